"""States: periodic orbits, or what is to become one (thesis, sections 2.1 and 2.2)."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import asinh, isfinite, sinh, sqrt
from typing import NamedTuple, Tuple

import numpy as np

from .._native import ffi, lib
from ..files import ConverseError
from .potential import Potential, address, done

STATIONARY = 1e-9           # of the gradient's largest coordinate: above it a state is no orbit
ROUNDING = 1e-12            # of eigenvalues
FAR = 1e-3                  # further along a direction than that, its eigenvalue may be another
NEAR_NULL = 1e-8            # of eigenvalues: along their directions the phase is not determined
ROUNDS = 200000             # points that the pivots run through at most, but five rounds
POINTS = 1000000            # times steps, of relax, before Ctrl-C is looked for
FARTHEST = 1000             # displacement: beyond, too few digits are left of where a point is


class Deviation(NamedTuple):
    """The largest displacement from a straight orbit: from the line through x_0, from the line where
    the calculation began, and from the best line (half the extent)."""

    from_point: float
    from_start: float
    from_best: float


class Pairs(NamedTuple):
    """The closest pairs of points, closest first: indices, |dx| on the torus, and |dp|."""

    i: np.ndarray
    j: np.ndarray
    distance: np.ndarray
    momentum: np.ndarray


@dataclass(frozen=True, eq=False)
class State:
    """q points of type (p, q), x_{j+q} = x_j + p, with x_j = origin + (j p mod q)/q + u_j.

    p       -- n integers; p/q need not be in lowest terms
    eps     -- the size of the perturbation
    u       -- array (q, n), the displacements from the straight orbit
    origin  -- n numbers: where the straight orbit begins
    searches -- of how many searches this is the state of least action; 0: none was made
    """

    potential: Potential
    p: Tuple[int, ...]
    q: int
    eps: float
    u: np.ndarray
    origin: Tuple[float, ...]
    searches: int = 0

    def __post_init__(self):
        n = self.potential.n
        try:
            p = tuple(int(i) for i in self.p)
            valid = p == tuple(self.p) and int(self.q) == self.q and self.q >= 1
        except (TypeError, ValueError):
            valid = False
        if not valid or len(p) != n or max(map(abs, p)) >= 2 ** 31 or self.q >= 2 ** 31:
            raise ValueError("a type is %d whole numbers p and a whole number q > 0, below 2^31, "
                             "not %r and %r" % (n, self.p, self.q))
        u = np.array(self.u, dtype=float)       # of its own
        if u.shape != (self.q, n) or not (np.abs(u) < FARTHEST).all():
            raise ValueError("displacements are %d rows of %d finite numbers below %d in size"
                             % (self.q, n, FARTHEST))
        u.flags.writeable = False
        try:
            origin, eps = tuple(float(x) for x in self.origin), float(self.eps)
            valid = len(origin) == n and all(map(isfinite, origin + (eps,)))
        except (TypeError, ValueError, OverflowError):
            valid = False
        if not valid:
            raise ValueError("origin and eps are finite numbers, %d and one, not %r and %r"
                             % (n, self.origin, self.eps))
        for name, value in (("p", p), ("q", int(self.q)), ("u", u), ("origin", origin),
                            ("eps", eps)):
            object.__setattr__(self, name, value)

    def __repr__(self):
        return "<State %s, type (%s)/%d, eps %r, %s>" % (
            self.potential.name, ", ".join(map(str, self.p)), self.q, self.eps, self.label)

    # ---- points

    @property
    def rotation(self):
        """p/q as an array (n,)."""
        return np.array(self.p) / self.q

    @cached_property
    def base(self):
        """The straight orbit on the torus, origin + (j p mod q)/q, array (q, n)."""
        j = np.arange(self.q, dtype=np.int64)[:, None]
        return np.array(self.origin) + j * (np.array(self.p) % self.q) % self.q / self.q

    @property
    def x(self):
        """The points on the torus, array (q, n), from 0 up to 1."""
        x = (self.base + self.u) % 1.0
        return np.where(x < 1.0, x, 0.0)

    @cached_property
    def momenta(self):
        """p_j = x_{j+1} - x_j + eps grad V(x_j), array (q, n)."""
        return self.rotation + np.roll(self.u, -1, 0) - self.u + self.eps * self._local[1]

    @cached_property
    def _local(self):
        return self.potential.evaluate(self.base + self.u)

    # ---- action

    @property
    def action(self):
        """The action per point less that of the straight orbit at eps 0, |p/q|^2/2."""
        step = np.roll(self.u, -1, 0) - self.u
        return float(np.mean((step ** 2).sum(1) / 2 - self.eps * self._local[0]))

    @cached_property
    def gradient(self):
        """dL/dx_j, array (q, n)."""
        return (2 * self.u - np.roll(self.u, 1, 0) - np.roll(self.u, -1, 0)
                - self.eps * self._local[1])

    @property
    def grad_size(self):
        """The root mean square of |dL/dx_j|."""
        return sqrt(float(np.mean((self.gradient ** 2).sum(1))))

    @property
    def shadow(self):
        """The largest distance between (x_{j+1}, p_{j+1}) and the image of (x_j, p_j).  The x agree;
        what remains is the largest |dL/dx_j|."""
        return sqrt(float((self.gradient ** 2).sum(1).max()))

    @cached_property
    def blocks(self):
        """beta_j = 2 - eps V''(x_j), entries 00, 01 and 11: array (q, 3).  Where n is one, the second
        coordinate is idle."""
        bend = self._local[2]
        blocks = np.tile([2.0, 0.0, 2.0], (self.q, 1))
        blocks[:, 0] -= self.eps * bend[:, 0, 0]
        if self.potential.n == 2:
            blocks[:, 1] -= self.eps * bend[:, 0, 1]
            blocks[:, 2] -= self.eps * bend[:, 1, 1]
        return blocks

    def below(self, shift):
        """How many eigenvalues of the Hessian are below shift."""
        return done(lib.cv_solve(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                                 -shift, ffi.NULL, ffi.NULL))

    @cached_property
    def least(self):
        """The least eigenvalue of the Hessian, to a relative 1e-5 or an absolute 1e-15, but for the
        rounding of the Hessian, about 1e-15 too."""
        high = asinh(1e15 * (2 * float(np.abs(self.blocks).max()) + 2))
        low = -high
        for _ in range(24):
            middle = (low + high) / 2
            low, high = (low, middle) if self.below(1e-15 * sinh(middle)) else (middle, high)
        return 1e-15 * sinh((low + high) / 2)

    # ---- what kind of state it is

    @cached_property
    def _pivots(self):
        """d_j = beta_j - 1/d_{j-1}, array (q, 3), and how many rounds it took to repeat; 0: they did
        not; -r: not all are positive definite, in round r."""
        pivots = np.zeros((self.q, 3))
        rounds = lib.cv_pivots(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                               max(5, ROUNDS // self.q), address(pivots, "double(*)[3]"))
        return pivots, rounds

    @property
    def label(self):
        """What is known of it, in doubles: "not stationary"; "saddle", if it or an n-fold copy of it
        has an action that can be lowered to second order; "minimum", if neither has, but for
        directions so flat that nobody knows (undetermined); "stationary", if rounding hides which;
        "best of N searches", of a minimum found so."""
        if not self.shadow < STATIONARY:
            return "not stationary"
        rounds = self._pivots[1]
        if rounds <= 0:
            if self.repeat(1 - rounds).below(-max(ROUNDING, self.shadow / FAR)):
                return "saddle"
            if rounds < 0:
                return "stationary"
        return "best of %d searches" % self.searches if self.searches else "minimum"

    @property
    def undetermined(self):
        """Along how many directions the state may be moved at (almost) no cost: eigenvalues between
        -NEAR_NULL and NEAR_NULL.  The phases along them are not determined."""
        return self.below(NEAR_NULL) - self.below(-NEAR_NULL)

    @cached_property
    def exponents(self) -> np.ndarray:
        """The n Lyapunov exponents (1/q) log |l| >= 0 of the orbit, larger first, array (n,); NaN
        where the pivots are not positive definite.  An exponent below about 1/200,000 or 1/(5 q),
        whichever is smaller, is that small, not more exactly known."""
        pivots, rounds = self._pivots
        growth = ffi.new("double[2]")
        if rounds < 0:
            return np.full(self.potential.n, np.nan)
        lib.cv_growth(self.q, address(pivots, "double(*)[3]"), growth)
        return np.maximum(list(growth)[:self.potential.n], 0.0)

    # ---- measures

    @property
    def deviation(self):
        low, high = self.u.min(0), self.u.max(0)
        return Deviation(float(np.sqrt(((self.u - self.u[0]) ** 2).sum(1)).max()),
                         float(np.sqrt((self.u ** 2).sum(1)).max()),
                         float(np.sqrt((((high - low) / 2) ** 2).sum())))

    def pairs(self, count=800):
        """The count closest pairs of its points on the torus."""
        count = min(int(count), self.q * (self.q - 1) // 2)
        x = np.zeros((self.q, 2))
        x[:, :self.potential.n] = self.x
        i, j, distance = np.zeros(count, "l"), np.zeros(count, "l"), np.zeros(count)
        found = done(lib.cv_pairs(self.potential.n, self.q, address(x), count, address(i, "long *"),
                                  address(j, "long *"), address(distance, "double *")))
        i, j = i[:found], j[:found]
        momentum = np.sqrt(((self.momenta[i] - self.momenta[j]) ** 2).sum(1))
        return Pairs(i, j, distance[:found], momentum)

    # ---- other states

    def moved(self, u):
        """This state with other displacements."""
        return replace(self, u=u, searches=0)

    def repeat(self, n):
        """The orbit run through n times, of type (n p, n q)."""
        return replace(self, p=tuple(n * i for i in self.p), q=n * self.q,
                       u=np.tile(self.u, (n, 1)))

    def relax(self, eps=None, tol=1e-13, max_steps=10000):
        """A state of least action near this one, at this or another eps, by damped Newton: the
        gradient's coordinates are at most tol, or 100 tol where rounding hides what would lower
        them.  ConverseError if that many steps do not reach it."""
        n, q = self.potential.n, self.q
        eps = self.eps if eps is None else float(eps)
        u, base = np.zeros((q, 2)), np.zeros((q, 2))
        u[:, :n], base[:, :n] = self.u, self.base
        how, code = ffi.new("cv_relaxed *"), lib.CV_RUNNING
        while code == lib.CV_RUNNING:
            until = min(max_steps, how.steps + max(1, POINTS // q))
            code = done(lib.cv_relax(self.potential.native, q, eps, address(base), address(u), tol,
                                     until, how), self.potential)
            if how.steps < until or until == max_steps:
                break
        if code != lib.CV_OK:
            raise ConverseError(
                "no orbit of type (%s)/%d found at eps %r: the gradient is still %.1e after %d steps"
                % (", ".join(map(str, self.p)), q, eps, how.largest, how.steps))
        return replace(self, eps=eps, u=u[:, :n], searches=0)
