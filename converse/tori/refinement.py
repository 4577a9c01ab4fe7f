"""Refinement of a torus: Newton's method, its error computed with as many digits as the theorem
asks for, by the midpoints of ball arithmetic; and how many modes and digits these are.

The coefficients may be polynomials in sigma, the variable of a range of amplitudes.  They are then
corrected at points of the circle |sigma| = 1, from where Cauchy's formula, a Fourier transform,
leads back to the polynomials.
"""

from fractions import Fraction
from math import ceil, exp, inf, log2
from typing import Iterator, NamedTuple, Optional, Tuple

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
TURNS = 5                   # of refinement
EDGE = 1.5                  # the error is computed for so many times the largest |k| of the torus


class Plan(NamedTuple):
    """norm -- of modes, that of the theorem; alpha -- |k| = sum of alpha_i |m_i| on a mesh
    size -- of the largest k that is kept
    rho, needed -- the width of the strip, and about the largest ||E||_rho that the theorem takes"""

    norm: Norm
    alpha: np.ndarray
    size: float
    rho: float
    needed: float

    def length(self, mesh: Mesh) -> np.ndarray:
        """|k| of the modes of a mesh."""
        return _length(mesh, self.alpha)

    def mesh(self, like: Mesh, real: bool = True) -> Mesh:
        """One on which products of the modes that are kept have room."""
        return Mesh.holding(like.potential, like.rotation, like.frame,
                            [EDGE * self.size / a for a in self.alpha], real)


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
    while True:
        rho = (4 * tau + 1) / K
        x = rate - rho
        tail = density * largest * exp(-x * K) * (1 / x if len(alpha) == 1
                                                  else K / x + 1 / x ** 2)
        needed = _needed(found, alpha, rho)
        if tail <= needed / margin:
            break
        K *= 1.05
    norm = Norm(mesh.frame, tuple(Fraction(int(a)) for a in weights))
    if more > 1:
        needed = _needed(found, alpha, rho / more)
    return Plan(norm, alpha, K * more, rho / more, needed)


def _length(mesh, alpha):
    return sum(a * abs(m) for a, m in zip(alpha, mesh.m))


def _needed(found, alpha, rho):
    """About the largest ||E||_rho for which the theorem holds (docs/existence.md): from norms in
    doubles, the divisors of the mesh, and the loss in 4 + 2 s parts with s = 0.3."""
    mesh, tau = found.mesh, found.mesh.potential.dimension
    length = _length(mesh, alpha)
    weight = np.exp(np.minimum(length * rho, 200))
    at, _ = mesh.positive(found.keep)

    def norm(coefficients):
        components = tuple(range(coefficients.ndim - len(mesh.sizes)))
        size = np.sqrt((abs(coefficients) ** 2).sum(components))
        return float(size.flat[0] + 2 * (size * weight).ravel()[at].sum())

    L, A, du = mesh.frames(found.u)
    l = 1 + norm(du)
    m, a = (norm(mesh.coefficients(inverted(x))) for x in (L, A))
    delta = rho / 4.6
    sizes = abs(mesh.back).ravel()[at]
    c = float((np.exp(-delta * length.ravel()[at]) / sizes).max())
    d = 1 / (delta * exp(1) * alpha.min())
    T = 0.0
    for k, p in zip(mesh.vectors, found.amplitude):
        growth = exp(min(50, norm(np.tensordot(np.array(k), found.u, 1)[None])))
        T += float(abs(p)) * float(np.dot(k, k)) ** 1.5 * growth
    h = 1.1
    G = a * h * c ** 2 * l * ((2 * m * l * d if tau > 1 else 0) + d / 2
                              + T / 2 * a * h * c ** 2 * l ** 3)
    return 2.0 ** (-4 * tau) / G


