"""Trees and proof files that tests make up."""

import contextlib
import re
from fractions import Fraction

import numpy as np
from files import sealed, with_line

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


INPUTS = ("trig272", "trig274", "trig276", "trig278")


def with_field(text, name, value):
    """The text with another value of a field; or, of a proof of the thesis's waves, with another
    centre and half-width of a, b or c, or parameters that move `together` or not."""
    if name in ("a", "b", "c"):
        return with_wave(text, "abc".index(name), value)
    if name == "together":
        return with_parts(text, value == "yes")
    if name == "at once" and value == "yes" and is_together(text):
        value = "upper end"
    return with_line(text, name, value)


def wave_words(text):
    return [line.split(" ") for line in re.findall("(?m)^wave: (.*)$", text)]


def is_together(text):
    """Is there one parameter, with which all waves move?"""
    return {len(words) for words in wave_words(text)} == {5}


def with_wave(text, i, value):
    centre, _, half = value.partition(" ")
    words = wave_words(text)[i]
    parts = [half] if is_together(text) else ["0"] * i + [half] + ["0"] * (2 - i)
    return with_line(text, "wave", " ".join([*words[:3], centre, *parts]), i)


def with_parts(text, together):
    halves = [next((part for part in words[4:] if part != "0"), "0") for words in wave_words(text)]
    once = re.search("(?m)^at once: (.*)$", text).group(1)
    for i, (words, half) in enumerate(zip(wave_words(text), halves)):
        parts = [half] if together else ["0"] * i + [half] + ["0"] * (2 - i)
        text = with_line(text, "wave", " ".join([*words[:4], *parts]), i)
    return text if once == "no" else with_line(text, "at once", "upper end" if together else "yes")


def with_tree(text, tree, counted=True):
    """The text with another tree, and the counts of that tree."""
    head, middle, rest = text.partition("\ntree:\n")
    text = head + middle + tree + "\n" + rest[rest.rindex("checksum"):]
    if counted:
        for name, kinds in (("cuts", check.AXES), ("proved", "P"), ("symmetric", "S"),
                            ("undecided", "U")):
            text = with_field(text, name, sum(map(tree.count, kinds)))
        try:
            text = with_field(text, "most_cuts", max(
                [sum(cuts) for at, (_, cuts) in check.leaves(tree) if tree[at] == "P"] + [0]))
        except check.Failure:
            pass
    return text


def with_parameters(text, *pairs):
    """The text with other centres and half-widths of a, b and c."""
    for name, pair in zip("abc", pairs):
        text = with_field(text, name, " ".join(check.decimal_text(Fraction(x)) for x in pair))
    return text


def above(cell):
    """Does the cell lie above the diagonal of the angles?"""
    (i, j, *_), (k, l, *_) = cell
    return j << k >= i + 1 << l


def built(a, half, depth, text):
    """A proof file whose leaves need orbits; the tree is cut until one attempt settles a leaf."""
    text = with_parameters(text, *((k * Fraction(a), k * Fraction(half)) for k in (1, 1, 2)))
    text = with_tree(with_field(with_field(text, "depth", 99), "most_cuts", depth), "P", False)
    criterion, tree, todo = check.Criterion(claim_of(text)), [], [check.ROOT]
    while todo:
        cell = todo.pop()
        failed = None
        if above(cell):
            tree.append("S")
        elif sum(cell[1]) == depth or not (failed := criterion.attempt(
                criterion.least_pivot(cell), cell, check.SITE_PENALTIES[0])):
            tree.append("P")
        else:
            tree.append("0" if failed[1][-2] > failed[1][-1] else "1")
            todo += reversed(halves(cell, int(tree[-1])))
    return sealed(with_tree(text, "".join(tree)))


def part_of(text):
    for name in ("v0", "v1"):
        text = with_field(text, name, "1 0.25")
    return sealed(text)
