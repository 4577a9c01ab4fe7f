"""Finds invariant tori, without proof: continuation in the amplitude of the potential from 0, where
every torus is there, by Newton's method in floating-point numbers; then refinement, with the error
computed to as many digits as the theorem asks for.

The number of modes follows the decay of the coefficients, in each of the frame's directions by
itself.  Small divisors magnify the rounding errors of high modes, so an error below the noise of
its own computation counts as zero.
"""

from fractions import Fraction
from math import ceil, exp, inf, isfinite, log, log2
from typing import List, NamedTuple, Optional, Union

import numpy as np

from ..model.potential import FourierSum
from ..model.problem import Problem
from .divisors import Norm
from .newton import Frame, Mesh, Real, default_frame, inverted
from .residual import Grid, residual
from .rotation import Rotation
from .torus import Torus, decay, family

ROOM = 0.4                  # of a mesh's box of modes is used: products fit, too
FLAT = 5.0                  # a decay rate; what falls faster has one or two modes
POINTS = 1 << 21            # of a mesh, at most
FIRST_STEP, SMALL_STEP, LEAST_STEP = 0.25, 0.01, 1e-5   # of the way to the amplitudes asked for
SPARE = 1.25                # of the log of the smallest coefficient: amplitudes ahead need more
ASPECTS = 1.0, 0.25, 0.4, 0.6, 1.6, 2.5, 4.0, 6.0   # of rates of decay in two directions
ITERATIONS = 9              # of Newton's method
STALLED = 1e-12             # of the error: below, more modes are needed, or there is noise alone
HISTORY = 4                 # tori from which the next one is extrapolated
TOO_LARGE = "too large"
MARGIN = 100.0              # of the theorem's inequality, that is aimed at
TURNS, ROUNDS = 5, 3        # of refinement with one number of modes, and numbers of modes
EDGE = 1.5                  # the error is computed for so many times the largest |k| of the torus


class NotFound(Exception):
    """No torus was found; the text says why, and what was reached.

    reached -- the part of the way from the start to the amplitudes asked for, in [0, 1]
    torus -- the last torus on this way, unrefined, with the amplitudes that it is for"""

    def __init__(self, text: str, reached: float, torus: Optional[Torus] = None) -> None:
        super().__init__(text)
        self.reached, self.torus = reached, torus


def find(problem: Problem, rotation: Rotation, *, start: Optional[Torus] = None,
         frame: Optional[Frame] = None, margin: float = MARGIN, points: int = POINTS) -> Torus:
    """The invariant torus of a rotation vector, about: no proof is made.

    start -- a torus of the same rotation vector, of other amplitudes, from which to continue; by
        default the map without potential
    frame -- integer rows of the mode numbers, in whose directions rates of decay may differ
    margin -- by which the error of the torus should be smaller than the theorem needs
    points -- of a mesh of angles, at most

    NotFound: there is none, as far as can be seen, or it needs more points.
    ValueError: problem, rotation vector and start do not go together."""
    potential, part = family(problem)
    if rotation.dimension != potential.dimension:
        raise ValueError("the rotation vector has %d components, but the potential depends on %d "
                         "angles" % (rotation.dimension, potential.dimension))
    way = _Way(potential, rotation, frame or default_frame(potential), points, start)
    return _refined(way, way.follow(), margin)


# ---- continuation

class _Found(NamedTuple):
    """part -- of the way
    mesh, u -- the torus, as coefficients on a mesh, of the modes `keep`
    rates -- at which they decay in each mode number
    reach -- log of the largest coefficient over the noise: e^-reach is about the least that is seen
    """

    part: float
    mesh: Mesh
    u: np.ndarray
    keep: np.ndarray
    rates: np.ndarray
    reach: float


