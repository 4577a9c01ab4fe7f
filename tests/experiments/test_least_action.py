"""Lower bounds of the action: no orbit and no path has less action than is proved of all."""

import csv
import ctypes
import itertools
import os
import platform
import runpy
import subprocess
import sys

import mpmath
import numpy as np
import pytest
from least_action import branch_and_bound, enclosed_action, least_action, mather, mather_beta
from least_action.build import library
from sums import fourier
from test_orbits import truth

from converse import ConverseError, orbits
from converse._native import ffi
from converse.orbits.potential import address

from moments import PATIENCE
from truth import TORTURE

POTENTIALS = [orbits.trig, orbits.poly, orbits.ff, orbits.froeschle, orbits.standard]
SPIRAL = (0.5698402909980532, 0.7548776662466927)
WAVES = fourier({(0, 0): (1, 0), (3, -2): (0.25, -0.5), (0, 1): (-1, 0.125), (2, 2): (0.5, 0)})


def by(value):
    return getattr(value, "name", None)


def pairs(x):
    """Points (m, n) as C takes them."""
    return np.ascontiguousarray(np.column_stack([x, np.zeros((len(x), 2 - x.shape[1]))]))


# ---- what doubles may be off by

@pytest.mark.parametrize("potential", [*POTENTIALS, WAVES], ids=by)
def test_errors_of_values(potential):
    """V and its derivatives are no further from those at a point moved by as much as it may be off
    than cv_errors says, and it does not say a thousand times too much."""
    rng, n = np.random.default_rng(3), potential.n
    for reach in (1.0, 5.0, 90.0):
        x = rng.uniform(-reach, reach, (40 * TORTURE, n))
        errors = ffi.new("double[3]")
        assert library().cv_errors(potential.native, reach, errors) == 0
        value, gradient, hessian = potential.evaluate(x)
        worst = np.zeros(3)
        with mpmath.workdps(40):
            v = mp_value(potential)
            for k, point in enumerate(x):
                off = 2.0 ** -53 * (2 * reach + 2)
                moved = [mpmath.mpf(c) + float(rng.choice([-1, 1])) * off for c in point]
                true = [v(moved, order) for order in mp_orders(n)]
                slopes = [abs(gradient[k, i] - true[1 + i]) for i in range(n)]
                bends = [abs(hessian[k, i, j] - true[1 + n + n * i + j])
                         for i in range(n) for j in range(n)]
                far = [abs(value[k] - true[0]), mpmath.norm(slopes), mpmath.norm(bends)]
                worst = np.maximum(worst, [float(f) for f in far])
        assert (worst <= list(errors)).all()
        assert (np.array(list(errors)) < 1000 * worst + 1e-13).all()


def mp_orders(n):
    """Value, gradient and Hessian, row by row, as orders of derivatives."""
    basis = np.eye(n, dtype=int)
    return [np.zeros(n, int), *basis, *[a + b for a in basis for b in basis]]


def mp_value(potential):
    """The derivatives of V of any order at a point, with mpmath's digits."""
    if potential.name in ("poly", "ff"):
        v = truth(potential)
        h = mpmath.mpf(10) ** -11

        def derivative(x, order):
            # central differences, exact but for h^2 times what is beyond the cubics
            points = [(mpmath.mpf(1), list(x))]
            for axis, times in enumerate(order):
                for _ in range(times):
                    points = [(sign * weight / (2 * h), [c + sign * h * (k == axis)
                                                         for k, c in enumerate(at)])
                              for weight, at in points for sign in (1, -1)]
            return mpmath.fsum(weight * v(*at) for weight, at in points)
        return derivative
    low, high = potential.scale_enclosure(30)

    def derivative(x, order):
        total = mpmath.mpf(0)
        for k, *both in potential.sum.terms(0):
            cosine, sine = (exact for exact, _ in both)
            phase = 2 * mpmath.pi * mpmath.fdot(k, x)
            waves = [mpmath.cos(phase), mpmath.sin(phase)]
            cosine, sine = (mpmath.mpf(c.numerator) / c.denominator for c in (cosine, sine))
            for _ in range(sum(order)):
                cosine, sine = sine, -cosine
            factor = mpmath.fprod((2 * mpmath.pi * k[i]) ** int(order[i]) for i in range(len(x)))
            total += factor * (cosine * waves[0] + sine * waves[1])
        return total * (mpmath.mpf(low.numerator) / low.denominator)
    return derivative


# ---- kernels against brute force

