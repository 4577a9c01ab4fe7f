"""Proofs that a true orbit lies beside a state, with bounds of its action and its exponents.

docs/proofs/proved-orbits.md has the theorems and their proofs.  enclosure.py and exponents.py bound
all sums over the points of the orbit, in balls.  This module combines them as exact rationals.
"""

import math
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Any, Optional, Tuple

import numpy as np

from ..model.exact import Interval, rounded, rounded_text, whole_number
from ..model.potential import per_period, product
from ..storage.files import ConverseError
from ..storage.methods import provided
from .limits import (DEFAULT_DIGITS, EIGENVALUE_ROUNDING, EXPONENT_PLACES, GUARD_PLACES,
                     LEAST_RATIO, LEAST_SHARE, MAX_DIGITS, MAX_MORE_PLACES, MAX_PLACES,
                     MAX_PROOF_STEPS, MAX_SHADOW, MIN_LEAST_GUESS, NULL_EIGENVALUE, SHOWN_PLACES)
from .state import PeriodicOrbit, expected

EXACT_NULL = Fraction(NULL_EIGENVALUE)


class NotProved(ConverseError):
    """The orbit is not proved, for the reason in the text.  It may exist all the same."""


@dataclass(frozen=True, eq=False, repr=False)
class ProvedOrbit:
    """A theorem about the true orbit beside a state.

    Attributes
    ----------
    state : PeriodicOrbit
        The state that was given.
    digits : int
        The decimal places the proof was computed with.
    radius : Fraction
        There is exactly one true orbit of the state's type whose displacements are within radius of
        `displacements`, in the Euclidean norm of all coordinates together; both are exact numbers
        of turns.
    least : Fraction
        No eigenvalue of the second variation of its action is below this positive number, however
        often the orbit is run through.
    action : Interval
        Its action per point less the straight orbit's, in the units of the map.
    exponents : tuple of Interval, shape (n,)
        Its positive Lyapunov exponents, larger first.
    sign : int
        1 or -1: its multipliers are real and have this sign; 0: they are complex, or this is
        undecided.
    moved : float
        The distance of the points from the state's: the largest coordinate, on the torus, in turns.
    displacements : tuple of tuple of Fraction, shape (q, n)
        The centre of the ball of this radius, as displacements from the straight orbit.
    """

    state: PeriodicOrbit
    digits: int
    radius: Fraction
    least: Fraction
    action: Interval
    exponents: Tuple[Interval, ...]
    sign: int
    moved: float
    displacements: Tuple[Tuple[Fraction, ...], ...]

    label = "proved"

    def __repr__(self):
        return "<ProvedOrbit %s, %s, eps %r, radius %s>" % (
            self.state.potential.name, self.state.type_text, self.state.eps, distances(self)[0])

    @cached_property
    def points(self) -> Tuple[Tuple[Fraction, ...], ...]:
        """The centre of the ball: q points in [0, 1)^n, in turns, exactly."""
        state = self.state
        return tuple(tuple((Fraction(o) + Fraction(j * p % state.q, state.q) + x) % 1
                           for o, p, x in zip(state.origin, state.p, u))
                     for j, u in enumerate(self.displacements))

    @cached_property
    def nearest(self) -> PeriodicOrbit:
        """The points that were proved as doubles have them, to be drawn or measured."""
        return self.state.moved(np.array(self.displacements, dtype=float))

    @cached_property
    def indices(self) -> Optional[Tuple[Interval, ...]]:
        """Enclosures of its n stability indices rho = l + 1/l, in the order of the exponents; None
        where the multipliers l are not known to be real.  Exact numbers of many digits."""
        if not self.sign:
            return None
        from ..model.balls import precision
        from .enclosure import ball, bits_of, lower, upper

        found = []
        with precision(bits_of(EXPONENT_PLACES)):
            for ends in self.exponents:             # l + 1/l grows with |l|
                low, high = (2 * (self.state.q * ball(end)).cosh() for end in ends)
                found.append(sorted((self.sign * lower(low), self.sign * upper(high))))
        return tuple(Interval(low, high) for low, high in found)

    @property
    def residue(self) -> Interval:
        """An enclosure of Greene's residue (2 - rho)/4, which is negative.  ValueError: n is 2."""
        if self.state.potential.n != 1 or self.indices is None:
            raise ValueError("Greene's residue is of maps with one angle; with two there are the "
                             "stability indices, .indices")
        (low, high), = self.indices
        return Interval((2 - high) / 4, (2 - low) / 4)

    def plot(self, ax: Any = None) -> Any:
        """The state nearest to it.

        Parameters
        ----------
        ax
            As of PeriodicOrbit.plot.
        """
        return provided("PeriodicOrbit.plot")(self, ax)

    def report(self) -> str:
        """The theorem in words."""
        state, (within, moved) = self.state, distances(self)
        lines = [
            "THEOREM, proved with %d decimal places: the map %s"
            % (self.digits, map_words(state.potential)),
            "with the potential %s," % state.potential.name,
            "V(%s) = %s," % (state.potential.letters[0], state.potential.formula),
            "and eps = %s has exactly one orbit of type %s within %s of the points computed"
            % (_eps(state), state.type_text, within),
            "(Euclidean norm of all coordinates together), which are within %s of those given "
            "(each coordinate)." % moved,
            "It is hyperbolic and, run through any number of times, a nondegenerate local minimum "
            "of the action.",
            "Second variation : at least %s" % rounded_text(self.least, 3, up=False),
            "%s : %r" % (action_words(state.potential), self.action)] + [
            "Exponent : %r" % (ends,) for ends in self.exponents]
        if state.potential.n == 1 and self.residue[0] > -10 ** SHOWN_PLACES:
            lines.append("Residue : %r" % (self.residue,))
        return "\n".join(lines) + "\n"


