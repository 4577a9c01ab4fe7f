"""Reads the files that describe a problem or a potential: the five lines of 1989 (thesis, Appendix
B), or JSON with the harmonics of a Fourier sum (docs/reference/inputs.md)."""

import json
import os
import re
from fractions import Fraction
from typing import IO, Dict, NamedTuple, NoReturn, Sequence, Union

from .exact import Ends, exact, is_decimal
from .map import CONSTANT, HIGHEST, MOST_PARAMETERS, MOST_WAVES, affine
from .potential import Wave
from .problem import InputError, Problem

LABELS = ("a", "b", "c", "theta[0]", "theta[1]")        # as the input's documentation calls them
PHASES = {"sin": Fraction(0), "cos": Fraction(1, 2)}    # sin(k.y + pi / 2) = cos k.y
NAME = re.compile(r"[^\W\d]\w{0,30}")
# Of a number: one of 100,000 characters takes a proof 18 seconds before it begins, one of 10,000
# takes half a second (November 2026).
MOST_CHARACTERS = 10000
MOST_BYTES = 1 << 24                    # of a file

Source = Union[str, "os.PathLike[str]", IO]


def read_input(source: Source) -> Problem:
    """Reads an input file (docs/reference/inputs.md).

    The thesis's format (Appendix B) has five lines of two numbers, centre and half-width, for a, b,
    c and the two angles, these in units of pi; then comment lines.  A file that begins with a brace
    or is called .json is a Fourier sum.

    Parameters
    ----------
    source : path or open file

    Returns
    -------
    Problem

    Raises
    ------
    InputError
        The file has neither format.
    """
    text, name = _read(source)
    if not _is_json(text, name):
        return _five_lines(text, name)
    try:
        return _problem(_json(text, name))
    except _Wrong as wrong:
        raise InputError("%s%s" % (name, wrong)) from None


def _is_json(text, name):
    return text.lstrip().startswith("{") or name.endswith(".json")


def _read(source):
    """The text of a path or of an open file, text or binary, and its name for messages."""
    is_path = isinstance(source, (str, os.PathLike))
    name = os.fspath(source) if is_path else getattr(source, "name", None)
    name = name if isinstance(name, str) else "<stdin>"
    try:
        if is_path:
            with open(source, "rb") as file:
                data = file.read(MOST_BYTES + 1)
        else:
            data = getattr(source, "buffer", source).read(MOST_BYTES + 1)
    except OSError as error:
        raise InputError("%s: cannot be read (%s); name a readable file"
                         % (name, error.strerror or error)) from None
    if len(data) > MOST_BYTES:
        raise InputError("%s: is longer than %d bytes; name an input file" % (name, MOST_BYTES))
    if isinstance(data, bytes):
        try:
            data = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            data = data.decode("latin-1")
    return data.replace("\r\n", "\n").replace("\r", "\n"), name


def _number(text: str) -> Fraction:
    """The number, exactly; ValueError: it is none, or too long."""
    if len(text) > MOST_CHARACTERS:
        raise ValueError("the number %.20s... has %d characters where at most %d are possible"
                         % (text, len(text), MOST_CHARACTERS))
    return exact(text)


# ---- the five lines of 1989

def _five_lines(text, name):
    lines = text.rstrip("\n").split("\n")
    centre, half = [], []
    used = 0

    def fail(wrong: object, remedy: str) -> NoReturn:
        raise InputError("%s, line %d: %s; %s" % (name, max(used, 1), wrong, remedy))

    for label in LABELS:
        want = "give the centre and the half-width of %s" % label
        while used < len(lines) and not lines[used].strip():
            used += 1
        if used == len(lines):
            fail("the input is empty" if not centre else "the input ends too early", want)
        words = lines[used].split()
        used += 1
        try:
            values = list(map(_number, words))
        except ValueError as error:
            fail(error, want)
        if len(values) != 2:
            fail("%d number%s where two belong"
                 % (len(values), "" if len(values) == 1 else "s"), want)
        if values[1] < 0:
            fail("the half-width %s is negative" % words[1], want + ", which is 0 or more")
        centre.append(values[0])
        half.append(values[1])

    comments = [line.rstrip() for line in lines[used:]]
    while comments and not comments[0]:
        comments.pop(0)
    while comments and not comments[-1]:
        comments.pop()
    try:
        return Problem.around(centre, half, comments)
    except ValueError as error:
        raise InputError("%s: %s" % (name, error)) from None


