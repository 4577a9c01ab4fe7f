"""What all results have: a report, a picture, a file and, where there is a theorem, verify()."""

from fractions import Fraction

import pytest

import converse
from converse import MuldoonMap, StandardMap, diagram, orbits, tori
from converse.model.exact import Interval

SMALL = StandardMap("0.5")


@pytest.fixture(scope="module")
def results():
    found = diagram.Diagram.of(StandardMap((0, 2)))
    found.add(converse.prove(StandardMap(("1.2", "1.3"))))
    family = orbits.follow(StandardMap(1), 3, 5, [0.5, 0.9])
    torus = tori.find(SMALL, "golden")
    return {"proof": converse.prove(StandardMap("1.2")), "family": family, "orbit": family[1],
            "torus": torus, "proved torus": tori.prove(torus),
            "portrait": converse.portray(StandardMap("1.2"), columns=16, depth=6),
            "diagram": found}


NAMES = ["proof", "family", "orbit", "torus", "proved torus", "portrait", "diagram"]


@pytest.mark.parametrize("name", NAMES)
def test_the_methods_of_a_result(results, name, tmp_path):
    result = results[name]
    assert "\n" not in repr(result) and len(repr(result)) < 200 and repr(result).startswith("<")
    text = result.report()
    assert text.endswith("\n") and len(text) > 60
    path = tmp_path / ("a.npz" if name in ("family", "orbit") else "a")
    result.save(path)
    if name in ("family", "orbit"):     # NumPy reads these
        return
    again = type(result).load(path)
    read = again.report().splitlines()[:2]
    assert (read[0].partition(", of which")[0], read[1]) == tuple(text.splitlines()[:2])
    if name != "torus":
        assert again.verify()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow
def test_pictures(results, name):
    figure = pytest.importorskip("matplotlib.figure")
    result = results[name]
    assert result.plot()._repr_png_().startswith(b"\x89PNG")
    axes = figure.Figure().subplots()
    assert result.plot(axes) is axes and axes.has_data()


def test_intervals_are_values():
    x = Interval(Fraction("1.2345"), Fraction("1.2347"))
    assert repr(x) == "1.2346(1)" and float(x) == 1.2346 and x.mid == Fraction("1.2346")
    assert Fraction("1.2345") in x and 1.2346 in x and 1.2348 not in x and "x" not in x
    low, high = x
    assert (low, high) == (x.lo, x.hi) and x.rad == Fraction(1, 10 ** 4)
    proved = orbits.prove(orbits.straight(StandardMap(1), 1, 3).relax(0.8))
    assert proved.nearest.residue in Interval(*(Fraction(end) + s * Fraction(1, 10 ** 12)
                                                for end, s in zip(proved.residue, (-1, 1))))
    assert float(proved.exponents[0]) == pytest.approx(proved.nearest.exponents[0])


def test_a_segment_is_a_map():
    """Of the thesis's line, in its epsilon: the report names it."""
    proof = converse.prove(MuldoonMap(epsilon=("0.0275", "0.028")))
    assert proof.no_tori and "for every epsilon in [0.0275, 0.028]" in proof.report()
