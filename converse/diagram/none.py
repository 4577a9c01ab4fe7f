"""No torus over a cell of the parameters: x* is chosen by what it leaves.

Near the last torus only some x* exclude all successors, and which they are changes with the
parameters within a percent.  So a cell is first tried at its middle.  Over each x* of a coarse
scan of the torus a tree of few cuts is grown; the x* that leaves the fewest prisms is improved by
steps; and a cell is given the x* that excludes its middle at the least cost.  A scan costs as much
as many tries, so first come the x* of neighbours, and those that steps from these lead to.  All
costs are points of orbits, so the outcome depends on the cell and on the x* that are suggested, not
on the machine.
"""

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

from ..model.exact import decimal_text
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..prover import native
from ..prover.proof import Proof, Tree
from ..prover.run import prove, ready
from ..prover.settings import Settings

Point = Tuple[str, str]                 # x*, as the prover takes it

SCAN = {1: 62, 2: 8}                    # x* of a scan in a turn
SCAN_CUTS, STEP_CUTS = {1: 8, 2: 12}, {1: 14, 2: 16}    # of the trees that compare x*
SCAN_LENGTH = 400                       # the most points of their orbits; and of such a tree
SCAN_POINTS = {1: 20000, 2: 1 << 17}
LEAST_STEP = {1: 0.003, 2: 0.02}        # radians, by which x* is moved
BASINS, CHOICES = 3, 6                  # x* that are improved; that are then tried to the end
HINTS = 3                               # x* of neighbours that are tried first
DEPTH = 60                              # cuts of a proof
RANGE_FACTOR, RANGE_TRIES = 6, 2        # points of a range, by those of its middle; x* for it
CHEAP = 4                               # A neighbour's x* that costs such a part is good.
TREE_POINTS = 1000                      # A tree costs as much as so many more, to set it up.
SCALE = 10 ** 4                         # x* has four decimals


class Outcome(NamedTuple):
    """What became of a cell.

    Attributes
    ----------
    points
        How many points of orbits were computed.
    proof
        The Proof that no map of the cell has invariant tori; None: none was found.
    xstar
        An x* over which the middle of the cell is excluded; None: none was found, and a torus may
        be there.
    """

    points: int
    proof: Optional[Proof]
    xstar: Optional[Point]


def exclude(family: SymplecticMap, middle: SymplecticMap, hints: Sequence[Point], points: int,
            stop: Callable[[], bool] = bool) -> Optional[Outcome]:
    """Tries to prove that no map of a family has invariant tori.

    Parameters
    ----------
    family, middle
        The family, and the map in its middle.
    hints
        x* that excluded maps near by, the nearest first.
    points
        The most points of orbits of a try at the middle.
    stop
        stop() tells whether to end soon.

    Returns
    -------
    Outcome
        None if it was stopped.
    """
    search = _Search(Problem.of(middle), points, stop)
    problem, enough = Problem.of(family), points / CHEAP
    best: Tuple[float, Optional[Point]] = (math.inf, None)
    for xstars in search.candidates(hints[:HINTS]):
        choices = search.cheapest(xstars)
        best = min([best, *choices[:1]], key=lambda choice: choice[0])
        for cost, xstar in choices[:RANGE_TRIES]:
            grown = search.proof(problem, xstar, RANGE_FACTOR * max(points, cost))
            if grown:
                proof = prove(resume=grown, jobs=1)     # Its tree is whole.
                return Outcome(search.points, proof if proof.no_tori else None, xstar)
        if best[0] < enough:            # A half of the cell costs less than other x*.
            break
        enough = math.inf
    return None if search.stopped else Outcome(search.points, None, best[1])


class _Search:
    """The choice of x* for one map.  points: how many have been computed so far; stopped: whether
    a try was broken off."""

    def __init__(self, problem, most, stop):
        self.problem, self.most, self.stop = problem, most, stop
        self.points = self.spent = 0
        self.stopped = False
        self.q = next((k for k, _ in problem.present), (1, 0))
        self.axes = 1 if problem.is_flat else 2         # V depends on q.y alone, or on both angles

    def _grown(self, problem, xstar, cuts, points, stubborn, longest=native.ORDINARY):
        """The Proof that a search over x* begins with, and what became of it; None: stopped."""
        before = ready(Proof((Tree(problem, xstar),), Settings("loewner", cuts, stubborn=stubborn)))
        grown = None if self.stopped else native.grow(
            native.Task(before.problem, before.settings, before.xstar, longest), points=points,
            look=self.stop)
        self.stopped = self.stopped or grown is None or self.stop()
        self.spent = int(grown.points) if grown else 0
        self.points += self.spent + TREE_POINTS
        return before, grown

    def proof(self, problem, xstar, points):
        """The proof of a problem over x*, if it takes no more points; else None."""
        before, grown = self._grown(problem, xstar, DEPTH, points, False)
        if grown is None or grown.cells or grown.counts.undecided:
            return None
        return replace(before.with_tree(0, text=grown.text), counts=grown.counts)

    def _left(self, place, cuts):
        """How much a small tree over a place leaves, and what it costs."""
        _, grown = self._grown(self.problem, self._point(place), cuts, SCAN_POINTS[self.axes], True,
                               SCAN_LENGTH)
        if grown is None:
            return math.inf, 0
        return math.inf if grown.cells else grown.counts.undecided, self.spent

    def candidates(self, hints):
        """Yields lists of x*: those of neighbours, those that steps from these lead to, and those
        that a scan leads to."""
        yield hints
        near = [self._place(tuple(map(Fraction, hint))) for hint in hints]
        yield [x for x in self._improved(near, 8 * LEAST_STEP[self.axes]) if x not in hints]
        yield self._improved(self._basins(), math.pi / SCAN[self.axes])

    def cheapest(self, candidates) -> List[Tuple[int, Point]]:
        """Those of these x* over which the map is excluded, with the points that this takes, the
        fewest first."""
        return sorted((self.spent, xstar) for xstar in candidates
                      if self.proof(self.problem, xstar, self.most))

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
        places += [tuple(round(2 * math.pi * SCALE * (i + 0.5) / count) for i in at)
                   for at in itertools.product(range(count), repeat=axes)]
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
