"""The backup: a file that is kept up to date with a proof while it is found."""

import contextlib
import time
import warnings

from . import files
from .files import ConverseError
from .proof import Proof

SECONDS = 1.0                       # between two writes
SHARE = 20                          # of the time, at most one part in so many goes into them


class Keeper:
    """Keeps path up to date; with None it keeps nothing.

    The file must be new, or empty, or that of the run which is continued: nothing is overwritten.
    ConverseError: it is not, or cannot be written, or another run writes it."""

    def __init__(self, path, resumed=None):
        self.path, self.resumed = path, resumed
        self.due, self.pause = 0.0, SECONDS
        self.lock = contextlib.ExitStack()

    def __enter__(self):
        path = self.path
        if path is not None:
            files.check_writable(path, regular=True)
            self.lock.enter_context(files.lock(path))
            try:
                files.check_new(path, self.resumed)
            except ConverseError:
                self.lock.close()
                raise
        return self

    def __exit__(self, *_):
        self.lock.close()

    def keep(self, snapshot):
        """Writes what snapshot() returns, if it is time; what goes wrong is tried again later."""
        if self.path is None or time.monotonic() < self.due:
            return
        now = time.monotonic()
        try:
            snapshot().save(self.path)
        except (ConverseError, MemoryError) as error:
            if self.due == 0.0:         # nothing is lost yet
                self.path = None
                raise
            warnings.warn("%s; the run goes on and tries again" % _words(error), RuntimeWarning,
                          stacklevel=2)
        self.pause = max(SECONDS, SHARE * (time.monotonic() - now))
        self.due = time.monotonic() + self.pause

    def finish(self, proof: Proof) -> str:
        """Writes the end of a run; returns the SHA-256 of the file, "" if there is none."""
        if self.path is None:
            return ""
        try:
            return proof.save(self.path)
        except (ConverseError, MemoryError) as error:
            warnings.warn("%s; this run is not saved" % _words(error), RuntimeWarning,
                          stacklevel=2)
            return ""


def _words(error):
    return str(error) or "there is not enough memory"
