"""SymplecticMap: what is equal, what is refused, and what it does to points."""

from fractions import Fraction

import numpy as np
import pytest

import converse
from converse import FourierMap, FroeschleMap, MuldoonMap, Problem, StandardMap, SymplecticMap
from converse.model.map import LINE, THESIS


def test_one_family_is_one_value():
    """However it is written; a parameter without width is none."""
    thesis = MuldoonMap(("0.3", "0.4"), "0.2", ("0.5", "0.7"))
    assert thesis == FourierMap({(1, 0): ("0.3", "0.4"), (0, 1): "0.2", (1, 1): ("0.5", "0.7")})
    assert hash(thesis) == hash(SymplecticMap(THESIS, ["0.35", "0.2", "0.6"],
                                              [["0.05", 0, 0], [0, 0, "0.1"]]))
    assert thesis != MuldoonMap(("0.3", "0.4"), "0.2", ("0.5", "0.7"), together=True)
    assert StandardMap("0.9") == FourierMap({(1, 0, "-1/2"): "0.9"}) == FourierMap(
        {(1, 0, "3/2"): {"k": 1}}, k=Fraction(9, 10)) != StandardMap("0.90000000001")
    assert MuldoonMap(epsilon="0.01") == MuldoonMap(LINE / 100, LINE / 100, LINE / 50)
    assert StandardMap("0.9") != "0.9"


def test_files_are_maps(root):
    path = root / "inputs" / "froeschle-0.3.json"
    family = SymplecticMap.read(path)
    assert family == FroeschleMap(("0.6", "0.602"), "0.3") and family.names == ("K",)
    assert family.at(K="0.7") == FroeschleMap("0.7", "0.3")
    with pytest.raises(ValueError, match="no parameter B: the parameters are K"):
        family.at(B=1)
    with pytest.raises(ValueError, match=r"K goes from 0.6 to 0.602; choose .*--at K=0.601"):
        family.potential()


@pytest.mark.parametrize("make, words", [
    (lambda: StandardMap(0.9), "0.9 is not an exact number"),
    (lambda: MuldoonMap(epsilon=0.01), "0.01 is not an exact number"),
    (lambda: MuldoonMap(1, 1, 1, epsilon=1), "or epsilon"),
    (lambda: FourierMap({1: {"K": 1}}), "no parameter 'K'"),
    (lambda: SymplecticMap([(1, 0)], [1], [[1]], [1], ["a", "b"]), "1 parameters"),
    (lambda: SymplecticMap([(1, 0), (2, 0)], [1, 1], [[1, 0], [0, 1]], names=["a", "a"]),
     "1 different names")])
def test_mistakes(make, words):
    with pytest.raises((TypeError, ValueError)) as caught:
        make()
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_it_is_the_map_of_the_potential():
    """In one angle and two: images, inverses, the Jacobian, and the units of 2 pi."""
    rng = np.random.default_rng(3)
    standard, y, J = StandardMap("0.9"), *rng.uniform(-3, 3, (2, 7))
    assert standard.map(y, J)[1] == pytest.approx(J + 0.9 * np.sin(y))
    two = FroeschleMap("0.6", "0.3")
    y, J = rng.uniform(-3, 3, (2, 5, 2))
    there, after = two.map(y, J)
    assert after == pytest.approx(J + 0.6 * np.sin(y) + 0.3 * np.sin(y.sum(1))[:, None])
    assert there == pytest.approx(y + after)
    assert np.stack(two.inverse(there, after)) == pytest.approx(np.stack([y, J]))
    step, jacobian = 1e-6, two.jacobian(y)
    for i in range(4):
        d = step * np.eye(4)[i]
        ends = [np.concatenate(two.map(y + s * d[:2], J + s * d[2:]), 1) for s in (1, -1)]
        assert jacobian[:, :, i] == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-8)
    ys, Js = two.orbit(y, J, 3)
    assert (ys[0] == y).all() and np.stack(two.orbit(ys[3], Js[3], -3))[:, 3] == pytest.approx(
        np.stack([y, J]))


# ---- what one types first

def test_all_rooms_are_there():
    assert converse.orbits.follow and converse.tori.find and converse.check.verify
    assert converse.parameters.explore and set(converse.__all__) <= set(dir(converse))
    with pytest.raises(AttributeError, match="has no attribute 'rooms'"):
        converse.rooms


def test_what_is_typed_first():
    m = StandardMap("0.9")
    family = converse.orbits.follow(m, 89, 233)
    assert family[0].label == "minimum" and family[0].eps == 1
    assert converse.orbits.follow(StandardMap(1), 89, 233, 0.9)[0].exponents == pytest.approx(
        family[0].exponents, rel=1e-2)
    assert converse.orbits.follow(StandardMap(1), 89, 233, "0.9")[0].eps == 0.9
    torus = converse.tori.find(m, "golden")
    assert torus.x(0.1).shape == () and torus.x([0.1, 0.2]).shape == (2,)
    assert torus.x(np.array([[0.1]])) == pytest.approx(torus.x(0.1))
    proof = converse.tori.prove(torus)
    assert len(repr(proof)) < 100 and proof.distance < 1e-6
    assert converse.prove(StandardMap("0.99")).no_tori
    with pytest.raises(TypeError, match="the map is a SymplecticMap, .* not orbits.standard"):
        converse.tori.find(converse.orbits.standard, "golden")
    with pytest.raises(TypeError, match="is a Rotation, or a text"):
        converse.tori.find(m, 0.618)


def test_problems_hold_maps():
    problem = Problem(StandardMap("4/3"))
    low, high = (p for p in (problem.amplitude[0] - problem.parts[0][0],
                             problem.amplitude[0] + problem.parts[0][0]))
    assert low < Fraction(4, 3) < high and high - low < Fraction(1, 10 ** 39)
    assert problem.map.potential().amplitude == (Fraction(4, 3),)
    assert Problem.of(problem) is problem and Problem.of(problem.map) == problem
