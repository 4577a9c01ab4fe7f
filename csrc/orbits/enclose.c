/* enclose.c - a state in decimals, and what can be proved of the orbit beside it.

   docs/orbits-proof.md has the theorems; the comments here are about the numbers.  No double
   carries a proof: all numbers are decimals, most of them with dp places, and an ulp is 10^-dp.

   The Hessian of the action is that of a chain: blocks beta[j] = 2 - eps V''(x[j]), -1 between
   neighbours.  A chain of points with both ends left is told by three matrices: what it adds to
   the block of its first point, E, and of its last, G, and how it couples them, -F. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arith/guard.h"
#include "arith/special.h"
#include "orbits/potential.h"

typedef struct { apm_t m[3]; } block;               /* symmetric: entries 00, 01, 11 */
typedef struct { apm_t m[2][2]; } matrix;

typedef struct {
    apm_t u[2], kept[2];
    apm_t force[2];             /* dL/dx */
    block beta;
    /* of the elimination of the points 1, 2, ..., for the step of Newton's method */
    block inverse;
    matrix f;
    apm_t r[2];
    /* s <= D <= t: the pivots of the true orbit, between those of cv_exact_pivots */
    block s;
    apm_t wide;                 /* >= |t - s| */
    apm_t v[2];                 /* about the direction that grows most; |v| is 1 but for 2 ulp */
} site;

enum { SCRATCH = 16, BOUNDS = CV_GROWTH_HIGH + 1, STUBBORN = 40,
       ASK = 256 };                 /* points dealt with before Ctrl-C is looked for */

struct cv_exact {
    int kind, n, terms, lost;
    cv_stop stop;
    long q, p[2], dp, asked;
    apm_t eps, curvature, lipschitz, origin[2];
    int *k;
    apm_t *amplitude;           /* the cosines', then the sines' */
    site *at;
    apm_t ulp, fuzz, blur;
    apm_t bound[BOUNDS];        /* which, in orbits.h */
    apm_t t[SCRATCH];
    block E, G, last, spare[2];
    matrix F, old, spread;
    trig_t trig;
    apm_t pi;
};

/* ---- all numbers of a state, for whatever must be done to each */

static void each_block(block *b, void (*f)(apm_t))
{
    for (int i = 0; i < 3; i++)
        f(b->m[i]);
}

static void each_matrix(matrix *x, void (*f)(apm_t))
{
    for (int i = 0; i < 4; i++)
        f(x->m[i / 2][i % 2]);
}

static void each_number(cv_exact *o, void (*f)(apm_t))
{
    apm_struct *const single[] = { o->eps, o->curvature, o->lipschitz, o->origin[0], o->origin[1],
                                   o->ulp, o->fuzz, o->blur, o->pi };

    for (size_t i = 0; i < sizeof single / sizeof *single; i++)
        f(single[i]);
    for (int i = 0; i < BOUNDS; i++)
        f(o->bound[i]);
    for (int i = 0; i < SCRATCH; i++)
        f(o->t[i]);
    for (int i = 0; i < 2 * o->terms; i++)
        f(o->amplitude[i]);
    each_block(&o->E, f);
    each_block(&o->G, f);
    each_block(&o->last, f);
    each_block(&o->spare[0], f);
    each_block(&o->spare[1], f);
    each_matrix(&o->F, f);
    each_matrix(&o->old, f);
    each_matrix(&o->spread, f);
    for (long j = 0; j < o->q; j++) {
        site *const here = &o->at[j];
        for (int i = 0; i < 2; i++) {
            f(here->u[i]);
            f(here->kept[i]);
            f(here->force[i]);
            f(here->r[i]);
            f(here->v[i]);
        }
        f(here->wide);
        each_block(&here->beta, f);
        each_block(&here->inverse, f);
        each_block(&here->s, f);
        each_matrix(&here->f, f);
    }
}

void cv_exact_free(cv_exact *o)
{
    if (o == NULL)
        return;
    if (!o->lost) {                     /* after CV_ENOMEM the numbers are abandoned: guard.c */
        each_number(o, apm_clear);
        trig_clear(&o->trig);
    }
    free(o->at);
    free(o->k);
    free(o->amplitude);
    free(o);
}

/* In each loop over the points, where all numbers are whole. */
static void ask(cv_exact *o)
{
    if (++o->asked % ASK == 0) {
        if (cv_python_interrupts())
            cv_stop_set(&o->stop);
        guard_poll();
    }
}

typedef struct {
    int (*work)(cv_exact *, const void *);
    cv_exact *o;
    const void *how;
    int status;
} errand;

static void run(void *data)
{
    errand *const e = data;

    e->status = e->work(e->o, e->how);
}

/* Runs a piece of work that may run out of memory: then the state is lost.  When it is stopped, the
   numbers are good for being freed. */
static int guarded(cv_exact *o, int (*work)(cv_exact *, const void *), const void *how)
{
    errand e = { work, o, how, CV_ENOMEM };

    if (cv_stop_get(&o->stop))
        return CV_ESTOPPED;
    if (!o->lost)
        switch (guard_run(run, &e, &o->stop)) {
        case GUARD_STOP:
            return CV_ESTOPPED;
        case GUARD_MEMORY:
            e.status = CV_ENOMEM;
        }
    if (e.status == CV_ENOMEM)
        o->lost = 1;
    return e.status;
}

typedef struct {
    const long *p;
    const int *k;
    const char *const *number;
    const double (*u)[2];
} given;

static int fill(cv_exact *o, const void *how)
{
    const given *const g = how;

    each_number(o, apm_init);
    trig_init(&o->trig, 1);
    for (int i = 0; i < o->n; i++)
        if (apm_set_str(o->origin[i], g->number[3 + i]) != APM_OK)
            return CV_ENUMBER;
    if (apm_set_str(o->eps, g->number[0]) != APM_OK ||
        apm_set_str(o->curvature, g->number[1]) != APM_OK ||
        apm_set_str(o->lipschitz, g->number[2]) != APM_OK)
        return CV_ENUMBER;
    for (long j = 0; j < o->q; j++)
        for (int i = 0; i < o->n; i++)
            if (apm_set_d(o->at[j].u[i], g->u[j][i]) != APM_OK)
                return CV_ENUMBER;
    return CV_OK;
}

