"""The report of a proof.

The thesis's method reports as in 1989 (report_1989).  The report of the sharper method begins with
the theorem, in the parameters of the input, and goes on with what the theorem rests on.
"""

from fractions import Fraction

from ..model.exact import short_text
from ..model.problem import ANGLES, frame_text, identity
from ..model.region import folds
from ..model.statement import (TORUS, conditions, ended, indented, labelled, map_lines, one_angle,
                               parameters, whole)
from ..storage.kept import headline, verify_text
from . import report_1989, tree
from .report_1989 import MORE_TIME, deeper, quoted
from .settings import DEPTH, DOUBLES, HOPELESS, LENGTH, REGION, THEOREM, TIME

TINY = 1e-10                            # half-width of an angle, in units of pi
GRAPH = {1: "", **{n: " J = P + S'(y) over %s angles, P constant, S periodic and C1" % these
                   for n, these in ((2, "both"), (3, "all"))}}
HUGE = 2 ** 60                          # MAX_AMPLITUDE of csrc/loewner/problem.c
ENDED = {
    HOPELESS: "hopeless as seen: long orbits in thin prisms contradict nothing, as near a torus",
    LENGTH: "at the limit of length: a prism needs a longer orbit than the method follows",
    DEPTH: "at the limit of depth: a prism was cut as often as -d allows",
    DOUBLES: "at the limit of doubles: a prism is too small, or rounding errors are too large",
    TIME: "before the whole region was examined: there was no time left, or a signal came",
}
KEYWORDS = {                            # of prove(), by the command's flags
    "-b FILE, then -r FILE": "save(FILE), then prove(resume=FILE)",
    "--xstar X0 X1": "xstar=(X0, X1)", "--method loewner": "method='loewner'", "-d ": "depth="}
REASONS = (report_1989.REASONS[0], "the prism was too large", *report_1989.REASONS[2:])


def report(proof, file=None):
    """The whole report.  file: as in verify_text."""
    return verdict(proof, file) if proof.method != "thesis" else \
        report_1989.header(proof.problem, proof.as_printed) + verdict(proof, file)


def verdict(proof, file=None):
    """The conclusion, and what it rests on."""
    if proof.method == "thesis":
        return _advised(report_1989.verdict(proof), file)
    lines = _theorem(proof) if proof.all_decided else _undecided(proof, file)
    for label, text in _grounds(proof, file):
        lines += labelled(label, text)
    return "\n".join(lines) + "\n"


def _advised(text, file):
    """The text, in which advice for a Python program names keywords and not flags."""
    for flag, keyword in KEYWORDS.items() if file is None else ():
        text = text.replace(flag, keyword)
    return text


# ---- the theorem

def _theorem(proof):
    problem, part = proof.problem, proof.conclusion == REGION
    torus = TORUS[problem.map.dimension] + GRAPH[problem.map.dimension]
    lines = [headline("THEOREM" + ", for a part of the torus only" * part, proof.restored, "prism"),
             *map_lines(problem), "  has no " + torus]
    if part:
        lines += indented(["whose orbit goes from x* = %s to y' = %s, where" % (
                                _star(problem, proof.xstar), frame_text(problem.frame, "v%d")),
                            "%s (no other y' was examined)" % _region(problem)])
    lines = ended([*lines, *indented(conditions(problem, proof.at_once))])
    if problem.map.dimension > 1 and not part and one_angle(problem) is not None:
        lines += ["  So the map of y%d alone has no rotational invariant circle."
                  % one_angle(problem)]
    return [*lines, ""]


# ---- without a theorem

def _undecided(proof, file):
    problem, undecided = proof.problem, proof.undecided
    torus = ("a " if problem.map.dimension == 1 else "an ") + TORUS[problem.map.dimension]
    flat = not problem.present
    lines = ["UNDECIDED: nothing is proved.  There may be %s%s." % (
                 torus, " (see converse-tori)" * (problem.size == 2)),
             *map_lines(problem), *ended(indented(["was examined " + " ".join(
                 conditions(problem))])), ""]
    if undecided:
        lines += labelled("Undecided", "%s, the deepest cut %s" % (
            _many(len(undecided), "prism"),
            _many(max(leaf.depth for leaf in undecided), "time")))
        leaf = undecided[0]
        lines += labelled("", "the first of them: " + ", ".join(
            _between("v%d" % i, c - h, c + h, h / 100)
            for i, (c, h) in enumerate(zip(leaf.centre, leaf.half)) if i < problem.map.dimension))
    stuck = any(leaf.depth < proof.depth and min(leaf.half) < TINY for leaf in undecided)
    if stuck:
        lines += labelled("", "one of them is as small as doubles can tell: the orbit from x* "
                           "to it may minimize")
    lines += labelled("Ended", _advised(ENDED[proof.ended], file))
    if sum(proof.counts.reasons):
        lines += labelled("Tries", "%s without a proof: %s" % (
            _count(sum(proof.counts.reasons)), ", ".join(
                "%s because %s" % (_count(number), why)
                for number, why in zip(proof.counts.reasons, REASONS) if number)))
    return lines + labelled("To try", _advised(_advice(proof, stuck, flat), file))


