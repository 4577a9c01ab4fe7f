"""No torus over a range of parameters, by several x*.

Over one x* a tree of few cuts leaves some clusters of prisms.  Each cluster is linked to a region
of successors of an x* that excludes it cheaply (prover/links.py), perhaps of the same x*.  This
region moves with the parameters, so a range need not be cut into many.  The x* are compared at the
ends of the range; nothing rests on the choice."""

import math
from dataclasses import replace
from fractions import Fraction
from operator import itemgetter
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ..model.exact import decimal_text
from ..model.problem import Problem
from ..model.region import halved, skips, with_image
from ..prover import native, tree
from ..prover.links import (Cell, Link, Target, clusters, corners, crests, hull_of, linked_tree,
                            region_around)
from ..prover.proof import Proof, Tree
from ..prover.run import prove, ready
from ..prover.settings import Settings
from ..prover.shifts import best_shifts
from ..prover.starts import at_corner, reaches, ways

Point = Tuple[str, ...]                 # x*, as the prover takes it

DEPTH = 60                              # cuts of a proof
LOOK_CUTS = {1: 16, 2: 24}              # of the tree over the first x*
RINGS, FINE_RINGS = ([Fraction(step, 1000) for step in steps] for steps in (
    (16, 32, 64, 128, 256, 8, 4), (*range(8, 136, 8), 256)))    # radians, between x*; of one angle
ENOUGH = 1000                           # points: an x* that excludes a cluster so cheaply is good
LEVEL_FACTOR = 8                        # x* are tried with this factor more points each time,
FAR_FACTOR = {1: 4, 2: 8}               # those that are not suggested with this factor fewer.
RANGE_FACTOR = 16                       # points of a range, by those of a try at its ends
TREE_POINTS, LINK_POINTS = 1000, 20000  # the costs of setting up a tree,
                                        # and the bounds of a link.


class Growth:
    """Trees that are grown one after the other, and their cost.

    Parameters
    ----------
    stop
        stop() tells whether to end soon.
    most
        How many points may be computed.

    Attributes
    ----------
    points
        How many points of orbits were computed, and what else was done, in such points.
    spent
        The points of the last tree.
    stopped
        Whether a tree was broken off because stop() returned True, or for more points than `most`.
    """

    def __init__(self, stop: Callable[[], bool], most: float = math.inf) -> None:
        self.stop, self.most = stop, most
        self.points = self.spent = 0
        self.stopped = False

    def grow(self, problem: Problem, xstar: Point, cuts: int, points: float,
             stubborn: bool = False, longest: int = native.ORDINARY
             ) -> Optional[Tuple[native.Grown, native.Search]]:
        """A tree and its search; None: it takes more points, or a prism is undecided and the
        search is not stubborn, or it was stopped.

        Parameters
        ----------
        problem, xstar
            What the tree is of, and over which x*.
        cuts, points, stubborn, longest
            The most cuts; the most points of its orbits; whether to go on after a prism that cannot
            be decided; the most points of an orbit.
        """
        search = native.Search(native.Task(
            problem, Settings("loewner", cuts, stubborn=stubborn), xstar, longest))
        self.stopped = self.stopped or self.points > self.most or not (
            search.work(0, self.stop) and search.work(
                1, self.stop, points=min(points, self.most - self.points))) or self.stop()
        if self.stopped:
            return None
        grown = search.view(True)
        self.spent = int(grown.points)
        self.points += self.spent + TREE_POINTS
        self.stopped = self.points > self.most
        if self.stopped:
            return None
        if grown.cells or grown.counts.undecided and not stubborn:
            return None
        return grown, search


def linked(growth: Growth, problem: Problem, xstars: Sequence[Point], points: float
           ) -> Tuple[Optional[Proof], List[Point]]:
    """A proof, or None, and x*: the first one, and those that exclude clusters.

    Parameters
    ----------
    growth
        Grows the trees.
    problem
        The maps, and the whole torus.
    xstars
        The first x*, and others with which clusters are tried first.
    points
        The most points of orbits of a cluster's tree at an end of the range.
    """
    before = ready(Proof((Tree(problem, xstars[0]),), Settings("loewner", DEPTH)))
    problem, used = before.problem, [xstars[0]]
    targets: List[Target] = []
    parts: List[Tree] = []
    if problem.factor is not None or skips(problem, xstars[0]) or not problem.present:
        return None, used               # prover/run.py, _may_link; a map with V = 0
    found = growth.grow(problem, xstars[0], LOOK_CUTS[1 if problem.is_flat else 2],
                        RANGE_FACTOR * points, True)
    if found is None:
        return None, used
    grown, search = found
    work = _Linking(growth, problem, xstars[0], Fraction(search.constants["B"]), points)
    for cells in clusters(problem, grown.text):
        choice = work.best(cells, [*used, *xstars[1:]])
        if choice is None:
            return None, used
        used += [choice.xstar] if choice.xstar not in used else []
        part = work.part(cells, choice)
        if part is None:
            return None, used
        targets.append(replace(part[0], letter=tree.LETTERS[len(parts)]))
        parts.append(part[1])
    text = linked_tree(problem, grown.text, targets)
    if "U" in text or any(target.letter not in text for target in targets):
        return None, used
    proof = prove(resume=replace(before, trees=(replace(before.trees[0], text=text), *parts)),
                  jobs=1)
    return proof if proof.no_tori else None, used


