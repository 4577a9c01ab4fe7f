"""prove(): one run of the search for a proof, from what is known before it to a Proof."""

import concurrent.futures
import math
import os
import time
from dataclasses import replace
from fractions import Fraction
from typing import Any, Callable, Optional, Sequence, Union

from ..model.exact import Number, decimal_text, exact
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..model.region import reduced, skips
from ..storage.backup import Backup
from ..storage.files import ConverseError, Path
from ..storage.signals import interruptible
from ..version import __version__
from . import native, tree
from .links import wrong_letter
from .native import Counts, Task
from .orbit_length import longest
from .proof import Proof, Tree
from .resume import continued, counted
from .settings import LENGTH, MAY_CHANGE, SETTINGS, Settings
from .shared import Shared, take_up
from .starts import MAX_PROOF_LEAVES, has_width, plan
from .workers import WorkerPool, count_workers

LONG = 400                              # points: of a proved prism's orbit
# Decided prisms, after which it is asked whether thin prisms resist: with waves of one combination
# of the angles most proofs are finished then.
MANY_LEAVES = 5000
# Threads of this process decide these before the work is handed to an executor, each of whose
# workers sets the search up anew.
ALONE_LEAVES = 1000


def prove(source: Union[SymplecticMap, Problem, None] = None, *,
          xstar: Optional[Sequence[Number]] = None,
          jobs: Optional[int] = None, executor: Optional[concurrent.futures.Executor] = None,
          backup: Optional[Path] = None, resume: Union[Proof, Path, None] = None,
          time_limit: float = math.inf,
          progress: Optional[Callable[[float, Counts], None]] = None, **settings: Any) -> Proof:
    """Tries to prove that a map, or a family of maps, has no invariant tori.

    Parameters
    ----------
    source : SymplecticMap or Problem, optional
        The maps; or a Problem, which also says where x_1 is looked for.
    xstar : tuple of exact numbers, optional
        The angles of x*, in radians: two, or three for a map of three angles.  By default the
        program chooses them.
    jobs : int, optional
        How many threads: by default one per core; or how many tasks the executor gets at a time: by
        default as many as keep its workers busy.  The result does not depend on it.
    executor : concurrent.futures.Executor, optional
        Its workers decide the prisms, by default threads of this process.  The result does not
        depend on it.
    backup : path, optional
        A new file that is kept up to date, and is the proof file in the end.
    resume : Proof or path, optional
        An unfinished proof, or its file, to continue with its map and its settings; `depth` may
        be greater, and `stubborn` differ.  A file is also kept up to date, unless `backup` names
        another.
    time_limit : float
        Seconds of this run, on the clock, after which, about, the search is left as it is.
    progress : callable, optional
        progress(examined, counts) is called a few times a second.  `examined`, from 0 to 1, is the
        share of parameters and angles in prisms that are proved, skipped or given up.  It never
        falls.
    settings : optional
        Those of Settings, by name: method, depth, digits, stubborn, as_printed.  None is no choice.
        `digits` and `as_printed`, which only the thesis's method has, choose it.

    Returns
    -------
    Proof
        True if it proves a theorem; its `conclusion` says what was decided.

    Raises
    ------
    ConverseError, MemoryError
        The run ended; the backup is whole.
    ValueError, TypeError
        An argument is wrong.

    Warns
    -----
    RuntimeWarning
        The backup cannot be written now, and will be tried again.  NotSaved, one of these: it could
        not be written in the end.
    """
    if unknown := settings.keys() - SETTINGS:
        raise TypeError("prove() has no argument %s; the settings are %s"
                        % (min(unknown), ", ".join(SETTINGS)))
    given = {name: value for name, value in settings.items() if value is not None}
    pool = WorkerPool(executor, jobs, time_limit)
    file = None if resume is None or isinstance(resume, Proof) else resume
    name = "the proof to resume" if file is None else os.fspath(file)
    if resume is not None:
        if source is not None or xstar is not None or not set(given) <= MAY_CHANGE:
            raise ValueError("a proof is continued as it was asked for, only deeper or more "
                             "stubbornly; leave out the map, x* and the method")
    elif source is None:
        raise TypeError("there must be a map or a problem, or a proof to resume")
    else:
        problem = Problem.of(source)
        before = Proof((Tree(problem, None if xstar is None else _point(xstar, problem.size)),),
                       Settings.of(given))
    with interruptible(), Backup(file if backup is None else backup, resumed=file) as backup_file:
        if resume is not None:
            proof = resume if isinstance(resume, Proof) else Proof.load(resume)
            before = continued(proof, name, given)
        try:
            return _Run(ready(before), backup_file, pool, progress).run()
        except native.WrongTree as error:
            raise ConverseError("%s: %s; use an intact copy or start anew"
                                % (name, error)) from None


