"""Potentials V on the torus of period 1, n = 1 or 2 dimensions (thesis, section 2.2).

The map is x' = x + p', p' = p - eps grad V(x).
"""

import math
import operator
import pickle
import threading
from fractions import Fraction
from functools import lru_cache
from numbers import Number
from types import MappingProxyType
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from .._native import ffi, lib
from ..model.dynamics import Dynamics
from ..model.exact import Ends, root_bounds
from ..model.map import SymplecticMap
from ..model.potential import FourierSum, from_terms, per_period, product
from ..prover.native import check
from ..storage.files import plain
from .limits import COMPARED_POINTS, DIFFERENCE_STEP, MAX_DISAGREEMENT

Source = Union[SymplecticMap, "Potential"]
Numerators = Union[int, Sequence[int]]      # the p of a type (p, q)

TURN = 2 * math.pi
# The scales of Fourier sums, as formulas name them.
PER_PERIOD, TRIG = "1/(4 pi^2)", "8 sqrt 2/sqrt(207 + 33 sqrt 33)"
STUDIED = {}                # by name, the potentials at the end of this file


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
    """As a list of floats, of one number or several; ValueError, unless they are finite."""
    floats = _floats([values] if isinstance(values, (str, Number)) else values)
    if floats is None:
        raise ValueError("%s: finite numbers, as a list, not %.200r" % (what, values))
    return list(floats)


