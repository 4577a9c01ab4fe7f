"""Calls in separate processes.

Each process has a separate pipe to its parent and shares no lock or queue with another one, so its
death is seen immediately and disturbs nobody.  Processes are ended by SIGKILL, which always
ends them; they leave nothing behind.  (A ProcessPoolExecutor hangs if a process dies while a queue
is full, or if its processes ignore SIGTERM.)
"""

import os
import signal
import threading

from .signals import SIGNALS

LOOK_SECONDS = 0.1                      # between two looks for a signal
AHEAD = 4                               # results of each process that wait for an earlier one


class ProcessDied(Exception):
    """A process ended while it worked, as by SIGKILL where memory is exhausted."""


class Worker:
    """A process that applies a function to what it is sent."""

    def __init__(self, call):
        import multiprocessing  # here, so that one job works on systems without processes
        self.pipe, end = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=work, args=(call, end), daemon=True)
        self.process.start()
        end.close()                     # the process has the only one, which closes when it dies

    def give(self, item):
        try:
            self.pipe.send(item)
        except OSError:
            raise ProcessDied from None

    def answer(self):
        """(True, what the call returned) or (False, what it raised)."""
        try:
            return self.pipe.recv()
        except (EOFError, OSError):
            raise ProcessDied from None

    def end(self):
        self.process.kill()
        self.process.join()
        self.pipe.close()


def work(call, pipe):
    """The loop of a process.  Signals that a terminal sends to all are left to the parent."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL if number == signal.SIGTERM else signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    threading.Thread(target=end_with_parent, daemon=True).start()
    while True:
        item = pipe.recv()
        try:
            answer = True, call(item)
        except Exception as error:
            answer = False, error
        pipe.send(answer)


def end_with_parent():
    import multiprocessing.connection
    multiprocessing.connection.wait([multiprocessing.parent_process().sentinel])
    os._exit(1)


def in_order(call, items, jobs, undisturbed):
    """Yields call(item) of all items in their order.  `jobs` processes compute one item each at a
    time; few items and results are in memory.

    An exception of a call is raised here; ProcessDied: a process died.  undisturbed() is a context
    in which no signal raises an exception.
    """
    import multiprocessing.connection
    items, workers, idle = iter(items), [], []
    busy, answers = {}, {}              # pipe -> worker and number of the item; number -> answer
    given, due, more = 0, 0, True
    try:
        while more or busy or answers:
            while more and len(busy) < jobs and given < due + AHEAD * jobs:
                try:
                    item = next(items)
                except StopIteration:
                    more = False
                    break
                if not idle:
                    with undisturbed():
                        workers.append(Worker(call))
                    idle.append(workers[-1])
                worker = idle.pop()
                worker.give(item)
                busy[worker.pipe] = worker, given
                given += 1
            if due in answers:
                done, found = answers.pop(due)
                if not done:
                    raise found
                yield found
                due += 1
                continue
            for pipe in multiprocessing.connection.wait(list(busy), LOOK_SECONDS):
                worker, number = busy.pop(pipe)
                answers[number] = worker.answer()
                idle.append(worker)
    finally:
        with undisturbed():
            for worker in workers:
                worker.end()
