"""The tree of cuts, its counts, and the mirror images of the leaves that are skipped.

A cell (index, cuts) is slice index[k] of the 2^cuts[k] equal slices of the region along each of
the axes k.  Cutting a cell replaces it by its two halves, so the leaves of a complete tree tile the
region exactly.
"""

import itertools
from array import array

from .claim import ANGLE_AXES, AXES, DIAGONALS, IDENTITY, LETTERS
from .failures import NotConfirmed, Rejected, named
from .limits import MAX_CUTS

ROOT = (0,) * len(AXES), (0,) * len(AXES)
GO_ON = "; converse -r FILE goes on with the search"


def changed(values, axis, value):
    return values[:axis] + (value,) + values[axis + 1:]


def leaves(tree, axes=AXES, kinds="PSU"):
    """Yields (position, cell) for each leaf, in preorder; Rejected if it is not a whole tree."""
    pending = [((0,) * len(axes),) * 2]
    for at, node in enumerate(tree):
        if not pending:
            raise Rejected("the tree ends before its text does, at node %d" % at)
        index, cuts = cell = pending.pop()
        axis = axes.find(node)
        if axis >= 0:
            cuts = changed(cuts, axis, cuts[axis] + 1)
            pending += ((changed(index, axis, 2 * index[axis] + upper), cuts) for upper in (1, 0))
        elif node in kinds:
            yield at, cell
        else:
            raise Rejected("%a is not a node of a finished tree%s, at node %d%s" % (
                node, " nor a later part" * (node in LETTERS), at, GO_ON * (node == "?")))
        if sum(cuts) > MAX_CUTS:
            raise NotConfirmed("node %d lies below %d cuts, the checker's limit" % (at, MAX_CUTS))
    if pending:                         # what is written of a map is whole
        raise Rejected("the tree is incomplete: %d of its parts are missing%s" % (
            len(pending), GO_ON * (axes == AXES)))


def trees(claim):
    """The claims of a proof file and of its parts a, b, ..., each with the letters of the parts
    that its leaves may be linked to."""
    return [(part, LETTERS[n:len(claim.parts)]) for n, part in enumerate((claim, *claim.parts))]


def tree_counts(claim, letters=""):
    """Counts the nodes of the tree; Rejected, if it is not whole and decided."""
    total = most_cuts = deepest = 0
    known = {*ANGLE_AXES[:len(claim.half)], *range(2, 2 + claim.parameters)}
    if wrong := [claim.tree.index(letter) for axis, letter in enumerate(AXES)
                 if axis not in known and letter in claim.tree]:
        raise Rejected("the tree cuts an angle or a parameter that there is not, at node %d"
                       % min(wrong))
    for position, (_, cuts) in leaves(claim.tree, kinds="PSU" + letters):
        total, depth, kind = total + 1, sum(cuts), claim.tree[position]
        if kind == "U":
            raise Rejected("leaf %d is undecided: the file claims no theorem" % total)
        deepest, most_cuts = max(deepest, depth), max(most_cuts, depth if kind == "P" else 0)
    return {"cuts": total - 1, "proved": claim.tree.count("P"),
            "symmetric": claim.tree.count("S"), "undecided": 0, "most_cuts": most_cuts,
            "depth": deepest, "linked": sum(map(claim.tree.count, letters))}


def check_tree(claim):
    """Checks the trees of a claim against the header, and gives each part its own counts.

    Parameters
    ----------
    claim : Claim

    Raises
    ------
    Rejected
        The file is not meant as a proof, a tree is not whole or not decided, the header's counts
        are not the trees' counts, or no leaf is linked to a part.
    """
    if claim.header["kind"] != "sound":
        raise Rejected("the file's kind is not 'sound': it is not meant as a proof")
    if not {"xstar", "B"} <= claim.header.keys():
        raise Rejected("the search had not begun when it was left; converse -r FILE begins it")
    found = []
    for part, letters in trees(claim):
        with named(part.where):
            found.append(tree_counts(part, letters))
    if max([counts["depth"] for counts in found]) > claim.counts["depth"]:
        raise Rejected("a leaf was cut more often than the depth allows")
    for name in claim.counts.keys() - {"depth"}:
        value = (max if name == "most_cuts" else sum)([counts[name] for counts in found])
        if claim.counts[name] != value:
            raise Rejected("the header's %s is %d, the tree's %d"
                           % (name, claim.counts[name], value))
    for letter in LETTERS[:len(claim.parts)]:
        if not any(letter in part.tree for part, _ in trees(claim)):
            raise Rejected("no leaf is linked to part " + letter)
    for (part, _), counts in zip(trees(claim), found):
        part.counts.update(counts)


