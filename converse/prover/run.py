"""prove(): one run of the search for a proof, from what is known before it to a Proof."""

import concurrent.futures
import math
import os
import time
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Optional, Tuple, Union

from ..model.exact import Number, decimal_text, exact
from ..model.problem import Problem
from ..storage.backup import Backup
from ..storage.files import ConverseError
from ..storage.signals import interruptible, postponed
from ..version import __version__
from . import native, tree
from .native import Counts, Task
from .proof import Proof
from .resume import continued
from .settings import Settings
from .tree_search import OLD, TreeSearch
from .workers import LOOK_SECONDS

Path = Union[str, "os.PathLike[str]"]


def prove(problem: Optional[Problem] = None, *, method: Optional[str] = None,
          depth: Optional[int] = None, digits: Optional[int] = None,
          stubborn: Optional[bool] = None, as_printed: Optional[bool] = None,
          xstar: Optional[Tuple[Number, Number]] = None,
          jobs: Optional[int] = None, executor: Optional[concurrent.futures.Executor] = None,
          backup: Optional[Path] = None, resume: Union[Proof, Path, None] = None,
          time_limit: float = math.inf,
          progress: Optional[Callable[[float, Counts], None]] = None,
          on_leaf: Optional[Callable[[tree.Leaf, int], None]] = None) -> Proof:
    """Tries to prove that there are no invariant tori, and returns a Proof either way.

    method, depth, digits, stubborn, as_printed: see Settings.
    xstar: the two angles of x*, in radians, exact numbers; by default the program chooses them.

    jobs: how many tasks at a time, by default one per core, or as many as keep the executor's
    workers busy; executor: a concurrent.futures.Executor whose workers they are, by default threads
    of this process.  The result does not depend on either.

    backup: a new file that is kept up to date.
    resume: an unfinished proof, or its file, to continue; what is not said otherwise is as it was,
    but depth may be greater.  A file is kept up to date, too, unless backup names another.

    time_limit: after about so many seconds of this run the search is left as it is.
    progress(examined, counts) is called a few times a second; examined, from 0 to 1: the share of
    parameters and angles in prisms that are proved, skipped or given up.  It never falls.  The last
    of it takes longest, and how long is not known.
    on_leaf(leaf, points) is called for every leaf that this run decides, in preorder; points: the
    length of its orbit.

    ConverseError, MemoryError: nothing is lost of the backup; ValueError, TypeError: an argument is
    wrong.  RuntimeWarning: the backup cannot be written now, and will be tried again; NotSaved, one
    of these: it could not be written in the end.
    """
    given: Dict[str, Any] = {name: value for name, value in (
        ("method", method), ("depth", depth), ("digits", digits), ("stubborn", stubborn),
        ("as_printed", as_printed)) if value is not None}
    _check_problem(problem, resume)
    options = _Options(jobs, executor, time_limit, progress, on_leaf)
    star = None if xstar is None else _point(xstar)
    file = None if resume is None or isinstance(resume, Proof) else resume
    name = "the proof to resume" if file is None else os.fspath(file)
    if problem is not None and resume is None:
        before = Proof(problem, Settings(**given), xstar=star)
    with interruptible(), Backup(file if backup is None else backup, resumed=file) as backup_file:
        if resume is not None:
            proof = resume if isinstance(resume, Proof) else Proof.load(resume)
            before = continued(proof, name, problem, given, star)
        before = replace(before, problem=before.settings.accept(before.problem))
        try:
            return _Run(before, backup_file, options).run()
        except native.WrongTree as error:
            raise ConverseError("%s: %s; use an intact copy or start anew"
                                % (name, error)) from None


def _check_problem(problem, resume):
    if problem is None and resume is None:
        raise TypeError("there must be a problem, or a proof to resume")
    if problem is not None and not isinstance(problem, Problem):
        raise TypeError("the problem is a Problem, not %r" % (problem,))


