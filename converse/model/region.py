"""Which regions of the successors of x* stand for the whole torus, and the one that is searched.

A region is a rectangle of v, x_1 = F v with the integers F of the frame.  Two x_1 that differ by
multiples of 2 pi are one point of the torus.  So, in units of pi, v may be moved by (0, P1) and by
(P0, a number).  P0 = 2 g/|det F| and P1 = 2/g, with g the divisor of F's second column.  Reversal
of time takes v0 to 2 c0 - v0, and the exchange of the angles v1 to -v1: docs/proofs/argument.md,
section 2.
"""

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from typing import List, Optional, Sequence, Tuple

from .exact import Ends, pi_bounds, rounded, sine_bounds
from .problem import IDENTITY, Frame, Problem, bezout, inverse, periods

EXCHANGED = 0, 1, 1, 0              # the frame with v0 and v1 for the second angle and the first
DIAGONALS = 1, 1, 1, -1             # v0 along the diagonal, v1 across it
REVERSAL, EXCHANGE = "reversal of time", "exchange of the angles"
DIGITS = 40
PLACES = 9                          # of the ends of a region that is chosen, which have one more to
MARGIN = Fraction(1, 10 ** PLACES)  # spare, so that whoever bounds c0 sees that they suffice
FAR = 8                             # in units of pi

Point = Tuple[str, str]


def symmetries_used(problem: Problem, xstar: Optional[Point]) -> Optional[List[str]]:
    """The symmetries by which the region stands for the whole torus, or None if it does not, or
    has shifts."""
    if problem.shifts:
        return None
    period0, period1 = periods(problem.frame)
    (low0, high0), (low1, high1) = problem.v0, problem.v1
    used = []
    if high1 - low1 < period1:
        if high1 < 1 or xstar is None or not folds(problem, xstar):
            return None
        used = [EXCHANGE]
    if high0 - low0 < period0:
        if xstar is None:
            return None
        low, high = reversal_centre(problem, xstar)
        if low < low0 or high + period0 / 2 > high0:
            return None
        used = [REVERSAL, *used]
    return used


def exchangeable(problem: Problem, xstar: Point) -> bool:
    """Does the exchange of the angles leave x* alone, and the patch and the shifts, with the
    parameters in some order?"""
    if Fraction(xstar[0]) != Fraction(xstar[1]) or problem.factor is not None:
        return False
    waves = list(zip(problem.waves, problem.amplitude, *problem.parts))
    here = _sums(waves)
    return any(_sums([((k1, k0, phase), p, *(parts[m] for m in order))
                      for (k0, k1, phase), p, *parts in waves]) == here
               and all(s == problem.shifts[m] for s, m in zip(problem.shifts, order))
               for order in itertools.permutations(range(len(problem.parts))))


def folds(problem: Problem, xstar: Point) -> bool:
    """Is the region proved together with its mirror image, in which v1 has the other sign?"""
    return problem.frame == DIAGONALS and problem.v1[0] <= 0 <= problem.v1[1] and \
        not any(s1 for _, s1 in problem.shifts) and exchangeable(problem, xstar)


def with_image(problem: Problem, xstar: Point) -> Tuple[Ends, Ends]:
    """The region that links to a part may lead into, with its mirror image if that is proved."""
    if not folds(problem, xstar):
        return problem.v0, problem.v1
    most = max(map(abs, problem.v1))
    return problem.v0, (-most, most)


def halved(problem: Problem, xstar: Point) -> Problem:
    """The part of the problem that is to be proved: of a region that may be folded, the half."""
    if not folds(problem, xstar) or problem.v1[0] == 0:
        return problem
    return replace(problem, v1=(Fraction(0), max(map(abs, problem.v1))))


def skips(problem: Problem, xstar: Point) -> bool:
    """May the search skip prisms for the sake of their mirror images, which must then be proved,
    and not be linked to other starting points?"""
    return problem.frame == IDENTITY and problem.v0 == problem.v1 and not problem.shifts and \
        exchangeable(problem, xstar)


def _sums(waves):
    """What the amplitudes of waves with the same k and phase add up to, and their parts."""
    sums = {}
    for wave, *numbers in waves:
        before = sums.get(wave, (0,) * len(numbers))
        sums[wave] = tuple(map(Fraction.__add__, map(Fraction, before), numbers))
    return {wave: numbers for wave, numbers in sums.items() if any(numbers)}


