"""Where the methods of the orbits fail (thesis, section 2.2 and Appendix A), and that they say
so."""

import math
import runpy
import signal
import subprocess
import sys
import time

import mpmath
import numpy as np
import pytest
from conftest import ROOT
from sums import fourier

import converse
from converse import orbits
from converse._native import ffi, lib
from converse.orbits.pictures import exponent_text
from converse.orbits.potential import address
from converse.orbits.solver import newton

from truth import TORTURE

SPIRAL = ((1432, 1897), 2513)
flow = runpy.run_path(str(ROOT / "experiments" / "finders.py"))["flow"]


def moved(a, b):
    """The largest distance between the points of two states of one type."""
    return np.sqrt(((a.u - b.u) ** 2).sum(1)).max()


# ---- finding a state

@pytest.mark.parametrize("eps, far", [(0.0025, 1e-4), (0.0075, 0.005), (0.0125, 5e-4)])
@pytest.mark.slow
def test_gradient_flow_stops_far_from_the_orbit(eps, far):
    """A small gradient over a far smaller eigenvalue: the orbit is somewhere else along the soft
    direction.  What flow returns is not called stationary."""
    flowed, steps = flow(orbits.straight(orbits.trig, (151, 200), 265), eps)
    assert steps > 50 and flowed.grad_size <= 1e-6 and flowed.label == "not stationary"
    orbit = flowed.relax()
    assert orbit.label == "minimum" and moved(flowed, orbit) > far > 10 * flowed.shadow
    assert flowed.action == pytest.approx(orbit.action, abs=1e-7)       # which shows nothing
    unfinished, steps = flow(orbits.straight(orbits.trig, (151, 200), 265), eps,
                                    max_steps=20)
    assert steps == 20 and unfinished.grad_size > 1e-6


def test_newton_without_damping_finds_saddles_or_nothing():
    """Continued in small steps beyond 0.0075 it comes upon saddles and then diverges; from the same
    guess the damped one goes to a minimum.  No label is wrong: the Hessian's eigenvalues tell."""
    labels = set()
    for step in (0.0005, 0.0006, 0.0007):
        state = orbits.follow(orbits.trig, *SPIRAL, [0.0075])[0]
        while state.eps < 0.013 and "not stationary" != state.label:
            guess = state
            state, steps = newton(guess, round(guess.eps + step, 6))
            labels.add(state.label)
            if state.label == "saddle":
                assert state.shadow < 1e-12 and steps < 50
                assert state.least < -1e-12 or guess.repeat(2).least < -1e-12
                assert guess.relax(state.eps).label == "minimum"
            elif state.label == "minimum":
                assert state.least > -1e-12
        assert state.label == "not stationary" or state.eps >= 0.013
    assert labels >= {"saddle", "not stationary"}


def test_newton_at_the_start_of_poly():
    """There two eigenvalues of the Hessian are 0, and many are negative once eps is not: the first
    steps lead anywhere.  Points whose digits are gone are no state."""
    straight = orbits.straight(orbits.poly, (377, 2330), 3770)
    assert straight.undetermined == 2
    begun = orbits.PeriodicOrbit(orbits.poly, straight.p, straight.q, 0.0025, straight.u,
                                 straight.origin)
    assert begun.below(0) >= 2 and begun.least < -1e-3
    wild, _ = newton(straight, 0.0025)
    assert wild.label == "not stationary" and np.abs(wild.u).max() > 1
    with pytest.raises(ValueError, match="below 1000"):
        wild.moved(wild.u + 1e18)           # there V' rounds to the same everywhere, and L' to zero
    assert straight.relax(0.0025).label == "minimum"


