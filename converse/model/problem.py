"""The problem: a potential, the patch of parameters it has, and the angles of a successor."""

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import gcd
from typing import TYPE_CHECKING, Optional, Sequence, Tuple, Union

from .exact import Ends, Number, decimal_text, exact, is_decimal, outward, range_text
from .lattice import echelon
from .potential import Wave, sum_text

NAMES = ("a", "b", "c", "v0", "v1")
PLACES = 40                             # to which what is no finite decimal is enclosed
THESIS = (1, 0), (0, 1), (1, 1)         # the waves of a, b and c
# The thesis's line is a = b = c/2 = LINE epsilon: this decimal defines epsilon here.  The thesis's
# own constant is 2 pi^2/M = 11.2143598191..., M = sqrt(207 + 33 sqrt 33)/(8 sqrt 2), which
# converse.orbits has.
LINE = Fraction("11.21436")
MOST_WAVES, MOST_PARAMETERS, HIGHEST = 16, 3, 100       # the last: of k and of a frame
IDENTITY = 1, 0, 0, 1

Range = Tuple[Number, Number]           # what becomes of it: Ends
Frame = Tuple[int, int, int, int]
Numbers = Tuple[Fraction, ...]
Shifts = Tuple[Tuple[Fraction, Fraction], ...]         # of v0 and v1, by each parameter
Parameter = Tuple[str, Fraction, Fraction]              # name, lower and upper end


class InputError(ValueError):
    """The input is not a problem; the text names the file, the line and the remedy."""


