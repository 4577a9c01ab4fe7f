/* method.c - the sharper method as a search sees it. */
#include "model/torus.h"
#include "problem.h"
#include "start.h"

/* The potential in doubles. */
typedef struct { double phase[MOST_WAVES], p[MOST_WAVES]; } numbers;

/* In the middle, or at_end where the parameters are 1. */
static waves potential_of(const patch *p, int at_end, numbers *room)
{
    for (int i = 0; i < p->n_waves; i++)
        room->phase[i] = apm_get_d(p->phase[i]);
    patch_amplitudes(p, at_end, room->p);
    return (waves){ p->n_waves, p->k, room->phase, room->p };
}

static int loewner_accepts(const patch *p, const precision *how)
{
    (void)p;
    return how->as_printed || how->longest > MAX_POINTS ? CV_EARGUMENT : CV_OK;
}

static void loewner_choose_start(const patch *p, int symmetric, double x[2])
{
    numbers room;
    const waves v = potential_of(p, 0, &room);

    loewner_start(&v, symmetric, x);
}

/* Does the theorem hold at once, and for which parameters?  See converse.h. */
static int find_at_once(const loewner *w, const patch *p)
{
    const int one = p->n_parameters == 1;
    numbers room;
    const waves v = potential_of(p, one, &room);
    double x[2];

    if (!p->odd)
        return 0;
    loewner_lowest(&v, x);
    return loewner_at_once(w, x, 0) ? 1 : one && loewner_at_once(w, x, 1) ? 2 : 0;
}

static int loewner_prepare(void **work, const patch *p, const precision *how,
                           apm_t constants[CV_N_CONSTANTS], int *at_once)
{
    loewner *const w = *work = loewner_new(p, how->longest > 0 ? how->longest : MAX_POINTS);

    if (w == NULL)
        return CV_ENOMEM;
    loewner_bound_torus(w);
    if (apm_set_d(constants[CV_B], loewner_largest(w)) != APM_OK)
        return CV_EARITHMETIC;
    apm_round(constants[CV_B], constants[CV_B], TORUS_PLACES, APM_UP);
    *at_once = find_at_once(w, p);
    return CV_OK;
}

/* The work holds doubles and no number of GMP's. */
static void free_loewner(void *work, int numbers_lost)
{
    (void)numbers_lost;
    loewner_free(work);
}

static int loewner_axes(const patch *p) { return 2 + p->n_parameters; }
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
    .least_digits = 35,
    .prepare = loewner_prepare,
    .free = free_loewner,
    .axes = loewner_axes,
    .lanes = loewner_lanes,
    .try = loewner_try,
};
