"""Rotation vectors with good small divisors near a given place.

Near a vector of rationals there are vectors of a field: those that lie in one Farey triangle (of
determinant 1 or -1) with its corners p_i/q_i weighed by a basis c_i of the integers of the field,
(sum of c_i p_i)/(sum of c_i q_i).  Far out they all have the divisors of the field; a large
triangle, small norms and conjugates that nearly coincide make them better (Kim and Ostlund, Phys.
Rev. A 34, 3426, 1986).  On a line these are the noble numbers, whose continued fractions end in
1, 1, 1, ...
"""

import re
from fractions import Fraction
from functools import lru_cache
from itertools import permutations, product, repeat
from math import ceil, floor
from typing import Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np

from ..model.exact import Number, exact, short_text
from .field import Field, Polynomial, determinant, real_roots
from .newton import combined
from .rotation import Rotation, read_rotation

TOLERANCE, LEAST = Fraction(1, 1000), Fraction(1, 10 ** 12)
COARSEST = {1: LEAST, 2: TOLERANCE}         # For two angles a smaller tolerance takes minutes.
FIELDS = (-1, -2, 1, 1), (-1, -1, 0, 1)         # of 2 cos(2 pi/7), and of the spiral mean
GOLDEN = -1, 1, 1
HIGHEST = 2                             # coefficient of the integers of a field that are tried
STEEPEST = 60.0                         # ratio of weights in a triangle
SEEN, POOLED, COMPARED = 200, 800, 6    # candidates of a triangle, of all, and in the end,
DISTINCT = 100                          # which differ by the tolerance over DISTINCT.
LARGEST = 20                            # denominator of a triangle, times the tolerance^(2/3)
NEAREST, REACH = 40, 500                # |k| up to which divisors are judged so
DECIMALS = re.compile(r"(\s*[-+]?(\d+\.?\d*|\.\d+)\s*(,|$))+", re.ASCII)

Place = Sequence[Union[Number, float]]
# Triangles are (A, B, C), the right angle at B; points are triples (p0, p1, q).
Triangle = Tuple[Tuple[int, int, int], ...]
LOWER: Triangle = ((1, 0, 1), (0, 0, 1), (0, 1, 1))
UPPER: Triangle = ((1, 0, 1), (1, 1, 1), (0, 1, 1))


def rotation_of(given: Union[Rotation, str], dimension: Optional[int] = None) -> Rotation:
    """A rotation vector as it is, or the one that a text describes: as read_rotation takes it, or
    decimals such as "0.2077" or "0.2742, 0.2802", which stand for the nearest() vector.

    Raises
    ------
    TypeError, ValueError
        It is neither, or not of `dimension` angles."""
    if not isinstance(given, (Rotation, str)):
        raise TypeError("the rotation vector is a Rotation, or a text such as 'golden', not %r; "
                        "near=(0.618,) takes numbers" % (given,))
    if isinstance(given, Rotation):
        return given
    if not DECIMALS.fullmatch(given):
        return read_rotation(given, dimension)
    return nearest([each.strip() for each in given.split(",")], dimension=dimension)


def nearest(place: Place, tolerance: Union[Number, float, None] = None,
            dimension: Optional[int] = None) -> Rotation:
    """The rotation vector with the best small divisors that is found near a place: a noble number,
    or for two angles a vector of a cubic field.

    For it c(delta) of docs/proofs/existence.md is least in doubles, with the norm of k that adds
    the absolute values of its components.

    Parameters
    ----------
    place : sequence of number, str or float
        One or two components, in turns.
    tolerance : number, optional
        How far each component may be away, in turns; by default a unit of the last decimal that is
        given, 0.001 if it is no decimal, and for two angles at least 0.001.
    dimension : int, optional
        How many angles the map has; by default any number.

    Returns
    -------
    Rotation

    Raises
    ------
    ValueError
        The place is not of so many numbers, or no vector was found so near.
    """
    texts = [repr(float(w)) if isinstance(w, float) else str(w) for w in place]
    target, n = tuple(map(exact, texts)), len(texts)
    if n not in (1, 2) or dimension not in (None, n):
        raise ValueError("a rotation vector near %s has %d components; give %s" % (
            ", ".join(texts), n, "one or two" if dimension is None else dimension))
    if tolerance is None:
        within = max(COARSEST[n], *(
            Fraction(1, 10 ** len(text.partition(".")[2])) if "." in text and text[-1] != "."
            and "e" not in text else TOLERANCE for text in texts))
    else:
        within = exact(repr(tolerance) if isinstance(tolerance, float) else tolerance)
    if not LEAST <= within <= 1:
        raise ValueError("the tolerance, %s, is not from %s to 1"
                         % (short_text(within), short_text(LEAST)))
    found = _nobles(target[0], within) if n == 1 else cubics(target, within)
    delta = _delta(n, within)
    k = _modes(n, ceil(min(10 / delta, REACH)))
    best, least = None, None
    for rotation in found:
        if any(low < w - within or high > w + within
               for (low, high), w in zip(rotation.turns(30), target)):
            continue
        c = float(_near_part(np.array([rotation.floats]), k, abs(k).sum(1), delta)[0])
        if least is None or c < least:
            best, least = rotation, c
    if best is None:
        raise ValueError("no rotation vector was found within %s of %s; give fewer decimals"
                         % (short_text(within), " ".join(map(short_text, target))))
    return best


