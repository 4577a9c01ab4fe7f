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
//, is to be seen where it happens.  Errors are counted in units.  This file shares no code with the
prover: of the package it takes the version, for its report, and nothing else; and it needs nothing
but Python, so a copy of this one file will do.

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
CHUNK = 16                              # leaves per task
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
    spent = pieces = 0
    for n, (ordinal, cell) in enumerate(chunk):
        why, tried = criterion.excluded(cell)
        if why:
            return n, spent, pieces, (ordinal, cell, why)
        spent += cost(cell)
        pieces += tried
    return len(chunk), spent, pieces, None


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


def verify(path, jobs=1, sample=None, state=None, bar=False):
    """Verifies a proof file: returns a Result, or raises Rejected, NotConfirmed or Unusable.

    jobs: processes.  sample: so many leaves only, chosen by chance: a spot check.
    state: a file that remembers what was confirmed, so that an interrupted check can go on; it
    is kept in the end.  bar: show the progress on stderr, if that is a terminal.
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
    done = State(state, claim)
    earlier, proved = done.confirmed, claim.tree.count("P")
    chosen = range(earlier, proved)
    if sample is not None:
        chosen = set(random.SystemRandom().sample(chosen, min(sample, proved)))

    def work():
        cells = (cell for position, cell in leaves(claim.tree) if claim.tree[position] == "P")
        return ((n, cell) for n, cell in enumerate(cells) if n in chosen)

    queue = work()
    chunks = iter(lambda: list(itertools.islice(queue, CHUNK)), [])
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
        "Method : Loewner criterion, Taylor models in integers of %d bits" % criterion.fixed.bits,
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
                        not options.quiet)
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
