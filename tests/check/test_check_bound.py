"""The checker's bound B, l, and whether larger parameters are excluded at once."""

import itertools
import math
from fractions import Fraction

import mpmath
import pytest
from files import sealed

from checker import check
from claims import (FIXED, TRIG, ZERO, bent, exact_decimal, general, highest, in_units, near,
                    random_cell, random_claim, random_point, some_waves, true_bound, waves_of)
from trees import claim_of, with_field, with_parameters, with_tree
from truth import TORTURE

pytestmark = pytest.mark.usefixtures("impatient")


def eigenvalue(amplitudes, y, waves=TRIG):
    p, q, r = bent(waves, amplitudes, y, mpmath.fp)
    return (p + r) / 2 + ((p - r) ** 2 / 4 + q * q) ** 0.5


@pytest.mark.quick
def test_bound_over_a_cell(generator):
    fixed, one = FIXED[96], FIXED[96].one
    for n in range(2000 * TORTURE):
        waves = some_waves(generator)
        amplitudes = [int(near(generator) * 2 ** generator.randint(-6, 3) * one) for _ in waves]
        y = [int(near(generator) * 4 * one) for _ in range(2)]
        w = one * 3 >> n % 24
        bound, value = (x / one for x in check.cell_bound(
            fixed, in_units(fixed, waves), amplitudes, y, w))
        stiff = check.stiffness(in_units(fixed, waves))
        scale = (1 + max(map(abs, amplitudes)) / one) * stiff
        real_ones = [p / one for p in amplitudes]
        for _ in range(4):
            at = [float(c + near(generator) * w) / one for c in y]
            assert eigenvalue(real_ones, at, waves) <= bound + 1e-14 * scale
        assert abs(eigenvalue(real_ones, [t / one for t in y], waves) - value) < 1e-14 * scale


