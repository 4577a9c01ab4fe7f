"""The rigorous C routines one at a time, from exact numbers to exact numbers: the console, which
build.py builds."""

import math
from decimal import Decimal
from fractions import Fraction
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from itertools import chain
from types import SimpleNamespace
from typing import Any, List, Sequence, Tuple

from converse.model.exact import Number, decimal_text, exact
from converse.prover import native
from converse.prover.native import MESSAGES, check

from .build import NAME, path


def _load():
    file = str(path())
    module = module_from_spec(spec_from_file_location(
        NAME, file, loader=ExtensionFileLoader(NAME, file)))
    return module.ffi, module.lib


ffi, lib = _load()

Interval = Tuple[Fraction, Fraction]
Rows = List[List[Fraction]]
Prism = Tuple[Sequence[Number], Sequence[Sequence[Number]]]     # centre: 7; matrix: 7 rows of 7
Range = Sequence[Number]                                        # lo, hi

ARITHMETICS = ("apm", "double")

# What the routines take for granted; the C side looks.
_PRISM = "a prism whose parameters depend on nothing else and have no negative widths"
TAKES = {
    "bound_sincos": "lo <= hi", "product": "lo <= hi", "square": "lo <= hi",
    "torus": "lo <= hi of each parameter", "image": _PRISM, "btrace": _PRISM, "Blams": _PRISM,
    "row_sums": _PRISM,
    "image_ns": _PRISM + ", and at most 1e9 repetitions",
    "least_lambda": _PRISM + ", and positive bounds of a positive definite block",
    "cone": "k = 4 or k = 16", "scale": "at most 100000 places",
    "cell": "lo <= hi of each parameter, and no negative half-widths",
    "region": "a half-width that is not negative",
    "region_that_moves": "a half-width that is not negative",
    "constants": "half-widths that are not negative",
}


def _exact(x: Number) -> str:
    """An int, a Fraction or a Decimal of finite decimals, or a string, for the C side."""
    if isinstance(x, str):
        return decimal_text(exact(x)) if "/" in x else x
    if isinstance(x, bool) or not isinstance(x, (int, Fraction, Decimal)):
        raise TypeError("%r is not an exact number: give an int, a Fraction, a Decimal or a "
                        "decimal string" % (x,))
    if isinstance(x, Decimal) and not x.is_finite():
        raise ValueError("%s is not a finite number" % x)
    return str(x) if isinstance(x, Decimal) else decimal_text(x)


def call(name: str, values: Sequence[Number], nout: int, dp: int, arithmetic: str = "apm",
         as_printed: bool = False) -> List[Fraction]:
    """Calls a routine of the core with these numbers and returns its nout results."""
    if arithmetic not in ARITHMETICS:
        raise ValueError("the arithmetic is 'apm' or 'double', not %r" % (arithmetic,))
    owners = [ffi.new("char[]", _exact(x).encode("utf-8")) for x in values]
    out = ffi.new("char *[]", nout)
    code = lib.kernel(name.encode("utf-8"), arithmetic == "double", as_printed, dp,
                         len(owners), ffi.new("char *[]", owners), nout, out)
    texts = [ffi.string(text).decode("ascii") for text in out if text]
    for text in filter(None, out):
        lib.cv_free(text)
    if code in (native.lib.CV_EARITHMETIC, native.lib.CV_ESINGULAR):
        raise ArithmeticError("%s: %s" % (name, MESSAGES[code]))
    if code == native.lib.CV_EARGUMENT and name in TAKES:
        raise ValueError("%s: too many or too few numbers, or some that make no sense; it takes %s"
                         % (name, TAKES[name]))
    if code in (native.lib.CV_ENUMBER, native.lib.CV_EARGUMENT):
        raise ValueError("%s: %s" % (name, MESSAGES[code]))
    check(code)
    return [Fraction(Decimal(text)) for text in texts]


THESIS = ((1, 0), (0, 1), (1, 1))       # k of the thesis's waves


def thesis(prism: Sequence[Fraction]) -> Any:
    """The patch of centres and half-widths of a, b, c, v0, v1; x*; do a, b, c move together?

    A patch has waves (*k, phase in radians, amplitude, three parts), centre and half-width of each
    v, the frame row by row, x*, three shifts of each v, and the number of its parameters.
    """
    centre, half, star, together = prism[:5], prism[5:10], [*prism[10:12]], prism[12]
    waves = [(*k, Fraction(0), p, *(h * (m == (0 if together else i)) for m in range(3)))
             for i, (k, p, h) in enumerate(zip(THESIS, centre, half))]
    return SimpleNamespace(waves=waves, parameters=1 if together else 3, centre=centre[3:],
                           half=half[3:], frame=(1, 0, 0, 1), xstar=star,
                           shifts=[[Fraction(0)] * 3] * 2)


def arguments(patch: Any) -> List[Number]:
    """The patch as the routines of any waves take it."""
    return [len(patch.waves), patch.parameters, *chain(*patch.waves),
            *chain(*zip(patch.centre, patch.half)), *patch.frame, *patch.xstar,
            *chain(*patch.shifts)]


def turns(upper: Number, lower: Number) -> Fraction:
    """An angle of csrc/arith/turns.h as a part of a turn, from -1/2 to 1/2."""
    part = Fraction(int(upper) << 32 | int(lower), 1 << 64)
    return part - (part > Fraction(1, 2))


