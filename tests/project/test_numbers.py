"""What README.md and docs/ say in numbers, and a command counts, is what it counts.

Seconds and megabytes are those of the machine that is named there, and are not looked at."""

import functools
import re
import runpy
from fractions import Fraction
from pathlib import Path

import chart
import mpmath
import pytest
import reading
from pages import PAGES, ROOT, columns, golden, is_near, missing, number, rows

from converse import Problem, check, orbits, prove, read_input
from converse.model.map import MuldoonMap, SymplecticMap

from truth import TORTURE


@functools.lru_cache(maxsize=None)
def sharper(problem, xstar=None):
    proof = prove(problem, method="loewner", xstar=xstar)
    assert proof.no_tori
    return proof.counts


def given(name, together=False):
    path = ROOT / "inputs" / name
    problem = read_input(path)
    return problem.tied() if together else problem


# ---- what the prover counts

def test_the_standard_map():
    head, *table = columns("method.md", "k")
    assert head == ("k", "longest orbit", "prisms", "CPU seconds")
    for k, points, prisms, _ in table[:None if TORTURE > 1 else -1]:     # the last takes longest
        counts = sharper(Problem(MuldoonMap(k, 0, 0)))
        assert (counts.max_NTsteps, counts.proved) == (number(points), number(prisms))


def test_the_inputs_of_the_standard_map():
    """Their points and prisms are those of the golden outputs."""
    for name, _, points, prisms in rows("method.md", "input")[1:]:
        report = golden("loewner/" + re.match("`(.*?).in`", name)[1])
        assert [number(points), number(prisms)] == [
            number(re.search(words, report)[1]) for words in (
                "orbits of up to ([0-9,]+) points", "Search +([0-9,]+) prisms proved")]


def test_the_files_of_the_inputs():
    """The page lists each file, and the prisms of its proof are those of the golden output."""
    head, *table = rows("inputs.md", "file")
    listed = {row[0].strip("`"): row for row in table}
    assert listed.keys() == {path.name for path in (ROOT / "inputs").iterdir()}
    for name, (_, _, _, command, prisms) in listed.items():
        kind = "loewner" if "loewner" in command else "sound"
        report = ROOT / "golden_outputs" / kind / (Path(name).stem + ".out")
        assert report.exists() == bool(prisms), name
        for count in re.findall("[0-9]+(?:,[0-9]{3})*", prisms):
            assert re.search(r"\b(%s|%d) (successful|prisms|were|linked)" % (
                count, number(count)), report.read_text("utf-8")), name


def test_the_tutorial_of_a_map(tmp_path):
    """The file that it has one write is proved as it says."""
    (tmp_path / "mine.json").write_text(
        re.findall(r"```json\n(.*?)```", PAGES["first-map.md"], re.DOTALL)[1])
    counts = sharper(read_input(tmp_path / "mine.json"))
    assert missing("first-map.md", counts.proved, counts.max_NTsteps) == []


def patch(waves, *amplitudes):
    return Problem(SymplecticMap(waves, [Fraction(p) for p in amplitudes]))


COS = "-1/2"
FROESCHLE = [(1, 0, COS), (0, 1, COS), (1, 1, COS)]
POINTS = {                              # by how a row begins: the input, and the problem of a point
    "standard map": ("standard", lambda K: patch([(1, 0, COS)], K)),
    "two harmonics, K2 = 0.4": ("two-harmonics",
                                lambda K: patch([(1, 0, COS), (2, 0, COS)], K, "0.2")),
    **{"Froeschlé, B = " + B: ("froeschle-" + B, lambda K, B=B: patch(FROESCHLE, K, K, B))
       for B in ("0.1", "0.3", "0.5")},
    "crossed": ("crossed", lambda s: patch(
        [(1, 0), (0, 1), (1, 1), (1, -1)],
        *(Fraction(s) * Fraction(p) for p in ("0.4", "0.4", "0.3", "0.1")))),
}