@pytest.mark.quick
def test_bound_over_a_cell_where_slopes_cancel():
    """beta - 2 is sin 2x / 2 - sin x, of third order at 0: the rest of third order bounds it."""
    fixed, one = FIXED[96], FIXED[96].one
    waves = ((1,), ZERO), ((2,), ZERO)
    for w in (1 / 4, 1 / 16, 1 / 256):
        bound, value = (x / one - 2 for x in check.cell_bound(
            fixed, in_units(fixed, waves), [one, -one // 8], [0], int(w * one)))
        assert abs(value) < 1e-15
        assert abs(bent(waves, [1, -1 / 8], [-w], math)[0] - 2) < bound < 0.9 * w ** 3


@pytest.mark.quick
def test_bound_over_the_torus(generator):
    fixed, one = FIXED[96], FIXED[96].one
    for n in range(12 * min(TORTURE, 5)):
        waves = (TRIG, (((1, -1), ZERO), ((2, 1), Fraction(1, 3))), (((2, 4), ZERO),
                 ((-1, -2), Fraction(1, 5))), (((3, 0), ZERO), ((2, 0), Fraction(2, 7))),
                 (((0, 2), ZERO), ((0, -3), Fraction(2, 7))),
                 (((6, 4), ZERO), ((9, 6), Fraction(1, 7))))[n % 6]
        q = {2: (1, 2), 5: (3, 2)}.get(n % 6)           # all k are multiples of it
        low = [int(near(generator) * one) for _ in waves]
        high = [p + int(abs(near(generator)) * one / 8) * (n % 4) for p in low]
        known, scale = in_units(fixed, waves), 1
        if q:
            known, scale = [((k[0] // q[0],), phase) for k, phase in known], q[0] ** 2 + q[1] ** 2
        bound = check.torus_bound(fixed, known, [tuple([scale * p for p in corner]) for corner in
                                                 itertools.product(*zip(low, high))]) / one
        corners = set(itertools.product(*zip((p / one for p in low), (p / one for p in high))))
        best = max(highest(amplitudes, waves, 48) for amplitudes in corners)
        assert -1e-12 <= bound - best < 1e-4


def test_bound_over_the_torus_if_no_wave_couples_the_angles(monkeypatch):
    """Of few cells, though beta is largest on lines; whichever angle has the larger waves."""
    fixed, one, cells, cell_bound = FIXED[96], FIXED[96].one, [], check.cell_bound
    monkeypatch.setattr(check, "cell_bound", lambda *of: cells.append(of) or cell_bound(*of))
    waves = ((1, 0), ZERO), ((0, 1), ZERO), ((0, 2), Fraction(1, 3))
    for amplitudes in (0.6, 0.1, 0.05), (-0.1, 0.6, 0.05), (0.5, 0.5, 0):
        known = in_units(fixed, waves)
        bound = check.torus_bound(fixed, known, [tuple([int(p * one) for p in amplitudes])]) / one
        assert -1e-12 <= bound - highest(amplitudes, waves) < 1e-4
    assert len(cells) < 1000


@pytest.mark.quick
def test_least_pivot(texts, generator):
    """l is at most what the true B of the parameters of a cell gives, and hardly less than what
    the true B at the ends of all parameters give, between them."""
    for n in range(4 * min(TORTURE, 3)):
        text = with_tree(texts["trig274"], "2PP" if n % 3 else "P", False)
        claim = claim_of(random_claim(generator, text, 1, "0.3", False))
        criterion, one = check.Criterion(claim), check.Fixed(96).one
        axes = claim.parameters
        ends = {corner: true_bound([float(wave.at(corner)) for wave in claim.waves])
                for corner in itertools.product((-1, 1), repeat=axes)}
        for _ in range(6):
            index, cuts = random_cell(generator, claim, 4)
            if n % 3 == 0:                      # no cuts of parameters
                index, cuts = index[:2] + (0,) * 4, cuts[:2] + (0,) * 4
            l = criterion.least_pivot((index, cuts)) * 2.0 ** -criterion.fixed.bits
            assert criterion.fixed.one == one and 0 < l < 1
            for _ in range(3):
                point, _ = random_point(generator, claim, (index, cuts))
                B = highest(list(map(float, point)), waves_of(claim))
                assert l + 1 / l >= B - 1e-12
            between = [sum(B * math.prod((i + u) / 2 ** k if s > 0 else 1 - (i + u) / 2 ** k
                                         for i, k, u, s in zip(index[2:], cuts[2:], upper, corner))
                           for corner, B in ends.items())
                       for upper in itertools.product((0, 1), repeat=axes)]
            assert abs(l + 1 / l - max(between)) < 1e-5


@pytest.mark.quick
def test_least_pivot_to_the_last_unit(texts, generator, monkeypatch):
    """With a bound that leaves nothing to spare, and that grows as fast as an eigenvalue can."""
    def bound(abc):
        return 2 + max(abs(abc[0]), abs(abc[1])) + 2 * abs(abc[2])

    def in_units_of(fixed, waves, corners):
        if len(waves[0][0]) == 1:       # a wave (1, 1) has twice the amplitude there
            return max(2 * fixed.one + abs(p) for p, in corners)
        found = dict.fromkeys(check.THESIS, 0)
        return max(2 * fixed.one + bound([{**found, **dict(zip(
            [k for k, _ in waves], corner))}[k] for k in check.THESIS]) - 2 for corner in corners)

    monkeypatch.setattr(check, "torus_bound", in_units_of)
    for n in range(300 * TORTURE):
        text = with_tree(texts["trig274"], "2PP" if n % 3 else "P", False)
        claim = claim_of(random_claim(generator, text, 2, 1, False))
        criterion = check.Criterion(claim)
        for _ in range(10):
            index, cuts = random_cell(generator, claim, 9)
            if n % 3 == 0:
                index, cuts = index[:2] + (0,) * 4, cuts[:2] + (0,) * 4
            l = Fraction(criterion.least_pivot((index, cuts)), criterion.fixed.one)
            amplitudes, _ = random_point(generator, claim, (index, cuts))
            found = dict(zip([wave.k for wave in claim.examined], amplitudes))
            B = bound([found.get(k, 0) for k in check.THESIS])
            assert 0 < l < 1 and l * l - B * l + 1 >= 0         # l is at most the lesser root
    criterion = check.Criterion(claim_of(with_field(with_tree(text, "2PP"), "together", "yes")))
    one = criterion.fixed.one           # B between two ends that differ by a unit, where it counts
    criterion.B_at = [2 * one + (one >> 14), 2 * one + (one >> 14) + 1]
    l = Fraction(criterion.least_pivot(((0,) * 6, (0, 0, 1, 0, 0, 0))), one)
    assert l * l - l * (sum(map(Fraction, criterion.B_at)) / 2 / one) + 1 >= 0


def test_parameters_without_an_eigenvalue_above_2(texts, run):
    """B is hardly above 2, l hardly below 1; but nothing is excluded."""
    for together, tree in (("no", "P"), ("yes", "P"), ("yes", "2PP"), ("no", "432PPPP")):
        text = with_field(with_tree(texts["trig274"], tree), "together", together)
        for half in ("0", "1e-30", "0.001"):
            changed = with_parameters(text, *[("0", half)] * 3)
            criterion = check.Criterion(claim_of(changed))
            assert 0.9 < criterion.least_pivot(check.ROOT) / criterion.fixed.one < 1
            assert "not excluded" in run(sealed(changed))[2]
            assert "at once" in run(sealed(with_field(changed, "at once", "yes")))[2]


def test_waves_too_weak_for_any_orbit_are_given_up(texts, run, monkeypatch):
    """Without a try: orbits so long would take hours."""
    text = with_parameters(with_tree(texts["trig274"], "P"), *[("1e-12", "0")] * 3)
    for path in check.Criterion, check.Lockstep:
        monkeypatch.setattr(path, "attempt", None)
    for options in ((), ("--exact",)):
        status, out, err = run(sealed(text), *options)
        assert (status, out) == (5, "") and "so weak that" in err


@pytest.mark.quick
def test_what_is_too_weak(np, texts, generator, monkeypatch):
    """Where the form of (C3) is not negative if beta has everywhere the least value that it may."""
    text = with_parameters(with_tree(texts["trig274"], "P"), *[("0.25", "0.125")] * 3)
    problems, answers = check.Problems([claim_of(text)]), set()
    assert not problems.hopeless((0, check.ROOT)) and problems.bent == {0: 0.375 * (1 + 1 + 2)}
    monkeypatch.setattr(check, "MAX_SITES", 20)
    for _ in range(200):
        bent, l = 10 ** generator.uniform(-4, -1), 1 - 10 ** generator.uniform(-3, -1)
        form = np.diag(np.full(40, 2 - bent)) - np.eye(40, k=1) - np.eye(40, k=-1)
        form[0, 0] -= l
        form[-1, -1] -= l
        problems.bent[0] = bent
        criterion = problems.criterion(0)
        monkeypatch.setattr(criterion, "least_pivot", lambda _, l=l: l * criterion.fixed.one)
        answers.add(problems.hopeless((0, check.ROOT)))
        assert problems.hopeless((0, check.ROOT)) == (np.linalg.eigvalsh(form)[0] >= 0)
    assert answers == {False, True}


@pytest.mark.quick
def test_one_orbit_on_a_circle_is_not_halved(texts, monkeypatch):
    """Its halves would be the same orbit, of the most points that are followed."""
    monkeypatch.setattr(check, "MAX_SITES", 20)
    claim = claim_of(general(texts["trig274"], [((1, 0), Fraction(1, 2), Fraction(1, 2), [])],
                             (Fraction("0.6"), 0), (1, 0), xstar=(0, 0)))
    why, pieces = check.Criterion(claim).excluded(check.ROOT)
    assert pieces == 1 and "contradicts nothing over 40 points" in why


def at_once(text, centre, half, together):
    text = with_parameters(with_tree(text, "P"), *zip(centre, half))
    text = with_field(with_field(text, "together", together), "at once", "yes")
    claim = claim_of(text)
    return bool(claim.examined) and check.Criterion(claim).at_once()


def test_at_once(texts, generator, monkeypatch):
    """True above B = 10/3, false below, of either sign; false with the origin in the box."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    text = texts["trig274"]
    for n in range(2 * min(TORTURE, 3)):
        abc = [exact_decimal(generator, 1) * generator.choice((0, 1, 1)) for _ in range(3)]
        B = true_bound(list(map(float, abc)))
        scale = Fraction(round(4e9 / 3 / (B - 2)), 10 ** 9) if any(abc) else 1
        for factor, right in (("1.001", any(abc)), ("3", any(abc)), ("0.999", False), ("0", False)):
            centre = [p * scale * Fraction(factor) for p in abc]
            for together in ("no", "yes"):
                assert at_once(text, centre, (0, 0, 0), together) is right
            # A box is as good as its worst point; parameters that move together as their upper end.
            assert not at_once(text, centre, [abs(p) * Fraction("1.01") for p in centre], "no")
            lower = [p - Fraction("0.25") for p in centre]
            assert at_once(text, lower, [Fraction("0.25")] * 3, "yes") is right
            half = [abs(exact_decimal(generator, "0.01")) for _ in range(3)]
            found = at_once(text, centre, half, "no")
            assert not found or right
            if found and n < 2:
                assert min(true_bound([float(p + s * h) for p, h, s in zip(centre, half, corner)])
                           for corner in itertools.product((-1, 0, 1), repeat=3)) > 10 / 3
            assert not right or found or factor == "1.001"
