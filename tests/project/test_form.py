"""docs/how-to/form.md: the maps of its tables are the program's map in other variables."""

import math
import random
import re
from fractions import Fraction

import numpy as np
import pytest
from pages import PAGES

from converse import FourierMap, SymplecticMap

H, A, DRIFT, PERIOD = 0.7, -1.3, 0.45, 3.0      # h, a, w and L of the page
AMPLITUDES = Fraction(3, 10), Fraction(1, 5)


def waves(*ks):
    return [(*k, phase) for k, phase in zip(ks, ("1/5", "-1/2"))]


ONE, TWO = waves((1, 0), (2, 0)), waves((1, 2), (1, -1))


def potential(ks, factor=1.0):
    """The program's map of these waves, the amplitudes times a factor."""
    return SymplecticMap(ks, [p * Fraction(factor) for p in AMPLITUDES])


def slope(ks, x):
    """W' there, W of these waves: by hand."""
    x, total = np.atleast_1d(x), np.zeros(np.atleast_1d(x).size)
    for (k0, k1, phase), p in zip(ks, AMPLITUDES):
        k = np.array((k0, k1)[:x.size], float)
        total -= float(p) * k * math.cos(k @ x + math.pi * Fraction(phase))
    return total


def one(x):
    return slope(ONE, x)[0]


def leapfrog(x, p):
    q = p - H * one(x) / 2
    x = x + H * q
    return x, q - H * one(x) / 2


def position(x, p):
    x = x + H * p / 2
    p = p - H * one(x)
    return x + H * p / 2, p


def kicked(change, drift):
    def step(x, p):
        p = p - change * one(change * x)
        return drift(x, p), p
    return step


# How a row of the page begins; its map; y, J of x, p; and by what V is larger than W(y).
ROWS = {
    "kick, then drift": (kicked(1, lambda x, p: x + p), lambda x, p: (x, p), 1),
    "drift, then kick": (lambda x, p: (x + p, p - one(x + p)), lambda x, p: (x, p + one(x)), 1),
    "kick, drift, kick": (leapfrog, lambda x, p: (x, H * p + H * H * one(x) / 2), H * H),
    "drift, kick, drift": (position, lambda x, p: (x + H * p / 2, H * p), H * H),
    "period L": (kicked(2 * math.pi / PERIOD, lambda x, p: x + p),
                 lambda x, p: (2 * math.pi / PERIOD * x, 2 * math.pi / PERIOD * p),
                 (2 * math.pi / PERIOD) ** 2),
    "mass or tune": (kicked(1, lambda x, p: x + A * p), lambda x, p: (x, A * p), A),
    "a negative drift": (kicked(1, lambda x, p: x - p), lambda x, p: (x, -p), -1),
    "a drift w": (kicked(1, lambda x, p: x + p + DRIFT), lambda x, p: (x, p + DRIFT), 1),
}


def test_all_rows_are_tried():
    table = PAGES["form.md"].partition("## One angle")[2].partition("## Two")[0]
    named = re.findall(r"^\| (?!map|-)(.*?)(?::| with| \()", table, re.MULTILINE)
    assert named == [*ROWS, "backwards"]


@pytest.mark.parametrize("name", ROWS)
def test_a_map_is_the_programs_in_other_variables(name):
    step, variables, factor = ROWS[name]
    here, rng = potential(ONE, factor), random.Random(name)
    for _ in range(20):
        x, p = rng.uniform(-3, 3), rng.uniform(-3, 3)
        assert here.map(*variables(x, p)) == pytest.approx(variables(*step(x, p)), abs=1e-12)


def test_backwards_is_the_inverse():
    here, x, p = potential(ONE), 0.3, 1.1
    assert here.inverse(x, p) == pytest.approx((x - p, p + one(x - p)), abs=1e-12)


def test_terms_of_the_force():
    """J' - J by the page, of K = 0.3 and k = (1, -2), and the amplitude and phase beside it."""
    found = re.findall(r"^\| ([+-]) K k (sin|cos)\(k.y\) \| ([+-]) K (sin|cos)\(k.y\) "
                       r"\| K, `([+-](?:sin|cos))` \((\S+)\) \|$", PAGES["form.md"], re.MULTILINE)
    y, k, K = np.array([0.7, 0.4]), np.array([1, -2]), 0.3
    assert len(found) == 4
    for sign, name, sign_of_V, of_V, word, phase in found:
        here = SymplecticMap([(1, -2, phase)], [Fraction(3, 10)])
        assert here == FourierMap({((1, -2), word): "0.3"})
        force = float(sign + "1") * K * k * getattr(math, name)(k @ y)
        assert here.map(y, 0 * y)[1] == pytest.approx(force, abs=1e-12)

        def V(y, scale=float(sign_of_V + "1") * K, of_V=of_V):
            return scale * getattr(math, of_V)(k @ y)

        for i in range(2):
            e = np.eye(2)[i] * 1e-6
            assert (V(y - e) - V(y + e)) / 2e-6 == pytest.approx(force[i], abs=1e-8)


def test_a_mass_matrix():
    """A = s M M^T: waves M^T k of s times the amplitudes, at y = M^-1 x and J = s M^T p."""
    M, s, rng = np.array([[2, 1], [-1, 1]]), Fraction(3, 2), random.Random(1)
    mass = float(s) * M @ M.T
    here = potential([(*map(int, M.T @ (k0, k1)), phase) for k0, k1, phase in TWO], s)

    def variables(x, p):
        return np.linalg.solve(M, x), float(s) * M.T @ p

    for _ in range(20):
        x, p = (np.array([rng.uniform(-3, 3), rng.uniform(-3, 3)]) for _ in range(2))
        q = p - slope(TWO, x)
        for found, expected in zip(here.map(*variables(x, p)), variables(x + mass @ q, q)):
            assert found == pytest.approx(expected, abs=1e-12)
