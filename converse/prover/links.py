"""Links between starting points: what an invariant graph does at one point says what it does at
another (docs/proofs/argument.md, section 10).

Let f be the map of an invariant graph, f(x*) = F v and f(x) = F v'.  Then v' - v lies in a small
box that depends on x* and x alone.  So where v' must lie in a region that is excluded over
x, v is excluded over x*.  All of this is exact arithmetic on rationals; nothing of it is floating.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Callable, Dict, List, Optional, Sequence, Tuple

from ..model.exact import Ends, pi_bounds, root_bounds, sine_bounds
from ..model.problem import Problem, Shifts, inverse
from ..model.region import with_image
from . import tree
from .proof import Tree

PIECES = 8                              # The segment is cut into pieces, each with one bound K.
DIGITS = 30                             # Irrational numbers are known to 30 decimals.
COARSE = 10 ** 12                       # Bounds are rounded to multiples of 1/COARSE.
SPARE = Fraction(1, 10 ** 6)            # A link leaves this width to checkers with looser bounds.
PI = pi_bounds(DIGITS)
LEAST_GAP, MOST_CLUSTERS = Fraction(1, 256), 8      # as a part of a region's sides

Box = Tuple[Ends, ...]                  # the ranges of v0, v1, ..., in units of pi
Point = Tuple[str, ...]
Cell = Tuple[Tuple[int, ...], Tuple[int, ...]]      # as in tree.Walk


def _up(x):
    return Fraction(-(-x * COARSE // 1), COARSE)


def _root(x):
    """A bound of the root of x >= 0."""
    return root_bounds(x, 12)[1]


def _most(low, high, y, reach):
    """A bound of -p sin over p in [low, high] and the angles y - reach .. y + reach, y in units of
    pi:  sin(y + t) is sin y cos t + cos y sin t, which is near sin y."""
    bottom, top = sine_bounds(y, DIGITS)
    slope = max(map(abs, sine_bounds(y + Fraction(1, 2), DIGITS)))
    off = reach * slope + reach ** 2 / 2
    ends = max(bottom - off, Fraction(-1)), min(top + off, Fraction(1))
    return _up(max(-p * s for p in (low, high) for s in ends))


def least_slope(largest: Fraction) -> Fraction:
    """l with l + 1/l >= `largest`, at or above which no eigenvalue of beta is (Lemma 4)."""
    if largest < 2:
        raise ValueError("the largest eigenvalue of beta makes no sense: %s" % largest)
    return 2 / (largest + _root(largest ** 2 - 4))  # rounded down, as the root is rounded up


# ---- the lemma

@dataclass(frozen=True)
class Link:
    """From the point here to the point there, both exact and in radians: v' - v lies in this box,
    in units of pi, for every invariant graph of any parameters of the problem."""

    box: Box

    @classmethod
    def between(cls, problem: Problem, largest: Fraction, here: Point,
                there: Point) -> "Link":
        """Lemma 10 along the segment in pieces; of a point and itself nothing but 0.  largest: a
        bound of B, of all parameters of the problem."""
        start, end = ([Fraction(x) for x in point] for point in (here, there))
        step = [(b - a) / PIECES for a, b in zip(start, end)]
        l, rows, n = least_slope(largest), inverse(problem.frame), problem.size
        if start == end:                # roots are rounded up
            return cls(((Fraction(0), Fraction(0)),) * n)
        middle, radius = [Fraction(0)] * n, [Fraction(0)] * n
        for piece in range(PIECES):
            centre = [a + d * (piece + Fraction(1, 2)) for a, d in zip(start, step)]
            d = _spread(problem, l, centre, [abs(x) / 2 for x in step])
            moved = _applied(d, step)
            width = _dot(step, moved)
            for i, u in enumerate(rows):
                middle[i] += l * _dot(u, step) + _dot(u, moved) / 2
                radius[i] += _root(max(Fraction(0), _dot(u, _applied(d, u)) * width)) / 2
        return cls(tuple(_over_pi(m - r, m + r) for m, r in zip(middle, radius)))

    def image(self, box: Box) -> Box:
        """Where v' lies if v lies in the box."""
        return tuple((low + a, high + b) for (low, high), (a, b) in zip(box, self.box))

    def leads_into(self, box: Box, region: Box) -> bool:
        """Does v' lie in the region if v lies in the box, with something to spare?  Where the
        region moves, the box is that of v as seen from it: tree.prisms, `still`."""
        return all(a <= low - SPARE and high + SPARE <= b
                   for (low, high), (a, b) in zip(self.image(box), region))


