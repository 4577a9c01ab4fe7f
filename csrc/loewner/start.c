/* start.c - where orbits are to start, so that the proof is short: plain double precision.

   A proof succeeds when no minimizing orbit leads through x*, so x* should lie in the middle of the
   gap that minimizing orbits leave.  The first choice lies between the place where beta is least,
   where a single point contradicts minimality soonest, and the minimum of the potential, which
   minimizing orbits avoid most.  If nine points contradict every orbit through it by a margin, the
   proof is easy, and no other place is looked for.  The second choice is where the score of these
   nine points is least (score.h).  If no orbit is left, weaker waves are asked: the place hardly
   depends on their size.  Where all waves are parallel, one angle is searched, on a finer grid.
   Where V is symmetric about the diagonal, the best place on it and the best place elsewhere are
   compared by thirteen points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arith/sym2.h"
#include "model/patch.h"
#include "score.h"
#include "start.h"

enum { COARSEST_GRID = 24, FINEST_GRID = 240 }; /* places per turn, where beta and V are surveyed */
enum { PLACES = 16, FLAT_PLACES = 64 }; /* per turn, where scores are first computed */
static const double PI = 3.14159265358979323846;
static const double BETWEEN = 0.28; /* of the way from the least beta to the least potential */
static const double ROUNDING = 1e-12; /* Values on the grid that differ by less are equal. */
/* The diagonal is kept unless another place is better by this, as mirror images can be skipped. */
static const double GAIN_OFF_DIAGONAL = 0.001;
/* If the first choice has a score below EASY_SCORE it is taken.  Otherwise waves are weakened by
   the factor WEAKENING until the score there is at least SCORE_LEFT.  The proofs of 80 maps, most
   of them near the least amplitudes that one x* proves, chose these scores (2026-11-25).  An
   EASY_SCORE from -0.2 to -0.03 changed the number of tries by less than 0.1 %.  A SCORE_LEFT of
   0.05 or 0.08 lost one proof more than 0.06 did. */
static const double EASY_SCORE = -0.1, WEAKENING = 0.97, SCORE_LEFT = 0.06, FLAT_SCORE_LEFT = 0.04;
/* B - 2 of the weakened waves is in this range: there is no torus above, nothing to prove below. */
static const double STRONGEST = 1.5, WEAKEST = 0.5;

/* ---- the least eigenvalue of beta, and the least potential */

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

/* The least value of a function on a grid so far, and its place. */
typedef struct { double value, place[2]; } least;

static void keep_least(least *l, double value, const double place[2])
{
    if (value < l->value - ROUNDING) {
        l->value = value;
        memcpy(l->place, place, sizeof l->place);
    }
}

typedef struct {
    int grid; /* places per turn, more for high harmonics */
    least beta, potential; /* beta: its least eigenvalue */
    double largest; /* the largest eigenvalue of beta */
} survey;

/* The least places are on the diagonal if they shall be. */
static survey survey_of(const waves *v, int on_diagonal)
{
    const least none = { HUGE_VAL, { PI / 2, PI / 2 } };
    survey s = { COARSEST_GRID, none, none, 2.0 };
    double g[2], h[3];

    for (int j = 0; j < v->n; j++) {
        const int size = abs(v->k[j][0]) + abs(v->k[j][1]);
        while (s.grid < FINEST_GRID && s.grid < COARSEST_GRID * size / 2)
            s.grid += COARSEST_GRID;
    }
    for (int i = 0; i < s.grid; i++)
        for (int j = 0; j < s.grid; j++) {
            const double y[2] = { 2 * PI * (i + 0.5) / s.grid, 2 * PI * (j + 0.5) / s.grid };
            const double value = value_of_potential(v, y, g, h);
            const double beta[3] = { 2.0 - h[0], -h[1], 2.0 - h[2] };
            const double low = sym2_least_eigenvalue(beta);
            s.largest = fmax(s.largest, beta[0] + beta[2] - low);
            if (on_diagonal && i != j)
                continue;
            keep_least(&s.beta, low, y);
            keep_least(&s.potential, value, y);
        }
    return s;
}

/* x = a place where f is least: where Newton's method leads from (pi/2, pi/2), as in 1989, or from
   the best place of a grid if that is better, or downhill from there if it is not isolated. */
static void find_least(objective *f, const waves *v, const double best[2], int grid,
                       int on_diagonal, double x[2])
{
    double g[2], h[3];
    const double value = f(v, best, g, h);

    x[0] = x[1] = PI / 2;
    if (!(newton(f, v, x) <= value)) {
        memcpy(x, best, 2 * sizeof *x);
        if (!(newton(f, v, x) <= value)) {
            memcpy(x, best, 2 * sizeof *x);
            descend(depth_of, &(valley){ f, v }, x, value, PI / grid,
                    on_diagonal ? DIAGONAL : ANYWHERE);
        }
    }
    if (on_diagonal)
        x[1] = x[0];
}

void loewner_lowest(const waves *v, double x[2])
{
    const survey s = survey_of(v, 0);

    find_least(least_eigenvalue_of_beta, v, s.beta.place, s.grid, 0, x);
}

/* ---- the place of the least score */

/* Moves x, which has this score, to a place of the least score: from the best place of a grid, or
   from x if that is better. */
