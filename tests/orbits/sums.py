"""Potentials as tests write them."""

from fractions import Fraction

from thesis import potentials

from converse import orbits
from converse.model.potential import from_terms
from converse.orbits.potential import Fourier


def fourier(terms, name="fourier", start=None):
    """V(x), the sum of cosine cos(2 pi k.x) + sine sin(2 pi k.x) over {k: (cosine, sine)}; floats
    stand for their exact values."""
    return Fourier.of(from_terms({k: (Fraction(c), Fraction(s)) for k, (c, s) in terms.items()}),
                      name, start, "1")


def named(name):
    """One of the potentials with names."""
    return getattr(potentials if name in ("poly", "ff") else orbits, name)
