"""Regions of parts that move with the parameters: links into them, proofs, files and reports."""

import re
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import product

import pytest
from files import line

from converse import ConverseError, FourierMap, Problem, Proof, Settings, prove
from converse.model.map import THESIS, MuldoonMap, SymplecticMap
from converse.model.region import skips, symmetries_used
from converse.prover import native, tree
from converse.prover.links import (PI, SPARE, Link, Target, hull_of, linked_tree, region_around,
                                   wrong_letter)
from converse.prover.proof import Tree
from converse.prover.run import ready
from converse.storage import files

import kernels
from truth import TORTURE, rng_for

HERE, THERE = ("0.858", "0.858"), ("0.842", "0.85")
B = Fraction("2.8")
SHIFTS = (Fraction("0.01"), Fraction("-0.02")),


line = partial(line, axes=(1, 1, 1, -1))
PATCH = Problem(SymplecticMap(THESIS, ["0.15", "0.16", "0.3"], [["0.001", 0, 0], [0, "0.002", 0]]),
                axes=(1, 1, 1, -1), v0=("0.5", "0.7"), v1=("-0.1", "0.3"))
TWO = (Fraction("0.01"), Fraction("-0.02")), (Fraction(0), Fraction("0.005"))


# ---- the problem

def test_shifts_are_exact():
    """However they are given; and as many as there are parameters."""
    region = (0, 1), (0, 1)
    whole = line("0.014", "0.015")
    problem = whole.part(region, [("0.01", "-2e-2")])
    assert problem.shifts == SHIFTS and "0.01 -0.02" in repr(problem)
    again = replace(problem)
    assert again == problem == whole.part(region, SHIFTS) and hash(again) == hash(problem)
    still = whole.part(region)
    assert still.shifts == () != problem.shifts and still != problem
    assert replace(problem, shifts=[(0, 0)]) == still and "shifts" not in repr(still)
    for wrong in ([(0, 0)] * 2, [(1,)], [(1, 2, 3)], [("1/3", 0)], [("inf", 0)], SHIFTS * 3):
        with pytest.raises(ValueError):
            replace(problem, shifts=wrong)
    for wrong in ([(0.1, 0)], [(float("nan"), 0)], [1], 3, [None]):
        with pytest.raises(TypeError):
            whole.part(region, wrong)


def test_no_whole_proof_has_shifts(tmp_path):
    """Its file's header could not say so."""
    problem = replace(line("0.014", "0.015"), shifts=SHIFTS)
    for method in "loewner", "thesis":
        with pytest.raises(ValueError, match="give no shifts"):
            prove(problem, method=method)
    with pytest.raises(ValueError, match="does not move"):
        Proof((Tree(problem),)).save(tmp_path / "proof")
    wide = replace(line("0.02", "0.021"), v0=(0, 2), v1=(0, 2))
    assert symmetries_used(wide, HERE) == []
    assert symmetries_used(replace(wide, shifts=SHIFTS), HERE) is None


def test_mirror_images():
    square = replace(line("0.015", "0.016"), axes=(1, 0, 0, 1))
    assert skips(square, HERE) and not skips(replace(square, shifts=SHIFTS), HERE)


# ---- prisms and links

def random_cell(rng, parameters):
    cuts = [rng.randrange(5) if axis < 2 + parameters else 0 for axis in range(6)]
    return tuple(rng.randrange(1 << k) for k in cuts), tuple(cuts)


def corners(problem, cell):
    """(t, v) at the corners of a cell, in exact numbers, as the definition has them."""
    index, cuts = cell
    for ends in product((0, 1), repeat=2 + len(problem.parts)):
        u = [Fraction(2 * (i + e), 1 << k) - 1 for i, k, e in zip(index, cuts, ends)]
        yield u[2:], [c + h * x + sum(pair[i] * t for pair, t in zip(problem.shifts, u[2:]))
                      for i, (c, h, x) in enumerate(zip(problem.centre[-2:], problem.half[-2:], u))]


@pytest.mark.parametrize("still", [(), TWO, (TWO[1], TWO[0])])
def test_prisms_are_the_least_rectangles(still):
    """Seen from what stands still, and from what moves."""
    rng = rng_for("shifted prisms %s" % (still,))
    problem = PATCH.part((PATCH.v0, PATCH.v1), TWO)
    for _ in range(50):
        cell = random_cell(rng, 2)
        seen = [[x - sum(pair[i] * t for pair, t in zip(still, ts)) for i, x in enumerate(v)]
                for ts, v in corners(problem, cell)]
        centre, half = tree.prisms(problem, still)(cell)
        assert [(c - h, c + h) for c, h in zip(centre, half)] == [
            (min(xs), max(xs)) for xs in zip(*seen)]
        assert hull_of(problem, [cell], still) == tuple((min(xs), max(xs)) for xs in zip(*seen))


