"""The error of tori with many digits, against doubles and against sums with many digits."""

import tracemalloc
from fractions import Fraction as Q

import mpmath
import numpy as np
import pytest
from flint import ctx

from converse.model.potential import FourierSum
from converse.tori.effort import REFINING_BYTES
from converse.tori.newton import Mesh
from converse.tori.precise import errors
from converse.tori.refinement import Modes, numbers_of
from converse.tori.rotation import read_rotation
from converse.tori.torus import Torus

BITS = 90
CIRCLE = FourierSum(((2, 0, Q(0)), (4, 0, Q(1, 3))), (Q("0.4"), Q("-0.11")), 1)
THESIS = FourierSum(((1, 0, Q(0)), (0, 1, Q(0)), (1, 1, Q(0))), (Q("0.1"), Q("0.12"), Q("0.2")), 2)
MIXED = FourierSum(((1, -1, Q(1, 7)), (2, 2, Q(-3, 4)), (0, 2, Q(1))),
                   (Q("0.2"), Q("0.07"), Q("-0.05")), 2)
LINE = FourierSum(((2, -1, Q(2, 5)), (-4, 2, Q(0))), (Q("0.1"), Q("0.03")), 2)
CROSS, PLAIN = ((1, 1), (1, -1)), ((1, 0), (0, 1))
CASES = {"circle": (CIRCLE, ((1,),), (64,)), "thesis": (THESIS, CROSS, (64, 16)),
         "mixed": (MIXED, PLAIN, (48, 24)), "line": (LINE, PLAIN, (32,))}
every_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


def some_torus(case, degree):
    """(Modes, a torus with a few random modes, far from invariant), of a range if degree > 0."""
    potential, frame, sizes = case
    n = potential.dimension
    mesh = Mesh(potential, read_rotation("golden" if n == 1 else "T49"), frame, sizes,
                real=not degree)
    modes = Modes(mesh, mesh.inside & (abs(mesh.k).max(0) <= 4) & (abs(mesh.k).max(0) > 0))
    chance = np.random.default_rng(1)
    c = 0.05 * 3.0 ** -abs(modes.k).sum(0) * 0.25 ** np.arange(degree + 1)[:, None, None] * (
        chance.normal(size=(degree + 1, *modes.k.shape)) + 1j * chance.normal(size=modes.k.shape))
    part, piece = (None, (Q(0), Q(0))) if not degree else (
        tuple(p / 3 for p in potential.amplitude), (Q(-1), Q(1, 3)))
    return modes, Torus(potential, part, mesh.rotation, BITS, modes.k.T, numbers_of(c, BITS), None,
                        piece)


@every_case
@pytest.mark.parametrize("degree", [0, 2])
def test_errors_are_those_of_doubles(case, degree):
    """For real sigma and for complex sigma, where u and V have complex values at real angles."""
    modes, torus = some_torus(case, degree)
    mesh, layers = modes.mesh, 8 if degree else 1
    wanted = mesh.inside & (mesh.k[0] != 3)
    amplitude = np.array(torus.amplitudes, float)
    found = list(errors(mesh, torus, layers, wanted, BITS))
    assert len(found) == layers // 2 + 1 and ctx.prec == 53
    for l, (u, e) in enumerate(zip(modes.on_circle(torus.doubles, layers), found)):
        sigma = np.exp(2j * np.pi * l / layers)
        p = amplitude[:, 0] + amplitude[:, 1] * sigma if degree else amplitude[:, 0]
        assert abs(e).max() > 1e-3
        assert e == pytest.approx(mesh.error(u, p) * wanted, abs=1e-15)


def test_digits_beyond_doubles_are_right():
    """E of a torus near which there is an invariant one: here 1e-17 of terms of 1e-1."""
    potential = FourierSum(((1, 0, Q(0)),), (Q(1, 10),), 1)
    golden = read_rotation("golden")
    mesh = Mesh(potential, golden, ((1,),), (64,))
    modes = Modes(mesh, mesh.inside & (mesh.k[0] > 0))
    u = np.zeros((1, *mesh.k.shape[1:]), complex)
    for _ in range(6):
        u = u + mesh.correction(u, mesh.error(u, np.array([0.1])))
    torus = Torus(potential, None, golden, BITS, modes.k.T,
                  numbers_of(modes.picked(u)[None], BITS))
    found, = errors(mesh, torus, 1, mesh.inside, BITS)
    with mpmath.workdps(40):
        (low, _), = golden.turns(45)
        omega = mpmath.mpf(low.numerator) / low.denominator
        c = [mpmath.mpc(*parts) / 2 ** BITS for parts in torus.numbers[:, 0, 0].T.tolist()]
        total = [mpmath.mpc(0)] * 4
        for j in range(64):
            theta = 2 * mpmath.pi * j / 64
            x = theta + sum(2 * (a * mpmath.expj(k * theta)).real
                            for a, k in zip(c, torus.k[:, 0].tolist()))
            total = [t - mpmath.cos(x) / 10 * mpmath.expj(-k * theta) / 64
                     for k, t in enumerate(total)]
        for k in 1, 2, 3:
            exact = total[k] - 4 * mpmath.sin(mpmath.pi * k * omega) ** 2 * c[k - 1]
            assert 0 < abs(exact) < 1e-16
            assert abs(mpmath.mpc(found[0, k]) - exact) < 1e-9 * abs(exact) + mpmath.mpf(10) ** -26


@every_case
def test_memory_is_what_is_said(case):
    modes, torus = some_torus(case, 0)
    tracemalloc.start()
    try:
        list(errors(modes.mesh, torus, 1, modes.mesh.inside, BITS))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < REFINING_BYTES * modes.mesh.points + 200000