@pytest.mark.slow
def test_cholesky_fails_while_the_torus_is_whole_and_the_pivots_do_not():
    """Two eigenvalues are zero but for rounding, which decides whether the Hessian is positive."""
    failed = 0
    p, q = (65, 86), 114
    for state in orbits.follow(orbits.trig, p, q, [0.0005, 0.001, 0.0015, 0.002, 0.0025, 0.003]):
        band = np.diag(np.tile([2.0], 2 * q))
        for j in range(q):
            a, b, c = state.blocks[j]
            band[2 * j:2 * j + 2, 2 * j:2 * j + 2] = [[a, b], [b, c]]
            for i in (0, 1):
                there = (2 * j + 2) % (2 * q) + i
                band[2 * j + i, there] = band[there, 2 * j + i] = -1
        try:
            np.linalg.cholesky(band)
        except np.linalg.LinAlgError:
            failed += 1
        assert state.label == "minimum" and state.undetermined == 2 and abs(state.least) < 1e-11
        assert state.exponents[0] < 1e-4
    assert failed


def test_phases_along_soft_directions_are_not_determined():
    """While the torus is whole the orbit may begin anywhere on it: other points, the same action to
    the last digit.  So for a gap further, where one eigenvalue is small."""
    for eps, soft in ((0.005, 2), (0.0085, 1)):
        state = orbits.follow(orbits.trig, *SPIRAL, [eps])[0]
        assert state.undetermined == soft
    state = orbits.follow(orbits.trig, *SPIRAL, [0.005])[0]
    other = orbits.straight(orbits.trig, *SPIRAL, (0.3, 0.1)).relax(0.0025).relax(0.005)
    apart = (state.x[:, None, :] - other.x[None, :200, :] + 0.5) % 1 - 0.5
    assert np.sqrt((apart ** 2).sum(2)).min(0).max() > 1e-4        # no point lies on one of these
    assert other.label == "minimum" and other.action == pytest.approx(state.action, abs=1e-15)
    assert orbits.follow(orbits.trig, *SPIRAL, [0.0125])[0].undetermined == 0


def test_a_direction_so_flat_that_nothing_is_known():
    """A saddle as flat as this is one if the gradient is zero; if not, the orbit may lie anywhere
    along it, and what is said is that this direction is not determined."""
    sure = orbits.PeriodicOrbit(orbits.standard, (0,), 1, 1e-9, [[0.0]], (0.0,))
    assert sure.label == "saddle" and sure.undetermined == 1
    flat = orbits.PeriodicOrbit(orbits.standard, (0,), 1, 1e-9, [[0.0]], (2e-3,))
    assert flat.label == "stationary" and flat.undetermined == 1
    state = orbits.follow(orbits.trig, *SPIRAL, [0.0075])[0]        # 1e-13, and -4e-11
    assert state.label == "minimum" and state.undetermined == 2


def test_a_minimum_whose_copies_are_none():
    """Eight points of poly, at least action among those of period 8, and beyond doubt; but run
    through twice there is a direction down; four times, and a minimum lies tenfold lower."""
    rng = np.random.default_rng(5)
    for _ in range(400):
        state = orbits.PeriodicOrbit(orbits.poly, (1, 8), 8, 0.0619, rng.uniform(-0.5, 0.5, (8, 2)),
                             orbits.poly.start).relax()
        if state.label == "saddle":
            break
    assert state.below(1e-3) == 0                   # all 16 eigenvalues are clearly positive
    twice = state.repeat(2)
    assert twice.least < -1e-3 and twice.label == "saddle"
    lower = state.repeat(4).relax()                 # which leaves the saddle
    assert lower.label == "minimum" and lower.action < state.action - 1e-4


