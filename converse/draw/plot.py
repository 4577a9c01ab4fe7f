"""The figure of the prisms of a proof, as in the thesis, and what all pictures share.

Every picture is drawn by matplotlib (the extra "plot"), whose backend and settings stay the same.
"""

import io
import os
import sys
import textwrap
from fractions import Fraction
from functools import partial

from ..model.exact import short_text
from ..prover import tree
from ..storage import files
from ..version import __version__
from . import captions
from .style import BLUE, DARK, GREEN, GREY, ORANGE, PURPLE, SALT, STYLE, VERMILLION  # noqa: F401

FORMATS = "svg", "png", "pdf"           # of all pictures, as their names end
COLOURS = {"P": "0.35", "S": "0.85", "a": ORANGE, "?": "1.0", "U": "#f4b183"}
EDGES = {"P": "0.1", "S": "0.6", "a": ORANGE, "?": "0.6", "U": VERMILLION}
WIDTHS = {"U": 0.8}                     # of the edges, in points
LAYERS = "SPa?U"                        # from the bottom: what is not proved is never hidden
MANY = 2000                             # with more prisms than this the depth of the cuts is drawn
DPI = 200                               # of a file
SINGLE = Fraction(1, 10 ** 200)         # half-widths below are drawn as 0: matplotlib fails on them
DEPTHS = "#9ecae1", "#4292c6", "#08306b"   # of the cuts
LETTERS = 17                            # of a caption, in an inch
PROGRAM = "converse " + __version__         # by which files.check_output knows its pictures
METADATA = {"svg": {"Creator": PROGRAM, "Date": None}, "png": {"Software": PROGRAM},
            "pdf": {"Creator": PROGRAM, "CreationDate": None}}


def check():
    """Raises ConverseError if matplotlib is missing."""
    try:
        _import_matplotlib()
    except ImportError:
        raise files.ConverseError(
            "figures need matplotlib; pip install 'converse-kam[plot]'") from None


def _import_matplotlib():
    """Imports it, whatever backend the environment names: figures here need none, and the one of a
    notebook may not be installed."""
    try:
        import matplotlib  # noqa: F401
    except ValueError:
        for name in [name for name in sys.modules if name.startswith("matplotlib")]:
            del sys.modules[name]               # what was imported before it failed
        backend = os.environ.pop("MPLBACKEND")
        try:
            import matplotlib  # noqa: F401
        finally:
            os.environ["MPLBACKEND"] = backend


def check_file(path, others=()):
    """The format that the name of a new figure asks for.  ConverseError, before the work starts: it
    cannot be drawn there, would overwrite one of the other files of the run or a file that is not a
    figure of this program, or matplotlib is missing."""
    files.check_output(path, "figure", FORMATS, others)
    check()
    return files.ending(path)


def write(proof, path, caption=True):
    """Draws a proof, finished or not, in a file whose name ends as one of FORMATS.

    caption: whether the lines above the prisms state what is proved and by what.
    ConverseError: the file cannot be written, or matplotlib is missing."""
    check()
    from matplotlib import style

    with style.context(["default", SALT]):
        files.write(path, encode(page(proof, caption), files.ending(path), dpi=DPI))


def encode(figure, kind, **options):
    """A Figure as the bytes of a file of that kind, without a date."""
    data = io.BytesIO()
    figure.savefig(data, format=kind, bbox_inches="tight", metadata=METADATA[kind], **options)
    return data.getvalue()


def _figure(**options):
    """A Figure that no window and no notebook's backend knows of: it draws itself."""
    from matplotlib.figure import Figure

    figure = Figure(**options)
    figure._repr_png_ = partial(encode, figure, "png", dpi=100)     # for a notebook
    return figure


def new(width, height, fill, layout=None):
    """A Figure that a notebook shows, of that size in inches.  fill(figure) draws it; the user's
    settings do not matter to it.  fill may return a caption, which is written below.  layout is an
    engine of matplotlib's; without one the margins fit a single panel."""
    check()
    from matplotlib import style

    with style.context(["default", STYLE]):
        figure = _figure(figsize=(width, height), layout=layout)
        words = fill(figure)
        if layout is None:
            figure.subplots_adjust(left=0.55 / width, right=1 - 0.1 / width, bottom=0.5 / height,
                                   top=1 - 0.4 / height)
        if words:
            lines = textwrap.wrap(words.replace("$", r"\$"), int(LETTERS * width))
            figure.text(0.1 / width, 0.0, "\n".join(lines), color="0.25", va="top",
                        linespacing=1.35)
    return figure


def written(width, height, kind, fill, layout=None, dpi=200):
    """The figure of new() as the bytes of a file of this kind; dpi: the resolution of rasters."""
    figure = new(width, height, fill, layout)
    from matplotlib import style

    with style.context(["default", STYLE]):
        return encode(figure, kind, dpi=dpi, pad_inches=0.1)


def single(size, fill, path=None, ax=None, dpi=200):
    """A picture in one pair of Axes, which fill(axes) draws: in a file, or into the given Axes, or
    as a Figure that is returned.  dpi: of the rasters in a file of vectors.

    ConverseError: the picture cannot be drawn."""
    def draw(figure):
        fill(figure.subplots())

    if path is not None:
        kind = check_file(path)
        files.write(path, written(*size, kind, draw, dpi=200 if kind == "png" else dpi))
    elif ax is None:
        return new(*size, draw)
    else:
        check()
        fill(ax)
    return ax


