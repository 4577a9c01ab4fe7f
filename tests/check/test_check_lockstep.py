"""The checker's fast path, in doubles, against true orbits with many digits."""

import dataclasses
import itertools
import math
import re
import sys
import types
from fractions import Fraction

import pytest
from files import sealed, tree_of
from test_exact import worst

from converse import prove, read_input

from checker import check
from claims import (FRAMES, OTHERS, TRIG, ZERO, angle_at, bent, definite, exact_decimal, general,
                    in_form, in_frame, moved_by, mp, near, pairs_of, prisms_of, random_cell,
                    random_point, real, some_waves, true_orbit)
from trees import cells_of, claim_of, with_field, with_parameters, with_tree
from truth import TORTURE

pytestmark = pytest.mark.usefixtures("impatient")


def random_prisms(np, generator, count=8, scale=1.0):
    """Prisms of any kind, from needles to parallelograms, of the thesis's waves or others, with
    parameters that move many waves or one or none, and x[1], or not; in some lanes a wave may be
    missing."""
    waves = some_waves(generator)
    moving = generator.choice((
        [(w, 0) for w in range(len(waves))], [(w, w % 3) for w in range(len(waves))], [],
        [(w, m) for w in range(len(waves)) for m in range(3)], [(0, 0)]))
    parameters = max([m + 1 for _, m in moving] + [generator.choice((0, 0, 1, 3))])
    shape = check.Shape(waves, moving, parameters + 2)
    draw = np.random.default_rng(generator.getrandbits(64))
    P, width = np.zeros((len(waves), count)), 2.0 ** draw.uniform(
        generator.choice((-40, -7)), -2, count)
    for w, (k, _) in enumerate(waves):
        P[w] = draw.uniform(-scale, scale, count) / (abs(k[0]) + abs(k[1]))
    if generator.random() < 0.3:
        P[generator.randrange(len(waves))] *= draw.integers(0, 2, count)
    h = np.zeros((len(P), shape.parameters, count))
    for w, symbols in enumerate(shape.moving):
        for m in symbols:
            h[w, m] = abs(P[w]) * draw.uniform(-1, 1, count) * width
    W = abs(P) * generator.choice((0, 2.0 ** -50, 2.0 ** -30, 2.0 ** -8))
    x = draw.uniform(-0.5, 0.5, (2, count))
    sides = draw.uniform(0, 1, (2, count)) * width * generator.choice((1, np.array([[1], [0]])))
    frame = np.array(generator.choice(FRAMES), float).reshape(2, 2, 1)
    columns = draw.uniform(-1, 1, (2, parameters, count)) * width
    columns *= generator.choice((0, 0, 1))
    columns = np.concatenate((columns, frame * sides), axis=1)
    off = draw.uniform(0, 1, (2, count)) * width * generator.choice((0, 0, 2.0 ** -20, 2.0 ** -45))
    xstar = np.array([[generator.choice((0.25, draw.uniform(-0.5, 0.5)))] for _ in "01"]) \
        + generator.choice((0, 0.1)) * draw.uniform(-0.5, 0.5, (2, count))
    amplitudes = np.array([[check.units_of(Fraction(float(p)), check.AMPLITUDE_BITS) for p in row]
                           for row in P], object)
    return check.Prisms((check.in_turns(amplitudes), h, W, check.whole(x), columns, off), shape,
                        check.whole(xstar), draw.uniform(0, 0.9, count))


def inside(generator, prisms, lane, eta=None):
    """A point of the prism of a lane ahead: its symbols, exact parameters, x[0] and x[1]."""
    eta = eta or [near(generator) for _ in range(prisms.known)]
    amplitudes = []
    for most, rest, h, W in zip(*prisms.turns[:2], prisms.h, prisms.W):
        turns = Fraction(int(most[lane]), 1 << 38) + Fraction(float(rest[lane])) * (1 << 26)
        amplitudes.append(2 * mp.pi * real(turns) + real(
            Fraction(float(W[lane])) * near(generator)
            + sum(Fraction(float(x)) * e for x, e in zip(h[:, lane], eta))))
    angles = []
    for units, rest, columns in (
            (prisms.before[0], prisms.other(prisms.rounding), 0 * prisms.ends),
            (prisms.first[0], prisms.rounding, prisms.ends)):
        angles.append([
            2 * mp.pi * real(Fraction(int(units[i, lane]), 1 << 64)) + real(
                Fraction(float(rest[i, lane])) * near(generator)
                + sum(Fraction(float(x)) * e for x, e in zip(columns[i, :, lane], eta)))
            for i in (0, 1)])
    return eta, amplitudes, angles


def test_lockstep_sincos(np, generator):
    turns = [float(near(generator)) / 2 * 2.0 ** -generator.choice((0, 0, 0, 1, 9, 60, 300))
             for _ in range(3000)]
    turns += [k / 2048 + d for k in range(-1023, 1024, 8) for d in (-2.0 ** -40, 0, 2.0 ** -40)]
    errors = []
    for waves in (TRIG, OTHERS, (((100, -99), Fraction(1, 3)), ((-100, 100), Fraction(199, 100)))):
        shape = check.Shape(waves)
        X = check.whole(np.array([turns, turns[::-1]]))
        found = shape.turns(X)
        sines, cosines, close, low = check.lockstep_sincos(found)
        unit = mp.mpf(2) ** -53
        for n in range(0, X.shape[1], 1 if waves is TRIG else 7):
            y = [2 * mp.pi * mp.mpf(int(x)) / 2 ** 64 for x in X[:, n]]
            for w, wave in enumerate(shape.waves):
                angle = 2 * mp.pi * mp.mpf(int(found[w, n])) / 2 ** 64
                for value, function in ((sines, mp.sin), (cosines, mp.cos)):
                    value = mp.mpf(float(value[w, n]))
                    assert abs(value - function(angle)) <= 2 * unit
                    assert abs(value - function(angle_at((wave[0], Fraction(wave[1])), y))) \
                        <= 2.1 * unit
                fine = mp.mpf(int(close[w, n])) / 2 ** 26 + mp.mpf(float(low[w, n]))
                errors.append(abs(fine - mp.cos(angle)) / unit)
                assert abs(low[w, n]) < 1 / 320
    assert 1 / 200 < max(errors) <= 1 / 40
    assert check.SINE_ROUNDING == 24 * 2.0 ** -53


