"""Fixed-point numbers: Python integers in units of 2^-bits.

They are exact and unbounded; each rounding, a >> or a //, is to be seen where it happens, and
errors are counted in units.  A wave is (k0, k1, phase), the phase in units; its amplitude is apart.
"""

import functools
import math

GUARD = 64                              # more bits, in which constants are computed
SLICES = 1024                           # of the circle, in the table of sines and cosines
SINE_ERROR = 16                         # units; see Fixed.sincos


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
    """The waves, with pi phase (modulo 2 pi) off by less than 2 units."""
    return [(*wave.k, fixed.angle(wave.phase)) for wave in waves]


def angle_of(wave, x):
    return wave[0] * x[0] + wave[1] * x[1] + wave[2]


def turn_of(waves):
    """(q0, q1), the frame of the errors, step (C5): along the wave that bends most, of pairs of k
    and an amplitude not below 0; (1, 0) where that is along an axis."""
    (k0, k1), _ = max(waves, key=lambda wave: wave[1] * (wave[0][0] ** 2 + wave[0][1] ** 2),
                      default=((1, 0), 0))
    common = math.gcd(k0, k1)
    return (k0 // common, k1 // common) if k0 and k1 else (1, 0)


def turned(turn, k):
    """A vector in that frame, times |q|."""
    return turn[0] * k[0] + turn[1] * k[1], turn[0] * k[1] - turn[1] * k[0]


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
