"""The map: the value that proofs, tori, orbits and the maps of parameter space take.

    from converse import FourierMap, StandardMap
    StandardMap("0.9")
    FourierMap({(1, 0): {"K": 1}, (0, 1): {"K": 1}, (1, 1): "0.3"}, K=("0.6", "0.602"))
"""

import math
import re
import warnings
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Dict, Mapping, Sequence, Tuple, Union

from ..storage.methods import provided
from .dynamics import Dynamics
from .exact import (Ends, Number, decimal_text, exact, integer, is_decimal, is_integer, number_text,
                    outward, pi_bounds, range_text, short_text)
from .potential import PHASES, FourierSum, Wave, potential_text

THESIS = (1, 0), (0, 1), (1, 1)         # the harmonics of a, b and c
# The line of Muldoon's thesis is a = b = c/2 = LINE epsilon: this decimal defines epsilon here.
# The thesis's own constant is 2 pi^2/M = 11.2143598191..., M = sqrt(207 + 33 sqrt 33)/(8 sqrt 2),
# which converse.orbits has.
LINE = Fraction("11.21436")
PLACES = 40                             # to which an end that is not a finite decimal is enclosed
# Of a number.  A file says sums of two of them, each 10^-300 to 10^300 in size: at most 1,601
# digits.  converse-check takes 3,000.
MOST_CHARACTERS = 1000
MOST_WAVES, MOST_PARAMETERS, HIGHEST = 16, 3, 100       # the last: of k and of a frame
NAME = re.compile(r"[^\W\d]\w{0,30}(\[[0-9]{1,9}\])?")      # of a parameter
RESERVED = "J", "J0", "J1", "P", "S", "V", "cos", "pi", "sin", "y", "y0", "y1"     # of theorems
RESERVED_OF_THREE = "J2", "y2"          # of theorems about three angles
CONSTANT = "constant"                   # the part of an amplitude that no parameter moves

Range = Tuple[Number, Number]           # Ends are made of it
Numbers = Tuple[Fraction, ...]
Amplitude = Union[Number, Range, Mapping[str, Number]]


