"""The problem: ranges of the parameters a, b, c and of the angles v0, v1 of a successor."""

import os
import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import IO, Sequence, Tuple, Union

NAMES = ("a", "b", "c", "v0", "v1")
LABELS = ("a", "b", "c", "theta[0]", "theta[1]")        # as the input's documentation calls them
MAX_EXPONENT = 300
PLACES = 40                             # to which what is no finite decimal is enclosed
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,9})?")
RATIO = re.compile(r"[+-]?[0-9]+/[0-9]*[1-9][0-9]*")

Number = Union[int, str, Decimal, Fraction]
Range = Tuple[Number, Number]


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

    TypeError, ValueError: a range is none; the text says which and why.
    """

    a: Union[Range, Number]
    b: Union[Range, Number]
    c: Union[Range, Number]
    v0: Union[Range, Number] = (0, 2)
    v1: Union[Range, Number] = (0, 2)
    comments: Tuple[str, ...] = ()
    together: bool = False

    def __post_init__(self):
        for name in NAMES:
            object.__setattr__(self, name, _range(name, getattr(self, name)))
        if not isinstance(self.together, bool):
            raise TypeError("together must be True or False, not %r" % (self.together,))
        comments = [self.comments] if isinstance(self.comments, str) else list(self.comments)
        if not all(isinstance(comment, str) for comment in comments):
            raise TypeError("comments are strings")
        object.__setattr__(self, "comments", tuple(
            line.encode("utf-8", "backslashreplace").decode("utf-8")
            for comment in comments for line in (comment.splitlines() or [""])))

    @classmethod
    def around(cls, centre: Sequence[Number], half: Sequence[Number], comments=(),
               together: bool = False) -> "Problem":
        """From the centres and the half-widths of a, b, c, v0 and v1, as in an input file."""
        if not len(centre) == len(half) == len(NAMES):
            raise ValueError("there are %d centres and %d half-widths where five belong: of a, b, c, "
                             "v0 and v1" % (len(centre), len(half)))
        pairs = [(exact(c), exact(h)) for c, h in zip(centre, half)]
        for name, (_, h) in zip(NAMES, pairs):
            if h < 0:
                raise ValueError("the half-width of %s is negative" % name)
        return cls(*((c - h, c + h) for c, h in pairs), comments=comments, together=together)

    def __repr__(self):
        ranges = ", ".join("%s=%s" % (name, range_text(*getattr(self, name))) for name in NAMES)
        return "Problem(%s%s)" % (ranges, ", together" if self.together else "")

    @property
    def centre(self) -> Tuple[Fraction, ...]:
        """The middles of the five ranges."""
        return tuple((low + high) / 2 for low, high in self._ranges())

    @property
    def half(self) -> Tuple[Fraction, ...]:
        """The half-widths of the five ranges."""
        return tuple((high - low) / 2 for low, high in self._ranges())

    def _ranges(self):
        return [getattr(self, name) for name in NAMES]

    def decimals(self):
        """The centres and the half-widths, each as a list of exact decimal strings."""
        return [decimal_text(x) for x in self.centre], [decimal_text(x) for x in self.half]

    @property
    def full_torus(self) -> bool:
        """Does the region hold every possible successor?"""
        return all(high - low >= 2 for low, high in (self.v0, self.v1))


def _range(name, value):
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
    scale = 10 ** PLACES
    if not _is_decimal(low):
        low = Fraction(low.numerator * scale // low.denominator, scale)
    if not _is_decimal(high):
        high = Fraction(-(-high.numerator * scale // high.denominator), scale)
    return low, high


def exact(x: Number) -> Fraction:
    """The number x, exactly.  TypeError, ValueError: it is none, or out of range."""
    if isinstance(x, str):
        return parse_number(x)
    if isinstance(x, bool) or not isinstance(x, (int, Fraction, Decimal)):
        raise TypeError("%r is not an exact number: give an int, a Fraction, a Decimal or a string "
                        "such as '0.3085' or '63/64'" % (x,))
    if isinstance(x, Decimal):
        return parse_number(str(x))
    return _in_range(Fraction(x), x)


def _in_range(value, given):
    if value and not Fraction(1, 10 ** MAX_EXPONENT) <= abs(value) <= 10 ** MAX_EXPONENT:
        raise ValueError("'%.40s' is out of range" % given)
    return value


def parse_number(text: str) -> Fraction:
    """The exact value of a decimal string, such as 1.25e-3, or of a ratio, such as 63/64;
    ValueError says what is wrong."""
    if RATIO.fullmatch(text):
        return _in_range(Fraction(text), text)
    if not NUMBER.fullmatch(text):
        raise ValueError("'%.40s' is not a decimal number" % text)
    value = Decimal(text)
    if abs(value.adjusted()) > MAX_EXPONENT:
        raise ValueError("'%.40s' is out of range" % text)
    return Fraction(value)


def _odd_part(n):
    """n without its factors 2 and 5, and how often the one that stands more often does."""
    twos = (n & -n).bit_length() - 1
    n >>= twos
    fives = 0
    while n % 5 == 0:
        n //= 5
        fives += 1
    return n, max(twos, fives)


def _is_decimal(x):
    return _odd_part(x.denominator)[0] == 1


def exact_decimal(x):
    """The rational number x, which must be a finite decimal, as a Decimal of the same value."""
    x = Fraction(x)
    rest, places = _odd_part(x.denominator)
    if rest != 1:
        raise ValueError("%s is not a finite decimal" % x)
    digits = Decimal(x.numerator * (10 ** places // x.denominator)).as_tuple()
    return Decimal((digits.sign, digits.digits, -places))


def decimal_text(x):
    """The same as a string, exactly."""
    return str(exact_decimal(x))


def range_text(low, high):
    """A range for a short line."""
    return "%.10g" % low if low == high else "%.10g..%.10g" % (low, high)


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


def read_input(source: Union[str, "os.PathLike[str]", IO]) -> Problem:
    """Reads an input file (thesis, Appendix B) from a path or an open file.

    Five lines of two numbers, centre and half-width, for a, b, c and the two angles, these in units
    of pi; then comment lines.  Blank lines may stand anywhere.  InputError: it is none.
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
    try:
        return Problem.around(centre, half, comments)
    except ValueError as error:
        raise InputError("%s: %s" % (name, error)) from None
