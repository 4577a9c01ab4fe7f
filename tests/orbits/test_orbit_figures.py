"""The figures of orbits: drawn from short orbits, they show what they say, where they say it."""

import itertools
import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from converse import ConverseError, orbits
from converse.orbits import farey
from converse.orbits.solver import newton

from truth import TORTURE

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure  # noqa: E402
from matplotlib.text import Text  # noqa: E402

from converse.orbits import figures  # noqa: E402

REAL = figures.ORBITS
SPIRAL, TENTH = ((28, 37), 49), ((11, 68), 110)
START = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}


@pytest.fixture(scope="module")
def families():
    """Found once for all tests."""
    return figures.Families()


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Stand-ins for the thesis's long orbits."""
    vectors = {figures.SPIRAL: SPIRAL, figures.TENTH: TENTH}
    monkeypatch.setattr(figures, "ORBITS", {
        name: (potential, vectors[vector], *rest)
        for name, (potential, vector, *rest) in figures.ORBITS.items()})
    for name, value in (("SPIRAL", SPIRAL), ("TENTH", TENTH), ("SEQUENCE", (8, 21, 47, 110)),
                        ("CANTORUS", (1.001635, (34,), 89))):
        monkeypatch.setattr(figures, name, value)


@pytest.fixture
def drawn(families):
    """A function from a figure's name to its panels and to what is said below it."""
    def drawn(name):
        figure = Figure()
        return figure, figures.FIGURES[name][2](figure, families)
    return drawn


def data(axes, number=0):
    return np.array(axes.get_lines()[number].get_data()).T


def title(axes):
    return axes.get_title(loc="left") or axes.get_title()


def test_all_of_them_are_there():
    """Every figure of the thesis's second chapter and of Appendix A, and the standard map's."""
    assert set(figures.FIGURES) == {
        "std-demo", "cyl-def", "twist", "billiards", "cantorus", "pert-maps", "Lyaps", "smooth",
        "hed1", "hed2", "deev", "hed_st", "tree", "trimed", "tri", *("orb-" + name for name in (
            "spnf1", "spnf2", "aunf1", "aunf2", "sphd1", "sphd2", "auhd1", "auhd2", "spff1",
            "spff2"))}
    maps = {"n": "trig", "h": "poly", "f": "ff"}
    for name, (potential, vector, sizes, first_known) in REAL.items():
        ((p0, _), q), kind = vector, name[4:]
        assert maps[kind[2]] == potential.name                  # spnf: spiral mean, not ...
        assert (q, p0) == {"sp": (2513, 1432), "au": (3770, 377)}[kind[:2]]
        assert first_known == (kind in ("spnf1", "spff1")) and (not first_known
                                                               or sizes[0] == 0.0075)
        assert set(sizes) <= set(figures.FINE) and list(sizes) == sorted(sizes)
    assert all(float("%.4f" % eps) == eps for eps in figures.STEPS)     # that is what is written
    assert set(figures.SMOOTH) <= set(figures.STEPS)


@pytest.mark.parametrize("name", sorted(REAL))
def test_projections(name, drawn, families):
    """The angles to the left, the momenta to the right, in the right order, all of them in sight;
    and what is said beside them is true of them."""
    potential, vector, sizes, first_known = figures.ORBITS[name]
    figure, words = drawn(name)
    assert len(figure.axes) == 2 * len(sizes)
    for number, eps in enumerate(sizes):
        left, right = figure.axes[2 * number:2 * number + 2]
        state = families.at(potential, vector, eps)
        assert np.array_equal(data(left), state.x) and np.array_equal(data(right), state.momenta)
        assert left.get_xlim() == left.get_ylim() == (0, 1)
        for panel, label in (left, "$x_%d$"), (right, "$p_%d$"):
            assert [panel.get_xlabel(), panel.get_ylabel()] == [label % 0, label % 1]
            assert panel.get_aspect() == 1
        for axis, limits in enumerate((right.get_xlim(), right.get_ylim())):
            momenta = state.momenta[:, axis]
            assert limits[0] < momenta.min() <= momenta.max() < limits[1]
            assert data(right, 1)[0][axis] == pytest.approx(vector[0][axis] / vector[1])
        head = title(left)
        assert head.startswith("(%s)  ε = %r, (%d, %d)/%d: %s" % (
            "abc"[number], eps, *vector[0], vector[1], state.label))
        for label, value in (("shadow", state.shadow), ("grad size", state.grad_size)):
            number = re.search(label + " (\\S+?)[,\n]", head)[1]
            assert float(number) == pytest.approx(value, rel=0.5)       # it has one digit
        said = re.search("exponents (.*), (.*)\n", head)
        assert [float(x) for x in said.groups()] == pytest.approx(state.exponents, abs=1e-4)
        assert ("arbitrary" in head) == (state.undetermined > 0)
        away = np.hypot(*(state.momenta - state.rotation).T).max()
        assert float(re.search(r"up to (\d\.\d{3})", head)[1]) == pytest.approx(away, abs=1e-3)
    assert figures.NAMES[potential.name] in words and "nothing is proved" in words
    assert ("The first ε is the thesis's" in words) == first_known and "chosen here" in words


