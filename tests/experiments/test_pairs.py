"""The closest pairs of points, against all pairs."""

import math

import numpy as np
import pytest
from pairs import pairs as closest

from converse import orbits


@pytest.mark.parametrize("potential, q, count", [
    (orbits.trig, 2, 800), (orbits.trig, 3, 2), (orbits.trig, 90, 800), (orbits.trig, 90, 4005),
    (orbits.standard, 1, 800), (orbits.standard, 2, 1), (orbits.standard, 90, 300)], ids=str)
def test_pairs_against_all_pairs(potential, q, count):
    rng = np.random.default_rng(q)
    n = potential.n
    for scale in (0.5, 1e-3):                   # all over the torus; in a clump over its corner
        u = scale * rng.uniform(-1, 1, (q, n))
        state = orbits.PeriodicOrbit(potential, (0,) * n, q, 0.1, u, (0.0,) * n)
        i, j = np.triu_indices(q, 1)
        apart = np.abs(state.x[i] - state.x[j])
        distance = np.sqrt((np.minimum(apart, 1 - apart) ** 2).sum(1))
        pairs, first = closest(state, count), np.argsort(distance)[:count]
        assert np.allclose(pairs.distance, distance[first], rtol=1e-14, atol=1e-16)
        if len(first):
            assert {frozenset(pair) for pair in zip(pairs.i, pairs.j)} \
                == {frozenset(pair) for pair in zip(i[first], j[first])}
        assert np.allclose(pairs.momentum, np.linalg.norm(
            state.momenta[pairs.i] - state.momenta[pairs.j], axis=1), atol=1e-15)


def test_pairs_half_way_round():
    """Two points opposite each other are as far in both directions, and one pair."""
    state = orbits.PeriodicOrbit(orbits.trig, (0, 0), 3, 0.0, [[0, 0], [0.5, 0], [0.25, 0.5]],
                                 (0, 0))
    pairs = closest(state)
    assert {frozenset(pair) for pair in zip(pairs.i, pairs.j)} == {frozenset(s) for s in
                                                                   ((0, 1), (0, 2), (1, 2))}
    assert pairs.distance == pytest.approx([0.5, math.hypot(0.25, 0.5), math.hypot(0.25, 0.5)])


def test_pairs_at_the_same_place():
    """The same points again are at distance zero, as often as there are copies."""
    double = orbits.straight(orbits.trig, (5, 7), 9).relax(0.03).repeat(2)
    assert (closest(double, 9).distance == 0).all() and closest(double, 10).distance[9] > 0.01
    assert sorted((closest(double, 9).j - closest(double, 9).i) % 9) == [0] * 9