class _Linking:
    """The choice of x* for what a tree over the first x* leaves.  largest: B."""

    def __init__(self, growth, problem, first, largest, points):
        self.growth, self.problem, self.first, self.largest = growth, problem, first, largest
        self.points, self.far = points, FAR_FACTOR[1 if problem.is_flat else 2]
        self.ends = [_End(problem, min(largest, crest), signs) for crest, signs in zip(
            crests(problem), corners(problem))]

    def best(self, cells: List[Cell], xstars: Sequence[Point]) -> "Optional[_Choice]":
        """The x* that excludes the cells at the ends of the range at the least cost; None: no x*
        was found.  These x* and rings around the first one are tried with ever more points, then
        rings around the best one."""
        best: Optional[_Choice] = None
        boxes = [hull_of(self.problem, [cell for cell in cells if reaches(cell, end.signs)]
                         or cells) for end in self.ends]

        def look(xstars, points):
            nonlocal best
            for xstar in dict.fromkeys(xstars):
                if not (best and best.points <= ENOUGH):
                    best = self._choice(boxes, xstar, best.points if best else points) or best

        def around(step):
            centre = [Fraction(x) for x in (best.xstar if best else self.first)]
            return [tuple(decimal_text(a + step * b) for a, b in zip(centre, way))
                    for way in ways(self.problem)]

        points, most = ENOUGH, self.points * len(self.ends)
        others = [xstar for step in (FINE_RINGS if self.problem.is_flat else RINGS)
                  for xstar in around(step)]
        while not best and points < most:
            points = min(LEVEL_FACTOR * points, most)
            look([*xstars, *(others if self.far * points <= most else [])], points)
        for step in RINGS if best else []:
            look(around(step), points)
        return best

    def _choice(self, boxes, xstar, points):
        """The _Choice of an x*; None: it takes more points."""
        spent, found = 0, []
        for end, box in zip(self.ends, boxes):
            if self.growth.stopped:
                return None
            self.growth.points += LINK_POINTS * (xstar not in end.links)
            problem = end.region(box, self.first, xstar)
            grown = self.growth.grow(problem, xstar, DEPTH, points - spent)
            if grown is None:
                return None
            spent += self.growth.spent
            found.append((self.growth.spent, problem, grown[0].text))
        return _Choice(spent, xstar, *max(found, key=itemgetter(0))[1:])

    def part(self, cells: List[Cell], choice: "_Choice") -> Optional[Tuple[Target, Tree]]:
        """The region of the cells over the x*, and its tree; None: that takes too many points."""
        problem, xstar = self.problem, choice.xstar
        shifts = () if not problem.parts else best_shifts(
            problem.part(choice.end.region), choice.end.amplitude, xstar, choice.text)
        link = Link.between(problem, self.largest, self.first, xstar)
        region = region_around(hull_of(problem, cells, shifts), link)
        part = halved(problem.part(region, shifts), xstar)
        self.growth.points += LINK_POINTS
        found = self.growth.grow(part, xstar, DEPTH, RANGE_FACTOR * max(self.points, choice.points))
        return None if found is None else (Target("", link, with_image(part, xstar), shifts),
                                           Tree(part, xstar, found[0].text))


class _Choice(NamedTuple):
    """An x* that excludes a cluster at the ends: the points that takes; and the problem at the end
    at which it takes most, with its tree."""

    points: int
    xstar: Point
    end: Problem
    text: str


class _End:
    """The problem at an end of its parameters, and a bound of B there."""

    def __init__(self, problem, largest, signs):
        self.problem, self.largest, self.signs = at_corner(problem, signs), largest, signs
        self.links: Dict[Point, Link] = {}

    def region(self, box, first, xstar):
        """The problem in a region over x* to which the box over the first x* is linked."""
        if xstar not in self.links:
            self.links[xstar] = Link.between(self.problem, self.largest, first, xstar)
        return halved(self.problem.part(region_around(box, self.links[xstar])), xstar)
