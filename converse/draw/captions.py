"""The words in a figure of a proof: the same in PostScript and by matplotlib."""

import math
import textwrap
from fractions import Fraction

from ..model.exact import short_text
from ..model.problem import IDENTITY, frame_text, wave_text
from ..model.region import nearest
from ..prover import tree

LINKED = "a"                            # stands for all letters
KIND_NAMES = {"P": "proved", "S": "skipped by symmetry", LINKED: "linked to another x*",
              "?": "untried", "U": "undecided"}
STAR = "x*, whose successors these are"
LINE_LENGTH = 78                        # characters of a line of the head, at most
LEAST = 1 / 128                         # of a side: what is not proved is drawn no smaller
CONCLUSIONS = {
    "theorem": "no invariant tori",
    "region": "no invariant tori whose successor of x* lies in this part of the torus",
    "undecided": "undecided whether there are invariant tori",
    "as printed": "every prism decided",
}


def head(proof):
    """The lines that say what is proved: the parameters, exactly, and the conclusion."""
    problem = proof.problem
    low, high = ([short_text(c + sign * h) for c, h in zip(problem.centre[:-2], problem.half)]
                 for sign in (-1, 1))
    names = "abc" if problem.by_ranges else [
        "p of " + wave_text(wave) for wave in problem.waves]
    ranges = ["%s < %s < %s" % (a, name, b) if a != b else "%s = %s" % (name, a)
              for a, name, b in zip(low, names, high)]
    if problem.together:
        ranges = ["(a, b, c) moving together", "from (%s)" % ", ".join(low),
                  "to (%s)" % ", ".join(high)]
    # A range is divided between two lines only where it is too long for one.
    text = (" " if problem.together else ",  ").join(
        part.replace(" ", "\xa0") if len(part) < LINE_LENGTH else part for part in ranges)
    words = [CONCLUSIONS[proof.conclusion]]
    if not problem.by_ranges and any(
            sum(map(bool, part)) > 1 for part in problem.parts):
        words[:0] = ["on a part of this box"]
    if problem.dimension == 1:
        words[-1] = words[-1].replace("invariant tori", "rotational invariant circles")
    if proof.symmetries_used is None and proof.conclusion != "region":
        words.append("a part of the torus only")
    if proof.as_printed:
        words.append("as printed in the thesis, a historical reconstruction: not a proof")
    return [line.replace("\xa0", " ")
            for part in (text, "; ".join(words)) for line in textwrap.wrap(part, LINE_LENGTH)]


def foot(proof):
    """The lines that say by what it was proved, and from which file it was drawn."""
    lines = ["converse %s, method %s, %s" % (proof.version, proof.method, proof.arithmetic)]
    if any(map(proof.tree.count, tree.CUTS[2:])) and not proof.all_decided:
        lines.append("where prisms of several parameters share a place, "
                     "what is not proved lies on top")
    if proof.problem.frame != IDENTITY:
        lines.append("the angles after x* are " + frame_text(proof.problem.frame, "v%d"))
    if proof.symmetries_used:
        lines.append("this region stands for the whole torus by "
                     + " and ".join(proof.symmetries_used))
    if proof.sha256:
        lines.append("proof file: SHA-256 " + proof.sha256)
    return lines


def nodes(proof):
    """The tree that is drawn: that of the proof's x*, with one letter for all."""
    return proof.tree.translate(dict.fromkeys(map(ord, tree.LETTERS), LINKED))


def counts(proof):
    """The number of prisms of each kind that occurs."""
    found = {kind: nodes(proof).count(kind) for kind in KIND_NAMES}
    cuts = sum(map(proof.tree.count, tree.CUTS))
    found["?"] += 1 + cuts - sum(found.values())        # those that are missing at the end
    return {kind: count for kind, count in found.items() if count}


def star(proof):
    """The place of x*, modulo 2 pi, in units of the region's sides; None if it is not in the region
    or not yet chosen."""
    places = []
    if proof.xstar is None:
        return None
    x = [Fraction(text) / Fraction(math.pi) for text in proof.xstar]
    centre, half = proof.problem.centre[-2:], proof.problem.half[-2:]
    for v, middle, side in zip(nearest(proof.problem.frame, x, centre), centre, half):
        if side == 0 or abs(v - middle) > side:
            return None
        places.append(float(((v - middle) / side + 1) / 2))
    return tuple(places)
