"""Potentials V on the torus of period 1, n = 1 or 2 dimensions (thesis, section 2.2).

The map is x' = x + p', p' = p - eps grad V(x).
"""

import math
import threading
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from numbers import Number
from typing import Any, Callable, ClassVar, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from ..model.dynamics import Dynamics
from ..model.exact import MAX_EXPONENT, Ends, root_bounds
from ..model.map import SymplecticMap
from ..model.potential import FourierSum, per_period, potential_text, product, two_at_most
from ..prover.native import check, ffi, lib
from ..storage.files import plain
from .limits import MIN_STEP_RATIO

Source = Union[SymplecticMap, "Potential"]
Numerators = Union[int, Sequence[int]]      # the p of a type (p, q)

TURN = 2 * math.pi
STUDIED = "trig", "froeschle", "standard"   # names of the potentials at the end of this file
# The scales of Fourier sums, as formulas name them.
PER_PERIOD, TRIG = "1/(4 pi^2)", "8 sqrt 2/sqrt(207 + 33 sqrt 33)"


def known(source: Any) -> "Potential":
    """The potential of a map, or a Potential as it is.  ValueError: the source is neither, or a
    parameter of the map has no value."""
    if isinstance(source, SymplecticMap):
        return _of_map(source, plain(str(source)))
    if not isinstance(source, Potential):
        raise ValueError("the map is a SymplecticMap, such as converse.StandardMap('0.9'), or a "
                         "potential of converse.orbits, not %.200r" % (source,))
    return source


@lru_cache(maxsize=64)
def _of_map(source, name):
    return Fourier.of(source.potential(), name + ".json" * (name in STUDIED), None, PER_PERIOD,
                      TURN)


def told(progress):
    """ValueError, unless it is None or can be called."""
    if progress is not None and not callable(progress):
        raise ValueError("progress is a function that is told how far it is, not %r" % (progress,))


def finite(what, values):
    """Returns one number or several as a list of floats.  ValueError: they are not all finite."""
    try:
        floats = [float(x) for x in ([values] if isinstance(values, (str, Number)) else values)]
        if all(map(math.isfinite, floats)):
            return floats
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError("%s: finite numbers, as a list, not %.200r" % (what, values))


def points(x, n):
    """x as a C-contiguous array (m, 2) of floats, its idle coordinate zero; ValueError if it
    has another shape."""
    array = np.ascontiguousarray(x, dtype=float)
    if array.ndim != 2 or array.shape[1] != n:
        raise ValueError("points are an array of shape (m, %d), not %r" % (n, array.shape))
    return array if n == 2 else np.column_stack([array, np.zeros_like(array)])


def address(array, kind="double(*)[2]"):
    """Where C finds an array."""
    return ffi.cast(kind, ffi.from_buffer(array))


