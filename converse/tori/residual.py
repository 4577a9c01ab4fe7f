"""The residual E(u) = u_+ - 2 u + u_- + grad V(theta + u) of a torus, and its norm, in ball
arithmetic.

A function is evaluated on a grid by fast Fourier transforms of balls, and what the grid cannot see
is bounded by the function's size in a wider strip (docs/existence.md, sections 10 and 13).

The grid.  The modes k of the torus and of the potential lie in the lattice K that the waves' k[j]
generate.  q is the vector of k's coordinates in a basis of K; a function of theta with modes in K
is one of angles chi with k.theta = q.chi, and the grid is chi = -2 pi (j0/M0, j1/M1): no point is
met twice, whatever K is.  A lattice of rank 1, as on the circle, has M0 = 1.

A range of parameters is one more axis.  A polynomial in sigma is a Fourier series in the
angle of sigma = e^{-i psi} whose modes j are not negative; it is sampled at `layers` points, and
neither shifted nor differentiated.
"""

import math
from array import array
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Callable, Dict, Iterator, List, Sequence, Tuple

import numpy as np
from flint import acb, arb, ctx, fmpq

from .divisors import Norm
from .torus import Torus

MOST = 1 << 24              # summands
SLACK = 1 + 2.0 ** -28      # above what MOST + 20 roundings amount to: (1 + 2^-53)^(MOST + 20)
DIGIT = 256                 # |m_i| = coarse DIGIT + fine, of tables of exponentials
TINY = 2.0 ** -1000         # above what underflows lose
ROUND = 1 << 30             # denominator of the widths that are tried
Columns = Dict[Tuple[int, int], Dict[int, acb]]      # (q1, j): {q0: coefficient}, modulo the grid
Layers = List[List[acb]]                             # of each sigma, the values along chi_1


@contextmanager
def precision(bits: int):
    """Balls have midpoints of so many bits in this context.  The number is one for all threads."""
    before, ctx.prec = ctx.prec, bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(x: Fraction) -> arb:
    """A rational number, enclosed."""
    x = Fraction(x)
    return arb(fmpq(x.numerator, x.denominator))


def between(low: Fraction, high: Fraction) -> arb:
    """An interval, enclosed."""
    return ball(low).union(ball(high))


def above(x: arb) -> float:
    """A double that is no less than any number of the ball: infinity if the ball is not finite.

    float() rounds the upper end, a number without radius, to the nearest double; SLACK and TINY
    exceed what it can lose."""
    number = float(x.upper())
    if not abs(number) < math.inf:
        return math.inf
    return number * (SLACK if number > 0 else 1 / SLACK) + TINY


# ---- the grid

