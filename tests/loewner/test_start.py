"""Where orbits start, method Loewner: the choice of x*, and that no proof depends on luck with
it."""

import math
from decimal import Decimal
from fractions import Fraction

import pytest

from converse.model.map import THESIS, MuldoonMap, SymplecticMap
from converse.model.problem import Problem
from converse.prover import native
from converse.prover.settings import Settings


def decide(parameters, xstar=None, most=20000):
    """The first prism of a problem, or of three ranges, and what it is cut into, as far as `most`
    tries: x*, tries, all proved?"""
    problem = parameters if isinstance(parameters, Problem) else \
        Problem(MuldoonMap(*parameters))
    search = native.Search(native.Task(problem, Settings(method="loewner"), xstar))
    assert search.work(0, bool)
    search.work(1, lambda: search.view().counts.tries >= most)
    counts, finished = search.view().counts, search.view().finished
    return tuple(map(float, search.xstar)), counts.tries, finished and not counts.undecided


def largest(*ranges):
    """B of three ranges."""
    search = native.Search(native.Task(Problem(MuldoonMap(*ranges)), Settings(method="loewner")))
    assert search.work(0, bool)
    return float(search.constants["B"])


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_parameters_without_width_share_the_bounds_of_the_others(axis):
    """B of a range of one parameter is the larger B of its ends."""
    point = ["0.3", "0.2", "0.5"]
    at = [largest(*point[:axis], end, *point[axis + 1:]) for end in ("0.31", "0.37")]
    ends = largest(*point[:axis], ("0.31", "0.37"), *point[axis + 1:])
    assert at[0] < at[1] - 0.01 and ends == pytest.approx(at[1], abs=1e-9)


def chosen(*parameters):
    return decide(parameters, most=0)[0]


@pytest.mark.parametrize("epsilon", [0.0139, 0.0141, 0.0152, 0.0180, 0.0210, 0.0278])
def test_on_the_thesis_line_it_stays(epsilon):
    a = "%.9f" % (4 * math.pi * epsilon)
    assert chosen(a, a, "%.9f" % (8 * math.pi * epsilon)) == (0.858028, 0.858028)


def test_a_range_is_easy_only_if_its_weakest_end_is():
    """In the middle nine points contradict every orbit through the first choice; at the weak end
    a better place is looked for."""
    waves = [(1, 0), (0, 1), (1, 1), (1, -1)]
    wide = Problem(SymplecticMap(waves, ["0.55", "0.55", "0.4125", "0.1375"],
                                 [["0.25", "0.25", "0.1875", "0.0625"]]))
    middle = Problem(SymplecticMap(waves, wide.amplitude))
    assert decide(middle, most=0)[0] == (1.018997, 0.879503)
    assert decide(wide, most=0)[0] == (1.325359, 0.589049)


@pytest.mark.parametrize("a, b", [("0.972", "0"), ("0.98", "0.98"), ("0.99", "0.5"), ("1.4", "0")])
def test_without_coupling_it_is_where_each_wave_bends_most(a, b):
    assert chosen(a, b, "0") == (math.pi / 2, math.pi / 2)


def test_it_may_leave_the_diagonal_and_follows_the_wave_that_couples():
    x0, x1 = chosen("0.8", "0.8", "0.08")
    assert sorted((x0, x1)) == [pytest.approx(0.3, abs=0.2), pytest.approx(1.52, abs=0.1)]
    x0, x1 = chosen("0", "0", "0.5")
    assert math.sin(x0 + x1) == pytest.approx(1, abs=1e-6)
    assert chosen("0.5", "0", "0.3") == (math.pi / 2, 0)


# A few per cent above the least radius at which the best of many x* succeeded.
@pytest.mark.parametrize("parameters", [
    ("0.81", "0.81", "0.081"), ("0.63", "0.63", "0.126"), ("0.53", "0.53", "0.159"),
    ("0.456", "0.228", "0.228"), ("0.187", "0.0935", "0.374"), ("0.61", "0.122", "0.183"),
    ("0.44", "0.352", "0.22"), ("0.53", "0.053", "0.265"), ("0.37", "0.037", "0.37"),
    ("0.40", "0", "0.40"), ("0.213", "0.0426", "0.426")])
def test_points_near_the_frontier_are_proved(parameters):
    assert decide(parameters)[2]


@pytest.mark.parametrize("parameters",
                         [("0", "0", "0"), ("1e-9", "0", "0"), ("1e300", "1e300", "0"),
                                        ("0.01", "0.01", "0.01"), ("5", "1", "3")])
def test_there_is_always_a_choice(parameters):
    assert all(map(math.isfinite, chosen(*parameters)))


# Far beyond the frontier: with these x* they took 10^5 tries or were cut as often as can be,
# because one of two contradictions of each orbit was next to nothing, or an end of it could not go
# on.
CUT_FOR_EVER = [
    ((("1.1528125", "1.158125"), "0", ("0.05046875", "0.053125")), ("1.570796", "0"), 1000),
    ((("1.1528125", "1.158125"), "0", ("0.05046875", "0.053125")), ("1.5", "0.1"), 1000),
    ((("1.0805855953896855", "1.0966733436560456"), ("0.9657828825428744", "0.9801614490910491"),
      ("0.021836354249403802", "0.02186864783924623")), ("1.5933", "-0.2340"), 2000),
    ((("0.6015395427020019", "0.6095855226225753"), ("0.288756079009757", "0.28913999809174634"),
      ("0.6611360188515273", "0.6699791401342166")), ("1.3354", "1.0792"), 2000),
    ((("1.1556965402127692", "1.15933100085478"), ("0.06216866387434051", "0.06236417329585014"),
      "0.25383573470622683"), ("1.9936", "0.5480"), 4000),
    ((("0.006774129899626973", "0.006828950644381873"),
      ("0.004412148962980927", "0.004447854993970013"),
      ("0.8080800271305957", "0.8146195457942839")), ("0.5697", "0.4299"), 5000),
]


