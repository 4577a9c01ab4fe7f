"""Theorems about tori against what they are about: the map itself, with many digits, and the other
half of the program."""

import random
from fractions import Fraction as F

import mpmath
import numpy as np
import pytest

from converse.model.map import LINE, MuldoonMap, SymplecticMap
from converse.model.problem import Problem
from converse.prover.run import prove as prove_no_tori
from converse.prover.settings import THEOREM
from converse.tori import NotFound, NotProved, find, prove, read_rotation

from truth import TORTURE

DIGITS = 50

CASES = {
    "golden": (Problem(SymplecticMap([(1, 0)], ["0.8"])), read_rotation("golden")),
    "phase": (Problem(SymplecticMap([(1, 0, F(1, 3)), (2, 0)], ["0.2", "-0.05"])),
              read_rotation("silver")),
    "line": (Problem(MuldoonMap(*(LINE * F("0.002") * m for m in (1, 1, 2)))),
             read_rotation("T49")),
    "phases": (Problem(SymplecticMap([(1, 0, F(1, 5)), (1, 1)], ["0.04", "0.03"])),
               read_rotation("spiral")),
    "a sublattice": (Problem(SymplecticMap([(2, 0), (1, 3, F(1, 5))], ["0.01", "0.003"])),
                     read_rotation("T49")),
    "a direction": (Problem(SymplecticMap([(1, 1, F(1, 5))], ["0.05"])), read_rotation("T49")),
}


@pytest.fixture(scope="module", params=[
    "golden", "line", *(pytest.param(name, marks=pytest.mark.slow) for name in (
        "phase", "phases", "a sublattice", "a direction"))])
def proved(request):
    return prove(*CASES[request.param])


def value(torus, theta):
    """u(theta) with many digits, from the integers of the torus."""
    u = [mpmath.mpf(0)] * torus.dimension
    for k, numbers in zip(torus.k.tolist(), torus.numbers[:, 0].transpose(2, 1, 0).tolist()):
        turn = mpmath.expj(mpmath.fdot(k, theta))
        for i, parts in enumerate(numbers):
            u[i] += 2 * (mpmath.mpc(*parts) / 2 ** torus.bits * turn).real
    return u


def shift(rotation):
    """w, with many digits."""
    return [mpmath.pi * (mpmath.mpf(low.numerator) / low.denominator
                         + mpmath.mpf(high.numerator) / high.denominator)
            for low, high in rotation.turns(DIGITS + 5)]


def force(torus, y):
    """V'(y)."""
    total = [mpmath.mpf(0)] * torus.dimension
    for (*k, phase), p in zip(torus.potential.waves, torus.potential.amplitude):
        k = k[:torus.dimension]
        slope = -mpmath.mpf(p.numerator) / p.denominator * mpmath.cos(
            mpmath.fdot(k, y) + mpmath.pi * phase.numerator / phase.denominator)
        total = [t + slope * x for t, x in zip(total, k)]
    return total


def stiffness(torus):
    """An upper bound of |V''|."""
    return float(sum(abs(p) * (k0 ** 2 + k1 ** 2)
                     for (k0, k1, _), p in zip(torus.potential.waves, torus.potential.amplitude)))


def test_the_map_takes_the_torus_to_itself(proved):
    """E(u) with fifty digits, at random angles, is at most what was proved of it; and at most what
    it can be that near to a true torus: (4 + |V''|) times the distance."""
    torus, rng = proved.torus, random.Random(1)
    with mpmath.workdps(DIGITS):
        w = shift(torus.rotation)
        for _ in range(6):
            theta = [mpmath.mpf(rng.uniform(0, 6)) for _ in w]
            before, here, after = (value(torus, [t + s * x for t, x in zip(theta, w)])
                                   for s in (-1, 0, 1))
            E = [a - 2 * u + b + f for a, u, b, f in zip(
                after, here, before, force(torus, [t + u for t, u in zip(theta, here)]))]
            size = float(mpmath.norm(E))
            assert size <= proved.residual
            assert size <= (4 + stiffness(torus)) * proved.distance
            angles = np.array(theta, float)             # and in doubles
            assert torus.x(angles) == pytest.approx(np.array(
                [t + u for t, u in zip(theta, here)], float), abs=1e-12)
            assert torus.J(angles) == pytest.approx(np.array(
                [x + u - v for x, u, v in zip(w, here, before)], float), abs=1e-12)


