"""SymplecticMap: what is equal, what is refused, and what it does to points."""

import warnings
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
    assert thesis != MuldoonMap(("0.3", "0.4"), "0.2", ("0.5", "0.7")).tied()
    assert StandardMap("0.9") == FourierMap({(1, "-1/2"): "0.9"}) == FourierMap(
        {(1, "3/2"): {"k": 1}}, k=Fraction(9, 10)) != StandardMap("0.90000000001")
    assert MuldoonMap(epsilon="0.01") == MuldoonMap(LINE / 100, LINE / 100, LINE / 50)
    assert StandardMap("0.9") != "0.9"
    both = {(1, 0): {"s": 1}, (2, 1): {"t": 1, "constant": "0.1"}}
    ranges = {"s": (0, 1), "t": (1, 2)}
    family = FourierMap(both, **ranges)
    others = [FourierMap(dict(reversed(both.items())), **ranges),
              FourierMap(both, **dict(reversed(ranges.items()))),
              FourierMap({(1, 0): {"s": -1}, (2, 1): {"t": 1, "constant": "0.1"}}, s=(-1, 0),
                         t=(1, 2))]
    assert all(other == family and hash(other) == hash(family) for other in others)
    one = SymplecticMap([(1, 0)], [1], [["0.1"]])
    assert one != SymplecticMap([(1, 0)], [1], [["0.1"], ["0.1"]])


def test_a_word_is_the_sign_and_the_function_of_the_term_of_V(tmp_path):
    """In Python, in JSON and in reports: V itself, and the force."""
    y = np.linspace(0, 6, 7)
    for word, value, force in (("+cos", np.cos, np.sin), ("-cos", lambda y: -np.cos(y),
                                                          lambda y: -np.sin(y)),
                               ("+sin", np.sin, lambda y: -np.cos(y)),
                               ("-sin", lambda y: -np.sin(y), np.cos)):
        made = FourierMap({(3, word): "0.1"})
        path = tmp_path / "a.json"
        path.write_text('{"harmonics": [{"k": [3], "amplitude": 0.1, "phase": "%s"}]}' % word)
        assert made == SymplecticMap.read(path) == SymplecticMap([(3, 0, word)], ["0.1"])
        assert made.map(y, 0.0)[1] == pytest.approx(0.3 * force(3 * y))
        low, high = converse.orbits.potential.known(made).evaluate(
            np.array([[0.0], [0.1]]) / 3)[0] * 4 * np.pi ** 2
        assert high - low == pytest.approx(0.1 * (value(0.2 * np.pi) - value(0.0)))
        assert "V(y) = %s0.1 %s(3 y)" % (word[0].strip("+"), word[1:]) in repr(made)
    assert FourierMap({1: "0.1"}) == FourierMap({(1, "-sin"): "0.1"})


@pytest.mark.parametrize("word", ["sin", "cos"])
def test_a_word_without_a_sign_is_refused(word):
    with pytest.raises(ValueError, match=r"the phase of harmonic 1: '%s' has no sign; .* give "
                                         r"'\+%s', and .* '-%s', as" % ((word,) * 3)):
        FourierMap({(1, word): 1})


def test_keys_of_a_fourier_map():
    """k or (k, phase); a third integer is no phase but a third k, and integers are those of any
    library."""
    one = FourierMap({np.int64(1): 1, (np.int32(3), "-1/2"): "0.1"})
    assert one == FourierMap({1: np.int64(1), (3, Fraction(-1, 2)): "0.1"}) and one.dimension == 1
    assert one.harmonics == ((1, 0, 0), (3, 0, Fraction(-1, 2)))
    assert {type(k) for wave in one.harmonics for k in wave[:2]} == {int}
    two = FourierMap({(1, 3): 1, ((0, 1), "1/3"): 1})
    assert two.harmonics == ((1, 3, 0), (0, 1, Fraction(1, 3)))
    three = FourierMap({(1, 0, 1): 1, ((0, np.int64(1), 0), "1/3"): 1, (0, 1, 0, "+cos"): 2})
    assert three.dimension == 3 and three.harmonics == (
        (1, 0, 1, 0), (0, 1, 0, Fraction(1, 3)), (0, 1, 0, Fraction(-1, 2)))
    assert FourierMap({(1, 0, 0): 1, ((1, 1, 0), "1/3"): 1}) == \
        FourierMap({(1, 0): 1, ((1, 1), "1/3"): 1})     # nothing depends on y2
    with pytest.raises(ValueError, match="harmonic 2 has 3 integers k, .*; a phase that is an int"):
        FourierMap({(1, 0): 1, (0, 1, 1): 1})           # 1 was meant as a phase
    for key in (1, 0, 1, 1), (1, 0, 1, 1, "1"), (1, True), True, "1", ((1, 0), 1), (1.0, 0):
        with pytest.raises((TypeError, ValueError)):
            FourierMap({key: 1})


