"""The checker: it confirms what is proved, rejects everything else, and its bounds are bounds."""

import ast
import contextlib
import dataclasses
import gzip
import hashlib
import itertools
import json
import math
import multiprocessing
import operator
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import types
from fractions import Fraction

import mpmath
import pytest
from conftest import around
from files import sealed, tree_of, with_line
from test_exact import worst

from converse import StandardMap
from converse import check as package
from converse import prove, read_input
from converse.model.map import LINE

from checker import check, start_of_workers
from moments import PATIENCE
from trees import cells_of, claim_of, found_tree, halves
from truth import TORTURE

# Of a process without sanitizers, which may import what lies about its file.
PLAIN = {name: value for name, value in os.environ.items()
         if name not in ("LD_PRELOAD", "PYTHONSAFEPATH", "PYTHONPATH")}

INPUTS = ("trig272", "trig274", "trig276", "trig278")
mp = mpmath.mp.clone()
mp.dps = 60
pytestmark = pytest.mark.usefixtures("impatient")


# ---- files to check

@pytest.fixture(scope="module")
def texts(root, tmp_path_factory):
    """The proof files of the four inputs, as text."""
    found = {}
    for name in INPUTS:
        path = tmp_path_factory.mktemp("proofs") / name
        prove(read_input(root / "inputs" / (name + ".in")), method="thesis").save(path)
        found[name] = path.read_text(encoding="utf-8")
    return found


def with_field(text, name, value):
    """The text with another value of a field; or, of a proof of the thesis's waves, with another
    centre and half-width of a, b or c, or parameters that move `together` or not."""
    if name in ("a", "b", "c"):
        return with_wave(text, "abc".index(name), value)
    if name == "together":
        return with_parts(text, value == "yes")
    if name == "at once" and value == "yes" and is_together(text):
        value = "upper end"
    return with_line(text, name, value)


def wave_words(text):
    return [line.split(" ") for line in re.findall("(?m)^wave: (.*)$", text)]


def is_together(text):
    """Is there one parameter, with which all waves move?"""
    return {len(words) for words in wave_words(text)} == {5}


def with_wave(text, i, value):
    centre, _, half = value.partition(" ")
    words = wave_words(text)[i]
    parts = [half] if is_together(text) else ["0"] * i + [half] + ["0"] * (2 - i)
    return with_line(text, "wave", " ".join([*words[:3], centre, *parts]), i)


def with_parts(text, together):
    halves = [next((part for part in words[4:] if part != "0"), "0") for words in wave_words(text)]
    once = re.search("(?m)^at once: (.*)$", text).group(1)
    for i, (words, half) in enumerate(zip(wave_words(text), halves)):
        parts = [half] if together else ["0"] * i + [half] + ["0"] * (2 - i)
        text = with_line(text, "wave", " ".join([*words[:4], *parts]), i)
    return text if once == "no" else with_line(text, "at once", "upper end" if together else "yes")


def with_tree(text, tree, counted=True):
    """The text with another tree, and the counts of that tree."""
    head, middle, rest = text.partition("\ntree:\n")
    text = head + middle + tree + "\n" + rest[rest.rindex("checksum"):]
    if counted:
        for name, kinds in (("cuts", check.AXES), ("proved", "P"), ("symmetric", "S"),
                            ("undecided", "U")):
            text = with_field(text, name, sum(map(tree.count, kinds)))
        try:
            text = with_field(text, "most_cuts", max(
                [sum(cuts) for at, (_, cuts) in check.leaves(tree) if tree[at] == "P"] + [0]))
        except check.Failure:
            pass
    return text


def with_parameters(text, *pairs):
    """The text with other centres and half-widths of a, b and c."""
    for name, pair in zip("abc", pairs):
        text = with_field(text, name, " ".join(check.decimal_text(Fraction(x)) for x in pair))
    return text


def above(cell):
    """Does the cell lie above the diagonal of the angles?"""
    (i, j, *_), (k, l, *_) = cell
    return j << k >= i + 1 << l


def built(a, half, depth, text):
    """A proof file whose leaves need orbits; the tree is cut until one attempt settles a leaf."""
    text = with_parameters(text, *((k * Fraction(a), k * Fraction(half)) for k in (1, 1, 2)))
    text = with_tree(with_field(with_field(text, "depth", 99), "most_cuts", depth), "P", False)
    criterion, tree, todo = check.Criterion(claim_of(text)), [], [check.ROOT]
    while todo:
        cell = todo.pop()
        failed = None
        if above(cell):
            tree.append("S")
        elif sum(cell[1]) == depth or not (failed := criterion.attempt(
                criterion.least_pivot(cell), cell, check.SITE_PENALTIES[0])):
            tree.append("P")
        else:
            tree.append("0" if failed[1][-2] > failed[1][-1] else "1")
            todo += reversed(halves(cell, int(tree[-1])))
    return sealed(with_tree(text, "".join(tree)))


@pytest.fixture(scope="module")
def deep(texts):
    """a = b = c/2 = 0.24: beyond the thesis's method; no leaf is settled at once."""
    return built("0.24", "0.0001", 30, texts["trig274"])


@pytest.fixture(scope="module")
def moving(tmp_path_factory):
    """Proof files of the method loewner, by name: parameters on a segment, that of the inputs or
    another, or in a box about a piece of it; with cuts of the parameters or without.  They are of
    the whole torus, in the frame in which leaves may be mirror images: what the program makes of
    it is in test_parts.py."""
    inputs = [LINE * k for k in (1, 1, 2)]          # times epsilon
    slanted = (Fraction(12), Fraction("10.5"), Fraction(23))
    found = {}
    for name, direction, low, high, together in (
            ("segment", inputs, "0.0200", "0.0280", True),
            ("beginning", inputs, "0.0200", "0.0202", True),
            ("slanted", slanted, "0.0216", "0.0284", True),
            ("point", inputs, "0.0240", "0.0240", True),
            ("box", inputs, "0.0230", "0.0250", False),
            ("narrow box", inputs, "0.0239", "0.0241", False),
            ("slanted box", slanted, "0.0236", "0.0250", False)):
        ends = [[k * Fraction(x) for k in direction] for x in (low, high)]
        problem = around((*((p + q) / 2 for p, q in zip(*ends)), Fraction(1), Fraction(1)),
                          (*((q - p) / 2 for p, q in zip(*ends)), Fraction(1), Fraction(1)), (),
                          together)
        path = tmp_path_factory.mktemp("proofs") / "moving"
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("converse.prover.run.reduced", lambda problem, xstar: problem)
            prove(problem, method="loewner").save(path)
        found[name] = path.read_text(encoding="utf-8")
    return found


# ---- confirmed

@pytest.mark.parametrize("name", INPUTS)
def test_confirms(texts, run, name):
    status, out, err = run(texts[name])
    assert (status, err) == (0, "")
    assert out.startswith("Verified :")
    assert hashlib.sha256(texts[name].encode()).hexdigest() in out
    assert "%d proved" % tree_of(texts[name]).count("P") in out
    if name == "trig274":
        assert "\n0.30725 <= a <= 0.30975\n" in out and "\n0.6145 <= c <= 0.6195\n" in out
        assert "region" not in out


@pytest.mark.parametrize("name, cuts, at_once", [
    ("segment", "2", True), ("beginning", "", False), ("slanted", "2", True), ("point", "", False),
    ("box", "4", False), ("narrow box", "", False), ("slanted box", None, False)])
def test_confirms_ranges_of_parameters(moving, run, name, cuts, at_once):
    text = moving[name]
    status, out, err = run(text)
    assert (status, err) == (0, "") and out.startswith("Verified :")
    assert cuts is None or set(tree_of(text)) & set("234") == set(cuts)
    assert ("moving together" in out) == is_together(text) == ("box" not in name)
    told = "any multiple s >= 1 of the upper ends" in out
    assert told == ("at once: no" not in text) == at_once
    assert ("symmetric" in out and "0 symmetric" in out) == ("slanted" in name)
    if name == "segment":
        assert "\n0.2242872 <= a <= 0.31400208\n" in out and "region" not in out


def test_confirms_cuts_along_every_parameter(moving, run):
    """Halved and halved again along a, b and c, the same tree proves the same; and B falls."""
    for name, axes in (("segment", "22"), ("narrow box", "234"), ("narrow box", "3"),
                       ("slanted box", "42"), ("point", "2")):
        text, tree = moving[name], tree_of(moving[name])
        for axis in axes:
            tree = axis + tree + tree
        text = with_field(text, "depth", 99)
        assert run(sealed(with_tree(text, tree)))[0] == 0
    ends = [0, (1 << 3) - 1]
    for name in ("segment", "narrow box", "slanted box"):
        criterion = check.Criterion(claim_of(with_tree(moving[name], "2PP")))
        low, high = (criterion.least_pivot(((0, 0, i, i, i), (0, 0, 3, 3, 3))) for i in ends)
        assert low > high == criterion.least_pivot(check.ROOT)


def test_halves_leaves_that_are_too_large(deep, texts, run):
    tree = tree_of(deep)
    while "0PP" in tree and tree.count("P") > 200:
        tree = tree.replace("0PP", "P").replace("1PP", "P")
    status, out, _ = run(sealed(with_tree(deep, tree)))
    assert status == 0
    assert int(re.search("in ([0-9]+) pieces", out).group(1)) > tree.count("P")


def test_halves_angles_that_only_a_longer_orbit_feels(texts, run):
    """Of so wide a region no orbit is followed but for x*, which contradicts hardly, and only the
    parameters move that."""
    text = general(texts["trig274"], [
        ((1, 0), 0, Fraction("1.25"), (Fraction("0.25"), 0)),
        ((1, 1), 0, Fraction("0.234375"), (Fraction("0.046875"), Fraction("0.09375")))],
        (Fraction("0.875"), Fraction("0.125")), (Fraction("0.75"), Fraction("0.25")), tree="P",
        xstar=(Fraction("1.570796"), 0))
    for options in ((), ("--exact",)):
        status, out, err = run(text, *options)
        assert status == 3 and 3 <= int(re.search("in ([0-9]+) pieces", out).group(1)) < 100, err


def test_the_theorem_is_stated_in_the_named_parameters(run, tmp_path):
    """What a name means is derived from the waves: other ends of it give another amplitude."""
    prove(StandardMap(("2.5", "3"))).save(tmp_path / "proof")
    text = (tmp_path / "proof").read_text(encoding="utf-8")
    for line, V, force, ends in (
            ("k 2.5 3", "k cos y", "k sin y", "2.5 <= k <= 3\nand for any k > 3 "),
            ("k 3 2.5", "(5.5 - k) cos y", "(5.5 - k) sin y", "2.5 <= k <= 3\nand for any multiple "
             "of V at k = 2.5, by a factor >= 1 "),
            ("\u03b5[1] 0.001 0.002", "(2 + 500 \u03b5[1]) cos y", "(2 + 500 \u03b5[1]) sin y",
             "0.001 <= \u03b5[1] <= 0.002\nand for any multiple of V at \u03b5[1] = 0.002, "),
            ("K -1 -1.2", "-2.5 K cos y", "- 2.5 K sin y",
             "-1.2 <= K <= -1\nand for any K < -1.2 "),
            ("K 0 3", "(2.5 + 1/6 K) cos y", "(2.5 + 1/6 K) sin y", "0 <= K <= 3\n"),
            ("J2 0 3", "(2.5 + 1/6 J2) cos y", "(2.5 + 1/6 J2) sin y", "0 <= J2 <= 3\n")):
        status, out, _ = run(sealed(with_field(text, "parameter", line)))
        assert "\nV(y) = %s,\nthat is, J' = J %s,\n" % (V, force if force[0] == "-"
                                                       else "+ " + force) in out
        assert (status, out.count("for any parameters with\n" + ends)) == (0, 1)
    for line, why in (
            ("\033k 2.5 3", "a control character"), ("k\u202e 2 3", "not a name"),
            ("J 2 3", "not a name"),
            ("k 2.5", "not a name of a parameter and two numbers"), ("k 2.5 nan", "not a decimal"),
            ("k 3 3", "has one value"), ("k 2 3\nparameter: l 2 3", "each parameter once"),
            ("k 2 " + "3" * 3001, "limit")):
        status, out, err = run(sealed(with_field(text, "parameter", line)))
        assert status == (5 if why == "limit" else 1) and why in err and err[:-1].isprintable()
    for name in ("v0", "v1"):
        text = with_field(text, name, "1 0.001")
    out = run(sealed(text))[1]
    assert "so that" not in out and "full torus) for any parameters with\n2.5 <= k <= 3\n" in out


def formula(text, values):
    """The value of what a theorem says V or a momentum is."""
    text = re.sub(r"([\w)]) (?=[a-z(])", r"\1 * ", re.sub("(sin|cos) (y[01]?)", r"\1(\2)", text))
    return eval(text, {"sin": math.sin, "cos": math.cos, "pi": math.pi, **values})


@pytest.mark.parametrize("dimension", [1, 2])
def test_the_map_of_a_theorem_is_that_of_the_waves(generator, dimension):
    """V and the force, read from the theorem, at random points and parameters."""
    def number(least=0):
        return Fraction(generator.randint(least, 4), generator.choice((1, 2, 3, 7)))
    for count in [0, 1, 2, 3] * 8:
        ends = [(x := number(), x + number(1)) for _ in range(count)]
        names = [("p%d" % m, *generator.sample(each, 2)) for m, each in enumerate(ends)]
        waves = [check.Wave((generator.randint(-2, 2), generator.randint(-2, 2) * (dimension - 1)),
                            number(-4) * generator.choice((1, Fraction(1, 2))), number(-4),
                            tuple([number(-4) for _ in names])) for _ in range(3)]
        lines = check.map_lines(waves, names, dimension)
        said = dict(re.findall(r"(V\(y\)|J[01]?') = ((?:[^J,]|J[01]?\b(?!'))+),",
                               " ".join(" ".join(lines[1:]).split())))
        letters = ["y"] if dimension == 1 else ["y0", "y1"]
        t = [generator.uniform(-1, 1) for _ in names]
        y = {letter: generator.uniform(-4, 4) for letter in letters}
        values = {**y, **{name: float(low + high) / 2 + x * float(high - low) / 2
                          for (name, low, high), x in zip(names, t)}}
        angles = [sum(map(operator.mul, wave.k, y.values())) + math.pi * wave.phase
                  for wave in waves]
        sizes = [float(wave.at(t)) for wave in waves]
        assert math.isclose(formula(said["V(y)"], values), -sum(
            map(operator.mul, sizes, map(math.sin, angles))), abs_tol=1e-9)
        for i, letter in enumerate(letters):
            J = "J" + letter[1:]
            assert math.isclose(formula(said[J + "'"], {**values, J: 7.0}), 7 + sum(
                [wave.k[i] * size * math.cos(angle)
                 for wave, size, angle in zip(waves, sizes, angles)]), abs_tol=1e-9)


def test_same_output_for_any_jobs(deep, run):
    assert run(deep) == run(deep, "--jobs", "3")
    bad = sealed(with_field(deep, "xstar", "-1.5 -1.5"))
    alone = run(bad)
    assert alone == run(bad, "--jobs", "2") and alone[0] == 5


def test_gzip(texts, run):
    text = texts["trig278"].encode()
    data = gzip.compress(text)
    status, out, _ = run(data, name="some.proof.gz")
    assert status == 0 and hashlib.sha256(text).hexdigest() in out
    assert run(data, name="named.otherwise")[0] == 0


def test_quiet(texts, run):
    assert run(texts["trig276"], "--quiet") == (0, "", "")
    assert "NOT a verification" in run(texts["trig276"], "--quiet", "--sample", "3")[1]
    assert "for a part of the torus only" in run(part_of(texts["trig276"]), "--quiet")[1]


@pytest.mark.parametrize("options", [("20",), ("20", "--jobs", "2"), ("999999",)])
def test_a_spot_check_says_so(deep, run, options):
    """In its status and in its words, even if it was of all leaves."""
    status, out, err = run(deep, "--sample", *options)
    leaves = tree_of(deep).count("P")
    assert (status, err) == (4, "") and "erified :" not in out.replace("NOT verified :", "")
    assert out.startswith("Spot check of %d of %d proved leaves, NOT a verification"
                          % (20 if "20" in options else leaves, leaves))


def test_a_spot_check_cannot_be_foreseen(deep, run, monkeypatch):
    """Else a forger would know where nobody looks."""
    seen = []
    monkeypatch.setattr(check.Criterion, "excluded", lambda self, cell: seen.append(cell) or (0, 1))
    assert [run(deep, "--sample", "20", "--exact")[0] for _ in "12"] == [4, 4]
    assert len(set(seen[:20])) == 20 and set(seen[:20]) != set(seen[20:])


def test_a_spot_check_that_misses_the_false_leaf_verifies_nothing(moving, run):
    """Of the segment from 0.0120 only the upper half is proved, and the lower is one leaf."""
    text, tree = moving["segment"], tree_of(moving["segment"])
    scale = LINE
    text = with_parameters(text, *((k * scale / 50, k * scale * Fraction("0.008"))
                                   for k in (1, 1, 2)))
    text = sealed(with_tree(with_field(text, "depth", 99), "2P" + tree))
    statuses = [run(text, "--sample", "3")[0] for _ in range(3)]
    assert 4 in statuses and set(statuses) <= {4, 5}
    status, out, err = run(text)
    assert (status, out) == (5, "") and "proved leaf 1 of" in err


