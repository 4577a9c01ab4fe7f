/* start.c - where orbits are to start, so that the proof is short: plain double precision.

   A proof succeeds when no minimizing orbit leads through x*, so x* should lie in the middle of the
   gap that minimizing orbits leave.  Two answers are compared.  The first lies between the place
   where beta is least, where a single point contradicts minimality soonest, and the minimum of the
   potential, which minimizing orbits shun most.  The second asks nine points of each orbit through
   x*: when all others are eliminated they leave a quadratic form at x*, and its least eigenvalue,
   for the orbit where that is largest, is to be as small as can be.  (If nothing is left, a weaker
   potential is asked: the place hardly depends on its size.)  Where waves are all parallel it is a
   question of one angle, and asked more finely.  Where V is symmetric about the diagonal the best
   of it and the best elsewhere are judged by thirteen points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define LANES 2                         /* past and future, side by side */
#endif
#include "loewner.h"
#include "arith/sine.h"
#include "arith/sym2.h"
#include "start.h"

enum { COARSEST_GRID = 24, FINEST_GRID = 240 };
enum { NEAR = 4, REACH = 6 };           /* points on either side of x*; to judge by, at last */
enum { PLACES = 16, OFFSETS = 24, HALVINGS = 6 };
enum { FINER = 4 };                     /* so many times, where waves feel but one angle */
enum { ANGLES = FINER * OFFSETS, SIDES = 2 / LANES, GUESSES = 8 };
static const double PI = 3.14159265358979323846;
static const double BETWEEN = 0.28; /* of the way from the least beta to the least potential */
static const double NOTHING = 1e-6;     /* no better than that: it may be rounding */
static const double PLAINLY = 0.001;    /* better: enough to leave where symmetry is */
static const double ENOUGH = 0.06, WEAKER = 0.97;   /* so much must be left, or V is weakened */
static const double STRONG = 1.5, WEAK = 0.5;   /* B - 2: there is no torus; nothing to prove */

/* ---- descents without derivatives */

/* The value at x if it is less than `enough`; otherwise any number that is not less. */
typedef double function(void *context, const double x[2], double enough);

/* Where x may go: along the diagonal, along its first angle, anywhere. */
typedef enum { DIAGONAL, FIRST_ANGLE, ANYWHERE } ways;

/* From x, where f has this value, in ever smaller steps to smaller ones, which it returns. */
static double descend(function *f, void *context, double x[2], double value, double step,
                      ways where)
{
    static const int way[8][2] = { { 1, 1 }, { -1, -1 }, { 1, 0 },  { -1, 0 },
                                   { 0, 1 }, { 0, -1 },  { 1, -1 }, { -1, 1 } };
    const int begin = where == FIRST_ANGLE ? 2 : 0, end = where == ANYWHERE ? 8 : begin + 2;

    for (int halving = 0; halving < HALVINGS; step *= 0.5, halving++)
        for (int j = begin; j < end; j++) {
            const double y[2] = { x[0] + step * way[j][0], x[1] + step * way[j][1] };
            const double at_y = f(context, y, value - NOTHING);
            if (at_y < value - NOTHING) {
                value = at_y;
                x[0] = y[0];
                x[1] = y[1];
                j = begin - 1;
            }
        }
    return value;
}

/* ---- between the least beta and the least potential */

typedef struct {
    objective *f;
    const waves *v;
} valley;

static double depth_of(void *context, const double x[2], double enough)
{
    const valley *const o = context;
    double g[2], h[3];

    (void)enough;
    return o->f(o->v, x, g, h);
}

/* What is least, or largest, on a grid. */
typedef struct {
    int grid;
    double least[2], potential[2];      /* the places of the least eigenvalue of beta, of V */
    double largest;                     /* eigenvalue of beta */
} survey;

