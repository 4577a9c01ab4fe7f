"""Phase portraits: orbits of a map, drawn on the cylinder or, with two angles, in a plane."""

import math

import numpy as np

from ..draw import plot

STARTS = 20                 # initial points, unless some are given
MOST = 10 ** 7              # points computed for a portrait
LABELS = {                  # by period: of an angle or momentum of period 1, and of period 2 pi
    1: {"x": r"$x%s$  mod $1$", "p": r"$p%s$  mod $1$"},
    2 * math.pi: {"x": r"$y%s = 2\pi x%s$  mod $2\pi$", "p": r"$J%s = 2\pi p%s$  mod $2\pi$"},
}
POINTS = {"linestyle": "none", "marker": "o", "markersize": 1.3, "markeredgewidth": 0,
          "rasterized": True, "color": plot.DARK}


def starts(n, count=STARTS):
    """Initial points spread evenly over angles and momenta: arrays (count, n), of x and of p.  For
    n = 1 they have shape (count,).

    The coordinates of point k are (k + 1/2)/g^i modulo 1, i = 1 to 2n, with g^(2n+1) = g + 1."""
    d = 2 * n
    g = 2.0
    for _ in range(60):
        g = (1 + g) ** (1 / (d + 1))
    points = (np.arange(count)[:, None] + 0.5) / g ** np.arange(1, d + 1) % 1.0
    x, p = points[:, :n], points[:, n:]
    return (x[:, 0], p[:, 0]) if n == 1 else (x, p)


def names(n):
    """What the coordinates are called, x before p."""
    return ["x", "p"] if n == 1 else ["x0", "x1", "p0", "p1"]


def coordinates(potential, eps, x, p, steps):
    """The orbits of the points: {name: array (steps + 1, orbits), modulo 1}."""
    if (x is None) != (p is None):
        raise ValueError("give both x and p, or neither")
    if x is None:
        x, p = starts(potential.n)
    x, p = np.broadcast_arrays(np.asarray(x, float), np.asarray(p, float))
    if potential.n == 2 and x.shape[-1:] != (2,):
        raise ValueError("initial points of two angles are arrays of shape (..., 2), not %r"
                         % (x.shape,))
    orbits = x.size // potential.n
    if not 0 < orbits * (abs(steps) + 1) <= MOST:
        raise ValueError("a portrait has 1 to %d points, not %d orbits of %d"
                         % (MOST, orbits, abs(steps) + 1))
    xs, ps = (each.reshape(abs(steps) + 1, orbits, potential.n) % 1.0
              for each in potential.orbit(x, p, steps, eps))
    both = np.concatenate([xs, ps], axis=2)
    return {name: both[:, :, k] for k, name in enumerate(names(potential.n))}


def chosen(potential, plane, within):
    """The plane and the conditions of a slice, if they are valid: a pair of names, and
    {name: (middle, half width)}."""
    known = names(potential.n)
    plane = (known[0], known[potential.n]) if plane is None else tuple(plane)
    if len(plane) != 2 or plane[0] == plane[1] or not set(plane) <= set(known):
        raise ValueError("the plane is two of %s, not %r" % (", ".join(known), plane))
    conditions = {}
    for name, pair in dict(within or {}).items():
        try:
            middle, half = map(float, pair)
            valid = name in known and name not in plane and math.isfinite(middle) and 0 < half
        except (TypeError, ValueError):
            valid = False
        if not valid:
            raise ValueError("within says {name: (middle, half width)} of coordinates that are not "
                             "in the plane, %s here; not %r: %r"
                             % (", ".join(set(known) - set(plane)) or "none", name, pair))
        conditions[name] = middle, half
    return plane, conditions


def title(potential, plane, conditions):
    """What a portrait shows of orbits with more than two coordinates; "" if it shows all."""
    if potential.n == 1:
        return ""
    words = [_math(name) for name in plane]
    if not conditions:
        return "all points, projected to (%s, %s)" % tuple(words)
    return "slice: points with %s modulo 1" % ", ".join(
        r"$|%s - %g| \leq %g$" % (_symbol(name), *pair) for name, pair in conditions.items())


def portrait(potential, eps, x, p, steps, plane, within, period, ax, style):
    """See Potential.portrait."""
    if period not in LABELS:
        raise ValueError("the period is 1 or 2 * math.pi, not %r" % (period,))
    plane, conditions = chosen(potential, plane, within)
    plot.check()
    found = coordinates(potential, eps, x, p, steps)
    seen = np.ones(found[plane[0]].shape, bool)
    for name, (middle, half) in conditions.items():
        off = found[name] - middle
        seen &= abs(off - np.rint(off)) <= half
    columns = [np.where(seen, period * found[name], np.nan) for name in plane]
    if ax is not None:
        return _draw(ax, potential, plane, conditions, columns, period, style)

    def fill(figure):
        _draw(figure.subplots(), potential, plane, conditions, columns, period, style)

    return plot.new(4.4, 4.4, fill)


def _draw(ax, potential, plane, conditions, columns, period, style):
    ax.plot(*columns, **{**POINTS, **style})
    ax.set(xlim=(0, period), ylim=(0, period), aspect="equal",
           xlabel=_label(plane[0], period), ylabel=_label(plane[1], period))
    for axis in ax.xaxis, ax.yaxis:
        if period == 1:
            axis.set_ticks([0, 0.5, 1])
        else:
            axis.set_ticks([0, math.pi, 2 * math.pi], ["$0$", r"$\pi$", r"$2\pi$"])
    words = title(potential, plane, conditions)
    if words:
        ax.set_title(words)
    return ax


def _symbol(name):
    return name[0] + ("_" + name[1] if name[1:] else "")


def _math(name):
    return "$%s$" % _symbol(name)


def _label(name, period):
    text = LABELS[period][name[0]]
    return text.replace("%s", "_" + name[1] if name[1:] else "")
