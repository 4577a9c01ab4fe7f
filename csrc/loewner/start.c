/* start.c - where orbits are to start, so that the proof is short: plain double precision.

   A proof succeeds when no minimizing orbit leads through x*, so x* should lie in the middle of the
   gap that minimizing orbits leave.  The first choice lies between the place where beta is least,
   where a single point contradicts minimality soonest, and the minimum of the potential, which
   minimizing orbits avoid most.  If nine points contradict every orbit through it by a margin, the
   proof is easy, and no other place is looked for.  The second choice is where the score of these
   nine points is least (score.h).  If no orbit is left, weaker waves are asked: the place hardly
   depends on their size.  Where V is symmetric about the diagonal,
   the best place on it and the best place elsewhere are compared by thirteen points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "score.h"
#include "start.h"

enum { COARSEST_GRID = 24, FINEST_GRID = 240 }; /* places per turn, where beta and V are surveyed */
/* Places per turn, where scores are first computed, of one, two and three angles. */
static const int PLACES[ANGLES] = { 64, 16, 8 };
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
static const double EASY_SCORE = -0.1, WEAKENING = 0.97, SCORE_LEFT = 0.06,
                    SCORE_LEFT_OF_ONE = 0.04;
/* B - 2 of the weakened waves is in this range: there is no torus above, nothing to prove below. */
static const double STRONGEST = 1.5, WEAKEST = 0.5;

/* ---- the least eigenvalue of beta, and the least potential */

/* V, and beta, at x. */
static double potential_at(const waves *v, const double x[ANGLES], double beta[MOST_ENTRIES])
{
    double value = 0.0;

    for (int a = 0, ab = 0; a < v->angles; a++)
        for (int b = a; b < v->angles; b++)
            beta[ab++] = a == b ? 2.0 : 0.0;
    for (int j = 0; j < v->n; j++) {
        const int *const k = v->k[j];
        double y = v->phase[j];
        for (int a = 0; a < v->angles; a++)
            y += k[a] * x[a];
        const double s = v->p[j] * sin(y);
        value -= s;
        for (int a = 0, ab = 0; a < v->angles; a++)
            for (int b = a; b < v->angles; b++)
                beta[ab++] -= s * k[a] * k[b];
    }
    return value;
}

static double potential(void *context, const double x[ANGLES], double enough)
{
    double beta[MOST_ENTRIES];

    (void)enough;
    return potential_at(context, x, beta);
}

static double least_of_beta(void *context, const double x[ANGLES], double enough)
{
    const waves *const v = context;
    double beta[MOST_ENTRIES];

    (void)enough;
    potential_at(v, x, beta);
    return sym_least_eigenvalue(v->angles, beta);
}

/* The least value of a function on a grid so far, and its place. */
typedef struct { double value, place[ANGLES]; } least;

static void keep_least(least *l, double value, const double place[ANGLES])
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
    const least none = { HUGE_VAL, { PI / 2, PI / 2, PI / 2 } };
    const int finest = v->angles == 3 ? COARSEST_GRID : FINEST_GRID, entries = MOST_ENTRIES;
    survey s = { COARSEST_GRID, none, none, 2.0 };
    int all = 1;

    for (int j = 0; j < v->n; j++) {
        int size = 0;
        for (int a = 0; a < v->angles; a++)
            size += abs(v->k[j][a]);
        while (s.grid < finest && s.grid < COARSEST_GRID * size / 2)
            s.grid += COARSEST_GRID;
    }
    for (int a = 0; a < v->angles; a++)
        all *= s.grid;
    for (int i = 0; i < all; i++) {
        double y[ANGLES] = { 0.0 }, beta[MOST_ENTRIES] = { 0.0 }, minus[MOST_ENTRIES];
        for (int a = v->angles - 1, rest = i; a >= 0; rest /= s.grid, a--)
            y[a] = 2 * PI * (rest % s.grid + 0.5) / s.grid;
        const double value = potential_at(v, y, beta);
        for (int j = 0; j < entries; j++)
            minus[j] = -beta[j];
        s.largest = fmax(s.largest, -sym_least_eigenvalue(v->angles, minus));
        if (on_diagonal && (y[0] != y[1] || (v->angles == 3 && y[0] != y[2])))
            continue;
        keep_least(&s.beta, sym_least_eigenvalue(v->angles, beta), y);
        keep_least(&s.potential, value, y);
    }
    return s;
}

/* x = a place where f is least: of two angles where Newton's method, with f's derivatives, leads
   from (pi/2, pi/2), as in 1989, or from the best place of a grid if that is better; else, or if it
   is not isolated, downhill from there. */
static void find_least(function *f, objective *derivatives, const waves *v, const least *best,
                       int grid, int on_diagonal, double x[ANGLES])
{
    const int two = v->angles == 2;

    x[0] = x[1] = PI / 2;
    if (two && newton(derivatives, v, x) <= best->value)
        return;
    memcpy(x, best->place, sizeof best->place);
    if (!two || !(newton(derivatives, v, x) <= best->value)) {
        memcpy(x, best->place, sizeof best->place);
        descend(f, (void *)v, v->angles, x, best->value, PI / grid,
                on_diagonal ? DIAGONAL : ANYWHERE);
    }
    if (on_diagonal)
        x[1] = x[2] = x[0];
}

