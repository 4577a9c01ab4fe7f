/* special.h - pi, sine and cosine to dp decimal places, for any dp and any argument
   (thesis, Appendix B, "special functions").  The square root is apm_sqrt. */
#ifndef CONVERSE_SPECIAL_H
#define CONVERSE_SPECIAL_H

#include "apm.h"

enum { TRIG_ROW = 32 };                 /* powers that are kept at most */

typedef struct {
    long dp;
    mp_bitcnt_t w;                      /* an ulp is 2^-w */
    mp_bitcnt_t halvings;               /* an angle is halved until it is below 2^-halvings */
    unsigned long terms, row;           /* of the series for it */
    mpz_t half_pi, turn;                /* pi/2, 2^-half_pi_bits; 10^turn_exp in quarter turns, */
    mp_bitcnt_t half_pi_bits, turn_bits;        /* 2^-turn_bits; bits = 0: not yet needed */
    long turn_exp;
    mpz_t one, half;                    /* 10^dp, 2^(w-1) */
    mpz_t t, v, term, power[TRIG_ROW + 1];
} trig_t;

void trig_init(trig_t *trig, long dp);
void trig_clear(trig_t *trig);

/* The first dp decimals of pi: 0 < pi - r < 10^-dp. */
void apm_pi(apm_t r, long dp);

/* |s - sin x| <= 10^-dp and |c - cos x| <= 10^-dp with dp that of trig; both in [-1, 1]. */
void apm_sincos(apm_t s, apm_t c, const apm_t x, trig_t *trig);

#endif
