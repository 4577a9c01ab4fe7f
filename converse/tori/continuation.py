"""Continuation of a torus in the amplitudes of the potential, by Newton's method in floating-point
numbers, from a map where it is known: without potential, every torus is there.  Or a torus is made
of an orbit that lies on it (regular.py), where no continuation leads.

The number of modes follows the decay of the coefficients, in two directions at different rates.
On the way the number is as large as the next step needs; at the end it is as large as doubles can
tell. Small divisors magnify the rounding errors of high modes. So an error below the noise of its
computation counts as zero.
"""

from math import inf, log
from typing import List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ..model.potential import FourierSum
from ..storage.files import ConverseError
from .effort import LAYER_BYTES, REFINING_BYTES, SOLVING, Work, free_memory
from .newton import EPSILON, Mesh, best_frame, default_frame
from .regular import Orbit, Orbits
from .rotation import Rotation
from .torus import FLAT, Torus, rates_of

ROOM = 0.4                  # This part of a mesh's box of modes is used, so that products fit.
POINTS = 1 << 21            # A mesh has at most these points.
# Steps are parts of the way to the amplitudes asked for.
FIRST_STEP, SMALL_STEP, LEAST_STEP = 0.25, 0.01, 1e-5
SPARE = 1.25                # Factor of the log of the least coefficient: the next step needs more.
ENOUGH = 1e-9               # Smaller coefficients do not count on the way.
ITERATIONS = 9              # Newton's method takes at most these steps.
USEFUL, STALLED = 1e-7, 1e-12   # Newton's method may end at the first; at the second no mode lacks.
ENLARGED = 8                # This often the number of modes is raised.
HISTORY = 4                 # The next torus is extrapolated from the last HISTORY ones.
TOO_LARGE = "too large"
FRAMED = 1 << 11            # points of the mesh on which the frame is chosen
# The torus of an orbit begins with modes up to REACH, by the number of angles.  Where Newton's
# method stalls, it has GROWTH times as many in each direction.  It is given up if the error, which
# is at most SEEN, does not become DOWN times as large in WEARY rounds.
REACH, GROWTH, SEEN, DOWN, WEARY = {1: 128, 2: 8}, {1: 2.0, 2: 1.5}, 1e-2, 0.7, 4
# The break-up is estimated from the last FITTED tori, if the norm of the second derivatives grows
# like a power of the distance to within MISFIT, and if the last FEWER say the same to AGREED.
FITTED, FEWER, MISFIT, AGREED = 6, 4, 0.02, 0.3


class NotFound(ConverseError):
    """No torus was found; the text gives the reason and the last torus.

    Attributes
    ----------
    reached
        The last torus is at this part of the way to the parameters, in [0, 1].  The way through a
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
    bend -- the norm of the second derivatives
    """

    part: float
    amplitude: np.ndarray
    mesh: Mesh
    u: np.ndarray
    keep: np.ndarray
    seen: np.ndarray
    rates: np.ndarray
    reach: float
    bend: float = 0.0


def place(named: Sequence[Tuple[str, float]], amplitude: np.ndarray) -> str:
    """Where a map is, in words: by its parameters, or else by its amplitudes."""
    if named:
        return ", ".join("%s = %.6g" % each for each in named)
    return "the amplitudes " + ", ".join("%.6g" % float(p) for p in amplitude)


