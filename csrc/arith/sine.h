/* sine.h - sine and cosine in double precision, with a proved error, of each lane.

   Only additions, multiplications and bit patterns of doubles that are rounded to nearest: the
   same bits on every machine, and no libm. */
#ifndef CONVERSE_SINE_H
#define CONVERSE_SINE_H

#include "lanes.h"

#define SINE_ERROR 0x1p-51
#define SINE_LIMIT 1.5e6                /* beyond it the results are NaN */

/* |s - sin x| <= SINE_ERROR and |c - cos x| <= SINE_ERROR for |x| <= SINE_LIMIT.

   n = the integer next to 2x/pi, r = x - n pi/2 with |r| < 0.7854; u = 2^-53.
   pi/2 is the sum of three doubles to within 1e-31, the first two of 33 bits, so n times either is
   exact (|n| < 2^20) and so is the first difference (Sterbenz); the other two are rounded:
   |r| is off by less than 1.6 u.
   The polynomials are Taylor's; what is left out is below (pi/4)^19/19! < 1e-19.
   sin: r^3 p(r^2) is at most 0.081 and good to 10 u of that, the last sum rounds by u/2:
   together with r, 1.6 u + 0.81 u + 0.5 u < 3 u.
   cos: r^2/2 <= 0.31 loses u/2 of it, r^4 q(r^2) <= 0.016 loses 10 u of it, the sums u/2 of 0.31
   and of 1: together with r (times 0.71), 1.14 u + 0.16 u + 0.16 u + 0.16 u + 0.5 u < 3 u.
   That is by hand; formal/gappa.py has Gappa prove of these very lines that 1.9 u are enough. */
INLINE void double_sincos(vec *s, vec *c, vec x)
{
    static const double SHIFT = 0x1.8p52;
    const vec shifted = x * 0x1.45f306dc9c883p-1 + SHIFT, n = shifted - SHIFT;
    const vec r = ((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
    const vec z = r * r;
    /* clang-format off */
    const vec p = -1.0 / 6 + z * (1.0 / 120 + z * (-1.0 / 5040 + z * (1.0 / 362880
        + z * (-1.0 / 39916800 + z * (1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0
        + z * (1.0 / 355687428096000.0)))))));
    const vec q = 1.0 / 24 + z * (-1.0 / 720 + z * (1.0 / 40320 + z * (-1.0 / 3628800
        + z * (1.0 / 479001600 + z * (-1.0 / 87178291200.0 + z * (1.0 / 20922789888000.0
        + z * (-1.0 / 6402373705728000.0)))))));
    /* clang-format on */
    const vec sine = r + r * (z * p), cosine = 1.0 - (0.5 * z - z * (z * q));
    const mask bits = bits_of(shifted);                 /* its last two: the quadrant */
    const mask odd = TRUTH((bits & 1) == 1), bad = ~TRUTH(mag(x) <= SINE_LIMIT);

    *s = vec_of((bits_of(pick(odd, cosine, sine)) ^ (bits & 2) << 62) | bad);
    *c = vec_of((bits_of(pick(odd, sine, cosine)) ^ ((bits + 1) & 2) << 62) | bad);
}

#endif
