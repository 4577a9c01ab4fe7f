"""The residual and the constants of tori, against sums on fine grids in floating-point numbers."""

import itertools
import random
import tracemalloc
from fractions import Fraction as Q

import numpy as np
import pytest
from flint import acb

from converse.model.balls import precision
from converse.model.potential import FourierSum
from converse.tori.constants import Inverse
from converse.tori.divisors import Norm
from converse.tori.effort import BYTES, INVERTING
from converse.tori.residual import (Grid, Phases, coefficients, frame_modes, hermite, residual,
                                    values, wave_vectors)
from converse.tori.rotation import read_rotation
from converse.tori.torus import Torus

BITS = 50
CIRCLE = FourierSum(((2, 0, Q(0)), (4, 0, Q(1, 3))), (Q("0.4"), Q("-0.11")), 1)
THESIS = FourierSum(((1, 0, Q(0)), (0, 1, Q(0)), (1, 1, Q(0))), (Q("0.1"), Q("0.12"), Q("0.2")), 2)
MIXED = FourierSum(((1, -1, Q(1, 7)), (2, 2, Q(-3, 4)), (0, 2, Q(1))),
                   (Q("0.2"), Q("0.07"), Q("-0.05")), 2)
LINE = FourierSum(((2, -1, Q(2, 5)), (-4, 2, Q(0))), (Q("0.1"), Q("0.03")), 2)
CIRCLE_NORM = Norm(((1,),), (Q(3, 2),))
CROSS, PLAIN = Norm(((1, 1), (1, -1)), (Q(1), Q(3))), Norm(((1, 0), (0, 1)), (Q(1), Q(1, 2)))
CASES = [(CIRCLE, CIRCLE_NORM, (1, 64)), (THESIS, CROSS, (64, 16)), (MIXED, PLAIN, (32, 32)),
         (LINE, PLAIN, (1, 32))]
RHO = Q(1, 10)


def some_torus(potential, degree=0, size=0.05, seed=1, most=3):
    """A torus with a few random modes, far from invariant."""
    chance, n = random.Random(seed), potential.dimension
    part, piece = (None, (Q(0), Q(0))) if not degree else (
        tuple(p / 3 for p in potential.amplitude), (Q(-1), Q(1, 3)))
    basis = hermite([wave[:n] for wave in potential.waves])
    modes = {}
    for a in itertools.product(range(-most, most + 1), repeat=len(basis)):
        k = tuple(sum(x * row[i] for x, row in zip(a, basis)) for i in range(n))
        if k > (0,) * n and max(map(abs, k)) <= 4:
            modes[k] = tuple(
                tuple(int(chance.gauss(0, size) * 3.0 ** -sum(map(abs, k)) * 2.0 ** (BITS - 2 * j))
                      for _ in range(2 * n)) for j in range(degree + 1))
    return Torus(potential, part, read_rotation("golden" if n == 1 else "T49"), BITS, modes, piece)


