"""The charts: drawn from made-up numbers; the command is not run to its end, which takes long."""

import math
import runpy
import xml.etree.ElementTree as ET

import chart
import numpy as np
import pytest
from conftest import ROOT

from converse import orbits
from converse.model.map import LINE

ROWS = {
    "angles": [("1989", "0.0272", 469, 0.1, "6.0.0"), ("2 angles", "0.0139", 41000, 50.0, "6.0.0"),
               ("2 angles", "0.0200", 45, 0.01, "6.0.0"),
               ("3 angles", "0.0133", 12436, 0.5, "6.1.0"),
               ("3 angles", "0.0183", 30, 0.01, "6.1.0")],
    "bound": [("1989", "0.0274", 2698.0, "1989"), ("thesis", "0.0274", 0.05, "1.12.0"),
              ("no torus", "0.0250", 0.001, "1.12.0"), ("no torus", "0.01389", 240.0, "1.12.0"),
              ("torus", "0.004", 1.3, "1.12.0"), ("torus", "0.0122", 1559.0, "2026-11-27"),
              ("tori up to", "0.004", 12.0, "1.11.0"), ("tori up to", "0.008", 166.0, "1.11.0")],
    "width": [("fixed form", "double", 2, 150.0, 1.02), ("column rotor", "35", 3, 5e4, 1.4),
              ("Taylor model", "double", 4, 160.0, 1.0)],
    "wall": [("thesis", "0.0280", 1, 0, "yes"), ("thesis", "0.0270", 71804, 28, "no"),
             ("loewner", "0.0141", 216165, 36, "yes")],
}


@pytest.mark.parametrize("name", sorted(chart.CHARTS))
def test_charts(name):
    pytest.importorskip("matplotlib")
    data = chart.chart(name, ROWS[name])
    ET.fromstring(data)
    assert b"dc:date" not in data and data == chart.chart(name, ROWS[name])


def drawn(name, rows):
    """The caption and all other words of a chart, and its markers."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    figure = Figure()
    caption = chart.CHARTS[name][2](figure, rows)
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    return caption, "\n".join(words), [line for axes in figure.axes for line in axes.get_lines()]


def test_the_two_sides_do_not_meet():
    """The end of each curve is labelled, and no torus is drawn above one that is excluded."""
    _, words, _ = drawn("bound", ROWS["bound"])
    assert "0.01389" in words and "0.0122" in words and words.count("PROVED") == 3
    rows = [*chart.BOUNDS, chart.LAST[0]], [*chart.TORI, *(each for each, *_ in chart.RANGES),
                                            chart.sides.LONGEST[1][2]]
    assert max(map(float, rows[1])) < chart.sides.FRONTIER["line"] < min(map(float, rows[0]))


def test_the_last_circle_of_the_diagonal():
    """The map on it is trig's, and of the noble rotation numbers none is seen to last longer than
    [0; 5, 1, 1, ...]; so they do in the standard map, where the last one is known."""
    experiment = runpy.run_path(str(ROOT / "experiments" / "diagonal.py"))
    diagonal = experiment["diagonal"]()
    t = np.random.default_rng(1).uniform(0, 1, (50, 1))
    both = orbits.trig.evaluate(np.hstack([t, t]))[1]
    assert np.abs(diagonal.evaluate(t)[1] - both).max() < 1e-13
    (p,), q = experiment["noble"]((5,), 5545)
    assert (p, q) == (987, 5545) and p / q == pytest.approx(1 / (4.5 + 5 ** 0.5 / 2), abs=1e-7)
    below, above = orbits.onset(diagonal, (p,), q, step=0.0005, width=1e-6, top=0.02)
    assert 0.0138 < below.eps < above.eps < 0.01382
    (first, head), (second, _), *_ = experiment["nobles"](2, 5, 100)
    assert head == (5,) and abs(first - above.eps) < 3e-5 and second < below.eps


def test_bounds_are_measured():
    rows = list(chart.bound(True))
    assert {row[0] for row in rows} == {row[0] for row in ROWS["bound"]}
    assert all(row[2] > 0 and math.isfinite(row[2]) for row in rows)


def test_width():
    """An enclosure is never narrower than the orbits of sampled points."""
    rows = list(chart.width(True))
    assert {row[0] for row in rows} == {"fixed form", "column rotor", "Taylor model"}
    assert all(row[3] > 0 and 1 <= row[4] < 10 for row in rows)


def test_the_line():
    problem = chart.on_line("0.0274", "0.0276", together=True)
    low, high = (float(problem.centre[0] + sign * problem.half[0]) for sign in (-1, 1))
    assert low == pytest.approx(0.0274 * LINE) and high == pytest.approx(0.0276 * LINE)
    assert problem.centre[2] == 2 * problem.centre[1] == 2 * problem.centre[0]
    assert problem.together and problem.full_torus