def part_of(text):
    for name in ("v0", "v1"):
        text = with_field(text, name, "1 0.25")
    return sealed(text)


def test_part_of_the_torus_is_said_to_be_a_part(texts, run):
    text = part_of(texts["trig274"])
    status, out, _ = run(text)
    assert status == 3 and out.startswith("Verified, for a part of the torus only :")
    assert run(text, "--sample", "3")[0] == 4
    assert "no other y' was examined" in out
    assert "\n0.75 <= v0 / pi <= 1.25\n" in out


@pytest.mark.parametrize("centre", ["1e30", "-123456789012345678901234567890.5", "0", "3"])
def test_angles_count_modulo_the_circle(texts, run, centre):
    text = texts["trig278"]
    for name in ("v0", "v1"):
        text = with_field(text, name, centre + " 1.5")
    assert run(sealed(text))[0] == 0


# ---- rejected: the file is wrong; not confirmed: the claim is, or the checker is too weak


CONTINUE = "; converse -r FILE goes on with the search\n"


@pytest.mark.parametrize("tree, why", [
    ("S", "mirror image"), ("0PS", "mirror image"), ("0SS", "mirror"),
    ("", "incomplete: 1 of its parts are missing" + CONTINUE),
    ("0P", "incomplete: 1 of its parts are missing" + CONTINUE), ("PP", "ends before"),
    ("0PPP", "ends before"), ("U", "undecided"), ("0PU", "undecided"), ("2PPP", "ends before"),
    ("2P", "incomplete"), ("p", "not a node"), ("0 PP", "not a node"),
    ("6PP", "'6' is not a node of a finished tree, at node 0\n"),
    ("?", "not a node of a finished tree, at node 0" + CONTINUE), ("3P?", "not a node"),
    ("4?P", "not a node"),
    ("0" * 1200, "the checker's limit"), ("0" * 40 + "P" * 41, "depth")])
@pytest.mark.quick
def test_trees(texts, run, tree, why):
    status, _, err = run(sealed(with_tree(texts["trig278"], tree)))
    assert status == (5 if "limit" in why else 1) and why in err


def test_a_search_that_had_not_begun(texts, run):
    text = re.sub("xstar: .*\n", "", texts["trig278"])
    assert run(sealed(text)) == (1, "", "converse-check: FILE: rejected: the search had not begun "
                                 "when it was left; converse -r FILE begins it\n")


@pytest.mark.parametrize("name", ["beginning", "point", "box", "narrow box", "slanted box"])
def test_at_once_flipped(moving, run, name):
    status, out, err = run(sealed(with_field(moving[name], "at once", "yes")))
    assert (status, out) == (5, "") and "not confirmed: that larger parameters are" in err
    assert run(with_field(moving[name], "at once", "yes"))[2].count("wrong checksum") == 1
    assert "multiple" not in run(sealed(with_field(moving["segment"], "at once", "no")))[1]


@pytest.mark.parametrize("status, why, name, value", [
    (1, "symmetric", "a", "0.3085 0.3"), (1, "symmetric", "b", "0.3086 0.00125"),
    (5, "not excluded", "c", "0.617 0.617"), (5, "not excluded", "c", "0 0.0025"),
    (1, "negative", "v1", "1 -0.5"), (1, "wave 1", "a", "0.3085"), (1, "wave 1", "a", "nan 0"),
    (1, "symmetric", "v0", "1 0.5"), (1, "symmetric", "v1", "0.5 1"),
    (1, "symmetric", "v0", "1.1 1"), (1, "symmetric", "xstar", "0.8 0.82773291385109182"),
    (5, "not excluded", "xstar", "0 0"), (5, "not excluded", "xstar", "-0.8 -0.8"),
    (5, "out of range", "c", "1e999 0"), (5, "out of range", "v0", "1 1e301"),
    (5, "out of range", "v0", "-1e301 1"), (1, "depth", "depth", "11"),
    (1, "not meant as a proof", "kind", "as printed, not a proof"),
    (1, "not meant", "kind", "Sound"), (5, "arithmetic", "xstar", "1e300 1e300"),
    (1, "wave 1", "a", "0.3085 0.00125 0"), (1, "two decimal", "v0", "1"),
    (5, "characters", "a", "1" * 3001 + " 0"), (1, "symmetric", "a", "0.3085 1e-999"),
    (5, "bits", "c", "0.617 0." + "0" * 990 + "1e-999"), (5, "too large", "c", "1e300 0"),
    (1, "wave 3", "c", "\u0660.617 0"), (1, "depth", "depth", "9" * 19),
    *[(1, name, name, value) for name in ("cuts", "proved", "symmetric", "undecided", "most_cuts")
      for value in ("12345", "-1", "x", "1.0", "")]])
@pytest.mark.quick
def test_header(texts, run, status, why, name, value):
    """Whatever is in it: an answer soon, and in one line."""
    text = with_field(texts["trig274"], name, value)
    found, out, err = run(text)
    assert (found, out) == (1, "") and "wrong checksum" in err
    found, out, err = run(sealed(text))
    assert (found, out) == (status, "") and why in err and err.count("\n") == 1
    assert ("rejected: " in err) == (status == 1) and ("not confirmed: " in err) == (status == 5)


def test_header_lines(texts, run):
    """Each field once, in any order, and the seconds may be missing, as may be comments."""
    text = texts["trig278"]
    head, tree, rest = text.partition("\ntree:\n")
    first, *lines = head.split("\n")
    for other in (lines[::-1], sorted(lines), [x for x in lines if not x.startswith("seconds:")],
                  lines + ["comment: "] * 3, lines + ["seconds: 1"] * ("seconds:" not in head)):
        assert run(sealed("\n".join([first, *other]) + tree + rest))[0] == 0
    for other, why in ((text.replace("depth:", "deepth:"), "unknown meaning"),
                       (text.replace("depth: 30\n", ""), "lacks depth"),
                       (text.replace("depth: 30\n", "depth: 30\ndepth: 30\n"), "twice"),
                       (text.replace("alone: no", "alone: perhaps"), "neither no nor 0"),
                       (text.replace("at once: no", "at once: No"), "neither yes nor no"),
                       (text.replace("alone: no\n", ""), "lacks alone"),
                       (text.replace("at once: no\n", "at once: no\nat once: yes\n"), "twice"),
                       (text.replace("\ntree:\n", "\ntrees:\n"), "no line 'tree:'")):
        status, _, err = run(sealed(other))
        assert status == 1 and why in err
    status, _, err = run(re.sub("sha256 .", "sha256 g", text))
    assert status == 1 and "checksum" in err


@pytest.mark.parametrize("data", [b"", b"\x00\xff\xfe junk" * 99, b"\x1f\x8b", b"\x1f\x8b\x08junk",
                                  b"tree", b"\xef\xbb\xbfconverse proof 6\n",
                                  bytes(range(256)) * 10])
def test_unreadable(run, data):
    status, out, err = run(data)
    assert (status, out) == (2, "") and err.count("\n") == 1


def test_other_versions_and_line_ends(texts, run):
    release = re.search("program: converse (.*)", texts["trig278"])[1]
    for version in ("1", "2", "3", "4", "5", "7", "6.0", "", "66" * 999):
        status, _, err = run(texts["trig278"].replace("proof 6", "proof " + version))
        assert status == 2 and err.count("\n") == 1
        assert (" is a proof file of another version, which converse %s reads (pip install "
                "converse-kam==%s)\n" % (release, release) in err) == (len(version) == 1), err
    status, _, err = run(re.sub("(?m)^program: .*", "program: x", texts["trig278"]).replace(
        "proof 6", "proof 9"))
    assert status == 2 and "another version, which another release of converse reads" in err
    status, _, err = run('{"format": 3, "program": "converse 5.2.0", "region": "k"}')
    assert status == 2 and " is a map of another version, which converse 5.2.0 reads (" in err
    assert run('{"harmonics": []}')[0] == 2
    status, _, err = run(texts["trig278"].replace("\n", "\r\n"))
    assert status == 1 and "CR LF" in err
    assert run(texts["trig278"].replace("\n", "\r"))[0] == 2
    assert run("converse proof 6\n")[0] == run(b"converse proof 6\n\xff")[0] == 1


@pytest.mark.parametrize("control", [
    "\x00", "\x0b", "\x1b[31m", "\x1c", "\x7f", "\x85", "\x9b", "\r"])
@pytest.mark.quick
def test_no_control_character_stands_in_a_header(texts, run, control):
    text = texts["trig278"].replace("\ntree:", "\ncomment: tabs\tare text, \u03b5 \u00e9\ntree:")
    assert run(sealed(text))[0] == 0
    status, out, err = run(sealed(text.replace("are text", control)))
    assert (status, out) == (1, "") and "contains a control character" in err


def test_the_longest_numbers_of_an_input_are_within_the_limits_of_the_checker(run, tmp_path):
    """A sum of two numbers may have more characters than each of them."""
    source = {"v0": ["1." + "7" * 990 + "e-300", "0.5"], "harmonics": [
        {"k": [1], "amplitude": "4." + "3" * 998}]}
    (tmp_path / "a.json").write_text(json.dumps(source))
    prove(read_input(tmp_path / "a.json")).save(tmp_path / "proof")
    text = (tmp_path / "proof").read_text(encoding="utf-8")
    assert max(map(len, text.split())) > 1000
    assert run(text)[::2] == (3, "")


def test_nothing_of_the_file_is_echoed(texts, run, tmp_path, capsys):
    """No escape sequence, no line of the file's own making, in whatever field and whatever name."""
    evil = "\x1b[2J\r\u202e\x9bVerified :\u2028"
    text = texts["trig278"]
    for changed in (text.replace("\ntree:\n", "\ncomment: %s\ntree:\n" % evil),
                    text.replace("\ntree:\n", "\n%s: 1\ntree:\n" % evil),
                    text.replace("\ntree:\n", "\n%s\ntree:\n" % evil),
                    text.replace("\ntree:\n", "\ntree:\n%s" % evil),
                    *(with_field(text, name, evil) for name in sorted(check.FIELDS))):
        status, out, err = run(sealed(changed))
        for output in (out, err):
            assert output.replace("\n", "").isprintable() and "Verified :" not in output[10:]
        assert out.count("\n") <= 18 and err.count("\n") == (status != 0)
    path = tmp_path / (evil.replace("/", "") + "\udcff")
    path.write_text(text, encoding="utf-8")
    for arguments in ([str(tmp_path / "missing") + evil], [str(path), "--jobs", evil],
                      [str(path), evil]):
        assert check.main(arguments) == 2
        out, err = capsys.readouterr()
        assert out == "" and err[:-1].isprintable()
    assert check.main([str(path)]) == 0


@pytest.mark.parametrize("start, filler, status", [
    (b"", b"\n", 2), (b"converse proof 6\n", b"\0", 5),
    (b"converse proof 6\ntree:\n", b"0P", 5)])
def test_a_bomb_is_bounded(one_file, tmp_path, start, filler, status):
    """A file of kilobytes that unpacks to gigabytes, in a process with a gigabyte."""
    path = tmp_path / "bomb.gz"
    part = gzip.compress(filler * (1 << 20), 9)
    path.write_bytes(gzip.compress(start) + part * (1 + (300 << 20) // (len(filler) << 20)))
    done = alone(one_file, path, before="import resource; "
                              "resource.setrlimit(resource.RLIMIT_AS, [1 << 30] * 2)")
    assert (done.returncode, done.stdout) == (status, "") and done.stderr.count("\n") == 1
    assert "limit" in done.stderr or "not a proof file" in done.stderr


def test_long_lines_and_deep_trees_are_bounded(texts, run, monkeypatch):
    monkeypatch.setattr(check, "MAX_LINE", 1 << 16)
    text = with_field(with_field(texts["trig278"], "depth", "9" * 18), "at once", "yes")
    for line in ("comment: " + "x" * check.MAX_LINE, "comment: " + "\u2028" * check.MAX_LINE):
        status, _, err = run(sealed(text.replace("\ntree:\n", "\n%s\ntree:\n" % line)))
        assert status == 5 and "limit" in err
    for tree, status in (("0" * 1000 + "P" * 1001, 0), ("0" * 1001 + "P" * 1002, 5),
                         ("234" * 50 + "P" * 151, 0), ("0" * 10 ** 5, 5), ("P" * 10 ** 5, 1)):
        assert run(sealed(with_tree(text, tree)))[0] == status


def test_what_is_no_file(tmp_path, capsys):
    for path in ("/dev/zero", "/dev/null", tmp_path, tmp_path / "missing", tmp_path / ("x" * 999)):
        assert check.main([str(path)]) == 2
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    assert check.main([str(loop)]) == 2
    assert capsys.readouterr().err.count("\n") == 6


def test_damaged_gzip(texts, run):
    data = gzip.compress(texts["trig272"].encode())
    for n in (len(data) - 1, len(data) - 9, len(data) // 2, 12, 5):
        assert run(data[:n])[0] == 2
    generator = random.Random(1)
    for _ in range(100):
        n = generator.randrange(10, len(data))
        bad = data[:n] + bytes([data[n] ^ 1 << generator.randrange(8)]) + data[n + 1:]
        assert run(bad)[0] in (1, 2)


def test_arguments(tmp_path, capsys):
    for arguments in ([], ["a", "b"], ["--jobs", "0", "x"], ["--sample", "x", "x"], ["--what"],
                      [str(tmp_path)], [str(tmp_path / "missing")], ["a\0b"], [""]):
        assert check.main(arguments) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1
    assert check.main(["--version"]) == 0


def alone(one_file, *arguments, before="", stdin=None):
    """Runs a process that has nothing but Python and the one file."""
    code = before + "; import runpy, sys; sys.argv = sys.argv[1:]; " \
        "runpy.run_path(sys.argv[0], run_name='__main__')"
    return subprocess.run([sys.executable, "-I", "-S", "-c", code.lstrip("; "), one_file,
                           *map(str, arguments)], capture_output=True, text=True, stdin=stdin,
                          env=PLAIN)


# ---- its other form, one file

FOLDER = os.path.dirname(package.__file__)


def made(home):
    """What `make checker` makes of the sources of the checker in a folder."""
    subprocess.run(["make", "-s", "-C", home, "checker", "PYTHON=" + sys.executable], check=True,
                   stdout=subprocess.DEVNULL)
    return home / "build" / "converse-check.pyz"


@pytest.fixture(scope="module")
def sources(root, tmp_path_factory):
    """A folder with the Makefile and the sources of the checker alone."""
    home = tmp_path_factory.mktemp("sources")
    shutil.copy(root / "Makefile", home)
    shutil.copytree(FOLDER, home / "converse" / "check",
                    ignore=shutil.ignore_patterns("__pycache__"))
    return home


@pytest.fixture(scope="module")
def one_file(sources):
    return made(sources)


@pytest.mark.skipif(sys.version_info < (3, 10), reason="it cannot name its own modules")
@pytest.mark.quick
def test_it_imports_nothing_of_the_program(root):
    """Python's own modules, numpy, and its own: nothing else, however deep in a function."""
    for file in sorted((root / "converse" / "check").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level < 2, "%s, line %d" % (file, node.lineno)
                names = [node.module] if node.level == 0 else []
            elif isinstance(node, ast.Name):
                assert node.id not in ("__import__", "exec", "eval"), file
            for name in names:
                assert name.split(".")[0] in {*sys.stdlib_module_names, "numpy"}, (file, name)
            assert "import_module" not in str(getattr(node, "attr", "")), file


def test_the_one_file_says_the_same(texts, moving, diagram, one_file, run, tmp_path):
    """Of the same files, good and bad, one with numpy and the next without; word for word."""
    bad = with_field(texts["trig274"], "c", "0.617 0.618")
    large = sealed(with_field(texts["trig278"], "a", "1e200 0"))
    cases = [part_of(texts["trig278"]), diagram, bad, large, "junk",
             moving["narrow box"]]
    path, statuses = tmp_path / "some.proof", set()
    fast, exact = (("-I",), ("--jobs", "2")), (("-I", "-S"), ("--exact",))
    for text, (isolated, options) in zip(cases, itertools.cycle((fast, exact))):
        status, out, err = run(text, *options)
        statuses.add(status)
        done = subprocess.run([sys.executable, *isolated, one_file, path, *options],
                              capture_output=True, text=True, env=PLAIN, cwd=tmp_path)
        found = done.returncode, done.stdout, done.stderr.replace(str(path), "FILE")
        assert found == (status, out, err)
    assert statuses == {0, 1, 2, 3, 5}


def test_help_names_every_status(capsys):
    assert check.main(["--help"]) == 0
    out = capsys.readouterr().out
    for status, word in enumerate(("verified", "rejected", "bad usage", "part of the torus",
                                   "spot check", "not confirmed")):
        assert re.search("(?m)^  %d  .*%s" % (status, word), out)


@pytest.mark.parametrize("stream", [">&-", "> /dev/full", "2>&-", ">&- 2>&-"])
def test_streams_that_are_closed_or_full(texts, one_file, tmp_path, stream):
    """No success without a report, and no traceback."""
    path = tmp_path / "x"
    path.write_text(texts["trig278"], encoding="utf-8")
    done = subprocess.run(["bash", "-c", "set -o pipefail; \"$@\" " + stream, "-", sys.executable,
                           one_file, path], capture_output=True, text=True)
    assert "Traceback" not in done.stderr and done.stderr.count("\n") <= 1
    assert done.returncode == 0 if stream == "2>&-" else done.returncode == 2


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], []])
@pytest.mark.parametrize("form", ["package", "one file"])
def test_a_reader_that_has_enough_is_no_failure(texts, one_file, tmp_path, form, arguments):
    path = tmp_path / "x"
    path.write_text(texts["trig278"], encoding="utf-8")
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, *(["-m", "converse.check"] if form == "package" else
                                             [one_file]), *(arguments or [path])],
                          stdout=write, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "PYTHONUNBUFFERED": ""})
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


