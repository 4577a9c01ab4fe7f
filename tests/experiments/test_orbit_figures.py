"""The figures of orbits: drawn from short orbits, they show what they say, where they say it."""

import dataclasses
import itertools
import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import farey
import numpy as np
import pytest

from converse import ConverseError, orbits

from truth import TORTURE

pytest.importorskip("matplotlib")

import thesis as figures  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from pairs import pairs as closest  # noqa: E402
from sums import fourier
from thesis import appendix, hedlund, shared, states, twist_maps  # noqa: E402

from converse.orbits import pictures  # noqa: E402
from converse.orbits.state import vector_words  # noqa: E402
from converse.tori.nearest import LOWER, halves  # noqa: E402

REAL = states.ORBITS
SPIRAL, TENTH = ((28, 37), 49), ((11, 68), 110)
START = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}


@pytest.fixture(scope="module")
def families():
    """Found once for all tests."""
    return shared.Families()


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Stand-ins for the thesis's long orbits."""
    vectors = {shared.SPIRAL: SPIRAL, shared.TENTH: TENTH}
    monkeypatch.setattr(states, "ORBITS", {
        name: (potential, vectors[vector], *rest)
        for name, (potential, vector, *rest) in states.ORBITS.items()})
    for module, name, value in ((shared, "SPIRAL", SPIRAL), (shared, "TENTH", TENTH),
                                (hedlund, "SEQUENCE", (8, 21, 47, 110)),
                                (twist_maps, "CANTORUS", (1.001635, (34,), 89))):
        monkeypatch.setattr(module, name, value)


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
        assert set(sizes) <= {k / 800 for k in range(33)} and list(sizes) == sorted(sizes)
    assert all(float("%.4f" % eps) == eps for eps in shared.STEPS)     # that is what is written
    assert set(states.SMOOTH) <= set(shared.STEPS)


@pytest.mark.parametrize("name", sorted(REAL))
def test_projections(name, drawn, families):
    """The angles to the left, the momenta to the right, in the right order, all of them in sight;
    and what is said beside them is true of them."""
    potential, vector, sizes, first_known = states.ORBITS[name]
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
        for label, value in (("at most", state.shadow), ("square", state.grad_size)):
            number = re.search(label + " (\\S+?)[,\n]", head)[1]
            assert float(number) == pytest.approx(value, rel=0.5)       # it has one digit
        said = re.search("exponents (.*), (.*);", head)
        assert [float(x) for x in said.groups()] == pytest.approx(state.exponents, abs=1e-4)
        assert ("arbitrary" in head) == (state.undetermined > 0)
        away = np.hypot(*(state.momenta - state.rotation).T).max()
        assert float(re.search(r"up to (\d\.\d{3})", head)[1]) == pytest.approx(away, abs=1e-3)
    assert shared.NAMES[potential.name] in words and "nothing is proved" in words
    assert ("The first ε is the thesis's" in words) == first_known and "chosen here" in words


def test_the_curves_that_the_text_names(monkeypatch):
    """Three of type (1, 1), up to a sign, in orb-spnf1b; seven of type (0, 1) in orb-sphd2b."""
    monkeypatch.undo()
    for name, words in (("orb-spnf1", "3 curves of type (1, -1)"),
                        ("orb-sphd2", "7 curves of type (0, 1)")):
        potential, vector, sizes, _ = states.ORBITS[name]
        assert len(sizes) == 2 and name in states.TEXT
        assert states.shape(orbits.follow(potential, *vector, sizes[1:])[0]).startswith(words)


def test_shapes_in_words(monkeypatch):
    potential = orbits.trig
    p, q, eps = (1432, 1897), 2513, 0.025
    state = orbits.follow(potential, p, q, [eps])[-1]
    assert re.fullmatch(r"3 curves of type \(1, -1\) at links up to 0\.\d+", states.shape(state))
    monkeypatch.setattr(states, "filaments", lambda x: None)
    assert states.shape(state) == "no curves to be told apart"


def test_standard_map(drawn):
    figure, words = drawn("std-demo")
    assert len(figure.axes) == 3
    for panel, k in zip(figure.axes, twist_maps.KICKS):
        assert len(panel.get_lines()) == 20
        for orbit in (data(panel, number) for number in range(20)):
            assert len(orbit) == 201
            x, p = orbit[:-1].T
            after = (p - k / (2 * math.pi) * np.sin(2 * math.pi * x))
            off = np.stack([x + after, after], 1) - orbit[1:]
            assert abs(off - np.rint(off)).max() < 1e-12
        assert panel.get_title() == "$k$ = %g" % k
        assert panel.get_xlim() == panel.get_ylim() == (0, 1)
    assert twist_maps.KICKS[0] < twist_maps.KICKS[1] < 4 / 3 < twist_maps.KICKS[2]
    assert "chosen here" in words


