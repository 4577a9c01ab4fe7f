"""The image of a prism holds the image of every point of it; inverses are as good as they say."""

import itertools
from fractions import Fraction

import mpmath
import pytest

import kernels
from truth import (CLOSE, DIGITS, TORTURE, beta, cube_of, cube_point, decimal, exact, list_prism,
                   mp, point_of, rng_for, step, uniform)

DP = 35


def outside(inside, x):
    """By how much the worst cube coordinate of x exceeds 1; of a prism, by its cube_of."""
    return max(map(abs, inside(x))) - 1


def random_prism(rng):
    """A prism of any shape, as they come up along an orbit."""
    centre = [decimal(uniform(rng, -1, 1)) for _ in range(3)]
    centre += [decimal(uniform(rng, -9, 9)) for _ in range(4)]
    size = Fraction(1, 10**rng.randrange(0, 8))
    matrix = [[Fraction(0)] * 7 for _ in range(7)]
    for j in range(3):
        matrix[j][j] = decimal(uniform(rng, 0, "0.01")) * rng.choice((0, 1, 1))
    for j in range(3, 7):
        for k in range(7):
            if k >= 3 or matrix[k][k] != 0:
                matrix[j][k] = decimal(uniform(rng, -1, 1) * size / 5)
    if rng.randrange(10) == 0:
        matrix = [[x if j == k else Fraction(0) for k, x in enumerate(row)]
                  for j, row in enumerate(matrix)]
    return centre, matrix


def test_every_rounding_of_gauss_jordan_counts():
    """A matrix climbed to: its error is within the bound, and more than half of it."""
    rows = ["17.754533872504574 1.248459279028823 4.662584663e-07 -7.3131404e-09",
            "1.4611562116364845 0.0837104530633502 -2.583818e-10 1.428e-13",
            "0 -1.08322e-11 -17.027131768541814 0.2428988620418489",
            "-0.0051376467362393 1.205120668235213 -0.3280600471043452 3.942747832860456"]
    matrix = [[Fraction(word) for word in row.split()] for row in rows]
    *found, error = kernels.call("gauss_jordan", [x for row in matrix for x in row], 17, 12)
    true = [x for row in exact_inverse(matrix) for x in row]
    assert error / 2 < max(abs(x - y) for x, y in zip(found, true)) <= error


def test_a_pivot_hardly_larger_than_its_error():
    """The reciprocal of 982 is cut off by nearly a unit, and the last pivot is one and a half times
    what becomes of that."""
    rows = ["500 0 0 0", "0 500 0 0", "0 0 982 972.18", "0 0 972.18 962.463271267968"]
    matrix = [[Fraction(word) for word in row.split()] for row in rows]
    *found, error = kernels.call("gauss_jordan", [x for row in matrix for x in row], 17, 8)
    true = [x for row in exact_inverse(matrix) for x in row]
    assert error * 9 / 10 < max(abs(x - y) for x, y in zip(found, true)) <= error


def exact_inverse(matrix):
    """Gauss-Jordan in rational arithmetic."""
    n = len(matrix)
    m = [list(row) + [Fraction(j == k) for k in range(n)] for j, row in enumerate(matrix)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda j: abs(m[j][i]))
        m[i], m[pivot] = m[pivot], m[i]
        m[i] = [x / m[i][i] for x in m[i]]
        for j in range(n):
            if j != i and m[j][i] != 0:
                m[j] = [x - m[j][i] * y for x, y in zip(m[j], m[i])]
    return [row[n:] for row in m]


