/* general.h - any waves, up to MOST_WAVES: what three.h is for the thesis's.

   The first two slots are the coordinates, as waves without amplitude; those that there are come
   after, with y = k.x + phase.  Along a wave, columns and bow are what doubles make of k.L and k.T:
   what they lose there, which counts where coordinates cancel, is the wave's slip, and belongs to the
   rest along it.  Where bounds of coordinates are put together |k| stands for k.

   `far` bounds the rounding of all angles, and sums over the waves, in units u: products k x lose
   u |k x|, their sum u of itself, the phase, which `near` made a double, 8 u of itself, and the last
   sum u of what it adds.  That is 3 u (|k0 x0| + |k1 x1|) + 9 u |phase| at most; far has one |phase|
   more, for the 10^-40 that it may be off before, and the number of waves. */
#ifndef CONVERSE_GENERAL_H
#define CONVERSE_GENERAL_H

#include "arith/sine.h"
#include "prism.h"

enum { FIRST = 2 };                     /* of the waves that there are */

INLINE int waves_of(const batch *w) { return w->root->waves; }

/* What a wave feels, of x0, x1 along the coordinates. */
INLINE vec felt(const batch *w, int wave, vec x0, vec x1)
{
    const double *const k = w->root->k[wave];

    return k[0] * x0 + k[1] * x1;
}

/* What coordinate i has of something of each wave, and a bound of it from bounds. */
INLINE vec gathered(const batch *w, int i, const vec of[])
{
    vec sum = every(0.0);

    for (int j = FIRST; j < waves_of(w); j++)
        sum += w->root->k[j][i] * of[j];
    return sum;
}

INLINE vec gathered_sizes(const batch *w, int i, const vec of[])
{
    vec sum = every(0.0);

    for (int j = FIRST; j < waves_of(w); j++)
        sum += fabs(w->root->k[j][i]) * of[j];
    return sum;
}

/* How far D is along a wave from what columns and bow make of it. */
INLINE vec rest_along(const batch *w, const point *q, int wave)
{
    const double *const k = w->root->k[wave];

    return fabs(k[0]) * q->rest[0] + fabs(k[1]) * q->rest[1] + q->slip[wave];
}

/* k.L and k.T lose u to each product and u to the sum: 2 u of the absolute values. */
INLINE void measure_slips(const batch *w, point *q, int columns)
{
    vec size[2];

    for (int i = 0; i < 2; i++) {
        size[i] = every(0.0);
        for (int k = 0; k < columns; k++)
            size[i] += mag(q->column[i][k]);
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++)
            size[i] += mag(q->bow[i][kl]);
    }
    q->slip[0] = q->slip[1] = every(0.0);
    for (int j = FIRST; j < waves_of(w); j++)
        q->slip[j] = 0x1p-51 * (fabs(w->root->k[j][0]) * size[0] + fabs(w->root->k[j][1]) * size[1]);
}

/* Sines and cosines of the waves at q->x, beta, and their errors.

   Let N be the number of waves, S the sum of (|k0| + |k1|)^2 times their sizes.  p sin and p cos are
   off by (5 + far - N) u |p|; in beta such a product is multiplied by k k', rounded twice more, and N
   are added, and taken from an integer: beta is off by u (3 + (9 + far) S) at most, where fuzz is
   16 u (1 + S)(1 + far), far >= 1. */
INLINE void see(const batch *w, point *q)
{
    vec pull[3] = { every(0.0), every(0.0), every(0.0) }, farthest = every(0.0);
    vec sizes = every(1.0);

    for (int j = FIRST; j < waves_of(w); j++) {
        const double k0 = w->root->k[j][0], k1 = w->root->k[j][1], phase = w->root->phase[j];
        const vec y0 = k0 * q->x[0], y1 = k1 * q->x[1];
        double_sincos(&q->sine[j], &q->cosine[j], (y0 + y1) + phase);
        farthest = larger(farthest, 3.0 * (mag(y0) + mag(y1)) + 10.0 * fabs(phase));
        const vec s = w->p[j] * q->sine[j];
        pull[0] += k0 * k0 * s;
        pull[1] += k0 * k1 * s;
        pull[2] += k1 * k1 * s;
        sizes += w->root->square_k[j] * w->size[j];
    }
    q->far = farthest + (double)(waves_of(w) - FIRST + 1);
    for (int i = 0; i < 3; i++)
        q->beta[i] = (i == 1 ? 0.0 : 2.0) - pull[i];
    q->fuzz = 0x1p-49 * sizes * (1.0 + q->far);
}

