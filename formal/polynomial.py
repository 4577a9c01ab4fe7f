"""Polynomials with exact coefficients, in the symbols that they are made of."""

from fractions import Fraction


class Polynomial:
    """terms: the coefficient of each monomial, which is a sorted tuple of symbols."""

    def __init__(self, terms=()):
        self.terms = {key: x for key, x in dict(terms).items() if x}

    @classmethod
    def of(cls, value):
        """Of a number."""
        return value if isinstance(value, cls) else cls({(): Fraction(value)})

    def __add__(self, other):
        sum_ = dict(self.terms)
        for key, x in Polynomial.of(other).terms.items():
            sum_[key] = sum_.get(key, 0) + x
        return Polynomial(sum_)

    def __mul__(self, other):
        product = {}
        for key, x in self.terms.items():
            for more, y in Polynomial.of(other).terms.items():
                both = tuple(sorted(key + more))
                product[both] = product.get(both, 0) + x * y
        return Polynomial(product)

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + -Polynomial.of(other)

    def __rsub__(self, other):
        return Polynomial.of(other) - self

    __radd__, __rmul__ = __add__, __mul__


def symbol(name):
    return Polynomial({(name,): Fraction(1)})
