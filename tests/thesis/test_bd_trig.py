"""Sine and cosine over an interval: containment, and no more than that."""

from fractions import Fraction

import mpmath
import pytest

import kernels
from truth import DIGITS, TORTURE, decimal, exact, mp, rng_for, uniform

DP = 35
SLACK = Fraction(3, 10**DP)       # three ulps: what bounds may exceed the range by


def true_range(function, low, high):
    """The range of sin or cos on [low, high], to far more digits than the core has."""
    with mpmath.workdps(DIGITS + len(str(int(abs(high) + abs(low)))) + 10):
        values = [exact(function(mp(low))), exact(function(mp(high)))]
        first = mpmath.pi / 2 if function is mpmath.sin else mpmath.mpf(0)    # a maximum
        for extremum, shift in ((1, 0), (-1, mpmath.pi)):
            k = mpmath.ceil((mp(low) - first - shift) / (2 * mpmath.pi))
            if first + shift + 2 * mpmath.pi * k <= mp(high):
                values.append(Fraction(extremum))
    return min(values), max(values)


def boxes(rng, n):
    """Intervals of every kind, around every special point, on either side of zero."""
    pi = kernels.pi(60)
    for i in range(n):
        kind = i % 8
        if kind == 0:                   # anywhere, any width up to two turns
            low = uniform(rng, -20, 20)
            high = low + uniform(rng, 0, 13)
        elif kind == 1:                 # straddles an extremum or a zero, narrowly
            middle = rng.randrange(-12, 13) * pi / 2
            low = middle - uniform(rng, 0, 1) / 10**rng.randrange(0, 45)
            high = middle + uniform(rng, 0, 1) / 10**rng.randrange(0, 45)
        elif kind == 2:                 # ends just before or begins just after one
            middle = rng.randrange(-12, 13) * pi / 2
            gap, width = uniform(rng, 0, 1) / 10**rng.randrange(20, 50), uniform(rng, 0, 1)
            low, high = ((middle - gap - width, middle - gap) if rng.random() < 0.5
                         else (middle + gap, middle + gap + width))
        elif kind == 3:                 # no width
            low = high = uniform(rng, -30, 30)
        elif kind == 4:                 # tiny
            low = uniform(rng, -7, 7)
            high = low + uniform(rng, 0, 1) / 10**rng.randrange(10, 50)
        elif kind == 5:                 # nearly or just over a half and a whole turn
            low = uniform(rng, -7, 7)
            high = low + rng.choice((1, 2, 3, 4)) * pi / rng.choice((1, 2)) \
                + uniform(rng, -1, 1) / 10**rng.randrange(1, 40)
        elif kind == 6:                 # far away
            low = uniform(rng, -1, 1) * 10**rng.randrange(2, 25)
            high = low + uniform(rng, 0, 7)
        else:                           # around zero
            low = -uniform(rng, 0, 4) / 10**rng.randrange(0, 10)
            high = uniform(rng, 0, 4) / 10**rng.randrange(0, 10)
        yield decimal(min(low, high)), decimal(max(low, high))


@pytest.mark.parametrize("arithmetic", ["apm", "double"])
def test_encloses_and_is_tight(arithmetic):
    rng = rng_for("bd_trig" + arithmetic)
    for low, high in boxes(rng, 500 * TORTURE):
        s_low, s_high, c_low, c_high = kernels.call("bound_sincos", [low, high], 4, DP,
                                                    arithmetic=arithmetic)
        size = max(1, abs(low), abs(high))
        if arithmetic == "apm":
            # turns are known to an ulp each, so very far away an extremum may be imagined
            slack = SLACK + (2 if size * Fraction(1, 10**DP) > Fraction(1, 10**20) else 0)
            miss = Fraction(0)
        elif size > 10**9:
            continue
        else:                           # the filter promises nothing; it should be close
            slack = miss = Fraction(1, 10**12) * size
        for function, lo, hi in ((mpmath.sin, s_low, s_high), (mpmath.cos, c_low, c_high)):
            least, largest = true_range(function, low, high)
            # an extremum within an ulp of the end may be counted in: second order
            assert least - slack <= lo <= least + miss, (function, low, high)
            assert largest - miss <= hi <= largest + slack, (function, low, high)


def test_as_printed_misses_the_maximum_below_zero():
    """Erratum: cutting off the fraction is no floor below zero."""
    low, high = kernels.bound_cos(-1, 1, DP, as_printed=True)
    assert high < 1
    low, high = kernels.bound_cos(-1, 1, DP)
    assert high == 1
    low, high = kernels.bound_sin("0", "6.28", DP, as_printed=True)
    assert high < Fraction(1, 2)
    assert kernels.bound_sin("0", "6.28", DP) == (-1, 1)


@pytest.mark.parametrize("dp", [1, 2, 3, 10, 100])
def test_other_precisions(dp):
    rng = rng_for("dp%d" % dp)
    for low, high in boxes(rng, 300 * TORTURE):
        bounds = kernels.call("bound_sincos", [low, high], 4, dp)
        for function, lo, hi in ((mpmath.sin, *bounds[:2]), (mpmath.cos, *bounds[2:])):
            with mpmath.workdps(200):
                for x in (low, high, (low + high) / 2, decimal(uniform(rng, low, high), 100)):
                    assert lo <= exact(function(mp(x))) <= hi
