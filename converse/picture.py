"""The figure as SVG, PNG or PDF, drawn with matplotlib (the extra "plot")."""

import io
import os

from . import files, tree

FORMATS = (".svg", ".png", ".pdf")
COLOURS = {"P": "0.35", "S": "0.85", "?": "1.0", "U": "#ffd0d0"}
LABELS = {"P": "proved", "S": "skipped by symmetry", "?": "untried", "U": "undecided"}
RASTER = 5000                           # with more prisms than this the depth of the cuts is drawn
PIXELS = 1200


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
    counts = {kind: proof.tree.count(kind) for kind in COLOURS}
    counts["?"] = sum(kind == "?" for kind, _ in tree.cells(proof.tree))
    colours = dict(COLOURS)
    if sum(counts.values()) > RASTER:
        colours["P"] = "#35b779"
        _raster(fig, axes, proof, low, side)
    else:
        boxes = {kind: [] for kind in COLOURS}
        for kind, ((i, j, *_), (k, l, *_)) in tree.cells(proof.tree):
            x0, x1 = (low[0] + side[0] * n / 2 ** k for n in (i, i + 1))
            y0, y1 = (low[1] + side[1] * n / 2 ** l for n in (j, j + 1))
            boxes[kind].append((k + l, ((x0, y0), (x1, y0), (x1, y1), (x0, y1))))
        for kind, prisms in boxes.items():          # small ones above the large ones they share
            polygons = [box for _, box in sorted(prisms)]
            edge = {"U": "red"}.get(kind, "0.1" if kind == "P" else "0.6")
            axes.add_collection(PolyCollection(polygons, facecolors=COLOURS[kind],
                                               edgecolors=edge, linewidths=0.3))
    axes.plot(*_star(proof, low, side), "o", markersize=5, markerfacecolor="white",
              markeredgecolor="black", label="x*")
    axes.set_xlim(low[0], low[0] + (side[0] or 1))
    axes.set_ylim(low[1], low[1] + (side[1] or 1))
    axes.set_aspect("equal" if side[0] == side[1] else "auto")
    axes.set_xlabel(r"$v_0 / \pi$")
    axes.set_ylabel(r"$v_1 / \pi$")
    axes.set_title(_title(proof), fontsize=9)
    handles = [Patch(facecolor=colours[kind], edgecolor="0.1",
                     label="%s (%d)" % (LABELS[kind], count))
               for kind, count in counts.items() if count]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.09),
                ncol=len(handles), fontsize=8, frameon=False)
    data = io.BytesIO()
    kind = os.fspath(path)[-3:]
    fig.savefig(data, format=kind, dpi=300, bbox_inches="tight",
                metadata={"Date": None} if kind == "svg" else
                {"CreationDate": None} if kind == "pdf" else None)
    files.write(path, data.getvalue())


def _raster(fig, axes, proof, low, side):
    """Draws for each place how often the smallest prism there was cut; a place may lie in many
    where the parameters were cut."""
    import numpy
    depth = numpy.zeros((PIXELS, PIXELS), numpy.float32)
    kind_at = {kind: numpy.zeros((PIXELS, PIXELS), bool) for kind in "SU?"}
    for kind, ((i, j, *_), (k, l, *_)) in tree.cells(proof.tree):
        x0, x1 = i * PIXELS >> k, -(-(i + 1) * PIXELS >> k)
        y0, y1 = j * PIXELS >> l, -(-(j + 1) * PIXELS >> l)
        if kind == "P":
            part = depth[y0:y1, x0:x1]
            numpy.maximum(part, k + l, out=part)
        else:
            kind_at[kind][y0:y1, x0:x1] = True
    extent = low[0], low[0] + (side[0] or 1), low[1], low[1] + (side[1] or 1)
    image = axes.imshow(numpy.ma.masked_equal(depth, 0), cmap="viridis_r", origin="lower",
                        extent=extent, interpolation="nearest")
    for kind, places in kind_at.items():
        colour = {"S": (0.85, 0.85, 0.85, 1), "U": (0.8, 0, 0, 1), "?": (1, 1, 1, 1)}[kind]
        shown = places if kind != "S" else places & (depth == 0)
        axes.imshow(shown[..., None] * numpy.array(colour), origin="lower", extent=extent,
                    interpolation="nearest")
    fig.colorbar(image, ax=axes, shrink=0.6, label="cuts of the smallest prism along both angles")


def _star(proof, low, side):
    """The starting point moved into the region by multiples of 2 pi, or nothing."""
    from math import pi

    place = [(float(x) / pi - a) % 2 + a for x, a in zip(proof.xstar, low)]
    inside = all(x <= a + s for x, a, s in zip(place, low, side))
    return ([place[0]], [place[1]]) if inside else ([], [])


def _title(proof):
    centre, half = proof.problem.centre, proof.problem.half
    ranges = ",  ".join("%.9g < %s < %.9g" % (c - h, name, c + h) if h else
                        "%s = %.9g" % (name, c) for name, c, h in zip("abc", centre, half))
    words = "as printed: not a proof" if proof.as_printed else "converse " + proof.version
    if proof.sha256:
        words += ", proof " + proof.sha256[:16]
    return "%s\n%s, %s" % (ranges, words, proof.arithmetic)
