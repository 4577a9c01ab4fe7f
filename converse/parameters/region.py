"""Regions of parameter space, in polar form, and their cells.

A face is a set of directions d(s) = d_0 + s d_1, 0 <= s <= 1, and all (a, b, c) = r d(s) with
0 <= r <= radius.  A cell is a rectangle of (r, s): along each of them a slice of equal slices,
2^cuts in number.  A region is one or two faces that meet along an edge.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Tuple

RADIUS = 2          # Beyond it Mather's criterion, B > 10/3, holds in all directions.

A, B, C = (1, 0, 0), (0, 1, 0), (0, 0, 1)
REGIONS = {                             # by name, d_0 and d_1 of each face
    "b=0": ((A, C), (C, A)),
    "a=b": (((1, 1, 0), C), (C, (1, 1, 0))),
    "c=0": ((A, B),),
}


@dataclass(frozen=True)
class Cell:
    """A rectangle of (r, s).

    Attributes
    ----------
    face
        The number of the face in its region, from 0.
    low, high
        The lower and the upper ends of r and s.
    """

    face: int
    low: Tuple[Fraction, ...]
    high: Tuple[Fraction, ...]

    @property
    def middle(self) -> Tuple[Fraction, ...]:
        """r and s in the middle."""
        return tuple((low + high) / 2 for low, high in zip(self.low, self.high))

    def halves(self, axis: int) -> "Tuple[Cell, Cell]":
        """The lower and the upper half across an axis.

        Parameters
        ----------
        axis
            0: r is cut; 1: s is cut.
        """
        middle = self.middle[axis]
        return (Cell(self.face, self.low, self.high[:axis] + (middle,) + self.high[axis + 1:]),
                Cell(self.face, self.low[:axis] + (middle,) + self.low[axis + 1:], self.high))


def root(face):
    """All of a face."""
    return Cell(face, (Fraction(0), Fraction(0)), (Fraction(RADIUS), Fraction(1)))


def direction(directions, s):
    """d(s), exactly."""
    return tuple(x + s * y for x, y in zip(*directions))


def patch(directions, cell):
    """The amplitudes (a, b, c) in the middle of a set of parameters that holds the cell, and what
    each of two parameters from -1 to 1 adds at its upper end.

    r d(s) = r d(sm) + r (s - sm) d_1, and r is at most the r of the cell's outer end.
    """
    (r0, s0), (r1, s1) = cell.low, cell.high
    middle = direction(directions, cell.middle[1])
    parts = (tuple((r1 - r0) / 2 * d for d in middle),
             tuple(r1 * (s1 - s0) / 2 * d for d in directions[1]))
    return tuple((r0 + r1) / 2 * d for d in middle), parts
