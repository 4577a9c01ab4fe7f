"""Rational approximation of one number or of a pair: thesis, Appendix A; Kim and Ostlund.

All is exact.  Which half of an interval or a triangle a point lies in is decided by the sign of an
integer or a Fraction, and a point on the cut counts as lying to the right; a double, which could
decide otherwise, is refused.
"""

from typing import NamedTuple

from converse.model.exact import exact
from converse.storage.files import plain
from converse.tori.nearest import triangles


class Mediant(NamedTuple):
    """A rational number or vector p/q; the type (p, q) of a state is made of its first two."""
    p: tuple
    q: int
    address: str                        # the turns, l or r, that led to it


def tree(w):
    """The Mediants of the intervals of the Farey tree that contain w: the first is (1)/2, the last
    w itself."""
    w = exact(w)
    if not 0 < w < 1:
        raise ValueError("%s: is not between 0 and 1" % w)
    left, right, address = (0, 1), (1, 1), ""
    while True:
        p, q = middle = _sum(left, right)
        yield Mediant((p,), q, address)
        if p == w * q:
            return
        if p < w * q:
            left, address = middle, address + "r"
        else:
            right, address = middle, address + "l"


def _sum(a, b):
    return tuple(x + y for x, y in zip(a, b))


def triangle(w):
    """The Mediants of the Farey triangles that contain the vector w: the first is (1, 1)/2, the
    last w itself, if the triangles ever meet it."""
    try:
        w0, w1 = w
    except (TypeError, ValueError):
        raise ValueError("%s: is no vector; give two numbers" % plain(repr(w))) from None
    w0, w1 = exact(w0), exact(w1)
    if not (0 <= w0 <= 1 and 0 <= w1 <= 1) or {w0, w1} <= {0, 1}:
        raise ValueError("(%s, %s): is not in the unit square, or is one of its corners" % (w0, w1))
    for (a, _, c), address in triangles(w0, w1):
        p0, p1, q = _sum(a, c)
        yield Mediant((p0, p1), q, address)
        if (p0, p1) == (w0 * q, w1 * q):
            return
