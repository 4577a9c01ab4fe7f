"""Several starting points: what is proved over one is linked to others."""

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from files import line, sealed

from converse import ConverseError, Problem, Proof, Settings, StandardMap, check, prove, read_input
from converse.check.claim import Claim, Wave
from converse.check.criterion import Criterion
from converse.check.links import displacement
from converse.model import region
from converse.model.map import MuldoonMap, SymplecticMap
from converse.prover import links, native, run, starts, tree
from converse.prover.links import (SPARE, Link, Target, clusters, hull_of, least_slope, linked_tree,
                                   region_around)
from converse.prover.native import Counts
from converse.prover.proof import Tree
from converse.prover.resume import counted
from converse.prover.workers import WorkersGone
from converse.tori.find import find
from converse.tori.rotation import read_rotation

from moments import PATIENCE
from truth import TORTURE

DIAGONAL = 1, 1, 1, -1


def make_links_easy(monkeypatch):
    monkeypatch.setattr(run, "LONG", 15)
    monkeypatch.setattr(starts, "LOOK_DEPTH", 8)
    monkeypatch.setattr(starts, "SMALL_AREA", 1)
    monkeypatch.setattr(starts, "TRY_DEPTH", 6)
    monkeypatch.setattr(starts, "MAX_PROOF_LEAVES", 5)
    for name, steps in ("FINE", []), ("NEAR", [Fraction("0.032")]), ("FAR", []):
        monkeypatch.setattr(starts, name + "_STEPS", steps)


@pytest.fixture
def easily(monkeypatch):
    """Links are made of short orbits already, where one starting point would do."""
    make_links_easy(monkeypatch)


@pytest.fixture(scope="module")
def linked():
    with pytest.MonkeyPatch.context() as monkeypatch:
        make_links_easy(monkeypatch)
        return prove(line("0.015"), method="loewner")


# ---- the lemma

@pytest.mark.parametrize("problem, rotation", [
    (line("0.004"), "T49"),
    (Problem(SymplecticMap([
        (1, 0), (0, 1, Fraction(1, 8)), (1, -1, Fraction(1, 3))], ["0.05", "0.04", "-0.02"])),
     "spiral")])
@pytest.mark.parametrize("frame", [(1, 0, 0, 1), DIAGONAL, (2, -1, 1, 2)])
@pytest.mark.slow
def test_invariant_tori_obey_the_link(problem, rotation, frame):
    """The map of a torus that exists takes v' where the lemma says, for many pairs of points."""
    torus = find(Problem(SymplecticMap(problem.waves, problem.amplitude)), read_rotation(rotation))
    problem = Problem(SymplecticMap(problem.waves, problem.amplitude), axes=frame)
    rng = np.random.default_rng(5)
    inverse = np.linalg.inv(np.reshape(frame, (2, 2)))
    amplitude, k = np.array(problem.amplitude, float), np.array([w[:2] for w in problem.waves])
    phase = np.pi * np.array([float(w[2]) for w in problem.waves])
    largest = Fraction(2 + float(np.abs(amplitude) @ (k ** 2).sum(1))).limit_denominator(10 ** 9)
    for _ in range(25):
        theta = rng.uniform(0, 7, 2)
        points = np.array([theta, theta + rng.normal(0, 0.02, 2)])
        x, J = torus.x(points), torus.J(points)
        # V' = -sum of p k cos(k.x + phase), and f(x) = x + J - V'(x)
        v = (x + J + np.cos(x @ k.T + phase) @ (amplitude[:, None] * k)) @ inverse.T / np.pi
        here, there = (tuple("%.17f" % number for number in point) for point in x)
        for moved, (low, high) in zip(v[1] - v[0],
                                      Link.between(problem, largest, here, there).box):
            assert float(low) - 1e-12 < moved < float(high) + 1e-12


