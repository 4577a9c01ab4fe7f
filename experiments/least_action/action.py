"""Rigorous bounds, in doubles, of V, of its derivatives and of the action of a state."""

from math import inf, ulp
from typing import Tuple

import numpy as np

from converse._native import ffi, lib
from converse.orbits.potential import address
from converse.orbits.state import PeriodicOrbit, expected
from converse.prover.native import check

from .build import library

U = 2.0 ** -53              # half the distance of the doubles next to 1
LARGEST_EPS = 1e6


def rounding_errors(potential, reach):
    """What V, its gradient and its Hessian may be off by in doubles: cv_errors.  ValueError, unless
    potential is one with which anything can be proved."""
    errors = ffi.new("double[3]")
    code = library().cv_errors(potential.native, reach, errors)
    if code == lib.CV_EARGUMENT:
        raise ValueError("nothing can be proved of the potential %s: its rounding errors are not "
                         "known; take a SymplecticMap, trig, poly or ff" % potential.name)
    check(code)
    return tuple(errors)


def floats_within(what, values, most):
    """As floats; ValueError, unless they are numbers of at most this size."""
    try:
        floats = [float(value) for value in values]
    except (TypeError, ValueError, OverflowError):
        floats = [inf]
    if not all(abs(value) <= most for value in floats):
        raise ValueError("%s: a list of numbers of at most %g, not %r" % (what, most, values))
    return floats


def values_at(potential, x):
    """V at points (m, 2)."""
    values = np.empty(len(x))
    lib.cv_evaluate(potential.native, len(x), address(x), address(values, "double *"), ffi.NULL,
                    ffi.NULL)
    return values


def action_on_grid(potential, eps, grid):
    """-eps V at the nodes i/grid, and what it may be off by; by how much a path's action per point
    grows when it is rounded to them."""
    n = potential.n
    x = np.zeros((grid ** n, 2))
    x[:, :n] = np.indices((grid,) * n).reshape(n, -1).T / grid
    W = -eps * values_at(potential, x)
    off = abs(eps) * rounding_errors(potential, 1.0)[0] + 2 * U * float(np.abs(W).max())
    rise = n * (1 + abs(eps) * potential.curvature) / (8 * grid ** 2) * (1 + 2.0 ** -40)
    return W, off, rise


def errors_near(state):
    """The rounding_errors at the points of a state, before whole turns are taken off."""
    reach = 1 + float(np.abs(state.origin).max()) + float(np.abs(state.u).max())
    return rounding_errors(state.potential, reach)


def action_bounds(state):
    """Two numbers around the sum of |u_{j+1} - u_j|^2/2 - eps V(x_j)."""
    step, x = np.roll(state.u, -1, 0) - state.u, np.zeros((state.q, 2))
    x[:, :state.potential.n] = state.base + state.u
    parts = np.append(step.ravel() ** 2 / 2, -state.eps * values_at(state.potential, x))
    off = (2 * (len(parts) + 8) * U * float(np.abs(parts).sum())
           + state.q * abs(state.eps) * errors_near(state)[0])
    return float(parts.sum()) - off, float(parts.sum()) + off


def gradient_bounds(state):
    """Of the action, and what each of its coordinates may be off by."""
    off = 8 * U * (4 * float(np.abs(state.u).max()) + float(np.abs(state._gradient).max()))
    return (state._gradient,
            off + 1.001 * abs(state.eps) * errors_near(state)[1])


def per_point(low, high, q):
    low, high = low / q, high / q
    return low - ulp(low), high + ulp(high)


def enclosed_action(state: PeriodicOrbit) -> Tuple[float, float]:
    """Two numbers, proved to be around the action per point of a state, an orbit or not, for angles
    of period 1."""
    expected(state)
    floats_within("eps", [state.eps], LARGEST_EPS)
    low, high = action_bounds(state)
    return per_point(low, high, state.q)