@pytest.mark.quick
def test_whole_turns(np, generator):
    """They are off by less than a unit of 2^-64 turns, at the ends of a turn, too."""
    turns = [generator.uniform(-1, 1) * 2.0 ** generator.randint(-80, 12) for _ in range(3000)]
    turns += [k / 2 + d for k in range(-3, 4) for d in (-2.0 ** -54, -2.0 ** -66, 0, 2.0 ** -54)]
    turns += [0.5 - 2.0 ** -54, 2.0 ** -54 - 0.5, 1.5 + 2.0 ** -52]
    with np.errstate(all="raise"):                  # if one did not fit
        units = check.whole(np.array(turns)).tolist()
    for x, found in zip(turns, units):
        off = (Fraction(x) * 2 ** 64 - found + 2 ** 63) % 2 ** 64 - 2 ** 63
        assert abs(off) < 1 and -2 ** 63 <= found < 2 ** 63


def what_an_error_adds(text, name):
    """An error of each step, and the rests of the hundredth site less those without the error."""
    for angle in "v0", "v1":
        text = with_field(text, angle, "1 0")
    rests = []
    for counted in (1, 0):
        prisms = prisms_of(claim_of(text))
        error = getattr(prisms, name)
        size = error.copy()
        error *= counted
        assert all(prisms.follow())
        rests.append(prisms.sites[100].rest[:2])
    return size, rests[0] - rests[1]


@pytest.mark.parametrize("c, factor", [("0", 1), ("2e-9", 2)])
@pytest.mark.quick
def test_roundings_of_each_step_are_counted(np, texts, c, factor):
    """Where columns are 0 and matrices nearly constant, N steps add up to N^2 / 2 times the error
    of one, in the frame of the angles; in the diagonal one each has both coordinates' errors."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("1e-9", "0"), ("1e-9", "0"), (c, "0"))
    push, counted = what_an_error_adds(text, "push")
    assert (push >= 2.0 ** -57 * 1e-9 + 2.0 ** -61).all()
    assert (counted > 0.95 * factor * push * 100 ** 2 / 2).all()


@pytest.mark.quick
def test_roundings_of_waves_that_move_are_counted(np, texts):
    """As above, the roundings of what the parameters do to a wave."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("1e-9", "1e-9"), ("1e-9", "1e-9"),
                           ("0", "0"))
    moving, counted = what_an_error_adds(text, "from_H")
    assert (moving >= 2.0 ** -48 * 1e-9).all()
    assert (counted > 0.95 * moving * 100 ** 2 / 2).all()


@pytest.mark.parametrize("G, mu, terms, least", [
    # G is 0, and terms 10 and 20 cancel in it
    ([0, 0, 0], [0, 0, 0], [10, 20], lambda grain: grain * (10 * (3 + 0.5) + 20 * (4 + 0.5))),
    # mu of the other lane, which is subtracted, loses digits of its terms
    ([7, -5, 0], [7, -5, 0], [0, 0], lambda grain: grain * (7 + 5) * (3 + 0.5)),
    # all coefficients of G, one of them negative, times what x[1] is off by
    ([1, -2, 0.5], [0, 0, 0], [0, 0], lambda grain: 0.5 * (1 + 2 + 0.5))])
@pytest.mark.quick
def test_errors_where_the_lanes_meet_are_counted(np, G, mu, terms, least):
    """x[1] is off by its columns, which sum to 3 and 4, and by 1/2."""
    def first(row):
        return np.array([[[x] for x in map(float, row)], [[0.0]] * 3])

    shape, sums = check.Shape([((1, 0), 0)]), types.SimpleNamespace(error=np.zeros(1))
    check.Prisms.add_ends(types.SimpleNamespace(
        other=np.array, joined=np.array, rounding=np.full((2, 1), 0.5), shape=shape,
        ends=np.array([[[1.0], [-2.0]], [[4.0], [0.0]]])), sums, first(G), first(mu),
        np.array([[float(x)] for x in terms]))
    assert shape.grain >= 64 * check.UNIT and sums.error >= least(shape.grain)


@pytest.mark.quick
def test_a_wave_that_vanishes_in_the_middle_is_there(np, texts):
    """Its parameter moves it, so no orbit goes on where it reaches beyond 1."""
    text = with_parameters(with_tree(texts["trig278"], "P"), ("0", "0.3"), ("0", "0"), ("0", "0"))
    prisms = prisms_of(claim_of(with_field(text, "v0", "1 0.001")))
    assert all(prisms.follow()) and 1 < len(prisms.sites) < 100
    assert max([site.reach[0].max() for site in prisms.sites]) <= check.REACH_MAX


@pytest.mark.quick
def test_roundings_of_slopes_are_counted_at_every_site(np, texts, monkeypatch):
    """Not only where the lanes meet, which is left out here."""
    monkeypatch.setattr(check.Prisms, "add_ends", lambda prisms, sums, G, *_: setattr(
        sums, "ends", np.zeros((prisms.known, G.shape[1], prisms.size))))
    text = with_field(with_tree(texts["trig278"], "P"), "v0", "1 0.001")
    prisms = prisms_of(claim_of(with_field(text, "v1", "1 0.001")), 0.3)
    assert all(prisms.follow()) and len(prisms.sites) > 1
    *_, error = prisms.expand()
    prisms.shape.grain = 1.0                    # after all else was made of it
    assert prisms.expand()[-1] > error + 1


@pytest.mark.quick
def test_l_as_a_double_is_not_larger(generator):
    for _ in range(100):
        one, l = 1 << 96, generator.randrange(1 << 96)
        criterion = types.SimpleNamespace(least_pivot=lambda _, l=l: l,
                                          fixed=types.SimpleNamespace(one=one))
        found = Fraction(check.least_in_double(criterion, check.ROOT))
        assert Fraction(l, one) * (1 - Fraction(1, 2 ** 48)) < found <= Fraction(l, one)


def cut_short(monkeypatch, bits):
    """Centres are whole numbers of 2^-bits turns, cut downwards, so that all errors have one sign
    and nothing else hides them; and WHOLE_ERROR is what it is for 64 bits."""
    if bits < 64:
        whole, lost = check.whole, 64 - bits
        monkeypatch.setattr(check, "whole", lambda turns: whole(turns) >> lost << lost)
        monkeypatch.setattr(check, "WHOLE_ERROR", 2.0 ** (3 - bits))