@pytest.mark.parametrize("phase, words", [
    ("1.5707963", "give 1/2 if it is 1/2 pi"), ("3.14", "give 1 if"), ("-0.7853", "give -1/4 if"),
    ("1.57", "give 1/2 if"), ("1.5", None), ("0.5236", "give 1/6 if"), ("0.79", None),
    ("1/2", None), ("-1/2", None), ("0.25", None), ("0.333333", None), ("0", None)])
def test_a_phase_that_looks_like_radians_is_told(phase, words):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        FourierMap({(1, phase): 1})
    assert [words in str(each.message) for each in caught] == [True] * (words is not None)


def test_names_of_parameters_in_messages():
    with pytest.raises(TypeError, match=r"^the range of k: 0.9 is not an exact number"):
        StandardMap(0.9)
    with pytest.raises(ValueError, match="2 parameters, 1 ranges and 2 different names"):
        SymplecticMap([(1, 0)], [1], [[1], [2]], [1], ["a", "b"])
    with pytest.raises(ValueError, match="^the range of b: 'x' is not"):
        FroeschleMap("0.3", "x")


def test_a_repr_tells_V_and_the_parameters():
    assert repr(StandardMap("0.9")) == "<SymplecticMap: standard map, V(y) = k cos y, k = 0.9>"
    mine = FourierMap({(1, "+cos"): {"K1": 1}, (3, "+cos"): "0.05"}, K1=("0.35", "0.359"))
    assert repr(mine) == "<SymplecticMap: V(y) = K1 cos y + 0.05 cos(3 y), K1 = 0.35..0.359>"
    assert str(StandardMap(("1/3", "2/3"))) == "standard map, k = 0.3333333334..0.6666666666"
    assert str(StandardMap("1/3")) == "standard map, k = 1/3"
    narrow = StandardMap(("0.12345678901234", "0.12345678901235"))
    assert str(narrow) == "standard map, k = 0.12345678901234..0.12345678901235"


def test_numbers_are_no_longer_than_a_checker_takes():
    """A number of 1,000 characters is taken, and so is what is made of it, or it is refused."""
    digits = "0." + "3" * 998
    assert Problem(StandardMap(digits)).amplitude == (Fraction(digits),)
    with pytest.raises(ValueError, match="harmonic 1 has more than 1000 characters"):
        Problem(StandardMap((digits, "0.4")))


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
    assert converse.diagram.explore and set(converse.__all__) <= set(dir(converse))
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
    with pytest.raises(TypeError, match="the map is a SymplecticMap, .* not <potential standard>"):
        converse.tori.find(converse.orbits.standard, "golden")
    with pytest.raises(TypeError, match="is a Rotation, or a text such as"):
        converse.tori.find(m, 0.618)


def test_problems_hold_maps():
    problem = Problem(StandardMap("4/3"))
    low, high = (p for p in (problem.amplitude[0] - problem.parts[0][0],
                             problem.amplitude[0] + problem.parts[0][0]))
    assert low < Fraction(4, 3) < high and high - low < Fraction(1, 10 ** 39)
    assert problem.map.potential().amplitude == (Fraction(4, 3),)
    assert Problem.of(problem) is problem and Problem.of(problem.map) == problem
