"""docs/proofs/existence.md against brute force: functions are their values on fine grids of
doubles, and each identity, bound and constant of the page is compared with what it is about.
Numbers in parentheses are the page's."""

import dataclasses
import itertools
import math
from functools import lru_cache
from typing import List, NamedTuple, Tuple

import numpy as np
import pytest

from converse import Problem
from converse.model.map import SymplecticMap
from converse.tori import NotProved, find, prove, read_rotation

GOLDEN = (math.sqrt(5) - 1) / 2
SPIRAL = 1.3247179572447460             # t^3 = t + 1
SEVEN = 2 * math.cos(2 * math.pi / 7)
NOISE = 1e-15                           # of a Fourier coefficient


class Case(NamedTuple):
    """A map, a rotation vector, a norm of modes, and a grid of N points along each angle."""

    waves: Tuple[Tuple[Tuple[int, ...], float, float], ...]      # k, amplitude, phase
    omega: Tuple[float, ...]
    basis: Tuple[Tuple[int, ...], ...]                           # of K
    frame: Tuple[Tuple[int, ...], ...] = ((1,),)
    alpha: Tuple[float, ...] = (1.0,)
    N: int = 128


CASES = {
    "standard": Case((((1,), .5, 0),), (GOLDEN,), ((1,),)),
    "two harmonics": Case((((2,), .05, .7), ((4,), .005, -.3)), (math.sqrt(2) - 1,), ((2,),),
                          ((2,),), (.7,)),
    "a sublattice": Case((((1, 1), .05, .2), ((1, -1), .04, 0)), (SEVEN - 1, SEVEN ** 2 - 1),
                         ((1, 1), (1, -1)), ((1, 1), (1, -1)), (1, 2), 64),
    "two angles": Case((((1, 0), .06, 0), ((0, 1), .04, .4), ((1, 1), .02, -.3)),
                       (SPIRAL - 1, SPIRAL ** 2 - 1), ((1, 0), (0, 1)), ((1, 0), (0, 1)), (1, 1.5),
                       64),
    "a line": Case((((1, 1), .03, .5),), (SPIRAL - 1, SPIRAL ** 2 - 1), ((1, 1),), ((1, 0), (1, 1)),
                   (.6, .4), 64),
}
every_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


# ---- functions on grids: components first, then the grid

@lru_cache(maxsize=None)
def modes(case):
    """k, an array (n, N, ...)."""
    return np.array(np.meshgrid(*[np.fft.fftfreq(case.N, 1 / case.N)] * len(case.omega),
                                indexing="ij"))


@lru_cache(maxsize=None)
def size(case):
    """|k| (4)."""
    return sum(a * abs(np.tensordot(row, modes(case), 1))
               for a, row in zip(case.alpha, case.frame))


def kappa(case):
    return max(np.linalg.norm(c) / a for c, a in zip(np.linalg.inv(case.frame).T, case.alpha))


