"""converse-check: verifies the theorem of a proof file, independently of the program that wrote it.

The map.  V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1);  x[j+1] = 2 x[j] - x[j-1] - V'(x[j]);
beta(x) = 2I - V''(x).  Its orbits are stationary for the sum of |x[j+1] - x[j]|^2 / 2 - V(x[j]),
whose second variation is  Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1].

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

The left side of 3 is a sum of terms p sin(y) with known weights.  Over a prism each term is enclosed
by a first-order Taylor model in a, b, c and the two angles of x[1] (and in one new symbol for every
error made on the way), so the sum is bounded as a whole: effects that cancel, cancel.

The arithmetic.  Python integers, in units of 2^-bits: exact, unbounded, and each rounding, a >> or a
//, is to be seen where it happens.  Errors are counted in units.

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
import gzip
import hashlib
import heapq
import io
import itertools
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
MAX_POINTS = 330                        # of an orbit
CHUNKS, CHUNK = 8, 16                   # tasks of a process, about; leaves of one, with --exact
FAST_CHUNK = 1 << 8, 1 << 14            # least and most of the fast path
NU_BITS = 20                            # of the test vectors
STATE_SECONDS, BAR_SECONDS = 10, 0.2    # between two writes


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

NAMES = ("a", "b", "c", "v0", "v1")
AXES = "01234"                          # of cuts: v0, v1, then a, b, c or, together, 2 for all
COUNTS = ("depth", "cuts", "proved", "symmetric", "undecided", "most_cuts")
IGNORED = ("program", "method", "digits", "stubborn", "quick_tries", "tries", "Rtries",
           "HermSuccess", "LLSuccess", "ll_used", "reasons", "max_steps", "max_NTsteps",
           "B", "pending")
OPTIONAL = {"T", "Tr-", "Tr+", "lambda-min", "lambda-max", "seconds", "comment"}    # ignored, too
FIELDS = {*NAMES, *COUNTS, *IGNORED, "kind", "xstar", "together", "at once"}
KNOWN = FIELDS | OPTIONAL
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", re.ASCII)


MAGIC = b"converse proof "               # and the version, alone on the first line


def reason(error):
    """An OSError in words."""
    return getattr(error, "strerror", None) or str(error)


@dataclass(frozen=True)
class Claim:
    """What a proof file says: exact numbers, the angles v0 and v1 in units of pi."""

    centre: tuple
    half: tuple
    xstar: tuple
    counts: dict
    together: bool                      # the parameters move as one, from end to end
    at_once: bool                       # the claim covers larger multiples of them, too
    tree: str
    sha256: str                         # of the file, uncompressed


def read(path):
    """Reads a proof file; nothing in it is believed but what the claim is."""
    try:
        with open(path, "rb") as file:
            packed = file.peek(2)[:2] == b"\x1f\x8b"
            stream = gzip.GzipFile(fileobj=file) if packed else file
            data = bytearray(stream.read(len(MAGIC)))
            if data != MAGIC:
                raise Unusable("is not a proof file")
            while (more := stream.read(1 << 20)) and len(data) <= MAX_BYTES:
                data += more
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise Unusable("the compressed file is damaged or truncated") from None
    except (OSError, ValueError) as error:
        raise Unusable("cannot be read (%s)" % reason(error)) from None
    if len(data) > MAX_BYTES:
        raise NotConfirmed("the file is larger than %d bytes, the checker's limit" % MAX_BYTES)
    first = data[len(MAGIC):len(MAGIC) + 9].partition(b"\n")[0]
    if first.endswith(b"\r"):
        raise Rejected("its lines end in CR LF: it was altered on its way; ask for the original")
    if first != b"2":
        raise Unusable("is a proof file of another version; this checker knows version 2")
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


def parse(head, tree, sha256):
    """The claim; the header must give each field once, and nothing of unknown meaning.

    Nothing of it is repeated in a message but the names of fields that are known.
    """
    header, file = {}, io.BytesIO(head)
    file.readline()                                     # which read has seen to
    for number, line in enumerate(iter(lambda: file.readline(MAX_LINE), b""), 2):
        if len(line) == MAX_LINE:
            raise NotConfirmed("line %d is longer than the checker's limit, %d bytes"
                               % (number, MAX_LINE - 1))
        name, colon, value = line.decode("utf-8", "replace").rstrip("\n").partition(": ")
        if not colon or name not in KNOWN:
            raise Rejected("line %d, in the header, is of unknown meaning" % number)
        if name in header and name != "comment":
            raise Rejected("the header gives %s twice" % name)
        header[name] = value
    if "xstar" not in header:
        raise Rejected("the search had not begun when it was left: there is no x* yet")
    if FIELDS - header.keys():
        raise Rejected("the header lacks %s" % ", ".join(sorted(FIELDS - header.keys())))
    if header["kind"] != "sound":
        raise Rejected("the file's kind is not 'sound': it is not meant as a proof")
    pairs = []
    for name in (*NAMES, "xstar"):
        words = header[name].split(" ", 2)
        if len(words) != 2 or not all(map(NUMBER.fullmatch, words)):
            raise Rejected("the header's %s is not two decimal numbers" % name)
        if max(map(len, words)) > MAX_CHARACTERS:
            raise NotConfirmed("the header's %s has more than %d characters, the checker's limit"
                               % (name, MAX_CHARACTERS))
        pairs.append(tuple(map(Fraction, words)))
        if max(map(abs, pairs[-1])) > MAX_SIZE:
            raise NotConfirmed("the header's %s is out of range: the checker's limit is 1e300"
                               % name)
    *ranges, xstar = pairs
    if min(half for _, half in ranges) < 0:
        raise Rejected("a half-width is negative")
    for name in COUNTS:
        if not re.fullmatch("[0-9]{1,18}", header[name], re.ASCII):
            raise Rejected("the header's %s is not a count" % name)
    for name in ("together", "at once"):
        if header[name] not in ("yes", "no"):
            raise Rejected("the header's %s is neither yes nor no" % name)
    return Claim(*zip(*ranges), xstar, {name: int(header[name]) for name in COUNTS},
                 header["together"] == "yes", header["at once"] == "yes", tree, sha256)


# ---- the tree
# A cell (index, cuts) is slice index[k] of the 2^cuts[k] equal slices of the region along each of
# the five axes k.  Cutting a cell replaces it by its two halves, so the leaves of a complete tree
# tile the region exactly.

ROOT = (0,) * 5, (0,) * 5


def changed(values, axis, value):
    return values[:axis] + (value,) + values[axis + 1:]


def leaves(tree):
    """Yields (position, cell) for each leaf, in preorder; Rejected if it is not a whole tree."""
    pending = [ROOT]
    for position, node in enumerate(tree):
        if not pending:
            raise Rejected("the tree ends before its text does, at node %d" % position)
        index, cuts = cell = pending.pop()
        axis = AXES.find(node)
        if axis >= 0:
            cuts = changed(cuts, axis, cuts[axis] + 1)
            pending += ((changed(index, axis, 2 * index[axis] + upper), cuts) for upper in (1, 0))
        elif node in "PSU":
            yield position, cell
        else:
            raise Rejected("%a is not a node of a finished tree, at node %d" % (node, position))
        if sum(cuts) > MAX_CUTS:
            raise NotConfirmed("node %d lies below %d cuts, the checker's limit"
                               % (position, MAX_CUTS))
    if pending:
        raise Rejected("the tree is incomplete: %d of its parts are missing" % len(pending))


def check_tree(claim):
    """Rejected, if the tree is not whole, decided, and what the header's counts say."""
    total = most_cuts = 0
    if claim.together and set("34") & set(claim.tree):
        raise Rejected("parameters that move together are cut one at a time")
    for position, (_, cuts) in leaves(claim.tree):
        total += 1
        depth = sum(cuts)
        if claim.tree[position] == "U":
            raise Rejected("leaf %d is undecided: the file claims no theorem" % total)
        if depth > claim.counts["depth"]:
            raise Rejected("leaf %d was cut more often than the depth allows" % total)
        if claim.tree[position] == "P":
            most_cuts = max(most_cuts, depth)
    found = {"cuts": total - 1, "proved": claim.tree.count("P"),
             "symmetric": claim.tree.count("S"), "undecided": 0, "most_cuts": most_cuts}
    for name, value in found.items():
        if claim.counts[name] != value:
            raise Rejected("the header's %s is %d, the tree's %d"
                           % (name, claim.counts[name], value))