def test_the_curves_that_the_text_names(monkeypatch):
    """Three of type (1, 1), up to a sign, in orb-spnf1b; seven of type (0, 1) in orb-sphd2b."""
    monkeypatch.undo()
    for name, words in (("orb-spnf1", "3 curves of type (1, -1)"),
                        ("orb-sphd2", "7 curves of type (0, 1)")):
        potential, vector, sizes, _ = figures.ORBITS[name]
        assert len(sizes) == 2 and name in figures.TEXT
        assert figures.shape(orbits.follow(potential, *vector, sizes[1:])[0]).startswith(words)


def test_points_that_doubles_cannot_tell_apart():
    state = orbits.follow(orbits.trig, *SPIRAL, [0.01])[-1]
    assert figures.coinciding(state) == 0
    assert figures.coinciding(state.repeat(3)) == 3 * state.q
    u = state.u.copy()
    u[5] += (state.x[9] - state.x[5]) + [3e-14, -2e-14]
    u[7] += (state.x[9] - state.x[7]) + [1e-11, 0]
    u[2] += (1 - 1e-15, 0.3) - state.x[2]               # the torus has no edge
    u[3] += (1e-14, 0.3) - state.x[3]
    assert figures.coinciding(state.moved(u)) == 4
    figure = Figure()
    words = figures.pairs_of_projections(figure, [state, state.repeat(2), state.moved(u)])
    assert "98 points of (b) and 4 points of (c)" in words
    assert "not stationary" in title(figure.axes[4])


def test_shapes_in_words():
    potential = orbits.trig
    p, q, eps = (1432, 1897), 2513, 0.025
    state = orbits.follow(potential, p, q, [eps])[-1]
    assert re.fullmatch(r"3 curves of type \(1, -1\) at links up to 0\.\d+", figures.shape(state))
    assert figures.shape(orbits.straight(potential, (500, 701), 5001)) == "curves not looked for"


def test_standard_map(drawn):
    figure, words = drawn("std-demo")
    assert len(figure.axes) == 3
    for panel, k in zip(figure.axes, figures.KICKS):
        points = data(panel).reshape(200, 20, 2).transpose(1, 0, 2)
        for orbit in points:
            x, p = orbit[:-1].T
            after = (p - k / (2 * math.pi) * np.sin(2 * math.pi * x))
            off = np.stack([x + after, after], 1) - orbit[1:]
            assert abs(off - np.rint(off)).max() < 1e-12
        assert panel.get_title() == "$k$ = %g" % k
        assert panel.get_xlim() == panel.get_ylim() == (0, 1)
    assert figures.KICKS[0] < figures.KICKS[1] < 4 / 3 < figures.KICKS[2]
    assert "chosen here" in words


