"""converse-check: verifies the theorem of a proof file, independently of the program that wrote it.

The map.  V(y) = - sum over waves of p sin(k.y + phase), k of two integers, p affine in at most
three parameters;  x[j+1] = 2 x[j] - x[j-1] - V'(x[j]);  beta(x) = 2I - V''(x).  (The thesis's V has
the waves (1, 0), (0, 1) and (1, 1), without phase, with p = a, b and c.)
Its orbits are stationary for the sum of |x[j+1] - x[j]|^2 / 2 - V(x[j]), whose second variation is
Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1].

The criterion (the Loewner criterion of converse KAM, by its witness).
1. Orbits on an invariant graph p = P + S'(x), S of class C1, minimize (MacKay, Meiss and Stark,
   Nonlinearity 2, 1989).  For F(x, y) = |y - x|^2 / 2 - V(x) + P.(x - y) + S(x) - S(y) has a least
   value over y, taken where y - x = P + S'(y), that is at the successor of x on the graph alone;
   as a function of x this least value has the derivative dF/dx = 0 there (Danskin), so it is
   constant, and no other segment between the same ends sums up to less.  So Q(n) >= 0 for every
   finite sequence n; hence also for every square-summable one, since beta is bounded.
   A graph lies over the whole torus: it has an orbit through x[0] = x*, and x[1] is somewhere.
2. Let B > 2 bound the largest eigenvalue of beta over the torus and the parameters, and let
   l = 2 / (B + sqrt(B^2 - 4)), the lesser root of l + 1/l = B.  Choose n[s..t] at will and let it
   decay outside as n[s-k] = l^k n[s], n[t+k] = l^k n[t].  Each tail adds at most
       |n|^2 (sum over k > 0 of B l^(2k) - 2 l^(2k-1)) = |n|^2 (B l^2 - 2l)/(1 - l^2) = -l |n|^2.
3. So no minimizing orbit passes through a set of orbits on all of which, for some n,
       sum over s..t of n[j].beta(x[j])n[j] - 2 sum n[j].n[j+1] - l (|n[s]|^2 + |n[t]|^2) < 0.
Such an n exists for one orbit if and only if the recursion d[s] = beta - l, d[j+1] = beta - 1/d[j]
leads to a d[j] that is not above l: eliminate n[s], n[s+1], ... in turn.  That recursion, from both
ends and in double precision, is how n is found; but no bound rests on it, as any n will do.

The left side of 3 is a sum of terms p sin(k.x + phase) with known weights.  Over a prism each term
is enclosed by a first-order Taylor model in the parameters and the two angles of x[1] (and in one
new symbol for every error made on the way), so the sum is bounded as a whole: effects that cancel,
cancel.

The arithmetic.  Python integers, in units of 2^-bits: exact, unbounded, and each rounding, a >> or
a //, is to be seen where it happens.  Errors are counted in units.

The fast path.  Where there is numpy, a thousand prisms at a time are tried in doubles first, by a
bound of the left side of 3 that is linear in the length of the orbits; its section has the proof.
What it does not exclude is decided in integers, as all is with --exact.

This file shares no code with the prover: of the package it takes the version, for its report, and
nothing else; and it needs nothing but Python, so a copy of this one file will do.

What is said.  "Rejected" is a file that is wrong whatever the truth about the map: altered, without
a whole and decided tree, with a leaf skipped whose mirror image is not proved.  A leaf that is not
excluded is not thereby refuted, since a longer orbit might exclude it: then the file is "not
confirmed".  docs/format.md has the format and the exit statuses.
"""

import argparse
import collections
import contextlib
import functools
import gzip
import hashlib
import heapq
import io
import itertools
import json
import math
import os
import random
import re
import signal
import stat
import sys
import tempfile
import threading
import time
import zlib
from array import array
from dataclasses import dataclass
from fractions import Fraction

try:
    from converse.version import __version__
except ImportError:                     # the file also works alone
    __version__ = "(standing alone)"

VERIFIED, REJECTED, UNUSABLE, PART, SPOT_CHECK, NOT_CONFIRMED = range(6)    # exit statuses
INTERRUPTED = 128                       # and the number of the signal
MAX_BYTES = 1 << 28                     # of a proof file, uncompressed
MAX_CUTS = 1000                         # of a leaf
MAX_LINE = 1 << 24                      # of the header
MAX_CHARACTERS = 1000                   # of a number in the header
MAX_SIZE = 10 ** 300                    # of such a number
MAX_BITS = 4096                         # of the arithmetic
MAX_HALVINGS, MAX_PIECES = 24, 4096     # of a leaf, by the checker itself
LAG = 4                                 # halvings along one axis that another may be behind
MAX_POINTS = 330                        # of an orbit
MAX_WAVES, MAX_K = 16, 100              # of a potential; |k0| and |k1|
MAX_ITEMS = 1 << 22                     # of a map
MAX_CELLS = 1 << 15                     # of the torus, about, when B is bounded
CHUNKS, CHUNK = 8, 16                   # tasks of a process, about; leaves of one, with --exact
FAST_CHUNK = 1 << 8, 1 << 14            # least and most of the fast path
NU_BITS = 20                            # of the test vectors
STATE_SECONDS, BAR_SECONDS = 10, 0.2    # between two writes
LOOK_SECONDS = 0.1                      # a signal waits so long at most


class Failure(Exception):
    """Nothing was verified; the text says why."""


class Rejected(Failure):
    """The file is wrong, whatever the truth about the map may be."""

    status, word = REJECTED, "rejected: "


class NotConfirmed(Failure):
    """The checker has reached a limit of its own: what the file claims may be true or false."""

    status, word = NOT_CONFIRMED, "not confirmed: "


class Unusable(Failure):
    """The arguments or the file cannot be used at all."""

    status, word = UNUSABLE, ""


# ---- the proof file

RANGES = ("a", "b", "c")                # of version 2
ANGLES = ("v0", "v1")
AXES = "01234"                          # of cuts: v0, v1, then the parameters
COUNTS = ("depth", "cuts", "proved", "symmetric", "undecided", "most_cuts")
IGNORED = ("program", "method", "digits", "stubborn", "quick_tries", "tries", "Rtries",
           "HermSuccess", "LLSuccess", "ll_used", "reasons", "max_steps", "max_NTsteps",
           "B", "pending")
OPTIONAL = {"T", "Tr-", "Tr+", "lambda-min", "lambda-max", "seconds", "comment"}    # ignored, too
ALWAYS = {*ANGLES, *COUNTS, *IGNORED, "kind", "xstar", "at once"}
FIELDS = {b"2": {*ALWAYS, *RANGES, "together"},
          b"3": {*ALWAYS, "wave", "frame", "alone", "odd about"}}
REPEATED = {"wave", "comment"}
DECIMAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
NUMBER = re.compile(DECIMAL, re.ASCII)
RATIO = re.compile("[+-]?[0-9]+/0*[1-9][0-9]*|" + DECIMAL, re.ASCII)
THESIS = (1, 0), (0, 1), (1, 1)         # k of the three waves of the thesis
IDENTITY = (1, 0, 0, 1)

MAGIC = b"converse proof "               # and the version, alone on the first line


def reason(error):
    """An OSError in words."""
    return getattr(error, "strerror", None) or str(error)


@dataclass(frozen=True)
class Wave:
    """-p sin(k.y + pi phase), p = middle + sum of parts[m] t[m] for parameters -1 <= t[m] <= 1."""

    k: tuple
    phase: Fraction
    middle: Fraction
    parts: tuple

    def at(self, t):
        return self.middle + sum([g * x for g, x in zip(self.parts, t)])


def present(waves):
    """Those whose amplitude is not always zero."""
    return tuple(wave for wave in waves if wave.middle or any(wave.parts))


@dataclass(frozen=True)
class Claim:
    """What a proof file says, or a proved cell of a map: exact; v0 and v1 in units of pi."""

    waves: tuple
    centre: tuple                       # of v0 and v1
    half: tuple
    frame: tuple                        # x[1] = (frame[0] v0 + frame[1] v1, the same with 2 and 3)
    alone: object                       # the only coordinate that is looked at, or None
    xstar: tuple
    counts: dict
    at_once: str                        # does the claim cover larger multiples: yes, no, upper end
    tree: str
    sha256: str                         # of the file, uncompressed
    where: str = ""                     # of a cell of a map: which it is

    @property
    def parameters(self):
        return len(self.waves[0].parts)

    @property
    def felt(self):
        """The waves that count.  If none feels both coordinates the map is a product, and Q(n) for
        n = (n[0], 0) is the second variation of the first factor: it is the one of the map that has
        the first factor's waves alone, whose other coordinate moves freely and adds nothing
        negative to it.  So what excludes an orbit of that map for any n excludes it of this one."""
        return tuple(wave for wave in present(self.waves)
                     if self.alone is None or wave.k[self.alone])


def load(path):
    """The bytes of a proof file or of a map, uncompressed."""
    try:
        with open(path, "rb") as file:
            packed = file.peek(2)[:2] == b"\x1f\x8b"
            stream = gzip.GzipFile(fileobj=file) if packed else file
            data = bytearray(stream.read(len(MAGIC)))
            if data != MAGIC and not data.startswith(b"{"):
                raise Unusable("is not a proof file")
            while (more := stream.read(1 << 20)) and len(data) <= MAX_BYTES:
                data += more
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise Unusable("the compressed file is damaged or truncated") from None
    except (OSError, ValueError) as error:
        raise Unusable("cannot be read (%s)" % reason(error)) from None
    if len(data) > MAX_BYTES:
        raise NotConfirmed("the file is larger than %d bytes, the checker's limit" % MAX_BYTES)
    return data


def read(path):
    """Reads a proof file, or a map; nothing in it is believed but what the claim is."""
    data = load(path)
    if data.startswith(b"{"):
        return read_map(data)
    first = data[len(MAGIC):len(MAGIC) + 9].partition(b"\n")[0]
    if first.endswith(b"\r"):
        raise Rejected("its lines end in CR LF: it was altered on its way; ask for the original")
    if bytes(first) not in FIELDS:
        raise Unusable("is a proof file of another version; this checker knows versions 2 and 3")
    marker = b"checksum: sha256 "
    end = data.rfind(b"\n" + marker) + 1
    end_line = data[end + len(marker):]
    if not end or not re.fullmatch(b"[0-9a-f]{64}\nend\n", end_line):
        raise Rejected("the file does not end with its checksum; it is truncated or altered")
    whole = memoryview(data)
    if end_line[:64] != hashlib.sha256(whole[:end]).hexdigest().encode():
        raise Rejected("wrong checksum: the file was changed or damaged")
    start = data.find(b"\ntree:\n", 0, end) + 1
    if not start:
        raise Rejected("there is no tree")
    tree = data[start + len(b"tree:\n"):end].translate(None, b"\n").decode("latin-1")
    return parse(bytes(whole[:start]), tree, hashlib.sha256(whole).hexdigest())


def number(text, name, form=NUMBER):
    """The exact number that the text is, within the checker's limits."""
    if len(text) > MAX_CHARACTERS:
        raise NotConfirmed("%s has more than %d characters, the checker's limit"
                           % (name, MAX_CHARACTERS))
    if not form.fullmatch(text):
        raise Rejected("%s is not a decimal number%s" % (name, " or ratio" * (form is RATIO)))
    value = Fraction(text)
    if abs(value) > MAX_SIZE:
        raise NotConfirmed("%s is out of range: the checker's limit is 1e300" % name)
    return value


def parse(head, tree, sha256):
    """The claim; the header must give each field once, and nothing of unknown meaning.

    Nothing of it is repeated in a message but the names of fields that are known.
    """
    header, file = {"wave": []}, io.BytesIO(head)
    version = file.readline()[len(MAGIC):].rstrip()     # which read has seen to
    fields = FIELDS[version]
    for at, line in enumerate(iter(lambda: file.readline(MAX_LINE), b""), 2):
        if len(line) == MAX_LINE:
            raise NotConfirmed("line %d is longer than the checker's limit, %d bytes"
                               % (at, MAX_LINE - 1))
        name, colon, value = line.decode("utf-8", "replace").rstrip("\n").partition(": ")
        if not colon or name not in fields | OPTIONAL:
            raise Rejected("line %d, in the header, is of unknown meaning" % at)
        if name in header and name not in REPEATED:
            raise Rejected("the header gives %s twice" % name)
        if name == "wave":
            header[name].append(value)
        else:
            header[name] = value
    if "xstar" not in header:
        raise Rejected("the search had not begun when it was left: there is no x* yet")
    if fields - header.keys():
        raise Rejected("the header lacks %s" % ", ".join(sorted(fields - header.keys())))
    if header["kind"] != "sound":
        raise Rejected("the file's kind is not 'sound': it is not meant as a proof")

    def pair(name, form=NUMBER):
        words = header[name].split(" ", 2)
        if len(words) != 2 or not all(map(form.fullmatch, words)):
            raise Rejected("the header's %s is not two decimal numbers" % name)
        return tuple(number(word, "the header's " + name, form) for word in words)

    def one_of(name, *values):
        if header[name] not in values:
            raise Rejected("the header's %s is neither %s" % (name, " nor ".join(values)))
        return header[name]

    ranges = [pair(name) for name in (RANGES if version == b"2" else ()) + ANGLES]
    xstar = pair("xstar")
    if min(half for _, half in ranges) < 0:
        raise Rejected("a half-width is negative")
    for name in COUNTS:
        if not re.fullmatch("[0-9]{1,18}", header[name], re.ASCII):
            raise Rejected("the header's %s is not a count" % name)
    *ranges, v0, v1 = ranges
    frame, alone, odd = IDENTITY, None, (Fraction(0), Fraction(0))
    if version == b"2":
        together = one_of("together", "yes", "no") == "yes"
        at_once = one_of("at once", "yes", "no").replace("yes", "upper end" if together else "yes")
        waves = tuple(
            Wave(k, Fraction(0), middle, (half,) if together else
                 tuple(half if k == other else Fraction(0) for other in THESIS))
            for k, (middle, half) in zip(THESIS, ranges))
    else:
        at_once = one_of("at once", "yes", "no", "upper end")
        waves = parse_waves(header["wave"])
        frame = check_frame(header["frame"].split(" "), "the header's frame")
        alone = {"no": None, "0": 0, "1": 1}[one_of("alone", "no", "0", "1")]
        check_alone(waves, alone)
        odd = None if header["odd about"] == "no" else pair("odd about", RATIO)
    claim = Claim(waves, *zip(v0, v1), frame, alone, xstar,
                  {name: int(header[name]) for name in COUNTS}, at_once, tree, sha256)
    if odd and any((sum([k * s for k, s in zip(wave.k, odd)]) + wave.phase) % 1
                   for wave in claim.felt):
        raise Rejected("V is not odd about the point that the header names")
    if at_once != "no" and not odd:
        raise Rejected("larger parameters are excluded at once only where V is odd about a point")
    if at_once == "upper end" and claim.parameters != 1:
        raise Rejected("without exactly one parameter there is no upper end")
    return claim


def parse_waves(lines):
    """The waves of a header."""
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
        middle, *parts = [number(word, name) for word in words[3:]]
        waves.append(Wave(k, phase, middle, tuple(parts)))
        if len(parts) != len(waves[0].parts):
            raise Rejected(name + " has not as many parts as the first")
    return tuple(waves)


def check_frame(words, name):
    """The frame: four integers (as text) of a change of coordinates of the torus."""
    if len(words) != 4 or not all(re.fullmatch("[+-]?[0-9]{1,3}", word, re.ASCII)
                                  for word in words):
        raise Rejected(name + " is not four integers")
    a, b, c, d = frame = tuple(map(int, words))
    if max(map(abs, frame)) > MAX_K:
        raise Rejected("%s has an entry beyond %d" % (name, MAX_K))
    if abs(a * d - b * c) != 1:
        raise Rejected(name + " has not determinant 1 or -1")
    return frame


def check_alone(waves, alone):
    if alone is not None and any(all(wave.k) for wave in present(waves)):
        raise Rejected("no coordinate is alone: a wave feels both")


# ---- the tree
# A cell (index, cuts) is slice index[k] of the 2^cuts[k] equal slices of the region along each of
# the axes k.  Cutting a cell replaces it by its two halves, so the leaves of a complete tree
# tile the region exactly.