@dataclass(frozen=True, eq=False, repr=False)
class SymplecticMap(Dynamics):
    """A symplectic twist map of the torus in one to three angles, or a family of such maps:

        y' = y + J', J' = J - grad V(y),    V(y) = - sum of p[j] sin(k[j].y + pi phase[j]),

    y and J of period 2 pi.  The amplitudes are p = amplitude + sum over m of s[m] slopes[m], and
    the parameter s[m] lies in the range ranges[m].  StandardMap, FroeschleMap, MuldoonMap and
    FourierMap make such values, and SymplecticMap.read does from a file.

    Parameters
    ----------
    harmonics
        (k0, k1), (k0, k1, phase), (k0, k1, k2) or (k0, k1, k2, phase) of each harmonic: k integers
        up to 100, two in all harmonics or three in all.  The phase is a number in units of pi, but
        no int, which would look like another k; or "+cos", "-cos", "+sin" or "-sin": then the term
        of V is p times this function of k.y.  Without a phase it is "-sin".  If all k2 are 0, the
        map has two angles at most; if all k1 are 0 also, it has one.
    amplitude
        Of each harmonic where all parameters are 0, an exact number.
    slopes
        For each parameter the factor by which it moves each amplitude.
    ranges
        Of each parameter, (low, high) or one number; by default (-1, 1).
    names
        Of the parameters, or none.
    name
        Of the map, for reports.

    Numbers are exact: ints, Fractions, Decimals, and strings such as "0.3085", "1.25e-3" and
    "63/64".  Two values are equal if they have the same harmonics, and the same amplitudes for the
    same ranges of parameters, in any order, whatever the parameters are called.

    Raises
    ------
    TypeError, ValueError
        An argument is not as described; the text names the argument and the reason.
    """

    harmonics: Tuple[Wave, ...]
    amplitude: Numbers
    slopes: Tuple[Numbers, ...] = ()
    ranges: Tuple[Ends, ...] = ()
    names: Tuple[str, ...] = ()
    name: str = ""

    period, letters = 2 * math.pi, "yJ"

    if TYPE_CHECKING:                   # the arguments; above are the values made of them
        def __init__(self, harmonics: Sequence[tuple], amplitude: Sequence[Number],
                     slopes: Sequence[Sequence[Number]] = (),
                     ranges: Sequence[Union[Range, Number]] = (), names: Sequence[str] = (),
                     name: str = "") -> None: ...

    def __post_init__(self) -> None:
        harmonics, amplitude, slopes = _checked(self.harmonics, self.amplitude, self.slopes)
        names, reserved = tuple(self.names), RESERVED + RESERVED_OF_THREE * (len(harmonics[0]) > 3)
        for name in names:
            if not isinstance(name, str) or not NAME.fullmatch(name) or name in reserved:
                raise ValueError("a parameter's name is a letter and then letters and digits, and "
                                 "none of %s, not %.40r" % (", ".join(reserved), name))
        given = list(self.ranges) or [(Fraction(-1), Fraction(1))] * len(slopes)
        ranges = [ends_of("the range of %s" % name, ends) for name, ends in zip(
            names if len(names) == len(given) else
            ["parameter %d" % m for m in range(1, 1 + len(given))], given)]
        if harmonics == tuple((*k, Fraction(0)) for k in THESIS) and not slopes:
            slopes = tuple(tuple(Fraction(m == j) for j in range(3)) for m in range(3))
            amplitude, ranges, names = (Fraction(0),) * 3, [(p, p) for p in amplitude], tuple("abc")
        if len(ranges) != len(slopes) or names and len(set(names)) != len(slopes):
            raise ValueError("there are %d parameters, %d ranges and %d different names of them"
                             % (len(slopes), len(ranges), len(set(names))))
        for name, value in (("harmonics", harmonics), ("amplitude", amplitude), ("slopes", slopes),
                            ("ranges", tuple(ranges)), ("names", names)):
            object.__setattr__(self, name, value)

    @classmethod
    def read(cls, source: Any) -> "SymplecticMap":
        """The map of an input file (docs/reference/inputs.md): the five lines of 1989, or JSON.

        Parameters
        ----------
        source
            As of converse.read_input, with the same errors.
        """
        return provided("SymplecticMap.read")(source).map

    def _key(self):
        middle, parts = self.patch
        waves, *parts = zip(*sorted(zip(zip(self.harmonics, middle), *filter(any, parts))))
        return waves, tuple(sorted(max(part, tuple(-x for x in part)) for part in parts))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SymplecticMap) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __str__(self) -> str:
        return self._in_words(self.name or self.formula)

    def __repr__(self) -> str:
        return "<SymplecticMap: %s>" % self._in_words(
            "%s, %s" % (self.name, self.formula) if self.name else self.formula)

    def _in_words(self, text):
        return ", ".join([text] + ["%s = %s" % (name, range_text(*ends))
                                   for name, ends in zip(self._letters, self.ranges)])

    @property
    def _letters(self):
        return self.names or ["t[%d]" % m for m in range(1, 1 + len(self.slopes))]

    @property
    def formula(self) -> str:
        """V in words, exactly, by the names of the parameters."""
        forms = ({"": p, **dict(zip(self._letters, slopes))}
                 for p, *slopes in zip(self.amplitude, *self.slopes))
        return "V(y) = " + potential_text(self.harmonics, forms, self.dimension)

    @property
    def dimension(self) -> int:     # type: ignore[override]
        """The number of angles: 3 if a harmonic depends on y2, else 2 if one depends on y1, else
        1."""
        return max(i + 1 for *k, _ in self.harmonics for i, x in enumerate(k) if x or not i)

    @cached_property
    def patch(self) -> Tuple[Numbers, Tuple[Numbers, ...]]:
        """The amplitudes in the middle of all ranges, and for each parameter what it adds to each
        amplitude at its upper end."""
        return _patch(self.amplitude, self.slopes, self.ranges)

    @cached_property
    def enclosed(self) -> Tuple[Numbers, Tuple[Numbers, ...]]:
        """As `patch`, in finite decimals, of ranges whose ends are moved outwards to 40 places
        where they are not finite decimals.  ValueError: an amplitude is not a finite decimal, or
        one that is too long for a proof file."""
        middle, parts = _patch(self.amplitude, self.slopes,
                               [outward(*ends, PLACES) for ends in self.ranges])
        for name, numbers in [("the amplitude", middle)] + [
                ("the part of parameter %d" % m, part) for m, part in enumerate(parts, 1)]:
            for j, number in enumerate(numbers, 1):
                if not is_decimal(number):
                    raise ValueError("%s of harmonic %d: %s is not a finite decimal"
                                     % (name, j, number_text(number)))
                if len(decimal_text(number)) > MOST_CHARACTERS:
                    raise ValueError("%s of harmonic %d has more than %d characters; give shorter "
                                     "numbers" % (name, j, MOST_CHARACTERS))
        return middle, parts

    # ---- other maps

    def at(self, **values: Union[Range, Number]) -> "SymplecticMap":
        """The map, or smaller family, at values of some parameters.

        Parameters
        ----------
        values
            Exact numbers, or ranges (low, high), by the names of parameters; they may lie outside
            of the family's ranges.

        Raises
        ------
        TypeError, ValueError
            A parameter has another name, or a value is not an exact number.
        """
        for name in values:
            if name not in self.names:
                raise ValueError("there is no parameter %.40s: the parameters are %s"
                                 % (name, ", ".join(self.names) or "none"))
        return replace(self, ranges=tuple(
            ends_of(name, values.get(name, ends)) for name, ends in zip(self.names, self.ranges))
            ) if values else self

    def tied(self) -> "SymplecticMap":
        """The family whose parameters move together, from all lower to all upper ends.

        Returns
        -------
        SymplecticMap
            With one parameter, from -1 to 1; with none, if there was none.

        Raises
        ------
        ValueError
            An amplitude is not a finite decimal.
        """
        amplitude, parts = self.enclosed
        return SymplecticMap(self.harmonics, amplitude,
                             [tuple(map(sum, zip(*parts)))] if parts else (), name=self.name)

    def potential(self) -> FourierSum:
        """V alone, exactly.

        Raises
        ------
        ValueError
            A parameter has a range, and so no value.
        """
        for m, (low, high) in enumerate(self.ranges):
            if low != high:
                name = self.names[m] if self.names else "an amplitude"
                raise ValueError("%s goes from %s to %s; %s" % (
                    name, short_text(low), short_text(high),
                    "choose a value: .at(%s='%s'), or --at %s=%s" % (
                        (name, short_text((low + high) / 2)) * 2) if self.names else
                    "give one number, or name a parameter and choose its value"))
        return FourierSum(self.harmonics, self.patch[0], self.dimension)

    # ---- in doubles

    @cached_property
    def _doubles(self):
        """k (waves, n), the phases in radians, and the amplitudes, as arrays."""
        import numpy as np

        return (np.array([wave[:self.dimension] for wave in self.harmonics], float),
                np.pi * np.array([float(phase) for *_, phase in self.harmonics]),
                np.array([float(p) for p in self.potential().amplitude]))

    def _gradient(self, y):
        import numpy as np

        k, phase, p = self._doubles
        return -(p * np.cos(y @ k.T + phase)) @ k

    def _hessian(self, y):
        import numpy as np

        k, phase, p = self._doubles
        return np.einsum("mj,ja,jb->mab", p * np.sin(y @ k.T + phase), k, k)