@pytest.mark.parametrize("bits", [64, 36])
def test_lockstep_orbits(np, generator, monkeypatch, bits):
    """True orbits of a prism are where the models say, within their rests, rounded as they are."""
    cut_short(monkeypatch, bits)
    cases = tight = others = 0
    step, centres, bows = check.Prisms.step, [], []     # bows: k.T of each site

    def records(self):
        centres.append(self.X.copy())
        bows.append(self.shape.along(self.LT[:, self.known:]).copy())
        step(self)

    monkeypatch.setattr(check.Prisms, "step", records)
    for _ in range((10 if bits == 64 else 6) * TORTURE):
        prisms = random_prisms(np, generator)
        known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
        centres.clear()
        bows.clear()
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
        push = 2.0 ** -57 * abs(prisms.P) + check.WHOLE_ERROR       # (C13), of each wave
        assert (prisms.push > 0.99 * np.tensordot(abs(prisms.shape.k.T), push, 1)).all()
        for lane in range(prisms.size):
            eta, amplitudes, angles = inside(generator, prisms, lane)
            ends = [[site[0][k] for site in prisms.sites].count(True)
                    for k in (lane, lane + prisms.size)]
            orbits = true_orbit(known, amplitudes, angles, min(max(ends), 20))
            for orbit, k, end in zip(orbits, (lane, lane + prisms.size), ends):
                for site, centre, bow, x in list(zip(prisms.sites[:end], centres, bows, orbit)):
                    columns, size, rest, reach = site.columns, site.size, site.rest, site.reach
                    centre = [Fraction(int(turns[k]), 1 << 64) for turns in centre]
                    for w in range(prisms.shape.count):
                        (k0, k1), _ = known[w]
                        model = sum(mp.mpf(float(a)) * real(e) for a, e in zip(columns[w, :, k],
                                                                               eta))
                        turns_ = real(k0 * centre[0] + k1 * centre[1])
                        off = (k0 * x[0] + k1 * x[1] - 2 * mp.pi * turns_ - model + mp.pi) \
                            % (2 * mp.pi) - mp.pi
                        if reach[w, k] <= 1:
                            assert abs(off) <= mp.mpf(float(rest[w, k]))
                            assert size[w, k] >= sum(map(abs, columns[w, :, k]))
                            off -= sum(mp.mpf(float(a)) * real(e) for a, e in zip(
                                bow[w, :, k], pairs_of(eta)))
                            left = rest[w, k] - (prisms.halves[:, 0] * abs(bow[w, :, k])).sum()
                            assert abs(off) <= left + 2.0 ** -50 * rest[w, k]
                            cases += 1
                            tight += abs(off) > left / 20
                            others += w > 2
    assert cases > 300 * TORTURE and tight > 12 and others > 30


def some(generator):
    """Three numbers, as a rule only one of them above 0."""
    kinds = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)
    return [generator.choice((1, generator.random())) * k for k in generator.choice(kinds)]


def extremes(generator):
    """A wave and a point of it, from where one term of a bound stands alone to all together: P, H,
    W, y, the reaches of its parts, and where e, xi, w and more lie in theirs."""
    P, H, W = some(generator)
    size, rest = (generator.choice((0, 0.5, generator.random() / 2)) for _ in range(2))
    y = generator.choice((generator.uniform(-4, 4), math.pi / 2 * generator.randint(-2, 2)))
    at = [generator.choice((-1, 1, -1, 1, generator.uniform(-1, 1), 0)) for _ in range(6)]
    return P * generator.choice((-1, 1)), H, W, y, size, rest, at


def bending_quotients(generator):
    """What a wave does to r in a step, divided by its bound."""
    P, H, W, y, size, rest, (e, i, j, k, *others) = extremes(generator)
    shares = [generator.choice((-1, 0, 0, 1, generator.uniform(-1, 1))) for _ in "012"]
    shares = [i * size * x / max(sum(map(abs, shares)), 1) for x in shares]
    eta, parts = [e, *others], [(0, H * math.sin(y))] if H else []
    pairs = list(itertools.combinations_with_replacement(range(3), 2))
    form, mean = check.quadratic(pairs, check.np.array([[x] for x in shares]), P * math.cos(y),
                                 parts)
    xi, w = sum(mp.mpf(x) * z for x, z in zip(shares, eta)), j * mp.mpf(rest)
    c, s = mp.cos(y), mp.sin(y)
    true = (P + H * e + W * k) * mp.cos(y + xi + w) - P * c + P * s * (xi + w) - H * e * c \
        + mean[0] + sum(float(x[0]) * mp.mpf(z) for x, z in zip(form, pairs_of(eta)))
    bound = check.bending(P, H, W, abs(math.sin(y)), abs(math.cos(y)), size, rest, size + rest)
    yield abs(true) / (bound * check.SUM_ROUNDING + mp.mpf(10) ** -15)


def remainder_quotients(generator):
    """What a wave has beside G z and (4), divided by its bound."""
    P, H, W, y, size, rest, (e, i, j, k, l, m) = extremes(generator)
    omega, m0, m1 = some(generator)
    m0 *= generator.choice((-1, 1))
    xi, w, mu = i * mp.mpf(size), j * mp.mpf(rest), m0 + l * mp.mpf(m1)
    c, s, z = mp.cos(y), mp.sin(y), xi + w
    A0, B0, alpha, beta = m0 * c - omega * s, -omega * c - m0 * s, (mu - m0) * c, (m0 - mu) * s
    true = (P + H * e + W * k) * (mu * mp.cos(y + z) - omega * mp.sin(y + z)) \
        - z * (P * B0 + P * beta - P * A0 * xi + H * e * B0) - P * (A0 + alpha) \
        - H * e * (A0 + alpha) - P * A0 * xi ** 2 / 2 + P * alpha * xi ** 2 / 2 \
        + P * B0 * xi ** 3 / 6 - H * e * (beta * xi - A0 * xi ** 2 / 2)
    bound = check.remainder(
        P, H, W, float(A0), m1 * abs(float(c)), float(B0), m1 * abs(float(s)),
        abs(m0) + m1 + omega, size, rest, size + rest)
    yield true / (bound * check.SUM_ROUNDING + mp.mpf(10) ** -14)


