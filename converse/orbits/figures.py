"""Pictures of states, and the figures of the thesis's chapter 2 and Appendix A, and the standard
map's of chapter 1.  (Not chapter 1's other two, of a star's motion and of a torus, which are drawn
after other books.)

The thesis's captions say what is shown, but seldom for which size of the perturbation: where a
figure had to choose, it says so.  Needs matplotlib (the extra "plot"), of which nothing is changed.
"""

import functools
import itertools
import math
import os
import textwrap
from collections import Counter
from fractions import Fraction

import numpy as np

from ..draw import plot
from ..draw.plot import BLUE, DARK, GREY, VERMILLION
from ..storage import files
from . import farey
from .filaments import filaments
from .potential import ff, poly, standard, trig
from .proved import ProvedOrbit, distances
from .solver import STEP, follow

SPIRAL = (1432, 1897), 2513             # near farey.SPIRAL
TENTH = (377, 2330), 3770               # near (1/10, farey.GOLDEN)
STEPS = tuple(k / 400 for k in range(17))           # eps, where the thesis does not say
FINE = tuple(k / 800 for k in range(33))
KICKS = 0.5, 0.97, 2.0                  # k; the thesis: small, the middle, more than 4/3
CANTORUS = 1.001635, (377,), 987        # k, and the rotation number: near 1/gamma^2
SEQUENCE = 60, 110, 199, 309, 720, 1330, 2550, 3770     # periods on the way to TENTH
SMOOTH = 0.005, 0.01, 0.0125, 0.02, 0.025, 0.03      # eps; the thesis: small to large
PAIRS = 800
LEVELS = 5                              # of the triangles
MANY = 5000                             # in more points curves are not looked for
ROWS = 40                               # that a page has room for
NOISE = 0.003                           # about (log q)/q, the error of exponents in 1989
LOST = 1e-13                            # distances below are rounding

# name: potential, rotation vector, eps, and whether the thesis says the first of these.
ORBITS = {
    "orb-spnf1": (trig, SPIRAL, (0.0075, 0.025), True),     # (b): "three curves", says the text
    "orb-spnf2": (trig, SPIRAL, (0.03, 0.04), False),
    "orb-aunf1": (trig, TENTH, (0.005, 0.01), False),
    "orb-aunf2": (trig, TENTH, (0.015, 0.03), False),
    "orb-sphd1": (poly, SPIRAL, (0.00125, 0.0025), False),
    "orb-sphd2": (poly, SPIRAL, (0.005, 0.0075), False),    # (b): "seven curves"
    "orb-auhd1": (poly, TENTH, (0.0025, 0.0075), False),
    "orb-auhd2": (poly, TENTH, (0.02, 0.03), False),
    "orb-spff1": (ff, SPIRAL, (0.0075, 0.015), True),
    "orb-spff2": (ff, SPIRAL, (0.03, 0.04), False),
}
TEXT = {                                # what it says of (b): an eps was chosen where that is so
    "orb-spnf1": "The text says that (b) has three curves, each once round in both directions.",
    "orb-sphd2": "The text says that (b) has seven curves of type (0, 1).",
}

NAMES = {"trig": "trigonometric", "poly": "polynomial", "ff": "fast-Froeschlé"}
COLOURS = {"trig": DARK, "poly": BLUE, "ff": VERMILLION}
STYLE = {**plot.STYLE, "axes.titlesize": 8, "axes.linewidth": 0.6}
POINTS = {"linestyle": "none", "marker": "o", "markersize": 1.3, "markeredgewidth": 0,
          "rasterized": True}
LETTERS = 17                            # of a caption, in an inch
TUNNEL = 0.01                           # of the Euclidean length: Bangert's metric in a tunnel


class Families:
    """The families that figures share, each found when it is first asked for."""

    def __init__(self):
        self.found = {}

    def __call__(self, potential, vector, eps=STEPS):
        key = potential, vector, eps
        if key not in self.found:
            self.found[key] = follow(potential, *vector, eps)
        return self.found[key]

    def at(self, potential, vector, eps):
        """The state at one of the STEPS, or at another eps."""
        steps = STEPS if eps in STEPS else (eps,)
        return self(potential, vector, steps)[steps.index(eps)]


