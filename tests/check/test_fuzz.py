"""Whatever is read, the answer is a problem, a proof or one clear line."""

import gzip
import hashlib
import io
import itertools
import math
import os
import random
import re
from fractions import Fraction

import pytest
import test_parts as by_hand
from conftest import around
from files import sealed, tree_of
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from test_tori import BODY as TORUS

import converse
from converse import InputError, Problem, Proof, StandardMap
from converse.diagram import Diagram
from converse.model.exact import decimal_text
from converse.prover.portrait import Portrait, portray
from converse.storage.files import ConverseError
from converse.tori import certificate

from checker import check, says_the_same
from claims import definite, true_bound
from trees import with_field, with_tree
from truth import TORTURE

MANY = settings(max_examples=200 * TORTURE, deadline=None,
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
        assert all(map(decimal_text, (*problem.centre, *problem.half)))


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
    converse.prove(converse.read_input(root / "inputs" / "trig276.in"), backup=path,
                   method="thesis")
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
        Proof.load(path)
    except ConverseError as error:
        one_line(error)
        return
    assert seal or data == proof_bytes
    try:
        converse.prove(resume=path, time_limit=0.05)
    except (ConverseError, ValueError) as error:
        one_line(error)


@pytest.fixture(scope="module")
def formats(proof_bytes, diagram):
    """A small file of each format that the checker reads."""
    links = by_hand.linked(by_hand.found())
    portrait = portray(StandardMap("1.2"), columns=8, depth=4)
    return [proof_bytes, by_hand.file_of(**links).encode(), sealed(TORUS).encode(),
            diagram.encode(), portrait._text().encode()]


LOAD = [Proof.load, Proof.load, certificate.read, Diagram.load, Portrait.load]


@pytest.mark.parametrize("which", range(5), ids=["proof", "links", "torus", "diagram", "portrait"])
@settings(MANY, max_examples=100 * TORTURE)
@given(edits=edits, seal=st.booleans(), zipped=st.booleans())
def test_any_change_of_a_file(formats, tmp_path_factory, which, edits, seal, zipped):
    """The checker verifies a changed file, and the program loads it, only if it was sealed again,
    and then what it says is a theorem.  Everything else is refused in one line."""
    data = edited(formats[which], edits)
    if seal:
        data = resealed(data)
    path = tmp_path_factory.getbasetemp() / ("changed-%d" % os.getpid())
    path.write_bytes(gzip.compress(data, 1) if zipped else data)
    status, why = check.VERIFIED, ""
    for read, failure in (check.verify, check.Failure), (LOAD[which], ConverseError):
        try:
            found = read(path)
            assert seal or data == formats[which]
        except failure as error:
            one_line(error)
            found, why = error, why + str(error)
        status = getattr(found, "status", status)
    assert which > 1 or says_the_same(path, status, why)


@MANY
@given(start=st.sampled_from([b"", b"converse proof 6\n", b"\x1f\x8b", b"converse proof "]),
       data=st.binary(max_size=300), seal=st.booleans())
@example(b"converse proof 6\n", b"checksum: sha256 ", True)
@example(b"converse proof 6\n", b"\ntree:\n\n", True)
@example(b"converse proof 6\n", b"tree:\nP\n", True)
@example(b"converse proof 6\n", b"tree:\nend\n", False)
@example(b"converse proof ", b"1\n", False)
@example(b"\x1f\x8b", b"", False)
def test_any_bytes_as_a_proof_file(tmp_path_factory, start, data, seal):
    path = tmp_path_factory.getbasetemp() / ("any-%d" % os.getpid())
    data = start + data + b"\nchecksum: sha256 \n" * seal
    path.write_bytes(resealed(data))
    for read, failure in (check.verify, check.Failure), (Proof.load, ConverseError):
        with pytest.raises(failure) as caught:
            read(path)
        one_line(caught.value)


# ---- changes that make sense: another claim or tree, with the counts and the checksum it needs

@pytest.fixture(scope="module")
def proof_files(root, tmp_path_factory):
    """Whole proofs: of both methods, with parameters together and apart, cut and not."""
    path = tmp_path_factory.mktemp("fuzz") / "whole.proof"
    found = []
    for name in ("trig274", "trig278"):
        converse.prove(converse.read_input(root / "inputs" / (name + ".in")),
                       method="thesis").save(path)
        found.append(path.read_text(encoding="utf-8"))
    for a, b, c, together in (("0.29 0.02", "0.29 0.02", "0.58 0.04", True),
                              ("0.28 0.01", "0.29 0.015", "0.59 0.03", True),
                              ("0.27 0", "0.27 0", "0.54 0", True),
                              ("0.285 0.015", "0.285 0.015", "0.57 0.03", False),
                              ("0.27 0.01", "0.29 0.01", "0.57 0.02", False)):
        ranges = [map(Fraction, pair.split()) for pair in (a, b, c, "1 1", "1 1")]
        converse.prove(around(*zip(*ranges), (), together), method="loewner").save(path)
        found.append(path.read_text(encoding="utf-8"))
    return found


numbers = st.one_of(
    st.sampled_from(["0", "-0.3", "0.3", "1", "-1", "2", "0.001", "1e-20", "20", "1e300"]),
    st.decimals(-2, 2, places=3).map(str))
waves = st.integers(0, 2)
changes = st.lists(st.one_of(
    st.tuples(st.just("amplitude"), waves, numbers),
    st.tuples(st.just("part"), waves, numbers),
    st.tuples(st.just("k"), waves, st.sampled_from(["1 -1", "2 0", "0 1", "1 1", "-1 0", "0 0"])),
    st.tuples(st.just("phase"), waves, st.sampled_from(["1", "1/2", "-0.1", "2", "1/0"])),
    st.tuples(st.just("stretch"), st.sampled_from(["0", "0.5", "1.001", "1.1", "2", "20"]),
              st.none()),
    st.tuples(st.just("scale"), st.sampled_from(["0", "-1", "0.1", "0.7", "0.9", "1.2", "9"]),
              st.none()),
    st.tuples(st.just("region"), numbers, numbers.map(lambda x: x.lstrip("-"))),
    st.tuples(st.just("field"), st.just("xstar"), st.tuples(numbers, numbers).map(" ".join)),
    st.tuples(st.just("field"), st.just("at once"), st.sampled_from(["yes", "no", "upper end"])),
    st.tuples(st.just("field"), st.just("frame"),
              st.sampled_from(["1 0 0 1", "1 0 -1 1", "0 1 1 0", "2 1 1 1", "1 1 1 1"])),
    st.tuples(st.just("field"), st.just("alone"), st.sampled_from(["no", "0", "1"])),
    st.tuples(st.just("field"), st.just("odd about"),
              st.sampled_from(["no", "0 0", "1/2 0", "1 1"])),
    st.tuples(st.just("node"), st.integers(0, 10**6), st.sampled_from("01234PPPSU?")),
    st.tuples(st.just("prune"), st.integers(0, 10**6), st.sampled_from("PPS")),
    st.tuples(st.just("graft"), st.integers(0, 10**6),
              st.sampled_from(["2PP", "3PS", "4SP", "0SP", "2P2SP", "43PPP"])),
    st.tuples(st.just("double"), st.sampled_from(check.AXES), st.none())),
    min_size=1, max_size=4)


def subtree_end(tree, at):
    missing = 1
    while missing and at < len(tree):
        missing += 1 if tree[at] in check.AXES else -1
        at += 1
    return at


def changed(text, changes):
    """The text after these changes, with the counts of its tree, sealed."""
    waves = [line.split(" ") for line in re.findall("(?m)^wave: (.*)$", text)]  # k0 k1 phase p g..
    tree = tree_of(text)

    def times(word, factor):
        return check.decimal_text(Fraction(word) * Fraction(factor))

    for kind, what, new in changes:
        if kind == "amplitude":
            waves[what][3] = new
        elif kind == "part":
            waves[what][4:] = [new if Fraction(word) else word for word in waves[what][4:]]
        elif kind == "k":
            waves[what][:2] = new.split()
        elif kind == "phase":
            waves[what][2] = new
        elif kind == "stretch":
            waves = [wave[:4] + [times(word, what) for word in wave[4:]] for wave in waves]
        elif kind == "scale":
            waves = [wave[:3] + [times(wave[3], what)] + wave[4:] for wave in waves]
        elif kind == "region":
            for name in ("v0", "v1"):
                text = with_field(text, name, what + " " + new)
        elif kind == "field":
            text = with_field(text, what, new)
        elif kind == "double":
            tree = what + tree + tree
        else:
            at = what % len(tree)
            if kind == "graft":
                at = min((n for n in range(len(tree)) if tree[n] in "PS"), default=0,
                         key=lambda n: abs(n - at))
            end = at + 1 if kind == "node" else subtree_end(tree, at)
            tree = tree[:at] + new + tree[end:]
    lines = iter(["wave: " + " ".join(wave) for wave in waves])
    text = re.sub("(?m)^wave: .*$", lambda _: next(lines), text)
    return sealed(with_tree(with_field(text, "depth", 99), tree))


def refuted(claim, cases):
    """Parameters of the claim for which it is wrong, if some are found in so many cases: x* goes on
    to a point of the region on an orbit whose second variation is definite for 14 steps each way;
    or B <= 10/3 where larger parameters are said to be excluded at once."""
    rng = random.Random(claim.sha256)
    potential = [(wave.k, wave.phase) for wave in claim.waves]
    for n in range(cases):
        eta = [rng.choice((-1, 0, 1, rng.uniform(-1, 1), rng.uniform(-1, 1))) for _ in range(5)]
        p = [float(wave.at(list(map(Fraction, eta)))) for wave in claim.waves]
        v = [c + h * Fraction(e) for c, h, e in zip(claim.centre, claim.half, eta[3:])]
        x0 = list(map(float, claim.xstar))
        x1 = [math.pi * float((claim.frame[i] * v[0] + claim.frame[i + 1] * v[1]) % 2)
              for i in (0, 2)]
        if definite(p, x0, x1, 14, math, potential):
            return p
    if claim.at_once != "no" and potential == [(k, 0) for k in check.THESIS]:
        corners = [(1,) * claim.parameters] if claim.at_once == "upper end" else \
            itertools.product((-1, 0, 1), repeat=claim.parameters)
        for corner in corners:
            abc = [float(wave.at(corner)) for wave in claim.waves]
            if max(map(abs, abc)) < 9 and true_bound(abc) <= 10 / 3 - 1e-9:
                return abc
    return None


@pytest.mark.usefixtures("impatient")
@settings(MANY, max_examples=25 * TORTURE)
@given(which=st.integers(0, 6), changes=changes)
@example(2, [("stretch", "20", None)])
@example(6, [("scale", "-1", None)])
@example(4, [("field", "at once", "yes")])
@example(6, [("field", "at once", "upper end")])
@example(2, [("field", "alone", "0")])
@example(2, [("field", "frame", "1 0 -1 1")])
@example(2, [("k", 2, "1 -1")])
@example(2, [("phase", 2, "1")])
def test_any_other_claim_or_tree(proof_files, tmp_path_factory, which, changes):
    """A changed proof file that counts right and has its checksum is verified only if no
    counterexample to what it says can be found.  (What is false costs the checker all the pieces
    that it may make of a leaf; what is true, some.)"""
    text = changed(proof_files[which], changes)
    path = tmp_path_factory.getbasetemp() / ("other-%d" % os.getpid())
    path.write_text(text, encoding="utf-8")
    try:
        result = check.verify(path)
    except check.Failure as error:
        one_line(error)
    else:
        claim = check.read(path)
        whole = check.symmetries_used(claim) is not None
        assert result.status == (check.VERIFIED if whole else check.PART)
        assert refuted(claim, 40) is None
