"""Continuation of a torus in the amplitudes of the potential, by Newton's method in floating-point
numbers, from a map where it is known: without potential, every torus is there.

The number of modes follows the decay of the coefficients, in two directions at different rates.
On the way the number is as large as the next step needs; at the end it is as large as doubles can
tell. Small divisors magnify the rounding errors of high modes. So an error below the noise of its
computation counts as zero.
"""

from math import inf, isfinite, log
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ..model.potential import FourierSum
from ..storage.files import ConverseError
from .effort import LAYER_BYTES, REFINING_BYTES, SOLVING, free_memory, some
from .newton import EPSILON, Mesh, default_frame
from .rotation import Rotation
from .torus import Torus, decay

ROOM = 0.4                  # This part of a mesh's box of modes is used, so that products fit.
FLAT = 5.0                  # Series that decay at this rate or faster have one or two modes.
POINTS = 1 << 21            # A mesh has at most these points.
# Steps are parts of the way to the amplitudes asked for.
FIRST_STEP, SMALL_STEP, LEAST_STEP = 0.25, 0.01, 1e-5
SPARE = 1.25                # Factor of the log of the least coefficient: the next step needs more.
ENOUGH = 1e-9               # Smaller coefficients do not count on the way.
ASPECTS = 1.0, 0.25, 0.4, 0.6, 1.6, 2.5, 4.0, 6.0   # Ratios of two rates of decay that are tried.
ITERATIONS = 9              # Newton's method takes at most these steps.
USEFUL, STALLED = 1e-7, 1e-12   # Newton's method may end at the first; at the second no mode lacks.
ENLARGED = 8                # This often the number of modes is raised.
HISTORY = 4                 # The next torus is extrapolated from the last HISTORY ones.
TOO_LARGE = "too large"


class NotFound(ConverseError):
    """No torus was found; the text says why, and what was reached.

    Attributes
    ----------
    reached
        The last torus is at this part of the way to the amplitudes, in [0, 1].  The way through a
        range begins at its lower end.
    amplitude
        The amplitude of each wave there.
    """

    def __init__(self, text: str, reached: float, amplitude: Sequence[float]) -> None:
        super().__init__(text)
        self.reached, self.amplitude = reached, tuple(amplitude)


class Found(NamedTuple):
    """part -- of the way.
    amplitude -- of each wave there.
    mesh, u -- The torus: coefficients on a mesh, of the modes `keep`.
    seen -- the modes whose coefficients are above the noise.
    rates -- These coefficients decay so in each mode number.
    reach -- log of the largest coefficient over the least that count, with some to spare.
    """

    part: float
    amplitude: np.ndarray
    mesh: Mesh
    u: np.ndarray
    keep: np.ndarray
    seen: np.ndarray
    rates: np.ndarray
    reach: float


