/* loewner.h - the sharper criterion: prisms, in doubles with proved rounding. */
#ifndef CONVERSE_LOEWNER_H
#define CONVERSE_LOEWNER_H

#include <stddef.h>
#include <stdint.h>

#include "search/method.h"

typedef struct loewner loewner;

enum { SLOTS = MOST_WAVES + ANGLES };

/* The most points of an orbit.  The standard map needs 85,237 for k = 0.97165. */
enum { MAX_POINTS = 1 << 17 };

/* For a problem whose angles are also in radians, and whose x* is chosen.  longest: the most
   points of an orbit, at most MAX_POINTS.  NULL: no memory. */
loewner *loewner_new(const patch *problem, int longest);
/* The same problem, with room of its own to try prisms in.  NULL: no memory. */
loewner *loewner_copy(const loewner *w);
void loewner_free(loewner *w);

/* Bounds B over the torus, for all parameters.  Before this call B is infinite, and no prism can
   be proved. */
void loewner_bound_torus(loewner *w);

/* Is the least eigenvalue of beta below 2/3 at x, for all parameters or, at_end, where they are all
   1?  Then, if V is odd, no multiple s >= 1 of these amplitudes allows a torus. */
int loewner_at_once(const loewner *w, const double x[ANGLES], int at_end);

/* The upper bound of the largest eigenvalue over the torus that belongs to the whole root. */
double loewner_largest(const loewner *w);

/* The prism of a cell.  x_1 = x1 + frame (width e + shift e), with the symbols e of the angles and
   of the parameters.  The amplitude of a wave is force 2^(coarse - 64) turns at the centre, and
   part e, to within err_amp.  p is the amplitude at the centre with a relative error of 3 u, and
   p + p_low of 2^-100.  0: it is too thin for doubles, or its parameters are too large. */
typedef struct {
    uint64_t x1[ANGLES];                /* turns.h */
    int64_t force[SLOTS];
    double width[ANGLES], shift[ANGLES][PARAMETERS];
    double p[SLOTS], p_low[SLOTS], part[SLOTS][PARAMETERS], err_amp[SLOTS], l;
} loewner_cell;
int loewner_prism(const loewner *w, const cv_cell *cell, loewner_cell *c);

#endif
