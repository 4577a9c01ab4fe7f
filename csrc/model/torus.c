/* torus.c - the largest trace and the largest eigenvalue of beta over the whole torus and all
   parameters, by branch and bound, in doubles.  The thesis found them by Newton's method and added a
   margin; that is a guess, and everything else rests on these two numbers.

   beta(-v) = 2I + W(v), W = a sin v0 e0e0' + b sin v1 e1e1' + c sin(v0+v1) (1,1)(1,1)', and the torus
   is its own mirror image, so W serves.

   Rounding (u = 2^-53).  On a rectangle as large as the torus the bound of c sin(v0 + v1) is
   |c| (1 + t + t^2/2) with t = 2 pi, 27 |c|; those of the others are 9.1 |a| and 9.1 |b|.  Sines and
   cosines are off by 4 u, by 8 u where their angle is a rounded sum; with the roundings on the way
   these bounds are off by 214 u |c|, 57 u |a| and 57 u |b|, the eigenvalue by
   57 u max(|a|, |b|) + 428 u |c| and the trace by 57 u (|a| + |b|) + 428 u |c|.  The formula of the
   eigenvalue rounds by 50 u (|a| + |b|) + 257 u |c| + 2 u, that of the trace, four sums, by
   37 u (|a| + |b|) + 216 u |c| + 16 u.  A centre is rounded by 2 u at each of at most 100 cuts, so
   rectangles may fail to meet by as much: 200 u (|a| + |b| + 2 |c|).  TORUS_ENDS is 2048 u, and the
   ranges of the thesis's method are off by 9 u: 9 u (|a| + |b| + 2 |c|).  Together less than
   3300 u (1 + |a| + |b| + |c|); MARGIN is 9007 u. */
#include <math.h>

#include "arith/sine.h"
#include "model/torus.h"

enum { CELLS = 20000, DEPTH = 100, WAVES = 3 };
static const double MARGIN = 1e-12, NEAR = 5e-7, PI = 0x1.921fb54442d19p+1;     /* not less than pi */

typedef struct { double low[WAVES], high[WAVES], size[WAVES]; int which; } problem;
typedef struct { double v[2], r[2]; int depth; } cell;

static problem problem_of(const double low[3], const double high[3], int which)
{
    problem p = { .which = which };

    for (int i = 0; i < WAVES; i++) {
        p.low[i] = low[i];
        p.high[i] = high[i];
        p.size[i] = larger(fabs(low[i]), fabs(high[i]));
    }
    return p;
}

/* >= p sin(v + t) for every p of the range, s and c the sine and cosine of v:
   sup p (s + c t) + |p| t^2/2, since |sin''| <= 1.  As a function of t this is convex. */
static double wave(const problem *p, int i, double s, double c, double t)
{
    const double x = s + c * t;

    return x * (x < 0.0 ? p->low[i] : p->high[i]) + 0.5 * t * t * p->size[i];
}

/* >= the trace or the largest eigenvalue of 2I + W(v + t), s and c the sines and cosines of the waves
   at v.  As a function of t the bound is convex: so are the three coefficients, W grows with them in
   the Loewner order, and trace and largest eigenvalue are convex and grow with W.  The root is
   scaled, so that no square is too large. */
static double displaced(const problem *p, const double s[WAVES], const double c[WAVES], double t0,
                        double t1)
{
    const double x = wave(p, 0, s[0], c[0], t0), y = wave(p, 1, s[1], c[1], t1);
    const double z = wave(p, 2, s[2], c[2], t0 + t1), trace = (x + y) + 2.0 * z;
    const double a = x - y, b = 2.0 * z, scale = larger(larger(fabs(a), fabs(b)), 0x1p-1000);
    const double e = a / scale, f = b / scale;

    if (p->which == TORUS_TRACE)
        return trace + 4.0;
    return 0.5 * (trace + scale * sqrt(e * e + f * f)) + 2.0;
}

static void waves_at(const double v[2], double s[WAVES], double c[WAVES])
{
    double_sincos(&s[0], &c[0], v[0]);
    double_sincos(&s[1], &c[1], v[1]);
    double_sincos(&s[2], &c[2], v[0] + v[1]);
}

/* >= the same for every point of the rectangle: a convex function is largest at a corner.
   *middle: the value at its centre. */
static double over(const problem *p, const double v[2], const double r[2], double *middle)
{
    double s[WAVES], c[WAVES], most;

    waves_at(v, s, c);
    *middle = displaced(p, s, c, 0.0, 0.0);
    most = displaced(p, s, c, r[0], r[1]);
    most = larger(displaced(p, s, c, -r[0], r[1]), most);
    most = larger(displaced(p, s, c, r[0], -r[1]), most);
    return larger(displaced(p, s, c, -r[0], -r[1]), most);
}

