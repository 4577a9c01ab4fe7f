"""The core of the orbits: potentials, the band of the Hessian, states, continuation."""

import copy
import json
import pickle
import re
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from sums import fourier, from_terms, named
from thesis.potentials import ff, poly

from converse import orbits
from converse._native import lib
from converse.model.map import SymplecticMap
from converse.model.potential import FourierSum
from converse.orbits import solver
from converse.orbits.potential import address

POTENTIALS = [orbits.trig, poly, ff, orbits.froeschle, orbits.standard]
TWO = POTENTIALS[:4]
SPIRAL, RESONANT = ((1432, 1897), 2513), ((377, 2330), 3770)


def by(value):
    return getattr(value, "name", None)


def truth(potential):
    """V as the thesis writes it (section 2.2), with mpmath's numbers."""
    def spline(x):
        x %= 1
        return 1 - 24 * x ** 2 + 32 * x ** 3 if x <= 0.5 else 9 - 48 * x + 72 * x ** 2 - 32 * x ** 3

    def trig(x, y):
        m = mpmath.sqrt(207 + 33 * mpmath.sqrt(33)) / (8 * mpmath.sqrt(2))
        s = lambda t: mpmath.sin(2 * mpmath.pi * t)                             # noqa: E731
        return -((s(x) + s(y)) / 2 + s(x + y)) / m

    def poly(x, y):
        x, y = x % 1, y % 1
        return -4096 * x ** 2 * (1 - x) ** 2 * (x - 0.75) * (0.25 - x) * y ** 2 * (1 - y) ** 2

    def froeschle(x, y, c=lambda t: mpmath.cos(2 * mpmath.pi * t)):
        return -((c(x) + c(y)) / 2 + c(x + y)) / 2

    return {"trig": trig, "poly": poly, "ff": lambda x, y: froeschle(x, y, spline),
            "froeschle": froeschle,
            "standard": lambda x: -mpmath.cos(2 * mpmath.pi * x) / (4 * mpmath.pi ** 2)
            }[potential.name]


# ---- potentials

@pytest.mark.parametrize("potential", POTENTIALS, ids=by)
def test_potentials_are_the_thesis_s(potential):
    """Value and derivatives against 40 digits, the derivatives by differences of 10^-12."""
    rng = np.random.default_rng(1)
    x = np.vstack([rng.uniform(-2, 2, (20, potential.n)), np.zeros((1, potential.n)),
                   np.full((1, potential.n), 0.5), np.full((1, potential.n), 0.25 + 2.0 ** -40)])
    value, gradient, hessian = potential.evaluate(x)
    v = truth(potential)
    with mpmath.workdps(40):
        h = mpmath.mpf("1e-12")
        for k, point in enumerate(x):
            point = [mpmath.mpf(float(c)) for c in point]

            def moved(*by):
                return v(*[c + h * d for c, d in zip(point, by)])

            basis = np.eye(potential.n, dtype=int)
            assert abs(value[k] - v(*point)) < 2e-15
            for i, e in enumerate(basis):
                assert abs(gradient[k, i] - (moved(*e) - moved(*-e)) / (2 * h)) < 2e-14
                for j, f in enumerate(basis):
                    second = (moved(*(e + f)) - moved(*(e - f)) - moved(*(f - e))
                              + moved(*(-e - f)))
                    # at a junction of cubics the difference is off by h times their third
                    # derivative
                    assert abs(hessian[k, i, j] - second / (4 * h * h)) < 3e-9