# ---- JSON

class _Number(str):
    """A number of JSON, as it is written."""


class _Wrong(Exception):
    """Where, what is wrong, and the remedy."""


class _Description(NamedTuple):
    """What a file says, exactly: of each wave the amplitude, which is a range (low, high) or the
    factor of each named parameter and the constant; the parameters' ranges."""

    waves: Sequence[Wave]
    amplitudes: Sequence[Union[Ends, Dict[str, Fraction]]]
    parameters: Dict[str, Ends]
    region: Sequence[Ends] = ()         # the ranges of v0 and v1
    comments: Sequence[str] = ()
    name: str = ""                      # of the file


def _json(text: str, name: str) -> _Description:
    try:
        stem = os.path.splitext(os.path.basename(name))[0]
        return _described(json.loads(text, parse_int=_Number, parse_float=_Number,
                                     parse_constant=_constant, object_pairs_hook=_object))._replace(
                                         name=stem)
    except json.JSONDecodeError as error:
        raise InputError("%s, line %d: this is no JSON (%s, column %d); mend it there" % (
            name, error.lineno, error.msg[:1].lower() + error.msg[1:], error.colno)) from None
    except RecursionError:
        raise InputError("%s, line 1: too many brackets in each other; give 'harmonics', a list of "
                         "objects" % name) from None


def _fail(where, wrong, remedy):
    raise _Wrong("%s: %s; %s" % (", " + where if where else "", wrong, remedy))


def _constant(word):
    _fail("", "%s is no number" % word, "give a finite one")


def _object(pairs):
    found = {}
    for key, value in pairs:
        if key in found:
            _fail("", "%s stands twice in one object" % json.dumps(key[:40]), "leave one out")
        found[key] = value
    return found


def _keys(where, value, needed, others):
    """Sees that the value is an object with these keys."""
    every = ", ".join(needed + others)
    if not isinstance(value, dict):
        _fail(where, "this is %s" % _kind(value), "give an object with " + every)
    for key in value:
        if key not in needed + others:
            _fail(where, "there is no field %s" % json.dumps(key[:40]), "its fields are " + every)
    for key in needed:
        if key not in value:
            _fail(where, "%s is missing" % key, "its fields are " + every)


def _kind(value):
    """What the value is, in words."""
    if isinstance(value, _Number):
        return "a number"
    return {str: "a string", list: "a list", dict: "an object", bool: str(value).lower(),
            type(None): "null"}[type(value)]


def _exact(where, value,
           remedy="give a number such as 0.3085, or as a string a ratio such as \"1/3\""):
    """A number, or a string that is one."""
    if not isinstance(value, str):
        _fail(where, "this is %s" % _kind(value), "give a number, or as a string a ratio")
    try:
        return _number(str(value))
    except ValueError as error:
        _fail(where, error, remedy)


def _range(where, value):
    """A range [low, high] or one number, exactly: (low, high)."""
    ends = value if isinstance(value, list) else [value]
    if len(ends) not in (1, 2) or isinstance(value, list) and len(ends) == 1:
        _fail(where, "%d numbers" % len(ends), "give [low, high] or one number")
    ends = [_exact(where, end) for end in ends]
    if ends[0] > ends[-1]:
        _fail(where, "the lower end, %s, is above the upper one, %s" % (ends[0], ends[-1]),
              "give [low, high] or one number")
    return ends[0], ends[-1]


