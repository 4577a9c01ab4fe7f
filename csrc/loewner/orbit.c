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
#include "prism.h"

static const double WIDEN = 1.0 + 0x1p-46;      /* of sums of positive terms: 128 u */

/* Bounds of |L e| and |T[e, e]| along each wave: sums of at most 21 positive terms. */
static void measure(const batch *w, point *q)
{
    const int columns = w->problem->columns;

    for (int i = 0; i < waves_of(w); i++) {
        vec sum = every(0.0);
        for (int k = 0; k < columns; k++)
            sum += mag(dot_k(w, i, q->lin[k]));
        q->lin_bound[i] = sum * WIDEN;
        sum = every(0.0);
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++)
            sum += mag(dot_k(w, i, q->quad[kl]));
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
    vec *const parts[] = {
        q->lin[0], q->rem, q->lin_bound, q->quad_bound, q->nonlin_bound, q->rad
    };
    const int columns = w->problem->columns, waves = waves_of(w);
    const int sizes[] = { N * columns * (columns + 3) / 2, N, waves, waves, waves, waves };

    for (size_t j = 0; j < sizeof parts / sizeof *parts; j++)
        for (int k = 0; k < sizes[j]; k++)
            parts[j][k] = pick(q->reached, parts[j][k], every(0.0));
    bound_err_dot(w, q);
}

