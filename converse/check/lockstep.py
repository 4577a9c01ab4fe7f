"""The fast path: a thousand prisms in lockstep, in doubles.

The same bound as in exact.py, steps (C4) to (C8) of docs/proofs/checker.md, where rounding errors
are bounded by steps (C9) to (C20).  Where V is even about x* orbits are followed to one side of it:
step (C32).  A leaf that is not excluded here is left to the integers.  Each operation is done to
all prisms together, as arrays of numpy, whose operations round to nearest (import_numpy_if_sound
tests this).
"""

import collections
import functools
import itertools
import math
import random
from dataclasses import replace
from fractions import Fraction

from .arith import (DIAGONAL, ROWS, cofactors, dot, entries, fixed_of, newton, pairs_of, trace,
                    turn_of, with_determinant)
from .choice import least, worst_axis
from .claim import ANGLE_AXES
from .criterion import axes_of
from .limits import FIRST_TRY_SITES, MAX_HALVINGS, MAX_PIECES, MAX_SITES, SITE_PENALTIES
from .progress import complain

np = None                               # numpy, once the fast path is wanted
UNIT = 2.0 ** -53                       # the unit roundoff u of doubles
TWO_PI = 2 * math.pi                    # within 0.35 u of 2 pi, relatively

# Of the bound; docs/proofs/checker.md needs these values.
SINE_ROUNDING = 24 * UNIT               # error of a sine or cosine, by the sum of |k[i]|: (C11)
SUM_ROUNDING = 1 + 2.0 ** -40           # factor for the roundings of a sum of positive terms: (C16)
GRID = 1.5 * 2.0 ** 26                  # doubles near it are multiples of 2^-26: (C19)
REST_MAX = MAX_SITES * 2.0 ** -26       # of the rests of all sites, 2^-27 for each site of a lane
MASS_MAX = 2.0 ** 22                    # of the masses, so that sums of such multiples are exact
WHOLE_ERROR = 2.0 ** -61                # radians in 2^-64 turns, and more
FORCE_ROUNDING = UNIT / 16              # of a wave's force, divided by its amplitude: (C13)
AMPLITUDE_BITS, AMPLITUDE_UNIT = 100, 2.0 ** -100       # of amplitudes, in turns: (C9)
UNDERFLOW_MARGIN = 2.0 ** -200          # added to sizes and divisors that may underflow
FAST_SIZE_MAX = 2.0 ** 10               # of a cell's amplitudes, x*, regions (in turns) and frames
AMPLITUDE_MAX = 2.0 ** 100              # of a claim's, of which some cells may have less
FAST_WAVES_MAX = 64                     # of all claims: (C18)
FAST_CUTS_MAX = 52                      # cuts of an axis; cells are wider than 2^-64 turns
REACH_MAX = 1.0                         # of a wave at a site, in radians: (C19)
DETERMINANT_MIN = 2.0 ** -60            # of d; smaller ones end a lane: (C15)

# Of the effort, on which no theorem rests; chosen by the table in docs/proofs/checker.md.
BATCH, BATCH_MIN = 1024, 16             # prisms in lockstep, at first and where orbits are long
MEMORY_MAX = 1 << 31                    # bytes of the sites of a batch; twice that in all processes
LENGTH_MARGIN = 1.5                     # by which orbits of a batch may be longer than the last's
BLOCK = 1 << 13                         # sites times lanes that are added up together
EARLY_TRY_GROWTH = 16                   # of a reach while its lane becomes four times as long


@functools.lru_cache(maxsize=1)
def sums_and_products():
    """Numbers x and y, including the smallest; and x + y, x - y, x y, x / y and x - 1, each rounded
    to nearest by Fraction."""
    draw = random.Random(1)
    x, y = ([draw.uniform(-1, 1) * 2.0 ** draw.randint(-500, 500) for _ in range(200)]
            + [2.0 ** -1022, 1 + 2.0 ** -30, 2.0 ** -530 / 3, 0.7, -1.1] for _ in range(2))
    return x, y, [[float(exact(Fraction(a), Fraction(b))) for a, b in zip(x, y)] for exact in (
        Fraction.__add__, Fraction.__sub__, Fraction.__mul__, Fraction.__truediv__,
        lambda a, _: a - 1)]


def import_numpy_if_sound():
    """Imports numpy.  Does it round to nearest, also below 2^-1022, and halves to even, and are its
    integers modulo 2^64?"""
    global np
    import numpy as np
    *operands, exact = sums_and_products()
    x, y = map(np.array, operands)
    one, high = np.ones_like(x), np.array([1 << 62], np.int64)
    with np.errstate(all="ignore"):
        return [found.tolist() for found in (x + y, x - y, x * y, x / y, x - one)] == exact \
            and (np.array([2.0 ** -1022] * 9) / 2 * 2).tolist() == [2.0 ** -1022] * 9 \
            and np.rint(np.array([0.5, 1.5, -2.5, 0.49, 7.0])).tolist() == [0, 2, -2, 0, 7] \
            and (np.array([[3, -1]], np.int64) @ [[1 << 62], [1 << 62]]).tolist() == [[-1 << 63]] \
            and [x.tolist() for x in (high * 3, high + high, high << 1)] \
            == [[-1 << 62], [-1 << 63], [-1 << 63]]


def whole(turns):
    """The turns in units of 2^-64 turns, modulo one turn, each off by less than a unit."""
    turns = turns - np.rint(turns)
    return np.ldexp(np.where(turns < 0.5, turns, turns - 1), 64).astype(np.int64)


def wrapped(units):
    """Integers modulo 2^64."""
    return ((units + (1 << 63)) % (1 << 64) - (1 << 63)).astype(np.int64)


def units_of(x, bits):
    """x radians in units of 2^-bits turns, off by less than 1.1 units for bits <= 100 and |x| up to
    AMPLITUDE_MAX: x and pi are taken within 2^-255."""
    fixed = fixed_of(256)
    return (math.floor(x * fixed.one) << bits) // (2 * fixed.pi)


def in_turns(amplitudes):
    """Amplitudes in units of 2^-AMPLITUDE_BITS turns as most / 2^38 + rest 2^26 turns, and rounded
    to a double, all in turns."""
    bits = AMPLITUDE_BITS - 38
    return ((amplitudes >> bits).astype(np.int64),
            (amplitudes & (1 << bits) - 1).astype(float) * (AMPLITUDE_UNIT / 2.0 ** 26),
            amplitudes.astype(float) * AMPLITUDE_UNIT)


@functools.lru_cache(maxsize=1)
def circle():
    """Of the cosines of the 1024th parts of a turn: the nearest multiples of 2^-26, as integers,
    the rest, and the cosines rounded; the sines are those of 256 parts less."""
    fixed = fixed_of(128)
    cosines = [cosine for _, cosine in fixed.table]
    near = [(x >> 101) + 1 >> 1 for x in cosines]
    return (np.array(near, np.int64),
            np.array([x - (y << 102) for x, y in zip(cosines, near)], float) * 2.0 ** -128,
            np.array(cosines, float) * 2.0 ** -128)


