"""The checker that Coq has proved, as a command: what is not proved of it is how it reads, divides
the work and speaks.  All this is compared with converse-check.  (make verified-check builds it.)"""

import gzip
import hashlib
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
from files import sealed, with_line

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


def too_low(text):
    """The proof of 0.0180 to 0.0280, said to be one from 0.0020 on."""
    return sealed(text.replace("0.25793028 0.0560718", "0.16821544 0.14578664")
                  .replace("0.51586056 0.1121436", "0.33643088 0.29157328"))


def test_at_falling_parameters_no_upper_end_is_claimed(texts, tmp_path):
    text = sealed(re.sub(r"(?m)^(wave: .*) ([0-9.]+)$", r"\1 -\2", texts["plain"]))
    assert agree(tmp_path, text) == VERIFIED
    _, out, _ = run(tmp_path / "proof")
    assert "any multiple s >= 1 of these amplitudes at t1 = 1 " in " ".join(out.split())


def with_waves(text, waves, tree, **fields):
    """The text with other waves and another tree, whose counts belong to it."""
    head, middle, rest = text.partition("wave: ")
    text = head + "".join("wave: %s\n" % wave for wave in waves) + rest[rest.index("frame: "):]
    cuts, most = tree.count("P") + tree.count("S") - 1, {"P": "0", "01PS12PPP": "3"}[tree]
    for name, value in {**fields, "cuts": cuts, "proved": tree.count("P"),
                        "symmetric": tree.count("S"), "most_cuts": most}.items():
        text = with_field(text, name.replace("_", " ") if name in fields else name, str(value))
    return with_tree(text, tree)


def test_what_is_beyond_coq_is_not_called_wrong(texts, tmp_path):
    """A B that only an upper bound tells; and no wave at all."""
    text = texts["plain"]
    high = ["%d 0 %s %.12f" % (k, Fraction(1, 2) - Fraction(k, 128), 0.1 / k ** 2)
            for k in range(69, 100, 2)]
    assert agree(tmp_path, with_waves(text, high, "P", alone=0, at_once="yes",
                                      odd_about="65/128 0")) == NOT_CONFIRMED
    assert agree(tmp_path, with_waves(
        text, ["0 1 0 0.9"], "P", alone=0, at_once="yes")) == NOT_CONFIRMED


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
