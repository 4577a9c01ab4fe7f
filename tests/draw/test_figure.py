"""The figure: rendered, it shows the tree's areas where they belong, and says what it shows."""

import itertools
import math
import os
import random
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from fractions import Fraction

import pytest

from converse import ConverseError, Problem, prove, read_input
from converse.draw import captions, plot
from converse.model.map import MuldoonMap, SymplecticMap, from_patch
from converse.prover.tree import leaves

SHA = "0123456789abcdef" * 4
ELSEWHERE = {"xstar": ("9", "9"), "v": ("0.5", "0.5", "0.25", "0.25")}      # no x* in the figure
def drawn(proof, dpi=50):
    """The pixels of the prisms' square as rows of (red, green, blue), the top one first."""
    matplotlib = pytest.importorskip("matplotlib")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        figure = Figure(figsize=(4, 4), dpi=dpi)
        canvas = FigureCanvasAgg(figure)
        axes = figure.add_axes([0, 0, 1, 1])
        assert proof.plot(ax=axes) is axes
        axes.set_axis_off()
        canvas.draw()
    pixels = bytes(canvas.buffer_rgba())
    return [[pixels[x:x + 3] for x in range(y, y + 16 * dpi, 4)]
            for y in range(0, len(pixels), 16 * dpi)]


@pytest.fixture(params=["outlines", "surfaces"])
def shown(request, monkeypatch):
    """A function from proofs to pixels, for each way to draw."""
    monkeypatch.setattr(plot, "MANY", 0 if request.param == "surfaces" else 10 ** 9)
    return drawn


def share(rows, test):
    colours = Counter(itertools.chain(*rows))
    return sum(n for pixel, n in colours.items() if test(pixel)) / (len(rows) * len(rows[0]))


def is_dark(pixel):
    return max(pixel) < 100


def is_white(pixel):
    return pixel == b"\xff\xff\xff"


def is_proved(pixel):
    """Dark, or a colour of the scale of depths."""
    return max(pixel) < 100 or (max(pixel) - min(pixel) > 60 and not is_red(pixel)
                                and not is_reddish(pixel))


def is_red(pixel):
    """The colour of what is undecided, vermillion."""
    return pixel[0] > 190 and pixel[1] < 110 and pixel[2] < 60


def is_reddish(pixel):
    return pixel[0] > 190 and pixel[0] - 40 > pixel[1] > pixel[2] + 20


def area(proof, kind):
    """The share of the region that leaves of this kind cover."""
    whole = 4 * proof.problem.half[3] * proof.problem.half[4]
    return float(sum(4 * leaf.half[0] * leaf.half[1]
                     for leaf in leaves(proof.problem, proof.tree, kind)) / whole)


def random_tree(rng, depth):
    if depth == 0 or rng.random() < 0.1:
        return rng.choice("PPSS")
    return rng.choice("01") + random_tree(rng, depth - 1) + random_tree(rng, depth - 1)


def test_a_real_proof(root):
    proof = prove(read_input(root / "inputs" / "trig274.in"))
    rows = drawn(proof)
    assert share(rows, is_dark) == pytest.approx(area(proof, "P"), abs=0.01)
    assert share(rows, is_red) == 0


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.slow
def test_areas_of_random_trees(made_up, shown, seed):
    proof = made_up(random_tree(random.Random(seed), 7), xstar=("9", "9"), v=("1", "1", "1", "0.5"))
    assert share(shown(proof), is_proved) == pytest.approx(area(proof, "P"), abs=0.015)


