"""The closest pairs of points of a periodic orbit: how smooth is the surface that they lie on?"""

from typing import NamedTuple

import numpy as np


class Pairs(NamedTuple):
    """The closest pairs of points, closest first: their indices i and j, the distance |dx| of the
    angles on the torus, and the distance |dp| of the momenta, in the units of the map; arrays of
    one length."""

    i: np.ndarray
    j: np.ndarray
    distance: np.ndarray
    momentum: np.ndarray


def pairs(state, count=800):
    """The pairs of points with the closest angles on the torus, at most so many."""
    count = min(count, state.q * (state.q - 1) // 2)
    i, j, distance = closest_pairs(state.turns, count)
    momentum = np.sqrt(((state.momenta[i] - state.momenta[j]) ** 2).sum(1))
    return Pairs(i, j, state.potential.period * distance, momentum)


def closest_pairs(x, count):
    """The `count` closest pairs of points x (q, n) on the torus: indices i, j and distances, the
    closest first.

    In the order of the first angle each point is compared with its next, second, ... neighbour to
    the right, round the torus, until that angle alone is farther than the widest pair kept.  Each
    pair is met from the end that has the other within half a turn to its right."""
    x = x - np.floor(x)
    order = np.argsort(x[:, 0], kind="stable")
    x, q = x[order], len(x)
    i, j, square = np.zeros(0, int), np.zeros(0, int), np.zeros(0)
    for offset in range(1, q if count else 1):
        left = np.arange(q)
        right = (left + offset) % q
        gap = x[right, 0] - x[left, 0] + (right < left)
        widest = square.max() if len(square) == count else 1.0
        near = (gap * gap <= widest) & ((gap < 0.5) | ((gap == 0.5) & (left < right)))
        if not near.any():
            break
        left, right = left[near], right[near]
        away = x[right] - x[left]
        i, j = np.append(i, left), np.append(j, right)
        square = np.append(square, ((away - np.rint(away)) ** 2).sum(1))
        kept = np.argpartition(square, count - 1)[:count] if len(square) > count else slice(None)
        i, j, square = i[kept], j[kept], square[kept]
    nearest = np.argsort(square, kind="stable")
    return order[i[nearest]], order[j[nearest]], np.sqrt(square[nearest])
