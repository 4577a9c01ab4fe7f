"""The search for a tree, divided between threads of this process or workers anywhere.

The verdict on a prism depends on the prism and on the hint from its parent, which goes with it.  So
the tree, its counts and the theorem are the same however the work is divided.
"""

import contextlib
import time
from dataclasses import replace

from ..storage.signals import Resource
from . import native, tree
from .native import Counts
from .workers import WorkerPool

MANY = 2 ** 30                      # No task grows 2^30 leaves.
ALONE_SECONDS = 0.03                # One thread works for this time before the work is divided.
TASK_SECONDS = 0.25                 # A task takes at most this, and a tenth of the time so far.
OLD = -1                            # The orbit's length of a node of an earlier run.


class Part:
    """A part of the tree: its text so far, in pieces, and the cells that are to follow it, each
    (index, cuts, hint) as in native.Begun."""

    def __init__(self, cells, text=""):
        self.cells, self.pieces = list(cells), [text]
        self.steps = [OLD] * len(text)      # orbit lengths, by node of the text, if wanted
        self.kinds = tree.count(text)

    @property
    def stopped(self):
        """Is there an undecided prism?  Unless it is stubborn the search ends here."""
        return self.kinds[3] > 0

    def append(self, pieces, steps, kinds):
        self.pieces += pieces
        self.steps += steps
        self.kinds = tuple(map(int.__add__, self.kinds, kinds))


LINKED_AS_PROVED = dict.fromkeys(map(ord, tree.LETTERS), "P")   # the core knows of no links


