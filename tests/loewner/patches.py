"""Patches of waves of any number of angles, as kernels take them, and the second truth about them:
their orbits and second variations with many digits."""

import itertools
import math
from fractions import Fraction
from types import SimpleNamespace

import mpmath

import kernels
from kernels import THESIS, arguments, thesis  # noqa: F401
from truth import mp

MOST = 4                                # waves of a kernel's potential
SITE, SHOWN, SITES = 83, 13, 60         # numbers of a point, points, and vectors of a kernel
PAIRS = [*itertools.combinations_with_replacement(range(5), 2)]         # the order of the bows
UNIT = Fraction(1, 2 ** 53)


def place(patch, e):
    """Amplitudes and x_1 at a point of the patch, by its symbols: of each v, then of the
    parameters."""
    n = len(patch.centre)
    p = [w[n + 1] + sum(t * g for t, g in zip(e[n:], w[n + 2:])) for w in patch.waves]
    v = [c + h * s + sum(x * t for x, t in zip(row, e[n:]))
         for c, h, s, row in zip(patch.centre, patch.half, e, patch.shifts)]
    return p, [sum(f * y for f, y in zip(patch.frame[n * i:], v)) for i in range(n)]


def inside(rng, patch):
    """A random exact point of the patch, often at its edge: symbols, amplitudes, x_1."""
    e = [Fraction(rng.choice([-1, 1, 0, rng.uniform(-1, 1)]))
         for _ in range(len(patch.centre) + 3)]
    return e, *place(patch, e)


def angles(patch, x, number=mp):
    n = len(x)
    return [sum(k * y for k, y in zip(w, x)) + number(w[n]) for w in patch.waves]


def orbit(patch, p, x1, first, last, number=mp):
    """The points first..last of the orbit through x* and x_1, by index."""
    x = {0: [*map(number, patch.xstar)], 1: [*map(number, x1)]}
    p, cos = [*map(number, p)], math.cos if number is float else mpmath.cos
    for j, here, before in (*((j + 1, j, j - 1) for j in range(1, last)),
                            *((j - 1, j, j + 1) for j in range(0, first, -1))):
        force = [q * cos(y) for q, y in zip(p, angles(patch, x[here], number))]
        x[j] = [2 * y - z + sum(w[i] * f for w, f in zip(patch.waves, force))
                for i, (y, z) in enumerate(zip(x[here], x[before]))]
    return x


def second_variation(patch, p, x, n, l, number=mp):
    """Q of the vectors n, by their sites, along an orbit."""
    sin, total = math.sin if number is float else mpmath.sin, number(0)
    p = [*map(number, p)]
    for j, u in n.items():
        total += (2 - number(l) * ((j == min(n)) + (j == max(n)))) * sum(y * y for y in u)
        total -= 2 * sum(y * z for y, z in zip(u, n.get(j + 1, ())))
        total -= sum(q * sin(y) * sum(k * z for k, z in zip(w, u)) ** 2 for w, q, y in
                     zip(patch.waves, p, angles(patch, x[j], number)))
    return total


def bounded(patch, s, t, signs):
    """The core's bound for the orbits from s to t, its l, and the vectors by their sites; None
    where these orbits cannot be followed, or there are no such vectors."""
    size = len(patch.centre)
    name = "waves_bound" + ("" if size == 2 else "_%d" % size)
    try:
        bound, l, first, count, _, *numbers = kernels.call(
            name, [*arguments(patch), s, t, signs], 5 + size * SITES, 20)
    except ArithmeticError:
        return None
    n = {int(first) + j: [*map(mp, numbers[size * j:][:size])] for j in range(int(count))}
    return (mp(bound), l, n) if n else None


def variations(rng, cases, draw):
    """Yields patch, the core's bound of the second variation with vectors of its own choice, and
    its true values along the orbits of three random points of the patch."""
    for _ in range(cases):
        patch, s, t = draw(rng), -rng.randrange(0, 5), rng.randrange(1, 6)
        found = bounded(patch, s, t, rng.randrange(2))
        if found:
            bound, l, n = found
            values = []
            for _ in range(3):
                _, p, x1 = inside(rng, patch)
                values.append(second_variation(patch, p, orbit(patch, p, x1, s, t), n, l))
            yield patch, bound, values