# ---- the pages of the formats

def test_the_example_of_the_format(root, run):
    page = (root / "docs/reference/proof-file.md").read_text(encoding="utf-8")
    example = page[page.rindex("    converse proof 6\n"):].split("\n\n")[0]
    status, out, _ = run("".join(line[4:] + "\n" for line in example.split("\n")))
    assert status == 0 and out.startswith("Verified :")


def test_the_format_names_what_the_checker_knows(root, texts, monkeypatch):
    """Each field, each limit, each status; and nothing that is in no file."""
    monkeypatch.undo()                          # the limits themselves
    page = (root / "docs/reference/proof-file.md").read_text(encoding="utf-8")
    header = page[page.index("## The header"):page.index("## The tree")]
    names = set(re.findall("`([^`\n]+)`", header)) - {"sound", "yes", "no", "0", "1", "3",
                                                      "upper end", "as printed, not a proof"}
    assert names == check.FIELDS | check.OPTIONAL
    fields = (root / "docs/reference/map-file.md").read_text(encoding="utf-8")
    names = re.findall("(?m)^\\| ((?:`[a-z]+`,? ?)+) \\|", fields.partition("## What")[0])
    assert set(re.findall("`([a-z]+)`", " ".join(names))) == (
        check.DIAGRAM.needed | check.DIAGRAM.optional)
    for value in (check.MAX_CHARACTERS, check.MAX_CUTS, check.MAX_BITS, check.MAX_SITES,
                  check.MAX_PIECES, check.MAX_HALVINGS):
        assert re.search("\\b{:,}\\b".format(value), page[page.index("limits: "):])
    assert 1 << 28 == check.MAX_BYTES and 1 << 24 == check.MAX_LINE and 10 ** 300 == check.MAX_SIZE
    for status in range(6):
        assert "\n| %d | " % status in page


# ---- interruptions and processes

@pytest.fixture(scope="module")
def long(moving, tmp_path_factory):
    """A proof file whose check takes a second or two, and the pieces that it takes."""
    path = tmp_path_factory.mktemp("long") / "proof"
    path.write_text(moving["segment"], encoding="utf-8")
    return path, re.search("in [0-9]+ pieces", check.verify(path, exact=True).text).group()


def test_a_signal_that_waited():
    """As a library the checker leaves signals as they were, whoever's handler raises."""
    for handler in (signal.default_int_handler, check.interrupt):
        before, waited = signal.signal(signal.SIGINT, handler), False
        try:
            with pytest.raises(KeyboardInterrupt), check.undisturbed():
                signal.pthread_kill(threading.get_ident(), signal.SIGINT)
                time.sleep(0.01)                # not here
                waited = True
        finally:
            for number in check.SIGNALS:
                signal.signal(number, signal.SIG_DFL)
            signal.signal(signal.SIGINT, before)
        assert waited and check._late is None and not signal.pthread_sigmask(signal.SIG_BLOCK, [])


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_killed_at_random_moments(long, tmp_path, generator, jobs):
    """It ends with the status of its signal and one line, and leaves no process and no file."""
    path, pieces = long
    kinds = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL]
    code = """
import signal
signal.signal(2, signal.SIG_DFL)                # as Python starts and ends
import sys
sys.path.insert(0, sys.argv.pop(1))
from check import main, progress
progress.LINE_SECONDS = 1e9
print(flush=True)
sys.exit(main())
"""
    command = [sys.executable, "-I", "-c", code, os.path.dirname(FOLDER), path, "--jobs", jobs,
               "--exact"]
    for n in range(12 * min(TORTURE, 2)):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, start_new_session=True, cwd=tmp_path)
        process.stdout.readline()
        kind = kinds[n % 4]
        time.sleep(0.5 * generator.random())
        if process.poll() is None:
            (os.killpg if n % 3 else os.kill)(process.pid, kind)
        out, err = process.communicate(timeout=PATIENCE)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            for _ in range(10 * PATIENCE):              # a worker that is left ends by itself
                os.killpg(process.pid, 0)
                time.sleep(0.1)
            raise AssertionError("a process is left")
        assert "Traceback" not in err and err.count("\n") <= 1
        if out:                                 # it is done, even if struck after its last word
            assert pieces in out
        elif n % 3 and "a worker process died" in err:
            assert process.returncode == 2          # the whole group was struck, a worker first
        else:
            assert process.returncode in (-kind, 128 + kind), err
            assert process.returncode < 0 or "interrupted; nothing was verified" in err
        assert not os.listdir(tmp_path)


def test_a_worker_that_dies(deep, run, monkeypatch):
    """It is said, and nothing is verified."""
    left = tree_of(deep).count("P") - 100
    last = [cell for at, cell in check.leaves(tree_of(deep)) if tree_of(deep)[at] == "P"][left]
    with monkeypatch.context() as patch:
        patch.setattr(check, "START", start_of_workers("""if True:
            import os
            from converse.check.criterion import Criterion
            excluded = Criterion.excluded
            Criterion.excluded = lambda self, cell: (
                os._exit(3) if cell == %r else excluded(self, cell))
            """ % (last,)))
        status, out, err = run(deep, "--jobs", "2", "--exact")
    assert (status, out) == (2, "")
    assert "a worker process died, perhaps for lack of memory; nothing was verified\n" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("method", ["spawn", "forkserver", "fork"])
def test_processes_never_run_the_main_module(texts, tmp_path, method):
    """A script without a guard, whatever it says of how multiprocessing is to start processes."""
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("multiprocessing has no %s here" % method)
    path, script = tmp_path / "proof", tmp_path / "script.py"
    path.write_text(texts["trig274"], encoding="utf-8")
    script.write_text("""if True:
        import multiprocessing, sys
        print("the script runs")
        multiprocessing.set_start_method(sys.argv[1])
        from converse import check
        print(check.verify(sys.argv[2], jobs=2, exact=True).verdict)
        """, encoding="utf-8")
    done = subprocess.run([sys.executable, script, method, path], capture_output=True, text=True,
                          timeout=PATIENCE)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "the script runs\nverified\n"


def test_a_worker_whose_numpy_is_not_sound_uses_integers(np, texts, run, monkeypatch):
    """However sound it was in the parent."""
    exact = run(texts["trig274"], "--exact")[1]
    assert "Method : Loewner criterion, multipliers, in integers" in exact
    monkeypatch.setattr(check, "FAST_CHUNK", (16, 32))
    monkeypatch.setattr(check, "START", start_of_workers("""if True:
        import os
        from converse.check import lockstep, workers
        workers.import_numpy_if_sound = lambda: False
        lockstep.Lockstep.settle = lambda *_: os._exit(3)
        """))
    assert run(texts["trig274"], "--jobs", "2") == (0, exact, "")


def test_narrow_cells_do_not_make_the_bound_of_beta_slow(texts, tmp_path, monkeypatch):
    """Cells of width 1e-999 need 3,400 bits; B needs no more than 256 to be as good."""
    torus_bound, bits = check.torus_bound, []

    def bound(fixed, *rest):
        bits.append(fixed.bits)
        return torus_bound(fixed, *rest)

    monkeypatch.setattr(check, "torus_bound", bound)
    found = []
    for text in texts["trig278"], sealed(with_field(texts["trig278"], "v0", "0.5 1e-999")):
        (tmp_path / "proof").write_text(text, encoding="utf-8")
        criterion = check.Criterion(check.read(tmp_path / "proof"))
        found.append(Fraction(criterion.B, criterion.fixed.one))
    assert criterion.fixed.bits > 3000 and max(bits) == 256 and len(bits) == 2
    assert abs(found[0] - found[1]) < Fraction(1, 2 ** 80)


def test_a_failure_of_its_own_is_no_success(deep, run, monkeypatch):
    for error in (MemoryError(), OSError(11, "Resource temporarily unavailable"), KeyError("x")):
        def fails(self, cell):
            raise error
        monkeypatch.setattr(check.Criterion, "excluded", fails)
        monkeypatch.setattr(check.Lockstep, "attempt", lambda *_: fails(*_[:2]))
        for options in ((), ("--exact",)):
            status, out, err = run(deep, *options)
            assert (status, out) == (2, "") and "the checker failed" in err
            assert err.count("\n") == 1


def test_the_bar(deep, tmp_path, monkeypatch, capsys):
    """On a terminal; it says how many leaves are confirmed and goes away."""
    path = tmp_path / "x"
    path.write_text(deep, encoding="utf-8")
    monkeypatch.setattr(check, "BAR_SECONDS", 1e-3)
    assert check.main([str(path)]) == 0
    assert capsys.readouterr().err == ""                # a line is not due yet
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    for options, shown in ((["--quiet"], False), ([], True)):
        assert check.main([str(path), *options]) == 0
        err = capsys.readouterr().err
        assert (" leaves" in err) == shown
    steps = [int(n.replace(",", "")) for n in re.findall("\r0:00:[0-9]{2} ([0-9,]+) of", err)]
    assert steps == sorted(steps)
    assert err.endswith("\r" + " " * (len(err.split("\r")[-4])) + "\r")


def test_lines_where_there_is_no_terminal(deep, run, monkeypatch, tmp_path, capsys):
    """Now and then, also while a task is not done; not in quiet, and not from Python unless asked
    for."""
    monkeypatch.setattr(check, "LINE_SECONDS", 0.01)
    status, out, err = run(deep, "--exact")
    assert status == 0 and out.startswith("Verified :")
    steps = [int(n.replace(",", "")) for n in re.findall(
        "(?m)^converse-check: 0:00:[0-9]{2} ([0-9,]+) of [0-9,]+ leaves$", err)]
    assert len(steps) == err.count("\n") > len(set(steps)) > 1 and steps == sorted(steps)
    assert run(deep, "--quiet") == (0, "", "")
    check.verify(tmp_path / "some.proof")
    assert capsys.readouterr() == ("", "")


# ---- from Python

def test_results_and_exceptions(texts, deep, tmp_path):
    path = tmp_path / "x"
    for text, options, status in (
            (texts["trig278"], {}, 0), (part_of(texts["trig274"]), {}, 3),
            (texts["trig278"], {"sample": 1}, 4), (texts["trig278"], {"jobs": 2}, 0)):
        path.write_text(text, encoding="utf-8")
        result = check.verify(path, **options)
        assert result.status == status and bool(result) == (status == 0)
        assert result.verdict == {0: "verified", 3: "verified in part", 4: "spot check"}[status]
    for text, failure in ((texts["trig278"][:-1], check.Rejected), ("x", check.Unusable),
                          (sealed(with_field(deep, "xstar", "0 0")), check.NotConfirmed)):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(failure):
            check.verify(path)
    for wrong in ({"jobs": 0}, {"sample": 0}, {"sample": -1}):
        with pytest.raises(ValueError):
            check.verify(path, **wrong)


@pytest.mark.parametrize("options", [(), ("--sample", "1")])
@pytest.mark.parametrize("kind", ["proof", "part", "diagram"])
@pytest.mark.quick
def test_nothing_is_verified_if_a_leaf_is_not_confirmed(texts, diagram, run, tmp_path, monkeypatch,
                                                        kind, options):
    """Whatever the reason, as here that the leaves are not looked at."""
    text = {"proof": texts["trig278"], "part": part_of(texts["trig274"]),
            "diagram": diagram}[kind]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(check, "check_leaves", lambda *_: (0, 0, 0))
    status, out, err = run(text, *options)
    assert (status, out) == (2, "") and re.search("the checker failed .RuntimeError: [01] of ", err)


# ---- where tori exist there is no theorem

@pytest.mark.parametrize("a", ["0", "0.0011", "0.011", "0.05", "0.11", "0.15"])
@pytest.mark.parametrize("tree", ["P", "01PP1PP"])
def test_forged(texts, run, a, tree):
    text = texts["trig278"]
    text = with_parameters(text, *((k * Fraction(a), 0) for k in (1, 1, 2)))
    status, out, err = run(sealed(with_tree(text, tree)))
    assert (status, out) == (5, "") and "leaf 1 of" in err and "not excluded" in err


def test_parameters_that_move_together_are_halved_together(texts, run):
    """Tori exist in the middle of this segment, where the map is a rotation.  With c alone halved,
    a and b would be followed from their lower to their upper ends while c is above (or below) 0."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("0", "20"), ("0", "20"), ("0", "22"))
    for name, value in (("v0", "-0.25 0.01"), ("v1", "-0.25 0.01"), ("together", "yes"),
                        ("xstar", "0.785398 0.785398")):
        text = with_field(text, name, value)
    assert "not excluded" in run(sealed(text))[2]


@pytest.mark.parametrize("tree", ["P", "22PP2PP"])
@pytest.mark.parametrize("centre, half", [
    ("0", "0.3"), ("-0.3", "0.3"), ("0.15", "0"), ("-0.15", "0.05"), ("1", "1"), ("1", "0.9999"),
    ("0", "0"), ("-1", "1.1")])
def test_forged_segments(texts, run, tree, centre, half):
    """Segments to, from or through where there are tori, in any cuts and any region."""
    text = with_field(with_tree(texts["trig278"], tree), "together", "yes")
    c, h = Fraction(centre), Fraction(half)
    text = with_parameters(text, (c, h), (c, h), (2 * c, 2 * h))
    for region in {"P": ("1 1", "0 0"), "22PP2PP": ("0 0.1", "1e9 3")}[tree]:
        for name in ("v0", "v1"):
            text = with_field(text, name, region)
        status, out, err = run(sealed(text))
        if status == 3:             # a single successor, and the truth
            assert (region, half) == ("0 0", "0")
            x0 = [mp.mpf("0.82773291385109182")] * 2
            assert not definite([real(k * c) for k in (1, 1, 2)], x0, [mp.mpf(0)] * 2, 20)
        else:
            assert (status, out) == (5, "") and "not excluded" in err
    status, out, err = run(sealed(with_field(text, "at once", "yes")))
    upper = 472 * (c + h) > 133             # B > 10/3 there
    assert (status, out) == (5, "")
    assert ("not excluded: " if upper else "that larger parameters are excluded at once") in err


# ---- the arithmetic against mpmath

FIXED = {bits: check.Fixed(bits) for bits in (64, 96, 131)}


def near(generator, places=60):
    """A random number in [-1, 1], exact, often special."""
    return Fraction(generator.choice((generator.randint(-2 ** places, 2 ** places),
                                      generator.choice((-1, 0, 1)) << places)), 1 << places)


def real(x):
    return mp.mpf(x.numerator) / x.denominator


@pytest.mark.parametrize("bits", FIXED)
@pytest.mark.quick
def test_sincos(bits, generator):
    fixed = FIXED[bits]
    unit = mp.mpf(2) ** -bits
    assert abs(fixed.pi - mp.pi / unit) < 2
    worst = 0
    for n in range(5000 * TORTURE):
        x = generator.randint(-1 << bits + n % 40, 1 << bits + n % 40)
        if n % 4 == 0:                      # next to the ends of the steps of the table
            x = generator.randint(-2400, 2400) * (fixed.step >> check.GUARD + 1) + x % 7 - 3
        s, c = fixed.sincos(x)
        worst = max(worst, abs(s - mp.sin(x * unit) / unit), abs(c - mp.cos(x * unit) / unit))
    assert 0.5 < worst < check.SINE_ERROR
    with pytest.raises(OverflowError):
        fixed.sincos(1 << bits + 42)


@pytest.mark.quick
def test_taylor_polynomials_of_small_angles():
    """They are within 4 units for angles up to 1/128, whichever term is the last."""
    for bits in range(64, 180):
        divisors, one = check.Fixed._divisors(bits), mp.mpf(2) ** bits
        for r in (1 << bits - 7, -1 << bits - 7, 100 + 5 ** 9 << bits - 30):
            c, s = check.Fixed._small(r, bits, divisors)
            assert abs(c - mp.cos(r / one) * one) < 4 and abs(s - mp.sin(r / one) * one) < 4


@pytest.mark.quick
def test_roots_and_eigenvalues(generator):
    for _ in range(4000):
        n = generator.randint(0, 1 << generator.randint(1, 200))
        root = check.upper_sqrt(n)
        assert root * root >= n and (root == 0 or (root - 1) ** 2 < n)
        p, q, r = (generator.randint(-1 << 66, 1 << 66) for _ in range(3))
        bound = check.largest([p, q, r])
        # bound I - [p q; q r] is positive semidefinite, and a little less is not
        assert bound >= max(p, r) and (bound - p) * (bound - r) >= q * q
        less = bound - 2
        assert less < max(p, r) or (less - p) * (less - r) < q * q


ZERO = Fraction(0)
TRIG = tuple((k, ZERO) for k in check.THESIS)       # k and phase of the thesis's waves
OTHERS = (((1, -1), ZERO), ((2, 1), Fraction(1, 3)), ((3, 0), Fraction(-7, 5)), ((0, 2), ZERO),
          ((1, 0), Fraction(1, 2)), ((-1, 4), Fraction(17, 12)), ((1, 1), ZERO), ((0, 1), ZERO),
          ((1, 0), ZERO), ((5, -3), Fraction(1, 7)))


def some_waves(generator):
    """(k, phase) of the thesis's waves, or of others."""
    return TRIG if generator.random() < 0.4 else tuple(
        generator.sample(OTHERS, generator.randint(1, 5)))


