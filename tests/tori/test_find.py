"""Tori that are found, without proof: they are invariant to many digits, whatever the potential."""

import re
import sys
from fractions import Fraction

import numpy as np
import pytest
from files import line

from converse import ConverseError, FourierMap
from converse.check import field
from converse.model.map import MuldoonMap, SymplecticMap
from converse.model.problem import Problem
from converse.tori import continuation, refinement
from converse.tori.continuation import Way
from converse.tori.find import MOST_DEGREE, NotFound, _Pieces, find, series_degree
from converse.tori.newton import Mesh, default_frame, sizes_holding, triangular
from converse.tori.plan import Plan, _divisors, _loss
from converse.tori.refinement import Modes, accepted, layers_for, numbers_of, pruned, taken
from converse.tori.rotation import read_rotation
from converse.tori.torus import Torus, family

GOLDEN = read_rotation("golden")

POTENTIALS = {
    "two waves": (Problem(SymplecticMap([(1, 0), (2, 0, Fraction(1, 6))], ["0.3", "-0.04"])),
                  "golden"),
    "phases": (Problem(SymplecticMap([
        (1, 0), (0, 1, Fraction(1, 8)), (1, -1, Fraction(1, 3))], ["0.05", "0.04", "-0.02"])),
               "spiral")}


