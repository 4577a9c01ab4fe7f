/* sym.h - symmetric matrices of n = 1, 2 or 3 rows, lane by lane: the entries of the upper half,
   row by row.  Nothing rigorous rests on the roundings of these functions, except sym_adjugate. */
#ifndef CONVERSE_SYM_H
#define CONVERSE_SYM_H

#include "arith/lanes.h"

enum { MOST_ENTRIES = 6 };

/* The place of the element i, j of n rows. */
INLINE int sym_at(int n, int i, int j)
{
    return i <= j ? i * (2 * n - i - 1) / 2 + j : j * (2 * n - j - 1) / 2 + i;
}

/* a = the cofactors of d; the determinant.  Each cofactor is an entry of d, or a difference of two
   products of entries; the determinant is the sum of the first row's entries times theirs. */
INLINE vec sym_adjugate(int n, vec a[], const vec d[])
{
    if (n == 1) {
        a[0] = every(1.0);
        return d[0];
    }
    if (n == 2) {
        a[0] = d[2];
        a[1] = -d[1];
        a[2] = d[0];
        return d[0] * d[2] - d[1] * d[1];
    }
    a[0] = d[3] * d[5] - d[4] * d[4];
    a[1] = d[2] * d[4] - d[1] * d[5];
    a[2] = d[1] * d[4] - d[2] * d[3];
    a[3] = d[0] * d[5] - d[2] * d[2];
    a[4] = d[1] * d[2] - d[0] * d[4];
    a[5] = d[0] * d[3] - d[1] * d[1];
    return d[0] * a[0] + d[1] * a[1] + d[2] * a[2];
}

/* r = d v */
INLINE void sym_times(int n, vec r[], const vec d[], const vec v[])
{
    for (int i = 0; i < n; i++) {
        r[i] = d[sym_at(n, i, 0)] * v[0];
        for (int j = 1; j < n; j++)
            r[i] += d[sym_at(n, i, j)] * v[j];
    }
}

/* r = d - x I */
INLINE void sym_less(int n, vec r[], const vec d[], vec x)
{
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            r[sym_at(n, i, j)] = i == j ? d[sym_at(n, i, i)] - x : d[sym_at(n, i, j)];
}

/* Of three rows it is a little less than the least eigenvalue: mean + 2 p c, where c, the least
   root of 4c^3 - 3c = r, lies between -1 and -1/2.  A parabola in the root of (1 - r)/2 leads
   Newton's method to it from below. */
INLINE vec sym_least_eigenvalue(int n, const vec d[])
{
    if (n == 1)
        return d[0];
    if (n == 2) {
        const vec half = 0.5 * (d[0] - d[2]);
        return 0.5 * (d[0] + d[2]) - root_of(half * half + d[1] * d[1]);
    }
    const vec mean = (d[0] + d[3] + d[5]) * (1.0 / 3.0);
    vec e[MOST_ENTRIES], a[MOST_ENTRIES];

    sym_less(n, e, d, mean);
    const vec squares =
        e[0] * e[0] + e[3] * e[3] + e[5] * e[5] + 2.0 * (e[1] * e[1] + e[2] * e[2] + e[4] * e[4]);
    const vec p = root_of(squares * (1.0 / 6.0)) + 0x1p-100;
    const vec r = sym_adjugate(n, a, e) / (2.0 * p * p * p);
    const vec s = root_of(larger(every(0.0), 0.5 - 0.5 * r));
    vec c = -0.51 - s * (0.57 - 0.07 * s);

    for (int k = 0; k < 3; k++)
        c -= (c * (4.0 * c * c - 3.0) - r) / (12.0 * c * c - 3.0);
    return mean + 2.0 * p * (c - 0x1p-20);
}

/* A unit eigenvector for the least eigenvalue: the largest column of the cofactors. */
INLINE void sym_least_eigenvector(int n, const vec d[], vec v[])
{
    vec e[MOST_ENTRIES], a[MOST_ENTRIES], most, squares = every(0.0);

    sym_less(n, e, d, sym_least_eigenvalue(n, d));
    sym_adjugate(n, a, e);
    most = a[0];
    for (int i = 0; i < n; i++)
        v[i] = a[i];
    for (int k = 1; k < n; k++) {
        const vec size = a[sym_at(n, k, k)];
        const mask better = TRUTH(size > most);
        most = pick(better, size, most);
        for (int i = 0; i < n; i++)
            v[i] = pick(better, a[sym_at(n, i, k)], v[i]);
    }
    for (int i = 0; i < n; i++)
        squares += v[i] * v[i];
    const vec length = root_of(squares);
    const mask good = TRUTH(length > 0.0);
    for (int i = 0; i < n; i++)
        v[i] = pick(good, v[i] / length, every(i == 0 ? 1.0 : 0.0));
}

/* Are all eigenvalues above l?  They are if the leading minors of d - l are positive. */
INLINE mask sym_is_above(int n, const vec d[], vec l)
{
    vec e[MOST_ENTRIES], a[MOST_ENTRIES];

    sym_less(n, e, d, l);
    mask above = TRUTH(d[0] > l) & TRUTH(sym_adjugate(n, a, e) > 0.0);
    if (n == 3)
        above &= TRUTH(a[5] > 0.0);
    return above;
}

/* r = m - 1/d; r may be m. */
INLINE void sym_subtract_inverse(int n, vec r[], const vec m[], const vec d[])
{
    vec a[MOST_ENTRIES];
    const vec inverse = 1.0 / sym_adjugate(n, a, d);

    for (int i = 0; i < n * (n + 1) / 2; i++)
        r[i] = m[i] - a[i] * inverse;
}

/* v = m / d */
INLINE void sym_solve(int n, vec v[], const vec d[], const vec m[])
{
    vec a[MOST_ENTRIES];
    const vec inverse = 1.0 / sym_adjugate(n, a, d);

    sym_times(n, v, a, m);
    for (int i = 0; i < n; i++)
        v[i] *= inverse;
}

#endif
