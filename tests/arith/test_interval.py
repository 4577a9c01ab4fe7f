"""Intervals of doubles (csrc/arith/interval.h): each result holds the operation's value for all
members, whatever the operands are, and is not much wider than it must be."""

import ctypes
import math
import os
import re
import shutil
import subprocess
from fractions import Fraction

import mpmath
import pytest

from truth import TORTURE, rng_for

CODE = """
#include "arith/interval.h"
void operate(const interval *x, const interval *y, double t, interval *out)
{
    out[0] = interval_add(*x, *y);
    out[1] = interval_sub(*x, *y);
    out[2] = interval_mul(*x, *y);
    out[3] = interval_scale(t, *x);
    out[4] = interval_about(x->low, fabs(t));
    out[5] = interval_of(t);
    interval_sincos(out + 6, out + 7, *x);
    out[8] = (interval){ just_below(t), just_above(t) };
    out[9] = (interval){ just_below(t / x->low), just_above(t / x->low) };
    out[10] = (interval){ just_below(sqrt(t)), just_above(sqrt(t)) };
    out[11] = (interval){ -interval_size(*x), interval_size(*x) };
}
"""
NAMES = ("add", "sub", "mul", "scale", "about", "of", "sin", "cos", "moved", "quotient", "root",
         "size")
LARGEST, TINY, INF = 1.7976931348623157e308, 5e-324, math.inf
HOSTILE = (0.0, -0.0, TINY, 3 * TINY, 2.0 ** -1022, 2.0 ** -1021.5, 2.0 ** -951, 2.0 ** -900,
           2.0 ** -540, 1.0, 1 + 2.0 ** -52, 1 - 2.0 ** -53, 1.5e6, 2.0 ** 512, 1e300, LARGEST / 2,
           LARGEST)


@pytest.fixture(scope="module")
def every(root, tmp_path_factory):
    if not shutil.which("gcc"):
        pytest.skip("needs gcc")
    folder = tmp_path_factory.mktemp("interval")
    (folder / "every.c").write_text(CODE)
    flags = re.findall(r'"(-[^"]+)"', re.search(
        r"FLAGS = (\[.*?\])", (root / "converse" / "_build.py").read_text("utf-8"), re.S)[1])
    csrc = os.environ.get("CONVERSE_CSRC", root / "csrc")       # tests/mutate has its own
    subprocess.run(["gcc", *flags, "-O2", "-shared", "-fPIC", "-I%s" % csrc,
                    str(folder / "every.c"), "-lm", "-o", str(folder / "every.so")], check=True)
    function = ctypes.CDLL(str(folder / "every.so")).operate

    def call(x, y, t):
        pair, out = ctypes.c_double * 2, (ctypes.c_double * (2 * len(NAMES)))()
        function(pair(*x), pair(*y), ctypes.c_double(t), out)
        return {name: (out[2 * j], out[2 * j + 1]) for j, name in enumerate(NAMES)}
    return call


def holds(bounds, x):
    """Is the real number, a Fraction or an mpf, within the bounds?"""
    low, high = bounds
    if isinstance(x, Fraction):
        return ((low == -INF or Fraction(low) <= x) and (high == INF or x <= Fraction(high)))
    return low <= x <= high


def draw(rng):
    kind = rng.randrange(4)
    if kind == 0:
        return rng.choice((-1, 1)) * rng.choice(HOSTILE)
    if kind == 1:
        return rng.uniform(-10, 10)
    return rng.choice((-1, 1)) * rng.random() * 2.0 ** rng.randrange(-1070, 1024)


