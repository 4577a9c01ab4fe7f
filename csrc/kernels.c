/* kernels.c - one routine at a time, from decimal strings to decimal strings. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "loewner/loewner.h"
#include "arith/guard.h"
#include "arith/special.h"
#include "arith/sine.h"
#include "thesis/unit.h"
#include "model/torus.h"

enum { MAX_DP = 100000, MAX_IN = 64, MAX_OUT = 900 };
enum { WAVE = 7, MOST_SHOWN = 4 };      /* numbers of a wave; waves of a kernel's potential */

/* The operations of apm.h and special.h, which stand below num_t.
   pi: -> pi          add, sub, mul: x, y -> r       cmp: x, y -> -1, 0 or 1
   div: x, y -> quotient rounded down, up, towards zero
   sqrt: x -> root rounded down, up                  round: x -> down, up, towards zero
   floor: x -> r      scale: x, n -> x 10^n          order: x -> apm_order
   double: x -> the double apm_get_d makes of it, exactly
   region: centre, half in units of pi -> the same in radians, with dp places of pi */
static int apm_kernel(const char *name, long dp, int nin, apm_t in[], int nout, apm_t out[])
{
    static const struct { const char *name; int nin, nout; } shapes[] = {
        { "pi", 0, 1 }, { "add", 2, 1 }, { "sub", 2, 1 }, { "mul", 2, 1 }, { "cmp", 2, 1 },
        { "div", 2, 3 }, { "sqrt", 1, 2 }, { "round", 1, 3 }, { "floor", 1, 1 },
        { "scale", 2, 1 }, { "order", 1, 1 }, { "double", 1, 1 },
        { "region", 2, 2 }
    };
    static const apm_round_t directions[3] = { APM_DOWN, APM_UP, APM_TRUNC };
    size_t which = 0;
    int status = APM_OK;
    double places;

    while (which < sizeof shapes / sizeof *shapes && strcmp(name, shapes[which].name) != 0)
        which++;
    if (which == sizeof shapes / sizeof *shapes || nin != shapes[which].nin ||
        nout != shapes[which].nout)
        return CV_EARGUMENT;
    switch (which) {
    case 0: apm_pi(out[0], dp); break;
    case 1: apm_add(out[0], in[0], in[1]); break;
    case 2: apm_sub(out[0], in[0], in[1]); break;
    case 3: apm_mul(out[0], in[0], in[1]); break;
    case 4: apm_set_si(out[0], apm_cmp(in[0], in[1]), 0); break;
    case 5:
        for (int j = 0; j < 3 && status == APM_OK; j++)
            status = apm_div(out[j], in[0], in[1], dp, directions[j]);
        break;
    case 6:
        for (int j = 0; j < 2 && status == APM_OK; j++)
            status = apm_sqrt(out[j], in[0], dp, directions[j]);
        break;
    case 7:
        for (int j = 0; j < 3; j++)
            apm_round(out[j], in[0], dp, directions[j]);
        break;
    case 8: apm_floor(out[0], in[0]); break;
    case 9:
        places = apm_get_d(in[1]);
        if (!(fabs(places) <= APM_MAX_EXP))
            return CV_EARGUMENT;
        apm_scale(out[0], in[0], (long)places);
        break;
    case 10: apm_set_si(out[0], apm_order(in[0]), 0); break;
    case 11: status = apm_set_d(out[0], apm_get_d(in[0])); break;
    default: {
        apm_t pi;
        if (apm_sgn(in[1]) < 0)
            return CV_EARGUMENT;
        apm_init(pi);
        apm_pi(pi, dp);
        apm_set(out[0], in[0]);
        apm_set(out[1], in[1]);
        to_radians(out[0], out[1], pi, dp);
        apm_clear(pi);
    }
    }
    return status == APM_OK ? CV_OK : CV_EARITHMETIC;
}