def lands(problem, cell, link, target):
    """Does each v' of each corner lie in the target's region there, with SPARE left?"""
    return all(a - SPARE >= low and b + SPARE <= high
               for ts, v in corners(problem, cell)
               for i, ((low, high), (d0, d1)) in enumerate(zip(target.region, link.box))
               for moved in [v[i] - sum(pair[i] * t for pair, t in zip(target.shifts, ts))]
               for a, b in [(moved + d0, moved + d1)])


@pytest.mark.parametrize("mine", [(), TWO])
@pytest.mark.parametrize("theirs", [(), TWO, (TWO[1], TWO[0])])
def test_links_lead_into_regions_that_move(mine, theirs):
    """To the edge: an end that is nearer by any amount is not enough."""
    problem = PATCH.part((PATCH.v0, PATCH.v1), mine)
    rng = rng_for("shifted links %s %s" % (mine, theirs))
    link = Link.between(problem, B, HERE, THERE)
    for _ in range(10 * TORTURE):
        cell = random_cell(rng, 2)
        seen = [[x - sum(pair[i] * t for pair, t in zip(theirs, ts)) for i, x in enumerate(v)]
                for ts, v in corners(problem, cell)]
        exact = [[min(xs) + d0 - SPARE, max(xs) + d1 + SPARE]
                 for xs, (d0, d1) in zip(zip(*seen), link.box)]
        for axis, end in (None, 0), *product(range(2), range(2)):
            region = [list(ends) for ends in exact]
            if axis is not None:
                region[axis][end] += (1, -1)[end] * Fraction(1, 10 ** 30)
            target = Target("a", link, tuple(map(tuple, region)), theirs)
            assert lands(problem, cell, link, target) == (axis is None)
            part = Tree(problem.part(target.region, theirs), THERE)
            whole = tree_of(cell)
            wrong = wrong_letter(problem, B, HERE, whole, [part])
            assert wrong == (None if axis is None else "a")
            grown = linked_tree(problem, whole.replace("a", "U"), [target])
            assert ("a" in grown) == (axis is None)


def tree_of(cell):
    """A tree in which a cell is linked to part a, and all others are proved."""
    index, cuts = cell
    nodes = [(str(axis), index[axis] >> k - 1 - level & 1)
             for axis, k in enumerate(cuts) for level in range(k)]
    text = "a"
    for axis, upper in reversed(nodes):
        text = axis + ("P" + text if upper else text + "P")
    assert [found for kind, found in tree.cells(text) if kind == "a"] == [cell]
    return text


@pytest.mark.slow
def test_a_region_for_cells_takes_them_all():
    rng = rng_for("shifted regions")
    for mine, theirs, there in product(((), TWO), ((), TWO), (HERE, THERE)):
        problem = PATCH.part((PATCH.v0, PATCH.v1), mine)
        link = Link.between(problem, B, HERE, there)
        cells = [random_cell(rng, 2) for _ in range(5)]
        region = region_around(hull_of(problem, cells, theirs), link)
        target = Target("a", link, region, theirs)
        for cell in cells:
            assert lands(problem, cell, link, target)
            assert wrong_letter(problem, B, HERE, tree_of(cell), [
                Tree(problem.part(target.region, theirs), there)]) is None
        sizes = [high - low for low, high in target.region]
        hull = hull_of(problem, cells, theirs)
        assert all(size < (high - low) * Fraction(9, 8) + 2 * (d1 - d0) + Fraction(1, 1000)
                   for size, (low, high), (d0, d1) in zip(
                       sizes, hull, link.box))


def test_a_point_is_linked_to_itself():
    zero = ((Fraction(0), Fraction(0)),) * 2
    assert Link.between(PATCH, B, HERE, HERE).box == zero
    assert Link.between(PATCH, B, HERE, ("0.8580", "858e-3")).box == zero
    assert Link.between(PATCH, B, HERE, THERE).box != zero


# ---- whole proofs

