"""The leaves of all claims, divided among processes."""

import collections
import os
import signal
import threading

from .claim import LETTERS
from .criterion import Criterion
from .failures import Unusable, named
from .lockstep import import_numpy_if_sound
from .progress import cost
from .signals import LOOK_SECONDS, SIGNALS, undisturbed
from .tree import leaves

_worker = []                            # in each process: its Problems


class Problems:
    """The claims of a file: its own and those of its parts, or those of a map's cells with a bound
    of B for each; the fast path of all, if there is one."""

    def __init__(self, claims, bounds=None):
        self.claims, self.bounds, self.fast, self.known = claims, bounds, None, {}

    def criterion(self, n):
        if n not in self.known:
            claim = self.claims[n]
            if n and self.bounds is None:
                self.known[n] = self.criterion(0).of_part(claim)
            else:
                with named(claim.where):
                    self.known[n] = Criterion(claim, self.bounds and self.bounds[n])
        return self.known[n]

    def least_in_double(self, leaf):
        return self.criterion(leaf[0]).least_in_double(leaf[1])

    def excluded(self, leaf):
        return self.criterion(leaf[0]).excluded(leaf[1])

    def leaves(self):
        """The leaves P of all claims, as (number of the claim, cell), in their order."""
        for n, claim in enumerate(self.claims):
            for position, cell in leaves(claim.tree, kinds="PS" + LETTERS):
                if claim.tree[position] == "P":
                    yield n, cell


def check_chunk(chunk):
    """Checks leaves in order: (how many are confirmed, their cost and pieces, what then fails)."""
    problems, = _worker
    cells, refused, pieces = [leaf for _, leaf in chunk], None, []
    if problems.fast:
        refused, pieces = problems.fast.settle(
            cells, [problems.least_in_double(leaf) for leaf in cells],
            lambda n: problems.excluded(cells[n]))
    else:
        for n, leaf in enumerate(cells):
            why, tried = problems.excluded(leaf)
            if why:
                refused = n, why
                break
            pieces.append(tried)
    n = refused[0] if refused else len(cells)
    return n, sum([cost(cell) for _, cell in cells[:n]]), sum(pieces[:n]), \
        refused and (*chunk[n], refused[1])


def begin_apart(problems, stop):
    """Starts a worker process.  Signals are for the parent to notice; a worker ends when its parent
    says so, or has died."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    _worker[:] = [problems]
    if problems.fast:
        import_numpy_if_sound()
    threading.Thread(target=end_with_parent, args=(stop,), daemon=True).start()


def end_with_parent(stop):
    import multiprocessing.connection
    multiprocessing.connection.wait([stop, multiprocessing.parent_process().sentinel])
    os._exit(1)


def in_order(chunks, jobs, problems):
    """Yields the results of the chunks in their order, few of them being in memory at a time."""
    if jobs == 1:
        _worker[:] = [problems]
        yield from map(check_chunk, chunks)
        return
    import concurrent.futures.process  # where there are no processes, one job still works
    import multiprocessing

    def result(future):
        while True:
            with undisturbed():
                if concurrent.futures.wait([future], LOOK_SECONDS).done:
                    return future.result()

    stop, stopper = multiprocessing.Pipe(duplex=False)
    pool = concurrent.futures.ProcessPoolExecutor(jobs, initializer=begin_apart,
                                                  initargs=(problems, stop))
    waiting, over = collections.deque(), False
    try:
        for chunk in chunks:
            with undisturbed():
                waiting.append(pool.submit(check_chunk, chunk))
            if len(waiting) > 4 * jobs:
                yield result(waiting.popleft())
        while waiting:
            yield result(waiting.popleft())
        over = True
    except concurrent.futures.process.BrokenProcessPool:
        raise Unusable("a worker process died; nothing was verified") from None
    finally:
        if not over:                        # what the workers still do is of no use to anybody
            stopper.send_bytes(b"stop")
        with undisturbed():
            pool.shutdown(cancel_futures=True)
        stop.close()
        stopper.close()
