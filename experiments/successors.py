"""How much of the plane of successors is without tori, for maps of two angles.

    python experiments/successors.py [DIRECTORY] [--draw] [--planes]

For a fixed x* and each parameter value, prisms of at most DEPTH cuts prove that no invariant torus
leads from x* to a successor x_1 in them: this measures their share of the torus.  Writes
successors.csv and successors.svg into DIRECTORY (build); --draw draws the table that is there.
--planes writes successors-plane.svg instead: these planes at three values of the line, and in each
the successor on a torus that is proved.  A minute of one core; --planes as much.
"""

import math
import os
import sys
import time
from fractions import Fraction

import numpy as np
import output

import converse
from converse import Problem, prove, tori
from converse.commands.common import Parser, ended
from converse.draw import plot
from converse.model.exact import decimal_text
from converse.model.map import LINE, MuldoonMap, SymplecticMap
from converse.prover import tree
from converse.storage import files

COLUMNS = "map", "parameter", "undecided", "prisms", "seconds", "release"
DEPTH, PLANE_DEPTH = 20, 18
LINE_VALUES = ["0.002", "0.003", "0.004", "0.005", "0.006", "0.007", "0.008", "0.009", "0.010",
               "0.011", "0.012", "0.013", "0.01389"]
COUPLING = Fraction(3, 10)              # B of the Froeschlé map
FROESCHLE_VALUES = ["0.05", "0.1", "0.15", "0.2", "0.25", "0.3", "0.35", "0.4", "0.45"]
PLANES = "0.004", "0.008", "0.010"      # epsilon
ROTATION = "V1"
SIDE, PIXELS = 1 << 10, 500             # of the region as an image, and of the plane


def line(value):
    a = LINE * Fraction(value)
    return Problem(MuldoonMap(a, a, 2 * a))


def froeschle(value):
    """Of coupling COUPLING, in the variables of docs/reference/inputs.md."""
    return Problem(SymplecticMap([(1, 0, "-1/2"), (0, 1, "-1/2"), (1, 1, "-1/2")],
                                 [Fraction(value)] * 2 + [COUPLING]))


MAPS = {"line": (line, LINE_VALUES), "froeschle": (froeschle, FROESCHLE_VALUES)}


def searched(problem, depth):
    return prove(problem, method="loewner", stubborn=True, depth=depth)


def undecided(proof):
    """The share of the region, which stands for the torus, in undecided prisms."""
    return sum(0.5 ** sum(cuts) for kind, (_, cuts) in tree.cells(proof.tree) if kind == "U")


def measure():
    for name, (problem, values) in MAPS.items():
        for value in values:
            began = time.process_time()
            proof = searched(problem(value), DEPTH)
            yield (name, value, "%.5f" % undecided(proof), len(proof.tree),
                   "%.2f" % (time.process_time() - began), converse.__version__)


# ---- planes

def image(proof):
    """The shares undecided in SIDE x SIDE cells of the region, v0 downwards."""
    found = np.zeros((SIDE, SIDE))
    for kind, (index, cuts) in tree.cells(proof.tree):
        if kind == "U":
            ends = [(SIDE * index[k] / 2 ** cuts[k], SIDE * (index[k] + 1) / 2 ** cuts[k])
                    for k in (0, 1)]
            (a, b), (c, d) = [(int(low), max(int(low) + 1, int(high))) for low, high in ends]
            part = math.prod(min(1.0, high - low) for low, high in ends)
            found[a:b, c:d] += part
    return np.minimum(found, 1)


def plane(proof):
    """The shares undecided at PIXELS x PIXELS successors x_1 - x* from -pi to pi.  Shifts, the
    reversal of time and the exchange of the angles bring all of them into the region
    (docs/proofs/argument.md, section 2), whose frame consists of the diagonals."""
    (low0, high0), (low1, high1) = (map(float, ends) for ends in (proof.problem.v0,
                                                                  proof.problem.v1))
    assert proof.problem.frame == (1, 1, 1, -1) and (low1, high1) == (0, 1)
    star = np.array([float(x) for x in proof.xstar]) / math.pi
    centre = (low0 + high0) / 2 - 0.25          # of the reversal: v0 -> 2 centre - v0
    w = (np.arange(PIXELS) + 0.5) / PIXELS * 2 - 1
    x0, x1 = star[0] + w[:, None], star[1] + w[None]
    v0, v1 = (x0 + x1) / 2, (x0 - x1) / 2
    turns = np.round(v0 - centre)               # by (1, 1) of the lattice
    v0, v1 = v0 - turns, v1 - turns
    v0 = centre + abs(v0 - centre)              # reversed where it was below; v1 becomes -v1
    v1 = abs((v1 + 1) % 2 - 1)
    at = [np.clip((SIDE * (v - low) / (high - low)).astype(int), 0, SIDE - 1)
          for v, low, high in ((v0, low0, high0), (v1, low1, high1))]
    return image(proof)[at[0], at[1]]


