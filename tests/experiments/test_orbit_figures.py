"""The figures of orbits: drawn from short orbits, they show what they say, where they say it."""

import itertools
import math
import os
import re
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from converse import ConverseError, orbits

from truth import TORTURE

pytest.importorskip("matplotlib")

import thesis as figures  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from thesis import hedlund, shared, states, twist_maps  # noqa: E402

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


def test_the_curves_that_the_text_names(monkeypatch):
    """Three of type (1, 1), up to a sign, in orb-spnf1b; seven of type (0, 1) in orb-sphd2b."""
    monkeypatch.undo()
    for name, words in (("orb-spnf1", "3 curves of type (1, -1)"),
                        ("orb-sphd2", "7 curves of type (0, 1)")):
        potential, vector, sizes, _ = states.ORBITS[name]
        assert len(sizes) == 2 and name in states.TEXT
        assert states.shape(orbits.follow(potential, *vector, sizes[1:])[0]).startswith(words)


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


@pytest.mark.skipif(TORTURE <= 1, reason="takes a minute")
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
