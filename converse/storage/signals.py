"""Signals end a run by KeyboardInterrupt, but never inside the locks of concurrent.futures.

Python runs the handler of a signal between any two steps of the main thread.  An exception that it
raises inside concurrent.futures can leave the lock of a future held: then the worker that is to
fill this future waits for the lock, and the program waits for the worker.  So everything that takes
these locks happens inside postponed(), and the signal is raised at its end.

Blocking signals by pthread_sigmask would not do: the mask is that of one thread, another thread
receives the signal, and Python runs the handler in the main thread all the same."""

import signal
import threading
from typing import List

ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
          if hasattr(signal, name)]

_depth = 0                              # of postponed(), in the main thread
_heard: List[int] = []                  # numbers of the signals since interruptible() began
_due = False                            # the first of them is yet to be raised


def _interrupt(number, frame):
    """The handler.  Only the first signal counts: a second one would strike while the backup is
    saved."""
    global _due
    _heard.append(number)
    if len(_heard) == 1:
        _due = True
        while frame is not None and frame.f_code.co_filename != _interrupt.__code__.co_filename:
            frame = frame.f_back
        if frame is None:               # else __enter__ or __exit__ below sees to it
            _raise_if_due()


def _raise_if_due():
    global _due
    if _due and not _depth:
        _due = False
        raise KeyboardInterrupt


def _in_main_thread():
    return threading.current_thread() is threading.main_thread()


class interruptible:
    """A context in which these signals raise KeyboardInterrupt, unless they are ignored or have a
    handler other than Python's own; only the first of all counts.  As a variable it is the list of
    those that came.  Inside another interruptible() it changes nothing, nor in another thread than
    the main one, which alone receives signals.

    at_end: the process ends after this: once a signal came, the others are ignored for good."""

    def __init__(self, numbers=(signal.SIGINT,), at_end=False):
        self.numbers, self.at_end, self.before = numbers, at_end, {}

    def __enter__(self):
        global _due
        try:
            for number in self.numbers if _in_main_thread() else ():
                handler = signal.getsignal(number)
                if handler in (signal.SIG_DFL, signal.default_int_handler):
                    if not self.before:
                        _heard.clear()
                        _due = False
                    self.before[number] = handler
                    signal.signal(number, _interrupt)
            _raise_if_due()
        except BaseException:
            self._restore()
            raise
        return _heard

    def __exit__(self, *_):
        self._restore()
        if self.before:
            _raise_if_due()

    def _restore(self):
        for number, handler in self.before.items():
            signal.signal(number, signal.SIG_IGN if self.at_end and _heard else handler)


class postponed:
    """A context, which should be short, at whose end a signal of interruptible() is raised that
    came meanwhile."""

    def __enter__(self):
        global _depth
        self.counted = _in_main_thread()
        if self.counted:
            _depth += 1

    def __exit__(self, *_):
        global _depth
        if self.counted:
            _depth -= 1
            _raise_if_due()
