"""csrc/arith/apm.c against Python's fractions: every operation, every rounding direction."""

import re
import sys
from decimal import Decimal
from fractions import Fraction
from math import floor

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import kernels

if hasattr(sys, "set_int_max_str_digits"):
    sys.set_int_max_str_digits(0)

DP = 12


def decimals(digits=60, exponent=90):
    """Finite decimals as (text, value), with many digits and far exponents."""
    def make(mantissa, exponent):
        text = "%de%d" % (mantissa, exponent)
        return text, Fraction(Decimal(text))
    return st.builds(make, st.integers(-10**digits, 10**digits),
                     st.integers(-exponent, exponent))


def call(name, *texts, nout=1, dp=DP):
    return kernels.call(name, texts, nout, dp)


@given(decimals(), decimals())
@example(("0e50", Fraction(0)), ("1e-50", Fraction(1, 10**50)))
@example(("1e90", Fraction(10**90)), ("-1e-90", Fraction(-1, 10**90)))
def test_ring_operations_are_exact(x, y):
    assert call("add", x[0], y[0]) == [x[1] + y[1]]
    assert call("sub", x[0], y[0]) == [x[1] - y[1]]
    assert call("mul", x[0], y[0]) == [x[1] * y[1]]
    assert call("cmp", x[0], y[0]) == [(x[1] > y[1]) - (x[1] < y[1])]


def rounded(x, dp):
    """(down, up, towards zero) to dp places."""
    down = Fraction(floor(x * 10**dp), 10**dp)
    up = -Fraction(floor(-x * 10**dp), 10**dp)
    return [down, up, up if x < 0 else down]


@given(decimals(), decimals(), st.integers(1, 200))
@example(("1e0", Fraction(1)), ("3e0", Fraction(3)), 1)
@example(("-1e0", Fraction(-1)), ("3e0", Fraction(3)), 35)
@example(("1e90", Fraction(10**90)), ("7e-90", Fraction(7, 10**90)), 5)
def test_division_keeps_its_direction(x, y, dp):
    if y[1] == 0:
        with pytest.raises(ArithmeticError):
            call("div", x[0], y[0], nout=3, dp=dp)
    else:
        assert call("div", x[0], y[0], nout=3, dp=dp) == rounded(x[1] / y[1], dp)


@given(decimals(), st.integers(1, 250))
@example(("-5e-3", Fraction(-5, 1000)), 2)
@example(("-1999999999999999999999999999999999999e-200", None), 160)
def test_rounding_keeps_its_direction(x, dp):
    value = Fraction(Decimal(x[0]))
    expected = rounded(value, dp)
    if expected[0] == expected[1]:
        expected = [value] * 3
    assert call("round", x[0], nout=3, dp=dp) == expected


@given(decimals())
@example(("-3e-1", Fraction(-3, 10)))
@example(("-4e0", Fraction(-4)))
def test_floor_is_a_floor_also_below_zero(x):
    assert call("floor", x[0]) == [floor(x[1])]


@given(decimals(), st.integers(1, 120))
@example(("4e0", Fraction(4)), 10)
@example(("2e0", Fraction(2)), 1)
@example(("1e-90", Fraction(1, 10**90)), 3)
@example(("-1e0", Fraction(-1)), 3)
def test_square_root_encloses(x, dp):
    if x[1] < 0:
        with pytest.raises(ArithmeticError):
            call("sqrt", x[0], nout=2, dp=dp)
        return
    low, high = call("sqrt", x[0], nout=2, dp=dp)
    assert low * low <= x[1] <= high * high
    assert high - low == (0 if low * low == x[1] else Fraction(1, 10**dp))


@given(decimals(), st.integers(-500, 500))
def test_scale(x, places):
    assert call("scale", x[0], str(places)) == [x[1] * Fraction(10)**places]


OPERATIONS = ("set", "neg", "abs", "add", "sub", "mul", "mul_si", "scale", "round", "floor", "sqrt",
              "div")                        # numbers.c: operate


