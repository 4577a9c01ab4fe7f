/* loewner.c - the routines of csrc/loewner.  All take doubles only.

   They begin with a problem: the numbers of waves, at most 4, and of parameters; of each wave k,
   phase in radians, amplitude and three parts; centre and half-width of each angle, the frame, x*,
   and three shifts of each angle. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "console.h"
#include "hooks.h"

enum { WAVE = 5, MOST_SHOWN = 4 };      /* numbers of a wave; waves of a problem */
enum { SITES = 60 };                    /* no point of an orbit is further */
enum { SITE = 83, SHOWN = 13, CELL = 55 };
enum { MOST_MORE = 10, MOST_OUT = SITE * SHOWN };

/* What a routine is asked: the numbers after those of the problem. */
typedef struct {
    loewner *w;
    double more[MOST_MORE];
} request;

typedef int routine(const request *r, double y[]); /* 0: it cannot be done */

static const hooks *hooks_of(const loewner *w)
{
#define ROW(engine) { &engine, &hooks_##engine },
    static const struct {
        const engine *engine;
        const hooks *hooks;
    } table[] = { ENGINES(ROW) };
#undef ROW
    size_t j = 0;

    while (table[j].engine != w->engine)
        j++;
    return table[j].hooks;
}

static int follow(loewner *w, double s, double t)
{
    return hooks_of(w)->follow(w->work, w, (int)s, (int)t);
}

static void look(const loewner *w, double n, known_point *p)
{
    hooks_of(w)->look(w->work, (int)n, p);
}

/* The orbit of the root's prism from point n or 0 to point 0 or n. */
static int follow_to(loewner *w, double n) { return follow(w, fmin(n, 0.0), fmax(n, 0.0)); }

/* What is known of a point: returns where it ends. */
static double *show(double *y, const known_point *p)
{
    enum { slots = 2 + MOST_SHOWN };
    double lin[2][5], quad[2][15];
    const struct {
        const double *from;
        int count;
    } parts[] = {
        { p->x, 2 },
        { lin[0], 10 },
        { quad[0], 30 },
        { p->rem, 2 },
        { p->lin_bound, slots },
        { p->quad_bound, slots },
        { p->nonlin_bound, slots },
        { p->rad, slots },
        { p->residual, 2 },
        { p->force, 2 },
        { p->beta, 3 },
        { p->d, 3 },
        { &p->err_beta, 1 },
        { p->mu, 2 },
        { p->x_low, 2 },
    };

    for (int i = 0; i < 2; i++)
        for (int k = 0, kl = 0; k < 5; k++) {
            lin[i][k] = p->lin[i][k];
            for (int l = k; l < 5; l++)
                quad[i][kl++] = p->quad[i][sym_at(MOST_COLUMNS, k, l)];
        }
    for (size_t j = 0; j < sizeof parts / sizeof *parts; j++) {
        memcpy(y, parts[j].from, (size_t)parts[j].count * sizeof *y);
        y += parts[j].count;
    }
    return y;
}

static cv_cell cell_of(const request *r)
{
    cv_cell cell = { { 0 }, { 0 }, 0 };

    for (int j = 0; j < 5; j++) {
        cell.index[j] = (unsigned long long)fabs(r->more[j]);
        cell.cuts[j] = (int)fmin(fabs(r->more[5 + j]), 100.0);
    }
    return cell;
}

/* Halves of the angles of x_1: upper ones in 2^-32 turns, lower ones in 2^-64. */
static void show_x1(const loewner_cell *prism, double upper[2], double lower[2])
{
    for (int i = 0; i < 2; i++) {
        upper[i] = (double)(prism->x1[i] >> 32);
        lower[i] = (double)(prism->x1[i] & UINT32_MAX);
    }
}

/* Index and cuts of five axes -> upper halves of x_1, widths of v0, v1, three shifts of each, how
   many columns the prisms have, would a cut of each axis help, and the lower halves; of 4 waves
   that are there p, p_low, err_amp, and three parts each; l; B at the corners of the parameters,
   the lower end of the first parameter first. */
static int k_cell(const request *r, double y[])
{
    const cv_cell cell = cell_of(r);
    loewner_cell prism;
    const int good = loewner_prism(r->w, &cell, &prism);

    show_x1(&prism, y, y + 16);
    memcpy(y + 2, prism.width, 2 * sizeof *prism.width);
    memcpy(y + 4, prism.shift, 2 * sizeof *prism.shift);
    y[10] = r->w->columns;
    for (int axis = 0; axis < 5; axis++)
        y[11 + axis] = cut_helps(r->w, &cell, axis);
    y += 18;
    for (int slot = 2, j = 0; slot < r->w->waves && j < MOST_SHOWN; slot++, j++) {
        y[j] = prism.p[slot];
        y[MOST_SHOWN + j] = prism.p_low[slot];
        y[2 * MOST_SHOWN + j] = prism.err_amp[slot];
        memcpy(y + (3 + j) * MOST_SHOWN, prism.part[slot], PARAMETERS * sizeof *y);
    }
    y[7 * MOST_SHOWN] = prism.l;
    memcpy(y + 7 * MOST_SHOWN + 1, r->w->corner, sizeof r->w->corner);
    return good;
}

