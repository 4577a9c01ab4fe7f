"""What a referee looked for: numbers that underflow, tori that are not what they say, bounds in
the wrong direction."""

import dataclasses
import itertools
import math
from fractions import Fraction as Q

import numpy as np
import pytest
from flint import arb

from converse.model.balls import precision
from converse.model.potential import FourierSum
from converse.tori import constants
from converse.tori.constants import Constants, Inverse, spectral
from converse.tori.divisors import Divisors, Norm
from converse.tori.proved import check_cover, prove
from converse.tori.residual import (MOST, SLACK, Grid, Phases, Sizes, above, amplitudes, between,
                                    residual, rotation_balls)
from converse.tori.rotation import read_rotation
from converse.tori.theorem import Bounds, Choice, Numbers, Theorem, holds
from converse.tori.torus import Torus

GOLDEN = read_rotation("golden")
ONE, PLAIN = Norm(((1,),), (Q(1),)), Norm(((1, 0), (0, 1)), (Q(1), Q(1)))
CIRCLE = ((1, 0, Q(0)),)


def circle(amplitude, modes=None, bits=10):
    return Torus(FourierSum(CIRCLE, (Q(amplitude),), 1), None, GOLDEN, bits, modes or {})


# ---- numbers that are very small, very large, or none

@pytest.mark.parametrize("exponent", [20, 100, 155, 200, 290])
def test_a_small_residual_does_not_become_zero(exponent):
    """E(0) = -p cos(theta) has the norm p e^rho, and u about p cos(theta)/(4 sin^2(pi omega))."""
    p = Q(1, 10 ** exponent)
    piece, = prove(circle(p)).pieces
    exact = float(p) * math.exp(piece.rho)
    assert exact <= piece.residual <= exact * 1.001
    assert piece.distance >= float(p) / 4 / math.sin(math.pi * GOLDEN.floats[0]) ** 2


def test_small_modes_count():
    bits = 700
    torus = circle("0.1", {(1,): ((1, 1),)}, bits)      # |u_1| = sqrt 2 2^-700
    assert Phases(torus, ONE).sizes[1,].norm_at(Q(0)) >= 2 * 1.414 * 2.0 ** -700


@pytest.mark.parametrize("scale", [1, 1e-170, 1e-300, 1e200])
def test_spectral_norms_of_all_sizes(scale):
    chance = np.random.default_rng(3)
    entries = chance.normal(size=(40, 2, 2, 2)) + 1j * chance.normal(size=(40, 2, 2, 2))
    truth = np.linalg.svd(np.moveaxis(entries, 3, 1), compute_uv=False).max(-1)
    found = spectral(entries * scale) / scale
    assert (found >= truth * (1 - 2.0 ** -40)).all() and (found <= truth * (1 + 1e-6)).all()


@pytest.mark.parametrize("x", [
    arb(1) / 3, arb(2) / 3, -arb(1) / 3, arb(0), arb(2) ** -3000, -arb(2) ** -3000, arb(1, 0.25),
    arb(10) ** 300, arb(1) + arb(2) ** -53, -arb(1) - arb(2) ** -53])
def test_a_double_above(x):
    assert arb(above(x)) >= x and above(x) > float(x.mid())


@pytest.mark.parametrize("x", [arb("nan"), arb("inf"), arb(0, "inf"), arb(2) ** 2000,
                               -arb(2) ** 2000])
def test_what_has_no_double_above_is_infinite(x):
    assert above(x) == math.inf


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e308])
def test_sizes_that_are_no_numbers_are_infinite(bad):
    sizes = Sizes(ONE, np.array([[0], [900]]), np.array([1.0, bad]))
    assert sizes.norm_at(Q(1)) == math.inf
    assert bad == 1e308 or sizes.sup() == math.inf


