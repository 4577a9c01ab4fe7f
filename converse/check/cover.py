"""Does a region hold all of the torus, or enough of it: step (C24)."""

import math
from fractions import Fraction

from .arith import SINE_ERROR, fixed_of
from .tree import folds

CENTRE_BITS = 256                       # of the centre of the reversal


def reversal_centre(claim):
    """Bounds of c0 of step (C24), in units of pi, over all parameters, less what the parameters
    shift v0 by: exact numbers.

    pi c0 is the first component of F^-1 (x* - V'(x*)/2), that is u.x* + sum of p u.k cos(k.x* +
    phase)/2 over the waves, with u the first row of F^-1; and affine in the parameters.  A cosine
    is off by SINE_ERROR units, and by 3 as the angle is off by 3.
    """
    fixed = fixed_of(CENTRE_BITS)
    one, (f00, f01, f10, f11) = fixed.one, claim.frame
    u = [Fraction(f, f00 * f11 - f01 * f10) for f in (f11, -f01)]
    middle, moved = sum([a * x for a, x in zip(u, claim.xstar)]), [Fraction(0)] * claim.parameters
    error = Fraction(0)
    for wave in claim.examined:
        angle = math.floor(sum([k * x for k, x in zip(wave.k, claim.xstar)]) * one)
        weight = sum([a * k for a, k in zip(u, wave.k)]) / 2
        cosine = weight * Fraction(fixed.sincos(angle + fixed.angle(wave.phase))[1], one)
        middle += wave.middle * cosine
        moved = [x + part * cosine for x, part in zip(moved, wave.parts)]
        error += abs(weight) * (abs(wave.middle) + sum(map(abs, wave.parts))) * (SINE_ERROR + 3)
    for m, (shift, _) in enumerate(claim.shifts):       # pi is within 2 units
        moved[m] -= shift * Fraction(fixed.pi, one)
        error += 2 * abs(shift)
    error = error / one + sum(map(abs, moved))
    ends = [x / Fraction(fixed.pi + off, one) for x in (middle - error, middle + error)
            for off in (-2, 2)]
    return min(ends), max(ends)


def symmetries_used(claim):
    """The symmetries by which the claim's region holds enough of the torus, in words; None, if it
    does not, or the checker cannot tell."""
    f00, f01, f10, f11 = claim.frame
    common, used = math.gcd(f01, f11), []
    period0, period1 = Fraction(2 * common, abs(f00 * f11 - f01 * f10)), Fraction(2, common)
    (low0, high0), (low1, high1) = [(c - h, c + h) for c, h in zip(claim.centre, claim.half)]
    if high1 - low1 < period1:
        if high1 < 1 or not folds(claim):
            return None
        used = ["exchange of the angles"]
    if high0 - low0 < period0:
        try:
            least, most = reversal_centre(claim)
        except OverflowError:           # of an x* far off
            return None
        if least < low0 or most + period0 / 2 > high0:
            return None
        used = ["reversal of time", *used]
    return used
