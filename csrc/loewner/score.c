/* score.c - see score.h. */
#include <math.h>
#include <string.h>

#if defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define LANES 2                         /* past and future, side by side */
#endif
#include "arith/sine.h"
#include "arith/sym2.h"
#include "score.h"

enum { SIDES = 2 / LANES, HALVINGS = 6 };
static const double PI = 3.14159265358979323846;

double descend(function *f, void *context, double x[2], double value, double step, ways where)
{
    static const int way[8][2] = { { 1, 1 }, { -1, -1 }, { 1, 0 },  { -1, 0 },
                                   { 0, 1 }, { 0, -1 },  { 1, -1 }, { -1, 1 } };
    const int begin = where == FIRST_ANGLE ? 2 : 0, end = where == ANYWHERE ? 8 : begin + 2;

    for (int halving = 0; halving < HALVINGS; step *= 0.5, halving++)
        for (int j = begin; j < end; j++) {
            const double y[2] = { x[0] + step * way[j][0], x[1] + step * way[j][1] };
            const double at_y = f(context, y, value - GAIN_MIN);
            if (at_y < value - GAIN_MIN) {
                value = at_y;
                memcpy(x, y, sizeof y);
                j = begin - 1;
            }
        }
    return value;
}

/* The force and beta at a point on either side. */
INLINE void evaluate(const orbits *o, const vec x[2], vec force[2], vec beta[3])
{
    const waves *const v = o->v;

    force[0] = force[1] = beta[1] = every(0.0);
    beta[0] = beta[2] = every(2.0);
    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], p = o->scale * v->p[j];
        vec s, c;
        double_sincos(&s, &c, k0 * x[0] + k1 * x[1] + v->phase[j]);
        s *= p;
        c *= p;
        force[0] += c * k0;
        force[1] += c * k1;
        beta[0] -= s * k0 * k0;
        beta[1] -= s * k0 * k1;
        beta[2] -= s * k1 * k1;
    }
}

/* The score for `points` points on either side, given their beta.  More points lower it. */
INLINE double score_of(const orbits *o, int points, vec beta[SIDES][FAR_REACH][3])
{
    vec form[3] = { every(o->beta[0]), every(o->beta[1]), every(o->beta[2]) }, least;

    for (int side = 0; side < SIDES; side++) {
        vec d[3] = { every(1.0 / o->l), every(0.0), every(1.0 / o->l) };
        vec taken[3] = { every(0.0), every(0.0), every(0.0) };
        for (int j = points - 1; j >= 0; j--) {
            vec next[3];
            sym2_subtract_inverse(next, beta[side][j], d);
            if (any(~sym2_is_above(next, every(o->l))))
                return -HUGE_VAL;
            memcpy(d, next, sizeof d);
        }
        sym2_subtract_inverse(taken, taken, d);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < LANES; k++)
                form[i] += at(&taken[i], k);
    }
    least = sym2_least_eigenvalue(form);
    return at(&least, 0);
}

/* The score of the orbit with this offset; if it does not exceed floor, any number that does
   not. */
static double score_at(const orbits *o, const double offset[2], double floor)
{
    vec x[SIDES][2], before[SIDES][2], force[2], beta[SIDES][FAR_REACH][3];
    double found = 0.0;

    for (int side = 0; side < SIDES; side++)
        for (int i = 0; i < 2; i++) {
            before[side][i] = every(o->xstar[i]);
            for (int k = 0; k < LANES; k++)
                put_at(&x[side][i], k, o->middle[i] + (side + k ? -offset[i] : offset[i]));
        }
    for (int points = 0; points < o->reach; points++) {
        for (int side = 0; side < SIDES; side++) {
            evaluate(o, x[side], force, beta[side][points]);
            for (int i = 0; i < 2; i++) {
                const vec next = 2.0 * x[side][i] - before[side][i] + force[i];
                before[side][i] = x[side][i];
                x[side][i] = next;
            }
        }
        found = score_of(o, points + 1, beta);
        if (found <= floor)
            break;
    }
    return found;
}

static double less_score(void *context, const double offset[2], double enough)
{
    return -score_at(context, offset, -enough);
}

/* The largest score of the offsets, and top = its offset, if it exceeds floor; or floor.  The first
   score that is `enough` will do. */
static double scan(const orbits *o, double top[2], double floor, double enough)
{
    const int end = o->flat ? 1 : OFFSETS;

    for (int i = 0; i <= OFFSETS / 2; i += o->step)
        for (int j = 0; j < end; j += o->step) {
            const double offset[2] = { 2.0 * PI * i / OFFSETS, 2.0 * PI * j / OFFSETS };
            const double found = score_at(o, offset, floor);
            if (found > floor) {
                floor = found;
                memcpy(top, offset, sizeof offset);
                if (found >= enough)
                    return found;
            }
        }
    return floor;
}

/* The guess with this number, or top, becomes the first. */
static void remember(orbits *o, int old, const double top[2])
{
    const double guess[2] = { top[0], top[1] };

    memmove(o->guess + 1, o->guess, (size_t)old * sizeof *o->guess);
    memcpy(o->guess, guess, sizeof guess);
}

/* o becomes the orbits through x. */
static void move_to(orbits *o, const double x[2])
{
    const vec here[2] = { every(x[0]), every(x[1]) };
    vec force[2], beta[3];

    evaluate(o, here, force, beta);
    for (int i = 0; i < 3; i++)
        o->beta[i] = at(&beta[i], 0);
    for (int i = 0; i < 2; i++) {
        o->xstar[i] = x[i];
        o->middle[i] = x[i] + 0.5 * at(&force[i], 0);
    }
}

double score(void *context, const double x[2], double enough)
{
    orbits *const o = context;
    double top[2], found;

    move_to(o, x);
    for (int n = 0; n < GUESSES; n++) {
        found = score_at(o, o->guess[n], enough);
        if (found >= enough) {
            remember(o, n, o->guess[n]);
            return found;
        }
    }
    found = scan(o, top, enough, enough);
    if (!(found > enough)) {            /* its value is asked for */
        memcpy(top, o->guess[0], sizeof top);
        found = scan(o, top, score_at(o, top, -HUGE_VAL), HUGE_VAL);
        found = -descend(less_score, o, top, -found, PI * o->step / OFFSETS,
                         o->flat ? FIRST_ANGLE : ANYWHERE);
    }
    remember(o, GUESSES - 1, top);
    return found;
}
