/* orbit.c - the orbits of the prisms, enclosed by Taylor models of second order.

   Let x[j] be the orbit of the prism's centre, as doubles have it, and x[j] + D[j] any true one.
   D[j] = L[j] e + T[j][e, e] + r[j], e in the unit cube: a Taylor model (Berz and Makino, Reliable
   Computing 4, 1998) with linear coefficients L (lin), quadratic ones T (quad) and a remainder r,
   of which rem is a bound.  L and T are carried by the linearized map, and T gains a quadratic form
   from each wave.

   A bound of r by absolute values alone would grow much faster than the orbits diverge (the
   wrapping effect; Lohner's remedy is to carry remainders in a moving frame).  Here the linearized
   map is factored instead, and r is bounded by two recursions of first order that follow its
   factors, r[j+1] = d[j] r[j] + f[j], f[j] = f[j-1]/d[j-1] + e[j], d[j] = beta - 1/d[j-1]:
   docs/proofs/argument.md, section 5, (R) and (F).  Both are bounded entry by entry, in axes along
   the largest wave and across it.

   Along each wave rad = rho bounds |D[j]|. */
#include "arith/sym2.h"
#include "prism.h"

static const double WIDEN = 1.0 + 0x1p-46;      /* of sums of positive terms: 128 u */

/* Bounds of |L e| and |T[e, e]| along each wave: sums of at most 15 positive terms. */
static void measure(const batch *w, point *q)
{
    const int columns = w->problem->columns;

    for (int i = 0; i < waves_of(w); i++) {
        vec sum = every(0.0);
        for (int k = 0; k < columns; k++)
            sum += mag(dot_k(w, i, q->lin[0][k], q->lin[1][k]));
        q->lin_bound[i] = sum * WIDEN;
        sum = every(0.0);
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++)
            sum += mag(dot_k(w, i, q->quad[0][kl], q->quad[1][kl]));
        q->quad_bound[i] = sum * WIDEN;
    }
    bound_err_dot(w, q);
}

/* Bounds of D, of what was measured and the remainder. */
static void bound_displacement(const batch *w, point *q)
{
    q->rad_max = every(0.0);
    for (int i = 0; i < waves_of(w); i++) {
        q->nonlin_bound[i] = (q->quad_bound[i] + rem_along(w, q, i)) * WIDEN;
        q->rad[i] = (q->lin_bound[i] + q->nonlin_bound[i]) * WIDEN;
        if (i >= FIRST)
            q->rad_max = larger(q->rad_max, w->weight[i] * q->rad[i]);
    }
}

/* Sets a point to zero in the lanes that cannot use it, so that all that follows is finite. */
static void forget(const batch *w, point *q)
{
    /* clang-format off */
    vec *const parts[] = { q->lin[0], q->lin[1], q->quad[0], q->quad[1],
                           q->rem, q->lin_bound, q->quad_bound, q->nonlin_bound, q->rad };
    /* clang-format on */
    const int columns = w->problem->columns, pairs = columns * (columns + 1) / 2;
    const int waves = waves_of(w);
    const int sizes[] = { columns, columns, pairs, pairs, 2, waves, waves, waves, waves };

    for (size_t j = 0; j < sizeof parts / sizeof *parts; j++)
        for (int k = 0; k < sizes[j]; k++)
            parts[j][k] = pick(q->reached, parts[j][k], every(0.0));
    bound_err_dot(w, q);
}

/* The sines at q->x, and what follows from them. */
static void finish(const batch *w, point *q)
{
    evaluate(w, q);
    q->least = sym2_least_eigenvalue(q->beta);
}

/* How far a wave p' cos(y + z), p' = p + h e + w, may be from what L and T make of it,
   p cos y - p (z sin y + (c.e)^2/2 cos y) + h e (cos y - (c.e) sin y), where z = c.e and what is
   off it, |c.e| <= a, |z - c.e| <= b, |z| <= rho, |w| <= err_amp:
       |p| (|cos y| (b (2a + b)/2 + rho^4/24) + |sin y| rho^3/6)
       + h (|cos y| rho^2/2 + |sin y| (b + rho^3/6)) + err_amp.
   Sines are off by 1.01 u, where 2 u are added; the roundings are relative to the sum, and WIDEN
   covers them (step: force). */
