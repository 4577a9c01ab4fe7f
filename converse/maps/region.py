"""Regions of parameter space, in polar form, and their cells.

A face is a set of directions d(s) = d_0 + s d_1 (+ t d_2), 0 <= s, t <= 1, and all (a, b, c) =
r d(s) with 0 <= r <= radius.  A cell is a box of (r, s, t): along each of them a slice of equal
slices, 2^cuts in number.  A region is one or two faces that meet along an edge.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Tuple

AXES = "rst"
RADIUS = 2          # from it on Mather's criterion holds in all directions: B > 10/3

A, B, C = (1, 0, 0), (0, 1, 0), (0, 0, 1)
REGIONS = {                             # by name, the directions of the faces
    "b=0": ((A, C), (C, A)),
    "a=b": (((1, 1, 0), C), (C, (1, 1, 0))),
    "c=0": ((A, B),),
    "sphere": ((A, B, C), (C, A, B)),
}


@dataclass(frozen=True)
class Cell:
    """low and high: the ends of r, s (and t), of face number `face` of the region."""

    face: int
    low: Tuple[Fraction, ...]
    high: Tuple[Fraction, ...]

    @property
    def middle(self) -> Tuple[Fraction, ...]:
        return tuple((low + high) / 2 for low, high in zip(self.low, self.high))

    def halves(self, axis: int) -> "Tuple[Cell, Cell]":
        """The lower and the upper half across an axis."""
        middle = self.middle[axis]
        return (Cell(self.face, self.low, self.high[:axis] + (middle,) + self.high[axis + 1:]),
                Cell(self.face, self.low[:axis] + (middle,) + self.low[axis + 1:], self.high))


def root(directions, face):
    """All of a face."""
    count = len(directions)
    return Cell(face, (Fraction(0),) * count, (Fraction(RADIUS),) + (Fraction(1),) * (count - 1))


def direction(directions, place):
    """d(s, t), exactly."""
    origin, *sides = directions
    return tuple(d + sum(x * side[i] for x, side in zip(place, sides))
                 for i, d in enumerate(origin))


def patch(directions, cell):
    """The amplitudes (a, b, c) in the middle of a set of parameters that holds the cell, and what
    each of two or three parameters from -1 to 1 adds at its upper end.

    r d(s, t) = r d(sm, tm) + r (s - sm) d_1 + r (t - tm) d_2, and r is at most that of the cell's
    outer end.
    """
    (r0, *low), (r1, *high) = cell.low, cell.high
    middle = direction(directions, cell.middle[1:])
    parts = [tuple((r1 - r0) / 2 * d for d in middle)]
    parts += [tuple(r1 * (x1 - x0) / 2 * d for d in side)
              for x0, x1, side in zip(low, high, directions[1:])]
    return tuple((r0 + r1) / 2 * d for d in middle), tuple(parts)


def is_outside(directions, cell):
    """Is b >= a in all of a cell of the sphere?  Then it is the mirror image of other cells."""
    if len(directions) < 3:
        return False
    corners = [direction(directions, place) for place in
               ((s, t) for s in (cell.low[1], cell.high[1]) for t in (cell.low[-1], cell.high[-1]))]
    return all(b >= a for a, b, _ in corners)
