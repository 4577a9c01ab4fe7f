/* stationary.h - stationary points of functions on the torus, by Newton's method in plain double
   precision.  Searches begin there; any starting point is allowed, and no bound depends on
   it. */
#ifndef CONVERSE_STATIONARY_H
#define CONVERSE_STATIONARY_H

/* V(y) = -sum of p[j] sin(k[j].y + phase[j]), phases in radians. */
typedef struct {
    int angles, n;
    const int (*k)[3];
    const double *phase, *p;
} waves;

/* A function of two angles at x, with its gradient g and Hessian h (00, 01, 11). */
typedef double objective(const waves *v, const double x[2], double g[2], double h[3]);

objective value_of_potential;           /* V */
objective least_eigenvalue_of_beta;     /* of 2 - V'' */

/* Newton's method from x, jumps bounded; returns the value reached, or HUGE_VAL. */
double newton(objective *f, const waves *v, double x[2]);

#endif
