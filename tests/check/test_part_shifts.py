"""Proof files with parts whose regions move with the parameters.  What is right is
confirmed, and what is wrong in any one place is not, by both paths of the checker; and orbits are
where the checker says."""

import contextlib
import dataclasses
import itertools
import math
import re
from fractions import Fraction

import pytest
from test_parts import OTHER, XSTAR, file_of, replaced, run  # noqa: F401

from checker import check
from trees import found_tree

ONE = ["1 0 0 0.225 0.004", "0 1 0 0.225 0.004", "1 1 0 0.45 0.008"]
IDLE = ["1 0 0 0.225 0.002 0", "0 1 0 0.225 0.002 0", "1 1 0 0.45 0.004 0"]     # t2 moves no wave
V0, V1 = "0.5362 0.2505", "0.5 0.5"
TIGHT = Fraction(1, 10 ** 39)


def decimals(*numbers):
    return " ".join([check.decimal_text(Fraction(x)) for x in numbers])


def part_claim(waves, xstar, ranges):
    """Of a part with these lines of v0 and v1, as a claim of its own."""
    v0, v1 = [list(map(Fraction, words.split())) for words in ranges]
    claim = check.content(file_of("P", waves=waves, xstar=xstar).encode())
    return dataclasses.replace(claim, centre=(v0[0], v1[0]), half=(v0[1], v1[1]),
                               shifts=tuple(zip(v0[2:], v1[2:])), where="part a")


def sums(rows, t):
    """What the parameters t add to v0 and v1."""
    return [sum([row[n] * x for row, x in zip(rows, t)]) for n in (0, 1)]


def corners(claim, cell):
    """The corners of a cell: v0 and v1, and the parameters."""
    at = [[Fraction(2 * i + e, 1 << k) - 1 for e in (0, 2)] for i, k in zip(*cell)]
    for u0, u1, *t in itertools.product(*at[:2 + claim.parameters]):
        yield [c + h * u + s for c, h, u, s in zip(claim.centre, claim.half, (u0, u1),
                                                   sums(claim.shifts, t))], t


def region_for(claim, cell, there, shifts, margin):
    """The lines v0 and v1 of the least region, moving so, that a leaf may be linked to."""
    whole = dataclasses.replace(claim, shifts=(), where="", counts={"most_cuts": 20})
    moved = check.displacement(check.Criterion(whole), cell, claim.xstar,
                               tuple(map(Fraction, there.split())))
    lines, unit = [], 10 ** 40
    for n, (below, above) in enumerate(moved):
        ends = [v[n] - sums(shifts, t)[n] for v, t in corners(claim, cell)]
        low, high = min(ends) + below, max(ends) + above
        middle = Fraction(round((low + high) / 2 * unit), unit)
        half = Fraction(math.ceil((max(high - middle, middle - low) + margin) * unit), unit)
        lines.append(decimals(middle, half, *[shift[n] for shift in shifts]))
    return lines


def chain(waves, steps, margin=TIGHT, cut="2"):
    """The arguments of a file: the first tree is cut along a parameter, and of the upper half the
    deepest leaf is linked to a part, the tree of which likewise to the next.  steps: x* and shifts
    of each part."""
    trees, parts, here = [], [], (XSTAR, (V0, V1))
    for letter, (xstar, shifts) in zip(check.LETTERS, steps):
        claim = part_claim(waves, *here)
        tree = found_tree(claim, 5000)
        both = cut + tree + tree
        at, cell = max((leaf for leaf in check.leaves(both) if leaf[0] > len(tree)),
                       key=lambda leaf: sum(leaf[1][1]))
        trees.append(both[:at] + letter + both[at + 1:])
        here = xstar, region_for(claim, cell, xstar, [tuple(map(Fraction, x)) for x in shifts],
                                 margin)
        parts.append((xstar, *here[1]))
    trees.append(found_tree(part_claim(waves, *here), 5000))
    return {"tree": trees[0], "v0": V0, "v1": V1, "waves": waves,
            "parts": [(*part, tree) for part, tree in zip(parts, trees[1:])]}


