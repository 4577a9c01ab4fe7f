"""Proved orbits against an independent truth.

The truth: the map alone, iterated with mpmath, its orbits found by shooting, their exponents from
the derivative of the map; potentials written anew; Hessians of copies by Bloch's waves in numpy.
"""

import math
import re
import signal
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat, ctx, fmpq
from sums import fourier, named

from converse import ConverseError, orbits
from converse.model.balls import precision
from converse.orbits import enclosure, proved
from converse.orbits.enclosure import Enclosure, law_of
from converse.orbits.exponents import growth
from converse.orbits.proved import NotProved, prove
from converse.orbits.solver import newton

from truth import TORTURE, mp, rng_for

# ---- potentials, anew: one-variable jets (f, f', f'') of waves, or of factors


def sine(x):
    s, c, w = mpmath.sin(2 * mpmath.pi * x), mpmath.cos(2 * mpmath.pi * x), 2 * mpmath.pi
    return s, w * c, -w * w * s


def cosine(x):
    return sine(x + mpmath.mpf(1) / 4)


def spline(x):
    x = x - mpmath.floor(x)
    if x <= 0.5:
        return 1 - 24 * x**2 + 32 * x**3, -48 * x + 96 * x**2, -48 + 192 * x
    return (9 - 48 * x + 72 * x**2 - 32 * x**3, -48 + 144 * x - 96 * x**2, 144 - 192 * x)


def polynomial(*factors):
    """Coefficients, highest first, of a product of polynomials."""
    product = [Fraction(1)]
    for factor in factors:
        product = [sum(product[i] * Fraction(factor[k - i]) for i in range(len(product))
                       if 0 <= k - i < len(factor)) for k in range(len(product) + len(factor) - 1)]
    return product


def jet(coefficients):
    def f(x):
        x, c, out = x - mpmath.floor(x), coefficients, []
        for _ in range(3):
            value = mpmath.mpf(0)
            for k in c:
                value = value * x + mp(k)
            out.append(value)
            c = [k * (len(c) - 1 - i) for i, k in enumerate(c[:-1])]
        return out
    return f


X0 = jet(polynomial((1, 0), (1, 0), (-1, 1), (-1, 1), (1, Fraction(-3, 4)), (-1, Fraction(1, 4))))
X1 = jet(polynomial((1, 0), (1, 0), (-1, 1), (-1, 1)))


def waves(parts):
    """V = sum of weight f(k.x): value, gradient, Hessian."""
    def V(x):
        n = len(x)
        value, gradient = mpmath.mpf(0), [mpmath.mpf(0)] * n
        hessian = [[mpmath.mpf(0)] * n for _ in range(n)]
        for weight, f, k in parts():
            f0, f1, f2 = f(sum(i * y for i, y in zip(k, x)))
            value += weight * f0
            for i in range(n):
                gradient[i] += weight * k[i] * f1
                for j in range(n):
                    hessian[i][j] += weight * k[i] * k[j] * f2
        return value, gradient, hessian
    return V


def poly(x):
    (f0, f1, f2), (g0, g1, g2) = X0(x[0]), X1(x[1])
    return (-4096 * f0 * g0, [-4096 * f1 * g0, -4096 * f0 * g1],
            [[-4096 * f2 * g0, -4096 * f1 * g1], [-4096 * f1 * g1, -4096 * f0 * g2]])


def trig_parts():
    M = mpmath.sqrt(207 + 33 * mpmath.sqrt(33)) / (8 * mpmath.sqrt(2))
    return [(-1 / (2 * M), sine, (1, 0)), (-1 / (2 * M), sine, (0, 1)), (-1 / M, sine, (1, 1))]


def three(f):
    quarter = mpmath.mpf(1) / 4
    return lambda: [(-quarter, f, (1, 0)), (-quarter, f, (0, 1)), (-2 * quarter, f, (1, 1))]


ODD = fourier({(1, 0): (Fraction(1, 3), Fraction(-1, 7)), (0, 1): (0, Fraction(2, 7)),
               (2, -1): (Fraction(1, 11), Fraction(1, 9))}, "odd")
# Short waves, whose amplitudes hardly matter and whose errors do.
NOISY = fourier({(k,): (Fraction(-1, 40 if k == 1 else 10**6), Fraction(k, 10**7))
                 for k in (1, 7, 8, 9, 10, 11, 12)}, "noisy")
OWN = {"odd": ODD, "noisy": NOISY}


def given(name):
    return OWN.get(name) or named(name)