class Drawn:
    """A proved orbit, drawn as the state is that doubles make of it."""

    undetermined = 0

    def __init__(self, proof):
        self.state = proof.nearest
        self.label = "proved within %s, at most %s from the state found" % distances(proof)

    def __getattr__(self, name):
        return getattr(self.state, name)


# ---- words

LABELS = ("Minimum: a local one, as far as doubles show; nothing is proved, and there may be "
          "states of less action.")
PROVED = ("Proved: a true orbit is so near to the points drawn, before these were rounded to "
          "doubles, and a local minimum of the action; there may be states of less.")
HOW = "Found by continuation from ε = 0 in steps of at most %g.  %s" % (STEP, LABELS)


def chosen(first_known=False):
    """That the thesis does not say eps, but perhaps the first."""
    if first_known:
        return "The first ε is the thesis's; it says no other, what follows was chosen here."
    return "The thesis does not say the ε; these were chosen here."


def vector_words(p, q):
    """As the thesis writes it: (1432, 1897)/2513."""
    return ("(%s)/%d" if len(p) > 1 else "%s/%d") % (", ".join(map(str, p)), q)


def quality(state):
    """How good a state is."""
    return "shadow %.0e, grad size %.0e" % (state.shadow, state.grad_size)


def kind(state):
    """What it is, as far as doubles show."""
    words = state.label
    if state.undetermined:
        words += ", %d near-null direction%s (phase arbitrary)" % (
            state.undetermined, "s" * (state.undetermined > 1))
    return words


def labels(states):
    """How many states there are of each kind."""
    count = Counter(state.label for state in states)
    return "Labels of the states: %s." % ", ".join("%s (%d)" % item for item in count.items())


def exponents_words(state):
    return "exponents " + ", ".join("%.4f" % x for x in state.exponents)


def shape(state):
    """What the points hang together as."""
    if state.q > MANY:
        return "curves not looked for"
    found = filaments(state.x)
    if found is None:
        return "no curves to be told apart"
    return "%d curve%s of type (%d, %d) at links up to %.2g" % (
        found.count, "s" * (found.count > 1), *found.type, found.gap)


def coinciding(state):
    """How many points have another one nearer than doubles can tell."""
    x = state.x[np.argsort(state.x[:, 0])]
    near = np.zeros(len(x), bool)
    for shift in range(1, len(x)):
        step = np.roll(x, -shift, axis=0) - x
        step = abs(step - np.rint(step))
        if not (step[:, 0] < LOST).any():               # nor with a larger shift
            break
        close = (step < LOST).all(axis=1)
        near |= close | np.roll(close, shift)
    return np.count_nonzero(near)


# ---- chapter 1 and section 2.1: the standard map, billiards, a cantorus

def std_demo(figure, families):
    axes = figure.subplots(1, 3, sharey=True, gridspec_kw={"wspace": 0.12})
    number = np.arange(20)[:, None]
    for panel, k in zip(axes, KICKS):
        x, p = (number + 0.5) / 20, number * float(farey.GOLDEN) % 1.0
        xs, ps = standard.orbit(x, p, 200, k)
        panel.plot(xs[1:].ravel() % 1, ps[1:].ravel() % 1, color=DARK, **POINTS)
        panel.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="$x$")
        panel.set_title("$k$ = %g" % k)
    axes[0].set_ylabel("$p$")
    return ("The standard map: 200 iterates of 20 points, spread evenly.  The thesis does not say "
            "the three k (the last is more than 4/3) or the points; these were chosen here.")


def cyl_def(figure, families):
    axes = figure.subplots()
    turn = np.linspace(0, 2 * np.pi, 201)
    for height in 0.0, 1.0:
        for line, part in (("-", turn >= np.pi), ("--" if height == 0 else "-", turn <= np.pi)):
            axes.plot(np.cos(turn[part]), height + 0.22 * np.sin(turn[part]), line, color=DARK)
    axes.plot([-1, -1, np.nan, 1, 1], [0, 1, np.nan, 0, 1], color=DARK)
    arc = np.linspace(1.3, 1.7, 41) * np.pi
    x, y = np.cos(arc), 0.6 + 0.22 * np.sin(arc)
    axes.plot(x, y, color=BLUE)
    arrow = {"arrowstyle": "->", "color": BLUE, "shrinkA": 0, "shrinkB": 0}
    for head, foot in (((x[-1], y[-1]), (x[-3], y[-3])), ((1.15, 0.85), (1.15, 0.15))):
        axes.annotate("", head, foot, arrowprops=arrow)
    axes.annotate("$x$", (0, 0.38), (0, 3), textcoords="offset points", ha="center")
    axes.annotate("$p$", (1.15, 0.5), (4, 0), textcoords="offset points", va="center")
    axes.set(xlim=(-1.1, 1.3), ylim=(-0.3, 1.3), aspect="equal")
    axes.set_axis_off()
    return "A drawing: the cylinder, the angle x of period 1 round it, the momentum p along it."