@pytest.mark.parametrize("quotients", [bending_quotients, remainder_quotients])
@pytest.mark.quick
def test_lockstep_terms(np, generator, quotients):
    """What is left of a wave is bounded, hardly too far."""
    assert 0.99 < worst(lambda: quotients(generator), 2000 * TORTURE) <= 1


def left_side(waves, amplitudes, lanes, n, tails, l, lane, size, m=mp):
    """The left side of (3) of a true orbit."""
    total, number = 0, mp.mpf if m is mp else float
    for x, k in zip(lanes, (lane, lane + size)):
        vectors = [[number(float(v)) for v in vector[:, k]] for vector in n]
        for y, vector, tail in zip(x, vectors, tails):
            total += in_form(bent(waves, amplitudes, y, m), vector) \
                - l * number(float(tail[k])) * (vector[0] ** 2 + vector[1] ** 2)
        total -= 2 * sum(a[0] * b[0] + a[1] * b[1] for a, b in zip(vectors, vectors[1:]))
    a, b = [[number(float(v)) for v in n[0][:, k]] for k in (lane, lane + size)]
    return total - 2 * (a[0] * b[0] + a[1] * b[1])


@pytest.mark.parametrize("chosen", ["by the checker", "at random"])
def test_lockstep_bound(np, generator, chosen):
    """At all sorts of points of a prism the true left side of (3) is below the bound, and below
    the polynomial and its error."""
    cases = 0
    least = math.inf
    for _ in range(12 * TORTURE):
        prisms = random_prisms(np, generator)
        known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            if chosen == "at random":
                draw = np.random.default_rng(generator.getrandbits(64))
                shrink = generator.choice((0.5, 0.8, 1))
                n = [draw.uniform(-1, 1, v.shape) * shrink ** k * site[0]
                     for k, (v, site) in enumerate(zip(n, prisms.sites))]
                tails = [draw.uniform(0, 2, t.shape) for t in tails]
                prisms.test_vectors = lambda: (n, tails)
            bound, _ = prisms.bound()
            value, form, _, error = prisms.expand()
        for lane in range(prisms.size):
            both = [lane, lane + prisms.size]
            count = sum(bool(site[0][both].any()) for site in prisms.sites)
            if count > 25 or not np.isfinite(bound[lane]) or not n[0].any():
                continue

            def about(eta):
                _, abc, angles = inside(generator, prisms, lane, eta)
                abc, angles = [float(x) for x in abc], [[float(x) for x in y] for y in angles]
                return left_side(known, abc, true_orbit(known, abc, angles, count, math), n, tails,
                                 float(prisms.l[lane]), lane, prisms.size, math)

            worst = max(itertools.product((-1, 1), repeat=prisms.known), key=about)
            for eta in (None, [Fraction(e) for e in worst]):
                eta, abc, angles = inside(generator, prisms, lane, eta)
                true = left_side(known, abc, true_orbit(known, abc, angles, count), n, tails,
                                 mp.mpf(float(prisms.l[lane])), lane, prisms.size)
                model = mp.mpf(float(value[lane])) + sum(
                    mp.mpf(float(x[lane])) * math.prod([real(eta[k]) for k in key])
                    for key, x in form.items())
                assert true <= bound[lane] and true <= model + float(error[lane])
                least = min(least, model + float(error[lane]) - true if true else 1)
                cases += 1
    assert cases > 36 * TORTURE and 0 < least < (1e-6 if chosen == "at random" else 1)


@pytest.mark.quick
def test_what_the_centres_miss_counts(np, generator):
    """The centre's step misses `push` at each site (C18), and a centre at either end `rounding`:
    with larger ones every bound that has multipliers is larger."""
    grown = 0
    for _ in range(4 * TORTURE):
        prisms = random_prisms(np, generator)
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            prisms.test_vectors = lambda: (n, tails)
            usual, _ = prisms.bound()
            long = np.isfinite(usual) & [sum(site[0][lane] for site in prisms.sites) > 2
                                         for lane in range(prisms.size)] & (abs(usual) > 1e-9)
            push, prisms.push = prisms.push, prisms.push + 1e-3
            further, _ = prisms.bound()
            prisms.push = push
            rounding, prisms.rounding = prisms.rounding, prisms.rounding + 1e-3
            ends, _ = prisms.bound()
            prisms.rounding = rounding
            again, _ = prisms.bound()
        assert (again[long] == usual[long]).all()
        assert (further[long] > usual[long]).all() and (ends[long] > usual[long]).all()
        grown += long.sum()
    assert grown > 10


@pytest.mark.quick
def test_sums_in_blocks(np, generator, monkeypatch):
    """Blocks of one site, of three or of all lead to the same sums.  So do their errors; N blocks
    of one site have as many terms one after the other as one block of N, and blocks of three fewer.
    """
    monkeypatch.setattr(check, "MAX_SITES", 40)
    cases = 0
    for _ in range(8):
        prisms, found = random_prisms(np, generator, scale=0.3), []
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            N, lanes = len(prisms.sites), prisms.l.size
            draw = np.random.default_rng(generator.getrandbits(64))
            vectors = [draw.uniform(-1, 1, (2, lanes)) * site.alive for site in prisms.sites], \
                [draw.integers(0, 3, lanes) for _ in prisms.sites]
            prisms.test_vectors = lambda: vectors
            for sites in (1, 3, N):
                monkeypatch.setattr(check, "BLOCK", sites * lanes)
                value, form, _, error = prisms.expand()
                found.append((np.stack([value, *form.values()]), error))
        (ones, _), (threes, less), (whole, error) = found
        good = (error < 0.1) & (N > 6)
        for other in ones, threes:
            assert (abs(other - whole) <= error)[:, good].all()
        assert found[0][1][good] == pytest.approx(error[good], rel=1e-13, abs=0)
        assert (less < error)[good].all()
        assert less[good] == pytest.approx(error[good], rel=0.9, abs=0)
        cases += good.sum()
    assert cases > 10