@pytest.mark.parametrize("frame", [(1, 0, 0, 1), DIAGONAL, (2, -1, 1, 2)])
def test_the_box_is_no_wider_than_the_lemma_needs(frame):
    """Close by, K is beta - l, and some symmetric matrix between l and K moves v to each end of the
    box: l + D^1/2 (1 + R)/2 D^1/2 with the reflection R that takes D^1/2 w to D^1/2 u."""
    problem = Problem(SymplecticMap([(1, 0), (0, 1), (1, 1)], ["0.15", "0.16", "0.3"]), axes=frame)
    x, w, B = np.array([0.85, 0.9]), np.array([3e-6, -2e-6]), Fraction("2.7")
    l = float(least_slope(B))
    s = [0.15 * np.sin(x[0]), 0.16 * np.sin(x[1]), 0.3 * np.sin(x.sum())]
    D = np.array([[2 - s[0] - s[2], -s[2]], [-s[2], 2 - s[1] - s[2]]]) - 2 * l * np.eye(2)
    size, axes = np.linalg.eigh(D)
    root = axes @ np.diag(size ** 0.5) @ axes.T
    box = Link.between(problem, B, *(tuple("%.12f" % y for y in z) for z in (x, x + w)))
    for u, (low, high) in zip(np.linalg.inv(np.reshape(frame, (2, 2))), box.box):
        a, b = (root @ y / np.linalg.norm(root @ y) for y in (u, w))
        for sign, end in (-1, low), (1, high):
            bisector = a + sign * b if abs(a + sign * b).max() > 1e-9 else np.array([-a[1], a[0]])
            R = 2 * np.outer(bisector, bisector) / bisector.dot(bisector) - np.eye(2)
            between = l * np.eye(2) + root @ (np.eye(2) + R) @ root / 2
            assert 0 <= sign * (float(end) - u @ between @ w / np.pi) < 1e-9


def test_least_slope():
    for largest in Fraction("2.001"), Fraction("2.736074882225"), Fraction(10), Fraction(10) ** 20:
        l = least_slope(largest)
        assert 0 <= l + 1 / l - largest < Fraction(1, 10 ** 6) and l < 1
    with pytest.raises(ValueError):
        least_slope(Fraction("1.9"))


@pytest.mark.parametrize("y", ["0.5", "-0.5", "0", "0.2", "0.9", "-1.3"])
@pytest.mark.parametrize("low, high", [("0.3", "0.4"), ("-0.2", "0.1"), ("-1", "-1")])
def test_the_most_that_a_wave_adds(y, low, high):
    """Also about a crest, where the sine has no slope."""
    for reach in "0", "0.01", "0.3", "2":
        t = np.linspace(-float(reach), float(reach), 101)
        sines = np.sin(np.pi * float(y) + t)
        most = links._most(*map(Fraction, (low, high, y, reach)))
        assert most >= max((-p * sines).max() for p in (float(low), float(high))) - 1e-15


def test_quotients_by_pi_are_rounded_outwards():
    """The bounds of pi are next to it, and 1 is a multiple of 1/COARSE."""
    below, above = links.PI
    step = Fraction(1, links.COARSE)
    assert links._over_pi(below, above) == (1 - step, 1 + step)
    assert links._over_pi(-above, -below) == (-1 - step, -1 + step)


def test_a_link_holds_for_all_parameters():
    """The box of a patch holds those of its points."""
    patch = Problem(MuldoonMap(("0.15", "0.17"), ("0.15", "0.17"), ("0.3", "0.35")))
    boxes = [Link.between(problem, Fraction(3), ("0.85", "0.86"), ("0.88", "0.84")).box
             for problem in (patch, Problem(MuldoonMap("0.15", "0.17", "0.35")),
                             Problem(MuldoonMap("0.16", "0.15", "0.3")))]
    for box in boxes[1:]:
        assert all(a[0] <= b[0] and b[1] <= a[1] for a, b in zip(boxes[0], box))


@pytest.mark.parametrize("problem", [
    Problem(SymplecticMap([(1, 0), (1, 1)], ["0.5", "0"], [["0", "0.5"]]), v0=(0, 1), v1=(0, 1)),
    Problem(MuldoonMap(("0.3", "0.6"), ("0.3", "0.6"), "0")),
    Problem(MuldoonMap(("0.1", "0.4"), ("0.1", "0.4"), "0.2")),
    Problem(SymplecticMap([
        (1, 0), (0, 1, Fraction(1, 8)), (1, -1, Fraction(1, 3))], ["0.3", "-0.1", "0.2"],
                          [["0.1", "0.2", 0], ["-0.1", "0.1", "0.3"]]), axes=DIAGONAL)])
