"""Reading a proof file: nothing in it is believed but what the claim is."""

import hashlib
import io
import re
from dataclasses import replace
from fractions import Fraction

from .claim import (ANGLES, LETTERS, NAME, NUMBER, RATIO, RESERVED, Claim, Wave, check_alone,
                    check_frame, number)
from .failures import NotConfirmed, Rejected, Unusable
from .limits import MAX_K, MAX_LINE, MAX_WAVES

COUNTS = ("depth", "cuts", "proved", "symmetric", "linked", "undecided", "most_cuts")
IGNORED = ("program", "method", "digits", "stubborn", "quick_tries", "tries", "Rtries", "reasons",
           "HermSuccess", "LLSuccess", "ll_used", "max_steps", "max_NTsteps", "B", "pending")
OPTIONAL = {"T", "Tr-", "Tr+", "lambda-min", "lambda-max", "seconds", "hopeless", "parameter",
            "comment"}
FIELDS = {*ANGLES, *COUNTS, *IGNORED, "kind", "xstar", "at once", "wave", "frame", "alone",
          "odd about"}
REPEATED = {"wave", "parameter", "comment", "seen", "search"}
MAGIC, VERSION = b"converse proof ", b"6"       # the first line


def read_proof(data):
    """The claim of a proof file, if it is whole and has the checksum that it says."""
    if not data.startswith(MAGIC):
        raise Unusable("is a diagram, a portrait or a certificate of existence, which "
                       "converse-check verifies")
    head, tree, sha256 = sealed(data, MAGIC + VERSION, "proof file", b"tree:\n", "is no tree")
    return parse(bytes(head), bytes(tree).decode("latin-1"), sha256)


def sealed(data, first_line, kind, marker, lack):
    """What stands in a file before and after the line `marker`, which begins with this first line
    and has the checksum that it says, as memoryviews; and the SHA-256 of the whole.  kind, lack:
    what such a file is called, and that there is nothing after the marker, in words."""
    start = first_line.rindex(b" ") + 1
    first = data[start:start + 9].partition(b"\n")[0]
    if first.endswith(b"\r"):
        raise Rejected("its lines end in CR LF: it was altered on its way; ask for the original")
    if first != first_line[start:]:
        raise Unusable("is a %s of another version; this checker knows version %s"
                       % (kind, first_line[start:].decode()))
    checksum = b"checksum: sha256 "
    end = data.rfind(b"\n" + checksum) + 1
    end_line = data[end + len(checksum):]
    if not end or not re.fullmatch(b"[0-9a-f]{64}\nend\n", end_line):
        raise Rejected("the file does not end with its checksum; it is truncated or altered")
    view = memoryview(data)
    if end_line[:64] != hashlib.sha256(view[:end]).hexdigest().encode():
        raise Rejected("wrong checksum: the file was changed or damaged")
    at = data.find(b"\n" + marker, 0, end) + 1
    if not at:
        raise Rejected("there " + lack)
    return view[:at], view[at + len(marker):end], hashlib.sha256(view).hexdigest()


def header_fields(head, known):
    """The fields, each of them given once, and none of unknown meaning.

    Nothing of it is repeated in a message but the names of fields that are known.
    """
    header, file = {"wave": []}, io.BytesIO(head)
    file.readline()                     # which sealed has seen to
    for at, line in enumerate(iter(lambda: file.readline(MAX_LINE), b""), 2):
        if len(line) == MAX_LINE:
            raise NotConfirmed("line %d is longer than the checker's limit, %d bytes"
                               % (at, MAX_LINE - 1))
        name, colon, value = line.decode("utf-8", "replace").rstrip("\n").partition(": ")
        if not colon or name not in known:
            raise Rejected("line %d, in the header, is of unknown meaning" % at)
        if name in header and name not in REPEATED:
            raise Rejected("the header gives %s twice" % name)
        if name in REPEATED:
            header.setdefault(name, []).append(value)
        else:
            header[name] = value
    return header


def parse_header(head):
    header = header_fields(head, FIELDS | OPTIONAL)
    if "xstar" not in header:
        raise Rejected("the search had not begun when it was left; converse -r FILE begins it")
    if FIELDS - header.keys():
        raise Rejected("the header lacks %s" % ", ".join(sorted(FIELDS - header.keys())))
    if header["kind"] != "sound":
        raise Rejected("the file's kind is not 'sound': it is not meant as a proof")
    return header


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
    return pair(xstar, name + "xstar"), centre, half, tuple(shifts) * any(map(any, shifts))


def parse_part(text, letter, claim):
    """A part of a claim, from what follows `part: `: four lines and a tree."""
    name, found = "part " + letter, re.match(
        letter + "\nxstar: (.*)\nv0: (.*)\nv1: (.*)\ntree:\n", text)
    if not found:
        raise Rejected("%s is not 'part: %s', xstar, v0, v1 and a tree, each on its line"
                       % (name, letter))
    xstar, centre, half, shifts = place(*found.groups(), name + "'s ", claim.parameters)
    return replace(claim, xstar=xstar, centre=centre, half=half, shifts=shifts, where=name,
                   tree=text[found.end():].replace("\n", ""), counts={}, at_once="no")


def parse(head, tree, sha256):
    """The claim of a header, and of what follows it: a tree, and perhaps parts."""
    header = parse_header(head)
    tree, *parts = ("\n" + tree).split("\npart: ")

    def one_of(name, *values):
        if header[name] not in values:
            raise Rejected("the header's %s is neither %s" % (name, " nor ".join(values)))
        return header[name]

    xstar, centre, half, _ = place(*[header[x] for x in ("xstar", *ANGLES)], "the header's ")
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
                  sha256, names=parameter_names(header.get("parameter", ()), waves))
    check_odd(claim, odd)
    if len(parts) > len(LETTERS):
        raise Rejected("there are more parts than letters")
    if parts and alone is not None:
        raise Rejected("a coordinate is alone, and there are parts: links are of whole graphs")
    return replace(claim, parts=tuple([parse_part(text, letter, claim)
                                       for text, letter in zip(parts, LETTERS)]))


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
