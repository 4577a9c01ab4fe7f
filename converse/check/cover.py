"""Does a region hold all of the torus, or enough of it: step (C24)."""

import itertools
import math
from fractions import Fraction

from .arith import SINE_ERROR, determinant, dot, fixed_of, inverse_rows
from .claim import DIAGONALS
from .tree import exchange_orders

CENTRE_BITS = 256                       # of the centre of the reversal


def reversal_centre(claim):
    """Bounds of c0 of step (C24), in units of pi, over all parameters, less what the parameters
    shift v0 by: exact numbers.

    pi c0 is the first component of F^-1 (x* - V'(x*)/2), that is u.x* + sum of p u.k cos(k.x* +
    phase)/2 over the waves, with u the first row of F^-1; and affine in the parameters.  A cosine
    is off by SINE_ERROR units, and by 3 as the angle is off by 3.
    """
    fixed = fixed_of(CENTRE_BITS)
    one, u = fixed.one, inverse_rows(claim.rows)[0]
    middle, moved = dot(u, claim.xstar), [Fraction(0)] * claim.parameters
    error = Fraction(0)
    for wave in claim.examined:
        angle = math.floor(dot(wave.k, claim.xstar) * one)
        weight = dot(u, wave.k) / 2
        cosine = weight * Fraction(fixed.sincos(angle + fixed.angle(wave.phase))[1], one)
        middle += wave.middle * cosine
        moved = [x + part * cosine for x, part in zip(moved, wave.parts)]
        error += abs(weight) * (abs(wave.middle) + sum(map(abs, wave.parts))) * (SINE_ERROR + 3)
    for m, (shift, *_) in enumerate(claim.shifts):       # pi is within 2 units
        moved[m] -= shift * Fraction(fixed.pi, one)
        error += 2 * abs(shift)
    error = error / one + sum(map(abs, moved))
    ends = [x / pi for x in (middle - error, middle + error) for pi in fixed.around_pi]
    return min(ends), max(ends)


def periods(frame):
    """P of step (C24), of each v."""
    n, minors = len(frame), [1]
    for i in range(1, n + 1):           # of the last i columns
        minors.append(math.gcd(*[determinant([row[n - i:] for row in rows])
                                 for rows in itertools.combinations(frame, i)]))
    return [Fraction(2 * a, b) for a, b in zip(minors, minors[1:])][::-1]


def symmetries_used(claim):
    """The symmetries by which the claim's region holds enough of the torus, in words; None, if it
    does not, or the checker cannot tell."""
    used = []
    ends = [(c - h, c + h, P) for c, h, P in zip(claim.centre, claim.half, periods(claim.rows))]
    if any(high - low < P for low, high, P in ends[1:]):
        n = len(ends)
        if claim.frame != DIAGONALS[n] or any(
                low > 0 or n * high < 2 for low, high, _ in ends[1:]) or not all(
                exchange_orders(claim, at) for at in range(n - 1)) or any(
                any(shift[1:]) for shift in claim.shifts):
            return None
        used = ["exchange of the angles"]
    low, high, P = ends[0]
    if high - low < P:
        try:
            least, most = reversal_centre(claim)
        except OverflowError:           # of an x* far off
            return None
        if least < low or most + P / 2 > high:
            return None
        used = ["reversal of time", *used]
    return used