/* The routines of sine.h: double_sincos: x -> sine, cosine; double_sincos_ns: x, repeat -> ns of
   three. */
static int sine_kernel(const char *name, int nin, apm_t in[], int nout, apm_t out[])
{
    double t[3] = { 0.0, 1.0, 2.0 }, cosine[3] = { 0.0, 0.0, 0.0 };

    if (strcmp(name, "double_sincos") == 0 && nin == 1 && nout == 2) {
        double_sincos(&t[0], &cosine[0], apm_nearest_d(in[0]));
        if (!isfinite(t[0]) || !isfinite(cosine[0]))
            return CV_EARITHMETIC;
        apm_set_d(out[0], t[0]);
        apm_set_d(out[1], cosine[0]);
        return CV_OK;
    }
    if (strcmp(name, "double_sincos_ns") == 0 && nin == 2 && nout == 1) {
        const double repeat = apm_nearest_d(in[1]);
        const clock_t begin = clock();
        t[0] = apm_nearest_d(in[0]);
        for (double j = 0.0; j < repeat && j < 1e9; j++)
            for (int k = 0; k < 3; k++)
                double_sincos(&t[k], &cosine[k], t[k] + cosine[k]);
        return apm_set_d(out[0], t[0] + t[1] + t[2] > 4.0 ? 0.0         /* never: but t is used */
                         : 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / fmax(repeat, 1.0))
               == APM_OK ? CV_OK : CV_EARITHMETIC;
    }
    return CV_EARGUMENT;
}

/* The bounds over the torus, of trace and largest eigenvalue, for ranges lo <= hi of a, b, c:
   torus: these -> T, B; cell: these, centre and half-widths of a rectangle -> the same over it, of
   beta at its mirror image, but for roundings. */
static int torus_kernel(const char *name, int nin, apm_t in[], int nout, apm_t out[])
{
    const int cell = strcmp(name, "cell") == 0;
    double x[10], low[3], high[3];

    if ((!cell && strcmp(name, "torus") != 0) || nin != (cell ? 10 : 6) || nout != 2)
        return CV_EARGUMENT;
    for (int j = 0; j < nin; j++)
        x[j] = apm_nearest_d(in[j]);
    for (int j = 0; j < 3; j++) {
        low[j] = x[2 * j];
        high[j] = x[2 * j + 1];
        if (apm_cmp(in[2 * j], in[2 * j + 1]) > 0)
            return CV_EARGUMENT;
    }
    if (cell && (apm_sgn(in[8]) < 0 || apm_sgn(in[9]) < 0))
        return CV_EARGUMENT;
    for (int which = 0; which < 2; which++)
        if (apm_set_d(out[which], cell ? torus_rectangle(low, high, x + 6, x + 8, which)
                                       : torus_largest(low, high, which)) != APM_OK)
            return CV_EARITHMETIC;
    return CV_OK;
}

/* The orbit of the root's prism from point n or 0 to point 0 or n. */
static int follow_to(loewner *w, double n)
{
    return loewner_follow(w, n < 0.0 ? (int)n : 0, n > 0.0 ? (int)n : 0);
}

/* The patch of a loewner kernel's arguments, which it borrows to read, and so it does a zero. */
static void set_patch(patch *b, apm_t in[], int together, const apm_t zero)
{
    memset(b, 0, sizeof *b);
    b->n_waves = 3;
    b->n_parameters = together ? 1 : 3;
    b->frame[0] = b->frame[3] = 1;
    for (int i = 0; i < 3; i++) {
        b->k[i][0] = i != 1;
        b->k[i][1] = i != 0;
        *b->phase[i] = *zero;
        *b->amplitude[i] = *in[i];
        for (int m = 0; m < b->n_parameters; m++)
            *b->part[i][m] = together || m == i ? *in[5 + i] : *zero;
    }
    for (int i = 0; i < 2; i++) {
        *b->angle[i] = *in[3 + i];
        *b->half[i] = *in[8 + i];
        *b->xstar[i] = *in[10 + i];
    }
}

