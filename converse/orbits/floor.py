"""Bounds of the action from below that hold for all orbits: the Lax-Oleinik operator on a grid.

The action of any path, rounded at random to the corners of a grid's cells, grows by little on the
average: csrc/orbits/minplus.c says by how much, and why.  So the least action on a grid, which is
found without guessing, bounds all from below.  The numbers low are proved, with all roundings,
and so is high; estimates are called estimates.
"""

import heapq
from dataclasses import dataclass
from itertools import combinations
from math import gcd, inf, sqrt, ulp
from typing import Sequence, Tuple

import numpy as np

from .._native import ffi, lib
from ..prover.native import check
from ..storage.files import ConverseError
from .potential import Potential, address, known, whole
from .state import FARTHEST, State, expected

U = 2.0 ** -53              # half the distance of the doubles next to 1
LARGEST_EPS = 1e6
LARGEST_ROTATION = 100
LONGEST = 500               # q


def _errors(potential, reach):
    """What V, its gradient and its Hessian may be off by in doubles: cv_errors.  ValueError, unless
    potential is one with which anything can be proved."""
    errors = ffi.new("double[3]")
    code = lib.cv_errors(potential.native, reach, errors)
    if potential.curvature is None or potential.lipschitz is None or code == lib.CV_EARGUMENT:
        raise ValueError("nothing can be proved of the potential %s: its rounding errors are not "
                         "known; take orbits.Fourier or one of the thesis's" % potential.name)
    check(code)
    return tuple(errors)


def _numbers(what, values, most):
    """As floats; ValueError, unless they are numbers of at most this size."""
    try:
        floats = [float(value) for value in values]
    except (TypeError, ValueError, OverflowError):
        floats = [inf]
    if not all(abs(value) <= most for value in floats):
        raise ValueError("%s: a list of numbers of at most %g, not %r" % (what, most, values))
    return floats


def _values(potential, x):
    """V at points (m, 2)."""
    values = np.empty(len(x))
    check(lib.cv_evaluate(potential.native, len(x), address(x), address(values, "double *"),
                          ffi.NULL, ffi.NULL))
    return values


def _torus(potential, eps, grid):
    """-eps V at the nodes i/grid, and what it may be off by; by how much a path's action per point
    grows when it is rounded to them."""
    n = potential.n
    x = np.zeros((grid ** n, 2))
    x[:, :n] = np.indices((grid,) * n).reshape(n, -1).T / grid
    W = -eps * _values(potential, x)
    off = abs(eps) * _errors(potential, 1.0)[0] + 2 * U * float(np.abs(W).max())
    rise = n * (1 + abs(eps) * potential.curvature) / (8 * grid ** 2) * (1 + 2.0 ** -40)
    return W, off, rise


# ---- one state

def _reach(state):
    """How large its points' coordinates are before whole turns are taken off."""
    return 1 + float(np.abs(state.origin).max()) + float(np.abs(state.u).max())


def _action(state):
    """Two numbers around the sum of |u_{j+1} - u_j|^2/2 - eps V(x_j)."""
    step, x = np.roll(state.u, -1, 0) - state.u, np.zeros((state.q, 2))
    x[:, :state.potential.n] = state.base + state.u
    parts = np.append(step.ravel() ** 2 / 2, -state.eps * _values(state.potential, x))
    off = (2 * (len(parts) + 8) * U * float(np.abs(parts).sum())
           + state.q * abs(state.eps) * _errors(state.potential, _reach(state))[0])
    return float(parts.sum()) - off, float(parts.sum()) + off


def _gradient(state):
    """Of the action, and what each of its coordinates may be off by."""
    off = 8 * U * (4 * float(np.abs(state.u).max()) + float(np.abs(state.gradient).max()))
    return (state.gradient,
            off + 1.001 * abs(state.eps) * _errors(state.potential, _reach(state))[1])


def _per_point(low, high, q):
    low, high = low / q, high / q
    return low - ulp(low), high + ulp(high)


def enclosed_action(state: State) -> Tuple[float, float]:
    """Two numbers, proved to be around state.action, whether it is an orbit or not."""
    expected(state)
    _numbers("eps", [state.eps], LARGEST_EPS)
    low, high = _action(state)
    return _per_point(low, high, state.q)


# ---- the floor under all orbits of a rotation vector

