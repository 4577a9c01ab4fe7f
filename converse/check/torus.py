"""The bound B of the largest eigenvalue of beta over the torus and the parameters, step (C2), and
whether B is so large that all larger multiples are excluded at once.
"""

import heapq
import itertools
import math
import operator
from fractions import Fraction

from .arith import SINE_ERROR, angle_of, forms, in_units, largest, stiffness

MAX_CELLS = 1 << 15                     # of the torus, about, when B is bounded
EIGENVECTOR_BITS = 20                   # of an eigenvector


def cell_bound(fixed, waves, amplitudes, sides, y, w):
    """An upper bound of the largest eigenvalue of beta over y + sum of d side, |d| <= w, and one at
    y.

    beta = 2I + sum of m k k', where m = -p sin(k.x + phase).
    Taylor: with x = k.D, of |x| <= X = w sum of |k.side|, m is at most m(y) - p cos(k.y + phase) x
    and a rest, the lesser of |p| x^2 / 2 and -m(y) x^2 / 2 + |p x^3| / 6.  The part affine in d has
    a convex largest eigenvalue, so its maximum lies at a corner of the cell.  The rests add at most
    the largest eigenvalue of the sum of k k' times a bound of the rest over |x| <= X.
    """
    bits, one = fixed.bits, fixed.one
    along = [[k0 * u + k1 * v for u, v in sides] for k0, k1, _ in waves]
    angles = [fixed.sincos(angle_of(wave, y)) for wave in waves]
    m = [-p * s >> bits for p, (s, _) in zip(amplitudes, angles)]
    g = [-p * c * w >> 2 * bits for p, (_, c) in zip(amplitudes, angles)]

    middle = forms(waves, m)
    slopes = [forms(waves, [slope * ks[i] for slope, ks in zip(g, along)])
              for i in range(len(sides))]

    def eigenvalue(d):
        p, q, r = [x + sum(map(operator.mul, d, slope)) for x, *slope in zip(middle, *slopes)]
        return largest(2 * one + p, q, 2 * one + r, one)

    def rest(p, m, ks):
        X, p = w * sum(map(abs, ks)), abs(p)
        square = (X * X >> bits) + 1
        third = ((p * square >> bits) + 1) * X // (6 << bits) + 1
        m = max(-m, 0) + (SINE_ERROR * p >> bits) + 2
        return min(p * square >> bits + 1, (m * square >> bits + 1) + 1 + third) + 1

    bend = largest(*forms(waves, map(rest, amplitudes, m, along)), one)
    # Sines and floors: m is off by 1 + SINE_ERROR size units at most, and g d by 1 + SINE_ERROR
    # size w for each unit of k.side, where |k.side| <= |k0| + |k1|; 1 to spare.
    size = max(map(abs, amplitudes), default=0)
    slack = 4 + stiffness(waves) * (4 + ((2 * SINE_ERROR * size * (one + w)) >> 2 * bits) + 1)
    corners = max(map(eigenvalue, itertools.product((-1, 1), repeat=len(sides))))
    return corners + bend + slack, eigenvalue((0,) * len(sides)) + slack


def torus_bound(fixed, waves, corners):
    """An upper bound B of the largest eigenvalue of beta over the torus and the parameters between
    these corners, each a tuple of amplitudes.

    beta(x) is affine in the parameters and its largest eigenvalue convex: for each x the maximum
    is at one of the corners.  At each, branch and bound over cells that cover the torus,
    until the worst cell is within 2^-20 (relative to the parameters) of a value taken, or there are
    MAX_CELLS, which makes the bound a little less sharp.

    If all k are multiples of q, a primitive vector, then beta depends on q.y alone, and has all its
    values on a piece of an axis, |y| <= pi/|q0| or pi/|q1|.

    If each wave depends on one coordinate only, then beta is diagonal, and its eigenvalues are
    those of the waves of either coordinate alone.  (Their maxima are lines in the torus, which
    would take as many cells as there may be.)
    """
    of_axis = [[n for n, wave in enumerate(waves) if wave[axis]] for axis in (0, 1)]
    if all(of_axis) and not set(of_axis[0]) & set(of_axis[1]):
        return max([torus_bound(fixed, [waves[n] for n in part],
                                [tuple([p[n] for n in part]) for p in corners])
                    for part in of_axis])
    corners = sorted(set(corners))
    sides, width = [(1, 0), (0, 1)], fixed.pi
    q0, q1 = waves[0][:2] if waves else (1, 0)
    if all(k0 * q1 == k1 * q0 for k0, k1, _ in waves):
        axis = 0 if q0 else 1
        sides, width = [sides[axis]], fixed.pi * math.gcd(q0, q1) // abs((q0, q1)[axis])
    tolerance = (fixed.one + max([sum(map(abs, p)) for p in corners])) >> 20
    heap, taken, order = [], 0, itertools.count()

    def push(p, y, w):
        nonlocal taken
        bound, value = cell_bound(fixed, waves, p, sides, y, w)
        taken = max(taken, value)
        heapq.heappush(heap, (-bound, next(order), p, y, w))

    for p in corners:
        push(p, (0, 0), width + 3)          # pi is off by less than 2 units, width by 3
    while -heap[0][0] > taken + tolerance and next(order) < MAX_CELLS:
        _, _, p, y, w = heapq.heappop(heap)
        w = w + 1 >> 1
        for d in itertools.product((-w, w), repeat=len(sides)):
            push(p, tuple([c + sum([e * side[i] for e, side in zip(d, sides)])
                           for i, c in enumerate(y)]), w)
    return -heap[0][0]


def least(d):
    """The least eigenvalue of [p q; q r] and its eigenvector, in double precision."""
    p, q, r = d
    value = (p + r - math.hypot(p - r, 2 * q)) / 2
    u, v = (q, value - p) if p > r else (value - r, q)
    length = math.hypot(u, v)
    return value, ((u / length, v / length) if length else (1.0, 0.0))


def is_at_once(fixed, waves, t=None):
    """Is B > 10/3 for all parameters of the waves, or at t; B of beta over the torus?

    V is odd about a point, so the least eigenvalue of beta over the torus is 4 - B; where it is
    attained, (C3) with that point and its eigenvector alone is 4 - B - 2l < 0, that is B > 10/3;
    and B - 2 grows in proportion with the amplitudes.  So it is enough that n.beta(x)n < 2/3 |n|^2
    for some x and n: found on a grid in double precision, and then bounded for all parameters.
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
    n0, n1 = [round(u * 2 ** EIGENVECTOR_BITS) for u in least(beta(x))[1]]
    x = [math.floor(Fraction(y) * one) for y in x]
    total = 4 * (n0 * n0 + n1 * n1) << 2 * fixed.bits       # three times 2 |n|^2 - 2/3 |n|^2
    moved = [0] * max(map(len, amplitudes), default=0)      # by each parameter
    for wave, (p, *parts) in zip(known, amplitudes):
        omega, (sine, _) = 3 * (wave[0] * n0 + wave[1] * n1) ** 2, fixed.sincos(angle_of(wave, x))
        total -= omega * p * sine
        # The sine is off by SINE_ERROR, the middle and each part by less than a unit.
        total += omega * ((abs(p) + sum(map(abs, parts))) * SINE_ERROR
                          + 2 * (1 + len(parts)) * one)
        for m, part in enumerate(parts):
            moved[m] += omega * part * sine
    return total + sum(map(abs, moved)) < 0
