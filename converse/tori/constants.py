"""The constants of a torus that the theorem needs besides its residual, in ball arithmetic:

    l0 >= ||L||,   m0 >= ||L^-1||,   a0 >= ||A^-1||,   b0 >= |<A^-1>^-1|,   p0 >= sup_{k != 0}
    |(A^-1)_k|,

where L = I + Du and A = L_-^T L, all at one width rho and with sums over the powers of sigma if
there is a range of parameters (docs/existence.md, section 11).  The series that they come from do
not depend on rho and are computed once.

Products are taken on a grid on which no two of their modes are one, so nothing is lost but by
rounding, which the balls enclose.  A matrix of functions is a list of rows, and a row (f, g) is the
function f + i g (f alone if n = 1).
"""

import math
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any, List, Optional, Tuple

import numpy as np
from flint import acb, arb

from ..model.balls import precision
from .divisors import Norm
from .residual import (TINY, ZERO, Columns, Grid, Layers, Sizes, frame_modes, gather, packed, pairs,
                       rotation_balls, turns, unpacked, values, wave_vectors)
from .torus import Torus

BITS = 64                   # of the balls: the constants are needed to a per cent


@dataclass(frozen=True)
class Constants:
    """The numbers at width rho, upper bounds all; eta bounds ||I - L M||, which made them so."""

    rho: Fraction
    l0: float
    m0: float
    a0: float
    b0: float
    p0: float
    eta: float

    def near(self, other: "Constants") -> bool:
        """Are they the other's, to two per cent?"""
        return all(abs(x - y) < 0.02 * y for x, y in (
            (self.l0, other.l0), (self.m0, other.m0), (self.a0, other.a0), (self.b0, other.b0),
            (1 + self.p0, 1 + other.p0)))


class Inverse:
    """An approximate inverse M of L with finitely many modes, and what is needed of the products by
    which L^-1 and A^-1 = L^-1 (L^-1)_-^T are known.

    M is proposed by doubles, and is what these doubles say.  With K' the modes |k| < cut, L~ being
    L cut to K' and to powers of sigma up to `degree`, and M's modes and powers being such, too, L~
    M and N = M M_-^T have modes |k| < 2 cut = reach of the grid and powers below `layers`, so that
    each is alone on the grid.

    torus, norm -- as elsewhere
    shape, layers -- of the grid
    """

    def __init__(self, torus: Torus, norm: Norm, shape: Tuple[int, int], layers: int = 1):
        n, degree = torus.dimension, (layers - 1) // 2
        self.grid = grid = Grid(norm, wave_vectors(torus), shape, layers)
        self.cut = grid.reach / 2
        self._slopes(torus, norm, degree)
        with precision(BITS):
            of_l = _jacobian(torus, grid, self.cut, degree)
            of_m, back, series = _proposal(of_l, torus, grid, self.cut, degree)
            rest: List[List[Layers]] = [[] for _ in range(n)]
            product: List[List[Layers]] = [[] for _ in range(n)]
            lines = [[values(row, grid) for row in each] for each in (of_l, of_m, back)]
            del of_l, of_m, back                    # values() drops them, too, when it has begun
            for _ in range(grid.lines[0]):
                l, m, m_back = ([next(row) for row in each] for each in lines)
                for found, x, y, across in (rest, l, m, False), (product, m, m_back, True):
                    line = packed(partial(_layer, x, y, across), layers)
                    for row, each in zip(found, line):
                        row.append(each)
            self.m = self._matrix(series)[0]
            self.rest = self._matrix([
                gather(iter(row), grid, partial(_subtract, one))
                for row, one in zip(rest, (acb(1), acb(0, 1)))])[0]
            self.product, mean, off = self._matrix(
                [gather(iter(row), grid, lambda *_: None) for row in product])
        self.mean, self.mean_off = mean, off
        self.others = Sizes(norm, self.product.m, np.where(
            self.product.m.any(1)[:, None], self.product.size, 0))
        self.inverse_mean = _inverse_mean(mean)

    def _slopes(self, torus, norm, degree):
        """Sizes of Du: (Du)_k = i u_k k^T has the spectral norm |u_k|_2 |k|_2; and of L - L~."""
        unit, m = 1 << torus.bits, self.grid.all_numbers(torus.vectors)
        size = np.zeros((len(torus.modes), torus.degree + 1))
        for row, (k, series) in enumerate(torus.modes.items()):
            length = math.sqrt(sum(a * a for a in k))
            for j, numbers in enumerate(series):
                size[row, j] = 2 * length * math.hypot(*(x / unit for x in numbers))
        self.slopes = Sizes(norm, m, size)
        near, rest = self.grid.within(m, self.cut), size.copy()
        rest[near, :degree + 1] = 0
        self.cut_off = Sizes(norm, m, rest)

    def _matrix(self, rows):
        """(Sizes, the coefficients of the mode 0, what these are off by) of a matrix of functions,
        from the coefficients of its packed rows."""
        m = self.grid.inside[1]
        if len(rows) == 1:
            f, _, error = unpacked(*rows[0])
            entries, off = f[:, None, None], error
        else:
            (a, b, e0), (c, d, e1) = (unpacked(*row) for row in rows)
            entries = np.stack([np.stack([a, b], 1), np.stack([c, d], 1)], 1)
            off = 2 * (e0 + e1)
        zero = len(m) // 2
        return (Sizes(self.grid.norm, m, spectral(entries) + off),
                entries[zero], float(off[zero].sum()) * 1.001)

    def at(self, rho: Fraction) -> Optional[Constants]:
        """The constants; None if M is no good inverse at this width.

        With eta >= ||I - L~ M|| + ||L - L~|| ||M||: L^-1 = M sum (I - L M)^i, so that
        m0 = ||M||/(1 - eta), and dm = ||M|| eta/(1 - eta) >= ||L^-1 - M||.  From
        A^-1 - N = (L^-1 - M)(L^-1)_-^T + M (L^-1 - M)_-^T follows err = dm (m0 + ||M||) for A^-1 -
        N and each of its coefficients.  With Z the approximate inverse of N_0, (<A^-1>) Z differs
        from I by |I - N_0 Z| + err |Z| at most."""
        with precision(BITS):
            m = arb(self.m.norm_at(rho))
            eta = arb(self.rest.norm_at(rho)) + arb(self.cut_off.norm_at(rho)) * m
            if not eta < 1:
                return None
            m0 = m / (1 - eta)
            err = m * eta / (1 - eta) * (m0 + m)
            z, eta_z = self.inverse_mean
            left = 1 - arb(eta_z) - (err + self.mean_off) * arb(z)
            if not left > 0:
                return None
            found = [1 + arb(self.slopes.norm_at(rho)), m0,
                     arb(self.product.norm_at(rho)) + err, arb(z) / left,
                     arb(self.others.sup()) + err, eta]
            return Constants(rho, *(float(x.upper()) * (1 + 2.0 ** -50) for x in found))