class TreeSearch(Resource):
    """A search under way: the parts of its tree in preorder, some of them being worked on.

    The C core works in other threads or processes, so that this thread can watch the clock and
    Ctrl-C.  The threads of this process can be stopped in the middle of a prism."""

    def __init__(self, task, jobs, executor=None, want_steps=False):
        """executor: whose workers are used once the work is worth dividing, or None; jobs: parts at
        a time, or None."""
        self.task, self.executor = task, executor
        self.pool = WorkerPool(executor, jobs, native.Stop())
        self.want_steps, self.stubborn = want_steps, task.settings.stubborn
        self.parts, self.statistics = [], Counts()
        self.changes = 0                    # under way: see _change
        self.long = False                   # may a prism need longer orbits than the task allows?

    def acquire(self):
        self.pool.acquire()

    def release(self):
        self.pool.release()

    # ---- the beginning

    def begin(self, text, hints, counts, seconds_left):
        """Sets up the search and takes up a tree with its statistics, if there is one; returns what
        native.begin does, or None if seconds_left() fell to 0 before.

        hints: of the untried prisms, in their order."""
        began = time.monotonic()
        begun, = self.pool.results(
            seconds_left, [(native.begin, self.task, text.translate(LINKED_AS_PROVED))])
        if begun is None:
            return None
        self.task = replace(self.task, xstar=begun.xstar)
        # Each worker sets up its search anew, which takes as long as here.  So the search is not
        # divided before that time has passed.
        self.began = time.monotonic()
        self.alone_until = self.began + max(ALONE_SECONDS, 10 * (self.began - began))
        seen = begun.counts
        if (seen.cuts, seen.proved, seen.symmetric, seen.undecided) != (
                counts.cuts, counts.proved + counts.linked, counts.symmetric, counts.undecided):
            raise native.WrongTree()
        hints = iter(hints)
        cells = [(index, cuts, next(hints, 0)) for index, cuts, _ in begun.cells]
        *pieces, last = text.split(tree.UNTRIED)
        for piece, cell in zip(pieces, cells):
            self.parts += [Part([], piece), Part([cell])]
        self.parts += [Part([], last), Part(cells[len(pieces):])]
        self.statistics = replace(counts, most_cuts=begun.counts.most_cuts)
        return begun

    # ---- what there is

    def _relevant(self):
        """The parts; unless the search is stubborn, up to the first with an undecided prism."""
        for part in self.parts:
            yield part
            if part.stopped and not self.stubborn:
                return

    @property
    def counts(self):
        """The statistics.  Nodes are counted in the tree as it is.  Tries also count in parts that
        were dropped because an undecided prism before them ended the search."""
        kinds = map(sum, zip(*(part.kinds for part in self._relevant()), (0,) * len(tree.NODES)))
        return replace(self.statistics, **dict(zip(tree.NODES, kinds)))

    @property
    def finished(self):
        """Is every prism decided, or one undecided in a search that is not stubborn?"""
        return not any(part.cells for part in self._relevant()
                       if self.stubborn or not part.stopped)

    def text(self):
        """The tree so far, and the hints of the untried prisms in it.  AssertionError: an exception
        struck in the middle of a change, so that the tree is lost."""
        if self.changes:
            raise AssertionError("the tree is not whole")
        pieces, hints = [], []
        for part in self._relevant():
            pieces += part.pieces
            if self.stubborn or not part.stopped:
                pieces += [tree.UNTRIED * len(part.cells)]
                hints += [hint for _, _, hint in part.cells]
        text = "".join(pieces)
        self._check(text)
        return text.rstrip(tree.UNTRIED), hints

    def _check(self, text):
        """AssertionError if the text lacks a prism or has one too many, so that it is not saved."""
        missing, counts = tree.untried(text) - text.count(tree.UNTRIED), self.counts
        if (missing < 0 if counts.undecided and not self.stubborn else missing != 0) or (
                tree.count(text) != tuple(getattr(counts, name) for name in tree.NODES)):
            raise AssertionError("the tree is not whole")

    @contextlib.contextmanager
    def _change(self):
        """Around every change of the parts: one that an exception leaves half done must not be
        saved."""
        self.changes += 1
        yield
        self.changes -= 1

    def beginning(self, start):
        """The tree from node number `start` to its first gap: the text, and the length of each
        node's orbit, OLD for nodes of an earlier run.  Needs want_steps."""
        first = self.parts[0]
        first.pieces = ["".join(first.pieces)]
        return first.pieces[0][start:], first.steps[start:]

    @property
    def examined(self):
        """The share of parameters and angles that lies in prisms which are proved, skipped or given
        up; it never falls."""
        return 1.0 - sum(0.5 ** sum(cuts) for part in self.parts for _, cuts, _ in part.cells) \
            if self.parts else 0.0

    # ---- growing

    def _take(self, part, grown):
        """Adds to a part what was grown from its cells."""
        if grown is None:                   # stopped before it could begin
            return
        with self._change():
            part.append([grown.text], grown.steps, tree.count(grown.text))
            part.cells = grown.cells
            self.statistics += grown.counts
        self.long |= grown.long

    def _queue(self):
        """The parts that wait for a worker, in preorder."""
        busy = {id(task.key) for task in self.pool.running.values()}
        return [part for part in self._relevant() if part.cells and id(part) not in busy
                and (self.stubborn or not part.stopped)]

    def _divide(self, queue, wanted):
        """Divides the parts in the queue until there are as many as wanted, if possible."""
        while 0 < len(queue) < wanted:
            part = max(queue, key=lambda part: len(part.cells))
            if len(part.cells) == 1:
                break
            rest = Part(part.cells[-1:])        # the last cell is the largest: it was cut least
            at, place = self.parts.index(part), queue.index(part)
            with self._change():
                part.cells = part.cells[:-1]
                self.parts.insert(at + 1, rest)
            queue.insert(place + 1, rest)
        return queue

    def work(self, seconds):
        """Hands parts to workers and takes their results.  Returns after `seconds`, or when a
        result came back and no part waits."""
        end = time.monotonic() + seconds
        alone = self.alone_until - time.monotonic()
        here = alone > 0 or (self.executor is None and self.pool.size == 1)
        if here:
            workers, queue = 1, self._queue()
            seconds = min(seconds, alone) if alone > 0 else seconds
        else:
            workers = self.pool.size
            seconds = min(TASK_SECONDS, 0.1 * (time.monotonic() - self.began))
            queue = self._divide(self._queue(), workers - len(self.pool.running))
        queue.reverse()
        running = self.pool.running
        while True:
            while queue and len(running) < workers:
                part = queue.pop()
                self.pool.give(part, native.grow, self.task, part.cells, seconds, MANY,
                               self.want_steps, here=here)
            came = stopped = False
            for part, grown in self.pool.take(max(0.0, end - time.monotonic())):
                self._take(part, grown)
                came = True
                stopped = stopped or self.long or (part.stopped and not self.stubborn)
            if not (queue or running) or (came and not queue) or stopped or \
                    time.monotonic() >= end:
                break
        self._merge()

    def _merge(self):
        """Joins the text of parts to the part before them where that is finished."""
        parts = []
        with self._change():
            for part in self.parts:
                if parts and not parts[-1].cells and (self.stubborn or not parts[-1].stopped):
                    parts[-1].append(part.pieces, part.steps, part.kinds)
                    part.pieces, part.steps, part.kinds = [], [], tree.count("")
                    if not part.cells:
                        continue
                parts.append(part)
            self.parts = parts

    def settle(self):
        """Waits a little for the workers, takes what they bring, and ends the work."""
        for part, grown in self.pool.settle(4 * TASK_SECONDS + 1):
            self._take(part, grown)
        self._merge()
