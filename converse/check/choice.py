"""Choices: of vectors n and of axes to cut, in double precision.

No theorem rests on them.  Any n will do, and halves of a leaf along any axis tile it.
"""

import math

from .arith import DIAGONAL, NEWTON_STEPS, full, newton, spread, times, trace, with_determinant
from .limits import HALVINGS_APART_MAX, MATTERS_MIN


def least(d, root=math.sqrt, quotient=lambda x, y: x / y if x > 0 and y > 0 else 0):
    """The least eigenvalue of a symmetric matrix, in double precision; of arrays with a root and a
    quotient of arrays."""
    n = len(DIAGONAL[len(d)])
    value = (trace(d) - root(spread(d))) / n
    for _ in range(NEWTON_STEPS * (n > 2)):
        value = value + quotient(*newton(d, value)[:2])
    return value


def eigenvector(d, value):
    """The eigenvector of that eigenvalue, in double precision: the longest row of the cofactors."""
    rows = full(newton(d, value)[2])
    v = max(zip(rows, range(len(rows))), key=lambda pair: pair[0][pair[1]])[0]
    length = math.hypot(*v)
    return [x / length for x in v] if length else [1.0] + [0.0] * (len(rows) - 1)


def recursion(blocks, middle, tail):
    """The recursion of step (C3) from the first of these matrices on: of each d, its inverse, and
    where what it rests on begins, as it begins anew behind a place where d is not positive, and in
    the middle, where the other lane begins, if there was such a place before."""
    found, begin, inverse = [], 0, tail
    for k, block in enumerate(blocks):
        if k == middle and begin:
            begin, inverse = k, tail
        d = [x - y for x, y in zip(block, inverse)]
        adjugate, det = with_determinant(d)
        definite = d[0] > 0 and adjugate[-1] > 0 and det > 0
        inverse = [x / det for x in adjugate] if definite else tail
        found.append((d, inverse, begin))
        begin = begin if definite else k + 1
    return found


def test_vectors(ahead, back, tail):
    """Vectors n for the sites of both lanes, with these matrices: in doubles, as any n will do.

    At each site the recursions from both ends of the orbit are compared, the one from the lane's
    own end only where it has not failed.  Of each part that they cover without beginning anew, n at
    the place where both together have the negative eigenvalue nearest to zero is its eigenvector,
    and follows outwards.  The part with the lowest is taken: others may contradict next to nothing.
    Where both fail, x* is taken if its eigenvalue is 64 times lower: of amplitudes in thousands.
    """
    blocks = [*reversed(back), *ahead]
    left = recursion(blocks, len(back), tail)
    right = recursion(blocks[::-1], len(ahead), tail)[::-1]
    found, n = {}, [[0.0] * len(DIAGONAL[len(tail)])] * len(blocks)
    for k, (block, (d, _, begin), (beyond, _, end)) in enumerate(zip(blocks, left, right)):
        form = [x + y - z for x, y, z in zip(d, beyond, block)]
        low = least(form)
        if low < 0 and not (begin if k < len(back) else end):
            found[begin, end] = max(found.get((begin, end), (-math.inf,)), (low, k, form))
        elif low < 0 and k == len(back) - 1 and end:
            found[begin, end] = low / 64, k, form
    if found:
        _, place, form = min(found.values())
        n[place] = eigenvector(form, least(form))
        for k in range(place, left[place][2], -1):
            n[k - 1] = times(left[k - 1][1], n[k])
        for k in range(place + 1, len(n) - right[place][2]):
            n[k] = times(right[k][1], n[k - 1])
    return [n[len(back):], n[:len(back)][::-1]]


def trimmed(vectors):
    """The vectors without the zeros at the end."""
    while vectors and not any(vectors[-1]):
        vectors.pop()
    return vectors


def worst_axis(blame, halved):
    """The place of the axis that matters most, from how much each matters; or if it was halved far
    more often than another that matters, of the one that was halved least."""
    worst = blame.index(max(blame))
    often = halved[worst] - HALVINGS_APART_MAX
    others = [(k, n) for n, k in enumerate(halved)
              if k < often and blame[n] >= blame[worst] * MATTERS_MIN]
    return min(others)[1] if others else worst