def test_sums_are_rounded_up():
    m = np.arange(300)[:, None]
    sizes = Sizes(ONE, m, np.full(300, 0.1))
    exact = sum((Q(k) * Q(1, 7) for k, in m.tolist()), Q(0))       # e^x > 1 + x
    assert Q(sizes.norm_at(Q(1, 7))) > 30 + exact / 10
    exact = sum((arb(k) / 7).exp() for k, in m.tolist()) * arb(0.1)
    assert arb(sizes.norm_at(Q(1, 7))) > exact > sizes.norm_at(Q(1, 7)) / SLACK ** 6
    assert Q(sizes.sup()) > Q(0.1)


def test_so_many_roundings_are_less_than_the_slack():
    """A relative error of 2^-53 each, whatever its sign."""
    with precision(200):
        one = (1 - arb(2) ** -53) ** (MOST + 20)
        assert one * (1 - arb(2) ** -53) * arb(SLACK) > 1


# ---- tori that are not what they say

@pytest.mark.parametrize("change, words", [
    ({"modes": {(-1,): ((1, 0),)}}, "the mode"), ({"modes": {(1, 0): ((1, 0),)}}, "the mode"),
    ({"modes": {(0,): ((1, 0),)}}, "the mode"), ({"modes": {(1,): ((1, 0, 1),)}}, "integers"),
    ({"modes": {(1,): ()}}, "integers"), ({"modes": {(1,): ((0.5, 0),)}}, "integers"),
    ({"modes": {(1,): ((1 << 2000, 0),)}}, "too large"),
    ({"modes": {(1 << 70,): ((1, 0),)}}, "too large"),
    ({"potential": FourierSum(((1, 1, Q(0)),), (Q(1, 10),), 1)}, "not one of 1 angles"),
    ({"potential": FourierSum(CIRCLE * 2, (Q(1, 10),), 1)}, "one amplitude"),
    ({"part": (), "piece": (Q(-1), Q(1))}, "one part"),
    ({"modes": {(1.5,): ((1, 0),)}}, "waves and modes integers"),
    ({"potential": FourierSum(((1.0, 0, Q(0)),), (Q(1, 10),), 1)}, "waves and modes integers"),
    ({"potential": FourierSum(((1, 0, 0.3),), (Q(1, 10),), 1)}, "phases .* are Fractions"),
    ({"potential": FourierSum(CIRCLE, (0.1,), 1)}, "amplitudes.* are Fractions"),
    ({"part": (0.01,), "piece": (Q(-1), Q(1))}, "parts.* are Fractions"),
])
def test_what_is_no_torus_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        check_cover([dataclasses.replace(circle("0.1"), **change)])


@pytest.mark.parametrize("end", [0.1, 0.3, 0.55])
def test_pieces_that_would_be_rounded_are_refused(end):
    """The amplitudes of the piece (-1, end) would end below those with which (end, 1) begins."""
    low, high = (dataclasses.replace(circle("0.1"), part=(Q(1, 100),), piece=piece)
                 for piece in ((-1.0, end), (end, 1.0)))
    ((c, d),), ((a, b),) = amplitudes(low), amplitudes(high)
    assert Q(c) + Q(d) < Q(a) - Q(b)
    with pytest.raises(ValueError, match="pieces are Fractions"):
        check_cover([low, high])


def test_weights_that_leave_no_room_in_64_bits_are_refused():
    """Modes far out would count as near: 511 times 2^55 + 1 is more than 2^63."""
    grid = Grid(Norm(((1,),), (1 + Q(1, 2 ** 55),)), ((1,),), (1, 1024))
    with pytest.raises(ValueError, match="take rounder ones"):
        grid.within(grid.inside[1], grid.reach / 2)


@pytest.mark.parametrize("layers", [2, 256, 1024])
def test_many_points_of_sigma(layers):
    torus = dataclasses.replace(circle("0.001"), part=(Q(1, 10 ** 4),), piece=(Q(-1), Q(1)))
    piece, = prove(torus, layers=layers).pieces
    exact = 0.0011 * math.exp(piece.rho)
    assert exact <= piece.residual < 2 * exact


