/* setup.c - a search is made: the problem is read, and what every step needs is set up. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "loewner/start.h"
#include "arith/guard.h"
#include "arith/machine.h"
#include "arith/special.h"
#include "search/search.h"
#include "model/torus.h"

enum { MAX_DP = 100000, MAX_DEPTH = 100000 };
enum { MOST = 300 };                    /* no number of a problem is beyond 10^MOST */
enum { MOST_K = 100 };                  /* of a wave, and of the frame */
enum { PHASE_PLACES = 50 };             /* of pi, for phases */
enum { PI_SHORT = 5 };                  /* see region.c */

static void for_box(box *b, void (*what)(apm_t))
{
    for (int j = 0; j < 5; j++) {
        what(b->centre[j]);
        what(b->half[j]);
    }
    what(b->xstar[0]);
    what(b->xstar[1]);
}

static void for_patch(patch *p, void (*what)(apm_t))
{
    for (int i = 0; i < MOST_WAVES; i++) {
        what(p->phase[i]);
        what(p->amplitude[i]);
        for (int m = 0; m < PARAMETERS; m++)
            what(p->part[i][m]);
    }
    for (int j = 0; j < 2; j++) {
        what(p->angle[j]);
        what(p->half[j]);
        what(p->xstar[j]);
    }
}

static void for_search(cv_search *s, void (*what)(apm_t))
{
    for_patch(&s->problem, what);
    for_box(&s->root, what);
    for_box(&s->prism, what);
    for (int j = 0; j < N_CONSTANTS; j++)
        what(s->constants[j]);
    what(s->t[0]);
    what(s->t[1]);
}

/* After CV_ENOMEM the numbers are abandoned, not freed: see guard.c. */
void cv_search_free(cv_search *s)
{
    if (s == NULL)
        return;
    if (s->status != CV_ENOMEM) {
        Runit_free(s->exact);
        unit_free(s->quick);
        loewner_free(s->sharp);
        for_search(s, apm_clear);
    }
    free(s->stack);
    free(s->noted);
    free(s->notes);
    free(s->tree);
    free(s->steps);
    free(s);
}

/* Whatever the locale writes between whole numbers and decimals, a point replaces it. */
static void with_a_point(char *text)
{
    char *end = text;

    for (const char *c = text; *c != '\0'; c++)
        if (strchr("0123456789+-e", *c) != NULL)
            *end++ = *c;
        else if (end == text || end[-1] != '.')
            *end++ = '.';
    *end = '\0';
}

/* A number of the problem. */
static int read_number(apm_t x, const char *text)
{
    apm_t size, most;
    int status = CV_OK;

    apm_init(size);
    apm_init(most);
    apm_set_si(most, 1, MOST);
    if (apm_set_str(x, text) != APM_OK)
        status = CV_ENUMBER;
    apm_abs(size, x);
    if (apm_cmp(size, most) > 0)
        status = CV_ENUMBER;
    apm_clear(size);
    apm_clear(most);
    return status;
}

/* A phase in units of pi becomes one in radians, without whole turns. */
static void reduce(apm_t phase)
{
    apm_t t;

    apm_init(t);
    apm_mul_si(t, phase, 5);
    apm_scale(t, t, -1);
    apm_floor(t, t);
    apm_mul_si(t, t, -2);
    apm_add(phase, phase, t);
    apm_pi(t, PHASE_PLACES);
    apm_mul(phase, phase, t);
    apm_clear(t);
}

static int read_wave(patch *p, int i, const cv_wave *wave)
{
    int status = read_number(p->phase[i], wave->phase);

    for (int j = 0; j < 2; j++)
        p->k[i][j] = wave->k[j];
    if (abs(wave->k[0]) > MOST_K || abs(wave->k[1]) > MOST_K || (!wave->k[0] && !wave->k[1]))
        status = CV_EARGUMENT;
    if (status == CV_OK)
        status = read_number(p->amplitude[i], wave->amplitude);
    for (int m = 0; m < p->n_parameters && status == CV_OK; m++)
        status = read_number(p->part[i][m], wave->part[m]);
    if (status == CV_OK)
        reduce(p->phase[i]);
    return status;
}

