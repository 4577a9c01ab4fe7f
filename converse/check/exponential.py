"""e^(i s) of a real function s, given as a series without radius: step (T5e) of
docs/checker.md.  An approximation is guessed, in few products, and then judged by one more.
"""

import math
from fractions import Fraction

from .field import Norm, exponential_above
from .series import FINE, Box, Ring

SPARE_BITS = 12                         # of an approximation, beyond half of those of the next


class Line:
    """For series over the box of a ring, of degree 0: D = -i d/dxi, xi the angle of the frame with
    the larger weight, and the restriction to xi = 0, a series in the other angle, if there is one.
    """

    def __init__(self, ring):
        box, norm, n = ring.box, ring.box.norm, ring.box.norm.dimension
        at = max(range(n), key=lambda i: norm.alpha[i])
        # Of each mode D's factor, and its mode of the restriction.
        self.factors, rest = [], []
        for b, (_, first, count) in box.rows.items():
            starts, slopes = norm.forms(b)
            for a in range(first, first + count):
                self.factors.append(starts[at] + a * slopes[at])
                rest.append(starts[1 - at] + a * slopes[1 - at] if n > 1 else 0)
        self.ring = Ring(Box(Norm([[1]], [norm.alpha[1 - at] if n > 1 else 1], [(1,)]),
                             box.limit if n > 1 else 0, 0), ring.sigma, ring.bits)
        self.places = [self.ring.box.find((b,)) for b in rest]

    def derivative(self, f):
        """Df; its radius is not bounded."""
        (entry,) = f.entries
        return f.of([x and [y * by for y, by in zip(x, self.factors)] for x in entry])

    def restricted(self, f):
        """f at xi = 0: as |k| is no less than the part of the other angle, its norm is no larger.
        """
        found = []
        for x in f.entries[0]:
            sums = x and [0] * self.ring.box.count
            for y, at in zip(x or (), self.places):
                sums[at] += y
            found.append(sums)
        return f.of(found, f.radius)


def exponential_of_imaginary(ring, f):
    """e^f, f = i s."""
    if ring.box.degree:                 # what is left out of powers of s would count for too much
        return ring.exponential(f)
    line = Line(ring)
    slope, g = line.derivative(f), guess(ring, f)
    product = ring.multiply(slope, g)
    rest = difference(line.derivative(g), product)
    # What of the rest D makes out of something, and how large that is; and all else.
    found, other = 0, product.radius
    for x, by, weight in zip(ring.sizes(rest), line.factors, ring.weights):
        if by:
            found -= -x * weight // abs(by)
        else:
            other += x * weight
    one, small = 1 << ring.bits + FINE, line.ring
    start = small.multiply(line.restricted(g), small.exponential(negative(line.restricted(f))))
    height = exponential_above(Fraction(ring.norm(f), one))
    radius = height * (small.norm(small.more(start, -1)) + 2 * height * (
        other + (1 + Fraction(ring.norm(slope), one)) * found))
    return g.of(g.entries[0], math.ceil(radius))


def guess(ring, f):
    """A polynomial near e^f, but nothing is proved: Newton's method, in each step with about twice
    the bits, and to twice the |k|."""
    bits, box = ring.bits // 2 + SPARE_BITS, ring.box
    if bits > ring.bits * 3 // 4:
        return ring.exponential(f).without_radius
    coarse = Ring(Box(box.norm, math.ceil(box.limit * Fraction(bits, ring.bits)), 0), ring.sigma,
                  bits)
    line, shift = Line(ring), ring.bits - bits
    g = moved(guess(coarse, moved(f, box, coarse.box, -shift)), coarse.box, box, 0)
    fine, back = moved(g, box, box, shift), conjugate(g, 0)

    def product(x, y):
        return x.of(ring.convolved(x, y, bits)[0])

    # g = e^f (1 + h), so D g - g D f = g D h, and about 1/g is conj g: where D is not 0, that is.
    change = product(difference(line.derivative(fine), product(line.derivative(f), g)), back)
    change = change.of([x and [y // by if by else 0 for y, by in zip(x, line.factors)]
                        for x in change.entries[0]])
    small = line.ring
    start = line.restricted(fine)
    off = difference(start, small.exponential(line.restricted(f)))
    off = difference(off.of(small.convolved(off, conjugate(start, 0), small.bits)[0]),
                     line.restricted(change))
    change = change.of([x and [y if by else z[at] for y, by, at in zip(
        x, line.factors, line.places)] for x, z in zip(change.entries[0], off.entries[0])])
    return difference(fine, product(change, g))


def difference(f, g):
    """f - g, without its radius."""
    return f.of([x and [p - q for p, q in zip(x, y)] for x, y in zip(f.entries[0], g.entries[0])])


def negative(f):
    return f.of([x and [-y for y in x] for x in f.entries[0]], f.radius)


def conjugate(f, degree):
    """The conjugate function, for real angles."""
    re, im = [x and reversed_(x, degree) for x in f.entries[0]]
    return f.of([re, im and [-x for x in im]], f.radius)


def reversed_(values, degree):
    """Those at -k, for all k."""
    if not degree:
        return values[::-1]
    step = degree + 1
    return [x for at in range(len(values) - step, -1, -step) for x in values[at:at + step]]


def moved(f, box, to, shift):
    """f times 2^shift, rounded down, with those of its modes that are in another box, too, which
    has another limit alone."""
    found = []
    for values in f.entries[0]:
        if values is not None:
            if shift < 0:
                values = [x >> -shift for x in values]
            elif shift:
                values = [x << shift for x in values]
            new = [0] * to.count
            for b in set(box.rows) & set(to.rows):
                (at, first, count), (start, other, more) = box.rows[b], to.rows[b]
                low, high = max(first, other), min(first + count, other + more)
                new[start + low - other:start + high - other] = \
                    values[at + low - first:at + high - first]
            values = new
        found.append(values)
    return f.of(found)
