"""Trees and the head of the files that tests make up."""

import numpy as np

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