@dataclass(frozen=True, eq=False)
class Floor:
    """low      -- the average action per point of any orbit of this rotation vector, and of any
                   other sequence of points, is no less: proved; less |rotation|^2/2, as
                   State.action
    estimate -- the same of paths on the grid: at most so much higher could low be
    c        -- low is |rotation - c|^2/2 below the least of W + |y - x - c|^2/2; any c bounds
    """

    potential: Potential
    eps: float
    rotation: Tuple[float, ...]
    grid: int
    low: float
    estimate: float
    c: Tuple[float, ...]


class _Torus:
    """The operator T on functions u on a grid, (T u)(y) = min of u(x) + W(x) + |y - x - c|^2/2, and
    a u with which to begin."""

    def __init__(self, potential, eps, grid, u=None):
        self.n, self.grid = potential.n, grid
        self.W, self.off, self.rise = _torus(potential, eps, grid)
        self.u = np.zeros(grid ** self.n) if u is None else u

    def apply(self, c, back=None):
        out, c = np.empty_like(self.u), np.array([*c, 0.0][:2])
        check(lib.cv_lax_oleinik(self.n, self.grid, address(c, "double *"),
                                 address(self.W, "double *"), address(self.u, "double *"),
                                 address(out, "double *"),
                                 ffi.NULL if back is None else address(back, "int(*)[2]")))
        return out

    def settle(self, c, tolerance, most):
        """Makes T u - u constant, but for the tolerance if `most` steps reach it; half steps do not
        go round with an orbit.  Returns its least value less all roundings: no closed path on the
        grid has less W + |y - x - c|^2/2 per step."""
        for step in range(most):
            change = self.apply(c) - self.u
            if step == most - 1 or change.max() - change.min() <= tolerance:
                break
            self.u += change / 2
            self.u -= self.u.min()
        size = float(np.abs(self.u).max() + np.abs(self.W).max())
        return (float(change.min()) - 2.0 ** -45 * (size + 8 * max(1.0, float(np.abs(c).max())))
                - 4 * U * size - self.off)

    def cycle(self, c, rotation):
        """Where the best predecessors lead back to, a closed path: its W + |y - x - rotation|^2/2
        per step, and rotation less its average step."""
        back = np.empty((len(self.u), 2), dtype=np.intc)
        self.apply(c, back)
        shape = (self.grid,) * self.n
        node = np.indices(shape).reshape(self.n, -1).T
        before = np.ravel_multi_index(tuple(((node - back[:, :self.n]) % self.grid).T), shape)
        seen, at = {}, 0
        while at not in seen:
            seen[at] = len(seen)
            at = int(before[at])
        path = list(seen)[seen[at]:]
        short = rotation - back[path, :self.n] / self.grid
        return float(np.mean(self.W[path] + (short ** 2).sum(1) / 2)), short.mean(0)

    def refined(self, potential, eps):
        """The same on a grid of half the pitch, u interpolated."""
        u = self.u.reshape((self.grid,) * self.n)
        for axis in range(self.n):
            between = (u + np.roll(u, -1, axis)) / 2
            u = np.stack([u, between], axis + 1).reshape(
                [2 * side if k == axis else side for k, side in enumerate(u.shape)])
        return _Torus(potential, eps, 2 * self.grid, u.ravel())


def _highest(planes, radius):
    """The highest point below all planes t = a + b.s over the cube |b_i| <= radius: (b, t)."""
    n = len(planes[0][1])
    rows = [[*-s, 1.0, a] for a, s in planes]           # of (b, t), at most the last number
    rows += [[*(sign * axis), 0.0, radius] for axis in np.eye(n) for sign in (-1.0, 1.0)]
    rows = np.array(rows)
    chosen = rows[np.array(list(combinations(range(len(rows)), n + 1)))]
    chosen = chosen[np.abs(np.linalg.det(chosen[:, :, :-1])) > 1e-12]
    corners = np.linalg.solve(chosen[:, :, :-1], chosen[:, :, -1:])[:, :, 0]
    below = (corners @ rows[:, :-1].T <= rows[:, -1] + 1e-12).all(1)
    best = max(corners[below], key=lambda corner: corner[n])
    return best[:n], float(best[n])