@pytest.mark.parametrize("which", range(len(OPERATIONS)), ids=OPERATIONS)
@given(x=decimals(), y=decimals(), dp=st.integers(1, 120), direction=st.integers(0, 2))
@example(x=("7e20", None), y=("3e0", None), dp=3, direction=0)
@example(x=("3e0", None), y=("7e20", None), dp=3, direction=1)
def test_results_may_be_operands(which, x, y, dp, direction):
    if OPERATIONS[which] == "sqrt":
        x = y = (x[0].lstrip("-"), None)
    try:
        apart, *in_place, twice, twice_in_place = call(
            "in_place", str(which), str(direction), x[0], y[0], nout=5, dp=dp)
    except ArithmeticError:
        assert OPERATIONS[which] == "div"
        return
    assert in_place == [apart, apart]
    assert twice_in_place == twice


def test_the_header_has_no_other_operation(root):
    header = (root / "csrc" / "arith" / "apm.h").read_text("utf-8")
    named = re.findall(r"^(?:int|void) apm_(\w+)\(apm_t r, const apm_t x", header, re.MULTILINE)
    assert sorted(named) == sorted(OPERATIONS)


@given(decimals())
def test_order_bounds_the_magnitude(x):
    order = int(call("order", x[0])[0])
    if x[1] == 0:
        assert order == 0
    else:
        assert Fraction(10)**(order - 2) <= abs(x[1]) < Fraction(10)**order


@given(st.floats(allow_nan=False, allow_infinity=False))
@example(5e-324)
@example(1.7976931348623157e308)
@example(0.1)
def test_doubles_come_back(x):
    """A double written out in full is read back to within two units in the last place."""
    [back] = call("double", "%.20e" % x)
    if abs(x) < 2.3e-308:
        assert abs(back) <= 2 * Fraction(2.3e-308)
    elif abs(x) < 1.7e308:
        assert abs(back - Fraction(x)) <= abs(Fraction(x)) * Fraction(1, 2**51)


@given(st.one_of(decimals(), st.floats(-1e300, 1e300).map(lambda x: ("%.40e" % x, Fraction(
    "%.40e" % x)))))
@example(("0", Fraction(0)))
@example(("4e-324", Fraction(4, 10**324)))
def test_bounds_by_doubles_lie_on_their_sides(x):
    low, high = call("bounds", x[0], nout=2)
    assert low <= x[1] <= high
    assert high - low <= max(abs(x[1]) / 2**50, Fraction(1, 2**1072))


def test_doubles_are_written_exactly():
    """0.1 is not the nearest double, and the nearest double is not 0.1."""
    assert call("double", "0.1") == [Fraction(0.1)]
    assert Fraction(0.1) != Fraction(1, 10)
    assert call("add", "0.1", "0") == [Fraction(1, 10)]


@pytest.mark.parametrize("text", ["1e309", "-2e400"])
def test_what_no_double_holds_is_an_error(text):
    with pytest.raises(ArithmeticError):
        call("double", text)


@pytest.mark.parametrize("text", ["", "-", "+", ".", "1.2.3", "1e", "1e+", "e5", "0x10", "1 ",
                                  " 1", "nan", "inf", "1_000", "--1", "1e400000", "1e-400000",
                                  "١", "1,5"])
def test_not_numbers(text):
    with pytest.raises(ValueError):
        call("add", text, "0")


@pytest.mark.parametrize("text", ["1.", ".5", "+.5e-3", "-0", "007", "1E5", "1e+5", "-12.500"])
def test_numbers(text):
    assert call("add", text, "0") == [Fraction(Decimal(text))]


@settings(max_examples=20)
@given(st.integers(10**5000, 10**6000), st.integers(2, 10**3000))
def test_thousands_of_digits(x, y):
    assert call("div", str(x), str(y), nout=3, dp=4000) == rounded(Fraction(x, y), 4000)