@pytest.mark.slow
def test_the_checker_links_no_worse(problem):
    """What is linked with SPARE the checker links, whatever the cell, wide or narrow."""
    waves = [Wave(wave[:2], wave[2], p, tuple(parts)) for wave, p, *parts
             in zip(problem.waves, problem.amplitude, *problem.parts)]
    criterion = Criterion(Claim(tuple(waves), problem.centre[-2:], problem.half[-2:], problem.frame,
                                None, (Fraction(1), Fraction(1)), {"most_cuts": 12}, "no",
                                "234PPPP", ""))
    for points in ((("0.85", "0.86"), ("0.88", "0.84")), (("1.32", "1.32"), ("1.82", "1.82"))):
        link = Link.between(problem, Fraction(criterion.B, criterion.fixed.one), *points)
        here, there = (tuple(map(Fraction, point)) for point in points)
        for index, cuts in ((0, 0, 0), (0, 0, 0)), ((1, 0, 0), (1, 0, 0)), (
                (7, 7, 0), (4, 4, 0)), ((2, 12, 1), (4, 4, 2)):
            cell = (0, 0, *index), (0, 0, *cuts)
            for (a, b), (low, high) in zip(link.box, displacement(
                    criterion, cell, here, there)):
                assert a - SPARE < low < high < b + SPARE


# ---- letters

@pytest.mark.slow
def test_letters_stand_as_high_up_as_may_be():
    problem = Problem(MuldoonMap("0.1", "0.1", "0.2"), v0=(0, 1), v1=(0, 1))
    still = Link(((Fraction(0), Fraction(0)),) * 2)
    text = "00PU1UP"
    assert [hull_of(problem, cells) for cells in clusters(problem, text)] == [
        ((Fraction(1, 4), 1), (0, 1))]
    whole = Target("b", still, ((Fraction(-1), Fraction(2)),) * 2)
    assert linked_tree(problem, text, [whole]) == "b"
    left = Target("c", still, ((Fraction(-1), Fraction("0.51")), (Fraction(-1), Fraction(2))))
    assert linked_tree(problem, "0UP", [left]) == "0cP"
    assert linked_tree(problem, text, [left]) == "0c1UP"
    tight = Target("d", still, ((Fraction(1, 4), Fraction(1)), (Fraction(0), Fraction(1))))
    assert linked_tree(problem, text, [tight]) == text      # nothing to spare
    far = Target("e", Link(((Fraction(3), Fraction(3)),) * 2), whole.region)
    assert linked_tree(problem, text, [far]) == text


def test_cells_are_linked_into_the_region_around_them():
    link = Link(((Fraction("-0.01"), Fraction("0.02")), (Fraction("-0.03"), Fraction("-0.02"))))
    box = (Fraction("0.1"), Fraction("0.2")), (Fraction("0.7"), Fraction("0.71"))
    assert link.leads_into(box, region_around(box, link))
    assert not link.leads_into(box, box)


def test_counting():
    assert tree.count_linked("0a1PzU?") == 2
    assert tree.most_cuts("00P1Pa1Pb") == 3 and tree.most_cuts("0P0UU") == 1
    assert tree.complete("0aP") and not tree.complete("0a")


# ---- whole proofs

@pytest.mark.slow
def test_a_linked_proof(linked, tmp_path):
    """It is found, written, read and verified by the checker; the report names the points."""
    assert linked.no_tori and len(linked.parts) == 2
    # a single value moves nothing
    assert not any(part.problem.shifts for part in linked.parts)
    assert {"a", "b"} <= set(linked.tree) and linked.counts.linked == tree.count_linked(linked.tree)
    trees = [linked.tree, *(part.text for part in linked.parts)]
    assert linked.counts.proved == sum(text.count("P") for text in trees)
    assert linked.counts.most_cuts == max(map(tree.most_cuts, trees))
    linked.save(tmp_path / "proof")
    assert Proof.load(tmp_path / "proof") == linked
    assert linked.verify()
    for part in linked.parts:
        assert "x* = (%s, %s), " % part.xstar in linked.report()


@pytest.mark.parametrize("change", [
    lambda text: replaced_tree(text, "b", "a"),             # or to one before it
    lambda text: replaced_tree(text, "", "0ac"),            # there is no part c
    lambda text: re.sub("part: a\nxstar: .*\n", "part: a\n", text),
    lambda text: text[:text.index("part: b")] + text[text.index("checksum"):],
])
def test_wrong_parts(linked, tmp_path, change):
    with pytest.raises(ConverseError, match="use an intact copy or start anew"):
        Proof.load(changed(linked, tmp_path / "proof", change))


def changed(proof, path, change):
    """The path of the proof's file, its text changed and its checksum renewed."""
    proof.save(path)
    path.write_text(sealed(change(path.read_text())))
    return path