# ---- the maps of the literature

def StandardMap(k: Union[Range, Number]) -> SymplecticMap:
    """The standard map y' = y + J', J' = J + k sin y (Chirikov 1979).

    Parameters
    ----------
    k
        A number or a range (low, high), exact.

    Raises
    ------
    TypeError, ValueError
        k is not as described.
    """
    return SymplecticMap([(1, 0, "+cos")], [0], [[1]], [k], ["k"], "standard map")


def FroeschleMap(k: Union[Range, Number], b: Union[Range, Number]) -> SymplecticMap:
    """The Froeschlé map J_i' = J_i + k sin y_i + b sin(y_0 + y_1), i = 0, 1 (Froeschlé 1972).

    Parameters
    ----------
    k, b
        A number or a range (low, high), exact.

    Raises
    ------
    TypeError, ValueError
        An argument is not as described; the text names the parameter.
    """
    return SymplecticMap([(1, 0, "+cos"), (0, 1, "+cos"), (1, 1, "+cos")], [0] * 3,
                         [[1, 1, 0], [0, 0, 1]], [k, b], ["k", "b"], "Froeschlé map")


def MuldoonMap(a: Union[Range, Number, None] = None, b: Union[Range, Number, None] = None,
               c: Union[Range, Number, None] = None, *,
               epsilon: Union[Range, Number, None] = None) -> SymplecticMap:
    """The map of Muldoon's thesis, V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1).

    Parameters
    ----------
    a, b, c
        Numbers or ranges (low, high), exact.
    epsilon
        In the place of a, b and c: a = b = c/2 = 11.21436 epsilon.

    Raises
    ------
    TypeError, ValueError
        An argument is not as described, or epsilon is given beside a, b or c.
    """
    if epsilon is not None:
        if (a, b, c) != (None,) * 3:
            raise ValueError("a map has a, b and c, or epsilon; give the ones or the other")
        return SymplecticMap(THESIS, [0] * 3, [[LINE, LINE, 2 * LINE]], [epsilon], ["epsilon"],
                             "Muldoon map")
    ranges = [ends_of(name, ends) for name, ends in zip("abc", (a, b, c))]
    return SymplecticMap(THESIS, [0] * 3, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], ranges, tuple("abc"),
                         "Muldoon map")


