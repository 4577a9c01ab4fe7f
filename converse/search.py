"""The search: the C core grows parts of the tree, in threads here or in processes anywhere.

What becomes of a prism depends on nothing but itself, so the tree, its counts and the theorem are
the same however the work is divided.
"""

import concurrent.futures
import contextlib
import os
import threading
import time
from dataclasses import asdict, dataclass, fields
from decimal import Decimal
from typing import List, Optional, Tuple

from . import tree
from ._native import ffi, lib
from .files import ConverseError

METHODS = {"thesis": lib.CV_THESIS, "loewner": lib.CV_LOEWNER}
MANY = 2 ** 30
ALONE_SECONDS = 0.03                # before anyone else is asked
TASK_SECONDS = 0.25                 # that a worker grows its part before it reports, in the long run
LOOK_SECONDS = 0.1                  # between two looks at the clock, at Ctrl-C, at the bar
ATTEMPTS = 4                        # at a part whose workers die

MESSAGES = {
    lib.CV_ENUMBER: "a number is malformed or out of range",
    lib.CV_EARGUMENT: "an argument makes no sense",
    lib.CV_EARITHMETIC: "the arithmetic failed: a division by zero, a root of a negative number "
                        "or lost precision; try more digits",
    lib.CV_ESINGULAR: "the matrix could not be inverted at any sensible precision",
    lib.CV_EMACHINE: "this machine's floating-point arithmetic, or the way the program was "
                     "built, breaks the rules that the proof relies on",
}


def check(code):
    """Turns an error code of the C core into an exception; passes any other code on."""
    if code == lib.CV_ENOMEM:
        raise MemoryError("there is not enough memory")
    if code < 0:
        raise ConverseError(MESSAGES.get(code, "the C core failed with code %d" % code))
    return code


@dataclass(frozen=True)
class Counts:
    """The statistics of a search; the names are those of csrc/converse.h."""

    quick_tries: int = 0
    tries: int = 0
    Rtries: int = 0
    cuts: int = 0
    proved: int = 0
    symmetric: int = 0
    undecided: int = 0
    HermSuccess: int = 0
    LLSuccess: int = 0
    ll_used: Tuple[int, ...] = (0, 0, 0)
    reasons: Tuple[int, ...] = (0,) * lib.CV_N_REASONS
    most_cuts: int = 0
    max_steps: int = 0
    max_NTsteps: int = 0

    def __add__(self, other):
        """The statistics of both searches together."""
        both = {}
        for name, mine in asdict(self).items():
            theirs = getattr(other, name)
            if isinstance(mine, tuple):
                both[name] = tuple(map(sum, zip(mine, theirs)))
            else:
                both[name] = (max if name.startswith("m") else int.__add__)(mine, theirs)
        return Counts(**both)


@dataclass(frozen=True)
class Task:
    """All that a worker must know of a search; what prove() was asked, as plain data."""

    centre: Tuple[str, ...]
    half: Tuple[str, ...]
    xstar: Optional[Tuple[str, str]]
    together: bool
    method: str
    depth: int
    digits: int
    stubborn: bool
    as_printed: bool


@dataclass
class Grown:
    """What a worker grew: the text, and the cells that are to follow it.

    A cell here is (index, cuts, hint), the hint being what the C core learnt from its parent."""

    text: str
    cells: List[tuple]
    counts: Counts
    volume: float                           # decided, as a share of the root
    steps: int                              # orbit length of the last leaf


class Part:
    """A part of the tree: its text so far, in pieces, and the cells that are to follow it."""

    def __init__(self, cells, text=""):
        self.cells, self.pieces = list(cells), [text]
        self.stopped = "U" in text          # and a search that is not stubborn ends here


class Search:
    """A search in the C core, in terms of Python."""

    def __init__(self, task):
        owners = []

        def strings(texts):
            owners.extend(ffi.new("char[]", text.encode("ascii")) for text in texts)
            return ffi.new("char *[]", owners[len(owners) - len(texts):])

        handle = ffi.new("cv_search **")
        check(lib.cv_search_new(
            handle, strings(task.centre), strings(task.half),
            strings(task.xstar) if task.xstar else ffi.NULL, METHODS[task.method], task.together,
            task.digits, task.depth, task.stubborn, task.as_printed))
        self.handle = ffi.gc(handle[0], lib.cv_search_free)

    def grow(self, cells, seconds, max_leaves=MANY):
        """Decides cells, and those they are cut into, for about so long."""
        handle = self.handle
        check(lib.cv_restart(handle, len(cells), cells))
        check(lib.cv_step(handle, max_leaves, seconds))
        length = ffi.new("size_t *")
        text = lib.cv_tree(handle, length)
        pending = ffi.new("cv_cell[]", lib.cv_pending(handle, ffi.NULL))
        lib.cv_pending(handle, pending)
        counts = lib.cv_get_counts(handle)
        values = {item.name: getattr(counts, item.name) for item in fields(Counts)}
        return Grown(ffi.unpack(text, length[0]).decode("ascii") if length[0] else "",
                     [(tuple(cell.index), tuple(cell.cuts), getattr(cell, "from"))
                      for cell in pending],
                     Counts(**{name: value if isinstance(value, int) else tuple(value)
                               for name, value in values.items()}),
                     lib.cv_volume_decided(handle), lib.cv_last_steps(handle))

    def constant(self, which):
        text = lib.cv_constant(self.handle, which)
        if not text:
            raise MemoryError("there is not enough memory")
        text = ffi.gc(text, lib.cv_free)
        return str(Decimal(ffi.string(text).decode("ascii")))

    @property
    def symmetric(self):
        return bool(lib.cv_symmetric(self.handle))

    @property
    def at_once(self):
        return bool(lib.cv_at_once(self.handle))


