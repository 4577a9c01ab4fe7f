"""Refinement of a torus: Newton's method, its error computed with as many digits as the theorem
asks for, by the midpoints of ball arithmetic; and how many modes and digits these are.

Balls are slow, so the error is computed in them once, or twice: what a correction changes in it is
known to as many digits in floating-point numbers (Mesh.change).

The coefficients may be polynomials in sigma, the variable of a range of amplitudes.  They are then
corrected at points of the circle |sigma| = 1, from where Cauchy's formula, a Fourier transform,
leads back to the polynomials.
"""

from fractions import Fraction
from itertools import repeat
from math import ceil, exp, inf, log2
from typing import Callable, Iterator, NamedTuple, Optional, Tuple

import numpy as np

from ..model.exact import Ends
from ..model.potential import FourierSum
from .continuation import Found
from .divisors import Norm
from .newton import Mesh, inverted
from .residual import Grid, residual
from .rotation import Rotation
from .torus import NO_RANGE, Part, Torus

MARGIN = 100.0              # of the theorem's inequality, that is aimed at
TURNS = 5                   # in balls
STEPS = 8                   # of Newton's method in each of them
SPARE_BITS = 8              # of the balls, beyond those of the coefficients
EDGE = 1.13                 # the error is computed for so many times the largest |k| of the plan
ROOM = 0.9                  # a part of that is taken by the torus, from which the rest is left out


class Plan(NamedTuple):
    """norm -- of modes, that of the theorem; alpha -- |k| = sum of alpha_i |m_i| on a mesh
    size -- of the largest k that matters
    rho, needed -- the width of the strip, and about the largest ||E||_rho that the theorem takes
    rate -- at which coefficients decay with |k|"""

    norm: Norm
    alpha: np.ndarray
    size: float
    rho: float
    needed: float
    rate: float

    def length(self, mesh: Mesh) -> np.ndarray:
        """|k| of the modes of a mesh."""
        return _length(mesh, self.alpha)

    def mesh(self, like: Mesh, real: bool = True) -> Mesh:
        """One on which products of the modes that are kept have room."""
        return Mesh.holding(like.potential, like.rotation, like.frame,
                            [EDGE * self.size / a for a in self.alpha], real)

    def keep(self, mesh: Mesh) -> np.ndarray:
        """The modes of a mesh that a torus may have."""
        reach = float((self.alpha * mesh.half).min())
        return mesh.inside & (self.length(mesh) <= ROOM * reach) & (abs(mesh.k).max(0) > 0)


def plan(found: Found, margin: float = MARGIN, more: float = 1.0) -> Plan:
    """How many modes the theorem needs, and the width of the strip: the fewest for which the
    coefficients beyond them, by their decay, are `margin` times smaller than the theorem needs;
    then `more` times as many in each direction."""
    mesh, u = found.mesh, found.u.astype(complex)
    tau = mesh.potential.dimension
    weights = np.ones(tau)
    if len(mesh.sizes) == len(weights):
        alpha = weights = np.maximum(1, np.rint(found.rates / found.rates.min()))
    else:                                       # all modes are multiples of one vector
        alpha = np.array([abs(np.array(mesh.frame) @ mesh.basis[0]).sum()])
    rate = float((found.rates / alpha).min())
    length = _length(mesh, alpha)
    size = abs(u).max(0)
    # exp of a large number is only asked for where the coefficient is known to be small
    largest = float((size * np.exp(np.minimum(rate * length, 600)))[found.seen].max(initial=1e-3))
    density = (2 if len(alpha) == 1 else 4) / float(alpha.prod())   # of modes near |k| <= 1
    K = (4 * tau + 1) / (0.9 * rate)
    theorem = _Needed(found, alpha)
    while True:
        rho = (4 * tau + 1) / K
        x = rate - rho
        tail = density * largest * exp(-x * K) * (1 / x if len(alpha) == 1
                                                  else K / x + 1 / x ** 2)
        needed = theorem.at(rho)
        if tail <= needed / margin:
            break
        K *= 1.05
    norm = Norm(mesh.frame, tuple(Fraction(int(a)) for a in weights))
    if more > 1:
        needed = theorem.at(rho / more)
    return Plan(norm, alpha, K * more, rho / more, needed, rate)


