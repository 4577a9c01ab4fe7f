"""Random claims, prisms and cells of the checker's tests, and their true orbits with mpmath."""

import itertools
import math
import types
from fractions import Fraction

import mpmath
import pytest
from files import sealed

from checker import check
from trees import cells_of, with_field, with_parameters, with_tree

mp = mpmath.mp.clone()
mp.dps = 60
FIXED = {bits: check.Fixed(bits) for bits in (64, 96, 131)}


def near(generator, places=60):
    """A random number in [-1, 1], exact, often special."""
    return Fraction(generator.choice((generator.randint(-2 ** places, 2 ** places),
                                      generator.choice((-1, 0, 1)) << places)), 1 << places)


def real(x):
    return mp.mpf(x.numerator) / x.denominator


ZERO = Fraction(0)
TRIG = tuple((k, ZERO) for k in check.THESIS)       # k and phase of the thesis's waves
OTHERS = (((1, -1), ZERO), ((2, 1), Fraction(1, 3)), ((3, 0), Fraction(-7, 5)), ((0, 2), ZERO),
          ((1, 0), Fraction(1, 2)), ((-1, 4), Fraction(17, 12)), ((1, 1), ZERO), ((0, 1), ZERO),
          ((1, 0), ZERO), ((5, -3), Fraction(1, 7)))


def some_waves(generator):
    """(k, phase) of the thesis's waves, or of others."""
    return TRIG if generator.random() < 0.4 else tuple(
        generator.sample(OTHERS, generator.randint(1, 5)))


def angle_at(wave, y, m=mp):
    k, phase = wave
    turn = m.pi * real(phase) if m is mp else math.pi * float(phase)
    return sum(a * b for a, b in zip(k, y)) + turn


def v_prime(waves, amplitudes, y, m=mp):
    found = [0 for _ in y]
    for wave, p in zip(waves, amplitudes):
        c = p * m.cos(angle_at(wave, y, m))
        found = [x - k * c for x, k in zip(found, wave[0])]
    return found


def successor(waves, amplitudes, before, x, m=mp):
    return [2 * p - q - f for p, q, f in zip(x, before, v_prime(waves, amplitudes, x, m))]


def bent(waves, amplitudes, y, m=mp):
    """The entries of beta, row by row from the diagonal on."""
    b = [2 * (i == j) for i, j in check.pairs_of(len(waves[0][0]))]
    for wave, p in zip(waves, amplitudes):
        s = p * m.sin(angle_at(wave, y, m))
        b = [x - k * s for x, k in zip(b, check.entries(wave[0]))]
    return b


def in_form(b, n):
    return sum(x * m for x, m in zip(check.times(b, n), n))


def in_units(fixed, waves):
    return [(k, fixed.angle(phase)) for k, phase in waves]


FRAMES = (1, 0, 0, 1), (1, 1, -1, 0), (2, 1, 3, 2), (0, -1, 1, 0)


def in_frame(frame, v):
    """The frame, whose integers are row by row, times v."""
    return [sum(f * x for f, x in zip(frame[at:], v)) for at in range(0, len(frame), len(v))]


def exact_decimal(generator, size, places=9):
    return Fraction(generator.randint(-10 ** places, 10 ** places), 10 ** places) * Fraction(size)


def as_text(x):
    return check.decimal_text(Fraction(x))


def general(text, waves, v0=(1, 1), v1=(1, 1), frame=check.IDENTITY, alone="no", odd="no",
            at_once="no", tree=None, xstar=None):
    """A file of the rest of the text; waves: (k, phase, amplitude, parts)."""
    head, middle, rest = text.partition("\ntree:\n")
    lines = [line for line in head.split("\n")[1:] if line.partition(":")[0] not in (
        "v0", "v1", "at once", "wave", "frame", "alone", "odd about")]
    lines += ["wave: %d %d %s %s" % (*k, phase, " ".join(map(as_text, (p, *parts))))
              for k, phase, p, parts in waves]
    lines += ["v0: %s %s" % tuple(map(as_text, v0)), "v1: %s %s" % tuple(map(as_text, v1)),
              "frame: %d %d %d %d" % frame, "alone: " + alone, "odd about: " + odd,
              "at once: " + at_once]
    text = "\n".join(["converse proof 6", *lines]) + middle + rest
    if xstar:
        text = with_field(text, "xstar", "%s %s" % tuple(map(as_text, xstar)))
    return sealed(with_tree(text, tree) if tree else text)