def test_the_constants():
    """max |V| = 1, attained where V is least; the starts are maxima."""
    for potential, low, at, start in [(orbits.trig, -1, (0.1489578, 0.1489578), 1),
                                      (poly, -1, (0.5, 0.5), 0.25),
                                      (ff, -1, (0, 0), Fraction(27, 49)),
                                      (orbits.froeschle, -1, (0, 0), Fraction(9, 16))]:
        axis = (np.arange(200) + 0.5) / 200
        grid = np.stack(np.meshgrid(axis, axis), -1).reshape(-1, 2)
        values = potential.evaluate(grid)[0]
        assert abs(potential.evaluate([at])[0][0] - low) < 1e-13
        assert values.min() > low - 1e-12 and values.max() < float(start) + 1e-12
        assert abs(potential.evaluate([potential.start])[0][0] - float(start)) < 1e-12
    assert abs(orbits.trig.scale - 1 / 1.7601726) < 1e-8
    for potential in (orbits.trig, orbits.standard):
        low, high = potential.scale_enclosure(30)
        with mpmath.workdps(50):
            true = -truth(potential)(*[mpmath.mpf(0)] * potential.n) if potential.n == 1 else \
                8 * mpmath.sqrt(2) / mpmath.sqrt(207 + 33 * mpmath.sqrt(33))
            assert mpmath.mpf(low.numerator) / low.denominator < true \
                < mpmath.mpf(high.numerator) / high.denominator
        assert high - low < Fraction(1, 10 ** 30)


@pytest.mark.parametrize("potential", POTENTIALS, ids=by)
def test_bounds_of_the_second_derivative(potential):
    """Curvature and lipschitz hold, and not by more than a factor of two, at random and on a
    grid."""
    rng = np.random.default_rng(2)
    n = potential.n
    grid = np.stack(np.meshgrid(*[np.arange(128) / 128] * n), -1).reshape(-1, n)
    hessian = potential.evaluate(grid)[2]
    size = np.linalg.norm(hessian, 2, axis=(1, 2)).max()
    assert 0.5 * potential.curvature < size <= potential.curvature * (1 + 1e-14)
    worst = 0.0
    for step in 2.0 ** -np.arange(2, 13):
        x = rng.uniform(0, 1, (3000, n))
        dx = rng.normal(size=(3000, n))
        dx[:1500] = rng.choice([-1, 0, 1], (1500, n))   # along the sides and diagonals, too
        x[:500] = 0.0                                   # across the junctions
        dx = dx * step / np.maximum(1e-9, np.linalg.norm(dx, axis=1))[:, None]
        change = potential.evaluate(x + dx)[2] - potential.evaluate(x)[2]
        length = np.linalg.norm(dx, axis=1)
        ratio = np.linalg.norm(change, 2, axis=(1, 2))[length > 0] / length[length > 0]
        worst = max(worst, ratio.max())
    assert 0.4 * potential.lipschitz < worst <= potential.lipschitz


def test_the_other_half_of_the_package_has_the_same_map():
    """y = 2 pi x: a = b = c/2 = 11.21436 eps, and the same orbits."""
    a = b = 2 * np.pi ** 2 * orbits.trig.scale * 0.0276
    c = 2 * a
    assert (a, b, c) == pytest.approx((11.21436 * 0.0276,) * 2 + (2 * 11.21436 * 0.0276,), rel=1e-6)
    x = np.random.default_rng(3).uniform(size=(10, 2))
    y = 2 * np.pi * x
    both = c * np.cos(y.sum(1))
    force = np.stack([a * np.cos(y[:, 0]) + both, b * np.cos(y[:, 1]) + both], 1)   # -dV(y)
    assert np.allclose(-0.0276 * orbits.trig.evaluate(x)[1], force / (2 * np.pi), atol=1e-14)


@pytest.mark.parametrize("file, at", [
    ("froeschle-0.3.json", {"K": "0.6"}), ("crossed.json", {"s": "5/7"}),
    ("two-harmonics.json", {"K1": 1}), ("trig278.in", {"a": "0.3", "b": "-0.1", "c": "1/3"}),
    (None, {})])
