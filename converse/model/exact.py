"""Exact numbers: rationals that are read and written without error, and enclosures of those that
are irrational.

Every exact number of the package is a Fraction.  exact() reads it from whatever a user may give.
number_text() and short_text() write it, and decimal_text() a finite decimal.  rounded_text() writes
a bound, and ball_text() two, rounded towards the weaker statement.
"""

import math
import operator
import re
from decimal import Context, Decimal
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple, Tuple, Union

MAX_EXPONENT = 300                      # A number is 0 or from 10^-300 to 10^300 in size.
LEAST, LARGEST = Fraction(1, 10 ** MAX_EXPONENT), Fraction(10 ** MAX_EXPONENT)
EXPONENT_DIGITS = 9                     # Decimals of longer exponents are errors of decimal.
SHOWN = 20                              # An Interval or a number of a line has 20 digits at most.
FEWEST, MOST = 6, 10000                 # short_text() tries 6, 12, 24, ... digits.
SHORT = 3                               # Numbers from 10^-SHORT to 10^SHORT need no exponent.
DECIMAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?0*([0-9]+))?")
RATIO = re.compile(r"([+-]?[0-9]+)/([0-9]*[1-9][0-9]*)")

Number = Union[int, str, Decimal, Fraction]
Ends = Tuple[Fraction, Fraction]        # the lower and the upper end of an interval


class Interval(NamedTuple):
    """A proved interval: the true number is between the rational numbers lo and hi, or one of
    them.  It is printed as a decimal and its error in units of the last digit, such as
    3.0472(1)e-9."""

    lo: Fraction
    hi: Fraction

    @property
    def mid(self) -> Fraction:
        """The middle, exactly."""
        return (self.lo + self.hi) / 2

    @property
    def rad(self) -> Fraction:
        """Half the width, exactly."""
        return (self.hi - self.lo) / 2

    def __float__(self) -> float:
        return float(self.mid)

    def __contains__(self, x: object) -> bool:
        """Is a number, taken as what it is exactly, in the interval?  Infinity and nan are not."""
        try:
            ratio = x.as_integer_ratio() if hasattr(x, "as_integer_ratio") else (integer(x), 1)
        except (TypeError, ValueError, OverflowError):
            return False
        return self.lo <= Fraction(*map(int, ratio)) <= self.hi

    def __repr__(self) -> str:
        return ball_text(self.lo, self.hi, SHOWN)


# ---- reading

def exact(x: Number) -> Fraction:
    """The number x.  A string is a decimal, such as "1.25e-3", or a ratio, such as "63/64".

    TypeError: x is not an exact number, above all if it is a float, which is seldom the number that
    was meant.  ValueError: a string is not a number, or the number is out of range."""
    if isinstance(x, (str, Decimal)):
        return _parsed(str(x))
    if not isinstance(x, Fraction):
        try:
            x = Fraction(integer(x))
        except TypeError:
            raise TypeError("%.200r is not an exact number: give an int, a Fraction, a Decimal or "
                            "a string such as '0.3085' or '63/64'" % (x,)) from None
    return _in_range(x)


def integer(x: Any) -> int:
    """The integer x, of whatever library, as an int.  TypeError: x is not one, or it is a bool."""
    if isinstance(x, bool):
        raise TypeError("%r is not an integer" % x)
    return operator.index(x)


def is_integer(x: Any) -> bool:
    """Does integer() take x?"""
    try:
        integer(x)
    except TypeError:
        return False
    return True


def whole_number(value: Any, name: str, least: int, most: float = math.inf) -> int:
    """The integer that an argument is; ValueError: it is none, or is not from `least` to `most`."""
    if is_integer(value) and least <= integer(value) <= most:
        return integer(value)
    raise ValueError("%s must be a whole number%s, not %.200r" % (
        name, ", %d or more" % least if most == math.inf else " from %d to %d" % (least, most),
        value))


def _parsed(text):
    if ratio := RATIO.fullmatch(text):      # Decimals have no limit of digits, as int() has
        return _in_range(Fraction(*(int(Decimal(part)) for part in ratio.groups())))
    number = DECIMAL.fullmatch(text)
    if not number:
        raise ValueError("%r is not a decimal number" % text[:40])
    if len(number[3] or "") > EXPONENT_DIGITS or abs(Decimal(text).adjusted()) > MAX_EXPONENT:
        raise _out_of_range(text)
    return Fraction(Decimal(text))


