"""States: periodic orbits, or what is to become one (thesis, sections 2.1 and 2.2)."""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from math import asinh, isfinite, sinh, sqrt
from typing import NamedTuple, Optional, Tuple

import numpy as np

from .._native import ffi, lib
from ..storage.files import ConverseError
from .potential import Potential, address, done, finite, known, look_up, whole
from .stability import Monodromy, beyond, derivatives, log_excesses, log_multipliers, product

STATIONARY = 1e-9           # of the gradient's largest coordinate: above it a state is no orbit
ROUNDING = 1e-12            # of eigenvalues
FAR = 1e-3                  # further along a direction than that, its eigenvalue may be another
NEAR_NULL = 1e-8            # of eigenvalues: along their directions the phase is not determined
ROUNDS = 200000             # points that the pivots run through at most, but five rounds
LONGEST = 10 ** 7           # points
FARTHEST = 1000             # displacement or origin: beyond, a point has too few digits left


class Deviation(NamedTuple):
    """The largest displacement of a point from a straight orbit: from that through x_0, from that
    where the calculation began, and from the best one, the nearest of all: the radius of the
    smallest circle around all displacements.  So from_best is never larger than the others."""

    from_point: float
    from_start: float
    from_best: float


def middle(points):
    """The centre of the smallest circle around points, an array (q, n), n one or two.

    It is that of a few of them: the smallest around these few is found, and then the point farthest
    from its centre joins those on its rim, until none is outside.  Each circle is larger than the
    one before, or rounding decides."""
    def circles(few):
        """Those with two of them as a diameter, or through three: (centre, radius)."""
        for a, b in combinations(few, 2):
            yield (a + b) / 2, float(np.linalg.norm(a - b)) / 2
        for a, b, c in combinations(few, 3):
            sides = np.array([b - a, c - a])
            if points.shape[1] == 2 and abs(np.linalg.det(sides)) > 0:
                step = np.linalg.solve(sides, (sides ** 2).sum(1) / 2)
                yield a + step, float(np.linalg.norm(step))

    rim, centre, radius = [points[0]], points[0], 0.0
    while True:
        away = np.linalg.norm(points - centre, axis=1)
        few = rim + [points[int(away.argmax())]]
        larger = [(r, *c) for c, r in circles(few)
                  if r > radius and all(np.linalg.norm(x - c) <= r * (1 + 1e-12) for x in few)]
        if not away.max() > radius * (1 + 1e-12) or not larger:
            return centre
        radius, *centre = min(larger)
        rim = [x for x in few if np.linalg.norm(x - centre) >= radius * (1 - 1e-9)][:3]


def _fixed(array):
    """An array that is remembered, and therefore not to be changed."""
    array.flags.writeable = False
    return array


class Pairs(NamedTuple):
    """The closest pairs of points, closest first: indices, |dx| on the torus, and |dp|."""

    i: np.ndarray
    j: np.ndarray
    distance: np.ndarray
    momentum: np.ndarray