/* The columns and the bow of next, the point after q, seen from o before it: 2L - L(o), the same of
   T, and what the waves make of them and add,
       -p (c.e) sin y + h e cos y  and  -p T sin y - p (c.e)^2/2 cos y - h e (c.e) sin y.
   Where no wave feels a column it is carried as it should be. */
INLINE void carry(const batch *w, point *next, const point *q, const point *o, int columns)
{
    const int pairs = columns * (columns + 1) / 2;
    vec straight[2][COLUMNS], bowed[2][PAIRS];

    memset(straight, 0, sizeof straight);
    memset(bowed, 0, sizeof bowed);
    for (int j = FIRST; j < waves_of(w); j++) {
        const double *const wave = w->root->k[j];
        const vec pull = -w->p[j] * q->sine[j], half = 0.5 * w->p[j] * q->cosine[j];
        vec c[COLUMNS], f[COLUMNS], push[COLUMNS];
        for (int k = 0; k < columns; k++) {
            c[k] = felt(w, j, q->column[0][k], q->column[1][k]);
            f[k] = -half * c[k];
            push[k] = pull * c[k];
        }
        add_moves(w, j, -q->sine[j], f, columns);
        add_moves(w, j, q->cosine[j], push, columns);
        for (int k = 0, kl = 0; k < columns; k++) {
            for (int i = 0; i < 2; i++)
                straight[i][k] += wave[i] * push[k];
            for (int l = k; l < columns; l++, kl++) {           /* (c.e) (f.e) */
                const vec cf = l == k ? c[k] * f[k] : c[k] * f[l] + c[l] * f[k];
                const vec bow = cf + pull * felt(w, j, q->bow[0][kl], q->bow[1][kl]);
                for (int i = 0; i < 2; i++)
                    bowed[i][kl] += wave[i] * bow;
            }
        }
    }
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < columns; k++)
            next->column[i][k] = (2.0 * q->column[i][k] - o->column[i][k]) + straight[i][k];
        for (int kl = 0; kl < pairs; kl++)
            next->bow[i][kl] = (2.0 * q->bow[i][kl] - o->bow[i][kl]) + bowed[i][kl];
    }
}

/* What that loses to roundings of the waves: p sin, its products with c and T, with k, and sums over
   the waves (10 + far) u |p| of their sizes, h cos y (8 + far) u h; and p times the slips, as the map
   has k.L where carry has c. */
INLINE vec carried(const batch *w, const point *q, int i)
{
    const vec unit = 0x1p-49 * (1.0 + q->far);
    vec lost[WAVES];

    for (int j = FIRST; j < waves_of(w); j++)
        lost[j] = unit * (mag(w->p[j]) * (q->straight[j] + q->bowed[j]) + w->h[j])
                  + mag(w->p[j]) * q->slip[j];
    return gathered_sizes(w, i, lost);
}

/* Minus the gradient of n.beta n at a site. */
INLINE vec gradient(const batch *w, const point *q, int i)
{
    vec sum = every(0.0);

    for (int j = FIRST; j < waves_of(w); j++)
        sum += w->root->k[j][i] * (square(felt(w, j, q->n[0], q->n[1])) * w->p[j] * q->cosine[j]);
    return sum;
}

/* At least omega + |m| of each wave with their roundings, which are relative to |k|^2 |n|^2 and
   |k| |mu|. */
INLINE vec weights_of(const batch *w, const vec omega[], const vec m[])
{
    const double most = w->root->most_k;

    return most * most * (omega[0] + omega[1]) + most * (mag(m[0]) + mag(m[1]));
}

/* At least the reach along a wave of all whose products add_cubic sums. */
INLINE vec width_of(const batch *w, const point *q, int wave)
{
    (void)w;
    return q->reach[wave];
}

/* Adds the cubic terms (c.e) form[e, e] of all waves. */
INLINE void add_cubic(batch *w, const point *q, mask now, vec form[][PAIRS], int columns)
{
    for (int m = 0; m < columns; m++)
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++) {
            vec sum = every(0.0);
            for (int j = FIRST; j < waves_of(w); j++)
                sum += felt(w, j, q->column[0][m], q->column[1][m]) * form[j][kl];
            w->cubic[m][kl] += pick(now, sum, every(0.0));
        }
}

#endif
