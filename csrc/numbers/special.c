/* special.c - see special.h.

   All work is done with integers that stand for multiples of an ulp, 2^-w.  The error of a sine
   has the three parts of the thesis's equation for reducedSin: that of the reduced argument,
   that of the truncated intermediate results, and the rest of the Taylor series. */
#include "special.h"
#include "guard.h"

/* r += scale * arctan(1/n) in ulps of 2^-w, n >= 5, |scale| <= 16; off by less than 2w ulps.
   Every quotient is truncated: a power is short by less than 1/(1 - 1/25) < 2 ulps, a term by less
   than 2.  The series alternates and decreases, so what is left out is below the first power that
   came out zero, which is below 2; and there are fewer than w - 1 terms. */
static void add_arctan(mpz_t r, unsigned long n, long scale, mp_bitcnt_t w)
{
    mpz_t power, term;
    mpz_init(power);
    mpz_init(term);
    mpz_set_si(power, scale);
    mpz_mul_2exp(power, power, w);
    mpz_tdiv_q_ui(power, power, n);
    for (unsigned long k = 1; mpz_sgn(power) != 0; k += 2) {
        guard_poll();
        mpz_tdiv_q_ui(term, power, k);
        if (k % 4 == 1)
            mpz_add(r, r, term);
        else
            mpz_sub(r, r, term);
        mpz_tdiv_q_ui(power, power, n * n);
    }
    mpz_clear(power);
    mpz_clear(term);
}

/* r - 1 < pi 2^bits < r + 2, by Machin's formula pi = 16 arctan(1/5) - 4 arctan(1/239).  The sum
   is off by less than 4 (bits + 64) ulps of 2^-64, less than 1 by far; then it is cut off, which
   takes less than 1 away. */
static void fixed_pi(mpz_t r, mp_bitcnt_t bits)
{
    mpz_set_ui(r, 0UL);
    add_arctan(r, 5UL, 16L, bits + 64);
    add_arctan(r, 239UL, -4L, bits + 64);
    mpz_fdiv_q_2exp(r, r, 64);
}

void apm_pi(apm_t r, long dp)
{
    mp_bitcnt_t bits = (mp_bitcnt_t)(dp > 0 ? dp : 0) * 10 / 3 + 16;
    int settled = 0;
    mpz_t lower, upper, scale;

    if (dp < 0)
        dp = 0;
    mpz_init(lower);
    mpz_init(upper);
    mpz_init(scale);
    mpz_ui_pow_ui(scale, 10UL, (unsigned long)dp);
    while (!settled) {                      /* until both ends have the same dp decimals */
        bits += 32;
        fixed_pi(lower, bits);
        mpz_add_ui(upper, lower, 2UL);
        mpz_sub_ui(lower, lower, 1UL);
        mpz_mul(lower, lower, scale);
        mpz_mul(upper, upper, scale);
        mpz_fdiv_q_2exp(lower, lower, bits);
        mpz_fdiv_q_2exp(upper, upper, bits);
        settled = mpz_cmp(lower, upper) == 0;
    }
    mpz_swap(r->mant, lower);
    r->exp = -dp;
    mpz_clear(lower);
    mpz_clear(upper);
    mpz_clear(scale);
}

void trig_init(trig_t *trig, long dp)
{
    trig->dp = dp;
    trig->half_pi_bits = 0;
    mpz_init(trig->half_pi);
    mpz_init(trig->t);
    mpz_init(trig->t2);
    mpz_init(trig->term);
    mpz_init(trig->sum[0]);
    mpz_init(trig->sum[1]);
}

void trig_clear(trig_t *trig)
{
    mpz_clear(trig->half_pi);
    mpz_clear(trig->t);
    mpz_clear(trig->t2);
    mpz_clear(trig->term);
    mpz_clear(trig->sum[0]);
    mpz_clear(trig->sum[1]);
}

/* sum = the Taylor series of cos t (odd = 0) or sin t (odd = 1), in ulps.
   Promise: off by at most 2N + 2 ulps, N < w the number of terms, for 0 <= t <= 0.8.
   A term is the one before, T <= 1, times t2 (short of t^2 by less than an ulp), shifted, over
   d, truncated twice.  If T was short by e ulps, the new term is short by less than
   (e t^2 + T + 1)/d + 1 ulps.  The first term is exact, e = 0, so the second is short by less than
   (0 + 1 + 1)/2 + 1 = 2; from then on e <= 2 and d >= 6, and (1.28 + 1 + 1)/6 + 1 < 2.  The series
   alternates and decreases, so what is left out is below the first term that came out zero, which
   is below 2 ulps. */
