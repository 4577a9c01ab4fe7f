"""Rotation vectors as exact values: elements of a real quadratic or a cubic number field.

The rotation number of a torus of one angle is an element omega of Q(t), t a real root of an
irreducible integer polynomial of degree 2; the rotation vector of a torus of two angles has two
elements of Q(t), t of degree 3, that are independent with 1 over the rationals.  Then no
combination k.omega, k != 0, is an integer, and how near to integers they come has a lower bound
that can be computed: converse/check/field.py.
"""

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Dict, Optional, Sequence, Tuple, Union

from ..check.field import is_irreducible, roots_between
from ..model.exact import Ends, exact
from .field import Element, Field, Polynomial, determinant, primitive, real_roots

LONGEST = 2000                          # characters of a rotation vector that is given as a text
DEGREES = {2: "a quadratic", 3: "a cubic"}


@dataclass(frozen=True)
class Rotation:
    """A rotation vector, in turns: w = 2 pi omega.

    name -- for reports; "" if it has none
    polynomial -- ascending integer coefficients, irreducible, of degree 2 (one angle) or 3 (two)
    root -- rationals, low < t < high, between which t is its only real root
    vector -- of each omega_j the rational coefficients of 1, t, (t^2)

    ValueError: the polynomial is reducible, the interval does not isolate a real root, or 1 and
    the omega_j are linearly dependent over the rationals.
    """

    name: str
    polynomial: Polynomial
    root: Ends
    vector: Tuple[Element, ...]

    def __post_init__(self) -> None:
        polynomial = tuple(self.polynomial)
        if not all(type(c) is int for c in polynomial) or not any(polynomial):
            raise ValueError("a polynomial has integer coefficients that are not all 0, unlike "
                             "%.80r" % (self.polynomial,))
        while not polynomial[-1]:
            polynomial = polynomial[:-1]
        polynomial = primitive(polynomial)
        vector = tuple(tuple(map(exact, element)) for element in self.vector)
        low, high = map(exact, self.root)
        degree = len(polynomial) - 1
        if degree not in DEGREES or len(vector) != degree - 1:
            raise ValueError("%d component%s of degree %d: one angle takes a quadratic polynomial "
                             "and one component, two angles take a cubic one and two"
                             % (len(vector), "s" * (len(vector) != 1), degree))
        if any(len(element) != degree for element in vector):
            raise ValueError("each component has %d coefficients, of 1, t, ..." % degree)
        if not is_irreducible(polynomial):
            raise ValueError("%s is reducible over the rationals: give the irreducible factor that "
                             "has the root, or another polynomial" % polynomial_text(polynomial))
        if not low < high or roots_between(polynomial, low, high) != 1:
            raise ValueError("between %s and %s the polynomial %s has not one real root"
                             % (low, high, polynomial_text(polynomial)))
        for j, element in enumerate(vector):
            if not any(element[1:]):
                raise ValueError("component %d, %s, is rational: its torus is resonant; give an "
                                 "irrational number, with t in it" % (j + 1, element[0]))
        if len(vector) == 2 and not determinant([element[1:] for element in vector]):
            raise ValueError("1, %s and %s are linearly dependent over the rationals: the torus is "
                             "resonant; give an independent vector"
                             % tuple(map(element_text, vector)))
        for name, value in (("polynomial", polynomial), ("root", (low, high)), ("vector", vector)):
            object.__setattr__(self, name, value)

    @property
    def dimension(self) -> int:
        """The number of angles."""
        return len(self.vector)

    @property
    def field(self) -> Field:
        """Q(t)."""
        return Field(self.polynomial, self.root)

    def turns(self, digits: int) -> Tuple[Ends, ...]:
        """Of each omega_j a lower and an upper bound that differ by 10^-digits at most."""
        return tuple(self.field.bounds(element, digits) for element in self.vector)

    @cached_property
    def floats(self) -> Tuple[float, ...]:
        """The omega_j as doubles."""
        return tuple(float(low) for low, _ in self.turns(30))

    def text(self) -> str:
        """What read_rotation reads as this vector: the polynomial, the root unless it is the
        largest real one, and the components."""
        roots = real_roots(self.polynomial)
        near, t = "", self.field.bounds((Fraction(0), Fraction(1)) + (Fraction(0),) *
                                        (self.dimension - 1), 20)
        if t[1] <= roots[-1][0]:
            places = 1
            while _nearest(self.polynomial, round(t[0], places)) != _index(roots, t):
                places += 1
            near = " near %s" % float(round(t[0], places))
        return "%s%s: %s" % (polynomial_text(self.polynomial), near,
                             ", ".join(map(element_text, self.vector)))

    def __str__(self) -> str:
        return self.name or self.text()


def _index(roots, t):
    return next(i for i, (low, high) in enumerate(roots) if t[0] < high)


