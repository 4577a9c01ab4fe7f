/* state.h - everything one instance of the algorithms works on.  Included by rigorous.c and
   double.c before the files of Appendix C. */
#ifndef CONVERSE_STATE_H
#define CONVERSE_STATE_H

#include <stdlib.h>
#include <string.h>

#include "num.h"
#include "arith/sine.h"
#include "arith/special.h"
#include "model/torus.h"
#include "unit.h"

enum { N_PARMS = 3, DEG_FREE = 2, TWO_DF = 4, MAT_DIM = 7 };
enum { P = 0, U = N_PARMS, V = N_PARMS + DEG_FREE };    /* first row or column of a block */
enum { SAFETY_DP = 5 };                 /* as printed: digits carried beyond dp */
enum { W_DIGITS = 12 };                 /* significant digits kept of the widths w_j */
enum { THETA_ROT = 11 };                /* the column rotor's angle, in hundredths of pi */
enum { MAX_SUM = 85 };                  /* a prism is too big beyond it, in hundredths */
enum { START_SZ = 6 };                  /* as printed: the start is off by 10^-START_SZ */

typedef struct { num_t lb, ub; } bdd;                   /* a number between two bounds */
typedef struct { num_t p[N_PARMS], u[DEG_FREE], v[DEG_FREE]; } xtnd_pt;
typedef struct {
    xtnd_pt centre;
    num_t matrix[MAT_DIM][MAT_DIM];
} prism;

/* beta = 2I - V'' and gamma = the derivative of v' with respect to the parameters. */
typedef struct { num_t beta[DEG_FREE][DEG_FREE], gamma[DEG_FREE][N_PARMS]; } jacobian;

/* All the numbers of a state.  Only num_t's may stand here: they are set up as one array.
   Names after the thesis; t[] and the like are scratch of the function or file they name. */
typedef struct {
    num_t pi_lb, pi_ub;
    num_t max_error;                    /* 10^-dp; as printed: what is added wherever in doubt */
    num_t ulp;                          /* 10^-precision: what a rounding can cost */
    num_t theta_cos, theta_sin, small_sinsq;            /* of the column rotor's angle */
    num_t max_sum;
    num_t constants[CV_N_CONSTANTS];
    num_t first_slope, first_least_lam;

    bdd a, b, c, sin[3], cos[3], a_sin, b_sin, c_sin;   /* over a prism: global_bounds */
    bdd b_trace, minBlam, maxBlam;

    num_t sin_c[3], cos_c[3];           /* of v0, v1, v0 + v1 at a centre: set_sines */
    jacobian deriv;
    num_t centre_err;                   /* bound of the error of each coordinate of v' */
    num_t beta_star, beta_dif, gamma_dif;
    num_t w[MAT_DIM];
    num_t inverse[TWO_DF][TWO_DF], inverse_err;

    prism work[2], earliest;
    num_t slope, least_lam, maxBlam_ll, minBlam_ll, trace_ll;
    num_t mul, t[8], bd[8], ex[8], blam[8], cr[12], ff[8];
    bdd bx[4];
    num_t gauss[TWO_DF][TWO_DF], g[12];
} numbers;

struct R(unit) {
    numbers n;
    trig_t trig;
    long dp, precision;
    int as_printed;
    int failed;                         /* an operation had no result: decide nothing */
    int inverse_failed;                 /* the column rotor's matrix could not be inverted */
};

typedef struct R(unit) state;

/* Sets the number of places to which quotients, roots, sines and roundings are taken. */
static void set_precision(state *s, long precision)
{
    s->precision = precision;
    num_set_si(s->n.ulp, 1, -precision);
}

/* r += x y, r -= x y */
static void num_addmul(state *s, num_t r, const num_t x, const num_t y)
{
    num_mul(s->n.mul, x, y);
    num_add(r, r, s->n.mul);
}

static void num_submul(state *s, num_t r, const num_t x, const num_t y)
{
    num_mul(s->n.mul, x, y);
    num_sub(r, r, s->n.mul);
}

/* r += |x| */
static void num_addabs(state *s, num_t r, const num_t x)
{
    num_abs(s->n.mul, x);
    num_add(r, r, s->n.mul);
}

static void num_min(num_t r, const num_t x)
{
    if (num_cmp(x, r) < 0)
        num_set(r, x);
}
static void num_max(num_t r, const num_t x)
{
    if (num_cmp(x, r) > 0)
        num_set(r, x);
}

#ifdef NUM_DOUBLE

static void num_div(state *s, num_t r, const num_t x, const num_t y, apm_round_t dir)
{
    (void)dir;
    if (y[0] == 0.0)
        s->failed = 1;
    else
        r[0] = x[0] / y[0];
}

static void num_sqrt(state *s, num_t r, const num_t x, apm_round_t dir)
{
    (void)dir;
    if (x[0] < 0.0)
        s->failed = 1;
    else
        r[0] = sqrt(x[0]);
}

static void num_round(state *s, num_t r, const num_t x, apm_round_t dir)
{
    (void)s;
    (void)dir;
    r[0] = x[0];
}

static void num_round_width(num_t r, const num_t x) { r[0] = x[0]; }

static void num_floor(num_t r, const num_t x) { r[0] = floor(x[0]); }
static void num_truncate(num_t r, const num_t x) { r[0] = trunc(x[0]); }

static void num_sincos(state *s, num_t sine, num_t cosine, const num_t x)
{
    const double y = x[0];
    (void)s;
    if (fabs(y) < SINE_LIMIT) {
        double_sincos(sine, cosine, y);
    } else {                            /* such an angle is for the filter only */
        sine[0] = sin(y);
        cosine[0] = cos(y);
    }
}

#else

static void num_div(state *s, num_t r, const num_t x, const num_t y, apm_round_t dir)
{
    if (apm_div(r, x, y, s->precision, dir) != APM_OK)
        s->failed = 1;
}

static void num_sqrt(state *s, num_t r, const num_t x, apm_round_t dir)
{
    if (apm_sqrt(r, x, s->precision, dir) != APM_OK)
        s->failed = 1;
}

static void num_round(state *s, num_t r, const num_t x, apm_round_t dir)
{
    apm_round(r, x, s->precision, dir);
}

/* r >= x with W_DIGITS or one more significant digits.  Widths may only grow, and short numbers
   keep the matrices short. */
static void num_round_width(num_t r, const num_t x)
{
    apm_round(r, x, W_DIGITS - apm_order(x), APM_UP);
}

static void num_floor(num_t r, const num_t x) { apm_floor(r, x); }
static void num_truncate(num_t r, const num_t x) { apm_round(r, x, 0, APM_TRUNC); }

/* Within ulp = 10^-precision of the truth. */
static void num_sincos(state *s, num_t sine, num_t cosine, const num_t x)
{
    apm_sincos(sine, cosine, x, &s->trig);
}

#endif
#endif
