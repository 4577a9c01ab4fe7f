"""The criterion (C3) on the leaves of one claim, in integers."""

import collections
import itertools
import math
from fractions import Fraction

from .arith import Fixed, in_units, stiffness, upper_sqrt
from .failures import NotConfirmed, Rejected
from .limits import LAG, MAX_BITS, MAX_HALVINGS, MAX_PIECES
from .taylor import MAX_POINTS, PARAMETERS, SYMBOLS, Point, second_variation, step, witness
from .torus import is_at_once, torus_bound
from .tree import changed


class Criterion:
    """Everything that does not change from leaf to leaf."""

    def __init__(self, claim, bound=None):
        """bound: of B, exact, if it is known."""
        widths = [x for x in claim.half if x] + [abs(g) for wave in claim.examined
                                                 for g in wave.parts if g]
        narrow = max([h.denominator.bit_length() - h.numerator.bit_length() for h in widths] + [0])
        bits = max(96, 64 + narrow + claim.counts["most_cuts"])
        if bits > MAX_BITS:
            raise NotConfirmed("numbers of %d bits are needed; the checker's limit is %d"
                               % (bits, MAX_BITS))
        self.claim, self.fixed = claim, Fixed.of(bits)
        one, waves = self.fixed.one, claim.examined
        self.waves = in_units(self.fixed, waves)
        self.amplitudes = [(math.floor(wave.middle * one), [math.floor(g * one)
                                                            for g in wave.parts]) for wave in waves]
        if max([abs(x) for p, parts in self.amplitudes for x in (p, *parts)] + [0]) >> 2 * bits:
            raise NotConfirmed("the parameters are too large for this checker")     # l has no digit
        self.xstar = tuple([math.floor(x * one) for x in claim.xstar])
        # Orbits that differ by 2 pi in x[1] differ by 2 pi j in x[j]: nothing else changes.
        self.region = [(math.floor(c % 2 * self.fixed.pi), math.floor(h * self.fixed.pi),
                        4 * math.ceil(h) + 10) for c, h in zip(claim.centre, claim.half)]
        # The ends of the parameters: a cell's B is no larger than what lies between B there.  An
        # end is off by less than a unit for each wave, and the eigenvalue by less than stiffness.
        if bound is not None:
            self.B_at = [math.ceil(bound * one)]
        else:
            corners = [tuple([math.floor(wave.at(t) * one) for wave in waves])
                       for t in itertools.product((-1, 1), repeat=claim.parameters)]
            apart = [[x] for x in corners] if set("234") & set(claim.tree) else [corners]
            found = {}
            for ends in map(tuple, apart):
                if ends not in found:
                    found[ends] = torus_bound(self.fixed, self.waves, ends) + stiffness(self.waves)
            self.B_at = [found[tuple(ends)] for ends in apart]
        self.B = max(self.B_at)
        if self.B <= 2 * one:
            # The tails of step 2 must be square-summable, l < 1, which needs B > 2.  (The mean of
            # beta over the torus is 2I, so this would say that there are no parameters.)
            raise NotConfirmed("beta has no eigenvalue above 2: the criterion does not apply")
        self.l_of = {}                      # by the cell's slices of the parameters
        self.fast = None                    # a Lockstep, where there is one

    def least_pivot(self, cell):
        """l of step 2 for the parameters of the cell, from below.

        The largest eigenvalue is convex in the parameters, so between two ends it lies below the
        straight line, and over the cell below the largest value, at a corner of the cell, of the
        product of such lines.  l falls as B grows, so an upper bound of B, and of the divisor,
        make a lower bound of l; lesser l makes (C3) larger.
        """
        key = tuple(x[2:] for x in cell)
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
                # Harmless, since a lesser l only makes (C3) harder; but the witness needs 1/l, and
                # no theorem is wanted from numbers that have lost all their digits.
                raise NotConfirmed("the parameters are too large for this checker")
            self.l_of[key] = l
        return self.l_of[key]

    def least_in_double(self, cell):
        """l from below as a double: the quotient is rounded to nearest, the rest lowers it."""
        return self.least_pivot(cell) / self.fixed.one * (1 - 2.0 ** -50)

    def piece(self, cell):
        """The cell as a piece that covers it: of each wave the middle and the parts of its
        amplitude, then centres and half-widths of v0 and v1.

        An angle: the centre c + h (2i + 1 - 2^k) / 2^k and the half-width h / 2^k, in units of pi:
        pi is off by 2 units and c mod 2 below 2, so with the floors 4 h + 10 units are enough.
        An amplitude is followed along its symbols to within 10 units (a floor of the middle, and
        for each part one of itself and one of each of its shifts), and each halving of the piece
        may add one: PARAMETER_ERROR.
        """
        index, cuts = cell
        amplitudes = []
        for p, parts in self.amplitudes:
            for g, i, k in zip(parts, index[2:], cuts[2:]):
                p += g * (2 * i + 1 - (1 << k)) >> k
            amplitudes.append((p, [g >> k for g, k in zip(parts, cuts[2:])]))
        sides = [(c + (h * (2 * i + 1 - (1 << k)) >> k), (h >> k) + e)
                 for (c, h, e), i, k in zip(self.region, index, cuts)]
        return amplitudes, sides

    def ends(self, piece):
        """x[0] and x[1] of a piece, as Points."""
        amplitudes, ((c0, h0), (c1, h1)) = piece
        f0, f1, f2, f3 = self.claim.frame
        none = [0] * PARAMETERS
        return (Point(self.fixed, self.waves, amplitudes, self.xstar,
                      (none + [0, 0, 1, 0], none + [0, 0, 0, 1])),
                Point(self.fixed, self.waves, amplitudes, (f0 * c0 + f1 * c1, f2 * c0 + f3 * c1),
                      (none + [f0 * h0, f1 * h1, 0, 0], none + [f2 * h0, f3 * h1, 0, 0])))

    def attempt(self, l, piece):
        """Is (C3) true of the whole piece?  None if so, or else why not, and where to halve it."""
        try:
            return self._follow(l, piece)
        except (OverflowError, ValueError, ZeroDivisionError):
            # An angle or a double too large, a singular pivot, a NaN: no bound was established,
            # and an attempt that establishes none excludes nothing.
            return "the arithmetic failed", [0] * PARAMETERS + [h for _, h in piece[1]]

    def _follow(self, l, piece):
        """Lengthens the orbit at the end that is better known until (C3) is true or all is lost.

        (C3) is tried each time the orbit has grown by a twelfth, and in the end.
        """
        fixed, waves, amplitudes = self.fixed, self.waves, piece[0]
        first, second = self.ends(piece)
        why, columns = None, [0] * PARAMETERS + [h for _, h in piece[1]]
        orbit = collections.deque()
        point, ahead, due, known = first, True, 1, SYMBOLS

        def reach(point):
            return max(point.reach, default=0)

        while point:
            (orbit.append if ahead else orbit.appendleft)(point)
            if len(orbit) == 1:
                point = second
            else:
                ahead = reach(orbit[-1]) < reach(orbit[0])
                ends = (orbit[-1], orbit[-2]) if ahead else (orbit[0], orbit[1])
                point = step(fixed, waves, amplitudes, *ends, known)
                known = len(point.rows[0])
            if reach(point) > fixed.one or len(orbit) == MAX_POINTS:
                point = None
            if point and len(orbit) < due:
                continue
            due = len(orbit) + 1 + len(orbit) // 12
            vectors = witness([point.beta for point in orbit], l / fixed.one)
            if vectors:
                bound, columns = second_variation(fixed, waves, l, orbit, vectors)
                if bound < 0:
                    return None
                why = "its second variation may be positive"
        # What moves the ends matters, if little: when it is halved, the orbit may go on.
        columns = [abs(x) + sum([abs(k0 * p.rows[0][m] + k1 * p.rows[1][m])
                                 for p in (orbit[0], orbit[-1], second) for k0, k1, _ in waves])
                   for m, x in enumerate(columns[:PARAMETERS + 2])]
        return why or "the orbit of its centre contradicts nothing over %d points, %s" % (
            len(orbit), "the most that are followed" if len(orbit) == MAX_POINTS else
            "beyond which it is too uncertain"), columns

    @staticmethod
    def halves(piece, worst):
        """The halves of a piece along a symbol: of a parameter, which moves the amplitudes of many
        waves, or of an angle."""
        amplitudes, sides = piece

        def half(centre, halves, at, sign):
            step = [h + 1 >> 1 if k == at else 0 for k, h in enumerate(halves)]
            return centre + sign * sum(step), [s if k == at else h for k, (h, s)
                                               in enumerate(zip(halves, step))]

        found = []
        for sign in (1, -1):
            angles = [half(c, [h], worst - PARAMETERS - i, sign) for i, (c, h) in enumerate(sides)]
            found.append(([half(p, parts, worst, sign) for p, parts in amplitudes],
                          [(c, h) for c, (h,) in angles]))
        return found

    def excluded(self, cell):
        """Does no minimizing orbit go from x* to the cell?  (None or else why not, pieces tried)"""
        l, todo, pieces = self.least_pivot(cell), [(self.piece(cell), (0,) * 5)], 0
        while todo:
            piece, halved = todo.pop()
            pieces += 1
            failed = self.attempt(l, piece)
            if not failed:
                continue
            if sum(halved) >= MAX_HALVINGS or pieces + len(todo) >= MAX_PIECES:
                return "%s (piece %d, halved %d times)" % (failed[0], pieces, sum(halved)), pieces
            # Along what matters most, but no symbol that matters is left behind for long.
            blame = failed[1]
            worst = max(range(len(blame)), key=blame.__getitem__)
            last = min((k for k, x in enumerate(blame) if x or k == worst), key=halved.__getitem__)
            if halved[worst] - halved[last] > LAG:
                worst = last
            now = changed(halved, worst, halved[worst] + 1)
            todo += [(half, now) for half in self.halves(piece, worst)]
        return None, pieces

    def at_once(self):
        """Is B > 10/3 for all parameters, or where that is claimed, at the upper end?"""
        return is_at_once(self.fixed, self.claim.examined,
                          (1,) if self.claim.at_once == "upper end" else None)

    def not_at_once(self):
        """Is B <= 10/3 for some of these parameters?  Those nearest to 0 are tried, about."""
        waves, t = self.claim.examined, [Fraction(0)] * self.claim.parameters
        for m in list(range(len(t))) * 4:
            square = sum([wave.parts[m] ** 2 for wave in waves])
            slope = sum([wave.parts[m] * wave.at(t) for wave in waves])
            if square:
                t[m] = min(max(t[m] - slope / square, Fraction(-1)), Fraction(1))
                t[m] = Fraction(math.floor(t[m] * 2 ** 60), 2 ** 60)
        if self.claim.at_once == "upper end":
            t = (1,)
        nearest = tuple([math.floor(wave.at(t) * self.fixed.one) for wave in waves])
        return 3 * (torus_bound(self.fixed, self.waves, [nearest])
                    + stiffness(self.waves)) <= 10 * self.fixed.one


def check_at_once(criterion):
    """Rejected or NotConfirmed, if larger parameters are claimed to be excluded at once, and are
    not."""
    if criterion.claim.at_once != "no" and not criterion.at_once():
        if criterion.not_at_once():
            raise Rejected("larger parameters are not excluded at once: B <= 10/3 for some")
        raise NotConfirmed("that larger parameters are excluded at once (B > 10/3)")
