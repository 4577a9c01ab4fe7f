"""Orbits through a point about which V is even: the past is the future's mirror image, and the core
follows one side."""

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import pytest

from converse import FourierMap, Problem, Settings, prove
from converse.model.map import MuldoonMap
from converse.model.region import reduced
from converse.prover import native
from converse.prover.native import Search, Task
from converse.prover.tree import cells

import kernels
from patches import bounded, inside, orbit, second_variation, sites
from truth import TORTURE, rng_for

CASES = 400 * TORTURE
QUARTER, HALF = "1.57079632679489661923", "3.14159265358979323846"     # turns
STARS = (1, 0), (0, 1), (1, 1), (1, 2), (-3, 2)         # in quarter turns


@pytest.fixture(autouse=True)
def many_digits():
    with mpmath.workdps(40):
        yield


def draw(rng):
    """A random patch of two angles, even about its x*, which is a little off."""
    star, parameters = rng.choice(STARS), rng.randrange(4)
    kinds = [k for k in itertools.product(range(-2, 3), repeat=2)
             if sum(map(int.__mul__, k, star)) % 2]
    size = 10.0 ** rng.uniform(-1, 0.1)

    def part():
        return rng.choice([0.0, 10.0 ** rng.uniform(-9, -2) * size])

    return SimpleNamespace(
        waves=[(*rng.choice(kinds), *map(Fraction, (
            0, size * rng.uniform(-1, 1), *(part() if m < parameters else 0 for m in range(3)))))
            for _ in range(rng.randrange(1, 4))],
        parameters=parameters, frame=rng.choice([(1, 0, 0, 1), (1, 1, 1, -1), (2, -1, 1, 2)]),
        centre=[Fraction(rng.uniform(-4, 4)) for _ in range(2)],
        half=[Fraction(rng.choice([0.0, 10.0 ** rng.uniform(-9, -1.5)])) for _ in range(2)],
        xstar=[n * Fraction(QUARTER) + Fraction(rng.randrange(-13, 14), 10 ** 20) for n in star],
        shifts=[[Fraction(rng.choice([0.0, 1e-3])) if m < parameters else Fraction(0)
                 for m in range(3)] for _ in range(2)])


def test_half_of_the_second_variation_is_bounded():
    """Twice the bound is above Q of n and its mirror image, or of both where they are apart."""
    rng, seen, proved, close, apart = rng_for("mirror"), 0, 0, 0, 0
    for _ in range(CASES):
        patch, t = draw(rng), rng.randrange(1, 8)
        found = bounded(patch, 0, t, rng.randrange(2))
        if not found:
            continue
        bound, l, n = found
        image = {-j: u for j, u in n.items()}
        for _, p, x1 in [inside(rng, patch) for _ in range(3)]:
            x = orbit(patch, p, x1, -t, t)
            # along an orbit that is not its own mirror image one side alone is as much as half
            whole = [second_variation(patch, p, x, m, l) for m in (
                [{**image, **n}] if min(n) == 0 else [n, image])]
            assert sum(whole) <= 2 * bound, patch
            seen += 1
            proved += bound < 0
            apart += min(n) > 0
            close += 2 * bound - sum(whole) < 0.1 * abs(sum(whole))
    assert seen > CASES // 4 and proved > seen // 10 and close > seen // 10 and apart > 0, (
        seen, proved, close, apart)


def test_the_past_begins_where_the_error_of_xstar_puts_it():
    """(2 + S) times a unit of 2^-64 turns is what x_1 may be off by, seen from x*."""
    patch = SimpleNamespace(
        waves=[(1, 0, 0, Fraction(3, 2), 0, 0, 0)], parameters=0, frame=(1, 0, 0, 1),
        centre=[Fraction(3), Fraction(1)], half=[Fraction(1, 1000)] * 2,
        xstar=[Fraction(QUARTER), Fraction(0)], shifts=[[Fraction(0)] * 3] * 2)
    rests = []
    for star in patch.xstar[0], Fraction(QUARTER) + Fraction(1, 10 ** 18):
        patch.xstar[0] = star
        rests.append(sites(patch, 0, 3)[1].rem[0])
    assert rests[0] >= (2 + Fraction(3, 2)) * Fraction(710, 113) / 2 ** 64 and rests[1] == 0


