"""The tree while it grows: parts of it in threads here or in processes anywhere.

What becomes of a prism depends on itself and on what its parent learnt, which goes with it, so the
tree, its counts and the theorem are the same however the work is divided.
"""

import concurrent.futures
import contextlib
import os
import time

from . import core, tree
from .core import Counts
from .files import ConverseError

MANY = 2 ** 30                      # leaves
ALONE_SECONDS = 0.03                # before anyone else is asked
TASK_SECONDS = 0.25                 # that a worker grows its part before it reports, in the long run
ATTEMPTS = 4                        # at a part whose workers die
OLD = -1                            # in place of the orbit's length: not of this run


class Part:
    """A part of the tree: its text so far, in pieces, and the cells that are to follow it."""

    def __init__(self, cells, text=""):
        self.cells, self.pieces = list(cells), [text]
        self.steps = [OLD] * len(text)      # of each node of the text, if they are wanted
        self.stopped = "U" in text          # and a search that is not stubborn ends here


def count_workers(executor=None):
    """How many tasks keep the cores of this machine, or an executor, busy."""
    if executor is not None:
        return 2 * (getattr(executor, "num_workers", None)
                    or getattr(executor, "_max_workers", None) or 4)
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:              # not everywhere
        return os.cpu_count() or 1


class Growth:
    """The tree while it grows: its parts in preorder, some of them being worked on.

    The C core always works in other threads than this one, or elsewhere, so that this one can keep
    an eye on the clock and on Ctrl-C; and those here can be stopped in the middle of a prism."""

    def __init__(self, task, jobs, executor=None, want_steps=False):
        """executor: of somebody else, for the work that is worth dividing; jobs: parts at a time."""
        self.task, self.jobs, self.executor = task, jobs, executor
        self.want_steps, self.stubborn = want_steps, task.settings.stubborn
        self.parts, self.counts, self.history = [], Counts(), core.History()
        self.running = {}                   # future -> (part, attempts left)
        self.stop = core.stop_token()
        self.threads = concurrent.futures.ThreadPoolExecutor(jobs if executor is None else 1)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop[0] = 1
        self.threads.shutdown()

    # ---- the beginning

    def begin(self, text, hints, counts, wait):
        """Sets up the search and takes up a tree with its statistics, if there is one; returns what
        core.begin does, or None if wait(future) says that there is no time for it.

        hints: what is known of the untried prisms, in their order."""
        began = time.monotonic()
        future = self._start(self.threads, core.begin, self.task, text, self.stop)
        if not wait(future):
            self.stop[0] = 1
        begun = future.result()
        if begun is None:
            return None
        self.task = core.Task(self.task.problem, self.task.settings, begun.xstar)
        # Every worker makes a search of its own: that must pay.
        self.began = time.monotonic()
        self.alone_until = self.began + max(ALONE_SECONDS, 10 * (self.began - began))
        for name in "cuts", "proved", "symmetric", "undecided", "most_cuts":
            if getattr(begun.counts, name) != getattr(counts, name):
                raise ConverseError("the tree does not belong to a search of this kind")
        hints = iter(hints)
        cells = [(index, cuts, next(hints, 0)) for index, cuts, _ in begun.cells]
        *pieces, last = text.split(tree.UNTRIED)
        for piece, cell in zip(pieces, cells):
            self.parts += [Part([], piece), Part([cell])]
        self.parts += [Part([], last), Part(cells[len(pieces):])]
        self.counts = counts
        return begun

    # ---- what there is

    def _relevant(self):
        """The parts, up to the one that ends a search that is not stubborn."""
        for part in self.parts:
            yield part
            if part.stopped and not self.stubborn:
                return

    @property
    def finished(self):
        """Is everything decided that is to be decided?"""
        return not any(part.cells for part in self._relevant()
                       if self.stubborn or not part.stopped)

    def text(self):
        """The tree so far, and the hints of the untried prisms in it."""
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
        """AssertionError if the text lacks a prism or has one too many, as it might after an
        exception in the middle of a change: such a tree must never be saved."""
        cuts, proved, symmetric, undecided, untried = (
            sum(map(text.count, kinds)) for kinds in (tree.CUTS, "P", "S", "U", tree.UNTRIED))
        if undecided and not self.stubborn:
            return                          # it ends there, and can never become a theorem
        if proved + symmetric + undecided + untried != cuts + 1 or self.counts.cuts != cuts or (
                self.counts.proved, self.counts.symmetric) != (proved, symmetric):
            raise AssertionError("the tree is not whole")

    def beginning(self, start):
        """The tree up to its first gap, from node number start on: the text and the lengths of the
        orbits, OLD for what this run took up.  Needs want_steps."""
        first = self.parts[0]
        first.pieces = ["".join(first.pieces)]
        return first.pieces[0][start:], first.steps[start:]

    @property
    def done(self):
        """The share of the work that is behind us, as far as can be seen."""
        counts = self.counts
        nodes = counts.cuts + counts.proved + counts.symmetric + counts.undecided
        cells = [cell for part in self._relevant() for cell in part.cells]
        return nodes / (nodes + self.history.expected(cells)) if nodes or cells else 0.0

    # ---- growing

    def _take(self, part, grown):
        """Adds to a part what was grown from its cells."""
        part.pieces.append(grown.text)
        part.steps += grown.steps
        part.cells = grown.cells
        part.stopped = part.stopped or grown.counts.undecided > 0
        self.counts += grown.counts
        self.history.add(grown.history)

    def _queue(self):
        """The parts that wait for a worker, in preorder."""
        busy = {id(part) for part, _ in self.running.values()}
        return [part for part in self._relevant() if part.cells and id(part) not in busy
                and (self.stubborn or not part.stopped)]

    def _divide(self, queue, wanted):
        """Makes as many parts of those in the queue as are wanted, if it can."""
        while 0 < len(queue) < wanted:
            part = max(queue, key=lambda part: len(part.cells))
            if len(part.cells) == 1:
                break
            first, rest = Part(part.cells[:-1]), Part(part.cells[-1:])  # the last is the largest
            first.pieces, first.steps, first.stopped = part.pieces, part.steps, part.stopped
            at, place = self.parts.index(part), queue.index(part)
            self.parts = self.parts[:at] + [first, rest] + self.parts[at + 1:]
            queue[place:place + 1] = [first, rest]
        return queue

    def work(self, seconds):
        """Hands parts to workers and takes what comes back within so many seconds."""
        left = self.alone_until - time.monotonic()
        if left > 0 or (self.jobs == 1 and self.executor is None):
            for part in self._queue()[:1 - len(self.running)]:
                self._submit(part, ATTEMPTS, self.threads, min(seconds, left if left > 0 else seconds))
        else:
            idle = self.jobs - len(self.running)
            for part in self._divide(self._queue(), idle)[:idle]:
                self._submit(part, ATTEMPTS, self.executor or self.threads,
                             min(TASK_SECONDS, 0.1 * (time.monotonic() - self.began)))
        done, _ = concurrent.futures.wait(self.running, seconds,
                                          concurrent.futures.FIRST_COMPLETED)
        for future in done:
            part, attempts = self.running.pop(future)
            try:
                self._take(part, future.result())
            except (ConverseError, MemoryError):
                raise
            except Exception as error:      # a worker died: its part is as it was
                if attempts == 1:
                    raise ConverseError("the workers keep failing (%s: %s)"
                                        % (type(error).__name__, error)) from None
                self._submit(part, attempts - 1, self.executor or self.threads, TASK_SECONDS)
        self._merge()

    def _submit(self, part, attempts, executor, seconds):
        stop = [self.stop] if executor is self.threads else []      # it cannot leave the process
        self.running[self._start(executor, core.grow, self.task, part.cells, seconds, MANY,
                                 self.want_steps, *stop)] = part, attempts

    def _start(self, executor, *call):
        try:
            return executor.submit(*call)
        except RuntimeError as error:
            if executor is self.threads:
                raise MemoryError("there is not enough memory for another thread") from None
            raise ConverseError("the workers are gone (%s)" % error) from None

    def _merge(self):
        """Gives the text of parts whose predecessors are finished to these."""
        parts = []
        for part in self.parts:
            if parts and not parts[-1].cells and (self.stubborn or not parts[-1].stopped):
                parts[-1].pieces += part.pieces
                parts[-1].steps += part.steps
                parts[-1].stopped = parts[-1].stopped or part.stopped
                part.pieces, part.steps = [], []
                if not part.cells:
                    continue
            parts.append(part)
        self.parts = parts

    def settle(self):
        """Waits a little for those who still work, and takes what they bring."""
        self.stop[0] = 1
        done, late = concurrent.futures.wait(self.running, 4 * TASK_SECONDS + 1)
        for future in done:
            with contextlib.suppress(Exception):        # else the part is as it was
                self._take(self.running[future][0], future.result())
        for future in late:
            future.cancel()
        self.running.clear()
