"""The bound B of the largest eigenvalue of beta over the torus and the parameters, step (C2), and
whether B is so large that all larger multiples are excluded at once.
"""

import heapq
import itertools
import math
import operator
from fractions import Fraction

from .arith import DIAGONAL, SINE_ERROR, dot, forms, in_units, largest, stiffness
from .choice import eigenvector, least

MAX_CELLS = 1 << 15                     # of the torus, about, when B is bounded
TOLERANCE_BITS = {1: 20, 2: 20, 3: 6}   # by the number of angles; of three, cells are many
MAX_GRID = 1 << 14                      # points of the torus where an eigenvector is looked for
EIGENVECTOR_BITS = 20                   # of an eigenvector


def cell_bound(fixed, waves, amplitudes, y, w):
    """An upper bound of the largest eigenvalue of beta over the cube of all x, |x[i] - y[i]| <= w,
    and one at y.

    beta = 2I + sum of m k k', where m = -p sin(k.x + phase).
    Taylor: with z = k.(x - y), of |z| <= X = w sum of |k[i]|, m is at most m(y) - p cos(k.y +
    phase) z and a rest, the lesser of |p| z^2 / 2 and -m(y) z^2 / 2 + |p z^3| / 6. The part affine
    in x has a convex largest eigenvalue, so its maximum lies at a corner of the cell. The rests add
    at most the largest eigenvalue of the sum of k k' times a bound of the rest over |z| <= X. As k
    k' is not below 0, beta is also at most the sum with the largest m: |p|, or m(y) + |p cos (k.y +
    phase)| X and the rest. Of three angles, where cells are many, the lesser bound is taken.
    """
    bits, one = fixed.bits, fixed.one
    angles = [fixed.sincos(dot(k, y) + phase) for k, phase in waves]
    m = [-p * s >> bits for p, (s, _) in zip(amplitudes, angles)]
    g = [-p * c * w >> 2 * bits for p, (_, c) in zip(amplitudes, angles)]

    middle = forms(waves, m)
    for at in DIAGONAL[len(middle)]:
        middle[at] += 2 * one
    slopes = [forms(waves, [slope * k[i] for slope, (k, _) in zip(g, waves)])
              for i in range(len(y))]

    def eigenvalue(d):
        return largest([x + dot(d, slope) for x, *slope in zip(middle, *slopes)])

    def rest(p, m, wave):
        X, p = w * sum(map(abs, wave[0])), abs(p)
        square = (X * X >> bits) + 1
        third = ((p * square >> bits) + 1) * X // (6 << bits) + 1
        m = max(-m, 0) + (SINE_ERROR * p >> bits) + 2
        return min(p * square >> bits + 1, (m * square >> bits + 1) + 1 + third) + 1

    rests = list(map(rest, amplitudes, m, waves))
    bend = largest(forms(waves, rests))
    # Sines and floors: m is off by 1 + SINE_ERROR size units at most, and g d by 1 + SINE_ERROR
    # size w for each unit of k; 1 to spare.
    size = max(map(abs, amplitudes), default=0)
    slack = 4 + stiffness(waves) * (4 + ((2 * SINE_ERROR * size * (one + w)) >> 2 * bits) + 1)
    corners = max(map(eigenvalue, itertools.product((-1, 1), repeat=len(y))))
    found = corners + bend
    if len(y) > 2:
        most = forms(waves, [min(abs(p), x + abs(slope) * sum(map(abs, k)) + more) for
                             p, x, slope, more, (k, _) in zip(amplitudes, m, g, rests, waves)])
        for at in DIAGONAL[len(most)]:
            most[at] += 2 * one
        found = min(found, largest(most))
    return found + slack, largest(middle) + slack


def torus_bound(fixed, waves, corners):
    """An upper bound B of the largest eigenvalue of beta over the torus and the parameters between
    these corners, each a tuple of amplitudes.

    beta(x) is affine in the parameters and its largest eigenvalue convex: for each x the maximum
    is at one of the corners.  At each, branch and bound over cells that cover the torus,
    until the worst cell is within a tolerance (relative to the parameters) of a value taken, or
    there are MAX_CELLS, which makes the bound a little less sharp.

    If each wave depends on one coordinate only, then beta is diagonal, and its eigenvalues are
    those of the waves of each coordinate alone.  (Their maxima are lines in the torus, which
    would take as many cells as there may be.)
    """
    n = len(waves[0][0])
    if n > 1 and all(sum(map(bool, k)) == 1 for k, _ in waves):
        apart = [[at for at, (k, _) in enumerate(waves) if k[i]] for i in range(n)]
        return max([torus_bound(fixed, [((sum(waves[at][0]),), waves[at][1]) for at in part],
                                [tuple([p[at] for at in part]) for p in corners])
                    for part in apart if part])
    corners = sorted(set(corners))
    tolerance = (fixed.one + max([sum(map(abs, p)) for p in corners])) >> TOLERANCE_BITS[n]
    heap, taken, order = [], 0, itertools.count()

    def push(p, y, w):
        nonlocal taken
        bound, value = cell_bound(fixed, waves, p, y, w)
        taken = max(taken, value)
        heapq.heappush(heap, (-bound, next(order), p, y, w))

    for p in corners:
        push(p, (0,) * n, fixed.pi + 3)     # pi is off by less than 2 units
    while -heap[0][0] > taken + tolerance and next(order) < MAX_CELLS:
        _, _, p, y, w = heapq.heappop(heap)
        w = w + 1 >> 1
        for d in itertools.product((-w, w), repeat=n):
            push(p, tuple(map(operator.add, y, d)), w)
    return -heap[0][0]


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
    angles = [(wave.k, math.pi * float(wave.phase % 2)) for wave in waves]
    middle = [p / one for p, *_ in amplitudes]

    def beta(x):
        found = forms(angles, [-m * math.sin(dot(k, x) + phase)
                               for m, (k, phase) in zip(middle, angles)])
        return [y + 2 * (at in DIAGONAL[len(found)]) for at, y in enumerate(found)]

    def level(x):
        return least(beta(x))

    number = len(waves[0].k)
    count = min(16 * max([abs(k) for wave in waves for k in wave.k]),
                round(MAX_GRID ** (1 / number)))
    grid = [2 * math.pi * k / count for k in range(count)]
    places = heapq.nsmallest(4, itertools.product(grid, repeat=number), key=level)
    for width in (2 * math.pi / count * 2.0 ** -k for k in range(1, 18)):
        places = [min(itertools.product(*((y - width, y, y + width) for y in x)), key=level)
                  for x in places]
    x = min(places, key=level)
    n = [round(u * 2 ** EIGENVECTOR_BITS) for u in eigenvector(beta(x), level(x))]
    x = [math.floor(Fraction(y) * one) for y in x]
    total = 4 * dot(n, n) << 2 * fixed.bits       # three times 2 |n|^2 - 2/3 |n|^2
    moved = [0] * max(map(len, amplitudes), default=0)      # by each parameter
    for (k, phase), (p, *parts) in zip(known, amplitudes):
        omega, (sine, _) = 3 * dot(k, n) ** 2, fixed.sincos(dot(k, x) + phase)
        total -= omega * p * sine
        # The sine is off by SINE_ERROR, the middle and each part by less than a unit.
        total += omega * ((abs(p) + sum(map(abs, parts))) * SINE_ERROR
                          + 2 * (1 + len(parts)) * one)
        for m, part in enumerate(parts):
            moved[m] += omega * part * sine
    return total + sum(map(abs, moved)) < 0
