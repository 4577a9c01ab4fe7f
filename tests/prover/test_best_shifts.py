"""How the regions of parts are made to move with the parameters."""

import math
from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from files import line
from test_links import make_links_easy

from converse import Problem, prove
from converse.model.map import SymplecticMap
from converse.model.region import folds
from converse.prover import native, starts
from converse.prover.links import corners, crests
from converse.prover.settings import Settings
from converse.prover.shifts import STEPS, best_shifts

from truth import TORTURE

HERE = "0.858028", "0.858028"
REGION = (Fraction("0.6807"), Fraction("0.6851")), (Fraction(0), Fraction("0.006"))


line = partial(line, axes=(1, 1, 1, -1))


def grown(problem, depth=120, stubborn=False):
    return native.grow(native.Task(problem, Settings("loewner", depth, stubborn=stubborn), HERE),
                       leaves=100000)


@pytest.fixture(scope="module")
def narrow():
    """A narrow range of parameters, a tree for its lower end and the shifts that it suggests."""
    problem = line("0.01395", "0.013951").part(REGION)
    lower = line("0.01395").part(REGION)
    text = grown(lower).text
    return problem, lower, text, best_shifts(problem, lower.amplitude, HERE, text)


def ends(amplitude, v):
    """The ends of an orbit, followed for STEPS either way."""
    x, y = [float(a) for a in HERE], [math.pi * (v[0] + v[1]), math.pi * (v[0] - v[1])]
    a, b, c = map(float, amplitude)
    found = []
    for o, q in (x, y), (y, x):
        for _ in range(STEPS):
            both = c * math.cos(q[0] + q[1])
            o, q = q, [2 * q[0] - o[0] + a * math.cos(q[0]) + both,
                       2 * q[1] - o[1] + b * math.cos(q[1]) + both]
        found += q
    return found


@pytest.mark.slow
def test_orbits_through_a_region_that_moves_stay_together(narrow):
    """Against differences: of all shifts near these none moves the ends of orbits less."""
    problem, lower, _, ((s0, s1),) = narrow
    start, t = (0.68296, 0.0004), 1e-4
    p = [float(x) for x in lower.amplitude]
    moved = [x + t * float(part) for x, part in zip(p, problem.parts[0])]

    def moves(shift):
        v = [x + t * float(s) for x, s in zip(start, shift)]
        return math.dist(ends(p, start), ends(moved, v))

    best, still = moves((s0, s1)), moves((0, 0))
    assert best < still / 20 and 1e-6 < s0 < 2e-6 and abs(s1) < s0 / 10
    for off in (-1, 1):
        assert best < moves((s0 * (1 + Fraction(off, 3)), s1))
        assert best < moves((s0, s1 + off * s0 / 3))


@pytest.mark.slow
def test_fewer_prisms(narrow):
    """The range takes several times as many prisms as its lower end alone; hardly more, if the
    region moves with it."""
    problem, _, text, shifts = narrow
    still, moving = grown(problem), grown(replace(problem, shifts=shifts))
    assert not moving.counts.undecided and not still.counts.undecided
    assert moving.counts.proved < 1.5 * text.count("P")
    assert moving.counts.proved < 0.7 * still.counts.proved


def test_the_scale_of_the_parameter(narrow):
    """Shifts are what the parameter adds at its upper end: in proportion to the range."""
    problem, lower, text, ((s0, _),) = narrow
    (wide,) = best_shifts(line("0.01395", "0.01396").part(REGION), lower.amplitude, HERE,
                          text)
    assert wide[0] == pytest.approx(10 * s0, rel=1e-2)


def test_undecided_prisms_come_first(narrow):
    """Where the tree has any, the shifts are theirs, not those of prisms that were cut more."""
    problem, lower, *_ = narrow
    left = best_shifts(problem, lower.amplitude, HERE, "0U1PP")
    assert left == best_shifts(problem, lower.amplitude, HERE, "0U1P1PP")
    assert left != best_shifts(problem, lower.amplitude, HERE, "0P1P1PP")


def test_an_angle_that_is_not_felt():
    """Where waves feel one angle, the other need not move: least squares have no answer there."""
    problem = Problem(SymplecticMap([(1, 0)], ["0.98"], [["0.001"]]), v0=(0, 1), v1=(0, 2),
                      axes=(1, 0, 0, 1))
    ((s0, s1),) = best_shifts(problem, ["0.979"], ("3.14", "0"), "0P0PP")
    assert s0 != 0 and abs(s1) < Fraction(1, 10 ** 6)


def test_where_the_waves_bend_least():
    problem = Problem(SymplecticMap([(1, 0), (0, 1)], ["0.3", "-0.2"], [["0.1", 0], [0, "0.1"]]))
    _, signs = min(zip(crests(problem), corners(problem)))
    weakest = starts.at_corner(problem, signs)
    assert signs == (-1, 1) and weakest.amplitude == (Fraction("0.2"), Fraction("-0.1"))
    assert starts.reaches(((5, 3, 0, 3, 0), (3, 2, 4, 2, 0)), signs)
    assert not starts.reaches(((5, 3, 0, 2, 0), (3, 2, 4, 2, 0)), signs)
    assert not starts.reaches(((5, 3, 1, 3, 0), (3, 2, 4, 2, 0)), signs)


@pytest.mark.slow
def test_a_range_is_linked_to_a_region_that_moves(monkeypatch):
    """Where links are made of short orbits already.  The second region is half of one that the
    exchange of the angles maps to itself: it moves along v0 alone."""
    make_links_easy(monkeypatch)
    proof = prove(line("0.0145", "0.0146", axes=None), method="loewner")
    whole, half = proof.parts
    assert proof.no_tori and proof.counts.linked and proof.counts.proved < 2000
    assert whole.problem.shifts[0][1] and not folds(whole.problem, whole.xstar)
    assert half.problem.shifts[0][0] and folds(half.problem, half.xstar)
    assert half.problem.v1[0] == 0 and proof.verify()


@pytest.mark.slow
@pytest.mark.skipif(TORTURE <= 1, reason="minutes; make torture has it")
def test_a_range_takes_fewer_prisms_over_regions_that_move():
    """With regions that stay where they are it takes 61,058 prisms."""
    proof = prove(line("0.01397", "0.014", axes=None), method="loewner")
    assert proof.no_tori and all(part.problem.shifts for part in proof.parts)
    assert proof.parts and proof.counts.proved < 20000