def random_claim(generator, text, size=1, width=1, three=None):
    """Any parameters, one in four of them without width, and any region of angles: of the thesis's
    waves, or of any and a frame."""
    sides = [(exact_decimal(generator, 9), abs(exact_decimal(generator, width))
              * generator.choice((0, 1, 1, 1))) for _ in "01"]
    if three if three is not None else generator.random() < 0.6:
        waves, parts = some_waves(generator), generator.randint(0, 3)
        # Of a finite number of decimals, and the less the more the wave turns.
        return general(text, [(k, phase, exact_decimal(generator, size) / 2 ** sum(map(abs, k)),
                               [exact_decimal(generator, width) / 2 * generator.choice((0, 1, 1))
                                for _ in range(parts)]) for k, phase in waves],
                       *sides, generator.choice(FRAMES))
    for name, side in zip(("v0", "v1"), sides):
        text = with_field(text, name, "%s %s" % tuple(map(as_text, side)))
    text = with_parameters(text, *((exact_decimal(generator, size), abs(
        exact_decimal(generator, width)) * generator.choice((0, 1, 1, 1))) for _ in "abc"))
    return with_field(text, "together", generator.choice(("yes", "no")))


def random_slice(generator, most):
    k = generator.randint(0, most)
    return generator.choice((0, (1 << k) - 1, generator.randrange(1 << k))), k


def random_cell(generator, claim, most=40):
    slices = [random_slice(generator, most) for _ in range(2 + claim.parameters)]
    return tuple(zip(*slices + [(0, 0)] * (6 - len(slices))))


def waves_of(claim):
    return [(wave.k, wave.phase) for wave in claim.examined]


def random_point(generator, claim, cell):
    """Exact amplitudes and v0, v1 of a cell, often at its ends."""
    eta = [near(generator) for _ in range(6)]
    along = [Fraction(2 * i + 1 + e, 1 << k) - 1 for i, k, e in zip(*cell, eta)]
    return ([wave.at(along[2:]) for wave in claim.examined],
            [c + h * t for c, h, t in zip(claim.centre, claim.half, along)])


def moved_by(claim, along):
    """What the parameters add to v0 and v1."""
    return [sum([shift[i] * t for shift, t in zip(claim.shifts, along[2:])]) for i in (0, 1)]


def pairs_of(eta):
    """What the quadratic parts of orbits are coefficients of, in their order."""
    return [x * y - Fraction(i == j, 2) for (i, x), (j, y) in
            itertools.combinations_with_replacement(enumerate(eta), 2)]


def definite(amplitudes, x0, x1, steps, m=mp, waves=TRIG):
    """Is the second variation along the true orbit, steps to either side, positive definite?"""
    back, ahead = [x1, x0], [x0, x1]
    for _ in range(steps):
        for orbit in (back, ahead):
            orbit.append(successor(waves, amplitudes, *orbit[-2:], m))
    d = None
    for y in back[:0:-1] + ahead[1:]:
        p, q, r = bent(waves, amplitudes, y, m)
        if d:
            det = d[0] * d[2] - d[1] ** 2
            p, q, r = p - d[2] / det, q + d[1] / det, r - d[0] / det
        if p <= 0 or p * r <= q * q:
            return False
        d = p, q, r
    return True


def prisms_of(claim, l=0.9, cell=check.ROOT):
    """The prism of a cell, followed by nobody yet."""
    fast, number = check.Lockstep([claim]), check.np.zeros(1, int)
    return check.Prisms(fast.box(*cells_of([cell]), number), fast.shape, fast.xstar[:, number],
                        check.np.array([l]))


def true_orbit(waves, amplitudes, angles, count, m=mp):
    """count sites ahead and count back, x[1] and x[0] the first of them."""
    lanes = []
    for before, x in (angles, angles[::-1]):
        lane = [x]
        while len(lane) < count:
            before, x = x, successor(waves, amplitudes, before, x, m)
            lane.append(x)
        lanes.append(lane)
    return lanes


def highest(amplitudes, waves=TRIG, points=48, starts=4):
    """The largest eigenvalue over the torus, in doubles: on a grid, and on from its best points."""
    np, step = pytest.importorskip("numpy"), 2 * math.pi / points
    cosines = types.SimpleNamespace(pi=math.pi, sin=np.sin)

    def largest(y):
        p, q, r = bent(waves, amplitudes, y, cosines)
        return (p + r) / 2 + np.sqrt((p - r) ** 2 / 4 + q * q)

    y = np.stack(np.meshgrid(*[step * np.arange(points)] * 2)).reshape(2, -1)
    y = y[:, np.argsort(-largest(y))[:starts]]
    around = np.stack(np.meshgrid(*[np.arange(-2, 3) / 2] * 2)).reshape(2, 1, -1)
    for _ in range(25):
        near = y[:, :, None] + step * around
        best = largest(near).argmax(axis=1)
        y, step = near[:, np.arange(starts), best], step / 2
    return max(2, np.max(largest(y)))


def true_bound(abc):
    return highest(abc)
