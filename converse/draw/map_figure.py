"""The figure of a map: SVG, PNG or PDF, by matplotlib."""

import math

try:
    import numpy as np
except ImportError:                     # matplotlib brings it, and plot.check() says so
    np = None  # type: ignore[assignment]

from ..maps.map import AT_ONCE, OPEN, PROVED
from ..maps.region import RADIUS, direction
from ..model.problem import LINE
from ..storage import files
from . import notebook, plot
from .figure import format_of

PARAMETERS = "abc"
STYLE = {**plot.STYLE, "axes.spines.top": False, "axes.spines.right": False}
COLOURS = {PROVED: "#7fa8d1", AT_ONCE: "#cfdeed"}
WORDS = {PROVED: "proved cell by cell: no tori",
         AT_ONCE: "proved at once, with all larger multiples"}
MARKER = {"markersize": 7, "markerfacecolor": "white", "markeredgecolor": "black",
          "linestyle": "none"}
MARKED_POINTS = (                       # of the dashed line, a = b = c/2
    (0.0272, "o", "\u03b5 \u2265 0.0272: no torus (1989)"),
    (0.01389, "*", "\u03b5 \u2265 0.01389: no torus"),
    (0.0120, "s", "\u03b5 = 0.0120: a torus"))
SAMPLES = 120                           # of the angles, and of the directions of a side
AT_ONCE_LEVEL = 4 / 3                   # of B - 2, above which Mather's criterion proves


def largest(p):
    """B - 2 of amplitudes (a, b, c), an array (..., 3): to a few digits, on a grid of angles."""
    y = np.linspace(0, 2 * math.pi, SAMPLES, endpoint=False)
    sines = np.sin(y)[:, None], np.sin(y)[None], np.sin(y[:, None] + y)
    a, b, c = (np.asarray(p, float)[..., i, None, None] for i in range(3))
    p0, p1, both = a * sines[0], b * sines[1], c * sines[2]
    return ((p0 + p1) / 2 + both + np.hypot((p0 - p1) / 2, both)).max((-1, -2))


def check(path):
    """The format that a figure's name asks for; ConverseError: it cannot be drawn there."""
    kind = format_of(path)
    if kind not in plot.FORMATS:
        raise files.ConverseError("%s: a map is drawn as %s; name the picture so"
                                  % (path, ", ".join("." + each for each in plot.FORMATS)))
    files.check_writable(path)
    plot.check()
    return kind


def draw(region_map, path, tori=()):
    """Draws a map in a file, and in that of a plane the points (a, b, c) at which tori are proved;
    ConverseError: it cannot be drawn, or has no estimate yet."""
    kind = check(path)
    files.write(path, picture(region_map, kind, tori))


def html(region_map):
    """What a notebook shows of a map: what is proved, and its picture."""
    return notebook.html(region_map.report(), lambda: picture(region_map, "png"), "png", "the map")


def picture(region_map, kind, tori=()):
    """A map, and points at which tori are proved, as the bytes of a file of that kind."""
    plot.check()
    if not all(region_map.estimate):
        raise files.ConverseError("the map has nothing to draw yet: it was left while the frontier "
                                  "was estimated; continue it with -r")
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE]):
        figure = Figure(figsize=(6.4, 5.0))
        if len(region_map.directions[0]) == 3:
            _draw_sphere(region_map, figure)
        else:
            _draw_plane(region_map, figure, tori)
        return plot.encode(figure, kind, dpi=160, pad_inches=0.08)


