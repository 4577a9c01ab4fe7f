"""csrc/arith/special.c against mpmath at many more digits: pi, sine, cosine, square root."""

import sys
from decimal import Decimal
from fractions import Fraction

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kernels

if hasattr(sys, "set_int_max_str_digits"):
    sys.set_int_max_str_digits(0)


def true_value(function, x, dp):
    """function(x) with at least dp + 20 correct decimals, x exact."""
    digits = dp + 40 + len(str(abs(x.numerator)))
    with mpmath.workdps(digits):
        y = function(mpmath.mpf(x.numerator) / x.denominator)
        return Fraction(str(mpmath.nstr(y, digits, strip_zeros=False)))


def check(x, dp):
    """The promise of Appendix B: |sin~ x - sin x| <= 10^-dp, likewise the cosine."""
    sine, cosine = kernels.call("sincos", [x], 2, dp)
    x = Fraction(Decimal(x)) if isinstance(x, str) else x
    allowed = Fraction(1, 10**(dp))
    assert abs(sine - true_value(mpmath.sin, x, dp)) <= allowed
    assert abs(cosine - true_value(mpmath.cos, x, dp)) <= allowed
    assert abs(sine) <= 1 and abs(cosine) <= 1


@pytest.mark.parametrize("dp", [1, 2, 5, 10, 40, 100, 1000])
def test_pi_is_cut_off(dp):
    with mpmath.workdps(dp + 30):
        digits = mpmath.nstr(+mpmath.pi, dp + 20)
    assert kernels.pi(dp) == Fraction(Decimal(digits[:dp + 2]))


def test_ten_thousand_digits():
    with mpmath.workdps(10100):
        digits = str(mpmath.nstr(+mpmath.pi, 10020))
        sine = Fraction(mpmath.nstr(mpmath.sin(mpmath.mpf(7) / 5), 10050))
    assert kernels.pi(10000) == Fraction(Decimal(digits[:10002]))
    assert abs(kernels.sin("1.4", 10000) - sine) <= Fraction(1, 10**10000)


@pytest.mark.parametrize("dp", [1, 3, 10, 35, 50, 100])
def test_multiples_of_half_pi(dp):
    """At and next to multiples of pi/2 and pi/4, on both sides, from inside and outside."""
    pi = kernels.pi(dp + 30)
    for k in list(range(-9, 10)) + [1000, 10**6, -10**9]:
        for e in (0, dp // 2, dp, dp + 4, dp + 9):
            for sign in (-1, 0, 1):
                check(k * pi / 4 + sign * Fraction(1, 10**e), dp)


@pytest.mark.parametrize("dp", [1, 10, 35, 60])
def test_tiny_and_huge(dp):
    for text in ("0", "1e-1", "1e-30", "-1e-200", "1e5", "-1e30", "1e100", "123456789e80",
                 "3.14159", "-0.785398163397448", "1e1000"):
        check(text, dp)


@given(st.decimals(-100, 100, places=30), st.sampled_from([2, 7, 20, 35, 75]))
def test_anywhere(x, dp):
    check(Fraction(x), dp)


@pytest.mark.parametrize("dp", [1, 10, 35, 60])
def test_one_after_another(dp):
    """What is kept from one argument serves the next, however much longer: the unit's own first
    sine is that of a few tenths with two places more than dp."""
    for places in range(dp, dp + 5):
        for digits in (0, 1, 5, 18, 19, 20, 21, 25, 40, 80, 200):
            check(10**digits + Fraction(1, 10**places), dp)


@pytest.mark.parametrize("dp", [1, 10, 35, 60, 250])
@pytest.mark.slow
def test_every_size(dp):
    """However often an angle is halved, down to where nothing is left of it."""
    for j in range(int(3.4 * dp) + 40):
        check(Fraction(3 * 5**j // 4, 10**j) + Fraction(1, 10**(j + 2)), dp)


@given(st.decimals(0, 10**6, places=12), st.integers(1, 60))
def test_sqrt(x, dp):
    root = kernels.sqrt(x, dp)
    assert root**2 <= Fraction(x) < (root + Fraction(1, 10**dp))**2


@pytest.mark.parametrize("dp", [3000, 3001])
def test_identities_of_thousands_of_digits(dp):
    """Nothing else knows so many digits of these: the functions bear each other out."""
    x, unit = Fraction(31415926, 10**7), Fraction(1, 10**dp)
    sine, cosine = kernels.call("sincos", [x], 2, dp)
    twice, double = kernels.call("sincos", [2 * x], 2, dp + 700)
    assert abs(sine**2 + cosine**2 - 1) <= 5 * unit
    assert abs(twice - 2 * sine * cosine) <= 5 * unit
    assert abs(double - 2 * cosine**2 + 1) <= 5 * unit
    assert 0 <= kernels.pi(dp + 700) - kernels.pi(dp) < unit