def test_billiards():
    """It turns twice, and at each corner both angles with the wall are the same."""
    t = 2 * np.pi * np.arange(4000) / 4000
    x, y = figures.table(t)
    length, star = figures.longest_star(x, y)
    points = np.stack([x, y], 1)[star]
    steps = np.roll(points, -1, axis=0) - points
    assert length == pytest.approx(np.hypot(*steps.T).sum())
    assert sum((b - a) % 4000 for a, b in zip(star, star[1:] + star[:1])) == 2 * 4000
    units = steps / np.hypot(*steps.T)[:, None]
    walls = np.roll(np.stack([x, y], 1), -1, axis=0) - np.roll(np.stack([x, y], 1), 1, axis=0)
    walls = walls[star] / np.hypot(*walls[star].T)[:, None]
    assert abs(((units - np.roll(units, 1, axis=0)) * walls).sum(1)).max() < 4e-3
    circle = figures.longest_star(np.cos(t), np.sin(t))[0]
    assert circle == pytest.approx(10 * math.sin(2 * math.pi / 5))


def test_cantorus(drawn, families):
    figure, words = drawn("cantorus")
    panel, = figure.axes
    k, p, q = figures.CANTORUS
    state, = families(orbits.standard, (p, q), (k,))
    x, y = data(panel).T
    assert np.array_equal(x, state.x[:, 0]) and len(x) == q
    # By the map's symmetry: y is the mean of both momenta at x, and the same at 1 - x.
    after = np.roll(state.momenta[:, 0], -1)
    assert y == pytest.approx((state.momenta[:, 0] + after) / 2, abs=1e-12)
    order, mirrored = np.argsort(x), np.argsort(1 - x)
    assert y[order] == pytest.approx(y[mirrored], abs=1e-9)
    for number in "1.001635", "34/89", "0.3820", "minimum", "chosen here":
        assert number in words
    gap = np.diff(np.sort(x), append=np.sort(x)[0] + 1).max()
    assert float(re.search(r"widest gap is (\S+),", words)[1]) == pytest.approx(gap, abs=1e-4)
    assert "about x = 0.0000" in words


def test_potentials(drawn):
    """Contours of -V, not of V; dashed where negative, a tenth apart; x_0 to the right."""
    from matplotlib.contour import ContourSet

    figure, _ = drawn("pert-maps")
    for panel, potential in zip(figure.axes, (orbits.trig, orbits.poly, orbits.ff)):
        contours, = (each for each in panel.collections if isinstance(each, ContourSet))
        assert contours.levels == pytest.approx(np.arange(-10, 11) / 10)
        for level, path, style in zip(contours.levels, contours.get_paths(),
                                      contours.get_linestyle()):
            assert (style[1] is not None) == (level < 0)
            if len(path.vertices):
                value = potential.evaluate(path.vertices)[0]
                assert -value == pytest.approx(np.full(len(value), level), abs=2e-3)
        assert data(panel)[0] == pytest.approx(potential.start)
        assert figures.NAMES[potential.name] in panel.get_title()
    assert [re.findall(r"from (\S+) to (\S+)", panel.get_title())[0] for panel in figure.axes] == [
        ("-1", "1"), ("-0.25", "1"), ("-0.551", "1")]


def test_exponents(drawn, families):
    figure, words = drawn("Lyaps")
    order = (orbits.trig, TENTH), (orbits.poly, TENTH), (orbits.trig, SPIRAL), (orbits.ff, SPIRAL)
    for panel, (potential, vector) in zip(figure.axes, order):
        family = families(potential, vector)
        assert figures.NAMES[potential.name] in panel.get_title()
        assert figures.vector_words(*vector) in panel.get_title()
        for k, name in enumerate(("first", "second")):
            line = panel.get_lines()[k]
            assert line.get_label() == name
            assert np.array_equal(data(panel, k), np.stack([family.eps, family.exponents[:, k]], 1))
        said = float(re.search(r"first > 0.003 from ε = (\S+) on", panel.get_title())[1])
        first = family.exponents[:, 0]
        assert (first[family.eps < said] <= 0.003).all() and first[family.eps == said] > 0.003
    assert "Labels of the states: minimum (68)." in words and "chosen here" in words


