"""The search for the least action: never worse than continuation, repeatable, and right where the
least is known."""

import concurrent.futures
import itertools
import subprocess
import sys

import less_action
import numpy as np
import pytest
from less_action import search

from converse import ConverseError, orbits
from converse.orbits import ff, poly, standard, trig

SPIRAL = (65, 86), 114


def follow(potential, p, q, eps):
    return orbits.follow(potential, p, q, [eps])[0]


# ---- what is known to be the least

def dense(potential, p, q, eps, starts):
    """The least action of many random states, relaxed."""
    rng = np.random.default_rng(12)
    found = []
    for k in range(starts):
        u = rng.normal(size=(q, potential.n)) * rng.choice((0, 0.2, 0.5))
        state = orbits.PeriodicOrbit(potential, p, q, eps, u, rng.random(potential.n)).relax()
        found.append(state.action)
    return min(found)


@pytest.mark.parametrize("potential, p, q, eps", [
    (trig, (2, 3), 4, 0.05), (trig, (3, 4), 5, 0.03), (trig, (5, 7), 9, 0.04),
    (trig, (5, 7), 9, 0.06), (ff, (4, 5), 7, 0.03), (poly, (3, 4), 5, 0.02),
    (poly, (5, 7), 9, 0.03)])
def test_brute_force_finds_no_less(potential, p, q, eps):
    least = dense(potential, p, q, eps, 150)
    best = search(potential, p, q, eps, searches=60)
    assert abs(best.action - least) < 1e-13


def test_the_proved_least():
    """Branch and bound over all states of the type agrees (experiments/least_action); continuation
    has more by 2.9e-5."""
    low, high = -0.0059191024798050775, -0.005919102479802085
    best = search(trig, (5, 7), 9, 0.04, searches=30)
    assert low - 1e-15 <= best.action <= high + 1e-14
    assert follow(trig, (5, 7), 9, 0.04).action - best.action == pytest.approx(2.9475e-5, abs=1e-8)


def test_hedlund():
    """Twice the orbit of type (5, 7)/9 is not the least of type (10, 14)/18 at eps 0.06."""
    best = search(trig, (10, 14), 18, 0.06, searches=60)
    assert best.action == pytest.approx(-0.0143222602, abs=1e-10)
    assert search(trig, (5, 7), 9, 0.06, searches=60).action == pytest.approx(
        -0.0143010202, abs=1e-10)


def test_copies_below_hedlund():
    """At eps 0.03 twice the orbit is the least that is found."""
    short = search(trig, (3, 4), 5, 0.03, searches=40)
    assert search(trig, (6, 8), 10, 0.03, searches=40).action == pytest.approx(short.action,
                                                                                  abs=1e-14)


def test_one_degree_of_freedom():
    """Continuation's orbit of a twist map is the least (Aubry): nothing less is found."""
    for k in (0.5, 1.2):
        best = search(standard, (13,), 34, k, searches=40)
        assert best.action == pytest.approx(follow(standard, (13,), 34, k).action, abs=1e-14)
        assert best.label == "minimum"


# ---- beside continuation

@pytest.mark.parametrize("eps, gain, low", [(0.02, 2.115e-6, -0.00176480564),
                                            (0.03, 1.813e-5, -0.00374315173),
                                            (0.04, 1.433e-4, -0.00684781663)])
def test_continuation_loses(eps, gain, low):
    """By so much per point, to a hundredth and 1e-8: what moved pieces alone find, too, in a
    hundred times as long.  The best is above Mather's beta, whose lower bound on a grid of 32 is
    proved (experiments/least_action)."""
    followed = follow(trig, *SPIRAL, eps)
    best = search(trig, *SPIRAL, eps, searches=100)
    assert followed.label == "minimum" and best.label == "minimum"
    assert gain <= followed.action - best.action < 1.01 * gain + 1e-8
    assert best.action > low


def test_all_agree_where_tori_are():
    for (p, q), eps in [(SPIRAL, 0.005), (SPIRAL, 0.01), (((5, 7), 9), 0.01)]:
        best = search(trig, p, q, eps, searches=40)
        assert best.action == pytest.approx(follow(trig, p, q, eps).action, abs=1e-13)


def test_never_worse_than_continuation():
    rng = np.random.default_rng(4)
    for potential in (trig, ff, poly) * 4:
        q = int(rng.integers(1, 24))
        p, eps = tuple(int(i) for i in rng.integers(-q, q + 1, 2)), float(rng.uniform(0, 0.06))
        best = search(potential, p, q, eps, searches=int(rng.integers(1, 30)))
        assert best.action <= follow(potential, p, q, eps).action
        assert (best.p, best.q, best.eps) == (p, q, eps)


