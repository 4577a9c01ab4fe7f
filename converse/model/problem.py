"""The problem: a map or a family of maps, and the region of successors that is searched."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import gcd
from typing import TYPE_CHECKING, List, Optional, Sequence, Tuple, Union

from ..storage.files import ConverseError, plain
from .exact import Ends, Number, decimal_text, integer, is_decimal, is_integer, outward, range_text
from .lattice import echelon
from .map import HIGHEST, PLACES, THESIS, Numbers, Range, SymplecticMap, ends_of, exact_of
from .potential import Term, Wave, sum_text

NAMES = ("a", "b", "c", "v0", "v1")
IDENTITY = 1, 0, 0, 1

Frame = Tuple[int, int, int, int]
Shifts = Tuple[Tuple[Fraction, Fraction], ...]         # of v0 and v1, by each parameter


class InputError(ConverseError, ValueError):
    """The input is not a problem; the text names the file, the line and the remedy."""


@dataclass(frozen=True, eq=False, repr=False)
class Problem:
    """A map, or a family of maps, and where the point x_1 that follows x* is looked for.

    Two problems are equal if their maps, regions and comments are equal, and the frames and the
    coordinates that are given or chosen.

    Parameters
    ----------
    map
        The map or the family.  Ends of its ranges that are not finite decimals, such as 4/3, are
        moved outwards to 40 places.
    v0, v1
        The ranges of the angles of x_1, in units of pi; by default they cover the torus, as a
        theorem needs.
    comments
        For the report and the proof file.  Control characters in them become escapes.
    axes
        The frame, x_1 = frame.(v0, v1), as (f00, f01, f10, f11).  By default, where v0 and v1 are
        all of the torus, the frame is chosen with the region that stands for the torus (region.py);
        else it is the identity.  `frame` has it.
    alone
        The coordinate that is examined alone, 0 or 1, or "no"; by default it is chosen.  `factor`
        has it.
    shifts
        For each parameter, the distances by which it moves v0 and v1 at its upper end, in units of
        pi.  At t the region is moved by sum of t[m] shifts[m].  Only the regions
        of further starting points move (`part`).

    Raises
    ------
    TypeError, ValueError
        An argument is not as described; the text names the argument and the reason.
    """

    map: SymplecticMap
    v0: Ends = (Fraction(0), Fraction(2))
    v1: Ends = (Fraction(0), Fraction(2))
    comments: Tuple[str, ...] = ()
    axes: Optional[Frame] = None
    alone: Union[int, str, None] = None
    shifts: Shifts = ()

    if TYPE_CHECKING:                   # the arguments; above are the values made of them
        def __init__(self, map: SymplecticMap, v0: Union[Range, Number] = (0, 2),
                     v1: Union[Range, Number] = (0, 2), comments: Union[str, Sequence[str]] = (),
                     axes: Optional[Frame] = None, alone: Union[int, str, None] = None,
                     shifts: Sequence[Sequence[Number]] = ()) -> None: ...

    def __post_init__(self) -> None:
        if not isinstance(self.map, SymplecticMap):
            raise TypeError("the map is a SymplecticMap, such as converse.StandardMap('0.9'), not "
                            "%.200r" % (self.map,))
        self.map.enclosed               # ValueError: an amplitude is not a finite decimal
        for name in NAMES[3:]:
            object.__setattr__(self, name, outward(*ends_of(name, getattr(self, name)), PLACES))
        comments = [self.comments] if isinstance(self.comments, str) else list(self.comments)
        if not all(isinstance(comment, str) for comment in comments):
            raise TypeError("comments are strings")
        object.__setattr__(self, "comments", tuple(
            plain(line) for comment in comments for line in (comment.splitlines() or [""])))
        self._check_choices()
        self._check_shifts()

    @classmethod
    def of(cls, source: "Union[SymplecticMap, Problem]") -> "Problem":
        """The problem, or the problem of a map and all of the torus.

        Parameters
        ----------
        source
            A problem, which is returned, or a map.

        Raises
        ------
        TypeError, ValueError
            The source is neither, or an amplitude of the map is not a finite decimal.
        """
        return source if isinstance(source, Problem) else cls(source)

    def part(self, region: Tuple[Ends, Ends], shifts: Shifts = ()) -> "Problem":
        """The same map with another region, in the same frame.

        Parameters
        ----------
        region
            The ranges of v0 and v1, in units of pi.
        shifts
            As for Problem.

        Returns
        -------
        Problem
            Without comments.

        Raises
        ------
        ValueError
            The region or the shifts are not as described.
        """
        return replace(self, v0=region[0], v1=region[1], axes=self.frame, shifts=shifts,
                       comments=())

    def tied(self) -> "Problem":
        """The problem whose parameters move together, from all lower to all upper ends.

        Returns
        -------
        Problem
            Of map.tied().

        Raises
        ------
        ValueError
            An amplitude is not a finite decimal.
        """
        return replace(self, map=self.map.tied())

    def _check_choices(self):
        """Checks the axes and alone."""
        if self.axes is not None:
            axes = tuple(self.axes)
            if len(axes) != 4 or not all(is_integer(f) and abs(f) <= HIGHEST for f in axes) or \
                    axes[0] * axes[3] == axes[1] * axes[2]:
                raise ValueError("the axes are four integers up to %d whose determinant is not 0, "
                                 "not %r" % (HIGHEST, self.axes))
            object.__setattr__(self, "axes", tuple(map(integer, axes)))
        if self.alone is not None:
            if self.alone not in (0, 1, "no") or isinstance(self.alone, bool):
                raise ValueError("alone is 0, 1 or 'no', not %r" % (self.alone,))
            if self.alone != "no" and self._best_alone() is None:
                raise ValueError("no coordinate stands alone: a wave depends on both, or all "
                                 "depend on one")

    def _check_shifts(self):
        """Checks that there is a pair for each parameter, or none."""
        shifts = exact_shifts(self.shifts)
        if self.shifts and len(self.shifts) != len(self.parts):
            raise ValueError("there are shifts by %d parameters for %d"
                             % (len(self.shifts), len(self.parts)))
        object.__setattr__(self, "shifts", shifts)

    def _key(self):
        return (self.map, self.v0, self.v1, self.comments, self.frame, self.factor,
                self.shifts and (self.shifts, self.map.patch))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Problem) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __repr__(self):
        ranges = ["%s=%s" % (name, range_text(*getattr(self, name))) for name in NAMES[3:]]
        if self.shifts:
            ranges.append("shifts=(%s)" % "; ".join(
                "%s %s" % tuple(map(decimal_text, pair)) for pair in self.shifts))
        return "<Problem: %s; %s>" % (self.map, ", ".join(ranges))

    # ---- the map as the core and a proof file take it: in finite decimals

    @property
    def waves(self) -> Tuple[Wave, ...]:
        """(k0, k1, phase in units of pi) of each wave."""
        return self.map.harmonics

    @property
    def amplitude(self) -> Numbers:
        """The amplitude of each wave, in the middle of the patch of parameters."""
        return self.map.enclosed[0]

    @property
    def parts(self) -> Tuple[Numbers, ...]:
        """For each parameter t[m] in [-1, 1] its contribution to each amplitude at t[m] = 1."""
        return self.map.enclosed[1]

    @cached_property
    def terms(self) -> Tuple[Term, ...]:
        """The waves with their amplitudes over the patch."""
        return tuple(Term((k0, k1), phase, p, tuple(parts)) for (k0, k1, phase), p, *parts in zip(
            self.waves, self.amplitude, *self.parts))

    @property
    def parameters(self) -> Tuple[Tuple[str, Fraction, Fraction], ...]:
        """The name of each parameter and its range, (name, low, high), in which reports state
        theorems; (): a, b and c where ranges of these describe the patch, else the t[m]."""
        if self.map.names == tuple("abc") and self.by_ranges:
            return ()
        return tuple((name, *outward(*ends, PLACES))
                     for name, ends in zip(self.map.names, self.map.ranges))

    @cached_property
    def abc(self) -> Optional[Tuple[Ends, ...]]:
        """The ranges of a, b and c, if these describe the patch: independent ranges, or ranges
        that are taken together; else None."""
        parts = self.parts
        if self.waves != tuple((*k, Fraction(0)) for k in THESIS) or len(parts) not in (1, 3):
            return None
        half = parts[0] if len(parts) == 1 else tuple(part[m] for m, part in enumerate(parts))
        if min(half) < 0 or len(parts) == 3 and any(
                part[j] for m, part in enumerate(parts) for j in range(3) if j != m):
            return None
        return tuple((p - h, p + h) for p, h in zip(self.amplitude, half))

    @property
    def by_ranges(self) -> bool:
        """Is the patch described by ranges of a, b and c, perhaps taken together?"""
        return self.abc is not None

    @property
    def together(self) -> bool:
        """Are there ranges of a, b and c that are taken together?"""
        return self.by_ranges and len(self.parts) == 1

    @cached_property
    def frame(self) -> Frame:
        """x_1 = (f[0] v0 + f[1] v1, f[2] v0 + f[3] v1)."""
        return self._best_frame() if self.axes is None else self.axes

    @cached_property
    def present(self) -> List[Tuple[Tuple[int, int], Fraction]]:
        """The waves that are nonzero somewhere in the patch: (k0, k1), and |p| in its middle."""
        return [(term.k, abs(term.p)) for term in self.terms if term.most]

    def _best_frame(self):
        """The frame where none is given.  If all waves depend on one q.y, which is not a
        coordinate, v0 moves along lines of constant q.y, and need not be cut.  The region of such a
        frame must be the whole torus."""
        directions = {(k0 // gcd(k0, k1), k1 // gcd(k0, k1)) for (k0, k1), _ in self.present}
        q = max(directions, default=(0, 0))
        if not directions <= {q, (-q[0], -q[1])} or 0 in q or not self.full_torus:
            return IDENTITY
        sign, (x, y) = (1 if q[1] > 0 else -1), bezout(*q)
        return sign * q[1], x, -sign * q[0], y  # of determinant sign q.(x, y)

    @cached_property
    def factor(self) -> Optional[int]:
        """The coordinate that is examined alone, without the waves that depend on the other one;
        None: both are examined.

        If no wave depends on both, the map is a product of two maps.  The second variation of test
        vectors (n, 0) is then the second variation of the first map."""
        if self.alone is None:
            return self._best_alone()
        return self.alone if isinstance(self.alone, int) else None

    def _best_alone(self):
        """The coordinate with the larger V'', or None where a wave depends on both."""
        bends = [sum(p * k[i] ** 2 for k, p in self.present) for i in range(2)]
        felt = {tuple(map(bool, k)) for k, _ in self.present}
        return int(bends[1] > bends[0]) if felt == {(True, False), (False, True)} else None

    @property
    def searched(self) -> Tuple[Term, ...]:
        """The waves that the search needs."""
        return tuple(term for term in self.terms
                     if self.factor is None or term.k[1 - self.factor] == 0)

    @cached_property
    def odd(self) -> Optional[Ends]:
        """A point s, in units of pi, about which V is odd; None: V is not odd about any point.

        For every wave k.s + phase is an integer.  Sums and differences of such conditions are such
        conditions.  So Euclid's algorithm replaces them by one for s1 alone, one with s0, and
        conditions on the phases alone."""
        pivots, rest = echelon([(Fraction(k0), Fraction(k1), phase)
                                for k0, k1, phase in self.waves], 2)
        s = [Fraction(0), Fraction(0)]
        if any(row[2].denominator != 1 for row in rest):
            return None
        for i, pivot in reversed(list(enumerate(pivots))):
            if pivot is not None:
                s[i] = -(pivot[2] + sum(pivot[m] * s[m] for m in range(i + 1, 2))) / pivot[i] % 1
        return s[0], s[1]

    @property
    def is_flat(self) -> bool:
        """Do the waves that the search needs depend on one combination of the angles?"""
        k = [wave for wave, _ in self.present]
        return self.factor is not None or all(a * d == b * c for a, b in k for c, d in k)

    # ---- ranges

    @property
    def centre(self) -> Numbers:
        """The middles of the amplitudes' ranges and of those of v0 and v1."""
        return self.amplitude + tuple((low + high) / 2 for low, high in (self.v0, self.v1))

    @property
    def half(self) -> Numbers:
        """The half-widths of the same ranges."""
        return (*(term.half for term in self.terms),
                *((high - low) / 2 for low, high in (self.v0, self.v1)))

    @property
    def full_torus(self) -> bool:
        """Does the region hold every possible successor?  (region.symmetries_used also sees where
        it need not.)"""
        return all(high - low >= period for (low, high), period
                   in zip((self.v0, self.v1), periods(self.axes or IDENTITY)))