def lockstep_sincos(angles):
    """Sines and cosines of angles in units of 2^-64 turns, each within 2 u, and the cosine as
    near / 2^26 + low, within u/40.

    The angle less the nearest 1024th part of a turn is at most 1/325; in radians it has a relative
    error of 1.4 u, and its sine of 2.5 u.  Taylor's polynomials are off by less than u/2^20.  So
    what is added to a number of the table, at most 1/320, is off by 5.6 u/325 and the roundings of
    6 u/325^2 and u/320: in all u/40.
    """
    part = angles + (1 << 53) >> 54
    near, rest, cosines = circle()
    at, beside = part & 1023, part - 256 & 1023
    r = (angles - (part << 54)) * (TWO_PI / 2.0 ** 64)
    square = r * r
    versed = square * (0.5 - square * (1 / 24 - square / 720))
    sine = r - r * square * (1 / 6 - square * (1 / 120 - square / 5040))
    C, S, near = cosines[at], cosines[beside], near[at]
    low = rest[at] - (C * versed + S * sine)
    return S + (C * sine - S * versed), near * 2.0 ** -26 + low, near, low


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
    """The waves of the fast path without their amplitudes: their k and phases, and which symbols
    move their amplitudes."""

    def __init__(self, waves, moving=(), symbols=0):
        """waves: (k, phase) of each; moving: pairs (number of a wave, symbol that moves its
        amplitude); symbols: the number of all of them."""
        self.waves, self.symbols, self.count = waves, symbols, len(waves)
        self.moving = [[m for w, m in moving if w == here] for here in range(len(waves))]
        self.parameters = 1 + max([-1] + [m for _, m in moving])
        k = np.array([k for k, _ in waves], float)
        self.angles = k.shape[1]
        self.K = abs(k).sum(axis=1)
        self.square = (k * k).sum(axis=1)
        self.grain = (96 + 16 * len(k)) * UNIT
        self.k = k.astype(np.int64)
        self.phases = np.array([[(round(phase * (1 << 63)) + (1 << 63)) % (1 << 64) - (1 << 63)]
                                for _, phase in waves], np.int64)
        squares = np.array([entries(row) for row in k])
        self.forces, self.strengths = table(k.T), table(abs(k).T)       # V' from waves
        self.stiff = table((abs(squares) * self.K[:, None]).T)          # S
        self.strong = table((abs(k) * self.K[:, None]).T)
        self.forms = table(squares.T)
        self.mixed, self.sizes = table(k), table(abs(k))                # k.x of x
        # Of a site of a lane: s, c, columns, rest, far, E; the inverses of both recursions, n,
        # scores, and five numbers of a byte.
        numbers = len(k) * (3 + symbols) + 3 * self.angles + 2 * len(squares[0]) + 1
        self.site_bytes = 8 * numbers + 5

    def in_frame(self, turn):
        """In that frame of the errors: the absolute values of V' from waves, and of k.x from x;
        and the frame and the table of matrices, with their norms divided out."""
        size = math.isqrt(turn.length)
        rows = [[Fraction(x, size) for x in row] for row in turn.rows]
        k = np.array([[float(dot(row, k)) for row in rows] for k, _ in self.waves])
        blocks = turn.table and table([[x / turn.length for x in row] for row in turn.table])
        return table(abs(k).T), table(abs(k)), np.abs(np.array(rows, float)), blocks

    def along(self, v):
        """k.v for all waves."""
        return combined(self.mixed, v)

    def turns(self, X):
        """The angles of the waves, of X in units of 2^-64 turns, as X modulo one turn."""
        return self.k @ X + self.phases


def table(rows):
    """The rows of a matrix, as combined() takes them."""
    return [[(w, x) for w, x in enumerate(row) if x] for row in rows]


def inverted(d):
    """The inverses of symmetric matrices, as far as there are any, and which are definite."""
    found, det = with_determinant(d)
    definite = (d[0] > 0) & (det > 0)
    if len(d) == 6:
        definite &= found[-1] > 0
    return scaled(found, 1 / det), definite


def scaled(rows, by):
    into = np.empty((len(rows), *by.shape))
    for row, part in zip(rows, into):
        np.multiply(row, by, out=part)
    return into


def applied(d, v):
    """Symmetric matrices times vectors."""
    if len(v) < 3:
        return d[:2] * v[0] + d[1:] * v[1] if len(v) == 2 else d * v
    return sum([d[row] * x for row, x in zip(ROWS[len(d)], v)])


def scaled_sum(matrix, v):
    """A matrix of numbers times vectors."""
    return (matrix[..., None] * v).sum(axis=1)


def scalar(x, y):
    """Products of vectors."""
    return sum([a * b for a, b in zip(x[1:], y[1:])], x[0] * y[0])