static int read_problem(patch *p, const cv_problem *given)
{
    const int *const f = given->frame;
    int status = CV_OK;

    if (given->n_waves < 1 || given->n_waves > MOST_WAVES || given->n_parameters < 0 ||
        given->n_parameters > PARAMETERS)
        return CV_EARGUMENT;
    for (int j = 0; j < 4; j++) {
        if (f[j] < -MOST_K || f[j] > MOST_K)
            return CV_EARGUMENT;
        p->frame[j] = f[j];
    }
    if (abs(f[0] * f[3] - f[1] * f[2]) != 1)
        return CV_EARGUMENT;
    p->n_waves = given->n_waves;
    p->n_parameters = given->n_parameters;
    p->odd = given->odd;
    for (int i = 0; i < p->n_waves && status == CV_OK; i++)
        status = read_wave(p, i, &given->waves[i]);
    for (int j = 0; j < 2 && status == CV_OK; j++) {
        status = read_number(p->angle[j], given->angle[j]);
        if (status == CV_OK)
            status = read_number(p->half[j], given->half[j]);
        if (status == CV_OK && apm_sgn(p->half[j]) < 0)
            status = CV_EARGUMENT;
    }
    return status;
}

/* Has each of the thesis's waves a parameter of its own? */
static int independent(const patch *p)
{
    int good = thesis_waves(p) && p->n_parameters == 3;

    for (int i = 0; i < 3 && good; i++)
        for (int m = 0; m < 3; m++)
            good = good && (m == i ? apm_sgn(p->part[i][m]) >= 0 : apm_sgn(p->part[i][m]) == 0);
    return good;
}

/* Does the exchange of the coordinates leave these amplitudes, one of each wave, alone?  All that
   waves of one kind add up to is what counts. */
static int exchangeable(const patch *p, const apm_struct *const amplitude[MOST_WAVES])
{
    int good = 1;
    apm_t sum;

    apm_init(sum);
    for (int i = 0; i < p->n_waves; i++) {
        apm_set_si(sum, 0, 0);
        for (int j = 0; j < p->n_waves; j++) {
            if (apm_cmp(p->phase[i], p->phase[j]) != 0)
                continue;
            if (p->k[i][0] == p->k[j][0] && p->k[i][1] == p->k[j][1])
                apm_add(sum, sum, amplitude[j]);
            if (p->k[i][0] == p->k[j][1] && p->k[i][1] == p->k[j][0])
                apm_sub(sum, sum, amplitude[j]);
        }
        good = good && apm_sgn(sum) == 0;
    }
    apm_clear(sum);
    return good;
}

/* Does it map the patch and the region of x_1 to themselves?  Where the parameters are those of the
   waves the first two change places; else none does. */
static int is_symmetric(const patch *p)
{
    const apm_struct *vector[MOST_WAVES];
    int good = is_identity(p->frame) && apm_cmp(p->angle[0], p->angle[1]) == 0 &&
               apm_cmp(p->half[0], p->half[1]) == 0;

    for (int i = 0; i < p->n_waves; i++)
        vector[i] = p->amplitude[i];
    good = good && exchangeable(p, vector);
    if (good && independent(p))
        return apm_cmp(p->part[0][0], p->part[1][1]) == 0;
    for (int m = 0; m < p->n_parameters && good; m++) {
        for (int i = 0; i < p->n_waves; i++)
            vector[i] = p->part[i][m];
        good = exchangeable(p, vector);
    }
    return good;
}

/* The amplitudes in the middle, or at_end where the parameters are 1. */
static void amplitudes(const patch *p, int at_end, double to[MOST_WAVES])
{
    for (int i = 0; i < p->n_waves; i++) {
        to[i] = apm_get_d(p->amplitude[i]);
        for (int m = 0; m < p->n_parameters && at_end; m++)
            to[i] += apm_get_d(p->part[i][m]);
    }
}