def test_each_kind_in_its_place(made_up):
    # the lower left quarter proved, the upper left skipped, the lower right undecided,
    # the upper right untried
    rows = drawn(made_up("01PS1U", **ELSEWHERE))
    half = len(rows) // 2
    quarters = {(x, y): [row[x * half + 9:x * half + half - 9]
                         for row in rows[y * half + 9:y * half + half - 9]]
                for x in (0, 1) for y in (0, 1)}

    def only(place, value):
        return all(pixel == bytes([value] * 3) for row in quarters[place] for pixel in row)

    assert only((0, 1), round(0.35 * 255)) and only((0, 0), round(0.85 * 255))
    assert only((1, 0), 255)
    assert share(quarters[1, 1], is_reddish) == 1
    assert share(rows, is_dark) == pytest.approx(0.25, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("tree", ["2?P", "2P?", "2P", "3?0PP", "20PP?", "42P?P", "2S?"])
def test_untried_prisms_are_not_hidden(made_up, shown, tree):
    """Where parameters were cut, proved prisms may share the place."""
    rows = shown(made_up(tree, **ELSEWHERE))
    assert share(rows, is_proved) < 0.03        # of the frame
    assert share(rows, is_white) > 0.9


@pytest.mark.parametrize("tree", ["2UP", "2PU", "2U2PP", "2U?", "2?U", "3P2?U", "2SU"])
def test_undecided_prisms_are_not_hidden(made_up, shown, tree):
    """Neither by proved ones nor by untried ones."""
    rows = shown(made_up(tree, **ELSEWHERE))
    assert share(rows, is_proved) < 0.03
    assert share(rows, lambda pixel: is_red(pixel) or is_reddish(pixel)) > 0.002


def test_only_half_of_the_place_is_untried(made_up, shown):
    rows = shown(made_up("20P?P", **ELSEWHERE))
    assert share(rows, is_proved) == pytest.approx(0.5, abs=0.02)
    assert share(rows, is_white) == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("tree", ["0P" * 25 + "U", "01" * 20 + "U" + "PP" * 20,
                                  "0P1P" * 20 + "U", "20P1PU0P1PU", "2" + "0P1P" * 20 + "UP"])
def test_tiny_undecided_prisms_are_seen(made_up, shown, tree):
    """However small, in the midst and in a corner, and under proved ones."""
    rows = shown(made_up(tree, **ELSEWHERE))
    assert share(rows, lambda pixel: is_red(pixel) or is_reddish(pixel)) > 1e-5


@pytest.mark.slow
def test_tiny_untried_prisms_are_seen(made_up, shown):
    rows = shown(made_up("0P1P" * 20 + "?", **ELSEWHERE), 100)
    assert share(rows, is_white) > share(shown(made_up("P", **ELSEWHERE), 100), is_white) == 0


@pytest.mark.parametrize("tree", ["P", "2PP", "2S0PS", "20SP0PS"])
def test_depth_without_cuts_of_angles(made_up, shown, tree):
    """A proved prism is seen at any depth, and above one that is skipped in the same place."""
    proof = made_up(tree, **ELSEWHERE)
    assert share(shown(proof), is_proved) == pytest.approx(
        {"P": 1, "2PP": 1, "2S0PS": 0.5, "20SP0PS": 1}[tree], abs=0.02)


def test_place_of_the_starting_point(made_up):
    pi = "3.14159265358979323846264338327950288"
    for v, xstar, place in (
            (("1", "1", "1", "1"), (pi, "0"), (0.5, 0.0)),
            (("1", "-1", "1", "1"), (pi, "1.5707963267948966"), (0.5, 0.25)),  # moved by 2 pi
            (("2.6", "4.5", "0.5", "2"), (pi, pi), (0.9, 0.625)),
            (("0", "0", "0.5", "0.5"), (pi, "0"), None),
            (("1", "1", "0", "1"), (pi, pi), None)):
        found = captions.star(made_up("P", v=v, xstar=xstar))
        assert found == (place and pytest.approx(place, abs=1e-12))


def words(proof):
    """The texts of the figure."""
    pytest.importorskip("matplotlib")
    axes = proof.plot().axes[0]
    texts = [axes.get_title(), *(text.get_text() for text in axes.texts)]
    return "\n".join(texts + [text.get_text() for text in axes.get_legend().get_texts()])


def test_what_is_said(made_up):
    part = ("0.5", "1", "0.25", "1")
    for proof, said, unsaid in (
            (made_up("P"), ["\nno invariant torus\n"], ["part", "undecided", "SHA", "share"]),
            (made_up("0P?"), ["undecided", "untried (1)"], ["no invariant", "share"]),
            (made_up("2PU"), ["undecided whether", "undecided (1)", "share a place"],
             ["no invariant"]),
            (made_up("P", v=part), ["in this part of the torus"], ["undecided"]),
            (made_up("U", v=part), ["undecided", "a part of the torus only"], ["no invariant"]),
            (made_up("P", as_printed=True), ["as printed", "not a proof"], ["no invariant"]),
            (made_up("P", as_printed=True, v=part), ["not a proof", "a part of the torus only"],
             ["no invariant"]),
            (made_up("U", as_printed=True), ["not a proof", "undecided"], ["no invariant"]),
            (made_up("01PS1U", sha256=SHA), [
                "proof file: SHA-256 " + SHA, "proved (1)", "skipped by symmetry (1)",
                "untried (1)", "undecided (1)", "x*, whose successors these are"], []),
            (made_up("P", xstar=("9", "9"), v=part), [], ["x*,"])):
        text = "\n%s\n" % words(proof)
        assert all(word in text for word in said), (said, text)
        assert not any(word in text for word in unsaid), (unsaid, text)


def test_the_colour_bar_counts_the_proved(made_up, monkeypatch):
    """The legend of surfaces has the other kinds, or is absent."""
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(plot, "MANY", 0)
    axes, bar = made_up("01PS1U").plot().axes
    assert bar.get_ylabel().startswith("proved (1):")
    assert not any("proved" in text.get_text() for text in axes.get_legend().get_texts())
    assert made_up("P", **ELSEWHERE).plot().axes[0].get_legend() is None


@pytest.mark.parametrize("ending", [".svg", ".png", ".pdf", ".SVG"])
@pytest.mark.slow
def test_other_formats(made_up, tmp_path, ending):
    """The name decides; the same proof gives the same file."""
    pytest.importorskip("matplotlib")
    paths = [tmp_path / (name + ending) for name in "ab"]
    for path in paths:
        plot.write(made_up("0P1US"), str(path))
    first, second = (path.read_bytes() for path in paths)
    assert first == second
    start = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}[ending.lower()]
    assert first.startswith(start)
    assert b"dc:date" not in first and b"CreationDate" not in first