@dataclass(frozen=True, repr=False)
class Problem:
    """Five ranges (low, high): of the parameters a, b and c, and of the angles v0 and v1 of the
    point x_1 that follows x*, in units of pi.

        Problem(a=("0.3072", "0.3097"), b=("0.3072", "0.3097"), c=("0.6145", "0.6195"))

    A number is an int, a Decimal, a Fraction, or a string such as "0.3085", "1.25e-3" or "63/64";
    never a float, which is seldom the number that was meant.  One number alone is a range without
    width.  What is no finite decimal, such as 4/3, is enclosed to 40 places.  By default the angles
    cover the torus, as a theorem needs.

    together: a, b and c move together, along the segment from all lower to all upper ends.

    Problem.patch takes other potentials, and any patch of parameters.  In every problem

        V(y) = - sum of p[j] sin(k[j].y + phi[j]),   p = amplitude + sum of t[m] parts[m],

    -1 <= t[m] <= 1, the wave j being (k0, k1, phi / pi): three ranges are three parameters t[m],
    ranges taken together are one.

    by_ranges: whether ranges of a, b and c describe the patch; if not, these are None.
    axes: the frame, x_1 = frame.(v0, v1), as (f00, f01, f10, f11); None: where v0 and v1 are all of
    the torus, chosen, with the region that stands for it (region.py); else the identity.  Axes that
    would be chosen anyhow become None; `axes_named` tells that there were some.
    alone: the coordinate that is examined alone, 0 or 1, or "no"; None: chosen.  `factor` has it.
    parameters: the name of each parameter and its range, (name, low, high), in which reports state
    theorems; (): a, b and c where ranges of these describe the patch, else the t[m].
    shifts: of each parameter, by how much it moves v0 and v1 at its upper end, in units of pi: the
    region of t is that of v0 and v1, moved by sum of t[m] shifts[m].  (): none.  Only regions of
    parts have some (links.part_problem); no input, and no proof as a whole.

    TypeError, ValueError: an argument is not what it must be; the text says which, and why.
    """

    a: Optional[Ends] = None
    b: Optional[Ends] = None
    c: Optional[Ends] = None
    v0: Ends = (Fraction(0), Fraction(2))
    v1: Ends = (Fraction(0), Fraction(2))
    comments: Tuple[str, ...] = ()
    together: bool = False
    _patch: Optional[Tuple[Tuple[Wave, ...], Numbers, Tuple[Numbers, ...]]] = None
    axes: Optional[Frame] = None
    alone: Union[int, str, None] = None
    shifts: Shifts = ()
    parameters: Tuple[Parameter, ...] = field(default=(), compare=False)
    axes_named: bool = field(default=False, init=False, compare=False)

    if TYPE_CHECKING:                   # what is given; above is what becomes of it
        def __init__(self, a: Union[Range, Number, None] = None,
                     b: Union[Range, Number, None] = None, c: Union[Range, Number, None] = None,
                     v0: Union[Range, Number] = (0, 2), v1: Union[Range, Number] = (0, 2),
                     comments: Union[str, Sequence[str]] = (), together: bool = False,
                     _patch: Optional[tuple] = None, axes: Optional[Frame] = None,
                     alone: Union[int, str, None] = None,
                     shifts: Sequence[Sequence[Number]] = (),
                     parameters: Sequence[Parameter] = ()) -> None: ...

    def __post_init__(self) -> None:
        for name in NAMES if self.by_ranges else NAMES[3:]:
            object.__setattr__(self, name, interval(name, getattr(self, name)))
        if not isinstance(self.together, bool):
            raise TypeError("together must be True or False, not %r" % (self.together,))
        comments = [self.comments] if isinstance(self.comments, str) else list(self.comments)
        if not all(isinstance(comment, str) for comment in comments):
            raise TypeError("comments are strings")
        object.__setattr__(self, "comments", tuple(
            line.encode("utf-8", "backslashreplace").decode("utf-8")
            for comment in comments for line in (comment.splitlines() or [""])))
        if not self.by_ranges:
            if self.together or (self.a, self.b, self.c) != (None,) * 3:
                raise ValueError("a, b, c and together do not go with a patch")
            self._normalize()
        self._check_choices()
        self._check_shifts()
        self._check_parameters()

    @classmethod
    def around(cls, centre: Sequence[Number], half: Sequence[Number],
               comments: Union[str, Sequence[str]] = (), together: bool = False) -> "Problem":
        """From the centres and the half-widths of a, b, c, v0 and v1, as in an input file."""
        if not len(centre) == len(half) == len(NAMES):
            raise ValueError("there are %d centres and %d half-widths where five belong: of a, b, "
                             "c, v0 and v1" % (len(centre), len(half)))
        pairs = [(exact(c), exact(h)) for c, h in zip(centre, half)]
        for name, (_, h) in zip(NAMES, pairs):
            if h < 0:
                raise ValueError("the half-width of %s is negative" % name)
        a, b, c, v0, v1 = [(middle - h, middle + h) for middle, h in pairs]
        return cls(a, b, c, v0, v1, comments, together)

    @classmethod
    def patch(cls, amplitude: Sequence[Number], parts: Sequence[Sequence[Number]] = (),
              waves: Sequence[tuple] = THESIS, v0: Union[Range, Number] = (0, 2),
              v1: Union[Range, Number] = (0, 2), comments: Union[str, Sequence[str]] = (),
              axes: Optional[Frame] = None, alone: Union[int, str, None] = None,
              parameters: Sequence[Parameter] = ()) -> "Problem":
        """A patch of the parameters of a potential:  amplitude + sum of t[m] parts[m],  each t[m]
        in [-1, 1].

            Problem.patch(["0.4", "0.35", 0], [["0.01", 0, 0], ["0.01", "0.02", 0]])

        amplitude: of each wave, in the middle of the patch, a finite decimal.
        parts: for each parameter, of which there are 3 at most, what it adds to each amplitude at
        its upper end.
        waves: at most 16 of (k0, k1) or (k0, k1, phase), k integer and up to 100, the phase exact
        and in units of pi; by default those of a, b and c.  On the circle k1 is 0.

        A patch that three ranges of a, b and c, or these together, can describe is that Problem.
        """
        return cls(None, None, None, v0, v1, comments, False, _checked(waves, amplitude, parts),
                   axes, alone, parameters=parameters)

    def _normalize(self):
        """What a, b and c can say is said by them: one problem, one Problem."""
        waves, amplitude, parts = _checked(*self._patch)
        object.__setattr__(self, "_patch", (waves, amplitude, parts))
        if waves != tuple((*k, Fraction(0)) for k in THESIS):
            return
        if len(parts) == 1:
            half = parts[0]
        elif parts and len(parts) < 3 or any(part[j] for m, part in enumerate(parts)
                                             for j in range(3) if j != m):
            return
        else:
            half = tuple(part[m] for m, part in enumerate(parts)) or (Fraction(0),) * 3
        if min(half) < 0:
            return
        for name, p, h in zip("abc", amplitude, half):
            object.__setattr__(self, name, (p - h, p + h))
        object.__setattr__(self, "together", len(parts) == 1)
        object.__setattr__(self, "_patch", None)

    def _check_choices(self):
        """Sees that axes and alone make sense; None where they say what would be chosen anyhow."""
        if self.axes is not None:
            axes = tuple(self.axes)
            if len(axes) != 4 or not all(type(f) is int and abs(f) <= HIGHEST for f in axes) or \
                    axes[0] * axes[3] == axes[1] * axes[2]:
                raise ValueError("the axes are four integers up to %d whose determinant is not 0, "
                                 "not %r" % (HIGHEST, self.axes))
            object.__setattr__(self, "axes", None if axes == self._best_frame() else axes)
            object.__setattr__(self, "axes_named", True)
        if self.alone is not None:
            if self.alone not in (0, 1, "no") or isinstance(self.alone, bool):
                raise ValueError("alone is 0, 1 or 'no', not %r" % (self.alone,))
            if self.alone != "no" and self._best_alone() is None:
                raise ValueError("no coordinate stands alone: a wave feels both, or all feel one")
            if self.alone == ("no" if self._best_alone() is None else self._best_alone()):
                object.__setattr__(self, "alone", None)

    def _check_shifts(self):
        """A pair for each parameter, or none."""
        shifts = exact_shifts(self.shifts)
        if self.shifts and len(self.shifts) != len(self.parts):
            raise ValueError("there are shifts by %d parameters for %d"
                             % (len(self.shifts), len(self.parts)))
        object.__setattr__(self, "shifts", shifts)

    def _check_parameters(self):
        """A name and a range for each parameter, or none."""
        if self.parameters and len(self.parameters) != len(self.parts):
            raise ValueError("there are names of %d parameters for %d"
                             % (len(self.parameters), len(self.parts)))
        for (name, low, high), part in zip(self.parameters, self.parts):
            if low > high or low == high and any(part):
                raise ValueError("the range of %.40s goes from %s to %s" % (name, low, high))
        object.__setattr__(self, "parameters", tuple(self.parameters))

    def __repr__(self):
        ranges = ["%s=%s" % (name, range_text(*getattr(self, name))) for name in NAMES
                  if getattr(self, name) is not None]
        if self.shifts:
            ranges.append("shifts=(%s)" % "; ".join(
                "%s %s" % tuple(map(decimal_text, pair)) for pair in self.shifts))
        if self.by_ranges:
            return "Problem(%s%s)" % (", ".join(ranges), ", together" if self.together else "")
        return "Problem.patch(%s, %s)" % (", ".join(
            "%s of (%d, %d)" % (range_text(p - h, p + h), k0, k1)
            for (k0, k1, _), p, h in zip(self.waves, self.amplitude, self.half)), ", ".join(ranges))

    # ---- the one mechanism: what the core and a proof file are told

    @cached_property
    def waves(self) -> Tuple[Wave, ...]:
        """(k0, k1, phase in units of pi) of each wave."""
        return (tuple((*k, Fraction(0)) for k in THESIS) if self._patch is None
                else self._patch[0])

    @cached_property
    def amplitude(self) -> Numbers:
        """Of each wave, in the middle of the patch."""
        if self._patch is not None:
            return self._patch[1]
        return tuple(sum(getattr(self, name)) / 2 for name in "abc")

    @cached_property
    def parts(self) -> Tuple[Numbers, ...]:
        """Of each parameter, what it adds to each amplitude at its upper end."""
        if self._patch is not None:
            return self._patch[2]
        half = [(high - low) / 2 for low, high in (getattr(self, name) for name in "abc")]
        if self.together:
            return tuple(half),
        return tuple(tuple(h if j == m else Fraction(0) for j in range(3))
                     for m, h in enumerate(half))

    @property
    def by_ranges(self) -> bool:
        """Is the patch described by ranges of a, b and c, perhaps taken together?"""
        return self._patch is None

    @cached_property
    def frame(self) -> Frame:
        """x_1 = (f[0] v0 + f[1] v1, f[2] v0 + f[3] v1)."""
        return self._best_frame() if self.axes is None else self.axes

    def _present(self):
        """The waves that are anywhere in the patch: their (k0, k1), and their amplitudes' size."""
        return [((k0, k1), abs(p)) for (k0, k1, _), p, *parts
                in zip(self.waves, self.amplitude, *self.parts) if p or any(parts)]

    def _best_frame(self):
        """If all waves feel the same q.y alone, and q no coordinate, v0 moves along what none
        feels, and so need not be cut.  Only a region that is the whole torus has no axes
        already."""
        directions = {(k0 // gcd(k0, k1), k1 // gcd(k0, k1)) for (k0, k1), _ in self._present()}
        q = max(directions, default=(0, 0))
        if not directions <= {q, (-q[0], -q[1])} or 0 in q or not self.full_torus:
            return IDENTITY
        sign, (x, y) = (1 if q[1] > 0 else -1), bezout(*q)
        return sign * q[1], x, -sign * q[0], y  # of determinant sign q.(x, y)

    @cached_property
    def factor(self) -> Optional[int]:
        """The coordinate that is examined alone, without the waves that depend on the other one;
        None: neither.

        If no wave depends on both, the map is a product of two, and so are the second variations:
        that of test vectors (n, 0) is the second variation of the first map by itself."""
        if self.alone is None:
            return self._best_alone()
        return self.alone if isinstance(self.alone, int) else None

    def _best_alone(self):
        """The one that bends more, or None where neither can be left out."""
        bends = [sum(p * k[i] ** 2 for k, p in self._present()) for i in range(2)]
        felt = {tuple(map(bool, k)) for k, _ in self._present()}
        return int(bends[1] > bends[0]) if felt == {(True, False), (False, True)} else None

    @property
    def searched(self) -> Tuple[int, ...]:
        """Which of the waves the search needs."""
        return tuple(j for j, k in enumerate(self.waves)
                     if self.factor is None or k[1 - self.factor] == 0)

    @cached_property
    def odd(self) -> Optional[Ends]:
        """A point s, in units of pi, about which V is odd: k.s + phase is an integer for every
        wave.
        None: there is no such point.

        Sums and differences of such conditions are such conditions, so Euclid's algorithm makes of
        them one for s1 alone, one more that has s0, and those that s has no part in."""
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
    def dimension(self) -> int:
        """1 if the potential is given on the circle, else 2."""
        return 2 if self.by_ranges or any(k1 for _, k1, _ in self.waves) else 1

    @property
    def is_flat(self) -> bool:
        """Do those waves that the search needs feel one combination of the angles alone?"""
        k = [wave for wave, _ in self._present()]
        return self.factor is not None or all(a * d == b * c for a, b in k for c, d in k)

    # ---- ranges

    @property
    def centre(self) -> Numbers:
        """The middles of the amplitudes' ranges and of those of v0 and v1."""
        return self.amplitude + tuple((low + high) / 2 for low, high in (self.v0, self.v1))

    @property
    def half(self) -> Numbers:
        """The half-widths of the same ranges."""
        widths = tuple(sum(map(abs, parts), Fraction(0)) for parts in zip(*self.parts)) \
            if self.parts else (Fraction(0),) * len(self.waves)
        return widths + tuple((high - low) / 2 for low, high in (self.v0, self.v1))

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


def bezout(a: int, b: int) -> Tuple[int, int]:
    """(x, y) with a x + b y = 1, where there are such integers."""
    if b == 0:
        return a, 0
    x, y = bezout(b, a % b)
    return y, x - a // b * y


def _checked(waves, amplitude, parts):
    """The three as Problem keeps them: tuples of exact numbers.  TypeError, ValueError: they are
    something else, or do not go together."""
    try:
        waves, amplitude, parts = list(waves), list(amplitude), [list(part) for part in parts]
        waves = [tuple(wave) for wave in waves]
    except TypeError:
        raise TypeError("waves, amplitudes and parts are sequences") from None
    if not 1 <= len(waves) <= MOST_WAVES:
        raise ValueError("there are %d waves; give 1 to %d" % (len(waves), MOST_WAVES))
    if len(parts) > MOST_PARAMETERS:
        raise ValueError("there are %d parameters; give %d at most" % (len(parts), MOST_PARAMETERS))
    seen = {}
    for j, wave in enumerate(waves):
        if len(wave) not in (2, 3):
            raise ValueError("wave %d: give (k0, k1) or (k0, k1, phase), not %d numbers"
                             % (j + 1, len(wave)))
        if not all(type(k) is int for k in wave[:2]):
            raise TypeError("wave %d: k is two integers, not %r" % (j + 1, wave[:2]))
        if wave[:2] == (0, 0) or max(map(abs, wave[:2])) > HIGHEST:
            raise ValueError("wave %d: k = (%.20s, %.20s) is %s" % (
                j + 1, *wave[:2], "no wave" if wave[:2] == (0, 0) else
                "out of range (%d at most)" % HIGHEST))
        phase = _exact_of("the phase of wave %d" % (j + 1), wave[2] if len(wave) == 3 else 0)
        waves[j] = (*wave[:2], 1 - (1 - phase) % 2)
        if waves[j] in seen:
            raise ValueError("waves %d and %d are the same" % (seen[waves[j]], j + 1))
        seen[waves[j]] = j + 1
    for name, numbers in [("the amplitude", amplitude)] + [
            ("part %d" % (m + 1), part) for m, part in enumerate(parts)]:
        if len(numbers) != len(waves):
            raise ValueError("%s has %d numbers for %d waves" % (name, len(numbers), len(waves)))
        for j, number in enumerate(numbers):
            numbers[j] = _exact_of("%s of wave %d" % (name, j + 1), number)
            if not is_decimal(numbers[j]):
                raise ValueError("%s of wave %d: %s is no finite decimal" % (name, j + 1, number))
    return tuple(waves), tuple(amplitude), tuple(map(tuple, parts))


def exact_shifts(shifts: Sequence[Sequence[Number]]) -> Shifts:
    """Exact pairs, () if all of them are 0.  TypeError, ValueError: they are no shifts."""
    try:
        given = [tuple(pair) for pair in shifts]
    except TypeError:
        raise TypeError("shifts are pairs of numbers") from None
    pairs = []
    for pair in given:
        if len(pair) != 2:
            raise ValueError("the shifts by a parameter are of v0 and v1, not %d numbers"
                             % len(pair))
        s0, s1 = (_exact_of("a shift", x) for x in pair)
        for x in s0, s1:
            if not is_decimal(x):
                raise ValueError("a shift: %s is no finite decimal" % x)
        pairs.append((s0, s1))
    return tuple(pairs) if any(map(any, pairs)) else ()


def _exact_of(name, number):
    try:
        return exact(number)
    except (TypeError, ValueError) as error:
        raise type(error)("%s: %s" % (name, error)) from None


def interval(name, value):
    """(low, high) as Fractions that are finite decimals."""
    ends = value if isinstance(value, (tuple, list)) else (value, value)
    if len(ends) != 2:
        raise ValueError("%s is a range (low, high) or one number, not %d numbers"
                         % (name, len(ends)))
    try:
        low, high = map(exact, ends)
    except (TypeError, ValueError) as error:
        raise type(error)("%s: %s" % (name, error)) from None
    if low > high:
        raise ValueError("%s: the lower end, %s, is above the upper one, %s" % (name, *ends))
    return outward(low, high, PLACES)


def wave_text(wave):
    """A wave (k0, k1, phase) as a function of y."""
    return "sin(%s)" % sum_text(zip(wave, ("y0", "y1", "pi")))


def frame_text(frame, name):
    """The angles that belong to v0 and v1, whose names are name % 0 and name % 1."""
    names = name % 0, name % 1
    return "(%s, %s)" % (sum_text(zip(frame[:2], names)), sum_text(zip(frame[2:], names)))