def test_an_input_s_potential_has_the_input_s_map(root, tmp_path, file, at):
    """Both maps from the same points: y' = y + J', J' = J - grad V(y) as
    docs/reference/proof-file.md has V,
    and with y = 2 pi x, J = 2 pi p and eps = 1 that of the orbits."""
    path = root / "inputs" / (file or "")
    if file is None:                    # the page's example, and phases without rational sines
        path = tmp_path / "mine.json"
        path.write_text(json.dumps({"harmonics": [
            {"k": [1, 0], "amplitude": "1/3", "phase": "-cos"}, {"k": [1, 0], "amplitude": "0.2"},
            {"k": [1, -1], "amplitude": "0.3", "phase": "1/3"},
            {"k": [1, -1], "amplitude": "-0.1", "phase": "-3/7"}]}))
    source = SymplecticMap.read(path).at(**at).potential()
    mine = orbits.potential.Fourier.of(source, "mine")
    for again in (mine, *ways(mine)):
        rng = np.random.default_rng(6)
        x, p = rng.uniform(size=(20, mine.n)), rng.uniform(-1, 1, (20, mine.n))
        y, J = 2 * np.pi * x, 2 * np.pi * p
        for _ in range(5):
            for (*k, phase), size in zip(source.waves, source.amplitude):
                k = np.array(k[:mine.n])
                J = J + float(size) * k * np.cos(y @ k + np.pi * float(phase))[:, None]
            y = y + J
            p = p - again.evaluate(x)[1]
            x = x + p
        assert np.abs(y - 2 * np.pi * x).max() < 1e-12 and again.formula == mine.formula


@pytest.mark.parametrize("digits", [0, 40, 200])
def test_coefficients_hold_the_true_ones(digits):
    source = FourierSum(((1, 0, Fraction(1, 2)), (1, 0, Fraction(1)), (1, 0, Fraction(-2, 3)),
                         (3, -2, Fraction(1, 10 ** 9))),
                        (Fraction(1, 3), Fraction(10 ** 20), Fraction(-2, 7), Fraction(5)), 2)
    mine = orbits.potential.Fourier.of(source)
    found = mine.coefficients(digits)
    assert [k for k, *_ in found] == [(1, 0), (1, 0), (3, -2)]
    with mpmath.workdps(digits + 60):
        scale = 1 / (4 * mpmath.pi ** 2)
        true = [(-scale / 3, scale * 10 ** 20)] + [
            tuple(-p * scale * f(mpmath.mpf(phase.numerator) / phase.denominator)
                  for f in (mpmath.sinpi, mpmath.cospi))
            for p, phase in ((-mpmath.mpf(2) / 7, Fraction(-2, 3)), (5, Fraction(1, 10 ** 9)))]
        for (_, *both), values in zip(found, true):
            for (low, high), value in zip(both, values):
                assert mpmath.mpf(low.numerator) / low.denominator <= value
                assert value <= mpmath.mpf(high.numerator) / high.denominator
                assert high - low <= Fraction(1, 10 ** digits)
    for k in range(2):                  # what the doubles are made of
        assert mine.arrays[1 + k] == pytest.approx([float(values[k]) for values in true],
                                                    rel=4e-16)


def test_one_s_own_potentials():
    """A Fourier sum is as good as what is built in."""
    scale = Fraction(orbits.trig.scale)
    mine = fourier({k: (c * scale, s * scale)
                    for k, (c, _), (s, _) in orbits.trig.sum.terms(0)}, "mine")
    assert mine.start == pytest.approx(orbits.trig.start, abs=1e-6)
    a = orbits.straight(mine, (5, 7), 9, orbits.trig.start).relax(0.03)
    b = orbits.straight(orbits.trig, (5, 7), 9).relax(0.03)
    assert np.abs(a.u - b.u).max() < 1e-12 and a.label == b.label == "minimum"


AT_REST = orbits.straight(orbits.trig, (5, 7), 9)


MINE = {(1,): (-1, 0), (2,): (0, Fraction(1, 7))}


def ways(thing):
    """What becomes of a thing that is copied or sent to another process."""
    return copy.copy(thing), copy.deepcopy(thing), pickle.loads(pickle.dumps(thing))


