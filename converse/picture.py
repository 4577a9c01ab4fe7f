"""The figure as SVG, PNG or PDF, drawn with matplotlib (the extra "plot")."""

import io
import os

from . import files, tree

FORMATS = (".svg", ".png", ".pdf")
COLOURS = {"P": "0.35", "S": "0.85", "?": "1.0", "U": "#ffd0d0"}
LABELS = {"P": "proved", "S": "skipped by symmetry", "?": "untried", "U": "undecided"}
RASTER = 5000                           # more prisms than this are drawn as pixels, also in SVG


def check():
    """ConverseError if matplotlib is missing."""
    try:
        import matplotlib
    except ImportError:
        raise files.ConverseError("SVG, PNG and PDF need matplotlib; pip install 'converse[plot]' "
                                  "or name the figure .ps") from None
    matplotlib.use("Agg")


def picture(proof, path):
    """Draws a proof, finished or not, in the format that the name of the file asks for."""
    check()
    from matplotlib import rcParams
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    rcParams["svg.hashsalt"] = "converse"           # the same picture, the same file
    low, side = zip(*((float(c - h), float(2 * h)) for c, h in zip(
        proof.problem.centre[3:], proof.problem.half[3:])))
    fig = Figure(figsize=(6.4, 7.0))
    axes = fig.add_subplot()
    boxes = {kind: [] for kind in COLOURS}
    for kind, ((i, j, *_), (k, l, *_)) in tree.cells(proof.tree):
        x0, x1 = (low[0] + side[0] * n / 2 ** k for n in (i, i + 1))
        y0, y1 = (low[1] + side[1] * n / 2 ** l for n in (j, j + 1))
        boxes[kind].append(((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
    many = sum(map(len, boxes.values())) > RASTER
    for kind, polygons in boxes.items():
        edge = {"U": "red"}.get(kind, "0.1" if kind == "P" else "0.6")
        axes.add_collection(PolyCollection(polygons, facecolors=COLOURS[kind], edgecolors=edge,
                                           linewidths=0.05 if many else 0.3, rasterized=many))
    axes.plot(*_star(proof, low, side), "o", markersize=5, markerfacecolor="white",
              markeredgecolor="black", label="x*")
    axes.set_xlim(low[0], low[0] + (side[0] or 1))
    axes.set_ylim(low[1], low[1] + (side[1] or 1))
    axes.set_aspect("equal" if side[0] == side[1] else "auto")
    axes.set_xlabel(r"$v_0 / \pi$")
    axes.set_ylabel(r"$v_1 / \pi$")
    axes.set_title(_title(proof), fontsize=9)
    handles = [Patch(facecolor=COLOURS[kind], edgecolor="0.1",
                     label="%s (%d)" % (LABELS[kind], len(polygons)))
               for kind, polygons in boxes.items() if polygons]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.09),
                ncol=len(handles), fontsize=8, frameon=False)
    data = io.BytesIO()
    kind = os.fspath(path)[-3:]
    fig.savefig(data, format=kind, dpi=300, bbox_inches="tight",
                metadata={"Date": None} if kind == "svg" else
                {"CreationDate": None} if kind == "pdf" else None)
    files.write(path, data.getvalue())


def _star(proof, low, side):
    """The starting point moved into the region by multiples of 2 pi, or nothing."""
    from math import pi

    place = [(float(x) / pi - a) % 2 + a for x, a in zip(proof.xstar, low)]
    inside = all(x <= a + s for x, a, s in zip(place, low, side))
    return ([place[0]], [place[1]]) if inside else ([], [])


def _title(proof):
    centre, half = proof.problem.centre, proof.problem.half
    ranges = ",  ".join("%.9g < %s < %.9g" % (c - h, name, c + h)
                        for name, c, h in zip("abc", centre, half))
    words = "as printed: not a proof" if proof.as_printed else "converse " + proof.version
    if proof.sha256:
        words += ", proof " + proof.sha256[:16]
    return "%s\n%s, %s" % (ranges, words, proof.arithmetic)