class Fine:
    """Functions on a fine grid of the angles theta, and of sigma on the unit circle."""

    def __init__(self, torus, layers=1, size=64):
        self.torus, self.layers, n = torus, layers, torus.dimension
        size = self.size = 512 if n == 1 else size
        axis = 2 * np.pi * np.arange(size) / size
        self.theta = np.stack(np.meshgrid(*[axis] * n, indexing="ij"), -1)
        self.sigma = np.exp(2j * np.pi * np.arange(layers) / layers)
        self.omega = 2 * np.pi * np.array(torus.rotation.floats)
        self.modes = np.stack(np.meshgrid(*[np.fft.fftfreq(size, 1 / size).astype(int)] * n,
                                          indexing="ij"), -1)

    def u(self, shift=0.0, slope=False):
        """u(theta + shift w) or its Jacobian, shape (layers, *grid, n[, n])."""
        torus, n = self.torus, self.torus.dimension
        found = np.zeros((self.layers, *self.theta.shape) + (n,) * slope, complex)
        for k, series in torus.modes.items():
            for sign, j in itertools.product((1, -1), range(len(series))):
                c = np.array([complex(a, sign * b) for a, b in
                              zip(series[j][::2], series[j][1::2])]) / 2.0 ** torus.bits
                wave = np.exp(1j * sign * (self.theta @ np.array(k) + shift * (k @ self.omega)))
                if slope:
                    c = 1j * sign * c[:, None] * np.array(k)
                power = (self.sigma ** j).reshape((-1,) + (1,) * (n + c.ndim))
                found += power * wave.reshape((1, *wave.shape) + (1,) * c.ndim) * c
        return found

    def residual(self):
        torus, n = self.torus, self.torus.dimension
        (low, high), part = torus.piece, torus.part or [Q(0)] * len(torus.potential.waves)
        s = (float(low + high) + float(high - low) * self.sigma) / 2
        total = self.u(1) - 2 * self.u() + self.u(-1)
        x = self.theta + self.u()
        for wave, p, d in zip(torus.potential.waves, torus.potential.amplitude, part):
            k = np.array(wave[:n])
            p = (float(p) + float(d) * s).reshape((-1,) + (1,) * n)
            total -= (p * np.cos(x @ k + np.pi * float(wave[2])))[..., None] * k
        return total

    def coefficients(self, f):
        """Of modes and powers of sigma, axes 1, ..., n and 0."""
        space = np.fft.fftn(f, axes=range(1, self.torus.dimension + 1), norm="forward")
        return np.fft.fft(space, axis=0, norm="forward")

    def norm(self, f, norm, rho):
        """The norm of a vector or matrix function."""
        c = self.coefficients(f)
        length = np.sqrt((abs(c) ** 2).sum(-1)) if c.ndim == self.torus.dimension + 2 else \
            np.linalg.svd(c, compute_uv=False).max(-1)
        far = sum(float(a) * abs(self.modes @ np.array(row))
                  for a, row in zip(norm.alpha, norm.frame))
        clean = np.where(length > 1e-15, length, 0)          # the rest is rounding
        return (clean * np.exp(float(rho) * far)).sum()


@pytest.mark.parametrize("case", range(len(CASES)))
def test_grid_tells_modes_apart(case):
    potential, norm, shape = CASES[case]
    n = potential.dimension
    grid = Grid(norm, tuple(w[:n] for w in potential.waves), shape)
    q, m = grid.inside
    assert len({(a % shape[0], b % shape[1]) for a, b in q.tolist()}) == len(q)
    assert (q[::-1] == -q).all()
    # every k of the lattice with |k| < reach is there: the waves' multiples and sums
    vectors = [w[:n] for w in potential.waves]
    for a, b in itertools.product(range(-9, 10), repeat=2):
        k = tuple(a * x + b * y for x, y in zip(vectors[0], vectors[1]))
        if norm.of(k) < grid.reach:
            place, = grid.index(np.array([k])).tolist()
            assert list(grid.numbers(k)) == m[q.tolist().index(place)].tolist()
    # and the least vector that the grid takes for 0 is twice as long as it reaches
    assert 2 * grid.reach == min(norm.of(k) for k in itertools.product(range(-160, 161), repeat=n)
                                 if any(k) and _on(grid, k))


def _on(grid, k):
    try:
        q, = grid.index(np.array([k]))
    except ValueError:
        return False
    return bool(q[0] % grid.shape[0] == 0 == q[1] % grid.shape[1])


def test_modes_of_one_column_of_the_grid_are_told_apart():
    """k = (8, 8) and its negative have the same q1 modulo 16; so have (7, 7) and (-9, -9)."""
    torus = some_torus(THESIS, size=0.003)
    torus.modes.update({(8, 8): ((1 << 41, 1 << 39, -(1 << 40), 5),),
                        (7, 7): ((3, 1 << 40, 1 << 41, 1 << 38),),
                        (9, 9): ((1 << 38, -(1 << 40), 1 << 37, 7),)})
    fine, grid = Fine(torus, 1, 128), Grid(CROSS, wave_vectors(torus), (128, 16))
    q = grid.index(np.array([(8, 8)]))
    assert (grid.places(q)[:, 1] == grid.places(-q)[:, 1]).all()
    truth, found = fine.coefficients(fine.residual()), residual(torus, grid, 100)
    for k, values in zip(found.k.tolist(), found.values):
        if max(map(abs, k)) < 20:
            assert abs(values[:, 0] - truth[0, k[0] % 128, k[1] % 128]).max() < 1e-10
    rho = Q(1, 50)
    inverse = Inverse(torus, CROSS, (128, 16)).at(rho)
    exact = fine.norm(np.linalg.inv(np.eye(2) + fine.u(0, True)), CROSS, rho)
    assert exact * (1 - 1e-6) < inverse.m0 < exact * (1 + 2 * inverse.eta)
    assert inverse.eta < 0.02