def test_soft_directions_that_turn():
    """Why: three blocks soft along directions 60 degrees apart.  Once round, what came along the
    soft direction returns with its sign changed, as period 3 forbids and period 6 allows."""
    class Blocks(orbits.Potential):
        """V with gradient zero and the Hessian that makes beta_j at (j/3, j/3)."""
        def evaluate(self, x):
            angle = np.pi / 3 * np.rint(3 * x[:, 0])
            e = np.stack([np.cos(angle), np.sin(angle)], 1)
            return np.zeros(len(x)), np.zeros((len(x), 2)), (
                (2 - stiff) * np.eye(2) + (stiff - soft) * e[:, :, None] * e[:, None, :])

    for soft, stiff, label in ((0.85, 10, "saddle"), (1.6, 10, "minimum"), (1.6, 30, "minimum")):
        potential = Blocks("blocks", (0.0, 0.0), lib.CV_FF)
        state = orbits.PeriodicOrbit(potential, (1, 1), 3, 1.0, np.zeros((3, 2)), (0.0, 0.0))
        assert state.below(0) == 0 and state.label == label
        assert (state.repeat(2).least < 0) == (label == "saddle")
        if label == "minimum":      # DF^3 has complex eigenvalues, then two that are below -1
            assert state.exponents == pytest.approx(carried(state, 40), abs=1e-12)


def test_continuation_loses_the_minimum():
    """Above eps 0.02 other phases lead lower than continuation from the maximum of V; both are
    minima, and neither is called more.  At 0.01 all agree."""
    rng = np.random.default_rng(6)
    gained = {}
    for eps in (0.01, 0.04):
        for p, q in (((5, 7), 9), ((21, 28), 37)):
            followed, = orbits.follow(orbits.trig, p, q, [eps])
            others = [orbits.straight(orbits.trig, p, q, tuple(rng.uniform(size=2))).relax(eps)
                      for _ in range(40)]
            assert {state.label for state in (followed, *others)} == {"minimum"}
            gained[eps, q] = followed.action - min(state.action for state in others)
    assert max(abs(gained[0.01, q]) for q in (9, 37)) < 1e-12
    assert gained[0.04, 9] == pytest.approx(2.9475e-5, rel=1e-3) and gained[0.04, 37] > 5e-5


def test_it_leaves_a_saddle_for_the_lower_side():
    """From the least V of a skew potential both sides lead down, to the same maximum."""
    for skew in (0.3, -0.3):
        potential = fourier({(1,): (1, 0), (2,): (0, skew)}, "skew")
        axis = np.arange(10 ** 6)[:, None] / 10 ** 6
        low = axis[np.argmin(potential.evaluate(axis)[0])]
        saddle = newton(orbits.PeriodicOrbit(potential, (0,), 1, 0.01, [[0.0]], tuple(low)))[0]
        assert saddle.label == "saddle"
        left, right = potential.evaluate([low - 0.05, low + 0.05])[0]
        assert abs(left - right) > 0.01
        orbit = saddle.relax()
        assert orbit.label == "minimum" and (orbit.u[0, 0] > 0) == (right > left)


def test_no_step_is_longer_than_a_tenth():
    """Near an inflection of V Newton's step is longer than the torus."""
    state = orbits.PeriodicOrbit(orbits.standard, (0,), 1, 0.5, [[0.251]], (0.0,))
    wild, _ = newton(state, max_steps=1)
    assert abs(wild.u[0, 0] - 0.251) > 10
    how, u = ffi.new("cv_relaxed *"), np.array([[0.251, 0.0]])
    assert lib.cv_relax(orbits.standard.native, 1, 0.5, address(np.zeros((1, 2))), address(u),
                        -1, 1e-13, 1, how) == lib.CV_RUNNING
    assert how.steps == 1 and u[0, 0] == pytest.approx(0.351, abs=1e-12)
    assert state.relax().x[0, 0] == pytest.approx(0.5, abs=1e-12)


def test_no_state_is_said():
    state = orbits.straight(orbits.trig, (5, 7), 9)
    with pytest.raises(converse.ConverseError,
                       match=r"type \(5, 7\)/9 found at eps 0.03: .* 1 steps"):
        state.relax(0.03, max_steps=1)
    with pytest.raises(converse.ConverseError, match="0 steps"):
        state.relax(0.03, max_steps=0)


# ---- exponents

