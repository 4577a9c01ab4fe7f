"""The search for a map: cells are tried, cut, and tried again."""

import concurrent.futures
import heapq
import itertools
import math
from fractions import Fraction
from typing import Callable, Optional

from ..model.exact import Number, decimal_text, exact
from ..model.map import THESIS, SymplecticMap
from ..model.problem import IDENTITY, Problem
from ..model.region import DIAGONALS, exchangeable, reduced
from ..prover import native
from ..prover.settings import Settings
from ..prover.workers import LOOK_SECONDS, Filling, WorkerPool, check_options
from ..storage.backup import Backup
from ..storage.files import ConverseError, Path
from ..storage.signals import interruptible
from ..version import __version__
from . import region
from .map import AT_ONCE, OPEN, PROVED, ParameterMap
from .region import REGIONS

SETTINGS = Settings(method="loewner")

# The budget of a cell is the number of leaves that its proof may have.
FIRST_BUDGET, LARGEST_BUDGET = 1 << 15, 1 << 21
BUDGET_FACTOR = 4                   # from one try at a cell to the next
COARSE_BUDGET = 1 << 9              # leaves of a proof in the first bisection of the estimate
TRIAL_BUDGET = 1 << 12             # where one x* is compared with others
POINT_BUDGET = 1 << 14              # in the second one, which is the estimate

WIDEST = 0.25                       # width of the first cells as a part of their radius
GRAIN = 6                           # least width of a cell that is cut, as a part of down_to - 1
FINER = 8                           # less by this factor where the largest budget was not enough

SHEARED = (1, 0, -1, 1)             # a frame in which the wave a feels v0 alone, and c v1 alone;
WEAK = 5                            # in the identity b does the latter: for c less by this factor
ASIDE = Fraction(3, 10)             # shift of x* along the direction that the wave c lacks
RIGHT_ANGLES = ("1.570796", "1.570796")     # x* where the waves a and b have their maxima
TOO_LONG = native.lib.CV_REASON_TOO_LONG    # of a failed try: more cuts will not help


# ---- what a worker does, on plain data

def _problem(amplitude, parts=()):
    return Problem(SymplecticMap(THESIS, amplitude, parts))


def _prove_within(problem, xstar, budget, stop):
    """Returns (tree, leaves, Begun) of a proof with about `budget` leaves at most, None if stopped.

    Where the budget does not suffice the tree is None, and leaves is the number to expect if the
    rest of the volume costs as much as the part that was decided; or infinite, if no budget helps.
    """
    begun = native.begin(native.Task(problem, SETTINGS, xstar), "", stop)
    if begun is None:
        return None
    task, cells = native.Task(problem, SETTINGS, begun.xstar), begun.cells
    pieces, leaves = [], 0
    while cells and not begun.at_once:
        grown = native.grow(task, cells, LOOK_SECONDS, budget - leaves, False, stop)
        if grown is None or stop.is_set():
            return None
        pieces.append(grown.text)
        leaves += grown.counts.proved + grown.counts.symmetric
        cells = grown.cells
        if grown.counts.undecided or cells and grown.counts.reasons[TOO_LONG]:
            return None, math.inf, begun
        if cells and leaves >= budget:
            decided = 1 - sum(2.0 ** -sum(cuts) for _, cuts, _ in cells)
            return None, leaves / decided, begun
    return "".join(pieces), leaves, begun


def _way(directions, cell, stop):
    """The frame and x* for a cell: of those that promise most, the pair that costs least for its
    middle; None if stopped.  A frame that is None is chosen."""
    r, s = cell.middle
    a, b, c = point = tuple(r * d for d in region.direction(directions, s))
    problem = _problem(point)
    xstar = native.chosen_start(native.Task(problem, SETTINGS))
    if problem.is_flat:
        return None, xstar
    frame = DIAGONALS if exchangeable(problem, xstar) else \
        IDENTITY if WEAK * c < min(a, b) else SHEARED
    ways = [(frame, xstar)]
    if 10 * c < min(a, b):                      # nearly two separate standard maps
        ways.append((IDENTITY, RIGHT_ANGLES))
    if c > 10 * max(a, b) and frame != DIAGONALS:
        x0, x1 = map(Fraction, xstar)
        ways.append((frame, (decimal_text(x0 - ASIDE), decimal_text(x1 + ASIDE))))
    costs = {}
    for frame, xstar in ways if len(ways) > 1 else ():
        found = _prove_within(reduced(problem, xstar, frame), xstar, TRIAL_BUDGET, stop)
        if found is None:
            return None
        costs[frame, xstar] = found[1]
    return min(costs, key=costs.__getitem__, default=ways[0])