def pi(dp: int, **options: Any) -> Fraction:
    """pi to dp decimal places."""
    return call("pi", [], 1, dp, **options)[0]


def sin(x: Number, dp: int, **options: Any) -> Fraction:
    """The sine of x to dp decimal places."""
    return call("sincos", [x], 2, dp, **options)[0]


def sqrt(x: Number, dp: int, **options: Any) -> Fraction:
    """The square root of x to dp decimal places."""
    return call("sqrt", [x], 2, dp, **options)[0]


def bound_sin(lo: Number, hi: Number, dp: int, **options: Any) -> Interval:
    """An interval (lo, hi) that holds the sine of every number from lo to hi."""
    return _pair(call("bound_sincos", [lo, hi], 4, dp, **options))


def bound_cos(lo: Number, hi: Number, dp: int, **options: Any) -> Interval:
    """An interval (lo, hi) that holds the cosine of every number from lo to hi."""
    return _pair(call("bound_sincos", [lo, hi], 4, dp, **options)[2:])


def inverse(matrix: Sequence[Sequence[Number]], dp: int, **options: Any) -> Rows:
    """An approximate inverse of a 4 x 4 matrix, a list of rows."""
    return _rows(call("inverse", [x for row in matrix for x in row], 17, dp, **options)[:16], 4)


def image(prism: Prism, dp: int, **options: Any) -> Tuple[List[Fraction], Rows]:
    """A prism that holds the image of a prism (centre, matrix): 7 numbers, 7 rows of 7."""
    out = call("image", _flat(prism), 56, dp, **options)
    return out[:7], _rows(out[7:], 7)


def btrace(prism: Prism, dp: int, **options: Any) -> Interval:
    """An interval (lo, hi) that holds the trace of beta at every point of a prism."""
    return _pair(call("btrace", _flat(prism), 2, dp, **options))


def Blams(prism: Prism, dp: int, **options: Any) -> Tuple[Interval, Interval]:
    """Intervals that hold the least and the largest eigenvalue of beta over a prism."""
    out = call("Blams", _flat(prism), 4, dp, **options)
    return _pair(out), _pair(out[2:])


def torus(a: Range, b: Range, c: Range, dp: int, **options: Any) -> Interval:
    """The bounds (T, B) over the whole torus for ranges (lo, hi) of the parameters."""
    return _pair(call("torus", [*a, *b, *c], 2, dp, **options))


def cell(a: Range, b: Range, c: Range, centre: Sequence[Number], half: Sequence[Number],
         dp: int, **options: Any) -> Interval:
    """Bounds of the trace and of the largest eigenvalue of 2I + W over a cell of the torus, a
    rectangle centre +- half, for ranges (lo, hi) of the parameters (csrc/model/torus.c)."""
    return _pair(call("cell", [*a, *b, *c, *centre, *half], 2, dp, **options))


def region(centre: Number, half: Number, dp: int, **options: Any) -> Interval:
    """An interval (centre, half) in radians that holds one in units of pi."""
    return _pair(call("region", [centre, half], 2, dp, **options))


def constants(centre: Sequence[Number], half: Sequence[Number], xstar: Sequence[Number],
              dp: int, **options: Any) -> Tuple[Fraction, ...]:
    """What a search begins with, for parameters centre +- half: T, Tr-, Tr+, B, lambda-min and
    lambda-max, and upper bounds of the trace and of the least eigenvalue of the block d_0."""
    return tuple(call("constants", [*centre, *half, *xstar], 8, dp, **options))


def _pair(values: Sequence[Fraction]) -> Interval:
    return values[0], values[1]


def _flat(prism: Prism) -> List[Number]:
    centre, matrix = prism
    return list(centre) + [x for row in matrix for x in row]


def _rows(values: List[Fraction], n: int) -> Rows:
    return [values[i:i + n] for i in range(0, n * n, n)]


def lanes(search: Any) -> int:
    """How many prisms a search of the product's, its handle, tries at once."""
    return lib.search_lanes(ffi.cast("void *", int(native.ffi.cast("intptr_t", search))))


def is_mirrored(search: Any) -> bool:
    """Does a search of the product's follow orbits from x* to one side only?  It is set up."""
    return bool(lib.search_mirrored(ffi.cast("void *", int(native.ffi.cast("intptr_t", search)))))


def half_width(search: Any, axis: int) -> Fraction:
    """Half of the width of v0 or v1, in radians, once it is set up."""
    text = lib.search_half(ffi.cast("void *", int(native.ffi.cast("intptr_t", search))), axis)
    return Fraction(ffi.string(ffi.gc(text, lib.cv_free)).decode("ascii"))


def grow(search: Any, leaves: int = native.MANY) -> str:
    """The text of a search of the product's, its handle, when it has so many leaves more."""
    check(native.lib.cv_begin(search, leaves, math.inf))
    check(native.lib.cv_set_up(search))
    check(native.lib.cv_work(search))
    view = native.ffi.new("cv_view *")
    check(native.lib.cv_look(search, 1, view))
    text = native.ffi.unpack(view.tree, view.length).decode("ascii") if view.length else ""
    native.lib.cv_forget_view(view)
    return text.rstrip("?")
