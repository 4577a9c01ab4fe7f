"""A second judge of certificates of tori: python tests/judge_of_tori.py FILE

It shares nothing with converse/check, which multiplies series of integers.  Here functions are
balls (python-flint) on a grid of angles, and the norm of a wider strip bounds the modes that the
Fourier transform of a grid cannot see.  Numbers in brackets are those of docs/proofs/existence.md;
docs/reference/torus-certificate.md has the format.  One or two angles, without a parameter."""

import gzip
import hashlib
import itertools
import math
import sys
from collections import namedtuple
from fractions import Fraction

from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_mat, fmpz_poly

SPARE_BITS = 128
SEEN = {1: 1 << 14, 2: 400}         # The divisors of |k| up to this are looked at.
EDGE_PIECES = 256
WIDER = 1.1, 1.4, 2, 3, 4, 5, 6     # strips for the modes that a grid does not see
MOST_POINTS, UNSEEN = 1 << 20, 1e-17    # of a grid, and what it may not see

Certificate = namedtuple("Certificate", "n waves polynomial root rotation frame alpha rho bits u")


class Refused(Exception):
    """The certificate is wrong, or this judge cannot confirm it."""


def demand(holds, words):
    if not holds:
        raise Refused(words)


# ---- the file

def read(data):
    """The certificate in the bytes."""
    data = gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data
    end = data.rfind(b"checksum: ")
    demand(data.startswith(b"converse torus 1\n") and data[end:] == b"checksum: sha256 %s\nend\n"
           % hashlib.sha256(data[:end]).hexdigest().encode(), "the checksum is not that of a torus")
    header, _, body = data[:end].decode("ascii").partition("\ntori:\n")
    fields = {}
    for name, value in (line.split(": ", 1) for line in header.split("\n")[1:]):
        fields.setdefault(name, []).append(value)

    def rows(name, count=None):
        found = [list(map(Fraction, text.split())) for text in fields[name]]
        demand(count is None or len(found) == count, "%d fields %s" % (len(found), name))
        return found

    ((n,),), ((pieces,),) = rows("dimension", 1), rows("pieces", 1)
    n, waves = int(n), [wave for wave in rows("wave") if wave[3:] != [0]]
    demand(n in (1, 2) and pieces == 1 and {len(wave) for wave in waves} == {4},
           "not of one or two angles without a parameter")
    demand(any(wave[1] for wave in waves) == (n == 2), "not of this dimension")
    (polynomial,), (root,), rotation = rows("polynomial", 1), rows("root", 1), rows("rotation", n)
    (frame,), (alpha,), ((rho,),) = rows("frame", 1), rows("alpha", 1), rows("rho", 1)
    demand(len(polynomial) == n + 2 and len(root) == 2 and all(len(x) == n + 1 for x in rotation)
           and len(frame) == n * n and len(alpha) == n and min(alpha) > 0 < rho
           and all(x.denominator == 1 for x in polynomial + frame), "no such fields")
    piece, *lines = body.rstrip("\n").split("\n")
    word, low, high, bits, degree, count = piece.split()
    demand((word, low, high, degree, int(count)) == ("piece", "0", "0", "0", len(lines)), piece)
    u = {}
    for words in map(str.split, lines):
        k, numbers = tuple(map(int, words[:n])), [int(x, 16) for x in words[n + 1:]]
        demand(k not in u and k > (0,) * n and words[n] == "0" and len(numbers) == 2 * n,
               "the mode %s" % " ".join(words))
        u[k] = tuple(zip(numbers[::2], numbers[1::2]))
    return Certificate(n, [(tuple(map(int, wave[:n])), *wave[2:]) for wave in waves],
                       list(map(int, polynomial)), root, rotation,
                       [list(map(int, frame[i * n:i * n + n])) for i in range(n)], alpha, rho,
                       int(bits), u)


# ---- numbers

def ball(x):
    return arb(fmpq(x.numerator, x.denominator)) if isinstance(x, Fraction) else arb(x)


def upper(x):
    return arb(x).upper()


def length(k):
    return arb(sum(i * i for i in k)).sqrt()


