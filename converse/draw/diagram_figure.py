"""The figure of a diagram: SVG, PNG or PDF, by matplotlib."""

from fractions import Fraction
from math import inf

from . import plot

LINE_SIZE, PLANE_SIZE = (6.4, 2.6), (6.4, 5.0)      # inches
BAR = 0.84                              # where the bar of a line begins, as a part of the height
MARGIN, EXCLUDED = 0.02, 0.2            # beyond what is shown; of ends without tori, as parts of it
NONE, LARGER = "#7fa8d1", "#cfdeed"     # no torus; with all larger multiples
NO_TORUS, TORUS, SEEN = "proved: no torus", "proved: a torus", "seen, not proved"


def draw(diagram, path=None, ax=None):
    """Draws a diagram, as plot.single() does.  ConverseError: it cannot be drawn."""
    line = len(diagram.ranges) == 1
    return plot.single(LINE_SIZE if line else PLANE_SIZE,
                       lambda axes: (_line if line else _plane)(diagram, axes), path, ax)


def _line(diagram, axes):
    """A bar along the parameter, and below it the rotation numbers of the tori."""
    low, high = _shown(diagram)
    beyond = MARGIN * float(high - low)
    left, right = float(low) - beyond, float(high) + beyond

    def place(x):
        return min(max(float(x), left), right)

    def fill(ends, colour, words, bottom=BAR):
        axes.axvspan(*map(place, ends), bottom, 1, facecolor=colour, edgecolor=colour, label=words,
                     linewidth=0.8 if ends[0] == ends[1] or colour == plot.GREEN else 0)

    for n, ends in enumerate(diagram.none):
        fill(ends, NONE, NO_TORUS if n == 0 else None)
        for at, end, arrow in ((0, ends[0], "<"), (1, ends[1], ">")):
            if abs(end) == inf and place(ends[0]) < place(ends[1]):     # all beyond the axes
                axes.plot(at, (BAR + 1) / 2, arrow, color=NONE, markersize=12, clip_on=False,
                          transform=axes.transAxes)
    for n, torus in enumerate(diagram.tori):
        fill(torus[:2], plot.GREEN, TORUS if n == 0 else None)
        for omega in _folded(torus.rotation.floats):
            axes.plot([float(torus.low), float(torus.high)], [omega] * 2, ".-", linewidth=1.6,
                      color=plot.GREEN, markersize=5)
    for n, seen in enumerate(diagram.seen):
        axes.axvline(float(seen.value[0]), BAR, 0.92, color=plot.GREY, linewidth=0.5,
                     label=SEEN if n == 0 else None)
        for omega in _folded(seen.rotation):
            axes.plot(float(seen.value[0]), omega, ".", color=plot.GREY, markersize=2)
    axes.axhline(0.5 * BAR / (BAR - 0.04), color=plot.DARK, linewidth=0.6)
    axes.set(xlim=(left, right), ylim=(0, 0.5 / (BAR - 0.04)), xlabel=diagram.names[0],
             yticks=[0, 0.25, 0.5], ylabel="rotation %s" % ("number" if diagram.family.dimension
                                                            == 1 else "vector"))
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncol=3, frameon=False)


def _shown(diagram):
    """The range, of whose ends without tori a part is cut off."""
    (low, high), = diagram.ranges
    inside = [x for ends in (*diagram.open, *diagram.tori) for x in ends[:2]] or [low, high]
    more = Fraction(EXCLUDED) * ((max(inside) - min(inside)) or high - low)
    return max(low, min(inside) - more), min(high, max(inside) + more)


def _folded(rotation):
    """Rotation numbers in [0, 1/2]: reversal of time changes their sign, and turns do not count."""
    return [abs(omega - round(omega)) for omega in rotation]


def _plane(diagram, axes):
    """Boxes and points in the plane of two parameters."""
    for larger, colour, words in ((False, NONE, NO_TORUS),
                                  (True, LARGER, NO_TORUS + ", nor for any larger multiple")):
        corners = []
        for member in diagram.members:
            if member.rotation is None and member.larger == larger:
                (x0, x1), (y0, y1) = [list(map(float, ends)) for ends in member.box]
                corners += [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        if corners:
            plot.rectangles(axes, corners, facecolor=colour, edgecolor="white", linewidth=0.2,
                            label=words)
    for n, torus in enumerate(diagram.tori):
        axes.plot(*[list(map(float, ends)) for ends in zip(torus.low, torus.high)], "o-",
                  color=plot.GREEN, markersize=3.5, clip_on=False, label=TORUS if n == 0 else None)
    for n, seen in enumerate(diagram.seen):
        axes.plot(*map(float, seen.value), ".", color=plot.GREY, markersize=2,
                  label=SEEN if n == 0 else None)
    ranges = [list(map(float, ends)) for ends in diagram.ranges]
    axes.set(xlim=ranges[0], ylim=ranges[1], xlabel=diagram.names[0], ylabel=diagram.names[1])
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0), borderaxespad=4.5, ncol=2)
