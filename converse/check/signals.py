"""Signals: they interrupt a check, but not inside the locks of a pool of processes."""

import contextlib
import signal
import threading

_late = None                            # where signals wait, the number of the one that came
SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
           if hasattr(signal, name)]


@contextlib.contextmanager
def undisturbed():
    """The signal waits, also in a process that is begun meanwhile: an exception that struck inside
    the locks of a pool would leave them broken, or locked for ever."""
    global _late
    _late, before = [], None
    try:
        if hasattr(signal, "pthread_sigmask"):
            before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        yield
    finally:
        try:
            if before is not None:          # the handler may be another one, and raise here
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        finally:
            late, _late = _late, None
        if late:                            # another thread may have taken it in spite of the mask
            raise KeyboardInterrupt(*late)


def interrupt(number, frame):
    """The first signal ends the check, where it may; the end itself is quick and must not be
    interrupted."""
    for heard in SIGNALS:
        signal.signal(heard, signal.SIG_IGN)
    if _late is None:
        raise KeyboardInterrupt(number)
    _late.append(number)


@contextlib.contextmanager
def interruptible(alone):
    """Lets the signals interrupt, but those that are ignored (nohup); only the main thread may.

    Where nothing else is to come in this process (alone), they are left to end it in silence.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    heard = [number for number, handler in before.items() if handler not in (None, signal.SIG_IGN)]
    try:
        for number in heard:
            signal.signal(number, interrupt)
        yield
    finally:
        for number in heard:
            signal.signal(number, signal.SIG_DFL if alone else before[number])
