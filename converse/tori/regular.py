"""The most regular orbits of a map that are not resonant: there tori are looked for.  All is in
doubles, and nothing is proved.

Every torus that is a graph has a point over each x*.  So orbits are followed that begin over one
x*, and the weighted means of their steps over two halves are compared (csrc/orbits/average.c): the
change from one half to the other is small on a torus, and large on a chaotic orbit.

One angle: an orbit on one side of an invariant circle advances faster than the circle, or slower on
the other side.  So the momentum of each of many noble rotation numbers is found by bisection, and
then by interpolation; near the most regular ones more noble numbers are tried.  An island has a
rational rotation number, and is never met.

Two angles: the momenta are taken from a grid, and then ever nearer to those of the most regular
orbits.  Orbits on islands are regular, too.  Their rotation vectors lie on a resonance k.omega = m
of small integers: such vectors are refused.
"""

from fractions import Fraction
from math import pi
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .._native import ffi, lib
from ..model.potential import FourierSum
from .nearest import cubics, noble
from .newton import best_frame
from .rotation import Rotation
from .torus import rates_of

GRID = 64                               # points of an axis, among which x* is chosen
LIFTED = 1 << 14                        # points of an orbit, of which a torus is made
CALL = 1 << 24                          # C is called for about this many steps at a time.
# One angle.  Nobles between neighbours of the Farey sequence of order FAREY are tried first.
FAREY, ROUNDS, KEPT = 36, 4, 12
GOLDEN = (5 ** 0.5 - 1) / 2
BISECTIONS, SECANTS = 13, 7
FEWEST = 256                            # points of the first bisection; each has GROWTH times more
GROWTH = 1.25
# Points of a half, where a momentum is found and where its orbit is judged: in the first round and
# later.
POINTS = (1024, 1 << 13), (4096, 1 << 15)
# Two angles.  For each stage: how many orbits it keeps, up to which |k_i| resonances are refused,
# and within what.
SIDE, LENGTH = 96, 500                  # the grid, and the points of a half, doubled in each stage
STAGES = ((800, 7, 1e-5), (700, 7, 1e-5), (500, 12, 1e-6), (350, 45, 3e-8), (250, 45, 3e-8),
          (150, 45, 3e-8), (100, 45, 3e-8))
CHILDREN = 4
# Near a rotation vector, within this, NEIGHBOURS vectors of fields are looked for.
WITHIN, NEIGHBOURS = Fraction(1, 1000), 8
WALK, WALKED = 10, 1 << 14               # steps to a rotation vector, points of a half
SEEN = 24                               # |k_i| up to which the decay of their modes is seen
FAR = 0.003                             # |k.omega - m| |k|^2 is larger for good vectors.
APART = 3e-3                            # Vectors that are listed differ by this.
CHAOTIC = 1e-5                          # Orbits that change more are not listed.


class Orbit(NamedTuple):
    """An orbit through x*.

    Attributes
    ----------
    rotation
        Its rotation vector, in turns.
    change
        From one half of it to the other, in turns; on a torus this is little more than rounding.
    momentum
        With which it leaves x*, in turns: the step that follows is the momentum and the force.
    vector
        The exact rotation vector that it has, about, as far as one was chosen.
    """

    rotation: Tuple[float, ...]
    change: float
    momentum: Tuple[float, ...]
    vector: Optional[Rotation] = None