def replaced_tree(text, letter, tree):
    """The text of a file with another tree of a part, or with "" of the proof itself."""
    begin = text.index("tree:\n", text.index("part: " + letter) if letter else 0) + 6
    end = re.compile("part: |checksum: ").search(text, begin).start()
    return text[:begin] + tree + "\n" + text[end:]


@pytest.mark.parametrize("change, wrong", [
    (lambda text: replaced_tree(text, "", "0ab"), "part a may lead out of its region"),
    (lambda text: re.sub("(part: b\nxstar): .*", r"\1: 0.906 0.6", text), "part b may lead out"),
    (lambda text: re.sub("(part: a(\n.*)*?\nv0: [0-9.]*) .*", r"\1 0.05", text), "part a may"),
    (lambda text: text.replace("frame: 1 1 1 -1", "frame: 1 0 0 1"), "may lead out"),
    (lambda text: replaced_tree(text, "b", "S"), "does not belong"),
    (lambda text: replaced_tree(text, "b", "4PP"), "does not belong")])
def test_wrong_links_are_not_resumed(linked, tmp_path, change, wrong):
    """What can be seen at once is not believed of a file; and its trees are left as they were."""
    def trees():
        return re.search("^tree:.*(?=^checksum)", path.read_text(), re.M | re.S)[0]

    path = changed(linked, tmp_path / "proof", change)
    before = trees()
    with pytest.raises(ConverseError, match=wrong):
        prove(resume=path)
    assert trees() == before


@pytest.mark.slow
@pytest.mark.parametrize("ending, parts", [(".*?P", 0), (".*?b.*?P", 1)])
def test_parts_that_nothing_is_linked_to(linked, tmp_path, ending, parts):
    """An undecided prism ended the search before others were linked: a deeper one has no parts
    that the checker would refuse, and their prisms are not counted."""
    text = re.match(ending, linked.tree)[0]
    assert text.count("a") == 0
    before = linked.with_tree(0, text=text[:-1] + "U")
    again = prove(resume=replace(before, counts=counted(before)), depth=linked.depth + 1)
    assert again.no_tori and len(again.parts) == parts
    assert again.verify()


@pytest.mark.slow
def test_one_region_may_do_for_two_clusters(easily, monkeypatch):
    """A part that no cell is linked to, as those before it take them all, is not written."""
    monkeypatch.setattr(starts, "region_around", lambda *_: ((Fraction(-1), Fraction(2)),) * 2)
    monkeypatch.setattr(starts, "_best_start", lambda *_: (Fraction("0.86"), Fraction("0.85")))
    proof = prove(line("0.015"), method="loewner", time_limit=20)
    assert len(proof.parts) == 1 and set(tree.LETTERS) & set(proof.tree) == {"a"}


@pytest.mark.slow
def test_prisms_that_are_skipped_are_not_linked(easily):
    """The checker wants the mirror images of such proved."""
    square = replace(line("0.015"), v0=(Fraction("0.4"), Fraction("1.6")),
                     v1=(Fraction("0.4"), Fraction("1.6")))
    proof = prove(square, method="loewner", xstar=("0.858", "0.858"))
    assert proof.counts.symmetric and not proof.parts and proof.conclusion == "region"
    assert proof.verify(2).status == 3


def test_a_smaller_region_is_not_verified(linked):
    """The checker does not believe a letter whose region lost an edge."""
    part = linked.parts[0]
    low, high = part.problem.v0
    narrower = replace(part.problem, v0=(low + (high - low) / 8, high))
    with pytest.raises(check.NotConfirmed):
        linked.with_tree(1, problem=narrower).verify()


@pytest.mark.parametrize("jobs, moments, found", [
    (1, (1, 4, 7), {(0, 0), (2, 0), (2, 2)}),
    (3, (2, 6), {(0, 1), (2, 1)})])