def floor(potential: Potential, eps: float, rotation: Sequence[float],
          grid: int = 256) -> Floor:
    """A Floor: how little action per point orbits of this rotation vector can have, by value
    iteration on grid^n nodes (Mather's beta from below).

    rotation -- n numbers, as doubles have them
    grid     -- nodes along an axis, 8 to 2048; the cost of the grid falls as 1/grid^2

    The action of a path x_0 ... x_m exceeds c.(x_m - x_0) by at least m times the least average on
    the grid, whatever c is; the c that gives the most is looked for by cutting planes, first on
    coarse grids: each closed path bounds what a c can give."""
    known(potential)
    (eps,), n = _numbers("eps", [eps], LARGEST_EPS), potential.n
    w = np.array(_numbers("rotation", rotation, LARGEST_ROTATION))
    if len(w) != n:
        raise ValueError("the rotation vectors of %s have %d numbers, not %d"
                         % (potential.name, n, len(w)))
    coarse = grid = whole("grid", grid, 8, 2048)
    while coarse % 2 == 0 and coarse >= 48:
        coarse //= 2
    torus = _Torus(potential, eps, coarse)
    # at c = rotation the bound is min W or more, and elsewhere mean W - |c - rotation|^2/2 or less
    radius = sqrt(2 * float(torus.W.mean() - torus.W.min()) + 1e-12) * 1.1
    tolerance = _torus(potential, eps, grid)[2] / 20
    planes, b = [], np.zeros(n)
    while True:
        low = -inf
        for _ in range(max(3, (512 // torus.grid) ** 2)):
            here = torus.settle(w + b, tolerance / 4, 400) - float(b @ b) / 2
            if here > low:
                low, best = here, b
            planes.append(torus.cycle(w + b, w))
            planes = sorted(planes, key=lambda plane: plane[0] + best @ plane[1])[:40]
            b, estimate = _highest(planes, radius)
            if estimate - low <= tolerance:
                break
        b = best
        if torus.grid == grid:
            break
        torus = torus.refined(potential, eps)
    size = float(np.abs(w).max() + np.abs(b).max() + 1)
    return Floor(potential, eps, tuple(map(float, w)), grid, low - torus.rise - 64 * U * size ** 2,
                 estimate, tuple(map(float, w + b)))


# ---- the least action over all states of a type

@dataclass(frozen=True, eq=False)
class LeastAction:
    """low <= the least action of all states of state's type and eps <= high, both per point, less
    that of the straight orbit, and proved.

    state     -- one whose action is at most high
    copies    -- the state of least action is an orbit run through so many times: proved; 1: nothing
                 is claimed
    corridors -- how many products of rectangles were looked into
    """

    low: float
    high: float
    state: State
    copies: int
    corridors: int


NODES = 65                  # at least, along an axis of a rectangle
PITCH = 1 / 64              # at most, if there are no more than
MOST_NODES = 2000000        # in all rectangles together: a quarter of a second
TINY = 1e-12                # of an action per point: what is as well known is settled


@dataclass(frozen=True)
class _Settled:
    """What a corridor was left with: no state in it has less action than bound; copies as above."""

    bound: float
    copies: int


def _least_eigenvalue(matrix):
    """A number, proved to be no more than any eigenvalue of a symmetric matrix."""
    size = len(matrix)
    guess = float(np.linalg.eigvalsh(matrix)[0])
    guess -= 1e-14 * size + 1e-3 * abs(guess)
    shifted = matrix - guess * np.eye(size)
    try:
        lower = np.linalg.cholesky(shifted)
    except np.linalg.LinAlgError:
        return -inf
    # lower lower^T has no negative eigenvalue, and the rest no larger one than its rows' sums
    rest = np.abs(shifted - np.einsum("ik,jk->ij", lower, lower))
    rest += 4 * (size + 4) * U * (np.einsum("ik,jk->ij", np.abs(lower), np.abs(lower))
                                  + np.abs(matrix) + abs(guess))
    return guess - 1.001 * float(rest.sum(1).max())


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
        high = _action(state)[1]
        if high < self.known:
            self.best, self.known = state, high
        return state

    # ---- corridors

    def root(self):
        """All that a least state can be: sum |z_{j+1} - z_j|^2/2 is its action less the sum
        of -eps V, and |z_j - z_0|^2 is at most 2 j (q - j)/q times that."""
        W, off, rise = _torus(self.potential, self.eps, 64)
        energy = self.known - self.q * float(W.min() - off - rise)
        j = np.arange(self.q)
        reach = np.sqrt(2 * max(energy, 0.0) * j * (self.q - j) / self.q)[:, None] * 1.001 + 1e-6
        if not reach.max() < FARTHEST / 2:
            raise ValueError("eps %r is too large for %d points: they could lie anywhere"
                             % (self.eps, self.q))
        low, high = np.zeros((self.q, 2)), np.zeros((self.q, 2))
        low[:, :self.n], high[:, :self.n] = -reach, 1 + reach
        return low, high

    def narrow(self, low, high):
        """Changes low and high to what a least state needs of them.  Returns the least action in
        there, infinite if there is none, and a path to begin with."""
        nodes = np.clip(np.ceil((high - low) / PITCH) + 1, NODES, 1025)
        nodes *= min(1.0, (MOST_NODES / nodes[:, :self.n].prod(1).sum()) ** (1 / self.n))
        nodes = np.maximum(nodes, 3).astype(np.intc)
        nodes[:, self.n:] = 1
        least, path = ffi.new("double *"), np.zeros((self.q, 2))
        check(lib.cv_corridor(
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
        off = (1.001 * abs(self.eps) * _errors(self.potential, _reach(state))[2]
               + 32 * U * float(np.abs(matrix).max()))
        return _least_eigenvalue(matrix.reshape(size, size)) - change - off

    def settled(self, low, high):
        """_Settled, if the action is convex in the corridor and its least value there known.

        With mu <= all eigenvalues and g the gradient at z, the action elsewhere exceeds that at z
        by at least g.t + mu |t|^2/2."""
        room = (high - low) / 8             # a least state on the edge shall be inside, too
        mu = self.convexity(low - room, high + room)
        if not mu > 0:
            return None
        low, high, room = low[:, :self.n], high[:, :self.n], room[:, :self.n]
        state = self.relaxed((low + high) / 2)
        if not ((low <= state.u) & (state.u <= high)).all():
            state = state.moved(np.clip(state.u, low, high))
        (least, most), (g, off) = _action(state), _gradient(state)
        t = np.clip(-g / mu, low - state.u, high - state.u)
        parts = np.append(g * t, mu / 2 * t ** 2)
        bound = (least + float(parts.sum()) - off * float((high - low).sum())
                 - 8 * len(parts) * U * float(np.abs(parts).sum()))
        if bound <= self.known and most - bound > TINY * self.q:
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
                g, off = _gradient(same)
                r = float(min((same.u - low).min(), (high - same.u).min()))
                if r > 2.001 / mu * (sqrt(float((g ** 2).sum())) + off * sqrt(g.size)):
                    return d
        return 1

    def run(self, gap, corridors):
        """Looks into corridors, the lowest first, until the least action is known to gap.  Returns
        a lower bound of it, copies as above, and how many corridors were looked into."""
        self.relaxed(np.zeros((self.q, 2)) + [*self.potential.start, 0.0][:2])
        pending, settled, count, pushed = [(-inf, 0, *self.root())], [], 0, 0
        while pending and count < corridors and self.known - pending[0][0] > gap:
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


def least_action(potential: Potential, p: Tuple[int, ...], q: int, eps: float, gap: float = 1e-9,
                 corridors: int = 10000) -> LeastAction:
    """A LeastAction: bounds of the least action of all states of type (p, q), by branch and bound.

    gap       -- how far apart the bounds may stay
    corridors -- how many to look into at most: then the bounds are as far apart as they are

    Above the eps where an orbit's tori break, q up to 30 takes seconds to minutes, and a gap of
    1e-12 is as cheap as a larger one.  Below, states slide along each other at no cost, and a small
    gap takes corridors without end."""
    known(potential)
    _errors(potential, 1.0)
    eps, gap = _numbers("eps and gap", [eps, gap], LARGEST_EPS)
    corridors = whole("corridors", corridors, 1, 10 ** 9)
    q = whole("q", q, 1, LONGEST)
    state = State(potential, p, q, eps, np.zeros((q, potential.n)), (0.0,) * potential.n)
    if eps == 0:
        return LeastAction(0.0, 0.0, state, gcd(*state.p, state.q), 0)
    search = _Search(state)
    low, copies, count = search.run(gap * state.q, corridors)
    low, high = _per_point(low, search.known, state.q)
    return LeastAction(low, high, search.best, copies, count)