@lru_cache(maxsize=None)
def in_lattice(case):
    """Which modes are in K, not too near the grid's end."""
    allowed = np.zeros(modes(case).shape[1:], bool)
    reach = range(-case.N // 3, case.N // 3 + 1)
    for q in itertools.product(*[reach] * len(case.basis)):
        k = np.array(q) @ np.array(case.basis)
        if max(abs(k)) <= case.N // 3:
            allowed[tuple(k)] = True
    return allowed


def fft(case, f):
    axes = tuple(range(-len(case.omega), 0))
    return np.fft.fftn(f, axes=axes) / case.N ** len(axes)


def back(case, c):
    axes = tuple(range(-len(case.omega), 0))
    return np.fft.ifftn(c, axes=axes).real * case.N ** len(axes)


def lengths(case, f):
    """|f_k|_2 of each mode; what is rounding is left out."""
    c = fft(case, f)
    rank = c.ndim - len(case.omega)
    if rank == 2:
        found = np.linalg.norm(np.moveaxis(c, (0, 1), (-2, -1)), 2, axis=(-2, -1))
    else:
        found = np.sqrt((abs(c) ** 2).sum(0)) if rank else abs(c)
    return np.where(found > NOISE, found, 0)


def norm(case, f, rho):
    """(5)."""
    return float((lengths(case, f) * np.exp(rho * size(case))).sum())


def shifted(case, f, sign=1):
    phase = np.exp(2j * np.pi * sign * np.tensordot(case.omega, modes(case), 1))
    return back(case, fft(case, f) * phase)


def derivative(case, f):
    """(i, j, ...): d_j f_i."""
    return np.moveaxis(np.array([back(case, 1j * k * fft(case, f)) for k in modes(case)]), 0, 1)


def average(case, f):
    return f.mean(axis=tuple(range(-len(case.omega), 0)))


def times(a, b):
    """Of matrices, or of a matrix and a vector."""
    return np.einsum("ij...,jk...->ik..." if b.ndim == a.ndim else "ij...,j...->i...", a, b)


def inverse(a):
    return np.moveaxis(np.linalg.inv(np.moveaxis(a, (0, 1), (-2, -1))), (-2, -1), (0, 1))


def turn(a):
    """Transposed."""
    return np.swapaxes(a, 0, 1)


def constant(case, c):
    return np.asarray(c)[(...,) + (None,) * len(case.omega)]


def theta(case):
    axis = 2 * np.pi * np.arange(case.N) / case.N
    return np.array(np.meshgrid(*[axis] * len(case.omega), indexing="ij"))


def force(case, x):
    """V'."""
    return sum(-p * constant(case, k) * np.cos(np.tensordot(k, x, 1) + phase)
               for k, p, phase in case.waves)


def hessian(case, x):
    return sum(p * constant(case, np.outer(k, k)) * np.sin(np.tensordot(k, x, 1) + phase)
               for k, p, phase in case.waves)


def residual(case, u):
    """E (3)."""
    return shifted(case, u) - 2 * u + shifted(case, u, -1) + force(case, theta(case) + u)


@lru_cache(maxsize=None)
def divided(case):
    """1/(e^{ik.w} - 1); zero at k = 0 and outside of K."""
    d = np.exp(2j * np.pi * np.tensordot(case.omega, modes(case), 1)) - 1
    allowed = in_lattice(case).copy()
    allowed[(0,) * len(case.omega)] = False
    return np.where(allowed, 1 / np.where(allowed, d, 1), 0)


@lru_cache(maxsize=None)
def small_divisors(case, reach):
    """|k| and |1 - e^{ik.w}| for the k of K in a large box."""
    n = len(case.basis)
    q = np.array(np.meshgrid(*[np.arange(-reach, reach + 1)] * n)).reshape(n, -1)
    q = q[:, abs(q).any(0)]
    k = np.array(case.basis).T @ q
    far = sum(a * abs(np.array(row) @ k) for a, row in zip(case.alpha, case.frame))
    turns = np.array(case.omega) @ k
    return far, 2 * np.sin(np.pi * abs(turns - np.round(turns)))


def c_of(case, delta, reach=200):
    """(8)."""
    far, low = small_divisors(case, reach)
    return float((np.exp(-delta * far) / low).max())


def some_u(case, rng, amount):
    """A random real function with modes in K that decrease."""
    c = rng.normal(size=(len(case.omega), *[case.N] * len(case.omega))) * amount
    c = fft(case, c) * case.N ** (len(case.omega) / 2)
    return back(case, c * np.exp(-1.5 * size(case)) * in_lattice(case))


class Step:
    """One step (20), with all that is in it."""

    def __init__(self, case, u):
        self.E = residual(case, u)
        self.DE = derivative(case, self.E)
        self.L = constant(case, np.eye(len(case.omega))) + derivative(case, u)
        self.A = times(turn(shifted(case, self.L, -1)), self.L)
        self.W = self.A - turn(self.A)
        self.inverse = inverse(self.A)
        self.mean = np.linalg.inv(average(case, self.inverse))
        divide = divided(case)
        self.g = back(case, fft(case, times(turn(self.L), self.E)) * divide)
        C = self.mean @ average(case, times(self.inverse, self.g))
        self.y = times(self.inverse, constant(case, C) - self.g)         # nabla z
        self.z = shifted(case, back(case, fft(case, self.y) * divide))
        self.v = times(self.L, self.z)

    def numbers(self, case, rho):
        """e, l, m, a, b, p of section 5, and the g_j (11)."""
        each = lengths(case, self.inverse)
        each[(0,) * len(case.omega)] = 0
        return (norm(case, self.E, rho), norm(case, self.L, rho),
                norm(case, inverse(self.L), rho), norm(case, self.inverse, rho),
                np.linalg.norm(self.mean, 2), each.max())


def weights(case, u, rho):
    """g_j of (11)."""
    return [math.exp(rho * sum(a * abs(np.dot(row, k)) for a, row in zip(case.alpha, case.frame))
                     + norm(case, np.tensordot(k, u, 1), rho)) for k, _, _ in case.waves]


# ---- section 4

@every_case
def test_the_identities(case):
    """Lemmas 1 to 3, for any u and z."""
    rng = np.random.default_rng(1)
    u, z = some_u(case, rng, .05), some_u(case, rng, 1)
    step = Step(case, u)
    assert norm(case, step.E, 0) > .01
    small = 1e-10
    assert abs(average(case, times(turn(step.L), step.E))).max() < small
    assert abs(average(case, step.W)).max() < small
    curl = times(turn(step.L), step.DE)
    assert abs(shifted(case, step.W) - step.W - curl + turn(curl)).max() < small
    if len(case.omega) == 2 and case.waves[0][2] != .5:
        assert abs(step.W).max() > 1e-4     # they say something
    v = times(step.L, z)
    change = shifted(case, v) - 2 * v + shifted(case, v, -1) + times(
        hessian(case, theta(case) + u), v)
    nabla = z - shifted(case, z, -1)
    flux = times(step.A, nabla)
    right = shifted(case, flux) - flux + times(step.W, nabla) + times(turn(step.L),
                                                                      times(step.DE, z))
    assert abs(times(turn(step.L), change) - right).max() < 1e-8


# ---- section 2

@every_case
def test_norms_divisors_and_derivatives(case):
    """(4), (6), (7), (9): for random functions; (7) and (9) are nearly attained by single modes."""
    rng = np.random.default_rng(2)
    k = modes(case)
    assert (np.linalg.norm(k, axis=0) <= kappa(case) * size(case) * (1 + 1e-12)).all()
    f, g = (some_u(case, rng, 1) for _ in range(2))
    Df = derivative(case, f)
    for rho, delta in ((.2, .05), (.3, .2)):
        assert norm(case, times(Df, g), rho) <= norm(case, Df, rho) * norm(case, g, rho)
        assert norm(case, Df, rho - delta) <= kappa(case) / (math.e * delta) * norm(case, f, rho)
        solved = back(case, fft(case, f) * divided(case))
        mean = constant(case, average(case, f))
        assert abs(shifted(case, solved) - solved - f + mean).max() < 1e-10 * abs(f).max() / delta
        c = c_of(case, delta, 200)
        assert norm(case, solved, rho - delta) <= c * norm(case, f, rho)
        best = (abs(divided(case)) * np.exp(-delta * size(case))).max()
        assert c / 2 < best <= c * (1 + 1e-9)


# ---- section 5

@every_case
@pytest.mark.parametrize("amount", [.03, 1e-3, 1e-5])
def test_one_step_obeys_its_bounds(case, amount):
    """(22), (23) and what their proof says of g, nabla z and W."""
    u = some_u(case, np.random.default_rng(3), amount)
    for _ in range(2):
        step = Step(case, u)
        for rho, delta in ((.25, .1), (.12, .03)):
            e, l, m, a, b, p = step.numbers(case, rho)
            if e < 1e-9:
                continue
            c, d, h = c_of(case, delta, 100), kappa(case) / (math.e * delta), 1 + b * p
            inner = rho - 2 * delta
            assert norm(case, step.g, rho - delta) <= c * l * e
            assert norm(case, step.y, rho - delta) <= a * h * c * l * e
            assert norm(case, step.z, inner) <= a * h * c ** 2 * l * e
            v = norm(case, step.v, inner)
            assert v <= a * h * c ** 2 * l ** 2 * e
            n = len(case.omega)
            if n > 1:
                assert norm(case, step.W, inner) <= 2 * c * l * d * e
            T = sum(abs(amplitude) * np.linalg.norm(k) ** 3 * g * math.exp(np.linalg.norm(k) * v)
                    for (k, amplitude, _), g in zip(case.waves, weights(case, u, rho)))
            bracket = 2 * m * l * d * (n > 1) + d / 2 + T * a * h * c ** 2 * l ** 3 / 2
            after = residual(case, u + step.v)
            assert norm(case, after, inner) <= a * h * c ** 2 * l * bracket * e ** 2
            # The exact remainder is (21).
            x = theta(case) + u
            Q = force(case, x + step.v) - force(case, x) - times(hessian(case, x), step.v)
            rest = times(inverse(turn(step.L)), times(step.W, step.y)) + times(step.DE, step.z) + Q
            assert abs(after - rest).max() < 1e-9
        u = u + step.v


# ---- sections 3 and 6

def uniform_c(case, delta, reach=300):
    """(30)."""
    tau = len(case.omega)
    far, low = small_divisors(case, reach)
    x = delta * far
    return float((np.where(x <= tau, np.exp(-x), (tau / (math.e * x)) ** tau) / low).max())


class Iteration(NamedTuple):
    """(12) to (18): q, the sums, and e_i, v_i, delta_i of all steps up to a few beyond N."""

    q: float
    of_Dv: float
    of_v: float
    t: float
    e: List[float]
    v: List[float]
    delta: List[float]
    bounds: Tuple[float, ...]           # l, m, a, b, p


def iteration(case, u, rho, rho_inf, s, factor, N, beyond=3):
    step = Step(case, u)
    e0, l0, m0, a0, b0, p0 = step.numbers(case, rho)
    tau, n = len(case.omega), len(case.omega)
    t = factor / (l0 * m0 * a0)
    sigma = (2 * l0 + t) * t
    l, m, a = l0 + t, m0 / (1 - m0 * t), a0 / (1 - a0 * sigma)
    da = a * a0 * sigma
    b, p = b0 / (1 - b0 * da), p0 + da
    assert m0 * t < 1 and a0 * sigma < 1 and b0 * da < 1
    h = 1 + b * p
    T = sum(abs(amplitude) * np.linalg.norm(k) ** 3 * g * math.exp(np.linalg.norm(k) * t)
            for (k, amplitude, _), g in zip(case.waves, weights(case, u, rho)))
    delta = [2. ** -i * (rho - rho_inf) / (4 + 2 * s) for i in range(N + beyond + 1)]
    C = [c_of(case, delta[i]) for i in range(N)] + [uniform_c(case, delta[N])]
    K = kappa(case) / math.e
    G = [a * h * c ** 2 * l * (2 * m * l * K / d * (n > 1) + K / (2 * d)
                               + T * a * h * c ** 2 * l ** 3 / 2) for c, d in zip(C, delta)]
    e = [e0]
    for i in range(N):
        e.append(G[i] * e[i] ** 2)
    v = [a * h * c ** 2 * l ** 2 * each for c, each in zip(C, e)]
    q = 2 ** (4 * tau) * G[N] * e[N]
    of_Dv = sum(K / (s * d) * each for d, each in zip(delta[:N], v)) \
        + K / (s * delta[N]) * v[N] / (1 - 2 ** (1 - 2 * tau))
    of_v = sum(v[:N]) + v[N] / (1 - 2 ** (-2 * tau))
    for r in range(1, beyond + 1):
        e.append(e[N] * min(q, 1) ** (2 ** r - 1) * 2. ** (-4 * tau * r))
        v.append(v[N] * 2. ** (-2 * tau * r))
    return Iteration(q, of_Dv, of_v, t, e, v, delta, (l, m, a, b, p))


@every_case
@pytest.mark.parametrize("N", [0, 1, 3])
def test_newtons_method_does_as_the_theorem_says(case, N):
    """The claim of section 6, from a u about as far from a torus as the conditions admit."""
    case = case._replace(waves=tuple((k, p / 4, phase) for k, p, phase in case.waves))
    rho, rho_inf, s = .3, .02, .4
    torus = np.zeros((len(case.omega), *[case.N] * len(case.omega)))
    for _ in range(6):
        torus = torus + Step(case, torus).v
    change = some_u(case, np.random.default_rng(7), 1)
    for power in range(2, 12):
        start = torus + change * 10. ** -power
        said = iteration(case, start, rho, rho_inf, s, .1, N)
        if said.q <= 1 and said.of_Dv <= said.t and said.of_v <= said.t:
            break
    assert said.e[0] > 1e-11            # it is not rounding alone
    u, noise = start, 1e-12
    for e, v, delta in zip(said.e, said.v, said.delta):
        step = Step(case, u)
        now, l, m, a, b, p = step.numbers(case, rho)
        assert now <= e + noise
        assert all(x <= y for x, y in zip((l, m, a, b, p), said.bounds))
        assert norm(case, step.v, rho - 2 * delta) <= v + noise
        rho -= (2 + s) * delta
        assert norm(case, derivative(case, step.v), rho) <= \
            kappa(case) / (math.e * s * delta) * v + 30 * noise
        u = u + step.v
    assert rho > rho_inf and abs(residual(case, u)).max() < 1e-13
    assert norm(case, u - start, rho_inf) <= said.of_v
    assert norm(case, derivative(case, u - start), rho_inf) <= said.of_Dv
    assert norm(case, u - start, 0) > 1e-14


@pytest.mark.slow
def test_the_true_torus_is_as_near_as_is_proved():
    """A torus is cut to fewer and fewer modes, as long as it can be proved; Newton's limit, from
    zero, is within the distance of the last one.  The mean of the theorem's u, at most the
    distance, is a translation, which moves u by 1 + l0 times as much."""
    case = CASES["standard"]
    torus = find(Problem(SymplecticMap([(1, 0)], ["0.5"])), read_rotation("golden"))
    last, cut = None, .6
    while True:
        kept = torus.k[:, 0] <= cut * torus.k.max()
        torus = dataclasses.replace(torus, k=torus.k[kept], numbers=torus.numbers[..., kept])
        try:
            last, cut = prove(torus).pieces[0], .85
        except NotProved:
            break
    assert last is not None and last.distance > 1e-6
    u = np.zeros((1, case.N))
    for _ in range(6):
        u = u + Step(case, u).v
    computed = last.torus.x(theta(case).T).T - theta(case)
    off = norm(case, u - u.mean() - computed, 0)
    assert last.distance / 1e4 < off <= (2 + last.constants.l) * last.distance


# ---- section 7

@every_case
def test_the_limit_is_an_invariant_lagrangian_graph(case):
    """Section 7, on Newton's limit."""
    u = np.zeros((len(case.omega), *[case.N] * len(case.omega)))
    for _ in range(6):
        u = u + Step(case, u).v
    x = theta(case) + u
    w = constant(case, 2 * np.pi * np.array(case.omega))
    J = w + u - shifted(case, u, -1)
    next_J = J - force(case, x)
    assert abs(next_J - shifted(case, J)).max() < 1e-9
    assert abs(u + next_J - w - shifted(case, u)).max() < 1e-9      # the angles
    step = Step(case, u)
    assert abs(step.W).max() < 1e-10
    slope = times(derivative(case, J), inverse(step.L))     # of the graph J = psi(y)
    assert abs(slope - turn(slope)).max() < 1e-9
    assert np.linalg.det(np.moveaxis(step.L, (0, 1), (-2, -1))).min() > 0


# ---- section 2 and 11: inverses

@every_case
def test_inverses(case):
    """(10) and (34) to (37), with a bad and a good approximate inverse."""
    rng = np.random.default_rng(4)
    u = some_u(case, rng, .05)
    step, rho = Step(case, u), .1
    one = constant(case, np.eye(len(case.omega)))
    Y = derivative(case, some_u(case, rng, .005))
    a, y = norm(case, step.inverse, rho), norm(case, Y, rho)
    assert a * y < 1
    changed = inverse(step.A + Y)
    assert norm(case, changed, rho) <= a / (1 - a * y)
    assert norm(case, changed - step.inverse, rho) <= a * y * a / (1 - a * y)
    for cut in (2.5, 5):
        def short(f):
            return back(case, fft(case, f) * (size(case) <= cut))
        M, L = short(inverse(step.L)), short(step.L)
        big = norm(case, M, rho)
        eta = norm(case, one - times(L, M), rho) + norm(case, step.L - L, rho) * big
        if eta >= 1:
            assert cut < 5
            continue
        m0, dm = big / (1 - eta), big * eta / (1 - eta)
        assert norm(case, inverse(step.L), rho) <= m0
        assert norm(case, inverse(step.L) - M, rho) <= dm
        X = times(M, turn(shifted(case, M, -1)))
        err = dm * (m0 + big)
        assert norm(case, step.inverse - X, rho) <= err
        mean = np.linalg.norm(np.linalg.inv(average(case, X)), 2)
        assert mean * err >= 1 or np.linalg.norm(step.mean, 2) <= mean / (1 - mean * err)
