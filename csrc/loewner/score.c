/* score.c - see score.h. */
#include <math.h>
#include <string.h>

#if defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define LANES 2                         /* past and future, side by side */
#endif
#include "arith/sine.h"
#include "score.h"

enum { SIDES = 2 / LANES, HALVINGS = 6 };
static const double PI = 3.14159265358979323846;

double descend(function *f, void *context, int angles, double x[ANGLES], double value, double step,
               ways where)
{
    static const int way[14][ANGLES] = {
        { 1, 1, 1 },  { -1, -1, -1 }, { 1, 0, 0 },  { -1, 0, 0 }, { 0, 1, 0 },
        { 0, -1, 0 }, { 1, -1, 0 },   { -1, 1, 0 }, { 0, 0, 1 },  { 0, 0, -1 },
        { 1, 0, -1 }, { -1, 0, 1 },   { 0, 1, -1 }, { 0, -1, 1 },
    };
    static const int ends[ANGLES] = { 2, 8, 14 };
    const int end = where == DIAGONAL ? 2 : ends[angles - 1];

    for (int halving = 0; halving < HALVINGS; step *= 0.5, halving++)
        for (int j = 0; j < end; j++) {
            double y[ANGLES] = { 0.0 };
            for (int i = 0; i < angles; i++)
                y[i] = x[i] + step * way[j][i];
            const double at_y = f(context, y, value - GAIN_MIN);
            if (at_y < value - GAIN_MIN) {
                value = at_y;
                memcpy(x, y, sizeof y);
                j = -1;
            }
        }
    return value;
}

/* The force and beta at a point on either side. */
INLINE void evaluate(const orbits *o, int n, const vec x[], vec force[], vec beta[])
{
    const waves *const v = o->v;

    for (int a = 0, ab = 0; a < n; a++) {
        force[a] = every(0.0);
        for (int b = a; b < n; b++)
            beta[ab++] = every(a == b ? 2.0 : 0.0);
    }
    for (int j = 0; j < v->n; j++) {
        const int *const k = v->k[j];
        const double p = o->scale * v->p[j];
        vec s, c, y = (double)k[0] * x[0];
        for (int a = 1; a < n; a++)
            y += (double)k[a] * x[a];
        double_sincos(&s, &c, y + v->phase[j]);
        s *= p;
        c *= p;
        for (int a = 0, ab = 0; a < n; a++) {
            force[a] += c * (double)k[a];
            for (int b = a; b < n; b++)
                beta[ab++] -= s * (double)k[a] * (double)k[b];
        }
    }
}

/* The score for `points` points on either side, given their beta.  More points lower it. */
INLINE double score_of(const orbits *o, int n, int points, vec beta[SIDES][FAR_REACH][MOST_ENTRIES])
{
    const int entries = n * (n + 1) / 2;
    vec form[MOST_ENTRIES], least;

    for (int i = 0; i < entries; i++)
        form[i] = every(o->beta[i]);
    for (int side = 0; side < SIDES; side++) {
        vec d[MOST_ENTRIES], taken[MOST_ENTRIES];
        memset(d, 0, sizeof d);
        memset(taken, 0, sizeof taken);
        for (int i = 0; i < n; i++)
            d[sym_at(n, i, i)] = every(1.0 / o->l);
        for (int j = points - 1; j >= 0; j--) {
            sym_subtract_inverse(n, d, beta[side][j], d);
            if (any(~sym_is_above(n, d, every(o->l))))
                return -HUGE_VAL;
        }
        sym_subtract_inverse(n, taken, taken, d);
        for (int i = 0; i < entries; i++)
            for (int k = 0; k < LANES; k++)
                form[i] += at(&taken[i], k);
    }
    least = sym_least_eigenvalue(n, form);
    return at(&least, 0);
}

/* The score of the orbit with this offset; if it does not exceed floor, any number that does
   not. */
static double score_at(const orbits *o, const double offset[ANGLES], double floor)
{
    const int n = o->v->angles;
    vec x[SIDES][ANGLES], before[SIDES][ANGLES], force[ANGLES];
    vec beta[SIDES][FAR_REACH][MOST_ENTRIES];
    double found = 0.0;

    for (int side = 0; side < SIDES; side++)
        for (int i = 0; i < n; i++) {
            before[side][i] = every(o->xstar[i]);
            for (int k = 0; k < LANES; k++)
                put_at(&x[side][i], k, o->middle[i] + (side + k ? -offset[i] : offset[i]));
        }
    for (int points = 0; points < o->reach; points++) {
        for (int side = 0; side < SIDES; side++) {
            evaluate(o, n, x[side], force, beta[side][points]);
            for (int i = 0; i < n; i++) {
                const vec next = 2.0 * x[side][i] - before[side][i] + force[i];
                before[side][i] = x[side][i];
                x[side][i] = next;
            }
        }
        found = score_of(o, n, points + 1, beta);
        if (found <= floor)
            break;
    }
    return found;
}

static double less_score(void *context, const double offset[ANGLES], double enough)
{
    return -score_at(context, offset, -enough);
}

/* The largest score of the offsets, and top = its offset, if it exceeds floor; or floor.  The first
   score that is `enough` will do. */
static double scan(const orbits *o, double top[ANGLES], double floor, double enough)
{
    const int n = o->v->angles, others = n == 1 ? 1 : OFFSETS / o->step;
    const int all = (OFFSETS / 2 / o->step + 1) * others * (n == 3 ? others : 1);

    for (int i = 0; i < all; i++) {
        double offset[ANGLES] = { 0.0 };
        for (int a = n - 1, rest = i; a >= 0; rest /= others, a--)
            offset[a] = 2.0 * PI * (a == 0 ? rest : rest % others) * o->step / OFFSETS;
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
static void remember(orbits *o, int old, const double top[ANGLES])
{
    double guess[ANGLES];

    memcpy(guess, top, sizeof guess);
    memmove(o->guess + 1, o->guess, (size_t)old * sizeof *o->guess);
    memcpy(o->guess, guess, sizeof guess);
}

/* o becomes the orbits through x. */
static void move_to(orbits *o, const double x[ANGLES])
{
    const int n = o->v->angles;
    vec here[ANGLES], force[ANGLES], beta[MOST_ENTRIES];

    memset(beta, 0, sizeof beta);
    for (int i = 0; i < n; i++)
        here[i] = every(x[i]);
    evaluate(o, n, here, force, beta);
    for (int i = 0; i < n * (n + 1) / 2; i++)
        o->beta[i] = at(&beta[i], 0);
    for (int i = 0; i < n; i++) {
        o->xstar[i] = x[i];
        o->middle[i] = x[i] + 0.5 * at(&force[i], 0);
    }
}

double score(void *context, const double x[ANGLES], double enough)
{
    orbits *const o = context;
    double top[ANGLES], found;

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
        found =
            -descend(less_score, o, o->v->angles, top, -found, PI * o->step / OFFSETS, ANYWHERE);
    }
    remember(o, GUESSES - 1, top);
    return found;
}
