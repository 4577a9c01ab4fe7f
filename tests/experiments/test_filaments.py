"""What the points of an orbit hang together as, and the counts that the thesis gives."""

import numpy as np
import pytest
from thesis.filaments import filaments

from converse import orbits

from truth import TORTURE


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
