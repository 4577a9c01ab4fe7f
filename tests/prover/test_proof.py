"""Proofs: what prove returns, the proof file, and continuing from it."""

import gzip
import math
import signal
import threading
import time
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from conftest import around
from files import sealed

from converse import (ConverseError, Counts, FourierMap, Problem, Proof, Settings, StandardMap,
                      check, prove, read_input)
from converse.commands.prove import parser
from converse.draw import plot
from converse.model.map import THESIS, MuldoonMap, SymplecticMap
from converse.model.problem import IDENTITY
from converse.prover import native, run
from converse.prover.report import verdict
from converse.prover.resume import continued
from converse.prover.settings import FILED, LIMIT, MAY_CHANGE, SETTINGS
from converse.prover.tree import leaves
from converse.storage import files
from converse.version import __version__

from moments import PATIENCE

NUMBERS = {"ll_used": (3, 2, 1), "reasons": (1, 2, 3, 4, 5, 6), "quick_tries": 7}


@pytest.fixture(scope="session")
def problem(root):
    return read_input(root / "inputs" / "trig274.in")


@pytest.fixture(scope="session")
def proof(problem):
    return prove(problem, method="thesis")


def test_theorem(proof):
    assert proof.no_tori and proof.all_decided and proof.undecided == []
    counts = proof.counts
    assert (counts.cuts, counts.proved, counts.symmetric, counts.undecided) == (
        sum(map(proof.tree.count, "01")), *map(proof.tree.count, "PSU"))
    assert counts.proved + counts.symmetric == counts.cuts + 1
    assert counts.most_cuts == max(leaf.depth for leaf in leaves(proof.problem, proof.tree, "P"))
    assert counts.HermSuccess + counts.LLSuccess == counts.proved
    assert "I find no invariant tori" in proof.report()


def test_symmetric_prisms_mirror_examined_ones(proof):
    """A prism is skipped only on the side v1 >= v0 of the diagonal."""
    for leaf in leaves(proof.problem, proof.tree, "S"):
        assert leaf.centre[1] - leaf.half[1] >= leaf.centre[0] + leaf.half[0]


def test_as_printed_is_no_proof(problem):
    result = prove(problem, as_printed=True)
    assert result.all_decided and not result.no_tori


def test_undecided(problem):
    stopped = prove(problem, depth=3, method="thesis")
    assert not stopped.no_tori and len(stopped.undecided) == 1
    assert stopped.tree.endswith("U") and stopped.counts.undecided == 1
    stubborn = prove(problem, depth=3, stubborn=True, method="thesis")
    assert not stubborn.no_tori
    assert len(stubborn.undecided) == stubborn.counts.undecided > 1
    assert all(leaf.depth == 3 for leaf in stubborn.undecided)
    assert stubborn.tree.startswith(stopped.tree)


def test_progress(problem, proof):
    fractions = []
    result = prove(problem, progress=lambda fraction, counts: fractions.append(fraction),
                   method="thesis")
    assert result == proof
    assert fractions[0] == 0 and fractions[-1] == 1 and all(0 <= x <= 1 for x in fractions)


