"""Whatever is read, the answer is a problem, a proof or one clear line."""

import gzip
import io
import os

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import converse
from converse import InputError, Problem, Proof
from converse.files import ConverseError
from truth import TORTURE

MANY = settings(max_examples=1000 * TORTURE, deadline=None,
                suppress_health_check=list(HealthCheck))

words = st.one_of(
    st.sampled_from(["0.3085", "0.00125", "1.0", "-1", "nan", "inf", "1e400", "1e-400", "0x10",
                     "1e", "--1", "1,5", "", "١", "+.5e+3", "1e99999999999", "a", "\x00"]),
    st.text(max_size=8), st.decimals(allow_nan=True, allow_infinity=True).map(str))
lines = st.lists(words, max_size=4).map(" ".join)
texts = st.lists(lines, max_size=9).map("\n".join)


def one_line(error):
    text = str(error)
    assert text and "\n" not in text.strip()


@MANY
@given(st.one_of(texts, st.text(max_size=200)))
@example("0.3085 0.00125\n" * 5)
@example("1e300 0\n" * 5)
def test_any_text_as_input(text):
    try:
        problem = converse.read_input(io.StringIO(text))
    except InputError as error:
        one_line(error)
    else:
        assert isinstance(problem, Problem) and all(half >= 0 for half in problem.half)
        problem.decimals()


@MANY
@given(st.binary(max_size=300))
@example(b"\xff\xfe0 1\n")
def test_any_bytes_as_input(data):
    try:
        converse.read_input(io.BytesIO(data))
    except InputError as error:
        one_line(error)


@pytest.fixture(scope="module")
def proof_bytes(root, tmp_path_factory):
    path = tmp_path_factory.mktemp("fuzz") / "whole.proof"
    converse.prove(converse.read_input(root / "inputs" / "trig276.in"), backup=path)
    return path.read_bytes()


edits = st.lists(st.tuples(st.sampled_from(["flip", "cut", "insert", "drop line", "double line"]),
                           st.integers(0, 10**6), st.binary(min_size=1, max_size=6)),
                 min_size=1, max_size=4)


def edited(data, edits):
    for kind, where, new in edits:
        if not data:
            break
        at = where % len(data)
        if kind == "flip":
            data = data[:at] + new[:1] + data[at + 1:]
        elif kind == "cut":
            data = data[:at]
        elif kind == "insert":
            data = data[:at] + new + data[at:]
        else:
            rows = data.split(b"\n")
            row = where % len(rows)
            rows[row:row + 1] = [] if kind == "drop line" else [rows[row]] * 2
            data = b"\n".join(rows)
    return data


def resealed(data):
    """The same with its checksum put right, so that what lies behind it is read."""
    import hashlib
    head, found, _ = data.rpartition(b"checksum: sha256 ")
    if not found:
        return data
    return head + b"checksum: sha256 " + hashlib.sha256(head).hexdigest().encode() + b"\nend\n"


@MANY
@given(edits=edits, seal=st.booleans(), zipped=st.booleans())
def test_any_change_of_a_backup(proof_bytes, tmp_path_factory, edits, seal, zipped):
    """A changed backup is refused, or it says what it said before, or it is resealed on purpose."""
    data = edited(proof_bytes, edits)
    if seal:
        data = resealed(data)
    path = tmp_path_factory.getbasetemp() / ("fuzzed-%d" % os.getpid())
    path.write_bytes(gzip.compress(data, 1) if zipped else data)
    try:
        proof = Proof.load(path)
    except ConverseError as error:
        one_line(error)
        return
    assert seal or data == proof_bytes
    try:
        converse.prove(proof.problem, proof.depth, proof.digits, proof.stubborn,
                       proof.as_printed, resume=path, time_limit=0.05)
    except (ConverseError, ValueError) as error:
        one_line(error)


@MANY
@given(data=st.binary(max_size=400))
@example(b"\x1f\x8b")
@example(b"converse proof 1\n")
@example(b"converse proof 1\ntree:\nend\n")
def test_any_bytes_as_backup(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / ("bytes-%d" % os.getpid())
    path.write_bytes(data)
    with pytest.raises(ConverseError) as caught:
        Proof.load(path)
    one_line(caught.value)


@MANY
@given(edits=edits, seal=st.booleans(), zipped=st.booleans())
def test_any_change_of_a_certificate(proof_bytes, tmp_path_factory, edits, seal, zipped):
    """The checker verifies a changed file only if the change leaves a theorem that is true: an
    intact tree of the same problem.  Everything else is rejected, or unusable, in one line."""
    from converse.check import Rejected, Unusable, verify

    data = edited(proof_bytes, edits)
    if seal:
        data = resealed(data)
    path = tmp_path_factory.getbasetemp() / ("certificate-%d" % os.getpid())
    path.write_bytes(gzip.compress(data, 1) if zipped else data)
    try:
        verify(path)
    except (Rejected, Unusable) as error:
        one_line(error)
    else:
        assert seal or data == proof_bytes