def test_a_potential_stays_what_it_is():
    """Copied, and in another process, V is the same: start, bounds and scale with it."""
    x = np.random.default_rng(4).uniform(size=(50, 1))
    for mine in (fourier(MINE, "mine"),
                 fourier({(1,): (-1, 0)}, "mine", (0.25,)),
                 orbits.potential.Fourier.of(from_terms(MINE), "mine"), orbits.standard):
        state = orbits.straight(mine, (2,), 5).relax(0.1)
        for again in ways(mine):
            for name in ("name", "n", "start", "formula", "curvature", "lipschitz"):
                assert getattr(again, name) == getattr(mine, name), name
            assert again == mine and hash(again) == hash(mine)
            assert all((a == b).all() for a, b in zip(again.evaluate(x), mine.evaluate(x)))
        for again in ways(state):
            assert again.action == state.action and again.label == state.label == "minimum"
            assert orbits.follow(mine, (2,), 5, [0.1], start=again)[0].action == state.action
    assert fourier(MINE, start=(0.5,)) != orbits.potential.Fourier.of(from_terms(MINE),
                                                                      start=(0.5,))
    assert orbits.trig != "trig"


def test_a_potential_cannot_be_changed():
    """Proofs believe its bounds."""
    for mine in (orbits.trig, poly, fourier(MINE)):
        for name in ("name", "n", "start", "formula", "curvature", "lipschitz", "native", "sum",
                     "scale", "scale_enclosure", "other"):
            with pytest.raises(AttributeError):
                setattr(mine, name, 1.0)
        with pytest.raises(AttributeError):
            del mine.curvature


def test_formulas_say_what_v_is():
    """The words of a formula, read as Python, give V."""
    def value(potential, at):
        words = potential.formula.partition(", ")[0]
        names = {"pi": mpmath.pi, "cos": mpmath.cos, "sin": mpmath.sin, "x": at[0],
                 "s": getattr(potential, "scale", None), **{"x%d" % i: x for i, x in enumerate(at)}}
        if potential is poly:
            for letter, x in zip("ab", at):
                names[letter] = 0.25 - (x % 1 - 0.5) ** 2
        names["c"] = lambda x: 1 - 24 * abs(x - round(x)) ** 2 + 32 * abs(x - round(x)) ** 3
        return eval(re.sub(r"([\da-z)]) (?=[\da-z(])", r"\1*", words).replace("^", "**"), names)

    shifted = orbits.potential.Fourier.of(FourierSum(
        ((1, 0, Fraction(1, 3)), (2, -1, Fraction(-1, 7)), (0, 1, Fraction(1))),
        (Fraction(2, 5), Fraction(-1), Fraction(1, 3)), 2))
    odd = fourier({(3, -2): (0.25, -0.5), (-1, 0): (2, 0)})
    rng = np.random.default_rng(5)
    for potential in (orbits.trig, poly, ff, orbits.froeschle, orbits.standard, odd,
                      shifted):
        for at in rng.uniform(size=(5, potential.n)):
            assert float(value(potential, at)) == pytest.approx(
                potential.evaluate([at])[0][0], abs=1e-14), potential.formula
    assert orbits.trig.formula.endswith(", s = 8 sqrt 2/sqrt(207 + 33 sqrt 33)")
    assert orbits.standard.formula == "s (-cos(2 pi x)), s = 1/(4 pi^2)"