def changed(link, n, line, at, value=None, by=None, times=None):
    """Another number of the line v0 or v1 of a part."""
    parts = [list(part) for part in link["parts"]]
    words = parts[n][1 + (line == "v1")].split()
    words[at] = value or decimals(Fraction(words[at]) * (1 if times is None else times) + Fraction(
        by or 0))
    parts[n][1 + (line == "v1")] = " ".join(words)
    return {**link, "parts": [tuple(part) for part in parts]}


def with_lines(link, n, v0=None, v1=None, tree=None):
    parts = list(link["parts"])
    xstar, *old = parts[n]
    parts[n] = (xstar, *[new or was for new, was in zip((v0, v1, tree), old)])
    return {**link, "parts": parts}


@pytest.fixture(scope="module")
def both():
    """Two parts that move, each in its own way, over the first x* and another; without room."""
    return chain(ONE, [(XSTAR, [("0.003", "-0.002")]), (OTHER, [("-0.001", "0.004")])])


@pytest.fixture(scope="module")
def later():
    """Two parts, of which the later moves."""
    return chain(ONE, [(OTHER, [(0, 0)]), (XSTAR, [("0.002", "0.001")])])


@pytest.fixture(scope="module")
def idle():
    """A part that moves with a parameter that moves no wave, too."""
    return chain(IDLE, [(XSTAR, [("0.002", "0"), ("-0.004", "0.003")])], cut="3")


@pytest.mark.slow
def test_regions_that_move_are_confirmed(both, later, idle, run):
    for link in (both, later, idle):
        status, out, _ = run(file_of(**link))
        assert status == 0 and out.startswith("Verified :") and "links between" in out
        assert "\nx* of part a : %s\n" % link["parts"][0][0] in out


# ---- wrong files

def with_s(link):
    """The first tree linked to a symmetric region, whose tree has a leaf S; the frame fits, too."""
    part = XSTAR, "1 1.01 0", "1 1.01 0", "01PS1PP"
    return {**link, "frame": "1 0 0 1", "v0": "1 1", "v1": "1 1", "tree": "a", "parts": [part]}


REJECTED = {            # a change of a file, made of the arguments; and what is said
    "one too many": (lambda f: file_of(**with_lines(f, 0, v0=f["parts"][0][1] + " 0")),
                     "part a's v0 is not two or 3 decimal numbers"),
    "no parameter": (lambda f: file_of(**{**f, "waves": [" ".join(wave.split()[:4])
                                                       for wave in ONE]}),
                     "part a's v0 is not two decimal numbers"),
    "one too few": (lambda f: file_of(**{**f, "waves": IDLE}),
                    "part a's v0 is not two or 4 decimal numbers"),
    "in the header's v0": (lambda f: file_of(**{**f, "v0": V0 + " 0.001"}),
                           "the header's v0 is not two decimal numbers"),
    "in x*": (lambda f: replaced(file_of(**f), "xstar: %s\nv0" % OTHER, "xstar: %s 0\nv0" % OTHER),
              "part b's xstar is not two decimal numbers"),
    "infinite": (lambda f: file_of(**changed(f, 1, "v1", 2, "inf")), "part b's v1 is not two or 3"),
    "negative half-width": (lambda f: file_of(**changed(f, 0, "v1", 1, "-1")),
                            "part a's v1: the half-width is negative"),
    "a leaf S": (lambda f: file_of(**changed(with_s(f), 0, "v0", 2, "0.001")),
                 "part a: symmetric leaf 1 of 1"),
    "a leaf S, both alike": (lambda f: file_of(**changed(changed(
        with_s(f), 0, "v0", 2, "0.001"), 0, "v1", 2, "0.001")), "but the problem is not symmetric"),
}


@pytest.mark.parametrize("name", REJECTED)
def test_wrong_files_are_rejected(both, run, name):
    change, why = REJECTED[name]
    status, out, err = run(change(both))
    assert (status, out) == (1, "") and why in err and err.count("\n") == 1, err


