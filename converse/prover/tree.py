"""The tree of a proof as text: one character per prism, in preorder.

0 and 1 are cuts along v0 and v1, 5 along v2; 2, 3 and 4 along the parameters (a, b and c, or where
they move together 2 along all of them); the lower half comes first.  The leaves are P (proved), S
(skipped by symmetry), a lower-case letter (linked to the part of the proof that it names), U
(undecided) and ? (untried); where a text ends too early, untried prisms are missing.
"""

import re
from array import array
from collections import namedtuple
from fractions import Fraction
from itertools import accumulate, zip_longest
from string import ascii_lowercase

CUTS = "012345"
PARAMETERS, ANGLES = range(2, 5), (0, 1, 5)     # of these
UNTRIED = "?"
LETTERS = ascii_lowercase
KINDS = "PSU" + UNTRIED + LETTERS
UNDECIDED_OR_UNTRIED = re.compile("[U?]")
ROOT = (0,) * len(CUTS), (0,) * len(CUTS)
NODES = "cuts", "proved", "symmetric", "undecided", "linked"    # as native.Counts calls them

# centre and half: (v0, v1, ...), in units of pi, as of prisms()
Leaf = namedtuple("Leaf", "kind centre half depth")


class TreeError(ValueError):
    """The text is not a tree."""


class Walk:
    """Follows a tree that is still growing.  A cell (index, cuts) is slice index[k], counted from
    the lower end, of the 2^cuts[k] equal slices of the region along each of the axes k of CUTS."""

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


def prisms(problem, still=()):
    """A function from cells to (centre, half), the exact sides (v0, v1, ...) in units of pi.

    Where the problem has shifts the prism moves with the parameters: these are the sides of the
    least box that holds it for all parameters of the cell.  still: shifts of something else, from
    which the prism is looked at; only what the problem's shifts differ from these moves."""
    pairs = zip_longest(problem.shifts, still, fillvalue=(0,) * problem.size)
    moves = [tuple(a - b for a, b in zip(*pair)) for pair in pairs]
    moves = list(enumerate(moves, PARAMETERS[0])) if any(map(any, moves)) else []
    sides = list(zip(ANGLES, problem.centre[-problem.size:], problem.half[-problem.size:]))
    known = {}                              # (axis, slice, cuts) -> centre and half-width

    def prism(cell):
        index, cuts = cell
        found = []
        for axis, centre, half in sides:
            i, k = place = index[axis], cuts[axis]
            if (axis, place) not in known:
                width = half / (1 << k)
                known[axis, place] = centre + width * (2 * i + 1 - (1 << k)), width
            found.append(known[axis, place])
        for axis, shifts in moves:
            width = Fraction(1, 1 << cuts[axis])
            t = (2 * index[axis] + 1) * width - 1
            found = [(c + s * t, h + abs(s) * width) for (c, h), s in zip(found, shifts)]
        return tuple(zip(*found))

    return prism


def leaves(problem, text, kinds=KINDS):
    """Yields a Leaf for each leaf of one of these kinds, with exact numbers."""
    prism = prisms(problem)
    for kind, cell in cells(text):
        if kind in kinds:
            yield Leaf(kind, *prism(cell), sum(cell[1]))


_OPENS = bytes(1 if chr(n) in CUTS else 255 if chr(n) in KINDS else 0 for n in range(256))


def complete(text):
    """Is this a complete tree, all of it tried?  TreeError: it is not the beginning of a tree."""
    wrong = text.translate(dict.fromkeys(map(ord, CUTS + KINDS)))
    if wrong:
        raise TreeError("%r is not a node of a tree" % wrong[0])
    opened = array("b", text.encode("ascii").translate(_OPENS))     # 1 for a cut, -1 for a leaf
    balance = sum(opened)
    if min(accumulate(opened[:-1]), default=0) < 0 or balance < -1:
        raise TreeError("text follows the end of the tree")
    return balance == -1 and UNTRIED not in text


def count_linked(text):
    """How many leaves are linked to other starting points."""
    return len(text) - len(text.translate(dict.fromkeys(map(ord, LETTERS))))


def count(text):
    """The numbers of nodes of the kinds NODES."""
    return (sum(map(text.count, CUTS)), *map(text.count, "PSU"), count_linked(text))


def untried(text):
    """How many prisms have a `?`, or are missing at the end."""
    cuts, *leaves = count(text)
    return cuts + 1 - sum(leaves)


def check_letters(texts):
    """TreeError: a leaf is linked to a part that is not there, or not after its own.

    texts: the trees of a proof and of its parts a, b, ..."""
    for n, text in enumerate(texts):
        wrong = set(text) & set(LETTERS) - set(LETTERS[n:len(texts) - 1])
        if wrong:
            raise TreeError("a leaf of %s is linked to %s, which is not a later part" % (
                "part " + LETTERS[n - 1] if n else "the tree", min(wrong)))


def most_cuts(text):
    """The most cuts above a proved leaf, 0 if there is none."""
    pending, most = [0], 0              # the cuts above the nodes that follow
    for node in text:
        cuts = pending.pop()
        if node in CUTS:
            pending += [cuts + 1] * 2
        elif node == "P" and cuts > most:
            most = cuts
    return most
