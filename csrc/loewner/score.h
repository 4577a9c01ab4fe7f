/* score.h - how much the orbits through a point leave of positive definiteness: plain double
   precision. */
#ifndef CONVERSE_SCORE_H
#define CONVERSE_SCORE_H

#include "arith/sym.h"
#include "model/patch.h"
#include "model/stationary.h"

enum { GUESSES = 8 };
enum { FINEST_STEP = 1, FINE_STEP = 2, COARSE_STEP = 4, OFFSETS = 96 }; /* per turn: see orbits */
enum { NEAR_REACH = 4, FAR_REACH = 6 };

/* The orbits through x* of waves scale v.  Their points next to x* are middle + offset and middle -
   offset, the offsets being multiples of step / OFFSETS turns in each angle.  Time may run either
   way, so half of these offsets are all. */
typedef struct {
    const waves *v;
    int reach, step;                    /* reach: points of an orbit on each side of x* */
    double scale, l;                    /* l: see least_slope in converse/prover/links.py */
    double xstar[ANGLES], middle[ANGLES], beta[MOST_ENTRIES];
    double guess[GUESSES][ANGLES]; /* offsets whose orbits left most, the latest first */
} orbits;

/* The value of a function at x if it is less than `enough`; otherwise any number that is not. */
typedef double function(void *context, const double x[ANGLES], double enough);

/* The largest score of an orbit through x.  All points of the orbit but x are eliminated from its
   second variation.  The score is the least eigenvalue of the form at x that is left; -HUGE_VAL
   where a point that was eliminated contradicts minimality. */
function score; /* the context is orbits */

/* Gains of less than this may be rounding. */
static const double GAIN_MIN = 1e-6;

typedef enum { DIAGONAL, ANYWHERE } ways; /* of one angle they are the same */

/* Moves x, of so many angles, where f has this value, to places where f is smaller by GAIN_MIN or
   more, in steps that are halved HALVINGS times.  Returns the value there. */
double descend(function *f, void *context, int angles, double x[ANGLES], double value, double step,
               ways where);

#endif