def test_two_threads(problem, proof, root):
    other = read_input(root / "inputs" / "trig272.in")
    results = {}

    def work(name, *arguments, **options):
        results[name] = prove(*arguments, method="thesis", **options)

    threads = [threading.Thread(target=work, args=(name, it), kwargs=options)
               for name, it, options in (("first", problem, {}), ("second", problem, {}),
                                         ("other", other, {"digits": 20}))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results["first"] == results["second"] == proof
    assert results["other"] == prove(other, digits=20)


# ---- the proof file ---------------------------------------------------------------------

@pytest.mark.parametrize("name", ["a.proof", "a.proof.gz"])
def test_round_trip(tmp_path, made_up, name):
    for tree, options in (
            ("0P1SU", {"stubborn": True, "seconds": 3.25}), ("", {}), ("0" * 300, {}),
            ("0PS", {"as_printed": True, "comments": ("", "a: b", "tree:", "\u03b5 \u00fc"),
                     "a": "0.123456789012345678901234567890"})):
        proof = made_up(tree, **options)
        proof = replace(proof, counts=replace(proof.counts, **NUMBERS))
        proof.save(tmp_path / name)
        known = 0 if proof.all_decided else proof.seconds       # not a matter of the proof
        assert Proof.load(tmp_path / name) == replace(proof, seconds=known)
        report = Proof.load(str(tmp_path / name)).report()
        assert report.split("Restored")[0].split("Proof file")[0] == \
            replace(proof, seconds=known).report()
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_region_without_width_is_loaded(tmp_path, made_up):
    proof = made_up("P", v=("1", "1", "0", "0.5"))
    proof.save(tmp_path / "proof")
    assert Proof.load(tmp_path / "proof").problem == proof.problem


def test_file_says_what_it_is(tmp_path, made_up):
    made_up("0PS").save(tmp_path / "sound")
    made_up("0PS", as_printed=True).save(tmp_path / "printed")
    sound, printed = [(tmp_path / name).read_text().split("\n") for name in ("sound", "printed")]
    assert sound[0] == printed[0] == "converse proof 6" and sound[-2:] == ["end", ""]
    assert "kind: sound" in sound and "kind: as printed, not a proof" in printed
    assert {"wave: 1 0 0 0.3085 0.00125 0 0", "wave: 0 1 0 0.3085 0 0.00125 0",
            "wave: 1 1 0 0.617 0 0 0.0025", "frame: 1 0 0 1", "odd about: 0 0", "alone: no",
            "v0: 1 1", "depth: 30", "program: converse %s" % __version__} <= set(sound)
    assert all(len(line) < 82 for line in sound)


def test_save_keeps_the_older_file(tmp_path, made_up, monkeypatch):
    path = tmp_path / "a.proof"
    made_up("P").save(path)
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(ConverseError, match="No space left on device.*intact"):
        made_up("0PP").save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


# ---- continuing -------------------------------------------------------------------------

@pytest.fixture
def interrupted(monkeypatch):
    """A run that Ctrl-C ends after so many leaves."""
    def interrupted(problem, backup, leaves_done, **options):
        work = native.Search.work
        if problem is not None:
            options["method"] = "thesis"

        def struck(self, threads, look):
            work(self, threads, look, leaves_done)
            if threads:
                raise KeyboardInterrupt
            return True

        with monkeypatch.context() as patch:
            patch.setattr(native.Search, "work", struck)
            with pytest.raises(KeyboardInterrupt):
                prove(problem, backup=backup, jobs=2, **options)
    return interrupted


@pytest.mark.parametrize("leaves_done", [1, 2, 7, 30])
def test_interrupt_and_continue(tmp_path, problem, proof, leaves_done, interrupted):
    backup = tmp_path / "backup"
    interrupted(problem, backup, leaves_done)
    half = Proof.load(backup)
    assert not half.no_tori and proof.tree.startswith(half.tree)
    assert sum(map(half.tree.count, "PSU")) == leaves_done
    assert "before the whole region was examined" in half.report()
    whole = prove(resume=backup, backup=backup)
    assert whole == proof
    assert whole.seconds >= half.seconds
    assert Proof.load(backup) == proof
    assert [path.name for path in tmp_path.iterdir()] == ["backup"]


def test_continue_in_several_goes(tmp_path, problem, proof, interrupted):
    backup = tmp_path / "backup.gz"
    interrupted(problem, backup, 5)
    interrupted(None, None, 6, resume=backup)
    half = Proof.load(backup)
    assert sum(map(half.tree.count, "PSU")) == 11
    assert prove(resume=half) == proof


def test_continue_a_finished_proof(tmp_path, problem, proof):
    proof.save(tmp_path / "whole")
    again = prove(resume=tmp_path / "whole")
    assert again == proof
    assert again.report().split("This inv")[0] == proof.report().split("This inv")[0]


def test_continue_after_an_undecided_prism(problem):
    stopped = prove(problem, depth=4, method="thesis")
    assert prove(depth=4, resume=stopped) == stopped
    stubborn = prove(depth=4, resume=stopped, stubborn=True)
    assert stubborn == prove(problem, depth=4, stubborn=True, method="thesis")


def test_continue_as_printed(tmp_path, problem, interrupted):
    interrupted(problem, tmp_path / "backup", 9, as_printed=True)
    assert prove(resume=tmp_path / "backup") == prove(problem, as_printed=True)


def test_hints_stay_with_their_prisms(made_up):
    """A prism that was undecided is tried again without one, if it may be cut more often."""
    half = made_up("0U?", stubborn=True, pending=(7,))
    again = continued(half, "a.proof", {"depth": half.depth + 1})
    assert (again.tree, again.trees[0].pending, again.counts.undecided) == ("0??", (0, 7), 0)


@pytest.mark.parametrize("words, change, options", [
    (r"\(depth: there .*, here ", {}, {"depth": 29}),
    ("is of converse 0.9; continue it with that release", {"version": "0.9"}, {})])
def test_another_run_is_refused(proof, words, change, options):
    with pytest.raises(ConverseError, match=words):
        prove(resume=replace(proof, **change), **options)


@pytest.mark.parametrize("other", [
    {"as_printed": True}, {"as_printed": False}, {"digits": 36}, {"method": "loewner"},
    {"method": "thesis"}, {"xstar": ("0.8", "0.9")}, {"source": MuldoonMap(1, 1, 1)}])
def test_a_run_is_continued_as_it_was_asked_for(proof, other):
    with pytest.raises(ValueError, match="leave out the map, x. and the method"):
        prove(resume=proof, **other)


def test_a_tree_that_does_not_fit_is_refused(problem, proof):
    for tree in "PP", "1" * 40 + "P", "0P?":
        with pytest.raises((ConverseError, ValueError)):
            prove(resume=replace(proof.with_tree(0, text=tree), counts=Counts()))


def test_one_backup_for_two_runs_is_refused(tmp_path, problem):
    backup = tmp_path / "backup"
    messages = []

    def second(*_):
        with pytest.raises(ConverseError) as caught:
            prove(problem, backup=backup, method="thesis")
        messages.append(str(caught.value))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        prove(problem, backup=backup, progress=second, method="thesis")
    assert "another run is writing this file" in messages[0]
    assert prove(backup=backup, resume=backup).no_tori


def test_a_backup_destroys_nothing_else(tmp_path, problem):
    path = tmp_path / "precious"
    path.write_text("my notes")
    for place in path, tmp_path, "/dev/null", tmp_path / "missing" / "backup":
        with pytest.raises(ConverseError):
            prove(problem, backup=place, method="thesis")
    assert path.read_text() == "my notes"


def test_zero_half_widths(tmp_path):
    point = around((Fraction("0.32"), Fraction("0.32"), Fraction("0.64"), Fraction(1),
                     Fraction(1)), (Fraction(0),) * 3 + (Fraction(1),) * 2)
    assert prove(point, method="thesis").no_tori
    spot = around(point.centre[:3] + (Fraction("0.75"), Fraction("0.5")),
                          (Fraction(0),) * 5)
    result = prove(spot, depth=2, method="thesis")
    assert set(result.tree) <= set("01PSU")
    plot.write(result, tmp_path / "spot.svg")


# ---- what a proof says of itself ---------------------------------------------------------

def test_what_is_claimed(made_up):
    """Only the whole torus, wholly decided by the sound program, is a theorem, and true."""
    for tree, v, as_printed, conclusion in (
            ("0PS", ("1", "1", "1", "1"), False, "theorem"),
            ("0PS", ("3", "-1", "1.5", "1"), False, "theorem"),
            ("0PS", ("1", "1", "1", "0.999"), False, "region"),
            ("0PS", ("1", "1", "1", "1"), True, "as printed"),
            ("0PU", ("1", "1", "1", "1"), False, "undecided"),
            ("0P", ("1", "1", "1", "1"), False, "undecided"),
            ("", ("1", "1", "1", "1"), True, "undecided")):
        proof = made_up(tree, v=v, as_printed=as_printed)
        assert proof.conclusion == conclusion
        assert proof.no_tori == bool(proof) == (conclusion == "theorem")
        assert len(repr(proof)) < 200 and "tree" not in repr(proof)


@pytest.mark.parametrize("name", ["a.proof", "a.proof.gz"])
def test_two_runs_write_one_file(tmp_path, problem, name, interrupted):
    first, second = tmp_path / ("1" + name), tmp_path / ("2" + name)
    prove(problem, backup=first, jobs=1, method="thesis")
    interrupted(problem, second, 7)
    assert "seconds: " in _text(second)
    prove(resume=second, jobs=3)
    assert "seconds: " not in _text(second) and first.read_bytes() == second.read_bytes()


def _text(path):
    data = path.read_bytes()
    return (gzip.decompress(data) if path.suffix == ".gz" else data).decode()


def test_deeper(tmp_path, problem, proof):
    """What was given up for its depth is tried again; the rest is as it was."""
    path = tmp_path / "a.proof"
    shallow = prove(problem, depth=8, stubborn=True, backup=path, method="thesis")
    assert shallow.undecided
    deeper = prove(resume=path, depth=30)
    assert deeper.no_tori and deeper.tree == proof.tree and deeper.settings.stubborn
    assert deeper.restored == shallow.counts.proved + shallow.counts.symmetric
    assert Proof.load(path).no_tori
    with pytest.raises(ConverseError, match=r"\(depth: there 30, here 29\)"):
        prove(resume=path, depth=29)
    stopped = prove(problem, depth=8, method="thesis")
    assert prove(resume=stopped, depth=30).tree == proof.tree


def test_a_failing_backup_does_not_end_the_run(tmp_path, problem, proof, monkeypatch):
    path = tmp_path / "a.proof"
    monkeypatch.setattr("converse.storage.backup.SECONDS", 0.0)
    monkeypatch.setattr("converse.storage.backup.SHARE", 0)
    writes, write, work = [], files.write, native.Search.work

    def leaf_by_leaf(self, threads, look):
        while work(self, threads, look, 1) and threads and not look():
            pass
        return True

    monkeypatch.setattr(native.Search, "work", leaf_by_leaf)

    def full(name, data):
        writes.append(name)
        if 1 < len(writes) < 20:
            raise ConverseError("%s: cannot be written (No space left on device)" % name)
        write(name, data)

    monkeypatch.setattr(files, "write", full)
    with pytest.warns(RuntimeWarning, match="No space left on device.*tries again"):
        result = prove(problem, backup=path, jobs=1, method="thesis")
    assert len(writes) > 20 and result == proof
    assert Proof.load(path) == proof and result.sha256


def test_a_backup_that_cannot_be_begun_is_an_error(tmp_path, problem, monkeypatch):
    def full(name, data):
        raise ConverseError("%s: cannot be written" % name)

    monkeypatch.setattr(files, "write", full)
    with pytest.raises(ConverseError, match="cannot be written"):
        prove(problem, backup=tmp_path / "a.proof", method="thesis")


def test_a_long_set_up_obeys(problem, monkeypatch):
    """At a hundred thousand places pi alone takes seconds."""
    result = prove(problem, digits=100000, time_limit=0.2)
    assert result.tree == "" and result.constants == {}
    work, left, begun, done = native.Search.work, run._Run._seconds_left, [], []

    def tells(*arguments):
        begun.append(None)
        done.append(work(*arguments))

    def strikes(self):
        if begun:
            signal.raise_signal(signal.SIGINT)
        return left(self)

    monkeypatch.setattr(native.Search, "work", tells)
    monkeypatch.setattr(run._Run, "_seconds_left", strikes)
    with pytest.raises(KeyboardInterrupt):
        prove(problem, digits=100000)
    assert begun and not done           # it was left in the middle


@pytest.mark.slow
def test_a_long_prism_obeys(problem, proof, monkeypatch):
    """A rigorous try with thousands of digits is left in the middle, and nothing comes of it."""
    monkeypatch.setattr(native, "LOOK_SECONDS", 0.01)
    monkeypatch.setattr(run._Run, "_seconds_left", lambda self: (
        -math.inf if self.search is not None and self.view.counts.cuts else math.inf))
    began = time.monotonic()
    result = prove(problem, digits=20000, jobs=2)
    assert not result.all_decided and proof.tree.startswith(result.tree) and result.tree
    assert time.monotonic() - began < PATIENCE
    assert result.counts.Rtries == result.tree.count("P")


def test_verify(proof, problem, made_up):
    """The independent checker, from Python; what is not proved it does not verify."""
    result = proof.verify(jobs=2)
    assert result and "no invariant Lagrangian graph" in result.text
    assert not prove(replace(problem, v0=("0.5", "1")), depth=40, method="thesis").verify()
    for bad in (prove(problem, depth=3, method="thesis"), prove(problem, as_printed=True),
                proof.with_tree(0, text=proof.tree.replace("S", "P"))):
        with pytest.raises(check.Rejected):
            bad.verify()


@pytest.mark.parametrize("options, error", [
    ({"time_limit": float("nan")}, ValueError), ({"time_limit": -1}, ValueError),
    ({"time_limit": "5"}, ValueError), ({"time_limit": None}, ValueError),
    ({"jobs": 0}, ValueError),
    ({"jobs": "2"}, ValueError), ({"jobs": 2.5}, ValueError), ({"executor": 5}, TypeError),
    ({"as_printed": "no"}, ValueError), ({"stubborn": 1}, ValueError), ({"method": 3}, ValueError),
    ({"digits": "35"}, ValueError), ({"depth": 3.0}, ValueError)])
def test_what_prove_refuses(problem, options, error):
    with pytest.raises(error) as caught:
        prove(problem, **options)
    assert len(str(caught.value)) > 20
    for wrong in "x", None, 5:
        with pytest.raises(TypeError):
            prove(wrong, method="thesis")


def test_a_proof_of_nothing_can_be_shown(problem):
    nothing = prove(problem, digits=30000, time_limit=0)     # nor x*, which takes a while
    assert not nothing and nothing.xstar is None and nothing.report()
    # however long each took
    assert prove(problem, method="thesis") == prove(problem, method="thesis")


# ---- the format


@pytest.mark.parametrize("other", [2, 3, 4, 5, 7])
def test_other_formats_are_refused(made_up, tmp_path, other):
    path = tmp_path / "old.proof"
    made_up("P").save(path)
    path.write_text(sealed(path.read_text("utf-8").replace("proof 6", "proof %d" % other)))
    with pytest.raises(ConverseError, match="proof file of another version, which converse "
                       r"(.*) reads \(pip install converse-kam==\1\)$") as caught:
        Proof.load(path)
    assert "\n" not in str(caught.value)


def test_a_search_without_a_frame_is_continued_so(tmp_path, monkeypatch):
    """What was grown in the angles themselves, with all waves and on all of the torus, whatever is
    asked for anew."""
    monkeypatch.setattr(run, "reduced", lambda problem, xstar: problem)
    for problem in Problem(MuldoonMap(0, 0, "0.6")), Problem(MuldoonMap("1.1", "0.1", 0)):
        path = tmp_path / ("%d.proof" % bool(problem.abc[0][0]))
        plain = replace(problem, axes=IDENTITY, alone="no")
        half = prove(plain, method="loewner", depth=3, stubborn=True, backup=path)
        assert Proof.load(path).problem == plain != problem
        again = prove(resume=Proof.load(path), depth=9)
        assert again.problem == plain and len(again.tree) > len(half.tree)


PATCHES = {
    "thesis": Problem(MuldoonMap(("0.4", "0.5"), "0.4", ("0.4", "0.5"))),
    "segment": Problem(SymplecticMap(THESIS, ["0.4", "0.4", "0.4"], [["0.01", "-0.01", 0]])),
    "frame": Problem(MuldoonMap(0, 0, ("0.4", "0.5"))),
    "no frame": replace(Problem(MuldoonMap(0, 0, "0.5")), axes=IDENTITY),
    "other frame": replace(Problem(MuldoonMap(0, 0, "0.5")), axes=(2, 1, -1, -1)),
    "alone": Problem(MuldoonMap("0.5", ("0.3", "0.4"), 0)),
    "both": replace(Problem(MuldoonMap("0.5", "0.3", 0)), alone="no"),
    "other alone": replace(Problem(MuldoonMap("0.5", "0.3", 0)), alone=1),
    "part": Problem(MuldoonMap(1, 1, 1), v0=(0, "0.5")),
    "waves": Problem(SymplecticMap([(1, 0, "1/3"), (-7, 100, "-1/2")], ["0.4", "-1e-30"],
                                   [["1e-9", 0], [0, "12.5"], ["7", "-7"]]), v1=("0.25", "4/3"),
                     comments="c"),
    "circle": Problem(SymplecticMap([(k, 0, "1/7") for k in range(1, 17)], ["0.4"] * 16))}


@pytest.mark.parametrize("name", PATCHES)
def test_every_problem_has_a_file(made_up, tmp_path, name):
    problem = PATCHES[name]
    for at_once in (False, True) if problem.odd is not None else (False,):
        proof = replace(made_up("0PP", method="loewner").with_tree(0, problem=problem),
                        at_once=at_once, constants={"B": "3.5"}, seconds=0)
        proof.save(tmp_path / "a.proof")
        assert Proof.load(tmp_path / "a.proof") == proof
        text = (tmp_path / "a.proof").read_text()
        assert ("\nat once: %s\n" % (
            "no" if not at_once else "upper end" if len(problem.parts) == 1 else "yes")) in text
        assert text.count("\nwave: ") == len(problem.waves)
    assert proof.report() and repr(problem) and proof.plot()


@pytest.mark.parametrize("line, new", [
    ("frame", "frame: 1 1 1 1"), ("alone", ""), ("wave", "wave: 1 0 x 0.3 0 0 0"),
    ("v0", "v0: 1 -1"), ("at once", "at once: perhaps")])
def test_a_header_that_makes_no_sense(made_up, tmp_path, line, new):
    """The checker reads it, and its refusals are lines of the prover, too."""
    path = tmp_path / "a.proof"
    made_up("0PP").save(path)
    lines = path.read_text().split("\n")
    at = next(n for n, text in enumerate(lines) if text.startswith(line + ": "))
    lines[at:at + 1] = [new] if new else []
    path.write_text(sealed("\n".join(lines)))
    with pytest.raises(ConverseError, match="a.proof: .*; use an intact copy or start anew$"
                       ) as caught:
        Proof.load(path)
    assert "\n" not in str(caught.value)


def test_nothing_is_at_once_that_is_not_odd(made_up, tmp_path):
    problem = Problem(SymplecticMap([(1, 0), (2, 0, "1/2")], [1, 1]))
    replace(made_up("P").with_tree(0, problem=problem), at_once=True).save(tmp_path / "a.proof")
    with pytest.raises(ConverseError, match="excluded at once only where V is odd"):
        Proof.load(tmp_path / "a.proof")
    assert not prove(Problem(SymplecticMap(problem.waves, [4, 4])), method="loewner").at_once


def test_the_method_of_1989_takes_ranges_only():
    for problem, words in ((Problem(MuldoonMap(1, 1, 1).tied()), "move together"),
                           (Problem(SymplecticMap([(1, 0)], [1])), "method loewner")):
        with pytest.raises(ValueError, match=words):
            prove(problem, method="thesis")
    # in no frame, and with all waves
    for problem in Problem(MuldoonMap(0, 0, 2)), Problem(MuldoonMap(2, 2, 0)):
        proof = prove(problem, method="thesis")
        assert proof.problem.frame == IDENTITY and proof.problem.factor is None
        assert prove(resume=proof).tree == proof.tree


# ---- a point x* of one's own

def test_a_point_of_ones_own(problem, tmp_path):
    point = Problem(MuldoonMap("0.45", "0.45", "0.45"))
    for xstar in (("0.8", "0.95"), (Fraction(4, 5), Decimal("0.95"))):
        proof = prove(point, method="loewner", xstar=xstar,
                      backup=tmp_path / ("%s" % type(xstar[0])))
        assert proof.no_tori
        assert tuple(map(Fraction, proof.xstar)) == (Fraction("0.8"), Fraction("0.95"))
    assert prove(point, method="loewner").xstar != proof.xstar
    assert prove(problem, xstar=(0, 2), depth=2, method="thesis").xstar == ("0", "2")
    half = prove(point, method="loewner", xstar=("0.8", "0.95"), depth=2)
    assert prove(resume=half, depth=60).no_tori


@pytest.mark.parametrize("xstar, error", [
    (5, ValueError), ("12", ValueError), ((1,), ValueError), ((1, 2, 3), ValueError),
    ((1, 0.5), TypeError), ((1, None), TypeError), (("1", "x"), ValueError),
    (("1/3", 0), ValueError),
    (("1e400", 0), ValueError), (("nan", 0), ValueError)])
def test_a_point_that_is_none(problem, xstar, error):
    with pytest.raises(error, match="xstar"):
        prove(problem, xstar=xstar, method="thesis")


# ---- why a search ended

LINE, WEAK = (Problem(MuldoonMap(a, a, 2 * Fraction(a))) for a in ("0.3085", "0.02"))


@pytest.mark.parametrize("source, options, why", [
    pytest.param(StandardMap(k="0.9"), {}, "hopeless as seen", marks=pytest.mark.slow),
    (StandardMap(k=2), {}, ""),
    (WEAK, {"depth": 6}, "limit of depth"), (LINE, {"time_limit": 0}, "time"),
    (LINE, {"method": "thesis", "depth": 3}, "limit of depth"),
    (MuldoonMap("1e19", 0, 0), {}, "limit of doubles")])
def test_why_a_search_ended_is_a_value(source, options, why, tmp_path):
    proof = prove(source, **options)
    assert proof.ended == why and bool(why) != proof.all_decided
    proof.save(tmp_path / "a.proof")
    loaded = Proof.load(tmp_path / "a.proof")
    assert loaded.ended == why and loaded == proof
    if why:
        ends = {"time": "before the", "hopeless as seen": "hopeless"}.get(why, "at the " + why)
        sharper = replace(proof.settings, method="loewner")
        text = verdict(replace(proof, settings=sharper), "")
        assert "\nEnded      " + ends in text
        assert ("more time (-b" in text) == (why == "time")
        assert "larger parameters" not in text


@pytest.mark.slow
def test_a_range_with_circles_is_given_up_within_seconds(monkeypatch, tmp_path):
    """Cuts around the circles would go on for hours.  The end and its reason are saved, and the
    checker knows the field; a stubborn search goes on."""
    monkeypatch.setattr(run, "MANY_LEAVES", 500)
    path = tmp_path / "a.proof"
    proof = prove(StandardMap(k=("0.5", "1")), backup=path)
    assert proof.ended == "hopeless as seen" and 1000 <= proof.counts.tries < 100_000
    assert "U" not in proof.tree and "\nhopeless: yes\n" in path.read_text()
    with pytest.raises(check.Rejected, match="goes on with the search"):
        check.verify(path)
    again = prove(resume=path)
    assert again.hopeless and again.restored
    went_on = prove(resume=path, stubborn=True, time_limit=1)
    assert went_on.ended in ("time", "hopeless as seen") and went_on.seconds > proof.seconds


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.001, pytest.param(0.5, marks=pytest.mark.slow)])
def test_where_a_search_is_given_up_does_not_depend_on_when_it_is_looked_at(monkeypatch, seconds):
    monkeypatch.setattr(run, "MANY_LEAVES", 100)
    monkeypatch.setattr(native, "LOOK_SECONDS", seconds)
    proof = prove(StandardMap(k=("0.5", "1")), jobs=2)
    assert proof.hopeless and proof.counts.proved == 100
    assert proof.tree == prove(resume=proof, jobs=1).tree


