"""Estimates how many modes and digits the theorem of docs/proofs/existence.md will need of a torus
that is known in doubles, and chooses the norm and the strip.  The checker alone
decides."""

from fractions import Fraction
from functools import lru_cache
from math import ceil, exp, inf, log2
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..model.exact import rounded_text
from .continuation import Found
from .newton import Frame, Mesh, combined, inverted, sizes_holding, triangular, turns
from .rotation import Rotation
from .torus import Strip

MARGIN = 100.0              # Factor by which the error of a torus is to be below the error needed.
WEIGHTS = 1, 2, 3, 4, 5, 6, 8, 10, 12, 16       # ratios of alpha
TRIED = 3                   # So many are tried, those nearest to the ratio of the rates of decay.
# E is computed for |k| up to EDGE times the longest mode that matters.  The torus takes up to ROOM
# of these, so that most modes that it leaves in E are seen.
EDGE, ROOM = 1.13, 0.9
SHARE = 0.3                 # s of the theorem
BOX = {1: 1 << 16, 2: 700}  # Divisors are computed for modes with coordinates up to this.
OUTER = 4                   # Ratio of lengths among which there are divisors of the usual size.
NOTABLE = 64.0              # Divisors count where |1 - e^{ik.w}| |k|^n is below this times its min.

Weights = Tuple[int, ...]


class Plan(NamedTuple):
    """frame, alpha -- of the norm |k| = sum of alpha_i |frame_i.k|.
    size -- of the largest k that matters.
    rho, needed -- the width of the strip, and about the largest ||E||_rho that the theorem takes.
    rate -- Coefficients decay so with |k|."""

    frame: Frame
    alpha: Weights
    size: float
    rho: float
    needed: float
    rate: float

    @property
    def strip(self) -> Strip:
        return Strip(self.frame, tuple(map(Fraction, self.alpha)),
                     Fraction(rounded_text(Fraction(self.rho), 6, up=False)))

    def length(self, k: np.ndarray) -> np.ndarray:
        """|k| of modes (n, ...)."""
        return _length(self.frame, self.alpha, k)

    def box(self, like: Mesh) -> Sequence[float]:
        """In each direction the mode numbers of a mesh on which products of the modes that are kept
        have room."""
        return [EDGE * self.size / a for a in _steps(like, self.alpha)]

    def mesh(self, like: Mesh, real: bool = True) -> Mesh:
        """Such a mesh."""
        return Mesh.holding(like.potential, like.rotation, like.frame, self.box(like), real)

    def reach(self, mesh: Mesh) -> float:
        """All modes with |k| below this are on the mesh."""
        return float((_steps(mesh, self.alpha) * mesh.half).min())

    def keep(self, mesh: Mesh) -> np.ndarray:
        """The modes of a mesh that a torus may have."""
        return mesh.inside & (self.length(mesh.k) <= ROOM * self.reach(mesh)) \
            & (abs(mesh.k).max(0) > 0)

    def modes(self, like: Mesh) -> int:
        """About how many modes matter.  Meshes are rounded up, and a torus is pruned in the end."""
        mesh = self.mesh(like)
        return int((self.length(mesh.k) <= self.size).sum())

    def bits(self, k: np.ndarray, degree: int, margin: float) -> int:
        """The bits of the coefficients of modes k, for each power of sigma.  Cutting them to these
        bits changes ||E||_rho by less than needed/margin/16."""
        weights = (degree + 1) * np.exp(np.minimum(self.rho * self.length(k), 600))
        return ceil(log2(margin / self.needed) + log2(max(float(weights.sum()), 1)) + 8)


def plan(found: Found, margin: float = MARGIN, more: float = 1.0,
         alpha: Optional[Weights] = None) -> Plan:
    """How many modes the theorem needs, and the width of the strip.  They are the fewest for which
    the coefficients beyond them, by their decay, are `margin` times smaller than the theorem needs.
    Then they are made `more` times as many in each direction.

    alpha -- weights of the norm; by default chosen so that the modes are the fewest."""
    theorem = _Needed(found)
    if alpha is not None or found.mesh.potential.dimension == 1:
        return theorem.plan(alpha or (1,), margin, more)
    ratio = found.rates[0] / found.rates[-1]        # one rate, if the waves span a line

    def cost(each):
        aim = theorem.plan(each, margin, 1)
        sizes = sizes_holding(found.mesh.potential, found.mesh.frame, aim.box(found.mesh))
        return np.prod(sizes), aim.size ** 2 / float(np.prod(each))

    choices = [(1, a) for a in WEIGHTS] + [(a, 1) for a in WEIGHTS[1:]]
    choices.sort(key=lambda each: abs(log2(ratio * each[1] / each[0])))
    return theorem.plan(min(choices[:TRIED], key=cost), margin, more)


def _length(frame, alpha, k):
    return sum(a * abs(combined(row, k)) for a, row in zip(alpha, frame))


def _steps(mesh: Mesh, alpha: Weights) -> np.ndarray:
    """The length that a step of each mode number of a mesh adds to |k|."""
    return np.array(alpha if len(mesh.basis) == 2 else [
        _length(mesh.frame, alpha, np.array(mesh.basis[0]))], float)