def test_pairs(drawn, families, monkeypatch):
    monkeypatch.setattr(figures, "PAIRS", 60)
    figure, words = drawn("smooth")
    for panel, eps in zip(figure.axes, figures.SMOOTH):
        state = families.at(orbits.trig, SPIRAL, eps)
        distance, ratio = data(panel).T
        pairs = state.pairs(60)
        assert distance == pytest.approx(pairs.distance)
        assert distance * ratio == pytest.approx(pairs.momentum)
        assert panel.get_xscale() == panel.get_yscale() == "log"
        assert float(re.search(r"L up to (\S+)", title(panel))[1]) == pytest.approx(
            ratio.max(), rel=0.06)
        x, y = data(panel, 1).T                         # a grey line
        assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(-1)
    assert "the 60 pairs" in words and "less 0 that" in words and "chosen here" in words


def test_pairs_that_are_left_out(monkeypatch):
    class Doubled(figures.Families):
        def at(self, *arguments):
            return super().at(*arguments).repeat(2)

    monkeypatch.setattr(figures, "PAIRS", 100)
    figure = Figure()
    words = figures.smooth(figure, Doubled())
    assert "less %d that are nearer" % (6 * 49) in words
    assert all(len(data(panel)) == 51 for panel in figure.axes)


def test_deviations(drawn, families):
    figure, words = drawn("deev")
    largest = 0
    for panel, vector in zip(figure.axes, (SPIRAL, TENTH)):
        for k, potential in enumerate((orbits.trig, orbits.poly, orbits.ff)):
            family = families(potential, vector, figures.FINE)
            solid, dotted = panel.get_lines()[2 * k:2 * k + 2]
            assert solid.get_label() == figures.NAMES[potential.name]
            assert (solid.get_linestyle(), dotted.get_linestyle()) == ("-", ":")
            for line, means in (solid, "from_start"), (dotted, "from_point"):
                assert list(line.get_xdata()) == list(figures.FINE)
                assert line.get_ydata() == pytest.approx(
                    [getattr(state.deviation, means) for state in family])
            largest = max(largest, *solid.get_ydata())
        assert panel.get_title() == figures.vector_words(*vector)
        assert panel.get_lines()[-1].get_ydata()[0] == pytest.approx(math.sqrt(0.5))
    assert "%.3f at most" % largest in words and "chosen here" in words
    dotted = max(max(line.get_ydata()) for panel in figure.axes for line in panel.get_lines()
                 if line.get_linestyle() == ":")
    assert ("that is not so" in words) == (dotted > 0.5 ** 0.5)
    arbitrary = sum(state.undetermined > 0 for potential in (orbits.trig, orbits.poly, orbits.ff)
                    for vector in (SPIRAL, TENTH)
                    for state in families(potential, vector, figures.FINE))
    assert "In %d of 198 states a phase is arbitrary" % arbitrary in words and arbitrary


def test_sequence(drawn, families):
    figure, words = drawn("hed_st")
    mediants = {m.q: m.p for m in itertools.islice(farey.triangle(("1/10", farey.GOLDEN)), 20)}
    for number, q in enumerate(figures.SEQUENCE):
        left, right = figure.axes[2 * number:2 * number + 2]
        state = families.at(orbits.poly, (mediants[q], q), 0.02)
        assert figures.vector_words(mediants[q], q) in title(left) and state.label in title(left)
        assert np.array_equal(data(left), state.x) and np.array_equal(data(right), state.momenta)
    assert len(figure.axes) == 8 and len({panel.get_xlim() for panel in figure.axes[1::2]}) == 1
    assert "ε = 0.02" in words and "chosen here" in words


def test_sequence_of_the_thesis(monkeypatch):
    monkeypatch.undo()
    mediants = {m.q: m.p for m in itertools.islice(farey.triangle(("1/10", farey.GOLDEN)), 37)}
    assert set(figures.SEQUENCE) <= set(mediants) and figures.SEQUENCE[-1] == 3770
    assert figures.TENTH == (mediants[3770], 3770)
    assert figures.SPIRAL in [m[:2] for m in itertools.islice(farey.triangle(farey.SPIRAL), 30)]