def ready(before: Proof) -> Proof:
    """Prepares a search.  The problem becomes as the method takes it.  With the sharper method, x*
    and the region are chosen, unless the search has begun or the problem names axes.
    ConverseError: the problem is not for this program; ValueError: not for this method."""
    problem, xstar = before.settings.accept(before.problem), before.xstar
    if before.method == "loewner" and not before.tree and problem.full_torus and \
            problem.axes is None:
        xstar = xstar or native.chosen_start(Task(problem, before.settings))
        problem = reduced(problem, xstar)
    return before.with_tree(0, problem=problem, xstar=xstar)


def _point(xstar, size):
    """x* as `size` decimal strings."""
    if not isinstance(xstar, (tuple, list)) or len(xstar) != size:
        raise ValueError("xstar is %s numbers, in radians, not %r"
                         % ({2: "two", 3: "three"}[size], xstar))
    try:
        return tuple(decimal_text(exact(x)) for x in xstar)
    except (TypeError, ValueError) as error:
        raise type(error)("xstar: %s" % error) from None


class _Run:
    """One run of a search, from what was known before it to a Proof.

    The trees are grown one after the other.  Where a tree leaves prisms undecided, further ones are
    added to the list."""

    def __init__(self, before, backup, pool, progress):
        self.proof, self.backup = replace(before, hopeless=False), backup
        self.pool, self.threads = pool, pool.here and pool.jobs or count_workers()
        self.progress = progress or (lambda share, counts: None)
        self.began, self.seconds_before = time.monotonic(), before.seconds
        self.examined = self.share = 0.0    # before the tree that is grown now; of all, told last
        self.number, self.search = 0, None      # of that tree, and its search
        self.counts = before.counts             # when that began
        self.tried = set()                      # trees for which others were looked for
        # The most points of an orbit in all trees.  None: that is asked when a prism needs more.
        self.may_be_long = before.method == "loewner" and before.problem.is_flat
        self.longest = before.longest if self.may_be_long else native.ORDINARY

    def run(self):
        try:
            with self.pool:
                while self.number < len(self.proof.trees) and self._grow():
                    linked = (not self._tree.decided or self._is_hard()) and self._link()
                    if not linked and self._tree.decided:
                        self.number += 1
                    elif not linked and ("U" in self._tree.text or self._is_vain()):
                        self.proof = replace(self.proof, hopeless=self._is_hopeless())
                        break
                    self.examined = self.share
        except native.WrongTree:            # the file is left to whoever wants to mend it
            self.backup.leave()
            raise
        except BaseException:               # what is known is saved
            if self.search is not None or self.proof.tree:
                self._saved()
            raise
        return self._saved()

    # ---- one tree

    def _grow(self):
        """Grows one of the trees; False if time is up first.  Growing also ends when the tree turns
        out to be so hard that other starting points are to be looked for."""
        problem, text = self._tree.problem, self._tree.text
        task = Task(problem, self.proof.settings, self._tree.xstar,
                    -native.ORDINARY if self.longest is None else self.longest)
        search = native.Search(task)
        if self._is_late() or not search.work(0, self._is_late):    # no time even to set it up
            return False
        counts = self.counts = self.proof.counts
        if self.proof.parts:
            counts = replace(counts, **dict(zip(tree.NODES, tree.count(text))))
        take_up(search, self.proof.depth, text, self._tree.pending)
        if any(getattr(counts, name) != n for name, n in zip(tree.NODES, tree.count(text))):
            raise native.WrongTree()
        self.counts_before = counts
        if self.number == 0:
            self.proof = replace(self.proof.with_tree(0, xstar=search.xstar),
                                 constants=search.constants, at_once=search.at_once)
        wrong = wrong_letter(problem, Fraction(search.constants["B"]), search.xstar, text,
                             self.proof.parts)
        if wrong:
            raise native.WrongTree("a leaf that is linked to part %s may lead out of its region"
                                   % wrong)
        self.search = search
        left = MANY_LEAVES - counts.decided
        if self.may_be_long and left > 0 and not self._look():  # what is asked then is asked there,
            search.work(self.threads, self._look, left)     # whenever this looks
        if not self.pool.here:
            if not self._look():
                search.work(self.threads, self._look, ALONE_LEAVES)
            if not self._look():        # it is not soon finished
                self.search = Shared(replace(task, xstar=search.xstar), search.view(True),
                                     self.pool)
        if not self._look():
            self.search.work(self.threads, self._look)
            self._look()
        ended, doubtful = self._is_ended(), self._is_doubtful()
        self.proof, self.search = self._snapshot(), None
        if doubtful and not ended:
            return self._knows_longest() and self._grow()
        return ended

    def _is_late(self):
        return self._seconds_left() <= 0

    def _is_ended(self):
        """Is the tree finished, so hard that other points are looked for, or is more work vain?"""
        return self.view.finished or self._is_hard() or self._is_vain()

    def _knows_longest(self):
        """Finds out how long orbits may become, which the first tree tells for all; False if time
        is up first."""
        if self.longest is None:
            first = self.proof.trees[0]
            self.longest = longest(first.problem, first.xstar, self.threads, self._is_late_told)
            self.proof = replace(self.proof, longest=self.longest)
        return self.longest is not None

    def _is_doubtful(self):
        """Is it to be asked now how long orbits may become?"""
        return self.view.needs_long or (
            self.longest is None and self.may_be_long and self._counts.decided >= MANY_LEAVES)

    def _resists(self):
        """Are there thin prisms that no orbit contradicts, over the first x* alone?"""
        return self.may_be_long and self.longest == native.ORDINARY and self.number == 0 and \
            self._counts.proved > 0 and not tree.count_linked(self._tree.text)

    def _is_vain(self):
        """Does more work on such a tree prove nothing?  If it cannot be linked it ends then."""
        return self._resists() and self._counts.decided >= MANY_LEAVES and \
            not self.proof.settings.stubborn

    def _is_hopeless(self):
        """Is there probably a torus, now that a tree ends undecided?"""
        return self._resists() or (
            self.longest == native.ORDINARY and self.proof.ended == LENGTH)

    @property
    def _counts(self):
        """The statistics as they stand."""
        return self.proof.counts if self.search is None else \
            self.counts_before + (self.view.settled or self.view.counts)

    @property
    def _tree(self):
        """The tree that is grown."""
        return self.proof.trees[self.number]

    # ---- other starting points

    def _is_hard(self):
        """Are other starting points to be looked for before the tree is finished?  The answer
        depends on prisms and not on time."""
        return (self._is_long() or self._is_large()) and self._may_link()

    def _is_long(self):
        """Did a prism of the first tree need LONG points?  For a single map of one angle, all
        orbits are long near the last circle."""
        problem = self._tree.problem
        return self.number == 0 and self._counts.max_NTsteps >= LONG and \
            not (problem.is_flat and not has_width(problem))

    def _is_large(self):
        """Has a tree of a single value more prisms than those that show a starting point to be
        good?"""
        proved = self._tree.text.count("P") if self.search is None else self._counts.proved
        return proved > MAX_PROOF_LEAVES and not has_width(self._tree.problem)

    def _may_link(self):
        """May the tree be linked?  Other points are looked for once, since a second look would try
        the same points.  Where the core skips mirror images, the originals must be proved, and
        not linked."""
        problem, settings = self._tree.problem, self.proof.settings
        return self.number not in self.tried and \
            settings.method == "loewner" and not settings.stubborn and \
            problem.factor is None and not skips(problem, self._tree.xstar) and \
            not tree.count_linked(self._tree.text)

    def _link(self):
        """Links what the tree leaves undecided to new parts, if some are found."""
        problem = self._tree.problem
        if not (self._may_link() and self._knows_longest()):
            return False
        undecided = not self._is_long()
        self.tried.add(self.number)

        found = plan(problem, self.proof.depth, self._tree.xstar, undecided,
                     Fraction(self.proof.constants["B"]), len(self.proof.parts),
                     self.longest, self.threads, self._is_late_told)
        if found is None:
            return False
        proof = self.proof.with_tree(self.number, text=found.tree, pending=())
        counts = self.counts if self.number else Counts()       # without what was in vain
        self.proof = replace(proof, trees=proof.trees + tuple(found.parts),
                             counts=counts + found.counts)
        return True

    # ---- what is told

    def _seconds_left(self):
        return self.pool.seconds_left()

    def _is_late_told(self):
        """This is asked again and again while no tree grows."""
        self.pool.check()
        self.progress(self.share, self.proof.counts)
        return self._is_late()

    def _look(self):
        """Tells whoever wants to know how far things are.  Returns whether the work is to end."""
        self.view = self.search.view()
        self.share = max(self.share, self.examined + (1 - self.examined) * self.view.examined / (
            len(self.proof.trees) - self.number))
        self.progress(self.share, self.counts_before + self.view.counts)
        self.backup.update(self._snapshot)
        return self._is_ended() or self._is_doubtful() or self._is_late()

    def _snapshot(self):
        """The proof as it stands."""
        proof = self.proof
        if self.search is not None:
            grown = self.search.view(True)
            nodes = dict(zip(tree.NODES, tree.count(grown.text)))   # an undecided prism drops some
            proof = replace(proof.with_tree(
                self.number, text=grown.text, pending=tuple(hint for _, _, hint in grown.cells)),
                counts=replace(self.counts_before + grown.counts, **nodes))
        if proof.parts:
            proof = replace(proof, counts=counted(proof))
        return replace(proof, seconds=self.seconds_before + time.monotonic() - self.began,
                       version=__version__, sha256="")

    def _saved(self):
        proof = self._snapshot()
        return replace(proof, sha256=self.backup.finish(proof))
