"""Images of points under a map, orbits, Jacobians and phase portraits, in doubles."""

from typing import TYPE_CHECKING, Any, Tuple

from ..storage.methods import provided
from .exact import whole_number

if TYPE_CHECKING:
    import numpy as np


class Dynamics:
    """The map y' = y + J', J' = J - eps grad V(y) of a potential V.

    The class that inherits these methods has `dimension`, the number n of angles, and `period`,
    that of every angle and momentum.  No method reduces its results modulo the period.
    """

    dimension: int
    period: float
    letters: str                        # the names of an angle and of a momentum

    def _gradient(self, y: "np.ndarray") -> "np.ndarray":
        """The gradient (m, n) of V at points (m, n)."""
        raise NotImplementedError

    def _hessian(self, y: "np.ndarray") -> "np.ndarray":
        """The Hessian (m, n, n) of V at points (m, n)."""
        raise NotImplementedError

    def map(self, y: Any, J: Any, eps: float = 1.0) -> "Tuple[np.ndarray, np.ndarray]":
        """The images of points.

        Parameters
        ----------
        y, J
            Angles and momenta: arrays (..., n) of any number of points.  With one angle the arrays
            have any shape, and numbers are taken.
        eps
            The potential is multiplied by this number.

        Returns
        -------
        y', J'
            Arrays of the shape of y and J.

        Raises
        ------
        ValueError
            An array has another shape, eps is not finite, or a parameter of the map has a range.
        """
        ys, Js = self.orbit(y, J, 1, eps)
        return ys[1], Js[1]

    def inverse(self, y: Any, J: Any, eps: float = 1.0) -> "Tuple[np.ndarray, np.ndarray]":
        """The points whose images these are.

        Parameters
        ----------
        y, J, eps
            As of map(), with the same errors.

        Returns
        -------
        y, J
            Arrays of the shape of y and J.
        """
        ys, Js = self.orbit(y, J, -1, eps)
        return ys[1], Js[1]

    def jacobian(self, y: Any, eps: float = 1.0) -> "np.ndarray":
        """The derivative of map() at y, which does not depend on J.

        Parameters
        ----------
        y, eps
            As of map(), with the same errors.

        Returns
        -------
        array (..., 2n, 2n)
            Angles before momenta, that is, [[1 - eps V'', 1], [-eps V'', 1]].
        """
        n, y = self.dimension, self._points(y, 0.0, eps)[0]
        shape = y.shape[:-1] if y.shape[-1:] == (n,) else y.shape
        bend = eps * self._hessian(y.reshape(-1, n))
        return jacobians(bend).reshape(*shape, 2 * n, 2 * n)

    def orbit(self, y: Any, J: Any, steps: int,
              eps: float = 1.0) -> "Tuple[np.ndarray, np.ndarray]":
        """The orbits of points.

        Parameters
        ----------
        y, J, eps
            As of map(), with the same errors.
        steps
            A whole number below 2^31 in size; if it is negative the orbits go backwards.

        Returns
        -------
        y, J
            Arrays (abs(steps) + 1, ...), whose first rows are the points themselves.
        """
        import numpy as np

        steps, (y, J) = _steps(steps), self._points(y, J, eps)
        ys, Js = (np.empty((abs(steps) + 1, *y.shape)) for _ in range(2))
        ys[0], Js[0] = y, J
        flat = [each.reshape(len(each), y.size // self.dimension, self.dimension)
                for each in (ys, Js)]
        y, J = (each[0] for each in flat)
        for j in range(1, len(ys)):
            if steps > 0:
                J = J - eps * self._gradient(y)
                y = y + J
            else:
                y = y - J
                J = J + eps * self._gradient(y)
            flat[0][j], flat[1][j] = y, J
        return ys, Js

    def portrait(self, y: Any = None, J: Any = None, steps: int = 500, *, eps: float = 1.0,
                 ax: Any = None, **style: Any) -> Any:
        """A phase portrait: the orbits of initial points, modulo the period; of more angles their
        projection to the first angle and its momentum.

        Parameters
        ----------
        y, J
            Initial points as for orbit(); by default 20, spread evenly.
        steps
            Of each orbit; backwards if negative.
        eps
            As of map().
        ax
            Axes of matplotlib, which are drawn into and returned; with None a Figure is returned.
        style
            As for Axes.plot; color=None gives each orbit another colour.

        Raises
        ------
        ValueError
            The arguments make no portrait.
        ConverseError
            matplotlib is missing.
        """
        return provided("SymplecticMap.portrait")(self, eps, y, J, _steps(steps), ax, style)

    def _points(self, y, J, eps):
        """y and J as arrays of one shape, (..., n) or, with one angle, any."""
        import numpy as np

        if not np.isfinite(eps):
            raise ValueError("eps is a finite number, not %r" % (eps,))
        y, J = np.broadcast_arrays(np.asarray(y, float), np.asarray(J, float))
        n = self.dimension
        if n > 1 and y.shape[-1:] != (n,):
            raise ValueError("points of %d angles are arrays of shape (..., %d), not %r"
                             % (n, n, y.shape))
        return y, J


def jacobians(bend: "np.ndarray") -> "np.ndarray":
    """The derivatives of the map at points where eps V'' is bend (m, n, n): array (m, 2n, 2n),
    angles before momenta."""
    import numpy as np

    n = bend.shape[1]
    step = np.empty((len(bend), 2 * n, 2 * n))
    step[:, :n, n:] = step[:, n:, n:] = np.eye(n)
    step[:, n:, :n] = -bend
    step[:, :n, :n] = np.eye(n) - bend
    return step


def _steps(steps):
    return whole_number(steps, "steps", 1 - 2 ** 31, 2 ** 31 - 1)
