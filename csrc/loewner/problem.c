/* problem.c - what belongs to all prisms of a problem, and the engine that is to try them. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "arith/sine.h"
#include "arith/sym2.h"
#include "problem.h"
#include "model/torus.h"

enum { ALIGNMENT = 64 };
enum { MAX_CUTS = 46 };                 /* cuts along one axis: then doubles run out */

/* ---- one prism */

/* B >= the largest eigenvalue over the torus for all parameters of the cell.  It is convex in the
   parameters, so along each edge of the root it lies below the straight line between the ends, and
   so below the product of these lines, which over a cell is largest at a corner.  The shares are
   exact, their products and the sum of 8 are off by 10 u, of which 2^-46 is 128. */
static double cell_largest(const loewner *w, const double low[3], const double high[3])
{
    const int axes = w->n_parameters;
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

    memset(c, 0, sizeof *c);
    for (int k = 0; k < COLUMNS; k++) {
        if (cell->cuts[k] > MAX_CUTS)
            return 0;
        part[k] = ldexp(1.0, -cell->cuts[k]);
        at_axis[k] = (2.0 * (double)cell->index[k] + 1.0) * part[k] - 1.0;      /* exact */
    }
    for (int i = 0; i < 2; i++) {
        c->v[i] = w->centre[i] + w->half[i] * at_axis[i];
        c->width[i] = w->half[i] * part[i] + w->err_v[i];
        for (int m = 0; m < w->n_parameters; m++) {
            c->v[i] += w->shift[i][m] * at_axis[2 + m];
            c->shift[i][m] = w->shift[i][m] * part[2 + m];
        }
    }
    for (int m = 0; m < w->n_parameters; m++) {
        low[m] = 0.5 * (1.0 + at_axis[2 + m] - part[2 + m]);
        high[m] = 0.5 * (1.0 + at_axis[2 + m] + part[2 + m]);
    }
    for (int i = 0; i < w->waves; i++) {
        c->p[i] = w->amplitude[i];
        for (int m = 0; m < w->n_parameters; m++) {
            c->p[i] += w->part[i][m] * at_axis[2 + m];
            c->part[i][m] = w->part[i][m] * part[2 + m];
        }
        c->err_amp[i] = w->err_amp[i];
    }
    B = cell_largest(w, low, high);
    c->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46);   /* off by 5 u before */
    return c->l > 0.0;
}

