"""Certificates: written, read, and refused where they are damaged."""

import dataclasses
from fractions import Fraction as Q

import pytest
from files import sealed

from converse import StandardMap, check, tori
from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.storage.files import ConverseError
from converse.tori import certificate
from converse.tori.find import find
from converse.tori.proved import prove
from converse.tori.rotation import read_rotation


@pytest.fixture(scope="module", params=["surface", "range"])
def proof(request):
    if request.param == "range":
        problem = Problem(SymplecticMap([(1, 0), (2, 0, Q(1, 3))], ["0.15", "-0.01"],
                                        [["0.1", "0"]]))
        return prove(find(problem, read_rotation("golden", 1)))
    return prove(find(Problem(SymplecticMap(THESIS, ["0.01", "0.01", "0.02"])),
                      read_rotation("T49", 2)))


@pytest.mark.parametrize("name", ["torus.txt", "torus.gz"])
def test_what_was_written_is_read(proof, name, tmp_path):
    checksum = proof.save(tmp_path / name)
    found = certificate.read(tmp_path / name)
    assert found.sha256 == checksum
    for torus, piece in zip(found.tori, proof.pieces):
        for field in ("potential", "part", "rotation", "bits", "strip", "piece"):
            assert getattr(torus, field) == getattr(piece.torus, field)
        for field in ("k", "numbers"):
            assert (getattr(torus, field) == getattr(piece.torus, field)).all()
            assert (getattr(torus, field).dtype == getattr(piece.torus, field).dtype)
    assert len(found.tori) == len(proof.pieces)


def test_a_found_torus_is_in_its_certificate():
    """Its modes stay in their order, and coefficients that are 0 are not in the file."""
    torus = find(Problem(SymplecticMap([(1, 0)], ["0.35"], [["0.3"]])),
                 read_rotation("golden", 1))[0]
    numbers = torus.numbers.copy()
    numbers[:, 1, :, 2] = 0
    torus = dataclasses.replace(torus, numbers=numbers, piece=(Q(-1), Q(1)))
    text = certificate.text([torus])
    assert text.count("\n3 0 ") == 1 and text.count("\n3 1 ") == 0 and text.count("\n3 2 ") == 1
    again, = certificate.tori_of(check.content(text.encode()))
    assert (again.k == torus.k).all() and (again.numbers == torus.numbers).all()
    assert certificate.text([again]) == text


def test_a_torus_that_was_read_is_proved(proof, tmp_path):
    proof.save(tmp_path / "torus")
    again = prove(certificate.read(tmp_path / "torus").tori)
    assert again.residual == proof.residual


def refused(path, data):
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(ConverseError) as error:
        certificate.read(path)
    assert str(error.value).startswith(str(path)) and "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", [
    "silver", pytest.param("golden", marks=pytest.mark.slow)])
def test_a_name_in_a_file_names_nothing(tmp_path, name):
    """The polynomial, its root and the vector do."""
    body = tori.prove(StandardMap("0.1"), "golden").certificate.partition("checksum")[0].replace(
        "frame:", "hint-name: %s\nframe:" % name)
    (tmp_path / "x").write_text(sealed(body))
    proof = tori.ProvedTorus.load(tmp_path / "x")
    said = proof.report() + repr(proof) + repr(proof.torus)
    assert proof.rotation.name == "golden" and "silver" not in said
