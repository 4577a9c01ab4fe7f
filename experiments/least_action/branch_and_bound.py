"""The least action of all states of a type, by branch and bound: `low` and `high` are proved, with
all roundings.

A corridor, one rectangle for each point, is excluded by min-plus sums over the rectangles' grids
(minplus.c, where the margins are proved), or is settled where the action is convex.
"""

import heapq
from dataclasses import dataclass
from math import gcd, inf, sqrt
from typing import Callable, Optional

import numpy as np

from converse import ConverseError
from converse._native import ffi
from converse.orbits.limits import MAX_DISPLACEMENT
from converse.orbits.potential import Numerators, Source, address, known, told, whole
from converse.orbits.state import PeriodicOrbit, type_of
from converse.prover.native import check

from .action import (LARGEST_EPS, U, action_bounds, action_on_grid, errors_near, floats_within,
                     gradient_bounds, per_point, rounding_errors)
from .build import library

MAX_Q = 500                     # The period q for which a least action is looked for.
MIN_NODES = 65                  # Nodes along an axis of a rectangle.
MAX_PITCH = 1 / 64              # Their distance, if MAX_NODES allows that.
MAX_NODES = 2000000             # Nodes of all rectangles: a quarter of a second.
ROWS_PER_POLL = 64              # Rows that are multiplied between two looks for Ctrl-C.
MAX_SETTLED_GAP = 1e-12         # An action per point that is known as well as this is settled.


@dataclass(frozen=True, eq=False)
class LeastAction:
    """low <= the least action of all states of state's type and eps <= high: proved.  Both are per
    point and less the straight orbit's action.

    state     -- one whose action is at most high
    copies    -- how often the state of least action runs through an orbit: proved; 1: nothing is
                 claimed
    corridors -- how many products of rectangles were looked into
    """

    low: float
    high: float
    state: PeriodicOrbit
    copies: int
    corridors: int


@dataclass(frozen=True)
class _Settled:
    """The result for a corridor: no state in it has less action than bound; copies as above."""

    bound: float
    copies: int


def _least_eigenvalue(matrix, guess):
    """A number, proved to be no more than any eigenvalue of a symmetric matrix, of which the least
    is about the guess."""
    size = len(matrix)
    guess -= 1e-14 * size + 1e-3 * abs(guess)
    shifted = matrix - guess * np.eye(size)
    try:
        lower = np.linalg.cholesky(shifted)
    except np.linalg.LinAlgError:
        return -inf
    # lower lower^T has no negative eigenvalue; rows' sums bound the eigenvalues of the rest
    sizes, sums = np.abs(lower), np.zeros(size)
    for rows in (slice(k, k + ROWS_PER_POLL) for k in range(0, size, ROWS_PER_POLL)):
        rest = np.abs(shifted[rows] - np.einsum("ik,jk->ij", lower[rows], lower))
        rest += 4 * (size + 4) * U * (np.einsum("ik,jk->ij", sizes[rows], sizes)
                                      + np.abs(matrix[rows]) + abs(guess))
        sums[rows] = rest.sum(1)
    return guess - 1.001 * float(sums.max())


