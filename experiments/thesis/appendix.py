"""Figures of Appendix A: Farey's tree and triangles."""

import itertools
from fractions import Fraction

import farey
import numpy as np

from converse.draw.plot import DARK, VERMILLION
from converse.tori.nearest import LOWER, UPPER, halves

from . import shared

LEVELS = 5                              # of the triangles


def tree(figure, families):
    """Levels of Farey's tree and the golden mean."""
    axes = figure.subplots()
    ends = [(0, 1), (1, 1)]
    for level in range(3):
        axes.plot([0, 1], [-level, -level], color=DARK, linewidth=0.8)
        mediants = [tuple(map(sum, zip(*pair))) for pair in zip(ends, ends[1:])]
        best = next(itertools.islice(farey.tree(shared.GOLDEN), level, None))
        for p, q in ends + mediants:
            new = (p, q) in mediants
            axes.plot([p / q] * 2, [-level - 0.07, -level + 0.07], color=DARK, linewidth=0.8)
            axes.annotate("(%d, %d)" % (p, q), (p / q, -level), (0, -13 if new else 7), ha="center",
                          textcoords="offset points", color=DARK if new else "0.45",
                          weight="bold" if ((p,), q) == best[:2] else "normal")
        axes.plot(float(shared.GOLDEN), -level, "o", color=DARK, markersize=4)
        axes.annotate("level %d" % level, (-0.06, -level), ha="right", va="center")
        ends = sorted(ends + mediants, key=lambda end: Fraction(*end))
    axes.set(xlim=(-0.2, 1.05), ylim=(-2.3, 0.3))
    axes.set_axis_off()
    return ("Farey's tree: above, the ends of a level's intervals, below, their mediants.  The dot "
            "is the golden mean; in bold its approximant, the mediant with the largest p + q of "
            "its level.")


def trimed(figure, families):
    """How a Farey triangle is cut in two."""
    axes = figure.subplots()
    corners = {"A": (1, -1), "B": (0, 0), "C": (-1, -1), "M = A + C": (0, -1)}
    a, b, c, m = corners.values()
    axes.plot(*zip(a, b, c, a), color=DARK)
    axes.plot(*zip(b, m), color=DARK, linestyle="--")
    for name, (x, y) in corners.items():
        axes.plot(x, y, "o", color=DARK, markersize=3.5)
        axes.annotate(name, (x, y), (10 * x, 8 if name == "B" else -12), ha="center", va="center",
                      textcoords="offset points", fontsize=9)
    for letter, x, where in (("r", -0.33, "(C, M, B)"), ("l", 0.33, "(B, M, A)")):
        axes.annotate("%s\n%s" % (letter, where), (x, -0.72), ha="center", va="center")
    axes.set_aspect("equal")
    axes.margins(0.12, 0.2)
    axes.set_axis_off()
    return ("A triangle (A, B, C) of triples (p0, p1, q), its right angle at B, is cut at the sum "
            "of the ends of its hypotenuse into a right one and a left one.")


def tri(figure, families):
    """Levels of Farey's triangles."""
    ideal, true = figure.subplots(1, 2)
    corners = {point: np.array(point[:2], float) for point in LOWER + UPPER}
    cells = [LOWER, UPPER]
    for level in range(LEVELS):
        style = {"color": DARK, "linewidth": 1.2 - 0.2 * level}
        for cell in cells:
            loop = cell + cell[:1]
            ideal.plot(*np.array([corners[point] for point in loop]).T, **style)
            true.plot(*np.array([(p0 / q, p1 / q) for p0, p1, q in loop]).T, **style)
        parts = [half for cell in cells for half in halves(cell)]
        for (a, _, c), (_, middle, _) in zip(cells, parts[::2]):
            corners[middle] = (corners[a] + corners[c]) / 2
        cells = parts
    place = [np.array(point[:2], float) for point in UPPER]
    for _ in range(60):                     # rrr...: (A, B, C) <- (C, A + C, B)
        a, b, c = place
        place = [c, (a + c) / 2, b]
    ideal.plot(*place[0], "o", color=VERMILLION, markersize=4)
    true.plot(*map(float, shared.SPIRAL_MEAN), "o", color=VERMILLION, markersize=4)
    for letter, panel, ticks in (("a", ideal, ()), ("b", true, (0, 1))):
        panel.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), title="(%s)" % letter, xticks=ticks,
                  yticks=ticks)
    true.set(xlabel="$w_0$", ylabel="$w_1$")
    return ("Levels 0 to %d of the Farey triangles: (a) with all cuts in the middle, (b) where the "
            "rational vectors lie in the unit square.  The dot is the spiral mean, rrr..."
            % (LEVELS - 1))
