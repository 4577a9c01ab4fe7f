"""The inequality of the theorem (docs/existence.md, section 3; numbers of formulas are those
there).

Constants at width rho and e0 >= ||E(u)||_rho are given; s, t and N are chosen here, and rho_inf =
rho/100. The steps are the same in doubles, by which choices are compared, and in balls, which alone
decide.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Callable, Iterator, NamedTuple, Optional, Sequence, Tuple

from flint import arb

from ..model.balls import precision
from .constants import Constants
from .divisors import Divisors
from .residual import Phases, above, ball

BITS = 96
NARROW = 100                            # rho/rho_inf
SHARES = tuple(Fraction(s, 20) for s in (1, 2, 4, 8, 16))
PARTS = 0.001, 0.003, 0.01, 0.025, 0.06, 0.15           # of 1/(l0 m0 a0), for t
STEPS = 4                               # N: more are never worse, as (30) is made
HALVINGS = 20                           # of the logarithm of the largest e0


class Choice(NamedTuple):
    """What the theorem leaves free."""

    s: Fraction
    t: Fraction
    steps: int                          # N


class Bounds(NamedTuple):
    """The left sides of (16), (17) and (18)."""

    q: Any
    slope: Any
    distance: Any


class Verdict(NamedTuple):
    """needed -- an e0, about the largest, with which the theorem holds
    choice -- of s, t and N for it
    bounds -- with the actual e0, as upper bounds; None if the theorem does not hold for it"""

    needed: float
    choice: Choice
    bounds: Optional[Bounds]


@dataclass(frozen=True)
class Numbers:
    """What (12) to (18) are made of but e0 and the choice: doubles or balls.

    forces -- (|p_j| |k_j|_2^3 g_j, |k_j|_2) of each wave
    small -- C_0, ..., C_N
    delta, kappa, exp -- of delta_0; of (4); the exponential function
    """

    n: int
    l0: Any
    m0: Any
    a0: Any
    b0: Any
    p0: Any
    forces: Sequence[Tuple[Any, Any]]
    small: Sequence[Any]
    delta: Any
    kappa: Any
    e: Any
    exp: Callable[[Any], Any]

    def bounds(self, e0: Any, s: Any, t: Any) -> Optional[Bounds]:
        """The left sides of (16) to (18) for e0; None unless m0 t < 1, a0 sigma < 1, b0 da < 1."""
        n = tau = self.n
        sigma = (2 * self.l0 + t) * t
        if not (self.m0 * t < 1 and self.a0 * sigma < 1):
            return None
        l, m, a = self.l0 + t, self.m0 / (1 - self.m0 * t), self.a0 / (1 - self.a0 * sigma)
        da = a * self.a0 * sigma
        if not self.b0 * da < 1:
            return None
        h = 1 + self.b0 / (1 - self.b0 * da) * (self.p0 + da)
        force = sum((size * self.exp(k * t) for size, k in self.forces), 0 * l)         # T
        e, slope, distance = e0, 0 * l, 0 * l
        for i, c in enumerate(self.small):
            delta = self.delta / 2 ** i
            loss = self.kappa / (self.e * delta)                                # d(delta_i)
            ahcc = a * h * c * c
            growth = ahcc * l * ((2 * m * l * loss if n > 1 else 0 * l) + loss / 2
                                 + force * ahcc * l * l * l / 2)                # G_i, (14)
            v = ahcc * l * l * e
            if i == len(self.small) - 1:
                return Bounds(2 ** (4 * tau) * growth * e,
                              slope + loss / s * v / (1 - _power(self.e, 1 - 2 * tau)),
                              distance + v / (1 - _power(self.e, -2 * tau)))
            slope, distance, e = slope + loss / s * v, distance + v, growth * e * e
        raise ValueError("no small divisors are given")


def _power(like, exponent):
    """2^exponent, as a number of the kind of `like`."""
    return (like * 0 + 1) / 2 ** -exponent


def holds(bounds: Optional[Bounds], t: Any) -> bool:
    """(16) to (18), all certainly: a comparison with nan or an infinite radius is false."""
    return bounds is not None and bool(bounds.q <= 1) and bool(bounds.slope <= t) and \
        bool(bounds.distance <= t)


class Theorem:
    """The theorem for one torus and norm, at any width.

    phases -- of the torus; divisors -- of its rotation vector, in the norm of phases"""

    def __init__(self, phases: Phases, divisors: Divisors):
        self.phases, self.divisors = phases, divisors
        self._found: dict = {}

    def verdict(self, constants: Constants, e0: float, careful: bool = True) -> Verdict:
        """Does the theorem hold with these constants and residual?

        Doubles compare choices.  Balls then decide: `bounds` are there only if all that the theorem
        asks for is certainly true of e0.  `needed` is checked in balls, too, if careful.
        """
        needed, choice = max(self._largest(constants, choice) for choice in _choices(constants))
        if not needed > 0:
            return Verdict(0.0, choice, None)
        with precision(BITS):
            numbers, s, t = self._balls(constants, choice)
            bounds = numbers.bounds(arb(e0), s, t) if math.isfinite(e0) else None
            if careful:
                needed = _nine(needed, lambda e: holds(numbers.bounds(arb(e), s, t), t))
            if not holds(bounds, t):
                return Verdict(needed, choice, None)
            assert bounds is not None
            return Verdict(needed, choice, Bounds(*map(above, bounds)))

    def _largest(self, constants, choice):
        """(about the largest e0 with which the theorem holds, the choice), in doubles."""
        numbers, s, t = self._doubles(constants, choice)
        low, high = -300.0, 0.0
        if not holds(numbers.bounds(math.exp(low), s, t), t):
            return 0.0, choice
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            ok = holds(numbers.bounds(math.exp(middle), s, t), t)
            low, high = (middle, high) if ok else (low, middle)
        return math.exp(low), choice

    def _balls(self, constants, choice):
        rho = constants.rho
        delta = (rho - rho / NARROW) / (4 + 2 * choice.s)
        forces = []
        for k, (c, d) in zip(self.phases.wave_vectors, self.phases.amplitudes):
            length = arb(sum(a * a for a in k)).sqrt()
            forces.append((ball(abs(c) + abs(d)) * length * length * length
                           * self.phases.exponential(k, rho), length))
        return Numbers(
            len(self.phases.norm.alpha), *(arb(x) for x in (
                constants.l0, constants.m0, constants.a0, constants.b0, constants.p0)),
            forces, self._small(delta, choice.steps), ball(delta), ball(self.divisors.norm.kappa),
            arb(1).exp(), lambda x: x.exp()), ball(choice.s), ball(choice.t)

    def _small(self, delta, steps):
        """C_0, ..., C_N of (13)."""
        first = [self._remembered(self.divisors.c_at, delta / 2 ** i) for i in range(steps)]
        return [*first, self._remembered(self.divisors.c, delta / 2 ** steps)]

    def _remembered(self, function, delta):
        key = function.__name__, delta
        if key not in self._found:
            self._found[key] = function(delta)
        return self._found[key]

    def _doubles(self, constants, choice):
        key = constants, choice.s, choice.steps
        if key not in self._found:
            with precision(BITS):
                numbers, s, _ = self._balls(constants, choice)
            self._found[key] = Numbers(
                numbers.n, *map(float, (numbers.l0, numbers.m0, numbers.a0, numbers.b0,
                                        numbers.p0)),
                [tuple(map(float, pair)) for pair in numbers.forces],
                [float(c) for c in numbers.small], float(numbers.delta), float(numbers.kappa),
                math.e, math.exp), float(s)
        return (*self._found[key], float(choice.t))


def _choices(constants: Constants) -> Iterator[Choice]:
    unit = 1 / (constants.l0 * constants.m0 * constants.a0)
    for s in SHARES:
        for part in PARTS:
            yield Choice(s, Fraction(part * unit), STEPS)


def _nine(e: float, test: Callable[[float], bool]) -> float:
    """e, or some per cent less, with test(e); 0 if that is not enough."""
    for _ in range(20):
        if test(e):
            return e
        e *= 0.99
    return 0.0
