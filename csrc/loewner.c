/* loewner.c - the Loewner criterion by a witness and multipliers, in doubles.

   The criterion.  Orbits on an invariant Lagrangian graph minimize, so their second variation
   Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1] is not negative for any square-summable n
   (Katok; MacKay, Meiss and Stark, Nonlinearity 2, 1989).  With B >= the largest eigenvalue of beta
   over the torus, l + 1/l = B, l < 1, and n decaying outwards by l from its ends s and t, the two
   tails add at most -l |n[s]|^2 and -l |n[t]|^2.  So there is no torus if for some s, t and n

       Q = sum n[j].beta(x[j])n[j] - 2 sum n[j].n[j+1] - l (|n[s]|^2 + |n[t]|^2) < 0.           (1)

   Some n does it for one orbit if and only if the recursion d[s] = beta - l, d[j+1] = beta - 1/d[j]
   of the Loewner bounds leads to a d[j] that is not above l; past and future are used alike.

   A prism is a set of orbits: x[0] = x*, x[1] in a rectangle, the parameters on a segment or in a
   box.  n is chosen for the orbit of the prism's centre and then kept.  Let x[j] be that orbit and
   x[j] + D[j] any other one, and write the map as E[j] = 2x[j] - x[j-1] - x[j+1] - V'(x[j]) = 0.  So
   for any multipliers mu the sum Q + sum mu[j].E[j] is Q, and with

       mu[j-1] = gradient of n[j].beta(x[j])n[j] + beta(x[j])mu[j] - mu[j+1]   from the future,     (2)

   and likewise from the past, all terms linear in the D[j] cancel, except those in D[0] and D[1],
   which are the prism itself.  What is left of each wave, of weight omega = (n.u)^2 and with
   m = mu.u, A = m cos y - omega sin y, B = -omega cos y - m sin y, is

       p (A (cos d - 1) + B (sin d - d)),   |d| <= rho,                                        (3)

   and at most max(0, -pA) rho^2/2 + |pB| rho^3/6.  (2) is an identity in exact arithmetic; in
   doubles its rest, too, is multiplied by |D[j]| and added.

   The reach rho of |D[j]|: D[j] = L[j] e + r[j], e in the unit cube, the columns L as the linearized
   map carries them, the rest r bounded by two first-order recursions that follow the factors of the
   linearized map, r[j+1] = d[j] r[j] + f[j], f[j] = f[j-1]/d[j-1] + e[j], d[j] = beta - 1/d[j-1],
   which grow as the orbits do and not as absolute values would.

   Rounding.  All numbers are doubles rounded to nearest (unit u = 2^-53).  n, mu, x, L and d are what
   they are: any values make a valid proof.  Only the bounds are to be trusted: sums of positive
   terms, widened in the end by more than their roundings, and the few sums with signs, whose
   roundings are bounded by the sums of absolute values. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "loewner.h"
#include "sine.h"

enum { WAVES = 3, COLUMNS = 5, MAX_POINTS = 4000, ORIGIN = MAX_POINTS };
enum { FINEST = 46 };                   /* cuts along one axis: then doubles run out */
enum { PATIENCE = 12 };                 /* tries follow each other by a twelfth of the orbit */
static const double TWO_PI = 0x1.921fb54442d18p+2;      /* less than 2^-51 below it */
static const double FAR = 1e5;          /* turns in one step after which orbits end */
static const double WIDEN = 1.0 + 0x1p-43;

/* One point of the orbit of the prism's centre, and all that is known of its neighbours. */
typedef struct {
    double x[2], turns[2];              /* x modulo 2 pi; turns taken off when it was reached */
    double missed[2];                   /* by the step from here: a bound of |E| at the centre */
    double column[2][COLUMNS];          /* v0, v1, then the parameters */
    double rest[2], force[2];           /* r and f: bounds */
    double d[3];                        /* the factor: d00, d01, d11 */
    double sine[WAVES], cosine[WAVES];
    double reach[WAVES];                /* rho: |D0|, |D1|, |D0 + D1| */
    double beta[3];                     /* beta00, beta01, beta11 */
    double far;                         /* how large a rounded angle is */
    double fuzz;                        /* how far p sin, p cos and entries of beta may be off */
    double n[2], mu[2], gradient[2];
    double left[3], right[3];           /* the blocks of the recursion from either end */
} point;