@pytest.mark.slow
def test_the_orbit_has_the_rotation_number_asked_for():
    """By the mean of x_{m+1} - x_m with a weight that is flat at both ends (Das, Saiki, Sander and
    Yorke)."""
    torus = find(Problem(MuldoonMap("0.9", 0, 0)), GOLDEN)
    x, J = torus.x([1.0])[0], torus.J([1.0])[0]
    count = 3000
    t = np.arange(1, count) / count
    weight = np.exp(-1 / (t * (1 - t)))
    steps = []
    for _ in t:
        J += 0.9 * np.cos(x)
        x += J
        steps.append(J)
    assert (weight @ steps) / weight.sum() / (2 * np.pi) == pytest.approx(
        (5 ** 0.5 - 1) / 2, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("problem, rotation", [(Problem(MuldoonMap("0.98", 0, 0)), "golden"),
                                               (Problem(MuldoonMap("3", 0, 0)), "golden")])
def test_beyond_the_frontier_nothing_is_found(problem, rotation):
    with pytest.raises(NotFound) as caught:
        find(problem, read_rotation(rotation), points=1 << 15)
    reached = float(caught.value.amplitude[0])
    assert 0.8 < reached < 0.9717 and "no torus of this rotation number" in str(caught.value)
    assert reached == pytest.approx(caught.value.reached * float(problem.amplitude[0]))


@pytest.mark.slow
def test_a_common_factor_of_the_waves_changes_only_the_units():
    """The map of 100 y is the standard map: as many modes, and the same margin about."""
    found = []
    for factor in (1, 10, 100):
        torus = find(FourierMap({factor: Fraction("0.8") / factor ** 2}),
                     "t^2+t-1: t/%d" % factor)
        assert set(torus.k[:, 0] % factor) == {0}
        found.append((len(torus.k), float(torus.strip.rho * factor)))
    assert found == [pytest.approx(found[0], rel=0.02)] * 3


@pytest.mark.slow
def test_a_torus_is_continued_from_another_one():
    first = find(Problem(MuldoonMap("0.6", 0, 0)), GOLDEN)
    direct, continued = (find(Problem(MuldoonMap("0.8", 0, 0)), GOLDEN, start=start)
                         for start in (None, first))
    theta = np.linspace(0, 6, 9)[:, None]
    assert continued.x(theta) == pytest.approx(direct.x(theta), abs=1e-10)
    with pytest.raises(ValueError, match="another rotation"):
        find(Problem(MuldoonMap("0.8", 0, 0)), read_rotation("silver"), start=first)
    with pytest.raises(ValueError, match="waves"):
        find(Problem(SymplecticMap([(2, 0)], ["0.3"])), GOLDEN, start=first)


def test_a_grid_that_is_too_small_is_said():
    assert issubclass(NotFound, ConverseError)
    """Not only where the torus would seem to break up."""
    with pytest.raises(NotFound, match="farther on it needs more than the 256 points that are"):
        find(Problem(MuldoonMap("0.9", 0, 0)), GOLDEN, points=256)


@pytest.mark.slow
def test_the_break_up_is_estimated():
    """On the way of the golden circle of the standard map, which ends at 0.971635."""
    with pytest.raises(NotFound, match="it breaks up near a = .*, by an estimate$") as caught:
        find(Problem(MuldoonMap("0.98", 0, 0)), GOLDEN, points=1 << 14)
    assert float(str(caught.value).split("near a = ")[1].split(",")[0]) == pytest.approx(
        0.971635, abs=2e-3)


@pytest.mark.parametrize("power, noise, end", [(-1.0, 0, 1.1), (-2.0, 1e-3, 1.1), (-1.0, 0.5, None),
                                               (0.0, 1e-3, None), (1.0, 0, None)])
def test_a_break_up_is_told_only_if_the_norms_grow_like_a_power(power, noise, end):
    part = np.array([0.6, 0.75, 0.85, 0.93, 0.97, 1.0])
    norm = (1.1 - part) ** power * (1 + noise * np.array([1, -1, 1, 1, -1, 1]))
    found = continuation.break_up(list(zip(part, norm)))
    assert found == (None if end is None else pytest.approx(end, abs=0.02))
    assert continuation.break_up(list(zip(part, norm))[1:]) is None


@pytest.mark.slow
def test_the_constant_amplitudes_come_first_and_the_named_parameter_is_told():
    """K2 stays as it is while K1 grows: the golden circle is gone at K1 = 0.131."""
    family = SymplecticMap([(1, 0, "-1/2"), (3, 0, "-1/2")], [0, "0.05"], [[1, 0]], ["0.4"], ["K1"])
    with pytest.raises(NotFound, match=r"the last is at K1 = 0\.1\d+, on a grid") as caught:
        find(family, "golden", points=1 << 13)
    assert 0.11 < caught.value.amplitude[0] < 0.1317 and caught.value.amplitude[1] == 0.05
    strong = SymplecticMap([(1, 0), (2, 0)], [0, 2], [[1, 0]], ["0.4"], ["K1"])
    with pytest.raises(NotFound, match="the last is at the share of the constant amplitudes = 0."):
        find(strong, "golden", points=1 << 10)


@pytest.mark.slow
def test_refinement_begins_with_what_is_below_the_noise(monkeypatch):
    """It belongs to the errors of the other coefficients: without it E is much larger, 7e-10."""
    begun = []

    def refined(torus, modes, *_):
        u = modes.mesh.spread(modes.k, torus.doubles[0])
        begun.append(abs(modes.mesh.error(u, np.array([0.965]))).sum())
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["converse.tori.find"], "refined", refined)
    with pytest.raises(KeyboardInterrupt):
        find(Problem(MuldoonMap("0.965", 0, 0)), GOLDEN)
    assert begun[0] < 1e-12


def test_what_does_not_go_together_is_refused():
    with pytest.raises(TypeError, match="a text such as 'golden'"):
        find(Problem(MuldoonMap("0.5", 0, 0)), 0.618)
    with pytest.raises(TypeError, match="the map is a SymplecticMap, such as .*, not 'standard-go"):
        find("standard-golden.in", GOLDEN)
    with pytest.raises(ValueError, match="margin"):
        find(Problem(MuldoonMap("0.5", 0, 0)), GOLDEN, margin=1e300)
    with pytest.raises(ValueError, match="2 components.*1 angle"):
        find(Problem(MuldoonMap("0.5", 0, 0)), read_rotation("T49"))
    with pytest.raises(ValueError, match="V is 0: every torus J = constant is invariant"):
        find(Problem(MuldoonMap(0, 0, 0)), GOLDEN)
    with pytest.raises(ValueError, match="2 parameters"):
        find(Problem(MuldoonMap(("0.1", "0.2"), ("0.1", "0.2"), 0)), read_rotation("T49"))


