/* apm.c - see apm.h. */
#include "apm.h"
#include "guard.h"

#include <assert.h>
#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_DIGITS 19                    /* 10^19 is the largest power of ten in 64 bits */

/* clang-format off */
static const unsigned long power10[WORD_DIGITS + 1] = {
    1UL, 10UL, 100UL, 1000UL, 10000UL, 100000UL, 1000000UL, 10000000UL, 100000000UL,
    1000000000UL, 10000000000UL, 100000000000UL, 1000000000000UL, 10000000000000UL,
    100000000000000UL, 1000000000000000UL, 10000000000000000UL, 100000000000000000UL,
    1000000000000000000UL, 10000000000000000000UL
};
/* clang-format on */
_Static_assert(sizeof(unsigned long) == 8, "apm assumes 64-bit words");

/* r = x * 10^n, n >= 0.  Word by word for the short shifts that fill a proof, in one product
   for the long ones. */
static void shift_up(mpz_t r, const mpz_t x, long n)
{
    assert(n >= 0);
    if (n > 8 * WORD_DIGITS) {
        mpz_t p;
        mpz_init(p);
        mpz_ui_pow_ui(p, 10UL, (unsigned long)n);
        mpz_mul(r, x, p);
        mpz_clear(p);
        return;
    }
    if (n <= WORD_DIGITS) {
        mpz_mul_ui(r, x, power10[n]);
        return;
    }
    mpz_mul_ui(r, x, power10[WORD_DIGITS]);
    for (n -= WORD_DIGITS; n > WORD_DIGITS; n -= WORD_DIGITS)
        mpz_mul_ui(r, r, power10[WORD_DIGITS]);
    mpz_mul_ui(r, r, power10[n]);
}

/* Where the direction is towards zero, cutting off takes a quarter less: it needs no remainder. */
static void divide(mpz_t r, const mpz_t x, const mpz_t y, apm_round_t dir)
{
    const apm_round_t inward = (mpz_sgn(x) < 0) == (mpz_sgn(y) < 0) ? APM_DOWN : APM_UP;

    if (dir == APM_TRUNC || dir == inward)
        mpz_tdiv_q(r, x, y);
    else if (dir == APM_DOWN)
        mpz_fdiv_q(r, x, y);
    else
        mpz_cdiv_q(r, x, y);
}

static void divide_word(mpz_t r, const mpz_t x, unsigned long y, apm_round_t dir)
{
    if (dir == APM_DOWN)
        mpz_fdiv_q_ui(r, x, y);
    else if (dir == APM_UP)
        mpz_cdiv_q_ui(r, x, y);
    else
        mpz_tdiv_q_ui(r, x, y);
}

/* r = x / 10^n rounded, n >= 0.  Rounding word by word in one direction is the same as
   rounding once: floor(floor(x/p)/q) = floor(x/(pq)).  More than four words cost more than one
   division. */
static void shift_down(mpz_t r, const mpz_t x, long n, apm_round_t dir)
{
    assert(n >= 0);
    if (n > 4 * WORD_DIGITS) {
        mpz_t p;
        mpz_init(p);
        mpz_ui_pow_ui(p, 10UL, (unsigned long)n);
        divide(r, x, p, dir);
        mpz_clear(p);
        return;
    }
    if (n <= WORD_DIGITS) {
        divide_word(r, x, power10[n], dir);
        return;
    }
    divide_word(r, x, power10[WORD_DIGITS], dir);
    for (n -= WORD_DIGITS; n > WORD_DIGITS; n -= WORD_DIGITS)
        divide_word(r, r, power10[WORD_DIGITS], dir);
    divide_word(r, r, power10[n], dir);
}

void apm_init(apm_t x)
{
    mpz_init(x->mant);
    x->exp = 0;
}

void apm_clear(apm_t x) { mpz_clear(x->mant); }

void apm_set(apm_t r, const apm_t x)
{
    mpz_set(r->mant, x->mant);
    r->exp = x->exp;
}

void apm_set_si(apm_t r, long n, long exp)
{
    mpz_set_si(r->mant, n);
    r->exp = exp;
}

/* The text is looked at first, so that a number is either read whole or not at all. */
int apm_set_str(apm_t r, const char *text)
{
    const char *s = text + (*text == '+' || *text == '-');
    long digits = 0, places = 0, exp = 0;
    mpz_t mant;

    for (int seen_point = 0; isdigit((unsigned char)*s) || (*s == '.' && !seen_point); s++) {
        seen_point |= *s == '.';
        places += seen_point && *s != '.';
        digits += *s != '.';
    }
    const char *const end_of_digits = s;
    if (digits > 0 && (*s == 'e' || *s == 'E')) {
        const char *const e = s + 1 + (s[1] == '+' || s[1] == '-');
        if (isdigit((unsigned char)*e)) {
            char *end;
            exp = strtol(s + 1, &end, 10);  /* saturates, and is then out of range */
            s = end;
        }
    }
    if (digits == 0 || *s != '\0')
        return APM_ESYNTAX;
    if (exp > APM_MAX_EXP || exp < -APM_MAX_EXP || digits > APM_MAX_EXP)
        return APM_ERANGE;

    mpz_init(mant);
    for (s = text; s < end_of_digits; s++)
        if (isdigit((unsigned char)*s)) {
            mpz_mul_ui(mant, mant, 10UL);
            mpz_add_ui(mant, mant, (unsigned long)(*s - '0'));
        }
    if (*text == '-')
        mpz_neg(mant, mant);
    mpz_swap(r->mant, mant);
    mpz_clear(mant);
    r->exp = exp - places;
    return APM_OK;
}

