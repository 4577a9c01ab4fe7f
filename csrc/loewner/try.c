/* try.c - one prism from beginning to end, and the problem it belongs to. */
#include <stdlib.h>
#include <string.h>

#include "prism.h"
#include "numbers/sine.h"
#include "torus.h"

enum { FINEST = 46 };                   /* cuts along one axis: then doubles run out */
enum { PATIENCE = 8 };                  /* tries follow each other by an eighth of the orbit */
static const double HOPELESS = 2.0;     /* times the least bound yet: longer orbits will not do */

/* ---- one prism */

/* B >= the largest eigenvalue over the torus for all parameters of the cell.  It is convex in the
   parameters, so along each edge of the root it lies below the straight line between the ends, and
   so below the product of these lines, which over a cell is largest at a corner.  The shares are
   exact, their products and the sum of 8 are off by 10 u, of which 2^-46 is 128. */
static double cell_largest(const loewner *w, const double low[3], const double high[3])
{
    const int axes = w->together ? 1 : 3;
    double largest = 0.0;

    for (int corner = 0; corner < 1 << axes; corner++) {
        double sum = 0.0;
        for (int root = 0; root < 1 << axes; root++) {
            double part = w->corner[root];
            for (int k = 0; k < axes; k++) {
                const double at = corner >> k & 1 ? high[k] : low[k];       /* 0 .. 1 */
                part *= root >> k & 1 ? at : 1.0 - at;
            }
            sum += part;
        }
        largest = larger(largest, sum);
    }
    return largest * (1.0 + 0x1p-46);
}

/* The prism of the cell.  0: it is too thin for doubles, or its parameters are too large. */
static int set_prism(loewner *w, const cv_cell *cell)
{
    double at[COLUMNS], part[COLUMNS], low[3], high[3], B;

    for (int k = 0; k < COLUMNS; k++) {
        if (cell->cuts[k] > FINEST)
            return 0;
        part[k] = ldexp(1.0, -cell->cuts[k]);
        at[k] = (2.0 * (double)cell->index[k] + 1.0) * part[k] - 1.0;       /* exact */
    }
    for (int i = 0; i < 2; i++) {
        w->v[i] = w->centre[i] + w->half[i] * at[i];
        w->width[i] = w->half[i] * part[i] + w->slack[i];
    }
    for (int i = 0; i < WAVES; i++) {
        const int axis = w->together ? 2 : 2 + i;
        w->p[i] = w->centre[2 + i] + w->half[2 + i] * at[axis];
        w->h[i] = w->half[2 + i] * part[axis];
        w->loose[i] = w->slack[2 + i];
        low[i] = 0.5 * (1.0 + at[axis] - part[axis]);
        high[i] = 0.5 * (1.0 + at[axis] + part[axis]);
    }
    B = cell_largest(w, low, high);
    w->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46);   /* off by 5 u before */
    return w->l > 0.0;
}

/* Tries to prove the prism with the orbit as far as it is known.  Returns whether at least its
   centre contradicts; then the bound's shares say why it failed, if it did. */
static int attempt(loewner *w, verdict *v)
{
    if (!witness(w))
        return 0;
    bound_second_variation(w, 0);
    v->nsteps = w->to - w->from + 1;
    v->no_tori = w->bound < 0.0;
    v->reason = w->bound - 2.0 * w->rounding < 0.0 ? CV_REASON_ARITHMETIC : CV_REASON_TOO_BIG;
    return 1;
}

/* Would cutting the cell across axis help?  Not where its width is the slack of doubles, but for
   a fifth of it. */
static int may_cut(const loewner *w, const cv_cell *cell, int axis)
{
    const int last = w->together && axis == 2 ? COLUMNS - 1 : axis;
    int wide = 0;

    for (int k = axis; k <= last; k++)
        wide = wide || ldexp(w->half[k], 2 - cell->cuts[axis]) > w->slack[k];
    return wide && cell->cuts[axis] < FINEST;
}

