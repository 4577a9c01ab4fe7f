"""The search along one parameter: what is tried next.

Rounds that look for tori (some.py) and rounds that exclude them (none.py) change off: the side that
has cost less is next.  A cell of the line that is not excluded is halved.  If its middle was
excluded, only x* has to change; if not, there may be a torus, and with each halving the tries may
cost twice the points.  Cells next to excluded ones come first.  The tasks of a round are chosen
before any of them is done, and their results are taken in order, as long as the points last.  So
what is found does not depend on how many are done at a time.
"""

import itertools
from fractions import Fraction
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from . import none, some
from .value import POINTS_A_SECOND, Diagram, Member

CELLS = 24                              # of the range, at first
FINEST = 1 << 14                        # A cell of this part of the range with a torus is left out.
ROUND, LEAST = 8, Fraction(1, 16)       # cells of a round, none of which is much less urgent
FIRST_POINTS = {1: 1 << 15, 2: 1 << 18}     # of the first try at a cell, by the number of angles
DOUBT = Fraction(1, 2)                  # of its weight, where the middle of a cell is not excluded
EDGE = {1: 32, 2: 256}                  # A neighbour of excluded values is more urgent by this.
Hint = Tuple[Fraction, Tuple[none.Point, ...]]  # a value, and the x* over which it is excluded
NEAREST = 8                             # x* of neighbours that are suggested for a cell


class Cell(NamedTuple):
    """A part of the line that is to be proved.

    Attributes
    ----------
    low, high
        The ends.
    points
        Of the next try at its middle.
    weight
        A factor of its width; 0 for the whole range, which is tried first.
    """

    low: Fraction
    high: Fraction
    points: int
    weight: Fraction

    @property
    def middle(self) -> Fraction:
        return (self.low + self.high) / 2

    def halves(self, doubtful: bool) -> "List[Cell]":
        """Its halves, and what is to be done for them."""
        points, weight = (2 * self.points, DOUBT * self.weight) if doubtful else (
            self.points, Fraction(1))
        return [Cell(low, high, points, weight) for low, high
                in ((self.low, self.middle), (self.middle, self.high))]


def search(diagram: Diagram, filling, points: int, tell) -> None:
    """Adds proofs to a diagram of one parameter.

    Parameters
    ----------
    diagram
        The diagram; its `search` has the cells and the x* that are known.
    filling : prover.workers.Filling
        Its workers do the tasks.
    points
        The search ends when the diagram has this number of points.
    tell
        tell(text) is called with a line about each proof, as soon as it is found.
    """
    line = _Line(diagram)
    while diagram.points < points and not filling.late:
        tasks, keys = line.round(points), itertools.count()
        calls = [line.call(task) for task in tasks]     # before any of them is done
        results, taken = {}, []         # type: Dict[int, Any], List[int]
        if not tasks:
            break

        def next_task():
            key, left = next(keys), points - diagram.points
            return (key, *calls[key](left)) if key < len(tasks) and left > 0 else None

        def record():
            key = len(taken)
            taken.append(key)
            return line.take(tasks[key], results.get(key), points - diagram.points)

        def take(key, outcome):
            results[key] = outcome
            while results.get(len(taken)):
                member = record()
                if member:
                    tell(diagram.sentence(member))

        try:
            filling.work(next_task, take)
        finally:                        # also of a round that is broken off
            while len(taken) < len(tasks):
                record()
            diagram.search = line.lines()


