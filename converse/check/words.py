"""The theorem that was verified, in words: neither more nor less."""

import textwrap
from fractions import Fraction

from .claim import ANGLES, RANGES, THESIS, Wave, present
from .cover import symmetries_used

WIDTH = 100                             # characters of a line
NUMBERS = {1: "one angle", 2: "two angles", 3: "three angles"}
GRAPH = {1: ["has no rotational invariant circle",
             "(no invariant graph J = P + S'(y), P constant, S periodic and C1)"],
         **{n: ["has no invariant Lagrangian graph",
                "(no invariant torus J = P + S'(y) over %s angles, P constant, S periodic and C1)"
                % words] for n, words in ((2, "both"), (3, "all three"))}}
QUARTERS = ("sin", 1), ("cos", 1), ("sin", -1), ("cos", -1)     # sin(y + n pi/2): function, sign


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
    low, high = exact_text(low), exact_text(high)
    return "%s = %s" % (name, low) if low == high else "%s <= %s <= %s" % (low, name, high)


def exact_text(x):
    """A rational number, as a decimal if it is a finite one."""
    rest = x.denominator
    for p in (2, 5):
        while rest % p == 0:
            rest //= p
    return decimal_text(x) if rest == 1 else str(x)


def sum_text(coefficients, names):
    """The sum of rational numbers times names, without terms that are 0; the name "" is 1."""
    text = ""
    for x, name in zip(coefficients, names):
        if x:
            text += (" - " if x < 0 else " + ") if text else "-" * (x < 0)
            text += name if abs(x) == 1 and name else " ".join(
                filter(None, (exact_text(abs(x)), name)))
    return text or "0"


def frame_text(frame):
    """The angles that v stands for, such as (v0 + v1, v0 - v1)."""
    return "(%s)" % ", ".join([sum_text(row, ANGLES) for row in frame])


def amplitude_in(wave, names):
    """The amplitude of the wave as a sum: its terms as (factor, name) without those that are 0.

    names: of each parameter t of the wave (name, value at t = -1, value at t = 1).  The named
    parameter is the affine function of t with these values, so the sum is exact.  The name of the
    constant is "".
    """
    constant, moving = wave.middle, []
    for g, (name, low, high) in zip(wave.parts, names):
        if g:
            slope = 2 * g / (high - low)
            constant -= slope * (low + high) / 2
            moving.append((slope, name))
    return [(constant, "")] * bool(constant) + moving


def terms(waves, names, letters, factors, quarters):
    """The terms factor A sin(k.y + phase + quarters pi/2) of the waves: numbers and what each of
    them multiplies, in words."""
    numbers, texts = [], []
    for wave, factor in zip(waves, factors):
        form, angle = amplitude_in(wave, names), sum_text(wave.k, letters)
        function, sign = QUARTERS[quarters]
        if (2 * wave.phase).denominator == 1:
            function, sign = QUARTERS[int(2 * wave.phase + quarters) % 4]
        else:
            angle += " %s %s pi" % ("-" if wave.phase < 0 else "+", abs(wave.phase))
        text = function + (" " + angle if angle in letters else "(%s)" % angle)
        if len(form) > 1:
            form = [(1, "(%s)" % sum_text(*zip(*form)))]
        for x, name in form:
            numbers.append(factor * sign * x)
            texts.append((name + " " + text).strip())
    return numbers, texts


def map_lines(waves, names, dimension):
    """The map, its potential and its force, exactly, in lines.  names: as of amplitude_in()."""
    letters, momenta = ["y"] if dimension == 1 else ["y%d" % i for i in range(dimension)], []
    for i, letter in enumerate(letters):
        J = "J" + letter[1:]
        numbers, texts = terms(waves, names, letters, [wave.k[i] for wave in waves], 1)
        momenta.append("%s' = %s" % (J, sum_text([1, *numbers], [J, *texts])))
    potential = sum_text(*terms(waves, names, letters, [-1] * len(waves), 0))
    lines = ["THEOREM.  The map y' = y + J', J' = J - %s (modulo 2 pi)," % (
        "%s(y) of %s y" % ("V'" if dimension == 1 else "grad V", NUMBERS[dimension]))]
    for text in "V(y) = " + potential, "that is, " + momenta[0], *momenta[1:]:
        lines += textwrap.wrap(text + ",", WIDTH, subsequent_indent="    ", break_long_words=False,
                               break_on_hyphens=False)
    return lines


