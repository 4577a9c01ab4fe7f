"""Which regions of the successors of x* stand for the whole torus, and the one that is searched.

A region is a box of v, x_1 = F v with the integers F of the frame.  Two x_1 that differ by
multiples of 2 pi are one point of the torus.  So, in units of pi, the last of v0, v1, ... may be
moved by its period alone, and each other one by its period together with some moves of those after
it (problem.moves).  Reversal of time takes v0 to 2 c0 - v0.  The exchange of two angles takes v1 to
-v1: docs/proofs/argument.md, section 2.
"""

import itertools
from dataclasses import replace
from fractions import Fraction
from math import gcd
from typing import Dict, List, Optional, Sequence, Tuple

from .exact import Ends, pi_bounds, rounded, sine_bounds
from .lattice import echelon
from .map import HIGHEST
from .potential import Term
from .problem import IDENTITY, Frame, Problem, identity, inverse, moves, periods, ranges, rows

EXCHANGED = 0, 1, 1, 0              # the frame with v0 and v1 for the second angle and the first
# v0 along the diagonal; n v1 = x0 - x1, n v2 = x1 - x2.  Where angles may be exchanged it is enough
# that x0 >= x1 >= ... >= x0 - 2, in units of pi, so that v1, v2, ... go from 0 to 2/n.
DIAGONALS: Dict[int, Frame] = {2: (1, 1, 1, -1), 3: (1, 2, 1, 1, -1, 1, 1, -1, -2)}
REVERSAL, EXCHANGE = "reversal of time", "exchange of the angles"
DIGITS = 40
PLACES = 9                          # of the ends of a region that is chosen, which have one more to
MARGIN = Fraction(1, 10 ** PLACES)  # spare, so that whoever bounds c0 sees that they suffice
FAR = 8                             # in units of pi

Point = Tuple[str, ...]


def symmetries_used(problem: Problem, xstar: Optional[Point]) -> Optional[List[str]]:
    """The symmetries by which the region stands for the whole torus, or None if it does not, or
    has shifts."""
    if problem.shifts:
        return None
    period0, *others = periods(problem.frame)
    (low0, high0), *rest = problem.region
    used = []
    if any(high - low < period for (low, high), period in zip(rest, others)):
        if xstar is None or problem.frame != DIAGONALS[problem.size] or any(
                low > 0 or high < Fraction(2, problem.size) for low, high in rest) or \
                not exchangeable(problem, xstar):
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
    """Does each exchange of neighbouring angles leave x* alone, and the patch and the shifts, with
    the parameters in some order?"""
    if len(set(map(Fraction, xstar))) > 1 or problem.factor is not None:
        return False
    here, orders = _sums(problem.terms), list(itertools.permutations(range(len(problem.parts))))

    def kept(i, order):
        return _sums(Term((*k[:i], k[i + 1], k[i], *k[i + 2:]), phase, p,
                          tuple(parts[m] for m in order))
                     for k, phase, p, parts in problem.terms) == here and all(
            s == problem.shifts[m] for s, m in zip(problem.shifts, order))

    return all(any(kept(i, order) for order in orders) for i in range(problem.size - 1))


def folds(problem: Problem, xstar: Point) -> bool:
    """Is the region proved together with its mirror image, in which v1 has the other sign?"""
    return problem.frame == DIAGONALS[2] and problem.v1[0] <= 0 <= problem.v1[1] and \
        not any(s1 for _, s1 in problem.shifts) and exchangeable(problem, xstar)


def with_image(problem: Problem, xstar: Point) -> Tuple[Ends, ...]:
    """The region that links to a part may lead into, with its mirror image if that is proved."""
    if not folds(problem, xstar):
        return problem.region
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
    return problem.size == 2 and symmetric(problem) and exchangeable(problem, xstar)


def symmetric(problem: Problem) -> bool:
    """Does each exchange of neighbouring coordinates map the patch and the region to themselves?"""
    return problem.frame == identity(problem.size) and len(set(problem.region)) == 1 and \
        not problem.shifts and exchangeable(problem, ("0",))