def FourierMap(harmonics: Mapping[Any, Amplitude], *, name: str = "",
               **parameters: Union[Range, Number]) -> SymplecticMap:
    """A map of any potential that is a finite Fourier sum, V(y) = - sum of p sin(k.y + pi phase).

        FourierMap({(1, "+cos"): {"K": 1}, (3, "+cos"): "0.05"}, K=("0.6", "0.602"))
        FourierMap({(1, 0): "0.3", (0, 1): "0.3", ((1, 1), "1/3"): "0.6"})

    Parameters
    ----------
    harmonics
        {k: p} or {(k, phase): p}.  k is an integer for one angle, a pair (k0, k1) for two, (k0, k1,
        k2) for three; the phase is as of SymplecticMap.  An amplitude p is a number, a range (low,
        high), or {name: factor} of parameters, with the name "constant" for what no parameter
        moves.

        ========  ==============  ==================
        phase     term of V       term of J' (one k)
        ========  ==============  ==================
        "+cos"    p cos(k y)      + p k sin(k y)
        "-cos"    - p cos(k y)    - p k sin(k y)
        "+sin"    p sin(k y)      - p k cos(k y)
        "-sin"    - p sin(k y)    + p k cos(k y)
        ========  ==============  ==================

    name
        Of the map, for reports.
    parameters
        The values or ranges of the parameters.

    Raises
    ------
    TypeError, ValueError
        An argument is not as described, or no amplitude depends on a parameter.
    """
    return affine(list(map(_wave, harmonics)), list(harmonics.values()), parameters, name)


def _wave(key):
    """The harmonic of a key of FourierMap: k, (k0, k1), (k0, k1, k2), or (k, phase) with any of
    them."""
    if is_integer(key):
        return key, 0
    if isinstance(key, tuple) and len(key) == 2 and not is_integer(key[1]):
        k, phase = key
        return (*(k if isinstance(k, tuple) else (k, 0)), phase)
    return key


