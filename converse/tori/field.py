"""The number field Q(t) of a real root t of an irreducible polynomial, exactly.

An element is the tuple of its rational coefficients of 1, t, t^2, ...; what is said of its value
(sign, enclosure) follows from an enclosure of t by bisection, in integers.
"""

from fractions import Fraction
from functools import lru_cache
from math import ceil, floor, gcd
from typing import List, NamedTuple, Sequence, Tuple

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

    def matrix(self, a: Element) -> List[List[Fraction]]:
        """Of multiplication by a: its columns are a, a t, a t^2, ..."""
        columns = [self.element([Fraction(0)] * j + list(a)) for j in range(self.degree)]
        return [list(row) for row in zip(*columns)]

    def trace(self, a: Element) -> Fraction:
        return sum((row[i] for i, row in enumerate(self.matrix(a))), Fraction(0))

    def norm(self, a: Element) -> Fraction:
        return determinant(self.matrix(a))

    def inverse(self, a: Element) -> Element:
        """1/a.  ZeroDivisionError: a is 0."""
        matrix = self.matrix(a)         # Cramer's rule for matrix x = (1, 0, ...)
        whole, solution = determinant(matrix), []
        for j in range(self.degree):
            replaced = [row[:j] + [Fraction(not i)] + row[j + 1:] for i, row in enumerate(matrix)]
            solution.append(determinant(replaced) / whole)
        return tuple(solution)

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

    def sign(self, a: Element) -> int:
        """Of the value of an element: 1, 0 or -1."""
        digits = 10
        while any(a):                   # the powers of t below the degree are independent
            low, high = self.bounds(a, digits)
            if low > 0 or high < 0:
                return 1 if low > 0 else -1
            digits *= 2
        return 0


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


def is_irreducible(polynomial: Polynomial) -> bool:
    """Of degree 2 or 3, which is so if it has no rational root.

    If a is the leading coefficient, a x is an integer for every rational root x; and a multiple
    root would be rational."""
    lead = polynomial[-1]
    if not polynomial[0] or len(_sturm(polynomial)[-1]) > 1:
        return False
    for low, high in real_roots(polynomial):
        while (high - low) * abs(lead) > 1:         # two integers at most are left for a x
            middle = (low + high) / 2
            low, high = (middle, high) if roots_between(polynomial, middle, high) else (low, middle)
        ends = floor(low * lead), ceil(low * lead), floor(high * lead), ceil(high * lead)
        if not all(value_at(polynomial, Fraction(x, lead)) for x in ends):
            return False
    return True


def _sturm(polynomial):
    """Sturm's chain: polynomials of falling degree, the last constant if all roots are simple."""
    chain = [[Fraction(c) for c in polynomial],
             [Fraction(j * c) for j, c in enumerate(polynomial)][1:]]
    while len(chain[-1]) > 1:
        rest, by = list(chain[-2]), chain[-1]
        while len(rest) >= len(by):
            factor = rest[-1] / by[-1]
            for j in range(len(by)):
                rest[len(rest) - len(by) + j] -= factor * by[j]
            rest.pop()
        while rest and not rest[-1]:
            rest.pop()
        if not rest:
            break
        chain.append([-c for c in rest])
    return chain


def roots_between(polynomial: Polynomial, low: Fraction, high: Fraction) -> int:
    """How many real roots are above low and not above high, if all roots are simple (Sturm)."""
    def changes(x):
        signs = [value > 0 for value in (value_at(p, x) for p in chain) if value]
        return sum(a != b for a, b in zip(signs, signs[1:]))

    chain = _sturm(polynomial)
    return changes(low) - changes(high)


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
