/* torus.c - the largest trace and the largest eigenvalue of beta over the whole torus and ranges
   of amplitudes, by branch and bound, in intervals.  The thesis found them by Newton's method and
   added a margin; that is a guess, and everything else rests on these two numbers.

   beta(-v) = 2I + W(v), W(v) = sum of p sin(k.v - phase) k k', and the torus is its own mirror
   image, so W serves.  With y = k.v - phase and t a displacement along k, |sin''| <= 1 says

       p sin(y + t) <= p (sin y + t cos y) + |p| t^2/2.

   The right side is convex in t; W grows with these coefficients in the Loewner order, and trace
   and largest eigenvalue are convex and grow with W.  So over a rectangle about v their bounds are
   largest at a corner.  docs/proofs/argument.md, section 4. */
#include <assert.h>
#include <string.h>

#include "arith/sym.h"
#include "model/patch.h"
#include "model/torus.h"

enum { MAX_CELLS = 20000 };             /* At most 20,000 cells are halved. */
enum { MAX_DEPTH = 100 };               /* A cell is halved at most 100 times. */
static const double EXCESS_MAX = 5e-7;  /* The last pass bounds the maximum to within this. */
static const double TOLERANCE_RATIO = 1e-3; /* Each pass has this part of the last tolerance. */
static const double PI = 0x1.921fb54442d19p+1; /* not less than pi */

/* A wave in the coordinates of the cells.  slope[j]: the derivative of k.v by coordinate j.
   trace: of k k'.  entry: where there are no three angles, the difference of its diagonal elements,
   and twice the other one.  size >= |p|. */
typedef struct {
    double slope[ANGLES], k[ANGLES], trace, entry[2], size;
    interval phase, p;
} wave;

/* The function that is bounded, over the box about 0 with half-sides `side`, of so many dimensions.
   curvature[j] times the square of a side estimates by how much the waves change along it.  scale:
   about the size of W. */
typedef struct {
    int angles, dimensions, n, which;
    wave waves[MOST_WAVES];
    double side[ANGLES], curvature[ANGLES], scale;
} surface;

typedef struct {
    double low[ANGLES], high[ANGLES];
    int depth;
} cell;

/* Is x - m positive definite for all m of the intervals?  Its leading minors are positive. */
static int is_above(double x, const interval m[MOST_ENTRIES])
{
    interval e[MOST_ENTRIES];

    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            e[sym_at(3, i, j)] = interval_sub(interval_of(i == j ? x : 0.0), m[sym_at(3, i, j)]);
    const interval two = interval_sub(interval_mul(e[0], e[3]), interval_mul(e[1], e[1]));
    const interval a = interval_sub(interval_mul(e[1], e[4]), interval_mul(e[2], e[3]));
    const interval b = interval_sub(interval_mul(e[1], e[2]), interval_mul(e[0], e[4]));
    const interval last = interval_add(interval_mul(e[4], b), interval_mul(e[5], two));

    return e[0].low > 0.0 && two.low > 0.0 && interval_add(interval_mul(e[2], a), last).low > 0.0;
}

/* >= the largest eigenvalue of M = sum of z[i] k k' of three rows: a number a little above it, if a
   test confirms that, or else the sum of all |M[i][j]|. */
static double largest_of_three(const surface *q, const double z[])
{
    interval m[MOST_ENTRIES] = { { 0.0, 0.0 } };
    double minus[MOST_ENTRIES], sum = 0.0;

    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            interval *const entry = &m[sym_at(3, i, j)];
            for (int w = 0; w < q->n; w++)
                *entry = interval_add(
                    *entry, interval_scale(q->waves[w].k[i] * q->waves[w].k[j], interval_of(z[w])));
            minus[sym_at(3, i, j)] = -entry->high;
            sum = just_above(sum + (i == j ? 1.0 : 2.0) * interval_size(*entry));
        }
    const double x = -sym_least_eigenvalue(3, minus) + 0x1p-40 * sum;
    return is_above(x, m) ? x : sum;
}

/* >= trace or largest eigenvalue of M = sum of z[i] k k': of two rows the latter is half of
   trace + sqrt((M00 - M11)^2 + (2 M01)^2).  Both terms are scaled before they are squared, so that
   they do not overflow. */