/* The places are on the diagonal if they shall be.  All sines are those of parts of a turn. */
static survey survey_of(const waves *v, int on_diagonal)
{
    double sine[2 * FINEST_GRID], least = HUGE_VAL, lowest = HUGE_VAL;
    survey s = { COARSEST_GRID, { PI / 2, PI / 2 }, { PI / 2, PI / 2 }, 2.0 };
    double sin_phase[MOST_WAVES], cos_phase[MOST_WAVES];

    for (int j = 0; j < v->n; j++) {
        const int size = abs(v->k[j][0]) + abs(v->k[j][1]);
        while (s.grid < FINEST_GRID && s.grid < COARSEST_GRID * size / 2)
            s.grid += COARSEST_GRID;
        sin_phase[j] = v->p[j] * sin(v->phase[j]);
        cos_phase[j] = v->p[j] * cos(v->phase[j]);
    }
    const int turn = 2 * s.grid;
    for (int m = 0; m < turn; m++)
        sine[m] = sin(PI * m / s.grid);
    for (int i = 0; i < s.grid; i++)
        for (int j = 0; j < s.grid; j++) {
            const double y[2] = { 2 * PI * (i + 0.5) / s.grid, 2 * PI * (j + 0.5) / s.grid };
            vec beta[3] = { every(2.0), every(0.0), every(2.0) }, least_beta;
            double value = 0.0, low;
            for (int w = 0; w < v->n; w++) {
                const int k0 = v->k[w][0], k1 = v->k[w][1];
                const int m = (k0 * (2 * i + 1) + k1 * (2 * j + 1)) % turn;
                const int at_sine = m < 0 ? m + turn : m, at_cosine = (at_sine + turn / 4) % turn;
                const double part = cos_phase[w] * sine[at_sine] + sin_phase[w] * sine[at_cosine];
                value -= part;
                beta[0] -= part * k0 * k0;
                beta[1] -= part * k0 * k1;
                beta[2] -= part * k1 * k1;
            }
            least_beta = sym2_least_eigenvalue(beta);
            low = at(&least_beta, 0);
            s.largest = fmax(s.largest, at(&beta[0], 0) + at(&beta[2], 0) - low);
            if (on_diagonal && i != j)
                continue;
            if (low < least) {
                least = low;
                memcpy(s.least, y, sizeof y);
            }
            if (value < lowest) {
                lowest = value;
                memcpy(s.potential, y, sizeof y);
            }
        }
    return s;
}

/* x = a place where f is least: where Newton's method leads from (pi/2, pi/2), as in 1989, or
   from the best point of so fine a grid if that is better, or downhill from there. */
static void find_least(objective *f, const waves *v, const double best[2], int grid,
                       int on_diagonal, double x[2])
{
    double g[2], h[3];
    const double least = f(v, best, g, h);

    x[0] = x[1] = PI / 2;
    if (!(newton(f, v, x) <= least)) {
        x[0] = best[0];
        x[1] = best[1];
        if (!(newton(f, v, x) <= least)) {          /* it is not isolated */
            x[0] = best[0];
            x[1] = best[1];
            descend(depth_of, &(valley){ f, v }, x, least, PI / grid,
                    on_diagonal ? DIAGONAL : ANYWHERE);
        }
    }
    if (on_diagonal)
        x[1] = x[0];
}

void loewner_lowest(const waves *v, double x[2])
{
    const survey s = survey_of(v, 0);

    find_least(least_eigenvalue_of_beta, v, s.least, s.grid, 0, x);
}

/* ---- what nine points of an orbit leave */

/* Orbits through x*: their x[1] and x[-1] lie at middle + and - offset. */
typedef struct {
    const waves *v;
    int flat;                           /* no wave feels the second angle */
    int reach, step;                    /* points on either side; from one offset to the next */
    double above;                       /* the largest eigenvalue of V as it is, less 2 */
    double scale, l, xstar[2], middle[2], beta[3];
    double sine[ANGLES];                /* of the parts of a turn */
    double guess[GUESSES][2];           /* offsets that left most, the latest first */
} orbits;

/* What the waves, so much weaker, make of a point on either side. */
INLINE void look(const orbits *o, const vec x[2], vec force[2], vec beta[3])
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

/* The eigenvalue that so many points on either side leave, given their beta; -HUGE_VAL if they
   contradict before.  More points leave less. */
INLINE double left_by(const orbits *o, int points, vec beta[SIDES][REACH][3])
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

/* 1 on one side, -1 on the other. */
INLINE vec sign_of(int side)
{
    vec sign = every(side ? -1.0 : 1.0);

    if (LANES == 2)
        put_at(&sign, LANES - 1, -1.0);
    return sign;
}

/* The eigenvalue that the orbit with this offset leaves, -HUGE_VAL if it is contradicted before; if
   it does not exceed floor, any number that does not. */
static double left_over(const orbits *o, const double offset[2], double floor)
{
    vec x[SIDES][2], before[SIDES][2], force[2], beta[SIDES][REACH][3];
    double left = 0.0;

    for (int side = 0; side < SIDES; side++)
        for (int i = 0; i < 2; i++) {
            before[side][i] = every(o->xstar[i]);
            x[side][i] = o->middle[i] + sign_of(side) * offset[i];
        }
    for (int points = 0; points < o->reach; points++) {
        for (int side = 0; side < SIDES; side++) {
            look(o, x[side], force, beta[side][points]);
            for (int i = 0; i < 2; i++) {
                const vec next = 2.0 * x[side][i] - before[side][i] + force[i];
                before[side][i] = x[side][i];
                x[side][i] = next;
            }
        }
        left = left_by(o, points + 1, beta);
        if (left <= floor)
            break;
    }
    return left;
}

