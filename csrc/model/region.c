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

/* The truncated pi and the truncated product make a number x off by |x| ulp and by one ulp, and
   half contains the errors of the others. */
void region_to_radians(patch *p, const apm_t pi, long dp)
{
    for (int j = 0; j < p->n_angles; j++) {
        to_radians(p->angle[j], p->half[j], pi, dp);
        for (int m = 0; m < PARAMETERS; m++)
            shift_to_radians(p->shift[j][m], p->half[j], pi, dp);
    }
}
