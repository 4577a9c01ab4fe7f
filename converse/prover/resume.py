"""What an unfinished result is continued with: the same release, and the same search or a deeper
one."""

from dataclasses import replace

from ..storage.files import ConverseError
from ..version import __version__
from . import tree


def check_release(result, name):
    """ConverseError, if a result cannot be continued, as it is of another release."""
    if result.version != __version__:
        raise ConverseError("%s: is of converse %s; continue it with that release, or start anew"
                            % (name, result.version))


def continued(proof, name, changes):
    """The proof with such changes of its settings, by name, to continue it with.

    ConverseError: it cannot be continued so; the message calls the proof by `name`."""
    proof = _without_unused(proof, name)
    settings = replace(proof.settings, **changes)
    deeper = settings.depth > proof.settings.depth

    def differs(what, theirs, ours):
        raise ConverseError("%s: is of another run (%s: there %s, here %s); name the backup of "
                            "this run or start anew" % (name, what, theirs, ours))

    check_release(proof, name)
    if settings.depth < proof.settings.depth:
        differs("depth", proof.settings.depth, settings.depth)
    if "U" in proof.tree and proof.settings.stubborn and not (settings.stubborn or deeper):
        differs("stubborn", True, False)
    if deeper:
        proof = _with_undecided_untried(proof)
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