@pytest.mark.parametrize("n", (1, 2))
def test_lax_oleinik(n):
    """Against all pairs of nodes and images, and `back` says where the least came from."""
    rng = np.random.default_rng(4)
    for grid in (2, 5, 6):
        for c in ([0.0, 0.0], [0.73, -0.21], [-2.5, 7.125], [0.5, 1 / 3]):
            size = grid ** n
            W, u = rng.normal(0, 0.1, size), rng.normal(0, 0.1, size)
            out, back = np.empty(size), np.empty((size, 2), dtype=np.intc)
            c = np.array(c)
            assert library().cv_lax_oleinik(
                n, grid, address(c, "double *"), address(W, "double *"), address(u, "double *"),
                address(out, "double *"), address(back, "int(*)[2]")) == 0
            nodes = np.indices((grid,) * n).reshape(n, -1).T
            images = np.array(list(itertools.product(range(-12, 13), repeat=n)))
            for k, y in enumerate(nodes):
                step = (y - nodes[:, None] - grid * images) / grid - c[:n]
                cost = (u + W)[:, None] + (step ** 2).sum(2) / 2
                assert out[k] == pytest.approx(cost.min(), abs=1e-14)
                origin = np.ravel_multi_index((y - back[k, :n]) % grid, (grid,) * n)
                step = back[k, :n] / grid - c[:n]
                assert (u + W)[origin] + (step ** 2).sum() / 2 == pytest.approx(out[k], abs=1e-14)
                assert not back[k, n:].any()


def corridor(potential, q, p, eps, low, high, nodes, known):
    """cv_corridor: (least, low, high), of arrays (q, n)."""
    n = potential.n
    base = pairs(np.array([[(j * i) % q / q for i in p] for j in range(q)]))
    low, high = pairs(low), pairs(high)
    nodes = np.ascontiguousarray(np.column_stack(
        [nodes, np.ones((q, 2 - n))]).astype(np.intc))
    least, path = ffi.new("double *"), np.zeros((q, 2))
    assert library().cv_corridor(
        potential.native, q, eps, potential.curvature, address(base), known,
        address(nodes, "int(*)[2]"), address(low), address(high), least, address(path)) == 0
    return least[0], low[:, :n], high[:, :n]


def total(potential, q, p, eps, z):
    base = np.array([[(j * i) % q / q for i in p] for j in range(q)])
    value = potential.evaluate(base + z)[0]
    return float(((np.roll(z, -1, 0) - z) ** 2).sum() / 2 - eps * value.sum()), value


@pytest.mark.parametrize("potential", [*POTENTIALS, WAVES], ids=by)
def test_corridors_keep_what_may_be_least(potential):
    """A state of a corridor is never thrown out, nor is the least action put above its own, if its
    action is what is known and its first point is the one with the largest V."""
    rng, n, tried, shrunk = np.random.default_rng(5), potential.n, 0, 0
    while tried < 150 * TORTURE:
        q = int(rng.integers(1, 6))
        p = tuple(int(i) for i in rng.integers(-3, 4, n))
        eps = float(rng.choice([0.0, 0.01, 0.3, -0.3, 2.0]))
        wide = 10.0 ** rng.uniform(-3, 0, (q, n))
        low = rng.uniform(0, 1, n) + rng.uniform(-0.3, 0.3, (q, n)) * wide.max() - wide / 2
        nodes = rng.integers(2, 9, (q, n))
        cell = rng.integers(0, nodes - 1)
        z = low + wide * (cell + rng.choice([0.0, 0.5, 0.5, rng.uniform()], (q, n))) / (nodes - 1)
        high = low + wide
        action, value = total(potential, q, p, eps, z)
        if (np.sign(eps) * value > np.sign(eps) * value[0]).any():
            continue
        tried += 1
        least, left, right = corridor(potential, q, p, eps, low, high, nodes, action)
        assert least <= action
        assert (left <= z).all() and (z <= right).all()
        shrunk += bool((left > low).any() or (right < high).any())
    assert shrunk > tried / 10


