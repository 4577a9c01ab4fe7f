"""Figures of section 2.5: Hedlund's examples, displacements, a sequence of states."""

import itertools
import math
from fractions import Fraction

import farey
import numpy as np

from converse.draw.plot import BLUE, DARK, GREY, VERMILLION
from converse.orbits.pictures import angles, momenta, quality, square
from converse.orbits.potential import trig
from converse.orbits.state import vector_words

from . import shared
from .potentials import ff, poly

SEQUENCE = 60, 110, 199, 309, 720, 1330, 2550, 3770     # periods on the way to shared.TENTH
TUNNEL = 0.01                           # of the Euclidean length: Bangert's metric in a tunnel
SLANT = TUNNEL / math.sqrt(1 - 2 * TUNNEL ** 2)         # of a leap: see hedlund_geodesic


def hed1(figure, families):
    """Shortest closed geodesics of the flat torus of two dimensions."""
    panels = figure.subplots(1, 2, sharey=True, width_ratios=(1, 2), gridspec_kw={"wspace": 0.15})
    for panel, times in zip(panels, (1, 2)):
        i, j = times, 2 * times
        for k in range(j + 1):
            panel.plot((0, i), (k, k), color="0.85", linewidth=0.6)
            panel.plot((min(k, i),) * 2, (0, j), color="0.85", linewidth=0.6)
        for copy in range(times):
            panel.plot((copy, copy + 1), (2 * copy, 2 * copy + 2), linewidth=2,
                       color=(BLUE, VERMILLION)[copy])
        panel.plot(np.arange(times + 1), 2 * np.arange(times + 1), "o", color=DARK, markersize=4)
        panel.set_title("type (%d, %d): length %.4g" % (i, j, math.hypot(i, j)))
        panel.set(aspect="equal", xlim=(-0.1, i + 0.1), ylim=(-0.1, 4.1), xlabel="$x_0$",
                  xticks=range(i + 1), yticks=range(5))
    panels[0].set_ylabel("$x_1$")
    return ("Shortest closed geodesics of the flat two-dimensional torus, in the plane.  All dots "
            "are the same point.  The shortest one of type (2, 4) is two copies of that of type "
            "(1, 2).  Hedlund proved it for any metric on the two-dimensional torus.")


def hedlund_geodesic(i, j, k):
    """The shortest closed curve of type (1, 2, 1), or (2, 4, 2), in Bangert's metric on the torus
    of three dimensions, in space: its corners, from which in turn a tunnel and a leap to another
    tunnel lead on.

    Length counts as TUNNEL = c times the Euclidean one along the lines (t, 0, 0), (0, t, 1/2) and
    (1/2, 1/2, t) and their translates by whole numbers.  These are the tunnels, of width 0 here.
    Why no curve of type m is shorter:

    A curve that meets at most one family of tunnels moves by two components of m outside of them:
    by sqrt 2 at least, or sqrt 8.
    Let it meet the families of directions a and b only, and d be the third direction.  Its pieces v
    outside of tunnels and what it moves within add up to m, so its length is at least
    c (m_a + m_b) + the sum of all |v| - c (|v_a| + |v_b|), which is |v_d| r or more with
    r = sqrt(1 - 2 c^2).  The |v_d| add up to m_d at least, and to 1 since two pieces lead from one
    family to the other, 1/2 apart: for (1, 2, 1) to 1, length 3 c + r; for (2, 4, 2) to 2 or more.
    Let it meet all three.  At least three pieces lead from one family to another, and the length is
    at least c (m_0 + m_1 + m_2) + 3/2 (r - c).
    So the shortest curves have length 3 c + r and 8 c + 3/2 (r - c), which those drawn attain: in
    a leap |v_a| = |v_b| = SLANT |v_d|."""
    if (i, j, k) == (1, 2, 1):
        s = SLANT / 2
        return [(s, 0, 0), (1 - s, 0, 0), (1, s, 1 / 2), (1, 2 - s, 1 / 2), (1 + s, 2, 1)]
    if (i, j, k) == (2, 4, 2):
        s = SLANT / 2
        return [(s, 0, 0), (1 - s, 0, 0), (1, s, 1 / 2), (1, 7 / 2 - s, 1 / 2),
                (3 / 2, 7 / 2, 1 / 2 + s), (3 / 2, 7 / 2, 2 - s), (3 / 2 + s, 4, 2), (2 + s, 4, 2)]
    raise ValueError("the shortest curve is known of types (1, 2, 1) and (2, 4, 2)")


def hedlund_length(corners):
    """Its length: in tunnels a hundredth of the Euclidean one."""
    legs = [math.dist(*ends) for ends in zip(corners, corners[1:])]
    return sum(leg * (TUNNEL, 1)[number % 2] for number, leg in enumerate(legs))