/* Not where the rounding of doubles makes four fifths of its width or more. */
int cut_helps(const loewner *w, const cv_cell *cell, int axis)
{
    int wide = axis < 2 && ldexp(w->half[axis], 2 - cell->cuts[axis]) > w->err_v[axis];

    for (int i = 0; i < w->waves && axis >= 2; i++)
        wide = wide || ldexp(fabs(w->part[i][axis - 2]), 2 - cell->cuts[axis]) > w->err_amp[i];
    for (int i = 0; i < 2 && axis >= 2; i++)
        wide = wide || ldexp(fabs(w->shift[i][axis - 2]), 2 - cell->cuts[axis]) > w->err_v[i];
    return wide && cell->cuts[axis] < MAX_CUTS;
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

/* The engine with the most lanes that this machine can use.  The environment variable
   CONVERSE_LANES limits that number, as tests compare the engines. */
static const engine *fastest_engine(void)
{
#ifdef __x86_64__
    const char *const limit = getenv("CONVERSE_LANES");
    const long lanes = limit == NULL ? MOST_LANES : strtol(limit, NULL, 10);

    if (lanes >= 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        return &engine_8;
    if (lanes >= 4 && __builtin_cpu_supports("avx2"))
        return &engine_4;
#endif
    return &engine_2;
}

/* A double that is not less than x >= 0. */
static double above(const apm_t x)
{
    return apm_sgn(x) == 0 ? 0.0 : apm_nearest_d(x) * (1.0 + 0x1p-50) + 0x1p-1070;
}

/* The angles, and x*.  With S the sum of |shift|, in units u: centre, half and shifts are off by 8
   of themselves (near), products with shares of a cell, |at_axis| + part <= 1, by 1, those with
   part by nothing, and the at most 4 sums by 1 each of (|centre| + half + S).  So v and width and
   shifts of a cell are off by 13 of that, width by 1 more of itself and err_v, where err_v has 32.
   x_1 = frame v, and the columns frame width and frame shift, are off by less than 2 |frame| v, 1
   |frame| half and 2 |frame| S, of which off has 8 of (|centre| + half + S), but for the identity,
   which is exact; v and width take in that, too, and what the radians are off, for other points'
   links end at a prism's sides. */
static void set_angles(loewner *w, const patch *problem)
{
    const int *const f = problem->frame;
    const double det = abs(f[0] * f[3] - f[1] * f[2]);
    double off[2] = { 0.0, 0.0 }, size[2];

    w->n_parameters = problem->n_parameters;
    for (int i = 0; i < 2; i++) {
        w->centre[i] = near(problem->angle[i]);
        w->half[i] = near(problem->half[i]);
        size[i] = fabs(w->centre[i]) + w->half[i];
        for (int m = 0; m < w->n_parameters; m++) {
            w->shift[i][m] = near(problem->shift[i][m]);
            size[i] += fabs(w->shift[i][m]);
        }
        w->err_v[i] = 0x1p-48 * size[i] + above(problem->off[i]);
        w->xstar[i] = near(problem->xstar[i]);
        w->xstar_err[i] = 0x1p-49 * fabs(w->xstar[i]);
        for (int k = 0; k < 2; k++)
            w->frame[i][k] = f[2 * i + k];
    }
    w->seen[0][0] = w->seen[1][1] = 1.0;
    for (int i = 0; i < 2 && !is_identity(f); i++)
        for (int k = 0; k < 2; k++)
            off[i] += 0x1p-50 * fabs(w->frame[i][k]) * size[k];
    for (int i = 0; i < 2; i++)         /* |frame^-1| off */
        w->err_v[i] +=
            (fabs(w->frame[1 - i][1 - i]) * off[i] + fabs(w->frame[i][1 - i]) * off[1 - i]) / det;
}

/* One more wave, if it is there at all. */
static void add_wave(loewner *w, const patch *problem, int given)
{
    const int i = w->waves, *const k = problem->k[given];
    double size;

    w->amplitude[i] = near(problem->amplitude[given]);
    size = fabs(w->amplitude[i]);
    for (int m = 0; m < w->n_parameters; m++) {
        w->part[i][m] = near(problem->part[given][m]);
        size += fabs(w->part[i][m]);
    }
    w->phase[i] = near(problem->phase[given]);
    w->err_amp[i] = 0x1p-48 * size;
    w->present[i] = size != 0.0;
    for (int j = 0; j < 2; j++)
        w->k[i][j] = k[j];
    w->square_k[i] = square(fabs(w->k[i][0]) + fabs(w->k[i][1]));
    w->most_k = larger(w->most_k, fabs(w->k[i][0]) + fabs(w->k[i][1]));
    w->waves += w->present[i];
}

/* The waves, and the columns of the parameters that move them or the region. */
static void set_wave_slots(loewner *w, const patch *problem)
{
    w->columns = 2;
    w->axis[1] = 1;
    w->most_k = 1.0;
    w->k[0][0] = w->k[1][1] = 1.0;
    w->waves = 2;
    for (int i = 0; i < problem->n_waves; i++)
        add_wave(w, problem, i);
    for (int m = 0; m < w->n_parameters; m++) {         /* what does not move needs no symbol */
        int counts = w->shift[0][m] != 0.0 || w->shift[1][m] != 0.0;
        for (int i = 0; i < w->waves; i++) {
            w->moves[i][w->columns] = w->part[i][m] != 0.0;
            counts |= w->moves[i][w->columns];
        }
        if (counts)
            w->axis[w->columns++] = 2 + m;
    }
}

/* Where all waves are m q, q primitive, s = q.x moves by itself: s' = 2s - s(o) + |q|^2 sum m p cos
   y, and vectors n = q nu make of Q |q|^2 times what it is for waves (m, 0) of amplitude |q|^2 p at
   s.  So these may be taken for them, if the frame tells s apart: then s_1 is a multiple of v1,
   with what shifts it, and v0 is not felt.  s* = q.x* and the products with |q|^2 are rounded by u
   or two more. */
static void straighten(loewner *w)
{
    const double *const k = w->k[2], common = divisor(fabs(k[0]), fabs(k[1]));
    const double q[2] = { k[0] / common, k[1] / common }, scale = q[0] * q[0] + q[1] * q[1];
    const double s[2] = { q[0] * w->xstar[0], q[1] * w->xstar[1] };
    int good = w->waves > 2 && q[0] * w->frame[0][0] + q[1] * w->frame[1][0] == 0.0;

    for (int i = 2; i < w->waves; i++)
        good = good && w->k[i][0] * q[1] == w->k[i][1] * q[0];
    if (!good)
        return;
    w->xstar[0] = s[0] + s[1];
    w->xstar_err[0] = 0x1p-49 * (fabs(s[0]) + fabs(s[1]));
    w->xstar[1] = w->xstar_err[1] = 0.0;
    w->frame[0][1] = q[0] * w->frame[0][1] + q[1] * w->frame[1][1];
    w->frame[1][0] = 1.0;
    w->frame[0][0] = w->frame[1][1] = 0.0;
    w->most_k = 1.0;
    for (int i = 2; i < w->waves; i++) {
        w->amplitude[i] *= scale;
        for (int m = 0; m < w->n_parameters; m++)
            w->part[i][m] *= scale;
        w->err_amp[i] *= scale;
        w->k[i][0] = (w->k[i][0] * q[0] + w->k[i][1] * q[1]) / scale;
        w->k[i][1] = 0.0;
        w->square_k[i] = square(w->k[i][0]);
        w->most_k = larger(w->most_k, fabs(w->k[i][0]));
    }
    for (int i = 0; i < 2; i++) {
        w->seen[0][i] = q[i];
        w->seen[1][i] = 0.0;
    }
}

/* The axes in which remainders are bounded (orbit.c: step): along k of the wave that bends most,
   and across it.  Orbits stretch along such axes, and products of matrices bounded entry by entry
   grow there much as they do themselves, where in other coordinates entries that cancel would be
   added.  R is orthogonal but for the factor |k|, and made of integers; quotients are off by u. */
static void set_axes(loewner *w)
{
    double k[2] = { 1.0, 0.0 }, most = -1.0, common, square_k;

    for (int i = 0; i < w->waves; i++) {
        double bends = fabs(w->amplitude[i]);
        for (int m = 0; m < w->n_parameters; m++)
            bends += fabs(w->part[i][m]);
        bends *= square(w->k[i][0]) + square(w->k[i][1]);
        if (w->present[i] && bends > most) {
            most = bends;
            memcpy(k, w->k[i], sizeof k);
        }
    }
    common = divisor(fabs(k[0]), fabs(k[1]));
    for (int j = 0; j < 2; j++)
        k[j] /= common;
    square_k = square(k[0]) + square(k[1]);
    w->axes[0][0] = w->axes[1][1] = k[0];
    w->axes[0][1] = k[1];
    w->axes[1][0] = -k[1];
    w->turn[0] = k[0] * k[0] / square_k;
    w->turn[1] = k[0] * k[1] / square_k;
    w->turn[2] = k[1] * k[1] / square_k;
    w->turn[3] = (k[0] * k[0] - k[1] * k[1]) / square_k;
    for (int i = 0; i < w->waves; i++)
        for (int j = 0; j < 2; j++) {
            w->onto[j][i] = fabs(w->axes[j][0] * w->k[i][0] + w->axes[j][1] * w->k[i][1]);
            w->along[i][j] = w->onto[j][i] / square_k;
        }
}

/* B at the corners of the parameters' cube; infinity if it is not to be bounded.  An amplitude
   there is off by less than its err_amp, and a phase by 2^-50 of itself (near) and what it was off
   before, less than 10^-39 (converse.h). */
static void set_corners(loewner *w, int with_bounds)
{
    torus_wave waves[MOST_WAVES];

    for (int corner = 0; corner < 1 << w->n_parameters; corner++) {
        int n = 0;
        for (int i = 0; i < w->waves; i++) {
            if (!w->present[i])
                continue;
            double p = w->amplitude[i];
            for (int m = 0; m < w->n_parameters; m++)
                p += (corner >> m & 1 ? 1.0 : -1.0) * w->part[i][m];
            waves[n++] =
                (torus_wave){ { w->k[i][0], w->k[i][1] },
                              interval_about(w->phase[i], 0x1p-49 * fabs(w->phase[i]) + 0x1p-129),
                              interval_about(p, w->err_amp[i]) };
        }
        w->corner[corner] = with_bounds ? torus_largest(n, waves, TORUS_EIGENVALUE) : HUGE_VAL;
    }
}

loewner *loewner_new(const patch *problem, int with_bounds)
{
    loewner *w = calloc(1, sizeof *w);

    if (w == NULL)
        return NULL;
    set_angles(w, problem);
    set_wave_slots(w, problem);
    straighten(w);
    set_axes(w);
    set_corners(w, with_bounds);
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

void loewner_try(loewner *w, int n, const cv_cell *const cells[], outcome *const out[])
{
    w->engine->try(w->work, w, n, cells, out);
}

double loewner_largest(const loewner *w)
{
    const double low[3] = { 0, 0, 0 }, high[3] = { 1, 1, 1 };

    return cell_largest(w, low, high);
}

/* With n the eigenvector at the centre, n.beta n = 2|n|^2 - sum p sin(y) (k.n)^2 is linear in the
   parameters.  In units u, a wave's terms are off by 32 of |p| and its parts, by (4 + err_angle)
   for the sine, err_angle as in waves.h, and 8 for the product, where (k.n)^2 is off by 5 of (|k0|
   + |k1|)^2 |n|^2; at most 21 numbers are added.  So all is off by 70 + err_angle of the sum of
   absolute values with that in the place of (k.n)^2, the mass; the margin is 256 (1 + err_angle).
   */
int loewner_at_once(const loewner *w, const double at[2], int at_end)
{
    const double x[2] = { w->seen[0][0] * at[0] + w->seen[0][1] * at[1],
                          w->seen[1][0] * at[0] + w->seen[1][1] * at[1] };
    double n[2], d[3] = { 2.0, 0.0, 2.0 }, p[SLOTS], pull[SLOTS], sum, mass, err_angle = 0.0;

    for (int i = 0; i < w->waves; i++) {
        const double *const k = w->k[i], y0 = k[0] * x[0], y1 = k[1] * x[1];
        double c;
        double_sincos(&pull[i], &c, (y0 + y1) + w->phase[i]);
        err_angle = larger(err_angle, 3.0 * (fabs(y0) + fabs(y1)) + 10.0 * fabs(w->phase[i]));
        p[i] = w->amplitude[i];
        for (int m = 0; m < w->n_parameters && at_end; m++)
            p[i] += w->part[i][m];
        d[0] -= p[i] * pull[i] * k[0] * k[0];
        d[1] -= p[i] * pull[i] * k[0] * k[1];
        d[2] -= p[i] * pull[i] * k[1] * k[1];
    }
    least_eigenvector(d, n);
    const double length = square(n[0]) + square(n[1]);
    sum = mass = 4.0 / 3.0 * length;    /* 2 |n|^2 less 2/3 |n|^2 */
    for (int i = 0; i < w->waves; i++) {
        double size = fabs(w->amplitude[i]) + w->err_amp[i];
        pull[i] *= square(w->k[i][0] * n[0] + w->k[i][1] * n[1]);
        sum -= p[i] * pull[i];
        for (int m = 0; m < w->n_parameters; m++)
            size += fabs(w->part[i][m]);
        mass += size * w->square_k[i] * length;
    }
    for (int m = 0; m < w->n_parameters && !at_end; m++) {
        double swing = 0.0;
        for (int i = 0; i < w->waves; i++)
            swing += w->part[i][m] * pull[i];
        sum += fabs(swing);
    }
    return mass >= 1.0 && sum + 0x1p-45 * (1.0 + err_angle) * mass < 0.0;
}
