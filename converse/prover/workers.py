"""Tasks for the workers of an executor: threads of this process, or somebody else's anywhere.

concurrent.futures hands out calls, and Dask gives the task of a worker that died to another one.
This module adds what runs of hours need: workers may join and leave (Dask), and no signal strikes
in a lock.  A task is a column, a cell of a map, or a list of prisms that are to be decided."""

import concurrent.futures
import contextlib
import math
import os
import pickle
import platform
import threading
import time
import warnings

from ..model.exact import whole_number
from ..storage.files import ConverseError, WorkersGone
from ..storage.signals import Resource, postponed
from ..version import __version__

LOOK_SECONDS = 0.1                  # between two looks at the clock, at Ctrl-C, at the bar
TASKS = 8                           # for an executor whose workers nobody counts
ASK_SECONDS = 1.0                   # between two questions to a Dask scheduler
# Evaluated by a worker of an executor, on which the package may be missing.
ANSWER = "__import__('converse.prover.workers', fromlist='*').answer(release, task)"


def count_workers():
    """How many tasks keep the cores of this machine busy."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:              # not everywhere
        return os.cpu_count() or 1


class WorkerPool(Resource):
    """The workers of an executor or, where that is None, threads of this process, for a run that
    begins now.

    executor: a concurrent.futures.Executor or None; jobs: tasks at a time, or None: as many as keep
    the workers busy, which with a Dask cluster may come and go; time_limit: seconds on the clock.
    TypeError, ValueError: one of these is wrong.
    The tasks of threads of this process have as their last argument a function that tells whether
    to stop; other processes cannot be told."""

    def __init__(self, executor=None, jobs=None, time_limit=math.inf):
        if jobs is not None:
            whole_number(jobs, "jobs", 1)
        if executor is not None and not hasattr(executor, "submit"):
            raise TypeError("the executor is a concurrent.futures.Executor, not %r" % (executor,))
        if isinstance(time_limit, bool) or not isinstance(time_limit, (int, float)) or \
                not time_limit >= 0:
            raise ValueError("time_limit is a number of seconds, not %r" % (time_limit,))
        self.end, self.jobs, self.here = time.monotonic() + time_limit, jobs, executor is None
        self.executor = executor or concurrent.futures.ThreadPoolExecutor(jobs or count_workers())
        self.client = getattr(executor, "_client", None)        # of Dask
        self.due, self.cores, self.waiting = 0.0, 0, ""         # of _ask
        # By future the key of its task, by which who gave it recognises the result.
        self.running, self.stop = {}, threading.Event()

    def acquire(self):
        """The threads begin with the first task."""

    def release(self):
        self.stop.set()
        self._cancel()
        if self.here:
            self.executor.shutdown()

    def _cancel(self):
        with postponed():
            for future in self.running if self.alive else ():
                future.cancel()
        self.running.clear()

    def seconds_left(self):
        """Until the limit; 0 or less: none."""
        return self.end - time.monotonic()

    # ---- tasks

    def work(self, next_task, take, look):
        """Hands out what next_task() returns, (key, call, *arguments) or None, and calls take(key,
        result) for what comes back, until no task is left or look() returns True."""
        task = next_task()
        while task or self.running:
            size = self.size
            while task and len(self.running) <= size:           # one task waits for a worker
                self._submit(*task)
                task = next_task()
            for key, result in self._take():
                take(key, result)
            if look():
                self._cancel()          # What comes of the tasks is of no use.
                break
            task = task or next_task()

    def _submit(self, key, *task):
        """WorkersGone: nobody takes the task; MemoryError: memory lacks for another thread."""
        given = (*task, self.stop.is_set) if self.here else (
            eval, ANSWER, {"release": __version__, "task": pickle.dumps(task)})
        try:
            with postponed():
                self.running[self.executor.submit(*given)] = key
        except Exception as error:
            if not self.here:
                raise self._gone(error) from None
            if "new thread" in str(error):
                raise MemoryError("there is not enough memory for another thread") from None
            raise

    def _take(self):
        """Yields (key, result) of tasks that are done, as soon as one is; waits for LOOK_SECONDS at
        most.  WorkersGone: one failed; an exception of this program, missing memory, and whatever a
        thread of this process raised is passed on."""
        with postponed():
            done = concurrent.futures.wait(self.running, LOOK_SECONDS,
                                           concurrent.futures.FIRST_COMPLETED)[0]
        for future in done:
            try:
                with postponed():
                    result = future.result()
            except Exception as error:
                raise self._failed(error) from None
            yield self.running.pop(future), result

    # ---- workers

    @property
    def alive(self):
        """Can tasks still be given or cancelled?"""
        return self.client is None or self.client.status in ("running", "connecting")

    def check(self):
        """WorkersGone: they cannot."""
        if not self.alive:
            raise self._gone()

    @property
    def size(self):
        """How many tasks to have under way, without the one that waits; 0, with a RuntimeWarning,
        while a cluster lacks workers.  WorkersGone: there will be none."""
        if self.client is None:
            return self.jobs or (count_workers() if self.here else TASKS)
        if time.monotonic() >= self.due:
            self._ask()
            self.due = time.monotonic() + ASK_SECONDS
        return min(self.cores, 1) * (self.jobs or 2 * self.cores)

    def _gone(self, error=None):
        """The exception to raise where no task can be given to the workers."""
        lost = not self.alive or isinstance(error, concurrent.futures.CancelledError)
        return WorkersGone("the Dask scheduler is gone" if lost else "the workers are gone (%s)"
                           % " ".join(str(error).split()).partition(". ")[0])

    def _failed(self, error):
        """The exception to raise where a task failed."""
        if self.here or isinstance(error, (ConverseError, MemoryError)):
            return error
        if isinstance(error, (ImportError, AttributeError)):
            return WorkersGone("a worker has no converse %s (%s); install converse-kam %s where "
                               "the workers run" % (__version__, error, __version__))
        return self._gone(error)

    def _ask(self):
        """Asks a Dask cluster for its workers."""
        self.check()
        self.cores, lack = 0, "the Dask scheduler does not answer"
        with contextlib.suppress(Exception):    # of many kinds, among them that time is up
            if self.client.status == "running":
                self.cores = sum(self.client.nthreads(callback_timeout=10).values())
                lack = "" if self.cores else "the Dask cluster has no workers"
        if lack and lack != self.waiting:
            warnings.warn(lack + "; waiting", RuntimeWarning, stacklevel=3)
        self.waiting = lack


def answer(release, task):
    """The result of a task, (function, *arguments) by pickle, of another process that has a release
    of this program.  A worker calls it; before, neither it nor a scheduler must import anything.
    WorkersGone: the releases differ."""
    if release != __version__:
        raise WorkersGone("the worker on %s needs converse %s and has %s; install converse-kam %s "
                          "where the workers run"
                          % (platform.node(), release, __version__, release))
    call, *arguments = pickle.loads(task)
    return call(*arguments)


class Filling(Resource):
    """A run that adds to a result by many tasks: a context, at whose end the result is saved.

    result: with seconds, sha256 and save(); backup: of it; pool: a WorkerPool; look() is called a
    few times a second."""

    def __init__(self, result, backup, pool, look):
        self.result, self.backup, self.pool, self.look = result, backup, pool, look
        self.began = time.monotonic() - result.seconds

    @property
    def late(self):
        """Is the time up?"""
        return self.pool.seconds_left() <= 0

    def acquire(self):
        self.pool.acquire()

    def release(self):
        self.pool.release()
        self._count()
        self.result.sha256 = self.backup.finish(self.result)

    def _count(self):
        self.result.seconds = time.monotonic() - self.began

    def work(self, next_task, take):
        """As WorkerPool.work does, until no time is left."""
        def look():
            self._count()
            self.backup.update(lambda: self.result)
            self.look()
            return self.late

        if not self.late:
            self.pool.work(next_task, take, look)
