/* loewner.h - the sharper criterion: one prism, in doubles with proved rounding. */
#ifndef CONVERSE_LOEWNER_H
#define CONVERSE_LOEWNER_H

#include <stddef.h>

#include "converse.h"
#include "thesis/unit.h"

typedef struct loewner loewner;

/* For a root with its angles in radians and x* chosen.  quick: a double instance, for the bounds
   over the torus, or NULL if nothing is to be proved.  NULL: no memory. */
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

/* For tests: the orbit of the root's prism from point s or 0 to point t or 1, and what is known of
   point s if t is 0, or else of t: x, the columns (x0's five, then x1's), the rest, the reach.
   0: it cannot be followed so far. */
typedef struct { double x[2], column[2][5], rest[2], reach[3]; } loewner_point;
int loewner_follow(loewner *w, int s, int t, loewner_point *p);

/* For tests: the bound of the second variation that loewner_follow's orbit gives, the l it was made
   with, and the vectors n from the first to the last site; their number, 0 without a witness. */
int loewner_bound(loewner *w, double *bound, double *l, int *first, double n[][2], int most);

#endif