void loewner_try(loewner *w, const cv_cell *cell, verdict *v, int *axis, int *from)
{
    int points = 0, next = cell->from, contradicted = 0, worst = 0, why;
    double least = HUGE_VAL;

    memset(v, 0, sizeof *v);
    v->reason = CV_REASON_ARITHMETIC;
    *axis = -1;
    if (!set_prism(w, cell))
        return;
    orbit_begin(w);
    for (int more = 1; more;) {
        more = orbit_lengthen(w, &why);
        points += more;
        if (points >= next || !more) {
            if (attempt(w, v)) {
                if (v->no_tori)
                    return;
                if (!contradicted)
                    contradicted = points;
                if (w->bound > HOPELESS * least)
                    break;
                least = w->bound < least ? w->bound : least;
            }
            next = points + 1 + points / PATIENCE;
        }
    }
    v->nsteps = points;
    if (contradicted) {
        bound_shares(w);
    } else {                            /* blame whoever is widest at the ends */
        v->reason = why;
        contradicted = points;
        for (int k = 0; k < w->columns; k++) {
            w->share[k] = 0.0;
            for (int i = 0; i < 2; i++)
                if (size(w, i) > 0.0 || size(w, 2) > 0.0)
                    w->share[k] += fabs(w->orbit[w->last].column[i][k])
                                   + fabs(w->orbit[w->first].column[i][k]);
        }
    }
    for (int k = 1; k < w->columns; k++)
        if (w->share[k] > w->share[worst])
            worst = k;
    if (may_cut(w, cell, w->axis[worst]))
        *axis = w->axis[worst];
    else if (v->reason == CV_REASON_TOO_BIG)
        v->reason = CV_REASON_ARITHMETIC;
    *from = contradicted > 3 ? contradicted - 2 : 0;
}

/* ---- for tests */

int loewner_prism(loewner *w, const cv_cell *cell, loewner_cell *c)
{
    const int good = set_prism(w, cell);

    memcpy(c->v, w->v, sizeof c->v);
    memcpy(c->width, w->width, sizeof c->width);
    memcpy(c->p, w->p, sizeof c->p);
    memcpy(c->h, w->h, sizeof c->h);
    memcpy(c->loose, w->loose, sizeof c->loose);
    c->l = w->l;
    memcpy(c->corner, w->corner, sizeof c->corner);
    return good;
}

int loewner_follow(loewner *w, int s, int t)
{
    static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };

    set_prism(w, &whole);
    orbit_begin(w);
    w->last = ORIGIN + 1;
    while (w->last < ORIGIN + t)
        if (!orbit_step(w, 1))
            return 0;
    while (w->first > ORIGIN + s)
        if (!orbit_step(w, 0))
            return 0;
    return 1;
}

int loewner_bound(loewner *w, int signs, double *bound, double *l, double *rounding, int *first,
                  double n[][2], int most)
{
    *l = w->l;
    if (!witness(w) || w->to - w->from >= most)
        return 0;
    bound_second_variation(w, signs);
    *bound = w->bound;
    *rounding = w->rounding;
    *first = w->from - ORIGIN;
    for (int j = w->from; j <= w->to; j++)
        memcpy(n[j - w->from], w->orbit[j].n, sizeof n[0]);
    return w->to - w->from + 1;
}

void loewner_look(const loewner *w, int n, loewner_point *p)
{
    const point *q = w->orbit + ORIGIN + n;

    memset(p, 0, sizeof *p);
    memcpy(p->x, q->x, sizeof p->x);
    for (int i = 0; i < 2; i++)
        for (int k = 0, kl = 0; k < w->columns; k++) {
            p->column[i][w->axis[k]] = q->column[i][k];
            for (int l = k; l < w->columns; l++)
                p->bow[i][pair(COLUMNS, w->axis[k], w->axis[l])] = q->bow[i][kl++];
        }
    memcpy(p->rest, q->rest, sizeof p->rest);
    memcpy(p->straight, q->straight, sizeof p->straight);
    memcpy(p->bowed, q->bowed, sizeof p->bowed);
    memcpy(p->off, q->off, sizeof p->off);
    memcpy(p->reach, q->reach, sizeof p->reach);
    memcpy(p->missed, q->missed, sizeof p->missed);
    memcpy(p->force, q->force, sizeof p->force);
    memcpy(p->beta, q->beta, sizeof p->beta);
    memcpy(p->d, q->d, sizeof p->d);
    p->fuzz = q->fuzz;
    memcpy(p->mu, q->mu, sizeof p->mu);
}

/* ---- the problem */

