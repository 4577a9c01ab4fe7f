"""The words in a figure of a proof: what is proved, how, and from which file."""

import math
import textwrap
from fractions import Fraction

from ..model.problem import frame_text, identity
from ..model.region import nearest
from ..model.statement import TORUS, conditions, potential_text
from ..prover import tree

LINKED = "a"                            # stands for all letters
KIND_NAMES = {"P": "proved", "S": "skipped by symmetry", LINKED: "linked to another x*",
              "?": "untried", "U": "undecided"}
STAR = "x*, whose successors these are"
LINE_LENGTH = 78                        # characters of a line of the head, at most
LEAST = 1 / 128                         # of a side: what is not proved is drawn no smaller
CONCLUSIONS = {
    "theorem": "no %s",
    "region": "no %s whose successor of x* lies in this part of the torus",
    "undecided": "undecided whether there is %s",
    "as printed": "every prism decided",
}


def head(proof):
    """The lines that state what is proved: the conclusion, and the parameters, exactly."""
    problem = proof.problem
    torus = TORUS[problem.map.dimension]
    if proof.conclusion == "undecided":
        torus = ("an " if torus[0] == "i" else "a ") + torus
    words = CONCLUSIONS[proof.conclusion]
    words = [words % torus if "%s" in words else words]
    if proof.symmetries_used is None and proof.conclusion != "region":
        words.append("a part of the torus only")
    if proof.as_printed:
        words.append("as printed in the thesis, a historical reconstruction: not a proof")
    text = " ".join(conditions(problem, proof.at_once and proof.no_tori))
    if not problem.by_ranges or problem.parameters:
        text += "; V(y) = " + potential_text(problem)
    # A range is divided between two lines only where it is too long for one.
    text = " ".join(word if len(word) < LINE_LENGTH else word.replace("\xa0", " ")
                    for word in text.split(" "))
    return [line.replace("\xa0", " ") for part in ("; ".join(words), text)
            for line in textwrap.wrap(part, LINE_LENGTH, break_on_hyphens=False)]


def foot(proof):
    """The lines that say by what it was proved, and from which file it was drawn."""
    lines = ["converse %s, method %s, %s" % (proof.version, proof.method, proof.arithmetic)]
    if any(map(proof.tree.count, tree.CUTS[2:])) and not proof.all_decided:
        lines.append("where prisms of several parameters share a place, "
                     "what is not proved lies on top")
    if proof.problem.size > 2:
        lines.append("prisms are seen along v2, and what is not proved lies on top")
    if proof.problem.frame != identity(proof.problem.size):
        lines.append("the angles after x* are " + frame_text(proof.problem.frame, "v%d"))
    if proof.symmetries_used:
        lines.append("this region stands for the whole torus by "
                     + " and ".join(proof.symmetries_used))
    if proof.sha256:
        lines.append("proof file: SHA-256 " + proof.sha256)
    return lines


def nodes(proof):
    """The tree of the proof's x*, which is drawn, with one letter for all linked leaves."""
    return proof.tree.translate(dict.fromkeys(map(ord, tree.LETTERS), LINKED))


def counts(proof):
    """The number of prisms of each kind that occurs."""
    found = {kind: nodes(proof).count(kind) for kind in KIND_NAMES}
    found["?"] = tree.untried(proof.tree)
    return {kind: count for kind, count in found.items() if count}


def star(proof):
    """The place of x*, modulo 2 pi, in units of the region's sides; None if it is not in the region
    or not yet chosen."""
    places = []
    if proof.xstar is None:
        return None
    x = [Fraction(text) / Fraction(math.pi) for text in proof.xstar]
    n = proof.problem.size
    centre, half = proof.problem.centre[-n:], proof.problem.half[-n:]
    for v, middle, side in zip(nearest(proof.problem.frame, x, centre), centre, half):
        if side == 0 or abs(v - middle) > side:
            return None
        places.append(float(((v - middle) / side + 1) / 2))
    return tuple(places[:2])