/* Room for the potential in doubles. */
typedef struct { double phase[MOST_WAVES], p[MOST_WAVES]; } potential_room;

/* The potential in the middle, or at_end where the parameters are 1. */
static waves potential(const patch *problem, int at_end, potential_room *room)
{
    for (int i = 0; i < problem->n_waves; i++)
        room->phase[i] = apm_get_d(problem->phase[i]);
    amplitudes(problem, at_end, room->p);
    return (waves){ problem->n_waves, problem->k, room->phase, room->p };
}

/* The starting point of the program's choice. */
static int choose_start(const cv_search *s, apm_t xstar[2])
{
    const int sharp = s->method == CV_LOEWNER;
    potential_room room;
    const waves v = potential(&s->problem, 0, &room);
    double start[2];
    char text[40];

    if (sharp)
        loewner_start(&v, s->symmetric, start);
    else
        set_LL_start(start, room.p, s->symmetric);
    for (int j = 0; j < 2; j++) {
        snprintf(text, sizeof text, sharp ? "%.6f" : "%.17g", start[j]);
        with_a_point(text);
        if (apm_set_str(xstar[j], text) != APM_OK)
            return CV_ENUMBER;
    }
    return CV_OK;
}

static int set_start(cv_search *s, const char *const xstar[2])
{
    int status = CV_OK;

    s->symmetric = is_symmetric(&s->problem);
    if (xstar == NULL)
        status = choose_start(s, s->problem.xstar);
    for (int j = 0; j < 2 && xstar != NULL; j++)
        if (apm_set_str(s->problem.xstar[j], xstar[j]) != APM_OK)
            status = CV_ENUMBER;
    if (status == CV_OK && apm_cmp(s->problem.xstar[0], s->problem.xstar[1]) != 0)
        s->symmetric = 0;
    return status;
}

/* What cv_search_new was given. */
typedef struct {
    cv_search *s;
    const cv_problem *problem;
    const char *const *xstar;
    int status;
} given;

static void set_up(void *data)
{
    given *const g = data;
    cv_search *const s = g->s;

    g->status = read_problem(&s->problem, g->problem);
    if (g->status == CV_OK && s->method == CV_THESIS &&
        !(independent(&s->problem) && is_identity(g->problem->frame)))
        g->status = CV_EARGUMENT;
    if (g->status == CV_OK)
        g->status = set_start(s, g->xstar);
}

/* Does the theorem hold at once, and for which parameters?  See converse.h. */
static int find_at_once(const cv_search *s)
{
    const int one = s->problem.n_parameters == 1;
    potential_room room;
    const waves v = potential(&s->problem, one, &room);
    double x[2];

    if (!s->problem.odd)
        return 0;
    loewner_lowest(&v, x);
    return loewner_at_once(s->sharp, x, 0) ? 1 : one && loewner_at_once(s->sharp, x, 1) ? 2 : 0;
}

static int prepare_loewner(cv_search *s)
{
    s->sharp = loewner_new(&s->problem, 1);
    if (s->sharp == NULL)
        return CV_ENOMEM;
    if (apm_set_d(s->t[0], loewner_largest(s->sharp)) != APM_OK)
        return CV_EARITHMETIC;
    apm_round(s->constants[C_B], s->t[0], TORUS_PLACES, APM_UP);
    s->at_once = find_at_once(s);
    return CV_OK;
}

/* All of the problem as a prism: its parameters are those of the waves. */
static void set_root(cv_search *s)
{
    for (int j = 0; j < 3; j++) {
        apm_set(s->root.centre[j], s->problem.amplitude[j]);
        apm_set(s->root.half[j], s->problem.part[j][j]);
    }
    for (int j = 0; j < 2; j++) {
        apm_set(s->root.centre[3 + j], s->problem.angle[j]);
        apm_set(s->root.half[3 + j], s->problem.half[j]);
        apm_set(s->root.xstar[j], s->problem.xstar[j]);
    }
}

