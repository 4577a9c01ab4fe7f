"""Who does the work: threads of this process, or the workers of somebody else's executor."""

import concurrent.futures
import contextlib
import os
import time
import warnings

from ..storage.files import ConverseError
from ..version import __version__
from .signals import postponed

LOOK_SECONDS = 0.1                  # between two looks at the clock, at Ctrl-C, at the bar
ATTEMPTS = 4                        # at a part whose workers die
ASK_SECONDS = 1.0                   # between two questions to a cluster
PROBE = "__import__('converse.prover.native').__version__"       # evaluated by a worker that may not have it


class WorkersGone(ConverseError):
    """Nobody is left to do the work, or nobody can; what was found until then stands."""


def count_workers(executor=None):
    """How many tasks keep the cores of this machine, or an executor, busy."""
    if executor is not None:
        return 2 * (getattr(executor, "num_workers", None)
                    or getattr(executor, "_max_workers", None) or 4)
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:              # not everywhere
        return os.cpu_count() or 1


class Crew:
    """The workers of an executor, or of this process.

    executor: a concurrent.futures.Executor or None; jobs: tasks at a time, or None: as many as keep
    the workers busy, who may come and go where the executor is a Dask cluster's."""

    def __init__(self, executor, jobs):
        self.executor, self.jobs = executor, jobs
        self.client = getattr(executor, "_client", None)        # of Dask
        self.due, self.threads, self.probes, self.waiting = 0.0, 0, {}, ""

    @property
    def alive(self):
        """Is there somebody to take tasks, or to cancel them?"""
        return self.client is None or self.client.status in ("running", "connecting")

    @property
    def size(self):
        """How many tasks to give them at a time; 0 while they are waited for, of which a
        RuntimeWarning tells.  WorkersGone: they will not come."""
        if self.client is None:
            return self.jobs or count_workers(self.executor)
        if time.monotonic() >= self.due:
            self._ask()
            self.due = time.monotonic() + ASK_SECONDS
        return self.threads and (self.jobs or 2 * self.threads)

    def gone(self, error=None):
        """The exception to raise where no task can be given to them."""
        return WorkersGone("the workers are gone (%s)" % error if self.alive
                           else "the Dask scheduler is gone")

    def failed(self, error, attempts):
        """What becomes of a task of which so many attempts were left: nothing if it may be tried
        again; an exception of this program or memory that is missing is passed on; WorkersGone."""
        if isinstance(error, (ConverseError, MemoryError)):
            raise error
        if not self.alive:
            raise self.gone()
        if attempts > 1:
            return
        words = " ".join(str(error).split()).partition(". ")[0]
        if "deserialization" in words:  # by a Dask scheduler
            raise WorkersGone("the Dask scheduler cannot read the tasks: converse is missing there, "
                              "or its packages are others; install converse-kam %s as here (%s)"
                              % (__version__, words))
        raise WorkersGone("the workers keep failing (%s: %s)" % (type(error).__name__, words))

    def _ask(self):
        """Asks a Dask cluster for its workers, and each new one whether this program is there: one
        that lacks it dies of the first task that it is sent."""
        if not self.alive:
            raise self.gone()
        there, lack = {}, "the Dask scheduler does not answer"
        with contextlib.suppress(Exception):    # of many kinds, among them that time is up
            if self.client.status == "running":
                there = self.client.nthreads(callback_timeout=10)
                lack = "the Dask cluster has no workers"
                for address in there or [None]:     # a cluster that adapts waits for a task
                    if address not in self.probes:
                        self.probes[address] = self.client.submit(
                            eval, PROBE, pure=False, workers=address)
                if there:
                    self.probes.pop(None, None)
        self.threads = sum(threads for address, threads in there.items() if self._is_fit(address))
        self._wait_for("" if there else lack)

    def _is_fit(self, address):
        """Is this program at a worker, the same release?  False: it is not known; WorkersGone: no."""
        probe = self.probes.get(address)
        if probe is None or probe is True or probe.status not in ("finished", "error"):
            return probe is True
        try:
            release, why = probe.result(), ""
        except OSError:                 # the answer is lost with the worker or the scheduler
            return False
        except Exception as error:
            release, why = "none", " (%s)" % error
        if release != __version__:
            raise WorkersGone("the worker at %s needs converse %s and has %s%s; install converse-kam "
                              "%s where the workers and the scheduler run"
                              % (address, __version__, release, why, __version__))
        self.probes[address] = True
        return True

    def _wait_for(self, what):
        if what and what != self.waiting:
            warnings.warn(what + "; waiting", RuntimeWarning, stacklevel=3)
        self.waiting = what


def wait(futures, seconds):
    """Those of the futures that are done, as soon as one is, or after so many seconds or
    LOOK_SECONDS."""
    if not futures:
        time.sleep(seconds)
    with postponed():
        return concurrent.futures.wait(futures, min(seconds, LOOK_SECONDS), concurrent.futures.FIRST_COMPLETED)[0]


def submit(executor, *call):
    """executor.submit(*call); a signal waits until it is done."""
    with postponed():
        return executor.submit(*call)


def result(future):
    """future.result(); a signal ends the waiting for it."""
    while not wait([future], LOOK_SECONDS):
        pass
    return future.result()
