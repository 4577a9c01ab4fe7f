/* start.h - the points that the sharper method begins with.  Any are allowed: no bound depends on
   them. */
#ifndef CONVERSE_START_H
#define CONVERSE_START_H

#include "model/patch.h"
#include "model/stationary.h"

/* x = a point from which the proof is short, for waves in the middle of their parameters and the
   weakest waves.  On the diagonal if V is symmetric about it, so that mirror images can be skipped,
   unless longer orbits judge another point to be better. */
void loewner_start(const waves *middle, const waves *weakest, int on_diagonal, double x[ANGLES]);

/* x = where the least eigenvalue of beta is least. */
void loewner_lowest(const waves *v, double x[ANGLES]);

#endif
