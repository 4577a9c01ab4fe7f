"""All values above one, or below it, by one point of the torus."""

import math
from fractions import Fraction as F

import pytest

from converse import FourierMap, FroeschleMap, MuldoonMap, StandardMap
from converse.diagram import Diagram
from converse.diagram.sides import excludes, sides_of

CROSSED = FourierMap({(1, 0): {"K": 1}, (0, 1): {"K": "0.7"}, (1, -1): "0.05"}, K=(0, 2))
TWO = FourierMap({(1, 0, "1/2"): {"K": 1}, (2, 0, "1/2"): "0.2"}, K=(0, 3))


@pytest.mark.parametrize("family, above", [
    (StandardMap((0, 2)), 2.0), (TWO, 1.2), (FroeschleMap((0, 2), "0.1"), 1.9),
    (MuldoonMap(epsilon=(0, "0.03")), 0.03776), (CROSSED, 1.95)])
def test_one_point_excludes_all_larger_values(family, above):
    """Found, rounded upwards, and confirmed by the checker."""
    found = Diagram.of(family)
    found.sides = sides_of(found.family)
    value = found.sides["above"][0]
    assert above <= float(value) < above * 1.001 + 1e-4
    assert found.none[-1] == (value, math.inf) and found.none[0][0] == -math.inf
    assert found.verify() and found.report().startswith("THEOREM")


@pytest.mark.parametrize("value, x, n, above, below", [
    ("2.0001", (F(1, 2), 0), (1, 0), True, False), ("2", (F(1, 2), 0), (1, 0), False, False),
    ("1.9999", (F(1, 2), 0), (1, 0), False, False), ("2.0001", (0, 0), (1, 0), False, False),
    ("-2.0001", (0, 0), (1, 0), False, True), ("3", (F(1, 4), 0), (1, 0), False, False),
    ("3", (F(1, 2), 0), (0, 1), False, False), ("3", (F(1, 2), 0), (0, 0), False, False)])
def test_the_test_is_strict(value, x, n, above, below):
    """Of the standard map, n.beta n = 2 + k cos x; and n is not 0."""
    family = Diagram.of(StandardMap((0, 2))).family
    side = F(value), tuple(map(F, x)), n
    assert (excludes(family, 1, side), excludes(family, -1, side)) == (above, below)


def test_a_family_without_such_a_point():
    """2 + K bends nothing: V does not depend on the angle where K acts."""
    family = Diagram.of(FourierMap({1: {"K": "0.001"}, 2: "0.3"}, K=(0, 1))).family
    found = sides_of(family)
    assert found["above"][0] < 2001 and found["below"][0] > -2001


def test_where_no_value_has_tori_both_sides_meet():
    found = Diagram.of(FourierMap({1: "3", 2: {"K": 1}}, K=(-3, 3)))
    found.sides = sides_of(found.family)
    assert found.none == [(-math.inf, math.inf)] and found.open == [] and found.verify()