def _length(mesh, alpha):
    return sum(a * abs(m) for a, m in zip(alpha, mesh.m))


class _Needed:
    """About the largest ||E||_rho for which the theorem holds (docs/existence.md): from norms in
    doubles, the divisors of the mesh, and the loss in 4 + 2 s parts with s = 0.3."""

    def __init__(self, found: Found, alpha: np.ndarray) -> None:
        self.mesh, self.alpha = found.mesh, alpha
        mesh = found.mesh
        at, _ = mesh.positive(found.keep)
        self.length = _length(mesh, alpha).ravel()[at]
        self.divisors = abs(mesh.back).ravel()[at]

        def sizes(coefficients):
            components = tuple(range(coefficients.ndim - len(mesh.sizes)))
            size = np.sqrt((abs(coefficients) ** 2).sum(components)).ravel()
            return float(size[0]), size[at]

        L, A, du = mesh.frames(found.u)
        self.du, self.m, self.a = (sizes(x) for x in (
            du, *(mesh.coefficients(inverted(x)) for x in (L, A))))
        self.waves = [(float(abs(p)) * float(np.dot(k, k)) ** 1.5, sizes(np.tensordot(
            np.array(k), found.u, 1)[None])) for k, p in zip(mesh.vectors, found.amplitude)]

    def at(self, rho: float) -> float:
        weight, tau = np.exp(np.minimum(self.length * rho, 200)), self.mesh.potential.dimension

        def norm(sizes):
            return sizes[0] + 2 * float(weight @ sizes[1])

        l, m, a = 1 + norm(self.du), norm(self.m), norm(self.a)
        delta = rho / 4.6
        c = float((np.exp(-delta * self.length) / self.divisors).max())
        d = 1 / (delta * exp(1) * self.alpha.min())
        T = sum(size * exp(min(50, norm(phase))) for size, phase in self.waves)
        h = 1.1
        G = a * h * c ** 2 * l * ((2 * m * l * d if tau > 1 else 0) + d / 2
                                  + T / 2 * a * h * c ** 2 * l ** 3)
        return float(2.0 ** (-4 * tau) / G)


