/* potential.h - what is asked of a potential that Python knows. */
#ifndef CONVERSE_POTENTIAL_H
#define CONVERSE_POTENTIAL_H

#include "converse.h"
#include "orbits.h"

/* Defined where Python meets C: all that is not NULL is filled in, or an error returned. */
int cv_python_potential(void *self, long m, const double *x, double *value, double *gradient,
                        double *hessian);

#endif
