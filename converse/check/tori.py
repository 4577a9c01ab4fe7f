"""Verifying a certificate of existence: steps (T1) to (T9) of docs/proofs/checker.md.

Doubles choose what may be chosen at will: approximate inverses, which a product of series then
judges, and how many modes and bits are used.  No bound rests on them.
"""

import cmath
import contextlib
import functools
import itertools
import math
import operator
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction

from .arith import GUARD, dot, fixed_of
from .failures import NotConfirmed, Rejected, named
from .field import (E_LOW, Divisors, Field, Norm, combination, exponential_above, rounded_down,
                    rounded_up, upper_root)
from .limits import MAX_BITS
from .processes import mapped
from .series import FINE, Box, Ring, conjugate, greatest, opposite, powers_of, turn
from .version import __version__
from .words import decimal_text, exact_text, map_lines, sum_text

MAX_LENGTH = 1 << 21                    # of a mode, with the weights alpha
MAX_WIDTH = 200                         # of the strip of a torus, times its longest mode
MAX_GRID = 1 << 22                      # numbers: entries of L on the grid where it is inverted
SHARES_OF_LOSS = [Fraction(x, 20) for x in (1, 2, 4, 8, 16)]        # s of the theorem
CHANGES = [Fraction(x, 1000) for x in (1, 2, 5, 10, 20, 40, 70, 100, 150)]     # t l0 m0 a0
ROUGH_BITS = 64                         # The series for the constants have these bits.
STEPS = 3                               # So many steps are followed one by one, if they must be.
FEW_MODES = 1 << 14                     # Any torus may need these. They take seconds.
INVERSE_MODES = 64                      # Modes of L^-1 per mode of u. Sparse tori needed 17.
TRIES = 6                               # The number of modes is raised at most so often.
POWERS = "", "t", "t^2", "t^3"
OMEGA_PLACES = 12                             # of the components of a rotation vector
FAR = "the torus is too far from the straight one"


# ---- the lattice of modes

def lattice(vectors, n):
    """A basis of the group that they generate, or of all integer vectors if its rank is below n."""
    rows, found = [list(v) for v in vectors], []
    for column in range(n):
        while True:
            rows = [row for row in rows if any(row)]
            some = sorted([row for row in rows if row[column]], key=lambda row: abs(row[column]))
            if len(some) < 2:
                break
            for row in some[1:]:
                factor = row[column] // some[0][column]
                row[:] = [x - factor * y for x, y in zip(row, some[0])]
        if not some:
            return [tuple([int(i == j) for j in range(n)]) for i in range(n)]
        found.append(tuple(some[0]))
        rows = [row for row in rows if row is not some[0]]
    return found


# ---- the theorem (T8)

@dataclass(frozen=True)
class Constants:
    """Bounds of the norms of L, L^-1, A^-1 and <A^-1>^-1, and of the coefficients of A^-1."""

    l: Fraction
    m: Fraction
    a: Fraction
    b: Fraction
    p: Fraction

    def after(self, t):
        """The same for a torus whose L differs by at most t; None, if there are none."""
        change = (2 * self.l + t) * t
        if self.m * t >= 1 or self.a * change >= 1:
            return None
        a = self.a / (1 - self.a * change)
        da = self.a * a * change
        if self.b * da >= 1:
            return None
        return Constants(*map(rounded_up, (self.l + t, self.m / (1 - self.m * t), a,
                                           self.b / (1 - self.b * da), self.p + da)))


def logarithm_below(x):
    """A rational not above log x, x > 1: 2 artanh((x - 1)/(x + 1))."""
    y = (x - 1) / (x + 1)
    return rounded_down(2 * sum([y ** j / j for j in range(1, 12, 2)]))


def allowed(constants, waves, rho, kappa, divisors, steps=0):
    """(e, v): if ||E|| <= e there is a torus, at most v ||E|| from the approximate one, in the norm
    of a hundredth of the strip.

    waves: (|p|, |k|, bound of ||e^(i k.x)||).  steps: of the iteration that are followed one by
    one, with the small divisors that are met in each.
    """
    best, scale = (Fraction(0), Fraction(0)), constants.l * constants.m * constants.a
    for share in SHARES_OF_LOSS:
        delta = rounded_down((rho - rho / 100) / (4 + 2 * share))
        deltas = [delta / 2 ** at for at in range(steps + 1)]
        losses = [divisors.loss_at(x) for x in deltas[:-1]] + [divisors.loss(deltas[-1])]
        for change in CHANGES:
            t = rounded_down(change / scale)
            if (c := constants.after(t)) is None:
                continue
            iteration = Iteration(c, t, waves, kappa, divisors.power, [
                (x, share * x, loss) for x, loss in zip(deltas, losses)])
            e = iteration.largest(best[0])
            if e > best[0]:
                best = e, rounded_up(iteration.moved(e) / e)
    return best


