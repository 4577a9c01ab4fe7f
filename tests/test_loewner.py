"""The sharper method, piece by piece, against an independent truth.

Random prisms, random exact points inside, their orbits with many digits: they must lie where the
core says; and the second variation along them must be below the bound.
"""

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from truth import TORTURE, beta, mp, rng_for

from converse import ConverseError, Problem, kernels, prove
from converse.core import Search, Task, ffi
from converse.growth import MANY
from converse.tree import ROOT, cells

CASES = 10000 * TORTURE
SITES = 60                              # of the core's longest vector


def draw(rng):
    """A prism: centres and half-widths of a, b, c, v0, v1, x*, and whether a, b, c move together."""
    size = 10.0 ** rng.uniform(-2, 0.3)
    centre = [rng.choice([size, -size, size * rng.uniform(-1, 1), 0.0]) for _ in range(3)]
    centre[0] = centre[0] or size           # c alone would make the bound B slow
    half = [rng.choice([0.0, 10.0 ** rng.uniform(-14, -1.5) * size,
                        rng.uniform(0, 2) * size]) for _ in range(3)]
    centre += [rng.choice([rng.uniform(-7, 7), 1e-9, 1.5707963267948966]) for _ in range(2)]
    half += [rng.choice([0.0, 10.0 ** rng.uniform(-13, -1)]) for _ in range(2)]
    star = [rng.choice([rng.uniform(-4, 4), 0.8547]) for _ in range(2)]
    return [*map(Fraction, centre + half + star), Fraction(rng.random() < 0.5)]


def inside(rng, prism):
    """A random exact point of the prism, often at its edge: five symbols and five numbers."""
    together = prism[12]
    e = [Fraction(rng.choice([-1, 1, 0, rng.uniform(-1, 1)])) for _ in range(5)]
    if together:
        e[1] = e[2] = e[0]
    return e, [c + h * s for c, h, s in zip(prism[:5], prism[5:10], e)]


def orbit(point, star, first, last):
    """The points first..last of the orbit through x*, v, by index."""
    a, b, c = map(mp, point[:3])
    x = {0: list(map(mp, star)), 1: list(map(mp, point[3:]))}

    def beyond(here, before):
        u, v = here
        w = c * mpmath.cos(u + v)
        return [2 * u - before[0] + a * mpmath.cos(u) + w, 2 * v - before[1] + b * mpmath.cos(v) + w]

    for j in range(2, last + 1):
        x[j] = beyond(x[j - 1], x[j - 2])
    for j in range(-1, first - 1, -1):
        x[j] = beyond(x[j + 1], x[j + 2])
    return x


@pytest.fixture(autouse=True)
def many_digits():
    with mpmath.workdps(40):
        yield


def test_sines():
    rng, worst = rng_for("loewner sines"), 0
    for n in range(CASES):
        x = rng.choice([rng.uniform(-10, 10), rng.uniform(-1.5e6, 1.5e6), rng.gauss(0, 1e-6),
                        float(rng.randrange(-900000, 900000)) * 1.5707963267948966])
        if n % 7 == 0:                      # the doubles next to multiples of pi/4
            x = float(mpmath.pi / 4 * rng.randrange(-1000000, 1000000)) * rng.choice(
                [1, 1 - 2.0 ** -53, 1 + 2.0 ** -52])
        s, c = kernels.call("double_sincos", [Fraction(x)], 2, 10)
        worst = max(worst, abs(mp(s) - mpmath.sin(x)),
                    abs(mp(c) - mpmath.cos(x)))
    assert 2.0 ** -54 < worst <= 2.0 ** -52             # the promise is 2^-51
    with pytest.raises(ArithmeticError):
        kernels.call("double_sincos", [2 * 10 ** 6], 2, 10)