class _Way:
    """From amplitudes for which a torus is known to those asked for."""

    def __init__(self, potential: FourierSum, rotation: Rotation, frame: Frame, points: int,
                 start: Optional[Torus]) -> None:
        self.potential, self.rotation, self.frame = potential, rotation, frame
        self.points, self.start = points, start
        known = {} if start is None else dict(zip(start.potential.waves, start.potential.amplitude))
        if start is not None and (
                start.rotation.floats != rotation.floats or start.part is not None
                or not set(known) <= set(potential.waves)):
            raise ValueError("the torus to start from has another rotation vector, a parameter, "
                             "or waves that the potential does not have")
        self.first, self.last = (
            np.array([Real(p.numerator) / p.denominator for p in amplitude]) for amplitude in
            ([known.get(wave, Fraction(0)) for wave in potential.waves], potential.amplitude))

    def amplitude(self, part: float) -> np.ndarray:
        return self.first + Real(part) * (self.last - self.first)

    def mesh(self, box) -> Mesh:
        return Mesh.holding(self.potential, self.rotation, self.frame, np.array(box) / ROOM / 2)

    def follow(self) -> _Found:
        """The torus at the end of the way."""
        known = [self._start()]
        step = FIRST_STEP if self.start is None else 1.0
        while known[-1].part < 1:
            last = known[-1]
            if not self._hopeful(known):
                break
            part = 1.0 if last.part + 1.25 * step >= 1 else last.part + step
            found = self._solved(part, last, _extrapolated(known, part))
            if isinstance(found, _Found):
                known = [*known[1 - HISTORY:], found]
                step *= 1.6
                continue
            step = (part - last.part) / 2.5
            if found == TOO_LARGE and step < SMALL_STEP or step < LEAST_STEP:
                break
        else:
            return known[-1]
        raise NotFound(*self._story(known))

    def _start(self):
        if self.start is None:
            rank = len(Mesh.holding(self.potential, self.rotation, self.frame, (1, 1)).sizes)
            mesh = self.mesh((8,) * rank)
            u = np.zeros((self.potential.dimension, *mesh.k.shape[1:]), np.clongdouble)
            return _Found(0.0, mesh, u, mesh.inside, np.full(rank, FLAT), 0.0)
        k, size = self.start.vectors.T, abs(self.start.coefficients()).max(1)
        small = self.mesh((1, 1))
        m = np.tensordot(np.array(self.frame), k, 1) if len(small.sizes) == 2 \
            else np.array(small._coordinates(k))
        mesh = self.mesh(abs(m[:, size > float(np.finfo(Real).eps) / 100]).max(1, initial=1) + 1)
        u = mesh.spread(k, self.start.coefficients().T.astype(np.clongdouble))
        return self._measured(0.0, mesh, u)

    def _solved(self, part: float, last: _Found, u: np.ndarray) -> Union[_Found, str, None]:
        """The torus there, from coefficients about its own on the last mesh; a mesh is taken whose
        modes reach down to the noise.  None: Newton's method failed; TOO_LARGE: the mesh would be.
        """
        mesh, keep = last.mesh, last.keep
        amplitude = self.amplitude(part)
        for _ in range(6):
            solved = newton(mesh, u, amplitude, keep)
            if solved is None:
                return None
            found = self._measured(part, mesh, solved)
            box = found.reach / found.rates
            larger = self.mesh(np.maximum(box, mesh.half))
            if larger.points > mesh.points and larger.points > self.points:
                return TOO_LARGE
            fits = all(b <= 2 * ROOM * half for b, half in zip(box, mesh.half))
            if fits:
                if (found.keep & ~keep).sum() <= 0.02 * keep.sum():
                    return found
                u, keep = found.u, found.keep
                continue
            larger = self.mesh(np.maximum(box, 2 * ROOM * np.array(mesh.half)))
            u, mesh = mesh.moved(found.u, larger), larger
            keep = _ellipse(mesh, found.rates, found.reach)
        return None

    def _measured(self, part, mesh, u):
        """The rates of decay, of coefficients above the noise, and the modes to keep.

        The noise of u is that of E over the smallest divisor so far: by L, in v = L z, the noise of
        one mode reaches the others."""
        turn = mesh.turn.astype(float)
        far = sum(abs(m) / half for m, half in zip(mesh.m, mesh.half)).ravel()
        order = np.argsort(far, kind="stable")
        least = np.minimum.accumulate(np.where(far > 0, turn.ravel(), 4)[order])
        noise = np.empty(turn.size)
        noise[order] = mesh.noise(self.amplitude(part)) / least
        size = abs(u).max(0).astype(float).ravel()
        seen = np.where((size > noise) & mesh.inside.ravel(), size, 0)
        if not seen.any():
            return _Found(part, mesh, u, mesh.inside, np.full(len(mesh.sizes), FLAT), 1.0)
        rates = max((_rates(mesh, seen, q) for q in ASPECTS[:None if len(mesh.m) == 2 else 1]),
                    key=np.prod)
        reach = SPARE * max(log(seen.max() / noise[far <= ROOM].max()), 0) + 6
        return _Found(part, mesh, u, _ellipse(mesh, rates, reach), rates, reach)

    def _hopeful(self, known):
        """Do the rates of decay, if they go on as they do, stay above 0 for half of what is left?
        """
        if len(known) < HISTORY or known[-1].mesh.points < self.points >> 4:
            return True
        return self._breakdown(known) > (known[-1].part + 1) / 2

    def _breakdown(self, known):
        """The part of the way at which a line through the last two rates of decay is 0."""
        (x0, y0), (x1, y1) = [(f.part, f.rates.min()) for f in known[-2:]]
        return x1 + y1 * (x1 - x0) / (y0 - y1) if y1 < y0 else inf

    def _story(self, known):
        last = known[-1]
        at = ", ".join("%.6g" % float(p) for p in self.amplitude(last.part))
        end = self._breakdown(known) if len(known) > 1 else inf
        guess = ", ".join("%.6g" % float(p) for p in self.amplitude(end)) if isfinite(end) else ""
        text = "no torus of %s was found for the amplitudes asked for: the last one is at %s" % (
            self.rotation, at)
        text += ", with %d points" % last.mesh.points
        if guess and end < 2:
            text += "; its coefficients decay at a rate that would be 0 near %s" % guess
        return text, last.part, self._torus(last)

    def _torus(self, found):
        """As it is, in doubles."""
        amplitude = tuple(Fraction(float(p)) for p in self.amplitude(found.part))
        return _Digits(found.mesh, found.keep, found.u, 80).torus(
            self.potential._replace(amplitude=amplitude), self.rotation)


