"""The tree of a search as pieces, which threads of this process or the workers of an executor grow.

The verdict on a prism depends on the prism and on the hint from its parent, which goes with it.  So
the tree, its statistics and the theorem are the same however the work is divided."""

import re
import time
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

from . import native, tree
from .native import Counts, Grown

TASK_SECONDS = 1.0                  # A task takes this time at most, and
TASK_RATIO = 10                     # ten times as long as each worker's setting up.
PIECE = re.compile(r"[^?]+\?*|\?+")     # nodes, and the untried prisms that follow them


class View(NamedTuple):
    """What is known of a tree that is grown.

    counts: the statistics, in which nodes that were taken up do not count.
    settled: the same up to the first prism on which somebody works: what depends on it does not
    depend on the workers.
    examined, finished, needs_long: as of Grown."""

    counts: Counts
    settled: Counts
    examined: float
    finished: bool
    needs_long: bool


def volume(cells):
    """The share of parameters and angles that lies in cells."""
    return sum(0.5 ** sum(cuts) for _, cuts, _ in cells)


def settled(pieces, stubborn):
    """Parts that follow each other, as Grown; those at the beginning of which nothing is left to do
    are one.  What lies beyond an undecided prism that ends the search does not count."""
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


def taken_up(search, depth, text, hints):
    """A tree as pieces.  WrongTree: no such search can have grown it.

    hints: of the first untried prisms, in their order; the others have 0."""
    pieces, walk, hints = [], tree.Walk(), iter(hints)
    most = [native.lib.CV_INDEX_BITS * search.has_axis(axis) for axis in range(len(tree.CUTS))]
    missing = tree.untried(text) - text.count(tree.UNTRIED)
    try:
        for chunk in PIECE.findall(text + tree.UNTRIED * missing):
            cells = []
            for kind, (index, cuts) in walk.feed(chunk):
                if sum(cuts) > depth or any(map(int.__gt__, cuts, most)) or kind == "S" and not (
                        search.skips and index[1] << cuts[0] >= index[0] + 1 << cuts[1]):
                    raise native.WrongTree()
                if kind == tree.UNTRIED:
                    cells.append((index, cuts, next(hints, 0)))
            pieces.append(Grown(chunk.rstrip(tree.UNTRIED), cells=cells))
    except tree.TreeError:
        raise native.WrongTree() from None
    return pieces


class Growth:
    """A tree that was begun and that threads of this process grow: it takes over a search."""

    def __init__(self, search, settings, text, hints):
        self.search, self.stubborn = search, settings.stubborn
        self.begun = settled(taken_up(search, settings.depth, text, hints), self.stubborn)
        self.cells = [cell for piece in self.begun for cell in piece.cells]
        search.restart(self.cells)

    def work(self, *limits):
        """As native.Search.work."""
        return self.search.work(*limits)

    def view(self):
        """The View of the tree as it is."""
        grown = self.search.view()
        return View(grown.counts, grown.counts, 1.0 - volume(self.cells) + grown.examined,
                    grown.finished or not self.cells, grown.needs_long)

    def pieces(self):
        """The tree as it is: pieces that follow each other, the first of which is all that is
        settled, and the cells after it."""
        grown, pieces, at = self.search.view(True), [], 0
        cells = iter(grown.cells)
        for piece in self.begun:
            begin, left = at, len(piece.cells)      # to be decided
            if piece is self.begun[-1]:
                at, left = len(grown.text), len(grown.cells)
            while left and at < len(grown.text):
                left += 1 if grown.text[at] in tree.CUTS else -1
                at += 1
            pieces.append(piece.followed_by(Grown(
                grown.text[begin:at], cells=list(islice(cells, left)))))
        pieces[0] = replace(pieces[0], counts=grown.counts)
        return settled(pieces, self.stubborn)


class Shared:
    """A tree whose pieces are given to the workers of an executor.  The list of pieces is replaced
    and never changed, so that it is whole whenever an exception comes."""

    def __init__(self, task, pieces, pool):
        self.task, self.pool = task, pool
        self.needs_long = False         # may a prism need longer orbits than the task allows?
        self.known = pieces

    def pieces(self):
        """As Growth.pieces."""
        self.known = settled(self.known, self.task.settings.stubborn)
        return self.known

    def view(self):
        """As Growth.view."""
        pieces = self.pieces()
        cells = [cell for piece in pieces for cell in piece.cells]
        return View(sum((piece.counts for piece in pieces), Counts()), pieces[0].counts,
                    1.0 - volume(cells), not cells, self.needs_long)

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
    """What cells become in some seconds.  A worker calls it."""
    began, search = time.monotonic(), native.Search(task)
    search.work(0, bool)
    now = time.monotonic()
    end = now + max(seconds, ratio * (now - began))
    return search.grow(cells, look=lambda: time.monotonic() >= end)