def ordinary_names(count):
    """The names of parameters that a file does not name: as of amplitude_in()."""
    return tuple([("t%d" % m, Fraction(-1), Fraction(1)) for m in range(1, count + 1)])


# The map of the thesis's potential, for any a, b and c.
THESIS_LINES = map_lines(
    [Wave(k, Fraction(0), Fraction(0), tuple([Fraction(m == j) for j in range(3)]))
     for m, k in enumerate(THESIS)], [(name, Fraction(-1), Fraction(1)) for name in RANGES], 2)


def is_boxed(claim):
    """Is it stated in the thesis's a, b and c?  They are the parameters, or move together and none
    of them downwards, or are fixed."""
    return [(wave.k, wave.phase) for wave in claim.waves] == [(k, 0) for k in THESIS] \
        and not claim.names and claim.parameters in (0, 1, 3) and all(
            g >= 0 if claim.parameters == 1 else m == w or g == 0
            for w, wave in enumerate(claim.waves) for m, g in enumerate(wave.parts))


def successors(claim):
    """The y' after x* that are examined, in units of pi: (name, lower end, upper end) of each
    coordinate.  Of one angle, by step (C29), all that the region has of the first angle."""
    if claim.dimension > 1:
        return [(name + " / pi", c - h, c + h)
                for name, c, h in zip(ANGLES, claim.centre, claim.half)]
    c, h = [sum([f * x for f, x in zip(row, values)]) for row, values in (
        (claim.rows[0], claim.centre), (map(abs, claim.rows[0]), claim.half))]
    return [("y' / pi", c - h, c + h)]


def claimed(claim):
    """The claim of a proof file, in lines."""
    names = claim.names or ordinary_names(claim.parameters)
    whole = symmetries_used(claim) is not None
    if is_boxed(claim):
        lines, larger = THESIS_LINES, "multiple s >= 1 of %s (B > 10/3)" % (
            "the upper ends of these ranges" if claim.at_once == "upper end" else "such parameters")
        ranges = [range_text(name, *sorted([wave.at([t] * claim.parameters) for t in (-1, 1)]))
                  for name, wave in zip(RANGES, claim.waves)]
        if claim.parameters == 1:
            ranges += ["moving together, on the segment from all lower to all upper ends"]
    else:
        lines, larger = map_lines(claim.waves, names, claim.dimension), multiples(claim, names)
        ranges = [range_text(name, *sorted(ends)) for name, *ends in names if ends[0] != ends[1]]
    lines = [*lines, *GRAPH[claim.dimension]]
    if not whole:
        lines += ["whose orbit goes from y = x* to y'%s in the region" % (
                      (" = " + frame_text(claim.rows)) * (claim.dimension > 1)),
                  *[range_text(*ends) for ends in successors(claim)],
                  "(no other y' was examined, and the region is not the full torus)"]
    lines[-1] += " for any parameters with" * bool(ranges)
    lines += [*ranges, *["and for any " + larger] * (claim.at_once != "no")]
    flat = {tuple(map(bool, wave.k)) for wave in present(claim.waves)}
    if whole and claim.dimension == 2 and flat in ({(True, False)}, {(False, True)}):
        lines += ["So the map of y%d alone %s." % (flat == {(False, True)}, GRAPH[1][0])]
    return lines


def multiples(claim, names):
    """The larger potentials of which the claim may be.  If V is a parameter times a function, they
    are those of this parameter beyond its value at t = 1."""
    name, _, end = names[0] if claim.at_once == "upper end" else ("", 0, 0)
    if end and {x for wave in claim.waves for _, x in amplitude_in(wave, names)} == {name}:
        return "%s %s %s (since B > 10/3)" % (name, "><"[end < 0], exact_text(end))
    return "multiple of %s, by a factor >= 1 (since B > 10/3)" % (
        "V at %s = %s" % (name, exact_text(end)) if name else "such a V")