def _sums(terms):
    """The sums of the amplitudes of waves with the same k and phase, and of their parts."""
    sums = {}
    for k, phase, p, parts in terms:
        before = sums.get((k, phase % 2), (0,) * (1 + len(parts)))
        sums[k, phase % 2] = tuple(a + b for a, b in zip(before, (p, *parts)))
    return {wave: numbers for wave, numbers in sums.items() if any(numbers)}


def reversal_centre(problem: Problem, xstar: Point) -> Ends:
    """Bounds of c0 in units of pi for all parameters.  pi c0 is the first component of
    F^-1 (x* - V'(x*)/2), that is r.x* + sum of (r.k) p cos(k.x* + phase)/2 over the waves that are
    examined, r the first row of F^-1.  It is affine in the parameters, whose shifts of v0 are
    subtracted."""
    row, star = inverse(problem.frame)[0], tuple(map(Fraction, xstar))
    ends = [_dot(row, star)] * 2
    by_parameter = [[Fraction(0)] * 2 for _ in problem.parts]
    for k, phase, p, parts in problem.searched:
        cosine, weight = _cosine(_dot(k, star), phase), _dot(row, k) / 2
        _add(ends, weight * p, cosine)
        for move, part in zip(by_parameter, parts):
            _add(move, weight * part, cosine)
    for move, (shift, *_) in zip(by_parameter, problem.shifts):
        _add(move, -shift, pi_bounds(DIGITS))
    reach = sum([max(map(abs, move)) for move in by_parameter], Fraction(0))
    quotients = [x / p for x in (ends[0] - reach, ends[1] + reach) for p in pi_bounds(DIGITS)]
    return min(quotients), max(quotients)


def _dot(x, y):
    return sum(a * b for a, b in zip(x, y))


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
    if problem.frame != identity(problem.size):     # all waves feel one combination of the angles
        return problem
    problem = replace(problem, axes=frame or _frame(problem, xstar))
    period0, *others = periods(problem.frame)
    low, high = reversal_centre(problem, xstar)
    if high - low >= period0 / 2 or max(abs(low), abs(high)) > FAR:
        v0 = Fraction(0), period0   # reversal gains nothing, or doubles are too coarse there
    else:
        v0 = (rounded(low - MARGIN, PLACES, up=False),
              rounded(high + period0 / 2 + MARGIN, PLACES, up=True))
    if problem.frame == DIAGONALS[problem.size] and exchangeable(problem, xstar):
        others = [rounded(Fraction(2, problem.size), PLACES, up=True)] * len(others)
    return replace(problem, **ranges([v0, *((Fraction(0), period) for period in others)]))


def _frame(problem, xstar):
    """v0 along the wave that bends most, the others across it; or, where that may be, along the
    diagonal and across it."""
    if problem.factor is not None:
        return EXCHANGED if problem.factor else IDENTITY
    if exchangeable(problem, xstar):
        return DIAGONALS[len(xstar)]
    k = max(problem.terms, key=lambda term: term.most * sum(x * x for x in term.k)).k
    k = tuple(x // gcd(*k) for x in k)
    if sum(map(bool, k)) == 1:          # along a coordinate, which comes first
        units = sorted(rows(identity(len(k))), key=lambda unit: unit != tuple(map(abs, k)))
        return tuple(x for row in zip(*units) for x in row)
    if len(k) == 2:
        return k[0], -k[1], k[1], k[0]
    _, across = echelon([(x, *row) for x, row in zip(k, rows(identity(3)))], 1)
    frame = tuple(x for row in zip(k, *[c for _, *c in across]) for x in row)
    return frame if max(map(abs, frame)) <= HIGHEST else identity(3)


# ---- places in it

def nearest(frame: Frame, x: Sequence[Fraction], centre: Sequence[Fraction]) -> List[Fraction]:
    """The v that x stands for, all in units of pi, moved to where v0 is nearest to the centre, then
    v1, and so on."""
    v = [_dot(row, x) for row in inverse(frame)]
    for i, move in enumerate(moves(frame)):
        turns = round((centre[i] - v[i]) / move[i])
        v = [a + turns * b for a, b in zip(v, move)]
    return v