_mine = threading.local()               # each thread's last search: making one takes time


def grow(task, cells, seconds):
    """What a worker does."""
    if getattr(_mine, "task", None) != task:
        _mine.search = Search(task)
        _mine.task = task
    try:
        return _mine.search.grow(cells, seconds)
    except BaseException:
        _mine.task = _mine.search = None    # nobody knows in what state it is
        raise


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
    """The tree while it grows: its parts in preorder, some of them being worked on."""

    def __init__(self, task, search, parts, executor=None, jobs=1):
        """search: one for this thread; parts: the parts of the tree, in preorder."""
        self.task, self.search, self.parts = task, search, parts
        self.counts, self.volume, self.steps = Counts(), 0.0, 0
        self.executor, self.jobs, self.began = executor, jobs, time.monotonic()
        self.running = {}                   # future -> (part, attempts left)

    def _relevant(self):
        """The parts, up to the one that ends a search that is not stubborn."""
        for part in self.parts:
            yield part
            if part.stopped and not self.task.stubborn:
                return

    @property
    def finished(self):
        """Is everything decided that is to be decided?"""
        return not any(part.cells for part in self._relevant()
                       if self.task.stubborn or not part.stopped)

    def text(self):
        """The tree so far, and the hints of the untried prisms in it."""
        pieces, hints = [], []
        for part in self._relevant():
            pieces += part.pieces
            if self.task.stubborn or not part.stopped:
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
        if undecided and not self.task.stubborn:
            return                          # it ends there, and can never become a theorem
        if proved + symmetric + undecided + untried != cuts + 1 or self.counts.cuts != cuts or (
                self.counts.proved, self.counts.symmetric) != (proved, symmetric):
            raise AssertionError("the tree is not whole")

    def _take(self, part, grown):
        """Adds to a part what was grown from its cells."""
        part.pieces.append(grown.text)
        part.cells = grown.cells
        part.stopped = part.stopped or grown.counts.undecided > 0
        self.counts += grown.counts
        self.volume += grown.volume
        self.steps = grown.steps

    def alone(self, seconds, max_leaves=MANY):
        """Works in this thread on the first part that is not finished."""
        for part in self._relevant():
            if part.cells:
                self._take(part, self.search.grow(part.cells, seconds, max_leaves))
                return

    def _queue(self):
        """The parts that wait for a worker, in preorder."""
        busy = {id(part) for part, _ in self.running.values()}
        return [part for part in self._relevant() if part.cells and id(part) not in busy
                and (self.task.stubborn or not part.stopped)]

    def _divide(self, queue, wanted):
        """Makes as many parts of those in the queue as are wanted, if it can."""
        while 0 < len(queue) < wanted:
            part = max(queue, key=lambda part: len(part.cells))
            if len(part.cells) == 1:
                break
            first, rest = Part(part.cells[:-1]), Part(part.cells[-1:])  # the last is the largest
            first.pieces, first.stopped = part.pieces, part.stopped
            at, place = self.parts.index(part), queue.index(part)
            self.parts = self.parts[:at] + [first, rest] + self.parts[at + 1:]
            queue[place:place + 1] = [first, rest]
        return queue

    def together(self, seconds):
        """Hands parts to the executor and takes what comes back within so many seconds."""
        idle = self.jobs - len(self.running)
        for part in self._divide(self._queue(), idle)[:idle]:
            self._submit(part, ATTEMPTS)
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
                self._submit(part, attempts - 1)
        self._merge()

    def _submit(self, part, attempts):
        seconds = min(TASK_SECONDS, 0.1 * (time.monotonic() - self.began))
        try:
            future = self.executor.submit(grow, self.task, part.cells, seconds)
        except RuntimeError as error:
            raise ConverseError("the workers are gone (%s)" % error) from None
        self.running[future] = part, attempts

    def _merge(self):
        """Gives the text of parts whose predecessors are finished to these."""
        parts = []
        for part in self.parts:
            if parts and not parts[-1].cells and (self.task.stubborn or not parts[-1].stopped):
                parts[-1].pieces += part.pieces
                parts[-1].stopped = parts[-1].stopped or part.stopped
                part.pieces = []
                if not part.cells:
                    continue
            parts.append(part)
        self.parts = parts

    def settle(self):
        """Waits a little for those who still work, and takes what they bring."""
        done, late = concurrent.futures.wait(self.running, 4 * TASK_SECONDS + 1)
        for future in done:
            with contextlib.suppress(Exception):        # else the part is as it was
                self._take(self.running[future][0], future.result())
        for future in late:
            future.cancel()
        self.running.clear()
