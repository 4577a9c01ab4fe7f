"""The map of a potential, and how an orbit's neighbours move: multipliers, indices, residues."""

import dataclasses
import math

import mpmath
import numpy as np
import pytest
from thesis.potentials import ff, poly

from converse import SymplecticMap, orbits
from converse.orbits.solver import newton

LOWEST = {"trig": (0.1489578,) * 2, "poly": (0.5, 0.5), "ff": (0.0, 0.0), "standard": (0.0,)}
POTENTIALS = (orbits.trig, poly, ff, orbits.standard)


@pytest.mark.parametrize("potential", POTENTIALS, ids=str)
def test_the_map(potential):
    """It is that of the definition, has an inverse, and the tangent map is its derivative."""
    n = potential.n
    x, p = np.random.default_rng(1).random((2, 5, 4, n))
    x1, p1 = potential.map(x, p, 0.3)
    gradient = potential.evaluate(x.reshape(-1, n))[1].reshape(x.shape)
    assert np.abs(p1 - (p - 0.3 * gradient)).max() < 1e-14 and np.abs(x1 - x - p1).max() < 1e-14
    for back, forth in zip(potential.inverse(x1, p1, 0.3), (x, p)):
        assert np.abs(back - forth).max() < 1e-13
    found, h = potential.jacobian(x, 0.3), 1e-6
    assert found.shape == (5, 4, 2 * n, 2 * n)
    for k in range(2 * n):
        a, b = np.zeros((2, n))
        (a if k < n else b)[k % n] = h
        above, below = (np.concatenate(potential.map(x + s * a, p + s * b, 0.3), -1)
                        for s in (1, -1))
        assert np.abs((above - below) / (2 * h) - found[..., k]).max() < 1e-3
    assert np.linalg.det(found) == pytest.approx(1, abs=1e-9)


def test_shapes_of_points():
    """One angle: any shape; two: the last axis is theirs."""
    for shape in ((), (3,), (3, 1), (2, 3)):
        x, p = orbits.standard.map(np.full(shape, 0.2), 0.1, 0.5)
        assert x.shape == p.shape == shape
    assert orbits.standard.jacobian(0.2).shape == (2, 2)
    assert orbits.standard.jacobian([0.2, 0.3]).shape == (2, 2, 2)
    assert orbits.trig.map([0.1, 0.2], [0.3, 0.4])[0].shape == (2,)
    for call in (lambda: orbits.trig.map(0.1, 0.2), lambda: orbits.trig.map([[0.1]], 0.2)):
        with pytest.raises(ValueError, match=r"shape \(..., 2\)"):
            call()
    with pytest.raises(ValueError, match="eps is a finite"):
        orbits.trig.map([0.1, 0.2], [0.3, 0.4], math.nan)


def test_orbits_of_points():
    """A state is the orbit of its first point; backwards the orbit returns."""
    state = orbits.straight(orbits.trig, (5, 7), 9).relax(0.01)
    x, p = orbits.trig.orbit(state.x[0], state.momenta[0], 9, state.eps)
    assert np.abs((x[:9] - state.x + 0.5) % 1 - 0.5).max() < 1e-9
    assert x[9] - x[0] == pytest.approx([5, 7], abs=1e-9)
    back, _ = orbits.trig.orbit(x[9], p[9], -9, state.eps)
    assert np.abs(back[::-1] - x).max() < 1e-9
    assert orbits.standard.orbit(0.1, 0.2, 0)[0].tolist() == [0.1]


def test_periods_of_one_and_of_two_pi():
    """The map of an input file, y' = y + J', J' = J - grad V(y); V on the torus of period 1."""
    mine = orbits.potential.known(SymplecticMap.read("inputs/froeschle-0.3.json").at(K="0.6"))
    turn, h = 2 * math.pi, 1e-6
    y, J = np.array([0.3, 2.0]), np.array([1.0, -0.4])

    def V(y):
        return 4 * math.pi ** 2 * mine.evaluate(y[None] / turn)[0][0]

    slope = [(V(y + e) - V(y - e)) / (2 * h) for e in h * np.eye(2)]
    after, momentum = mine.map(y, J)
    assert momentum == pytest.approx(J - slope, abs=1e-8)
    assert after == pytest.approx(y + J - slope, abs=1e-8)


def multiplied(state):
    """The eigenvalues of DF^q, whose modulus is at least 1, in 50 digits, from the doubles that the
    points are; and DF^q."""
    n = state.potential.n
    with mpmath.workdps(50):
        product = mpmath.eye(2 * n)
        for bend in state.potential.evaluate(state.base + state.u)[2].tolist():
            step = mpmath.eye(2 * n)
            for i in range(n):
                step[i, n + i] = 1
                for k in range(n):
                    step[n + i, k] = -mpmath.mpf(state.eps) * bend[i][k]
                    step[i, k] += step[n + i, k]
            product = step * product
        values = sorted(mpmath.eig(product)[0], key=abs, reverse=True)
    return values, product