def displacements(rng, cases):
    """Yields prism, coordinate, how far a random point of a random prism's orbit is from where the
    columns put it, the core's bound of that, how far it is from the centre's, the bound of that."""
    for _ in range(cases):
        prism, n = draw(rng), rng.choice([-1, 1]) * rng.randrange(1, 9)
        try:
            out = kernels.call("loewner_orbit", [*prism, n], 17, 20)
        except ArithmeticError:
            continue
        centre, columns, rest, reach = out[:2], (out[2:7], out[7:12]), out[12:14], out[14:]
        if max(reach) > 3:
            continue
        e, point = inside(rng, prism)
        start = kernels.call("loewner_orbit", [*prism, 1], 17, 20)
        symbols = [(v - x) / (k or 1) for v, x, k in zip(point[3:], start[:2], (start[2], start[8]))]
        assert all(abs(s) <= 1 for s in symbols)
        symbols += e[:3]                                # in the order of the columns
        x = orbit(point, prism[10:12], min(n, 0), max(n, 1))[n]
        x = [y - 2 * mpmath.pi * mpmath.nint((y - mp(near)) / (2 * mpmath.pi))
             for y, near in zip(x, centre)]             # the core keeps them modulo 2 pi
        away = [y - mp(near) for y, near in zip(x, centre)]
        for i in range(2):
            moved = sum(k * s for k, s in zip(columns[i], symbols))
            yield prism, i, abs(away[i] - mp(moved)), mp(rest[i]), abs(away[i]), mp(reach[i])
        yield prism, 2, 0, 0, abs(sum(away)), mp(reach[2])


def test_orbits_stay_within_reach():
    followed = tight = 0
    for prism, _, off, rest, away, reach in displacements(rng_for("loewner orbits"), CASES):
        assert off <= rest + 1e-35 and away <= reach + 1e-35, prism     # mpmath rounds, too
        followed += 1
        tight += rest <= 1e-10 or off > 0.02 * rest
    assert followed > CASES // 4 and tight > 0.3 * followed


def variations(rng, cases):
    """Yields prism, the core's bound of the second variation with vectors of its own choice, and its
    true values along the orbits of three random points of the prism."""
    for _ in range(cases):
        prism = draw(rng)
        s, t = -rng.randrange(0, 5), rng.randrange(1, 6)
        try:
            out = kernels.call("loewner_bound", [*prism, s, t], 4 + 2 * SITES, 20)
        except ArithmeticError:
            continue
        bound, l, first, sites = out[:4]
        n = [(mp(out[4 + 2 * k]), mp(out[5 + 2 * k])) for k in range(int(sites))]
        if not n:
            continue
        totals = []
        for _ in range(3):
            _, point = inside(rng, prism)
            x = orbit(point, prism[10:12], s, t)
            total = -mp(l) * sum(u * u for u in (*n[0], *n[-1]))
            total -= 2 * sum(u[0] * v[0] + u[1] * v[1] for u, v in zip(n, n[1:]))
            for k, (u, v) in enumerate(n):
                p, q, r = beta(*map(mp, point[:3]), *x[int(first) + k])
                total += p * u * u + 2 * q * u * v + r * v * v
            totals.append(total)
        yield prism, mp(bound), totals


