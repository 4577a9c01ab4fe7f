/* relax.c - minimizes the action of a periodic orbit: damped Newton, and a way off saddles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "converse.h"
#include "orbits.h"

/* Does Python want an end?  Python defines this function, which looks for signals.  Every loop that
   may last calls it now and then, but not so often that the calls take time. */
int cv_python_interrupts(void);

/* The period is 1, and the eigenvalues of the Hessian are of about 1. */
static const double MAX_STEP = 0.1;     /* No coordinate moves further in one step. */
static const double NULL_EIGENVALUE = 1e-11;    /* Rounding decides the sign of smaller ones. */
static const double MAX_DAMPING = 1e9; /* With a larger mu a step is below 1e-9 of the gradient. */
static const double MIN_DAMPING = 1e-15; /* Of eigenvalues of about 1 it is the rounding. */
static const double ROUNDING = 1e-15; /* The rounding of a sum, as a part of the sum of sizes. */
static const double MIN_ESCAPE = 1e-7; /* Shorter steps off a saddle change the action by less
                                          than its rounding. */
static const double HELD_ENTRY = 1e100; /* A held coordinate has this diagonal entry. */
enum { MAX_ESCAPES = 50 }; /* The most saddles that one search leaves. */
enum { WALKING_STEPS = 1000 }; /* Later steps have to lower the action or the gradient. */
enum { POINTS_PER_POLL = 1 << 18 }; /* The points between two questions to Python about Ctrl-C. */

typedef double point[2];
typedef double block[3];

typedef struct {
    const cv_potential *v;
    long q;
    double eps;
    const point *base;
    int held; /* see cv_relax */
    point *x; /* base + u, scratch */
    double *value; /* scratch */
    double *work; /* of cv_solve */
    long points; /* dealt with since Ctrl-C was looked for */
} action_of;

typedef struct {
    point *u, *gradient;
    block *beta;
    double action, largest, mean_square;
    double noise; /* About the rounding of the action's sum. */
    double doubt; /* About its rounding where values of V cancel, but not their slopes. */
} place;

/* Is the calculation to end?  Asked after each round through all points. */
static int stopped(action_of *of)
{
    of->points += of->q;
    if (of->points < POINTS_PER_POLL)
        return 0;
    of->points = 0;
    return cv_python_interrupts();
}

/* cv_solve; CV_ESTOPPED, if the search is to end. */
static long solve(action_of *of, const block *beta, double mu, const point *b, point *u)
{
    return stopped(of) ? CV_ESTOPPED
                       : cv_solve(of->v->n, of->q, beta, mu, b, u, b ? of->work : NULL);
}

/* Evaluates action, gradient and the Hessian's blocks at at->u. */
static void evaluate(const action_of *of, place *at)
{
    const long q = of->q;
    double sum = 0.0, lost = 0.0, size = 0.0, slopes = 0.0, squares = 0.0, largest = 0.0;

    for (long j = 0; j < q; j++)
        for (int i = 0; i < 2; i++)
            of->x[j][i] = of->base[j][i] + at->u[j][i];
    cv_evaluate(of->v, q, (const point *)of->x, of->value, at->gradient, at->beta);
    for (long j = 0; j < q; j++) {
        const double *const before = at->u[j > 0 ? j - 1 : q - 1], *const here = at->u[j],
                            *const after = at->u[j < q - 1 ? j + 1 : 0];
        double term = -of->eps * of->value[j], total;
        for (int i = 0; i < 2; i++) {
            const double step = after[i] - here[i];
            double g = (here[i] - before[i]) - step - of->eps * at->gradient[j][i];
            if (j == 0 && i == of->held)
                g = 0.0;
            term += 0.5 * step * step;
            size += step * step;
            squares += g * g;
            largest = fmax(largest, fabs(g));
            slopes += fabs(of->eps * at->gradient[j][i]);
            at->gradient[j][i] = g;
        }
        total = sum + term; /* Its rounding is kept: it adds up over long orbits. */
        lost += (sum - (total - (total - sum))) + (term - (total - sum));
        sum = total;
        size += fabs(of->eps * of->value[j]);
        for (int i = 0; i < 3; i++)
            at->beta[j][i] = (i == 1 ? 0.0 : 2.0) - of->eps * at->beta[j][i];
    }
    if (of->held >= 0) {
        at->beta[0][2 * of->held] = HELD_ENTRY;
        at->beta[0][1] = 0.0;
    }
    at->action = sum + lost;
    at->noise = ROUNDING * size;
    at->doubt = at->noise + ROUNDING * slopes;
    at->largest = squares < HUGE_VAL ? largest : HUGE_VAL; /* infinite if NaN */
    at->mean_square = squares / (double)q;
}

/* to = from + t along. */
static void move(long q, place *to, const place *from, double t, const point *along)
{
    for (long j = 0; j < q; j++)
        for (int i = 0; i < 2; i++)
            to->u[j][i] = from->u[j][i] + t * along[j][i];
}

static double widest(long q, const point *v)
{
    double most = 0.0;
    for (long j = 0; j < q; j++)
        for (int i = 0; i < 2; i++)
            most = fmax(most, fabs(v[j][i]));
    return most;
}

/* Finds the eigenvector of the least eigenvalue, which is below -NULL_EIGENVALUE, by inverse
   iteration.  Counts of negative eigenvalues bring the shift within a twentieth of it. */
