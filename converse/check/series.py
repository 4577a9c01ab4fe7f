"""Fourier series with integer coefficients and a bound of what they leave out: step (T5) of
docs/checker.md.

A series is a function of n angles and perhaps of a parameter s, with values in matrices: a
polynomial with the modes e^(i k.theta) s^j of a box, and a radius.  All is measured in the norm
that is the sum of |F_kj| sigma^|k|, |.| being the spectral norm of a matrix: so is how far the
function is from the polynomial, which is at most the radius.
"""

import decimal
import itertools
import math
from dataclasses import dataclass

from .failures import NotConfirmed
from .limits import MAX_DIGITS, MAX_TERMS

FINE = 64                               # bits that norms have beyond the coefficients
EXACT = decimal.Context(prec=decimal.MAX_PREC, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN,
                        traps=[decimal.Inexact, decimal.Rounded, decimal.InvalidOperation])


def greatest(numbers):
    """Of the absolute values."""
    return max(max(numbers), -min(numbers)) if numbers else 0


def powers_of(sigma, count):
    """sigma^0 to sigma^count, rounded up, in units of 2^-FINE."""
    found = [1 << FINE]
    while len(found) <= count:
        found.append(-(-found[-1] * sigma.numerator // sigma.denominator))
    return found


class Box:
    """The modes (k, j) with |k| <= limit and j <= degree, k in a lattice, in the order of the
    coordinates b, a of k and of j.

    A group is all modes with one k.  At (b W + a) J + j, with the number W of all a, these modes
    are the powers of one variable, in which series are multiplied.
    """

    def __init__(self, norm, limit, degree):
        self.norm, self.limit, self.degree = norm, limit, degree
        self.reach = [math.floor(w * limit) for w in norm.widths()]
        (wide, high), steps = (self.reach + [0])[:2], 2 * degree + 1
        self.wide, self.high = wide, high
        self.size = (2 * wide + 1) * (2 * high + 1) * steps
        self.origin = ((2 * wide + 1) * high + wide) * steps
        # The sums over modes of equal |k| of two series are multiplied for each pair of powers.
        terms = max(self.size, (limit + 1) * (degree + 1) ** 2)
        if terms > MAX_TERMS:
            raise NotConfirmed("series of %d terms are needed, the checker's limit is %d"
                               % (terms, MAX_TERMS))
        self.rows, self.lengths, self.runs = {}, [], []     # of row b: its first group, least a
        slopes = [sum(x * y for x, y in zip(row, norm.basis[0])) for row in norm.frame]
        for b in range(-high, high + 1):
            starts = [sum(x * b * y for x, y in zip(row, norm.basis[-1])) * (len(slopes) > 1)
                      for row in norm.frame]
            terms = list(zip(norm.alpha, starts, slopes))
            found = [(a, length) for a in range(-wide, wide + 1)
                     if (length := sum([w * abs(p + q * a) for w, p, q in terms])) <= limit]
            if not found:
                continue
            self.rows[b] = len(self.lengths), found[0][0], len(found)
            self.lengths += [length for _, length in found]
            first = ((b + high) * (2 * wide + 1) + found[0][0] + wide) * steps
            if degree:
                self.runs += [(first + at * steps, degree + 1) for at in range(len(found))]
            else:
                self.runs.append((first, len(found)))
        self.groups = len(self.lengths)
        self.centre = self.groups // 2  # k = 0: opposite k are opposite in order
        self.count = self.groups * (degree + 1)

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
    """Of rows times columns entries, each (real parts, imaginary parts or None), lists in the order
    of the box, in units of 2^-bits of its ring; the radius in units of 2^-(bits + FINE)."""

    rows: int
    columns: int
    entries: tuple
    radius: int

    @property
    def transposed(self):
        return Series(self.columns, self.rows, tuple([
            self.entries[j * self.columns + i]
            for i in range(self.columns) for j in range(self.rows)]), self.radius)


class Ring:
    """Series over a box with coefficients in units of 2^-bits, in the norm of sigma > 1."""

    def __init__(self, box, sigma, bits):
        self.box, self.bits, self.one, self.sigma = box, bits, 1 << bits, sigma
        self.powers = powers_of(sigma, box.limit)
        self.ones = (box.degree + 1) * sum([self.powers[length] for length in box.lengths])

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
        """What it is at most in norm, if each part of each entry is off by less than a unit."""
        return (1 + len(f.entries)) * self.ones

    # ---- sums and products

    def series(self, rows, columns, entries, radius=0):
        return Series(rows, columns, tuple(entries), radius)

    def constant(self, rows):
        """The unit matrix."""
        return self.more(self.series(rows, rows, [([0] * self.box.count, None)] * rows ** 2), 1)

    def more(self, f, number):
        """f and so many unit matrices."""
        entries, at = list(f.entries), self.box.centre * (self.box.degree + 1)
        for place in range(0, len(entries), f.rows + 1):
            re, im = entries[place]
            entries[place] = re[:at] + [re[at] + number * self.one] + re[at + 1:], im
        return self.series(f.rows, f.columns, entries, f.radius)

    def multiply(self, f, g):
        """The product.  Its modes beyond the box are left out, and while the box is a period of
        what is multiplied (Kronecker's substitution) they may come to lie on those within; neither
        is more than the sum over these pairs of modes of the product of their norms."""
        box, zero = self.box, decimal.Decimal(0)
        parts = [x for h in (f, g) for entry in h.entries for x in entry if x is not None]
        sums = max(sum(map(abs, x)) for entry in g.entries for x in entry if x is not None)
        most = max(map(greatest, parts))
        digits = len(str(8 * f.columns * most * max(sums, 1))) + 1
        if digits * box.size > MAX_DIGITS:
            raise NotConfirmed("numbers of more than %d digits are needed, the checker's limit"
                               % MAX_DIGITS)

        # Complex numbers are multiplied with three products instead of four.
        def packed(h):
            found = []
            for re, im in h.entries:
                x = self._pack(re, digits)
                y = None if im is None else x if im is re else self._pack(im, digits)
                found.append((x, y, None if y is None else EXACT.add(x, y)))
            return found

        left = packed(f)
        right = left if f is g else packed(g)
        entries = []
        for i, j in itertools.product(range(f.rows), range(g.columns)):
            re = im = zero
            is_real = True
            for n in range(f.columns):
                x, y, xy = left[i * f.columns + n]
                u, v, uv = right[n * g.columns + j]
                first = EXACT.multiply(x, u)
                re = EXACT.add(re, first)
                if y is None and v is None:
                    continue
                is_real = False
                if y is None:
                    im = EXACT.add(im, EXACT.multiply(x, v))
                elif v is None:
                    im = EXACT.add(im, EXACT.multiply(y, u))
                else:
                    second = EXACT.multiply(y, v)
                    re = EXACT.subtract(re, second)
                    im = EXACT.add(im, EXACT.subtract(EXACT.multiply(xy, uv),
                                                      EXACT.add(first, second)))
            entries.append((self._unpack(re, digits),
                            None if is_real else self._unpack(im, digits)))
        p = self.profile(f)
        q = p if f is g else self.profile(g)
        m, n = sum(map(sum, p)), sum(map(sum, q))
        found = self.series(f.rows, g.columns, entries)
        radius = self.product_of_norms(m + f.radius, g.radius) \
            + self.product_of_norms(n, f.radius) + 2 * self._beyond(p, q) + self.rounding(found)
        return self.series(f.rows, g.columns, entries, radius)

    def _beyond(self, p, q):
        """The sum of the products of all norms of modes that have |k| + |k'| > limit or
        j + j' > degree, from the two profiles."""
        tails = []
        for sums in q:
            rest = list(itertools.accumulate(reversed(sums)))       # of the last 1, 2, ...
            tails.append(rest)
        total = 0
        for i, sums in enumerate(p):
            whole = sum(sums)
            for j, rest in enumerate(tails):
                if i + j > self.box.degree:
                    total += whole * rest[-1]
                else:                   # |k'| > limit - |k|: the last |k| of them
                    total += sum([x * y for x, y in zip(sums[1:], rest)])
        return (total >> self.bits + FINE) + 1

    def _pack(self, values, digits):
        """The sum of value 10^(digits place), the first mode having the highest place."""
        size, half = self.box.size, 5 * 10 ** (digits - 1)
        blank, form = "5" + "0" * (digits - 1), "%%0%dd" % digits
        text, at, place = [], 0, 0
        for first, count in self.box.runs:
            text.append(blank * (first - place))
            text += [form % (x + half) for x in values[at:at + count]]
            at, place = at + count, first + count
        text.append(blank * (size - place))
        return EXACT.subtract(decimal.Decimal("".join(text)), decimal.Decimal(blank * size))

    def _unpack(self, number, digits):
        """Those of the places of a product that are in the box, in units of 2^-bits, rounded down;
        the product's value at the place i + j is that of the factors' places i and j."""
        places, half = 2 * self.box.size - 1, 5 * 10 ** (digits - 1)
        blank = decimal.Decimal(("5" + "0" * (digits - 1)) * places)
        text = str(EXACT.add(number, blank)).rjust(places * digits, "0")
        found, bits = [], self.bits
        for first, count in self.box.runs:
            start = (first + self.box.origin) * digits
            found += [int(text[at:at + digits]) - half >> bits
                      for at in range(start, start + count * digits, digits)]
        return found

    def exponential(self, f):
        """e^f of a series with values in numbers: Taylor's polynomial of f / 2^m, squared m times.
        """
        size = self.norm(f)
        one = 1 << self.bits + FINE
        plans = []
        for m in range(64):
            if size >> m > one // 2:    # the remainder is less than twice its first term
                continue
            degree, term = 0, one
            while term > self.ones:
                degree += 1
                term = (term * ((size >> m) + 1) >> self.bits + FINE) // degree + 1
            for q in range(1, degree + 2):
                plans.append((m + q - 1 + degree // q, m, degree, q, 2 * term))
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
        powers = [self.constant(1), scaled]
        while len(powers) <= q:
            powers.append(self.multiply(powers[-1], scaled))
        total = None
        for first in range(degree // q * q, -1, -q):
            part = self._block(powers[:q], first)
            total = part if total is None else self.add(self.multiply(total, powers[q]), part)
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
