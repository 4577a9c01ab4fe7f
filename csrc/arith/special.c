/* special.c - see special.h.

   All work is done with integers that stand for multiples of an ulp, 2^-w.  The error of a sine
   has the three parts of the thesis's equation for reducedSin: the errors of the reduced argument
   and of truncated intermediate results, and the rest of the Taylor series.  Unlike the
   thesis we halve the reduced argument before the series, and double the angle after it.

   MPFR has these functions, but guard.c leaves a computation by longjmp when memory runs out, and
   MPFR's cache of pi does not bear that.  With MPFR 4.2.0 the next call of mpfr_const_pi, for 100
   bits, returned 3.1415926535897932384626433832793333, wrong in the 31st decimal. */
#include "special.h"
#include "guard.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* r += scale * arctan(1/n) in ulps of 2^-w, n >= 5, |scale| <= 16; off by less than 2w ulps.
   Every quotient is truncated: a power is short by less than 1/(1 - 1/25) < 2 ulps, a term by less
   than 2.  The series alternates and decreases, so what is left out is below the first power that
   came out zero, which is below 2; and there are fewer than w - 1 terms. */
static void add_arctan(mpz_t r, unsigned long n, long scale, mp_bitcnt_t w)
{
    mpz_t power, term;

    assert(n >= 5 && labs(scale) <= 16);
    mpz_inits(power, term, NULL);
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
    mpz_clears(power, term, NULL);
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
    mpz_inits(lower, upper, scale, NULL);
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
    mpz_clears(lower, upper, scale, NULL);
}

/* How often an angle is halved, h >= 2, and how many terms of the series are then needed.  The
   angle is then below 2^-h, its square z below 4^-h, and what n terms leave out less than
   z^(n+1) / (2n+2)!, which is at most 2^-(w+2h) if 2hn + log2 (2n+2)! >= w. */
static void plan(trig_t *trig)
{
    const mp_bitcnt_t w = trig->w;
    mp_bitcnt_t bits = 1;               /* 2hn + log2 (2n+2)!, each factor rounded down */
    int e;

    trig->halvings = 1 + (mp_bitcnt_t)(sqrt((double)w) / 5.0);
    assert(trig->halvings >= 2);
    for (trig->terms = 0; bits < w; trig->terms++) {
        const double n = (double)trig->terms;
        frexp((2.0 * n + 3.0) * (2.0 * n + 4.0), &e);
        bits += 2 * trig->halvings + (mp_bitcnt_t)(e - 1);
    }
    trig->row = (unsigned long)ceil(sqrt((double)trig->terms));
    if (trig->row > TRIG_ROW)
        trig->row = TRIG_ROW;
}

void trig_init(trig_t *trig, long dp)
{
    /* dp + 1 decimals and at least 27 bits: the errors counted in apm_sincos come to less than
       4.5 (5 + halvings) + 6 ulps, for a million decimals to 2^11, and so to far less than
       10^-(dp+1); rounding adds 10^-dp / 2. */
    trig->dp = dp;
    trig->w = (mp_bitcnt_t)(dp + 1) * 3322 / 1000 + 28;
    trig->half_pi_bits = 0;
    trig->turn_bits = 0;
    trig->turn_exp = 0;
    plan(trig);
    mpz_inits(trig->half_pi, trig->turn, trig->one, trig->half, trig->t, trig->v, trig->term, NULL);
    for (unsigned long j = 0; j <= TRIG_ROW; j++)
        mpz_init(trig->power[j]);
    mpz_ui_pow_ui(trig->one, 10UL, (unsigned long)dp);
    mpz_setbit(trig->half, trig->w - 1);
}

void trig_clear(trig_t *trig)
{
    mpz_clears(trig->half_pi, trig->turn, trig->one, trig->half, trig->t, trig->v, trig->term,
               NULL);
    for (unsigned long j = 0; j <= TRIG_ROW; j++)
        mpz_clear(trig->power[j]);
}

/* turn = 10^exp in quarter turns, in units of 2^-turn_bits, turn_bits >= bits.  It is off by less
   than one unit, as the quotient is cut off, and by a relative error below 1.3 2^-half_pi_bits:
   pi/2 2^half_pi_bits lies between half_pi - 1 and half_pi + 2. */