def type_of(potential, p, q):
    """The type (p, q) as integers; ValueError, if these are no type."""
    n = potential.n
    try:
        numbers = tuple(int(i) for i in p)
        valid = numbers == tuple(p) and int(q) == q and 1 <= q <= LONGEST
    except (TypeError, ValueError, OverflowError):
        valid = False
    if not valid or len(numbers) != n or max(map(abs, numbers)) >= 2 ** 31:
        raise ValueError("a type is %d whole number%s p below 2^31 in size, as a tuple, and a "
                         "whole number q from 1 to %d, not %.200r and %.200r"
                         % (n, "s" * (n > 1), LONGEST, p, q))
    return numbers, int(q)


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
        known(self.potential)
        n = self.potential.n
        p, q = type_of(self.potential, self.p, self.q)
        try:
            u = np.array([] if np.iscomplexobj(self.u) else self.u, dtype=float)    # of its own
        except (TypeError, ValueError):
            u = np.empty(0)
        if u.shape != (q, n) or not (np.abs(u) < FARTHEST).all():
            raise ValueError("displacements are %d rows of %d finite numbers below %d in size"
                             % (q, n, FARTHEST))
        try:
            origin, eps = tuple(float(x) for x in self.origin), float(self.eps)
            valid = len(origin) == n and isfinite(eps) and all(abs(x) < FARTHEST for x in origin)
        except (TypeError, ValueError, OverflowError):
            valid = False
        if not valid:
            raise ValueError("origin and eps are finite numbers, %d below %d in size and one, not "
                             "%r and %r" % (n, FARTHEST, self.origin, self.eps))
        for name, value in (("p", p), ("q", q), ("u", _fixed(u)), ("origin", origin),
                            ("eps", eps), ("searches", whole("searches", self.searches, 0))):
            object.__setattr__(self, name, value)

    def __reduce__(self):               # what was remembered, and that u is fixed, would get lost
        return State, (self.potential, self.p, self.q, self.eps, self.u, self.origin, self.searches)

    def __repr__(self) -> str:
        return "<State %s, type (%s)/%d, eps %r, %s>" % (
            self.potential.name, ", ".join(map(str, self.p)), self.q, self.eps, self.label)

    # ---- points

    @property
    def rotation(self) -> np.ndarray:
        """p/q as an array (n,)."""
        return np.array(self.p) / self.q

    @cached_property
    def base(self) -> np.ndarray:
        """The straight orbit on the torus, origin + (j p mod q)/q, array (q, n)."""
        j = np.arange(self.q, dtype=np.int64)[:, None]
        return _fixed(np.array(self.origin) + j * (np.array(self.p) % self.q) % self.q / self.q)

    @property
    def x(self) -> np.ndarray:
        """The points on the torus, array (q, n), from 0 up to 1."""
        x = (self.base + self.u) % 1.0
        return np.where(x < 1.0, x, 0.0)

    @cached_property
    def momenta(self) -> np.ndarray:
        """p_j = x_{j+1} - x_j + eps grad V(x_j), array (q, n)."""
        return _fixed(self.rotation + np.roll(self.u, -1, 0) - self.u + self.eps * self._local[1])

    @cached_property
    def _local(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        return tuple(map(_fixed, self.potential.evaluate(self.base + self.u)))

    # ---- action

    @property
    def action(self) -> float:
        """The action per point less that of the straight orbit at eps 0, |p/q|^2/2."""
        step = np.roll(self.u, -1, 0) - self.u
        return float(np.mean((step ** 2).sum(1) / 2 - self.eps * self._local[0]))

    @cached_property
    def gradient(self) -> np.ndarray:
        """dL/dx_j, array (q, n)."""
        return _fixed(2 * self.u - np.roll(self.u, 1, 0) - np.roll(self.u, -1, 0)
                      - self.eps * self._local[1])

    @property
    def grad_size(self) -> float:
        """The root mean square of |dL/dx_j|."""
        return sqrt(float(np.mean((self.gradient ** 2).sum(1))))

    @property
    def shadow(self) -> float:
        """The largest distance between (x_{j+1}, p_{j+1}) and the image of (x_j, p_j).  Since the x
        agree, it is the largest |dL/dx_j|."""
        return sqrt(float((self.gradient ** 2).sum(1).max()))

    @cached_property
    def blocks(self) -> np.ndarray:
        """beta_j = 2 - eps V''(x_j), entries 00, 01 and 11: array (q, 3).  With one angle the
        second coordinate is idle."""
        bend = self._local[2]
        blocks = np.tile([2.0, 0.0, 2.0], (self.q, 1))
        blocks[:, 0] -= self.eps * bend[:, 0, 0]
        if self.potential.n == 2:
            blocks[:, 1] -= self.eps * bend[:, 0, 1]
            blocks[:, 2] -= self.eps * bend[:, 1, 1]
        return _fixed(blocks)

    def below(self, shift: float) -> int:
        """How many eigenvalues of the Hessian are below shift."""
        shift, = finite("shift", [shift])
        return done(lib.cv_solve(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                                 -shift, ffi.NULL, ffi.NULL, ffi.NULL))

    @cached_property
    def least(self) -> float:
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
    def _rounds(self) -> int:
        """Rounds until the pivots d_j = beta_j - 1/d_{j-1} repeated; 0: they did not; -r: not all
        are positive definite, in round r."""
        pivots = np.zeros((self.q, 3))
        return lib.cv_pivots(self.potential.n, self.q, address(self.blocks, "double(*)[3]"),
                             max(5, ROUNDS // self.q), address(pivots, "double(*)[3]"))

    @property
    def label(self) -> str:
        """What is known of it, in doubles: "not stationary"; "saddle", if the action of it or of an
        n-fold copy of it can be lowered to second order; "minimum", if not, except along directions
        too flat to tell (undetermined); "stationary", if rounding hides which; "best of N
        searches", of a minimum found so."""
        if not self.shadow < STATIONARY:
            return "not stationary"
        rounds = self._rounds
        if rounds <= 0:
            if self.repeat(1 - rounds).below(-max(ROUNDING, self.shadow / FAR)):
                return "saddle"
            if rounds < 0:
                return "stationary"
        return "best of %d searches" % self.searches if self.searches else "minimum"

    @property
    def undetermined(self) -> int:
        """Along how many directions the state may be moved at (almost) no cost: eigenvalues between
        -NEAR_NULL and NEAR_NULL.  The phases along them are not determined."""
        return self.below(NEAR_NULL) - self.below(-NEAR_NULL)

    # ---- how neighbours move away: stability.py

    @property
    def _derivatives(self) -> np.ndarray:
        return derivatives(self.eps * self._local[2])

    @property
    def monodromy(self) -> Monodromy:
        """DF^q at x_0, x before p: a matrix (2n, 2n), times e^log, so that nothing overflows."""
        return product(self._derivatives)

    @cached_property
    def _log_excesses(self) -> np.ndarray:
        """log (rho - 2) of the stability indices."""
        log = ffi.new("double *")
        negative = lib.cv_determinant(self.potential.n, self.q,
                                      address(self.blocks, "double(*)[3]"), log)
        return _fixed(log_excesses(self.monodromy, log[0] + (negative % 2) * np.pi * 1j))

    @property
    def log_multipliers(self) -> np.ndarray:
        """log l of those n multipliers, eigenvalues of DF^q, whose modulus is at least 1 (the
        others are 1/l), larger first: complex array (n,).  The imaginary part is the angle by which
        neighbours turn, pi where they are reflected."""
        return log_multipliers(self._log_excesses)

    @property
    def multipliers(self) -> np.ndarray:
        """These l themselves: array (n,), complex if one is; infinite beyond 1e308."""
        return beyond(self.log_multipliers)

    @property
    def indices(self) -> np.ndarray:
        """The stability indices rho = l + 1/l, array (n,): an orbit is stable to first order if
        they are real, distinct and between -2 and 2.  Infinite beyond 1e308."""
        return 2 + beyond(self._log_excesses)

    @property
    def residue(self) -> float:
        """Greene's residue (2 - trace DF^q)/4 of an orbit of one angle: below 0 hyperbolic, as
        minima are, from 0 to 1 elliptic, above 1 hyperbolic with reflection.  Infinite beyond
        1e308.  ValueError for n = 2: see indices."""
        if self.potential.n != 1:
            raise ValueError("Greene's residue is of maps with one angle; with two there are the "
                             "stability indices, state.indices")
        return float(-beyond(self._log_excesses)[0] / 4)

    @property
    def exponents(self) -> np.ndarray:
        """The n Lyapunov exponents (1/q) log |l| >= 0, larger first, array (n,).  One below
        2/max(ROUNDS, 5 q), that is, 1/100,000 while q is at most 40,000, is not told from 0."""
        return _fixed(self.log_multipliers.real / self.q)

    # ---- measures

    @property
    def deviation(self) -> Deviation:
        """See Deviation."""
        def away(centre):
            return sqrt(float(((self.u - centre) ** 2).sum(1).max()))

        from_point, from_start = away(self.u[0]), away(0.0)
        return Deviation(from_point, from_start,
                         min(from_point, from_start, away(middle(self.u))))

    def pairs(self, count: int = 800) -> Pairs:
        """The count closest pairs of its points on the torus."""
        count = min(whole("count", count, 0), self.q * (self.q - 1) // 2)
        x = np.zeros((self.q, 2))
        x[:, :self.potential.n] = self.x
        i, j, distance = np.zeros(count, "l"), np.zeros(count, "l"), np.zeros(count)
        found = done(lib.cv_pairs(self.potential.n, self.q, address(x), count, address(i, "long *"),
                                  address(j, "long *"), address(distance, "double *")))
        i, j = i[:found], j[:found]
        momentum = np.sqrt(((self.momenta[i] - self.momenta[j]) ** 2).sum(1))
        return Pairs(i, j, distance[:found], momentum)

    def _repr_png_(self):
        """For notebooks: its angles and momenta; None without matplotlib."""
        from .figures import states_picture
        try:
            return states_picture([self], "png", caption=False)
        except ConverseError:
            return None

    # ---- other states

    def moved(self, u: np.ndarray) -> "State":
        """This state with other displacements."""
        return replace(self, u=u, searches=0)

    def repeat(self, n: int) -> "State":
        """The orbit run through n times, of type (n p, n q)."""
        n = whole("how often an orbit is run through", n, 1, LONGEST // self.q)
        return replace(self, p=tuple(n * i for i in self.p), q=n * self.q,
                       u=np.tile(self.u, (n, 1)), searches=0)

    def relax(self, eps: Optional[float] = None, tol: float = 1e-13,
              max_steps: int = 10000) -> "State":
        """A state of least action near this one, at this or another eps, by damped Newton: the
        gradient's coordinates are at most tol, or 100 tol where rounding hides what would lower
        them.  ConverseError if that many steps do not reach it."""
        n, q = self.potential.n, self.q
        eps, tol = finite("eps and tol", [self.eps if eps is None else eps, tol])
        max_steps = whole("max_steps", max_steps, 0)
        u, base = np.zeros((q, 2)), np.zeros((q, 2))
        u[:, :n], base[:, :n] = self.u, self.base
        how = ffi.new("cv_relaxed *")
        look_up()
        code = done(lib.cv_relax(self.potential.native, q, eps, address(base), address(u), tol,
                                 max_steps, how), self.potential)
        if code != lib.CV_OK:
            raise ConverseError(
                "no orbit of type (%s)/%d found at eps %r: the gradient is still %.1e after %d "
                "steps" % (", ".join(map(str, self.p)), q, eps, how.largest, how.steps))
        return replace(self, eps=eps, u=u[:, :n], searches=0)


def expected(state):
    """ValueError, unless it is a State."""
    if not isinstance(state, State):
        raise ValueError("a state is expected, such as follow and relax return, not %.200r"
                         % (state,))
