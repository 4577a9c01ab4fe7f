"""Proved orbits: that a true orbit lies beside a state, what it is, its action and its exponents.

docs/orbits-proof.md has the theorems and their proofs; csrc/orbits/enclose.c bounds all that has as
many terms as the orbit has points; here the few numbers that remain are put together, as exact
rationals.
"""

import math
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Optional, Tuple

import numpy as np

from .._native import ffi, lib
from ..storage.files import ConverseError
from .potential import Bounds, address, done
from .state import NEAR_NULL, ROUNDING, STATIONARY, State, expected

DIGITS = 20                 # the radius is at most 10^-DIGITS unless another number is asked for
MOST = 1000                 # places, with which no orbit is tried any more
MORE = 100                  # places that are added in vain, at most
STEPS = 60                  # of Newton's method, at most
SOFT = Fraction(NEAR_NULL)  # eigenvalues of the Hessian below it in size are none in doubles
GUARD = 10                  # places by which what must be seen stands above rounding
SHOWN = 20                  # places of an interval in a report, at most


class NotProved(ConverseError):
    """No theorem; the text says why.  Nothing is said against the orbit."""


@dataclass(frozen=True, eq=False, repr=False)
class ProvedOrbit:
    """A theorem about the true orbit beside a state.

    state     -- the state that was given
    digits    -- decimal places the proof was computed with
    radius    -- there is exactly one true orbit of the state's type whose displacements are within
                 radius of `displacements`, in the Euclidean norm of all coordinates together
    least     -- no eigenvalue of the second variation of its action is below this positive number,
                 however often the orbit is run through
    action    -- (low, high): its action per point less that of the straight orbit, |p/q|^2/2
    exponents -- ((low, high), ...): its n positive Lyapunov exponents, larger first
    moved     -- how far the points are from those of the state: the largest coordinate, on the
                 torus
    """

    state: State
    digits: int
    radius: Fraction
    least: Fraction
    action: Bounds
    exponents: Tuple[Bounds, ...]
    moved: float
    displacements: Tuple[Tuple[Fraction, ...], ...]

    label = "proved"

    def __repr__(self):
        return "<ProvedOrbit %s, %s, eps %r, radius %s>" % (
            self.state.potential.name, _type(self.state), self.state.eps, distances(self)[0])

    @cached_property
    def points(self) -> Tuple[Tuple[Fraction, ...], ...]:
        """The centre of the ball: q points in [0, 1)^n, exactly."""
        state = self.state
        return tuple(tuple((Fraction(o) + Fraction(j * p % state.q, state.q) + x) % 1
                           for o, p, x in zip(state.origin, state.p, u))
                     for j, u in enumerate(self.displacements))

    @cached_property
    def nearest(self) -> State:
        """The points that were proved as doubles have them, to be drawn or measured."""
        return self.state.moved(np.array(self.displacements, dtype=float))

    def report(self) -> str:
        """The theorem in words."""
        state, (within, moved) = self.state, distances(self)
        lines = [
            "Proved, with %d decimal places: the map x' = x + p', p' = p - eps grad V(x) with the "
            "potential %s," % (self.digits, state.potential.name),
            "V(x) = %s," % state.potential.formula,
            "and eps = %s has exactly one orbit of type %s within %s of the points computed"
            % (_eps(state), _type(state), within),
            "(Euclidean norm of all coordinates together), which are within %s of those given (each "
            "coordinate)." % moved,
            "It is hyperbolic and, run through any number of times, a nondegenerate local minimum of "
            "the action:", "second variation at least %s." % _round(self.least, 3, up=False),
            "Action per point less |p/q|^2/2: %s." % _interval(self.action)] + [
            "Exponent: %s." % _interval(exponent) for exponent in self.exponents]
        return "\n".join(lines) + "\n"