class Digits:
    """The coefficients of a torus with many digits, as integers times 2^-bits, on a mesh: a complex
    one if there is a parameter.

    k -- the modes, one of each k and -k, integers (n, modes)"""

    def __init__(self, mesh: Mesh, keep: np.ndarray, bits: int, degree: int = 0) -> None:
        self.mesh, self.bits, self.degree = mesh, bits, degree
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
        place = {k: i for i, k in enumerate(map(tuple, other.k.T.tolist()))}
        pairs = [(i, place[k]) for i, k in enumerate(map(tuple, self.k.T.tolist())) if k in place]
        mine, theirs = (list(each) for each in zip(*pairs))
        unit = self.bits - other.bits
        taken = other.parts[..., theirs]
        self.parts[..., mine] = taken << unit if unit > 0 else taken >> -unit

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
        sigma = e^{2 pi i l/layers} for l = 0, ..., layers/2."""
        both = [np.fft.ifft(each, layers, axis=0, norm="forward") for each in (c, c.conj())]
        for at_k, at_minus_k in list(zip(*both))[:layers // 2 + 1]:
            u = np.zeros((len(self.k), self.mesh.points), at_k.dtype)
            u[:, self.at], u[:, self.negative] = at_k, at_minus_k
            yield u.reshape(len(u), *self.mesh.sizes)

    def series(self, circle: Iterator[np.ndarray], layers: int) -> np.ndarray:
        """The opposite: c_j for j = 0, ..., layers - 1."""
        at_k, conjugate = [], []
        for u in circle:
            u = u.reshape(len(u), -1)
            at_k.append(u[:, self.at])
            conjugate.append(u[:, self.negative].conj())
        return np.fft.fft(np.array(at_k + conjugate[-2:0:-1]), axis=0, norm="forward")

    def torus(self, potential: FourierSum, part: Part, rotation: Rotation,
              piece: Ends = NO_RANGE) -> Torus:
        numbers = self.parts.transpose(3, 1, 2, 0).reshape(len(self.at), self.degree + 1, -1)
        modes = {}
        for k, series in sorted(zip(map(tuple, self.k.T.tolist()), numbers.tolist())):
            while series and not any(series[-1]):
                series.pop()
            if series:
                modes[k] = tuple(map(tuple, series))
        return Torus(potential, part, rotation, self.bits, modes, piece)


def refined(digits: Digits, plan: Plan, potential: FourierSum, part: Part, rotation: Rotation,
            margin: float, piece: Ends = NO_RANGE) -> Tuple[Torus, float]:
    """The torus after as many corrections as help; ||E||_rho over what the theorem needs."""
    mesh, before = digits.mesh, inf
    layers = 1 if part is None else 2 << max(digits.degree - 1, 0).bit_length()
    shape = mesh.sizes[-2] if len(mesh.sizes) == 2 else 1, mesh.sizes[-1]
    grid = Grid(plan.norm, mesh.vectors, shape, layers)
    for _ in range(TURNS):
        torus = digits.torus(potential, part, rotation, piece)
        result = residual(torus, grid, digits.bits + 24)
        size = np.sqrt((abs(result.values) ** 2).sum(1)).sum(1)
        length = sum(float(a) * abs(m) for a, m in zip(plan.norm.alpha, result.sizes.m.T))
        ratio = float((size * np.exp(plan.rho * length)).sum()) / plan.needed
        if ratio <= 1 / margin or not ratio < before / 4:
            break
        before = ratio
        place, ok = mesh.index(result.k.T)
        spot = (slice(None), *(x[ok] for x in place))
        error = np.zeros((layers, len(mesh.k), *mesh.k.shape[1:]), complex)
        for j in range(layers):
            error[j][spot] = result.values[ok, :, j].T
        if part is None:
            u = mesh.spread(digits.k, digits.doubles()[0])
            digits.add(digits.picked(mesh.correction(u, error[0]))[None])
        else:
            error = np.fft.ifft(error, axis=0, norm="forward")
            circle = (mesh.correction(u, e) for u, e in
                      zip(digits.on_circle(digits.doubles(), layers), error))
            digits.add(digits.series(circle, layers)[:digits.degree + 1])
    return torus, ratio


def digits_for(plan: Plan, like: Mesh, margin: float, degree: Optional[int] = None) -> Digits:
    """Room for the coefficients that the plan asks for."""
    mesh = plan.mesh(like, degree is None)
    keep = mesh.inside & (plan.length(mesh) <= plan.size) & (abs(mesh.k).max(0) > 0)
    bits = ceil(log2(margin / plan.needed) + log2(keep.sum()) + 16)
    return Digits(mesh, keep, bits, degree or 0)
