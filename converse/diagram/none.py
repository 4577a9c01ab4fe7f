"""No torus over a cell of the parameters: x* are chosen by what they leave.

Near the last torus only some x* exclude all successors, and which they are changes with the
parameters within a percent.  So a cell is first tried at its middle.  Over each x* of a coarse
scan of the torus a tree of few cuts is grown; the x* that leaves the fewest prisms is improved by
steps; and a cell is given the x* that excludes its middle at the least cost.  Where one x* does not
do for the middle, or only for a small part of the cell about it, what it leaves is linked to others
(linked.py).  A scan costs as much as many tries, so first come the x* of neighbours.  All costs are
points of orbits, so the outcome depends on the cell and on the x* that are suggested, not on the
machine.
"""

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

from ..model.exact import decimal_text
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..prover.proof import Proof, Tree
from ..prover.run import ready
from ..prover.settings import Settings
from .linked import DEPTH, Growth, Point, linked

SCAN = {1: 62, 2: 8}                    # x* of a scan in a turn
SCAN_CUTS, STEP_CUTS = {1: 8, 2: 12}, {1: 14, 2: 16}    # of the trees that compare x*
SCAN_LENGTH = 400                       # the most points of their orbits; and of such a tree
SCAN_POINTS = {1: 20000, 2: 1 << 17}
LEAST_STEP = {1: 0.003, 2: 0.02}        # radians, by which x* is moved
BASINS, CHOICES = 3, 6                  # x* that are improved; that are then tried to the end
HINTS = 3                               # x* of neighbours that are tried first, each alone
RANGE_FACTOR = 4                        # points of a range over one x*, by those of its middle
NARROW = Fraction(1, 8)                 # If one x* excludes this part of a cell, it is halved.
SCALE = 10 ** 4                         # x* has four decimals


class Outcome(NamedTuple):
    """The result of a try at a cell.

    Attributes
    ----------
    points
        How many points of orbits were computed.
    proof
        The Proof that no map of the cell has invariant tori; None: none was found.
    xstars
        x* over which the middle of the cell is excluded; (): none was found, and a torus may be
        there.
    """

    points: int
    proof: Optional[Proof]
    xstars: Tuple[Point, ...]


def exclude(family: SymplecticMap, hints: Sequence[Point], points: int, most: float = math.inf,
            stop: Callable[[], bool] = bool) -> Optional[Outcome]:
    """Tries to prove that no map of a family has invariant tori.

    Parameters
    ----------
    family
        The family, whose first parameter has a range.
    hints
        x* that excluded maps near by, the nearest first.
    points
        The most points of orbits of a try at the middle.
    most
        The most points of all.
    stop
        stop() tells whether to end soon.

    Returns
    -------
    Outcome
        None if it was stopped.  It tells of more points than `most` if more are needed.
    """
    def part(share):
        """The problem over this share of the range, about its middle."""
        low, high = family.ranges[0]
        ends = [(low + high + sign * share * (high - low)) / 2 for sign in (-1, 1)]
        return Problem.of(family.at(**{family.names[0]: ends}))

    def outcome(proof=None, used=()):
        stopped = search.stopped and search.points <= most and not proof
        return None if stopped else Outcome(search.points, proof, tuple(used))

    search, problem = _Search(part(0), points, stop, most), part(1)
    for xstars, alone in search.candidates(hints):
        costs, proof = search.cheapest(xstars), None
        used = [xstar for _, xstar in costs[:1]]
        if costs:
            dearest = RANGE_FACTOR * max(points, costs[0][0])
            proof = search.proof(problem, used[0], dearest)
            if not proof and search.proof(part(NARROW), used[0], dearest):
                return outcome(None, used)
        elif not (alone or search.stopped):
            found, used = linked(search, search.problem, [*xstars[:1], *hints], points)
            used = used if found else []
        if used:
            if not proof:
                proof, used = linked(search, problem, [*used, *hints], points)
            return outcome(proof, used)
    return outcome()