@pytest.mark.parametrize("waves, frame", [
    ([(1, 0), (0, 1), (1, 1)], ((1, 1), (1, -1))), ([(2, 0), (1, 3)], ((1, 0), (0, 1))),
    ([(2, 1), (1, 3)], ((1, 1), (1, -1))), ([(3, 0), (0, 2), (1, 1)], ((2, 1), (1, -1)))])
def test_a_mesh_tells_its_modes_apart(waves, frame):
    """Coefficients of random modes in its box are found again in its values, summed by hand."""
    potential, _ = family(Problem(SymplecticMap(waves, ["0.1"] * len(waves))))
    mesh = Mesh(potential, read_rotation("T49"), frame, (16, 8))
    inside = mesh.k[:, mesh.inside].T
    assert len({tuple(k) for k in inside}) == len(inside)
    assert (abs(mesh.m[:, mesh.inside]).T < mesh.half).all()
    random = np.random.default_rng(1)
    k = inside[random.choice(len(inside), 9, replace=False)]
    c = random.normal(size=(2, 9)) + 1j * random.normal(size=(2, 9))
    c[:, (k == 0).all(1)] = 0
    twice = [j for j in range(9) if any((k[j] == -k[i]).all() for i in range(j))]
    c[:, twice] = 0
    values = mesh.values(mesh.spread(k.T, c))
    for place in [(0, 0), (3, 1), (15, 7), (8, 4)]:
        # the phases a.p/N of the modes, in terms of the basis
        angle = [2 * np.pi * sum(a * p / size for a, p, size in zip(
            np.linalg.solve(np.array(mesh.basis).T.astype(float), each), place, mesh.sizes))
            for each in k]
        assert values[(slice(None), *place)] == pytest.approx(
            2 * (c * np.exp(1j * np.array(angle))).real.sum(1))
    larger = Mesh(potential, read_rotation("T49"), frame, (32, 16))
    moved = mesh.moved(mesh.spread(k.T, c), larger)
    assert (larger.moved(moved, mesh) == mesh.spread(k.T, c)).all()


def test_the_basis_of_a_group_is_triangular_in_the_frame():
    assert triangular([(1, 0), (0, 1), (1, 1)], ((1, 1), (1, -1)))[1] in ((1, -1), (-1, 1))
    assert triangular([(4,), (6,)], ((1,),)) == [(2,)]
    assert triangular([(2, 2), (3, 3)], ((1, 0), (0, 1))) == [(1, 1)]
    assert default_frame(family(line("0.002"))[0]) == ((1, 1), (1, -1))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two waves", pytest.param("phases", marks=pytest.mark.slow)])
def test_refinement_mends_a_torus(name, monkeypatch):
    """A continuation that ends 1e-6 off, in a few modes, makes no difference."""
    problem, rotation = POTENTIALS[name]
    right = find(problem, read_rotation(rotation))
    follow = Way.follow

    def sloppy(self, start=None):
        found = follow(self, start)
        u = found.u.copy()
        near = abs(found.mesh.k).sum(0) == 2
        u[0, near] *= 1 + 1e-6
        return found._replace(u=u)

    monkeypatch.setattr(Way, "follow", sloppy)
    mended = find(problem, read_rotation(rotation))
    theta = np.random.default_rng(2).uniform(0, 6, (5, right.dimension))
    assert mended.x(theta) == pytest.approx(right.x(theta), abs=1e-10)


@pytest.mark.parametrize("name", ["two waves", "phases"])
def test_a_small_change_of_the_error_is_known_to_all_digits(name):
    """E(u + v) - E(u) for v of 1e-12, of which the difference in doubles has four digits left."""
    problem, rotation = POTENTIALS[name]
    potential, _ = family(problem)
    mesh = Mesh(potential, read_rotation(rotation), default_frame(potential),
                (32, 16)[:potential.dimension])
    amplitude = np.array(potential.amplitude, float)
    random = np.random.default_rng(5)
    inside = mesh.k[:, mesh.inside & (abs(mesh.k).sum(0) > 0)]
    u, v = (mesh.spread(inside[:, :5], size * (random.normal(size=(potential.dimension, 5)) + 1j))
            for size in (0.1, 1e-12))
    # the derivative of E, by a difference of much larger steps of which the errors are odd
    large = v * 1e6
    slope = (mesh.error(u + large, amplitude) - mesh.error(u - large, amplitude)) / 2e6
    found = mesh.change(u, v, amplitude)
    assert abs(found - slope).max() < 1e-9 * abs(found).max()
    assert abs(mesh.change(u, large, amplitude) - (
        mesh.error(u + large, amplitude) - mesh.error(u, amplitude))).max() < 1e-15


