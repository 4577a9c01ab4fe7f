"""Small divisors: bounds for all k against the divisors of many k, computed one by one."""

from fractions import Fraction
from math import gcd, isqrt, pi

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from converse.tori import Divisors, Norm, Rotation, lattice_basis, near, read_rotation
from converse.tori.field import is_irreducible, real_roots

LINE = ((1, 1), (1, -1))
SQUARE = ((1, 0), (0, 1))
THESIS = (1, 0), (0, 1), (1, 1)
ONE = Norm(((1,),), (1,))


def distances(rotation, vectors):
    """Of k.omega from the integers, to 1e-40 and as doubles."""
    unit = 10 ** 50
    omega = [int(low * unit) for low, _ in rotation.turns(50)]
    found = []
    for k in vectors:
        rest = sum(x * w for x, w in zip(k, omega)) % unit
        found.append(min(rest, unit - rest) / unit)
    return np.array(found)


@pytest.mark.parametrize("name,frame,alpha,tail,all_k", [
    ("golden", ((1,),), [1], 2.80992, 1.86406), ("silver", ((1,),), [1], 2.22144, 1.92781),
    ("T49", LINE, (1, 1), .47008, .470078), ("T49", LINE, (1, 2), 1.88031, 1.88031),
    ("T49", LINE, (1, 3), 4.23071, 4.23071), ("T49", LINE, (1, 4), 7.52125, 7.52125),
    ("T49", LINE, (1, 5), 11.7520, 7.53886), ("T49", LINE, (1, 6), 16.9229, 7.53886),
    ("spiral", SQUARE, (1, 1), 1.47333, 1.39238), ("seven", SQUARE, (1, 1), 1.21795, 1.21428),
    ("V1", LINE, (1, 3), 13.0301, 1.59057), ("V1", LINE, (1, 8), 49.0277, 7.67646),
    ("V2", LINE, (1, 4), 12.7858, 2.59887),
])
def test_constants_of_named_vectors(name, frame, alpha, tail, all_k):
    waves = THESIS if len(frame) == 2 else [(1,)]
    divisors = Divisors(read_rotation(name), Norm(frame, alpha), lattice_basis(waves), 300)
    assert float(divisors.gamma_tail) == pytest.approx(tail, rel=2e-4)
    assert float(divisors.gamma) == pytest.approx(all_k, rel=2e-4)


def quadratics():
    """Random numbers of random real quadratic fields."""
    small = st.fractions(-3, 3, max_denominator=12)
    return st.builds(
        lambda polynomial, which, a, b: Rotation(
            "", polynomial, real_roots(polynomial)[which], ((a, b),)),
        st.tuples(st.integers(-30, 30), st.integers(-9, 9), st.integers(1, 5)).filter(
            lambda p: is_irreducible(p) and real_roots(p)),
        st.sampled_from((0, 1)), small, small.filter(bool))


@given(quadratics(), st.fractions("1/3", 4, max_denominator=7), st.integers(1, 3))
@settings(max_examples=15, deadline=None)
def test_bounds_hold_for_random_quadratic_numbers(rotation, alpha, step):
    try:
        divisors = Divisors(rotation, Norm(((1,),), (alpha,)), ((step,),), 60)
    except ValueError as error:
        assert "reach" in str(error)
        return
    m = step * np.arange(1, 5001)
    size = m * float(alpha)
    true = 2 * np.sin(pi * distances(rotation, m[:, None].tolist()))
    assert (size * true)[size >= 60].min() >= float(divisors.gamma_tail) * (1 - 1e-12)
    assert (size * true).min() >= float(divisors.gamma) * (1 - 1e-12)
    for delta in (Fraction(1, 2), Fraction(1, 30), Fraction(1, 1000)):
        check_c(divisors, delta, size, true)