V = {"trig": waves(trig_parts), "froeschle": waves(three(cosine)), "ff": waves(three(spline)),
     "poly": poly, "standard": waves(lambda: [(-1 / (4 * mpmath.pi**2), cosine, (1,))])}


def sum_of(source):
    return waves(lambda: [(mp(w), f, k[:source.dimension]) for k, *both in source.terms(0)
                          for (w, _), f in zip(both, (cosine, sine))])


V.update({name: sum_of(potential.sum) for name, potential in OWN.items()})

# ---- orbits, anew


def eps_of(state):
    return mpmath.mpf(repr(state.eps))


def exact_points(state, displacements):
    """x_j on the lifted orbit."""
    return [[mp(Fraction(o) + Fraction(j * p, state.q) + d)
             for o, p, d in zip(state.origin, state.p, u)] for j, u in enumerate(displacements)]


def shoot(state, x0, x1):
    """The true orbit next to these two points: its points, and DF^q with respect to (x_0, x_1)."""
    n, eps, potential = len(x0), eps_of(state), V[state.potential.name]
    z, last = list(x0) + list(x1), False
    for _ in range(60):
        points = [z[:n], z[n:]]
        rows = [[mpmath.mpf(i == k) for k in range(2 * n)] for i in range(2 * n)]
        tangents = [rows[:n], rows[n:]]
        for j in range(1, state.q + 1):
            _, gradient, bend = potential(points[j])
            points.append([2 * b - a - eps * g
                           for a, b, g in zip(points[j - 1], points[j], gradient)])
            tangents.append([[2 * tangents[j][i][k] - tangents[j - 1][i][k]
                              - eps * sum(bend[i][m] * tangents[j][m][k] for m in range(n))
                              for k in range(2 * n)] for i in range(n)])
        if last:
            return points[:state.q], mpmath.matrix(tangents[state.q] + tangents[state.q + 1])
        miss = [points[state.q + s][i] - state.p[i] - points[s][i]
                for s in (0, 1) for i in range(n)]
        M = mpmath.matrix(tangents[state.q] + tangents[state.q + 1])
        step = mpmath.lu_solve(M - mpmath.eye(2 * n), -mpmath.matrix(miss))
        z = [a + b for a, b in zip(z, step)]
        last = max(map(abs, step)) < mpmath.mpf(10) ** -(mpmath.mp.dps // 2)
    raise AssertionError("the truth did not converge")


def truth_indices(M):
    """s = l + 1/l of the eigenvalues l, 1/l of a symplectic matrix."""
    t = sum(M[i, i] for i in range(M.rows))
    if M.rows == 2:
        return [t]
    square = M * M
    e2 = (t * t - sum(square[i, i] for i in range(4))) / 2
    root = mpmath.sqrt(mpmath.mpc(t * t - 4 * (e2 - 2)))
    return [(t + root) / 2, (t - root) / 2]


def truth_exponents(M, q):
    sizes = []
    for s in truth_indices(M):
        root = mpmath.sqrt(mpmath.mpc(s * s - 4))
        sizes.append(max(abs(s + root), abs(s - root)) / 2)
    return sorted((mpmath.log(x) / q for x in sizes), reverse=True)


def truth_action(state, points):
    """Per point less |p/q|^2/2."""
    total = mpmath.mpf(0)
    for j, x in enumerate(points):
        after = points[j + 1] if j + 1 < state.q else [a + b for a, b in zip(points[0], state.p)]
        total += sum((b - a) ** 2 for a, b in zip(x, after)) / 2
        total -= eps_of(state) * V[state.potential.name](x)[0]
    return total / state.q - sum(mp(Fraction(p, state.q)) ** 2 for p in state.p) / 2


def blocks(state, points):
    """beta_j in floats."""
    with mpmath.workdps(30):
        return np.array([[[float((2 if i == k else 0) - eps_of(state) * h)
                           for k, h in enumerate(row)]
                          for i, row in enumerate(V[state.potential.name](x)[2])] for x in points])


def bottom(beta, waves=24):
    """The least eigenvalue of all copies: of Bloch's waves."""
    q, n = beta.shape[:2]
    least = np.inf
    for phase in np.pi * np.arange(waves + 1) / waves:
        H = np.zeros((q * n, q * n), complex)
        for j in range(q):
            here, after = slice(j * n, j * n + n), slice((j + 1) % q * n, (j + 1) % q * n + n)
            H[here, here] += beta[j]
            turn = np.exp(1j * phase) if j == q - 1 else 1.0
            H[here, after] -= turn * np.eye(n)
            H[after, here] -= np.conj(turn) * np.eye(n)
        least = min(least, np.linalg.eigvalsh(H)[0])
    return least


def inside(x, ends):
    return mp(ends[0]) <= x <= mp(ends[1])


def contains(orbit, near, digits):
    """Does the theorem hold of the true orbit that lies near these points?"""
    state = orbit.state
    with mpmath.workdps(digits):
        points, M = shoot(state, *near[:2] if state.q > 1 else (
            near[0], [x + p for x, p in zip(near[0], state.p)]))
        centre = exact_points(state, orbit.displacements)
        apart = mpmath.sqrt(sum((a - b) ** 2 for x, y in zip(points, centre) for a, b in zip(x, y)))
        assert apart <= mp(orbit.radius)
        assert inside(truth_action(state, points), orbit.action)
        for exponent, ends in zip(truth_exponents(M, state.q), orbit.exponents):
            assert inside(exponent, ends)
        indices = sorted(truth_indices(M), key=abs, reverse=True)
        assert (orbit.indices is None) == any(mpmath.im(s) != 0 for s in indices)
        for s, ends in zip(indices, orbit.indices or ()):
            assert inside(mpmath.re(s), ends)
        if M.rows == 2:
            assert inside((2 - indices[0]) / 4, orbit.residue)
    return points


CASES = [
    ("trig", (5, 7), 9, 0.03), ("trig", (10, 14), 18, 0.06), ("trig", (3, 4), 5, 0.01),
    ("trig", (1, 1), 2, 0.02), ("trig", (0, 0), 1, 0.02), ("trig", (-3, 2), 4, 0.02),
    ("ff", (5, 7), 9, 0.03), ("ff", (2, 3), 4, 0.012), ("ff", (0, 1), 1, 0.02),
    ("poly", (5, 7), 9, 0.03), ("poly", (3, 4), 5, 0.005), ("poly", (1, 0), 2, 0.02),
    ("froeschle", (5, 7), 9, 0.03), ("froeschle", (2, 2), 3, 0.01),
    ("standard", (5,), 13, 1.2), ("standard", (1,), 3, 0.3), ("standard", (1,), 2, 2.0),
    ("standard", (0,), 1, 0.7), ("standard", (2,), 5, -0.9), ("odd", (5, 7), 9, 0.01),
    ("odd", (1, 2), 3, -0.008), ("noisy", (1,), 3, 0.7), ("noisy", (3,), 7, 0.5),
]


def found(name, p, q, eps):
    potential = given(name)
    return orbits.straight(potential, p, q, tuple(x + 0.02 for x in potential.start)).relax(eps)


@pytest.mark.parametrize("case", CASES, ids=lambda case: "%s-%d-%s" % (case[0], case[2], case[3]))
def test_contains_the_true_orbit(case):
    state = found(*case)
    orbit = prove(state)
    assert orbit.label == "proved" and orbit.radius <= Fraction(1, 10**20)
    near = exact_points(state, [[Fraction(float(x)) for x in u] for u in state.u])  # of the doubles
    points = contains(orbit, near, 70)
    least = bottom(blocks(state, points))
    assert 0.9 * least < orbit.least <= least + 1e-13
    assert all(low >= 0 and high - low < high / 10**9 for low, high in orbit.exponents)
    assert orbit.moved < 1e-9
    assert all(0 <= x < 1 for point in orbit.points for x in point)


@pytest.mark.slow
def test_long_types():
    """Shooting needs more digits than an orbit grows by."""
    for name, p, q, eps, digits in (("trig", (65, 86), 114, 0.0125, 90),
                                    ("ff", (37, 49), 65, 0.02, 90),
                                    ("poly", (10, 62), 100, 0.01, 110)):
        orbit = prove(orbits.follow(named(name), p, q, [eps])[0])
        contains(orbit, exact_points(orbit.state, orbit.displacements), digits)
    orbit = prove(orbits.follow(orbits.trig, (1432, 1897), 2513, [0.0125])[0])
    assert orbit.radius < Fraction(1, 10**25) and 1.4e-6 < orbit.least < 1.6e-6
    assert [float(low) for low, _ in orbit.exponents] == pytest.approx([0.099222812, 0.001306122],
                                                                      rel=1e-7)


@pytest.mark.slow
def test_far_below_doubles():
    """Where the least eigenvalue is below the rounding of doubles, phases and all."""
    orbit = prove(orbits.follow(orbits.trig, (65, 86), 114, [0.004])[0])
    assert 0 < orbit.least < 1e-11 and orbit.radius <= Fraction(1, 10**20)
    contains(orbit, exact_points(orbit.state, orbit.displacements), 120)


def test_more_digits():
    state = found("trig", (5, 7), 9, 0.03)
    coarse, fine = prove(state, digits=5), prove(state, digits=60)
    assert coarse.radius <= Fraction(1, 10**5) and fine.radius <= Fraction(1, 10**60)
    apart = sum((a - b) ** 2 for x, y in zip(coarse.displacements, fine.displacements)
                for a, b in zip(x, y))
    assert apart <= (coarse.radius + fine.radius) ** 2
    for wide, narrow in zip((coarse.action,) + coarse.exponents, (fine.action,) + fine.exponents):
        assert wide[0] <= narrow[0] <= narrow[1] <= wide[1]


# The mirror image of what has its signs the other way: so what is cut off x makes it look steeper.
COMPLEX = orbits.PeriodicOrbit(named("poly"), (-1, -4), 4, 0.2547, [
    [0.13872656450355808, 0.23636730472985026], [0.11127343549644189, 0.2363673047298503],
    [0.1323984999421461, 0.0435489119315375], [0.11760150005785408, 0.0435489119315374]], (0, 0))


TURNED = orbits.PeriodicOrbit(named("poly"), (1, 0), 6, 0.1336, [
    [0.1115, -0.3125], [0.0165, -0.236], [0.0461, -0.0711], [0.1206, -0.0711], [0.1502, -0.236],
    [0.0552, -0.3125]], (0, 0))


def test_complex_exponents_are_equal():
    """The second pair is hardly complex any more: at eps 0.1251 it is real."""
    for state in (COMPLEX.relax(), TURNED.relax(0.12507)):
        orbit = prove(state)
        assert orbit.exponents[0] == orbit.exponents[1]
        contains(orbit, exact_points(orbit.state, orbit.displacements), 60)
    orbit = prove(TURNED.relax(0.1251))
    assert orbit.exponents[0][0] > orbit.exponents[1][1]
    contains(orbit, exact_points(orbit.state, orbit.displacements), 60)


def test_negative_multipliers():
    """The unstable bundle turns by half a turn along the orbit."""
    orbit = prove(TURNED.relax())
    points = contains(orbit, exact_points(orbit.state, orbit.displacements), 60)
    product = np.eye(2)
    for d in pivots(blocks(orbit.state, points)):
        product = d @ product
    assert max(np.linalg.eigvals(product)) < 0 and orbit.sign == -1
    assert all(high - low < high / 10**9 for low, high in orbit.exponents)


# ---- what must not be proved


def test_saddles():
    lowest = {"trig": (0.1489578, 0.1489578), "poly": (0.5, 0.5), "ff": (0.0, 0.0),
              "standard": (0.0,)}
    for name, p, q in (("trig", (0, 0), 1), ("trig", (1, 1), 2), ("poly", (0, 1), 1),
                       ("ff", (1, 0), 2), ("standard", (1,), 3), ("standard", (1,), 1)):
        potential = named(name)
        state, _ = newton(orbits.straight(potential, p, q, lowest[name]), 0.03)
        assert state.least < -1e-6
        for copies in (1, 2):
            with pytest.raises(NotProved, match="saddle"):
                prove(state.repeat(copies))


def minimax(p, q, k):
    """The orbit between the minima of the standard map."""
    begin = orbits.straight(orbits.standard, (p,), q, (0.5 + 0.5 / q,))
    return newton(replace(begin, eps=k))[0]


# The eigenvalues are too small for relax(), and not for the label.
@pytest.mark.parametrize("p, q, k", [(-2, 5, 0.04460940551965372), (1, 5, 0.0345), (3, 7, 0.0766),
                                     (-2, 3, 0.0035)])
def test_a_saddle_is_proved_to_be_nothing_else(p, q, k):
    state = minimax(p, q, k)
    assert state.label == "saddle" and -1e-8 < state.least < -1e-12
    with pytest.raises(NotProved, match="the state is a saddle"):
        prove(state)


@pytest.mark.parametrize("name, p, origin",
                         [("standard", (0,), (0.0,)), ("ff", (0, 0), (0.0, 0.0))])
def test_a_saddle_whose_gradient_is_exactly_zero(name, p, origin):
    state = replace(orbits.straight(named(name), p, 1, origin), eps=1e-10)
    assert state.label == "saddle" and not state.gradient.any()
    with pytest.raises(NotProved, match="the state is a saddle"):
        prove(state)


def test_minimum_that_copies_lose():
    """Its own Hessian is positive definite, but not that of two copies."""
    state = orbits.PeriodicOrbit(named("poly"), (6, 0), 7, 0.0829, [
        [0.09001452930093247, 0.22129605034580752], [0.05284261355621051, 0.22129605034580754],
        [0.10321553783195166, 0.17508214209550613], [0.10488570850555318, 0.0745211942219912],
        [0.07142857142857154, 0.03396091525211244], [0.0379714343515899, 0.07452119422199109],
        [0.039641605025191325, 0.17508214209550604]], (0.0, 0.0)).relax()
    beta = blocks(state, exact_points(state, [[Fraction(float(x)) for x in u] for u in state.u]))
    assert state.least > 0.05 and bottom(beta, 2) < -0.01
    with pytest.raises(NotProved, match="run through several times"):
        prove(state)
    with pytest.raises(NotProved, match="saddle"):
        prove(state.repeat(2))


def test_perturbed_states():
    state = found("trig", (5, 7), 9, 0.03)
    true = prove(state)
    rng = np.random.default_rng(1)
    for size in (1e-14, 1e-11, 1e-10, 1e-8, 1e-4, 0.3):
        other = state.moved(state.u + size * rng.uniform(-1, 1, state.u.shape))
        if size > 1e-9:
            with pytest.raises(NotProved, match="not stationary"):
                prove(other)
        else:
            orbit = prove(other)
            apart = sum((a - b) ** 2 for x, y in zip(orbit.displacements, true.displacements)
                        for a, b in zip(x, y))
            assert apart <= (orbit.radius + true.radius) ** 2 and orbit.moved < 1e-9
    for eps in (0.0300001, -0.03, 0.0, 1e-300, 1e300):
        with pytest.raises(NotProved, match="eps 0" if eps == 0 else "not stationary|saddle"):
            prove(replace(state, eps=eps))
    with pytest.raises(NotProved, match="not stationary"):
        prove(replace(state, p=(5, 8)))
    for u in (999.0, 3.7):
        with pytest.raises(NotProved, match="not stationary"):
            prove(state.moved(np.vstack([state.u[:4] + u, state.u[4:]])))
    for u in (1e300, math.nan, math.inf):
        with pytest.raises(ValueError, match="displacements are"):
            prove(state.moved(np.vstack([state.u[:4] + u, state.u[4:]])))


def test_flat():
    state = orbits.straight(orbits.standard, (1,), 3)
    with pytest.raises(NotProved, match="eps 0"):
        prove(state)
    flat = fourier({(1, 0): (1, 0)}, "flat")           # V does not depend on x_1
    with pytest.raises(NotProved, match="too flat"):
        prove(orbits.straight(flat, (1, 1), 2).relax(0.01), digits=1)
    for digits in (0, -1, 10**9):
        with pytest.raises(ValueError, match="digits must be a whole number"):
            prove(state, digits)
    assert issubclass(NotProved, ConverseError)


# ---- Ctrl-C

@pytest.mark.slow
@pytest.mark.parametrize("name, p, q", [("standard", (317,), 512), ("trig", (5, 7), 9)])
def test_ctrl_c_leaves_nothing_behind(name, p, q, monkeypatch):
    """Whatever round through the points it strikes in, all is as if nothing had been."""
    state = orbits.follow(named(name), p, q, [1.5 if len(p) == 1 else 0.03])[0]
    asked, last = 0, None

    def struck(function):
        def strike(*arguments):
            nonlocal asked
            asked += 1
            if asked == last:
                signal.raise_signal(signal.SIGINT)
            return function(*arguments)
        return strike

    for rounds in "evaluate", "_eliminate", "tube":
        monkeypatch.setattr(Enclosure, rounds, struck(getattr(Enclosure, rounds)))
    monkeypatch.setattr(ctx, "prec", 77)
    orbit = prove(state)
    assert ctx.prec == 77 and asked >= 12
    for last in range(1, asked + 1):
        asked = 0
        with pytest.raises(KeyboardInterrupt):
            prove(state)
        assert (ctx.prec, asked) == (77, last)
    last = None
    assert prove(state).report() == orbit.report()


def test_without_python_flint():
    """Orbits are found without it; a proof says what is missing, and the command in time."""
    code = ("import sys; sys.modules['flint'] = None\n"
            "from converse import ConverseError, orbits\n"
            "state = orbits.follow(orbits.standard, (1,), 3, [0.5])[0]\n"
            "try: orbits.prove(state)\n"
            "except ConverseError as error: print(error)\n"
            "from converse.commands.orbits import main\n"
            "sys.exit(main(['standard', '1/3', '0.5', '--prove']))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout.count("\n") == done.stderr.count("\n") == 1
    for said in done.stdout, done.stderr:
        assert "needs python-flint" in said and "pip install 'converse-kam[orbits]'" in said


def test_report():
    orbit = prove(found("trig", (5, 7), 9, 0.03))
    text = orbit.report()
    for part in ("THEOREM", "trig", "eps = 0.03 has exactly one orbit", "(5, 7)/9",
                 "nondegenerate local minimum", "Exponent : 0.354820971654982389",
                 " : -0.0030426956587949647"):
        assert part in text
    assert max(map(len, text.splitlines())) <= 110 and "proved" in orbit.label
    assert "\nV(x) = %s,\n" % orbits.trig.formula in text
    given = orbit.state.moved(orbit.state.u + [3e-10, -2e-10])
    assert re.search(r", which are within 3\.[01]e-10 of those given", prove(given).report())
    assert ", which are within 0 of those given" in replace(orbit, moved=0.0).report()
    assert "(5, 7)/9" in repr(orbit)


# ---- numbers one at a time


def test_exact_numbers():
    rng = rng_for("exact numbers")
    for _ in range(500):
        x = Fraction(rng.randrange(-10**30, 10**30)) * Fraction(2) ** rng.randrange(-200, 200)
        ctx.prec = 200
        try:
            assert enclosure.lower(enclosure.ball(x)) == enclosure.upper(enclosure.ball(x)) == x
            third = enclosure.ball(x / 3)
            assert enclosure.lower(third) <= x / 3 <= enclosure.upper(third)
            assert (enclosure.lower(third) < enclosure.upper(third)) == (x.numerator % 3 != 0)
        finally:
            ctx.prec = 53


def test_matrices():
    """inverse is one, of what is positive definite; norm bounds every matrix of a ball."""
    rng = rng_for("matrices")
    for _ in range(300):
        a, b, c = (Fraction(rng.randrange(-99, 100), rng.randrange(1, 9)) for _ in range(3))
        x = arb_mat(2, 2, [enclosure.ball(i) for i in (a, b, b, c)])
        turned = enclosure.inverse(x)
        assert (turned is None) == (a <= 0 or a * c <= b * b)
        if turned is not None:
            assert (x * turned).contains(arb_mat(2, 2, [1, 0, 0, 1]))
            assert (turned[0, 1] - turned[1, 0]).contains(arb(0))
        off = [Fraction(rng.randrange(5), 7) for _ in range(3)]
        wide = arb_mat(2, 2, [arb(i, r) for i, r in zip(x.entries(), map(enclosure.ball, (
            off[0], off[1], off[1], off[2])))])
        signs = [rng.choice((-1, 1)) for _ in range(3)]
        h = [float(i + s * r) for i, s, r in zip((a, b, c), signs, off)]
        size = np.abs(np.linalg.eigvalsh([[h[0], h[1]], [h[1], h[2]]])).max()
        assert size <= float(enclosure.norm(wide)) * (1 + 1e-12)


def test_potentials():
    """At points with junctions among them, in the balls, which are small."""
    rng = rng_for("potentials")
    for name, true in V.items():
        ours = given(name)
        for _ in range(40 * TORTURE):
            base = [Fraction(rng.choice([rng.randrange(97), 0, 97, 48]), 97) for _ in range(ours.n)]
            u = [rng.choice([rng.uniform(-1, 1), 0.0, 0.5, 0.25, -1e-30]) for _ in range(ours.n)]
            with precision():
                ctx.prec = 200
                local = law_of(ours, 60)
                found = local([fmpq(x.numerator, x.denominator) for x in base],
                              [arb(x) for x in u])
                found = [(enclosure.lower(x), enclosure.upper(x)) for x in found]
            with mpmath.workdps(70):
                value, gradient, h = true([mp(x + Fraction(y)) for x, y in zip(base, u)])
                for x, ends in zip([value, *gradient, *(h[i][j] for i in range(ours.n)
                                                        for j in range(i, ours.n))], found):
                    assert mp(ends[0]) - mpmath.mpf(10) ** -60 <= x
                    assert x <= mp(ends[1]) + mpmath.mpf(10) ** -60
                    assert ends[1] - ends[0] < Fraction(1, 10**50)


# ---- what is summed up, with so few places that roundings matter


def enclosed(state):
    return Enclosure(state, Fraction(repr(state.eps)))


@pytest.fixture
def few(monkeypatch):
    """Balls hardly better than an ulp."""
    monkeypatch.setattr(enclosure, "GUARD_BITS", 7)
    with precision():
        yield


def rough(rng):
    """A minimum, its displacements a little off, and so few places that every rounding counts."""
    case = rng.choice([case for case in CASES if case[2] > 1 and case[3] > 0.005]
                      + [COMPLEX, TURNED])
    if case not in FOUND:
        FOUND[case] = found(*case) if isinstance(case, tuple) else case.relax()
    state = FOUND[case]
    shake = np.random.default_rng(rng.randrange(2**32)).uniform(-1, 1, state.u.shape)
    origin = [rng.random() for _ in state.origin]           # with more places than there are
    state = replace(state, origin=origin, u=state.u + shake * 10 ** rng.uniform(-9, -3)
                    + np.array(state.origin) - origin)
    exact, places = enclosed(state), rng.randrange(10, 12)
    ours = state.potential
    # coefficients as little known as they may be
    if isinstance(ours, orbits.potential.Fourier):

        def widened(low, high, digits):
            wide, t = Fraction(1, 10**digits) - (high - low), rng.choice([0, 1])
            return (low - t * wide, high + (1 - t) * wide) if low or high else (low, high)

        exact.potential = SimpleNamespace(n=ours.n, coefficients=lambda digits: [
            (k, *(widened(*ends, digits) for ends in both))
            for k, *both in ours.coefficients(digits + 10)])
    exact.evaluate(places)
    return state, exact, places


FOUND = {}


@pytest.mark.slow
def test_few_places_state(few):
    rng = rng_for("few places: state")
    for _ in range(150 * TORTURE):
        state, exact, places = rough(rng)
        points = exact_points(state, exact.displacements())
        with mpmath.workdps(40):
            square = mpmath.mpf(0)
            for j, x in enumerate(points):
                before = points[j - 1] if j else [a - b for a, b in zip(points[-1], state.p)]
                after = (points[j + 1] if j + 1 < state.q
                         else [a + b for a, b in zip(points[0], state.p)])
                gradient = V[state.potential.name](x)[1]
                square += sum((2 * b - a - c - eps_of(state) * g) ** 2
                              for a, b, c, g in zip(before, x, after, gradient))
            size = mpmath.sqrt(square)
            assert size <= mp(exact.gradient) <= size + 10**6 * 10.0**-places
            assert inside(truth_action(state, points), exact.action)
            assert exact.action[1] - exact.action[0] < Fraction(10**6, 10**places)


@pytest.mark.slow
def test_few_places_least(few):
    """The largest m that is proved is below the truth, and hardly below it."""
    rng = rng_for("few places: least")
    for _ in range(120 * TORTURE):
        state, exact, places = rough(rng)
        points = exact_points(state, exact.displacements())
        least = bottom(blocks(state, points), 8)
        for above in (2e-14, 1.5e-10, 1e-9, 1e-8, 1e-6, 1e-3, 1.0):
            assert not exact.least(Fraction(least + above))
        assert exact.least(Fraction(least * 0.98 - 1e-6))


def test_the_least_eigenvalue_is_that_of_all_of_the_ball(monkeypatch):
    """Where the points are rough: it may be less by |eps| lipschitz radius than at the centre."""
    state, seen = found("standard", (1,), 3, 0.3), []

    def rough(state, exact, places, floor):
        exact.evaluate(places)
        exact.move([arb_mat(1, 1, ["1e-7"])] * state.q)
        exact.evaluate(places)

    def least(*arguments, real=proved._least):
        seen.append(real(*arguments))
        return seen[-1]

    monkeypatch.setattr(proved, "_refine", rough)
    monkeypatch.setattr(proved, "_least", least)
    with precision():
        orbit = proved._attempt(state, enclosed(state), growth, 30, 3)
    bend = Fraction("0.3") * Fraction(state.potential.lipschitz)
    assert orbit.radius > Fraction(1, 10**8)
    assert seen[0] / 2 < orbit.least <= seen[0] - bend * orbit.radius


def pivots(beta):
    """D_j of these blocks, from far above, in floats."""
    d, before = 1000 * np.eye(beta.shape[1]), None
    for _ in range(20000):
        out = []
        for b in beta:
            d = b - np.linalg.inv(d)
            out.append(d)
        if before is not None and np.abs(d - before).max() < 1e-15:
            return out
        before = d
    raise AssertionError("the pivots did not settle")


@pytest.mark.slow
def test_few_places_pivots(few):
    """Whatever blocks within `away` of the state's: their pivots' products lie where they must.
    The intervals are wider than the blur of so few places, far above the rounding of floats."""
    rng = rng_for("few places: pivots")
    kinds = set()
    for case in range(100 * TORTURE):
        state, exact, places = rough(rng)
        if case % 12 == 0:
            state, exact = COMPLEX, enclosed(COMPLEX)
            exact.evaluate(11)
        away = Fraction(rng.choice([0, 1e-9, 1e-6, 1e-5]))
        logs, sign = growth(exact, 2 * away + Fraction(1, 10**9), away)
        kinds.add(len(logs) == 2 and logs[0] == logs[1])
        assert state is not COMPLEX or logs[0] == logs[1]
        beta = blocks(state, exact_points(state, exact.displacements()))
        same, n = rng.choice([1, -1, 0]), beta.shape[1]
        for b in beta:
            s, c = math.sin(rng.uniform(0, 7)), math.cos(rng.uniform(0, 7))
            turn = np.array([[s, c], [c, -s]]) / math.hypot(s, c)
            b += float(away) * (same * np.eye(n) if same or n == 1 else turn)
        product = np.eye(n)
        for d in pivots(beta):
            product = d @ product
        values = np.linalg.eigvals(product)
        assert sign == 0 or (np.isreal(values).all() and (sign * values.real > 0).all())
        sizes = sorted(np.log(np.abs(values)), reverse=True)
        for size, (low, high) in zip(sizes, logs):
            assert low <= size <= high
    assert kinds == {True, False}


def rational(x):
    """A matrix of balls without radius as Fractions."""
    return [[enclosure.lower(i) for i in row] for row in x.tolist()]


def is_semidefinite(x):
    if len(x) == 1:
        return x[0][0] >= 0
    (a, b), (c, d) = x
    return a >= 0 and d >= 0 and b == c and a * d >= b * b


def turned(x):
    """The inverse, exactly."""
    if len(x) == 1:
        return [[1 / x[0][0]]]
    (a, b), (c, d) = x
    det = a * d - b * c
    return [[d / det, -b / det], [-c / det, a / det]]


@pytest.mark.slow
def test_few_places_certificates(few):
    """What below and above say holds exactly, for all matrices in the balls, however bad the guess
    where to begin, and however little room was left for roundings."""
    rng, given = rng_for("few places: certificates"), [0, 0]
    for _ in range(150 * TORTURE):
        _, exact, _ = rough(rng)
        away = Fraction(rng.choice([0, 1e-9, 1e-6]))
        m = 2 * away + Fraction(1, 10**9)
        exact.margin /= rng.choice([1, 1, 1, 10**3, 10**6])
        guess, off = exact.pivot_after_all, rng.choice([0, 0, 1, -1]) * 10 ** rng.uniform(-12, -3)
        exact.pivot_after_all = lambda shift: guess(shift) + enclosure.unit(exact.n, off)
        n, signs = exact.n, [1, -1]
        for which, tube in enumerate((exact.below(enclosure.ball(m)),
                                      exact.above(enclosure.ball(away), enclosure.ball(m)))):
            if tube is None:
                continue
            given[which] += 1
            tube = [rational(x) for x in tube]
            for j, x in enumerate(tube):
                beta, before = exact.beta[j], turned(tube[j - 1])
                centre, radius = rational(beta.mid()), [
                    [enclosure.upper(i.rad()) for i in row] for row in beta.tolist()]
                for d, e, f in ((d, e, f) for d in signs for e in signs for f in signs):
                    sign = [[d, e], [e, f]]
                    rest = [[(centre[i][k] + sign[i][k] * radius[i][k] - x[i][k] - before[i][k]
                              + (-m, away)[which] * (i == k)) * (1, -1)[which]
                             for k in range(n)] for i in range(n)]
                    assert is_semidefinite(x) and is_semidefinite(rest)
    assert min(given) > 50


def test_negative_blocks():
    """beta < 0 throughout, where pivots below zero repeat as well as others do above."""
    for name, p, q, eps in (("ff", (0, 0), 1, 0.5), ("ff", (0, 0), 2, 0.5),
                            ("standard", (0,), 1, 9.0)):
        state = orbits.straight(given(name), p, q, (0.0,) * len(p))
        exact, m = enclosed(replace(state, eps=eps)), Fraction(1, 10**5)
        with precision():
            exact.evaluate(30)
            assert not exact.bends(Fraction(0)) and not exact.least(m)
            assert growth(exact, m, m / 10) is None