def spectral(entries: np.ndarray) -> np.ndarray:
    """The spectral norms of 1 x 1 or 2 x 2 matrices in axes 1 and 2, from above but for 2^-40 of
    each.  The square of a 2 x 2 matrix's is (S + root(S^2 - 4 |det|^2))/2, S the sum of squares;
    what rounding takes from the root's argument is less than 1e-13 S^2.  The largest entry is made
    about 1 before, so that nothing underflows that counts."""
    if entries.shape[1] == 1:
        return abs(entries[:, 0, 0])
    largest = abs(entries).max((1, 2)) + TINY
    entries = entries / largest[:, None, None]
    square = (entries.real ** 2 + entries.imag ** 2).sum((1, 2))
    det = entries[:, 0, 0] * entries[:, 1, 1] - entries[:, 0, 1] * entries[:, 1, 0]
    inner = np.maximum(square ** 2 - 4 * (det.real ** 2 + det.imag ** 2), 0) + 1e-13 * square ** 2
    return largest * np.sqrt((square + np.sqrt(inner)) / 2)


def _jacobian(torus: Torus, grid: Grid, cut: Fraction, degree: int) -> List[Columns]:
    """The rows of L, cut: (L_ab)_k = i u_k,a k_b, and I at k = 0."""
    n, exponent = torus.dimension, -torus.bits
    rows: List[Columns] = [_columns(grid) for _ in range(n)]
    for row, one in zip(rows, (acb(1), acb(0, 1))):
        row[0, 0][0] = one
    near = np.flatnonzero(grid.within(grid.all_numbers(torus.vectors), cut))
    series, q = list(torus.modes.values()), grid.index(torus.vectors[near])
    for at, k, *places in zip(near.tolist(), torus.vectors[near].tolist(),
                              grid.places(q).tolist(), grid.places(-q).tolist()):
        factor = acb(-k[1] if n == 2 else 0, k[0])          # i (k_0 + i k_1)
        for j, numbers in enumerate(series[at][:degree + 1]):
            for row, re, im in zip(rows, numbers[::2], numbers[1::2]):
                for (q0, q1), sign in zip(places, (1, -1)):
                    c = acb(arb((re, exponent)), arb((sign * im, exponent)))
                    row[q1, j][q0] = sign * factor * c
    return rows


