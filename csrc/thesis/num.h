/* num.h - the numbers the algorithms are written in.

   Every algorithm of the thesis stands here once and is compiled twice: by rigorous.c with num_t
   an exact decimal, and by double.c with num_t a double.  The second is the quick filter of
   1989: it proves nothing and only tells which prisms are worth the first.  As in the thesis,
   names of the rigorous instance begin with R.

   Where a direction is asked for, the rigorous instance keeps the promise of apm.h.  A failed
   operation (division by zero, root of a negative number) marks the state and leaves a zero;
   whoever decides something looks at the mark first. */
#ifndef CONVERSE_NUM_H
#define CONVERSE_NUM_H

#include "arith/apm.h"

#ifdef NUM_DOUBLE

#include <math.h>

typedef double num_t[1];
#define R(name) name

static inline void num_init(num_t x) { x[0] = 0.0; }
static inline void num_clear(num_t x) { (void)x; }
static inline void num_set(num_t r, const num_t x) { r[0] = x[0]; }
static inline void num_set_si(num_t r, long n, long exp)
{
    r[0] = (double)n * pow(10.0, (double)exp);
}

static inline void num_set_apm(num_t r, const apm_t x) { r[0] = apm_get_d(x); }
static inline int num_set_d(num_t r, double x)
{
    r[0] = x;
    return isfinite(x) ? APM_OK : APM_ERANGE;
}

static inline int num_get_apm(apm_t r, const num_t x) { return apm_set_d(r, x[0]); }
static inline void num_neg(num_t r, const num_t x) { r[0] = -x[0]; }
static inline void num_abs(num_t r, const num_t x) { r[0] = fabs(x[0]); }
static inline void num_add(num_t r, const num_t x, const num_t y) { r[0] = x[0] + y[0]; }
static inline void num_sub(num_t r, const num_t x, const num_t y) { r[0] = x[0] - y[0]; }
static inline void num_mul(num_t r, const num_t x, const num_t y) { r[0] = x[0] * y[0]; }
static inline void num_mul_si(num_t r, const num_t x, long n) { r[0] = x[0] * (double)n; }
static inline void num_half(num_t r, const num_t x) { r[0] = 0.5 * x[0]; }
static inline void num_swap(num_t x, num_t y)
{
    const double t = x[0];
    x[0] = y[0];
    y[0] = t;
}
static inline int num_sgn(const num_t x) { return (x[0] > 0.0) - (x[0] < 0.0); }
static inline int num_cmp(const num_t x, const num_t y) { return (x[0] > y[0]) - (x[0] < y[0]); }
static inline int num_is_finite(const num_t x) { return isfinite(x[0]); }

#else

typedef apm_t num_t;
#define R(name) R##name

#define num_init apm_init
#define num_clear apm_clear
#define num_set apm_set
#define num_set_si apm_set_si
#define num_set_apm apm_set
#define num_set_d apm_set_d
#define num_neg apm_neg
#define num_abs apm_abs
#define num_add apm_add
#define num_sub apm_sub
#define num_mul apm_mul
#define num_mul_si apm_mul_si
#define num_swap apm_swap
#define num_sgn apm_sgn
#define num_cmp apm_cmp

static inline void num_half(apm_t r, const apm_t x)
{
    apm_mul_si(r, x, 5);
    r->exp -= 1;
}

static inline int num_get_apm(apm_t r, const apm_t x)
{
    apm_set(r, x);
    return APM_OK;
}

static inline int num_is_finite(const apm_t x)
{
    (void)x;
    return 1;
}

#endif
#endif