def corners(problem: Problem) -> List[Tuple[int, ...]]:
    """The corners of the parameters, each with -1 or 1 for a parameter."""
    return list(product((-1, 1), repeat=len(problem.parts)))


def crests(problem: Problem) -> List[Fraction]:
    """Bounds of the largest eigenvalue of beta, with every wave at its largest, at the corners.

    Of n eigenvalues with the mean m and the sum s of the squares of their distances from m, none is
    more than m + root of (n - 1) s/n."""
    found, n = [], problem.size
    for signs in corners(problem):
        d = _scalar(n, Fraction(2))
        for term in problem.terms:
            d = _with(d, abs(term.at(signs)), term.k)
        mean = sum(d[i][i] for i in range(n)) / n
        squares = sum(x * x for row in d for x in row) - n * mean ** 2
        found.append(_up(mean + _root(squares * (n - 1) / n)))
    return found


def _spread(problem, l, centre, reach):
    """D = K - l, K >= beta(x) - l for all parameters and all x = centre - reach .. centre +
    reach.  Each wave is taken where it is largest."""
    d = _scalar(problem.size, 2 - 2 * l)
    for term in problem.terms:
        y = _dot(term.k, centre) / PI[0]
        off = 4 * abs(y) * (PI[1] - PI[0])          # as PI[0] is not pi
        d = _with(d, _most(term.p - term.half, term.p + term.half, y + term.phase,
                           _dot(map(abs, term.k), reach) + off), term.k)
    return d


def _with(d, size, k):
    """d with size times k k' added."""
    return [[x + size * a * b for x, b in zip(row, k)] for row, a in zip(d, k)]


def _scalar(n, x):
    return [[x * (i == j) for j in range(n)] for i in range(n)]


def _applied(d, x):
    return [_dot(row, x) for row in d]


def _dot(x, y):
    return sum(a * b for a, b in zip(x, y))


def _over_pi(low, high):
    """An enclosure of low/pi .. high/pi with few digits."""
    low, high = low / PI[low > 0], high / PI[high < 0]
    return -_up(-low), _up(high)


# ---- what one starting point leaves to others

@dataclass(frozen=True)
class Target:
    """A part that cells may be linked to."""

    letter: str
    link: Link
    region: Box                         # in the middle of the parameters, with its mirror image
    shifts: Shifts = ()

    def takes(self, problem: Problem) -> Callable[[Cell], bool]:
        """A function that tells whether the cells of a problem may be linked to it."""
        box = _boxes(problem, self.shifts)
        return lambda cell: self.link.leads_into(box(cell), self.region)


def clusters(problem: Problem, text: str) -> List[List[Cell]]:
    """The undecided cells of the tree, those that are near each other in one cluster; at most
    MOST_CLUSTERS, and fewer cells are near each other then.  [] if that is not to be had."""
    cells = [cell for kind, cell in tree.cells(text) if kind == "U"]
    whole = [not any(cuts[axis] for _, cuts in cells) for axis in tree.ANGLES]
    gap = LEAST_GAP
    while gap < 1:                      # An axis that is not cut is one box long.
        found = _joined(cells, [Fraction(1) if uncut else 2 * h / gap for uncut, h in zip(
            whole, problem.half[-problem.size:])])
        if len(found) <= MOST_CLUSTERS:
            return found
        gap *= 2
    return []