def successor(torus, star):
    """x_1 - x_0 on a torus at x_0 = x*, by Newton's method in doubles."""
    star, theta = np.array([float(x) for x in star]), np.array([float(x) for x in star])
    for _ in range(60):
        jacobian = np.stack([(torus.x(theta + step) - torus.x(theta - step)) / 2e-6
                             for step in np.eye(2) * 1e-6], axis=1)
        theta = theta - np.linalg.solve(jacobian, torus.x(theta) - star)
    assert abs(torus.x(theta) - star).max() < 1e-9
    return torus.J(theta + 2 * math.pi * np.array(torus.rotation.floats))


def draw_planes(path):
    with output.figure(plot.STYLE, figsize=(7.8, 3.1), layout="constrained") as figure:
        for axes, value in zip(figure.subplots(1, len(PLANES), sharey=True), PLANES):
            proof = searched(line(value), PLANE_DEPTH)
            colours = np.empty((PIXELS, PIXELS, 4))
            colours[..., :3], colours[..., 3] = (0.50, 0.66, 0.83), 1 - plane(proof).T
            axes.imshow(colours, origin="lower", extent=(-1, 1, -1, 1), interpolation="nearest")
            w = successor(tori.prove(line(value), tori.read_rotation(ROTATION)).torus,
                          proof.xstar) / math.pi
            w = (w + 1) % 2 - 1
            axes.plot(*w, "o", markersize=5, markerfacecolor="white",
                      markeredgecolor=plot.VERMILLION, label="on a proved torus")
            axes.set(title="ε = %s, undecided %.1f%%" % (value, math.ceil(
                1000 * undecided(proof)) / 10), xlabel=r"$(x_1 - x^*)_0/\pi$")
        figure.axes[0].set_ylabel(r"$(x_1 - x^*)_1/\pi$")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower right")
        files.write(path, plot.encode(figure, "svg", dpi=150))


def draw(table, path):
    titles = {"line": ("the line a = b = c/2", "ε"),
              "froeschle": ("Froeschlé, B = %s" % decimal_text(COUPLING), "K")}
    with output.figure(plot.STYLE, figsize=(6.4, 2.8), layout="constrained") as figure:
        for axes, name in zip(figure.subplots(1, 2, sharey=True), MAPS):
            rows = [row for row in table if row[0] == name]
            axes.plot([float(row[1]) for row in rows], [1 - float(row[2]) for row in rows], "o-",
                      markersize=3, color=plot.BLUE)
            axes.set(title=titles[name][0], xlabel=titles[name][1], xlim=(0, None), ylim=(0, 1.02))
            axes.grid(color="0.92", linewidth=0.6)
        figure.axes[0].set_ylabel("share of successors without tori")
        files.write(path, plot.encode(figure, "svg"))


def run(options):
    os.makedirs(options.directory, exist_ok=True)
    path = os.path.join(options.directory, "successors")
    if options.planes:
        draw_planes(path + "-plane.svg")
        return 0
    if not options.draw:
        rows = []
        for row in measure():
            print(*row, flush=True)
            rows.append(row)
        files.write_text(path + ".csv", output.text(COLUMNS, rows))
    draw(output.read(COLUMNS, path + ".csv"), path + ".svg")
    return 0


def main(arguments=None):
    parser = Parser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("directory", nargs="?", default="build")
    parser.add_argument("--draw", action="store_true", help="draw the table that is there")
    parser.add_argument("--planes", action="store_true", help="draw three planes")
    return ended("successors.py", lambda: run(parser.parse_args(arguments)),
                 lambda: "nothing was drawn")


if __name__ == "__main__":
    sys.exit(main())