def _draw_plane(region_map, figure, tori):
    horizontal, vertical = {"b=0": (0, 2), "a=b": (0, 2), "c=0": (0, 1)}[region_map.region]
    axes = figure.add_subplot()

    def at(directions, r, place):
        point = direction(directions, place)
        return float(r * point[horizontal]), float(r * point[vertical])

    corners = {PROVED: [], AT_ONCE: []}
    for leaf in region_map.leaves():
        if leaf.kind in corners:
            (r0, s0), (r1, s1) = leaf.cell.low, leaf.cell.high
            directions = region_map.directions[leaf.cell.face]
            ends = [(r0, s0), (r1, s0), (r1, s1), (r0, s1), (r0, s0)]
            corners[leaf.kind] += [at(directions, r, (s,)) for r, s in ends]
    for kind, points in corners.items():
        plot.rectangles(axes, points, facecolor=COLOURS[kind], edgecolor="white",
                           linewidth=0.2, label=WORDS[kind])
    unit = [direction(directions, (k / SAMPLES,)) for directions in region_map.directions
            for k in range(SAMPLES + 1)]
    mather = np.array(unit) * (AT_ONCE_LEVEL / largest(unit))[:, None]
    estimate = np.array([at(directions, radius, place)
                         for directions, found in zip(region_map.directions, region_map.estimate)
                         for place, radius in sorted(found.items())])
    axes.plot(*_around(mather[:, (horizontal, vertical)]).T, ":", color=plot.DARK, linewidth=1.2,
              label="B = 10/3, where no orbit is needed")
    axes.plot(*_around(estimate).T, color=plot.VERMILLION, linewidth=1.6,
              label="estimate: single points proved to here")
    if tori:
        places = np.array(sorted((float(p[horizontal]), float(p[vertical])) for p in tori))
        axes.plot(*places.T, "o", color=plot.GREEN, markersize=3.5,
                  label="a torus is proved there")
    if region_map.region == "a=b":
        ends = np.array([0, 0.03]) * float(LINE)
        axes.plot(ends, 2 * ends, "--", color=plot.DARK, linewidth=0.6)
        for epsilon, marker, words in MARKED_POINTS:
            axes.plot(LINE * epsilon, 2 * LINE * epsilon, marker, label=words, **MARKER)
    most = 1.08 * mather.max()
    axes.set(xlim=(0, most), ylim=(0, 1.08 * mather[:, vertical].max()), aspect="equal",
             xlabel={"a=b": "a = b"}.get(region_map.region, "a"), ylabel=PARAMETERS[vertical])
    axes.set_title("The plane %s; white: undecided" % region_map.region.replace("=", " = "))
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0), borderaxespad=4.5, ncol=2)


def _around(points):
    """In the order of the angle, so that faces follow each other."""
    return points[np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")]


def heights(region_map, count):
    """By face, at the middles of count x count squares of directions (or count intervals): the
    radius from which on all is proved."""
    made = []
    for directions, tree in zip(region_map.directions, region_map.roots):
        sides = len(directions) - 1
        height = np.zeros((count,) * sides)
        for leaf in tree.nodes():
            if leaf.kind == OPEN and not leaf.halves:
                where = tuple(slice(math.ceil(low * count - 0.5), math.ceil(high * count - 0.5))
                              for low, high in zip(leaf.cell.low[1:], leaf.cell.high[1:]))
                height[where] = np.maximum(height[where], float(leaf.cell.high[0]))
        made.append(height)
    return made


def _draw_sphere(region_map, figure):
    """Each direction of the fundamental domain at its place in a triangle, coloured by B - 2 where
    its proof begins."""
    from matplotlib.tri import Triangulation

    places, values = [], []
    middles = (np.arange(SAMPLES) + 0.5) / SAMPLES
    for directions, height in zip(region_map.directions, heights(region_map, SAMPLES)):
        d0, d1, d2 = (np.array(d, float) for d in directions)
        unit = d0 + middles[:, None, None] * d1 + middles[None, :, None] * d2
        a, b, c = np.moveaxis(unit, -1, 0)
        inside = (b <= a) & (height < RADIUS)
        places.append(np.stack((b + c / 2, math.sqrt(0.75) * c), -1)[inside]
                      / (a + c)[inside, None])
        values.append(height[inside] * np.concatenate(
            [largest(row) for row in unit])[inside.ravel()])
    x, y = np.concatenate(places).T
    values = np.concatenate(values)
    axes = figure.add_subplot()
    mesh = axes.tricontourf(Triangulation(x, y), values, levels=np.arange(0.6, 1.36, 0.025),
                            cmap="viridis", extend="both")
    mesh.set_rasterized(True)               # ten thousand triangles
    figure.colorbar(mesh, ax=axes, shrink=0.7,
                    label="B \u2212 2 from which on there are no tori, proved")
    axes.plot([0, 1, 0.5, 0], [0, 0, math.sqrt(0.75), 0], color=plot.DARK, linewidth=0.8)
    for place, words, align in (((0, 0), "a alone", "top"), ((1, 0), "a = b", "top"),
                                ((0.5, math.sqrt(0.75)), "c alone", "bottom")):
        axes.annotate(words, place, (0, -4 if align == "top" else 4), textcoords="offset points",
                      ha="center", va=align)
    line = np.array([1, 1, 2]) / 3
    at_line = line[1] + line[2] / 2, math.sqrt(0.75) * line[2]
    axes.plot(*at_line, "*", **MARKER)
    axes.annotate("a = b = c/2", at_line, (7, 4), textcoords="offset points", bbox={
        "boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none"})
    axes.set_title("all directions with a \u2265 b \u2265 0, c \u2265 0")
    axes.set_aspect("equal")
    axes.set_axis_off()