def test_billiards():
    """It turns twice, and at each corner both angles with the wall are the same."""
    t = 2 * np.pi * np.arange(4000) / 4000
    x, y = twist_maps.table(t)
    length, star = twist_maps.longest_star(x, y)
    points = np.stack([x, y], 1)[star]
    steps = np.roll(points, -1, axis=0) - points
    assert length == pytest.approx(np.hypot(*steps.T).sum())
    assert sum((b - a) % 4000 for a, b in zip(star, star[1:] + star[:1])) == 2 * 4000
    units = steps / np.hypot(*steps.T)[:, None]
    walls = np.roll(np.stack([x, y], 1), -1, axis=0) - np.roll(np.stack([x, y], 1), 1, axis=0)
    walls = walls[star] / np.hypot(*walls[star].T)[:, None]
    assert abs(((units - np.roll(units, 1, axis=0)) * walls).sum(1)).max() < 4e-3
    circle = twist_maps.longest_star(np.cos(t), np.sin(t))[0]
    assert circle == pytest.approx(10 * math.sin(2 * math.pi / 5))


def test_cantorus(drawn, families):
    figure, words = drawn("cantorus")
    panel, = figure.axes
    k, p, q = twist_maps.CANTORUS
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
        assert shared.NAMES[potential.name] in panel.get_title()
    assert [re.findall(r"from (\S+) to (\S+)", panel.get_title())[0] for panel in figure.axes] == [
        ("-1", "1"), ("-0.25", "1"), ("-0.551", "1")]


def test_exponents(drawn, families):
    """All of them to the left; to the right, on a logarithmic scale, how they leave 0."""
    figure, words = drawn("Lyaps")
    order = (orbits.trig, TENTH), (orbits.poly, TENTH), (orbits.trig, SPIRAL), (orbits.ff, SPIRAL)
    count = 0
    for left, right, (potential, vector) in zip(figure.axes[::2], figure.axes[1::2], order):
        family = families.resolved(potential, vector)
        count += len(family)
        assert left.get_title() == "%s, %s" % (shared.NAMES[potential.name],
                                               vector_words(*vector))
        assert right.get_yscale() == "log" and right.get_xlim()[1] < left.get_xlim()[1]
        said = re.fullmatch(r"above 1/q from ε = (\S+) and (\S+) on", right.get_title())
        for k, name in enumerate(("first", "second")):
            exponents = family.exponents[:, k]
            assert left.get_lines()[k].get_label() == name
            assert np.array_equal(data(left, k), np.stack([family.eps, exponents], 1))
            seen = data(right, k)[:, 1]
            assert np.array_equal(seen[exponents > 1e-5], exponents[exponents > 1e-5])
            assert np.isnan(seen[exponents <= 1e-5]).all()
            above = int(np.argmax(exponents > 1 / vector[1]))
            assert above and float(said[k + 1]) == pytest.approx(family.eps[above], abs=5e-6)
            assert family.eps[above] - family.eps[above - 1] <= shared.SHORTEST
        assert right.get_lines()[2].get_ydata()[0] == 1 / vector[1]
    assert "Labels of the states: minimum (%d)." % count in words and "chosen here" in words
    assert states.leaves(families(orbits.trig, SPIRAL, (0.001, 0.002)), 0) == "beyond"


def test_steps_that_adapt_themselves(families):
    """They are short where much changes, and only there."""
    for potential in orbits.trig, orbits.ff:
        family = families.resolved(potential, SPIRAL)
        steps = np.diff(family.eps)
        assert family.eps[0] == 0 and family.eps[-1] == shared.TOP == 0.04
        assert shared.SHORTEST / 2 < steps[:-1].min()           # the last one ends at TOP
        assert steps.max() == pytest.approx(shared.LONGEST)
        assert (steps > shared.LONGEST * 0.999).sum() >= 5
        large = [abs(after.exponents - before.exponents).max() > shared.CHANGE
                 for before, after in zip(family, list(family)[1:])]
        assert (steps[large] <= shared.SHORTEST).all()
    assert families.resolved(orbits.ff, SPIRAL) is family


