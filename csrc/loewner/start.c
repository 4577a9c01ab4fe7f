/* start.c - where orbits are to start, so that the proof is short: plain double precision.

   A proof succeeds when no minimizing orbit leads through x*, so x* should lie in the middle of the
   gap that minimizing orbits leave.  Two answers are compared.  The first lies between the place
   where beta is least, where a single point contradicts minimality soonest, and the minimum of the
   potential, which minimizing orbits shun most.  The second asks nine points of each orbit through
   x*: when all others are eliminated they leave a quadratic form at x*, and its least eigenvalue,
   for the orbit where that is largest, is to be as small as can be.  (If nothing is left, a weaker
   potential is asked: the place hardly depends on its size.) */
#include <math.h>
#include <stdlib.h>

#include "start.h"

enum { STEPS = 200, GRID = 24, FINEST_GRID = 240 };
enum { REACH = 4 };                     /* points on either side of x* */
enum { PLACES = 16, OFFSETS = 24, HALVINGS = 6 };
static const double TOLERANCE = 1e-9, MAX_JUMP = 0.5, PI = 3.14159265358979323846;
static const double BETWEEN = 0.28;     /* of the way from the least beta to the least potential */
static const double NOTHING = 1e-6;     /* no better than that: it may be rounding */
static const double PLAINLY = 0.001;    /* better: enough for giving up symmetry */
static const double ENOUGH = 0.06, WEAKER = 0.97;       /* so much must be left; else V is weakened */

/* What is minimized, its gradient g and Hessian h (00, 01, 11). */
typedef double objective(const waves *v, const double x[2], double g[2], double h[3]);

static double potential(const waves *v, const double x[2], double g[2], double h[3])
{
    double value = 0.0;

    g[0] = g[1] = h[0] = h[1] = h[2] = 0.0;
    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], y = k0 * x[0] + k1 * x[1] + v->phase[j];
        const double s = v->p[j] * sin(y), c = v->p[j] * cos(y);
        value -= s;
        g[0] -= c * k0;
        g[1] -= c * k1;
        h[0] += s * k0 * k0;
        h[1] += s * k0 * k1;
        h[2] += s * k1 * k1;
    }
    return value;
}

/* Of beta = 2 - V'', that is mean - root(apart^2 + mixed^2). */
static double least_eigenvalue(const waves *v, const double x[2], double g[2], double h[3])
{
    enum { MEAN, APART, MIXED };
    double value[3] = { 2.0, 0.0, 0.0 }, first[3][2] = { { 0.0 } }, second[3][3] = { { 0.0 } };
    double root, along[2];

    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], y = k0 * x[0] + k1 * x[1] + v->phase[j];
        const double s = v->p[j] * sin(y), c = v->p[j] * cos(y);
        const double part[3] = { 0.5 * (k0 * k0 + k1 * k1), 0.5 * (k0 * k0 - k1 * k1), k0 * k1 };
        for (int i = 0; i < 3; i++) {
            value[i] -= s * part[i];
            first[i][0] -= c * part[i] * k0;
            first[i][1] -= c * part[i] * k1;
            second[i][0] += s * part[i] * k0 * k0;
            second[i][1] += s * part[i] * k0 * k1;
            second[i][2] += s * part[i] * k1 * k1;
        }
    }
    root = sqrt(value[APART] * value[APART] + value[MIXED] * value[MIXED]);
    for (int m = 0; m < 2; m++) {
        along[m] = (value[APART] * first[APART][m] + value[MIXED] * first[MIXED][m]) / root;
        g[m] = first[MEAN][m] - along[m];
    }
    for (int m = 0, mn = 0; m < 2; m++)
        for (int n = m; n < 2; n++, mn++)
            h[mn] = second[MEAN][mn] + (along[m] * along[n]
                    - first[APART][m] * first[APART][n] - value[APART] * second[APART][mn]
                    - first[MIXED][m] * first[MIXED][n] - value[MIXED] * second[MIXED][mn]) / root;
    return value[MEAN] - root;
}

/* Newton's method from x, jumps bounded; returns the value reached, or HUGE_VAL. */
static double newton(objective *f, const waves *v, double x[2])
{
    double g[2], h[3], size = 0.0;

    for (int j = 0; j < v->n; j++)
        size += fabs(v->p[j]);
    for (int step = 0; step < STEPS; step++) {
        const double value = f(v, x, g, h), det = h[0] * h[2] - h[1] * h[1];
        double dx, dy, jump;
        if (fabs(g[0]) + fabs(g[1]) <= TOLERANCE * size)
            return value;
        dx = (g[0] * h[2] - g[1] * h[1]) / det;
        dy = (g[1] * h[0] - g[0] * h[1]) / det;
        jump = fabs(dx) + fabs(dy);
        if (!isfinite(jump))
            return HUGE_VAL;
        if (jump > MAX_JUMP) {
            dx *= MAX_JUMP / jump;
            dy *= MAX_JUMP / jump;
        }
        x[0] -= dx;
        x[1] -= dy;
    }
    return HUGE_VAL;
}