def gram_schmidt_exponents(state, rounds=1, seed=0):
    """The exponents of a state as they were found in 1989 (thesis, Appendix A), for comparison: 2n
    random vectors are carried along with DF and, whenever the first has grown, orthogonalized; the
    logarithms of their lengths are added.  Array (n,), larger first.

    Rounds times round the orbit; the error is about log(rounds q)/(rounds q), so that where all
    exponents are zero one round of q = 2513 gives 0.003."""
    n = state.potential.n
    total = np.zeros(2 * n)
    vectors = np.linalg.qr(np.random.default_rng(seed).standard_normal((2 * n, 2 * n)))[0]
    for bend in np.concatenate([state.eps * state.potential.evaluate(state.x)[2]] * rounds):
        vectors[n:] -= bend @ vectors[:n]
        vectors[:n] += vectors[n:]
        if np.abs(vectors[:, 0]).max() > 100:
            vectors, lengths = np.linalg.qr(vectors)
            total += np.log(np.abs(np.diag(lengths)))
    total += np.log(np.abs(np.diag(np.linalg.qr(vectors)[1])))
    return np.sort(total / (rounds * state.q))[::-1][:n]


def carried(state, digits):
    """The exponents from the eigenvalues of DF^q, multiplied out in many digits."""
    n = state.potential.n
    with mpmath.workdps(digits):
        product = mpmath.eye(2 * n)
        for bend in state.eps * state.potential.evaluate(state.x)[2]:
            step = mpmath.eye(2 * n)
            for i in range(n):
                step[i, n + i] = 1
                for k in range(n):
                    step[n + i, k] = -bend[i, k]
                    step[i, k] -= bend[i, k]
            product = step * product
        moduli = sorted((abs(value) for value in mpmath.eig(product)[0]), reverse=True)
        return [float(mpmath.log(modulus) / state.q) for modulus in moduli[:n]]


@pytest.mark.parametrize("potential, p, q, eps", [
    (orbits.standard, (0,), 1, 0.5), (orbits.standard, (1,), 2, 0.7),
    (orbits.standard, (3,), 8, 1.2),
    (orbits.standard, (34,), 89, 1.5), (orbits.trig, (1, 1), 1, 0.02),
    (orbits.trig, (1, 1), 2, 0.03),
    (orbits.trig, (1, 2), 3, 0.03), (orbits.trig, (5, 7), 9, 0.05), (orbits.ff, (12, 16), 21, 0.02),
    (orbits.poly, (7, 9), 12, 0.03), (orbits.froeschle, (3, 4), 5, 0.04)], ids=str)
def test_exponents_against_many_digits(potential, p, q, eps):
    state = orbits.straight(potential, p, q).relax(eps)
    assert state.label == "minimum"
    assert state.exponents == pytest.approx(carried(state, 60), abs=1e-9)
    assert state.repeat(3).exponents == pytest.approx(state.exponents, abs=1e-11)
    assert gram_schmidt_exponents(state, 3000 // q) == pytest.approx(
        state.exponents, abs=math.log(3000) / 3000 + 1e-3)


def test_the_product_of_derivatives_overflows():
    """q times the exponent is 2000: DF^q is beyond doubles, 10^308, the pivots are not."""
    state = orbits.follow(orbits.trig, *SPIRAL, [0.04])[0]
    product = np.eye(4)
    with np.errstate(all="ignore"):
        for bend in 0.04 * state.potential.evaluate(state.x)[2]:
            product = np.block([[np.eye(2) - bend, np.eye(2)], [-bend, np.eye(2)]]) @ product
    assert not np.isfinite(product).all()
    assert state.q * state.exponents[0] > 1900
    assert gram_schmidt_exponents(state, 5) == pytest.approx(state.exponents, abs=5e-4)


