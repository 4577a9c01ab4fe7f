"""The report of the thesis's method: that of 1989 (thesis, Appendix B), in the same words and
number formats, and below it what a theorem rests on."""

import math

from ..model.exact import decimal_text, short_text
from ..storage.kept import believed
from . import tree
from .settings import AS_PRINTED, LIMIT, REGION, THEOREM, TIME, UNDECIDED

PLUSES = "+" * 48
MAP = ("Map : y' = y + J', J' = J - dV(y), V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1)",
       "x* and v : the angles y at one time and at the next, modulo 2 pi",
       "Tori : invariant graphs J = P + S'(y) over all angles, P constant, S periodic and C1")
MORE_TIME = "more time (-b FILE, then -r FILE)"
LEAST_PLACES = 6                        # Ranges are printed with at least six decimal places.
REASONS = (                             # in the order of csrc/converse.h
    "the orbit of the centre contradicts nothing",
    "an image prism grew too big",
    "the orbit grew too long",
    "a matrix could not be inverted",
    "the arithmetic failed",
    "only the double-precision try succeeded",
)
FINDINGS = {
    THEOREM: "I find no invariant tori",
    REGION: "I find no invariant tori whose successor of x* lies in the region :",
    UNDECIDED: "I could not decide whether there are invariant tori",
    AS_PRINTED: "I find no invariant tori",
}


def header(problem, as_printed=False):
    """The lines above the row of pluses: parameters, region and comments.

    Comments come from the input.  They are quoted, because they are not the program's
    words, except in a run as printed."""
    lines = ["Parameters :"]
    lines += ["%s : %.14e \t %.14e" % row for row in zip(
        "abc", map(float, problem.centre), map(float, problem.half))]
    lines += ["", "Initial region :"]
    lines += ["v[%d] : %.14e \t %.14e" % (i, problem.centre[i - 2] * math.pi,
                                          problem.half[i - 2] * math.pi) for i in range(2)]
    lines += ["", "Comments :", "",
              *(comment if as_printed else quoted(comment) for comment in problem.comments),
              "", PLUSES]
    return "\n".join(lines) + "\n"


def quoted(comment):
    """A line of the input, marked as such."""
    return ("> " + comment).rstrip()


def verdict(proof):
    """The lines below the row of pluses: the conclusion, the counts and the grounds."""
    lines = _theorem(proof) + [""] + _statistics(proof)
    if not proof.as_printed:
        lines += [""] + _grounds(proof)
    return "\n".join(lines) + "\n"


def _theorem(proof):
    problem, exactly = proof.problem, not proof.as_printed
    of = "for the range of parameters :"
    lines = [FINDINGS[proof.conclusion]]
    if proof.conclusion == REGION:
        lines += [_range("v[0] / pi", *problem.v0), _range("v[1] / pi", *problem.v1),
                  "(only a part of the torus: other successors were not examined)", of]
    else:
        lines[0] += " " + of
    lines += [_range(name, *ends, exactly) for name, ends in zip("abc", problem.abc)]
    if proof.conclusion == UNDECIDED:
        lines += [""] + _gaps(proof)
    return lines


def _range(name, low, high, exactly=True):
    """A range with its ends exact, or to the six places of 1989.  The report of 1989 has the
    strict sign, although the theorem includes the ends."""
    low, high = (decimal_text(x, LEAST_PLACES) if exactly else "%f" % x for x in (low, high))
    if exactly and low == high:
        return "%s = %s" % (name, low)
    return "%s < %s < %s" % (low, name, high)


def _gaps(proof):
    """The reason why nothing is proved, and advice."""
    undecided = proof.undecided
    lines = ["Undecided prisms : %d" % len(undecided)]
    if undecided:
        lines += ["The deepest of them was cut %d times." % max(leaf.depth for leaf in undecided)]
    if not tree.complete(proof.tree):
        lines += ["The search ended before the whole region was examined."]
    if proof.as_printed:
        return lines
    for leaf in undecided[:1]:
        lines += ["The first of them : %s." % ", ".join(
            "%s < v[%d] / pi < %s" % (short_text(c - h, h / 100), i, short_text(c + h, h / 100))
            if h else "v[%d] / pi = %s" % (i, short_text(c))
            for i, (c, h) in enumerate(zip(leaf.centre, leaf.half)))]
    if not proof.problem.present:
        return lines + ["To try : amplitudes that are not all 0, as the map without potential has "
                        "invariant tori."]
    return lines + ["To try : the sharper criterion (--method loewner)%s." % (
        ", or " + MORE_TIME if proof.ended == TIME else deeper(proof))]


def deeper(proof):
    """The advice to cut deeper, where a prism was given up at the depth of the search."""
    if proof.depth < LIMIT and any(leaf.depth == proof.depth for leaf in proof.undecided):
        return ", or deeper cuts (-d %d)" % min(max(2 * proof.depth, 10), LIMIT)
    return ""


def _statistics(proof):
    counts = proof.counts
    used = counts.ll_used
    if proof.as_printed:                # The listing exchanged these two labels.
        used = (used[1], used[0], used[2])
    share = [100.0 * n / max(1, sum(used)) for n in used]
    return [
        "Did %d quick checks, %d semi-rigorous bounding tries," % (counts.quick_tries,
                                                                   counts.tries),
        "and %d rigorous bounding tries." % counts.Rtries,
        "The most deeply refined prism was cut %d times." % counts.most_cuts,
        "The longest semi-rigorous orbit ran for %d iterations," % counts.max_steps,
        "the longest successful orbit, %d iterations." % counts.max_NTsteps,
        "Of the %d successful prisms, %d fell to the trace criterion," % (counts.proved,
                                                                         counts.HermSuccess),
        "%d to the least eigenvalue test." % counts.LLSuccess,
        "The best upper bound on the least eigenvalue came from",
        "the maxBlam criterion %.1f%% of the time," % share[0],
        "the minBlam criterion %.1f%% of the time," % share[1],
        "and from the trace criterion %.1f%% of the time." % share[2],
        "",
        "This investigation took %.2f seconds." % proof.seconds,
    ]


def _grounds(proof):
    """The map, the method and the counts that the conclusion rests on."""
    problem = proof.problem
    lines = list(MAP)
    if proof.symmetries_used:
        lines += ["Region : %s, %s" % (_range("v[0] / pi", *problem.v0),
                                       _range("v[1] / pi", *problem.v1)),
                  "which by %s stands for the whole torus" % " and ".join(proof.symmetries_used)]
    lines += ["Program : converse " + proof.version,
              "Method : that of the thesis, its listing corrected",
              "Arithmetic : " + proof.arithmetic]
    lines += ["x* : %s %s" % proof.xstar] if proof.xstar else []
    lines += ["%s : %s" % (name, proof.constants[name]) for name in ("T", "B")
              if name in proof.constants]
    lines += ["Tries that failed : %d" % sum(proof.counts.reasons),
              *("%d : %s" % pair for pair in zip(proof.counts.reasons, REASONS) if pair[0])]
    if proof.restored:
        lines += ["Restored : " + believed(proof.restored, "prism")]
    if proof.sha256:
        lines += ["Proof file : SHA-256 " + proof.sha256]
    return lines