def test_modes_outside_of_the_lattice_are_refused():
    torus = some_torus(CIRCLE)
    torus.modes[3,] = ((1, 1),)
    with pytest.raises(ValueError, match="not in the lattice"):
        residual(torus, Grid(CIRCLE_NORM, wave_vectors(torus), (1, 64)), 64)


@pytest.mark.parametrize("degree", [0, 2])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_residual_is_that_of_sums(case, degree):
    potential, norm, shape = CASES[case]
    torus = some_torus(potential, degree)
    layers = 16 if degree else 1
    grid = Grid(norm, wave_vectors(torus), shape, layers)
    found = residual(torus, grid, 100)
    fine = Fine(torus, layers)
    truth = fine.coefficients(fine.residual())
    for k, values in zip(found.k.tolist(), found.values):
        for j in range(layers):
            at = (j, *(x % fine.size for x in k))
            assert abs(values[:, j] - truth[at]).max() < 2e-13
    tail, wider, radius = Phases(torus, norm).best_tail(grid, RHO)
    bound = found.norm_at(RHO, tail)
    exact = fine.norm(fine.residual(), norm, RHO)
    assert exact * (1 - 1e-9) < bound < 1.1 * exact
    assert wider > RHO and (radius > 1) == bool(degree)


@pytest.mark.parametrize("points", [1, 2, 4, 8, 32, 128])
def test_a_line_of_points_is_transformed_as_a_matrix(points):
    """Of rank 1: values of a few modes, summed by hand, and back."""
    grid, chance = Grid(CIRCLE_NORM, ((2,), (4,)), (1, points)), random.Random(3)
    rows, size = grid.lines
    assert rows * size == points and rows <= size <= 2 * rows
    wanted = {q: complex(chance.gauss(0, 1), chance.gauss(0, 1)) for q in range(points)}
    places = grid.places(np.array([(0, q) for q in wanted])).tolist()
    columns = {(q1, 0): [acb(0)] * rows for q1 in range(size)}
    for (q0, q1), c in zip(places, wanted.values()):
        columns[q1, 0][q0] = acb(c)
    with precision(80):
        found = list(values(columns, grid))
        for j0, (line,) in enumerate(found):
            for j1, value in enumerate(line):
                assert complex(value) == pytest.approx(sum(
                    c * np.exp(-2j * np.pi * (q * (j0 + rows * j1) % points) / points)
                    for q, c in wanted.items()), abs=1e-12)
        back = {(q1, q0): c for q1, _, line in coefficients(iter(found), grid, range(size))
                for q0, c in enumerate(line)}
        for (q0, q1), c in zip(places, wanted.values()):
            assert abs(back[q1, q0] - c) < 1e-18 and float(back[q1, q0].abs_upper()) < 10


@pytest.mark.parametrize("case", range(len(CASES)))
def test_short_balls_enclose_what_long_ones_show(case):
    """In their radii: with 20 bits the upper bounds of all |E_k| are above what they are."""
    potential, norm, shape = CASES[case]
    torus = some_torus(potential)
    short, long = (residual(torus, Grid(norm, wave_vectors(torus), shape), bits)
                   for bits in (20, 150))
    exact = np.sqrt((abs(long.values) ** 2).sum(1))
    assert (short.sizes.size >= exact).all() and (short.sizes.size < exact + 1e-3).all()
    assert (abs(short.values - long.values) > 1e-9).any()


@pytest.mark.parametrize("what", ["residual", "inverse"])
@pytest.mark.parametrize("case", [0, 1])
def test_memory_is_what_is_said(case, what):
    """Python's own, of a grid that is full of modes; of the digits of balls above 128 bits there is
    no account here, and they are in what is said."""
    potential, norm, _ = CASES[case]
    shape = (64, 32) if potential.dimension == 2 else (1, 2048)
    waves = tuple(wave[:potential.dimension] for wave in potential.waves)
    q, m = (grid := Grid(norm, waves, shape)).inside
    modes = {tuple(k): ((1,) * 2 * potential.dimension,) for k in frame_modes(grid, m).tolist()
             if tuple(k) > (0,) * potential.dimension}
    torus = Torus(potential, None, read_rotation(("golden", "T49")[case]), 90, modes)
    tracemalloc.start()
    try:
        if what == "residual":
            residual(torus, grid, 120)
        else:
            Inverse(torus, norm, shape)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    bound = BYTES if what == "residual" else INVERTING
    assert bound / 3 < most / grid.points < bound