def periods(frame: Frame) -> Tuple[Fraction, Fraction]:
    """P0 and P1, in units of pi: x_1 = frame.v is the same point of the torus where v is moved by
    (0, P1), and by (P0, some number)."""
    f00, f01, f10, f11 = frame
    common = gcd(f01, f11)
    return Fraction(2 * common, abs(f00 * f11 - f01 * f10)), Fraction(2, common)


def inverse(frame: Frame) -> Tuple[Tuple[Fraction, Fraction], ...]:
    """The rows of the inverse of a frame."""
    a, b, c, d = frame
    determinant = Fraction(a * d - b * c)
    return (d / determinant, -b / determinant), (-c / determinant, a / determinant)


def bezout(a: int, b: int) -> Tuple[int, int]:
    """(x, y) with a x + b y = 1, where there are such integers."""
    if b == 0:
        return a, 0
    x, y = bezout(b, a % b)
    return y, x - a // b * y


def exact_shifts(shifts: Sequence[Sequence[Number]]) -> Shifts:
    """Exact pairs, () if all of them are 0.  TypeError, ValueError: these are not shifts."""
    try:
        given = [tuple(pair) for pair in shifts]
    except TypeError:
        raise TypeError("shifts are pairs of numbers") from None
    pairs = []
    for pair in given:
        if len(pair) != 2:
            raise ValueError("the shifts by a parameter are of v0 and v1, not %d numbers"
                             % len(pair))
        s0, s1 = (exact_of("a shift", x) for x in pair)
        for x in s0, s1:
            if not is_decimal(x):
                raise ValueError("a shift: %s is not a finite decimal" % x)
        pairs.append((s0, s1))
    return tuple(pairs) if any(map(any, pairs)) else ()


def frame_text(frame, name):
    """The angles that belong to v0 and v1, whose names are name % 0 and name % 1."""
    names = name % 0, name % 1
    return "(%s, %s)" % (sum_text(zip(frame[:2], names)), sum_text(zip(frame[2:], names)))