def size(entries):
    """At least the Euclidean length of a vector of one or two numbers, or the spectral norm of a
    matrix of one or four."""
    total = upper(sum(x.real * x.real + x.imag * x.imag for x in entries))
    if len(entries) < 4:
        return total.sqrt().upper()
    a, b, c, d = entries
    gap = (total * total - 4 * abs(a * d - b * c).lower() ** 2).upper()
    return ((total + max(gap, arb(0)).sqrt()) / 2).sqrt().upper()


# ---- small divisors, section 9

class Rotation:
    """omega, in turns, and the divisors of all k.  A mode is here kappa = frame k, of the norm
    sum alpha_i |kappa_i| (4)."""

    def __init__(self, found):
        n, self.n = found.n, found.n
        self.alpha = list(map(ball, found.alpha))
        frame = fmpq_mat(n, n, [fmpq(x) for row in found.frame for x in row])
        demand(frame.det() != 0, "the frame has determinant 0")
        self.back = frame.inv().tolist()
        self.kappa = max((sum(arb(row[i]) ** 2 for row in self.back).sqrt() / self.alpha[i]).upper()
                         for i in range(n))
        chi = fmpz_poly(found.polynomial)
        demand([x.degree() for x, _ in chi.factor()[1]] == [chi.degree()] == [n + 1],
               "the polynomial is reducible")
        roots = [x for x, _ in chi.complex_roots()]
        inside = [x for x in roots if x.imag == 0 and ball(found.root[0]) < x.real
                  and x.real < ball(found.root[1])]
        demand(len(inside) == 1, "not one root is between the ends")
        others = [x for x in roots if x.imag != 0 or not x.real.overlaps(inside[0].real)]
        demand(len(others) == n, "the roots are not told apart")
        demand(fmpq_mat(n, n, [fmpq(x.numerator, x.denominator) for row in found.rotation
                               for x in row[1:]]).det() != 0, "omega is resonant")

        def vector(t):
            return [sum((ball(r) * t ** i for i, r in enumerate(row)), acb(0))
                    for row in found.rotation]

        self.omega = [x.real for x in vector(inside[0])]
        self.conjugates = [[x - y for x, y in zip(vector(t), self.omega)] for t in others]
        D = self.denominator(found.polynomial, found.rotation)
        Q, mu = arb(0), arb(0)
        for i, signs in itertools.product(range(EDGE_PIECES), ((1, 1), (1, -1))[:n]):
            share = arb(arb(2 * i + 1) / (2 * EDGE_PIECES), arb(1) / (2 * EDGE_PIECES))
            point = [share / self.alpha[0], signs[1] * (1 - share) / self.alpha[-1]][:n] \
                if n == 2 else [1 / self.alpha[0]]
            k = [sum(arb(x) * y for x, y in zip(row, point)) for row in self.back]
            sizes = [abs(sum(x * y for x, y in zip(each, k))).upper() for each in self.conjugates]
            Q, mu = max(Q, upper(math.prod(sizes))), max(mu, upper(sum(sizes)))
        last = arb(SEEN[n])
        g = 1 / (D * Q)
        gamma = (1 / arb(D) / (Q + (g * mu / last ** 3 + g * g / last ** 6 if n == 2
                                    else g / last ** 2))).lower()                       # (27)
        near = gamma / last ** n
        demand(near < arb(1) / 2, "too few divisors are looked at")
        self.Gamma = (2 * arb.pi() * gamma * (1 - (arb.pi() * near) ** 2 / 6)).lower()   # (28)
        self.seen, least = [], arb(10)
        for far, mode in sorted(self.modes(found.alpha)):
            divisor = (2 * abs((arb.pi() * self.turns(mode)).sin())).lower()
            if divisor < least:                     # the others count less than this one
                self.seen.append((ball(far), divisor))
                least = divisor
        demand(least > 0, "a divisor may be 0")

    def wavenumber(self, mode):
        """k of kappa, as rationals."""
        return [sum(x * y for x, y in zip(row, mode)) for row in self.back]

    def turns(self, mode):
        """k . omega."""
        return sum((x * arb(k) for x, k in zip(self.omega, self.wavenumber(mode))), arb(0))

    def modes(self, alpha):
        """(|k|, kappa) of all k to be looked at, one of k and -k."""
        last = SEEN[self.n]
        for mode in itertools.product(range(int(last / alpha[0]) + 1), *[
                range(-int(last / a), int(last / a) + 1) for a in alpha[1:]]):
            far = sum(a * abs(x) for a, x in zip(alpha, mode))
            if 0 < far <= last and all(k.q == 1 for k in self.wavenumber(mode)):
                yield far, mode

    def denominator(self, polynomial, rotation):
        """A D so that D times the norm (26), the determinant of p + k . omega as a matrix, is whole
        for all whole p and k, as it is where none is negative and their sum is at most n + 1."""
        m = self.n + 1
        t = fmpq_mat(m, m, [fmpq(j == i + 1) if i < m - 1 else fmpq(-polynomial[j], polynomial[-1])
                            for i in range(m) for j in range(m)])
        terms = [t ** 0] + [sum((t ** i * fmpq(r.numerator, r.denominator)
                              for i, r in enumerate(row)), t * 0) for row in rotation]
        return math.lcm(*(int(sum((term * x for term, x in zip(terms, point)), t * 0).det().q)
                          for point in itertools.product(range(m + 1), repeat=m)
                          if sum(point) <= m))

    def loss(self, delta, all_of_them):
        """At least c(delta) (29), or the C_N (30) of it and of all smaller ones."""
        tau, found = self.n, arb(0)
        for far, divisor in self.seen:
            x = delta * far
            best = (tau / (arb(1).exp() * x)) ** tau if all_of_them and x > tau else (-x).exp()
            found = max(found, (best / divisor).upper())
        last = delta * SEEN[self.n]
        tail = (-last).exp() * arb(SEEN[self.n]) ** tau if last > tau and not all_of_them else \
            (tau / (arb(1).exp() * delta)) ** tau
        return max(found, (tail / self.Gamma).upper())


