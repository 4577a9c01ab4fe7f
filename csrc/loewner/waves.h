/* waves.h - the waves of the potential, as an engine sees them.

   The slots below FIRST are the coordinates themselves, whether there are such waves or not: FIRST
   is the first slot with an amplitude.

   Along a wave, lin and quad are k.L and k.T as doubles compute them.  Their roundings, which count
   where coordinates cancel, are the wave's err_dot, and belong to the remainder along the wave.
   Where bounds of coordinates are put together |k| stands for k.

   Angles are integers (turns.h): k.x + phase rounds nothing.  Phases are off by 1 unit of 2^-64
   turns. */
#ifndef CONVERSE_WAVES_H
#define CONVERSE_WAVES_H

#include "prism.h"

INLINE int waves_of(const batch *w) { return w->problem->waves; }
INLINE const double *k_of(const batch *w, int wave) { return w->problem->k[wave]; }

/* The sum of n products. */
INLINE vec dot(int n, const double a[], const vec x[])
{
    vec sum = a[0] * x[0];

    for (int i = 1; i < n; i++)
        sum += a[i] * x[i];
    return sum;
}

/* k.x */
INLINE vec dot_k(const batch *w, int wave, const vec x[N]) { return dot(N, k_of(w, wave), x); }

/* A bound of coordinate i of the sum of k f over the waves, from bounds of f. */
INLINE vec sum_abs_k(const batch *w, int i, const vec f[])
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += fabs(k_of(w, j)[i]) * f[j];
    return sum;
}

/* Bounds of a coordinate along axis i: for the sum of k f over the waves, |O_i.k| |f|, and for a
   vector, from bounds of its coordinates. */
INLINE vec sum_onto(const batch *w, int i, const vec f[])
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += w->problem->onto[j][i] * f[j];
    return sum;
}

INLINE vec onto_axis(const batch *w, int i, const vec x[N])
{
    return dot(N, w->problem->axes[i], x);
}

/* O m O', of a symmetric matrix m. */
INLINE void along_axes(const batch *w, vec turned[ENTRIES], const vec m[ENTRIES])
{
    for (int i = 0; i < ENTRIES; i++)
        turned[i] = dot(ENTRIES, w->problem->turn[i], m);
}

/* A bound of the remainder of D along a wave: k.r = sum of (O_i.k) (O_i.r). */
INLINE vec rem_along(const batch *w, const point *q, int wave)
{
    const vec rem = dot(N, w->problem->onto[wave], q->rem);

    return wave < FIRST ? rem : rem + q->err_dot[wave];
}

/* k.L and k.T lose u to each product and u to each of N - 1 sums: N u of the absolute values, which
   the coordinates' lin_bound and quad_bound bound.  err_dot has 2 N u. */
INLINE void bound_err_dot(const batch *w, point *q)
{
    FOR_WAVES(w, j) {
        vec sum = every(0.0);
        for (int i = 0; i < N; i++)
            sum += fabs(k_of(w, j)[i]) * (q->lin_bound[i] + q->quad_bound[i]);
        q->err_dot[j] = N * 0x1p-52 * sum;
    }
}

/* How many u the waves make of a number that is rounded twelve times at most for each of them, and
   once in each addition. */
INLINE double grain_of(const batch *w) { return 0x1p-53 * (double)(12 + waves_of(w)); }

/* The angle of a wave at q->x. */
INLINE mask angle_of(const batch *w, const point *q, int wave)
{
    mask angle = w->problem->turns.phase[wave] - none();

    for (int i = 0; i < N; i++)
        angle += w->problem->turns.k[wave][i] * q->x[i];
    return angle;
}

/* Sine and cosine of a wave at q->x, and what it adds to the step from there.

   The sines are off by u of themselves and TURNS_ERROR, less than 1.01 u.  The step gets p cos in
   units of 2^(coarse - 64) turns, off by less than 2 (high_of), and a cosine is off by 3 units
   of 2^-62, and as the phase is off by 2 pi/4 more: by 2 + 4.6 |force| 2^-62 units in all, which is
   2^-59 (|p| + 2^coarse) radians or less: see set_lane. */
INLINE void wave_at(const batch *w, point *q, int wave)
{
    mask s, c;

    turns_sincos(&s, &c, angle_of(w, q, wave));
    q->sine[wave] = sine_of(s);
    q->cosine[wave] = sine_of(c);
    const mask negative = sign_of(c), size = high_of(w->force[wave], with_sign(c, negative) << 1);
    const mask force = with_sign(size, negative ^ w->backward[wave]) << w->problem->coarse;
    for (int i = 0; i < N; i++)
        q->push[i] += w->problem->turns.k[wave][i] * force;
}

