"""The figure of a phase portrait: SVG, PNG or PDF, by matplotlib."""

import math

try:
    import numpy as np
except ImportError:                     # matplotlib brings it, and plot.check() says so
    np = None  # type: ignore[assignment]

from ..model.exact import rounded_text, short_text
from ..model.map import SymplecticMap
from ..prover import tree
from . import plot

ROWS, FINER = 720, 16                   # of the image; its cells are summed up over finer ones
SIZE = 6.2, 5.6                         # inches
ORBITS, STEPS = 80, 800                # of the map, that are drawn
CURVE = 4000                            # points of a circle that is proved
TURN = 2 * math.pi
COLOUR = 0.50, 0.66, 0.83               # where no circle passes: the less is undecided, the fuller
APART = 9                               # lines are narrower than columns by this factor
SHADES = 8                              # of COLOUR, so that a file is small
DPI = 130                               # of the orbits and circles in a file of vectors


def draw(portrait, path=None, tori=(), ax=None):
    """Draws a Portrait, with orbits of its map and, in colour, the circles of tori that are proved
    (ProvedTorus), as plot.single() does.  ConverseError: it cannot be drawn."""
    return plot.single(SIZE, lambda axes: fill(axes, portrait, tori), path, ax, DPI)


def fill(axes, portrait, tori=()):
    """Draws it into axes: y across and J upwards, both modulo 2 pi."""
    image, left = shares(portrait)
    colours = np.empty((*image.shape, 4))
    colours[..., :3], colours[..., 3] = COLOUR, 1 - np.ceil(SHADES * image) / SHADES
    if not portrait.strip:              # nothing is proved between two lines
        colours = np.repeat(colours, APART, axis=1)
        colours[:, np.arange(colours.shape[1]) % APART != APART // 2, 3] = 0
    for turn in range(math.floor(-left / TURN), math.ceil(1 - left / TURN)):
        begin = left + turn * TURN
        axes.imshow(colours, origin="lower", extent=(begin, begin + TURN, 0, TURN), aspect="auto",
                    interpolation="none", zorder=0)
    axes.plot(*orbits(portrait.problem), ",", color=plot.DARK, rasterized=True, zorder=1)
    for torus, colour in zip(tori, (plot.VERMILLION, plot.GREEN, plot.PURPLE, plot.ORANGE) * 9):
        axes.plot(*circle(torus.torus), ".", color=colour, markersize=1, rasterized=True, zorder=2)
        axes.plot([], [], color=colour, label=str(torus.rotation))
    for axis in axes.xaxis, axes.yaxis:
        axis.set_ticks([m * math.pi / 2 for m in range(5)],
                       ["0", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$"])
    axes.set(xlim=(0, TURN), ylim=(0, TURN), xlabel=r"$y$  mod $2\pi$", ylabel=r"$J$  mod $2\pi$",
             title=title(portrait))
    if tori:
        axes.legend(loc="upper right", title="proved circles, rotation number")


def title(portrait):
    """The theorem, in two lines."""
    waves = [r" \pm ".join(map(short_text, (term.p, *term.parts)))
             for term in portrait.problem.terms]
    return "amplitude $%s$; coloured: proved, no rotational circle\n%s undecided: %s%% of %s" % (
        ", ".join(waves), "strips," if portrait.strip else "lines,",
        rounded_text(100 * portrait.undecided, 3, up=True),
        "phase space" if portrait.strip else "their successors")


def force(problem, y):
    """V'(y) in the middle of the patch."""
    return -sum(float(term.p) * term.k[0] * np.cos(term.k[0] * y + math.pi * float(term.phase))
                for term in problem.terms)


def orbits(problem):
    """Orbits of the map in the middle of the parameters, from points that are spread evenly."""
    at = (np.arange(ORBITS)[:, None] + 0.5) * [0.7548776662466927, 0.5698402909980532] % 1
    middle = SymplecticMap(problem.waves, problem.amplitude)
    return [each[1:].ravel() % TURN for each in middle.orbit(*TURN * at.T, STEPS)]


def circle(torus):
    """Points (y, J), modulo 2 pi, of an invariant circle and of its image by the reversal of time,
    (y, -J')."""
    theta = np.linspace(0, TURN, CURVE, endpoint=False)[:, None]
    y, J, after = torus.x(theta)[:, 0], torus.J(theta)[:, 0], torus.J(
        theta + TURN * torus.rotation.floats[0])[:, 0]
    return np.concatenate([y, y]) % TURN, np.concatenate([J, -after]) % TURN


def shares(portrait):
    """The share that is undecided of each column, from the left, and of each of ROWS intervals of
    J from 0 to 2 pi: an array; and where the columns begin, which are 2 pi wide together."""
    stars = portrait.stars
    half = math.pi / len(stars) * portrait.turns / 2
    image = np.ones((ROWS, len(stars) * 2 // portrait.turns))
    left = float(stars[0]) - half
    shift = 0 if portrait.even is None else len(stars)
    for at, x in enumerate(stars):
        if x in portrait.found:
            image[:, shift + at] = column(portrait, x)
            if shift:                   # the mirror image
                image[:, shift - 1 - at] = image[::-1, shift + at]
    left -= math.pi if shift else 0
    return image, left


def column(portrait, xstar):
    """The shares that are undecided in one column: of prisms of points (y, y' - y), where J = y' -
    y + V'(y), and of their images by the reversal of time, (y, -J')."""
    step = TURN / ROWS / FINER
    ends, weights = [], []
    k, _, _ = portrait.problem.waves[0]
    for region in portrait.found[xstar]:
        (low, high), shifts = region.problem.v0, region.problem.shifts
        shift = float(shifts[1][0]) if shifts else 0.0
        for kind, (index, cuts) in tree.cells(region.text):
            if kind != "U":
                continue
            u, t = ((2 * index[axis] + 1) / 2 ** cuts[axis] - 1 for axis in (0, 3))
            half = float(high - low) / 2
            centre = float(low + high) / 2 + shift * t + half * u
            w, y = math.pi * centre - float(xstar), float(xstar)
            if portrait.strip:
                y += math.asin(t * k * float(portrait.strip)) / k
            half *= math.pi / 2 ** cuts[0]
            for middle in w + force(portrait.problem, y), -w:
                ends.append((middle - half, middle + half))
                weights.append(0.5 ** cuts[3])
    fine = np.zeros(ROWS * FINER + 1)
    if ends:
        low, high = np.rint(np.array(ends).T / step).astype(int)
        first, last = low.min() // (ROWS * FINER), high.max() // (ROWS * FINER)
        for turn in range(-last, 1 - first):
            for at, sign in (low, 1), (high, -1):
                np.add.at(fine, np.clip(at + turn * ROWS * FINER, 0, ROWS * FINER),
                          sign * np.array(weights))
    return np.minimum(np.cumsum(fine)[:-1].reshape(ROWS, FINER).mean(axis=1), 1)