static double trace_or_eigenvalue(const surface *q, const double z[])
{
    double trace = 0.0, size[2];

    for (int i = 0; i < q->n; i++)
        trace = just_above(trace + just_above(q->waves[i].trace * z[i]));
    if (q->which == TORUS_TRACE)
        return trace;
    if (q->angles == 3)
        return largest_of_three(q, z);
    for (int j = 0; j < 2; j++) {
        interval sum = { 0.0, 0.0 };
        for (int i = 0; i < q->n; i++)
            if (q->waves[i].entry[j] != 0.0)
                sum = interval_add(sum, interval_scale(q->waves[i].entry[j], interval_of(z[i])));
        size[j] = interval_size(sum);
    }
    const double scale = larger(larger(size[0], size[1]), 0x1p-900);
    const double x = just_above(size[0] / scale), y = just_above(size[1] / scale);
    const double root = just_above(sqrt(just_above(just_above(x * x) + just_above(y * y))));
    return just_above(0.5 * just_above(trace + just_above(scale * root)));
}

static interval along(const surface *q, const wave *w, const double x[ANGLES])
{
    interval sum = interval_scale(w->slope[0], interval_of(x[0]));

    for (int j = 1; j < q->dimensions; j++)
        sum = interval_add(sum, interval_scale(w->slope[j], interval_of(x[j])));
    return sum;
}

/* >= trace or largest eigenvalue of W over the box.  *middle becomes about the value at its centre.
   On each diagonal the corners are at the displacements t and -t. */
static double over(const surface *q, const double low[ANGLES], const double high[ANGLES],
                   double *middle)
{
    interval s[MOST_WAVES], c[MOST_WAVES];
    double v[ANGLES], r[ANGLES], z[2][MOST_WAVES], top = -HUGE_VAL;

    for (int j = 0; j < q->dimensions; j++) {
        v[j] = 0.5 * low[j] + 0.5 * high[j];
        r[j] = larger(just_above(v[j] - low[j]), just_above(high[j] - v[j]));
    }
    for (int i = 0; i < q->n; i++) {
        const wave *const w = &q->waves[i];
        interval_sincos(&s[i], &c[i], interval_sub(along(q, w, v), w->phase));
        z[0][i] = interval_mul(w->p, s[i]).high;
    }
    *middle = trace_or_eigenvalue(q, z[0]);
    for (int diagonal = 0; diagonal < 1 << (q->dimensions - 1); diagonal++) {
        double t[ANGLES];
        for (int j = 0; j < q->dimensions; j++)
            t[j] = j > 0 && diagonal >> (j - 1) & 1 ? -r[j] : r[j];
        for (int i = 0; i < q->n; i++) {
            const wave *const w = &q->waves[i];
            const interval far = along(q, w, t), line = interval_mul(c[i], far);
            const double size = interval_size(far);
            const double bow = just_above(0.5 * just_above(w->size * just_above(size * size)));
            z[0][i] = just_above(interval_mul(w->p, interval_add(s[i], line)).high + bow);
            z[1][i] = just_above(interval_mul(w->p, interval_sub(s[i], line)).high + bow);
        }
        top = larger(larger(trace_or_eigenvalue(q, z[0]), trace_or_eigenvalue(q, z[1])), top);
    }
    return top;
}

/* One pass over the torus.  *best becomes the largest value seen at any centre, if larger than
   before.  The result is >= every value on the torus.  It is at most *best + tolerance, unless
   MAX_DEPTH or MAX_CELLS was reached.  *cells counts the cells that were halved.

   A cell is done when its bound is at most *best + tolerance.  Otherwise it is halved along the
   side with the larger curvature times square, since near a maximum the bound's excess is
   quadratic in the sides.  Both halves have the same end, so that they leave no gap. */
static double pass(const surface *q, double *best, double tolerance, long *cells)
{
    cell stack[MAX_DEPTH + 2] = { { { 0.0 }, { 0.0 }, 0 } };
    double most = *best, middle;
    int top = 0;

    for (int j = 0; j < q->dimensions; j++) {
        stack[0].low[j] = -q->side[j];
        stack[0].high[j] = q->side[j];
    }
    while (top >= 0) {
        cell *const k = stack + top, *const other = stack + top + 1;
        const double bound = over(q, k->low, k->high, &middle);
        if (!(bound < HUGE_VAL))
            return HUGE_VAL;
        *best = larger(*best, middle);
        if (bound <= *best + tolerance || k->depth == MAX_DEPTH || ++*cells > MAX_CELLS) {
            most = larger(most, bound);
            top--;
        } else {
            double bends = -1.0;
            int j = 0;
            for (int i = 0; i < q->dimensions; i++) {
                const double x = k->high[i] - k->low[i];
                if (x * x * q->curvature[i] > bends) {
                    bends = x * x * q->curvature[i];
                    j = i;
                }
            }
            assert(top + 1 < MAX_DEPTH + 2);
            k->depth++;
            *other = *k;
            k->high[j] = other->low[j] = 0.5 * k->low[j] + 0.5 * k->high[j];
            top++;
        }
    }
    return most;
}

