"""Rotation vectors with good small divisors near a given place.

    python experiments/near.py W [W] [--tolerance T]

Prints the vector that converse-tori takes as --rotation.  For one angle it is a noble number.

Near a vector of rationals there are vectors of a field: those that lie in one Farey triangle (of
determinant 1 or -1) with its corners p_i/q_i weighed by a basis c_i of the integers of the field,
(sum of c_i p_i)/(sum of c_i q_i).  Far out they all have the divisors of the field; a large
triangle, small norms and conjugates that nearly coincide make them better.  On a line these are
the noble numbers, whose continued fractions end in 1, 1, 1, ...
"""

import argparse
import sys
from fractions import Fraction
from itertools import permutations, product
from math import ceil, floor
from typing import Iterator, List, Tuple, Union

import farey
import numpy as np

from converse.commands.common import Parser, ended
from converse.model.exact import Number, exact, short_text
from converse.storage.files import ConverseError
from converse.tori.field import Element, Field, real_roots
from converse.tori.rotation import Rotation

TOLERANCE, LEAST = Fraction(1, 1000), Fraction(1, 10 ** 6)
FIELDS = (-1, -2, 1, 1), (-1, -1, 0, 1)         # of 2 cos(2 pi/7), and of the spiral mean
GOLDEN = -1, 1, 1
HIGHEST = 3                             # coefficient of the integers of a field that are tried
STEEPEST = 60.0                         # ratio of weights in a triangle
SEEN, COMPARED = 1000, 6                # candidates, judged by few k and by many
LARGEST = 20                            # denominator of a triangle, times the tolerance^(2/3)
NEAREST, REACH = 40, 500                # |k| up to which divisors are judged so

Candidate = Tuple[Field, Tuple[Element, ...]]
Triangle = Tuple[Tuple[int, int, int], ...]     # corners (q, p0, p1)


def near(w0: Union[Number, float], w1: Union[Number, float, None] = None,
         tolerance: Union[Number, float] = TOLERANCE) -> Rotation:
    """The rotation vector with the best small divisors that was found near w0, or near (w0, w1).

    For it c(delta) of docs/proofs/existence.md is least in doubles, with the norm of k that adds
    the absolute values of its components.

    Parameters
    ----------
    w0, w1 : number or str
        In turns; w1 is given for two angles.
    tolerance : number or str
        How far each component may be away, in turns; the result's name tells it.

    Returns
    -------
    Rotation

    Raises
    ------
    ValueError
        None was found so near.
    """
    target = tuple(_about(w) for w in (w0, w1) if w is not None)
    within, n = _about(tolerance), len(target)
    if not LEAST <= within <= 1:
        raise ValueError("the tolerance, %s, is not from %s to 1"
                         % (short_text(within), short_text(LEAST)))
    # A Farey interval of this size has denominators of about within^(-1/2), a triangle of about
    # within^(-2/3), and the divisors that set this vector apart are those of such k.
    delta = Fraction(float(within) ** (0.5 if n == 1 else 2 / 3)).limit_denominator(10 ** 6)
    name = "best found within %s of %s" % (short_text(within), " ".join(map(short_text, target)))
    found = _nobles(target[0], within, float(delta)) if n == 1 \
        else _cubics(target, within, float(delta))
    k = _modes(n, ceil(min(10 / float(delta), REACH)))
    best, least = None, None
    for field, vector in found:
        rotation = Rotation(name, field.polynomial, (field.low, field.high), vector)
        if any(low < w - within or high > w + within
               for (low, high), w in zip(rotation.turns(30), target)):
            continue
        c = float(_near_part(np.array([rotation.floats]), k, abs(k).sum(1), float(delta))[0])
        if least is None or c < least:
            best, least = rotation, c
    if best is None:
        raise ValueError("no rotation vector was found within %s of %s; give a larger tolerance"
                         % (short_text(within), " ".join(map(short_text, target))))
    return best


def _about(number):
    """The number; a float stands for its decimal, since no theorem rests on it."""
    return exact(repr(float(number)) if isinstance(number, float) else number)


