"""The theorem that was verified, in words: neither more nor less."""

from fractions import Fraction

from .claim import ANGLES, RANGES, THESIS
from .cover import symmetries_used
from .limits import PART, VERIFIED
from .tree import leaf_text
from .version import __version__


def decimal_text(x):
    """A finite decimal, exactly.

    Parameters
    ----------
    x : int or Fraction

    Returns
    -------
    str
    """
    places = 0
    while 10 ** places % x.denominator:
        places += 1
    digits = str(abs(x.numerator) * (10 ** places // x.denominator)).rjust(places + 1, "0")
    before, rest = digits[:len(digits) - places], digits[len(digits) - places:]
    return "-" * (x < 0) + before + ("." + rest if rest else "")


def range_text(name, low, high):
    low, high = decimal_text(low), decimal_text(high)
    return "%s = %s" % (name, low) if low == high else "%s <= %s <= %s" % (low, name, high)


SYSTEM = "THEOREM.  The map y' = y + J', J' = J - grad V(y) of two angles y (modulo 2 pi),"
TRIG = "V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1)"
GRAPH = ["has no invariant Lagrangian graph",
         "(no invariant torus J = P + S'(y) over both angles, P constant, S periodic and C1)"]


def frame_text(frame):
    """The angles that v0 and v1 stand for, such as (v0 + v1, v0 - v1)."""
    return "(%s)" % ", ".join([sum_text(row, ANGLES) for row in (frame[:2], frame[2:])])


def sum_text(coefficients, names):
    """The sum of integers times names, without those that are 0."""
    text = ""
    for x, name in zip(coefficients, names):
        if x:
            text += (" - " if x < 0 else " + ") if text else "-" * (x < 0)
            text += name if abs(x) == 1 else "%d %s" % (abs(x), name)
    return text or "0"


def affine_text(middle, parts):
    """middle + the sum of factor name over the pairs (factor, name)."""
    return " ".join([decimal_text(middle), *["%s %s %s" % ("-" if g < 0 else "+", decimal_text(
        abs(g)), name) for g, name in parts if g]])


def is_boxed(claim):
    """Is it of the thesis's potential, with one parameter, or one for each of a, b, c or none?"""
    return tuple(wave.k for wave in claim.waves) == THESIS \
        and not any(wave.phase for wave in claim.waves) \
        and (claim.parameters < 2 or claim.parameters == 3 and not any(
            g for w, wave in enumerate(claim.waves) for m, g in enumerate(wave.parts) if m != w))


def claimed(claim):
    """The claim of a proof file, in lines."""
    boxed, torus = is_boxed(claim), symmetries_used(claim) is not None
    potential = TRIG if boxed else "V(y) = - the sum of A sin(k.y + phase) over the waves below"
    lines = [SYSTEM, potential + ", " + GRAPH[0], *GRAPH[1:]]
    if not torus:
        lines += ["whose orbit goes from y = x* to y' = %s in the region" % frame_text(claim.frame),
                  *(range_text(name + " / pi", c - h, c + h)
                    for name, c, h in zip(ANGLES, claim.centre, claim.half)),
                  "(no other y' was examined, and the region is not the full torus)"]
    lines[-1] += " for any parameters with" if boxed or claim.parameters else " for"
    if boxed:
        spread = [sum(map(abs, wave.parts)) for wave in claim.waves]
        lines += [range_text(name, wave.middle - x, wave.middle + x)
                  for name, wave, x in zip(RANGES, claim.waves, spread)]
        if claim.parameters == 1:
            rising = all(g >= 0 for wave in claim.waves for g in wave.parts)
            lines += ["moving together, on the segment from all lower to all upper ends"
                      if rising else "moving together, (a, b, c) = (%s) + t (%s), -1 <= t <= 1" % (
                          ", ".join([decimal_text(wave.middle) for wave in claim.waves]),
                          ", ".join([decimal_text(wave.parts[0]) for wave in claim.waves]))]
    else:
        names = ["t%d" % (m + 1) for m in range(claim.parameters)]
        lines += ["-1 <= %s <= 1" % ", ".join(names)] * bool(names)
        lines += ["where the input's %s is %s, from %s to %s" % (name, affine_text(
            (low + high) / 2, [((high - low) / 2, t)]), decimal_text(low), decimal_text(high))
            for (name, low, high), t in zip(claim.names, names)]
        for wave in claim.waves:
            lines += ["k = (%d, %d), phase = %s pi, A = %s" % (
                *wave.k, wave.phase, affine_text(wave.middle, zip(wave.parts, names)))]
    if claim.at_once != "no":
        upper = "these amplitudes at t1 = 1" if not boxed else (
            "the upper ends of these ranges" if claim.parameters == 1 and rising
            else "these parameters at t = 1")
        lines += ["and for any multiple s >= 1 of %s (B > 10/3)" % (
            upper if claim.at_once == "upper end" else "such parameters" if boxed
            else "such amplitudes")]
    return lines


def not_excluded(claim, ordinal, cell, why):
    """The message that a leaf is not confirmed, with the reason."""
    return "%s is not excluded: %s; the claim is false or its proof beyond the limits of this " \
        "checker" % (leaf_text(claim, "P", ordinal, cell), why)


def report(claims, theorem, criterion, confirmed, pieces, doubles):
    """The exit status and the lines of a report: the theorem, exactly as far as it was verified.

    claims: of the cells of a map, of the columns of a portrait, or of a proof file and its parts;
    theorem: what is claimed, in lines; criterion: of a proof file only; doubles: the number of
    leaves that were tried in doubles.
    """
    proved, skipped, linked, undecided = [
        sum([claim.counts.get(kind, 0) for claim in claims])
        for kind in ("proved", "symmetric", "linked", "undecided")]
    used = symmetries_used(claims[0]) if criterion else []      # else a part was rejected
    lines = ["Verified" + ", for a part of the torus only" * (used is None) + " :", *theorem, "",
             "Checker : converse-check " + __version__,
             "Method : Loewner criterion, multipliers, %s%sin integers%s" % (
                 "links between starting points, " * (linked > 0),
                 ("in doubles%s and where these fail " % (
                     " (%d leaves)" % doubles * (doubles < confirmed))) * (doubles > 0),
                 " of %d bits" % criterion.fixed.bits if criterion else "")]
    if criterion:
        places, claim = 9, criterion.claim
        bound = -(-criterion.B * 10 ** places // criterion.fixed.one)       # rounded up
        if used:
            lines += ["Successors : y' = %s," % frame_text(claim.frame)
                      + ",".join([" " + range_text(name + " / pi", c - h, c + h) for name, c, h in
                                  zip(ANGLES, claim.centre, claim.half)])
                      + "; all others by " + " and ".join(used)]
        lines += ["x*%s : %s %s" % (part.where and " of " + part.where,
                                    *map(decimal_text, part.xstar)) for part in claims]
        lines += ["B : %s" % decimal_text(Fraction(bound, 10 ** places))]
        if claim.alone is not None:
            lines += ["Alone : y%d, since no wave depends on both angles" % claim.alone]
    lines += ["Leaves : %d, of which %d proved%s%s and %d symmetric" % (
        proved + skipped + linked + undecided, proved,
        ", %d linked to other parts" % linked * (linked > 0),
        ", %d undecided" % undecided * (undecided > 0), skipped),
        "Proved leaves checked : %d, in %d piece%s" % (confirmed, pieces, "s" * (pieces != 1))]
    return PART if used is None else VERIFIED, lines