def test_corridors_round():
    """Orbits in corridors so narrow that only rounding could throw them out; known is their action,
    to the last bit."""
    for potential, p, q, eps in ((orbits.trig, (5, 7), 9, 0.06), (orbits.standard, (3,), 8, 1.2),
                                 (orbits.ff, (3, 4), 5, 0.06)):
        state = least_action(potential, p, q, eps, gap=1e-9).state
        _, value = total(potential, q, p, eps, state.u)
        first = int(np.argmax(value))
        z = np.roll(state.u, -first, 0) + np.array(p) * first / q
        state = orbits.PeriodicOrbit(potential, p, q, eps, z, (0.0,) * potential.n).relax(tol=1e-14)
        low, high = (number * q for number in enclosed_action(state))
        rng = np.random.default_rng(10)
        for _ in range(20):
            wide = 10.0 ** rng.uniform(-9, -8, z.shape)
            left = state.u - wide * rng.uniform(0.1, 0.9, z.shape)
            least, left, right = corridor(potential, q, p, eps, left, left + wide,
                                          np.full(z.shape, 4), (low + high) / 2)
            assert least <= high and (left <= state.u).all() and (state.u <= right).all()


def test_the_price_of_a_grid():
    """The middle of a cell at the maximum of V, and points that cannot both be on the grid: there
    each part of what rounding to the grid costs is needed."""
    for start, eps in ((np.array([[0.5]]), 0.9), (np.array([[0.5]]), 0.0)):
        low, high = start - 0.1, start + 0.1
        action, _ = total(orbits.standard, 1, (0,), eps, start)
        least, left, right = corridor(orbits.standard, 1, (0,), eps, low, high, [[2]], action)
        assert least <= action and left < 0.5 < right
    z = np.full((2, 1), 0.5)
    least, left, right = corridor(orbits.standard, 2, (0,), 0.0, np.array([[0.0], [-0.25]]),
                                  np.array([[1.0], [1.25]]), [[2], [2]], 0.0)
    assert least <= 0 and (left < z).all() and (right > z).all()


def test_corridors_against_all_paths():
    """The bound is that of the best of all paths through the nodes whose first point has the
    largest V, less the price of the grid; that they may end a little off where they began adds
    little."""
    rng, met = np.random.default_rng(6), 0
    for potential, q in itertools.product((orbits.standard, orbits.trig), (1, 2, 3)):
        n, eps, p = potential.n, 0.7, (1,) * potential.n
        for _ in range(20 * TORTURE):
            wide = rng.uniform(0.01, 0.1, (q, n))
            wide[0] = 1e-7
            low = rng.uniform(0, 1, n) + rng.uniform(-0.1, 0.1, (q, n))
            sites = [list(itertools.product(*[low[j, i] + wide[j, i] * np.arange(3) / 2
                                              for i in range(n)])) for j in range(q)]
            every = [total(potential, q, p, eps, np.array(path))
                     for path in itertools.product(*sites)]
            allowed = [action for action, value in every if (value <= value[0]).all()]
            least, *_ = corridor(potential, q, p, eps, low, low + wide, np.full((q, n), 3), 1e3)
            price = float((2 + eps * potential.curvature) * ((wide / 2) ** 2).sum() / 8)
            if allowed:
                met += 1
                assert min(a for a, _ in every) - price - 1e-6 < least
                assert least <= min(allowed) - 0.99 * price
    assert met > 40 * TORTURE


def test_least_eigenvalue():
    """Below the true one, and close; below it whatever was guessed."""
    rng = np.random.default_rng(7)
    for size in (1, 2, 9, 40, branch_and_bound.ROWS_PER_POLL + 3):
        a = rng.normal(size=(size, size))
        for matrix in (a @ a.T, a + a.T, np.eye(size)):
            true = min(mpmath.eigsy(mpmath.matrix(matrix.tolist()), eigvals_only=True))
            bound = branch_and_bound._least_eigenvalue(matrix, float(true))
            assert bound <= true
            assert bound >= true - 0.01 * abs(true) - 1e-10 * abs(matrix).max()
            for wrong in (-1.0, 0.01, 1.0, 100.0):
                assert branch_and_bound._least_eigenvalue(matrix, float(true) + wrong) <= true


def test_least_action_sees_ctrl_c_between_short_steps(monkeypatch):
    """The largest matrices are multiplied in parts: no call in between takes all of it."""
    parts = []
    monkeypatch.setattr(branch_and_bound.np, "einsum", lambda how, a, b: parts.append(len(a))
                        or np.matmul(a, b.T))
    branch_and_bound._least_eigenvalue(2.1 * np.eye(1000), 2.1)
    assert len(parts) > 20 and max(parts) <= branch_and_bound.ROWS_PER_POLL