int cv_exact_new(cv_exact **out, int kind, int n, int terms, const int *k, const long p[2], long q,
                 const char *const number[5], const double (*u)[2])
{
    const given g = { .p = p, .k = k, .number = number, .u = u };
    cv_exact *o;
    int status;

    *out = NULL;
    if ((kind != CV_FOURIER && kind != CV_POLY && kind != CV_FF) || n < 1 || n > 2 || terms < 0 ||
        q < 1 || q >= 1L << 31 || (kind != CV_FOURIER && n != 2))
        return CV_EARGUMENT;
    o = calloc(1, sizeof *o);
    if (o == NULL)
        return CV_ENOMEM;
    o->kind = kind;
    o->n = n;
    o->terms = terms;
    o->q = q;
    for (int i = 0; i < n; i++)
        o->p[i] = (p[i] % q + q) % q;
    o->k = calloc((size_t)terms + 1, 2 * sizeof *o->k);
    o->amplitude = calloc((size_t)terms + 1, 2 * sizeof *o->amplitude);
    o->at = calloc((size_t)q, sizeof *o->at);
    if (o->k == NULL || o->amplitude == NULL || o->at == NULL) {
        o->lost = 1;                    /* nothing in it to clear */
        cv_exact_free(o);
        return CV_ENOMEM;
    }
    if (terms > 0)
        memcpy(o->k, k, 2 * (size_t)terms * sizeof *o->k);
    status = guarded(o, fill, &g);
    if (status != CV_OK)
        cv_exact_free(o);
    else
        *out = o;
    return status;
}

/* ---- the potential

   Its derivatives at a decimal point x: value, gradient, hessian in out[0], out[1..2], out[3..5].
   Promise: each is within fuzz of the truth. */

/* a = sum of a few: r += x y, exactly. */
static void add_product(apm_t r, const apm_t x, const apm_t y, apm_t scratch)
{
    apm_mul(scratch, x, y);
    apm_add(r, r, scratch);
}

/* Amplitudes, sines and cosines are within 1, 2 and 2 ulp: the last two 1 by their own promise,
   and 1 as the phase, at most half a turn, is multiplied by 2 pi that is 2 ulp short.  So a wave
   a cos + b sin, and its slope, is within 2 (1 + |a| + |b|) ulp.  Times 2 pi, and (2 pi)^2, short
   by 2 and less than 26 ulp: gradients and Hessians are within 15 and 105 ulp times the sum over
   the waves of |k|^m (1 + |a| + |b|), |k| the sum of both, m = 1 and 2; and rounded once. */
static void fourier(cv_exact *o, apm_t x[2], apm_t out[6])
{
    apm_t *const t = o->t;

    for (int i = 0; i < 6; i++)
        apm_set_si(out[i], 0, 0);
    for (int term = 0; term < o->terms; term++) {
        const int *const k = o->k + 2 * term;
        apm_mul_si(t[0], x[0], k[0]);
        apm_mul_si(t[1], x[1], k[1]);
        apm_add(t[0], t[0], t[1]);
        apm_set_si(t[1], 5, -1);
        apm_add(t[1], t[0], t[1]);
        apm_floor(t[1], t[1]);
        apm_sub(t[0], t[0], t[1]);
        apm_mul(t[0], t[0], o->pi);
        apm_mul_si(t[0], t[0], 2);
        apm_sincos(t[1], t[2], t[0], &o->trig);
        apm_mul(t[0], o->amplitude[term], t[2]);
        add_product(t[0], o->amplitude[o->terms + term], t[1], t[3]);     /* the wave */
        apm_neg(t[1], t[1]);
        apm_mul(t[1], o->amplitude[term], t[1]);
        add_product(t[1], o->amplitude[o->terms + term], t[2], t[3]);     /* its slope */
        apm_add(out[0], out[0], t[0]);
        for (int i = 0; i < 2; i++) {
            apm_mul_si(t[2], t[1], k[i]);
            apm_add(out[1 + i], out[1 + i], t[2]);
        }
        for (int i = 0; i < 3; i++) {
            apm_mul_si(t[2], t[0], -(long)k[i / 2] * k[(i + 1) / 2]);
            apm_add(out[3 + i], out[3 + i], t[2]);
        }
    }
    apm_mul_si(t[0], o->pi, 2);
    for (int i = 1; i < 6; i++) {
        apm_mul(out[i], out[i], t[0]);
        if (i >= 3)
            apm_mul(out[i], out[i], t[0]);
    }
}

/* V = -4096 f(y0) g(y1), y = x - 1/2; with a = 1/4 - y^2, f = a^2 (a - 3/16), g = a^2:
   f' = -6 y a (a - 1/8), f'' = -30 a^2 + 33 a/4 - 3/8, g' = -4 y a, g'' = 2 - 12 a.  Exactly. */
static void poly(cv_exact *o, apm_t x[2], apm_t out[6])
{
    apm_t *const t = o->t, *const f = t + 6, *const g = t + 9;

    apm_set_si(t[0], 5, -1);
    for (int i = 0; i < 2; i++) {
        apm_sub(t[1 + i], x[i], t[0]);                      /* y */
        apm_mul(t[3 + i], t[1 + i], t[1 + i]);
        apm_set_si(t[5], 25, -2);
        apm_sub(t[3 + i], t[5], t[3 + i]);                  /* a */
    }
    apm_mul(g[0], t[4], t[4]);
    apm_mul(g[1], t[2], t[4]);
    apm_mul_si(g[1], g[1], -4);
    apm_mul_si(g[2], t[4], -12);
    apm_set_si(t[5], 2, 0);
    apm_add(g[2], g[2], t[5]);

    apm_mul(f[2], t[3], t[3]);
    apm_set_si(t[5], -1875, -4);
    apm_add(t[5], t[3], t[5]);
    apm_mul(f[0], f[2], t[5]);
    apm_set_si(t[5], -125, -3);
    apm_add(t[5], t[3], t[5]);
    apm_mul(f[1], t[1], t[3]);
    apm_mul(f[1], f[1], t[5]);
    apm_mul_si(f[1], f[1], -6);
    apm_mul_si(f[2], f[2], -30);
    apm_set_si(t[5], 825, -2);
    add_product(f[2], t[3], t[5], t[0]);
    apm_set_si(t[5], -375, -3);
    apm_add(f[2], f[2], t[5]);

    apm_mul(out[0], f[0], g[0]);
    apm_mul(out[1], f[1], g[0]);
    apm_mul(out[2], f[0], g[1]);
    apm_mul(out[3], f[2], g[0]);
    apm_mul(out[4], f[1], g[1]);
    apm_mul(out[5], f[0], g[2]);
    for (int i = 0; i < 6; i++)
        apm_mul_si(out[i], out[i], -4096);
}

