"""The problem: a map or a family of maps, and the region of successors that is searched."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from math import gcd, isqrt
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from ..storage.files import ConverseError, plain
from .exact import Ends, Number, decimal_text, integer, is_decimal, is_integer, outward, range_text
from .lattice import basis_along, determinant, echelon
from .map import HIGHEST, PLACES, THESIS, Numbers, Range, SymplecticMap, ends_of, exact_of
from .potential import Term, Wave, sum_text

ANGLES = "v0", "v1", "v2"
IDENTITY = 1, 0, 0, 1                   # the frame of two angles that changes nothing
WHOLE = Fraction(0), Fraction(2)        # of an angle, in units of pi

Frame = Tuple[int, ...]                 # a square matrix, row by row
Matrix = Sequence[Sequence[Fraction]]
Shifts = Tuple[Numbers, ...]            # of v0, v1, ..., by each parameter


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
    v0, v1, v2
        The ranges of the angles of x_1, in units of pi; by default they cover the torus, as a
        theorem needs.  Only a map of three angles has v2.
    comments
        For the report and the proof file.  Control characters in them become escapes.
    axes
        The frame, x_1 = frame.(v0, v1), as (f00, f01, f10, f11); of three angles nine integers.
        By default, where the region is all of the torus, the frame is chosen with the region that
        stands for the torus (region.py); else it is the identity.  `frame` has it.
    alone
        The coordinate that is examined alone, 0 or 1, or "no"; by default it is chosen.  `factor`
        has it.  Of three angles none is.
    shifts
        For each parameter, the distances by which it moves the angles of the region at its upper
        end, in units of pi.  At t the region is moved by sum of t[m] shifts[m].  Only the regions
        of further starting points move (`part`).

    Raises
    ------
    TypeError, ValueError
        An argument is not as described; the text names the argument and the reason.
    """

    map: SymplecticMap
    v0: Ends = WHOLE
    v1: Ends = WHOLE
    comments: Tuple[str, ...] = ()
    axes: Optional[Frame] = None
    alone: Union[int, str, None] = None
    shifts: Shifts = ()
    v2: Ends = WHOLE

    if TYPE_CHECKING:                   # the arguments; above are the values made of them
        def __init__(self, map: SymplecticMap, v0: Union[Range, Number] = (0, 2),
                     v1: Union[Range, Number] = (0, 2), comments: Union[str, Sequence[str]] = (),
                     axes: Optional[Frame] = None, alone: Union[int, str, None] = None,
                     shifts: Sequence[Sequence[Number]] = (),
                     v2: Union[Range, Number] = (0, 2)) -> None: ...

    def __post_init__(self) -> None:
        if not isinstance(self.map, SymplecticMap):
            raise TypeError("the map is a SymplecticMap, such as converse.StandardMap('0.9'), not "
                            "%.200r" % (self.map,))
        self.map.enclosed               # ValueError: an amplitude is not a finite decimal
        for name in ANGLES:
            object.__setattr__(self, name, outward(*ends_of(name, getattr(self, name)), PLACES))
        if self.size == 2 and self.v2 != WHOLE:
            raise ValueError("v2 is given, and no wave depends on a third angle; leave v2 out")
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

    def part(self, region: Sequence[Ends], shifts: Shifts = ()) -> "Problem":
        """The same map with another region, in the same frame.

        Parameters
        ----------
        region
            The ranges of v0, v1, ..., in units of pi.
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
        return replace(self, **ranges(region), axes=self.frame, shifts=shifts, comments=())

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
            if len(axes) != self.size ** 2 or \
                    not all(is_integer(f) and abs(f) <= HIGHEST for f in axes) or \
                    not determinant(rows(axes)):
                raise ValueError("the axes are %s integers up to %d whose determinant is not 0, "
                                 "not %r" % ({2: "four", 3: "nine"}[self.size], HIGHEST,
                                             self.axes))
            object.__setattr__(self, "axes", tuple(map(integer, axes)))
        if self.alone is not None:
            if self.alone not in (0, 1, "no") or isinstance(self.alone, bool):
                raise ValueError("alone is 0, 1 or 'no', not %r" % (self.alone,))
            if self.alone != "no" and self._best_alone() is None:
                raise ValueError("no coordinate stands alone: a wave depends on both, or all "
                                 "depend on one")

    def _check_shifts(self):
        """Checks that there are distances for each parameter, or none."""
        try:
            shifts = tuple(tuple(exact_of("a shift", x) for x in by) for by in self.shifts)
        except TypeError as error:
            raise TypeError("shifts are pairs of numbers, or triples of three angles (%s)"
                            % error) from None
        if shifts and len(shifts) != len(self.parts):
            raise ValueError("there are shifts by %d parameters for %d"
                             % (len(shifts), len(self.parts)))
        for distances in shifts:
            if len(distances) != self.size:
                raise ValueError("the shifts by a parameter are of %s, not %d numbers"
                                 % (" and ".join(ANGLES[:self.size]), len(distances)))
            for x in distances:
                if not is_decimal(x):
                    raise ValueError("a shift: %s is not a finite decimal" % x)
        object.__setattr__(self, "shifts", shifts if any(map(any, shifts)) else ())

    def _key(self):
        return (self.map, self.region, self.comments, self.frame, self.factor,
                self.shifts and (self.shifts, self.map.patch))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Problem) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __repr__(self):
        ranges = ["%s=%s" % (name, range_text(*ends)) for name, ends in zip(ANGLES, self.region)]
        if self.shifts:
            ranges.append("shifts=(%s)" % "; ".join(
                " ".join(map(decimal_text, distances)) for distances in self.shifts))
        return "<Problem: %s; %s>" % (self.map, ", ".join(ranges))

    # ---- the map as the core and a proof file take it: in finite decimals

    @property
    def size(self) -> int:
        """The number of coordinates that k, x* and the region have: 2, or 3 of three angles."""
        return max(2, self.map.dimension)

    @property
    def waves(self) -> Tuple[Wave, ...]:
        """(k0, k1, phase in units of pi) of each wave, or (k0, k1, k2, phase)."""
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
        return tuple(Term(tuple(k), phase, p, tuple(parts)) for (*k, phase), p, *parts in zip(
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
        """x_1 = (f[0] v0 + f[1] v1, f[2] v0 + f[3] v1), or the same with three angles."""
        return self._best_frame() if self.axes is None else self.axes

    @cached_property
    def present(self) -> List[Tuple[Tuple[int, ...], Fraction]]:
        """The waves that are nonzero somewhere in the patch: k, and |p| in its middle."""
        return [(term.k, abs(term.p)) for term in self.terms if term.most]

    def _best_frame(self):
        """The frame where none is given.  If all waves depend on one q.y, which is not a
        coordinate, only the last of v0, v1, ... moves q.y, and the others need not be cut.  The
        region of such a frame must be the whole torus."""
        directions = {tuple(x // gcd(*k) for x in k) for k, _ in self.present}
        q = max(directions, default=())
        if not directions <= {q, tuple(-x for x in q)} or sum(map(bool, q)) < 2 or \
                not self.full_torus:
            return identity(self.size)
        return tuple(x for row in zip(*basis_along(q)) for x in row)

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
        """The coordinate with the larger V'', or None where a wave depends on both, and of three
        angles."""
        bends = [sum(p * k[i] ** 2 for k, p in self.present) for i in range(2)]
        felt = {tuple(map(bool, k)) for k, _ in self.present}
        return int(bends[1] > bends[0]) if felt == {(True, False), (False, True)} else None

    @property
    def searched(self) -> Tuple[Term, ...]:
        """The waves that the search needs."""
        return tuple(term for term in self.terms
                     if self.factor is None or term.k[1 - self.factor] == 0)

    @cached_property
    def odd(self) -> Optional[Numbers]:
        """A point s, in units of pi, about which V is odd; None: V is not odd about any point.

        For every wave k.s + phase is an integer.  Sums and differences of such conditions are such
        conditions.  So Euclid's algorithm replaces them by one for the last coordinate alone, one
        with that before it, and so on, and conditions on the phases alone."""
        pivots, rest = echelon([tuple(map(Fraction, wave)) for wave in self.waves], self.size)
        s = [Fraction(0)] * self.size
        if any(row[-1].denominator != 1 for row in rest):
            return None
        for i, pivot in reversed(list(enumerate(pivots))):
            if pivot is not None:
                s[i] = -(pivot[-1] + sum(a * b for a, b in zip(pivot[i + 1:], s[i + 1:]))) \
                    / pivot[i] % 1
        return tuple(s)

    @property
    def is_flat(self) -> bool:
        """Do the waves that the search needs depend on one combination of the angles?"""
        pivots, _ = echelon([k for k, _ in self.present], self.size)
        return self.factor is not None or len(list(filter(None, pivots))) < 2

    # ---- ranges

    @property
    def region(self) -> Tuple[Ends, ...]:
        """The ranges of v0, v1, ..., in units of pi."""
        return (self.v0, self.v1, self.v2)[:self.size]

    @property
    def centre(self) -> Numbers:
        """The middles of the amplitudes' ranges and of those of the region."""
        return self.amplitude + tuple((low + high) / 2 for low, high in self.region)

    @property
    def half(self) -> Numbers:
        """The half-widths of the same ranges."""
        return (*(term.half for term in self.terms),
                *((high - low) / 2 for low, high in self.region))

    @property
    def full_torus(self) -> bool:
        """Does the region hold every possible successor?  (region.symmetries_used also sees where
        it need not.)"""
        return all(high - low >= period for (low, high), period
                   in zip(self.region, periods(self.axes or identity(self.size))))