def _columns(grid: Grid) -> Columns:
    """Columns of zeros."""
    return defaultdict(lambda: [ZERO] * grid.lines[0])


def _proposal(rows: List[Columns], torus: Torus, grid: Grid, cut: Fraction, degree: int
              ) -> Tuple[List[Columns], List[Columns], List[Tuple[np.ndarray, np.ndarray]]]:
    """M, about L^-1, and M_-: each a list of rows; and those of M as `gather` gives functions."""
    n, size = torus.dimension, (*grid.shape, grid.layers)
    parts = []
    for row in rows:
        table = np.zeros((*grid.lines, grid.layers), complex)
        for (q1, j), column in row.items():
            table[:, q1, j] = list(map(complex, column))
        table = np.fft.fftn(table.reshape(size))            # in rank 1 the lines follow each other
        other = table[:, :, -np.arange(size[2])].conj()
        parts.append([(table + other) / 2, (table - other) / 2j])
    if n == 1:
        inverse = [1 / parts[0][0]]
    else:
        (l00, l01), (l10, l11) = parts
        det = l00 * l11 - l01 * l10
        inverse = [(l11 - 1j * l01) / det, (1j * l00 - l10) / det]
    q, m = grid.inside
    near = grid.within(m, cut)
    q, omega = q[near], rotation_balls(torus, BITS)
    places, at = grid.places(q).tolist(), tuple((q % np.array(grid.shape)).T)
    shift = []
    for k in frame_modes(grid, m[near]).tolist():
        sine, cosine = (-2 * turns(k, omega)).sin_cos_pi()
        shift.append(acb(cosine, sine))
    found, back, series = [], [], []
    for table in inverse:
        numbers: Any = np.fft.ifftn(table)[at][:, :degree + 1]
        straight, turned = _columns(grid), _columns(grid)
        for (q0, q1), powers, factor in zip(places, numbers, shift):
            for j, number in enumerate(powers.tolist()):
                straight[q1, j][q0] = acb(number)
                turned[q1, j][q0] = acb(number) * factor
        found.append(straight)
        back.append(turned)
        middle = np.zeros((len(m), grid.layers), complex)
        middle[near, :degree + 1] = numbers
        series.append((middle, np.zeros(middle.shape)))
    return found, back, series


def _subtract(one, q1, j, line):
    """X - I instead of X, in the row whose part of I is `one`."""
    if q1 == j == 0:
        line[0] = line[0] - one


def _layer(x, y, across, l):
    """The rows of X Y or X Y^T in layer l."""
    return _times(list(pairs(x, l)), list(pairs(y, l)), across)


def _times(x, y, across):
    """X Y, or X Y^T: matrices as lists of rows, whose entries are lists of values."""
    if len(x) == 1:
        (f, zeros), (g, _) = x[0], y[0]
        return [([a * b for a, b in zip(f, g)], zeros)]
    (e, f), (g, h) = y
    if across:
        f, g = g, f
    return [([a * p + b * r for a, b, p, r in zip(v, w, e, g)],
             [a * p + b * r for a, b, p, r in zip(v, w, f, h)]) for v, w in x]


def _inverse_mean(mean: np.ndarray) -> Tuple[float, float]:
    """Of N_0, a polynomial in sigma of n x n matrices (n, n, layers) of doubles: |Z| and |I - N_0
    Z| for an approximate inverse Z, bounded above, the norms being sums over the powers of
    sigma."""
    n, _, layers = mean.shape
    at = np.moveaxis(np.fft.fft(mean, axis=2), 2, 0)
    try:
        z = np.moveaxis(np.fft.ifft(np.linalg.inv(at), axis=0), 0, 2)
    except np.linalg.LinAlgError:
        return math.inf, math.inf
    total = arb(0)
    for power in range(2 * layers - 1):
        for a in range(n):
            for b in range(n):
                entry = acb(-1 if power == 0 and a == b else 0)
                for j in range(max(0, power - layers + 1), min(power, layers - 1) + 1):
                    for c in range(n):
                        entry += acb(complex(mean[a, c, j])) * acb(complex(z[c, b, power - j]))
                total += entry.abs_upper()          # their sum is no less than the norm
    size = (spectral(np.moveaxis(z, 2, 0)) * (1 + 2.0 ** -30)).sum() * (1 + 2.0 ** -30) + TINY
    return float(size), float(total.upper()) * (1 + 2.0 ** -50)