@pytest.mark.parametrize("potential", POTENTIALS, ids=by)
def test_enclosed_action(potential):
    """Around the truth of any state, stationary or not, at the decimal that eps stands for."""
    rng, n = np.random.default_rng(8), potential.n
    v = truth(potential)
    for q in (1, 2, 7):
        state = orbits.PeriodicOrbit(potential, (3,) * n, q, 0.3, rng.normal(0, 2, (q, n)),
                             rng.uniform(-2, 2, n))
        low, high = enclosed_action(state)
        with mpmath.workdps(40):
            x = [[mpmath.mpf(state.origin[i]) + mpmath.mpf(3 * j % q) / q + float(state.u[j, i])
                  for i in range(n)] for j in range(q)]
            step = [float(state.u[(j + 1) % q, i]) - mpmath.mpf(float(state.u[j, i]))
                    for j in range(q) for i in range(n)]
            true = (mpmath.fsum(s * s / 2 for s in step)
                    - mpmath.mpf("0.3") * mpmath.fsum(v(*point) for point in x)) / q
        assert low <= true <= high and high - low < 1e-12


# ---- the least action of a type

KNOWN = [(orbits.trig, (5, 7), 9, 0.06, -0.0143010202),
         (orbits.trig, (5, 7), 9, 0.05, -0.0097823873),
         (orbits.trig, (1, 1), 1, 0.05, -0.05), (orbits.trig, (3, 4), 5, 0.08, None),
         (orbits.poly, (2, 3), 4, 0.06, None), (orbits.ff, (3, 4), 5, 0.06, None),
         (orbits.froeschle, (1, 1), 2, 0.1, None), (orbits.trig, (2, 3), 4, -0.08, None),
         (orbits.standard, (3,), 8, 1.2, None), (orbits.standard, (1,), 2, -2.0, None)]


@pytest.mark.parametrize("potential, p, q, eps, known", KNOWN, ids=by)
def test_no_state_has_less(potential, p, q, eps, known):
    """Not one of many starts, relaxed, comes out below; the bounds meet where some come out."""
    found = least_action(potential, p, q, eps, gap=1e-12)
    assert found.low <= found.high <= found.low + 2e-12
    assert found.low <= found.state.action + 1e-14 and found.state.label == "minimum"
    if known is not None:
        assert found.high == pytest.approx(known, abs=1e-10)
    rng, n, met = np.random.default_rng(9), potential.n, 0
    for _ in range(60 * TORTURE):
        start = orbits.PeriodicOrbit(potential, p, q, eps, rng.normal(0, 0.3, (q, n)),
                                     rng.uniform(0, 1, n))
        low, high = enclosed_action(start.relax())
        assert high >= found.low
        met += low <= found.high
    assert met > 0


def test_where_nothing_is_least():
    """At eps 0 all straight states are alike."""
    found = least_action(orbits.trig, (4, 6), 8, 0.0)
    assert (found.low, found.high, found.copies) == (0.0, 0.0, 2)


def test_bounds_at_any_time():
    """However soon the search ends, its bounds hold; the longer, the closer."""
    sharp = least_action(orbits.trig, (3, 4), 5, 0.08, gap=1e-13)
    last = -np.inf
    for corridors in (1, 3, 10, 30):
        found = least_action(orbits.trig, (3, 4), 5, 0.08, gap=1e-13, corridors=corridors)
        assert last <= found.low <= sharp.high and sharp.low <= found.high
        assert found.corridors <= corridors and (found.low > sharp.low - 1e-13 or found.copies == 1)
        last = found.low
    loose = least_action(orbits.trig, (3, 4), 5, 0.08, gap=1e-3)
    assert 1e-13 < loose.high - loose.low <= 1e-3 and loose.corridors < sharp.corridors


def test_copies():
    """One degree of freedom: Aubry's theorem.  Two: Hedlund's pathology, and where it is not."""
    assert least_action(orbits.standard, (6,), 15, 2.0, gap=0).copies == 3
    assert least_action(orbits.standard, (5,), 12, 2.0, gap=0).copies == 1
    twice = least_action(orbits.trig, (4, 6), 8, 0.08, gap=0)
    assert twice.copies == 2
    once = least_action(orbits.trig, (2, 3), 4, 0.08, gap=0)
    assert max(once.low, twice.low) <= min(once.high, twice.high)


