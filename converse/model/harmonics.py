"""The input of a potential of one's own: a JSON file of its harmonics (docs/format.md)."""

import json
import re
from fractions import Fraction

from .exact import decimal_text, exact, is_decimal
from .problem import HIGHEST, MOST_PARAMETERS, MOST_WAVES, InputError, Problem, interval

PHASES = {"sin": Fraction(0), "cos": Fraction(1, 2)}    # sin(k.y + pi / 2) = cos k.y
CONSTANT = "constant"
NAME = re.compile(r"[^\W\d]\w{0,30}")


class _Number(str):
    """A number of JSON, as it is written."""


class _Wrong(Exception):
    """Where, what is wrong, and the remedy."""


def read(text, name):
    """The Problem that the text of a file of this name describes; InputError."""
    try:
        return _problem(json.loads(text, parse_int=_Number, parse_float=_Number,
                                   parse_constant=_constant, object_pairs_hook=_object))
    except _Wrong as wrong:
        raise InputError("%s%s" % (name, wrong)) from None
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


def _exact(where, value):
    """A number, or a string that is one."""
    if not isinstance(value, str):
        _fail(where, "this is %s" % _kind(value), "give a number, or as a string a ratio")
    try:
        return exact(str(value))
    except ValueError as error:
        _fail(where, error, "give a number such as 0.3085, or as a string a ratio such as \"1/3\"")


def _interval(where, value):
    """A range [low, high] or one number, as Problem takes them: (low, high), finite decimals."""
    ends = value if isinstance(value, list) else [value]
    if len(ends) not in (1, 2) or isinstance(value, list) and len(ends) == 1:
        _fail(where, "%d numbers" % len(ends), "give [low, high] or one number")
    ends = [_exact(where, end) for end in ends]
    try:
        return interval("", (ends[0], ends[-1]))
    except ValueError as error:
        _fail(where, str(error)[2:], "give [low, high] or one number")


def _problem(value):
    _keys("", value, ["harmonics"], ["parameters", "comments", "v0", "v1"])
    harmonics, named = value["harmonics"], _named(value.get("parameters", {}))
    if not isinstance(harmonics, list) or not 1 <= len(harmonics) <= MOST_WAVES:
        _fail("harmonics", "%d of them" % len(harmonics) if isinstance(harmonics, list)
              else "this is " + _kind(harmonics), "give a list of 1 to %d" % MOST_WAVES)
    parameters = list(named.values())       # (low, high); those without a name follow
    waves, constants, slopes = [], [], []
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
        constant, slope = _amplitude(where + ", amplitude", harmonic["amplitude"], list(named),
                                     parameters)
        constants.append(constant)
        slopes.append(slope)
    for m, name in enumerate(named):
        if not any(m in slope for slope in slopes):
            _fail("parameters, " + json.dumps(name), "no amplitude has it", "leave it out")
    if len(parameters) > MOST_PARAMETERS:
        _fail("", "%d parameters and ranges of amplitudes" % len(parameters),
              "give %d at most" % MOST_PARAMETERS)
    if size == 1 and "v1" in value:
        _fail("v1", "on the circle there is no second angle", "leave it out")
    amplitude = [constant + sum(slope[m] * sum(parameters[m]) / 2 for m in slope)
                 for constant, slope in zip(constants, slopes)]
    parts = [[slope.get(m, 0) * (high - low) / 2 for slope in slopes]
             for m, (low, high) in enumerate(parameters)]
    try:
        return Problem.patch(amplitude, parts, waves, *(
            _interval(key, value[key]) if key in value else (0, 2) for key in ("v0", "v1")),
            _comments(value.get("comments", []), named))
    except ValueError as error:
        _fail("", error, "give moderate numbers")


def _named(value):
    """The ranges of the parameters by name."""
    if not isinstance(value, dict):
        _fail("parameters", "this is " + _kind(value), "give an object of ranges by name")
    found = {}
    for name, ends in value.items():
        where = "parameters, " + json.dumps(name[:40])
        if not NAME.fullmatch(name) or name == CONSTANT:
            _fail(where, "this is no name for a parameter",
                  "a name is a letter and then letters and digits, and not " + CONSTANT)
        found[name] = _interval(where, ends)
    return found


def _comments(value, named):
    """The comments as a list, and what the parameters are called, which no proof file says."""
    lines = [value] if isinstance(value, str) else value
    if not isinstance(lines, list) or any(_kind(line) != "a string" for line in lines):
        _fail("comments", "this is no text", "give a string or a list of strings")
    return lines + ["%s from %s to %s (t[%d])" % (name, *map(decimal_text, ends), m)
                    for m, (name, ends) in enumerate(named.items(), 1)]


def _phase(where, value):
    """In units of pi, from -1 (not itself) to 1."""
    phase = PHASES[value] if isinstance(value, str) and value in PHASES else _exact(where, value)
    return 1 - (1 - phase) % 2


def _vector(where, value):
    """The integers k."""
    if not isinstance(value, list) or len(value) not in (1, 2):
        _fail(where, "this is %s" % ("a list of %d" % len(value) if isinstance(value, list)
                                     else _kind(value)), "give [k] or [k0, k1]")
    numbers = [_exact(where, number) if isinstance(number, _Number) else _fail(
        where, "this has %s in it" % _kind(number), "give integers") for number in value]
    if any(number.denominator != 1 or abs(number) > HIGHEST for number in numbers):
        _fail(where, "(%s) is out of range" % ", ".join("%.20s" % number for number in value),
              "give integers from -%d to %d" % (HIGHEST, HIGHEST))
    if not any(numbers):
        _fail(where, "this is zero, and so no harmonic", "leave it out")
    return tuple(map(int, numbers))


def _amplitude(where, value, names, parameters):
    """What is constant of an amplitude, and {m: its slope in the parameter m}.  A range is a new
    parameter of its own."""
    if not isinstance(value, dict):
        low, high = _interval(where, value)
        if low == high:
            return low, {}
        parameters.append((low, high))
        return Fraction(0), {len(parameters) - 1: Fraction(1)}
    for key in value:
        if key not in [*names, CONSTANT]:
            _fail(where, "there is no parameter %s" % json.dumps(key[:40]),
                  "the parameters are %s" % (", ".join(names) or "none; name them in 'parameters'"))
    numbers = {key: _exact("%s, %s" % (where, key), number) for key, number in value.items()}
    for key, number in numbers.items():
        if not is_decimal(number):
            _fail("%s, %s" % (where, key), "%s is no finite decimal" % number, "give one")
    return numbers.pop(CONSTANT, Fraction(0)), {
        names.index(key): number for key, number in numbers.items()}