/* V = -(c(x0) + c(x1))/4 - c(x0 + x1)/2, c = 1 - 24 y^2 + 32 y^3, y the distance from x to the next
   integer.  Exactly. */
static void fast_froeschle(cv_exact *o, apm_t x[2], apm_t out[6])
{
    static const long weight[3] = { -25, -25, -50 };        /* hundredths */
    apm_t *const t = o->t;

    for (int i = 0; i < 6; i++)
        apm_set_si(out[i], 0, 0);
    for (int wave = 0; wave < 3; wave++) {
        long sign = 1;
        if (wave < 2) {
            apm_set(t[0], x[wave]);
        } else {
            apm_add(t[0], x[0], x[1]);
            apm_floor(t[1], t[0]);
            apm_sub(t[0], t[0], t[1]);
        }
        apm_set_si(t[1], 5, -1);
        if (apm_cmp(t[0], t[1]) > 0) {
            apm_set_si(t[1], 1, 0);
            apm_sub(t[0], t[1], t[0]);
            sign = -1;
        }
        apm_mul(t[1], t[0], t[0]);                          /* y^2 */
        apm_mul_si(t[2], t[0], 32);
        apm_set_si(t[3], -24, 0);
        apm_add(t[2], t[2], t[3]);
        apm_mul(t[2], t[2], t[1]);
        apm_set_si(t[3], 1, 0);
        apm_add(t[2], t[2], t[3]);                          /* c */
        apm_mul_si(t[1], t[1], 96 * sign);
        apm_mul_si(t[3], t[0], -48 * sign);
        apm_add(t[3], t[3], t[1]);                          /* c' */
        apm_mul_si(t[4], t[0], 192);
        apm_set_si(t[5], -48, 0);
        apm_add(t[4], t[4], t[5]);                          /* c'' */
        for (int i = 2; i < 5; i++) {
            apm_mul_si(t[i], t[i], weight[wave]);
            apm_scale(t[i], t[i], -2);
        }
        apm_add(out[0], out[0], t[2]);
        for (int i = 0; i < 2; i++)
            if (wave == i || wave == 2)
                apm_add(out[1 + i], out[1 + i], t[3]);
        for (int i = 0; i < 3; i++)
            if (2 * wave == i || wave == 2)
                apm_add(out[3 + i], out[3 + i], t[4]);
    }
}

/* ---- the state: force, beta, and what is uncertain of them */

/* Reads the amplitudes and sets pi and the bounds of errors.

   x[j] = origin + (j p mod q)/q + u is taken 2 ulp short or less in each coordinate, 3 ulp in all;
   that moves V by 3 ulp times the largest |grad V|, which is at most the curvature (V is periodic,
   so within less than 1 there is a point where grad V = 0), grad V by 3 ulp times the curvature and
   V'' by 3 ulp times K.
   fuzz: of what the functions above return.  blur: of beta[j], as a norm; its entries are within
   |eps| fuzz and one more ulp for their rounding, and a norm is at most twice the largest entry. */
static int set_digits(cv_exact *o, const char *const amplitude[])
{
    apm_t *const t = o->t;

    apm_set_si(o->ulp, 1, -o->dp);
    apm_set_si(t[0], 2, 0);
    for (int i = 0; i < 2 * o->terms; i++) {
        const int *const k = o->k + 2 * (i % o->terms);
        const long size = labs((long)k[0]) + labs((long)k[1]);
        if (apm_set_str(o->amplitude[i], amplitude[i]) != APM_OK)
            return CV_ENUMBER;
        apm_abs(t[1], o->amplitude[i]);
        apm_set_si(t[2], 1, 0);
        apm_add(t[1], t[1], t[2]);
        apm_mul_si(t[1], t[1], 120 * (1 + size * size));
        apm_add(t[0], t[0], t[1]);
    }
    apm_mul(o->fuzz, t[0], o->ulp);
    apm_abs(t[0], o->eps);
    apm_mul(t[1], t[0], o->fuzz);
    apm_add(t[1], t[1], o->ulp);
    apm_mul_si(o->blur, t[1], 2);
    apm_mul(t[1], o->lipschitz, o->ulp);
    apm_mul_si(t[1], t[1], 3);
    add_product(o->blur, t[0], t[1], t[2]);
    trig_clear(&o->trig);
    trig_init(&o->trig, o->dp);
    apm_pi(o->pi, o->dp);
    return CV_OK;
}

/* x = origin + (j p mod q)/q + u modulo 1, short by less than 2 ulp */
static void point(cv_exact *o, long j, apm_t x[2])
{
    apm_t *const t = o->t;

    apm_set_si(x[1], 0, 0);
    for (int i = 0; i < o->n; i++) {
        apm_set_si(t[0], j * o->p[i] % o->q, 0);
        apm_set_si(t[1], o->q, 0);
        apm_div(t[0], t[0], t[1], o->dp, APM_DOWN);
        apm_add(t[1], o->origin[i], o->at[j].u[i]);
        apm_round(t[1], t[1], o->dp, APM_DOWN);
        apm_add(t[0], t[0], t[1]);
        apm_floor(t[1], t[0]);
        apm_sub(x[i], t[0], t[1]);
    }
}

/* The norm of the gradient and the action per point, with every error: the gradient's 2q entries
   are within |eps| (fuzz + 3 ulp curvature), and so is each eps V. */
static void sum_up(cv_exact *o, const apm_t squares, const apm_t action)
{
    apm_t *const t = o->t;

    apm_set_si(t[0], o->q, 0);
    apm_mul(t[2], o->curvature, o->ulp);
    apm_mul_si(t[2], t[2], 3);
    apm_add(t[2], t[2], o->fuzz);
    apm_mul(t[2], t[2], o->eps);
    apm_abs(t[2], t[2]);
    apm_mul_si(t[1], t[0], 2);
    apm_sqrt(t[1], t[1], 3, APM_UP);
    apm_mul_si(t[3], o->ulp, 4);
    apm_add(t[3], t[3], t[2]);
    apm_mul(o->bound[CV_NOISE], t[1], t[3]);
    apm_mul(t[1], t[1], t[2]);
    apm_sqrt(o->bound[CV_GRADIENT], squares, o->dp + 5, APM_UP);
    apm_add(o->bound[CV_GRADIENT], o->bound[CV_GRADIENT], t[1]);
    apm_div(t[1], action, t[0], o->dp, APM_DOWN);
    apm_sub(o->bound[CV_ACTION_LOW], t[1], t[2]);
    apm_div(t[1], action, t[0], o->dp, APM_UP);
    apm_add(o->bound[CV_ACTION_HIGH], t[1], t[2]);
}