def whole(what, value, least, most=2 ** 31 - 1):
    """As an int; ValueError, unless it is a whole number in this range."""
    try:
        if int(value) == value and least <= value <= most:
            return int(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError("%s: a whole number from %d to %d, not %.200r" % (what, least, most, value))


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


class Potential(Dynamics):
    """A potential V(x) on the torus of period 1, and its map x' = x + p', p' = p - eps grad V(x).
    It cannot be changed.

    Its map, and its states, have angles and momenta of another period if it is the potential of a
    SymplecticMap: then they are y = 2 pi x and J = 2 pi p.  The methods of the map take these, and
    evaluate() takes x.

    name       -- for reports
    period     -- of the angles and momenta of the map and of states: 1, or 2 pi
    n          -- dimensions, 1 or 2
    start      -- a maximum of V, where orbits begin
    formula    -- V(x), or V(y), in words, exactly, for reports
    curvature  -- an upper bound of the spectral norm of V'' anywhere; None: not known
    lipschitz  -- K with |V''(x) - V''(y)| <= K |x - y|, in these norms; None: not known
    """

    name: str
    n: int
    start: Tuple[float, ...]
    formula: str
    curvature: Optional[float]
    lipschitz: Optional[float]
    scale: float                        # of a Fourier sum
    native: Any
    period, letters = 1.0, "xp"

    def __init__(self, kind: int, name: str, n: int, start: Optional[Sequence[float]], formula: str,
                 curvature: Optional[float] = None, lipschitz: Optional[float] = None):
        if n not in (1, 2):
            raise ValueError("a potential has one or two coordinates, not %r" % (n,))
        if not isinstance(name, str) or not name or not name.isprintable():
            raise ValueError("the name of a potential is printable text, not %r" % (name,))
        if name in STUDIED:
            raise ValueError("the name %s is taken by orbits.%s; choose another" % (name, name))
        n = int(n)
        start = (0.0,) * n if start is None else _floats(start)
        if start is None or len(start) != n:
            raise ValueError("the start of an orbit is %d finite numbers" % n)
        for bound in curvature, lipschitz:
            if bound is not None and (_floats([bound]) is None or not bound >= 0):
                raise ValueError("curvature and lipschitz are finite numbers, 0 or more, or None, "
                                 "not %r" % (bound,))
        vars(self).update(name=name, n=n, dimension=n, start=start, formula=formula,
                          curvature=curvature, lipschitz=lipschitz,
                          native=ffi.new("cv_potential *", {"kind": kind, "n": n}))

    def __setattr__(self, name, value):
        if not name.startswith("_"):
            raise AttributeError("a potential cannot be changed (%s), since what was found and "
                                 "proved rests on it: make another" % name)
        super().__setattr__(name, value)

    def __delattr__(self, name):
        raise AttributeError("a potential cannot be changed (%s)" % name)

    def __repr__(self) -> str:
        return "orbits.%s" % self.name if self.name in STUDIED else "<potential %s>" % self.name

    def __reduce__(self):
        if STUDIED.get(self.name) is self:
            return _studied, (self.name,)
        raise TypeError("the potential %s cannot be sent to another process" % self.name)

    def _key(self) -> tuple:
        """The values that define the potential: two with the same key are equal."""
        return self.name, self.n, self.start, self.formula, self.curvature, self.lipschitz

    def __eq__(self, other: object) -> bool:
        return self is other or (type(other) is type(self) and self._key() == other._key())

    def __hash__(self) -> int:
        return hash((self.name, self.n, self.start))

    def evaluate(self, x: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """V, its gradient and its Hessian at x (m, n): arrays (m,), (m, n) and (m, n, n)."""
        x = points(x, self.n)
        value, gradient, bend = np.empty(len(x)), np.empty((len(x), 2)), np.empty((len(x), 3))
        done(lib.cv_evaluate(self.native, len(x), address(x), address(value, "double *"),
                             address(gradient), address(bend, "double(*)[3]")), self)
        hessian = np.empty((len(x), 2, 2))
        hessian[:, 0, 0], hessian[:, 1, 1] = bend[:, 0], bend[:, 2]
        hessian[:, 0, 1] = hessian[:, 1, 0] = bend[:, 1]
        return value, gradient[:, :self.n], hessian[:, :self.n, :self.n]

    def _derivatives(self, y):
        _, gradient, hessian = self.evaluate(y / self.period)
        return self.period * gradient, hessian


class Fourier(Potential):
    """A finite Fourier sum, V(x) = scale * sum of cosine cos(2 pi k.x) + sine sin(2 pi k.x).

    terms -- {k: (cosine, sine)}, k a tuple of n integers; floats stand for their exact values
    start -- a maximum of V; by default one is looked for

    The scale is 1.  Fourier.of takes the potential of a map, whose scale is 1/(4 pi^2).
    """

    sum: FourierSum
    _scale: str                         # a key of SCALES

    def __init__(self, terms: Dict[Tuple[int, ...], tuple], name: str = "fourier",
                 start: Optional[Tuple[float, ...]] = None):
        try:
            terms = {tuple(map(operator.index, k)): (Fraction(c), Fraction(s))
                     for k, (c, s) in terms.items()}
        except (AttributeError, TypeError, ValueError, ZeroDivisionError, OverflowError):
            raise ValueError("terms are {(k0, k1): (cosine, sine)}, or {(k,): (cosine, sine)} for "
                             "one angle: tuples of whole numbers with finite numbers, not %r"
                             % (terms,)) from None
        widths = {len(k) for k in terms}
        if len(widths) != 1 or not widths <= {1, 2} or any(abs(i) > 1000 for k in terms for i in k):
            raise ValueError("a Fourier sum has terms, all with one or all with two integers from "
                             "-1000 to 1000; there are %r" % sorted(terms))
        self._set_up(from_terms(terms), name, start)

    @classmethod
    def of(cls, source: FourierSum, name: str = "fourier",
           start: Optional[Tuple[float, ...]] = None, scale: str = PER_PERIOD,
           period: float = 1.0) -> "Fourier":
        """From waves, amplitudes and phases, in the units of input files, where angles have period
        2 pi: with eps 1, y = 2 pi x and J = 2 pi p the map is that of proofs
        (converse/model/potential.py)."""
        if not isinstance(source, FourierSum):
            raise ValueError("Fourier.of takes a FourierSum, not %.200r" % (source,))
        made = cls.__new__(cls)
        made._set_up(source, name, start, scale, period)
        return made

    def _set_up(self, source, name, start, scale="1", period=1.0):
        low, high = SCALES[scale](30)
        vars(self).update(sum=source, scale=float((low + high) / 2), _scale=scale, period=period,
                          letters="xp" if period == 1 else "yJ")
        terms = _significant(source)
        formula = source.text("2 pi", "x") if period == 1 else source.text("", "y")
        if period == 1 and scale != "1":
            formula = "s (%s), s = %s" % (formula, scale)
        super().__init__(lib.CV_FOURIER, name, source.dimension, start, formula,
                         *_bounds(terms, high))
        self._arrays = [np.array([k for k, *_ in terms], dtype=np.intc)] + [
            np.array([float(sum(term[i]) / 2) * self.scale for term in terms]) for i in (1, 2)]
        self.native.terms = len(terms)
        self.native.k, self.native.cosine, self.native.sine = (
            address(array, kind)
            for array, kind in zip(self._arrays, ("int *",) + 2 * ("double *",)))
        if start is None:
            vars(self).update(start=self._maximum())

    def __reduce__(self):
        if STUDIED.get(self.name) is self:
            return super().__reduce__()
        return Fourier.of, (self.sum, self.name, self.start, self._scale, self.period)

    def _key(self) -> tuple:
        return (*super()._key(), self.sum, self._scale, self.period)

    @property
    def terms(self) -> Mapping[Tuple[int, ...], Tuple[Fraction, Fraction]]:
        """{k: (cosine, sine)}, without waves whose phase makes these irrational."""
        return MappingProxyType({k[:self.n]: (c[0], d[0]) for k, c, d in self.sum.terms(0)
                                 if c[0] == c[1]})

    def coefficients(self, digits: int) -> List[Tuple[Tuple[int, ...], Ends, Ends]]:
        """[((k0, k1), ends of the cosine's factor, ends of the sine's)], scale and all, each to
        10^-digits."""
        sizes: List[Any] = [*self.sum.amplitude, self.scale]
        more = digits + 2 + len(str(math.ceil(max(map(abs, sizes)))))
        scale = self.scale_enclosure(more)
        return [(k, product(c, scale), product(d, scale)) for k, c, d in self.sum.terms(more)]

    def scale_enclosure(self, digits: int) -> Ends:
        """The ends of an interval around the scale, no further apart than 10^-digits."""
        return SCALES[self._scale](digits)

    def _maximum(self):
        """The best of a grid of points, then Newton."""
        axis = (np.arange(64) + 0.5) / 64
        grid = np.stack(np.meshgrid(*[axis] * self.n, indexing="ij"), -1).reshape(-1, self.n)
        best = grid[np.argmax(self.evaluate(grid)[0])][None]
        for _ in range(20):
            value, gradient, hessian = self.evaluate(best)
            with np.errstate(all="ignore"):
                step = np.linalg.lstsq(hessian[0], gradient[0], rcond=1e-9)[0]
            better = best - step
            if not self.evaluate(better)[0][0] > value[0]:
                break
            best = better
        return tuple(map(float, best[0]))


class FromPython(Potential):
    """A potential given by an object: value(x), gradient(x) and hessian(x) take an array (m, n) and
    return arrays (m,), (m, n) and (m, n, n).

    ValueError, with the place and both numbers, if gradient or hessian disagree with differences of
    value or gradient at one of a few points."""

    def __init__(self, source: object, n: int, name: str = "python",
                 start: Optional[Sequence[float]] = None,
                 curvature: Optional[float] = None) -> None:
        for method in ("value", "gradient", "hessian"):
            if not callable(getattr(source, method, None)):
                raise ValueError("a potential needs value(x), gradient(x) and hessian(x); %r has "
                                 "no %s"
                                 % (source, method))
        super().__init__(lib.CV_PYTHON, name, n, start, "what a Python object says", curvature)
        vars(self).update(source=source)
        self._error = None              # what source raised, until done() raises it again
        self._handle = ffi.new_handle(self)
        self.native.self = self._handle
        self._compare()

    def _compare(self):
        """Compares gradient and Hessian with central differences.  Their error is about
        DIFFERENCE_STEP^2 of the third derivative, and the rounding of V over DIFFERENCE_STEP."""
        x = np.random.default_rng(0).random((COMPARED_POINTS, self.n))
        value, gradient, hessian = self.evaluate(x)
        for axis in range(self.n):
            step = DIFFERENCE_STEP * np.eye(self.n)[axis]
            above, below = self.evaluate(x + step), self.evaluate(x - step)
            for what, of, said, k in (("gradient", "value", gradient[:, axis, None], 0),
                                      ("hessian", "gradient", hessian[:, :, axis], 1)):
                seen = (above[k] - below[k]).reshape(said.shape) / (2 * DIFFERENCE_STEP)
                size = np.abs(said).max() + np.abs(seen).max() + 1e-6 * np.abs(value).max()
                off = np.abs(said - seen)
                if off.max() > MAX_DISAGREEMENT * size:
                    point, i = np.unravel_index(np.argmax(off), off.shape)
                    entry = axis if k == 0 else (int(i), axis)
                    raise ValueError(
                        "%s(x) of the potential %s is not the derivative of %s(x): at x = %s its "
                        "entry %s is %.9g, and differences give %.9g; they are %.1e apart"
                        % (what, self.name, of, tuple(map(float, x[point].round(6))), entry,
                           said[point, i], seen[point, i], off[point, i]))

    def __reduce__(self):
        return FromPython, (self.source, self.n, self.name, self.start, self.curvature)

    def _key(self):
        """Sources are compared as their pickles: a class need not define equality."""
        try:
            source = pickle.dumps(self.source)
        except Exception:               # of many kinds; such a source is equal to itself alone
            source = id(self.source)
        return (*super()._key(), source)


@ffi.def_extern(error=lib.CV_EARGUMENT)
def cv_python_potential(handle, m, x, value, gradient, hessian):
    potential = ffi.from_handle(handle)
    n = potential.n

    def array(pointer, width):
        return np.frombuffer(ffi.buffer(pointer, 8 * m * width)).reshape(m, width)

    def ask(method, *shape):
        found = np.asarray(getattr(potential.source, method)(at), dtype=float)
        if found.shape != (m, *shape) or not np.isfinite(found).all():
            raise ValueError("%s(x) of the potential %s is not an array %r of finite numbers"
                             % (method, potential.name, (m, *shape)))
        return found

    try:
        at = array(x, 2)[:, :n].copy()      # to be kept or changed as one likes
        if value:
            array(value, 1)[:, 0] = ask("value")
        if gradient:
            array(gradient, 2)[:, n:] = 0.0
            array(gradient, 2)[:, :n] = ask("gradient", n)
        if hessian:
            bend, flat = ask("hessian", n, n), array(hessian, 3)
            flat[:] = 0.0
            flat[:, 0] = bend[:, 0, 0]
            if n == 2:
                flat[:, 1], flat[:, 2] = bend[:, 0, 1], bend[:, 1, 1]
    except BaseException as error:          # Ctrl-C, too
        potential._error = error
        return lib.CV_EARGUMENT
    return lib.CV_OK


# Of each thread: `error`, the exception that ended its C; `stop`, an Event that ends the thread.
_mine = threading.local()


def look_up():
    """Ends the work of a thread that was told to end, as Ctrl-C ends the main thread's."""
    stop = getattr(_mine, "stop", None)
    if stop is not None and stop.is_set():
        raise KeyboardInterrupt


class Stoppable:
    """A task for the threads of an executor, all of which end soon after stop is set.  It can be
    sent to other processes; there only signals end it."""

    def __init__(self, task):
        self.task, self.stop = task, threading.Event()

    def __reduce__(self):
        return Stoppable, (self.task,)

    def __call__(self, *arguments):
        _mine.stop = self.stop
        try:
            return self.task(*arguments)
        finally:
            _mine.stop = None


def _interrupted(kind, error, trace):
    _mine.error = error


@ffi.def_extern(error=1, onerror=_interrupted)
def cv_python_interrupts():
    """Signals are looked for when Python begins to run, and Ctrl-C is raised then."""
    look_up()
    return 0


def done(code, potential=None):
    """A code of C, unless it is an error, which is raised; what Python raised there is its own."""
    if code == lib.CV_ESTOPPED:
        raise _mine.error
    if code < 0 and getattr(potential, "_error", None) is not None:
        error, potential._error = potential._error, None
        raise error
    return check(code)


def _floats(values):
    """As a tuple; None, unless they are finite numbers."""
    try:
        floats = tuple(float(x) for x in values)
    except (TypeError, ValueError, OverflowError):
        return None
    return floats if all(map(math.isfinite, floats)) else None


def _significant(source):
    """The terms of a FourierSum to 18 significant digits at least."""
    digits = 30
    while True:
        terms = list(source.terms(digits))
        if all((high - low) * 10 ** 18 <= min(abs(low), abs(high))
               for _, *both in terms for low, high in both):
            return terms
        if digits > 1000:
            raise ValueError("an amplitude cannot be told from zero")
        digits *= 2


def _bounds(terms, size):
    """Curvature and lipschitz: (2 pi)^m times the sum of |k|^m |amplitude|, m = 2 and 3, added up
    exactly and a little more; as a double at least that, float() being off by 2^-53 of it."""
    sums = [sum(size * _root_up(k0 * k0 + k1 * k1) ** m
                * _root_up(sum(max(map(abs, ends)) ** 2 for ends in both))
                for (k0, k1), *both in terms) for m in (2, 3)]
    if max(sums) > 10 ** 300:
        raise ValueError("the amplitudes of a Fourier sum are too large for doubles")
    return [float(bound * x * (1 + Fraction(1, 2 ** 50)))
            for bound, x in zip(sums, (Fraction("39.4785"), Fraction("248.0503")))]


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

# Curvature and lipschitz.  ff: |c''| <= 48, |c'''| = 192.  V'' is diag(c''(x0), c''(x1))/4, of norm
# 12 at most, and c''(x0 + x1)/2 times [[1, 1], [1, 1]], whose norm is 2; x0 + x1 moves by sqrt 2
# |dx| at most: 12 + 48, and 48 + 96 2 sqrt 2 < 320.
_FF_BOUNDS = (60.0, 320.0)

# poly: V = -4096 f(y0) g(y1), y = x mod 1 - 1/2.  With a = 1/4 - y^2, from 0 to 1/4,
# f = a^2 (a - 3/16), f'' = -30 a^2 + 33 a/4 - 3/8, f''' = 2 y (60 a - 33/4); g = a^2, g'' = 2 - 12
# a, g''' = 24 y.  Derivatives 0 to 3 are at most 1/256, 0.022, 3/8, 33/4 and 1/16, 0.1925, 2, 12.
# The norm of V'' is at most its larger diagonal entry and |V_01|; of the third derivative along a
# unit vector v the terms with v0^3 and v1^3 make at most the larger one, and v0^2 v1 and v0 v1^2,
# three times each, are at most 0.385.
_POLY_BOUNDS = (4096 * (3 / 8 / 16 + 0.022 * 0.1925),
                4096 * (33 / 4 / 16 + 3 * 0.385 * (3 / 8 * 0.1925 + 0.022 * 2)))

# The thesis's three, the real Froeschle map, and the standard map, whose eps is its parameter k.
# Their names are theirs alone.
# V = 1 at the start of trig, 1/4 at poly's, 27/49 at ff's, 9/16 at froeschle's.
trig = Fourier.of(from_terms({(1, 0): (0, -_HALF), (0, 1): (0, -_HALF), (1, 1): (0, -1)}),
                       "trig", (0.8510422, 0.8510422), TRIG)
poly = Potential(lib.CV_POLY, "poly", 2, ((2 - math.sqrt(2)) / 4, 0.5),
                 "-4096 a^2 (a - 3/16) b^2, a = 1/4 - (x0 mod 1 - 1/2)^2, "
                 "b = 1/4 - (x1 mod 1 - 1/2)^2", *_POLY_BOUNDS)
ff = Potential(lib.CV_FF, "ff", 2, (2 / 7, 2 / 7),
               "-(c(x0) + c(x1))/4 - c(x0 + x1)/2, c(x) = 1 - 24 y^2 + 32 y^3, y the distance from "
               "x to the nearest integer", *_FF_BOUNDS)
froeschle = Fourier({(1, 0): (-_HALF / 2, 0), (0, 1): (-_HALF / 2, 0), (1, 1): (-_HALF, 0)},
                    "froeschle", (0.29021531, 0.29021531))
standard = Fourier.of(from_terms({(1,): (-1, 0)}), "standard", (0.5,))

STUDIED.update({potential.name: potential
                for potential in (trig, poly, ff, froeschle, standard)})


def _studied(name):
    return STUDIED[name]


def parameters(eps: float) -> Tuple[float, float, float]:
    """The a, b, c of the rest of the package, where the angles have period 2 pi, whose map is that
    of trig and eps: with y = 2 pi x, a = b = c/2 = 2 pi^2 eps/M_trig."""
    eps, = finite("eps", [eps])
    a = 2 * math.pi ** 2 * trig.scale * eps
    return a, a, 2 * a
