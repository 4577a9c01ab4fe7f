"""The report of a proof.

The thesis's method reports as in 1989 (report_1989).  The report of the sharper method begins with
the theorem, in the parameters of the input, and goes on with what the theorem rests on.
"""

import textwrap
from fractions import Fraction

from ..model.exact import decimal_text, is_decimal, short_text
from ..model.potential import sum_text
from ..model.problem import IDENTITY, LINE, frame_text
from . import report_1989, tree
from .report_1989 import deeper, quoted
from .settings import REGION, THEOREM

WIDTH, INDENT = 98, 11                  # characters of a line, and of the labels at its left
LONGEST = 12                            # A value of epsilon with more digits is not printed.
TINY = 1e-10                            # half-width of an angle, in units of pi
TORUS = {1: "rotational invariant circle", 2: "invariant torus"}        # by dimension
REASONS = (                             # in the order of csrc/converse.h
    "the orbit of the centre contradicts nothing",
    "the prism was too large",
    "the orbit grew too long",
    "a matrix could not be inverted",
    "the arithmetic failed",
    "only the double-precision try succeeded",
)


def header(proof):
    """What is printed before the search: with the sharper method nothing."""
    return report_1989.header(proof.problem, proof.as_printed) if proof.method == "thesis" else ""


def verdict(proof, file=None):
    """The conclusion, and what it rests on.  file: the name of the proof's file, or None."""
    if proof.method == "thesis":
        return report_1989.verdict(proof)
    lines = _theorem(proof) if proof.all_decided else _undecided(proof)
    for label, text in _grounds(proof, file):
        lines += _labelled(label, text)
    return "\n".join(lines) + "\n"


def report(proof):
    """The whole report."""
    return header(proof) + verdict(proof)


def _labelled(label, text):
    """A line with a label, continued below where it is long, unless it is a line of the input."""
    first = label.ljust(INDENT)
    return [(first + text).rstrip()] if text.startswith(">") else _wrapped(text, first)


def _wrapped(text, first, indent=INDENT):
    return [line.replace("\xa0", " ") for line in textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=" " * indent,
        break_long_words=False, break_on_hyphens=False)]


def _whole(text):
    """The text as a word that is not divided between two lines."""
    return text.replace(" ", "\xa0")


# ---- the theorem

def _theorem(proof):
    problem, part = proof.problem, proof.conclusion == REGION
    torus = TORUS[problem.dimension]
    lines = ["THEOREM" + ", for a part of the torus only" * part,
             *_map(problem), "  has no " + torus + _graph(problem)]
    if part:
        lines += _indented(["whose orbit goes from x* = %s to y' = %s, where" % (
                                _star(problem, proof.xstar), frame_text(problem.frame, "v%d")),
                            "%s (no other y' was examined)" % _region(problem)])
    lines = _ended([*lines, *_indented(conditions(problem, proof.at_once))])
    if problem.dimension == 2 and not part and _one_angle(problem) is not None:
        lines += ["  So the map of y%d alone has no rotational invariant circle."
                  % _one_angle(problem)]
    return [*lines, ""]


def _graph(problem):
    """The definition of a torus, as the theorem needs it."""
    if problem.dimension == 1:
        return ""
    return " J = P + S'(y) over both angles, P constant, S periodic and C1"


def _one_angle(problem):
    """The only angle that a wave depends on; None: both are, or none."""
    felt = {(bool(k0), bool(k1)) for (k0, k1, _), p, *parts
            in zip(problem.waves, problem.amplitude, *problem.parts) if p or any(parts)}
    return {((True, False),): 0, ((False, True),): 1}.get(tuple(felt))


def _map(problem):
    """The map, with its potential, in lines."""
    return _indented(["The map  y' = y + J',  J' = J - %s,  y modulo 2 pi,"
                      % ("V'(y)" if problem.dimension == 1 else "grad V(y)"),
                      "with  V(y) = %s," % potential_text(problem)])


def _indented(lines):
    return [line for each in lines for line in _wrapped(each, "  ", 8)]


def _ended(lines):
    """The lines with a full stop."""
    return [*lines[:-1], lines[-1] + "."]


def potential_text(problem):
    """V in the problem's parameters, exactly: -p sin(k.y + phi) is written as a cosine where phi
    is a multiple of pi/2."""
    letters, text = ("y", "") if problem.dimension == 1 else ("y0", "y1"), ""
    for (k0, k1, phase), form in zip(problem.waves, _forms(problem)):
        angle, sign, function = sum_text(zip((k0, k1), letters)), -1, "sin"
        if (2 * phase).denominator == 1:        # phase is -1/2, 0, 1/2 or 1
            sign = 1 if phase in (1, Fraction(-1, 2)) else -1
            function = "cos" if phase.denominator == 2 else "sin"
        elif phase:
            angle += " %s %s pi" % ("-" if phase < 0 else "+", abs(phase))
        terms = [(x, name) for name, x in form.items() if x]
        if not terms:
            continue
        if len(terms) == 1:
            (x, name), = terms
            sign *= -1 if x < 0 else 1
            factor = " ".join(filter(None, (
                "" if abs(x) == 1 and name else number_text(abs(x)), name)))
            factor = "" if factor == "1" else factor + " "
        else:
            factor = "(%s) " % _linear(terms)
        text += " %s %s%s" % ("-" if sign < 0 else "+", factor,
                              function + (" " + angle if angle in letters else "(%s)" % angle))
    return ("-" + text[3:] if text.startswith(" -") else text[3:]) or "0"


