"""Pictures of states, proved orbits and families.  They need matplotlib (the extra "plot"), whose
settings stay as they are."""

import numpy as np

from ..draw import plot
from ..draw.plot import BLUE, DARK, VERMILLION
from .limits import MAX_PIVOTS
from .proved import ProvedOrbit, distances

FEW = 300                               # points that are drawn larger
MOST_STATES = 40                        # in a picture
WIDTH, HEIGHT = 6.2, 3.25               # of the picture of a state, in inches
LABELS = ("Minimum: a local one, as far as doubles show; nothing is proved, and there may be "
          "states of less action.")
PROVED = ("Proved: a true orbit is so near to the points drawn, before these were rounded to "
          "doubles, and a local minimum of the action; there may be states of less.")


# ---- words

def quality(state):
    """How small the gradient of the action is."""
    return "gradient at most %.0e, root mean square %.0e" % (state.shadow, state.grad_size)


def drawn(one):
    """The points of a state, or those nearest to a proved orbit."""
    return one.nearest if isinstance(one, ProvedOrbit) else one


def kind(one):
    """The kind of a state, as far as doubles show, or of a proved orbit."""
    if isinstance(one, ProvedOrbit):
        return "proved within %s, at most %s from the state found" % distances(one)
    state, words = one, one.label
    if state.undetermined:
        words += ", %d near-null direction%s (phase arbitrary)" % (
            state.undetermined, "s" * (state.undetermined > 1))
    return words


def exponents_words(state):
    return "exponents " + ", ".join("%.4f" % x for x in state.exponents)


def exponent_text(state, exponent, digits):
    """An exponent to that number of digits; only a bound if doubles do not tell it from 0."""
    least = 2 / max(MAX_PIVOTS, 5 * state.q)
    return "below %.0e" % least if exponent < least else "%.*g" % (digits, exponent)


# ---- one state

def figure(one, ax=None):
    """A state, or the state nearest to a proved orbit: as a Figure, or drawn into ax."""
    if ax is None:
        return plot.new(WIDTH, HEIGHT, lambda page: rows(page, [one]) and None)
    plot.check()
    axes, n = np.ravel(ax), drawn(one).potential.n
    if not 1 <= len(axes) <= n:
        raise ValueError("a state of %s is drawn into %s of matplotlib, not into %d" % (
            *(("two angles", "Axes, or into a pair of Axes") if n == 2 else
              ("one angle", "Axes")), len(axes)))
    for axis, draw in zip(axes, (angles, momenta)):
        draw(axis, drawn(one))
    return ax


def dots(state):
    """How the points of a state are drawn."""
    return {"linestyle": "none", "marker": "o", "markersize": 3 if state.q < FEW else 1.3,
            "markeredgewidth": 0, "rasterized": True, "color": DARK}


def angles(ax, state):
    """The angles of a state of two; of one, x and p."""
    whole, (x, p) = (0, state.potential.period), state.potential.letters
    if state.potential.n == 1:
        ax.plot(state.x, state.momenta, **dots(state))
        ax.set(xlim=whole, xlabel="$%s$" % x, ylabel="$%s$" % p)
    else:
        ax.plot(*state.x.T, **dots(state))
        ax.set(xlim=whole, ylim=whole, aspect="equal", xlabel="$%s_0$" % x, ylabel="$%s_1$" % x)


def momenta(ax, state, middle=None, half=0.0):
    """The momenta of a state of two angles, and a cross at the rotation vector, in a square about
    middle; by default in one that the momenta lie in."""
    if middle is None:
        middle, half = square(state)
    p = state.potential.letters[1]
    ax.plot(*state.momenta.T, **dots(state))
    ax.plot(*state.potential.period * state.rotation, "+", color=VERMILLION, markersize=7)
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half),
           aspect="equal", xlabel="$%s_0$" % p, ylabel="$%s_1$" % p)
    for axis in ax.xaxis, ax.yaxis:
        axis.get_major_locator().set_params(nbins=5)


def square(state):
    """The middle and half the side of a square that the momenta lie in."""
    low, high = state.momenta.min(0), state.momenta.max(0)
    return (low + high) / 2, max(0.55 * (high - low).max(), 1e-9)


# ---- several states

def rows(page, shown, more=None):
    """Draws a row of panels for each of some states or proved orbits, with its kind and measures in
    the title, and returns a caption for all of them.  more(state) adds words to the title of
    each."""
    potential = drawn(shown[0]).potential
    grid = page.subplots(len(shown), potential.n, squeeze=False, gridspec_kw={"hspace": 0.42})
    for number, (panels, one) in enumerate(zip(grid, shown)):
        state = drawn(one)
        letter = "abcdefghijklmnopqrstuvwxyz"[number % 26] * (1 + number // 26)
        lines = ["ε = %r, %s: %s" % (state.eps, state.type_text, kind(one)),
                 "%s; %s" % (exponents_words(state), quality(state))]
        angles(panels[0], state)
        if potential.n == 2:
            momenta(panels[1], state)
            centre = potential.period * state.rotation
            away = np.sqrt(((state.momenta - centre) ** 2).sum(1)).max()
            if len(shown) > 1:
                lines[0] = "(%s)  %s" % (letter, lines[0])
            lines.append("momenta up to %.3f from the cross" % away
                         + ("; " + more(state) if more else ""))
        panels[0].set_title("\n".join(lines), loc="left")
    if potential.n == 1:
        return ""
    return "Left the angles, right the momenta, the cross at the rotation vector%s." % (
        "" if potential.period == 1 else " times 2 pi")


def states_picture(states, kind="svg"):
    """The angles and momenta of states of a potential, or of proved orbits, as the bytes of a file
    of that kind."""
    if kind not in plot.FORMATS:
        raise ValueError("figures are %s, not %s" % (", ".join(plot.FORMATS), kind))
    if not 0 < len(states) <= MOST_STATES:
        raise ValueError("a picture shows 1 to %d states, not %d; choose fewer eps"
                         % (MOST_STATES, len(states)))

    def fill(page):
        proved = {isinstance(one, ProvedOrbit) for one in states}
        said = ["The potential %s." % drawn(states[0]).potential.name,
                *[LABELS] * (False in proved), *[PROVED] * (True in proved), rows(page, states)]
        return "  ".join(filter(None, said))

    return plot.written(WIDTH, HEIGHT * len(states), kind, fill)


# ---- families

def family_plot(family, ax=None):
    """The exponents of a family against eps: as a Figure, or drawn into ax."""
    if not len(family):
        raise ValueError("a family without states cannot be drawn")
    return plot.single((5.0, 3.4), lambda axes: _against_eps(axes, family), ax=ax)


def _against_eps(ax, family):
    eps, minima = family.eps, np.array([state.label == "minimum" for state in family])
    for part, colour in zip(family.exponents.T, (DARK, BLUE)):
        ax.plot(eps, part, "o-", markersize=3, color=colour)
        ax.plot(eps[~minima], part[~minima], "o", markersize=3, color=colour,
                markerfacecolor="white")
    ax.set(xlabel="ε", ylabel="Lyapunov exponents",
           title="%s, %s" % (family[0].potential.name, family[0].type_text))
    ax.xaxis.get_major_locator().set_params(nbins=6)
