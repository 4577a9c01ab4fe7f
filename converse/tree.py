"""The tree of a proof as text: one character per prism, in preorder.

0 and 1 are cuts along v0 and v1, 2, 3 and 4 along a, b and c (2 along all of them where they move
together); the lower half comes first.  The leaves are P (proved), S (skipped by symmetry),
U (undecided) and ? (untried); where a text ends too early, untried prisms are missing.
"""

from collections import namedtuple

CUTS = "01234"
UNTRIED = "?"
KINDS = "PSU" + UNTRIED
ROOT = (0,) * 5, (0,) * 5

Leaf = namedtuple("Leaf", "kind centre half depth")     # centre and half: (v0, v1), units of pi


class TreeError(ValueError):
    """The text is not a tree."""


class Walk:
    """Follows a tree that is still growing.  A cell (index, cuts) is slice index[k], counted from
    the lower end, of the 2^cuts[k] equal slices of the region along each of the five axes k."""

    def __init__(self, pending=(ROOT,)):
        self.pending = list(pending)        # the next one last

    def feed(self, text):
        """Takes more of the text and yields (kind, cell) for each leaf in it."""
        pending = self.pending
        for kind in text:
            if not pending:
                raise TreeError("text follows the end of the tree: %r" % kind)
            cell = pending.pop()
            axis = CUTS.find(kind)
            if axis >= 0:
                index, cuts = map(list, cell)
                index[axis] *= 2
                cuts[axis] += 1
                lower = tuple(index)
                index[axis] += 1
                pending.append((tuple(index), tuple(cuts)))
                pending.append((lower, tuple(cuts)))
            elif kind in KINDS:
                yield kind, cell
            else:
                raise TreeError("%r is not a node of a tree" % kind)


def cells(text):
    """Yields (kind, cell) for each leaf, those that are missing at the end."""
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
        (i, j, *_), (k, l, *_) = cell
        (c0, h0), (c1, h1) = side(3, i, k), side(4, j, l)
        return (c0, c1), (h0, h1)

    return prism


def leaves(problem, text, kinds=KINDS):
    """Yields a Leaf for each leaf of one of these kinds, with exact numbers."""
    prism = prisms(problem)
    for kind, cell in cells(text):
        if kind in kinds:
            yield Leaf(kind, *prism(cell), sum(cell[1]))


def above_diagonal(cell):
    """Does the prism lie where v1 >= v0, if both angles have the same range?"""
    (i, j, *_), (k, l, *_) = cell
    return j << k >= i + 1 << l


def complete(text):
    """Is this a whole tree, all of it tried?  TreeError where it is not the beginning of one."""
    open_cells, untried = 1, False
    for kind in text:
        if open_cells == 0:
            raise TreeError("text follows the end of the tree: %r" % kind)
        if kind in CUTS:
            open_cells += 1
        elif kind in KINDS:
            open_cells -= 1
            untried = untried or kind == UNTRIED
        else:
            raise TreeError("%r is not a node of a tree" % kind)
    return open_cells == 0 and not untried
