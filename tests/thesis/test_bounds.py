"""Trace and eigenvalues of beta, over prisms and over the torus, and the blocks d_j."""

import math
import time
from fractions import Fraction
from itertools import product

import mpmath
import pytest

import kernels
from truth import (DIGITS, TORTURE, beta, cube_point, decimal, eigenvalues, exact, inverse,
                   list_prism, mp, point_of, rng_for, uniform)

DP = 35
SLACK = Fraction(1, 10**(DP - 2))


def beta_at(x):
    with mpmath.workdps(DIGITS):
        return beta(*(mp(x[j]) for j in (0, 1, 2, 5, 6)))


def grid_maxima(a, b, c):
    """The largest trace and eigenvalue of beta on a grid, refined around the best points; doubles
    are good enough, by far."""
    def trace(x, y):
        return 4 + a * math.sin(x) + b * math.sin(y) + 2 * c * math.sin(x + y)

    def eigenvalue(x, y):
        p, q, r = a * math.sin(x), b * math.sin(y), c * math.sin(x + y)
        return 2 + (p + q + 2 * r + math.hypot(p - q, 2 * r)) / 2

    best = []
    for f in (trace, eigenvalue):
        n, h = 24, 2 * math.pi / 24
        points = sorted(((f(i * h, j * h), i * h, j * h) for i, j in product(range(n), repeat=2)),
                        reverse=True)[:4]
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


def test_the_cells_cover_the_torus(root):
    """The double that stands for pi is not less."""
    text = (root / "csrc/model/torus.c").read_text("utf-8")
    end = float.fromhex(text.partition("double PI = ")[2].partition(";")[0])
    with mpmath.workdps(DIGITS):
        assert mpmath.pi < end < mpmath.pi + mp(Fraction(1, 2 ** 51))


def torus_values(p, v):
    """Trace and largest eigenvalue of 2I + W, that is of beta at -v, as exact numbers."""
    with mpmath.workdps(DIGITS):
        m = beta(*map(mp, p), *(-mp(x) for x in v))
        return exact(m[0] + m[2]), exact(eigenvalues(m)[1])


def test_bounds_over_a_cell_of_the_torus():
    """Ranges of either sign, the longer side up or down, down to single numbers; cells down to
    points, where nothing but roundings separates the bounds from the truth."""
    rng = rng_for("cell")
    for _ in range(400 * TORTURE):
        size = Fraction(10)**rng.randrange(-9, 9)
        ends = [[decimal(uniform(rng, -2, 2) * size * rng.choice((1, 1, Fraction(1, 50))))
                 for _ in range(2)] for _ in range(3)]
        ranges = [sorted(x) if rng.random() < 0.6 else [x[0]] * 2 for x in ends]
        centre = [decimal(uniform(rng, -7, 7)) for _ in range(2)]
        reach = Fraction(rng.choice((0, 3, 3)), 10**rng.randrange(0, 4))
        half = [decimal(uniform(rng, 0, reach)) for _ in range(2)]
        bounds = kernels.cell(*ranges, centre, half, DP)
        for _ in range(8):
            at = [rng.choice(((-1, 1), (-1, 1), (0, 0), (uniform(rng, -1, 1),) * 2))
                  for _ in range(2)]
            v = [c + h * rng.choice(t) for c, h, t in zip(centre, half, at)]
            true = torus_values([rng.choice(x) for x in ranges], v)
            assert true[0] <= bounds[0] and true[1] <= bounds[1]
        rounding = (1 + sum(max(map(abs, x)) for x in ranges)) * Fraction(1200, 2**53)
        if not any(half) and all(x[0] == x[1] for x in ranges):
            assert bounds[0] - true[0] <= rounding and bounds[1] - true[1] <= rounding


@pytest.mark.parametrize("a, b, c, T, B", [
    ("0", "0", "1", "6", "4"),
    ("0", "0", "-0.75", "5.5", "3.5"),
    ("1000", "1", "0", "1005", "1002"),
    ("1", "-1000", "0", "1005", "1002"),
])
def test_a_ridge_is_bounded_by_what_no_sines_exceed(a, b, c, T, B):
    """The maximum is attained along a line, which cells as small as they would have to be cannot
    cover in a sensible time."""
    found = kernels.torus((a, a), (b, b), (c, c), DP)
    assert 0 <= found[0] - Fraction(T) <= Fraction(1, 10**6)
    assert 0 <= found[1] - Fraction(B) <= Fraction(2, 10**9)


