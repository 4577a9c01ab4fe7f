"""Reading a proof file: nothing in it is believed but what the claim is."""

import re
from dataclasses import replace
from fractions import Fraction

from .claim import (ANGLES, LETTERS, NAME, NUMBER, RATIO, RESERVED, Claim, Wave, check_alone,
                    check_frame, number)
from .container import Format
from .failures import Rejected
from .limits import MAX_K, MAX_WAVES

COUNTS = ("depth", "cuts", "proved", "symmetric", "linked", "undecided", "most_cuts")
IGNORED = ("program", "method", "digits", "stubborn", "quick_tries", "tries", "Rtries", "reasons",
           "HermSuccess", "LLSuccess", "ll_used", "max_steps", "max_NTsteps", "pending")
OPTIONAL = {"xstar", "B", "T", "Tr-", "Tr+", "lambda-min", "lambda-max", "seconds", "hopeless",
            "long orbits", "parameter", "comment", "angles", "v2"}
FIELDS = {*ANGLES[:2], *COUNTS, *IGNORED, "kind", "at once", "wave", "frame", "alone", "odd about"}


def numbers(value, name, n=2, form=NUMBER, count=0):
    """n numbers, two or three, or count more."""
    words = value.split(" ", 9)
    if len(words) not in (n, n + count) or not all(map(form.fullmatch, words)):
        raise Rejected("%s is not %s%s decimal numbers" % (
            name, ("two", "three")[n - 2], " or %d" % (n + count) if count else ""))
    return tuple([number(word, name, form) for word in words])


def place(xstar, ranges, name, count=0):
    """x*, centres and half-widths of each v, and their shifts by count parameters, if any."""
    ranges = [numbers(text, name + v, count=count) for text, v in zip(ranges, ANGLES)]
    if wrong := [angle for angle, (_, half, *_) in zip(ANGLES, ranges) if half < 0]:
        raise Rejected("%s%s: the half-width is negative" % (name, wrong[0]))
    centre, half, *shifts = zip(*[(x + (Fraction(0),) * count)[:2 + count] for x in ranges])
    shifts = tuple(shifts) * any(map(any, shifts))
    return xstar and numbers(xstar, name + "xstar", len(ranges)), centre, half, shifts


def parse_part(letter, text, claim):
    """A part of a claim, of this letter or number, from what follows `part: `: lines and a tree, of
    which nothing is there before its search begins."""
    name, angles = "part " + letter, ANGLES[:len(claim.half)]
    found = re.match(letter + "\nxstar: (.*)\n%stree:(?:\n|$)" % "".join(
        [v + ": (.*)\n" for v in angles]), text)
    if not found:
        raise Rejected("%s is not 'part: %s', xstar, %s and a tree, each on its line"
                       % (name, letter, ", ".join(angles)))
    xstar, *ranges = found.groups()
    xstar, centre, half, shifts = place(xstar, ranges, name + "'s ", claim.parameters)
    return replace(claim, xstar=xstar, centre=centre, half=half, shifts=shifts, where=name,
                   tree=text[found.end():].replace("\n", ""), counts={}, at_once="no")


