"""Trace and eigenvalues of beta, over prisms and over the torus, and the blocks d_j."""

from fractions import Fraction
from itertools import product

import mpmath
import pytest

from converse import kernels
from truth import (DIGITS, TORTURE, beta, cube_point, decimal, eigenvalues, exact, inverse,
                   list_prism, mp, point_of, rng_for, uniform)

DP = 35
SLACK = Fraction(1, 10**(DP - 2))


def beta_at(x):
    with mpmath.workdps(DIGITS):
        return beta(*(mp(x[j]) for j in (0, 1, 2, 5, 6)))


def test_trace_and_eigenvalues_over_a_prism():
    rng = rng_for("btrace")
    tight = []
    for _ in range(1000 * TORTURE):
        prism = list_prism(rng, rng.choice(("3", "0.1", "0.001")), (-2, 2))
        t_lo, t_hi = kernels.btrace(prism, DP)
        (m_lo, m_hi), (b_lo, b_hi) = kernels.Blams(prism, DP)
        traces = []
        for _ in range(12):
            m = beta_at(point_of(prism, cube_point(rng)))
            with mpmath.workdps(DIGITS):
                least, largest = map(exact, eigenvalues(m))
                trace = exact(m[0] + m[2])
            assert t_lo <= trace <= t_hi
            assert m_lo <= least <= m_hi
            assert b_lo <= largest <= b_hi
            traces.append(trace)
        if t_hi > t_lo:
            tight.append((max(traces) - min(traces)) / (t_hi - t_lo))
    tight.sort()
    assert tight[len(tight) // 2] > Fraction(2, 5)


def test_a_point_is_bounded_to_the_last_places():
    rng = rng_for("point")
    for _ in range(500):
        centre = list_prism(rng)[0]
        prism = (centre, [[0] * 7 for _ in range(7)])
        m = beta_at(centre)
        for (lo, hi) in (kernels.btrace(prism, DP), *kernels.Blams(prism, DP)):
            # the root of a discriminant near zero has half the digits
            assert 0 <= hi - lo <= Fraction(1, 10**18)
        with mpmath.workdps(DIGITS):
            lo, hi = kernels.btrace(prism, DP)
            assert lo <= exact(m[0] + m[2]) <= hi and hi - lo <= SLACK


def grid_maxima(a, b, c):
    """The largest trace and eigenvalue of beta on a grid, refined around the best points."""
    def trace(x, y):
        return float(4 + a * mpmath.sin(x) + b * mpmath.sin(y) + 2 * c * mpmath.sin(x + y))

    def eigenvalue(x, y):
        p, q, r = a * mpmath.sin(x), b * mpmath.sin(y), c * mpmath.sin(x + y)
        return float(2 + (p + q + 2 * r + mpmath.sqrt((p - q)**2 + 4 * r * r)) / 2)

    best = []
    with mpmath.workdps(15):
        for f in (trace, eigenvalue):
            n, h = 24, 2 * float(mpmath.pi) / 24
            points = sorted(((f(i * h, j * h), i * h, j * h)
                             for i, j in product(range(n), repeat=2)), reverse=True)[:4]
            top = points[0]
            for point in points:
                step = h
                while step > 1e-7:
                    around = [(f(point[1] + i * step, point[2] + j * step),
                               point[1] + i * step, point[2] + j * step)
                              for i, j in product((-1, 0, 1), repeat=2)]
                    new = max(around)
                    step = step / 2 if new[0] <= point[0] else step
                    point = max(point, new)
                top = max(top, point)
            best.append(top[0])
    return best


@pytest.mark.parametrize("a, b, c", [
    ((0, 0), (0, 0), (0, 0)),
    (("0.30725", "0.30975"), ("0.30725", "0.30975"), ("0.6145", "0.6195")),
    (("0.2", "0.2"), ("0.5", "0.5"), ("0.6", "0.6")),
    (("0.3", "0.3"), ("-0.3", "-0.3"), ("0.6", "0.6")),
    (("-0.4", "-0.1"), ("0.2", "0.3"), ("-0.7", "-0.5")),
    ((1, 1), (0, 0), (0, 0)),
    ((0, 0), (0, 0), ("0.7", "0.8")),
    ((0, 0), ("-0.5", "0.25"), (0, 0)),
    (("-1", "1"), ("-1", "1"), ("-1", "1")),
    ((100, 100), (-30, -30), (55, 55)),
])
def test_bounds_over_the_torus(a, b, c):
    """T and B are above the true maxima over the torus and all parameters, by at most 1e-6."""
    T, B = kernels.torus(a, b, c, DP)
    t = e = -1
    for corner in product(*(sorted(set(map(Fraction, x))) for x in (a, b, c))):
        found = grid_maxima(*map(float, corner))
        t, e = max(t, found[0]), max(e, found[1])
    # the grid's maxima are attained, to about 1e-10
    assert t - 1e-9 <= T <= t + 1e-6
    assert e - 1e-9 <= B <= e + 1e-6


def test_bounds_over_the_torus_for_random_parameters():
    rng = rng_for("torus")
    for _ in range(25 * TORTURE):
        a, b, c = (decimal(uniform(rng, -1, 1), 6) for _ in range(3))
        T, B = kernels.torus((a, a), (b, b), (c, c), DP)
        t, e = grid_maxima(float(a), float(b), float(c))
        assert t - 1e-9 <= T <= t + 1e-6
        assert e - 1e-9 <= B <= e + 1e-6


def test_uniform_cone():
    """low and high are the roots of d = M - k/(4 d), rounded outwards."""
    rng = rng_for("cone")
    for k in (4, 16):
        for i in range(5000 * TORTURE):
            M = decimal(uniform(rng, 0, 5) + (2 if k == 4 else 4), 30)
            low, high = kernels.call("cone", [M, k], 2, DP)
            # x^2 - M x + k/4 is positive outside the roots
            for root in (low, high):
                assert root * root - M * root + Fraction(k, 4) >= 0
            assert 0 < low <= high
            with mpmath.workdps(DIGITS):
                root = exact(mpmath.sqrt(mp(M * M - k)))
            assert 0 <= (M - root) / 2 - low <= SLACK
            assert 0 <= high - (M + root) / 2 <= SLACK


@pytest.mark.parametrize("M, k", [("1.999999", 4), ("-3", 4), ("3.9", 16)])
def test_no_cone(M, k):
    if Fraction(M) > 0:
        with pytest.raises(ArithmeticError):
            kernels.call("cone", [M, k], 2, DP)
    else:                               # a negative bound contradicts itself
        low, high = kernels.call("cone", [M, k], 2, DP)
        assert low >= high or low <= 0


def test_next_block():
    """For blocks d within bounds, and any point of the prism, d' = beta - 1/d is within the next."""
    rng = rng_for("blocks")
    for _ in range(2500 * TORTURE):
        prism = list_prism(rng, rng.choice(("0.5", "0.01")), (-1, 1))
        with mpmath.workdps(DIGITS):
            blocks = []
            for _ in range(4):          # random positive definite blocks
                angle = uniform(rng, 0, "6.3")
                low, high = sorted(mp(uniform(rng, "0.05", 4)) for _ in range(2))
                co, si = mpmath.cos(mp(angle)), mpmath.sin(mp(angle))
                blocks.append((low * co**2 + high * si**2, (low - high) * co * si,
                               low * si**2 + high * co**2))
            slope = decimal(max(exact(d[0] + d[2]) for d in blocks) + Fraction(1, 10**50), 49)
            slope += Fraction(1, 10**49)
            least = max(exact(eigenvalues(d)[0]) for d in blocks)
            least = decimal(least, 49) + Fraction(1, 10**49)
            smallest = decimal(min(exact(eigenvalues(d)[0]) for d in blocks), 49)
            next_slope, next_least = kernels.call(
                "least_lambda", [*prism[0], *(x for row in prism[1] for x in row),
                                 slope, least, smallest], 2, DP)
            for d in blocks:
                m = beta_at(point_of(prism, cube_point(rng)))
                after = [x - y for x, y in zip(m, inverse(d))]
                assert exact(after[0] + after[2]) <= next_slope
                assert exact(eigenvalues(after)[0]) <= next_least


@pytest.mark.parametrize("dp", [1, 2, 5, 35])
def test_next_block_where_nothing_is_lost(dp):
    """beta and d multiples of the identity: all three bounds are equalities, but for rounding."""
    rng = rng_for("equality%d" % dp)
    for _ in range(500 * TORTURE):
        a, v, d = (decimal(uniform(rng, *ends), 12) for ends in ((0, 1), (0, 6), ("0.1", 4)))
        prism = [a, a, 0, 0, 0, v, v] + [0] * 49
        slope, least = kernels.call("least_lambda", prism + [2 * d, d, d], 2, dp)
        with mpmath.workdps(DIGITS):
            true = exact(2 - mp(a) * mpmath.sin(mp(v)) - 1 / mp(d))
        assert 0 <= least - true <= Fraction(20, 10**(dp))
        assert 0 <= slope - 2 * true <= Fraction(20, 10**(dp))


@pytest.mark.parametrize("dp", [1, 2, 3])
def test_few_digits(dp):
    """The bounds over a prism about as small as the last place."""
    rng = rng_for("few%d" % dp)
    for _ in range(1000 * TORTURE):
        centre, matrix = list_prism(rng, Fraction(1, 10**(dp + 3)), (-2, 2))
        prism = (centre, [[x / 10**(dp + 2) for x in row] for row in matrix])
        t_lo, t_hi = kernels.btrace(prism, dp)
        (m_lo, m_hi), (b_lo, b_hi) = kernels.Blams(prism, dp)
        m = beta_at(point_of(prism, cube_point(rng)))
        with mpmath.workdps(DIGITS):
            least, largest = map(exact, eigenvalues(m))
            assert t_lo <= exact(m[0] + m[2]) <= t_hi
        assert m_lo <= least <= m_hi
        assert b_lo <= largest <= b_hi


@pytest.mark.parametrize("dp", [1, 2, 3])
def test_uniform_cone_with_few_digits(dp):
    rng = rng_for("cone%d" % dp)
    for k in (4, 16):
        for _ in range(1000 * TORTURE):
            M = decimal(uniform(rng, 0, 5) + (2 if k == 4 else 4), 30)
            low, high = kernels.call("cone", [M, k], 2, dp)
            with mpmath.workdps(DIGITS):
                root = exact(mpmath.sqrt(mp(M * M - k)))
            assert low <= (M - root) / 2 and (M + root) / 2 <= high
