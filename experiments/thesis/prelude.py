"""The thesis's prelude: where no tori can be."""

from typing import NamedTuple

import numpy as np

from converse.orbits.potential import Potential, known


class Prelude(NamedTuple):
    """From which eps on something is impossible (thesis, section 2.3), in doubles.

    lowest  -- that a minimizing state visits the minimum of V
    worst   -- that it visits the point where V'' is largest
    graphs  -- that there is an invariant Lagrangian graph
    """

    lowest: float
    worst: float
    graphs: float


def prelude(potential: Potential) -> Prelude:
    """Where minimizing states and tori are impossible without following an orbit: a Prelude.

    A minimizing state has 2 - eps V'' > 0 at its points.  An invariant graph passes through all x,
    and there even 2 - eps V'' >= 2 l holds, where l is the smaller root of l + 1/l = B and B = 2 -
    eps (least eigenvalue of V''): since d_j = beta_j - 1/d_{j-1} > 0 and all beta_j <= B, all d_j
    and all 1/d_j are at least l, and beta_j is the sum of two of them.  With V'' between -m and M
    that ends where 2 - eps M = 2 l, at eps = 4 m/(M (M + 2 m))."""
    potential = known(potential)

    def eigenvalues(x):
        return np.linalg.eigvalsh(potential.evaluate(x)[2])

    bottom = _highest(lambda x: -potential.evaluate(x)[0], potential.n)
    most = _highest(lambda x: eigenvalues(x)[:, -1], potential.n)
    least = _highest(lambda x: -eigenvalues(x)[:, 0], potential.n)
    top, depth = eigenvalues(most)[0, -1], -eigenvalues(least)[0, 0]
    return Prelude(float(2 / eigenvalues(bottom)[0, -1]), float(2 / top),
                   float(4 * depth / (top * (top + 2 * depth))))


def _highest(function, n):
    """Where a function on the torus is largest, as an array (1, n): the best point of a grid, then
    of ever finer grids around it.  No derivatives are used, since the maximum may be a kink."""
    centre, width, size = np.full((1, n), 0.5), 0.5, 120
    while width > 1e-12:
        axis = width * np.arange(-size, size + 1) / size
        grid = centre + np.stack(np.meshgrid(*[axis] * n, indexing="ij"), -1).reshape(-1, n)
        centre = grid[np.argmax(function(grid))][None]
        width, size = 2 * width / size, 5
    return centre