@pytest.mark.parametrize("matrix", [
    [[0] * 4] * 4,
    [[1, 2, 3, 4], [2, 4, 6, 8], [0, 1, 0, 0], [0, 0, 1, 0]],
    [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
])
def test_singular_matrices_are_given_up(matrix):
    with pytest.raises(ArithmeticError):
        kernels.inverse(matrix, DP)
    with pytest.raises(ArithmeticError):
        kernels.inverse(matrix, DP, arithmetic="double")


@pytest.mark.parametrize("dp", [1, 2, 3, 5])
@pytest.mark.parametrize("make", [list_prism, random_prism])
@pytest.mark.slow
def test_image_with_few_digits(make, dp):
    """Prisms about as small as the last place: here the error terms are all that holds."""
    rng = rng_for("few digits %d" % dp)
    tested = 0
    for _ in range(100 * TORTURE):
        centre, matrix = make(rng)
        largest = max(max(map(abs, row)) for row in matrix) or 1
        scale = Fraction(rng.randrange(1, 100), 10**(dp + rng.randrange(1, 7))) / largest
        centre = [decimal(x, dp) for x in centre[:3]] + centre[3:]
        prism = (centre, [[decimal(x * scale, 40) for x in row] for row in matrix])
        if rng.random() < 0.2:
            prism = (prism[0], [[Fraction(0)] * 7 for _ in range(7)])
        try:
            image = kernels.image(prism, dp)
        except ArithmeticError:
            continue
        inside = cube_of(image)
        for _ in range(6):
            assert outside(inside, step(point_of(prism, cube_point(rng)))) <= CLOSE * 10**20
            tested += 1
    assert tested > 100


@pytest.mark.parametrize("make", [list_prism, random_prism])
@pytest.mark.slow
def test_widths_are_rounded_up(make):
    """Of prisms so small that nothing else counts: the corners' images touch the image's wall."""
    rng, dp, closest = rng_for("tiny" + make.__name__), 60, -1
    for _ in range(20 * TORTURE):
        centre, matrix = make(rng)
        prism = (centre, [[x / 10**18 for x in row] for row in matrix])
        try:
            image = kernels.image(prism, dp)
        except ArithmeticError:
            continue
        inside = cube_of(image)
        for signs in itertools.product((-1, 1), repeat=7):
            if all(matrix[j][j] or signs[j] > 0 for j in range(3)):
                worst = outside(inside, step(point_of(prism, signs)))
                assert worst <= Fraction(1, 10**30)
                closest = max(closest, worst)
    assert closest > Fraction(-1, 10**10)


@pytest.mark.parametrize("dp", [12, DP])
@pytest.mark.slow
def test_no_zero_width_is_singular(dp):
    """One angle or both without width, the parameters with or without: two images are found."""
    rng, tested = rng_for("zero widths"), 0
    while tested < 200:
        prism = list_prism(rng)
        if prism[1][5][5] * prism[1][6][6] == 0:
            kernels.image(kernels.image(prism, dp), dp)
            tested += 1


def test_the_error_of_the_centre_grows_with_the_parameters_of_any_prism():
    """The same for the column rotor: a prism hardly larger than the last place."""
    rng, dp = rng_for("large rotor"), 6
    ulp, tested = Fraction(1, 10**dp), 0
    for _ in range(150 * TORTURE):
        centre = [decimal(uniform(rng, -10**4, 10**4), 2) for _ in range(3)]
        centre += [decimal(uniform(rng, -7, 7)) for _ in range(4)]
        matrix = [[Fraction(0)] * 7 for _ in range(7)]
        for j in range(3, 7):
            for k in range(3, 7):
                matrix[j][k] = ulp * (20 * (j == k) + rng.randrange(-3, 4))
        try:
            image = kernels.image((centre, matrix), dp)
        except ArithmeticError:
            continue
        tested, inside = tested + 1, cube_of(image)
        for _ in range(4):
            x = step(point_of((centre, matrix), cube_point(rng)))
            assert outside(inside, x) <= CLOSE * 10**20
    assert tested > 100 * TORTURE


def sums_at(prism, x):
    """At a point: the sums of |beta|, of |(gamma - gamma_c) P_pp| and of |beta - beta_c|, each over
    all entries of both rows."""
    centre, matrix = prism

    def entries(p):
        first, mixed, second = beta(*map(mp, p[:3] + p[5:]))
        return [first, mixed, mixed, second]

    def waves(p):
        return [mpmath.cos(mp(y)) for y in (p[5], p[6], p[5] + p[6])]

    with mpmath.workdps(DIGITS):
        here, there = entries(x), entries(centre)
        moved = [abs(y - z) * mp(matrix[j][j])
                 for j, (y, z) in enumerate(zip(waves(x), waves(centre)))]
        return [exact(y) for y in (sum(map(abs, here)), sum(moved) + moved[2],
                                   sum(abs(y - z) for y, z in zip(here, there)))]


@pytest.mark.parametrize("alone", [None, 2])
def test_the_sums_over_all_entries(alone):
    """Each entry counts, that of c twice in gamma and four times in beta; corners of prisms of the
    list come near."""
    rng, closest = rng_for("sums"), [0] * 3
    for i in range(12 * TORTURE):
        centre, matrix = (list_prism if i % 2 else random_prism)(rng)
        for j in range(3):
            if alone in (None, j):
                matrix[j][j] = Fraction(1, 100)
            else:
                centre[j] = matrix[j][j] = Fraction(0)
        prism = centre, matrix
        bounds = kernels.call("row_sums", [*centre, *itertools.chain(*matrix)], 3, DP)
        for signs in itertools.product((-1, 1), repeat=5):
            found = sums_at(prism, point_of(prism, [*signs[:3], 0, 0, *signs[3:]]))
            for k, (x, bound) in enumerate(zip(found, bounds)):
                assert x <= bound + CLOSE
                closest[k] = max(closest[k], x / bound)
    assert min(closest) > 0.99


@pytest.mark.parametrize("dp", [1, 2, 4])
@pytest.mark.slow
def test_the_error_of_the_inverse(dp):
    """Without parameters the map is linear, and large prisms leave the bounds no slack but that."""
    rng, tested = rng_for("linear%d" % dp), 0
    ulp = Fraction(1, 10**dp)
    for _ in range(100 * TORTURE):
        matrix = [[Fraction(0)] * 7 for _ in range(7)]
        for j in range(3, 7):
            for k in range(3, 7):
                matrix[j][k] = ulp * rng.randrange(-50 * 10**dp, 50 * 10**dp)
        prism = ([Fraction(0)] * 7, matrix)
        try:
            image = kernels.image(prism, dp)
        except ArithmeticError:
            continue
        tested, inside = tested + 1, cube_of(image)
        for _ in range(6):
            eta = [Fraction(rng.choice((-1, 1))) for _ in range(7)]
            assert outside(inside, step(point_of(prism, eta))) <= CLOSE * 10**20
    assert tested > 90


@pytest.mark.parametrize("dp", [2, 4])
@pytest.mark.parametrize("tall", [(3, 4), (5, 6)])
@pytest.mark.slow
def test_needles_of_a_linear_map(tall, dp):
    """Without parameters, and one half of the rows far above the other: all rows of |P'^-1 DG P|,
    in rational arithmetic, are at most one."""
    rng, tested = rng_for("needles%d%d" % (dp, tall[0])), 0
    for _ in range(175 * TORTURE):
        scale = rng.choice((10, 50, 200, 1000))
        tiny = rng.choice((1, 2, 5, 20, 100))
        matrix = [[Fraction(0)] * 7 for _ in range(7)]
        for j in range(3, 7):
            most = scale * 10**dp if j in tall else tiny
            for k in range(3, 7):
                matrix[j][k] = Fraction(rng.randrange(-most, most + 1), 10**dp)
        try:
            image = kernels.image(([Fraction(0)] * 7, matrix), dp)
        except ArithmeticError:
            continue
        tested += 1
        corner = [row[3:] for row in matrix[3:]]
        after = corner[2:] + [[2 * x - y for x, y in zip(corner[2 + j], corner[j])]
                              for j in range(2)]
        for row in exact_inverse([row[3:] for row in image[1][3:]]):
            assert sum(abs(sum(x * y[k] for x, y in zip(row, after))) for k in range(4)) <= 1
    assert tested > 100


def test_every_rounding_of_the_column_rotor_counts():
    """The columns of the parameters and the centre all lose nearly a unit of the last place, in
    the same direction; the corner of u and v loses nothing."""
    ulp, part = Fraction(1, 100), Fraction(99, 10000)
    matrix = [[Fraction(0)] * 7 for _ in range(7)]
    for j in range(3):
        matrix[j][j] = Fraction(1, 10**9)
    for j in range(2):
        matrix[3 + j] = [part] * 3 + [Fraction(0)] * 4
        matrix[5 + j] = [part] * 3 + [Fraction(0)] * 4
        matrix[3 + j][3 + j], matrix[3 + j][5 + j] = 20 * ulp, -10 * ulp
        matrix[5 + j][3 + j] = 10 * ulp
    centre = [Fraction(0)] * 3 + [Fraction(1) - part] * 2 + [Fraction(1, 2)] * 2
    image = kernels.image((centre, matrix), 2)
    worst = outside(cube_of(image), step(point_of((centre, matrix), [1] * 7)))
    assert Fraction(-1, 20) < worst <= CLOSE


def test_the_sign_of_a_width_does_not_matter():
    """A prism of the list turned over is the same set; the parameters must not be."""
    rng = rng_for("signs")
    for _ in range(50 * TORTURE):
        centre, matrix = list_prism(rng)
        for j in (5, 6):
            matrix[j][j] *= rng.choice((-1, -1, 1))
        inside = cube_of(kernels.image((centre, matrix), DP))
        for _ in range(8):
            assert outside(inside, step(point_of((centre, matrix), cube_point(rng)))) <= CLOSE


@pytest.mark.parametrize("row, column, entry", [(0, 0, -1), (2, 2, -1), (0, 1, 1), (1, 5, -1)])
@pytest.mark.parametrize("name, nout", [("image", 56), ("btrace", 2), ("Blams", 4)])
def test_what_is_no_prism_is_refused(name, nout, row, column, entry):
    matrix = [[Fraction(j == k) / 100 for k in range(7)] for j in range(7)]
    matrix[row][column] = Fraction(entry, 100)
    numbers = [0] * 7 + [x for row in matrix for x in row]
    for arithmetic in kernels.ARITHMETICS:
        with pytest.raises(ValueError, match="no negative widths"):
            kernels.call(name, numbers, nout, DP, arithmetic=arithmetic)


@pytest.mark.parametrize("dp", [2, 4])
def test_the_roundings_of_the_fixed_form(dp):
    """No parameters to speak of, widths just below a unit of the last place."""
    rng = rng_for("roundings%d" % dp)
    ulp = Fraction(1, 10**dp)
    for _ in range(100 * TORTURE):
        centre = [Fraction(0)] * 3 + [decimal(uniform(rng, 0, 1)) for _ in range(2)]
        centre += [ulp * rng.randrange(-3, 4) for _ in range(2)]
        half = [ulp * 99 / 100] * 3 + [0, 0] + [ulp * rng.randrange(2, 9)] * 2
        prism = (centre, [[Fraction(half[j]) if j == k else Fraction(0) for k in range(7)]
                          for j in range(7)])
        inside = cube_of(kernels.image(prism, dp))
        for eta in ([1] * 7, [-1] * 7, [1, 1, 1, 0, 0, -1, -1], [-1, -1, -1, 0, 0, 1, 1]):
            assert outside(inside, step(point_of(prism, eta))) <= CLOSE * 10**20