def angle_at(wave, y, m=mp):
    k, phase = wave
    turn = m.pi * real(phase) if m is mp else math.pi * float(phase)
    return sum(a * b for a, b in zip(k, y)) + turn


def v_prime(waves, amplitudes, y, m=mp):
    found = [0 for _ in y]
    for wave, p in zip(waves, amplitudes):
        c = p * m.cos(angle_at(wave, y, m))
        found = [x - k * c for x, k in zip(found, wave[0])]
    return found


def successor(waves, amplitudes, before, x, m=mp):
    return [2 * p - q - f for p, q, f in zip(x, before, v_prime(waves, amplitudes, x, m))]


def bent(waves, amplitudes, y, m=mp):
    """The entries of beta, row by row from the diagonal on."""
    b = [2 * (i == j) for i, j in check.pairs_of(len(waves[0][0]))]
    for wave, p in zip(waves, amplitudes):
        s = p * m.sin(angle_at(wave, y, m))
        b = [x - k * s for x, k in zip(b, check.entries(wave[0]))]
    return b


def in_form(b, n):
    return sum(x * m for x, m in zip(check.times(b, n), n))


def in_units(fixed, waves):
    return [(k, fixed.angle(phase)) for k, phase in waves]


FRAMES = (1, 0, 0, 1), (1, 1, -1, 0), (2, 1, 3, 2), (0, -1, 1, 0)


def in_frame(frame, v):
    """The frame, whose integers are row by row, times v."""
    return [sum(f * x for f, x in zip(frame[at:], v)) for at in range(0, len(frame), len(v))]


def exact_decimal(generator, size, places=9):
    return Fraction(generator.randint(-10 ** places, 10 ** places), 10 ** places) * Fraction(size)


def as_text(x):
    return check.decimal_text(Fraction(x))


def general(text, waves, v0=(1, 1), v1=(1, 1), frame=check.IDENTITY, alone="no", odd="no",
            at_once="no", tree=None, xstar=None):
    """A file of the rest of the text; waves: (k, phase, amplitude, parts)."""
    head, middle, rest = text.partition("\ntree:\n")
    lines = [line for line in head.split("\n")[1:] if line.partition(":")[0] not in (
        "v0", "v1", "at once", "wave", "frame", "alone", "odd about")]
    lines += ["wave: %d %d %s %s" % (*k, phase, " ".join(map(as_text, (p, *parts))))
              for k, phase, p, parts in waves]
    lines += ["v0: %s %s" % tuple(map(as_text, v0)), "v1: %s %s" % tuple(map(as_text, v1)),
              "frame: %d %d %d %d" % frame, "alone: " + alone, "odd about: " + odd,
              "at once: " + at_once]
    text = "\n".join(["converse proof 6", *lines]) + middle + rest
    if xstar:
        text = with_field(text, "xstar", "%s %s" % tuple(map(as_text, xstar)))
    return sealed(with_tree(text, tree) if tree else text)


def random_claim(generator, text, size=1, width=1, three=None):
    """Any parameters, one in four of them without width, and any region of angles: of the thesis's
    waves, or of any and a frame."""
    sides = [(exact_decimal(generator, 9), abs(exact_decimal(generator, width))
              * generator.choice((0, 1, 1, 1))) for _ in "01"]
    if three if three is not None else generator.random() < 0.6:
        waves, parts = some_waves(generator), generator.randint(0, 3)
        # Of a finite number of decimals, and the less the more the wave turns.
        return general(text, [(k, phase, exact_decimal(generator, size) / 2 ** sum(map(abs, k)),
                               [exact_decimal(generator, width) / 2 * generator.choice((0, 1, 1))
                                for _ in range(parts)]) for k, phase in waves],
                       *sides, generator.choice(FRAMES))
    for name, side in zip(("v0", "v1"), sides):
        text = with_field(text, name, "%s %s" % tuple(map(as_text, side)))
    text = with_parameters(text, *((exact_decimal(generator, size), abs(
        exact_decimal(generator, width)) * generator.choice((0, 1, 1, 1))) for _ in "abc"))
    return with_field(text, "together", generator.choice(("yes", "no")))


def random_slice(generator, most):
    k = generator.randint(0, most)
    return generator.choice((0, (1 << k) - 1, generator.randrange(1 << k))), k


def random_cell(generator, claim, most=40):
    slices = [random_slice(generator, most) for _ in range(2 + claim.parameters)]
    return tuple(zip(*slices + [(0, 0)] * (6 - len(slices))))


def waves_of(claim):
    return [(wave.k, wave.phase) for wave in claim.examined]


def random_point(generator, claim, cell):
    """Exact amplitudes and v0, v1 of a cell, often at its ends."""
    eta = [near(generator) for _ in range(6)]
    along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, eta)]
    return ([wave.at(along[2:]) for wave in claim.examined],
            [c + h * t for c, h, t in zip(claim.centre, claim.half, along)])


def random_text(generator, text, tree="P", size=1, width=1):
    return random_claim(generator, with_tree(text, tree), size, width)


def with_shifts(generator, claim, width="0.1"):
    """The claim, or one whose region moves with some of its parameters, as those of parts may."""
    shifts = tuple([tuple([exact_decimal(generator, width) * generator.choice((0, 1, 1))
                           for _ in "01"]) for _ in range(claim.parameters)])
    return generator.choice((claim, dataclasses.replace(claim, shifts=shifts)))


def moved_by(claim, along):
    """What the parameters add to v0 and v1."""
    return [sum([shift[i] * t for shift, t in zip(claim.shifts, along[2:])]) for i in (0, 1)]


def random_prism(generator, texts, most=12, shift="0.1"):
    """(criterion, cell, prism) of the exact path; shift: how far a parameter may move x[1]."""
    while True:
        claim = claim_of(random_text(generator, texts["trig274"], "P", 1, "0.5"))
        claim = with_shifts(generator, claim, shift)
        if claim.examined:
            criterion, cell = check.Criterion(claim), random_cell(generator, claim, most)
            return criterion, cell, criterion.prism(cell)


def true_point(generator, criterion, cell, corner=False):
    """Symbols, and the amplitudes, x[0] and x[1] that they stand for, exact."""
    claim = criterion.reduced
    eta = [Fraction(generator.choice((-1, 1))) if corner else near(generator) for _ in range(6)]
    along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, eta)]
    v = [c % 2 + h * t + s for c, h, t, s in zip(claim.centre, claim.half, along,
                                                 moved_by(claim, along))]
    return ([eta[axis] for axis in criterion.axes], [wave.at(along[2:]) for wave in claim.examined],
            [[real(x) for x in claim.xstar], in_frame(claim.frame, [real(x) * mp.pi for x in v])])


@pytest.mark.quick
def test_prisms_cover_their_cells(texts, generator, monkeypatch):
    """The same symbols lead to all amplitudes and, modulo 2 pi, to both angles."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    tight = 0
    for _ in range(60 * min(TORTURE, 5)):
        criterion, cell, prism = random_prism(      # in 10^9 turns it counts that pi is off
            generator, texts, 40, generator.choice(("0.1", 10 ** 9)))
        one, turn = criterion.fixed.one, 2 * mp.pi * criterion.fixed.one
        for _ in range(5):
            eta, amplitudes, angles = true_point(generator, criterion, cell)
            for wave, true in zip(prism.waves, amplitudes):
                found = wave.amplitude + sum(part * eta[i] for i, part in wave.parts)
                size = abs(wave.amplitude) + sum(abs(part) for _, part in wave.parts)
                assert abs(true * one - found) < 1 + len(wave.parts)
                assert wave.error - 2 * (1 + len(wave.parts)) >= Fraction(
                    size * check.SINE_ERROR, one)
            for lane, true in zip(prism.lanes, angles[::-1]):
                for x, y, columns, rest in zip(lane.x, true, lane.first_columns, lane.first_rest):
                    gap = y * one - x - sum(a * real(e) for a, e in zip(columns, eta))
                    gap = abs((gap + turn / 2) % turn - turn / 2)
                    assert gap <= rest + 10 ** 10 * turn / one ** 2
                    tight += gap > rest / 20
    assert tight > 50


def pairs_of(eta):
    """What the quadratic parts of orbits are coefficients of, in their order."""
    return [x * y - Fraction(i == j, 2) for (i, x), (j, y) in
            itertools.combinations_with_replacement(enumerate(eta), 2)]


@pytest.mark.quick
def test_exact_orbits(texts, generator, monkeypatch):
    """True orbits of a prism are where the centres and columns say, within the errors; of its
    corners, where the models miss most, a tenth of the sites need a twentieth of that, or more."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    cases = tight = turned = 0
    for _ in range(60 * TORTURE):
        criterion, cell, prism = random_prism(generator, texts)
        one, waves = mp.mpf(criterion.fixed.one), waves_of(criterion.reduced)
        eta, amplitudes, angles = true_point(generator, criterion, cell, generator.random() < 0.7)
        amplitudes = [real(x) for x in amplitudes]
        if max(map(abs, criterion.reduced.frame)) > 1:
            angles[1] = [y + 2 * mp.pi * mp.nint((x / one - y) / (2 * mp.pi))
                         for x, y in zip(prism.lanes[0].x, angles[1])]
        shift = [mp.nint((x / one - y) / (2 * mp.pi)) * 2 * mp.pi
                 for x, y in zip(prism.lanes[0].x, angles[1])]
        angles[1] = [y + d for y, d in zip(angles[1], shift)]
        for lane, true in zip(prism.lanes, true_orbit(waves, amplitudes, angles, 20)):
            for x in true:
                gaps = [y * one - c - sum(a * real(e) for a, e in zip(
                            columns, [*eta, *pairs_of(eta)]))
                        for y, c, columns in zip(x, lane.x, lane.LT)]
                gaps = in_frame([*itertools.chain(*prism.turn.rows)], gaps)
                assert all(abs(gap) <= rest for gap, rest in zip(gaps, lane.r))
                if not lane.advance():
                    break
                cases += 1
                tight += any(abs(gap) > rest / 20 for gap, rest in zip(gaps, lane.r))
                turned += prism.turn.table is not None
    assert cases > 180 * TORTURE and tight > cases / 10 and turned > 20


@pytest.mark.quick
def test_one_bound_in_two_arithmetics(np, texts, generator, monkeypatch):
    """Doubles and integers choose the same vectors, and lead to the same value, error and bound,
    but for their roundings."""
    monkeypatch.setattr(check, "MAX_SITES", 60)
    monkeypatch.setattr(check, "FIRST_TRY_SITES", 60)
    cases = 0
    for _ in range(max(7, 12 * TORTURE)):
        criterion, cell, prism = random_prism(generator, texts, 9)
        l = criterion.least_pivot(cell)
        with np.errstate(all="ignore"):
            prisms = prisms_of(criterion.claim, l / criterion.fixed.one, cell)
            assert all(prisms.follow())
            value, _, most, error = prisms.expand()
            bound = value + most + error
        found, bounds = check.SecondVariation.bound, []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(check.SecondVariation, "bound",
                          lambda self: bounds.append(found(self)) or bounds[-1])
            check.attempt(prism, l, check.SITE_PENALTIES[0])
        if not bounds or not error[0] < 10:
            continue
        exact = [x / (6 << 4 * check.UNIT_BITS) for x in (
            bounds[-1][0], bounds[-1][1], bounds[-1][3])]
        for x, y in zip(exact, (bound[0], value[0], error[0])):
            assert x == pytest.approx(y, rel=1e-5, abs=1e-6)
        cases += 1
    assert cases > 2 * TORTURE


def definite(amplitudes, x0, x1, steps, m=mp, waves=TRIG):
    """Is the second variation along the true orbit, steps to either side, positive definite?"""
    back, ahead = [x1, x0], [x0, x1]
    for _ in range(steps):
        for orbit in (back, ahead):
            orbit.append(successor(waves, amplitudes, *orbit[-2:], m))
    d = None
    for y in back[:0:-1] + ahead[1:]:
        p, q, r = bent(waves, amplitudes, y, m)
        if d:
            det = d[0] * d[2] - d[1] ** 2
            p, q, r = p - d[2] / det, q + d[1] / det, r - d[0] / det
        if p <= 0 or p * r <= q * q:
            return False
        d = p, q, r
    return True


# ---- the fast path

@pytest.fixture(scope="module")
def np():
    assert check.import_numpy_if_sound()
    return check.np


def prisms_of(claim, l=0.9, cell=check.ROOT):
    """The prism of a cell, followed by nobody yet."""
    fast, number = check.Lockstep([claim]), check.np.zeros(1, int)
    return check.Prisms(fast.box(*cells_of([cell]), number), fast.shape, fast.xstar[:, number],
                        check.np.array([l]))


def random_prisms(np, generator, count=8, scale=1.0):
    """Prisms of any kind, from needles to parallelograms, of the thesis's waves or others, with
    parameters that move many waves or one or none, and x[1], or not; in some lanes a wave may be
    missing."""
    waves = some_waves(generator)
    moving = generator.choice((
        [(w, 0) for w in range(len(waves))], [(w, w % 3) for w in range(len(waves))], [],
        [(w, m) for w in range(len(waves)) for m in range(3)], [(0, 0)]))
    parameters = max([m + 1 for _, m in moving] + [generator.choice((0, 0, 1, 3))])
    shape = check.Shape(waves, moving, parameters + 2)
    draw = np.random.default_rng(generator.getrandbits(64))
    P, width = np.zeros((len(waves), count)), 2.0 ** draw.uniform(
        generator.choice((-40, -7)), -2, count)
    for w, (k, _) in enumerate(waves):
        P[w] = draw.uniform(-scale, scale, count) / (abs(k[0]) + abs(k[1]))
    if generator.random() < 0.3:
        P[generator.randrange(len(waves))] *= draw.integers(0, 2, count)
    h = np.zeros((len(P), shape.parameters, count))
    for w, symbols in enumerate(shape.moving):
        for m in symbols:
            h[w, m] = abs(P[w]) * draw.uniform(-1, 1, count) * width
    W = abs(P) * generator.choice((0, 2.0 ** -50, 2.0 ** -30, 2.0 ** -8))
    x = draw.uniform(-0.5, 0.5, (2, count))
    sides = draw.uniform(0, 1, (2, count)) * width * generator.choice((1, np.array([[1], [0]])))
    frame = np.array(generator.choice(FRAMES), float).reshape(2, 2, 1)
    columns = draw.uniform(-1, 1, (2, parameters, count)) * width
    columns *= generator.choice((0, 0, 1))
    columns = np.concatenate((columns, frame * sides), axis=1)
    off = draw.uniform(0, 1, (2, count)) * width * generator.choice((0, 0, 2.0 ** -20, 2.0 ** -45))
    xstar = np.array([[generator.choice((0.25, draw.uniform(-0.5, 0.5)))] for _ in "01"]) \
        + generator.choice((0, 0.1)) * draw.uniform(-0.5, 0.5, (2, count))
    amplitudes = np.array([[check.units_of(Fraction(float(p)), check.AMPLITUDE_BITS) for p in row]
                           for row in P], object)
    return check.Prisms((check.in_turns(amplitudes), h, W, check.whole(x), columns, off), shape,
                        check.whole(xstar), draw.uniform(0, 0.9, count))


def inside(generator, prisms, lane, eta=None):
    """A point of the prism of a lane ahead: its symbols, exact parameters, x[0] and x[1]."""
    eta = eta or [near(generator) for _ in range(prisms.known)]
    amplitudes = []
    for most, rest, h, W in zip(*prisms.turns[:2], prisms.h, prisms.W):
        turns = Fraction(int(most[lane]), 1 << 38) + Fraction(float(rest[lane])) * (1 << 26)
        amplitudes.append(2 * mp.pi * real(turns) + real(
            Fraction(float(W[lane])) * near(generator)
            + sum(Fraction(float(x)) * e for x, e in zip(h[:, lane], eta))))
    angles = []
    for units, rest, columns in (
            (prisms.before[0], prisms.other(prisms.rounding), 0 * prisms.ends),
            (prisms.first[0], prisms.rounding, prisms.ends)):
        angles.append([
            2 * mp.pi * real(Fraction(int(units[i, lane]), 1 << 64)) + real(
                Fraction(float(rest[i, lane])) * near(generator)
                + sum(Fraction(float(x)) * e for x, e in zip(columns[i, :, lane], eta)))
            for i in (0, 1)])
    return eta, amplitudes, angles


def true_orbit(waves, amplitudes, angles, count, m=mp):
    """count sites ahead and count back, x[1] and x[0] the first of them."""
    lanes = []
    for before, x in (angles, angles[::-1]):
        lane = [x]
        while len(lane) < count:
            before, x = x, successor(waves, amplitudes, before, x, m)
            lane.append(x)
        lanes.append(lane)
    return lanes