def read_proof(file):
    """The claim of a container: of its header, and of a tree and perhaps parts, its body."""
    header = file.header
    tree, *parts = ("\n" + bytes(file.body).decode("latin-1")).split("\npart: ")

    def one_of(name, *values):
        if header.get(name) not in values:
            raise Rejected("the header's %s is neither %s" % (
                name, " nor ".join(filter(None, values))))
        return header.get(name)

    n = 2 if one_of("angles", None, "3") is None else 3
    if ("v2" in header) != (n == 3):
        raise Rejected("the header has v2 without 'angles: 3', or this without v2")
    xstar, centre, half, _ = place(header.get("xstar"), map(header.get, ANGLES[:n]),
                                   "the header's ")
    for name in COUNTS:
        if not re.fullmatch("[0-9]{1,18}", header[name], re.ASCII):
            raise Rejected("the header's %s is not a count" % name)
    at_once = one_of("at once", "yes", "no", "upper end")
    waves = parse_waves(header["wave"], n=n)
    frame = check_frame(header["frame"].split(" "), "the header's frame", n)
    alone = {"no": None, "0": 0, "1": 1}[one_of("alone", "no", "0", "1")]
    check_alone(waves, alone)
    if n == 3 and alone is not None:
        raise Rejected("a coordinate is alone, and there are three")
    odd = None if header["odd about"] == "no" else \
        numbers(header["odd about"], "the header's odd about", n, RATIO)
    claim = Claim(waves, centre, half, frame, alone, xstar,
                  {name: int(header[name]) for name in COUNTS}, at_once, tree.replace("\n", ""),
                  file.sha256, names=parameter_names(header.get("parameter", ()), waves),
                  header=header)
    check_odd(claim, odd)
    if parts and alone is not None:
        raise Rejected("a coordinate is alone, and there are parts: links are of whole graphs")
    if len(parts) > len(LETTERS):
        raise Rejected("there are more parts than letters")
    return replace(claim, parts=tuple([parse_part(*each, claim) for each in zip(LETTERS, parts)]))


def parameter_names(lines, waves):
    """(name, value at t = -1, value at t = 1) of each parameter; () if the file names none.

    A parameter that moves a wave must have two values: then it is an affine function of t, and t
    one of it, so that the claim can be stated in it.
    """
    found, reserved = [], RESERVED if len(waves[0].k) > 2 else RESERVED[:-2]
    for at, line in enumerate(lines, 1):
        title, words = "the header's parameter %d" % at, line.split(" ", 3)
        if len(words) != 3 or not NAME.fullmatch(words[0]) or words[0] in reserved:
            raise Rejected(title + " is not a name of a parameter and two numbers")
        found.append((words[0], *[number(word, title) for word in words[1:]]))
    count = len(waves[0].parts)
    if found and (len(found) != count or len({name for name, _, _ in found}) != count):
        raise Rejected("the header does not name each parameter once")
    for at, (_, low, high) in enumerate(found):
        if low == high and any(wave.parts[at] for wave in waves):
            raise Rejected("the header's parameter %d has one value, and moves a wave" % (at + 1))
    return tuple(found)


def check_odd(claim, odd):
    """Rejected, if V is not odd about that point (in units of pi), or would have to be."""
    if odd and any((sum([k * s for k, s in zip(wave.k, odd)]) + wave.phase) % 1
                   for wave in claim.examined):
        raise Rejected("V is not odd about the point that the header names")
    if claim.at_once != "no" and not odd:
        raise Rejected("larger parameters are excluded at once only where V is odd about a point")
    if claim.at_once == "upper end" and claim.parameters != 1:
        raise Rejected("without exactly one parameter there is no upper end")


def parse_waves(lines, form=NUMBER, n=2):
    """The waves of a header, of n angles; their amplitudes have this form."""
    if not 0 < len(lines) <= MAX_WAVES:
        raise Rejected("the header has %d waves, not 1 to %d" % (len(lines), MAX_WAVES))
    waves = []
    for at, line in enumerate(lines, 1):
        words, name = line.split(" ", 9), "the header's wave %d" % at
        if not n + 2 <= len(words) <= n + 5:
            raise Rejected("%s is not %s PHASE AMPLITUDE and at most three parts" % (
                name, "K0 K1 K2"[:3 * n - 1]))
        if not all(re.fullmatch("[+-]?[0-9]{1,3}", word, re.ASCII) for word in words[:n]):
            raise Rejected(name + " has no integer k")
        k = tuple(map(int, words[:n]))
        if not any(k) or max(map(abs, k)) > MAX_K:
            raise Rejected("%s has a k that is zero or beyond %d" % (name, MAX_K))
        phase = number(words[n], name, RATIO)
        middle, *parts = [number(word, name, form) for word in words[n + 1:]]
        waves.append(Wave(k, phase, middle, tuple(parts)))
        if len(parts) != len(waves[0].parts):
            raise Rejected(name + " has not as many parts as the first")
    return tuple(waves)


PROOF = Format("proof", "6", "proof file", "tree", FIELDS, OPTIONAL, read_proof)
