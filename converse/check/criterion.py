"""The criterion (C3) on the leaves of one claim, in integers."""

import copy
import itertools
import math

from .arith import SINE_ERROR, dot, fixed_of, in_units, stiffness, upper_sqrt
from .choice import worst_axis
from .claim import ANGLE_AXES
from .exact import Prism, PrismWave, attempt
from .failures import NotConfirmed
from .limits import MAX_BITS, MAX_HALVINGS, MAX_PIECES, SITE_PENALTIES
from .torus import is_at_once, torus_bound
from .tree import changed, trees

BOUND_BITS = 256        # of the bound B; the thousands of bits of narrow cells do not improve it


def axes_of(claim, counts):
    """The axes of the symbols: of the parameters with a part that counts or that move x[1], then of
    the v that do; one at least."""
    moving = {2 + m for wave in claim.waves for m, part in enumerate(wave.parts) if counts(part)}
    moving |= {axis for axis, move in enumerate(claim.moves)
               if any(dot(row, move) for row in claim.rows)}
    return [axis for axis in (2, 3, 4, *ANGLE_AXES) if axis in moving] or [0]


class Criterion:
    """Everything that does not change from leaf to leaf."""

    def __init__(self, claim):
        parts = [part for part, _ in trees(claim)]
        self.take(claim)
        waves = self.reduced.waves
        widths = [x for part in parts for x in part.half if x] + [
            abs(g) for wave in waves for g in wave.parts if g]
        narrow = max([h.denominator.bit_length() - h.numerator.bit_length() for h in widths] + [0])
        bits = max([96] + [64 + narrow + part.counts["most_cuts"] for part in parts])
        if bits > MAX_BITS:
            raise NotConfirmed("numbers of %d bits are needed; the checker's limit is %d"
                               % (bits, MAX_BITS))
        self.fixed, self.coarse = fixed_of(bits), fixed_of(min(bits, BOUND_BITS))
        coarse = self.coarse
        one = self.fixed.one
        self.waves = in_units(self.fixed, waves)
        if max([abs(x) for wave in waves for x in (wave.middle, *wave.parts)] + [0]) >= one:
            raise NotConfirmed("the parameters are too large for this checker")     # l rounds to 0
        # The ends of the parameters: B of a cell is at most the interpolation of B at the ends.  An
        # end is off by less than a unit for each wave, and the eigenvalue by less than stiffness.
        corners = [tuple([math.floor(wave.at(t) * coarse.one) for wave in waves])
                   for t in itertools.product((-1, 1), repeat=claim.parameters)]
        apart = [(x,) for x in corners] if any(set("234") & set(part.tree) for part in parts) \
            else [tuple(corners)]
        units = in_units(coarse, waves)
        found = {ends: torus_bound(coarse, units, ends) + stiffness(units) << bits - coarse.bits
                 for ends in set(apart)} if waves else {}
        self.B_at = [found.get(ends, 2 * one + 1) for ends in apart]    # beta = 2 without waves
        self.B = max(self.B_at)
        if self.B <= 2 * one:
            # The tails of step (C2) must be square-summable, l < 1, which needs B > 2.
            raise NotConfirmed("beta has no eigenvalue above 2: the criterion does not apply")
        self.l_of = {}                      # by the cell's slices of the parameters
        self.fast = None                    # a Lockstep, where there is one

    def take(self, claim):
        self.claim, self.reduced = claim, claim.reduced
        self.axes = axes_of(self.reduced, bool)

    def of_part(self, part):
        """The criterion for a part of the claim, which has another x* and another region."""
        other = copy.copy(self)
        other.take(part)
        return other

    def least_pivot(self, cell):
        """l of step 2 for the parameters of the cell, from below.

        The largest eigenvalue is convex in the parameters, so between two ends it lies below the
        straight line, and over the cell below the largest value, at a corner of the cell, of the
        product of such lines.  l falls as B grows, so an upper bound of B, and of the divisor,
        make a lower bound of l; lesser l makes (C3) larger.
        """
        key = tuple(x[2:5] for x in cell)
        if key not in self.l_of:
            one, axes = self.fixed.one, len(self.B_at).bit_length() - 1
            B = 0
            for corner in itertools.product((0, 1), repeat=axes):
                values = self.B_at
                for i, k, upper in zip(*key, corner):       # the first axis is the slowest
                    half = len(values) // 2
                    values = [((1 << k) - i - upper) * low + (i + upper) * high
                              for low, high in zip(values[:half], values[half:])]
                B = max(B, -(-values[0] >> sum(key[1][:axes])))
            B = max(B, 2 * one + 1)
            l = 2 * one ** 2 // (B + upper_sqrt(B * B - (2 * one) ** 2))
            if l <= 0:
                # A lesser l only makes (C3) harder, but the witness needs 1/l.
                raise NotConfirmed("the parameters are too large for this checker")
            self.l_of[key] = l
        return self.l_of[key]

    def prism(self, cell):
        """The cell as a Prism that covers it.

        Its middle and half-widths are exact; amplitudes are rounded down by less than a unit, as
        are their parts, and so are their products with sines and cosines, which are within
        SINE_ERROR units.  x[1] is within 2 units, as angle() says, modulo turns: orbits that differ
        by 2 pi in x[1] differ by 2 pi j in x[j], and nothing else changes.  A column is off
        by 2 units for pi as often as it has it, and by one more; it is exact if it is zero.
        """
        (_, cuts), fixed, one, waves = cell, self.fixed, self.fixed.one, []
        for (k, phase), wave in zip(self.waves, self.reduced.waves):
            amplitude = math.floor(wave.over(cell)[0] * one)
            parts = [(i, math.floor(wave.parts[axis - 2] / (1 << cuts[axis]) * one))
                     for i, axis in enumerate(self.axes) if axis in (2, 3, 4)
                     and wave.parts[axis - 2]]
            size = abs(amplitude) + sum([abs(part) for _, part in parts])
            waves.append(PrismWave(k, phase, amplitude, parts,
                                   (size * SINE_ERROR >> fixed.bits) + 3 + 2 * len(parts)))
        xstar = [math.floor(x * one) for x in self.reduced.xstar]
        v, x, columns, error = self.reduced.box(cell), [], [], []
        for row in self.reduced.rows:
            sides = [dot(row, [along[axis] for _, along in v]) for axis in self.axes]
            x.append(fixed.angle(dot(row, [middle for middle, _ in v])))
            columns.append([math.floor(side * fixed.pi) for side in sides])
            error.append(2 + sum([2 * math.ceil(abs(side)) + 1 for side in sides if side]))
        return Prism(fixed, waves, xstar, (x, columns, error), len(self.axes))

    def attempt(self, l, cell, penalties):
        """Is (C3) true of the whole cell?  None if so, or else why not, and for each of its axes
        how much it matters, or None where halves would fail like it."""
        try:
            return attempt(self.prism(cell), l, penalties)
        except (OverflowError, ValueError, ZeroDivisionError):
            # A number too large, a singular matrix, a NaN: without a bound nothing is excluded.
            return "the arithmetic failed", [1.0 for _ in self.axes]

    def excluded(self, cell):
        """Does no minimizing orbit go from x* to the cell?  (None or else why not, pieces tried)"""
        l, todo, pieces = self.least_pivot(cell), [cell], 0
        while todo:
            piece = todo.pop()
            halved = [k - begun for k, begun in zip(piece[1], cell[1])]
            pieces += 1
            failed = self.attempt(l, piece, SITE_PENALTIES[sum(halved) % len(SITE_PENALTIES)])
            if not failed:
                continue
            why, blame = failed
            if blame is None or sum(halved) >= MAX_HALVINGS or pieces + len(todo) >= MAX_PIECES:
                return "%s (piece %d, halved %d times)" % (why, pieces, sum(halved)), pieces
            worst = self.axes[worst_axis(blame, [halved[a] for a in self.axes])]
            index, cuts = piece
            todo += [(changed(index, worst, 2 * index[worst] + upper),
                      changed(cuts, worst, cuts[worst] + 1)) for upper in (0, 1)]
        return None, pieces

    def at_once(self):
        """Is B > 10/3 for all parameters, or where that is claimed, at the upper end?"""
        waves = self.reduced.waves          # without which B is 2
        return bool(waves) and is_at_once(self.coarse, waves,
                                          (1,) if self.claim.at_once == "upper end" else None)


def check_at_once(criterion):
    """NotConfirmed, if larger parameters are claimed to be excluded at once, and it is not found
    that they are."""
    if criterion.claim.at_once != "no" and not criterion.at_once():
        raise NotConfirmed("that larger parameters are excluded at once (B > 10/3)")