def prove(state: PeriodicOrbit, digits: Optional[int] = None) -> ProvedOrbit:
    """Proves that a true orbit lies beside a state of least action.

    The points are made as exact as the proof needs.  Where phases are undetermined in doubles they
    are determined here, and the points may move: see `moved` of the result.

    Parameters
    ----------
    state : PeriodicOrbit
    digits : int, optional
        The radius of the result is at most 10^-digits, by default 10^-20.

    Returns
    -------
    ProvedOrbit

    Raises
    ------
    NotProved
        With a reason: among others, because the state is not stationary, or a saddle.
    """
    wanted = DEFAULT_DIGITS if digits is None else whole_number(digits, "digits", 1, MAX_DIGITS)
    expected(state)
    if state.eps == 0:
        raise NotProved("without a perturbation, at eps 0, no orbit is isolated")
    precision, Enclosure, growth = balls()
    with np.errstate(all="ignore"):
        shadow = state._shadow
    if not shadow < MAX_SHADOW:
        raise NotProved("the state is not stationary, its gradient is %.1e: relax() it first"
                        % shadow)
    if state.least < -EXACT_NULL:
        raise NotProved("the state is a saddle: the least eigenvalue of its Hessian is about %.1e"
                        % state.least)
    if state.label == "saddle":
        raise NotProved("the state is a saddle: it, or it run through several times, is no minimum "
                        "of the action")
    places = wanted + 2 * GUARD_PLACES
    most = min(MAX_PLACES, places + MAX_MORE_PLACES)
    orbit, reason = None, None
    with precision():
        exact = Enclosure(state, Fraction(_eps(state)))
        while True:
            try:
                orbit = _attempt(state, exact, growth, places, wanted)
                if all(high - low <= high / 10 ** GUARD_PLACES for low, high in orbit.exponents):
                    return orbit
            except TooFewPlaces as error:
                reason = error
            if places == most:
                break
            places = min(most, max(places + 15, places * 3 // 2))
    if orbit is None:
        raise NotProved("%s: %d decimal places do not tell" % (reason, places))
    return orbit


def balls():
    """Imports the modules that need python-flint, when something is to be proved."""
    try:
        from ..model.balls import precision
        from .enclosure import Enclosure
        from .exponents import growth
    except ImportError as error:
        raise ConverseError("proving orbits needs python-flint (%s); pip install "
                            "'converse-kam[orbits]'" % error) from None
    return precision, Enclosure, growth


class TooFewPlaces(Exception):
    """The reason why a proof fails; more decimal places may help."""


def _attempt(state, exact, growth, places, wanted):
    ulp = Fraction(1, 10 ** places)
    floor = ulp * 10 ** (2 * GUARD_PLACES)
    _refine(state, exact, places, floor)
    displacements = exact.displacements()
    steps = [abs(float(new - Fraction(old)))
             for row, olds in zip(displacements, state.u.tolist()) for new, old in zip(row, olds)]
    # lipschitz is a double above the K of docs/proofs/proved-orbits.md; here its exact value.
    bend = abs(exact.eps) * Fraction(state.potential.lipschitz)
    least = _least(state, exact, floor, float(bend) * math.hypot(*steps))
    shown = places + GUARD_PLACES
    radius = rounded(exact.gradient / least * Fraction(9, 8) + ulp, shown, up=True)
    left = rounded(least - bend * radius, shown, up=False)
    if not exact.gradient < radius * left or left < least / 2:
        raise TooFewPlaces("the gradient is too large for so flat a minimum")
    if radius > Fraction(1, 10 ** wanted):
        raise TooFewPlaces("the orbit is known to %.1e only" % radius)
    exponents, sign = grown(exact, growth, least, bend * radius)
    exponents = tuple(Interval(rounded(max(low, 0) / state.q, EXPONENT_PLACES, up=False),
                               rounded(high / state.q, EXPONENT_PLACES, up=True))
                      for low, high in exponents)
    action = in_units(state.potential, (exact.action[0] - exact.gradient * radius / state.q,
                                        exact.action[1]), shown)
    moved = max(abs(step - round(step)) for step in steps)
    return ProvedOrbit(state, places, radius, left, action, exponents, sign,
                       moved, displacements)


def grown(exact, growth, least, away):
    """The result of growth() for every orbit whose blocks are within `away` of these; least: a
    lower bound of the eigenvalues.  TooFewPlaces: there is none."""
    ulp = Fraction(1, 10 ** exact.places)
    away += ulp
    strict = max(4 * away, ulp * 10 ** GUARD_PLACES)
    if strict > least / 2:
        raise TooFewPlaces("the chain is too flat")
    found = growth(exact, strict, away)
    if found is None:
        raise TooFewPlaces("the pivots could not be enclosed")
    return found


def _refine(state, exact, places, floor):
    """Newton's method until the gradient is as small as this number of places allows.

    Where the Hessian is not positive, by less than doubles see, the step is made with Hessian +
    shift.  A long step along a soft direction raises the gradient of the others.  Steps with a
    shift that stops the soft directions lower it again.  A step that raises the action is undone.
    A nudge leaves a saddle where the gradient vanishes."""
    exact.evaluate(places)
    noise, shift = 4 * exact.noise(), Fraction(0)
    for _ in range(MAX_PROOF_STEPS):
        gradient, action = exact.gradient, exact.action
        if not exact.bends(shift or -floor):
            if not shift and exact.bends(floor):
                raise TooFewPlaces("the minimum is too flat, if it is one")
            if not exact.bends(EXACT_NULL):
                raise NotProved("the state is a saddle")
            shift = _boundary(max(shift, floor), EXACT_NULL, exact.bends, 16)[1]
            if gradient < noise:
                exact.nudge()
                exact.evaluate(places)
                gradient, action = exact.gradient, exact.action
        before = exact.u
        exact.newton(shift)
        exact.evaluate(places)
        still = None
        while (exact.gradient > max(gradient, noise)
               and (still is None or 2 * exact.gradient < still)):
            still = exact.gradient
            exact.newton(EXACT_NULL)
            exact.evaluate(places)
        if exact.action[0] > action[1]:
            exact.u = before
            exact.evaluate(places)
            shift = max(16 * shift, floor, gradient / math.isqrt(state.q))  # no further than 1
        elif not shift and exact.gradient < noise:
            return
        else:
            shift *= min(Fraction(1, 64), (exact.gradient / gradient) ** 2)
            if shift < floor:
                shift = Fraction(0)
    raise TooFewPlaces("Newton's method did not converge")


def _least(state, exact, floor, change):
    """A lower bound of the eigenvalues of any copy's Hessian, within a few per cent of the best.
    change: a bound of the eigenvalues' change from the state's points to these."""
    guess, more = max(Fraction(state.least), MIN_LEAST_GUESS) * LEAST_SHARE, LEAST_RATIO
    if exact.least(guess):
        if change + EIGENVALUE_ROUNDING < state.least / 100 or not exact.least(guess * more):
            return guess
        low, high = guess * more, guess * 16
        while exact.least(high):
            low, high = high, high * 16
        return _boundary(low, high, lambda m: not exact.least(m), more)[0]
    if not exact.least(floor):
        if exact.bends(-floor * 10 ** GUARD_PLACES):
            raise NotProved("the orbit is no minimum of the action when it is run through several "
                            "times")
        raise TooFewPlaces("the minimum is too flat")
    return _boundary(floor, guess, lambda m: not exact.least(m), more)[0]


def _boundary(low, high, holds, ratio):
    """Brings low and high together, to that ratio, with holds(high) and not holds(low) as given."""
    while high > ratio * low:
        scale = 10 ** (MAX_PLACES + GUARD_PLACES)
        middle = Fraction(math.isqrt(int(low * high * scale ** 2)), scale)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


# ---- numbers

def in_units(potential, action, digits):
    """The ends of an action on the torus of period 1, as an Interval around the action in the units
    of the map, rounded to these digits."""
    if potential.period != 1:
        low, high = per_period(digits + GUARD_PLACES)           # around 1/(2 pi)^2
        action = product(action, (1 / high, 1 / low))
    return Interval(rounded(action[0], digits, up=False), rounded(action[1], digits, up=True))


def distance_words(potential, turns):
    """A distance in turns, in words, in the units of the map, rounded up."""
    unit = 1 if potential.period == 1 else Fraction(6283185308, 10 ** 9)       # above 2 pi
    return rounded_text(turns * unit, 2, up=True)


def distances(proof):
    """radius and moved in words, rounded up."""
    potential, moved = proof.state.potential, Fraction(proof.moved) * (1 + Fraction(1, 2 ** 50))
    return distance_words(potential, proof.radius), distance_words(potential, moved)


def map_words(potential):
    x, p = potential.letters
    return "%s' = %s + %s', %s' = %s - eps grad V(%s)" % (x, x, p, p, p, x)


def action_words(potential):
    """The label of an action in a report."""
    return "Action per point less |%sp/q|^2/2" % ("" if potential.period == 1 else "2 pi ")


def _eps(state):
    """eps as the exact decimal that it stands for."""
    return str(Decimal(repr(state.eps)))