def test_what_is_left_out_of_a_torus_is_about_what_it_may_be():
    """Of E's norm: it grows by no more than it is said to, with fewer modes."""
    potential, _ = family(Problem(MuldoonMap("0.8", 0, 0)))
    torus = find(Problem(MuldoonMap("0.8", 0, 0)), GOLDEN, margin=1e8)
    mesh = Mesh(potential, GOLDEN, default_frame(potential), (512,))
    aim = Plan(((1,),), (1,), 200, 0.05, 1e-8, 0.1)

    def norm(torus):
        u = mesh.spread(torus.k.T, torus.doubles[0])
        error = mesh.error(u, np.array([0.8]))
        return 2 * float((abs(error[0]) * np.exp(0.05 * mesh.k[0])).sum())

    shorter, said = pruned(torus, aim, 1e-6)
    assert 1e-7 < said < 1e-6 and len(shorter.k) < len(torus.k)
    assert said / 20 < norm(shorter) - norm(torus) < said


def test_a_torus_that_is_accurate_enough_is_not_corrected(monkeypatch):
    potential, _ = family(Problem(MuldoonMap("0.8", 0, 0)))
    mesh = Mesh(potential, GOLDEN, default_frame(potential), (64,))
    modes = Modes(mesh, mesh.inside & (abs(mesh.k).max(0) > 0))
    torus = Torus(potential, None, GOLDEN, 60, modes.k.T, numbers_of(
        np.zeros((1, *modes.k.shape), complex), 60))
    error = np.full((1, 1, *mesh.k.shape[1:]), 1e-9 + 0j)
    calls, correction = [], Mesh.correction
    monkeypatch.setattr(Mesh, "correction", lambda *given: calls.append(0) or correction(*given))
    for enough, needed in ((1e-6, False), (1e-9, True)):
        refinement._corrected(torus, modes, error, np.ones(mesh.k.shape[1:]), [np.array([0.8])], 1,
                              enough)
        assert bool(calls) == needed


def test_a_grid_is_not_much_larger_than_its_box():
    potential, _ = family(Problem(MuldoonMap("0.9", 0, 0)))
    for reach in (1, 4, 5.9, 6, 6.1, 8, 8.1, 487, 531, 768.5, 16384):
        size, = sizes_holding(potential, ((1,),), (reach,))
        assert size % 2 == 0 and max(2 * reach, 8) <= size < 1.34 * max(2 * reach, 8)
    frame = ((1, 1), (1, -1))           # the second mode number goes in steps of 2
    assert sizes_holding(family(line("0.004"))[0], frame, (531, 266)) == [1280, 320]


@pytest.mark.parametrize("margin, part", [(1, 1), (10, 0.1), (100, 0.04), (1e6, 4e-6)])
def test_what_error_of_a_torus_will_do(margin, part):
    assert accepted(margin) == part


@pytest.mark.slow
def test_a_grid_that_memory_does_not_hold_is_refused(monkeypatch):
    monkeypatch.setattr(continuation, "free_memory", lambda: 10 ** 5)
    with pytest.raises(NotFound, match="takes a grid of 768 points and 0.000998 GB of memory"):
        find(Problem(MuldoonMap("0.9", 0, 0)), GOLDEN)
    with pytest.raises(NotFound, match="takes a grid of .* points and") as caught:
        find(Problem(MuldoonMap(("0.1", "0.5"), 0, 0)), GOLDEN)
    assert caught.value.reached == 1