@pytest.fixture(scope="module")
def begun():
    """A proof over three x*, nothing of whose parts is grown: of the part a, over the same x*, and
    of b, the regions move."""
    problem = line("0.0150", "0.0151")
    before = ready(Proof((Tree(problem, HERE),), Settings("loewner")))
    problem = replace(before.problem, v0=(Fraction("0.2"), Fraction("1.3")),
                      v1=(Fraction("-0.1"), Fraction("1.1")))
    task = native.Task(problem, Settings("loewner", 8, stubborn=True), HERE)
    search = native.Search(task)
    search.work(0, bool)
    grown = search.grow(leaves=10 ** 5)
    cells = [cell for kind, cell in tree.cells(grown.text) if kind == "U"]
    assert len(cells) > 3
    largest = Fraction(search.constants["B"])
    first, parts = Link.between(problem, largest, HERE, HERE), []
    shifts = (Fraction("-0.05"), Fraction("0.03")),
    parts.append(Tree(problem.part(region_around(
        hull_of(problem, cells, shifts), first), shifts), HERE))
    text = linked_tree(problem, grown.text, [
        Target("a", first, (parts[0].problem.v0, parts[0].problem.v1), shifts)])
    assert "a" in text and "U" not in text
    other, there = (Fraction("-0.04"), Fraction(0)), ("0.85", "0.85")
    middle = problem.part((parts[0].problem.v0, parts[0].problem.v1), shifts)
    second = Link.between(middle, largest, HERE, there)
    region = region_around(hull_of(middle, [tree.ROOT], (other,)), second)
    parts = [replace(parts[0], text="b"), Tree(middle.part(region, (other,)), there)]
    return Proof((Tree(problem, HERE, text), *parts), Settings("loewner"), replace(
        grown.counts, undecided=0, linked=text.count("a") + 1), search.constants)


@pytest.fixture(scope="module")
def moved(begun):
    proof = prove(resume=begun)
    assert proof.no_tori
    return proof


def changed(proof, path, change):
    proof.save(path)
    text = change(path.read_text())
    body = text[:text.index("checksum: ")]
    path.write_text(body + "checksum: sha256 %s\nend\n" % files.sha256(body))
    return path


def test_a_proof_with_regions_that_move(moved, begun):
    first, second = moved.parts
    assert first.text == "b" and set(second.text) <= set("012P") and len(second.text) > 1
    assert second.problem == moved.problem.part((second.problem.v0, second.problem.v1),
                                                second.problem.shifts)
    for number, part in enumerate(begun.parts, 1):
        with pytest.raises(ConverseError, match="may lead out of its region"):
            prove(resume=begun.with_tree(number, problem=replace(part.problem, shifts=())))


def test_the_report_tells_how_regions_move(moved):
    def said(proof):
        return " ".join(proof.report().split())

    assert re.search(
        r"Part b x\* = \(0\.85, 0\.85\), 0\.[0-9]+ pi <= v0 <= [01]\.[0-9]+ pi, -?0\.[0-9]+ pi <= "
        r"v1 <= [01]\.[0-9]+ pi in the middle of the parameters, moved by "
        r"\(-0\.04 pi, 0\) at the upper end, with its mirror image: [0-9,]+ prisms proved, "
        "0 linked", said(moved))
    here, _, part = moved.trees
    region = part.problem.v0, part.problem.v1
    several = replace(moved, trees=(replace(here, problem=PATCH),
                                    replace(part, problem=PATCH.part(region, TWO))))
    assert "moved by (0.01 pi, -0.02 pi) at the upper end of t[1], (0, 0.005 pi) at the " \
        "upper end of t[2]: " in said(several)
    point = Problem(MuldoonMap("0.3", "0.3", "0.6"))
    ranges = replace(moved, trees=(replace(here, problem=point), replace(
        part, problem=point.part(region, (*TWO, TWO[0])))))
    assert "of b, (0.01 pi, -0.02 pi) at the upper end of c: " in said(ranges)
    without = replace(moved, trees=tuple(replace(each, problem=replace(each.problem, shifts=()))
                                         for each in moved.trees))
    assert "moved" not in said(without) and re.search(
        r"Part b x\* = \(0\.85, 0\.85\), \S+ pi <= v0 <= \S+ pi, \S+ pi <= v1 <= \S+ pi, "
        "with its mirror image: [0-9,]+ ", said(without))