@pytest.mark.parametrize("make, word", [
    (lambda: fourier({(1, 2): (1e308, 0)}), "too large"),
    (lambda: orbits.follow(orbits.trig, (5, 7), 9, [float("nan")]), "eps: finite"),
    (lambda: orbits.follow(orbits.trig, (5, 7), 9, [1e6]), "more than 10000 steps of 0.0025"),
    (lambda: orbits.follow(orbits.trig, (5, 7), 9, [20.0, -20.0]), "eps -20.0 is more than"),
    (lambda: orbits.follow("trig", (5, 7), 9, [0.01]), "map is a SymplecticMap"),
    (lambda: orbits.follow(orbits.trig, (5, 7), 9, [0.01], 3), "progress is a function"),
    (lambda: orbits.follow(orbits.trig, 5, 9, [0.01]), "whole"),
    (lambda: orbits.follow(orbits.trig, (5, 7), 10 ** 7 + 1, [0.01]), "from 1 to 10000000"),
    (lambda: orbits.follow(orbits.trig, (float("inf"), 7), 9, [0.01]), "whole"),
    (lambda: orbits.straight(orbits.standard, (1,), 3, 0.0), "origin"),
    (lambda: orbits.straight(orbits.standard, (1,), 3, (1e17,)), "origin"),     # x_0 = x_1 = x_2
    (lambda: orbits.PeriodicOrbit(orbits.trig, (1, 1), 2, 0.1, "a", (0, 0)), "rows"),
    (lambda: orbits.prove(3), "a state is expected"),
    (lambda: orbits.onset(orbits.trig, (5, 7), 9, step=1e-300), "at most"),
    (lambda: AT_REST.relax(0.01, tol=float("nan")), "eps and tol: finite"),
    (lambda: AT_REST.relax(0.01, max_steps=1.5), "max_steps"),
    (lambda: AT_REST.repeat(10 ** 9), "run through"),
    (lambda: AT_REST.below("a"), "shift: finite"),
    (lambda: orbits.trig.evaluate([1, 2]), "shape"),
    (lambda: orbits.straight(orbits.trig, (1,), 3), "2 whole"),
    (lambda: orbits.PeriodicOrbit(orbits.trig, (1, 1), 2, 0.1, np.zeros((3, 2)), (0, 0)), "rows"),
    (lambda: orbits.PeriodicOrbit(orbits.trig, (1, 1), 2, 0.1, np.full((2, 2), np.nan), (0, 0)),
     "finite"),
])
def test_bad_arguments(make, word):
    with pytest.raises(ValueError, match=word) as error:
        make()
    assert "\n" not in str(error.value)


# ---- the band

def dense(state):
    """The Hessian, block by block as the action's second difference has it."""
    n, q = state.potential.n, state.q
    hessian = np.zeros((q, n, q, n))
    for j in range(q):
        a, b, c = state.blocks[j]
        hessian[j, :, j, :] += np.array([[a, b], [b, c]])[:n, :n]
        hessian[j, :, (j + 1) % q, :] -= np.eye(n)
        hessian[(j + 1) % q, :, j, :] -= np.eye(n)
    return hessian.reshape(q * n, q * n)


@pytest.mark.parametrize("potential, p, q, eps", [
    (orbits.trig, (5, 7), 9, 0.03), (orbits.trig, (1, 1), 2, 0.05), (ff, (1, 0), 1, 0.1),
    (poly, (0, 1), 3, 0.03), (orbits.standard, (3,), 8, 0.9),
    (orbits.standard, (1,), 2, 2.0),
    (orbits.standard, (0,), 1, 1.0), (orbits.froeschle, (13, 8), 40, 0.2)], ids=str)
def test_the_band_against_a_dense_matrix(potential, p, q, eps):
    rng = np.random.default_rng(q)
    n = potential.n
    for _ in range(20):
        state = orbits.PeriodicOrbit(potential, p, q, eps, rng.normal(size=(q, n)) / 5,
                                     potential.start)
        matrix = dense(state)
        eigenvalues = np.linalg.eigvalsh(matrix)
        mu = rng.uniform(-1, 1)
        b, u = np.zeros((q, 2)), np.zeros((q, 2))
        b[:, :n] = rng.normal(size=(q, n))
        work = np.zeros((q, lib.CV_WORK))
        negative = lib.cv_solve(n, q, address(state.blocks, "double(*)[3]"), mu, address(b),
                                address(u), address(work, "double *"))
        true = np.linalg.solve(matrix + mu * np.eye(n * q), b[:, :n].ravel()).reshape(q, n)
        away = 1 / np.abs(eigenvalues + mu).min()
        assert negative == (eigenvalues < -mu).sum()
        assert np.abs(u[:, :n] - true).max() < 1e-11 * away * np.abs(true).max() + 1e-12 * away
        assert not u[:, n:].any()
        assert state.least == pytest.approx(eigenvalues[0], rel=1e-4)