def attempt(directions, cell, budget, stop=None):
    """Tries to prove a cell with a limited number of leaves: its kind and, if it is proved, the
    proof as plain data; None if stopped."""
    stop = stop or native.Stop()
    middle, parts = region.patch(directions, cell)
    if cell.high[0] == region.RADIUS:           # it must hold for all larger radii, too
        begun = native.begin(native.Task(_problem(middle, parts), SETTINGS), "", stop)
        return begun and (AT_ONCE if begun.at_once else OPEN, None)
    way = _way(directions, cell, stop)
    if way is None:
        return None
    frame, xstar = way
    problem = reduced(_problem(middle, parts), xstar, frame)
    found = _prove_within(problem, xstar, budget, stop)
    if found is None:
        return None
    tree, leaves, begun = found
    if begun.at_once or tree is None:
        return AT_ONCE if begun.at_once else OPEN, None
    region_text = {name: [decimal_text((low + high) / 2), decimal_text((high - low) / 2)]
                   for name, (low, high) in (("v0", problem.v0), ("v1", problem.v1))}
    return PROVED, {"xstar": list(begun.xstar), "frame": list(problem.frame),
                    "alone": "no" if problem.factor is None else str(problem.factor),
                    **region_text, "tree": tree}


def estimate_frontier(directions, s, stop=None):
    """About the least radius at which a direction is proved with POINT_BUDGET leaves, by
    bisection: an estimate of where the method ends.  None if stopped."""
    stop = stop or native.Stop()

    def proved(radius, budget):
        cell = region.Cell(0, (radius, s), (radius, s))
        way = _way(directions, cell, stop)
        if way is None:
            return None
        frame, xstar = way
        point = region.patch(directions, cell)[0]
        found = _prove_within(reduced(_problem(point), xstar, frame), xstar, budget, stop)
        return found and (found[0] is not None or found[2].at_once)

    low, high = 0, region.RADIUS
    for budget, tolerance in ((COARSE_BUDGET, Fraction(1, 32)),
                              (POINT_BUDGET, Fraction(1, 256))):
        step = 8 * tolerance
        while True:                             # down to where it fails
            low = high * (1 - step)
            answer = proved(low, budget)
            if not answer or low < Fraction(1, 100):
                break
            high = low
        while answer is not None and high - low > tolerance * high:
            middle = (low + high) / 2
            answer = proved(middle, budget)
            low, high = (low, middle) if answer else (middle, high)
        if answer is None:
            return None
    return float(high)


# ---- the search

def explore(name: Optional[str] = None, down_to: Optional[Number] = None, *, path: Path,
            resume: bool = False, jobs: Optional[int] = None,
            executor: Optional[concurrent.futures.Executor] = None, time_limit: float = math.inf,
            progress: Optional[Callable[[float, ParameterMap], None]] = None) -> ParameterMap:
    """Proves for as many (a, b, c) of a region as possible that there are no invariant tori.

    Parameters
    ----------
    name
        The region: "b=0", "a=b" or "c=0".  With resume it may be left out.
    down_to
        How near to the estimated frontier to come, as a ratio from 1 to 100; by default 1.05.
    path
        The file that keeps the map: a new one or, with resume, the map to continue.
    resume
        Whether the map of the file is continued.
    jobs, executor
        The number of cells at a time, by default one per core; the executor that works on them, by
        default threads of this process.
    time_limit
        The search ends after about this number of seconds.
    progress
        progress(share, map) is called a few times a second, with the proved share of the area that
        is to be proved.

    Returns
    -------
    ParameterMap

    Raises
    ------
    TypeError, ValueError
        An argument is wrong.
    ConverseError, MemoryError
        The run ended; the cells that are proved are in the file.
    """
    check_options(jobs, executor, time_limit)
    ratio = None if down_to is None else exact(down_to)
    if ratio is not None and not 1 < ratio <= 100:
        raise ValueError("down_to is a ratio above 1, not %s" % (down_to,))
    if not resume and name not in REGIONS:
        raise ValueError("the region is one of %s, not %r" % (", ".join(REGIONS), name))
    with interruptible(), Backup(path, resumed=path if resume else None) as backup:
        if resume:
            region_map = ParameterMap.load(path)
            if name not in (None, region_map.region):
                raise ConverseError("%s: is of another region, %s; name another, or this region"
                                    % (path, region_map.region))
            if region_map.version != __version__:
                raise ConverseError("%s: is of another program, %s; start anew"
                                    % (path, region_map.version))
            region_map.down_to = ratio or region_map.down_to
        else:
            region_map = ParameterMap.new(str(name), ratio or Fraction(21, 20))
        search = _Search(region_map, progress)
        with Filling(region_map, backup, WorkerPool(executor, jobs, native.Stop()), time_limit,
                     search.look) as filling:
            search.estimate(filling)
            if region_map.estimated_all:
                search.explore(filling)
    return region_map


