"""Reads the files that describe a problem or a potential: the five lines of 1989 (thesis, Appendix
B), or JSON with the harmonics of a Fourier sum (docs/reference/inputs.md)."""

import json
import os
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from typing import IO, NoReturn, Union

from .exact import exact
from .map import MOST_CHARACTERS, MuldoonMap, affine
from .problem import ANGLES, WHOLE, InputError, Problem, ranges

LABELS = ("a", "b", "c", "theta[0]", "theta[1]")        # as the input's documentation calls them
INTEGER = re.compile("-?[0-9]{1,9}")
MOST_BYTES = 1 << 18                    # of a file, with its comments

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
    is_json = text.lstrip().startswith("{") or name.endswith(".json")
    return (_json if is_json else _five_lines)(text, name)


def _read(source):
    """The text of a path or of an open file, text or binary, and its name for messages."""
    is_path = isinstance(source, (str, os.PathLike))
    name = os.fspath(source) if is_path else getattr(source, "name", None)
    name = name if isinstance(name, str) else "<stdin>"
    if not name:
        raise InputError("the name of the input file is empty; give one")
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
        raise InputError("%s: is longer than %d bytes; name an input file, with shorter comments"
                         % (name, MOST_BYTES))
    if isinstance(data, bytes):
        if data[:2] in (BOM_UTF16_LE, BOM_UTF16_BE) or b"\0" in data[:2]:
            raise InputError("%s: is not text in UTF-8, perhaps in UTF-16; save it in UTF-8" % name)
        try:
            data = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            data = data.decode("latin-1")
    return data.replace("\r\n", "\n").replace("\r", "\n"), name


def _check_length(text):
    if len(text) > MOST_CHARACTERS:
        raise ValueError("the number %.20s... has %d characters; give at most %d"
                         % (text, len(text), MOST_CHARACTERS))


def _number(text):
    _check_length(text)
    return exact(text)


# ---- the five lines of 1989

def _five_lines(text, name):
    lines = text.rstrip("\n").split("\n")
    ranges = []
    used = 0

    def fail(wrong: object, remedy: str) -> NoReturn:
        raise InputError("%s, line %d: %s; %s" % (name, max(used, 1), wrong, remedy))

    for label in LABELS:
        want = "give the centre and the half-width of %s" % label
        while used < len(lines) and not lines[used].strip():
            used += 1
        if used == len(lines):
            fail("the input is empty" if not ranges else "the input ends too early", want)
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
        ranges.append((values[0] - values[1], values[0] + values[1]))

    comments = [line.rstrip() for line in lines[used:]]
    while comments and not comments[0]:
        comments.pop(0)
    while comments and not comments[-1]:
        comments.pop()
    try:
        return Problem(MuldoonMap(*ranges[:3]), *ranges[3:], comments)
    except ValueError as error:
        raise InputError("%s: %s" % (name, error)) from None


# ---- JSON

class _Number(str):
    """A number of JSON, as it is written."""


class _Wrong(Exception):
    """The place of a mistake, what is wrong, and the remedy."""


def _fail(where, wrong, remedy):
    raise _Wrong("%s: %s; %s" % (", " + where if where else "", wrong, remedy))


def _json(text, name):
    """The Problem that a JSON text describes.  The map checks its numbers (map.affine)."""
    try:
        return _problem(json.loads(text, parse_int=_Number, parse_float=_Number,
                                   parse_constant=_Number, object_pairs_hook=_object),
                        os.path.splitext(os.path.basename(name))[0])
    except _Wrong as wrong:
        raise InputError("%s%s" % (name, wrong)) from None
    except json.JSONDecodeError as error:
        raise InputError("%s, line %d: this is not valid JSON (%s, column %d); correct it" % (
            name, error.lineno, error.msg[:1].lower() + error.msg[1:], error.colno)) from None
    except RecursionError:
        raise InputError("%s, line 1: too many brackets in each other; give 'harmonics', a list of "
                         "objects" % name) from None
    except (TypeError, ValueError) as error:
        raise InputError("%s: %s%s" % (
            name, error, "" if ";" in str(error) else "; correct this number")) from None


def _object(pairs):
    """An object of JSON.  No field has two values, and none is true, false, null or too long."""
    found = {}
    for key, value in pairs:
        shown = json.dumps(key[:40])
        if key in found:
            _fail("", "%s is in one object twice" % shown, "leave one out")
        for each in value if isinstance(value, list) else [value]:
            if each is None or isinstance(each, bool):
                _fail(shown, "this is %s" % json.dumps(each), "give a number")
            if isinstance(each, str) and key != "comments":
                _check_length(each)
        found[key] = value
    return found


def _check_fields(where, value, needed, others):
    """Checks that the value is an object with these fields."""
    every = ", ".join(needed + others)
    if not isinstance(value, dict):
        _fail(where, "this is not an object", "give an object with " + every)
    for key in value:
        if key not in needed + others:
            _fail(where, "there is no field %s" % json.dumps(key[:40]), "the fields are " + every)
    for key in needed:
        if key not in value:
            _fail(where, "%s is missing" % key, "the fields are " + every)


def _problem(value, name):
    _check_fields("", value, ["harmonics"], ["parameters", "comments", *ANGLES])
    for key, kinds, want in (("harmonics", (list,), "a list of objects"),
                             ("parameters", (dict,), "an object of ranges by name"),
                             ("comments", (list, str), "a string or a list of strings")):
        if not isinstance(value.get(key, kinds[0]()), kinds):
            _fail(key, "this value has another type", "give " + want)
    waves = []
    for j, harmonic in enumerate(value["harmonics"], 1):
        _check_fields("harmonic %d" % j, harmonic, ["k", "amplitude"], ["phase"])
        where, k = "harmonic %d, k" % j, harmonic["k"]
        if not isinstance(k, list) or not all(
                isinstance(n, _Number) and INTEGER.fullmatch(n) for n in k):
            _fail(where, "this is not a list of integers", "give [k], [k0, k1] or [k0, k1, k2]")
        if not 1 <= len(k) <= 3:
            _fail(where, "maps have one to three angles, not %d" % len(k),
                  "give [k], [k0, k1] or [k0, k1, k2]")
        if len(k) != len(value["harmonics"][0]["k"]):
            _fail(where, "the number of angles is not that of harmonic 1", "give [k], [k0, k1] or "
                  "[k0, k1, k2] in all harmonics")
        waves.append((*map(int, k), *(0,) * (2 - len(k)), harmonic.get("phase", "-sin")))
    for angle in ANGLES[len(k) if waves else 3:]:
        if angle in value:
            _fail(angle, "the map has no such angle", "leave it out")
    made = affine(waves, [harmonic["amplitude"] for harmonic in value["harmonics"]],
                  value.get("parameters", {}), name)
    return Problem(made, comments=value.get("comments", ()),
                   **ranges(value.get(angle, WHOLE) for angle in ANGLES))