class _Needed:
    """About the largest ||E||_rho for which the theorem holds, in any norm: from norms in doubles,
    small divisors, and the loss of the first step."""

    def __init__(self, found: Found) -> None:
        self.mesh = mesh = found.mesh
        n = mesh.potential.dimension
        at, _ = mesh.positive(found.keep)
        self.k = mesh.k.reshape(n, -1)[:, at]

        def sizes(coefficients):
            components = tuple(range(coefficients.ndim - len(mesh.sizes)))
            size = np.sqrt((abs(coefficients) ** 2).sum(components)).ravel()
            return float(size[0]), size[at]

        L, A, du = mesh.frames(found.u)
        inverse = inverted(A)
        self.du, self.m, self.a = (sizes(x) for x in (
            du, *(mesh.coefficients(x) for x in (inverted(L), inverse))))
        mean = inverse.mean(tuple(range(2, inverse.ndim)))
        self.h = 1 + float(np.linalg.norm(np.linalg.inv(mean), 2)) * float(
            self.a[1].max(initial=0))
        self.waves = [(float(abs(p)) * float(np.dot(k, k)) ** 1.5, k, sizes(
            combined(k, found.u)[None])) for k, p in zip(mesh.vectors, found.amplitude)]
        self.divisors = _divisors(mesh.vectors, mesh.rotation, mesh.frame)
        corners = np.linalg.norm(np.linalg.inv(np.array(mesh.frame, float)), axis=0)
        self.corners = corners
        self.seen = found.seen.ravel()
        self.size, self.all = abs(found.u).max(0).ravel(), mesh.k.reshape(n, -1)
        self.rates = found.rates

    def plan(self, alpha: Weights, margin: float, more: float) -> Plan:
        mesh, tau = self.mesh, len(alpha)
        rank = len(mesh.sizes)
        steps = _steps(mesh, alpha)
        rate = float((self.rates / steps).min())
        length = _length(mesh.frame, alpha, self.all)
        # exp of a large number is only asked for where the coefficient is known to be small
        largest = float((self.size * np.exp(np.minimum(rate * length, 600)))[self.seen].max(
            initial=1e-3))
        density = 2 * rank / float(steps.prod())        # of modes near |k| <= 1
        near = _length(mesh.frame, alpha, self.k)

        def lacking(K):
            """(tail times margin over needed, rho, needed)."""
            rho = (4 * tau + 1) / K
            x = rate - rho
            tail = density * largest * exp(-x * K) * (1 / x if rank == 1 else K / x + 1 / x ** 2)
            needed = self.at(alpha, near, rho)
            return tail * margin / needed if needed else inf, rho, needed

        low = high = (4 * tau + 1) / (0.9 * rate)
        while lacking(high)[0] > 1:
            low, high = high, 1.4 * high
        while high > 1.04 * low:
            middle = (low * high) ** 0.5
            low, high = (middle, high) if lacking(middle)[0] > 1 else (low, middle)
        _, rho, needed = lacking(high)
        if more > 1:
            rho, needed = rho / more, self.at(alpha, near, rho / more)
        return Plan(mesh.frame, alpha, high * more, rho, needed, rate)

    def at(self, alpha: Weights, near: np.ndarray, rho: float) -> float:
        weight, tau = np.exp(np.minimum(near * rho, 200)), len(alpha)

        def norm(sizes):
            return sizes[0] + 2 * float(weight @ sizes[1])

        l, m, a = 1 + norm(self.du), norm(self.m), norm(self.a)
        delta = rho / (4 + 2 * SHARE)
        c = _loss(*self.divisors, alpha, delta)
        d = float((self.corners / alpha).max()) / (delta * exp(1))
        T = sum(size * exp(min(50, norm(phase) + rho * float(
            _length(self.mesh.frame, alpha, np.array(k))))) for size, k, phase in self.waves)
        G = a * self.h * c ** 2 * l * ((2 * m * l * d if tau > 1 else 0) + d / 2
                                       + T / 2 * a * self.h * c ** 2 * l ** 3)
        return float(2.0 ** (-4 * tau) / G)


def _loss(k: np.ndarray, divisor: np.ndarray, alpha: Weights, delta: float) -> float:
    """About c(delta), from the lists of _divisors.  The k that count most have about the length
    n/delta.  If the box does not hold all of these, they are taken to have the least
    |1 - e^{ik.w}| |k|^n of the longest k that it holds."""
    n = len(alpha)
    length, whole = np.array(alpha) @ k, BOX[n] * min(alpha)
    seen = float((np.exp(-delta * length) / divisor).max())
    if n < delta * whole:
        return seen
    far = (length > whole / OUTER) & (length <= whole)
    least = float((divisor[far] * length[far] ** float(n)).min(initial=NOTABLE))
    return max(seen, (n / (exp(1) * delta)) ** n / least)


@lru_cache(maxsize=4)
def _divisors(vectors: Sequence[Tuple[int, ...]], rotation: Rotation, frame: Frame
              ) -> Tuple[np.ndarray, np.ndarray]:
    """(|frame_i.k|, |1 - e^{ik.w}|) of the modes whose divisors are notably small for their size,
    in the group that vectors generate; in Z^n, if its rank is below n."""
    n = len(frame)
    basis = triangular(vectors, frame) if n == 1 or len(triangular(vectors, frame)) == 2 else \
        [(1, 0), (0, 1)]
    reach = BOX[n]
    a = np.array(np.meshgrid(np.arange(reach + 1), *[np.arange(-reach, reach + 1)] * (n - 1),
                             indexing="ij")).reshape(n, -1)
    k = np.array(basis).T @ a[:, (a != 0).any(0)]
    size, divisor = abs(np.array(frame) @ k), 2 * abs(np.sin(np.pi * turns(k, rotation)))
    small = divisor * size.sum(0) ** float(n)
    notable = small <= NOTABLE * small.min()
    return size[:, notable], divisor[notable]
