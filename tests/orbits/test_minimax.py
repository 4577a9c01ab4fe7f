"""Minimax orbits, the flux through gaps, and gaps, against mpmath and what is known of them."""

import contextlib
import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from sums import fourier

from converse import ConverseError, orbits
from converse.orbits import minimax
from converse.orbits.minimax import difference
from converse.orbits.state import descended

GREENE = 0.971635406        # where the golden circle breaks up
FIBONACCI = [1, 1]
while len(FIBONACCI) < 25:
    FIBONACCI.append(sum(FIBONACCI[-2:]))


def least(potential, p, q, eps):
    return orbits.follow(potential, p, q, [eps])[0]


def best(potential, p, q, eps):
    """The state of least action of several that begin elsewhere."""
    states = []
    for k in range(16):
        with contextlib.suppress(ConverseError):
            states.append(orbits.straight(potential, p, q, (k / 16,)).relax(eps))
    return min(states, key=lambda state: state.action)


def golden(k, eps):
    """The minimum of type F(k-2)/F(k), whose rotation numbers tend to 2 less the golden mean."""
    return least(orbits.standard, (FIBONACCI[k - 2],), FIBONACCI[k], eps)


def solved(beta, b):
    """The solution of the cyclic chain with beta on and -1 beside the diagonal, by elimination of
    its points in turn and the Sherman-Morrison formula."""
    q = len(beta)
    if q < 3:
        H = mpmath.diag(beta)
        for j in range(q):
            H[j, (j + 1) % q] -= 1
            H[(j + 1) % q, j] -= 1
        return mpmath.lu_solve(H, b)
    diagonal = [beta[0] + 3, *beta[1:-1], beta[-1] + mpmath.mpf(1) / 3]
    w = mpmath.matrix(q, 1)
    w[0], w[q - 1] = 3, 1                       # H = chain - w (1, 0, ..., 0, 1/3)

    def chain(side):
        side, pivot = side.copy(), list(diagonal)
        for j in range(1, q):
            side[j] += side[j - 1] / pivot[j - 1]
            pivot[j] -= 1 / pivot[j - 1]
        side[q - 1] /= pivot[-1]
        for j in range(q - 2, -1, -1):
            side[j] = (side[j] + side[j + 1]) / pivot[j]
        return side
    y, z = chain(b), chain(w)
    return y + z * ((y[0] + y[q - 1] / 3) / (1 - z[0] - z[q - 1] / 3))


def truth(state, eps):
    """The action of all points of the orbit of the standard map near a state, by mpmath alone: a
    solution of the cyclic equations, and its residue from the derivative of the map."""
    q, p, turn = state.q, state.p[0], 2 * mpmath.pi
    x = mpmath.matrix([state.origin[0] + mpmath.mpf(j * p) / q + state.u[j, 0] for j in range(q)])

    def after(j):
        return x[(j + 1) % q] + (p if j == q - 1 else 0)

    def before(j):
        return x[j - 1 if j else q - 1] - (0 if j else p)

    for _ in range(9):
        force = mpmath.matrix([2 * x[j] - before(j) - after(j)
                               - eps / turn * mpmath.sin(turn * x[j]) for j in range(q)])
        x -= solved([2 - eps * mpmath.cos(turn * x[j]) for j in range(q)], force)
        if mpmath.norm(force) < mpmath.mpf(10) ** -45:
            break
    assert mpmath.norm(force) < mpmath.mpf(10) ** -45
    a, b, c, d = map(mpmath.mpf, (1, 0, 0, 1))
    for j in range(q):
        bend = eps * mpmath.cos(turn * x[j])
        c, d = c - bend * a, d - bend * b
        a, b = a + c, b + d
    action = mpmath.fsum((after(j) - x[j]) ** 2 / 2 + eps / turn ** 2 * mpmath.cos(turn * x[j])
                         for j in range(q))
    return action, (2 - a - d) / 4


@pytest.mark.parametrize("k, eps", [(1, "0.3"), (3, "2"), (4, "0.971635406"), (7, "0.971635406"),
                                    (9, "1.5"), (10, "0.971635406"), (10, "8"), (11, "3")])