def _delta(n, within):
    """A Farey interval of the size `within` has denominators of about within^(-1/2), a triangle of
    about within^(-2/3), and the divisors that set a vector apart are those of such k."""
    return float(within) ** (0.5 if n == 1 else 2 / 3)


# ---- one angle

Interval = Tuple[Tuple[int, int], Tuple[int, int]]      # neighbours p/q and r/s of a Farey sequence


def noble(interval: Interval) -> Rotation:
    """The noble number (p t + r)/(q t + s), t the golden mean, between p/q and r/s.  With its ends
    exchanged an interval has another one, nearer to p/q."""
    above, below = zip(*interval)
    field = _field(GOLDEN)
    return _rotation(field, [_quotient(field, (field.t, field.element([1])), above, below)])


def _nobles(w: Fraction, within: Fraction) -> List[Rotation]:
    """The most promising noble numbers of the Farey intervals that meet the range but do not lie
    within smaller ones that do."""
    low, high, t = w - within, w + within, (5 ** 0.5 - 1) / 2
    intervals: List[Interval] = [((p, 1), (p + 1, 1)) for p in range(floor(low), ceil(high))]
    found, omega = [], []
    while intervals:
        (p, q), (r, s) = left, right = intervals.pop()
        for interval, value in (((left, right), (p * t + r) / (q * t + s)),
                                ((right, left), (r * t + p) / (s * t + q))):
            if abs(value - w) <= within:
                found.append(interval)
                omega.append(value)
        if not low <= Fraction(p, q) < Fraction(r, s) <= high:
            middle = p + r, q + s
            intervals += [(a, b) for a, b in ((left, middle), (middle, right))
                          if Fraction(*a) < high and low < Fraction(*b)]
    score = _near_part(np.array(omega)[:, None], np.arange(1, SEEN + 1)[:, None],
                       np.arange(1.0, SEEN + 1), _delta(1, within))
    return [noble(found[j]) for j in np.argsort(score, kind="stable")[:COMPARED]]


@lru_cache(maxsize=None)
def _field(polynomial):
    """The field of its largest real root."""
    return Field(polynomial, real_roots(polynomial)[-1])


def _rotation(field, vector):
    return Rotation("", field.polynomial, (field.low, field.high), tuple(vector))


def _quotient(field, weights, above, below):
    """(sum of weights times above)/(sum of weights times below), integers."""
    total = [field.element([sum(n * w[j] for n, w in zip(numbers, weights))
                            for j in range(field.degree)]) for numbers in (above, below)]
    return field.product(total[0], field.inverse(total[1]))


# ---- two angles

def cubics(target: Sequence[Union[Fraction, float]], within: Fraction, count: int = COMPARED,
           norm: Optional[np.ndarray] = None) -> List[Rotation]:
    """Vectors of both fields within some distance of a place, those with the best divisors first,
    as far as doubles can tell.

    norm -- a matrix of determinant 1 or -1: |k| adds the absolute values of norm.k; None: of k"""
    target, delta = [Fraction(w) for w in target], _delta(2, within)
    norm = np.eye(2) if norm is None else norm
    corners = np.linalg.inv(norm).T             # of the ball |k| <= 1
    kept: List[tuple] = []
    for polynomial in FIELDS:
        bases, values = _bases(polynomial)
        for triangle in _triangles(target, within):
            q, *p = (combined(column, values[:, 0].real) for column in zip(*triangle))
            close = np.flatnonzero(np.all([abs(p_i - float(w) * q) <= float(within) * q
                                           for p_i, w in zip(p, target)], 0))
            omega, score = _far_part(values[..., close], triangle, delta, corners)
            best = np.argsort(score, kind="stable")[:SEEN]
            kept += zip(score[best], omega[:, best].T, repeat(polynomial), close[best],
                        repeat(triangle))
    kept = sorted(kept, key=lambda each: each[0])[:POOLED]
    k = _modes(2, NEAREST)
    near = _near_part(np.array([each[1] for each in kept]).reshape(-1, 2), k,
                      abs(k @ norm.T).sum(1), delta)
    chosen: List[Rotation] = []
    for j in np.argsort(np.maximum(near, [each[0] for each in kept]), kind="stable"):
        _, omega, polynomial, basis, triangle = kept[j]
        if all(abs(omega - other.floats).max() > float(within) / DISTINCT for other in chosen):
            field, (q, *p) = _field(polynomial), zip(*triangle)
            weights = [tuple(map(Fraction, w)) for w in _bases(polynomial)[0][basis].tolist()]
            chosen.append(_rotation(field, [_quotient(field, weights, each, q) for each in p]))
        if len(chosen) == count:
            break
    return chosen


