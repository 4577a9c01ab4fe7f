"""Rational approximation, exact: the facts that the thesis gives, and what theory promises."""

from fractions import Fraction
from itertools import islice

import farey
from hypothesis import given
from hypothesis import strategies as st

from converse.tori.field import determinant
from converse.tori.nearest import LOWER, UPPER, halves

PADOVAN = [2, 2, 3, 4, 5, 7, 9, 12, 16, 21, 28, 37, 49, 65, 86, 114, 151, 200, 265, 351, 465, 616,
           816, 1081, 1432, 1897, 2513, 3329, 4410, 5842]
TENTH = [2, 2, 3, 3, 5, 5, 8, 10, 13, 18, 21, 26, 39, 47, 60, 68, 81, 89, 102, 110, 191, 199, 301,
         309, 411, 610, 720, 1021, 1330, 1631, 1940, 2241, 2550, 2851, 3160, 3461, 3770]
# (sqrt 5 - 1)/2, and (tau^-2, tau^-1) with tau^3 = tau + 1, rounded down to 60 digits.
GOLDEN = Fraction("0.618033988749894848204586834365638117720309179805762862135448")
SPIRAL_MEAN = (Fraction("0.569840290998053265911399958119568648839797439128940220544730"),
               Fraction("0.754877666246692760049508896358528691894606617772793143989283"))
STEP = Fraction(10, 10 ** 60)
ADDRESS = "rlrrlllllrlllrlrlrllrrlrrrrrlrlrlrlr"    # thesis, Appendix A: of (377, 2330)/3770

inside = st.fractions(0, 1).filter(lambda w: 0 < w < 1)
part = st.fractions(0, 1, max_denominator=10 ** 30)
vectors = st.tuples(part, part).filter(lambda w: not {*w} <= {0, 1})


def take(generator, count):
    return list(islice(generator, count))


def test_spiral_mean():
    mediants = take(farey.triangle(SPIRAL_MEAN), 30)
    assert [m.q for m in mediants] == PADOVAN
    assert mediants[26] == ((1432, 1897), 2513, "r" * 26)


def test_a_tenth_and_the_golden_mean():
    """A resonant vector: it comes to lie on an edge, and ties decide."""
    w = Fraction(1, 10), GOLDEN
    mediants = take(farey.triangle(w), 37)
    assert [m.q for m in mediants] == TENTH
    assert mediants[36] == ((377, 2330), 3770, ADDRESS)
    assert mediants[26] == ((72, 445), 720, ADDRESS[:26])
    assert mediants == take(farey.triangle(("1/10", GOLDEN)), 37)
    assert mediants == take(farey.triangle(("0.1", str(float(GOLDEN)))), 37)
    nearest = Fraction(0.1), GOLDEN                   # the double is above a tenth
    assert take(farey.triangle(nearest), 37)[36] != mediants[36]


@given(inside)
def test_tree(w):
    mediants = take(farey.tree(w), 400)
    low, high, address = (0, 1), (1, 1), ""
    for (p,), q, turns in mediants:
        assert turns == address
        assert high[0] * low[1] - low[0] * high[1] == 1
        assert (p, q) == (low[0] + high[0], low[1] + high[1])
        assert Fraction(*low) < w < Fraction(*high)
        if w > Fraction(p, q):
            low, address = (p, q), address + "r"
        else:
            high, address = (p, q), address + "l"
    if len(mediants) < 400:
        assert Fraction(p, q) == w


@given(vectors)
def test_triangle(w):
    """Each mediant is the sum of the hypotenuse's ends of a triangle that contains the vector and
    has determinant 1 or -1, and the address leads there."""
    cell = UPPER if sum(w) >= 1 else LOWER
    mediants = take(farey.triangle(w), 60)
    for k, (p, q, address) in enumerate(mediants):
        assert abs(determinant(cell)) == 1
        weights = [determinant(cell[:j] + ((*w, 1),) + cell[j + 1:]) for j in range(3)]
        assert min(weights) >= 0 or max(weights) <= 0       # barycentric coordinates
        assert (*p, q) == tuple(x + y for x, y in zip(cell[0], cell[2])) and len(address) == k
        assert address == mediants[-1].address[:k]
        if k + 1 < len(mediants):
            cell = halves(cell)["lr".index(mediants[-1].address[k])]
    if len(mediants) < 60:
        assert (Fraction(p[0], q), Fraction(p[1], q)) == w