/* Less than `enough`, or at least that and no more need be known of it. */
typedef double function(void *context, const double x[2], double enough);

/* From x, where f has this value, in ever smaller steps to smaller ones, which it returns. */
static double descend(function *f, void *context, double x[2], double value, double step,
                      int on_diagonal)
{
    static const int way[8][2] = { { 1, 1 }, { -1, -1 }, { 1, 0 }, { -1, 0 },
                                   { 0, 1 }, { 0, -1 }, { 1, -1 }, { -1, 1 } };

    for (int halving = 0; halving < HALVINGS; step *= 0.5, halving++)
        for (int j = 0; j < (on_diagonal ? 2 : 8); j++) {
            const double y[2] = { x[0] + step * way[j][0], x[1] + step * way[j][1] };
            const double at_y = f(context, y, value - NOTHING);
            if (at_y < value - NOTHING) {
                value = at_y;
                x[0] = y[0];
                x[1] = y[1];
                j = -1;
            }
        }
    return value;
}

typedef struct { objective *f; const waves *v; } valley;

static double depth_of(void *context, const double x[2], double enough)
{
    const valley *const o = context;
    double g[2], h[3];

    (void)enough;
    return o->f(o->v, x, g, h);
}

/* x = a place where f is least: where Newton's method leads from (pi/2, pi/2), as in 1989, or
   from the best point of a grid if that is better, or downhill from there. */
static void find_least(objective *f, const waves *v, int on_diagonal, double x[2])
{
    double best[2] = { PI / 2, PI / 2 }, g[2], h[3], least = HUGE_VAL, value;
    int grid = GRID;

    for (int j = 0; j < v->n; j++)
        while (grid < FINEST_GRID && grid < GRID * (abs(v->k[j][0]) + abs(v->k[j][1])) / 2)
            grid += GRID;
    x[0] = x[1] = PI / 2;
    value = newton(f, v, x);
    for (int i = 0; i < grid; i++)
        for (int j = on_diagonal ? i : 0; j < (on_diagonal ? i + 1 : grid); j++) {
            const double y[2] = { 2 * PI * (i + 0.5) / grid, 2 * PI * (j + 0.5) / grid };
            const double at_y = f(v, y, g, h);
            if (at_y < least) {
                least = at_y;
                best[0] = y[0];
                best[1] = y[1];
            }
        }
    if (!(value <= least)) {
        x[0] = best[0];
        x[1] = best[1];
        if (!(newton(f, v, x) <= least)) {          /* it is not isolated */
            x[0] = best[0];
            x[1] = best[1];
            descend(depth_of, &(valley){ f, v }, x, least, PI / grid, on_diagonal);
        }
    }
    if (on_diagonal)
        x[1] = x[0];
}

void loewner_lowest(const waves *v, double x[2])
{
    find_least(least_eigenvalue, v, 0, x);
}

/* ---- what nine points of an orbit leave */

/* Orbits through x*: their x[1] and x[-1] lie at middle + and - offset. */
typedef struct {
    const waves *v;
    double scale, l, xstar[2], middle[2], beta[3];
    double guess[2];                    /* of the offset that leaves most */
} pencil;

/* What the waves, so much weaker, make of a point. */
static void look(const pencil *o, const double x[2], double force[2], double beta[3])
{
    const waves *const v = o->v;


    force[0] = force[1] = beta[1] = 0.0;
    beta[0] = beta[2] = 2.0;
    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], y = k0 * x[0] + k1 * x[1] + v->phase[j];
        const double s = o->scale * v->p[j] * sin(y), c = o->scale * v->p[j] * cos(y);
        force[0] += c * k0;
        force[1] += c * k1;
        beta[0] -= s * k0 * k0;
        beta[1] -= s * k0 * k1;
        beta[2] -= s * k1 * k1;
    }
}

/* form -= 1/d */
static void take(double form[3], const double d[3])
{
    const double det = d[0] * d[2] - d[1] * d[1];

    form[0] -= d[2] / det;
    form[1] += d[1] / det;
    form[2] -= d[0] / det;
}