/* What is bounded: by `over`, over cells of a rectangle of these sides about 0. */
typedef struct {
    double (*over)(const void *of, const double v[2], const double r[2], double *middle);
    const void *of;
    double side[2], reach[2];           /* reach: how much the square of a side moves the waves */
    double all, no_more, margin, last;  /* sizes added up; no value is above; roundings; tolerance */
    double closer;                      /* of each pass's tolerance, that of the next */
} surface;

/* One pass over the torus: *best becomes the largest value seen at any centre, if larger than
   before; the result is >= every value on the torus, and at most *best + tolerance unless depth or
   patience ran out, when it is looser, and still a bound.  cells: how many were halved so far.

   A cell is done when its bound is at most *best + tolerance; otherwise it is halved along the side
   whose square moves the waves most, since it is at their maxima, where they are parabolas, that
   cells have to be small. */
static double pass(const surface *p, double *best, double tolerance, long *cells)
{
    cell stack[DEPTH + 2] = { { { 0.0, 0.0 }, { p->side[0], p->side[1] }, 0 } };
    double most = *best, middle;
    int top = 0;

    while (top >= 0) {
        cell *const k = stack + top, *const other = stack + top + 1;
        const double bound = p->over(p->of, k->v, k->r, &middle);
        if (isnan(bound))
            return bound;
        *best = larger(*best, middle);
        if (bound <= *best + tolerance || k->depth == DEPTH || ++*cells > CELLS) {
            most = larger(most, bound);
            top--;
        } else {
            const int j = k->r[0] * k->r[0] * p->reach[0] < k->r[1] * k->r[1] * p->reach[1];
            k->depth++;
            k->r[j] *= 0.5;
            *other = *k;
            other->v[j] += k->r[j];
            k->v[j] -= k->r[j];
            top++;
        }
    }
    return most;
}

/* Each pass looks more closely than the last, whose best value spares it all but the neighbourhood of
   the maximum.  Cells run out where the maximum is a ridge, or there are many.  Then the result is the
   best bound of the passes or, if that is less, what no sines exceed. */
static double largest(const surface *p)
{
    double best = 0.0, most = HUGE_VAL;                 /* 0: the mean is above */
    long cells = 0;

    for (double tolerance = 0.5 * p->all; ; tolerance *= p->closer) {
        const int done = tolerance <= 2.0 * p->last;
        const double found = pass(p, &best, done ? p->last : tolerance, &cells);
        most = isnan(found) || found < most ? found : most;
        if (cells > CELLS)
            most = p->no_more < most ? p->no_more : most;
        if (done || cells > CELLS || isnan(most))
            return most + p->margin;
    }
}

static double over_three(const void *of, const double v[2], const double r[2], double *middle)
{
    return over(of, v, r, middle);
}

/* A thousand times more closely in each pass, down to NEAR and 10^-12 of the parameters.  There are
   ridges across the cells if |c| is much larger than |a| or |b|, along them if c = 0 and |a| and |b|
   differ, since the larger of two waves does not depend on the other's angle; the bound
   4 + |a| + |b| + 2|c| or 2 + max(|a|, |b|) + 2|c|, that they nearly reach, serves there. */
double torus_largest(const double low[3], const double high[3], int which)
{
    const problem p = problem_of(low, high, which);
    const double all = p.size[0] + p.size[1] + p.size[2];
    const surface s = {
        over_three, &p, { PI, PI }, { p.size[0] + p.size[2], p.size[1] + p.size[2] }, all,
        2.0 * p.size[2] + (which == TORUS_TRACE
            ? 4.0 + p.size[0] + p.size[1] : 2.0 + larger(p.size[0], p.size[1])),
        MARGIN * (1.0 + all), NEAR + MARGIN * all, 1e-3
    };

    return largest(&s);
}

double torus_rectangle(const double low[3], const double high[3], const double centre[2],
                       const double half[2], int which)
{
    const problem p = problem_of(low, high, which);
    double middle;

    return over(&p, centre, half, &middle);
}

/* ---- any waves

   Again beta(-v) = 2I + W(v), W = sum of p sin(k.v - phase) k k'.  Where all waves feel one and the
   same combination of the angles, and where none feels both, the torus is too large: its ridges need no
   cells.  So waves say apart what they feel, of the cells' coordinates, and what they do.

   Rounding.  Let K be the largest |k0| + |k1|, and P the sum of |p| times K^2.  On a cell as large as
   the torus a wave is at most |p| (1 + t + t^2/2) <= 5 |p| (1 + K)^2, t = K pi.  Sines and cosines are
   off by (4 + 10 K + 70) u, for k.v and a phase below 2 pi, W by 30 u more for 16 waves, the
   eigenvalue by 10 u; that is less than 600 (1 + K)^3 u P.  Cells fail to meet by 200 u pi at most,
   which is worth 630 K u P.  Together, with TORUS_ENDS, less than 3000 (1 + K)^3 u (1 + P); the margin
   is 8192 (1 + K)^3 u (1 + P). */