def coefficients(waves, at=None, order=None):
    """V as the coefficients of sin(k.y + pi phase), k0 > 0 or k0 = 0 < k1, 0 <= phase < 1, in the
    middle and of each parameter; the coordinates at and at + 1 exchanged, the parameters in another
    order."""
    found = {}
    for wave in waves:
        k, phase = wave.k, wave.phase
        if at is not None:
            k = k[:at] + (k[at + 1], k[at]) + k[at + 2:]
        if k < (0,) * len(k):                   # sin(x) = sin(pi - x)
            k, phase = tuple([-x for x in k]), 1 - phase
        sign = -1 if phase // 1 % 2 else 1      # sin(x + pi) = -sin(x)
        parts = [wave.parts[m] for m in order] if order else wave.parts
        key = k, phase % 1
        found[key] = [old + sign * new for old, new in
                      zip(found.get(key, [0] * (1 + len(parts))), (wave.middle, *parts))]
    return {key: value for key, value in found.items() if any(value)}


def exchange_orders(claim, at=0):
    """The orders of the parameters in which the potential with its coordinates at and at + 1
    exchanged, t'[m] = t[order[m]], is the potential, and the shifts are the same; none, if the
    components of x* are not equal or a coordinate is alone."""
    if len(set(claim.xstar)) > 1 or claim.alone is not None:
        return []
    # V(sigma y; t) = V(y; t'):  the part of t[order[m]] is, exchanged, that of t'[m].
    return [order for order in itertools.permutations(range(claim.parameters))
            if coefficients(claim.waves, at, order) == coefficients(claim.waves)
            and all(s == claim.shifts[m] for s, m in zip(claim.shifts, order))]


def folds(claim):
    """Is the region proved with its mirror image, in which v1 has the other sign: step (C28)?"""
    return (claim.frame == DIAGONALS[2] and abs(claim.centre[1]) <= claim.half[1]
            and not any(s1 for _, s1 in claim.shifts) and exchange_orders(claim) != [])


class Mirror:
    """The exchange of the two coordinates: may a leaf be skipped for the sake of its mirror image?

    It maps the graphs of V to those of V with its coordinates exchanged.  Where this is V for
    parameters in another order, t'[m] = t[order[m]], the orbits from x* to a cell are mapped to
    those from the image of x* to the image of the cell, with its parameters in that order.
    """

    def __init__(self, claim):
        v0, v1, *_ = zip(claim.centre, claim.half)
        fits = v0 == v1 and claim.frame == IDENTITY and not claim.shifts
        self.orders = exchange_orders(claim) if fits else []    # of the parameters
        self.tree = claim.tree
        self.upper = array("i", [0]) * len(self.tree)       # where a node's upper half begins
        unfinished = []                                     # nodes whose lower half goes on
        for position, node in enumerate(self.tree):
            if node in AXES:
                unfinished.append(position)
            elif unfinished:
                self.upper[unfinished.pop()] = position + 1

    def refusal(self, cell):
        """Why the symmetric leaf may not be skipped, or None if its mirror image is proved."""
        if not self.orders:
            return "is skipped, but the problem is not symmetric"
        slices = tuple(zip(*cell))
        for order in self.orders:
            image = slices[1], slices[0], *[slices[2 + m] for m in order]
            if self.is_proved(image + slices[len(image):]):
                return None
        return "is skipped, but its mirror image is not proved"

    def is_proved(self, image):
        """Is every leaf P that overlaps these slices?"""
        todo = [(0, image)]                 # a node, and the image's cell within that node
        while todo:
            position, image = todo.pop()
            node, lower = self.tree[position], position + 1
            if node == "P":
                continue
            axis = AXES.find(node)
            if axis < 0:
                return False
            halves = lower, self.upper[position]
            index, cuts = image[axis]
            if cuts == 0:                                   # the image has both halves
                todo += [(half, image) for half in halves]
            else:
                rest = index & (1 << cuts - 1) - 1, cuts - 1
                todo.append((halves[index >> cuts - 1], changed(image, axis, rest)))
        return True


def check_mirror_images(claim):
    """Rejected, if a leaf is skipped by symmetry that may not be."""
    for part, letters in trees(claim):
        if "S" not in part.tree:
            continue
        mirror = Mirror(part)
        for position, cell in leaves(part.tree, kinds="PS" + letters):
            if part.tree[position] == "S" and (why := mirror.refusal(cell)):
                before = part.tree.count("S", 0, position)
                raise Rejected(leaf_text(part, "S", before, cell) + " " + why)


def leaf_text(claim, kind, ordinal, cell):
    """Names a leaf by its part, its number among leaves of its kind, its depth and its place."""

    def sides(ends):
        return " x ".join(["[%.9g, %.9g]" % (x - h, x + h) for x, h in ends])

    return "%s%s leaf %d of %d (v in %s pi%s, amplitudes in %s, %d cuts)" % (
        claim.where and claim.where + ": ",
        {"P": "proved", "S": "symmetric"}.get(kind, "linked"), ordinal + 1, claim.tree.count(kind),
        sides([(x, along[n]) for n, (x, along) in enumerate(claim.box(cell))]),
        " at the parameters' middle" if claim.shifts else "",
        sides([wave.over(cell) for wave in claim.waves]), sum(cell[1]))
