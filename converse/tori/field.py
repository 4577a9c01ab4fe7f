"""The number field Q(t) of a real root t of an irreducible polynomial: the checker's arithmetic
(converse/check/field.py), with inverses and decimal places.

An element is the tuple of its rational coefficients of 1, t, t^2, ...
"""

from fractions import Fraction
from math import gcd
from typing import List, Sequence, Tuple

from ..check import field
from ..model.exact import Ends
from ..model.lattice import determinant

Element = Tuple[Fraction, ...]
Polynomial = Tuple[int, ...]            # ascending coefficients, the last not 0


class Field(field.Field):
    """polynomial -- irreducible, of degree 2 or 3; ascending integer coefficients.
    root -- two rational numbers between which t is its only real root."""

    def __init__(self, polynomial: Polynomial, root: Ends) -> None:
        super().__init__(polynomial, *root)
        self.t: Element = (Fraction(0), Fraction(1), Fraction(0))[:self.degree]

    def element(self, coefficients: Sequence) -> Element:
        """A polynomial in t, given by ascending rational coefficients, as an element."""
        found = (Fraction(0),) * self.degree
        for c in reversed(coefficients):
            first, *rest = self.product(found, self.t)
            found = (first + c, *rest)
        return found

    def inverse(self, a: Element) -> Element:
        """1/a.  ZeroDivisionError: a is 0."""
        columns = [self.element([Fraction(0)] * j + list(a)) for j in range(self.degree)]
        whole = determinant(columns)    # Cramer's rule: a, a t, a t^2 times these are 1
        one = self.element([Fraction(1)])
        return tuple(determinant([*columns[:j], one, *columns[j + 1:]]) / whole
                     for j in range(self.degree))

    def bounds(self, a: Element, digits: int) -> Ends:
        """The value of an element, to 10^-digits; exactly, if it is rational."""
        bits = 4 * digits + 16
        while (ends := self.interval(a, bits))[1] - ends[0] > Fraction(1, 10 ** digits):
            bits *= 2
        return ends


# ---- polynomials

def primitive(polynomial: Sequence[int]) -> Polynomial:
    """Divides by the coefficients' common factor; the leading coefficient becomes positive."""
    polynomial = polynomial[:max(j for j, c in enumerate(polynomial) if c) + 1]
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
        left = field.roots_between(polynomial, low, middle)
        return isolated(low, middle, left) + isolated(middle, high, number - left)

    return isolated(-size, size, field.roots_between(polynomial, -size, size))
