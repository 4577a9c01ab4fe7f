"""Trees and proof files that tests make up."""

import contextlib
from fractions import Fraction

import numpy as np
from files import sealed

from checker import check

HEAD = """converse proof 6
kind: sound
program: by hand
method: loewner
digits: 0
stubborn: 0
quick_tries: 0
tries: 0
Rtries: 0
HermSuccess: 0
LLSuccess: 0
ll_used: 0
reasons: none
max_steps: 0
max_NTsteps: 0
B: 0
pending: 0
"""


def decimal(x):
    return check.decimal_text(Fraction(x))


def ranged(low, high):
    """The line of a range: its middle and half its width."""
    low, high = Fraction(low), Fraction(high)
    return "%s %s" % (decimal((low + high) / 2), decimal((high - low) / 2))


def proof_file(tree, waves, parts=(), **fields):
    """A proof file, with the counts of its trees unless the fields have others; a field None is
    left out.  parts: of each x*, the lines v0, v1, ... and the tree."""
    trees, most = [tree, *[part[-1] for part in parts]], 0

    def count(kinds):
        return sum(tree.count(kind) for tree in trees for kind in kinds)

    for text in trees:
        with contextlib.suppress(check.Rejected):       # in what is wrong on purpose
            for at, (_, cuts) in check.leaves(text, kinds="PSU?" + check.LETTERS):
                most = max(most, sum(cuts) if text[at] == "P" else 0)
    header = {"odd about": "no", "alone": "no", "at once": "no", "depth": 99, "cuts": count(
        check.AXES), "proved": count("P"), "symmetric": count("S"), "undecided": count("U?"),
        "most_cuts": most, "linked": count(check.LETTERS),
        **{name.replace("_", " "): value for name, value in fields.items()}}
    text = HEAD + "".join("wave: %s\n" % wave for wave in waves) + "".join(
        "%s: %s\n" % item for item in header.items() if item[1] is not None)
    text += "tree:\n%s\n" % tree
    for name, (*lines, tree) in zip(check.LETTERS + "z", parts):
        text += "part: %s\n%stree:\n%s\n" % (name, "".join(
            "%s: %s\n" % line for line in zip(("xstar", *check.ANGLES), lines)), tree)
    return sealed(text)


def claim_of(text):
    return check.content(sealed(text).encode())


def halves(cell, axis):
    index, cuts = cell
    cuts = check.changed(cuts, axis, cuts[axis] + 1)
    return [(check.changed(index, axis, 2 * index[axis] + upper), cuts) for upper in (0, 1)]


def cells_of(cells):
    """As the fast path takes them."""
    return [np.array([cell[part] for cell in cells], np.int64).T for part in (0, 1)]


def found_tree(claim, most):
    """A tree that proves the claim, by the fast path alone and a cut where it says so, in at most
    so many tries."""
    assert check.import_numpy_if_sound()
    criterion, fast = check.Criterion(claim), check.Lockstep([claim])
    nodes, todo = {}, [check.ROOT]
    while todo:
        assert len(nodes) < most
        batch, todo = todo[-256:], todo[:-256]
        l = np.array([check.least_in_double(criterion, cell) for cell in batch])
        excluded, axis = fast.attempt(*cells_of(batch), np.zeros(len(batch), int), l,
                                      check.SITE_PENALTIES[0])
        for cell, good, at in zip(batch, excluded.tolist(), axis.tolist()):
            nodes[cell] = "P" if good else check.AXES[at]
            todo += [] if good else halves(cell, at)
    tree, todo = [], [check.ROOT]
    while todo:
        cell = todo.pop()
        tree.append(nodes[cell])
        if tree[-1] != "P":
            todo += reversed(halves(cell, int(tree[-1])))
    return "".join(tree)
