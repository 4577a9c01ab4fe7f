/* numbers.c - the operations of apm.h, special.h, sine.h and torus.h. */
#include <math.h>
#include <time.h>

#include "arith/guard.h"
#include "arith/sine.h"
#include "arith/special.h"
#include "arith/sym.h"
#include "console.h"
#include "torus.h"
#include "thesis/unit.h"

/* What a routine returns if an operation failed. */
static int code_of(int status) { return status == APM_OK ? CV_OK : CV_EARITHMETIC; }

typedef int routine(long dp, apm_t in[], apm_t out[]);

static int pi(long dp, apm_t in[], apm_t out[])
{
    (void)in;
    apm_pi(out[0], dp);
    return CV_OK;
}

static int add(long dp, apm_t in[], apm_t out[])
{
    (void)dp;
    apm_add(out[0], in[0], in[1]);
    return CV_OK;
}

static int sub(long dp, apm_t in[], apm_t out[])
{
    (void)dp;
    apm_sub(out[0], in[0], in[1]);
    return CV_OK;
}

static int mul(long dp, apm_t in[], apm_t out[])
{
    (void)dp;
    apm_mul(out[0], in[0], in[1]);
    return CV_OK;
}

static int cmp(long dp, apm_t in[], apm_t out[])        /* -1, 0 or 1 */
{
    (void)dp;
    apm_set_si(out[0], apm_cmp(in[0], in[1]), 0);
    return CV_OK;
}

static const apm_round_t directions[3] = { APM_DOWN, APM_UP, APM_TRUNC };

static int divide(long dp, apm_t in[], apm_t out[])     /* rounded down, up, towards zero */
{
    int status = APM_OK;

    for (int j = 0; j < 3 && status == APM_OK; j++)
        status = apm_div(out[j], in[0], in[1], dp, directions[j]);
    return code_of(status);
}

static int root(long dp, apm_t in[], apm_t out[])       /* rounded down, up */
{
    int status = APM_OK;

    for (int j = 0; j < 2 && status == APM_OK; j++)
        status = apm_sqrt(out[j], in[0], dp, directions[j]);
    return code_of(status);
}

static int rounded(long dp, apm_t in[], apm_t out[])    /* down, up, towards zero */
{
    for (int j = 0; j < 3; j++)
        apm_round(out[j], in[0], dp, directions[j]);
    return CV_OK;
}

static int integer_below(long dp, apm_t in[], apm_t out[])
{
    (void)dp;
    apm_floor(out[0], in[0]);
    return CV_OK;
}

static int scale(long dp, apm_t in[], apm_t out[])      /* x, n -> x 10^n */
{
    const double places = apm_get_d(in[1]);

    (void)dp;
    if (!(fabs(places) <= APM_MAX_EXP))
        return CV_EARGUMENT;
    apm_scale(out[0], in[0], (long)places);
    return CV_OK;
}

static int order(long dp, apm_t in[], apm_t out[])
{
    (void)dp;
    apm_set_si(out[0], apm_order(in[0]), 0);
    return CV_OK;
}

static int as_double(long dp, apm_t in[], apm_t out[])  /* what apm_get_d makes of x, exactly */
{
    (void)dp;
    return code_of(apm_set_d(out[0], apm_get_d(in[0])));
}

static int bounds(long dp, apm_t in[], apm_t out[])     /* doubles not above and not below x */
{
    int status = APM_OK;

    (void)dp;
    for (int j = 0; j < 2 && status == APM_OK; j++)
        status = apm_set_d(out[j], apm_bound_d(in[0], directions[j]));
    return code_of(status);
}

static void ask_and_poll(void *stop)
{
    ask_to_stop(stop, 1);
    guard_poll();
}

typedef struct {
    stop_request inner, outer;
    int ended;
} nested;

static void nest(void *data)
{
    nested *const n = data;

    n->ended = guard_run(ask_and_poll, &n->inner, &n->inner);
    ask_and_poll(&n->outer);
}

/* How a guard within a guard ends where it is stopped, and then the other one. */
static int guards(long dp, apm_t in[], apm_t out[])
{
    nested n = { { 0 }, { 0 }, -1 };

    (void)dp;
    (void)in;
    apm_set_si(out[1], guard_run(nest, &n, &n.outer), 0);
    apm_set_si(out[0], n.ended, 0);
    return CV_OK;
}

