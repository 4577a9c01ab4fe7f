"""The core for one and three angles, against an independent truth: the second variation along true
orbits, the largest eigenvalue over the torus, and a map of six dimensions."""

import itertools
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from converse import FourierMap, Problem, Settings
from converse.model.region import reduced
from converse.prover.native import Search, Task, grow

import kernels
from patches import arguments, variations
from truth import TORTURE, rng_for

CASES = 300 * TORTURE
FRAMES = {1: [(1,), (-2,)],
          3: [(1, 0, 0, 0, 1, 0, 0, 0, 1), (1, 1, 0, 1, -1, 1, 1, 0, -1),
              (2, 1, 0, 0, 1, -1, 1, 0, 1)]}
STAR = ("0.575",) * 3


@pytest.fixture(autouse=True)
def many_digits():
    with mpmath.workdps(40):
        yield


def draw(rng, n):
    """A random patch of n angles."""
    size, parameters = 10.0 ** rng.uniform(-0.7, 0.2), rng.randrange(4)
    kinds = [k for k in itertools.product(range(-2, 3), repeat=n) if any(k)]

    def part():
        return rng.choice([0.0, 10.0 ** rng.uniform(-9, -2) * size])

    def wave():
        return *rng.choice(kinds), *map(Fraction, (
            rng.choice([0.0, rng.uniform(0, 6)]), size * rng.uniform(-1, 1),
            *(part() if m < parameters else 0.0 for m in range(3))))

    return SimpleNamespace(
        waves=[wave() for _ in range(rng.randrange(1, 5))], parameters=parameters,
        frame=rng.choice(FRAMES[n]),
        centre=[Fraction(rng.uniform(-4, 4)) for _ in range(n)],
        half=[Fraction(rng.choice([0.0, 10.0 ** rng.uniform(-9, -1.5)])) for _ in range(n)],
        xstar=[Fraction(rng.uniform(-4, 4)) for _ in range(n)],
        shifts=[[Fraction(rng.choice([0.0, 1e-3])) if m < parameters else Fraction(0)
                 for m in range(3)] for _ in range(n)])


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_matrices_above_a_number(rows):
    """All eigenvalues count, also where two of them are below it, and the determinant is not."""
    rng, found, (i, j) = rng_for("matrices %d" % rows), [], np.triu_indices(rows)
    for _ in range(60):
        d = np.array([[rng.uniform(-1, 1) for _ in range(rows)] for _ in range(rows)])
        d, l = d + d.T, rng.uniform(-1, 1)
        least = np.linalg.eigvalsh(d)[0]
        above, value = kernels.call("matrix", [rows, Fraction(l), *map(Fraction, d[i, j]),
                                               *[0] * (6 - i.size)], 2, 30)
        assert above == (least > l) and abs(float(value) - least) < 1e-5
        found.append((bool(above), (np.linalg.eigvalsh(d) < l).sum()))
    assert {(True, 0), *[(False, n) for n in range(1, rows + 1)]} <= set(found)


@pytest.mark.parametrize("angles", [1, 3])
def test_the_bound_holds(angles):
    """The second variation with the core's vectors, along true orbits, is below its bound."""
    seen = proved = close = 0
    for patch, bound, values in variations(rng_for("bound of %d angles" % angles), CASES,
                                           lambda rng: draw(rng, angles)):
        assert max(values) <= bound, patch
        seen += 1
        proved += bound < 0
        close += bound - max(values) < 0.1 * abs(max(values))
    assert seen > CASES // 10 and proved > seen // 10 and close > seen // 10, (seen, proved, close)


def test_the_largest_eigenvalue_of_three_angles():
    """B is above the largest eigenvalue at any point, and hardly above at the best of these."""
    rng = rng_for("largest of three angles")
    for _ in range(4):
        patch = draw(rng, 3)
        patch.parameters = min(patch.parameters, 1)
        B = float(kernels.call("waves_largest_3", arguments(patch), 1, 20)[0])
        numbers = np.random.default_rng(rng.randrange(10 ** 6))

        def eigenvalues(x, signs):
            m = 2.0 * np.eye(3)
            for *k, phase, p, a, b, c in patch.waves:
                p = float(p) + sum(t * float(g) for t, g in zip(signs, (a, b, c)))
                m = m - p * np.sin(x @ k + float(phase))[:, None, None] * np.outer(k, k)
            return np.linalg.eigvalsh(m)[:, -1]

        best = 0.0
        for signs in itertools.product((-1, 1), repeat=patch.parameters):
            x = numbers.uniform(-4, 4, (1000, 3))
            for top in x[np.argsort(eigenvalues(x, signs))[-3:]]:
                for step in 0.3 * 0.75 ** np.arange(50):
                    x = np.vstack([top, top + step * numbers.uniform(-1, 1, (20, 3))])
                    top = x[eigenvalues(x, signs).argmax()]
                best = max(best, eigenvalues(top[None], signs)[0])
        assert best <= B <= best + 0.01 * (best - 2)


def line(epsilon):
    """V = -a sum sin y_i - 2a sin(y_0 + y_1 + y_2), a = 11.21436 epsilon; what of x_1 is left."""
    a = Fraction("11.21436") * Fraction(epsilon)
    return reduced(Problem(FourierMap({(1, 0, 0): a, (0, 1, 0): a, (0, 0, 1): a,
                                       (1, 1, 1): 2 * a})), STAR)


@pytest.mark.parametrize("epsilon, longest, most", [
    ("0.018", 5, 120), ("0.017", 5, 300),
    pytest.param("0.0133", 36, 13000, marks=pytest.mark.slow)])
def test_a_line_of_three_angles(epsilon, longest, most):
    """The longest orbits are those of a scalar program with unrounded doubles."""
    grown = grow(Task(line(epsilon), Settings("loewner"), STAR))
    assert set(grown.text) <= set("015P") and grown.counts.max_NTsteps == longest
    assert grown.counts.proved < most


def test_tori_of_three_angles_are_not_denied():
    """At epsilon = 0.002 regular orbits are seen."""
    grown = grow(Task(line("0.002"), Settings("loewner", 8, stubborn=True), STAR))
    assert grown.counts.undecided > 0


def test_a_parallel_map_is_one_angle():
    """The same tree and x* for k = m q as for its only angle, in whichever letter the frame has."""
    def search(waves, axes=None, **options):
        problem = Problem(FourierMap(waves), axes=axes, v0=(0, 2), v1=(0, 2))
        return Search(Task(problem, Settings("loewner"), **options))

    one = grow(Task(Problem(FourierMap({(1, 0): "1.2"})), Settings("loewner"), ("1.5", "0")))
    two = grow(Task(Problem(FourierMap({(0, 1): "1.2"})), Settings("loewner"), ("7", "1.5")))
    assert "0" in one.text and two.text == one.text.replace("0", "1")
    q = search({(1, 1): "0.6"}, axes=(1, 0, -1, 1))
    assert q.one.q == (1, 1) and q.one.i == 1 and q.one.c == 1
    assert sum(map(Fraction, q.xstar)) == Fraction(Search(Task(
        Problem(FourierMap({(1, 0): "1.2"})), Settings("loewner"))).xstar[0])
    assert search({(1, 1): "0.6"}, axes=(1, 0, 0, 1)).one is None     # both v are felt
    assert search({(1, 1): "0.6", (1, 0): "0.1"}).one is None