def test_choices_without_sense_are_refused():
    for wrong in ({"rho": Q(0)}, {"rho": Q(20)}, {"norm": PLAIN}, {"shape": (1, 48)},
                  {"layers": 3}):
        with pytest.raises(ValueError):
            prove(circle("0.1"), **wrong)
    with pytest.raises(ValueError, match="powers of two"):
        Grid(PLAIN, ((1, 0), (0, 1)), (3, 16))


# ---- the theorem's numbers, term by term

PLANE = FourierSum(((1, 0, Q(0)), (1, -2, Q(1, 3))), (Q("-0.1"), Q("0.05")), 2)
MODES = {(0, 2): ((9, -5, 3, 8), (2, 1, -3, 1)), (1, 0): ((90, 11, -25, 3), (7, 0, 1, -5)),
         (1, 2): ((3, 3, -4, 1), (0, 0, 0, 1)), (3, 2): ((1, 0, 0, 1), (0, 0, 0, 0))}
SKEW = Norm(((1, 1), (1, -1)), (Q(1, 2), Q(1)))


def plane(part=True):
    """A torus far from invariant; of a range, s from -1 to 1/3."""
    if not part:
        return Torus(PLANE, None, read_rotation("T49"), 12,
                     {k: series[:1] for k, series in MODES.items()})
    return Torus(PLANE, (Q("0.02"), Q("-0.01")), read_rotation("T49"), 12, MODES,
                 (Q(-1), Q(1, 3)))


def test_what_balls_are_off_by_counts():
    """With few bits each bound is no less than with many."""
    for torus, layers in (plane(), 8), (plane(False), 1):
        grid = Grid(SKEW, ((1, 0), (1, -2)), (16, 16), layers)
        coarse, fine = (residual(torus, grid, bits).sizes.size for bits in (14, 150))
        assert (coarse >= fine * (1 - 1e-6)).all() and (coarse.sum() > 1.01 * fine.sum())


@pytest.mark.parametrize("name", ["rest", "product"])
def test_what_balls_of_the_constants_are_off_by_counts(name, monkeypatch):
    sizes = []
    for bits in 14, 150:
        monkeypatch.setattr(constants, "BITS", bits)
        sizes.append(getattr(Inverse(plane(), SKEW, (16, 16), 8), name).size)
    assert (sizes[0] >= sizes[1] * (1 - 1e-6)).all()


def by_hand(torus, rho, radius):
    """(31), and ||k.u|| of each wave."""
    (low, high), total, exponents = torus.piece, 0.0, []
    part = torus.part or (Q(0),) * len(PLANE.waves)
    for (k0, k1, _), p, d in zip(PLANE.waves, PLANE.amplitude, part):
        size = sum(2 * abs(complex(k0 * c[0] + k1 * c[2], k0 * c[1] + k1 * c[3])) / 2 ** 12
                   * radius ** j * math.exp(rho * float(SKEW.of(k)))
                   for k, series in torus.modes.items() for j, c in enumerate(series))
        exponents.append(math.exp(rho * float(SKEW.of((k0, k1))) + size))
        total += float(abs(p + (low + high) / 2 * d) + radius * abs((high - low) / 2 * d)) \
            * math.hypot(k0, k1) * exponents[-1]
    return total, exponents


