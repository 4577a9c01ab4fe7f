"""All values of a parameter above one value, or below it, by one point of the torus.

beta(x; K) = 2 - V''(x; K) is affine in the parameter K.  If n.beta(x; K)n <= 0 at K = value for a
point x and an integer vector n, and does not grow from there, no invariant graph exists for any K
beyond the value: docs/proofs/argument.md, section 2.
"""

import itertools
import math
from fractions import Fraction
from typing import Dict, Optional

from ..model.exact import sine_bounds
from ..model.map import SymplecticMap
from .value import Side

TURN = 1 << 12                          # Components of x are multiples of 1/TURN of a turn.
GRID = 32                               # First, points in a turn are compared for each angle,
LARGEST = 4                             # and n with entries up to this,
LARGEST_AT_BEST = 16                    # and up to this where they have led farthest.
DIGITS = 40                             # of the sines
SPARE = Fraction(1, 10 ** 30)           # n.beta n is below 0 by this, for any checker to confirm.
SLOPE_MIN = 1e-6                        # of n.beta n; a lesser one may be an error of rounding.
FIGURES = 5                             # significant digits of the value, which is rounded


def sides_of(family: SymplecticMap) -> Dict[str, Side]:
    """The values of the parameter above which, and below which, one point excludes all tori, as far
    as such values are found.

    Parameters
    ----------
    family
        With one parameter; those that have one value are taken as they are.

    Returns
    -------
    dict
        By "above" and "below": the value, x in turns, and n.
    """
    found = {"above": _found(family, 1), "below": _found(family, -1)}
    return {side: each for side, each in found.items() if each}


def _found(family, sign) -> Optional[Side]:
    """For sign = 1 the least value that is found, or for sign = -1 the largest one."""
    forms = _forms(family)
    waves = [(*wave[:2], float(wave[2]), float(start), sign * float(slope))
             for wave, start, slope in forms]
    axes = 2 if family.dimension == 2 else 1

    def level(n, x):
        """The value of sign K from which x excludes with n; infinite if there is none."""
        start, slope = 2.0 * (n[0] * n[0] + n[1] * n[1]), 0.0
        for k0, k1, phase, p, q in waves:
            weight = (n[0] * k0 + n[1] * k1) ** 2 * math.sin(
                math.pi * (2 * (k0 * x[0] + k1 * x[1]) / TURN + phase))
            start, slope = start - weight * p, slope - weight * q
        return start / -slope if slope < -SLOPE_MIN else math.inf

    def vectors(most):
        return [(1, 0)] if axes == 1 else [
            (n0, n1) for n0 in range(most + 1) for n1 in range(-most, most + 1)
            if math.gcd(n0, n1) == 1 and (n0, n1) > (0, 0)]

    def grid(width, count):
        return itertools.product(range(0, count * width, width), *[
            range(0, count * width, width)] * (axes - 1), *[(0,)] * (2 - axes))

    best = min((level(n, x), n, x) for x in grid(TURN // GRID, GRID) for n in vectors(LARGEST))
    width = TURN // GRID
    while width > 1 and best[0] < math.inf:
        width //= 2
        near = [tuple(y + d * width for y, d in zip(best[2], move))
                for move in itertools.product((-1, 0, 1), repeat=axes)]
        best = min(best, *((level(n, (*x, 0)[:2]), n, (*x, 0)[:2]) for x in near
                           for n in vectors(LARGEST_AT_BEST)))
    value, n, x = best
    if not math.isfinite(value):
        return None
    place = FIGURES - 1 - math.floor(math.log10(abs(value))) if value else FIGURES
    for up in (0, 1):                   # in doubles it may be just missed
        rounded = sign * Fraction(math.ceil(Fraction(value) * Fraction(10) ** place) + up) \
            / Fraction(10) ** place
        side = rounded, tuple(Fraction(y % TURN, TURN) for y in x), n
        if excludes(family, sign, side):
            return side
    return None


def excludes(family: SymplecticMap, sign: int, side: Side) -> bool:
    """Is it proved that no map of the family with the parameter beyond a value has an invariant
    graph?

    Parameters
    ----------
    family
        As of sides_of().
    sign
        1: above the value; -1: below it.
    side
        The value, x and n.
    """
    value, x, n = side
    most, growth = Fraction(2 * sum(i * i for i in n)), Fraction(0)    # bounds, from above
    for (k0, k1, phase), start, slope in _forms(family):
        weight = (n[0] * k0 + n[1] * k1) ** 2
        sines = sine_bounds(2 * (k0 * x[0] + k1 * x[1]) + phase, DIGITS)
        most += max(-weight * (start + slope * value) * sine for sine in sines)
        growth += max(-weight * sign * slope * sine for sine in sines)
    return most <= -SPARE and growth <= 0


def _forms(family):
    """Of each wave (k0, k1, phase), its amplitude where the parameter is 0, and its slope."""
    fixed = [(ends[0], slopes) for ends, slopes in zip(family.ranges, family.slopes)
             if ends[0] == ends[1]]
    moving, = [slopes for ends, slopes in zip(family.ranges, family.slopes) if ends[0] < ends[1]]
    return [(wave, family.amplitude[j] + sum((x * slopes[j] for x, slopes in fixed), Fraction(0)),
             moving[j]) for j, wave in enumerate(family.harmonics)]
