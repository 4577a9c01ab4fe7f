"""Calls in processes of their own: the precision of balls is one for all threads of a process."""

import concurrent.futures.process
import multiprocessing
import os
import signal
import threading
from typing import Any, Callable, Iterator, List

from ..storage.files import ConverseError
from ..storage.signals import ENDING, Resource, postponed

LOOK_SECONDS = 0.1          # between two looks at Ctrl-C


class Processes(Resource):
    """A context in which at most so many processes work at calls.  They end with it, whatever they
    are doing, and with this process."""

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self.futures: List[Any] = []
        self.pool: Any = None

    def acquire(self) -> None:
        """The processes begin with the first call."""
        self.stop, self.stopper = multiprocessing.Pipe(duplex=False)
        self.pool = concurrent.futures.ProcessPoolExecutor(self.jobs, initializer=_begin,
                                                           initargs=(self.stop,))

    def release(self) -> None:
        if self.pool is None:
            return
        if not all(future.done() for future in self.futures):
            self.stopper.send(None)
        self.pool.shutdown(cancel_futures=True)
        self.stop.close()
        self.stopper.close()

    def give(self, call: Callable, *arguments: Any) -> None:
        """Hands out a call, of a function of a module with arguments that can be pickled."""
        try:
            with postponed():
                self.futures.append(self.pool.submit(call, *arguments))
        except concurrent.futures.process.BrokenProcessPool:
            raise _died() from None

    def results(self) -> Iterator[Any]:
        """Of all calls, in their order.  What a call raised is raised; ConverseError: a process
        died."""
        for future in self.futures:
            try:
                while True:
                    with postponed():
                        if concurrent.futures.wait([future], LOOK_SECONDS).done:
                            found = future.result()
                            break
            except concurrent.futures.process.BrokenProcessPool:
                raise _died() from None
            yield found


def _died():
    return ConverseError("a process that worked at a piece died, perhaps for lack of memory; let "
                         "fewer work at a time (jobs)")


def _begin(stop):
    """Starts a process.  Signals are for the parent to notice."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, args=(stop,), daemon=True).start()


def _end_with_parent(stop):
    import multiprocessing.connection
    multiprocessing.connection.wait([stop, multiprocessing.parent_process().sentinel])
    os._exit(1)
