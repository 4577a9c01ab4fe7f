"""What an unfinished proof is continued with: the same search, or a deeper one."""

from dataclasses import replace
from decimal import Decimal

from ..model.exact import decimal_text
from ..model.problem import NAMES
from ..storage.files import ConverseError
from ..version import __version__
from . import tree


def _as_before(problem, proof, differs):
    """The problem with the region, the frame and the coordinate of the proof, unless it names
    others.  Except for comments it must be the problem of the proof."""
    before = proof.problem
    if proof.method == "loewner" and problem.full_torus and proof.symmetries_used is not None:
        problem = replace(problem, v0=before.v0, v1=before.v1)
    for key, theirs, ours in zip(NAMES, *((*(each.abc or (None,) * 3), each.v0, each.v1)
                                          for each in (before, problem))):
        if None not in (theirs, ours) and theirs != ours:
            differs(key, *(" .. ".join(map(decimal_text, ends)) for ends in (theirs, ours)))
    if problem.by_ranges != before.by_ranges or not problem.by_ranges and (
            problem.waves, problem.map.enclosed) != (before.waves, before.map.enclosed):
        differs("potential", before, problem)
    if problem.together != before.together:
        differs("together", before.together, problem.together)
    same = replace(problem, **{key: getattr(before, key) for key in ("axes", "alone")
                               if getattr(problem, key) is None})
    for key, what in ("frame", "frame"), ("factor", "coordinate that stands alone"):
        if getattr(same, key) != getattr(before, key):
            differs(what, getattr(before, key), getattr(same, key))
    return same


def continued(proof, name, problem=None, given=None, xstar=None):
    """The proof with the settings to continue it with.

    problem, given (some of the fields of Settings by name), xstar: None, or values that must equal
    the proof's, except that the depth may be greater and `stubborn` may change.
    ConverseError: something does not agree; the message calls the proof by `name`."""
    given = given or {}
    proof = _without_unused(proof, name)
    settings = replace(proof.settings, **{key: value for key, value in given.items()
                                          if key in ("depth", "stubborn")})

    def differs(what, theirs, ours):
        raise ConverseError("%s: is of another run (%s: there %s, here %s); name the backup of "
                            "this run or start anew" % (name, what, theirs, ours))

    if proof.version != __version__:
        differs("program", proof.version, __version__)
    for key in "method", "digits", "as_printed":
        if key in given and given[key] != getattr(proof.settings, key):
            differs(key.replace("_", " "), getattr(proof.settings, key), given[key])
    if settings.depth < proof.settings.depth:
        differs("depth", proof.settings.depth, settings.depth)
    if problem is not None:
        problem = _as_before(problem, proof, differs)
    if xstar is not None:
        if proof.xstar is not None and list(map(Decimal, proof.xstar)) != list(map(Decimal, xstar)):
            differs("x*", " ".join(proof.xstar), " ".join(xstar))
        proof = proof.with_tree(0, xstar=proof.xstar or xstar)
    if "U" in proof.tree and proof.settings.stubborn and not settings.stubborn and \
            settings.depth == proof.settings.depth:
        differs("stubborn", True, False)
    if settings.depth > proof.settings.depth:
        proof = _with_undecided_untried(proof)
    proof = proof.with_tree(0, problem=problem or proof.problem)
    return replace(proof, settings=settings, restored=sum(
        each.text.count(kind) for each in proof.trees for kind in "PS"))


def _without_unused(proof, name):
    """The proof without the parts that nothing is linked to, as when an undecided prism before
    them ended the search.  ConverseError: a letter does not name a later part."""
    try:
        tree.check_letters([each.text for each in proof.trees])
    except tree.TreeError as error:
        raise ConverseError("%s: %s; use an intact copy or start anew" % (name, error)) from None
    used, kept = set(proof.tree), {}
    for letter, part in zip(tree.LETTERS, proof.parts):     # links lead to later parts alone
        if letter in used:
            used |= set(part.text)
            kept[letter] = part
    names = {ord(old): new for old, new in zip(kept, tree.LETTERS)}
    rest = replace(proof, trees=tuple(replace(each, text=each.text.translate(names))
                                      for each in (proof.trees[0], *kept.values())))
    return rest if len(kept) == len(proof.parts) else replace(rest, counts=counted(rest))


def counted(proof):
    """The statistics, nodes being counted in all trees."""
    texts = [each.text for each in proof.trees]
    return replace(proof.counts, **dict(zip(tree.NODES, map(sum, zip(*map(tree.count, texts))))),
                   most_cuts=max(map(tree.most_cuts, texts)))


def _with_undecided_untried(proof):
    """The proof whose undecided prisms are to be tried again, without hints."""
    def again(each):
        hints, known = [], iter(each.pending)
        for leaf in tree.UNDECIDED_OR_UNTRIED.findall(each.text):
            hints.append(next(known, 0) if leaf == tree.UNTRIED else 0)
        return replace(each, text=each.text.replace("U", tree.UNTRIED), pending=(*hints, *known))

    return replace(proof, trees=tuple(map(again, proof.trees)),
                   counts=replace(proof.counts, undecided=0))
