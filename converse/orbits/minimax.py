"""Minimax orbits: the passes between a minimum and its neighbours, and how much action they cost.

A minimum x of type (p, q) has copies of the same action, x_{j+r} less whole turns, which are
displaced by the vectors r p/q + m of a lattice.  On the way to one of them, through sequences of
points of the same type, the action rises at least to the action of a pass.  A pass is also an
orbit: a saddle with one direction down.  With one angle it is the minimax orbit of the Birkhoff
pair.  The difference of action is then the flux through the gap of the (p, q) cantorus approximant
(MacKay, Meiss and Percival, Physica D 13, 1984).

The coordinate in which the two differ most is held, and the action minimized over all others, from
one to the other.  Every way passes through each value of that coordinate, and so it rises to the
largest of these minima; where they depend on it continuously, the state there is a pass.
"""

import math
from dataclasses import dataclass
from typing import Any, Optional, Tuple

import numpy as np

from ..storage.files import ConverseError
from ..storage.methods import provided
from .limits import (ACTION_ROUNDING, EIGENVALUE_ROUNDING, HELD_STEPS, MAX_HELD, MAX_HELD_GRADIENT,
                     MAX_NESTED_JUMPS, MAX_PASS_SHADOW, MAX_POLISH_STEPS, MAX_SHADOW, MIN_JUMP,
                     MIN_SLOPE, ORDER_TOLERANCE, PASS_BISECTIONS, PASS_STOPS)
from .proved import balls
from .solver import newton
from .state import PeriodicOrbit, descended, expected, vector_words


@dataclass(frozen=True, eq=False)
class Pair:
    """A minimum and a pass on the way to one of its neighbours.

    Parameters
    ----------
    minimum : PeriodicOrbit
        The state that was given.
    minimax : PeriodicOrbit
        The pass: a saddle with exactly one direction of less action among the states of its type,
        unless its label says that rounding hides it.
    step : tuple of int, shape (n,)
        By how much that neighbour is displaced, in turns over q.
    turn : int
        The neighbour begins at this point of the minimum.
    """

    minimum: PeriodicOrbit
    minimax: PeriodicOrbit
    step: Tuple[int, ...]
    turn: int

    def __post_init__(self):
        low, high = expected(self.minimum), expected(self.minimax)
        if (low.potential != high.potential or (low.p, low.q, low.eps) !=
                (high.p, high.q, high.eps) or (low.potential.n == 1 and self.step != (1,))
                or not isinstance(self.turn, int)
                or any((self.turn * k - i) % low.q for k, i in zip(low.p, self.step))):
            raise ValueError("a pair is what state.minimax() returns: two states of one map and "
                             "type, and the step to a neighbour")

    def __repr__(self):
        low = self.minimum
        return "<Pair of %s, type %s, eps %r, step %s, barrier %.10g>" % (
            low.potential.name, low.type_text, low.eps, vector_words(self.step, low.q),
            self.barrier)

    @property
    def barrier(self) -> float:
        """The action of the pass less the minimum's, of all q points together, in doubles and in
        the units of the map.  Its rounding is about 1e-16 times the root of q, and eps where eps is
        larger than 1."""
        return self.minimum.potential.period ** 2 * difference(self.minimum, self.minimax)

    @property
    def flux(self) -> float:
        """With one angle, the area that each iterate of the map carries through the gap, in either
        direction, if the gap holds no other orbits of the type.  It is the barrier, an area in the
        units of the map: the torus has the area period^2.  ValueError for
        n = 2."""
        self.check_flux()
        return self.barrier

    def check_flux(self) -> None:
        """Raises ValueError unless there is one angle."""
        if self.minimum.potential.n != 1:
            raise ValueError("the flux is of maps with one angle; with two there is the difference "
                             "of action, .barrier")

    def prove(self, digits: Optional[int] = None) -> Any:
        """Proves both orbits, and encloses the difference of their actions to ten digits at least.

        Parameters
        ----------
        digits : int, optional
            Both orbits are known to 10^-digits at least, by default 10^-20.

        Returns
        -------
        ProvedPair
            Its attributes include `minimum`, a ProvedOrbit, and enclosures `barrier` and `residue`.

        Raises
        ------
        NotProved
            With a reason.
        """
        balls()
        return provided("Pair.prove")(self, digits)