def test_tree(drawn):
    figure, _ = drawn("tree")
    panel, = figure.axes
    bold = {text.get_text() for text in panel.texts if text.get_weight() == "bold"}
    assert bold == {"(1, 2)", "(2, 3)", "(3, 5)"}
    dots = [line for line in panel.get_lines() if line.get_marker() == "o"]
    assert [dot.get_ydata()[0] for dot in dots] == [0, -1, -2]
    assert [dot.get_xdata()[0] for dot in dots] == pytest.approx([(math.sqrt(5) - 1) / 2] * 3)
    below = [text.get_text() for text in panel.texts
             if text.get_text().startswith("(") and text.xyann[1] < 0]
    assert below == ["(1, 2)", "(1, 3)", "(2, 3)", "(1, 4)", "(2, 5)", "(3, 5)", "(3, 4)"]


def test_cut_of_a_triangle(drawn):
    """The right one is at C, as halves() has it."""
    figure, _ = drawn("trimed")
    at = {text.get_text()[0]: text.xy[0] for text in figure.axes[0].texts}
    left, right = farey.halves(("A", "B", "C"))
    assert ("C" in right, "A" in left) == (True, True)
    assert at["C"] < at["r"] < at["B"] == at["M"] < at["l"] < at["A"]


def test_triangles(drawn):
    """Each level covers the square once, in both panels, and the spiral mean lies in the same
    triangle of the last."""
    figure, _ = drawn("tri")
    places = []
    for panel in figure.axes:
        *loops, dot = [data(panel, k) for k in range(len(panel.get_lines()))]
        assert len(loops) == 2 * (2 ** figures.LEVELS - 1)
        for level in range(figures.LEVELS):
            cells = loops[2 * (2 ** level - 1):2 * (2 ** (level + 1) - 1)]
            assert sum(abs(area(*cell[:3])) for cell in cells) == pytest.approx(1)
        inside = [number for number, (a, b, c, _) in enumerate(cells)
                  if abs(area(a, b, c)) == pytest.approx(sum(abs(area(*each)) for each in (
                      (dot[0], a, b), (dot[0], b, c), (dot[0], c, a))))]
        assert len(inside) == 1
        places.append(inside[0])
    assert places[0] == places[1]
    assert data(figure.axes[1], -1)[0] == pytest.approx([0.5698403, 0.7548777], abs=1e-7)


def area(a, b, c):
    return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2


@pytest.mark.parametrize("kind", sorted(START))
def test_files(kind, families, tmp_path):
    place, seen, names = tmp_path / "new" / "place", [], ["tree", "orb-spnf2"]
    paths = figures.figures(place, names, kind, seen.append)
    assert paths == seen == [str(place / ("%s.%s" % (name, kind))) for name in names]
    assert sorted(os.listdir(place)) == sorted(os.path.basename(path) for path in paths)
    for name, path in zip(names, paths):
        with open(path, "rb") as file:
            read = file.read()
        assert read.startswith(START[kind])
        if kind == "svg":
            ET.fromstring(read)
            assert read == figures.draw(name) and b"dc:date" not in read


def test_every_caption_is_inside(families):
    """Below the axes nothing is cut off, and nothing is read as mathematics by mistake."""
    for name in figures.FIGURES if TORTURE > 1 else ("cantorus", "hed_st"):
        root = ET.fromstring(figures.draw(name, families=families))
        assert float(root.get("width")[:-2]) > 72 * figures.FIGURES[name][0] * 0.8
        assert float(root.get("height")[:-2]) > 72 * figures.FIGURES[name][1] * 0.8
    strange = orbits.Fourier({(1, 0): (1, 0), (0, 1): (1, 0)}, "$x^{")
    assert figures.states_picture(orbits.follow(strange, (2, 3), 7, [0.001])).startswith(b"<?xml")