def twist(figure, families):
    before, after = figure.subplots(1, 2, sharey=True, gridspec_kw={"wspace": 0.15})
    p = np.linspace(0, 1, 200)
    for x, colour in zip((1 / 6, 1 / 2, 5 / 6), (DARK, BLUE, VERMILLION)):
        before.plot(np.full(len(p), x), p, color=colour)
        after.plot(*twisted(x, p), color=colour)
    before.set(xlim=(0, 1), xlabel="$x$", ylabel="$p$", title="vertical lines")
    after.set(xlabel="$x'$", ylabel="$p'$", title="their images")
    return ("A twist map carries vertical lines to monotone curves.  Here p' = p − (k/2π) sin 2πx, "
            "x' = x + p' + (sin 2πp')/4π, not reduced to the circle, k = %g, chosen here."
            % KICKS[0])


def twisted(x, p):
    """An area-preserving twist map whose twist is not the same everywhere."""
    p = p - KICKS[0] / (2 * np.pi) * np.sin(2 * np.pi * x)
    return x + p + np.sin(2 * np.pi * p) / (4 * np.pi), p


def billiards(figure, families):
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
    return np.cos(t) + np.cos(2 * t) / 12, 0.8 * np.sin(t)


def longest_star(x, y):
    """The longest closed way found with five points on a curve and two turns, the curve given by
    points: its length, and the indices.  Each corner in turn goes where the way is longest."""
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


# ---- section 2.2: the potentials

def pert_maps(figure, families):
    grid = np.linspace(0, 1, 401)
    x = np.stack(np.meshgrid(grid, grid), -1)
    levels = np.arange(-10, 11) / 10
    axes = figure.subplots(1, 3, sharey=True, gridspec_kw={"wspace": 0.12})
    for letter, panel, potential in zip("abc", axes, (trig, poly, ff)):
        value = potential.evaluate(x.reshape(-1, 2))[0].reshape(x.shape[:2])
        panel.contour(grid, grid, -value, levels, colors=DARK, linewidths=0.6,
                      negative_linestyles="dashed")
        panel.plot(*potential.start, "+", color=VERMILLION, markersize=7)
        panel.set(aspect="equal", xlabel="$x_0$")
        panel.set_title("(%s) %s\nfrom %.3g to %.3g" % (letter, NAMES[potential.name],
                                                      -value.max(), -value.min()))
    axes[0].set_ylabel("$x_1$")
    return ("Contours of -V, the interval 0.1, those of negative values dashed.  The cross: the "
            "maximum of V where states begin.")


# ---- section 2.3: shapes and exponents

def pair(left, right, state, middle, half):
    """The two projections of a state; of the momenta, a square about middle."""
    left.plot(*state.x.T, color=DARK, **POINTS)
    left.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="$x_0$", ylabel="$x_1$")
    right.plot(*state.momenta.T, color=DARK, **POINTS)
    right.plot(*state.rotation, "+", color=VERMILLION, markersize=7)
    right.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half),
              aspect="equal", xlabel="$p_0$", ylabel="$p_1$")
    for axis in right.xaxis, right.yaxis:
        axis.get_major_locator().set_params(nbins=5)


def square(state):
    """The middle and half the side of a square that the momenta lie in."""
    low, high = state.momenta.min(0), state.momenta.max(0)
    return (low + high) / 2, max(0.55 * (high - low).max(), 1e-9)


