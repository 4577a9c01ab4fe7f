"""Rotation vectors as exact values: elements of a real quadratic or a cubic number field.

The rotation number of a torus of one angle is an element omega of Q(t), t a real root of an
irreducible integer polynomial of degree 2.  The rotation vector of a torus of two angles has two
elements of Q(t), t of degree 3, that are independent with 1 over the rationals.  Then no
combination k.omega, k != 0, is an integer, and how near to integers they come has a lower bound
that can be computed: converse/check/field.py.
"""

import re
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import floor, lcm
from typing import Dict, List, Optional, Sequence, Tuple, Union

from ..check.field import is_irreducible, roots_between
from ..check.words import sum_text
from ..model.exact import Ends, exact
from .field import Element, Field, Polynomial, determinant, primitive, real_roots

LONGEST = 2000                          # A text of a rotation vector has at most these characters.


@dataclass(frozen=True)
class Rotation:
    """A rotation vector, in turns: w = 2 pi omega.  Two are equal if all except the name is.

    Parameters
    ----------
    name
        For reports; "" for none.
    polynomial
        Ascending integer coefficients, irreducible, of degree 2 (one angle) or 3 (two).
    root
        Rationals, low < t < high, between which t is its only real root.
    vector
        Of each omega_j the rational coefficients of 1, t, (t^2).

    Raises
    ------
    ValueError
        The polynomial is reducible, the interval does not isolate a real root, or 1 and the omega_j
        are linearly dependent over the rationals.
    """

    name: str = field(compare=False)
    polynomial: Polynomial
    root: Ends
    vector: Tuple[Element, ...]

    def __post_init__(self) -> None:
        polynomial = _minimal(self.polynomial)
        vector = tuple(tuple(map(exact, element)) for element in self.vector)
        low, high = map(exact, self.root)
        degree = len(polynomial) - 1
        if len(vector) != degree - 1:
            raise ValueError("%d component%s of degree %d: one angle takes a quadratic polynomial "
                             "and one component, two angles take a cubic one and two components"
                             % (len(vector), "s" * (len(vector) != 1), degree))
        if any(len(element) != degree for element in vector):
            raise ValueError("each component has %d coefficients, of 1, t, ..." % degree)
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
        """Bounds of the components.

        Parameters
        ----------
        digits
            A lower and an upper bound differ by 10^-digits at most.

        Returns
        -------
        tuple of (Fraction, Fraction)
            Of each omega_j both bounds.
        """
        return tuple(self.field.bounds(element, digits) for element in self.vector)

    @cached_property
    def floats(self) -> Tuple[float, ...]:
        """The omega_j as doubles."""
        return tuple(float(low) for low, _ in self.turns(30))

    def continued_fraction(self, most: int = 24) -> str:
        """The continued fraction of a rotation number, which is periodic in the end.

        Parameters
        ----------
        most
            At most about these quotients are written.

        Returns
        -------
        str
            Such as "[0; 2, 7, 1, 1, ...]": the period is written twice, if that is short enough.

        Raises
        ------
        ValueError
            It is a vector of two components.
        """
        if self.dimension > 1:
            raise ValueError("a rotation vector of two components has no continued fraction")
        rest = self.vector[0]
        quotients: List[int] = []
        seen: Dict[Element, int] = {}
        while rest not in seen and len(quotients) < most:
            seen[rest], digits = len(quotients), 10
            while len(found := {floor(x) for x in self.field.bounds(rest, digits)}) > 1:
                digits *= 2
            quotients += found
            rest = self.field.inverse((rest[0] - quotients[-1], *rest[1:]))
        first, *others = map(str, (quotients + quotients[seen.get(rest, most):])[:most])
        return "[%s; %s, ...]" % (first, ", ".join(others))

    def text(self) -> str:
        """The text that read_rotation reads as this vector: the polynomial, the root unless it is
        the largest real one, and the components."""
        roots, (low, _) = real_roots(self.polynomial), self.field.bounds(self.field.t, 20)
        index = next(i for i, (_, high) in enumerate(roots) if low < high)
        near, places = "", 1
        if index < len(roots) - 1:
            while _nearest(self.polynomial, roots, round(low, places)) != index:
                places += 1
            near = " near %s" % float(round(low, places))
        return "%s%s: %s" % (polynomial_text(self.polynomial), near,
                             ", ".join(map(element_text, self.vector)))

    def __str__(self) -> str:
        return self.name or self.text()