static double least_of(const double d[3])
{
    return 0.5 * (d[0] + d[2]) - hypot(0.5 * (d[0] - d[2]), d[1]);
}

/* Less the eigenvalue that the orbit with this offset leaves; HUGE_VAL if it is contradicted before. */
static double less_left(void *context, const double offset[2], double enough)
{
    const pencil *const o = context;
    double form[3] = { o->beta[0], o->beta[1], o->beta[2] };

    (void)enough;
    for (int side = -1; side <= 1; side += 2) {
        double x[2], before[2], force[2], d[REACH + 1][3] = { { 0.0 } };
        for (int i = 0; i < 2; i++) {
            before[i] = o->xstar[i];
            x[i] = o->middle[i] + side * offset[i];
        }
        for (int j = 0; j < REACH; j++) {
            look(o, x, force, d[j]);
            for (int i = 0; i < 2; i++) {
                const double next = 2.0 * x[i] - before[i] + force[i];
                before[i] = x[i];
                x[i] = next;
            }
        }
        d[REACH][0] = d[REACH][2] = 1.0 / o->l;
        for (int j = REACH - 1; j >= 0; j--) {
            take(d[j], d[j + 1]);
            if (least_of(d[j]) < o->l)
                return HUGE_VAL;
        }
        take(form, d[0]);
    }
    return -least_of(form);
}

/* The largest eigenvalue that orbits through x leave.  (Time may run either way, so that half of the
   offsets will do.) */
static double score(void *context, const double x[2], double enough)
{
    pencil *const o = context;
    const double step = 2.0 * PI / OFFSETS;
    double force[2], top[2] = { o->guess[0], o->guess[1] }, least;

    look(o, x, force, o->beta);
    for (int i = 0; i < 2; i++) {
        o->xstar[i] = x[i];
        o->middle[i] = x[i] + 0.5 * force[i];
    }
    least = less_left(o, top, 0.0);
    for (int i = 0; i < OFFSETS / 2 && -least < enough; i++)
        for (int j = 0; j < OFFSETS; j++) {
            const double offset[2] = { step * i, step * j }, value = less_left(o, offset, 0.0);
            if (value < least) {
                least = value;
                top[0] = offset[0];
                top[1] = offset[1];
            }
        }
    if (-least < enough)
        least = descend(less_left, o, top, least, 0.5 * step, 0);
    o->guess[0] = top[0];
    o->guess[1] = top[1];
    return -least;
}

/* For the tails: l + 1/l = B, the largest eigenvalue of beta, on a grid. */
static double rate(const pencil *o)
{
    double B = 2.0, force[2], beta[3];

    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            const double x[2] = { 2 * PI * (i + 0.5) / GRID, 2 * PI * (j + 0.5) / GRID };
            look(o, x, force, beta);
            B = fmax(B, beta[0] + beta[2] - least_of(beta));
        }
    return 2.0 / (B + sqrt((B - 2.0) * (B + 2.0)));
}

/* x = a place of the least score, which it returns: the best place of a grid or x, and from there. */
static double find_best(pencil *o, int on_diagonal, double x[2])
{
    const double step = 2.0 * PI / PLACES;
    double least = score(o, x, HUGE_VAL);

    for (int i = 0; i < PLACES; i++)
        for (int j = on_diagonal ? i : 0; j < (on_diagonal ? i + 1 : PLACES); j++) {
            const double y[2] = { step * i, step * j }, value = score(o, y, least - NOTHING);
            if (value < least - NOTHING) {
                least = value;
                x[0] = y[0];
                x[1] = y[1];
            }
        }
    return descend(score, o, x, least, 0.5 * step, on_diagonal);
}

void loewner_start(const waves *v, int on_diagonal, double x[2])
{
    pencil o = { .v = v, .scale = 1.0 };
    double least[2], value;

    find_least(least_eigenvalue, v, on_diagonal, x);
    find_least(potential, v, on_diagonal, least);
    for (int i = 0; i < 2; i++)
        x[i] += BETWEEN * (least[i] - x[i]);
    for (;;) {
        o.l = rate(&o);
        value = score(&o, x, HUGE_VAL);
        if (value >= ENOUGH)
            break;
        o.scale *= WEAKER;
    }
    for (int diagonal = on_diagonal; diagonal >= 0; diagonal--) {
        double y[2] = { x[0], x[1] };
        const double at_y = find_best(&o, diagonal, y);
        if (at_y < value - (on_diagonal ? PLAINLY : NOTHING)) {
            value = at_y;
            x[0] = y[0];
            x[1] = y[1];
        }
    }
}
