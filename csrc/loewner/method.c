/* method.c - the sharper method as a search sees it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/torus.h"
#include "problem.h"
#include "start.h"

/* The potential in doubles. */
typedef struct {
    int k[MOST_WAVES][ANGLES];
    double phase[MOST_WAVES], p[MOST_WAVES];
} numbers;

/* Where each parameter is t, without the waves that are zero there. */
static waves potential_of(const patch *p, double t, numbers *room)
{
    waves v = { p->n_angles, 0, (const int (*)[ANGLES])room->k, room->phase, room->p };
    double amplitude[MOST_WAVES];

    patch_amplitudes(p, t, amplitude);
    for (int i = 0; i < p->n_waves; i++)
        if (amplitude[i] != 0.0) {
            memcpy(room->k[v.n], p->k[i], sizeof p->k[i]);
            room->phase[v.n] = apm_get_d(p->phase[i]);
            room->p[v.n++] = amplitude[i];
        }
    return v;
}

static int loewner_accepts(const patch *p, const precision *how)
{
    (void)p;
    return how->as_printed || how->longest < -MAX_POINTS || how->longest > MAX_POINTS ? CV_EARGUMENT
                                                                                      : CV_OK;
}

/* How much the waves bend at most, if all k have the same direction. */
static double bend_of(const waves *v)
{
    double sum = 0.0;

    for (int i = 0; i < v->n; i++)
        sum += fabs(v->p[i]) * (double)(v->k[i][0] * v->k[i][0] + v->k[i][1] * v->k[i][1] +
                                        v->k[i][2] * v->k[i][2]);
    return sum;
}

static void loewner_choose_start(const patch *p, int symmetric, double x[ANGLES])
{
    numbers numbers_of[3];
    const waves middle = potential_of(p, 0.0, &numbers_of[0]);
    const waves low = potential_of(p, -1.0, &numbers_of[1]);
    const waves high = potential_of(p, 1.0, &numbers_of[2]);

    loewner_start(&middle, bend_of(&low) <= bend_of(&high) ? &low : &high, symmetric, x);
}

/* cv_at_once of converse.h. */
static int find_at_once(const loewner *w, const patch *p)
{
    const int one = p->n_parameters == 1;
    numbers room;
    const waves v = potential_of(p, one ? 1.0 : 0.0, &room);
    double x[ANGLES] = { 0.0 };

    if (!p->odd)
        return 0;
    loewner_lowest(&v, x);
    return loewner_at_once(w, x, 0) ? 1 : one && loewner_at_once(w, x, 1) ? 2 : 0;
}

static int loewner_prepare(void **work, const patch *p, const precision *how,
                           apm_t constants[CV_N_CONSTANTS], int *at_once)
{
    loewner *const w = *work = loewner_new(p, how->longest ? abs(how->longest) : MAX_POINTS);

    if (w == NULL)
        return CV_ENOMEM;
    loewner_bound_torus(w);
    if (apm_set_d(constants[CV_B], loewner_largest(w)) != APM_OK)
        return CV_EARITHMETIC;
    apm_round(constants[CV_B], constants[CV_B], TORUS_PLACES, APM_UP);
    *at_once = find_at_once(w, p);
    return CV_OK;
}

static int loewner_copied(void **copy, const void *work, const patch *p, const precision *how)
{
    (void)p;
    (void)how;
    *copy = loewner_copy(work);
    return *copy == NULL ? CV_ENOMEM : CV_OK;
}

/* The work holds doubles and no number of GMP's. */
static void free_loewner(void *work, int numbers_lost)
{
    (void)numbers_lost;
    loewner_free(work);
}

static int loewner_has_axis(const patch *p, int axis)
{
    return axis < T1 ? axis < p->n_angles
                     : axis < T1 + p->n_parameters || (axis == V2 && p->n_angles > 2);
}

static int loewner_lanes(const void *work) { return ((const loewner *)work)->engine->lanes; }

static int loewner_try(void *work, int n, const cv_cell *const cells[], outcome *const out[])
{
    const loewner *const w = work;

    return w->engine->try(w->work, w, n, cells, out);
}

const method method_loewner = {
    .accepts = loewner_accepts,
    .choose_start = loewner_choose_start,
    .start_places = 6,
    .quarter_places = 20,
    .least_digits = 35,
    .prepare = loewner_prepare,
    .copy = loewner_copied,
    .free = free_loewner,
    .has_axis = loewner_has_axis,
    .lanes = loewner_lanes,
    .try = loewner_try,
};
