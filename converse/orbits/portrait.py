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


def names(system):
    """The names of the coordinates, angles before momenta."""
    return [letter + str(i) * (system.dimension > 1)
            for letter in system.letters for i in range(system.dimension)]


def coordinates(system, eps, x, p, steps):
    """The orbits of the points: {name: array (steps + 1, orbits), modulo the period}."""
    if (x is None) != (p is None):
        raise ValueError("give both angles and momenta, or neither")
    if x is None:
        x, p = (system.period * each for each in starts(system.dimension))
    x, p = np.broadcast_arrays(np.asarray(x, float), np.asarray(p, float))
    n = system.dimension
    if n > 1 and x.shape[-1:] != (n,):
        raise ValueError("initial points of %d angles are arrays of shape (..., %d), not %r"
                         % (n, n, x.shape))
    orbits = x.size // n
    if not 0 < orbits * (abs(steps) + 1) <= MOST:
        raise ValueError("a portrait has 1 to %d points, not %d orbits of %d"
                         % (MOST, orbits, abs(steps) + 1))
    xs, ps = (each.reshape(abs(steps) + 1, orbits, system.dimension) % system.period
              for each in system.orbit(x, p, steps, eps))
    both = np.concatenate([xs, ps], axis=2)
    return {name: both[:, :, k] for k, name in enumerate(names(system))}


def chosen(system, plane):
    """The plane, if it is valid: a pair of names."""
    known = names(system)
    plane = (known[0], known[system.dimension]) if plane is None else tuple(plane)
    if len(plane) != 2 or plane[0] == plane[1] or not set(plane) <= set(known):
        raise ValueError("the plane is two of %s, not %r" % (", ".join(known), plane))
    return plane


def portrait(system, eps, x, p, steps, plane, ax, style):
    """See Dynamics.portrait."""
    plane = chosen(system, plane)
    plot.check()
    found = coordinates(system, eps, x, p, steps)
    columns = [found[name] for name in plane]
    if ax is not None:
        return _draw(ax, system, plane, columns, style)

    def fill(figure):
        _draw(figure.subplots(), system, plane, columns, style)

    return plot.new(4.4, 4.4, fill)


def _draw(ax, system, plane, columns, style):
    ax.plot(*columns, **{**POINTS, **style})
    period, words = system.period, PERIODS[system.period]
    ax.set(xlim=(0, period), ylim=(0, period), aspect="equal",
           **{side: r"$%s$  mod $%s$" % (_symbol(name), words)
              for side, name in zip(("xlabel", "ylabel"), plane)})
    for axis in ax.xaxis, ax.yaxis:
        if period == 1:
            axis.set_ticks([0, 0.5, 1])
        else:
            axis.set_ticks([0, math.pi, 2 * math.pi], ["$0$", r"$\pi$", r"$2\pi$"])
    if system.dimension > 1:
        ax.set_title("all points, projected to ($%s$, $%s$)" % tuple(map(_symbol, plane)))
    return ax


def _symbol(name):
    return name[0] + ("_" + name[1] if name[1:] else "")
