"""Proofs of tori: what must be proved, and what must not."""

import dataclasses
import math
import sys
from fractions import Fraction as Q

import numpy as np
import pytest
from flint import arb

from converse.model.problem import Problem
from converse.storage.files import ConverseError
from converse.tori import proved
from converse.tori.constants import Constants
from converse.tori.divisors import Divisors, Norm, lattice_basis
from converse.tori.find import find
from converse.tori.proved import NotProved, best_shape, check_cover, prove
from converse.tori.residual import Grid, Phases, wave_vectors
from converse.tori.rotation import Rotation, read_rotation
from converse.tori.theorem import Theorem, holds

GOLDEN, T49 = read_rotation("golden", 1), read_rotation("T49", 2)


def standard(k):
    return Problem.patch([k], (), [(1, 0)])


def line(eps):
    c = Q("11.21436") * Q(eps)
    return Problem.patch([c, c, 2 * c])


@pytest.fixture(scope="module")
def circle():
    return find(standard("0.8"), GOLDEN)


@pytest.fixture(scope="module")
def surface():
    return find(line("0.002"), T49)


@pytest.mark.parametrize("problem, rotation", [
    (standard("0.5"), GOLDEN), (standard("-0.8"), GOLDEN), (line("0.002"), T49),
    (Problem.patch(["0.3", "0.04"], (), [(1, 0), (2, 0, Q(1, 3))]), GOLDEN),
    (Problem.patch(["0.1"], (), [(2, 0, Q(-1, 5))]), read_rotation("silver", 1)),
    (Problem.patch(["0.03", "0.02", "-0.01"], (), [(1, 0), (0, 1, Q(1, 8)), (1, -1, Q(-1, 10))]),
     read_rotation("spiral", 2)),
    pytest.param(line("0.004"), T49, marks=pytest.mark.slow)])
def test_tori_are_proved(problem, rotation):
    proof = prove(problem, rotation)
    piece, = proof.pieces
    assert proof.residual <= proof.needed and piece.margin > 10
    assert 0 < piece.distance < 1e-6 and piece.distance <= piece.slope
    assert piece.constants.eta < 0.02
    widths = {rho: (residual, needed) for rho, residual, needed in piece.tried}
    assert widths[piece.rho][0] == piece.residual and len(widths) > 5
    assert widths[piece.rho][1] == pytest.approx(piece.needed, rel=0.3)
    assert max(widths, key=lambda rho: widths[rho][1] / widths[rho][0]) == piece.rho
    assert piece.bounds.q <= 1
    shown = proof._repr_html_()
    assert shown.startswith("<pre>I find") and "It is a real analytic graph" in shown


def changed(torus, modes=None, **others):
    return dataclasses.replace(torus, **({} if modes is None else {"modes": modes}), **others)


def scaled(torus, factor):
    return changed(torus, {k: tuple(tuple(int(x * factor) for x in c) for c in series)
                           for k, series in torus.modes.items()})


def moved(torus, k, amount):
    """With another coefficient at k."""
    (first, *rest), = torus.modes[k]
    step = int(amount * 2 ** torus.bits)
    return changed(torus, {**torus.modes, k: ((first + step, *rest),)})


def potential(torus, factor):
    p = torus.potential
    return changed(torus, potential=p._replace(
        amplitude=tuple(factor * each for each in p.amplitude)))


def turned(torus):
    r = torus.rotation
    (first, *rest), *others = r.vector
    return changed(torus, rotation=Rotation("", r.polynomial, r.root, (
        (first + Q(1, 10 ** 6), *rest), *others)))


DAMAGES = {
    "a coefficient": lambda t: moved(t, min(t.modes), 1e-6),
    "a high coefficient": lambda t: moved(t, max(t.modes), 1e-6),
    "smaller": lambda t: scaled(t, Q(9999, 10000)),
    "nothing": lambda t: changed(t, {}),
    "other potential": lambda t: potential(t, Q(100001, 100000)),
    "other sign": lambda t: scaled(t, -1),
    "other rotation": turned,
    "24 bits": lambda t: changed(t, {
        k: tuple(tuple(x >> (t.bits - 24) for x in c) for c in series)
        for k, series in t.modes.items()}, bits=24),
}


