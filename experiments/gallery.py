"""Draws a picture of the pages:  python experiments/gallery.py NAME [DIRECTORY]

portraits -- orbits of the standard map at three k
cantorus -- a periodic orbit beside a cantorus of the standard map
onset -- the first Lyapunov exponent of one orbit against eps, and the line 1/q
standard-63-64 -- how small the prisms of a proof are, along the only angle that counts

NAME.svg is written into the DIRECTORY (build).  Each takes seconds.
"""

import argparse
import os
import sys
from pathlib import Path

import numpy as np

import converse
from converse import ConverseError, orbits
from converse.draw import plot
from converse.prover import tree

sys.path.insert(0, str(Path(__file__).resolve().parent))
from thesis import shared, twist_maps  # noqa: E402

SPIRAL = (1432, 1897), 2513             # a convergent of the spiral mean's vector
ONSETS = sorted({*0.0005 * np.arange(1, 41), *0.00005 * np.arange(150, 165)})     # eps
HIDDEN = 1e-5                           # Doubles do not tell a smaller exponent from 0.
STANDARD = Path(__file__).resolve().parent.parent / "inputs" / "standard-63-64.in"


def portraits(figure):
    """The thesis's figure, with the angle and the momentum as these pages call them."""
    twist_maps.std_demo(figure, shared.Families())
    for axes in figure.axes:
        axes.set(xlabel=r"$y/2\pi$", ylabel=r"$J/2\pi$" if axes is figure.axes[0] else "")


def cantorus(figure):
    twist_maps.cantorus(figure, shared.Families())
    figure.axes[0].set_title("k = %g, of %d points: gaps, and no curve"
                             % (twist_maps.CANTORUS[0], twist_maps.CANTORUS[2]))


def onset(figure):
    axes = figure.subplots()
    family = orbits.follow(orbits.trig, *SPIRAL, ONSETS)
    eps, first, q = family.eps, family.exponents[:, 0], SPIRAL[1]
    seen = first > HIDDEN
    axes.plot(eps[seen], first[seen], "o-", color=plot.BLUE, markersize=3)
    axes.axhline(1 / q, color=plot.DARK, linestyle="--", linewidth=0.8)
    axes.annotate("1/q: a stretching by e in one period", (eps[-1], 1 / q), (0, -4),
                  textcoords="offset points", ha="right", va="top")
    at = eps[first > 1 / q][0]
    axes.axvline(at, color=plot.VERMILLION, linewidth=0.8)
    axes.annotate("onset: ε = %.4f" % at, (at, 0.3), (5, 0), textcoords="offset points",
                  color=plot.VERMILLION, va="center")
    axes.set(yscale="log", xlim=(0, eps[-1] * 1.02), ylim=(HIDDEN, 1), xlabel="ε",
             ylabel="first Lyapunov exponent, per iterate",
             title="(%d, %d)/%d of the thesis's map" % (*SPIRAL[0], q))


def standard(figure):
    """The width of each prism, in a proof that one angle decides."""
    axes = figure.subplots()
    proof = converse.prove(converse.read_input(STANDARD), method="loewner")
    low, high = (float(x) for x in proof.problem.v0)
    sides = [(high - low) / 2 ** cuts[0] for _, (_, cuts) in tree.cells(proof.tree)]
    axes.stairs(sides, low + np.cumsum([0, *sides]), baseline=2, fill=True, color=plot.BLUE,
                alpha=0.55)
    axes.set(yscale="log", xlim=(low, high), ylim=(min(sides) / 3, 2),
             xlabel="$v_0 / \\pi$, the angle after $x^* = \\pi/2$",
             ylabel="width of the prism,\nin units of $\\pi$",
             title="No circle for 63/64 ≤ k ≤ 0.985: %d prisms, narrow where orbits nearly minimize"
             % proof.counts.proved)


PICTURES = {                            # width and height in inches, and what draws it
    "cantorus": (5.4, 3.2, cantorus), "onset": (5.4, 3.2, onset),
    "portraits": (7.2, 2.9, portraits), "standard-63-64": (6.0, 2.6, standard)}


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Draws a picture of the pages.")
    parser.add_argument("name", choices=PICTURES)
    parser.add_argument("directory", nargs="?", default="build", help="of NAME.svg (build)")
    options = parser.parse_args(arguments)
    width, height, fill = PICTURES[options.name]
    try:
        os.makedirs(options.directory, exist_ok=True)
        Path(options.directory, options.name + ".svg").write_bytes(plot.written(
            width, height, "svg", lambda figure: fill(figure)))
    except (ConverseError, OSError) as error:
        sys.exit("gallery.py: %s" % error)


if __name__ == "__main__":
    main()