@pytest.mark.parametrize("part", [True, False])
def test_the_tail_is_that_of_the_page(part):
    torus = plane(part)
    phases = Phases(torus, SKEW)
    grid = Grid(SKEW, ((1, 0), (1, -2)), (16, 16), 4 if part else 1)
    rho, wider, radius = Q(1, 10), Q(2, 5), Q(3, 2)
    (wide, _), (force, exponents) = by_hand(torus, 0.4, 1), by_hand(torus, 0.1, 1.5)
    for k, truth in zip(phases.wave_vectors, exponents):
        assert float(phases.exponential(k, rho, radius)) == pytest.approx(truth)
    assert phases.force(rho, radius) == pytest.approx(force)
    truth = 2 * wide * math.exp(-0.3 * float(grid.reach)) + 2 * force * 1.5 ** -4 * part
    assert phases.tail(grid, rho, wider, radius) == pytest.approx(truth)
    assert phases.tail(grid, rho, rho, radius) == math.inf
    found = residual(torus, grid, 64)
    assert found.norm_at(rho, 1.0) == pytest.approx(1 + found.sizes.norm_at(rho))


def test_the_tail_in_s_is_there_if_only_the_amplitudes_vary():
    torus = dataclasses.replace(plane(), modes=plane(False).modes)
    grid = Grid(SKEW, ((1, 0), (1, -2)), (64, 64), 2)
    assert Phases(torus, SKEW).best_tail(grid, Q(1, 10))[0] > 1e-3


def page(n, c, forces, small, delta, kappa, e0, s, t):
    """(12) to (18)."""
    l0, m0, a0, b0, p0 = c
    sigma = (2 * l0 + t) * t
    l, m, a = l0 + t, m0 / (1 - m0 * t), a0 / (1 - a0 * sigma)
    da = a * a0 * sigma
    b, p = b0 / (1 - b0 * da), p0 + da
    h, T = 1 + b * p, sum(x * math.exp(k * t) for x, k in forces)
    e, slope, distance, N = e0, 0.0, 0.0, len(small) - 1
    for i, C in enumerate(small):
        def d(x):
            return kappa / (math.e * x)
        di = delta / 2 ** i
        G = a * h * C ** 2 * l * (2 * m * l * d(di) * (n > 1) + d(2 * di)
                                  + T * a * h * C ** 2 * l ** 3 / 2)
        v, q = a * h * C ** 2 * l ** 2 * e, 2 ** (4 * n) * G * e
        slope += d(s * di) * v / (1 - 2 ** (1 - 2 * n) if i == N else 1)
        distance += v / (1 - 2 ** (-2 * n) if i == N else 1)
        e = G * e * e
    return q, slope, distance


NUMBERS = {"l0": 1.3, "m0": 1.7, "a0": 1.9, "b0": 1.1, "p0": 0.4}


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("small", [[7.0], [7.0, 19.0, 45.0]])
@pytest.mark.parametrize("t", [0.01, 0.04])
def test_the_inequality_is_that_of_the_page(n, small, t):
    forces, c = [(0.3, 1.0), (0.2, 3.0)], list(NUMBERS.values())
    numbers = Numbers(n, *c, forces, small, 0.02, 1.4, math.e, math.exp)
    assert numbers.bounds(1e-9, 0.3, t) == pytest.approx(
        page(n, c, forces, small, 0.02, 1.4, 1e-9, 0.3, t))


@pytest.mark.parametrize("change", [{"m0": 20.1, "a0": 0.1}, {"m0": 1e-3, "a0": 8.0, "b0": 1e-9},
                                    {"b0": 5.0}])
def test_what_must_be_below_1(change):
    def bounds(numbers):
        return Numbers(2, *numbers.values(), [(0.3, 1.0)], [1.0], 0.02, 1.4, math.e,
                       math.exp).bounds(1e-30, 0.3, 0.05)
    assert bounds(NUMBERS) and bounds({**NUMBERS, **change}) is None


@pytest.mark.parametrize("which", range(3))
def test_each_of_the_three_is_asked_for(which):
    good = [arb(0.4)] * 3
    assert holds(Bounds(*good), arb(0.5)) and not holds(None, arb(0.5))
    for wrong in arb(1.1), arb("nan"), arb("inf"), arb(0.5, 1), arb(0, "inf"):
        assert not holds(Bounds(*good[:which], wrong, *good[which + 1:]), arb(0.5))


