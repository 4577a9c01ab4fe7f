"""Figures of chapter 1 and section 2.1: the standard map, twist maps, billiards, a cantorus."""

import numpy as np

from converse.draw.plot import BLUE, DARK, VERMILLION
from converse.orbits.pictures import exponents_words, kind, quality
from converse.orbits.potential import standard
from converse.orbits.state import vector_words

KICKS = 0.5, 0.97, 2.0                  # k; the thesis: small, the middle, more than 4/3
ON_CYLINDER = 0.38, 0.62                # momenta at x = 0 of the orbits on the cylinder
CANTORUS = 1.001635, (377,), 987        # k, and the rotation number: near 1/gamma^2


def std_demo(figure, families):
    """Phase portraits of the standard map."""
    axes = figure.subplots(1, 3, sharey=True, gridspec_kw={"wspace": 0.12})
    for panel, k in zip(axes, KICKS):
        standard.portrait(eps=k, steps=200, ax=panel)
        panel.set_title("$k$ = %g" % k)
    for panel in axes[1:]:
        panel.set_ylabel("")
    return ("The standard map: 200 iterates of 20 points, spread evenly.  The thesis does not say "
            "the three k (the last is more than 4/3) or the points; these were chosen here.")


def cyl_def(figure, families):
    """The cylinder, its coordinates, and orbits of the standard map on it."""
    axes = figure.subplots()
    turn = np.linspace(0, 1, 201)
    for p in 0.0, 1.0:
        for style, front in (("-", True), ("--" if p == 0 else "-", False)):
            part = (turn >= 0.5) == front
            axes.plot(*cylinder(turn[part], p), style, color=DARK)
    axes.plot([-1, -1, np.nan, 1, 1], [0, 1, np.nan, 0, 1], color=DARK)
    xs, ps = standard.orbit(np.zeros(len(ON_CYLINDER)), ON_CYLINDER, 400, KICKS[0])
    front = xs % 1.0 >= 0.5
    for seen, colour in (~front, "0.75"), (front, DARK):
        axes.plot(*cylinder(xs[seen], ps[seen]), "o", markersize=1.3, markeredgewidth=0,
                  color=colour)
    x, y = cylinder(np.linspace(0.65, 0.85, 41), -0.12)
    axes.plot(x, y, color=BLUE)
    arrow = {"arrowstyle": "->", "color": BLUE, "shrinkA": 0, "shrinkB": 0}
    for head, foot in (((x[-1], y[-1]), (x[-3], y[-3])), ((1.15, 0.85), (1.15, 0.15))):
        axes.annotate("", head, foot, arrowprops=arrow)
    axes.annotate("$x$ mod 1", (x[20], y[20]), (0, -9), textcoords="offset points", ha="center",
                  va="center")
    axes.annotate("$p$", (1.15, 0.5), (4, 0), textcoords="offset points", va="center")
    axes.set(xlim=(-1.1, 1.35), ylim=(-0.5, 1.3), aspect="equal")
    axes.set_axis_off()
    return ("The cylinder: round it the angle, x modulo 1, along it the momentum p.  On it %d "
            "orbits of the standard map, k = %g, 400 iterates of each, those behind in grey."
            % (len(ON_CYLINDER), KICKS[0]))


def cylinder(x, p):
    """Points of the cylinder as they are drawn: arrays of both coordinates.  x from 1/2 to 1 is in
    front."""
    return np.cos(2 * np.pi * x), p + 0.22 * np.sin(2 * np.pi * x)


def twist(figure, families):
    """Vertical lines and their images under two twist maps."""
    before, after = figure.subplots(1, 2, sharey=True, width_ratios=(1, 2),
                                    gridspec_kw={"wspace": 0.12})
    p = np.linspace(0, 1, 200)
    for x, colour in zip((1 / 6, 1 / 2, 5 / 6), (DARK, BLUE, VERMILLION)):
        before.plot(np.full(len(p), x), p, color=colour)
        after.plot(*twisted(x, p), color=colour)
        after.plot(*standard.map(np.full(len(p), x), p, KICKS[0]), color=colour, linewidth=0.8,
                   linestyle=":")
    before.set(xlim=(0, 1), aspect="equal", xlabel="$x$", ylabel="$p$", title="vertical lines")
    after.set(xlim=(0, 2), aspect="equal", xlabel="$x'$", ylabel="$p'$", title="their images")
    return ("A twist map carries vertical lines to monotone curves.  Here p' = p − (k/2π) sin 2πx, "
            "x' = x + p' + (sin 2πp')/4π, not reduced to the circle, k = %g, chosen here; dotted: "
            "the standard map, without the last term." % KICKS[0])


