"""The checker that Coq has proved, as a command: what is not proved of it is how it reads, divides
the work and speaks.  All this is compared with converse-check.  (make verified-check builds it.)"""

import gzip
import hashlib
import math
import os
import random
import re
import resource
import signal
import subprocess
import time
from dataclasses import replace
from fractions import Fraction

import pytest
import test_parts as by_hand
from conftest import ROOT, around
from files import sealed, tree_of, with_line

from converse import Problem, check, prove, read_input
from converse.model.exact import decimal_text
from converse.model.map import MuldoonMap

from moments import PATIENCE, wait_until

COMMAND = ROOT / "formal" / "build" / "converse-verified"
pytestmark = pytest.mark.skipif(not COMMAND.exists(), reason="make verified-check was not run")

VERIFIED, REJECTED, UNUSABLE, PART, SPOT_CHECK, NOT_CONFIRMED = range(6)

GENERAL = "standard.json", "two-harmonics.json", "froeschle-0.5.json", "crossed.json"


def start(*arguments, **options):
    return subprocess.Popen([COMMAND, *map(str, arguments)], text=True, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


def run(*arguments, **options):
    with start(*arguments, **options) as process:
        out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


@pytest.fixture(scope="module")
def texts(tmp_path_factory):
    """Proof files with one parameter, with three, with none, of other potentials, and of a part."""
    inputs = {name: (read_input(ROOT / "inputs" / name), together) for name, together in (
        ("trig278.in", True), ("trig180.in", True), ("trig276.in", False),
        ("standard-63-64.in", False), ("standard-972.in", False),
        *((name, False) for name in GENERAL))}
    inputs["point"] = Problem(MuldoonMap("0.31", "0.31", "0.62")), False
    inputs["part"] = around(("0.3085", "0.3085", "0.617", "0.4", "1.3"),
                                    ("0.00125", "0.00125", "0.0025", "0.2", "0.1")), False
    found = {}
    for name, (problem, together) in inputs.items():
        path = tmp_path_factory.mktemp("proofs") / "proof"
        if together:
            problem = problem.tied()
        prove(problem, method="loewner").save(path)
        found[name] = path.read_text("utf-8")
    found["plain"] = about(found["trig278.in"], "1 0 0 1", "1 1", "1 1")
    return found


def about(text, frame, v0, v1):
    """A text without S leaves about that region."""
    for name, value in ("frame", frame), ("v0", v0), ("v1", v1):
        text = with_field(text, name, value)
    return text


def with_field(text, name, value):
    return sealed(with_line(text, name, value))


def with_tree(text, tree):
    return sealed(text[:text.index("\ntree:\n") + 7] + tree + "\n"
                  + text[text.rindex("checksum: "):])


def both(tmp_path, text):
    """The verdicts of both checkers: exit statuses and what they say."""
    path = tmp_path / "proof"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    try:
        result = check.verify(path)
        reference = result.status, result.text
    except check.Failure as error:
        reference = error.status, error.word + str(error)
    return reference, run(path)


def agree(tmp_path, text):
    """The same verdict, whatever it is, and the same theorem except that one of them lists the
    waves.  Returns the status."""
    (status, said), (mine, out, err) = both(tmp_path, text)
    if mine in (VERIFIED, PART):
        assert status == mine and not err
        if "the waves below" in out:    # then from "has no" to where one of them lists the waves
            theorems = [re.split("\n-1 <=| for\nk = |\n\nChecker", text[text.index("has no"):])[0]
                        for text in (out, said)]
            assert theorems[0] == theorems[1]
        else:
            assert out[:out.index("\nChecker")] == said[:said.index("\nChecker")]
        assert out.splitlines()[-1] == said.splitlines()[-1]            # the SHA-256
    else:
        assert mine == status, (said, err)
        assert not out and err.count("\n") == 1 and err.startswith("converse-verified: ")
    return mine


@pytest.mark.parametrize("name", ["trig278.in", "trig180.in", "trig276.in", "standard-63-64.in",
                                  "point", "part"])
def test_confirms(texts, tmp_path, name):
    assert agree(tmp_path, texts[name]) == (PART if name == "part" else VERIFIED)


def test_nothing_can_be_fused():
    """OCaml makes one operation of a product and a sum where the processor has one, as on ARM64.
    In what was extracted a product goes straight into next_up or next_down, which are C."""
    text = re.sub(r"\(\*.*?\*\)", "", (COMMAND.parent / "checker.ml").read_text(), flags=re.S)
    assert [line.strip() for line in text.split("\n") if "Float64.mul" in line] == [
        "Float64.next_up (Float64.mul x y)", "Float64.next_down (Float64.mul x y)"]
    assert "*." not in text and "fma" not in text
    text = (COMMAND.parent / "primitive.ml").read_text()
    for name in "next_up", "next_down":
        assert re.search(r'external %s : float -> float = "\w+" "coq_%s"\n' % (name, name), text)


def reversal_centres(text, frame):
    """c0 of docs/proofs/argument.md at both ends of a text's parameter, in units of pi."""
    a, b, c, d = frame
    x = [float(x) for x in re.search("(?m)^xstar: (.*)$", text)[1].split()]
    found = []
    for t in (-1, 1):
        y = list(x)                             # x* - V'(x*)/2
        for k0, k1, phase, p, part in [map(float, map(Fraction, wave.split())) for wave in
                                       re.findall("(?m)^wave: (.*)$", text)]:
            push = (p + t * part) * math.cos(k0 * x[0] + k1 * x[1] + phase * math.pi) / 2
            y = [y[0] + k0 * push, y[1] + k1 * push]
        found.append((d * y[0] - b * y[1]) / (a * d - b * c) / math.pi)
    return found


DIAGONALS = 1, 1, 1, -1


@pytest.mark.parametrize("below, above, v1, status", [
    ("1e-9", "1e-9", "0.5 0.5", VERIFIED), ("-1e-9", "1e-9", "0.5 0.5", PART),
    ("1e-9", "-1e-9", "0.5 0.5", PART), ("1e-9", "1e-9", "0.5 0.4999", PART),
    ("1e-9", "1e-9", "0.5001 0.5", PART), ("1e-9", "1e-9", "-0.5 1.5", VERIFIED),
    ("-1e-9", "1e-9", "7 1", PART), ("1e-9", "1e-9", "7 1", VERIFIED)])
def test_half_of_v0_by_reversal_and_of_v1_by_exchange(texts, tmp_path, below, above, v1, status):
    text = texts["plain"]
    centres = [Fraction(x) for x in reversal_centres(text, DIAGONALS)]
    low = min(centres) - Fraction(below)
    high = max(centres) + Fraction(1, 2) + Fraction(above)      # P0 = 1
    v0 = "%.15f %.15f" % ((low + high) / 2, (high - low) / 2)
    assert agree(tmp_path, about(text, "1 1 1 -1", v0, v1)) == status


@pytest.mark.parametrize("xstar", ["0.858028 0.858029", "0.858029 0.858029"])
def test_exchange_needs_x_on_the_diagonal(texts, tmp_path, xstar):
    text = with_field(texts["plain"], "xstar", xstar)
    assert agree(tmp_path, about(text, "1 1 1 -1", "7 0.5", "0.5 0.5")) == (
        VERIFIED if len(set(xstar.split())) == 1 else PART)


@pytest.mark.parametrize("frame, v0, v1, status", [     # P0 = 2 g / D, P1 = 2 / g
    ("1 0 0 1", "7 1", "-3 1", VERIFIED), ("1 0 0 1", "7 0.999", "-3 1", PART),
    ("1 1 1 -1", "7 0.5", "-3 1", VERIFIED), ("1 1 1 -1", "7 0.5", "-3 0.999", PART),
    ("-1 1 1 1", "7 0.5", "0.5 0.5", PART), ("-1 1 1 1", "7 0.5", "0.5 1", VERIFIED),
    ("2 4 0 2", "7 0.5", "-3 0.5", VERIFIED), ("2 4 0 2", "7 0.499", "-3 0.5", PART),
    ("2 4 0 2", "7 0.5", "-3 0.499", PART), ("3 -6 5 9", "7 0.0526316", "0 0.3333334", VERIFIED),
    ("3 -6 5 9", "7 0.0526315", "0 0.3333334", PART), ("0 0 0 0", "1 1", "1 1", REJECTED),
    ("1 2 2 4", "1 1", "1 1", REJECTED)])
def test_frames_of_any_determinant(texts, tmp_path, frame, v0, v1, status):
    assert agree(tmp_path, about(texts["plain"], frame, v0, v1)) == status


def test_half_of_a_coordinate_that_is_alone(texts, tmp_path):
    """By reversal of its own map, whatever the other coordinate feels."""
    waves = "wave: 0 1 1/3 1.5 0.001\nwave: 2 0 0 0.4 0\n"
    text = re.sub("(?m)(^wave: .*\n)+", waves, texts["plain"])
    for field, value in ("alone", "1"), ("odd about", "no"), ("at once", "no"):
        text = with_field(text, field, value)
    centres = reversal_centres(text, (0, 1, 1, 0))
    for more, status in (1e-9, VERIFIED), (-1e-9, PART):
        low, high = min(centres) - 1e-9, max(centres) + 1 + more
        v0 = "%.15f %.15f" % ((low + high) / 2, (high - low) / 2)
        assert agree(tmp_path, about(text, "0 1 1 0", v0, "1 1")) == status


# ---- parts that are linked to each other: the attack of the other checker's tests

@pytest.fixture(scope="module")
def links():
    """The arguments of a file with one link, into a region that is hardly larger than it must be,
    and of one with two."""
    tree = by_hand.found()
    return [by_hand.linked(tree, (by_hand.ASIDE,), margin=EDGE),
            by_hand.linked(tree, (by_hand.OTHER, "0.85 0.87"))]


EDGE = Fraction(1, 10 ** 5)             # of a half-width; the two checkers' bounds are nearer


def test_links_are_confirmed(links, tmp_path):
    """The report names all x*, and what was linked."""
    for link, parts in zip(links, (1, 2)):
        text = by_hand.file_of(**link)
        assert agree(tmp_path, text) == VERIFIED
        out = run(tmp_path / "proof")[1]
        assert "\nMethod : Loewner criterion, links between starting points, proved in Coq" in out
        assert "\nx* : 0.858 0.858\nx* of part a : %s\n" % link["parts"][0][0] in out
        assert re.search("Leaves : .*, %d linked to other parts and 0 symmetric" % parts, out)
    assert run("--sample", 1, tmp_path / "proof")[0] == SPOT_CHECK
    assert agree(tmp_path, by_hand.file_of(**{**links[1], "v0": "0.5364 0.2502"})) == PART


@pytest.mark.parametrize("margin", [-EDGE, EDGE])
@pytest.mark.parametrize("name", ["v0", "v1"])
@pytest.mark.parametrize("end", [-1, 1])
def test_where_a_link_leads_out(links, tmp_path, name, end, margin):
    """The region of the part is shorter at one end, by less or by more than it can be."""
    at = 1 + (name == "v1")
    short = by_hand.shorter(links[0]["parts"][0][at], end, EDGE - margin)
    text = by_hand.file_of(**by_hand.with_part(links[0], 0, **{name: short}))
    path = tmp_path / "proof"
    path.write_text(text)
    status, out, err = run(path)
    if margin > 0:
        assert status == VERIFIED
    else:
        assert (status, out) == (NOT_CONFIRMED, "") and err.endswith(
            ": not confirmed: linked leaf 1 of 1 is linked to part a, but may lead out of its "
            "region\n")


def test_thousands_of_parts(tmp_path):
    """Too many parts are rejected before the text is divided among them."""
    text = by_hand.file_of("P").replace("checksum: ", "part: \n" * 20000 + "checksum: ")
    (tmp_path / "proof").write_text(sealed(text))
    assert limited(resource.RLIMIT_AS, 1 << 29, tmp_path / "proof") == (
        REJECTED, "", "converse-verified: %s: rejected: there are more parts than letters\n"
        % (tmp_path / "proof"))


def limited(kind, limit, *arguments):
    """As run, with a limit on what the process may use."""
    return run(*arguments, preexec_fn=lambda: resource.setrlimit(kind, (limit, limit)))


# ---- regions that move with the parameters

SHIFTS = {"v0": "0.01 0.02", "v1": "-0.03 0.005"}           # by the two parameters
ROOM = {"v0": "0.5362 0.2802", "v1": "0.5 0.535"}           # as wide as half the torus and these


@pytest.fixture(scope="module")
def moving():
    """The arguments of a file of three trees over the same x*: half of the torus, linked to a
    region that moves and is no wider than it must be, linked to one that moves alike."""
    ranges = {name: "%s %s" % (ROOM[name], SHIFTS[name]) for name in ROOM}
    claim = by_hand.claim_of(by_hand.file_of("P", *ROOM.values(), waves=by_hand.APART))
    claim = replace(claim, shifts=tuple(zip(*[map(Fraction, SHIFTS[name].split())
                                              for name in ROOM])))
    tree = by_hand.found_tree(claim, 5000)
    return {"tree": "a", "waves": by_hand.APART, "parts": [
        (by_hand.XSTAR, *ranges.values(), text) for text in ("b", tree)]}


def test_regions_that_move(moving, tmp_path):
    """Where both move alike nothing is lost; the report names all x*."""
    assert agree(tmp_path, by_hand.file_of(**moving)) == VERIFIED
    out = run(tmp_path / "proof")[1]
    assert "\nx* of part b : %s\n" % by_hand.XSTAR in out
    assert agree(tmp_path, by_hand.file_of(**{**moving, "v0": "0.5362 0.25"})) == PART


@pytest.mark.parametrize("name", GENERAL)
def test_claims_of_other_potentials(texts, tmp_path, name):
    """The waves of the file, and the parameters that go from -1 to 1."""
    path = tmp_path / "proof"
    path.write_text(texts[name])
    status, out, _ = run("--sample", 10, path)
    waves = ["k = (%d, %d), phase = %s pi, A = %s" % (*wave.k, wave.phase, " ".join(
        [decimal_text(wave.middle, 0), *["%s %s t%d" % ("-" if g < 0 else "+", decimal_text(
            abs(g), 0), m) for m, g in enumerate(wave.parts, 1) if g]]))
             for wave in check.read(path).waves]
    assert status == SPOT_CHECK and "\n".join(["\n-1 <= t1 <= 1", *waves, ""]) in out


def test_orbits_of_thousands_of_points(texts, tmp_path):
    path = tmp_path / "proof"
    path.write_text(texts["standard-972.in"])
    status, out, err = run("--sample", 5, path)
    assert status == SPOT_CHECK and not err
    assert re.match("Spot check of 5 of [1-9][0-9]{2,} proved leaves", out)


@pytest.mark.parametrize("field, value", [
    ("kind", "as printed, not a proof"), ("frame", "1 0 0 2"), ("frame", "1 0 0"),
    ("frame", "1 0 0 101"), ("alone", "0"), ("alone", "1"), ("alone", "maybe"),
    ("odd about", "no"), ("odd about", "1/3 0"), ("odd about", "1/0 0"), ("odd about", "1 -2"),
    ("v0", "1 -1"), ("v0", "1"), ("v0", "0.5 0.5"), ("xstar", "1 1 1"), ("xstar", "1.5 0.2"),
    ("xstar", "0.858028 0.858029"), ("at once", "maybe"), ("at once", "no"), ("depth", "-1"),
    ("cuts", "1"), ("proved", "2"), ("symmetric", "1"), ("undecided", "1"), ("most_cuts", "1"),
    ("wave", "1 0 0 0.31 0.00125 0"), ("wave", "0 0 0 0.31 0.00125"),
    ("wave", "1 0 1/2 0.31 0.00125"),
    ("wave", "101 0 0 0.31 0.00125"), ("wave", "1 0 0 0.31"), ("wave", "1 0 0 0.2 0.00125"),
    ("wave", "1 0 0 1e999 0"), ("wave", "1 0 0 1e-4000 0"), ("wave", "1 0 0 0x1 0"),
    ("wave", "1 0 0 31e-2 +.00125"), ("wave", "1 0 1 -0.31 -0.00125")])
def test_header(texts, tmp_path, field, value):
    agree(tmp_path, with_field(texts["plain"], field, value))


def too_low(text):
    """The proof of 0.0180 to 0.0280, said to be one from 0.0020 on."""
    return sealed(text.replace("0.25793028 0.0560718", "0.16821544 0.14578664")
                  .replace("0.51586056 0.1121436", "0.33643088 0.29157328"))


def test_claims_that_are_too_large(texts, tmp_path):
    """Each field that makes the claim is looked at: at once below 10/3, ranges beyond the proof."""
    text = texts["trig180.in"]
    for forged in (too_low(text), with_field(text, "at once", "yes")):
        assert agree(tmp_path, forged) in (REJECTED, NOT_CONFIRMED)
    low = texts["standard-63-64.in"]
    assert agree(tmp_path, with_field(low, "at once", "yes")) in (REJECTED, NOT_CONFIRMED)


def test_no_tori_at_small_parameters(texts, tmp_path):
    """The standard map at 0.1 has invariant circles; at x[1] = 0 alone one leaf is excluded."""
    text = re.sub("wave: .*\n", "", texts["point"])
    text = with_tree(text, "P").replace(
        "frame: ", "wave: 1 0 0 0.1\nwave: 0 1 0 0\nwave: 1 1 0 0\nframe: ")
    for field, value in (("frame", "0 0 0 0"), ("xstar", "0.1 1.5"), ("at once", "no")):
        text = with_field(text, field, value)
    assert agree(tmp_path, text) == REJECTED


def test_an_odd_point_is_looked_at_in_any_case(texts, tmp_path):
    text = with_field(texts["trig278.in"], "at once", "no")
    assert agree(tmp_path, with_field(text, "odd about", "1/3 0")) == REJECTED


def test_at_falling_parameters_no_upper_end_is_claimed(texts, tmp_path):
    text = sealed(re.sub(r"(?m)^(wave: .*) ([0-9.]+)$", r"\1 -\2", texts["plain"]))
    assert agree(tmp_path, text) == VERIFIED
    _, out, _ = run(tmp_path / "proof")
    assert "any multiple s >= 1 of these amplitudes at t1 = 1 " in " ".join(out.split())


def test_an_upper_end_needs_one_parameter(texts, tmp_path):
    for name in ("trig276.in", "point"):
        assert agree(tmp_path, with_field(texts[name], "at once", "upper end")) == REJECTED


def test_no_leaf_may_be_skipped(texts, tmp_path):
    """A proved leaf that is called symmetric, and one that a cut is taken away from."""
    text, generator = texts["trig180.in"], random.Random(13)
    tree = tree_of(text)
    counts = {name: int(re.search("(?m)^%s: ([0-9]+)$" % name, text)[1])
              for name in ("cuts", "proved", "symmetric")}
    for _ in range(4):
        at = generator.choice([m.start() for m in re.finditer("P", tree)])
        forged = with_tree(text, tree[:at] + "S" + tree[at + 1:])
        forged = with_field(forged, "proved", str(counts["proved"] - 1))
        forged = with_field(forged, "symmetric", str(counts["symmetric"] + 1))
        assert agree(tmp_path, forged) in (VERIFIED, REJECTED, NOT_CONFIRMED)


def with_waves(text, waves, tree, **fields):
    """The text with other waves and another tree, whose counts belong to it."""
    head, middle, rest = text.partition("wave: ")
    text = head + "".join("wave: %s\n" % wave for wave in waves) + rest[rest.index("frame: "):]
    cuts, most = tree.count("P") + tree.count("S") - 1, {"P": "0", "01PS12PPP": "3"}[tree]
    for name, value in {**fields, "cuts": cuts, "proved": tree.count("P"),
                        "symmetric": tree.count("S"), "most_cuts": most}.items():
        text = with_field(text, name.replace("_", " ") if name in fields else name, str(value))
    return with_tree(text, tree)


@pytest.mark.parametrize("waves", [
    "0 1 1 -0.32 -0.005", "0 -1 1 0.32 0.005", "0 -1 -2 -0.32 -0.005", "0 1 -6 0.32 0.005",
    "0 1 0 0.2 0.005, 0 1 0 0.12 0", "0 -1 0 -0.2 0, 0 1 3 -0.12 -0.005",
    "0 1 0 0.32 0.005, 2 1 0.3 0.001 0, -2 -1 0.7 -0.001 0",
    "0 1 0 0.32 0.005, 2 1 0.3 0.0001 0, -1 -2 0.7 0.0001 0",
    "0 1 0 0.32 0.005, 2 1 0.3 0.0001 0, 1 2 1.3 -0.0001 0"])
def test_a_mirror_image_is_the_same_sum(texts, tmp_path, waves):
    """However the waves are written; and not the same if a sign, a phase or a part of one is
    changed."""
    text, waves = texts["plain"], waves.split(", ")

    def verdict(*waves):
        return agree(tmp_path, with_waves(text, ["1 0 0 0.32 0.005", *waves, "1 1 0 0.64 0.01"],
                                          "01PS12PPP", at_once="no", odd_about="no"))

    assert verdict(*waves) == VERIFIED
    for at, wave in enumerate(waves):
        k0, k1, *numbers = map(Fraction, wave.split())
        for sign, *changes in (-1, 0, 0, 0), (1, 1, 0, 0), (1, "1/3", 0, 0), (1, 0, "1/64", 0), (
                1, 0, 0, "1/64"):
            phase, middle, part = map(Fraction.__add__, numbers, map(Fraction, changes))
            changed = "%d %d %s %s %s" % (sign * k0, sign * k1, phase,
                                          *map(decimal_text, (middle, part)))
            assert verdict(*waves[:at], changed, *waves[at + 1:]) == REJECTED, changed


@pytest.mark.parametrize("a, b, c, status", [
    ("0.306", "0.306", "0.612", VERIFIED), ("-0.306", "0.306", "0.612", VERIFIED),
    ("0.306", "-0.306", "0.612", VERIFIED), ("0.12", "0.12", "0.24", NOT_CONFIRMED),
    ("0.15", "0", "0.3", NOT_CONFIRMED)])
def test_all_in_one_leaf(texts, tmp_path, a, b, c, status):
    """Halved where that matters, even from a bad x*, and not for ever."""
    waves = ["1 0 0 %s 0.00125" % a, "0 1 0 %s 0.00125" % b, "1 1 0 %s 0.0025" % c]
    assert agree(tmp_path, with_waves(texts["plain"], waves, "P", at_once="no",
                                      odd_about="no")) == status


def test_what_is_beyond_coq_is_not_called_wrong(texts, tmp_path):
    """A B that only an upper bound tells; but no wave at all is wrong."""
    text = texts["plain"]
    high = ["%d 0 %s %.12f" % (k, Fraction(1, 2) - Fraction(k, 128), 0.1 / k ** 2)
            for k in range(69, 100, 2)]
    assert agree(tmp_path, with_waves(text, high, "P", alone=0, at_once="yes",
                                      odd_about="65/128 0")) == NOT_CONFIRMED
    assert agree(tmp_path, with_waves(text, ["0 1 0 0.9"], "P", alone=0, at_once="yes")) == REJECTED


def test_files_of_every_length(texts, tmp_path):
    """SHA-256 fills up its last block, or adds one."""
    for length in range(64):
        path = tmp_path / "proof"
        text = sealed(texts["trig278.in"].replace("\ntree:",
                                                  "\ncomment: %s\ntree:" % ("x" * length)))
        path.write_text(text)
        status, out, _ = run(path)
        assert status == VERIFIED
        assert out.splitlines()[-1] == "SHA-256 : " + hashlib.sha256(text.encode()).hexdigest()


def test_numbers(texts, tmp_path):
    """What is printed is the exact number that was read."""
    generator = random.Random(5)
    for _ in range(20):
        e = generator.randint(-6, 6)
        tiny = Fraction(generator.randint(0, 10 ** 6), 10 ** 10)
        digits = check.decimal_text((Fraction(31, 100) + tiny) / Fraction(10) ** e)
        text = "1 0 0 %se%+d 0.00125" % (digits, e)
        assert agree(tmp_path, with_field(texts["plain"], "wave", text)) \
            in (VERIFIED, NOT_CONFIRMED)


def test_numbers_of_hundreds_of_digits(texts, tmp_path):
    """They are printed fast.  Beyond the limit of an amplitude and its parts, this is said."""
    waves = ["1 0 0 0.31 1e-%d", "0 1 0 0.31 1e-300", "1 1 0 0.62 1e-300"]

    def text(exponent):
        return with_waves(texts["plain"], [waves[0] % exponent, *waves[1:]], "P", at_once="no",
                          odd_about="no")

    assert agree(tmp_path, text(306)) == VERIFIED
    assert limited(resource.RLIMIT_CPU, 3, tmp_path / "proof")[0] == VERIFIED
    (tmp_path / "proof").write_text(text(307))
    status, out, err = run(tmp_path / "proof")
    assert (status, out) == (NOT_CONFIRMED, "")
    assert ": not confirmed: the header's wave 1: the amplitude and its parts have too many " in err


def test_a_hint_that_is_the_least_of_the_integers(texts, tmp_path):
    """B in units of 10^-9 is 2^62, one more than OCaml's largest integer."""
    text = with_waves(texts["plain"], ["1 0 0 4611681404.7459822", "0 1 0 0.1"], "P",
                      at_once="no", odd_about="no")
    (tmp_path / "proof").write_text(text)
    assert run(tmp_path / "proof") == (
        NOT_CONFIRMED, "", "converse-verified: %s: not confirmed: the bound B\n"
        % (tmp_path / "proof"))


def test_gzip(texts, tmp_path):
    text = texts["trig278.in"]
    packed = gzip.compress(text.encode())
    assert agree(tmp_path, packed) == VERIFIED
    assert agree(tmp_path, packed[:-9]) == UNUSABLE
    assert agree(tmp_path, packed[:40]) == UNUSABLE


def test_jobs_and_spot_checks(texts, tmp_path):
    path = tmp_path / "proof"
    path.write_text(texts["trig180.in"])
    assert run("--jobs", 1, path) == run("--jobs", 3, path)
    status, out, _ = run("--sample", 5, path)
    assert status == SPOT_CHECK and out.startswith("Spot check of 5 of ") and "Verified" not in out
    assert run("--sample", 10 ** 6, path)[0] == SPOT_CHECK


def test_a_false_leaf_is_found_by_whichever_process(texts, tmp_path):
    """Below what is true: some leaves fail, and none of them is overlooked."""
    path = tmp_path / "proof"
    path.write_text(too_low(texts["trig180.in"]))
    for jobs in (1, 2, 5):
        status, out, err = run("--jobs", jobs, path)
        assert status == NOT_CONFIRMED and not out and " is not excluded; " in err


def test_arguments(tmp_path):
    for arguments in ((), ("--jobs",), ("--jobs", "0", "x"), ("--sample", "-1", "x"), ("-x", "x"),
                      ("x", "y"), (tmp_path,), (tmp_path / "none",)):
        status, out, err = run(*arguments)
        assert status == UNUSABLE and not out and err.count("\n") == 1
    assert run("--help")[0] == 0
    assert run("--version")[1].startswith("converse-verified ")


def children(process):
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process.pid)], text=True,
                           stdout=subprocess.PIPE)
    return list(map(int, found.stdout.split()))


@pytest.fixture
def busy(texts, tmp_path):
    """A check that takes a while, when its processes have begun."""
    path = tmp_path / "proof"
    path.write_text(texts["two-harmonics.json"])
    with start("--jobs", 2, path) as process:
        wait_until(lambda: len(children(process)) == 2, process)
        yield process
        process.kill()


def test_a_process_that_dies_is_missed(busy):
    os.kill(children(busy)[0], signal.SIGKILL)
    out, err = busy.communicate(timeout=PATIENCE)
    assert busy.returncode == UNUSABLE and not out and err.count("\n") == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_interrupted(busy, number):
    workers = children(busy)
    for _ in range(5):                          # only the first counts
        busy.send_signal(number)
        time.sleep(0.001)
    out, err = busy.communicate(timeout=PATIENCE)
    assert busy.returncode == 128 + number and not out
    assert err.endswith(": interrupted; nothing was verified\n") and err.count("\n") == 1
    for pid in workers:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
