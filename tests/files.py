"""Files of proofs as text: with the checksum that belongs to them, a field or a tree changed."""

import hashlib
import re


def sealed(file):
    """The text or the bytes, whose last lines are a checksum or which has none, with the right
    one."""
    data = file if isinstance(file, bytes) else file.encode()
    body = data[:data.rindex(b"checksum: ")] if b"checksum: " in data else data
    data = body + b"checksum: sha256 %s\nend\n" % hashlib.sha256(body).hexdigest().encode()
    return data if isinstance(file, bytes) else data.decode()


def with_line(text, name, value, number=0):
    """The text with another value of a field, or of the one of that number if it is repeated."""
    places = [match.span() for match in re.finditer("(?m)^%s: .*$" % re.escape(name), text)]
    start, end = places[number]
    return "%s%s: %s%s" % (text[:start], name, value, text[end:])


def tree_of(text):
    """The first tree of a proof file."""
    return re.split("\npart: |\nchecksum: ", text.partition("\ntree:\n")[2])[0].replace("\n", "")


def one_line(text):
    """Is it one line, which says something and has no traceback?"""
    return bool(text.strip()) and text.strip().count("\n") == 0 and "Traceback" not in text
