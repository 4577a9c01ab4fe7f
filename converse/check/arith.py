"""Fixed-point numbers: Python integers in units of 2^-bits.

They are exact and unbounded; each rounding, a >> or a //, is to be seen where it happens, and
errors are counted in units.  A wave is (k, phase), the phase in units; its amplitude is apart.  A
symmetric matrix of one, two or three rows is the list of its entries on and above the diagonal, row
by row.
"""

import collections
import functools
import itertools
import math
import operator
from fractions import Fraction

GUARD = 64                              # more bits, in which constants are computed
SLICES = 1024                           # of the circle, in the table of sines and cosines
SINE_ERROR = 16                         # units; see Fixed.sincos
TURN = 1 << 20                          # about the length of w in turn_of
NEWTON_STEPS = 4                        # for the extreme eigenvalues of three rows


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

    @property
    def around_pi(self):
        """Rational numbers below and above pi."""
        return Fraction(self.pi - 2, self.one), Fraction(self.pi + 2, self.one)

    def angle(self, phase):
        """pi phase, modulo 2 pi, off by less than 2 units."""
        return math.floor(phase % 2 * self.two_pi / 2) >> GUARD

    @staticmethod
    def _divisors(bits):
        """n (n - 1) and n (n + 1) for even n, downwards, as many as _small needs."""
        n = 2
        while math.factorial(n + 2) << 7 * (n + 2) < 1 << bits:
            n += 2
        return [(m * (m - 1), m * (m + 1)) for m in range(n, 0, -2)]

    @staticmethod
    def _small(r, bits, divisors):
        """The cosine and sine of |r| <= 1/128, each within 4 units.

        Horner's form of Taylor's series, with z = r^2 <= 2^-14.  The first term left out is below
        a unit; the floor of z costs half a unit, those of an order two units, which the orders
        after it make 2^-14 as large, and the last product one.
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
        if abs(n) > 1 << 48:            # n times the error of a step must stay below a unit
            raise OverflowError("an angle is too large")
        c, s = self._small(x - (n * self.step >> GUARD), bits, self.divisors)
        sin, cos = self.table[n % SLICES]
        return sin * c + cos * s >> bits, cos * c - sin * s >> bits


fixed_of = functools.lru_cache(maxsize=16)(Fixed)       # by bits


def in_units(fixed, waves):
    """The waves as (k, pi phase), the phase modulo 2 pi and off by less than 2 units."""
    return [(wave.k, fixed.angle(wave.phase)) for wave in waves]


def dot(k, x):
    if len(k) == 2:                     # which is faster
        return k[0] * x[0] + k[1] * x[1]
    if len(k) == 3:
        return k[0] * x[0] + k[1] * x[1] + k[2] * x[2]
    return sum(map(operator.mul, k, x))


def combined(k, rows):
    """The sum of k[i] times row i, of integer k that are not all 0."""
    found = None
    for x, row in zip(k, rows):
        if x:
            found = [a + x * b for a, b in zip(found, row)] if found else \
                row if x == 1 else [x * a for a in row]
    return found


def pairs_of(n):
    """i <= j < n, in order: the places of the entries of a symmetric matrix in its list."""
    return list(itertools.combinations_with_replacement(range(n), 2))


def entries(k):
    """k k'."""
    return [x * y for x, y in itertools.combinations_with_replacement(k, 2)]


def full(d):
    """The rows of a symmetric matrix of at most three."""
    return [[d[at] for at in row] for row in ROWS[len(d)]]


# By the number of entries: the places of a matrix's rows, and of its diagonal.
ROWS = {len(pairs_of(n)): [[pairs_of(n).index((min(i, j), max(i, j))) for j in range(n)]
                           for i in range(n)] for n in (1, 2, 3)}
DIAGONAL = {count: [row[i] for i, row in enumerate(rows)] for count, rows in ROWS.items()}
BESIDE = {count: [(rows[i][i], rows[i][j], rows[j][j]) for i in range(len(rows)) for j in range(i)]
          for count, rows in ROWS.items()}      # and of entries beside it


def times(d, v):
    """A symmetric matrix times a vector."""
    if len(v) == 2:
        (a, b, c), (x, y) = d, v
        return [a * x + b * y, b * x + c * y]
    return [dot(row, v) for row in full(d)]


