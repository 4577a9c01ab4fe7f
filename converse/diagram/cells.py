"""The search over cells: boxes of the parameters are tried, the largest first, and what is not
proved is halved."""

from dataclasses import replace
from fractions import Fraction
from typing import Callable, Optional, Tuple

from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..prover import native
from ..prover.proof import Proof, Tree
from ..prover.run import prove, ready
from ..prover.settings import Settings
from .value import Box, Diagram

CELL_POINTS = 1 << 15                   # A cell is given up after this number of points of orbits,
CELL_LEAVES = 1 << 14                   # or of prisms.
TRY_POINTS = 1 << 15                    # A try costs as much as these more: x* is chosen.
CELL = "cell "                          # The lines of Diagram.search begin with this.


def search(diagram: Diagram, filling, points: int, tell) -> None:
    """Adds proofs that there are no tori to a diagram.

    Cells are handed out in the order of a queue, and their results are taken in that order.  So
    what is proved does not depend on how many cells are tried at a time.

    Parameters
    ----------
    diagram
        The diagram; its `search` has the cells that are open, in the order of the queue.
    filling : prover.workers.Filling
        Its workers try the cells.
    points
        The search ends when the diagram has this number of points.
    tell
        tell(text) is called with a line about each proof.
    """
    queue, results = dict(enumerate(map(_box, diagram.search) if diagram.search else
                                    [diagram.ranges])), {}
    given = taken = 0

    def next_task():
        nonlocal given
        if diagram.points >= points or given not in queue:
            return None
        given += 1
        return given - 1, attempt, diagram.over(queue[given - 1])

    def take(key, result):
        nonlocal taken
        results[key] = result
        while results.get(taken) and diagram.points < points:
            used, proof = results.pop(taken)
            box = queue.pop(taken)
            taken += 1
            if proof is None:
                end = taken + len(queue)
                queue.update(zip((end, end + 1), halves(diagram, box)))
            else:
                member = diagram.add(proof)
            diagram.points += used
            diagram.search = list(map(_line, queue.values())) or [CELL]
            if proof is not None:
                tell(diagram.sentence(member))

    filling.work(next_task, take)


def attempt(family: SymplecticMap, stop: Callable[[], bool] = bool
            ) -> Optional[Tuple[int, Optional[Proof]]]:
    """Tries to prove that no map of a family has invariant tori: the cost, in points of orbits, and
    the proof or None.  None: stop() returned True.  A worker calls it."""
    before = ready(Proof((Tree(Problem.of(family)),), Settings(method="loewner")))
    grown = native.grow(native.Task(before.problem, before.settings, before.xstar), CELL_LEAVES,
                        CELL_POINTS, look=stop)
    if grown is None:
        return None
    used = TRY_POINTS + sum(grown.steps)
    if grown.cells or grown.counts.undecided:
        return used, None
    known = replace(before.with_tree(0, text=grown.text), counts=grown.counts)
    return used, prove(resume=known, jobs=1)


def halves(diagram: Diagram, box: Box) -> Tuple[Box, Box]:
    """The halves of a box, cut across the parameter that changes V'' most over it."""
    reach = [(high - low) * sum((abs(slope) * (k0 * k0 + k1 * k1) for (k0, k1, _), slope in zip(
        diagram.family.harmonics, slopes)), Fraction(0))
        for (low, high), slopes in zip(box, diagram.family.slopes)]
    axis = reach.index(max(reach))
    low, high = box[axis]
    middle = (low + high) / 2
    lower, upper = (box[:axis] + (ends,) + box[axis + 1:]
                    for ends in ((low, middle), (middle, high)))
    return lower, upper


def _line(box):
    return CELL + " ".join(str(x) for ends in box for x in ends)


def _box(line):
    ends = list(map(Fraction, line[len(CELL):].split()))
    return tuple(zip(ends[::2], ends[1::2]))
