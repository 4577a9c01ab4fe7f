"""What the points of an orbit hang together as, and the counts that the thesis gives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from thesis.filaments import Filaments, clumps, clusters, filaments

from converse import orbits

from truth import TORTURE


def curves(count, a, b, q, blur=0.002, seed=1):
    """Points blurred about count parallel curves of type (a, b), evenly apart and not on a cell's
    edge."""
    rng = np.random.default_rng(seed)
    t = (np.arange(q) // count + rng.uniform(0, 0.5, q)) / (q // count)
    place = (np.arange(q) % count + 0.2) / count
    across = np.array([b, -a]) / (a * a + b * b)
    return (t[:, None] * (a, b) + place[:, None] * across + rng.normal(0, blur, (q, 2))) % 1.0


@pytest.mark.parametrize("count, kind", [(3, (1, -1)), (7, (0, 1)), (1, (1, -4)), (2, (1, 2)),
                                         (4, (1, 0)), (1, (3, 2))])
def test_curves(count, kind):
    x = curves(count, *kind, 600)
    found = filaments(x)
    assert found.type == kind and found.count == count
    assert found.clusters == count * abs(kind[found.axis]) and 0 < found.gap < found.distance
    turned = filaments(x[::-1, ::-1])           # the coordinates exchanged
    sign = 1 if kind[::-1] > (0, 0) else -1
    assert turned.type == (sign * kind[1], sign * kind[0]) and turned.count == count
    assert (turned.gap, turned.distance) == pytest.approx((found.gap, found.distance))


@settings(max_examples=20 * TORTURE)
@given(st.tuples(st.floats(-3, 3), st.floats(-3, 3)))
def test_a_translation_changes_nothing(shift):
    x = curves(2, 1, -2, 120)
    moved, found = filaments(x + shift), filaments(x)
    assert moved.type == found.type
    assert (moved.gap, moved.distance) == pytest.approx((found.gap, found.distance))


def test_surfaces_and_clusters_are_no_filaments():
    rng = np.random.default_rng(2)
    axis = (np.arange(20) + 0.5) / 20
    grid = np.stack(np.meshgrid(axis, axis), -1).reshape(-1, 2)
    assert filaments(grid + rng.uniform(-0.004, 0.004, grid.shape)) is None
    assert filaments(0.3 + rng.normal(0, 0.001, (200, 2))) is None
    assert filaments(np.array([[0.5, 0.5]])) is None


def rows(count):
    """Two rows of so many points, 0.3 apart."""
    return np.array([(k / count, y) for k in range(count) for y in (0.1, 0.4)])


def test_gap_and_distance():
    assert filaments(rows(20)) == Filaments((1, 0), pytest.approx(0.05), pytest.approx(0.3), 0, 2)
    assert filaments(rows(11)).type == (1, 0)
    assert filaments(rows(9)) is None                   # no curve has such gaps


def test_clusters():
    assert clusters(curves(5, 0, 1, 500), 1) == 5
    assert clusters(curves(5, 1, 0, 500), 0) == 5
    assert clusters(curves(1, 3, 1, 500), 0, 1 / 3) == 3
    assert clusters(np.array([[0.2, 0.2], [0.2, 0.5], [0.2, 0.54]]), 0) == 2    # where any are


def test_bad_points():
    for x in (np.zeros((3, 1)), np.zeros(4), np.full((2, 2), np.nan)):
        with pytest.raises(ValueError, match="shape|finite"):
            filaments(x)


@pytest.mark.parametrize("potential, p, q, eps, count, kind, resonance", [
    ("trig", (1432, 1897), 2513, 0.025, 3, (1, -1), (3, 3)),
    ("poly", (1432, 1897), 2513, 0.0075, 7, (0, 1), (7, 0)),
    ("poly", (377, 2330), 3770, 0.02, 1, (1, -4), (4, 1))] + [
    ("trig", (1432, 1897), 2513, 0.0275, 3, (1, -1), (3, 3)),
    ("poly", (1432, 1897), 2513, 0.005, 7, (0, 1), (7, 0)),
    ("poly", (377, 2330), 3770, 0.015, 1, (1, -4), (4, 1))] * (TORTURE > 1))
def test_the_thesis(potential, p, q, eps, count, kind, resonance):
    """Continuation as in the figures.  Three curves of type (1, 1), seven of (0, 1), one of (4, 1):
    the thesis names the last by its resonance, and leaves out signs.  The curves cross the
    resonance k: its k.p/q is nearly whole."""
    steps = [0.0025 * k for k in range(1, round(eps / 0.0025) + 1)]
    state = orbits.follow(getattr(orbits, potential), p, q, steps)[-1]
    found = filaments(state.x)
    assert (found.type, found.count) == (kind, count)
    assert np.dot(resonance, kind) == 0
    turns = np.dot(resonance, p) / q
    assert 0 < abs(turns - round(turns)) < 0.03
    assert found.clusters == count * max(map(abs, kind))


def test_a_torus_is_no_filament():
    state, = orbits.follow(orbits.trig, (1432, 1897), 2513, [0.0075])
    assert filaments(state.x) is None


def test_clumps():
    """Components of the graph whose links are at most so long, on the torus."""
    x = np.array([[0.001, 0.5], [0.999, 0.5], [0.004, 0.5], [0.3, 0.9], [0.3, 0.1]])
    assert [clumps(x, link) for link in (0.001, 0.0025, 0.0035, 0.21, 0.6)] == [5, 4, 3, 2, 1]
    assert clumps(x[:1], 0.1) == 1
