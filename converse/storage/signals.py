"""Signals end a run by KeyboardInterrupt, but never inside the locks of concurrent.futures.

Python runs the handler of a signal between any two steps of the main thread.  An exception that it
raises inside concurrent.futures can leave the lock of a future held: then the worker that is to
fill this future waits for the lock, and the program waits for the worker.  So everything that takes
these locks happens inside postponed(), and the signal is raised at its end.

Blocking signals by pthread_sigmask would not do: the mask is that of one thread, another thread
receives the signal, and Python runs the handler in the main thread all the same."""

import signal
import sys
import threading
from typing import List

ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
          if hasattr(signal, name)]

_depth = 0                              # of postponed(), in the main thread
_heard: List[int] = []                  # numbers of the signals since interruptible() began
_due = False                            # must the first of them still be raised?
_hook = sys.unraisablehook              # the hook before interruptible()


def _interrupt(number, frame):
    """The handler.  Only the first signal counts: a second one would strike while the backup is
    saved.  Python may run the handler of another signal between any two calls of this one, so
    everything that decides who is first precedes the first call."""
    global _due
    if not _heard:
        _due = True
    _heard.append(number)
    while frame is not None and frame.f_code.co_filename != _interrupt.__code__.co_filename:
        frame = frame.f_back
    if frame is None:                   # else a Resource's __enter__ or __exit__ raises it
        _raise_if_due()


def _not_passed_on(unraisable):
    """The hook for exceptions that Python cannot pass on, since a weakref's callback or a __del__
    raised them.  If the exception is the signal, it must still be raised."""
    global _due
    if _heard and unraisable.exc_type is KeyboardInterrupt:
        _due = True
    else:
        _hook(unraisable)


def _raise_if_due():
    global _due
    if _due and not _depth:
        _due = False
        raise KeyboardInterrupt


def _in_main_thread():
    return threading.current_thread() is threading.main_thread()


class Resource:
    """A context whose acquire() and release() are whole: a signal of interruptible() that comes
    meanwhile is raised at their end.  They should be short, and release() must also do after an
    acquire() that failed."""

    def acquire(self):
        raise NotImplementedError

    def release(self):
        raise NotImplementedError

    def __enter__(self):
        try:
            self.acquire()
            _raise_if_due()
        except BaseException:
            self.release()
            raise
        return self

    def __exit__(self, *_):
        self.release()
        _raise_if_due()


class interruptible(Resource):
    """A context in which these signals raise KeyboardInterrupt, unless they are ignored or have a
    handler other than Python's own.  Only the first signal of all counts.  The context changes
    nothing inside another interruptible(), and nothing outside the main thread, which alone
    receives signals.

    heard: the numbers of the signals that came.
    at_end: the process ends after this: once a signal came, the others are ignored for good."""

    def __init__(self, numbers=(signal.SIGINT,), at_end=False):
        self.numbers, self.at_end, self.before, self.heard = numbers, at_end, {}, _heard

    def acquire(self):
        global _due, _hook
        for number in self.numbers if _in_main_thread() else ():
            handler = signal.getsignal(number)
            if handler in (signal.SIG_DFL, signal.default_int_handler):
                if not self.before:
                    _heard.clear()
                    _due = False
                    _hook, sys.unraisablehook = sys.unraisablehook, _not_passed_on
                self.before[number] = handler
                signal.signal(number, _interrupt)

    def release(self):
        if self.before:
            sys.unraisablehook = _hook
        # In reverse, so that SIGINT comes last: with Python's own handler back it may strike here.
        for number, handler in reversed(self.before.items()):
            signal.signal(number, signal.SIG_IGN if self.at_end and _heard else handler)


class postponed(Resource):
    """A context, which should be short, that delays signals of interruptible() to its end."""

    counted = False

    def acquire(self):
        global _depth
        if _in_main_thread():
            _depth += 1
            self.counted = True

    def release(self):
        global _depth
        if self.counted:
            _depth -= 1
            self.counted = False
