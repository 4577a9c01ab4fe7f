"""Chooses further starting points, where one leaves prisms undecided.

Orbits that minimize leave gaps, and x* must lie in one; but those of different rotation vectors
leave different gaps.  So one x* may contradict all but a few clusters of prisms, and for each of
these another x*, near by, is better.  The tree over the first x* is grown to a moderate depth; what
is left is linked (links.py) to regions over others.  Nothing rests on how those are chosen."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import chain, combinations, compress
from math import inf, prod
from typing import List, Tuple

from ..model.exact import decimal_text
from ..model.map import SymplecticMap
from ..model.problem import rows
from ..model.region import folds, halved, with_image
from . import native, tree
from .links import Link, Target, clusters, corners, crests, hull_of, linked_tree, region_around
from .proof import Tree
from .settings import Settings
from .shifts import best_shifts

LOOK_DEPTH = 24                         # cuts of the first tree that is clustered
DEEPER = 4                              # cuts, by which the next such tree is deeper
MAX_LOOK_LEAVES = 200000                # of such a tree
MAX_MOVING_LEAVES = 50000               # Larger clusters are good enough where regions move.
# Where there are tori, the orbits of the tree are long, and no other x* helps.  Of all maps in
# docs/explanation/method.md the crossed one with s = 0.58 needs the most points of orbits: 17
# million, and 0.9 million in the trees of less than LOOK_DEPTH cuts.
MAX_LOOK_POINTS, MAX_SHRINK_POINTS = 50_000_000, 5_000_000
SMALL_AREA = Fraction(1, 10000)         # of all clusters, in powers of pi: no deeper tree is grown
MAX_SHRINK_RATIO = 0.7                  # of the undecided volume, from a tree to one DEEPER
TRY_DEPTH, MAX_TRY_LEAVES = 16, 10000   # of trees that compare starting points
MAX_PROOF_LEAVES = 40000                # of a tree that is tried to the end
FINE_STEPS, NEAR_STEPS, FAR_STEPS = (   # between points, in radians
    [Fraction(x, 1000) for x in steps] for steps in ((4, 8), (16, 32, 64), (128, 256, 512)))
MAX_PARTS = 26                          # a letter each


@dataclass
class Plan:
    """The tree over a starting point with its links: the text, the statistics
    of the search, and the new parts."""

    tree: str
    counts: native.Counts
    parts: List[Tree]


def plan(problem, depth, xstar, undecided, largest, before, longest, threads, is_late):
    """A Plan for a region over xstar; None: none was found, or is_late() was True before.
    Prisms without a better point become untried.

    undecided: whether the tree over x* alone is known to be undecided; before: the number of
    further parts so far; largest: B; longest: the most points of an orbit in a tree that is tried
    to the end; threads: how many work on a tree."""
    survey = partial(_surveys, threads, is_late)
    grown, found = _look(problem, depth, xstar, survey)
    if not found or before + len(found) > MAX_PARTS:
        return None
    targets, parts = [], []
    points = [] if undecided else [tuple(Fraction(x) for x in xstar)]   # x* itself may do
    for cells in found:
        image = _Image(problem, depth, xstar, largest, cells, longest, survey)
        best = _best_start(image, points)
        shifts = () if best is None else image.shifts(best)
        if is_late():
            return None
        if best is not None and (_text(best) != xstar or shifts):
            link = Link.between(problem, largest, xstar, _text(best))
            region = region_around(hull_of(problem, cells, shifts), link)
            part = halved(problem.part(region, shifts), _text(best))
            targets.append(Target(tree.LETTERS[before + len(parts)], link,
                                  with_image(part, _text(best)), shifts))
            parts.append(Tree(part, _text(best)))
            points += [best] if best not in points else []
    text = linked_tree(problem, grown.text, targets)
    used = [target.letter in text for target in targets]    # one region may do for two clusters
    names = zip(compress((ord(target.letter) for target in targets), used), tree.LETTERS[before:])
    text = text.translate(dict(names)).replace("U", tree.UNTRIED)
    return Plan(text, grown.counts, list(compress(parts, used))) if any(used) else None


def _look(problem, depth, xstar, survey):
    """Grows a tree over xstar and returns it with the clusters of its undecided prisms.  The depth
    is LOOK_DEPTH, and greater as long as the area of the clusters is large and is halved.
    (None, []) if the tree is too large, or time was up."""
    best, covered, cuts = (None, []), inf, LOOK_DEPTH
    enough = MAX_MOVING_LEAVES if has_width(problem) else MAX_LOOK_LEAVES
    while cuts <= depth and (best[0] or _shrinks(problem, xstar, survey)):
        grown = _whole(problem, xstar, cuts, survey, MAX_LOOK_POINTS)
        if grown is None:
            break
        found = clusters(problem, grown.text)
        area = sum(prod(b - a for a, b in hull_of(problem, cells)) for cells in found)
        if best[1] and 2 * area > covered:
            break
        best, covered, cuts = (grown, found), area, cuts + DEEPER
        if area < SMALL_AREA or 3 * len(grown.text) > 2 * enough:
            break
    return best


def _shrinks(problem, xstar, survey):
    """Does what is undecided become less with each DEEPER cuts?  If there are tori it does not:
    each has a successor of any x*, and cuts around these to LOOK_DEPTH may take minutes."""
    volume = inf
    for cuts in range(max(DEEPER, LOOK_DEPTH - 3 * DEEPER), LOOK_DEPTH, DEEPER):
        grown = _whole(problem, xstar, cuts, survey, MAX_SHRINK_POINTS)
        left = inf if grown is None else sum(
            0.5 ** sum(cell[1]) for kind, cell in tree.cells(grown.text) if kind == "U")
        if grown is None or left > MAX_SHRINK_RATIO * volume:
            return False
        volume = left
    return True


def _whole(problem, xstar, cuts, survey, points):
    """The tree down to `cuts` cuts; None if it has more than MAX_LOOK_LEAVES leaves or `points`
    points of orbits, or if time was up."""
    grown = survey([native.Task(problem, Settings("loewner", cuts, stubborn=True), xstar)],
                   MAX_LOOK_LEAVES, points)
    return grown[0] if grown and not grown[0].cells else None


def _surveys(threads, is_late, tasks, leaves, points=inf):
    """The trees of the tasks, of `leaves` leaves or `points` points each; [] if time was up."""
    found = []
    for task in tasks:
        grown = native.grow(task, leaves, points, threads, is_late)
        if grown is None:
            return []
        found.append(grown)
    return found


class _Image:
    """The image of a box over other starting points, where the waves bend least: there most prisms
    resist, and cuts of parameters do not hide how many."""

    def __init__(self, problem, depth, xstar, largest, cells, longest, survey):
        """cells: whose hull is the box, those that there are for the weakest waves."""
        crest, signs = min(zip(crests(problem), corners(problem)))
        cells = [cell for cell in cells if reaches(cell, signs)] or cells
        self.weakest, self.box = at_corner(problem, signs), hull_of(problem, cells)
        self.problem, self.depth, self.xstar = problem, depth, xstar
        self.largest = min(largest, crest)
        self.longest, self.survey = longest, survey

    def part(self, point):
        """The problem over the point: in half of the region, if the mirror image of the half is the
        other half."""
        link = Link.between(self.weakest, self.largest, self.xstar, _text(point))
        return halved(self.problem.part(region_around(self.box, link)), _text(point))

    def is_half(self, point):
        """Is the region over this point halved?"""
        return folds(self.part(point), _text(point))

    def grow(self, points, settings, most, longest=native.ORDINARY):
        """The trees over the points, of `most` leaves each; [] if time was up."""
        parts = [self.part(point) for point in points]
        return self.survey([
            native.Task(self.weakest.part(part.region), settings, _text(point), longest)
            for part, point in zip(parts, points)], most)

    def proof(self, point):
        """A tree over the point, tried to the end; None if time was up."""
        grown = self.grow([point], Settings("loewner", self.depth), MAX_PROOF_LEAVES, self.longest)
        return grown[0] if grown else None

    def shifts(self, point):
        """How the region over this point is to move with the parameters; () if there are none.
        Half of a region does not move along v1."""
        grown = self.proof(point) if has_width(self.problem) else None
        if grown is None:
            return ()
        part = self.part(point)
        shifts = best_shifts(part, self.weakest.amplitude, _text(point), grown.text)
        half = folds(part, _text(point))
        return tuple((s0, Fraction(0)) for s0, *_ in shifts) if half else shifts


def _best_start(image, others):
    """A starting point over which the box's image is proved where the waves bend least; if none is
    found, that over which the fewest prisms resist; None if that is x* or time is up.  The prisms
    of half a region are compared with those of whole ones as they are.  If no point is good enough,
    a good one is looked for once more, and the half's count twice.

    others: points to be tried first."""
    start = tuple(Fraction(x) for x in image.xstar)
    known = {}          # scores

    def look(points):
        """The best of these points; None if time was up."""
        new = [point for point in dict.fromkeys(points) if point not in known]
        most = min([MAX_TRY_LEAVES, *(2 * leaves for _, leaves in sorted(known.values())[:1])])
        grown = image.grow(new, Settings("loewner", TRY_DEPTH, stubborn=True), most)
        known.update((point, _score(one, weight if image.is_half(point) else 1))
                     for point, one in zip(new, grown))
        return min(points, key=known.__getitem__) if len(grown) == len(new) else None

    best, tried = None, set()
    for weight in 1, 2:
        known.update((point, tuple(weight * x for x in score)) for point, score in known.items()
                     if image.is_half(point))
        for point in chain(others, _candidates(look, known, start, ways(image.problem))):
            if point not in tried:
                grown = image.proof(point)
                if grown and tree.complete(grown.text) and not grown.counts.undecided:
                    return point
            tried.add(point)
        best = best or min(known, key=known.__getitem__, default=start)
    return None if best == start or known[best][0] == inf else best


def ways(problem):
    """Directions of length 1: along the axes of the frame and across.  Where the waves depend on
    one combination of the angles, only along its gradient."""
    columns = list(zip(*rows(problem.frame)))
    ways = [*columns, *([a + sign * b for a, b in zip(*pair)]
                        for pair in combinations(columns, 2) for sign in (1, -1))]
    if problem.is_flat:
        ways = [problem.present[0][0]]
    return [tuple(Fraction(sign * x, max(map(abs, way))) for x in way)
            for way in ways if any(way) for sign in (1, -1)]


def _candidates(look, known, start, ways):
    """Yields points over which few prisms resist, good ones first, as long as look() has time.
    First come points near start and points that smaller steps from the best one lead to, then
    points farther away."""
    best = look([start])
    for steps in NEAR_STEPS, FAR_STEPS:
        rings = [look([_moved(start, step, way) for way in ways]) for step in steps]
        if best is None or None in rings:
            return
        best = min([best, *rings], key=known.__getitem__)
        yield best
        for step in reversed([*FINE_STEPS, *steps]):
            while known[best][0]:
                better = look([_moved(best, step, way) for way in ways])
                if better is None:
                    return
                if not known[better] < known[best]:
                    break
                best = better
        yield best
        yield from sorted(rings, key=known.__getitem__)


def _moved(point, step, way):
    return tuple(round(a + step * b, 6) for a, b in zip(point, way))


def has_width(problem):
    return any(map(any, problem.parts))


def at_corner(problem, signs):
    """The problem at a corner of its parameters."""
    return replace(problem, map=SymplecticMap(
        problem.waves, [term.at(signs) for term in problem.terms]), axes=problem.frame, alone=None,
        comments=(), shifts=())


def reaches(cell, signs):
    """Does the cell reach that corner of the parameters?"""
    return all(cell[0][axis] == (0 if sign < 0 else (1 << cell[1][axis]) - 1)
               for sign, axis in zip(signs, tree.PARAMETERS))


def _score(grown, weight) -> Tuple[float, int]:
    """How many prisms resist, and how many there are, each counted `weight` times."""
    counts = grown.counts
    return (inf if grown.cells else weight * counts.undecided,
            weight * (counts.proved + counts.undecided + len(grown.cells)))


def _text(point):
    return tuple(decimal_text(x) for x in point)
