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

#include "model/patch.h"
#include "model/torus.h"

enum { MAX_CELLS = 20000 };             /* At most 20,000 cells are halved. */
enum { MAX_DEPTH = 100 };               /* A cell is halved at most 100 times. */
static const double EXCESS_MAX = 5e-7;  /* The last pass bounds the maximum to within this. */
static const double TOLERANCE_RATIO = 1e-3; /* Each pass has this part of the last tolerance. */
static const double PI = 0x1.921fb54442d19p+1; /* not less than pi */

/* A wave in the coordinates of the cells.  slope[j]: the derivative of k.v by coordinate j.
   trace: of k k'.  entry: the difference of its diagonal elements, and twice the other one.  size
   >= |p|. */
typedef struct {
    double slope[2], trace, entry[2], size;
    interval phase, p;
} wave;

/* The function that is bounded, over the rectangle about 0 with half-sides `side`.  curvature[j]
   times the square of a side estimates by how much the waves change along it.  scale: about the
   size of W. */
typedef struct {
    int n, which;
    wave waves[MOST_WAVES];
    double side[2], curvature[2], scale;
} surface;

typedef struct {
    double low[2], high[2];
    int depth;
} cell;

/* >= trace or largest eigenvalue of M = sum of z[i] k k': the latter is half of
   trace + sqrt((M00 - M11)^2 + (2 M01)^2).  Both terms are scaled before they are squared, so that
   they do not overflow. */
static double trace_or_eigenvalue(const surface *q, const double z[])
{
    double trace = 0.0, size[2];

    for (int i = 0; i < q->n; i++)
        trace = just_above(trace + just_above(q->waves[i].trace * z[i]));
    if (q->which == TORUS_TRACE)
        return trace;
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

static interval along(const wave *w, const double x[2])
{
    return interval_add(interval_scale(w->slope[0], interval_of(x[0])),
                        interval_scale(w->slope[1], interval_of(x[1])));
}

/* >= trace or largest eigenvalue of W over the rectangle.  *middle becomes about the value at its
   centre.  On either diagonal the corners are at the displacements t and -t. */
static double over(const surface *q, const double low[2], const double high[2], double *middle)
{
    interval s[MOST_WAVES], c[MOST_WAVES];
    double v[2], r[2], z[2][MOST_WAVES], top = -HUGE_VAL;

    for (int j = 0; j < 2; j++) {
        v[j] = 0.5 * low[j] + 0.5 * high[j];
        r[j] = larger(just_above(v[j] - low[j]), just_above(high[j] - v[j]));
    }
    for (int i = 0; i < q->n; i++) {
        const wave *const w = &q->waves[i];
        interval_sincos(&s[i], &c[i], interval_sub(along(w, v), w->phase));
        z[0][i] = interval_mul(w->p, s[i]).high;
    }
    *middle = trace_or_eigenvalue(q, z[0]);
    for (int diagonal = 0; diagonal < 2; diagonal++) {
        const double t[2] = { r[0], diagonal == 0 ? r[1] : -r[1] };
        for (int i = 0; i < q->n; i++) {
            const wave *const w = &q->waves[i];
            const interval far = along(w, t), line = interval_mul(c[i], far);
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
    cell stack[MAX_DEPTH + 2] = { { { -q->side[0], -q->side[1] }, { q->side[0], q->side[1] }, 0 } };
    double most = *best, middle;
    int top = 0;

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
            const double x = k->high[0] - k->low[0], y = k->high[1] - k->low[1];
            const int j = x * x * q->curvature[0] < y * y * q->curvature[1];
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
static surface surface_of(int n, const torus_wave waves[], const int chosen[], int which,
                          const double *direction)
{
    const int main = direction != NULL && direction[0] == 0.0;
    surface q = { .which = which, .side = { PI, direction == NULL ? PI : 0.0 } };

    for (int i = 0; i < n; i++) {
        const double *const k = waves[i].k, sum = fabs(k[0]) + fabs(k[1]);
        wave *const w = &q.waves[q.n];
        if (!chosen[i])
            continue;
        q.n++;
        w->slope[0] = direction == NULL ? k[0] : k[main] / direction[main];
        w->slope[1] = direction == NULL ? k[1] : 0.0;
        w->trace = k[0] * k[0] + k[1] * k[1];
        w->entry[0] = k[0] * k[0] - k[1] * k[1];
        w->entry[1] = 2.0 * k[0] * k[1];
        w->phase = waves[i].phase;
        w->p = waves[i].p;
        w->size = interval_size(w->p);
        for (int j = 0; j < 2; j++)
            q.curvature[j] += w->size * sum * sum * w->slope[j] * w->slope[j];
        q.scale += w->size;
    }
    return q;
}

/* W is diagonal, and each entry has its own angle. */
static double largest_apart(int n, const torus_wave waves[], int which)
{
    double top[2];

    for (int j = 0; j < 2; j++) {
        const double axis[2] = { 1.0 - j, j };
        int chosen[MOST_WAVES];
        for (int i = 0; i < n; i++)
            chosen[i] = waves[i].k[j] != 0.0 && interval_size(waves[i].p) != 0.0;
        const surface q = surface_of(n, waves, chosen, which, axis);
        top[j] = largest(&q);
    }
    return which == TORUS_TRACE ? just_above(top[0] + top[1]) : larger(top[0], top[1]);
}

/* Where all waves depend on one combination of the angles, or each on one angle, cells in one
   dimension are enough; cells of the whole torus would crowd along ridges. */
double torus_largest(int n, const torus_wave waves[], int which)
{
    const double flat = which == TORUS_TRACE ? 4.0 : 2.0;
    const double *first = NULL; /* k of the first wave that is there */
    int there[MOST_WAVES], parallel = 1, apart = 1;

    for (int i = 0; i < n; i++) {
        const double *const k = waves[i].k;
        there[i] = interval_size(waves[i].p) != 0.0;
        if (!there[i])
            continue;
        first = first == NULL ? k : first;
        parallel = parallel && k[0] * first[1] == k[1] * first[0];
        apart = apart && (k[0] == 0.0 || k[1] == 0.0);
    }
    if (first == NULL)
        return flat;
    if (apart && !parallel)
        return just_above(flat + largest_apart(n, waves, which));
    const double common = divisor(fabs(first[0]), fabs(first[1]));
    const double direction[2] = { first[0] / common, first[1] / common };
    const surface q = surface_of(n, waves, there, which, parallel ? direction : NULL);
    return just_above(flat + largest(&q));
}
