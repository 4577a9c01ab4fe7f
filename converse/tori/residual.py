"""The residual E(u) = u_+ - 2 u + u_- + grad V(theta + u) of a torus, and its norm, in ball
arithmetic.

A function is evaluated on a grid by fast Fourier transforms of balls, and what the grid cannot see
is bounded by the function's size in a wider strip (docs/existence.md, sections 10 and 13).

The grid.  The modes k of the torus and of the potential lie in the lattice K that the waves' k[j]
generate.  q is the vector of k's coordinates in a basis of K; a function of theta with modes in K
is one of angles chi with k.theta = q.chi, and the grid is chi = -2 pi (j0/M0, j1/M1): no point is
met twice, whatever K is.  A lattice of rank 1, as on the circle, has M0 = 1.

Transforms.  The grid is a matrix of `lines`, and balls are Python objects for no more than this
matrix: the coefficients of the torus are made column by column when they are asked for, and the
values are there one line at a time.  In rank 2 the matrix is the grid.  In rank 1 the M points are
put into a matrix, too, P times Q: with j = j0 + P j1 and q = Q q0 + q1,

    q j/M = q0 j0/P + q1 j0/M + q1 j1/Q   modulo 1,

so a transform is one of each column, a factor e^{-2 pi i q1 j0/M}, and one of each line.

A range of parameters is one more axis.  A polynomial in sigma is a Fourier series in the
angle of sigma = e^{-i psi} whose modes j are not negative; it is sampled at `layers` points, and
neither shifted nor differentiated.
"""

import math
from array import array
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Callable, Dict, Iterator, List, Mapping, Sequence, Tuple

import numpy as np
from flint import acb, arb, fmpq

from ..model.balls import precision
from .divisors import Norm
from .torus import Torus

