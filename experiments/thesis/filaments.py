"""The curves that an orbit contracts to, and how often they wind round the torus: thesis, section
2.3, "shapes".

Points at most r apart are linked.  A closed chain of links has winding numbers round the torus, one
in each direction.  A component of the graph of links is a cluster if all its chains wind (0, 0), a
curve of type (a, b) if all wind by multiples of (a, b), and a surface otherwise.  The type is the
one for which this holds over the widest range of r that begins below WIDEST.  Curves that touch are
one component; how many curves there are is therefore counted on lines across them.

The captions of the figures orb-* use this: the thesis counts the curves of orb-spnf1, orb-sphd2 and
orb-auhd2, and speaks of clumps in orb-spnf2 and orb-sphd2.
"""

from math import gcd
from typing import NamedTuple, Tuple

import numpy as np

MOST_PARTS = 60                         # components; a division into more is not examined
WIDEST = 0.1                            # gap between neighbours on a curve
APART = 0.05                            # a wider gap on a line separates two clusters
HALF_WIDTH = 0.02                       # of a line
LINES = 100


class Filaments(NamedTuple):
    """The curves that the points of an orbit lie on."""

    type: Tuple[int, int]               # as (1, -1): the first that is not 0 is positive
    gap: float                          # with r from gap up to distance they form curves
    distance: float
    axis: int                           # the coordinate that is constant on lines across
    clusters: int                       # the median number of clusters on such a line

    @property
    def count(self):
        """How many curves these are, each crossing a line as often as its type says."""
        return max(1, round(self.clusters / abs(self.type[self.axis])))


def filaments(x):
    """The Filaments that the points x (q, 2), of period 1, lie on, or None.  Takes time in q^2."""
    x = np.array(x, dtype=float) % 1.0
    if x.ndim != 2 or x.shape[1] != 2 or not len(x) or not np.isfinite(x).all():
        raise ValueError("filaments are of points in the plane: give a finite array (q, 2)")
    edges, lift = _spanning_tree(x)
    first_edges = max(len(edges) - MOST_PARTS, 0)
    label = np.arange(len(x))
    for _, i, j in edges[:first_edges]:
        label[label == label[j]] = label[i]
    label = np.unique(label, return_inverse=True)[1]
    loops = _loops(x, lift, label)
    part = np.arange(label.max(initial=0) + 1)          # of each label
    ranges, begin = [], 0.0
    for length, i, j in edges[first_edges:] + [(0.5, 0, 0)]:    # at 0.5 the torus is covered
        ranges += [found for found in _range_of_r(part, loops, begin, length)
                   if found[0] <= WIDEST]
        part[part == part[label[j]]] = part[label[i]]
        begin = length
    if not ranges:
        return None
    gap, distance, kind = max(ranges, key=lambda found: found[1] / found[0])
    axis = int(abs(kind[1]) >= abs(kind[0]))
    return Filaments(kind, gap, distance, axis, clusters(x, axis, kind[1 - axis] / kind[axis]))


def clumps(x, link):
    """How many components the points x (q, 2), of period 1, form when points at a distance of at
    most `link` are linked."""
    edges, _ = _spanning_tree(np.array(x, dtype=float) % 1.0)
    return 1 + sum(length > link for length, _, _ in edges)


def clusters(x, axis, slope=0.0):
    """How many clusters there are on a line x[axis] = const, of the points within HALF_WIDTH, moved
    there along the slope: the median over those of LINES lines that meet any."""
    counts = []
    for k in range(LINES):
        off = x[:, axis] - k / LINES
        off -= np.rint(off)
        near = abs(off) <= HALF_WIDTH
        if near.any():
            place = np.sort((x[near, 1 - axis] - slope * off[near]) % 1.0)
            gaps = np.diff(place, append=place[0] + 1.0)
            counts.append(max(np.count_nonzero(gaps > APART), 1))
    return int(np.median(counts))


def _way(x, y):
    """From a point to points: the shortest way round the torus, and its length."""
    step = y - x
    step -= np.rint(step)
    return step, np.hypot(step[:, 0], step[:, 1])


def _windings(x, step, y):
    """The whole numbers by which x + step lies in another cell of the plane than y."""
    return np.rint(x + step - y).astype(int)


def _spanning_tree(x):
    """The shortest tree that links all points (Prim): its edges (length, i, j), shortest first, and
    the cell of the plane, for each point, to which the tree leads from point 0."""
    lift, link = np.zeros(x.shape, int), np.zeros(len(x), int)
    far, outside = np.full(len(x), np.inf), np.ones(len(x), bool)
    edges, i = [], 0
    for _ in range(len(x) - 1):
        outside[i], far[i] = False, np.inf
        length = _way(x[i], x)[1]
        nearer = outside & (length < far)
        far[nearer], link[nearer] = length[nearer], i
        j = int(np.argmin(far))
        edges.append((float(far[j]), int(link[j]), j))
        step, _ = _way(x[link[j]], x[j:j + 1])
        lift[j] = lift[link[j]] + _windings(x[link[j]], step[0], x[j])
        i = j
    return sorted(edges), lift


def _loops(x, lift, label):
    """The shortest link of each kind that closes a chain round the torus: rows (length, label of
    one end, of the other, windings in both directions), shortest first."""
    reach = 2 * int(abs(lift).max(initial=0)) + 2
    side = 2 * reach + 1
    shape = (label.max(initial=0) + 1,) * 2 + (side, side)
    least = np.full(shape, np.inf).ravel()
    for i in range(len(x) - 1):
        step, length = _way(x[i], x[i + 1:])
        windings = _windings(x[i], step, x[i + 1:]) + lift[i] - lift[i + 1:]
        round_ = windings.any(axis=1)
        a, b = windings[round_].T + reach
        kind = ((label[i] * shape[1] + label[i + 1:][round_]) * side + a) * side + b
        np.minimum.at(least, kind, length[round_])
    there, = np.nonzero(least < np.inf)
    one, other, a, b = np.unravel_index(there, shape)
    return sorted(zip(least[there].tolist(), one.tolist(), other.tolist(), (a - reach).tolist(),
                      (b - reach).tolist()))


def _range_of_r(part, loops, begin, end):
    """For a division into parts that holds for r from begin to end: the least and the largest r for
    which all parts are curves of one type, and the type; a list of one, or an empty one."""
    first = {}                                          # of each part: its shortest loop
    for length, one, other, a, b in loops:
        if length >= end:
            break
        if part[one] == part[other]:
            c, d, _ = first.setdefault(int(part[one]), (a, b, length))
            if a * d != b * c:                          # with longer links it is a surface
                end = length
                break
    types = {_type(a, b) for a, b, _ in first.values()}
    begin = max([begin] + [length for _, _, length in first.values()])
    if len(first) < len(set(part.tolist())) or len(types) > 1 or begin >= end:
        return []
    return [(begin, end, types.pop())]


def _type(a, b):
    sign = 1 if (a, b) > (0, 0) else -1
    return sign * a // gcd(a, b), sign * b // gcd(a, b)