@pytest.mark.parametrize("damage, which", [(d, "circle") for d in DAMAGES] + [
    ("a coefficient", "surface"),
    *(pytest.param(d, "surface", marks=pytest.mark.slow) for d in (
        "other potential", "nothing", "a high coefficient", "smaller", "other sign",
        "other rotation", "24 bits"))])
def test_damaged_tori_are_not_proved(damage, which, request):
    torus = request.getfixturevalue(which)
    with pytest.raises(NotProved) as error:
        prove(DAMAGES[damage](torus))
    assert "\n" not in str(error.value) and error.value.residual > error.value.needed


def test_what_is_no_torus_is_refused(circle, surface):
    with pytest.raises(ValueError, match="lattice"):    # all waves have even k
        prove(changed(circle, potential=circle.potential._replace(waves=((2, 0, Q(0)),))))
    for k in (0,), (-1,):
        with pytest.raises(ValueError, match="has the mode"):
            prove(changed(circle, {**circle.modes, k: ((1, 0),)}))
    with pytest.raises(ValueError, match="different"):
        check_cover([circle, surface])
    with pytest.raises(ValueError, match="tile"):
        prove([circle, circle])
    with pytest.raises(ValueError, match="no torus"):
        prove([])


def test_choices_of_ones_own(circle):
    at = Q(3, 100)
    piece, = prove(circle, rho=at, shape=(1, 1024), bits=100).pieces
    assert (piece.rho, piece.grid.shape, piece.bits) == (at, (1, 1024), 100)
    with pytest.raises(NotProved):
        prove(circle, rho=Q(1))                         # wider than the torus is analytic
    with pytest.raises(ValueError, match="too small"):
        prove(circle, shape=(1, 64))
    with pytest.raises(NotProved):
        prove(circle, rho=at, bits=24)
    with pytest.raises(NotProved, match="memory"):
        prove(circle, memory=1000)
    with pytest.raises(NotProved, match="memory"):
        prove(circle, shape=(1, 1 << 29), memory=10 ** 9)
    with pytest.raises(TypeError, match="not an exact number"):
        prove(circle, rho=0.03)
    for bits in 0, 4001:
        with pytest.raises(ValueError, match="balls have from 2 to 4000 bits"):
            prove(circle, bits=bits)


def test_a_coarser_choice_is_no_better(circle):
    """Whatever is chosen, the same true torus is near."""
    best, = prove(circle).pieces
    assert best.distance < 1e-7
    assert prove(circle, rho=Q(1, 20)).pieces[0].distance < 1e-6


@pytest.fixture(scope="module")
def theorem(circle):
    norm = Norm(((1,),), (Q(1),))
    return Theorem(Phases(circle, norm), Divisors(
        GOLDEN, norm, lattice_basis(wave_vectors(circle))))


CONSTANTS = Constants(Q(3, 50), 1.9, 1.8, 2.1, 0.96, 0.09, 0.001)


def test_needed_is_the_limit(theorem):
    needed = theorem.verdict(CONSTANTS, 1.0).needed
    assert theorem.verdict(CONSTANTS, 1.0).bounds is None
    assert theorem.verdict(CONSTANTS, 0.98 * needed).bounds is not None
    assert theorem.verdict(CONSTANTS, 1.1 * needed).bounds is None


@pytest.mark.parametrize("name", ["l0", "a0", "b0", "p0"])       # m0 matters if n = 2
def test_larger_constants_need_a_smaller_residual(theorem, name):
    worse = dataclasses.replace(CONSTANTS, **{name: getattr(CONSTANTS, name) * 2})
    assert theorem.verdict(worse, 1.0).needed < theorem.verdict(CONSTANTS, 1.0).needed


