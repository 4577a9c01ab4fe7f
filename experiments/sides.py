"""The cost of proofs near break-up, on both sides of it and for two maps.

    python experiments/sides.py [DIRECTORY] [--quick] [--draw]

Writes chart-sides.csv and chart-sides.svg into DIRECTORY (build).  Each row is the proof for one
parameter value, made in a separate process: CPU seconds of the search and the proof, without
Python's start; the largest memory of that process; bytes of the proof file or certificate; and the
release that was measured.  The proofs of LONGEST are not repeated, since each takes up to an
hour.  --draw draws the table that is there.  All takes ten minutes of one core and up to 3 GB,
--quick less than a minute.
"""

import concurrent.futures
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

import output

import converse
from converse import tori
from converse.commands.common import Parser, ended
from converse.draw import plot
from converse.draw.plot import BLUE, GREEN
from converse.model.map import LINE, THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.storage import files

COLUMNS = ("map", "side", "parameter", "seconds", "megabytes", "bytes", "parts", "longest",
           "release")
# Distances are measured from break-up.  Numerics give the golden circle's to many digits (Greene).
# For the line 0.0126 is an estimate: the last onset seen (experiments/toughest.py).
FRONTIER = {"standard": 0.971635406, "line": 0.0126}
ROTATION = {"standard": "golden", "line": "V1"}
GRID = 1 << 23                          # points on which a torus is looked for, at most
POINTS = {
    ("standard", "torus"): ("0.5", "0.8", "0.9", "0.95", "0.96", "0.965", "0.97", "0.971",
                            "0.9714", "0.9715"),
    ("standard", "none"): ("1.34", "1.1", "1", "0.984375", "0.98", "0.976", "0.974", "0.973",
                           "0.9725", "0.972", "0.9719", "0.9718", "0.9717"),
    ("line", "torus"): ("0.002", "0.004", "0.006", "0.008", "0.009", "0.010", "0.0105", "0.011",
                        "0.0115"),
    ("line", "none"): ("0.0272", "0.0240", "0.0200", "0.0180", "0.0160", "0.0150", "0.0145",
                       "0.0142", "0.0141", "0.01405", "0.0140", "0.01395", "0.0139"),
}
# Measured with --points 16777216 and more, on the machines of docs/how-to/tori.md.
LONGEST = (("standard", "torus", "0.9716", 636.0, 7400.0, 0, 1580267, "", "2026-11-24"),
           ("line", "torus", "0.0120", 730.0, 4900.0, 0, 598989, "", "2026-11-26"),
           ("line", "torus", "0.0121", 1559.0, 5900.0, 51063809, 918649, "", "2026-11-27"),
           ("line", "torus", "0.0122", 2249.0, 9300.0, 94017674, 1690321, "", "2026-11-27"),
           ("standard", "none", "0.97165", 1609.0, 1128.0, 31346, 15169, 81452, "2026-11-27"))
QUICK = {"standard": 0.008, "line": 0.0026}     # as near as that
WORDS = {("standard", "torus"): ("o", "the standard map: its golden circle"),
         ("standard", "none"): ("s", "the standard map: no circle"),
         ("line", "torus"): ("^", "the thesis's line: a torus of V1"),
         ("line", "none"): ("D", "the thesis's line: no torus")}
COLOURS = {"torus": GREEN, "none": BLUE}


def problem_of(name, value):
    """The standard map with k = value, or the thesis's with epsilon = value."""
    k = Fraction(value)
    if name == "standard":
        return Problem(SymplecticMap([(1, 0)], [k]))
    return Problem(SymplecticMap(THESIS, [LINE * k, LINE * k, 2 * LINE * k]))


