"""Certificates: written, read, and refused where they are damaged."""

import dataclasses
import gzip
import hashlib
from fractions import Fraction as Q

import pytest

from converse import StandardMap, check, tori
from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.storage import files
from converse.storage.files import ConverseError
from converse.tori import certificate
from converse.tori.find import find
from converse.tori.proved import prove
from converse.tori.rotation import read_rotation


@pytest.fixture(scope="module", params=["surface", "range"])
def proof(request):
    if request.param == "range":
        problem = Problem(SymplecticMap([(1, 0), (2, 0, Q(1, 3))], ["0.35", "-0.01"],
                                        [["0.3", "0"]]))
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
    again, = certificate.tori_of(check.read_torus(text.encode()))
    assert (again.k == torus.k).all() and (again.numbers == torus.numbers).all()
    assert certificate.text([again]) == text


def test_a_torus_that_was_read_is_proved(proof, tmp_path):
    proof.save(tmp_path / "torus")
    again = prove(certificate.read(tmp_path / "torus").tori)
    assert again.residual == proof.residual


def sealed(lines):
    text = "\n".join(lines) + "\n"
    return text + "checksum: sha256 %s\nend\n" % hashlib.sha256(text.encode()).hexdigest()


def refused(path, data):
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(ConverseError) as error:
        certificate.read(path)
    assert str(error.value).startswith(str(path)) and "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", ["silver", "\x1b[31mred", "golden"])
def test_a_name_in_a_file_names_nothing(tmp_path, name):
    """The polynomial, its root and the vector do."""
    body = tori.prove(StandardMap("0.1"), "golden").certificate.partition("checksum")[0].replace(
        "frame:", "hint-name: %s\nframe:" % name)
    (tmp_path / "x").write_text(body + "checksum: sha256 %s\nend\n" % files.sha256(body))
    proof = tori.ProvedTorus.load(tmp_path / "x")
    said = proof.report() + repr(proof) + repr(proof.torus)
    assert proof.rotation.name == "golden" and "silver" not in said and "\x1b" not in said


def test_damaged_files_are_refused(proof, tmp_path):
    proof.save(tmp_path / "good")
    path, data = tmp_path / "bad", (tmp_path / "good").read_bytes()
    for at in range(0, len(data), len(data) // 60):
        refused(path, data[:at] + bytes([data[at] ^ 1]) + data[at + 1:])
        refused(path, data[:at])
    refused(path, b"")
    refused(path, b"\xff\xfe")
    refused(path, gzip.compress(data)[:-10])
    refused(path, b"converse proof 6\n" + data)
    assert "cannot be read" in str(pytest.raises(
        ConverseError, certificate.read, tmp_path / "none").value)


def test_senseless_files_are_refused(proof, tmp_path):
    """With a checksum that is right."""
    proof.save(tmp_path / "good")
    lines = (tmp_path / "good").read_text().split("\n")[:-3]
    path = tmp_path / "bad"
    start = lines.index("tori:") + 2
    for at in range(1, start):
        refused(path, sealed(lines[:at] + lines[at + 1:])) if not lines[at].startswith(
            ("program", "hint", "wave")) else None
        refused(path, sealed(lines[:at] + ["x" + lines[at][:3]] + lines[at + 1:]))
        if ": " in lines[at] and not lines[at].startswith(("hint", "program")):
            refused(path, sealed(lines[:at] + [lines[at] + " 1"] + lines[at + 1:]))
        if lines[at].startswith("polynomial"):
            refused(path, sealed(lines[:at] + [lines[at] + " 0"] + lines[at + 1:]))
    for unknown in "depth: 3", "Wave: 1 0 0 0.1", "hint_a: 1":
        assert "unknown meaning" in refused(path, sealed([lines[0], unknown, *lines[1:]]))
    mode = lines[start]
    for wrong in (mode + " 1", "-" + mode, "", lines[start + 1],
                  mode.replace(" ", "  ", 1), mode + "g"):
        refused(path, sealed(lines[:start] + [wrong] + lines[start + 1:]))
    refused(path, sealed(lines + [mode]))
    refused(path, sealed(lines[:-1]))