struct loewner {
    /* the problem */
    double centre[COLUMNS], half[COLUMNS], slack[COLUMNS];      /* v0, v1, a, b, c */
    double xstar[2], xstar_err[2], corner[8];                   /* bounds B at the corners */
    int together, columns;
    /* the prism at hand */
    double p[WAVES], h[WAVES], loose[WAVES];    /* p +- h moves with a column, loose by itself */
    double v[2], width[2], l;
    double share[COLUMNS];
    double bound, rounding;
    int first, last;                    /* of the orbit's points */
    int from, to, until;                /* n is zero before from and after to; until: see witness */
    point orbit[2 * MAX_POINTS + 1];
};

static double square(double x) { return x * x; }
static double larger(double x, double y) { return x > y ? x : y; }

/* |p| + h + loose */
static double size(const loewner *w, int wave)
{
    return fabs(w->p[wave]) + w->h[wave] + w->loose[wave];
}

/* The sines at q->x; what follows from them and from the columns and the rest.

   Sines and cosines are off by SINE_ERROR, those of a rounded sum by u |x0 + x1| more, and products
   with p by u/2: p sin is off by less than 2^-50 |p| (1 + |x0| + |x1|), and an entry of beta, a sum of
   two and an integer, by less than fuzz.  Reaches are sums of at most 8 positive terms; that of a
   wave that is not there is of no interest. */
static void finish(const loewner *w, point *q)
{
    const double y[WAVES] = { q->x[0], q->x[1], q->x[0] + q->x[1] };
    double sum[WAVES] = { 0, 0, 0 }, c_sin;

    q->far = size(w, 2) > 0.0 ? fabs(q->x[0]) + fabs(q->x[1]) : 0.0;
    for (int j = 0; j < WAVES; j++)
        double_sincos(&q->sine[j], &q->cosine[j], y[j]);
    c_sin = w->p[2] * q->sine[2];
    q->beta[0] = 2.0 - w->p[0] * q->sine[0] - c_sin;
    q->beta[1] = -c_sin;
    q->beta[2] = 2.0 - w->p[1] * q->sine[1] - c_sin;
    q->fuzz = 0x1p-49 * (1.0 + size(w, 0) + size(w, 1) + size(w, 2)) * (1.0 + q->far);
    for (int k = 0; k < w->columns; k++) {
        sum[0] += fabs(q->column[0][k]);
        sum[1] += fabs(q->column[1][k]);
        sum[2] += fabs(q->column[0][k] + q->column[1][k]);
    }
    q->reach[0] = (sum[0] + q->rest[0]) * WIDEN;
    q->reach[1] = (sum[1] + q->rest[1]) * WIDEN;
    q->reach[2] = (sum[2] + q->rest[0] + q->rest[1]) * WIDEN;
}

/* How far a wave p cos(y + d) may be from p cos y - p d sin y + h e cos y, e in [-1, 1] the symbol
   of the parameter: (|p| + h)(|cos y| d^2/2 + |sin y| |d|^3/6) + h |sin y d| + loose.  Sines are off
   by far less than 2^-40 (1 + |x0| + |x1|). */
static double bend(const loewner *w, const point *q, int wave)
{
    const double rho = q->reach[wave];
    const double off = 0x1p-40 * (1.0 + q->far);
    const double c = fabs(q->cosine[wave]) + off, s = fabs(q->sine[wave]) + off;

    return size(w, wave) * rho * rho * (c * 0.5 + s * rho * (1.0 / 6.0)) +
           (w->h[wave] + w->loose[wave]) * s * rho + w->loose[wave] * c;
}