/* The sines at q->x, and what follows from them. */
static void finish(const batch *w, point *q)
{
    evaluate(w, q);
    q->least = sym_least_eigenvalue(N, q->beta);
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

/* What roundings make of the quadratic form that a wave adds to T: (11 + W) u (|p| a^2/2 + h a), W
   waves.  The columns along the wave, and so a, are those of the doubles. */
static vec bending_err(const batch *w, const point *q, int wave)
{
    const vec a = q->lin_bound[wave];

    return grain_of(w) * (mag(w->p[wave]) * a * a + 2.0 * w->h[wave] * a);
}

/* inverse = 1/d, and a bound of its roundings.  The condition c is the product of d's diagonal over
   the determinant.  Where this returns true, d is positive definite, and the entries of inverse are
   off by less than 2, 3 + 2 c, or 2 + 25 c units u of its trace, for N = 1, 2, 3, where `rounded`
   has 2, 8, or 32 times 1 + c: docs/proofs/argument.md, section 8, *rounded*. */
INLINE mask invert_factor(const vec d[ENTRIES], vec inverse[ENTRIES], vec *rounded)
{
    vec cofactor[ENTRIES];
    const vec det = sym_adjugate(N, cofactor, d), one = 1.0 / det;
    vec condition = one, trace = every(0.0);
    mask good = TRUTH(d[0] > 0.0) & TRUTH(det > TINY);

    for (int i = 0; i < ENTRIES; i++)
        inverse[i] = cofactor[i] * one;
    for (int i = 0; i < N; i++) {
        const int ii = sym_at(N, i, i);
        condition *= d[ii];
        trace += inverse[ii];
        good &= TRUTH(cofactor[ii] > 0.0);
    }
    *rounded = (1 << (2 * N - 1)) * 0x1p-53 * trace * (1.0 + condition);
    return good & TRUTH(condition < 0x1p20);
}

/* q->force, a bound of O f.  f begins as r(o), which is zero or the rounding of x*.  e has the
   bound of wave_remainder along each wave, and in each coordinate the residual and the roundings of
   lin and quad: 2 u of them, propagate_err and bending_err. */
INLINE void set_force(const batch *w, const point *next, point *q, const point *o,
                      const vec inverse[ENTRIES], vec rounded, int is_first)
{
    vec wave_err[SLOTS], lost[SLOTS], err[N];

    FOR_WAVES(w, j) {
        wave_err[j] = wave_remainder(w, q, j);
        lost[j] = propagate_err(w, q, j) + bending_err(w, q, j);
    }
    for (int i = 0; i < N; i++)
        err[i] = sum_abs_k(w, i, lost) + w->residual[i] +
                 0x1p-50 * (next->lin_bound[i] + next->quad_bound[i] + o->rad[i]);
    for (int i = 0; i < N; i++) {
        vec e = sum_onto(w, i, wave_err) + onto_axis(w, i, err);
        vec before = o->rem[i], rems = q->rem[0];
        for (int j = 0; j < N && !is_first; j++) {
            const vec of = (mag(inverse[sym_at(N, i, j)]) + rounded) * o->force[j];
            before = j == 0 ? of : before + of;
        }
        for (int j = 1; j < N; j++)
            rems += q->rem[j];
        q->force[i] = (e + before + (2.0 * q->err_beta + rounded) * rems) * WIDEN;
    }
}

/* next->rem, a bound of O r, by the factor and the force of q. */
INLINE void set_remainder(point *next, const point *q)
{
    for (int i = 0; i < N; i++) {
        vec sum = mag(q->d[i]) * q->rem[0];
        for (int j = 1; j < N; j++)
            sum += mag(q->d[sym_at(N, i, j)]) * q->rem[j];
        next->rem[i] = (sum + q->force[i]) * WIDEN;
    }
}

/* next = the point after q, seen from o before it; time may run either way.  The factor begins with
   d = beta.  Where the factor cannot go on, or next would be of no use, next is not reached.

   The centre and the steps that the waves add are whole numbers of 2^-64 turns: only the forces of
   the waves are rounded (residual: set_lane).  The remainder obeys r' = beta r - r(o) + e.  Writing
   r' = d r + f and, from the last step, r(o) = (r - f(o))/d(o), gives
   f = f(o)/d(o) + e + (beta - 1/d(o) - d) r.

   rem, force and d are those of O r, O f and O d O', O as in set_axes, for which the same holds
   with O e, and with O beta O' for beta.  The last bracket is rounding.  An error of beta
   (waves.h: evaluate) makes u (3 + (7 + W) S) in an element of O beta O', as the rows of O have
   length 1, and the length of k is |k| at most.  along_axes loses 10 u of sums below 2 + S, and the
   difference u of that: in all u (25 + (18 + W) S), where 2 err_beta are (24 + 2 N + 2 W) u (1 +
   S). */
static void step(const batch *w, point *next, point *q, const point *o, int is_first)
{
    static const double RAD_MAX = 0x1p10;       /* A point with a rad above 1,024 is of no use. */
    vec inverse[ENTRIES], rounded = every(0.0), turned[ENTRIES];

    memset(inverse, 0, sizeof inverse);
    for (int i = 0; i < N; i++)
        next->x[i] = q->x[i] + q->x[i] - o->x[i] + q->push[i];
    propagate(w, next, q, o);
    measure(w, next);
    next->reached = is_first ? ~none() : invert_factor(o->d, inverse, &rounded);
    set_force(w, next, q, o, inverse, rounded, is_first);
    along_axes(w, turned, q->beta);
    for (int j = 0; j < ENTRIES; j++)
        q->d[j] = turned[j] - inverse[j];
    set_remainder(next, q);
    bound_displacement(w, next);
    next->reached &= TRUTH(next->rad_max <= RAD_MAX);
    if (any(~next->reached))
        forget(w, next);
    finish(w, next);
}

/* Sets the two points that the prisms give.  Their roundings are in the widths: set_region.  0: out
   of memory.

   Mirrored, the past seen from x* is an orbit of the prism whose x_1 is off by 2 + S times what x*
   is, and half of beta at x* belongs to half of (1): docs/proofs/argument.md, Lemma 8a. */
static int begin(batch *w)
{
    vec err = every(w->problem->xstar_err);

    if (!make_room(w, ORIGIN) || !make_room(w, ORIGIN + 1))
        return 0;
    point *const origin = site_of(w, ORIGIN);
    clear(w, origin);
    clear(w, origin + 1);
    for (int i = 0; i < N; i++) {
        const double *const frame = w->problem->frame[i];
        origin->x[i] = w->problem->turns.xstar[i] - none();
        origin[1].x[i] = w->x1[i];
        for (int k = 0; k < N; k++)
            origin[1].lin[k][i] = frame[k] * w->width[k];
        for (int k = N; k < w->problem->columns; k++)
            for (int j = 0; j < N; j++)
                origin[1].lin[k][i] += frame[j] * w->shift[j][k];
    }
    origin[0].reached = origin[1].reached = ~none();
    measure(w, origin + 1);
    for (int j = 0; j < 2; j++) {
        vec errs[N];
        for (int i = 0; i < N; i++)
            errs[i] = err;
        for (int i = 0; i < N; i++)
            origin[j].rem[i] = onto_axis(w, i, errs) * WIDEN;
        bound_displacement(w, origin + j);
        finish(w, origin + j);
        err *= w->problem->mirrored ? 2.0 * origin->err_beta * (1.0 / grain_of(w)) : every(0.0);
    }
    for (int i = 0; i < ENTRIES && w->problem->mirrored; i++)
        origin->left[i] = origin->beta[i] *= 0.5;
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

/* The points of lane k's orbit: mirrored, those of both sides. */
static int points_of(const batch *w, int k)
{
    const int ahead = w->last[k] - ORIGIN;

    return ahead + 1 + (w->problem->mirrored && ahead > 0 ? ahead : ORIGIN - w->first[k]);
}

/* Adds a point to the orbit of lane k at the end that is better known, or at the other end if the
   orbit cannot go on there; mirrored, one at either end.  0: the end is known too badly, or the
   orbit is too long; why says which. */
static int lengthen(batch *w, int k, int *why)
{
    const int mirrored = w->problem->mirrored;
    static const double END_RAD_MAX = 0.6;      /* A rad above 0.6 radians ends an orbit. */

    *why = CV_REASON_TOO_BIG;
    for (;;) {
        const int inner = w->last[k] <= ORIGIN;     /* two points are the prism's own */
        const int ahead = inner || mirrored || w->end_rad[k][1] < w->end_rad[k][0];
        int *const end = ahead ? &w->last[k] : &w->first[k]; /* hard to foretell: no branches */
        const int next = *end + 2 * ahead - 1;

        if (!inner && !(w->end_rad[k][ahead] <= END_RAD_MAX))
            return 0;
        if (points_of(w, k) + (mirrored && !inner) >= w->problem->longest || !follow(w, next)) {
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