/* The same of any waves.  0: the arguments are no patch. */
static int set_waves(patch *b, apm_t in[], int nin, int waves, int parameters)
{
    const int rest = 2 + WAVE * waves;

    if (waves < 1 || waves > MOST_SHOWN || parameters < 0 || parameters > PARAMETERS ||
        nin < rest + 10)
        return 0;
    memset(b, 0, sizeof *b);
    b->n_waves = waves;
    b->n_parameters = parameters;
    for (int i = 0; i < waves; i++) {
        apm_t *const wave = in + 2 + WAVE * i;
        for (int j = 0; j < 2; j++)
            b->k[i][j] = (int)apm_get_d(wave[j]);
        *b->phase[i] = *wave[2];
        *b->amplitude[i] = *wave[3];
        for (int m = 0; m < PARAMETERS; m++)
            *b->part[i][m] = *wave[4 + m];
    }
    for (int j = 0; j < 2; j++) {
        *b->angle[j] = *in[rest + 2 * j];
        *b->half[j] = *in[rest + 2 * j + 1];
        *b->xstar[j] = *in[rest + 8 + j];
    }
    for (int j = 0; j < 4; j++)
        b->frame[j] = (int)apm_get_d(in[rest + 4 + j]);
    return 1;
}

/* What is known of a point, of so many slots: returns where it ends. */
static double *show(double *y, const loewner_point *p, int slots)
{
    const struct { const double *from; int count; } parts[] = {
        { p->x, 2 }, { p->column[0], 10 }, { p->bow[0], 30 }, { p->rest, 2 },
        { p->straight, slots }, { p->bowed, slots }, { p->off, slots }, { p->reach, slots },
        { p->missed, 2 }, { p->force, 2 }, { p->beta, 3 }, { p->d, 3 }, { &p->fuzz, 1 },
        { p->mu, 2 }
    };

    for (size_t j = 0; j < sizeof parts / sizeof *parts; j++) {
        memcpy(y, parts[j].from, (size_t)parts[j].count * sizeof *y);
        y += parts[j].count;
    }
    return y;
}

/* The routines of loewner.h; all take doubles only, and begin with centres and half-widths of a, b,
   c, v0, v1, x* and together (0 or 1).
   loewner_cell: ..., index and cuts of five axes -> centres and widths of v0, v1; p, h and loose
                 of a, b, c; l; B at the corners (together: at two), the lower end of a first
   loewner_orbit: ..., n -> 2 coordinates, 2 rows of 5 columns, 2 bows of 15, 2 rests of point n,
                  and for 3 waves the reach of columns, bows, all but the columns, and all
   loewner_bound: ..., s, t, signs -> bound, l, index of the first site, number of sites (0: no
                  witness), how much of the bound roundings are, the vectors n; for the orbit of
                  s..t.  signs: those of cubic terms count
   loewner_sites: ..., s, t -> of each point of that orbit, at most 13, what loewner_orbit tells,
                  and missed, force, beta, d, fuzz and mu
   loewner_step: ..., n, repeat -> the reaches of both coordinates of point n, ns per step and prism,
                 prisms at once
   waves_bound, waves_sites: the same of at most 4 waves; they begin with the numbers of waves and of
                 parameters, seven numbers of each wave, k0, k1, phase in radians, amplitude and three
                 parts, centre and half-width of v0 and of v1, the frame and x*.  Of a point there are
                 the reaches of the coordinates and of 4 waves; at most 11 points
   waves_largest: as these -> B */
