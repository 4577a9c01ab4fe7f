"""The figure of a map: SVG, PNG or PDF, by matplotlib."""

import math

try:
    import numpy as np
except ImportError:                     # matplotlib brings it, and plot.check() says so
    np = None  # type: ignore[assignment]

from ..model.map import LINE
from ..parameters.map import AT_ONCE, PROVED
from ..parameters.region import direction
from ..storage import files
from . import plot

PARAMETERS = "abc"
COLOURS = {PROVED: "#7fa8d1", AT_ONCE: "#cfdeed"}
WORDS = {PROVED: "proved cell by cell: no tori",
         AT_ONCE: "proved at once, with all larger multiples"}
MARKER = {"markersize": 7, "markerfacecolor": "white", "markeredgecolor": "black",
          "linestyle": "none"}
MARKED_POINTS = (                       # of the dashed line, a = b = c/2
    (0.0272, "o", "\u03b5 \u2265 0.0272: no torus (1989)"),
    (0.01389, "*", "\u03b5 \u2265 0.01389: no torus"),
    (0.0122, "s", "\u03b5 = 0.0122: a torus"))
SIZE = 6.4, 5.0                         # inches
SAMPLES = 120                           # of the angles, and of the directions of a side
AT_ONCE_LEVEL = 4 / 3                   # of B - 2, above which Mather's criterion proves


def largest(p):
    """B - 2 of amplitudes (a, b, c), an array (..., 3): to a few digits, on a grid of angles."""
    y = np.linspace(0, 2 * math.pi, SAMPLES, endpoint=False)
    sines = np.sin(y)[:, None], np.sin(y)[None], np.sin(y[:, None] + y)
    a, b, c = (np.asarray(p, float)[..., i, None, None] for i in range(3))
    p0, p1, both = a * sines[0], b * sines[1], c * sines[2]
    return ((p0 + p1) / 2 + both + np.hypot((p0 - p1) / 2, both)).max((-1, -2))


def draw(region_map, path=None, tori=(), ax=None):
    """Draws a map, with the points (a, b, c) at which tori are proved, as plot.single() does.

    ConverseError: it cannot be drawn, or is not estimated yet."""
    return plot.single(SIZE, lambda axes: _fill(region_map, axes, tori), path, ax)


def _fill(region_map, axes, tori):
    if not all(region_map.estimate):
        raise files.ConverseError("the map has nothing to draw yet: it was left while the frontier "
                                  "was estimated; continue it with -r")
    horizontal, vertical = {"b=0": (0, 2), "a=b": (0, 2), "c=0": (0, 1)}[region_map.region]

    def at(directions, r, s):
        point = direction(directions, s)
        return float(r * point[horizontal]), float(r * point[vertical])

    corners = {PROVED: [], AT_ONCE: []}
    for leaf in region_map.leaves():
        if leaf.kind in corners:
            (r0, s0), (r1, s1) = leaf.cell.low, leaf.cell.high
            directions = region_map.directions[leaf.cell.face]
            ends = [(r0, s0), (r1, s0), (r1, s1), (r0, s1), (r0, s0)]
            corners[leaf.kind] += [at(directions, r, s) for r, s in ends]
    for kind, points in corners.items():
        plot.rectangles(axes, points, facecolor=COLOURS[kind], edgecolor="white",
                           linewidth=0.2, label=WORDS[kind])
    unit = [direction(directions, k / SAMPLES) for directions in region_map.directions
            for k in range(SAMPLES + 1)]
    mather = np.array(unit) * (AT_ONCE_LEVEL / largest(unit))[:, None]
    estimate = np.array([at(directions, radius, s)
                         for directions, found in zip(region_map.directions, region_map.estimate)
                         for s, radius in sorted(found.items())])
    axes.plot(*_around(mather[:, (horizontal, vertical)]).T, ":", color=plot.DARK, linewidth=1.2,
              label="B = 10/3, where no orbit is needed")
    axes.plot(*_around(estimate).T, color=plot.VERMILLION, linewidth=1.6,
              label="estimate: single points proved to here")
    if tori := list(filter(region_map.in_plane, tori)):
        places = np.array(sorted((float(p[horizontal]), float(p[vertical])) for p in tori))
        axes.plot(*places.T, "o", color=plot.GREEN, markersize=3.5,
                  label="a torus is proved there", clip_on=False)
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