def _forms(problem):
    """Each amplitude as a linear form of the parameters, {name: factor}; "" is the constant's."""
    if problem.by_ranges and not problem.parameters:
        return [{letter: Fraction(1)} for letter in "abc"]
    forms, names = [], problem.parameters or _parameters(problem)
    for middle, *parts in zip(problem.amplitude, *problem.parts):
        form = {"": middle}
        for (name, low, high), part in zip(names, parts):
            if part:                    # t = (2 x - low - high)/(high - low)
                form[name] = 2 * part / (high - low)
                form[""] -= part * (low + high) / (high - low)
        forms.append(form)
    return forms


def _linear(terms):
    text = ""
    for x, name in terms:
        text += " - " if x < 0 else " + "
        text += name if abs(x) == 1 and name else (number_text(abs(x)) + " " + name).strip()
    return "-" + text[3:] if text.startswith(" - ") else text[3:]


def _parameters(problem):
    """(name, low, high) of each parameter of V; None: a, b and c move along one segment."""
    if problem.parameters:
        return [each for each in problem.parameters if each[1] < each[2]]
    if problem.together and any(problem.half[:3]):
        return None
    if problem.by_ranges:
        return [(letter, *getattr(problem, letter)) for letter in "abc"]
    return [("t[%d]" % m, Fraction(-1), Fraction(1)) for m in range(1, 1 + len(problem.parts))]


def conditions(problem, at_once=False):
    """For which parameters the theorem holds, in lines; at_once: multiples of these are covered,
    too (Proof.at_once)."""
    names = _parameters(problem)
    if names is None:
        ends = [_whole("(%s)" % ", ".join(number_text(getattr(problem, letter)[i])
                                          for letter in "abc")) for i in (0, 1)]
        lines = ["for every (a, b, c) on the segment from %s to %s" % tuple(ends)]
    else:
        ranges = [_whole("%s in [%s, %s]" % (name, *map(number_text, ends)))
                  for name, *ends in names if ends[0] < ends[1]]
        values = ["%s = %s" % (name, number_text(low)) for name, low, high in names if low == high]
        lines = ["for %s%s" % ("every " * bool(ranges), ", ".join(ranges + values))] \
            if names else []
    if at_once:
        lines += ["and for every " + _multiples(problem, names)]
    return lines + _epsilon(problem, at_once)


def _multiples(problem, names):
    """The multiples s >= 1 that are covered: of all amplitudes or, where there is one parameter,
    of those at its upper end."""
    if names is None:
        return "multiple s >= 1 of the upper end"
    forms = [{name for name, x in form.items() if x} for form in _forms(problem)]
    zero = {name for name, low, high in names if low == high == 0}
    for name, _, high in names:         # V is this parameter times a function: s V is at s times it
        if high > 0 and {name} in forms and all(form <= zero or form == {name} for form in forms):
            return "%s > %s" % (name, number_text(high))
    if problem.by_ranges and not problem.parameters:
        return "multiple s (a, b, c), s >= 1"
    if len(problem.parts) == len(names) == 1:
        return "multiple s >= 1 of the amplitudes at %s = %s" % (names[0][0],
                                                               number_text(names[0][2]))
    return "multiple s >= 1 of these amplitudes"


def _epsilon(problem, at_once):
    """The same in the thesis's epsilon, in a line, where epsilon parametrizes the patch."""
    if not problem.by_ranges or problem.parameters or not (
            problem.together or all(low == high for low, high in (problem.a, problem.b,
                                                                   problem.c))):
        return []
    ends = [x / LINE for x in problem.a]
    if problem.b != problem.a or problem.c != tuple(2 * x for x in problem.a) or ends[0] <= 0 or \
            not all(is_decimal(x) and len(number_text(x)) <= LONGEST for x in ends):
        return []
    low, high = map(number_text, ends)
    return ["that is, with a = b = c/2 = %s epsilon, for %s%s" % (
        number_text(LINE), "epsilon = " + low if low == high else
        "every epsilon in [%s, %s]" % (low, high),
        " and every epsilon > " + high if at_once else "")]


# ---- without a theorem

