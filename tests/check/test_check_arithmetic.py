"""The checker's integers against mpmath: sines, prisms and orbits."""

import dataclasses
import itertools
from fractions import Fraction

import pytest

from checker import check
from claims import (FIXED, exact_decimal, in_frame, moved_by, mp, near, pairs_of, prisms_of,
                    random_cell, random_claim, real, true_orbit, waves_of)
from trees import claim_of, with_tree
from truth import TORTURE

pytestmark = pytest.mark.usefixtures("impatient")


@pytest.mark.parametrize("bits", FIXED)
@pytest.mark.quick
def test_sincos(bits, generator):
    fixed = FIXED[bits]
    unit = mp.mpf(2) ** -bits
    assert abs(fixed.pi - mp.pi / unit) < 2
    worst = 0
    for n in range(5000 * TORTURE):
        x = generator.randint(-1 << bits + n % 40, 1 << bits + n % 40)
        if n % 4 == 0:                      # next to the ends of the steps of the table
            x = generator.randint(-2400, 2400) * (fixed.step >> check.GUARD + 1) + x % 7 - 3
        s, c = fixed.sincos(x)
        worst = max(worst, abs(s - mp.sin(x * unit) / unit), abs(c - mp.cos(x * unit) / unit))
    assert 0.5 < worst < check.SINE_ERROR
    with pytest.raises(OverflowError):
        fixed.sincos(1 << bits + 42)


@pytest.mark.quick
def test_taylor_polynomials_of_small_angles():
    """They are within 4 units for angles up to 1/128, whichever term is the last."""
    for bits in range(64, 180):
        divisors, one = check.Fixed._divisors(bits), mp.mpf(2) ** bits
        for r in (1 << bits - 7, -1 << bits - 7, 100 + 5 ** 9 << bits - 30):
            c, s = check.Fixed._small(r, bits, divisors)
            assert abs(c - mp.cos(r / one) * one) < 4 and abs(s - mp.sin(r / one) * one) < 4


@pytest.mark.quick
def test_roots_and_eigenvalues(generator):
    for _ in range(4000):
        n = generator.randint(0, 1 << generator.randint(1, 200))
        root = check.upper_sqrt(n)
        assert root * root >= n and (root == 0 or (root - 1) ** 2 < n)
        p, q, r = (generator.randint(-1 << 66, 1 << 66) for _ in range(3))
        bound = check.largest([p, q, r])
        # bound I - [p q; q r] is positive semidefinite, and a little less is not
        assert bound >= max(p, r) and (bound - p) * (bound - r) >= q * q
        less = bound - 2
        assert less < max(p, r) or (less - p) * (less - r) < q * q


def random_text(generator, text, tree="P", size=1, width=1):
    return random_claim(generator, with_tree(text, tree), size, width)


def with_shifts(generator, claim, width="0.1"):
    """The claim, or one whose region moves with some of its parameters, as those of parts may."""
    shifts = tuple([tuple([exact_decimal(generator, width) * generator.choice((0, 1, 1))
                           for _ in "01"]) for _ in range(claim.parameters)])
    return generator.choice((claim, dataclasses.replace(claim, shifts=shifts)))


def random_prism(generator, texts, most=12, shift="0.1"):
    """(criterion, cell, prism) of the exact path; shift: how far a parameter may move x[1]."""
    while True:
        claim = claim_of(random_text(generator, texts["trig274"], "P", 1, "0.5"))
        claim = with_shifts(generator, claim, shift)
        if claim.examined:
            criterion, cell = check.Criterion(claim), random_cell(generator, claim, most)
            return criterion, cell, criterion.prism(cell)


def true_point(generator, criterion, cell, corner=False):
    """Symbols, and the amplitudes, x[0] and x[1] that they stand for, exact."""
    claim = criterion.reduced
    eta = [Fraction(generator.choice((-1, 1))) if corner else near(generator) for _ in range(6)]
    along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, eta)]
    v = [c % 2 + h * t + s for c, h, t, s in zip(claim.centre, claim.half, along,
                                                 moved_by(claim, along))]
    return ([eta[axis] for axis in criterion.axes], [wave.at(along[2:]) for wave in claim.examined],
            [[real(x) for x in claim.xstar], in_frame(claim.frame, [real(x) * mp.pi for x in v])])


