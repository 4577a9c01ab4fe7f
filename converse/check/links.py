"""Leaves that are linked to another part: steps (C25), (C26), (C28)."""

import math
from dataclasses import replace
from fractions import Fraction

from .arith import SINE_ERROR, upper_sqrt
from .claim import LETTERS
from .failures import NotConfirmed
from .tree import folds, leaf_text, leaves, trees

PIECES = 16                             # of the segment from one x* to the other


def upper_beta(claim, fixed, cell, middle, w):
    """A matrix [p q; q r] that beta is not above, for the parameters of a cell, on the segment
    between middle - w/2 and middle + w/2: exact.

    k k' is not below zero, so it may stand with an upper bound of -p' sin(k.x + phase), found at
    ends of p' and of the sine.  With the angle y in the middle of the segment, off by less than 3
    units, its sine and cosine by SINE_ERROR and one more, and z = k.(x - middle), |z| <= h, that is
    sin(y + z) = sin y + z cos y - z^2/2 sin(some angle).
    """
    p, q, r, off = Fraction(2), Fraction(0), Fraction(2), Fraction(SINE_ERROR + 1, fixed.one)
    for wave in claim.examined:
        (k0, k1), (amplitude, half) = wave.k, wave.over(cell)
        angle = math.floor((k0 * middle[0] + k1 * middle[1]) * fixed.one)
        s, c = [Fraction(x, fixed.one) for x in fixed.sincos(angle + fixed.angle(wave.phase))]
        h = abs(k0 * w[0] + k1 * w[1]) / 2
        far = off + (abs(c) + off) * h + h * h / 2
        most = max([-x * sine for x in (amplitude - half, amplitude + half)
                    for sine in (max(s - far, -1), min(s + far, 1))])
        p, q, r = p + k0 * k0 * most, q + k0 * k1 * most, r + k1 * k1 * most
    return p, q, r


def displacement(criterion, cell, start, end):
    """Bounds of v' - v in units of pi, if f(start) = F v pi and f(end) = F v' pi for an invariant
    graph's f, for any parameters of the cell: for v0 and v1, exact."""
    claim, fixed = criterion.claim, criterion.fixed
    one, (f00, f01, f10, f11) = fixed.one, claim.frame
    l, det = Fraction(criterion.least_pivot(cell), one), f00 * f11 - f01 * f10
    rows, shift, radius = ((f11, -f01), (-f10, f00)), [Fraction(0)] * 2, [Fraction(0)] * 2
    w = [(y - x) / PIECES for x, y in zip(start, end)]
    for piece in range(PIECES):
        middle = [x + (2 * piece + 1) * d / 2 for x, d in zip(start, w)]
        p, q, r = upper_beta(claim, fixed, cell, middle, w)
        moved = p * w[0] + q * w[1], q * w[0] + r * w[1]
        a, c = p - 2 * l, r - 2 * l                         # D = [a q; q c]
        for n, (u0, u1) in enumerate(rows):
            square = (a * u0 * u0 + 2 * q * u0 * u1 + c * u1 * u1) \
                * (a * w[0] * w[0] + 2 * q * w[0] * w[1] + c * w[1] * w[1])
            shift[n] += (u0 * moved[0] + u1 * moved[1]) / 2
            radius[n] += Fraction(upper_sqrt(math.ceil(square * one * one)), 2 * one)
    return [(min(ends), max(ends)) for ends in [
        [x / Fraction(fixed.pi + off, one) for x in (s / det - d / abs(det), s / det + d / abs(det))
         for off in (-2, 2)] for s, d in zip(shift, radius)]]


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
            key = part.where, letter, *[x[2:] for x in cell]
            if key not in known:
                try:
                    known[key] = displacement(criterion, cell, part.xstar, target.xstar)
                except OverflowError:
                    raise NotConfirmed("the x* of a part is too far off for this checker") from None
            # The leaf, where the target's region stands still and has its middle at 0.
            leaf = replace(part, centre=[x - y for x, y in zip(part.centre, target.centre)],
                           shifts=[(a - c, b - d) for (a, b), (c, d) in
                                   zip(part.moves[2:], target.moves[2:])])
            for (x, along), (low, high), half in zip(leaf.box(cell), known[key], target.half):
                reach = sum(map(abs, along))
                if x - reach + low < -half or x + reach + high > half:
                    raise NotConfirmed("%s is linked to part %s, but may lead out of its region" % (
                        leaf_text(part, letter, part.tree.count(letter, 0, position), cell),
                        letter))
