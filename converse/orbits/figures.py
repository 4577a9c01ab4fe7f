"""Pictures of states, and the computed figures of the thesis's chapters 1 and 2 and Appendix A.

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

from .. import files, picture
from . import farey
from .filaments import filaments
from .potential import ff, poly, standard, trig
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
    "orb-spnf1": (trig, SPIRAL, (0.0075, 0.0175, 0.025), True),
    "orb-spnf2": (trig, SPIRAL, (0.03, 0.04), False),
    "orb-aunf1": (trig, TENTH, (0.005, 0.01), False),
    "orb-aunf2": (trig, TENTH, (0.015, 0.03), False),
    "orb-sphd1": (poly, SPIRAL, (0.0025, 0.005), False),
    "orb-sphd2": (poly, SPIRAL, (0.0075, 0.02), False),
    "orb-auhd1": (poly, TENTH, (0.0025, 0.0075), False),
    "orb-auhd2": (poly, TENTH, (0.02, 0.03), False),
    "orb-spff1": (ff, SPIRAL, (0.0075, 0.015), True),
    "orb-spff2": (ff, SPIRAL, (0.03, 0.04), False),
}

NAMES = {"trig": "trigonometric", "poly": "polynomial", "ff": "fast-Froeschlé"}
DARK, BLUE, ORANGE, GREY = "0.1", "#1f5f94", "#d98a2b", "0.6"
COLOURS = {"trig": DARK, "poly": BLUE, "ff": ORANGE}
STYLE = {
    **picture.SALT, "lines.linewidth": 1, "legend.frameon": False, "legend.fontsize": 8,
    "axes.titlesize": 8, "axes.labelsize": 9, "axes.linewidth": 0.6, "xtick.labelsize": 7,
    "ytick.labelsize": 7,
}
POINTS = {"linestyle": "none", "marker": "o", "markersize": 1.3, "markeredgewidth": 0,
          "rasterized": True}
LETTERS = 20                            # of a caption, in an inch


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
        """The state at one of the STEPS."""
        return self(potential, vector)[STEPS.index(eps)]


# ---- words

LABELS = ("Minimum: a local one, as far as doubles show; nothing is proved, and there may be "
          "states of less action.")
HOW = "Found by continuation from eps = 0 in steps of at most %g.  %s" % (STEP, LABELS)


def chosen(first_known=False):
    """That the thesis does not say eps, but perhaps the first."""
    if first_known:
        return "The first eps is the thesis's; it says no other, what follows was chosen here."
    return "The thesis does not say the eps; these were chosen here."


def vector_words(p, q):
    """As the thesis writes it: (1432, 1897)/2513."""
    return ("(%s)/%d" if len(p) > 1 else "%s/%d") % (", ".join(map(str, p)), q)


def quality(state):
    """What is known of a state."""
    words = "%s, shadow %.0e, grad size %.0e" % (state.label, state.shadow, state.grad_size)
    if state.undetermined:
        words += ", %d near-null direction%s (phase arbitrary)" % (
            state.undetermined, "s" * (state.undetermined > 1))
    return words


def labels(states):
    """How many states there are of each kind."""
    count = Counter(state.label for state in states)
    return "Labels of the states: %s." % ", ".join("%s (%d)" % item for item in count.items())


def exponents_words(state):
    return "exponents " + ", ".join("unknown" if np.isnan(x) else "%.4f" % x
                                    for x in state.exponents)


def shape(state):
    """What the points hang together as."""
    if state.q > MANY:
        return "curves not looked for"
    found = filaments(state.x)
    if found is None:
        return "no curves to be told apart"
    return "curves of type (%d, %d) at links up to %.2g: %d cluster%s on $x_%d$ = const" % (
        *found.type, found.gap, found.clusters, "s" * (found.clusters > 1), found.axis)


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
    axes = figure.subplots(3, 1, sharex=True)
    number = np.arange(20)[:, None]
    for panel, k in zip(axes, KICKS):
        x, p = (number + 0.5) / 20, number * float(farey.GOLDEN) % 1.0
        orbit = []
        for _ in range(200):
            p = p - k * standard.evaluate(x)[1]
            x = (x + p) % 1.0
            orbit.append((x, p % 1.0))
        xs, ps = np.array(orbit).transpose(1, 0, 2, 3)
        panel.plot(xs.ravel(), ps.ravel(), color=DARK, **POINTS)
        panel.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", ylabel="$p$")
        panel.set_title("$k$ = %g" % k, pad=4)
    axes[-1].set_xlabel("$x$")
    return ("The standard map: 200 iterates of 20 points, spread evenly.  The thesis does not say "
            "the three k (the last is more than 4/3) or the points; these were chosen here.")


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
                      textcoords="offset points", fontsize=8)
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
            "number %s = %.6f; %s; %s.  The widest gap is %.4f, about x = %.4f.  The range of y is "
            "chosen here." % (k, vector_words(p, q), p[0] / q, quality(state),
                              exponents_words(state), gaps[widest],
                              round((at[widest] + gaps[widest] / 2) % 1.0, 4) % 1.0))


# ---- section 2.2: the potentials

def pert_maps(figure, families):
    grid = np.linspace(0, 1, 401)
    x = np.stack(np.meshgrid(grid, grid), -1)
    levels = np.arange(-10, 11) / 10
    axes = figure.subplots(3, 1, gridspec_kw={"hspace": 0.35})
    for letter, panel, potential in zip("abc", axes, (trig, poly, ff)):
        value = potential.evaluate(x.reshape(-1, 2))[0].reshape(x.shape[:2])
        panel.contour(grid, grid, -value, levels, colors=DARK, linewidths=0.6,
                      negative_linestyles="dashed")
        panel.plot(*potential.start, "+", color=ORANGE, markersize=6)
        panel.set(aspect="equal", xlabel="$x_0$", ylabel="$x_1$")
        panel.set_title("(%s) %s: from %.3g to %.3g" % (letter, NAMES[potential.name],
                                                        -value.max(), -value.min()))
    return ("Contours of -V, the interval 0.1, those of negative values dashed.  The cross: the "
            "maximum of V where states begin.")


# ---- section 2.3: shapes and exponents

def pair(left, right, state, middle, half):
    """The two projections of a state; of the momenta, a square about middle."""
    left.plot(*state.x.T, color=DARK, **POINTS)
    left.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel=r"$\theta_0$", ylabel=r"$\theta_1$")
    right.plot(*state.momenta.T, color=DARK, **POINTS)
    right.plot(*state.rotation, "+", color=ORANGE, markersize=7)
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
    for number, ((left, right), state) in enumerate(zip(rows, states), ord("a")):
        pair(left, right, state, *square(state))
        away = np.sqrt(((state.momenta - state.rotation) ** 2).sum(1)).max()
        left.set_title("(%c)  eps = %r, %s: %s\n%s; $|p_j - p/q|$ up to %.3f\n%s" % (
            number, state.eps, vector_words(state.p, state.q), quality(state),
            exponents_words(state), away, shape(state)), loc="left", fontsize=6.5)
        count = coinciding(state)
        if count:
            lost.append("%d points of (%c)" % (count, number))
    words = ("Left the angles, right the momenta, the cross at p/q.  Type (a, b) at links up to r: "
             "points at most r apart, when linked, form curves that wind so round the torus; "
             "clusters: the median over lines.")
    if lost:
        words += "  Doubles cannot tell %s from another one (nearer than %g)." % (
            " and ".join(lost), LOST)
    return words


def orbits_pairs(figure, families, name):
    potential, vector, sizes, first_known = ORBITS[name]
    words = pairs_of_projections(figure, [families.at(potential, vector, eps) for eps in sizes])
    return "The %s perturbation, rotation vector %s.  %s  %s  %s" % (
        NAMES[potential.name], vector_words(*vector), chosen(first_known), HOW, words)


def phase_planes(figure, states):
    """A panel for each state of one angle."""
    for panel, state in zip(figure.subplots(len(states), squeeze=False,
                                            gridspec_kw={"hspace": 0.42}).flat, states):
        panel.plot(state.x, state.momenta, color=DARK, **POINTS)
        panel.set(xlim=(0, 1), xlabel="$x$", ylabel="$p$")
        panel.set_title("eps = %r, %s: %s\n%s" % (
            state.eps, vector_words(state.p, state.q), quality(state), exponents_words(state)),
            loc="left", fontsize=6.5)


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
            "\nfirst > %g from eps = %g on" % (NOISE, leaves[0]) if len(leaves) else "")))
        states += family
    rows[0, 0].legend(loc="upper left")
    for panel in rows[:, 0]:
        panel.set_ylabel("exponents")
    for panel in rows[1]:
        panel.set_xlabel("eps")
    return ("The two Lyapunov exponents >= 0 against eps; %g is about what 1989's method gave "
            "where they are 0.  The thesis does not say the range; 0 to %g in steps of %g was "
            "chosen here.  %s  %s" % (NOISE, STEPS[-1], STEPS[1], labels(states), HOW))


# ---- section 2.4: smoothness

def smooth(figure, families):
    from matplotlib import ticker

    rows = figure.subplots(3, 2, gridspec_kw={"hspace": 0.3, "wspace": 0.22})
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
        panel.set_title("(%s)  eps = %g: L up to %.2g\n%s, shadow %.0e" % (
            letter, eps, ratio.max(), state.label, state.shadow), fontsize=7)
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
    rows[1].set_xlabel("eps")
    return ("The largest displacement of a point of the state from where it would be without "
            "perturbation, %.3f at most (dotted: from the straight line through x_0, which depends "
            "on which point is called x_0); dashed: 1/sqrt 2, half the diagonal of the unit "
            "square.  In %d of %d states a phase is arbitrary, and with it a part of the "
            "displacement.  The thesis does not say the vectors or the steps; these (%g) were "
            "chosen here.  %s  %s"
            % (max(state.deviation.from_start for state in states),
               sum(state.undetermined > 0 for state in states), len(states), FINE[1],
               labels(states), HOW))


def hed_st(figure, families):
    potential, eps = poly, 0.02
    w = Fraction(1, 10), farey.GOLDEN
    chain = [(m.p, m.q) for m in itertools.takewhile(lambda m: m.q <= SEQUENCE[-1],
                                                     farey.triangle(w)) if m.q in SEQUENCE]
    cells = figure.subplots(len(chain) // 2, 4, gridspec_kw={"hspace": 0.5, "wspace": 0.42})
    states = [families.at(potential, vector, eps) for vector in chain]
    middle, half = square(states[-1])
    for (left, right), state in zip(cells.reshape(-1, 2), states):
        pair(left, right, state, middle, 1.1 * half)
        for panel in left, right:
            panel.set(xlabel="", ylabel="")
        left.set_title("%s: %s\nshadow %.0e, grad size %.0e" % (
            vector_words(state.p, state.q), state.label, state.shadow, state.grad_size),
            loc="left", fontsize=6)
    return ("States whose rotation vectors approach %s, mediants of the Farey triangles about "
            "(1/10, golden mean): pairs of angles and momenta, %s perturbation, eps = %g.  The "
            "thesis does not say the map, eps, or the members; these were chosen here.  %s"
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
                          textcoords="offset points", fontsize=7, color=DARK if new else GREY,
                          weight="bold" if ((p,), q) == best[:2] else "normal")
        axes.plot(float(farey.GOLDEN), -level, "o", color=DARK, markersize=4)
        axes.annotate("level %d" % level, (-0.06, -level), ha="right", va="center", fontsize=8)
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
        axes.annotate("%s\n%s" % (letter, where), (x, -0.72), ha="center", va="center", fontsize=8)
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
    ideal.plot(*place[0], "o", color=ORANGE, markersize=4)
    true.plot(*map(float, farey.SPIRAL), "o", color=ORANGE, markersize=4)
    for letter, panel in (("a", ideal), ("b", true)):
        panel.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), title="(%s)" % letter, xticks=(0, 1),
                  yticks=(0, 1))
    return ("Levels 0 to %d of the Farey triangles: (a) with all cuts in the middle, (b) where the "
            "rational vectors lie in the unit square.  The dot is the spiral mean, rrr..."
            % (LEVELS - 1))


# ---- all of them

FIGURES = {                             # the order of the thesis: width and height in inches
    "std-demo": (3.6, 9.6, std_demo),
    "billiards": (3.6, 3.0, billiards),
    "cantorus": (6.0, 3.8, cantorus),
    "pert-maps": (3.4, 9.6, pert_maps),
    "Lyaps": (6.4, 5.2, lyaps),
    **{name: (6.2, 3.25 * len(sizes), functools.partial(orbits_pairs, name=name))
       for name, (_, _, sizes, _) in ORBITS.items()},
    "smooth": (6.4, 7.4, smooth),
    "deev": (6.0, 6.0, deev),
    "hed_st": (7.2, 8.0, hed_st),
    "tree": (6.0, 2.2, tree),
    "trimed": (4.2, 2.4, trimed),
    "tri": (6.4, 3.2, tri),
}


def draw(name, kind="svg", families=None):
    """One of the FIGURES as the bytes of a file of that kind: "svg", "png" or "pdf"."""
    check([name], kind)
    width, height, fill = FIGURES[name]
    families = Families() if families is None else families
    return _page(width, height, kind, lambda figure: fill(figure, families))


def states_picture(states, kind="svg"):
    """States of a potential as the bytes of a file of that kind: their angles and momenta."""
    check([], kind)
    states = list(states)
    if not 0 < len(states) <= ROWS:
        raise ValueError("a picture shows 1 to %d states, not %d; choose fewer eps"
                         % (ROWS, len(states)))

    def fill(figure):
        words = "The potential %s.  %s" % (states[0].potential.name, LABELS)
        if states[0].potential.n == 2:
            return "%s  %s" % (words, pairs_of_projections(figure, states))
        phase_planes(figure, states)
        return words

    return _page(6.2, 3.25 * len(states), kind, fill)


def _page(width, height, kind, fill):
    """A figure as the bytes of a file: fill(figure) draws it and returns what is said below."""
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE]):
        figure = Figure(figsize=(width, height))
        words = fill(figure).replace("$", r"\$")
        figure.subplots_adjust(left=0.55 / width, right=1 - 0.1 / width, bottom=0.5 / height,
                               top=1 - 0.4 / height)
        figure.text(0.1 / width, 0.0, "\n".join(textwrap.wrap(words, int(LETTERS * width))),
                    fontsize=7, color="0.25", va="top", linespacing=1.35)
        return picture.encode(figure, kind, dpi=200, pad_inches=0.1)


def check(names, kind):
    """Finds out before the work starts what is wrong with an order for figures."""
    try:
        picture.check()
    except files.ConverseError:
        raise files.ConverseError("figures need matplotlib; pip install matplotlib") from None
    if kind not in picture.FORMATS:
        raise ValueError("figures are %s, not %s" % (", ".join(picture.FORMATS), kind))
    for name in names:
        if name not in FIGURES:
            raise ValueError("there is no figure %s; there are %s" % (name, ", ".join(FIGURES)))


def figures(directory, only=None, kind="svg", progress=None):
    """Draws the figures, or only those named, into NAME.svg (or "png", "pdf") in a directory, which
    is made if need be; returns the paths.  progress(path) is called after each."""
    names = list(FIGURES) if only is None else list(only)
    check(names, kind)
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise files.ConverseError("%s: cannot be made a directory (%s); name another place"
                                  % (directory, files.reason(error))) from None
    paths = [os.path.join(directory, "%s.%s" % (name, kind)) for name in names]
    for path in paths:
        files.check_writable(path)
    families = Families()
    for name, path in zip(names, paths):
        files.write(path, draw(name, kind, families))
        if progress is not None:
            progress(path)
    return paths
