/* patch.h - a patch of problems, as numbers: the potential, the range of its parameters, the
   region of x_1, and the starting point x*. */
#ifndef CONVERSE_PATCH_H
#define CONVERSE_PATCH_H

#include "arith/apm.h"
#include "converse.h"                   /* without a guard, as cffi reads it: only here */

enum { MOST_WAVES = 16, PARAMETERS = 3, ANGLES = 3 };

/* cv_problem as numbers; phases in radians, which may be off by 10^-39.  quarters: how many quarter
   turns a phase is exactly, 0 to 3, or -1. */
typedef struct {
    int n_angles, n_waves, n_parameters, k[MOST_WAVES][ANGLES], frame[ANGLES][ANGLES];
    int odd, symmetric, quarters[MOST_WAVES];
    apm_t phase[MOST_WAVES], amplitude[MOST_WAVES], part[MOST_WAVES][PARAMETERS];
    apm_t angle[ANGLES], half[ANGLES], shift[ANGLES][PARAMETERS], xstar[ANGLES];
} patch;

void patch_init(patch *p);
void patch_clear(patch *p);

/* Reads the problem that Python gives; x* is set elsewhere.  CV_OK; CV_ENUMBER or CV_EARGUMENT if
   it is not a problem. */
int patch_read(patch *p, const cv_problem *given);

int is_identity(const patch *p); /* Is the frame? */

/* Are these the thesis's waves, in its order and without phases, each with its own parameter, in
   the identity frame and without shifts? */
int is_of_thesis(const patch *p);

/* The amplitudes in doubles, where each parameter is t. */
void patch_amplitudes(const patch *p, double t, double to[MOST_WAVES]);

/* region.c.  Converts centre +- half from units of pi to radians; the result encloses the interval.
   pi is truncated after dp places, to which the results are rounded. */
void to_radians(apm_t centre, apm_t half, const apm_t pi, long dp);

/* Converts a shift, which is multiplied by t, |t| <= 1.  A bound of its error is added to half,
   which is in radians already. */
void shift_to_radians(apm_t shift, apm_t half, const apm_t pi, long dp);

/* Converts the region and its shifts.  The result encloses the region.  A centre or shift of x pi
   is off by at most (|x| + 1) 10^-dp.  half is larger than the exact half by at most the sum of
   (|x| + 1) 10^-dp over all numbers of its axis, itself among them. */
void region_to_radians(patch *p, const apm_t pi, long dp);

#endif
