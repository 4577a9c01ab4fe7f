"""How a part's region is to move with the parameters.

The hardest prisms are near orbits that stay close to an ordered set for long.  The starting points
of these orbits depend smoothly on the parameters t.  A prism that does not move along must be
narrow in t.  So the region gets shifts s, for which the orbits through v + s t stay together
longest.  They are found by least squares: the ends of short orbits through the hardest prisms move
least.  Doubles are enough, since no bound depends on the shifts."""

import math
from fractions import Fraction

from . import tree

# Points of an orbit to either side.  With 64, every k >= 0.972 takes half as many prisms as with
# 16; with 256 a range above k = 0.973 takes as many as with 64.
STEPS, FLAT_STEPS = 16, 64
MOST_ORBITS, FEWER = 64, 2              # A hard prism has at most FEWER cuts less than the deepest.
PLACES = 8                              # Shifts are rounded to 8 decimals.
LEAST = 1e-10                           # The normal equations are regularized by this ratio.


def best_shifts(problem, amplitude, xstar, text):
    """The shifts for the problem's parameters, near where the amplitudes are these: for each
    parameter what it adds to v0 and v1 at its upper end, in units of pi.

    text: a tree over xstar for these amplitudes, and the region of the problem."""
    waves = [(*map(float, term.k), math.pi * term.phase, float(p), *map(float, term.parts))
             for term, p in zip(problem.terms, amplitude)]
    star, sums = [float(x) for x in xstar], [[0.0] * (2 + len(problem.parts)) for _ in range(2)]
    for v in _hardest(problem, text):
        for rows in _ends(waves, problem.frame, star, v, FLAT_STEPS if problem.is_flat else STEPS):
            size = sum(row[i] * row[i] for row in rows for i in range(2))
            if math.isfinite(size) and size > 0:
                for i in range(2):
                    for j in range(len(sums[i])):
                        sums[i][j] += sum(row[i] * row[j] for row in rows) / size
    (a, b, *right0), (_, d, *right1) = sums
    a, d = a + LEAST * (a + d), d + LEAST * (a + d)
    if not a * d > b * b:
        return ()
    return tuple((_rounded((b * y - d * x) / (a * d - b * b)),
                  _rounded((b * x - a * y) / (a * d - b * b))) for x, y in zip(right0, right1))


def _hardest(problem, text):
    """Successors, (v0, v1) in units of pi: the centres of prisms that are undecided, or else of
    those that were cut most often or almost so."""
    cells = [cell for kind, cell in tree.cells(text) if kind == "U"]
    if not cells:
        most = tree.most_cuts(text)
        cells = [cell for _, cell in tree.cells(text) if sum(cell[1]) + FEWER >= most]
    prism = tree.prisms(problem)
    for cell in cells[::-(-len(cells) // MOST_ORBITS)]:
        yield [float(x) for x in prism(cell)[0]]


def _ends(waves, frame, star, v, steps):
    """How both ends of the orbit through star and the successor, so many steps away, move with v0,
    v1 and the parameters: for each end two rows, of its coordinates."""
    f00, f01, f10, f11 = frame
    n = len(waves[0]) - 4
    next_ = [math.pi * (f00 * v[0] + f01 * v[1]), math.pi * (f10 * v[0] + f11 * v[1])]
    still = [[0.0] * (2 + n) for _ in range(2)]
    moved = [[math.pi * f00, math.pi * f01] + [0.0] * n, [math.pi * f10, math.pi * f11] + [0.0] * n]
    for x, y, rows0, rows in (star, next_, still, moved), (next_, star, moved, still):
        for _ in range(steps):
            force, by_x = [0.0, 0.0], [0.0, 0.0, 0.0]
            by_t = [[0.0] * n for _ in range(2)]
            for k0, k1, phase, p, *parts in waves:
                angle = k0 * y[0] + k1 * y[1] + phase
                sine, cosine = math.sin(angle), math.cos(angle)
                for i, k in enumerate((k0, k1)):
                    force[i] += k * p * cosine
                    for m, part in enumerate(parts):
                        by_t[i][m] += k * part * cosine
                for i, kk in enumerate((k0 * k0, k0 * k1, k1 * k1)):
                    by_x[i] -= kk * p * sine
            x, y = y, [2 * y[i] - x[i] + force[i] for i in range(2)]
            rows0, rows = rows, [
                [2 * rows[i][j] - rows0[i][j] + by_x[i] * rows[0][j] + by_x[i + 1] * rows[1][j]
                 + (by_t[i][j - 2] if j > 1 else 0.0) for j in range(2 + n)] for i in range(2)]
        yield rows


def _rounded(x):
    return round(Fraction(x), PLACES)