def check_c(divisors, delta, size, true):
    """c(delta) is above what these k ask for, and not far above it if they reach beyond 8/delta."""
    tau, small = divisors.tau, float(delta)
    sup, at = 0.0, (np.exp(-small * size) / true).max()
    for d in small * np.exp2(-np.arange(0, 10, .05)):
        sup = max(sup, (d / small) ** tau * (np.exp(-d * size) / true).max())
    c, single = divisors.c(delta), divisors.c_at(delta)
    assert isinstance(c, arb) and c.rad() == 0
    assert sup <= float(c) * (1 + 1e-12) and at <= float(single) * (1 + 1e-12)
    assert float(single) <= float(c) * (1 + 1e-12)
    generic = (tau / (np.e * small)) ** tau / float(divisors.gamma_tail)
    assert float(c) <= max(sup * 1.01, generic * (1 + 1e-12))


@pytest.mark.parametrize("name", ["golden", "silver"])
def test_bounds_hold_and_are_sharp_on_a_line(name):
    rotation = read_rotation(name)
    divisors = Divisors(rotation, ONE, ((1,),), 10000)
    k = np.arange(1, 10001)
    true = 2 * np.sin(pi * distances(rotation, k[:, None].tolist()))
    assert float(divisors.gamma) == pytest.approx((k * true).min(), rel=1e-9)
    assert (k * true)[10:].min() == pytest.approx(float(divisors.gamma_tail), rel=.01)
    for delta in ("1/2", "1/30", "1/900"):
        check_c(divisors, Fraction(delta), k, true)
    records = [(d.k[0], float(d.low)) for d in divisors.records]
    best = np.minimum.accumulate(true)
    assert [k for k, _ in records] == [1, *(1 + np.flatnonzero(best[1:] < best[:-1]) + 1).tolist()]
    for k, low in records:
        assert low == pytest.approx(true[k - 1], rel=1e-9) and low <= true[k - 1] * (1 + 1e-13)


@pytest.mark.parametrize("text,frame,alpha,basis", [
    ("T49", LINE, (1, 4), SQUARE), ("V1", LINE, (1, "7/2"), SQUARE),
    ("spiral", SQUARE, (1, 1), SQUARE), ("seven", SQUARE, (3, "1/2"), SQUARE),
    ("spiral", LINE, ("1/3", 2), ((2, 1), (0, 3))),
    ("T49", SQUARE, (1, 1), ((1, 1), (0, 2))),
    ("3t^3-t-7: t/5, (1+t^2)/3", ((2, 1), (0, 1)), (1, 2), SQUARE),
    ("t^3+t^2-2t-1 near -2: t/2, t^2+t/3", LINE, (1, 1), ((3, 0), (0, 1))),
])
def test_bounds_hold_in_the_plane(text, frame, alpha, basis):
    rotation, norm = read_rotation(text), Norm(frame, alpha)
    divisors = Divisors(rotation, norm, basis, 25)
    (a, b), (_, d) = basis
    vectors = [(a * i, b * i + d * j) for i in range(121) for j in range(-120, 121)
               if (i, j) > (0, 0)]
    size = np.array([float(norm.of(k)) for k in vectors])
    true = 2 * np.sin(pi * distances(rotation, vectors))
    assert (size ** 2 * true)[size >= 25].min() >= float(divisors.gamma_tail) * (1 - 1e-12)
    assert (size ** 2 * true).min() >= float(divisors.gamma) * (1 - 1e-12)
    for delta in (Fraction(1, 3), Fraction(1, 20), Fraction(1, 200)):
        check_c(divisors, delta, size, true)
    small = sorted(zip(size[size <= 25], true[size <= 25]))
    best = float("inf")
    for far, value in small:            # every k has a record before it
        assert any(float(r.size) <= far * (1 + 1e-12) and float(r.low) <= value * (1 + 1e-12)
                   for r in divisors.records)
        best = min(best, value)
    assert float(divisors.records[-1].low) == pytest.approx(best, rel=1e-9)