# ---- names

NAMES: Dict[str, Tuple[str, str]] = {   # of what, and what it is
    "golden": ("t^2+t-1: t", "(sqrt 5 - 1)/2"),
    "silver": ("t^2+2t-1: t", "sqrt 2 - 1"),
    "spiral": ("t^3-t-1: t-1, t^2-1", "the spiral mean of Kim and Ostlund"),
    "seven": ("t^3+t^2-2t-1: t-1, t^2-1", "of t = 2 cos(2 pi/7)"),
    "T49": ("t^3+t^2-2t-1: (-23+8t+11t^2)/13, (25-7t-8t^2)/13",
            "near (0.3139, 0.2947), of the field of discriminant 49"),
    "V1": ("t^3+t^2-2t-1: (65069+4428t+8047t^2)/277999, (82757-371t-737t^2)/277999",
           "near (0.29893, 0.29190), of the same field"),
    "V2": ("t^3+t^2-2t-1: (341+187t+338t^2)/3683, (23180-2258t-4101t^2)/47879",
           "near (0.29860, 0.29214), of the same field"),
}


def read_rotation(text: str, dimension: Optional[int] = None) -> Rotation:
    """The rotation vector that a text names or describes:

        golden   silver   spiral   seven   T49   V1   V2
        POLYNOMIAL: ELEMENT                     one angle; the polynomial quadratic in t
        POLYNOMIAL: ELEMENT, ELEMENT            two angles; the polynomial cubic in t
        POLYNOMIAL near 1.2: ...                the real root t that is nearest to 1.2

    such as "t^3+t^2-2t-1: (-23+8t+11t^2)/13, (25-7t-8t^2)/13".  Without `near` t is the largest
    real root.  Elements are made of rational numbers and t by + - * / ^ and parentheses.

    ValueError, in one line: it is none, or not of so many angles as `dimension` says.
    """
    if len(text) > LONGEST:
        raise ValueError("the rotation vector has %d characters; %d at most" % (len(text), LONGEST))
    key = {name.lower(): name for name in NAMES}.get(text.strip().lower())
    rotation = _read(NAMES[key][0], key) if key else _read(text, "")
    if dimension not in (None, rotation.dimension):
        raise ValueError("%s has %s, but the map has %s" % (
            rotation, ("one component", "two components")[rotation.dimension - 1],
            ("one angle", "two angles")[(dimension or 1) - 1]))
    return rotation


def rotation_of(given: Union[Rotation, str]) -> Rotation:
    """A rotation vector as it is, or that of a text."""
    if not isinstance(given, (Rotation, str)):
        raise TypeError("the rotation vector is a Rotation, or a text such as 'golden', not %r"
                        % (given,))
    return given if isinstance(given, Rotation) else read_rotation(given)


def _read(text, name):
    left, colon, right = text.partition(":")
    if not colon:
        raise ValueError("%.60r is no rotation vector: give a name (%s) or POLYNOMIAL: ELEMENTS, "
                         "such as 't^2+t-1: t'" % (text, ", ".join(NAMES)))
    left, near, place = left.partition("near")
    coefficients = _parsed(left, None)
    if not all(c.denominator == 1 for c in coefficients):
        raise ValueError("%s: a polynomial has integer coefficients" % left.strip())
    polynomial = tuple(int(c) for c in coefficients)
    if len(polynomial) - 1 not in DEGREES:
        raise ValueError("%s is of degree %d: one angle takes a quadratic polynomial, two angles "
                         "take a cubic one" % (left.strip(), len(polynomial) - 1))
    if not is_irreducible(polynomial):
        raise ValueError("%s is reducible over the rationals: give the irreducible factor that has "
                         "the root, or another polynomial" % left.strip())
    roots = real_roots(polynomial)
    if not roots:
        raise ValueError("%s has no real root" % left.strip())
    root = roots[_nearest(polynomial, exact(place.strip())) if near else -1]
    field = Field(polynomial, root)
    parts = right.split(",")
    if len(parts) != field.degree - 1:
        raise ValueError("%s is of degree %d, so give %s, not %d" % (
            left.strip(), field.degree, ("one component", "two components")[field.degree - 2],
            len(parts)))
    return Rotation(name, polynomial, root, tuple(_parsed(part, field) for part in parts))


def _nearest(polynomial, place):
    """The index of the real root that is nearest to a place."""
    roots = real_roots(polynomial)
    if not roots:
        raise ValueError("%s has no real root" % polynomial_text(polynomial))
    digits = 10
    while digits < 400:
        ends = []
        for root in roots:
            low, high = Field(polynomial, root).bounds(
                (-place, Fraction(1)) + (Fraction(0),) * (len(polynomial) - 3), digits)
            ends.append((max(low, -high, 0), max(-low, high)))
        best = min(range(len(roots)), key=lambda i: ends[i][1])
        if all(ends[best][1] < low for i, (low, _) in enumerate(ends) if i != best):
            return best
        digits *= 4
    raise ValueError("two real roots of %s are equally near to %s: say which one"
                     % (polynomial_text(polynomial), place))


