"""Pictures of invariant tori: over the angles, their Fourier coefficients, and how far the error of
a proved torus is below what the theorem allows.  Needs matplotlib (the extra "plot")."""

import math
import textwrap

import numpy as np

from ..model.exact import range_text, rounded_text
from ..storage import files
from . import plot
from .plot import BLUE, DARK, GREY, VERMILLION

POINTS = 600                # of the curve that is a torus of one angle
CURVES = 5                  # for a range of parameters
SIDE = 96                   # points of each angle of a torus of two
LATTICE = 20000             # modes that are drawn, at most: those with the largest coefficients
TURN = 2 * math.pi


def draw(tori, ax=None, proved=(), path=None):
    """A picture of tori that cover a range, or of one torus: in a file, as its name says; or the
    tori drawn into Axes; or a Figure that a notebook shows.  ConverseError: it cannot be drawn.

    proved -- of each what its proof says (proved.Piece)"""
    def fill(figure):
        _fill(figure, tori, proved)

    if path is not None:
        kind = plot.check_file(path)
        files.write(path, plot.written(*_size(tori, proved), kind, fill, "constrained"))
    elif ax is None:
        return plot.new(*_size(tori, proved), fill, "constrained")
    else:
        into(ax, tori)
    return ax


def _panels(tori, proved):
    """How many panels there are: in a row, and rows."""
    panels = tori[0].dimension + 1 + (len(proved) > 1)
    columns = 2 if panels == 4 else panels
    return columns, panels // columns


def _size(tori, proved):
    columns, rows = _panels(tori, proved)
    return 3.1 * columns, 2.9 * rows


def _fill(figure, tori, proved):
    n, (columns, rows) = tori[0].dimension, _panels(tori, proved)
    axes = np.ravel(figure.subplots(rows, columns))
    into(axes[:n], tori)
    (_line if n == 1 else _lattice)(figure, axes[n], tori[-1])
    if len(proved) > 1:
        _errors(axes[n + 1], proved)
    figure.suptitle(_title(tori, 50 * columns, proved), fontsize=9)


def into(ax, tori):
    """Draws the tori into Axes: one with one angle, a pair with two.
    ValueError: there are more or fewer Axes."""
    axes = np.ravel(ax)
    n = tori[0].dimension
    if len(axes) != n:
        raise ValueError("a torus of %d angle%s is drawn into %d Axes, not %d"
                         % (n, "s" * (n > 1), n, len(axes)))
    if n == 1:
        _curves(axes[0], tori)
    else:
        for i in range(2):
            _surface(axes[i].figure, axes[i], tori[-1], i)


def _title(tori, width, proved):
    """The title, in lines of at most `width` characters."""
    first = tori[0]
    text = "rotation %s: %s" % ("vector" if first.dimension > 1 else "number", first.rotation)
    ranges = [range_text(*sorted(p + s * q for s in (first.piece[0], tori[-1].piece[1])))
              for p, q in zip(first.potential.amplitude, first.part or
                              [0] * len(first.potential.amplitude))]
    text = "%s; amplitude%s %s" % (text, "s" * (len(ranges) > 1), ", ".join(ranges))
    if len(proved) == 1:
        text += "; error of the invariance equation at most %s, admissible %s" % (
            rounded_text(proved[0].residual, 3, up=True),
            rounded_text(proved[0].needed, 3, up=False))
    return "\n".join(textwrap.wrap(text, width))


def _s(tori):
    """Values of the parameter, across all pieces."""
    low, high = float(tori[0].piece[0]), float(tori[-1].piece[1])
    return np.linspace(low, high, CURVES) if high > low else np.array([low])


def _curves(ax, tori):
    """A torus of one angle is a curve in the plane of x and J."""
    theta = np.linspace(0, TURN, POINTS)[:, None]
    values = _s(tori)
    for i, s in enumerate(values):
        torus = next(t for t in tori if float(t.piece[0]) <= s <= float(t.piece[1]))
        x, J = torus.x(theta, s)[:, 0] / TURN, torus.J(theta, s)[:, 0] / TURN
        x, J = np.concatenate([x + shift for shift in (-1, 0, 1)]), np.tile(J, 3)
        shade = (i + 1) / len(values)
        ax.plot(x, J, color=BLUE, alpha=0.25 + 0.75 * shade,
                label="s = %.3g" % s if len(values) > 1 else None)
    ax.set(xlim=(0, 1), xlabel=r"$x\,/\,2\pi$", ylabel=r"$J\,/\,2\pi$", title="the torus")
    if len(values) > 1:
        ax.legend()