def test_the_lines_of_a_part(moved, tmp_path):
    path = tmp_path / "proof"
    moved.save(path)
    text = path.read_text()
    assert re.search(r"part: b\nxstar: 0.85 0.85\nv0: \S+ \S+ -0.04\nv1: \S+ \S+ 0\ntree:", text)
    again = Proof.load(path)
    assert again == moved and again.parts[1].problem.shifts
    half = moved.with_tree(1, problem=replace(moved.parts[0].problem, shifts=()))
    half.save(path)
    assert re.search(r"part: a\nxstar: 0.858 0.858\nv0: \S+ \S+\nv1: \S+ \S+\n", path.read_text())
    assert Proof.load(path) == half
    still = half.with_tree(2, problem=replace(half.parts[1].problem, shifts=((0, 0),)))
    still.save(path)
    assert Proof.load(path) == still


@pytest.mark.parametrize("change, wrong", [
    (lambda text: re.sub("(part: b\n.*\nv0: .*)", r"\1 0", text), "b's v0 is not two or 3"),
    (lambda text: re.sub("P\n(?=checksum)", "S\n", text), r"part is skipped \(S\), though")])
def test_wrong_numbers_of_parts(moved, tmp_path, change, wrong):
    """The checker's reader refuses them, and tests/check has the others."""
    with pytest.raises(ConverseError, match=wrong) as caught:
        Proof.load(changed(moved, tmp_path / "proof", change))
    assert "\n" not in str(caught.value)


def test_a_part_may_have_two_numbers(moved, tmp_path):
    path = changed(moved, tmp_path / "proof", lambda text: re.sub(
        "(part: b\n.*\n.*\nv1: .*) 0\n", r"\1\n", text))
    assert Proof.load(path) == moved


def test_wrong_shifts_are_not_resumed(moved, tmp_path):
    path = changed(moved, tmp_path / "proof", lambda text: re.sub(
        "(part: b\n.*\nv0: .*) -0.04", r"\1 0.04", text))
    with pytest.raises(ConverseError, match="part b may lead out of its region"):
        prove(resume=path)


@pytest.mark.slow
@pytest.mark.parametrize("moment", [
    pytest.param(1, marks=pytest.mark.slow), 2, pytest.param(3, marks=pytest.mark.slow)])
def test_interrupted(begun, moved, tmp_path, monkeypatch, moment):
    """A backup is read and continued to the same proof."""
    path, calls = tmp_path / "backup", []
    begun.save(path)
    assert Proof.load(path) == begun

    def interrupts(*_):
        calls.append(1)
        if len(calls) == moment:
            raise KeyboardInterrupt

    try:
        prove(resume=path, progress=interrupts, backup=path)
    except KeyboardInterrupt:
        assert Proof.load(path).parts
    assert prove(resume=path) == moved


def test_undecided_prisms_of_parts_that_move(moved):
    """They are told as wide as all their places."""
    part = moved.parts[1]
    proof = moved.with_tree(2, text="2PU")
    leaf, = proof.undecided
    for i, (low, high) in enumerate((part.problem.v0, part.problem.v1)):
        s, half = part.problem.shifts[0][i], (high - low) / 2
        assert leaf.half[i] == half + abs(s) / 2 and leaf.centre[i] == (low + high) / 2 + s / 2
    assert "the first of them: " in proof.report()


def test_shifts_in_radians():
    """What the core makes of a shift is off by the half-width that it adds, and not by much more;
    pi has 30 places at least."""
    halves = []
    for shifts in (), ((Fraction("0.0123456789"), Fraction("-0.5")),):
        problem = line("0.0150", "0.0151").part(((0, 1), (0, 1)), shifts)
        search = native.Search(native.Task(problem, Settings("loewner"), HERE))
        assert search.work(0, bool)
        halves.append([kernels.half_width(search.handle, axis) for axis in range(2)])
    places = 30
    for i, shift in enumerate(shifts[0]):
        scale = 10 ** places
        off = abs(shift) * PI[1] - Fraction(abs(shift) * (PI[0] * scale // 1) // 1, scale)
        assert off <= halves[1][i] - halves[0][i] <= Fraction(2, scale)


def test_mirror_images_of_parameters_that_change_places():
    """Where the exchange of the angles gives the parameters another order, the checker agrees."""
    K = Fraction("0.19"), Fraction("0.194")
    family = FourierMap({(1, 0): {"K0": 1}, (0, 1): {"K1": 1}, (1, 1): "0.4"}, K0=K, K1=K)
    proof = prove(Problem(family, axes=(1, 0, 0, 1)), xstar=("0.86", "0.86"), jobs=1)
    assert "S" in proof.tree and proof.verify().status == 0