enum { MOST_WAVES = 16 };

typedef struct {
    int n;
    double feels[MOST_WAVES][2], does[MOST_WAVES][3], phase[MOST_WAVES], p[MOST_WAVES];
} potential;

/* >= the largest eigenvalue of 2I + W(v + t), as a function of t convex, as above. */
static double moved(const potential *q, const double s[], const double c[], const double t[2])
{
    double m[3] = { 0.0, 0.0, 0.0 };

    for (int i = 0; i < q->n; i++) {
        const double along = q->feels[i][0] * t[0] + q->feels[i][1] * t[1];
        const double z = q->p[i] * (s[i] + c[i] * along) + 0.5 * along * along * fabs(q->p[i]);
        for (int j = 0; j < 3; j++)
            m[j] += z * q->does[i][j];
    }
    const double a = m[0] - m[2], b = 2.0 * m[1];
    const double scale = larger(larger(fabs(a), fabs(b)), 0x1p-1000), e = a / scale, f = b / scale;
    return 0.5 * ((m[0] + m[2]) + scale * sqrt(e * e + f * f)) + 2.0;
}

static double over_any(const void *of, const double v[2], const double r[2], double *middle)
{
    static const double still[2] = { 0.0, 0.0 };
    const potential *const q = of;
    double s[MOST_WAVES], c[MOST_WAVES], top = -HUGE_VAL;

    for (int i = 0; i < q->n; i++)
        double_sincos(&s[i], &c[i], (q->feels[i][0] * v[0] + q->feels[i][1] * v[1]) - q->phase[i]);
    *middle = moved(q, s, c, still);
    for (int corner = 0; corner < 4; corner++) {
        const double t[2] = { corner & 1 ? r[0] : -r[0], corner & 2 ? r[1] : -r[1] };
        top = larger(moved(q, s, c, t), top);
    }
    return top;
}

/* The bound of those waves that `which` names.  direction: what they all feel is a multiple of it,
   which is not zero at `main`; or NULL. */
static double largest_of(int n, const double k[][2], const double phase[], const double p[],
                         const int which[], const double *direction, int main)
{
    potential q = { 0 };
    surface s = { .over = over_any, .of = &q, .side = { PI, direction == NULL ? PI : 0.0 },
                  .no_more = 2.0, .closer = 0.03 };
    double most_k = 0.0, all = 0.0;

    for (int i = 0; i < n; i++) {
        const double sum = fabs(k[i][0]) + fabs(k[i][1]);
        if (!which[i])
            continue;
        q.feels[q.n][0] = direction == NULL ? k[i][0] : k[i][main] / direction[main];
        q.feels[q.n][1] = direction == NULL ? k[i][1] : 0.0;
        for (int j = 0; j < 3; j++)
            q.does[q.n][j] = k[i][j / 2] * k[i][(j + 1) / 2];
        for (int j = 0; j < 2; j++)
            s.reach[j] += fabs(p[i]) * sum * sum * q.feels[q.n][j] * q.feels[q.n][j];
        q.phase[q.n] = phase[i];
        q.p[q.n++] = p[i];
        most_k = larger(most_k, sum);
        all += fabs(p[i]);
        s.no_more += fabs(p[i]) * (k[i][0] * k[i][0] + k[i][1] * k[i][1]);
    }
    s.all = all * most_k * most_k;
    s.margin = 0x1p-40 * (1.0 + most_k) * (1.0 + most_k) * (1.0 + most_k) * (1.0 + s.all);
    s.last = NEAR + s.margin;
    return largest(&s);
}

double torus_waves(int n, const double k[][2], const double phase[], const double p[])
{
    int all[MOST_WAVES], feels[2][MOST_WAVES], parallel = n > 0, apart = 1;
    double direction[2] = { 0.0, 0.0 }, top = 2.0;

    for (int i = 0; i < n; i++) {
        all[i] = 1;
        feels[0][i] = k[i][0] != 0.0;
        feels[1][i] = k[i][1] != 0.0;
        parallel = parallel && k[i][0] * k[0][1] == k[i][1] * k[0][0];
        apart = apart && !(feels[0][i] && feels[1][i]);
    }
    if (parallel) {
        const double common = divisor(fabs(k[0][0]), fabs(k[0][1]));
        direction[0] = k[0][0] / common;
        direction[1] = k[0][1] / common;
        return largest_of(n, k, phase, p, all, direction, direction[0] == 0.0);
    }
    for (int j = 0; j < 2 && apart; j++) {              /* the larger eigenvalue of the two */
        direction[j] = 1.0;
        direction[1 - j] = 0.0;
        top = larger(top, largest_of(n, k, phase, p, feels[j], direction, j));
    }
    return apart ? top : largest_of(n, k, phase, p, all, NULL, 0);
}