/* next = the point after q, seen from o before it; time may run either way.  The factor begins
   with d = beta, and f then holds r(o), which is zero or the rounding of x*.  0: the factor cannot go on.

   The coordinates are kept modulo 2 pi; a turn costs 2^-51, less than its share of missed.
   The rest obeys r' = beta r - r(o) + e, where e is what the waves bend, what the step of the
   centre missed, and the roundings of the columns.  Writing r' = d r + f and, from the last step,
   r(o) = (r - f(o))/d(o), gives f = f(o)/d(o) + e + (beta - 1/d(o) - d) r, where the last bracket is
   rounding: below 2 fuzz and 8 units of the inverse, times 1 + its condition. */
static int step(const loewner *w, point *next, point *q, const point *o, int is_first)
{
    double g[WAVES], bent[WAVES], inverse[3] = { 0, 0, 0 }, rounded = 0.0, rest_sum;

    for (int j = 0; j < WAVES; j++) {
        g[j] = w->p[j] * q->cosine[j];
        bent[j] = bend(w, q, j);
    }
    for (int i = 0; i < 2; i++) {
        const double b0 = q->beta[i], b1 = q->beta[i + 1];
        const double before = o->x[i] - q->turns[i] * TWO_PI;
        const double x = (2.0 * q->x[i] - before) + (g[i] + g[2]);
        next->turns[i] = floor(x / TWO_PI + 0.5);
        next->x[i] = x - next->turns[i] * TWO_PI;
        q->missed[i] = 0x1p-50 * (fabs(q->x[i]) + fabs(o->x[i]) + fabs(before) + fabs(x)) + q->fuzz;
        for (int k = 0; k < w->columns; k++)
            next->column[i][k] = b0 * q->column[0][k] + b1 * q->column[1][k] - o->column[i][k];
    }
    for (int i = 0; i < 2; i++) {
        next->column[i][w->together ? 2 : 2 + i] += w->h[i] * q->cosine[i];
        next->column[i][w->together ? 2 : 4] += w->h[2] * q->cosine[2];
    }

    if (!is_first) {
        const double *d = o->d, det = d[0] * d[2] - d[1] * d[1];
        const double condition = (fabs(d[0] * d[2]) + d[1] * d[1]) / det;
        if (!(d[0] > 0.0 && det > 0.0 && condition < 0x1p20))
            return 0;
        inverse[0] = d[2] / det;
        inverse[1] = -d[1] / det;
        inverse[2] = d[0] / det;
        rounded = 0x1p-50 * (inverse[0] + inverse[2]) * (1.0 + condition);
    }
    rest_sum = q->rest[0] + q->rest[1];
    for (int i = 0; i < 2; i++) {
        const double i0 = fabs(inverse[i]) + rounded, i1 = fabs(inverse[i + 1]) + rounded;
        double e = bent[i] + bent[2];

        e += q->missed[i];
        for (int k = 0; k < w->columns; k++)
            e += 0x1p-50 * fabs(next->column[i][k]);
        e += 4.0 * q->fuzz * (q->reach[0] + q->reach[1] + w->h[i] + w->h[2])
             + 0x1p-50 * o->reach[i];
        e += is_first ? o->rest[i] : i0 * o->force[0] + i1 * o->force[1];
        q->force[i] = (e + (2.0 * q->fuzz + rounded) * rest_sum) * WIDEN;
    }
    for (int j = 0; j < 3; j++)
        q->d[j] = q->beta[j] - inverse[j];
    for (int i = 0; i < 2; i++)
        next->rest[i] = (fabs(q->d[i]) * q->rest[0] + fabs(q->d[i + 1]) * q->rest[1]
                         + q->force[i]) * WIDEN;
    finish(w, next);
    return 1;
}

/* ---- the witness: nothing rigorous rests on it */

/* The least eigenvalue of a symmetric matrix, and a unit eigenvector. */
static double least(const double d[3], double n[2])
{
    const double half = 0.5 * (d[0] - d[2]);
    const double value = 0.5 * (d[0] + d[2]) - sqrt(half * half + d[1] * d[1]);
    const double a = d[0] > d[2] ? d[1] : value - d[2], b = d[0] > d[2] ? value - d[0] : d[1];
    const double length = sqrt(a * a + b * b);

    n[0] = length > 0.0 ? a / length : 1.0;
    n[1] = length > 0.0 ? b / length : 0.0;
    return value;
}