def affine(waves: Sequence[tuple], amplitudes: Sequence[Amplitude],
           parameters: Mapping[str, Union[Range, Number]], name: str) -> SymplecticMap:
    """The map of amplitudes as FourierMap takes them.  Those that are ranges or not finite decimals
    are parameters of their own, behind those that are named."""
    for key in parameters:
        if not key.isidentifier() or key == CONSTANT:
            raise ValueError("%.40r is not a name for a parameter; a name is a letter and then "
                             "letters and digits, and not %r" % (key, CONSTANT))
    ranges = {key: ends_of(key, ends) for key, ends in parameters.items()}
    constants, slopes = [], []
    for j, amplitude in enumerate(amplitudes, 1):
        words = "the amplitude of harmonic %d" % j
        if isinstance(amplitude, Mapping):
            factors: Dict[str, Number] = {
                key: exact_of("%s, %.40s" % (words, key), x) for key, x in amplitude.items()}
        else:
            low, high = ends_of(words, amplitude)
            factors, own = {CONSTANT: low}, "amplitude[%d]" % j
            if low != high or not is_decimal(low):
                factors = {own: 1}
                ranges[own] = low, high
        unknown = set(factors) - {CONSTANT, *ranges}
        if unknown:
            raise ValueError("%s: there is no parameter %.40r; the parameters are %s" % (
                words, min(unknown), ", ".join(parameters) or "none"))
        constants.append(factors.pop(CONSTANT, 0))
        slopes.append(factors)
    unused = set(parameters).difference(*slopes)
    if unused:
        raise ValueError("no amplitude depends on the parameter %r; leave it out" % min(unused))
    return SymplecticMap(waves, constants, [[slope.get(key, 0) for slope in slopes]
                                            for key in ranges], list(ranges.values()),
                         list(ranges) if parameters else (), name)


def from_patch(harmonics: Sequence[tuple], amplitude: Sequence[Number],
               parts: Sequence[Sequence[Number]],
               parameters: Sequence[Tuple[str, Fraction, Fraction]]) -> SymplecticMap:
    """The map with these amplitudes in the middle of all ranges, and what each parameter adds to
    them at its upper end.

    parameters -- (name, low, high) of each; (): the parameters are unnamed
    ValueError: their numbers differ, or a parameter moves amplitudes and its range is a point."""
    if not parameters:
        return SymplecticMap(harmonics, amplitude, parts)
    if len(parameters) != len(parts):
        raise ValueError("there are names of %d parameters for %d" % (len(parameters), len(parts)))
    middle, slopes = [exact(p) for p in amplitude], []
    for (name, low, high), part in zip(parameters, parts):
        moves = [exact(p) for p in part]
        if low > high or low == high and any(moves):
            raise ValueError("the range of %.40s goes from %s to %s" % (name, low, high))
        slopes.append([2 * p / (high - low) if p else p for p in moves])
        middle = [p - slope * (low + high) / 2 for p, slope in zip(middle, slopes[-1])]
    return SymplecticMap(harmonics, middle, slopes, [(low, high) for _, low, high in parameters],
                         [name for name, *_ in parameters])


# ---- arguments

def _patch(amplitude, slopes, ranges):
    middle = [p + sum(slope[j] * (low + high) / 2 for slope, (low, high) in zip(slopes, ranges))
              for j, p in enumerate(amplitude)]
    parts = [[p * (high - low) / 2 for p in slope] for slope, (low, high) in zip(slopes, ranges)]
    name = "an amplitude"               # ValueError: out of range
    return tuple(exact_of(name, p) for p in middle), tuple(
        tuple(exact_of(name, p) for p in part) for part in parts)


def ends_of(name: str, value: Any) -> Ends:
    """The ends of a range, or a number twice, exactly.  TypeError, ValueError: it is neither, with
    the name."""
    ends = value if isinstance(value, (tuple, list)) else (value, value)
    if len(ends) != 2:
        raise ValueError("%s is a range (low, high) or one number, not %d numbers"
                         % (name, len(ends)))
    low, high = (exact_of(name, end) for end in ends)
    if low > high:
        raise ValueError("%s: the lower end, %s, is above the upper one, %s"
                         % (name, number_text(low), number_text(high)))
    return low, high


def exact_of(name: str, number: Any) -> Fraction:
    """The number, exactly; the errors of exact(), with the name."""
    try:
        return exact(number)
    except (TypeError, ValueError) as error:
        raise type(error)("%s: %s" % (name, error)) from None