def test_every_operation_holds_all_members(every):
    rng = rng_for("intervals")
    for _ in range(4000 * TORTURE):
        x, y = (sorted((draw(rng), draw(rng))) if rng.random() < 0.7 else [draw(rng)] * 2
                for _ in range(2))
        t = draw(rng)
        out = every(x, y, t)
        assert all(low <= high for low, high in out.values())       # and none is NaN
        f = Fraction(t)
        for p in {*map(Fraction, x), sum(map(Fraction, x)) / 2}:
            for q in {*map(Fraction, y), sum(map(Fraction, y)) / 2}:
                assert holds(out["add"], p + q) and holds(out["sub"], p - q)
                assert holds(out["mul"], p * q)
            assert holds(out["scale"], f * p) and holds(out["size"], abs(p))
            if abs(p) < 10 ** 30:
                with mpmath.workdps(80):
                    at = mpmath.mpf(p.numerator) / p.denominator
                    assert holds(out["sin"], mpmath.sin(at)) and holds(out["cos"], mpmath.cos(at))
        assert all(holds(out["about"], Fraction(x[0]) + way * f) for way in (-1, 1))
        assert out["of"] == (t, t) and out["moved"][0] < t < out["moved"][1]
        assert x[0] == 0 or holds(out["quotient"], f / Fraction(x[0]))
        if t >= 0:
            low, high = out["root"]
            assert low <= 0 or Fraction(low) ** 2 <= f
            assert high == INF or Fraction(high) ** 2 >= f


@pytest.mark.parametrize("x", [(math.nan, math.nan), (math.nan, 1.0), (-INF, INF), (0.0, INF),
                               (-INF, -1.0), (LARGEST, INF)])
def test_what_is_not_known_is_the_whole_line(every, x):
    """NaN and infinite ends: nothing becomes narrower, and no result is NaN."""
    for y in ((0.0, 0.0), (-1.0, 2.0), (3.0, 3.0), (-INF, INF), (math.nan, math.nan)):
        for t in 0.0, -2.0, 1e308, INF, math.nan:
            out = every(x, y, t)
            known = {name: value for name, value in out.items() if name not in ("of", "size")}
            assert not any(map(math.isnan, sum(known.values(), ())))
            assert out["sin"] == out["cos"] == (-1.0, 1.0)
            assert math.isfinite(t) or out["of"] == out["moved"] == (-INF, INF) or t == INF
            for name in "add", "sub":
                low, high = out[name]
                assert low == -INF or x[0] > -INF and y[0] > -INF
                assert high == INF or (x[1] < INF and math.isfinite(y[0]) and not math.isnan(x[1]))
            if math.isnan(x[0]) or math.isnan(y[0]):
                assert out["mul"] == (-INF, INF)
    assert every((0.0, 1.0), (0.0, 1.0), INF)["of"] == (-INF, INF)


def test_intervals_are_tight(every):
    """A few units of the last place, where there are no tiny numbers."""
    rng = rng_for("tight intervals")
    for _ in range(500 * TORTURE):
        p, q, t = (rng.choice((-1, 1)) * rng.uniform(0.1, 9) for _ in range(3))
        out = every((p, p), (q, q), t)
        for name in "add", "sub", "mul", "scale", "quotient", "moved":
            low, high = out[name]
            assert high - low <= 12 * 2.0 ** -53 * max(abs(low), abs(high))
        for name in "sin", "cos":
            assert out[name][1] - out[name][0] <= 24 * 2.0 ** -53 + 24 * 2.0 ** -53 * abs(p)
        assert out["about"][1] - out["about"][0] <= 2 * abs(t) + 24 * 2.0 ** -53 * (abs(p) + abs(t))


def test_what_is_beyond_the_sines_is_anything(every):
    assert every((2e6, 2e6), (0.0, 0.0), 0.0)["sin"] == (-1.0, 1.0)
    low, high = every((1.0, 2.0), (0.0, 0.0), 0.0)["sin"]
    assert low <= math.sin(1.0) and high == 1.0


def test_the_sines_of_neighbours_and_of_points(every):
    """Where the middle of an interval is one of its ends, and what the sine is proved to be off."""
    rng = rng_for("neighbours")
    for _ in range(100 * TORTURE):
        low = rng.choice((-1, 1)) * rng.uniform(1e4, 1e6)
        x = low, math.nextafter(low, INF)
        out = every(x, x, 0.0)
        with mpmath.workdps(40):
            for p in map(mpmath.mpf, x):
                assert holds(out["sin"], mpmath.sin(p)) and holds(out["cos"], mpmath.cos(p))
        for low, high in (every((low, low), x, 0.0)[name] for name in ("sin", "cos")):
            assert high - low >= 2 ** -50 or low == -1 or high == 1
