"""Where the methods of the orbits fail (thesis, section 2.2 and Appendix A), and that they say
so."""

import math
import signal
import subprocess
import sys
import time

import mpmath
import numpy as np
import pytest
from sums import fourier
from thesis.potentials import ff, poly

import converse
from converse import orbits
from converse._native import ffi, lib
from converse.orbits.potential import address
from converse.orbits.solver import newton

SPIRAL = ((1432, 1897), 2513)


# ---- finding a state


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
        state = orbits.PeriodicOrbit(poly, (1, 8), 8, 0.0619, rng.uniform(-0.5, 0.5, (8, 2)),
                             poly.start).relax()
        if state.label == "saddle":
            break
    assert state.below(1e-3) == 0                   # all 16 eigenvalues are clearly positive
    twice = state.repeat(2)
    assert twice.least < -1e-3 and twice.label == "saddle"
    lower = state.repeat(4).relax()                 # which leaves the saddle
    assert lower.label == "minimum" and lower.action < state.action - 1e-4


def test_a_potential_of_python_that_fails():
    """What it raises ends the search, and the next search begins without it."""
    class Failing(type(ff)):
        def evaluate(self, x):
            if failures:
                raise failures.pop()
            return super().evaluate(x)

    failures, state = [], orbits.straight(Failing("failing", ff.start), (2, 3), 5)
    for error in KeyboardInterrupt, ZeroDivisionError:
        failures.append(error())
        with pytest.raises(error):
            state.relax(0.02)
        assert (state.relax(0.02).u == orbits.straight(ff, (2, 3), 5).relax(0.02).u).all()


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
        potential = Blocks("blocks", (0.0, 0.0))
        state = orbits.PeriodicOrbit(potential, (1, 1), 3, 1.0, np.zeros((3, 2)), (0.0, 0.0))
        assert state.below(0) == 0 and state.label == label
        assert (state.repeat(2).least < 0) == (label == "saddle")
        if label == "minimum":      # DF^3 has complex eigenvalues, then two that are below -1
            assert state.exponents == pytest.approx(carried(state, 40), abs=1e-12)


@pytest.mark.slow
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
    (orbits.trig, (1, 2), 3, 0.03), (orbits.trig, (5, 7), 9, 0.05), (ff, (12, 16), 21, 0.02),
    (poly, (7, 9), 12, 0.03), (orbits.froeschle, (3, 4), 5, 0.04)], ids=str)
def test_exponents_against_many_digits(potential, p, q, eps):
    state = orbits.straight(potential, p, q).relax(eps)
    assert state.label == "minimum"
    assert state.exponents == pytest.approx(carried(state, 60), abs=1e-9)
    assert state.repeat(3).exponents == pytest.approx(state.exponents, abs=1e-11)


# ---- size

def test_short_orbits():
    """One, two and three points, where both neighbours of a point are one, or itself."""
    for q in (1, 2, 3):
        for potential in (orbits.trig, poly, ff):
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