# ---- functions on grids

class Grid:
    """Angles xi with theta = sum xi_i l_i, where k . theta = kappa . xi; N_i points of each."""

    def __init__(self, shape):
        self.shape, self.points = shape, math.prod(shape)
        self.modes = list(itertools.product(*[[j if 2 * j < N else j - N for j in range(N)]
                                              for N in shape]))
        self.place = {mode: at for at, mode in enumerate(self.modes)}

    def transformed(self, numbers, inverse):
        numbers, row = list(numbers), self.shape[-1]
        for at in range(0, self.points, row):
            numbers[at:at + row] = acb.dft(numbers[at:at + row], inverse=inverse)
        for at in range(row if len(self.shape) == 2 else 0):
            numbers[at::row] = acb.dft(numbers[at::row], inverse=inverse)
        return numbers

    def values(self, coefficients):
        """Of a function with the coefficients {mode: number}, at the points."""
        numbers = [acb(0)] * self.points
        for mode, x in coefficients.items():
            numbers[self.place[mode]] = x * self.points
        return self.transformed(numbers, True)

    def coefficients(self, values):
        return [x / self.points for x in self.transformed(values, False)]


class Judge:
    def __init__(self, found):
        self.found, self.n, self.rotation = found, found.n, Rotation(found)
        self.rho = ball(found.rho)
        self.u = {}
        for k, parts in found.u.items():
            mode = self.mode(k)
            for sign in 1, -1:
                self.u[tuple(sign * x for x in mode)] = [
                    acb(arb((re, -found.bits)), sign * arb((im, -found.bits))) for re, im in parts]
        self.degrees = [max(abs(mode[i]) for mode in self.u) for i in range(self.n)]

    def mode(self, k):
        """kappa of k."""
        return tuple(sum(x * y for x, y in zip(row, k)) for row in self.found.frame)

    def weight(self, mode, rho):
        return (rho * sum(a * abs(x) for a, x in zip(self.rotation.alpha, mode))).exp()

    def norm(self, grid, parts):
        """Of a function whose components have these lists of coefficients (5)."""
        weights = itertools.product(*([(self.rho * a * min(j, N - j)).exp() for j in range(N)]
                                      for a, N in zip(self.rotation.alpha, grid.shape)))
        return upper(sum((size(entries) * math.prod(weight)
                          for weight, entries in zip(weights, zip(*parts))), arb(0)))

    def constants(self):
        """l0, m0, a0, b0 and p0: section 11."""
        n, grid = self.n, Grid([1 << (4 * d + 2).bit_length() for d in self.degrees])
        L, l0 = [{(0,) * n: acb(i == j)} for i in range(n) for j in range(n)], arb(1)
        for mode, x in self.u.items():
            k = [int(i.p) for i in self.rotation.wavenumber(mode)]
            l0 += size(x) * length(k) * self.weight(mode, self.rho)
            for i, j in itertools.product(range(n), repeat=2):
                L[n * i + j][mode] = acb(0, k[j]) * x[i]

        def matrices(parts):
            return [acb_mat(n, n, entries) for entries in zip(*map(grid.values, parts))]

        def coefficients(values):
            return [grid.coefficients(part) for part in zip(*(x.entries() for x in values))]

        L = matrices(L)
        M = [{mode: x.mid() for mode, x in zip(grid.modes, part)
              if all(abs(i) <= d for i, d in zip(mode, self.degrees))}
             for part in coefficients([x.mid().inv().mid() for x in L])]
        turn = {mode: (acb(0, -2) * arb.pi() * self.rotation.turns(mode)).exp() for mode in M[0]}
        back = matrices({mode: x * turn[mode] for mode, x in part.items()} for part in M)
        M = matrices(M)
        one = coefficients([x * y - 1 for x, y in zip(L, M)])
        of_M, eta = self.norm(grid, coefficients(M)), self.norm(grid, one)              # (34)
        demand(eta < arb(1) / 2, "the inverse of L is not good enough")
        m0 = of_M / (1 - eta)                                                           # (35)
        X = coefficients([x * y.transpose() for x, y in zip(M, back)])
        err = upper(m0 * eta * (m0 + of_M))                                             # (36)
        middle = size(acb_mat(n, n, [part[0] for part in X]).inv().entries())
        demand(middle * err < 1, "the mean of 1/A may be 0")
        p0 = max(size(entries) for entries in list(zip(*X))[1:]) + err                  # (37)
        return map(upper, (l0, m0, self.norm(grid, X) + err, middle / (1 - middle * err), p0))

    def size_of_phase(self, k, rho):
        """At least the norm of e^(i k.(theta + u))."""
        of_u = sum((abs(sum(i * x for i, x in zip(k, each))).upper() * self.weight(at, rho)
                    for at, each in self.u.items()), arb(0))
        return upper(self.weight(self.mode(k), rho) * of_u.exp())

    def unseen(self, shape):
        """At least the norm of the modes of V'(theta + u) beyond the grid, and of what they are
        taken for: |f_kappa| <= F e^(-r |kappa|), r > rho, and a mode is taken for one that is no
        longer."""
        found = arb("inf")
        for wider in WIDER:
            r = self.rho * wider
            F = sum((ball(abs(p)) * length(k) * self.size_of_phase(k, r)
                     for k, _, p in self.found.waves), arb(0))
            x = [(-(r - self.rho) * a).exp() for a in self.rotation.alpha]
            every = [(1 + y) / (1 - y) for y in x]
            beyond = [2 * y ** (N // 2) / (1 - y) for y, N in zip(x, shape)]
            found = min(found, upper(2 * F * sum(
                b * math.prod(every[:i] + every[i + 1:]) for i, b in enumerate(beyond))))
        return found

    def residual(self):
        """At least the norm of E(u): (31) to (33)."""
        n, shape = self.n, [1 << (2 * d).bit_length() for d in self.degrees]
        while not self.unseen(shape) < UNSEEN:
            shortest = min(range(n), key=lambda i: self.found.alpha[i] * shape[i])
            shape[shortest] *= 2
            demand(math.prod(shape) <= MOST_POINTS, "more modes count than a grid has points")
        grid = Grid(shape)
        u = [[x.real for x in grid.values({mode: x[i] for mode, x in self.u.items()})]
             for i in range(n)]
        waves = [(k, self.mode(k), arb.pi() * ball(phase), ball(p))
                 for k, phase, p in self.found.waves]
        longest, force = max(shape), []
        angles = [arb.pi() * ball(Fraction(2 * j, longest)) for j in range(longest)]
        for at, each in zip(itertools.product(*map(range, shape)), zip(*u)):
            total = [arb(0)] * n
            for k, mode, phase, p in waves:
                angle = angles[sum(x * j * longest // N for x, j, N in zip(mode, at, shape))
                               % longest]
                slope = p * (angle + phase + sum(i * x for i, x in zip(k, each))).cos()
                total = [f - i * slope for f, i in zip(total, k)]
            force.append(total)
        E = list(map(grid.coefficients, zip(*force)))
        for mode, x in self.u.items():
            divisor = 4 * (arb.pi() * self.rotation.turns(mode)).sin() ** 2
            for i in range(n):
                E[i][grid.place[mode]] -= divisor * x[i]
        return upper(self.norm(grid, E) + self.unseen(shape))

    def distance(self, e0, l0, m0, a0, b0, p0):
        """The left side of (18), if the theorem holds with some of these choices; None."""
        tau, e = self.n, arb(1).exp()
        phases = [(length(k), ball(abs(p)), self.size_of_phase(k, self.rho))
                  for k, _, p in self.found.waves]

        def d(delta):
            return self.rotation.kappa / (e * delta)                                    # (7)

        for s, steps in itertools.product((arb(1) / 20, arb(1) / 5, arb(4) / 5), (0, 2, 4)):
            deltas = [self.rho * 99 / 100 / (4 + 2 * s) / 2 ** i for i in range(steps + 1)]
            C = [self.rotation.loss(delta.lower(), i == steps) for i, delta in enumerate(deltas)]
            for share in 0.001, 0.003, 0.01, 0.03, 0.1:
                t = (share / (l0 * m0 * a0)).mid()
                sigma = (2 * l0 + t) * t
                if not (m0 * t < 1 and a0 * sigma < 1):
                    continue
                l, m, a = l0 + t, m0 / (1 - m0 * t), a0 / (1 - a0 * sigma)
                d_a = a * a0 * sigma
                if not b0 * d_a < 1:
                    continue
                h = 1 + b0 / (1 - b0 * d_a) * (p0 + d_a)
                T = sum((p * k ** 3 * g * (k * t).exp() for k, p, g in phases), arb(0))  # (12)
                error, moved, bent = e0, arb(0), arb(0)
                for i, (delta, c) in enumerate(zip(deltas, C)):
                    G = a * h * c * c * l * ((2 * m * l * d(delta) if tau > 1 else 0) + d(
                        2 * delta) + T * a * h * c * c * l ** 3 / 2)                    # (14)
                    v = a * h * c * c * l * l * error                                   # (15)
                    last = i == steps
                    moved += v / (1 - arb(2) ** (-2 * tau)) if last else v
                    bent += d(s * delta) * v / (1 - arb(2) ** (1 - 2 * tau) if last else 1)
                    if last and 2 ** (4 * tau) * G * error <= 1 and bent <= t and moved <= t:
                        return upper(moved)                                     # (16) to (18)
                    error = G * error * error
        return None


def verify(data):
    """(residual, distance) of the certificate in the bytes, as floats that are no less.  Refused:
    it is wrong, or not confirmed."""
    found = read(data)
    with ctx.workprec(found.bits + SPARE_BITS):
        judge = Judge(found)
        constants, error = judge.constants(), judge.residual()
        distance = judge.distance(error, *constants)
        demand(distance is not None, "the error %.3g of the torus is too large" % float(error))
        return tuple(math.nextafter(float(x), math.inf) for x in (error, distance))


if __name__ == "__main__":
    with open(sys.argv[1], "rb") as file:
        print("verified: error at most %.4g, distance at most %.4g" % verify(file.read()))
