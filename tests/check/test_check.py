"""The checker confirms what is proved and rejects everything else, of the thesis's waves."""

import gzip
import hashlib
import json
import math
import operator
import random
import re
from fractions import Fraction

import pytest
from files import sealed, tree_of

from converse import StandardMap, prove, read_input
from converse.model.map import LINE

from checker import check
from claims import definite, general, mp, real
from trees import INPUTS, claim_of, is_together, part_of, with_field, with_parameters, with_tree

pytestmark = pytest.mark.usefixtures("impatient")


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