def prove(state: State, digits: Optional[int] = None, descend: bool = False) -> ProvedOrbit:
    """Proves that a true orbit lies beside a state of least action: a ProvedOrbit, whose radius is
    at most 10^-digits, by default 10^-20.

    The points are made as exact as that needs.  Where phases are undetermined in doubles they are
    determined here, and the points may move: see `moved`.
    descend -- from a saddle whose least eigenvalue is above -1e-8, prove the minimum below it,
               which is elsewhere; a steeper one is left by state.relax()
    NotProved, with a reason: among others, because the state is none of an orbit, or a saddle."""
    wanted = DIGITS if digits is None else digits
    expected(state)
    if not isinstance(wanted, int) or not 1 <= wanted <= MOST - 2 * GUARD:
        raise ValueError("digits is a number from 1 to %d, not %r" % (MOST - 2 * GUARD, digits))
    if state.eps == 0:
        raise NotProved("without a perturbation, at eps 0, no orbit is isolated")
    exact = _Exact(state)
    with np.errstate(all="ignore"):
        shadow = state.shadow
    if not shadow < STATIONARY:
        raise NotProved("the state is not stationary, its gradient is %.1e: relax() it first"
                        % shadow)
    if state.least < -SOFT:
        raise NotProved("the state is a saddle: the least eigenvalue of its Hessian is about %.1e"
                        % state.least)
    if not descend and state.label == "saddle":
        raise NotProved("the state is a saddle: it, or it run through several times, is no minimum of "
                        "the action")
    places, most = wanted + 2 * GUARD, min(MOST, wanted + 2 * GUARD + MORE)
    orbit, reason = None, None
    while True:
        try:
            orbit = _attempt(state, exact, places, wanted)
            if all(high - low <= high / 10 ** GUARD for low, high in orbit.exponents):
                return orbit
        except _TooFewPlaces as error:
            reason = error
        if places == most:
            break
        places = min(most, max(places + 15, places * 3 // 2))
    if orbit is None:
        raise NotProved("%s: %d decimal places do not tell" % (reason, places))
    return orbit


class _TooFewPlaces(Exception):
    """What the proof stumbled over; more decimal places may help."""


class _Exact:
    """A state in decimals, in the C core."""

    def __init__(self, state):
        potential = state.potential
        self.q, self.n, kind = state.q, potential.n, potential.native.kind
        if kind == lib.CV_PYTHON:
            raise ValueError("nothing can be proved of the potential %s: only Fourier sums, poly "
                             "and ff have exact values" % potential.name)
        # Doubles that are at least what docs/orbits-proof.md says, taken as what they are.
        self.curvature, self.lipschitz = map(Fraction, (potential.curvature, potential.lipschitz))
        self.potential = potential
        self.terms = potential.terms if kind == lib.CV_FOURIER else {}
        u = np.zeros((self.q, 2))
        u[:, :self.n] = state.u
        numbers = [_eps(state), _decimal(self.curvature, 6, up=True),
                   _decimal(self.lipschitz, 6, up=True)] + [str(Decimal(x)) for x in state.origin]
        owners, array = _strings(numbers)
        waves = ffi.new("int[]", [i for k in self.terms for i in (k + (0,))[:2]])
        handle = ffi.new("cv_exact **")
        done(lib.cv_exact_new(handle, kind, self.n, len(self.terms), waves,
                               [int(i) for i in state.p] + [0] * (2 - self.n), self.q, array,
                               address(u)))
        self.handle = ffi.gc(handle[0], lib.cv_exact_free)
        self.eps = abs(Fraction(_eps(state)))
        self.places = None

    def evaluate(self, places):
        """Gradient, Hessian and action of the points as they are, with so many decimal places."""
        if places != self.places:
            scale = [c for i in (0, 1) for c in (term[i] for term in self.terms.values())]
            self._owners, self._amplitudes = _strings(
                [_amplitude(self.potential, c, places) for c in scale])
            self.places = places
        done(lib.cv_exact_evaluate(self.handle, places, self._amplitudes))
        self.gradient = self.bound(lib.CV_GRADIENT)
        self.action = self.bound(lib.CV_ACTION_LOW), self.bound(lib.CV_ACTION_HIGH)

    def keep(self):
        """Remembers the points, and goes back to them."""
        done(lib.cv_exact_keep(self.handle, 0))

    def back(self):
        done(lib.cv_exact_keep(self.handle, 1))

    def newton(self, shift):
        """Makes a step of Newton's method.  False: Hessian + shift is not positive definite."""
        return self._succeeds(lib.cv_exact_newton(self.handle, self._text(shift)))

    def bends(self, shift):
        """Is the Hessian + shift positive definite?  No promise."""
        return self._succeeds(lib.cv_exact_bends(self.handle, self._text(shift)))

    def least(self, m):
        """Is no eigenvalue of any copy's Hessian below m?"""
        return self._succeeds(lib.cv_exact_least(self.handle, self._text(m)))

    def pivots(self, m, away):
        """Encloses the pivots; CV_UNDECIDED, CV_REAL or CV_COMPLEX.  None: it could not be done."""
        kind = ffi.new("int *")
        if self._succeeds(lib.cv_exact_pivots(self.handle, self._text(m), self._text(away, up=True),
                                              kind)):
            return kind[0]
        return None

    def bound(self, which):
        return Fraction(Decimal(_text(lib.cv_exact_bound(self.handle, which))))

    def displacements(self):
        return tuple(tuple(Fraction(Decimal(_text(lib.cv_exact_point(self.handle, j, i))))
                           for i in range(self.n)) for j in range(self.q))

    def _text(self, x, up=False):
        return _decimal(x, self.places, up).encode()

    @staticmethod
    def _succeeds(code):
        return code != lib.CV_ESINGULAR and done(code) == lib.CV_OK


def _attempt(state, exact, places, wanted):
    ulp = Fraction(1, 10 ** places)
    floor = ulp * 10 ** (2 * GUARD)
    _refine(state, exact, places, floor)
    displacements = exact.displacements()
    steps = [abs(float(new - Fraction(old)))
             for row, olds in zip(displacements, state.u.tolist()) for new, old in zip(row, olds)]
    bend = exact.eps * exact.lipschitz
    least = _least(state, exact, floor, float(bend) * math.hypot(*steps))
    radius = exact.gradient / least * Fraction(9, 8) + ulp
    left = least - bend * radius
    if not exact.gradient < radius * left or left < least / 2:
        raise _TooFewPlaces("the gradient is too large for so flat a minimum")
    if radius > Fraction(1, 10 ** wanted):
        raise _TooFewPlaces("the orbit is known to %.1e only" % radius)
    away = bend * radius + ulp
    strict = max(4 * away, ulp * 10 ** GUARD)
    if strict > least / 2:
        raise _TooFewPlaces("the minimum is too flat")
    kind = exact.pivots(strict, away)
    if kind is None:
        raise _TooFewPlaces("the pivots could not be enclosed")
    action = (exact.action[0] - exact.gradient * radius / state.q, exact.action[1])
    moved = max(abs(step - round(step)) for step in steps)
    return ProvedOrbit(state, places, radius, left, action, _exponents(state, exact, kind), moved,
                       displacements)


def _refine(state, exact, places, floor):
    """Newton's method until the gradient is as small as so many places allow.

    Where the Hessian is not positive, but for less than what doubles see of it, the step is made
    with Hessian + shift.  A long way along a soft direction bends into the others: steps with a
    shift that stops the soft ones bring these back.  What raises the action is taken back."""
    exact.evaluate(places)
    noise, shift = 4 * exact.bound(lib.CV_NOISE), Fraction(0)
    for _ in range(STEPS):
        gradient, action = exact.gradient, exact.action
        if not exact.bends(shift or -floor):
            if not shift and exact.bends(floor):
                raise _TooFewPlaces("the minimum is too flat, if it is one")
            if not exact.bends(SOFT):
                raise NotProved("the state is a saddle")
            shift = _boundary(max(shift, floor), SOFT, exact.bends, 16)[1]
        exact.keep()
        exact.newton(shift)
        exact.evaluate(places)
        still = None
        while (exact.gradient > max(gradient, noise)
               and (still is None or 2 * exact.gradient < still)):
            still = exact.gradient
            exact.newton(SOFT)
            exact.evaluate(places)
        if exact.action[0] > action[1]:
            exact.back()
            exact.evaluate(places)
            shift = max(16 * shift, floor, gradient / math.isqrt(state.q))  # no further than 1
        elif not shift and exact.gradient < noise:
            return
        else:
            shift *= min(Fraction(1, 64), (exact.gradient / gradient) ** 2)
            if shift < floor:
                shift = Fraction(0)
    raise _TooFewPlaces("Newton's method did not converge")


def _least(state, exact, floor, change):
    """A number that no eigenvalue of any copy's Hessian is below, within a few per cent of the
    largest.  change: by how much the eigenvalues may be others than those of the state, whose
    points are others."""
    guess = max(Fraction(state.least), Fraction(1, 10 ** 11)) * Fraction(49, 50)
    more = Fraction(21, 20)
    if exact.least(guess):
        if change + ROUNDING < state.least / 100 or not exact.least(guess * more):
            return guess
        low, high = guess * more, guess * 16
        while exact.least(high):
            low, high = high, high * 16
        return _boundary(low, high, lambda m: not exact.least(m), more)[0]
    if not exact.least(floor):
        if exact.bends(-floor * 10 ** GUARD):
            raise NotProved("the orbit is no minimum of the action when it is run through several "
                            "times")
        raise _TooFewPlaces("the minimum is too flat")
    return _boundary(floor, guess, lambda m: not exact.least(m), more)[0]


def _boundary(low, high, holds, ratio):
    """Brings low and high together, to that ratio, with holds(high) and not holds(low) as given."""
    while high > ratio * low:
        scale = 10 ** (MOST + GUARD)
        middle = Fraction(math.isqrt(int(low * high * scale ** 2)), scale)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return low, high


def _exponents(state, exact, kind):
    """Enclosures of the exponents, from that of the product of the determinants, their sum, and
    what is known of the two eigenvalues.  If one's modulus is, the other's is the determinant over
    it; if they are complex, both are the determinant's root; if nothing is, the larger is at least
    that."""
    total = (log_bounds(exact.bound(lib.CV_DET_LOW))[0],
             log_bounds(exact.bound(lib.CV_DET_HIGH))[1])
    half = (total[0] / 2, total[1] / 2)
    if state.potential.n == 1:
        pair = (total,)
    elif kind == lib.CV_COMPLEX:
        pair = (half, half)
    else:
        high = log_bounds(exact.bound(lib.CV_GROWTH_HIGH))[1]
        if kind == lib.CV_REAL:
            one = (log_bounds(exact.bound(lib.CV_GROWTH_LOW))[0], high)
            other = (total[0] - one[1], total[1] - one[0])
            pair = (tuple(map(max, one, other)), tuple(map(min, one, other)))
        else:
            pair = ((half[0], high), (total[0] - high, half[1]))
    return tuple((_places(max(low, 0) / state.q, up=False), _places(high / state.q, up=True))
                 for low, high in pair)


# ---- numbers

def _amplitude(potential, c, places):
    """scale * c to within 10^-places, as a decimal string."""
    digits = places + 2 + len(str(math.ceil(abs(c))))
    return _decimal(min(c * x for x in potential.scale_within(digits)), places + 1)


def log_bounds(x: Fraction) -> Bounds:
    """Two Fractions around the natural logarithm of x > 0.

    x = y 2^k, 1/2 < y < 2, log y = 2 artanh z, z = (y - 1)/(y + 1), |z| < 1/3, and log 2 is
    2 artanh(1/3).
    The series is cut where a power is below one unit, 10^-60; all further terms together are below
    two.  Each power is off by less than 2 units, each term by less than 3, and fewer than 70 are
    added, so that twice their sum is off by less than 500 units."""
    unit = 10 ** 60

    def twice_artanh(z):
        sign, power = (-1 if z < 0 else 1), abs(z.numerator) * unit // z.denominator
        square, total, n = power * power // unit, 0, 1
        while power:
            total += power // n
            power, n = power * square // unit, n + 2
        return 2 * sign * total

    k = x.numerator.bit_length() - x.denominator.bit_length()
    y = x / Fraction(2) ** k
    middle = twice_artanh((y - 1) / (y + 1)) + k * twice_artanh(Fraction(1, 3))
    off = 500 * (1 + abs(k))
    return Fraction(middle - off, unit), Fraction(middle + off, unit)


def distances(proof):
    """radius and moved in words, rounded up."""
    return (_round(proof.radius, 2, up=True),
            _round(Fraction(proof.moved) * (1 + Fraction(1, 2 ** 50)), 2, up=True))


def _eps(state):
    """eps as the exact decimal that it stands for."""
    return str(Decimal(repr(state.eps)))


def _type(state):
    return "(%s)/%d" % (", ".join(map(str, state.p)), state.q)


def _places(x, places=45, up=False):
    """x cut to so many places, downwards or upwards."""
    scaled = x * 10 ** places
    return Fraction(math.ceil(scaled) if up else math.floor(scaled), 10 ** places)


def _decimal(x, places, up=False):
    """The same as a decimal string."""
    scaled = Fraction(x) * 10 ** places
    return "%de-%d" % (math.ceil(scaled) if up else math.floor(scaled), places)


def _round(x, digits, up):
    """A number >= 0 rounded to so many digits, downwards or upwards."""
    if not x:
        return "0"
    order = 0
    while x >= Fraction(10) ** (order + 1):
        order += 1
    while x < Fraction(10) ** order:
        order -= 1
    scaled = x / Fraction(10) ** (order - digits + 1)
    text = str(math.ceil(scaled) if up else math.floor(scaled))     # 10^digits at most
    return "%s.%se%d" % (text[0], text[1:digits], order + len(text) - digits)


def _interval(ends):
    """Both ends rounded outwards, to a place or two after the first in which they differ."""
    places = 2
    while places < SHOWN and (ends[1] - ends[0]) * 10 ** places < 1:
        places += 1
    texts = []
    for x, up in zip(ends, (False, True)):
        scaled = int(_places(x, places, up) * 10 ** places)
        digits = str(abs(scaled)).rjust(places + 1, "0")
        texts.append("-" * (scaled < 0) + digits[:-places] + "." + digits[-places:])
    return "from %s to %s" % tuple(texts)


def _strings(texts):
    """C strings, and the array of their addresses."""
    owners = [ffi.new("char[]", text.encode("ascii")) for text in texts]
    return owners, ffi.new("char *[]", owners)


def _text(pointer):
    if not pointer:
        raise MemoryError("there is not enough memory")
    text = ffi.string(pointer).decode("ascii")
    lib.cv_free(pointer)
    return text