static double find_best(orbits *o, ways where, double value, double x[2])
{
    const int places = where == FIRST_ANGLE ? FLAT_PLACES : PLACES;
    const double step = 2.0 * PI / places;

    for (int i = 0; i < places; i++)
        for (int j = 0; j < (where == ANYWHERE ? places : 1); j++) {
            const double y[2] = { step * i, step * (where == DIAGONAL ? i : j) };
            const double at_y = score(o, y, value - GAIN_MIN);
            if (at_y < value - GAIN_MIN) {
                value = at_y;
                memcpy(x, y, sizeof y);
            }
        }
    return descend(score, o, x, value, 0.5 * step, where);
}

/* Makes B - 2 of the waves, which is `excess`, as small as `weaker`. */
static void weaken(orbits *o, double excess, double weaker)
{
    const double B = 2.0 + weaker;

    o->scale = excess > 0.0 ? weaker / excess : 1.0;
    o->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0)));
}

/* Weakens the waves as little as leaves a large enough score at x, but not below WEAKEST. */
static void weaken_until_left(orbits *o, double excess, const double x[2])
{
    const double enough = o->flat ? FLAT_SCORE_LEFT : SCORE_LEFT;
    double weaker = fmin(excess, STRONGEST);

    for (weaken(o, excess, weaker); weaker >= WEAKEST && score(o, x, enough) < enough;
         weaken(o, excess, weaker))
        weaker *= WEAKENING;
}

/* Moves x off the diagonal if longer orbits judge another place to be better. */
static void leave_diagonal(orbits *o, double x[2])
{
    double value, off[2] = { x[0], x[1] };

    find_best(o, ANYWHERE, HUGE_VAL, off);
    if (fmax(fabs(off[0] - x[0]), fabs(off[1] - x[1])) < 2.0 * PI / PLACES)
        return; /* it is the same gap */
    o->reach = FAR_REACH;
    o->step = FINE_STEP;
    value = score(o, x, HUGE_VAL) - GAIN_OFF_DIAGONAL;
    if (score(o, off, value) < value)
        memcpy(x, off, sizeof off);
}

/* Moves x to a better place, if there is one.  excess: B - 2 of the waves. */
static void improve(orbits *o, double excess, int on_diagonal, double x[2])
{
    const ways where = o->flat ? FIRST_ANGLE : on_diagonal ? DIAGONAL : ANYWHERE;
    double value, y[2] = { x[0], x[1] };

    weaken_until_left(o, excess, x);
    value = score(o, x, HUGE_VAL);
    if (find_best(o, where, value, y) < value - (on_diagonal ? GAIN_OFF_DIAGONAL : 0.0))
        memcpy(x, y, sizeof y);
    if (on_diagonal)
        leave_diagonal(o, x);
}

/* ---- waves that are all parallel */

static int common_divisor(int a, int b) { return b == 0 ? abs(a) : common_divisor(b, a % b); }

/* Are all k multiples of one primitive q? */
static int are_parallel(const waves *v, int q[2])
{
    const int common = v->n > 0 ? common_divisor(v->k[0][0], v->k[0][1]) : 0;

    for (int i = 0; i < 2 && common > 0; i++)
        q[i] = v->k[0][i] / common;
    for (int j = 0; j < v->n; j++)
        if (v->k[j][0] * q[1] != v->k[j][1] * q[0])
            return 0;
    return common > 0;
}

/* Improves x for waves with k = m q.  The second variation along q of x is that of the angle q.x
   with waves (m, 0) of |q|^2 the amplitude. */
static void improve_along(const orbits *o, double excess, const int q[2], double x[2])
{
    const waves *const v = o->v;
    const int size = q[0] * q[0] + q[1] * q[1];
    const double along = q[0] * x[0] + q[1] * x[1];
    double y[2] = { along, 0.0 }, p[MOST_WAVES];
    int k[MOST_WAVES][3] = { { 0 } };
    const waves of_angle = { v->n, (const int (*)[3])k, v->phase, p };
    orbits of_it = *o;

    for (int j = 0; j < v->n; j++) {
        k[j][0] = (v->k[j][0] * q[0] + v->k[j][1] * q[1]) / size;
        p[j] = v->p[j] * size;
    }
    of_it.v = &of_angle;
    of_it.flat = 1;
    of_it.step = FINEST_STEP;
    improve(&of_it, excess, 0, y);
    for (int i = 0; i < 2; i++)
        x[i] += (y[0] - along) * q[i] / size;
}

/* ---- the answer */

/* Do nine points contradict every orbit through x of the weakest waves by a margin? */
static int is_easy(const waves *weakest, double excess, const double x[2])
{
    orbits o = { .v = weakest, .reach = NEAR_REACH, .step = COARSE_STEP };

    weaken(&o, excess, fmin(excess, STRONGEST));
    return score(&o, x, EASY_SCORE) < EASY_SCORE;
}

void loewner_start(const waves *middle, const waves *weakest, int on_diagonal, double x[2])
{
    const survey s = survey_of(middle, on_diagonal);
    const double excess = s.largest - 2.0;
    orbits o = { .v = middle, .reach = NEAR_REACH, .step = COARSE_STEP };
    int q[2] = { 1, 0 };
    double lowest[2];

    find_least(least_eigenvalue_of_beta, middle, s.beta.place, s.grid, on_diagonal, x);
    find_least(value_of_potential, middle, s.potential.place, s.grid, on_diagonal, lowest);
    for (int i = 0; i < 2; i++)
        x[i] += BETWEEN * (lowest[i] - x[i]);
    if (is_easy(weakest, excess, x))
        return;
    if (are_parallel(middle, q))
        improve_along(&o, excess, q, x);
    else
        improve(&o, excess, on_diagonal, x);
}