@dataclass(frozen=True, repr=False)
class Potential(Dynamics):
    """A potential V(x) on the torus of period 1, and its map x' = x + p', p' = p - eps grad V(x).

    The potential of a SymplecticMap has a map, and states, whose angles and momenta have the period
    2 pi: they are y = 2 pi x and J = 2 pi p.  The methods of the map take these, and evaluate()
    takes x.

    A subclass has evaluate(), `formula`, `curvature` and `lipschitz`: V(x), or V(y), in words,
    exactly; an upper bound of the spectral norm of V'' anywhere; and K with |V''(x) - V''(y)|
    <= K |x - y|, in these norms.  If its orbits are to be proved it has also law(base, u): V, its
    gradient, and the entries 00, 01 and 11 of its Hessian, as balls of python-flint that hold them
    at the point base + u, base rational numbers and u balls without radius.

    Parameters
    ----------
    name : str
        For reports; of a potential that is no Fourier sum, also its name in the module of its
        class.
    start : tuple of float, shape (n,)
        A maximum of V, where orbits begin; n is the number of dimensions, 1 or 2, and 2 of a
        potential that is no Fourier sum.
    """

    name: str
    start: Tuple[float, ...]

    period = 1.0
    formula: ClassVar[Any]
    curvature: ClassVar[Any]
    lipschitz: ClassVar[Any]

    @property
    def n(self) -> int:
        """Dimensions, 1 or 2."""
        return len(self.start)

    dimension = n                       # type: ignore[assignment]

    @property
    def letters(self) -> str:           # type: ignore[override]
        """The names of an angle and of a momentum."""
        return "xp" if self.period == 1 else "yJ"

    @cached_property
    def _handle(self):
        return ffi.new_handle(self)

    @cached_property
    def native(self) -> Any:
        """What C takes."""
        return ffi.new("cv_potential *", {"n": self.n, "python": self._handle})

    def __repr__(self) -> str:
        return "<potential %s>" % self.name

    def __reduce__(self):
        return self.name

    def evaluate(self, x: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """V, its gradient and its Hessian.

        Parameters
        ----------
        x : array of float, shape (m, n)
            Points, in turns.

        Returns
        -------
        value, gradient, hessian
            Arrays (m,), (m, n) and (m, n, n) of V and its derivatives by x.

        Raises
        ------
        ValueError
            The array has another shape.
        """
        raise NotImplementedError

    def _gradient(self, y):
        return self.period * self.evaluate(y / self.period)[1]

    def _hessian(self, y):
        return self.evaluate(y / self.period)[2]


@dataclass(frozen=True, repr=False)
class Fourier(Potential):
    """A finite Fourier sum: V(x) is a scale times the sum at 2 pi x.

    Parameters
    ----------
    sum : FourierSum
        In the units of input files, where angles have period 2 pi.
    factor : str
        The scale, a key of SCALES.
    period : float
        Of the angles of the map and of states: 1, or 2 pi if the factor is PER_PERIOD.  With eps 1,
        y = 2 pi x and J = 2 pi p the latter is the map of proofs (converse/model/potential.py).
    """

    sum: FourierSum
    factor: str
    period: float                       # type: ignore[misc]

    @classmethod
    def of(cls, source: FourierSum, name: str = "fourier",
           start: Optional[Tuple[float, ...]] = None, factor: str = PER_PERIOD,
           period: float = 1.0) -> "Fourier":
        """The potential of a FourierSum; without a start a maximum of V is looked for.
        ValueError: it has three angles, or is too large for doubles."""
        two_at_most(source.dimension)
        made = cls(name, start or (0.0,) * source.dimension, source, factor, period)
        made.lipschitz                  # ValueError: too large
        return made if start else replace(made, start=made._maximum())

    def __reduce__(self):
        return Fourier.of, (self.sum, self.name, self.start, self.factor, self.period)

    @property
    def formula(self) -> str:
        text = potential_text(self.sum.waves, [{"": p} for p in self.sum.amplitude], self.n,
                              *(["x", "2 pi"] if self.period == 1 else []))
        return text if self.period != 1 or self.factor == "1" else \
            "s (%s), s = %s" % (text, self.factor)

    def _bound(self, m, turns):
        """(2 pi)^m, rounded up, times the sum of |k|^m |amplitude|, added up exactly and a little
        more; as a double at least that, float() being off by 2^-53 of it."""
        bound = self.scale_enclosure(30)[1] * sum(
            _root_up(sum(i * i for i in k)) ** m * abs(p)
            for (*k, _), p in zip(self.sum.waves, self.sum.amplitude))
        if bound > 10 ** 300:
            raise ValueError("the amplitudes of a Fourier sum are too large for doubles")
        return float(bound * Fraction(turns) * (1 + Fraction(1, 2 ** 50)))

    @cached_property
    def curvature(self) -> float:
        return self._bound(2, "39.4785")

    @cached_property
    def lipschitz(self) -> float:
        return self._bound(3, "248.0503")

    @property
    def scale(self) -> float:
        """The factor of the sum, in doubles."""
        low, high = self.scale_enclosure(30)
        return float((low + high) / 2)

    def scale_enclosure(self, digits: int) -> Ends:
        """The ends of an interval around the scale, no further apart than 10^-digits."""
        return SCALES[self.factor](digits)

    @cached_property
    def arrays(self) -> List[np.ndarray]:
        """The integers k, shape (m, 2), and the coefficients of the cosines and of the sines, scale
        and all, of V(x)."""
        terms, scale = list(self.sum.terms(MAX_EXPONENT + 20)), self.scale
        return [np.array([k for k, *_ in terms], dtype=np.intc)] + [
            np.array([float(sum(term[i]) / 2) * scale for term in terms]) for i in (1, 2)]

    @cached_property
    def native(self) -> Any:
        k, *both = self.arrays
        cosine, sine = (address(array, "double *") for array in both)
        return ffi.new("cv_potential *", {"n": self.n, "terms": len(k), "k": address(k, "int *"),
                                          "cosine": cosine, "sine": sine})

    def evaluate(self, x: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        x = points(x, self.n)
        value, gradient, bend = np.empty(len(x)), np.empty((len(x), 2)), np.empty((len(x), 3))
        lib.cv_evaluate(self.native, len(x), address(x), address(value, "double *"),
                        address(gradient), address(bend, "double(*)[3]"))
        return value, gradient[:, :self.n], bend[:, [[0, 1], [1, 2]]][:, :self.n, :self.n]

    def coefficients(self, digits: int) -> List[Tuple[Tuple[int, ...], Ends, Ends]]:
        """[((k0, k1), ends of the cosine's factor, ends of the sine's)], scale and all, each to
        10^-digits."""
        sizes: List[Any] = [*self.sum.amplitude, self.scale]
        more = digits + 2 + len(str(math.ceil(max(map(abs, sizes)))))
        scale = self.scale_enclosure(more)
        return [(k, product(c, scale), product(d, scale)) for k, c, d in self.sum.terms(more)]

    def _maximum(self):
        """The best of a grid of points, then Newton."""
        axis = (np.arange(64) + 0.5) / 64
        grid = np.stack(np.meshgrid(*[axis] * self.n, indexing="ij"), -1).reshape(-1, self.n)
        best = grid[np.argmax(self.evaluate(grid)[0])][None]
        for _ in range(20):
            value, gradient, hessian = self.evaluate(best)
            with np.errstate(all="ignore"):
                step = np.linalg.lstsq(hessian[0], gradient[0], rcond=MIN_STEP_RATIO)[0]
            better = best - step
            if not self.evaluate(better)[0][0] > value[0]:
                break
            best = better
        return tuple(map(float, best[0]))


class _Mine(threading.local):
    """Of each thread the exception that is to end its C."""

    error = None


_mine = _Mine()


def _keep(kind, error, trace):
    _mine.error = error


@ffi.def_extern(error=1, onerror=_keep)
def cv_python_interrupts():
    """Signals are looked for when Python begins to run, and Ctrl-C is raised then."""
    return _mine.error is not None


@ffi.def_extern(onerror=_keep)
def cv_python_evaluate(handle, m, x, value, gradient, hessian):
    """Calls evaluate() of the potential."""
    def array(pointer, *shape):
        return np.frombuffer(ffi.buffer(pointer, 8 * math.prod(shape))).reshape(shape)

    found = ffi.from_handle(handle).evaluate(array(x, m, 2))
    array(value, m)[:], array(gradient, m, 2)[:] = found[:2]
    array(hessian, m, 3)[:] = found[2][:, [0, 0, 1], [0, 1, 1]]


def done(code):
    """A code of C, unless it is an error, which is raised."""
    error, _mine.error = _mine.error, None
    if error is not None:
        raise error
    return check(code)


def _root_up(x):
    """Not below the square root, by at most 10^-9."""
    return root_bounds(Fraction(math.ceil(x * 10 ** 18), 10 ** 18), 9)[1] if x else Fraction(0)


def _trig_scale(digits):
    """1/M_trig, M_trig = sqrt(207 + 33 sqrt 33)/(8 sqrt 2): 1/M^2 = 128/(207 + 33 sqrt 33)."""
    low, high = root_bounds(Fraction(33), digits + 5)
    return (root_bounds(128 / (207 + 33 * high), digits + 5)[0],
            root_bounds(128 / (207 + 33 * low), digits + 5)[1])


# The bounds of scales to 10^-digits.
SCALES: Dict[str, Callable[[int], Ends]] = {
    "1": lambda digits: (Fraction(1), Fraction(1)), PER_PERIOD: per_period, TRIG: _trig_scale}

_HALF = Fraction(1, 2)

# The first of the thesis's three, the real Froeschle map, and the standard map, whose eps is its
# parameter k.  V = 1 at the start of trig, 9/16 at froeschle's.
_SINES, _COSINES = (((1, 0, phase), (0, 1, phase), (1, 1, phase)) for phase in (Fraction(0), _HALF))
trig = Fourier.of(FourierSum(_SINES, (_HALF, _HALF, Fraction(1)), 2), "trig",
                  (0.8510422, 0.8510422), TRIG)
froeschle = Fourier.of(FourierSum(_COSINES, (_HALF / 2, _HALF / 2, _HALF), 2), "froeschle",
                       (0.29021531, 0.29021531), "1")
standard = Fourier.of(FourierSum(((1, 0, _HALF),), (Fraction(1),), 1), "standard", (0.5,))