def test_lockstep_sincos(np, generator):
    turns = [float(near(generator)) / 2 * 2.0 ** -generator.choice((0, 0, 0, 1, 9, 60, 300))
             for _ in range(3000)]
    turns += [k / 2048 + d for k in range(-1023, 1024, 8) for d in (-2.0 ** -40, 0, 2.0 ** -40)]
    errors = []
    for waves in (TRIG, OTHERS, (((100, -99), Fraction(1, 3)), ((-100, 100), Fraction(199, 100)))):
        shape = check.Shape(waves)
        X = check.whole(np.array([turns, turns[::-1]]))
        found = shape.turns(X)
        sines, cosines, close, low = check.lockstep_sincos(found)
        unit = mp.mpf(2) ** -53
        for n in range(0, X.shape[1], 1 if waves is TRIG else 7):
            y = [2 * mp.pi * mp.mpf(int(x)) / 2 ** 64 for x in X[:, n]]
            for w, wave in enumerate(shape.waves):
                angle = 2 * mp.pi * mp.mpf(int(found[w, n])) / 2 ** 64
                for value, function in ((sines, mp.sin), (cosines, mp.cos)):
                    value = mp.mpf(float(value[w, n]))
                    assert abs(value - function(angle)) <= 2 * unit
                    assert abs(value - function(angle_at((wave[0], Fraction(wave[1])), y))) \
                        <= 2.1 * unit
                fine = mp.mpf(int(close[w, n])) / 2 ** 26 + mp.mpf(float(low[w, n]))
                errors.append(abs(fine - mp.cos(angle)) / unit)
                assert abs(low[w, n]) < 1 / 320
    assert 1 / 200 < max(errors) <= 1 / 40
    assert check.SINE_ROUNDING == 24 * 2.0 ** -53


@pytest.mark.quick
def test_whole_turns(np, generator):
    """They are off by less than a unit of 2^-64 turns, at the ends of a turn, too."""
    turns = [generator.uniform(-1, 1) * 2.0 ** generator.randint(-80, 12) for _ in range(3000)]
    turns += [k / 2 + d for k in range(-3, 4) for d in (-2.0 ** -54, -2.0 ** -66, 0, 2.0 ** -54)]
    turns += [0.5 - 2.0 ** -54, 2.0 ** -54 - 0.5, 1.5 + 2.0 ** -52]
    with np.errstate(all="raise"):                  # if one did not fit
        units = check.whole(np.array(turns)).tolist()
    for x, found in zip(turns, units):
        off = (Fraction(x) * 2 ** 64 - found + 2 ** 63) % 2 ** 64 - 2 ** 63
        assert abs(off) < 1 and -2 ** 63 <= found < 2 ** 63


def what_an_error_adds(text, name):
    """An error of each step, and the rests of the hundredth site less those without the error."""
    for angle in "v0", "v1":
        text = with_field(text, angle, "1 0")
    rests = []
    for counted in (1, 0):
        prisms = prisms_of(claim_of(text))
        error = getattr(prisms, name)
        size = error.copy()
        error *= counted
        assert all(prisms.follow())
        rests.append(prisms.sites[100].rest[:2])
    return size, rests[0] - rests[1]


@pytest.mark.parametrize("c, factor", [("0", 1), ("2e-9", 2)])
@pytest.mark.quick
def test_roundings_of_each_step_are_counted(np, texts, c, factor):
    """Where columns are 0 and matrices nearly constant, N steps add up to N^2 / 2 times the error
    of one, in the frame of the angles; in the diagonal one each has both coordinates' errors."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("1e-9", "0"), ("1e-9", "0"), (c, "0"))
    push, counted = what_an_error_adds(text, "push")
    assert (push >= 2.0 ** -57 * 1e-9 + 2.0 ** -61).all()
    assert (counted > 0.95 * factor * push * 100 ** 2 / 2).all()


@pytest.mark.quick
def test_roundings_of_waves_that_move_are_counted(np, texts):
    """As above, the roundings of what the parameters do to a wave."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("1e-9", "1e-9"), ("1e-9", "1e-9"),
                           ("0", "0"))
    moving, counted = what_an_error_adds(text, "from_H")
    assert (moving >= 2.0 ** -48 * 1e-9).all()
    assert (counted > 0.95 * moving * 100 ** 2 / 2).all()


@pytest.mark.parametrize("G, mu, terms, least", [
    # G is 0, and terms 10 and 20 cancel in it
    ([0, 0, 0], [0, 0, 0], [10, 20], lambda grain: grain * (10 * (3 + 0.5) + 20 * (4 + 0.5))),
    # mu of the other lane, which is subtracted, loses digits of its terms
    ([7, -5, 0], [7, -5, 0], [0, 0], lambda grain: grain * (7 + 5) * (3 + 0.5)),
    # all coefficients of G, one of them negative, times what x[1] is off by
    ([1, -2, 0.5], [0, 0, 0], [0, 0], lambda grain: 0.5 * (1 + 2 + 0.5))])
@pytest.mark.quick
def test_errors_where_the_lanes_meet_are_counted(np, G, mu, terms, least):
    """x[1] is off by its columns, which sum to 3 and 4, and by 1/2."""
    def first(row):
        return np.array([[[x] for x in map(float, row)], [[0.0]] * 3])

    shape, sums = check.Shape([((1, 0), 0)]), types.SimpleNamespace(error=np.zeros(1))
    check.Prisms.add_ends(types.SimpleNamespace(
        other=np.array, joined=np.array, rounding=np.full((2, 1), 0.5), shape=shape,
        ends=np.array([[[1.0], [-2.0]], [[4.0], [0.0]]])), sums, first(G), first(mu),
        np.array([[float(x)] for x in terms]))
    assert shape.grain >= 64 * check.UNIT and sums.error >= least(shape.grain)


@pytest.mark.quick
def test_a_wave_that_vanishes_in_the_middle_is_there(np, texts):
    """Its parameter moves it, so no orbit goes on where it reaches beyond 1."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("0", "0.3"), ("0", "0"), ("0", "0"))
    prisms = prisms_of(claim_of(with_field(text, "v0", "1 0.001")))
    assert all(prisms.follow()) and 1 < len(prisms.sites) < 100
    assert max([site.reach[0].max() for site in prisms.sites]) <= check.REACH_MAX


@pytest.mark.quick
def test_roundings_of_slopes_are_counted_at_every_site(np, texts, monkeypatch):
    """Not only where the lanes meet, which is left out here."""
    monkeypatch.setattr(check.Prisms, "add_ends", lambda prisms, sums, G, *_: setattr(
        sums, "ends", np.zeros((prisms.known, G.shape[1], prisms.size))))
    text = with_field(with_tree(texts["trig278"], "P"), "v0", "1 0.001")
    prisms = prisms_of(claim_of(with_field(text, "v1", "1 0.001")), 0.3)
    assert all(prisms.follow()) and len(prisms.sites) > 1
    *_, error = prisms.expand()
    prisms.shape.grain = 1.0                    # after all else was made of it
    assert prisms.expand()[-1] > error + 1


@pytest.mark.quick
def test_l_as_a_double_is_not_larger(generator):
    for _ in range(100):
        one, l = 1 << 96, generator.randrange(1 << 96)
        criterion = types.SimpleNamespace(least_pivot=lambda _, l=l: l,
                                          fixed=types.SimpleNamespace(one=one))
        found = Fraction(check.least_in_double(criterion, check.ROOT))
        assert Fraction(l, one) * (1 - Fraction(1, 2 ** 48)) < found <= Fraction(l, one)


def cut_short(monkeypatch, bits):
    """Centres are whole numbers of 2^-bits turns, cut downwards, so that all errors have one sign
    and nothing else hides them; and WHOLE_ERROR is what it is for 64 bits."""
    if bits < 64:
        whole, lost = check.whole, 64 - bits
        monkeypatch.setattr(check, "whole", lambda turns: whole(turns) >> lost << lost)
        monkeypatch.setattr(check, "WHOLE_ERROR", 2.0 ** (3 - bits))


@pytest.mark.parametrize("bits", [64, 36])
def test_lockstep_orbits(np, generator, monkeypatch, bits):
    """True orbits of a prism are where the models say, within their rests, rounded as they are."""
    cut_short(monkeypatch, bits)
    cases = tight = others = 0
    step, centres, bows = check.Prisms.step, [], []     # bows: k.T of each site

    def records(self):
        centres.append(self.X.copy())
        bows.append(self.shape.along(self.LT[:, self.known:]).copy())
        step(self)

    monkeypatch.setattr(check.Prisms, "step", records)
    for _ in range((10 if bits == 64 else 6) * TORTURE):
        prisms = random_prisms(np, generator)
        known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
        centres.clear()
        bows.clear()
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
        push = 2.0 ** -57 * abs(prisms.P) + check.WHOLE_ERROR       # (C13), of each wave
        assert (prisms.push > 0.99 * np.tensordot(abs(prisms.shape.k.T), push, 1)).all()
        for lane in range(prisms.size):
            eta, amplitudes, angles = inside(generator, prisms, lane)
            ends = [[site[0][k] for site in prisms.sites].count(True)
                    for k in (lane, lane + prisms.size)]
            orbits = true_orbit(known, amplitudes, angles, min(max(ends), 20))
            for orbit, k, end in zip(orbits, (lane, lane + prisms.size), ends):
                for site, centre, bow, x in list(zip(prisms.sites[:end], centres, bows, orbit)):
                    columns, size, rest, reach = site.columns, site.size, site.rest, site.reach
                    centre = [Fraction(int(turns[k]), 1 << 64) for turns in centre]
                    for w in range(prisms.shape.count):
                        (k0, k1), _ = known[w]
                        model = sum(mp.mpf(float(a)) * real(e) for a, e in zip(columns[w, :, k],
                                                                               eta))
                        turns_ = real(k0 * centre[0] + k1 * centre[1])
                        off = (k0 * x[0] + k1 * x[1] - 2 * mp.pi * turns_ - model + mp.pi) \
                            % (2 * mp.pi) - mp.pi
                        if reach[w, k] <= 1:
                            assert abs(off) <= mp.mpf(float(rest[w, k]))
                            assert size[w, k] >= sum(map(abs, columns[w, :, k]))
                            off -= sum(mp.mpf(float(a)) * real(e) for a, e in zip(
                                bow[w, :, k], pairs_of(eta)))
                            left = rest[w, k] - (prisms.halves[:, 0] * abs(bow[w, :, k])).sum()
                            assert abs(off) <= left + 2.0 ** -50 * rest[w, k]
                            cases += 1
                            tight += abs(off) > left / 20
                            others += w > 2
    assert cases > 300 * TORTURE and tight > 12 and others > 30


def some(generator):
    """Three numbers, as a rule only one of them above 0."""
    kinds = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)
    return [generator.choice((1, generator.random())) * k for k in generator.choice(kinds)]


def extremes(generator):
    """A wave and a point of it, from where one term of a bound stands alone to all together: P, H,
    W, y, the reaches of its parts, and where e, xi, w and more lie in theirs."""
    P, H, W = some(generator)
    size, rest = (generator.choice((0, 0.5, generator.random() / 2)) for _ in range(2))
    y = generator.choice((generator.uniform(-4, 4), math.pi / 2 * generator.randint(-2, 2)))
    at = [generator.choice((-1, 1, -1, 1, generator.uniform(-1, 1), 0)) for _ in range(6)]
    return P * generator.choice((-1, 1)), H, W, y, size, rest, at


def bending_quotients(generator):
    """What a wave does to r in a step, divided by its bound."""
    P, H, W, y, size, rest, (e, i, j, k, *others) = extremes(generator)
    shares = [generator.choice((-1, 0, 0, 1, generator.uniform(-1, 1))) for _ in "012"]
    shares = [i * size * x / max(sum(map(abs, shares)), 1) for x in shares]
    eta, parts = [e, *others], [(0, H * math.sin(y))] if H else []
    pairs = list(itertools.combinations_with_replacement(range(3), 2))
    form, mean = check.quadratic(pairs, check.np.array([[x] for x in shares]), P * math.cos(y),
                                 parts)
    xi, w = sum(mp.mpf(x) * z for x, z in zip(shares, eta)), j * mp.mpf(rest)
    c, s = mp.cos(y), mp.sin(y)
    true = (P + H * e + W * k) * mp.cos(y + xi + w) - P * c + P * s * (xi + w) - H * e * c \
        + mean[0] + sum(float(x[0]) * mp.mpf(z) for x, z in zip(form, pairs_of(eta)))
    bound = check.bending(P, H, W, abs(math.sin(y)), abs(math.cos(y)), size, rest, size + rest)
    yield abs(true) / (bound * check.SUM_ROUNDING + mp.mpf(10) ** -15)


def remainder_quotients(generator):
    """What a wave has beside G z and (4), divided by its bound."""
    P, H, W, y, size, rest, (e, i, j, k, l, m) = extremes(generator)
    omega, m0, m1 = some(generator)
    m0 *= generator.choice((-1, 1))
    xi, w, mu = i * mp.mpf(size), j * mp.mpf(rest), m0 + l * mp.mpf(m1)
    c, s, z = mp.cos(y), mp.sin(y), xi + w
    A0, B0, alpha, beta = m0 * c - omega * s, -omega * c - m0 * s, (mu - m0) * c, (m0 - mu) * s
    true = (P + H * e + W * k) * (mu * mp.cos(y + z) - omega * mp.sin(y + z)) \
        - z * (P * B0 + P * beta - P * A0 * xi + H * e * B0) - P * (A0 + alpha) \
        - H * e * (A0 + alpha) - P * A0 * xi ** 2 / 2 + P * alpha * xi ** 2 / 2 \
        + P * B0 * xi ** 3 / 6 - H * e * (beta * xi - A0 * xi ** 2 / 2)
    bound = check.remainder(
        P, H, W, float(A0), m1 * abs(float(c)), float(B0), m1 * abs(float(s)),
        abs(m0) + m1 + omega, size, rest, size + rest)
    yield true / (bound * check.SUM_ROUNDING + mp.mpf(10) ** -14)


@pytest.mark.parametrize("quotients", [bending_quotients, remainder_quotients])
@pytest.mark.quick
def test_lockstep_terms(np, generator, quotients):
    """What is left of a wave is bounded, hardly too far."""
    assert 0.99 < worst(lambda: quotients(generator), 2000 * TORTURE) <= 1


def left_side(waves, amplitudes, lanes, n, tails, l, lane, size, m=mp):
    """The left side of (3) of a true orbit."""
    total, number = 0, mp.mpf if m is mp else float
    for x, k in zip(lanes, (lane, lane + size)):
        vectors = [[number(float(v)) for v in vector[:, k]] for vector in n]
        for y, vector, tail in zip(x, vectors, tails):
            total += in_form(bent(waves, amplitudes, y, m), vector) \
                - l * number(float(tail[k])) * (vector[0] ** 2 + vector[1] ** 2)
        total -= 2 * sum(a[0] * b[0] + a[1] * b[1] for a, b in zip(vectors, vectors[1:]))
    a, b = [[number(float(v)) for v in n[0][:, k]] for k in (lane, lane + size)]
    return total - 2 * (a[0] * b[0] + a[1] * b[1])


@pytest.mark.parametrize("chosen", ["by the checker", "at random"])
def test_lockstep_bound(np, generator, chosen):
    """At all sorts of points of a prism the true left side of (3) is below the bound, and below
    the polynomial and its error."""
    cases = 0
    least = math.inf
    for _ in range(12 * TORTURE):
        prisms = random_prisms(np, generator)
        known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            if chosen == "at random":
                draw = np.random.default_rng(generator.getrandbits(64))
                shrink = generator.choice((0.5, 0.8, 1))
                n = [draw.uniform(-1, 1, v.shape) * shrink ** k * site[0]
                     for k, (v, site) in enumerate(zip(n, prisms.sites))]
                tails = [draw.uniform(0, 2, t.shape) for t in tails]
                prisms.test_vectors = lambda: (n, tails)
            bound, _ = prisms.bound()
            value, form, _, error = prisms.expand()
        for lane in range(prisms.size):
            both = [lane, lane + prisms.size]
            count = sum(bool(site[0][both].any()) for site in prisms.sites)
            if count > 25 or not np.isfinite(bound[lane]) or not n[0].any():
                continue

            def about(eta):
                _, abc, angles = inside(generator, prisms, lane, eta)
                abc, angles = [float(x) for x in abc], [[float(x) for x in y] for y in angles]
                return left_side(known, abc, true_orbit(known, abc, angles, count, math), n, tails,
                                 float(prisms.l[lane]), lane, prisms.size, math)

            worst = max(itertools.product((-1, 1), repeat=prisms.known), key=about)
            for eta in (None, [Fraction(e) for e in worst]):
                eta, abc, angles = inside(generator, prisms, lane, eta)
                true = left_side(known, abc, true_orbit(known, abc, angles, count), n, tails,
                                 mp.mpf(float(prisms.l[lane])), lane, prisms.size)
                model = mp.mpf(float(value[lane])) + sum(
                    mp.mpf(float(x[lane])) * math.prod([real(eta[k]) for k in key])
                    for key, x in form.items())
                assert true <= bound[lane] and true <= model + float(error[lane])
                least = min(least, model + float(error[lane]) - true if true else 1)
                cases += 1
    assert cases > 36 * TORTURE and 0 < least < (1e-6 if chosen == "at random" else 1)


@pytest.mark.quick
def test_what_the_centres_miss_counts(np, generator):
    """The centre's step misses `push` at each site (C18), and a centre at either end `rounding`:
    with larger ones every bound that has multipliers is larger."""
    grown = 0
    for _ in range(4 * TORTURE):
        prisms = random_prisms(np, generator)
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            prisms.test_vectors = lambda: (n, tails)
            usual, _ = prisms.bound()
            long = np.isfinite(usual) & [sum(site[0][lane] for site in prisms.sites) > 2
                                         for lane in range(prisms.size)] & (abs(usual) > 1e-9)
            push, prisms.push = prisms.push, prisms.push + 1e-3
            further, _ = prisms.bound()
            prisms.push = push
            rounding, prisms.rounding = prisms.rounding, prisms.rounding + 1e-3
            ends, _ = prisms.bound()
            prisms.rounding = rounding
            again, _ = prisms.bound()
        assert (again[long] == usual[long]).all()
        assert (further[long] > usual[long]).all() and (ends[long] > usual[long]).all()
        grown += long.sum()
    assert grown > 10


@pytest.mark.quick
def test_sums_in_blocks(np, generator, monkeypatch):
    """Blocks of one site, of three or of all lead to the same sums.  So do their errors; N blocks
    of one site have as many terms one after the other as one block of N, and blocks of three fewer.
    """
    monkeypatch.setattr(check, "MAX_SITES", 40)
    cases = 0
    for _ in range(8):
        prisms, found = random_prisms(np, generator, scale=0.3), []
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            N, lanes = len(prisms.sites), prisms.l.size
            draw = np.random.default_rng(generator.getrandbits(64))
            vectors = [draw.uniform(-1, 1, (2, lanes)) * site.alive for site in prisms.sites], \
                [draw.integers(0, 3, lanes) for _ in prisms.sites]
            prisms.test_vectors = lambda: vectors
            for sites in (1, 3, N):
                monkeypatch.setattr(check, "BLOCK", sites * lanes)
                value, form, _, error = prisms.expand()
                found.append((np.stack([value, *form.values()]), error))
        (ones, _), (threes, less), (whole, error) = found
        good = (error < 0.1) & (N > 6)
        for other in ones, threes:
            assert (abs(other - whole) <= error)[:, good].all()
        assert found[0][1][good] == pytest.approx(error[good], rel=1e-13, abs=0)
        assert (less < error)[good].all()
        assert less[good] == pytest.approx(error[good], rel=0.9, abs=0)
        cases += good.sum()
    assert cases > 10


@pytest.mark.quick
def test_sums_of_the_value(np):
    """Multiples of 2^-26 add up exactly, however many of them cancel, and only what is beside them
    is rounded: step (C19)."""
    draw = np.random.default_rng(3)
    for size in 2.0 ** -30, 1.0, 2.0 ** 9:
        terms = draw.uniform(-size, size, (40, 100, 2))
        sums = check.Sums(2, 0, 2)
        sums.add(terms[0, :1])
        assert (abs(sums.low) <= 2.0 ** -27).all()
        sums.add(terms[0, 1:])
        for block in terms[1:]:
            sums.add(block)
        for lane in range(2):
            exact = sum(map(Fraction, terms[..., lane].ravel().tolist()))
            found = Fraction(sums.value[lane]) + Fraction(sums.low[lane])
            assert abs(exact - found) <= Fraction(4000 * 140, 1 << 27 + 53)
            assert sums.value[lane] * 2 ** 26 % 1 == 0 and abs(sums.low[lane]) <= 4000 / 2 ** 27


@pytest.mark.quick
def test_masses_of_roundings(np, generator, monkeypatch):
    """The masses, of each wave and site, and what (C19) takes of them; none where they are large.
    """
    blocks, joined, add_sites, join = [], [], check.Prisms.add_sites, check.Sums.join
    monkeypatch.setattr(check.Prisms, "add_sites", lambda self, *block: (
        blocks.append(block), add_sites(self, *block))[1])
    monkeypatch.setattr(check.Sums, "join", lambda self, both: (
        join(self, both), joined.append(self))[0])
    cases = large = 0
    for length in [1] * 6 + [2.0 ** 11] * 2:
        prisms, both = random_prisms(np, generator, scale=0.5), (2, -1)
        blocks.clear()
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            prisms.test_vectors = lambda: ([length * v for v in n], tails)
            _, _, added, error = prisms.expand()
        m0, m2, N, size = 0, 0, len(prisms.sites), prisms.size
        for _, site, n, _, _, _, mus, _, _ in blocks:
            long, mu = (n * n).sum(axis=0), abs(mus[0]).sum(axis=1)
            m0 = m0 + (2 * long).sum(axis=0).reshape(both).sum(axis=0)
            for (k, _), P, H, reach in zip(prisms.shape.waves, abs(prisms.P), prisms.H,
                                           site.reach):
                K, square = sum(map(abs, k)), (k[0] ** 2 + k[1] ** 2) * long
                weight = K * (abs(k[0]) * mu[0] + abs(k[1]) * mu[1] + square)
                m0, m2 = [m + x.sum(axis=0).reshape(both).sum(axis=0) for m, x in (
                    (m0, K * P * square), (m2, weight * (P * reach ** 2 + 3 * H)))]
        block = max(1, check.BLOCK // (2 * size))
        chain = (len(prisms.P) + 2) * (block + math.ceil(N / block))
        least = 2.0 ** -53 * (96 * m0 + 256 * m2 + chain * (m2 + 2.0 ** -9) + 96 * added)
        fine = m0 + m2 < 0.99 * 2 ** 22
        assert (error >= joined[-1].error + (1 - 1e-9) * least)[fine].all()
        assert (error == math.inf)[m0 + m2 > 1.01 * 2 ** 22].all()
        cases, large = cases + fine.sum(), large + (~fine).sum()
    assert cases > 20 and large > 0


def test_a_leaf_of_long_orbits(np, texts, generator, monkeypatch):
    """A leaf of the proof from 0.01391 to 0.0140 over its second point: one piece, in doubles and
    in integers, where models of first order took more than 4,096; and the bound is near the truth.
    """
    monkeypatch.setattr(check, "MAX_SITES", 300)
    half = Fraction("0.0005046462")
    claim = claim_of(general(
        texts["trig274"], [(k, 0, p * Fraction("0.1564963938"), [p * half]) for k, p in zip(
            check.THESIS, (1, 1, 2))],
        (Fraction("0.670635"), Fraction("0.021925")), (Fraction("0.00781"), Fraction("0.0096")),
        xstar=(Fraction("0.846028"), Fraction("0.846028"))))
    claim = dataclasses.replace(claim, frame=check.DIAGONALS[2])
    cell = (96814, 858, 5, 0, 0, 0), (17, 12, 10, 0, 0, 0)
    criterion = check.Criterion(claim)
    l = check.least_in_double(criterion, cell)
    assert criterion.attempt(criterion.least_pivot(cell), cell, check.SITE_PENALTIES[0]) is None
    with np.errstate(all="ignore"):
        prisms = prisms_of(claim, l, cell)
        assert all(prisms.follow())
        bound = prisms.bound()[0][0]
        n, tails = prisms.test_vectors()
    assert bound < 0 and len(n) > 190
    known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
    for _ in range(3):
        _, amplitudes, angles = inside(generator, prisms, 0)
        true = left_side(known, amplitudes, true_orbit(known, amplitudes, angles, len(n)), n,
                         tails, mp.mpf(l), 0, 1)
        assert true <= bound < 0.8 * true


@pytest.mark.quick
def test_lockstep_polynomial(np, generator):
    """The left side of (3) is the polynomial but for what it is said to leave, to either side; and
    this is of fourth order."""
    cases = falls = 0
    for _ in range(12 * min(TORTURE, 20)):
        box = random_prisms(np, generator)
        size, lefts = box.size, []
        known = [(k, Fraction(phase)) for k, phase in box.shape.waves]
        draw = np.random.default_rng(generator.getrandbits(64))
        n = draw.uniform(-1, 1, (4, 2, 2 * size)) * draw.uniform(0.3, 1)
        for shrink in (2.0 ** -4, 2.0 ** -5):
            width = shrink / (abs(box.ends[:, -2:, :size]).max(axis=(0, 1)) + 2.0 ** -99)
            prisms = check.Prisms(([x[:, :size] for x in box.turns], box.h[..., :size] * width,
                                   0 * box.W[:, :size], box.first[0][:, :size],
                                   box.ends[..., :size] * width, np.zeros((2, size))), box.shape,
                                  box.before[0][:, :size], box.l[:size])
            with np.errstate(all="ignore"):
                assert all(prisms.follow())
            if len(prisms.sites) < 4:
                break
            prisms.test_vectors = lambda: ([v * site[0] for v, site in zip(n, prisms.sites)]
                                        + [0 * n[0]] * (len(prisms.sites) - 4), tails)
            tails = [0 * box.l] * len(prisms.sites)
            value, form, _, error = prisms.expand()
            whole = prisms.sites[3][0][:size] & prisms.sites[3][0][size:]
            lefts.append(np.where(whole, error, math.nan))
            for lane in range(size):
                if not whole[lane] or error[lane] > 1:
                    continue
                eta, abc, angles = inside(generator, prisms, lane)
                true = left_side(known, abc, true_orbit(known, abc, angles, 4), n, tails, mp.mpf(0),
                                 lane, size)
                found = real(Fraction(float(value[lane]))) + sum(
                    real(Fraction(float(x[lane])) * math.prod([eta[k] for k in key]))
                    for key, x in form.items())
                assert true - found <= error[lane] and found - true <= 30 * error[lane]
                cases += 1
        if len(lefts) == 2:
            fourth = (lefts[1] > 1e-9) & (lefts[0] > 0)
            assert (lefts[0] > 12 * lefts[1])[fourth].all()
            falls += fourth.sum()
    assert cases > 100 * TORTURE and falls > 20 * TORTURE


@pytest.mark.quick
def test_cells_of_a_wide_range_are_checked_in_doubles(np, texts, generator):
    """Those whose amplitudes are small; and their amplitudes are as true as others'."""
    claim = claim_of(with_tree(texts["trig278"], "P"))
    for wide in Fraction(10) ** 9, Fraction(2) ** 51:
        claim = dataclasses.replace(claim, waves=tuple([dataclasses.replace(
            wave, middle=wide / 2 + Fraction(1, 3), parts=(-wide / 2, *wave.parts[1:]))
            for wave in claim.waves]))
        fast, cuts = check.Lockstep([claim]), math.ceil(math.log2(wide))
        last = (1 << cuts) - 1
        small, large = [((0, 0, index, 0, 0, 0), (0, 0, cuts, 0, 0, 0)) for index in (last, 0)]
        *_, kept = fast.pieces_of([(0, large), (0, small)], [0.5, 0.5])
        assert kept.tolist() == [1]
        for n in range(20):
            at = (0, 0, last - n, 0, 0, 0), small[1]
            (most, rest, rounded), h, W, *_ = fast.box(*cells_of([at]), np.zeros(1, int))
            for wave in claim.examined:
                w = fast.shape.waves.index((wave.k, wave.phase % 2))
                turns = Fraction(int(most[w, 0]), 1 << 38) + Fraction(float(rest[w, 0])) * (1 << 26)
                assert abs(turns - Fraction(float(rounded[w, 0]))) <= abs(turns) / (1 << 53)
                assert abs(real(wave.over(at)[0]) - 2 * mp.pi * real(turns)) <= W[w, 0] / 2


