/* torus.h - the largest trace and the largest eigenvalue of beta over the whole torus. */
#ifndef CONVERSE_TORUS_H
#define CONVERSE_TORUS_H

#include "arith/interval.h"

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
enum { TORUS_PLACES = 12 };             /* More decimals would be below the bounds' excess. */

/* A wave of beta = 2I - sum of p sin(k.v + phase) k k'.  k are small integers; phase and p are any
   numbers of their intervals. */
typedef struct {
    double k[3]; /* zero beyond the angles */
    interval phase, p;
} torus_wave;

/* A bound from above of the largest trace, or eigenvalue, of beta over the torus and all amplitudes
   and phases of at most MOST_WAVES waves; infinite where doubles end.  It is within
   5e-7 + 10^-12 (1 + sum of |p|) of the truth, except on ridges: see torus.c. */
double torus_largest(int angles, int n, const torus_wave waves[], int which);

#endif
