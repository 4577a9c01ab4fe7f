"""The fast path: a thousand prisms in lockstep, in doubles.

The same bound as in exact.py, steps (C4) to (C8) of docs/proofs/checker.md, where rounding errors
are bounded by steps (C9) to (C20).  A leaf that is not excluded here is left to the integers.
Each operation is done to all prisms together, as arrays of numpy, whose operations round to nearest
(import_numpy_if_sound tests this).
"""

import collections
import functools
import itertools
import math
import random
from fractions import Fraction

from .arith import fixed_of, turn_of, turned
from .limits import FIRST_TRY_SITES, MAX_HALVINGS, MAX_PIECES, MAX_SITES, SITE_PENALTIES
from .progress import complain
from .tree import worst_axis

np = None                               # numpy, once the fast path is wanted
UNIT = 2.0 ** -53                       # the unit roundoff u of doubles
TWO_PI = 2 * math.pi                    # within 0.35 u of 2 pi, relatively

# Of the bound; docs/proofs/checker.md needs these values.
SINE_ROUNDING = 24 * UNIT               # error of a sine or cosine, divided by |k0| + |k1|: (C11)
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
    """The waves of the fast path without their amplitudes: their k and phases, after (1, 0) and
    (0, 1); which of them are present in a lane, and which symbols move their amplitudes."""

    def __init__(self, waves, moving=(), parameters=0):
        """waves: (k, phase) of each wave that is present; moving: pairs (number of such a wave,
        symbol that moves its amplitude); parameters: the least number of symbols, of which some
        may move x[1] alone."""
        self.known = [((1, 0), 0), ((0, 1), 0)]
        self.known += [wave for wave in waves if wave not in self.known]
        at = self.at = [self.known.index(wave) for wave in waves]   # their numbers here
        self.present = sorted(at)
        self.moving = [[m for w, m in moving if at[w] == here] for here in range(len(self.known))]
        self.parameters = max([parameters] + [1 + m for _, m in moving])
        k = np.array([k for k, _ in self.known], float)
        self.K = abs(k).sum(axis=1)
        self.square = (k * k).sum(axis=1)
        self.grain = (64 + 16 * len(k)) * UNIT
        self.k = k.astype(np.int64)
        self.phases = np.array([[(round(phase * (1 << 63)) + (1 << 63)) % (1 << 64) - (1 << 63)]
                                for _, phase in self.known], np.int64)
        p, q = k.T
        self.forces = self.table(p, q)              # V' from waves
        self.strengths = self.table(abs(p), abs(q))
        self.stiff = self.table(                    # S_00, S_01, S_11
            *(abs(x) * self.K for x in (p * p, p * q, q * q)))
        self.strong = self.table(abs(p) * self.K, abs(q) * self.K)
        self.forms = self.table(p * p, p * q, q * q)
        self.mixed = self.rows(k[2:])               # k.x of x
        # Of a site of a lane: s, c, columns, rest, E; the inverses of both recursions, n, scores,
        # and five numbers of a byte.
        self.site_bytes = 8 * (len(k) * (5 + self.parameters) + 2 + 6 + 2 + 2) + 5
        self.sizes = self.rows(abs(k))

    def table(self, *rows):
        """The rows, of a number for each wave, as combined() takes them."""
        return [[(w, row[w]) for w in self.present if row[w]] for row in rows]

    @staticmethod
    def rows(columns):
        return [[(i, x) for i, x in enumerate(row) if x] for row in columns]

    def in_frame(self, turn):
        """In that frame of the errors: the absolute values of V' from waves, and of k.x from x."""
        k = np.array([turned(turn, k) for k, _ in self.known], float)
        return self.table(*abs(k.T)), self.rows(abs(k) / (turn[0] ** 2 + turn[1] ** 2))

    def along(self, v):
        """k.v for all waves."""
        if not self.mixed:
            return v
        found = np.empty((len(self.known), *v.shape[1:]))
        found[:2] = v
        found[2:] = combined(self.mixed, v)
        return found

    def angles(self, X):
        """The angles of the waves, of X in units of 2^-64 turns, as X modulo one turn."""
        return self.k @ X + self.phases


def inverted(d):
    """The inverses of symmetric matrices, as far as there are any, and which are definite."""
    det = d[0] * d[2] - d[1] * d[1]
    inverse = d[::-1] * (1 / det)
    np.negative(inverse[1], out=inverse[1])
    return inverse, (d[0] > 0) & (det > 0)


def applied(d, v):
    return d[:2] * v[0] + d[1:] * v[1]


