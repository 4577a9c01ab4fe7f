/* orbit.c - the orbits of a prism, enclosed.

   Let x[j] be the orbit of the prism's centre, as doubles have it, and x[j] + D[j] any true one.
   D[j] = L[j] e + r[j], e in the unit cube, the columns L as the linearized map carries them, the
   rest r bounded by two first-order recursions that follow the factors of the linearized map,
   r[j+1] = d[j] r[j] + f[j], f[j] = f[j-1]/d[j-1] + e[j], d[j] = beta - 1/d[j-1], which grow as the
   orbits do and not as absolute values would.  The reach rho bounds |D[j]| along each wave. */
#include <string.h>

#include "prism.h"
#include "numbers/sine.h"

static const double TWO_PI = 0x1.921fb54442d18p+2;      /* less than 2^-51 below it */
static const double FAR = 1e5;          /* turns in one step after which orbits end */
static const double WIDEN = 1.0 + 0x1p-43;

/* The sines at q->x; what follows from them and from the columns and the rest.

   Sines and cosines are off by SINE_ERROR = 4 u, those of a rounded sum by u far more, and products
   with p by u: p sin and p cos are off by (5 + far) u |p|.  An entry of beta, a sum of two and an
   integer, is rounded twice more, and off by u (4 + 7 |p0| + (6 + far) |p2|) at most; fuzz is
   16 u (1 + sizes)(1 + far).  Reaches are sums of at most 8 positive terms. */
static void finish(const loewner *w, point *q)
{
    const double y[WAVES] = { q->x[0], q->x[1], q->x[0] + q->x[1] };
    double sum[WAVES] = { 0, 0, 0 }, bow[WAVES] = { 0, 0, 0 }, c_sin;

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
    for (int k = 0; k < w->pairs; k++) {
        bow[0] += fabs(q->bow[0][k]);
        bow[1] += fabs(q->bow[1][k]);
        bow[2] += fabs(q->bow[0][k] + q->bow[1][k]);
    }
    for (int j = 0; j < WAVES; j++) {
        q->straight[j] = sum[j] * WIDEN;
        q->off[j] = (bow[j] + (j < 2 ? q->rest[j] : q->rest[0] + q->rest[1])) * WIDEN;
        q->reach[j] = (sum[j] + q->off[j]) * WIDEN;
    }
}

/* How far a wave p cos(y + d) may be from p cos y - p d sin y + h e cos y, e in [-1, 1] the symbol
   of the parameter: (|p| + h + loose)(|cos y| d^2/2 + |sin y d^3|/6) + (h + loose) |sin y d|
   + loose |cos y|.  Sines are off by (4 + far) u, and the dozen roundings are relative: 2^-40 is
   a thousand times as much as either needs. */
static double bend(const loewner *w, const point *q, int wave)
{
    const double rho = q->reach[wave], a = q->straight[wave], b = q->off[wave];
    const double off = 0x1p-40 * (1.0 + q->far);
    const double c = fabs(q->cosine[wave]) + off, s = fabs(q->sine[wave]) + off;
    const double h = w->h[wave], loose = w->loose[wave], cube = rho * rho * rho * (1.0 / 6.0);

    return (fabs(w->p[wave]) * (c * (b * (2.0 * a + b) + rho * cube * 0.5) * 0.5 + s * cube)
            + (h + loose) * (c * rho * rho * 0.5 + s * cube)
            + h * s * b + loose * (s * rho + c));
}

/* next = the point after q, seen from o before it; time may run either way.  The factor begins
   with d = beta, and f then holds r(o), which is zero or the rounding of x*.  0: the factor cannot
   go on.

   The coordinates are kept modulo 2 pi.  The step of the centre misses, with every rounding and
   turn, 2 u |q| + 1.4 u |o| + 3.4 u |before| + 4.7 u |x| and what its waves are off: `missed` has
   8 u of each, and fuzz.
   The rest obeys r' = beta r - r(o) + e, where e is what the waves bend, what the step of the
   centre missed, and the roundings of the columns.  Writing r' = d r + f and, from the last step,
   r(o) = (r - f(o))/d(o), gives f = f(o)/d(o) + e + (beta - 1/d(o) - d) r, where the last bracket
   is rounding: of beta, below fuzz with that of the difference; of the inverse, whose determinant
   is off by 1 + condition units, 3 + condition units of its trace, where `rounded` has
   8 (1 + condition). */
static int step(const loewner *w, point *next, point *q, const point *o, int is_first)
{
    double source[WAVES][PAIRS], g[WAVES], bent[WAVES], inverse[3] = { 0, 0, 0 }, rounded = 0.0, rest_sum;

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
    for (int j = 0; j < WAVES; j++) {
        double c[COLUMNS];
        const int t = w->together ? 2 : 2 + j;
        for (int k = 0; k < w->columns; k++)
            c[k] = j < 2 ? q->column[j][k] : q->column[0][k] + q->column[1][k];
        for (int k = 0, kl = 0; k < w->columns; k++)
            for (int l = k; l < w->columns; l++, kl++) {
                source[j][kl] = -(k == l ? 0.5 : 1.0) * g[j] * c[k] * c[l];
                if (l == t || k == t)
                    source[j][kl] -= w->h[j] * q->sine[j] * c[l == t ? k : l];
            }
    }
    for (int i = 0; i < 2; i++)
        for (int kl = 0; kl < w->pairs; kl++)
            next->bow[i][kl] = q->beta[i] * q->bow[0][kl] + q->beta[i + 1] * q->bow[1][kl]
                             - o->bow[i][kl] + (source[i][kl] + source[2][kl]);

    if (!is_first) {
        const double *d = o->d, det = d[0] * d[2] - d[1] * d[1];
        const double condition = (fabs(d[0] * d[2]) + d[1] * d[1]) / det;
        if (!(d[0] > 0.0 && det > TINY && condition < 0x1p20))
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
        for (int k = 0; k < w->pairs; k++)
            e += 0x1p-50 * fabs(next->bow[i][k]);
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

/* The largest reach of a wave. */
static double far_reach(const loewner *w, const point *q)
{
    double reach = 0.0;

    for (int j = 0; j < WAVES; j++)
        if (size(w, j) > 0.0)
            reach = larger(reach, q->reach[j]);
    return reach;
}

void orbit_begin(loewner *w)
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

int orbit_step(loewner *w, int ahead)
{
    point *const end = w->orbit + (ahead ? w->last : w->first);

    if (ahead ? step(w, end + 1, end, end - 1, w->last == ORIGIN + 1)
              : step(w, end - 1, end, end + 1, w->first == ORIGIN)) {
        w->last += ahead;
        w->first -= !ahead;
        return 1;
    }
    return 0;
}

int orbit_lengthen(loewner *w, int *why)
{
    static const double LONGEST_REACH = 0.5;
    point *const q = w->orbit;

    if (w->last <= ORIGIN) {
        w->last++;
        return 1;
    }
    const int ahead = far_reach(w, q + w->last) < far_reach(w, q + w->first);
    const point *const end = q + (ahead ? w->last : w->first);
    *why = CV_REASON_TOO_BIG;
    if (!(far_reach(w, end) <= LONGEST_REACH))
        return 0;
    *why = CV_REASON_TOO_LONG;
    if (w->last - w->first + 1 == MAX_POINTS || fabs(end->turns[0]) + fabs(end->turns[1]) > FAR)
        return 0;
    *why = CV_REASON_SINGULAR;
    return orbit_step(w, ahead);
}