def gap_of(pair):
    """The displacements of the neighbour's points from the minimum's, array (q, n)."""
    return _gap(pair.minimum, pair.turn, pair.step)


def difference(low, high):
    """The action of all points of one state less that of another's, on the torus of period 1."""
    steps = [np.roll(state.u, -1, 0) - state.u for state in (low, high)]
    kinetic = (steps[1] - steps[0]) * (steps[1] + steps[0]) / 2
    return math.fsum([*kinetic.ravel(), *(low.eps * (low._local[0] - high._local[0]))])


def minimax(state, step=0):
    """See PeriodicOrbit.minimax."""
    if math.gcd(*state.p, state.q) > 1:
        raise ValueError("the type %s is not in lowest terms: take the state of the shorter type"
                         % state.type_text)
    if state.eps == 0:
        raise ConverseError("at eps 0 all states of a type have the same action: there is no "
                            "minimum and no pass")
    if state.label in ("saddle", "not stationary"):
        raise ConverseError("a pass leads from a minimum to its neighbour, and the state is %s: "
                            "relax() it" % {"saddle": "a saddle"}.get(state.label, state.label))
    r, vector = _neighbour(state, step)
    gap = _gap(state, r, vector)
    if state.potential.n == 1 and not gap.min() > -ORDER_TOLERANCE:
        raise ConverseError("the points of the state are not ordered as those of a rotation, so "
                            "that it is not the least of its type: take another state")
    beyond = state.moved(state.u + gap)
    for rank in range(min(MAX_HELD, gap.size)):
        found = _Way(state, beyond, MAX_NESTED_JUMPS, rank).top(least=state.potential.n == 1)
        if found is not None and (state.potential.n == 2 or (
                np.abs(found.u - state.u - gap / 2) < gap / 2 + ORDER_TOLERANCE).all()):
            return Pair(state, found, vector, r)
    raise ConverseError("no pass found on the way to the neighbour: whatever coordinate is held, "
                        "the others jump" + "; try another step, 0, 1 or 2" * (gap.shape[1] == 2))


def _gap(state, r, vector):
    """The displacements of the neighbour's points from the state's, array (q, n)."""
    return np.roll(state.u, -r, 0) - state.u + np.array(vector) / state.q


def _neighbour(state, which):
    """The which-th neighbour: the r for which it begins at x_r, and q times its displacement.  With
    two angles the three bound a cell of the lattice: the two shortest vectors, and the shorter one
    of their sum and difference."""
    n, q = state.potential.n, state.q
    if isinstance(which, (bool, float)) or which not in range(2 * n - 1):
        raise ValueError("step is %s, not %r" % ("0, 1 or 2, the nearest neighbour first" if n == 2
                                                 else "0 with one angle", which))
    if n == 1:
        return pow(state.p[0], -1, q) if q > 1 else 0, (1,)
    c = np.arange(q, dtype=np.int64)[:, None] * (np.array(state.p) % q) % q
    c = np.concatenate([np.where(2 * c > q, c - q, c), [[q, 0], [0, q]]])
    r = np.append(np.arange(q), [0, 0])
    order = np.argsort((c ** 2).sum(1), kind="stable")[1:]          # the first one is zero
    first = order[0]
    second = order[np.argmax(c[order, 0] * c[first, 1] != c[order, 1] * c[first, 0])]
    sign = -1 if c[first] @ c[second] > 0 else 1
    turn, vector = ((r[first], c[first]), (r[second], c[second]),
                    ((r[first] + sign * r[second]) % q, c[first] + sign * c[second]))[which]
    return int(turn), tuple(map(int, vector))


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