@pytest.mark.quick
def test_a_frame_counts_with_its_entries(np, texts):
    """Where v0 and v1 lose nearly a unit each, x[1] loses as many as its frame has."""
    v = 1 + (1 - Fraction(1, 1 << 40)) / (1 << 63)
    claim = dataclasses.replace(claim_of(with_tree(texts["trig278"], "P")), frame=(60, 1, -1, 60),
                                centre=(v, v), half=(Fraction(0), Fraction(0)))
    cell = np.zeros((6, 1), np.int64)
    *_, X, _, off = check.Lockstep([claim]).box(cell, cell, np.zeros(1, int))
    for x, found, allowed in zip(in_frame(claim.frame, claim.centre), X[:, 0], off[:, 0]):
        gap = (x / 2 - Fraction(int(found), 1 << 64) + Fraction(1, 2)) % 1 - Fraction(1, 2)
        assert 50 < abs(gap) * (1 << 64) < 2.0 ** 64 * float(allowed) / (2 * math.pi)


@pytest.mark.quick
def test_inverses_of_a_step_count_with_their_roundings(np, generator):
    """M is not quite the inverse of d: what is left times the rests of the site before is in f."""
    d = np.array([[generator.uniform(1, 3), generator.uniform(-1, 1), generator.uniform(1.1, 3)]
                  for _ in range(200)]).T
    rests, none = np.ones((2, 200)), np.zeros((2, 200))
    f, M, _ = check.next_rest(d, none, none, rests, none, np.zeros((3, 200)))
    for k in range(200):
        (p, q, r), (m, n, o) = [[Fraction(float(x)) for x in a[:, k]] for a in (d, M)]
        left = abs(1 - m * p - n * q) + abs(m * q + n * r), \
            abs(n * p + o * q) + abs(1 - n * q - o * r)
        assert all(x <= Fraction(float(y)) for x, y in zip(left, f[:, k]))


@pytest.mark.quick
@pytest.mark.parametrize("rows", (1, 2, 3))
def test_inverses_of_a_step_count_as_step_c15_has_it(np, generator, rows):
    """|I - M d| is bounded by 5 u |1/det| times the products of cofactors and d without signs, and
    by 6 u |1/det| times the determinant without signs."""
    i, j = np.triu_indices(rows)
    for width in 0, 0.3:
        d = np.array([(a == b) * 2 + width * generator.uniform(-1, 1) for a, b in zip(i, j)])
        matrix = np.empty((rows, rows))
        matrix[i, j] = matrix[j, i] = d
        rests, none = np.array([[generator.uniform(0, 1)] for _ in i[:rows]]), np.zeros((rows, 1))
        f, _, det = check.next_rest(d[:, None], none, none, rests, none, np.zeros((len(d), 1)))
        some = np.empty((rows, rows))
        some[i, j] = some[j, i] = check.cofactors(abs(d), 1)
        least = 5 * some @ abs(matrix) @ rests + 6 * (abs(matrix[0]) @ some[0]) * rests
        assert (f >= least * (2.0 ** -53 * (1 - 1e-9) / abs(det))).all()


@pytest.mark.quick
def test_cells_too_fine_for_doubles_are_left_to_the_integers(np, texts):
    fast, asked = check.Lockstep([claim_of(with_tree(texts["trig278"], "P"))]), []
    cell = (0,) * 6, (check.FAST_CUTS_MAX + 1, 0, 0, 0, 0, 0)
    refused, pieces = fast.settle([(0, cell)], [0.9],
                                  lambda n: (asked.append(n), ("it may be positive", 7))[1])
    assert asked == [0] and refused == (0, "it may be positive") and pieces == [7]


@pytest.mark.quick
def test_sines_of_a_step_count_with_their_roundings(np, texts, monkeypatch):
    seen, bending = [], check.bending
    monkeypatch.setattr(check, "bending", lambda P, H, W, s, c, *others: (
        seen.append((s, c)), bending(P, H, W, s, c, *others))[1])
    prisms = prisms_of(claim_of(with_tree(texts["trig278"], "P")))
    prisms.step()
    (site,), (allowed,) = prisms.sites, seen
    for exact, bound in zip((site.s, site.c), allowed):
        assert (bound >= np.abs(exact) + 23 * check.UNIT * prisms.shape.K[:, None]).all()


@pytest.mark.quick
def test_lockstep_corners(np, texts, generator, monkeypatch):
    """Corners of cells, wide or narrow, are those of the box within W and the error of x[1]: also
    of a wave that a claim names 16 times, and of parts that have 64 bits and signs."""
    monkeypatch.setattr(check, "in_turns", lambda units: (units,) * 3)
    claim = claim_of(with_tree(texts["trig274"], "P"))
    for _ in range(100):
        def some(count, size=1):
            size *= Fraction(10) ** generator.choice((0, -3, -10, -20, -40, -400))
            return tuple([near(generator) * size for _ in range(count)])

        amplitudes = some(generator.choice((1, 16)))
        parts = generator.choice((some(3), tuple([Fraction(n, 10 ** 11) for n in (7, -1, 0)])))
        claim = dataclasses.replace(
            claim, waves=tuple([check.Wave((1, 0), Fraction(1, 3), p, parts) for p in amplitudes]),
            centre=some(2, 9), half=tuple(map(abs, some(2))), frame=generator.choice(FRAMES),
            shifts=generator.choice(((), (some(2), some(2), some(2)))))
        if not claim.examined:
            continue
        other = dataclasses.replace(claim, frame=check.IDENTITY, shifts=(), waves=tuple([
            check.Wave(k, ZERO, Fraction(1), (ZERO,) * 3) for k in ((0, 1), (1, 1))]))
        q, cell = generator.randrange(2), random_cell(generator, claim, 52)
        fast = check.Lockstep([claim, other] if q == 0 else [other, claim])
        (units, _, _), h, W, X, columns, off = fast.box(*cells_of([cell]), np.full(1, q))
        corner = [generator.choice((-1, 1)) for _ in range(6)]
        along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, corner)]
        turns = in_frame(claim.frame, [c + v * t + s for c, v, t, s in zip(
            claim.centre, claim.half, along, moved_by(claim, along))])
        w, signs = fast.shape.waves.index(((1, 0), Fraction(1, 3))), [
            corner[axis] for axis in fast.axes]
        assert np.count_nonzero(W) == 1                 # no wave of the other claim
        amplitude = real(sum([wave.at(along[2:]) for wave in claim.examined]))
        pairs = [(amplitude, units[w, 0], check.AMPLITUDE_BITS, h[w], W[w, 0])]
        pairs += zip([mp.pi * real(x) for x in turns], X[:, 0], (64, 64), columns, off[:, 0])
        for true, found, bits, moved, error in pairs:
            gap = true - 2 * mp.pi * int(found) / mp.mpf(2) ** bits - sum(
                [mp.mpf(float(x)) * e for x, e in zip(moved[:, 0], signs)])
            assert abs(gap - 2 * mp.pi * mp.nint(gap / (2 * mp.pi))) <= error