static vec wave_remainder(const batch *w, const point *q, int wave)
{
    const vec a = q->lin_bound[wave], b = q->nonlin_bound[wave], rho = q->rad[wave];
    const double off = 0x1p-52;
    const vec c = mag(q->cosine[wave]) + off, s = mag(q->sine[wave]) + off;
    const vec half_square = 0.5 * rho * rho, cube = rho * half_square * (1.0 / 3.0);

    return mag(w->p[wave]) * (c * (b * (a + 0.5 * b) + 0.25 * rho * cube) + s * cube) +
           w->h[wave] * (c * half_square + s * (b + cube)) + w->err_amp[wave];
}

/* What roundings make of the quadratic form that a wave adds to T: (11 + N) u (|p| a^2/2 + h a), N
   waves.  The columns along the wave, and so a, are those of the doubles. */
static vec bending_err(const batch *w, const point *q, int wave)
{
    const vec a = q->lin_bound[wave];

    return grain_of(w) * (mag(w->p[wave]) * a * a + 2.0 * w->h[wave] * a);
}

/* inverse = 1/d, and a bound of its roundings: the determinant is off by 1 + condition units, so
   the inverse is off by 4 + condition units of its trace, where `rounded` has 8 (1 + condition).
   Returns where the inverse is of use. */
INLINE mask invert_factor(const vec d[3], vec inverse[3], vec *rounded)
{
    const vec det = d[0] * d[2] - d[1] * d[1], one = 1.0 / det;
    const vec condition = (mag(d[0] * d[2]) + d[1] * d[1]) * one;

    inverse[0] = d[2] * one;
    inverse[1] = -d[1] * one;
    inverse[2] = d[0] * one;
    *rounded = 0x1p-50 * (inverse[0] + inverse[2]) * (1.0 + condition);
    return TRUTH(d[0] > 0.0) & TRUTH(det > TINY) & TRUTH(condition < 0x1p20);
}

/* q->force, a bound of R f.  f begins as r(o), which is zero or the rounding of x*.  e has the
   bound of wave_remainder along each wave, and in each coordinate the residual and the roundings of
   lin and quad: 2 u of them, propagate_err and bending_err. */
INLINE void set_force(const batch *w, const point *next, point *q, const point *o,
                      const vec inverse[3], vec rounded, int is_first)
{
    vec wave_err[SLOTS], lost[SLOTS], err[2];

    FOR_WAVES(w, j) {
        wave_err[j] = wave_remainder(w, q, j);
        lost[j] = propagate_err(w, q, j) + bending_err(w, q, j);
    }
    for (int i = 0; i < 2; i++)
        err[i] = sum_abs_k(w, i, lost) + w->residual[i] +
                 0x1p-50 * (next->lin_bound[i] + next->quad_bound[i] + o->rad[i]);
    for (int i = 0; i < 2; i++) {
        const vec i0 = mag(inverse[i]) + rounded, i1 = mag(inverse[i + 1]) + rounded;
        vec e = sum_onto(w, i, wave_err) + onto_axis(w, i, err);

        e += is_first ? o->rem[i] : i0 * o->force[0] + i1 * o->force[1];
        e += (2.0 * q->err_beta + rounded) * (q->rem[0] + q->rem[1]);
        q->force[i] = e * WIDEN;
    }
}

/* next->rem, a bound of R r, by the factor and the force of q. */
INLINE void set_remainder(point *next, const point *q)
{
    for (int i = 0; i < 2; i++)
        next->rem[i] =
            (mag(q->d[i]) * q->rem[0] + mag(q->d[i + 1]) * q->rem[1] + q->force[i]) * WIDEN;
}

/* next = the point after q, seen from o before it; time may run either way.  The factor begins with
   d = beta.  Where the factor cannot go on, or next would be of no use, next is not reached.

   The centre and the steps that the waves add are whole numbers of 2^-64 turns: only the forces of
   the waves are rounded (residual: set_lane).  The remainder obeys r' = beta r - r(o) + e.  Writing
   r' = d r + f and, from the last step, r(o) = (r - f(o))/d(o), gives
   f = f(o)/d(o) + e + (beta - 1/d(o) - d) r.

   rem, force and d are those of R r, R f and R d R'/|k|^2, R as in set_axes, for which the same
   holds with R e, and with R beta R'/|k|^2 for beta.  The last bracket is rounding.  Of what is off
   in an entry of beta, u (3 + (7 + N) S), an entry has twice as much there, as (|k0| + |k1|)^2 is 2
   |k|^2 at most; along_axes loses 4 u of sums below 2 (2 + S), and the difference u of that: in
   all u (26 + (24 + 2 N) S), where 2 err_beta are (28 + 2 N) u (1 + S). */