def _rates(mesh, seen, q):
    """The rates at which coefficients decay with |m_0| and |m_1|, the second q times the first."""
    aspect = np.array([1.0, q])[:len(mesh.m)]
    rate = decay(sum(a * abs(m) for a, m in zip(aspect, mesh.m)).ravel(), seen)
    return aspect * min(FLAT / aspect.max(), max(rate, 1e-9))


def _ellipse(mesh, rates, reach):
    """Where coefficients of these rates are above e^-reach."""
    return mesh.inside & (sum(rate * abs(m) for rate, m in zip(rates, mesh.m)) <= reach)


def _extrapolated(known: List[_Found], part: float) -> np.ndarray:
    """The polynomial through the known coefficients, at another part of the way, on the last mesh.
    """
    mesh = known[-1].mesh
    total = np.zeros_like(known[-1].u)
    for i, found in enumerate(known):
        weight = Real(1)
        for j, other in enumerate(known):
            if i != j:
                weight *= Real(part - other.part) / Real(found.part - other.part)
        total += weight * (found.u if found.mesh is mesh else found.mesh.moved(found.u, mesh))
    return total


def newton(mesh: Mesh, u: np.ndarray, amplitude: np.ndarray,
           keep: np.ndarray) -> Optional[np.ndarray]:
    """The coefficients that solve the equation, as exactly as the noise permits, of the modes
    `keep`; None: the method does not converge from u."""
    noise = mesh.noise(amplitude)
    before = inf
    for _ in range(ITERATIONS):
        error = mesh.error(u, amplitude)
        error[abs(error) < noise] = 0
        size = float(np.sqrt((abs(error[:, keep]) ** 2).sum()))
        if size == 0:
            return u
        if not size < before / 2:
            return u if size < STALLED else None
        before = size
        u = (u + mesh.correction(u, error)) * keep
        if not abs(u).max() < 100:
            return None
    return None


# ---- refinement

class _Digits:
    """The coefficients of a torus with many digits, as integers times 2^-bits."""

    def __init__(self, mesh, keep, u, bits):
        self.mesh, self.bits = mesh, bits
        self.at, self.plain = mesh.positive(keep)
        self.k = mesh.k.reshape(len(mesh.k), -1)[:, self.at]
        self.k = np.where(self.plain, self.k, -self.k)
        self.parts = np.zeros((2, len(u), len(self.at)), object)        # re, im
        high = u.astype(complex)
        self.add(high)
        self.add((u - high).astype(complex))

    def add(self, v):
        """Adds coefficients on the mesh."""
        unit = 2.0 ** self.bits
        v = v.reshape(len(v), -1)[:, self.at]
        v = np.where(self.plain, v, v.conj())
        for mine, other in zip(self.parts, (v.real, v.imag)):
            mine += np.array([[int(x) for x in row] for row in (other * unit).tolist()], object)

    def doubles(self):
        """On the mesh."""
        unit = 1 << self.bits
        re, im = (np.array([[x / unit for x in row] for row in part.tolist()])
                  for part in self.parts)
        return self.mesh.spread(self.k, re + 1j * im)

    def torus(self, potential, rotation):
        numbers = self.parts.transpose(2, 1, 0).reshape(len(self.at), -1).tolist()
        modes = {k: (tuple(c),) for k, c in sorted(zip(map(tuple, self.k.T.tolist()), numbers))
                 if any(c)}
        return Torus(potential, None, rotation, self.bits, modes)


