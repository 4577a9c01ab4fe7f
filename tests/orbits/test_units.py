"""The states of a SymplecticMap have the map's units: angles and momenta of period 2 pi."""

import dataclasses
import math
from fractions import Fraction

import numpy as np
import pytest

from converse import FroeschleMap, StandardMap, orbits

TURN = 2 * math.pi
STANDARD, FROESCHLE = StandardMap("1.2"), FroeschleMap("0.4", "0.2")
CASES = [(STANDARD, (3,), 8), (FROESCHLE, (2, 3), 7)]


@pytest.mark.parametrize("system, p, q", CASES)
def test_the_map_takes_each_point_to_the_next(system, p, q):
    state = orbits.follow(system, p, q)[0]
    y, J = system.map(state.x, state.momenta)
    away = (y - np.roll(state.x, -1, 0)) / TURN
    assert np.abs(away - np.round(away)).max() < 1e-12
    assert np.abs(J - np.roll(state.momenta, -1, 0)).max() < 1e-12
    assert state.x.max() > 2 and (0 <= state.x).all() and (state.x < TURN).all()
    assert state.momenta.mean(0) == pytest.approx(TURN * state.rotation)
    y, _ = state.potential.map(state.x, state.momenta)
    assert y == pytest.approx(system.map(state.x, state.momenta)[0])


def test_against_angles_of_period_1():
    """Lengths are 2 pi times, actions and areas 4 pi^2 times those of orbits.standard, which is the
    same map for angles that begin half a turn further."""
    ours = orbits.follow(STANDARD, 3, 8)[0]
    turns = dataclasses.replace(ours, potential=orbits.standard, eps=1.2, origin=(0.5,))
    assert ours.x == pytest.approx(TURN * ((turns.x + 0.5) % 1))
    for name in "momenta", "deviation":
        assert getattr(ours, name) == pytest.approx(TURN * np.array(getattr(turns, name)))
    moved, there = (state.moved(state.u + np.arange(8)[:, None] / 99) for state in (ours, turns))
    assert moved.gradient == pytest.approx(TURN * there.gradient)
    assert (moved.shadow, moved.grad_size) == pytest.approx(
        (TURN * there.shadow, TURN * there.grad_size))
    assert ours.action == pytest.approx(TURN ** 2 * turns.action)
    assert (ours.residue, ours.least) == pytest.approx((turns.residue, turns.least))
    assert ours.minimax().flux == pytest.approx(TURN ** 2 * turns.minimax().flux)


def test_the_flux_through_the_gap_of_the_fixed_point():
    """It is the difference of V = k cos y between its maximum and its minimum: 2 k."""
    pair = orbits.follow(STANDARD, 0, 1)[0].minimax()
    assert pair.flux == pytest.approx(2.4, rel=1e-14)
    proved = pair.prove()
    low, high = proved.flux
    assert low < Fraction("2.4") < high < low + Fraction(1, 10 ** 15)


@pytest.mark.parametrize("system, p, q", CASES)
def test_theorems_are_in_the_same_units(system, p, q):
    state = orbits.follow(system, p, q)[0]
    proved = orbits.prove(state)
    low, high = proved.action
    assert abs(low - state.action) < 1e-13 and low < high < low + 1e-17
    x, J = system.letters
    for text in state.report(), proved.report():
        assert "%s' = %s + %s'" % (x, x, J) in text and "|2 pi p/q|^2/2" in text
        assert "V(%s)" % x in text and "2 pi x" not in text and "4 pi^2" not in text
    assert "angles of period 2 pi" in state.report()
    words = orbits.proved.distance_words(state.potential, proved.radius)
    assert words in proved.report() and 0 <= float(words) / float(proved.radius) / TURN - 1 < 0.11


def test_pictures_are_in_the_same_units():
    pytest.importorskip("matplotlib")
    panel, = orbits.follow(STANDARD, 3, 8)[0].plot().axes
    assert panel.get_xlim() == (0, TURN)
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("$y$", "$J$")


def test_files_keep_the_units(tmp_path):
    family = orbits.follow(STANDARD, 3, 8)
    family.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as stored:
        assert (stored["x"][0] == family[0].x).all()
