"""The error E(u) = u(. + w) - 2 u + u(. - w) + grad V(theta + u) of a torus with many digits, by
python-flint.  It is computed at the midpoints of balls, whose radii are ignored: nothing rests on
it.

A function is evaluated on a mesh by fast Fourier transforms; its coefficients, and one line of
values, are in memory at a time.  Where sigma is real so are the functions of theta, and two
components are transformed as the parts of one complex function.
"""

import operator
from fractions import Fraction
from typing import Dict, Iterator, List, Sequence, Tuple

import numpy as np
from flint import acb, arb, fmpq

from ..model.balls import precision
from .newton import Mesh
from .torus import Torus

ZERO, I = acb(0), acb(0, 1)
Line = List[acb]


def errors(mesh: Mesh, torus: Torus, layers: int, wanted: np.ndarray, bits: int
           ) -> Iterator[np.ndarray]:
    """The coefficients of E in doubles, as the mesh has them, at sigma = e^{2 pi i l/layers} for
    l = 0, ..., layers/2; with one layer at sigma = 0, on a real mesh.

    wanted -- of which modes of the mesh; the others are 0
    bits -- of the midpoints"""
    with precision(bits):
        task = _Task(mesh, torus, wanted, bits)
    for l in range(layers // 2 + 1):
        with precision(bits):
            sigma = (acb(2 * l) / layers).exp_pi_i() if layers > 1 else ZERO
            found = task.error(sigma, 2 * l % layers == 0)
        yield found


class _Task:
    """The data that are the same for all sigma."""

    def __init__(self, mesh: Mesh, torus: Torus, wanted: np.ndarray, bits: int) -> None:
        self.mesh, self.torus, self.wanted = mesh, torus, wanted
        self.shape = (*mesh.sizes, 1)[:2]       # of the matrix of coefficients
        self.line = mesh.sizes[-1]              # values of a line
        # Of all k, and then of all -k, where they stand in the matrix.  Those of column q1 are the
        # numbers entries[part] for the slice part = columns[q1].
        q0, q1 = self._places(np.concatenate([torus.k, -torus.k]).T)
        order = np.argsort(q1, kind="stable")
        self.q0, self.entries = q0[order].tolist(), order.tolist()
        used, begin = np.unique(q1[order], return_index=True)
        self.columns = dict(zip(used.tolist(), map(slice, begin, [*begin[1:], len(order)])))
        kept = self._places(mesh.k[:, wanted])[1]
        self.kept = np.unique([kept, -kept % self.shape[1]]).tolist()
        omega = [_ball((low + high) / 2) for low, high in torus.rotation.turns(bits // 3 + 20)]
        self.turns = [4 * sum(map(operator.mul, k, omega), arb(0)).sin_pi() ** 2
                      for k in torus.k.tolist()]
        unit = arb((1, -torus.bits))
        re, im = torus.numbers.reshape(2, torus.degree + 1, -1).transpose(0, 2, 1).tolist()
        self.series = [[acb(a, b) * unit for a, b in zip(*each)] for each in zip(re, im)]
        step = 2 * arb.pi() / self.line
        self.waves = []                 # k, phase, turns per line, angles along a line
        for (*k, phase), a in zip(torus.potential.waves, mesh.waves):
            across, along = (0, *map(int, a))[-2:]
            angles = [step * (-along * j % self.line) for j in range(self.line)]
            self.waves.append((k[:torus.dimension], phase, across, angles))

    def _places(self, k):
        """Where modes stand in the matrix of coefficients: their first indices, and the second."""
        a = self.mesh.coordinates(k)
        return [x % size for x, size in zip([*a, 0 * a[0]], self.shape)]

    def error(self, sigma: acb, is_real: bool) -> np.ndarray:
        n, (m0, m1) = self.torus.dimension, self.shape
        at_k = self._at(sigma)
        # At -k stands the conjugate of what stands at k where sigma is the conjugate.
        at_minus_k = at_k if is_real else self._at(sigma.conjugate())
        sides = [at_k, [[x.conjugate() for x in each] for each in at_minus_k]]
        if is_real and n == 2:
            sides = [[[x + I * y for x, y in zip(*side)]] for side in sides]
        functions = [[x for side in sides for x in side[at]] for at in range(len(sides[0]))]
        del sides, at_k, at_minus_k
        amplitudes = [_ball(c) + _ball(d) * (sigma.real if is_real else sigma)
                      for c, d in self.torus.amplitudes]
        found = np.zeros((len(functions), m0, m1), complex)
        count = len(self.turns)
        for at, q1, line in self._coefficients(
                self._forces(self._values(functions), amplitudes, is_real), len(functions)):
            part = self.columns.get(q1, slice(0))
            for q0, entry in zip(self.q0[part], self.entries[part]):
                line[q0] -= self.turns[entry % count] * functions[at][entry]
            found[at, :, q1] = list(map(complex, line))
        if is_real:                     # E_0 + i E_1, both real
            other = np.roll(found[0, ::-1, ::-1], 1, (0, 1)).conj()
            found = np.array([(found[0] + other) / 2, (found[0] - other) / 2j][:n])
        found = found.reshape(n, *self.mesh.sizes)[..., :self.mesh.k.shape[-1]]
        return found * self.wanted

    def _at(self, sigma):
        """The coefficients at sigma: of each component those of all modes."""
        count, degree = len(self.torus.k), self.torus.degree
        if degree:
            powers = [sigma ** j for j in range(degree + 1)]
            found = [sum((c * p for c, p in zip(each, powers)), ZERO) for each in self.series]
        else:
            found = [c for c, in self.series]
        return [found[i * count:(i + 1) * count] for i in range(self.torus.dimension)]

    def _forces(self, lines, amplitudes, is_real):
        """Lines of grad V(theta + u) = -sum p_j k_j cos(k_j.x + pi phase_j), from those of u."""
        m0 = self.mesh.points // self.line
        for j0, line in enumerate(lines):
            if is_real:
                line = [[w.real for w in line[0]], *[[w.imag for w in line[0]]] * (
                    self.torus.dimension - 1)]
            force = [[0] * self.line] * self.torus.dimension
            for (k, phase, across, angles), p in zip(self.waves, amplitudes):
                start = arb.pi() * _ball((phase - Fraction(2 * across * j0, m0)) % 2)
                wave = [(x + (start + angle)).cos()
                        for x, angle in zip(_combined(k, line), angles)]
                for i, each in enumerate(k):
                    if each:
                        factor = -p * each
                        force[i] = [f + factor * x for f, x in zip(force[i], wave)]
            if is_real and len(force) == 2:
                force = [[x + I * y for x, y in zip(*force)]]
            yield force

    def _values(self, functions: Sequence[Line]) -> Iterator[List[Line]]:
        """For j0 = 0, ..., m0 - 1, of each function, a line of its values at the angles
        -2 pi (j0/m0, j1/m1); with one angle all its values."""
        m0, m1 = self.shape
        rows: List[Dict[int, Line]] = [{} for _ in functions]
        for row, values in zip(rows, functions):
            for q1, part in self.columns.items():
                column = [ZERO] * m0
                for q0, entry in zip(self.q0[part], self.entries[part]):
                    column[q0] = values[entry]
                row[q1] = acb.dft(column)
        if m1 == 1:                     # one angle
            yield [row.pop(0, [ZERO] * m0) for row in rows]
            return
        for j0 in range(m0):
            found = []
            for row in rows:
                line = [ZERO] * m1
                for q1, column in row.items():
                    line[q1], column[j0] = column[j0], ZERO         # it is not needed again
                found.append(acb.dft(line))
            yield found

    def _coefficients(self, lines: Iterator[List[Line]], count: int
                      ) -> Iterator[Tuple[int, int, Line]]:
        """The inverse of `_values`: (number of the function, q1, column) of the columns that are
        kept."""
        if self.shape[1] == 1:
            for at, line in enumerate(next(lines)):
                yield at, 0, acb.dft(line, inverse=True)
            return
        rows: List[Dict[int, Line]] = [{q1: [] for q1 in self.kept} for _ in range(count)]
        for each in lines:
            for row, line in zip(rows, each):
                line = acb.dft(line, inverse=True)
                for q1 in self.kept:
                    row[q1].append(line[q1])
        for at, row in enumerate(rows):
            for q1 in self.kept:
                yield at, q1, acb.dft(row.pop(q1), inverse=True)


def _ball(x: Fraction) -> arb:
    return arb(fmpq(x.numerator, x.denominator))


def _combined(k, line):
    """k.u for each of the values."""
    (number, each), *rest = [(number, each) for number, each in zip(k, line) if number]
    found = each if number == 1 else [number * x for x in each]
    for number, each in rest:
        found = [x + number * y for x, y in zip(found, each)]
    return found