ROOT = (0,) * 5, (0,) * 5


def changed(values, axis, value):
    return values[:axis] + (value,) + values[axis + 1:]


def leaves(tree, axes=AXES, kinds="PSU"):
    """Yields (position, cell) for each leaf, in preorder; Rejected if it is not a whole tree."""
    pending = [((0,) * len(axes),) * 2]
    for position, node in enumerate(tree):
        if not pending:
            raise Rejected("the tree ends before its text does, at node %d" % position)
        index, cuts = cell = pending.pop()
        axis = axes.find(node)
        if axis >= 0:
            cuts = changed(cuts, axis, cuts[axis] + 1)
            pending += ((changed(index, axis, 2 * index[axis] + upper), cuts) for upper in (1, 0))
        elif node in kinds:
            yield position, cell
        else:
            raise Rejected("%a is not a node of a finished tree, at node %d" % (node, position))
        if sum(cuts) > MAX_CUTS:
            raise NotConfirmed("node %d lies below %d cuts, the checker's limit"
                               % (position, MAX_CUTS))
    if pending:
        raise Rejected("the tree is incomplete: %d of its parts are missing" % len(pending))


def tree_counts(claim):
    """What the tree has, counted; Rejected, if it is not whole and decided."""
    total = most_cuts = deepest = 0
    if set(AXES[2 + claim.parameters:]) & set(claim.tree):
        raise Rejected("the tree cuts a parameter that there is not")
    for position, (_, cuts) in leaves(claim.tree):
        total += 1
        depth = sum(cuts)
        if claim.tree[position] == "U":
            raise Rejected("leaf %d is undecided: the file claims no theorem" % total)
        deepest = max(deepest, depth)
        if claim.tree[position] == "P":
            most_cuts = max(most_cuts, depth)
    return {"cuts": total - 1, "proved": claim.tree.count("P"),
            "symmetric": claim.tree.count("S"), "undecided": 0, "most_cuts": most_cuts,
            "depth": deepest}


def check_tree(claim):
    """Rejected, if the tree is not whole, decided, and what the header's counts say."""
    found = tree_counts(claim)
    if found.pop("depth") > claim.counts["depth"]:
        raise Rejected("a leaf was cut more often than the depth allows")
    for name, value in found.items():
        if claim.counts[name] != value:
            raise Rejected("the header's %s is %d, the tree's %d"
                           % (name, claim.counts[name], value))


def coefficients(waves, swap=False, order=None):
    """V as the coefficients of sin(k.y + pi phase), k0 > 0 or k0 = 0 < k1, 0 <= phase < 1, in the
    middle and of each parameter; the coordinates exchanged, the parameters in another order."""
    found = {}
    for wave in waves:
        k, phase = wave.k[::-1] if swap else wave.k, wave.phase
        if k < (0, 0):                          # sin(x) = sin(pi - x)
            k, phase = (-k[0], -k[1]), 1 - phase
        sign = -1 if phase // 1 % 2 else 1      # sin(x + pi) = -sin(x)
        parts = [wave.parts[m] for m in order] if order else wave.parts
        key = k, phase % 1
        found[key] = [old + sign * new for old, new in
                      zip(found.get(key, [0] * (1 + len(parts))), (wave.middle, *parts))]
    return {key: value for key, value in found.items() if any(value)}


class Mirror:
    """The exchange of the two coordinates: may a leaf be skipped for the sake of its mirror image?

    It maps the graphs of V to those of V with its coordinates exchanged.  Where this is V for
    parameters in another order, t'[m] = t[order[m]], the orbits from x* to a cell are mapped to
    those from the image of x* to the image of the cell, with its parameters in that order.
    """

    def __init__(self, claim):
        (v0, v1), waves = zip(claim.centre, claim.half), claim.felt
        self.orders = []                                    # of the parameters
        if v0 == v1 and claim.xstar[0] == claim.xstar[1] and claim.frame == IDENTITY:
            # V(sigma y; t) = V(y; t'):  the part of t[order[m]] is, exchanged, that of t'[m].
            self.orders = [order for order in ((1, 0, 2), (0, 1, 2), (0, 2, 1), (2, 1, 0),
                                               (1, 2, 0), (2, 0, 1), (1, 0), (0, 1), (0,), ())
                           if len(order) == claim.parameters
                           and coefficients(waves, True, order) == coefficients(waves)]
        self.tree = claim.tree
        self.upper = array("i", [0]) * len(self.tree)       # where a node's upper half begins
        unfinished = []                                     # nodes whose lower half goes on
        for position, node in enumerate(self.tree):
            if node in AXES:
                unfinished.append(position)
            elif unfinished:
                self.upper[unfinished.pop()] = position + 1

    def refusal(self, cell):
        """Why the symmetric leaf may not be skipped, or None if its mirror image is proved."""
        if not self.orders:
            return "is skipped, but the problem is not symmetric"
        slices = list(zip(*cell))
        for order in self.orders:
            image = [slices[1], slices[0], *(slices[2 + m] for m in order)]
            if self.is_proved(tuple(image + slices[len(image):])):
                return None
        return "is skipped, but its mirror image is not proved"

    def is_proved(self, image):
        """Is every leaf P that overlaps these slices?"""
        todo = [(0, image)]                 # a node, and the image's cell within that node
        while todo:
            position, image = todo.pop()
            node, lower = self.tree[position], position + 1
            if node == "P":
                continue
            axis = AXES.find(node)
            if axis < 0:
                return False
            halves = lower, self.upper[position]
            index, cuts = image[axis]
            if cuts == 0:                                   # the image has both halves
                todo += [(half, image) for half in halves]
            else:
                rest = index & (1 << cuts - 1) - 1, cuts - 1
                todo.append((halves[index >> cuts - 1], changed(image, axis, rest)))
        return True


def check_mirror_images(claim):
    """Rejected, if a leaf is skipped by symmetry that may not be."""
    if "S" not in claim.tree:
        return
    mirror, skipped = Mirror(claim), 0
    for position, cell in leaves(claim.tree):
        if claim.tree[position] == "S":
            why = mirror.refusal(cell)
            if why:
                raise Rejected(leaf_text(claim, "S", skipped, cell) + " " + why)
            skipped += 1


# ---- fixed-point numbers: integers in units of 2^-bits

GUARD = 64                              # more bits, in which constants are computed
SLICES = 256                            # of the circle, in the table of sines and cosines
SINE_ERROR = 16                         # units; see Fixed.sincos
PARAMETER_ERROR = 40                    # units; see Criterion and its piece


def arctan_inverse(n, one):
    """arctan(1/n) in units of 1/one, off by less than a unit per term (alternating series)."""
    total, power, k = 0, one // n, 1
    while power:
        total += power // k if k & 2 == 0 else -(power // k)
        power //= n * n
        k += 2
    return total


def upper_sqrt(n):
    """The least integer not below the root of n >= 0."""
    return math.isqrt(n - 1) + 1 if n > 0 else 0


class Fixed:
    """The units, pi, sines and cosines."""

    def __init__(self, bits):
        self.bits, self.one = bits, 1 << bits
        fine = bits + GUARD
        # Machin's formula, off by less than 16 units per term, far less than 2^GUARD in all.
        two_pi = 8 * (4 * arctan_inverse(5, 1 << fine) - arctan_inverse(239, 1 << fine))
        self.two_pi = two_pi                                # in fine units
        self.pi = two_pi >> GUARD + 1                       # pi, off by less than 2 units
        self.step = two_pi // SLICES                        # of the table, in fine units
        self.steps_per_radian = (SLICES << 128) // (two_pi >> bits)         # units of 2^-64
        self.divisors = self._divisors(bits)
        # Rotations by a step, in fine units; each adds less than 2^10 of them to the error, so
        # an entry is off by little more than the unit of its last rounding.
        c, s = self._small(self.step, fine, self._divisors(fine))
        x, y = 1 << fine, 0
        self.table = []
        for _ in range(SLICES):
            self.table.append((y >> GUARD, x >> GUARD))
            x, y = x * c - y * s >> fine, y * c + x * s >> fine

    @staticmethod
    @functools.lru_cache(maxsize=16)
    def of(bits):
        return Fixed(bits)

    def angle(self, phase):
        """pi phase, modulo 2 pi, off by less than 2 units."""
        return math.floor(phase % 2 * self.two_pi / 2) >> GUARD

    @staticmethod
    def _divisors(bits):
        """n (n - 1) and n (n + 1) for even n, downwards, as many as _small needs."""
        n = 2
        while math.factorial(n + 2) << 5 * (n + 2) < 1 << bits:
            n += 2
        return [(m * (m - 1), m * (m + 1)) for m in range(n, 0, -2)]

    @staticmethod
    def _small(r, bits, divisors):
        """The cosine and sine of |r| <= 1/32, each within 4 units.

        Horner's form of Taylor's series, with z = r^2 <= 2^-10.  The first term left out is below
        a unit; the floor of z costs half a unit, those of an order two units, which the orders
        after it make 2^-10 as large, and the last product one.
        """
        one, z = 1 << bits, r * r >> bits
        c = s = one
        for even, odd in divisors:
            c = one - (c * z >> bits) // even
            s = one - (s * z >> bits) // odd
        return c, s * r >> bits

    def sincos(self, x):
        """The sine and cosine of x (units), each within SINE_ERROR units, even if x is off by 2.

        x = n steps + r, r off by 2 units.  In the sum formulas a number of the table is off by
        2 units, one of r by 4 and by 2 more for r, and their factors are a sine and a cosine, of
        sum at most 1.5: less than 1.5 (2 + 6) + 1 units, and 2 more for those of x.
        """
        bits = self.bits
        n = (x * self.steps_per_radian >> bits) + (1 << 63) >> 64
        if abs(n) > 1 << 32:            # n times the error of a step must stay below a unit
            raise OverflowError("an angle is too large")
        c, s = self._small(x - (n * self.step >> GUARD), bits, self.divisors)
        sin, cos = self.table[n % SLICES]
        return sin * c + cos * s >> bits, cos * c - sin * s >> bits


# ---- the largest eigenvalue of beta over the torus and the parameters
# Here and below a wave is (k0, k1, phase), in units, and its amplitude is apart.

def in_units(fixed, waves):
    """The waves, with pi phase (modulo 2 pi) off by less than 2 units."""
    return [(*wave.k, fixed.angle(wave.phase)) for wave in waves]


def angle_of(wave, x):
    k0, k1, phase = wave
    return k0 * x[0] + k1 * x[1] + phase


def stiffness(waves):
    """The sum of |k|^2 (|k0| + |k1|): where each amplitude is off by one, and each slope of a wave
    by |k0| + |k1|, an eigenvalue is off by no more."""
    return sum([(k0 * k0 + k1 * k1) * (abs(k0) + abs(k1)) for k0, k1, _ in waves])


def largest(p, q, r, one):
    """An upper bound of the largest eigenvalue of [p q; q r]: less than 2 units above it."""
    return (p + r + upper_sqrt((p - r) ** 2 + 4 * q * q) + 1) // 2


def forms(waves, weights):
    """The sum of weight k k' over the waves: the entries 00, 01, 11."""
    p = q = r = 0
    for (k0, k1, _), m in zip(waves, weights):
        p, q, r = p + k0 * k0 * m, q + k0 * k1 * m, r + k1 * k1 * m
    return p, q, r


def cell_bound(fixed, waves, amplitudes, sides, y, w):
    """An upper bound of the largest eigenvalue of beta over y + sum of d side, |d| <= w, and one at
    y.

    beta = 2I + sum of m k k', where m = -p sin(k.x + phase).
    Taylor: m <= m(y) - p cos(k.y + phase) k.D + |p| (k.D)^2 / 2.  The part affine in d has a convex
    largest eigenvalue, so its maximum lies at a corner of the cell; as |k.D| <= w sum of |k.side|
    the rest adds at most the largest eigenvalue of the sum of |p| (w sum of |k.side|)^2 k k' / 2.
    """
    bits, one = fixed.bits, fixed.one
    along = [[k0 * u + k1 * v for u, v in sides] for k0, k1, _ in waves]
    angles = [fixed.sincos(angle_of(wave, y)) for wave in waves]
    m = [-p * s >> bits for p, (s, _) in zip(amplitudes, angles)]
    g = [-p * c * w >> 2 * bits for p, (_, c) in zip(amplitudes, angles)]

    def eigenvalue(d):
        at = [value + slope * sum([k * e for k, e in zip(ks, d)])
              for value, slope, ks in zip(m, g, along)]
        p, q, r = forms(waves, at)
        return largest(2 * one + p, q, 2 * one + r, one)

    square = (w * w >> bits) + 1
    bend = largest(*forms(waves, [(abs(p) * square * sum(map(abs, ks)) ** 2 >> bits + 1) + 1
                                  for p, ks in zip(amplitudes, along)]), one)
    # Sines and floors: m is off by 1 + SINE_ERROR size units at most, and g d by 1 + SINE_ERROR
    # size w for each unit of k.side; 1 to spare.  (A side is a unit vector, or for waves that are
    # multiples of k0 is such that k.side is the multiple: |k.side| <= |k0| + |k1|.)
    size = max(map(abs, amplitudes), default=0)
    slack = 4 + stiffness(waves) * (4 + ((2 * SINE_ERROR * size * (one + w)) >> 2 * bits) + 1)
    corners = max(map(eigenvalue, itertools.product((-1, 1), repeat=len(sides))))
    return corners + bend + slack, eigenvalue((0,) * len(sides)) + slack