@pytest.mark.slow
def test_whether_long_orbits_help_is_asked_once(monkeypatch, tmp_path):
    """A continued run has the answer, from the proof or from its file."""
    asked, path = [], tmp_path / "a.proof"
    monkeypatch.setattr(run, "MANY_LEAVES", 500)
    monkeypatch.setattr(run, "longest", lambda *_: asked.append(1) or native.ORDINARY)
    proof = prove(StandardMap("0.97"), backup=path)
    assert proof.hopeless and asked == [1] and "\nlong orbits: no\n" in path.read_text()
    for before in proof, path:
        assert prove(resume=before).longest == native.ORDINARY
    assert asked == [1]
    with pytest.raises(check.Rejected, match="claims no theorem|goes on with the search"):
        check.verify(path)


def test_a_narrower_range_is_advised_where_cuts_are_along_the_parameter(made_up):
    for tree, advised in ("022P", True), ("002P", False):
        text = made_up(tree, method="loewner").report()
        assert ("To try     a narrower range of parameters, or more time (" in text) == advised


# ---- values

def test_a_proof_is_a_value(problem):
    """Equal ones have one hash, and the text of one tells its map and range."""
    proof = prove(StandardMap(k=("2", "2.5")))
    assert len({proof, prove(StandardMap(k=("2", "2.5")))}) == 1
    assert "standard map" in repr(proof) and "2.5" in repr(proof)


