"""The tree of a search as pieces, which threads of this process or the workers of an executor grow.

The verdict on a prism depends on the prism and on the hint from its parent, which goes with it.  So
the tree, its statistics and the theorem are the same however the work is divided."""

import re
import time
from dataclasses import replace
from itertools import islice

from . import native, tree
from .native import Counts, Grown

TASK_SECONDS = 1.0                  # A task takes this time at most, and
TASK_RATIO = 10                     # ten times as long as each worker's setting up.
PIECE = re.compile(r"[^?]+\?*|\?+")     # nodes, and the untried prisms that follow them


def settled(pieces, stubborn):
    """Parts that follow each other, as Grown; those at the beginning of which nothing is left to do
    are one.  Prisms beyond an undecided one that ends the search do not count."""
    first, rest = Grown(), []
    for piece in pieces:
        end = -1 if stubborn else piece.text.find("U")
        if end >= 0:
            piece = replace(piece, text=piece.text[:end + 1], cells=[])
        if first.cells or rest:
            rest.append(piece)
        else:
            first = first.followed_by(piece)
        if end >= 0:
            break
    return [first, *rest]


def take_up(search, depth, text, hints):
    """Lets a search take up a tree.  WrongTree: no such search can have grown it.

    hints: of the first untried prisms, in their order; the others have 0."""
    cells, hints = [], iter(hints)
    most = [native.lib.CV_INDEX_BITS * search.has_axis(axis) for axis in range(len(tree.CUTS))]
    text += tree.UNTRIED * (tree.untried(text) - text.count(tree.UNTRIED))
    try:
        for kind, (index, cuts) in tree.Walk().feed(text):
            if sum(cuts) > depth or any(map(int.__gt__, cuts, most)) or kind == "S" and not (
                    search.skips and index[1] << cuts[0] >= index[0] + 1 << cuts[1]):
                raise native.WrongTree()
            if kind == tree.UNTRIED:
                cells.append((index, cuts, next(hints, 0)))
    except tree.TreeError:
        raise native.WrongTree() from None
    search.restart(text, cells)


class Shared:
    """A tree whose pieces are given to the workers of an executor.  The list of pieces is replaced
    and never changed, so that it is whole whenever an exception comes."""

    def __init__(self, task, grown, pool):
        """grown: what is known of the tree."""
        self.task, self.pool, cells = task, pool, iter(grown.cells)
        self.needs_long = False         # may a prism need longer orbits than the task allows?
        text = grown.text + tree.UNTRIED * (len(grown.cells) - grown.text.count(tree.UNTRIED))
        self.known = [Grown(counts=grown.counts), *(
            Grown(piece.rstrip(tree.UNTRIED), cells=list(islice(cells, piece.count(tree.UNTRIED))))
            for piece in PIECE.findall(text))]

    def view(self, whole=False):
        """As native.Search.view."""
        pieces = self.known = settled(self.known, self.task.settings.stubborn)
        cells = [cell for piece in pieces for cell in piece.cells]
        left = sum(0.5 ** sum(cuts) for _, cuts, _ in cells)    # of the volume
        text = "".join([piece.text + tree.UNTRIED * len(piece.cells) for piece in pieces
                        if whole]).rstrip(tree.UNTRIED)
        return Grown(text, counts=sum((piece.counts for piece in pieces), Counts()), cells=cells,
                     settled=pieces[0].counts, examined=1.0 - left, finished=not cells,
                     needs_long=self.needs_long)

    def work(self, _, look):
        """Lets the workers decide prisms, until look() returns True."""
        self.pool.work(self._next_task, self._take, look)

    def _next_task(self):
        """The first cells on which nobody works.  The pieces that wait are divided before, until
        there are as many as tasks are wanted, if possible: the last cell of a piece is the largest,
        since it was cut least."""
        busy = {id(cells) for cells in self.pool.running.values()}
        waiting = [piece for piece in self.known if piece.cells and id(piece.cells) not in busy]
        while waiting and len(waiting) < self.pool.size - len(busy):
            piece = max(waiting, key=lambda piece: len(piece.cells))
            if len(piece.cells) == 1:
                break
            halves = replace(piece, cells=piece.cells[:-1]), Grown(cells=piece.cells[-1:])
            self._replace(piece.cells, halves)
            at = waiting.index(piece)
            waiting[at:at + 1] = halves
        return (waiting[0].cells, grow, self.task, waiting[0].cells, TASK_SECONDS,
                TASK_RATIO) if waiting else None

    def _take(self, cells, grown):
        for piece in self.known:
            if piece.cells is cells:    # else an undecided prism before it ended the search
                self.needs_long |= grown.needs_long
                self._replace(cells, [piece.followed_by(grown)])
                break

    def _replace(self, cells, pieces):
        """Puts pieces in the place of the one with these cells."""
        at = [id(piece.cells) for piece in self.known].index(id(cells))
        self.known = [*self.known[:at], *pieces, *self.known[at + 1:]]


def grow(task, cells, seconds, ratio):
    """The trees of cells after some seconds.  A worker calls it."""
    began, search = time.monotonic(), native.Search(task)
    search.work(0, bool)
    now = time.monotonic()
    end = now + max(seconds, ratio * (now - began))
    return search.grow(cells, look=lambda: time.monotonic() >= end)