MOST = 1 << 24              # summands
SLACK = 1 + 2.0 ** -28      # above what MOST + 20 roundings amount to: (1 + 2^-53)^(MOST + 20)
DIGIT = 256                 # |m_i| = coarse DIGIT + fine, of tables of exponentials
TINY = 2.0 ** -1000         # above what underflows lose
ROUND = 1 << 30             # denominator of the widths that are tried
Columns = Mapping[Tuple[int, int], List[acb]]        # (q1, j): the coefficients over q0
Layers = List[List[acb]]                             # of each sigma, the values of a line


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

    @cached_property
    def lines(self) -> Tuple[int, int]:
        """(P, Q): the shape of the matrix that is transformed."""
        if len(self.basis) == 2:
            return self.shape
        rows = 1 << (self.shape[1].bit_length() - 1) // 2
        return rows, self.shape[1] // rows

    def numbers(self, k: Sequence[int]) -> Tuple[int, ...]:
        """m = F k."""
        return tuple(sum(f * each for f, each in zip(row, k)) for row in self.norm.frame)

    def all_numbers(self, k: np.ndarray) -> np.ndarray:
        """m of modes k, both (count, n).

        ValueError: they are so long that |k| is no integer of 64 bits in the units of `_units`."""
        longest = [int(abs(x).max(initial=0)) for x in k.T]
        if sum(unit * sum(abs(f) * each for f, each in zip(row, longest))
               for unit, row in zip(self._units[0], self.norm.frame)) >= 1 << 62:
            raise ValueError("a mode is too long for the weights; take rounder ones")
        return k @ np.array(self.norm.frame, dtype=np.int64).T

    def index(self, k: np.ndarray) -> np.ndarray:
        """q of modes k, (count, 2); ValueError: one of them is not in K."""
        rest, q = self.all_numbers(k), np.zeros((len(k), 2), np.int64)
        for i, row in enumerate(self.basis, 2 - len(self.basis)):
            pivot = next(j for j, each in enumerate(row) if each)
            q[:, i] = rest[:, pivot] // row[pivot]
            rest = rest - q[:, i, None] * np.array(row, dtype=np.int64)
        wrong = rest.any(1)
        if wrong.any():
            raise ValueError("the mode %s is not in the lattice that the waves generate"
                             % (tuple(k[wrong][0].tolist()),))
        return q

    def places(self, q: np.ndarray) -> np.ndarray:
        """(q0, q1), where the modes stand in the matrix of `lines`.  Those of two k inside are
        never the same, but one of their components may be."""
        if len(self.basis) == 2:
            return q % np.array(self.shape)
        rows, size = self.lines
        return np.stack([q[:, 1] // size % rows, q[:, 1] % size], 1)

    def turning(self, q: Sequence[int]) -> Tuple[Fraction, Fraction]:
        """(a0, a1): at the point (j0, j1) of `lines` q.chi is -2 pi (a0 j0 + a1 j1)."""
        rows, size = self.lines
        return Fraction(q[0] if len(self.basis) == 2 else q[1],
                        rows if len(self.basis) == 2 else rows * size), Fraction(q[1], size)

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
        """The same for all k with |k| < size.

        ValueError: |k| is no integer of 64 bits in the units of `_units`."""
        unit, common = self._units
        bound = size * common                   # 'below' is the largest integer below it
        below = math.ceil(bound) - 1
        if below >= 1 << 62:
            raise ValueError("the grid reaches too far for the weights; take rounder ones")
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

    def within(self, m: np.ndarray, size: Fraction) -> np.ndarray:
        """Of each m = F k, is |k| < size?"""
        unit, common = self._units
        return abs(m) @ np.array(unit, dtype=np.int64) < math.ceil(size * common)

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
    """For j0 = 0, ..., P - 1 the values of sum c_qj e^{iq.chi} sigma^j on a line, sigma = e^{-2 pi
    i l/layers}, as a list over l of lists over j1."""
    (m0, m1), layers, turned = grid.lines, grid.layers, _turned(grid, 1)
    rows, line = {}, None
    for q1, j in columns:
        line = columns[q1, j]
        rows[q1, j] = turned(acb.dft(line) if m0 > 1 else list(line), q1)
    del columns, line
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
    m0, layers, turned = grid.lines[0], grid.layers, _turned(grid, -1)
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
            yield q1, j, acb.dft(turned(row, q1), inverse=True)


def _turned(grid: Grid, sign: int) -> Callable[[List[acb], int], List[acb]]:
    """What multiplies the numbers x_j0 of a column q1 by e^{-sign 2 pi i q1 j0/M}: the exponent is
    a multiple of 1/P and one of 1/M below 1/P, from two tables.  In rank 2 there is no factor."""
    if len(grid.basis) == 2:
        return lambda line, q1: line
    m0, m1 = grid.lines
    coarse, fine = ([_root(Fraction(-2 * sign * j, size)) for j in range(count)]
                    for count, size in ((m0, m0), (m1, m0 * m1)))

    def turned(line, q1):
        found = []
        for j0, x in enumerate(line):
            high, low = divmod(q1 * j0, m1)
            found.append(x * coarse[high] * fine[low])
        return found
    return turned


def _root(half_turns: Fraction) -> acb:
    """e^{pi i half_turns}."""
    x = fmpq(half_turns.numerator, half_turns.denominator)
    return acb(arb.cos_pi_fmpq(x), arb.sin_pi_fmpq(x))


def gather(lines: Iterator[Layers], grid: Grid, change: Callable[[int, int, list], None]
           ) -> Tuple[np.ndarray, np.ndarray]:
    """The coefficients of `grid.inside` as complex doubles and what each is off by at most, shape
    (count, layers).  change(q1, j, line) may change a line of `coefficients` before."""
    q = grid.places(grid.inside[0])
    order = np.argsort(q[:, 1], kind="stable")
    kept, begin = np.unique(q[order, 1], return_index=True)
    end, q0 = iter([*begin[1:].tolist(), len(q)]), q[order, 0]
    near, far = ([array("d") for _ in range(grid.layers)] for _ in range(2))
    for q1, j, line in coefficients(lines, grid, kept.tolist()):
        change(q1, j, line)
        if j == 0:
            row = q0[len(far[0]):next(end)].tolist()
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
    return k[0] * omega[0] if len(k) == 1 else k[0] * omega[0] + k[1] * omega[1]


def rotation_balls(torus: Torus, bits: int) -> List[arb]:
    """omega, in turns."""
    return [between(low, high) for low, high in torus.rotation.turns(bits * 302 // 1000 + 5)]


class TorusColumns(Columns):
    """The coefficients of u_0 + i u_1 (of u_0, if n = 1), each column made when it is asked for.
    With u_k = a + ib, u_-k = a - ib in each component: (a_0 - b_1) + i (b_0 + a_1) at k
    and (a_0 + b_1) + i (a_1 - b_0) at -k.

    ValueError: a mode is not in K, or the grid is too small for it."""

    def __init__(self, torus: Torus, grid: Grid) -> None:
        self.unit, self.size = arb((1, -torus.bits)), grid.lines[0]
        self.k, self.series = torus.vectors, list(torus.modes.values())
        q = grid.index(self.k)
        far = ~grid.within(grid.all_numbers(self.k), grid.reach)
        if far.any():
            raise ValueError("the grid of %s points is too small for the mode %s; take a larger "
                             "one, or let the program choose it"
                             % (" x ".join(map(str, grid.shape[-len(grid.basis):])),
                                ", ".join(map(str, self.k[far][0]))))
        if torus.degree >= grid.layers:
            raise ValueError("%d points are too few for the degree %d"
                             % (grid.layers, torus.degree))
        places = grid.places(np.concatenate([q, -q]))
        # k number i is entry i, and -k entry i + count
        self.order = np.argsort(places[:, 1], kind="stable")
        self.q0 = places[self.order, 0]
        columns, begin = np.unique(places[self.order, 1], return_index=True)
        self.parts = dict(zip(columns.tolist(), map(slice, begin, [*begin[1:], len(places)])))
        self.degree = torus.degree

    def __len__(self) -> int:
        return len(self.parts) * (self.degree + 1)

    def __iter__(self) -> Iterator[Tuple[int, int]]:
        return ((q1, j) for q1 in self.parts for j in range(self.degree + 1))

    def entries(self, q1: int) -> Iterator[Tuple[int, int, bool]]:
        """(q0, the number of k, whether -k stands there) of a column."""
        part, count = self.parts.get(q1, slice(0)), len(self.series)
        return ((q0, at % count, at >= count) for q0, at in zip(
            self.q0[part].tolist(), self.order[part].tolist()))

    def __getitem__(self, key: Tuple[int, int]) -> List[acb]:
        (q1, j), line, unit = key, [ZERO] * self.size, self.unit
        for q0, at, negative in self.entries(q1):
            if j < len(self.series[at]):
                a0, b0, *second = self.series[at][j]
                a1, b1 = second or (0, 0)
                re, im = (a0 + b1, a1 - b0) if negative else (a0 - b1, b0 + a1)
                line[q0] = acb(re, im) * unit
        return line


def _forces(torus: Torus, grid: Grid, columns: Columns) -> Iterator[Layers]:
    """The values on the grid of g_0 + i g_1, g = grad V(theta + u) = -sum p_j k_j cos(k_j.x + pi
    phase_j), in the order of `values`.  k_j.theta = q_j.chi is a rational part of 2 pi there."""
    m1, layers = grid.lines[1], grid.layers
    waves = []
    places = grid.index(np.array(wave_vectors(torus), dtype=np.int64)).tolist()
    for k, q, wave, (c, d) in zip(wave_vectors(torus), places, torus.potential.waves,
                                  amplitudes(torus)):
        across, along = grid.turning(q)
        table = [_angle(-2 * along * j) for j in range(m1)]
        factors = []
        for l in range(layers):
            p: Any = ball(c)
            if d:
                sigma = _root(Fraction(-2 * l, layers))
                p = ball(c) + ball(d) * (sigma.real if 2 * l % layers == 0 else sigma)
            factors.append([-p * each for each in k])
        waves.append((k, wave[2], across, table, factors))

    for j0, line in enumerate(values(columns, grid)):
        starts = [_angle(phase - 2 * across * j0) for _, phase, across, _, _ in waves]

        def parts(l):
            (u, v), = pairs([line], l)
            force = [[0] * m1, [0] * m1]
            for (k, _, _, table, factors), start in zip(waves, starts):
                cosine = [(x + (start + angle)).cos()
                          for x, angle in zip(_combined(k, u, v), table)]
                for i, component in enumerate(k):
                    if component:
                        f = factors[l][i]
                        force[i] = [a + f * b for a, b in zip(force[i], cosine)]
            return [(force[0], force[1])]

        yield packed(parts, layers)[0]


def _angle(half_turns: Fraction) -> arb:
    """pi half_turns, modulo 2 pi, in (-pi, pi]."""
    return arb.pi() * ball(1 - (1 - half_turns) % 2)


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
        columns, omega = TorusColumns(torus, grid), rotation_balls(torus, bits)
        sines: Dict[int, List[arb]] = {}            # of one column

        def add_linear(q1, j, line):
            if q1 not in columns.parts or j > columns.degree:
                return
            if q1 not in sines:
                sines.clear()
                sines[q1] = [turns(k, omega).sin_pi() for k in columns.k[
                    [at for _, at, _ in columns.entries(q1)]].tolist()]
            column = columns[q1, j]
            for (q0, _, _), sine in zip(columns.entries(q1), sines[q1]):
                line[q0] -= 4 * sine * sine * column[q0]

        middle, off = gather(_forces(torus, grid, columns), grid, add_linear)
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
        m = Grid(norm, self.wave_vectors, (1, 1)).all_numbers(torus.vectors)
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
        return 2 * self._force(rho, radius) * float(radius) ** -layers, radius

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