def products(rows):
    """The products of rows i <= j, in order."""
    found, at = np.empty((len(rows) * (len(rows) + 1) // 2, *rows.shape[1:])), 0
    for i, row in enumerate(rows):
        np.multiply(row, rows[i:], out=found[at:at + len(rows) - i])
        at += len(rows) - i
    return found


def least_eigenvalue(d):
    return least(d, np.sqrt, lambda x, y: np.where((x > 0) & (y > 0), x / y, 0))


def least_eigenvector(d):
    found = np.stack(newton(d, least_eigenvalue(d))[2])
    diagonal = DIAGONAL[len(d)]
    best = found[diagonal].argmax(axis=0)
    v = sum([np.where(best == i, found[row], 0) for i, row in enumerate(ROWS[len(d)])])
    length = np.sqrt(scalar(v, v))
    first = np.zeros_like(v)
    first[0] = 1
    return np.where(length > 0, v / np.where(length > 0, length, 1), first)


def quadratic(pairs, xi, bend, parts):
    """Step (C6): the part of -p' cos(y + z) that is of second order in the symbols, as the
    coefficients of e[i] e[j] for these pairs, i <= j, and its mean; from the columns xi of k.L,
    P cos y, and pairs (symbol, h sin y)."""
    form, mean = bend * products(xi), 0
    for x, (i, j) in zip(form, pairs):
        if i == j:
            x /= 2
        for m, part in parts:
            if m in (i, j):
                x += part * xi[i + j - m]
        if i == j:
            mean = mean + x / 2
    return form, mean


def bending(P, H, W, s, c, size, rest, reach):
    """Step (C6), (iii), of a wave with |sin y| <= s and |cos y| <= c."""
    second = reach * reach / 2
    third, fourth = second * reach / 3, second * second / 6
    return np.abs(P) * (c * (rest * (reach + size) / 2 + fourth) + s * third) \
        + H * (c * second + s * (rest + third)) + W


def remainder(P, H, W, A0, alpha, B0, beta, weight, size, rest, reach):
    """Bounds the difference between a wave and the polynomial of step (C8), if alpha and beta bound
    these linear parts, and weight |m| + omega."""
    second = reach * reach / 2
    third, fourth = second * reach / 3, second * second / 6
    far = rest * (reach + size) / 2 + fourth
    a, b = np.abs(A0), np.abs(B0)
    return np.abs(P) * (a * np.where(P * A0 > 0, fourth, rest * rest / 2) + alpha * far
                        + b * (rest * (reach * (reach + size) + size * size) / 6
                               + second * third / 10)
                        + beta * third) \
        + H * (a * far + alpha * second + b * third + beta * (rest + third)) + W * weight


class Sites(collections.namedtuple("Sites", "alive s c columns rest far E")):
    """A site of all lanes, in the words of docs/proofs/checker.md: the lanes that have it; s, c,
    k.L as columns of the symbols and the rest of each wave; bounds of |D|; E of step (C7).  Or a
    block of sites, in arrays whose last axes are the sites and the lanes."""

    @classmethod
    def block(cls, sites):
        return cls(*[stacked(values) for values in zip(*sites)])

    @property
    def size(self):
        return np.abs(self.columns).sum(axis=1) * SUM_ROUNDING

    @property
    def reach(self):
        return (self.size + self.rest) * SUM_ROUNDING


def stacked(values):
    """Arrays of a block's sites as one array."""
    return np.stack(values, axis=-2)


def next_rest(d, f, r, r0, err, unsure):
    """Steps (C5) and (C15): f of a site q, with M and the determinant of d, from d and f of the
    site before it, the rests r of q and r0 of that site, the error err of the step from q, and
    what the entries of beta are unsure by."""
    found, det = with_determinant(d)
    inv, sizes = 1 / det, np.abs(d)
    M, some = scaled(found, inv), np.stack(cofactors(sizes, 1))
    full = scalar(sizes[:len(r)], some[:len(r)])        # the determinant without signs
    f = applied(np.abs(M), f) + err + applied(unsure, r) \
        + 8 * UNIT * np.abs(inv) * (applied(some, applied(sizes, r0)) + full * r0)
    return f, M, det


class Sums:
    """Sums over the sites of each lane: the value at X and P, the polynomial of step (C8) in the
    symbols, a bound of the rest (error), and the mass of step (C19)."""

    def __init__(self, known, angles, lanes):
        """known: the number of symbols; angles: the number of the parameters, which come first."""
        self.known, self.angles = known, angles
        self.pairs = [(i, j) for i in range(known) for j in range(i, known)]
        self.value, self.low, self.error = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
        self.mass, self.bent = np.zeros(lanes), np.zeros(lanes)
        self.linear, self.square = np.zeros((known, lanes)), np.zeros((len(self.pairs), lanes))
        self.cubic = np.zeros((known, len(self.pairs), lanes))      # of e[i] and of a pair
        self.mixed = np.zeros((angles, known, lanes))   # of e[i] and a parameter's symbol
        self.skew = np.zeros((angles, known, known, lanes))
        self.ends = None                                # of e[i] and the columns of x[1]

    def add_waves(self, shape, P, h, columns, A, B):
        """Adds the polynomial of step (C8) of all waves of a block of sites, except P (A0 + alpha),
        which the multipliers of (C7) cancel up to mu.E."""
        for w in range(shape.count):
            xi, A0, alpha = columns[w], A[w, 0], A[w, 1:]
            # What stands with xi^2.
            first = (P[w] / -2) * alpha - (P[w] * B[w, 0] / 6) * xi
            for symbol in shape.moving[w]:
                part = h[w, symbol]
                part_A = part * A0
                first[symbol] -= part_A / 2
                self.linear[symbol] += part_A.sum(axis=-2)
                self.mixed[symbol] += (part * alpha).sum(axis=-2)
                self.skew[symbol] += ((part * B[w, 1:])[:, None] * xi).sum(axis=-2)
            xi = products(xi)
            self.square += (P[w] * A0 / 2 * xi).sum(axis=-2)
            self.cubic += (first[:, None] * xi).sum(axis=-2)

    def add(self, terms):
        """Adds these terms, of several sites, to the value: multiples of 2^-26 exactly, and apart
        from them the rests, of at most 2^-27 each; step (C19)."""
        coarse = terms + GRID - GRID
        self.value += coarse.sum(axis=-2)
        self.low += (terms - coarse).sum(axis=-2)

    def join(self, joined):
        """Puts the lanes of each prism together."""
        for name in ("value", "low", "mass", "bent", "error", "linear", "square", "cubic", "mixed",
                     "skew"):
            setattr(self, name, joined(getattr(self, name)))

    def form(self):
        """The coefficients of e[i], e[i] e[j] and e[i] e[j] e[k], by (i,), (i, j) and (i, j, k),
        i <= j <= k."""
        form = {tuple(key): np.zeros_like(self.value) for count in (1, 2, 3)
                for key in itertools.combinations_with_replacement(range(self.known), count)}

        def add(x, *key):
            form[tuple(sorted(key))] += x

        for i in range(self.known):
            add(self.linear[i], i)
            for at, (j, k) in enumerate(self.pairs):
                add((1 + (j < k)) * self.cubic[i, at], i, j, k)
            for k in range(self.angles):
                add(self.mixed[k, i], i, k)
                for j in range(self.known):
                    add(self.skew[k, i, j], i, j, k)
            for k in range(self.known):
                add(self.ends[k, 1 + i], i, k)
            add(self.ends[i, 0], i)
        for at, (j, k) in enumerate(self.pairs):
            add((1 + (j < k)) * self.square[at], j, k)
        return form


class Prisms:
    """Prisms followed and bounded in lockstep; all arrays end with the axis of lanes, those ahead
    before those back.  If V is even about x*, only those back: step (C32)."""

    def __init__(self, box, shape, xstar, l, penalties=SITE_PENALTIES[0], memory=MEMORY_MAX,
                 even=False):
        """The box: amplitudes as in_turns() gives them, h (by wave and symbol) and W of the waves,
        X[1], its columns (by coordinate and symbol, of which the last two span the parallelogram)
        and the error of x[1], in radians; the Shape; x*; l; and penalties (see SITE_PENALTIES).
        X[1] and x* are in units of 2^-64 turns.  memory: bytes that the sites may take.  even: is V
        even about x* for all parameters?"""
        turns, h, W, x, columns, off = box
        self.size, self.shape, self.even = x.shape[1], shape, even
        self.turns = [self.both(part, part) for part in turns]
        self.P, self.h, self.W = self.turns[-1] * TWO_PI, self.both(h, h), self.both(W, W)
        self.H = np.abs(self.h).sum(axis=1) * SUM_ROUNDING
        self.magnitude, self.l = np.abs(self.P), self.both(l, l)
        self.penalties = [self.both(x + 0 * l, x + 0 * l) for x in penalties]
        self.absent = (self.magnitude == 0) & (self.H == 0) & (self.W == 0)     # in these lanes
        self.reach_max = np.where(self.absent, math.inf, REACH_MAX)
        self.known, self.pairs = shape.symbols, pairs_of(shape.symbols)
        self.halves = np.array([[0.5 if i == j else 1] for i, j in self.pairs])
        start, blank, rounding = xstar + 0 * x, 0 * columns, np.full_like(off, WHOLE_ERROR)
        if even:                        # the mirror image of x[1], too
            off = off + WHOLE_ERROR * (3 + combined(shape.strong, self.magnitude + self.H + self.W))
        self.ends, self.rounding = [np.concatenate(pair, axis=-1) for pair in (
            (columns, blank), (off, rounding))]
        self.bound_roundings()
        off, rounding = [scaled_sum(self.turn, u) for u in (off, rounding)]
        self.before = self.both(start, x), self.both(blank, columns), self.both(rounding, off)
        self.first = self.both(x, start), self.both(columns, blank), self.both(off, rounding)
        self.sites, self.excluded = [], np.zeros(self.size, bool)  # which are not followed further
        self.sites_max = memory // (self.l.size * shape.site_bytes)
        self.begin()

    def bound_roundings(self):
        """The frame of the rests, and what the roundings of a step are multiplied by: (C12) to
        (C14)."""
        shape = self.shape
        self.strengths, self.sizes, self.turn, self.blocks = shape.in_frame(turn_of(
            [(k, x) for (k, _), x in zip(shape.waves, self.magnitude.mean(axis=1))], shape.angles))
        self.F = shape.grain * combined(shape.stiff, self.magnitude)
        self.F[self.diagonal] += shape.grain
        self.from_H = shape.grain * combined(shape.strong, self.H)
        # Of the step of the centre.
        self.push = FORCE_ROUNDING * combined(shape.strengths, self.magnitude) \
            + WHOLE_ERROR * abs(shape.k).sum()
        # Of beta in that frame.
        self.unsure = np.broadcast_to(trace(self.F), self.F.shape) if self.blocks else self.F

    @property
    def diagonal(self):
        return DIAGONAL[len(self.shape.forms)]

    def both(self, ahead, back):
        return back if self.even else np.concatenate((ahead, back), axis=-1)

    def other(self, lanes):
        """Of the other lane; zero if it is not followed."""
        return np.roll(lanes, self.size, axis=-1) if lanes.shape[-1] > self.size else \
            np.zeros_like(lanes)

    def joined(self, lanes):
        return lanes[..., :self.size] + lanes[..., self.size:] if lanes.shape[-1] > self.size \
            else lanes

    def begin(self):
        """The lanes at their first sites.  LT: L, then T, as columns; near: a bound of L e + T(e)
        in each coordinate; a 0 stands for the site before."""
        (self.X0, L0, self.r0), (self.X, L, self.r) = self.before, self.first
        none = np.zeros((len(L), len(self.pairs), L.shape[-1]))
        self.LT0, self.LT = [np.concatenate((x, none), axis=1) for x in (L0, L)]
        self.near0, self.d, self.f = np.abs(L0).sum(axis=1), None, None
        self.alive = self.regular = np.ones(L.shape[-1], bool)
        self.measure()
        self.last = self.moved(self.columns)        # how far each symbol moves a lane's last site

    def moved(self, columns):
        """How far each symbol moves a site: the sum over the waves of a lane."""
        return np.where(self.absent[:, None], 0, np.abs(columns)).sum(axis=0)

    def follow(self):
        """Follows all lanes until each reaches too far.  Yields True at the end and where (C3) is
        to be tried earlier; False if the memory is full.

        An early try costs as much as the try at the end.  So there is one only if, for the majority
        of the lanes, the reach grew by less than EARLY_TRY_GROWTH since the last, as near elliptic
        orbits, which end late.
        """
        due, reached = FIRST_TRY_SITES, 0
        while True:
            near = (self.reach <= self.reach_max).all(axis=0)
            self.end(self.alive & ~(self.regular & near))
            count = len(self.sites)
            if count and (not self.alive.any() or count == MAX_SITES):
                yield True
                return
            if count >= self.sites_max and self.size > BATCH_MIN:
                yield False
                return
            farthest = np.where(self.absent, 0, self.reach).max(axis=0)
            if 2 * count == due:
                reached = farthest
            if count == due:
                slow = self.alive & (farthest < EARLY_TRY_GROWTH * reached)
                if 2 * slow.sum() > self.alive.sum():
                    yield True
                    self.end(self.alive & self.both(self.excluded, self.excluded))
                reached, due = farthest, 4 * due
            self.step()

    def measure(self):
        """How far the waves reach at this site, and (near) the coordinates without r."""
        known, waves, own = self.known, self.shape.along(self.LT), np.abs(self.LT)
        self.columns, far = waves[:, :known].copy(), np.abs(waves)
        size = far[:, :known].sum(axis=1) * SUM_ROUNDING
        self.near = (own[:, :known].sum(axis=1) + (self.halves * own[:, known:]).sum(axis=1)) \
            * SUM_ROUNDING
        rest = (self.halves * far[:, known:]).sum(axis=1) + combined(self.sizes, self.r) \
            + 4 * UNIT * combined(self.shape.sizes, self.near)
        self.size_, self.rest = size, rest * SUM_ROUNDING
        self.reach = (size + self.rest) * SUM_ROUNDING

    def end(self, lanes):
        """Ends these lanes: they are zero from this site on."""
        if lanes.any():
            if self.sites:
                np.copyto(self.last, self.moved(self.sites[-1].columns), where=lanes)
            self.alive = self.alive & ~lanes
            self.clear()
            self.measure()

    def clear(self):
        """Sets lanes that have ended to zero."""
        if not self.alive.all():
            for array in self.LT, self.r:
                np.copyto(array, 0, where=~self.alive)

    def step(self):
        """Adds this site to the lanes and goes on to the next: steps (C4) to (C6)."""
        P, shape = self.P, self.shape
        s, c, near, low = lockstep_sincos(shape.turns(self.X))
        beta = combined(shape.forms, P * -s)
        beta[self.diagonal] += 2
        LT = applied(beta[:, None], self.LT) - self.LT0
        mean = self.add_forces(LT, s, c)
        far = self.near + (scaled_sum(self.turn.T, self.r) if self.blocks else self.r)
        self.sites.append(Sites(self.alive, s, c, self.columns, self.rest, far,
                                combined(shape.forces, mean)))
        most, rest, turns = self.turns
        forces = most * near + whole(turns * low + rest * near - mean / TWO_PI)
        self.X, self.X0 = 2 * self.X - self.X0 + shape.k.T @ forces, self.X
        r = self.next_rests(beta, np.abs(s), np.abs(c))
        self.LT, self.LT0, self.r, self.r0, self.near0 = LT, self.LT, r, self.r, self.near
        self.clear()
        self.measure()

    def add_forces(self, LT, s, c):
        """Adds to the next L and T what the parameters' forces and the quadratic parts of the waves
        do; returns the mean of (C6) of each wave."""
        h, known, mean = self.h, self.known, np.zeros_like(s)
        for w in range(self.shape.count):
            symbols = self.shape.moving[w]
            form, mean[w] = quadratic(self.pairs, self.columns[w], self.P[w] * c[w],
                                      [(m, h[w, m] * s[w]) for m in symbols])
            forces = [(m, h[w, m] * c[w]) for m in symbols]
            for i, k in enumerate(self.shape.waves[w][0]):
                if k:
                    LT[i, known:] -= form if k == 1 else k * form
                    for m, wave in forces:
                        LT[i, m] += wave if k == 1 else k * wave
        return mean

    def next_rests(self, beta, s, c):
        """The rests of the next site, steps (C5), (C6) and (C13) to (C15), from beta and the
        absolute values of sines and cosines."""
        shape, r = self.shape, self.r
        slack = SINE_ROUNDING * shape.K[:, None]
        bent = bending(self.P, self.H, self.W, s + slack, c + slack, self.size_, self.rest,
                       self.reach)
        err = self.push + applied(self.F, self.near) + self.from_H \
            + (4 + len(s)) * UNIT * self.near0
        if self.blocks:
            err, beta = scaled_sum(self.turn, err), combined(self.blocks, beta)
        err = combined(self.strengths, bent) + err
        if self.d is None:                      # d[q] = beta, f = err - r[o] + roundings
            f, d = self.r0 + err + applied(self.unsure, r), beta
        else:
            f, M, det = next_rest(self.d, self.f, r, self.r0, err, self.unsure)
            self.regular, d = np.abs(det) > DETERMINANT_MIN, beta - M
        self.d, self.f = d, f * SUM_ROUNDING
        return (applied(np.abs(d), r) + self.f) * SUM_ROUNDING

    def test_vectors(self):
        """Vectors n for each site, and how many tails begin there: one where a lane ends, one where
        n begins amid a lane.  Any vectors give a bound, if n is zero beyond.

        At each site the recursions from both ends of the orbit are compared, as by test_vectors in
        exact.py, to beta plus a penalty for the reach of the site.  A recursion that fails begins
        anew after that site.  They cut the orbit into segments.  In each, n is an eigenvector at
        the site where both recursions together have the negative eigenvalue nearest to zero, and
        follows outwards by the recursions.  The segment with the lowest such eigenvalue is taken:
        others may contradict by a tiny amount, however small the prism.
        """
        ends = [*[site.alive for site in self.sites[1:]], np.zeros_like(self.alive)]
        back, whole, blocks = self.recursion_inwards(ends)
        ahead, begins, scores = self.recursion_outwards(ends, back, whole, blocks)
        place = self.plainest(begins, scores)
        before = (begins & (np.arange(len(ends))[:, None] <= place))[::-1]
        begin = np.where(before.any(axis=0), len(ends) - 1 - before.argmax(axis=0), -1)
        v = least_eigenvector(self.joint_form(place, ends, ahead, back))
        n, x = [], np.zeros_like(v)
        for k in range(len(ends) - 1, -1, -1):
            inward = (begin <= k) & (k < place)
            x = np.where(place == k, v, np.where(inward, applied(ahead[k], x), 0))
            n.append(x)
        n.reverse()
        across = self.other((place >= 0) & (begin < 0)) & self.sites[0].alive
        n[0] = np.where(across, applied(back[0], self.other(n[0])), n[0])
        for k, site in enumerate(self.sites):
            if k:
                outward = (place < k) & ((place >= 0) | across)
                n[k] = np.where(outward, applied(back[k], n[k - 1]), n[k])
            n[k] = np.where(site.alive, n[k], 0)
        tails = [np.add(site.alive & ~end, begin == k, dtype=np.int8)
                 for k, (site, end) in enumerate(zip(self.sites, ends))]
        return n, tails

    def penalized(self, site):
        """beta at a site plus a penalty for the reach there, which makes the bound larger."""
        reach = site.reach
        more = (self.penalties[0] + self.penalties[1] * reach) * reach
        block = combined(self.shape.forms, (self.magnitude + self.H) * more - self.P * site.s)
        block[self.diagonal] += 2
        return block

    def tail(self):
        found = np.zeros((len(self.shape.forms), self.l.size))
        found[self.diagonal] = self.l
        return found

    def recursion_inwards(self, ends):
        """The recursion from each lane's end: the inverses, from which site of each lane on it has
        not failed, and the blocks."""
        back, blocks, tail = [], [], self.tail()
        good, whole = np.ones_like(self.alive), np.full(self.l.shape, len(ends) - 1)
        inverse = tail
        for k in range(len(ends) - 1, -1, -1):
            blocks.append(self.penalized(self.sites[k]))
            if self.even and k == 0:
                blocks[-1] /= 2
            inverse, definite = inverted(blocks[-1] - np.where(ends[k], inverse, tail))
            back.append(inverse)
            good = good & (definite | ~self.sites[k].alive)
            whole[good] = k - 1
        return back[::-1], whole, blocks[::-1]

    def recursion_outwards(self, ends, back, whole, blocks):
        """The recursion from the other lane: the inverses; where it begins anew; and at each site
        minus the lowest eigenvalue of both recursions together, infinite where that is not negative
        or the recursion from the lane's end has failed."""
        tail, (N, lanes) = self.tail(), (len(ends), self.l.size)
        begins, scores = np.empty((N, lanes), bool), np.empty((N, lanes))
        good, inverse = self.other((whole < 0) & self.sites[0].alive), self.other(back[0])
        good |= self.even
        span = max(1, BLOCK // lanes)
        ahead = blocks
        for start in range(0, N, span):
            joints = []
            for k in range(start, min(start + span, N)):
                np.logical_not(good, out=begins[k])
                inner = blocks[k] - np.where(good, inverse, tail)
                beyond = back[k + 1] if k + 1 < N else tail
                joints.append(inner - np.where(ends[k], beyond, tail))
                inverse, good = inverted(inner)
                ahead[k] = inverse
            low = least_eigenvalue(stacked(joints))
            at = np.arange(start, start + len(joints))[:, None]
            counts = stacked([site.alive for site in self.sites[start:start + span]]) \
                & (at >= whole) & (low < 0)
            scores[start:start + span] = np.where(counts, -low, math.inf)
        return ahead, begins, scores

    def plainest(self, begins, scores):
        """The site of each lane where n is an eigenvector, or -1."""
        N, lanes = scores.shape
        scores, starts = np.ascontiguousarray(scores.T), begins.T.copy()
        starts[:, 0] = True
        starts = np.flatnonzero(starts)
        best = np.minimum.reduceat(scores.ravel(), starts)
        first = np.searchsorted(starts, np.arange(lanes) * N)       # segment of each lane
        # A segment that spans both lanes is one.
        spans = ~begins[0] & self.other(~begins[0])
        near = best[first]
        farther = (near > self.other(near)) | (near == self.other(near)) \
            & (np.arange(lanes) >= self.size)
        best[first[spans & farther]] = math.inf
        best[best == math.inf] = 0
        best = np.maximum.reduceat(best, first)
        mine, others = best, self.other(best)
        chosen = (mine > 0) & ((mine > others) | (mine == others)
                               & (np.arange(lanes) < self.size))
        return np.where(chosen, (scores == best[:, None]).argmax(axis=1), -1)

    def joint_form(self, place, ends, ahead, back):
        """Both recursions together at these sites."""
        def at(arrays, places):
            return np.stack([arrays[k][:, lane] for lane, k in enumerate(places)], axis=-1)

        N, tail = len(ends), self.tail()
        beyond = np.where(np.stack(ends)[place, np.arange(place.size)],
                          at(back, np.minimum(place + 1, N - 1)), tail)
        return inverted(at(ahead, place))[0] - beyond

    def expand(self):
        """The left side of (C3): its value at X and P, the coefficients of a polynomial, the sum
        of their absolute values, which bounds it over the cube, and a bound of the difference from
        value and polynomial, infinite where there is none."""
        N, shape = len(self.sites), self.shape
        n, tails = self.test_vectors()
        sums = Sums(self.known, shape.parameters, self.l.size)
        mu = mu1 = np.zeros((shape.angles, 1 + self.known, self.l.size))    # here, and beyond
        terms, span = 0 * mu[:, 0], max(1, BLOCK // self.l.size)
        for start in reversed(range(0, N if any(x.any() for x in n) else 0, span)):
            sites, n0 = self.sites[start:start + span], stacked(n[start:start + span])
            n1 = stacked([*n[start + 1:start + span + 1], 0 * n[0]][:len(sites)])
            omega = shape.along(n0) ** 2
            if self.even and not start:     # half of the site x[0]; of 2 |n|^2 see below
                omega[:, 0] /= 2
            mus, A, B, mu, mu1 = self.multipliers(sites, omega, mu, mu1)
            terms = self.add_sites(sums, Sites.block(sites), n0, n1, omega,
                                   stacked(tails[start:start + span]), mus, A, B)
        sums.low -= scalar(n[0], n[0] if self.even else self.other(n[0]))
        sums.join(self.joined)
        if self.even:                   # x[1] and beyond are without n and mu
            mu, mu1, terms = [np.concatenate((0 * x, x), axis=-1) for x in (mu, mu1, terms)]
        self.add_ends(sums, mu, mu1, terms)
        value = sums.value + sums.low
        form = sums.form()
        added = sum([np.abs(x) for x in form.values()])
        chain = (len(self.P) + 2) * (span + -(-N // span))  # terms one after the other: (C19)
        mass = 96 * sums.mass + 256 * sums.bent + chain * (sums.bent + REST_MAX) + 96 * added
        error = (sums.error + UNIT * mass) * (SUM_ROUNDING + 64 * UNIT * N)
        return value, form, added, np.where(sums.mass + sums.bent < MASS_MAX, error, math.inf)

    def multipliers(self, sites, omega, mu, mu1):
        """Step (C7), from the last of these sites inwards: mu of each and of the one beyond, A and
        B; and mu of the next two."""
        shape, P, h, found = self.shape, self.P, self.h, []
        moving = [(w, m) for w in range(shape.count) for m in shape.moving[w]]
        for site, squares in zip(sites[::-1], np.moveaxis(omega, -2, 0)[::-1]):
            m = shape.along(mu)
            A, B = m * site.c[:, None], -m * site.s[:, None]
            A[:, 0] -= squares * site.s
            B[:, 0] -= squares * site.c
            found.append((mu, mu1, A, B))
            slopes = P[:, None] * B
            slopes[:, 1:] -= (P * A[:, 0])[:, None] * site.columns
            for w, symbol in moving:
                slopes[w, 1 + symbol] += h[w, symbol] * B[w, 0]
            mu, mu1 = 2 * mu - mu1 + combined(shape.forces, slopes), mu
        before, beyond, A, B = [stacked([x[i] for x in found[::-1]]) for i in range(4)]
        return (before, beyond), A, B, mu, mu1

    def add_sites(self, sums, site, n0, n1, omega, tails, mus, A, B):
        """Adds a block of sites, with the vectors n0 there and n1 beyond each; returns the sum of
        the sizes of the terms of G at the first: step (C18)."""
        shape, P, H, W = self.shape, self.P[:, None], self.H[:, None], self.W[:, None]
        E, size, reach = site.E, site.size, site.reach
        magnitude, long, (mu, mu1) = np.abs(P), scalar(n0, n0), mus
        sums.add(2 * long - (P * omega * site.s).sum(axis=0) - self.l * tails * long
                 - 2 * scalar(n0, n1) + scalar(mu[:, 0], E))
        sums.linear += scalar(mu[:, 1:], E).sum(axis=1)
        sums.add_waves(shape, P, self.h, site.columns, A, B)
        most = np.abs(mu).sum(axis=1)
        K, square = shape.K[:, None, None], shape.square[:, None, None] * long
        weight = K * (combined(shape.sizes, most) + square)
        left = remainder(P, H, W, A[:, 0], np.abs(A[:, 1:]).sum(axis=1), B[:, 0],
                         np.abs(B[:, 1:]).sum(axis=1), weight, size, site.rest, reach)
        sums.error += left.sum(axis=(0, 1))
        sums.mass += (2 * long + (K * magnitude * square).sum(axis=0)).sum(axis=0)
        sums.bent += (weight * (magnitude * reach * reach + 3 * H)).sum(axis=(0, 1))
        terms = combined(shape.strengths, weight * (magnitude * (1 + size) + H)) \
            + 2 * most + np.abs(mu1).sum(axis=1)
        # The last but one: what E is off by, (C18).
        off = self.push[:, None] + applied(self.F[:, None], site.far)
        small = most * off + shape.grain * terms * site.far
        sums.error += small.sum(axis=(0, 1))
        return terms[:, 0]

    def add_ends(self, sums, G, mu, terms):
        """Adds the terms of x[1] and x[0], where the lanes meet: G and mu there, and the sum of the
        sizes of the terms of G, without mu of the other lane."""
        across = self.other(mu)
        G, terms = G - across, terms + np.abs(across).sum(axis=1)
        small = np.abs(G).sum(axis=1) * self.rounding \
            + self.shape.grain * terms * (np.abs(self.ends).sum(axis=1) + self.rounding)
        sums.error += self.joined(small.sum(axis=0))
        sums.ends = self.joined(np.stack([scalar(G, side) for side in self.ends.swapaxes(0, 1)]))

    def bound(self):
        """An upper bound of the left side of (C3) for each prism; and about how much each symbol
        adds to it, which decides where to cut."""
        value, form, most, error = self.expand()
        last = np.where(self.alive, self.moved(self.sites[-1].columns), self.last)
        share = self.joined(last) + UNDERFLOW_MARGIN
        share = share / share.sum(axis=0)
        moved = np.stack([sum([np.abs(x) for key, x in form.items() if k in key])
                          for k in range(self.known)])
        # The second term: so that symbols that move the ends count.
        more = np.where(error < math.inf, error, 0) + moved.sum(axis=0) / 64
        return value + (most + error), np.where(value < 0, moved + more * share, share)


def least_in_double(criterion, cell):
    """l from below as a double: the quotient is rounded to nearest, the rest lowers it."""
    return criterion.least_pivot(cell) / criterion.fixed.one * (1 - 2.0 ** -50)


def middle_of(claim):
    """The point about which V is even for all parameters, in units of 2^-64 turns, if this is x* up
    to WHOLE_ERROR: step (C32).  Else None."""
    low, high = fixed_of(256).around_pi
    quarters = [round(2 * x / low) for x in claim.xstar]
    even = all((Fraction(dot(wave.k, quarters), 2) + wave.phase) % 1 == Fraction(1, 2)
               for wave in claim.waves)
    near = all(max(abs(x - q * pi / 2) for pi in (low, high)) <= WHOLE_ERROR
               for x, q in zip(claim.xstar, quarters))
    return [q << 62 for q in quarters] if even and near else None


class Lockstep:
    """The fast path of some claims; each prism belongs to one of them."""

    def __init__(self, claims):
        """Converts the claims to doubles; ValueError if one has numbers that are too large, or no
        wave."""
        if not all(claim.examined for claim in claims):
            raise ValueError("no wave: orbits without end")
        reduced = [claim.reduced for claim in claims]
        if len({len(claim.xstar) for claim in reduced}) > 1:
            reduced = [replace(claim, waves=claim.examined) for claim in claims]
        claims = reduced
        self.batch, self.memory = BATCH, MEMORY_MAX
        # The axes of the symbols; parts that underflow move nothing.
        moving = {axis for claim in claims for axis in axes_of(claim, float)}
        self.axes = [axis for axis in (2, 3, 4, *ANGLE_AXES) if axis in moving]
        self.take_waves(claims)
        self.take_regions(claims)
        sizes = [x for claim in claims for x in (
            *claim.xstar, *claim.centre, *claim.frame,
            *[x / 2 for x in itertools.chain(*claim.moves)])]
        amplitudes = [abs(x) for claim in claims for wave in claim.waves
                      for x in (wave.middle, *wave.parts)]
        if max(map(abs, sizes)) > FAST_SIZE_MAX or max(amplitudes) > AMPLITUDE_MAX:
            raise ValueError("too large for the fast path")

    def take_waves(self, claims):
        """The waves of all claims, and by wave and claim how often it is there, its middle and, by
        axis of cells, its parts, in units of 2^-AMPLITUDE_BITS turns."""
        waves = list(dict.fromkeys((wave.k, wave.phase % 2) for claim in claims
                                   for wave in claim.waves))
        if len(waves) > FAST_WAVES_MAX:
            raise ValueError("too many waves for the fast path")
        shape = len(waves), len(claims)
        self.present = np.zeros(shape)
        self.middle, self.parts = np.full(shape, 0, object), np.full((6, *shape), 0, object)
        for q, claim in enumerate(claims):
            for wave in claim.waves:
                w = waves.index((wave.k, wave.phase % 2))
                self.present[w, q] += 1
                self.middle[w, q] += units_of(wave.middle, AMPLITUDE_BITS)
                for axis, part in enumerate(wave.parts, 2):
                    self.parts[axis, w, q] += units_of(part, AMPLITUDE_BITS)
        self.shape = Shape(waves, [(w, m) for m, axis in enumerate(self.axes)
                                   for w in self.parts[axis].any(axis=1).nonzero()[0]],
                           len(self.axes))

    def take_regions(self, claims):
        """The regions of all claims, and x*, in units of 2^-64 turns: the centres, and what moves
        them along each axis of cells, rounded down."""
        def units(along):
            return [math.floor(v * (1 << 63)) for v in along]

        self.centre = np.array([units(claim.centre) for claim in claims], object).T
        self.moves = np.array([[units(along) for along in claim.moves] for claim in claims],
                              object).transpose(1, 2, 0)
        self.rows = np.array([claim.rows for claim in claims], object).transpose(1, 2, 0)
        middles = [middle_of(claim) for claim in claims]
        self.even = None not in middles
        self.xstar = wrapped(np.array(middles if self.even else [
            [units_of(x, 64) for x in claim.xstar] for claim in claims], object).T)

    def box(self, index, cuts, number):
        """Boxes that cover these cells of the claims with these numbers, as Prisms takes them."""
        cells = *self.placed(index, cuts), number
        A, h, W = self.amplitudes(*cells)
        return in_turns(A), h, W, *self.successors(*cells)

    @staticmethod
    def placed(index, cuts):
        """at and cuts, and part: at / 2^cuts, the middle of a cell, and part, its half-width, both
        for the half-width 1 of the claim, are exact."""
        at = 2 * index + 1 - (1 << cuts)
        return at.astype(object), cuts.astype(object), np.ldexp(1.0, -cuts.astype(np.intc))

    def amplitudes(self, at, cuts, part, number):
        """The amplitudes in units of 2^-AMPLITUDE_BITS turns, h and W of the waves of these cells.

        Each time that a claim names a wave, the amplitude is off by less than 1.1 units for the
        middle, and by 2.1 for each part, in all by 7.4 units, 0.73 2^-94 radians.  A part is off by
        1.1 units, less than 2^-97 radians, and by 2.4 u of it.
        """
        A = np.full((self.shape.count, number.size), 0, object)
        W, h = np.zeros(A.shape), np.zeros((len(A), self.shape.parameters, number.size))
        for w, (here, middle, parts) in enumerate(zip(self.present, self.middle,
                                                      self.parts.swapaxes(0, 1))):
            A[w] = middle[number]
            for m, axis in enumerate(self.axes):
                if parts[axis].any():
                    along = parts[axis, number]
                    A[w] += along * at[axis] >> cuts[axis]
                    h[w, m] = along.astype(float) * (TWO_PI * AMPLITUDE_UNIT) * part[axis]
            W[w] = here[number] * 2.0 ** -93 + 3 * UNIT * np.abs(h[w]).sum(axis=0)
        return A, h, W

    def successors(self, at, cuts, part, number):
        """X[1] of these cells, its columns, and the error of x[1].

        In turns, the centre and what each axis adds are off by 1 and 3 units, of which the frame
        makes as many as its entries; and a column is off by 5 u of its terms.
        """
        V, frame = self.centre[:, number], self.rows[..., number]
        columns = np.zeros((len(V), len(self.axes), number.size))
        for m, axis in enumerate(self.axes):
            along = self.moves[axis][:, number]
            V = V + (along * at[axis] >> cuts[axis])
            columns[:, m] = along.astype(float) * (TWO_PI / 2.0 ** 64) * part[axis]
        X = wrapped((frame * V).sum(axis=1))
        frame = frame.astype(float)
        sizes = np.abs(frame)
        columns, terms = [(f[:, :, None] * x).sum(axis=1) for f, x in (
            (frame, columns), (sizes, np.abs(columns)))]
        off = WHOLE_ERROR * (1 + 3 * len(self.axes)) * sizes.sum(axis=1) \
            + 6 * UNIT * terms.sum(axis=1)
        return X, columns, off

    def attempt(self, index, cuts, number, l, penalties, halved=None):
        """Is (C3) true of all orbits of these cells?  Returns an answer for each, and the axis
        along which to cut it, or -1 if no cut is needed or will help; None if their orbits are too
        long for a batch of this size.  halved: how often each cell was halved along each axis."""
        with np.errstate(all="ignore"):
            prisms = Prisms(self.box(index, cuts, number), self.shape, self.xstar[:, number], l,
                            penalties, self.memory, self.even)
            for ready in prisms.follow():
                if not ready:
                    return None
                bound, blame = prisms.bound()
                prisms.excluded |= bound < 0
                if prisms.excluded.all():
                    break
        most = prisms.sites_max * prisms.size / (LENGTH_MARGIN * len(prisms.sites))
        self.batch = min(max(int(most), BATCH_MIN), BATCH)
        vain = prisms.joined(prisms.sites[-1].alive) & (len(prisms.sites) == MAX_SITES)
        axis, often = np.full(prisms.size, -1), (0 * cuts if halved is None else halved)[self.axes]
        cut = np.flatnonzero(~(prisms.excluded | vain))
        axis[cut] = [self.axes[worst_axis(*both)] for both in zip(
            blame[:, cut].T.tolist(), often[:, cut].T.tolist())]
        return prisms.excluded, axis

    def settle(self, cells, least, exactly):
        """Decides on cells, pairs of a claim's number and a cell, with these l: (number of the
        first that is not excluded, why not) or None, and how many pieces each took.

        Cells that fail are halved and tried again, up to the checker's limits and with each of
        SITE_PENALTIES in turn (n spreads over few sites if their reach is penalized, over many if
        its square is).  Cells with the fewest cuts come first, as orbits of one length go well
        together.  Cells that fail then are decided by exactly(number) -> (None or why not, pieces).
        """
        begun = np.array([cuts for _, (_, cuts) in cells]).T
        pieces, refused, todo = np.zeros(len(cells), int), None, self.pieces_of(cells, least)
        fine = sorted(set(range(len(cells))) - set(todo[-1].tolist()))
        while True:
            for n in fine:
                if refused is None or n < refused[0]:
                    why, tried = exactly(n)
                    pieces[n] += tried
                    refused = (n, why) if why else refused
            keep = ~np.isin(todo[-1], fine) & (todo[-1] < (refused[0] if refused else len(cells)))
            if not keep.any():
                return refused, pieces.tolist()
            todo = [x[..., keep] for x in todo]
            batch, later = [[x[..., part] for x in todo] for part in (
                slice(self.batch), slice(self.batch, None))]
            index, cuts, claim, l, number = batch
            halved = cuts - begun[:, number]
            halvings = halved.sum(axis=0)
            tried = self.attempt(index, cuts, claim, l,
                                 np.array(SITE_PENALTIES)[halvings % len(SITE_PENALTIES)].T, halved)
            if tried is None:
                self.batch, fine = self.batch // 2, []
                continue
            pieces += np.bincount(number, minlength=len(cells))
            excluded, axis = tried
            lost = ~excluded & ((axis < 0) | (halvings >= MAX_HALVINGS)
                                | (pieces[number] >= MAX_PIECES)
                                | (cuts[axis, np.arange(axis.size)] >= FAST_CUTS_MAX))
            fine = sorted(set(number[lost].tolist()))
            todo = [np.concatenate(both, axis=-1) for both in zip(
                halves([x[..., ~excluded] for x in batch], axis[~excluded]), later)]

    def pieces_of(self, cells, least):
        """The cells with an l whose numbers are exact in doubles and whose amplitudes are at most
        FAST_SIZE_MAX, those with the fewest cuts first: as arrays of index, cuts, the claim's
        number, l and the cell's number."""
        some = sorted([n for n, (_, (_, cuts)) in enumerate(cells)
                       if max(cuts) <= FAST_CUTS_MAX and least[n] is not None],
                      key=lambda n: sum(cells[n][1][1]))
        index, cuts = [np.array([cells[n][1][part] for n in some], np.int64).reshape(-1, 6).T
                       for part in (0, 1)]
        number = np.array([cells[n][0] for n in some], int)
        A, h, _ = self.amplitudes(*self.placed(index, cuts), number)
        size = np.abs(A).astype(float) * (TWO_PI * AMPLITUDE_UNIT) + np.abs(h).sum(axis=1)
        return [x[..., (size <= FAST_SIZE_MAX).all(axis=0)] for x in (
            index, cuts, number, np.array([least[n] for n in some]), np.array(some, int))]


def halves(pieces, axis):
    """The halves of these pieces along these axes."""
    index, cuts, *others = [x.repeat(2, axis=-1) for x in pieces]
    axis, at = axis.repeat(2), np.arange(2 * axis.size)
    index[axis, at] = 2 * index[axis, at] + at % 2
    cuts[axis, at] += 1
    return index, cuts, *others


def make_lockstep(claims):
    """The fast path, or None: the claims' numbers are too large for it, or the machine lacks what
    it needs; then a line on stderr says so."""
    try:
        if import_numpy_if_sound():
            return Lockstep(claims)
        why = "numpy does not round as it must"
    except ImportError:
        why = "numpy is not installed"
    except (ValueError, OverflowError):
        return None
    complain(why + ": all is checked in integers, dozens of times slower")
    return None
