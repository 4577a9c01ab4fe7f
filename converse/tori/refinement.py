"""Refinement of a torus: Newton's method, its error computed with as many digits as the theorem
asks for (converse/tori/precise.py).

That is slow, so the error is computed once, or twice: the change by a correction is known to as
many digits in doubles (Mesh.change).

The coefficients may be polynomials in sigma, the variable of a range of amplitudes.  They are then
corrected at points of the circle |sigma| = 1, from where Cauchy's formula, a Fourier transform,
leads back to the polynomials.
"""

from dataclasses import replace
from itertools import repeat
from math import inf
from typing import Iterator, NamedTuple, Optional, Tuple

import numpy as np

from .newton import Mesh
from .plan import Plan
from .precise import errors
from .torus import Torus

TURNS = 5                   # The error is computed with many digits at most TURNS times.
STEPS = 8                   # Newton's method then takes at most these steps.
SPARE_BITS = 8              # The error has these bits more than the coefficients.
# An error of LACKING/margin of the admissible one will do, if it is at most SURE of it.
LACKING, SURE = 4.0, 0.05


class Modes:
    """The modes of a mesh that a torus has, as Torus.k has them: of k and -k one, in lexicographic
    order.

    k -- integers (n, modes)"""

    def __init__(self, mesh: Mesh, keep: np.ndarray) -> None:
        self.mesh, self.keep = mesh, keep
        at, plain = mesh.positive(keep)
        k = mesh.k.reshape(len(mesh.k), -1)[:, at]
        k = np.where(plain, k, -k)
        order = np.lexsort(k[::-1])
        self.k, self.at, self.plain = k[:, order], at[order], plain[order]
        if not mesh.real:
            place, _ = mesh.index(-self.k)
            self.negative = np.ravel_multi_index(place, mesh.sizes)

    def picked(self, u: np.ndarray) -> np.ndarray:
        """From coefficients on a real mesh: those at k, (n, modes)."""
        u = u.reshape(len(u), -1)[:, self.at]
        return np.where(self.plain, u, u.conj())

    # The circle |sigma| = 1.  u is real for real sigma: at the conjugate of sigma the mode k has
    # the conjugate of the coefficient that -k has at sigma.  So half of the circle will do.

    def on_circle(self, c: np.ndarray, layers: int) -> Iterator[np.ndarray]:
        """The sums of c_j sigma^j on the mesh, at sigma = e^{2 pi i l/layers} for l = 0, ...,
        layers/2.  c has the shape (degree + 1, n, modes); on a real mesh the degree is 0."""
        if self.mesh.real:
            yield self.mesh.spread(self.k, c[0])
            return
        both = [np.fft.ifft(each, layers, axis=0, norm="forward") for each in (c, c.conj())]
        for at_k, at_minus_k in list(zip(*both))[:layers // 2 + 1]:
            u = np.zeros((len(self.k), self.mesh.points), complex)
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


def numbers_of(c: np.ndarray, bits: int) -> np.ndarray:
    """Coefficients (degree + 1, n, modes) as Torus.numbers has them."""
    found = np.zeros((2, *c.shape), object)
    for mine, part in zip(found, (c.real, c.imag)):
        mine[...] = np.array([int(x) for x in (part * 2.0 ** bits).ravel().tolist()],
                             object).reshape(part.shape)
    return found


def taken(modes: Modes, bits: int, other: Torus) -> np.ndarray:
    """Torus.numbers of these modes: of those that another torus has its own, otherwise 0."""
    found = np.zeros((*other.numbers.shape[:3], modes.k.shape[1]), object)
    key, other_key = (k[0] * (1 << 32) + k[-1] for k in (modes.k, other.k.T))
    _, mine, its = np.intersect1d(key, other_key, assume_unique=True, return_indices=True)
    shift = bits - other.bits
    given = other.numbers[..., its]
    found[..., mine] = given << shift if shift > 0 else given >> -shift
    return found


def pruned(torus: Torus, plan: Plan, most: float) -> Tuple[Torus, float]:
    """Without the modes that matter least, as many as make up `most` of ||E||_rho; and about what
    they make up.  |E'(u) v| is less than 4 + sum |p_j| |k_j|^2 times |v|."""
    slope = 4.0
    for (k0, k1, _), (c, d) in zip(torus.potential.waves, torus.amplitudes):
        slope += float(abs(c) + abs(d)) * (k0 ** 2 + k1 ** 2)
    size = np.sqrt((abs(torus.doubles) ** 2).sum(1)).sum(0)
    cost = 2 * slope * size * np.exp(plan.rho * plan.length(torus.k.T))
    order = np.argsort(cost, kind="stable")
    total = np.cumsum(cost[order])
    count = int(np.searchsorted(total, most))
    kept = np.sort(order[count:])
    kept = kept[torus.numbers[..., kept].astype(bool).any((0, 1, 2))]
    return replace(torus, k=torus.k[kept], numbers=torus.numbers[..., kept]), \
        float(total[count - 1]) if count else 0.0


def accepted(margin: float) -> float:
    """The part of the admissible error that the error of a torus may be."""
    return max(1 / margin, min(LACKING / margin, SURE))


def refined(torus: Torus, modes: Modes, plan: Plan, margin: float,
            last: bool = True) -> Tuple[Torus, float]:
    """The torus after as many corrections as help, and about ||E||_rho over the norm needed.

    last -- if not, a torus that needs more modes is not corrected further"""
    mesh, before = modes.mesh, inf
    layers = 1 if mesh.real else layers_for(torus.degree)
    amplitude = np.array(torus.amplitudes, float)
    amplitudes = [amplitude[:, 0] + amplitude[:, 1] * np.exp(2j * np.pi * l / layers)
                  if layers > 1 else amplitude[:, 0] for l in range(layers // 2 + 1)]
    length = plan.length(mesh.k)
    weights = np.where(mesh.inside & (length < plan.reach(mesh)),
                       np.exp(np.minimum(plan.rho * length, 600)), 0)
    enough = plan.needed / 2 / margin
    for _ in range(TURNS):
        error = list(errors(mesh, torus, layers, weights > 0, max(64, torus.bits + SPARE_BITS)))
        v, size, rest = _corrected(torus, modes, error, weights, amplitudes, layers, enough)
        if v is None:                   # the error of the same torus would be the same
            break
        torus = replace(torus, numbers=torus.numbers + numbers_of(v, torus.bits))
        most = accepted(margin) * plan.needed
        if size - rest <= enough or size <= most or not size < before / 4 \
                or rest > most and not last:
            break
        before = size
    torus, more = pruned(torus, plan, enough / 4)
    return torus, (size + more) / plan.needed


class _Left(NamedTuple):
    """v -- a correction of u, None for none.
    size -- about the norm of E(u + v).
    rest -- its part in modes and powers of sigma that the torus cannot have."""

    v: Optional[np.ndarray]
    size: float
    rest: float


def _corrected(torus, modes, error, weights, amplitudes, layers, enough):
    """Takes several steps of Newton's method, given E(u) as `errors` gives it.  The correction is
    so small that doubles will do.  In norms modes are counted with their weights e^{rho |k|}; on
    the circle the largest norm is taken."""
    mesh, u, best = modes.mesh, torus.doubles, _Left(None, inf, 0.0)
    weights = weights * (2 if mesh.real else 1)         # which has one of k and -k, about
    rest = weights * ~modes.keep
    v = None
    for _ in range(STEPS):
        now, norms = [], []
        steps = repeat(None) if v is None else modes.on_circle(v, layers)
        for at, step, e, p in zip(modes.on_circle(u, layers), steps, error, amplitudes):
            if step is not None:
                e = e + mesh.change(at, step, p) * (weights > 0)
            size = np.sqrt((abs(e) ** 2).sum(0))
            norms.append((float((size * weights).sum()), float((size * rest).sum())))
            now.append(e)
        size, beyond = max(norms)
        if layers > 1:
            powers = modes.series(iter(now), layers)[torus.degree + 1:]
            beyond += 2 * float(np.sqrt((abs(powers) ** 2).sum(1)).sum(0)
                                @ weights.ravel()[modes.at])
        found = _Left(v, size, beyond)
        if not found.size < best.size:
            break
        stalled, best = found.size > best.size / 2, found
        if stalled or found.size - found.rest <= enough / 2:
            break
        places = modes.on_circle(u if v is None else u + v, layers)
        more = modes.series((mesh.correction(at, e) for at, e in zip(places, now)),
                            layers)[:torus.degree + 1]
        v = more if v is None else v + more
    return best


def layers_for(degree: int) -> int:
    """How many points of the circle |sigma| = 1 are taken: a power of two, so large that some
    powers beyond the degree do not stand in the place of lower ones."""
    return 1 << (degree + max(2, degree // 4) - 1).bit_length()