class Digits:
    """The coefficients of a torus with many digits, as integers times 2^-bits, on a mesh: a complex
    one if there is a parameter.

    k -- the modes of `keep`, one of each k and -k, integers (n, modes)"""

    def __init__(self, mesh: Mesh, keep: np.ndarray, bits: int, degree: int = 0) -> None:
        self.mesh, self.keep, self.bits, self.degree = mesh, keep, bits, degree
        self.at, self.plain = mesh.positive(keep)
        k = mesh.k.reshape(len(mesh.k), -1)[:, self.at]
        self.k = np.where(self.plain, k, -k)
        self.parts = np.zeros((2, degree + 1, len(k), len(self.at)), object)    # re, im
        if not mesh.real:
            place, _ = mesh.index(-self.k)
            self.negative = np.ravel_multi_index(place, mesh.sizes)

    def add(self, c: np.ndarray) -> None:
        """Adds coefficients (degree + 1, n, modes)."""
        for part in (c.astype(complex), (c - c.astype(complex)).astype(complex)):
            for mine, other in zip(self.parts, (part.real, part.imag)):
                flat = [int(x) for x in (other * 2.0 ** self.bits).ravel().tolist()]
                mine += np.array(flat, object).reshape(mine.shape)

    def take(self, other: "Digits") -> None:
        """Takes the coefficients of another one, of the modes that both have."""
        shape = other.mesh.k.shape[1:]
        numbers = np.full(other.mesh.k[0].size, -1)
        numbers[other.at] = np.arange(len(other.at))
        found = np.full(len(self.at), -1)
        for sign in (1, -1):                        # one of k and -k is there
            place, ok = other.mesh.index(sign * self.k)
            there = numbers[np.ravel_multi_index(place, shape)]
            found = np.maximum(found, np.where(ok, there, -1))
        unit = self.bits - other.bits
        taken = other.parts[..., found[found >= 0]]
        self.parts[..., found >= 0] = taken << unit if unit > 0 else taken >> -unit

    def doubles(self) -> np.ndarray:
        """The coefficients (degree + 1, n, modes)."""
        unit = 1 << self.bits
        re, im = (np.array([x / unit for x in part.ravel().tolist()]).reshape(part.shape)
                  for part in self.parts)
        return re + 1j * im

    def picked(self, u: np.ndarray) -> np.ndarray:
        """From coefficients on a real mesh: those at k, (n, modes)."""
        u = u.reshape(len(u), -1)[:, self.at]
        return np.where(self.plain, u, u.conj())

    # ---- the circle |sigma| = 1.  u is real for real sigma: at the conjugate of sigma the mode k
    # has the conjugate of the coefficient that -k has at sigma.  So half of the circle will do.

    def on_circle(self, c: np.ndarray, layers: int) -> Iterator[np.ndarray]:
        """The sums of c_j sigma^j, c of shape (degree + 1, n, modes), on the mesh, at
        sigma = e^{2 pi i l/layers} for l = 0, ..., layers/2; of degree 0 on a real mesh."""
        if self.mesh.real:
            yield self.mesh.spread(self.k, c[0])
            return
        both = [np.fft.ifft(each, layers, axis=0, norm="forward") for each in (c, c.conj())]
        for at_k, at_minus_k in list(zip(*both))[:layers // 2 + 1]:
            u = np.zeros((len(self.k), self.mesh.points), at_k.dtype)
            u[:, self.at], u[:, self.negative] = at_k, at_minus_k
            yield u.reshape(len(u), *self.mesh.sizes)

    def series(self, circle: Iterator[np.ndarray], layers: int) -> np.ndarray:
        """The opposite: c_j for j = 0, ..., layers - 1."""
        if self.mesh.real:
            return np.array([self.picked(u) for u in circle])
        at_k, conjugate = [], []
        for u in circle:
            u = u.reshape(len(u), -1)
            at_k.append(u[:, self.at])
            conjugate.append(u[:, self.negative].conj())
        return np.fft.fft(np.array(at_k + conjugate[-2:0:-1]), axis=0, norm="forward")

    def prune(self, plan: Plan, potential: FourierSum, part: Part, most: float) -> float:
        """Leaves out the coefficients that matter least, as many as make up `most` of ||E||_rho;
        returns about what they make up.  |E'(u) v| is less than 4 + sum |p_j| |k_j|^2 times |v|."""
        slope = 4.0
        for j, k in enumerate(self.mesh.vectors):
            p = abs(potential.amplitude[j]) + (0 if part is None else abs(part[j]))
            slope += float(p) * float(np.dot(k, k))
        length = plan.length(self.mesh).ravel()[self.at]
        c = np.sqrt((abs(self.doubles()) ** 2).sum(1)).sum(0)
        cost = 2 * slope * c * np.exp(plan.rho * length)
        order = np.argsort(cost, kind="stable")
        total = np.cumsum(cost[order])
        count = int(np.searchsorted(total, most))
        self.parts[..., order[:count]] = 0
        return float(total[count - 1]) if count else 0.0

    def torus(self, potential: FourierSum, part: Part, rotation: Rotation,
              piece: Ends = NO_RANGE) -> Torus:
        numbers = self.parts.transpose(3, 1, 2, 0).reshape(len(self.at), self.degree + 1, -1)
        order, modes = np.lexsort(self.k[::-1]), {}
        for k, series in zip(map(tuple, self.k.T[order].tolist()), map(list, numbers[order])):
            while series and not any(series[-1]):
                series.pop()
            if series:
                modes[k] = tuple(tuple(each) for each in series)
        return Torus(potential, part, rotation, self.bits, modes, piece)


def refined(digits: Digits, plan: Plan, potential: FourierSum, part: Part, rotation: Rotation,
            amplitude: Callable[[complex], np.ndarray], margin: float,
            piece: Ends = NO_RANGE) -> Tuple[Torus, float]:
    """The torus after as many corrections as help; about ||E||_rho over what the theorem needs.

    amplitude(sigma) -- of each wave"""
    mesh, before = digits.mesh, inf
    layers = 1 if part is None else layers_for(digits.degree)
    amplitudes = [amplitude(np.exp(2j * np.pi * l / layers) if layers > 1 else 0)
                  for l in range(layers // 2 + 1)]
    shape = mesh.sizes[-2] if len(mesh.sizes) == 2 else 1, mesh.sizes[-1]
    grid = Grid(plan.norm, mesh.vectors, shape, layers)
    reach = float(grid.reach)
    length = plan.length(mesh)
    weights = np.where(length < reach, np.exp(np.minimum(plan.rho * length, 600)), 0)
    enough = plan.needed / 2 / margin
    for _ in range(TURNS):
        result = residual(digits.torus(potential, part, rotation, piece), grid,
                          max(64, digits.bits + SPARE_BITS))
        place, ok = mesh.index(result.k.T)
        spot = (slice(None), *(x[ok] for x in place))
        error = np.zeros((layers, len(mesh.k), *mesh.k.shape[1:]), complex)
        for j in range(layers):
            error[j][spot] = result.values[ok, :, j].T
        error = np.fft.ifft(error, axis=0, norm="forward")[:layers // 2 + 1]
        v, size, rest = _corrected(digits, error, weights, amplitudes, layers, enough)
        if v is not None:
            digits.add(v)
        if size - rest <= enough or not size < before / 4:
            break
        before = size
    size += digits.prune(plan, potential, part, enough / 4)
    return digits.torus(potential, part, rotation, piece), size / plan.needed


class _Left(NamedTuple):
    """v -- a correction of u, None for none
    size -- about the norm of E(u + v), of which `rest` is of modes and powers of sigma that the
        torus cannot have"""

    v: Optional[np.ndarray]
    size: float
    rest: float


def _corrected(digits, error, weights, amplitudes, layers, enough):
    """What several steps of Newton's method lead to, given E(u) as Digits.on_circle gives
    functions: the correction is so small that doubles will do.  In norms modes are counted with
    their weights, e^{rho |k|}; of the circle the largest norm is taken."""
    mesh, u, best = digits.mesh, digits.doubles(), _Left(None, inf, 0.0)
    weights = weights * (2 if mesh.real else 1)         # which has one of k and -k, about
    rest = weights * ~digits.keep
    v = None
    for _ in range(STEPS):
        errors, norms = [], []
        steps = repeat(None) if v is None else digits.on_circle(v, layers)
        for at, step, e, p in zip(digits.on_circle(u, layers), steps, error, amplitudes):
            if step is not None:
                change = mesh.change(at.astype(step.dtype), step, p)
                e = (e + change * (weights > 0)).astype(complex)
            size = np.sqrt((abs(e) ** 2).sum(0))
            norms.append((float((size * weights).sum()), float((size * rest).sum())))
            errors.append(e)
        size, beyond = max(norms)
        if layers > 1:
            powers = digits.series(iter(errors), layers)[digits.degree + 1:]
            beyond += 2 * float(np.sqrt((abs(powers) ** 2).sum(1)).sum(0)
                                @ weights.ravel()[digits.at])
        found = _Left(v, size, beyond)
        if not found.size < best.size:
            break
        stalled, best = found.size > best.size / 2, found
        if stalled or found.size - found.rest <= enough / 2:
            break
        now = digits.on_circle(u if v is None else (u + v).astype(complex), layers)
        more = digits.series((mesh.correction(at, e) for at, e in zip(now, errors)),
                             layers)[:digits.degree + 1]
        v = more.astype(np.clongdouble) if v is None else v + more
    return best


def layers_for(degree: int) -> int:
    """How many points of the circle |sigma| = 1 are taken: a power of two, so large that some
    powers beyond the degree do not stand in the place of lower ones."""
    return 1 << (degree + max(2, degree // 4) - 1).bit_length()


def digits_for(plan: Plan, like: Mesh, margin: float, degree: Optional[int] = None) -> Digits:
    """Room for the coefficients that the plan asks for, with so many bits that what is cut off them
    makes up less than needed/margin/16 of ||E||_rho."""
    mesh = plan.mesh(like, real=degree is None)
    keep = plan.keep(mesh)
    degree = degree or 0
    weights = (degree + 1) * np.exp(np.minimum(plan.rho * plan.length(mesh)[keep], 600))
    bits = ceil(log2(margin / plan.needed) + log2(max(float(weights.sum()), 1)) + 8)
    return Digits(mesh, keep, bits, degree)
