"""Files of proofs as text: with the checksum that belongs to them, a field or a tree changed; and
the problem of most of them."""

import hashlib
import re
from fractions import Fraction

from converse import Problem
from converse.model.map import LINE, MuldoonMap


def line(low, high=None, together=True, **region):
    """The thesis's line, a = b = c/2, from one epsilon to another: alone or with all in between."""
    ends = LINE * Fraction(low), LINE * Fraction(high or low)
    made = MuldoonMap(ends, ends, tuple(2 * end for end in ends))
    return Problem(made.tied() if together else made, **region)


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
