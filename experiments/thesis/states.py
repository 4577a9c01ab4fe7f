"""Figures of sections 2.2 to 2.4: potentials, states, their exponents and closest pairs."""

import numpy as np
from pairs import pairs as closest

from converse.draw.plot import BLUE, DARK, GREY, VERMILLION
from converse.orbits import pictures
from converse.orbits.potential import trig
from converse.orbits.state import vector_words

from . import shared
from .filaments import clumps, filaments
from .potentials import ff, poly

SMOOTH = 0.005, 0.01, 0.0125, 0.02, 0.025, 0.03      # eps; the thesis: small to large
PAIRS = 800
LOST = 1e-13                            # distances below are rounding
LINK = 0.002                            # between the points of a clump
NOISE = 0.003                           # about (log q)/q, the error of exponents in 1989
SMALLEST = 1e-5                         # exponents below are not told from 0
ONSETS = 0.012                          # eps up to which the onset of exponents is shown

# name: potential, rotation vector, eps, and whether the thesis says the first of these.
ORBITS = {
    "orb-spnf1": (trig, shared.SPIRAL, (0.0075, 0.025), True),  # (b): "three curves", says the text
    "orb-spnf2": (trig, shared.SPIRAL, (0.03, 0.04), False),
    "orb-aunf1": (trig, shared.TENTH, (0.005, 0.01), False),
    "orb-aunf2": (trig, shared.TENTH, (0.015, 0.03), False),
    "orb-sphd1": (poly, shared.SPIRAL, (0.00125, 0.0025), False),
    "orb-sphd2": (poly, shared.SPIRAL, (0.005, 0.00875), False),    # (b): "seven curves"
    "orb-auhd1": (poly, shared.TENTH, (0.0025, 0.0075), False),
    "orb-auhd2": (poly, shared.TENTH, (0.02, 0.03), False),
    "orb-spff1": (ff, shared.SPIRAL, (0.0075, 0.015), True),
    "orb-spff2": (ff, shared.SPIRAL, (0.03, 0.04), False),
}
TEXT = {                                # what it says of (b): an eps was chosen where that is so
    "orb-spnf1": "The text says that (b) has three curves, each once round in both directions.",
    "orb-sphd2": "The text says that (b) has seven curves of type (0, 1).",
}
CLUMPED = "orb-spnf2", "orb-sphd2"      # of which it says that clumps appear along the filaments
SMOOTH_SURFACE = "orb-spnf1"            # of which it says that the momenta of (a) lie on one
CURVES = ("Curves of type (a, b) at links up to r: points at most r apart, when linked, form "
          "curves that wind so round the torus, as many as clusters are met on lines across, in "
          "the median.")


def shape(state):
    """The curves that its points form, in words."""
    found = filaments(state.x)
    if found is None:
        return "no curves to be told apart"
    return "%d curve%s of type (%d, %d) at links up to %.2g" % (
        found.count, "s" * (found.count > 1), *found.type, found.gap)


def pert_maps(figure, families):
    """Contours of the three potentials."""
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
        panel.set_title("(%s) %s\nfrom %.3g to %.3g" % (letter, shared.NAMES[potential.name],
                                                      -value.max(), -value.min()))
    axes[0].set_ylabel("$x_1$")
    return ("Contours of -V, the interval 0.1, those of negative values dashed.  The cross: the "
            "maximum of V where states begin.")


def orbits_pairs(figure, families, name):
    """The states of one of the figures ORBITS: angles and momenta, a row for each eps."""
    potential, vector, sizes, first_known = ORBITS[name]
    states = [families.at(potential, vector, eps) for eps in sizes]
    words = pictures.rows(figure, states, shape)
    said = [shared.chosen(first_known), TEXT.get(name)]
    if name == SMOOTH_SURFACE:
        said.append("Of the %d closest pairs of points |Δp|/|Δx| is at most %.2g in (a), where the "
                    "thesis sees a smooth surface, and %.2g in (b)."
                    % (PAIRS, *(steepest(state) for state in states)))
    if name in CLUMPED:
        said.append("Linked where at most %g apart, the points of (a) form %d clumps, those of (b) "
                    "%d." % (LINK, *(clumps(state.x, LINK) for state in states)))
    said += [shared.HOW, words, CURVES]
    return "The %s perturbation, rotation vector %s.  %s" % (
        shared.NAMES[potential.name], vector_words(*vector), "  ".join(filter(None, said)))


def steepest(state):
    """The largest |dp|/|dx| of the closest pairs, except pairs that doubles cannot tell apart."""
    pairs = closest(state, PAIRS)
    apart = pairs.distance > LOST
    return (pairs.momentum[apart] / pairs.distance[apart]).max()


def lyaps(figure, families):
    """The exponents of four families against eps, all of them and where they leave 0."""
    rows = figure.subplots(4, 2, gridspec_kw={"hspace": 0.5, "wspace": 0.3})
    states = []
    for (left, right), (potential, vector) in zip(rows, (
            (trig, shared.TENTH), (poly, shared.TENTH), (trig, shared.SPIRAL),
            (ff, shared.SPIRAL))):
        family = families.resolved(potential, vector)
        states += family
        left.set_title("%s, %s" % (shared.NAMES[potential.name], vector_words(*vector)))
        left.set(xlim=(0, shared.TOP), ylabel="exponents")
        for k, (name, colour) in enumerate((("first", DARK), ("second", BLUE))):
            exponents = family.exponents[:, k]
            left.plot(family.eps, exponents, "o-", markersize=2, linewidth=0.8, color=colour,
                      label=name)
            seen = np.where(exponents > SMALLEST, exponents, np.nan)
            right.plot(family.eps, seen, "o-", markersize=2, linewidth=0.8, color=colour)
        right.axhline(1 / vector[1], color=GREY, linewidth=0.8, linestyle="--")
        right.set(xlim=(0, ONSETS), yscale="log", ylim=(SMALLEST, 1))
        right.set_title("above 1/q from ε = %s and %s on" % (leaves(family, 0), leaves(family, 1)))
    rows[0, 0].legend(loc="upper left")
    for panel in rows[-1]:
        panel.set_xlabel("ε")
    return ("The two Lyapunov exponents >= 0 against ε; right, how they leave 0.  Dashed: 1/q, a "
            "stretching by e along all of the orbit.  Where an exponent is above it for the first "
            "time, first and second, the title says; at the state before, at most %g less, it is "
            "not.  Exponents below %g are not told from 0.  1989's method could not tell those "
            "below %g, about (log q)/q.  The thesis does not say the range of ε; 0 to %g was "
            "chosen here.  %s  %s" % (shared.SHORTEST, SMALLEST, NOISE, shared.TOP,
                                      shared.labels(states), shared.RESOLVED))


def leaves(family, k):
    """The first eps of a family, as a text, where exponent k exceeds 1/q."""
    above = family.eps[family.exponents[:, k] > 1 / family[0].q]
    return "%.5f" % above[0] if len(above) else "beyond"


def smooth(figure, families):
    """|dp|/|dx| of the closest pairs of points against |dx|."""
    from matplotlib import ticker

    rows = figure.subplots(3, 2, gridspec_kw={"hspace": 0.42, "wspace": 0.22})
    lost = 0
    for letter, panel, eps in zip("abcdef", rows.flat, SMOOTH):
        state = families.at(trig, shared.SPIRAL, eps)
        pairs = closest(state, PAIRS)
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
            % (vector_words(*shared.SPIRAL), PAIRS, lost, LOST, shared.chosen(), shared.HOW))