static long downhill(action_of *of, const block *beta, point *v)
{
    const long q = of->q;
    double low = NULL_EIGENVALUE, high = 1.0, most;
    unsigned long long random = 88172645463325252ULL;
    long negative;

    while ((negative = solve(of, beta, high, NULL, NULL)) > 0)
        high *= 2.0;
    while (negative >= 0 && high > 1.05 * low) {
        const double middle = low > 0.01 * high ? 0.5 * (low + high) : sqrt(low * high);
        negative = solve(of, beta, middle, NULL, NULL);
        if (negative > 0)
            low = middle;
        else
            high = middle;
    }
    for (long j = 0; j < q; j++)
        for (int i = 0; i < 2; i++) {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            v[j][i] = i < of->v->n ? (double)(random >> 11) * 0x1p-53 - 0.5 : 0.0;
        }
    for (int k = 0; k < 12 && negative >= 0; k++) {
        negative = solve(of, beta, high, (const point *)v, v);
        most = widest(q, (const point *)v);
        for (long j = 0; j < q; j++)
            for (int i = 0; i < 2; i++)
                v[j][i] /= most;
    }
    return negative < 0 ? negative : 0;
}

static void swap(place *a, place *b)
{
    const place c = *a;
    *a = *b;
    *b = c;
}

/* Does b lie lower than a?  Along soft directions the action changes by less than rounding.  Then b
   is accepted if its gradient is smaller.  While the state may walk, b is also accepted if the mean
   of both gradients points from a to b and the gradient of b is not much larger. */
static int lower(long q, const place *b, const place *a, int may_walk)
{
    const double difference = b->action - a->action;
    double along = 0.0;

    if (difference < -a->noise || !(difference <= a->doubt))
        return difference < 0.0;
    if (b->mean_square < a->mean_square)
        return 1;
    for (long j = 0; j < q; j++)
        for (int i = 0; i < 2; i++)
            along += (a->gradient[j][i] + b->gradient[j][i]) * (b->u[j][i] - a->u[j][i]);
    return may_walk && along < 0.0 && b->largest < 2.0 * a->largest;
}

/* Steps off a saddle, to the lower one of both sides, by the longest of some steps that lowers the
   action.  Returns 1, 0 if none of them does, or an error. */
static long escape(action_of *of, place *at, place *other, point *along)
{
    long status = downhill(of, (const block *)at->beta, along);
    double best = at->action - at->noise, chosen = 0.0;

    for (double t = 0.5 * MAX_STEP; t > MIN_ESCAPE && chosen == 0.0 && status == CV_OK; t *= 0.25)
        for (int sign = -1; sign <= 1; sign += 2) {
            move(of->q, other, at, sign * t, (const point *)along);
            evaluate(of, other);
            if (other->action < best) {
                best = other->action;
                chosen = sign * t;
            }
        }
    if (status != CV_OK || chosen == 0.0)
        return status;
    move(of->q, other, at, chosen, (const point *)along);
    evaluate(of, other);
    swap(at, other);
    return 1;
}

static int descend(action_of *of, place *at, place *other, point *along, double tol, long max_steps,
                   cv_relaxed *how)
{
    const long q = of->q;
    double mu = 0.0;

    for (evaluate(of, at);;) {
        const double slope = sqrt(at->mean_square);
        long negative;
        how->largest = at->largest;
        how->action = at->action;
        /* Before break-up a gradient along directions that cost nothing may be all that rounding
           leaves, and no step lowers what it hides. */
        if (at->largest <= tol || (mu > MAX_DAMPING && at->largest <= 100.0 * tol)) {
            negative = solve(of, (const block *)at->beta, NULL_EIGENVALUE, NULL, NULL);
            if (negative > 0 && how->escapes < MAX_ESCAPES) {
                how->escapes++;
                negative = escape(of, at, other, along);
                mu = 0.0;
                if (negative > 0)
                    continue;
            }
            return negative < 0 ? (int)negative : CV_OK;
        }
        if (how->steps >= max_steps || !(at->largest < HUGE_VAL) || mu > MAX_DAMPING)
            return CV_RUNNING;
        how->steps++;
        while ((negative = solve(of, (const block *)at->beta, mu, (const point *)at->gradient,
                                 along)) > 0 &&
               mu < MAX_DAMPING)
            mu = fmax(4.0 * mu, fmax(0.01 * slope, MIN_DAMPING));
        if (negative < 0)
            return (int)negative;
        move(q, other, at, -fmin(1.0, MAX_STEP / widest(q, (const point *)along)),
             (const point *)along);
        evaluate(of, other);
        if (lower(q, other, at, how->steps < WALKING_STEPS)) {
            swap(at, other);
            mu = mu > 10.0 * MIN_DAMPING ? 0.1 * mu : 0.0;
        } else {
            mu = fmax(4.0 * mu, fmax(0.1 * slope, MIN_DAMPING));
        }
    }
}

int cv_relax(const cv_potential *v, long q, double eps, const double (*base)[2], double (*u)[2],
             int held, double tol, long max_steps, cv_relaxed *how)
{
    const size_t size = (size_t)q;
    point *const points = malloc(6 * size * sizeof *points);
    block *const blocks = malloc(2 * size * sizeof *blocks);
    double *const work = malloc((1 + CV_WORK) * size * sizeof *work);
    action_of of = { .v = v, .q = q, .eps = eps, .base = base, .held = held };
    int status = CV_ENOMEM;

    if (points && blocks && work) {
        place at = { .u = points, .gradient = points + size, .beta = blocks };
        place other = { .u = points + 2 * size,
                        .gradient = points + 3 * size,
                        .beta = blocks + size };
        of.x = points + 4 * size;
        of.value = work + CV_WORK * size;
        of.work = work;
        memcpy(at.u, u, size * sizeof *u);
        status = descend(&of, &at, &other, points + 5 * size, tol, max_steps, how);
        memcpy(u, at.u, size * sizeof *u);
    }
    free(points);
    free(blocks);
    free(work);
    return status;
}