@pytest.mark.parametrize("n", [1, 2])
def test_the_round_of_the_first_pivot_that_is_not_positive(n):
    """Against the open chain of blocks, run round the orbit: it is definite up to there."""
    rng, found, indefinite = np.random.default_rng(n), [], 0
    for _ in range(400):
        q, rounds = int(rng.integers(1, 5)), 4
        blocks, pivots = np.tile([2.0, 0.0, 2.0], (q, 1)), np.zeros((q, 3))
        blocks[:, :2 * n - 1] += rng.normal(size=(q, 2 * n - 1)) * rng.choice([0.1, 0.5, 2])
        chain = np.zeros((n * q * rounds, n * q * rounds))
        first = 0
        for j in range(q * rounds):
            a, b, c = blocks[j % q]
            chain[n * j:n * j + n, n * j:n * j + n] = np.array([[a, b], [b, c]])[:n, :n]
            for i in range(n * j, n * j + n if j else 0):
                chain[i, i - n] = chain[i - n, i] = -1
            values = np.linalg.eigvalsh(chain[:n * j + n, :n * j + n])
            if values[0] <= 0:
                first, indefinite = j // q + 1, indefinite + (values[-1] > 0)
                break
        result = lib.cv_pivots(n, q, address(blocks, "double(*)[3]"), rounds,
                               address(pivots, "double(*)[3]"))
        assert result == -first if first else result >= 0
        found.append(result)
    assert {-4, -3, -2, -1, 0} <= {*found} and indefinite > 100


def test_action_gradient_and_blocks_belong_together():
    """Each is the derivative of the one before, by differences; type and action are those of H."""
    rng = np.random.default_rng(4)
    for potential in POTENTIALS:
        n, q = potential.n, 7
        p = (3, -2)[:n]
        state = orbits.PeriodicOrbit(potential, p, q, 0.3, rng.normal(size=(q, n)) / 3,
                                     potential.start)
        lift = np.array(state.origin) + np.arange(q + 1)[:, None] * np.array(p) / q \
            + np.vstack([state.u, state.u[:1]])
        kinetic = (np.diff(lift, axis=0) ** 2).sum() / 2 / q - (state.rotation ** 2).sum() / 2
        assert state.action == pytest.approx(
            kinetic - 0.3 * potential.evaluate(lift[:-1])[0].mean(), abs=1e-13)
        assert np.abs((lift[:-1] - state.x + 0.5) % 1 - 0.5).max() < 1e-14
        direction, h = rng.normal(size=(q, n)), 1e-5
        ahead, behind = state.moved(state.u + h * direction), state.moved(state.u - h * direction)
        assert q * (ahead.action - behind.action) / (2 * h) == pytest.approx(
            (state.gradient * direction).sum(), abs=1e-7)
        assert np.allclose((ahead.gradient - behind.gradient).ravel() / (2 * h),
                           dense(state) @ direction.ravel(), atol=1e-6)
        # the map takes a point to the next but for the gradient
        following = state.momenta - 0.3 * potential.evaluate(state.x)[1]
        assert np.allclose((state.x + following - np.roll(state.x, -1, 0) + 0.5) % 1, 0.5,
                           atol=1e-13)
        assert state.shadow == pytest.approx(np.linalg.norm(
            np.roll(state.momenta, -1, 0) - following, axis=1).max(), abs=1e-13)
        assert state.grad_size <= state.shadow <= np.sqrt(q) * state.grad_size * (1 + 1e-12)


# ---- continuation; the values are those of an independent program

