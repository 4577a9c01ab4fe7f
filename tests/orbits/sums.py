"""Potentials as tests write them."""

from fractions import Fraction

from thesis import potentials

from converse import orbits
from converse.model.potential import QUARTER, FourierSum
from converse.orbits.potential import Fourier


def from_terms(terms) -> FourierSum:
    """The FourierSum of {k: (c, d)}, k a tuple of one or two integers."""
    waves, amplitude = [], []
    for k, (c, d) in terms.items():
        for p, phase in (-c, QUARTER), (-d, Fraction(0)):
            if p or phase and not d:            # one, even if both are zero
                waves.append((*k, *(0,) * (2 - len(k)), phase))
                amplitude.append(p)
    return FourierSum(tuple(waves), tuple(amplitude), max(map(len, terms)))


def fourier(terms, name="fourier", start=None):
    """V(x), the sum of cosine cos(2 pi k.x) + sine sin(2 pi k.x) over {k: (cosine, sine)}; floats
    stand for their exact values."""
    return Fourier.of(from_terms({k: (Fraction(c), Fraction(s)) for k, (c, s) in terms.items()}),
                      name, start, "1")


def named(name):
    """One of the potentials with names."""
    return getattr(potentials if name in ("poly", "ff") else orbits, name)