void loewner_lowest(const waves *v, double x[ANGLES])
{
    const survey s = survey_of(v, 0);

    find_least(least_of_beta, least_eigenvalue_of_beta, v, &s.beta, s.grid, 0, x);
}

/* ---- the place of the least score */

/* Moves x, which has this score, to a place of the least score: from the best place of a grid, or
   from x if that is better. */
static double find_best(orbits *o, ways where, double value, double x[ANGLES])
{
    const int angles = o->v->angles, places = PLACES[angles - 1];
    const double step = 2.0 * PI / places;
    int all = places;

    for (int a = 1; a < angles && where == ANYWHERE; a++)
        all *= places;
    for (int i = 0; i < all; i++) {
        double y[ANGLES] = { 0.0 };
        for (int a = angles - 1, rest = i; a >= 0; rest /= where == ANYWHERE ? places : 1, a--)
            y[a] = step * (rest % places);
        const double at_y = score(o, y, value - GAIN_MIN);
        if (at_y < value - GAIN_MIN) {
            value = at_y;
            memcpy(x, y, sizeof y);
        }
    }
    return descend(score, o, angles, x, value, 0.5 * step, where);
}

/* Makes B - 2 of the waves, which is `excess`, as small as `weaker`. */
static void weaken(orbits *o, double excess, double weaker)
{
    const double B = 2.0 + weaker;

    o->scale = excess > 0.0 ? weaker / excess : 1.0;
    o->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0)));
}

/* Weakens the waves as little as leaves a large enough score at x, but not below WEAKEST. */
static void weaken_until_left(orbits *o, double excess, const double x[ANGLES])
{
    const double enough = o->v->angles == 1 ? SCORE_LEFT_OF_ONE : SCORE_LEFT;
    double weaker = fmin(excess, STRONGEST);

    for (weaken(o, excess, weaker); weaker >= WEAKEST && score(o, x, enough) < enough;
         weaken(o, excess, weaker))
        weaker *= WEAKENING;
}

/* Moves x off the diagonal if longer orbits judge another place to be better. */
static void leave_diagonal(orbits *o, double x[ANGLES])
{
    double value, off[ANGLES] = { x[0], x[1] };

    find_best(o, ANYWHERE, HUGE_VAL, off);
    if (fmax(fabs(off[0] - x[0]), fabs(off[1] - x[1])) < 2.0 * PI / PLACES[1])
        return; /* it is the same gap */
    o->reach = FAR_REACH;
    o->step = FINE_STEP;
    value = score(o, x, HUGE_VAL) - GAIN_OFF_DIAGONAL;
    if (score(o, off, value) < value)
        memcpy(x, off, sizeof off);
}

/* Moves x to a better place, if there is one.  excess: B - 2 of the waves. */
static void improve(orbits *o, double excess, int on_diagonal, double x[ANGLES])
{
    const ways where = on_diagonal ? DIAGONAL : ANYWHERE;
    double value, y[ANGLES] = { x[0], x[1], x[2] };

    weaken_until_left(o, excess, x);
    value = score(o, x, HUGE_VAL);
    if (find_best(o, where, value, y) < value - (on_diagonal ? GAIN_OFF_DIAGONAL : 0.0))
        memcpy(x, y, sizeof y);
    if (on_diagonal && o->v->angles == 2)
        leave_diagonal(o, x);
}

/* ---- the answer */

/* Do nine points contradict every orbit through x of the weakest waves by a margin? */
static int is_easy(const waves *weakest, double excess, const double x[ANGLES])
{
    orbits o = { .v = weakest, .reach = NEAR_REACH, .step = COARSE_STEP };

    weaken(&o, excess, fmin(excess, STRONGEST));
    return score(&o, x, EASY_SCORE) < EASY_SCORE;
}

void loewner_start(const waves *middle, const waves *weakest, int on_diagonal, double x[ANGLES])
{
    const survey s = survey_of(middle, on_diagonal);
    const double excess = s.largest - 2.0;
    orbits o = { .v = middle,
                 .reach = NEAR_REACH,
                 .step = middle->angles == 1 ? FINEST_STEP : COARSE_STEP };
    double lowest[ANGLES] = { 0.0 };

    find_least(least_of_beta, least_eigenvalue_of_beta, middle, &s.beta, s.grid, on_diagonal, x);
    find_least(potential, value_of_potential, middle, &s.potential, s.grid, on_diagonal, lowest);
    for (int i = 0; i < middle->angles; i++)
        x[i] += BETWEEN * (lowest[i] - x[i]);
    if (!is_easy(weakest, excess, x))
        improve(&o, excess, on_diagonal, x);
}
