"""The precision of python-flint's balls, which is one number for all threads of a process."""

import os
import threading
from contextlib import contextmanager
from typing import Iterator

from flint import ctx

_turn = threading.RLock()       # held by the one thread that computes with balls


def _fresh():
    global _turn
    _turn = threading.RLock()


os.register_at_fork(after_in_child=_fresh)      # the thread that held the lock is not in the child


@contextmanager
def precision(bits: int = 53) -> Iterator[None]:
    """A context in which balls have midpoints of `bits` bits, and no other thread of the program
    computes with balls.  At its end the earlier precision is restored.

    Balls are right at any precision, but with fewer bits they are wider: what is proved must not
    depend on what other threads prove, nor on what the user has set.  The context may be entered
    inside itself."""
    with _turn:
        before = ctx.prec
        try:
            ctx.prec = bits
            yield
        finally:
            ctx.prec = before