@pytest.mark.quick
def test_sums_of_the_value(np):
    """Multiples of 2^-26 add up exactly, however many of them cancel, and only what is beside them
    is rounded: step (C19)."""
    draw = np.random.default_rng(3)
    for size in 2.0 ** -30, 1.0, 2.0 ** 9:
        terms = draw.uniform(-size, size, (40, 100, 2))
        sums = check.Sums(2, 0, 2)
        sums.add(terms[0, :1])
        assert (abs(sums.low) <= 2.0 ** -27).all()
        sums.add(terms[0, 1:])
        for block in terms[1:]:
            sums.add(block)
        for lane in range(2):
            exact = sum(map(Fraction, terms[..., lane].ravel().tolist()))
            found = Fraction(sums.value[lane]) + Fraction(sums.low[lane])
            assert abs(exact - found) <= Fraction(4000 * 140, 1 << 27 + 53)
            assert sums.value[lane] * 2 ** 26 % 1 == 0 and abs(sums.low[lane]) <= 4000 / 2 ** 27


@pytest.mark.quick
def test_masses_of_roundings(np, generator, monkeypatch):
    """The masses, of each wave and site, and what (C19) takes of them; none where they are large.
    """
    blocks, joined, add_sites, join = [], [], check.Prisms.add_sites, check.Sums.join
    monkeypatch.setattr(check.Prisms, "add_sites", lambda self, *block: (
        blocks.append(block), add_sites(self, *block))[1])
    monkeypatch.setattr(check.Sums, "join", lambda self, both: (
        join(self, both), joined.append(self))[0])
    cases = large = 0
    for length in [1] * 6 + [2.0 ** 11] * 2:
        prisms, both = random_prisms(np, generator, scale=0.5), (2, -1)
        blocks.clear()
        with np.errstate(all="ignore"):
            assert all(prisms.follow())
            n, tails = prisms.test_vectors()
            prisms.test_vectors = lambda: ([length * v for v in n], tails)
            _, _, added, error = prisms.expand()
        m0, m2, N, size = 0, 0, len(prisms.sites), prisms.size
        for _, site, n, _, _, _, mus, _, _ in blocks:
            long, mu = (n * n).sum(axis=0), abs(mus[0]).sum(axis=1)
            m0 = m0 + (2 * long).sum(axis=0).reshape(both).sum(axis=0)
            for (k, _), P, H, reach in zip(prisms.shape.waves, abs(prisms.P), prisms.H,
                                           site.reach):
                K, square = sum(map(abs, k)), (k[0] ** 2 + k[1] ** 2) * long
                weight = K * (abs(k[0]) * mu[0] + abs(k[1]) * mu[1] + square)
                m0, m2 = [m + x.sum(axis=0).reshape(both).sum(axis=0) for m, x in (
                    (m0, K * P * square), (m2, weight * (P * reach ** 2 + 3 * H)))]
        block = max(1, check.BLOCK // (2 * size))
        chain = (len(prisms.P) + 2) * (block + math.ceil(N / block))
        least = 2.0 ** -53 * (96 * m0 + 256 * m2 + chain * (m2 + 2.0 ** -9) + 96 * added)
        fine = m0 + m2 < 0.99 * 2 ** 22
        assert (error >= joined[-1].error + (1 - 1e-9) * least)[fine].all()
        assert (error == math.inf)[m0 + m2 > 1.01 * 2 ** 22].all()
        cases, large = cases + fine.sum(), large + (~fine).sum()
    assert cases > 20 and large > 0


def test_a_leaf_of_long_orbits(np, texts, generator, monkeypatch):
    """A leaf of the proof from 0.01391 to 0.0140 over its second point: one piece, in doubles and
    in integers, where models of first order took more than 4,096; and the bound is near the truth.
    """
    monkeypatch.setattr(check, "MAX_SITES", 300)
    half = Fraction("0.0005046462")
    claim = claim_of(general(
        texts["trig274"], [(k, 0, p * Fraction("0.1564963938"), [p * half]) for k, p in zip(
            check.THESIS, (1, 1, 2))],
        (Fraction("0.670635"), Fraction("0.021925")), (Fraction("0.00781"), Fraction("0.0096")),
        xstar=(Fraction("0.846028"), Fraction("0.846028"))))
    claim = dataclasses.replace(claim, frame=check.DIAGONALS[2])
    cell = (96814, 858, 5, 0, 0, 0), (17, 12, 10, 0, 0, 0)
    criterion = check.Criterion(claim)
    l = check.least_in_double(criterion, cell)
    assert criterion.attempt(criterion.least_pivot(cell), cell, check.SITE_PENALTIES[0]) is None
    with np.errstate(all="ignore"):
        prisms = prisms_of(claim, l, cell)
        assert all(prisms.follow())
        bound = prisms.bound()[0][0]
        n, tails = prisms.test_vectors()
    assert bound < 0 and len(n) > 190
    known = [(k, Fraction(phase)) for k, phase in prisms.shape.waves]
    for _ in range(3):
        _, amplitudes, angles = inside(generator, prisms, 0)
        true = left_side(known, amplitudes, true_orbit(known, amplitudes, angles, len(n)), n,
                         tails, mp.mpf(l), 0, 1)
        assert true <= bound < 0.8 * true


@pytest.mark.quick
def test_lockstep_polynomial(np, generator):
    """The left side of (3) is the polynomial but for what it is said to leave, to either side; and
    this is of fourth order."""
    cases = falls = 0
    for _ in range(12 * min(TORTURE, 20)):
        box = random_prisms(np, generator)
        size, lefts = box.size, []
        known = [(k, Fraction(phase)) for k, phase in box.shape.waves]
        draw = np.random.default_rng(generator.getrandbits(64))
        n = draw.uniform(-1, 1, (4, 2, 2 * size)) * draw.uniform(0.3, 1)
        for shrink in (2.0 ** -4, 2.0 ** -5):
            width = shrink / (abs(box.ends[:, -2:, :size]).max(axis=(0, 1)) + 2.0 ** -99)
            prisms = check.Prisms(([x[:, :size] for x in box.turns], box.h[..., :size] * width,
                                   0 * box.W[:, :size], box.first[0][:, :size],
                                   box.ends[..., :size] * width, np.zeros((2, size))), box.shape,
                                  box.before[0][:, :size], box.l[:size])
            with np.errstate(all="ignore"):
                assert all(prisms.follow())
            if len(prisms.sites) < 4:
                break
            prisms.test_vectors = lambda: ([v * site[0] for v, site in zip(n, prisms.sites)]
                                        + [0 * n[0]] * (len(prisms.sites) - 4), tails)
            tails = [0 * box.l] * len(prisms.sites)
            value, form, _, error = prisms.expand()
            whole = prisms.sites[3][0][:size] & prisms.sites[3][0][size:]
            lefts.append(np.where(whole, error, math.nan))
            for lane in range(size):
                if not whole[lane] or error[lane] > 1:
                    continue
                eta, abc, angles = inside(generator, prisms, lane)
                true = left_side(known, abc, true_orbit(known, abc, angles, 4), n, tails, mp.mpf(0),
                                 lane, size)
                found = real(Fraction(float(value[lane]))) + sum(
                    real(Fraction(float(x[lane])) * math.prod([eta[k] for k in key]))
                    for key, x in form.items())
                assert true - found <= error[lane] and found - true <= 30 * error[lane]
                cases += 1
        if len(lefts) == 2:
            fourth = (lefts[1] > 1e-9) & (lefts[0] > 0)
            assert (lefts[0] > 12 * lefts[1])[fourth].all()
            falls += fourth.sum()
    assert cases > 100 * TORTURE and falls > 20 * TORTURE


@pytest.mark.quick
def test_cells_of_a_wide_range_are_checked_in_doubles(np, texts, generator):
    """Those whose amplitudes are small; and their amplitudes are as true as others'."""
    claim = claim_of(with_tree(texts["trig278"], "P"))
    for wide in Fraction(10) ** 9, Fraction(2) ** 51:
        claim = dataclasses.replace(claim, waves=tuple([dataclasses.replace(
            wave, middle=wide / 2 + Fraction(1, 3), parts=(-wide / 2, *wave.parts[1:]))
            for wave in claim.waves]))
        fast, cuts = check.Lockstep([claim]), math.ceil(math.log2(wide))
        last = (1 << cuts) - 1
        small, large = [((0, 0, index, 0, 0, 0), (0, 0, cuts, 0, 0, 0)) for index in (last, 0)]
        *_, kept = fast.pieces_of([(0, large), (0, small)], [0.5, 0.5])
        assert kept.tolist() == [1]
        for n in range(20):
            at = (0, 0, last - n, 0, 0, 0), small[1]
            (most, rest, rounded), h, W, *_ = fast.box(*cells_of([at]), np.zeros(1, int))
            for wave in claim.examined:
                w = fast.shape.waves.index((wave.k, wave.phase % 2))
                turns = Fraction(int(most[w, 0]), 1 << 38) + Fraction(float(rest[w, 0])) * (1 << 26)
                assert abs(turns - Fraction(float(rounded[w, 0]))) <= abs(turns) / (1 << 53)
                assert abs(real(wave.over(at)[0]) - 2 * mp.pi * real(turns)) <= W[w, 0] / 2


@pytest.mark.quick
def test_a_frame_counts_with_its_entries(np, texts):
    """Where v0 and v1 lose nearly a unit each, x[1] loses as many as its frame has."""
    v = 1 + (1 - Fraction(1, 1 << 40)) / (1 << 63)
    claim = dataclasses.replace(claim_of(with_tree(texts["trig278"], "P")), frame=(60, 1, -1, 60),
                                centre=(v, v), half=(Fraction(0), Fraction(0)))
    cell = np.zeros((6, 1), np.int64)
    *_, X, _, off = check.Lockstep([claim]).box(cell, cell, np.zeros(1, int))
    for x, found, allowed in zip(in_frame(claim.frame, claim.centre), X[:, 0], off[:, 0]):
        gap = (x / 2 - Fraction(int(found), 1 << 64) + Fraction(1, 2)) % 1 - Fraction(1, 2)
        assert 50 < abs(gap) * (1 << 64) < 2.0 ** 64 * float(allowed) / (2 * math.pi)


@pytest.mark.quick
def test_inverses_of_a_step_count_with_their_roundings(np, generator):
    """M is not quite the inverse of d: what is left times the rests of the site before is in f."""
    d = np.array([[generator.uniform(1, 3), generator.uniform(-1, 1), generator.uniform(1.1, 3)]
                  for _ in range(200)]).T
    rests, none = np.ones((2, 200)), np.zeros((2, 200))
    f, M, _ = check.next_rest(d, none, none, rests, none, np.zeros((3, 200)))
    for k in range(200):
        (p, q, r), (m, n, o) = [[Fraction(float(x)) for x in a[:, k]] for a in (d, M)]
        left = abs(1 - m * p - n * q) + abs(m * q + n * r), \
            abs(n * p + o * q) + abs(1 - n * q - o * r)
        assert all(x <= Fraction(float(y)) for x, y in zip(left, f[:, k]))


@pytest.mark.quick
@pytest.mark.parametrize("rows", (1, 2, 3))
def test_inverses_of_a_step_count_as_step_c15_has_it(np, generator, rows):
    """|I - M d| is bounded by 5 u |1/det| times the products of cofactors and d without signs, and
    by 6 u |1/det| times the determinant without signs."""
    i, j = np.triu_indices(rows)
    for width in 0, 0.3:
        d = np.array([(a == b) * 2 + width * generator.uniform(-1, 1) for a, b in zip(i, j)])
        matrix = np.empty((rows, rows))
        matrix[i, j] = matrix[j, i] = d
        rests, none = np.array([[generator.uniform(0, 1)] for _ in i[:rows]]), np.zeros((rows, 1))
        f, _, det = check.next_rest(d[:, None], none, none, rests, none, np.zeros((len(d), 1)))
        some = np.empty((rows, rows))
        some[i, j] = some[j, i] = check.cofactors(abs(d), 1)
        least = 5 * some @ abs(matrix) @ rests + 6 * (abs(matrix[0]) @ some[0]) * rests
        assert (f >= least * (2.0 ** -53 * (1 - 1e-9) / abs(det))).all()


@pytest.mark.quick
def test_cells_too_fine_for_doubles_are_left_to_the_integers(np, texts):
    fast, asked = check.Lockstep([claim_of(with_tree(texts["trig278"], "P"))]), []
    cell = (0,) * 6, (check.FAST_CUTS_MAX + 1, 0, 0, 0, 0, 0)
    refused, pieces = fast.settle([(0, cell)], [0.9],
                                  lambda n: (asked.append(n), ("it may be positive", 7))[1])
    assert asked == [0] and refused == (0, "it may be positive") and pieces == [7]


@pytest.mark.quick
def test_sines_of_a_step_count_with_their_roundings(np, texts, monkeypatch):
    seen, bending = [], check.bending
    monkeypatch.setattr(check, "bending", lambda P, H, W, s, c, *others: (
        seen.append((s, c)), bending(P, H, W, s, c, *others))[1])
    prisms = prisms_of(claim_of(with_tree(texts["trig278"], "P")))
    prisms.step()
    (site,), (allowed,) = prisms.sites, seen
    for exact, bound in zip((site.s, site.c), allowed):
        assert (bound >= np.abs(exact) + 23 * check.UNIT * prisms.shape.K[:, None]).all()


@pytest.mark.quick
def test_lockstep_corners(np, texts, generator, monkeypatch):
    """Corners of cells, wide or narrow, are those of the box within W and the error of x[1]: also
    of a wave that a claim names 16 times, and of parts that have 64 bits and signs."""
    monkeypatch.setattr(check, "in_turns", lambda units: (units,) * 3)
    claim = claim_of(with_tree(texts["trig274"], "P"))
    for _ in range(100):
        def some(count, size=1):
            size *= Fraction(10) ** generator.choice((0, -3, -10, -20, -40, -400))
            return tuple([near(generator) * size for _ in range(count)])

        amplitudes = some(generator.choice((1, 16)))
        parts = generator.choice((some(3), tuple([Fraction(n, 10 ** 11) for n in (7, -1, 0)])))
        claim = dataclasses.replace(
            claim, waves=tuple([check.Wave((1, 0), Fraction(1, 3), p, parts) for p in amplitudes]),
            centre=some(2, 9), half=tuple(map(abs, some(2))), frame=generator.choice(FRAMES),
            shifts=generator.choice(((), (some(2), some(2), some(2)))))
        if not claim.examined:
            continue
        other = dataclasses.replace(claim, frame=check.IDENTITY, shifts=(), waves=tuple([
            check.Wave(k, ZERO, Fraction(1), (ZERO,) * 3) for k in ((0, 1), (1, 1))]))
        q, cell = generator.randrange(2), random_cell(generator, claim, 52)
        fast = check.Lockstep([claim, other] if q == 0 else [other, claim])
        (units, _, _), h, W, X, columns, off = fast.box(*cells_of([cell]), np.full(1, q))
        corner = [generator.choice((-1, 1)) for _ in range(6)]
        along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, corner)]
        turns = in_frame(claim.frame, [c + v * t + s for c, v, t, s in zip(
            claim.centre, claim.half, along, moved_by(claim, along))])
        w, signs = fast.shape.waves.index(((1, 0), Fraction(1, 3))), [
            corner[axis] for axis in fast.axes]
        assert np.count_nonzero(W) == 1                 # no wave of the other claim
        amplitude = real(sum([wave.at(along[2:]) for wave in claim.examined]))
        pairs = [(amplitude, units[w, 0], check.AMPLITUDE_BITS, h[w], W[w, 0])]
        pairs += zip([mp.pi * real(x) for x in turns], X[:, 0], (64, 64), columns, off[:, 0])
        for true, found, bits, moved, error in pairs:
            gap = true - 2 * mp.pi * int(found) / mp.mpf(2) ** bits - sum(
                [mp.mpf(float(x)) * e for x, e in zip(moved[:, 0], signs)])
            assert abs(gap - 2 * mp.pi * mp.nint(gap / (2 * mp.pi))) <= error