def test_copies_are_not_taken_for_others():
    """A state that is nearly a copy is none."""
    once = least_action(orbits.standard, (1,), 2, 2.0, gap=0)
    search = branch_and_bound._Search(once.state.repeat(2))
    for off, copies in ((0.0, 2), (1e-3, 1)):
        state = once.state.repeat(2).moved(once.state.repeat(2).u + [[off], [0], [0], [0]])
        low, high = state.u - 2e-4, state.u + 2e-4
        assert search.copies(state, low, high, 0.5) == copies


def test_hedlund():
    """For trig the least action of (10, 14)/18 is less than twice that of (5, 7)/9."""
    short = least_action(orbits.trig, (5, 7), 9, 0.06)
    long = least_action(orbits.trig, (10, 14), 18, 0.06)
    assert short.low > long.high + 2e-5
    assert long.copies == 1 and long.high == pytest.approx(-0.0143222602, abs=1e-10)


def test_experiment(root, capsys):
    main = runpy.run_path(str(root / "experiments" / "hedlund.py"))["main"]
    main(["--eps", "0.08", "--type", "1,2,3"])
    out = capsys.readouterr().out
    assert "an orbit of type (1, 2)/3 run through 2 times" in out and out.endswith("Proved.\n")
    for arguments in (["--type", "5,7"], ["--type", "5,7,0"], ["--eps", "nan"], ["--times", "0"]):
        with pytest.raises(SystemExit) as stop:
            main(arguments + ["--eps", "0.08"][:2 * ("--eps" not in arguments)])
        message = str(stop.value)
        assert message.startswith("hedlund.py: ") and "\n" not in message


# ---- the floor

def test_floor_of_the_spiral_mean():
    """Value iteration's numbers, from elsewhere, lie between the proved and the estimate; states
    of types near it lie above."""
    for eps, known, grid in ((0.02, -0.0012623, 64), (0.04, -0.0060520, 64)):
        found = mather_beta(orbits.trig, eps, SPIRAL, grid)
        assert found.low < known + 1e-6 < found.estimate + 1e-5
        assert found.estimate - found.low < 1.2 * 2 * (1 + eps * 67.4) / (8 * grid ** 2)
        for q in (9, 16, 28):
            p = tuple(round(w * q) for w in SPIRAL)
            state = orbits.follow(orbits.trig, p, q, [eps])[-1]
            near = ((np.array(p) / q - SPIRAL) ** 2).sum() ** 0.5
            assert found.low < state.action + 0.1 * near


@pytest.mark.parametrize("potential, p, q, eps", [
    (orbits.standard, (2,), 5, 1.5), (orbits.standard, (1,), 3, -0.8),
    (orbits.trig, (1, 1), 1, 0.05), (orbits.trig, (2, 3), 4, 0.08),
    (orbits.ff, (1, 1), 2, 0.05)], ids=by)
def test_floor_below_the_least_action(potential, p, q, eps):
    """Of its own type the least state is above the proved floor; with one degree of freedom it is
    the least of all and below the grid's."""
    grid = 512 if potential.n == 1 else 64
    found = mather_beta(potential, eps, np.array(p) / q, grid)
    least = least_action(potential, p, q, eps)
    assert found.low < least.low
    price = potential.n * (1 + abs(eps) * potential.curvature) / (8 * grid ** 2)
    assert found.estimate - 1.2 * price <= found.low < found.estimate
    if potential.n == 1:
        assert least.low <= found.estimate + 1e-12 and least.low - found.low < 1.2 * price


def test_floor_holds_for_any_path():
    """Also for paths on the grid itself, whatever the rotation, and at eps 0."""
    found = mather_beta(orbits.standard, 0.0, (0.3,), 50)
    assert -1.2 / (8 * 50 ** 2) < found.low <= 0 <= found.estimate + 1e-12
    torus = mather._Torus(orbits.trig, 0.3, 16)
    c, rotation = (0.4, -0.2), np.array([0.3, 0.1])
    bound = torus.settle(c, 1e-12, 50)
    change = torus.apply(c) - torus.u
    assert bound <= change.min()
    cost, short = torus.cycle(c, rotation)
    # the same path with c instead of rotation
    step = rotation - short
    cost += ((step - c) ** 2).sum() / 2 - ((step - rotation) ** 2).sum() / 2
    assert bound <= cost + 1e-12


# ---- bad input

