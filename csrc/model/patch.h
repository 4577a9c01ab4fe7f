/* patch.h - a patch of problems, as numbers: the potential, the range of its parameters, the
   region of x_1, and the starting point x*. */
#ifndef CONVERSE_PATCH_H
#define CONVERSE_PATCH_H

#include "arith/apm.h"
#include "converse.h"                   /* which cffi reads, so it has no guard: only here */

enum { MOST_WAVES = 16, PARAMETERS = 3 };

/* cv_problem as numbers; phases in radians, which may be off by 10^-39. */
typedef struct {
    int n_waves, n_parameters, k[MOST_WAVES][2], frame[4], odd;
    apm_t phase[MOST_WAVES], amplitude[MOST_WAVES], part[MOST_WAVES][PARAMETERS];
    apm_t angle[2], half[2], shift[2][PARAMETERS], xstar[2];
    apm_t off[2];                       /* see region_to_radians */
} patch;

void patch_init(patch *p);
void patch_clear(patch *p);

/* Takes what Python gives, but for x*.  CV_OK; CV_ENUMBER or CV_EARGUMENT if it is no problem. */
int patch_read(patch *p, const cv_problem *given);

int is_identity(const int frame[4]);

/* Are these the thesis's waves, in its order and without phases, each with its own parameter? */
int thesis_parameters(const patch *p);

/* Does the region of x_1 move with the parameters? */
int has_shifts(const patch *p);

/* Does the exchange of the coordinates map the patch and the region of x_1 to themselves?  Of a
   region that moves nobody asks: 0. */
int patch_symmetric(const patch *p);

/* The amplitudes in doubles, in the middle or, at_end, where the parameters are 1. */
void patch_amplitudes(const patch *p, int at_end, double to[MOST_WAVES]);

/* region.c: centre +- half, in units of pi, becomes an interval in radians that encloses it.
   pi: cut off after dp places, to which the results are rounded. */
void to_radians(apm_t centre, apm_t half, const apm_t pi, long dp);

/* The same of a shift, which is multiplied by t, |t| <= 1: what it is off is added to half, which
   is in radians already. */
void shift_to_radians(apm_t shift, apm_t half, const apm_t pi, long dp);

/* Both, of the patch.  Not only the region is enclosed: a prism of it, as the radians have it,
   holds the prism that is meant if its sides are moved outwards by off. */
void region_to_radians(patch *p, const apm_t pi, long dp);

#endif