CHECK = {       # eps: exponents, action per point less the straight one's
    (orbits.trig, SPIRAL): {0.005: (0, 0, -0.000070636966), 0.0075: (0, 0, -0.000159967622),
                            0.01: (0.0359, 0.0005, -0.00028757171),
                            0.0125: (0.0992, 0.0013, -0.00045753824),
                            0.015: (0.1633, 0.0027, -0.00067501039),
                            0.02: (0.2724, 0.0131, -0.00126164517),
                            0.03: (0.4243, 0.0766, -0.003056), 0.04: (0.8132, 0.1624, -0.005905)},
    (orbits.trig, RESONANT): {0.005: (0.0001, 0, -0.00012432687),
                              0.0075: (0.0011, 0, -0.000280228738),
                              0.01: (0.0549, 0.0064, -0.000501227481),
                              0.0125: (0.1215, 0.0179, -0.000793845843),
                              0.015: (0.1994, 0.0376, -0.001166463600),
                              0.02: (0.3628, 0.0963, -0.002173733577),
                              0.03: (0.6290, 0.1780, -0.005133715291),
                              0.04: (0.8439, 0.2287, -0.009015999413)},
    (ff, SPIRAL): {0.005: (0.0495, 0.0031, -0.000059078),
                          0.0075: (0.1026, 0.0048, -0.000133394),
                          0.01: (0.1560, 0.0049, -0.000238778),
                          0.0125: (0.2038, 0.0054, -0.000376696),
                          0.015: (0.2488, 0.0117, -0.000548203),
                          0.02: (0.3330, 0.0214, -0.000994821),
                          0.03: (0.4913, 0.0298, -0.00229929), 0.04: (0.6526, 0.0742, -0.00411219)},
    (poly, RESONANT): {0.005: (0.0976, 0.0016, 0.00051729),
                              0.0075: (0.1231, 0.0038, 0.00071202),
                              0.01: (0.2196, 0.0361, 0.00086109),
                              0.0125: (0.2885, 0.0415, 0.00096544),
                              0.015: (0.3528, 0.0444, 0.00102809),
                              0.02: (0.4653, 0.0589, 0.00104560),
                              0.03: (0.6535, 0.1412, 0.00074550),
                              0.04: (0.8014, 0.1670, 0.00014024)},
}
SURE = {(orbits.trig, RESONANT): 1e-11}         # actions that other steps confirm to all digits


@pytest.mark.parametrize("which", CHECK, ids=lambda which: "%s %s" % (which[0].name, which[1]))
@pytest.mark.slow
def test_families(which):
    potential, (p, q) = which
    table = CHECK[which]
    family = orbits.follow(potential, p, q, table)
    assert list(family.eps) == list(table)
    for state, (first, second, action) in zip(family, table.values()):
        assert state.label == "minimum" and np.abs(state.gradient).max() <= 1e-13
        loose = 1e-8 if state.eps < 0.025 else 1e-6 if state.eps < 0.035 else 6e-6
        if potential is poly:
            loose = max(loose, 2e-6)
        if state.eps > 0.005 or potential is not orbits.trig:
            loose = SURE.get(which, loose)
        assert state.action == pytest.approx(action, abs=loose)
        assert state.exponents[0] == pytest.approx(first, rel=0.01, abs=1e-4)
        far = 0.013 if potential is poly and state.eps < 0.015 else 0.003
        assert state.exponents[1] == pytest.approx(second, abs=far)
        assert (state.undetermined > 0) == (state.eps < 0.009 and potential is orbits.trig)


def test_first_exponents_leave_zero_where_the_text_says():
    """trig 0.0080 for both vectors; the momenta at 0.0075 lie on a smooth surface (thesis, 2.2)."""
    for p, q in (SPIRAL, RESONANT):
        below, above = orbits.follow(orbits.trig, p, q, [0.007, 0.009])
        assert below.exponents[0] < 0.001 and above.exponents[0] > 0.004


