"""Newton's method for invariant tori on a grid of angles, by fast Fourier transforms.

One step is the step of the theorem's proof (docs/proofs/existence.md), after Levi and Moser, and de
la Llave, Gonzalez, Jorba and Villanueva.  With L = I + Du and A = L(. - w)^T L, the correction
v = L z of the error E solves two equations of the form g(. + w) - g = f, each a division of Fourier
coefficients by e^{i k.w} - 1, and leaves an error of the order of E^2.  It costs some Fourier
transforms; no system of linear equations is solved.

All numbers are doubles.  E(u + v) - E(u) has as many right digits as v, however small v is: that
lets converse/tori/refinement.py correct a torus of many more digits.
"""

from math import ceil, log2
from typing import Any, Iterable, List, Sequence, Tuple

import numpy as np

from ..model.lattice import echelon
from ..model.potential import FourierSum
from .rotation import Rotation

WORD = 64                   # bits of k.omega modulo 1
EPSILON = float(np.finfo(float).eps)
Frame = Tuple[Tuple[int, ...], ...]


def triangular(vectors: Sequence[Sequence[int]], frame: Frame) -> List[Tuple[int, ...]]:
    """A basis of the group that vectors generate, one or two of them.  In the frame's mode numbers
    m = F k the second has the form (0, m1): a basis in Hermite's normal form.

    For a group of one dimension: the one vector."""
    size = len(frame)
    rows = [(*(sum(f * k for f, k in zip(row, vector)) for row in frame), *vector)
            for vector in vectors]
    return [tuple(x if pivot[i] > 0 else -x for x in pivot[size:])
            for i, pivot in enumerate(echelon(rows, size)[0]) if pivot is not None]


def default_frame(potential: FourierSum) -> Frame:
    """The identity; for the waves of the thesis the sum and the difference of both angles, along
    which their tori are smooth to different degrees."""
    if potential.dimension == 1:
        return ((1,),)
    if {(k0, k1) for k0, k1, _ in potential.waves} == {(1, 0), (0, 1), (1, 1)}:
        return (1, 1), (1, -1)
    return (1, 0), (0, 1)


# Frames that are tried: the first is that of Z^2.
FRAMES: Tuple[Frame, ...] = tuple(
    ((a, b), (c, d)) for a, b in ((1, 0), (1, 1), (2, 1), (1, 2), (1, -1))
    for c, d in ((0, 1), (1, -1), (2, -1), (1, -2), (1, 1)) if a * d != b * c)


def best_frame(k: np.ndarray, size: np.ndarray) -> Frame:
    """The frame along whose axes the modes k (2, n) that count fill the smallest rhombus.  Those
    count that are larger than any mode at the edge of the known ones."""
    k = k[:, size > size[abs(k).max(0) == abs(k).max()].max()]

    def rhombus(frame):
        (a, b), (c, d) = frame
        m, aspect = abs(np.array(frame) @ k), np.geomspace(1 / 16, 16, 33)
        reach = (m[0] + aspect[:, None] * m[1]).max(1, initial=1)
        return (reach ** 2 / aspect).min() / abs(a * d - b * c)
    return min(FRAMES, key=rhombus)


def pivots(basis: Sequence[Sequence[int]], frame: Frame) -> List[int]:
    """The diagonal of a basis in mode numbers; 1 for a group of one dimension."""
    if len(basis) == 1:
        return [1]
    return [sum(f * k for f, k in zip(row, vector)) for row, vector in zip(frame, basis)]


def wave_vectors(potential: FourierSum) -> Tuple[Tuple[int, ...], ...]:
    """The k of the waves, as n-tuples."""
    return tuple((k0, k1)[:potential.dimension] for k0, k1, _ in potential.waves)


