"""Rational approximation of one number or of a pair: thesis, Appendix A; Kim and Ostlund.

All is exact.  Which half of an interval or a triangle a point lies in is decided by the sign of an
integer or a Fraction, and a point on the cut counts as lying to the right; a double, which could
decide otherwise, is refused.
"""

from typing import NamedTuple

from converse.model.exact import exact
from converse.storage.files import plain


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


# Triangles are (A, B, C), the right angle at B; points are triples (p0, p1, q).
LOWER = (1, 0, 1), (0, 0, 1), (0, 1, 1)
UPPER = (1, 0, 1), (1, 1, 1), (0, 1, 1)


def halves(triangle):
    """The two triangles that the mediant of the hypotenuse, their new right angle, cuts a triangle
    into: the left one and the right one."""
    a, b, c = triangle
    middle = _sum(a, c)
    return (b, middle, a), (c, middle, b)


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


def triangles(w0, w1):
    """The Farey triangles that contain a vector of the unit square, each a half of the one before,
    without end: (corners, address)."""
    cell, address = UPPER if w0 + w1 >= 1 else LOWER, ""
    while True:
        yield cell, address
        a, b, c = cell
        middle = _sum(a, c)
        side = determinant(b, middle, (w0, w1, 1)) * determinant(b, middle, c)
        cell = halves(cell)[side >= 0]
        address += "lr"[side >= 0]


def determinant(a, b, c):
    """Of three points; between the points that a triangle of the scheme has it is 1 or -1."""
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
