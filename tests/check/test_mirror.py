"""Step (C32): orbits through a point about which V is even are followed to one side."""

import functools
import math

import pytest
from mpmath import mp

from checker import check
from trees import cells_of, claim_of, proof_file
from truth import TORTURE

with mp.workdps(40):
    HALF_PI = mp.nstr(mp.pi / 2, 21)    # 20 places, as the prover writes it
ONE = ["1 0 0 1.1 0.01"], HALF_PI + " 0"
# Even about (pi/2, pi/2) and about (pi/2, -pi/2).
TWO = ["1 0 0 0.7 0.01", "0 1 0 0.6 0", "1 1 1/2 0.2 0.01", "3 0 0 0.03 0"]
CASES = [ONE, (["1 0 0 -1.1 0.01"], HALF_PI + " 0"),
         (TWO, HALF_PI + " " + HALF_PI), (TWO, HALF_PI + " -" + HALF_PI)]


def claim(waves, xstar, v0="0.9 0.001", v1="0.9 0.001"):
    return claim_of(proof_file("P", waves, xstar=xstar, frame="1 0 0 1", v0=v0, v1=v1))


@pytest.mark.quick
def test_where_v_is_even():
    quarter = 1 << 62
    for waves, xstar, found in (
            (*ONE, [quarter]),
            (TWO, HALF_PI + " -" + HALF_PI, [quarter, -quarter]),
            (["1 0 1/2 1.1 0.01"], "0 0", [0]),
            (["1 1 0 1.1 0.01"], HALF_PI + " 0", [quarter]),            # in the angle y0 + y1
            (ONE[0], "1.570796326794896619 0", [quarter]),              # off by 2.3e-19
            (ONE[0], "1.57079632679489662 0", None),                    # by 7.7e-19
            (ONE[0], "1.5707963267948966 0", None),
            (ONE[0], "1.571 0", None),
            (ONE[0], "0 0", None),                                      # odd about it
            (["1 0 1/1000000000000 1.1 0.01"], HALF_PI + " 0", None),
            (["1 0 0 1.1 0.01", "2 0 0 0.001 0"], HALF_PI + " 0", None),
            (["1 0 0 1.1 0.01", "2 0 0 0 0.001"], HALF_PI + " 0", None),
            (["1 0 0 1.1 0.01", "2 0 1/2 0 0.001"], HALF_PI + " 0", [quarter]),
            (["1 0 0 1 0.01", "0 1 0 1 0", "1 1 0 1 0"], HALF_PI + " " + HALF_PI, None)):
        reduced = claim(waves, xstar).reduced
        assert check.middle_of(reduced) == found, (waves, xstar)
        assert check.import_numpy_if_sound() and check.Lockstep([claim(waves, xstar)]).even \
            == (found is not None)


def prisms_of(file, even=True):
    """The prism of the whole region, to one side of x* or to both."""
    fast, number = check.Lockstep([file]), check.np.zeros(1, int)
    l = check.np.array([check.least_in_double(check.Criterion(file), check.ROOT)])
    return check.Prisms(fast.box(*cells_of([check.ROOT]), number), fast.shape,
                        fast.xstar[:, number], l, check.SITE_PENALTIES[0], even=even)


def radians(units):
    return [2 * mp.pi * mp.mpf(int(x)) / 2 ** 64 for x in units[:, 0]]


def slopes(waves, amplitudes, x, function):
    """Of each wave p times this function of its angle."""
    return [p * function(sum([a * b for a, b in zip(wave.k, x)]) + mp.pi * float(wave.phase))
            for wave, p in zip(waves, amplitudes)]


def orbit(waves, amplitudes, before, x, count):
    """So many points from x on."""
    found = []
    for _ in range(count):
        found.append(x)
        forces = slopes(waves, amplitudes, x, mp.cos)
        before, x = x, [2 * a - b + sum([f * wave.k[i] for f, wave in zip(forces, waves)])
                        for i, (a, b) in enumerate(zip(x, before))]
    return found


def some_orbit(near, waves, prisms, count):
    """Symbols, amplitudes, and x[0], x[-1], ... and x[1], x[2], ... of an orbit of the prism."""
    e, t = [near() for _ in range(prisms.known)], 0
    if prisms.shape.parameters:
        t = e[0]
    amplitudes = [mp.mpf(wave.middle.numerator) / wave.middle.denominator
                  + float(wave.parts[0]) * t for wave in waves]
    x0 = [x + near() * check.WHOLE_ERROR for x in radians(prisms.first[0])]
    x1 = [x + sum([float(a) * b for a, b in zip(row[:, 0], e)])
          for x, row in zip(radians(prisms.before[0]), prisms.ends)]
    return e, amplitudes, orbit(waves, amplitudes, x1, x0, count), \
        orbit(waves, amplitudes, x0, x1, count)


def mirrored(prisms, x):
    return [[2 * z - y for z, y in zip(radians(prisms.first[0]), point)] for point in x]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("far", (2.0 ** -61, 2.0 ** -16))
