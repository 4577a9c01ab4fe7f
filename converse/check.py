"""converse-check: verifies the theorem of a proof file, independently of the program that wrote it.

The map.  V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1);  x[j+1] = 2 x[j] - x[j-1] - V'(x[j]);
beta(x) = 2I - V''(x).  Its orbits are stationary for the sum of |x[j+1] - x[j]|^2 / 2 - V(x[j]),
whose second variation is  Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1].

The criterion (the Loewner criterion of converse KAM, by its witness).
1. Orbits on an invariant Lagrangian graph minimize (Katok; MacKay, Meiss and Stark, Nonlinearity 2,
   1989), so Q(n) >= 0 for every finite sequence n; hence also for every square-summable one.
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
prover: of the package it takes the version, for its report, and nothing else.
"""

import argparse
import collections
import concurrent.futures.process
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
import sys
import zlib
from array import array
from dataclasses import dataclass
from fractions import Fraction

from tqdm import tqdm

try:
    from converse import __version__
except ImportError:                     # the file also works alone
    __version__ = "(standing alone)"

VERIFIED, REJECTED, UNUSABLE, INTERRUPTED = 0, 1, 2, 130
MAX_BYTES = 1 << 28                     # of a proof file, uncompressed
MAX_CUTS = 1000                         # of a leaf
MAX_HALVINGS, MAX_PIECES = 12, 512      # of a leaf, by the checker itself
MAX_POINTS = 330                        # of an orbit
CHUNK = 64                              # leaves per task
NU_BITS = 20                            # of the test vectors


class Unusable(Exception):
    """The arguments or the file cannot be used at all."""


class Rejected(Exception):
    """The file does not prove what it claims, or its format is broken."""


# ---- the proof file

NAMES = ("a", "b", "c", "v0", "v1")
AXES = "01234"                          # of cuts: v0, v1, then a, b, c or, together, 2 for all
COUNTS = ("depth", "cuts", "proved", "symmetric", "undecided", "most_cuts")
IGNORED = ("program", "method", "digits", "stubborn", "seconds", "quick_tries", "tries", "Rtries",
           "HermSuccess", "LLSuccess", "ll_used", "reasons", "max_steps", "max_NTsteps",
           "B", "pending")
OPTIONAL = {"T", "Tr-", "Tr+", "lambda-min", "lambda-max", "comment"}     # ignored, too
FIELDS = {*NAMES, *COUNTS, *IGNORED, "kind", "xstar", "together", "at once"}
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", re.ASCII)


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
            data = raw = file.read(MAX_BYTES + 1)
        if raw[:2] == b"\x1f\x8b":
            with gzip.GzipFile(fileobj=io.BytesIO(raw)) as file:
                data = file.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise Unusable("the compressed file is damaged or truncated") from None
    except UnicodeDecodeError:
        raise Unusable("is not a proof file") from None
    except (OSError, ValueError) as error:
        raise Unusable("cannot be read (%s)" % (getattr(error, "strerror", 0) or error)) from None
    if max(len(raw), len(data)) > MAX_BYTES:
        raise Unusable("is larger than %d bytes" % MAX_BYTES)
    if not text.startswith("converse proof "):
        raise Unusable("is not a proof file")
    if not text.startswith("converse proof 2\n"):
        raise Rejected("the format is not version 2")
    body, marker, end = text.rpartition("checksum: sha256 ")
    if not body.endswith("\n") or not re.fullmatch("[0-9a-f]{64}\nend\n", end):
        raise Rejected("the file does not end with its checksum; it is truncated or altered")
    if end[:64] != hashlib.sha256(body.encode("utf-8")).hexdigest():
        raise Rejected("wrong checksum: the file was changed or damaged")
    head, marker, tree = body.partition("\ntree:\n")
    if not marker:
        raise Rejected("there is no tree")
    return parse(head.split("\n")[1:], tree.replace("\n", ""), hashlib.sha256(data).hexdigest())


def parse(lines, tree, sha256):
    """The claim; the header must give each field once, and nothing of unknown meaning."""
    header = {}
    for line in lines:
        name, colon, value = line.partition(": ")
        if not colon or name not in FIELDS | OPTIONAL:
            raise Rejected("the header has a line of unknown meaning: '%.40s'" % line)
        if name in header and name != "comment":
            raise Rejected("the header gives %s twice" % name)
        header[name] = value
    if FIELDS - header.keys():
        raise Rejected("the header lacks %s" % ", ".join(sorted(FIELDS - header.keys())))
    if header["kind"] != "sound":
        raise Rejected("the file says '%.40s': it is not meant as a proof" % header["kind"])
    pairs = []
    for name in (*NAMES, "xstar"):
        words = header[name].split(" ")
        if len(words) != 2 or len(header[name]) > 4000 or not all(map(NUMBER.fullmatch, words)):
            raise Rejected("the header's %s is not two decimal numbers" % name)
        pairs.append(tuple(map(Fraction, words)))
        if max(map(abs, pairs[-1])) > 10 ** 300:
            raise Rejected("the header's %s is out of range" % name)
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
            raise Rejected("'%s' is not a node of a finished tree, at node %d" % (node, position))
        if sum(cuts) > MAX_CUTS:
            raise Rejected("node %d lies below %d cuts" % (position, MAX_CUTS))
    if pending:
        raise Rejected("the tree is incomplete: %d of its parts are missing" % len(pending))