def test_pairs(drawn, families, monkeypatch):
    monkeypatch.setattr(states, "PAIRS", 60)
    figure, words = drawn("smooth")
    for panel, eps in zip(figure.axes, states.SMOOTH):
        state = families.at(orbits.trig, SPIRAL, eps)
        distance, ratio = data(panel).T
        pairs = closest(state, 60)
        assert distance == pytest.approx(pairs.distance)
        assert distance * ratio == pytest.approx(pairs.momentum)
        assert panel.get_xscale() == panel.get_yscale() == "log"
        assert float(re.search(r"L up to (\S+)", title(panel))[1]) == pytest.approx(
            ratio.max(), rel=0.06)
        x, y = data(panel, 1).T                         # a grey line
        assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(-1)
    assert "the 60 pairs" in words and "less 0 that" in words and "chosen here" in words


def test_pairs_that_are_left_out(monkeypatch):
    class Doubled(shared.Families):
        def at(self, *arguments):
            return super().at(*arguments).repeat(2)

    monkeypatch.setattr(states, "PAIRS", 100)
    figure = Figure()
    words = states.smooth(figure, Doubled())
    assert "less %d that are nearer" % (6 * 49) in words
    assert all(len(data(panel)) == 51 for panel in figure.axes)


def test_deviations(drawn, families):
    figure, words = drawn("deev")
    found, leaps = [], []
    for panel, vector in zip(figure.axes, (SPIRAL, TENTH)):
        for k, potential in enumerate((orbits.trig, orbits.poly, orbits.ff)):
            family = families.resolved(potential, vector)
            found += family
            solid, dotted = panel.get_lines()[2 * k:2 * k + 2]
            assert solid.get_label() == shared.NAMES[potential.name]
            assert (solid.get_linestyle(), dotted.get_linestyle()) == ("-", ":")
            for line, means in (solid, "from_start"), (dotted, "from_point"):
                assert np.array_equal(line.get_xdata(), family.eps)
                assert line.get_ydata() == pytest.approx(
                    [getattr(state.deviation, means) for state in family])
        leaps += hedlund.jumps(family)                  # of ff, the last
        assert panel.get_title() == vector_words(*vector)
        assert panel.get_lines()[-1].get_ydata()[0] == pytest.approx(math.sqrt(0.5))
    for number in (max(state.deviation.from_start for state in found),
                   max(state.deviation.from_point for state in found),
                   max(hedlund.across(state) for state in found)):
        assert "%.3f at most" % number in words
    assert all("%.3f at ε = %.5f" % (by, eps) in words for eps, by in leaps)
    arbitrary = sum(state.undetermined > 0 for state in found)
    assert "In %d of %d states a phase is arbitrary" % (arbitrary, len(found)) in words


def test_distance_from_the_line():
    """Along the line points may move as they like; across, by a whole line, not only the circle."""
    state = orbits.straight(orbits.trig, (3, 4), 5)
    u = np.zeros((5, 2))
    u[1:] = np.outer([1, -2, 0.5, 3], [0.03, 0.04])
    assert hedlund.across(state.moved(u)) == pytest.approx(0, abs=1e-15)
    u[2] += [0.08, -0.06]
    u[3] -= [0.04, -0.03]
    assert hedlund.across(state.moved(u)) == pytest.approx(0.1)
    assert hedlund.across(state.moved(u + [0.3, 0.1])) == pytest.approx(0.1)


def test_jumps():
    """Those that the shortest steps leave, not what changes while a step is long."""
    state = orbits.straight(orbits.trig, (3, 4), 5)
    family = orbits.Family(tuple(
        dataclasses.replace(state, eps=eps, u=np.full((5, 2), size))
        for eps, size in ((0, 0), (0.001, 0.5), (0.00101, 0.51), (0.00102, 0.61), (0.002, 0.7))))
    (eps, by), = hedlund.jumps(family)
    assert eps == 0.00102 and by == pytest.approx(0.1 * math.sqrt(2))


def test_sequence(drawn, families):
    figure, words = drawn("hed_st")
    mediants = {m.q: m.p for m in itertools.islice(farey.triangle(("1/10", shared.GOLDEN)), 20)}
    for number, q in enumerate(hedlund.SEQUENCE):
        left, right = figure.axes[2 * number:2 * number + 2]
        state = families.at(orbits.poly, (mediants[q], q), 0.02)
        assert vector_words(mediants[q], q) in title(left) and state.label in title(left)
        assert np.array_equal(data(left), state.x) and np.array_equal(data(right), state.momenta)
    assert len(figure.axes) == 8 and len({panel.get_xlim() for panel in figure.axes[1::2]}) == 1
    assert "ε = 0.02" in words and "chosen here" in words