class _Search(Growth):
    """The choice of x* for one map."""

    def __init__(self, problem, dearest, stop, most):
        super().__init__(stop, most)
        self.problem, self.dearest = problem, dearest
        self.q = next((k for k, _ in problem.present), (1, 0))
        self.axes = 1 if problem.is_flat else 2         # V depends on q.y alone, or on both angles

    def proof(self, problem, xstar, points):
        """The proof of a problem over x*, if it takes no more points; else None."""
        before = ready(Proof((Tree(problem, xstar),), Settings("loewner", DEPTH)))
        found = self.grow(before.problem, xstar, DEPTH, points)
        if found is None:
            return None
        grown, search = found
        proof = replace(before.with_tree(0, text=grown.text), counts=grown.counts,
                        constants=search.constants, at_once=search.at_once)
        return proof if proof.no_tori else None

    def _left(self, place, cuts):
        """How much a small tree over a place leaves, and what it costs."""
        xstar = self._point(place)
        before = ready(Proof((Tree(self.problem, xstar),), Settings("loewner", cuts)))
        found = self.grow(before.problem, xstar, cuts, SCAN_POINTS[self.axes], True, SCAN_LENGTH)
        return (math.inf, 0) if found is None else (found[0].counts.undecided, self.spent)

    def candidates(self, hints):
        """Yields lists of x*, and whether only a single one is to be tried: the x* of neighbours;
        those that steps from these lead to; and those that a scan leads to."""
        near = [self._place(tuple(map(Fraction, hint))) for hint in hints[:HINTS]]
        if hints:
            yield hints[:HINTS], True
            yield self._improved(near, 8 * LEAST_STEP[self.axes]), False
        yield self._improved(self._basins(), math.pi / SCAN[self.axes]), False

    def cheapest(self, candidates) -> List[Tuple[int, Point]]:
        """Those of these x* over which the map is excluded, with the points that this takes, the
        fewest first."""
        found: List[Tuple[int, Point]] = []
        for xstar in candidates:
            before = ready(Proof((Tree(self.problem, xstar),), Settings("loewner", DEPTH)))
            if self.grow(before.problem, xstar, DEPTH, min([self.dearest, *(
                    cost for cost, _ in found)])):
                found.append((self.spent, xstar))
        return sorted(found)

    def _improved(self, places, first_step) -> List[Point]:
        """The most promising x*, from places that are improved by ever smaller steps."""
        axes, known = self.axes, {}

        def left(place):
            if place not in known:
                known[place] = self._left(place, STEP_CUTS[axes])
            return known[place]

        for place in places:
            step = first_step
            while step > LEAST_STEP[axes] and not self.stopped:
                move = round(step * SCALE)
                near = [tuple(x + move * way for x, way in zip(place, ways))
                        for ways in itertools.product((0, -1, 1), repeat=axes)]
                best = min(near, key=left)
                place, step = best, step / 2 if best == place else step
        return [self._point(place) for place in sorted(known, key=known.__getitem__)[:CHOICES]]

    def _basins(self):
        """Places of the scan, and that which the prover would choose, the most promising first."""
        count, axes = SCAN[self.axes], self.axes
        chosen = ready(Proof((Tree(self.problem),), Settings("loewner"))).xstar
        places = [self._place(tuple(map(Fraction, chosen)))]    # best where all are equal
        even = all(term.phase % 1 == Fraction(1, 2) for term in self.problem.terms)
        places += [tuple(round(2 * math.pi * SCALE * (i + 0.5) / count) for i in at)
                   for at in itertools.product(range(count), repeat=axes)
                   if not even or at <= tuple(count - 1 - i for i in at)]   # x* does as -x* does
        scores = {place: self._left(place, SCAN_CUTS[axes]) for place in dict.fromkeys(places)}
        return sorted(scores, key=scores.__getitem__)[:BASINS]

    def _point(self, place) -> Point:
        """x* at a place, which has one coordinate where V depends on q.y alone."""
        x = [Fraction(x, SCALE) for x in place]
        if self.axes == 1:
            x.insert(1 if self.q[0] else 0, Fraction(0))
        return decimal_text(x[0]), decimal_text(x[1])

    def _place(self, point):
        """The place of an x*, about."""
        if self.axes == 1:
            axis = 0 if self.q[0] else 1
            point = [sum(a * b for a, b in zip(self.q, point)) / self.q[axis]]
        return tuple(round(x * SCALE) for x in point)