def products(rows):
    """The products of rows i <= j, in order."""
    found, at = np.empty((len(rows) * (len(rows) + 1) // 2, *rows.shape[1:])), 0
    for i, row in enumerate(rows):
        np.multiply(row, rows[i:], out=found[at:at + len(rows) - i])
        at += len(rows) - i
    return found


def least_eigenvalue(d):
    return (d[0] + d[2] - np.sqrt((d[0] - d[2]) ** 2 + 4 * d[1] * d[1])) / 2


def least_eigenvector(d):
    (p, q, r), low = d, least_eigenvalue(d)
    v = np.where(p > r, np.stack((q, low - p)), np.stack((low - r, q)))
    length = np.sqrt(v[0] * v[0] + v[1] * v[1])
    return np.where(length > 0, v / np.where(length > 0, length, 1), np.stack((p <= r, p > r)))


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


class Sites(collections.namedtuple("Sites", "alive s c columns rest E")):
    """A site of all lanes, in the words of docs/proofs/checker.md: the lanes that have it; s, c,
    k.L as columns of the symbols and the rest of each wave; E of step (C7).  Or a block of sites,
    in arrays whose last axes are the sites and the lanes."""

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


def next_rest(d, f, r, r0, err, along, beside):
    """Steps (C5) and (C15): f of a site q, with M and the determinant of d, from d and f of the
    site before it, the rests r of q and r0 of that site, and the error err of the step from q.
    The roundings of beta multiply r by along, and its other coordinate by beside."""
    diagonal, square = d[0] * d[2], d[1] * d[1]
    det = diagonal - square
    inv = 1 / det
    M = d[::-1] * inv
    np.negative(M[1], out=M[1])
    m, inv, sizes = np.abs(M), np.abs(inv), np.abs(d)
    f = applied(m, f) + err + along * r + beside * r[::-1] \
        + 8 * UNIT * inv * ((np.abs(diagonal) + square) * r0
                            + sizes[1] * (sizes[0] + sizes[2]) * r0[::-1])
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
        for w in shape.present:
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
                     "skew", "ends"):
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
    before those back."""

    def __init__(self, box, shape, xstar, l, penalties=SITE_PENALTIES[0], memory=MEMORY_MAX):
        """The box: amplitudes as in_turns() gives them, h (by wave and symbol) and W of the waves,
        X[1], its columns (by coordinate and symbol, of which the last two span the parallelogram)
        and the error of x[1], in radians; the Shape; x*; l; and penalties (see SITE_PENALTIES).
        X[1] and x* are in units of 2^-64 turns.  memory: bytes that the sites may take."""
        turns, h, W, x, columns, off = box
        self.size, self.shape = x.shape[1], shape
        self.turns = [self.both(part, part) for part in turns]
        self.P, self.h, self.W = self.turns[-1] * TWO_PI, self.both(h, h), self.both(W, W)
        self.H = np.abs(self.h).sum(axis=1) * SUM_ROUNDING
        self.magnitude, self.l = np.abs(self.P), self.both(l, l)
        self.penalties = [self.both(x + 0 * l, x + 0 * l) for x in penalties]
        self.absent = (self.magnitude == 0) & (self.H == 0) & (self.W == 0)     # in these lanes
        self.reach_max = np.where(self.absent, math.inf, REACH_MAX)[shape.present]
        self.known, self.angles = shape.parameters + 2, shape.parameters
        self.pairs = list(itertools.combinations_with_replacement(range(self.known), 2))
        self.halves = np.array([[0.5 if i == j else 1] for i, j in self.pairs])
        self.bound_roundings()
        start, blank, rounding = xstar + 0 * x, 0 * columns, np.full_like(off, WHOLE_ERROR)
        self.ends, self.rounding = self.both(columns, blank), self.both(off, rounding)
        a, b = map(abs, self.turn)
        off, rounding = [np.stack((a * u + b * v, b * u + a * v)) for u, v in (off, rounding)]
        self.before = self.both(start, x), self.both(blank, columns), self.both(rounding, off)
        self.first = self.both(x, start), self.both(columns, blank), self.both(off, rounding)
        self.sites, self.excluded = [], np.zeros(self.size, bool)  # which are not followed further
        self.sites_max = memory // (2 * self.size * shape.site_bytes)
        self.begin()

    def bound_roundings(self):
        """The frame of the rests, and what the roundings of a step are multiplied by: (C12) to
        (C14)."""
        shape = self.shape
        self.turn = q0, q1 = turn_of([(k, x) for (k, _), x in zip(shape.known,
                                                                  self.magnitude.mean(axis=1))])
        self.strengths, self.sizes = shape.in_frame(self.turn)
        stiff = combined(shape.stiff, self.magnitude)
        self.F, self.F01 = shape.grain * (1 + stiff[::2]), shape.grain * stiff[1]
        self.from_H = shape.grain * combined(shape.strong, self.H)
        # Of the step of the centre.
        self.push = FORCE_ROUNDING * combined(shape.strengths, self.magnitude) \
            + WHOLE_ERROR * abs(shape.k).sum()
        # Of beta in that frame.
        self.along, self.beside = (self.F[0] + self.F[1],) * 2 if q1 else (self.F, self.F01)

    @staticmethod
    def both(ahead, back):
        return np.concatenate((ahead, back), axis=-1)

    def other(self, lanes):
        return np.roll(lanes, self.size, axis=-1)

    def joined(self, lanes):
        return lanes[..., :self.size] + lanes[..., self.size:]

    def begin(self):
        """The lanes at their first sites.  LT: L, then T, as columns; near: a bound of L e + T(e)
        in each coordinate; a 0 stands for the site before."""
        (self.X0, L0, self.r0), (self.X, L, self.r) = self.before, self.first
        none = np.zeros((2, len(self.pairs), L.shape[-1]))
        self.LT0, self.LT = [np.concatenate((x, none), axis=1) for x in (L0, L)]
        self.near0, self.d, self.f = np.abs(L0).sum(axis=1), None, None
        self.alive = self.regular = np.ones(L.shape[-1], bool)
        self.measure()
        self.last = self.moved(self.columns)        # how far each symbol moves a lane's last site

    def moved(self, columns):
        """How far each symbol moves a site: the sum over the waves of a lane."""
        return np.where(self.absent[:, None], 0, np.abs(columns))[self.shape.present].sum(axis=0)

    def follow(self):
        """Follows all lanes until each reaches too far.  Yields True at the end and where (C3) is
        to be tried earlier; False if the memory is full.

        An early try costs as much as the try at the end.  So there is one only if, for the majority
        of the lanes, the reach grew by less than EARLY_TRY_GROWTH since the last, as near elliptic
        orbits, which end late.
        """
        due, reached = FIRST_TRY_SITES, 0
        while True:
            near = (self.reach[self.shape.present] <= self.reach_max).all(axis=0)
            self.end(self.alive & ~(self.regular & near))
            count = len(self.sites)
            if count and (not self.alive.any() or count == MAX_SITES):
                yield True
                return
            if count >= self.sites_max and self.size > BATCH_MIN:
                yield False
                return
            farthest = self.reach[self.shape.present].max(axis=0)
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
        shape, known = self.shape, self.known
        waves = shape.along(self.LT)
        self.columns, far = waves[:, :known].copy(), np.abs(waves)
        size = far[:, :known].sum(axis=1) * SUM_ROUNDING
        curve = (self.halves * far[:, known:]).sum(axis=1)
        rest, self.near = curve + combined(self.sizes, self.r), size[:2] + curve[:2] * SUM_ROUNDING
        if shape.mixed:
            rest[2:] += 3 * UNIT * combined(shape.sizes[2:], self.near)
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
        s, c, near, low = lockstep_sincos(shape.angles(self.X))
        beta = combined(shape.forms, P * -s)
        beta[::2] += 2
        LT = applied(beta[:, None], self.LT) - self.LT0
        mean = self.add_forces(LT, s, c)
        self.sites.append(Sites(self.alive, s, c, self.columns, self.rest,
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
        for w in self.shape.present:
            symbols = self.shape.moving[w]
            form, mean[w] = quadratic(self.pairs, self.columns[w], self.P[w] * c[w],
                                      [(m, h[w, m] * s[w]) for m in symbols])
            forces = [(m, h[w, m] * c[w]) for m in symbols]
            for i, k in enumerate(self.shape.known[w][0]):
                if k:
                    LT[i, known:] -= form if k == 1 else k * form
                    for m, wave in forces:
                        LT[i, m] += wave if k == 1 else k * wave
        return mean

    def next_rests(self, beta, s, c):
        """The rests of the next site, steps (C5), (C6) and (C13) to (C15), from beta and the
        absolute values of sines and cosines."""
        shape, F, (q0, q1), r = self.shape, self.F, self.turn, self.r
        slack, near = SINE_ROUNDING * shape.K[:, None], self.near
        bent = bending(self.P, self.H, self.W, s + slack, c + slack, self.size_, self.rest,
                       self.reach)
        err = self.push + F * near + self.F01 * near[::-1] + self.from_H \
            + (4 + len(s)) * UNIT * self.near0
        err = combined(self.strengths, bent) + abs(q0) * err + abs(q1) * err[::-1]
        block = beta
        if q1:
            flat, skew, steep = [x / (q0 * q0 + q1 * q1) for x in (q0 * q0, q0 * q1, q1 * q1)]
            block = np.stack((flat * beta[0] + 2 * skew * beta[1] + steep * beta[2],
                              skew * (beta[2] - beta[0]) + (flat - steep) * beta[1],
                              steep * beta[0] - 2 * skew * beta[1] + flat * beta[2]))
        if self.d is None:                      # d[q] = beta, f = err - r[o] + roundings
            f, d = self.r0 + err + self.along * r + self.beside * r[::-1], block
        else:
            f, M, det = next_rest(self.d, self.f, r, self.r0, err, self.along, self.beside)
            self.regular, d = np.abs(det) > DETERMINANT_MIN, block - M
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
        block[::2] += 2
        return block

    def tail(self):
        return np.stack((self.l, 0 * self.l, self.l))

    def recursion_inwards(self, ends):
        """The recursion from each lane's end: the inverses, from which site of each lane on it has
        not failed, and the blocks."""
        back, blocks, tail = [], [], self.tail()
        good, whole = np.ones_like(self.alive), np.full(self.l.shape, len(ends) - 1)
        inverse = tail
        for k in range(len(ends) - 1, -1, -1):
            blocks.append(self.penalized(self.sites[k]))
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
        spans = ~begins[0] & ~self.other(begins[0])
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
        sums = Sums(self.known, self.angles, self.l.size)
        mu = mu1 = np.zeros((2, 1 + self.known, self.l.size))   # of this site, and the one beyond
        terms, span = 0 * mu[:, 0], max(1, BLOCK // self.l.size)
        for start in reversed(range(0, N if any(x.any() for x in n) else 0, span)):
            sites, n0 = self.sites[start:start + span], stacked(n[start:start + span])
            n1 = stacked([*n[start + 1:start + span + 1], 0 * n[0]][:len(sites)])
            omega = shape.along(n0) ** 2
            mus, A, B, mu, mu1 = self.multipliers(sites, omega, mu, mu1)
            terms = self.add_sites(sums, Sites.block(sites), n0, n1, omega,
                                   stacked(tails[start:start + span]), mus, A, B)
        self.add_ends(sums, mu, mu1, terms)
        sums.join(self.joined)
        x, y = n[0][:, :self.size], n[0][:, self.size:]
        value = sums.value + sums.low - 2 * (x[0] * y[0] + x[1] * y[1])
        form = sums.form()
        added = sum([np.abs(x) for x in form.values()])
        chain = (len(self.P) + 2) * (span + -(-N // span))  # terms one after the other: (C19)
        mass = 96 * sums.mass + 256 * sums.bent + chain * (sums.bent + REST_MAX) + 64 * added
        error = (sums.error + UNIT * mass) * (SUM_ROUNDING + 64 * UNIT * N)
        return value, form, added, np.where(sums.mass + sums.bent < MASS_MAX, error, math.inf)

    def multipliers(self, sites, omega, mu, mu1):
        """Step (C7), from the last of these sites inwards: mu of each and of the one beyond, A and
        B; and mu of the next two."""
        shape, P, h, found = self.shape, self.P, self.h, []
        moving = [(w, m) for w in shape.present for m in shape.moving[w]]
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
        (E0, E1), size, reach = site.E, site.size, site.reach
        magnitude, long, (mu, mu1) = np.abs(P), n0[0] ** 2 + n0[1] ** 2, mus
        sums.add(2 * long - (P * omega * site.s).sum(axis=0) - self.l * tails * long
                 - 2 * (n0[0] * n1[0] + n0[1] * n1[1]) + (mu[0, 0] * E0 + mu[1, 0] * E1))
        sums.linear += (mu[0, 1:] * E0 + mu[1, 1:] * E1).sum(axis=1)
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
        off = self.push[:, None] + self.F[:, None] * reach[:2] + self.F01 * reach[1::-1]
        small = most * off + shape.grain * terms * reach[:2]
        sums.error += small.sum(axis=(0, 1))
        return terms[:, 0]

    def add_ends(self, sums, G, mu, terms):
        """Adds the terms of x[1] and x[0], where the lanes meet: G and mu there, and the sum of the
        sizes of the terms of G, without mu of the other lane."""
        across = self.other(mu)
        G, terms = G - across, terms + np.abs(across).sum(axis=1)
        small = np.abs(G).sum(axis=1) * self.rounding \
            + self.shape.grain * terms * (np.abs(self.ends).sum(axis=1) + self.rounding)
        sums.error += small[0] + small[1]
        sums.ends = np.stack([G[0] * x + G[1] * y for x, y in zip(*self.ends)])

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


class Lockstep:
    """The fast path of some claims; each prism belongs to one of them."""

    def __init__(self, claims):
        """Converts the claims to doubles; ValueError if one has numbers that are too large, or no
        wave."""
        if not all(claim.examined for claim in claims):
            raise ValueError("no wave: orbits without end")
        self.batch, self.memory = BATCH, MEMORY_MAX
        # The axes of the symbols: of the parameters that move anything in doubles, and of v0, v1.
        self.axes = sorted({2 + m for claim in claims for wave in claim.examined
                            for m, part in enumerate(wave.parts) if float(part)}    # or underflow
                           | {2 + m for claim in claims for m, shift in enumerate(claim.shifts)
                              if any(shift)}) + [0, 1]
        self.take_waves(claims)
        self.take_regions(claims)
        sizes = [x for claim in claims for x in (
            *claim.xstar, *claim.centre, *claim.frame,
            *[x / 2 for x in itertools.chain(*claim.moves)])]
        amplitudes = [abs(x) for claim in claims for wave in claim.examined
                      for x in (wave.middle, *wave.parts)]
        if max(map(abs, sizes)) > FAST_SIZE_MAX or max(amplitudes) > AMPLITUDE_MAX:
            raise ValueError("too large for the fast path")

    def take_waves(self, claims):
        """The waves of all claims, and by wave and claim how often it is there, its middle and, by
        axis of cells, its parts, in units of 2^-AMPLITUDE_BITS turns."""
        waves = list(dict.fromkeys((wave.k, wave.phase % 2) for claim in claims
                                   for wave in claim.examined))
        shape = len(waves), len(claims)
        self.present = np.zeros(shape)
        self.middle, self.parts = np.full(shape, 0, object), np.full((5, *shape), 0, object)
        for q, claim in enumerate(claims):
            for wave in claim.examined:
                w = waves.index((wave.k, wave.phase % 2))
                self.present[w, q] += 1
                self.middle[w, q] += units_of(wave.middle, AMPLITUDE_BITS)
                for axis, part in enumerate(wave.parts, 2):
                    self.parts[axis, w, q] += units_of(part, AMPLITUDE_BITS)
        self.shape = Shape(waves, [(w, m) for m, axis in enumerate(self.axes[:-2])
                                   for w in self.parts[axis].any(axis=1).nonzero()[0]],
                           len(self.axes) - 2)

    def take_regions(self, claims):
        """The regions of all claims, and x*, in units of 2^-64 turns: the centres, and what moves
        them along each axis of cells, rounded down."""
        def units(along):
            return [math.floor(v * (1 << 63)) for v in along]

        self.centre = np.array([units(claim.centre) for claim in claims], object).T
        self.moves = np.array([[units(along) for along in claim.moves] for claim in claims],
                              object).transpose(1, 2, 0)
        self.frame = np.array([claim.frame for claim in claims], object).T.reshape(2, 2, -1)
        self.xstar = wrapped(np.array([[units_of(x, 64) for x in claim.xstar] for claim in claims],
                                      object).T)

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
        A = np.full((len(self.shape.known), number.size), 0, object)
        W, h = np.zeros(A.shape), np.zeros((len(A), self.shape.parameters, number.size))
        for w, here, middle, parts in zip(self.shape.at, self.present, self.middle,
                                          self.parts.swapaxes(0, 1)):
            A[w] = middle[number]
            for m, axis in enumerate(self.axes[:-2]):
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
        V, columns = self.centre[:, number], np.zeros((2, len(self.axes), number.size))
        for m, axis in enumerate(self.axes):
            along = self.moves[axis][:, number]
            V = V + (along * at[axis] >> cuts[axis])
            columns[:, m] = along.astype(float) * (TWO_PI / 2.0 ** 64) * part[axis]
        frame = self.frame[..., number]
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
                            penalties, self.memory)
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
        index, cuts = [np.array([cells[n][1][part] for n in some], np.int64).reshape(-1, 5).T
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