def cofactors(d, sign=-1):
    """The adjugate of a symmetric matrix, up to roundings of its two products; with the sign 1 the
    same sums with + everywhere."""
    if len(d) == 1:
        return [d[0] * 0 + 1]
    if len(d) == 3:
        return [d[2], sign * d[1], d[0]]
    a, b, c, e, f, g = d
    of_b, of_c, of_f = sign * b, sign * c, sign * f
    return [e * g + of_f * f, c * f + of_b * g, b * f + of_c * e,
            a * g + of_c * c, b * c + of_f * a, a * e + of_b * b]


def with_determinant(d):
    """The cofactors and the determinant, by the first row."""
    if len(d) == 3:                     # which is faster
        a, b, c = d
        return [c, -b, a], a * c - b * b
    found = cofactors(d)
    return found, dot(d[:len(DIAGONAL[len(d)])], found)


def determinant(rows):
    """Of any square matrix of integers."""
    return sum([(-1) ** i * row[0] * determinant([r[1:] for r in [*rows[:i], *rows[i + 1:]]])
                for i, row in enumerate(rows)]) if rows else 1


def inverse_rows(rows):
    """The rows of the inverse of a matrix of integers."""
    det, n = determinant(rows), range(len(rows))
    return [[Fraction((-1) ** (i + j) * determinant(
        [r[:i] + r[i + 1:] for at, r in enumerate(rows) if at != j]), det) for j in n] for i in n]


# The frame of the errors, step (C5): integers R in rows, R R' = length; where it is not the
# coordinates, the table of R d R' by the entries of d.
Turn = collections.namedtuple("Turn", "rows length table")


def turn_of(waves, n):
    """The Turn along the wave that bends most, of pairs of k and an amplitude not below 0.

    R = |w|^2 - 2 w w' reflects the first axis to k, up to the rounding of w.
    """
    k, _ = max(waves, key=lambda wave: wave[1] * dot(wave[0], wave[0]), default=((0,), 0))
    if sum(map(bool, k)) < 2:
        return Turn([[int(i == j) for j in range(n)] for i in range(n)], 1, None)
    w = [round(x / math.hypot(*k) * TURN) - TURN * (not i) for i, x in enumerate(k)]
    size = dot(w, w)
    rows = [[size * (i == j) - 2 * x * y for j, y in enumerate(w)] for i, x in enumerate(w)]
    table = [[rows[a][i] * rows[b][j] + (i != j) * rows[a][j] * rows[b][i] for i, j in pairs_of(n)]
             for a, b in pairs_of(n)]
    return Turn(rows, size * size, table)


def stiffness(waves):
    """The sum of |k|^2 times the sum of the |k[i]|: where each amplitude is off by one, and each
    slope of a wave by that sum, an eigenvalue is off by no more."""
    return sum([dot(k, k) * sum(map(abs, k)) for k, _ in waves])


def trace(d):
    return sum([d[at] for at in DIAGONAL[len(d)]])


def spread(d):
    """(n - 1) (n F - S^2) for a symmetric matrix of n rows with the trace S and the sum F of the
    squares of all entries.  By Samuelson's inequality no eigenvalue lies further from S/n than by
    the n-th part of its root; for n <= 2 both extreme ones do."""
    n, found = len(DIAGONAL[len(d)]), d[0] * 0
    for i, at, j in BESIDE[len(d)]:
        x, y = d[i] - d[j], d[at]
        found = found + x * x + 2 * n * y * y
    return (n - 1) * found


def newton(d, x):
    """The characteristic polynomial of d at x, up to its sign that of det(d - x), its derivative,
    without that sign, and the cofactors of d - x."""
    found, det = with_determinant([y - x if at in DIAGONAL[len(d)] else y
                                   for at, y in enumerate(d)])
    return det, trace(found), found


def largest(d):
    """An upper bound of the largest eigenvalue of a symmetric matrix: for at most two rows less
    than 2 units above it.  For three Newton's method leads from above to less, as the
    characteristic polynomial is convex above its roots."""
    n = len(DIAGONAL[len(d)])
    found = -(-(trace(d) + upper_sqrt(spread(d))) // n)
    for _ in range(NEWTON_STEPS * (n > 2)):
        det, slope, _ = newton(d, found)
        if det >= 0 or slope <= 0:      # at a root
            break
        found -= -det // slope
    return found


def forms(waves, weights):
    """The sum of weight k k' over the waves, of which there is one at least."""
    found = [weights[0] * x for x in entries(waves[0][0])]
    for (k, _), weight in zip(waves[1:], weights[1:]):
        found = [a + weight * b for a, b in zip(found, entries(k))]
    return found