def test_into_axes(made_up):
    """Only the prisms: the caller's legend and title are the caller's."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.subplots(2)[1]
    axes.set_title("mine")
    proof = made_up("20PU01PS1U")
    assert proof.plot(ax=axes) is axes
    assert axes.get_title() == "mine" and axes.get_legend() is None and not axes.texts
    assert len(figure.axes) == 2 and not figure.axes[0].patches
    assert [text.get_text() for text in axes.legend().get_texts()] == [
        "proved (2)", "skipped by symmetry (1)", "untried (1)", "undecided (2)", captions.STAR]
    assert axes.get_xlim() == axes.get_ylim() == (0, 2)
    star, = axes.lines
    assert star.get_xydata()[0] == pytest.approx([2 * x for x in captions.star(proof)])


@pytest.mark.slow
def test_without_a_caption(made_up, tmp_path):
    """Only the prisms, their axes and the legend, in every format."""
    pytest.importorskip("matplotlib")
    proof = made_up("01PSU", sha256=SHA)
    axes = proof.plot(caption=False).axes[0]
    assert not axes.get_title() and not axes.texts and axes.get_xlabel() and axes.get_legend()
    for caption in True, False:
        plot.write(proof, tmp_path / "a.svg", caption)
        said = (tmp_path / "a.svg").read_text()
        assert (SHA in said) == ("undecided whether" in said) == caption


def test_without_matplotlib(made_up, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    proof = made_up("01PSU")
    for draw in (proof.plot, lambda: plot.write(proof, tmp_path / "a.pdf"),
                 lambda: proof.plot(ax=object())):
        with pytest.raises(ConverseError, match="matplotlib"):
            draw()


SIDE_EFFECTS = """
import sys, matplotlib
matplotlib.use("pdf")
matplotlib.rcParams.update({"font.size": 21, "svg.hashsalt": None, "axes.facecolor": "red"})
before = dict(matplotlib.rcParams)
from converse import Proof, prove, read_input
from converse.draw import plot
proof = prove(read_input(%r))
def svg():
    plot.write(proof, sys.argv[1])
    return open(sys.argv[1]).read()
