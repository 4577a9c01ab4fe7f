"""A proof is looked for."""

import concurrent.futures
import math
import os
import time
from dataclasses import replace
from decimal import Decimal
from typing import Any, Callable, Dict, Optional, Tuple, Union

from ..model.exact import Number, decimal_text, exact
from ..model.problem import IDENTITY, NAMES, Problem
from ..storage.backup import Keeper
from ..storage.files import ConverseError
from ..version import __version__
from . import native, tree
from .native import Counts, Task
from .proof import Proof
from .settings import Settings
from .signals import interruptible, postponed
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
    if problem is None and resume is None:
        raise TypeError("there must be a problem, or a proof to resume")
    if problem is not None and not isinstance(problem, Problem):
        raise TypeError("the problem is a Problem, not %r" % (problem,))
    if isinstance(time_limit, bool) or not isinstance(time_limit, (int, float)) or \
            not time_limit >= 0:
        raise ValueError("time_limit is a number of seconds, not %r" % (time_limit,))
    star = None if xstar is None else _point(xstar)
    if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
        raise ValueError("jobs must be a whole number, 1 or more, not %r" % (jobs,))
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError("the executor is a concurrent.futures.Executor, not %r" % (executor,))
    file = None if resume is None or isinstance(resume, Proof) else resume
    with interruptible(), Keeper(file if backup is None else backup, resumed=file) as keeper:
        if problem is not None and resume is None:
            before = Proof(problem, Settings(**given), xstar=star)
        else:
            before = _continued(resume, file, problem, given, star)
        if before.settings.method == "thesis":
            before = replace(before, problem=_for_thesis(before.problem))
        run = _Run(before, keeper, jobs, executor, time_limit, progress, on_leaf)
        try:
            return run.run()
        except native.WrongTree as error:
            raise ConverseError("%s: %s; use an intact copy or start anew"
                                % (_name(file), error)) from None


class _Run:
    """One run of a search, from what was known before it to a Proof."""

    def __init__(self, before, keeper, jobs, executor, time_limit, progress, on_leaf):
        self.before, self.keeper = before, keeper
        self.progress, self.on_leaf = progress, on_leaf
        self.began = time.monotonic()
        self.end = self.began + time_limit
        self.search = TreeSearch(Task(before.problem, before.settings, before.xstar), jobs,
                                 executor, want_steps=on_leaf is not None)
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
        if self.on_leaf:
            text, steps = self.search.beginning(self.seen)
            self.seen += len(text)
            for node, points in zip(text, steps):
                for kind, cell in self.walk.feed(node):
                    if points != OLD:
                        self.on_leaf(tree.Leaf(kind, *self.prism(cell), sum(cell[1])), points)
        if self.progress:
            self.progress(self.search.examined, self.search.counts)
        self.keeper.keep(self._snapshot)

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
            self.keeper.leave()

    def _finished(self, proof):
        with postponed():               # a signal must not cost the last write
            return replace(proof, sha256=self.keeper.finish(proof))


def _for_thesis(problem):
    """The problem as the thesis's method takes it, which knows of no frames."""
    if problem.together:
        raise ValueError("parameters that move together need the method loewner")
    if problem.general is not None:
        raise ValueError("the method thesis takes three ranges of a, b and c; for any other patch or "
                         "potential choose the method loewner")
    return replace(problem, axes=IDENTITY, alone="no")


def _point(xstar):
    """x* as a pair of decimal strings."""
    if not isinstance(xstar, (tuple, list)) or len(xstar) != 2:
        raise ValueError("xstar is two numbers, in radians, not %r" % (xstar,))
    try:
        return decimal_text(exact(xstar[0])), decimal_text(exact(xstar[1]))
    except (TypeError, ValueError) as error:
        raise type(error)("xstar: %s" % error) from None


def _name(file):
    return "the proof to resume" if file is None else os.fspath(file)


def _as_before(problem, before, differs):
    """The problem, which must be the one of before but for its comments, with the frame and the
    coordinate that were chosen then, unless it names others."""
    for key in NAMES:
        theirs, ours = getattr(before, key), getattr(problem, key)
        if None not in (theirs, ours) and theirs != ours:
            differs(key, *(" .. ".join(map(decimal_text, ends)) for ends in (theirs, ours)))
    if problem.general != before.general:
        differs("potential", before, problem)
    if problem.together != before.together:
        differs("together", before.together, problem.together)
    same = replace(problem, **{key: getattr(before, key) for key in ("axes", "alone")
                               if getattr(problem, key) is None})
    for key, what in ("frame", "frame"), ("kept", "coordinate that stands alone"):
        if getattr(same, key) != getattr(before, key):
            differs(what, getattr(before, key), getattr(same, key))
    return same


def _continued(resume, file, problem, given, xstar):
    """The proof to continue, with the settings it is to be continued with."""
    name = _name(file)
    proof = resume if file is None else Proof.load(file)
    settings = replace(proof.settings, **{key: value for key, value in given.items()
                                          if key in ("depth", "stubborn")})

    def differs(what, theirs, ours):
        raise ConverseError("%s: is of another run: its %s is %s, this one's is %s; "
                            "name the backup of this run or start anew" % (name, what, theirs, ours))

    if proof.version != __version__:
        differs("program", proof.version, __version__)
    for key in "method", "digits", "as_printed":
        if key in given and given[key] != getattr(proof.settings, key):
            differs(key.replace("_", " "), getattr(proof.settings, key), given[key])
    if settings.depth < proof.settings.depth:
        differs("depth", proof.settings.depth, settings.depth)
    if problem is not None:
        problem = _as_before(problem, proof.problem, differs)
    if xstar is not None:
        if proof.xstar is not None and list(map(Decimal, proof.xstar)) != list(map(Decimal, xstar)):
            differs("x*", " ".join(proof.xstar), " ".join(xstar))
        proof = replace(proof, xstar=proof.xstar or xstar)
    if "U" in proof.tree and proof.settings.stubborn and not settings.stubborn and \
            settings.depth == proof.settings.depth:
        differs("stubborn", True, False)
    text, pending = proof.tree, proof.pending
    if settings.depth > proof.settings.depth:       # what was given up is tried again
        known, hints = iter(pending), []
        for leaf in tree.UNDECIDED_OR_UNTRIED.findall(text):
            hints.append(next(known, 0) if leaf == tree.UNTRIED else 0)
        pending = (*hints, *known)
        text = text.replace("U", tree.UNTRIED)
    return replace(proof, settings=settings, problem=problem or proof.problem, tree=text,
                   pending=pending, counts=replace(proof.counts, undecided=text.count("U")),
                   restored=sum(map(text.count, "PS")))
