"""Phase portraits: orbits of a map, drawn on the cylinder or, with two angles, in a plane."""

import math

import numpy as np

from ..draw import plot

STARTS = 20                 # initial points, unless some are given
MOST = 10 ** 7              # points computed for a portrait
PERIODS = {1.0: "1", 2 * math.pi: r"2\pi"}
POINTS = {"linestyle": "none", "marker": "o", "markersize": 1.3, "markeredgewidth": 0,
          "rasterized": True, "color": plot.DARK}


def starts(n, count=STARTS):
    """Initial points spread evenly over angles and momenta of period 1: arrays (count, n), of
    angles and of momenta.  For n = 1 they have shape (count,).

    The coordinates of point k are (k + 1/2)/g^i modulo 1, i = 1 to 2n, with g^(2n+1) = g + 1."""
    d = 2 * n
    g = 2.0
    for _ in range(60):
        g = (1 + g) ** (1 / (d + 1))
    points = (np.arange(count)[:, None] + 0.5) / g ** np.arange(1, d + 1) % 1.0
    x, p = points[:, :n], points[:, n:]
    return (x[:, 0], p[:, 0]) if n == 1 else (x, p)


def portrait(system, eps, x, p, steps, ax, style):
    """See Dynamics.portrait."""
    if (x is None) != (p is None):
        raise ValueError("give both angles and momenta, or neither")
    if x is None:
        x, p = (system.period * each for each in starts(system.dimension))
    x, p = system._points(x, p, eps)
    orbits = x.size // system.dimension
    if not 0 < orbits * (abs(steps) + 1) <= MOST:
        raise ValueError("a portrait has 1 to %d points, not %d orbits of %d"
                         % (MOST, orbits, abs(steps) + 1))
    plot.check()
    columns = [each.reshape(abs(steps) + 1, orbits, system.dimension)[:, :, 0] % system.period
               for each in system.orbit(x, p, steps, eps)]
    return plot.single((4.4, 4.4), lambda axes: _draw(axes, system, columns, style), ax=ax)


def _draw(ax, system, columns, style):
    ax.plot(*columns, **{**POINTS, **style})
    period, plane = system.period, [letter + "_0" * (system.dimension > 1)
                                    for letter in system.letters]
    ax.set(xlim=(0, period), ylim=(0, period), aspect="equal",
           **{side: r"$%s$  mod $%s$" % (name, PERIODS[period])
              for side, name in zip(("xlabel", "ylabel"), plane)})
    for axis in ax.xaxis, ax.yaxis:
        if period == 1:
            axis.set_ticks([0, 0.5, 1])
        else:
            axis.set_ticks([0, math.pi, 2 * math.pi], ["$0$", r"$\pi$", r"$2\pi$"])
    if system.dimension > 1:
        ax.set_title("all points, projected to ($%s$, $%s$)" % tuple(plane))