first = svg(); proof.plot()
from matplotlib.figure import Figure
proof.plot(ax=Figure().add_subplot())
assert dict(matplotlib.rcParams) == before and matplotlib.get_backend().lower() == "pdf"
assert "matplotlib.pyplot" not in sys.modules
matplotlib.rcdefaults()
assert first == svg()
"""


@pytest.mark.slow
def test_no_side_effects(root, tmp_path):
    """The user's backend and settings stay as they were, and do not change the file."""
    pytest.importorskip("matplotlib")
    done = subprocess.run([sys.executable, "-c", SIDE_EFFECTS % str(root / "inputs/trig278.in"),
                           str(tmp_path / "a.svg")], stderr=subprocess.PIPE)
    assert done.returncode == 0 and done.stderr == b"", done.stderr.decode()


# ---- other frames, other potentials

@pytest.mark.parametrize("frame", [(1, 0, -1, 1), (1, 0, 1, -1), (2, 1, -1, -1), (0, 1, 1, 0)])
def test_the_star_stands_in_the_frame(made_up, frame):
    """What is drawn at (v0, v1) is the point frame.(v0, v1), a multiple of 2 pi aside."""
    problem = replace(Problem(MuldoonMap(0, 0, ("0.4", "0.5"))), axes=frame)
    for x in (0.25, -1.5), (3.0, 7.0):
        proof = made_up("P").with_tree(0, problem=problem, xstar=tuple(map(str, x)))
        v = [2 * math.pi * part
             for part in captions.star(proof)]         # of a region from 0 to 2 pi
        there = frame[0] * v[0] + frame[1] * v[1], frame[2] * v[0] + frame[3] * v[1]
        assert all(abs(math.remainder(a - b, 2 * math.pi)) < 1e-9 for a, b in zip(there, x))


def test_what_is_said_of_other_problems(made_up):
    for problem, said in (
            (Problem(MuldoonMap(0, 0, ("0.4", "0.5"))),
             ["c in [0.4, 0.5], a = 0, b = 0", "the angles after x* are (v0, -v0 + v1)"]),
            (Problem(SymplecticMap([(1, 0, "-1/2"), (2, -1)], ["0.4", 1], [["0.1", 0]])), [
                "no invariant torus for every t[1] in [-1, 1]; "
                "V(y) = (0.4 + 0.1 t[1]) cos y0 - sin(2 y0 - y1)"]),
            (Problem(from_patch([(1, 0), (2, 0)], ["0.4", 1], [["0.1", "0.1"]], [
                ("K", Fraction("0.3"), Fraction("0.5"))])), [
                "no rotational invariant circle for every K in [0.3, 0.5]; V(y) = -K sin y - "])):
        text = " ".join(words(made_up("P").with_tree(0, problem=problem)).split())
        assert all(word in text for word in said), (said, text)
        assert ("the angles after" in text) == (problem.frame != (1, 0, 0, 1))


@pytest.mark.slow
def test_figures_need_no_backend(root, tmp_path):
    """Jupyter names its own to the programs in its terminals, where it may not be installed."""
    pytest.importorskip("matplotlib")
    path = tmp_path / "a.svg"
    done = subprocess.run(
        [sys.executable, "-m", "converse", "-g", path, root / "inputs" / "trig278.in"],
        env={**os.environ, "MPLBACKEND": "module://no_such_backend.backend_inline"},
        capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "") and path.stat().st_size > 10000
