"""What was confirmed already, in a file, so that a check that was interrupted can go on."""

import contextlib
import hashlib
import importlib.util
import os
import pkgutil
import re
import stat
import sys
import time

from .failures import Unusable, complain, reason
from .signals import undisturbed

STATE_SECONDS = 10                      # between two writes of the state
STATE = """converse-check state 2
file: sha256 %s
checker: sha256 %s
confirmed: %d
pieces: %d
"""


def own_digest():
    """The SHA-256 of the sources of this very checker: of all modules of its package, in a folder
    or in a zip file, or of the one file that they were put together in."""
    sources = [(__loader__, __file__)]
    if __package__:
        specs = [importlib.util.find_spec(__package__ + "." + name) for _, name, _ in
                 pkgutil.iter_modules(sys.modules[__package__].__path__)]
        sources = [(spec.loader, spec.origin) for spec in specs]
    found = hashlib.sha256()
    for loader, path in sources:
        found.update(hashlib.sha256(loader.get_data(path)).digest())
    return found.hexdigest()


class State:
    """How many of the proved leaves of a proof file or map are confirmed, in their order; and if a
    path is given, a small file that says so, with which an interrupted check can go on.

    The file belongs to one proof file or map and to this very checker.  It is believed: its
    checksum guards against accidents, not against forgers.
    """

    def __init__(self, path, sha256, total):
        self.confirmed = self.pieces = 0
        self.path, self.sha256, self.saved = path and os.path.realpath(path), sha256, 0
        if path is None:
            return
        self.checker = own_digest()
        try:
            if not os.path.lexists(self.path):
                self._write()
                return
            if not stat.S_ISREG(os.stat(self.path).st_mode):
                raise Unusable("the state %s is not a regular file; name another" % path)
            with open(self.path, "rb") as file:
                text = file.read(1000).decode("ascii", "replace")
        except (OSError, ValueError) as error:
            raise Unusable("the state %s cannot be kept (%s); name another file"
                           % (path, reason(error))) from None
        if not text.startswith(STATE.partition("\n")[0]):
            raise Unusable("%s is not a state of this checker; name another file" % path)
        words = re.findall("(?m)^(?:file|checker): sha256 ([0-9a-f]{64})$", text)
        found = [int(n) for n in re.findall("(?m)^(?:confirmed|pieces): ([0-9]{1,18})$", text)]
        if len(words) != 2 or len(found) != 2 or text != self._sealed(*words, *found) \
                or found[0] > total and words[0] == sha256:
            raise Unusable("the state %s is damaged; delete it to begin anew" % path)
        if words != [self.sha256, self.checker]:
            raise Unusable("the state %s belongs to another %s; name another file" % (
                path, "checker" if words[0] == self.sha256 else "file"))
        self.confirmed, self.pieces = found

    @staticmethod
    def _sealed(*values):
        text = STATE % values
        return text + "checksum: sha256 %s\n" % hashlib.sha256(text.encode()).hexdigest()

    def _write(self):
        """The file is whole at any time, the older one or the newer.

        A signal waits meanwhile: if KeyboardInterrupt struck inside file.write on a full disk, the
        OSError of the close() that follows would take its place, and the check would go on."""
        with undisturbed():
            self._write_beside()
        self.saved = time.monotonic()

    def _write_beside(self):
        name = os.path.join(os.path.dirname(self.path), ".converse-check-" + os.urandom(8).hex())
        try:
            handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with open(handle, "w") as file:
                file.write(self._sealed(self.sha256, self.checker, self.confirmed, self.pieces))
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, self.path)
        except BaseException:
            with contextlib.suppress(OSError):  # it may be in its place already
                os.unlink(name)
            raise

    def advance(self, leaves, pieces):
        self.confirmed, self.pieces = self.confirmed + leaves, self.pieces + pieces
        if self.path and time.monotonic() > self.saved + STATE_SECONDS:
            self.save()

    def save(self):
        """A failure does not end a check of hours: it is said, and there will be another time."""
        if self.path:
            try:
                self._write()
            except OSError as error:
                self.saved = time.monotonic()
                complain("the state %s cannot be written (%s); what it says stands, and the check "
                         "goes on" % (self.path, reason(error)))