def _described(value):
    _keys("", value, ["harmonics"], ["parameters", "comments", "v0", "v1"])
    harmonics, parameters = value["harmonics"], _parameters(value.get("parameters", {}))
    if not isinstance(harmonics, list) or not 1 <= len(harmonics) <= MOST_WAVES:
        _fail("harmonics", "%d of them" % len(harmonics) if isinstance(harmonics, list)
              else "this is " + _kind(harmonics), "give a list of 1 to %d" % MOST_WAVES)
    waves, amplitudes = [], []
    for j, harmonic in enumerate(harmonics, 1):
        where = "harmonic %d" % j
        _keys(where, harmonic, ["k", "amplitude"], ["phase"])
        k = _vector(where + ", k", harmonic["k"])
        size = len(harmonics[0]["k"])
        if len(k) != size:
            _fail(where + ", k", "%d number%s, and %d before" % (len(k), "s" * (len(k) > 1), size),
                  "give all one (the circle) or all two (the torus)")
        wave = (*k, *(0,) * (2 - size), _phase(where + ", phase", harmonic.get("phase", "sin")))
        if wave in waves:
            _fail(where, "harmonic %d has the same k and phase" % (1 + waves.index(wave)),
                  "add their amplitudes up")
        waves.append(wave)
        amplitudes.append(_amplitude(where + ", amplitude", harmonic["amplitude"], parameters))
    for name in parameters:
        if not any(name in amplitude for amplitude in amplitudes):
            _fail("parameters, " + json.dumps(name), "no amplitude has it", "leave it out")
    if size == 1 and "v1" in value:
        _fail("v1", "on the circle there is no second angle", "leave it out")
    region = [_range(key, value[key]) if key in value else (Fraction(0), Fraction(2))
              for key in ("v0", "v1")]
    return _Description(waves, amplitudes, parameters, region,
                        _comments(value.get("comments", [])))


def _parameters(value):
    """The ranges of the parameters by name."""
    if not isinstance(value, dict):
        _fail("parameters", "this is " + _kind(value), "give an object of ranges by name")
    found = {}
    for name, ends in value.items():
        where = "parameters, " + json.dumps(name[:40])
        if not NAME.fullmatch(name) or name == CONSTANT:
            _fail(where, "this is no name for a parameter",
                  "a name is a letter and then letters and digits, and not " + CONSTANT)
        found[name] = _range(where, ends)
    return found


def _comments(value):
    lines = [value] if isinstance(value, str) else value
    if not isinstance(lines, list) or any(_kind(line) != "a string" for line in lines):
        _fail("comments", "this is no text", "give a string or a list of strings")
    return lines


def _phase(where, value):
    """In units of pi, from -1 (not itself) to 1."""
    phase = PHASES[value] if isinstance(value, str) and value in PHASES else _exact(where, value)
    return 1 - (1 - phase) % 2


def _vector(where, value):
    """The integers k."""
    if not isinstance(value, list) or len(value) not in (1, 2):
        _fail(where, "this is %s" % ("a list of %d" % len(value) if isinstance(value, list)
                                     else _kind(value)), "give [k] or [k0, k1]")
    remedy = "give integers from -%d to %d" % (HIGHEST, HIGHEST)
    numbers = [_exact(where, number, remedy) if isinstance(number, _Number) else _fail(
        where, "this has %s in it" % _kind(number), remedy) for number in value]
    if any(number.denominator != 1 or abs(number) > HIGHEST for number in numbers):
        _fail(where, "(%s) is out of range" % ", ".join("%.20s" % number for number in value),
              remedy)
    if not any(numbers):
        _fail(where, "this is zero, and so no harmonic", "leave it out")
    return tuple(map(int, numbers))


def _amplitude(where, value, parameters):
    """A range, or the factors of the parameters and the constant."""
    if not isinstance(value, dict):
        return _range(where, value)
    for key in value:
        if key not in [*parameters, CONSTANT]:
            _fail(where, "there is no parameter %s" % json.dumps(key[:40]),
                  "the parameters are %s" % (", ".join(parameters)
                                             or "none; name them in 'parameters'"))
    return {key: _exact("%s, %s" % (where, key), number) for key, number in value.items()}


# ---- what becomes of a description

def _problem(described):
    """The Problem of a description."""
    for j, amplitude in enumerate(described.amplitudes, 1):
        for key, number in amplitude.items() if isinstance(amplitude, dict) else ():
            if not is_decimal(number):
                _fail("harmonic %d, amplitude, %s" % (j, key),
                      "%s is not a finite decimal" % number, "give one")
    count = len(described.parameters) + sum(not isinstance(each, dict) and
                             (each[0] != each[1] or not is_decimal(each[0]))
                             for each in described.amplitudes)
    if count > MOST_PARAMETERS:
        _fail("", "%d parameters and ranges of amplitudes" % count,
              "give %d at most" % MOST_PARAMETERS)
    try:
        return Problem(affine(described.waves, described.amplitudes, described.parameters,
                              described.name), *described.region, described.comments)
    except ValueError as error:
        _fail("", error, "give moderate numbers")
