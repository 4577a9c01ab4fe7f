"""The left side of (C3) over a prism, bounded in integers: steps (C4) to (C8) of
docs/proofs/checker.md.

Centres, columns, matrices, multipliers and vectors are chosen, and floating-point choices are
rounded to integers first; the bound holds for any choice.  Sums and products are exact.  Only
sines, amplitudes and quotients are rounded.  These errors are counted in units, once for each wave,
in its `error`.  Bounds of errors are rounded upwards.
"""

import collections
import itertools

from .arith import DIAGONAL, combined, dot, entries, pairs_of, times, turn_of, with_determinant
from .choice import test_vectors, trimmed
from .limits import FIRST_TRY_SITES, MAX_SITES

VECTOR_BITS = 28                        # of the vectors; the multipliers have twice as many
UNIT_BITS = 56                          # of the second variation

# A wave of a prism: k and the phase; amplitude and parts, as pairs (symbol, part); what p' cos y
# and p' sin y are off by at most, computed as these numbers times cosines and sines.
PrismWave = collections.namedtuple("PrismWave", "k phase amplitude parts error")

# A wave at a site: p cos y and p sin y, and of its parts, as (symbol, h cos y, h sin y); its
# columns xi = k.L; a bound of |w|.
SiteWave = collections.namedtuple("SiteWave", "cosine sine parts columns rest error")

# A site of a lane: its waves; E of step (C7); as doubles beta, and the reach of each wave.
Site = collections.namedtuple("Site", "waves E beta reach")


class Prism:
    """A prism: its waves, x[0] and x[1] as (centre, columns, error), each by coordinates, and the
    number of its symbols."""

    def __init__(self, fixed, waves, xstar, x1, symbols):
        self.fixed, self.waves, self.symbols = fixed, waves, symbols
        self.pairs = pairs_of(symbols)
        # Where e[i]^2 stands among them; and for each i the places of e[i] e[j], with j.
        self.squared = [at for at, (i, j) in enumerate(self.pairs) if i == j]
        self.with_symbol = [[(at, sum(pair) - m) for at, pair in enumerate(self.pairs) if m in pair]
                            for m in range(symbols)]
        self.turn = turn_of([(wave.k, abs(wave.amplitude)) for wave in waves], len(xstar))
        self.squares = [entries(wave.k) for wave in waves]
        start = xstar, [[0] * symbols for _ in xstar], [1 for _ in xstar]
        self.lanes = Lane(self, start, x1), Lane(self, x1, start)
        self.sizes = [(abs(wave.amplitude) + sum([abs(x) for _, x in wave.parts])) / fixed.one
                      for wave in waves]

    def tail(self, l):
        """The matrix l I."""
        return [l * (i == j) for i, j in pairs_of(len(self.turn.rows))]

    def penalized(self, site, penalties):
        """beta at a site plus a penalty for the reach there, which makes the bound larger."""
        beta = site.beta
        for size, reach, squares in zip(self.sizes, site.reach, self.squares):
            more = size * (penalties[0] + penalties[1] * reach) * reach
            beta = [x + more * y for x, y in zip(beta, squares)]
        return beta