def _minimal(coefficients: Sequence[Union[int, Fraction]]) -> Polynomial:
    """The polynomial, made primitive.  ValueError: it defines no field of degree 2 or 3."""
    if not any(coefficients) or any(c != int(c) for c in coefficients):
        raise ValueError("a polynomial has integer coefficients that are not all 0, unlike %.80s"
                         % polynomial_text(coefficients))
    polynomial = primitive([int(c) for c in coefficients])
    if len(polynomial) not in (3, 4):
        raise ValueError("%s is of degree %d: one angle takes a quadratic polynomial, two angles "
                         "take a cubic one" % (polynomial_text(polynomial), len(polynomial) - 1))
    if not is_irreducible(polynomial):
        raise ValueError("%s is reducible over the rationals: give the irreducible factor that has "
                         "the root, or another polynomial" % polynomial_text(polynomial))
    return polynomial


# ---- names

NAMES: Dict[str, str] = {
    "golden": "t^2+t-1: t",             # (sqrt 5 - 1)/2
    "silver": "t^2+2t-1: t",            # sqrt 2 - 1
    "spiral": "t^3-t-1: t-1, t^2-1",    # the spiral mean of Kim and Ostlund
    # t = 2 cos(2 pi/7); T49 is near (0.3139, 0.2947), V1 near (0.29893, 0.29190), V2 near
    # (0.29860, 0.29214).
    "seven": "t^3+t^2-2t-1: t-1, t^2-1",
    "T49": "t^3+t^2-2t-1: (-23+8t+11t^2)/13, (25-7t-8t^2)/13",
    "V1": "t^3+t^2-2t-1: (65069+4428t+8047t^2)/277999, (82757-371t-737t^2)/277999",
    "V2": "t^3+t^2-2t-1: (341+187t+338t^2)/3683, (23180-2258t-4101t^2)/47879",
}


def read_rotation(text: str, dimension: Optional[int] = None) -> Rotation:
    """The rotation vector that a text names or describes:

        golden   silver   spiral   seven   T49   V1   V2
        POLYNOMIAL: ELEMENT                     one angle; the polynomial quadratic in t
        POLYNOMIAL: ELEMENT, ELEMENT            two angles; the polynomial cubic in t
        POLYNOMIAL near 1.2: ...                the real root t that is nearest to 1.2
        [0; 4, 1, 4, ...]                       a continued fraction, which 1, 1, ... follows

    such as "t^3+t^2-2t-1: (-23+8t+11t^2)/13, (25-7t-8t^2)/13".  Without `near` t is the largest
    real root.  An element is a sum of terms such as 3/4 t^2, or a quotient of two sums in
    parentheses.  The last quotient of a continued fraction goes on if it is there twice.

    Parameters
    ----------
    text
        In one of these forms.
    dimension
        How many angles the map has; by default any number.

    Returns
    -------
    Rotation

    Raises
    ------
    ValueError
        The text is not a rotation vector, or not of `dimension` angles.
    TypeError
        It is not a text.
    """
    if not isinstance(text, str):
        raise TypeError("a rotation vector is given as a text such as 'golden' or 't^2+t-1: t', "
                        "exactly; %r is not a text" % (text,))
    if len(text) > LONGEST:
        raise ValueError("the rotation vector has %d characters; %d at most" % (len(text), LONGEST))
    key = {name.lower(): name for name in NAMES}.get(text.strip().lower())
    rotation = _read(NAMES[key], key) if key else _read(text, "")
    if dimension not in (None, rotation.dimension):
        raise ValueError("%s has %s, but the map has %s" % (
            rotation, ("one component", "two components")[rotation.dimension - 1],
            ("one angle; name another, such as golden",
             "two angles; name another, such as spiral")[(dimension or 1) - 1]))
    return rotation


def name_of(rotation: Rotation) -> str:
    """The name that read_rotation() reads as this rotation vector, "" if there is none."""
    return next((name for name, text in NAMES.items() if text.partition(":")[0] ==
                 polynomial_text(rotation.polynomial) and read_rotation(name).text() ==
                 rotation.text()), "")