def check_tree(claim):
    """The number of leaves, if the tree is whole, decided, and what the header's counts say."""
    total = most_cuts = 0
    if claim.together and set("34") & set(claim.tree):
        raise Rejected("parameters that move together are cut one at a time")
    for position, (_, cuts) in leaves(claim.tree):
        total += 1
        depth = sum(cuts)
        if claim.tree[position] == "U":
            raise Rejected("leaf %d is undecided" % total)
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
    return total


class Mirror:
    """The exchange of v0 and v1, a and b: may a leaf be skipped for the sake of its mirror image?"""

    def __init__(self, claim):
        """The exchange maps orbits to orbits; the rest must be its own image."""
        a, b, _, v0, v1 = zip(claim.centre, claim.half)
        self.symmetric = a == b and v0 == v1 and claim.xstar[0] == claim.xstar[1]
        self.tree, self.together = claim.tree, claim.together
        self.upper = array("q", bytes(8 * len(self.tree)))  # where a node's upper half begins
        unfinished = []                                     # nodes whose lower half goes on
        for position, node in enumerate(self.tree):
            if node in AXES:
                unfinished.append(position)
            elif unfinished:
                self.upper[unfinished.pop()] = position + 1

    def refusal(self, cell):
        """Why the symmetric leaf may not be skipped, or None if its mirror image is proved."""
        if not self.symmetric:
            return "is skipped by symmetry, but the problem is not symmetric"
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
                return "is skipped by symmetry, but its mirror image is not proved"
            halves = lower, self.upper[position]
            index, cuts = image[axis]
            if cuts == 0:                                   # the image has both halves
                todo += [(half, image) for half in halves]
            else:
                rest = index & (1 << cuts - 1) - 1, cuts - 1
                todo.append((halves[index >> cuts - 1], changed(image, axis, rest)))
        return None


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
        self.fixed = fixed = Fixed(max(96, 64 + narrow + claim.counts["most_cuts"]))
        self.parameters = [[math.floor(x * fixed.one) for x in claim.centre[:3]],
                           [math.floor(x * fixed.one) for x in claim.half[:3]]]
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
            raise Rejected("beta has no eigenvalue above 2: the criterion does not apply")
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
                raise Rejected("the parameters are too large for this checker")
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
        why, columns, known = "the orbit of its centre contradicts nothing", half, 7
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
        return why, columns

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
                return failed[0], pieces
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


# ---- the whole file

_worker = []                            # in each process: a Criterion and a Mirror