def measured(name, side, value):
    """A row without its first three columns; None: it was not proved."""
    problem = problem_of(name, value)
    with tempfile.TemporaryDirectory() as directory:
        path = os.path.join(directory, "proof")
        if side == "none":
            runs = []
            while len(runs) < 5 and sum(runs) < 1:      # short ones: the least of a few
                began = time.process_time()
                proof = converse.prove(problem, method="loewner", jobs=1)
                runs.append(time.process_time() - began)
            if not proof.no_tori:
                return None
            seconds = min(runs)
            parts, longest = proof.counts.proved, proof.counts.max_NTsteps
        else:
            rotation = tori.read_rotation(ROTATION[name], 1 if name == "standard" else 2)
            began = time.process_time()
            try:
                proof = tori.prove(problem, rotation, points=GRID)
            except (tori.NotFound, tori.NotProved):
                return None
            seconds = time.process_time() - began
            parts, longest = len(proof.torus.k), ""
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
        proof.save(path)
        return seconds, memory, os.path.getsize(path), parts, longest


def measure(quick):
    """The rows of the table, in the order of POINTS."""
    spawn = multiprocessing.get_context("spawn")
    for (name, side), values in POINTS.items():
        for value in values:
            if quick and distance(name, value) * FRONTIER[name] < QUICK[name]:
                continue
            with concurrent.futures.ProcessPoolExecutor(1, mp_context=spawn) as one:
                row = one.submit(measured, name, side, value).result()
            if row is None:
                print("%s %s: %s was not proved" % (name, side, value), flush=True)
                continue
            yield name, side, value, *row, converse.__version__
    if not quick:
        yield from LONGEST


def distance(name, value):
    """The relative distance from break-up."""
    return abs(float(Fraction(value)) / FRONTIER[name] - 1)


def read(path):
    """The rows of a table.  ConverseError: it is none."""
    return [(*row[:3], float(row[3]), float(row[4]), int(row[5]), *row[6:])
            for row in output.read(COLUMNS, path)]


def nearer(rows, name, side):
    """The rows of one curve; the last is nearest to break-up."""
    return sorted((row for row in rows if row[:2] == (name, side)),
                  key=lambda row: -distance(name, row[2]))


def draw(rows):
    """The picture, as the bytes of an SVG file."""
    with output.figure(output.CHART, figsize=(7.2, 3.9)) as figure:
        panels = figure.subplots(1, 2, gridspec_kw={"wspace": 0.32})
        for axes, column, words in ((panels[0], 3, "CPU time (seconds)"),
                                    (panels[1], 5, "bytes of the proof file or the certificate")):
            for (name, side), (marker, label) in WORDS.items():
                mine = [row for row in nearer(rows, name, side) if row[column]]
                axes.plot([distance(name, row[2]) for row in mine], [row[column] for row in mine],
                          marker + "-", color=COLOURS[side], label=label,
                          markerfacecolor=COLOURS[side] if name == "line" else "white")
                last = mine[-1]
                # The other curve is to the right of the golden circle's.
                x, align = (-3, "right") if (name, side) == ("standard", "torus") else (3, "left")
                axes.annotate(last[2], (distance(name, last[2]), last[column]), (x, 4), ha=align,
                              textcoords="offset points", color=COLOURS[side])
            axes.set(xscale="log", yscale="log", ylabel=words,
                     xlabel="relative distance from break-up")
            axes.invert_xaxis()
            axes.margins(x=0.12, y=0.08)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper center", ncol=2, bbox_to_anchor=(0.5, 1.02))
        return plot.encode(figure, "svg", pad_inches=0.08)


def run(options):
    plot.check()
    os.makedirs(options.directory, exist_ok=True)
    data, picture = (os.path.join(options.directory, "chart-sides." + ending)
                     for ending in ("csv", "svg"))
    files.check_writable(picture)
    if not options.draw:
        rows = []
        for row in measure(options.quick):
            rows.append(row)
            files.write_text(data, output.text(COLUMNS, rows))
            print(*row, flush=True)
    files.write(picture, draw(read(data)))
    return 0


def parser():
    p = Parser(prog="sides.py", description="What proofs cost near break-up.")
    p.add_argument("directory", nargs="?", default=str(Path("build")))
    p.add_argument("--quick", action="store_true", help="leave out what takes long")
    p.add_argument("--draw", action="store_true", help="draw the table that is there")
    return p


def main(argv=None):
    return ended("sides.py", lambda: run(parser().parse_args(argv)),
                 lambda: "the rows that were measured are kept")


if __name__ == "__main__":
    sys.exit(main())
