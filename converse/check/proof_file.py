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
            "long orbits", "parameter", "comment"}
FIELDS = {*ANGLES, *COUNTS, *IGNORED, "kind", "at once", "wave", "frame", "alone", "odd about"}


def pair(value, name, form=NUMBER, count=0):
    """Two numbers, or count more."""
    words = value.split(" ", 9)
    if len(words) not in (2, 2 + count) or not all(map(form.fullmatch, words)):
        raise Rejected("%s is not two%s decimal numbers" % (
            name, " or %d" % (2 + count) if count else ""))
    return tuple([number(word, name, form) for word in words])


def place(xstar, v0, v1, name, count=0):
    """x*, centres and half-widths of v0 and v1, and their shifts by count parameters, if any."""
    ranges = [pair(v0, name + "v0", count=count), pair(v1, name + "v1", count=count)]
    if wrong := [angle for angle, (_, half, *_) in zip(ANGLES, ranges) if half < 0]:
        raise Rejected("%s%s: the half-width is negative" % (name, wrong[0]))
    centre, half, *shifts = zip(*[(x + (Fraction(0),) * count)[:2 + count] for x in ranges])
    shifts = tuple(shifts) * any(map(any, shifts))
    return xstar and pair(xstar, name + "xstar"), centre, half, shifts


def parse_part(letter, text, claim):
    """A part of a claim, of this letter or number, from what follows `part: `: four lines and a
    tree, of which nothing is there before its search begins."""
    name, found = "part " + letter, re.match(
        letter + "\nxstar: (.*)\nv0: (.*)\nv1: (.*)\ntree:(?:\n|$)", text)
    if not found:
        raise Rejected("%s is not 'part: %s', xstar, v0, v1 and a tree, each on its line"
                       % (name, letter))
    xstar, centre, half, shifts = place(*found.groups(), name + "'s ", claim.parameters)
    return replace(claim, xstar=xstar, centre=centre, half=half, shifts=shifts, where=name,
                   tree=text[found.end():].replace("\n", ""), counts={}, at_once="no")


def read_proof(file):
    """The claim of a container: of its header, and of a tree and perhaps parts, its body."""
    header = file.header
    tree, *parts = ("\n" + bytes(file.body).decode("latin-1")).split("\npart: ")

    def one_of(name, *values):
        if header[name] not in values:
            raise Rejected("the header's %s is neither %s" % (name, " nor ".join(values)))
        return header[name]

    xstar, centre, half, _ = place(*map(header.get, ("xstar", *ANGLES)), "the header's ")
    for name in COUNTS:
        if not re.fullmatch("[0-9]{1,18}", header[name], re.ASCII):
            raise Rejected("the header's %s is not a count" % name)
    at_once = one_of("at once", "yes", "no", "upper end")
    waves = parse_waves(header["wave"])
    frame = check_frame(header["frame"].split(" "), "the header's frame")
    alone = {"no": None, "0": 0, "1": 1}[one_of("alone", "no", "0", "1")]
    check_alone(waves, alone)
    odd = None if header["odd about"] == "no" else \
        pair(header["odd about"], "the header's odd about", RATIO)
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
    found = []
    for at, line in enumerate(lines, 1):
        title, words = "the header's parameter %d" % at, line.split(" ", 3)
        if len(words) != 3 or not NAME.fullmatch(words[0]) or words[0] in RESERVED:
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


def parse_waves(lines, form=NUMBER):
    """The waves of a header; their amplitudes have this form."""
    if not 0 < len(lines) <= MAX_WAVES:
        raise Rejected("the header has %d waves, not 1 to %d" % (len(lines), MAX_WAVES))
    waves = []
    for at, line in enumerate(lines, 1):
        words, name = line.split(" ", 9), "the header's wave %d" % at
        if not 4 <= len(words) <= 7:
            raise Rejected(name + " is not K0 K1 PHASE AMPLITUDE and at most three parts")
        if not all(re.fullmatch("[+-]?[0-9]{1,3}", word, re.ASCII) for word in words[:2]):
            raise Rejected(name + " has no integer k")
        k = tuple(map(int, words[:2]))
        if k == (0, 0) or max(map(abs, k)) > MAX_K:
            raise Rejected("%s has a k that is zero or beyond %d" % (name, MAX_K))
        phase = number(words[2], name, RATIO)
        middle, *parts = [number(word, name, form) for word in words[3:]]
        waves.append(Wave(k, phase, middle, tuple(parts)))
        if len(parts) != len(waves[0].parts):
            raise Rejected(name + " has not as many parts as the first")
    return tuple(waves)


PROOF = Format("proof", "6", "proof file", "tree", FIELDS, OPTIONAL, read_proof)