def _joined(cells: Sequence[Cell], sizes: Sequence[Fraction]) -> List[List[Cell]]:
    """The cells in clusters.  A grid of boxes covers the region; cells in one box or in two
    boxes that touch belong together.  sizes: how many boxes a side of the region has."""
    squares: Dict[Tuple[int, ...], List[Cell]] = {}
    for cell in cells:
        ranges = [range(int(size * index / (1 << cuts)), int(size * (index + 1) / (1 << cuts)) + 1)
                  for index, cuts, size in zip(*(map(each.__getitem__, tree.ANGLES)
                                                 for each in cell), sizes)]
        for square in product(*ranges):
            squares.setdefault(square, []).append(cell)
    found = []
    for first in sorted(squares):
        members: Dict[Cell, None] = {}
        near = [first]
        while near:
            place = near.pop()
            members.update(dict.fromkeys(squares.pop(place, ())))
            near += [square for square in product(*((i - 1, i, i + 1) for i in place))
                     if square in squares]
        if members:
            found.append(list(members))
    return found


def hull_of(problem: Problem, cells: Sequence[Cell], still: Shifts = ()) -> Box:
    """The box that holds the cells for all their parameters; still: as seen from what moves
    by such shifts."""
    return tuple((min(low for low, _ in ends), max(high for _, high in ends))
                 for ends in zip(*map(_boxes(problem, still), cells)))


def _boxes(problem, still):
    """A function from cells to boxes, seen from what moves by the shifts `still`."""
    prism = tree.prisms(problem, still)

    def box(cell):
        return tuple((c - h, c + h) for c, h in zip(*prism(cell)))

    return box


def region_around(box: Box, link: Link) -> Box:
    """A region that the cells of the box are linked into, its ends with few digits."""
    def around(low: Fraction, high: Fraction) -> Ends:
        spare, places = (high - low) / 32 + 2 * SPARE, 10 ** 5
        return (Fraction((low - spare) * places // 1, places),
                Fraction(-((-high - spare) * places // 1), places))

    return tuple(around(*ends) for ends in link.image(box))


def wrong_letter(problem: Problem, largest: Fraction, xstar: Point, text: str,
                 parts: Sequence[Tree]) -> Optional[str]:
    """The letter of the first leaf of a tree over xstar that is linked to a part and may lead out
    of its region.  None: there is none.  largest: B; parts: a, b, ... of the proof."""
    takes = {}
    for letter, part in zip(tree.LETTERS, parts):
        if letter in text:
            assert part.xstar is not None
            takes[letter] = Target(letter, Link.between(problem, largest, xstar, part.xstar),
                                   with_image(part.problem, part.xstar),
                                   part.problem.shifts).takes(problem)
    return next((kind for kind, cell in tree.cells(text if takes else "")
                 if kind in takes and not takes[kind](cell)), None)


def linked_tree(problem: Problem, text: str, targets: List[Target]) -> str:
    """The tree with links.  A node above undecided cells becomes a letter if its whole box is
    linked to that part; nodes near the root are tried first.  Cells that cannot be linked stay
    undecided."""
    size = len(text)
    end, open_ = [0] * size, [False] * size     # of each node: where the next begins; anything U
    for i in range(size - 1, -1, -1):
        if text[i] in tree.CUTS:
            other = end[i + 1]
            end[i], open_[i] = end[other], open_[i + 1] or open_[other]
        else:
            end[i], open_[i] = i + 1, text[i] == "U"
    nodes = []
    letters = [(target.letter, target.takes(problem)) for target in targets]
    walk, i = tree.Walk(), 0
    while i < size:
        cell, node = walk.pending[-1], text[i]
        if open_[i]:
            node = next((letter for letter, takes in letters if takes(cell)), node)
        for _ in walk.feed(node):
            pass
        nodes.append(node)
        i = i + 1 if node == text[i] else end[i]
    return "".join(nodes)