/* An operation of apm.h by its number, with a direction where it takes one. */
static int operate(int which, apm_t r, const apm_t x, const apm_t y, long n, apm_round_t dir)
{
    switch (which) {
    case 0: apm_set(r, x); break;
    case 1: apm_neg(r, x); break;
    case 2: apm_abs(r, x); break;
    case 3: apm_add(r, x, y); break;
    case 4: apm_sub(r, x, y); break;
    case 5: apm_mul(r, x, y); break;
    case 6: apm_mul_si(r, x, n); break;
    case 7: apm_scale(r, x, n); break;
    case 8: apm_round(r, x, n, dir); break;
    case 9: apm_floor(r, x); break;
    case 10: return apm_sqrt(r, x, n, dir);
    default: return apm_div(r, x, y, n, dir);
    }
    return APM_OK;
}

/* Which operation, its direction, x and y -> its results of x and y, where r is neither, x or y;
   and of x and x, where r is neither and where r is x. */
static int in_place(long dp, apm_t in[], apm_t out[])
{
    const int which = (int)apm_get_d(in[0]);
    const apm_round_t dir = directions[(int)apm_get_d(in[1])];
    const apm_struct *const x = in[2], *const y = in[3];
    int status = operate(which, out[0], x, y, dp, dir);

    apm_set(out[1], x);
    apm_set(out[2], y);
    apm_set(out[4], x);
    if (status == APM_OK)
        status = operate(which, out[1], out[1], y, dp, dir) ||
                 operate(which, out[2], x, out[2], dp, dir) ||
                 operate(which, out[3], x, x, dp, dir) ||
                 operate(which, out[4], out[4], out[4], dp, dir);
    return code_of(status);
}

/* Centre and half-width in units of pi -> the same in radians, with dp places of pi. */
static int region(long dp, apm_t in[], apm_t out[])
{
    apm_t pi;

    if (apm_sgn(in[1]) < 0)
        return CV_EARGUMENT;
    apm_init(pi);
    apm_pi(pi, dp);
    apm_set(out[0], in[0]);
    apm_set(out[1], in[1]);
    to_radians(out[0], out[1], pi, dp);
    apm_clear(pi);
    return CV_OK;
}

/* Centre, half-width and a shift by each of three parameters, of v0 in units of pi -> the same in
   radians. */
static int region_that_moves(long dp, apm_t in[], apm_t out[])
{
    patch p;
    apm_t pi;

    if (apm_sgn(in[1]) < 0)
        return CV_EARGUMENT;
    apm_init(pi);
    apm_pi(pi, dp);
    patch_init(&p);
    p.n_angles = 1;
    apm_set(p.angle[0], in[0]);
    apm_set(p.half[0], in[1]);
    for (int m = 0; m < PARAMETERS; m++)
        apm_set(p.shift[0][m], in[2 + m]);
    region_to_radians(&p, pi, dp);
    apm_set(out[0], p.angle[0]);
    apm_set(out[1], p.half[0]);
    for (int m = 0; m < PARAMETERS; m++)
        apm_set(out[2 + m], p.shift[0][m]);
    patch_clear(&p);
    apm_clear(pi);
    return CV_OK;
}

static int sine_and_cosine(long dp, apm_t in[], apm_t out[])
{
    double sine, cosine;

    (void)dp;
    double_sincos(&sine, &cosine, apm_nearest_d(in[0]));
    if (!isfinite(sine) || !isfinite(cosine))
        return CV_EARITHMETIC;
    apm_set_d(out[0], sine);
    apm_set_d(out[1], cosine);
    return CV_OK;
}

/* n, l, entries of a matrix -> is it above l, its least eigenvalue */
static int matrix(long dp, apm_t in[], apm_t out[])
{
    const int n = (int)apm_nearest_d(in[0]);
    double d[MOST_ENTRIES];

    (void)dp;
    if (n < 1 || n > 3)
        return CV_EARGUMENT;
    for (int i = 0; i < MOST_ENTRIES; i++)
        d[i] = apm_nearest_d(in[2 + i]);
    apm_set_d(out[0], sym_is_above(n, d, apm_nearest_d(in[1])) ? 1.0 : 0.0);
    apm_set_d(out[1], sym_least_eigenvalue(n, d));
    return CV_OK;
}