def reversal_centre(problem: Problem, xstar: Point) -> Ends:
    """Bounds of c0 in units of pi for all parameters.  pi c0 is the first component of
    F^-1 (x* - V'(x*)/2), that is r.x* + sum of (r.k) p cos(k.x* + phase)/2 over the waves that are
    examined, r the first row of F^-1.  It is affine in the parameters, whose shifts of v0 are
    subtracted."""
    row, star = inverse(problem.frame)[0], tuple(map(Fraction, xstar))
    ends = [row[0] * star[0] + row[1] * star[1]] * 2
    moves = [[Fraction(0)] * 2 for _ in problem.parts]
    for (k0, k1), phase, p, parts in problem.searched:
        cosine = _cosine(k0 * star[0] + k1 * star[1], phase)
        weight = (row[0] * k0 + row[1] * k1) / 2
        _add(ends, weight * p, cosine)
        for move, part in zip(moves, parts):
            _add(move, weight * part, cosine)
    for move, (shift, _) in zip(moves, problem.shifts):
        _add(move, -shift, pi_bounds(DIGITS))
    reach = sum([max(map(abs, move)) for move in moves], Fraction(0))
    quotients = [x / p for x in (ends[0] - reach, ends[1] + reach) for p in pi_bounds(DIGITS)]
    return min(quotients), max(quotients)


def _add(ends, factor, interval):
    """ends += factor interval"""
    for i, x in enumerate(sorted(factor * x for x in interval)):
        ends[i] += x


def _cosine(angle, phase):
    """Bounds of cos(angle + pi phase).  The angle in units of pi is off by less than the difference
    of its ends, and sin(pi t) by at most 4 times that (of an angle of many turns, the most)."""
    low, high = sorted(angle / p for p in pi_bounds(DIGITS))
    least, most = sine_bounds(low + phase + Fraction(1, 2), DIGITS)
    return least - 4 * (high - low), most + 4 * (high - low)


# ---- the choice

def reduced(problem: Problem, xstar: Point, frame: Optional[Frame] = None) -> Problem:
    """The problem, whose region is all of the torus, in this frame, by default one that suits it,
    with the smaller region that stands for the torus."""
    if problem.frame != IDENTITY:       # all waves feel one combination of the angles
        return problem
    problem = replace(problem, axes=frame or _frame(problem, xstar))
    period0, period1 = periods(problem.frame)
    low, high = reversal_centre(problem, xstar)
    if high - low >= period0 / 2 or max(abs(low), abs(high)) > FAR:
        v0 = Fraction(0), period0   # reversal gains nothing, or doubles are too coarse there
    else:
        v0 = (rounded(low - MARGIN, PLACES, up=False),
              rounded(high + period0 / 2 + MARGIN, PLACES, up=True))
    exchanged = problem.frame == DIAGONALS and exchangeable(problem, xstar)
    return replace(problem, v0=v0, v1=(Fraction(0), Fraction(1) if exchanged else period1))


def _frame(problem, xstar):
    """v0 along the wave that bends most, v1 across it; or, where that may be, along the diagonal
    and across it."""
    if problem.factor is not None:
        return EXCHANGED if problem.factor else IDENTITY
    if exchangeable(problem, xstar):
        return DIAGONALS
    k0, k1 = max(problem.terms, key=lambda term: term.most * sum(k * k for k in term.k)).k
    common = math.gcd(k0, k1)
    k0, k1 = k0 // common, k1 // common
    if 0 in (k0, k1):
        return IDENTITY if k0 else EXCHANGED
    return k0, -k1, k1, k0


# ---- places in it

def nearest(frame: Frame, x: Sequence[Fraction], centre: Sequence[Fraction]) -> List[Fraction]:
    """The v that x stands for, all in units of pi, moved to where v0, and then v1, is nearest to
    the centre."""
    f00, f01, f10, f11 = frame
    det = f00 * f11 - f01 * f10
    period0, period1 = periods(frame)
    common = math.gcd(f01, f11)
    m, n = bezout(f11 // common, -f01 // common)        # 2 (m, n) moves v0 by P0 or -P0
    turns = round((centre[0] - (f11 * x[0] - f01 * x[1]) / det) / period0)
    turns *= 1 if det > 0 else -1
    x0, x1 = x[0] + 2 * m * turns, x[1] + 2 * n * turns
    v0, v1 = (f11 * x0 - f01 * x1) / det, (f00 * x1 - f10 * x0) / det
    return [v0, v1 + period1 * round((centre[1] - v1) / period1)]