/* n, repeat -> the reaches of both coordinates of point n, ns per step and prism, prisms at
   once. */
static int k_step(const request *r, double y[])
{
    const double n = r->more[0], repeat = r->more[1];
    const clock_t begin = clock();
    known_point p;
    int good = 1;

    for (int j = 0; j < (int)repeat; j++)
        good = follow_to(r->w, n);
    look(r->w, n, &p);
    memcpy(y, p.rad, 2 * sizeof *y);
    y[2] = 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / fmax(repeat, 1.0) /
           fmax(fabs(n), 1.0) / r->w->engine->lanes;
    y[3] = r->w->engine->lanes;
    return good;
}

/* For the orbit of s..t: bound, l, index of the first site, number of sites (0: no witness), how
   much of the bound roundings are, the vectors n. */
static int bound_orbit(const request *r, int signs, double y[])
{
    double n[SITES][ANGLES] = { { 0.0 } };
    int first = 0;

    if (!follow(r->w, r->more[0], r->more[1]))
        return 0;
    y[3] = hooks_of(r->w)->bound(r->w->work, signs, &y[0], &y[1], &y[4], &first, n, SITES);
    y[2] = first;
    for (int j = 0, size = r->w->angles; j < SITES; j++)
        memcpy(y + 5 + size * j, n[j], (size_t)size * sizeof n[j][0]);
    return 1;
}

/* s, t, signs -> the same.  signs: 1: those of cubic terms count; 2: the sums of bound.c without
   roundings, with multipliers that are off; 3: of vectors that are 2^-300 times as long. */
static int k_bound(const request *r, double y[]) { return bound_orbit(r, (int)r->more[2], y); }

/* s, t, signs -> of each point of that orbit, at most 13: upper halves of 2 coordinates, 2 rows of
   5 columns, 2 bows of 15, 2 rests; for the coordinates and 4 waves the reach of columns, bows, all
   but the columns, and all; residual, force, beta, d, err_beta, mu, and the lower halves of the
   coordinates. */
static int k_sites(const request *r, double y[])
{
    double unused[5 + 2 * SITES] = { 0 }, *end = y;
    const int good = bound_orbit(r, (int)r->more[2], unused);

    for (int j = 0; j < SHOWN; j++) {
        known_point p;
        memset(&p, 0, sizeof p);
        if (r->more[0] + j <= fmax(r->more[1], 1.0))
            look(r->w, r->more[0] + j, &p);
        end = show(end, &p);
    }
    return good;
}

/* Upper and lower half of an angle -> the same of sine and cosine in 2^-62, the double next to the
   sine, and what that lacks. */
static int k_sincos(const request *r, double y[])
{
    int64_t s, c;

    hooks_of(r->w)->sincos((uint64_t)r->more[0] << 32 | (uint64_t)r->more[1], &s, &c, y + 4);
    y[0] = (double)(s >> 32);
    y[1] = (double)(s & UINT32_MAX);
    y[2] = (double)(c >> 32);
    y[3] = (double)(c & UINT32_MAX);
    return 1;
}

/* Upper and lower half of x0, n, mu -> high, low, p, p_low of the last wave. */
static int k_pull(const request *r, double y[])
{
    const uint64_t turns = (uint64_t)r->more[0] << 32 | (uint64_t)r->more[1];

    hooks_of(r->w)->pull(r->w->work, r->w, turns, r->more + 2, y);
    return 1;
}

static int k_sum(const request *r, double y[]) /* n, x */
{
    y[0] = hooks_of(r->w)->sum((int)r->more[0], r->more[1]);
    return 1;
}

static int k_largest(const request *r, double y[]) /* B */
{
    y[0] = loewner_largest(r->w);
    return 1;
}

/* angles: of the waves; bounds: with those over the torus, which take most of the time, where 0
   takes any_largest for them; first, others: what the absolute value of the first of the further
   numbers, and of the others, must be below. */
typedef struct {
    const char *name;
    int more, nout, angles, bounds;
    double first, others;
    routine *run;
} row;