@pytest.mark.quick
def test_lockstep_xstar(np, texts, generator):
    for _ in range(20):
        text = with_field(with_tree(texts["trig274"], "P"), "xstar", "%s %s" % tuple(
            check.decimal_text(exact_decimal(generator, size, 25)) for size in (1000, 3)))
        claim = claim_of(text)
        fast = check.Lockstep([claim])
        for x, units in zip(claim.xstar, fast.xstar[:, 0]):
            off = (real(x) - 2 * mp.pi * mp.mpf(int(units)) / 2 ** 64 + mp.pi) % (2 * mp.pi) - mp.pi
            assert abs(off) <= check.WHOLE_ERROR


def contradicts(abc, x0, x1, steps):
    """Is the second variation along an orbit not positive definite?  In doubles, and if these say
    that it is, with many digits."""
    return not definite(abc, x0, x1, steps, math) or not definite(
        [mp.mpf(x) for x in abc], [mp.mpf(x) for x in x0], [mp.mpf(x) for x in x1], 2 * steps)


def test_nothing_that_minimizes_is_excluded(np, texts, generator):
    """Cells at the edge of what can be proved, of true and of false claims: wherever the fast path
    alone excludes a cell, no orbit of it minimizes."""
    cases = excluded = open_ones = 0
    while cases < 1000 * min(2 * TORTURE - 1, 50):
        scale = generator.choice(("0.1", "0.14", "0.16", "0.2", "0.3"))
        a, b, c = (Fraction(scale) * Fraction(generator.randint(50, 110), 100) * k
                   for k in (1, 1, 2))
        text = with_field(with_tree(texts["trig274"], "P"), "together",
                          generator.choice(("yes", "no")))
        width = Fraction(1, 10 ** generator.randint(2, 5))
        claim = claim_of(with_parameters(text, *((x, width * x) for x in (a, b, c))))
        criterion = check.Criterion(claim)
        fast = check.Lockstep([claim])
        cells = []
        for _ in range(256):
            most = generator.randint(3, 11)
            slices = [(generator.randrange(1 << k), k) for k in (most, most)] + [
                (generator.randrange(1 << k), k) for k in [generator.randint(0, 3)] * 3] + [(0, 0)]
            if claim.parameters == 1:
                slices[3:] = [(0, 0)] * 3
            cells.append(tuple(zip(*slices)))
        l = np.array([check.least_in_double(criterion, cell) for cell in cells])
        proved, _ = fast.attempt(*cells_of(cells), np.zeros(len(cells), int), l,
                                  check.SITE_PENALTIES[0])
        for cell, good in zip(cells, proved):
            cases += 1
            excluded += bool(good)
            amplitudes, v = random_point(generator, claim, cell)
            fails = contradicts([float(x) for x in amplitudes], [float(x) for x in claim.xstar],
                                [float(x) * math.pi for x in v], 25) \
                if good or cases % 8 == 0 else None
            assert fails or not good
            open_ones += fails is False
    assert excluded > cases / 10 and open_ones > cases / 200


@pytest.mark.quick
def test_numbers_that_are_none_prove_nothing(np, generator):
    for bad in (math.nan, math.inf, 1e300):
        for part, row in itertools.product(range(5), range(3)):
            if part > 2 and (row == 2 or bad == 1e300):
                continue                            # two angles; and large ones are no harm
            prisms = random_prisms(np, generator)
            while prisms.shape.count < 2 or part == 1 and not any(prisms.shape.moving):
                prisms = random_prisms(np, generator)
            most, rest, *box, X = [x[..., :prisms.size].copy() for x in (
                *prisms.turns, prisms.h, prisms.W, prisms.ends, prisms.rounding, prisms.first[0])]
            if part == 1:
                w = generator.choice([w for w, m in enumerate(prisms.shape.moving) if m])
                box[part][w, prisms.shape.moving[w][0]] = bad
            else:
                box[part][row % 2 if part < 3 else row] = bad
            with np.errstate(all="ignore"):
                rounded, h, W, columns, off = box
                prisms = check.Prisms(((most, rest, rounded), h, W, X, columns, off),
                                      prisms.shape, prisms.before[0][:, :prisms.size],
                                      prisms.l[:prisms.size])
                all(prisms.follow())
                bound, _ = prisms.bound()
            assert not (bound < 0).any()


def test_both_paths_agree(np, deep, run):
    """They confirm, and do not confirm, the same theorem; and halve few leaves.  (Of smaller files
    this is seen in test_parts.py.)"""
    results = []
    for options in ((), ("--exact",)):
        status, out, _ = run(deep, *options)
        results.append((status, out.partition("\nChecker")[0]))
        pieces = int(re.search("in ([0-9]+) pieces", out).group(1))
        assert 200 < tree_of(deep).count("P") <= pieces < 1.1 * tree_of(deep).count("P")
        assert run(sealed(with_field(deep, "xstar", "1.2 1.2")), *options)[0] == 5
    assert results[0] == results[1] and status == 0


@pytest.mark.parametrize("blame, halved, axis", [
    ([0.5, 1.0, 0.2], [0, 0, 0], 1), ([0.5, 1.0, 0.2], [0, 4, 0], 1),
    ([0.5, 1.0, 0.2], [1, 5, 0], 2), ([0.5, 1.0, 0.2], [0, 5, 1], 0),
    ([2.0 ** -31, 1.0, 0.0], [0, 9, 0], 1),
    ([2.0 ** -30, 1.0, 0.0], [0, 9, 0], 0), ([math.nan, 1.0], [9, 0], 0), ([0.0, 0.0], [0, 9], 0)])
def test_the_axis_that_is_halved(blame, halved, axis):
    """One that was halved far less often has its turn, if it matters."""
    assert check.worst_axis(blame, halved) == axis


def test_without_numpy(texts, run, monkeypatch):
    for module, why in ((None, "numpy is not installed"), ("rounds", "does not round")):
        if module is None:
            monkeypatch.setitem(sys.modules, "numpy", None)
        else:
            monkeypatch.undo()
            monkeypatch.setattr(check, "import_numpy_if_sound", lambda: False)
        status, out, err = run(texts["trig278"])
        assert status == 0 and why in err and err.count("\n") == 1
        assert "Method : Loewner criterion, multipliers, in integers" in out
    monkeypatch.undo()
    status, out, err = run(texts["trig278"], "--exact")
    assert (status, err) == (0, "") and "in doubles" not in out
    status, out, err = run(texts["trig278"])
    assert (status, err) == (0, "") and "in doubles" in out


@pytest.mark.quick
def test_the_fast_path_looks_at_the_machine(np, monkeypatch):
    class Other:
        """numpy, but for one thing."""
        def __getattr__(self, name):
            return getattr(np, name)

    class Flushing(Other):
        def array(self, values, *rest):
            found = np.array(values, *rest)
            if found.size == 9:
                found[:] = 0
            return found

    class Truncating(Other):
        @staticmethod
        def rint(x):
            return np.trunc(x)

    for other in (Flushing(), Truncating()):
        monkeypatch.setitem(sys.modules, "numpy", other)
        assert not check.import_numpy_if_sound()
    monkeypatch.undo()
    assert check.import_numpy_if_sound()


def test_long_orbits_are_followed_fewer_at_a_time(np, root, tmp_path, monkeypatch):
    prove(read_input(root / "inputs" / "standard-63-64.in"), method="loewner").save(tmp_path / "a")
    claim = check.read(tmp_path / "a")
    monkeypatch.setattr(check, "MEMORY_MAX", 200000)
    criterion = check.Criterion(claim)
    fast = check.Lockstep([claim])
    cells = [(0, cell) for at, cell in check.leaves(claim.tree) if claim.tree[at] == "P"]
    least = [check.least_in_double(criterion, cell) for _, cell in cells]
    refused, pieces = fast.settle(cells, least, lambda n: ("not by the fast path", 0))
    assert refused is None and fast.batch < check.BATCH and min(pieces) == 1


