/* region.c - the region of successors in radians. */
#include "model/patch.h"

/* x pi, cut off after dp places as pi is.  off: a bound of what that is off. */
static void times_pi(apm_t x, apm_t off, const apm_t pi, const apm_t ulp, long dp)
{
    apm_t exact;

    apm_init(exact);
    apm_abs(off, x);
    apm_mul(off, off, ulp);                             /* pi < pi cut off + ulp */
    apm_mul(exact, x, pi);
    apm_round(x, exact, dp, APM_TRUNC);
    if (apm_cmp(x, exact) != 0)
        apm_add(off, off, ulp);
    apm_clear(exact);
}

/* An enclosure of the region meant, with pi cut off.  The search takes a pi that is cut off well
   before the errors of sines begin.  So the centres of prisms lie a little below the multiples of
   pi they stand for, by more than the errors of their sines, and what depends on the sign of such
   a sine (the column rotor) is no accident.  The pi of 1989 was short, too. */
void to_radians(apm_t centre, apm_t half, const apm_t pi, long dp)
{
    apm_t ulp, off, above;

    apm_init(ulp);
    apm_init(off);
    apm_init(above);
    apm_set_si(ulp, 1, -dp);
    times_pi(centre, off, pi, ulp, dp);
    apm_add(above, pi, ulp);
    apm_mul(half, half, above);
    apm_add(half, half, off);
    apm_round(half, half, dp, APM_UP);
    apm_clear(ulp);
    apm_clear(off);
    apm_clear(above);
}

void shift_to_radians(apm_t shift, apm_t half, const apm_t pi, long dp)
{
    apm_t ulp, off;

    apm_init(ulp);
    apm_init(off);
    apm_set_si(ulp, 1, -dp);
    times_pi(shift, off, pi, ulp, dp);
    apm_add(half, half, off);
    apm_clear(ulp);
    apm_clear(off);
}

/* Where c, s and h are centre, shifts and half-width, c + sum of s t + h u is off by what c and s
   are, and by what h is, as |t| <= 1 and |u| <= 1.  h is longer than the one meant by what c and s
   are off, or more; and pi is cut off.  So twice what it is longer than with that pi will do. */
void region_to_radians(patch *p, const apm_t pi, long dp)
{
    apm_t least;

    apm_init(least);
    for (int j = 0; j < 2; j++) {
        apm_mul(least, p->half[j], pi);
        to_radians(p->angle[j], p->half[j], pi, dp);
        for (int m = 0; m < PARAMETERS; m++)
            shift_to_radians(p->shift[j][m], p->half[j], pi, dp);
        apm_sub(p->off[j], p->half[j], least);
        apm_mul_si(p->off[j], p->off[j], 2);
    }
    apm_clear(least);
}
