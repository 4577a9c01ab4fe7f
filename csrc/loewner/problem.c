/* problem.c - what belongs to all prisms of a problem, and the engine that is to try them. */
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "eigenvector.h"
#include "numbers/sine.h"
#include "problem.h"
#include "torus.h"

enum { ALIGNMENT = 64 };
enum { FINEST = 46 };                   /* cuts along one axis: then doubles run out */

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
                const double share = corner >> k & 1 ? high[k] : low[k];       /* 0 .. 1 */
                part *= root >> k & 1 ? share : 1.0 - share;
            }
            sum += part;
        }
        largest = larger(largest, sum);
    }
    return largest * (1.0 + 0x1p-46);
}

int loewner_prism(const loewner *w, const cv_cell *cell, loewner_cell *c)
{
    double at_axis[COLUMNS], part[COLUMNS], low[3], high[3], B;

    for (int k = 0; k < COLUMNS; k++) {
        if (cell->cuts[k] > FINEST)
            return 0;
        part[k] = ldexp(1.0, -cell->cuts[k]);
        at_axis[k] = (2.0 * (double)cell->index[k] + 1.0) * part[k] - 1.0;      /* exact */
    }
    for (int i = 0; i < 2; i++) {
        c->v[i] = w->centre[i] + w->half[i] * at_axis[i];
        c->width[i] = w->half[i] * part[i] + w->slack[i];
    }
    for (int i = 0; i < WAVES; i++) {
        const int axis = w->together ? 2 : 2 + i;
        c->p[i] = w->centre[2 + i] + w->half[2 + i] * at_axis[axis];
        c->h[i] = w->half[2 + i] * part[axis];
        c->loose[i] = w->slack[2 + i];
        low[i] = 0.5 * (1.0 + at_axis[axis] - part[axis]);
        high[i] = 0.5 * (1.0 + at_axis[axis] + part[axis]);
    }
    B = cell_largest(w, low, high);
    c->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46);   /* off by 5 u before */
    memcpy(c->corner, w->corner, sizeof c->corner);
    return c->l > 0.0;
}

/* Not where its width is the slack of doubles, but for a fifth of it. */
int may_cut(const loewner *w, const cv_cell *cell, int axis)
{
    const int last = w->together && axis == 2 ? COLUMNS - 1 : axis;
    int wide = 0;

    for (int k = axis; k <= last; k++)
        wide = wide || ldexp(w->half[k], 2 - cell->cuts[axis]) > w->slack[k];
    return wide && cell->cuts[axis] < FINEST;
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

/* The one with the most lanes that this machine can use; the environment variable CONVERSE_VECTORS
   may limit the bits of its vectors. */
static const engine *fastest_engine(void)
{
    const char *const limit = getenv("CONVERSE_VECTORS");
    const long bits = limit == NULL ? LONG_MAX : strtol(limit, NULL, 10);

#ifdef HAVE_X86
    if (bits >= 512 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        return &engine_avx512;
    if (bits >= 256 && __builtin_cpu_supports("avx2"))
        return &engine_avx2;
#endif
#ifdef HAVE_VECTORS
    if (bits >= 128)
        return &engine_baseline;
#endif
    (void)bits;
    return &engine_scalar;
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
    for (int i = 0; i < WAVES; i++) {
        w->present[i] = w->centre[2 + i] != 0.0 || w->half[2 + i] != 0.0;
        if (w->half[2 + i] > 0.0) {     /* what does not move needs no symbol */
            if (!together || w->columns == 2)
                w->axis[w->columns++] = together ? 2 : 2 + i;
            w->symbol[i] = w->columns - 1;
        }
    }
    for (int corner = 0; corner < (together ? 2 : 8); corner++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            const int upper = corner >> (together ? 0 : k) & 1;
            p[k] = w->centre[2 + k] + (upper ? 1.0 : -1.0) * w->half[2 + k];
        }
        w->corner[corner] = with_bounds ? torus_largest(p, p, TORUS_EIGENVALUE) : HUGE_VAL;
    }
    w->engine = fastest_engine();
    w->memory = calloc(1, w->engine->size + ALIGNMENT);
    if (w->memory == NULL) {
        free(w);
        return NULL;
    }
    w->work = w->memory + (ALIGNMENT - (uintptr_t)w->memory % ALIGNMENT);
    return w;
}

void loewner_free(loewner *w)
{
    if (w != NULL)
        free(w->memory);
    free(w);
}

int loewner_lanes(const loewner *w) { return w->engine->lanes; }

void loewner_try(loewner *w, int n, const cv_cell *const cells[], loewner_outcome *const out[])
{
    w->engine->try(w->work, w, n, cells, out);
}

void loewner_soil(loewner *w, int s, int t) { w->engine->soil(w->work, s, t); }

int loewner_follow(loewner *w, int s, int t) { return w->engine->follow(w->work, w, s, t); }

int loewner_bound(loewner *w, int signs, double *bound, double *l, double *rounding, int *first,
                  double n[][2], int most)
{
    return w->engine->bound(w->work, signs, bound, l, rounding, first, n, most);
}

void loewner_look(const loewner *w, int n, loewner_point *p) { w->engine->look(w->work, n, p); }

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