def test_whole_numbers_are_those_of_numpy_too():
    proof = prove(LINE, depth=np.int64(50), jobs=np.int8(1))
    assert proof == prove(LINE, depth=50) and type(proof.depth) is int
    assert prove(LINE, digits=np.int32(20)).digits == 20
    for options in ({"depth": True}, {"jobs": 1.0}, {"jobs": 0}, {"digits": "9"}, {"depth": -1},
                    {"depth": LIMIT + 1}):
        with pytest.raises(ValueError, match="%s must be a whole number" % [*options][0]):
            prove(LINE, **options)


def test_the_method_of_settings_is_that_of_prove():
    assert Settings().method == prove(LINE, as_printed=False).method == "loewner"
    with pytest.raises(ValueError, match=r"digits \(--precision\) is of the method thesis alone"):
        prove(LINE, method="loewner", digits=20)


@pytest.mark.slow
def test_a_range_over_orders_of_magnitude_takes_few_prisms(tmp_path):
    """Its parameter is cut until the amplitudes are about the same in all of a cell, and the angles
    are not cut meanwhile.  The checker takes the small ones in doubles."""
    proof = prove(FourierMap({(1, "+cos"): {"K": 1}, (3, "+cos"): "0.05"}, K=("0.38", "1e9")))
    assert proof.no_tori and proof.counts.proved < 6000
    assert "in doubles" in proof.verify().text


def test_an_argument_that_prove_does_not_have_is_named():
    with pytest.raises(TypeError, match=r"prove\(\) has no argument deepness; the settings are m"):
        prove(LINE, deepness=9)


def test_a_setting_is_one_row():
    """Its flags and its keyword, and what a file and a continued run take, follow from the row."""
    parsed = parser().parse_args(["-d9", "-p20", "-s", "--as-printed", "--method", "thesis"])
    settings = Settings(**{name: getattr(parsed, name) for name in SETTINGS})
    assert settings == Settings("thesis", 9, 20, True, True)
    assert {*FILED, "method", "as_printed"} == set(SETTINGS) and {"depth", "stubborn"} == MAY_CHANGE