def test_exponents_of_1989_are_wrong_by_log_q_over_q():
    """All are zero, and once round the orbit 0.0029, 0.0027 are found, (log q)/q being 0.0031; ten
    times round they are smaller as predicted.  The pivots' error is 1/200,000."""
    state = orbits.follow(orbits.trig, *SPIRAL, [0.005])[0]
    found = gram_schmidt_exponents(state, seed=1)
    assert np.round(found, 4) == pytest.approx([0.0029, 0.0027])
    for rounds, seed in ((1, 2), (1, 3), (10, 2)):
        n = rounds * state.q
        found = gram_schmidt_exponents(state, rounds, seed)
        assert (0.7 * math.log(n) / n < found).all() and (found < 1.2 * math.log(n) / n).all()
    assert (0 <= state.exponents).all() and (state.exponents < 1e-5).all()
    assert all(exponent_text(state, x, 10) == "below 1e-05" for x in state.exponents)
    free = orbits.PeriodicOrbit(orbits.trig, (1, 1), 3, 0.0, np.zeros((3, 2)), (0.0, 0.0))
    assert (free.exponents < 1e-5).all()
    assert (gram_schmidt_exponents(free, 1000) < 3e-3).all()


# ---- the standard map

def test_greene_s_residues():
    """377/987 at k_c: R = (2 - trace DF^q)/4 is -0.2555 for the minimizing orbit and +0.2501 for
    the minimax one, a saddle, which Newton finds half-way between the points of the other."""
    least = orbits.follow(orbits.standard, (377,), 987, [0.971635406])[0]
    order = np.argsort(least.x[:, 0])
    after = np.roll(order, -1)
    gap = (least.x[after, 0] - least.x[order, 0]) % 1
    u = least.u.copy()
    u[order, 0] += gap / 2
    minimax, _ = newton(least.moved(u))
    assert (least.label, minimax.label) == ("minimum", "saddle")
    for state, residue in ((least, -0.2555), (minimax, 0.2501)):
        with mpmath.workdps(50):
            a, b, c, d = map(mpmath.mpf, (1, 0, 0, 1))
            for x in state.x[:, 0]:
                bend = mpmath.mpf("0.971635406") * mpmath.cos(2 * mpmath.pi * mpmath.mpf(float(x)))
                c, d = c - bend * a, d - bend * b
                a, b = a + c, b + d
            found = float((2 - a - d) / 4)
        assert found == pytest.approx(residue, abs=1e-4)
    assert (2 - 2 * np.cosh(987 * least.exponents[0])) / 4 == pytest.approx(-0.2555, abs=1e-4)


# ---- Ctrl-C

def test_ctrl_c_ends_a_long_descent():
    """The C core asks between rounds of 2^18 points."""
    rng = np.random.default_rng(7)
    state = orbits.PeriodicOrbit(orbits.trig, (0, 0), 30000, 0.04,
                                 rng.uniform(-0.5, 0.5, (30000, 2)),
                         (0, 0))
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    with pytest.raises(KeyboardInterrupt):
        state.relax(tol=0.0)                            # never there


# ---- size

def test_short_orbits():
    """One, two and three points, where both neighbours of a point are one, or itself."""
    for q in (1, 2, 3):
        for potential in (orbits.trig, orbits.poly, orbits.ff):
            state = orbits.straight(potential, (1, 1), q).relax(0.02)
            assert state.label == "minimum" and state.undetermined == 0
    fixed = orbits.straight(orbits.standard, (0,), 1).relax(0.5)
    assert fixed.x[0, 0] == pytest.approx(0.5, abs=1e-12)
    assert fixed.exponents[0] == pytest.approx(math.acosh(1.25), abs=1e-12)
    assert fixed.action == pytest.approx(-0.5 / (4 * math.pi ** 2), abs=1e-15)