def test_sequence_of_the_thesis(monkeypatch):
    monkeypatch.undo()
    mediants = {m.q: m.p for m in itertools.islice(farey.triangle(("1/10", shared.GOLDEN)), 37)}
    assert set(hedlund.SEQUENCE) <= set(mediants) and hedlund.SEQUENCE[-1] == 3770
    assert shared.TENTH == (mediants[3770], 3770)
    assert shared.SPIRAL in [m[:2] for m in itertools.islice(
        farey.triangle(shared.SPIRAL_MEAN), 30)]


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
    left, right = halves(LOWER)
    assert (LOWER[2] in right, LOWER[0] in left) == (True, True)
    assert at["C"] < at["r"] < at["B"] == at["M"] < at["l"] < at["A"]


def test_triangles(drawn):
    """Each level covers the square once, in both panels, and the spiral mean lies in the same
    triangle of the last."""
    figure, _ = drawn("tri")
    places = []
    for panel in figure.axes:
        *loops, dot = [data(panel, k) for k in range(len(panel.get_lines()))]
        assert len(loops) == 2 * (2 ** appendix.LEVELS - 1)
        for level in range(appendix.LEVELS):
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
    strange = fourier({(1, 0): (1, 0), (0, 1): (1, 0)}, "$x^{")
    assert pictures.states_picture(orbits.follow(strange, (2, 3), 7, [0.001])).startswith(b"<?xml")


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
    seen, encode = [], pictures.plot.encode
    monkeypatch.setattr(pictures.plot, "encode", lambda figure, kind, **options: (
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


def test_twist(drawn):
    """To the right the more, the larger p is; areas stay."""
    _, after = drawn("twist")[0].axes
    for k in range(6):
        assert (np.diff(data(after, k)[:, 0]) > 0).all()
    p = np.linspace(-1, 2, 500)
    for x in 0.0, 0.3, 0.77:
        assert (np.diff(twist_maps.twisted(x, p)[0]) > 0).all()
        h = 1e-6
        dx, dp = ((np.array(twist_maps.twisted(x + h * a, p + h * b))
                   - twist_maps.twisted(x - h * a, p - h * b)) / (2 * h)
                  for a, b in ((1, 0), (0, 1)))
        assert dx[0] * dp[1] - dx[1] * dp[0] == pytest.approx(np.ones(len(p)), abs=1e-8)


GEODESICS = {(1, 2, 1): 0.03 + math.sqrt(1 - 2e-4),
             (2, 4, 2): 0.08 + 1.5 * (math.sqrt(1 - 2e-4) - 0.01)}


@pytest.mark.parametrize("block", GEODESICS)
def test_hedlunds_geodesics(block):
    """They close up, run in tunnels and leap between them, and have the length of the bound."""
    corners = np.array(hedlund.hedlund_geodesic(*block))
    assert corners[-1] - corners[0] == pytest.approx(block)
    legs = np.diff(corners, axis=0)
    tunnels = {0: ((1, 2), (0, 0)), 1: ((0, 2), (0, 0.5)), 2: ((0, 1), (0.5, 0.5))}
    for number, leg in enumerate(legs[::2]):
        along, = np.nonzero(leg)[0]
        line, fixed = tunnels[int(along)]
        for corner in corners[2 * number:2 * number + 2]:
            assert tuple(corner[list(line)] % 1) == fixed
    if len(legs) % 2 == 0:                      # the last leap ends where the first tunnel begins
        assert tuple(corners[-1][1:] % 1) == tuple(corners[0][1:] % 1) == (0, 0)
    assert hedlund.hedlund_length(corners) == pytest.approx(GEODESICS[block], abs=1e-12)
    with pytest.raises(ValueError, match="known"):
        hedlund.hedlund_geodesic(3, 1, 2)


@pytest.mark.parametrize("block", GEODESICS)
def test_no_curve_is_shorter(block):
    """Of those with corners on a grid of halves, which are no shorter than the shortest of all, and
    longer by what a slant saves in each leap."""
    box = [np.arange(-1, 2 * size + 2) / 2 for size in block]
    points = np.stack(np.meshgrid(*box, indexing="ij"), -1).reshape(-1, 3)
    step = points[:, None] - points
    cost = np.sqrt((step ** 2).sum(2))
    families = ((1, 2), (0, 0)), ((0, 2), (0, 0.5)), ((0, 1), (0.5, 0.5))
    for line, fixed in families:
        within = (points[:, list(line)] % 1 == fixed).all(1)
        same = within[:, None] & within & (step[:, :, list(line)] == 0).all(2)
        cost[same] *= hedlund.TUNNEL
    shortest = np.inf
    for start in itertools.product((0, 0.5), repeat=3):
        far = np.where((points == start).all(1), 0.0, np.inf)
        for _ in range(12):                             # Bellman and Ford
            far = np.minimum(far, (far[:, None] + cost).min(0))
        shortest = min(shortest, far[(points == np.add(start, block)).all(1)][0])
    leaps = {(1, 2, 1): 2, (2, 4, 2): 3}[block]
    assert GEODESICS[block] < shortest <= GEODESICS[block] + 1e-4 * leaps * 0.51
    assert shortest == pytest.approx({2: 1.03, 3: 1.565}[leaps])


def test_the_drawings_of_hedlunds_examples(drawn):
    one, two = drawn("hed1")[0].axes
    assert [panel.get_title() for panel in (one, two)] == [
        "type (1, 2): length 2.236", "type (2, 4): length 4.472"]
    for panel, times in ((one, 1), (two, 2)):           # end to end, through one point
        lines = [data(panel, k) for k in range(len(panel.get_lines()))]
        copies = [line for line in lines if len(line) == 2 and (line[1] - line[0] != 0).all()]
        assert [line.tolist() for line in copies[:times]] == [
            [[k, 2 * k], [k + 1, 2 * k + 2]] for k in range(times)]
        assert (lines[-1] % 1 == 0).all() and len(lines[-1]) == times + 1
    figure, words = drawn("hed2")
    assert [panel.get_title() for panel in figure.axes] == [
        "type (1, 2, 1): length 1.0299", "type (2, 4, 2): length 1.5648"]
    assert "1.5648" in words and "2.0598" in words


def test_the_cylinder(drawn):
    """Its orbits are those of the map, on rotational circles: they stay within it."""
    figure, words = drawn("cyl-def")
    behind, front = (data(figure.axes[0], k) for k in (5, 6))
    assert len(behind) + len(front) == 401 * len(twist_maps.ON_CYLINDER)
    xs, ps = orbits.standard.orbit(np.zeros(2), twist_maps.ON_CYLINDER, 400, twist_maps.KICKS[0])
    assert 0 < ps.min() < ps.max() < 1
    drawn_at = np.concatenate([behind, front])
    for x, p in zip(xs[::37].ravel(), ps[::37].ravel()):
        assert abs(drawn_at - twist_maps.cylinder(x, p)).sum(1).min() < 1e-12
    assert (abs(front[:, 0]) <= 1).all() and "k = 0.5" in words


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
    with pytest.raises(ConverseError, match="trimed.svg.: exists and is not a figure"):
        figures.figures(tmp_path, ["tree", "trimed"])
    assert not (tmp_path / "tree.svg").exists()         # before anything is drawn
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ConverseError, match=r"converse-kam\[plot\]"):
        figures.draw("tree")


def test_no_display():
    """Neither pyplot nor a backend with windows is loaded, and the user's settings stay."""
    code = ("import sys, matplotlib; before = dict(matplotlib.rcParams)\n"
            "import thesis; thesis.draw('tri', 'png')\n"
            "assert 'matplotlib.pyplot' not in sys.modules and before == dict(matplotlib.rcParams)")
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    environment.update(MPLBACKEND="tkagg", PYTHONPATH=os.pathsep.join(sys.path))
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)


@pytest.mark.skipif(TORTURE == 1, reason="takes a minute")
def test_the_thesis(monkeypatch, tmp_path):
    """All the real figures; and what the thesis says about them, in their words."""
    monkeypatch.undo()
    families, said = shared.Families(), {}
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
    (before, after), = re.findall(r"\(a\) form (\d+) clumps, those of \(b\) (\d+)",
                                  said["orb-sphd2"])
    assert int(after) < int(before) / 2
    assert "at most 0.24 in (a)" in said["orb-spnf1"]
    near, far = (float(re.search(r"up to (\d\.\d{3})", said[name])[1])
                 for name in ("orb-sphd1", "orb-spnf1"))
    assert near < far / 2                       # poly's momenta stay near; at 0.0025 and 0.0075
    assert "from ε = 0.00625 and 0.00783 on" in said["Lyaps"]
    assert "from ε = 0.00778 and 0.00923 on" in said["Lyaps"]
    assert "by 0.046 at ε = 0.01065 and 0.089 at ε = 0.01077" in said["deev"]
    assert "At right angles to that line it is 0.653 at most." in said["deev"]
    figures.figures(tmp_path)
    assert len(os.listdir(tmp_path)) == len(figures.FIGURES)