static int above(const double d[3], double l)
{
    return d[0] > l && (d[0] - l) * (d[2] - l) > d[1] * d[1];
}

/* d' = beta - 1/d */
static void block(double next[3], const double beta[3], const double d[3])
{
    const double det = d[0] * d[2] - d[1] * d[1];

    next[0] = beta[0] - d[2] / det;
    next[1] = beta[1] + d[1] / det;
    next[2] = beta[2] - d[0] / det;
}

/* n = n / d */
static void divide(double n[2], const double m[2], const double d[3])
{
    const double det = d[0] * d[2] - d[1] * d[1];

    n[0] = (d[2] * m[0] - d[1] * m[1]) / det;
    n[1] = (d[0] * m[1] - d[1] * m[0]) / det;
}

/* The last blocks before the recursion falls below l: from the left, up to index `to`.  Returns
   where it falls, or to + 1.  from_right: the same from `to` downwards. */
static int fall_left(loewner *w, int from, int to)
{
    const double start[3] = { 1.0 / w->l, 0.0, 1.0 / w->l }, *d = start;
    point *q = w->orbit;

    for (int j = from; j <= to; j++) {
        block(q[j].left, q[j].beta, d);
        d = q[j].left;
        if (!above(d, w->l))
            return j;
    }
    return to + 1;
}

static int fall_right(loewner *w, int from, int to)
{
    const double start[3] = { 1.0 / w->l, 0.0, 1.0 / w->l }, *d = start;
    point *q = w->orbit;

    for (int j = to; j >= from; j--) {
        block(q[j].right, q[j].beta, d);
        d = q[j].right;
        if (!above(d, w->l))
            return j;
    }
    return from - 1;
}

/* Chooses from, to and n on the orbit so that (1) is negative at the centre.  0: it never is.

   Between the places where the recursions from both ends fall all blocks are above l.  There n is,
   at the site of the least beta, the eigenvector of the quadratic form that is left there when all
   others are eliminated; outwards n = n / d.  The sites that are summed over, from..until, hold 0
   and 1, with n = 0 where need be. */
static int witness(loewner *w)
{
    point *q = w->orbit;
    double value = HUGE_VAL, form[3], ignored[2];
    int site, from, to = w->last;
    const int fall = fall_left(w, w->first, w->last);

    if (fall > w->last)
        return 0;
    from = fall_right(w, w->first, to);
    if (from < w->first || from > fall) {               /* two places apart: the left one alone */
        to = fall;
        from = fall_right(w, w->first, to);
        if (from < w->first)
            from = fall;                                /* by a rounding only */
    }
    site = from;
    for (int j = from; j <= fall; j++) {
        const double v = least(q[j].beta, ignored);
        if (v < value) {
            value = v;
            site = j;
        }
    }
    for (int k = 0; k < 3; k++)
        form[k] = q[site].left[k] + q[site].right[k] - q[site].beta[k];
    least(form, q[site].n);
    w->from = w->first;
    w->to = to;
    w->until = to > ORIGIN ? to : ORIGIN + 1;
    for (int j = to + 1; j <= w->until; j++)
        q[j].n[0] = q[j].n[1] = 0.0;
    for (int j = site - 1; j >= w->from; j--)
        divide(q[j].n, q[j + 1].n, q[j].left);
    for (int j = site + 1; j <= w->to; j++)
        divide(q[j].n, q[j - 1].n, q[j].right);
    return 1;
}

/* ---- the bound */