@pytest.mark.parametrize("a, b, c", [("1e-5", "-2e-5", "1"), ("-3e-6", "1e-6", "-1")])
def test_a_ridge_that_is_not_level(a, b, c):
    """Along v0 + v1 = +-pi/2, where the wave of c is largest, the others add hypot(a, b)."""
    T, B = kernels.torus((a, a), (b, b), (c, c), DP)
    sizes = [abs(Fraction(x)) for x in (a, b)]
    rest = Fraction(math.hypot(*map(float, sizes)))
    assert 6 + rest - Fraction(1, 10**12) <= T <= 6 + sum(sizes) + Fraction(1, 10**6)
    assert 4 + rest / 2 - Fraction(1, 10**12) <= B <= 4 + max(sizes) + Fraction(1, 10**6)


@pytest.mark.parametrize("a, b, c", [
    ("-9.6e8", "0.9", "0.3"), ("1", "1", "1e9"), ("1e-5", "-1e-5", "1"), ("1e5", "-1", "1000"),
    ("1e300", "1", "1"), ("1", "1", "-1e306"),
])
def test_bounds_over_the_torus_take_about_a_second(a, b, c):
    """Bounds of what is attained where a wave or two have their maxima; not far from them."""
    begin = time.process_time()
    found = kernels.torus((a, a), (b, b), (c, c), DP)
    assert time.process_time() - begin < 10
    p = list(map(Fraction, (a, b, c)))
    half_pi = kernels.pi(500) / 2
    signs = [1 if x >= 0 else -1 for x in p]
    points = [(signs[0] * half_pi, signs[1] * half_pi), (signs[2] * half_pi / 2,) * 2,
              (signs[0] * half_pi, (signs[2] - signs[0]) * half_pi)]
    with mpmath.workdps(450):
        for v in points:
            m = beta(*map(mp, p), *(-mp(x) for x in v))
            assert exact(m[0] + m[2]) <= found[0] and exact(eigenvalues(m)[1]) <= found[1]
    sizes = list(map(abs, p))
    slack = Fraction(1, 10**6) + sum(sizes) / 10**11
    assert found[0] <= 4 + sizes[0] + sizes[1] + 2 * sizes[2] + slack
    assert found[1] <= 2 + max(sizes[:2]) + 2 * sizes[2] + slack


@pytest.mark.parametrize("size", ["1.7e308", "1e400"])
@pytest.mark.parametrize("which", range(3))
def test_no_double_is_a_bound_beyond_the_doubles(size, which):
    """What is summed overflows, or the number itself."""
    p = [(0, 0)] * 3
    p[which] = (size, size)
    with pytest.raises(ArithmeticError):
        kernels.torus(*p, DP)


def test_constants():
    """T and B hold for all parameters of the box, the cones are theirs, and the first block is
    bounded for every block before it that lies in them."""
    rng = rng_for("constants")
    for k in range(30 * TORTURE):
        centre = [decimal(uniform(rng, -1, 1), 4) for _ in range(3)]
        half = [decimal(uniform(rng, 0, "0.3"), 4) * rng.choice((0, 1, 1)) for _ in range(3)]
        xstar = [decimal(uniform(rng, -4, 4), 17) for _ in range(2)]
        dp = (1, 2, 3, 5, DP)[k % 5]
        T, low, high, B, least, most, slope, first = kernels.constants(centre, half, xstar, dp)
        # moving an angle by pi, or all to their opposites, turns two signs, or all three: the
        # maxima depend on |a|, |b|, |c| alone, and being convex they grow with them
        t, e = grid_maxima(*(float(abs(c) + h) for c, h in zip(centre, half)))
        assert t - 1e-9 <= T <= t + 1e-6 and e - 1e-9 <= B <= e + 1e-6
        blocks = [(min(most, high / 2),) * 2, (most, min(most, high - most))]
        with mpmath.workdps(DIGITS):
            for M, k4, ends in ((T, 16, (low, high)), (B, 4, (least, most))):
                root = exact(mpmath.sqrt(mp(M * M - k4)))
                assert 0 <= (M - root) / 2 - ends[0] <= Fraction(2, 10**dp)
                assert 0 <= ends[1] - (M + root) / 2 <= Fraction(2, 10**dp)
            for corner in product(*({c - h, c + h} for c, h in zip(centre, half))):
                m = beta(*map(mp, corner), *map(mp, xstar))
                for x, y in blocks:
                    after = (m[0] - 1 / mp(x), m[1], m[2] - 1 / mp(y))
                    assert exact(after[0] + after[2]) <= slope
                    assert exact(eigenvalues(after)[0]) <= first