class Way:
    """From amplitudes for which a torus is known to those asked for, one for each wave."""

    def __init__(self, potential: FourierSum, rotation: Rotation, points: int,
                 first: np.ndarray, last: np.ndarray,
                 tell: Callable[[str], None] = lambda words: None,
                 memory: Optional[int] = None) -> None:
        self.potential, self.rotation, self.frame = potential, rotation, default_frame(potential)
        self.points, self.first, self.last = points, first, last
        self.tell, self.memory = tell, memory

    def amplitude(self, part: float) -> np.ndarray:
        return self.first + part * (self.last - self.first)

    def mesh(self, box) -> Mesh:
        """One that holds the mode numbers of a box, with room for products."""
        return Mesh.holding(self.potential, self.rotation, self.frame, np.array(box) / ROOM / 2)

    def follow(self, start: Optional[Found] = None) -> Found:
        """The torus at the end of the way.  `start` is the torus at its beginning, by default the
        straight one of the map without potential."""
        known = [self._straight() if start is None else start._replace(part=0.0)]
        step = FIRST_STEP if start is None else 1.0
        while known[-1].part < 1:
            last = known[-1]
            if not self._hopeful(known):
                raise self._not_found(known)
            part = 1.0 if last.part + 1.25 * step >= 1 else last.part + step
            found = self._solved(part, last, _extrapolated(known, part))
            if isinstance(found, Found) and part == 1:
                found = self._solved(part, found, found.u, 0.0)
            if isinstance(found, Found):
                known = [*known[1 - HISTORY:], found]
                step *= 1.6
                continue
            step = (part - last.part) / 2.5
            if found == TOO_LARGE and step < SMALL_STEP or step < LEAST_STEP:
                raise self._not_found(known, found == TOO_LARGE)
        return known[-1]

    def _straight(self):
        rank = len(Mesh.holding(self.potential, self.rotation, self.frame, (1, 1)).sizes)
        mesh = self.mesh((8,) * rank)
        u = np.zeros((self.potential.dimension, *mesh.k.shape[1:]), complex)
        return Found(0.0, self.first, mesh, u, mesh.inside, mesh.inside, np.full(rank, FLAT), 1.0)

    def taken_up(self, torus: Torus) -> Found:
        """A torus of the map at the beginning of the way."""
        k, size = torus.k.T, abs(torus.coefficients()).max(1)
        m = self.mesh((1, 1)).numbers(k)
        seen = size > EPSILON / 100
        mesh = self.mesh(abs(m[:, seen]).max(1, initial=1) + 1)
        u = mesh.spread(k, torus.coefficients().T)
        return self._measured(0.0, mesh, u)

    def _solved(self, part: float, last: Found, u: np.ndarray,
                least: float = ENOUGH) -> Union[Found, str, None]:
        """The torus there, from coefficients about its own on the last mesh; a mesh is taken whose
        modes reach down to coefficients of the size `least`, or to the noise.  None: Newton's
        method failed; TOO_LARGE: the mesh would be."""
        mesh, keep, more = last.mesh, last.keep, 1.0
        amplitude = self.amplitude(part)
        for _ in range(ENLARGED):
            self.tell("looking for the torus at %s, on %d points%s" % (
                _text(amplitude), mesh.points, some(SOLVING * mesh.points)))
            solved = newton(mesh, u, amplitude, keep)
            if solved is None:
                return None
            found = self._measured(part, mesh, solved[0], least)
            u, more = found.u, more * (1.3 if solved[1] > STALLED else 1)
            box = more * found.reach / found.rates
            if all(b <= 2 * ROOM * half for b, half in zip(box, mesh.half)):
                wanted = ellipse(mesh, found.rates, more * found.reach)
                if solved[1] <= STALLED and (wanted & ~keep).sum() <= 0.02 * keep.sum():
                    return found
                keep = wanted
                continue
            larger = self.mesh(np.maximum(box, 2 * ROOM * np.array(mesh.half)))
            if larger.points > self.points:
                return TOO_LARGE
            u, mesh = mesh.moved(u, larger), larger
            keep = ellipse(mesh, found.rates, more * found.reach)
        return None

    def check_cost(self, points: int, layers: int = 0) -> None:
        """NotFound: to refine a torus on a grid of these points takes too much memory."""
        free = free_memory() * 3 // 4 if self.memory is None else self.memory
        memory = points * (REFINING_BYTES + LAYER_BYTES * layers)
        if memory > free:
            raise NotFound("the torus is seen, but to refine it takes a grid of %d points and %.3g "
                           "GB of memory, and %.3g GB may be used" % (
                               points, memory / 1e9, free / 1e9),
                           1.0, [float(p) for p in self.last])

    def _measured(self, part, mesh, u, enough=ENOUGH):
        """The rates of decay, of coefficients above the noise, and the modes to keep.

        The noise of u is that of E over the smallest divisor so far: by L, in v = L z, the noise of
        one mode reaches the others."""
        turn = mesh.turn
        far = sum(abs(m) / half for m, half in zip(mesh.m, mesh.half)).ravel()
        order = np.argsort(far, kind="stable")
        least = np.minimum.accumulate(np.where(far > 0, turn.ravel(), 4)[order])
        noise = np.empty(turn.size)
        noise[order] = np.maximum(mesh.noise(self.amplitude(part)) / least,
                                  enough)
        size = abs(u).max(0).ravel()
        seen = np.where((size > noise) & mesh.inside.ravel(), size, 0)
        rates, reach = np.full(len(mesh.sizes), FLAT), 8 * FLAT
        if seen.any():
            rates = max((_rates(mesh, seen, q) for q in ASPECTS[:None if len(mesh.m) == 2 else 1]),
                        key=np.prod)
            reach = SPARE * max(log(seen.max() / noise[far <= ROOM].max()), 0) + 6
        return Found(part, self.amplitude(part), mesh, u, ellipse(mesh, rates, reach),
                     (seen > 0).reshape(turn.shape), rates, reach)

    def _hopeful(self, known):
        """Do the rates of decay, if they go on as they do, stay above 0 for half of what is left?
        """
        if len(known) < HISTORY or known[-1].mesh.points < self.points >> 2:
            return True
        return self._breakdown(known) > (known[-1].part + 1) / 2

    def _breakdown(self, known):
        """The part of the way at which a line through the last two rates of decay is 0."""
        (x0, y0), (x1, y1) = [(f.part, f.rates.min()) for f in known[-2:]]
        return x1 + y1 * (x1 - x0) / (y0 - y1) if y1 < y0 else inf

    def _not_found(self, known, too_large=False):
        last = known[-1]
        at = _text(self.amplitude(last.part))
        end = self._breakdown(known) if len(known) > 1 else inf
        guess = _text(self.amplitude(end)) if isfinite(end) else ""
        text = "no torus of this rotation %s was found for the amplitudes asked for: the last is " \
            "at %s, on a grid of %d points" % (
                "vector" if self.potential.dimension > 1 else "number", at, last.mesh.points)
        if more := too_large or end >= 1 and last.mesh.points >= self.points >> 2:
            text += "; farther on it needs more than the %d points that are allowed " \
                "(converse-tori --points)" % self.points
        if guess and end < (1 if more else 2):
            text += "; the rate at which its coefficients decay would be 0 near %s" % guess
        return NotFound(text, last.part, [float(p) for p in self.amplitude(last.part)])


