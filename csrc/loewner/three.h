/* three.h - the thesis's waves: one that x0 feels, one that x1 does, and one that both do.

   The first two are the coordinates themselves.  A wave is off by what its angle is rounded: u far for
   the third, nothing for the others. */
#ifndef CONVERSE_THREE_H
#define CONVERSE_THREE_H

#include "arith/sine.h"
#include "prism.h"

enum { FIRST = 0 };                     /* of the waves that there may be */

INLINE int waves_of(const batch *w) { (void)w; return WAVES; }

/* What a wave feels, of x0, x1 along the coordinates. */
INLINE vec felt(const batch *w, int wave, vec x0, vec x1)
{
    (void)w;
    return wave == 0 ? x0 : wave == 1 ? x1 : x0 + x1;
}

/* What coordinate i has of something of each wave, and a bound of it from bounds. */
INLINE vec gathered(const batch *w, int i, const vec of[]) { (void)w; return of[i] + of[2]; }
INLINE vec gathered_sizes(const batch *w, int i, const vec of[]) { return gathered(w, i, of); }

/* How far D is along a wave from what columns and bow make of it. */
INLINE vec rest_along(const batch *w, const point *q, int wave)
{
    return felt(w, wave, q->rest[0], q->rest[1]);
}

INLINE void measure_slips(const batch *w, point *q, int columns)
{
    (void)w;
    (void)q;
    (void)columns;
}

/* Sines and cosines of the waves at q->x, beta, and their errors.

   Sines and cosines are off by SINE_ERROR = 4 u, those of a rounded sum by u far more, and products
   with p by u: p sin and p cos are off by (5 + far) u |p|.  An entry of beta, a sum of two and an
   integer, is rounded twice more, and off by u (4 + 7 |p0| + (6 + far) |p2|) at most; fuzz is
   16 u (1 + sizes)(1 + far). */
INLINE void see(const batch *w, point *q)
{
    const vec y[WAVES] = { q->x[0], q->x[1], q->x[0] + q->x[1] };
    vec c_sin;

    q->far = w->root->present[2] ? mag(q->x[0]) + mag(q->x[1]) : every(0.0);
    for (int i = 0; i < WAVES; i++)
        double_sincos(&q->sine[i], &q->cosine[i], y[i]);
    c_sin = w->p[2] * q->sine[2];
    q->beta[0] = 2.0 - w->p[0] * q->sine[0] - c_sin;
    q->beta[1] = -c_sin;
    q->beta[2] = 2.0 - w->p[1] * q->sine[1] - c_sin;
    q->fuzz = 0x1p-49 * (1.0 + w->size[0] + w->size[1] + w->size[2]) * (1.0 + q->far);
}

/* The columns and the bow of next, the point after q, seen from o before it: the linearized map of
   both, and what the waves add to them,
       h e cos y  and  -p (c.e)^2/2 cos y - h e (c.e) sin y. */
INLINE void carry(const batch *w, point *next, const point *q, const point *o, int columns)
{
    const int pairs = columns * (columns + 1) / 2;
    vec source[WAVES][PAIRS];

    for (int i = 0; i < WAVES; i++) {
        const vec half = 0.5 * w->p[i] * q->cosine[i];
        vec c[COLUMNS], f[COLUMNS];
        for (int k = 0; k < columns; k++) {
            c[k] = felt(w, i, q->column[0][k], q->column[1][k]);
            f[k] = -half * c[k];
        }
        add_moves(w, i, -q->sine[i], f, columns);
        for (int k = 0, kl = 0; k < columns; k++) {             /* (c.e) (f.e) */
            source[i][kl++] = c[k] * f[k];
            for (int l = k + 1; l < columns; l++)
                source[i][kl++] = c[k] * f[l] + c[l] * f[k];
        }
    }
    for (int i = 0; i < 2; i++) {
        const vec b0 = q->beta[i], b1 = q->beta[i + 1];
        for (int k = 0; k < columns; k++)
            next->column[i][k] = b0 * q->column[0][k] + b1 * q->column[1][k] - o->column[i][k];
        add_moves(w, i, q->cosine[i], next->column[i], columns);
        add_moves(w, 2, q->cosine[2], next->column[i], columns);
        for (int kl = 0; kl < pairs; kl++)
            next->bow[i][kl] = b0 * q->bow[0][kl] + b1 * q->bow[1][kl] - o->bow[i][kl]
                               + (source[i][kl] + source[2][kl]);
    }
}

/* What that loses to roundings of the waves, 11/16 fuzz of the reach, and (7 + far) u h. */
INLINE vec carried(const batch *w, const point *q, int i)
{
    return 4.0 * q->fuzz * (q->reach[0] + q->reach[1] + w->h[i] + w->h[2]);
}

/* Minus the gradient of n.beta n at a site. */
INLINE vec gradient(const batch *w, const point *q, int i)
{
    return square(q->n[i]) * w->p[i] * q->cosine[i]
           + square(q->n[0] + q->n[1]) * w->p[2] * q->cosine[2];
}

/* At least omega + |m| of each wave, of omega and the m of the first two. */
INLINE vec weights_of(const batch *w, const vec omega[], const vec m[])
{
    (void)w;
    return omega[0] + omega[1] + omega[2] + mag(m[0]) + mag(m[1]);
}

/* At least the reach along a wave of all whose products add_cubic sums: the third wave's c is the sum
   of the others', in which its cubic form is shared out. */
INLINE vec width_of(const batch *w, const point *q, int wave)
{
    return felt(w, wave, q->reach[0], q->reach[1]);
}

/* Adds the cubic terms (c.e) form[e, e] of all waves. */
INLINE void add_cubic(batch *w, const point *q, mask now, vec form[][PAIRS], int columns)
{
    for (int m = 0; m < columns; m++)
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++)
            w->cubic[m][kl] += pick(now, q->column[0][m] * (form[0][kl] + form[2][kl])
                                         + q->column[1][m] * (form[1][kl] + form[2][kl]),
                                    every(0.0));
}

#endif