@dataclass(frozen=True)
class Grid:
    """norm -- of modes, with its frame F; m = F k
    waves -- the k that generate the lattice K
    shape -- (M0, M1), powers of two; M0 = 1 if the rank of K is 1
    layers -- points of sigma, a power of two

    The modes of a function on the grid that are distinguished are those of `inside`: |k| < reach,
    where 2 reach = min |a| over the k = a != 0 with q0 in M0 Z and q1 in M1 Z, which a grid takes
    for 0. Two of them differ by less than 2 reach, so no two are one on the grid."""

    norm: Norm
    waves: Tuple[Tuple[int, ...], ...]
    shape: Tuple[int, int]
    layers: int = 1

    def __post_init__(self) -> None:
        if not all(type(x) is int and x > 0 and not x & (x - 1)
                   for x in (*self.shape, self.layers)):
            raise ValueError("a grid's numbers of points are powers of two, not %r and %r"
                             % (self.shape, self.layers))

    @cached_property
    def basis(self) -> Tuple[Tuple[int, ...], ...]:
        """Of F K in Hermite's normal form: (g,), or (p, r) and (0, s), or one pair."""
        return hermite([self.numbers(k) for k in self.waves])

    def numbers(self, k: Sequence[int]) -> Tuple[int, ...]:
        """m = F k."""
        return tuple(sum(f * each for f, each in zip(row, k)) for row in self.norm.frame)

    def index(self, k: Sequence[int]) -> Tuple[int, int]:
        """q; ValueError: k is not in K."""
        m = self.numbers(k)
        q, rest = [], list(m)
        for row in self.basis:
            pivot = next(i for i, each in enumerate(row) if each)
            q.append(rest[pivot] // row[pivot])
            rest = [a - q[-1] * b for a, b in zip(rest, row)]
        if any(rest):
            raise ValueError("the mode %s is not in the lattice that the waves generate"
                             % (tuple(k),))
        return (0, q[0]) if len(q) == 1 else (q[0], q[1])

    def places(self, k: Sequence[int]) -> Tuple[Tuple[int, int], Tuple[int, int]]:
        """q modulo the grid, of k and of -k.  Those of two k inside are never the same, but one of
        their components may be."""
        (q0, q1), (m0, m1) = self.index(k), self.shape
        return (q0 % m0, q1 % m1), (-q0 % m0, -q1 % m1)

    @cached_property
    def _units(self) -> Tuple[Tuple[int, ...], int]:
        """|k| = sum of unit_i |m_i|, over a denominator, in integers."""
        common = math.lcm(*(Fraction(a).denominator for a in self.norm.alpha))
        return tuple(int(a * common) for a in self.norm.alpha), common

    @cached_property
    def _twice(self) -> int:
        """2 reach in the units of `_units`, exactly."""
        (m0, m1), unit = self.shape, self._units[0]
        if len(self.basis) == 1:
            return m1 * sum(u * abs(b) for u, b in zip(unit, self.basis[0]))
        (p, r), (_, s) = self.basis
        best, t = unit[1] * s * m1, 1
        while unit[0] * p * m0 * t < best:
            rest = r * m0 * t % (s * m1)
            best = min(best, unit[0] * p * m0 * t + unit[1] * min(rest, s * m1 - rest))
            t += 1
        return best

    @cached_property
    def reach(self) -> Fraction:
        return Fraction(self._twice, 2 * self._units[1])

    @cached_property
    def inside(self) -> Tuple[np.ndarray, np.ndarray]:
        """q (count, 2) and m (count, n) of all k of K with |k| < reach.  They are in lexicographic
        order of q, so that reversing the order makes k to -k."""
        return self.ball(self.reach)

    def ball(self, size: Fraction) -> Tuple[np.ndarray, np.ndarray]:
        """The same for all k with |k| < size."""
        unit, common = self._units
        bound = size * common                   # 'below' is the largest integer below it
        below = math.ceil(bound) - 1
        if below < 0:
            return np.zeros((0, 2), np.int64), np.zeros((0, len(unit)), np.int64)
        if len(self.basis) == 1:
            row = np.array(self.basis[0], dtype=np.int64)
            most = below // sum(u * abs(b) for u, b in zip(unit, self.basis[0]))
            q1 = np.arange(-most, most + 1)
            return np.stack([np.zeros_like(q1), q1], 1), q1[:, None] * row
        (p, r), (_, s) = self.basis
        parts = []
        most = below // (unit[0] * p)
        for q0 in range(-most, most + 1):
            room = (below - unit[0] * p * abs(q0)) // unit[1]       # |r q0 + s q1| <= room
            q1 = np.arange(-((room + r * q0) // s), (room - r * q0) // s + 1)
            parts.append(np.stack([np.full_like(q1, q0), q1], 1))
        q = np.concatenate(parts)
        return q, np.stack([p * q[:, 0], r * q[:, 0] + s * q[:, 1]], 1)

    def within(self, k: Sequence[int], size: Fraction) -> bool:
        """Is |k| < size?"""
        unit, common = self._units
        return size.denominator * sum(u * abs(m) for u, m in zip(unit, self.numbers(k))) \
            < size.numerator * common

    @property
    def points(self) -> int:
        return self.shape[0] * self.shape[1] * self.layers


def hermite(vectors: Sequence[Sequence[int]]) -> Tuple[Tuple[int, ...], ...]:
    """A basis of the lattice that vectors of one or two integers generate, in echelon form with
    positive pivots and 0 <= r < s."""
    rest = [tuple(v) for v in vectors if any(v)]
    found: List[Tuple[int, ...]] = []
    for i in range(len(rest[0])):
        lead = [v for v in rest if v[i]]
        rest = [v for v in rest if not v[i]]
        while len(lead) > 1:                        # Euclid's algorithm
            least = min(lead, key=lambda v: abs(v[i]))
            lead.remove(least)
            turned = [tuple(a - v[i] // least[i] * b for a, b in zip(v, least)) for v in lead]
            rest += [v for v in turned if any(v) and not v[i]]
            lead = [v for v in turned if v[i]] + [least]
        if lead:
            found.append(lead[0] if lead[0][i] > 0 else tuple(-a for a in lead[0]))
    if len(found) == 2:
        (p, r), (_, s) = found
        found[0] = p, r % s
    return tuple(found)


# ---- norms

class Sizes:
    """Upper bounds, as doubles, of the lengths of a function's coefficients, up to the rounding of
    at most twenty operations: the constructor adds it.

    m -- (count, n), the modes' numbers in the frame
    size -- (count,) or (count, degree + 1): of each mode, or of each and each power of sigma"""

    def __init__(self, norm: Norm, m: np.ndarray, size: np.ndarray):
        self.norm = norm
        self.m = np.abs(m)
        self.size = (size if size.ndim == 2 else size[:, None]) * SLACK + TINY
        if self.size.size > MOST:
            raise ValueError("%d coefficients, and %d at most are possible; take a smaller grid"
                             % (self.size.size, MOST))

    def norm_at(self, rho: Fraction, radius: Fraction = Fraction(1)) -> float:
        """An upper bound of sum over k and j of |f_kj| e^{rho |k|} radius^j.

        e^{rho alpha_i m} is enclosed by a ball and rounded up; products and the sum of numbers that
        are not negative lose less than (count + 10) 2^-53 of their value in any order, SLACK is
        more."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self._finite((self._by_mode(radius) * self._weights(rho)).sum())

    def sup(self) -> float:
        """An upper bound of the largest sum over j of |f_kj|."""
        return self._finite(self._by_mode(Fraction(1)).max(initial=0))

    def _finite(self, x):
        return float(x) * SLACK + TINY if x < math.inf else math.inf

    def _by_mode(self, radius):
        powers = np.array([above(ball(radius) ** j) if j else 1.0
                           for j in range(self.size.shape[1])])
        return self.size @ powers if len(powers) > 1 else self.size[:, 0]

    def _weights(self, rho):
        found = np.ones(len(self.m))
        for alpha, m in zip(self.norm.alpha, self.m.T):
            with precision(64):
                base = ball(rho * alpha)
                fine, coarse = (np.array([above((base * (step * j)).exp()) for j in range(count)])
                                for step, count in ((1, DIGIT), (
                                    DIGIT, int(m.max(initial=0)) // DIGIT + 1)))
            found *= fine[m % DIGIT] * coarse[m // DIGIT]
        return found


# ---- transforms

ZERO = acb(0)


def values(columns: Columns, grid: Grid) -> Iterator[Layers]:
    """For j0 = 0, ..., M0 - 1 the values of sum c_qj e^{iq.chi} sigma^j at chi = -2 pi (j0/M0,
    j1/M1), sigma = e^{-2 pi i l/layers}, as a list over l of lists over j1."""
    (m0, m1), layers = grid.shape, grid.layers
    rows = {}
    for key, column in columns.items():
        line = [ZERO] * m0
        for q0, c in column.items():
            line[q0] = c
        rows[key] = acb.dft(line) if m0 > 1 else line
    for j0 in range(m0):
        found = [[ZERO] * m1 for _ in range(layers)]
        for (q1, j), line in rows.items():
            found[j][q1] = line[j0]
            line[j0] = ZERO                         # it is not needed again
        if layers > 1:
            for q1 in {q1 for q1, _ in rows}:
                for layer, value in zip(found, acb.dft([layer[q1] for layer in found])):
                    layer[q1] = value
        yield [acb.dft(layer) for layer in found]


def coefficients(lines: Iterator[Layers], grid: Grid, kept: Sequence[int]
                 ) -> Iterator[Tuple[int, int, List[acb]]]:
    """The inverse of `values`: for each q1 of `kept` and each j (q1, j, list over q0)."""
    m0, layers = grid.shape[0], grid.layers
    rows: Dict[int, List[List[acb]]] = {q1: [[] for _ in range(layers)] for q1 in kept} \
        if m0 > 1 else {}
    for line in lines:
        line = [acb.dft(layer, inverse=True) for layer in line]
        for q1 in kept:
            column = [layer[q1] for layer in line]
            if layers > 1:
                column = acb.dft(column, inverse=True)
            for j, value in enumerate(column):
                if m0 > 1:
                    rows[q1][j].append(value)
                else:
                    yield q1, j, [value]
    for q1 in list(rows):
        for j, row in enumerate(rows.pop(q1)):
            yield q1, j, acb.dft(row, inverse=True)


def gather(lines: Iterator[Layers], grid: Grid, change: Callable[[int, int, list], None]
           ) -> Tuple[np.ndarray, np.ndarray]:
    """The coefficients of `grid.inside` as complex doubles and what each is off by at most, shape
    (count, layers).  change(q1, j, line) may change a line of `coefficients` before."""
    q = grid.inside[0] % np.array(grid.shape)
    order = np.argsort(q[:, 1], kind="stable")
    kept, begin = np.unique(q[order, 1], return_index=True)
    end, q0 = iter([*begin[1:].tolist(), len(q)]), q[order, 0].tolist()
    near, far = ([array("d") for _ in range(grid.layers)] for _ in range(2))
    for q1, j, line in coefficients(lines, grid, kept.tolist()):
        change(q1, j, line)
        if j == 0:
            row = q0[len(far[0]):next(end)]
        for place in row:
            c = line[place]
            x = complex(c)
            near[j].append(x.real)
            near[j].append(x.imag)
            far[j].append(above((c - x).abs_upper()))
    middle, off = np.zeros((len(q), grid.layers), complex), np.zeros((len(q), grid.layers))
    middle[order], off[order] = np.array(near).view(complex).T, np.array(far).T
    return middle, off


def unpacked(middle: np.ndarray, off: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From the coefficients of f + i g, f and g real (where sigma is), those of f and g:

        f_k = (h_k + conj h_-k)/2,   g_k = (h_k - conj h_-k)/(2i),

    and what each component is off by at most, with the rounding here.  Axis 0 is that of
    Grid.inside, where -k stands at the place of k from the end."""
    other = middle[::-1].conj()
    f, g = (middle + other) / 2, (middle - other) * -0.5j
    error = (off + off[::-1]) / 2 * SLACK + (abs(f) + abs(g)) * 2.0 ** -50 + TINY
    return f, g, error


def pairs(lines: Sequence[Layers], l: int) -> Iterator[Tuple[list, list]]:
    """The two functions f, g that each function f + i g of `lines` stands for, in layer l.

    f and g are real where sigma is: conj f(sigma) = f(conj sigma), and conj sigma_l = sigma_-l."""
    for layers in lines:
        back = -l % len(layers)
        if back == l:
            yield [w.real for w in layers[l]], [w.imag for w in layers[l]]
            continue
        f, g = [], []
        for w, other in zip(layers[l], layers[back]):
            other = other.conjugate()
            f.append((w + other) / 2)
            g.append((w - other) * HALF_I)
        yield f, g


HALF_I = acb(0, -0.5)                               # 1/(2i)


def packed(parts: Callable[[int], Sequence[Tuple[list, list]]], layers: int) -> List[Layers]:
    """The opposite: of each pair (f, g) that parts(l) gives for a layer, f + i g in all layers."""
    found: List[Layers] = []
    for l in range(layers // 2 + 1):
        back = -l % layers
        for number, (f, g) in enumerate(parts(l)):
            if l == 0:
                found.append([[] for _ in range(layers)])
            if back == l:
                found[number][l] = [acb(a, b) for a, b in zip(f, g)]
            else:
                found[number][l] = [a + I * b for a, b in zip(f, g)]
                found[number][back] = [a.conjugate() + I * b.conjugate() for a, b in zip(f, g)]
    return found


I = acb(0, 1)


# ---- the torus and the map

def amplitudes(torus: Torus) -> List[Tuple[Fraction, Fraction]]:
    """Of each wave (c, d), its amplitude on the torus's piece being c + d sigma."""
    low, high = torus.piece
    part = torus.part or (Fraction(0),) * len(torus.potential.amplitude)
    return [(p + (low + high) / 2 * d, (high - low) / 2 * d)
            for p, d in zip(torus.potential.amplitude, part)]


def wave_vectors(torus: Torus) -> Tuple[Tuple[int, ...], ...]:
    """The k of the waves, as n-tuples."""
    return tuple((k0, k1)[:torus.dimension] for k0, k1, _ in torus.potential.waves)


def turns(k: Sequence[int], omega: Sequence[arb]) -> arb:
    """k.omega, in turns."""
    return sum((int(a) * w for a, w in zip(k, omega)), arb(0))


def rotation_balls(torus: Torus, bits: int) -> List[arb]:
    """omega, in turns."""
    return [between(low, high) for low, high in torus.rotation.turns(bits * 302 // 1000 + 5)]


def torus_columns(torus: Torus, grid: Grid) -> Columns:
    """The coefficients of u_0 + i u_1 (of u_0, if n = 1), exactly.  With u_k = a + ib, u_-k = a -
    ib in each component: (a_0 - b_1) + i (b_0 + a_1) at k and (a_0 + b_1) + i (a_1 - b_0) at -k.

    ValueError: a mode is not in K, or the grid is too small for it."""
    columns: Columns = {}
    exponent, reach = -torus.bits, grid.reach
    for k, series in torus.modes.items():
        if not grid.within(k, reach):
            raise ValueError("the grid of %s points is too small for the mode %s; take a larger "
                             "one, or let the program choose it"
                             % (" x ".join(map(str, grid.shape[-len(grid.basis):])),
                                ", ".join(map(str, k))))
        if len(series) > grid.layers:
            raise ValueError("%d points are too few for the degree %d"
                             % (grid.layers, len(series) - 1))
        places = grid.places(k)
        for j, (a0, b0, *second) in enumerate(series):
            a1, b1 = second or (0, 0)
            for (q0, q1), re, im in zip(places, (a0 - b1, a0 + b1), (b0 + a1, a1 - b0)):
                columns.setdefault((q1, j), {})[q0] = acb(
                    arb((re, exponent)), arb((im, exponent)))
    return columns


def _forces(torus: Torus, grid: Grid) -> Iterator[Layers]:
    """The values on the grid of g_0 + i g_1, g = grad V(theta + u) = -sum p_j k_j cos(k_j.x + pi
    phase_j), in the order of `values`.  k_j.theta = q_j.chi is a rational part of 2 pi there."""
    (m0, m1), layers = grid.shape, grid.layers
    size = max(m0, m1)
    pi = arb.pi()
    waves = []
    for k, wave, (c, d) in zip(wave_vectors(torus), torus.potential.waves, amplitudes(torus)):
        phase = Fraction(wave[2])
        one, start = phase.denominator * size, phase.numerator * size
        table = [pi * arb(fmpq(one - (one - start + 2 * j * phase.denominator) % (2 * one), one))
                 for j in range(size)]
        factors = []
        for l in range(layers):
            p: Any = ball(c)
            if d:
                sigma = acb(arb(fmpq(-2 * l, layers)).cos_pi(), arb(fmpq(-2 * l, layers)).sin_pi())
                p = ball(c) + ball(d) * (sigma.real if 2 * l % layers == 0 else sigma)
            factors.append([-p * each for each in k])
        waves.append((k, grid.index(k), table, factors))

    for j0, line in enumerate(values(torus_columns(torus, grid), grid)):
        def parts(l):
            (u, v), = pairs([line], l)
            force = [[0] * m1, [0] * m1]
            for k, (q0, q1), table, factors in waves:
                at, step = q0 * j0 * (size // m0), q1 * (size // m1)
                cosine = [(x + table[(at + step * j) % size]).cos()
                          for j, x in enumerate(_combined(k, u, v))]
                for i, component in enumerate(k):
                    if component:
                        f = factors[l][i]
                        force[i] = [a + f * b for a, b in zip(force[i], cosine)]
            return [(force[0], force[1])]

        yield packed(parts, layers)[0]


def _combined(k, u, v):
    """k.(u, v) for each of the values."""
    k0, k1 = k if len(k) == 2 else (*k, 0)
    if not k1:
        return u if k0 == 1 else [k0 * a for a in u]
    if not k0:
        return v if k1 == 1 else [k1 * b for b in v]
    if k0 == k1 == 1:
        return [a + b for a, b in zip(u, v)]
    return [k0 * a + k1 * b for a, b in zip(u, v)]


# ---- the residual

@dataclass(frozen=True, eq=False)
class Residual:
    """E(u) of a torus on a grid.

    values -- (count, n, layers), complex doubles: about E_k of `k`, of each power of sigma
    sizes -- of the |E_k|_2 on the grid
    """

    torus: Torus
    grid: Grid
    values: np.ndarray
    sizes: Sizes

    @cached_property
    def k(self) -> np.ndarray:
        """(count, n): all modes inside of the grid."""
        return frame_modes(self.grid, self.grid.inside[1])

    def norm_at(self, rho: Fraction, tail: float) -> float:
        """An upper bound of ||E||_rho, given one of what the grid does not see (Tail.at)."""
        return (self.sizes.norm_at(rho) + tail) * SLACK


def residual(torus: Torus, grid: Grid, bits: int) -> Residual:
    """E(u) on a grid, with balls of so many bits.

    A coefficient of grad V(theta + u) on the grid is the sum of those of all modes that are one on
    the grid; the linear part -4 sin(k.w/2)^2 u_k is exact but for rounding.
    ValueError: a mode of the torus is not in K, or the grid is too small."""
    with precision(bits):
        columns = torus_columns(torus, grid)
        omega = rotation_balls(torus, bits)
        sines = {}
        for k in torus.modes:
            sine = turns(k, omega).sin_pi()
            for place in grid.places(k):
                sines[place] = -4 * sine * sine

        def add_linear(q1, j, line):
            for q0, c in columns.get((q1, j), {}).items():
                line[q0] = line[q0] + sines[q0, q1] * c

        middle, off = gather(_forces(torus, grid), grid, add_linear)
    # h_k of E_0 + i E_1 has |E_k|^2 = (|h_k|^2 + |h_-k|^2)/2
    size = abs(middle) * SLACK + off
    size = np.hypot(size, size[::-1]) * math.sqrt(0.5)      # whose squares do not underflow
    parts = unpacked(middle, off)[:torus.dimension]
    return Residual(torus, grid, np.stack(parts, 1), Sizes(grid.norm, grid.inside[1], size))


def frame_modes(grid: Grid, m: np.ndarray) -> np.ndarray:
    """k of m = F k."""
    frame = np.array(grid.norm.frame, dtype=np.int64)
    if len(frame) == 1:
        return m // frame[0, 0]
    (a, b), (c, d) = frame
    return np.stack([d * m[:, 0] - b * m[:, 1], a * m[:, 1] - c * m[:, 0]], 1) // (a * d - b * c)


# ---- what the grid does not see

class Phases:
    """Bounds of the waves' exponentials e^{ik_j.(theta + u)} in all norms."""

    def __init__(self, torus: Torus, norm: Norm):
        self.torus, self.norm = torus, norm
        self.wave_vectors, self.amplitudes = wave_vectors(torus), amplitudes(torus)
        self.varies = torus.degree > 0 or any(d for _, d in self.amplitudes)
        grid = Grid(norm, self.wave_vectors, (1, 1))
        m = np.array([grid.numbers(k) for k in torus.modes], dtype=np.int64)
        m = m.reshape(-1, torus.dimension)
        unit = 1 << torus.bits
        self._forces: Dict[Tuple[Fraction, Fraction], float] = {}
        self.sizes: Dict[Tuple[int, ...], Sizes] = {}
        for k in set(self.wave_vectors):
            size = np.zeros((len(torus.modes), torus.degree + 1))
            for row, series in enumerate(torus.modes.values()):
                for j, numbers in enumerate(series):
                    re = sum(a * b for a, b in zip(k, numbers[::2])) / unit
                    im = sum(a * b for a, b in zip(k, numbers[1::2])) / unit
                    size[row, j] = 2 * math.hypot(re, im)
            self.sizes[k] = Sizes(norm, m, size)

    def exponential(self, k: Tuple[int, ...], rho: Fraction, radius: Fraction = Fraction(1)) -> arb:
        """g >= ||e^{ik.(theta + u)}||_rho: e^{rho |k|} e^{||k.u||}, for a wave's k."""
        return (ball(rho * self.norm.of(k)) + arb(self.sizes[k].norm_at(rho, radius))).exp()

    def force(self, rho: Fraction, radius: Fraction) -> float:
        """F >= ||grad V(theta + u)||_rho: the sum of |p_j| |k_j|_2 g_j."""
        total = arb(0)
        for k, (c, d) in zip(self.wave_vectors, self.amplitudes):
            p = ball(abs(c) + radius * abs(d))
            total += p * arb(sum(a * a for a in k)).sqrt() * self.exponential(k, rho, radius)
        return above(total)

    def tail(self, grid: Grid, rho: Fraction, wider: Fraction,
             radius: Fraction = Fraction(1)) -> float:
        """What E's norm at rho has beyond the coefficients inside of the grid, at most:

            2 F(wider, 1) e^{-(wider - rho) reach} + 2 F(rho, radius) radius^-layers

        for any wider > rho and radius > 1, the second term only if anything depends on sigma.  A
        coefficient f_kj of grad V(theta + u) that is not inside appears twice: as such, with the
        weight e^{rho|k|}, and at the one place inside that is the same on the grid, if there is
        one, with a smaller or equal weight if |k| >= reach, and the same weight if |k| < reach,
        where j >= layers.  In the first case e^{rho|k|} <= e^{wider|k|} e^{-(wider - rho) reach},
        in the second 1 <= radius^j radius^-layers; and the sums of |f_kj| with the weights
        e^{wider|k|}, and e^{rho|k|} radius^j, are no more than F."""
        if not wider > rho:
            return math.inf
        total = 2 * arb(self._force(wider, Fraction(1))) * ball((rho - wider) * grid.reach).exp()
        if self.varies:
            total += 2 * arb(self._force(rho, radius)) / ball(radius) ** grid.layers
        return above(total)

    def sigma_tail(self, layers: int, rho: Fraction) -> Tuple[float, Fraction]:
        """(the second term, about the least, and the radius for it)."""
        radius = 1 + _lowest(
            lambda x: math.log(self._force(rho, 1 + x)) - layers * math.log1p(x), LADDER)
        return 2 * self._force(rho, radius) / float(radius) ** layers, radius

    def best_tail(self, grid: Grid, rho: Fraction) -> Tuple[float, Fraction, Fraction]:
        """(tail, wider, radius), about the least tail.  Each of its terms is a logarithmically
        convex function of the width or of log radius, and so falls and then rises."""
        wider = _lowest(
            lambda x: math.log(self._force(x, Fraction(1))) - float((x - rho) * grid.reach),
            [x for x in LADDER if x > rho])
        radius = self.sigma_tail(grid.layers, rho)[1] if self.varies else Fraction(1)
        return self.tail(grid, rho, wider, radius), wider, radius

    def _force(self, rho, radius):
        """The force, remembered."""
        if (rho, radius) not in self._forces:
            self._forces[rho, radius] = self.force(rho, radius)
        return self._forces[rho, radius]


LADDER = [Fraction(round(1.03 ** j * ROUND), ROUND) for j in range(-440, 100)]  # 2e-6 ... 18


def _lowest(f: Callable[[Fraction], float], places: Sequence[Fraction]) -> Fraction:
    """The place where f, which falls and then rises, is least."""
    low, high = 0, len(places) - 1
    while low < high:
        middle = (low + high) // 2
        here = f(places[middle])
        if here < math.inf and f(places[middle + 1]) < here:
            low = middle + 1
        else:
            high = middle
    return places[low]
