"""Pictures and tables of states, proved orbits and families, and phase portraits: they show what
the program computed, and say what that is."""

import math
import sys

import numpy as np
import pytest

from converse import ConverseError, StandardMap, orbits
from converse.orbits.portrait import starts
from converse.orbits.solver import Family, newton

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure  # noqa: E402
from matplotlib.text import Text  # noqa: E402

from converse.orbits import pictures  # noqa: E402

START = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}
SPIRAL = (28, 37), 49
TURN = 2 * math.pi


@pytest.fixture(scope="module")
def plane():
    """States of two angles."""
    return orbits.follow(orbits.trig, *SPIRAL, [0.005, 0.01])


@pytest.fixture(scope="module")
def line():
    """States of one angle."""
    return orbits.follow(orbits.standard, (3,), 8, [0.5, 0.9])


@pytest.fixture(scope="module")
def saddle():
    found, _ = newton(orbits.straight(orbits.trig, (2, 3), 5, (0.1489578, 0.1489578)), 0.01)
    assert found.label == "saddle"
    return found


def data(axes, number=0):
    return np.array(axes.get_lines()[number].get_data()).T


# ---- states

def test_a_row_for_each_state(plane, line):
    figure = Figure()
    pictures.rows(figure, plane)
    for number, state in enumerate(plane):
        left, right = figure.axes[2 * number:2 * number + 2]
        assert np.array_equal(data(left), state.x) and np.array_equal(data(right), state.momenta)
        assert left.get_title(loc="left").startswith(
            "(%s)  ε = %r, (28, 37)/49: minimum" % ("ab"[number], state.eps))
    assert plane[0].plot().axes[0].get_title(loc="left").startswith("ε = 0.005, (28, 37)/49")
    figure = Figure()
    assert pictures.rows(figure, line) == ""
    for panel, state in zip(figure.axes, line):
        assert np.array_equal(data(panel), np.column_stack([state.x, state.momenta]))
        assert panel.get_title(loc="left").startswith("ε = %r, 3/8: minimum" % state.eps)


@pytest.mark.slow
def test_a_figure_of_a_state(plane, line):
    """A Figure that a notebook shows, with letters of eight points at least; or only the points, in
    Axes of one's own."""
    for state in plane[0], line[0]:
        figure = state.plot()
        assert len(figure.axes) == state.potential.n and not figure.texts
        assert figure._repr_png_().startswith(START["png"])
        assert min(word.get_size() for word in figure.findobj(Text) if word.get_text()) >= 8
    axes = Figure().subplots(1, 2)
    assert plane[0].plot(axes) is axes
    assert np.array_equal(data(axes[0]), plane[0].x)
    assert np.array_equal(data(axes[1]), plane[0].momenta) and not axes[0].get_title(loc="left")
    one = Figure().subplots()
    assert plane[1].plot(ax=one) is one and np.array_equal(data(one), plane[1].x)
    one = Figure().subplots()
    line[0].plot(one)
    assert np.array_equal(data(one)[:, 1], line[0].momenta[:, 0])
    for state, ax in (line[0], axes), (plane[0], Figure().subplots(3)):
        with pytest.raises(ValueError, match="is drawn into"):
            state.plot(ax)


# ---- families

def test_exponents_of_a_family(plane, line):
    axes = Figure().subplots()
    assert plane.plot(axes) is axes
    for k in range(2):
        assert np.array_equal(data(axes, 2 * k), np.column_stack([plane.eps,
                                                                  plane.exponents[:, k]]))
    assert axes.get_xlabel() == "ε" and axes.get_ylabel()
    assert line.plot().axes[0].get_lines()[0].get_ydata().tolist() == line.exponents[:, 0].tolist()
    assert plane.plot().axes[0].get_title() == "trig, (28, 37)/49"
    with pytest.raises(ValueError, match="without states"):
        Family(()).plot()


def test_states_that_are_no_minima_are_hollow(saddle):
    family = Family((saddle, saddle.relax()))
    assert family[1].label == "minimum"
    full, hollow = family.plot().axes[0].get_lines()[:2]
    assert list(full.get_ydata()) == family.exponents[:, 0].tolist()
    assert list(hollow.get_ydata()) == [saddle.exponents[0]]
    assert hollow.get_markerfacecolor() == "white"


def test_a_picture_of_a_proved_orbit(line):
    proof = orbits.prove(line[1])
    title = proof.plot().axes[0].get_title(loc="left")
    assert "proved within" in title
    assert np.array_equal(data(proof.plot().axes[0])[:, 0], proof.nearest.x[:, 0])


def test_without_matplotlib(plane, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for draw in plane[0].plot, plane.plot, orbits.trig.portrait:
        with pytest.raises(ConverseError, match=r"converse-kam\[plot\]"):
            draw()


# ---- phase portraits

def test_starts_are_spread():
    for n in 1, 2:
        x, p = starts(n, 400)
        points = np.concatenate([x.reshape(400, n), p.reshape(400, n)], axis=1)
        assert ((points >= 0) & (points < 1)).all()
        cells = np.unique((3 * points).astype(int), axis=0)
        assert len(cells) == 3 ** (2 * n)


@pytest.mark.parametrize("system, period", [(orbits.standard, 1), (StandardMap(1), TURN)])
def test_a_portrait_of_one_angle(system, period):
    y, J = (period * np.array(each) for each in ([0.1, 0.6], [0.2, 0.3]))
    figure = system.portrait(y, J, 50, eps=0.9)
    panel, = figure.axes
    ys, Js = system.orbit(y, J, 50, 0.9)
    for k in range(2):
        assert data(panel, k) == pytest.approx(np.column_stack([ys[:, k], Js[:, k]]) % period)
    names = panel.get_xlabel(), panel.get_ylabel()
    assert names == (("$x$  mod $1$", "$p$  mod $1$") if period == 1 else (
        r"$y$  mod $2\pi$", r"$J$  mod $2\pi$"))
    assert panel.get_xlim() == panel.get_ylim() == (0, period)
    assert not panel.get_title()


def test_projections():
    x, p = np.random.default_rng(3).random((2, 30, 2))
    xs, ps = (each % 1 for each in orbits.trig.orbit(x, p, 40, 0.01))
    panel, = orbits.trig.portrait(x, p, 40, eps=0.01).axes
    assert "projected" in panel.get_title() and panel.get_xlabel() == "$x_0$  mod $1$"
    for k in range(30):
        assert data(panel, k) == pytest.approx(np.stack([xs[:, k, 0], ps[:, k, 0]], 1))


@pytest.mark.parametrize("potential, wrong, words", [
    (orbits.standard, {"y": 0.1}, "both angles and momenta"),
    (orbits.trig, {"steps": 1.5}, "steps"),
    (orbits.trig, {"y": [0.1], "J": [0.2]}, "shape"), (orbits.trig, {"steps": 10 ** 8}, "10000000"),
    (orbits.standard, {"y": [], "J": []}, "0 orbits"), (orbits.trig, {"eps": math.nan}, "eps")])
def test_bad_portraits(potential, wrong, words):
    with pytest.raises(ValueError, match=words) as caught:
        potential.portrait(**wrong)
    assert "\n" not in str(caught.value)
