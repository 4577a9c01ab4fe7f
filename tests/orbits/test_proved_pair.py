"""Proved pairs against mpmath, and what must not be proved."""

import re
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import pytest
from flint import arb_mat
from test_minimax import golden, least, truth

from converse import orbits
from converse.model.balls import precision
from converse.orbits import NotProved, Pair
from converse.orbits.enclosure import Enclosure
from converse.orbits.minimax import turn_of
from converse.orbits.proved_pair import TooFewPlaces, _Pass

from truth import mp


def refined(state, displacements):
    """A state with exact displacements, for `truth`."""
    class Exact:
        q, p, origin = state.q, state.p, [mp(Fraction(state.origin[0]))]
        u = {(j, 0): mp(row[0]) for j, row in enumerate(displacements)}
    return Exact


@pytest.mark.parametrize("p, q, eps", [
    (0, 1, "0.5"), (1, 2, "2"), (1, 3, "0.3"), (8, 21, "0.2"), (34, 89, "0.971635406"),
    (34, 89, "0.5"), (34, 89, "8"), (21, 100, "1.3")])
def test_against_many_digits(p, q, eps):
    """Flux and residues contain those of the true orbits: where the flux is 0.02, and where it is
    1e-33 and doubles see no saddle."""
    pair = least(orbits.standard, (p,), q, float(eps)).minimax()
    proved = pair.prove()
    with mpmath.workdps(90):
        (low, below), (high, above) = (
            truth(refined(state, found.displacements), mpmath.mpf(eps))
            for state, found in ((pair.minimum, proved.minimum), (pair.minimax, proved)))
        off = mpmath.mpf(10) ** -43             # of the truth's own solution
        for (first, last), number in ((proved.flux, high - low), (proved.residue, above),
                                      (proved.minimum.residue, below)):
            assert mp(first) - off * max(1, abs(number)) <= number
            assert number <= mp(last) + off * max(1, abs(number))
    assert 0 < proved.flux[0] and proved.flux[1] - proved.flux[0] <= proved.flux[1] / 10 ** 10
    assert proved.minimum.residue[1] < 0 < proved.residue[0]
    assert proved.between or eps == "8"         # where gaps are below 10^-20
    assert proved.radius <= Fraction(1, 10 ** 20)


def ends(text):
    """The interval that a report writes as value(error)."""
    digits, error, power = re.fullmatch(r"(-?[0-9.]+)\(([0-9]+)\)(?:e(.*))?", text).groups()
    unit = Fraction(1, 10 ** len(digits.partition(".")[2]))
    scale = Fraction(10) ** int(power or 0)
    return [(Fraction(digits) + sign * int(error) * unit) * scale for sign in (-1, 1)]


def test_what_the_report_says():
    proved = golden(6, 0.971635406).minimax().prove(30)
    text = proved.report()
    assert text.startswith(proved.minimum.report()) and all(len(line) < 130
                                                            for line in text.splitlines())
    assert "exactly one orbit of type 5/13 within" in text and "one negative direction" in text
    assert "Each of its points is between" in text
    low, high = ends(re.search("\nFlux : (.*)\n", text)[1])
    assert low <= proved.flux[0] < proved.flux[1] <= high < low * Fraction(10001, 10000)
    assert "0.2466" in re.search("Residue of the minimax orbit : (.*)", text)[1]
    assert proved.radius <= Fraction(1, 10 ** 30) and ", flux " in repr(proved)


def test_states_of_different_maps_are_no_pair():
    """Nothing is claimed of two states that do not belong together."""
    one, other = (golden(5, eps).minimax() for eps in (0.5, 0.6))
    for changed in ({"minimax": other.minimax}, {"minimax": one.minimax.repeat(2)},
                    {"minimum": "a"}):
        with pytest.raises(ValueError):
            replace(one, **changed)


def test_a_minimum_or_nothing_in_the_place_of_the_pass():
    """No pass is proved where there is none: with the coordinate held a minimum is one, too, but
    has no direction down."""
    pair = golden(6, 1.5).minimax()

    class Held(_Pass):
        def refine(self):
            self.evaluate()

    with pytest.raises(TooFewPlaces, match="direction down"), precision():
        Held(pair, pair.minimum, Enclosure(pair.minimum, Fraction("1.5")), 5, 40).proved()
    swapped = Pair(pair.minimax, pair.minimax)
    with pytest.raises(NotProved, match="saddle"):
        swapped.prove()
    away = pair.minimax.moved(pair.minimax.u + 1e-5)
    with pytest.raises(NotProved, match="not stationary"):
        Pair(pair.minimum, away).prove()


def test_between_counts_both_balls():
    """A point is between its neighbours only if its ball is outside of both of theirs."""
    pair = golden(5, 1.2).minimax()
    proved = pair.prove()
    q, own, radius = pair.minimum.q, proved.minimum.displacements, Fraction(1, 1000)
    step, away = Fraction(1, q), radius + proved.minimum.radius
    shift = Fraction(pair.minimax.origin[0]) - Fraction(pair.minimum.origin[0])
    turn = turn_of(pair.minimum)
    ends = [(own[j][0] - shift, own[(j + turn) % q][0] + step - shift) for j in range(q)]
    held = object.__new__(_Pass)
    held.pair, held.minimum, held.exact = pair, proved.minimum, SimpleNamespace(q=q)
    middle = [((low + high) / 2,) for low, high in ends]
    assert held.between(middle, radius)
    for j, (low, high) in enumerate(ends):
        for place, inward in ((low + away, 1), (high - away, -1)):
            for inside in (True, False):
                points = [*middle]
                points[j] = place + inward * radius / 100 * (1 if inside else -1),
                assert held.between(points, radius) == inside


def test_the_action_of_a_pass_counts_all_of_its_ball():
    """Where the points are rough: the Hessian is at most 4 + |eps| curvature."""
    class Rough(_Pass):
        def refine(self):
            self.evaluate()
            self.exact.move([arb_mat(1, 1, ["1e-9"])] * self.exact.q)
            self.evaluate()

    pair = golden(5, 1.2).minimax()
    with precision():
        found = Rough(pair, pair.prove().minimum, Enclosure(pair.minimax, Fraction("1.2")), 5,
                      30).proved()
    state = pair.minimax
    most = (4 + Fraction("1.2") * Fraction(state.potential.curvature)) * found.radius ** 2 / 2
    assert found.radius > Fraction(1, 10 ** 9)
    assert found.action[1] - found.action[0] >= 2 * most / state.q


def test_bad_digits():
    for digits in (0, 1.5, "a", 10 ** 6):
        with pytest.raises(ValueError, match="digits"):
            golden(4, 0.5).minimax().prove(digits)


@pytest.mark.slow
def test_proved_pairs_beyond_the_reach_are_refused():
    with pytest.raises(NotProved, match="decimal places"):
        golden(12, 0.3).minimax().prove()
    with pytest.raises(NotProved, match="of the pass, with 1000 decimal places"):
        golden(5, 0.5).minimax().prove(980)     # the most that are tried


@pytest.mark.slow
def test_a_flux_below_the_least_double():
    """2 eps/(4 pi^2), at the two fixed points."""
    pair = orbits.follow(orbits.standard, (0,), 1, [1e-323])[0].minimax()
    low, high = ends(re.search("\nFlux : (.*)\n", pair.prove(400).report())[1])
    with mpmath.workdps(400):
        true = mpmath.mpf("1e-323") / (2 * mpmath.pi ** 2)
        assert mp(low) < true < mp(high) < mp(low) * (1 + mpmath.mpf(10) ** -15)
