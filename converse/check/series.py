"""Fourier series with integer coefficients and a bound of what they leave out: step (T5) of
docs/proofs/checker.md.

A series is a function of n angles and perhaps of a parameter s, with values in matrices: a
polynomial with the modes e^(i k.theta) s^j of a box, and a radius.  The norm is the sum of |F_kj|
sigma^|k|, |.| being the spectral norm of a matrix.  In this norm the distance of the function from
the polynomial is at most the radius.
"""

import decimal
import functools
import itertools
import math
import operator
from dataclasses import dataclass, replace

from .failures import NotConfirmed

MAX_TERMS = 1 << 24                     # of a series
MAX_DIGITS = 1 << 30                    # of all coefficients of a series, in decimal digits
FINE = 64                               # bits that norms have beyond the coefficients
TEXTS = 1 << 14                         # Numbers that are written as text at a time.
PARTS = 32                              # Products are computed up to a multiple of limit/PARTS.
EXACT = decimal.Context(prec=decimal.MAX_PREC, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN,
                        traps=[decimal.Inexact, decimal.Rounded, decimal.InvalidOperation])


def greatest(numbers):
    """The largest absolute value."""
    return max(max(numbers), -min(numbers)) if numbers else 0


def powers_of(sigma, count):
    """sigma^0 to sigma^count, rounded up, in units of 2^-FINE."""
    found = [1 << FINE]
    while len(found) <= count:
        found.append(-(-found[-1] * sigma.numerator // sigma.denominator))
    return found


class Box:
    """The modes (k, j) with |k| <= limit and j <= degree, k in a lattice, in the order of the
    coordinates b, a of k and of j.  A group is all modes with one k."""

    def __init__(self, norm, limit, degree):
        self.norm, self.limit, self.degree = norm, limit, degree
        wide, high = ([math.floor(w * limit) for w in norm.widths()] + [0])[:2]
        # A profile has a sum for each |k|, which weights make more than there are k.
        terms = max((2 * wide + 1) * (2 * high + 1), limit + 1) * (degree + 1)
        if terms > MAX_TERMS:
            raise NotConfirmed("series of %d terms are needed, the checker's limit is %d"
                               % (terms, MAX_TERMS))
        self.reach = wide, high
        self.rows, self.lengths = {}, []            # of row b: its first group, least a, count
        for b in range(-high, high + 1):
            low, top = norm.row(b, limit)
            if low <= top:
                self.rows[b] = len(self.lengths), low, top - low + 1
                self.lengths += norm.lengths(b, low, top)
        self.groups = len(self.lengths)
        self.centre = self.groups // 2  # k = 0: opposite k are opposite in order
        self.count = self.groups * (degree + 1)

    @functools.cached_property
    def places(self):
        """(size, powers, turns): of each mode a power of X, below size, and a number of times that
        X^size is taken off.  No two powers are the same.  Both together make (k, j) belong to
        X^(at steps + j), where steps = degree + 1 and `at` is a linear function of k, 1 at b_0."""
        steps = self.degree + 1
        for period, stride in self._periods():
            pairs = [divmod(first + stride * b + a, period)
                     for b, (_, first, count) in self.rows.items() for a in range(count)]
            if len({place for _, place in pairs}) == self.groups:
                return (period * steps,
                        [place * steps + j for _, place in pairs for j in range(steps)],
                        [turns for turns, _ in pairs for _ in range(steps)])
        raise AssertionError

    def _periods(self):
        """(period, stride), such that a + stride b seems to be different for all k = (a, b) of the
        box modulo the period, for a small period; then the pair of the smallest rectangle.

        They are different if no k != 0 with a + stride b = 0 has |k| <= 2 limit.  These k are a
        lattice: vectors (x, y + 1) and (-z, y) of it are tried that are just longer.
        """
        wide, high = self.reach
        spans = [self.norm.row(b, 2 * self.limit) for b in range(2 * high + 2)]
        tried = []
        for y, more, other in itertools.product(range(1, 2 * high + 1), range(3), range(3)):
            x, z = spans[y + 1][1] + 1 + more, 1 - spans[y][0] + other
            tried.append((x * y + z * (y + 1), -(x + z)))
        for period, stride in sorted(tried):
            if period >= self.groups and not any(
                    low <= at <= top or low <= at - period <= top
                    for b, (low, top) in enumerate(spans[1:], 1)
                    for at in [-stride * b % period]):
                yield period, stride
                break
        yield (2 * wide + 1) * (2 * high + 1), 2 * wide + 1

    def inner(self, part):
        """(the box of the modes |k| <= part/PARTS of the limit, the places of its modes in the
        lists of this one)."""
        limit, step = self.limit * part // PARTS, self.degree + 1
        return Box(self.norm, limit, self.degree), [
            at * step + j for at, length in enumerate(self.lengths) if length <= limit
            for j in range(step)]

    def modes(self):
        """The coordinates of all k, in order."""
        for b, (_, first, count) in self.rows.items():
            for a in range(first, first + count):
                yield (a, b)[:self.norm.dimension]

    def find(self, m):
        """The group of the k with these coordinates, or None."""
        a, b = (*m, 0)[:2]
        at, first, count = self.rows.get(b, (0, 0, 0))
        return at + a - first if first <= a < first + count else None


@dataclass(frozen=True)
class Series:
    """A matrix of series.  Each of its entries is (real parts, imaginary parts or None), lists in
    the order of the box, in units of 2^-bits of its ring.  The radius is in units of
    2^-(bits + FINE)."""

    rows: int
    columns: int
    entries: tuple
    radius: int

    @property
    def transposed(self):
        return Series(self.columns, self.rows, tuple([
            self.entries[j * self.columns + i]
            for i in range(self.columns) for j in range(self.rows)]), self.radius)


class Packing:
    """How products are made of large numbers: series over a box are polynomials in X = 10^digits
    modulo X^size + 1, as (k, j) belongs to the power of X that `places` says.  With real
    coefficients `size` is the places' size.  With complex ones it is twice as large, and
    X^(size / 2) is the imaginary unit.  A coefficient of a product must be below X/2 in absolute
    value.
    """

    def __init__(self, box, digits, is_real):
        self.apart, self.powers, self.turns = box.places
        self.is_real, self.digits = is_real, digits
        self.size = self.apart * (1 if is_real else 2)
        if digits * self.size > MAX_DIGITS:
            raise NotConfirmed("numbers of more than %d digits are needed, the checker's limit"
                               % MAX_DIGITS)
        self.half = 5 * 10 ** (digits - 1)
        self.blank = decimal.Decimal(str(self.half) * self.size)
        # X^size + 1 and, rounded up, half of that.
        self.modulus = EXACT.add(EXACT.scaleb(decimal.Decimal(1), digits * self.size), 1)
        self.most = EXACT.add(EXACT.scaleb(decimal.Decimal(5), digits * self.size - 1), 1)

    def pack(self, re, im):
        """The number of a series."""
        half, apart, form = self.half, self.apart, ("%%0%dd" % self.digits).__mod__
        numbers = [half] * self.size    # the highest power first
        if self.is_real:
            for at, quarters, x in zip(self.powers, self.turns, re):
                numbers[~at] = half - x if quarters & 1 else half + x
        else:
            for at, quarters, x, y in zip(self.powers, self.turns, re, im or itertools.repeat(0)):
                x, y = turn(x, y, quarters)
                numbers[~at] = half + x
                numbers[~at - apart] = half + y
        # A list of all texts would take many times their space.
        text = "".join(["".join(map(form, numbers[at:at + TEXTS]))
                        for at in range(0, self.size, TEXTS)])
        return EXACT.subtract(decimal.Decimal(text), self.blank)

    def unpack(self, number, bits):
        """(re, im or None) of a product, times 2^-bits, rounded down."""
        digits, half = self.digits, self.half
        length = digits * self.size
        high = EXACT.shift(number, -length)
        number = EXACT.subtract(EXACT.subtract(number, EXACT.scaleb(high, length)), high)
        while number.copy_abs() > self.most:
            number = EXACT.subtract(number, self.modulus.copy_sign(number))
        text = str(EXACT.add(number, self.blank)).rjust(length, "0")
        re, im = [], None if self.is_real else []
        for at, quarters in zip(self.powers, self.turns):
            at = length - (at + 1) * digits
            x = int(text[at:at + digits]) - half
            if im is None:
                re.append((-x if quarters & 1 else x) >> bits)
                continue
            at -= digits * self.apart
            x, y = turn(x, int(text[at:at + digits]) - half, -quarters)
            re.append(x >> bits)
            im.append(y >> bits)
        return re, im


def turn(x, y, quarters):
    """x + iy times i^quarters."""
    if quarters & 2:
        x, y = -x, -y
    return (-y, x) if quarters & 1 else (x, y)


class Ring:
    """Series over a box with coefficients in units of 2^-bits, in the norm of sigma > 1."""

    def __init__(self, box, sigma, bits):
        self.box, self.bits, self.one, self.sigma = box, bits, 1 << bits, sigma
        self.powers = powers_of(sigma, box.limit)
        self.ones = (box.degree + 1) * sum([self.powers[length] for length in box.lengths])

    @functools.cached_property
    def _aside(self):
        """A bound, in units of 2^-FINE, for a pair of modes that is left out: where it comes to
        lie, over the product of their norms."""
        norm, box = self.box.norm, self.box
        return self.powers[min(norm(norm.basis[0]), box.limit)] if box.degree else 1 << FINE

    # ---- norms, in units of 2^-(bits + FINE)

    def sizes(self, f):
        """Upper bounds of the norms of all coefficients, in units of 2^-bits."""
        flat = [x for entry in f.entries for x in entry if x is not None]
        if len(flat) == 1:
            return list(map(abs, flat[0]))
        squares = [sum([x * x for x in values]) for values in zip(*flat)]
        if min(f.rows, f.columns) > 1:  # |F|_2^2 = (|F|^2 + root(|F|^4 - 4 |det F|^2)) / 2
            zero = [0] * self.box.count
            parts = [x for re, im in f.entries for x in (re, im or zero)]
            for at, (a, x, b, y, c, z, d, w) in enumerate(zip(*parts)):
                re, im = a * d - x * w - b * c + y * z, a * w + x * d - b * z - y * c
                square = squares[at]
                root = square * square - 4 * (re * re + im * im)
                squares[at] = (square + (math.isqrt(root) + 1 if root > 0 else 0) + 1) // 2
        return [x and math.isqrt(x) + 1 for x in squares]

    def profile(self, f):
        """For each j the sums of |F_kj| sigma^|k| over |k| = 0, 1, ..., limit."""
        found = [[0] * (self.box.limit + 1) for _ in range(self.box.degree + 1)]
        sizes, step = self.sizes(f), self.box.degree + 1
        for j, sums in enumerate(found):
            for length, x in zip(self.box.lengths, sizes[j::step]):
                sums[length] += x
            sums[:] = [x * y for x, y in zip(sums, self.powers)]
        return found

    def norm(self, f):
        return sum(map(sum, self.profile(f))) + f.radius

    def product_of_norms(self, x, y):
        return (x * y >> self.bits + FINE) + 1

    def rounding(self, f):
        """A bound of the error's norm, if each part of each entry is off by less than a unit."""
        return (1 + len(f.entries)) * self.ones

    # ---- sums and products

    def series(self, rows, columns, entries, radius=0):
        return Series(rows, columns, tuple(entries), radius)

    def constant(self, rows):
        """The unit matrix."""
        return self.more(self.series(rows, rows, [([0] * self.box.count, None)] * rows ** 2), 1)

    def more(self, f, number):
        """The sum of f and of a number times the unit matrix."""
        entries, at = list(f.entries), self.box.centre * (self.box.degree + 1)
        for place in range(0, len(entries), f.rows + 1):
            re, im = entries[place]
            entries[place] = re[:at] + [re[at] + number * self.one] + re[at + 1:], im
        return self.series(f.rows, f.columns, entries, f.radius)

    def multiply(self, f, g, spared=0):
        """The product.  Of two modes with |k + k'| > limit it is left out, and may come to lie on
        one within: neither is more than the product of their norms.  If |k + k'| <= limit, but
        j + j' > degree, it comes to k + k' + b_0: that is at most sigma^|b_0| times as much.
        The limit is the box's, or a smaller one, if it loses at most 2^spared times as much as
        roundings lose.
        """
        part, radius = self._planned(f, g, spared)
        return self.series(f.rows, g.columns, self.convolved(f, g, part), radius)

    def _planned(self, f, g, spared):
        """(part, radius) of a product that is computed up to part/PARTS of the limit."""
        p = self.profile(f)
        q = p if f is g else self.profile(g)
        m, n = sum(map(sum, p)), sum(map(sum, q))
        rounding = (1 + f.rows * g.columns) * self.ones
        beyond = self._beyond(p, q, self.box.limit)
        part, low, lost = PARTS, 0, 0   # by a smaller limit, whatever the powers of s
        sums = [[list(map(sum, zip(*each)))] for each in (p, q)]
        while part - low > 1:
            middle = (low + part) // 2
            more = self._beyond(*sums, self.box.limit * middle // PARTS)
            if more <= rounding << spared:
                part, lost = middle, more
            else:
                low = middle
        return part, self.product_of_norms(m + f.radius, g.radius) \
            + self.product_of_norms(n, f.radius) + rounding \
            + ((1 << FINE) + self._aside) * (beyond + lost) // (1 << FINE) + 1

    def convolved(self, f, g, part):
        """The entries of the product of f and of g up to part/PARTS of the limit, rounded down:
        Kronecker's substitution, with complex numbers as polynomials modulo X^period - i."""
        box, square = self.box, f is g
        if part < PARTS:
            box, places = box.inner(part)
            f, g = [replace(h, entries=tuple([tuple([x and [x[at] for at in places] for x in entry])
                                              for entry in h.entries])) for h in (f, g)]
        is_real = all(im is None for h in (f, g) for _, im in h.entries)

        def sizes(h):
            """(the largest, the largest sum of the parts of an entry), at least 1."""
            parts = [[x for x in entry if x is not None] for entry in h.entries]
            return (max(1, *[greatest(x) for entry in parts for x in entry]),
                    max(1, *[sum([sum(map(abs, x)) for x in entry]) for entry in parts]))

        (f_most, f_sum), (g_most, g_sum) = sizes(f), sizes(g)
        digits = len(str(2 * f.columns * min(f_most * g_sum, g_most * f_sum)))
        packing = Packing(box, digits, is_real)
        left = [packing.pack(*entry) for entry in f.entries]
        right = left if square else [packing.pack(*entry) for entry in g.entries]
        entries = []
        for i, j in itertools.product(range(f.rows), range(g.columns)):
            total = decimal.Decimal(0)
            for n in range(f.columns):
                total = EXACT.add(total, EXACT.multiply(left[i * f.columns + n],
                                                        right[n * g.columns + j]))
            entries.append(packing.unpack(total, self.bits))
        if part < PARTS:
            entries = [tuple([x and self._spread(x, places) for x in entry]) for entry in entries]
        return entries

    def _spread(self, values, places):
        found = [0] * self.box.count
        for at, x in zip(places, values):
            found[at] = x
        return found

    def _beyond(self, p, q, limit):
        """The sum of the products of all norms of modes that have |k| + |k'| > limit or
        j + j' > degree, from the two profiles."""
        # Of q, the last 0, 1, 2, ... lengths, added over the powers up to j for each j.
        tails = list(itertools.accumulate(
            [[0, *itertools.accumulate(reversed(sums))] for sums in q],
            lambda x, y: list(map(operator.add, x, y))))
        total, spare = 0, self.box.limit - limit
        for sums, rest in zip(p, reversed(tails)):      # rest: j' <= degree - j
            # |k'| > limit - |k|: the last |k| + spare of them, or all
            near = sums[:len(rest) - spare]
            total += sum(map(operator.mul, near, rest[spare:])) - sum(near) * rest[-1] \
                + sum(sums) * tails[-1][-1]
        return (total >> self.bits + FINE) + 1

    def exponential(self, f):
        """e^f of a series with values in numbers: Taylor's polynomial of f / 2^m, squared m times;
        (38) of docs/proofs/existence.md bounds the remainder."""
        size = self.norm(f)
        one = 1 << self.bits + FINE
        plans = []
        for m in range(64):
            if size >> m > one // 2:    # the remainder is less than twice its first term
                continue
            terms = [one]               # bounds of the norms of X^j / j!
            while terms[-1] > self.ones:
                terms.append((terms[-1] * ((size >> m) + 1) >> self.bits + FINE) // len(terms) + 1)
            # A product that counts for little needs fewer modes and digits; a square is faster.
            costs = [(math.log(max(x / self.ones, 1)) / math.log(one / self.ones))
                     ** (self.box.norm.dimension + 1) for x in terms]
            degree = len(terms) - 1
            for q in range(1, degree + 2):
                plans.append((0.75 * (m + (q > 1)) + max(q - 2, 0) + sum(costs[q:degree + 1:q]),
                              m, degree, q, 2 * terms[-1]))
            if len(plans) > 200:
                break
        if not plans:
            raise NotConfirmed("the torus is too far from the straight one")
        _, m, degree, q, remainder = min(plans)
        def down(values):
            return None if values is None else [x >> m for x in values]
        scaled = self.series(1, 1, [tuple(map(down, f.entries[0]))])
        scaled = self.series(1, 1, scaled.entries,
                             (f.radius >> m) + 1 + self.rounding(scaled))
        powers, smaller = [self.constant(1), scaled], (one // ((size >> m) + 1)).bit_length() - 1
        while len(powers) <= q:
            powers.append(self.multiply(powers[-1], scaled))
        total = None
        for first in range(degree // q * q, -1, -q):
            part = self._block(powers[:q], first)
            total = part if total is None else self.add(
                self.multiply(total, powers[q], first * smaller), part)
        total = self.series(1, 1, total.entries, total.radius + remainder)
        for _ in range(m):
            total = self.multiply(total, total)
        return total

    def _block(self, powers, first):
        """The sum of power_j / (first + j)!."""
        last = math.factorial(first + len(powers) - 1)
        factors = [last // math.factorial(first + j) for j in range(len(powers))]
        entry = []
        for parts in zip(*[power.entries[0] for power in powers]):
            terms = [(factor, part) for factor, part in zip(factors, parts) if part is not None]
            entry.append([x // last for x in weighted_sum(terms)] if terms else None)
        radius = sum([factor * power.radius for factor, power in zip(factors, powers)]) // last + 1
        found = self.series(1, 1, [tuple(entry)])
        return self.series(1, 1, [tuple(entry)], radius + self.rounding(found))

    def add(self, f, g):
        """f + g."""
        entries = [tuple([x if y is None else y if x is None else list(map(sum, zip(x, y)))
                          for x, y in zip(one, other)])
                   for one, other in zip(f.entries, g.entries)]
        return self.series(f.rows, f.columns, entries, f.radius + g.radius)


def conjugate(f, degree):
    """Returns the conjugate, for real angles, of a function with values in numbers."""
    re, im = [x and opposite(x, degree) for x in f.entries[0]]
    return Series(1, 1, ((re, im and [-x for x in im]),), f.radius)


def opposite(values, degree):
    """Returns a list with the value at (-k, j) in the place of (k, j)."""
    step = degree + 1
    return [x for at in range(len(values) - step, -1, -step) for x in values[at:at + step]]


def weighted_sum(terms):
    """The sum of factor times list."""
    factors = [factor for factor, _ in terms]
    if len(factors) == 1:
        return [factors[0] * x for x in terms[0][1]]
    if len(factors) == 2:
        p, q = factors
        return [p * x + q * y for x, y in zip(terms[0][1], terms[1][1])]
    return [sum([p * x for p, x in zip(factors, values)])
            for values in zip(*[values for _, values in terms])]