/* >= trace or largest eigenvalue of W over the torus.  Each pass has a smaller tolerance than the
   last, whose best value confines it to the neighbourhood of the maximum.  MAX_CELLS is reached
   where the maximum is a ridge, or there are many maxima; then the result is the best bound so
   far.  It is at most the value with all waves at their maxima, which ridges nearly reach. */
static double largest(const surface *q)
{
    const double last = EXCESS_MAX + 1e-12 * q->scale;
    double best = 0.0, most, crests[MOST_WAVES]; /* best: the mean is above */
    long cells = 0;

    for (int i = 0; i < q->n; i++)
        crests[i] = q->waves[i].size;
    most = trace_or_eigenvalue(q, crests);
    for (double tolerance = 0.5 * q->scale;; tolerance *= TOLERANCE_RATIO) {
        const int done = !(tolerance > 2.0 * last);
        const double found = pass(q, &best, done ? last : tolerance, &cells);
        most = found < most ? found : most;
        if (done || cells > MAX_CELLS || !(most < HUGE_VAL))
            return most;
    }
}

/* The surface of the chosen waves.  direction: NULL, or a vector of which each k is a multiple, so
   that one coordinate is enough. */
static surface surface_of(int angles, int n, const torus_wave waves[], const int chosen[],
                          int which, const double *direction)
{
    surface q = { .angles = angles,
                  .dimensions = direction == NULL ? angles : 1,
                  .which = which,
                  .side = { PI, PI, PI } };
    int main = 0;

    while (direction != NULL && direction[main] == 0.0)
        main++;
    for (int i = 0; i < n; i++) {
        const double *const k = waves[i].k, sum = fabs(k[0]) + fabs(k[1]) + fabs(k[2]);
        wave *const w = &q.waves[q.n];
        if (!chosen[i])
            continue;
        q.n++;
        memcpy(w->k, k, sizeof w->k);
        memcpy(w->slope, k, sizeof w->slope);
        if (direction != NULL)
            w->slope[0] = k[main] / direction[main];
        w->trace = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
        w->entry[0] = k[0] * k[0] - k[1] * k[1];
        w->entry[1] = 2.0 * k[0] * k[1];
        w->phase = waves[i].phase;
        w->p = waves[i].p;
        w->size = interval_size(w->p);
        for (int j = 0; j < q.dimensions; j++)
            q.curvature[j] += w->size * sum * sum * w->slope[j] * w->slope[j];
        q.scale += w->size;
    }
    return q;
}

/* W is diagonal, and each entry has its own angle. */
static double largest_apart(int angles, int n, const torus_wave waves[], int which)
{
    double trace = 0.0, most = -HUGE_VAL;

    for (int j = 0; j < angles; j++) {
        const double axis[ANGLES] = { j == 0, j == 1, j == 2 };
        int chosen[MOST_WAVES];
        for (int i = 0; i < n; i++)
            chosen[i] = waves[i].k[j] != 0.0 && interval_size(waves[i].p) != 0.0;
        const surface q = surface_of(angles, n, waves, chosen, which, axis);
        const double top = largest(&q);
        trace = just_above(trace + top);
        most = larger(most, top);
    }
    return which == TORUS_TRACE ? trace : most;
}

/* Where all waves depend on one combination of the angles, or each on one angle, cells in one
   dimension are enough; cells of the whole torus would crowd along ridges. */
double torus_largest(int angles, int n, const torus_wave waves[], int which)
{
    const double flat = which == TORUS_TRACE ? 2.0 * angles : 2.0;
    const double *first = NULL; /* k of the first wave that is there */
    int there[MOST_WAVES], parallel = 1, apart = 1;

    for (int i = 0; i < n; i++) {
        const double *const k = waves[i].k;
        there[i] = interval_size(waves[i].p) != 0.0;
        if (!there[i])
            continue;
        first = first == NULL ? k : first;
        for (int j = 0; j < ANGLES; j++) {
            const int l = (j + 1) % ANGLES;
            parallel = parallel && k[j] * first[l] == k[l] * first[j];
            apart = apart && (k[j] == 0.0 || k[l] == 0.0);
        }
    }
    if (first == NULL)
        return flat;
    if (apart && !parallel)
        return just_above(flat + largest_apart(angles, n, waves, which));
    const double common = divisor(divisor(fabs(first[0]), fabs(first[1])), fabs(first[2]));
    const double direction[ANGLES] = { first[0] / common, first[1] / common, first[2] / common };
    const surface q = surface_of(angles, n, waves, there, which, parallel ? direction : NULL);
    return just_above(flat + largest(&q));
}
