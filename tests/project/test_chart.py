"""The charts: drawn from made-up numbers; the command is not run to its end, which takes long."""

import csv
import io
import math
import os
import re
import runpy
import subprocess
import sys
import xml.etree.ElementTree as ET

import chart
import numpy as np
import pytest
from conftest import ROOT

from converse import orbits
from converse.commands import common
from converse.draw import plot
from converse.model.map import LINE

ROWS = {
    "bound": [("1989", "0.0274", 2698.0, "1989"), ("thesis", "0.0274", 0.05, "1.12.0"),
              ("no torus", "0.0250", 0.001, "1.12.0"), ("no torus", "0.01389", 240.0, "1.12.0"),
              ("torus", "0.004", 1.3, "1.12.0"), ("torus", "0.0122", 1559.0, "2026-11-27"),
              ("tori up to", "0.004", 12.0, "1.11.0"), ("tori up to", "0.008", 166.0, "1.11.0")],
    "width": [("fixed form", "double", 2, 150.0, 1.02), ("column rotor", "35", 3, 5e4, 1.4),
              ("Taylor model", "double", 4, 160.0, 1.0)],
    "wall": [("thesis", "0.0280", 1, 0, "yes"), ("thesis", "0.0270", 71804, 28, "no"),
             ("loewner", "0.0141", 216165, 36, "yes")],
}
START = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}


@pytest.fixture
def quick(monkeypatch):
    """The measurements take no time: they are made up."""
    pytest.importorskip("matplotlib")
    for name, (header, _, draw) in chart.CHARTS.items():
        monkeypatch.setitem(chart.CHARTS, name, (header, lambda quick, name=name: iter(ROWS[name]),
                                                 draw))


def one_line(capsys):
    out, err = capsys.readouterr()
    assert err.startswith("chart.py: ") and err.count("\n") == 1
    return out, err


@pytest.mark.parametrize("kind", plot.FORMATS)
@pytest.mark.parametrize("name", sorted(chart.CHARTS))
def test_charts(name, kind):
    pytest.importorskip("matplotlib")
    data = chart.chart(name, ROWS[name], kind)
    assert data.startswith(START[kind])
    if kind == "svg":
        ET.fromstring(data)
        assert b"dc:date" not in data and data == chart.chart(name, ROWS[name], kind)


