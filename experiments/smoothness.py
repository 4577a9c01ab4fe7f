"""The smoothness puzzle (thesis, section 2.4): are momenta Lipschitz functions of the angles?

    python experiments/smoothness.py [DIRECTORY]

For the 800 closest pairs of points of an orbit, L = |dp|/|dx|.  Where orbits have contracted into
filaments the thesis saw the largest L at the smallest |dx|, with slope -1 and in "two populations",
and suspected noise.  Writes smoothness.svg into DIRECTORY (build).  All pairs
except those at eps 0.0075 belong to proved orbits, whose points are known to 10^-20 or better.  So
the rise is not noise.  A few seconds.
"""

import argparse
import math
import os
from collections import Counter
from fractions import Fraction

import numpy as np
import output
from pairs import pairs as closest

from converse import orbits
from converse.draw import plot

SPIRAL, LONGER = ((1432, 1897), 2513), ((2513, 3329), 4410)
# type, eps, digits of the proved orbit; None: the phases are not determined, doubles must do
STATES = [(SPIRAL, 0.0075, None), (SPIRAL, 0.0125, 20), (LONGER, 0.0125, 20), (SPIRAL, 0.02, 20),
          (SPIRAL, 0.03, 60)]
COUNT = 800                 # The pairs of each state that are drawn.
CANDIDATES = 4000           # The closest pairs are among this many that are closest in doubles.
STEEP = 40                  # The pairs of largest L whose distances along the orbit are listed.


def exact_pairs(proved):
    """The closest pairs of a proved orbit: i, j, |dx|, |dp|.  Since x_{j+1} = x_j + p_{j+1},
    momenta are differences of displacements."""
    state, u = proved.state, proved.displacements
    found = []
    for i, j in zip(*map(np.ndarray.tolist, closest(state, CANDIDATES)[:2])):
        dx = [Fraction((i - j) * p % state.q, state.q) + a - b
              for p, a, b in zip(state.p, u[i], u[j])]
        dp = [a - b - c + d for a, b, c, d in zip(u[i], u[i - 1], u[j], u[j - 1])]
        found.append((size([x - round(x) for x in dx]), size(dp), i, j))
    distance, momentum, i, j = map(np.array, zip(*sorted(found)[:COUNT]))
    return i, j, distance, momentum


def size(vector):
    """The Euclidean norm of a vector of Fractions."""
    largest = max(map(abs, vector))
    return float(largest) * math.hypot(*(float(x / largest) for x in vector)) if largest else 0.0


def measure(kind, eps, digits):
    """A state and its closest pairs; printed, what is said of them."""
    state = orbits.follow(orbits.trig, *kind, [eps])[0]
    if digits is None:
        pairs = closest(state, COUNT)
        print("(%d, %d)/%d, eps %g: in doubles, shadow %.0e"
              % (*state.p, state.q, eps, state.shadow))
    else:
        proved = orbits.prove(state, digits)
        pairs, doubles = exact_pairs(proved), closest(state, COUNT)
        print("(%d, %d)/%d, eps %g: proved, radius %.0e, %.0e from the doubles, whose largest L is "
              "%.4g"
              % (*state.p, state.q, eps, proved.radius, proved.moved,
                 max(doubles.momentum / doubles.distance)))
    i, j, distance, momentum = pairs
    steepness = momentum / distance
    apart = np.minimum(abs(i - j), state.q - abs(i - j))
    steep = np.argsort(-steepness)[:STEEP]
    at = steep[0]
    print("    |dx| %.1e to %.1e; largest L %.4g, points %d and %d, |dx| %.3e, |dp| %.3e"
          % (distance[0], distance[-1], steepness[at], i[at], j[at], distance[at], momentum[at]))
    print("    steepest %d:" % STEEP)
    for d, n in Counter(apart[steep].tolist()).most_common(6):
        there = momentum[steep][apart[steep] == d]
        print("        |i - j| = %d: %d pairs, |dp| %.1e to %.1e" %
              (d, n, there.min(), there.max()),
              flush=True)
    return state, i, j, distance, momentum


# ---- drawing

def draw(measured):
    """The figure, as the bytes of an SVG file; each line goes through an orbit's steepest pair."""
    with output.figure(output.CHART, figsize=(6, 3.8)) as figure:
        axes = figure.subplots()
        for (state, _, _, distance, momentum), colour, words, at in (
                (measured[0], "0.45", "a smooth surface", (1.6e-2, 1.2e-5)),
                (measured[2], plot.BLUE, "filaments", (6e-5, 2.5e-4))):
            x, p = max(zip(distance, momentum), key=lambda pair: pair[1] / pair[0])
            axes.axline((x, p), (2 * x, 2 * p), color=colour, zorder=1)
            axes.plot(distance, momentum, ".", markersize=2.5, color=colour, rasterized=True)
            axes.plot(x, p, "o", color=colour)
            axes.annotate(r"$|\Delta p| = %.3g\,|\Delta x|$" % (p / x), (x, p), (6, -6),
                          textcoords="offset points", color=colour, va="top")
            axes.text(*at, "%s,\nε = %g" % (words, state.eps), color=colour, ha="center")
        axes.set(xscale="log", yscale="log", xlim=(1e-7, 0.5), ylim=(3e-6, 1e-2),
                 xlabel=r"$|\Delta x|$ of two points (turns)", ylabel=r"$|\Delta p|$ (turns)",
                 title="Points of filaments come together in the angles, not in the momenta")
        return plot.encode(figure, "svg", dpi=150)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("directory", nargs="?", default="build", help="of the picture (build)")
    directory = parser.parse_args(arguments).directory
    os.makedirs(directory, exist_ok=True)
    with open(os.path.join(directory, "smoothness.svg"), "wb") as file:
        file.write(draw([measure(*state) for state in STATES]))


if __name__ == "__main__":
    main()