def hed2(figure, families):
    """Shortest closed geodesics of the torus of three dimensions, in a metric after Bangert."""
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
        panel.set_title("type (%d, %d, %d): length %.4f" % (*block, lengths[-1]))
        panel.set(aspect="equal", ylim=(-0.1, 2.7))
        panel.set_axis_off()
    panels[0].legend(loc="upper left", bbox_to_anchor=(0, 1))
    for axis, end in enumerate(np.eye(3) * 0.35):
        foot, head = oblique((0, 0, 0), end).T + (2.0, 1.75)
        panels[0].annotate("", head, foot, arrowprops={
            "arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
        panels[0].annotate("$x_%d$" % axis, head, (2, 2), textcoords="offset points")
    return ("Shortest closed geodesics of the three-dimensional torus, in space, in a metric after "
            "Bangert: %g of the Euclidean one in the tunnels (dotted), here of no width, the "
            "Euclidean one elsewhere.  That of type (1, 2, 1) leaps twice from tunnel to tunnel, "
            "that of type (2, 4, 2) three times: of length %.4f, it is shorter than two copies of "
            "the other, %.4f." % (TUNNEL, lengths[1], 2 * lengths[0]))


def tunnels(i, j, k):
    """The tunnels in the block [0, i] x [0, j] x [0, k], each as its two ends."""
    for b, c in itertools.product(range(j + 1), range(k + 1)):
        yield (0, b, c), (i, b, c)
    for a, c in itertools.product(range(i + 1), range(k)):
        yield (a, 0, c + 1 / 2), (a, j, c + 1 / 2)
    for a, b in itertools.product(range(i + 1), range(j)):
        if a < i:
            yield (a + 1 / 2, b + 1 / 2, 0), (a + 1 / 2, b + 1 / 2, k)


def oblique(*points):
    """Points (x_0, x_1, x_2) in oblique projection, x_0 to the back: arrays of x and of y."""
    return np.array([(b + 0.45 * a, c + 0.3 * a) for a, b, c in points]).T


def deev(figure, families):
    """The largest displacement of six families against eps."""
    rows = figure.subplots(2, 1, sharex=True, sharey=True)
    states, leaps = [], []
    for panel, vector in zip(rows, (shared.SPIRAL, shared.TENTH)):
        for potential in trig, poly, ff:
            family = families.resolved(potential, vector)
            deviations = np.array([state.deviation for state in family])
            panel.plot(family.eps, deviations[:, 1], "o-", markersize=2, linewidth=0.8,
                       color=shared.COLOURS[potential.name], label=shared.NAMES[potential.name])
            panel.plot(family.eps, deviations[:, 0], linewidth=0.8, linestyle=":",
                       color=shared.COLOURS[potential.name])
            states += family
            if potential is ff:
                leaps += ["%s by %s" % (vector_words(*vector), " and ".join(
                    "%.3f at ε = %.5f" % (by, eps) for eps, by in jumps(family)) or "nothing")]
        panel.axhline(1 / math.sqrt(2), color=GREY, linewidth=0.8, linestyle="--")
        panel.set(title=vector_words(*vector), ylabel="largest displacement",
                  xlim=(0, shared.TOP))
    rows[0].legend(loc="upper left")
    rows[1].set_xlabel("ε")
    away = max(across(state) for state in states)
    return ("The largest displacement of a point of the state from where it would be without "
            "perturbation, %.3f at most.  Dotted: from the straight orbit through x₀, %.3f at "
            "most, which depends on which point is called x₀.  Dashed: 1/√2, half the diagonal of "
            "the unit square; the thesis says that the distance from the straight line from x₀ to "
            "x_q always remains smaller.  At right angles to that line it is %.3f at most%s.  "
            "Jumps by more than %g, between states at most %g apart, of the fast-Froeschlé "
            "perturbation: %s.  In %d of %d states a phase is arbitrary, and with it a part of the "
            "displacement.  The thesis does not say the vectors or the steps.  %s  %s"
            % (max(state.deviation.from_start for state in states),
               max(state.deviation.from_point for state in states), away,
               "" if away < 1 / math.sqrt(2) else ": that is not so", shared.CHANGE,
               shared.SHORTEST, "; ".join(leaps),
               sum(state.undetermined > 0 for state in states), len(states), shared.labels(states),
               shared.RESOLVED))


def jumps(family):
    """(eps, by how much) of the jumps of the displacement that the shortest steps leave."""
    sizes = [state.deviation.from_start for state in family]
    return [(state.eps, size - before)
            for last, state, before, size in zip(family, list(family)[1:], sizes, sizes[1:])
            if abs(size - before) > shared.CHANGE and state.eps - last.eps < 2 * shared.SHORTEST]


def across(state):
    """The largest distance of a point from the straight line through x_0 along p, in the plane."""
    along = state.rotation / np.linalg.norm(state.rotation)
    return float(abs((state.u - state.u[0]) @ (along[1], -along[0])).max())


def hed_st(figure, families):
    """States of a Farey sequence of rotation vectors, at one eps."""
    potential, eps = poly, 0.02
    w = Fraction(1, 10), shared.GOLDEN
    chain = [(m.p, m.q) for m in itertools.takewhile(lambda m: m.q <= SEQUENCE[-1],
                                                     farey.triangle(w)) if m.q in SEQUENCE]
    cells = figure.subplots(len(chain) // 2, 4, gridspec_kw={"hspace": 0.62, "wspace": 0.5})
    states = [families.at(potential, vector, eps) for vector in chain]
    middle, half = square(states[-1])
    for (left, right), state in zip(cells.reshape(-1, 2), states):
        angles(left, state)
        momenta(right, state, middle, 1.1 * half)
        for axis in left.xaxis, left.yaxis, right.xaxis, right.yaxis:
            axis.get_major_locator().set_params(nbins=3)
            axis.labelpad = 2
        left.set_title("%s: %s\n%s" % (vector_words(state.p, state.q), state.label,
                                       quality(state)), loc="left")
    return ("States whose rotation vectors approach %s, mediants of the Farey triangles about "
            "(1/10, golden mean): pairs of angles and momenta, %s perturbation, ε = %g.  The "
            "thesis does not say the map, ε, or the members; these were chosen here.  %s"
            % (vector_words(*shared.TENTH), shared.NAMES[potential.name], eps, shared.HOW))
