/* special.h - pi, sine and cosine to dp decimal places, for any dp and any argument
   (thesis, Appendix B, "special functions").  The square root is apm_sqrt. */
#ifndef CONVERSE_SPECIAL_H
#define CONVERSE_SPECIAL_H

#include "apm.h"

typedef struct {
    long dp;
    mpz_t half_pi;            /* floor(pi/2 2^half_pi_bits), or zero if not yet needed */
    mp_bitcnt_t half_pi_bits;
    mpz_t t, t2, term, sum[2];
} trig_t;

void trig_init(trig_t *trig, long dp);
void trig_clear(trig_t *trig);

/* The first dp decimals of pi: 0 < pi - r < 10^-dp. */
void apm_pi(apm_t r, long dp);

/* |s - sin x| <= 10^-dp and |c - cos x| <= 10^-dp with dp that of trig; both in [-1, 1]. */
void apm_sincos(apm_t s, apm_t c, const apm_t x, trig_t *trig);

#endif