def polar(a, b, c, r, s):
    """The patch of r ((a, b, 0) + s (0, 0, c)), r and s in these ranges."""
    (r0, r1), (s0, s1) = (tuple(map(Fraction, ends)) for ends in (r, s))
    r, s = (r0 + r1) / 2, (s0 + s1) / 2
    return Problem(SymplecticMap(THESIS, [r * a, r * b, r * s * c],
                                 [[(r1 - r0) / 2 * x for x in (a, b, s * c)],
                          [0, 0, r1 * (s1 - s0) / 2 * c]]))


# A wave that is next to nothing ended orbits, since nobody knew the angle that feels it; or the
# angle that made the ends too wide was never cut.
CUT_FOR_EVER += [
    (polar(1, 0, 1, ("1.1875", "1.1953125"), (0, "0.00390625")), xstar, 1000)
    for xstar in (("1.570796", "0"), ("1.570796", "1.570796"), ("1.6", "0.5"), ("1.5", "3"))] + [
    (polar(1, 0, 1, ("1.0625", "1.0703125"), (0, "0.0078125")), ("1.570796", "0"), 3000),
    (polar(1, 1, 1, ("1.125", "1.1328125"), (0, "0.00390625")), ("1.570796", "1.570796"), 1000),
    (polar(1, 1, 1, ("1.125", "1.1328125"), (0, "0.00390625")), ("0", "1.570796"), 1000),
    (polar(1, 1, 1, ("1.125", "1.1328125"), (0, "0.00390625")), ("1.5", "0.1"), 2000)]


@pytest.mark.parametrize("b", ["0", "0.001", "0.01", "0.1", "0.5", "0.9"])
@pytest.mark.parametrize("c", ["1e-7", "0.001", "0.01", "0.03"])
def test_a_small_coupling_costs_little(b, c):
    """a alone takes 151 tries."""
    assert decide(("1.03", b, c))[2]


@pytest.mark.parametrize("parameters, xstar, most", CUT_FOR_EVER)
def test_nothing_is_cut_for_ever(parameters, xstar, most):
    _, tries, proved = decide(parameters, xstar, most)
    assert proved and tries <= most


# ---- other potentials

def two_harmonics(K1, K2="0.2", along=(1, 0)):
    """The standard map with a second harmonic; along y0, or y1, or y0 + y1."""
    size, phase = along[0] ** 2 + along[1] ** 2, "-1/2"
    return Problem(SymplecticMap([(m * along[0], m * along[1], phase) for m in (1, 2)],
                                 [Decimal(p) / size for p in (K1, K2)]))


def froeschle(K, coupling):
    return Problem(SymplecticMap([(1, 0, "-1/2"), (0, 1, "-1/2"), (1, 1, "-1/2")],
                                 [K, K, coupling]))


def crossed(*amplitudes):
    return Problem(SymplecticMap([(1, 0), (0, 1), (1, 1), (1, -1)], amplitudes))


@pytest.mark.parametrize("along", [(0, 1), (1, 1), (2, -1)])
def test_where_all_waves_are_parallel_it_is_one_question(along):
    """x* along them is that of the circle, and so is the proof."""
    (s, _), tries, proved = decide(two_harmonics("0.62"))
    x, same, also = decide(two_harmonics("0.62", along=along))
    assert proved and also and abs(same - tries) <= tries // 4
    assert math.cos(along[0] * x[0] + along[1] * x[1]) == pytest.approx(math.cos(s), abs=0.02)


# The best of 200 x* is in the gap that two harmonics leave to 0.59, and in none at 0.585.
@pytest.mark.parametrize("problem", [
    two_harmonics("0.59"), two_harmonics("0.605"), two_harmonics("0.64"),
    Problem(SymplecticMap([(1, 0), (2, 0)], ["1", "0.1"])),
    Problem(SymplecticMap([(1, 0), (2, 0)], ["0.8", "0.1"])),
    froeschle("0.84", "0.1"), froeschle("0.65", "0.3"), froeschle("0.6", "0.3"),
    froeschle("0.37", "0.5"), froeschle("0.28", "0.5"), crossed("0.3", "0.3", "0.225", "0.075")],
    ids=repr)
def test_points_near_the_frontier_of_other_potentials_are_proved(problem):
    assert decide(problem)[2]


def test_symmetry_is_given_up_only_for_longer_orbits():
    """On the diagonal nine points leave least, and no proof is to be had."""
    x0, x1 = decide(froeschle("0.65", "0.3"))[0]
    assert abs(x0 - x1) > 1
    assert not decide(froeschle("0.65", "0.3"), ("2.116893", "2.116893"))[2]
    x0, x1 = decide(froeschle("0.7", "0.3"))[0]
    assert x0 == x1


def test_high_harmonics_and_many_waves_have_a_choice():
    waves = [(k0, k1) for k0 in (0, 1, 97, 100) for k1 in (-100, -3, 1, 100)]
    problem = Problem(SymplecticMap(waves, [Decimal("0.0001")] * 16))
    assert all(map(math.isfinite, decide(problem, most=0)[0]))