static void set_turn(trig_t *trig, long exp, mp_bitcnt_t bits)
{
    mpz_t scale;

    if (trig->turn_exp == exp && trig->turn_bits >= bits && trig->turn_bits <= 2 * bits)
        return;
    bits += GMP_NUMB_BITS;                              /* the next one may be a little longer */
    mpz_init(scale);
    mpz_ui_pow_ui(scale, 10UL, (unsigned long)(exp < 0 ? -exp : exp));
    mpz_set_ui(trig->turn, 0UL);
    mpz_setbit(trig->turn, bits + trig->half_pi_bits);
    if (exp < 0)
        mpz_mul(scale, scale, trig->half_pi);
    else
        mpz_mul(trig->turn, trig->turn, scale);
    mpz_fdiv_q(trig->turn, trig->turn, exp < 0 ? scale : trig->half_pi);
    mpz_clear(scale);
    trig->turn_exp = exp;
    trig->turn_bits = bits;
}

/* v = 1 - cos y, y = t / 2^r, t = trig->t, in units of 2^-b, b = w + j + 2r, where t < 2^-j and
   j + r >= halvings.  Promise: off by less than 5 units, and not negative.

   With z = y^2 this is z/2! - z^2/4! + ..., by Smith's method: powers up to z^row are taken once,
   `row` terms are then words times powers, and one product with z^row leads to the next `row`
   terms.  When step k begins, v/c is the sum of +-z^(i-l) (2k)!/(2i)! over i > k, first +, where
   l is the multiple of row that began the terms after k: less than z, and z < 4^-2.

   A power is a truncated product of two: if these are short by less than 2 units, it is short by
   less than 2/16 + 2/16 + 1 < 2.  If v/c is off by e units, the product with z^row is off by less
   than e/16 + 2/16 + 1 and a little; the power adds less than 2 and a division by c less than 1;
   and then 2k (2k - 1) divides, which is at least 12 except for k = 1.  So e < 1/2 until k = 1, and
   then e < (1.3 + 2 + 1)/2, and the last division makes it less than 3.2.

   Less than a unit is left out: if j <= halvings, then b <= w + 2 halvings, which is what plan
   takes; and if not, z < 4^-j, each term gains on that by 4^(j - halvings), and b only by
   2^(j - halvings).  As the truth is not negative, |v| is as near to it as v. */
static void versine(trig_t *trig, mp_bitcnt_t j, mp_bitcnt_t b)
{
    mpz_t *const z = trig->power;
    unsigned long c = 1;

    assert(mpz_sizeinbase(trig->t, 2) <= trig->w - j);
    assert(2 * j + (b - trig->w - j) >= 2 * trig->halvings);
    mpz_mul(z[1], trig->t, trig->t);
    mpz_tdiv_q_2exp(z[1], z[1], trig->w - j);
    for (unsigned long i = 2; i <= trig->row; i++) {
        guard_poll();
        mpz_mul(z[i], z[i / 2], z[i - i / 2]);
        mpz_tdiv_q_2exp(z[i], z[i], b);
    }
    mpz_set_ui(trig->v, 0UL);
    for (unsigned long k = trig->terms; k > 0; k--) {
        const unsigned long d = 2 * k * (2 * k - 1);
        guard_poll();
        if (k % trig->row == 0 && k != trig->terms) {
            mpz_mul(trig->v, trig->v, z[trig->row]);
            mpz_tdiv_q_2exp(trig->v, trig->v, b);
        }
        mpz_neg(trig->v, trig->v);
        mpz_addmul_ui(trig->v, z[(k - 1) % trig->row + 1], c);
        if (c > ULONG_MAX / d) {
            mpz_tdiv_q_ui(trig->v, trig->v, c);
            c = 1;
        }
        c *= d;
    }
    mpz_tdiv_q_ui(trig->v, trig->v, c);
    mpz_abs(trig->v, trig->v);
}

/* r = +-x 2^-w to the nearest multiple of 10^-dp; x is at least 0 and at most 2^w. */
static void to_decimal(apm_t r, const mpz_t x, int negative, const trig_t *trig)
{
    assert(mpz_sgn(x) >= 0 && mpz_sizeinbase(x, 2) <= trig->w + 1);
    mpz_mul(r->mant, x, trig->one);
    mpz_add(r->mant, r->mant, trig->half);
    mpz_tdiv_q_2exp(r->mant, r->mant, trig->w);
    if (negative)
        mpz_neg(r->mant, r->mant);
    r->exp = -trig->dp;
}

/* trig->t = x less the nearest quarter turn, in radians, without its sign (negative), in ulps: off
   by less than 4, and below 0.8.  Returns the number of quarter turns, modulo 4. */