def ranges(region: Iterable[Ends]) -> Dict[str, Any]:
    """The arguments of Problem that a region makes."""
    return dict(zip(ANGLES, region))


def identity(n: int) -> Frame:
    """The frame of n angles that changes nothing."""
    return tuple(int(i == j) for i in range(n) for j in range(n))


def rows(frame: Frame) -> Tuple[Tuple[int, ...], ...]:
    """The rows of a frame."""
    n = isqrt(len(frame))
    return tuple(frame[i:i + n] for i in range(0, n * n, n))


def inverse(frame: Frame) -> Matrix:
    """The rows of the inverse of a frame."""
    matrix, size = rows(frame), determinant(rows(frame))
    return tuple(tuple(
        Fraction((-1) ** (i + j) * determinant([row[:i] + row[i + 1:] for m, row in
                                                enumerate(matrix) if m != j]), size)
        for j in range(len(matrix))) for i in range(len(matrix)))


@lru_cache(64)
def moves(frame: Frame) -> List[Any]:
    """Vectors that generate those, in units of pi, by which v may be moved: x_1 = frame.v stays the
    same point of the torus.  Of each the components before the i-th are 0, i = 0, 1, ..."""
    pivots, _ = echelon([[2 * x for x in column] for column in zip(*inverse(frame))],
                        isqrt(len(frame)))
    return pivots


def periods(frame: Frame) -> Numbers:
    """P0, P1, ..., in units of pi: x_1 = frame.v is the same point of the torus where the last of
    v0, v1, ... is moved by its period, and each other one with some move of those after it."""
    return tuple(abs(move[i]) for i, move in enumerate(moves(frame)))


def frame_text(frame, name):
    """The angles that belong to v0, v1, ..., whose names are name % 0, name % 1, ..."""
    return "(%s)" % ", ".join(sum_text((f, name % i) for i, f in enumerate(row))
                              for row in rows(frame))