static const row kernels[] = {
    { "waves_bound", 3, 5 + 2 * SITES, 2, 0, SITES, SITES, k_bound },
    { "waves_bound_1", 3, 5 + SITES, 1, 0, SITES, SITES, k_bound },
    { "waves_bound_3", 3, 5 + 3 * SITES, 3, 0, SITES, SITES, k_bound },
    { "waves_sites", 3, SITE * SHOWN, 2, 0, SITES, SITES, k_sites },
    { "waves_step", 2, 4, 2, 0, SITES, 1e9, k_step },
    { "waves_cell", 10, CELL, 2, 0, 0x1p60, 0x1p60, k_cell },
    { "waves_cell_of_l", 10, CELL, 2, 1, 0x1p60, 0x1p60, k_cell },
    { "waves_sincos", 2, 8, 2, 0, 0x1p33, 0x1p33, k_sincos },
    { "waves_pull", 6, 4, 2, 0, 0x1p33, 0x1p33, k_pull },
    { "waves_sum", 2, 1, 2, 0, 0x1p33, 0x1p33, k_sum },
    { "waves_largest", 0, 1, 2, 1, SITES, SITES, k_largest },
    { "waves_largest_3", 0, 1, 3, 1, SITES, SITES, k_largest },
};

/* ---- the problem, whose numbers are borrowed to read */

/* So many further numbers come after the patch.  0: the arguments are none. */
static int set_patch(patch *b, const question *q, int angles, int more)
{
    apm_t *const in = q->in;
    const int waves = q->nin < 2 ? 0 : (int)apm_get_d(in[0]);
    const int rest = 2 + (angles + WAVE) * waves, frame = rest + 2 * angles;
    const int star = frame + angles * angles, shifts = star + angles;
    const int parameters = q->nin < 2 ? 0 : (int)apm_get_d(in[1]);

    if (waves < 1 || waves > MOST_SHOWN || parameters < 0 || parameters > PARAMETERS ||
        q->nin != shifts + PARAMETERS * angles + more)
        return 0;
    memset(b, 0, sizeof *b);
    b->n_angles = angles;
    b->n_waves = waves;
    b->n_parameters = parameters;
    for (int i = 0; i < waves; i++) {
        apm_t *const wave = in + 2 + (angles + WAVE) * i;
        for (int j = 0; j < angles; j++)
            b->k[i][j] = (int)apm_get_d(wave[j]);
        *b->phase[i] = *wave[angles];
        *b->amplitude[i] = *wave[angles + 1];
        for (int m = 0; m < PARAMETERS; m++)
            *b->part[i][m] = *wave[angles + 2 + m];
    }
    for (int j = 0; j < angles; j++) {
        *b->angle[j] = *in[rest + 2 * j];
        *b->half[j] = *in[rest + 2 * j + 1];
        *b->xstar[j] = *in[star + j];
        for (int m = 0; m < PARAMETERS; m++)
            *b->shift[j][m] = *in[shifts + PARAMETERS * j + m];
    }
    for (int i = 0; i < ANGLES; i++)
        for (int j = 0; j < ANGLES; j++)
            b->frame[i][j] =
                i < angles && j < angles ? (int)apm_get_d(in[frame + angles * i + j]) : i == j;
    return 1;
}

/* ---- the answer */

/* B from the sizes of the waves alone: l is a number like any other to those that take this. */
static void any_largest(loewner *w)
{
    double B = 2.0;

    for (int i = 0; i < w->waves; i++) {
        double size = fabs(w->amplitude[i]);
        for (int m = 0; m < w->n_parameters; m++)
            size += fabs(w->part[i][m]);
        B += size * (w->k[i][0] * w->k[i][0] + w->k[i][1] * w->k[i][1] + w->k[i][2] * w->k[i][2]);
    }
    for (size_t j = 0; j < sizeof w->corner / sizeof *w->corner; j++)
        w->corner[j] = B;
}

static int run(const row *kernel, request *r, const patch *problem, const question *q)
{
    double y[MOST_OUT] = { 0 };
    int good;

    r->w = loewner_new(problem, MAX_POINTS);
    if (r->w == NULL)
        return CV_ENOMEM;
    (kernel->bounds ? loewner_bound_torus : any_largest)(r->w);
    hooks_of(r->w)->poison(r->w->work, r->w, -SITES, SITES);
    good = kernel->run(r, y);
    loewner_free(r->w);
    for (int j = 0; j < q->nout && good; j++)
        good = apm_set_d(q->out[j], y[j]) == APM_OK;
    return good ? CV_OK : CV_EARITHMETIC;
}

int loewner_answer(const question *q)
{
    const row *kernel = kernels, *const end = kernels + sizeof kernels / sizeof *kernels;
    request r = { 0 };
    patch problem;

    while (kernel < end && strcmp(q->name, kernel->name) != 0)
        kernel++;
    if (kernel == end)
        return NOT_MINE;
    if (q->nout != kernel->nout || !set_patch(&problem, q, kernel->angles, kernel->more))
        return CV_EARGUMENT;
    for (int j = 0; j < kernel->more; j++) {
        r.more[j] = apm_nearest_d(q->in[q->nin - kernel->more + j]);
        if (!(fabs(r.more[j]) < (j == 0 ? kernel->first : kernel->others)))
            return CV_EARITHMETIC;
    }
    return run(kernel, &r, &problem, q);
}