@pytest.mark.slow
def test_resumed_at_any_moment(linked, easily, tmp_path, monkeypatch, jobs, moments, found):
    """Whenever it is interrupted, the proof is the same: before the tree, before the parts are
    found, and when none, one or two of these are proved."""
    path = tmp_path / "backup"

    def interrupts(self):
        calls.append(1)
        if len(calls) == moment:
            raise KeyboardInterrupt
        return look(self)

    states, look = set(), run._Run._look
    monkeypatch.setattr(native, "LOOK_SECONDS", PATIENCE)   # Each tree is looked at twice.
    monkeypatch.setattr(run._Run, "_look", interrupts)
    for moment in moments:
        calls = []
        path.unlink(missing_ok=True)
        try:
            proof = prove(line("0.015"), method="loewner", backup=path, jobs=jobs)
        except KeyboardInterrupt:
            before = Proof.load(path)
            trees = [part.text for part in before.parts] or [before.tree]
            states.add((len(before.parts), sum(map(bool, trees))))
            moment = 0
            proof = prove(resume=path, jobs=jobs)
        assert proof == linked
        assert Proof.load(path) == linked
    assert states == found


@pytest.mark.parametrize("a, low, high", [("0.2", "0.5", "1.3"), ("0.19", "-0.1", "0.7")])
def test_mirror_images_are_not_linked(easily, monkeypatch, a, low, high):
    """Where prisms are skipped, their mirror images must be proved, not linked."""
    monkeypatch.setattr(run, "LONG", 8)
    a = Fraction(a)
    proof = prove(Problem(MuldoonMap(a, a, 2 * a), v0=(low, high), v1=(low, high)),
                  method="loewner")
    assert proof.conclusion == "region" and "S" in proof.tree and not proof.parts
    assert proof.verify().verdict


def test_orbits_over_another_point_are_as_long_as_over_the_first(easily, monkeypatch):
    """Where a tree is tried to the end, but not where starting points are compared."""
    lengths, grow = set(), native.grow

    def noted(task, *rest):
        lengths.add((task.settings.stubborn, task.longest))
        return grow(task, *rest)

    monkeypatch.setattr(native, "grow", noted)
    monkeypatch.setattr(starts, "MAX_PROOF_LEAVES", 100)
    proof = prove(Problem(MuldoonMap(("0.98", "0.981"), 0, 0)), method="loewner")
    assert proof.no_tori and proof.parts and lengths == {(True, native.ORDINARY), (False, 0)}


@pytest.mark.slow
def test_undecided_stays_undecided(easily):
    """Where there are tori, links prove nothing."""
    proof = prove(line("0.004"), method="loewner", depth=14)
    assert not proof.no_tori and proof.conclusion == "undecided"


@pytest.mark.slow
def test_a_part_that_grows_too_large_is_linked_further(linked, easily, monkeypatch):
    """It is looked at once, and the proof does not depend on the number of workers."""
    asked, plan = [], run.plan

    def noted(*arguments):
        found = plan(*arguments)
        asked.append((arguments[2], found is not None))
        return found

    monkeypatch.setattr(run, "plan", noted)
    most = max(part.text.count("P") for part in linked.parts)
    monkeypatch.setattr(run, "MAX_PROOF_LEAVES", most)
    assert prove(line("0.015"), method="loewner") == linked
    assert asked.pop() == (linked.xstar, True) and not asked
    monkeypatch.setattr(run, "MAX_PROOF_LEAVES", 40)
    proof, same = (prove(line("0.015"), method="loewner", jobs=jobs) for jobs in (1, 3))
    assert len(proof.parts) == 10
    assert proof == same and asked[7:] == asked[:7]
    assert [found for _, found in asked[:7]] == [True] * 4 + [False] * 3
    monkeypatch.setattr(run, "LONG", native.ORDINARY)
    assert not prove(line("0.015", "0.01501"), method="loewner").parts
    assert len(asked) == 14
    monkeypatch.setattr(run, "plan", lambda *_: asked.append(None))
    assert not prove(line("0.015"), method="loewner").parts and len(asked) > 14


@pytest.mark.parametrize("problem,x,grown", [
    (Problem(SymplecticMap([(1, 0)], ["0"])), "0.534071", [12, 16]),
    (Problem(MuldoonMap("0.5", 0, 0)), "1.570796", [12, 16]), (line("0.005"), "0.858028", [12, 16]),
    (line("0.0139"), "0.858028", [12, 16, 20, 24]),
    (Problem(SymplecticMap([
        (1, 0, Fraction(-1, 2)), (0, 1, Fraction(-1, 2)), (1, 1, Fraction(-1, 2))],
                           ["0.02", "0.02", "0.5"])),
     "1.579997", [12, 16, 20, 24])])