class _Search:
    """Branch and bound over corridors: rectangles low[j] to high[j], arrays (q, 2), one for each
    point's displacement z_j from j p/q.  Actions here are sums over all points.

    Of a least state's points that one is called 0 where V is largest (eps < 0: least), and whole
    turns bring it to 0 <= z_0 <= 1."""

    def __init__(self, state):
        self.q, self.n, self.eps = state.q, state.potential.n, state.eps
        self.potential, self.best, self.known = state.potential, state, inf
        self.base = np.zeros((self.q, 2))
        self.base[:, :self.n] = state.base

    # ---- states

    def relaxed(self, z):
        """A state near z, an orbit if there is one, and remembered if it is the best so far."""
        state = self.best.moved(z[:, :self.n])
        try:
            state = state.relax(max_steps=50)
        except ConverseError:
            pass
        high = action_bounds(state)[1]
        if high < self.known:
            self.best, self.known = state, high
        return state

    # ---- corridors

    def root(self):
        """All that a least state can be: sum |z_{j+1} - z_j|^2/2 is its action less the sum
        of -eps V, and |z_j - z_0|^2 is at most 2 j (q - j)/q times that."""
        W, off, rise = action_on_grid(self.potential, self.eps, 64)
        energy = self.known - self.q * float(W.min() - off - rise)
        j = np.arange(self.q)
        reach = np.sqrt(2 * max(energy, 0.0) * j * (self.q - j) / self.q)[:, None] * 1.001 + 1e-6
        if not reach.max() < MAX_DISPLACEMENT / 2:
            raise ValueError("eps %r is too large for %d points: they could lie anywhere"
                             % (self.eps, self.q))
        low, high = np.zeros((self.q, 2)), np.zeros((self.q, 2))
        low[:, :self.n], high[:, :self.n] = -reach, 1 + reach
        return low, high

    def narrow(self, low, high):
        """Changes low and high to what a least state needs of them.  Returns the least action in
        there, infinite if there is none, and a path to begin with."""
        nodes = np.clip(np.ceil((high - low) / MAX_PITCH) + 1, MIN_NODES, 1025)
        nodes *= min(1.0, (MAX_NODES / nodes[:, :self.n].prod(1).sum()) ** (1 / self.n))
        nodes = np.maximum(nodes, 3).astype(np.intc)
        nodes[:, self.n:] = 1
        least, path = ffi.new("double *"), np.zeros((self.q, 2))
        check(library().cv_corridor(
            self.potential.native, self.q, self.eps, self.potential.curvature, address(self.base),
            self.known, address(nodes, "int(*)[2]"), address(low), address(high), least,
            address(path)))
        return least[0], path

    def convexity(self, low, high):
        """A number, proved to be no more than any eigenvalue of the action's Hessian in there: from
        the centre V'' changes by at most the Lipschitz constant times the distance."""
        centre, reach = (low + high) / 2, np.sqrt(((high - low) ** 2).sum(1)).max() * 0.5001
        change = abs(self.eps) * (self.potential.lipschitz * float(reach))
        if change > 1:
            return -inf
        state = self.best.moved(centre[:, :self.n])
        n, q, size = self.n, self.q, self.n * self.q
        matrix = np.zeros((q, n, q, n))
        for j, block in enumerate(self.potential.evaluate(state.base + state.u)[2]):
            matrix[j, :, j] += 2 * np.eye(n) - self.eps * block
            matrix[j, :, (j + 1) % q] -= np.eye(n)
            matrix[(j + 1) % q, :, j] -= np.eye(n)
        off = (1.001 * abs(self.eps) * errors_near(state)[2]
               + 32 * U * float(np.abs(matrix).max()))
        return _least_eigenvalue(matrix.reshape(size, size), state.least) - change - off

    def settled(self, low, high):
        """_Settled, if the action is convex in the corridor and its least value there known.

        Let mu be at most every eigenvalue, and g the gradient at z.  At z + t the action is at
        least the action at z plus g.t + mu |t|^2/2."""
        room = (high - low) / 8             # so that a least state on the edge is inside
        mu = self.convexity(low - room, high + room)
        if not mu > 0:
            return None
        low, high, room = low[:, :self.n], high[:, :self.n], room[:, :self.n]
        state = self.relaxed((low + high) / 2)
        if not ((low <= state.u) & (state.u <= high)).all():
            state = state.moved(np.clip(state.u, low, high))
        (least, most), (g, off) = action_bounds(state), gradient_bounds(state)
        t = np.clip(-g / mu, low - state.u, high - state.u)
        parts = np.append(g * t, mu / 2 * t ** 2)
        bound = (least + float(parts.sum()) - off * float((high - low).sum())
                 - 8 * len(parts) * U * float(np.abs(parts).sum()))
        if bound <= self.known and most - bound > MAX_SETTLED_GAP * self.q:
            return None
        return _Settled(bound, self.copies(state, low - room, high + room, mu))

    def copies(self, state, low, high, mu):
        """How many copies of an orbit the only orbit of a convex corridor is, if that is proved.

        Among states that are d copies, and within r of one with gradient g, the action is least
        inside, not on the edge, if r > 2 |g|/mu; and least among such states, it is an orbit."""
        whole = gcd(*state.p, self.q)
        for d in range(whole, 1, -1):
            if whole % d == 0:
                same = state.moved(np.tile(state.u.reshape(d, -1, self.n).mean(0), (d, 1)))
                g, off = gradient_bounds(same)
                r = float(min((same.u - low).min(), (high - same.u).min()))
                if r > 2.001 / mu * (sqrt(float((g ** 2).sum())) + off * sqrt(g.size)):
                    return d
        return 1

    def run(self, gap, corridors, progress=None):
        """Looks into corridors, the lowest first, until the least action is known to gap.  Returns
        a lower bound of it, copies as above, and how many corridors were looked into."""
        self.relaxed(np.zeros((self.q, 2)) + [*self.potential.start, 0.0][:2])
        pending, settled, count, pushed = [(-inf, 0, *self.root())], [], 0, 0
        while pending and count < corridors and self.known - pending[0][0] > gap:
            if progress is not None:
                progress(count, pending[0][0] / self.q, self.known / self.q)
            lowest, _, low, high = heapq.heappop(pending)
            done = self.settled(low, high)
            if done is not None:
                settled.append(done)
                continue
            size = high - low
            least, path = self.narrow(low, high)
            count += 1
            if least > self.known:
                continue
            self.relaxed(path)
            shrunk = np.log((high - low)[:, :self.n] / size[:, :self.n]).mean() < -0.175
            for half in [(low, high)] if shrunk else self.halves(low, high):
                pushed += 1
                heapq.heappush(pending, (max(lowest, least), pushed, *half))
        left = [corridor[0] for corridor in pending] + [done.bound for done in settled]
        if not left or min(left) > self.known:
            raise ConverseError("every state was excluded, even the best one: the curvature or the "
                                "Lipschitz constant of %s is too small" % self.potential.name)
        open_ = bool(pending) and pending[0][0] <= self.known
        copies = gcd(*(done.copies for done in settled if done.bound <= self.known))
        return min(left), 1 if open_ else copies, count

    @staticmethod
    def halves(low, high):
        """Cuts the first rectangle or, where that is small beside another, the longest."""
        size = high - low
        j = 0 if size[0].max() > 0.3 * size.max() else int(np.argmax(size.max(1)))
        axis = int(np.argmax(size[j]))
        upper, lower = low.copy(), high.copy()
        upper[j, axis] = lower[j, axis] = (low[j, axis] + high[j, axis]) / 2
        return [(low, lower), (upper, high)]


