"""Proved pairs: that a true pass lies beside one that was found, and how much more action it has
than the proved minimum.  docs/proofs/proved-orbits.md, section 6, has the theorem and its proof.

The pass is a saddle.  One point is made stiffer by sigma: H = P - sigma e e^T,
where P is positive definite.  The pivots certify this as they do for minima.  Bounds of H follow
from bounds of P by the formula of Sherman and Morrison.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Tuple

import numpy as np
from flint import arb, arb_mat

from ..model.balls import precision
from ..model.exact import Interval, rounded, whole_number
from .enclosure import Enclosure, ball, lower, square, upper
from .exponents import growth
from .limits import (DEFAULT_DIGITS, GUARD_PLACES, MAX_DIGITS, MAX_MORE_PLACES, MAX_PLACES,
                     MAX_PROOF_STEPS, MAX_STIFFNESS, SHOWN_PLACES)
from .minimax import Pair, gap_of, turn_of
from .proved import (NotProved, ProvedOrbit, TooFewPlaces, _eps, distance_words, grown, in_units,
                     prove)


@dataclass(frozen=True, eq=False, repr=False)
class ProvedPair:
    """A theorem about a minimum and a pass.

    Attributes
    ----------
    pair : Pair
        The states that were given.
    minimum : ProvedOrbit
        The proved minimum.
    digits : int
        The decimal places the proof of the pass was computed with.
    radius : Fraction
        There is exactly one true orbit of the type whose displacements are within radius of
        `displacements`, in the Euclidean norm of all coordinates together, both in turns.  The
        Hessian of its action has exactly one negative eigenvalue, and none is zero.
    action : Interval
        Its action per point less the straight orbit's, in the units of the map.
    flux : Interval
        Its action less the minimum's, of all q points together, in the units of the map.
    residue : Interval
        Its residue, which is positive.
    between : bool
        Is it proved that each of its points lies between the points of the minimum and of its
        neighbour?  False means undecided.
    """

    pair: Pair
    minimum: ProvedOrbit
    digits: int
    radius: Fraction
    displacements: Tuple[Tuple[Fraction, ...], ...]
    action: Interval
    flux: Interval
    residue: Interval
    between: bool

    def __repr__(self):
        return "<ProvedPair %s, %s, eps %r, flux %r>" % (
            self.pair.minimum.potential.name, self.pair.minimum.type_text, self.pair.minimum.eps,
            self.flux)

    def report(self) -> str:
        """The theorem in words, the minimum first."""
        state = self.pair.minimax
        lines = [
            "THEOREM, proved with %d decimal places: the same map has exactly one orbit of type %s "
            "within %s of the points" % (self.digits, state.type_text,
                                      distance_words(state.potential, self.radius)),
            "computed of the pass (Euclidean norm of all coordinates together).  The second "
            "variation of its action, run",
            "through once, has exactly one negative direction and is nondegenerate.",
            *["Each of its points is between that of the minimum and that of the minimum's "
              "neighbour."] * self.between,
            "Flux : %r" % (self.flux,)]
        if self.residue[1] < 10 ** SHOWN_PLACES:
            lines.append("Residue of the minimax orbit : %r" % (self.residue,))
        return self.minimum.report() + "\n".join(lines) + "\n"


def prove_pair(pair, digits=None):
    """See Pair.prove."""
    if pair.minimax.label == "not stationary":
        raise NotProved("the pass is not stationary, its gradient is %.1e" % pair.minimax._shadow)
    digits = DEFAULT_DIGITS if digits is None else whole_number(digits, "digits", 1, MAX_DIGITS)
    minimum, reason = prove(pair.minimum, digits), ""
    first = digits + 2 * GUARD_PLACES
    last = min(first + 2 * MAX_MORE_PLACES, MAX_PLACES + 1)
    for places in range(first, last, MAX_MORE_PLACES // 5):
        with precision():
            exact = Enclosure(pair.minimax, Fraction(_eps(pair.minimax)))
            try:
                found = _Pass(pair, minimum, exact, digits, places).proved()
            except TooFewPlaces as error:
                reason = str(error)
                continue
        width, most = found.flux[1] - found.flux[0], found.flux[1] / 10 ** GUARD_PLACES
        if width <= most:
            return found
        reason = "the flux is known to %.1e only" % width
        if 2 * pair.minimum.q * (minimum.action[1] - minimum.action[0]) > most:
            minimum = prove(pair.minimum, min(places, MAX_DIGITS))
    raise NotProved("of the pass, with %d decimal places: %s" % (places, reason))


class _Pass:
    """The proof of one pass to `digits` digits, computed with `places` decimal places."""

    def __init__(self, pair, minimum, exact, digits, places):
        self.pair, self.minimum, self.exact = pair, minimum, exact
        self.digits, self.places = digits, places
        self.j = int(np.argmax(np.abs(gap_of(pair.minimum))))
        if pair.minimax.label != "saddle":
            self.halfway()
        self.sigma = self.stiffness(pair.minimax)
        self.e = [arb_mat(1, 1, [int(j == self.j)]) for j in range(exact.q)]

    def halfway(self):
        """Begins half-way between the proved minimum and its neighbour.  Where doubles do not see a
        saddle, W is a sine wave."""
        q, own = self.exact.q, self.minimum.displacements
        r, shift = turn_of(self.pair.minimum), Fraction(1, q)
        self.exact.evaluate(self.places)
        self.exact.u = [arb_mat(1, 1, [ball((own[j][0] + own[(j + r) % q][0] + shift) / 2).mid()])
                        for j in range(q)]

    def stiffness(self, state):
        """sigma: 1 - 2 S, S < 0 the Schur complement of that coordinate in H."""
        b = np.zeros_like(state.u)
        b[self.j] = 1
        inside = state.solved(b)[self.j, 0]
        return 1 + Fraction(min(2 / abs(inside), MAX_STIFFNESS) if inside < 0 else 0.0)

    def evaluate(self):
        """Gradient, action, and P for the Hessian."""
        exact = self.exact
        exact.evaluate(self.places)
        exact.beta[self.j] += arb_mat(1, 1, [ball(self.sigma)])

    def column(self):
        """About P^-1 e."""
        found = self.exact.solution([-e for e in self.e], 0)
        if found is None:
            raise TooFewPlaces("with one coordinate held it is no minimum")
        return found

    def at(self, v):
        return v[self.j][0, 0]

    def refine(self):
        """Newton's method until the gradient is as small as the places allow."""
        exact, sigma = self.exact, ball(self.sigma)
        for _ in range(MAX_PROOF_STEPS):
            self.evaluate()
            if exact.gradient < 4 * exact.noise():
                return
            w, v = self.column(), exact.solution(exact.force, 0)
            along = (sigma * self.at(v) / (1 - sigma * self.at(w))).mid()
            exact.move([a + b * along for a, b in zip(v, w)])
            if not all(abs(x) < 1000 for u in exact.u for x in u.entries()):
                break
        raise TooFewPlaces("Newton's method did not converge")

    def proved(self):
        exact, state, sigma = self.exact, self.pair.minimax, ball(self.sigma)
        self.refine()
        m = Fraction(1)
        while not exact.least(m):
            m /= 4
            if m < Fraction(1, 10 ** (self.places - GUARD_PLACES)):
                raise TooFewPlaces("with one coordinate held it is too flat")
        w = self.column()
        left, size = arb(0), arb(0)             # of |P w - e|^2 and |w|^2
        for j in range(exact.q):
            left += square(exact.beta[j] * w[j] - w[j - 1] - w[j + 1 - exact.q] - self.e[j])
            size += square(w[j])
        off = left.upper().sqrt() / ball(m)
        size = (size.upper().sqrt() + off).upper()      # not below |P^-1 e|
        inside = self.at(w) + arb(0, 1) * off.upper()   # e.P^-1 e
        lost = 1 - sigma * inside
        if not lost < 0:
            raise TooFewPlaces("it is not decided whether there is a direction down")
        inverse = upper(1 / ball(m) + sigma * size * size / abs(lost))
        # lipschitz is a double above the K of docs/proofs/proved-orbits.md; here its exact value.
        bend = abs(exact.eps) * Fraction(state.potential.lipschitz)
        shown = self.places + GUARD_PLACES
        radius = rounded(2 * inverse * exact.gradient + Fraction(1, 10 ** self.places), shown,
                         up=True)
        if not (inverse * (exact.gradient + bend * radius ** 2 / 2) <= radius
                and inverse * bend * radius < 1):
            raise TooFewPlaces("the pass is too flat")
        if radius > Fraction(1, 10 ** self.digits):
            raise TooFewPlaces("the pass is known to %.1e only" % radius)
        reach = (4 + abs(exact.eps) * Fraction(state.potential.curvature)) * radius ** 2 / 2
        action = in_units(state.potential, (exact.action[0] - reach / exact.q,
                                            exact.action[1] + reach / exact.q), shown)
        own = self.minimum.action
        displacements = exact.displacements()
        return ProvedPair(self.pair, self.minimum, self.places, radius, displacements, action,
                          Interval(exact.q * (action[0] - own[1]), exact.q * (action[1] - own[0])),
                          self.residue(m, bend * radius, size, inside, shown),
                          self.between(displacements, radius))

    def residue(self, m, away, size, inside, shown):
        """Encloses the residue, -det P (1 - sigma e.P^-1 e)/4, of every orbit whose blocks are
        within `away` of these.  Here det P is l + 1/l - 2 of the chain of P."""
        ((low, high),), _ = grown(self.exact, growth, m, away)
        away += Fraction(1, 10 ** self.places)
        det = 2 * (ball(low).union(ball(high))).cosh() - 2
        far = ball(away) * size * size / (1 - ball(away / m))
        lost = 1 - ball(self.sigma) * (inside + arb(0, 1) * far.upper())
        found = -det * lost / 4
        if not found > 0:
            raise TooFewPlaces("the sign of the residue is not decided")
        return Interval(rounded(lower(found), shown, up=False),
                        rounded(upper(found), shown, up=True))

    def between(self, displacements, radius):
        """Is each point, wherever in its ball, between the minimum's and its neighbour's?"""
        q, own, away = self.exact.q, self.minimum.displacements, self.minimum.radius + radius
        origins = [Fraction(state.origin[0]) for state in (self.pair.minimum, self.pair.minimax)]
        r, step = turn_of(self.pair.minimum), Fraction(1, q)
        shift = origins[1] - origins[0]
        return all(own[j][0] + away < displacements[j][0] + shift
                   < own[(j + r) % q][0] + step - away for j in range(q))
