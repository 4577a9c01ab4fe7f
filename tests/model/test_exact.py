"""Exact numbers: what is read is what was written, and what is rounded is rounded outwards."""

import math
import re
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from converse.model.exact import (Interval, ball_text, decimal_text, exact, integer, number_text,
                                  outward, pi_bounds, root_bounds, rounded, rounded_text,
                                  short_text, sine_bounds)

LONG = "0." + "0123456789" * 12
positive = st.fractions(min_value=Fraction(1, 10 ** 40), max_value=10 ** 40)


# ---- reading and writing

@pytest.mark.parametrize("x, value", [
    ("0.3085", "0.3085"), ("-.5", "-1/2"), ("5.", 5), ("1.25e-3", "1/800"), ("63/64", "63/64"),
    ("+4/6", "2/3"), (Decimal("1E+2"), 100), (7, 7), (Fraction(1, 3), "1/3")])
def test_numbers_are_read(x, value):
    assert exact(x) == Fraction(value)


@pytest.mark.parametrize("x, error, words", [
    (0.1, TypeError, "0.1 is not an exact"), (True, TypeError, "not an exact"),
    (None, TypeError, "not an exact"), ("x", ValueError, "'x' is not a decimal"),
    ("", ValueError, "not a decimal"), ("1/0", ValueError, "not a decimal"),
    ("1_0", ValueError, "not a decimal"), (" 1", ValueError, "not a decimal"),
    ("\x1b[1m", ValueError, r"'\\x1b\[1m' is not"), ("nan", ValueError, "not a decimal"),
    (Decimal("inf"), ValueError, "not a decimal"), ("\u0661", ValueError, "not a decimal"),
    ("1e301", ValueError, "out of range"), ("1e-999999999", ValueError, "out of range"),
    ("1e1000000000", ValueError, "out of range: a number is 0 or from"),
    ("0e" + "9" * 20, ValueError, "out of range"),
    (10 ** 301, ValueError, "out of range"), ("1/1" + "0" * 301, ValueError, "out of range")])
def test_what_is_no_number(x, error, words):
    with pytest.raises(error, match=words):
        exact(x)


@given(st.decimals(allow_nan=False, allow_infinity=False, min_value=-10**9, max_value=10**9),
       st.integers(0, 30))
def test_decimal_text_is_exact(x, places):
    for text in decimal_text(Fraction(x)), decimal_text(x, places):
        assert Fraction(text) == Fraction(x)
    assert "E" not in text and len((text + ".").split(".")[1]) >= places


@pytest.mark.slow
def test_decimal_text():
    assert decimal_text(Fraction(617, 1000)) == "0.617"
    assert decimal_text(Fraction(1, 2 ** 30)) == str(Decimal(5 ** 30).scaleb(-30))
    assert decimal_text(Fraction(617, 1000), 6) == "0.617000" and decimal_text(-3, 1) == "-3.0"
    long = Fraction(3, 5 ** 20000)          # longer than Python's limit on int <-> str
    assert Fraction(Decimal(decimal_text(long))) == long
    assert exact(decimal_text(1 + long)) == 1 + long
    ratio = Fraction(3 ** 10000, 7 ** 6000)
    for text in number_text, short_text:
        assert exact(text(ratio)) == ratio and text(Fraction(1, 3)) == "1/3"
    with pytest.raises(ValueError, match="1/3 is not a finite decimal"):
        decimal_text(Fraction(1, 3))


@pytest.mark.parametrize("text", ["0", "1", "-1", "0.30725", "-0.5", "100000", "1e300", "1e-300",
                                  "123456789.0123456789", "1" * 400, "0.000001", LONG, "4/3"])
def test_short_text(text):
    value = Fraction(text)
    assert Fraction(short_text(value)) == value
    assert len(short_text(value)) <= max(len(text), 6)
    assert abs(Fraction(short_text(value, abs(value) / 1000)) - value) <= abs(value) / 1000


# ---- rounding

@given(st.fractions(), st.integers(0, 30))
def test_rounded(x, places):
    down, up = rounded(x, places, up=False), rounded(x, places, up=True)
    assert down <= x <= up and up - down in (0, Fraction(1, 10 ** places))
    assert (up == down) == ((x * 10 ** places).denominator == 1)


def test_integers_of_any_library():
    with pytest.raises(ValueError, match="'10000.*' is out of range: a number is 0 or from"):
        exact(10 ** 5000)
    assert [type(exact(x)) for x in (np.int64(3), np.uint8(3))] == [Fraction] * 2
    assert type(integer(np.int64(3))) is int and integer(3) == 3
    for x in True, 3.0, np.float64(3), "3", Fraction(3):
        with pytest.raises(TypeError):
            integer(x)