class Way:
    """From amplitudes for which a torus is known to those asked for, one for each wave.

    named -- (name, value at the beginning, value at the end) of the parameters that change"""

    def __init__(self, potential: FourierSum, rotation: Rotation, points: int,
                 first: np.ndarray, last: np.ndarray,
                 tell: Optional[Work] = None, memory: Optional[int] = None,
                 named: Sequence[Tuple[str, float, float]] = ()) -> None:
        self.potential, self.rotation, self.frame = potential, rotation, default_frame(potential)
        self.points, self.first, self.last, self.chosen = points, first, last, False
        self.tell, self.memory, self.named = tell or Work(), memory, named

    def place(self, part: float) -> str:
        """Where a part of the way leads, in words."""
        return place([(name, low + part * (high - low)) for name, low, high in self.named],
                     self.amplitude(part))

    def amplitude(self, part: float) -> np.ndarray:
        return self.first + part * (self.last - self.first)

    def mesh(self, box) -> Mesh:
        """One that holds the mode numbers of a box, with room for products."""
        return Mesh.holding(self.potential, self.rotation, self.frame, np.array(box) / ROOM / 2)

    def follow(self, start: Optional[Found] = None) -> Found:
        """The torus at the end of the way.  `start` is the torus at its beginning, by default the
        straight one of the map without potential."""
        known = [self._straight() if start is None else start._replace(part=0.0)]
        step, bends = FIRST_STEP if start is None else 1.0, []
        while known[-1].part < 1:
            last = known[-1]
            part = 1.0 if last.part + 1.25 * step >= 1 else last.part + step
            found = self._solved(part, last, _extrapolated(known, part))
            if isinstance(found, Found) and part == 1:
                found = self._solved(part, found, found.u, 0.0)
            if isinstance(found, Found):
                known = [*known[1 - HISTORY:], self._framed(found)]
                bends.append((part, found.bend))
                step *= 1.6
                continue
            step = (part - last.part) / 2.5
            if found == TOO_LARGE and step < SMALL_STEP or step < LEAST_STEP:
                raise self._not_found(last, found == TOO_LARGE, break_up(bends[-FITTED:]))
        return known[-1]

    def of_orbit(self, orbits: Orbits, orbit: Orbit,
                 points: Optional[int] = None) -> Union[Found, float]:
        """The torus at the end of the way on which an orbit lies, in modes without which Newton's
        method stalls: `finished` adds the others.  Where there is none, the least error that is
        left on meshes of these sizes; infinity: Newton's method fails."""
        n, amplitude = self.potential.dimension, self.amplitude(1.0)
        k, c = orbits.series(orbit, self.rotation.floats, REACH[n])
        if n == 2:
            self.frame = best_frame(k, abs(c).max(0))
        box = np.full(len(self._straight().mesh.sizes), float(REACH[n]))
        mesh, before, rounds = self.mesh(2 * box), inf, 0
        u = mesh.spread(k, c)
        while mesh.points <= (points or self.points):
            self.tell("looking for the torus of an orbit, on %d points" % mesh.points,
                      SOLVING * mesh.points)
            keep = np.all([abs(m) <= 2 * b for m, b in zip(mesh.m, box)], 0) & mesh.inside
            solved = newton(mesh, u, amplitude, keep, SEEN)
            rounds = 0 if solved and solved[1] < DOWN * before else rounds + 1
            if solved is None or rounds == WEARY:
                return inf
            u, before = solved[0], min(before, solved[1])
            if before <= (STALLED if points else USEFUL):
                rough = self._tight(self._measured(1.0, mesh, u))
                found = self._solved(1.0, rough, rough.u)
                if isinstance(found, Found):
                    return found
            box *= GROWTH[n]
            larger = self.mesh(2 * box)
            u, mesh = mesh.moved(u, larger), larger
        return before

    def finished(self, rough: Found) -> Found:
        """A torus at the end of the way, with all modes that doubles can tell."""
        found = self._solved(1.0, rough, rough.u, 0.0)
        if not isinstance(found, Found):
            raise self._not_found(rough, found == TOO_LARGE, None)
        return found

    def _framed(self, found):
        """The torus in the frame in which its modes fill the smallest box, chosen once."""
        if len(found.mesh.sizes) == 1 or self.chosen or found.mesh.points < FRAMED:
            return found
        self.chosen, at = True, found.seen
        frame = best_frame(found.mesh.k[:, at], abs(found.u).max(0)[at])
        if frame == self.frame:
            return found
        self.frame = frame
        return self._tight(found)

    def _tight(self, found):
        """The torus on the smallest mesh that holds its modes."""
        k = found.mesh.k[:, found.keep]
        mesh = self.mesh((1,) * len(found.mesh.sizes))
        mesh = self.mesh(abs(mesh.numbers(k)).max(1) + 1)
        return self._measured(found.part, mesh, found.mesh.moved(found.u, mesh))

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
            self.tell("looking for the torus at %s, on %d points" % (
                self.place(part), mesh.points), SOLVING * mesh.points)
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
            rates = rates_of(abs(mesh.m).reshape(len(mesh.m), -1), seen)
            reach = SPARE * max(log(seen.max() / noise[far <= ROOM].max()), 0) + 6
        bend = float(np.linalg.norm(size * (mesh.k.reshape(len(mesh.k), -1) ** 2.0).sum(0)))
        return Found(part, self.amplitude(part), mesh, u, ellipse(mesh, rates, reach),
                     (seen > 0).reshape(turn.shape), rates, reach, bend)

    def _not_found(self, last, too_large, end):
        text = "no torus of this rotation %s was found for the parameters asked for: the last is " \
            "at %s, on a grid of %d points" % (
                "vector" if self.potential.dimension > 1 else "number", self.place(last.part),
                last.mesh.points)
        if too_large:
            text += "; farther on it needs more than the %d points that are allowed " \
                "(converse-tori --points)" % self.points
        if end is not None:
            text += "; it breaks up near %s, by an estimate" % self.place(end)
        return NotFound(text, last.part, [float(p) for p in self.amplitude(last.part)])


def break_up(bends: Sequence[Tuple[float, float]]) -> Optional[float]:
    """The part of a way at which a torus breaks up, about: there the norm of its derivatives grows
    like a power of the distance (Calleja and de la Llave, Nonlinearity 23, 2029, 2010).  None: it
    does not grow so, or not near enough to the end to tell."""
    if len(bends) < FITTED:
        return None
    ends = []
    for part, norm in (np.array(bends).T, np.array(bends[-FEWER:]).T):
        reach = part[-1] - part[0]
        off = reach * np.geomspace(1e-4, 1, 1000)
        height = np.log(norm) - np.log(norm).mean()
        far = np.log(part[-1] + off[:, None] - part)
        far -= far.mean(1)[:, None]
        slope = far @ height / (far ** 2).sum(1)
        misfit = abs(height - slope[:, None] * far).max(1) / np.ptp(height)
        best = int(misfit.argmin())
        if misfit[best] > MISFIT or slope[best] >= 0 or best in (0, len(off) - 1):
            return None
        ends.append(off[best])
    return float(bends[-1][0] + ends[0]) if abs(ends[0] - ends[1]) < AGREED * ends[0] else None


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


def newton(mesh: Mesh, u: np.ndarray, amplitude: np.ndarray, keep: np.ndarray,
           useful: float = USEFUL) -> Optional[Tuple[np.ndarray, float]]:
    """Solves the equation for the coefficients of the modes `keep`, as exactly as the noise and the
    other modes permit.  Returns them and the remaining error, or None if it is not useful."""
    noise = mesh.noise(amplitude)
    before, best = inf, None
    for _ in range(ITERATIONS):
        error = mesh.error(u, amplitude)
        error[abs(error) < noise] = 0
        size = float(np.sqrt((abs(error[:, keep]) ** 2).sum()))
        if size < before:
            best = u, size
        if not size < before / 2 or size == 0:
            return best if best and best[1] < useful else None
        before = size
        u = (u + mesh.correction(u, error)) * keep
        if not abs(u).max() < 100:
            return None
    return None