@pytest.mark.quick
def test_lockstep_xstar(np, texts, generator):
    for _ in range(20):
        text = with_field(with_tree(texts["trig274"], "P"), "xstar", "%s %s" % tuple(
            check.decimal_text(exact_decimal(generator, size, 25)) for size in (1000, 3)))
        claim = claim_of(text)
        fast = check.Lockstep([claim])
        for x, units in zip(claim.xstar, fast.xstar[:, 0]):
            off = (real(x) - 2 * mp.pi * mp.mpf(int(units)) / 2 ** 64 + mp.pi) % (2 * mp.pi) - mp.pi
            assert abs(off) <= check.WHOLE_ERROR


def contradicts(abc, x0, x1, steps):
    """Is the second variation along an orbit not positive definite?  In doubles, and if these say
    that it is, with many digits."""
    return not definite(abc, x0, x1, steps, math) or not definite(
        [mp.mpf(x) for x in abc], [mp.mpf(x) for x in x0], [mp.mpf(x) for x in x1], 2 * steps)


def test_nothing_that_minimizes_is_excluded(np, texts, generator):
    """Cells at the edge of what can be proved, of true and of false claims: wherever the fast path
    alone excludes a cell, no orbit of it minimizes."""
    cases = excluded = open_ones = 0
    while cases < 1000 * min(2 * TORTURE - 1, 50):
        scale = generator.choice(("0.1", "0.14", "0.16", "0.2", "0.3"))
        a, b, c = (Fraction(scale) * Fraction(generator.randint(50, 110), 100) * k
                   for k in (1, 1, 2))
        text = with_field(with_tree(texts["trig274"], "P"), "together",
                          generator.choice(("yes", "no")))
        width = Fraction(1, 10 ** generator.randint(2, 5))
        claim = claim_of(with_parameters(text, *((x, width * x) for x in (a, b, c))))
        criterion = check.Criterion(claim)
        fast = check.Lockstep([claim])
        cells = []
        for _ in range(256):
            most = generator.randint(3, 11)
            slices = [(generator.randrange(1 << k), k) for k in (most, most)] + [
                (generator.randrange(1 << k), k) for k in [generator.randint(0, 3)] * 3] + [(0, 0)]
            if claim.parameters == 1:
                slices[3:] = [(0, 0)] * 3
            cells.append(tuple(zip(*slices)))
        l = np.array([check.least_in_double(criterion, cell) for cell in cells])
        proved, _ = fast.attempt(*cells_of(cells), np.zeros(len(cells), int), l,
                                  check.SITE_PENALTIES[0])
        for cell, good in zip(cells, proved):
            cases += 1
            excluded += bool(good)
            amplitudes, v = random_point(generator, claim, cell)
            fails = contradicts([float(x) for x in amplitudes], [float(x) for x in claim.xstar],
                                [float(x) * math.pi for x in v], 25) \
                if good or cases % 8 == 0 else None
            assert fails or not good
            open_ones += fails is False
    assert excluded > cases / 10 and open_ones > cases / 200


