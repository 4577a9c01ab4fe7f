"""Finding states: continuation in eps, and the methods of 1989 (thesis, Appendix A)."""

import csv
from dataclasses import dataclass, replace
from typing import Tuple

import numpy as np

from .._native import lib
from ..files import ConverseError
from .potential import address, done
from .state import FARTHEST, State

STEP = 0.0025               # of eps, at most, from one state to the next guess
LEAST_STEP = STEP / 64


def straight(potential, p, q, origin=None):
    """The state x_j = origin + j p/q, least at eps 0; by default it begins at a maximum of V."""
    rows = q if isinstance(q, (int, np.integer)) and q > 0 else 0       # State tells what is wrong
    return State(potential, p, q, 0.0, np.zeros((rows, potential.n)), origin or potential.start)


@dataclass(frozen=True, eq=False)
class Family:
    """States of one type, in the order in which eps was asked for."""

    states: Tuple[State, ...]

    def __len__(self):
        return len(self.states)

    def __getitem__(self, k):
        return self.states[k]

    @property
    def eps(self):
        return np.array([state.eps for state in self.states])

    @property
    def exponents(self):
        """Array (len, n)."""
        return np.array([state.exponents for state in self.states])

    def write_csv(self, file):
        """A row for each state, with its measures."""
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(COLUMNS)
        rows.writerows(map(row, self.states))


COLUMNS = ("potential", "p", "q", "eps", "label", "action", "shadow", "grad_size", "exponent_1",
           "exponent_2", "deviation_point", "deviation_start", "deviation_best", "undetermined")


def row(state):
    """The measures of a state, as COLUMNS says."""
    exponents = [repr(float(x)) for x in state.exponents] + [""] * (2 - state.potential.n)
    return [state.potential.name, " ".join(map(str, state.p)), state.q, repr(state.eps), state.label,
            repr(state.action), repr(state.shadow), repr(state.grad_size), *exponents,
            *map(repr, state.deviation), state.undetermined]


def follow(potential, p, q, eps, progress=None):
    """A Family: the states that continuation from eps 0 reaches at each eps in turn.

    Each state is the guess for the next, at most STEP further, and less where the solver fails.
    A branch of minima is followed, which need not stay the least.  ConverseError, if it is lost."""
    state, states = straight(potential, p, q), []
    for target in eps:
        step = STEP
        while state.eps != target or not states:
            gap = target - state.eps
            there = target if abs(gap) <= step * 1.000001 else state.eps + (step if gap > 0 else -step)
            try:
                state = state.relax(there)
            except ConverseError:
                step /= 2
                if step < LEAST_STEP:
                    raise
                continue
            if there == target:
                break
        states.append(state)
        if progress is not None:
            progress(len(states), state)
    return Family(tuple(states))


def flow(state, eps=None, grad_size=1e-6, max_steps=10000, dt=0.5):
    """Gradient flow (thesis, Appendix A), for comparison: du/dtau = -dL/du until the gradient's root
    mean square is at most grad_size.  The kinetic part is taken implicitly, so that dt may be large.
    Returns the state, "not stationary" perhaps, and the number of steps."""
    state = replace(state, eps=state.eps if eps is None else float(eps), searches=0)
    wave = 2 - 2 * np.cos(2 * np.pi * np.fft.rfftfreq(state.q))
    damping = 1 / (1 + dt * wave)[:, None]
    for steps in range(max_steps):
        if state.grad_size <= grad_size:
            return state, steps
        force = state.u + dt * state.eps * state._local[1]
        u = np.fft.irfft(np.fft.rfft(force, axis=0) * damping, n=state.q, axis=0)
        state = state.moved(u)
    return state, max_steps


def newton(state, eps=None, tol=1e-13, max_steps=50):
    """Newton's method without damping (thesis, Appendix A), for comparison: it finds whatever is
    stationary, or nothing.  Returns the last state, "not stationary" perhaps, and the number of
    steps."""
    state = replace(state, eps=state.eps if eps is None else float(eps), searches=0)
    n = state.potential.n
    for steps in range(max_steps + 1):
        if steps == max_steps or np.abs(state.gradient).max() <= tol:
            break
        gradient, step = np.zeros((state.q, 2)), np.zeros((state.q, 2))
        gradient[:, :n] = state.gradient
        done(lib.cv_solve(n, state.q, address(state.blocks, "double(*)[3]"), 0.0,
                          address(gradient), address(step)))
        u = state.u - step[:, :n]
        if not (np.abs(u) < FARTHEST).all():
            break
        state = state.moved(u)
    return state, steps