static double less_left(void *context, const double offset[2], double enough)
{
    return -left_over(context, offset, -enough);
}

/* The waves at the middle: p sin and p cos. */
typedef struct { double sine[MOST_WAVES], cosine[MOST_WAVES]; } waves_at;

/* The orbit whose offset is i, j parts of a turn leaves no more than this: what its points next to
   x* leave. */
static double left_next(const orbits *o, const waves_at *middle, int i, int j)
{
    const waves *const v = o->v;
    vec beta[SIDES][REACH][3];

    for (int side = 0; side < SIDES; side++) {
        beta[side][0][0] = beta[side][0][2] = every(2.0);
        beta[side][0][1] = every(0.0);
    }
    for (int w = 0; w < v->n; w++) {
        const int k0 = v->k[w][0], k1 = v->k[w][1], m = (k0 * i + k1 * j) % ANGLES;
        const int at_sine = m < 0 ? m + ANGLES : m, at_cosine = (at_sine + ANGLES / 4) % ANGLES;
        for (int side = 0; side < SIDES; side++) {
            const vec s = middle->sine[w] * o->sine[at_cosine] +
                          sign_of(side) * (middle->cosine[w] * o->sine[at_sine]);
            beta[side][0][0] -= s * (double)(k0 * k0);
            beta[side][0][1] -= s * (double)(k0 * k1);
            beta[side][0][2] -= s * (double)(k1 * k1);
        }
    }
    return left_by(o, 1, beta);
}

/* The most that orbits with offsets on the grid leave, and top = the offset, if it is more than
   floor; or floor.  Of what is `enough` the first found will do.  (Time may run either way, so half
   of the offsets are all.) */
static double scan(const orbits *o, double top[2], double floor, double enough)
{
    const int end = o->flat ? 1 : ANGLES;
    waves_at middle;

    for (int w = 0; w < o->v->n; w++) {
        const double p = o->scale * o->v->p[w], k0 = o->v->k[w][0], k1 = o->v->k[w][1];
        const double y = k0 * o->middle[0] + k1 * o->middle[1] + o->v->phase[w];
        middle.sine[w] = p * sin(y);
        middle.cosine[w] = p * cos(y);
    }
    for (int i = 0; i <= ANGLES / 2; i += o->step)
        for (int j = 0; j < end; j += o->step) {
            const double offset[2] = { 2.0 * PI * i / ANGLES, 2.0 * PI * j / ANGLES };
            double left;
            if (left_next(o, &middle, i, j) <= floor)
                continue;
            left = left_over(o, offset, floor);
            if (left > floor) {
                floor = left;
                memcpy(top, offset, sizeof offset);
                if (left >= enough)
                    return left;
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

/* The largest eigenvalue that orbits through x leave. */
static double score(void *context, const double x[2], double enough)
{
    orbits *const o = context;
    const vec here[2] = { every(x[0]), every(x[1]) };
    vec force[2], beta[3];
    double top[2], left;

    look(o, here, force, beta);
    for (int i = 0; i < 3; i++)
        o->beta[i] = at(&beta[i], 0);
    for (int i = 0; i < 2; i++) {
        o->xstar[i] = x[i];
        o->middle[i] = x[i] + 0.5 * at(&force[i], 0);
    }
    for (int n = 0; n < GUESSES; n++) {
        left = left_over(o, o->guess[n], enough);
        if (left >= enough) {
            remember(o, n, o->guess[n]);
            return left;
        }
    }
    left = scan(o, top, enough, enough);
    if (!(left > enough)) {             /* it counts */
        memcpy(top, o->guess[0], sizeof top);
        left = scan(o, top, left_over(o, top, -HUGE_VAL), HUGE_VAL);
        left = -descend(less_left, o, top, -left, PI * o->step / ANGLES,
                        o->flat ? FIRST_ANGLE : ANYWHERE);
    }
    remember(o, GUESSES - 1, top);
    return left;
}

/* ---- the place where nine points leave least */

/* x = a place of the least score: the best place of a grid, or x if it is less than `least` nowhere
   there, and from there. */
static double find_best(orbits *o, ways where, double least, double x[2])
{
    const int places = where == FIRST_ANGLE ? FINER * PLACES : PLACES;
    const double step = 2.0 * PI / places;

    for (int i = 0; i < places; i++)
        for (int j = 0; j < (where == ANYWHERE ? places : 1); j++) {
            const double y[2] = { step * i, step * (where == DIAGONAL ? i : j) };
            const double value = score(o, y, least - NOTHING);
            if (value < least - NOTHING) {
                least = value;
                x[0] = y[0];
                x[1] = y[1];
            }
        }
    return descend(score, o, x, least, 0.5 * step, where);
}

/* So many times. */
static void weaken(orbits *o, int times)
{
    const double strength = fmin(o->above, STRONG) * pow(WEAKER, times), B = 2.0 + strength;

    o->scale = o->above > 0.0 ? strength / o->above : 1.0;
    o->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0)));
}