@pytest.mark.parametrize("x, inside", [
    (np.int64(1), True), (np.float64(0.5), True), (np.float32(0.5), True), (Decimal(1), True),
    (math.inf, False), (-math.inf, False), (math.nan, False), (Decimal("inf"), False),
    (Decimal("nan"), False), (np.float64("inf"), False), (2, False), ("1", False),
    (None, False), (Fraction(1, 3), True), (1.0000000000000002, False)])
def test_what_is_in_an_interval(x, inside):
    assert (x in Interval(Fraction(0), Fraction(1))) is inside


def test_outward():
    half, third = Fraction(1, 2), Fraction(1, 3)
    assert outward(third, third, 2) == (Fraction("0.33"), Fraction("0.34"))
    assert outward(-third, half, 0) == (-1, half)


@given(positive, st.integers(2, 6))
def test_rounded_text(x, digits):
    down, up = rounded_text(x, digits, up=False), rounded_text(x, digits, up=True)
    assert Fraction(down) <= x <= Fraction(up)
    assert Fraction(up) - Fraction(down) <= x / 10 ** (digits - 1)
    assert {sum(map(str.isdigit, text.partition("e")[0].lstrip("0.")))
            for text in (down, up) if x < 10 ** digits} <= {digits}


@pytest.mark.parametrize("x, digits, down, up", [
    (Fraction(999999), 2, "9.9e5", "1.0e6"), (0, 2, "0", "0"),
    (Fraction("9.6029"), 2, "9.6", "9.7"), (Fraction("0.0961"), 2, "0.096", "0.097"),
    (Fraction("0.35625"), 4, "0.3562", "0.3563"), (Fraction("0.35625"), 5, "0.35625", "0.35625"),
    (Fraction(1, 3000), 2, "3.3e-4", "3.4e-4"), (100, 3, "100", "100"), (1234, 2, "1200", "1300"),
    (0.1, 3, "0.100", "0.101"), (float("inf"), 3, "unbounded", "unbounded")])
def test_a_bound_is_rounded_towards_the_weaker_statement(x, digits, down, up):
    """0.1 is a double, above 1/10."""
    assert (rounded_text(x, digits, up=False), rounded_text(x, digits, up=True)) == (down, up)


@given(st.fractions(), st.one_of(st.just(0), positive), st.integers(-400, 400))
def test_ball_text(low, width, power):
    """The text contains the interval, and is not much wider; it has at most 20 digits."""
    low, high = low * Fraction(10) ** power, (low + width) * Fraction(10) ** power
    digits, error, exponent = re.fullmatch(r"(-?[0-9.]+)(?:\(([0-9]+)\))?(?:e(.*))?",
                                           ball_text(low, high, 20)).groups()
    unit = Fraction(10) ** (int(exponent or 0) - len(digits.partition(".")[2]))
    middle, radius = Fraction(digits) * Fraction(10) ** int(exponent or 0), int(error or 0) * unit
    assert middle - radius <= low and high <= middle + radius
    assert radius <= (high - low) + Fraction(1, 10 ** 18) * max(abs(low), abs(high))
    assert len(digits.replace(".", "").lstrip("-0")) <= 21


def test_balls_as_they_are_printed():
    for low, high, text in (("0.30472e-8", "0.30473e-8", "3.04725(5)e-9"), (0, 0, "0"),
                            ("-0.2500001", "-0.25", "-0.250000(1)"), (100, 300, "2(1)e2"),
                            ("-1e30", "1e30", "0(1)e30"), ("0.5", "0.5", "0.500000")):
        assert ball_text(Fraction(low), Fraction(high), 6) == text


# ---- irrational numbers

def holds(ends, value, digits):
    """Is the true value between the ends, and are these as close as they are to be?"""
    low, high = ends
    assert mpmath.mpf(low.numerator) / low.denominator <= value
    assert value <= mpmath.mpf(high.numerator) / high.denominator
    assert high - low <= Fraction(1, 10 ** digits)


@pytest.mark.parametrize("digits", [0, 1, 15, 60, 500])
def test_irrational_numbers(digits):
    with mpmath.workdps(digits + 60):
        holds(pi_bounds(digits), +mpmath.pi, digits)
        for x in "0", "2", "33", "1e-30", "1/3":
            value = mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator
            holds(root_bounds(Fraction(x), digits), mpmath.sqrt(value), digits)
        for turns in map(Fraction, ("1/3", "-1/7", "0.4999999", "0.5000001", "999/1000", "1/10000",
                                    "7/4", "12345/67", "1.0000001")):
            value = mpmath.sinpi(mpmath.mpf(turns.numerator) / turns.denominator)
            holds(sine_bounds(turns, digits), value, digits)
    for k in range(-8, 9):
        assert sine_bounds(Fraction(k, 2), digits) == ((0, 1, 0, -1)[k % 4],) * 2