# ---- one angle

def _nobles(w: Fraction, within: Fraction, delta: float) -> List[Candidate]:
    """The most promising noble numbers of the Farey intervals that meet the range but do not lie
    within smaller ones that do."""
    field = Field(GOLDEN, real_roots(GOLDEN)[-1])
    g, one = (Fraction(0), Fraction(1)), (Fraction(1), Fraction(0))
    low, high, t = w - within, w + within, float(field.bounds(g, 20)[0])
    intervals = [((1, p), (1, p + 1)) for p in range(floor(low), ceil(high))]
    found, omega = [], []
    while intervals:
        (q, p), (r, s) = intervals.pop()
        for weights, (x, y) in (((one, g), (1, t)), ((g, one), (t, 1))):
            value = (x * p + y * s) / (x * q + y * r)
            if abs(value - w) <= within:
                found.append((weights, (p, s), (q, r)))
                omega.append(value)
        if not low <= Fraction(p, q) < Fraction(s, r) <= high:
            middle = q + r, p + s
            intervals += [ends for ends in (((q, p), middle), (middle, (r, s)))
                          if Fraction(ends[0][1], ends[0][0]) < high
                          and low < Fraction(ends[1][1], ends[1][0])]
    score = _near_part(np.array(omega)[:, None], np.arange(1, SEEN + 1)[:, None],
                       np.arange(1.0, SEEN + 1), delta)
    return [(field, (_quotient(field, *found[j]),)) for j in np.argsort(score)[:COMPARED]]


def _quotient(field, weights, above, below):
    """(sum of weights times above)/(sum of weights times below), integers."""
    total = [field.element([sum(n * w[j] for n, w in zip(numbers, weights))
                            for j in range(field.degree)]) for numbers in (above, below)]
    return field.product(total[0], field.inverse(total[1]))


# ---- two angles

def _cubics(target, within, delta) -> List[Candidate]:
    """The most promising vectors of both fields, as far as doubles can tell."""
    found = []
    for polynomial in FIELDS:
        field = Field(polynomial, real_roots(polynomial)[-1])
        bases, roots = _bases(field), np.roots(polynomial[::-1])
        roots = roots[np.argsort(abs(roots - _value(field)))]           # t first
        values = bases @ np.vander(roots, 3, increasing=True).T         # (bases, weights, roots)
        for triangle in _triangles(target, within):
            corners = np.array(triangle, float)
            at = values[..., 0].real @ corners                          # (bases, 3)
            close = np.flatnonzero((abs(at[:, 1:] / at[:, :1] - np.array(target, float))
                                    <= float(within)).all(1))
            if len(close):
                score = _scores(values[close], corners, delta)
                best = np.argsort(score, kind="stable")[:4 * COMPARED]
                found += [(score[j], field, bases[close[j]], triangle) for j in best]
    chosen: List[Candidate] = []
    for _, field, weights, triangle in sorted(found, key=lambda each: each[0]):
        q, p0, p1 = zip(*triangle)
        elements = [tuple(map(Fraction, w.tolist())) for w in weights]
        candidate = field, tuple(_quotient(field, elements, p, q) for p in (p0, p1))
        if candidate not in chosen:
            chosen.append(candidate)
        if len(chosen) == COMPARED:
            break
    return chosen


def _value(field) -> float:
    """t."""
    return float(field.bounds(field.t, 20)[0])


def _bases(field) -> np.ndarray:
    """Triples of positive integers of the field with determinant 1 or -1, of comparable size and in
    all orders: shape (number, 3, 3), coefficients of 1, t, t^2 last."""
    t = _value(field)
    elements = np.array(list(product(range(-HIGHEST, HIGHEST + 1), repeat=3)))
    value = elements @ np.array([1, t, t * t])
    elements, value = elements[value > 1e-9], value[value > 1e-9]
    i, j = np.triu_indices(len(elements), 1)
    crosses = np.cross(elements[i], elements[j])
    pair, k = np.nonzero(abs(crosses @ elements.T) == 1)
    later = k > j[pair]
    pair, k = pair[later], k[later]
    triples = np.stack([i[pair], j[pair], k], 1)
    sizes = value[triples]
    triples = triples[sizes.max(1) < STEEPEST * sizes.min(1)]
    return np.concatenate([elements[triples[:, order]] for order in permutations(range(3))])