def sizes_holding(potential: FourierSum, frame: Frame, box: Iterable[float]) -> List[int]:
    """The sizes of the smallest mesh whose mode numbers reach box[i] in each direction: powers of
    two, or five or six eighths of one.  Transforms take a quarter more time for each point of
    these."""
    steps = pivots(triangular(wave_vectors(potential), frame), frame)
    least = [max(2 * reach / step, 8) for reach, step in zip(box, steps)]
    powers = [1 << ceil(log2(each)) for each in least]
    return [next((power * part // 8 for part in (5, 6) if power * part >= 8 * each), power)
            for power, each in zip(powers, least)]


def combined(numbers: Sequence[int], arrays: Any) -> Any:
    """The sum of numbers[i] arrays[i].  Of doubles np.tensordot would ask BLAS, whose threads cost
    more than they bring."""
    return sum(number * array for number, array in zip(numbers, arrays) if number)


def turns(k: np.ndarray, rotation: Rotation) -> np.ndarray:
    """k.omega modulo 1, in (-1/2, 1/2], of integers k (n, ...): exact integers modulo 2^64."""
    total = np.zeros(k.shape[1:], np.int64)
    for each, (low, high) in zip(k, rotation.turns(25)):
        omega = round((low + high) / 2 * 2 ** WORD) % 2 ** WORD
        omega -= 2 ** WORD if omega >= 2 ** (WORD - 1) else 0
        total += each * np.int64(omega)             # numpy's integers wrap round, without a warning
    return total / 2.0 ** WORD


class Mesh:
    """A grid of angles and the modes that it tells apart.

    The modes are the group K of the waves' k_j, with basis b: k = sum of a_i b_i.  The grid has
    sizes[i] points in the direction dual to b_i, even numbers.  Among all k that it does not tell
    apart it takes the one whose mode numbers m = F k are smallest.  With the basis triangular, the
    k of the grid fill a box of m, and nothing is spent on the k of Z^n that are not in K.

    Arrays of coefficients have the shape (components, *shape), those of values the shape
    (components, *sizes).  real: functions are real, so the last index takes one half of its values.

    k -- integers (n, *shape);  m -- the mode numbers (rank of K, *shape); if the rank is 1, those
        along the basis.  |m_i| < half[i] wherever `inside` is true
    back -- 1 - e^{-i k.w};  turn -- 2 - 2 cos k.w
    """

    def __init__(self, potential: FourierSum, rotation: Rotation, frame: Frame,
                 sizes: Sequence[int], real: bool = True) -> None:
        self.potential, self.rotation, self.frame, self.real = potential, rotation, frame, real
        self.vectors = wave_vectors(potential)
        self.sizes = tuple(sizes)
        self.basis = triangular(self.vectors, frame)
        self.axes = tuple(range(-len(self.sizes), 0))
        self.points = int(np.prod(self.sizes))
        index = [np.fft.fftfreq(size, 1 / size).round().astype(np.int64) for size in self.sizes]
        if real:
            index[-1] = np.arange(self.sizes[-1] // 2 + 1)
        a = np.array(np.meshgrid(*index, indexing="ij"))
        steps = pivots(self.basis, frame)
        if len(self.basis) == 2:                # the second mode number is lean a_0 + steps[1] a_1
            lean = sum(f * k for f, k in zip(frame[1], self.basis[0]))
            a[1] -= self.sizes[1] * np.rint((a[1] + lean * a[0] / steps[1])
                                            / self.sizes[1]).astype(np.int64)
        self.k = np.tensordot(np.array(self.basis).T, a, 1)
        self.m = self.numbers(self.k)
        self.half = [step * size / 2 for step, size in zip(steps, self.sizes)]
        self.inside = np.all([abs(m) < half for m, half in zip(self.m, self.half)], 0)
        self.waves = [self.coordinates(np.array(vector)) for vector in self.vectors]
        turn = turns(self.k, rotation)
        self.turn = 4 * np.sin(np.pi * turn) ** 2
        self.back = -np.expm1(-2j * np.pi * turn)
        self.ik = 1j * self.k.astype(float)

    @classmethod
    def holding(cls, potential: FourierSum, rotation: Rotation, frame: Frame,
                box: Iterable[float], real: bool = True) -> "Mesh":
        """The smallest whose mode numbers reach box[i] in each direction (as many numbers as the
        group's rank)."""
        return cls(potential, rotation, frame, sizes_holding(potential, frame, box), real)

    def numbers(self, k: np.ndarray) -> np.ndarray:
        """m of integers k (n, ...)."""
        if len(self.basis) == 2:
            return np.tensordot(np.array(self.frame), k, 1)
        return np.array(self.coordinates(k))

    def coordinates(self, k):
        """The integers a with k = sum of a_i b_i, for an array k of shape (n, ...)."""
        if len(self.basis) == 1:
            i = next(i for i, b in enumerate(self.basis[0]) if b)
            return [k[i] // self.basis[0][i]]
        (p, q), (r, s) = self.basis
        det = p * s - q * r
        return [(k[0] * s - k[1] * r) // det, (p * k[1] - q * k[0]) // det]

    # ---- transforms

    def values(self, coefficients: np.ndarray) -> np.ndarray:
        """From coefficients to values on the grid; leading axes are components."""
        if self.real:
            return np.fft.irfftn(coefficients, s=self.sizes, axes=self.axes, norm="forward")
        return np.fft.ifftn(coefficients, axes=self.axes, norm="forward")

    def coefficients(self, values: np.ndarray) -> np.ndarray:
        transform = np.fft.rfftn if self.real else np.fft.fftn
        return transform(values, axes=self.axes, norm="forward")

    def moved(self, coefficients: np.ndarray, other: "Mesh") -> np.ndarray:
        """The same function on another grid of the group, without the modes that it cannot hold."""
        there = self.inside & (abs(coefficients).max(0) > 0)
        if self.real:
            return other.spread(self.k[:, there], coefficients[:, there])
        found = np.zeros((len(coefficients), *other.k.shape[1:]), coefficients.dtype)
        place, ok = other.index(self.k[:, there])
        found[(slice(None), *(each[ok] for each in place))] = coefficients[:, there][:, ok]
        return found

    def index(self, k: np.ndarray) -> Tuple[List[np.ndarray], np.ndarray]:
        """Where in an array of coefficients the modes k stand, integers (n, ...), and whether the
        grid has them."""
        place = [a % size for a, size in zip(self.coordinates(k), self.sizes)]
        ok = np.ones(k.shape[1:], bool)
        if self.real:
            ok = place[-1] <= self.sizes[-1] // 2
            place[-1] = np.where(ok, place[-1], 0)
        return place, ok & (self.k[(slice(None), *place)] == k).all(0) & self.inside[tuple(place)]

    def spread(self, k: np.ndarray, c: np.ndarray) -> np.ndarray:
        """The coefficients of a real function whose modes k, integers (n, count), have the
        coefficients c, (components, count), and their negatives the conjugates."""
        found = np.zeros((len(c), *self.k.shape[1:]), c.dtype)
        for sign, each in ((1, c), (-1, c.conj())):
            place, ok = self.index(sign * k)
            found[(slice(None), *(x[ok] for x in place))] = each[:, ok]
        return found

    def positive(self, keep: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Where the modes of `keep` stand, one of k and -k: flat indices, and whether the one that
        stands there is the lexicographically positive one."""
        sign = np.zeros(self.k.shape[1:], np.int64)
        for k in self.k:
            sign = np.where(sign == 0, np.sign(k), sign)
        # where the last index is 0 or half of the size, both are there
        twice = 2 * self.coordinates(self.k)[-1] % self.sizes[-1] == 0 if self.real else sign != 0
        at = np.flatnonzero(keep & self.inside & (sign > 0) | keep & self.inside & (sign < 0)
                            & ~twice)
        return at, sign.ravel()[at] > 0

    # ---- the equation

    def error(self, u: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
        """The coefficients of E(u) = u(. + w) - 2 u + u(. - w) + grad V(theta + u)."""
        values = self.values(u)

        def force(phase, vector):
            return np.cos(phase + combined(vector, values))

        return self._linear(u) + self._force(force, values, amplitude)

    def change(self, u: np.ndarray, v: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
        """E(u + v) - E(u), to as many digits as v has: cos(a + s) - cos a is
        -2 sin(a + s/2) sin(s/2)."""
        values, step = self.values(u), self.values(v)

        def force(phase, vector):
            half = combined(vector, step) / 2
            return -2 * np.sin(phase + combined(vector, values) + half) * np.sin(half)

        return self._linear(v) + self._force(force, values, amplitude)

    def _linear(self, u):
        return -self.turn * u * self.inside

    def _force(self, cosine, like, amplitude):
        """The coefficients of - sum of p_j k_j cosine(k_j.theta + pi phase_j, k_j)."""
        force = np.zeros_like(like)
        n = self.potential.dimension
        for wave, a, p in zip(self.potential.waves, self.waves, amplitude.astype(like.dtype)):
            phase = float(wave[2] % 2) / 2
            for i, (number, size) in enumerate(zip(a, self.sizes)):
                along = np.arange(size) * number % size / size
                phase = phase + along.reshape([-1 if j == i else 1 for j in range(len(a))])
            found = cosine(2 * np.pi * (phase - np.rint(phase)), wave[:n])
            for i in range(n):
                if wave[i]:
                    force[i] -= p * wave[i] * found
        return self.coefficients(force) * self.inside

    def noise(self, amplitude: np.ndarray) -> float:
        """About the largest rounding error of a coefficient of `error`: the errors of many values
        add up like random numbers."""
        force = sum(float(abs(p)) * max(map(abs, wave[:2]))
                    for p, wave in zip(amplitude, self.potential.waves))
        return self._rounding() * force

    def _rounding(self):
        """The rounding error of coefficients, in terms of the values."""
        return 4 * EPSILON * (log2(self.points) / self.points) ** 0.5

    def _clean(self, values):
        """Their coefficients, without those that are rounding errors, which small divisors would
        magnify."""
        found = self.coefficients(values)
        size = float(np.sqrt((abs(values) ** 2).mean()))
        found[abs(found) < self._rounding() * size] = 0
        return found

    def frames(self, u: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """L = I + Du and A = L(. - w)^T L on the grid, and the coefficients of Du; in doubles."""
        n = len(u)
        one = np.eye(n).reshape(n, n, *(1,) * len(self.sizes))
        du = u[:, None] * self.ik[None]
        L = self.values(du) + one
        before = self.values(du * (1 - self.back)) + one
        return L, _product(before.swapaxes(0, 1), L), du

    def correction(self, u: np.ndarray, error: np.ndarray) -> np.ndarray:
        """The coefficients of v, in doubles, so that u + v solves the equation to second order.
        The average of v is 0."""
        zero: tuple = (0,) * len(self.sizes)
        scale = float(abs(error).max()) or 1.0
        error = error / scale
        L, A, du = self.frames(u)
        inverse = inverted(A)
        safe = self.back.copy()
        safe[zero] = 1
        g = self._clean(_apply(L.swapaxes(0, 1), self.values(error)))
        g *= (1 - self.back) / safe                  # divided by e^{i k.w} - 1
        g[(slice(None), *zero)] = 0
        g = self.values(g)
        g = _apply(inverse, g)
        mean = tuple(range(2, 2 + len(self.sizes)))
        C = np.linalg.solve(inverse.mean(mean), g.mean(self.axes))
        y = self._clean(_apply(inverse, C) - g)
        z = y / safe
        z[(slice(None), *zero)] = 0
        v = self.coefficients(_apply(L, self.values(z)))
        average = v[(slice(None), *zero)]
        v = v - _apply(du, average)
        v[(slice(None), *zero)] = 0
        return v * self.inside * scale


def _product(a, b):
    return np.array([[sum(a[i, j] * b[j, l] for j in range(len(a))) for l in range(len(a))]
                     for i in range(len(a))])


def _apply(a, v):
    return np.array([sum(a[i, j] * v[j] for j in range(len(v))) for i in range(len(v))])


def inverted(a: np.ndarray) -> np.ndarray:
    """The inverses of matrices, which are the first two axes."""
    if len(a) == 1:
        return 1 / a
    (p, q), (r, s) = a
    return np.array([[s, -q], [-r, p]]) / (p * s - q * r)