class Mirror:
    """The exchange of v0 and v1, a and b: may a leaf be skipped for the sake of its mirror image?"""

    def __init__(self, claim):
        """The exchange maps orbits to orbits; the rest must be its own image."""
        a, b, _, v0, v1 = zip(claim.centre, claim.half)
        self.symmetric = a == b and v0 == v1 and claim.xstar[0] == claim.xstar[1]
        self.tree, self.together = claim.tree, claim.together
        self.upper = array("i", [0]) * len(self.tree)       # where a node's upper half begins
        unfinished = []                                     # nodes whose lower half goes on
        for position, node in enumerate(self.tree):
            if node in AXES:
                unfinished.append(position)
            elif unfinished:
                self.upper[unfinished.pop()] = position + 1

    def refusal(self, cell):
        """Why the symmetric leaf may not be skipped, or None if its mirror image is proved."""
        if not self.symmetric:
            return "is skipped, but the problem is not symmetric"
        image = [(index, cuts) for index, cuts in zip(*cell)]
        image[0], image[1] = image[1], image[0]
        if not self.together:
            image[2], image[3] = image[3], image[2]
        todo = [(0, tuple(image))]          # a node, and the image's cell within that node
        while todo:
            position, image = todo.pop()
            node, lower = self.tree[position], position + 1
            if node == "P":
                continue
            axis = AXES.find(node)
            if axis < 0:
                return "is skipped, but its mirror image is not proved"
            halves = lower, self.upper[position]
            index, cuts = image[axis]
            if cuts == 0:                                   # the image has both halves
                todo += [(half, image) for half in halves]
            else:
                rest = index & (1 << cuts - 1) - 1, cuts - 1
                todo.append((halves[index >> cuts - 1], changed(image, axis, rest)))
        return None


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
PARAMETER_ERROR = 32                    # units; see Criterion and its piece


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
        """The sine and cosine of x (units), each within SINE_ERROR units.

        x = n steps + r, r off by 2 units.  In the sum formulas a number of the table is off by
        2 units, one of r by 4 and by 2 more for r, and their factors are a sine and a cosine, of
        sum at most 1.5: less than 1.5 (2 + 6) + 1 units.
        """
        bits = self.bits
        n = (x * self.steps_per_radian >> bits) + (1 << 63) >> 64
        if abs(n) > 1 << 32:            # n times the error of a step must stay below a unit
            raise OverflowError("an angle is too large")
        c, s = self._small(x - (n * self.step >> GUARD), bits, self.divisors)
        sin, cos = self.table[n % SLICES]
        return sin * c + cos * s >> bits, cos * c - sin * s >> bits


# ---- the largest eigenvalue of beta over the torus and the parameters

def largest(p, q, r, one):
    """An upper bound of the largest eigenvalue of [p q; q r]: less than 2 units above it."""
    return (p + r + upper_sqrt((p - r) ** 2 + 4 * q * q) + 1) // 2


def cell_bound(fixed, abc, y, w):
    """An upper bound of the largest eigenvalue of beta over |x - y| <= w, and one at y.

    beta = 2I + sum of m u u', where m = -p sin(u.x), for (p, u) = (a, (1,0)), (b, (0,1)), (c, (1,1)).
    Taylor: m <= m(y) - p cos(u.y) u.d + |p| (u.d)^2 / 2.  The part affine in d has a convex largest
    eigenvalue, so its maximum lies at a corner of the cell; as |u.d| <= w, w, 2w the rest adds at
    most w^2 max(|a|, |b|) / 2 + 4 |c| w^2, the largest eigenvalue of (1,1)(1,1)' being 2.
    """
    bits, size = fixed.bits, max(map(abs, abc))
    waves = [fixed.sincos(angle) for angle in (*y, sum(y))]
    m = [-p * s >> bits for p, (s, _) in zip(abc, waves)]
    g = [-p * c * w >> 2 * bits for p, (_, c) in zip(abc, waves)]

    def eigenvalue(d0, d1):
        m0, m1, m2 = m[0] + g[0] * d0, m[1] + g[1] * d1, m[2] + g[2] * (d0 + d1)
        return largest(2 * fixed.one + m0 + m2, m2, 2 * fixed.one + m1 + m2, fixed.one)

    square = (w * w >> bits) + 1
    bend = (square * (max(abs(abc[0]), abs(abc[1])) + 8 * abs(abc[2])) >> bits + 1) + 1
    # Sines and floors: each m and g d is off by 2 + SINE_ERROR (1 + w) size units at most, and the
    # eigenvalue by 4 times as much (1 for e0e0' and e1e1', 2 for (1,1)(1,1)', 1 to spare).
    slack = 4 * (4 + ((2 * SINE_ERROR * size * (fixed.one + w)) >> 2 * bits) + 1)
    corners = max(eigenvalue(d0, d1) for d0 in (-1, 1) for d1 in (-1, 1))
    return corners + bend + slack, eigenvalue(0, 0) + slack


def torus_bound(fixed, corners):
    """An upper bound B of the largest eigenvalue of beta over the torus and the parameters between
    these corners.

    beta(x) is affine in the parameters and its largest eigenvalue convex: for each x the maximum
    is at one of the corners.  At each, branch and bound over cells that cover the torus,
    until the worst cell is within 2^-20 (relative to the parameters) of a value taken.
    """
    corners = sorted(set(corners))
    tolerance = (fixed.one + max(sum(map(abs, abc)) for abc in corners)) >> 20
    heap, taken, order = [], 0, itertools.count()

    def push(abc, y, w):
        nonlocal taken
        bound, value = cell_bound(fixed, abc, y, w)
        taken = max(taken, value)
        heapq.heappush(heap, (-bound, next(order), abc, y, w))

    for abc in corners:
        push(abc, (0, 0), fixed.pi + 2)
    while -heap[0][0] > taken + tolerance:
        _, _, abc, (y0, y1), w = heapq.heappop(heap)
        w = w + 1 >> 1
        for d0, d1 in itertools.product((-w, w), repeat=2):
            push(abc, (y0 + d0, y1 + d1), w)
    return -heap[0][0]


# ---- orbits: first-order Taylor models
# A piece is a box of (a, b, c, v0, v1): centres and half-widths.  A number that depends on the
# point of the piece is enclosed as centre + sum of column * symbol, each symbol in [-1, 1]: first
# five symbols for the piece (parameters that move together all have the first), two for the rounding
# of x*, then three for the errors of each step.

class Point:
    """x[j] on all orbits of a piece: its centre x, its rows of columns, and models of p sin."""

    __slots__ = ("x", "rows", "waves", "reach", "sines", "beta")

    def __init__(self, fixed, parameters, x, rows):
        self.x, self.rows = x, rows
        row0, row1 = rows
        self.waves = [fixed.sincos(angle) for angle in (*x, sum(x))]
        self.reach = (sum(map(abs, row0)), sum(map(abs, row1)),
                      sum([abs(p + q) for p, q in zip(row0, row1)]))
        self.sines = [model(fixed.bits, *parameter, s, c, rho) for parameter, (s, c), rho
                      in zip(parameters, self.waves, self.reach)]
        s0, s1, s2 = [value / fixed.one for value, _, _, _ in self.sines]
        self.beta = 2 - s0 - s2, -s2, 2 - s1 - s2       # at the centre, in double precision