class _Plan(NamedTuple):
    """norm -- of modes, as the theorem's
    size -- of the largest k that is kept
    rho, needed -- the width of the strip, and about the largest ||E||_rho that the theorem takes"""

    norm: Norm
    alpha: np.ndarray
    size: float
    rho: float
    needed: float


def _refined(way: _Way, found: _Found, margin: float) -> Torus:
    more = 1.0
    for _ in range(ROUNDS):
        plan = _plan(way, found, margin, more)
        mesh = Mesh.holding(way.potential, way.rotation, way.frame,
                            [EDGE * plan.size / a for a in plan.alpha])
        keep = mesh.inside & (_length(mesh, plan.alpha) <= plan.size)
        bits = ceil(log2(margin / plan.needed) + log2(keep.sum()) + 16)
        digits = _Digits(mesh, keep, found.mesh.moved(found.u, mesh), bits)
        grid = Grid(plan.norm, mesh.vectors, (mesh.sizes[-2] if len(mesh.sizes) == 2 else 1,
                                              mesh.sizes[-1]))
        before = inf
        for _ in range(TURNS):
            torus = digits.torus(way.potential, way.rotation)
            result = residual(torus, grid, bits + 24)
            size = np.sqrt((abs(result.values[:, :, 0]) ** 2).sum(1))
            length = sum(float(a) * abs(m) for a, m in zip(plan.norm.alpha, result.sizes.m.T))
            norm = float((size * np.exp(plan.rho * length)).sum())
            if norm <= plan.needed / margin:
                return torus
            if not norm < before / 4:
                break
            before = norm
            place, ok = mesh.index(result.k.T)
            error = np.zeros((len(mesh.k), *mesh.k.shape[1:]), complex)
            error[(slice(None), *(x[ok] for x in place))] = result.values[ok, :, 0].T
            digits.add(mesh.correction(digits.doubles(), error))
        more *= 1.2
    return torus


def _length(mesh, alpha):
    return sum(a * abs(m) for a, m in zip(alpha, mesh.m))


def _plan(way, found, margin, more) -> _Plan:
    """How many modes the theorem needs, and the width of the strip: the fewest for which the
    coefficients beyond them, by their decay, are `margin` times smaller than the theorem needs."""
    mesh, u = found.mesh, found.u.astype(complex)
    weights = np.ones(way.potential.dimension)
    if len(mesh.sizes) == len(weights):
        alpha = weights = np.maximum(1, np.rint(found.rates / found.rates.min()))
    else:                                       # all modes are multiples of one vector
        alpha = np.array([abs(np.array(way.frame) @ mesh.basis[0]).sum()])
    rate = float((found.rates / alpha).min())
    tau = way.potential.dimension
    length = _length(mesh, alpha)
    size = abs(u).max(0)
    seen = size * mesh.turn.astype(float) > 4 * mesh.noise(way.amplitude(1.0))
    largest = float((size * np.exp(rate * length))[seen].max(initial=1e-3))
    density = (2 if len(alpha) == 1 else 4) / float(alpha.prod())   # of modes near |k| <= 1
    K = 8.0
    while True:
        rho = (4 * tau + 1) / K
        if rho < 0.9 * rate:
            x = rate - rho
            tail = density * largest * exp(-x * K) * (1 / x if len(alpha) == 1
                                                      else K / x + 1 / x ** 2)
            needed = _needed(way, found, alpha, rho)
            if tail <= needed / margin:
                break
        K *= 1.05
    K *= more
    norm = Norm(way.frame, tuple(Fraction(int(a)) for a in weights))
    return _Plan(norm, alpha, K, (4 * tau + 1) / K, needed)


def _needed(way, found, alpha, rho):
    """About the largest ||E||_rho for which the theorem holds (docs/existence.md): from norms in
    doubles, the divisors of the mesh, and the loss in 4 + 2 s parts with s = 0.3."""
    mesh, tau = found.mesh, way.potential.dimension
    length = _length(mesh, alpha)
    weight = np.where(length * rho < 200, np.exp(np.minimum(length * rho, 200)), 0)
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
    for wave, p in zip(way.potential.waves, way.potential.amplitude):
        k = np.array(wave[:tau])
        growth = exp(min(50, norm(np.tensordot(k, found.u, 1)[None])))
        T += float(abs(p)) * float(k @ k) ** 1.5 * growth
    h = 1.1
    G = a * h * c ** 2 * l * ((2 * m * l * d if tau > 1 else 0) + d / 2
                              + T / 2 * a * h * c ** 2 * l ** 3)
    return 2.0 ** (-4 * tau) / G