def test_both_sides_are_within_the_rests(generator, monkeypatch, case, far):
    """The orbit back from x*, and the mirror image of the one ahead, also where x* is far from the
    centre, so that rests of x[1] and x[-1] are more than roundings."""
    check.import_numpy_if_sound()
    most = end = 0
    file = claim(*case, *["0.9 0.0000001"] * 2)
    monkeypatch.setattr(check, "WHOLE_ERROR", far)
    with mp.workdps(40):
        for _ in range(20 * TORTURE):
            prisms = prisms_of(file)
            e, _, back, ahead = some_orbit(lambda: generator.choice((-1, 1)), file.reduced.waves,
                                           prisms, 12)
            (image,), x1 = mirrored(prisms, [back[1]]), ahead[0]
            more = (prisms.rounding - prisms_of(file, even=False).rounding)[:, 0]
            for a, b, off in zip(image, x1, more):
                assert abs(a - b) <= off
                end = max(end, abs(a - b) / float(off))
            for points in zip(back, mirrored(prisms, [back[0], *ahead])):
                for point in points:
                    turn = prisms.turn.tolist()
                    D = [x - y for x, y in zip(point, radians(prisms.X))]
                    D = [x - 2 * mp.pi * mp.nint(x / 2 / mp.pi) - sum(
                        [float(a) * b for a, b in zip(columns[:, 0], squares(e))])
                        for x, columns in zip(D, prisms.LT)]
                    gaps = [abs(sum([a * b for a, b in zip(row, D)])) for row in turn]
                    assert all(gap <= float(rest[0]) for gap, rest in zip(gaps, prisms.r))
                    most = max(most, *[gap / float(rest[0]) for gap, rest in zip(gaps, prisms.r)])
                prisms.step()
    assert far < 2.0 ** -50 or 0.3 < most <= 1 and 0.2 < end <= 1


def squares(e):
    """The symbols, and their products less the means."""
    return [*e, *[x * y - mp.mpf(i == j) / 2 for i, x in enumerate(e)
                  for j, y in enumerate(e) if i <= j]]


def left_side(waves, amplitudes, x, n, l):
    """Of (C3), where the points x have these n."""
    total = 0
    for at, (point, v) in enumerate(zip(x, n)):
        bends = slopes(waves, amplitudes, point, mp.sin)
        total += 2 * sum([a * a for a in v]) - sum([
            b * sum([a * k for a, k in zip(v, wave.k)]) ** 2 for b, wave in zip(bends, waves)])
        if at + 1 < len(n):
            total -= 2 * sum([a * b for a, b in zip(v, n[at + 1])])
    return total - l * sum([a * a for v in (n[0], n[-1]) for a in v])


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("chosen", ("by the checker", "at random"))
def test_the_bound_of_one_side(generator, case, chosen):
    """It is not below half of the left side of (C3) where n is even, nor below the one of either
    side where n does not reach x[0]; and not far above."""
    check.import_numpy_if_sound()
    (waves, xstar), cases, least = case, [0, 0], math.inf
    with mp.workdps(40), check.np.errstate(all="ignore"):
        for _ in range(12 * TORTURE):
            file = claim(waves, xstar, *["%.3f 0.00002" % generator.uniform(0, 2) for _ in "01"])
            prisms, known = prisms_of(file), file.reduced.waves
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            if chosen == "at random":   # from x[0] on
                count = generator.randint(1, min(5, len(n)))
                n = [check.np.array([[generator.uniform(-1, 1) * (at < count)] for _ in v])
                     for at, v in enumerate(n)]
                tails = [check.np.array([int(at == count - 1)]) for at in range(len(n))]
                prisms.test_vectors = functools.partial(tuple, (n, tails))
            bound = mp.mpf(float(prisms.bound()[0][0]))
            n = [[float(x) for x in v[:, 0]] for v in n]
            used = [at for at, v in enumerate(n) if any(v)]
            if not used or not mp.isfinite(bound):
                continue
            assert sum([int(x[0]) for x in tails]) == 1 + (used[0] > 0)
            n, l = n[used[0]:used[-1] + 1], mp.mpf(float(prisms.l[0]))
            for near in [lambda: 0] + [lambda: generator.choice((-1, 1))] * 3:
                _, amplitudes, back, ahead = some_orbit(near, known, prisms, used[-1] + 1)
                back, ahead = back[used[0]:], ahead[max(used[0] - 1, 0):used[-1]]
                if used[0]:
                    true = max([left_side(known, amplitudes, x, n, l) for x in (back, ahead)])
                else:
                    true = left_side(known, amplitudes, [*ahead[::-1], *back],
                                     [*n[:0:-1], *n], l) / 2
                assert true <= bound
                cases[used[0] > 0] += 1
                least = min(least, bound - true)
    found = chosen == "by the checker"
    assert cases[found] > 3 and least < (0.2 if found else 1e-3)