class _Search:
    """One run, which adds to a map."""

    def __init__(self, region_map, progress):
        self.map, self.progress = region_map, progress
        self.queue, self.order = [], itertools.count()
        self.decided, self.share = 0.0, 0.0    # area, and as a share of all

    def look(self):
        if self.progress:
            self.progress(self.share, self.map)

    def estimate(self, filling):
        """Estimates the frontier where it is not yet known."""
        def take(key, radius):
            face, s = key
            known[face][s] = radius

        known = self.map.estimate
        tasks = (((face, s), estimate_frontier, directions, s)
                 for face, directions in enumerate(self.map.directions)
                 for s in self.map.places() if s not in known[face])
        filling.work(lambda: next(tasks, None), take)

    def explore(self, filling):
        """Tries cells; first those that would add most area for the work."""
        def count():
            self.share = min(1.0, self.decided / total) if total else 1.0

        total = self.map.area()
        for leaf in list(self.map.leaves()):
            if leaf.kind == OPEN:
                self._push(leaf)
            else:
                self.decided += self.map.area(leaf.cell)
        count()

        def next_task():
            if not self.queue:
                return None
            node = heapq.heappop(self.queue)[-1]
            budget = BUDGET_FACTOR * node.tried or FIRST_BUDGET
            return (node, budget), attempt, self.map.directions[node.cell.face], node.cell, budget

        def take(key, outcome):
            self._take(*key, outcome)
            count()

        filling.work(next_task, take)

    def _widest(self, cell, axes=(0, 1)):
        """The axis along which a cell is widest in parameter space, and how wide; the directions d
        are of size 1."""
        return max((float((cell.high[k] - cell.low[k]) * (cell.high[0] if k else 1)), k)
                   for k in axes)

    def _push(self, node):
        """Queues an open cell, cut if it is too large; drops the parts that are not wanted."""
        cell = node.cell
        if not self.map.wanted(cell):
            return
        width, axis = self._widest(cell, [1])
        if width < WIDEST * cell.high[0]:       # one x* does not serve more directions
            low = self.map.target(cell)
            width, axis = self._widest(cell)
            if float(cell.low[0]) >= low or width <= self._grain(low):
                area = self.map.area(cell)
                heapq.heappush(self.queue, (-area / (node.tried or FIRST_BUDGET),
                                            next(self.order), node))
                return
        for half in node.cut(axis):
            self._push(half)

    def _grain(self, low):
        """The least width of cells that are cut."""
        return (float(self.map.down_to) - 1) * low / GRAIN

    def _take(self, node, budget, outcome):
        """Records the outcome of a try at a cell, and queues the parts that are still open."""
        cell = node.cell
        node.decide(*outcome)
        if node.kind != OPEN:
            self.decided += self.map.area(cell)
            return
        width, axis = self._widest(cell)
        low = self.map.target(cell)
        lower_half_counts = float(cell.middle[0]) > low
        if cell.high[0] == region.RADIUS or not lower_half_counts:
            axis = 0            # only an outer half reaches to infinity; or the lower is not wanted
        grain = self._grain(low) / (FINER if budget >= LARGEST_BUDGET else 1)
        if width > grain or not lower_half_counts:
            for half in node.cut(axis):
                self._push(half)
        elif budget < LARGEST_BUDGET:
            node.tried = budget
            self._push(node)