static int prepare_thesis(cv_search *s)
{
    double abc[MOST_WAVES], herman_start[2];
    int status;

    s->exact = Runit_new(s->dp, s->as_printed);
    s->quick = unit_new(s->dp, s->as_printed);
    if (s->exact == NULL || s->quick == NULL)
        return CV_ENOMEM;
    set_root(s);
    amplitudes(&s->problem, 0, abc);
    set_Herm_start(herman_start, abc, 1);
    for (int j = 0; j < 5; j++) {
        apm_set(s->prism.centre[j], s->root.centre[j]);
        apm_set(s->prism.half[j], s->root.half[j]);
    }
    apm_set(s->prism.xstar[0], s->root.xstar[0]);
    apm_set(s->prism.xstar[1], s->root.xstar[1]);
    status = Rprepare_trial(s->exact, &s->root, herman_start, NULL);
    if (status != CV_OK)
        return status;
    status = Runit_constants(s->exact, s->constants);
    if (status != CV_OK)
        return status;
    return prepare_trial(s->quick, &s->root, herman_start, s->constants);
}

static void prepare(void *data)
{
    cv_search *const s = data;
    const long pi_dp = s->as_printed ? s->dp : s->dp > PI_SHORT ? s->dp - PI_SHORT : 1;

    apm_pi(s->t[0], pi_dp);
    for (int j = 0; j < 2; j++)
        to_radians(s->problem.angle[j], s->problem.half[j], s->t[0], pi_dp);
    s->status = s->method == CV_LOEWNER ? prepare_loewner(s) : prepare_thesis(s);
}

int cv_prepare(cv_search *s, const cv_stop *stop)
{
    if (s->prepared || s->spoilt || s->status != CV_RUNNING)
        return s->prepared ? CV_OK : s->status < CV_OK ? s->status : CV_EARGUMENT;
    if (!machine_is_sound())
        return CV_EMACHINE;
    s->spoilt = 1;                      /* until it is done */
    switch (guard_run(prepare, s, stop)) {
    case GUARD_STOP:
        s->status = CV_EARGUMENT;       /* half prepared, it is good for nothing */
        return CV_RUNNING;
    case GUARD_MEMORY:
        s->status = CV_ENOMEM;
    }
    if (s->status == CV_OK && !machine_is_sound())
        s->status = CV_EMACHINE;
    if (s->status == CV_OK) {
        s->prepared = 1;
        s->spoilt = 0;
        s->status = CV_RUNNING;
        return CV_OK;
    }
    return s->status;
}

int cv_search_new(cv_search **result, const cv_problem *problem, const char *const xstar[2],
                  int method, int dp, int depth, int stubborn, int as_printed)
{
    cv_search *s;
    given g = { NULL, problem, xstar, CV_OK };
    int status;

    *result = NULL;
    if (dp < 1 || dp > MAX_DP || depth < 0 || depth > MAX_DEPTH ||
        (method != CV_THESIS && method != CV_LOEWNER) || (method == CV_LOEWNER && as_printed))
        return CV_EARGUMENT;
    s = calloc(1, sizeof *s);
    if (s == NULL)
        return CV_ENOMEM;
    for_search(s, apm_init);
    s->method = method;
    s->dp = dp;
    s->depth = depth;
    s->stubborn = stubborn;
    s->as_printed = as_printed;

    g.s = s;
    status = guard_run(set_up, &g, NULL) == GUARD_MEMORY ? CV_ENOMEM : g.status;
    if (status == CV_OK)
        status = cv_resume(s, "", 0);   /* the whole root is to be tried */
    if (status == CV_OK) {
        *result = s;
    } else {
        s->status = status;
        cv_search_free(s);
    }
    return status;
}
