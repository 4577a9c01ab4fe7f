"""What was verified, in words: exactly so much, and no more."""

from dataclasses import dataclass
from fractions import Fraction

from .claim import ANGLES, IDENTITY, RANGES, THESIS
from .limits import PART, SPOT_CHECK, VERIFIED
from .maps import Map, sign_changes
from .version import __version__


@dataclass(frozen=True)
class Result:
    """What came of a check in which nothing failed: true only if the whole claim is verified and
    its region is the whole torus, or all that a map says is proved.  (All else is an exception.)"""

    status: int                         # VERIFIED, PART or SPOT_CHECK: the exit status, too
    verdict: str                        # "verified", "verified in part" or "spot check"
    text: str                           # the report

    def __bool__(self):
        return self.status == VERIFIED


def decimal_text(x):
    """A finite decimal, exactly."""
    places = 0
    while 10 ** places % x.denominator:
        places += 1
    digits = str(abs(x.numerator) * (10 ** places // x.denominator)).rjust(places + 1, "0")
    before, rest = digits[:len(digits) - places], digits[len(digits) - places:]
    return "-" * (x < 0) + before + ("." + rest if rest else "")


def range_text(name, low, high):
    low, high = decimal_text(low), decimal_text(high)
    return "%s = %s" % (name, low) if low == high else "%s <= %s <= %s" % (low, name, high)


MAP = "The map x[j+1] = 2 x[j] - x[j-1] - V'(x[j]) of two angles (modulo 2 pi),"
TRIG = "V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1)"
GRAPH = ["has no invariant Lagrangian graph",
         "(no invariant torus p = P + S'(x) over the angles, where p[j] = x[j] - x[j-1], P is",
         "constant, S periodic and C1)"]


def is_boxed(claim):
    """Is it of the thesis's potential, with one parameter, or one for each of a, b, c or none?"""
    return tuple(wave.k for wave in claim.waves) == THESIS \
        and not any(wave.phase for wave in claim.waves) \
        and (claim.parameters < 2 or claim.parameters == 3 and not any(
            g for w, wave in enumerate(claim.waves) for m, g in enumerate(wave.parts) if m != w))


def claimed(claim):
    """What a proof file claims, in lines."""
    boxed, torus = is_boxed(claim), min(claim.half) >= 1
    lines = [MAP, (TRIG if boxed else "V(y) = - the sum of p sin(k.y + phase) over the waves below")
             + ", " + GRAPH[0], *GRAPH[1:]]
    if not torus:
        lines += ["whose orbit through x[0] = x* goes on to x[1] = (v0, v1) in the region",
                  *(range_text(name + " / pi", c - h, c + h)
                    for name, c, h in zip(ANGLES, claim.centre, claim.half)),
                  "(only successors in this region were examined, which is not the full torus)"]
        if claim.frame != IDENTITY:
            lines[-1:] = ["where x[1] = (%+d v0 %+d v1, %+d v0 %+d v1)" % claim.frame, lines[-1]]
    lines[-1] += " for any parameters with"
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
        for wave in claim.waves:
            terms = ["%s %s %s" % ("-" if g < 0 else "+", decimal_text(abs(g)), name)
                     for g, name in zip(wave.parts, names) if g]
            lines += ["k = (%d, %d), phase = %s pi, p = %s" % (
                *wave.k, wave.phase, " ".join([decimal_text(wave.middle), *terms]))]
    if claim.at_once != "no":
        upper = "these amplitudes at t1 = 1" if not boxed else (
            "the upper ends of these ranges" if claim.parameters == 1 and rising
            else "these parameters at t = 1")
        lines += ["and for any multiple s >= 1 of %s (B > 10/3)" % (
            upper if claim.at_once == "upper end" else "such parameters" if boxed
            else "such amplitudes")]
    return lines


def mapped(file):
    """What a map claims, in lines."""
    signs = len(sign_changes())
    lines = [MAP, TRIG + ", " + GRAPH[0], *GRAPH[1:]]
    lines[-1] += " for any (a, b, c)"
    lines += ["in the %d proved cells of the file, for any multiple s >= 1 of those in its %d cells"
              % (file.count("P"), file.count("A")),
              "at once (B > 10/3), and for the images of all these by the %d changes of the signs "
              "of" % signs,
              "a, b, c and by the exchange of a and b.  %d cells are open." % file.count("O"),
              "Region : " + file.region]
    for face in file.faces:
        cells = [cell for cell in face.cells if cell[0] != "X"]
        names = "st"[:len(face.directions) - 1]
        lines += ["Face (a, b, c) = r (%s), 0 <= %s <= 1, r <= %s :" % (" + ".join([
            name + "(%s)" % ", ".join(map(decimal_text, d))
            for name, d in zip(("", *[x + " " for x in names]), face.directions)]),
            ", ".join(names), decimal_text(face.radius))]
        least = min([face.box(*cell)[0][0] for kind, *cell in cells if kind in "PA"], default=None)
        if least is None:
            lines += ["  nothing is proved"]
            continue
        start, forever = face.proved
        lines += ["  every direction is proved from r = %s on, %s" % (
            decimal_text(start), "for ever" if forever else "up to the face's radius")
            if start is not None else "  not every direction is proved, even at the face's radius",
            "  the least r that is proved in some direction is %s" % decimal_text(least)]
    return lines


def report(file, problems, done, earlier, sampled):
    """The theorem, exactly as far as it was verified; or the result of a spot check."""
    claims = problems.claims
    proved, skipped = [sum([claim.counts[kind] for claim in claims])
                       for kind in ("proved", "symmetric")]
    whole = all(min(claim.half) >= 1 for claim in claims)
    if sampled:
        status, verdict = SPOT_CHECK, "spot check"
        lines = ["Spot check of %d of %d proved leaves, NOT a verification: none of them fails."
                 % (done.confirmed, proved), "What is claimed and NOT verified :"]
    else:
        status, verdict = (VERIFIED, "verified") if whole else (PART, "verified in part")
        lines = ["Verified" + ", for a part of the torus only" * (not whole)
                 + ", %d of %d leaves by an earlier run" % (earlier, proved) * (earlier > 0) + " :"]
    is_map = isinstance(file, Map)
    lines += mapped(file) if is_map else claimed(file)
    lines += [
        "", "Checker : converse-check " + __version__,
        "Method : Loewner criterion, multipliers, %sin integers%s" % (
            "in doubles and where these fail " * bool(problems.fast),
            "" if is_map else " of %d bits" % problems.criterion(0).fixed.bits)]
    if not is_map:
        places = 9
        criterion = problems.criterion(0)
        bound = -(-criterion.B * 10 ** places // criterion.fixed.one)       # rounded up
        lines += ["x* : %s %s" % tuple(map(decimal_text, file.xstar)),
                  "B : %s" % decimal_text(Fraction(bound, 10 ** places))]
        if file.alone is not None:
            lines += ["Alone : x%d, a map of its own" % file.alone]
    lines += ["Leaves : %d, of which %d proved and %d symmetric" % (
        proved + skipped, proved, skipped),
        "Proved leaves checked : %d, in %d pieces" % (done.confirmed, done.pieces)]
    if earlier:
        lines += ["Of these, by an earlier run whose state was believed : %d" % earlier]
    return Result(status, verdict, "\n".join(lines + ["SHA-256 : " + file.sha256]))