# ---- reading and writing polynomials

TOKEN = re.compile(r"\s*(?:([0-9]+(?:\.[0-9]+)?|\.[0-9]+)|([-+*/^()t]))")
HIGHEST, DEEPEST = 40, 40               # exponent; parentheses


def _parsed(text, field):
    """A polynomial in t as ascending coefficients; an element, if a field is given."""
    tokens, at = [], 0
    text = text.strip()
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise ValueError("%.60r: what is %r? A polynomial in t has numbers, t, + - * / ^ and "
                             "parentheses" % (text, text[at:at + 10].strip()))
        tokens.append(match.group(1) or match.group(2))
        at = match.end()
    if tokens.count("(") > DEEPEST:
        raise ValueError("a polynomial in t has at most %d parentheses" % DEEPEST)
    try:
        value, rest = _sum(tokens, field)
        if rest:
            raise ValueError("%r is left over" % rest[0])
    except ZeroDivisionError:
        raise ValueError("%.60r divides by 0" % text) from None
    except (ValueError, IndexError) as error:
        raise ValueError("%.60r is no polynomial in t%s" % (
            text, ": %s" % error if str(error) and isinstance(error, ValueError)
            else ": it ends too early")) from None
    while len(value) > 1 and not value[-1] and not field:
        value = value[:-1]
    return field.element(value) if field else tuple(value)


def _sum(tokens, field):
    sign, total = 1, [Fraction(0)]
    if tokens and tokens[0] in "+-":
        sign, tokens = (-1 if tokens[0] == "-" else 1), tokens[1:]
    while True:
        value, tokens = _product(tokens, field)
        size = max(len(total), len(value))
        total = [(total[j] if j < len(total) else 0) + (sign * value[j] if j < len(value) else 0)
                 for j in range(size)]
        if not tokens or tokens[0] not in "+-":
            return total, tokens
        sign, tokens = (-1 if tokens[0] == "-" else 1), tokens[1:]


def _product(tokens, field):
    value, tokens = _power(tokens, field)
    while tokens and tokens[0] not in "+-)":
        divide = tokens[0] == "/"
        factor, tokens = _power(tokens[1:] if tokens[0] in "*/" else tokens, field)
        if divide:
            if field:
                factor = list(field.inverse(field.element(factor)))
            elif any(factor[1:]):
                raise ValueError("a polynomial is divided by numbers only")
            else:
                factor = [1 / factor[0]]
        value = _times(value, factor, field)
    return value, tokens


def _power(tokens, field):
    first, tokens = tokens[0], tokens[1:]
    if first == "(":
        value, tokens = _sum(tokens, field)
        if tokens[0] != ")":
            raise ValueError("%r where a parenthesis should close" % tokens[0])
        tokens = tokens[1:]
    elif first == "t":
        value = [Fraction(0), Fraction(1)]
    elif first in "+-*/^)":
        raise ValueError("%r where a number or t should be" % first)
    else:
        value = [exact(first)]
    if tokens and tokens[0] == "^":
        if not tokens[1].isdigit() or int(tokens[1]) > HIGHEST:
            raise ValueError("an exponent is a whole number up to %d, not %.20s"
                             % (HIGHEST, tokens[1]))
        base, tokens, exponent = value, tokens[2:], int(tokens[1])
        value = [Fraction(1)]
        for _ in range(exponent):
            value = _times(value, base, field)
    return value, tokens


def _times(a, b, field):
    total = [Fraction(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            total[i + j] += x * y
    if field:
        return list(field.element(total))
    if len(total) > HIGHEST + 1:
        raise ValueError("its degree is above %d" % HIGHEST)
    return total


def polynomial_text(polynomial: Sequence[Union[int, Fraction]], ascending: bool = False) -> str:
    """Such as t^2+t-1."""
    text = ""
    terms = list(enumerate(polynomial))
    for j, c in terms if ascending else reversed(terms):
        if c:
            power = "" if j == 0 else "t" if j == 1 else "t^%d" % j
            size = "" if abs(c) == 1 and power else str(abs(c))
            text += ("-" if c < 0 else "+") + size + power
    return text[1:] if text.startswith("+") else text or "0"


def element_text(element: Element) -> str:
    """Such as (-23+8t+11t^2)/13."""
    below = lcm(*(c.denominator for c in element))
    text = polynomial_text([int(c * below) for c in element], ascending=True)
    return text if below == 1 else "(%s)/%d" % (text, below)