def test_the_numbers_are_those_of_the_torus():
    torus = plane()
    theorem = Theorem(Phases(torus, SKEW), Divisors(torus.rotation, SKEW, ((1, 0), (0, 2)), 60))
    rho, choice = Q(1, 10), Choice(Q(1, 4), Q(1, 100), 2)
    numbers, s, t = theorem._balls(Constants(rho, *NUMBERS.values(), 0.001), choice)
    delta = rho * Q(99, 100) / (4 + 2 * Q(1, 4))
    assert numbers.n == 2 and [float(x) for x in (numbers.delta, s, t)] == pytest.approx(
        [float(delta), 0.25, 0.01])
    _, exponents = by_hand(torus, 0.1, 1)
    for k, (size, length), p, g in zip(((1, 0), (1, -2)), numbers.forces, (
            0.1 + 0.02 / 3 + 0.04 / 3, 0.05 + 0.01 / 3 + 0.02 / 3), exponents):
        assert float(length) == pytest.approx(math.hypot(*k))
        assert float(size) == pytest.approx(p * math.hypot(*k) ** 3 * g)
    assert [float(x) for x in numbers.small] == [float(f(d)) for f, d in (
        (theorem.divisors.c_at, delta), (theorem.divisors.c_at, delta / 2),
        (theorem.divisors.c, delta / 4))]
    assert float(numbers.kappa) == pytest.approx(2 ** 0.5)      # at (1, 1), of |k| = 1


def test_the_rotation_vector_is_enclosed():
    with precision(400):
        for found, (low, high) in zip(rotation_balls(plane(), 64), plane().rotation.turns(100)):
            assert found.contains(between(low, high))


def test_powers_of_s_that_are_cut_off_are_counted():
    inverse = Inverse(plane(), SKEW, (16, 16), 2)       # of degree 0
    sizes = inverse.cut_off.size[:, 1]
    truth = [2 * math.hypot(*k) * math.hypot(*series[1]) / 2 ** 12 for k, series in MODES.items()]
    assert (sizes >= truth).all() and sizes == pytest.approx(truth)


class Stub:
    """Sizes of a given norm."""

    def __init__(self, norm):
        self.norm = norm

    def norm_at(self, rho):
        return self.norm

    def sup(self):
        return self.norm


def constants_of(m=2.0, rest=0.1, cut_off=0.02, z=1.5, eta_z=0.01):
    inverse = object.__new__(Inverse)
    inverse.m, inverse.rest, inverse.cut_off = Stub(m), Stub(rest), Stub(cut_off)
    inverse.slopes, inverse.product, inverse.others = Stub(0.3), Stub(5.0), Stub(0.7)
    inverse.inverse_mean, inverse.mean_off = (z, eta_z), 0.03
    return inverse.at(Q(1, 10))


def test_the_constants_are_those_of_the_page():
    """(34) to (37) and (40)."""
    found = constants_of(z=0.6)
    eta = 0.1 + 0.02 * 2
    m0 = 2 / (1 - eta)
    err = 2 * eta / (1 - eta) * (m0 + 2)
    assert (found.l0, found.m0, found.a0, found.b0, found.p0, found.eta) == pytest.approx(
        (1.3, m0, 5 + err, 0.6 / (1 - 0.01 - (err + 0.03) * 0.6), 0.7 + err, eta))


@pytest.mark.parametrize("change", [
    {"rest": 1.0}, {"rest": math.nan}, {"m": math.nan}, {"m": math.inf}, {"cut_off": 0.5},
    {"z": 0.8}, {"eta_z": 1.0}, {"eta_z": math.nan}, {"z": math.inf}])
def test_no_constants_without_an_inverse(change):
    assert constants_of(**{"z": 0.6, **change}) is None