def stationary():
    """Minima and others, of all kinds that there are: found by Newton from the straight orbit that
    begins where V is largest, and least, and somewhere else."""
    rng = np.random.default_rng(3)
    for potential, p, q, eps in (
            (orbits.standard, (0,), 1, 0.5), (orbits.standard, (1,), 2, 0.7),
            (orbits.standard, (1,), 3, 3.0), (orbits.standard, (3,), 8, 0.9),
            (orbits.standard, (34,), 89, 0.9716), (orbits.standard, (34,), 89, 0.5),
            (orbits.trig, (1, 1), 1, 0.02), (orbits.trig, (5, 7), 9, 0.01),
            (orbits.trig, (49, 65), 86, 0.0125), (orbits.trig, (49, 65), 86, 0.04),
            (ff, (12, 16), 21, 0.01), (poly, (7, 9), 12, 0.01)):
        starts = [potential.start, LOWEST[potential.name], *rng.random((2, potential.n))]
        for start in starts:
            state = orbits.straight(potential, p, q, tuple(start))
            yield state.relax(eps) if start is potential.start else newton(state, eps)[0]


@pytest.mark.parametrize("eps", [1e-300, 1e-100, 1e-12, 1e-6, 1e-3, 0.2])
@pytest.mark.parametrize("p, q", [(0, 1), (1, 2), (1, 3), (2, 5)])
def test_small_residues_have_all_their_digits(p, q, eps):
    """Those that the bends, as doubles, have: that of (0, 1) is eps, those of (1, 2) are -eps and
    eps, and the others nearly cancel."""
    state = orbits.straight(orbits.standard, p, q)
    state = state if eps < 1e-20 else state.relax(eps)
    state = dataclasses.replace(state, eps=eps)
    with mpmath.workdps(1600):
        product, bends = mpmath.eye(2), -state.eps * state.potential.evaluate(
            state.base + state.u)[2][:, 0, 0]
        for h in map(mpmath.mpf, bends.tolist()):
            product = mpmath.matrix([[1 + h, 1], [h, 1]]) * product
        truth = float((2 - product[0, 0] - product[1, 1]) / 4)
    assert state.residue == pytest.approx(truth, rel=2e-13 if q * abs(bends).sum() < 1 else 1e-9,
                                          abs=0)
    if q == 2 and eps in (1e-6, 1e-12, 1e-100):
        assert state.residue == pytest.approx(eps ** 2 / 4, rel=2e-13)
    if q == 1:
        assert state.residue == pytest.approx(-eps / 4, rel=1e-12)
        assert state.indices[0] == pytest.approx(2 + eps, rel=1e-15)
        assert state.exponents[0] == pytest.approx(2 * math.asinh(math.sqrt(eps) / 2), rel=1e-12)


@pytest.mark.slow
def test_multipliers_against_fifty_digits():
    kinds = set()
    for state in stationary():
        n, (values, product) = state.potential.n, multiplied(state)
        with mpmath.workdps(50):
            mine = [mpmath.exp(mpmath.mpc(x)) for x in state.log_multipliers]
            rho = [complex(l + 1 / l) for l in mine]
            theirs = [complex(l + 1 / l) for l in values]
            residue = (2 - product[0, 0] - product[1, 1]) / 4
            matrix = [[float(product[i, k] * mpmath.exp(-state.monodromy.log))
                       for k in range(2 * n)] for i in range(2 * n)]
        for one in rho:                             # each is one of theirs, to 1e-9 of its size
            off = min(abs(one - other) for other in theirs)
            assert off < 1e-8 * max(1, abs(one)), (state, rho, theirs)
        assert np.abs(matrix - state.monodromy.matrix).max() < 1e-9
        assert state.exponents == pytest.approx(
            [float(mpmath.log(abs(l))) / state.q for l in values[:n]], abs=1e-9)
        assert np.abs(state.indices - rho).max() < 1e-9 * max(1, *map(abs, rho))
        if n == 1:
            assert state.residue == pytest.approx(float(residue), rel=1e-9, abs=1e-10)
            kinds.add("hyperbolic" if state.residue < 0 else
                      "elliptic" if state.residue < 1 else "reflected")
        else:
            kinds.add("complex" if np.iscomplexobj(state.indices) else
                      tuple(sorted(int(abs(x) < 2) for x in state.indices)))
    assert kinds >= {"hyperbolic", "elliptic", "reflected", (0, 0), (0, 1)}, kinds


def test_the_residue_is_a_determinant():
    """R = -det(Hessian)/4 (MacKay and Meiss 1983): below 0 for minima, and above for saddles with
    one direction down."""
    for state in stationary():
        if state.potential.n == 1 and state.q > 2:
            band = np.diag(state.blocks[:, 0])
            for j in range(state.q):
                k = (j + 1) % state.q
                band[j, k] = band[k, j] = -1
            assert state.residue == pytest.approx(-np.linalg.det(band) / 4, rel=1e-8, abs=1e-10)
            assert (state.residue > 0) == (state.below(0) % 2 == 1)


def test_nothing_overflows():
    """q times the exponent is 2000."""
    state = orbits.follow(orbits.trig, (1432, 1897), 2513, [0.04])[0]
    assert np.isinf(state.indices[0]) and np.isinf(state.multipliers[0])
    assert state.log_multipliers.real == pytest.approx(state.q * state.exponents)
    assert state.monodromy.log > 1900 and np.isfinite(state.monodromy.matrix).all()
    long = orbits.straight(orbits.standard, (377,), 987).relax(2.0)
    assert long.residue == -math.inf and long.exponents[0] > 0.75
    with pytest.raises(ValueError, match="one angle"):
        state.residue
