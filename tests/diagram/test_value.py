"""The value Diagram: what is proved along the parameters, what is open, and its file."""

import math
import random
from fractions import Fraction as F

import pytest

from converse import (FourierMap, FroeschleMap, MuldoonMap, StandardMap, SymplecticMap, check,
                      diagram, prove, tori)
from converse.diagram import Diagram
from converse.diagram.value import Seen, _gaps, _uncovered
from converse.storage.files import ConverseError
from converse.storage.kept import sealed

TWO = FourierMap({1: {"K": 1, "constant": "0.1"}, 2: "1/3"}, K=(0, 3))


@pytest.fixture(scope="module")
def made():
    found = Diagram.of(StandardMap((0, 2)))
    for low, high in (("1.05", "1.1"), ("1.3", "1.4"), ("1.1", "1.2")):
        found.add(prove(found.over(((F(low), F(high)),))))
    for low, high in (("0.9", "0.9"), ("0.1", "0.2")):
        found.add(tori.prove(found.over(((F(low), F(high)),)), "golden"))
    found.seen += [Seen((F(value),), (turns,)) for value, turns in (
        ("0.3", 0.25), ("0.5", 0.24), ("0.93", 0.3819660112))]
    found.search.append("of no meaning here")
    found.points, found.seconds = 1234, 5.5
    return found


def test_what_is_proved_and_what_is_open(made):
    assert made.none == [(F("1.05"), F("1.2")), (F("1.3"), math.inf)]
    assert [each[:2] for each in made.tori] == [(F("0.1"), F("0.2")), (F("0.9"), F("0.9"))]
    assert {each.rotation for each in made.tori} == {tori.read_rotation("golden")}
    assert made.open == [(0, F("0.1")), (F("0.2"), F("0.9")), (F("0.9"), F("1.05")),
                         (F("1.2"), F("1.3"))]
    assert [proof.problem.map.ranges[0] for proof in made.proofs] == [
        (F("1.05"), F("1.1")), (F("1.3"), F("1.4")), (F("1.1"), F("1.2"))]
    assert all(made.proofs) and check.content(made.tori[0].certificate.encode())


@pytest.mark.parametrize("name", ["k.map", "k.map.gz"])
def test_it_is_what_it_was(made, tmp_path, name):
    made.save(tmp_path / name)
    again = Diagram.load(tmp_path / name)
    assert again._text() == made._text() and again.to_dict() == made.to_dict()
    assert repr(again) == repr(made).replace("standard map", "V(y) = k cos y")
    assert again.verify() and len(again.sha256) == 64


def test_the_report_states_the_theorem(made):
    text = made.report("k.map")
    assert text.startswith("THEOREM\n") and "V(y) = k cos y" in text
    assert "every k in [1.05, 1.2]; every k >= 1.3\n" in text
    assert "every k in [0.1, 0.2]; k = 0.9.\n" in text and "converse-check k.map" in text
    assert "omega = 0.618033988749... = [0; 1, 1, ...] (golden)" in text
    assert "Open       0 <= k < 0.1; 0.2 < k < 0.9; 0.9 < k < 1.05; 1.2 < k < 1.3\n" in text
    assert "Seen       k = 0.93: an orbit as of a torus, rotation 0.381966011\n" in text
    assert "2 values, k from 0.3 to 0.5: orbits as of tori, rotations from 0.24 to 0.25\n" in text
    assert "Rotation   every k in [0.1, 0.2]; k = 0.9: omega = 0.618" in text
    nothing = Diagram.of(StandardMap((0, 2))).report()
    assert nothing.startswith("UNDECIDED") and "J' = J + k sin y.\n" in nothing
    assert "Open       0 <= k <= 2\n" in nothing


def test_tori_of_one_rotation_number_are_united_in_the_report():
    found = Diagram.of(StandardMap((0, 2)))
    for low, high in (("0.1", "0.2"), ("0.15", "0.15"), ("0.2", "0.3"), ("0.4", "0.4")):
        found.add(tori.prove(found.over(((F(low), F(high)),)), "golden"))
    text = found.report()
    assert "for every k in [0.1, 0.3]; k = 0.4." in " ".join(text.split())
    assert text.count("Rotation ") == 1 and "4 of tori" in text


def test_plain_data(made):
    data = made.to_dict()
    assert data["none"] == [["21/20", "6/5"], ["13/10", "inf"]]
    assert data["tori"][1] == {"range": ["9/10", "9/10"], "rotation": "t^2+t-1: t"}
    assert data["parameters"] == {"k": ["0", "2"]} and data["seen"][-1]["value"] == ["93/100"]


def test_a_contradiction_is_an_error(made):
    """A proof and a torus for one value: one of them is wrong, and nothing is added."""
    found = Diagram.of(StandardMap((0, 2)))
    found.add(prove(StandardMap(("1.1", "1.2"))))
    torus = tori.prove(StandardMap("0.9"), "golden")._text()
    lines = torus.replace("wave: 1 0 -1/2 0.9", "wave: 1 0 -1/2 1.15").split("\n")[:-3]
    with pytest.raises(ConverseError, match="k = 1.15 there are a torus and a proof"):
        found.add(type("Torus", (), {"_text": lambda self: sealed(lines)})())
    assert len(found.members) == 1


def test_what_is_no_proof_of_the_family():
    found = Diagram.of(StandardMap((0, 2)))
    for proof in (prove(StandardMap("0.5"), depth=3), prove(FroeschleMap("2", "0.1")),
                  tori.prove(FourierMap({2: "0.1"}), "golden")):
        with pytest.raises(ValueError, match="not a proof of the family"):
            found.add(proof)
    assert found.members == []


