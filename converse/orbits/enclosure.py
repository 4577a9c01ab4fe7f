"""The action of a state, its gradient and its Hessian, and bounds of the Hessian's eigenvalues, in
ball arithmetic: python-flint's arb, a midpoint and a radius that bounds every rounding, and
matrices of them.

docs/proofs/proved-orbits.md has the theorems.  The Hessian of the action is a chain: n x n
blocks beta_j = 2 - eps V''(x_j), and -1 between neighbours, cyclically.
"""

from fractions import Fraction

from flint import arb, arb_mat, ctx, fmpq, fmpz

from .limits import GUARD_BITS


def bits_of(places):
    """The precision, in bits, of balls with this number of decimal places, and some to spare."""
    return places * 3322 // 1000 + GUARD_BITS


# ---- numbers

def ball(x):
    """A Fraction, enclosed."""
    return arb(fmpq(x.numerator, x.denominator))


def exact(x):
    """A ball without a radius as a rational number of python-flint."""
    mantissa, exponent = (int(i) for i in x.man_exp())
    return fmpq(mantissa << max(exponent, 0), fmpz(1) << max(-exponent, 0))


def lower(x):
    """The lower end of a ball as a Fraction."""
    return _fraction(x.lower())


def upper(x):
    return _fraction(x.upper())


def _fraction(x):
    x = exact(x)
    return Fraction(int(x.p), int(x.q))


# ---- small matrices; symmetric ones are so to the last bit

def inverse(x):
    """The inverse of a symmetric matrix; None, unless it is certainly positive definite."""
    if x.nrows() == 1:
        a = x[0, 0]
        return arb_mat(1, 1, [1 / a]) if a > 0 else None
    a, b, c = x[0, 0], x[0, 1], x[1, 1]
    det = a * c - b * b
    if not (det > 0 and a > 0):
        return None
    b = -b / det
    return arb_mat(2, 2, [c / det, b, b, a / det])


def is_positive(x):
    return inverse(x) is not None


def unit(n, x=1):
    """x times the unit matrix."""
    return arb_mat(n, n, [arb(x) if i == j else arb(0) for i in range(n) for j in range(n)])


def norm(x):
    """An upper bound of the norm of every matrix in a ball: the sum of all entries' sizes."""
    return sum(map(abs, x.entries()), arb(0)).upper()


def square(v):
    """|v|^2 of a column."""
    return (v.transpose() * v)[0, 0]


# ---- potentials: functions of a point, base + u with base a rational number and u without radius,
# ---- to a list of balls: V, its gradient, and the entries 00, 01, 11 of its Hessian

def law_of(potential, digits):
    """All are linear in the cosines and sines of 2 pi k.x, unless the potential says otherwise."""
    if hasattr(potential, "law"):
        return potential.law
    turn, axes, terms = 2 * arb.pi(), range(potential.n), potential.coefficients(digits)
    columns = []
    for k, *both in terms:
        k = [turn * i for i in k[:potential.n]]
        cosine, sine = (ball(low).union(ball(high)) for low, high in both)
        for wave, slope in (cosine, sine), (sine, -cosine):
            columns.append([wave] + [slope * i for i in k] + [
                -wave * k[i] * k[j] for i in axes for j in axes[i:]])
    law = arb_mat([list(row) for row in zip(*columns)])
    doubled = [[2 * i for i in k] for k, *_ in terms]

    def local(base, u):
        x = [arb(i) + j for i, j in zip(base, u)]
        waves = []
        for k in doubled:
            phase = x[0] * k[0]
            if len(x) == 2:
                phase += x[1] * k[1]
            sine, cosine = phase.sin_cos_pi()
            waves += cosine, sine
        return (law * arb_mat(len(waves), 1, waves)).entries()
    return local


# ---- the state

