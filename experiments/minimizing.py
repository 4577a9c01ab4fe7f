"""Are continuation's orbits the minimizing ones?  Where, and by how much, does it lose?

    python experiments/minimizing.py [DIRECTORY] [--quick]

For each map, type and eps: the action of continuation's orbit, the least that a search finds, and,
for the longest type's rotation vector, a floor under the action of all its orbits, proved, and an
estimate of it: what two grids give, extrapolated.  All actions are per point and less the straight
orbit's.  Writes minimizing.csv and minimizing.svg to DIRECTORY (.).  Two minutes of two cores;
--quick: a quarter of one.
"""

import argparse
import concurrent.futures
import csv
import itertools
import os
import sys

from least_action import mather_beta
from less_action import search

from converse import ConverseError, orbits
from converse.draw import plot

TYPES = [((28, 37), 49), ((37, 49), 65), ((49, 65), 86), ((65, 86), 114), ((351, 465), 616),
         ((1432, 1897), 2513)]
EPS = [0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04]
QUICK_EPS = [0.01, 0.02, 0.03, 0.04]
POTENTIALS = [orbits.trig, orbits.ff, orbits.poly]
SEARCHES, GRID = 60, 128
COLUMNS = ("potential", "p", "q", "eps", "continuation", "best", "gain", "label", "floor",
           "estimate")
SAME = 1e-13                        # actions that differ by less are one


def states(potential, p, q, eps, searches):
    """Continuation's state and the best found."""
    return (orbits.follow(potential, p, q, [eps])[0],
            search(potential, p, q, eps, searches=searches))


def bounds(potential, rotation, eps, grid):
    """The proved floor, and the estimates of two grids extrapolated: a grid costs 1/grid^2."""
    fine, coarse = (mather_beta(potential, eps, rotation, grid=k) for k in (grid, grid // 2))
    return fine.low, (4 * fine.estimate - coarse.estimate) / 3


def rows(potentials, types, eps, searches, grid):
    """COLUMNS of each case as soon as it is known; of the last type with its bounds."""
    cases = list(itertools.product(potentials, types, eps))
    rotation = [k / types[-1][1] for k in types[-1][0]]
    with concurrent.futures.ProcessPoolExecutor() as executor:
        found = [executor.submit(states, v, *kind, e, searches) for v, kind, e in cases]
        bound = {(v, e): executor.submit(bounds, v, rotation, e, grid)
                 for v, e in itertools.product(potentials, eps)}
        for (v, (p, q), e), future in zip(cases, found):
            continued, best = future.result()
            floor, estimate = bound[v, e].result() if (p, q) == types[-1] else ("", "")
            gain = continued.action - best.action
            yield (v.name, "%d %d" % p, q, e, continued.action, best.action,
                   gain if gain > SAME else 0.0, best.label, floor, estimate)


def draw(table, file):
    """The gains for the thesis's map."""
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", plot.STYLE]):
        figure = Figure(figsize=(5.6, 3.2), layout="constrained")
        axes = figure.subplots()
        table = [row for row in table if row[0] == "trig"]
        lengths = sorted({row[2] for row in table})
        for q in lengths:
            here = [row for row in table if row[2] == q]
            eps = [row[3] for row in here]
            last = q == lengths[-1]
            axes.plot(eps, [row[6] or float("nan") for row in here], "o-", markersize=3,
                      linewidth=1.6 if last else 0.7, color=plot.BLUE if last else "0.7",
                      zorder=3 if last else 2, label="q = %d" % q if last else
                      "q = %d to %d" % (lengths[0], lengths[-2]) if q == lengths[0] else None)
        axes.plot(eps, [row[4] - row[8] for row in here], "--", color=plot.DARK,
                  label="proved: not more (q = %d)" % q)
        axes.plot(eps, [row[4] - row[9] for row in here], "x", color=plot.VERMILLION,
                  markersize=5, label="estimated from grids (q = %d)" % q)
        axes.set(yscale="log", xlabel="ε", xlim=(0, max(eps) * 1.05),
                 ylabel="action per point above\nthe least that is found",
                 title="What continuation loses, for the thesis's map")
        axes.grid(color="0.92", linewidth=0.6)
        axes.legend(loc="lower right")
        data = plot.encode(figure, "svg", dpi=150)
    with open(file, "wb") as out:
        out.write(data)


def read(path):
    """The rows of such a table."""
    with open(path, encoding="ascii", newline="") as file:
        _, *rows = csv.reader(file)
    return [(row[0], row[1], int(row[2]), *(float(x) if at != 4 and x else x
                                            for at, x in enumerate(row[3:]))) for row in rows]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("directory", nargs="?", default=".", help="for minimizing.csv and .svg (.)")
    parser.add_argument("--quick", action="store_true", help="short orbits, few eps, a coarse grid")
    parser.add_argument("--draw", action="store_true", help="draw minimizing.csv, which is there")
    options = parser.parse_args(arguments)
    cases = ((POTENTIALS, TYPES, EPS, SEARCHES, GRID) if not options.quick else
             (POTENTIALS, TYPES[:4], QUICK_EPS, 50, 64))
    try:
        picture = os.path.join(options.directory, "minimizing.svg")
        if options.draw:
            draw(read(os.path.join(options.directory, "minimizing.csv")), picture)
            return
        os.makedirs(options.directory, exist_ok=True)
        table = []
        with open(os.path.join(options.directory, "minimizing.csv"), "w", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(COLUMNS)
            print("%-6s %-15s %6s %17s %17s %9s %17s %17s" % (
                "map", "type", "eps", "continuation", "best found", "gain", "estimate",
                "floor, proved"))
            for row in rows(*cases):
                name, p, q, eps, continued, best, gain, label, floor, estimate = row
                print("%-6s %-15s %6g %17.12f %17.12f %9.1e %17s %17s" % (
                    name, "(%s)/%d" % (p.replace(" ", ","), q), eps, continued, best, gain,
                    *("%.10f" % x if x != "" else "" for x in (estimate, floor))), flush=True)
                out.writerow(row)
                table.append(row)
        draw(table, picture)
    except (ConverseError, OSError) as error:
        sys.exit("minimizing.py: %s" % error)


if __name__ == "__main__":
    main()
