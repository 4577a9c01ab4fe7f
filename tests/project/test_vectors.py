"""experiments/vectors.py and near.py: rotation vectors whose tori last long."""

from fractions import Fraction

import near
import numpy as np
import pytest
import vectors

from converse import MuldoonMap, SymplecticMap, orbits, tori
from converse.tori import read_rotation

STANDARD = "inputs/standard.json"


@pytest.fixture(autouse=True)
def here(root, monkeypatch):
    monkeypatch.chdir(root)


def test_the_golden_circle_lasts_to_where_it_does():
    potential = vectors.potential_at(STANDARD, "K", 1.0)
    assert vectors.judge(potential, read_rotation("golden")) == pytest.approx(0.9716, abs=0.005)
    assert vectors.judge(potential, read_rotation("silver")) < 0.965


def test_the_search_finds_noble_numbers_near_the_golden_mean(monkeypatch):
    monkeypatch.setattr(vectors, "COUNT", 60)
    monkeypatch.setattr(vectors, "ROUNDS", 2)
    potential = vectors.potential_at(STANDARD, "K", 1.0)
    (multiple, (w,)), *_ = best = vectors.search(potential)
    assert 0.9 < multiple < 0.975 and min(abs(w - 0.382), abs(w - 0.618)) < 0.02
    assert best == sorted(best, reverse=True)
    assert len(vectors.search(potential, enough=0.5)) == 1


def test_files_mean_the_same_for_orbits_and_proofs():
    """And so they do in the thesis's map, where V1 is tougher than the others."""
    path = "inputs/froeschle-0.3.json"
    source, same = SymplecticMap.read(path).at(K="0.4"), vectors.map_at(path, "K", 0.4)
    assert same == source
    x = np.random.default_rng(1).random((5, 2))
    assert np.array_equal(vectors.potential_at(path, "K", 0.4).evaluate(x)[1],
                          orbits.potential.known(source).evaluate(x)[1])
    here = orbits.potential.known(MuldoonMap("0.158", "0.158", "0.316"))
    ranked = vectors.ranked(here, [read_rotation(name) for name in ("seven", "V1", "spiral")])
    assert ranked[0][1].name == "V1" and 0.8 < ranked[0][0] < 0.95


def test_what_it_proves_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(vectors, "COUNT", 20)
    monkeypatch.setattr(vectors, "ROUNDS", 1)
    monkeypatch.setattr(vectors, "BISECTIONS", 2)
    path = tmp_path / "k.torus"
    assert vectors.main([STANDARD, "K", "1.2", "--points", "2048", "--save", str(path)]) == 0
    out = capsys.readouterr().out
    assert "proved at K = 0." in out and "K = 0.6: tori are seen" in out
    assert "K = 0.9: tori are seen" in out and "--rotation 't^2+t-1: " in out
    torus = tori.read(path).tori[0]
    assert float(torus.potential.amplitude[0]) == pytest.approx(
        float(out.split("proved at K = ")[1].split(":")[0]), abs=1e-4)


@pytest.mark.parametrize("number,tolerance", [("0.618", "1/1000"), ("0.4", "1/100"),
                                              ("2.29", "1e-5"), ("-0.3", "1e-6")])
def test_a_noble_number_is_near(number, tolerance):
    rotation = near.near(number, tolerance=tolerance)
    assert rotation.polynomial == (-1, 1, 1)
    assert abs(rotation.floats[0] - float(number)) <= Fraction(tolerance) * (1 + 1e-9)
    x, ones = rotation.turns(300)[0][0], 0      # the continued fraction ends in 1, 1, 1, ...
    for _ in range(200):
        quotient = x // 1
        ones = ones + 1 if quotient == 1 else 0
        x = 1 / (x - quotient)
    assert ones > 80
    assert number != "0.618" or rotation.text() == "t^2+t-1: t"


def test_a_vector_near_a_place_is_printed_as_it_is_read(capsys):
    assert near.main(["0.2987", "0.2921", "--tolerance", "1/100"]) == 0
    rotation = read_rotation(capsys.readouterr().out, 2)
    assert rotation.floats == pytest.approx([0.2987, 0.2921], abs=0.01)
    for arguments, words in ((["0.3", "--tolerance", "1e-9"], "the tolerance, 1e-9, is not"),
                             (["0.3", "0.2", "0.1"], "has one number or two, not 3"),
                             (["0.3141593", "--tolerance", "1e-6"], None)):
        assert near.main(arguments) == (2 if words else 0)
        out, err = capsys.readouterr()
        assert (words in err and err.count("\n") == 1 and not out) if words else not err