def radians(upper, lower):
    """Two angles that the core has as whole numbers."""
    return [2 * mpmath.pi * mp(kernels.turns(*halves)) for halves in zip(upper, lower)]


def modulo(x):
    return x - 2 * mpmath.pi * mpmath.nint(x / (2 * mpmath.pi))


def sites(patch, s, t, signs=1):
    """What the core knows of the points s..t of the orbits; None where they cannot be followed."""
    try:
        out = kernels.call("waves_sites", [*arguments(patch), s, t, signs], SITE * SHOWN, 20)
    except ArithmeticError:
        return None
    result, count = {}, 2 + MOST
    for j in range(s, t + 1):
        y = [mp(x) for x in out[SITE * (j - s):SITE * (j - s + 1)]]
        straight, bowed, off, reach = (y[44 + count * i:44 + count * (i + 1)] for i in range(4))
        rest = y[44 + 4 * count:]
        result[j] = SimpleNamespace(
            x=radians(y[:2], y[81:]), lin=(y[2:7], y[7:12]),
            quad=(y[12:27], y[27:42]), rem=y[42:44],
            lin_bound=straight, quad_bound=bowed, nonlin_bound=off, rad=reach,
            residual=rest[:2], force=rest[2:4],
            beta=rest[4:7], d=rest[7:10], err_beta=rest[10], mu=rest[11:13])
    return result


def axes_of(patch):
    """The axes in which remainders are bounded, of length 1: along k of the wave that bends most,
    and along k_perp."""
    k0, k1 = max((w for w in patch.waves if any(w[3:])), default=(1, 0, 1, 0), key=lambda w: (
        abs(w[3]) + sum(map(abs, w[4:]))) * (w[0] ** 2 + w[1] ** 2))[:2]
    length = mpmath.sqrt(k0 ** 2 + k1 ** 2)
    return (k0 / length, k1 / length), (-k1 / length, k0 / length)


def symbols(first, v, t=()):
    """Those of v0 and v1 for which the core's first point is v, where the parameters' are t: its
    sides are a little longer."""
    (a, b), (c, d) = (row[:2] for row in first.lin)
    x, y = (modulo(mp(end) - centre - sum(shift * mp(e) for shift, e in zip(row[2:], t)))
            for end, centre, row in zip(v, first.x, first.lin))
    result = [(d * x - b * y) / (a * d - b * c), (a * y - c * x) / (a * d - b * c)]
    assert all(abs(s) <= 1 for s in result)
    return result


def displacements(rng, cases, draw):
    """Yields patch, how far random points of random patches' orbits are from where columns and bow
    put them, along the axes of the largest wave; along the coordinates and the waves, from where
    the columns do, and from the centre's; and the core's bounds of these."""
    for _ in range(cases):
        patch = draw(rng)
        n = rng.choice([-1, 1]) * rng.randrange(1, 9)
        s, t = min(n, 0), max(n, 1)
        found = sites(patch, s, t)
        if not found or max(found[n].rad) > 3:
            continue
        q, (e, p, v) = found[n], inside(rng, patch)
        e = symbols(found[1], v, e[2:]) + [*map(mp, e[2:])]
        away = [modulo(y - near) for y, near in zip(orbit(patch, p, v, s, t)[n], q.x)]
        straight = [sum(c * s for c, s in zip(row, e)) for row in q.lin]
        bent = [sum(t * e[k] * e[l] for t, (k, l) in zip(row, PAIRS)) for row in q.quad]
        rest = [D - L - T for D, L, T in zip(away, straight, bent)]
        along = [(1, 0), (0, 1), *(w[:2] for w in patch.waves if any(w[3:]))]
        D, L = ([abs(i * x + j * y) for i, j in along] for x, y in (
            away, [a - b for a, b in zip(away, straight)]))
        yield patch, ([abs(i * rest[0] + j * rest[1]) for i, j in axes_of(patch)], L, D), (
            q.rem, q.nonlin_bound, q.rad)