@pytest.mark.parametrize("name", ["l0", "m0", "a0", "b0", "p0"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_no_number_proves_nothing(theorem, name, value):
    worse = dataclasses.replace(CONSTANTS, **{name: value})
    choice = theorem.verdict(CONSTANTS, 1.0).choice
    numbers, s, t = theorem._balls(worse, choice)
    assert not holds(numbers.bounds(arb(1e-30), s, t), t)


@pytest.mark.parametrize("e0", [math.nan, math.inf])
def test_no_residual_proves_nothing(theorem, e0):
    assert theorem.verdict(CONSTANTS, e0).bounds is None


def test_inequality_is_that_of_the_page(theorem):
    """(12) to (18) by hand, in doubles, with N = 4 and n = 1."""
    verdict = theorem.verdict(CONSTANTS, 1e-12)
    choice, c = verdict.choice, CONSTANTS
    s, t, rho = float(choice.s), float(choice.t), float(c.rho)
    delta = [rho * 0.99 / (4 + 2 * s) / 2 ** i for i in range(5)]
    divisors = theorem.divisors
    small = [float(divisors.c_at(Q(x))) for x in delta[:4]] + [float(divisors.c(Q(delta[4])))]
    l, m, sigma = c.l0 + t, c.m0 / (1 - c.m0 * t), (2 * c.l0 + t) * t
    a = c.a0 / (1 - c.a0 * sigma)
    da = a * c.a0 * sigma
    h = 1 + c.b0 / (1 - c.b0 * da) * (c.p0 + da)
    big = 0.8 * float(theorem.phases.exponential((1,), c.rho)) * math.exp(t)
    e, slope, distance = 1e-12, 0.0, 0.0
    for i in range(5):
        d = 1 / (math.e * delta[i])
        growth = a * h * small[i] ** 2 * l * (d / 2 + big * a * h * small[i] ** 2 * l ** 3 / 2)
        v = a * h * small[i] ** 2 * l ** 2 * e
        last = i == 4
        slope += d / s * v / (1 - 2 ** -1 if last else 1)
        distance += v / (1 - 2 ** -2 if last else 1)
        q = 2 ** 4 * growth * e
        e = growth * e * e
    assert m > 0
    for found, truth in zip(verdict.bounds, (q, slope, distance)):
        assert truth <= found * (1 + 1e-9) and found <= truth * (1 + 1e-6)


def test_best_shape_reaches_furthest():
    norm = Norm(((1, 1), (1, -1)), (Q(1), Q(3)))
    assert Grid(norm, ((1, 0), (0, 1)), best_shape(norm, ((1, 0), (0, 1)), 64)).reach == 8
    assert best_shape(Norm(((1,),), (Q(1),)), ((3,),), 64) == (1, 64)


# ---- ranges

RANGE = Problem.patch(["0.3"], [["0.2"]], [(1, 0)])


@pytest.fixture(scope="module")
def pieces():
    return find(RANGE, GOLDEN)


def test_a_range_is_proved(pieces):
    proof = prove(pieces)
    assert [piece.torus for piece in proof.pieces] == pieces
    assert proof.residual < proof.needed and 0 < proof.distance < 1e-4
    for p in "0.1", "0.25", "0.5":          # and its tori are those of single values
        s = (Q(p) - Q("0.3")) / Q("0.2")
        piece, = (x for x in proof.pieces if x.torus.piece[0] <= s <= x.torus.piece[1])
        single, = prove(standard(p), GOLDEN).pieces
        theta = np.linspace(0, 6, 7)[:, None]
        gap = abs(piece.torus.x(theta, float(s)) - single.torus.x(theta)).max()
        assert gap < 2 * (piece.distance + single.distance)


def test_the_inverse_takes_few_powers_of_the_parameter(pieces, monkeypatch):
    """And with more of them the constants are the same, to what they are needed."""
    few, = prove(pieces).pieces
    assert few.inverse_grid.layers <= few.grid.layers
    monkeypatch.setattr(proved._Attempt, "_inverse_layers", lambda self: 64)
    many, = prove(pieces).pieces
    assert many.inverse_grid.layers == 64 and few.constants.near(
        dataclasses.replace(many.constants, rho=few.rho))


def test_an_inverse_with_too_few_powers_is_mended(pieces, monkeypatch):
    monkeypatch.setattr(proved._Attempt, "_inverse_layers", lambda self: 2)
    piece, = prove(pieces).pieces
    assert piece.residual < piece.needed


RANGE_DAMAGES = {
    "wider": lambda t: changed(t, part=tuple(p * Q(1001, 1000) for p in t.part)),
    "shifted": lambda t: potential(t, Q(101, 100)),
    "constant": lambda t: changed(t, {k: series[:1] for k, series in t.modes.items()}),
    "a power": lambda t: changed(t, {
        k: (series[0], tuple(x + (1 << t.bits) // 1000 for x in series[1]), *series[2:])
        for k, series in t.modes.items()}),
}


@pytest.mark.parametrize("damage", RANGE_DAMAGES)
def test_damaged_ranges_are_not_proved(damage, pieces):
    with pytest.raises(NotProved):
        prove([RANGE_DAMAGES[damage](torus) for torus in pieces])


def test_pieces_must_tile_the_range(pieces):
    torus, = pieces
    first, second = (changed(torus, piece=ends) for ends in ((Q(-1), Q(0)), (Q(1, 2), Q(1))))
    for wrong in [first], [second, first], [first, second], [torus, torus], [
            changed(torus, piece=(Q(0), Q(0)))]:
        with pytest.raises(ValueError, match="tile"):
            check_cover(wrong)


@pytest.mark.parametrize("problem, rotation", [
    pytest.param(Problem.patch(["0.01", "0.01", "0.02"], [["0.002", "0.002", "0.004"]]), T49,
                 marks=pytest.mark.slow)])
def test_ranges_of_two_angles_are_proved(problem, rotation):
    proof = prove(problem, rotation)
    assert proof.residual < proof.needed and proof.distance < 1e-4


@pytest.mark.parametrize("residual,needed,more,margins", [
    (1e-9, 1e-12, {}, [None, 1e7]), (1e-9, 0.0, {}, [None]), (float("inf"), 1e-9, {}, [None]),
    (1e-3, 1e-12, {}, [None]), (1e-9, 1e-12, {"margin": 50}, [50]),
    (1e-9, 1e-12, {"bits": 60}, [None])])
def test_a_torus_that_is_not_accurate_enough_is_found_again(monkeypatch, residual, needed, more,
                                                            margins):
    """Once, with a larger margin, unless what is missing is infinite, or the caller chose."""
    asked = []

    class Attempt:
        def __init__(self, *_):
            pass

        def run(self):
            raise NotProved("it lacks", residual, needed)
    torus = find(standard("0.5"), GOLDEN)
    monkeypatch.setattr(sys.modules["converse.tori.find"], "find",
                        lambda *_, margin=None, **__: asked.append(margin) or [torus])
    monkeypatch.setattr(proved, "check_cover", lambda tori: None)
    monkeypatch.setattr(proved, "_Attempt", Attempt)
    with pytest.raises(NotProved, match="it lacks"):
        prove(standard("0.5"), GOLDEN, **more)
    assert asked == [margin and pytest.approx(margin) for margin in margins]


def test_waves_of_one_direction_in_two_angles():
    """Their torus is found with too little accuracy first."""
    proof = prove(Problem.patch([0, 0, "0.09"]), T49)
    assert proof.residual < proof.needed


def test_what_looks_for_a_torus_needs_a_problem(circle):
    with pytest.raises(ValueError, match="for a Problem"):
        prove(circle, margin=10.0)


def test_no_theorem_is_claimed_that_was_not_asked_for(circle, monkeypatch):
    """A proof for the middle of a range is none for the range, nor one for another map."""
    monkeypatch.setattr(sys.modules["converse.tori.find"], "find", lambda *_, **__: circle)
    for problem in (Problem.patch(["0.8"], [["0.01"]], [(1, 0)]), standard("0.81")):
        with pytest.raises(ConverseError, match="not of the problem"):
            prove(problem, GOLDEN)
    assert prove(standard("0.8"), GOLDEN).torus is circle
