"""Rotation vectors: what is read, how exactly, and what is refused."""

from dataclasses import replace
from fractions import Fraction
from math import cos, floor, pi, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from converse.check.field import evaluate, is_irreducible
from converse.tori import Rotation, read_rotation
from converse.tori.field import Field, real_roots
from converse.tori.nearest import rotation_of
from converse.tori.rotation import NAMES, name_of


def test_names_are_the_numbers_of_the_literature():
    assert read_rotation("golden").floats == pytest.approx([(sqrt(5) - 1) / 2])
    assert read_rotation("silver").floats == pytest.approx([sqrt(2) - 1])
    assert read_rotation("spiral").floats == pytest.approx([0.3247179572447, 0.7548776662467])
    for name, half_sum, half_difference in (("t49", .304302077, .009573022),
                                            ("V1", .295417861571, .003516212919),
                                            ("V2", .295373025796, .003231653689)):
        x0, x1 = read_rotation(name).floats
        assert (x0 + x1) / 2 == pytest.approx(half_sum, abs=1e-9)
        assert (x0 - x1) / 2 == pytest.approx(half_difference, abs=1e-9)
    t = 2 * cos(2 * pi / 7)
    assert read_rotation("seven").floats == pytest.approx([t - 1, t * t - 1])


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_is_read(name):
    rotation = read_rotation(name)
    again = read_rotation(rotation.text())
    assert (again.polynomial, again.vector) == (rotation.polynomial, rotation.vector)
    assert again.floats == rotation.floats and str(rotation) == name and str(again) == again.text()


@pytest.mark.parametrize("text, fraction", [
    ("golden", "[0; 1, 1, ...]"), ("silver", "[0; 2, 2, ...]"),
    ("t^2+t-1: (89+t)/191", "[0; 2, 7, 1, 1, ...]"),
    ("t^2-3: t", "[1; 1, 2, 1, 2, ...]"), ("t^2+t-1: -t", "[-1; 2, 1, 1, ...]"),
    ("t^2-2: 1000001+t", "[1000002; 2, 2, ...]"),
    ("t^2-1000099: t", "[1000; 20, 4, 1, 15, 13, 1, 12, 17, 57, 11, 2, 10, 1, 1, 21, 1, 2, 2, 1, "
                       "17, 2, 13, 1, ...]")])
def test_continued_fractions_are_periodic(text, fraction):
    rotation = read_rotation(text)
    assert rotation.continued_fraction() == fraction
    (near, _), = rotation.turns(200)
    for quotient in fraction[1:-6].replace(";", ",").split(","):
        assert int(quotient) == floor(near)
        near = 1 / (near - floor(near))


def test_two_components_have_no_continued_fraction():
    with pytest.raises(ValueError, match="two components"):
        read_rotation("T49").continued_fraction()


@pytest.mark.parametrize("number", [0.618, 1, (0.3, 0.4), None, b"golden"])
def test_what_is_no_text_is_refused_in_words(number):
    for read in (read_rotation, rotation_of):
        with pytest.raises(TypeError, match="a text such as 'golden'"):
            read(number)


def test_a_name_is_that_of_the_vector():
    """However the root is isolated; and vectors of different names are equal."""
    golden, silver = map(read_rotation, ("golden", "silver"))
    assert {name_of(read_rotation(name)) for name in NAMES} == set(NAMES)
    assert name_of(replace(golden, name="silver", root=(Fraction(3, 5), Fraction(2, 3)))) == \
        "golden"
    assert name_of(replace(golden, root=(-2, -1))) == name_of(replace(
        golden, vector=((1, 1),))) == ""
    assert replace(golden, name="mine") == golden != silver


def test_the_root_is_the_largest_or_the_one_that_is_named():
    assert read_rotation("t^2-2: t").floats == pytest.approx([sqrt(2)])
    assert read_rotation("t^2-2 near -0.1: t").floats == pytest.approx([-sqrt(2)])
    assert read_rotation("t^2-2 near -0.1: t").text().partition(":")[0].endswith(" near -1.4")
    for place, index in (("1.2", 1), ("-1/2", 2), ("-2", 3)):
        rotation = read_rotation("t^3+t^2-2t-1 near %s: t, t^2" % place)
        assert rotation.floats[0] == pytest.approx(2 * cos(2 * pi * index / 7))
        assert read_rotation(rotation.text()).floats == rotation.floats