def begin_apart(*state):
    """Starts a worker process; it is for the parent process to notice Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _worker[:] = state


def check_chunk(chunk):
    """Checks leaves in order: (how many, pieces tried, None or the first failure)."""
    criterion, mirror = _worker
    pieces = 0
    for n, (ordinal, node, cell) in enumerate(chunk, 1):
        if node == "P":
            why, tried = criterion.excluded(cell)
            pieces += tried
            why = why and "is not excluded: " + why
        else:
            why = mirror.refusal(cell) if node == "S" else "is undecided"
        if why:
            return n, pieces, (ordinal, cell, why)
    return len(chunk), pieces, None


def in_order(chunks, jobs, state):
    """Yields the results of the chunks in their order, few of them being in memory at a time."""
    if jobs == 1:
        _worker[:] = state
        yield from map(check_chunk, chunks)
        return
    pool = concurrent.futures.ProcessPoolExecutor(jobs, initializer=begin_apart, initargs=state)
    try:
        waiting = collections.deque()
        for chunk in chunks:
            waiting.append(pool.submit(check_chunk, chunk))
            if len(waiting) > 4 * jobs:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    except concurrent.futures.process.BrokenProcessPool:
        raise Unusable("a worker process died; nothing was verified") from None
    finally:
        pool.shutdown(cancel_futures=True)


def verify(path, jobs=1, sample=None, quiet=True):
    """Verifies a proof file and returns the lines of the report; Rejected says what is wrong."""
    claim = read(path)
    total = check_tree(claim)
    mirror = Mirror(claim) if "S" in claim.tree else None
    criterion = Criterion(claim)
    if claim.at_once and not criterion.at_once():
        raise Rejected("it is not confirmed that larger parameters are excluded at once")
    chosen = range(total)
    if sample is not None:
        chosen = set(random.Random(claim.sha256).sample(chosen, min(sample, total)))
    work = ((n, claim.tree[position], cell)
            for n, (position, cell) in enumerate(leaves(claim.tree)) if n in chosen)
    chunks = iter(lambda: list(itertools.islice(work, CHUNK)), [])
    pieces = 0
    with tqdm(total=len(chosen), unit=" leaves", leave=False, file=sys.stderr,
              disable=True if quiet else None) as bar:      # None: unless stderr is a terminal
        for done, tried, failure in in_order(chunks, jobs, (criterion, mirror)):
            if failure:
                raise Rejected(failure_text(claim, total, *failure))
            pieces += tried
            bar.update(done)
    return report(claim, criterion, total, len(chosen), pieces, sample is not None)


# ---- what is said

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


def failure_text(claim, total, ordinal, cell, why):
    """Names a leaf by its number in preorder, its depth and where it lies."""
    sides = []
    for axis, i, k in zip((3, 4, 0, 1, 2), *cell):
        if claim.together and axis in (1, 2):
            i, k = cell[0][2], cell[1][2]
        low = claim.centre[axis] - claim.half[axis] + 2 * claim.half[axis] * i / (1 << k)
        sides.append("[%.9g, %.9g]" % (low, low + 2 * claim.half[axis] / (1 << k)))
    return "leaf %d of %d (v in %s pi, (a, b, c) in %s, %d cuts) %s" % (
        ordinal + 1, total, " x ".join(sides[:2]), " x ".join(sides[2:]), sum(cell[1]), why)


def report(claim, criterion, total, checked, pieces, sampled):
    """The theorem, exactly as far as it was verified; or the result of a spot check."""
    lines = ["No leaf that was looked at fails, but this is a SPOT CHECK of %d of %d leaves"
             % (checked, total), "and NOT a verification.  The file claims this :"] if sampled else \
            ["Verified :"]
    lines += ["The map x[j+1] = 2 x[j] - x[j-1] - V'(x[j]) of two angles (modulo 2 pi),",
              "V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1), has no invariant Lagrangian graph",
              "(no invariant torus p = P + S'(x) over the angles, where p[j] = x[j] - x[j-1], P is",
              "constant, S periodic and C1; so none that is a C1 or a Lipschitz graph)"]
    if min(claim.half[3:]) < 1:
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
    return lines + [
        "", "Checker : converse-check " + __version__,
        "Method : Loewner criterion, Taylor models in integers of %d bits" % criterion.fixed.bits,
        "x* : %s %s" % tuple(map(decimal_text, claim.xstar)),
        "B : %s" % decimal_text(Fraction(bound, 10 ** places)),
        "Leaves : %d, of which %d proved and %d symmetric" % (
            total, claim.tree.count("P"), claim.tree.count("S")),
        "Leaves checked : %d, in %d pieces" % (checked, pieces),
        "SHA-256 : " + claim.sha256]


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Unusable(message + "; see converse-check --help")


def whole(text):
    if not re.fullmatch("[0-9]{1,9}", text, re.ASCII) or int(text) == 0:
        raise argparse.ArgumentTypeError("'%.40s' is not a whole number above 0" % text)
    return int(text)


def parser():
    p = Parser(prog="converse-check", allow_abbrev=False, description=(
        "Verifies the theorem of a proof file, independently of the program that wrote it."),
        epilog="Exit status: 0 verified; 1 rejected; 2 bad usage or unreadable; 130 interrupted.")
    p.add_argument("file", help="a finished proof file, perhaps compressed by gzip")
    p.add_argument("--jobs", type=whole, default=1, metavar="N", help="processes (default 1)")
    p.add_argument("--sample", type=whole, metavar="K",
                   help="only a spot check, of K leaves; not a verification")
    p.add_argument("--quiet", action="store_true", help="no report of success, no bar")
    p.add_argument("--version", action="version", version="converse-check " + __version__)
    return p


def main(argv=None):
    """Runs the command and returns its exit status; every failure is one line."""
    name = ""
    try:
        if sys.stdout is None or sys.stderr is None:
            return UNUSABLE                     # a standard stream is closed: nowhere to say so
        for stream in (sys.stdout, sys.stderr):
            stream.reconfigure(errors="backslashreplace")
        options = parser().parse_args(argv)
        name = options.file + ": "
        lines = verify(options.file, min(options.jobs, 61), options.sample, options.quiet)
        if not options.quiet or options.sample:         # a spot check never passes in silence
            print("\n".join(lines), flush=True)
        return VERIFIED
    except SystemExit as end:                   # of --help and --version
        return end.code
    except KeyboardInterrupt:
        status, message = INTERRUPTED, "interrupted; nothing was verified"
    except Rejected as error:
        status, message = REJECTED, "rejected: %s" % error
    except Unusable as error:
        status, message = UNUSABLE, str(error)
    except OSError as error:
        status, message = UNUSABLE, "the output cannot be written (%s)" % (error.strerror or error)
        with contextlib.suppress(OSError):      # the interpreter must not try again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except Exception as error:                  # whatever went wrong must not look like success
        status, message = UNUSABLE, "the checker failed (%s: %s)" % (type(error).__name__, error)
    with contextlib.suppress(OSError):
        print("converse-check: " + " ".join((name + message).split()), file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