def test_orbits_stay_as_near_as_the_proved_distance_allows(proved):
    """Twenty steps of (y, J) -> (y + J', J'), J' = J - V'(y), from a point of the computed torus:
    off by at most 3 distances at first, which grow by the map's derivative."""
    torus = proved.torus
    with mpmath.workdps(DIGITS):
        w = shift(torus.rotation)
        theta = [mpmath.mpf(1) / 3] * len(w)
        now, before = value(torus, theta), value(torus, [t - x for t, x in zip(theta, w)])
        y = [t + u for t, u in zip(theta, now)]
        J = [x + u - v for x, u, v in zip(w, now, before)]
        allowed = 3 * proved.distance
        for _ in range(20):
            J = [a - b for a, b in zip(J, force(torus, y))]
            y = [a + b for a, b in zip(y, J)]
            theta = [t + x for t, x in zip(theta, w)]
            allowed *= 2 + stiffness(torus)             # of sup norms: at least |DF|
            there = [t + u for t, u in zip(theta, value(torus, theta))]
            assert max(abs(a - b) for a, b in zip(y, there)) <= 2 * allowed


@pytest.mark.slow
@pytest.mark.parametrize("name", [
    "golden", *(pytest.param(name, marks=pytest.mark.slow) for name in ("phase", "line"))])
def test_the_true_torus_is_where_it_was_proved_to_be(name):
    """A much more accurate torus is no further away than both distances allow.  Both have mean 0,
    and the true torus need not: a shift of theta by a distance moves x by as much times l0."""
    problem, rotation = CASES[name]
    rough, fine = (prove(find(problem, rotation, margin=margin)) for margin in (10.0, 1e9))
    assert fine.distance < rough.distance / 4
    coefficients = [dict(zip(map(tuple, torus.k.tolist()), torus.coefficients()))
                    for torus in (rough.torus, fine.torus)]
    total = 0.0
    for k in {*coefficients[0], *coefficients[1]}:
        a, b = (each.get(k, np.zeros(rough.torus.dimension)) for each in coefficients)
        total += 2 * np.linalg.norm(a - b)
    l0 = max(float(proof.worst.constants.l) for proof in (rough, fine))
    assert 0 < total <= (2 + l0) * (rough.distance + fine.distance)


def has_torus(problem, rotation):
    try:
        prove(problem, rotation, points=1 << 12)
        return True
    except (NotFound, NotProved):
        return False


MANY = 2 * TORTURE if TORTURE > 1 else 0


def has_none(problem):
    depth = 20 if problem.factor is None else 12
    proof = prove_no_tori(problem, method="loewner", depth=depth, jobs=1)
    return proof.conclusion == THEOREM


@pytest.mark.slow
@pytest.mark.parametrize("problem, rotations, low, high, between", [
    (lambda k: Problem(SymplecticMap([(1, 0)], [k])), ["golden", "silver"], 0.8, 1.2,
     2 * TORTURE),
    (lambda e: Problem(MuldoonMap(*(LINE * e * m for m in (1, 1, 2)))), ["T49"], 0.001, 0.03, MANY),
    (lambda e: Problem(MuldoonMap(LINE * e, 0, LINE * e)), ["spiral", "T49"], 0.001, 0.06, MANY),
], ids=["standard", "line", "b = 0"])
def test_never_both(problem, rotations, low, high, between):
    """No amplitude has a torus and has none; some have one, and some have none.  Amplitudes between
    these take minutes for maps of two angles, and are for make torture."""
    rng, seen = random.Random(2), set()
    amplitudes = [F(low), F(high)] + [F(rng.uniform(low, high)) for _ in range(between)]
    for amplitude in amplitudes:
        case = problem(round(amplitude, 6))
        answers = any(has_torus(case, read_rotation(name, 2 if name in ("T49", "spiral") else 1))
                      for name in rotations), has_none(case)
        assert answers != (True, True)
        seen.add(answers)
    assert {(True, False), (False, True)} <= seen
