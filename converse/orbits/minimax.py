"""Minimax orbits of maps of one angle: the pass between a minimum and its neighbour, and the flux.

A minimum x of type (p, q) has a copy of the same action, x_{j+r} less whole turns, displaced by 1/q
on average.  On the way to it, through sequences of points of the same type, the action rises at
least to the action of a pass.  A pass is also an orbit: a saddle with one direction down, the
minimax orbit of the Birkhoff pair.  The difference of action is the flux through the gap of the
(p, q) cantorus approximant (MacKay, Meiss and Percival, Physica D 13, 1984).

The coordinate in which the two differ most is held, and the action minimized over all others, from
one to the other.  Every way passes through each value of that coordinate, and so it rises to the
largest of these minima; where they depend on it continuously, the state there is a pass.
"""

import math
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from ..storage.files import ConverseError
from ..storage.methods import provided
from .limits import (ACTION_ROUNDING, EIGENVALUE_ROUNDING, HELD_STEPS, MAX_HELD, MAX_HELD_GRADIENT,
                     MAX_NESTED_JUMPS, MAX_PASS_SHADOW, MAX_POLISH_STEPS, MAX_SHADOW, MIN_JUMP,
                     MIN_SLOPE, ORDER_TOLERANCE, PASS_BISECTIONS, PASS_STOPS)
from .proved import balls
from .solver import newton
from .state import PeriodicOrbit, descended, expected


@dataclass(frozen=True, eq=False)
class Pair:
    """A minimum and the pass on the way to its neighbour, of a map of one angle.

    Parameters
    ----------
    minimum : PeriodicOrbit
        The state that was given.
    minimax : PeriodicOrbit
        The pass: a saddle with exactly one direction of less action among the states of its type,
        unless its label says that rounding hides it.
    """

    minimum: PeriodicOrbit
    minimax: PeriodicOrbit

    def __post_init__(self):
        low, high = expected(self.minimum), expected(self.minimax)
        if low.potential.n != 1 or low.potential != high.potential or \
                (low.p, low.q, low.eps) != (high.p, high.q, high.eps):
            raise ValueError("a pair is what state.minimax() returns: two states of one map and "
                             "type, of one angle")

    def __repr__(self):
        low = self.minimum
        return "<Pair of %s, type %s, eps %r, flux %.10g>" % (
            low.potential.name, low.type_text, low.eps, self.flux)

    @property
    def flux(self) -> float:
        """The area that each iterate of the map carries through the gap, in either direction, if
        the gap holds no other orbits of the type.

        It is the action of the pass less the minimum's, of all q points together, in doubles and in
        the units of the map: the torus has the area period^2.  Its rounding is about 1e-16 times
        the root of q, and eps where eps is larger than 1."""
        return self.minimum.potential.period ** 2 * difference(self.minimum, self.minimax)

    def prove(self, digits: Optional[int] = None) -> Any:
        """Proves both orbits, and encloses the flux to ten digits at least.

        Parameters
        ----------
        digits : int, optional
            Both orbits are known to 10^-digits at least, by default 10^-20.

        Returns
        -------
        ProvedPair
            Its attributes include `minimum`, a ProvedOrbit, and enclosures `flux` and `residue`.

        Raises
        ------
        NotProved
            With a reason.
        """
        balls()
        return provided("Pair.prove")(self, digits)


def turn_of(state):
    """The point of a state at which its neighbour begins."""
    return pow(state.p[0], -1, state.q) if state.q > 1 else 0


def gap_of(state):
    """The displacements of the neighbour's points from the state's, array (q, 1)."""
    return np.roll(state.u, -turn_of(state), 0) - state.u + 1 / state.q


def difference(low, high):
    """The action of all points of one state less that of another's, on the torus of period 1."""
    steps = [np.roll(state.u, -1, 0) - state.u for state in (low, high)]
    kinetic = (steps[1] - steps[0]) * (steps[1] + steps[0]) / 2
    return math.fsum([*kinetic.ravel(), *(low.eps * (low._local[0] - high._local[0]))])