def test_the_flux_against_fifty_digits(k, eps):
    """Minimum and minimax, their residues and the difference of their actions."""
    pair = golden(k, float(eps)).minimax()
    with mpmath.workdps(50):
        (low, below), (high, above) = (truth(state, mpmath.mpf(eps))
                                       for state in (pair.minimum, pair.minimax))
        assert below < 0 < above and low < high
        assert pair.flux == pytest.approx(float(high - low), rel=1e-9, abs=2e-16)
        assert pair.minimum.residue == pytest.approx(float(below), rel=1e-6)
        assert pair.minimax.residue == pytest.approx(float(above), rel=1e-6)


def test_short_pairs_in_closed_form():
    """Fixed points at 1/2 and 0: eps/(2 pi^2), residues -+eps/4.  Of type 1/2 the minimax orbit is
    at 0 and 1/2, its residue eps^2/4; at eps 2 a pivot of its Hessian is exactly zero."""
    for eps in (0.1, 2.0, 30.0):
        pair = least(orbits.standard, (0,), 1, eps).minimax()
        assert pair.flux == pytest.approx(eps / (2 * math.pi ** 2), rel=1e-14)
        assert pair.minimax.residue == pytest.approx(eps / 4, rel=1e-14)
        assert pair.minimax.x[0, 0] % 1 == pytest.approx(0, abs=1e-12)
    for eps in (0.5, 2.0, 3.0):
        pair = least(orbits.standard, (1,), 2, eps).minimax()
        assert pair.minimax.residue == pytest.approx(eps ** 2 / 4, rel=1e-12)
        assert pair.minimax.below(0) == 1


def test_the_flux_at_break_up_scales_as_mackay_says():
    """At k_c the flux falls as q^-3.0500: by 4.339 from one approximant to the next; the residues
    tend to -0.2554 and 0.2501 (MacKay 1983)."""
    pairs = [golden(k, GREENE).minimax() for k in range(10, 17)]
    for first, second in zip(pairs[2:], pairs[3:]):
        assert first.flux / second.flux == pytest.approx(4.339, abs=0.005)
    assert pairs[-1].minimum.residue == pytest.approx(-0.2554, abs=2e-4)
    assert pairs[-1].minimax.residue == pytest.approx(0.2501, abs=2e-4)


@pytest.mark.slow
def test_above_break_up_the_flux_tends_to_that_of_the_cantorus():
    """It is soon the same from one approximant to the next, and grows from there as (k - k_c)^eta,
    eta = log 4.33914/log 1.62795 = 3.0117 (MacKay): the slope from three k, extrapolated."""
    fluxes = []
    for more in (0.02, 0.01, 0.005):
        several = [golden(k, GREENE + more).minimax().flux for k in (8, 16, 18)]
        assert several[1] == pytest.approx(several[2], rel=1e-3)
        assert several[0] != pytest.approx(several[2], rel=1e-1)
        fluxes.append(several[-1])
    first, second = (math.log(a / b, 2) for a, b in zip(fluxes, fluxes[1:]))
    assert 2 * second - first == pytest.approx(3.0117, abs=0.003)


def ends(pair):
    """Where descents from the pass to either side end."""
    saddle = pair.minimax
    v = np.random.default_rng(0).normal(size=saddle.u.shape)
    for _ in range(4):                          # of inverse iteration
        v = saddle.solved(v, -1.001 * saddle.least)
        v /= np.abs(v).max()
    away = 0.05 * np.abs(minimax.gap_of(pair.minimum)).max() * v
    return [saddle.moved(saddle.u + side * away).relax() for side in (-1, 1)]


@pytest.mark.parametrize("eps", [1.2, 2.0, 5.0, 30.0, 100.0])
@pytest.mark.parametrize("p, q", [(8, 21), (987, 2584), (1, 3000)])
@pytest.mark.slow
def test_strong_coupling_and_long_orbits(p, q, eps):
    """The minimax orbit lies between the minimum and its neighbour, and has one way down on either
    side, to one of these and to the other."""
    state = least(orbits.standard, (p,), q, eps)
    pair = state.minimax()
    assert pair.minimax.label == "saddle" and pair.minimax.below(0) == 1
    assert pair.minimax.residue > 0 > pair.minimum.residue
    r = pow(p, -1, q)
    gap = np.roll(state.u, -r, 0) - state.u + 1 / q
    inside = pair.minimax.u - state.u
    assert (-1e-9 < inside).all() and (inside < gap + 1e-9).all()
    both = ends(pair)
    for end in both:
        assert difference(state, end) == pytest.approx(0, abs=1e-12)
    moved = sorted(float((end.u - state.u).mean()) * q for end in both)
    assert moved == pytest.approx([0, 1], abs=1e-6)