class _Line:
    """The state of the search: cells, x* that exclude a value, and the runs of tori."""

    def __init__(self, diagram):
        self.diagram = diagram
        self.first_points = FIRST_POINTS[diagram.family.dimension]
        self.grain = (diagram.ranges[0][1] - diagram.ranges[0][0]) / FINEST
        self.cells: List[Cell] = []
        self.hints: List[Hint] = []
        self.spent = [0, 0]             # points, by the cells and by the runs
        known: Dict[str, List[List[str]]] = {"cell": [], "hint": [], "spent": [], "run": []}
        for line in diagram.search:
            kind, *words = line.split()
            known.get(kind, known["run"]).append([kind, *words] if kind not in known else words)
        for low, high, points, weight in known["cell"]:
            self.cells.append(Cell(Fraction(low), Fraction(high), int(points), Fraction(weight)))
        size = max(2, diagram.family.dimension)
        self.hints = [(Fraction(value), tuple(zip(*[iter(words)] * size)))
                      for value, *words in known["hint"]]
        self.spent = [int(x) for words in known["spent"] for x in words] or [0, 0]
        self.tori = some.Runs(diagram, known["run"])
        if not diagram.search and diagram.open:
            self.cells = [Cell(diagram.open[0][0], diagram.open[-1][1], self.first_points,
                               Fraction(0))]

    def lines(self) -> List[str]:
        """The state, for the file."""
        return ["spent %d %d" % tuple(self.spent)] + [
            "cell %s %s %d %s" % cell for cell in self.cells] + [
            " ".join(["hint", str(value), *itertools.chain(*xstars)])
            for value, xstars in self.hints] + self.tori.lines()

    def round(self, points: float) -> List[Any]:
        """The tasks that are done next.  Tries at tori take at most half of the points of the
        search, and cells that meet runs of tori come last."""
        def tori():
            left = min(points / 2 - self.spent[1], points - self.diagram.points)
            return self.tori.round(left / POINTS_A_SECOND)

        first, second = (tori, self._cells) if self.spent[1] < self.spent[0] else (
            self._cells, tori)
        return first() or second() or self._cells(True)

    def call(self, task) -> Callable[[int], Tuple[Any, ...]]:
        """By the most points that a task may take, the function that does it, and its arguments."""
        if isinstance(task, some.Task):
            torus = some.attempt, self.diagram.over((task.ends,)), task
            return lambda most: torus
        family = self.diagram.over(((task.low, task.high),))
        cell = none.exclude, family, self._near(task), task.points
        return lambda most: (*cell, most)

    def take(self, task, outcome, most: int) -> Optional[Member]:
        """Records what became of a task, and returns what it adds to the diagram.  None: it was not
        done.  A task that took more points than `most` is to be done anew."""
        if outcome is not None:
            spent = min(outcome.points, most)
            self.diagram.points += spent
            self.spent[isinstance(task, some.Task)] += spent
            if outcome.points > most:
                outcome = None
        proof = outcome and (outcome.torus if isinstance(task, some.Task) else outcome.proof)
        member = self.diagram.add(proof) if proof else None
        if isinstance(task, some.Task):
            self.tori.take(task, outcome)
        elif outcome is None:
            self.cells.append(task)
        else:
            if outcome.xstars:
                self.hints.append((task.middle, outcome.xstars))
            if not outcome.proof:
                self.cells += task.halves(not outcome.xstars) if task.weight else \
                    self._divided(task)
        return member

    def _cells(self, all_of_them=False):
        """The cells that are tried next, the widest first, from the top down; one that touches a
        part without tori counts as if it were wider; those that meet a run only if all are wanted.
        First those with a proved torus are halved, until their parts have none."""
        ends = {end for each in self.diagram.none for end in each}
        edge = EDGE[self.diagram.family.dimension]
        runs = self.tori.hulls()

        def rank(cell):
            urgency = cell.weight * (edge if cell.low in ends or cell.high in ends else 1)
            return (cell.low - cell.high) * urgency, -cell.low

        tori = [(each.low, each.high) for each in self.diagram.tori]
        todo, free = list(self.cells), []       # type: List[Cell], List[Cell]
        for cell in todo:
            inside = [each for each in tori if each[0] <= cell.high and cell.low <= each[1]]
            if not inside:
                free.append(cell)
            elif cell.high - cell.low > self.grain and not any(
                    low <= cell.low and cell.high <= high for low, high in inside):
                todo += cell.halves(False)
        wanted = sorted((cell for cell in free if all_of_them or not any(
            low <= cell.high and cell.low <= high for low, high in runs)), key=rank)
        wanted = [cell for cell in wanted[:ROUND] if rank(cell)[0] <= LEAST * rank(wanted[0])[0]]
        self.cells = [cell for cell in free if cell not in wanted]
        return wanted

    def _divided(self, cell):
        """The parts of the whole range, with ends of few decimals."""
        ends = [cell.low, *(some.nice(cell.low + (cell.high - cell.low) * i / CELLS, self.grain)
                            for i in range(1, CELLS)), cell.high]
        return [Cell(*pair, self.first_points, Fraction(1)) for pair in zip(ends, ends[1:])]

    def _near(self, cell):
        """The x* over which the nearest values are excluded."""
        nearest = sorted(self.hints, key=lambda hint: abs(hint[0] - cell.middle))
        return list(dict.fromkeys(itertools.chain(*(xstars for _, xstars in nearest))))[:NEAREST]