@pytest.mark.quick
def test_prisms_cover_their_cells(texts, generator, monkeypatch):
    """The same symbols lead to all amplitudes and, modulo 2 pi, to both angles."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    tight = 0
    for _ in range(60 * min(TORTURE, 5)):
        criterion, cell, prism = random_prism(      # in 10^9 turns it counts that pi is off
            generator, texts, 40, generator.choice(("0.1", 10 ** 9)))
        one, turn = criterion.fixed.one, 2 * mp.pi * criterion.fixed.one
        for _ in range(5):
            eta, amplitudes, angles = true_point(generator, criterion, cell)
            for wave, true in zip(prism.waves, amplitudes):
                found = wave.amplitude + sum(part * eta[i] for i, part in wave.parts)
                size = abs(wave.amplitude) + sum(abs(part) for _, part in wave.parts)
                assert abs(true * one - found) < 1 + len(wave.parts)
                assert wave.error - 2 * (1 + len(wave.parts)) >= Fraction(
                    size * check.SINE_ERROR, one)
            for lane, true in zip(prism.lanes, angles[::-1]):
                for x, y, columns, rest in zip(lane.x, true, lane.first_columns, lane.first_rest):
                    gap = y * one - x - sum(a * real(e) for a, e in zip(columns, eta))
                    gap = abs((gap + turn / 2) % turn - turn / 2)
                    assert gap <= rest + 10 ** 10 * turn / one ** 2
                    tight += gap > rest / 20
    assert tight > 50


@pytest.mark.quick
def test_exact_orbits(texts, generator, monkeypatch):
    """True orbits of a prism are where the centres and columns say, within the errors; of its
    corners, where the models miss most, a tenth of the sites need a twentieth of that, or more."""
    monkeypatch.setattr(check, "torus_bound", lambda fixed, *_: 4 * fixed.one)      # unused
    cases = tight = turned = 0
    for _ in range(60 * TORTURE):
        criterion, cell, prism = random_prism(generator, texts)
        one, waves = mp.mpf(criterion.fixed.one), waves_of(criterion.reduced)
        eta, amplitudes, angles = true_point(generator, criterion, cell, generator.random() < 0.7)
        amplitudes = [real(x) for x in amplitudes]
        if max(map(abs, criterion.reduced.frame)) > 1:
            angles[1] = [y + 2 * mp.pi * mp.nint((x / one - y) / (2 * mp.pi))
                         for x, y in zip(prism.lanes[0].x, angles[1])]
        shift = [mp.nint((x / one - y) / (2 * mp.pi)) * 2 * mp.pi
                 for x, y in zip(prism.lanes[0].x, angles[1])]
        angles[1] = [y + d for y, d in zip(angles[1], shift)]
        for lane, true in zip(prism.lanes, true_orbit(waves, amplitudes, angles, 20)):
            for x in true:
                gaps = [y * one - c - sum(a * real(e) for a, e in zip(
                            columns, [*eta, *pairs_of(eta)]))
                        for y, c, columns in zip(x, lane.x, lane.LT)]
                gaps = in_frame([*itertools.chain(*prism.turn.rows)], gaps)
                assert all(abs(gap) <= rest for gap, rest in zip(gaps, lane.r))
                if not lane.advance():
                    break
                cases += 1
                tight += any(abs(gap) > rest / 20 for gap, rest in zip(gaps, lane.r))
                turned += prism.turn.table is not None
    assert cases > 180 * TORTURE and tight > cases / 10 and turned > 20


@pytest.mark.quick
def test_one_bound_in_two_arithmetics(np, texts, generator, monkeypatch):
    """Doubles and integers choose the same vectors, and lead to the same value, error and bound,
    but for their roundings."""
    monkeypatch.setattr(check, "MAX_SITES", 60)
    monkeypatch.setattr(check, "FIRST_TRY_SITES", 60)
    cases = 0
    for _ in range(max(7, 12 * TORTURE)):
        criterion, cell, prism = random_prism(generator, texts, 9)
        l = criterion.least_pivot(cell)
        with np.errstate(all="ignore"):
            prisms = prisms_of(criterion.claim, l / criterion.fixed.one, cell)
            assert all(prisms.follow())
            value, _, most, error = prisms.expand()
            bound = value + most + error
        found, bounds = check.SecondVariation.bound, []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(check.SecondVariation, "bound",
                          lambda self: bounds.append(found(self)) or bounds[-1])
            check.attempt(prism, l, check.SITE_PENALTIES[0])
        if not bounds or not error[0] < 10:
            continue
        exact = [x / (6 << 4 * check.UNIT_BITS) for x in (
            bounds[-1][0], bounds[-1][1], bounds[-1][3])]
        for x, y in zip(exact, (bound[0], value[0], error[0])):
            assert x == pytest.approx(y, rel=1e-5, abs=1e-6)
        cases += 1
    assert cases > 2 * TORTURE