@pytest.mark.parametrize("text,same", [
    ("t^2+t-1: 1/(t)", "1+t"), ("t^2+t-1: (1+2t) / (3+2t)", "3-4t"),
    ("-t^2-t+1: (-t)/7", "(-t)/7"), ("t^2+t-1: 1/2+t/3", "(3+2t)/6"),
    ("2t^2+2t-2: t", "t"), ("t^2 + t - 1 : 3 * t / 2 - 0.5", "(-1+3t)/2"),
    ("t^2+t-1: 1/2 t^2 + .5", "(2-t)/2"), ("t^2+t-1 + 0t^3: t", "t"),
])
def test_elements_are_simplified(text, same):
    assert read_rotation(text).text() == "t^2+t-1: " + same


@pytest.mark.parametrize("text,words", [
    ("0.618", "not a rotation vector"), ("", "not a rotation vector"),
    ("t^2-2", "not a rotation vector"),
    ("t^2-1: t", "reducible"), ("t^3-8: t, t^2", "reducible"), ("t^2: t", "reducible"),
    ("4t^2-4t+1: t", "reducible"), ("6t^3-7t^2+1: t,t^2", "reducible"),
    ("t^2+1: t", "no real root"), ("t^2+1 near 1: t", "no real root"),
    ("t^2-2 near 0: t", "equally near"), ("t^2-2 near z: t", "'z'"),
    ("t^2-2: 3/2", "rational"), ("t^2-2: t^2", "rational"),
    ("t^3-t-1: t,2t+1", "linearly dependent"), ("t^3-t-1: t, 1/2", "rational"),
    ("t^3-t-1: t", "two components"), ("t^2-2: t, t", "one component"),
    ("t^4+2: t", "degree 4"), ("t-1: t", "degree 1"), ("5: t", "degree 0"),
    ("t^2-t/2: t", "integer coefficients"),
    ("t^2-2: (t", "in parentheses"), ("t^2-2: t)", "in parentheses"), ("t^2-2: t**2", "'**2'"),
    ("t^2-2: x", "'+x'"), ("t^2-2: 1/(t^2-2)", "divides by 0"), ("t^2-2:", "what is '+'"),
    ("t^2-2: t^999", "what is '9'"), ("t^2-2: t^t", "what is '^t'"),
    ("t^2-2: t/0", "divides by 0"),
    ("t^40 t^40: t", "what is"), ("t^40: t", "degree 40"), ("0: t", "not all 0"),
    ("t^2-2: " + "t+" * 1000 + "t", "characters"), ("1/t: t", "what is '/t'"),
    ("t^2-2: 1 2", "what is"), ("t^2-2: *t", "what is"),
    ("t^2-2: " + "(" * 900 + "t" + ")" * 900, "parentheses"), ("t^2-2: 1e5t", "'e5t'"),
])
def test_what_is_no_irrational_vector_is_refused_in_one_line(text, words):
    with pytest.raises(ValueError, match=".") as error:
        read_rotation(text)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_the_number_of_angles_must_fit():
    with pytest.raises(ValueError, match="golden has one component, but the map has two angles"):
        read_rotation("golden", 2)
    with pytest.raises(ValueError, match="spiral has two components, but the map has one angle"):
        read_rotation("spiral", 1)


@pytest.mark.parametrize("root", [(0, 1), (-2, 2), (2, 1)])
def test_a_root_must_be_isolated(root):
    with pytest.raises(ValueError, match="has not one real root"):
        Rotation("", (-2, 0, 1), root, ((0, 1),))


@pytest.mark.slow
@given(st.lists(st.integers(-9, 9), min_size=3, max_size=4).filter(lambda p: p[-1]))
def test_irreducible_polynomials_have_no_rational_root(polynomial):
    rational = any(not evaluate(polynomial, Fraction(p, q))
                   for p in range(-9, 10) for q in range(1, 10))
    assert is_irreducible(tuple(polynomial)) is not rational


@pytest.mark.slow
@given(st.lists(st.integers(-50, 50), min_size=3, max_size=4).filter(
    lambda p: p[-1] and is_irreducible(tuple(p))), st.lists(st.fractions(max_denominator=99),
                                                          min_size=2, max_size=2))
def test_bounds_hold_the_value_and_the_field_is_a_field(polynomial, numbers):
    polynomial = tuple(polynomial)
    for root in real_roots(polynomial):
        field = Field(polynomial, root)
        t = field.element([0, 1])
        low, high = field.bounds(t, 50)
        assert 0 < high - low <= Fraction(1, 10 ** 50) and root[0] < high and low < root[1]
        assert evaluate(polynomial, low) * evaluate(polynomial, high) < 0
        a = field.element(numbers)
        assert field.bounds(field.element([0, 0, 0, 1]), 30)[0] <= high ** 3
        if any(a):
            assert field.product(a, field.inverse(a)) == field.element([1])
