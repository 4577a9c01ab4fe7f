"""What stops the sharper method on the line a = b = c/2: the diagonal, x_0 = x_1.

    python experiments/diagonal.py [--quick]

The diagonal is invariant, and the map on it is area-preserving.  Where that map has an invariant
circle that runs round, an orbit on the circle starts from every x* of the diagonal.  Within the
diagonal its second variation is positive.  If it is also positive across the diagonal, no proof can
succeed from such an x*.  This prints the onsets (orbits.onset) of that map's orbits of noble
rotation numbers, the last first; whether the successors that resist longest lie on the diagonal;
and how many points to either side contradict all sampled successors on the diagonal of one x*.

All that is found here is seen, not proved.  A few minutes.
"""

import argparse
import itertools
import sys
from fractions import Fraction

import numpy as np
from sweep import onsets

from converse import orbits
from converse.commands.common import ended
from converse.model.map import LINE as THESIS_LINE
from converse.model.potential import FourierSum

SIZES = {"full": {"heads": (3, 7), "least": 1000, "cells": 1000, "most": 400,
                  "eps": (0.0144, 0.0142, 0.0141, 0.0140, 0.01395, 0.0139),
                  "xstar": (0.850, 0.854, 0.858, 0.860, 0.862, 0.864, 0.868)},
         "quick": {"heads": (2, 5), "least": 100, "cells": 300, "most": 40,
                   "eps": (0.0144, 0.0138), "xstar": (0.858,)}}
OFF = 0.0141, 0.858                     # eps and x* for which successors off the diagonal are tried
LINE = 20000                            # cells of the diagonal at first
KEPT = 60000                            # cells, at most, that are cut
PARTS = (np.arange(5) - 2) * 0.28       # of a cell, along a side; they overlap


# ---- the map on the diagonal

def diagonal():
    """The potential of the map on x_0 = x_1, for converse.orbits: half of trig's there, since both
    coordinates move."""
    sines = FourierSum(((1, 0, Fraction(0)), (2, 0, Fraction(0))),
                       (Fraction(orbits.trig.scale) / 2,) * 2, 1)
    return orbits.potential.Fourier.of(sines, "diagonal", factor="1")


# ---- noble rotation numbers

def noble(head, least):
    """The first convergent p/q, q at least so large, of [0; head, 1, 1, 1, ...]."""
    (p, q), (r, s) = (0, 1), (1, 0)
    for quotient in itertools.chain(head, itertools.repeat(1)):
        (p, q), (r, s) = (quotient * p + r, quotient * q + s), (p, q)
        if q >= least:
            return (p,), q


def nobles(length, largest, least):
    """(eps of the onset, head) of all, the last first; time's direction halves them."""
    heads = [head for n in range(1, length + 1)
             for head in itertools.product(range(1, largest + 1), repeat=n)
             if head[0] > 1 and head[-1] > 1]
    table = onsets(diagonal(), [noble(head, least) for head in heads],
                   step=0.0005, width=1e-5, top=0.02)
    return sorted(zip((table["eps_below"] + table["eps_above"]) / 2, heads), reverse=True)


# ---- successors of x* that are left

def positive(a, xstar, v, n):
    """Which orbits from x* to x_1 = v (2, m) have a positive second variation over x_-n ... x_n."""
    def follow(x, y, steps):
        points = [x, y]
        for _ in range(steps):
            both = 2 * a * np.cos(y.sum(0))
            x, y = y, 2 * y - x + a * np.cos(y) + both
            points.append(y)
        return points

    x = np.full_like(v, xstar)
    good, inverse = np.ones(v.shape[1], bool), (0, 0, 0)
    with np.errstate(all="ignore"):     # of what is no longer good, anything may become
        for y in follow(v, x, n)[:1:-1] + follow(x, v, n - 1):
            (s0, s1), both = np.sin(y), 2 * np.sin(y.sum(0))
            d00, d01, d11 = (beta - old for beta, old in zip(
                (2 - a * (s0 + both), -a * both, 2 - a * (s1 + both)), inverse))
            det = d00 * d11 - d01 * d01
            good &= (d00 > 0) & (det > 0)
            inverse = d11 / det, -d01 / det, d00 / det
    return good


def resist(eps, xstar, v, side, parts, most):
    """Ever longer segments, and the successors whose cells' centres they do not contradict: yields
    (points to either side, successors left); cells are cut while there are not too many."""
    n = 8
    while v.shape[1] and n < most:
        n = n * 5 // 4
        good = [positive(float(THESIS_LINE) * eps, xstar, some, n)
                for some in np.array_split(v, v.shape[1] // 50000 + 1, axis=1)]
        v = v[:, np.concatenate(good)]
        yield n, v
        if v.shape[1] * parts.shape[1] <= KEPT:
            v = (v[:, :, None] + side * parts[:, None]).reshape(2, -1)
            side *= PARTS[1] - PARTS[0]


def on_diagonal(eps, xstar, most):
    """How many points to either side contradict all successors on the diagonal; None: not most."""
    v = np.tile((np.arange(LINE) + 0.5) * 2 * np.pi / LINE, (2, 1))
    for n, left in resist(eps, xstar, v, 2 * np.pi / LINE, np.tile(PARTS, (2, 1)), most):
        if not left.shape[1]:
            return n
    return None


def off_diagonal(eps, xstar, cells, most):
    """For every length of segments: the successors left in all, and those farther than 0.05 from
    the diagonal."""
    axis = (np.arange(cells) + 0.5) * 2 * np.pi / cells
    v, parts = (np.array(np.meshgrid(x, x)).reshape(2, -1) for x in (axis, PARTS))
    for n, left in resist(eps, xstar, v, 2 * np.pi / cells, parts, most):
        off = np.abs(np.sin((left[0] - left[1]) / 2)) > np.sin(0.025)
        yield n, left.shape[1], off.sum()


def main():
    p = argparse.ArgumentParser(description="What stops the sharper method on the line?")
    p.add_argument("--quick", action="store_true", help="few of everything: seconds")
    sizes = SIZES["quick" if p.parse_args().quick else "full"]
    print("noble circles of the map on the diagonal, last seen at")
    for eps, head in nobles(*sizes["heads"], sizes["least"])[:6]:
        print("    %.5f  [0; %s, 1, 1, 1, ...]" % (eps, ", ".join(map(str, head))))
    print("eps %g, x* %g: points to either side, cells left, of these off the diagonal" % OFF)
    for row in off_diagonal(*OFF, sizes["cells"], sizes["most"]):
        print("    %4d %8d %8d" % row)
    print("points to either side that contradict all of the diagonal; x* =",
          *("%6.3f" % x for x in sizes["xstar"]))
    for eps in sizes["eps"]:
        row = (on_diagonal(eps, x, sizes["most"]) for x in sizes["xstar"])
        print("    eps %.5f" % eps, *("%6s" % (n or "-") for n in row), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(ended("diagonal", main, lambda: "nothing is kept"))
