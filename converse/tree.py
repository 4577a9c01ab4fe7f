"""The tree of a proof as text: one character per prism, in preorder.

0 and 1 are cuts along v0 and v1, and the lower half comes first; the leaves are P (proved),
S (skipped by symmetry) and U (undecided).  A search that stopped early leaves a beginning of
such a text, whose pending prisms count as leaves of the kind ? (untried).
"""

from collections import namedtuple

CUTS = "01"
KINDS = "PSU"
UNTRIED = "?"

Leaf = namedtuple("Leaf", "kind centre half depth")     # centre and half: (v0, v1), units of pi


class TreeError(ValueError):
    """The text is not a tree."""


class Walk:
    """Follows a tree that is still growing; a cell (i, k, j, l) is the i-th of the 2^k slices
    of the region along v0 and the j-th of the 2^l along v1, counted from the lower end."""

    def __init__(self):
        self.pending = [(0, 0, 0, 0)]       # the next one last

    def feed(self, text):
        """Takes more of the text and yields (kind, cell) for each leaf in it."""
        pending = self.pending
        for kind in text:
            if not pending:
                raise TreeError("text follows the end of the tree: %r" % kind)
            cell = pending.pop()
            if kind == "0":
                i, k, j, l = cell
                pending.append((2 * i + 1, k + 1, j, l))
                pending.append((2 * i, k + 1, j, l))
            elif kind == "1":
                i, k, j, l = cell
                pending.append((i, k, 2 * j + 1, l + 1))
                pending.append((i, k, 2 * j, l + 1))
            elif kind in KINDS:
                yield kind, cell
            else:
                raise TreeError("%r is not a node of a tree" % kind)


def cells(text):
    """Yields (kind, cell) for each leaf, the untried ones at the end."""
    walk = Walk()
    yield from walk.feed(text)
    for cell in reversed(walk.pending):
        yield UNTRIED, cell


def prisms(problem):
    """A function from cells to (centre, half), the exact sides (v0, v1) in units of pi."""
    half = {}                               # (axis, cuts) -> half-width
    centre = {}                             # (axis, slice, cuts) -> centre

    def side(axis, i, k):
        if (axis, k) not in half:
            half[axis, k] = problem.half[axis] / (1 << k)
        if (axis, i, k) not in centre:
            centre[axis, i, k] = (problem.centre[axis]
                                  + half[axis, k] * (2 * i + 1 - (1 << k)))
        return centre[axis, i, k], half[axis, k]

    def prism(cell):
        i, k, j, l = cell
        (c0, h0), (c1, h1) = side(3, i, k), side(4, j, l)
        return (c0, c1), (h0, h1)

    return prism


def leaves(problem, text, kinds=KINDS + UNTRIED):
    """Yields a Leaf for each leaf of one of these kinds, with exact numbers."""
    prism = prisms(problem)
    for kind, cell in cells(text):
        if kind in kinds:
            yield Leaf(kind, *prism(cell), cell[1] + cell[3])


def complete(text):
    """Is this a whole tree?  TreeError where it is not even the beginning of one."""
    walk = Walk()
    for _ in walk.feed(text):
        pass
    return not walk.pending