def test_a_torus_is_not_proved_for_another_vector():
    with pytest.raises(ValueError, match="another rotation vector"):
        prove(circle("0.1"), read_rotation("silver"))


def test_the_first_divisors_are_those_that_there_are():
    torus = plane()
    theorem = Theorem(Phases(torus, SKEW), Divisors(torus.rotation, SKEW, ((1, 0), (0, 2)), 60))
    at, worst = theorem.divisors.c_at, theorem.divisors.c
    assert theorem._small(Q(3), 2) == [at(Q(3)), at(Q(3, 2)), worst(Q(3, 4))]
    assert worst(Q(3, 4)) > at(Q(3, 4))


@pytest.mark.parametrize("name, frame, alpha", [
    ("V1", ((1, 0), (0, 1)), (1, Q(1, 4))), ("seven", ((1, 1), (1, -1)), (1, Q(1, 2)))])
def test_the_orientation_of_the_frame_is_the_same(name, frame, alpha):
    """The edges of the parallelogram, one with a larger product than the other, change places."""
    turned = frame[0], tuple(-x for x in frame[1])
    one, other = (Divisors(read_rotation(name), Norm(each, alpha), ((1, 0), (0, 1)), 30)
                  for each in (frame, turned))
    assert one.gamma_tail == other.gamma_tail and one.records == other.records


def test_kappa_is_rounded_up():
    assert Norm(((1, 1), (1, -1)), (Q(1), Q(1))).kappa ** 2 >= Q(1, 2)
    assert Norm(((1, 2), (0, 3)), (Q(2), Q(1))).kappa ** 2 >= Q(5, 9)


@pytest.mark.parametrize("elements", [
    "(4-t-t^2)/(t+3), (4-t-t^2)/(t^2+1)", "1/(t+3), 1/((t^2+1)(4-t-t^2))"])
def test_mixed_coefficients_of_the_norm_have_denominators_too(elements):
    """13 splits in this field, t + 3 has the norm -13, and t^2 + 1, 4 - t - t^2 are conjugates."""
    rotation = read_rotation("t^3+t^2-2t-1: " + elements)
    divisors, field = Divisors(rotation, PLAIN, ((1, 0), (0, 1)), 10), rotation.field
    a, b = rotation.vector
    for p, m0, m1 in itertools.product(range(3), range(-2, 3), range(-2, 3)):
        norm = field.norm(tuple(p * (j == 0) + m0 * x + m1 * y
                                for j, (x, y) in enumerate(zip(a, b))))
        assert (divisors._denominator() * norm).denominator == 1


@pytest.mark.parametrize("name", ["seven", "spiral"])
def test_gamma_is_that_of_the_page(name):
    """(27) and (28), with real and with complex conjugates, by sums along the edges."""
    rotation, reach = read_rotation(name), 3.0
    roots = sorted(np.roots(rotation.polynomial[::-1]), key=lambda z: (abs(z.imag), -z.real))
    w = np.array([[sum(float(c) * t ** j for j, c in enumerate(element))
                   for element in rotation.vector] for t in roots])
    x = np.linspace(0, 1, 20001)
    ends = np.concatenate([np.stack([x, 1 - x], 1), np.stack([x, x - 1], 1)])
    others = abs(ends @ (w[1:] - w[0]).T)
    largest, spread = others.prod(1).max(), others.sum(1).max()
    gamma = 1 / (largest + spread / largest / reach ** 3 + largest ** -2 / reach ** 6)
    divisors = Divisors(rotation, PLAIN, ((1, 0), (0, 1)), 3)
    assert float(divisors.gamma_tail) == pytest.approx(
        2 * math.pi * gamma * (1 - (math.pi * gamma / 9) ** 2 / 6), rel=1e-6)


def test_large_coefficients_are_enclosed_as_narrowly():
    low, high = GOLDEN.field.bounds((Q(0), Q(10 ** 60)), 25)
    assert 0 < (high - low) * 10 ** 25 <= 1