static int loewner_kernel(const char *name, int nin, apm_t in[], int nout, apm_t out[])
{
    enum { BOX = 13, POINT = 56, SITE = 69, SITES = 60, SHOWN = 13, ANY_SITE = 81, ANY_SHOWN = 11 };
    enum { CELL, ORBIT, BOUND, ALL, STEP, ANY_BOUND, ANY_ALL, LARGEST, N_SHAPES };
    static const struct { const char *name; int more, nout; } shapes[N_SHAPES] = {
        { "loewner_cell", 10, 22 }, { "loewner_orbit", 1, POINT },
        { "loewner_bound", 3, 5 + 2 * SITES }, { "loewner_sites", 2, SITE * SHOWN },
        { "loewner_step", 2, 4 }, { "waves_bound", 3, 5 + 2 * SITES },
        { "waves_sites", 2, ANY_SITE * ANY_SHOWN }, { "waves_largest", 0, 1 }
    };
    double x[MAX_IN], y[MAX_OUT] = { 0 }, n[SITES][2] = { { 0.0, 0.0 } };
    const double *more;
    int which = 0, first = 0, good = 1, any;
    cv_cell cell = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };
    loewner_cell prism;
    loewner_point p;
    loewner *w;
    clock_t begin;
    patch b;
    apm_t zero;

    while (which < N_SHAPES && strcmp(name, shapes[which].name) != 0)
        which++;
    any = which >= ANY_BOUND;
    if (which == N_SHAPES || nout != shapes[which].nout)
        return CV_EARGUMENT;
    for (int j = 0; j < nin; j++)
        x[j] = apm_nearest_d(in[j]);
    if (any ? nin < 2 || !set_waves(&b, in, nin, (int)x[0], (int)x[1]) ||
              nin != 12 + WAVE * b.n_waves + shapes[which].more
            : nin != BOX + shapes[which].more)
        return CV_EARGUMENT;
    more = x + nin - shapes[which].more;
    for (int j = 0; j < shapes[which].more; j++)
        good = good && fabs(more[j]) < (which == CELL ? 0x1p60
                                        : which == STEP && j > 0 ? 1e9 : SITES);
    if (!good)
        return CV_EARITHMETIC;
    apm_init(zero);
    if (!any)
        set_patch(&b, in, x[12] != 0.0, zero);
    w = loewner_new(&b, which != ORBIT && which != STEP);
    apm_clear(zero);
    if (w == NULL)
        return CV_ENOMEM;
    if (which != STEP && which != LARGEST)
        loewner_soil(w, -SITES, SITES);
    switch (which) {
    case CELL:
        for (int j = 0; j < 5; j++) {
            cell.index[j] = (unsigned long long)fabs(more[j]);
            cell.cuts[j] = (int)fmin(fabs(more[5 + j]), 100.0);
        }
        good = loewner_prism(w, &cell, &prism);
        memcpy(y, prism.v, sizeof prism.v);
        memcpy(y + 2, prism.width, sizeof prism.width);
        for (int j = 0; j < 3; j++) {
            y[4 + j] = prism.p[j];
            y[7 + j] = prism.part[j][x[12] != 0.0 ? 0 : j];
            y[10 + j] = prism.loose[j];
        }
        y[13] = prism.l;
        memcpy(y + 14, prism.corner, sizeof prism.corner);
        break;
    case ORBIT:
        good = follow_to(w, more[0]);
        loewner_look(w, (int)more[0], &p);
        show(y, &p, 3);
        break;
    case STEP:
        begin = clock();
        for (int j = 0; j < (int)more[1]; j++)
            good = follow_to(w, more[0]);
        loewner_look(w, (int)more[0], &p);
        y[0] = p.reach[0];
        y[1] = p.reach[1];
        y[2] = 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / fmax(more[1], 1.0)
               / fmax(fabs(more[0]), 1.0) / loewner_lanes(w);
        y[3] = loewner_lanes(w);
        break;
    case LARGEST:
        y[0] = loewner_largest(w);
        break;
    default:
        good = loewner_follow(w, (int)more[0], (int)more[1]);
        y[3] = good ? loewner_bound(w, which == ALL || which == ANY_ALL || more[2] != 0.0, &y[0],
                                    &y[1], &y[4], &first, n, SITES) : 0;
        y[2] = first;
        memcpy(y + 5, n, sizeof n);
        if (which == ALL || which == ANY_ALL) {
            double *end = y;
            for (int j = 0; j < (any ? ANY_SHOWN : SHOWN); j++) {
                memset(&p, 0, sizeof p);
                if (more[0] + j <= fmax(more[1], 1.0))
                    loewner_look(w, (int)more[0] + j, &p);
                end = show(end, &p, any ? 2 + MOST_SHOWN : 3);
            }
        }
    }
    loewner_free(w);
    for (int j = 0; j < nout && good; j++) {
        if (apm_set_d(out[j], y[j]) != APM_OK)
            return CV_EARITHMETIC;
    }
    return good ? CV_OK : CV_EARITHMETIC;
}