static void taylor(mpz_t sum, mpz_t term, const mpz_t t, const mpz_t t2, mp_bitcnt_t w, int odd)
{
    if (odd) {
        mpz_set(term, t);
    } else {
        mpz_set_ui(term, 1UL);
        mpz_mul_2exp(term, term, w);
    }
    mpz_set(sum, term);
    for (unsigned long n = 1; mpz_sgn(term) != 0; n++) {
        const unsigned long k = odd ? 2 * n : 2 * n - 1;
        guard_poll();
        mpz_mul(term, term, t2);
        mpz_tdiv_q_2exp(term, term, w);
        mpz_tdiv_q_ui(term, term, k * (k + 1));
        if (n % 2 == 1)
            mpz_sub(sum, sum, term);
        else
            mpz_add(sum, sum, term);
    }
}

/* r = +-sum to the nearest multiple of 10^-dp, and not beyond 1. */
static void to_decimal(apm_t r, const mpz_t sum, int negative, long dp, mp_bitcnt_t w)
{
    mpz_t one;
    mpz_init(one);
    mpz_ui_pow_ui(one, 10UL, (unsigned long)dp);
    mpz_mul(r->mant, sum, one);
    mpz_tdiv_q_2exp(r->mant, r->mant, w - 1);
    mpz_add_ui(r->mant, r->mant, 1UL);
    mpz_fdiv_q_2exp(r->mant, r->mant, 1);
    if (mpz_cmp(r->mant, one) > 0)
        mpz_set(r->mant, one);
    if (negative)
        mpz_neg(r->mant, r->mant);
    r->exp = -dp;
    mpz_clear(one);
}

void apm_sincos(apm_t s, apm_t c, const apm_t x, trig_t *trig)
{
    /* dp + 1 decimals and at least 26 guard bits: the errors counted below come to at most 2N + 5
       ulps with N < w < 2^24, that is to less than 10^-(dp+1), and rounding adds 10^-dp / 2. */
    const mp_bitcnt_t w = (mp_bitcnt_t)(trig->dp + 1) * 3322 / 1000 + 28;
    const long order = apm_order(x);
    const mp_bitcnt_t big = order > 0 ? (mp_bitcnt_t)order * 3322 / 1000 + 2 : 0;
    unsigned long quadrant;
    int negative;
    mpz_t q;

    if (trig->half_pi_bits < w + big) {
        fixed_pi(trig->half_pi, w + big + 64);
        trig->half_pi_bits = w + big + 65;
    }

    /* t = x in ulps, short by less than one */
    mpz_init(q);
    mpz_mul_2exp(trig->t, x->mant, w);
    mpz_ui_pow_ui(q, 10UL, (unsigned long)(x->exp < 0 ? -x->exp : x->exp));
    if (x->exp < 0)
        mpz_fdiv_q(trig->t, trig->t, q);
    else
        mpz_mul(trig->t, trig->t, q);

    /* t -= q pi/2 with q = round(t / (pi/2)): |t| <= pi/4 + 3 ulps < 0.8.  |q| < 2^(big-1) and
       pi/2 is known to 2 2^-(w+big), so q pi/2 is off by less than an ulp; the shift adds
       another. */
    mpz_mul_2exp(q, trig->t, trig->half_pi_bits - w + 1);
    mpz_add(q, q, trig->half_pi);
    mpz_mul_2exp(trig->t2, trig->half_pi, 1);
    mpz_fdiv_q(q, q, trig->t2);
    quadrant = mpz_fdiv_ui(q, 4UL);
    mpz_mul(q, q, trig->half_pi);
    mpz_fdiv_q_2exp(q, q, trig->half_pi_bits - w);
    mpz_sub(trig->t, trig->t, q);
    mpz_clear(q);
    negative = mpz_sgn(trig->t) < 0;
    mpz_abs(trig->t, trig->t);

    mpz_mul(trig->t2, trig->t, trig->t);
    mpz_tdiv_q_2exp(trig->t2, trig->t2, w);
    taylor(trig->sum[0], trig->term, trig->t, trig->t2, w, 0);
    taylor(trig->sum[1], trig->term, trig->t, trig->t2, w, 1);

    /* sin(t + q pi/2) and cos(t + q pi/2) for q = 0, 1, 2, 3 mod 4 */
    to_decimal(s, trig->sum[quadrant % 2 == 0],
               quadrant % 2 == 0 ? negative != (quadrant == 2) : quadrant == 3, trig->dp, w);
    to_decimal(c, trig->sum[quadrant % 2],
               quadrant % 2 == 0 ? quadrant == 2 : negative != (quadrant == 1), trig->dp, w);
}