/* The multipliers, by (2): zero outside, and from either end up to the sites 0 and 1. */
static void set_multipliers(loewner *w)
{
    point *q = w->orbit;

    for (int j = w->from - 1; j <= w->until + 1; j++)
        q[j].mu[0] = q[j].mu[1] = 0.0;
    for (int j = w->from; j <= w->until; j++) {
        const double omega = square(q[j].n[0] + q[j].n[1]);
        const double sum = omega * w->p[2] * q[j].cosine[2];
        for (int i = 0; i < 2; i++)
            q[j].gradient[i] = -(square(q[j].n[i]) * w->p[i] * q[j].cosine[i] + sum);
    }
    for (int j = w->until; j > ORIGIN + 1; j--)
        for (int i = 0; i < 2; i++)
            q[j - 1].mu[i] = q[j].gradient[i] + q[j].beta[i] * q[j].mu[0]
                             + q[j].beta[i + 1] * q[j].mu[1] - q[j + 1].mu[i];
    for (int j = w->from; j < ORIGIN; j++)
        for (int i = 0; i < 2; i++)
            q[j + 1].mu[i] = q[j].gradient[i] + q[j].beta[i] * q[j].mu[0]
                             + q[j].beta[i + 1] * q[j].mu[1] - q[j - 1].mu[i];
}

/* w->bound >= (1) over the whole prism; w->share[k]: how much of it each column is to blame for;
   w->rounding: how much of it roundings are.  Needs a witness.

   The sums with signs are the constant `centre` and the coefficients of the parameters; `mass` is
   the sum of their terms' absolute values.  At each site less than 16 numbers are added to any sum,
   each addition rounds by u of the partial sums, and each number by a few u of itself: together by
   less than `each` = 32 u for every site.  The sines add 2^-49 (1 + |x0| + |x1|).  Where a wave comes
   with a reach, so does its part of the mass. */
static void bound_second_variation(loewner *w)
{
    double centre = 0.0, mass = 0.0, rest = 0.0, rounding = 0.0, far = 0.0;
    double along[WAVES] = { 0, 0, 0 }, along_mass = 0.0, tails, total;
    const double each = 0x1p-48 * (double)(w->until - w->from + 2);

    set_multipliers(w);
    for (int k = 0; k < COLUMNS; k++)
        w->share[k] = 0.0;
    for (int j = w->from; j <= w->until; j++) {
        const point *q = w->orbit + j;
        const double n0 = q->n[0], n1 = q->n[1], mu0 = q->mu[0], mu1 = q->mu[1];
        const double omega[WAVES] = { n0 * n0, n1 * n1, square(n0 + n1) };
        const double m[WAVES] = { mu0, mu1, mu0 + mu1 };
        const double weights = omega[0] + omega[1] + omega[2] + fabs(mu0) + fabs(mu1);

        centre += 2.0 * (omega[0] + omega[1]);
        mass += 2.0 * (omega[0] + omega[1]);
        if (j < w->to) {
            const double *next = q[1].n;
            centre -= 2.0 * (n0 * next[0] + n1 * next[1]);
            mass += 2.0 * (fabs(n0 * next[0]) + fabs(n1 * next[1]));
        }
        far = larger(far, q->far);
        for (int i = 0; i < WAVES; i++) {
            const double s = q->sine[i], c = q->cosine[i], p = w->p[i], rho = q->reach[i];
            const double h = w->h[i] + w->loose[i], half_square = 0.5 * rho * rho;
            const double A = m[i] * c - omega[i] * s, B = -omega[i] * c - m[i] * s;
            const double term = (larger(0.0, -p * A) + h * fabs(A)) * half_square
                + fabs(B) * (size(w, i) * rho * half_square * (1.0 / 3.0) + h * rho);

            centre -= omega[i] * p * s;
            mass += omega[i] * fabs(p);
            along[i] += A;
            along_mass += (omega[i] + fabs(m[i])) * (h + (size(w, i) * rho * (1.0 + rho) + h) * rho);
            rest += term;
            if (rho > 0.0) {
                const double part = term / rho;
                for (int k = 0; k < w->columns; k++)
                    w->share[k] += part * fabs(i < 2 ? q->column[i][k]
                                                     : q->column[0][k] + q->column[1][k]);
            }
        }
        /* what (2) leaves, and what the centre's steps missed */
        for (int i = 0; i < 2; i++) {
            const double before = q[-1].mu[i], after = q[1].mu[i];
            double left = 4.0 * q->fuzz * weights + 0x1p-50 * (fabs(before) + fabs(after));
            if (j == ORIGIN || j == ORIGIN + 1) {
                const double slope = fabs(q->gradient[i] + q->beta[i] * mu0
                                          + q->beta[i + 1] * mu1 - before - after);
                if (j == ORIGIN + 1)
                    w->share[i] += slope * q->reach[i];
                rest += slope * q->reach[i];
            }
            rounding += left * q->reach[i];
            if (j > w->from && j < w->until)
                rounding += fabs(q->mu[i]) * q->missed[i];
        }
    }
    tails = w->l * (square(w->orbit[w->from].n[0]) + square(w->orbit[w->from].n[1])
                    + square(w->orbit[w->to].n[0]) + square(w->orbit[w->to].n[1]));
    centre -= tails;
    mass += tails;
    total = 0.0;
    for (int i = 0; i < WAVES; i++) {
        const double part = w->h[i] * along[i];
        rest += w->loose[i] * fabs(along[i]);
        total = w->together ? total + part : fabs(part);
        if (!w->together || i == WAVES - 1) {
            w->share[w->together ? 2 : 2 + i] += fabs(total);
            rest += fabs(total);
        }
    }
    rounding += (mass + along_mass) * (each + 0x1p-49 * (1.0 + far));
    w->rounding = rounding * (1.0 + each);
    w->bound = centre + (rest + w->rounding) * (1.0 + each);
}