def pairs_of_projections(figure, states):
    """A row for each state, with what is known of it; returns what is to be said of all of them."""
    lost = []
    rows = figure.subplots(len(states), 2, squeeze=False, gridspec_kw={"hspace": 0.42})
    for number, ((left, right), state) in enumerate(zip(rows, states)):
        letter = "abcdefghijklmnopqrstuvwxyz"[number % 26] * (1 + number // 26)
        pair(left, right, state, *square(state))
        away = np.sqrt(((state.momenta - state.rotation) ** 2).sum(1)).max()
        left.set_title("(%s)  ε = %r, %s: %s\n%s, %s\n$|p_j - p/q|$ up to %.3f; %s" % (
            letter, state.eps, vector_words(state.p, state.q), kind(state), quality(state),
            exponents_words(state), away, shape(state)), loc="left")
        count = coinciding(state)
        if count:
            lost.append("%d points of (%s)" % (count, letter))
    words = ("Left the angles, right the momenta, the cross at p/q.  Curves of type (a, b) at "
             "links up to r: points at most r apart, when linked, form curves that wind so round "
             "the torus, as many as clusters are met on lines across, in the median.")
    if lost:
        words += "  Doubles cannot tell %s from another one (nearer than %g)." % (
            " and ".join(lost), LOST)
    return words


def orbits_pairs(figure, families, name):
    potential, vector, sizes, first_known = ORBITS[name]
    words = pairs_of_projections(figure, [families.at(potential, vector, eps) for eps in sizes])
    said = [chosen(first_known), TEXT.get(name), HOW, words]
    return "The %s perturbation, rotation vector %s.  %s" % (
        NAMES[potential.name], vector_words(*vector), "  ".join(filter(None, said)))


def phase_planes(figure, states):
    """A panel for each state of one angle."""
    for panel, state in zip(figure.subplots(len(states), squeeze=False,
                                            gridspec_kw={"hspace": 0.42}).flat, states):
        panel.plot(state.x, state.momenta, color=DARK, **POINTS)
        panel.set(xlim=(0, 1), xlabel="$x$", ylabel="$p$")
        panel.set_title("ε = %r, %s: %s\n%s, %s" % (
            state.eps, vector_words(state.p, state.q), kind(state), quality(state),
            exponents_words(state)), loc="left")


def lyaps(figure, families):
    rows = figure.subplots(2, 2, sharex=True, gridspec_kw={"hspace": 0.25, "wspace": 0.2})
    states = []
    for panel, (potential, vector) in zip(rows.flat, ((trig, TENTH), (poly, TENTH),
                                                      (trig, SPIRAL), (ff, SPIRAL))):
        family = families(potential, vector)
        for k, (marker, name) in enumerate((("o", "first"), ("s", "second"))):
            panel.plot(family.eps, family.exponents[:, k], marker + "-", markersize=2.5,
                       linewidth=0.8, color=(DARK, BLUE)[k], label=name)
        leaves = family.eps[family.exponents[:, 0] > NOISE]
        panel.set_title("%s, %s%s" % (NAMES[potential.name], vector_words(*vector), (
            "\nfirst > %g from ε = %g on" % (NOISE, leaves[0]) if len(leaves) else "")))
        states += family
    rows[0, 0].legend(loc="upper left")
    for panel in rows[:, 0]:
        panel.set_ylabel("exponents")
    for panel in rows[1]:
        panel.set_xlabel("ε")
    return ("The two Lyapunov exponents >= 0 against ε; %g is about what 1989's method gave "
            "where they are 0.  The thesis does not say the range; 0 to %g in steps of %g was "
            "chosen here.  %s  %s" % (NOISE, STEPS[-1], STEPS[1], labels(states), HOW))


# ---- section 2.4: smoothness

def smooth(figure, families):
    from matplotlib import ticker

    rows = figure.subplots(3, 2, gridspec_kw={"hspace": 0.42, "wspace": 0.22})
    lost = 0
    for letter, panel, eps in zip("abcdef", rows.flat, SMOOTH):
        state = families.at(trig, SPIRAL, eps)
        pairs = state.pairs(PAIRS)
        apart = pairs.distance > LOST
        distance, ratio = pairs.distance[apart], pairs.momentum[apart] / pairs.distance[apart]
        panel.plot(distance, ratio, "o", markersize=1.6, markeredgewidth=0, color=DARK)
        panel.set(xscale="log", yscale="log")
        if distance.max() < 3 * distance.min():
            panel.xaxis.set_major_locator(ticker.MaxNLocator(4))
            panel.xaxis.set_major_formatter("{x:g}")
        panel.xaxis.set_minor_formatter(ticker.NullFormatter())
        panel.set_title("(%s)  ε = %g: L up to %.2g\n%s, shadow %.0e" % (
            letter, eps, ratio.max(), state.label, state.shadow))
        lost += np.count_nonzero(~apart)
        across, upward = np.array(panel.get_xlim()), panel.get_ylim()
        for power in range(-16, 2):         # lines of constant |dp|, of slope -1
            panel.plot(across, 10.0 ** power / across, color="0.8", linewidth=0.5, zorder=0)
        panel.set(xlim=across, ylim=upward)
    for panel in rows[:, 0]:
        panel.set_ylabel(r"$L = |\Delta p|\,/\,|\Delta x|$")
    for panel in rows[-1]:
        panel.set_xlabel(r"$|\Delta x|$")
    return ("The trigonometric perturbation, %s: the %d pairs of points closest on the torus, less "
            "%d that are nearer than %g, which doubles cannot tell apart.  Grey: lines of constant "
            "|dp|, a decade apart, of slope -1.  %s  %s"
            % (vector_words(*SPIRAL), PAIRS, lost, LOST, chosen(), HOW))


# ---- section 2.5: Hedlund's examples

def hed1(figure, families):
    panels = figure.subplots(1, 2, sharey=True, gridspec_kw={"wspace": 0.15})
    for panel, times in zip(panels, (1, 2)):
        for copy in range(times):
            for start in np.arange(-2, 2) / 2 + copy / 4:
                panel.plot([start, start + 1 / 2], [0, 1], color=(BLUE, VERMILLION)[copy])
        panel.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="$x_0$", xticks=(0, 1),
                  yticks=(0, 1), title="type (%d, %d)" % (times, 2 * times))
    panels[0].set_ylabel("$x_1$")
    return ("A drawing: shortest closed geodesics of the flat two-dimensional torus.  One of type "
            "(2, 4) is two copies of one of type (1, 2), here drawn apart.")