def _phase(name, given="-sin"):
    """A phase in units of pi, from -1 to 1.  A warning: it looks like one in radians."""
    if is_integer(given):
        raise TypeError("%s, %.40r, looks like another k; a phase that is an integer is given as a "
                        "string" % (name, given))
    if not isinstance(given, str):
        return 1 - (1 - exact_of(name, given)) % 2
    if "+" + given in PHASES:
        raise ValueError("%s: %r has no sign; for V with the term p %s(k.y) give '+%s', and for "
                         "-p %s(k.y) '-%s', as which releases before 5.3 took it"
                         % (name, given, *(given,) * 4))
    phase = PHASES[given] if given in PHASES else exact_of(name, given)
    places = len(given.partition(".")[2])       # of 1.5707963
    step = Fraction(1, 2 if places < 4 else 12)
    turns = round(phase / pi_bounds(places)[0] / step) * step
    if places > 1 and turns and abs(phase - turns * pi_bounds(places)[0]) < Fraction(
            1, 10 ** places):
        warnings.warn("%s, %s, is taken in units of pi; give %s if it is %s pi in radians"
                      % (name, given, turns, turns), RuntimeWarning, stacklevel=2)
    return 1 - (1 - phase) % 2


def _checked(harmonics, amplitude, slopes):
    """The three as SymplecticMap keeps them: tuples of exact numbers."""
    try:
        harmonics, amplitude = [tuple(wave) for wave in harmonics], list(amplitude)
        slopes = [list(slope) for slope in slopes]
    except TypeError:
        raise TypeError("harmonics, amplitudes and slopes are sequences") from None
    if not 1 <= len(harmonics) <= MOST_WAVES:
        raise ValueError("there are %d harmonics; give 1 to %d" % (len(harmonics), MOST_WAVES))
    if len(slopes) > MOST_PARAMETERS:
        raise ValueError("there are %d parameters; give %d at most"
                         % (len(slopes), MOST_PARAMETERS))
    seen = {}
    for j, wave in enumerate(harmonics):
        n = 3 if len(wave) > 2 and is_integer(wave[2]) else 2
        if not 2 <= len(wave) <= n + 1:
            raise ValueError("harmonic %d: give (k0, k1) or (k0, k1, k2), and a phase at most, not "
                             "%d numbers" % (j + 1, len(wave)))
        if not all(map(is_integer, wave[:n])):
            raise TypeError("harmonic %d: k is two integers or three, not %.40r"
                            % (j + 1, wave[:n]))
        k = tuple(map(integer, wave[:n]))
        if not any(k) or max(map(abs, k)) > HIGHEST:
            raise ValueError("harmonic %d: k = (%s) is %s" % (
                j + 1, ", ".join(map(short_text, k)), "out of range (%d at most)" % HIGHEST
                if any(k) else "not a harmonic"))
        harmonics[j] = *k, _phase("the phase of harmonic %d" % (j + 1), *wave[n:])
        if len(harmonics[j]) != len(harmonics[0]):
            raise ValueError("harmonic %d has %d integers k, and harmonic 1 has not; a phase that "
                             "is an integer is given as a string" % (j + 1, n))
        if harmonics[j] in seen:
            raise ValueError("harmonics %d and %d are the same; add up their amplitudes"
                             % (seen[harmonics[j]], j + 1))
        seen[harmonics[j]] = j + 1
    if not any(any(wave[2:-1]) for wave in harmonics):      # nothing depends on y2
        harmonics = [(*wave[:2], wave[-1]) for wave in harmonics]
    for name, numbers in [("the amplitude", amplitude)] + [
            ("the slope by parameter %d" % m, slope) for m, slope in enumerate(slopes, 1)]:
        if len(numbers) != len(harmonics):
            raise ValueError("%s has %d numbers for %d harmonics"
                             % (name, len(numbers), len(harmonics)))
        numbers[:] = [exact_of("%s of harmonic %d" % (name, j), x)
                      for j, x in enumerate(numbers, 1)]
    return tuple(harmonics), tuple(amplitude), tuple(map(tuple, slopes))
