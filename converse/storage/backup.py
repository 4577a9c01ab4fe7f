"""The backup: a file that is kept up to date with a proof or a map during the search."""

import time
import warnings

from . import files
from .files import ConverseError, NotSaved
from .signals import Resource, postponed

SECONDS = 1.0                       # Between two writes is at least one second,
SHARE = 20                          # and at least 20 times the duration of the last write.


class Backup(Resource):
    """A context that keeps the file `path` up to date; with None it keeps nothing.

    The file must be new, or empty, or `resumed`, the file of the run that is continued.  Other
    files are not overwritten.  ConverseError: the file is another one, cannot be written, or is
    written by another run."""

    def __init__(self, path, resumed=None):
        self.path, self.resumed = path, resumed
        self.due, self.saved = 0.0, None    # when to write; the seconds of the search in the file
        self.failure = ""                   # of the last write
        self.lock = None if path is None else files.Lock(path)

    def acquire(self):
        if self.lock is not None:
            files.check_writable(self.path, regular=True)
            self.lock.acquire()
            files.check_new(self.path, self.resumed)

    def release(self):
        if self.lock is not None:
            self.lock.release()

    def update(self, snapshot):
        """Writes the result of snapshot(), if a write is due.

        A failure of the first write is raised.  The first later failure is a warning, and the
        next write is tried when it is due."""
        if self.path is None or time.monotonic() < self.due:
            return
        now = time.monotonic()
        try:
            self._write(snapshot())
        except (ConverseError, MemoryError) as error:
            if self.due == 0.0:         # the first write: no work is lost yet
                self.path = None
                raise
            if not self.failure:
                warnings.warn("%s; the run goes on and tries again" % _words(error), RuntimeWarning,
                              stacklevel=2)
            self.failure = _words(error)
        self.due = time.monotonic() + max(SECONDS, SHARE * (time.monotonic() - now))

    def finish(self, proof):
        """Writes the result of a run; returns the SHA-256 of the file, "" if there is none.
        NotSaved: a warning that the file could not be written."""
        if self.path is None:
            return ""
        with postponed():               # a signal must not cost the last write
            try:
                return self._write(proof)
            except (ConverseError, MemoryError) as error:
                self.failure = _words(error)
                self.leave()
                return ""

    def leave(self):
        """Leaves the file as it is.  NotSaved: a warning that the last write failed."""
        if self.failure:
            warnings.warn("%s; what was found %sis not saved" % (
                self.failure, "" if self.saved is None else
                "after the first %.2f seconds of the search " % self.saved), NotSaved, stacklevel=3)

    def _write(self, proof):
        sha256 = proof.save(self.path)
        self.failure, self.saved = "", proof.seconds
        return sha256


def _words(error):
    return str(error) or "there is not enough memory"