def hedlund_geodesic(i, j, k):
    """A short closed way of type (i, j, k) in Hedlund's and Bangert's metric, in the space of all
    copies of the three-dimensional torus: its corners, from which in turn a tunnel and a leap to
    another tunnel lead on.  The tunnels run along (t, 0, 0), (0, t, 1/2) and (1/2, 1/2, t)."""
    return [(0, 0, 0), (i - 1, 0, 0), (i - 1, 0, 1 / 2), (i - 1, j - 1 / 2, 1 / 2),
            (i - 1 / 2, j - 1 / 2, 1 / 2), (i - 1 / 2, j - 1 / 2, k), (i - 1 / 2, j, k), (i, j, k)]


def hedlund_length(corners):
    """Its length: in tunnels a hundredth of the Euclidean one."""
    legs = [math.dist(*ends) for ends in zip(corners, corners[1:])]
    return sum(leg * (TUNNEL, 1)[number % 2] for number, leg in enumerate(legs))


def hed2(figure, families):
    panels = figure.subplots(1, 2, sharey=True, width_ratios=(1, 2), gridspec_kw={"wspace": 0.1})
    lengths = []
    for panel, times in zip(panels, (1, 2)):
        i, j, k = block = times, 2 * times, times
        for a, b in itertools.combinations(itertools.product((0, i), (0, j), (0, k)), 2):
            if sum(x != y for x, y in zip(a, b)) == 1:
                panel.plot(*oblique(a, b), color="0.85", linewidth=0.6)
        for ends in tunnels(*block):
            panel.plot(*oblique(*ends), color=GREY, linewidth=0.8, linestyle=":")
        corners = hedlund_geodesic(*block)
        for number, ends in enumerate(zip(corners, corners[1:])):
            panel.plot(*oblique(*ends), linewidth=2, color=(BLUE, VERMILLION)[number % 2],
                       label=("in a tunnel", "a leap")[number] if number < 2 else None)
        panel.plot(*oblique(corners[0], corners[-1]), "o", color=DARK, markersize=4,
                   linestyle="none", label="the same point")
        lengths.append(hedlund_length(corners))
        panel.set_title("type (%d, %d, %d): length %.4g" % (*block, lengths[-1]))
        panel.set(aspect="equal", ylim=(-0.1, 2.7))
        panel.set_axis_off()
    panels[0].legend(loc="upper left", bbox_to_anchor=(0, 1))
    for axis, end in enumerate(np.eye(3) * 0.35):
        foot, head = oblique((0, 0, 0), end).T + (2.0, 1.75)
        panels[0].annotate("", head, foot, arrowprops={
            "arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
        panels[0].annotate("$x_%d$" % axis, head, (2, 2), textcoords="offset points")
    return ("A drawing: closed ways on the three-dimensional torus, spread out, in a metric after "
            "Bangert: %g of the Euclidean one in the tunnels (dotted), here the Euclidean one "
            "elsewhere.  Either leaps three times from tunnel to tunnel: that of type (2, 4, 2), "
            "of length %.4g, is shorter than two copies of the other, %.4g."
            % (TUNNEL, lengths[1], 2 * lengths[0]))


def tunnels(i, j, k):
    """Those in the block [0, i] x [0, j] x [0, k], by their ends."""
    for b, c in itertools.product(range(j + 1), range(k + 1)):
        yield (0, b, c), (i, b, c)
    for a, c in itertools.product(range(i + 1), range(k)):
        yield (a, 0, c + 1 / 2), (a, j, c + 1 / 2)
    for a, b in itertools.product(range(i + 1), range(j)):
        if a < i:
            yield (a + 1 / 2, b + 1 / 2, 0), (a + 1 / 2, b + 1 / 2, k)


def oblique(*points):
    """Points of space as they are drawn: x_1 to the right, x_2 upwards, x_0 to the back."""
    return np.array([(b + 0.45 * a, c + 0.3 * a) for a, b, c in points]).T


def deev(figure, families):
    rows = figure.subplots(2, 1, sharex=True, sharey=True)
    states = []
    for panel, vector in zip(rows, (SPIRAL, TENTH)):
        for potential in trig, poly, ff:
            family = families(potential, vector, FINE)
            deviations = np.array([state.deviation for state in family])
            panel.plot(family.eps, deviations[:, 1], "o-", markersize=2, linewidth=0.8,
                       color=COLOURS[potential.name], label=NAMES[potential.name])
            panel.plot(family.eps, deviations[:, 0], linewidth=0.8, linestyle=":",
                       color=COLOURS[potential.name])
            states += family
        panel.axhline(1 / math.sqrt(2), color=GREY, linewidth=0.8, linestyle="--")
        panel.set(title=vector_words(*vector), ylabel="largest displacement", xlim=(0, FINE[-1]))
    rows[0].legend(loc="upper left")
    rows[1].set_xlabel("ε")
    farthest = max(states, key=lambda state: state.deviation.from_point)
    words = ("The largest displacement of a point of the state from where it would be without "
             "perturbation, %.3f at most.  Dotted: from the straight line through x₀, which "
             "depends on which point is called x₀.  Dashed: 1/√2, half the diagonal of the unit "
             "square." % max(state.deviation.from_start for state in states))
    if farthest.deviation.from_point > 1 / math.sqrt(2):
        words += ("  The thesis says that the distance from the straight line that connects x₀ to "
                  "its image x_q is always smaller.  Of these states that is not so: %s, %s, "
                  "ε = %g: %.2f." % (NAMES[farthest.potential.name],
                                     vector_words(farthest.p, farthest.q), farthest.eps,
                                     farthest.deviation.from_point))
    return ("%s  In %d of %d states a phase is arbitrary, and with it a part of the displacement.  "
            "The thesis does not say the vectors or the steps; these (%g) were chosen here.  %s  %s"
            % (words, sum(state.undetermined > 0 for state in states), len(states), FINE[1],
               labels(states), HOW))


def hed_st(figure, families):
    potential, eps = poly, 0.02
    w = Fraction(1, 10), farey.GOLDEN
    chain = [(m.p, m.q) for m in itertools.takewhile(lambda m: m.q <= SEQUENCE[-1],
                                                     farey.triangle(w)) if m.q in SEQUENCE]
    cells = figure.subplots(len(chain) // 2, 4, gridspec_kw={"hspace": 0.62, "wspace": 0.5})
    states = [families.at(potential, vector, eps) for vector in chain]
    middle, half = square(states[-1])
    for (left, right), state in zip(cells.reshape(-1, 2), states):
        pair(left, right, state, middle, 1.1 * half)
        for axis in left.xaxis, left.yaxis, right.xaxis, right.yaxis:
            axis.get_major_locator().set_params(nbins=3)
            axis.labelpad = 2
        left.set_title("%s: %s\n%s" % (vector_words(state.p, state.q), state.label,
                                       quality(state)), loc="left")
    return ("States whose rotation vectors approach %s, mediants of the Farey triangles about "
            "(1/10, golden mean): pairs of angles and momenta, %s perturbation, ε = %g.  The "
            "thesis does not say the map, ε, or the members; these were chosen here.  %s"
            % (vector_words(*TENTH), NAMES[potential.name], eps, HOW))


# ---- Appendix A: Farey's tree and triangles

def tree(figure, families):
    axes = figure.subplots()
    ends = [(0, 1), (1, 1)]
    for level in range(3):
        axes.plot([0, 1], [-level, -level], color=DARK, linewidth=0.8)
        mediants = [tuple(map(sum, zip(*pair))) for pair in zip(ends, ends[1:])]
        best = next(itertools.islice(farey.tree(farey.GOLDEN), level, None))
        for p, q in ends + mediants:
            new = (p, q) in mediants
            axes.plot([p / q] * 2, [-level - 0.07, -level + 0.07], color=DARK, linewidth=0.8)
            axes.annotate("(%d, %d)" % (p, q), (p / q, -level), (0, -13 if new else 7), ha="center",
                          textcoords="offset points", color=DARK if new else "0.45",
                          weight="bold" if ((p,), q) == best[:2] else "normal")
        axes.plot(float(farey.GOLDEN), -level, "o", color=DARK, markersize=4)
        axes.annotate("level %d" % level, (-0.06, -level), ha="right", va="center")
        ends = sorted(ends + mediants, key=lambda end: Fraction(*end))
    axes.set(xlim=(-0.2, 1.05), ylim=(-2.3, 0.3))
    axes.set_axis_off()
    return ("Farey's tree: above, the ends of a level's intervals, below, their mediants.  The dot "
            "is the golden mean; in bold its approximant, the mediant with the largest p + q of "
            "its level.")


def trimed(figure, families):
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
    ideal, true = figure.subplots(1, 2)
    corners = {point: np.array(point[:2], float) for point in farey.LOWER + farey.UPPER}
    cells = [farey.LOWER, farey.UPPER]
    for level in range(LEVELS):
        style = {"color": DARK, "linewidth": 1.2 - 0.2 * level}
        for cell in cells:
            loop = cell + cell[:1]
            ideal.plot(*np.array([corners[point] for point in loop]).T, **style)
            true.plot(*np.array([(p0 / q, p1 / q) for p0, p1, q in loop]).T, **style)
        halves = [half for cell in cells for half in farey.halves(cell)]
        for (a, _, c), (_, middle, _) in zip(cells, halves[::2]):
            corners[middle] = (corners[a] + corners[c]) / 2
        cells = halves
    place = [np.array(point[:2], float) for point in farey.UPPER]
    for _ in range(60):                     # rrr...: (A, B, C) <- (C, A + C, B)
        a, b, c = place
        place = [c, (a + c) / 2, b]
    ideal.plot(*place[0], "o", color=VERMILLION, markersize=4)
    true.plot(*map(float, farey.SPIRAL), "o", color=VERMILLION, markersize=4)
    for letter, panel, ticks in (("a", ideal, ()), ("b", true, (0, 1))):
        panel.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), title="(%s)" % letter, xticks=ticks,
                  yticks=ticks)
    true.set(xlabel="$w_0$", ylabel="$w_1$")
    return ("Levels 0 to %d of the Farey triangles: (a) with all cuts in the middle, (b) where the "
            "rational vectors lie in the unit square.  The dot is the spiral mean, rrr..."
            % (LEVELS - 1))


# ---- all of them

FIGURES = {                             # the order of the thesis: width and height in inches
    "std-demo": (7.2, 2.9, std_demo),
    "cyl-def": (3.0, 2.2, cyl_def),
    "twist": (6.0, 2.6, twist),
    "billiards": (3.6, 3.0, billiards),
    "cantorus": (6.0, 3.8, cantorus),
    "pert-maps": (7.2, 3.1, pert_maps),
    "Lyaps": (6.4, 5.2, lyaps),
    **{name: (6.2, 3.25 * len(sizes), functools.partial(orbits_pairs, name=name))
       for name, (_, _, sizes, _) in ORBITS.items()},
    "smooth": (6.4, 7.8, smooth),
    "hed1": (4.8, 2.9, hed1),
    "hed2": (6.4, 3.0, hed2),
    "deev": (6.0, 6.0, deev),
    "hed_st": (7.2, 8.0, hed_st),
    "tree": (6.0, 2.2, tree),
    "trimed": (4.2, 2.4, trimed),
    "tri": (6.4, 3.2, tri),
}


def draw(name, kind="svg", families=None, caption=True):
    """One of the FIGURES as the bytes of a file of that kind: "svg", "png" or "pdf"; with a caption
    or without."""
    check([name], kind)
    width, height, fill = FIGURES[name]
    families = Families() if families is None else families
    return _page(width, height, kind, lambda figure: fill(figure, families), caption)


def states_picture(states, kind="svg", caption=True):
    """States of a potential, or what prove() made of them, as the bytes of a file of that kind:
    their angles and momenta; with a caption or without."""
    check([], kind)
    states = [Drawn(one) if isinstance(one, ProvedOrbit) else one for one in states]
    if not 0 < len(states) <= ROWS:
        raise ValueError("a picture shows 1 to %d states, not %d; choose fewer eps"
                         % (ROWS, len(states)))

    def fill(figure):
        proved = {isinstance(state, Drawn) for state in states}
        words = "  ".join(["The potential %s." % states[0].potential.name,
                           *[LABELS] * (False in proved), *[PROVED] * (True in proved)])
        if states[0].potential.n == 2:
            return "%s  %s" % (words, pairs_of_projections(figure, states))
        phase_planes(figure, states)
        return words

    return _page(6.2, 3.25 * len(states), kind, fill, caption)


def _page(width, height, kind, fill, caption):
    """A figure as the bytes of a file: fill(figure) draws it and returns the caption."""
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE]):
        figure = Figure(figsize=(width, height))
        words = fill(figure).replace("$", r"\$")
        figure.subplots_adjust(left=0.55 / width, right=1 - 0.1 / width, bottom=0.5 / height,
                               top=1 - 0.4 / height)
        if caption:
            figure.text(0.1 / width, 0.0, "\n".join(textwrap.wrap(words, int(LETTERS * width))),
                        color="0.25", va="top", linespacing=1.35)
        return plot.encode(figure, kind, dpi=200, pad_inches=0.1)


def check(names, kind):
    """Finds out before the work starts what is wrong with an order for figures."""
    try:
        plot.check()
    except files.ConverseError:
        raise files.ConverseError("figures need matplotlib; pip install matplotlib") from None
    if kind not in plot.FORMATS:
        raise ValueError("figures are %s, not %s" % (", ".join(plot.FORMATS), kind))
    for name in names:
        if name not in FIGURES:
            raise ValueError("there is no figure %s; there are %s" % (name, ", ".join(FIGURES)))


def figures(directory, only=None, kind="svg", progress=None, caption=True):
    """Draws the figures, or only those named, into NAME.svg (or "png", "pdf") in a directory, which
    is made if need be, with captions or without; returns the paths.  progress(path) is called after
    each."""
    names = list(FIGURES) if only is None else list(only)
    check(names, kind)
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise files.ConverseError("%s: cannot be made a directory (%s); name another place"
                                  % (directory, files.reason(error))) from None
    paths = [os.path.join(directory, "%s.%s" % (name, kind)) for name in names]
    for path in paths:
        files.check_output(path, "figure", [kind])
    families = Families()
    for name, path in zip(names, paths):
        files.write(path, draw(name, kind, families, caption))
        if progress is not None:
            progress(path)
    return paths
