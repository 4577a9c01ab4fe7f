"""A file that remembers which leaves are confirmed, so that an interrupted check can go on."""

import contextlib
import functools
import hashlib
import os
import re
import stat
import sys
import time

from .failures import Unusable
from .progress import complain, reason
from .signals import undisturbed

STATE_SECONDS = 10                      # between two writes of the state
STATE = """converse-check state 3
file: sha256 %s
checker: sha256 %s
shard: %d of %d
confirmed: %d
pieces: %d
in doubles: %d
"""


@functools.lru_cache(maxsize=None)
def own_digest():
    """The SHA-256 of the sources of this very checker: of all modules of its package, in a folder
    or in a zip file, or of the one file that they were put together in."""
    import importlib.util  # here, as only a check with a state needs both
    import pkgutil
    sources = [(__loader__, __file__)]
    if __package__:
        specs = [importlib.util.find_spec(__package__ + "." + name) for _, name, _ in
                 pkgutil.iter_modules(sys.modules[__package__].__path__)]
        sources = [(spec.loader, spec.origin) for spec in specs]
    found = hashlib.sha256()
    for loader, path in sources:
        found.update(hashlib.sha256(loader.get_data(path)).digest())
    return found.hexdigest()


def is_shard(i, count):
    """Is it one of count shards, or the sum ("all") of at least one?"""
    return count >= 1 and (i == "all" or 1 <= i <= count)


def state_of(path, sha256, total, shard):
    """The State of a proof file or map with total leaves P.

    shard: (i, n), whose state is the file PATH.i-of-n; or ("all", n), the sum of the states of n
    shards, each of which must be complete; or None."""
    if shard is None:
        return State(path, sha256, total)
    i, count = shard
    if i != "all":
        return State("%s.%d-of-%d" % (path, i, count), sha256, total, shard)
    whole = State(None, sha256, total)
    whole.earlier_runs = "the runs of %d shards" % count
    for i in range(1, count + 1):
        name = "%s.%d-of-%d" % (path, i, count)
        if not os.path.lexists(name):
            raise Unusable("the state %s is missing; run --shard %d/%d" % (name, i, count))
        part = State(name, sha256, total, (i, count))
        if part.confirmed < len(part.leaves):
            raise Unusable("shard %d/%d is not finished (%d of %d leaves); run --shard %d/%d again"
                           % (i, count, part.confirmed, len(part.leaves), i, count))
        whole.advance(part.confirmed, part.pieces, part.doubles)
    return whole


class State:
    """The number of leaves that are confirmed, in their order, of their pieces, and of the leaves
    that were tried in doubles; and, if a path is given, a small file with these numbers.

    The leaves are all leaves P of a proof file or map, or of a shard (i, n): each n-th, beginning
    with the i-th.  The file belongs to one proof file or map, one shard and this very checker.  It
    is believed: its checksum guards against accidents, not against forgers.
    """

    def __init__(self, path, sha256, total, shard=(1, 1)):
        """total: the number of leaves P."""
        self.confirmed = self.pieces = self.doubles = 0
        self.shard, self.earlier_runs = shard, "an earlier run"
        self.leaves = range(shard[0] - 1, total, shard[1])
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
        fields = STATE.replace("%s", "([0-9a-f]{64})").replace("%d", "([0-9]{1,18})")
        match = re.match(fields, text, re.ASCII)
        values = match.groups() if match else ()
        words, found = values[:2], [int(x) for x in values[2:]]
        mine = (*words, *found[:2]) == (sha256, self.checker, *shard)
        if not match or text != self._sealed(*words, *found) \
                or mine and found[2] > len(self.leaves):
            raise Unusable("the state %s is damaged; delete it to begin anew" % path)
        if not mine:
            raise Unusable("the state %s belongs to another %s; name another file" % (
                path, "file" if words[0] != sha256 else "checker" if words[1] != self.checker
                else "shard"))
        self.confirmed, self.pieces, self.doubles = found[2:]

    @staticmethod
    def _sealed(*values):
        text = STATE % values
        return text + "checksum: sha256 %s\n" % hashlib.sha256(text.encode()).hexdigest()

    def _write(self):
        """Replaces the file.  At any time either the older or the newer file is there, whole.

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
                file.write(self._sealed(self.sha256, self.checker, *self.shard, self.confirmed,
                                        self.pieces, self.doubles))
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, self.path)
        except BaseException:
            with contextlib.suppress(OSError):  # it may be in its place already
                os.unlink(name)
            raise

    def advance(self, leaves, pieces, doubles):
        """Adds confirmed leaves, their pieces, and how many of the leaves were tried in doubles."""
        self.confirmed, self.pieces = self.confirmed + leaves, self.pieces + pieces
        self.doubles += doubles
        if self.path and time.monotonic() > self.saved + STATE_SECONDS:
            self.save()

    def save(self):
        """Saves the state.  A failure does not end a check of hours: it is reported, and the next
        save tries again."""
        if self.path:
            try:
                self._write()
            except OSError as error:
                self.saved = time.monotonic()
                complain("the state %s cannot be written (%s); what it says stands, and the check "
                         "goes on" % (self.path, reason(error)))