static void step(const batch *w, point *next, point *q, const point *o, int is_first)
{
    static const double RAD_MAX = 0x1p10;       /* A point with a rad above 1,024 is of no use. */
    vec inverse[3] = { every(0.0), every(0.0), every(0.0) }, rounded = every(0.0), turned[3];

    for (int i = 0; i < 2; i++)
        next->x[i] = q->x[i] + q->x[i] - o->x[i] + q->push[i];
    propagate(w, next, q, o);
    measure(w, next);
    next->reached = is_first ? ~none() : invert_factor(o->d, inverse, &rounded);
    set_force(w, next, q, o, inverse, rounded, is_first);
    along_axes(w, turned, q->beta);
    for (int j = 0; j < 3; j++)
        q->d[j] = turned[j] - inverse[j];
    set_remainder(next, q);
    bound_displacement(w, next);
    next->reached &= TRUTH(next->rad_max <= RAD_MAX);
    if (any(~next->reached))
        forget(w, next);
    finish(w, next);
}

/* Sets the two points that the prisms give.  Their roundings are in the widths: set_region.  0: out
   of memory. */
static int begin(batch *w)
{
    const double *const off = w->problem->xstar_err;
    const vec star_err[2] = { every(off[0]), every(off[1]) };

    if (!make_room(w, ORIGIN) || !make_room(w, ORIGIN + 1))
        return 0;
    point *const origin = site_of(w, ORIGIN);
    clear(w, origin);
    clear(w, origin + 1);
    for (int i = 0; i < 2; i++) {
        origin->x[i] = w->problem->turns.xstar[i] - none();
        origin->rem[i] = onto_axis(w, i, star_err) * WIDEN;
        const double *const frame = w->problem->frame[i];
        origin[1].x[i] = w->x1[i];
        for (int k = 0; k < 2; k++)
            origin[1].lin[i][k] = frame[k] * w->width[k];
        for (int k = 2; k < w->problem->columns; k++)
            origin[1].lin[i][k] = frame[0] * w->shift[0][k] + frame[1] * w->shift[1][k];
        origin[i].reached = ~none();
    }
    measure(w, origin + 1);
    for (int j = 0; j < 2; j++) {
        bound_displacement(w, origin + j);
        finish(w, origin + j);
    }
    w->known_first = w->weighed_first = ORIGIN;
    w->known_last = ORIGIN + 1;
    w->weighed_last = ORIGIN - 1;
    for (int k = 0; k < LANES; k++) {
        w->first[k] = ORIGIN;
        w->last[k] = ORIGIN - 1;        /* not in use yet */
    }
    return 1;
}

/* Computes the points between the known ones and `to`.  0: out of memory. */
static int follow(batch *w, int to)
{
    if (!make_room(w, to))
        return 0;
    for (; w->known_last < to; w->known_last++) {
        point *const q = site_of(w, w->known_last);
        step(w, q + 1, q, q - 1, w->known_last == ORIGIN + 1);
    }
    for (; w->known_first > to; w->known_first--) {
        point *const q = site_of(w, w->known_first);
        step(w, q - 1, q, q + 1, w->known_first == ORIGIN);
    }
    return 1;
}

/* Adds a point to the orbit of lane k at the end that is better known, or at the other end if the
   orbit cannot go on there.  0: the end is known too badly, or the orbit is too long; why says
   which. */
static int lengthen(batch *w, int k, int *why)
{
    static const double END_RAD_MAX = 0.6;      /* A rad above 0.6 radians ends an orbit. */

    *why = CV_REASON_TOO_BIG;
    for (;;) {
        const int inner = w->last[k] <= ORIGIN;     /* two points are the prism's own */
        const int ahead = inner || w->end_rad[k][1] < w->end_rad[k][0];
        int *const end = ahead ? &w->last[k] : &w->first[k]; /* hard to foretell: no branches */
        const int next = *end + 2 * ahead - 1;

        if (!inner && !(w->end_rad[k][ahead] <= END_RAD_MAX))
            return 0;
        if (w->last[k] - w->first[k] + 1 == w->problem->longest || !follow(w, next)) {
            *why = CV_REASON_TOO_LONG;
            return 0;
        }
        const point *const q = site_of(w, next);
        if (holds(&q->reached, k)) {
            *end = next;
            w->end_rad[k][ahead] = at(&q->rad_max, k);
            if (next == ORIGIN)
                w->end_rad[k][0] = w->end_rad[k][1];
            return 1;
        }
        *why = CV_REASON_SINGULAR;
        w->end_rad[k][ahead] = HUGE_VAL;
    }
}