int apm_set_d(apm_t r, double x)
{
    int e;
    const double m = ldexp(frexp(x, &e), 53);           /* an integer */

    if (!isfinite(x))
        return APM_ERANGE;
    e -= 53;
    mpz_set_d(r->mant, m);
    r->exp = 0;
    if (e >= 0) {
        mpz_mul_2exp(r->mant, r->mant, (mp_bitcnt_t)e);
    } else if (mpz_sgn(r->mant) != 0) {
        /* 2^-k = 5^k 10^-k; strip the twos first so that short binary fractions stay short */
        const mp_bitcnt_t twos = mpz_scan1(r->mant, 0);
        const mp_bitcnt_t k = (mp_bitcnt_t)-e;
        const mp_bitcnt_t strip = twos < k ? twos : k;
        mpz_t p;
        mpz_init(p);
        mpz_tdiv_q_2exp(r->mant, r->mant, strip);
        mpz_ui_pow_ui(p, 5UL, k - strip);
        mpz_mul(r->mant, r->mant, p);
        r->exp = -(long)(k - strip);
        mpz_clear(p);
    }
    return APM_OK;
}

double apm_get_d(const apm_t x)
{
    /* Bring the integer near 17 digits first, so that neither factor can overflow. */
    const long excess = (long)mpz_sizeinbase(x->mant, 10) - 20;
    double result;
    mpz_t m;

    if (mpz_sgn(x->mant) == 0)
        return 0.0;
    mpz_init(m);
    if (excess > 0)
        shift_down(m, x->mant, excess, APM_TRUNC);
    else
        mpz_set(m, x->mant);
    const long exp = x->exp + (excess > 0 ? excess : 0);
    /* A decimal string and strtod would round correctly and cost ten times as much. */
    if (exp < -330)
        result = 0.0;
    else if (exp > 310)
        result = mpz_sgn(m) * HUGE_VAL;
    else if (exp < -22)
        result = mpz_get_d(m) / pow(10.0, 22) * pow(10.0, (double)(exp + 22));
    else
        result = exp < 0 ? mpz_get_d(m) / pow(10.0, (double)-exp)
                         : mpz_get_d(m) * pow(10.0, (double)exp);
    mpz_clear(m);
    return result;
}

double apm_nearest_d(const apm_t x)
{
    const double d = apm_get_d(x);
    apm_t rest;
    double result;

    if (!isfinite(d))
        return d;
    apm_init(rest);
    apm_set_d(rest, d);
    apm_sub(rest, x, rest);
    result = d + apm_get_d(rest);
    apm_clear(rest);
    return result;
}

double apm_bound_d(const apm_t x, apm_round_t dir)
{
    const double end = dir == APM_UP ? HUGE_VAL : -HUGE_VAL;
    double d = apm_nearest_d(x);
    apm_t found;

    apm_init(found);
    for (;;) {
        if (apm_set_d(found, d) != APM_OK) {
            d = end;
            break;
        }
        const int c = apm_cmp(found, x);
        if (dir == APM_UP ? c >= 0 : c <= 0)
            break;
        d = nextafter(d, end);
    }
    apm_clear(found);
    return d;
}

typedef struct {
    char *text;
    mpz_srcptr mant;
} printed;

static void print_digits(void *data)
{
    const printed *const p = data;

    mpz_get_str(p->text, 10, p->mant);
}

char *apm_get_str(const apm_t x)
{
    const size_t digits = mpz_sizeinbase(x->mant, 10);
    char *text = malloc(digits + 32);
    printed p = { text, x->mant };

    if (text == NULL)
        return NULL;
    if (guard_run(print_digits, &p, NULL) != GUARD_DONE) {
        free(text);
        return NULL;
    }
    if (x->exp != 0 && mpz_sgn(x->mant) != 0)
        snprintf(text + strlen(text), 24, "e%ld", x->exp);
    return text;
}

void apm_swap(apm_t x, apm_t y)
{
    const long e = x->exp;
    mpz_swap(x->mant, y->mant);
    x->exp = y->exp;
    y->exp = e;
}

void apm_neg(apm_t r, const apm_t x)
{
    mpz_neg(r->mant, x->mant);
    r->exp = x->exp;
}

void apm_abs(apm_t r, const apm_t x)
{
    mpz_abs(r->mant, x->mant);
    r->exp = x->exp;
}