def _point(xstar):
    """x* as a pair of decimal strings."""
    if not isinstance(xstar, (tuple, list)) or len(xstar) != 2:
        raise ValueError("xstar is two numbers, in radians, not %r" % (xstar,))
    try:
        return decimal_text(exact(xstar[0])), decimal_text(exact(xstar[1]))
    except (TypeError, ValueError) as error:
        raise type(error)("xstar: %s" % error) from None


@dataclass(frozen=True)
class _Options:
    """The arguments of prove() on which the tree does not depend; TypeError, ValueError: one of
    them is wrong."""

    jobs: Optional[int] = None
    executor: Optional[concurrent.futures.Executor] = None
    time_limit: float = math.inf
    progress: Optional[Callable] = None
    on_leaf: Optional[Callable] = None

    def __post_init__(self):
        if isinstance(self.time_limit, bool) or not isinstance(self.time_limit, (int, float)) or \
                not self.time_limit >= 0:
            raise ValueError("time_limit is a number of seconds, not %r" % (self.time_limit,))
        if self.jobs is not None and (
                isinstance(self.jobs, bool) or not isinstance(self.jobs, int) or self.jobs < 1):
            raise ValueError("jobs must be a whole number, 1 or more, not %r" % (self.jobs,))
        if self.executor is not None and not hasattr(self.executor, "submit"):
            raise TypeError("the executor is a concurrent.futures.Executor, not %r"
                            % (self.executor,))


class _Run:
    """One run of a search, from what was known before it to a Proof."""

    def __init__(self, before, backup, options):
        self.before, self.backup, self.options = before, backup, options
        self.began = time.monotonic()
        self.end = self.began + options.time_limit
        self.search = TreeSearch(Task(before.problem, before.settings, before.xstar), options.jobs,
                                 options.executor, want_steps=options.on_leaf is not None)
        self.walk, self.prism, self.seen = tree.Walk(), tree.prisms(before.problem), 0

    def run(self):
        with self.search as search:
            before = self.before
            begun = search.begin(before.tree, before.pending, before.counts, self._seconds_left)
            if begun is None:           # no time even to set it up
                return self._finished(replace(before, seconds=self._seconds()))
            self.before = replace(before, xstar=begun.xstar, constants=begun.constants,
                                  at_once=begun.at_once)
            try:
                self._look()
                while not search.finished and self._seconds_left() > 0:
                    search.work(min(LOOK_SECONDS, max(0.0, self._seconds_left())))
                    self._look()
                search.settle()
                self._look()
            except BaseException:       # what is known is saved, unless a change was half done
                search.settle()
                self._save_what_stands()
                raise
            return self._finished(self._snapshot())

    def _seconds_left(self):
        return self.end - time.monotonic()

    def _look(self):
        """Tells whoever wants to know how far things are."""
        if self.options.on_leaf:
            text, steps = self.search.beginning(self.seen)
            self.seen += len(text)
            for node, points in zip(text, steps):
                for kind, cell in self.walk.feed(node):
                    if points != OLD:
                        leaf = tree.Leaf(kind, *self.prism(cell), sum(cell[1]))
                        self.options.on_leaf(leaf, points)
        if self.options.progress:
            self.options.progress(self.search.examined, self.search.counts)
        self.backup.update(self._snapshot)

    def _seconds(self):
        return self.before.seconds + time.monotonic() - self.began

    def _snapshot(self):
        text, pending = self.search.text()
        return replace(self.before, tree=text, counts=self.search.counts, pending=tuple(pending),
                       seconds=self._seconds(), version=__version__, sha256="")

    def _save_what_stands(self):
        try:
            self._finished(self._snapshot())
        except AssertionError:          # an exception struck in the middle of a change
            self.backup.leave()

    def _finished(self, proof):
        with postponed():               # a signal must not cost the last write
            return replace(proof, sha256=self.backup.finish(proof))
