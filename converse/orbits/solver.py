"""Finding states: continuation in eps, and the methods of 1989 (thesis, Appendix A)."""

import math
import os
from dataclasses import dataclass, replace
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np

from ..storage.files import ConverseError
from ..storage.methods import provided
from .limits import (MAX_DISPLACEMENT, MAX_EPS_STEPS, MAX_STEP_DIVISOR, MIN_CURVATURE,
                     NEWTON_GRADIENT, STEP_TIMES_CURVATURE)
from .potential import Numerators, Source, finite, known, told
from .state import PeriodicOrbit, expected, type_of


def straight(potential: Source, p: Numerators, q: int,
             origin: Optional[Tuple[float, ...]] = None) -> PeriodicOrbit:
    """The state x_j = origin + j p/q, which is an orbit at eps 0.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
    q : int
    origin : tuple of float, shape (n,), optional
        The first point, in turns; by default a maximum of V.

    Returns
    -------
    PeriodicOrbit
    """
    potential = known(potential)
    numerators, q = type_of(potential, p, q)
    return PeriodicOrbit(potential, numerators, q, 0.0, np.zeros((q, potential.n)),
                 potential.start if origin is None else origin)


def step_of(potential):
    """The step of eps in follow: about STEP_TIMES_CURVATURE over the curvature, rounded to 1, 2.5
    or 5 times a power of ten.  The map of 1000 V and eps/1000 thus has the same orbits as that of V
    and eps."""
    bend = max(potential.curvature, MIN_CURVATURE)
    order = math.floor(math.log10(STEP_TIMES_CURVATURE / bend))
    return min((float("%se%d" % (digits, order)) for digits in ("1", "2.5", "5", "10")),
               key=lambda step: abs(math.log(step * bend / STEP_TIMES_CURVATURE)))


@dataclass(frozen=True, eq=False)
class Family:
    """States of one type, in the order in which eps was asked for.

    Parameters
    ----------
    states : tuple of PeriodicOrbit
    """

    states: Tuple[PeriodicOrbit, ...]

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, k: Union[int, slice]) -> Any:
        return Family(self.states[k]) if isinstance(k, slice) else self.states[k]

    def __iter__(self) -> Iterator[PeriodicOrbit]:
        return iter(self.states)

    @property
    def eps(self) -> np.ndarray:
        """Array (len,)."""
        return np.array([state.eps for state in self.states])

    @property
    def exponents(self) -> np.ndarray:
        """Array (len, n)."""
        return np.array([state.exponents for state in self.states])

    def report(self) -> str:
        """What doubles show of each state, in lines."""
        return provided("Family.report")(self)

    def plot(self, ax: Any = None) -> Any:
        """Its exponents against eps, as a Figure of matplotlib, which a notebook shows.  Hollow
        points are of states in which doubles see no minimum.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; they are returned.

        Raises
        ------
        ValueError
            There are no states.
        ConverseError
            matplotlib is missing.
        """
        return provided("Family.plot")(self, ax)

    def __repr__(self) -> str:
        first = self.states[0] if self.states else None
        return "<Family: %d states%s>" % (len(self), "" if first is None else " of %s, eps %g to %g"
                                          % (first.potential.name, self.eps[0], self.eps[-1]))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes all states to a file as PeriodicOrbit.save does one.

        Parameters
        ----------
        path : str or path

        Raises
        ------
        ValueError
            The family is empty, or its states are not of one potential and type.
        ConverseError
            As of PeriodicOrbit.save.
        """
        provided("PeriodicOrbit.save")(self.states, path)


def reached(potential, eps, begin=0.0):
    """Returns eps as a list of floats.  ValueError: not all are numbers that follow reaches."""
    eps, step = finite("eps", eps), step_of(potential)
    for a, b in zip([begin] + eps, eps):
        if not abs(b - a) <= MAX_EPS_STEPS * step:
            raise ValueError("eps %r is more than %d steps of %g away from %r: too far to be "
                             "followed" % (b, MAX_EPS_STEPS, step, a))
    return eps


def follow(potential: Source, p: Numerators, q: int, eps: Union[float, Sequence[float]] = 1.0,
           progress: Optional[Callable[[int, PeriodicOrbit], object]] = None,
           start: Optional[PeriodicOrbit] = None,
           on_step: Optional[Callable[[PeriodicOrbit], object]] = None) -> Family:
    """Follows a periodic orbit in eps, from the straight orbit at eps 0 or from another state.

    Parameters
    ----------
    potential : SymplecticMap or Potential
        A map without free parameters, or a potential of orbits.
    p : int or sequence of int, shape (n,)
        With q the type: x_{j+q} = x_j + p, in angles of period 1.
    q : int
        The period.
    eps : float or sequence of float
        The potential is multiplied by each of these numbers in turn.  From each to the next there
        are at most MAX_EPS_STEPS steps.
    progress : callable, optional
        progress(done, state) is called for each state of the result.
    start : PeriodicOrbit, optional
        A state of this type instead of the straight orbit.
    on_step : callable, optional
        on_step(state) is called for these and all states on the way to them.

    Returns
    -------
    Family
        The states that continuation reaches at each eps.

    Raises
    ------
    ConverseError
        The branch is lost.

    Notes
    -----
    Each state is the guess for the next, at most step_of(potential) further, and less where the
    solver fails.  A branch of minima is followed, which need not stay the least.
    """
    potential = known(potential)
    state = straight(potential, p, q)
    if start is not None:
        expected(start)
        if (start.p, start.q) != (state.p, state.q) or start.potential != potential:
            raise ValueError("the start is %r, and no state of the potential %s and type %s"
                             % (start, potential.name, state.type_text))
        state = start
    states: List[PeriodicOrbit] = []
    targets, longest = reached(potential, eps, state.eps), step_of(potential)
    told(progress)
    told(on_step)
    for target in targets:
        step = longest
        while state.eps != target or not states:
            gap = target - state.eps
            there = target
            if abs(gap) > step * 1.000001:
                there = state.eps + (step if gap > 0 else -step)
            try:
                state = state.relax(there)
            except ConverseError:
                step /= 2
                if step < longest / MAX_STEP_DIVISOR:
                    raise
                continue
            if on_step is not None:
                on_step(state)
            if there == target:
                break
        states.append(state)
        if progress is not None:
            progress(len(states), state)
    return Family(tuple(states))


def newton(state: PeriodicOrbit, eps: Optional[float] = None,
           max_steps: int = 50) -> Tuple[PeriodicOrbit, int]:
    """Newton's method without damping (thesis, Appendix A): it finds any stationary state, a
    minimum or a saddle, or nothing.  Returns the last state, "not stationary" perhaps, and the
    number of steps."""
    state = replace(state, eps=state.eps if eps is None else eps)
    for steps in range(max_steps + 1):
        if steps == max_steps or np.abs(state._gradient).max() <= NEWTON_GRADIENT:
            break
        u = state.u - state.solved(state._gradient)
        if not (np.abs(u) < MAX_DISPLACEMENT).all():
            break
        state = state.moved(u)
    return state, steps