def _surface(figure, ax, torus, i):
    """J_i over both angles x, at the last parameter."""
    s = float(torus.piece[1])
    phi = np.linspace(0, TURN, SIDE + 1)
    theta = np.stack(np.meshgrid(phi, phi, indexing="ij"), -1)
    x = torus.x(theta, s) / TURN
    J = torus.J(theta, s)[..., i] / TURN
    # the torus may be shifted and sheared in x: copies of it fill the square
    low, high = math.floor(x.min()) - 1, math.ceil(x.max()) + 1
    for a in range(-high, 1 - low):
        for b in range(-high, 1 - low):
            moved = x + (a, b)
            if moved.max((0, 1)).min() > 0 and moved.min((0, 1)).max() < 1:
                image = ax.pcolormesh(moved[..., 0], moved[..., 1], J, shading="gouraud",
                                      cmap="viridis", vmin=J.min(), vmax=J.max(), rasterized=True)
    ax.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel=r"$x_0\,/\,2\pi$",
           ylabel=r"$x_1\,/\,2\pi$", title=r"$J_%d\,/\,2\pi$%s" % (i, _at_end(torus)))
    figure.colorbar(image, ax=ax, shrink=0.8)


def _at_end(torus):
    """The words for the parameter that a panel shows, if there is one."""
    return "" if torus.part is None else ", s = %.3g" % torus.piece[1]


def _sizes(torus):
    """(k, log10 |u_k|) of the modes with the largest coefficients, at the end of the piece."""
    size = np.sqrt((abs(torus.coefficients(float(torus.piece[1]))) ** 2).sum(1))
    order = np.argsort(-size)[:LATTICE]
    order = order[size[order] > 0]
    return torus.k[order], np.log10(size[order])


def _line(figure, ax, torus):
    """|u_k| of one angle."""
    k, size = _sizes(torus)
    k = abs(k[:, 0])
    ax.plot(k, size, ".", color=DARK, markersize=2.5, markeredgewidth=0, rasterized=True)
    rate = torus.decay(s=float(torus.piece[1]))
    if math.isfinite(rate):
        # touches the coefficients from above in the outer half, where the rate was taken
        outer = 2 * k >= k.max()
        top = (size + rate * k / math.log(10))[outer].max()
        ends = np.array([0, k.max()])
        ax.plot(ends, top - rate * ends / math.log(10), color=VERMILLION,
                label=r"$\sim e^{-%.2g k}$" % rate)
        ax.legend()
    ax.set(xlabel=r"$k$", ylabel=r"$\log_{10} |u_k|$",
           title="Fourier coefficients" + _at_end(torus))


def _lattice(figure, ax, torus):
    """|u_k| of two angles."""
    k, size = _sizes(torus)
    k, size = np.concatenate([k, -k])[::-1], np.concatenate([size, size])[::-1]
    extent = abs(k).max() if len(k) else 1
    points = ax.scatter(k[:, 0], k[:, 1], c=size, s=max(0.4, min(12, (110 / extent) ** 2)),
                        linewidths=0, cmap="magma", rasterized=True)
    ax.set(aspect="equal", xlabel=r"$k_0$", ylabel=r"$k_1$", xlim=(-1.05 * extent, 1.05 * extent),
           ylim=(-1.05 * extent, 1.05 * extent),
           title=r"$\log_{10} |u_k|$" + _at_end(torus))
    figure.colorbar(points, ax=ax, shrink=0.8)


def _errors(ax, proved):
    """The norm of the error, and what the theorem needs, over the parameter."""
    ends = [float(proved[0].torus.piece[0])]
    ends += [float(piece.torus.piece[1]) for piece in proved]
    for values, colour, name in (([float(p.needed) for p in proved], GREY, "needed"),
                                 ([float(p.residual) for p in proved], BLUE, "reached")):
        ax.stairs(np.log10(values), ends, color=colour, baseline=None, label=name)
    ax.legend()
    ax.set(xlabel="parameter s", ylabel=r"$\log_{10} \|E\|_\rho$",
           title="error of the invariance equation")
    ax.margins(y=0.2)
