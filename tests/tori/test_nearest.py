"""Rotation vectors near a place, with good small divisors."""

from fractions import Fraction

import numpy as np
import pytest

from converse.check.field import Divisors, Norm
from converse.tori import nearest, read_rotation
from converse.tori.nearest import cubics, rotation_of


@pytest.mark.parametrize("number, tolerance", [("0.618", "1/1000"), ("0.4", "1/100"),
                                               ("-0.3", "1e-6"), ("2.29", "1e-5")])
def test_a_noble_number_is_near(number, tolerance):
    rotation = nearest([number], tolerance)
    assert rotation.polynomial == (-1, 1, 1)
    assert abs(rotation.floats[0] - float(number)) <= Fraction(tolerance) * (1 + 1e-9)
    assert number != "0.618" or rotation.text() == "t^2+t-1: t"
    x, ones = rotation.turns(300)[0][0], 0      # the continued fraction ends in 1, 1, 1, ...
    for _ in range(200):
        quotient = x // 1
        ones = ones + 1 if quotient == 1 else 0
        x = 1 / (x - quotient)
    assert ones > 80


@pytest.mark.parametrize("place, within", [((0.2077,), 1e-4), (("0.38",), 1e-2), ((0.5,), 0.1),
                                           ((Fraction(2, 7),), 1e-3)])
def test_a_number_is_taken_to_its_last_decimal(place, within):
    assert abs(nearest(place).floats[0] - float(place[0])) <= within * (1 + 1e-9)


@pytest.mark.slow
def test_a_vector_of_two_angles_is_near():
    rotation = rotation_of("0.2987, 0.2921", 2)
    assert rotation.floats == pytest.approx([0.2987, 0.2921], abs=0.001)
    assert read_rotation(rotation.text()) == rotation


def test_a_place_that_is_none_is_refused():
    for place, tolerance, words in ((["0.3"], "1e-20", "the tolerance, 1e-20, is not from"),
                                    (["0.3", "0.2", "0.1"], None, "has 3 components; give one or"),
                                    (["1/0"], None, "not a decimal number")):
        with pytest.raises(ValueError, match=words):
            nearest(place, tolerance)
    with pytest.raises(ValueError, match="near 0.3, 0.2 has 2 components; give 1"):
        rotation_of("0.3, 0.2", 1)
    with pytest.raises(TypeError, match=r"near=\(0.618,\) takes numbers"):
        rotation_of(0.618)


@pytest.mark.parametrize("text, same", [
    ("[0; 1, 1, ...]", "golden"), ("[0; 2, 2, ...]", "silver"), ("[0; 2, ...]", "t^2+t-1: 1-t"),
    ("[-1; 1, 1, ...]", "t^2+t-1: t-1"), ("[0; 4, 4, 1, 1, ...]", "t^2+t-1: (48+t)/205"),
    ("[0;4,4,1,...]", "t^2+t-1: (48+t)/205")])
def test_a_continued_fraction_is_read(text, same):
    rotation = read_rotation(text)
    assert rotation.floats == pytest.approx(read_rotation(same).floats, abs=1e-15)
    assert read_rotation(rotation.continued_fraction()) == rotation


@pytest.mark.parametrize("text", ["[0; 2]", "[0; 0, ...]", "[0.5; 1, ...]", "[0; 1, x, ...]", "[]",
                                  "[0; 99999999, ...]", "[0; ...]"])
def test_what_is_no_continued_fraction_is_refused(text):
    with pytest.raises(ValueError, match="continued fraction|quotients"):
        read_rotation(text)


def test_small_divisors_count_by_the_norm_of_the_torus():
    """Modes of a torus of the line at epsilon = 0.011 are long along k0 = k1.  In this norm the
    checker finds an eighth of the loss that the vectors nearby have which are best in |k0| + |k1|.
    """
    frame, alpha = ((1, 1), (1, -1)), (1, 6)
    norm = np.diag(alpha) @ frame / 12 ** 0.5

    def loss(rotation):
        length = Norm(frame, alpha, ((1, 0), (0, 1)))
        return Divisors(rotation.field, rotation.vector, length).loss(Fraction("0.0015"))

    place = Fraction("0.2927"), Fraction("0.2982"), Fraction("0.001")
    plain, fitting = cubics(place[:2], place[2], 1), cubics(place[:2], place[2], 1, norm)
    assert loss(fitting[0]) < loss(plain[0]) / 8