def test_more_modes_begin_with_the_coefficients_of_fewer():
    potential, _ = family(POTENTIALS["phases"][0])
    frame = default_frame(potential)
    small, large = (Mesh(potential, read_rotation("spiral"), frame, sizes)
                    for sizes in ((16, 8), (32, 16)))
    few, many = (Modes(mesh, mesh.inside & (abs(mesh.k).sum(0) > 0)) for mesh in (small, large))
    random = np.random.default_rng(4)
    c = random.normal(size=(1, *few.k.shape)) + 1j * random.normal(size=few.k.shape)

    def torus(modes, bits, numbers):
        return Torus(potential, None, read_rotation("spiral"), bits, modes.k.T, numbers)

    first = torus(few, 30, numbers_of(c, 30))
    second = torus(many, 40, taken(many, 40, first))
    assert (small.spread(few.k, first.doubles[0]) == large.moved(
        large.spread(many.k, second.doubles[0]), small)).all()
    assert (taken(few, 30, second) == first.numbers).all()


@pytest.mark.slow
@pytest.mark.parametrize("problem, rotation, count", [
    (Problem(MuldoonMap(("0", "0.5"), 0, 0)), "golden", 1),
    (Problem(MuldoonMap(("0.3", "0.8"), 0, 0)), "golden", 2),
    (Problem(SymplecticMap([(1, 0), (0, 1, Fraction(1, 3))], ["0.02", "0.01"],
                           [["0.005", "-0.005"]])),
     "T49", 1)])
def test_pieces_of_a_range(problem, rotation, count):
    """They tile it, and at each s they are the torus of these amplitudes."""
    rotation = read_rotation(rotation)
    pieces = find(problem, rotation)
    assert len(pieces) == count
    ends = [torus.piece for torus in pieces]
    assert [ends[0][0], *(high for _, high in ends)] == [*(low for low, _ in ends), 1]
    potential, part = family(problem)
    assert {(torus.potential, torus.part, torus.rotation) for torus in pieces} == {
        (potential, part, rotation)}
    theta = np.random.default_rng(3).uniform(0, 6, (5, potential.dimension))
    for torus in (pieces[0], pieces[-1]):
        low, high = torus.piece
        for s in (low, (low + 3 * high) / 4, high):
            amplitude = [p + s * q for p, q in zip(potential.amplitude, part)]
            if any(amplitude):
                alone = find(Problem(SymplecticMap(potential.waves, amplitude)), rotation)
                assert torus.x(theta, float(s)) == pytest.approx(alone.x(theta), abs=1e-7)
                assert torus.J(theta, float(s)) == pytest.approx(alone.J(theta), abs=1e-7)
    with pytest.raises(ValueError, match="outside"):
        pieces[0].x(theta, 1.5)


@pytest.mark.parametrize("ends", [
    ("-0.85", "-0.3"), pytest.param(("0.3", "0.85"), marks=pytest.mark.slow)])
def test_pieces_are_as_long_as_their_degree_permits(ends, monkeypatch):
    """On either side of the map without potential: no trial is lost, and no turn in balls."""
    residuals, words, errors = [], [], refinement.errors
    monkeypatch.setattr(refinement, "errors",
                        lambda *given: residuals.append(given) or errors(*given))
    pieces = find(Problem(MuldoonMap(ends, 0, 0)), GOLDEN, progress=words.append)
    assert len(pieces) == len(residuals) == 2
    assert sum(word.startswith("looking for the tori of") for word in words) == 2
    assert max(torus.degree for torus in pieces) in range(12, MOST_DEGREE + 1)


@pytest.mark.slow
def test_a_piece_that_is_too_long_is_cut(monkeypatch):
    """If the end of the tori is thought to be far away."""
    words = []
    monkeypatch.setattr(_Pieces, "_length", lambda self, low, *_: 1 - low)
    pieces = find(Problem(MuldoonMap(("0.3", "0.85"), 0, 0)), GOLDEN, progress=words.append)
    ends = [torus.piece for torus in pieces]
    assert [ends[0][0], *(high for _, high in ends)] == [*(low for low, _ in ends), 1]
    assert len(pieces) < sum(word.startswith("looking for the tori of") for word in words)


@pytest.mark.parametrize("degree, layers", [(0, 2), (4, 8), (12, 16), (13, 16), (14, 32), (20, 32),
                                            (24, 32), (26, 32), (27, 64)])
def test_points_of_sigma_leave_room_for_powers_beyond_the_degree(degree, layers):
    assert layers_for(degree) == layers


