"""Angles in turns: sines against an independent truth, and how long orbits may be."""

import time
from fractions import Fraction

import mpmath
import pytest
from test_waves import many_digits  # noqa: F401

from converse import ConverseError, Problem, StandardMap, prove
from converse.model.map import MuldoonMap
from converse.prover import native, orbit_length, run
from converse.prover.proof import Proof, Tree
from converse.prover.run import ready
from converse.prover.settings import Settings

import kernels
from patches import arguments, thesis
from truth import mp, rng_for

UNITS = mp(2) ** 62


def angles(rng):
    """Anywhere, and close to where quarter turns begin and end."""
    yield from (rng.randrange(1 << 64) for _ in range(1500))
    yield from ((n << 61) + j & (1 << 64) - 1 for n in range(8) for j in (-2, -1, 0, 1, 2))
    for _ in range(1500):
        near = rng.choice([-1, 1]) * rng.getrandbits(rng.randrange(1, 61))
        yield (rng.randrange(8) << 61) + near & (1 << 64) - 1


@pytest.mark.parametrize("lanes", ["2", "4", "8"])
@pytest.mark.slow
def test_sines(lanes, monkeypatch):
    """They are within the 3 units of 2^-62 that turns.h promises, a third of which are needed; the
    double next to a sine and what that lacks are the sine.  The fine sine is within 2^-100."""
    monkeypatch.setenv("CONVERSE_LANES", lanes)
    worst, finest, prism = [0, 0], 0, arguments(thesis([Fraction(1), *[Fraction(0)] * 12]))
    for turns in angles(rng_for("turns")):
        s1, s0, c1, c0, double, lacks, fine, finer = kernels.call(
            "waves_sincos", [*prism, turns >> 32, turns & 0xffffffff], 8, 20)
        s, c = int(s1) << 32 | int(s0), int(c1) << 32 | int(c0)
        y = 2 * mpmath.pi * mp(turns) / 2 ** 64
        for i, (found, true) in enumerate([(s, mpmath.sin(y)), (c, mpmath.cos(y))]):
            assert abs(found) <= 2 ** 62
            worst[i] = max(worst[i], abs(found - true * UNITS))
        finest = max(finest, abs(mp(fine) + mp(finer) - mpmath.sin(y)))
        assert (double + lacks) * 2 ** 62 == s and double == Fraction(s / 2 ** 62)
    assert 1 < min(worst) and max(worst) < 3, worst
    assert mp(2) ** -106 < finest < mp(2) ** -100, finest


@pytest.mark.parametrize("lanes", ["2", "4", "8"])
@pytest.mark.slow
def test_what_a_wave_leaves_has_twice_the_digits(lanes, monkeypatch):
    """Within the 2^-95 of bound.c, also where k.n and k.mu cancel."""
    monkeypatch.setenv("CONVERSE_LANES", lanes)
    rng, worst = rng_for("pull"), 0
    prism = arguments(thesis([Fraction(x) for x in ("0.1", "0.2", "0.7", *[0] * 10)]))
    for turns in [*angles(rng_for("turns"))][::5]:
        n, mu = ([rng.uniform(-1, 1) * 10 ** rng.uniform(0, 8)] * 2 for _ in range(2))
        for x in n, mu:
            x[1] *= -1 - rng.choice([0, 1, 1e-9]) * rng.random()
        high, low, p, p_low = map(mp, kernels.call(
            "waves_pull", [*prism, turns >> 32, turns & 0xffffffff, *map(Fraction, n + mu)],
            4, 20))
        y, (n0, n1, m0, m1) = 2 * mpmath.pi * mp(turns) / 2 ** 64, map(mp, n + mu)
        true = (p + p_low) * ((m0 + m1) * mpmath.sin(y) + (n0 + n1) ** 2 * mpmath.cos(y))
        weights = 4 * (n0 ** 2 + n1 ** 2) + 2 * (abs(m0) + abs(m1))
        worst = max(worst, abs(high + low - true) / (p * weights))
    assert mp(2) ** -112 < worst < mp(2) ** -95, worst


@pytest.mark.parametrize("x", [0.1, 1 / 3])
def test_long_sums_lose_as_little_as_short_ones(x):
    """32 u of a block of 16 sites, and not 8,000 roundings of the sum of the blocks."""
    prism = arguments(thesis([Fraction(x) for x in (1, *[0] * 12)]))
    found, = kernels.call("waves_sum", [*prism, 1 << 17, Fraction(x)], 1, 20)
    assert abs(found - Fraction(x) * 2 ** 17) <= 32 * Fraction(1, 2 ** 53) * found