def model(bits, p, h, f, g, rho):
    """Encloses (p + h e) (f' cos d + g' sin d) for |e| <= 1, |d| <= rho <= 2 and all f', g' within
    SINE_ERROR of f, g, as value + slope e + tilt d + error: these four numbers.

    cos d is in [1 - rho^2/2, 1], and |sin d - d| <= rho^3/6, so f cos d + g sin d is within
    bend = |f| rho^2/4 + |g| rho^3/6 + 2 SINE_ERROR of f (1 - rho^2/4) + g d.  Hence the error
    (|p| + h) bend + h |g| rho; each of value, slope, tilt d and the error loses 1 or 2 units, and
    p + h e is off by PARAMETER_ERROR, which the wave, at most 1, does not enlarge.
    """
    square = (rho * rho >> bits) + 1
    sag = f * square >> bits + 2
    bend = abs(sag) + (abs(g) * square * rho // 6 >> 2 * bits) + 2 * SINE_ERROR + 4
    error = ((abs(p) + h) * bend + ((h * abs(g) >> bits) + 1) * rho >> bits) \
        + PARAMETER_ERROR + 7
    return p * (f - sag) >> bits, h * (f - sag) >> bits, p * g >> bits, error


def step(fixed, parameters, symbols, point, before, known):
    """The point after next: 2 x - before - V'(x).  Time may run either way: the map is reversible.

    -V'(x) is (g0 + g2, g1 + g2) with g = p cos(angle); each g has a new symbol for its error, after
    the known ones.  The floor of each column costs a unit.
    """
    bits = fixed.bits
    (v0, s0, t0, e0), (v1, s1, t1, e1), (v2, s2, t2, e2) = [
        model(bits, *parameter, c, -s, rho) for parameter, (s, c), rho
        in zip(parameters, point.waves, point.reach)]
    m0, m1 = (2 << bits) + t0 + t2, (2 << bits) + t1 + t2
    row0, row1, old0, old1 = [row + [0] * (known - len(row)) for row in point.rows + before.rows]
    new0 = [(m0 * p + t2 * q >> bits) - o for p, q, o in zip(row0, row1, old0)]
    new1 = [(t2 * p + m1 * q >> bits) - o for p, q, o in zip(row0, row1, old1)]
    a, b, c = symbols
    new0[a] += s0
    new0[c] += s2
    new1[b] += s1
    new1[c] += s2
    x = (2 * point.x[0] - before.x[0] + v0 + v2, 2 * point.x[1] - before.x[1] + v1 + v2)
    return Point(fixed, parameters, x, (new0 + [e0 + known, 0, e2], new1 + [0, e1 + known, e2]))


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


def second_variation(fixed, symbols, l, orbit, vectors):
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
        w0, w1, w2 = n0 * n0, n1 * n1, (n0 + n1) ** 2
        (v0, s0, t0, e0), (v1, s1, t1, e1), (v2, s2, t2, e2) = point.sines
        centre += (2 * (w0 + w1) << bits) - w0 * v0 - w1 * v1 - w2 * v2
        error += w0 * e0 + w1 * e1 + w2 * e2
        k0, k1 = w0 * t0 + w2 * t2, w1 * t1 + w2 * t2
        row0, row1 = point.rows
        columns[:len(row0)] = [k - k0 * p - k1 * q for k, p, q in zip(columns, row0, row1)]
        for k, change in zip(symbols, (w0 * s0, w1 * s1, w2 * s2)):
            columns[k] -= change << bits
    return (centre + error << bits) + sum(map(abs, columns)), columns


class Criterion:
    """Everything that does not change from leaf to leaf."""

    def __init__(self, claim):
        narrow = max([h.denominator.bit_length() - h.numerator.bit_length()
                      for h in claim.half if h] + [0])
        bits = max(96, 64 + narrow + claim.counts["most_cuts"])
        if bits > MAX_BITS:
            raise NotConfirmed("numbers of %d bits are needed; the checker's limit is %d"
                               % (bits, MAX_BITS))
        self.fixed = fixed = Fixed(bits)
        self.parameters = [[math.floor(x * fixed.one) for x in claim.centre[:3]],
                           [math.floor(x * fixed.one) for x in claim.half[:3]]]
        if max(map(abs, sum(self.parameters, []))) >> 2 * bits:     # l would have no digit left
            raise NotConfirmed("the parameters are too large for this checker")
        self.together = claim.together
        self.symbols = (0, 0, 0) if claim.together else (0, 1, 2)
        self.xstar = [math.floor(x * fixed.one) for x in claim.xstar]
        # Orbits that differ by 2 pi in x[1] differ by 2 pi j in x[j]: nothing else changes.
        self.region = [(math.floor(c % 2 * fixed.pi), math.floor(h * fixed.pi),
                        4 * math.ceil(h) + 10) for c, h in zip(claim.centre[3:], claim.half[3:])]
        # The ends of the parameters: a cell's B is no larger than what lies between B there.  The
        # eigenvalue grows by at most max(|da|, |db|) + 2 |dc|; an end is off by less than 2 units,
        # and so is a point along its symbol: B is off by less than PARAMETER_ERROR.
        signs = [(s, s, s) for s in (-1, 1)] if claim.together else \
            list(itertools.product((-1, 1), repeat=3))
        corners = [tuple(c + s * h for c, h, s in zip(*self.parameters, sign)) for sign in signs]
        apart = [[x] for x in corners] if set("234") & set(claim.tree) else [corners]
        self.B_at = [torus_bound(fixed, ends) + PARAMETER_ERROR for ends in apart]
        self.B = max(self.B_at)
        if self.B <= 2 * fixed.one:
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
        """The cell as a box that covers it: centres and half-widths of a, b, c, v0 and v1.

        An angle: the centre c + h (2i + 1 - 2^k) / 2^k and the half-width h / 2^k, in units of pi:
        pi is off by 2 units and c mod 2 below 2, so with the floors 4 h + 10 units are enough.
        A parameter is followed along its symbol to within 5 units (four floors, one of them of a
        number that is doubled), and each halving of the piece may add one: PARAMETER_ERROR.
        """
        index, cuts = cell
        centre, half = [], []
        for n, (c, h) in enumerate(zip(*self.parameters)):
            axis = 2 if self.together else 2 + n
            i, k = index[axis], cuts[axis]
            centre.append(c + (h * (2 * i + 1 - (1 << k)) >> k))
            half.append(h >> k)
        for (c, h, e), i, k in zip(self.region, index, cuts):
            centre.append(c + (h * (2 * i + 1 - (1 << k)) >> k))
            half.append((h >> k) + e)
        return centre, half

    def attempt(self, l, piece):
        """Is (3) true of the whole piece?  None if so, or else why not, and where to halve it."""
        try:
            return self._follow(l, *piece)
        except (OverflowError, ValueError, ZeroDivisionError):
            # An angle or a double too large, a singular pivot, a NaN: no bound was established,
            # and an attempt that establishes none excludes nothing.
            return "the arithmetic failed", piece[1]

    def _follow(self, l, centre, half):
        """Lengthens the orbit at the end that is better known until (3) is true or all is lost.

        (3) is tried each time the orbit has grown by a twelfth, and in the end.  How far the angle
        of a wave that is not there moves is of no interest.
        """
        fixed, symbols, parameters = self.fixed, self.symbols, list(zip(centre[:3], half[:3]))
        waves = [k for k, parameter in enumerate(parameters) if any(parameter)]
        why, columns, known = None, half, 7
        orbit = collections.deque()
        point = Point(fixed, parameters, self.xstar, ([0] * 5 + [1, 0], [0] * 5 + [0, 1]))
        ahead, due = True, 1

        def reach(point):
            return max([point.reach[k] for k in waves] or [0])

        while point:
            (orbit.append if ahead else orbit.appendleft)(point)
            if len(orbit) == 1:
                point = Point(fixed, parameters, centre[3:], ([0, 0, 0, half[3], 0, 0, 0],
                                                              [0, 0, 0, 0, half[4], 0, 0]))
            else:
                ahead = reach(orbit[-1]) < reach(orbit[0])
                ends = (orbit[-1], orbit[-2]) if ahead else (orbit[0], orbit[1])
                point = step(fixed, parameters, symbols, *ends, known)
                known += 3
            if reach(point) > fixed.one or len(orbit) == MAX_POINTS:
                point = None
            if point and len(orbit) < due:
                continue
            due = len(orbit) + 1 + len(orbit) // 12
            vectors = witness([point.beta for point in orbit], l / fixed.one)
            if vectors:
                bound, columns = second_variation(fixed, symbols, l, orbit, vectors)
                if bound < 0:
                    return None
                why = "its second variation may be positive"
        return why or "the orbit of its centre contradicts nothing over %d points, %s" % (
            len(orbit), "the most that are followed" if len(orbit) == MAX_POINTS else
            "beyond which it is too uncertain"), columns

    def halves(self, centre, half, columns):
        """The halves of a piece along the symbol that matters most: of an angle or a parameter, or
        of all three parameters where they move together, since they have one symbol."""
        worst = max(range(5), key=lambda k: abs(columns[k]))
        axes = {0, 1, 2} if self.together and worst < 3 else {worst}
        step = [h + 1 >> 1 if k in axes else 0 for k, h in enumerate(half)]
        half = [s if k in axes else h for k, (h, s) in enumerate(zip(half, step))]
        return [([c + sign * s for c, s in zip(centre, step)], half) for sign in (1, -1)]

    def excluded(self, cell):
        """Does no minimizing orbit go from x* to the cell?  (None or else why not, pieces tried)"""
        l, todo, pieces = self.least_pivot(cell), [(*self.piece(cell), 0)], 0
        while todo:
            centre, half, halvings = todo.pop()
            pieces += 1
            failed = self.attempt(l, (centre, half))
            if not failed:
                continue
            if halvings == MAX_HALVINGS or pieces + len(todo) >= MAX_PIECES:
                return "%s (piece %d, halved %d times)" % (failed[0], pieces, halvings), pieces
            todo += [(*piece, halvings + 1) for piece in self.halves(centre, half, failed[1])]
        return None, pieces

    def at_once(self):
        """Is B > 10/3 for all parameters of the box, or where they move together, at the upper end?

        V is odd, so the least eigenvalue of beta over the torus is 4 - B; where it is attained,
        (3) with that point and its eigenvector alone is 4 - B - 2l < 0, that is B > 10/3; and B - 2
        grows in proportion with the parameters.  So it is enough that n.beta(x)n < 2/3 |n|^2 for
        some x and n: found on a grid in double precision, and then bounded for all parameters.
        """
        one = self.fixed.one
        centre, half = self.parameters
        if self.together:
            centre, half = [c + h for c, h in zip(centre, half)], [0, 0, 0]
        half = [h + PARAMETER_ERROR for h in half]
        a, b, c = [x / one for x in centre]

        def beta(x):
            s0, s1, s2 = math.sin(x[0]), math.sin(x[1]), math.sin(sum(x))
            return 2 - a * s0 - c * s2, -c * s2, 2 - b * s1 - c * s2

        grid = [math.pi * k / 32 for k in range(64)]
        x = min(itertools.product(grid, repeat=2), key=lambda x: least(beta(x))[0])
        for width in (2.0 ** -k for k in range(4, 20)):
            x = min(itertools.product(*((y - width, y, y + width) for y in x)),
                    key=lambda x: least(beta(x))[0])
        n0, n1 = [round(u * 2 ** NU_BITS) for u in least(beta(x))[1]]
        x = [math.floor(y * one) for y in x]
        total = 4 * (n0 * n0 + n1 * n1) * one               # three times 2 |n|^2 - 2/3 |n|^2
        for p, h, y, w in zip(centre, half, (*x, sum(x)), (n0 * n0, n1 * n1, (n0 + n1) ** 2)):
            sine, _ = self.fixed.sincos(y)
            total -= 3 * w * ((p * sine - h * abs(sine) - (abs(p) + h) * SINE_ERROR) // one)
        return total < 0

    def not_at_once(self):
        """Is B <= 10/3 for some parameters of the box, or where they move together, at their end?

        Those nearest to 0 are tried.  They are known to within 2 units, as in __init__.
        """
        nearest = [c + h if self.together else max(c - h, min(c + h, 0))
                   for c, h in zip(*self.parameters)]
        return 3 * (torus_bound(self.fixed, [tuple(nearest)]) + PARAMETER_ERROR) \
            <= 10 * self.fixed.one


# ---- the fast path: a thousand prisms in lockstep, in doubles
# The same left side of (3), bounded by other means, far more cheaply and more sharply: a polynomial
# of third order in the symbols, and what it leaves.  What is not bounded below zero here is left to
# the exact path.  All that is done to one prism is done to all of them, as arrays of numpy, whose
# operations are rounded to nearest (sound() looks).
#
# A prism is the set of orbits with x[0] = x*, x[1] in a rectangle, and p'_w = P_w + H_w e + v,
# |v| <= W_w, for the waves w = 0, 1, 2 with u = (1,0), (0,1), (1,1); e in [-1, 1] is a symbol of
# the parameter.  A lane is one half of its orbits, ahead x[1], x[2], ..., or back x[0], x[-1], ...;
# the map is reversible, so both are followed by the same steps, from o = x[0], q = x[1] or from
# o = x[1], q = x[0].  A site of a lane has X, in turns (so whole turns are taken off without any
# error), and a true orbit is there, modulo 2 pi and in radians,
#       2 pi X + D,    D = L e + r,    |r| <= rest,
# for the symbols e in the cube.  Of a wave at a site: y = 2 pi u.X, z = u.D, xi = u.L e and z = xi
# + w; |xi| <= size, |w| <= rest, |z| <= reach = size + rest.  s, c and p sin, p cos below are those
# at X and P.
#
# Orbits.  Let o, q, + be successive sites, M and d any matrices, and f[q] = r[+] - d[q] r[q].  As
# r[+] = beta r[q] - r[o] + err, and r[q] = d[o] r[o] + f[o],
#       f[q] = M f[o] + err + (beta - M - d[q]) r[q] - (I - M d[o]) r[o].
# With M near 1/d[o] and d[q] = beta - M the brackets are roundings, so that r grows like the orbits
# and not like products of norms, in a frame in which beta is nearly diagonal: where c counts, near
# x0 = x1 above all, this is the frame of x0 + x1 and x0 - x1, in which beta is
#       ((b00 + b11)/2 + b01, (b00 - b11)/2; the same, (b00 + b11)/2 - b01),
# symmetric, too.  A wave acts on x0 + x1 and x0 - x1 as 1, 1; or 1, -1; or 2, 0.
# xi^2 lies between 0 and size^2, so the bow of the orbits, -p cos y xi^2/2, is half of its extent
# about its mean: X[+] is 2X - X[o] + the sum of u P cos y (1 - size^2/4).  err is then (i) how far
# X[+] is from this; (ii) how far L[+] is from beta L[q] - L[o] and H cos y in the parameters'
# columns; and (iii) for each wave, bending(),
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
# E = sum of u P cos y size^2/4, but for (i).  n is the same for all orbits of the prism.  With
# omega = (n.u)^2 and m = u.mu, affine, too, a wave has in this sum  p'(A cos z + B sin z),
#       A = A0 + alpha = m cos y - omega sin y,    B = B0 + beta' = -omega cos y - m sin y,
# alpha and beta' being what is linear in e.  D is multiplied, in all, with
#       G = 2 mu[j] - mu[j-1] - mu[j+1] + sum of u (P B0 + P beta' - P A0 xi + H e B0),
# affine in e; what a wave has besides this, which is z times its part of the last sum, is
#       P (A0 + alpha) + H e (A0 + alpha)                                                     (4)
#       + P A0 xi^2/2 - P alpha xi^2/2 - P B0 xi^3/6 + H e (beta' xi - A0 xi^2/2)
# and a remainder.  For A0 (cos z + xi z) is A0 (1 + xi^2/2 - w^2/2 + (cos z - 1 + z^2/2)), with the
# last bracket between 0 and z^4/24; alpha cos z is alpha (1 - xi^2/2 - w (z + xi)/2) and at most
# |alpha| z^4/24; B0 (sin z - z) is -B0 xi^3/6, as far as z^3 - xi^3 = w (z^2 + z xi + xi^2), and at
# most |B0| |z|^5/120; beta' (sin z - z) is at most |beta'| |z|^3/6; and with H e stands A cos z +
# B sin z - B0 z, where alike A0 (cos z - 1 + xi^2/2), alpha (cos z - 1), B0 (sin z - z) and beta'
# (sin z - xi) are left.  So the remainder, remainder(), is at most
#       |P| (|alpha| (far + reach^4/24) + |beta'| reach^3/6
#            + |B0| (rest (reach^2 + reach size + size^2)/6 + reach^5/120))
#       + max(0, P A0) reach^4/24 + max(0, -P A0) rest^2/2
#       + H (|A0| (far + reach^4/24) + |alpha| reach^2/2 + |B0| reach^3/6
#            + |beta'| (rest + reach^3/6)) + W (|m| + omega),      far = rest (reach + size)/2.
# That is why mu is affine: all this is of fourth order, though r, of second order, is only bounded.
# From a lane's last site inwards the next mu is the one that makes G vanish, but for its rounding;
# at x[1] and x[0], where both lanes meet, G D is G times the sides of the rectangle, a polynomial,
# and the rounding of x*.  So the sum is a polynomial of third order in the symbols, its
# coefficients added up with their signs over all sites, and small things; summit() bounds it over
# the cube.
#
# Roundings.  u = 2^-53.  Which numbers X, P, H, L, d, M, n, mu, E and size are does not matter, but
# what bounds something must.  (S_i = |P_i| + |P_2|, for the coordinates i.)
#   sine, cosine: SINE is 16 u, see lockstep_sincos.  In (iii) 2 SINE with |cos y|, as E has the
#       computed one.
#   beta: products P s are off by 18 u |P|; the entries by u (2 + 20 S_i) < F_i / 2 and, beside the
#       diagonal, by 18 u |P_2| < F_2 / 2, where F_i = 64 u (1 + S_i), F_2 = 64 u |P_2|.  In the
#       other frame by (F_0 + F_1)/4 + F_2/2 and 6 u (2 + S_0 + S_1): less than F_0 + F_1.
#   (i): in turns 3 u for the sums of |2X - X| <= 1.5 and 25 u |P| / 2 pi for each wave; in radians
#       u (19 + 25 S_i), and 4 u S_i / 4 for E: less than F_i.  The rest of F_i, 38 u, is for
#       whatever is lost below 2^-1022.
#   (ii): F_i / 2 + 4 u (2 + S_i) < F_i of |L_i|, F_2 of the other, 4 u of |L[o]|, 32 u of H.
#   beta - M - d: F + 2 u |M|.   I - M d: with inv = 1 / det, each rounded, at most 5 u |inv| (|d00
#       d11| + d01^2) on the diagonal, as the determinant is off by 2.1 u of these products, the
#       quotient by u, M d by u of each product; and 2 u |inv d01| (|d00| + |d11|) beside it.
#   sums of positive terms: MORE = 1 + 2^-40 for a hundred roundings one after the other, and 64 u
#       more for each site.
#   omega is off by 3 u, m by u, A and B by 24 u weight, weight = |m_0| + sum of |m_k| + omega.
#       That u.L is a rounded sum for w = 2 goes into rest.
#   G: 28 u of weight (|P| (1 + size) + H) for each wave, 3 u of 2 |mu| and the |mu| before; at x[1]
#       and x[0] u more, u of the mu of the other lane, and of products and sums: 48 u.
#   (i) again: |mu| F.
#   mass is the sum of 2|n|^2 + |P| omega, and 2|n.n'| over neighbours is no more; and of weight
#       (|P| reach^2 + 3 H).  A term of a coefficient is off by 40 u of its size, and these sizes
#       are in all at most mass, as reach <= 1: 2|n|^2 + |P| omega; with weight |P| size^2/4 (mu.E),
#       size^2/2, size^3/6; with weight H 1, size^2/2, size.  In the remainder A and B have factors
#       of less than 2.3 |P| reach^2 + 3 H in all: 56 u.  Sums over K sites of each lane have at
#       most 4K terms one after the other: 4 K u; to join them by monomials, 16 u.
#   in summit, of each coefficient: 64 u.
# Masses are at least 1, as one n is a unit vector but for rounding, and below HUGE: so 64 u mass is
# more than all underflows.  A NaN is not below zero, and proves nothing.

np = None                               # numpy, once the fast path is wanted
UNIT = 2.0 ** -53
TWO_PI = 2 * math.pi                    # off by 0.35 u of itself
SINES = [(-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1)]
COSINES = [(-1) ** k / math.factorial(2 * k) for k in range(8, 1, -1)]
SINE, GRAIN, MORE, HUGE = 16 * UNIT, 64 * UNIT, 1 + 2.0 ** -40, 2.0 ** 900
XSTAR_REST = 2.0 ** -51                 # of x*, in radians; see Lockstep
TINY = 2.0 ** -200
FAST_SIZE = 2.0 ** 10                   # of parameters, x* and regions
FAST_CUTS = 52                          # of an axis
BATCH, SMALLEST_BATCH = 1024, 16
FAST_SITES, ROOM = 4096, 1 << 19        # of a lane; of all lanes at a time
FIRST_TRY = 96                          # sites, for lanes that are longer
FARTHEST = 1.0                          # reach of a wave that is there
CAUTION = 0.2, 0.2, 1.0                 # of the choice of n: see witnesses, settle


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
    """Sines and cosines of the three waves at 2 pi turns, |turns| <= 1/2: each within SINE.

    turns - n/4 is exact (Sterbenz) and at most 1/8; the angle is off by 1.4 u of itself.  Taylor's
    polynomials are off by less than u/50.  sine: 0.8 u for the angle, 0.6 u for what is added to
    it, at most 0.081, 0.8 u for the sum; cosine: 0.8 u, 0.4 u for the square's half, 0.1 u for the
    rest, 0.4 u and u for the sums: 4 u each, and by the sum formulas 4 u 2 sqrt 2 + 3 u < 16 u.
    """
    n = np.rint(4 * turns)
    angle = (turns - 0.25 * n) * TWO_PI
    square = angle * angle
    sine, cosine = SINES[0] * square, COSINES[0] * square
    for a in SINES[1:]:
        sine = (sine + a) * square
    for a in COSINES[1:-1]:
        cosine = (cosine + a) * square
    sine = angle + angle * sine
    cosine = 1 - (0.5 * square - square * square * (cosine + COSINES[-1]))
    quadrant = n.astype(np.int64)
    odd = (quadrant & 1) == 1
    s0, s1 = np.where(odd, cosine, sine) * (1 - (quadrant & 2))
    c0, c1 = np.where(odd, sine, cosine) * (1 - (quadrant + 1 & 2))
    return np.stack((s0, s1, s0 * c1 + c0 * s1)), np.stack((c0, c1, c0 * c1 - s0 * s1))


def matrices(w):
    """The sum of w u u' over the three waves, as the entries 00, 01, 11."""
    return np.stack((w[0] + w[2], w[2], w[1] + w[2]))


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

    def __init__(self, box, symbols, xstar, l, caution=CAUTION[0]):
        """The box: P, H and W of the waves, X[1] in turns and half the sides of the rectangle in
        radians; where (symbols) each wave's parameter has its symbol, if it has any; l; and how
        much the choice of n shies at sites that are not well known."""
        P, H, W, x, sides = box
        self.size, self.symbols = x.shape[1], symbols
        self.P, self.H, self.W = self.both(P, P), self.both(H, H), self.both(W, W)
        self.magnitude, self.l = np.abs(self.P), self.both(l, l)
        self.caution = self.both(caution + 0 * l, caution + 0 * l)
        self.present = [w for w in range(3) if (P[w] != 0).any() or W[w].any()]
        mean = self.magnitude.mean(axis=1)
        self.turned = bool(4 * mean[2] > mean[0] + mean[1])     # the frame of rests; any is right
        self.F = GRAIN * (1 + self.magnitude[:2] + self.magnitude[2])
        self.angles = 1 + max([k for k in symbols if k is not None] + [-1])     # their first symbol
        self.known = self.angles + 2
        start = np.repeat(np.array(xstar)[:, None], self.size, axis=1)
        columns, none = np.zeros((2, self.known, self.size)), np.zeros_like(x)
        for i in (0, 1):
            columns[i, self.angles + i] = sides[i]
        blank, rounding = np.zeros_like(columns), np.full_like(x, XSTAR_REST)
        self.sides, self.rounding = self.both(sides, none), self.both(none, rounding)
        rounding = rounding * (1 + self.turned)                 # of x0 + x1 and of x0 - x1
        self.before = self.both(start, x), self.both(blank, columns), self.both(rounding, none)
        self.first = self.both(x, start), self.both(columns, blank), self.both(none, rounding)
        self.sites = []

    @staticmethod
    def both(ahead, back):
        return np.concatenate((ahead, back), axis=-1)

    def other(self, lanes):
        return np.roll(lanes, self.size, axis=-1)

    def joined(self, lanes):
        return lanes[..., :self.size] + lanes[..., self.size:]

    def follow(self):
        """Follows all lanes until each reaches too far, and yields True then and wherever an orbit
        may be long enough; False if there is no room for more.

        A lane that has come to its end stays as zeros, alive no more, and nothing is said of it.
        """
        P, H, W, F = self.P, self.H, self.W, self.F
        slope, F2, from_H = P / TWO_PI, GRAIN * self.magnitude[2], 32 * UNIT * (H[:2] + H[2])
        along, beside = (F[0] + F[1],) * 2 if self.turned else (F, F2)      # of the frame's beta
        (X0, L0, r0), (X, L, r) = self.before, self.first
        size0 = np.abs(L0).sum(axis=1)
        alive, d, f, due = np.ones(X.shape[1], bool), None, None, FIRST_TRY
        while True:
            columns = np.concatenate((L, (L[0] + L[1])[None]))
            size = np.abs(columns).sum(axis=1) * MORE
            total = r[0] + r[1]
            rest = np.stack((total / 2, total / 2, r[0]) if self.turned else (r[0], r[1], total))
            rest[2] += 2 * UNIT * size[2]
            rest *= MORE
            reach = (size + rest) * MORE
            if not self.sites:                      # how far each symbol moves a lane's last site
                self.last = np.abs(columns[self.present]).sum(axis=0)
            for w in self.present:
                alive = alive & (reach[w] <= FARTHEST)
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
            np.copyto(self.last, np.abs(columns[self.present]).sum(axis=0), where=alive)
            s, c = lockstep_sincos(X)
            beta = -matrices(P * s)
            beta[::2] += 2
            bow = size * size / 4
            wave = P * c * bow
            self.sites.append((alive, s, c, columns, size, rest, reach, beta, wave[:2] + wave[2]))

            wave = slope * c * (1 - bow)
            X, X0 = 2 * X - X0 + (wave[:2] + wave[2]), X
            X -= np.rint(X)
            new = applied(beta[:, None], L) - L0
            wave = H * c
            for w, k in enumerate(self.symbols):
                if k is not None:
                    for i in ((0,), (1,), (0, 1))[w]:
                        new[i, k] += wave[w]
            bent = bending(P, H, W, np.abs(s) + SINE, np.abs(c) + 2 * SINE, size, rest, reach)
            err = F * (1 + size[:2]) + F2 * size[1::-1] + 4 * UNIT * size0[:2] + from_H
            if self.turned:
                mean, half = (beta[0] + beta[2]) / 2, (beta[0] - beta[2]) / 2
                both = bent[0] + bent[1]
                err = np.stack((both + 2 * bent[2], both)) + (err[0] + err[1])
                block = np.stack((mean + beta[1], half, mean - beta[1]))
            else:
                err, block = bent[:2] + bent[2] + err, beta
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
        sites, none = self.sites, np.zeros_like(self.l)
        blocks, tail = [], np.stack((self.l, none, self.l))
        for *_, reach, beta, _ in sites:
            more = self.caution * reach * reach
            blocks.append(beta + matrices((self.magnitude + self.H) * more))
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
        K, l, F, known = len(self.sites), self.l, self.F, self.known
        n, tails = self.witnesses()
        P, H, W, magnitude = self.P, self.H, self.W, self.magnitude
        pairs = [(i, j) for i in range(known) for j in range(i, known)]
        value, mass, error = np.zeros_like(l), np.zeros_like(l), np.zeros_like(l)
        linear, square = np.zeros((known, l.size)), np.zeros((len(pairs), l.size))
        cubic = np.zeros((known, *square.shape))    # of e[i] and of a pair
        mixed = np.zeros((self.angles, known, l.size))      # of e[i] and a parameter's symbol
        skew = np.zeros((self.angles, known, known, l.size))
        mu = mu1 = np.zeros((2, 1 + known, l.size))     # of this site, and of the one beyond
        n1 = np.zeros((2, l.size))
        for k in range(K - 1, -1, -1):
            _, s, c, columns, size, rest, reach, _, E = self.sites[k]
            n0 = n[k]
            omega = np.stack((n0[0] * n0[0], n0[1] * n0[1], (n0[0] + n0[1]) ** 2))
            long = omega[0] + omega[1]
            wave = P * omega * s
            value += 2 * long - (wave[0] + wave[1] + wave[2]) - l * tails[k] * long \
                - 2 * (n0[0] * n1[0] + n0[1] * n1[1]) + (mu[0, 0] * E[0] + mu[1, 0] * E[1])
            linear += mu[0, 1:] * E[0] + mu[1, 1:] * E[1]
            m = np.concatenate((mu, (mu[0] + mu[1])[None]))
            A, B = m * c[:, None], -m * s[:, None]
            A[:, 0] -= omega * s
            B[:, 0] -= omega * c
            A0, B0, alpha, beta = A[:, 0], B[:, 0], A[:, 1:], B[:, 1:]
            turn, PA = P[:, None] * B, P * A0
            turn[:, 1:] -= PA[:, None] * columns
            for w in self.present:
                xi, symbol = columns[w], self.symbols[w]
                first = (P[w] / -2) * alpha[w] - (P[w] * B0[w] / 6) * xi    # what stands with xi^2
                if symbol is not None:
                    H_A = H[w] * A0[w]
                    first[symbol] -= H_A / 2
                    linear[symbol] += H_A
                    mixed[symbol] += H[w] * alpha[w]
                    skew[symbol] += (H[w] * beta[w])[:, None] * xi
                    turn[w, 1 + symbol] += H[w] * B0[w]
                xi = products(xi)
                square += (PA[w] / 2) * xi
                cubic += first[:, None] * xi
            weight = np.abs(m).sum(axis=1) + omega
            wave = remainder(P, H, W, A0, np.abs(alpha).sum(axis=1), B0, np.abs(beta).sum(axis=1),
                             weight, size, rest, reach)
            error += wave[0] + wave[1] + wave[2]
            wave = magnitude * omega + weight * (magnitude * reach * reach + 3 * H)
            mass += 2 * long + (wave[0] + wave[1] + wave[2])

            G = 2 * mu - mu1 + (turn[:2] + turn[2])
            wave, most = weight * (magnitude * (1 + size) + H), np.abs(mu).sum(axis=1)
            turn = wave[:2] + wave[2] + 2 * most + np.abs(mu1).sum(axis=1)
            if k:
                small = most * F + 48 * UNIT * turn * reach[:2]
                mu, mu1, n1 = G, mu, n0
            else:
                across = self.other(mu)
                G, turn = G - across, turn + np.abs(across).sum(axis=1)
                small = most * F + np.abs(G).sum(axis=1) * self.rounding \
                    + 48 * UNIT * turn * (self.sides + self.rounding)
                ends = G * self.sides[:, None]
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
        error = (error + UNIT * ((4 * K + 192) * mass + 64 * added)) * (MORE + 64 * UNIT * K)
        return value, form, np.where(mass < HUGE, error, math.inf)

    def bound(self):
        """An upper bound of the left side of (3) for each prism; and what each symbol adds to it,
        about, which says where to cut."""
        value, form, error = self.expand()
        share = self.joined(self.last) + TINY
        share = share / share.sum(axis=0)
        moved = np.stack([sum([np.abs(x) for key, x in form.items() if k in key])
                          for k in range(self.known)])
        return value + (summit(form) + error), np.where(value < 0, moved + error * share, share)


class Lockstep:
    """The fast path of one claim."""

    def __init__(self, claim, criterion):
        """What all prisms share; ValueError if the claim has numbers that it is not made for.

        x* in turns is off by 2^-54 of its rounding and by 2^-80 of the integers, less than
        XSTAR_REST / 2 pi.
        """
        self.together = claim.together
        self.centre = [float(x) for x in claim.centre[:3]] + [float(v / 2 % 1)
                                                              for v in claim.centre[3:]]
        self.half = [float(x) for x in claim.half[:3]] + [float(v / 2) for v in claim.half[3:]]
        if max(map(abs, (*self.centre, *self.half, *claim.xstar))) > FAST_SIZE:
            raise ValueError("too large for the fast path")
        self.axes = [2] * any(claim.half[:3]) if claim.together else \
            [2 + w for w in range(3) if claim.half[w]]
        where = [2 if claim.together else 2 + w for w in range(3)]
        self.symbols = [self.axes.index(k) if k in self.axes else None for k in where]
        self.axes += [0, 1]                         # of the symbols
        self.present = [w for w in range(3) if claim.centre[w] or claim.half[w]]
        if not self.present:
            raise ValueError("no wave: orbits without end")
        half_turn = Fraction(1, 2)
        self.xstar = [float((Fraction(x, 2 * criterion.fixed.pi) + half_turn) % 1 - half_turn)
                      for x in criterion.xstar]
        self.batch = BATCH

    def box(self, index, cuts):
        """Boxes that cover these cells, as Prisms takes them.

        at and part are exact.  The doubles near centre c and half-width h are off by u of them, the
        products and sums by u of theirs: all in all by less than 8 u (c + h).
        """
        part = np.ldexp(1.0, -cuts.astype(np.intc))
        at = (2 * index + 1 - (1 << cuts)) * part
        P, H, W = np.zeros((3, 3, at.shape[1]))
        for w in self.present:
            axis, c, h = 2 if self.together else 2 + w, self.centre[w], self.half[w]
            P[w], H[w] = c + h * at[axis], h * part[axis]
            W[w] = 8 * UNIT * (abs(c) + h) + TINY
        X, sides = np.empty((2, 2, at.shape[1]))
        for i in (0, 1):
            c, h = self.centre[3 + i], self.half[3 + i]
            X[i] = c + h * at[i]
            sides[i] = TWO_PI * MORE * (h * part[i] + (8 * UNIT * (c + h) + TINY))
        return P, H, W, X - np.rint(X), sides

    def attempt(self, index, cuts, l, caution):
        """Is (3) true of all orbits of these cells?  For each, and the axis to cut it along, -1 if
        that seems vain; None if their orbits are too long for so many at a time."""
        with np.errstate(all="ignore"):
            prisms = Prisms(self.box(index, cuts), self.symbols, self.xstar, l, caution)
            excluded = np.zeros(l.shape, bool)
            for ready in prisms.follow():
                if not ready:
                    return None
                bound, blame = prisms.bound()
                excluded |= bound < 0
                if excluded.all():
                    break
        vain = prisms.joined(prisms.sites[-1][0]) & (len(prisms.sites) == FAST_SITES)
        return excluded, np.where(vain, -1, np.array(self.axes)[blame.argmax(axis=0)])

    def settle(self, cells, least, exactly):
        """Decides on cells with these l: (number of the first that is not excluded, why not) or
        None, and how many pieces each took.

        Those that fail are halved and tried again, up to the checker's limits and with n chosen
        boldly and cautiously in turn; what fails then, exactly(number) -> (None or why not,
        pieces) decides on.
        """
        depth = np.array([sum(cuts) for _, cuts in cells])
        pieces, refused = np.zeros(len(cells), int), None
        fine = [n for n, (_, cuts) in enumerate(cells) if max(cuts) > FAST_CUTS]
        rest = [n for n, (_, cuts) in enumerate(cells) if max(cuts) <= FAST_CUTS][::-1]
        index, cuts = [np.array([cells[n][part] for n in rest], np.int64).reshape(-1, 5).T
                       for part in (0, 1)]
        todo = [index, cuts, np.array([least[n] for n in rest]), np.array(rest, int)]
        while fine or todo[3].size:
            for n in fine:
                if refused is None or n < refused[0]:
                    why, tried = exactly(n)
                    pieces[n] += tried
                    refused = (n, why) if why else refused
            keep = ~np.isin(todo[3], fine) & (todo[3] < (refused[0] if refused else len(cells)))
            todo, fine = [x[..., keep] for x in todo], []
            if not keep.any():
                break
            index, cuts, l, number = [x[..., -self.batch:] for x in todo]
            halvings = cuts.sum(axis=0) - depth[number]
            tried = self.attempt(index, cuts, l, np.array(CAUTION)[halvings % len(CAUTION)])
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
            index, cuts, l, number, axis = [x[..., ~excluded].repeat(2, axis=-1)
                                            for x in (index, cuts, l, number, axis)]
            at = np.arange(axis.size)
            index[axis, at] = 2 * index[axis, at] + at % 2
            cuts[axis, at] += 1
            todo = [np.concatenate(both, axis=-1) for both in zip(todo, (index, cuts, l, number))]
        return refused, pieces.tolist()


def lockstep(claim, criterion):
    """The fast path, or None: it is not made for the claim's numbers, or, as a line then says, it
    has not the machine it needs."""
    try:
        if sound():
            return Lockstep(claim, criterion)
        why = "numpy does not round as it must"
    except ImportError:
        why = "numpy is not installed"
    except ValueError:
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

    def __init__(self, path, claim):
        self.confirmed = self.pieces = 0
        self.path, self.sha256, self.saved = path and os.path.realpath(path), claim.sha256, 0
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
                or found[0] > claim.tree.count("P") and words[0] == claim.sha256:
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

_worker = []                            # in each process: its Criterion
SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
           if hasattr(signal, name)]


def cost(cell):
    """About what it takes to confirm a leaf: orbits are as long as their leaves are deep, and the
    work grows with the square of their length."""
    return 1 + sum(cell[1]) ** 2


def check_chunk(chunk):
    """Checks leaves in order: (how many are confirmed, their cost and pieces, what then fails)."""
    criterion, = _worker
    cells, refused, pieces = [cell for _, cell in chunk], None, []
    if criterion.fast:
        refused, pieces = criterion.fast.settle(
            cells, [criterion.least_in_double(cell) for cell in cells],
            lambda n: criterion.excluded(cells[n]))
    else:
        for n, cell in enumerate(cells):
            why, tried = criterion.excluded(cell)
            if why:
                refused = n, why
                break
            pieces.append(tried)
    n = refused[0] if refused else len(cells)
    return n, sum(map(cost, cells[:n])), sum(pieces[:n]), refused and (*chunk[n], refused[1])


@contextlib.contextmanager
def undisturbed():
    """Signals wait, also in a process that is begun meanwhile."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def begin_apart(criterion, stop):
    """Starts a worker process.  Signals are for the parent to notice; a worker ends when its parent
    says so, or has died."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    _worker[:] = [criterion]
    if criterion.fast:
        sound()
    threading.Thread(target=end_with_parent, args=(stop,), daemon=True).start()


def end_with_parent(stop):
    import multiprocessing.connection
    multiprocessing.connection.wait([stop, multiprocessing.parent_process().sentinel])
    os._exit(1)


def in_order(chunks, jobs, criterion):
    """Yields the results of the chunks in their order, few of them being in memory at a time."""
    if jobs == 1:
        _worker[:] = [criterion]
        yield from map(check_chunk, chunks)
        return
    import concurrent.futures.process       # where there are no processes, one job still works
    import multiprocessing
    stop, stopper = multiprocessing.Pipe(duplex=False)
    pool = concurrent.futures.ProcessPoolExecutor(jobs, initializer=begin_apart,
                                                  initargs=(criterion, stop))
    waiting, over = collections.deque(), False
    try:
        for chunk in chunks:
            with undisturbed():
                waiting.append(pool.submit(check_chunk, chunk))
            if len(waiting) > 4 * jobs:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
        over = True
    except concurrent.futures.process.BrokenProcessPool:
        raise Unusable("a worker process died; nothing was verified") from None
    finally:
        if not over:                        # what the workers still do is of no use to anybody
            stopper.send_bytes(b"stop")
        pool.shutdown(cancel_futures=True)
        stop.close()
        stopper.close()


@dataclass(frozen=True)
class Result:
    """What came of a check in which nothing failed: true only if the whole claim is verified and
    its region is the whole torus.  (All else ends in an exception.)"""

    status: int                         # VERIFIED, PART or SPOT_CHECK: the exit status, too
    verdict: str                        # "verified", "verified in part" or "spot check"
    text: str                           # the report

    def __bool__(self):
        return self.status == VERIFIED


def verify(path, jobs=1, sample=None, state=None, bar=False, exact=False):
    """Verifies a proof file: returns a Result, or raises Rejected, NotConfirmed or Unusable.

    jobs: processes.  sample: so many leaves only, chosen by chance: a spot check.
    state: a file that remembers what was confirmed, so that an interrupted check can go on; it
    is kept in the end.  bar: show the progress on stderr, if that is a terminal.  exact: in
    integers alone, as where there is no numpy.
    """
    if jobs < 1 or sample is not None and sample < 1:
        raise ValueError("jobs and sample are 1 or more")
    if sample is not None and state is not None:
        raise Unusable("a spot check keeps no state; give --sample or --state")
    claim = read(path)
    check_tree(claim)
    check_mirror_images(claim)
    criterion = Criterion(claim)
    if claim.at_once and not criterion.at_once():
        if criterion.not_at_once():
            raise Rejected("larger parameters are not excluded at once: B <= 10/3 for some")
        raise NotConfirmed("that larger parameters are excluded at once (B > 10/3)")
    if not exact:
        criterion.fast = lockstep(claim, criterion)
    done = State(state, claim)
    earlier, proved = done.confirmed, claim.tree.count("P")
    chosen = range(earlier, proved)
    if sample is not None:
        chosen = set(random.SystemRandom().sample(chosen, min(sample, proved)))

    def work():
        cells = (cell for position, cell in leaves(claim.tree) if claim.tree[position] == "P")
        return ((n, cell) for n, cell in enumerate(cells) if n in chosen)

    queue = work()
    size = CHUNK
    if criterion.fast:
        fewest, most = FAST_CHUNK
        size = min(max(len(chosen) // (CHUNKS * jobs), fewest), most)
    chunks = iter(lambda: list(itertools.islice(queue, size)), [])
    try:
        with Bar(work() if bar else (), len(chosen)) as progress, \
                contextlib.closing(in_order(chunks, jobs, criterion)) as results:
            for n, spent, pieces, failure in results:
                done.advance(n, pieces)
                progress.advance(n, spent)
                if failure:
                    *leaf, why = failure
                    raise NotConfirmed(
                        "%s is not excluded: %s; the claim is false or its proof beyond the limits "
                        "of this checker" % (leaf_text(claim, "P", *leaf), why))
    finally:
        done.save()
    return report(claim, criterion, done, earlier, sample is not None)


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
        self.cost = sum(cost(cell) for _, cell in work) if self.on else 0

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


def range_text(name, centre, half):
    low, high = decimal_text(centre - half), decimal_text(centre + half)
    return "%s = %s" % (name, low) if half == 0 else "%s <= %s <= %s" % (low, name, high)


def leaf_text(claim, kind, ordinal, cell):
    """Names a leaf by its number among those of its kind, its depth and where it lies."""
    sides = []
    for axis, i, k in zip((3, 4, 0, 1, 2), *cell):
        if claim.together and axis in (1, 2):
            i, k = cell[0][2], cell[1][2]
        low = claim.centre[axis] - claim.half[axis] + 2 * claim.half[axis] * i / (1 << k)
        sides.append("[%.9g, %.9g]" % (low, low + 2 * claim.half[axis] / (1 << k)))
    return "%s leaf %d of %d (v in %s pi, (a, b, c) in %s, %d cuts)" % (
        {"P": "proved", "S": "symmetric"}[kind], ordinal + 1, claim.tree.count(kind),
        " x ".join(sides[:2]), " x ".join(sides[2:]), sum(cell[1]))


def report(claim, criterion, done, earlier, sampled):
    """The theorem, exactly as far as it was verified; or the result of a spot check."""
    proved, torus = claim.tree.count("P"), min(claim.half[3:]) >= 1
    if sampled:
        status, verdict = SPOT_CHECK, "spot check"
        lines = ["Spot check of %d of %d proved leaves, NOT a verification: none of them fails."
                 % (done.confirmed, proved), "What is claimed and NOT verified :"]
    else:
        status, verdict = (VERIFIED, "verified") if torus else (PART, "verified in part")
        lines = ["Verified" + ", for a part of the torus only" * (not torus)
                 + ", %d of %d leaves by an earlier run" % (earlier, proved) * (earlier > 0) + " :"]
    lines += ["The map x[j+1] = 2 x[j] - x[j-1] - V'(x[j]) of two angles (modulo 2 pi),",
              "V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1), has no invariant Lagrangian graph",
              "(no invariant torus p = P + S'(x) over the angles, where p[j] = x[j] - x[j-1], P is",
              "constant, S periodic and C1)"]
    if not torus:
        lines += ["whose orbit through x[0] = x* goes on to x[1] = (v0, v1) in the region",
                  *(range_text(name + " / pi", claim.centre[k], claim.half[k])
                    for k, name in ((3, "v0"), (4, "v1"))),
                  "(only successors in this region were examined, which is not the full torus)"]
    lines[-1] += " for any parameters with"
    lines += [range_text(name, claim.centre[k], claim.half[k]) for k, name in enumerate("abc")]
    if claim.together:
        lines += ["moving together, on the segment from all lower to all upper ends"]
    if claim.at_once:
        lines += ["and for any multiple s >= 1 of " + ("the upper ends of these ranges (B > 10/3)"
                                                      if claim.together else
                                                      "such parameters (B > 10/3)")]
    places = 9
    bound = -(-criterion.B * 10 ** places // criterion.fixed.one)       # rounded up
    lines += [
        "", "Checker : converse-check " + __version__,
        "Method : Loewner criterion, %sTaylor models in integers of %d bits" % (
            "multipliers in doubles, and where these fail " * bool(criterion.fast),
            criterion.fixed.bits),
        "x* : %s %s" % tuple(map(decimal_text, claim.xstar)),
        "B : %s" % decimal_text(Fraction(bound, 10 ** places)),
        "Leaves : %d, of which %d proved and %d symmetric" % (
            proved + claim.tree.count("S"), proved, claim.tree.count("S")),
        "Proved leaves checked : %d, in %d pieces" % (done.confirmed, done.pieces)]
    if earlier:
        lines += ["Of these, by an earlier run whose state was believed : %d" % earlier]
    return Result(status, verdict, "\n".join(lines + ["SHA-256 : " + claim.sha256]))


# ---- the command

def interrupt(number, frame):
    """The first signal ends the check; the end itself is quick and must not be interrupted."""
    for heard in SIGNALS:
        signal.signal(heard, signal.SIG_IGN)
    raise KeyboardInterrupt(number)


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
        "Verifies the theorem of a proof file, independently of the program that wrote it."),
        epilog="""exit status:
  0    verified
  1    rejected: the file is wrong (altered, unfinished, with undecided or missing
       parts, wrong counts, a skipped part without its mirror image)
  2    bad usage, or a file that cannot be read
  3    verified, but for successors in a part of the torus only
  4    a spot check in which nothing failed: NOT a verification
  5    not confirmed: the claim is false or its proof beyond the checker's limits
  130  interrupted (129, 143: by SIGHUP, SIGTERM)""")
    p.add_argument("file", help="a finished proof file, perhaps compressed by gzip")
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
