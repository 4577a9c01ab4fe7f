"""Periodic states: periodic orbits of a map, or approximations of one (thesis, 2.1 and 2.2)."""

import os
from dataclasses import dataclass, replace
from functools import cached_property
from math import asinh, sinh, sqrt
from typing import Any, NamedTuple, Optional, Tuple, Union

import numpy as np

from ..model.dynamics import jacobians
from ..model.exact import whole_number
from ..prover.native import ffi, lib
from ..storage.files import ConverseError
from ..storage.methods import provided
from .limits import (EIGENVALUE_ROUNDING, EIGENVALUE_STEP, MAX_DISPLACEMENT, MAX_PIVOTS, MAX_Q,
                     MAX_SHADOW, NULL_EIGENVALUE, SHADOW_REACH)
from .potential import Potential, address, done, finite, known
from .stability import Monodromy, beyond, log_excesses, log_multipliers, log_weak_excess, product


class Deviation(NamedTuple):
    """The largest distance |u_j - c| of a point from its place on a straight orbit, in the units of
    the map.

    from_point -- the straight orbit through x_0: c = u_0
    from_start -- the straight orbit where continuation began: c = 0"""

    from_point: float
    from_start: float


def _fixed(array):
    """The same array, made read-only because it is cached."""
    array.flags.writeable = False
    return array


def type_of(potential, p, q):
    """The type (p, q) as integers.  ValueError: the potential has no such type."""
    n = potential.n
    try:
        p = np.atleast_1d(p).tolist()
        numbers = tuple(int(i) for i in p)
        valid = numbers == tuple(p) and int(q) == q and 1 <= q <= MAX_Q
    except (TypeError, ValueError, OverflowError):
        valid = False
    if not valid or len(numbers) != n or max(map(abs, numbers)) >= 2 ** 31:
        raise ValueError("a type is %d whole number%s p below 2^31 in size and a whole number q "
                         "from 1 to %d, not %.200r and %.200r"
                         % (n, "s" * (n > 1), MAX_Q, p, q))
    return numbers, int(q)


def vector_words(p, q):
    """The type as the thesis writes it, (1432, 1897)/2513; of one angle 8/21."""
    return ("(%s)/%d" if len(p) > 1 else "%s/%d") % (", ".join(map(str, p)), q)