def _undecided(proof):
    problem, undecided = proof.problem, proof.undecided
    torus = {1: "a rotational invariant circle", 2: "an invariant torus"}[problem.dimension]
    flat = not any(map(any, (problem.amplitude, *problem.parts)))
    lines = ["UNDECIDED: nothing is proved.  There may be %s (see converse-tori)." % torus,
             *_map(problem), *_ended(_indented(["was examined " + " ".join(
                 conditions(problem))])), ""]
    if undecided:
        lines += _labelled("Undecided", "%s, the deepest cut %s" % (
            _many(len(undecided), "prism"),
            _many(max(leaf.depth for leaf in undecided), "time")))
        leaf = undecided[0]
        lines += _labelled("", "the first of them: " + ", ".join(
            _between("v%d" % i, c - h, c + h, h / 100)
            for i, (c, h) in enumerate(zip(leaf.centre, leaf.half)) if i < problem.dimension))
    if not all(tree.complete(part.tree) for part in (proof, *proof.parts)):
        lines += _labelled("", "the search ended before the whole region was examined")
    stuck = any(leaf.depth < proof.depth and min(leaf.half) < TINY for leaf in undecided)
    if stuck:
        lines += _labelled("", "one of them is as small as doubles can tell: the orbit from x* "
                           "to it may minimize")
    if sum(proof.counts.reasons):
        lines += _labelled("Tries", "%s without a proof: %s" % (
            _count(sum(proof.counts.reasons)), ", ".join(
                "%s because %s" % (_count(number), why)
                for number, why in zip(proof.counts.reasons, REASONS) if number)))
    return lines + _labelled("To try", _advice(proof, undecided, stuck, flat))


def _advice(proof, undecided, stuck, flat):
    if flat:
        return "amplitudes that are not all 0: the map without potential has invariant tori"
    if not undecided:
        return "more time, from a backup (-b FILE, then -r FILE)"
    return ("another x* (--xstar X0 X1), or " * stuck
            + "a smaller range of parameters, or " * any(map(any, proof.problem.parts))
            + "larger parameters" + deeper(proof))


# ---- what the theorem rests on

def _grounds(proof, file):
    """(label, text) of each further line."""
    problem, counts = proof.problem, proof.counts
    if proof.conclusion in (THEOREM, REGION):
        yield "Verify", "converse-check " + file if file else \
            "with -b FILE the proof is kept; converse-check FILE verifies it"
    for label, comment in zip(["Input"] + [""] * len(problem.comments), problem.comments):
        yield label, quoted(comment)
    if problem.dimension == 1 and proof.all_decided:
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
        yield "Part " + letter, "x* = %s, %s: %s proved, %s linked" % (
            _star(problem, part.xstar), _region(problem, part),
            _many(part.tree.count("P"), "prism"), _count(tree.count_linked(part.tree)))
    if proof.parts:
        yield "Links", "an invariant torus that leads from its x* into a linked prism leads from " \
            "the x* of a part into the region of that part (manual: proofs/argument, section 10)"
    if proof.restored:
        yield "Restored", "%s read from a backup, which is believed" % _many(proof.restored,
                                                                             "prism")
    if proof.sha256:
        yield "SHA-256", proof.sha256 + " (proof file)"
    yield "Time", "%.2f s" % proof.seconds


def _star(problem, xstar):
    return xstar[0] if problem.dimension == 1 else "(%s, %s)" % tuple(xstar)


def _searched(proof):
    """Which successors of x* were examined, and why they are enough."""
    problem, used = proof.problem, proof.symmetries_used
    if problem.frame == IDENTITY and not used and problem.full_torus:
        return "all y' that follow x*"
    return "the y' = %s that follow x*, %s%s" % (
        "v0" if problem.dimension == 1 else frame_text(problem.frame, "v%d"), _region(problem),
        "; the others follow by " + " and ".join(used) if used else "")


def _region(problem, part=None):
    """The region of the problem or of a part, and how a part's region moves with the parameters."""
    at = problem if part is None else part
    text = ", ".join(_between("v%d" % i, *ends) for i, ends in enumerate((at.v0, at.v1))
                     if i < problem.dimension)
    if part is None or not part.shifts:
        return text
    names = _parameters(problem)
    ends = ["the upper end"] if names is None else [
        "the upper end of " + name for name, *_ in names]
    return "%s in the middle of the parameters, moved by %s" % (text, ", ".join(
        "(%s, %s) at %s" % (*map(_angle, pair), end) for pair, end in zip(part.shifts, ends)))


def _between(name, low, high, error=Fraction(0)):
    if low == high:
        return _whole("%s = %s" % (name, _angle(low)))
    return _whole("%s <= %s <= %s" % (_angle(low, error), name, _angle(high, error)))


def _angle(x, error=Fraction(0)):
    """An angle in radians, as a multiple of pi."""
    if x in (0, 1, -1):
        return {0: "0", 1: "pi", -1: "-pi"}[int(x)]
    return short_text(x, error) + " pi"


def number_text(x):
    """An exact number: a decimal if it is a finite one, else a ratio."""
    return decimal_text(x, 0) if is_decimal(x) else str(x)


def _count(n):
    return format(n, ",")


def _many(n, noun, plural=None):
    """A number and its noun."""
    return "%s %s" % (_count(n), noun if n == 1 else plural or noun + "s")