@pytest.mark.parametrize("call", [
    lambda: least_action(orbits.trig, (1, 1), 3, float("nan")),
    lambda: least_action(orbits.trig, (1, 1), 3, 1e9),
    lambda: least_action(orbits.trig, (1, 1), 3, None),
    lambda: least_action(orbits.trig, (1,), 3, 0.05),
    lambda: least_action(orbits.trig, (1, 0.5), 3, 0.05),
    lambda: least_action(orbits.trig, (1, 1), 0, 0.05),
    lambda: least_action(orbits.trig, (1, 1), 501, 0.05),
    lambda: least_action(orbits.trig, (1, 1), "3", 0.05),
    lambda: least_action(orbits.trig, (1, 1), 3, 0.05, gap=float("nan")),
    lambda: least_action(orbits.trig, (1, 1), 3, 0.05, corridors=0),
    lambda: least_action(orbits.trig, (1, 1), 100, 1e5),
    lambda: enclosed_action(3),
    lambda: least_action("trig", (5, 7), 9, 0.05),
    lambda: mather_beta("standard", 0.5, [0.5]),
    lambda: mather_beta(orbits.trig, float("inf"), SPIRAL),
    lambda: mather_beta(orbits.trig, 0.1, (0.5,)),
    lambda: mather_beta(orbits.trig, 0.1, 0.5),
    lambda: mather_beta(orbits.trig, 0.1, (0.5, float("nan"))),
    lambda: mather_beta(orbits.trig, 0.1, SPIRAL, 7),
    lambda: mather_beta(orbits.trig, 0.1, SPIRAL, 64.5)])
def test_bad_input(call):
    with pytest.raises(ValueError) as refusal:
        call()
    assert str(refusal.value) and "\n" not in str(refusal.value)


def test_bad_calls_of_c():
    """Too many nodes, too far out, an unknown potential: refused, not believed."""
    one = np.zeros((1, 2))
    least, path = ffi.new("double *"), np.zeros((1, 2))
    for native, wide, nodes, code in ((orbits.trig.native, 0.5, (1026, 2), -3),
                                      (orbits.trig.native, 0.5, (0, 2), -3),
                                      (orbits.trig.native, 2000.0, (3, 3), -3),
                                      (ffi.new("cv_potential *", {"kind": 3}), 0.5, (3, 3), -3),
                                      (orbits.trig.native, float("nan"), (3, 3), -4)):
        low, high = one - wide, one + wide
        assert library().cv_corridor(
            native, 1, 0.1, 70.0, address(one), 0.0, ffi.new("int[1][2]", [nodes]), address(low),
            address(high), least, address(path)) == code


def test_the_arithmetic_is_looked_at():
    """Rounded upwards, doubles bound nothing."""
    libm, upward = ctypes.CDLL(None), {"x86_64": 0x800, "aarch64": 0x400000}.get(platform.machine())
    if upward is None or not hasattr(libm, "fesetround"):
        pytest.skip("no way to change the rounding here")
    state = orbits.straight(orbits.trig, (5, 7), 9).relax(0.05)
    before = libm.fegetround()
    try:
        libm.fesetround(upward)
        with pytest.raises(ConverseError, match="floating-point"):
            enclosed_action(state)
    finally:
        libm.fesetround(before)
    low, high = enclosed_action(state)
    assert low <= state.action <= high


# ---- experiments/minimizing.py

def test_minimizing(root, tmp_path):
    name = str(root / "experiments" / "minimizing.py")
    code = ("import sys; sys.argv = ['minimizing.py', %r, '--quick']; sys.path.insert(0, %r);"
            "import minimizing as m;"
            "m.POTENTIALS, m.TYPES = m.POTENTIALS[:1], m.TYPES[:2]; m.QUICK_EPS = [0.01, 0.04];"
            "m.main()" % (str(tmp_path / "new"), os.path.dirname(name)))
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                         timeout=PATIENCE)
    assert run.returncode == 0 and not run.stderr
    with open(tmp_path / "new" / "minimizing.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 and [row["eps"] for row in rows] == ["0.01", "0.04"] * 2
    assert [float(row["gain"]) > 1e-6 for row in rows] == [False, True] * 2
    assert all(float(row["floor"]) < float(row["best"]) for row in rows[2:])
    assert b"<svg" in (tmp_path / "new" / "minimizing.svg").read_bytes()


def test_errors_of_minimizing(root, tmp_path):
    (tmp_path / "file").write_text("")
    run = subprocess.run([sys.executable, str(root / "experiments" / "minimizing.py"),
                          str(tmp_path / "file")], capture_output=True, text=True, timeout=PATIENCE)
    assert run.returncode == 1 and run.stderr.count("\n") == 1
    assert run.stderr.startswith("minimizing.py: ")