def _of_quotients(text):
    """The rotation number of a continued fraction."""
    if not (match := FRACTION.fullmatch(text)):
        raise ValueError("%.60r is not a continued fraction such as '[0; 4, 1, 4, ...]'" % text)
    first, *others = [int(each) for each in re.findall(r"-?\d+", match[0])]
    if not all(0 < each <= MOST_QUOTIENT for each in others):
        raise ValueError("%.60r: the quotients after the first are from 1 to %d"
                         % (text, MOST_QUOTIENT))
    period = others[-1] if others[-2:-1] == others[-1:] else 1
    polynomial = -1, period, 1
    field = Field(polynomial, real_roots(polynomial)[-1])
    value = field.t
    for each in reversed(others):
        value = field.inverse((value[0] + each, *value[1:]))
    return Rotation("", polynomial, (field.low, field.high), ((value[0] + first, *value[1:]),))


def _read(text, name):
    if text.lstrip().startswith("["):
        return _of_quotients(text)
    text = re.sub(r"\s*([-+*/^()t,:])\s*", r"\1", text.strip())
    left, colon, right = text.partition(":")
    if not colon:
        raise ValueError("%.60r is not a rotation vector: give a name (%s), a continued fraction "
                         "or POLYNOMIAL: ELEMENTS, such as 't^2+t-1: t'" % (text, ", ".join(NAMES)))
    left, near, place = left.partition("near")
    polynomial = _minimal(_sum(left.strip()))
    roots = real_roots(polynomial)
    if not roots:
        raise ValueError("%s has no real root" % polynomial_text(polynomial))
    root = roots[_nearest(polynomial, roots, exact(place.strip())) if near else -1]
    return Rotation(name, polynomial, root, tuple(
        _element(part, Field(polynomial, root)) for part in right.split(",")))


def _nearest(polynomial, roots, place):
    """The index of the real root that is nearest to a place."""
    fields = [Field(polynomial, root) for root in roots]
    gaps = [abs(field.bounds(field.t, DIGITS)[0] - place) for field in fields]
    first, *rest = sorted(gaps)
    if rest and rest[0] - first < Fraction(4, 10 ** DIGITS):
        raise ValueError("two real roots of %s are equally near to %s: say which one"
                         % (polynomial_text(polynomial), place))
    return gaps.index(first)


# ---- reading and writing polynomials

FRACTION = re.compile(r"\s*\[\s*-?\d+\s*;(\s*\d+\s*,)+\s*\.\.\.\s*\]\s*", re.ASCII)
MOST_QUOTIENT = 10 ** 6
DIGITS = 60                             # Distances of roots from a place are compared to these.
QUOTIENT = re.compile(r"(\()?([^()]*)(?(1)\))(?:/(\()?([^()]*)(?(3)\)))?")
TERM = re.compile(r"([-+])(?=[\d.t])(\d+/\d+|\d*\.?\d+)?(?:(?:(?<=\d)\*)?(t)(?:\^(\d{1,2}))?)?"
                  r"(?:/(\d+))?", re.ASCII)


def _sum(text):
    """Ascending coefficients of a sum of terms such as 3/4 t^2."""
    terms = text if text[:1] in ("+", "-") else "+" + text
    total, at = [Fraction(0)], 0
    while at < len(terms):
        match = TERM.match(terms, at)
        if not match:
            raise ValueError("%.60r: what is %r? Give a sum of terms such as 3/4 t^2"
                             % (text, terms[at:at + 10]))
        sign, number, power, exponent, below = match.groups()
        j = int(exponent or 1) if power else 0
        total += [Fraction(0)] * (j + 1 - len(total))
        total[j] += exact(sign + (number or "1")) / exact(below or "1")
        at = match.end()
    return total


def _element(text, field):
    """The element that is a sum, or a quotient of sums in parentheses."""
    match = QUOTIENT.fullmatch(text)
    if not match:
        raise ValueError("%.60r is not a sum of terms, nor a quotient of two sums in parentheses"
                         % text)
    try:
        found = field.element(_sum(match[2]))
        return found if match[4] is None else field.product(
            found, field.inverse(field.element(_sum(match[4]))))
    except ZeroDivisionError:
        raise ValueError("%.60r divides by 0" % text) from None


def polynomial_text(polynomial: Sequence[Union[int, Fraction]], ascending: bool = False) -> str:
    """Such as t^2+t-1."""
    terms = [(c, ("", "t")[j] if j < 2 else "t^%d" % j) for j, c in enumerate(polynomial)]
    return sum_text(*zip(*(terms if ascending else reversed(terms)))).replace(" ", "")


def element_text(element: Element) -> str:
    """Such as (-23+8t+11t^2)/13."""
    below = lcm(*(c.denominator for c in element))
    text = polynomial_text([int(c * below) for c in element], ascending=True)
    return text if below == 1 else "(%s)/%d" % (text, below)