/* ---- one prism */

/* B >= the largest eigenvalue over the torus for all parameters of the cell.  It is convex in the
   parameters, so along each edge of the root it lies below the straight line between the ends, and
   so below the product of these lines, which over a cell is largest at a corner. */
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

/* The prism of the cell.  0: it is too thin for doubles. */
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
    w->l = B > 2.0 ? 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46) : 0.0;
    return 1;
}

/* The largest reach of a wave. */
static double far_reach(const loewner *w, const point *q)
{
    double reach = 0.0;

    for (int j = 0; j < WAVES; j++)
        if (size(w, j) > 0.0)
            reach = q->reach[j] > reach || isnan(q->reach[j]) ? q->reach[j] : reach;
    return reach;
}

/* Tries to prove the prism with the orbit as far as it is known.  Returns whether at least its
   centre contradicts; then w->share says why the bound failed, if it did. */
static int attempt(loewner *w, verdict *v)
{
    if (!witness(w))
        return 0;
    bound_second_variation(w);
    v->nsteps = w->to - w->from + 1;
    v->no_tori = w->bound < 0.0;
    v->reason = w->bound - 2.0 * w->rounding < 0.0 ? CV_REASON_ARITHMETIC : CV_REASON_TOO_BIG;
    return 1;
}

/* The two points that the prism gives. */
static void begin_orbit(loewner *w)
{
    point *const origin = w->orbit + ORIGIN;

    memset(origin, 0, 2 * sizeof *origin);
    for (int i = 0; i < 2; i++) {
        origin->x[i] = w->xstar[i];
        origin->rest[i] = w->xstar_err[i];
        origin[1].x[i] = w->v[i];
        origin[1].column[i][i] = w->width[i];
    }
    finish(w, origin);
    finish(w, origin + 1);
    w->first = ORIGIN;
    w->last = ORIGIN - 1;               /* none of them is in use yet */
}

/* One more point, at the end that is better known.  0: that end is known too badly, or the orbit
   is too long; why says which. */
static int lengthen(loewner *w, int *why)
{
    static const double LONGEST_REACH = 0.5;
    point *const q = w->orbit;

    if (w->last <= ORIGIN) {
        w->last++;
        return 1;
    }
    const int ahead = far_reach(w, q + w->last) < far_reach(w, q + w->first);
    point *const end = q + (ahead ? w->last : w->first);
    *why = CV_REASON_TOO_BIG;
    if (!(far_reach(w, end) <= LONGEST_REACH))
        return 0;
    *why = CV_REASON_TOO_LONG;
    if (w->last - w->first + 1 == MAX_POINTS || fabs(end->turns[0]) + fabs(end->turns[1]) > FAR)
        return 0;
    *why = CV_REASON_SINGULAR;
    if (ahead ? step(w, end + 1, end, end - 1, w->last == ORIGIN + 1)
              : step(w, end - 1, end, end + 1, w->first == ORIGIN)) {
        w->last += ahead;
        w->first -= !ahead;
        return 1;
    }
    return 0;
}

