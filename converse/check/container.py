"""The container of all files: a first line, a header, a body and a checksum."""

import hashlib
import io
import re
from dataclasses import dataclass
from typing import Callable

from .failures import NotConfirmed, Rejected, Unusable
from .limits import MAX_LINE

FIRST_LINE = re.compile(rb"converse (proof|portrait|diagram|torus) ([0-9]{1,9})(\r?)\n")
PROGRAM = re.compile(rb'\bprogram"?: "?converse ([0-9A-Za-z.+-]{1,40})')     # also of a JSON file
PROGRAM_BYTES = 1 << 12                 # of a file, in which it names its program
CHECKSUM = b"checksum: sha256 "
REPEATED = {"wave", "rotation", "parameter", "comment", "seen", "search"}
HINT = re.compile("hint-[a-z0-9-]{1,40}", re.ASCII)     # a field that is ignored
CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f-\x9f]")  # of a terminal; a tab is none


@dataclass(frozen=True)
class Format:
    """The container of a kind of file.

    Attributes
    ----------
    kind, version
        The words of the first line after `converse`.
    name
        What messages call such a file.
    body
        The line `body:` ends the header.
    needed, optional
        The fields of the header.
    read
        read(container) is the content of the file; Failure, if it is wrong.
    """

    kind: str
    version: str
    name: str
    body: str
    needed: set
    optional: set
    read: Callable


@dataclass(frozen=True)
class Container:
    """The parts of a file that is whole.

    Attributes
    ----------
    header
        The value of each field, or the list of values of a field that is REPEATED.
    body
        The bytes between the header and the checksum, a memoryview.
    line
        The number of the first line of the body.
    sha256
        The SHA-256 of the file, uncompressed.
    """

    header: dict
    body: memoryview
    line: int
    sha256: str


def read_container(data, *formats):
    """The content of a file of one of these formats.

    Parameters
    ----------
    data
        The bytes of the file, uncompressed.
    formats
        Each a Format.

    Raises
    ------
    Rejected, NotConfirmed, Unusable
        The file is wrong, exceeds the checker's limits, or is of another kind or release.
    """
    first = FIRST_LINE.match(data)
    form = next((each for each in formats if first and each.kind.encode() == first[1]), None)
    program = PROGRAM.search(data, 0, PROGRAM_BYTES)
    if form is None and (first or not program or data[:1] != b"{"):
        raise Unusable("is not a " + " or ".join([each.name for each in formats]))
    if form is None or first[2] != form.version.encode():
        name, release = form.name if form else "map", program and program[1].decode()
        raise Unusable("is a %s of another version, which %s" % (
            name, "converse %s reads (pip install converse-kam==%s)" % (release, release)
            if program else "another release of converse reads"))
    if first[3]:
        raise Rejected("its lines end in CR LF: it was altered on its way; ask for the original")
    end = data.rfind(b"\n" + CHECKSUM) + 1
    end_line = data[end + len(CHECKSUM):]
    if not end or not re.fullmatch(b"[0-9a-f]{64}\nend\n", end_line):
        raise Rejected("the file does not end with its checksum; it is truncated or altered")
    view = memoryview(data)
    if end_line[:64] != hashlib.sha256(view[:end]).hexdigest().encode():
        raise Rejected("wrong checksum: the file was changed or damaged")
    marker = ("\n%s:\n" % form.body).encode()
    at = data.find(marker, 0, end) + 1
    if not at:
        raise Rejected("there is no line '%s:'" % form.body)
    head = bytes(view[first.end():at])
    return form.read(Container(header_of(head, form), view[at + len(marker) - 1:end],
                               head.count(b"\n") + 3, hashlib.sha256(view).hexdigest()))


def header_of(head, form):
    """The fields of a header, each of them given once, and none of unknown meaning.

    Nothing of it is repeated in a message but the names of fields that are known.
    """
    header, known, file = {}, form.needed | form.optional, io.BytesIO(head)
    for at, line in enumerate(iter(lambda: file.readline(MAX_LINE), b""), 2):
        if len(line) == MAX_LINE:
            raise NotConfirmed("line %d is longer than the checker's limit, %d bytes"
                               % (at, MAX_LINE - 1))
        name, colon, value = line.decode("utf-8", "replace").rstrip("\n").partition(": ")
        if not colon or name not in known and not (form.kind == "torus" and HINT.fullmatch(name)):
            raise Rejected("line %d, in the header, is of unknown meaning" % at)
        if CONTROL.search(value):
            raise Rejected("line %d, in the header, contains a control character" % at)
        if name in REPEATED:
            header.setdefault(name, []).append(value)
        elif name in header:
            raise Rejected("the header gives %s twice" % name)
        else:
            header[name] = value
    if missing := sorted(form.needed - header.keys()):
        raise Rejected("the header lacks %s" % ", ".join(missing))
    return header