/* r = x + y or x - y, by bringing the operand of the larger exponent to the smaller one. */
static void add_or_sub(apm_t r, const apm_t x, const apm_t y, int subtract)
{
    if (x->exp == y->exp) {
        if (subtract)
            mpz_sub(r->mant, x->mant, y->mant);
        else
            mpz_add(r->mant, x->mant, y->mant);
        r->exp = x->exp;
    } else if (mpz_sgn(y->mant) == 0) {
        apm_set(r, x);
    } else if (mpz_sgn(x->mant) == 0) {
        if (subtract)
            apm_neg(r, y);
        else
            apm_set(r, y);
    } else {
        const int shift_x = x->exp > y->exp;
        const long exp = shift_x ? y->exp : x->exp;
        const int in_place = r != (shift_x ? y : x);    /* no temporary: saves an allocation */
        mpz_t temporary;
        const mpz_ptr t = in_place ? r->mant : temporary;
        mpz_init(temporary);
        if (shift_x)
            shift_up(t, x->mant, x->exp - exp);
        else
            shift_up(t, y->mant, y->exp - exp);
        const mpz_srcptr first = shift_x ? t : x->mant, second = shift_x ? y->mant : t;
        if (subtract)
            mpz_sub(r->mant, first, second);
        else
            mpz_add(r->mant, first, second);
        r->exp = exp;
        mpz_clear(temporary);
    }
}

void apm_add(apm_t r, const apm_t x, const apm_t y) { add_or_sub(r, x, y, 0); }
void apm_sub(apm_t r, const apm_t x, const apm_t y) { add_or_sub(r, x, y, 1); }

void apm_mul(apm_t r, const apm_t x, const apm_t y)
{
    const long exp = x->exp + y->exp;
    mpz_mul(r->mant, x->mant, y->mant);
    r->exp = exp;
}

void apm_mul_si(apm_t r, const apm_t x, long n)
{
    mpz_mul_si(r->mant, x->mant, n);
    r->exp = x->exp;
}

void apm_scale(apm_t r, const apm_t x, long places)
{
    apm_set(r, x);
    r->exp += places;
}

int apm_sgn(const apm_t x) { return mpz_sgn(x->mant); }

int apm_cmp(const apm_t x, const apm_t y)
{
    const int sx = mpz_sgn(x->mant), sy = mpz_sgn(y->mant);
    int c;

    if (sx != sy || sx == 0)
        return sx < sy ? -1 : sx > sy;
    if (x->exp == y->exp) {
        c = mpz_cmp(x->mant, y->mant);
    } else {
        mpz_t t;
        mpz_init(t);
        if (x->exp > y->exp) {
            shift_up(t, x->mant, x->exp - y->exp);
            c = mpz_cmp(t, y->mant);
        } else {
            shift_up(t, y->mant, y->exp - x->exp);
            c = mpz_cmp(x->mant, t);
        }
        mpz_clear(t);
    }
    return c < 0 ? -1 : c > 0;
}

int apm_div(apm_t r, const apm_t x, const apm_t y, long dp, apm_round_t dir)
{
    /* x/y = (X/Y) 10^(ex-ey), wanted as an integer times 10^-dp. */
    const long shift = x->exp - y->exp + dp;
    mpz_t t;

    if (mpz_sgn(y->mant) == 0)
        return APM_EDIVZERO;
    guard_poll();
    mpz_init(t);
    if (shift >= 0) {
        shift_up(t, x->mant, shift);
        divide(r->mant, t, y->mant, dir);
    } else {
        shift_up(t, y->mant, -shift);
        divide(r->mant, x->mant, t, dir);
    }
    r->exp = -dp;
    mpz_clear(t);
    return APM_OK;
}

int apm_sqrt(apm_t r, const apm_t x, long dp, apm_round_t dir)
{
    /* sqrt(X 10^e) 10^dp = sqrt(X 10^(e + 2 dp)); the integer square root is the floor of it. */
    const long shift = x->exp + 2 * dp;
    int exact = 1;
    mpz_t t, rest;

    if (mpz_sgn(x->mant) < 0)
        return APM_ENEGATIVE;
    mpz_inits(t, rest, NULL);
    if (shift >= 0) {
        shift_up(t, x->mant, shift);
    } else {
        shift_down(t, x->mant, -shift, APM_DOWN);
        shift_up(rest, t, -shift);
        exact = mpz_cmp(rest, x->mant) == 0;
    }
    mpz_sqrtrem(r->mant, rest, t);
    if (dir == APM_UP && (!exact || mpz_sgn(rest) != 0))
        mpz_add_ui(r->mant, r->mant, 1UL);
    r->exp = -dp;
    mpz_clears(t, rest, NULL);
    return APM_OK;
}

void apm_round(apm_t r, const apm_t x, long dp, apm_round_t dir)
{
    guard_poll();
    if (x->exp >= -dp) {
        apm_set(r, x);
        return;
    }
    shift_down(r->mant, x->mant, -dp - x->exp, dir);
    r->exp = -dp;
}

void apm_floor(apm_t r, const apm_t x) { apm_round(r, x, 0, APM_DOWN); }

long apm_order(const apm_t x)
{
    if (mpz_sgn(x->mant) == 0)
        return 0;
    return (long)mpz_sizeinbase(x->mant, 10) + x->exp;
}
