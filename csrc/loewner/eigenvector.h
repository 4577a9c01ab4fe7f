/* eigenvector.h - of a symmetric matrix, lane by lane; nothing rigorous rests on it. */
#ifndef CONVERSE_EIGENVECTOR_H
#define CONVERSE_EIGENVECTOR_H

#include "arith/lanes.h"

/* A unit eigenvector of a symmetric matrix, for its least eigenvalue. */
INLINE void least_eigenvector(const vec d[3], vec n[2])
{
    const vec half = 0.5 * (d[0] - d[2]);
    const vec value = 0.5 * (d[0] + d[2]) - root_of(half * half + d[1] * d[1]);
    const mask first = TRUTH(d[0] > d[2]);
    const vec a = pick(first, d[1], value - d[2]), b = pick(first, value - d[0], d[1]);
    const vec length = root_of(a * a + b * b);
    const mask good = TRUTH(length > 0.0);

    n[0] = pick(good, a / length, every(1.0));
    n[1] = pick(good, b / length, every(0.0));
}

#endif
