/* waves.h - the waves of the potential, as an engine sees them.

   The slots 0 and 1 are the coordinates themselves, whether there are such waves or not: FIRST is
   the first slot with an amplitude.

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

/* k.x */
INLINE vec dot_k(const batch *w, int wave, vec x0, vec x1)
{
    return k_of(w, wave)[0] * x0 + k_of(w, wave)[1] * x1;
}

/* |k|.x */
INLINE vec dot_abs_k(const batch *w, int wave, vec x0, vec x1)
{
    return fabs(k_of(w, wave)[0]) * x0 + fabs(k_of(w, wave)[1]) * x1;
}

/* A bound of coordinate i of the sum of k f over the waves, from bounds of f. */
INLINE vec sum_abs_k(const batch *w, int i, const vec f[])
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += fabs(k_of(w, j)[i]) * f[j];
    return sum;
}

/* Bounds of a coordinate along axis i: for the sum of k f over the waves, |R_i.k| |f|, and for a
   vector, from bounds of its coordinates. */
INLINE vec sum_onto(const batch *w, int i, const vec f[])
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += w->problem->onto[i][j] * f[j];
    return sum;
}

INLINE vec onto_axis(const batch *w, int i, const vec x[2])
{
    const double *const axis = w->problem->axes[i];

    return fabs(axis[0]) * x[0] + fabs(axis[1]) * x[1];
}

/* R m R'/|k|^2, of a symmetric matrix m. */
INLINE void along_axes(const batch *w, vec turned[3], const vec m[3])
{
    const double *const turn = w->problem->turn;

    turned[0] = turn[0] * m[0] + 2.0 * turn[1] * m[1] + turn[2] * m[2];
    turned[1] = turn[1] * (m[2] - m[0]) + turn[3] * m[1];
    turned[2] = turn[2] * m[0] - 2.0 * turn[1] * m[1] + turn[0] * m[2];
}

/* A bound of the remainder of D along a wave: k.r = sum of (R_i.k) (R_i.r)/|R_i|^2. */
INLINE vec rem_along(const batch *w, const point *q, int wave)
{
    const double *const along = w->problem->along[wave];
    const vec rem = along[0] * q->rem[0] + along[1] * q->rem[1];

    return wave < 2 ? rem : rem + q->err_dot[wave];
}

/* k.L and k.T lose u to each product and u to the sum: 2 u of the absolute values, which the
   coordinates' lin_bound and quad_bound bound. */
INLINE void bound_err_dot(const batch *w, point *q)
{
    const vec size0 = q->lin_bound[0] + q->quad_bound[0];
    const vec size1 = q->lin_bound[1] + q->quad_bound[1];

    for (int j = 2; j < waves_of(w); j++)
        q->err_dot[j] = 0x1p-51 * dot_abs_k(w, j, size0, size1);
}

/* How many u the waves make of a number that is rounded twelve times at most for each of them, and
   once in each addition. */
INLINE double grain_of(const batch *w) { return 0x1p-53 * (double)(12 + waves_of(w)); }

/* The angle of a wave at q->x. */
INLINE mask angle_of(const batch *w, const point *q, int wave)
{
    const uint64_t *const k = w->problem->turns.k[wave];

    return k[0] * q->x[0] + k[1] * q->x[1] + w->problem->turns.phase[wave];
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
    for (int i = 0; i < 2; i++)
        q->push[i] += w->problem->turns.k[wave][i] * force;
}

/* The waves at q->x, beta, and its errors.

   Let N be the number of waves, S the sum of (|k0| + |k1|)^2 times their sizes.  p sin and p cos
   are off by 5.1 u |p|; in beta such a product is multiplied by k k', rounded once more, and N are
   added, and taken from an integer: beta is off by u (3 + (7 + N) S) at most, where err_beta is
   (14 + N) u (1 + S). */
INLINE void evaluate(const batch *w, point *q)
{
    vec pull[3] = { every(0.0), every(0.0), every(0.0) }, sizes = every(1.0);

    q->push[0] = q->push[1] = none();
    FOR_WAVES(w, j) {
        const double k0 = k_of(w, j)[0], k1 = k_of(w, j)[1];
        wave_at(w, q, j);
        const vec s = w->p[j] * q->sine[j];
        pull[0] += k0 * k0 * s;
        pull[1] += k0 * k1 * s;
        pull[2] += k1 * k1 * s;
        sizes += w->problem->square_k[j] * w->size[j];
    }
    for (int i = 0; i < 3; i++)
        q->beta[i] = (i == 1 ? 0.0 : 2.0) - pull[i];
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
    vec lin[2][COLUMNS], quads[2][PAIRS];

    memset(lin, 0, sizeof lin);
    memset(quads, 0, sizeof quads);
    FOR_WAVES(w, j) {
        const vec pull = -w->p[j] * q->sine[j], half = 0.5 * w->p[j] * q->cosine[j];
        vec c[COLUMNS], f[COLUMNS], push[COLUMNS];
        for (int k = 0; k < columns; k++) {
            c[k] = dot_k(w, j, q->lin[0][k], q->lin[1][k]);
            f[k] = -half * c[k];
            push[k] = pull * c[k];
        }
        add_moves(w, j, -q->sine[j], f);
        add_moves(w, j, q->cosine[j], push);
        for (int k = 0, kl = 0; k < columns; k++) {
            for (int i = 0; i < 2; i++)
                lin[i][k] += k_of(w, j)[i] * push[k];
            for (int l = k; l < columns; l++, kl++) {           /* (c.e) (f.e) */
                const vec cf = l == k ? c[k] * f[k] : c[k] * f[l] + c[l] * f[k];
                const vec quad = cf + pull * dot_k(w, j, q->quad[0][kl], q->quad[1][kl]);
                for (int i = 0; i < 2; i++)
                    quads[i][kl] += k_of(w, j)[i] * quad;
            }
        }
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < columns; k++)
            next->lin[i][k] = (2.0 * q->lin[i][k] - o->lin[i][k]) + lin[i][k];
        for (int kl = 0; kl < pairs; kl++)
            next->quad[i][kl] = (2.0 * q->quad[i][kl] - o->quad[i][kl]) + quads[i][kl];
    }
}

/* What that loses of a wave to roundings: p sin, its products with c and T, with k, and sums over
   the N waves (8 + N) u |p| of their sizes, h cos y (4 + N) u h; and p times err_dot, as the map
   has k.L where propagate has c. */
INLINE vec propagate_err(const batch *w, const point *q, int wave)
{
    const vec p = mag(w->p[wave]), unit = every(grain_of(w));
    const vec lost = unit * (p * (q->lin_bound[wave] + q->quad_bound[wave]) + w->h[wave]);

    return wave < 2 ? lost : lost + p * q->err_dot[wave];
}

/* Minus the gradient of n.beta n at a site. */
INLINE vec gradient(const batch *w, const point *q, int i)
{
    vec sum = every(0.0);

    FOR_WAVES(w, j)
        sum += k_of(w, j)[i] * (square(dot_k(w, j, q->n[0], q->n[1])) * w->p[j] * q->cosine[j]);
    return sum;
}

/* At least omega + |m| of each wave with their roundings, which are relative to |k|^2 |n|^2 and
   |k| |mu|. */
INLINE vec weights_of(const batch *w, const vec omega[], const vec m[])
{
    const double most = w->problem->most_k;

    return most * most * (omega[0] + omega[1]) + most * (mag(m[0]) + mag(m[1]));
}

#endif
