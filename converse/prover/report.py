"""The report of 1989 (thesis, Appendix B), in the same words and number formats."""

import math

from ..model.exact import decimal_text, short_text
from ..model.problem import IDENTITY, frame_text, wave_text
from ..storage.files import plain
from . import tree
from .settings import AS_PRINTED, LIMIT, REGION, THEOREM, UNDECIDED

PLUSES = "+" * 48
MAP = ("y' = y + J', J' = J - dV(y), ", "V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1)",
       "x* and v : the angles y at one time and at the next, modulo 2 pi",
       "Tori : invariant graphs J = P + S'(y) over all angles, P constant, S periodic and C1")
LEAST_PLACES = 6                        # of a bound
TINY = 1e-10                            # half-width of an angle, in units of pi
WAVES = "V(y) = - the sum of"           # in general
METHOD_NAMES = {
    "thesis": "that of the thesis, its listing corrected",
    "loewner": "the Loewner criterion, by witness and multipliers",
}
REASONS = (                             # in the order of csrc/converse.h
    "the orbit of the centre contradicts nothing",
    "an image prism grew too big",
    "the orbit grew too long",
    "a matrix could not be inverted",
    "the arithmetic failed",
    "only the double-precision try succeeded",
)
TOO_BIG = 1                             # which the sharper method, without images, has as well


def header(problem, as_printed=False):
    """What is known before the search: parameters, region, comments.  Comments are the input's and
    not the program's words, and so are the names and ranges of the parameters of a JSON file, which
    are among them: except for a run as printed they are quoted."""
    lines = ["Parameters :"]
    lines += ["%s : %.14e \t %.14e" % row for row in zip(
        "abc" if problem.by_ranges else ["p of " + wave_text(wave) for wave in problem.waves],
        map(float, problem.centre), map(float, problem.half))]
    lines += ["", "Initial region :"]
    lines += ["v[%d] : %.14e \t %.14e" % (i, problem.centre[i - 2] * math.pi,
                                          problem.half[i - 2] * math.pi) for i in range(2)]
    lines += ["", "Comments :", "",
              *(plain(comment) if as_printed else ("> " + plain(comment)).rstrip()
                for comment in problem.comments),
              "", PLUSES]
    return "\n".join(lines) + "\n"


def verdict(proof):
    """What the search found."""
    lines = _theorem(proof) + [""] + _statistics(proof)
    if not proof.as_printed:
        lines += [""] + _method(proof)
    return "\n".join(lines) + "\n"


def report(proof):
    return header(proof.problem, proof.as_printed) + verdict(proof)


FINDINGS = {
    THEOREM: "I find no %s",
    REGION: "I find no %s whose successor of x* lies in the region :",
    UNDECIDED: "I could not decide whether there are %s",
    AS_PRINTED: "I find no %s",
}
TORI = {1: "rotational invariant circles", 2: "invariant tori"}         # by dimension


def _theorem(proof):
    problem, exactly, sign = proof.problem, not proof.as_printed, _sign(proof)
    of = " for the range of parameters :" if problem.by_ranges else " for %s :" % WAVES
    lines = [FINDINGS[proof.conclusion] % TORI[problem.dimension]]
    if proof.conclusion == REGION:
        lines += [_range("v[0] / pi", *problem.v0, sign), _range("v[1] / pi", *problem.v1, sign)]
        lines += ["(only a part of the torus: other successors were not examined)", of[1:]]
    else:
        lines[0] += of
    if not problem.by_ranges:
        lines += _potential(problem, sign)
    else:
        lines += [_range(name, *getattr(problem, name), sign, exactly) for name in "abc"]
    if problem.together:
        lines += ["which move together, from all lower to all upper ends."]
    if proof.conclusion == UNDECIDED:
        lines += [""] + _gaps(proof)
    elif proof.at_once:
        lines += ["Nor are there any for s times %s, s > 1." % (
            "the upper ends" if problem.together else "such parameters" if problem.by_ranges
            else "such p" if len(problem.parts) != 1 else "those p of t[1] = 1")]
    return lines