def minimax(state):
    """See PeriodicOrbit.minimax."""
    if state.potential.n != 1:
        raise ValueError("passes are looked for in maps of one angle")
    if math.gcd(*state.p, state.q) > 1:
        raise ValueError("the type %s is not in lowest terms: take the state of the shorter type"
                         % state.type_text)
    if state.eps == 0:
        raise ConverseError("at eps 0 all states of a type have the same action: there is no "
                            "minimum and no pass")
    if state.label in ("saddle", "not stationary"):
        raise ConverseError("a pass leads from a minimum to its neighbour, and the state is %s: "
                            "relax() it" % {"saddle": "a saddle"}.get(state.label, state.label))
    gap = gap_of(state)
    if not gap.min() > -ORDER_TOLERANCE:
        raise ConverseError("the points of the state are not ordered as those of a rotation, so "
                            "that it is not the least of its type: take another state")
    beyond = state.moved(state.u + gap)
    for rank in range(min(MAX_HELD, gap.size)):
        found = _Way(state, beyond, MAX_NESTED_JUMPS, rank).top(least=True)
        if found is not None and (
                np.abs(found.u - state.u - gap / 2) < gap / 2 + ORDER_TOLERANCE).all():
            return Pair(state, found)
    raise ConverseError("no pass found on the way to the neighbour: whatever coordinate is held, "
                        "the others jump")


class _Way:
    """From one state to another, along t from 0 to 1, with the coordinate in which they differ most
    (rank 0; or 1 less, and so on) held at t times the difference."""

    def __init__(self, first, last, jumps, rank=0):
        self.first, self.gap, self.jumps = first, last.u - first.u, jumps
        order = np.argsort(-np.abs(self.gap), axis=None, kind="stable")
        self.held = tuple(map(int, np.unravel_index(order[rank], self.gap.shape)))
        self.noise = ACTION_ROUNDING * first.q * max(1.0, abs(first.eps))

    def at(self, t, near):
        """The state of least action near one at another t; its action above the first one's; and
        the slope of that."""
        guess = near.u + (t - self.t_of(near)) * self.gap
        guess[self.held] = self.first.u[self.held] + t * self.gap[self.held]
        _, _, u = descended(near.moved(guess), near.eps, MAX_HELD_GRADIENT, HELD_STEPS, self.held)
        found = self.first.moved(u)
        return (found, difference(self.first, found),
                float(found._gradient[self.held] * np.sign(self.gap[self.held])))

    def t_of(self, state):
        return float((state.u[self.held] - self.first.u[self.held]) / self.gap[self.held])

    def top(self, least=False):
        """The pass: of all states where the action ceases to rise, that with most of it; None: no
        such state is found, or none where it rises highest.  least: the first state is to have the
        least action."""
        stops = [(self.first, 0.0, math.inf)]
        for k in range(1, PASS_STOPS + 1):
            stops.append(self.at(k / PASS_STOPS, stops[-1][0]))
            if least and stops[-1][1] < -self.noise:
                raise ConverseError("on the way to its neighbour there is less action than that of "
                                    "the state, which is not the least of its type: take another")
        if max(abs(slope) for _, _, slope in stops[1:]) < MIN_SLOPE:
            return stops[PASS_STOPS // 2][0]
        tops = []
        for low, high in zip(stops, stops[1:]):
            if low[2] > 0 and not self.rises(low, high):
                tops.append(self.between(low, high))
        return max(tops, key=lambda top: top[1])[0] if tops else None

    def rises(self, low, high):
        return high[2] > 0 and high[1] >= low[1] - self.noise

    def between(self, low, high):
        """Finds the pass between two stops, where the action ceases to rise.  Returns the pass and
        its action above the first state's; or None and a lower bound of that rise.  If the state
        jumps there, another coordinate leads from one side to the other."""
        for _ in range(PASS_BISECTIONS):
            middle = self.at((self.t_of(low[0]) + self.t_of(high[0])) / 2, low[0])
            found, _ = newton(middle[0], max_steps=MAX_POLISH_STEPS)
            begin, t, end = (self.t_of(state) for state in (low[0], found, high[0]))
            if (found._shadow < MAX_PASS_SHADOW
                    and begin - ORDER_TOLERANCE <= t <= end + ORDER_TOLERANCE
                    and found.below(-EIGENVALUE_ROUNDING) == found.below(EIGENVALUE_ROUNDING) == 1):
                return found, difference(self.first, found)
            low, high = (middle, high) if self.rises(low, middle) else (low, middle)
        if np.abs(high[0].u - low[0].u).max() < MIN_JUMP:                  # too flat for doubles
            return middle[0] if middle[0]._shadow < MAX_SHADOW else None, middle[1]
        found = _Way(low[0], high[0], self.jumps - 1).top() if self.jumps else None
        return found, low[1] if found is None else difference(self.first, found)