@pytest.mark.slow
def test_where_there_are_tori_no_starting_points_are_looked_for(problem, x, grown):
    """What is undecided does not shrink there, or takes too many points of orbits: the tree is not
    grown to the depth of clusters."""
    depths, points = [], []
    def noted(tasks, *most):
        depths.extend(task.settings.depth for task in tasks)
        found = starts._surveys(1, bool, tasks, *most)
        points.extend(sum(tree.steps) for tree in found)
        return found

    left = starts._look(problem, 24, (x, x), noted)[1]
    assert depths == grown and bool(left) == (24 in grown)
    # A survey ends with the orbit that reaches the bound; none has more than 10,000 points.
    assert max(points) < starts.MAX_SHRINK_POINTS + 10_000


def test_progress_goes_on_while_starting_points_are_looked_for(easily, monkeypatch):
    """For half a minute, where that is hard: the clock of the terminal must not stand."""
    told, meanwhile = [], []

    def looked(*arguments):
        before = len(told)
        arguments[-1]()                 # is there time left?
        meanwhile.append(told[before:])

    monkeypatch.setattr(run, "plan", looked)
    proof = prove(line("0.015"), method="loewner", progress=lambda *how: told.append(how))
    assert meanwhile and all(len(calls) == 1 for calls in meanwhile)
    assert [share for share, _ in told] == sorted(share for share, _ in told)
    assert told[-1][1].proved == proof.counts.proved


def test_a_lost_scheduler_is_noticed_while_starting_points_are_looked_for(
        easily, monkeypatch, tmp_path):
    """What was found until then is saved."""
    class Executor(ThreadPoolExecutor):
        status = "running"

        def nthreads(self, callback_timeout):
            return {"worker": 1}

    def looked(*arguments):
        executor.status = "closed"
        arguments[-1]()                 # is there time left?
        raise AssertionError("nobody noticed")

    monkeypatch.setattr(run, "plan", looked)
    path = tmp_path / "proof"
    with Executor(1) as executor:
        executor._client = executor
        with pytest.raises(WorkersGone, match="scheduler is gone"):
            prove(line("0.015"), method="loewner", executor=executor, backup=path)
    assert Proof.load(path).counts.proved


def test_an_undecided_part_is_no_proof(linked):
    part = linked.parts[1]
    for text in part.text.replace("P", "U", 1), part.text[:-1]:
        proof = linked.with_tree(2, text=text)
        assert not proof and proof.report().startswith("UNDECIDED: ")
        assert ("\nEnded      before the whole region" in proof.report()) == ("U" not in text)
    assert len(linked.with_tree(2, text=part.text.replace("P", "U", 1)).undecided) == 1


def test_hints_of_several_trees(linked, tmp_path):
    first, second = linked.parts
    proof = replace(linked, trees=(
        replace(linked.trees[0], text="0?", pending=(3, 4)), replace(first, text="0P1"),
        replace(second, text="0", pending=(0, 9))), counts=Counts(cuts=4, proved=1))
    proof.save(tmp_path / "proof")
    assert Proof.load(tmp_path / "proof") == proof


def test_regions_of_parts(linked):
    part = linked.parts[0]
    problem = part.problem
    assert isinstance(part, Tree) and problem.frame == linked.problem.frame == DIAGONAL
    assert problem == linked.problem.part((problem.v0, problem.v1))


def test_a_part_over_the_diagonal_is_half_of_its_region():
    """The half and its mirror image hold the region; links may lead into both."""
    problem = replace(line("0.015"), axes=DIAGONAL)
    for v1, half in (("-0.1", "0.2"), "0.2"), (("-0.3", "0.2"), "0.3"), ((0, "0.2"), "0.2"):
        part = region.halved(replace(problem, v1=v1), ("0.85", "0.85"))
        assert part.v1 == (0, Fraction(half)) and part.v0 == problem.v0
        assert region.with_image(part, ("0.85", "0.85")) == (
            problem.v0, (-Fraction(half), Fraction(half)))
    moving = replace(line("0.015", "0.016"), axes=DIAGONAL, v1=("-0.1", "0.2"))
    for good, changes, xstar in (
            (False, {}, ("0.85", "0.851")), (False, {"v1": ("0.01", "0.2")}, ("0.85", "0.85")),
            (False, {"axes": (1, -1, 1, 1)}, ("0.85", "0.85")),
            (True, {"shifts": [("0.1", "0")]}, ("0.85", "0.85")),
            (False, {"shifts": [("0.1", "0.01")]}, ("0.85", "0.85"))):
        part = replace(moving, **changes)
        assert region.folds(part, xstar) == good
        assert (region.halved(part, xstar) == part) == (not good)
        assert (region.with_image(part, xstar) == (part.v0, part.v1)) == (not good)