@pytest.mark.quick
def test_numbers_that_are_none_prove_nothing(np, generator):
    for bad in (math.nan, math.inf, 1e300):
        for part, row in itertools.product(range(5), range(3)):
            if part > 2 and (row == 2 or bad == 1e300):
                continue                            # two angles; and large ones are no harm
            prisms = random_prisms(np, generator)
            while prisms.shape.count < 2 or part == 1 and not any(prisms.shape.moving):
                prisms = random_prisms(np, generator)
            most, rest, *box, X = [x[..., :prisms.size].copy() for x in (
                *prisms.turns, prisms.h, prisms.W, prisms.ends, prisms.rounding, prisms.first[0])]
            if part == 1:
                w = generator.choice([w for w, m in enumerate(prisms.shape.moving) if m])
                box[part][w, prisms.shape.moving[w][0]] = bad
            else:
                box[part][row % 2 if part < 3 else row] = bad
            with np.errstate(all="ignore"):
                rounded, h, W, columns, off = box
                prisms = check.Prisms(((most, rest, rounded), h, W, X, columns, off),
                                      prisms.shape, prisms.before[0][:, :prisms.size],
                                      prisms.l[:prisms.size])
                all(prisms.follow())
                bound, _ = prisms.bound()
            assert not (bound < 0).any()