void loewner_try(loewner *w, const cv_cell *cell, verdict *v, int *axis, int *from)
{
    int points = 0, next = cell->from, contradicted = 0, why;

    memset(v, 0, sizeof *v);
    v->reason = CV_REASON_ARITHMETIC;
    *axis = 0;
    if (!set_prism(w, cell))
        return;
    begin_orbit(w);
    for (int more = 1; more;) {
        more = lengthen(w, &why);
        points += more;
        if (points >= next || !more) {
            if (attempt(w, v)) {
                if (v->no_tori)
                    return;
                if (!contradicted)
                    contradicted = points;
            }
            next = points + 1 + points / PATIENCE;
        }
    }
    v->nsteps = points;
    if (!contradicted) {                /* blame whoever is widest at the ends */
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
        if (w->share[k] > w->share[*axis])
            *axis = k;
    *from = contradicted > 3 ? contradicted - 2 : 0;
}

/* ---- for tests */

int loewner_follow(loewner *w, int s, int t, loewner_point *p)
{
    static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };
    const point *q;

    set_prism(w, &whole);
    begin_orbit(w);
    w->last = ORIGIN + 1;
    while (w->last < ORIGIN + t) {
        point *const end = w->orbit + w->last;
        if (!step(w, end + 1, end, end - 1, w->last == ORIGIN + 1))
            return 0;
        w->last++;
    }
    while (w->first > ORIGIN + s) {
        point *const end = w->orbit + w->first;
        if (!step(w, end - 1, end, end + 1, w->first == ORIGIN))
            return 0;
        w->first--;
    }
    q = w->orbit + ORIGIN + (t == 0 ? s : t);
    memcpy(p->x, q->x, sizeof p->x);
    memcpy(p->column, q->column, sizeof p->column);
    memcpy(p->rest, q->rest, sizeof p->rest);
    memcpy(p->reach, q->reach, sizeof p->reach);
    return 1;
}

int loewner_bound(loewner *w, double *bound, double *l, int *first, double n[][2], int most)
{
    *l = w->l;
    if (!witness(w) || w->to - w->from >= most)
        return 0;
    bound_second_variation(w);
    *bound = w->bound;
    *first = w->from - ORIGIN;
    for (int j = w->from; j <= w->to; j++)
        memcpy(n[j - w->from], w->orbit[j].n, sizeof n[0]);
    return w->to - w->from + 1;
}

/* ---- the problem */

/* B at one corner of the parameters, from the double instance.  Each of its bounds is a sum of less
   than 40 rounded terms of at most 4 (1 + |a| + |b| + |c|); its sines are off by SINE_ERROR and, where
   their angle is a rounded sum, by u 2 pi; and the corner is rounded: all far below 10^-12 of it. */
static double corner_largest(const loewner *w, unit *quick, const double p[3])
{
    double all = 1.0;

    for (int k = 2; k < COLUMNS; k++)
        all += fabs(w->centre[k]) + w->half[k];
    return quick_largest(quick, p) + 1e-12 * all;
}

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

loewner *loewner_new(const box *root, int together, unit *quick)
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
    w->columns = together ? 3 : 5;
    for (int corner = 0; corner < (together ? 2 : 8); corner++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            const int upper = corner >> (together ? 0 : k) & 1;
            p[k] = w->centre[2 + k] + (upper ? 1.0 : -1.0) * w->half[2 + k];
        }
        w->corner[corner] = quick == NULL ? HUGE_VAL : corner_largest(w, quick, p);
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
   parameters; 2^-45 of the sum of the terms' absolute values covers a dozen roundings and sines. */
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
    least(d, n);
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
    return sum + 0x1p-45 * mass < 0.0;
}