/* What cv_kernel was asked, and has. */
typedef struct {
    const char *name, *const *in;
    char **out;
    int as_double, as_printed, dp, nin, nout, status;
    apm_t x[MAX_IN + MAX_OUT];
    Runit *exact;
    unit *quick;
} question;

static void answer(void *data)
{
    question *const q = data;
    const char *const name = q->name;
    const int nin = q->nin, nout = q->nout;
    apm_t *const x = q->x;
    int status = CV_OK;

    q->status = CV_ENOMEM;
    for (int j = 0; j < nin; j++)
        if (apm_set_str(x[j], q->in[j]) != APM_OK)
            status = CV_ENUMBER;
    if (status == CV_OK)
        status = apm_kernel(name, q->dp, nin, x, nout, x + MAX_IN);
    if (status == CV_EARGUMENT)
        status = sine_kernel(name, nin, x, nout, x + MAX_IN);
    if (status == CV_EARGUMENT)
        status = loewner_kernel(name, nin, x, nout, x + MAX_IN);
    if (status == CV_EARGUMENT)
        status = torus_kernel(name, nin, x, nout, x + MAX_IN);
    if (status == CV_EARGUMENT && q->as_double) {
        q->quick = unit_new(q->dp, q->as_printed);
        status = q->quick == NULL ? CV_ENOMEM : kernel(q->quick, name, nin, x, nout, x + MAX_IN);
    } else if (status == CV_EARGUMENT) {
        q->exact = Runit_new(q->dp, q->as_printed);
        status = q->exact == NULL ? CV_ENOMEM : Rkernel(q->exact, name, nin, x, nout, x + MAX_IN);
    }
    for (int j = 0; j < nout && status == CV_OK; j++) {
        q->out[j] = apm_get_str(x[MAX_IN + j]);
        if (q->out[j] == NULL)
            status = CV_ENOMEM;
    }
    q->status = status;
}

int cv_kernel(const char *name, int as_double, int as_printed, int dp,
              int nin, const char *const in[], int nout, char *out[])
{
    question q = { .name = name, .in = in, .out = out, .as_double = as_double,
                   .as_printed = as_printed, .dp = dp, .nin = nin, .nout = nout };

    if (nin < 0 || nin > MAX_IN || nout < 0 || nout > MAX_OUT || dp < 1 || dp > MAX_DP)
        return CV_EARGUMENT;
    for (int j = 0; j < nout; j++)
        out[j] = NULL;
    for (int j = 0; j < MAX_IN + MAX_OUT; j++)
        apm_init(q.x[j]);
    guard_run(answer, &q, NULL);
    for (int j = 0; j < nout && q.status != CV_OK; j++) {
        free(out[j]);
        out[j] = NULL;
    }
    if (q.status != CV_ENOMEM) {        /* after that the numbers are abandoned: guard.c */
        Runit_free(q.exact);
        unit_free(q.quick);
        for (int j = 0; j < MAX_IN + MAX_OUT; j++)
            apm_clear(q.x[j]);
    }
    return q.status;
}