def test_both_paths_agree(np, deep, run):
    """They confirm, and do not confirm, the same theorem; and halve few leaves.  (Of smaller files
    this is seen in test_parts.py.)"""
    results = []
    for options in ((), ("--exact",)):
        status, out, _ = run(deep, *options)
        results.append((status, out.partition("\nChecker")[0]))
        pieces = int(re.search("in ([0-9]+) pieces", out).group(1))
        assert 200 < tree_of(deep).count("P") <= pieces < 1.1 * tree_of(deep).count("P")
        assert run(sealed(with_field(deep, "xstar", "1.2 1.2")), *options)[0] == 5
    assert results[0] == results[1] and status == 0


@pytest.mark.parametrize("blame, halved, axis", [
    ([0.5, 1.0, 0.2], [0, 0, 0], 1), ([0.5, 1.0, 0.2], [0, 4, 0], 1),
    ([0.5, 1.0, 0.2], [1, 5, 0], 2), ([0.5, 1.0, 0.2], [0, 5, 1], 0),
    ([2.0 ** -31, 1.0, 0.0], [0, 9, 0], 1),
    ([2.0 ** -30, 1.0, 0.0], [0, 9, 0], 0), ([math.nan, 1.0], [9, 0], 0), ([0.0, 0.0], [0, 9], 0)])
def test_the_axis_that_is_halved(blame, halved, axis):
    """One that was halved far less often has its turn, if it matters."""
    assert check.worst_axis(blame, halved) == axis


def test_without_numpy(texts, run, monkeypatch):
    for module, why in ((None, "numpy is not installed"), ("rounds", "does not round")):
        if module is None:
            monkeypatch.setitem(sys.modules, "numpy", None)
        else:
            monkeypatch.undo()
            monkeypatch.setattr(check, "import_numpy_if_sound", lambda: False)
        status, out, err = run(texts["trig278"])
        assert status == 0 and why in err and err.count("\n") == 1
        assert "Method : Loewner criterion, multipliers, in integers" in out
    monkeypatch.undo()
    status, out, err = run(texts["trig278"], "--exact")
    assert (status, err) == (0, "") and "in doubles" not in out
    status, out, err = run(texts["trig278"])
    assert (status, err) == (0, "") and "in doubles" in out


@pytest.mark.quick
def test_the_fast_path_looks_at_the_machine(np, monkeypatch):
    class Other:
        """numpy, but for one thing."""
        def __getattr__(self, name):
            return getattr(np, name)

    class Flushing(Other):
        def array(self, values, *rest):
            found = np.array(values, *rest)
            if found.size == 9:
                found[:] = 0
            return found

    class Truncating(Other):
        @staticmethod
        def rint(x):
            return np.trunc(x)

    for other in (Flushing(), Truncating()):
        monkeypatch.setitem(sys.modules, "numpy", other)
        assert not check.import_numpy_if_sound()
    monkeypatch.undo()
    assert check.import_numpy_if_sound()


def test_long_orbits_are_followed_fewer_at_a_time(np, root, tmp_path, monkeypatch):
    prove(read_input(root / "inputs" / "standard-63-64.in"), method="loewner").save(tmp_path / "a")
    claim = check.read(tmp_path / "a")
    monkeypatch.setattr(check, "MEMORY_MAX", 200000)
    criterion = check.Criterion(claim)
    fast = check.Lockstep([claim])
    cells = [(0, cell) for at, cell in check.leaves(claim.tree) if claim.tree[at] == "P"]
    least = [check.least_in_double(criterion, cell) for _, cell in cells]
    refused, pieces = fast.settle(cells, least, lambda n: ("not by the fast path", 0))
    assert refused is None and fast.batch < check.BATCH and min(pieces) == 1


def test_processes_share_the_memory_of_two(np, root, tmp_path, monkeypatch):
    prove(read_input(root / "inputs" / "standard-63-64.in"), method="loewner").save(tmp_path / "a")
    monkeypatch.setattr(check, "FAST_CHUNK", (50, check.FAST_CHUNK[1]))     # 135 leaves
    seen = []

    def record(call, chunks, jobs):
        seen.append((jobs, call.__self__.fast.memory))
        yield from map(call, chunks)

    monkeypatch.setattr(check, "mapped", record)
    for jobs in (1, 2, 9):
        assert check.verify(tmp_path / "a", jobs=jobs)
    assert seen == [(1, check.MEMORY_MAX), (2, check.MEMORY_MAX), (3, 2 * check.MEMORY_MAX // 3)]


@pytest.mark.skipif(TORTURE <= 1, reason="minutes; make torture has it")
def test_the_standard_map_nearest_to_break_up(np, root, tmp_path):
    """Orbits of 18,621 points: whole, and in doubles alone, where the integers would take days."""
    proof = prove(read_input(root / "inputs" / "standard-9717.in"), method="loewner")
    proof.save(tmp_path / "a")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check.Criterion, "excluded", lambda *_: ("not in doubles", 0))
        result = check.verify(tmp_path / "a")
    assert result and "\na = 0.9717\n" in result.text
    assert "Proved leaves checked : %d, " % proof.counts.proved in result.text