/* The waves at q->x, beta, and its errors.

   Let there be W waves, S the sum of |k|^2 times their sizes, |k| the sum of the |k[i]|.  p sin and
   p cos are off by 5.1 u |p|; in beta such a product is multiplied by k[a] k[b], rounded once more,
   and W are added, and taken from 2 or 0.  So its element a, b is off by u (3 + (7 + W) s) at most,
   where a = b, and else by u (7 + W) s, with the sum s of |k[a] k[b]| times the sizes.  err_beta is
   (12 + N + W) u (1 + S). */
INLINE void evaluate(const batch *w, point *q)
{
    vec pull[ENTRIES], sizes = every(1.0);

    for (int i = 0; i < ENTRIES; i++)
        pull[i] = every(0.0);
    for (int i = 0; i < N; i++)
        q->push[i] = none();
    FOR_WAVES(w, j) {
        wave_at(w, q, j);
        const vec s = w->p[j] * q->sine[j];
        for (int a = 0, ab = 0; a < N; a++)
            for (int b = a; b < N; b++)
                pull[ab++] += k_of(w, j)[a] * k_of(w, j)[b] * s;
        sizes += w->problem->square_k[j] * w->size[j];
    }
    for (int a = 0, ab = 0; a < N; a++)
        for (int b = a; b < N; b++, ab++)
            q->beta[ab] = (a == b ? 2.0 : 0.0) - pull[ab];
    q->err_beta = grain_of(w) * sizes;
}

/* lin and quad of next, the point after q, seen from o before it: 2L - L(o), the same of T, and
   what the waves make of them and add,
       -p (c.e) sin y + h e cos y  and  -p T sin y - p (c.e)^2/2 cos y - h e (c.e) sin y.
   Where k.L = 0 for all waves, next->lin = 2L - L(o) except for one rounding, which a product
   with beta would not give. */
static void propagate(const batch *w, point *next, const point *q, const point *o)
{
    const int columns = w->problem->columns, pairs = columns * (columns + 1) / 2;
    vec lin[COLUMNS][N], quads[PAIRS][N];

    memset(lin, 0, sizeof lin);
    memset(quads, 0, sizeof quads);
    FOR_WAVES(w, j) {
        const vec pull = -w->p[j] * q->sine[j], half = 0.5 * w->p[j] * q->cosine[j];
        vec c[COLUMNS], f[COLUMNS], push[COLUMNS];
        for (int k = 0; k < columns; k++) {
            c[k] = dot_k(w, j, q->lin[k]);
            f[k] = -half * c[k];
            push[k] = pull * c[k];
        }
        add_moves(w, j, -q->sine[j], f);
        add_moves(w, j, q->cosine[j], push);
        for (int k = 0, kl = 0; k < columns; k++) {
            for (int i = 0; i < N; i++)
                lin[k][i] += k_of(w, j)[i] * push[k];
            for (int l = k; l < columns; l++, kl++) {           /* (c.e) (f.e) */
                const vec cf = l == k ? c[k] * f[k] : c[k] * f[l] + c[l] * f[k];
                const vec quad = cf + pull * dot_k(w, j, q->quad[kl]);
                for (int i = 0; i < N; i++)
                    quads[kl][i] += k_of(w, j)[i] * quad;
            }
        }
    }
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < columns; k++)
            next->lin[k][i] = (2.0 * q->lin[k][i] - o->lin[k][i]) + lin[k][i];
        for (int kl = 0; kl < pairs; kl++)
            next->quad[kl][i] = (2.0 * q->quad[kl][i] - o->quad[kl][i]) + quads[kl][i];
    }
}

/* What that loses of a wave to roundings: p sin, its products with c and T, with k, and sums over
   the W waves (8 + W) u |p| of their sizes, h cos y (4 + W) u h; and p times err_dot, as the map
   has k.L where propagate has c. */
INLINE vec propagate_err(const batch *w, const point *q, int wave)
{
    const vec p = mag(w->p[wave]), unit = every(grain_of(w));
    const vec lost = unit * (p * (q->lin_bound[wave] + q->quad_bound[wave]) + w->h[wave]);

    return wave < FIRST ? lost : lost + p * q->err_dot[wave];
}

/* Minus the gradient of n.beta n at a site. */
INLINE vec gradient(const batch *w, const point *q, int i)
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += k_of(w, j)[i] * (square(dot_k(w, j, q->n)) * w->p[j] * q->cosine[j]);
    return sum;
}

/* At least omega + |m| of each wave with their roundings, which are relative to |k|^2 |n|^2 and
   |k| |mu|. */
INLINE vec weights_of(const batch *w, const vec omega[], const vec m[])
{
    const double most = w->problem->most_k;
    vec squares = omega[0], sizes = mag(m[0]);

    for (int i = 1; i < N; i++) {
        squares += omega[i];
        sizes += mag(m[i]);
    }
    return most * most * squares + most * sizes;
}

#endif