def page(proof, caption=True, ax=None):
    """A Figure that a notebook shows; with a caption, above it what is proved and by what.  With
    Axes the prisms are drawn there."""
    if ax is not None:
        return draw(proof, ax)
    check()
    from matplotlib.ticker import MaxNLocator

    fig = _figure(figsize=(6.4, 7.0))
    axes = draw(proof, fig.add_subplot())
    if caption:
        head, foot = ("\n".join(lines).replace("$", r"\$")
                      for lines in (captions.head(proof), captions.foot(proof)))
        axes.annotate(foot, (0.5, 1), (0, 5), "axes fraction", "offset points", fontsize=8,
                      ha="center", va="bottom")
        axes.set_title(head, fontsize=9, pad=10 + 10.5 * len(captions.foot(proof)))
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0), borderaxespad=5, ncol=3,
                    fontsize=8, frameon=False)          # below the labels of the axes
    for surface in axes.collections:
        if surface.get_array() is not None:
            fig.colorbar(surface, ax=axes, shrink=0.6, ticks=MaxNLocator(integer=True),
                         label="proved (%d): cuts of the smallest prism along v0 and v1"
                         % captions.counts(proof)["P"])
    return fig


def draw(proof, axes):
    """Draws the prisms and x* into axes, the angles in units of pi: no title and no legend, but
    the labels that a legend needs."""
    check()
    (left, width), (bottom, height) = (_axis(proof.problem, axes, k) for k in range(2))
    count = captions.counts(proof)
    paths, depths = _paths(captions.nodes(proof))
    for kind, number in count.items():
        corners = [(left + width * x, bottom + height * y) for x, y in paths.get(kind, ())]
        style = {"facecolor": COLOURS[kind], "zorder": 1 + LAYERS.index(kind) / 10,
                 "label": "%s (%d)" % (captions.KIND_NAMES[kind], number)}
        if sum(count.values()) <= MANY:
            rectangles(axes, corners, edgecolor=EDGES[kind], linewidth=WIDTHS.get(kind, 0.3),
                       **style)
        elif kind == "P":               # whose colours a colour bar explains
            _surface(axes, corners, depths, zorder=style["zorder"])
        else:
            _surface(axes, corners, **style)
    star = captions.star(proof)
    if star:
        axes.plot(left + width * star[0], bottom + height * star[1], "o", linestyle="none",
                  markersize=5, markerfacecolor="white", markeredgecolor="black",
                  label=captions.STAR)
    axes.set_aspect("equal" if width == height else "auto")
    return axes


def _axis(problem, axes, k):
    """Prepares an axis for the angle k; returns its beginning and its length.  A single value
    is drawn as a strip; in a narrow range, which doubles may not resolve, the centre is at 0."""
    low, high = problem.region[k]
    centre, half = (low + high) / 2, (high - low) / 2
    single = half < SINGLE
    strip = Fraction(1, 2) if single else half
    origin = centre if strip < abs(centre) / 10 ** 4 else 0
    low, side = float(centre - origin - strip), float(2 * strip)
    axis = (axes.xaxis, axes.yaxis)[k]
    axis.set_label_text(r"$v_%d / \pi$" % k + (
        " %s %s" % ("-" if origin > 0 else "+", short_text(abs(origin))) if origin else ""))
    (axes.set_xlim, axes.set_ylim)[k](low, low + side)
    axis.set_major_formatter("{x:.7g}")
    if origin:                          # long numbers
        axis.get_major_locator().set_params(nbins=4)
    if single:
        axis.set_ticks([float(centre - origin)])
    return low, side


def rectangles(axes, corners, **style):
    """One shape of many rectangles."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    axes.add_patch(PathPatch(Path(corners, codes * (len(corners) // 5)) if corners
                             else Path([(0, 0)]), **style))


def _spread(kind, index, cuts):
    """From where to where a prism is drawn along an axis, as parts of the region's side."""
    low, side = index / 2 ** cuts, 1 / 2 ** cuts
    if kind not in "PS" and side < captions.LEAST:
        low = min(max(low + (side - captions.LEAST) / 2, 0), 1 - captions.LEAST)
        side = captions.LEAST
    return low, low + side


def _paths(text):
    """The corners of the prisms, by kind, and the cuts of those that are proved."""
    paths, depths = {}, []
    for kind, ((i, j, *_), (k, l, *_)) in tree.cells(text):
        (x0, x1), (y0, y1) = _spread(kind, i, k), _spread(kind, j, l)
        paths.setdefault(kind, []).extend([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)])
        if kind == "P":
            depths.append(k + l)
    return paths, depths


def _surface(axes, corners, depths=None, **style):
    """Very many rectangles without edges; of those with depths, a colour for each, and the deepest
    on top: where parameters were cut a place lies in several prisms."""
    import numpy
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LinearSegmentedColormap

    shapes = numpy.reshape(corners, (-1, 5, 2))
    if depths is not None:
        order = numpy.argsort(depths, kind="stable")
        shapes, style["array"] = shapes[order], numpy.array(depths)[order]
        style["cmap"] = LinearSegmentedColormap.from_list("depths", DEPTHS)
    axes.add_collection(PolyCollection(shapes, linewidths=0, antialiaseds=False, rasterized=True,
                                       **style))