@pytest.mark.parametrize("k, longest", [("0.9716", 4000), ("0.9", 4000), ("0.9719", 0), ("2", 0)])
@pytest.mark.slow
def test_orbits_are_long_only_where_that_helps(k, longest):
    """Where a circle exists, thin prisms close to it are not proved."""
    before = ready(Proof((Tree(Problem(MuldoonMap(k, 0, 0)), None),), Settings(method="loewner")))
    assert orbit_length.longest(before.problem, before.xstar) == longest


@pytest.mark.parametrize("b", ["0", "1"])
def test_orbits_of_two_angles_are_not_long(b):
    """That of the other angle of a product does not count."""
    problem = Problem(MuldoonMap("2", b, 0))
    assert orbit_length.longest(problem, None) == 0
    assert orbit_length.longest(Problem(MuldoonMap("2", b, "0.1")), None) == native.ORDINARY


@pytest.fixture
def asked(monkeypatch):
    """Orbits of more than 20 points count as long.  What is asked about them, in a list."""
    calls = []

    def longest(*arguments):
        calls.append(arguments)
        return orbit_length.longest(*arguments)

    monkeypatch.setattr(native, "ORDINARY", 20)
    monkeypatch.setattr(run, "longest", longest)
    return calls


@pytest.mark.parametrize("jobs", [1, 3])
def test_long_orbits_are_asked_about_when_a_prism_first_needs_one(jobs, asked, monkeypatch):
    """The tree and its statistics do not depend on when that is."""
    assert prove(StandardMap(k=2), jobs=jobs) and not asked
    proof = prove(StandardMap(k=1), jobs=jobs)
    assert len(asked) == 1 and proof.counts.max_NTsteps > native.ORDINARY
    monkeypatch.undo()
    assert proof == prove(StandardMap(k=1), jobs=1)


def test_a_question_about_long_orbits_obeys_the_time_limit(asked, monkeypatch, tmp_path):
    """What was grown before it stands."""
    def longest(problem, xstar, threads, is_late):
        while not is_late():
            time.sleep(0.01)
        return orbit_length.longest(problem, xstar, threads, is_late)

    path, told = tmp_path / "proof", []
    with monkeypatch.context() as patched:
        patched.setattr(run, "longest", longest)
        left = prove(StandardMap(k=1), time_limit=1, backup=path,
                     progress=lambda *now: told.append(now))
    assert not left.all_decided and left.counts.proved and left.seconds < 60 and len(told) > 5
    assert prove(resume=path) == prove(StandardMap(k=1)) and len(asked) == 2


@pytest.mark.slow
def test_the_longest_orbits():
    """A prism as thin as can be beside a circle takes as many points as it may, and is given up."""
    proof = Proof((Tree(Problem(MuldoonMap("0.2", 0, 0)), None),), Settings(method="loewner"))
    problem, xstar = ready(proof).problem, ready(proof).xstar
    for longest, points in ((0, 1 << 17), (1 << 17, 1 << 17), (native.ORDINARY, native.ORDINARY)):
        task = native.Task(problem, Settings("loewner", 46, stubborn=True), xstar, longest)
        search = native.Search(task)
        search.work(0, bool)
        cell = orbit_length._thinnest(0, 6, 51, ())
        grown = search.grow([cell], 10)
        assert grown.text == "U" and grown.steps == [points - 1]    # as many on either side of x*
    with pytest.raises(ConverseError):
        native.Search(native.Task(problem, Settings("loewner"), xstar, (1 << 17) + 1))


def test_prisms_with_the_longest_orbits_are_not_cut():
    """Such a prism beside a circle is thicker than the thinnest ones, but orbits of its halves
    would contradict no more."""
    proof = Proof((Tree(Problem(MuldoonMap("0.9", 0, 0)), None),), Settings(method="loewner"))
    problem, xstar = ready(proof).problem, ready(proof).xstar
    search = native.Search(native.Task(problem, Settings("loewner", 46, stubborn=True), xstar, 100))
    search.work(0, bool)
    cuts = orbit_length.CUTS - 6
    cell = [103 << cuts - 7, 0, 0, 0, 0], [cuts, 0, 0, 0, 0], 0
    grown = search.grow([cell], 10)
    assert grown.text == "U" and grown.steps == [99]        # 49 on either side of x*


@pytest.mark.slow
def test_orbits_where_a_circle_exists_stay_ordinary():
    """Longer ones, as k = 0.9719 needs (test_numbers.py), are not tried."""
    undecided = prove(Problem(MuldoonMap("0.9", 0, 0)), jobs=1)
    assert not undecided.no_tori and undecided.counts.max_NTsteps <= native.ORDINARY