class Lane:
    """Half of the orbits of a prism: x[1], x[2], ... or x[0], x[-1], ..., followed site by site."""

    def __init__(self, prism, before, first):
        self.prism, self.sites, self.ended = prism, [], False
        (self.x0, L0, self.r0), (self.x, L, self.r) = before, first
        self.first_columns, self.first_rest = L, self.r
        # By coordinates L, then T, of pairs, as form in advance().
        self.LT0, self.LT = [[[*row, *[0] * len(prism.pairs)] for row in rows] for rows in (L0, L)]
        turn = [[abs(x) for x in row] for row in prism.turn.rows]
        self.r0, self.r = [[dot(row, r) for row in turn] for r in (self.r0, self.r)]
        # How strongly each wave moves the coordinates of the frame of the errors.
        self.strengths = [[abs(dot(row, wave.k)) for row in prism.turn.rows]
                          for wave in prism.waves]
        self.d = self.f = None              # of step (C5); d in half units

    def follow(self, most):
        """Follows the lane up to most sites, or until a wave reaches too far."""
        while not self.ended and len(self.sites) < most:
            self.ended = not self.advance()

    def advance(self):
        """Adds this site to the lane and goes on to the next one; False if a wave reaches beyond
        1, or the matrices are singular."""
        prism, x, r = self.prism, self.x, self.r
        fixed, pairs, symbols, length = prism.fixed, prism.pairs, prism.symbols, prism.turn.length
        bits, one, sincos, squared = fixed.bits, fixed.one, fixed.sincos, prism.squared
        waves, reaches, bend = [], [], [0] * (len(x) * (len(x) + 1) // 2)      # V''
        E, push, errors = [[0] * len(x) for _ in "123"]
        new = [[2 * a - b for a, b in zip(row, row0)] for row, row0 in zip(self.LT, self.LT0)]
        for wave, strong, squares in zip(prism.waves, self.strengths, prism.squares):
            k, phase, amplitude, parts, error = wave
            along = combined(k, self.LT)
            xi, tau = along[:symbols], along[symbols:]
            size = sum(map(abs, xi))
            rest = -(-dot(strong, r) // length) + sum(map(abs, tau)) \
                - (sum([abs(tau[at]) for at in squared]) >> 1)
            reach = size + rest
            if reach > one:
                return False
            s, c = sincos(dot(k, x) + phase)
            sine, cosine = amplitude * s >> bits, amplitude * c >> bits
            bend = [a + sine * b for a, b in zip(bend, squares)]
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
                for at, j in prism.with_symbol[m]:
                    form[at] += sine_part * xi[j]
                bent += ((3 * abs(cosine_part) * square + abs(sine_part) * (6 * rest + cube))
                         // 6 >> bits) + 1
            mean = sum([form[at] for at in squared]) >> bits + 1
            form = [0] * symbols + form
            for m, cosine_part, _ in moved:
                form[m] -= cosine_part << bits
            form = [sine * a + y >> bits for a, y in zip(along, form)]
            for i, factor in enumerate(k):
                errors[i] += strong[i] * bent
                if factor:
                    push[i] += factor * cosine
                    E[i] += factor * mean
                    new[i] = [a - factor * b for a, b in zip(new[i], form)]
            waves.append(SiteWave(cosine, sine, moved, xi, rest, error))
            reaches.append(reach / one)
        beta = [-2 * y for y in bend]       # in half units
        for at in DIAGONAL[len(beta)]:
            beta[at] += 4 * one
        self.sites.append(Site(waves, E, [y / (2 * one) for y in beta], reaches))
        if not self.bound_errors(beta, errors):
            return False
        self.x, self.x0 = [2 * a - b + c - e for a, b, c, e in zip(x, self.x0, push, E)], x
        self.LT, self.LT0 = new, self.LT
        return True

    def moved(self, symbol):
        """How far a symbol moves the lane's last site, the waves taken together."""
        if self.sites:
            return sum([abs(wave.columns[symbol]) for wave in self.sites[-1].waves])
        x = [columns[symbol] for columns in self.first_columns]
        return sum([abs(dot(wave.k, x)) for wave in self.prism.waves])

    def bound_errors(self, beta, error):
        """The errors of the next site, step (C5): from beta in half units, and the error of the
        step.  d[q] = beta - M is exact but that beta, in the frame of the errors, is off by less
        than a half unit; False if there is no M."""
        bits, r, turn = self.prism.fixed.bits + 1, self.r, self.prism.turn
        if turn.table:
            beta = [dot(row, beta) // turn.length for row in turn.table]
            error = [x + (sum(r) >> bits) + 1 for x in error]
        if self.d is None:
            f = [x + y for x, y in zip(self.r0, error)]
        else:
            found, det = with_determinant(self.d)
            if abs(det) << 60 < 1 << bits * len(r):
                return False
            M = [(x << 2 * bits) // det for x in found]     # the inverse of d, rounded
            # No row of |I - M d| |r0| is more, because M is off by less than a unit.
            off = sum(times([*map(abs, self.d)], self.r0)) >> bits
            beta = [x - y for x, y in zip(beta, M)]
            f = [(x + off >> bits) + 2 + y for x, y in zip(times([*map(abs, M)], self.f), error)]
        self.d, self.f = beta, f
        self.r0, self.r = r, [(y >> bits) + 1 + z for y, z in zip(times([*map(abs, beta)], r), f)]
        return True


class SecondVariation:
    """The left side of (C3): value, polynomial and error of step (C8), summed over the sites.

    All that is taken from a site is rounded to units of 2^-UNIT_BITS, in which omega and the
    multipliers are, too.  A product of n such numbers has degree n.
    """

    def __init__(self, prism, l):
        self.prism, self.symbols, self.angles = prism, range(prism.symbols), len(prism.turn.rows)
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
        mu = beyond = [[0] * (1 + len(self.symbols)) for _ in range(self.angles)]
        last = [0] * self.angles
        for site, n in zip(reversed(sites), reversed(vectors)):
            self.value += 2 * (dot(n, n) - dot(n, last)) << UNIT_BITS
            last = n
            for x, E in zip(mu, site.E):
                E >>= self.down
                self.value += x[0] * E
                for i in self.symbols:
                    self.product[i,] += x[1 + i] * E
                self.error += 120 * sum(map(abs, x))        # as E is rounded
            G = [[2 * a - b for a, b in zip(*rows)] for rows in zip(mu, beyond)]
            for (k, *_), wave in zip(self.prism.waves, site.waves):
                slopes = self.add_wave(wave, dot(k, n) ** 2, combined(k, mu))
                for i, factor in enumerate(k):
                    if factor:
                        G[i] = [a + factor * b for a, b in zip(G[i], slopes)]
            mu, beyond = G, mu
        return beyond, mu

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
        if all(n):
            self.value -= 2 * dot(n[0][0], n[1][0]) << UNIT_BITS
        used = [dot(x, x) for x in (*reversed(n[1]), *n[0]) if any(x)]
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
    symbol matters: None where halves would fail like it, as no orbit of the longest is uncertain.
    It is tried where a wave reaches too far, and before at lengths that double."""
    one, most, why, moved = prism.fixed.one, FIRST_TRY_SITES, None, None
    value = error = 0
    while True:
        for lane in prism.lanes:
            lane.follow(min(most, MAX_SITES))
        sites = [lane.sites for lane in prism.lanes]
        vectors = test_vectors(*[[prism.penalized(site, penalties) for site in lane]
                                 for lane in sites], prism.tail(l / one))
        n = [trimmed([[round(u * 2 ** VECTOR_BITS) for u in x] for x in lane]) for lane in vectors]
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
    if moved is None and not any(lane.ended for lane in prism.lanes):
        return why, None
    # Symbols that move the ends count a little: when they are halved, the orbit may go on.
    ends = [sum([lane.moved(i) for lane in prism.lanes]) / one for i in range(prism.symbols)]
    share = [x / (sum(ends) or 1) for x in ends]
    if moved is None or value >= 0:
        return why, share
    scale = error + sum(moved) // 64
    return why, [x / scale + y for x, y in zip(moved, share)]