@pytest.mark.parametrize("case", range(len(CASES)))
def test_what_a_coarse_grid_does_not_see_is_bounded(case):
    potential, norm, shape = CASES[case]
    torus = some_torus(potential, size=0.2, most=1)
    fine = Fine(torus)
    exact = fine.norm(fine.residual(), norm, RHO)
    for shape in (1, 8), (1, 16), (8, 8), (16, 8):
        grid = Grid(norm, wave_vectors(torus), shape)
        if (shape[0] == 1) != (len(grid.basis) == 1) or not grid.within(
                grid.all_numbers(torus.vectors), grid.reach).all():
            continue
        tail, *_ = Phases(torus, norm).best_tail(grid, RHO)
        assert residual(torus, grid, 80).norm_at(RHO, tail) >= exact * (1 - 1e-9)
        unseen = abs(residual(torus, grid, 80).sizes.norm_at(RHO) - exact)
        assert unseen <= tail + 1e-9


def test_a_range_has_a_tail_in_sigma_even_if_the_torus_is_constant():
    torus = some_torus(CIRCLE, 1)
    flat = Torus(torus.potential, torus.part, torus.rotation, BITS,
                 {k: series[:1] for k, series in torus.modes.items()}, torus.piece)
    grid = Grid(CIRCLE_NORM, wave_vectors(flat), (1, 64))
    tail, *_ = Phases(flat, CIRCLE_NORM).best_tail(grid, RHO)
    assert tail > float(potential_size(flat))


def potential_size(torus):
    """What s changes in the force, at least."""
    return abs(torus.part[0]) * 2 / 3


@pytest.mark.parametrize("degree", [0, 1])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_constants_are_those_of_sums(case, degree):
    potential, norm, _ = CASES[case]
    torus = some_torus(potential, degree, size=0.03 / (2 + degree) if case == 1 else 0.1)
    shape, layers = {0: (1, 128), 1: (64, 64), 2: (64, 64), 3: (1, 128)}[case], 1
    if degree:
        shape, layers = (shape[0] // 2 or 1, shape[1] // 2), 16
    inverse = Inverse(torus, norm, shape, layers)
    found = inverse.at(RHO)
    assert found.eta < 0.02             # by which bounds are larger than the truth
    n = torus.dimension
    fine = Fine(torus, layers)
    slope = np.eye(n) + fine.u(0, True)
    back = np.eye(n) + fine.u(-1, True)
    inverted = np.linalg.inv(np.swapaxes(back, -1, -2) @ slope)
    c = np.linalg.svd(fine.coefficients(inverted), compute_uv=False).max(-1)
    sums = c.sum(0)
    sums[(0,) * n] = 0
    mean = inverted.reshape(layers, -1, n, n).mean(1)
    mean = np.fft.fft(np.linalg.inv(mean), axis=0, norm="forward")
    for bound, truth in [(found.l0, fine.norm(slope, norm, RHO)),
                         (found.m0, fine.norm(np.linalg.inv(slope), norm, RHO)),
                         (found.a0, fine.norm(inverted, norm, RHO)),
                         (found.b0, np.linalg.svd(mean, compute_uv=False).max(-1).sum()),
                         (found.p0, sums.max())]:
        assert truth * (1 - 1e-9) < bound < truth * 1.001 + 8 * found.eta


@pytest.mark.parametrize("case", range(len(CASES)))
def test_exponentials_are_bounded(case):
    potential, norm, _ = CASES[case]
    torus = some_torus(potential, size=0.2)
    fine, phases = Fine(torus), Phases(torus, norm)
    for k in phases.wave_vectors:
        f = np.exp(1j * ((fine.theta + fine.u()) @ np.array(k)))
        assert fine.norm(f[..., None], norm, RHO) < float(phases.exponential(k, RHO)) * (1 + 1e-9)