class Enclosure:
    """A state, its points exact and all else in balls.

    u        -- the displacements: columns without radius
    gradient -- a Fraction, not below the Euclidean norm of the gradient of the action
    action   -- two Fractions around the action per point less the straight orbit's
    """

    def __init__(self, state, eps):
        self.potential, self.q, self.n = state.potential, state.q, state.potential.n
        self.eps, self.places = eps, None
        self.base = [[fmpq(*x.as_integer_ratio()) + fmpq(j * p % self.q, self.q)
                      for x, p in zip(state.origin, state.p)] for j in range(self.q)]
        self.u = [arb_mat(self.n, 1, [arb(x) for x in row]) for row in state.u.tolist()]

    def evaluate(self, places):
        """Gradient, Hessian and action of the points as they are, to this number of places."""
        n, q, u = self.n, self.q, self.u
        if places != self.places:
            ctx.prec = bits_of(places)
            self.places, self.ulp = places, ball(Fraction(1, 10 ** places))
            self.local = law_of(self.potential, places + GUARD_BITS // 3)
        eps = ball(self.eps)
        two, radii, squares, action = unit(n, 2), unit(n, 0), arb(0), arb(0)
        self.force, self.beta = [], []
        for j in range(q):
            here, after = u[j], u[j + 1 - q]
            value, *rest = self.local(self.base[j], here.entries())
            step = after - here
            force = here - u[j - 1] - step - arb_mat(n, 1, rest[:n]) * eps
            action += square(step) / 2 - eps * value
            squares += square(force)
            self.force.append(force)
            bend = rest if n == 1 else [rest[2], rest[3], rest[3], rest[4]]
            beta = two - arb_mat(n, n, bend[-n * n:]) * eps
            self.beta.append(beta)
            radii += beta - beta.mid()
        self.margin = self.ulp + 2 * norm(radii)
        self.gradient = upper(squares.upper().sqrt())
        self.action = lower(action / q), upper(action / q)

    def noise(self):
        """About the smallest gradient that these places can show."""
        radii = sum((square(force - force.mid()) for force in self.force), arb(0))
        return upper(radii.upper().sqrt() + 4 * self.ulp * arb(2 * self.q).sqrt())

    def displacements(self):
        return tuple(tuple(_fraction(i) for i in u.entries()) for u in self.u)

    # ---- eliminations, of midpoints: their results are guesses, which are checked later

    def _eliminate(self, shift, links=None, force=None):
        """The points 1, 2, ..., q - 1 of the chain from point 0 once round to point 0 again are
        eliminated, with beta + shift for beta.  Returns E, which that adds to the block of the
        first point, F, where -F couples it to the last, and G, the block of the last.  None: a
        pivot is not positive definite.
        links: a list that receives for each point its inverse pivot, its coupling to the first
        point, and its right-hand side, which is -force and the eliminated terms; for the last point
        the right-hand side alone."""
        zero, shift = unit(self.n, 0), unit(self.n, shift)
        before, E, F, side = zero, zero, unit(self.n), arb_mat(self.n, 1)
        for j in range(1, self.q + 1):
            G = (self.beta[j % self.q] + shift - before).mid()
            if links is not None:
                side = (before * side - force[j % self.q]).mid()
            before = inverse(G)
            if before is None:
                return None
            if j == self.q:
                break
            before = before.mid()
            if links is not None:
                links.append((before, F, side))
            through = F * before
            E, F = (E - through * F.transpose()).mid(), through.mid()
        if links is not None:
            links.append(side)
        return E, F, G

    @staticmethod
    def _last(E, F, G):
        """The block of point 0, when all others were eliminated."""
        return E + G - F - F.transpose()

    def bends(self, shift):
        """Is the Hessian + shift positive definite?  No promise."""
        chain = self._eliminate(ball(shift))
        return chain is not None and is_positive(self._last(*chain))

    def newton(self, shift):
        """Makes a step of Newton's method with Hessian + shift, if that is positive definite.  No
        promise."""
        moves = self.solution(self.force, shift)
        if moves is not None:
            self.move(moves)

    def move(self, moves):
        self.u = [(u + move).mid() for u, move in zip(self.u, moves)]

    def solution(self, force, shift):
        """About the v with (Hessian + shift) v = -force, if that is positive definite; else None.
        No promise."""
        links = []
        chain = self._eliminate(ball(shift), links, force)
        pivot = None if chain is None else inverse(self._last(*chain))
        if pivot is None:
            return None
        side = links.pop()
        for before, F, r in links:
            side += F * (before * r)
        first = after = (pivot * side).mid()
        moves = []
        for j in range(len(links) - 1, -1, -1):
            before, F, r = links[j]
            after = (before * (r + after + F.transpose() * first)).mid()
            moves.append(after)
        return [first] + moves[::-1]

    def nudge(self):
        """Moves point 0 by 10^-10, in no particular direction."""
        step = arb_mat(self.n, 1, [arb(i) / 2 ** 34 for i in (2, 1)][:self.n])
        self.u[0] = (self.u[0] + step).mid()

    def pivot_after_all(self, shift):
        """The pivot of point 0 after very many rounds: the chain is joined to a copy of itself, and
        so is the result, until its ends do not affect each other.  None: a pivot is not positive,
        so some copies of the orbit together are not a minimum.  No promise."""
        chain = self._eliminate(shift)
        if chain is None:
            return None
        E, F, G = chain
        for _ in range(4 * self.places):
            between = inverse(E + G)
            if between is None:
                return None
            E, G, F = ((E - F * between * F.transpose()).mid(),
                       (G - F.transpose() * between * F).mid(), (F * between * F).mid())
            if all(abs(i) < self.ulp for i in F.entries()):
                return ((G + G.transpose()) / 2).mid()
        return None

    # ---- pivots, with promises

    def tube(self, first, shift):
        """Symmetric matrices s_j, without radius, and s_q, which follows at point 0:

            |s_j + 1/s_{j-1} - beta_j - shift| <= margin        for j = 1, ..., q,

        as a norm, for every beta_j in its ball.  None: an s_j, j < q, is not positive definite, or
        the radii are too large."""
        s, shift, radii = [first], unit(self.n, shift), unit(self.n, 0)
        for j in range(1, self.q + 1):
            turned = inverse(s[-1])
            if turned is None:
                return None
            following = self.beta[j % self.q] + shift - turned
            s.append(following.mid())
            radii += following - s[-1]      # The sum of the radii bounds each.
        return s if norm(radii) <= self.margin else None

    def below(self, m):
        """s with s_j + 1/s_{j-1} <= beta_j - m, s > 0, for all j cyclically; None: not found.  It
        begins with the pivot for a slightly larger m, so that s_0 <= s_q closes the circle."""
        first = self.pivot_after_all(-m - 4 * self.margin)
        s = None if first is None else self.tube(first, -m - self.margin)
        return s[:-1] if s is not None and is_positive(s[-1] - first) else None

    def above(self, away, strict):
        """t with t_j + 1/t_{j-1} >= beta_j + away for all j cyclically; None: not found."""
        first = self.pivot_after_all(away + strict + 4 * self.margin)
        t = None if first is None else self.tube(first, away + self.margin)
        return t[:-1] if t is not None and is_positive(first - t[-1]) else None

    def least(self, m):
        """Is it proved that no eigenvalue of any copy's Hessian is below m?"""
        return self.below(ball(m)) is not None
