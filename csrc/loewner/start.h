/* start.h - the points that the sharper method begins with.  Any are allowed: no bound depends on
   them. */
#ifndef CONVERSE_START_H
#define CONVERSE_START_H

#include "model/stationary.h"

/* x = a point from which the proof is short.  On the diagonal if V is symmetric about it, so that
   mirror images can be skipped, unless another point is plainly better. */
void loewner_start(const waves *v, int on_diagonal, double x[2]);

/* x = where the least eigenvalue of beta is least. */
void loewner_lowest(const waves *v, double x[2]);

#endif
