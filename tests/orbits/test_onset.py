"""Onsets: where they are known to be, and what is refused."""

import math

import pytest

from converse import ConverseError, orbits

K_C = 0.971635406                               # Greene


def test_onsets_of_golden_approximants_tend_to_where_the_torus_breaks_up():
    found = {}
    for p, q in (((34,), 89), ((89,), 233), ((233,), 610)):
        below, above = orbits.onset(orbits.standard, p, q, width=1e-5)
        assert below.exponents[0] <= 1 / q < above.exponents[0]
        assert 0 < above.eps - below.eps <= 1e-5
        assert below.q == above.q == q and above.label == "minimum"
        found[q] = (below.eps + above.eps) / 2
    assert abs(found[89] - K_C) < 1e-3
    assert abs(found[233] - K_C) < 3e-4 and abs(found[610] - K_C) < 1e-4
    assert found[610] > K_C             # e against e^0.96: at the very onset nothing is closer


def test_greenes_residue_at_the_golden_onset():
    """The minimizing orbit's residue (2 - l - 1/l)/4 there tends to -0.2555: growth 0.968."""
    state = orbits.follow(orbits.standard, (233,), 610, [K_C])[0]
    assert -math.sinh(610 * state.exponents[0] / 2) ** 2 == pytest.approx(-0.2555, abs=0.001)


def test_a_saddle_is_no_onset(monkeypatch):
    """Whatever its exponents."""
    monkeypatch.setattr(orbits.PeriodicOrbit, "label", "saddle")
    assert orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4, top=0.004).above is None


def test_a_given_exponent_is_late():
    """The same for every q, and above the onset at 1/q, if it is the larger one."""
    free = orbits.onset(orbits.standard, (233,), 610)
    late = orbits.onset(orbits.standard, (233,), 610, exponent=0.01)
    assert free.above.eps < late.below.eps
    assert late.below.exponents[0] <= 0.01 < late.above.exponents[0]
    same = orbits.onset(orbits.standard, (233,), 610, exponent=1 / 610)
    assert (same.below.eps, same.above.eps) == (free.below.eps, free.above.eps)


@pytest.mark.slow
def test_the_onsets_of_the_thesis_vectors():
    """Thesis, section 2.3: trig's first exponent leaves zero when the state contracts; 0.0080."""
    below, above = orbits.onset(orbits.trig, (1432, 1897), 2513, step=0.0005, width=5e-5)
    assert 0.0075 < below.eps < above.eps < 0.0085


def test_no_onset_up_to_the_end():
    below, above = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4, top=0.0025)
    assert below.eps == 0.0025 and above is None


@pytest.mark.parametrize("how, words", [
    ({"width": 0}, "positive"), ({"step": -1}, "positive"),
    ({"step": 1e-4, "width": 1e-3}, "at most"),
    ({"top": math.inf}, "finite"), ({"width": math.nan}, "finite"),
    ({"exponent": 0}, "too small"), ({"exponent": math.nan}, "finite"),
    ({"exponent": 9e-6}, "too small")])
def test_onset_refuses(how, words):
    with pytest.raises(ValueError, match=words):
        orbits.onset(orbits.trig, (1, 1), 3, **how)


def test_the_solver_fails_and_smaller_steps_help(monkeypatch):
    """Only steps of less than 0.0003 succeed; then none does."""
    relax, tried = orbits.PeriodicOrbit.relax, []

    def fails(state, eps, **options):
        tried.append(eps - state.eps)
        if eps - state.eps > limit:
            raise ConverseError("no orbit")
        return relax(state, eps, **options)

    expected = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", fails)
    limit = 0.0003
    found = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    assert (found.below.eps, found.above.eps) == (expected.below.eps, expected.above.eps)
    assert max(tried) > limit
    limit = 0.0
    with pytest.raises(ConverseError, match="no orbit"):
        orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    assert min(tried) < 0.0025 / 64