EVEN = {
    "the standard map": (Problem(MuldoonMap("0.98", 0, 0)), (QUARTER, "0")),
    "a range": (Problem(MuldoonMap(("0.99", "1.01"), 0, 0)), (QUARTER, "0")),
    "two sines": (Problem(MuldoonMap("0.8", 0, "0.25")), (QUARTER, "0")),
    "Froeschlé's map": (Problem(FourierMap({
        ((1, 0), "+cos"): "1.1", ((0, 1), "+cos"): "1.1", ((1, 1), "+cos"): "0.1"})),
        (HALF, HALF)),
    "one wave of three angles": (Problem(FourierMap({
        ((1, 0, 0), "+cos"): "0.9", ((0, 1, 0), "+cos"): "0.9", ((0, 0, 1), "+cos"): "0.9",
        ((1, 1, 1), "+cos"): "0.1"})), (HALF,) * 3),
}


def search_of(problem, star, monkeypatch, exact=True, depth=26):
    """A search that was set up; where phases may be off it follows both sides."""
    with monkeypatch.context() as m:
        if not exact:
            real = native.native_problem

            def inexact(*args):
                made = real(*args)
                made.waves[0].quarters = -1
                return made

            m.setattr(native, "native_problem", inexact)
        search = Search(Task(problem, Settings("loewner", depth, stubborn=True), star))
    assert search.work(0, bool)
    return search


@pytest.mark.parametrize("name", EVEN)
def test_both_sides_prove_the_same(name, monkeypatch):
    """Each prism that is proved in one way is proved in the other.  Orbits are tried at other
    lengths there, so a few are cut first."""
    problem, star = EVEN[name]
    problem = reduced(problem, star)
    one = search_of(problem, star, monkeypatch)
    both = search_of(problem, star, monkeypatch, exact=False)
    assert kernels.is_mirrored(one.handle) and not kernels.is_mirrored(both.handle)
    for ahead, after in ((one, both), (both, one)):
        grown = ahead.grow([((0,) * 6, (0,) * 6, 0)])
        assert grown.finished and grown.counts.proved > 20 and not grown.counts.undecided
        leaves = [(index, cuts, 0) for kind, (index, cuts) in cells(grown.text) if kind == "P"]
        again = after.grow(leaves)
        assert "U" not in again.text and len(leaves) <= len(again.text) <= 1.5 * len(leaves)


@pytest.mark.parametrize("change", [
    (1, 0, 0), (0, Fraction(1, 2 ** 60), 0), (0, Fraction(-1, 2 ** 60), 0),
    (0, Fraction(1, 10 ** 45), 0), (0, Fraction(-1, 10 ** 45), 0), (0, Fraction(1, 3), 0),
    (0, 0, Fraction(1, 10 ** 18)), (0, 0, Fraction(1, 10 ** 6))])
def test_nearly_even_is_not_even(change, monkeypatch):
    """A wave that is odd about x*, a phase next to a quarter turn, x* some units beside it."""
    odd, phase, off = change
    even = {((1, 0), Fraction(1, 2)): "0.9", ((1, 1), Fraction(1, 2)): "0.2"}
    waves = {((1, 0), Fraction(1, 2) + phase): "0.9", ((1, 1), Fraction(1, 2)): "0.2",
             **({(2, 1): "0.01"} if odd else {})}
    problem = Problem(FourierMap(waves), v0=(0, 2), v1=(0, 2))
    star = str(float(off)) if off > 1e-9 else "%.20f" % off, "0"
    assert not kernels.is_mirrored(search_of(problem, star, monkeypatch).handle)
    problem = replace(problem, map=FourierMap(even))
    assert kernels.is_mirrored(search_of(problem, ("0", "0"), monkeypatch).handle)


def test_the_chosen_point_is_a_quarter_turn_to_twenty_places():
    """Where it is one to the six places of any other."""
    for (a, b, c), xstar in (("0.972", 0, 0), QUARTER), (("0.19", "0.19", "0.38"), "0.858028"):
        task = Task(Problem(MuldoonMap(a, b, c)), Settings("loewner"))
        assert Search(task).xstar == (xstar, xstar)


def test_no_point_of_the_past_is_computed():
    """The orbits of all tries, a side each: their lengths are odd."""
    proof = prove(Problem(MuldoonMap("0.98", 0, 0)), method="loewner", jobs=1)
    assert proof.no_tori and proof.counts.max_NTsteps % 2 == 1
    assert math.isclose(float(proof.xstar[0]), math.pi / 2)
