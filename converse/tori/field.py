"""The number field Q(t) of a real root t of an irreducible polynomial, exactly.

An element is the tuple of its rational coefficients of 1, t, t^2, ...; what is said of its value
(sign, enclosure) follows from an enclosure of t by bisection, in integers.
"""

from fractions import Fraction
from functools import lru_cache
from math import gcd
from typing import List, NamedTuple, Sequence, Tuple

from ..check.field import roots_between
from ..model.exact import Ends

Element = Tuple[Fraction, ...]
Polynomial = Tuple[int, ...]            # ascending coefficients, the last not 0


def value_at(polynomial: Sequence, x):
    """The polynomial, given by ascending coefficients, at x."""
    total = 0
    for coefficient in reversed(polynomial):
        total = total * x + coefficient
    return total


class Field(NamedTuple):
    """polynomial -- irreducible, of degree 2 or 3; ascending integer coefficients
    root -- two rational numbers between which t is its only real root"""

    polynomial: Polynomial
    root: Ends

    @property
    def degree(self) -> int:
        return len(self.polynomial) - 1

    def element(self, coefficients: Sequence) -> Element:
        """A polynomial in t, given by ascending rational coefficients, as an element."""
        rest, lead = [Fraction(c) for c in coefficients], self.polynomial[-1]
        rest += [Fraction(0)] * (self.degree - len(rest))
        while len(rest) > self.degree:
            top = rest.pop() / lead
            for j in range(self.degree):
                rest[len(rest) - self.degree + j] -= top * self.polynomial[j]
        return tuple(rest)

    def product(self, a: Element, b: Element) -> Element:
        total = [Fraction(0)] * (len(a) + len(b) - 1)
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                total[i + j] += x * y
        return self.element(total)

    def inverse(self, a: Element) -> Element:
        """1/a.  ZeroDivisionError: a is 0."""
        columns = [self.element([Fraction(0)] * j + list(a)) for j in range(self.degree)]
        whole = determinant(columns)    # Cramer's rule: a, a t, a t^2 times these are 1
        one = self.element([Fraction(1)])
        return tuple(determinant([*columns[:j], one, *columns[j + 1:]]) / whole
                     for j in range(self.degree))

    def bounds(self, a: Element, digits: int) -> Ends:
        """The value of an element, to 10^-digits; exactly, if it is rational."""
        if not any(a[1:]):
            return a[0], a[0]
        bits = 4 * digits + 16
        while True:
            below = _floor(self.polynomial, self.root, bits)
            ends = Fraction(below, 1 << bits), Fraction(below + 1, 1 << bits)
            low = high = Fraction(0)
            for c in reversed(a):
                products = low * ends[0], low * ends[1], high * ends[0], high * ends[1]
                low, high = min(products) + c, max(products) + c
            if (high - low) * 10 ** digits <= 1:
                return low, high
            bits *= 2


@lru_cache(maxsize=64)
def _floor(polynomial, root, bits):
    """The integer below t 2^bits, t irrational and the only root between the two of `root`."""
    low, high = root
    sign_below = value_at(polynomial, low) > 0
    degree = len(polynomial) - 1
    scaled = [c << bits * (degree - j) for j, c in enumerate(polynomial)]

    def is_below(x):                    # x < t 2^bits
        if x <= low * (1 << bits):
            return True
        return x < high * (1 << bits) and (value_at(scaled, x) > 0) == sign_below

    below, above = int(low * (1 << bits)) - 1, int(high * (1 << bits)) + 1
    while above - below > 1:
        middle = (below + above) // 2
        below, above = (middle, above) if is_below(middle) else (below, middle)
    return below


def determinant(matrix: Sequence[Sequence]) -> Fraction:
    """Of a square matrix, by expansion along its first row."""
    if len(matrix) == 1:
        return matrix[0][0]
    return sum(((-1) ** j * x * determinant([[*row[:j], *row[j + 1:]] for row in matrix[1:]])
                for j, x in enumerate(matrix[0]) if x), Fraction(0))


# ---- polynomials

def primitive(polynomial: Sequence[int]) -> Polynomial:
    """Without a common factor of its coefficients, and with a positive leading one."""
    factor = gcd(*polynomial) * (1 if polynomial[-1] > 0 else -1)
    return tuple(c // factor for c in polynomial)


def real_roots(polynomial: Polynomial) -> List[Ends]:
    """Disjoint intervals (low, high], ascending, each with one of the real roots, which are
    simple."""
    size = Fraction(1 + max(map(abs, polynomial[:-1])) // abs(polynomial[-1]) + 1)  # Cauchy's bound

    def isolated(low, high, number):
        if number <= 1:
            return [(low, high)] * number
        middle = (low + high) / 2
        left = roots_between(polynomial, low, middle)
        return isolated(low, middle, left) + isolated(middle, high, number - left)

    return isolated(-size, size, roots_between(polynomial, -size, size))
