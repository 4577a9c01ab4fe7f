"""Writing files so that each is complete or as it was before, and locking them."""

import contextlib
import fcntl
import os
import zlib
from typing import Union

from .signals import Resource, postponed

Path = Union[str, "os.PathLike[str]"]


class ConverseError(RuntimeError):
    """Something outside the mathematics went wrong; the text is one plain sentence."""


class WorkersGone(ConverseError):
    """No worker is left to do the work, or none can; the results until then stand."""


class NotSaved(RuntimeWarning):
    """The last results of a run are not in its file; the text says since when, and why."""


def plain(text):
    """The text with control characters, which a terminal would obey, written as escapes."""
    return "".join(c if c.isprintable() or c == "\t" else
                   c.encode("unicode_escape", "surrogatepass").decode("ascii") for c in text)


def check_new(path, resumed=None):
    """ConverseError if a backup would overwrite a file that is neither empty nor `resumed`."""
    if os.path.exists(path) and os.path.getsize(path) and not (
            resumed is not None and same(path, resumed)):
        raise ConverseError("%s: exists; to continue it, resume it (-r of the commands), or else "
                            "name another file or remove it" % path)


def reason(error):
    """An OSError in words."""
    return error.strerror or str(error)


def same(path, other):
    """Do both paths name one file, which need not exist?  other may be a file descriptor."""
    try:
        return os.path.samefile(path, other)
    except OSError:
        return not isinstance(other, int) and os.path.realpath(path) == os.path.realpath(other)


def _beside(path):
    """A name in the same directory that no other file has."""
    return os.path.join(os.path.dirname(path), ".converse-" + os.urandom(8).hex())


def check_name(path):
    """ConverseError if the name of a file is empty."""
    if not os.fspath(path):
        raise ConverseError("the name of a file is empty; give one")


def ending(path):
    """The ending of a file's name, in small letters."""
    return os.path.splitext(path)[1][1:].lower()


def check_writable(path, regular=False):
    """ConverseError if a file cannot be written.  Called before the work starts."""
    check_name(path)
    if os.path.isdir(path):
        raise ConverseError("'%s': is a directory; name a file" % path)
    if os.path.exists(path) and not os.path.isfile(path):
        if regular:
            raise ConverseError("%s: is not a regular file; name one" % path)
        return
    real = os.path.realpath(path)
    if os.path.exists(real) and not os.access(real, os.W_OK):
        raise ConverseError("%s: cannot be written (Permission denied); choose another file" % path)
    try:
        name = _beside(real)
        os.close(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600))
        os.unlink(name)
    except OSError as error:
        raise ConverseError("%s: its directory cannot be written (%s); choose another place"
                            % (path, reason(error))) from None


MADE = {                                # by the ending of its name, how a file of this program
    "svg": (b"<?xml", b"<dc:title>converse "),              # begins, and what it holds
    "png": (b"\x89PNG", b"Software\0converse "), "pdf": (b"%PDF", b"/Creator (converse "),
    "npz": (b"PK", b"converse.npy")}


def check_output(path, what, endings, others=()):
    """Checks, before the work starts, that a figure or a table (`what`) may be written.

    ConverseError: its name has none of the endings, or it is one of the other files of the run, or
    it exists and is neither empty nor made by this program."""
    if any(other is not None and same(path, other) for other in others):
        raise ConverseError("'%s': the %s would overwrite it; name another file" % (path, what))
    kind = ending(path)
    if kind not in endings:
        raise ConverseError("'%s': the name of the %s ends in %s; give it such a name"
                            % (path, what, " or ".join("." + each for each in endings)))
    check_writable(path)
    try:
        with open(path, "rb") as file:
            data = file.read() if os.path.isfile(path) else b""
    except FileNotFoundError:
        return
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name another file"
                            % (path, reason(error))) from None
    head, mark = MADE[kind]
    if data and not (data.startswith(head) and mark in data):
        raise ConverseError("'%s': exists and is not a %s of this program; remove it or name "
                            "another file" % (path, what))


def write(path, data):
    """Writes bytes to a file, all or none: to a new file beside it, which is then renamed.
    ConverseError: the file cannot be written; the older file is unchanged.

    A signal waits meanwhile.  If KeyboardInterrupt struck inside file.write on a full disk, the
    OSError of the close() that follows would replace it, and the run would not stop."""
    with postponed():
        _write(path, data)


def _write(path, data):
    name = None
    try:
        if os.path.exists(path) and not os.path.isfile(path):       # a device or a pipe
            with open(path, "wb") as file:
                file.write(data)
            return
        real = os.path.realpath(path)
        name = _beside(real)
        handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)    # less the umask
        with open(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        with contextlib.suppress(FileNotFoundError):
            os.chmod(name, os.stat(real).st_mode & 0o777)
        os.replace(name, real)
        name = None
    except OSError as error:
        raise ConverseError("%s: cannot be written (%s); the older file, if any, is intact"
                            % (path, reason(error))) from None
    finally:
        if name:
            with contextlib.suppress(OSError):
                os.unlink(name)


def sha256(text):
    """The SHA-256 of a text, in hexadecimal."""
    import hashlib  # for OpenSSL a tenth of a short run, as gzip is
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def write_text(path, text):
    """write() of a text, compressed by gzip if the path ends in .gz; returns the text's SHA-256."""
    data = text.encode("utf-8")
    if os.fspath(path).endswith(".gz"):
        import gzip
        data = gzip.compress(data, 6, mtime=0)
    write(path, data)
    return sha256(text)


def read_text(path, what, damaged):
    """The text of a file, compressed or not.  ConverseError: the file cannot be read, and
    the message asks for another `what`; or it is truncated or not text, as `damaged` says."""
    check_name(path)
    try:
        with open(path, "rb") as file:
            data = file.read()
        if data[:2] == b"\x1f\x8b":
            import gzip
            data = gzip.decompress(data)
        return data.decode("utf-8")
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name a readable %s"
                            % (path, reason(error), what)) from None
    except (EOFError, zlib.error, UnicodeDecodeError):
        raise ConverseError("%s%s; use an intact copy or start anew" % (path, damaged)) from None


class Lock(Resource):
    """A context in which no other run writes a file that this one writes again and again.

    ConverseError: another run does, or the lock, a file beside it, cannot be made."""

    def __init__(self, path):
        self.path, self.name = path, os.path.realpath(path) + ".lock"
        self.handle = None

    def acquire(self):
        while self.handle is None:
            self.handle = self._take()

    def release(self):
        if self.handle is not None:
            if self._is_there(self.handle):
                with contextlib.suppress(OSError):
                    os.unlink(self.name)
            os.close(self.handle)
            self.handle = None

    def _take(self):
        """The descriptor of the locked file, or None where its holder has just removed it."""
        try:
            handle = os.open(self.name, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise ConverseError("%s: cannot be written (%s); choose another file"
                                % (self.name, reason(error))) from None
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
            raise ConverseError("%s: another run is writing this file; name another"
                                % self.path) from None
        if os.fstat(handle).st_size:
            os.close(handle)
            raise ConverseError("%s: exists and is not a lock of this program; rename it"
                                % self.name)
        if self._is_there(handle):
            return handle
        os.close(handle)
        return None

    def _is_there(self, handle):
        """Does the name still belong to the file of this handle?"""
        with contextlib.suppress(OSError):
            return os.path.samestat(os.fstat(handle), os.stat(self.name))
        return False
