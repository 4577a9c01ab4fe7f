"""What an unfinished proof is continued with: the same search, or a deeper one."""

from dataclasses import replace
from decimal import Decimal

from ..model.exact import decimal_text
from ..model.problem import NAMES
from ..storage.files import ConverseError
from ..version import __version__
from . import tree


def _as_before(problem, before, differs):
    """The problem, which must be the one of before but for its comments, with the frame and the
    coordinate that were chosen then, unless it names others."""
    for key in NAMES:
        theirs, ours = getattr(before, key), getattr(problem, key)
        if None not in (theirs, ours) and theirs != ours:
            differs(key, *(" .. ".join(map(decimal_text, ends)) for ends in (theirs, ours)))
    if problem.by_ranges != before.by_ranges or not problem.by_ranges and (
            problem.waves, problem.amplitude, problem.parts) != (
            before.waves, before.amplitude, before.parts):
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

    problem, given (some of the fields of Settings by name), xstar: None, or what must agree with
    the proof; but the depth may be greater, and `stubborn` another.
    ConverseError: something does not agree; name is that of the proof in the message."""
    given = given or {}
    settings = replace(proof.settings, **{key: value for key, value in given.items()
                                          if key in ("depth", "stubborn")})

    def differs(what, theirs, ours):
        raise ConverseError("%s: is of another run: its %s is %s, this one's is %s; name the "
                            "backup of this run or start anew" % (name, what, theirs, ours))

    if proof.version != __version__:
        differs("program", proof.version, __version__)
    for key in "method", "digits", "as_printed":
        if key in given and given[key] != getattr(proof.settings, key):
            differs(key.replace("_", " "), getattr(proof.settings, key), given[key])
    if settings.depth < proof.settings.depth:
        differs("depth", proof.settings.depth, settings.depth)
    if problem is not None:
        problem = _as_before(problem, proof.problem, differs)
    if xstar is not None:
        if proof.xstar is not None and list(map(Decimal, proof.xstar)) != list(map(Decimal, xstar)):
            differs("x*", " ".join(proof.xstar), " ".join(xstar))
        proof = replace(proof, xstar=proof.xstar or xstar)
    if "U" in proof.tree and proof.settings.stubborn and not settings.stubborn and \
            settings.depth == proof.settings.depth:
        differs("stubborn", True, False)
    if settings.depth > proof.settings.depth:
        proof = _with_undecided_untried(proof)
    return replace(proof, settings=settings, problem=problem or proof.problem,
                   restored=sum(map(proof.tree.count, "PS")))


def _with_undecided_untried(proof):
    """The proof whose undecided prisms are to be tried again, without hints."""
    hints, known = [], iter(proof.pending)
    for leaf in tree.UNDECIDED_OR_UNTRIED.findall(proof.tree):
        hints.append(next(known, 0) if leaf == tree.UNTRIED else 0)
    return replace(proof, tree=proof.tree.replace("U", tree.UNTRIED), pending=(*hints, *known),
                   counts=replace(proof.counts, undecided=0))