def test_rounded_coefficients_leave_what_the_theorem_needs():
    """Those that count most, at the edge of a wide strip, too."""
    potential, _ = family(Problem(MuldoonMap("0.8", 0, 0)))
    like = Mesh(potential, GOLDEN, default_frame(potential), (8,))
    aim = Plan(((1,),), (1,), 300, 0.1, 1e-20, 0.3)
    mesh = aim.mesh(like)
    k = mesh.k[:, aim.keep(mesh)]
    rounding = 2.0 ** -aim.bits(k, 0, 100) * np.exp(aim.rho * aim.length(k)).sum()
    assert rounding < aim.needed / 100 / 200


@pytest.mark.slow
def test_a_range_that_goes_too_far():
    with pytest.raises(NotFound, match="no torus of this rotation number") as caught:
        find(Problem(MuldoonMap(("0.5", "1.2"), 0, 0)), GOLDEN, points=1 << 11)
    last, = caught.value.amplitude
    assert 0.8 < last < 0.9717
    assert caught.value.reached == pytest.approx((last - 0.5) / 0.7)


@pytest.mark.slow
def test_the_line_of_the_thesis_up_to_0_006():
    torus = find(line("0.006"), read_rotation("T49"))
    assert len(torus.k) < 4000 and torus.decay() > 0.1


def test_what_is_going_on_is_told():
    """Of a single torus and of a range: where it is, and how much work."""
    words = []
    find(Problem(MuldoonMap("0.2", 0, 0)), GOLDEN, progress=words.append)
    assert re.fullmatch(r"looking for the torus of an orbit, on \d+ points", words[0])
    assert re.fullmatch(r"refining a torus of \d+ modes", words[-1])
    words.clear()
    find(Problem(MuldoonMap(("0.09", "0.11"), 0, 0)), GOLDEN, progress=words.append)
    assert re.fullmatch(r"looking for the tori of -1 <= s <= 1, on \d+ points", words[-2])
    assert re.fullmatch(r"refining the tori of -1 <= s <= 1, \d+ modes of degree \d+", words[-1])


# Logs of the sizes of the powers of sigma, 0.97 <= k <= 0.9703, from a torus of 107 bits.
SIZES = [-1.2, -7.8, -11.7, -14.8, -17.6, -20.2, -22.8, -25.3, -27.8, -30.2, -32.6, -35.0, -37.4,
         -39.8]


@pytest.mark.parametrize("heights, least, degree", [
    (-4.0 * np.arange(14), 1e-20, 11.5),                    # Few powers are above the noise.
    (-4.0 * np.arange(14), 1e-6, 4),
    (np.where(np.arange(14) % 2, -3.0 * np.arange(14), -np.inf), 1e-16, 12.3),  # odd powers alone
    ([-1.0] + [-np.inf] * 13, 1e-16, 0), (SIZES, np.exp(-39.8), 12)])
def test_the_degree_follows_from_the_powers_above_the_noise(heights, least, degree):
    noise = 1e-10 * np.random.default_rng(5).uniform(0.1, 1, 32)
    sizes = noise + np.concatenate([np.exp(heights), np.zeros(18)])
    assert series_degree(sizes, least) == pytest.approx(degree, abs=0.9)


@pytest.mark.slow
@pytest.mark.parametrize("name, frame, alpha", [
    ("golden", ((1,),), (1,)), ("T49", ((1, 1), (1, -1)), (1, 4)),
    pytest.param("V1", ((1, 1), (1, -1)), (1, 6), marks=pytest.mark.slow)])
def test_the_loss_of_narrow_strips_is_about_what_the_checker_finds(name, frame, alpha):
    """Where the k that count most are beyond those whose divisors are computed, too."""
    rotation = read_rotation(name)
    unit = tuple(map(tuple, np.eye(len(alpha), dtype=int).tolist()))
    exact = field.Divisors(rotation.field, rotation.vector, field.Norm(frame, alpha, unit))
    for delta in 1e-2, 1e-3, 1e-5, 1e-7:
        found = _loss(*_divisors(unit, rotation, frame), alpha, delta)
        assert 0.4 < found / float(exact.loss(Fraction(delta))) < 1.01