def test_other_maps():
    """Their prisms, and the points that are proved with the program's x*."""
    head, *table = rows("method.md", "map")
    assert head[:4] == ["map", "input", "prisms", "point"] and len(table) == len(POINTS)
    for name, said_of_input, prisms, point, *_ in table:
        file, at = POINTS[name.partition(":")[0]]
        problem = given(file + ".json")
        for end in re.findall(r"[0-9.]+[0-9]", said_of_input):
            assert any(Fraction(end) in pair for pair in _named_ends(problem)), name
        assert sharper(problem).proved == number(prisms)
        assert sharper(at(point)).proved


def _named_ends(problem):
    """The ends of the parameters that an input names."""
    return [ends for _, *ends in problem.parameters]


def test_another_xstar():
    """For two harmonics, and for B = 0.3, where the program's choice needs links."""
    for name, at, xstar in (("two harmonics, K2 = 0.4", "0.6", ("1.836", "0")),
                            ("Froeschlé, B = 0.3", "0.62", ("0.31", "3.04"))):
        assert missing("method.md", xstar[0], at) == []
        assert not sharper(POINTS[name][1](at), xstar=xstar).linked


@pytest.mark.slow
def test_the_torus_of_the_tutorial(tmp_path):
    """Residuals differ between machines, by a factor of two."""
    from converse import tori

    text = re.findall(r"```json\n(.*?)```", PAGES["first-map.md"], re.DOTALL)[1]
    (tmp_path / "mine.json").write_text(text.replace('["0.5", "2"]', '["0.1", "0.1"]'))
    proof = tori.prove(tori.find(read_input(tmp_path / "mine.json").map, "spiral"))
    for value in proof.residual, proof.needed, proof.distance:
        assert is_near("first-map.md", float(value), 3)


def test_the_thesis_method():
    for name, *_, prisms in rows("speed.md", "")[2:]:
        assert prove(given(name + ".in"), method="thesis").counts.proved == number(prisms)


def test_the_line():
    """Down to epsilon 0.0140, which takes a minute, only where much is asked for."""
    head, *table = rows("speed.md", "down to epsilon")
    assert head[2:5] == ["prisms proved", "longest orbit", "deepest cut"] and len(table) == 9
    for epsilon, _, prisms, points, cuts, _ in table:
        epsilon = epsilon.partition(" ")[0]
        if epsilon != "0.0140" or TORTURE > 1:
            counts = sharper(chart.on_line(epsilon, "0.0280", together=True))
            assert [counts.proved, counts.max_NTsteps, counts.most_cuts] \
                == [*map(number, (prisms, points, cuts))], epsilon
    counts = sharper(chart.on_line("0.01405", together=True))
    assert missing("speed.md", "0.01405", counts.proved, counts.most_cuts,
                   counts.max_NTsteps) == []


def test_what_coq_proves():
    """As many leaves as the proofs have now."""
    counts = {name: number(count.split()[0]) for names, count, *_ in rows("coq.md", "theorem")[1:]
              for name in re.findall("`(trig[0-9]+)`", names)}
    assert len(counts) >= 12
    assert counts == {name: sharper(given(name + ".in", together=True)).proved for name in counts}


def test_fewer_places():
    head, *table = rows("limits.md", "places")
    for name, *found in table:
        problem = given(name.partition(",")[0] + ".in")
        for places, prisms in zip(head[1:], found):
            proof = prove(problem, digits=int(places.split()[0]))
            assert prisms == (str(proof.counts.proved) if proof.no_tori else "lost"), (name, places)


def test_towards_the_wall():
    head, *table = columns("limits.md", "epsilon")
    assert head == ("epsilon", "prisms", "deepest cut")
    for epsilon, prisms, cuts in table[:None if TORTURE > 1 else -1]:    # the last takes longest
        counts = prove(chart.on_line(epsilon), digits=20).counts
        assert (counts.proved, counts.most_cuts) == (number(prisms), number(cuts))
    assert missing("limits.md", sharper(Problem(MuldoonMap("0.2", "0.35", "0.5"))).proved) == []


def test_the_pieces_of_the_checker(tmp_path, capsys):
    """A piece more or less of a thousand, since numpy's sums may differ in their last bits."""
    path = tmp_path / "148.proof"
    prove(given("trig148.in", together=True), method="loewner").save(path)
    assert check.main([str(path)]) == 0
    proved, pieces = re.search("Proved leaves checked : ([0-9]+), in ([0-9]+) pieces",
                               capsys.readouterr().out).groups()
    assert is_near("speed.md", int(pieces) / int(proved), 1.05)