def test_states_picture():
    family = orbits.follow(orbits.standard, (3,), 8, [0.5, 0.9])
    for kind, start in START.items():
        assert figures.states_picture(family, kind).startswith(start)
    figure = Figure()
    figures.phase_planes(figure, family)
    for panel, state in zip(figure.axes, family):
        assert np.array_equal(data(panel), np.column_stack([state.x, state.momenta]))
        assert "3/8: minimum" in title(panel) and "ε = %r" % state.eps in title(panel)
    saddle, _ = newton(orbits.straight(orbits.trig, (2, 3), 5, (0.1489578, 0.1489578)), 0.01)
    assert figures.kind(saddle) == "saddle"
    assert figures.exponents_words(saddle) == "exponents %.4f, %.4f" % tuple(saddle.exponents)
    assert figures.states_picture([saddle]).startswith(b"<?xml")
    for number in 0, figures.ROWS + 1:
        with pytest.raises(ValueError, match="choose fewer eps"):
            figures.states_picture([saddle] * number)


def fonts_and_labels(figure):
    """Of a figure that was drawn: the sizes of its words; and whether each column of panels names
    what is to the right, and each row what is upwards."""
    sizes = {text.get_size() for text in figure.findobj(Text)
             if text.get_visible() and text.get_text().strip()}
    panels = [axes for axes in figure.axes if axes.axison and axes.get_xticks().size]
    places = [axes.get_position() for axes in panels]

    def named(label, side):
        return all(any(label(other) and round(getattr(there, side) - getattr(here, side), 3) == 0
                       for other, there in zip(panels, places)) for here in places)

    return sizes, named(lambda axes: axes.get_xlabel(), "x0"), named(
        lambda axes: axes.get_ylabel(), "y0")


@pytest.fixture
def seen(monkeypatch):
    """The figures that are written from here on."""
    seen, encode = [], figures.plot.encode
    monkeypatch.setattr(figures.plot, "encode", lambda figure, kind, **options: (
        seen.append(figure), encode(figure, kind, **options))[1])
    return seen


@pytest.mark.parametrize("name", figures.FIGURES)
def test_readable(name, families, seen):
    """No letters below eight points, and each axis has a name."""
    with_words = figures.draw(name, "png", families)
    sizes, right, upwards = fonts_and_labels(seen[0])
    assert min(sizes) >= 8 and right and upwards
    words = [text.get_text() for text in seen[0].texts if text.get_position()[1] == 0]
    assert words and not re.search(r"\beps\b|theta", "".join(words))
    without = figures.draw(name, "png", families, caption=False)
    assert not seen[1].texts and without != with_words


def test_a_state_draws_itself(monkeypatch, seen):
    for potential, vector in (orbits.trig, SPIRAL), (orbits.standard, ((3,), 8)):
        state = orbits.follow(potential, *vector, [0.01])[0]
        assert state._repr_png_().startswith(START["png"])
        sizes, right, upwards = fonts_and_labels(seen[-1])
        assert min(sizes) >= 8 and right and upwards and not seen[-1].texts
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert state._repr_png_() is None


def test_twist():
    """To the right the more, the larger p is; areas stay."""
    p = np.linspace(-1, 2, 500)
    for x in 0.0, 0.3, 0.77:
        assert (np.diff(figures.twisted(x, p)[0]) > 0).all()
        h = 1e-6
        dx, dp = ((np.array(figures.twisted(x + h * a, p + h * b))
                   - figures.twisted(x - h * a, p - h * b)) / (2 * h) for a, b in ((1, 0), (0, 1)))
        assert dx[0] * dp[1] - dx[1] * dp[0] == pytest.approx(np.ones(len(p)), abs=1e-8)


@pytest.mark.parametrize("block", [(1, 2, 1), (2, 4, 2), (3, 1, 2)])
def test_hedlunds_geodesics(block):
    """They close up, run in tunnels and leap half a unit, three times, whatever the type is."""
    corners = np.array(figures.hedlund_geodesic(*block))
    assert (corners[-1] - corners[0] == block).all()
    legs = np.diff(corners, axis=0)
    assert (np.count_nonzero(legs, axis=1) <= 1).all()
    assert np.abs(legs[1::2]).sum(1) == pytest.approx([0.5] * 3)
    for number, (line, fixed) in enumerate((((1, 2), (0, 0)), ((0, 2), (0, 0.5)),
                                            ((0, 1), (0.5, 0.5)), ((1, 2), (0, 0)))):
        for corner in corners[2 * number:2 * number + 2]:
            assert tuple(corner[list(line)] % 1) == fixed
        assert not legs[2 * number][list(line)].any()
    assert figures.hedlund_length(corners) == pytest.approx(1.5 + (sum(block) - 1.5) / 100)