def _text(amplitude):
    return ", ".join("%.6g" % float(p) for p in amplitude)


def _rates(mesh, seen, q):
    """The rates at which coefficients decay with |m_0| and |m_1|, the second q times the first."""
    aspect = np.array([1.0, q])[:len(mesh.m)]
    rate = decay(sum(a * abs(m) for a, m in zip(aspect, mesh.m)).ravel(), seen)
    return aspect * min(FLAT / aspect.max(), max(rate, 1e-9))


def ellipse(mesh, rates, reach):
    """Where coefficients of these rates are above e^-reach."""
    return mesh.inside & (sum(rate * abs(m) for rate, m in zip(rates, mesh.m)) <= reach)


def _extrapolated(known: List[Found], part: float) -> np.ndarray:
    """The polynomial through the known coefficients, at another part of the way, on the last mesh.
    """
    mesh = known[-1].mesh
    total = np.zeros_like(known[-1].u)
    for i, found in enumerate(known):
        weight = 1.0
        for j, other in enumerate(known):
            if i != j:
                weight *= (part - other.part) / (found.part - other.part)
        total += weight * (found.u if found.mesh is mesh else found.mesh.moved(found.u, mesh))
    return total


def newton(mesh: Mesh, u: np.ndarray, amplitude: np.ndarray,
           keep: np.ndarray) -> Optional[Tuple[np.ndarray, float]]:
    """Solves the equation for the coefficients of the modes `keep`, as exactly as the noise and the
    other modes permit.  Returns them and the remaining error, or None if it does not converge."""
    noise = mesh.noise(amplitude)
    before = inf
    for _ in range(ITERATIONS):
        error = mesh.error(u, amplitude)
        error[abs(error) < noise] = 0
        size = float(np.sqrt((abs(error[:, keep]) ** 2).sum()))
        if not size < before / 2 or size == 0:
            return (u, size) if size < USEFUL else None
        before = size
        u = (u + mesh.correction(u, error)) * keep
        if not abs(u).max() < 100:
            return None
    return None
