"""Rotation vectors in real number fields of degree 2 and 3, and how near to whole turns their
multiples come.  Rational arithmetic; steps (T2) and (T3) of docs/proofs/checker.md.

A polynomial is the tuple of its coefficients, the constant one first; an element of the field of
its root t is the tuple of its coordinates in 1, t, t^2.  An interval is a pair of rationals.
"""

import itertools
import math
from fractions import Fraction

from .arith import determinant, dot, inverse_rows
from .failures import NotConfirmed, Rejected

MAX_DIVISORS = 1 << 21                  # of a rotation, computed one by one
PRIMES = [p for p in range(2, 2000) if all(p % d for d in range(2, math.isqrt(p) + 1))]
PI_LOW, PI_HIGH = Fraction(314159265358979, 10 ** 14), Fraction(314159265358980, 10 ** 14)
E_LOW = Fraction(271828182845904, 10 ** 14)
SHARES = 64                             # An edge of the unit ball is cut into this number of parts.
BITS = 256                              # The root is first computed to this number of bits.
TURN_BITS = 192                         # k.omega modulo 1 is computed to this number of bits.
LARGE = "the rotation vector has too large coefficients for this checker"
SHY = 16                                # Divisors above SHY times the tail's bound do not count.


def rounded_up(x, bits=80, sign=-1):
    """A dyadic rational not below x >= 0, and above it by less than 2^(1-bits) of it."""
    shift = bits - x.numerator.bit_length() + x.denominator.bit_length()
    scaled = sign * ((sign * x.numerator << max(shift, 0)) // (x.denominator << max(-shift, 0)))
    return Fraction(scaled << max(-shift, 0), 1 << max(shift, 0))


def rounded_down(x, bits=80):
    """A dyadic rational not above x >= 0, and below it by less than 2^(1-bits) of it."""
    return rounded_up(x, bits, 1)


def upper_root(x):
    """A rational not below the root of x >= 0."""
    x = rounded_up(Fraction(x)) * 4 ** 64
    return Fraction(math.isqrt(math.floor(x)) + 1, 2 ** 64)


def exponential_above(x, rounded=rounded_up, last=2):
    """A rational not below e^x, x >= 0: of Taylor's series on [0, 1] all terms after the 12th are
    at most `last` = 2 times the next."""
    if x > 1:
        return rounded(exponential_above(x / 2, rounded, last) ** 2)
    return rounded(sum([x ** j / math.factorial(j) for j in range(13)])
                   + last * x ** 13 / math.factorial(13))


def exponential_below(x):
    """A rational not above e^x, x >= 0."""
    return exponential_above(x, rounded_down, 0)


def evaluate(polynomial, x):
    value = 0
    for coefficient in reversed(polynomial):
        value = value * x + coefficient
    return value


def is_irreducible(polynomial):
    """Is there a prime modulo which the polynomial, of degree 2 or 3, keeps its degree and has no
    root?  Then it is irreducible.  (An irreducible one has such primes: a third, or more.)"""
    return any(polynomial[-1] % p and all(evaluate(polynomial, x) % p for x in range(p))
               for p in PRIMES)


def variations(values):
    """Changes of sign."""
    signs = [value > 0 for value in values if value]
    return sum(x != y for x, y in zip(signs, signs[1:]))


def roots_between(polynomial, low, high):
    """How many different real roots are in low < x <= high: Sturm's theorem."""
    chain = [list(map(Fraction, polynomial)),
             [n * x for n, x in enumerate(map(Fraction, polynomial)) if n]]
    while len(chain[-1]) > 1:
        rest, by = list(chain[-2]), chain[-1]
        while len(rest) >= len(by):
            factor = rest[-1] / by[-1]
            for at in range(1, len(by) + 1):
                rest[-at] -= factor * by[-at]
            rest.pop()
        while rest and not rest[-1]:
            rest.pop()
        if not rest:
            break
        chain.append([-x for x in rest])
    return variations([evaluate(p, low) for p in chain]) \
        - variations([evaluate(p, high) for p in chain])


def times(x, y):
    """The product of two intervals."""
    products = [p * q for p in x for q in y]
    return min(products), max(products)


def plus(x, y):
    return x[0] + y[0], x[1] + y[1]


def size(x):
    return max(map(abs, x))


class Field:
    """The real numbers Q(t), t the only root of an irreducible polynomial between two rationals."""

    def __init__(self, polynomial, low, high):
        if not is_irreducible(polynomial):
            raise Rejected("the polynomial is not irreducible")
        if not low < high or roots_between(polynomial, low, high) != 1:
            raise Rejected("there is not exactly one root of the polynomial between these bounds")
        self.polynomial, self.degree = polynomial, len(polynomial) - 1
        self.low, self.high = low, high
        self.rises = evaluate(polynomial, high) > 0         # it is irreducible: no zero

    def root(self, bits):
        """An interval of length 2^-bits that holds t."""
        low, high = self.low, self.high
        a, b = math.floor(low * 2 ** bits), math.ceil(high * 2 ** bits)
        while b - a > 1:
            c = (a + b) // 2            # between low and high
            if (evaluate(self.polynomial, Fraction(c, 1 << bits)) > 0) == self.rises:
                b = c
            else:
                a = c
        return Fraction(a, 1 << bits), Fraction(b, 1 << bits)

    def interval(self, element, bits=BITS):
        t, value = self.root(bits), (Fraction(0), Fraction(0))
        for coordinate in reversed(element):
            value = plus(times(value, t), (coordinate, coordinate))
        return value

    def in_units(self, element, bits):
        """An integer within 3/4 of 2^bits times the element: the middle of an interval shorter than
        1/2 is within 1/4, and rounding adds 1/2 at most."""
        for more in (64, 512, 2048, 8192):
            low, high = [x * 2 ** bits for x in self.interval(element, bits + more)]
            if high - low < Fraction(1, 2):
                return round((low + high) / 2)
        raise NotConfirmed(LARGE)

    def truncated(self, element, places):
        """The element to `places` decimal places, rounded towards 0.  Both ends of an interval that
        contains it agree on these places, so they are right even if large coordinates cancel."""
        for bits in (BITS, 512, 2048, 8192):
            low, high = [math.trunc(x * 10 ** places) for x in self.interval(element, bits)]
            if low == high:
                return Fraction(low, 10 ** places)
        raise NotConfirmed(LARGE)

    def product(self, x, y):
        """The product of two elements."""
        found = [Fraction(0)] * (2 * self.degree - 1)
        for (i, a), (j, b) in itertools.product(enumerate(x), enumerate(y)):
            found[i + j] += a * b
        while len(found) > self.degree:
            last = found.pop() / self.polynomial[-1]
            for at in range(self.degree):
                found[at - self.degree] -= last * self.polynomial[at]
        return tuple(found)

    def norm_denominator(self, elements):
        """The common denominator of the coefficients of det(p + sum of m_j M_j), a polynomial in p
        and m, M_j the matrix of the multiplication by the element j."""
        size_ = self.degree
        units = [tuple([int(i == j) for j in range(size_)]) for i in range(size_)]
        matrices = [units] + [[self.product(element, unit) for unit in units]
                              for element in elements]
        total = {}
        for order in itertools.permutations(range(size_)):
            sign = (-1) ** sum(order[i] > order[j] for j in range(size_) for i in range(j))
            for choice in itertools.product(range(len(matrices)), repeat=size_):
                term = Fraction(sign)
                for row, (column, which) in enumerate(zip(order, choice)):
                    term *= matrices[which][row][column]
                key = tuple(sorted(choice))
                total[key] = total.get(key, 0) + term
        return math.lcm(*[value.denominator for value in total.values()])


def combination(numbers, vectors):
    """The sum of number times vector."""
    return tuple([dot(numbers, column) for column in zip(*vectors)])


class Norm:
    """The norm |k| of a mode k, a sum of alpha_i |l_i.k| with integer alpha_i; the l_i are the rows
    of the frame.  k is in a lattice, with coordinates m in which the ball is about as wide as high.
    """

    def __init__(self, frame, alpha, basis):
        self.frame, self.alpha, self.dimension = frame, alpha, len(alpha)
        # The ball |k| <= 1 is the convex hull of these and their opposites.
        self.vertices = [tuple(x / a for x in column)
                         for column, a in zip(zip(*inverse_rows(frame)), alpha)]
        self.basis = self._balanced(basis)
        self.kappa = max(upper_root(sum(x * x for x in v)) for v in self.vertices)

    def __call__(self, k):
        return sum([a * abs(dot(row, k)) for a, row in zip(self.alpha, self.frame)])

    def count(self, limit):
        """About how many k of the lattice have |k| <= limit."""
        cell = math.prod(self.alpha) * abs(determinant(self.frame) * determinant(self.basis))
        return (2 * limit) ** self.dimension // (self.dimension * cell) + 1

    def row(self, b, limit):
        """(least, largest) a of the k = a b_0 + b b_1 with |k| <= limit; none, if least > largest.

        |k| is the largest of the forms, linear in a, that have any signs of the l_i.k."""
        low, top = -math.inf, math.inf
        starts, slopes = self.forms(b)
        for signs in itertools.product((1, -1), repeat=self.dimension):
            start = sum([s * a * x for s, a, x in zip(signs, self.alpha, starts)])
            slope = sum([s * a * x for s, a, x in zip(signs, self.alpha, slopes)])
            if slope > 0:
                top = min(top, (limit - start) // slope)
            elif slope < 0:
                low = max(low, -((limit - start) // -slope))
            elif start > limit:
                return 0, -1
        return low, top

    def forms(self, b):
        """The l_i.k of k = a b_0 + b b_1: (at a = 0, per a)."""
        last = self.basis[1] if self.dimension > 1 else (0,)
        return [[dot(row, v) for row in self.frame]
                for v in ([b * x for x in last], self.basis[0])]

    def lengths(self, b, low, top):
        """|k| of those k with low <= a <= top."""
        terms = list(zip(self.alpha, *self.forms(b)))
        return [sum([w * abs(p + q * a) for w, p, q in terms]) for a in range(low, top + 1)]

    def coordinates(self, k, basis=None):
        """The coordinates of k in the lattice's basis: rationals, integers on the lattice."""
        return combination(k, inverse_rows(basis or self.basis))

    def place(self, k):
        """The coordinates of k in the lattice's own basis; None: k is not in the lattice."""
        if self.dimension == 1:
            (p,), d = k, self.basis[0][0]
            return (p // d,) if not p % d else None
        (p, q), ((a, b), (c, d)) = k, self.basis
        det = a * d - b * c
        x, y = p * d - q * c, q * a - p * b
        return (x // det, y // det) if not x % det and not y % det else None

    def widths(self, basis=None):
        """How large the coordinates are in the ball |k| <= 1."""
        return [max(map(abs, column))
                for column in zip(*[self.coordinates(v, basis) for v in self.vertices])]

    def _balanced(self, basis):
        """Another basis of the lattice, with a smaller box about the ball."""
        while self.dimension == 2:
            (a, b), (c, d) = basis
            others = [[(a, b), (c + s * a, d + s * b)] for s in (-1, 1)] \
                + [[(a + s * c, b + s * d), (c, d)] for s in (-1, 1)]
            best = min(others, key=lambda x: math.prod(self.widths(x)))
            if math.prod(self.widths(best)) >= math.prod(self.widths(basis)):
                break
            basis = best
        return basis


class Divisors:
    """Lower bounds of |1 - e^(2 pi i k.omega)| for all k != 0 of a lattice: (T3).

    Raises Rejected, if 1 and the numbers b.omega are dependent over the rationals, b in a basis of
    the lattice; NotConfirmed, if too many k would have to be looked at one by one.
    """

    def __init__(self, field, omega, norm):
        self.norm, self.power = norm, norm.dimension
        elements = [combination(b, omega) for b in norm.basis]
        n = self.power
        if not determinant([element[1:] for element in elements]):
            raise Rejected("1 and the components of the rotation vector are linearly dependent")
        denominator = field.norm_denominator(elements)
        corners = [norm.coordinates(v) for v in norm.vertices]
        largest = self._largest_form(field, elements, corners)
        first = 1 / (denominator * largest)
        mu = self._conjugates(field, elements, corners) if n == 2 else Fraction(1)

        def rest(radius):
            if n == 1:
                return first / radius ** 2
            return first * mu / radius ** 3 + (first / radius ** 3) ** 2

        radius = 32 if n == 1 else 4
        while rest(radius) > largest / 64:
            radius = radius * 5 // 4
            if math.prod([2 * w * radius + 1 for w in norm.widths()]) > MAX_DIVISORS:
                raise NotConfirmed("the rotation vector has too many small divisors to be looked "
                                   "at one by one")
        gamma = rounded_down(1 / (denominator * (largest + rest(radius))))
        near = gamma / radius ** n
        if near > Fraction(1, 2):
            raise NotConfirmed("the small divisors have no bound")     # never, for such radii
        self.tail = rounded_down(2 * PI_LOW * gamma * (1 - (PI_HIGH * near) ** 2 / 6))
        self.field, self.elements = field, elements
        self._look(radius)

    def look(self, radius):
        """Looks at all k one by one up to this radius, or as far as is not too much work."""
        most = min(radius, math.floor((MAX_DIVISORS / 4 / math.prod(
            [2 * float(w) for w in self.norm.widths()])) ** (1 / self.power)))
        if most > self.radius:
            self._look(most)

    @staticmethod
    def _largest_form(field, elements, corners):
        """An upper bound of the product over the other conjugates i of |l_i(k)|, |k| = 1."""
        f = field.polynomial
        slope = field.interval([Fraction(n * c, f[-1]) for n, c in enumerate(f) if n])
        t = field.interval((Fraction(0), Fraction(1)))
        if len(corners) == 1:
            return rounded_up(size(slope) * max(abs(combination(corners[0], elements)[1]), 0))
        total = plus((-Fraction(f[2], f[3]),) * 2, (-t[1], -t[0]))          # of the other roots
        product = plus(times(t, plus(t, (Fraction(f[2], f[3]),) * 2)), (Fraction(f[1], f[3]),) * 2)

        def polar(v, w):
            """The bilinear form of the product of l_1 and l_2."""
            (_, a, b), (_, c, d) = combination(v, elements), combination(w, elements)
            p, q = plus((a, a), times((b, b), t)), plus((c, c), times((d, d), t))
            mixed = plus(times(p, (d, d)), times(q, (b, b)))
            inner = plus(plus(times(p, q), times((Fraction(1, 2),) * 2, times(mixed, total))),
                         times((b * d, b * d), product))
            return size(times(slope, inner))

        found = 0
        for v, w in ((corners[0], corners[1]), (corners[0], [-x for x in corners[1]])):
            points = [combination((Fraction(SHARES - n, SHARES), Fraction(n, SHARES)), (v, w))
                      for n in range(SHARES + 1)]
            # A quadratic polynomial is between the least and the largest of its Bernstein
            # coefficients, the values of the bilinear form.
            found = max([found] + [polar(x, x) for x in points]
                        + [polar(x, y) for x, y in zip(points, points[1:])])
        return rounded_up(found)

    @staticmethod
    def _conjugates(field, elements, corners):
        """An upper bound of the sum over both other conjugates of the largest |l_i(k)|, |k| = 1."""
        f = field.polynomial
        root = 1 + max(abs(Fraction(c, f[-1])) for c in f)      # Cauchy's bound
        found = 0
        for corner in corners:
            _, a, b = combination(corner, elements)
            found = max(found, 2 * 2 * root * (abs(a) + 2 * abs(b) * root))
        return rounded_up(found)

    def _look(self, radius):
        """Finds the records: (|k|, lower bound) of each 0 < |k| <= radius whose divisor is smaller
        than SHY times the tail's bound, and smaller than all divisors of smaller |k|.  No other k
        in the ball makes a supremum larger."""
        n, bits = self.power, TURN_BITS
        steps = [self.field.in_units(element, bits) for element in self.elements]
        reach = [math.floor(w * radius) for w in self.norm.widths()]
        one, found = 1 << bits, []
        limit = self.tail * SHY * one / 4
        lattice = itertools.product(*[range(-r, r + 1) for r in reach[1:]], range(reach[0] + 1))
        for *rest, first in lattice:
            m = (first, *rest)
            turn = dot(m, steps) % one
            near = min(turn, one - turn)
            length = self.norm(combination(m, self.norm.basis))
            if not 0 < length <= radius:
                continue
            near -= sum(map(abs, m))    # each step is off by less than a unit
            # 2 sin(pi x) >= 4 x up to 1/2: most k need no more than this.
            if near * length ** n >= limit:
                continue
            if near <= 0:
                raise NotConfirmed("the small divisors need more than %d bits" % bits)
            x = Fraction(near, one)
            found.append((length, rounded_down(
                2 * PI_LOW * x * (1 - (PI_HIGH * x) ** 2 / 6))))
        self.records, self.radius = [], radius
        for length, bound in sorted(found):
            if not self.records or bound < self.records[-1][1]:
                self.records.append((length, bound))

    @property
    def front(self):
        """The records that are worse than the tail's bound."""
        return [(length, bound) for length, bound in self.records
                if bound * length ** self.power < self.tail]

    @property
    def least(self):
        """Gamma with |1 - e^(2 pi i k.omega)| >= Gamma |k|^-n for all k != 0."""
        return min([self.tail] + [bound * length ** self.power for length, bound in self.front])

    def loss(self, delta):
        """An upper bound of the supremum over 0 < d <= delta and k of
        (d / delta)^n e^(-d |k|) / |1 - e^(2 pi i k.omega)|."""
        n = self.power
        found = (n / (E_LOW * delta)) ** n / self.tail
        for length, bound in self.front:
            x = delta * length
            if x >= n:
                found = max(found, (n / (E_LOW * x)) ** n / bound)
            else:                       # the supremum is at d = delta
                found = max(found, 1 / sum([x ** j / math.factorial(j) for j in range(7)]) / bound)
        return rounded_up(found)

    def loss_at(self, d):
        """An upper bound of the supremum over k of e^(-d |k|) / |1 - e^(2 pi i k.omega)|."""
        n, radius = self.power, self.radius
        generic = (n / (E_LOW * d)) ** n / self.tail
        beyond = generic if d * radius < n else \
            radius ** n / exponential_below(d * radius) / self.tail
        return rounded_up(max([generic / SHY, beyond] + [
            1 / exponential_below(d * length) / bound for length, bound in self.records]))
