/* torus.h - the largest trace and the largest eigenvalue of beta over the whole torus. */
#ifndef CONVERSE_TORUS_H
#define CONVERSE_TORUS_H

#include <math.h>

/* The greatest common divisor of two small integers that are not negative. */
static inline double divisor(double a, double b)
{
    while (b != 0.0) {
        const double rest = a - b * floor(a / b);
        a = b;
        b = rest;
    }
    return a;
}

enum { TORUS_TRACE, TORUS_EIGENVALUE };
enum { TORUS_PLACES = 12 };            /* decimals to which it makes sense to round them */

/* What the ends of ranges may be off by, added up with the squares |k|^2 of their waves. */
#define TORUS_ENDS 0x1p-42

/* A bound from above of the largest trace, or eigenvalue, of beta over the torus and over all
   parameters a, b, c of the ranges; inf or NaN where doubles end.  It is within 5e-7 + 10^-12 (2 + 2 (|a| + |b| + |c|)) of the truth, but on ridges:
   see torus.c. */
double torus_largest(const double low[3], const double high[3], int which);

/* A bound from above of the largest eigenvalue of beta = 2I - sum p[i] sin(k[i].v + phase[i]) k k' over
   the torus, for any n waves; phases may be off by 9 u of themselves. */
double torus_waves(int n, const double k[][2], const double phase[], const double p[]);

/* For tests: the same over the rectangle centre +- half alone, of beta at -v, but for roundings. */
double torus_rectangle(const double low[3], const double high[3], const double centre[2],
                       const double half[2], int which);

#endif