/* From x to where the score is least, for waves so weak that enough is left at x, unless there is
   nothing to prove of them.  What lies off the diagonal is judged by longer orbits. */
static void improve(orbits *o, int on_diagonal, double x[2])
{
    double value, y[2] = { x[0], x[1] }, off[2] = { x[0], x[1] };
    int low = 0, high = 0;

    while (fmin(o->above, STRONG) * pow(WEAKER, high) >= WEAK)
        high++;
    for (int times = 0; low < high; times = (low + high) / 2) {
        weaken(o, times);
        if (score(o, x, ENOUGH) >= ENOUGH)
            high = times;
        else
            low = times + 1;
    }
    weaken(o, high);
    value = score(o, x, HUGE_VAL);
    if (!on_diagonal) {
        find_best(o, o->flat ? FIRST_ANGLE : ANYWHERE, value, x);
        return;
    }
    if (find_best(o, DIAGONAL, value, y) < value - PLAINLY)
        memcpy(x, y, sizeof y);
    find_best(o, ANYWHERE, HUGE_VAL, off);
    if (fmax(fabs(off[0] - x[0]), fabs(off[1] - x[1])) < 2.0 * PI / PLACES)
        return;                         /* it is the same gap */
    o->reach = REACH;
    o->step = FINER / 2;
    value = score(o, x, HUGE_VAL) - PLAINLY;
    if (score(o, off, value) < value)
        memcpy(x, off, sizeof off);
}

/* ---- waves that are all parallel */

/* Room for waves. */
typedef struct {
    int k[MOST_WAVES][2];
    double phase[MOST_WAVES], p[MOST_WAVES];
} room;

/* Those that there are, in room. */
static waves present(const waves *v, room *r)
{
    waves some = { 0, (const int (*)[2])r->k, r->phase, r->p };

    for (int j = 0; j < v->n; j++)
        if (v->p[j] != 0.0) {
            memcpy(r->k[some.n], v->k[j], sizeof v->k[j]);
            r->phase[some.n] = v->phase[j];
            r->p[some.n++] = v->p[j];
        }
    return some;
}

static int common_divisor(int a, int b) { return b == 0 ? abs(a) : common_divisor(b, a % b); }

/* If k = m q for all waves, q primitive, they become waves (m, 0) of |q|^2 the amplitude, which is
   what second variations of x along q see of them; the first angle is q.x then. */
static int flatten(room *r, int n, int q[2])
{
    const int common = n > 0 ? common_divisor(r->k[0][0], r->k[0][1]) : 0;

    for (int i = 0; i < 2 && common > 0; i++)
        q[i] = r->k[0][i] / common;
    for (int j = 0; j < n; j++)
        if (r->k[j][0] * q[1] != r->k[j][1] * q[0])
            return 0;
    for (int j = 0; j < n; j++) {
        const int size = q[0] * q[0] + q[1] * q[1];
        r->k[j][0] = (r->k[j][0] * q[0] + r->k[j][1] * q[1]) / size;
        r->k[j][1] = 0;
        r->p[j] *= size;
    }
    return n > 0;
}

/* ---- the answer */

void loewner_start(const waves *given, int on_diagonal, double x[2])
{
    room r;
    const waves v = present(given, &r);
    const survey s = survey_of(&v, on_diagonal);
    orbits o = { .v = &v, .reach = NEAR, .step = FINER, .above = s.largest - 2.0 };
    int q[2] = { 1, 0 };
    double least[2];

    find_least(least_eigenvalue_of_beta, &v, s.least, s.grid, on_diagonal, x);
    find_least(value_of_potential, &v, s.potential, s.grid, on_diagonal, least);
    for (int i = 0; i < 2; i++)
        x[i] += BETWEEN * (least[i] - x[i]);
    for (int m = 0; m < ANGLES; m++)
        o.sine[m] = sin(2.0 * PI * m / ANGLES);
    o.flat = flatten(&r, v.n, q);
    if (o.flat) {
        const double along = q[0] * x[0] + q[1] * x[1], size = q[0] * q[0] + q[1] * q[1];
        double y[2] = { along, 0.0 };
        o.step = 1;
        improve(&o, 0, y);
        for (int i = 0; i < 2; i++)
            x[i] += (y[0] - along) * q[i] / size;
    } else {
        improve(&o, on_diagonal, x);
    }
}