def test_the_drawings_of_hedlunds_examples(drawn):
    one, two = drawn("hed1")[0].axes
    assert [panel.get_title() for panel in (one, two)] == ["type (1, 2)", "type (2, 4)"]
    for panel, times in ((one, 1), (two, 2)):           # crossings of both sides of the square
        lines = [data(panel, k) for k in range(len(panel.get_lines()))]
        assert all((b - a)[1] == 2 * (b - a)[0] for a, b in lines)
        assert sum(0 <= a[0] < 1 for a, _ in lines) == 2 * times
        assert sum(a[0] < 1 <= b[0] for a, b in lines) == times
    words = drawn("hed2")[1]
    assert "1.565" in words and "3.05" in words


def test_bad_orders(tmp_path, monkeypatch):
    for only, kind in (["nothing"], "svg"), (["tree"], "gif"):
        with pytest.raises(ValueError, match=r"\A[^\n]*(nothing|gif)[^\n]*\Z"):
            figures.figures(tmp_path / "place", only, kind)
    assert not (tmp_path / "place").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(ConverseError, match="file"):
        figures.figures(tmp_path / "file", ["tree"])
    (tmp_path / "tri.svg").mkdir()
    with pytest.raises(ConverseError, match="tri.svg"):
        figures.figures(tmp_path, ["tree", "tri"])
    (tmp_path / "trimed.svg").write_text("<svg>somebody else's</svg>")
    with pytest.raises(ConverseError, match="trimed.svg.: exists and is no figure of this program"):
        figures.figures(tmp_path, ["tree", "trimed"])
    assert not (tmp_path / "tree.svg").exists()         # before anything is drawn
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ConverseError, match="pip install matplotlib"):
        figures.draw("tree")


def test_no_display():
    """Neither pyplot nor a backend with windows is loaded, and the user's settings stay."""
    code = ("import sys, matplotlib; before = dict(matplotlib.rcParams)\n"
            "from converse.orbits import figures; figures.draw('tri', 'png')\n"
            "assert 'matplotlib.pyplot' not in sys.modules and before == dict(matplotlib.rcParams)")
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    environment["MPLBACKEND"] = "tkagg"
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)


@pytest.mark.skipif(TORTURE == 1, reason="takes a minute")
def test_the_thesis(monkeypatch, tmp_path):
    """All the real figures; and what the thesis says about them, in their words."""
    monkeypatch.undo()
    families, said = figures.Families(), {}
    for name, (_, _, fill) in figures.FIGURES.items():
        figure = Figure()
        words = fill(figure, families)
        said[name] = "\n".join([title(panel) for panel in figure.axes] + [words])
    assert "exponents 0.0000, 0.0000" in said["orb-spnf1"]          # at 0.0075
    assert "3 curves of type (1, -1)" in said["orb-spnf1"]
    assert said["orb-sphd1"].count("curves of type (0, 1)") == 2
    assert said["orb-sphd2"].count("7 curves of type (0, 1)") == 2
    assert "1 curve of type (1, -4)" in said["orb-auhd2"]
    assert "curves of type (1, -1)" in said["orb-spff1"]            # already at 0.0075
    near, far = (float(re.search(r"up to (\d\.\d{3})", said[name])[1])
                 for name in ("orb-sphd1", "orb-spnf1"))
    assert near < far / 2                       # poly's momenta stay near; at 0.0025 and 0.0075
    assert "first > 0.003 from ε = 0.01 on" in said["Lyaps"]
    assert float(re.search(r"perturbation, (\S+) at most", said["deev"])[1]) < 1 / math.sqrt(2)
    assert "not so: polynomial, (1432, 1897)/2513, ε = 0.04: 0.82." in said["deev"]
    figures.figures(tmp_path)
    assert len(os.listdir(tmp_path)) == len(figures.FIGURES)