def least_action(potential: Source, p: Numerators, q: int, eps: float = 1.0, gap: float = 1e-9,
                 corridors: int = 10000,
                 progress: Optional[Callable[[int, float, float], object]] = None) -> LeastAction:
    """Bounds the least action of all states of type (p, q), by branch and bound.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
    q : int
    eps : float
    gap : float
        How far apart the bounds may stay, in action per point.
    corridors : int
        How many to look into at most; then the bounds are as far apart as they are.
    progress : callable, optional
        progress(corridors, low, high) is called with the number that was looked into, and with the
        bounds so far, about.

    Returns
    -------
    LeastAction

    Notes
    -----
    Above the eps where an orbit's tori break, q up to 30 takes seconds to minutes, and a gap of
    1e-12 is as cheap as a larger one.  Below, states slide along each other at no cost, and a small
    gap takes corridors without end.
    """
    potential = known(potential)
    told(progress)
    rounding_errors(potential, 1.0)
    eps, gap = floats_within("eps and gap", [eps, gap], LARGEST_EPS)
    corridors = whole("corridors", corridors, 1, 10 ** 9)
    q = whole("q", q, 1, MAX_Q)
    state = PeriodicOrbit(potential, type_of(potential, p, q)[0], q, eps,
                          np.zeros((q, potential.n)), (0.0,) * potential.n)
    if eps == 0:
        return LeastAction(0.0, 0.0, state, gcd(*state.p, state.q), 0)
    search = _Search(state)
    low, copies, count = search.run(gap * state.q, corridors, progress)
    low, high = per_point(low, search.known, state.q)
    return LeastAction(low, high, search.best, copies, count)
