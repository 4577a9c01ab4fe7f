"""Signals end a run by KeyboardInterrupt, but not inside the locks of an executor.

Python runs a signal's handler between any two steps of the main thread.  An exception that it
raises inside concurrent.futures can leave the lock of a future held for ever, and then the worker
that is to fill that future waits for ever, and whoever waits for the worker.  So whatever takes
these locks is done inside postponed()."""

import contextlib
import signal
import threading
from typing import List

ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
          if hasattr(signal, name)]

_depth = 0                              # of postponed(), in the main thread
_heard: List[int] = []                 # numbers of the signals since interruptible() began
_due = False                            # one of them waits for the end of postponed()


def _interrupt(number, _):
    """The first signal counts: another would strike while the backup is saved."""
    global _due
    _heard.append(number)
    if len(_heard) > 1:
        return
    if _depth:
        _due = True
    else:
        raise KeyboardInterrupt


@contextlib.contextmanager
def interruptible(numbers=(signal.SIGINT,), at_end=False):
    """Meanwhile these signals raise KeyboardInterrupt, unless they are ignored or already have a
    handler other than Python's own; only the first of all counts.  Yields the list of those that
    came.  Inside another interruptible(), or in another thread than the main one, which alone
    hears of signals, it changes nothing.

    at_end: the process ends after this; once a signal came the others are ignored for good."""
    global _due
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in numbers:
            if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                if not before:
                    _heard.clear()
                    _due = False
                before[number] = signal.signal(number, _interrupt)
    try:
        yield _heard
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if at_end and _heard else handler)


@contextlib.contextmanager
def postponed():
    """Meanwhile a signal of interruptible() waits; keep it short."""
    global _depth, _due
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1
        if _due and not _depth:
            _due = False
            raise KeyboardInterrupt
