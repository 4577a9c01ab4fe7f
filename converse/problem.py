"""The problem: ranges of the parameters a, b, c and of the angles v0, v1 of a successor."""

import os
import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Tuple

NAMES = ("a", "b", "c", "v0", "v1")
LABELS = ("a", "b", "c", "theta[0]", "theta[1]")        # as the input's documentation calls them
MAX_EXPONENT = 300
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,9})?")


class InputError(ValueError):
    """The input is not a problem; the text names the file, the line and the remedy."""


@dataclass(frozen=True)
class Problem:
    """Five ranges centre +- half; exact numbers, the angles v0 and v1 in units of pi.

    together: a, b and c move together, along the segment from all lower to all upper ends."""

    centre: Tuple[Fraction, ...]
    half: Tuple[Fraction, ...]
    comments: Tuple[str, ...] = ()
    together: bool = False

    def decimals(self):
        """The centres and the half-widths, each as a list of exact decimal strings."""
        return [decimal_text(x) for x in self.centre], [decimal_text(x) for x in self.half]

    @property
    def full_torus(self):
        """Does the region hold every possible successor?"""
        return self.half[3] >= 1 and self.half[4] >= 1


def exact_decimal(x):
    """The rational number x, which must be a finite decimal, as a Decimal of the same value."""
    x = Fraction(x)
    rest = x.denominator
    twos = (rest & -rest).bit_length() - 1
    rest >>= twos
    fives = 0
    while rest % 5 == 0:
        rest //= 5
        fives += 1
    if rest != 1:
        raise ValueError("%s is not a finite decimal" % x)
    places = max(twos, fives)
    digits = Decimal(x.numerator * (10 ** places // x.denominator)).as_tuple()
    return Decimal((digits.sign, digits.digits, -places))


def decimal_text(x):
    """The same as a string, exactly."""
    return str(exact_decimal(x))


def parse_number(text):
    """The exact value of a decimal string, such as 1.25e-3; ValueError says what is wrong."""
    if not NUMBER.fullmatch(text):
        raise ValueError("'%s' is not a decimal number" % text)
    value = Decimal(text)
    if abs(value.adjusted()) > MAX_EXPONENT:
        raise ValueError("'%s' is out of range" % text)
    return Fraction(value)


def _read(source):
    """The text of a path or of an open file, text or binary, and its name for messages."""
    is_path = isinstance(source, (str, os.PathLike))
    name = os.fspath(source) if is_path else getattr(source, "name", None)
    name = name if isinstance(name, str) else "<stdin>"
    try:
        if is_path:
            with open(source, "rb") as file:
                data = file.read()
        else:
            data = getattr(source, "buffer", source).read()
    except OSError as error:
        raise InputError("%s: cannot be read (%s); name a readable file"
                         % (name, error.strerror or error)) from None
    if isinstance(data, bytes):
        try:
            data = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            data = data.decode("latin-1")
    return data.replace("\r\n", "\n").replace("\r", "\n"), name


def read_input(source):
    """Reads an input file (thesis, Appendix B) from a path or an open file.

    Five lines of two numbers, centre and half-width, for a, b, c and the two angles; then
    comment lines.  Blank lines may stand anywhere.
    """
    text, name = _read(source)
    lines = text.rstrip("\n").split("\n")
    centre, half = [], []
    used = 0

    def fail(wrong, remedy):
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
            values = [parse_number(word) for word in words]
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
    return Problem(tuple(centre), tuple(half), tuple(comments))
