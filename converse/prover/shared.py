"""A tree that the workers of an executor grow.

The verdict on a prism depends on the prism and on the hint from its parent, which goes with it.  So
the tree, its statistics and the theorem are the same however the work is divided."""

import re
import time
from dataclasses import dataclass, field
from itertools import islice
from typing import List

from . import native, tree
from .native import Counts, View

TASK_SECONDS = 1.0                  # A task takes this time at most, and
TASK_RATIO = 10                     # ten times as long as each worker's setting up.
PIECE = re.compile(r"[^?]+\?*|\?+")     # nodes, and the untried prisms that follow them


@dataclass(frozen=True, eq=False)
class Part:
    """A part of the tree: nodes, the lengths of their orbits, if wanted, and their statistics; or
    cells, in preorder, that are to be decided.  It never changes, so that Shared.parts is whole
    whenever an exception comes."""

    text: str = ""
    steps: List[int] = field(default_factory=list)
    counts: Counts = Counts()
    cells: List[tuple] = field(default_factory=list)

    def followed_by(self, other):
        return Part(self.text + other.text, self.steps + other.steps, self.counts + other.counts)


class Shared:
    """The tree of a search, taken over from this process: its parts in preorder, some of them being
    worked on.  It has the methods of native.Search that a run needs."""

    def __init__(self, task, search, pool, seconds, want_steps):
        """seconds: of the setting up."""
        self.task, self.pool, self.want_steps = task, pool, want_steps
        self.seconds = max(TASK_SECONDS, TASK_RATIO * seconds)
        self.needs_long = False         # may a prism need longer orbits than the task allows?
        view, cells, self.parts = search.view(0), iter(search.cells()), []
        for piece in PIECE.finditer(view.text):
            text = piece[0].rstrip(tree.UNTRIED)
            steps = view.steps[piece.start():piece.start() + len(text)] if want_steps else []
            counts = Counts() if self.parts else view.counts
            self.parts += [Part(text, steps, counts),
                           Part(cells=list(islice(cells, len(piece[0]) - len(text))))]

    def _ends(self, part):
        """Does the search end with this part, at an undecided prism?"""
        return "U" in part.text and not self.task.settings.stubborn

    def view(self, start=None):
        """As native.Search.view; steps: of the nodes before the first untried prism, if wanted."""
        settled, *parts = self.parts
        while parts and not parts[0].cells and not self._ends(settled):
            settled = settled.followed_by(parts.pop(0))
        end = next((n for n, part in enumerate((settled, *parts)) if self._ends(part)), len(parts))
        self.parts = [settled, *parts[:end]]
        cells = [cell for part in self.parts for cell in part.cells]
        text, steps = "", []
        if start is not None:
            text = "".join(part.text + tree.UNTRIED * len(part.cells) for part in self.parts)
            text, steps = text[start:], settled.steps[start:]
        return View(text, steps, [hint for _, _, hint in cells],
                    sum((part.counts for part in self.parts[1:]), settled.counts), settled.counts,
                    1.0 - sum(0.5 ** sum(cuts) for _, cuts, _ in cells), not cells,
                    self.needs_long)

    def work(self, _, look):
        """Lets the workers decide prisms, until look() returns True."""
        self.pool.work(self._next_task, self._take, look)

    def _next_task(self):
        """The first part that nobody works on.  The parts that wait are divided before, until there
        are as many as tasks are wanted, if possible: the last cell of a part is the largest, since
        it was cut least."""
        busy = {id(task.key) for task in self.pool.running.values()}
        waiting = [part for part in self.parts if part.cells and id(part) not in busy]
        while waiting and len(waiting) < self.pool.size - len(busy):
            part = max(waiting, key=lambda part: len(part.cells))
            if len(part.cells) == 1:
                break
            halves = Part(cells=part.cells[:-1]), Part(cells=part.cells[-1:])
            self._replace(part, halves)
            at = waiting.index(part)
            waiting[at:at + 1] = halves
        return (waiting[0], grow, self.task, waiting[0].cells, self.seconds, self.want_steps) \
            if waiting else None

    def _take(self, part, grown):
        parts, needs_long = grown
        if part in self.parts:          # else an undecided prism before it ended the search
            self._replace(part, parts)
            self.needs_long |= needs_long

    def _replace(self, part, parts):
        at = self.parts.index(part)
        self.parts = [*self.parts[:at], *parts, *self.parts[at + 1:]]


def grow(task, cells, seconds, want_steps):
    """The Parts that cells become in some seconds, and whether the first prism that is not decided
    may need a longer orbit than the task allows.  A worker calls it."""
    search = native.Search(task)
    search.work(0, bool)
    end = time.monotonic() + seconds
    grown = search.grow(cells, look=lambda: time.monotonic() >= end)
    nodes = Part(grown.text, grown.steps if want_steps else [], grown.counts)
    return ([nodes, Part(cells=grown.cells)] if grown.cells else [nodes]), grown.needs_long