@lru_cache(maxsize=None)
def _bases(polynomial: Polynomial) -> Tuple[np.ndarray, np.ndarray]:
    """Triples of positive integers of the field with determinant 1 or -1, of comparable size and in
    all orders: shape (number, 3, 3), coefficients of 1, t, t^2 last; and their values at t and at
    its conjugates, shape (3, conjugates, number)."""
    roots, field = np.roots(polynomial[::-1]), _field(polynomial)
    order = np.argsort(abs(roots - float(field.bounds(field.t, 20)[0])))
    powers = np.vander(roots[order], 3, increasing=True)
    elements = np.array(list(product(range(-HIGHEST, HIGHEST + 1), repeat=3)))
    value = elements @ powers[0].real
    elements, value = elements[value > 1e-9], value[value > 1e-9]
    i, j = np.triu_indices(len(elements), 1)
    crosses = np.cross(elements[i], elements[j])
    pair, k = np.nonzero(abs(crosses @ elements.T) == 1)
    later = k > j[pair]
    pair, k = pair[later], k[later]
    triples = np.stack([i[pair], j[pair], k], 1)
    sizes = value[triples]
    triples = triples[sizes.max(1) < STEEPEST * sizes.min(1)]
    triples = np.concatenate([triples[:, order] for order in permutations(range(3))])
    return elements[triples], np.moveaxis((powers @ elements.T)[:, triples], -1, 0).copy()


def halves(triangle: Triangle) -> Tuple[Triangle, Triangle]:
    """The two triangles that the mediant of the hypotenuse, their new right angle, cuts a triangle
    into: the left one and the right one."""
    a, b, c = triangle
    x, y, q = (i + j for i, j in zip(a, c))
    return (b, (x, y, q), a), (c, (x, y, q), b)


def triangles(w0: Fraction, w1: Fraction) -> Iterator[Tuple[Triangle, str]]:
    """The Farey triangles that contain a vector of the unit square, each a half of the one before,
    without end: (corners, address).  A point on the cut counts as lying to the right."""
    cell, address = UPPER if w0 + w1 >= 1 else LOWER, ""
    while True:
        yield cell, address
        left, right = halves(cell)
        side = determinant([cell[1], left[1], (w0, w1, 1)]) * determinant([cell[1], left[1],
                                                                           cell[2]]) >= 0
        cell, address = (right if side else left), address + "lr"[side]


def _triangles(target, within) -> Iterator[Triangle]:
    """The Farey triangles that hold the target, each half of the one before (Kim and Ostlund),
    until they lie within the tolerance or have large denominators."""
    base = tuple(floor(w) for w in target)
    for cell, _ in triangles(*(w - b for w, b in zip(target, base))):
        corners = tuple((q, p0 + base[0] * q, p1 + base[1] * q) for p0, p1, q in cell)
        if max(q for q, *_ in corners) ** 3 * within ** 2 >= LARGEST ** 3:
            return
        yield corners
        if all(abs(Fraction(p, q) - w) <= within
               for q, *ps in corners for p, w in zip(ps, target)):
            return


def _far_part(values, triangle, delta, corners) -> Tuple[np.ndarray, np.ndarray]:
    """(vectors, about the share of large k in c(delta) of each), in doubles; values: (weights,
    conjugates, number)."""
    q, *p = (combined(column, values) for column in zip(*triangle))
    omega = np.array(p) / q                                     # (component, conjugate, number)
    (x0, x1), (y0, y1) = [combined(corner, omega[:, 1:] - omega[:, :1]) for corner in corners]
    # The form (x0 v + y0 w)(x1 v + y1 w) is a v^2 + b v w + c w^2; q has the norm of sum c_i q_i.
    a, b, c = (x0 * x1).real, (x0 * y1 + x1 * y0).real, (y0 * y1).real
    largest = np.maximum(abs(a), abs(c))
    for side in (b, -b):                # the largest value along an edge of the ball
        bend = a - side + c
        bend[bend == 0] = 1e-300
        at = (2 * a - side) / (2 * bend)
        largest = np.where((at > 0) & (at < 1), np.maximum(
            largest, abs((4 * a * c - b * b) / (4 * bend))), largest)
    return omega[:, 0].real, (2 / (np.e * delta)) ** 2 * abs(q.prod(0)) * largest / (2 * np.pi)


def _modes(n, reach) -> np.ndarray:
    """Of each k and -k one, k != 0, with components up to a reach: shape (count, n)."""
    k = np.array(np.meshgrid(np.arange(reach + 1), *[np.arange(-reach, reach + 1)] * (n - 1),
                             indexing="ij")).reshape(n, -1).T
    return k[(k[:, 0] > 0) | (k[:, -1] > 0)]


def _near_part(omega, k, size, delta) -> np.ndarray:
    """The share of k of these sizes in c(delta), in doubles; one row for each omega and k."""
    n, x = k.shape[1], delta * size
    height = np.where(x <= n, np.exp(-x), (n / (np.e * np.maximum(x, 1e-9))) ** n)
    divisor = 2 * abs(np.sin(np.pi * (omega @ k.T)))
    return (height / np.maximum(divisor, 1e-300)).max(1)
