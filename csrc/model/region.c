/* region.c - the region of successors in radians. */
#include "model/patch.h"

/* x becomes x pi, truncated after dp places as pi is.  A bound of its error is added to half. */
void shift_to_radians(apm_t x, apm_t half, const apm_t pi, long dp)
{
    apm_t exact, ulp, off;

    apm_init(exact);
    apm_init(ulp);
    apm_init(off);
    apm_set_si(ulp, 1, -dp);
    apm_abs(off, x);
    apm_mul(off, off, ulp);                             /* pi < pi cut off + ulp */
    apm_add(half, half, off);
    apm_mul(exact, x, pi);
    apm_round(x, exact, dp, APM_TRUNC);
    if (apm_cmp(x, exact) != 0)
        apm_add(half, half, ulp);
    apm_clear(exact);
    apm_clear(ulp);
    apm_clear(off);
}

/* The search takes a pi that is truncated by much more than the errors of sines.  So the centres
   of prisms lie below the exact multiples of pi by more than these errors, and the sign of such a
   sine, on which the column rotor depends, does not depend on rounding.  The pi of 1989 was also
   short. */
void to_radians(apm_t centre, apm_t half, const apm_t pi, long dp)
{
    apm_t above;

    apm_init(above);
    apm_set_si(above, 1, -dp);
    apm_add(above, above, pi);
    apm_mul(half, half, above);
    shift_to_radians(centre, half, pi, dp);
    apm_round(half, half, dp, APM_UP);
    apm_clear(above);
}

/* Let c, s and h be centre, shifts and half-width.  A side c + sum of s t + h u, |t| <= 1, |u| <=
   1, has the errors of c, s and h.  Let err = h - (exact half) (truncated pi).  The errors of c
   and s together are at most err, as they are part of h, and the error of h is at most err.  So
   off = 2 err is enough. */
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