def test_files(quick, tmp_path, capsys):
    place = tmp_path / "new" / "place"
    assert chart.main([str(place), "--quick", "--format", "svg"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert sorted(os.listdir(place)) == sorted(
        "chart-%s.%s" % (name, ending) for name in ROWS for ending in ("svg", "csv"))
    for name, rows in ROWS.items():
        lines = list(csv.reader(io.StringIO((place / ("chart-%s.csv" % name)).read_text())))
        assert tuple(lines[0]) == chart.CHARTS[name][0] and len(lines) == len(rows) + 1
        for words, row in zip(lines[1:], rows):
            for word, item in zip(words, row):
                assert word == item if isinstance(item, str) else float(word) == item
    assert out.count("\n") == sum(map(len, ROWS.values())) + 1
    assert "wall: method thesis, epsilon 0.0280, prisms 1, deepest_cut 0, proved yes\n" in out
    last = out.splitlines()[-1]
    assert last.startswith("written: ") and all("chart-%s.svg" % name in last for name in ROWS)


def test_a_table_is_drawn_again(quick, tmp_path, monkeypatch, capsys):
    """And what is in it is what is drawn; nothing is measured."""
    assert chart.main([str(tmp_path), "--only", "wall"]) == 0
    assert os.listdir(tmp_path) and not (tmp_path / "chart-bound.csv").exists()
    picture = (tmp_path / "chart-wall.svg").read_bytes()
    (tmp_path / "chart-wall.svg").unlink()
    monkeypatch.setattr(chart, "WALLS", None)
    assert chart.main([str(tmp_path), "--only", "wall", "--draw"]) == 0
    assert (tmp_path / "chart-wall.svg").read_bytes() == picture
    assert chart.read("wall", str(tmp_path / "chart-wall.csv")) == ROWS["wall"]
    (tmp_path / "chart-wall.csv").write_text("a,b\n")
    capsys.readouterr()
    assert chart.main([str(tmp_path), "--only", "wall", "--draw"]) == common.BAD
    assert "measure anew" in one_line(capsys)[1]


def test_bad_places(quick, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert chart.main([str(tmp_path / "file")]) == common.BAD
    assert "file" in one_line(capsys)[1]
    (tmp_path / "chart-wall.csv").mkdir()
    assert chart.main([str(tmp_path)]) == common.BAD
    out, err = one_line(capsys)
    assert out == "" and "chart-wall.csv" in err        # before anything is measured
    if os.geteuid():
        (tmp_path / "closed").mkdir(mode=0o500)
        assert chart.main([str(tmp_path / "closed")]) == common.BAD
        one_line(capsys)


def test_bad_usage(capsys):
    assert chart.main(["--format", "gif"]) == common.BAD
    assert "--help" in one_line(capsys)[1]
    assert chart.main(["a", "b"]) == common.BAD
    one_line(capsys)


def test_no_matplotlib(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert chart.main([str(tmp_path / "place")]) == common.BAD
    assert "pip install 'converse-kam[plot]'" in one_line(capsys)[1] and not os.listdir(tmp_path)


def test_interrupted(quick, tmp_path, monkeypatch, capsys):
    def interrupted(quick):
        yield ROWS["wall"][0]
        raise KeyboardInterrupt

    monkeypatch.setitem(chart.CHARTS, "wall", (*chart.CHARTS["wall"][:1], interrupted,
                                               chart.CHARTS["wall"][2]))
    assert chart.main([str(tmp_path)]) == 130
    one_line(capsys)
    assert (tmp_path / "chart-width.svg").exists() and not (tmp_path / "chart-wall.svg").exists()


def test_help(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "experiments" / "chart.py", "--help"],
                          cwd=tmp_path,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0 and done.stderr == b""
    assert "directory" in done.stdout.decode().lower()


def test_caption():
    text = chart.machine()
    assert re.fullmatch(r".*\d+ cores?", text)


@pytest.mark.parametrize("name", sorted(chart.CHARTS))
def test_readable(name, monkeypatch):
    """Letters of eight points or more; no release is called this one, which will be another's; and
    the caption may be left out."""
    pytest.importorskip("matplotlib")
    from matplotlib.text import Text

    figures, encode = [], plot.encode
    monkeypatch.setattr(plot, "encode", lambda figure, kind, **options: (
        figures.append(figure), encode(figure, kind, **options))[1])
    assert chart.chart(name, ROWS[name], "png") != chart.chart(name, ROWS[name], "png", False)
    with_words, without = ([text for text in figure.findobj(Text) if text.get_text().strip()]
                           for figure in figures)
    assert min(text.get_size() for text in with_words) >= 8
    assert not any("this release" in text.get_text() or "converse 1" in text.get_text()
                   for text in with_words)
    assert len(with_words) == len(without) + 1


def drawn(name, rows):
    """The caption and all other words of a chart, and its markers."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    figure = Figure()
    caption = chart.CHARTS[name][2](figure, rows)
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    return caption, "\n".join(words), [line for axes in figure.axes for line in axes.get_lines()]


def test_the_wall_names_its_markers():
    """Open ones are explained where there are such, and only there."""
    for rows in (ROWS["wall"], _pick(ROWS["wall"], "yes"), _pick(ROWS["wall"], "no")):
        caption, _, lines = drawn("wall", rows)
        hollow = [line for line in lines if line.get_markerfacecolor() == "white"
                  and len(line.get_xdata())]
        assert bool(hollow) == ("open" in caption) == bool(_pick(rows, "no"))


def _pick(rows, word):
    return [row for row in rows if row[-1] == word]


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


def test_the_diagonal_stops_the_sharper_method(monkeypatch, capsys):
    """With a circle some successors on it are left; above none is, and those off it go first."""
    experiment = runpy.run_path(str(ROOT / "experiments" / "diagonal.py"))
    rows = list(experiment["off_diagonal"](0.0144, 0.858, 300, 60))
    assert rows[-1][:2] == (33, 0)
    assert rows[-2][2] < rows[-2][1] / 10 and rows[0][2] > rows[0][1] / 2
    experiment["main"].__globals__["KEPT"] = 8000
    experiment["SIZES"]["quick"] = {"heads": (1, 6), "least": 100, "cells": 50, "most": 40,
                                    "eps": (0.0144, 0.0137), "xstar": (0.858, 0.86)}
    monkeypatch.setattr(sys, "argv", ["diagonal.py", "--quick"])
    assert experiment["main"]() == 0
    out = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r" +0\.0138. +\[0; 5, 1, 1, 1, \.\.\.\]", out[1])
    assert [line.split() for line in out[-2:]] == [["eps", "0.01440", "33", "33"],
                                                   ["eps", "0.01370", "-", "-"]]


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