def test_a_shorter_reach_weakens_the_bounds_only_a_little():
    near_one, far = (Divisors(read_rotation("V1"), Norm(LINE, (1, 4)), SQUARE, reach)
                     for reach in (30, 600))
    assert near_one.gamma_tail <= far.gamma_tail * (1 + Fraction(1, 10 ** 12))
    assert near_one.c(Fraction(1, 100)) >= far.c(Fraction(1, 100))


@pytest.mark.parametrize("delta", [Fraction(0), Fraction(-1), arb(0, 1), arb("nan")])
def test_no_bound_without_a_positive_delta(delta):
    divisors = Divisors(read_rotation("golden"), ONE, ((1,),), 100)
    assert not divisors.c(delta) < 1e300 and not divisors.c_at(delta) < 1e300


def test_a_ball_of_deltas_takes_the_worst():
    divisors = Divisors(read_rotation("golden"), ONE, ((1,),), 100)
    for bound in (divisors.c, divisors.c_at):
        assert bound(arb(0.25, 0.125)) >= bound(Fraction(1, 8))


def test_norms():
    norm = Norm(LINE, (1, "5/2"))
    assert norm.of((3, -1)) == 2 + Fraction(5, 2) * 4
    ratios = [isqrt(10 ** 12 * (i * i + j * j)) / 10 ** 6 / float(norm.of((i, j)))
              for i in range(-9, 10) for j in range(-9, 10) if i or j]
    assert max(ratios) == pytest.approx(float(norm.kappa)) and norm.kappa >= max(ratios)


@pytest.mark.parametrize("frame,alpha", [(((1, 1), (2, 2)), (1, 1)), (LINE, (1, 0)), (LINE, (1,)),
                                         (((1, 1),), (1,)), (((0,),), (1,))])
def test_what_is_no_norm_is_refused(frame, alpha):
    with pytest.raises(ValueError, match="not"):
        Norm(frame, alpha)


@given(st.lists(st.tuples(st.integers(-20, 20), st.integers(-20, 20)), min_size=1, max_size=5))
def test_a_basis_generates_what_the_waves_do(waves):
    (a, b), (zero, d) = lattice_basis(waves)
    assert zero == 0 and a > 0 and d > 0 and 0 <= b < max(d, 1) or (a, b) == (1, 0)
    for k0, k1 in waves:
        assert k0 % a == 0 and (k1 - k0 // a * b) % d == 0
    minors = gcd(*(p * s - q * r for p, q in waves for r, s in waves))
    assert minors in (0, a * d)         # of rank 2: the index is that of the waves
    assert lattice_basis([(3,), (-6,), (0,)]) == ((3,),)


def test_a_vector_that_is_nearly_resonant_is_refused():
    with pytest.raises(ValueError, match="too near to a resonance: 2 omega_0"):
        Divisors(read_rotation("t^2-2: 1/2 + t/10^20"), ONE, ((1,),), 10 ** 6)


def test_weights_that_machine_integers_cannot_hold_are_refused():
    alpha = 1, 1 + Fraction(1, 10 ** 17)
    with pytest.raises(ValueError, match="too many digits"):
        Divisors(read_rotation("T49"), Norm(LINE, alpha), SQUARE, 300)
    assert Divisors(read_rotation("T49"), Norm(LINE, alpha), SQUARE, 3).records


def test_a_reach_without_sense_is_refused():
    for reach in (0, 10 ** 12):
        with pytest.raises(ValueError, match="reach"):
            Divisors(read_rotation("golden"), ONE, ((1,),), reach)


@pytest.mark.slow
def test_a_vector_near_the_last_torus():
    norm = Norm(LINE, (1, 4))
    told = []
    found = near("0.3139", "0.2947", norm, progress=told.append)
    assert told[0].startswith("choosing") and told[-1] == "comparing rotation vector 6 of 6"
    assert len(set(told)) > 20
    assert abs(np.array(found.floats) - (.3139, .2947)).max() <= 1e-3 and "0.001" in str(found)
    new, old = (Divisors(rotation, norm, SQUARE, 400).c(Fraction(1, 1000))
                for rotation in (found, read_rotation("T49")))
    assert new < old                    # T49 is within the tolerance

