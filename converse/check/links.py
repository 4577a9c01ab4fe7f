"""Leaves that are linked to another part: steps (C25), (C26), (C28)."""

import math
from dataclasses import replace
from fractions import Fraction

from .arith import SINE_ERROR, dot, entries, inverse_rows, pairs_of, times, upper_sqrt
from .claim import LETTERS
from .failures import NotConfirmed
from .tree import folds, leaf_text, leaves, trees

PIECES = 16                             # of the segment from one x* to the other


def upper_beta(claim, fixed, cell, middle, w):
    """A symmetric matrix that beta is not above, for the parameters of a cell, on the segment
    between middle - w/2 and middle + w/2: exact.

    k k' is not below zero, so it may stand with an upper bound of -p' sin(k.x + phase), found at
    ends of p' and of the sine.  With the angle y in the middle of the segment, off by less than 3
    units, its sine and cosine by SINE_ERROR and one more, and z = k.(x - middle), |z| <= h, that is
    sin(y + z) = sin y + z cos y - z^2/2 sin(some angle).
    """
    found = [Fraction(2 * (i == j)) for i, j in pairs_of(len(w))]
    off = Fraction(SINE_ERROR + 1, fixed.one)
    for wave in claim.waves:
        amplitude, half = wave.over(cell)
        angle = math.floor(dot(wave.k, middle) * fixed.one)
        s, c = [Fraction(x, fixed.one) for x in fixed.sincos(angle + fixed.angle(wave.phase))]
        h = abs(dot(wave.k, w)) / 2
        far = off + (abs(c) + off) * h + h * h / 2
        most = max([-x * sine for x in (amplitude - half, amplitude + half)
                    for sine in (max(s - far, -1), min(s + far, 1))])
        found = [x + most * y for x, y in zip(found, entries(wave.k))]
    return found


def displacement(criterion, cell, start, end):
    """Bounds of v' - v in units of pi, if f(start) = F v pi and f(end) = F v' pi for an invariant
    graph's f, for any parameters of the cell: for each v, exact."""
    claim, fixed, n = criterion.claim, criterion.fixed, range(len(start))
    rows, l = inverse_rows(claim.rows), Fraction(criterion.least_pivot(cell), fixed.one)
    shift, radius = [Fraction(0) for _ in n], [Fraction(0) for _ in n]
    w = [(y - x) / PIECES for x, y in zip(start, end)]
    for piece in range(PIECES):
        middle = [x + (2 * piece + 1) * d / 2 for x, d in zip(start, w)]
        b = upper_beta(claim, fixed, cell, middle, w)
        D = [x - 2 * l * (i == j) for x, (i, j) in zip(b, pairs_of(len(w)))]
        for i, u in enumerate(rows):
            square = dot(u, times(D, u)) * dot(w, times(D, w))
            shift[i] += dot(u, times(b, w)) / 2
            radius[i] += Fraction(upper_sqrt(math.ceil(square * fixed.one ** 2)), 2 * fixed.one)
    return [(min(ends), max(ends)) for ends in [
        [x / pi for x in (s - d, s + d) for pi in fixed.around_pi]
        for s, d in zip(shift, radius)]]


def check_links(claim, criterion):
    """NotConfirmed, if a leaf that is linked to a part may have successors outside of the part's
    region."""
    known = {}                          # displacements
    targets = dict(zip(LETTERS, claim.parts))
    for letter, part in targets.items():
        if folds(part):                 # with its mirror image: step (C28)
            (c0, c1), (h0, h1) = part.centre, part.half
            targets[letter] = replace(part, centre=(c0, 0), half=(h0, abs(c1) + h1))
    for part, letters in trees(claim):
        for position, cell in leaves(part.tree, kinds="PS" + letters):
            letter = part.tree[position]
            if letter not in letters:
                continue
            target = targets[letter]
            key = part.where, letter, *[x[2:5] for x in cell]
            if key not in known:
                try:
                    known[key] = displacement(criterion, cell, part.xstar, target.xstar)
                except OverflowError:
                    raise NotConfirmed("the x* of a part is too far off for this checker") from None
            # The leaf, where the target's region stands still and has its middle at 0.
            leaf = replace(part, centre=[x - y for x, y in zip(part.centre, target.centre)],
                           shifts=[[x - y for x, y in zip(*both)] for both in
                                   zip(part.moves[2:5], target.moves[2:5])])
            for (x, along), (low, high), half in zip(leaf.box(cell), known[key], target.half):
                reach = sum(map(abs, along))
                if x - reach + low < -half or x + reach + high > half:
                    raise NotConfirmed("%s is linked to part %s, but may lead out of its region" % (
                        leaf_text(part, letter, part.tree.count(letter, 0, position), cell),
                        letter))