def torus_bound(fixed, waves, corners, most=None):
    """An upper bound B of the largest eigenvalue of beta over the torus and the parameters between
    these corners, each a tuple of amplitudes.

    beta(x) is affine in the parameters and its largest eigenvalue convex: for each x the maximum
    is at one of the corners.  At each, branch and bound over cells that cover the torus,
    until the worst cell is within 2^-20 (relative to the parameters) of a value taken, or there
    have been so many cells (most) that the bound may be a little less sharp.

    If all k are multiples of one, q, then beta depends on q.y alone, and its values are those on a
    line: for side.q = 1 those at y = d side, |d| <= pi.
    """
    corners = sorted(set(corners))
    q = min([(k0, k1) for k0, k1, _ in waves] or [(1, 0)], key=lambda k: abs(k[0]) + abs(k[1]))
    if all(k0 * q[1] == k1 * q[0] for k0, k1, _ in waves):
        divisor = math.gcd(*q)
        sides = [bezout(q[0] // divisor, q[1] // divisor)]
    else:
        sides = [(1, 0), (0, 1)]
    tolerance = (fixed.one + max([sum(map(abs, p)) for p in corners])) >> 20
    heap, taken, order = [], 0, itertools.count()

    def push(p, y, w):
        nonlocal taken
        bound, value = cell_bound(fixed, waves, p, sides, y, w)
        taken = max(taken, value)
        heapq.heappush(heap, (-bound, next(order), p, y, w))

    for p in corners:
        push(p, (0, 0), fixed.pi + 2)
    while -heap[0][0] > taken + tolerance and next(order) < (most or MAX_CELLS):
        _, _, p, y, w = heapq.heappop(heap)
        w = w + 1 >> 1
        for d in itertools.product((-w, w), repeat=len(sides)):
            push(p, tuple([c + sum([e * side[i] for e, side in zip(d, sides)])
                           for i, c in enumerate(y)]), w)
    return -heap[0][0]


def bezout(a, b):
    """Integers (u, v), |u|, |v| <= 1 or below |a|, |b|, with a u + b v = 1, for coprime a, b."""
    u, v, old, new = 1, 0, a, b
    x, y = 0, 1
    while new:
        n = old // new
        old, new, u, x, v, y = new, old - n * new, x, u - n * x, y, v - n * y
    return (u * old, v * old)               # old is 1 or -1


# ---- orbits: first-order Taylor models
# A piece is a set of amplitudes and of (v0, v1): of each wave the middle and the parts of its
# amplitude, and centres and half-widths of the angles.  A number that depends on the point of the
# piece is enclosed as centre + sum of column * symbol, each symbol in [-1, 1]: first the symbols of
# the three parameters and the two angles, two for the rounding of x*, then some for the errors of
# each step.

PARAMETERS, SYMBOLS = 3, 7              # of these; of these and all the others of a piece


class Point:
    """x[j] on all orbits of a piece: its centre x, its rows of columns, and models of p sin."""

    __slots__ = ("x", "rows", "angles", "reach", "sines", "beta")

    def __init__(self, fixed, waves, amplitudes, x, rows):
        self.x, self.rows = x, rows
        row0, row1 = rows
        self.angles = [fixed.sincos(angle_of(wave, x)) for wave in waves]
        self.reach = [sum([abs(k0 * p + k1 * q) for p, q in zip(row0, row1)])
                      for k0, k1, _ in waves]
        self.sines = [model(fixed.bits, *amplitude, s, c, rho) for amplitude, (s, c), rho
                      in zip(amplitudes, self.angles, self.reach)]
        p, q, r = forms(waves, [value / fixed.one for value, _, _, _ in self.sines])
        self.beta = 2 - p, -q, 2 - r        # at the centre, in double precision


def model(bits, p, parts, f, g, rho):
    """Encloses (p + sum of part e) (f' cos d + g' sin d) for |e| <= 1, |d| <= rho <= 2 and all f',
    g' within SINE_ERROR of f, g, as value + sum of slope e + tilt d + error: these four, the slopes
    as a list.

    cos d is in [1 - rho^2/2, 1], and |sin d - d| <= rho^3/6, so f cos d + g sin d is within
    bend = |f| rho^2/4 + |g| rho^3/6 + 2 SINE_ERROR of f (1 - rho^2/4) + g d.  With h, the sum of
    the |parts|, the error is (|p| + h) bend + h |g| rho; value, each slope, tilt d and the error
    lose 1 or 2 units each, and the amplitude is off by PARAMETER_ERROR, which the wave, at most 1,
    does not enlarge.
    """
    square, h = (rho * rho >> bits) + 1, sum(map(abs, parts))
    sag = f * square >> bits + 2
    bend = abs(sag) + (abs(g) * square * rho // 6 >> 2 * bits) + 2 * SINE_ERROR + 4
    error = ((abs(p) + h) * bend + ((h * abs(g) >> bits) + 1) * rho >> bits) \
        + PARAMETER_ERROR + 9
    return p * (f - sag) >> bits, [part * (f - sag) >> bits for part in parts], p * g >> bits, error


def step(fixed, waves, amplitudes, point, before, known):
    """The point after next: 2 x - before - V'(x).  Time may run either way: the map is reversible.

    -V'(x) is the sum of k g with g = p cos(angle).  Each g has a symbol for its error, all those
    that move x0 alone the same, and those that move x1 alone; these are new, after the known ones.
    The floor of each column costs a unit.
    """
    bits = fixed.bits
    models = [model(bits, *amplitude, c, -s, rho) for amplitude, (s, c), rho
              in zip(amplitudes, point.angles, point.reach)]
    p, q, r = forms(waves, [tilt for _, _, tilt, _ in models])
    p, r = (2 << bits) + p, (2 << bits) + r
    row0, row1, old0, old1 = [row + [0] * (known - len(row)) for row in point.rows + before.rows]
    new0 = [(p * u + q * v >> bits) - o for u, v, o in zip(row0, row1, old0)]
    new1 = [(q * u + r * v >> bits) - o for u, v, o in zip(row0, row1, old1)]
    x0, x1 = 2 * point.x[0] - before.x[0], 2 * point.x[1] - before.x[1]
    only0, only1, both0, both1 = known, known, [], []
    for (k0, k1, _), (value, slopes, _, error) in zip(waves, models):
        x0, x1 = x0 + k0 * value, x1 + k1 * value
        for m, slope in enumerate(slopes):
            new0[m] += k0 * slope
            new1[m] += k1 * slope
        if k1 == 0:
            only0 += abs(k0) * error
        elif k0 == 0:
            only1 += abs(k1) * error
        else:
            both0.append(k0 * error)
            both1.append(k1 * error)
    return Point(fixed, waves, amplitudes, (x0, x1),
                 (new0 + [only0, 0, *both0], new1 + [0, only1, *both1]))


# ---- the criterion

def least(d):
    """The least eigenvalue of [p q; q r] and its eigenvector, in double precision."""
    p, q, r = d
    value = (p + r - math.hypot(p - r, 2 * q)) / 2
    u, v = (q, value - p) if p > r else (value - r, q)
    length = math.hypot(u, v)
    return value, ((u / length, v / length) if length else (1.0, 0.0))


def pivots(betas, l):
    """The recursion d = beta - l, then beta - 1/d, in double precision, up to the first d that is
    not above l, or to the end."""
    d, found = (1 / l, 0.0, 1 / l), []
    for b0, b1, b2 in betas:
        p, q, r = d
        det = p * r - q * q
        d = p, q, r = b0 - r / det, b1 + q / det, b2 - p / det
        found.append(d)
        if not (p > l and (p - l) * (r - l) > q * q):
            break
    return found


def witness(betas, l):
    """Vectors n of negative second variation at the centres of an orbit with these betas, or None.

    The recursion from the left falls below l at some site, that from the right at another, and
    all blocks between them are above it; if they cross, the part up to the left one is enough.
    Between them, where beta is least, n is the least eigenvector of what the others leave there;
    outwards n[j-1] = 1/d[j-1] n[j].  The last sites may go without.  Double precision: nothing
    rests on it.
    """
    left, end = pivots(betas, l), len(betas)
    fall = len(left) - 1
    p, q, r = left[-1]
    if p > l and (p - l) * (r - l) > q * q:
        return None
    right = pivots(betas[::-1], l)
    if end - len(right) > fall:
        end = len(left)
        right = pivots(betas[end - 1::-1], l)
    first = min(end - len(right), fall)
    site = min(range(first, fall + 1), key=lambda j: least(betas[j])[0])
    form = [d + e - b for d, e, b in zip(left[site], right[end - 1 - site], betas[site])]

    def outwards(side):
        m = n
        for p, q, r in side:
            det = p * r - q * q
            m = (r * m[0] - q * m[1]) / det, (p * m[1] - q * m[0]) / det
            yield m

    n = least(form)[1]
    return [*[*outwards(left[:site][::-1])][::-1], n, *outwards(right[:end - 1 - site][::-1])]


def second_variation(fixed, waves, l, orbit, vectors):
    """Bounds the left side of (3) over a piece: (upper bound, columns of the symbols).

    All products are exact; the unit of the result is 2^-(2 bits + 2 NU_BITS).
    """
    bits = fixed.bits
    if len(vectors) > len(orbit):
        raise ValueError("a vector without its site")
    nu = [(round(u * 2 ** NU_BITS), round(v * 2 ** NU_BITS)) for u, v in vectors]
    centre = -l * sum(n * n for n in (*nu[0], *nu[-1]))
    centre -= 2 * sum(m[0] * n[0] + m[1] * n[1] for m, n in zip(nu, nu[1:])) << bits
    error, columns = 0, [0] * max(len(point.rows[0]) for point in orbit)
    for point, (n0, n1) in zip(orbit, nu):
        centre += 2 * (n0 * n0 + n1 * n1) << bits
        along0 = along1 = 0
        for (k0, k1, _), (value, slopes, tilt, loss) in zip(waves, point.sines):
            omega = (k0 * n0 + k1 * n1) ** 2
            centre -= omega * value
            error += omega * loss
            along0, along1 = along0 + omega * k0 * tilt, along1 + omega * k1 * tilt
            for m, slope in enumerate(slopes):
                columns[m] -= omega * slope << bits
        row0, row1 = point.rows
        columns[:len(row0)] = [k - along0 * p - along1 * q
                               for k, p, q in zip(columns, row0, row1)]
    return (centre + error << bits) + sum(map(abs, columns)), columns


def is_at_once(fixed, waves, t=None):
    """Is B > 10/3 for all parameters of the waves, or at t; B of beta over the torus?

    V is odd about a point, so the least eigenvalue of beta over the torus is 4 - B; where it is
    attained, (3) with that point and its eigenvector alone is 4 - B - 2l < 0, that is B > 10/3; and
    B - 2 grows in proportion with the amplitudes.  So it is enough that n.beta(x)n < 2/3 |n|^2 for
    some x and n: found on a grid in double precision, and then bounded for all parameters.
    """
    one, known = fixed.one, in_units(fixed, waves)
    amplitudes = [[math.floor(x * one) for x in (
        (wave.middle, *wave.parts) if t is None else (wave.at(t),))] for wave in waves]
    angles = [(*wave.k, math.pi * float(wave.phase % 2)) for wave in waves]
    middle = [p / one for p, *_ in amplitudes]

    def beta(x):
        p, q, r = forms(angles, [m * math.sin(k0 * x[0] + k1 * x[1] + phase)
                                 for m, (k0, k1, phase) in zip(middle, angles)])
        return 2 - p, -q, 2 - r

    def level(x):
        return least(beta(x))[0]

    count = min(16 * max([abs(k) for wave in waves for k in wave.k] + [1]), 128)
    grid = [2 * math.pi * k / count for k in range(count)]
    places = heapq.nsmallest(4, itertools.product(grid, repeat=2), key=level)
    for width in (2 * math.pi / count * 2.0 ** -k for k in range(1, 18)):
        places = [min(itertools.product(*((y - width, y, y + width) for y in x)), key=level)
                  for x in places]
    x = min(places, key=level)
    n0, n1 = [round(u * 2 ** NU_BITS) for u in least(beta(x))[1]]
    x = [math.floor(Fraction(y) * one) for y in x]
    total = 4 * (n0 * n0 + n1 * n1) << 2 * fixed.bits       # three times 2 |n|^2 - 2/3 |n|^2
    moved = [0] * max(map(len, amplitudes), default=0)      # by each parameter
    for wave, (p, *parts) in zip(known, amplitudes):
        omega, (sine, _) = 3 * (wave[0] * n0 + wave[1] * n1) ** 2, fixed.sincos(angle_of(wave, x))
        total -= omega * p * sine
        # The sine is off by SINE_ERROR, the middle and each part by a unit: 32 are enough.
        total += omega * ((abs(p) + sum(map(abs, parts))) * SINE_ERROR + PARAMETER_ERROR * 2 * one)
        for m, part in enumerate(parts):
            moved[m] += omega * part * sine
    return total + sum(map(abs, moved)) < 0


class Criterion:
    """Everything that does not change from leaf to leaf."""

    def __init__(self, claim, bound=None):
        """bound: of B, exact, if it is known."""
        widths = [x for x in claim.half if x] + [abs(g) for wave in claim.felt
                                                 for g in wave.parts if g]
        narrow = max([h.denominator.bit_length() - h.numerator.bit_length() for h in widths] + [0])
        bits = max(96, 64 + narrow + claim.counts["most_cuts"])
        if bits > MAX_BITS:
            raise NotConfirmed("numbers of %d bits are needed; the checker's limit is %d"
                               % (bits, MAX_BITS))
        self.claim, self.fixed = claim, Fixed.of(bits)
        one, waves = self.fixed.one, claim.felt
        self.waves = in_units(self.fixed, waves)
        self.amplitudes = [(math.floor(wave.middle * one), [math.floor(g * one)
                                                            for g in wave.parts]) for wave in waves]
        if max([abs(x) for p, parts in self.amplitudes for x in (p, *parts)] + [0]) >> 2 * bits:
            raise NotConfirmed("the parameters are too large for this checker")     # l has no digit
        self.xstar = tuple([math.floor(x * one) for x in claim.xstar])
        # Orbits that differ by 2 pi in x[1] differ by 2 pi j in x[j]: nothing else changes.
        self.region = [(math.floor(c % 2 * self.fixed.pi), math.floor(h * self.fixed.pi),
                        4 * math.ceil(h) + 10) for c, h in zip(claim.centre, claim.half)]
        # The ends of the parameters: a cell's B is no larger than what lies between B there.  An
        # end is off by less than a unit for each wave, and the eigenvalue by less than stiffness.
        if bound is not None:
            self.B_at = [math.ceil(bound * one)]
        else:
            corners = [tuple([math.floor(wave.at(t) * one) for wave in waves])
                       for t in itertools.product((-1, 1), repeat=claim.parameters)]
            apart = [[x] for x in corners] if set("234") & set(claim.tree) else [corners]
            found = {}
            for ends in map(tuple, apart):
                if ends not in found:
                    found[ends] = torus_bound(self.fixed, self.waves, ends) + stiffness(self.waves)
            self.B_at = [found[tuple(ends)] for ends in apart]
        self.B = max(self.B_at)
        if self.B <= 2 * one:
            # The tails of step 2 must be square-summable, l < 1, which needs B > 2.  (The mean of
            # beta over the torus is 2I, so this would say that there are no parameters.)
            raise NotConfirmed("beta has no eigenvalue above 2: the criterion does not apply")
        self.l_of = {}                      # by the cell's slices of the parameters
        self.fast = None                    # a Lockstep, where there is one

    def least_pivot(self, cell):
        """l of step 2 for the parameters of the cell, from below.

        The largest eigenvalue is convex in the parameters, so between two ends it lies below the
        straight line, and over the cell below the largest value, at a corner of the cell, of the
        product of such lines.  l falls as B grows, so an upper bound of B, and of the divisor,
        make a lower bound of l; lesser l makes (3) larger.
        """
        key = tuple(x[2:] for x in cell)
        if key not in self.l_of:
            one, axes = self.fixed.one, len(self.B_at).bit_length() - 1
            B = 0
            for corner in itertools.product((0, 1), repeat=axes):
                values = self.B_at
                for i, k, upper in zip(*key, corner):       # the first axis is the slowest
                    half = len(values) // 2
                    values = [((1 << k) - i - upper) * low + (i + upper) * high
                              for low, high in zip(values[:half], values[half:])]
                B = max(B, -(-values[0] >> sum(key[1][:axes])))
            B = max(B, 2 * one + 1)
            l = 2 * one ** 2 // (B + upper_sqrt(B * B - (2 * one) ** 2))
            if l <= 0:
                # Harmless, since a lesser l only makes (3) harder; but the witness needs 1/l, and
                # no theorem is wanted from numbers that have lost all their digits.
                raise NotConfirmed("the parameters are too large for this checker")
            self.l_of[key] = l
        return self.l_of[key]

    def least_in_double(self, cell):
        """l from below as a double: the quotient is rounded to nearest, the rest lowers it."""
        return self.least_pivot(cell) / self.fixed.one * (1 - 2.0 ** -50)

    def piece(self, cell):
        """The cell as a piece that covers it: of each wave the middle and the parts of its
        amplitude, then centres and half-widths of v0 and v1.

        An angle: the centre c + h (2i + 1 - 2^k) / 2^k and the half-width h / 2^k, in units of pi:
        pi is off by 2 units and c mod 2 below 2, so with the floors 4 h + 10 units are enough.
        An amplitude is followed along its symbols to within 10 units (a floor of the middle, and
        for each part one of itself and one of each of its shifts), and each halving of the piece
        may add one: PARAMETER_ERROR.
        """
        index, cuts = cell
        amplitudes = []
        for p, parts in self.amplitudes:
            for g, i, k in zip(parts, index[2:], cuts[2:]):
                p += g * (2 * i + 1 - (1 << k)) >> k
            amplitudes.append((p, [g >> k for g, k in zip(parts, cuts[2:])]))
        sides = [(c + (h * (2 * i + 1 - (1 << k)) >> k), (h >> k) + e)
                 for (c, h, e), i, k in zip(self.region, index, cuts)]
        return amplitudes, sides

    def ends(self, piece):
        """x[0] and x[1] of a piece, as Points."""
        amplitudes, ((c0, h0), (c1, h1)) = piece
        f0, f1, f2, f3 = self.claim.frame
        none = [0] * PARAMETERS
        return (Point(self.fixed, self.waves, amplitudes, self.xstar,
                      (none + [0, 0, 1, 0], none + [0, 0, 0, 1])),
                Point(self.fixed, self.waves, amplitudes, (f0 * c0 + f1 * c1, f2 * c0 + f3 * c1),
                      (none + [f0 * h0, f1 * h1, 0, 0], none + [f2 * h0, f3 * h1, 0, 0])))

    def attempt(self, l, piece):
        """Is (3) true of the whole piece?  None if so, or else why not, and where to halve it."""
        try:
            return self._follow(l, piece)
        except (OverflowError, ValueError, ZeroDivisionError):
            # An angle or a double too large, a singular pivot, a NaN: no bound was established,
            # and an attempt that establishes none excludes nothing.
            return "the arithmetic failed", [0] * PARAMETERS + [h for _, h in piece[1]]

    def _follow(self, l, piece):
        """Lengthens the orbit at the end that is better known until (3) is true or all is lost.

        (3) is tried each time the orbit has grown by a twelfth, and in the end.
        """
        fixed, waves, amplitudes = self.fixed, self.waves, piece[0]
        first, second = self.ends(piece)
        why, columns = None, [0] * PARAMETERS + [h for _, h in piece[1]]
        orbit = collections.deque()
        point, ahead, due, known = first, True, 1, SYMBOLS

        def reach(point):
            return max(point.reach, default=0)

        while point:
            (orbit.append if ahead else orbit.appendleft)(point)
            if len(orbit) == 1:
                point = second
            else:
                ahead = reach(orbit[-1]) < reach(orbit[0])
                ends = (orbit[-1], orbit[-2]) if ahead else (orbit[0], orbit[1])
                point = step(fixed, waves, amplitudes, *ends, known)
                known = len(point.rows[0])
            if reach(point) > fixed.one or len(orbit) == MAX_POINTS:
                point = None
            if point and len(orbit) < due:
                continue
            due = len(orbit) + 1 + len(orbit) // 12
            vectors = witness([point.beta for point in orbit], l / fixed.one)
            if vectors:
                bound, columns = second_variation(fixed, waves, l, orbit, vectors)
                if bound < 0:
                    return None
                why = "its second variation may be positive"
        # What moves the ends matters, if little: when it is halved, the orbit may go on.
        columns = [abs(x) + sum([abs(k0 * p.rows[0][m] + k1 * p.rows[1][m])
                                 for p in (orbit[0], orbit[-1], second) for k0, k1, _ in waves])
                   for m, x in enumerate(columns[:PARAMETERS + 2])]
        return why or "the orbit of its centre contradicts nothing over %d points, %s" % (
            len(orbit), "the most that are followed" if len(orbit) == MAX_POINTS else
            "beyond which it is too uncertain"), columns

    @staticmethod
    def halves(piece, worst):
        """The halves of a piece along a symbol: of a parameter, which moves the amplitudes of many
        waves, or of an angle."""
        amplitudes, sides = piece

        def half(centre, halves, at, sign):
            step = [h + 1 >> 1 if k == at else 0 for k, h in enumerate(halves)]
            return centre + sign * sum(step), [s if k == at else h for k, (h, s)
                                               in enumerate(zip(halves, step))]

        found = []
        for sign in (1, -1):
            angles = [half(c, [h], worst - PARAMETERS - i, sign) for i, (c, h) in enumerate(sides)]
            found.append(([half(p, parts, worst, sign) for p, parts in amplitudes],
                          [(c, h) for c, (h,) in angles]))
        return found

    def excluded(self, cell):
        """Does no minimizing orbit go from x* to the cell?  (None or else why not, pieces tried)"""
        l, todo, pieces = self.least_pivot(cell), [(self.piece(cell), (0,) * 5)], 0
        while todo:
            piece, halved = todo.pop()
            pieces += 1
            failed = self.attempt(l, piece)
            if not failed:
                continue
            if sum(halved) >= MAX_HALVINGS or pieces + len(todo) >= MAX_PIECES:
                return "%s (piece %d, halved %d times)" % (failed[0], pieces, sum(halved)), pieces
            # Along what matters most, but no symbol that matters is left behind for long.
            blame = failed[1]
            worst = max(range(len(blame)), key=blame.__getitem__)
            last = min((k for k, x in enumerate(blame) if x or k == worst), key=halved.__getitem__)
            if halved[worst] - halved[last] > LAG:
                worst = last
            now = changed(halved, worst, halved[worst] + 1)
            todo += [(half, now) for half in self.halves(piece, worst)]
        return None, pieces

    def at_once(self):
        """Is B > 10/3 for all parameters, or where that is claimed, at the upper end?"""
        return is_at_once(self.fixed, self.claim.felt,
                          (1,) if self.claim.at_once == "upper end" else None)

    def not_at_once(self):
        """Is B <= 10/3 for some of these parameters?  Those nearest to 0 are tried, about."""
        waves, t = self.claim.felt, [Fraction(0)] * self.claim.parameters
        for m in list(range(len(t))) * 4:
            square = sum([wave.parts[m] ** 2 for wave in waves])
            slope = sum([wave.parts[m] * wave.at(t) for wave in waves])
            if square:
                t[m] = min(max(t[m] - slope / square, Fraction(-1)), Fraction(1))
                t[m] = Fraction(math.floor(t[m] * 2 ** 60), 2 ** 60)
        if self.claim.at_once == "upper end":
            t = (1,)
        nearest = tuple([math.floor(wave.at(t) * self.fixed.one) for wave in waves])
        return 3 * (torus_bound(self.fixed, self.waves, [nearest])
                    + stiffness(self.waves)) <= 10 * self.fixed.one


# ---- the fast path: a thousand prisms in lockstep, in doubles
# The same left side of (3), bounded by other means, far more cheaply and more sharply: a polynomial
# of third order in the symbols, and what it leaves.  What is not bounded below zero here is left to
# the exact path.  All that is done to one prism is done to all of them, as arrays of numpy, whose
# operations are rounded to nearest (sound() looks).
#
# A prism is the set of orbits with x[0] = x*, x[1] in a parallelogram, and, for each wave, p' = P +
# h.e + v, |v| <= W; e in [-1, 1]^m are the symbols of the parameters, and H is the sum of the |h|.
# There are n waves; the first two are k = (1,0) and (0,1) with the phase 0, the coordinates
# themselves, and are of amplitude 0 where V has them not.  A lane is one half of a prism's orbits,
# ahead x[1], x[2], ..., or back x[0], x[-1], ...; the map is reversible, so both are followed by
# the same steps, from o = x[0], q = x[1] or from o = x[1], q = x[0].  A site of a lane has X, in
# turns (so whole turns are taken off without any error, and as k is of integers those of k.X, too),
# and a true orbit is there, modulo 2 pi and in radians,
#       2 pi X + D,    D = L e + r,    |r| <= rest,
# for the symbols e in the cube, now those of the parameters and of the sides of the parallelogram.
# Of a wave at a site: y = 2 pi (k.X + phase/2), z = k.D, xi = k.L e and z = xi + w; |xi| <= size,
# |w| <= rest, |z| <= reach = size + rest.  s, c and p sin, p cos below are those at X and P.
#
# Orbits.  Let o, q, + be successive sites, M and d any matrices, and f[q] = r[+] - d[q] r[q].  As
# r[+] = beta r[q] - r[o] + err, and r[q] = d[o] r[o] + f[o],
#       f[q] = M f[o] + err + (beta - M - d[q]) r[q] - (I - M d[o]) r[o].
# With M near 1/d[o] and d[q] = beta - M the brackets are roundings, so that r grows like the orbits
# and not like products of norms, in a frame in which beta is nearly diagonal: where waves that feel
# both coordinates count, near x0 = x1 above all, this is the frame of x0 + x1 and x0 - x1, in which
# beta is
#       ((b00 + b11)/2 + b01, (b00 - b11)/2; the same, (b00 + b11)/2 - b01),
# symmetric, too.  A wave acts on x0 + x1 and x0 - x1 as k0 + k1 and k0 - k1, and k.r is half of
# these times what r is there.
# xi^2 lies between 0 and size^2, so the bow of the orbits, -p cos y xi^2/2, is half of its extent
# about its mean: X[+] is 2X - X[o] + the sum of k P cos y (1 - size^2/4).  err is then (i) how far
# X[+] is from this; (ii) how far L[+] is from beta L[q] - L[o] and h cos y in the parameters'
# columns; and (iii) for each wave, |k| times bending(),
#       |P| (|cos y| (size^2/4 + rest (reach + size)/2) + |sin y| reach^3/6)
#       + H (|cos y| reach^2/2 + |sin y| reach) + W:
# cos z - 1 + size^2/4 is at most size^2/4 and at least size^2/4 - reach^2/2, where reach^2 is
# size^2 + rest (reach + size); |sin z - z| is at most |z|^3/6; and cos(y + z) - cos y is
# cos y (cos z - 1) - sin y sin z.
#
# The bound.  For any multipliers mu[j] the left side of (3) is the same with
#       sum of mu[j].(2x[j] - x[j-1] - x[j+1] - V'(x[j])),    which is zero on orbits,
# added to it.  It is zero at each orbit: so mu may depend on the orbit, and here it is affine in
# its symbols, mu = mu_0 + sum of mu_k e_k; zero at a lane's last site.  At X and P the bracket is
# E = sum of k P cos y size^2/4, but for (i).  n is the same for all orbits of the prism.  With
# omega = (n.k)^2 and m = k.mu, affine, too, a wave has in this sum  p'(A cos z + B sin z),
#       A = A0 + alpha = m cos y - omega sin y,    B = B0 + beta' = -omega cos y - m sin y,
# alpha and beta' being what is linear in e.  D is multiplied, in all, with
#       G = 2 mu[j] - mu[j-1] - mu[j+1] + sum of k (P B0 + P beta' - P A0 xi + h.e B0),
# affine in e; what a wave has besides this, which is z times its part of the last sum, is
#       P (A0 + alpha) + h.e (A0 + alpha)                                                     (4)
#       + P A0 xi^2/2 - P alpha xi^2/2 - P B0 xi^3/6 + h.e (beta' xi - A0 xi^2/2)
# and a remainder.  For A0 (cos z + xi z) is A0 (1 + xi^2/2 - w^2/2 + (cos z - 1 + z^2/2)), with the
# last bracket between 0 and z^4/24; alpha cos z is alpha (1 - xi^2/2 - w (z + xi)/2) and at most
# |alpha| z^4/24; B0 (sin z - z) is -B0 xi^3/6, as far as z^3 - xi^3 = w (z^2 + z xi + xi^2), and at
# most |B0| |z|^5/120; beta' (sin z - z) is at most |beta'| |z|^3/6; and with h.e stands A cos z +
# B sin z - B0 z, where alike A0 (cos z - 1 + xi^2/2), alpha (cos z - 1), B0 (sin z - z) and beta'
# (sin z - xi) are left.  So the remainder, remainder(), is at most
#       |P| (|alpha| (far + reach^4/24) + |beta'| reach^3/6
#            + |B0| (rest (reach^2 + reach size + size^2)/6 + reach^5/120))
#       + max(0, P A0) reach^4/24 + max(0, -P A0) rest^2/2
#       + H (|A0| (far + reach^4/24) + |alpha| reach^2/2 + |B0| reach^3/6
#            + |beta'| (rest + reach^3/6)) + W (|m| + omega),      far = rest (reach + size)/2.
# That is why mu is affine: all this is of fourth order, though r, of second order, is only bounded.
# From a lane's last site inwards the next mu is the one that makes G vanish, but for its rounding;
# at x[1] and x[0], where both lanes meet, G D is G times the sides of the parallelogram, a
# polynomial, and the rest of x[1] or x*.  So the sum is a polynomial of third order in the symbols,
# its coefficients added up with their signs over all sites, and small things; summit() bounds it
# over the cube.
#
# Roundings.  u = 2^-53.  Which numbers X, P, h, L, d, M, n, mu, E and size are does not matter, but
# what bounds something must.  K = |k0| + |k1| of a wave; grain = (64 + 16 n) u; S_ij is the sum of
# |ki kj| K |P| over the waves, and S_i that of |ki| K |P|, at most S_ii.  Sums over the waves are
# of at most n + 1 terms, each rounded as often.
#   angle: k.X is off by K/2 u in its products (none for 0, 1, -1), by K/2 u in its sum, and with
#       phase/2 by 1.5 u: in turns.  So by 2 pi (K + 1.5) u at most, and, with 4 u of
#       lockstep_sincos,
#   sine, cosine: SINE = 24 K u.  In (iii) 2 SINE with |cos y|, as E has the computed one.
#   beta: products ki kj P s are off by (24 K + 3) u |ki kj P|, sums by (n + 1) u of 2 and of all
#       products: (28 + n) u S_ij, and 2 (n + 1) u on the diagonal; less than F_ij / 2, where F_ij
#       is grain S_ij, and F_ii, F_i for short, grain (1 + S_ii).  In the other frame by (F_0 +
#       F_1)/4 + F_01/2 and 6 u (2 + S_00 + S_11): less than F_0 + F_1, as 2 S_01 <= S_00 + S_11.
#   (i): in turns (n + 2) u for the sums, of |2X - X| <= 1.5 and |ki P| / 2 pi for each wave, and
#       (24 K + 6) u |ki P| / 2 pi for each; in radians u (9.5 (n + 2) + (32 + n) S_i), and
#       (32 + n) u S_i / 4 for E: less than F_i.  What is left of F_i, 40 u, is for whatever is lost
#       below 2^-1022.
#   (ii): F_i / 2 + (4 + n) u (2 + S_ii) < F_i of |L_i|, F_01 of the other, (4 + n) u of |L[o]|,
#       and (28 + n) u K |ki| H, less than grain, for each wave.
#   beta - M - d: F + 2 u |M|.   I - M d: with inv = 1 / det, each rounded, at most 5 u |inv| (|d00
#       d11| + d01^2) on the diagonal, as the determinant is off by 2.1 u of these products, the
#       quotient by u, M d by u of each product; and 2 u |inv d01| (|d00| + |d11|) beside it.
#   sums of positive terms: MORE = 1 + 2^-40 for thousands of roundings one after the other, and 64
#       u more for each site.
#   that k.L is a rounded sum of rounded products, but for the first two waves, goes into rest: 3 u
#       of |k0| |L_0| + |k1| |L_1|.
#   weight = K (|k0| |mu_0| + |k1| |mu_1| + |k|^2 |n|^2) of a wave, |mu_i| with all coefficients, is
#       more than |m| + omega, and than the terms of these sums: so omega is off by 8 u weight, m by
#       2 u, A and B by 24 u more: 36 u weight.
#   G: 36 u, 4 u and n + 1 u of |ki| weight (|P| (1 + size) + H) for each wave, 3 u of 2 |mu| and
#       the |mu| before; at x[1] and x[0] u more, u of the mu of the other lane, and of products and
#       sums: grain, in all.
#   (i) again: |mu| F.
#   mass is the sum of 2|n|^2, and 2|n.n'| over neighbours is no more; and of weight (|P| (1 +
#       reach^2) + 3 H).  A term of a coefficient is off by 48 u of its size, and these sizes are in
#       all at most mass, as reach <= 1 (or P = H = 0): 2|n|^2 + |P| omega; with weight |P| size^2/4
#       (mu.E), size^2/2, size^3/6; with weight H 1, size^2/2, size.  In the remainder A and B have
#       factors of less than 2.3 |P| reach^2 + 3 H in all: 83 u.  Sums over N sites of each lane
#       have at most (n + 2) N terms one after the other; to join them by monomials, 16 u.
#   in summit, of each coefficient: 64 u.
# Masses are at least 1, as one n is a unit vector but for rounding, and below HUGE: so 64 u mass is
# more than all underflows.  A NaN is not below zero, and proves nothing.

np = None                               # numpy, once the fast path is wanted
UNIT = 2.0 ** -53
TWO_PI = 2 * math.pi                    # off by 0.35 u of itself
SINES = [(-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1)]
COSINES = [(-1) ** k / math.factorial(2 * k) for k in range(8, 1, -1)]
SINE, MORE, HUGE = 24 * UNIT, 1 + 2.0 ** -40, 2.0 ** 900
XSTAR_REST = 2.0 ** -51                 # of x*, in radians; see Lockstep
TINY = 2.0 ** -200
FAST_SIZE = 2.0 ** 10                   # of amplitudes, x*, regions and frames
FAST_CUTS = 52                          # of an axis
BATCH, SMALLEST_BATCH = 1024, 16
FAST_SITES, ROOM = 4096, 1 << 19        # of a lane; of all lanes at a time
FIRST_TRY = 96                          # sites, for lanes that are longer
FARTHEST = 1.0                          # reach of a wave that is there
CAUTION = (0, 0.2), (0.3, 0), (0, 1.0)  # of the choice of n: see witnesses, settle


def sound():
    """Imports numpy.  Does it round to nearest, below 2^-1022, too, and are its halves even?"""
    global np
    import numpy as np
    draw = random.Random(1)
    x, y = (np.array([draw.uniform(-1, 1) * 2.0 ** draw.randint(-500, 500) for _ in range(200)]
                     + [2.0 ** -1022, 1 + 2.0 ** -30, 2.0 ** -530 / 3, 0.7, -1.1])
            for _ in range(2))
    one = np.ones_like(x)
    with np.errstate(all="ignore"):
        for found, exact in ((x + y, Fraction.__add__), (x - y, Fraction.__sub__),
                             (x * y, Fraction.__mul__), (x / y, Fraction.__truediv__),
                             (x - one, lambda a, b: a - 1)):
            if found.tolist() != [float(exact(Fraction(a), Fraction(b)))
                                  for a, b in zip(x.tolist(), y.tolist())]:
                return False
        return (np.array([2.0 ** -1022] * 9) / 2 * 2).tolist() == [2.0 ** -1022] * 9 \
            and np.rint(np.array([0.5, 1.5, -2.5, 0.49, 7.0])).tolist() == [0, 2, -2, 0, 7]


def lockstep_sincos(turns):
    """Sines and cosines of 2 pi turns, |turns| <= 1/2: each within 4 u.

    turns - n/4 is exact (Sterbenz) and at most 1/8; the angle is off by 1.4 u of itself.  Taylor's
    polynomials are off by less than u/50.  sine: 0.8 u for the angle, 0.6 u for what is added to
    it, at most 0.081, 0.8 u for the sum; cosine: 0.8 u, 0.4 u for the square's half, 0.1 u for the
    rest, 0.4 u and u for the sums.
    """
    n = np.rint(4 * turns)
    angle = (turns - 0.25 * n) * TWO_PI
    square = angle * angle
    sine, cosine = SINES[0] * square, COSINES[0] * square
    for a in SINES[1:]:
        sine += a
        sine *= square
    for a in COSINES[1:-1]:
        cosine += a
        cosine *= square
    sine *= angle
    sine += angle
    cosine = 1 - (0.5 * square - square * square * (cosine + COSINES[-1]))
    quadrant = n.astype(np.int64)
    odd = (quadrant & 1) == 1
    return (np.where(odd, cosine, sine) * (1 - (quadrant & 2)),
            np.where(odd, sine, cosine) * (1 - (quadrant + 1 & 2)))


def combined(table, waves):
    """For each row of the table, pairs (w, factor), the sum of factor waves[w]."""
    found = np.empty((len(table), *waves.shape[1:]))
    for row, into in zip(table, found):
        if not row:
            into[...] = 0
            continue
        (w, factor), *more = row
        np.multiply(waves[w], factor, out=into)
        for w, factor in more:
            into += waves[w] if factor == 1 else factor * waves[w]
    return found


class Shape:
    """What the waves of the fast path are but for their amplitudes: their k and phases, the first
    two those of the coordinates; and which of them are present anywhere, and have which symbols."""

    def __init__(self, waves, moving=()):
        """waves: (k, phase) of those that are present; moving: pairs of the number of such a wave
        and of a symbol that moves its amplitude."""
        self.known = [((1, 0), 0), ((0, 1), 0)]
        self.known += [wave for wave in waves if wave not in self.known]
        at = self.at = [self.known.index(wave) for wave in waves]   # their numbers here
        self.present = sorted(at)
        self.moving = [[m for w, m in moving if at[w] == here] for here in range(len(self.known))]
        self.parameters = 1 + max([m for _, m in moving], default=-1)
        k = np.array([k for k, _ in self.known], float)
        self.K = abs(k).sum(axis=1)
        self.square = (k * k).sum(axis=1)
        self.grain = (64 + 16 * len(k)) * UNIT
        self.phases = [float(phase / 2 % 1) for _, phase in self.known]
        p, q = k.T
        self.forces = self.table(p, q)              # V' from waves
        self.strengths = self.table(abs(p), abs(q))
        self.stiff = self.table(                    # S_00, S_01, S_11
            *(abs(x) * self.K for x in (p * p, p * q, q * q)))
        self.strong = self.table(abs(p) * self.K, abs(q) * self.K)
        self.forms = self.table(p * p, p * q, q * q)
        self.turned = self.table(abs(p + q), abs(p - q))
        self.mixed = self.rows(k[2:])               # k.x of x
        self.sizes = self.rows(abs(k)), self.rows(abs(np.stack((p + q, p - q), axis=1)) / 2)

    def table(self, *rows):
        """The rows, of a number for each wave, as combined() takes them."""
        return [[(w, row[w]) for w in self.present if row[w]] for row in rows]

    @staticmethod
    def rows(columns):
        return [[(i, x) for i, x in enumerate(row) if x] for row in columns]

    def along(self, v):
        """k.v for all waves."""
        found = np.empty((len(self.known), *v.shape[1:]))
        found[:2] = v
        if self.mixed:
            found[2:] = combined(self.mixed, v)
        return found

    def turns(self, X):
        """The angles of the waves, in turns, at most 1/2."""
        found = self.along(X)
        for w, phase in enumerate(self.phases):
            if w > 1:
                found[w] -= np.rint(found[w])
                if phase:
                    found[w] += phase
                    found[w] -= np.rint(found[w])
        return found


def inverses(d):
    inv = 1 / (d[0] * d[2] - d[1] * d[1])
    return np.stack((d[2] * inv, -d[1] * inv, d[0] * inv))


def applied(d, v):
    return np.stack((d[0] * v[0] + d[1] * v[1], d[1] * v[0] + d[2] * v[1]))


def products(rows):
    """The products of rows i <= j, in order."""
    found, at = np.empty((len(rows) * (len(rows) + 1) // 2, rows.shape[1])), 0
    for i, row in enumerate(rows):
        np.multiply(row, rows[i:], out=found[at:at + len(rows) - i])
        at += len(rows) - i
    return found


def are_definite(d):
    return (d[0] > 0) & (d[0] * d[2] > d[1] * d[1])


def least_of(d):
    return (d[0] + d[2] - np.sqrt((d[0] - d[2]) ** 2 + 4 * d[1] * d[1])) / 2


def bending(P, H, W, s, c, size, rest, reach):
    """(iii) of a wave with |sin y| <= s and |cos y| <= c."""
    second = reach * reach / 2
    far = rest * (reach + size) / 2
    return np.abs(P) * (c * (size * size / 4 + far) + s * second * reach / 3) \
        + H * (c * second + s * reach) + W


def remainder(P, H, W, A0, alpha, B0, beta, weight, size, rest, reach):
    """What (4) leaves of a wave, if alpha and beta bound these linear parts, weight |m| + omega."""
    second = reach * reach / 2
    third, fourth = second * reach / 3, second * second / 6
    far = rest * (reach + size) / 2 + fourth
    a, b = np.abs(A0), np.abs(B0)
    return np.abs(P) * (a * np.where(P * A0 > 0, fourth, rest * rest / 2) + alpha * far
                        + b * (rest * (reach * (reach + size) + size * size) / 6
                               + second * third / 10)
                        + beta * third) \
        + H * (a * far + alpha * second + b * third + beta * (rest + third)) + W * weight


def summit(form):
    """At most so large is, over the cube, the polynomial with these coefficients: of e[i], of
    e[i] e[j] and of e[i] e[j] e[k] by (i,), (i, j) and (i, j, k), i <= j <= k; and no constant.

    x e^2 with x < 0 is at most x (2 t e - t^2) for any t, here for the one where, of it and what
    is linear in e, the largest value is.  x e^2 with x > 0 is x - x (1 - e^2), and e[i]^2 e[k],
    k = i or not, is e[k] - (1 - e[i]^2) e[k]: with 1 - e[i]^2, which lies between 0 and 1, stands
    at most the sum of these |coefficients|, less x.  The rest is linear in each symbol, and largest
    at a corner; at opposite corners what is odd has opposite signs.
    """
    symbols = [key[0] for key in form if len(key) == 1]
    linear, twist, constant = [form[i,] for i in symbols], [0] * len(symbols), 0
    for key, x in form.items():
        if len(key) == 3 and len(set(key)) < 3:
            i, k = key[1], key[0] if key[1] == key[2] else key[2]       # e[i]^2 e[k]
            linear[k] = linear[k] + x
            twist[i] = twist[i] + np.abs(x)
    for i in symbols:
        up, down = np.maximum(form[i, i], 0), np.maximum(-form[i, i], 0)
        t = np.clip(linear[i] / (2 * down + TINY), -1, 1)
        linear[i] = linear[i] - 2 * down * t
        constant = constant + up + down * t * t + np.maximum(twist[i] - up, 0)
    corners = [(1, *signs) for signs in itertools.product((1, -1), repeat=len(symbols) - 1)]

    def at_corners(keys, values):
        signs = np.array([[math.prod([corner[k] for k in key]) for key in keys]
                          for corner in corners], float)
        return (signs[:, :, None] * np.stack(values)).sum(axis=1)

    even, odd = [list(itertools.combinations(symbols, count)) for count in (2, 3)]
    odd = at_corners([(i,) for i in symbols] + odd, linear + [form[key] for key in odd])
    even = at_corners(even, [form[key] for key in even])
    return (np.abs(odd) + even).max(axis=0) + constant


class Prisms:
    """Prisms followed and bounded in lockstep; all arrays end with the axis of lanes, those ahead
    before those back."""

    def __init__(self, box, shape, xstar, l, caution=CAUTION[0]):
        """The box: P, h (by wave and symbol) and W of the waves, X[1] in turns, the sides of the
        parallelogram as columns and what x[1] may be off, in radians; the Shape; x* in turns; l;
        and how much the choice of n shies at sites that are not well known, by their reach and
        by its square."""
        P, h, W, x, sides, off = box
        self.size, self.shape = x.shape[1], shape
        self.P, self.h, self.W = self.both(P, P), self.both(h, h), self.both(W, W)
        self.H = np.abs(self.h).sum(axis=1) * MORE
        self.magnitude, self.l = np.abs(self.P), self.both(l, l)
        self.caution = [self.both(x + 0 * l, x + 0 * l) for x in caution]
        absent = (self.magnitude == 0) & (self.H == 0) & (self.W == 0)  # in these lanes
        self.absent = {w: absent[w] for w in shape.present if absent[w].any()}
        form = combined(shape.forms, self.magnitude.mean(axis=1)[:, None])[:, 0]
        stiff = combined(shape.stiff, self.magnitude)
        across = [abs(k0 * k1) * x for ((k0, k1), _), x in zip(shape.known,
                                                               self.magnitude.mean(axis=1))]
        self.turned = bool(6 * sum(across) > form[0] + form[2])     # of rests; either is right
        self.F = shape.grain * (1 + stiff[::2])
        self.F01 = shape.grain * stiff[1]
        self.angles = shape.parameters                          # their first symbol
        self.known = self.angles + 2
        start, none = xstar + 0 * x, np.zeros_like(x)
        columns = np.zeros((2, self.known, self.size))
        columns[:, self.angles:] = sides
        blank, rounding = np.zeros_like(columns), np.full_like(x, XSTAR_REST)
        self.sides, self.rounding = self.both(sides, 0 * sides), self.both(off, rounding)
        if self.turned:                                         # of x0 + x1 and of x0 - x1
            off, rounding = off[0] + off[1] + none, 2 * rounding
        self.before = self.both(start, x), self.both(blank, columns), self.both(rounding, off)
        self.first = self.both(x, start), self.both(columns, blank), self.both(off, rounding)
        self.sites = []

    @staticmethod
    def both(ahead, back):
        return np.concatenate((ahead, back), axis=-1)

    def other(self, lanes):
        return np.roll(lanes, self.size, axis=-1)

    def joined(self, lanes):
        return lanes[..., :self.size] + lanes[..., self.size:]

    def moved(self, columns):
        """How far each symbol moves a site, the waves that a lane has taken together."""
        total = 0
        for w in self.shape.present:
            x = np.abs(columns[w])
            total = total + (np.where(self.absent[w], 0, x) if w in self.absent else x)
        return total

    def follow(self):
        """Follows all lanes until each reaches too far, and yields True then and wherever an orbit
        may be long enough; False if there is no room for more.

        A lane that has come to its end stays as zeros, alive no more, and nothing is said of it.
        """
        P, h, H, W, F, F01, shape = self.P, self.h, self.H, self.W, self.F, self.F01, self.shape
        slope, n = P / TWO_PI, len(P)
        slack, from_H = SINE * shape.K[:, None], shape.grain * combined(shape.strong, H)
        along, beside = (F[0] + F[1],) * 2 if self.turned else (F, F01)     # of the frame's beta
        (X0, L0, r0), (X, L, r) = self.before, self.first
        size0 = np.abs(L0).sum(axis=1)
        alive, d, f, due = np.ones(X.shape[1], bool), None, None, FIRST_TRY
        while True:
            columns = shape.along(L)
            size = np.abs(columns).sum(axis=1) * MORE
            rest = combined(shape.sizes[self.turned], r)
            if shape.mixed:
                rest[2:] += 3 * UNIT * combined(shape.sizes[0][2:], size[:2])
            rest *= MORE
            reach = (size + rest) * MORE
            if not self.sites:                      # how far each symbol moves a lane's last site
                self.last = self.moved(columns)
            for w in shape.present:
                near = reach[w] <= FARTHEST
                alive = alive & (near | self.absent[w] if w in self.absent else near)
            if self.sites and (not alive.any() or len(self.sites) == FAST_SITES):
                yield True
                return
            if len(self.sites) * alive.size >= ROOM and self.size > SMALLEST_BATCH:
                yield False
                return
            if len(self.sites) == due:
                yield True
                due *= 2
            for array in (L, r, columns, size, rest, reach):
                np.copyto(array, 0, where=~alive)
            np.copyto(self.last, self.moved(columns), where=alive)
            s, c = lockstep_sincos(shape.turns(X))
            beta = combined(shape.forms, P * -s)
            beta[::2] += 2
            bow = size * size / 4
            wave = P * c * bow
            self.sites.append((alive, s, c, columns, size, rest, reach, beta,
                               combined(shape.forces, wave)))

            wave = slope * c * (1 - bow)
            X, X0 = 2 * X - X0 + combined(shape.forces, wave), X
            X -= np.rint(X)
            new = applied(beta[:, None], L) - L0
            for w, symbols in enumerate(shape.moving):
                for m in symbols:
                    wave = h[w, m] * c[w]
                    for i, k in enumerate(shape.known[w][0]):
                        if k:
                            new[i, m] += wave if k == 1 else k * wave
            bent = bending(P, H, W, np.abs(s) + slack, np.abs(c) + 2 * slack, size, rest, reach)
            err = F * (1 + size[:2]) + F01 * size[1::-1] + (4 + n) * UNIT * size0[:2] + from_H
            if self.turned:
                mean, half = (beta[0] + beta[2]) / 2, (beta[0] - beta[2]) / 2
                err = combined(shape.turned, bent) + (err[0] + err[1])
                block = np.stack((mean + beta[1], half, mean - beta[1]))
            else:
                err, block = combined(shape.strengths, bent) + err, beta
            if d is None:                           # d[q] = beta, f = err - r[o] + roundings
                f, d = r0 + err + along * r + beside * r[::-1], block
            else:
                diagonal, square = d[0] * d[2], d[1] * d[1]
                det = diagonal - square
                inv = 1 / det
                M = np.stack((d[2] * inv, -d[1] * inv, d[0] * inv))
                m, inv = np.abs(M), np.abs(inv)
                alive = alive & (np.abs(det) > 2.0 ** -60)
                f = applied(m, f) + err \
                    + (along + 2 * UNIT * m[::2]) * r + (beside + 2 * UNIT * m[1]) * r[::-1] \
                    + 8 * UNIT * inv * ((np.abs(diagonal) + square) * r0 + np.abs(d[1])
                                        * (np.abs(d[0]) + np.abs(d[2])) * r0[::-1])
                d = block - M
            f = f * MORE
            r, r0 = (applied(np.abs(d), r) + f) * MORE, r
            L, L0, size0 = new, L, size

    def witnesses(self):
        """Vectors n for each site, and how many tails begin there: one where a lane ends, one where
        n begins amid a lane.  Nothing rests on which vectors these are, if only n is zero beyond.

        At each site the recursions from both ends of the orbit are compared, as in witness() above,
        to beta and something for what the bound will add to a site.  A recursion that fails begins
        anew behind that site.  Where both together have a negative eigenvalue that is nearest to
        zero, and n as a rule is largest, is its eigenvector; n follows outwards by the recursions.
        """
        sites, none, shape = self.sites, np.zeros_like(self.l), self.shape
        blocks, tail = [], np.stack((self.l, none, self.l))
        for *_, reach, beta, _ in sites:
            more = (self.caution[0] + self.caution[1] * reach) * reach
            blocks.append(beta + combined(shape.forms, (self.magnitude + self.H) * more))
        outer, back, whole = [], [], []             # the recursion from the end
        inverse, beyond, good = tail, none > 0, none == 0
        for site, block in zip(sites[::-1], blocks[::-1]):
            alive = site[0]
            whole.append(good)
            outer.append(block - np.where(beyond, inverse, tail))
            good = good & (are_definite(outer[-1]) | ~alive)
            inverse, beyond = inverses(outer[-1]), alive
            back.append(inverse)
        outer, back, whole = outer[::-1], back[::-1], whole[::-1]
        begins, ahead = [], []                      # the recursion from the other lane
        good, inverse = self.other(good & beyond), self.other(inverse)
        best, place = np.full_like(none, math.inf), np.full(none.shape, -1)
        form = np.zeros((3, none.size))
        for k, (site, block) in enumerate(zip(sites, blocks)):
            begins.append(~good)
            inner = block - np.where(good, inverse, tail)
            joint = outer[k] + inner - block
            low = least_of(joint)
            score = np.where(site[0] & whole[k] & (low < 0), -low, math.inf)
            better = score < best
            best, place = np.where(better, score, best), np.where(better, k, place)
            np.copyto(form, joint, where=better)
            good, inverse = are_definite(inner), inverses(inner)
            ahead.append(inverse)
        first = self.both(best[:self.size] <= best[self.size:], best[self.size:] < best[:self.size])
        place = np.where(first, place, -1)          # of the two lanes one
        low = least_of(form)
        p, q, r = form
        v = np.where(p > r, np.stack((q, low - p)), np.stack((low - r, q)))
        length = np.sqrt(v[0] * v[0] + v[1] * v[1])
        v = np.where(length > 0, v / np.where(length > 0, length, 1), np.stack((p <= r, p > r)))
        n, x = [], np.zeros_like(v)
        for k in range(len(sites) - 1, -1, -1):
            inward = (place > k) & ~begins[min(k + 1, len(sites) - 1)]
            x = np.where(place == k, v, np.where(inward, applied(ahead[k], x), 0))
            n.append(x)
        n.reverse()
        across = self.other((place >= 0) & ~begins[0]) & sites[0][0]
        n[0] = np.where(across, applied(back[0], self.other(n[0])), n[0])
        tails = []
        for k, site in enumerate(sites):
            if k:
                outward = (place < k) & ((place >= 0) | across)
                n[k] = np.where(outward, applied(back[k], n[k - 1]), n[k])
            n[k] = np.where(site[0], n[k], 0)
            ends = site[0] & ~sites[k + 1][0] if k + 1 < len(sites) else site[0]
            tails.append(ends * 1.0 + (begins[k] & (place >= k)))
        return n, tails

    def expand(self):
        """The left side of (3): its value at X and P, a polynomial, as summit takes it, and what it
        may be more than both; infinite where it cannot be said."""
        N, l, F, known, shape = len(self.sites), self.l, self.F, self.known, self.shape
        n, tails = self.witnesses()
        P, h, H, W, magnitude, grain = self.P, self.h, self.H, self.W, self.magnitude, shape.grain
        K, square_K = shape.K[:, None], (shape.K * shape.square)[:, None]
        pairs = [(i, j) for i in range(known) for j in range(i, known)]
        value, mass, error = np.zeros_like(l), np.zeros_like(l), np.zeros_like(l)
        linear, square = np.zeros((known, l.size)), np.zeros((len(pairs), l.size))
        cubic = np.zeros((known, *square.shape))    # of e[i] and of a pair
        mixed = np.zeros((self.angles, known, l.size))      # of e[i] and a parameter's symbol
        skew = np.zeros((self.angles, known, known, l.size))
        mu = mu1 = np.zeros((2, 1 + known, l.size))     # of this site, and of the one beyond
        n1 = np.zeros((2, l.size))
        for k in range(N - 1, -1, -1):
            _, s, c, columns, size, rest, reach, _, E = self.sites[k]
            n0 = n[k]
            omega = shape.along(n0) ** 2
            long = omega[0] + omega[1]
            value += 2 * long - (P * omega * s).sum(axis=0) - l * tails[k] * long \
                - 2 * (n0[0] * n1[0] + n0[1] * n1[1]) + (mu[0, 0] * E[0] + mu[1, 0] * E[1])
            linear += mu[0, 1:] * E[0] + mu[1, 1:] * E[1]
            m = shape.along(mu)
            A, B = m * c[:, None], -m * s[:, None]
            A[:, 0] -= omega * s
            B[:, 0] -= omega * c
            A0, B0, alpha, beta = A[:, 0], B[:, 0], A[:, 1:], B[:, 1:]
            turn, PA = P[:, None] * B, P * A0
            turn[:, 1:] -= PA[:, None] * columns
            for w in shape.present:
                xi = columns[w]
                first = (P[w] / -2) * alpha[w] - (P[w] * B0[w] / 6) * xi    # what stands with xi^2
                for symbol in shape.moving[w]:
                    part = h[w, symbol]
                    part_A = part * A0[w]
                    first[symbol] -= part_A / 2
                    linear[symbol] += part_A
                    mixed[symbol] += part * alpha[w]
                    skew[symbol] += (part * beta[w])[:, None] * xi
                    turn[w, 1 + symbol] += part * B0[w]
                xi = products(xi)
                square += (PA[w] / 2) * xi
                cubic += first[:, None] * xi
            most = np.abs(mu).sum(axis=1)
            weight = K * combined(shape.sizes[0], most) + square_K * long
            error += remainder(P, H, W, A0, np.abs(alpha).sum(axis=1), B0,
                               np.abs(beta).sum(axis=1), weight, size, rest, reach).sum(axis=0)
            mass += 2 * long + (weight * (magnitude * (1 + reach * reach) + 3 * H)).sum(axis=0)

            G = 2 * mu - mu1 + combined(shape.forces, turn)
            turn = combined(shape.strengths, weight * (magnitude * (1 + size) + H)) \
                + 2 * most + np.abs(mu1).sum(axis=1)
            if k:
                small = most * F + grain * turn * reach[:2]
                mu, mu1, n1 = G, mu, n0
            else:
                across = self.other(mu)
                G, turn = G - across, turn + np.abs(across).sum(axis=1)
                small = most * F + np.abs(G).sum(axis=1) * self.rounding \
                    + grain * turn * (np.abs(self.sides).sum(axis=1) + self.rounding)
                ends = np.stack([G[0] * x + G[1] * y for x, y in zip(*self.sides)])
            error += small[0] + small[1]
        value, mass, error, linear, square, cubic, mixed, skew, ends = map(
            self.joined, (value, mass, error, linear, square, cubic, mixed, skew, ends))
        value -= 2 * (n[0][0, :self.size] * n[0][0, self.size:]
                      + n[0][1, :self.size] * n[0][1, self.size:])
        form = {tuple(key): np.zeros_like(value) for count in (1, 2, 3)
                for key in itertools.combinations_with_replacement(range(known), count)}

        def add(x, *key):
            form[tuple(sorted(key))] += x

        for i in range(known):
            add(linear[i], i)
            for at, (j, k) in enumerate(pairs):
                add((1 + (j < k)) * cubic[i, at], i, j, k)
            for k in range(self.angles):
                add(mixed[k, i], i, k)
                for j in range(known):
                    add(skew[k, i, j], i, j, k)
            for k in (0, 1):
                add(ends[k, 1 + i], i, self.angles + k)
        for at, (j, k) in enumerate(pairs):
            add((1 + (j < k)) * square[at], j, k)
        for k in (0, 1):
            add(ends[k, 0], self.angles + k)
        added = sum([np.abs(x) for x in form.values()])
        mass = UNIT * (((len(P) + 2) * N + 256) * mass + 64 * added)
        error = (error + mass) * (MORE + 64 * UNIT * N)
        return value, form, np.where(mass < UNIT * HUGE, error, math.inf)

    def bound(self):
        """An upper bound of the left side of (3) for each prism; and what each symbol adds to it,
        about, which says where to cut."""
        value, form, error = self.expand()
        share = self.joined(self.last) + TINY
        share = share / share.sum(axis=0)
        moved = np.stack([sum([np.abs(x) for key, x in form.items() if k in key])
                          for k in range(self.known)])
        more = error + moved.sum(axis=0) / 64       # what moves the ends matters, if little
        return value + (summit(form) + error), np.where(value < 0, moved + more * share, share)


class Lockstep:
    """The fast path of some claims; a prism is of one of them."""

    def __init__(self, claims):
        """What all prisms share, and what those of each claim; ValueError if one has numbers that
        it is not made for.

        x* in turns is off by 2^-54 of its rounding and by 2^-80 of the integers, less than
        XSTAR_REST / 2 pi.
        """
        waves = list(dict.fromkeys((wave.k, wave.phase % 2) for claim in claims
                                   for wave in claim.felt))
        if not all(claim.felt for claim in claims):
            raise ValueError("no wave: orbits without end")
        self.axes = sorted({2 + m for claim in claims for wave in claim.felt
                            for m, part in enumerate(wave.parts) if float(part)})   # or TINY
        shape = (len(waves), len(claims))
        self.middle, self.scale = np.zeros(shape), np.zeros(shape)
        self.parts = np.zeros((len(self.axes), *shape))
        for q, claim in enumerate(claims):
            for wave in claim.felt:
                w = waves.index((wave.k, wave.phase % 2))
                parts = [wave.parts[axis - 2] if axis - 2 < len(wave.parts) else 0
                         for axis in self.axes]
                self.middle[w, q] += float(wave.middle)
                self.parts[:, w, q] += [float(part) for part in parts]
                self.scale[w, q] += 2 * float(abs(wave.middle) + sum(map(abs, parts)))
        self.shape = Shape(waves, [(w, m) for m, w in zip(*self.parts.any(axis=2).nonzero())])
        self.axes += [0, 1]                         # of the symbols
        self.centre = np.array([[float(v / 2 % 1) for v in claim.centre] for claim in claims]).T
        self.half = np.array([[float(v / 2) for v in claim.half] for claim in claims]).T
        self.frame = np.array([claim.frame for claim in claims], float).T
        fixed, half_turn = Fixed.of(128), Fraction(1, 2)
        self.xstar = np.array([[float(
            (Fraction(math.floor(x * fixed.one), 2 * fixed.pi) + half_turn) % 1 - half_turn)
            for x in claim.xstar] for claim in claims]).T
        sizes = self.scale, self.half, self.frame, [max(map(abs, c.xstar)) for c in claims], \
            [max(map(abs, c.centre)) for c in claims]
        if max([np.max(np.array(x, float), initial=0) for x in map(np.abs, sizes)]) > FAST_SIZE:
            raise ValueError("too large for the fast path")
        self.batch = BATCH

    def box(self, index, cuts, number):
        """Boxes that cover these cells of the claims with these numbers, as Prisms takes them.

        at and part are exact.  The doubles near middles and parts are off by u of them, the
        products and sums by u of theirs, of four at most: all in all by less than 8 u of their
        sum, of which scale is the double.  Centres and half-widths of the angles alike; in a frame
        other than the identity x[1] has the roundings of two products and a sum, in turns, and its
        columns have those of their products.
        """
        part = np.ldexp(1.0, -cuts.astype(np.intc))
        at = (2 * index + 1 - (1 << cuts)) * part
        P = np.zeros((len(self.shape.known), number.size))
        W, h = np.zeros_like(P), np.zeros((len(P), self.shape.parameters, number.size))
        for w, middle in zip(self.shape.at, self.middle):
            P[w] = middle[number]
        for m, axis in enumerate(self.axes[:-2]):
            for w, parts in zip(self.shape.at, self.parts[m]):
                P[w] += parts[number] * at[axis]
                h[w, m] = parts[number] * part[axis]
        for w, scale in zip(self.shape.at, self.scale):
            W[w] = np.where(scale[number] > 0, 8 * UNIT * scale[number] + TINY, 0)
        V = self.centre[:, number] + self.half[:, number] * at[:2]
        V -= np.rint(V)
        sides = TWO_PI * MORE * (self.half[:, number] * part[:2] + (
            8 * UNIT * (self.centre + self.half)[:, number] + TINY))
        frame = self.frame[:, number]
        columns = frame.reshape(2, 2, -1) * sides
        X = np.stack((frame[0] * V[0] + frame[1] * V[1], frame[2] * V[0] + frame[3] * V[1]))
        off = UNIT * (8 * np.abs(frame.reshape(2, 2, -1)).sum(axis=1)
                      + 2 * np.abs(columns).sum(axis=1))
        off[:, (frame.T == IDENTITY).all(axis=1)] = 0
        return P, h, W, X - np.rint(X), columns, off

    def attempt(self, index, cuts, number, l, caution, halved=None):
        """Is (3) true of all orbits of these cells?  For each, and the axis to cut it along, -1 if
        that seems vain; None if their orbits are too long for so many at a time.

        It is the axis that matters most, but for one that matters and was halved far less often.
        """
        with np.errstate(all="ignore"):
            prisms = Prisms(self.box(index, cuts, number), self.shape, self.xstar[:, number], l,
                            caution)
            excluded = np.zeros(l.shape, bool)
            for ready in prisms.follow():
                if not ready:
                    return None
                bound, blame = prisms.bound()
                excluded |= bound < 0
                if excluded.all():
                    break
        vain = prisms.joined(prisms.sites[-1][0]) & (len(prisms.sites) == FAST_SITES)
        axis = blame.argmax(axis=0)
        if halved is not None:
            halved, at = halved[self.axes], np.arange(axis.size)
            last = np.where(blame > blame[axis, at] * 2.0 ** -30, halved, MAX_CUTS).argmin(axis=0)
            axis = np.where(halved[axis, at] - halved[last, at] > LAG, last, axis)
        return excluded, np.where(vain, -1, np.array(self.axes)[axis])

    def settle(self, cells, least, exactly):
        """Decides on cells, pairs of a claim's number and a cell, with these l: (number of the
        first that is not excluded, why not) or None, and how many pieces each took.

        Those that fail are halved and tried again, up to the checker's limits and with n chosen
        boldly and cautiously in turn (n spreads over few sites if their reach counts, over many if
        its square does); what fails then, exactly(number) -> (None or why not,
        pieces) decides on.
        """
        begun = np.array([cuts for _, (_, cuts) in cells]).T
        pieces, refused = np.zeros(len(cells), int), None
        fine = [n for n, (_, (_, cuts)) in enumerate(cells) if max(cuts) > FAST_CUTS]
        rest = [n for n, (_, (_, cuts)) in enumerate(cells) if max(cuts) <= FAST_CUTS][::-1]
        index, cuts = [np.array([cells[n][1][part] for n in rest], np.int64).reshape(-1, 5).T
                       for part in (0, 1)]
        todo = [index, cuts, np.array([cells[n][0] for n in rest], int),
                np.array([least[n] for n in rest]), np.array(rest, int)]
        while fine or todo[-1].size:
            for n in fine:
                if refused is None or n < refused[0]:
                    why, tried = exactly(n)
                    pieces[n] += tried
                    refused = (n, why) if why else refused
            keep = ~np.isin(todo[-1], fine) & (todo[-1] < (refused[0] if refused else len(cells)))
            todo, fine = [x[..., keep] for x in todo], []
            if not keep.any():
                break
            index, cuts, claim, l, number = [x[..., -self.batch:] for x in todo]
            halved = cuts - begun[:, number]
            halvings = halved.sum(axis=0)
            tried = self.attempt(index, cuts, claim, l,
                                 np.array(CAUTION)[halvings % len(CAUTION)].T, halved)
            if tried is None:
                self.batch //= 2
                continue
            todo = [x[..., :-self.batch] for x in todo]
            pieces += np.bincount(number, minlength=len(cells))
            excluded, axis = tried
            lost = ~excluded & ((axis < 0) | (halvings >= MAX_HALVINGS)
                                | (pieces[number] >= MAX_PIECES)
                                | (cuts[axis, np.arange(axis.size)] >= FAST_CUTS))
            fine = sorted(set(number[lost].tolist()))
            index, cuts, claim, l, number, axis = [
                x[..., ~excluded].repeat(2, axis=-1)
                for x in (index, cuts, claim, l, number, axis)]
            at = np.arange(axis.size)
            index[axis, at] = 2 * index[axis, at] + at % 2
            cuts[axis, at] += 1
            todo = [np.concatenate(both, axis=-1)
                    for both in zip(todo, (index, cuts, claim, l, number))]
        return refused, pieces.tolist()


def lockstep(claims):
    """The fast path, or None: it is not made for the claims' numbers, or, as a line then says, it
    has not the machine it needs."""
    try:
        if sound():
            return Lockstep(claims)
        why = "numpy does not round as it must"
    except ImportError:
        why = "numpy is not installed"
    except (ValueError, OverflowError):
        return None
    complain(why + ": all is checked in integers, hundreds of times slower")
    return None


# ---- what was confirmed already

STATE = """converse-check state 1
certificate: sha256 %s
checker: sha256 %s
confirmed: %d
pieces: %d
"""


class State:
    """How many of a certificate's proved leaves are confirmed, in their order; and if a path is
    given, a small file that knows it, so that a check that was interrupted can go on.

    The file belongs to one certificate and to this very checker.  It is believed: its checksum
    guards against accidents, not against forgers.
    """

    def __init__(self, path, sha256, total):
        self.confirmed = self.pieces = 0
        self.path, self.sha256, self.saved = path and os.path.realpath(path), sha256, 0
        if path is None:
            return
        self.checker = hashlib.sha256(__loader__.get_data(__file__)).hexdigest()
        try:
            if not os.path.lexists(self.path):
                self._write()
                return
            if not stat.S_ISREG(os.stat(self.path).st_mode):
                raise Unusable("the state %s is not a regular file; name another" % path)
            with open(self.path, "rb") as file:
                text = file.read(1000).decode("ascii", "replace")
        except (OSError, ValueError) as error:
            raise Unusable("the state %s cannot be kept (%s); name another file"
                           % (path, reason(error))) from None
        if not text.startswith(STATE.partition("\n")[0]):
            raise Unusable("%s is not a state of this checker; name another file" % path)
        words = re.findall("(?m)^(?:certificate|checker): sha256 ([0-9a-f]{64})$", text)
        found = [int(n) for n in re.findall("(?m)^(?:confirmed|pieces): ([0-9]{1,18})$", text)]
        if len(words) != 2 or len(found) != 2 or text != self._sealed(*words, *found) \
                or found[0] > total and words[0] == sha256:
            raise Unusable("the state %s is damaged; delete it to begin anew" % path)
        if words != [self.sha256, self.checker]:
            raise Unusable("the state %s belongs to another %s; name another file" % (
                path, "checker" if words[0] == self.sha256 else "certificate"))
        self.confirmed, self.pieces = found

    @staticmethod
    def _sealed(*values):
        text = STATE % values
        return text + "checksum: sha256 %s\n" % hashlib.sha256(text.encode()).hexdigest()

    def _write(self):
        """The file is whole at any time, the older one or the newer."""
        handle, name = tempfile.mkstemp(dir=os.path.dirname(self.path), prefix=".converse-check-")
        try:
            with open(handle, "w") as file:
                file.write(self._sealed(self.sha256, self.checker, self.confirmed, self.pieces))
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, self.path)
        except BaseException:
            with contextlib.suppress(OSError):  # a signal after the replacement is not to be lost
                os.unlink(name)
            raise
        self.saved = time.monotonic()

    def advance(self, leaves, pieces):
        self.confirmed, self.pieces = self.confirmed + leaves, self.pieces + pieces
        if self.path and time.monotonic() > self.saved + STATE_SECONDS:
            self.save()

    def save(self):
        """A failure does not end a check of hours: it is said, and there will be another time."""
        if self.path:
            try:
                self._write()
            except OSError as error:
                self.saved = time.monotonic()
                complain("the state %s cannot be written (%s); what it says stands, and the check "
                         "goes on" % (self.path, reason(error)))


# ---- the whole file

_worker = []                            # in each process: its Problems
_late = None                            # where signals wait, the number of the one that came
SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
           if hasattr(signal, name)]


def cost(cell):
    """About what it takes to confirm a leaf: orbits are as long as their leaves are deep, and the
    work grows with the square of their length."""
    return 1 + sum(cell[1]) ** 2


class Problems:
    """The claims of a file, one or those of a map's cells, with a bound of B for each if there are
    any; the fast path of all, if there is one."""

    def __init__(self, claims, bounds=None):
        self.claims, self.bounds, self.fast, self.known = claims, bounds, None, {}

    def criterion(self, n):
        if n not in self.known:
            with named(self.claims[n].where) if self.claims[n].where else contextlib.nullcontext():
                self.known[n] = Criterion(self.claims[n], self.bounds and self.bounds[n])
        return self.known[n]

    def least_in_double(self, leaf):
        return self.criterion(leaf[0]).least_in_double(leaf[1])

    def excluded(self, leaf):
        return self.criterion(leaf[0]).excluded(leaf[1])

    def leaves(self):
        """The leaves P of all claims, as (number of the claim, cell), in their order."""
        for n, claim in enumerate(self.claims):
            for position, cell in leaves(claim.tree):
                if claim.tree[position] == "P":
                    yield n, cell


def check_chunk(chunk):
    """Checks leaves in order: (how many are confirmed, their cost and pieces, what then fails)."""
    problems, = _worker
    cells, refused, pieces = [leaf for _, leaf in chunk], None, []
    if problems.fast:
        refused, pieces = problems.fast.settle(
            cells, [problems.least_in_double(leaf) for leaf in cells],
            lambda n: problems.excluded(cells[n]))
    else:
        for n, leaf in enumerate(cells):
            why, tried = problems.excluded(leaf)
            if why:
                refused = n, why
                break
            pieces.append(tried)
    n = refused[0] if refused else len(cells)
    return n, sum([cost(cell) for _, cell in cells[:n]]), sum(pieces[:n]), \
        refused and (*chunk[n], refused[1])


@contextlib.contextmanager
def undisturbed():
    """The signal waits, also in a process that is begun meanwhile: an exception that struck inside
    the locks of a pool would leave them broken, or locked for ever."""
    global _late
    _late, before = [], None
    try:
        if hasattr(signal, "pthread_sigmask"):
            before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        yield
    finally:
        try:
            if before is not None:          # the handler may be another one, and raise here
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        finally:
            late, _late = _late, None
        if late:                            # another thread may have taken it in spite of the mask
            raise KeyboardInterrupt(*late)


def begin_apart(problems, stop):
    """Starts a worker process.  Signals are for the parent to notice; a worker ends when its parent
    says so, or has died."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    _worker[:] = [problems]
    if problems.fast:
        sound()
    threading.Thread(target=end_with_parent, args=(stop,), daemon=True).start()


def end_with_parent(stop):
    import multiprocessing.connection
    multiprocessing.connection.wait([stop, multiprocessing.parent_process().sentinel])
    os._exit(1)


def in_order(chunks, jobs, problems):
    """Yields the results of the chunks in their order, few of them being in memory at a time."""
    if jobs == 1:
        _worker[:] = [problems]
        yield from map(check_chunk, chunks)
        return
    import concurrent.futures.process       # where there are no processes, one job still works
    import multiprocessing

    def result(future):
        while True:
            with undisturbed():
                if concurrent.futures.wait([future], LOOK_SECONDS).done:
                    return future.result()

    stop, stopper = multiprocessing.Pipe(duplex=False)
    pool = concurrent.futures.ProcessPoolExecutor(jobs, initializer=begin_apart,
                                                  initargs=(problems, stop))
    waiting, over = collections.deque(), False
    try:
        for chunk in chunks:
            with undisturbed():
                waiting.append(pool.submit(check_chunk, chunk))
            if len(waiting) > 4 * jobs:
                yield result(waiting.popleft())
        while waiting:
            yield result(waiting.popleft())
        over = True
    except concurrent.futures.process.BrokenProcessPool:
        raise Unusable("a worker process died; nothing was verified") from None
    finally:
        if not over:                        # what the workers still do is of no use to anybody
            stopper.send_bytes(b"stop")
        with undisturbed():
            pool.shutdown(cancel_futures=True)
        stop.close()
        stopper.close()


@dataclass(frozen=True)
class Result:
    """What came of a check in which nothing failed: true only if the whole claim is verified and
    its region is the whole torus, or all that a map says is proved.  (All else is an exception.)"""

    status: int                         # VERIFIED, PART or SPOT_CHECK: the exit status, too
    verdict: str                        # "verified", "verified in part" or "spot check"
    text: str                           # the report

    def __bool__(self):
        return self.status == VERIFIED


def verify(path, jobs=1, sample=None, state=None, bar=False, exact=False):
    """Verifies a proof file or a map: a Result; else Rejected, NotConfirmed or Unusable is raised.

    jobs: processes.  sample: so many leaves only, chosen by chance: a spot check.
    state: a file that remembers what was confirmed, so that an interrupted check can go on; it
    is kept in the end.  bar: show the progress on stderr, if that is a terminal.  exact: in
    integers alone, as where there is no numpy.
    """
    if jobs < 1 or sample is not None and sample < 1:
        raise ValueError("jobs and sample are 1 or more")
    if sample is not None and state is not None:
        raise Unusable("a spot check keeps no state; give --sample or --state")
    file = read(path)
    if isinstance(file, Map):
        problems = Problems(file.claims, check_map(file))
    else:
        check_tree(file)
        check_mirror_images(file)
        problems = Problems((file,))
        check_at_once(problems.criterion(0))
    if not exact and problems.claims:
        problems.fast = lockstep(problems.claims)
    proved = [claim.counts["proved"] for claim in problems.claims]
    done = State(state, file.sha256, sum(proved))
    earlier = done.confirmed
    chosen = range(earlier, sum(proved))
    if sample is not None:
        chosen = set(random.SystemRandom().sample(chosen, min(sample, sum(proved))))

    def work():
        return ((n, leaf) for n, leaf in enumerate(problems.leaves()) if n in chosen)

    queue = work()
    size = CHUNK
    if problems.fast:
        fewest, most = FAST_CHUNK
        size = min(max(len(chosen) // (CHUNKS * jobs), fewest), most)
    chunks = iter(lambda: list(itertools.islice(queue, size)), [])
    try:
        with Bar(work() if bar else (), len(chosen)) as progress, \
                contextlib.closing(in_order(chunks, jobs, problems)) as results:
            for n, spent, pieces, failure in results:
                done.advance(n, pieces)
                progress.advance(n, spent)
                if failure:
                    n, (at, cell), why = failure
                    claim = problems.claims[at]
                    raise NotConfirmed(
                        "%s%s is not excluded: %s; the claim is false or its proof beyond the "
                        "limits of this checker" % (
                            claim.where, leaf_text(claim, "P", n - sum(proved[:at]), cell), why))
    finally:
        done.save()
    return report(file, problems, done, earlier, sample is not None)


def check_at_once(criterion):
    """Rejected or NotConfirmed, if larger parameters are claimed to be excluded at once, and are
    not."""
    if criterion.claim.at_once != "no" and not criterion.at_once():
        if criterion.not_at_once():
            raise Rejected("larger parameters are not excluded at once: B <= 10/3 for some")
        raise NotConfirmed("that larger parameters are excluded at once (B > 10/3)")


# ---- maps
# A map is of the thesis's potential.  The points of a face are (a, b, c) = r d(s, t), d(s, t) =
# d0 + s d1 + t d2, 0 <= r <= radius, 0 <= s, t <= 1; without d2 there is no t.  About the middle of
# a cell of (r, s, t)
#       r d(s, t) = r d(sm, tm) + r (s - sm) d1 + r (t - tm) d2
# is covered by a patch of three parameters, or two: with middle rm d(sm, tm) and the parts
# (r1 - r0)/2 d(sm, tm), r1 (s1 - s0)/2 d1, r1 (t1 - t0)/2 d2.

REGIONS = {"b=0": (((1, 0, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0))),
           "a=b": (((1, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 1, 0))),
           "c=0": (((1, 0, 0), (0, 1, 0)),),
           "sphere": (((1, 0, 0), (0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0), (0, 1, 0)))}
MAP_AXES, MAP_KINDS = "012", "PAOX"     # of the tree of a face: cuts of r, s, t; leaves
GRID, MAP_CELLS = (16, 8), 2000         # of a face with s, or s and t; of the torus: for B


@dataclass(frozen=True)
class Face:
    """A face of a map: d0, d1 and perhaps d2, and its cells, (kind, index, cuts)."""

    directions: tuple
    radius: Fraction
    cells: tuple

    @functools.cached_property
    def proved(self):
        """What proved_from says of it."""
        return proved_from(self.cells, self.radius, len(self.directions) - 1)

    def d(self, place):
        """d(s, t) of exact numbers."""
        d0, *others = self.directions
        return [x + sum([p * d[i] for p, d in zip(place, others)]) for i, x in enumerate(d0)]

    def box(self, index, cuts):
        """The ends of r, and those of s and t."""
        r, *sides = [(Fraction(i, 1 << k), Fraction(i + 1, 1 << k))
                     for i, k in zip(index, cuts[:len(self.directions)])]
        return [self.radius * x for x in r], sides

    def waves(self, cell, least=False):
        """The waves of the patch of a cell; or of the patch of its points of the least r."""
        (r0, r1), sides = self.box(*cell)
        if least:
            r1 = r0
        middle = self.d([(low + high) / 2 for low, high in sides])
        parts = [[(r1 - r0) / 2 * x for x in middle]] + [
            [r1 * (high - low) / 2 * x for x in d]
            for (low, high), d in zip(sides, self.directions[1:])]
        return tuple(Wave(k, Fraction(0), (r0 + r1) / 2 * x, tuple(column))
                     for k, x, column in zip(THESIS, middle, zip(*parts)))

    def is_outside(self, cell):
        """Is b >= a all over the cell, and not only b = a?  b - a is r times what is affine in s
        and t: so it is at the corners."""
        _, sides = self.box(*cell)
        excess = [b - a for a, b, _ in map(self.d, itertools.product(*sides))]
        return min(excess) >= 0 and max(excess) > 0


@dataclass(frozen=True)
class Map:
    """What a map says."""

    region: str
    faces: tuple
    claims: tuple                       # of the proved cells, in their order
    sha256: str                         # of the file, uncompressed

    def count(self, kind):
        return sum(cell[0] == kind for face in self.faces for cell in face.cells)


@contextlib.contextmanager
def named(name):
    """What fails within is told by this name."""
    try:
        yield
    except Failure as error:
        raise type(error)("%s: %s" % (name, error)) from None


def fields_of(value, name, *ignored, **kinds):
    """The values of an object that must have just these fields, of these types, but for some that
    may be there and are ignored."""
    if type(value) is not dict or value.keys() - set(ignored) != {key.replace("_", " ")
                                                                 for key in kinds}:
        raise Rejected("%s is not an object with the fields %s, and no other"
                       % (name, ", ".join(sorted(kinds)).replace("_", " ")))
    values = [value[key.replace("_", " ")] for key in kinds]
    for key, kind, found in zip(kinds, kinds.values(), values):
        if type(found) is not kind:
            raise Rejected("%s: its %s is not of the type it must be"
                           % (name, key.replace("_", " ")))
    return values


def list_of(value, count, kind, name):
    if type(value) is not list or len(value) != count or any(type(x) is not kind for x in value):
        raise Rejected("%s is not a list of %d as they must be" % (name, count))
    return value


def read_map(data):
    """The map; every patch of its own is whole, and nothing in it is of unknown meaning."""
    if data.count(b",") + data.count(b"[") + data.count(b"{") > MAX_ITEMS:
        raise NotConfirmed("the map has more than %d items, the checker's limit" % MAX_ITEMS)

    def once(pairs):
        if len(dict(pairs)) != len(pairs):
            raise ValueError("a field appears twice")
        return dict(pairs)

    def integer(text):
        if len(text) > 10:
            raise ValueError("an integer is too long")
        return int(text)

    def finite(text):
        if not math.isfinite(float(text)):
            raise ValueError("a number is not finite")
        return float(text)

    try:
        content = json.loads(data.decode("utf-8"), object_pairs_hook=once, parse_int=integer,
                             parse_float=finite, parse_constant=finite)
    except UnicodeDecodeError:
        raise Rejected("the map is not UTF-8: it was altered or damaged") from None
    except json.JSONDecodeError as error:
        raise Rejected("the map is no whole JSON text, at character %d: it was truncated or altered"
                       % error.pos) from None
    except RecursionError:
        raise Rejected("the map is nested too deeply") from None
    except ValueError as error:
        raise Rejected("the map is not as maps are: %s" % error) from None
    if not isinstance(content, dict) or content.get("format") != "converse map 1":
        raise Unusable("is not a map of the version that this checker knows, converse map 1")
    _, _, region, down_to, faces, sha256 = fields_of(
        content, "the map", "seconds", format=str, program=str, region=str, down_to=str, faces=list,
        sha256=str)
    del content["sha256"]
    try:
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    except RecursionError:
        raise Rejected("the map is nested too deeply") from None
    if hashlib.sha256(text.encode()).hexdigest() != sha256:
        raise Rejected("wrong checksum: the map was changed or damaged")
    del content, text
    if region not in REGIONS:
        raise Rejected("the map's region is none of %s" % ", ".join(sorted(REGIONS)))
    number(down_to, "the map's 'down to'")
    if len(faces) != len(REGIONS[region]):
        raise Rejected("the region has %d faces, the map %d" % (len(REGIONS[region]), len(faces)))
    whole, claims, file = [], [], hashlib.sha256(data).hexdigest()
    for at, face in enumerate(faces, 1):
        with named("face %d" % at):
            whole.append(read_face(face, claims, at, file))
    if sorted(face.directions for face in whole) != sorted(REGIONS[region]):
        raise Rejected("the faces are not those of the region")
    return Map(region, tuple(whole), tuple(claims), file)


def read_face(face, claims, at, sha256):
    """A face of a map; adds the claims of its proved cells."""
    directions, radius, tree, proofs = fields_of(face, "it", "tried", "estimate", directions=list,
                                                 radius=str, tree=str, proofs=list)
    if len(directions) not in (2, 3):
        raise Rejected("it has not two or three directions")
    directions = tuple(tuple(number(x, "a direction") for x in list_of(d, 3, str, "a direction"))
                       for d in directions)
    radius = number(radius, "its radius")
    if radius <= 0:
        raise Rejected("its radius is not above 0")
    axes, cells, proofs = MAP_AXES[:len(directions)], [], iter(proofs)
    for position, cell in leaves(tree, axes, MAP_KINDS):
        kind = tree[position]
        cells.append((kind, *cell))
        if kind == "P":
            if (proof := next(proofs, None)) is None:
                raise Rejected("it has fewer proofs than proved cells")
            with named("cell %d" % len(cells)):
                claims.append(read_cell(proof, Face(directions, radius, ()).waves(cell),
                                        "face %d, cell %d: " % (at, len(cells)), sha256))
    if next(proofs, None) is not None:
        raise Rejected("it has more proofs than proved cells")
    return Face(directions, radius, tuple(cells))


def read_cell(proof, waves, name, sha256):
    """The claim of a proved cell."""
    xstar, frame, alone, tree = fields_of(proof, "its proof", xstar=list, frame=list, alone=str,
                                          tree=str)
    xstar = tuple(number(x, "x*") for x in list_of(xstar, 2, str, "x*"))
    frame = check_frame([str(x) for x in list_of(frame, 4, int, "the frame")], "the frame")
    if alone not in ("no", "0", "1"):
        raise Rejected("alone is neither no nor 0 nor 1")
    alone = None if alone == "no" else int(alone)
    check_alone(waves, alone)
    one = Fraction(1)
    claim = Claim(waves, (one, one), (one, one), frame, alone, xstar, {}, "no", tree, sha256, name)
    claim.counts.update(tree_counts(claim))
    check_mirror_images(claim)
    return claim


def check_map(file):
    """Rejected or NotConfirmed, if a cell is not outside or not at once; else for each proved cell
    an upper bound of B.

    B - 2 is convex and homogeneous of degree 1 in the amplitudes.  So it is r times its value at
    d(s, t), which lies below what is linear along s and along t between points of a grid; and over
    a cell this, or the convex function itself where the cell has more than one slice of the grid,
    is largest at a corner.
    """
    fixed, bounds, claims = Fixed.of(96), [], iter(file.claims)
    for at, face in enumerate(file.faces, 1):
        with named("face %d" % at):
            face.proved                 # which has a limit: not to be met after hours

        @functools.lru_cache(maxsize=None)
        def excess(place, face=face):
            """B - 2 at a point of the grid, exact and from above."""
            known = {(*k, 0): math.floor(x * fixed.one) for k, x in zip(THESIS, face.d(place)) if x}
            bound = torus_bound(fixed, list(known), [tuple(known.values())], MAP_CELLS) \
                + stiffness(known)
            return Fraction(bound, fixed.one) - 2

        grid = GRID[len(face.directions) - 2]

        def between(place, grid=grid, excess=excess):
            """The same, at any point of the face."""
            nodes = [((), Fraction(1))]
            for x in place:
                low = Fraction(min(math.floor(x * grid), grid - 1), grid)
                u = (x - low) * grid
                nodes = [(node + (y,), weight * v) for node, weight in nodes
                         for y, v in ((low, 1 - u), (low + Fraction(1, grid), u)) if v]
            return sum([weight * excess(node) for node, weight in nodes])

        for n, (kind, *cell) in enumerate(face.cells, 1):
            name = "face %d, cell %d" % (at, n)
            if kind == "X" and not face.is_outside(cell):
                raise Rejected("%s is said to be outside of the region, and is not" % name)
            if kind == "A" and not is_at_once(fixed, present(face.waves(cell, least=True))):
                raise NotConfirmed("%s: that it and all larger multiples are excluded at once "
                                   "(B > 10/3)" % name)
            if kind == "P":
                claim, ((_, r), sides) = next(claims), face.box(*cell)
                if claim.alone is None:
                    bounds.append(2 + r * max(map(between, itertools.product(*sides))))
                else:       # one coordinate, whose waves add no more than their amplitudes
                    bounds.append(2 + sum([wave.k[claim.alone] ** 2 * (
                        abs(wave.middle) + sum(map(abs, wave.parts))) for wave in claim.felt]))
    return bounds


def sign_changes():
    """How V's maps of the torus change the signs of a, b and c, generated by y0 -> y0 + pi,
    y1 -> y1 + pi and y -> -y: sin(k.(y + pi s)) = (-1)^(k.s) sin(k.y), sin(-k.y) = -sin(k.y)."""
    found = {(1, 1, 1)}
    for signs in [tuple([(-1) ** k[i] for k in THESIS]) for i in (0, 1)] + [(-1, -1, -1)]:
        found |= {tuple([p * q for p, q in zip(signs, other)]) for other in found}
    return found


def proved_from(cells, radius, axes):
    """The least r from which on, up to the radius, every direction of these cells is proved (None
    if not even at the radius), and whether every direction is proved from somewhere on for ever.

    A cell at once is proved from its least r on.  Directions in which some cell is finer are
    looked at in halves; where all cells are as wide as the directions, the unproved ones are
    those not above the first that is at once.  NotConfirmed, if that are too many halves: strips
    of s below strips of t make all their products.
    """
    worst, forever, seen = Fraction(0), True, 0
    todo = [((0,) * axes, (0,) * axes, cells)]
    while todo:
        index, cuts, cells = todo.pop()
        seen += len(cells)
        if seen > MAX_ITEMS:
            raise NotConfirmed("its cells lie in too many ways below each other for this checker")
        axis = next((m for m in range(axes)
                     if any(cell[2][1 + m] > cuts[m] for cell in cells)), None)
        if axis is None:
            ends = [(kind, radius * i / (1 << k), radius * (i + 1) / (1 << k))
                    for kind, (i, *_), (k, *_) in cells]
            once = min([low for kind, low, _ in ends if kind == "A"], default=None)
            worst = max([worst] + [high if once is None else min(high, once)
                                   for kind, low, high in ends
                                   if kind == "O" and (once is None or low < once)])
            forever &= once is not None or any(kind == "X" and high == radius
                                               for kind, _, high in ends)
            continue
        for upper in (0, 1):
            i, k = changed(index, axis, 2 * index[axis] + upper), changed(cuts, axis,
                                                                          cuts[axis] + 1)

            def meets(cell):
                ours, theirs = k[axis], cell[2][1 + axis]
                return cell[1][1 + axis] >> max(theirs - ours, 0) == \
                    i[axis] >> max(ours - theirs, 0)

            todo.append((i, k, [cell for cell in cells if meets(cell)]))
    return worst if worst < radius else None, forever


# ---- what is said

def shown(text):
    """The text without anything that could steer a terminal, on one line."""
    return "".join([x if x.isprintable() else x.encode("unicode_escape").decode() for x in text])


def complain(text):
    with contextlib.suppress(OSError, AttributeError):      # closed, or there is none
        print("converse-check: " + shown(text), file=sys.stderr, flush=True)


class Bar:
    """The progress on stderr, if it is a terminal: leaves, and by their cost what is left."""

    def __init__(self, work, total):
        self.total, self.done, self.spent, self.began = total, 0, 0, time.monotonic()
        self.drawn, self.width = self.began + 5 * BAR_SECONDS, 0    # a short check has none
        self.on = bool(work) and sys.stderr is not None and sys.stderr.isatty()
        self.cost = sum(cost(cell) for _, (_, cell) in work) if self.on else 0

    def __enter__(self):
        return self

    def advance(self, leaves, spent):
        self.done, self.spent = self.done + leaves, self.spent + spent
        now = time.monotonic()
        if self.on and self.spent and now > self.drawn + BAR_SECONDS:
            self.drawn = now
            self.draw("{:,} of {:,} leaves, {:.0%}, about {} left".format(
                self.done, self.total, self.spent / self.cost,
                duration((now - self.began) * (self.cost / self.spent - 1))))

    def draw(self, text):
        with contextlib.suppress(OSError):
            print("\r" + text.ljust(self.width), end="\r", file=sys.stderr, flush=True)
        self.width = len(text)

    def __exit__(self, *_):
        if self.width:
            self.draw("")


def duration(seconds):
    for unit, length in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return "%d %s" % (seconds / length, unit)
    return "%d s" % seconds


def decimal_text(x):
    """A finite decimal, exactly."""
    places = 0
    while 10 ** places % x.denominator:
        places += 1
    digits = str(abs(x.numerator) * (10 ** places // x.denominator)).rjust(places + 1, "0")
    whole, rest = digits[:len(digits) - places], digits[len(digits) - places:]
    return "-" * (x < 0) + whole + ("." + rest if rest else "")


def range_text(name, low, high):
    low, high = decimal_text(low), decimal_text(high)
    return "%s = %s" % (name, low) if low == high else "%s <= %s <= %s" % (low, name, high)


def leaf_text(claim, kind, ordinal, cell):
    """Names a leaf by its number among those of its kind, its depth and where it lies."""
    index, cuts = cell

    def sides(ends):
        return " x ".join(["[%.9g, %.9g]" % (low, high) for low, high in ends])

    t = [Fraction(2 * i + 1, 1 << k) - 1 for i, k in zip(index[2:], cuts[2:])]
    angles = [(c - h + 2 * h * i / (1 << k), c - h + 2 * h * (i + 1) / (1 << k))
              for c, h, i, k in zip(claim.centre, claim.half, index, cuts)]
    spread = [sum([abs(g) / (1 << k) for g, k in zip(wave.parts, cuts[2:])])
              for wave in claim.waves]
    return "%s leaf %d of %d (v in %s pi, amplitudes in %s, %d cuts)" % (
        {"P": "proved", "S": "symmetric"}[kind], ordinal + 1, claim.tree.count(kind),
        sides(angles), sides([(wave.at(t) - x, wave.at(t) + x)
                              for wave, x in zip(claim.waves, spread)]), sum(cuts))


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
        "Method : Loewner criterion, %sTaylor models in integers%s" % (
            "multipliers in doubles, and where these fail " * bool(problems.fast),
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


# ---- the command

def interrupt(number, frame):
    """The first signal ends the check, where it may; the end itself is quick and must not be
    interrupted."""
    for heard in SIGNALS:
        signal.signal(heard, signal.SIG_IGN)
    if _late is None:
        raise KeyboardInterrupt(number)
    _late.append(number)


@contextlib.contextmanager
def interruptible(alone):
    """Lets the signals interrupt, but those that are ignored (nohup); only the main thread may.

    Where nothing else is to come in this process (alone), they are left to end it in silence.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    heard = [number for number, handler in before.items() if handler not in (None, signal.SIG_IGN)]
    try:
        for number in heard:
            signal.signal(number, interrupt)
        yield
    finally:
        for number in heard:
            signal.signal(number, signal.SIG_DFL if alone else before[number])


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Unusable(message + "; see converse-check --help")


def whole(text):
    if not re.fullmatch("[0-9]{1,9}", text, re.ASCII) or int(text) == 0:
        raise argparse.ArgumentTypeError("'%.40s' is not a whole number above 0" % text)
    return int(text)


def parser():
    p = Parser(prog="converse-check", allow_abbrev=False,
               formatter_class=argparse.RawDescriptionHelpFormatter, description=(
        "Verifies the theorem of a proof file, or all those of a map, independently of the\n"
        "program that wrote them."),
        epilog="""exit status:
  0    verified
  1    rejected: the file is wrong (altered, unfinished, with undecided or missing
       parts, wrong counts, a skipped part without its mirror image)
  2    bad usage, or a file that cannot be read
  3    verified, but for successors in a part of the torus only
  4    a spot check in which nothing failed: NOT a verification
  5    not confirmed: the claim is false or its proof beyond the checker's limits
  130  interrupted (129, 143: by SIGHUP, SIGTERM)""")
    p.add_argument("file", help="a finished proof file or a map, perhaps compressed by gzip")
    p.add_argument("--jobs", type=whole, default=1, metavar="N", help="processes (default 1)")
    p.add_argument("--sample", type=whole, metavar="K",
                   help="only a spot check, of K leaves chosen by chance; not a verification")
    p.add_argument("--state", metavar="FILE", help=(
        "remember in FILE what was confirmed, and go on from there if it exists; it is believed"))
    p.add_argument("--exact", action="store_true", help=(
        "bound all leaves in integers, not first in doubles by numpy: hundreds of times slower"))
    p.add_argument("--quiet", action="store_true", help="no report of status 0, no bar")
    p.add_argument("--version", action="version", version="converse-check " + __version__)
    return p


def command(argv, options):
    """Fills in the options and does what they say; returns the exit status."""
    try:
        if sys.stdout is None:
            raise Unusable("the standard output is closed: nowhere to report to")
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.reconfigure(errors="backslashreplace")
        parser().parse_args(argv, options)
        result = verify(options.file, min(options.jobs, 61), options.sample, options.state,
                        not options.quiet, options.exact)
        try:
            if result.status != VERIFIED or not options.quiet:
                print(result.text, flush=True)
            return result.status
        except OSError as error:
            with contextlib.suppress(OSError):  # the interpreter must not try again when it ends
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise Unusable("the output cannot be written (%s)" % reason(error)) from None
    except SystemExit as end:                   # of --help and --version
        return end.code
    except Failure as error:
        status, message = error.status, error.word + str(error)
    except Exception as error:                  # whatever went wrong must not look like success
        status, message = UNUSABLE, "the checker failed (%s: %s)" % (type(error).__name__, error)
    complain((options.file and options.file + ": ") + message)
    return status


def main(argv=None):
    """Runs the command and returns its exit status; every failure is one line."""
    options = argparse.Namespace(file="", state=None)
    with interruptible(argv is None):
        try:
            return command(argv, options)
        except KeyboardInterrupt as end:
            message = "interrupted; nothing was verified"
            if options.state is not None:
                message += ", but the same command goes on from " + options.state
            complain((options.file and options.file + ": ") + message)
            return INTERRUPTED + (end.args[0] if end.args else signal.SIGINT)


if __name__ == "__main__":
    sys.exit(main())