static int reduced(trig_t *trig, const apm_t x, int *negative)
{
    const mp_bitcnt_t w = trig->w;
    const long order = apm_order(x);
    const mp_bitcnt_t big = order > 0 ? (mp_bitcnt_t)order * 3322 / 1000 + 2 : 0;
    int quadrant;

    if (trig->half_pi_bits < w + big + 2) {
        trig->half_pi_bits = 0;                         /* not whole, if a poll ends this */
        trig->turn_bits = 0;
        fixed_pi(trig->half_pi, w + big + 64);
        trig->half_pi_bits = w + big + 65;
    }

    /* t = x in quarter turns, in ulps: off by less than 1.6.  Of turn's two errors the first, times
       the mantissa, is less than 1/4 ulp; the second, since |x| 2/pi < 2^big, less than 1/3; and
       the shift takes less than 1. */
    set_turn(trig, x->exp, w + mpz_sizeinbase(x->mant, 2) + 2);
    assert(trig->turn_bits >= w);
    mpz_mul(trig->t, x->mant, trig->turn);
    mpz_fdiv_q_2exp(trig->t, trig->t, trig->turn_bits - w);

    /* In radians: off by less than 1.6 pi/2 + 1 ulps and what half_pi is off, less than 4. */
    mpz_add(trig->t, trig->t, trig->half);
    quadrant = mpz_tstbit(trig->t, w) + 2 * mpz_tstbit(trig->t, w + 1);
    mpz_fdiv_r_2exp(trig->t, trig->t, w);
    mpz_sub(trig->t, trig->t, trig->half);
    *negative = mpz_sgn(trig->t) < 0;
    mpz_abs(trig->t, trig->t);
    mpz_mul(trig->t, trig->t, trig->half_pi);
    mpz_tdiv_q_2exp(trig->t, trig->t, trig->half_pi_bits);
    assert(mpz_sizeinbase(trig->t, 2) <= w);
    return quadrant;
}

void apm_sincos(apm_t s, apm_t c, const apm_t x, trig_t *trig)
{
    const mp_bitcnt_t w = trig->w;
    int negative;
    const int quadrant = reduced(trig, x, &negative);
    mp_bitcnt_t j, r, b;

    /* v = 1 - cos t, from t / 2^r.  If v = 1 - cos y then 1 - cos 2y = 4v - 2v^2: in units of 2^-b
       before and of 2^-(b-2) after, v becomes v - v^2/2^(b+1).  In these units an error does not
       grow, as 0 <= v <= 1, but by less than 1 for the shift.  In the end b = w + j, and v is off
       by less than 5 + r units. */
    j = w - mpz_sizeinbase(trig->t, 2);
    r = j < trig->halvings ? trig->halvings - j : 0;
    b = w + j + 2 * r;
    versine(trig, j, b);
    for (; b > w + j; b -= 2) {
        guard_poll();
        mpz_mul(trig->term, trig->v, trig->v);
        mpz_tdiv_q_2exp(trig->term, trig->term, b + 1);
        mpz_sub(trig->v, trig->v, trig->term);
    }

    /* sin t = sqrt(v (2 - v)).  This square is off by less than 2 (5 + r) units and t >= 2^-(j+1),
       so sin t > 0.89 2^-(j+1), and the root is off by less than 2 (5 + r) 2^-b / sin t, that is
       by less than 4.5 (5 + r) ulps; for t = 0 all is zero.  Root and shift are floors, less than
       1 ulp each; the root is at most 1.  And cos t = 1 - v is off by less than 6 + r ulps. */
    mpz_set_ui(trig->term, 0UL);
    mpz_setbit(trig->term, b + 1);
    mpz_sub(trig->term, trig->term, trig->v);
    mpz_mul(trig->term, trig->term, trig->v);
    mpz_sqrt(trig->term, trig->term);
    mpz_tdiv_q_2exp(trig->term, trig->term, j);
    mpz_tdiv_q_2exp(trig->v, trig->v, j);
    mpz_mul_2exp(trig->t, trig->half, 1);
    mpz_sub(trig->v, trig->t, trig->v);

    /* sin(t + q pi/2) and cos(t + q pi/2) for q = 0, 1, 2, 3 mod 4 */
    to_decimal(s, quadrant % 2 == 0 ? trig->term : trig->v,
               quadrant % 2 == 0 ? negative != (quadrant == 2) : quadrant == 3, trig);
    to_decimal(c, quadrant % 2 == 0 ? trig->v : trig->term,
               quadrant % 2 == 0 ? quadrant == 2 : negative != (quadrant == 1), trig);
}