class Orbits:
    """The orbits of a potential through one point x*, where V is about largest: there resonances
    are narrow."""

    def __init__(self, potential: FourierSum) -> None:
        self.n = n = potential.dimension
        self._k = np.array([wave[:2] for wave in potential.waves], np.intc)
        self._size = np.array(potential.amplitude, float) / (2 * pi)
        self._phase = np.array([float(phase % 2) / 2 + 0.25 for *_, phase in potential.waves])
        self.native = ffi.new("cv_waves *", {
            "n": n, "waves": len(self._k), "k": ffi.from_buffer("int[]", self._k),
            "size": ffi.from_buffer("double[]", self._size),
            "phase": ffi.from_buffer("double[]", self._phase)})
        axis = np.arange(GRID) / GRID
        grid = np.zeros((GRID ** n, 2))
        grid[:, :n] = np.stack(np.meshgrid(*[axis] * n, indexing="ij"), -1).reshape(-1, n)
        turns = grid @ self._k.T + self._phase
        self.x = grid[np.argmax(np.cos(2 * pi * turns) @ self._size)]
        force = np.sin(2 * pi * (self._k @ self.x + self._phase)) * self._size @ self._k
        # Time's direction turns a momentum p into 2 centre - p, and the rotation vector round.
        self.centre = -force[:n] / 2

    def rotations(self, momenta: np.ndarray, points: int) -> Tuple[np.ndarray, np.ndarray]:
        """(rotation vectors, changes) of the orbits of momenta (m, n), halves of which have so many
        points."""
        p, x = _pairs(momenta), ffi.from_buffer("double[]", self.x)
        u = (np.arange(points) + 0.5) / points
        weight = np.exp(-1 / (u * (1 - u)))
        weight /= weight.sum()
        means = np.empty((len(p), 2, 2))
        step = max(2, CALL // (2 * points))
        for at in range(0, len(p), step):
            lib.cv_rotations(self.native, x, len(p[at:at + step]),
                             ffi.cast("double(*)[2]", ffi.from_buffer(p[at:at + step])), points,
                             ffi.from_buffer("double[]", weight),
                             ffi.cast("double(*)[2][2]", ffi.from_buffer(means[at:at + step])))
        means = means[..., :self.n]
        return means[:, 1], abs(means[:, 0] - means[:, 1]).sum(1)

    def lift(self, momentum: Sequence[float], points: int) -> np.ndarray:
        """The points (m, n) of an orbit, in turns, not reduced."""
        p, found = _pairs(np.array([momentum])), np.empty((points, 2))
        lib.cv_lift(self.native, ffi.from_buffer("double[]", self.x),
                    ffi.from_buffer("double[]", p), points,
                    ffi.cast("double(*)[2]", ffi.from_buffer(found)))
        return found[:, :self.n]

    def series(self, orbit: Orbit, rotation: Sequence[float],
               reach: int) -> Tuple[np.ndarray, np.ndarray]:
        """(modes k (n, count), coefficients (n, count)) of the u with x = theta + u(theta) along an
        orbit, |k_i| up to a reach: of k and -k one.  They are weighted means over the orbit; theta
        is counted from where u has no mean."""
        points = self.lift(orbit.momentum, LIFTED)
        theta = np.arange(LIFTED)[:, None] * np.array(rotation)
        u = np.arange(0.5, LIFTED) / LIFTED
        weight = np.exp(-1 / (u * (1 - u)))
        u = 2 * pi * (points - theta) * (weight / weight.sum())[:, None]
        axes = [np.arange(0, reach + 1), np.arange(-reach, reach + 1)][:self.n]
        waves = [np.exp(-2j * pi * theta[:, i:i + 1] * axis) for i, axis in enumerate(axes)]
        c = np.array([(waves[0] * each[:, None]).T @ (waves[1] if self.n > 1 else np.ones(
            (LIFTED, 1))) for each in u.T]).reshape(self.n, -1)
        k = np.array(np.meshgrid(*axes, indexing="ij")).reshape(self.n, -1)
        mean = c[:, (k == 0).all(0)][:, 0].real
        wanted = (k[0] > 0) | (k[0] == 0) & (k[-1] > 0)
        k, c = k[:, wanted], c[:, wanted]
        return k, c * np.exp(-1j * mean @ k)


def _pairs(momenta):
    found = np.zeros((len(momenta), 2))
    found[:, :momenta.shape[1]] = momenta
    return found


def regular(orbits: Orbits) -> List[Orbit]:
    """The most regular orbits that are seen, the best first; none if all are chaotic."""
    found = _on_a_line(orbits) if orbits.n == 1 else _on_a_grid(orbits)
    return [orbit for orbit in found if orbit.change < CHAOTIC]


def near_vectors(orbits: Orbits, seen: Sequence[Orbit]) -> List[Orbit]:
    """Orbits of two angles with exact rotation vectors, several near each of those that are seen:
    these may all be regular to rounding, and most vectors near them lie in gaps between the tori.

    The small divisors that matter are those of modes that a torus has.  So lengths are counted as
    the coefficients of the orbit decay."""
    known = []
    for near in seen:
        k, c = orbits.series(near, near.rotation, SEEN)
        size = abs(c).max(0)
        frame = best_frame(k, size)
        m = abs(np.array(frame) @ k)
        norm = np.diag(rates_of(m, np.where(size > CHAOTIC * size.max(), size, 0))) @ frame
        norm /= abs(np.linalg.det(norm)) ** 0.5
        known += [with_rotation(orbits, vector, near)._replace(vector=vector)
                  for vector in cubics(near.rotation, WITHIN, NEIGHBOURS, norm)]
    return [orbit for orbit in known if orbit.change < CHAOTIC]


def with_rotation(orbits: Orbits, rotation: Rotation, near: Optional[Orbit] = None) -> Orbit:
    """The orbit with this rotation vector, as far as there is one.

    near -- for two angles, an orbit with a rotation vector near by, from which it is looked for"""
    w = np.array(rotation.floats)
    if orbits.n == 1:
        p, off, change = _located(orbits, w, *POINTS[1])
        return Orbit(rotation.floats, float(change[0] + off[0]), (float(p[0]),))
    if near is None:
        near = min(_on_a_grid(orbits, w), key=lambda each: abs(each.rotation - w).sum())
    return _walked(orbits, w, near)


# ---- one angle

def _on_a_line(orbits):
    known = {}
    fractions = _farey(FAREY)
    intervals = list(zip(fractions, fractions[1:]))
    for points in (POINTS[0], *[POINTS[1]] * (ROUNDS - 1)):
        new = [each for p, q in intervals for each in ((p, q), (q, p))]
        omega = np.array([(p * GOLDEN + r) / (q * GOLDEN + s) for (p, q), (r, s) in new])
        for interval, w, p, off, change in zip(new, omega, *_located(orbits, omega, *points)):
            known[interval] = Orbit((float(w),), float(off + change), (float(p),))
        best, seen = sorted(known, key=lambda each: known[each].change), []
        intervals = []
        for a, b in best[:KEPT]:
            middle = a[0] + b[0], a[1] + b[1]
            intervals += [pair for pair in ((a, middle), (middle, b)) if pair not in intervals]
    for interval in best:               # a number may belong to several intervals
        orbit = known[interval]
        if len(seen) < KEPT and all(abs(orbit.rotation[0] - other.rotation[0]) > 1e-12
                                    for other in seen):
            seen.append(orbit._replace(vector=noble(interval)))
    return seen


def _farey(order):
    """The fractions (p, q) from 0 to 1/2 with q up to an order."""
    found = sorted({Fraction(p, q) for q in range(1, order + 1) for p in range(q // 2 + 1)})
    return [(each.numerator, each.denominator) for each in found]


def _located(orbits, omega, points, judged):
    """For each rotation number (momentum, distance of its orbit's rotation number, change)."""
    # Momenta between which all rotation numbers from 0 to 1/2 lie.
    low, high = (np.full(len(omega), orbits.centre[0] + end) for end in (-0.25, 0.75))
    low = low + np.floor(omega)
    high = high + np.floor(omega)
    below, above = np.full(len(omega), -1.0), np.full(len(omega), 1.0)
    best, at, side = np.full(len(omega), np.inf), low, np.zeros(len(omega))
    length = float(FEWEST)
    for turn in range(BISECTIONS + SECANTS):
        if turn < BISECTIONS:
            p = (low + high) / 2
        else:                           # false position, with an end's value halved that stays
            p = (low * above - high * below) / (above - below)
            length = points
        off = orbits.rotations(p[:, None], int(length))[0][:, 0] - omega
        length = min(points, GROWTH * length)
        at, best = np.where(abs(off) < best, p, at), np.minimum(best, abs(off))
        up = off > 0
        above = np.where(up, off, np.where(side < 0, above / 2, above))
        below = np.where(up, np.where(side > 0, below / 2, below), off)
        low, high, side = np.where(up, low, p), np.where(up, p, high), np.where(up, 1, -1)
    rotation, change = orbits.rotations(at[:, None], judged)
    return at, abs(rotation[:, 0] - omega), change


# ---- two angles

def _on_a_grid(orbits, target=None):
    """Those of the most regular orbits whose rotation vectors are APART; or, near a target, the
    nearest."""
    random = np.random.default_rng(1)
    i, j = np.divmod(np.arange(SIDE ** 2), SIDE)
    p = orbits.centre + np.column_stack([(i + 0.5) / 2 / SIDE, (j + 0.5) / SIDE])
    width = np.tile([0.5 / SIDE, 1 / SIDE], (len(p), 1))
    for stage, (kept, reach, within) in enumerate(STAGES):
        omega, change = orbits.rotations(p, LENGTH << stage)
        change = np.where(_resonant(omega, reach, within), 1.0, change)
        order = np.argsort(change, kind="stable")[:kept]
        omega, change, p, width = omega[order], change[order], p[order], width[order]
        if stage < len(STAGES) - 1:
            near = np.repeat(p, CHILDREN, 0)
            width = np.repeat(width, CHILDREN, 0)
            near += width * (random.random(near.shape) - 0.5)
            p, width = np.concatenate([p, near]), np.concatenate([2 * width[::CHILDREN], width]) / 2
    return apart([Orbit(tuple(w.tolist()), float(size), tuple(start.tolist()))
                   for w, size, start in zip(omega, change, p)], APART)


def apart(listed, least):
    """Of orbits those whose rotation vectors differ so much from those listed before."""
    found: List[Orbit] = []
    for orbit in listed:
        if all(abs(np.subtract(orbit.rotation, other.rotation)).sum() > least for other in found):
            found.append(orbit)
    return found


def _walked(orbits, omega, near):
    """From an orbit to one with the rotation vector omega: by differences, which become finer as
    the distance shrinks, since between the tori the rotation vector is not defined."""
    p, best = np.array(near.momentum), near
    off = np.array(near.rotation) - omega
    for _ in range(WALK):
        size = abs(off).max()
        width = max(size / 4, 1e-9)
        around = p + width * np.array([(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1)])
        rotation, change = orbits.rotations(around, WALKED)
        here = float(abs(rotation[0] - omega).max() + change[0])
        if here < best.change or best is near:
            best = Orbit(tuple(omega.tolist()), here, tuple(p.tolist()))
        off = rotation[0] - omega
        slope = np.array([rotation[1] - rotation[3], rotation[2] - rotation[4]]).T / (2 * width)
        step = np.linalg.solve(slope, off) if abs(np.linalg.det(slope)) > 1e-3 else off
        p = p - step * min(1, 3 * size / max(abs(step).max(), 1e-300))
    return best


def _resonant(omega, reach, within):
    """Is k.omega nearer to an integer than `within`, or than vectors that are far from resonances
    are, for some integers |k_i| up to a reach that are not 0?"""
    k = np.array([(i, j) for i in range(reach + 1) for j in range(-reach, reach + 1)
                  if (i, j) > (0, 0)])
    least = np.maximum(within, FAR / (k ** 2).sum(1))
    found = np.zeros(len(omega), bool)
    for at in range(0, len(omega), 1024):
        value = omega[at:at + 1024] @ k.T
        found[at:at + 1024] = (abs(value - np.rint(value)) < least).any(1)
    return found
