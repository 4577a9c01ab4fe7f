/* apm.h - decimal numbers of any length, on GMP.

   An apm is an integer times a power of ten, so every finite decimal is a number here: 0.3085
   is 0.3085 and not the nearest double.  Sums, differences and products are exact.  Quotients,
   roots and roundings are taken to dp places after the decimal point in a direction the caller
   names, and the direction is a promise: APM_DOWN never returns more than the true value,
   APM_UP never less, APM_TRUNC never more in magnitude; each is within 10^-dp of the truth.

   It stands in for Lloyd Zussman's library (thesis, Appendix C).  Where that library printed
   a message and returned zero, these functions return a code and leave the result alone.
   Results may be the same object as operands. */
#ifndef CONVERSE_APM_H
#define CONVERSE_APM_H

#include <gmp.h>
#include <stddef.h>

typedef struct {
    mpz_t mant;
    long exp;
} apm_struct;    /* mant * 10^exp */
typedef apm_struct apm_t[1];

enum { APM_OK = 0, APM_EDIVZERO, APM_ENEGATIVE, APM_ESYNTAX, APM_ERANGE };
typedef enum { APM_DOWN, APM_UP, APM_TRUNC } apm_round_t;

/* Exponents beyond this are refused when parsing: aligning two numbers costs memory in
   proportion to the distance of their exponents. */
#define APM_MAX_EXP 100000L

void apm_init(apm_t x);
void apm_clear(apm_t x);
void apm_set(apm_t r, const apm_t x);
void apm_set_si(apm_t r, long n, long exp);             /* n * 10^exp */
int apm_set_str(apm_t r, const char *text);            /* [+-]digits[.digits][e[+-]digits] */
int apm_set_d(apm_t r, double x);      /* exactly; APM_ERANGE if x is not finite */
double apm_get_d(const apm_t x);                        /* within an ulp or two; 0 if too small */
double apm_nearest_d(const apm_t x);    /* and of a double itself that double */
double apm_bound_d(const apm_t x, apm_round_t dir);     /* APM_DOWN: <= x; APM_UP: >= x; close to
                                           it, and infinite where doubles end */
char *apm_get_str(const apm_t x);       /* exact; the caller frees; NULL: no memory */

void apm_swap(apm_t x, apm_t y);
void apm_neg(apm_t r, const apm_t x);
void apm_abs(apm_t r, const apm_t x);
void apm_add(apm_t r, const apm_t x, const apm_t y);
void apm_sub(apm_t r, const apm_t x, const apm_t y);
void apm_mul(apm_t r, const apm_t x, const apm_t y);
void apm_mul_si(apm_t r, const apm_t x, long n);
void apm_scale(apm_t r, const apm_t x, long places);    /* x * 10^places */
int apm_cmp(const apm_t x, const apm_t y);             /* -1, 0, 1 */
int apm_sgn(const apm_t x);                            /* -1, 0, 1 */

int apm_div(apm_t r, const apm_t x, const apm_t y, long dp, apm_round_t dir);
int apm_sqrt(apm_t r, const apm_t x, long dp, apm_round_t dir);
void apm_round(apm_t r, const apm_t x, long dp, apm_round_t dir);   /* to dp places */
void apm_floor(apm_t r, const apm_t x);

/* A decimal order of magnitude: 10^(order-2) <= |x| < 10^order; 0 for x = 0. */
long apm_order(const apm_t x);

#endif
