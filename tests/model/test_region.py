"""Which regions stand for the torus: the rule, against orbits with many digits."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product

import mpmath
import numpy as np
import pytest
from files import line

from converse import FourierMap, Problem, Proof, Settings, Tree, prove
from converse.model import region
from converse.model.map import THESIS, MuldoonMap, SymplecticMap
from converse.model.problem import IDENTITY, periods
from converse.model.region import DIAGONALS, EXCHANGE, REVERSAL

from truth import TORTURE, mp, rng_for

CASES = 200 * TORTURE
STAR = "0.858028", "0.858028"
THREE = SymplecticMap([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], ["0.2", "0.2", "0.2", "0.4"],
                      [["0.01", "0.01", "0.01", "0.02"]])


def draw(rng):
    """A problem of waves of any kind, in two angles or three, with up to three parameters, and
    x*."""
    n = rng.choice((2, 3))
    waves = list({(rng.randrange(-3, 4) or 1, *(rng.randrange(-3, 4) for _ in range(1, n)),
                   Fraction(rng.randrange(8), 7)) for _ in range(rng.randrange(1, 5))})
    n = 2 if not any(any(wave[2:-1]) for wave in waves) else n
    amplitude = [Fraction(rng.randrange(-999, 999) or 1, 1000) for _ in waves]
    parts = [[Fraction(rng.randrange(-99, 99), 1000) for _ in waves]
             for _ in range(rng.randrange(4))]
    star = tuple(str(Fraction(rng.randrange(-4000, 4000), 1000) * 1.0) for _ in range(n))
    return Problem(SymplecticMap(waves, amplitude, parts), alone=None), star


def random_frame(rng, n):
    while True:
        frame = tuple(rng.randrange(-4, 5) for _ in range(n * n))
        if mpmath.det(matrix(frame)):
            return frame


def matrix(frame):
    n = math.isqrt(len(frame))
    return mpmath.matrix([frame[i:i + n] for i in range(0, n * n, n)])


def successors(problem, star, t):
    """x[-1] + x[1] of every orbit through x*, in units of pi."""
    result = []
    for i in range(problem.size):
        force = mp(0)
        for (*k, phase), p, *parts in zip(problem.waves, problem.amplitude, *problem.parts):
            size = mp(p + sum((e * g for e, g in zip(t, parts)), Fraction(0)))
            angle = sum(a * mp(x) for a, x in zip(k, star)) + mp(phase) * mpmath.pi
            force += size * k[i] * mpmath.cos(angle)
        result.append((2 * mp(star[i]) + force) / mpmath.pi)
    return result


@pytest.mark.slow
def test_the_centre_of_the_reversal():
    """c0 is between its bounds for all parameters, which the corners attain."""
    rng = rng_for("reversal centre")
    with mpmath.workdps(50):
        for _ in range(CASES):
            problem, star = draw(rng)
            problem = replace(problem, axes=random_frame(rng, problem.size),
                              alone="no" if problem.factor is not None else None)
            low, high = map(mp, region.reversal_centre(problem, star))
            back, seen = mpmath.inverse(matrix(problem.frame)), []
            for corner in range(3 ** len(problem.parts)):
                t = [corner // 3 ** m % 3 - 1 for m in range(len(problem.parts))]
                seen.append((back * mpmath.matrix(successors(problem, star, t)))[0] / 2)
            assert low <= min(seen) and max(seen) <= high
            assert min(seen) - low + high - max(seen) < 1e-25


def test_the_cosine_of_many_turns():
    """There the digits of pi decide, and the bounds are no wider than they need to be."""
    rng = rng_for("cosine")
    with mpmath.workdps(80):
        for _ in range(CASES):
            angle = Fraction(rng.randrange(10 ** 30), 10 ** 10)
            phase = Fraction(rng.randrange(7), 7)
            least, most = map(mp, region._cosine(angle, phase))
            true = mpmath.cos(mp(angle) + mp(phase) * mpmath.pi)
            assert least <= true <= most and most - least < 1e-18


def is_exchanged(problem):
    return all(0 <= high - low - Fraction(2, problem.size) < Fraction(1, 10 ** 8)
               for low, high in problem.region[1:])


def brought(problem, star, t, v):
    """Is v, after shifts, reversal and exchanges as the proof has them, in the region?"""
    n = problem.size
    forth = np.reshape(problem.frame, (n, n)).astype(float)
    back, total = np.linalg.inv(forth), np.array(successors(problem, star, t), float)
    turns = 2 * np.array(list(product(range(-9, 10) if n == 2 else range(-4, 5), repeat=n)))
    low, high = np.array(problem.region, float).T
    for x in forth @ v, total - forth @ v:
        for order in permutations(range(n)) if is_exchanged(problem) else [range(n)]:
            seen = (x + turns)[:, order] @ back.T
            if ((low <= seen) & (seen <= high)).all(1).any():
                return True
    return False


@pytest.mark.parametrize("problem, star, frame, used", [
    (line("0.0142"), STAR, DIAGONALS[2], [REVERSAL, EXCHANGE]),
    (line("0.0142", "0.0280"), STAR, DIAGONALS[2], [REVERSAL, EXCHANGE]),
    (line("0.0142"), ("0.858", "0.8"), (1, -1, 1, 1), [REVERSAL]),
    (Problem(MuldoonMap(("0.3", "0.4"), ("0.3", "0.4"), "0.6")), STAR, DIAGONALS[2],
     [REVERSAL, EXCHANGE]),
    (Problem(MuldoonMap(("0.3", "0.4"), ("0.3", "0.5"), "0.6")), STAR, (1, -1, 1, 1), [REVERSAL]),
    (Problem(MuldoonMap("0.9", "0.9", "0.1")), ("0.3", "1.5"), IDENTITY, [REVERSAL]),
    (Problem(MuldoonMap("0.3", "0.9", "0.1")), ("0.3", "1.5"), (0, 1, 1, 0), [REVERSAL]),
    (Problem(MuldoonMap("0.3", "0.9", 0)), STAR, (0, 1, 1, 0), [REVERSAL]),
    (Problem(MuldoonMap(0, 0, "0.6")), STAR, (1, 0, -1, 1), []),
    (Problem(SymplecticMap([(1, 0), (4, -2)], ["0.2", "0.3"])), STAR, (2, 1, -1, 2), [REVERSAL]),
    (Problem(SymplecticMap([(1, 0), (0, 1), (1, -1, "1/2")], ["0.2", "0.2", "0.3"])), STAR,
     (1, 1, -1, 1), [REVERSAL]),
    (Problem(THREE), ("0.6", "0.6", "0.60"), DIAGONALS[3], [REVERSAL, EXCHANGE]),
    (Problem(FourierMap({(1, 0, 0): ("0.2", "0.3"), (0, 1, 0): ("0.2", "0.3"), (1, 0, 1): "0.1",
                         (0, 0, 1): ("0.2", "0.3"), (1, 1, 0): "0.1", (0, 1, 1): "0.1"})),
     ("1", "1.0", "1"), DIAGONALS[3], [REVERSAL, EXCHANGE]),
    (Problem(FourierMap({(1, 0, 0): "0.2", (0, 1, 0): "0.2", (0, 0, 1): "0.2", (1, -1, 0): "0.1",
                         (0, 1, -1): "0.1"})), ("1",) * 3, None, [REVERSAL]),   # a chain
    (Problem(THREE), (*STAR, "0.6"), (1, -1, -1, 1, 1, 0, 1, 0, 1), [REVERSAL]),
    (Problem(SymplecticMap([(1, 0, 0), (0, 3, 0), (1, 0, 1, "1/2")], ["0.2", "0.2", "0.3"])),
     ("0.1", *STAR), (0, 1, 0, 1, 0, 0, 0, 0, 1), [REVERSAL]),
    (Problem(SymplecticMap([(1, -2, 2), (1, 0, 0), (1, 3, 0)], ["0.5", "0.2", "0.1"])),
     ("0.1", *STAR), (1, 2, -2, -2, 1, 0, 2, 0, 1), [REVERSAL]),
    (Problem(SymplecticMap([(1, 2, -3), (-2, -4, 6)], ["0.2", "0.1"])), (*STAR, "0.6"), None, []),
])
def test_the_region_that_is_chosen(problem, star, frame, used):
    """Any successor is in it, but for shifts and the symmetries that are said to be used."""
    rng, chosen = rng_for("chosen region"), region.reduced(problem, star)
    assert chosen.frame == (frame or chosen.frame)
    assert region.symmetries_used(chosen, star) == used
    assert is_exchanged(chosen) == (EXCHANGE in used)
    assert region.symmetries_used(chosen, None) == (None if used else [])
    share = math.prod((high - low) / period for (low, high), period
                      in zip(chosen.region, periods(chosen.frame)))
    assert math.prod(periods(chosen.frame)) * abs(mpmath.det(matrix(chosen.frame))) == \
        2 ** chosen.size
    assert share * (2 if REVERSAL in used else 1) * (chosen.size if EXCHANGE in used else 1) < 1.2
    with mpmath.workdps(30):
        for _ in range(10 * TORTURE):
            t = [rng.choice([-1, 1, 0]) for _ in problem.parts]
            assert brought(chosen, star, t, [rng.uniform(-1, 1) for _ in star]) or \
                problem.factor is not None


@pytest.mark.parametrize("change", [
    lambda v0, v1: ((v0[0] + Fraction(1, 10 ** 6), v0[1]), v1),
    lambda v0, v1: ((v0[0], v0[1] - Fraction(1, 10 ** 6)), v1),
    lambda v0, v1: (v0, (v1[0], v1[1] - Fraction(1, 10 ** 30))),
    lambda v0, v1: (v0, (v1[0] + Fraction(1, 10 ** 30), v1[1])),
])
def test_less_is_a_part_of_the_torus(change):
    chosen = region.reduced(line("0.0142", "0.0145"), STAR)
    v0, v1 = change(chosen.v0, chosen.v1)
    less = replace(chosen, v0=v0, v1=v1)
    assert region.symmetries_used(less, STAR) is None
    proof = Proof((Tree(less, STAR, "P"),), Settings("loewner"))
    assert proof.conclusion == "region" and not proof.no_tori
    assert proof.report().startswith("THEOREM, for a part of the torus only\n")


def test_exchange_needs_the_diagonal_and_the_symmetry():
    chosen = region.reduced(line("0.0142"), STAR)
    assert region.symmetries_used(chosen, ("0.858028", "0.858029")) is None
    skew = Problem(SymplecticMap(THESIS, ["0.16", "0.16000001", "0.32"]), v0=chosen.v0,
                   v1=chosen.v1, axes=DIAGONALS[2])
    assert region.symmetries_used(skew, STAR) is None
    for parts, good in (([["0.01", 0, 0], [0, "0.01", 0]], True), ([["0.01", 0, 0]], False),
                        ([["0.01", "-0.01", 0]], False), ([["0.01", "0.01", 0]], True)):
        patch = Problem(SymplecticMap(THESIS, ["0.3", "0.3", "0.6"], parts))
        assert region.exchangeable(patch, STAR) == good
    # one is looked at alone
    assert not region.exchangeable(Problem(MuldoonMap("0.9", "0.9", 0)), STAR)


@pytest.mark.parametrize("problem, star", [
    (Problem(MuldoonMap("1e100", "1e100", "1e100")), STAR),                     # c0 is far away
    (Problem(MuldoonMap((-4, 4), (-4, 4), "0.1")), STAR),                       # or moves too far
    (line("0.0142"), ("1000.5", "1000.5")),
    (Problem(SymplecticMap([(1, 0), (2, 1)], ["0.2", "0.3"], [["5", "5"]])), STAR)])
def test_where_reversal_gains_nothing(problem, star):
    chosen = region.reduced(problem, star)
    low, high = chosen.v0
    assert low == 0 and high >= periods(chosen.frame)[0]
    assert REVERSAL not in region.symmetries_used(chosen, star)


def test_a_place_is_found_modulo_the_lattice():
    rng = rng_for("nearest")
    for n in CASES * (2, 3):
        frame = random_frame(rng, n)
        x, centre = ([Fraction(rng.randrange(-999, 999), 100) for _ in range(n)] for _ in range(2))
        v = region.nearest(frame, x, centre)
        assert all((sum(f * a for f, a in zip(frame[n * i:], v)) - y) % 2 == 0
                   for i, y in enumerate(x))
        assert all(2 * abs(a - c) <= period for a, c, period in zip(v, centre, periods(frame)))


def test_the_same_theorem_from_less():
    """What is proved with the frame and region of its choice is proved with whole circles, too."""
    problem = line("0.0150")
    small = prove(problem, method="loewner")
    whole = prove(replace(problem, axes=(0, 1, 1, 0)), method="loewner")
    assert small.no_tori and whole.no_tori and whole.problem.v0 == (0, 2)
    assert 6 * len(small.tree) < len(whole.tree)
    named = prove(replace(problem, axes=IDENTITY), method="loewner")    # which is no choice of ours
    assert named.no_tori and named.problem.frame == IDENTITY and named.problem.v0 == (0, 2)
    assert "the others follow by reversal of time and exchange of the angles" in " ".join(
        small.report().split()) and "the others" not in whole.report()