/* A double d with |d - x| <= 2^-50 |x|, or else NaN, with which nothing is proved. */
static double near(const apm_t x)
{
    const double d = apm_nearest_d(x);
    apm_t error, scaled;
    int good;

    if (!isfinite(d))
        return NAN;
    apm_init(error);
    apm_init(scaled);
    apm_set_d(error, d);
    apm_sub(error, error, x);
    apm_set_d(scaled, 0x1p50);
    apm_mul(error, error, scaled);
    apm_abs(error, error);
    apm_abs(scaled, x);
    good = apm_cmp(error, scaled) <= 0;
    apm_clear(error);
    apm_clear(scaled);
    return good ? d : NAN;
}

loewner *loewner_new(const box *root, int together, int with_bounds)
{
    loewner *w = calloc(1, sizeof *w);

    if (w == NULL)
        return NULL;
    for (int k = 0; k < COLUMNS; k++) {
        const int axis = k < 2 ? 3 + k : k - 2;
        w->centre[k] = near(root->centre[axis]);
        w->half[k] = near(root->half[axis]);
        w->slack[k] = 0x1p-48 * (fabs(w->centre[k]) + w->half[k]);
    }
    for (int i = 0; i < 2; i++) {
        w->xstar[i] = near(root->xstar[i]);
        w->xstar_err[i] = 0x1p-49 * fabs(w->xstar[i]);
    }
    w->together = together;
    w->columns = 2;
    w->axis[1] = 1;
    for (int i = 0; i < WAVES; i++)     /* what does not move needs no symbol */
        if (w->half[2 + i] > 0.0) {
            if (!together || w->columns == 2)
                w->axis[w->columns++] = together ? 2 : 2 + i;
            w->symbol[i] = w->columns - 1;
        }
    for (int corner = 0; corner < (together ? 2 : 8); corner++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            const int upper = corner >> (together ? 0 : k) & 1;
            p[k] = w->centre[2 + k] + (upper ? 1.0 : -1.0) * w->half[2 + k];
        }
        w->corner[corner] = with_bounds ? torus_largest(p, p, TORUS_EIGENVALUE) : HUGE_VAL;
    }
    return w;
}

void loewner_free(loewner *w) { free(w); }

double loewner_largest(const loewner *w)
{
    const double low[3] = { 0, 0, 0 }, high[3] = { 1, 1, 1 };

    return cell_largest(w, low, high);
}

/* With n the eigenvector at the centre, n.beta n = 2|n|^2 - sum p sin(y) (n.u)^2 is linear in the
   parameters.  Its terms are off by 16 u for p and its half-width, (4 + |x0| + |x1|) u for the sine
   and 6 u, and 7 numbers are added: 33 + |x0| + |x1| units of the sum of absolute values, the mass;
   the margin is 256 (1 + |x0| + |x1|). */
int loewner_at_once(const loewner *w, const double x[2])
{
    double n[2], d[3], s[WAVES], c, sum, mass, omega[WAVES], p[WAVES];
    const double y[WAVES] = { x[0], x[1], x[0] + x[1] };

    for (int i = 0; i < WAVES; i++) {
        double_sincos(&s[i], &c, y[i]);
        p[i] = w->centre[2 + i] + (w->together ? w->half[2 + i] : 0.0);
    }
    d[0] = 2.0 - p[0] * s[0] - p[2] * s[2];
    d[1] = -p[2] * s[2];
    d[2] = 2.0 - p[1] * s[1] - p[2] * s[2];
    least_eigenvector(d, n);
    omega[0] = square(n[0]);
    omega[1] = square(n[1]);
    omega[2] = square(n[0] + n[1]);
    sum = mass = 4.0 / 3.0 * (omega[0] + omega[1]);     /* 2 |n|^2 less 2/3 |n|^2 */
    for (int i = 0; i < WAVES; i++) {
        sum -= p[i] * s[i] * omega[i];
        if (!w->together)
            sum += w->half[2 + i] * fabs(s[i]) * omega[i];
        mass += (fabs(p[i]) + w->half[2 + i] + w->slack[2 + i]) * omega[i];
    }
    return mass >= 1.0 && sum + 0x1p-45 * (1.0 + fabs(x[0]) + fabs(x[1])) * mass < 0.0;
}
