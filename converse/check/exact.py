"""The left side of (C3) over a prism, bounded in integers: steps (C4) to (C8) of
docs/proofs/checker.md.

Centres, columns, matrices, multipliers and vectors are chosen, and floating-point choices are
rounded to integers first; the bound holds for any choice.  Sums and products are exact.  Only
sines, amplitudes and quotients are rounded.  These errors are counted in units, once for each wave,
in its `error`.  Bounds of errors are rounded upwards.
"""

import collections
import itertools
import math

from .arith import turn_of, turned
from .limits import FIRST_TRY_SITES, MAX_SITES
from .torus import least

VECTOR_BITS = 28                        # of the vectors; the multipliers have twice as many
UNIT_BITS = 56                          # of the second variation

# A wave of a prism: k and the phase; amplitude and parts, as pairs (symbol, part); what p' cos y
# and p' sin y are off by at most, computed as these numbers times cosines and sines.
PrismWave = collections.namedtuple("PrismWave", "k0 k1 phase amplitude parts error")

# A wave at a site: p cos y and p sin y, and of its parts, as (symbol, h cos y, h sin y); its
# columns xi = k.L; bounds of |xi| and |w|.
SiteWave = collections.namedtuple("SiteWave", "cosine sine parts columns size rest error")

# A site of a lane: its waves; E of step (C7); as doubles beta, and the reach of each wave.
Site = collections.namedtuple("Site", "waves E beta reach")


class Prism:
    """A prism: its waves, x[0] and x[1] as (centre, columns, error), each for two coordinates, and
    the number of its symbols: one for each parameter, which may also move x[1], and two more."""

    def __init__(self, fixed, waves, xstar, x1, symbols):
        self.fixed, self.waves, self.symbols = fixed, waves, symbols
        self.pairs = list(itertools.combinations_with_replacement(range(symbols), 2))
        self.turn = turn_of([((wave.k0, wave.k1), abs(wave.amplitude)) for wave in waves])
        start = xstar, ([0] * symbols,) * 2, (1, 1)
        self.lanes = Lane(self, start, x1), Lane(self, x1, start)
        self.sizes = [(k0, k1, (abs(amplitude) + sum([abs(x) for _, x in parts])) / fixed.one)
                      for k0, k1, _, amplitude, parts, _ in waves]

    def penalized(self, site, penalties):
        """beta at a site plus a penalty for the reach there, which makes the bound larger."""
        p, q, r = site.beta
        for (k0, k1, size), reach in zip(self.sizes, site.reach):
            more = size * (penalties[0] + penalties[1] * reach) * reach
            p, q, r = p + k0 * k0 * more, q + k0 * k1 * more, r + k1 * k1 * more
        return p, q, r