# ---- what orbits.prove finds

def test_how_far_down_orbits_are_proved():
    """The first of the table, where little is asked for, each followed from eps 0."""
    head, *table = columns("proved-orbits.md", "trig (1432, 1897)/2513, eps")
    assert head[1:] == ("second variation at least", "smaller exponent", "places, seconds")
    for eps, least, exponent, places in table[:3 if TORTURE > 1 else 1]:
        state = orbits.follow(orbits.trig, (1432, 1897), 2513, [float(eps)])[-1]
        proved = orbits.prove(state)
        assert float(least) <= float(proved.least) < 1.1 * float(least)
        assert "%.1e" % proved.exponents[1][0] == "%.1e" % float(exponent)
        assert proved.digits == int(places.partition(",")[0])


def test_how_large_the_thousand_vectors_are():
    toughest = runpy.run_path(str(ROOT / "experiments" / "toughest.py"))
    size = toughest["SIZES"]["full"]
    q = [q for _, q in toughest["spread"](size["vectors"], size["q"])]
    assert len(q) == 1000
    assert missing("questions-of-1989.md", str(min(q)), str(max(q))) == []


# ---- what can be counted in the files

@pytest.mark.parametrize("page, files", [
    ("method.md", "converse/check/*.py"), ("trust.md", "converse/check/*.py"),
    ("coq.md", "formal/Map.v"), ("trust.md", "formal/verified.ml"),
    ("trust.md", "formal/roundings.py")])
def test_lines(page, files):
    found = sum(len(file.read_text("utf-8").splitlines()) for file in ROOT.glob(files))
    assert is_near(page, found, 1.05)


def test_what_runs_is_what_a_referee_reads(tmp_path):
    head, *table = rows("checker.md", "file")
    found = reading.lists(tmp_path, ROOT)
    assert {name for name, *_ in table} == set(found) and len(head) == 3
    for name, modules, lines in table:
        ran, count = found[name]
        assert set(re.findall("`([a-z_]+)`", modules)) == ran
        assert number(lines) == pytest.approx(count, rel=0.05) and count <= 2000


@pytest.fixture(scope="module")
def accuracy():
    """tests/accuracy.py, at work."""
    import accuracy

    with mpmath.workdps(accuracy.DIGITS):
        yield accuracy


def test_the_table_of_accuracy(accuracy):
    """docs/development/accuracy.md was printed by tests/accuracy.py: its head and the words of its
    rows."""
    page = PAGES["accuracy.md"]
    assert page.startswith(accuracy.HEAD % accuracy.DIGITS)
    printed = re.findall(r"^\| (.*?) \| (.*?) \| (.*?) \|.*\|$", page, re.MULTILINE)
    assert printed == [row[:3] for row in accuracy.ROWS]
    for _, algorithm, _ in printed:
        assert all(list((ROOT / "csrc").rglob(file))
                   for file in re.findall(r"\w+\.(?:[ch]|inc)\b", algorithm))


def test_files_that_are_named_exist():
    """In the pages and in the comments of the C core; of C, and ours."""
    names = []
    for text in PAGES.values():
        names += re.findall(r"(?<![\w./])[\w/]*\w\.(?:[ch]|inc)\b(?! *\[)", text)
    for file in (ROOT / "csrc").rglob("*.*"):
        for comment in re.findall(r"/\*.*?\*/", file.read_text("utf-8"), re.DOTALL):
            names += re.findall(
                r"(?<![\w<.>/])(?:[\w-]+/)*[a-z_]\w{2,}\.(?:[ch]|inc)\b(?!\w|\[|->)", comment)
    for file in (ROOT / "converse").rglob("*.py"):
        names += re.findall(r"csrc/[\w/]+\.(?:[ch]|inc)\b", file.read_text("utf-8"))
    missing = {name for name in names if not any(
        ("/" + str(path.relative_to(ROOT))).endswith("/" + name)
        for path in (ROOT / "csrc").rglob("*.*"))}
    assert len(names) > 50 and not missing