@pytest.mark.parametrize("dp", [1, 2, 3, DP])
def test_uniform_cone(dp):
    """low and high are the roots of d = M - k/(4 d), rounded outwards."""
    rng, unit = rng_for("cone%d" % dp), Fraction(1, 10**dp)
    for k in (4, 16):
        for _ in range(500 * TORTURE):
            M = decimal(uniform(rng, 0, 5) + (2 if k == 4 else 4), 30)
            low, high = kernels.call("cone", [M, k], 2, dp)
            with mpmath.workdps(DIGITS):
                root = exact(mpmath.sqrt(mp(M * M - k)))
            assert 0 <= (M - root) / 2 - low <= 100 * unit
            assert 0 <= high - (M + root) / 2 <= 100 * unit


@pytest.mark.parametrize("M, k", [("1.999999", 4), ("-3", 4), ("3.9", 16)])
def test_no_cone(M, k):
    if Fraction(M) > 0:
        with pytest.raises(ArithmeticError):
            kernels.call("cone", [M, k], 2, DP)
    else:                               # a negative bound contradicts itself
        low, high = kernels.call("cone", [M, k], 2, DP)
        assert low >= high or low <= 0


@pytest.mark.slow
def test_next_block():
    """For blocks d within bounds, and any point of the prism, d' = beta - 1/d is within the
    next."""
    rng = rng_for("blocks")
    for _ in range(500 * TORTURE):
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
    for _ in range(250 * TORTURE):
        a, v, d = (decimal(uniform(rng, *ends), 12) for ends in ((0, 1), (0, 6), ("0.1", 4)))
        prism = [a, a, 0, 0, 0, v, v] + [0] * 49
        slope, least = kernels.call("least_lambda", prism + [2 * d, d, d], 2, dp)
        with mpmath.workdps(DIGITS):
            true = exact(2 - mp(a) * mpmath.sin(mp(v)) - 1 / mp(d))
        assert 0 <= least - true <= Fraction(20, 10**(dp))
        assert 0 <= slope - 2 * true <= Fraction(20, 10**(dp))


@pytest.mark.parametrize("dp", [1, 2, 3])
@pytest.mark.slow
def test_few_digits(dp):
    """The bounds over a prism about as small as the last place."""
    rng = rng_for("few%d" % dp)
    for _ in range(200 * TORTURE):
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


@pytest.mark.parametrize("name, numbers, nout", [
    ("bound_sincos", [1, 0], 4), ("product", [0, 1, 1, 0], 2), ("square", [1, 0], 2),
    ("torus", [0, 1, 1, 0, 0, 1], 2), ("cell", [0, 1, 1, 0, 0, 1, 0, 0, 1, 1], 2),
    ("cell", [0, 1, 0, 1, 0, 1, 0, 0, 1, -1], 2), ("constants", [0, 0, 0, 1, -1, 1, 0, 0], 8),
    ("region", [0, -1], 2), ("cone", [5, 5], 2), ("scale", [1, 10**30], 1),
    ("least_lambda", [0] * 56 + [1, 0, 1], 2), ("least_lambda", [0] * 56 + [-1, 1, 1], 2),
    ("image_ns", [0] * 56 + [10**10], 1),
])
def test_what_makes_no_sense_is_refused(name, numbers, nout):
    for arithmetic in kernels.ARITHMETICS:
        with pytest.raises(ValueError, match="it takes"):
            kernels.call(name, numbers, nout, DP, arithmetic=arithmetic)
