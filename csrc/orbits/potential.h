/* potential.h - what Python is asked: of a potential that it knows, and whether to go on. */
#ifndef CONVERSE_POTENTIAL_H
#define CONVERSE_POTENTIAL_H

#include "converse.h"
#include "orbits.h"

/* Defined where Python meets C: all that is not NULL is filled in, or an error returned. */
int cv_python_potential(void *self, long m, const double *x, double *value, double *gradient,
                        double *hessian);

/* Does Python want an end?  Python defines this function, which looks for signals.  Every loop that
   may last calls it now and then, but not so often that the calls take time. */
int cv_python_interrupts(void);

#endif