def twisted(x, p):
    """The image of (x, p) under an area-preserving map whose twist dx'/dp is not constant."""
    p = p - KICKS[0] / (2 * np.pi) * np.sin(2 * np.pi * x)
    return x + p + np.sin(2 * np.pi * p) / (4 * np.pi), p


def billiards(figure, families):
    """The longest star with five points in a convex curve."""
    axes = figure.subplots()
    grid = 2 * np.pi * np.arange(4000) / 4000
    x, y = table(grid)
    length, star = longest_star(x, y)
    axes.plot(np.append(x, x[0]), np.append(y, y[0]), color=DARK)
    closed = np.append(star, star[0])
    axes.plot(x[closed], y[closed], color=BLUE)
    axes.plot(x[star], y[star], "o", markersize=4, color=BLUE)
    for j, k in enumerate(star):
        axes.annotate("$x_%d$" % j, (x[k], y[k]), (8 * x[k], 8 * y[k]), ha="center", va="center",
                      textcoords="offset points")
    axes.set_aspect("equal")
    axes.margins(0.08)
    axes.set_axis_off()
    return ("Billiards: the longest star with five points (p = 2, q = 5) in the curve x = cos t + "
            "(cos 2t)/12, y = (4/5) sin t, chosen here; of length %.3f, the best that 16 starts "
            "lead to." % length)


def table(t):
    """The boundary of the billiard table, t from 0 to 2 pi: arrays of x and of y."""
    return np.cos(t) + np.cos(2 * t) / 12, 0.8 * np.sin(t)


def longest_star(x, y):
    """The longest polygon found with five corners on a curve that turns twice: its length, and the
    indices of its corners.

    x, y -- points of the curve
    Each corner in turn is moved to the point that makes the polygon longest, until none moves."""
    best = 0.0, None
    n = len(x)
    for k in range(16):
        star, before = [(k * n // 80 + 2 * j * n // 5) % n for j in range(5)], None
        while star != before:
            before = list(star)
            for j in range(5):
                a, b = star[j - 1], star[(j + 1) % 5]
                star[j] = int(np.argmax(np.hypot(x - x[a], y - y[a])
                                        + np.hypot(x - x[b], y - y[b])))
        ends = star[1:] + star[:1]
        length = float(np.hypot(x[ends] - x[star], y[ends] - y[star]).sum())
        best = max(best, (length, star))
    return best


def cantorus(figure, families):
    """A cantorus of the standard map, approximated by a periodic orbit."""
    axes = figure.subplots()
    k, p, q = CANTORUS
    state = families(standard, (p, q), (k,))[0]
    x = state.x[:, 0]
    y = state.momenta[:, 0] - k / (4 * np.pi) * np.sin(2 * np.pi * x)
    axes.plot(x, y, "o", markersize=1.6, markeredgewidth=0, color=DARK)
    axes.set(xlim=(0, 1), xlabel="$x$", ylabel=r"$y = p - \frac{k}{4\pi}\,\sin 2\pi x$")
    at = np.sort(x)
    gaps = np.diff(at, append=at[0] + 1)
    widest = int(np.argmax(gaps))
    return ("A cantorus of the standard map, approached by a periodic orbit: k = %r, rotation "
            "number %s = %.6f; %s; %s; %s.  The widest gap is %.4f, about x = %.4f.  The range of "
            "y is chosen here." % (k, vector_words(p, q), p[0] / q, kind(state), quality(state),
                              exponents_words(state), gaps[widest],
                              round((at[widest] + gaps[widest] / 2) % 1.0, 4) % 1.0))
