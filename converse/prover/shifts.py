"""How a part's region is to move with the parameters.

The hardest prisms are near orbits that stay close to an ordered set for long.  The starting points
of these orbits depend smoothly on the parameters t.  A prism that does not move along must be
narrow in t.  So the region gets shifts s, for which the orbits through v + s t stay together
longest.  They are found by least squares: the ends of short orbits through the hardest prisms move
least.  Doubles are enough, since no bound depends on the shifts."""

import math
from fractions import Fraction

from ..model.problem import determinant, rows
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
    waves = [(term.k, math.pi * term.phase, float(p), [float(part) for part in term.parts])
             for term, p in zip(problem.terms, amplitude)]
    star, n, m = [float(x) for x in xstar], problem.size, len(problem.parts)
    sums = [[0.0] * (n + m) for _ in range(n)]
    for v in _hardest(problem, text):
        for moved in _ends(waves, problem.frame, star, v, FLAT_STEPS if problem.is_flat else STEPS):
            size = sum(row[i] * row[i] for row in moved for i in range(n))
            if math.isfinite(size) and size > 0:
                for i in range(n):
                    for j in range(n + m):
                        sums[i][j] += sum(row[i] * row[j] for row in moved) / size
    matrix = [row[:n] for row in sums]
    trace = sum(matrix[i][i] for i in range(n))
    for i in range(n):
        matrix[i][i] += LEAST * trace
    size = determinant(matrix)
    if not size > 0:
        return ()
    return tuple(tuple(_rounded(determinant([
        [*row[:i], -right[n + j], *row[i + 1:]] for row, right in zip(matrix, sums)]) / size)
        for i in range(n)) for j in range(m))       # Cramer's rule


def _hardest(problem, text):
    """Successors, (v0, v1, ...) in units of pi: the centres of prisms that are undecided, or else
    of those that were cut most often or almost so."""
    cells = [cell for kind, cell in tree.cells(text) if kind == "U"]
    if not cells:
        most = tree.most_cuts(text)
        cells = [cell for _, cell in tree.cells(text) if sum(cell[1]) + FEWER >= most]
    prism = tree.prisms(problem)
    for cell in cells[::-(-len(cells) // MOST_ORBITS)]:
        yield [float(x) for x in prism(cell)[0]]


def _ends(waves, frame, star, v, steps):
    """How both ends of the orbit through star and the successor, so many steps away, move with v0,
    v1, ... and the parameters: for each end the rows of its coordinates."""
    n, m = len(star), len(waves[0][3])
    moved = [[math.pi * f for f in row] + [0.0] * m for row in rows(frame)]
    next_ = [math.pi * sum(f * x for f, x in zip(row, v)) for row in rows(frame)]
    still = [[0.0] * (n + m) for _ in range(n)]
    for x, y, before, now in (star, next_, still, moved), (next_, star, moved, still):
        for _ in range(steps):
            force, by_x, by_t = [0.0] * n, [[0.0] * n for _ in range(n)], [[0.0] * m for _ in star]
            for k, phase, p, parts in waves:
                angle = sum(a * b for a, b in zip(k, y)) + phase
                sine, cosine = math.sin(angle), math.cos(angle)
                for i, a in enumerate(k):
                    force[i] += a * p * cosine
                    for j, part in enumerate(parts):
                        by_t[i][j] += a * part * cosine
                    for j, b in enumerate(k):
                        by_x[i][j] -= a * b * p * sine
            x, y = y, [2 * y[i] - x[i] + force[i] for i in range(n)]
            after = [[2 * b - a for a, b in zip(*pair)] for pair in zip(before, now)]
            for i, row in enumerate(after):
                for factor, other in zip(by_x[i], now):
                    row[:] = [a + factor * b for a, b in zip(row, other)]
                row[n:] = [a + b for a, b in zip(row[n:], by_t[i])]
            before, now = now, after
        yield now


def _rounded(x):
    return round(Fraction(x), PLACES)