def test_the_standard_map():
    """377/987 at Greene's k_c: the minimizing orbit's residue is -0.2555; and at k = 1.001635 the
    cantorus has its widest gap at x = 0 (thesis, sections 1.2, 2.1), as wide as a longer orbit
    says, and its points lie on the circle in the order of a rotation's."""
    critical, beyond = orbits.follow(orbits.standard, (377,), 987, [0.971635406, 1.001635])
    growth = 987 * critical.exponents[0]
    assert (2 - 2 * np.cosh(growth)) / 4 == pytest.approx(-0.2555, abs=2e-4)
    longer, = orbits.follow(orbits.standard, (610,), 1597, [1.001635])
    widest = []
    for state in (beyond, longer):
        order = np.argsort(state.x[:, 0])
        steps = np.diff(order * state.p[0] % state.q)           # their places in that order
        assert ((steps == 1) | (steps == 1 - state.q)).all()
        x = state.x[order, 0]
        gaps = np.diff(np.append(x, x[0] + 1))
        where = (x + gaps / 2)[gaps.argmax()] % 1
        assert min(where, 1 - where) < 1e-6
        widest.append(gaps.max())
    assert widest[0] == pytest.approx(widest[1], rel=1e-6) and 0.0528 < widest[0] < 0.0530


# ---- states

def test_labels():
    """A maximum of V is where a minimum runs through; the minima of V make the saddles."""
    least = orbits.straight(orbits.trig, (1, 1), 2).relax(0.02)
    assert least.label == "minimum" and least.repeat(3).label == "minimum"
    low = orbits.PeriodicOrbit(orbits.standard, (0,), 1, 0.5, [[0.0]], (0.0,))
    assert (low.label, orbits.PeriodicOrbit(orbits.standard, (0,), 1, 0.5, [[0.0]], (0.5,)).label) \
        == ("saddle", "minimum")
    assert least.moved(least.u + 1e-3).label == "not stationary"
    assert low.relax().label == "minimum"               # it escapes
    flat = orbits.straight(orbits.trig, (3, 4), 7)
    assert flat.label == "minimum" and flat.undetermined == 2


def test_continuation_knows_no_unit_of_eps():
    """1000 V and eps/1000 are the same map: the same minima, found in as many steps."""
    terms = {(1, 0): (0, -0.3), (0, 1): (0, -0.3), (1, 1): (0, -0.6)}
    families = []
    for factor in (Fraction(1, 1000), 1, 1000):
        mine = fourier({k: (factor * Fraction(c), factor * Fraction(s))
                        for k, (c, s) in terms.items()}, "mine", (0.85, 0.85))
        taken = []
        relax = orbits.PeriodicOrbit.relax
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(orbits.PeriodicOrbit, "relax", lambda state, eps: (
                taken.append(eps), relax(state, eps))[1])
            families.append(orbits.follow(mine, (65, 86), 114, [0.02 / factor, 0.06 / factor]))
        assert len(taken) == 24
    for family in families:
        for state, other in zip(family, families[1]):
            assert np.abs(state.u - other.u).max() < 1e-9
    assert [solver.step_of(named(name)) for name in ("trig", "poly", "ff", "standard")] \
        == [0.0025, 0.0025, 0.0025, 0.25]
    assert solver.step_of(fourier({(1,): (0, 0)}, "flat")) > 1e200


def test_states_are_values(tmp_path):
    state = orbits.straight(orbits.trig, (5, 7), 9).relax(0.03)
    for again in (state, *ways(state)):
        assert again.potential == orbits.trig and (again.u == state.u).all() and again.eps == 0.03
        for name in ("u", "base", "momenta", "gradient", "blocks", "exponents"):
            with pytest.raises(ValueError, match="read-only"):
                getattr(again, name)[0] = 1
    double = state.repeat(2)
    assert double.label == "minimum"
    assert (double.p, double.q) == ((10, 14), 18)
    assert double.action == pytest.approx(state.action, abs=1e-15)
    assert np.allclose(double.exponents, state.exponents, atol=1e-12)
    lengths = [np.hypot(*(state.u - line).T).max() for line in (state.u[0], 0)]
    assert state.deviation == pytest.approx(lengths, abs=1e-15)
    family = orbits.follow(orbits.trig, (5, 7), 9, [0.01, 0.02])
    assert isinstance(family[1:], orbits.Family) and list(family[1:].eps) == [0.02]
    assert family[1].eps == 0.02 and [state.eps for state in family] == family.eps.tolist()