static int evaluate(cv_exact *o, const void *how)
{
    apm_t x[2], local[6], squares, action, step;
    const int status = how != NULL ? set_digits(o, how) : CV_OK;

    if (status != CV_OK)
        return status;
    for (int i = 0; i < 2; i++)
        apm_init(x[i]);
    for (int i = 0; i < 6; i++)
        apm_init(local[i]);
    apm_init(squares);
    apm_init(action);
    apm_init(step);
    for (long j = 0; j < o->q; j++)
        for (int i = 0; i < o->n; i++)
            apm_round(o->at[j].u[i], o->at[j].u[i], o->dp, APM_DOWN);
    for (long j = 0; j < o->q; j++) {
        site *const here = &o->at[j];
        const site *const next = &o->at[(j + 1) % o->q];
        const site *const before = &o->at[(j + o->q - 1) % o->q];
        ask(o);
        point(o, j, x);
        (o->kind == CV_FOURIER ? fourier : o->kind == CV_POLY ? poly : fast_froeschle)(o, x, local);
        for (int i = 0; i < 6; i++) {
            apm_round(local[i], local[i], o->dp, APM_DOWN);
            apm_mul(local[i], local[i], o->eps);
        }
        for (int i = 0; i < o->n; i++) {
            apm_sub(step, next->u[i], here->u[i]);
            apm_sub(here->force[i], here->u[i], before->u[i]);
            apm_sub(here->force[i], here->force[i], step);
            apm_sub(here->force[i], here->force[i], local[1 + i]);
            add_product(squares, here->force[i], here->force[i], o->t[0]);
            apm_mul(step, step, step);
            apm_mul_si(step, step, 5);
            apm_scale(step, step, -1);
            apm_add(action, action, step);
        }
        apm_sub(action, action, local[0]);
        for (int i = 0; i < (o->n == 2 ? 3 : 1); i++) {
            apm_set_si(step, i == 1 ? 0 : 2, 0);
            apm_sub(here->beta.m[i], step, local[3 + i]);
            apm_round(here->beta.m[i], here->beta.m[i], o->dp, APM_DOWN);
        }
    }
    sum_up(o, squares, action);
    for (int i = 0; i < 2; i++)
        apm_clear(x[i]);
    for (int i = 0; i < 6; i++)
        apm_clear(local[i]);
    apm_clear(squares);
    apm_clear(action);
    apm_clear(step);
    return CV_OK;
}

int cv_exact_evaluate(cv_exact *o, long dp, const char *const amplitude[])
{
    if (dp < 10 || dp > 100000)
        return CV_EARGUMENT;
    o->dp = dp;
    return guarded(o, evaluate, amplitude);
}

/* ---- small matrices.  Where n is one, the entries 01 and 11 are zero. */

static void determinant(const cv_exact *o, apm_t r, const block *x, apm_t scratch)
{
    if (o->n == 1) {
        apm_set(r, x->m[0]);
        return;
    }
    apm_mul(r, x->m[0], x->m[2]);
    apm_mul(scratch, x->m[1], x->m[1]);
    apm_sub(r, r, scratch);
}

/* Is x positive definite, or, or_zero, semidefinite?  Exactly. */
static int is_positive(cv_exact *o, const block *x, int or_zero)
{
    determinant(o, o->t[0], x, o->t[1]);
    if (or_zero)
        return apm_sgn(o->t[0]) >= 0 && apm_sgn(x->m[0]) >= 0 && apm_sgn(x->m[2]) >= 0;
    return apm_sgn(o->t[0]) > 0 && apm_sgn(x->m[0]) > 0;
}

/* r = 1/x + e, |e| < 2 ulp as a norm: each entry is rounded by less than an ulp.  0: x is not
   positive definite. */
static int invert(cv_exact *o, block *r, const block *x)
{
    apm_t *const t = o->t;

    if (!is_positive(o, x, 0))
        return 0;
    if (o->n == 1) {
        apm_set_si(t[1], 1, 0);
        apm_div(r->m[0], t[1], x->m[0], o->dp, APM_DOWN);
        return 1;
    }
    apm_neg(t[1], x->m[1]);
    apm_set(t[2], x->m[0]);
    apm_div(r->m[0], x->m[2], t[0], o->dp, APM_DOWN);
    apm_div(r->m[1], t[1], t[0], o->dp, APM_DOWN);
    apm_div(r->m[2], t[2], t[0], o->dp, APM_DOWN);
    return 1;
}

static void set_block(block *r, const block *x)
{
    for (int i = 0; i < 3; i++)
        apm_set(r->m[i], x->m[i]);
}

static void subtract(block *r, const block *x, const block *y)
{
    for (int i = 0; i < 3; i++)
        apm_sub(r->m[i], x->m[i], y->m[i]);
}

static void add_shift(const cv_exact *o, block *r, const apm_t shift)
{
    apm_add(r->m[0], r->m[0], shift);
    if (o->n == 2)
        apm_add(r->m[2], r->m[2], shift);
}

/* r = x f x^T or, turned, x^T f x, to dp places */
static void sandwich(cv_exact *o, block *r, const matrix *x, const block *f, int turned)
{
    apm_t *const t = o->t;

    for (int i = 0; i < 3; i++) {
        const int a = i / 2, b = (i + 1) / 2;
        apm_set_si(t[0], 0, 0);
        for (int k = 0; k < 2; k++)
            for (int l = 0; l < 2; l++) {
                apm_mul(t[1], turned ? x->m[k][a] : x->m[a][k], turned ? x->m[l][b] : x->m[b][l]);
                add_product(t[0], t[1], f->m[k + l], t[2]);
            }
        apm_round(r->m[i], t[0], o->dp, APM_TRUNC);
    }
}

/* r = x f, to dp places; r is not x. */
static void times(cv_exact *o, matrix *r, const matrix *x, const block *f)
{
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            apm_mul(o->t[0], x->m[i][0], f->m[k]);
            add_product(o->t[0], x->m[i][1], f->m[1 + k], o->t[1]);
            apm_round(r->m[i][k], o->t[0], o->dp, APM_TRUNC);
        }
}

/* r += f v */
static void add_image(cv_exact *o, apm_t r[2], const block *f, apm_t v[2])
{
    for (int i = 0; i < 2; i++) {
        apm_mul(o->t[0], f->m[i], v[0]);
        add_product(o->t[0], f->m[i + 1], v[1], o->t[1]);
        apm_round(o->t[0], o->t[0], o->dp, APM_TRUNC);
        apm_add(r[i], r[i], o->t[0]);
    }
}

