"""Mather's beta function from below: how little action all orbits of a rotation vector have, by the
Lax-Oleinik operator on a grid.

The action of any path, rounded at random to the corners of a grid's cells, grows by little on the
average: minplus.c says by how much, and why.  So the least action on a grid, which is
found without guessing, bounds all from below.  `low` is proved, with all roundings; estimates are
called estimates.
"""

from dataclasses import dataclass
from itertools import combinations
from math import inf, sqrt
from typing import Sequence, Tuple, Union

import numpy as np

from converse._native import ffi
from converse.orbits.potential import Potential, Source, address, known, whole
from converse.prover.native import check

from .action import LARGEST_EPS, U, action_on_grid, floats_within
from .build import library

LARGEST_ROTATION = 100


@dataclass(frozen=True, eq=False)
class MatherBeta:
    """low      -- a lower bound, proved, of the average action per point of any orbit of this
                   rotation vector, and of any other sequence of points; less |rotation|^2/2, as
                   PeriodicOrbit.action
    estimate -- the least action of paths on the grid: low cannot rise above it
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
        self.W, self.off, self.rise = action_on_grid(potential, eps, grid)
        self.u = np.zeros(grid ** self.n) if u is None else u

    def apply(self, c, back=None):
        out, c = np.empty_like(self.u), np.array([*c, 0.0][:2])
        check(library().cv_lax_oleinik(self.n, self.grid, address(c, "double *"),
                                 address(self.W, "double *"), address(self.u, "double *"),
                                 address(out, "double *"),
                                 ffi.NULL if back is None else address(back, "int(*)[2]")))
        return out

    def settle(self, c, tolerance, most):
        """Makes T u - u constant, up to the tolerance if `most` steps reach it; half steps do not
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


def mather_beta(potential: Source, eps: float, rotation: Union[float, Sequence[float]],
                grid: int = 256) -> MatherBeta:
    """Mather's beta from below: how little action per point orbits of a rotation vector can have.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    eps : float
    rotation : float or sequence of float, shape (n,)
        In turns, as doubles have it.
    grid : int
        Nodes along an axis, 8 to 2048.  The loss falls as 1/grid^2.

    Returns
    -------
    MatherBeta

    Notes
    -----
    The action of a path x_0 ... x_m exceeds c.(x_m - x_0) by at least m times the least average on
    the grid^n nodes, whatever c is.  The least average is found by value iteration.  The c that
    gives the most is looked for by cutting planes, first on coarse grids: each closed path bounds
    what a c can give.
    """
    potential = known(potential)
    (eps,), n = floats_within("eps", [eps], LARGEST_EPS), potential.n
    w = np.array(floats_within("rotation", rotation, LARGEST_ROTATION))
    if len(w) != n:
        raise ValueError("the rotation vectors of %s have %d numbers, not %d"
                         % (potential.name, n, len(w)))
    coarse = grid = whole("grid", grid, 8, 2048)
    while coarse % 2 == 0 and coarse >= 48:
        coarse //= 2
    torus = _Torus(potential, eps, coarse)
    # at c = rotation the bound is min W or more, and elsewhere mean W - |c - rotation|^2/2 or less
    radius = sqrt(2 * float(torus.W.mean() - torus.W.min()) + 1e-12) * 1.1
    tolerance = action_on_grid(potential, eps, grid)[2] / 20
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
    return MatherBeta(potential, eps, tuple(map(float, w)), grid,
                      low - torus.rise - 64 * U * size ** 2,
                      estimate, tuple(map(float, w + b)))