class Lane:
    """Half of the orbits of a prism: x[1], x[2], ... or x[0], x[-1], ..., followed site by site."""

    def __init__(self, prism, before, first):
        self.prism, self.sites, self.ended = prism, [], False
        (self.x0, self.L0, self.r0), (self.x, self.L, self.r) = before, first
        self.first_columns, self.first_rest = self.L, self.r
        self.T0 = self.T = [[0] * len(prism.pairs)] * 2         # of pairs, as form in advance()
        a, b = map(abs, prism.turn)         # of the frame of the errors
        self.r0, self.r = [(a * u + b * v, b * u + a * v) for u, v in (self.r0, self.r)]
        # How strongly each wave moves the two coordinates of the frame of the errors.
        self.strengths = [tuple(map(abs, turned(prism.turn, wave[:2]))) for wave in prism.waves]
        self.d = self.f = None              # of step (C5); d in half units

    def follow(self, most):
        """Follows the lane up to most sites, or until a wave reaches too far."""
        while not self.ended and len(self.sites) < most:
            self.ended = not self.advance()

    def advance(self):
        """Adds this site to the lane and goes on to the next one; False if a wave reaches beyond
        1, or the matrices are singular."""
        prism, (u, v), (L0, L1), (T0, T1), (r0, r1) = self.prism, self.x, self.L, self.T, self.r
        fixed, pairs, length = prism.fixed, prism.pairs, sum([x * x for x in prism.turn])
        bits, one, sincos = fixed.bits, fixed.one, fixed.sincos
        waves, reaches, p, q, r = [], [], 0, 0, 0           # the last three for V''
        E0 = E1 = push0 = push1 = error0 = error1 = 0
        new0 = [2 * a - b for a, b in zip(L0, self.L0[0])]
        new1 = [2 * a - b for a, b in zip(L1, self.L0[1])]
        curve0 = [2 * a - b for a, b in zip(T0, self.T0[0])]
        curve1 = [2 * a - b for a, b in zip(T1, self.T0[1])]
        for wave, (strong0, strong1) in zip(prism.waves, self.strengths):
            k0, k1, phase, amplitude, parts, error = wave
            xi = [k0 * a + k1 * b for a, b in zip(L0, L1)]
            tau = [k0 * a + k1 * b for a, b in zip(T0, T1)]
            size = sum(map(abs, xi))
            rest = -(-(strong0 * r0 + strong1 * r1) // length) + (sum([
                abs(x) if i == j else 2 * abs(x) for (i, j), x in zip(pairs, tau)]) + 1 >> 1)
            reach = size + rest
            if reach > one:
                return False
            s, c = sincos(k0 * u + k1 * v + phase)
            sine, cosine = amplitude * s >> bits, amplitude * c >> bits
            push0, push1 = push0 + k0 * cosine, push1 + k1 * cosine
            p, q, r = p + k0 * k0 * sine, q + k0 * k1 * sine, r + k1 * k1 * sine
            # The error of p' cos(y + z) in the model: (iii) of step (C6); a unit for each floor.
            square, far = (reach * reach >> bits) + 1, (rest * (reach + size) >> bits) + 1
            cube, fourth = (square * reach >> bits) + 1, (square * square >> bits) + 1
            bent = ((abs(cosine) * (12 * far + fourth) + 4 * abs(sine) * cube) // 24 >> bits) \
                + 2 * error + len(xi) + len(pairs) + 2
            # The coefficients of e[i] e[j], of second order.  X is moved by their mean.  With
            # those of T they are the coefficients of e[i]^2 - 1/2 and e[i] e[j].
            form = [cosine * xi[i] * xi[j] >> bits + (i == j) for i, j in pairs]
            moved = []
            for m, part in parts:
                sine_part, cosine_part = part * s >> bits, part * c >> bits
                moved.append((m, cosine_part, sine_part))
                form = [x + sine_part * xi[i + j - m] if m in (i, j) else x
                        for (i, j), x in zip(pairs, form)]
                new0[m] += k0 * cosine_part
                new1[m] += k1 * cosine_part
                bent += ((3 * abs(cosine_part) * square + abs(sine_part) * (6 * rest + cube))
                         // 6 >> bits) + 1
            mean = sum([x for (i, j), x in zip(pairs, form) if i == j]) >> bits + 1
            E0, E1 = E0 + k0 * mean, E1 + k1 * mean
            slopes = [sine * a >> bits for a in xi]
            form = [sine * a + x >> bits for a, x in zip(tau, form)]
            if k0:
                new0 = [a - k0 * b for a, b in zip(new0, slopes)]
                curve0 = [a - k0 * b for a, b in zip(curve0, form)]
            if k1:
                new1 = [a - k1 * b for a, b in zip(new1, slopes)]
                curve1 = [a - k1 * b for a, b in zip(curve1, form)]
            error0, error1 = error0 + strong0 * bent, error1 + strong1 * bent
            waves.append(SiteWave(cosine, sine, moved, xi, size, rest, error))
            reaches.append(reach / one)
        self.sites.append(Site(waves, (E0, E1), (2 - p / one, -q / one, 2 - r / one), reaches))
        x = 2 * u - self.x0[0] + push0 - E0, 2 * v - self.x0[1] + push1 - E1
        if not self.bound_errors(4 * one - 2 * p, -2 * q, 4 * one - 2 * r, error0, error1):
            return False
        self.x0, self.L0, self.T0 = self.x, self.L, self.T
        self.x, self.L, self.T = x, (new0, new1), (curve0, curve1)
        return True

    def moved(self, symbol):
        """How far a symbol moves the lane's last site, the waves taken together."""
        if self.sites:
            return sum([abs(wave.columns[symbol]) for wave in self.sites[-1].waves])
        x, y = [columns[symbol] for columns in self.first_columns]
        return sum([abs(wave.k0 * x + wave.k1 * y) for wave in self.prism.waves])

    def bound_errors(self, p, q, r, error0, error1):
        """The errors of the next site, step (C5): from beta = [p q; q r] in half units, and the
        error of the step.  d[q] = beta - M is exact but that beta, in the frame of the errors, is
        off by less than a half unit; False if there is no M."""
        bits, (r0, r1), (old0, old1) = self.prism.fixed.bits + 1, self.r, self.r0
        a, b = self.prism.turn
        more = (r0 + r1 >> bits) + 1 if b else 0
        length, error0, error1 = a * a + b * b, error0 + more, error1 + more
        p, q, r = ((a * a * p + 2 * a * b * q + b * b * r) // length,
                   (a * b * (r - p) + (a * a - b * b) * q) // length,
                   (b * b * p - 2 * a * b * q + a * a * r) // length)
        if self.d is None:
            f0, f1 = old0 + error0, old1 + error1
        else:
            (a, b, c), (f0, f1), one = self.d, self.f, 1 << 2 * bits
            det = a * c - b * b
            if abs(det) << 60 < one:
                return False
            m, n, o = [x * one // det for x in (c, -b, a)]          # M, near the inverse of d
            p, q, r = p - m, q - n, r - o
            f0, f1 = abs(m) * f0 + abs(n) * f1, abs(n) * f0 + abs(o) * f1
            f0 += abs(one - m * a - n * b) * old0 + abs(m * b + n * c) * old1 >> bits
            f1 += abs(n * a + o * b) * old0 + abs(one - n * b - o * c) * old1 >> bits
            f0, f1 = (f0 >> bits) + 2 + error0, (f1 >> bits) + 2 + error1
        self.d, self.f = (p, q, r), (f0, f1)
        self.r0, self.r = self.r, ((abs(p) * r0 + abs(q) * r1 >> bits) + 1 + f0,
                                   (abs(q) * r0 + abs(r) * r1 >> bits) + 1 + f1)
        return True


def inverse(d):
    p, q, r = d
    det = p * r - q * q
    return r / det, -q / det, p / det


def matrix_times(d, n):
    return d[0] * n[0] + d[1] * n[1], d[1] * n[0] + d[2] * n[1]


def recursion(blocks, middle, tail):
    """The recursion of step (C3) from the first of these matrices on: d of each, and where what it
    rests on begins, as it begins anew behind a place where d is not positive, and in the middle,
    where the other lane begins, if there was such a place before."""
    found, begin, inv = [], 0, tail
    for k, block in enumerate(blocks):
        if k == middle and begin:
            begin, inv = k, tail
        d = [x - y for x, y in zip(block, inv)]
        found.append((d, begin))
        definite = d[0] > 0 and d[0] * d[2] > d[1] * d[1]
        begin, inv = (begin, inverse(d)) if definite else (k + 1, tail)
    return found


def test_vectors(ahead, back, l):
    """Vectors n for the sites of both lanes, which have these matrices; in double precision, since
    any vectors give a bound.

    At each site the recursions from both ends of the orbit are compared, the one from the lane's
    own end only where it has not failed.  Of each part of the orbit that they cover without
    beginning anew, where both together have a negative eigenvalue that is nearest to zero, and n
    as a rule is largest, is its eigenvector; n follows outwards by the recursions.  The part is
    taken where this eigenvalue is lowest: others may contradict next to nothing.
    """
    tail, blocks = (l, 0.0, l), [*reversed(back), *ahead]
    left = recursion(blocks, len(back), tail)
    right = recursion(blocks[::-1], len(ahead), tail)[::-1]
    found, n = {}, [(0.0, 0.0)] * len(blocks)
    for k, (block, (d, begin), (beyond, end)) in enumerate(zip(blocks, left, right)):
        low, vector = least([x + y - z for x, y, z in zip(d, beyond, block)])
        if low < 0 and not (begin if k < len(back) else end):
            found[begin, end] = max(found.get((begin, end), (-math.inf,)), (low, k, vector))
    if found:
        _, place, n_place = min(found.values())
        n[place] = n_place
        for k in range(place, left[place][1], -1):
            n[k - 1] = matrix_times(inverse(left[k - 1][0]), n[k])
        for k in range(place + 1, len(n) - right[place][1]):
            n[k] = matrix_times(inverse(right[k][0]), n[k - 1])
    return [n[len(back):], n[:len(back)][::-1]]


class SecondVariation:
    """The left side of (C3): value, polynomial and error of step (C8), summed over the sites.

    All that is taken from a site is rounded to units of 2^-UNIT_BITS, in which omega and the
    multipliers are, too.  A product of n such numbers has degree n.
    """

    def __init__(self, prism, l):
        self.prism, self.symbols = prism, range(prism.symbols)
        self.down = prism.fixed.bits - UNIT_BITS
        self.l = l >> self.down             # a lesser l makes (C3) larger
        self.value, self.error = 0, 0       # of degree 2; the error 120 times
        self.product = collections.defaultdict(int)             # of degree 2, by its symbols
        # Of degree 4, six times: of each pair of symbols, alone and with each symbol.
        self.pairs = list(itertools.combinations_with_replacement(self.symbols, 2))
        self.cubic = [[0] * len(self.pairs) for _ in range(1 + prism.symbols)]

    def add_lane(self, sites, vectors):
        """Adds the sites of a lane; returns the multipliers of the first, and G of step (C7) there
        without the multipliers of the other lane."""
        mu0, mu1, beyond0, beyond1 = [[0] * (1 + len(self.symbols))] * 4
        v0 = v1 = 0
        for site, (n0, n1) in zip(reversed(sites), reversed(vectors)):
            self.value += 2 * (n0 * n0 + n1 * n1 - n0 * v0 - n1 * v1) << UNIT_BITS
            v0, v1 = n0, n1
            E0, E1 = site.E[0] >> self.down, site.E[1] >> self.down
            self.value += mu0[0] * E0 + mu1[0] * E1
            for i in self.symbols:
                self.product[i,] += mu0[1 + i] * E0 + mu1[1 + i] * E1
            self.error += 120 * (sum(map(abs, mu0)) + sum(map(abs, mu1)))   # as E is rounded
            G0 = [2 * a - b for a, b in zip(mu0, beyond0)]
            G1 = [2 * a - b for a, b in zip(mu1, beyond1)]
            for (k0, k1, *_), wave in zip(self.prism.waves, site.waves):
                slopes = self.add_wave(wave, (k0 * n0 + k1 * n1) ** 2,
                                       [k0 * a + k1 * b for a, b in zip(mu0, mu1)])
                if k0:
                    G0 = [a + k0 * b for a, b in zip(G0, slopes)]
                if k1:
                    G1 = [a + k1 * b for a, b in zip(G1, slopes)]
            mu0, mu1, beyond0, beyond1 = G0, G1, mu0, mu1
        return (beyond0, beyond1), (mu0, mu1)

    def add_wave(self, wave, omega, m):
        """Adds what a wave has in step (C8), and returns its factor of D in G, which is affine."""
        down, U = self.down, UNIT_BITS
        m0, *m = m
        xi = [x >> down for x in wave.columns]
        c, s = wave.cosine >> down, wave.sine >> down
        A, B = m0 * c - omega * s >> U, -(omega * c + m0 * s) >> U
        alpha, beta = [x * c >> U for x in m], [-x * s >> U for x in m]
        most_m, linear_alpha, linear_beta = [sum(map(abs, x)) for x in (m, alpha, beta)]
        first = [3 * A << U, *[-3 * x << U for x in alpha]]         # what stands with xi^2
        slopes = [x - (A * y >> U) for x, y in zip(beta, xi)]
        parts_A = parts_alpha = parts_B = parts_beta = 0
        for i, part_c, part_s in wave.parts:
            part_c, part_s = part_c >> down, part_s >> down
            part_A = m0 * part_c - omega * part_s >> U
            part_B = -(omega * part_c + m0 * part_s) >> U
            self.product[i,] += part_A << U
            first[1 + i] -= 3 * part_A << U
            slopes[i] += part_B
            parts_A, parts_B = parts_A + abs(part_A), parts_B + abs(part_B)
            for j, x in enumerate(m):
                part_alpha, part_beta = x * part_c >> U, -x * part_s >> U
                self.product[i, j] += part_alpha << U
                parts_alpha, parts_beta = parts_alpha + abs(part_alpha), \
                    parts_beta + abs(part_beta)
                for k, y in enumerate(xi):
                    self.product[i, j, k] += part_beta * y
        products = [xi[j] * xi[k] for j, k in self.pairs]
        for row, x, y in zip(self.cubic, first, [0, *xi]):
            x -= B * y
            if x:
                row[:] = [a + x * b for a, b in zip(row, products)]
        self.value -= omega * s
        # The remainder.  Each number rounded down is off by less than a unit: rest has those of
        # the columns; p' cos y and p' sin y, in all, those of c, s and the parts; A and B those of
        # their coefficients, which stand with at most 1 each; and slopes, with |z|.
        size, count = sum(map(abs, xi)), 1 + len(xi)
        rest = (wave.rest >> down) + count
        reach = size + rest
        unsure = 2 * ((wave.error >> down) + 2 + len(wave.parts))
        second, far = (reach * reach >> U) + 1, (rest * (reach + size) >> U) + 1
        third, fourth = (second * reach >> U) + 1, (second * second >> U) + 1
        between = (rest * (reach * (reach + size) + size * size) >> 2 * U) + 1
        self.error += (
            (linear_alpha + parts_A) * (60 * far + 5 * fourth)
            + (linear_beta + parts_B) * 20 * third
            + abs(B) * (20 * between + (third * second >> U) + 1)
            + (A * 5 * fourth if A > 0 else -A * 60 * ((rest * rest >> U) + 1))
            + parts_alpha * 60 * second + parts_beta * (120 * rest + 20 * third)
            + 120 * (unsure * (abs(m0) + most_m + omega)
                     + (2 * count * (2 + len(wave.parts)) << U)))
        return [B, *slopes]

    def add_ends(self, n, ahead, back):
        """Adds the terms of x[1] and x[0], where the lanes meet; n and the results of add_lane for
        each lane."""
        (n0, *_), (n1, *_) = [vectors or [(0, 0)] for vectors in n]
        self.value -= 2 * (n0[0] * n1[0] + n0[1] * n1[1]) << UNIT_BITS
        orbit = [*reversed(n[1]), *n[0]]
        used = [u * u + v * v for u, v in orbit if u or v]
        self.value -= self.l * (used[0] + used[-1])
        lanes = self.prism.lanes
        for (_, G), (mu, _), lane in ((ahead, back, lanes[0]), (back, ahead, lanes[1])):
            for g, other, columns, rest in zip(G, mu, lane.first_columns, lane.first_rest):
                g = [a - b for a, b in zip(g, other)]
                columns = [x >> self.down for x in columns]
                self.error += 120 * sum(map(abs, g)) * ((rest >> self.down) + 1 + len(columns))
                for i, x in enumerate(columns):
                    if x:
                        self.product[i,] += g[0] * x
                        for j, y in enumerate(g[1:]):
                            self.product[i, j] += x * y

    def form(self):
        """The polynomial by its monomials (i,), (i, j) and (i, j, k), i <= j <= k: of degree 4,
        six times."""
        form = {key: 0 for count in (1, 2, 3)
                for key in itertools.combinations_with_replacement(self.symbols, count)}
        for key, x in self.product.items():
            form[tuple(sorted(key))] += 6 * x << 2 * UNIT_BITS
        for i, row in zip([(), *[(i,) for i in self.symbols]], self.cubic):
            for (j, k), x in zip(self.pairs, row):
                form[tuple(sorted((*i, j, k)))] += (1 + (j < k)) * x
        return form

    def bound(self):
        """An upper bound of the left side of (C3), its value in the middle, about how much each
        symbol adds, and the error: of degree 4, six times."""
        form = self.form()
        value, error = 6 * self.value << 2 * UNIT_BITS, (self.error << 2 * UNIT_BITS) // 20 + 1
        moved = [sum([abs(x) for key, x in form.items() if k in key]) for k in self.symbols]
        most = sum(map(abs, form.values()))     # of the polynomial over the cube
        return value + most + error, value, moved, error


def attempt(prism, l, penalties):
    """Is (C3) true of all orbits of the prism?  None if so, or else why not, and how much each
    symbol matters.  It is tried where a wave reaches too far, and before at lengths that double."""
    one, most, why, moved = prism.fixed.one, FIRST_TRY_SITES, None, None
    value = error = 0
    while True:
        for lane in prism.lanes:
            lane.follow(min(most, MAX_SITES))
        sites = [lane.sites for lane in prism.lanes]
        vectors = test_vectors(*[[prism.penalized(site, penalties) for site in lane]
                                 for lane in sites], l / one)
        n = [trimmed([(round(u * 2 ** VECTOR_BITS), round(v * 2 ** VECTOR_BITS)) for u, v in lane])
             for lane in vectors]
        if any(n):
            sums = SecondVariation(prism, l)
            sums.add_ends(n, *[sums.add_lane(lane[:len(used)], used)
                               for lane, used in zip(sites, n)])
            bound, value, moved, error = sums.bound()
            if bound < 0:
                return None
            why = "its second variation may be positive"
        if all(lane.ended or len(lane.sites) >= MAX_SITES for lane in prism.lanes):
            break
        most *= 2
    why = why or "the orbit of its centre contradicts nothing over %d points, %s" % (
        sum(map(len, sites)), "the most that are followed" if max(map(len, sites)) >= MAX_SITES else
        "beyond which it is too uncertain")
    # Symbols that move the ends count a little: when they are halved, the orbit may go on.
    ends = [sum([lane.moved(i) for lane in prism.lanes]) / one for i in range(prism.symbols)]
    share = [x / (sum(ends) or 1) for x in ends]
    if moved is None or value >= 0:
        return why, share
    scale = error + sum(moved) // 64
    return why, [x / scale + y for x, y in zip(moved, share)]


def trimmed(vectors):
    """The vectors without the zeros at the end."""
    while vectors and not any(vectors[-1]):
        vectors.pop()
    return vectors