/* ---- eliminations: no promises here.  What they find serves as a guess, which is then checked. */

/* E, F, G of the chain from point 0 once round to point 0 again, whose block is in G, with beta
   + shift for beta.  keep: each point is to remember how it was eliminated, and the force on it.
   0: a pivot is not positive definite. */
static int eliminate(cv_exact *o, const apm_t shift, int keep)
{
    for (int i = 0; i < 3; i++)
        apm_set_si(o->E.m[i], 0, 0);
    for (int i = 0; i < 4; i++)
        apm_set_si(o->F.m[i / 2][i % 2], i % 3 == 0 && i / 2 < o->n, 0);
    for (long j = 1; j <= o->q; j++) {
        site *const here = &o->at[j % o->q];
        ask(o);
        set_block(&o->G, &here->beta);
        add_shift(o, &o->G, shift);
        if (keep)
            for (int i = 0; i < 2; i++)
                apm_neg(here->r[i], here->force[i]);
        if (j > 1) {
            subtract(&o->G, &o->G, &o->spare[0]);
            if (keep)
                add_image(o, here->r, &o->spare[0], o->at[j - 1].r);
        }
        if (j == o->q)
            break;
        if (!invert(o, &o->spare[0], &o->G))
            return 0;
        sandwich(o, &o->spare[1], &o->F, &o->spare[0], 0);
        subtract(&o->E, &o->E, &o->spare[1]);
        if (keep) {
            set_block(&here->inverse, &o->spare[0]);
            for (int i = 0; i < 4; i++)
                apm_set(here->f.m[i / 2][i % 2], o->F.m[i / 2][i % 2]);
        }
        for (int i = 0; i < 4; i++)
            apm_set(o->old.m[i / 2][i % 2], o->F.m[i / 2][i % 2]);
        times(o, &o->F, &o->old, &o->spare[0]);
    }
    return is_positive(o, &o->G, 0);
}

/* The chain round the orbit is joined to its like, and the result to its like, until the ends do
   not feel each other any more: then G is the pivot at point 0 after ever so many rounds.  0:
   there is none; some copies of the orbit together are no minimum. */
static int join(cv_exact *o)
{
    for (long n = 0; n < 4 * o->dp; n++) {
        int coupled = 0;
        for (int i = 0; i < 3; i++)
            apm_add(o->spare[0].m[i], o->G.m[i], o->E.m[i]);
        if (!invert(o, &o->spare[1], &o->spare[0]))
            return 0;
        sandwich(o, &o->spare[0], &o->F, &o->spare[1], 0);
        subtract(&o->E, &o->E, &o->spare[0]);
        sandwich(o, &o->spare[0], &o->F, &o->spare[1], 1);
        subtract(&o->G, &o->G, &o->spare[0]);
        times(o, &o->old, &o->F, &o->spare[1]);
        for (int i = 0; i < 4; i++) {
            apm_t *const t = o->t;
            apm_mul(t[0], o->old.m[i / 2][0], o->F.m[0][i % 2]);
            add_product(t[0], o->old.m[i / 2][1], o->F.m[1][i % 2], t[1]);
            apm_round(o->spread.m[i / 2][i % 2], t[0], o->dp, APM_TRUNC);
        }
        for (int i = 0; i < 4; i++) {
            apm_set(o->F.m[i / 2][i % 2], o->spread.m[i / 2][i % 2]);
            coupled |= apm_sgn(o->F.m[i / 2][i % 2]) != 0;
        }
        if (!coupled)
            return is_positive(o, &o->G, 0);
    }
    return 0;
}

/* The block of point 0 alone, when all others were eliminated. */
static void last_block(cv_exact *o, block *r)
{
    for (int i = 0; i < 3; i++) {
        apm_add(r->m[i], o->E.m[i], o->G.m[i]);
        apm_sub(r->m[i], r->m[i], o->F.m[i / 2][(i + 1) / 2]);
        apm_sub(r->m[i], r->m[i], o->F.m[(i + 1) / 2][i / 2]);
    }
}

static int bends(cv_exact *o, const void *how)
{
    if (apm_set_str(o->t[12], how) != APM_OK)
        return CV_ENUMBER;
    if (!eliminate(o, o->t[12], 0))
        return CV_ESINGULAR;
    last_block(o, &o->spare[0]);
    return is_positive(o, &o->spare[0], 0) ? CV_OK : CV_ESINGULAR;
}

int cv_exact_bends(cv_exact *o, const char *shift)
{
    return guarded(o, bends, shift);
}

/* r = -(Hessian + shift)^-1 force, from point 0 back to those that were eliminated; u += r. */
static int newton(cv_exact *o, const void *how)
{
    apm_t *const t = o->t, *const first = o->at[0].r;
    apm_t along[2];

    if (apm_set_str(t[12], how) != APM_OK)
        return CV_ENUMBER;
    if (!eliminate(o, t[12], 1))
        return CV_ESINGULAR;
    last_block(o, &o->spare[0]);
    if (!invert(o, &o->spare[1], &o->spare[0]))
        return CV_ESINGULAR;
    for (int i = 0; i < 2; i++)
        apm_init(along[i]);
    /* At point 0, whose r holds its own and its last neighbour's part, add those of all others. */
    for (long j = 1; j < o->q; j++) {
        site *const here = &o->at[j];
        ask(o);
        for (int i = 0; i < 2; i++)
            apm_set_si(along[i], 0, 0);
        add_image(o, along, &here->inverse, here->r);
        for (int i = 0; i < o->n; i++) {
            apm_mul(t[0], here->f.m[i][0], along[0]);
            add_product(t[0], here->f.m[i][1], along[1], t[1]);
            apm_round(t[0], t[0], o->dp, APM_TRUNC);
            apm_add(first[i], first[i], t[0]);
        }
    }
    for (int i = 0; i < 2; i++) {
        apm_swap(along[i], first[i]);
        apm_set_si(first[i], 0, 0);
    }
    add_image(o, first, &o->spare[1], along);
    for (long j = o->q - 1; j > 0; j--) {
        site *const here = &o->at[j];
        const site *const next = &o->at[(j + 1) % o->q];
        ask(o);
        for (int i = 0; i < 2; i++) {
            apm_add(along[i], here->r[i], next->r[i]);
            for (int k = 0; k < 2; k++)
                add_product(along[i], here->f.m[k][i], first[k], t[0]);
            apm_set_si(here->r[i], 0, 0);
        }
        add_image(o, here->r, &here->inverse, along);
    }
    for (long j = 0; j < o->q; j++)
        for (int i = 0; i < o->n; i++)
            apm_add(o->at[j].u[i], o->at[j].u[i], o->at[j].r[i]);
    for (int i = 0; i < 2; i++)
        apm_clear(along[i]);
    return CV_OK;
}