static int sines_ns(long dp, apm_t in[], apm_t out[]) /* x, n -> nanoseconds of three, n times */
{
    double t[3] = { apm_nearest_d(in[0]), 1.0, 2.0 }, cosine[3] = { 0.0, 0.0, 0.0 };
    const double repeat = apm_nearest_d(in[1]);
    const clock_t begin = clock();

    (void)dp;
    for (double j = 0.0; j < repeat && j < 1e9; j++)
        for (int k = 0; k < 3; k++)
            double_sincos(&t[k], &cosine[k], t[k] + cosine[k]);
    return code_of(apm_set_d(out[0], t[0] + t[1] + t[2] > 4.0
                                         ? 0.0          /* never: but t is used */
                                         : 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC /
                                               fmax(repeat, 1.0)));
}

/* The thesis's waves with the ranges lo <= hi of a, b, c with which `torus` and `cell` begin.  0:
   one is no range. */
static int parameter_ranges(apm_t in[], torus_wave waves[3])
{
    for (int j = 0; j < 3; j++) {
        waves[j] = (torus_wave){ { j != 1, j != 0 },
                                 { 0.0, 0.0 },
                                 { apm_bound_d(in[2 * j], APM_DOWN),
                                   apm_bound_d(in[2 * j + 1], APM_UP) } };
        if (apm_cmp(in[2 * j], in[2 * j + 1]) > 0)
            return 0;
    }
    return 1;
}

/* The bounds over the torus of trace and largest eigenvalue, T and B. */
static int torus(long dp, apm_t in[], apm_t out[])
{
    torus_wave waves[3];
    int status = APM_OK;

    (void)dp;
    if (!parameter_ranges(in, waves))
        return CV_EARGUMENT;
    for (int which = 0; which < 2 && status == APM_OK; which++)
        status = apm_set_d(out[which], torus_largest(2, 3, waves, which));
    return code_of(status);
}

/* Ranges, centre and half-widths of a rectangle -> the same over it, of beta at its mirror
   image. */
static int cell(long dp, apm_t in[], apm_t out[])
{
    torus_wave waves[3];
    double low[2], high[2];
    int status = APM_OK;

    (void)dp;
    for (int j = 0; j < 2; j++) {
        const interval centre = { apm_bound_d(in[6 + j], APM_DOWN),
                                  apm_bound_d(in[6 + j], APM_UP) };
        const double half = apm_bound_d(in[8 + j], APM_UP);
        low[j] = just_below(centre.low - half);
        high[j] = just_above(centre.high + half);
    }
    if (!parameter_ranges(in, waves) || apm_sgn(in[8]) < 0 || apm_sgn(in[9]) < 0)
        return CV_EARGUMENT;
    for (int which = 0; which < 2 && status == APM_OK; which++)
        status = apm_set_d(out[which], torus_rectangle(3, waves, which, low, high));
    return code_of(status);
}

static const struct {
    shape shape;
    routine *run;
} kernels[] = {
    { { "pi", 0, 1 }, pi },
    { { "add", 2, 1 }, add },
    { { "sub", 2, 1 }, sub },
    { { "mul", 2, 1 }, mul },
    { { "cmp", 2, 1 }, cmp },
    { { "div", 2, 3 }, divide },
    { { "sqrt", 1, 2 }, root },
    { { "round", 1, 3 }, rounded },
    { { "floor", 1, 1 }, integer_below },
    { { "scale", 2, 1 }, scale },
    { { "order", 1, 1 }, order },
    { { "guards", 0, 2 }, guards },
    { { "bounds", 1, 2 }, bounds },
    { { "in_place", 4, 5 }, in_place },
    { { "double", 1, 1 }, as_double },
    { { "region", 2, 2 }, region },
    { { "region_that_moves", 5, 5 }, region_that_moves },
    { { "double_sincos", 1, 2 }, sine_and_cosine },
    { { "matrix", 2 + MOST_ENTRIES, 2 }, matrix },
    { { "double_sincos_ns", 2, 1 }, sines_ns },
    { { "torus", 6, 2 }, torus },
    { { "cell", 10, 2 }, cell },
};

int numbers_answer(const question *q)
{
    for (size_t j = 0; j < sizeof kernels / sizeof *kernels; j++)
        if (asks_for(q, &kernels[j].shape))
            return kernels[j].run(q->dp, q->in, q->out);
    return NOT_MINE;
}