def _triangles(target, within) -> Iterator[Triangle]:
    """The Farey triangles that hold the target, each half of the one before (Kim and Ostlund),
    until they lie within the tolerance or have large denominators."""
    base = tuple(floor(w) for w in target)
    for cell, _ in farey.triangles(*(w - b for w, b in zip(target, base))):
        corners = tuple((q, p0 + base[0] * q, p1 + base[1] * q) for p0, p1, q in cell)
        if max(q for q, *_ in corners) ** 3 * within ** 2 >= LARGEST ** 3:
            return
        yield corners
        if all(abs(Fraction(p, q) - w) <= within
               for q, *ps in corners for p, w in zip(ps, target)):
            return


def _scores(values, corners, delta) -> np.ndarray:
    """About c(delta) of each vector, in doubles; values: (number, weights, conjugates)."""
    total = np.einsum("nwr,wc->nrc", values, corners)
    conjugates = total[..., 1:] / total[..., :1]                        # (number, conjugate, 2)
    omega = conjugates[:, 0].real
    denominator = abs(total[..., 0].prod(1))                            # the norm of sum c_i q_i
    v, w = np.eye(2)

    def form(m):
        return (((conjugates[:, 1:] - conjugates[:, :1]) @ m).prod(1)).real

    a, c = form(v), form(w)
    b, largest = form(v + w) - a - c, np.maximum(abs(a), abs(c))
    for side in (b, -b):                # the largest value along an edge of the ball
        bend = a - side + c
        bend[bend == 0] = 1e-300
        at = (2 * a - side) / (2 * bend)
        largest = np.where((at > 0) & (at < 1), np.maximum(
            largest, abs((4 * a * c - b * b) / (4 * bend))), largest)
    score = (2 / (np.e * delta)) ** 2 * denominator * largest / (2 * np.pi)
    k = _modes(2, NEAREST)
    best = np.argsort(score)[:SEEN]
    found = np.full(len(score), np.inf)
    found[best] = np.maximum(score[best], _near_part(omega[best], k, abs(k).sum(1), delta))
    return found


def _modes(n, reach) -> np.ndarray:
    """Of each k and -k one, k != 0, with components up to a reach: shape (count, n)."""
    k = np.array(np.meshgrid(np.arange(reach + 1), *[np.arange(-reach, reach + 1)] * (n - 1),
                             indexing="ij")).reshape(n, -1).T
    return k[(k[:, 0] > 0) | (k[:, -1] > 0)]


def _near_part(omega, k, size, delta) -> np.ndarray:
    """What k of these sizes contribute to c(delta), in doubles; one row for each omega and k."""
    n, x = k.shape[1], delta * size
    height = np.where(x <= n, np.exp(-x), (n / (np.e * np.maximum(x, 1e-9))) ** n)
    divisor = 2 * abs(np.sin(np.pi * (omega @ k.T)))
    return (height / np.maximum(divisor, 1e-300)).max(1)


def number(text):
    try:
        return exact(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def run(options):
    if len(options.place) > 2:
        raise ConverseError("a place has one number or two, not %d" % len(options.place))
    try:
        print(near(*options.place, tolerance=options.tolerance).text())
    except ValueError as error:
        raise ConverseError(str(error)) from None
    return 0


def main(argv=None):
    p = Parser(prog="near.py", description="Finds a rotation vector with good small divisors.")
    p.add_argument("place", nargs="+", metavar="W", type=number, help="a component, in turns")
    p.add_argument("--tolerance", type=number, default=TOLERANCE, metavar="T",
                   help="how far each component may be away (default 0.001)")
    return ended("near.py", lambda: run(p.parse_args(argv)), lambda: "no vector is chosen")


if __name__ == "__main__":
    sys.exit(main())