def _sign(proof):
    """Both methods exclude closed ranges; the report of 1989 has the strict sign."""
    return "<=" if proof.method == "loewner" else "<"


def _potential(problem, sign):
    """The waves, exactly."""
    lines = []
    for wave, p, *parts in zip(problem.waves, problem.amplitude, *problem.parts):
        moves = "".join(" %s %s t[%d]" % ("-" if part < 0 else "+",
                                          decimal_text(abs(part), LEAST_PLACES), m)
                        for m, part in enumerate(parts, 1) if part)
        lines.append("p %s, p = %s%s" % (wave_text(wave), decimal_text(p, LEAST_PLACES), moves))
    if problem.parts:
        names = ", ".join("t[%d]" % m for m in range(1, len(problem.parts) + 1))
        lines += ["for -1 %s %s %s 1" % (sign, names, sign)]
    return lines


def _range(name, low, high, sign, exactly=True):
    """The bounds of a range, exactly, or to the six places of 1989."""
    low, high = (decimal_text(x, LEAST_PLACES) if exactly else "%f" % x for x in (low, high))
    if exactly and low == high:
        return "%s = %s" % (name, low)
    return "%s %s %s %s %s" % (low, sign, name, sign, high)


def _gaps(proof):
    """What stands in the way of a theorem, and what may help."""
    undecided = proof.undecided
    unfinished = not all(tree.complete(part.tree) for part in (proof, *proof.parts))
    lines = ["Undecided prisms : %d" % len(undecided)]
    if undecided:
        lines += ["The deepest of them was cut %d times." % max(leaf.depth for leaf in undecided)]
    if unfinished:
        lines += ["The search ended before the whole region was examined."]
    if proof.as_printed:
        return lines
    for leaf in undecided[:1]:
        lines += ["The first of them : %s." % ", ".join(
            "%s < v[%d] / pi < %s" % (short_text(c - h, h / 100), i, short_text(c + h, h / 100))
            if h else "v[%d] / pi = %s" % (i, short_text(c))
            for i, (c, h) in enumerate(zip(leaf.centre, leaf.half)))]
    stuck = any(leaf.depth < proof.depth and min(leaf.half) < TINY for leaf in undecided)
    if stuck and proof.method == "loewner":
        lines += ["One of them is as small as doubles can tell : "
                  "the orbit from x* to it may minimize."]
    if not any(map(any, (proof.problem.amplitude, *proof.problem.parts))):
        return lines + ["To try : amplitudes that are not all 0, as the map without potential has "
                        "invariant tori."]
    if proof.method == "thesis":
        advice = "the sharper criterion (--method loewner)"
    elif undecided:
        advice = "another x* (--xstar X0 X1), or " if stuck else ""
        advice += "a smaller range of parameters, or " if any(map(any, proof.problem.parts)) else ""
        advice += "larger parameters"
    else:
        advice = "more time, from a backup (-b FILE, then -r FILE)"
    if any(leaf.depth == proof.depth for leaf in undecided) and proof.depth < LIMIT:
        advice += ", or deeper cuts (-d %d)" % min(max(2 * proof.depth, 10), LIMIT)
    return lines + ["To try : %s." % advice]


def _leaves(counts):
    return counts.proved + counts.symmetric + counts.undecided + counts.linked


def _statistics(proof):
    counts = proof.counts
    if proof.method == "loewner":
        return [
            "Did %d rigorous bounding tries in double precision." % counts.tries,
            "The most deeply refined prism was cut %d times." % counts.most_cuts,
            "The longest successful orbit had %d points." % counts.max_NTsteps,
            "Of the %d prisms %d were proved, %s." % (
                _leaves(counts), counts.proved,
                "%d linked to other starting points" % counts.linked if proof.parts else
                "%d skipped by symmetry" % counts.symmetric),
            "",
            "This investigation took %.2f seconds." % proof.seconds,
        ]
    used = counts.ll_used
    if proof.as_printed:                # the listing exchanged these two labels
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