# ---- families

def test_parameters_with_one_value_are_no_parameters():
    assert Diagram.of(MuldoonMap((0, 2), 0, "0.1")).names == ("a",)
    assert Diagram.of(FroeschleMap("0.5", (0, 1))).names == ("b",)
    found = Diagram.of(TWO)
    assert found.names == ("K",) and found.family.names == ("K", "amplitude[2]")
    assert found.waves[1].middle == F(1, 3) and Diagram.of(found.family).family == found.family
    proof = prove(found.over(((F(2), F("2.1")),)))
    assert found.add(proof).box == ((2, F("2.1")),)
    assert "where amplitude[2] = 1/3, has no" in " ".join(found.report().split())


@pytest.mark.parametrize("family, words", [
    (StandardMap("0.5"), "no parameter of the family has a range"),
    (MuldoonMap((0, 1), (0, 1), (0, 1)), "3 parameters of the family have a range"),
    (SymplecticMap([(1, 0)], [1], [[0]], [(0, 1)], ["K"]), "no amplitude depends on the param"),
    (SymplecticMap([(1, 0), (0, 1)], [1, 1], [[1, 2], [2, 4]], [(0, 1)] * 2, ["K", "L"]),
     "K and L do not move the amplitudes independently")])
def test_what_is_no_family(family, words):
    with pytest.raises(ValueError, match=words):
        Diagram.of(family)


# ---- what is open

def test_gaps():
    whole = F(0), F(10)
    assert _gaps(whole, []) == [whole]
    assert _gaps(whole, [(F(2), F(3)), (F(3), F(4)), (F(7), math.inf)]) == [(0, 2), (4, 7)]
    assert _gaps(whole, [(-math.inf, F(1)), (F(5), F(5))]) == [(1, 5), (5, 10)]
    assert _gaps(whole, [(F(-1), F(11))]) == [] and _gaps(whole, [(F(11), F(12))]) == [whole]


def test_what_no_box_holds_is_uncovered():
    """Exactly, at the points of a grid; and the boxes do not overlap."""
    rng = random.Random(1)
    for _ in range(100):
        def ends():
            low = rng.randrange(8)
            return F(low), F(rng.randrange(low, 9) + 1)

        boxes = [(ends(), ends()) for _ in range(rng.randrange(7))]
        whole = (F(0), F(8)), (F(0), F(8))
        found = _uncovered(whole, boxes)
        for i in range(8):
            for j in range(8):
                at = F(2 * i + 1, 2), F(2 * j + 1, 2)
                inside = [all(low < x < high for x, (low, high) in zip(at, box)) for box in boxes]
                open_ = [all(low < x < high for x, (low, high) in zip(at, box)) for box in found]
                assert sum(open_) == (not any(inside))


def test_two_parameters(tmp_path):
    found = Diagram.of(FroeschleMap((0, 4), (0, 1)))
    found.add(prove(found.over(((F(3), F(4)), (F(0), F(1))))))
    assert found.none == [((F(3), F(0)), (F(4), F(1)))]
    assert found.open == [((0, 0), (F(3), 1))]
    found.save(tmp_path / "plane")
    again = Diagram.load(tmp_path / "plane")
    assert again.none == found.none and again.family == found.family and again.verify()
    assert "every k in [3, 4], every b in [0, 1]" in found.report()
    assert "Open       75.0 % of the rectangle" in found.report()


def test_the_share_that_is_open_is_rounded_up():
    found = Diagram.of(FroeschleMap((1, 4), (0, 1)))
    found.add(prove(found.over(((F("3.5"), F(4)), (F(0), F(1))))))
    assert "Open       83.4 % of the rectangle" in found.report()


def test_larger_multiples_of_two_parameters():
    """Where both amplitudes are multiples of parameters, and B > 10/3 for the whole box."""
    found = Diagram.of(MuldoonMap((0, 2), 0, (0, 2)))
    assert found.add(prove(found.over(((F(1), F(2)), (F(1), F(2)))))).larger
    assert not found.add(prove(found.over(((F("0.5"), F("0.51")), (F("0.44"), F("0.45")))))).larger
    assert "and for every multiple s >= 1 of every a in [1, 2], every c in [1, 2]" in \
        " ".join(found.report().split())
    result = found.verify()
    assert result and "and for any multiple s >= 1 of\n  every a in [1, 2], every c in [1, 2]\n" \
        in result.text


# ---- the file

def test_a_damaged_file_is_refused_in_a_line(made, tmp_path):
    text, rng, path = made._text(), random.Random(1), tmp_path / "k.map"
    damaged = [text[:rng.randrange(len(text))] for _ in range(20)]
    for _ in range(60):
        k = rng.randrange(len(text))
        damaged.append(text[:k] + chr(ord(text[k]) ^ 1) + text[k + 1:])
    for content in [*damaged, "", "\xff", "converse diagram 1\n", "converse diagram 0\n"]:
        path.write_text(content)
        with pytest.raises(ConverseError) as error:
            Diagram.load(path)
        assert "\n" not in str(error.value) and str(path) in str(error.value)
    with pytest.raises(ConverseError, match="cannot be read"):
        Diagram.load(tmp_path / "none")


def test_explore_is_imported_when_it_is_asked_for():
    assert diagram.explore.__module__ == "converse.diagram.run"
    with pytest.raises(AttributeError):
        diagram.nothing
