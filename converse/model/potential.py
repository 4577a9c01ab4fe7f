"""A potential as a finite Fourier sum,

    V(y) = - sum of p[j] sin(k[j].y + pi phase[j]),

and the two conventions in which its map is written:

    proofs, maps of the frontier, input files    orbits
    y, J of period 2 pi                          x = y/(2 pi), p = J/(2 pi) of period 1
    y' = y + J', J' = J - grad V(y)              x' = x + p', p' = p - eps grad U(x)

With eps = 1 they are the same map if U(x) = V(2 pi x)/(4 pi^2), that is, if U is the sum of

    s (c cos(2 pi k.x) + d sin(2 pi k.x)),
    s = 1/(4 pi^2), c = -p sin(pi phase), d = -p cos(pi phase).

This module is the only place where one is converted to the other.
"""

import math
from fractions import Fraction
from typing import Dict, Iterator, NamedTuple, Tuple

from .exact import Ends, number_text, pi_bounds, sine_bounds

Wave = Tuple                            # k, two integers or three, and the phase in units of pi
Rows = Iterator[Tuple[Tuple[int, ...], Ends, Ends]]
QUARTER = Fraction(1, 2)                # A quarter turn in units of pi: sin(t + pi/2) = cos t.
# The phases, in units of pi, with which a term - p sin(t + pi phase) of V is p times such a word.
PHASES = {"-sin": Fraction(0), "-cos": QUARTER, "+sin": Fraction(1), "+cos": -QUARTER}
QUARTERS = ("sin", 1), ("cos", 1), ("sin", -1), ("cos", -1)     # sin(y + n pi/2): function, sign


class Term(NamedTuple):
    """The term of a wave in -V over a patch: (p + sum of t[m] parts[m]) sin(k.y + pi phase), with
    all t[m] from -1 to 1."""

    k: Tuple[int, ...]
    phase: Fraction
    p: Fraction
    parts: Tuple[Fraction, ...]

    @property
    def half(self) -> Fraction:
        """How far the amplitude goes from p."""
        return sum(map(abs, self.parts), Fraction(0))

    @property
    def most(self) -> Fraction:
        """The largest size of the amplitude."""
        return abs(self.p) + self.half

    def at(self, t) -> Fraction:
        """The amplitude at such t."""
        return sum(map(Fraction.__mul__, map(Fraction, t), self.parts), self.p)


class FourierSum(NamedTuple):
    """waves -- (k0, k1, phase in units of pi), or (k0, k1, k2, phase) of three angles
    amplitude -- p of each wave
    dimension -- of the angles: 1 (all k1 are 0), 2 or 3"""

    waves: Tuple[Wave, ...]
    amplitude: Tuple[Fraction, ...]
    dimension: int

    def terms(self, digits: int) -> Rows:
        """Yields the terms c cos k.y + d sin k.y of V: (k, (ends of c), (ends of d)).

        Waves with rational c and d are exact, and added up for each k.  Each other wave is a
        separate term, whose ends are within 10^-digits of the truth."""
        rational: Dict[Tuple[int, ...], Tuple[Fraction, Fraction]] = {}
        for (*k, phase), p in zip(self.waves, self.amplitude):
            if (2 * phase).denominator == 1:
                c, d = rational.get(tuple(k), (Fraction(0), Fraction(0)))
                rational[tuple(k)] = (c - p * sine_bounds(phase, 0)[0],
                                      d - p * sine_bounds(phase + QUARTER, 0)[0])
        for wave, (c, d) in rational.items():
            yield wave, (c, c), (d, d)
        more = digits + len(str(math.ceil(max(map(abs, self.amplitude)))))
        for (*k, phase), p in zip(self.waves, self.amplitude):
            if (2 * phase).denominator != 1:
                yield (tuple(k), product((-p, -p), sine_bounds(phase, more)),
                       product((-p, -p), sine_bounds(phase + QUARTER, more)))


def two_at_most(dimension: int) -> None:
    """ValueError: tori or orbits are to be found of a map of three angles."""
    if dimension > 2:
        raise ValueError("tori and orbits are looked for in one angle or two; this map has three, "
                         "of which converse proves that there is no torus")


def angle_names(letter: str, dimension: int) -> Tuple[str, ...]:
    """The names of the angles, or of the momenta, of a map."""
    return tuple(letter + str(i) for i in range(dimension)) if dimension > 1 else (letter,)


def potential_text(waves, forms, dimension: int, letter: str = "y", turn: str = "") -> str:
    """V(y), or V of turn times the angles, exactly.  letter: of an angle; forms: each amplitude as
    a linear form of parameters, {name: factor}; the name "" is the constant's."""
    text = harmonics_text(waves, forms, [-1] * len(waves), 0, dimension, letter, turn)
    return "-" * text.startswith(" -") + text[3:] or "0"


def harmonics_text(waves, forms, factors, quarters: int, dimension: int, letter: str = "y",
                   turn: str = "") -> str:
    """The sum of factor p sin(k.y + phi + quarters pi/2), exactly, each term with its sign: it is
    written with k.y alone where phi is a multiple of pi/2."""
    letters, text = angle_names(letter, dimension), ""
    for (*k, phase), form, factor in zip(waves, forms, factors):
        angle, (function, sign) = sum_text(zip(k, letters)), QUARTERS[quarters]
        if turn:
            angle = "%s %s" % (turn, angle if angle in letters else "(%s)" % angle)
        if (2 * phase).denominator == 1:
            function, sign = QUARTERS[int(2 * phase + quarters) % 4]
        else:
            angle += " %s %s pi" % ("-" if phase < 0 else "+", number_text(abs(phase)))
        terms = [(x, name) for name, x in form.items() if x]
        if len(terms) > 1:
            terms = [(1, "(%s)" % sum_text(terms))]
        for x, name in terms if factor else ():
            x *= factor * sign
            text += (" - " if x < 0 else " + ") + " ".join(filter(None, (
                "" if abs(x) == 1 else number_text(abs(x)), name, function)))
            text += " " + angle if angle in letters else "(%s)" % angle
    return text


def per_period(digits: int) -> Ends:
    """The factor 1/(4 pi^2) from V to U."""
    low, high = pi_bounds(digits + 2)
    return 1 / (4 * high ** 2), 1 / (4 * low ** 2)


def product(x: Ends, y: Ends) -> Ends:
    """An interval times another."""
    products = [a * b for a in x for b in y]
    return min(products), max(products)


def sum_text(parts) -> str:
    """The sum of products of a rational number and what follows it, in words."""
    text = ""
    for c, what in parts:
        if c:
            text += " - " if c < 0 else " + "
            text += what if abs(c) == 1 and what else (number_text(abs(c)) + " " + what).strip()
    return ("-" if text.startswith(" -") else "") + text[3:] or "0"
