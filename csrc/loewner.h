/* loewner.h - the sharper criterion: one prism, in doubles with proved rounding. */
#ifndef CONVERSE_LOEWNER_H
#define CONVERSE_LOEWNER_H

#include "converse.h"
#include "unit.h"

typedef struct loewner loewner;

/* For a root with its angles in radians and x* chosen.  quick: a double instance, for the bounds
   over the torus.  NULL: no memory. */
loewner *loewner_new(const box *root, int together, unit *quick);
void loewner_free(loewner *w);

/* Is it impossible that a minimizing orbit leads from x* to the cell?  If that is not proved,
   *axis is where to cut the cell, and *from what its halves should know: fewer points of the
   orbit than that will hardly do.  Reason CV_REASON_ARITHMETIC: it is the doubles that failed. */
void loewner_try(loewner *w, const cv_cell *cell, verdict *v, int *axis, int *from);

/* Is the least eigenvalue of beta below 2/3 at x, for all parameters (together: for those at
   the upper end)?  Then no multiple s >= 1 of these parameters allows a torus. */
int loewner_at_once(const loewner *w, const double x[2]);

/* The upper bound of the largest eigenvalue over the torus that belongs to the whole root. */
double loewner_largest(const loewner *w);

#endif