def test_turns_alone_help_a_long_orbit(monkeypatch):
    """The better pieces of continuation's orbit, begun at each of its points, mend the others."""
    monkeypatch.setattr(less_action._TypeSearch, "shorter", lambda *_: None)
    followed = follow(trig, (200, 265), 351, 0.04)
    best = search(trig, (200, 265), 351, 0.04, searches=60)
    assert followed.action - best.action > 1e-4


# ---- promises

def test_the_command_writes_what_it_found(tmp_path):
    path = tmp_path / "best.npz"
    done = subprocess.run([sys.executable, less_action.__file__, "trig", "5,7/9", "0.04",
                           "--searches", "30", "--points", path], stdout=subprocess.PIPE, text=True,
                          check=True)
    best = search(trig, (5, 7), 9, 0.04, searches=30)
    assert done.stdout == best.report()
    assert orbits.PeriodicOrbit.load(path).u.tobytes() == best.u.tobytes()


def test_the_same_for_a_seed():
    def run(seed):
        best = search(trig, (28, 37), 49, 0.03, searches=30, seed=seed)
        return best.action, best.u.tobytes()
    assert run(3) == run(3)
    assert run(3)[1] != run(4)[1]


def test_in_an_executor():
    arguments = [(trig, (5, 7), 9, eps, 10) for eps in (0.02, 0.04)]
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        there = list(executor.map(search, *zip(*arguments)))
    for state, here in zip(there, itertools.starmap(search, arguments)):
        assert (state.action, state.label) == (here.action, here.label)
        assert state.potential == trig


def test_progress_counts_searches():
    """Those that end; the returned state is the least that any of them ended in."""
    calls, ended = [], []
    relax = orbits.PeriodicOrbit.relax

    def counted(state, *arguments, **options):
        found = relax(state, *arguments, **options)
        if state.q == 49 and not arguments:         # not continuation's, not at another eps
            ended.append(found.action)
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(orbits.PeriodicOrbit, "relax", counted)
        best = search(trig, (28, 37), 49, 0.03, searches=25,
                             progress=lambda n, state: calls.append((n, state.action)))
    assert [n for n, _ in calls] == list(range(1, 26))
    assert len(ended) == 24
    assert best.action == calls[-1][1] == min(ended)
    assert all(a >= b for (_, a), (_, b) in zip(calls, calls[1:]))


def test_a_search_that_does_not_end_is_not_counted(monkeypatch):
    def fails(state, *arguments, **options):
        raise ConverseError("no orbit")
    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", fails)
    with pytest.raises(ConverseError, match="none of 7 searches ended"):
        search(trig, (3, 4), 5, 0.03, searches=7)


# ---- its parts

def action_of(state, u):
    return state.moved(u).action


def test_a_recombined_path_is_the_least(monkeypatch):
    """Without slip: no choice of points of two states, among those that begin like it, has less."""
    monkeypatch.setattr(less_action, "JOINT_RELIEF", 0.0)
    rng = np.random.default_rng(3)
    for _ in range(20):
        state = orbits.PeriodicOrbit(trig, (4, 5), 7, 0.05, rng.normal(size=(7, 2)) / 4,
                                     (0.85, 0.85))
        u = rng.normal(size=(7, 2)) / 4
        near = np.argmin(((u - state.u) ** 2).sum(1))
        least = min(action_of(state, np.where(np.array(choice)[:, None], u, state.u))
                    for choice in itertools.product((False, True), repeat=7) if not choice[near])
        mended = less_action._recombined(state, u)
        found = action_of(state, state.u if mended is None else mended)
        assert found == pytest.approx(least, abs=1e-15)


def test_turns_are_the_same_orbit():
    """Begun at another point, and displaced as told, a state lies where it was."""
    state = search(trig, (5, 7), 9, 0.04, searches=2)
    turns, shifts = less_action._turns(state.p, state.q, 0.0)
    assert turns[0] == 0 and not shifts[0].any() and sorted(turns) == list(range(9))
    assert np.abs(shifts).max() <= 0.5
    for r in turns:
        turned = state.moved(np.roll(state.u, -r, 0) + shifts[r])
        assert turned.action == pytest.approx(state.action, abs=1e-15)
        apart = turned.x - np.roll(state.x, -r, 0)
        assert np.abs(apart - np.round(apart)).max() < 1e-14


def test_a_joint_has_the_points_of_both():
    first, second = follow(trig, (2, 3), 4, 0.03), follow(trig, (3, 4), 5, 0.03)
    joint = less_action._joint((5, 7), 9, first, 1, second, 3)
    path = joint.base + joint.u                     # on the torus but for whole turns
    for points, of in ((path[:4], np.roll(first.x, -1, 0)), (path[4:] - path[4], None)):
        if of is None:
            of = np.roll(second.x, -3, 0) - second.x[3]
        apart = points - of
        assert np.abs(apart - np.round(apart)).max() < 1e-14
    steps = np.diff(joint.u, axis=0, append=joint.u[:1]) + joint.rotation
    assert np.abs(steps.sum(0) - (5, 7)).max() < 1e-13