int cv_exact_newton(cv_exact *o, const char *shift)
{
    return guarded(o, newton, shift);
}

static int keep(cv_exact *o, const void *how)
{
    const int *const back = how;

    for (long j = 0; j < o->q; j++)
        for (int i = 0; i < o->n; i++)
            apm_set(*back ? o->at[j].u[i] : o->at[j].kept[i],
                    *back ? o->at[j].kept[i] : o->at[j].u[i]);
    return CV_OK;
}

int cv_exact_keep(cv_exact *o, int back)
{
    return guarded(o, keep, &back);
}

/* ---- pivots, with promises */

/* spare[0] = beta[j] + shift - 1/x, off by less than 2 ulp.  0: x is not positive definite. */
static int pivot(cv_exact *o, long j, const apm_t shift, const block *x)
{
    if (!invert(o, &o->spare[1], x))
        return 0;
    subtract(&o->spare[0], &o->at[j].beta, &o->spare[1]);
    add_shift(o, &o->spare[0], shift);
    return 1;
}

/* s[0] = G, s[j] = pivot(j), and last, what would follow at point 0.  Returns whether s is such
   that

       s[j] + 1/s[j-1] <= beta[j] - m   for all j cyclically,   s > 0,

   with beta that of the state, m = -shift - blur - 2 ulp: for j > 0 that is what pivot promises,
   and at point 0, where last satisfies it, it is enough that s[0] <= last. */
static int below(cv_exact *o, const apm_t shift)
{
    set_block(&o->at[0].s, &o->G);
    for (long j = 1; j <= o->q; j++) {
        ask(o);
        if (!pivot(o, j % o->q, shift, &o->at[j - 1].s))
            return 0;
        set_block(j < o->q ? &o->at[j].s : &o->last, &o->spare[0]);
    }
    subtract(&o->spare[0], &o->last, &o->at[0].s);
    return is_positive(o, &o->at[0].s, 0) && is_positive(o, &o->spare[0], 1);
}

/* Is every copy's Hessian, less m, positive semidefinite?  The guess is made for 8 ulp more at each
   point, more than it is rounded by there, so that s[0] comes to lie below last. */
static int is_least(cv_exact *o, const apm_t m)
{
    apm_t *const t = o->t;

    apm_mul_si(t[12], o->ulp, 2);
    apm_add(t[12], t[12], o->blur);
    apm_add(t[12], t[12], m);
    apm_neg(t[12], t[12]);                              /* the shift */
    apm_mul_si(t[13], o->ulp, -8);
    apm_add(t[13], t[13], t[12]);
    return eliminate(o, t[13], 0) && join(o) && below(o, t[12]);
}

static int least(cv_exact *o, const void *how)
{
    if (apm_set_str(o->t[14], how) != APM_OK)
        return CV_ENUMBER;
    return is_least(o, o->t[14]) ? CV_OK : CV_ESINGULAR;
}

int cv_exact_least(cv_exact *o, const char *m)
{
    return guarded(o, least, m);
}

/* r *= x, to dp digits, rounded in this direction; x >= 0. */
static void grow(const cv_exact *o, apm_t r, const apm_t x, apm_round_t direction)
{
    apm_mul(r, r, x);
    apm_round(r, r, o->dp - apm_order(r), direction);
}

/* t[0] = G, t[j] = pivot(j) with shift = away + blur + 2 ulp, so that t[j] + 1/t[j-1] >= beta[j]
   for every beta within `away` of the state's; at point 0 because last <= t[0].  And s[0] <=
   t[0]. Keeps |t - s| <= its trace at each point, and the products of the determinants. */
static int above(cv_exact *o, const apm_t shift)
{
    apm_t *const scratch = o->t;
    block *const before = &o->last;

    set_block(before, &o->G);
    apm_set_si(o->bound[CV_DET_LOW], 1, 0);
    apm_set_si(o->bound[CV_DET_HIGH], 1, 0);
    subtract(&o->spare[0], &o->G, &o->at[0].s);
    if (!is_positive(o, &o->spare[0], 1))
        return 0;
    for (long j = 0; j < o->q; j++) {
        site *const here = &o->at[j];
        ask(o);
        determinant(o, scratch[2], &here->s, scratch[3]);
        grow(o, o->bound[CV_DET_LOW], scratch[2], APM_DOWN);
        determinant(o, scratch[2], before, scratch[3]);
        grow(o, o->bound[CV_DET_HIGH], scratch[2], APM_UP);
        apm_add(here->wide, before->m[0], before->m[2]);
        apm_sub(here->wide, here->wide, here->s.m[0]);
        apm_sub(here->wide, here->wide, here->s.m[2]);
        if (!pivot(o, (j + 1) % o->q, shift, before))
            return 0;
        set_block(before, &o->spare[0]);
    }
    subtract(&o->spare[0], &o->G, before);
    return is_positive(o, &o->spare[0], 1);
}

/* The matrices that s are in the frames (v, Jv), J the quarter turn, and what they may be off by:
   D v = a v' + c Jv', D Jv = b v' + d Jv' but for the factor |v'|^2.  As |D - s| <= wide and |v|^2
   <= 1 + 4 ulp, 2 wide is more than enough.  With turn < 0 the next frame is (-v', -Jv'). */
static void in_frames(cv_exact *o, long j, int turn, apm_t a, apm_t b, apm_t c, apm_t d, apm_t off)
{
    site *const here = &o->at[j];
    apm_struct *const v0 = here->v[0], *const v1 = here->v[1];
    apm_t *const w = o->at[(j + 1) % o->q].v, *const t = o->t, *const s = here->s.m;

    apm_mul(t[0], s[0], v0);
    add_product(t[0], s[1], v1, t[2]);
    apm_mul(t[1], s[1], v0);
    add_product(t[1], s[2], v1, t[2]);                  /* s v */
    apm_mul(a, t[0], w[0]);
    add_product(a, t[1], w[1], t[2]);
    apm_neg(t[0], t[0]);
    apm_mul(c, t[1], w[0]);
    add_product(c, t[0], w[1], t[2]);
    apm_mul(t[0], s[1], v0);
    apm_mul(t[2], s[0], v1);
    apm_sub(t[0], t[0], t[2]);
    apm_mul(t[1], s[2], v0);
    apm_mul(t[2], s[1], v1);
    apm_sub(t[1], t[1], t[2]);                          /* s Jv */
    apm_mul(b, t[0], w[0]);
    add_product(b, t[1], w[1], t[2]);
    apm_neg(t[0], t[0]);
    apm_mul(d, t[1], w[0]);
    add_product(d, t[0], w[1], t[2]);
    if (turn < 0) {
        apm_neg(a, a);
        apm_neg(b, b);
        apm_neg(c, c);
        apm_neg(d, d);
    }
    apm_mul_si(off, here->wide, 2);
}