def test_the_bound_holds():
    """The second variation with the core's vectors, along true orbits, is below the core's bound."""
    proved = seen = close = 0
    for prism, bound, totals in variations(rng_for("loewner bound"), CASES // 3):
        assert max(totals) <= bound, prism
        seen += 1
        proved += bound < 0
        close += bound - max(totals) < 0.1 * abs(max(totals))
    assert seen > CASES // 60 and proved > seen // 10 and close > seen // 10


def test_l_is_below_the_truth():
    """l + 1/l = B for some B that is above every eigenvalue of beta, and not far above the largest."""
    rng, close, seen = rng_for("loewner l"), 0, 0
    grid = [2 * math.pi * k / 24 for k in range(24)]
    for _ in range(CASES // 50):
        prism = draw(rng)
        try:
            out = kernels.call("loewner_bound", [*prism, 0, 1], 4 + 2 * SITES, 20)
        except ArithmeticError:
            continue
        largest = 0
        for signs in itertools.product((-1, 1), repeat=1 if prism[12] else 3):
            a, b, c = (float(x + s * h) for x, h, s in zip(prism, prism[5:8], signs * 3))
            for x, y in itertools.product(grid, repeat=2):
                p, q, r = a * math.sin(x) + c * math.sin(x + y), c * math.sin(x + y), b * math.sin(y)
                half = (p - r - q) / 2
                largest = max(largest, 2 + (p + r + q) / 2 + math.sqrt(half * half + q * q))
        B = float(out[1] + 1 / out[1])
        assert largest <= B * (1 + 1e-12), prism
        seen += 1
        close += B - 2 < 1.05 * (largest - 2)
    assert close > seen / 2


# ---- whole proofs

def line(low, high, together=True, region=(1, 1), skew=1):
    """a = b = c/2 = 11.21436 epsilon; skew makes b differ."""
    low, high = Fraction(low) * Fraction("11.21436"), Fraction(high) * Fraction("11.21436")
    c, h = (low + high) / 2, (high - low) / 2
    skew = Fraction(skew)
    return Problem.around((c, skew * c, 2 * c, Fraction(1), Fraction(1)),
                   (h, skew * h, 2 * h, *map(Fraction, region)), together=together)


@pytest.fixture(scope="module")
def proof():
    return prove(line("0.0170", "0.0280"), method="loewner")


def test_the_theorem(proof):
    assert proof.no_tori and proof.at_once and "2" in proof.tree
    text = proof.report()
    for words in ("I find no invariant tori", "0.19064412 < a < 0.31400208", "move together",
                  "s times the upper ends", "Loewner", "double precision"):
        assert words in text


def test_true_orbits_of_proved_prisms_cannot_minimize(proof):
    """At random points of proved prisms the recursion of the Loewner bounds, with many digits,
    falls below l, or a block is not positive."""
    rng = rng_for("loewner leaves")
    leaves = [cell for kind, cell in cells(proof.tree) if kind == "P"]
    star = [Fraction(x) for x in proof.xstar]
    pi = kernels.pi(60)
    for index, cuts in rng.sample(leaves, max(60, CASES // 40)):
        t, *v = (Fraction(2 * index[k] + 1, 2 ** cuts[k]) - 1
                 + Fraction(rng.uniform(-1, 1)) / 2 ** cuts[k] for k in (2, 0, 1))
        centre, half = proof.problem.centre, proof.problem.half
        point = [c + t * h for c, h in zip(centre[:3], half)]
        point += [pi * (c + e * h) for c, e, h in zip(centre[3:], v, half[3:])]
        length = proof.counts.max_NTsteps
        x = orbit(point, star, -length, length)
        largest = 2 + 53 * mp(point[0]) / mpmath.mpf("11.21436")     # B, a little above it
        l = 2 / (largest + mpmath.sqrt(largest ** 2 - 4))
        assert any(falls([beta(*map(mp, point[:3]), *x[j]) for j in range(-s, length + 1)], l)
                   for s in range(length, -1, -1)), point


def falls(betas, l):
    p, q, r = 1 / l, mpmath.mpf(0), 1 / l
    for b0, b1, b2 in betas:
        det = p * r - q * q
        p, q, r = b0 - r / det, b1 + q / det, b2 - p / det
        if not (p > l and (p - l) * (r - l) > q * q):
            return True
    return False


@pytest.mark.parametrize("problem", [
    Problem.around((Fraction(0),) * 3 + (Fraction(1),) * 2, (Fraction(0),) * 3 + (Fraction(1),) * 2),
    line("0.0001", "0.0001"), line("0.001", "0.001"), line("0.01", "0.01"), line("0", "0.0280"),
    line("0.0120", "0.0280"), line("-0.001", "0.001"), line("0.01", "0.01", skew="0.5"),
    line("0.005", "0.0280", together=False)])
def test_never_a_false_theorem(problem):
    for stubborn, depth in ((False, 40), (True, 12)):
        result = prove(problem, depth=depth, stubborn=stubborn, method="loewner", time_limit=3)
        assert not result.no_tori and "I could not decide" in result.report()
        assert result.undecided or not stubborn


def test_a_cell_is_what_it_says(proof):
    """A cell of the tree fares like the root of a problem that is just this cell."""
    rng, problem, same = rng_for("loewner cells"), proof.problem, 0
    prisms, task = [], Task(problem, proof.settings, proof.xstar)
    for _, (index, cuts) in cells(proof.tree):
        index = tuple(i >> k // 2 for i, k in zip(index, cuts))
        cuts = tuple(k - k // 2 for k in cuts)
        if index[1] + 1 << cuts[0] <= index[0] << cuts[1]:      # below the diagonal
            prisms.append((index, cuts))
    def grow(task, cell):
        search = Search(task)
        search.prepare(ffi.NULL)
        return search.grow([cell], 10, MANY, ffi.NULL, False).text

    for index, cuts in rng.sample(prisms, 200):
        part = [Fraction(1, 2 ** k) for k in cuts]
        axes = 2, 2, 2, 0, 1                # of a, b, c, v0, v1
        centre = [c + h * ((2 * index[k] + 1) * part[k] - 1)
                  for c, h, k in zip(problem.centre, problem.half, axes)]
        half = [h * part[k] for h, k in zip(problem.half, axes)]
        cell = Problem.around(tuple(centre), tuple(half), together=True)
        same += grow(task, (index, cuts, 0)) == grow(replace(task, problem=cell), (*ROOT, 0))
    assert same > 190                       # rounding may tell them apart


@pytest.mark.parametrize("low, high, together, expected", [
    ("0.0250", "0.02517", True, False), ("0.0250", "0.0252", True, True),
    ("0.0250", "0.0260", False, False), ("0.0252", "0.0253", False, True)])
def test_at_once_above_ten_thirds(low, high, together, expected):
    """B = 2 + 52.955 epsilon > 10/3."""
    result = prove(line(low, high, together), method="loewner", depth=0)
    assert result.at_once == expected


def test_other_parameters():
    """Unsymmetric, independent and negative parameters, and a part of the torus."""
    skew = prove(line("0.0240", "0.0245", skew="0.9"), method="loewner")
    free = prove(line("0.0240", "0.0245", together=False), method="loewner")
    assert skew.no_tori and "S" not in skew.tree and free.no_tori and "S" in free.tree
    part = prove(line("0.0200", "0.0201", region=("0.1", "0.1")), method="loewner")
    assert part.conclusion == "region" and not part.no_tori and "successor" in part.report()
    minus = line("0.0200", "0.0210")        # V(y + pi) changes the signs of a and b
    minus = Problem.around(tuple(-x for x in minus.centre[:2]) + minus.centre[2:], minus.half,
                    together=False)
    assert prove(minus, method="loewner").no_tori


def test_huge_and_tiny_numbers():
    huge = Problem.around((Fraction(10) ** 100,) * 3 + (Fraction(1),) * 2,
                   (Fraction(0),) * 3 + (Fraction(1),) * 2)
    far = line("0.0200", "0.0200")
    far = Problem.around(far.centre[:3] + (Fraction(10) ** 12,) * 2, far.half, together=True)
    assert prove(huge, depth=10, method="loewner").no_tori    # and rightly so
    assert prove(far, depth=10, method="loewner", stubborn=True, time_limit=3).undecided
    with pytest.raises(ConverseError, match="arithmetic"):
        prove(Problem.around((Fraction(10) ** 250,) * 3 + (Fraction(1),) * 2, huge.half),
              method="loewner")
