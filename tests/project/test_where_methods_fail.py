"""Where the methods fail: a right answer, or "undecided" with the true reason counted."""

from fractions import Fraction

import pytest
from conftest import around

import converse

import kernels
from truth import cube_of, cube_point, decimal, point_of, rng_for, step, uniform

REASONS = ("centre", "too big", "too long", "singular", "arithmetic", "disagree")
FULL = (("1", "1"), ("1", "1"))


def problem(a, b, c, v=FULL):
    pairs = [a, b, c, *v]
    return around(tuple(Fraction(x) for x, _ in pairs),
                          tuple(Fraction(x) for _, x in pairs), ())


def reasons(proof):
    return dict(zip(REASONS, proof.counts.reasons))


def needle(rng, thin):
    """A prism whose columns of u and v are parallel but for a part in 1/thin."""
    centre = [Fraction(x) for x in ("0.3", "0.3", "0.6")] + [decimal(uniform(rng, 0, 6))
                                                            for _ in range(4)]
    matrix = [[Fraction(0)] * 7 for _ in range(7)]
    along = [decimal(uniform(rng, -1, 1) / 100) for _ in range(4)]
    for k in range(3, 7):
        for j in range(3, 7):
            matrix[j][k] = decimal(along[j - 3] * (k - 2) + thin * uniform(rng, -1, 1) / 100, 80)
    return centre, matrix


@pytest.mark.parametrize("thin", ["1e-3", "1e-10", "1e-20", "1e-30", "1e-34"])
def test_needles(thin):
    """The rotor opens a needle; what cannot be inverted is given up; the image always holds."""
    rng = rng_for("needle" + thin)
    for _ in range(60):
        prism = needle(rng, Fraction(thin))
        try:
            image = kernels.image(prism, 35)
        except ArithmeticError:
            continue
        inside = cube_of(image)
        for _ in range(4):
            worst = max(map(abs, inside(step(point_of(prism, cube_point(rng))))))
            assert worst <= 1 + Fraction(1, 10**20)


def test_exactly_flat_prisms_are_given_up_or_right():
    """Without the rotation nothing could be inverted; with it some flat prisms still cannot."""
    rng = rng_for("flat")
    given_up = 0
    for _ in range(50):
        prism = needle(rng, Fraction(0))
        try:
            kernels.image(prism, 35)
        except ArithmeticError:
            given_up += 1
    assert given_up < 50


@pytest.mark.parametrize("a, b, c", [
    (("0.30", "0.001"), ("0.32", "0.001"), ("0.62", "0.001")),
    (("0.9", "0"), ("0.3", "0"), ("0.5", "0")),
    (("0.32", "0"), ("0.32", "0"), ("-0.64", "0")),
    (("-0.32", "0"), ("-0.32", "0"), ("0.64", "0")),
])
def test_unsymmetric_and_negative(a, b, c):
    """No symmetry is assumed that is not there, and signs do not matter."""
    proof = converse.prove(problem(a, b, c), method="thesis")
    assert proof.no_tori
    if a != b:
        assert proof.counts.symmetric == 0


@pytest.mark.parametrize("k, theorem", [("1.34", True), ("1.3", False), ("0.9", False)])
def test_the_cylinder(k, theorem):
    """b = c = 0: two standard maps, one of them trivial.  The thesis's bound of the largest
    eigenvalue of a block, Tr d - lam_-, knows nothing of the other angle, and so Mather's 4/3
    is as far as it goes; where circles exist nothing is claimed."""
    proof = converse.prove(problem((k, 0), ("0", 0), ("0", 0)), depth=12, method="thesis")
    if not theorem:
        assert not proof.no_tori and proof.counts.undecided > 0
    if proof.no_tori:
        assert Fraction(k) > Fraction(4, 3)


def test_huge_angles():
    """The region may lie far away, as long as a double, the quick filter's, still has digits
    to tell its points apart; then it is undecided, and the filter is the reason."""
    def there(turns):
        v = ((Fraction(turns) + 1, "1"),) * 2
        return problem(("0.3085", "0"), ("0.3085", "0"), ("0.617", "0"), v)

    assert converse.prove(there(10**6), method="thesis").no_tori
    far = converse.prove(there(10**20), method="thesis")
    assert not far.no_tori and reasons(far)["centre"] > 0