class Iteration:
    """The iteration of the theorem in a strip where L differs by at most t from that of the
    approximate torus, so that the constants are at most c.

    widths: (delta, s delta, loss) of the steps that are followed one by one and, last, of all
    others together.
    """

    def __init__(self, c, t, waves, kappa, n, widths):
        def derivative(width):
            return rounded_up(kappa / (E_LOW * width))

        self.t, self.most = t, 2 ** (4 * n)
        self.slow, self.fast = 1 - Fraction(2, 4 ** n), 1 - Fraction(1, 4 ** n)
        third = sum([p * k ** 3 * g * exponential_above(k * t) for p, k, g in waves])
        self.steps = []                 # Of each (move, slope, growth), per e, e and e^2.
        for delta, narrow, loss in widths:
            step = rounded_up(c.a * (1 + c.b * c.p) * loss ** 2)
            move = rounded_up(step * c.l ** 2)
            self.steps.append((move, derivative(narrow) * move, rounded_up(step * c.l * (
                (2 * c.m * c.l * derivative(delta) if n > 1 else 0)
                + derivative(2 * delta) + third * step * c.l ** 3 / 2))))

    def moved(self, e):
        """Bounds how far the torus moves in all, if the residual is e.  None, if it may be more
        than t, or the iteration need not converge."""
        *single, (move, slope, growth) = self.steps
        total = sloped = Fraction(0)
        for one_move, one_slope, one_growth in single:
            total, sloped = total + one_move * e, sloped + one_slope * e
            e = rounded_up(one_growth * e * e)
        total, sloped = total + move * e / self.fast, sloped + slope * e / self.slow
        return None if self.most * growth * e > 1 or max(total, sloped) > self.t else total

    def largest(self, least):
        """About the largest residual with a bound; if it is not above `least`, any such number."""
        move, slope, growth = self.steps[0]
        if len(self.steps) == 1:
            return rounded_down(min(1 / (self.most * growth), self.t * self.slow / slope,
                                    self.t * self.fast / move))
        e = rounded_down(1 / growth)
        while e > least and self.moved(e) is None:
            e = rounded_down(e * 7 / 10)
        return e


# ---- discrete Fourier transforms in doubles

def transform(values, sign):
    """The sum of values[j] e^(sign 2 pi i j k / N) for all k, N a power of two."""
    size = len(values)
    if size == 1:
        return values
    even, odd = transform(values[::2], sign), transform(values[1::2], sign)
    odd = list(map(operator.mul, roots_of_one(size, sign), odd))
    return list(map(operator.add, even, odd)) + list(map(operator.sub, even, odd))