def test_the_action_of_a_long_orbit_keeps_its_digits():
    """Actions are compared; sums of a hundred thousand terms, one after the other, would
    lose what tells a step down from one up."""
    rng = np.random.default_rng(9)
    q = 100083
    state = orbits.PeriodicOrbit(orbits.trig, (57031, 75550), q, 0.025,
                                 rng.uniform(-0.1, 0.1, (q, 2)),
                         orbits.trig.start)
    how, u = ffi.new("cv_relaxed *"), state.u.copy()
    assert lib.cv_relax(orbits.trig.native, q, 0.025, address(state.base), address(u), -1, 1e-13,
                        0, how) == lib.CV_RUNNING
    step = np.roll(u, -1, 0) - u
    terms = [*(0.5 * step ** 2).ravel().tolist(),
             *(-0.025 * orbits.trig.evaluate(state.base + u)[0]).tolist()]
    assert how.action == pytest.approx(math.fsum(terms), rel=0, abs=1e-12)
    assert how.largest == pytest.approx(np.abs(state.gradient).max(), rel=0, abs=1e-15)


@pytest.mark.skipif(TORTURE == 1, reason="a hundred thousand points")
def test_a_hundred_thousand_points():
    begun = time.monotonic()
    family = orbits.follow(orbits.trig, (57031, 75550), 100083, [0.0025, 0.005, 0.01, 0.02, 0.03])
    assert family[0].undetermined >= 2 and all(state.shadow < 2e-13 for state in family)
    assert [state.label for state in family] == ["minimum"] * 5
    # the spiral mean's, as 2513 points have it
    for state, shorter in zip(family, orbits.follow(orbits.trig, *SPIRAL, family.eps)):
        assert state.action == pytest.approx(shorter.action, abs=2e-6)
        assert state.exponents == pytest.approx(shorter.exponents, abs=2e-3)
    assert time.monotonic() - begun < 300


def test_blocks_of_ten_thousand_against_a_dense_step():
    """The solver's residual on a long band, which no dense matrix holds."""
    state = orbits.follow(orbits.trig, (5842, 7739), 10252, [0.0025, 0.01])[1]
    rng = np.random.default_rng(8)
    b, u = rng.normal(size=(state.q, 2)), np.zeros((state.q, 2))
    work = np.zeros((state.q, lib.CV_WORK))
    lib.cv_solve(2, state.q, address(state.blocks, "double(*)[3]"), 0.01, address(b), address(u),
                 address(work, "double *"))
    a, c, d = state.blocks.T
    left = np.stack([a * u[:, 0] + c * u[:, 1], c * u[:, 0] + d * u[:, 1]], 1) + 0.01 * u \
        - np.roll(u, 1, 0) - np.roll(u, -1, 0)
    assert np.abs(left - b).max() < 1e-11


LONG = {                # what is made first, and a call that then lasts, at some 100,000 points
    "follow": ("", "[orbits.follow(orbits.trig, *LONG, [0.03]) for _ in range(99)]"),
    "prove": ("state = orbits.follow(orbits.trig, *LONG, [0.0125])[0]", "orbits.prove(state)"),
    "minimax": ("low = orbits.follow(orbits.standard, (46368,), 121393, [1.2])[0]",
                "[low.minimax() for _ in range(99)]"),
    "prove minimax": (
        "high = orbits.follow(orbits.standard, (46368,), 121393, [1.2])[0].minimax()",
        "high.prove()")}


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_ends_every_long_call(name):
    """Soon, wherever it strikes.  A second on a machine with nothing else to do; the bound is for
    one with much."""
    first, call = LONG[name]
    code = ("from converse import orbits\nfrom converse.orbits import proved\n"
            "LONG = (57031, 75550), 100083\n%s\nfor _ in range(2):\n    print(flush=True)\n"
            "    try:\n        %s\n    except KeyboardInterrupt:\n"
            "        print('ended', flush=True)" % (first, call))
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    for delay in (0.2, 0.7):
        assert process.stdout.readline() == "\n"
        time.sleep(delay)
        assert process.poll() is None
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "ended\n"
        took = time.monotonic() - begin
        print("%s, after %g s: ended in %.2f s" % (name, delay, took))
        assert took < 10
    process.communicate()