/* v = w/|w| to dp places.  Both quotients are rounded down by less than an ulp, so |v|^2 is
   within 3 ulp of 1, and 4 with the root's error.  0: w is zero. */
static int normalize(cv_exact *o, apm_t v[2], apm_t w[2])
{
    apm_t *const t = o->t;

    apm_mul(t[0], w[0], w[0]);
    add_product(t[0], w[1], w[1], t[1]);
    apm_sqrt(t[0], t[0], 2 * o->dp - apm_order(t[0]), APM_DOWN);
    if (apm_sgn(t[0]) == 0)
        return 0;
    apm_div(v[0], w[0], t[0], o->dp, APM_DOWN);
    apm_div(v[1], w[1], t[0], o->dp, APM_DOWN);
    return 1;
}

/* Brings a matrix to size about one, with dp places. */
static void rescale(cv_exact *o, matrix *x)
{
    long order = apm_order(x->m[0][0]);

    for (int i = 1; i < 4; i++)
        if (apm_sgn(x->m[i / 2][i % 2]) != 0 &&
            (order < apm_order(x->m[i / 2][i % 2]) || apm_sgn(x->m[0][0]) == 0))
            order = apm_order(x->m[i / 2][i % 2]);
    for (int i = 0; i < 4; i++) {
        apm_scale(x->m[i / 2][i % 2], x->m[i / 2][i % 2], -order);
        apm_round(x->m[i / 2][i % 2], x->m[i / 2][i % 2], o->dp, APM_TRUNC);
    }
}

/* Directions v that grow most: at point 0 the larger column of a high power of the product of all
   s, and from there on as s carries it.  A guess, but for |v|. */
static int directions(cv_exact *o)
{
    apm_t *const t = o->t;
    apm_t w[2];
    int found;

    for (int i = 0; i < 4; i++)
        apm_set_si(o->F.m[i / 2][i % 2], i % 3 == 0, 0);
    for (long j = 0; j < o->q; j++) {
        ask(o);
        for (int i = 0; i < 4; i++)                     /* from the left: (F^T s)^T */
            apm_set(o->old.m[i % 2][i / 2], o->F.m[i / 2][i % 2]);
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 2; k++) {
                apm_mul(t[0], o->old.m[i][0], o->at[j].s.m[k]);
                add_product(t[0], o->old.m[i][1], o->at[j].s.m[1 + k], t[1]);
                apm_set(o->F.m[k][i], t[0]);
            }
        rescale(o, &o->F);
    }
    for (long n = 0; n < 4 * o->dp; n++) {
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 2; k++) {
                apm_mul(o->old.m[i][k], o->F.m[i][0], o->F.m[0][k]);
                add_product(o->old.m[i][k], o->F.m[i][1], o->F.m[1][k], t[0]);
            }
        rescale(o, &o->old);
        for (int i = 0; i < 4; i++)
            apm_set(o->F.m[i / 2][i % 2], o->old.m[i / 2][i % 2]);
    }
    apm_init(w[0]);
    apm_init(w[1]);
    for (int k = 0; k < 2; k++) {
        apm_mul(t[k], o->F.m[0][k], o->F.m[0][k]);
        add_product(t[k], o->F.m[1][k], o->F.m[1][k], t[3]);
    }
    for (int i = 0; i < 2; i++)
        apm_set(w[i], o->F.m[i][apm_cmp(t[0], t[1]) < 0]);
    found = normalize(o, o->at[0].v, w);
    for (long j = 0; found && j + 1 < o->q; j++) {
        ask(o);
        for (int i = 0; i < 2; i++) {
            apm_mul(w[i], o->at[j].s.m[i], o->at[j].v[0]);
            add_product(w[i], o->at[j].s.m[i + 1], o->at[j].v[1], t[0]);
        }
        found = normalize(o, o->at[j + 1].v, w);
    }
    apm_clear(w[0]);
    apm_clear(w[1]);
    return found;
}

/* The sign of the eigenvalue that belongs to the directions: that of a at the last point. */
static int turn_at(cv_exact *o, long j)
{
    if (j < o->q - 1)
        return 1;
    in_frames(o, j, 1, o->t[4], o->t[5], o->t[6], o->t[7], o->t[8]);
    return apm_sgn(o->t[4]) < 0 ? -1 : 1;
}

/* Carries the cone |y| <= kappa x about v round the orbit: D takes it into |y'| <= kappa' x',

       kappa' = (|c| + off + (|d| + off) kappa)/(a - off - (|b| + off) kappa),

   and x' |v'|^2 is between a - off - (|b| + off) kappa and a + off + (|b| + off) kappa times x;
   |v'|^2 is within 4 ulp of 1, and 5 times that is enough for its inverse.  0: a divisor is not
   positive. */
static int carry_cone(cv_exact *o, apm_t kappa)
{
    apm_t *const t = o->t;
    apm_struct *const a = t[4], *const b = t[5], *const c = t[6], *const d = t[7];
    apm_struct *const off = t[8];

    apm_set_si(o->bound[CV_GROWTH_LOW], 1, 0);
    apm_set_si(o->bound[CV_GROWTH_HIGH], 1, 0);
    for (long j = 0; j < o->q; j++) {
        ask(o);
        in_frames(o, j, turn_at(o, j), a, b, c, d, off);
        apm_abs(b, b);
        apm_abs(c, c);
        apm_abs(d, d);
        apm_add(b, b, off);
        apm_mul(b, b, kappa);
        apm_add(b, b, off);                             /* how far x' may be from a x */
        apm_add(d, d, off);
        add_product(c, d, kappa, t[0]);
        apm_add(c, c, off);
        apm_sub(d, a, b);
        apm_add(a, a, b);
        if (apm_sgn(d) <= 0)
            return 0;
        apm_div(kappa, c, d, 2 * o->dp, APM_UP);
        apm_mul_si(t[0], o->ulp, -5);
        apm_set_si(t[1], 1, 0);
        apm_add(t[0], t[0], t[1]);
        apm_mul(d, d, t[0]);
        grow(o, o->bound[CV_GROWTH_LOW], d, APM_DOWN);
        apm_mul_si(t[0], o->ulp, 5);
        apm_add(t[0], t[0], t[1]);
        apm_mul(a, a, t[0]);
        grow(o, o->bound[CV_GROWTH_HIGH], a, APM_UP);
    }
    return 1;
}