@pytest.mark.slow
def test_a_leaf_s_without_shifts(both, run):
    """So what is wrong above is that the region moves; 0 moves nothing, in either line."""
    for link in (with_s(both), with_lines(with_s(both), 0, v0="1 1.01", v1="1 1.01 0")):
        assert run(file_of(**link))[0] != 1


def sign(x):
    return -1 if Fraction(x) < 0 else 1


def cut_end(link, n, line, end, by):
    """The part's region is shorter at its lower (-1) or upper end."""
    return changed(changed(link, n, line, 0, by=-end * Fraction(by) / 2), n, line, 1,
                   by=-Fraction(by) / 2)


def number_of(link, n, line, at=2):
    return link["parts"][n][1 + (line == "v1")].split()[at]


NOT_CONFIRMED = {
    **{"%s of part %d of the wrong sign" % (line, n): (
        lambda f, n=n, line=line: changed(f, n, line, 2, times=-1))
       for n, line in ((0, "v0"), (0, "v1"), (1, "v1"))},
    **{"%s of part %d three times" % (line, n): (
        lambda f, n=n, line=line: changed(f, n, line, 2, times=3)) for n in (0, 1)
       for line in ("v0", "v1")},
    **{"%s of part %d off by %s" % (line, n, by): (
        lambda f, n=n, line=line, by=by: changed(f, n, line, 2, by=Fraction(by) * sign(
            Fraction(number_of(f, n, line)) - (Fraction(number_of(f, 0, line)) if n else 0))))
       for n in (0, 1) for line in ("v0", "v1") for by in ("1e-30", "1e-3")},
    **{"%s of part %d short by %s at its end %+d" % (line, n, by, end): (
        lambda f, n=n, line=line, end=end, by=by: cut_end(f, n, line, end, by))
       for n in (0, 1) for line in ("v0", "v1") for end in (-1, 1) for by in ("1e-30", "1e-4")},
    **{"%s of part %d is %s" % (line, n, value): (
        lambda f, n=n, line=line, value=value: changed(f, n, line, 2, value))
       for n in (0, 1) for line, value in (("v0", "1e300"), ("v1", "-1e300"), ("v0", "2"),
                                           ("v1", "-4000"))},
    "exchanged": lambda f: with_lines(f, 0, *[
        " ".join([*a.split()[:2], b.split()[2]]) for a, b in (f["parts"][0][1:3],
                                                              f["parts"][0][2:0:-1])]),
    "the whole first region linked": lambda f: {**f, "tree": "a"},
    "the other half of the parameters linked": lambda f: {**f, "tree": "2" + f["tree"][
        1 + len(f["tree"]) // 2:] + f["tree"][1:1 + len(f["tree"]) // 2]},
    "a wider leaf": lambda f: {**f, "v0": "0.5362 0.2506"},
    "turns count": lambda f: changed(f, 0, "v0", 0, by=2),
    "1e301": lambda f: changed(f, 0, "v0", 2, "1e301"),
    "too many digits": lambda f: changed(f, 0, "v0", 2, "0." + "1" * 3000),
}


@pytest.mark.parametrize("name", NOT_CONFIRMED)
def test_what_leads_out_or_is_too_large_is_not_confirmed(both, run, name):
    status, out, err = run(file_of(**NOT_CONFIRMED[name](both)))
    assert (status, out) == (5, "") and err.count("\n") == 1
    assert re.search("is linked to part [ab], but may lead out|limit is 1e300|3000 characters", err)


@pytest.mark.parametrize("by, status", [("-1e-30", 5), ("1e-30", 5), ("0", 0)])
def test_the_later_part_alone(later, run, by, status):
    """It moves by 1e-30 less or more than the link allows, at one end of the parameters only."""
    link = changed(later, 1, "v0", 2, by=by) if Fraction(by) > 0 else cut_end(
        later, 1, "v0", 1, -Fraction(by))
    assert run(file_of(**link))[0] == status


def test_a_link_that_misses_at_one_end_of_the_parameters(both):
    """What is left out of the region is at one end of the leaf's parameters, and only there."""
    link = cut_end(both, 0, "v0", -1, "1e-30")
    claim = check.content(file_of(**link).encode())
    (_, cell), = [leaf for leaf in check.leaves(claim.tree, kinds="Pa")
                  if claim.tree[leaf[0]] == "a"]
    part, out = claim.parts[0], []
    for v, t in corners(claim, cell):
        gap = v[0] - part.centre[0] - sums(part.shifts, t)[0]
        out += [t] * (abs(gap) > part.half[0])
    assert len(set(map(tuple, out))) == 1


@pytest.mark.slow
def test_links_of_regions_that_move_alike(run):
    """They lose nothing: the later region is hardly wider than the leaf."""
    shifts = [("0.003", "-0.002")]
    link = chain(ONE, [(XSTAR, shifts), (XSTAR, shifts)])
    claim = check.content(file_of(**link).encode())
    a, b = claim.parts
    (_, cell), = [leaf for leaf in check.leaves(a.tree, kinds="Pb") if a.tree[leaf[0]] == "b"]
    for n in (0, 1):
        assert b.half[n] - a.half[n] / (1 << cell[1][n]) < Fraction(3, 10 ** 39)
    assert run(file_of(**link))[0] == 0


@pytest.mark.slow
def test_a_parameter_that_moves_no_wave(idle, run):
    """Its shifts count, in links and in prisms."""
    for line, at in (("v0", 3), ("v1", 3)):
        assert run(file_of(**changed(idle, 0, line, at, times=2)))[0] == 5
        assert run(file_of(**changed(idle, 0, line, at, times=-1)))[0] == 5


@pytest.mark.parametrize("line, m", [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_each_shift_counts_alone(idle, line, m):
    """None is taken for none because others are 0."""
    lines = [words.split()[:2] + ["0", "0"] for words in idle["parts"][0][1:3]]
    lines[line][2 + m] = "0.25"
    part, = check.content(file_of(**with_lines(idle, 0, *map(" ".join, lines))).encode()).parts
    assert part.shifts == tuple(tuple(Fraction((i, n) == (line, m), 4) for i in (0, 1))
                                for n in (0, 1))


def test_the_fast_path_is_not_made_for_large_shifts():
    for size, fits in (("2047", True), ("2049", False)):
        claim = part_claim(ONE, XSTAR, (V0 + " 0", V1 + " -" + size))
        with contextlib.nullcontext() if fits else pytest.raises(ValueError, match="too large"):
            check.Lockstep([claim])


@pytest.mark.parametrize("part, shifts, status", [
    (" 0", (0, 0), 3), (" 0", ("-0.8", "0.8"), 5), (" 0.001", ("0.8", "0.8"), 5)])
@pytest.mark.slow
def test_shifts_that_sweep_over_orbits_that_minimize(run, part, shifts, status):
    """A leaf that would be excluded if the region stood still, about where its link begins: near
    the elliptic points, from where it moves out of the island."""
    waves, xstar = ["1 0 0 0.6" + part, "0 1 0 0.6" + part], "1.5707963 1.5707963"
    small, width = "0.5 0.001", Fraction(1, 256)    # the parameter's slice is 0 to 2 / 256
    lines = [decimals(Fraction(1, 2) - s * width, Fraction(1, 1000) + abs(s) * width, s)
             for s in map(Fraction, shifts)]
    link = {"tree": "2P2222222aPPPPPPP", "v0": small, "v1": small, "waves": waves, "xstar": xstar,
            "frame": "1 0 0 1", "parts": [(xstar, *lines, "P")]}
    found = run(file_of(**link))
    assert found[0] == status
    if status == 5:
        assert "part a: proved leaf 1 of 1 (v in" in found[2]
        assert " pi at the parameters' middle, amplitudes in" in found[2]