@functools.lru_cache(maxsize=64)
def roots_of_one(size, sign):
    """e^(sign 2 pi i j / size) for j < size/2."""
    return [cmath.exp(sign * 2j * cmath.pi * j / size) for j in range(size // 2)]


def power_of_two(x):
    return 1 << max(x - 1, 0).bit_length()


def inverse_in_doubles(rows):
    if len(rows) == 1:
        return [1 / rows[0]]
    a, b, c, d = rows
    det = a * d - b * c
    return [d / det, -b / det, -c / det, a / det]


def in_double(x, bits):
    """About x 2^-bits."""
    spare = max(x.bit_length() - 64, 0)
    return math.ldexp(x >> spare, spare - bits)


# ---- one piece

class Torus:
    """The approximate torus of one piece, shifted by quarter turns such that its coefficients are
    imaginary, if that is possible, and what is needed to verify it."""

    def __init__(self, setting, piece, is_odd):
        claim, norm = setting.claim, setting.norm
        self.norm, self.divisors, self.field = norm, setting.divisors, setting.field
        self.n, self.degree, self.bits = claim.dimension, piece.degree, piece.bits
        self.omega = claim.rotation
        self.rotation = [combination(b, claim.rotation) for b in norm.basis]
        self.steps = {}
        middle, half = (piece.high + piece.low) / 2, (piece.high - piece.low) / 2
        shift, real, _ = quarter_turns(piece, self.n)
        self.is_odd = is_odd
        self.dropped = Fraction(2 * real * is_odd, 1 << self.bits)      # of |u| for real angles
        self.modes = {}
        for k, series in piece.modes.items():
            if any(any(map(any, vector)) for vector in series):
                turns = dot(k, shift) % 4
                series = [[turn(*x, turns) for x in vector] for vector in series]
                self.modes[k] = [[(0, im) for _, im in vector] for vector in series] \
                    if is_odd else series
        self.waves = []                 # (k, phase, p at the middle, p's part)
        for wave in claim.waves:
            part = wave.parts[0] if wave.parts else Fraction(0)
            k = wave.k[:self.n]
            self.waves.append((k, wave.phase + Fraction(dot(k, shift), 2),
                               wave.middle + part * middle, part * half))
        self.varies = any(part for *_, part in self.waves)
        # Of each k |k|, |u_k| summed over the powers of s, and |k| as a vector in units of 2^-32.
        sizes = []
        for k, series in self.modes.items():
            size = sum([math.isqrt(sum([x * x + y * y for x, y in vector])) + 1
                        for vector in series if any(map(any, vector))])
            sizes.append((norm(k), size, math.isqrt(sum([x * x for x in k]) << 64) + 1))
        if sum([size for _, size, _ in sizes]) >> self.bits > 100:
            raise NotConfirmed(FAR)
        self.farthest = max([length for length, _, _ in sizes], default=1)
        # Of each length the sums of |u_k| and |u_k| |k|.
        self.sums, self.slopes = [0] * (self.farthest + 1), Counter()
        for length, size, width in sizes:
            self.sums[length] += size
            self.slopes[length] += size * width

    def outside(self, powers, limit):
        """The sum of |u_k| sigma^|k| over |k| > limit, in units of 2^-(bits + FINE)."""
        return 2 * sum(map(operator.mul, self.sums[limit + 1:], powers[limit + 1:]))

    def derivative_outside(self, powers, limit):
        """The sum of |u_k| |k|_2 sigma^|k| over |k| > limit."""
        return rounded_up(Fraction(2 * sum([
            slope * powers[length] for length, slope in self.slopes.items() if length > limit]),
            1 << self.bits + FINE + 32))

    def extent(self, powers, spared):
        """(near, far): modes |k| > near add up to no more than what may be spared, and about as
        little is lost of products and exponentials, if these have modes |k| <= far."""
        by_length = [2 * size * power for size, power in zip(self.sums, powers)]
        near, total = self.farthest, 0
        while near > 1 and total + by_length[near] < spared:
            total += by_length[near]
            near -= 1
        inner, last = sum(by_length[near * 2 // 3:]), total + by_length[near] + 1
        slope = math.log(max(inner // last, 1)) / max(near / 3, 1)
        return near, near + math.ceil(min(3 / max(slope, 1e-6), near / 3)) + 1

    def turn_by(self, bits):
        """A function: of the coordinates of k (cos, sin) of k.w, off by less than
        2^-(bits + 24)."""
        fine = bits + 32
        if bits not in self.steps:
            self.steps[bits] = [self.field.in_units(element, fine + 64)
                                for element in self.rotation]
        steps, fixed = self.steps[bits], fixed_of(fine)
        whole = 1 << fine + 64

        def of(m):
            part = dot(m, steps) % whole
            sin, cos = fixed.sincos(part * fixed.two_pi >> fine + 64 + GUARD)
            return cos, sin
        return of

    def series(self, ring, limit):
        """The torus as a series of the ring, cut at |k| = limit, its coefficients rounded down;
        the radius counts neither."""
        step, box = self.degree + 1, ring.box
        entries = [[[0] * box.count, [0] * box.count] for _ in range(self.n)]
        for k, series in self.modes.items():
            if self.norm(k) > limit:
                continue
            m = self.norm.place(k)
            for at, sign in ((box.find(m), 1), (box.find(tuple([-x for x in m])), -1)):
                for j, vector in enumerate(series):
                    for entry, (re, im) in zip(entries, vector):
                        entry[0][at * step + j] = shifted(re, ring.bits - self.bits)
                        entry[1][at * step + j] = sign * shifted(im, ring.bits - self.bits)
        return ring.series(self.n, 1, [
            (None if self.is_odd else re, im) for re, im in entries])


def quarter_turns(piece, n):
    """(shift, real, imaginary): by how many quarter turns of each angle the coefficients become as
    nearly imaginary as they can, and the sums of the absolute values of their parts then."""
    found = []
    parts = [(k, sum([abs(re) for vector in series for re, _ in vector]),
              sum([abs(im) for vector in series for _, im in vector]))
             for k, series in piece.modes.items()]
    for shift in itertools.product((0, 1), repeat=n):
        sums = [0, 0]
        for k, *sizes in parts:
            turns = dot(k, shift) % 2
            sums[0] += sizes[turns]
            sums[1] += sizes[1 - turns]
        found.append((shift, *sums))
    return min(found, key=lambda x: x[1])


def shifted(x, bits):
    """x 2^bits, rounded towards 0, so that opposite numbers stay opposite."""
    if bits >= 0:
        return x << bits
    return x >> -bits if x >= 0 else -(-x >> -bits)


# ---- the constants (T6)

def find_constants(torus, sigma, powers):
    """Constants of the whole torus; or NotConfirmed is raised."""
    l0 = rounded_up(1 + torus.derivative_outside(powers, 0))
    if l0 > 1000:
        raise NotConfirmed(FAR)
    near, found = 1, None
    while torus.derivative_outside(powers, near) > Fraction(1, 1000):
        near = near * 9 // 8 + 1
    near = near * 5 // 4 + 2
    for _ in range(TRIES):
        refuse_too_many(torus, near * 3 // 2, INVERSE_MODES * (2 * len(torus.modes) + 1))
        ring = Ring(Box(torus.norm, near * 3 // 2, torus.degree), sigma, ROUGH_BITS)
        found = constants_with(torus, ring, near, torus.derivative_outside(powers, near))
        if found and found[1] < Fraction(1, 50):
            break
        near = near * 4 // 3 + 1
    if not found:
        raise NotConfirmed("no approximate inverse is near enough")
    m, _, a, b, p = found
    return Constants(l0, *map(rounded_up, (m, a, b, p)))


def constants_with(torus, ring, near, beyond):
    """(m, eta, a, b, p) by an approximate inverse of L with modes |k| <= near; None, if L times it
    is too far from 1."""
    n, box, step = torus.n, ring.box, torus.degree + 1
    unit, u = 1 << ring.bits + FINE, torus.series(ring, near)
    vectors = [combination(m, torus.norm.basis) for m in box.modes()]
    # L = 1 + i u k^T, except for roundings of u, and modes beyond.
    entries = []
    for i, j in itertools.product(range(n), repeat=2):
        factors = [k[j] for k in vectors for _ in range(step)]
        re, im = u.entries[i]
        entries.append(([-x * k for x, k in zip(im, factors)],
                        None if re is None else [x * k for x, k in zip(re, factors)]))
    rough = ring.rounding(u) * max([sum(map(abs, k)) for k in vectors]) + 1
    straight = ring.more(ring.series(n, n, entries), 1)
    left = ring.series(n, n, straight.entries, rough + math.ceil(beyond * unit))
    inverse = approximate_inverse(torus, ring, straight, near)
    if inverse is None:
        return None
    product = ring.multiply(left, inverse)
    eta = Fraction(ring.norm(ring.more(product, -1)), unit)
    if eta > Fraction(1, 8):
        return None
    size = Fraction(ring.norm(inverse), unit)
    m = size / (1 - eta)
    error = size * eta / (1 - eta) * (m + size)
    back = ring.multiply(inverse, delayed(torus, ring, inverse).transposed)
    error += Fraction(back.radius, unit)
    sizes = ring.sizes(back)
    origin = box.centre * step
    a = Fraction(ring.norm(back), unit) + error
    p = Fraction(max([sum(sizes[at:at + step]) for at in range(0, len(sizes), step)
                      if at != origin], default=0), ring.one) + error
    b = inverse_of_mean(torus, ring, back, error)
    return b and (m, eta, a, b, p)


def delayed(torus, ring, f):
    """f(. - w)."""
    by, step, shift = torus.turn_by(ring.bits), torus.degree + 1, ring.bits + 32
    turns = [by(m) for m in ring.box.modes() for _ in range(step)]
    entries = []
    for re, im in f.entries:
        if max(greatest(re), greatest(im or [0])) >> ring.bits + 16:
            raise NotConfirmed(FAR)
        im = im or [0] * len(re)
        entries.append(([x * c + y * s >> shift for x, y, (c, s) in zip(re, im, turns)],
                        [y * c - x * s >> shift for x, y, (c, s) in zip(re, im, turns)]))
    found = ring.series(f.rows, f.columns, entries)
    return ring.series(f.rows, f.columns, entries, f.radius + 2 * ring.rounding(found))


def approximate_inverse(torus, ring, f, near):
    """A polynomial with modes |k| <= near, near the inverse: chosen with doubles along a line that
    winds about the torus, where k = (a, b) and s^j turn as often as the place of (k, j)."""
    box, step = ring.box, torus.degree + 1
    deep, wide, high = [*map(power_of_two, (2 * step if step > 1 else 1, *[
        3 * math.floor(w * near) + 1 for w in torus.norm.widths()])), 1][:3]
    size = deep * wide * high
    if size * len(f.entries) > MAX_GRID:
        raise NotConfirmed("a grid of %d points is needed, the checker's limit is %d"
                           % (size, MAX_GRID // len(f.entries)))
    places = [(at * step + j, ((a + b * wide) * deep + j) % size)
              for at, (m, length) in enumerate(zip(box.modes(), box.lengths)) if length <= near
              for a, b in [(*m, 0)[:2]] for j in range(step)]
    grids, entries = [], []
    for re, im in f.entries:
        values = [0j] * size
        for at, place in places:
            values[place] = complex(in_double(re[at], ring.bits),
                                    in_double(im[at], ring.bits) if im else 0.0)
        grids.append(transform(values, 1))
    try:
        for values in zip(*map(inverse_in_doubles, zip(*grids))):
            values = transform(values, -1)
            re, im = [0] * box.count, [0] * box.count
            for at, place in places:
                re[at] = round(math.ldexp(values[place].real, ring.bits)) // size
                im[at] = round(math.ldexp(values[place].imag, ring.bits)) // size
            entries.append((re, None if torus.is_odd else im))
    except (ZeroDivisionError, OverflowError, ValueError):      # it is not invertible, as it seems
        return None
    return ring.series(f.rows, f.columns, entries)


def inverse_of_mean(torus, ring, f, error):
    """A bound of |<g>^-1| for all g within that error of f; None, if it is not invertible."""
    n, step, unit = torus.n, torus.degree + 1, 1 << ring.bits + FINE
    small = Ring(Box(torus.norm, 0, torus.degree), Fraction(2), ring.bits)
    origin = ring.box.centre * step
    mean = small.series(n, n, [tuple([x and x[origin:origin + step] for x in entry])
                               for entry in f.entries])
    guess = approximate_inverse(torus, small, mean, 0)
    if guess is None:
        return None
    bound = Fraction(small.norm(guess), unit)
    defect = small.norm(small.more(small.multiply(mean, guess), -1))
    rest = 1 - Fraction(defect, unit) - bound * error
    return bound / rest if rest > 0 else None


# ---- the residual (T7)

class Residual:
    """A bound of ||E(u)|| for the torus cut at |k| = near and rounded, and of ||e^(i k.x)|| for
    the waves.

    polynomial: the norm of the computed part of E; radius: a bound of its error; bounds: of each
    wave (|p|, |k|_2, a bound of ||e^(i k.x)||).
    """

    def __init__(self, torus, ring, near):
        self.torus, self.ring, self.near = torus, ring, near
        self.u = torus.series(ring, near)
        self.known = {}
        zero = [0] * ring.box.count
        # x + iy times i, for each component.
        self.angles = [ring.series(1, 1, [([-x for x in im], re)]) for re, im in self.u.entries]
        n, unit = torus.n, 1 << ring.bits + FINE
        reach = max([torus.norm(k) for k, *_ in torus.waves], default=0)
        degree = torus.degree + torus.varies
        self.wide = Ring(Box(torus.norm, ring.box.limit + reach, degree), ring.sigma, ring.bits)
        count = self.wide.box.count
        totals = [([0] * count, [0] * count) for _ in range(n)]
        radius, self.bounds = Fraction(0), []
        for k, phase, middle, part in torus.waves:
            g = self.power(k)
            weight = Fraction(self.wide.powers[torus.norm(k)], 1 << FINE)
            length = upper_root(sum([x * x for x in k]))
            p, size = abs(middle) + abs(part), Fraction(ring.norm(g), unit)
            self.bounds.append((p, length, rounded_up(weight * size)))
            error = (24 * p + 4) / ring.one             # of the amplitudes
            radius += length * weight * (p * Fraction(g.radius, unit) + error * size)
            self.add_wave(totals, k, g, self.amplitudes(phase, middle, part))
        entries = self.linear_part(zero)
        found = []
        for (re, im), (x, y) in zip(totals, entries):
            # A cosine is half the sum of what is at k and of the conjugate of what is at -k.
            shift, back = ring.bits + 1, (opposite(re, degree), opposite(im, degree))
            found.append(([z - (p + q >> shift) for z, p, q in zip(x, re, back[0])],
                          [z - (p - q >> shift) for z, p, q in zip(y, im, back[1])]))
        error = self.wide.series(n, 1, found)
        self.polynomial = Fraction(self.wide.norm(error), unit)
        self.radius = radius + Fraction(3 * self.wide.rounding(error), unit)

    def amplitudes(self, phase, middle, part):
        """p e^(i pi phase) for the powers 0 and 1 of s, in units."""
        fixed = fixed_of(self.ring.bits)
        sin, cos = fixed.sincos(fixed.angle(phase))
        quarter = phase * 2 % 4
        if quarter.denominator == 1:
            cos, sin = [x * fixed.one for x in ((1, 0), (0, 1), (-1, 0), (0, -1))[int(quarter)]]
        return [(math.floor(p * cos), math.floor(p * sin)) for p in (middle, part)]

    def power(self, k):
        """e^(i k.u)."""
        if k < tuple([-x for x in k]):
            return conjugate(self.power(tuple([-x for x in k])), self.torus.degree)
        if k not in self.known:
            if sum(map(abs, k)) == 1:
                found = self.ring.exponential(self.angles[k.index(1)])
            elif not any(x % 2 for x in k):
                half = self.power(tuple([x // 2 for x in k]))
                found = self.ring.multiply(half, half)
            else:
                at = max(range(len(k)), key=lambda i: abs(k[i]))
                unit = tuple([(k[at] > 0) - (k[at] < 0) if i == at else 0 for i in range(len(k))])
                found = self.ring.multiply(
                    self.power(tuple([x - y for x, y in zip(k, unit)])), self.power(unit))
            self.known[k] = found
        return self.known[k]

    def add_wave(self, totals, k, g, amplitudes):
        """Adds -k p e^(i (k.theta + pi phase)) g to the totals."""
        torus, box, wide = self.torus, self.ring.box, self.wide.box
        a, b = (*torus.norm.place(k), 0)[:2]
        step, far = torus.degree + 1, wide.degree + 1
        (re, im), = g.entries
        for row, (start, first, count) in box.rows.items():
            to = wide.find((first + a, row + b)[:torus.n])
            for j, power in itertools.product(range(step), range(far - step + 1)):
                c, s = amplitudes[power]
                x = re[start * step + j:(start + count) * step:step]
                y = im[start * step + j:(start + count) * step:step] if im else [0] * count
                place = slice(to * far + j + power, (to + count) * far, far)
                for (res, ims), factor in zip(totals, k):
                    if factor:
                        p, q = factor * c, factor * s
                        res[place] = [z + p * v - q * w for z, v, w in zip(res[place], x, y)]
                        ims[place] = [z + q * v + p * w for z, v, w in zip(ims[place], x, y)]

    def linear_part(self, zero):
        """u(. + w) - 2 u + u(. - w), each part off by less than 2 units."""
        torus, box, wide, bits = self.torus, self.ring.box, self.wide.box, self.ring.bits
        by, step, far = torus.turn_by(bits), torus.degree + 1, wide.degree + 1
        parts = [re or zero for re, _ in self.u.entries] + [im for _, im in self.u.entries]
        if max(map(greatest, parts)) >> bits + 16:
            raise NotConfirmed(FAR)
        found = [([0] * wide.count, [0] * wide.count) for _ in range(torus.n)]
        for at, m in enumerate(box.modes()):
            mine = slice(at * step, at * step + step)
            if not any(any(part[mine]) for part in parts):
                continue
            factor = 2 * (by(m)[0] - (1 << bits + 32))
            to = wide.find(m) * far
            for (re, im), (x, y) in zip(found, self.u.entries):
                for j in range(step):
                    re[to + j] = (x or zero)[at * step + j] * factor >> bits + 32
                    im[to + j] = y[at * step + j] * factor >> bits + 32
        return found


# ---- a piece, and a whole file (T9)

@dataclass(frozen=True)
class Verified:
    """The facts of which the report of a piece is made.

    Attributes
    ----------
    residual
        The norm of E(u) is at most this.
    needed
        The theorem admits this norm.
    distance
        The torus is within this distance of the file's, at real angles.
    rho
        The width of the strip, for |k| with integer weights.
    constants
        The Constants of the theorem.
    modes, bits
        The number of modes in the series of the residual, and the bits of their coefficients.
    gamma, basis
        |1 - e^(i k.w)| >= gamma |k|^-n for all k != 0 that are integer combinations of the basis.
    """

    residual: Fraction
    needed: Fraction
    distance: Fraction
    rho: Fraction
    constants: Constants
    modes: int
    bits: int
    gamma: Fraction
    basis: tuple


class Setting:
    """The common parts of all pieces of a claim: field, norm and small divisors.

    Raises Rejected, if a mode is outside of the group that the waves' k generate, and what Field
    and Divisors raise.
    """

    def __init__(self, claim):
        self.claim, n = claim, claim.dimension
        basis = lattice([wave.k[:n] for wave in claim.waves], n)
        self.scale = math.lcm(*[x.denominator for x in claim.alpha])
        self.norm = Norm(claim.frame, [int(x * self.scale) for x in claim.alpha], basis)
        for modes in ([wave.k[:n] for wave in claim.waves], *[x.modes for x in claim.pieces]):
            if max(map(self.norm, modes), default=0) > MAX_LENGTH:
                raise NotConfirmed("a mode is longer than %d, the checker's limit" % MAX_LENGTH)
        for piece in claim.pieces:
            if any(self.norm.place(k) is None for k in piece.modes):
                raise Rejected("there is a mode outside of the group that the waves' k generate")
        self.field = Field(claim.polynomial, *claim.root)
        self.divisors = Divisors(self.field, claim.rotation, self.norm)


def verify_piece(setting, tell, number):
    """Verified; or NotConfirmed is raised."""
    claim, count = setting.claim, len(setting.claim.pieces)
    piece, width = claim.pieces[number], claim.rho[number] / setting.scale
    name = "piece %d of %d" % (number + 1, count) if count > 1 else ""
    _, real, imaginary = quarter_turns(piece, claim.dimension)

    def verified(is_odd):
        return verify_width(Torus(setting, piece, is_odd), width,
                            lambda text: tell("%s: %s" % (name, text) if name else text))

    with named(name):
        if real << 16 > imaginary:
            return verified(False)
        try:
            return verified(True)
        except NotConfirmed as error:
            if not real:
                raise
            why = error
        try:
            return verified(False)
        except NotConfirmed as error:
            error.args = "%s; as an odd torus: %s" % (error, why),
            raise


def too_large(residual, needed):
    """NotConfirmed: this residual is more than what is needed."""
    error = NotConfirmed("the error of the torus is %s, where less than %s is needed" % (
        scientific(residual), scientific(needed)))
    error.residual, error.needed = residual, needed
    return error


def refuse_too_many(torus, limit, most):
    """NotConfirmed is raised, if far more modes have |k| <= limit than a torus needs whose norm was
    chosen well."""
    count = torus.norm.count(limit)
    if count > max(FEW_MODES, most):
        raise NotConfirmed("%d modes are needed, too many for a torus of %d: a mode is far out, or "
                           "the frame, alpha are wrong" % (count, len(torus.modes)))


def bounds_of_waves(torus, sigma, rho, powers):
    """(|p|, |k|, an upper bound of ||e^(i k.x)||) for each wave."""
    found = []
    for k, _, middle, part in torus.waves:
        length = upper_root(sum([x * x for x in k]))
        if rho * torus.norm(k) > 300:
            raise NotConfirmed("the strip is too wide for the fastest wave")
        exponent = rounded_up(length * Fraction(torus.outside(powers, 0), 1 << torus.bits + FINE))
        if exponent > 100:
            raise NotConfirmed(FAR)
        found.append((abs(middle) + abs(part), length,
                      rounded_up(sigma ** torus.norm(k)) * exponential_above(exponent)))
    return found


def verify_width(torus, width, tell):
    """Verified, with a strip of about this width; or NotConfirmed is raised."""
    norm, divisors = torus.norm, torus.divisors
    if width * torus.farthest > MAX_WIDTH:
        raise NotConfirmed("the strip is too wide for the longest mode")
    sigma = 1 + Fraction(max(round(math.expm1(width) * 2 ** 24), 1), 2 ** 24)
    rho, powers = logarithm_below(sigma), powers_of(sigma, torus.farthest)
    tell("the constants")
    whole = find_constants(torus, sigma, powers)
    waves = bounds_of_waves(torus, sigma, rho, powers)
    needed, _ = allowed(whole, waves, rho, norm.kappa, divisors)
    if needed < Fraction(1, 1 << MAX_BITS // 8):
        raise NotConfirmed("the constants are too large")
    # A part that is cut off u changes E by at most `factor` times its norm.
    factor = 4 + sum([p * k * k * g for p, k, g in waves])
    near, far = torus.extent(powers, needed / 64 / factor * (1 << torus.bits + FINE))
    # Sums of two modes of the torus are about what products and exponentials have.
    spread = max([abs(x) for k, *_ in torus.waves for x in norm.place(k)], default=1)
    refuse_too_many(torus, far, (2 * len(torus.modes) + 1) ** 2 * spread ** torus.n)
    spare = 12
    for _ in range(TRIES):
        ring = ring_for(torus, sigma, far, needed, spare)
        tell("the residual, with %d modes of %d bits" % (ring.box.groups, ring.bits))
        found = Residual(torus, ring, near)
        residual = found.polynomial + found.radius
        constants = constants_of_cut(found, whole, powers)
        needed, v = allowed(constants, found.bounds, rho, norm.kappa, divisors)
        if residual > needed:
            divisors.look(math.ceil(40 * 2 ** STEPS / rho))
            needed, v = allowed(constants, found.bounds, rho, norm.kappa, divisors, STEPS)
        if residual <= needed:
            distance = rounded_up(v * residual + shift_of_cut(found, powers))
            return Verified(residual, needed, distance, rho, constants, ring.box.groups, ring.bits,
                            divisors.least, tuple(norm.basis))
        if found.polynomial > needed:
            break
        far, spare = far * 9 // 8 + 1, spare + 6
    raise too_large(residual, needed)


def ring_for(torus, sigma, far, needed, spare):
    """Series with |k| <= far; roundings of the residual make up about 2^-spare of what is needed.
    """
    box, width = Box(torus.norm, far, torus.degree), math.log(sigma)
    reach = max([torus.norm(k) for k, *_ in torus.waves], default=0)
    return Ring(box, sigma, spare + math.ceil(reach * width * math.log2(math.e) + math.log2(
        (box.degree + 1) * sum([math.exp(width * x) for x in box.lengths]) / float(needed))))


def constants_of_cut(found, whole, powers):
    """The constants of the torus that was cut for the residual, from those of the whole torus."""
    ring, norm = found.ring, found.torus.norm
    beyond = found.torus.derivative_outside(powers, found.near) \
        + Fraction(ring.rounding(found.u), 1 << ring.bits + FINE) * rounded_up(
            norm.kappa * ring.box.limit)
    constants = whole.after(rounded_up(beyond))
    if constants is None:
        raise NotConfirmed("too much of the torus was cut off")
    return constants


def shift_of_cut(found, powers):
    """A bound of the distance, at real angles, of the file's torus from the one that was cut and
    rounded for the residual."""
    torus, bits = found.torus, found.ring.bits
    rounding = Fraction(4 * torus.n * len(torus.modes) * (torus.degree + 1), 1 << bits)
    return rounding + torus.dropped + Fraction(torus.outside(powers, found.near),
                                               1 << torus.bits + FINE)


def verify_torus(claim, tell=lambda text: None, jobs=1):
    """Verifies the claim of a certificate of existence.

    Parameters
    ----------
    claim
        A TorusClaim.
    tell
        tell(text) is called with each step of the work.
    jobs
        How many pieces are verified at a time, in processes.

    Returns
    -------
    lines, facts
        The report in lines, and for each piece a Verified.

    Raises
    ------
    Rejected, NotConfirmed, Unusable
        The theorem is not verified; the text says why.
    """
    setting, count, found = Setting(claim), len(claim.pieces), []
    jobs = min(jobs, count)
    call = functools.partial(verify_piece, setting, tell if jobs == 1 else nobody)
    with contextlib.closing(mapped(call, range(count), jobs)) as results:
        for each in results:
            found.append(each)
            if jobs > 1:
                tell("%d of %d pieces are verified" % (len(found), count))
    return existence_report(claim, setting, found), tuple(found)


def nobody(text):
    """Is told what processes do."""


# ---- the report

def scientific(x, up=True):
    """Two digits of x > 0, rounded up or down."""
    exponent = math.floor(math.log10(float(x))) if x > Fraction(1, 10 ** 300) else -300
    digits = x / Fraction(10) ** (exponent - 1)
    digits = math.ceil(digits) if up else math.floor(digits)
    if digits >= 100:
        digits, exponent = -(-digits // 10) if up else digits // 10, exponent + 1
    return "%d.%de%d" % (digits // 10, digits % 10, exponent)


def rotation_text(claim):
    """The rotation vector of a TorusClaim: its components in t and their first decimals."""
    field = Field(claim.polynomial, *claim.root)
    omega = ", ".join(["%s = %s..." % (sum_text(element, POWERS),
                                       decimal_text(field.truncated(element, OMEGA_PLACES)))
                       for element in claim.rotation])
    return "omega = " + ("(%s)" % omega if claim.dimension == 2 else omega)


def root_text(claim):
    """The field of the rotation vector, in words."""
    return "t is the root of %s between %s and %s" % (
        sum_text(map(Fraction, claim.polynomial), POWERS), *map(exact_text, claim.root))


def existence_report(claim, setting, found):
    """The theorem and what it rests on."""
    n, worst = claim.dimension, max(found, key=lambda x: x.residual / x.needed)
    ranged = claim.pieces[0].low != claim.pieces[-1].high
    lines = ["Verified :", *map_lines(claim.waves, [("s", Fraction(-1), Fraction(1))], n),
             "has%s an invariant %s" % (" for all -1 <= s <= 1" * ranged,
                                        "Lagrangian graph" if n == 2 else "circle"),
             "(J = P + S'(y) over %s, P constant, S periodic and real analytic), on which"
             % ("both angles" if n == 2 else "the angle"),
             "it is conjugate to the rotation by 2 pi omega,",
             rotation_text(claim), "where " + root_text(claim)]
    return lines + [
        "It is within %s of the file's: y = theta + u(theta)."
        % scientific(max(piece.distance for piece in found)), "",
        "Checker : converse-check " + __version__,
        "Method : KAM theorem a posteriori, Fourier series in integers of %d bits"
        % max(piece.bits for piece in found),
        "Pieces : %d" % len(found), "Modes : %d" % max(piece.modes for piece in found),
        "Strip : %s" % scientific(min(piece.rho for piece in found), False),
        "Small divisors : at least %s |k|^-%d, |k| = %s" % (
            scientific(worst.gamma, False), n, " + ".join(
                "%s|%s|" % ("%d " % a if a > 1 else "", sum_text(map(Fraction, row), ("k0", "k1")))
                for a, row in zip(setting.norm.alpha, claim.frame))),
        "Residual : %s, admissible: %s" % (scientific(worst.residual),
                                          scientific(worst.needed, False))]