/* Is there a cone that the whole round takes into itself?  The first guess is twice what becomes of
   the direction alone. */
static int close_cone(cv_exact *o)
{
    apm_t *const t = o->t;

    apm_set_si(t[12], 0, 0);
    if (!carry_cone(o, t[12]))
        return 0;
    for (int n = 0; n < STUBBORN; n++) {
        apm_mul_si(t[13], t[12], 2 << (n < 8 ? n : 8));
        apm_set(t[12], t[13]);
        if (!carry_cone(o, t[12]))
            return 0;
        if (apm_cmp(t[12], t[13]) <= 0)
            return 1;
        apm_set(t[12], t[13]);
    }
    return 0;
}

/* Without a cone.  The product of all matrices in the frames is x, each entry within that of r:

       r' = |A| r + off (|x| + r summed down the column) + rounding,   A the matrix with a, b, c, d.

   It is D_{q-1} ... D_0 in the frame at point 0, but for the factors |v|^2, together at most 1 +
   10 q ulp and not less than the inverse of that.  The larger row sum bounds the moduli of the
   eigenvalues; and if the square of the trace is less than four times the determinant, these are
   not real, so both moduli are the determinant's root.  Returns whether they are. */
static int bound_growth(cv_exact *o)
{
    apm_t *const t = o->t;
    matrix *const x = &o->F, *const r = &o->old;

    if (o->q > 10000000L || o->dp < 10)
        return 0;
    for (int i = 0; i < 4; i++) {
        apm_set_si(x->m[i / 2][i % 2], i % 3 == 0, 0);
        apm_set_si(r->m[i / 2][i % 2], 0, 0);
    }
    for (long j = 0; j < o->q; j++) {
        ask(o);
        in_frames(o, j, turn_at(o, j), t[4], t[5], t[6], t[7], t[8]);
        for (int k = 0; k < 2; k++) {
            apm_abs(t[9], x->m[0][k]);
            apm_abs(t[10], x->m[1][k]);
            apm_add(t[9], t[9], t[10]);
            apm_add(t[9], t[9], r->m[0][k]);
            apm_add(t[9], t[9], r->m[1][k]);
            apm_mul(t[9], t[9], t[8]);                  /* off (...) */
            for (int i = 0; i < 2; i++) {
                const int a = i == 0 ? 4 : 6;
                apm_mul(t[10 + i], t[a], x->m[0][k]);
                add_product(t[10 + i], t[a + 1], x->m[1][k], t[0]);
                apm_abs(t[1], t[a]);
                apm_abs(t[2], t[a + 1]);
                apm_mul(t[12 + i], t[1], r->m[0][k]);
                add_product(t[12 + i], t[2], r->m[1][k], t[0]);
                apm_add(t[12 + i], t[12 + i], t[9]);
            }
            for (int i = 0; i < 2; i++) {
                const long places = o->dp - apm_order(t[10 + i]);
                apm_round(x->m[i][k], t[10 + i], places, APM_DOWN);
                apm_set_si(t[0], 1, -places);
                apm_add(t[12 + i], t[12 + i], t[0]);
                apm_round(r->m[i][k], t[12 + i], o->dp - apm_order(t[12 + i]), APM_UP);
            }
        }
    }
    apm_mul_si(t[9], o->ulp, 10 * o->q);
    apm_set_si(t[0], 1, 0);
    apm_add(t[9], t[9], t[0]);                          /* the factors */
    for (int i = 0; i < 2; i++) {
        apm_set_si(t[i], 0, 0);
        for (int k = 0; k < 2; k++) {
            apm_abs(t[2], x->m[i][k]);
            apm_add(t[i], t[i], t[2]);
            apm_add(t[i], t[i], r->m[i][k]);
        }
    }
    apm_mul(o->bound[CV_GROWTH_HIGH], t[apm_cmp(t[0], t[1]) < 0], t[9]);
    apm_add(t[0], x->m[0][0], x->m[1][1]);
    apm_abs(t[0], t[0]);
    apm_add(t[0], t[0], r->m[0][0]);
    apm_add(t[0], t[0], r->m[1][1]);
    apm_mul(t[0], t[0], t[9]);
    apm_mul(t[0], t[0], t[0]);
    apm_mul_si(t[1], o->bound[CV_DET_LOW], 4);
    return apm_cmp(t[0], t[1]) < 0;
}

typedef struct { const char *m, *away; int kind; } tubes;

static int enclose(cv_exact *o, const void *how)
{
    tubes *const both = *(tubes *const *)how;
    apm_t *const t = o->t;

    if (apm_set_str(t[14], both->m) != APM_OK || apm_set_str(t[15], both->away) != APM_OK)
        return CV_ENUMBER;
    if (!is_least(o, t[14]))
        return CV_ESINGULAR;
    apm_mul_si(t[13], o->ulp, 2);
    apm_add(t[13], t[13], o->blur);
    apm_add(t[13], t[13], t[15]);
    apm_add(t[12], t[13], t[14]);
    if (!eliminate(o, t[12], 0) || !join(o) || !above(o, t[13]))
        return CV_ESINGULAR;
    if (o->n == 2) {
        if (!directions(o))
            return CV_ESINGULAR;
        both->kind = close_cone(o) ? CV_REAL : bound_growth(o) ? CV_COMPLEX : CV_UNDECIDED;
    }
    return CV_OK;
}

int cv_exact_pivots(cv_exact *o, const char *m, const char *away, int *kind)
{
    tubes both = { .m = m, .away = away, .kind = CV_UNDECIDED }, *const how = &both;
    const int status = guarded(o, enclose, &how);

    *kind = both.kind;
    return status;
}

/* ---- out */

char *cv_exact_bound(const cv_exact *o, int which)
{
    return !o->lost && which >= 0 && which < BOUNDS ? apm_get_str(o->bound[which]) : NULL;
}

char *cv_exact_point(const cv_exact *o, long j, int i)
{
    return !o->lost && j >= 0 && j < o->q && (i == 0 || i == 1) ? apm_get_str(o->at[j].u[i]) : NULL;
}
