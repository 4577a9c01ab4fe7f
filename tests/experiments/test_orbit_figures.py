"""The figures of orbits: drawn from short orbits, they show what they say, where they say it."""

import math
import os
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from converse import orbits

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


@pytest.mark.skipif(TORTURE <= 1, reason="takes a minute")
def test_the_thesis(monkeypatch, tmp_path):
    """All the real figures; and what the thesis says about them, in their words."""
    monkeypatch.undo()
    families, said = shared.Families(), {}
    for name, (_, _, fill) in figures.FIGURES.items():
        figure = Figure()
        words = fill(figure, families)
        said[name] = "\n".join([title(panel) for panel in figure.axes] + [words])
    for name, words in (("orb-spnf1", "3 curves of type (1, -1)"), (
            "orb-sphd2", "7 curves of type (0, 1)"), ("orb-auhd2", "1 curve of type (1, -4)")):
        assert words in said[name]
    near, far = (float(re.search(r"up to (\d\.\d{3})", said[name])[1])
                 for name in ("orb-sphd1", "orb-spnf1"))
    assert near < far / 2                       # poly's momenta stay near; at 0.0025 and 0.0075
    figures.figures(tmp_path)
    assert len(os.listdir(tmp_path)) == len(figures.FIGURES)
