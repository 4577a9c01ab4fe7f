"""Calls in separate processes.

Each process is a new Python that imports the module of the call, and nothing of the program that
started it: its main module may have no guard, and a fork would copy locks that its threads hold.
Each process has separate pipes to its parent and shares no lock or queue with another one, so its
death is seen immediately and disturbs nobody.  Processes are ended by SIGKILL, which always
ends them; they leave nothing behind.  (A ProcessPoolExecutor hangs if a process dies while a queue
is full, or if its processes ignore SIGTERM.)
"""

import contextlib
import os
import pickle
import queue
import signal
import sys
import threading

from .failures import Unusable
from .signals import SIGNALS, undisturbed

LOOK_SECONDS = 0.1                      # between two looks for a signal
AHEAD = 4                               # results of each process that wait for an earlier one
START = "import sys; sys.path[:] = sys.argv[1:]; from %s import work; work()" % __name__


class ProcessDied(Exception):
    """A process ended before it answered, as by SIGKILL where memory is exhausted."""


class Worker:
    """A process that applies a function to items, and the thread that talks to it.

    call -- the function.
    items -- the queue of (number, item) of all workers; None ends a thread.
    answers -- the queue for (number, True, what the call returned), (number, False, what it
        raised), and (None, False, why the process answers no more)."""

    def __init__(self, call, items, answers):
        import subprocess  # here, so that one job works on systems without processes
        self.call, self.items, self.answers = call, items, answers
        path = [each for each in sys.path if isinstance(each, str)]
        try:
            self.process = subprocess.Popen(
                [sys.executable or "", "-c", START, *path],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            self.thread = threading.Thread(target=self.talk, daemon=True)
            self.thread.start()
        except (OSError, RuntimeError):     # There is no such program, no memory or no thread.
            raise ProcessDied from None

    def talk(self):
        try:
            self.send(self.call)
            while (task := self.items.get()) is not None:
                number, item = task
                self.send(item)
                self.answers.put((number, *pickle.load(self.process.stdout)))
        except (EOFError, OSError, pickle.UnpicklingError):
            self.answers.put((None, False, ProcessDied()))
        except Exception as error:              # of pickle
            self.answers.put((None, False, error))

    def send(self, item):
        self.process.stdin.write(pickle.dumps(item))
        self.process.stdin.flush()

    def kill(self):
        """Also lets a thread end: the next that asks for an item."""
        self.process.kill()
        self.items.put(None)

    def join(self):
        """After all workers were killed."""
        self.thread.join()
        with contextlib.suppress(OSError), self.process:    # Something may not have been sent.
            pass


def work():
    """The loop of a process.  Signals that a terminal sends to all are left to the parent."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL if number == signal.SIGTERM else signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)                       # whatever a call prints is no answer
    given = queue.SimpleQueue()
    threading.Thread(target=listen, args=(given,), daemon=True).start()
    call = given.get()
    while True:
        item = given.get()
        try:
            answer = True, call(item)
        except Exception as error:
            answer = False, error
        answers.write(pickle.dumps(answer))
        answers.flush()


def listen(given):
    """Takes what the parent sends; ends the process with the parent, also in the midst of a call.
    """
    try:
        while True:
            given.put(pickle.load(sys.stdin.buffer))
    finally:
        os._exit(1)


def in_order(call, items, jobs, undisturbed):
    """Yields call(item) of all items in their order.  `jobs` processes compute one item each at a
    time; few items and results are in memory.

    The call, the items and the results go through pickle.  An exception of a call is raised here;
    ProcessDied: a process died.  undisturbed() is a context in which no signal raises an exception.
    """
    items, workers, answers = iter(items), [], {}           # number -> answer
    given, found = queue.SimpleQueue(), queue.SimpleQueue()
    taken, due, more = 0, 0, True
    try:
        while more or due < taken:
            busy = taken - due - len(answers)
            if more and busy < jobs and taken < due + AHEAD * jobs:
                try:
                    item = next(items)
                except StopIteration:
                    more = False
                    continue
                if busy == len(workers):
                    with undisturbed():
                        workers.append(Worker(call, given, found))
                given.put((taken, item))
                taken += 1
            elif due in answers:
                done, answer = answers.pop(due)
                if not done:
                    raise answer
                yield answer
                due += 1
            else:
                with contextlib.suppress(queue.Empty):
                    number, *answers[number] = found.get(timeout=LOOK_SECONDS)
                    if None in answers:         # sooner than what the others still compute
                        raise answers[None][1]
    finally:
        with undisturbed():
            for worker in workers:
                worker.kill()
            for worker in workers:
                worker.join()


def mapped(call, items, jobs):
    """Yields call(item) of all items in their order, in processes if there are several jobs.

    Unusable: a process died.
    """
    if jobs == 1:
        yield from map(call, items)
        return
    try:
        with contextlib.closing(in_order(call, items, jobs, undisturbed)) as results:
            yield from results
    except ProcessDied:
        raise Unusable("a worker process died, perhaps for lack of memory; nothing was "
                       "verified") from None