def _in_range(value):
    if value and not LEAST <= abs(value) <= LARGEST:
        raise _out_of_range(number_text(value))
    return value


def _out_of_range(text):
    return ValueError("'%.40s' is out of range: a number is 0 or from 10^-%d to 10^%d in size" % (
        text, MAX_EXPONENT, MAX_EXPONENT))


# ---- writing

def is_decimal(x: Fraction) -> bool:
    """Is x a finite decimal?"""
    return _odd_part(x.denominator)[0] == 1


def number_text(x: Fraction) -> str:
    """The number, exactly: a decimal if it is a finite one, else a ratio."""
    if is_decimal(x):
        return decimal_text(x, 0)
    return "%s/%s" % (Decimal(x.numerator), Decimal(x.denominator))     # str(int) has a limit


def decimal_text(x: Union[int, Decimal, Fraction], places: int = -1) -> str:
    """The rational number x, which must be a finite decimal, exactly; with places >= 0 without an
    exponent and with at least `places` digits after the point."""
    x = Fraction(x)
    rest, needed = _odd_part(x.denominator)
    if rest != 1:
        raise ValueError("%s is not a finite decimal" % number_text(x))
    digits = Decimal(x.numerator * (10 ** needed // x.denominator)).as_tuple()
    value = Decimal((digits.sign, digits.digits, -needed))
    return str(value) if places < 0 else "{:.{}f}".format(value, max(places, needed))


def _odd_part(n):
    """n without its factors 2 and 5, and the larger of their exponents."""
    twos = (n & -n).bit_length() - 1
    n >>= twos
    fives = 0
    while n % 5 == 0:
        n //= 5
        fives += 1
    return n, max(twos, fives)


def short_text(x: Fraction, error: Fraction = Fraction(0)) -> str:
    """A decimal no more than the error away from x; a ratio if that takes too many digits."""
    x = Fraction(x)
    digits = FEWEST if error or is_decimal(x) else MOST + 1
    while digits <= MOST:
        context = Context(prec=digits)
        value = context.divide(Decimal(x.numerator), Decimal(x.denominator))
        if abs(Fraction(value) - x) <= error:
            value = value.normalize(context)
            return format(value, "f") if -7 < value.adjusted() < 16 else str(value).lower()
        digits *= 2
    return number_text(x)


def range_text(low: Fraction, high: Fraction) -> str:
    """A range or a number, for a short line: a range to ten digits or more, and without what is
    not in it."""
    if low == high:
        text = short_text(low)
        return text if len(text) <= SHOWN else "about %.10g" % low
    places = max(9 - _order(max(-low, high)), 2 - _order(high - low))
    return "..".join(short_text(x) for x in (rounded(low, places, up=True),
                                             rounded(high, places, up=False)))


# ---- rounding in a direction

def rounded(x: Fraction, places: int, up: bool) -> Fraction:
    """x rounded down or up to `places` digits after the point; tens are places -1."""
    unit = Fraction(10) ** -places
    return (math.ceil(x / unit) if up else math.floor(x / unit)) * unit


def outward(low: Fraction, high: Fraction, places: int) -> Ends:
    """The interval with its ends rounded outwards, except ends that are finite decimals."""
    return (low if is_decimal(low) else rounded(low, places, up=False),
            high if is_decimal(high) else rounded(high, places, up=True))


def rounded_text(x: Union[int, float, Fraction], digits: int, up: bool) -> str:
    """A proved bound x >= 0, to `digits` significant digits, such as 0.0961 or 1.3e-21.  up: it is
    an upper bound, and is rounded up; else it is a lower bound, and is rounded down.

    The programs print every proved bound by this function, decimal_text() or ball_text()."""
    if x == math.inf:
        return "unbounded"
    x = Fraction(x)
    if not x:
        return "0"
    last = _order(x) - digits + 1                           # the place of the last digit
    bound = rounded(x, -last, up)
    order = _order(bound)               # one more than that of x if all digits were 9
    if -SHORT <= order <= SHORT:
        return decimal_text(bound, max(0, digits - 1 - order))
    text = decimal_text(bound / Fraction(10) ** order, digits - 1)
    return "%se%d" % (text, order)


def ball_text(low: Fraction, high: Fraction, digits: int) -> str:
    """An interval as a decimal and its error in units of the last digit, such as 3.0472(1)e-9: the
    true number is between 3.0471e-9 and 3.0473e-9.

    The text contains the interval.  digits: of the decimal, at most; there are fewer where the
    interval is wide.  An interval that is 0 alone is 0."""
    size = max(abs(low), abs(high))
    if not size:
        return "0"
    order = _order(size)
    middle, half = (low + high) / 2, (high - low) / 2
    last = max(order - digits + 1, _order(half) if half else order - digits + 1)
    while True:
        unit = Fraction(10) ** last
        value = round(middle / unit)
        error = math.ceil(max(high - value * unit, value * unit - low) / unit)
        if error < 100:
            break
        last += 1
    error_text = "(%d)" % error if error else ""
    if -SHORT <= order <= SHORT and last <= 0:
        return decimal_text(value * unit, max(0, -last)) + error_text
    text = str(abs(value))
    return "%s%s%s%se%d" % ("-" * (value < 0), text[0], "." * (len(text) > 1) + text[1:],
                            error_text, last + len(text) - 1)


def _order(x):
    """The exponent of x > 0 in scientific notation."""
    order = math.floor(math.log10(x.numerator) - math.log10(x.denominator))
    while x >= Fraction(10) ** (order + 1):
        order += 1
    while x < Fraction(10) ** order:
        order -= 1
    return order


# ---- irrational numbers

@lru_cache(maxsize=16)
def pi_bounds(digits: int) -> Ends:
    """pi to 10^-digits, by Machin's formula, 16 arctan 1/5 - 4 arctan 1/239, in integers.

    Each term of a series is cut by less than one unit of 10^-(digits + 10).  The terms decrease and
    alternate, so that the terms after the last nonzero one add up to less than one unit."""
    unit = 10 ** (digits + 10)

    def arctan(n):
        total, power, k, off = 0, unit // n, 1, 1
        while power:
            total += power // k if k % 4 == 1 else -(power // k)
            power, k, off = power // (n * n), k + 2, off + 1
        return total, off

    (five, off5), (more, off239) = arctan(5), arctan(239)
    middle, off = 16 * five - 4 * more, 16 * off5 + 4 * off239
    return Fraction(middle - off, unit), Fraction(middle + off, unit)


def root_bounds(x: Fraction, digits: int) -> Ends:
    """The square root of x >= 0, to 10^-digits."""
    scale = 10 ** digits
    low = math.isqrt(x.numerator * scale ** 2 // x.denominator)
    return Fraction(low, scale), Fraction(low + 1, scale)


def sine_bounds(turns: Fraction, digits: int) -> Ends:
    """sin(pi turns), to 10^-digits; exactly, where it is 0, 1 or -1.

    Taylor's series in integers, in units of 10^-(digits + 10), at an angle from 0 to pi/2 that is
    off by less than 2.  Each term is off by less than 2, since the division adds less than 1 and
    multiplies what the term before is off by with (pi/2)^2/6 < 0.42 at most.  The terms decrease
    and alternate, so that the terms after one that is found to be 0 also add up to less than 2."""
    t = Fraction(turns) % 2
    sign, t = (-1, t - 1) if t >= 1 else (1, t)
    t = min(t, 1 - t)
    if t in (0, Fraction(1, 2)):
        return (sign * 2 * t,) * 2
    unit = 10 ** (digits + 10)
    angle = math.floor(pi_bounds(digits + 10)[0] * t * unit)
    total, term, k = 0, angle, 1
    while term:
        total += term
        term = -term * angle * angle // (unit * unit * (k + 1) * (k + 2))
        k += 2
    off = 2 * k + 4                             # there were (k - 1)/2 terms, and the last, 0
    return Fraction(sign * total - off, unit), Fraction(sign * total + off, unit)
