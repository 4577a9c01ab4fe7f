/* sym2.h - symmetric matrices [d0 d1; d1 d2] of two rows, lane by lane.  Nothing rigorous rests on
   the roundings of these functions. */
#ifndef CONVERSE_SYM2_H
#define CONVERSE_SYM2_H

#include "arith/lanes.h"

INLINE vec sym2_det(const vec d[3]) { return d[0] * d[2] - d[1] * d[1]; }

INLINE vec sym2_least_eigenvalue(const vec d[3])
{
    const vec half = 0.5 * (d[0] - d[2]);

    return 0.5 * (d[0] + d[2]) - root_of(half * half + d[1] * d[1]);
}

/* A unit eigenvector for the least eigenvalue. */
INLINE void least_eigenvector(const vec d[3], vec n[2])
{
    const vec value = sym2_least_eigenvalue(d);
    const mask first = TRUTH(d[0] > d[2]);
    const vec a = pick(first, d[1], value - d[2]), b = pick(first, value - d[0], d[1]);
    const vec length = root_of(a * a + b * b);
    const mask good = TRUTH(length > 0.0);

    n[0] = pick(good, a / length, every(1.0));
    n[1] = pick(good, b / length, every(0.0));
}

/* Are both eigenvalues above l? */
INLINE mask sym2_is_above(const vec d[3], vec l)
{
    return TRUTH(d[0] > l) & TRUTH((d[0] - l) * (d[2] - l) > d[1] * d[1]);
}

/* r = m - 1/d; r may be m. */
INLINE void sym2_subtract_inverse(vec r[3], const vec m[3], const vec d[3])
{
    const vec inverse = 1.0 / sym2_det(d);

    r[0] = m[0] - d[2] * inverse;
    r[1] = m[1] + d[1] * inverse;
    r[2] = m[2] - d[0] * inverse;
}

/* n = m / d */
INLINE void sym2_solve(vec n[2], const vec d[3], const vec m[2])
{
    const vec inverse = 1.0 / sym2_det(d);

    n[0] = (d[2] * m[0] - d[1] * m[1]) * inverse;
    n[1] = (d[0] * m[1] - d[1] * m[0]) * inverse;
}

#endif