def test_processes_share_the_memory_of_two(np, root, tmp_path, monkeypatch):
    prove(read_input(root / "inputs" / "standard-63-64.in"), method="loewner").save(tmp_path / "a")
    monkeypatch.setattr(check, "FAST_CHUNK", (50, check.FAST_CHUNK[1]))     # 135 leaves
    check_all, seen = check.check_all, []

    def record(chunks, jobs, problems):
        seen.append((jobs, problems.fast.memory))
        return check_all(chunks, 1, problems)

    monkeypatch.setattr(check, "check_all", record)
    for jobs in (1, 2, 9):
        assert check.verify(tmp_path / "a", jobs=jobs)
    assert seen == [(1, check.MEMORY_MAX), (2, check.MEMORY_MAX), (3, 2 * check.MEMORY_MAX // 3)]


@pytest.mark.skipif(TORTURE <= 1, reason="minutes; make torture has it")
def test_the_standard_map_nearest_to_break_up(np, root, tmp_path):
    """Orbits of 18,621 points: whole, and in doubles alone, where the integers would take days."""
    proof = prove(read_input(root / "inputs" / "standard-9717.in"), method="loewner")
    proof.save(tmp_path / "a")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check.Criterion, "excluded", lambda *_: ("not in doubles", 0))
        result = check.verify(tmp_path / "a")
    assert result and "\na = 0.9717\n" in result.text
    assert "Proved leaves checked : %d, " % proof.counts.proved in result.text


# ---- the bound B

def eigenvalue(amplitudes, y, waves=TRIG):
    p, q, r = bent(waves, amplitudes, y, mpmath.fp)
    return (p + r) / 2 + ((p - r) ** 2 / 4 + q * q) ** 0.5


@pytest.mark.quick
def test_bound_over_a_cell(generator):
    fixed, one = FIXED[96], FIXED[96].one
    for n in range(2000 * TORTURE):
        waves = some_waves(generator)
        amplitudes = [int(near(generator) * 2 ** generator.randint(-6, 3) * one) for _ in waves]
        y = [int(near(generator) * 4 * one) for _ in range(2)]
        w = one * 3 >> n % 24
        bound, value = (x / one for x in check.cell_bound(
            fixed, in_units(fixed, waves), amplitudes, y, w))
        stiff = check.stiffness(in_units(fixed, waves))
        scale = (1 + max(map(abs, amplitudes)) / one) * stiff
        real_ones = [p / one for p in amplitudes]
        for _ in range(4):
            at = [float(c + near(generator) * w) / one for c in y]
            assert eigenvalue(real_ones, at, waves) <= bound + 1e-14 * scale
        assert abs(eigenvalue(real_ones, [t / one for t in y], waves) - value) < 1e-14 * scale


@pytest.mark.quick
def test_bound_over_a_cell_where_slopes_cancel():
    """beta - 2 is sin 2x / 2 - sin x, of third order at 0: the rest of third order bounds it."""
    fixed, one = FIXED[96], FIXED[96].one
    waves = ((1,), ZERO), ((2,), ZERO)
    for w in (1 / 4, 1 / 16, 1 / 256):
        bound, value = (x / one - 2 for x in check.cell_bound(
            fixed, in_units(fixed, waves), [one, -one // 8], [0], int(w * one)))
        assert abs(value) < 1e-15
        assert abs(bent(waves, [1, -1 / 8], [-w], math)[0] - 2) < bound < 0.9 * w ** 3


def highest(amplitudes, waves=TRIG, points=48, starts=4):
    """The largest eigenvalue over the torus, in doubles: on a grid, and on from its best points."""
    np, step = pytest.importorskip("numpy"), 2 * math.pi / points
    cosines = types.SimpleNamespace(pi=math.pi, sin=np.sin)

    def largest(y):
        p, q, r = bent(waves, amplitudes, y, cosines)
        return (p + r) / 2 + np.sqrt((p - r) ** 2 / 4 + q * q)

    y = np.stack(np.meshgrid(*[step * np.arange(points)] * 2)).reshape(2, -1)
    y = y[:, np.argsort(-largest(y))[:starts]]
    around = np.stack(np.meshgrid(*[np.arange(-2, 3) / 2] * 2)).reshape(2, 1, -1)
    for _ in range(25):
        near = y[:, :, None] + step * around
        best = largest(near).argmax(axis=1)
        y, step = near[:, np.arange(starts), best], step / 2
    return max(2, np.max(largest(y)))


@pytest.mark.quick
def test_bound_over_the_torus(generator):
    fixed, one = FIXED[96], FIXED[96].one
    for n in range(12 * min(TORTURE, 5)):
        waves = (TRIG, (((1, -1), ZERO), ((2, 1), Fraction(1, 3))), (((2, 4), ZERO),
                 ((-1, -2), Fraction(1, 5))), (((3, 0), ZERO), ((2, 0), Fraction(2, 7))),
                 (((0, 2), ZERO), ((0, -3), Fraction(2, 7))),
                 (((6, 4), ZERO), ((9, 6), Fraction(1, 7))))[n % 6]
        q = {2: (1, 2), 5: (3, 2)}.get(n % 6)           # all k are multiples of it
        low = [int(near(generator) * one) for _ in waves]
        high = [p + int(abs(near(generator)) * one / 8) * (n % 4) for p in low]
        known, scale = in_units(fixed, waves), 1
        if q:
            known, scale = [((k[0] // q[0],), phase) for k, phase in known], q[0] ** 2 + q[1] ** 2
        bound = check.torus_bound(fixed, known, [tuple([scale * p for p in corner]) for corner in
                                                 itertools.product(*zip(low, high))]) / one
        corners = set(itertools.product(*zip((p / one for p in low), (p / one for p in high))))
        best = max(highest(amplitudes, waves, 48) for amplitudes in corners)
        assert -1e-12 <= bound - best < 1e-4


def test_bound_over_the_torus_if_no_wave_couples_the_angles(monkeypatch):
    """Of few cells, though beta is largest on lines; whichever angle has the larger waves."""
    fixed, one, cells, cell_bound = FIXED[96], FIXED[96].one, [], check.cell_bound
    monkeypatch.setattr(check, "cell_bound", lambda *of: cells.append(of) or cell_bound(*of))
    waves = ((1, 0), ZERO), ((0, 1), ZERO), ((0, 2), Fraction(1, 3))
    for amplitudes in (0.6, 0.1, 0.05), (-0.1, 0.6, 0.05), (0.5, 0.5, 0):
        known = in_units(fixed, waves)
        bound = check.torus_bound(fixed, known, [tuple([int(p * one) for p in amplitudes])]) / one
        assert -1e-12 <= bound - highest(amplitudes, waves) < 1e-4
    assert len(cells) < 1000


def true_bound(abc):
    return highest(abc)


@pytest.mark.quick
def test_least_pivot(texts, generator):
    """l is at most what the true B of the parameters of a cell gives, and hardly less than what
    the true B at the ends of all parameters give, between them."""
    for n in range(4 * min(TORTURE, 3)):
        text = with_tree(texts["trig274"], "2PP" if n % 3 else "P", False)
        claim = claim_of(random_claim(generator, text, 1, "0.3", False))
        criterion, one = check.Criterion(claim), check.Fixed(96).one
        axes = claim.parameters
        ends = {corner: true_bound([float(wave.at(corner)) for wave in claim.waves])
                for corner in itertools.product((-1, 1), repeat=axes)}
        for _ in range(6):
            index, cuts = random_cell(generator, claim, 4)
            if n % 3 == 0:                      # no cuts of parameters
                index, cuts = index[:2] + (0,) * 4, cuts[:2] + (0,) * 4
            l = criterion.least_pivot((index, cuts)) * 2.0 ** -criterion.fixed.bits
            assert criterion.fixed.one == one and 0 < l < 1
            for _ in range(3):
                point, _ = random_point(generator, claim, (index, cuts))
                B = highest(list(map(float, point)), waves_of(claim))
                assert l + 1 / l >= B - 1e-12
            between = [sum(B * math.prod((i + u) / 2 ** k if s > 0 else 1 - (i + u) / 2 ** k
                                         for i, k, u, s in zip(index[2:], cuts[2:], upper, corner))
                           for corner, B in ends.items())
                       for upper in itertools.product((0, 1), repeat=axes)]
            assert abs(l + 1 / l - max(between)) < 1e-5


@pytest.mark.quick
def test_least_pivot_to_the_last_unit(texts, generator, monkeypatch):
    """With a bound that leaves nothing to spare, and that grows as fast as an eigenvalue can."""
    def bound(abc):
        return 2 + max(abs(abc[0]), abs(abc[1])) + 2 * abs(abc[2])

    def in_units_of(fixed, waves, corners):
        if len(waves[0][0]) == 1:       # a wave (1, 1) has twice the amplitude there
            return max(2 * fixed.one + abs(p) for p, in corners)
        found = dict.fromkeys(check.THESIS, 0)
        return max(2 * fixed.one + bound([{**found, **dict(zip(
            [k for k, _ in waves], corner))}[k] for k in check.THESIS]) - 2 for corner in corners)

    monkeypatch.setattr(check, "torus_bound", in_units_of)
    for n in range(300 * TORTURE):
        text = with_tree(texts["trig274"], "2PP" if n % 3 else "P", False)
        claim = claim_of(random_claim(generator, text, 2, 1, False))
        criterion = check.Criterion(claim)
        for _ in range(10):
            index, cuts = random_cell(generator, claim, 9)
            if n % 3 == 0:
                index, cuts = index[:2] + (0,) * 4, cuts[:2] + (0,) * 4
            l = Fraction(criterion.least_pivot((index, cuts)), criterion.fixed.one)
            amplitudes, _ = random_point(generator, claim, (index, cuts))
            found = dict(zip([wave.k for wave in claim.examined], amplitudes))
            B = bound([found.get(k, 0) for k in check.THESIS])
            assert 0 < l < 1 and l * l - B * l + 1 >= 0         # l is at most the lesser root
    criterion = check.Criterion(claim_of(with_field(with_tree(text, "2PP"), "together", "yes")))
    one = criterion.fixed.one           # B between two ends that differ by a unit, where it counts
    criterion.B_at = [2 * one + (one >> 14), 2 * one + (one >> 14) + 1]
    l = Fraction(criterion.least_pivot(((0,) * 6, (0, 0, 1, 0, 0, 0))), one)
    assert l * l - l * (sum(map(Fraction, criterion.B_at)) / 2 / one) + 1 >= 0


def test_parameters_without_an_eigenvalue_above_2(texts, run):
    """B is hardly above 2, l hardly below 1; but nothing is excluded."""
    for together, tree in (("no", "P"), ("yes", "P"), ("yes", "2PP"), ("no", "432PPPP")):
        text = with_field(with_tree(texts["trig274"], tree), "together", together)
        for half in ("0", "1e-30", "0.001"):
            changed = with_parameters(text, *[("0", half)] * 3)
            criterion = check.Criterion(claim_of(changed))
            assert 0.9 < criterion.least_pivot(check.ROOT) / criterion.fixed.one < 1
            assert "not excluded" in run(sealed(changed))[2]
            assert "at once" in run(sealed(with_field(changed, "at once", "yes")))[2]


def test_waves_too_weak_for_any_orbit_are_given_up(texts, run, monkeypatch):
    """Without a try: orbits so long would take hours."""
    text = with_parameters(with_tree(texts["trig274"], "P"), *[("1e-12", "0")] * 3)
    for path in check.Criterion, check.Lockstep:
        monkeypatch.setattr(path, "attempt", None)
    for options in ((), ("--exact",)):
        status, out, err = run(sealed(text), *options)
        assert (status, out) == (5, "") and "so weak that" in err


@pytest.mark.quick
def test_what_is_too_weak(np, texts, generator, monkeypatch):
    """Where the form of (C3) is not negative if beta has everywhere the least value that it may."""
    text = with_parameters(with_tree(texts["trig274"], "P"), *[("0.25", "0.125")] * 3)
    problems, answers = check.Problems([claim_of(text)]), set()
    assert not problems.hopeless((0, check.ROOT)) and problems.bent == {0: 0.375 * (1 + 1 + 2)}
    monkeypatch.setattr(check, "MAX_SITES", 20)
    for _ in range(200):
        bent, l = 10 ** generator.uniform(-4, -1), 1 - 10 ** generator.uniform(-3, -1)
        form = np.diag(np.full(40, 2 - bent)) - np.eye(40, k=1) - np.eye(40, k=-1)
        form[0, 0] -= l
        form[-1, -1] -= l
        problems.bent[0] = bent
        criterion = problems.criterion(0)
        monkeypatch.setattr(criterion, "least_pivot", lambda _, l=l: l * criterion.fixed.one)
        answers.add(problems.hopeless((0, check.ROOT)))
        assert problems.hopeless((0, check.ROOT)) == (np.linalg.eigvalsh(form)[0] >= 0)
    assert answers == {False, True}


@pytest.mark.quick
def test_one_orbit_on_a_circle_is_not_halved(texts, monkeypatch):
    """Its halves would be the same orbit, of the most points that are followed."""
    monkeypatch.setattr(check, "MAX_SITES", 20)
    claim = claim_of(general(texts["trig274"], [((1, 0), Fraction(1, 2), Fraction(1, 2), [])],
                             (Fraction("0.6"), 0), (1, 0), xstar=(0, 0)))
    why, pieces = check.Criterion(claim).excluded(check.ROOT)
    assert pieces == 1 and "contradicts nothing over 40 points" in why


def at_once(text, centre, half, together):
    text = with_parameters(with_tree(text, "P"), *zip(centre, half))
    text = with_field(with_field(text, "together", together), "at once", "yes")
    claim = claim_of(text)
    return bool(claim.examined) and check.Criterion(claim).at_once()


def test_at_once(texts, generator, monkeypatch):
    """True above B = 10/3, false below, of either sign; false with the origin in the box."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    text = texts["trig274"]
    for n in range(2 * min(TORTURE, 3)):
        abc = [exact_decimal(generator, 1) * generator.choice((0, 1, 1)) for _ in range(3)]
        B = true_bound(list(map(float, abc)))
        scale = Fraction(round(4e9 / 3 / (B - 2)), 10 ** 9) if any(abc) else 1
        for factor, right in (("1.001", any(abc)), ("3", any(abc)), ("0.999", False), ("0", False)):
            centre = [p * scale * Fraction(factor) for p in abc]
            for together in ("no", "yes"):
                assert at_once(text, centre, (0, 0, 0), together) is right
            # A box is as good as its worst point; parameters that move together as their upper end.
            assert not at_once(text, centre, [abs(p) * Fraction("1.01") for p in centre], "no")
            lower = [p - Fraction("0.25") for p in centre]
            assert at_once(text, lower, [Fraction("0.25")] * 3, "yes") is right
            half = [abs(exact_decimal(generator, "0.01")) for _ in range(3)]
            found = at_once(text, centre, half, "no")
            assert not found or right
            if found and n < 2:
                assert min(true_bound([float(p + s * h) for p, h, s in zip(centre, half, corner)])
                           for corner in itertools.product((-1, 0, 1), repeat=3)) > 10 / 3
            assert not right or found or factor == "1.001"


# ---- other potentials and frames

HALF_PI = "1.5707963267948966"
PROBLEMS = {                # waves, what else is said of them, and where minimizing is contradicted
    "the standard map": ([((1, 0), 0, "1.2", ["0.01"])], {"odd": "0 0"}, (HALF_PI, 0)),
    "with harmonics": ([((1, 0), 0, "0.98", ["0.01", 0]), ((2, 0), "-1/3", "0.1", [0, "0.02"])], {},
                       ("1.45", 0)),
    "(1, -1)": ([((1, 0), "1/2", "1.2", ["0.01"]), ((1, -1), 0, "0.4", ["-0.02"])],
                {"odd": "-1/2 1/2"}, (0, "-1.5")),
    "in a frame": ([((1, 1), 0, "0.62", [])], {"frame": (1, 0, -1, 1), "odd": "0 0"},
                   (HALF_PI, 0)),
    "a patch": ([((1, 0), 0, "0.6", ["0.01", "0.004", 0]),
                 ((0, 1), 0, "0.6", ["0.01", "-0.004", 0]),
                 ((1, 1), 0, "0.6", ["0.01", 0, "0.02"])], {"odd": "0 0"}, ("0.858", "0.858")),
    "one alone": ([((1, 0), 0, "1.3", ["0.1"]), ((0, 1), 0, "0.01", ["0.01"])],
                  {"alone": "0", "odd": "0 0"}, (HALF_PI, 0))}


@pytest.fixture(scope="module")
def others(texts, tmp_path_factory):
    """Proof files of other potentials, by name."""
    found = {}
    for name, (waves, more, xstar) in PROBLEMS.items():
        text = general(texts["trig274"], waves, tree="P", xstar=xstar, **more)
        tree = found_tree(claim_of(text), 20000)
        tree = "01PP1PP" if tree == "P" else tree           # something to alter
        found[name] = sealed(with_tree(with_field(text, "depth", 99), tree))
    return found


@pytest.mark.parametrize("name", PROBLEMS)
def test_confirms_other_potentials(others, run, name):
    text = others[name]
    status, out, err = run(text)
    assert (status, err) == (0, "") and out.startswith("Verified :")
    assert tree_of(text).count("P") > 3 and "multiple" not in out
    waves, more, _ = PROBLEMS[name]
    if name == "with harmonics":
        assert "\n-1 <= t1 <= 1\n-1 <= t2 <= 1\n" in out
        assert " - (0.1 + 0.02 t2) sin(2 y - 1/3 pi)" in out
    assert ("Alone : y0" in out) == (name == "one alone")
    assert run(text, "--exact")[0] == 0 or len(tree_of(text)) > 300


@pytest.mark.parametrize("name", PROBLEMS)
def test_no_orbit_of_a_leaf_of_other_potentials_minimizes(others, generator, name):
    claim = claim_of(others[name])
    cells = [cell for at, cell in check.leaves(claim.tree) if claim.tree[at] == "P"]
    waves = waves_of(claim)
    for _ in range(60):
        amplitudes, v = random_point(generator, claim, generator.choice(cells))
        x1 = in_frame(claim.frame, [real(x) * mp.pi for x in v])
        assert not definite([real(p) for p in amplitudes], [real(x) for x in claim.xstar], x1, 25,
                            waves=waves)


@pytest.mark.parametrize("name, field, value, status, why", [
    ("a patch", "frame", "1 2 2 4", 1, "determinant"), ("a patch", "alone", "0", 1, "both"),
    ("a patch", "alone", "2", 1, "neither"), ("a patch", "alone", "yes", 1, "neither"),
    ("one alone", "alone", "1", 5, "not excluded"), ("one alone", "alone", "no", 0, ""),
    ("a patch", "odd about", "1/2 0", 1, "not odd"), ("a patch", "odd about", "1/0 0", 1, "two"),
    ("a patch", "odd about", "yes", 1, "two"), ("a patch", "odd about", "1 -7", 0, ""),
    ("(1, -1)", "odd about", "1/2 -1/2", 0, ""), ("(1, -1)", "odd about", "0 0", 1, "not odd"),
    ("(1, -1)", "odd about", "1/2 0", 1, "not odd"),
    ("with harmonics", "odd about", "0 0", 1, "not odd"),
    ("with harmonics", "at once", "yes", 1, "only where V is odd"),
    ("with harmonics", "at once", "upper end", 1, "only where V is odd"),
    ("a patch", "at once", "upper end", 1, "no upper end"),
    ("in a frame", "at once", "upper end", 1, "no upper end"),
    ("in a frame", "at once", "yes", 5, "B > 10/3"),
    ("the standard map", "at once", "upper end", 5, "B > 10/3"),
    ("one alone", "at once", "upper end", 0, ""), ("one alone", "at once", "yes", 5, "B > 10/3"),
    ("a patch", "wave", "1 0 0", 1, "K0 K1"), ("a patch", "wave", "1 0 0 1 0 0 0 0", 1, "K0 K1"),
    ("a patch", "wave", "1 0 0 0.6 0.01", 1, "as many"),
    ("a patch", "wave", "0 0 0 1 0 0 0", 1, "zero"),
    ("a patch", "wave", "1 101 0 1 0 0 0", 1, "beyond 100"),
    ("a patch", "wave", "1 1 0 1e301 0 0 0", 5, "out of range"),
    ("a patch", "wave", "1 1 1/2 0.6 0.01 0 0.02", 1, "not odd")])
def test_header_of_other_potentials(others, run, name, field, value, status, why):
    text = re.sub("(?m)^%s: .*$" % field, "%s: %s" % (field, value), others[name], count=1)
    if status == 0 and others[name] != text:
        assert "wrong checksum" in run(text)[2]
    found, out, err = run(sealed(text))
    assert found == status and why in err and err.count("\n") == (status != 0)
    assert (out == "") == (status != 0)


@pytest.mark.parametrize("waves, order", [
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, [0, "0.1"])], (1, 0)),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, ["0.1", 0])], (0, 1)),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, ["0.1", "0.1"])], None),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, [0, "0.2"])], None),
    ([((1, 0), 0, 1, []), ((0, 1), 0, 1, [])], ()),
    ([((1, 0), 0, 1, []), ((0, 1), 0, 2, [])], None),
    ([((1, -1), "1/2", 1, [])], ()), ([((1, -1), 0, 1, [])], None), ([((1, -1), 1, 1, [])], None),
    ([((1, -1), 0, 1, []), ((-1, 1), 0, 1, [])], ()),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "7/3", 1, ["0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, -1), "2/3", 1, ["0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "4/3", -1, ["-0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "4/3", 1, ["0.1"])], None),
    ([((1, 2), 0, 1, ["0.1", 0, 0]), ((2, 1), 0, 1, [0, "0.1", 0]), ((1, 1), 0, 1, [0, 0, 1])],
     (1, 0, 2)),
    ([((1, 2), 0, 1, [0, "0.1", 0]), ((2, 1), 0, 1, [0, 0, "0.1"]), ((1, 1), 0, 1, [1, 0, 0])],
     (0, 2, 1))])
@pytest.mark.quick
def test_which_potentials_are_symmetric(texts, generator, waves, order):
    """V with its coordinates exchanged is V with its parameters in that order, or never."""
    claim = claim_of(general(texts["trig274"], waves, xstar=("0.5", "0.5")))
    orders = check.Mirror(claim).orders
    assert (order in orders) if order is not None else orders == []

    def V(t, y):
        return sum(wave.at(t) * mp.sin(angle_at((wave.k, wave.phase), y)) for wave in claim.waves)

    for _ in range(20):
        t = [near(generator) for _ in range(claim.parameters)]
        y = [real(near(generator)) * 4 for _ in "01"]
        for found in orders:
            image = [t[m] for m in found]
            assert abs(sum(real(wave.at(t)) * mp.sin(angle_at((wave.k, wave.phase), y[::-1]))
                           - real(wave.at(image)) * mp.sin(angle_at((wave.k, wave.phase), y))
                           for wave in claim.waves)) < mp.mpf(10) ** -50
    for more in ({"frame": (0, 1, 1, 0)}, {"v0": (1, 2)}, {"xstar": ("0.5", "0.6")}):
        text = general(texts["trig274"], waves, **{"xstar": ("0.5", "0.5"), **more})
        assert check.Mirror(claim_of(text)).orders == []


@pytest.mark.quick
def test_a_linked_leaf_is_no_proved_mirror_image(texts):
    text = general(texts["trig274"], [((1, 0), 0, 1, []), ((0, 1), 0, 1, [])],
                   xstar=("0.5", "0.5"))
    for tree, proved in ("01PP1SP", True), ("01Pa1SP", False):
        claim = dataclasses.replace(claim_of(text), tree=tree)
        cell, = [cell for at, cell in check.leaves(tree, kinds="PSa") if tree[at] == "S"]
        assert (check.Mirror(claim).refusal(cell) is None) == proved


@pytest.mark.quick
def test_coefficients_are_those_of_the_potential(generator):
    for _ in range(100):
        waves = [check.Wave(k, phase + generator.randint(-3, 3), exact_decimal(generator, 1),
                            (exact_decimal(generator, 1),)) for k, phase in
                 generator.choices(OTHERS, k=5)]
        waves += [check.Wave((-k[0], -k[1]), phase, exact_decimal(generator, 1), (ZERO,))
                  for k, phase in generator.choices(OTHERS, k=3)]
        found = check.coefficients(waves)
        y, t = [real(near(generator)) * 4 for _ in "01"], near(generator)
        total = sum(real(p + t * g) * mp.sin(angle_at(key, y)) for key, (p, g) in found.items())
        assert abs(total - sum(real(wave.at((t,))) * mp.sin(angle_at((wave.k, wave.phase), y))
                               for wave in waves)) < mp.mpf(10) ** -50
        assert all(k > (0, 0) and 0 <= phase < 1 for k, phase in found)


# ---- the tree

def random_tree(generator, depth, axes="01"):
    if depth == 0 or generator.random() < 0.25:
        return generator.choice("PPPS")
    return generator.choice(axes) + "".join(random_tree(generator, depth - 1, axes) for _ in "01")


@pytest.mark.parametrize("together, axes", [("no", "01"), ("no", "01234"), ("yes", "012"),
                                            ("no", "23"), ("no", "0123")])
def test_mirror_images_against_boxes(texts, generator, together, axes):
    text, seen = with_field(texts["trig274"], "together", together), set()
    swapped = (1, 0, 2, 3, 4) if together == "yes" else (1, 0, 3, 2, 4)
    for _ in range(300):
        tree = random_tree(generator, generator.randint(1, 7), axes)
        mirror = check.Mirror(claim_of(with_tree(text, tree)))
        boxes = [(tree[at], [(Fraction(i, 2 ** k), Fraction(i + 1, 2 ** k))
                             for i, k in zip(*cell)], cell) for at, cell in check.leaves(tree)]
        assert sum(math.prod(high - low for low, high in box) for _, box, _ in boxes) == 1
        for node, box, cell in boxes:
            if node == "S":
                image = [box[axis] for axis in swapped]
                clear = all(kind == "P" for kind, other, _ in boxes
                            if all(a < d and c < b for (a, b), (c, d) in zip(image, other)))
                assert (mirror.refusal(cell) is None) == clear
                seen.add(clear)
    assert seen == {True, False}