def test_shifts_that_the_exchange_changes():
    """Each parameter with its own wave: they must move the region alike."""
    problem = Problem(MuldoonMap(("0.30", "0.31"), ("0.30", "0.31"), "0.6"), axes=DIAGONAL)
    for second, good in ("0.1", True), ("0.2", False), ("-0.1", False):
        part = replace(problem, shifts=[("0.1", 0), (second, 0), (0, 0)][:len(problem.parts)])
        assert region.folds(part, ("0.85", "0.85")) == good


@pytest.mark.slow
def test_the_linked_input(root):
    """The Froeschle map of the inputs; the checker confirms all of it."""
    proof = prove(read_input(root / "inputs" / "froeschle-linked.json"), method="loewner")
    assert proof.no_tori and proof.parts and proof.verify()


def test_one_angle_is_linked():
    """What waves of one combination of the angles do not feel is no way to another point."""
    for waves in ([(1, 0), (2, 0)], [(1, 1), (2, 2)]):
        ways = starts.ways(Problem(SymplecticMap(waves, ["0.5", "0.2"])))
        assert ways == [waves[0], tuple(-k for k in waves[0])]


@pytest.mark.slow
@pytest.mark.skipif(TORTURE <= 1, reason="takes a minute")
@pytest.mark.parametrize("epsilon, parts", [("0.01395", 1), ("0.0139", 2)])
def test_near_where_links_end(epsilon, parts):
    """The classes of rotation vectors that one x* leaves, each from its own.  A single value has
    nothing to move with."""
    proof = prove(line(epsilon), method="loewner")
    assert proof.no_tori and len(proof.parts) == parts and proof.counts.proved < 100000
    assert not any(part.problem.shifts for part in proof.parts)


@pytest.mark.parametrize("half_width", ["0", "0.0001"])
def test_long_orbits_of_a_single_map_of_one_angle_are_no_reason_to_look_for_other_points(
        monkeypatch, half_width):
    """All orbits are long near the last circle.  For a range another point may do better."""
    asked = []
    monkeypatch.setattr(run, "LONG", 15)
    monkeypatch.setattr(run, "plan", lambda *_: asked.append(None))
    k, h = Fraction("1.02"), Fraction(half_width)
    for source in StandardMap(k=(k - h, k + h)), Problem(MuldoonMap((k - h, k + h), 0, 0)):
        proof = prove(source)
        assert proof.no_tori and proof.counts.max_NTsteps >= 15
    assert len(asked) == (2 if h else 0)


# ---- the prisms of the core

def test_the_core_has_the_prisms_that_links_mean():
    """However pi is rounded: cells beside them may be linked, and end where these begin.

    At x* = 0 the action is least, and so the orbit that stays there minimizes: no cell is proved
    whose lower corner is v = (2, 2), in units of pi."""
    waves = [(1, 0, "1.5"), (0, 1, "1.5"), (1, 1, "1.5")]
    problem = Problem(SymplecticMap(waves, ["0.3", "0.3", "0.6"]), v0=(1, 3), v1=(1, 3),
                      axes=(1, 0, 0, 1))
    task = native.Task(problem, Settings("loewner", 100, stubborn=True), ("0", "0"))
    for k in range(1, 41):
        cell = (2 ** k // 2, 2 ** k // 2, 0, 0, 0), (k, k, 0, 0, 0), 0
        assert native.Search(task).grow([cell], 1).text != "P"


def test_halves_of_regions_do_not_hide_a_better_point():
    class Image:
        """Only regions over points off the diagonal are proved; over the diagonal they are halved,
        and their halves have fewer prisms that resist."""

        xstar = "0.8", "0.8"
        problem = replace(line("0.015"), axes=(1, 0, 0, 1))

        def is_half(self, point):
            return point[0] == point[1]

        def grow(self, points, settings, most):
            resist = [4 if self.is_half(point) else 5 for point in points]
            return [SimpleNamespace(cells=[], counts=Counts(undecided=n)) for n in resist]

        def proof(self, point):
            half = self.is_half(point)
            return SimpleNamespace(text="U" if half else "P", counts=Counts(undecided=int(half)))

    image = Image()
    assert not image.is_half(starts._best_start(image, []))