@dataclass(frozen=True, eq=False)
class PeriodicOrbit:
    """A state of type (p, q): q points x_j = origin + (j p mod q)/q + u_j, continued by
    x_{j+q} = x_j + p.

    Units: p, q, u, origin and base are in turns, as doubles have them exactly.  All that is
    computed has the units of the map, whose angles have the period `potential.period`: 2 pi for a
    SymplecticMap, 1 for trig, poly, ff, froeschle and orbits.standard.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
        p/q need not be in lowest terms.
    q : int
    eps : float
        The size of the perturbation.
    u : array of float, shape (q, n)
        The displacements from the straight orbit, in turns.
    origin : sequence of float, shape (n,)
        The point of the straight orbit with j = 0, in turns.

    Raises
    ------
    ValueError
        The arguments make no state.

    Notes
    -----
    A state cannot be changed.
    """

    potential: Potential
    p: Tuple[int, ...]
    q: int
    eps: float
    u: np.ndarray
    origin: Tuple[float, ...]

    def __post_init__(self):
        object.__setattr__(self, "potential", known(self.potential))
        n = self.potential.n
        p, q = type_of(self.potential, self.p, self.q)
        try:
            u = np.array([] if np.iscomplexobj(self.u) else self.u, dtype=float)    # a copy
        except (TypeError, ValueError):
            u = np.empty(0)
        if u.shape != (q, n) or not (np.abs(u) < MAX_DISPLACEMENT).all():
            raise ValueError("displacements are %d rows of %d finite numbers below %d in size"
                             % (q, n, MAX_DISPLACEMENT))
        origin, (eps,) = tuple(finite("origin", self.origin)), finite("eps", [self.eps])
        if np.shape(self.origin) != (n,) or not max(map(abs, origin)) < MAX_DISPLACEMENT:
            raise ValueError("the origin is %d numbers below %d in size, not %r"
                             % (n, MAX_DISPLACEMENT, self.origin))
        for name, value in (("p", p), ("q", q), ("u", _fixed(u)), ("origin", origin),
                            ("eps", eps)):
            object.__setattr__(self, name, value)

    def __reduce__(self):               # the default would copy caches and make u writable
        return PeriodicOrbit, (self.potential, self.p, self.q, self.eps, self.u, self.origin)

    def __repr__(self) -> str:
        return "<PeriodicOrbit %s, type %s, eps %r, %s>" % (
            self.potential.name, self.type_text, self.eps, self.label)

    @property
    def type_text(self) -> str:
        """The type in words, "(5, 7)/9" or "8/21"."""
        return vector_words(self.p, self.q)

    # ---- points

    @property
    def rotation(self) -> np.ndarray:
        """The rotation vector p/q, in turns: array (n,)."""
        return np.array(self.p) / self.q

    @cached_property
    def base(self) -> np.ndarray:
        """The straight orbit, origin + (j p mod q)/q, in turns: array (q, n)."""
        j = np.arange(self.q, dtype=np.int64)[:, None]
        return _fixed(np.array(self.origin) + j * (np.array(self.p) % self.q) % self.q / self.q)

    @property
    def x(self) -> np.ndarray:
        """The angles modulo the period, in [0, period): array (q, n)."""
        return self.potential.period * self.turns

    @property
    def turns(self) -> np.ndarray:
        """The angles in turns, in [0, 1): array (q, n)."""
        x = (self.base + self.u) % 1.0
        return np.where(x < 1.0, x, 0.0)

    @cached_property
    def momenta(self) -> np.ndarray:
        """The momenta p_j = x_{j+1} - x_j + eps grad V(x_j): array (q, n)."""
        return _fixed(self.potential.period * (self.rotation + np.roll(self.u, -1, 0) - self.u
                                               + self.eps * self._local[1]))

    @cached_property
    def _local(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """V on the torus of period 1, its gradient and its Hessian at the points."""
        return tuple(map(_fixed, self.potential.evaluate(self.base + self.u)))

    # ---- action

    @property
    def action(self) -> float:
        """The mean over j of |x_{j+1} - x_j|^2/2 - eps V(x_j), less |period p/q|^2/2, the action of
        the straight orbit at eps 0."""
        step = np.roll(self.u, -1, 0) - self.u
        return self.potential.period ** 2 * float(
            np.mean((step ** 2).sum(1) / 2 - self.eps * self._local[0]))

    @property
    def gradient(self) -> np.ndarray:
        """The derivatives dL/dx_j of the action: array (q, n)."""
        return _fixed(self.potential.period * self._gradient)

    @cached_property
    def _gradient(self) -> np.ndarray:
        """The derivatives of the action by angles in turns: array (q, n)."""
        return _fixed(2 * self.u - np.roll(self.u, 1, 0) - np.roll(self.u, -1, 0)
                      - self.eps * self._local[1])

    @property
    def grad_size(self) -> float:
        """The root mean square of |dL/dx_j|."""
        return sqrt(float(np.mean((self.gradient ** 2).sum(1))))

    @property
    def shadow(self) -> float:
        """The largest distance between (x_{j+1}, p_{j+1}) and the image of (x_j, p_j).  The angles
        agree exactly, so it is the largest |dL/dx_j|."""
        return self.potential.period * self._shadow

    @property
    def _shadow(self) -> float:
        """The shadow on the torus of period 1."""
        return sqrt(float((self._gradient ** 2).sum(1).max()))

    @cached_property
    def blocks(self) -> np.ndarray:
        """The diagonal blocks beta_j = 2 - eps V''(x_j) of the Hessian of the action: array (q, 3)
        of the entries 00, 01 and 11.  With one angle, 01 is 0 and 11 is 2."""
        bend = self._local[2]
        blocks = np.tile([2.0, 0.0, 2.0], (self.q, 1))
        blocks[:, 0] -= self.eps * bend[:, 0, 0]
        if self.potential.n == 2:
            blocks[:, 1] -= self.eps * bend[:, 0, 1]
            blocks[:, 2] -= self.eps * bend[:, 1, 1]
        return _fixed(blocks)

    def below(self, shift: float) -> int:
        """How many eigenvalues of the Hessian are below a number.

        Parameters
        ----------
        shift : float
            The number.
        """
        shift, = finite("shift", [shift])
        return done(lib.cv_solve(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                                 -shift, ffi.NULL, ffi.NULL, ffi.NULL))

    def solved(self, b: np.ndarray, shift: float = 0.0) -> np.ndarray:
        """(Hessian + shift)^-1 b.  No promise where the matrix is nearly singular.

        Parameters
        ----------
        b : array of float, shape (q, n)
            The right side.
        shift : float
            The number that is added to the diagonal.

        Returns
        -------
        array of float, shape (q, n)
        """
        n, right, found = self.potential.n, np.zeros((self.q, 2)), np.zeros((self.q, 2))
        right[:, :n], work = b, np.empty((self.q, lib.CV_WORK))
        done(lib.cv_solve(n, self.q, address(self.blocks, "double(*)[3]"), shift, address(right),
                          address(found), address(work, "double *")))
        return found[:, :n]

    @cached_property
    def least(self) -> float:
        """The least eigenvalue of the Hessian, by bisection, to a relative 1e-5 or an absolute
        1e-15.  The rounding of the Hessian adds about 1e-15."""
        high = asinh((2 * float(np.abs(self.blocks).max()) + 2) / EIGENVALUE_STEP)
        low = -high
        for _ in range(24):
            middle = (low + high) / 2
            some = self.below(EIGENVALUE_STEP * sinh(middle))
            low, high = (low, middle) if some else (middle, high)
        return EIGENVALUE_STEP * sinh((low + high) / 2)

    # ---- what kind of state it is

    @cached_property
    def _rounds(self) -> int:
        """The number of rounds of the orbit after which the pivots d_j = beta_j - 1/d_{j-1} repeat.
        0: they did not repeat; -r: in round r one is not positive definite."""
        pivots = np.zeros((self.q, 3))
        return lib.cv_pivots(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                             max(5, MAX_PIVOTS // self.q), address(pivots, "double(*)[3]"))

    @property
    def label(self) -> str:
        """What doubles show of it.

        "not stationary" -- no orbit: the shadow is not below MAX_SHADOW periods
        "saddle" -- an orbit; its Hessian, or the Hessian of the orbit run through several times,
            has a negative eigenvalue
        "minimum" -- an orbit without such an eigenvalue; those counted by `undetermined` are too
            small to have a sign
        "stationary" -- an orbit; rounding hides whether it is a minimum or a saddle"""
        if not self._shadow < MAX_SHADOW:
            return "not stationary"
        rounds = self._rounds
        if rounds <= 0:
            rounding = max(EIGENVALUE_ROUNDING, self._shadow / SHADOW_REACH)
            if self.repeat(1 - rounds).below(-rounding):
                return "saddle"
            if rounds < 0:
                return "stationary"
        return "minimum"

    @property
    def undetermined(self) -> int:
        """The number of eigenvalues of the Hessian between -NULL_EIGENVALUE and NULL_EIGENVALUE.
        Along their eigenvectors the action changes by almost nothing, and the phase of the state is
        not determined."""
        return self.below(NULL_EIGENVALUE) - self.below(-NULL_EIGENVALUE)

    # ---- how neighbours move away: stability.py

    @property
    def _derivatives(self) -> np.ndarray:
        return jacobians(self.eps * self._local[2])

    @property
    def monodromy(self) -> Monodromy:
        """DF^q at x_0, x before p: a matrix (2n, 2n), times e^log, so that nothing overflows."""
        return product(self._derivatives)

    @cached_property
    def _log_excesses(self) -> np.ndarray:
        """log (rho - 2) of the stability indices rho: complex array (n,)."""
        bends = -self.eps * self._local[2]
        if self.potential.n == 1 and self.q * float(np.abs(bends).sum()) < 1:
            return _fixed(np.array([log_weak_excess(bends[:, 0, 0])]))
        log = ffi.new("double *")
        negative = lib.cv_determinant(self.potential.n, self.q,
                                      address(self.blocks, "double(*)[3]"), log)
        return _fixed(log_excesses(self.monodromy, log[0] + (negative % 2) * np.pi * 1j))

    @property
    def log_multipliers(self) -> np.ndarray:
        """log l of the n multipliers l (eigenvalues of DF^q) of modulus at least 1, the larger
        first: complex array (n,).  The other n are 1/l.  The imaginary part is the argument of l:
        the angle of rotation, or pi for a negative multiplier."""
        return log_multipliers(self._log_excesses)

    @property
    def multipliers(self) -> np.ndarray:
        """The multipliers l of log_multipliers: array (n,), complex if one is; infinite beyond
        1e308."""
        return beyond(self.log_multipliers)

    @property
    def indices(self) -> np.ndarray:
        """The stability indices rho = l + 1/l: array (n,).  The orbit is linearly stable if they
        are real, distinct and between -2 and 2.  Infinite beyond 1e308."""
        return 2 + beyond(self._log_excesses)

    @property
    def residue(self) -> float:
        """Greene's residue (2 - trace DF^q)/4 of an orbit of one angle: below 0 hyperbolic, as
        minima are, from 0 to 1 elliptic, above 1 hyperbolic with reflection.  Infinite beyond
        1e308.  It is that of the points as doubles: where eps V'' of the points cancel, their
        rounding moves it by about 1e-16 q times the sum of |eps V''|.  ValueError for n = 2: see
        indices."""
        if self.potential.n != 1:
            raise ValueError("Greene's residue is of maps with one angle; with two there are the "
                             "stability indices, state.indices")
        return float(-beyond(self._log_excesses)[0] / 4)

    @property
    def exponents(self) -> np.ndarray:
        """The n Lyapunov exponents (1/q) log |l| >= 0, larger first: array (n,).  An exponent below
        2/max(MAX_PIVOTS, 5 q), which is 1/100,000 for q up to 40,000, cannot be told from 0."""
        return _fixed(self.log_multipliers.real / self.q)

    # ---- measures

    @property
    def deviation(self) -> Deviation:
        """The largest displacements from two straight orbits."""
        return Deviation(*(self.potential.period * sqrt(float(((self.u - c) ** 2).sum(1).max()))
                           for c in (self.u[0], 0.0)))

    def minimax(self) -> Any:
        """The pass between this minimum and its neighbour, and the flux through the gap: of maps of
        one angle.

        Returns
        -------
        Pair

        Raises
        ------
        ValueError
            The map has two angles, or the type is not in lowest terms.
        ConverseError
            The state is no minimum, or not the least of its type, or no pass was found.
        """
        return provided("PeriodicOrbit.minimax")(self)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes points, momenta and all else of the state to a file, from which load() reads the
        state to the last bit.

        Parameters
        ----------
        path : str or path
            The file; its name ends in .npz.

        Raises
        ------
        ConverseError
            The file cannot be written, or exists and is of another kind.
        """
        provided("PeriodicOrbit.save")([self], path)

    # ---- pictures

    def report(self) -> str:
        """What doubles show of it, in lines."""
        return provided("PeriodicOrbit.report")(self)

    def plot(self, ax: Any = None) -> Any:
        """Its angles and momenta, as a Figure of matplotlib, which a notebook shows.

        Parameters
        ----------
        ax : Axes or pair of Axes, optional
            Where to draw; it is returned.  With one angle one Axes; with two a pair, for the angles
            and for the momenta, or one, for the angles.

        Raises
        ------
        ValueError
            There are too many Axes.
        ConverseError
            matplotlib is missing.
        """
        return provided("PeriodicOrbit.plot")(self, ax)

    # ---- other states

    def moved(self, u: np.ndarray) -> "PeriodicOrbit":
        """The state with other displacements.

        Parameters
        ----------
        u : array of float, shape (q, n)
            In turns.
        """
        return replace(self, u=u)

    def repeat(self, n: int) -> "PeriodicOrbit":
        """The orbit run through several times: a state of type (n p, n q).

        Parameters
        ----------
        n : int
            How often; n q is at most MAX_Q.
        """
        n = whole_number(n, "how often an orbit is run through", 1, MAX_Q // self.q)
        return replace(self, p=tuple(n * i for i in self.p), q=n * self.q,
                       u=np.tile(self.u, (n, 1)))

    def relax(self, eps: Optional[float] = None, tol: float = 1e-13,
              max_steps: int = 10000) -> "PeriodicOrbit":
        """A nearby minimum of the action, by Newton's method with damping.

        Parameters
        ----------
        eps : float, optional
            By default that of the state.
        tol : float
            The largest coordinate of its gradient, in turns; 100 tol where rounding prevents less.
        max_steps : int
            The most steps of Newton's method.

        Raises
        ------
        ConverseError
            The steps do not reach a minimum.
        """
        eps, tol = finite("eps and tol", [self.eps if eps is None else eps, tol])
        max_steps = whole_number(max_steps, "max_steps", 0, 2 ** 31 - 1)
        code, how, u = descended(self, eps, tol, max_steps)
        if code != lib.CV_OK:
            raise ConverseError(
                "no orbit of type %s found at eps %r: the gradient is still %.1e after %d steps"
                % (self.type_text, eps, how.largest, how.steps))
        return replace(self, eps=eps, u=u)


def descended(state, eps, tol, max_steps, held=None):
    """The result of cv_relax: its code, how it went, and the displacements, an array (q, n).
    held: None, or (j, i): coordinate i of point j stays where it is."""
    n, q = state.potential.n, state.q
    first, axis = held or (0, -1)
    u, base = np.zeros((q, 2)), np.zeros((q, 2))
    u[:, :n], base[:, :n] = np.roll(state.u, -first, 0), np.roll(state.base, -first, 0)
    how = ffi.new("cv_relaxed *")
    code = done(lib.cv_relax(state.potential.native, q, eps, address(base), address(u), axis, tol,
                             max_steps, how))
    return code, how, np.roll(u[:, :n], first, 0)


def expected(state):
    """Returns what it is given; raises ValueError unless that is a PeriodicOrbit."""
    if not isinstance(state, PeriodicOrbit):
        raise ValueError("a state is expected, such as follow and relax return, not %.200r"
                         % (state,))
    return state