def test_weak_coupling_is_flat():
    """Where doubles cannot tell the two apart the flux is rounding, and no saddle is claimed."""
    pair = golden(12, 0.5).minimax()
    assert abs(pair.flux) < 1e-14 and pair.minimax.label != "saddle"


@pytest.mark.slow
def test_potentials_without_symmetry():
    """The highest of all least actions with one coordinate held, on a grid, is not above the pass,
    and near it."""
    rng, compared = np.random.default_rng(3), 0
    for k in range(8):
        potential = fourier({(i,): tuple(rng.normal(size=2) / 40 / i ** 2.5)
                                    for i in range(1, 5)}, "own %d" % k)
        state = best(potential, ((2,), (5,))[k % 2], (5, 8)[k % 2],
                     float(rng.choice([0.8, 2, 6])))
        pair, r = state.minimax(), pow(state.p[0], -1, state.q)
        gap = np.roll(state.u, -r, 0) - state.u + 1 / state.q
        held, heights = int(np.argmax(gap)), []
        for t in np.arange(1, 32) / 32:
            heights.append(math.inf)
            for s in np.arange(0, 7) / 6:               # the others begin anywhere between
                u = state.u + s * gap
                u[held] = state.u[held] + t * gap[held]
                u = descended(state.moved(u), state.eps, 1e-12, 1000, (held, 0))[2]
                heights[-1] = min(heights[-1], difference(state, state.moved(u)))
        assert max(heights) <= pair.flux + 1e-12
        compared += max(heights) > 0.97 * pair.flux
    assert compared >= 6


def test_what_has_no_pass():
    state = least(orbits.standard, (1,), 3, 0.5)
    for bad, error, words in (
            (state.repeat(2), ValueError, "lowest terms"),
            (orbits.straight(orbits.standard, (1,), 3), ConverseError, "eps 0"),
            (state.minimax().minimax, ConverseError, "is a saddle"),
            (replace(state, eps=0.6), ConverseError, "not stationary")):
        with pytest.raises(error, match=words) as raised:
            bad.minimax()
        assert "\n" not in str(raised.value)
    with pytest.raises(ValueError, match="of one angle"):
        least(orbits.trig, (1, 1), 2, 0.02).minimax()


def test_a_state_that_is_not_the_least():
    """Of a potential with two maxima the orbit at the lower one is a minimum; beyond a pass there
    is less action."""
    potential = fourier({(1,): (0.01, 0), (2,): (0.05, 0)}, "two")
    upper = orbits.PeriodicOrbit(potential, (0,), 1, 1.0, [[0.0]], (0.5,)).relax()
    assert upper.label == "minimum"
    with pytest.raises(ConverseError, match="not the least"):
        upper.minimax()
    state = least(orbits.standard, (1,), 3, 100.0)
    jumbled = state.moved(state.u + [[0.0], [2.0], [0.0]]).relax()
    assert jumbled.label == "minimum"
    with pytest.raises(ConverseError, match="not ordered"):
        jumbled.minimax()


def test_no_pass_where_a_higher_one_may_have_been_missed(monkeypatch):
    """Two hills on the way: the lower one is not the pass when the other is not found."""
    potential = fourier({(1,): (1, 0), (2,): (0.4, 0.05)}, "two hills")
    state = best(potential, (0,), 1, 0.02)
    between, found = minimax._Way.between, []

    def counted(way, low, high):
        found.append(between(way, low, high))
        return found[-1]
    monkeypatch.setattr(minimax._Way, "between", counted)
    flux = state.minimax().flux
    assert len(found) == 2 and min(found, key=lambda top: top[1])[1] < flux

    heights = [height for _, height in found]
    for hidden, kept in ((max(heights), False), (min(heights), True)):
        monkeypatch.setattr(minimax._Way, "between", lambda way, low, high: [
            (None if height == hidden else top, height)
            for top, height in [between(way, low, high)]][0])
        if kept:
            assert state.minimax().flux == flux
        else:
            with pytest.raises(ConverseError, match="no pass found"):
                state.minimax()