def _method(proof):
    """The map, the method and the counts that the conclusion rests on."""
    problem = proof.problem
    lines = ["Map : " + MAP[0] + (MAP[1] if problem.by_ranges else WAVES + " such waves"),
             *MAP[2:], *_choices(proof),
             "Program : converse " + proof.version,
             "Method : " + METHOD_NAMES[proof.method],
             "Arithmetic : " + proof.arithmetic]
    lines += ["x* : %s %s" % proof.xstar] if proof.xstar else []
    lines += _parts(proof)
    lines += ["%s : %s" % (name, proof.constants[name]) for name in ("T", "B")
              if name in proof.constants]
    lines += _reasons(proof)
    if proof.restored:
        lines += ["Restored : %d prisms were read from a backup, which is believed"
                  % proof.restored]
    if proof.sha256:
        lines += ["Proof file : SHA-256 " + proof.sha256]
    return lines


def _reasons(proof):
    """How many tries proved nothing, and why.  With the sharper method the usual reason is no
    failure: the prism is cut."""
    what, words = "Tries that failed", list(REASONS)
    if proof.method == "loewner":
        what, words[TOO_BIG] = "Tries without a proof", "the prism was too large"
    return ["%s : %d" % (what, sum(proof.counts.reasons)),
            *("%d : %s" % pair for pair in zip(proof.counts.reasons, words) if pair[0])]


def _parts(proof):
    """The further starting points, and what was proved over each."""
    lines = []
    for letter, part in zip(tree.LETTERS, proof.parts):
        lines += ["Part %s : x* %s %s, %s : %d prisms proved, %d linked" % (
            letter, *part.xstar, _region(proof.problem, part), part.tree.count("P"),
            tree.count_linked(part.tree))]
    if lines:
        lines += ["Links : %d prisms of one x* lead, on an invariant graph, into the region of a "
                  "part" % proof.counts.linked,
                  "(the theorem rests on what graphs do at several points: "
                  "docs/proofs/argument.md, section 10)"]
    return lines


def _region(problem, part):
    """The region of a part, and how it moves with the parameters."""
    ranges = _range("v[0] / pi", *part.v0, "<="), _range("v[1] / pi", *part.v1, "<=")
    if not part.shifts:
        return "%s, %s" % ranges
    moves = ["by %s %s" % tuple(decimal_text(x, LEAST_PLACES) for x in pair)
             for pair in part.shifts]
    if len(moves) == 1:
        moves = [moves[0] + " to their upper ends"]
    else:
        names = "abc" if problem.by_ranges else ["t[%d]" % m for m in range(1, len(moves) + 1)]
        moves = ["%s to the upper end of %s" % pair for pair in zip(moves, names)]
    return "%s and %s in the middle of the parameters, moved %s" % (*ranges, ", ".join(moves))


def _choices(proof):
    """How the search looks at the problem, where it is not just as it stands."""
    problem, lines = proof.problem, []
    if problem.frame != IDENTITY:
        lines += ["Frame : the angles at the next time are " + frame_text(problem.frame, "v[%d]")]
    if proof.symmetries_used:
        lines += ["Region : %s, %s" % (_range("v[0] / pi", *problem.v0, _sign(proof)),
                                       _range("v[1] / pi", *problem.v1, _sign(proof))),
                  "which by %s stands for the whole torus" % " and ".join(proof.symmetries_used)]
    if problem.dimension == 1:
        lines += ["Circles : those that go around are graphs (Birkhoff), and times {J1 = 0} such "
                  "tori"]
    if problem.factor is not None:
        lines += ["Alone : y%d, as no wave feels both angles; what only y%d feels was left out" % (
            problem.factor, 1 - problem.factor)]
    return lines