def _advice(proof, stuck, flat):
    if flat:
        return "amplitudes that are not all 0: the map without potential has invariant tori"
    if any(term.most >= HUGE for term in proof.problem.terms):
        return "amplitudes below 2^60, near 10^18: larger ones do not fit into its numbers"
    ended, texts = proof.ended, [each.text for each in proof.trees]
    across, along = (sum(text.count(axis) for text in texts for axis in axes)
                     for axes in ("015", "234"))
    narrower = "a narrower range of parameters, or " * (
        any(map(any, proof.problem.parts)) and (ended != TIME or along > across))
    if ended == TIME:
        return narrower + MORE_TIME
    return ("another x* (--xstar X0 X1), or " * (stuck or ended == HOPELESS) + narrower
            + "other parameters" + ("; neither more time nor deeper cuts would help"
                                    if ended == HOPELESS else deeper(proof)))


# ---- what the theorem rests on

def _grounds(proof, file):
    """(label, text) of each further line."""
    problem, counts = proof.problem, proof.counts
    if proof.conclusion in (THEOREM, REGION):
        yield "Verify", verify_text(file, "proof")
    for label, comment in zip(["Input"] + [""] * len(problem.comments), problem.comments):
        yield label, quoted(comment)
    if problem.map.dimension == 1 and proof.all_decided:
        yield "Circle", "one that goes around the cylinder; it is a graph (Birkhoff)"
    yield "Method", "Loewner criterion in rigorous double precision; converse " + proof.version
    if problem.factor is not None:
        yield "", "y%d alone was examined: no wave depends on both angles" % problem.factor
    if proof.xstar:
        yield "Start", "x* = %s" % _star(problem, proof.xstar)
    if proof.conclusion != REGION:
        yield "Searched", _searched(proof)
    if "B" in proof.constants:
        yield "Bound", "B = %s: no eigenvalue of 2 - V'' is larger" % proof.constants["B"]
    yield "Search", "%s proved%s%s, cut %s at most; orbits of up to %s; %s" % (
        _many(counts.proved, "prism"), ", %s skipped by symmetry" % _count(
            counts.symmetric) if counts.symmetric else "",
        ", %s linked" % _count(counts.linked) if proof.parts else "",
        _many(counts.most_cuts, "time"), _many(counts.max_NTsteps, "point"),
        _many(counts.tries, "try", "tries"))
    for letter, part in zip(tree.LETTERS, proof.parts):
        yield "Part " + letter, "x* = %s, %s%s: %s proved, %s linked" % (
            _star(problem, part.xstar), _region(part.problem),
            ", with its mirror image" if folds(part.problem, part.xstar) else "",
            _many(part.text.count("P"), "prism"), _count(tree.count_linked(part.text)))
    if proof.parts:
        yield "Links", "an invariant torus that leads from its x* into a linked prism leads from " \
            "the x* of a part into the region of that part (manual: proofs/argument, section 10)"
    if proof.sha256:
        yield "SHA-256", proof.sha256 + " (proof file)"
    yield "Time", "%.2f s" % proof.seconds


def _star(problem, xstar):
    return xstar[0] if problem.map.dimension == 1 else "(%s)" % ", ".join(xstar)


def _searched(proof):
    """Which successors of x* were examined, and why they are enough."""
    problem, used = proof.problem, proof.symmetries_used
    if problem.frame == identity(problem.size) and not used and problem.full_torus:
        return "all y' that follow x*"
    return "the y' = %s that follow x*, %s%s" % (
        "v0" if problem.map.dimension == 1 else frame_text(problem.frame, "v%d"), _region(problem),
        "; the others follow by " + " and ".join(used) if used else "")


def _region(problem):
    """The region of a problem, and how it moves with the parameters."""
    text = ", ".join(_between(*each) for each in zip(
        ANGLES, *zip(*problem.region[:problem.map.dimension])))
    if not problem.shifts:
        return text
    names = problem.parameters or parameters(problem)
    ends = ["the upper end"] if names is None else [
        "the upper end of " + name for name, *_ in names]
    return "%s in the middle of the parameters, moved by %s" % (text, ", ".join(
        "(%s) at %s" % (", ".join(map(_angle, distances)), end)
        for distances, end in zip(problem.shifts, ends)))


def _between(name, low, high, error=Fraction(0)):
    if low == high:
        return whole("%s = %s" % (name, _angle(low)))
    return whole("%s <= %s <= %s" % (_angle(low, error), name, _angle(high, error)))


def _angle(x, error=Fraction(0)):
    """An angle in radians, as a multiple of pi."""
    if x in (0, 1, -1):
        return {0: "0", 1: "pi", -1: "-pi"}[int(x)]
    return short_text(x, error) + " pi"


def _count(n):
    return format(n, ",")


def _many(n, noun, plural=None):
    """A number and its noun."""
    return "%s %s" % (_count(n), noun if n == 1 else plural or noun + "s")
