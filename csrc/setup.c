/* setup.c - a search is made: the problem is read, and what every step needs is set up. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "loewner/start.h"
#include "numbers/guard.h"
#include "numbers/machine.h"
#include "numbers/special.h"
#include "search.h"
#include "torus.h"

enum { MAX_DP = 100000, MAX_DEPTH = 100000 };
enum { MOST = 300 };                    /* no number of a problem is beyond 10^MOST */
enum { PI_SHORT = 5 };                  /* see region.c */

static const int THESIS_WAVES[3][2] = { { 1, 0 }, { 0, 1 }, { 1, 1 } };

static void box_init(box *b)
{
    for (int j = 0; j < 5; j++) {
        apm_init(b->centre[j]);
        apm_init(b->half[j]);
    }
    apm_init(b->xstar[0]);
    apm_init(b->xstar[1]);
    b->n_cuts = 0;
}

static void box_clear(box *b)
{
    for (int j = 0; j < 5; j++) {
        apm_clear(b->centre[j]);
        apm_clear(b->half[j]);
    }
    apm_clear(b->xstar[0]);
    apm_clear(b->xstar[1]);
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
        box_clear(&s->root);
        box_clear(&s->prism);
        for (int j = 0; j < N_CONSTANTS; j++)
            apm_clear(s->constants[j]);
        apm_clear(s->t[0]);
        apm_clear(s->t[1]);
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

/* The problem as it is given, and the starting point. */
static int read_problem(cv_search *s, const char *const region[5], const char *const half[5],
                        const char *const xstar[2])
{
    double abc[3], start[2];
    const double phase[3] = { 0.0, 0.0, 0.0 };
    const waves v = { 3, THESIS_WAVES, phase, abc };
    char text[40];
    apm_t most;
    int status = CV_OK;

    apm_init(most);
    apm_set_si(most, 1, MOST);
    for (int j = 0; j < 5 && status == CV_OK; j++) {
        if (apm_set_str(s->root.centre[j], region[j]) != APM_OK ||
            apm_set_str(s->root.half[j], half[j]) != APM_OK)
            status = CV_ENUMBER;
        apm_abs(s->t[0], s->root.centre[j]);
        if (apm_cmp(s->t[0], most) > 0 || apm_cmp(s->root.half[j], most) > 0)
            status = CV_ENUMBER;
        if (apm_sgn(s->root.half[j]) < 0)
            status = CV_EARGUMENT;
    }
    apm_clear(most);
    if (status != CV_OK)
        return status;
    s->symmetric = apm_cmp(s->root.centre[0], s->root.centre[1]) == 0 &&
                   apm_cmp(s->root.half[0], s->root.half[1]) == 0 &&
                   apm_cmp(s->root.centre[3], s->root.centre[4]) == 0 &&
                   apm_cmp(s->root.half[3], s->root.half[4]) == 0;
    for (int j = 0; j < 3; j++)
        abc[j] = apm_get_d(s->root.centre[j]);
    if (s->method == CV_LOEWNER)
        loewner_start(&v, s->symmetric, start);
    else
        set_LL_start(start, abc, s->symmetric);
    for (int j = 0; j < 2; j++) {
        if (xstar == NULL) {
            snprintf(text, sizeof text, s->method == CV_LOEWNER ? "%.6f" : "%.17g", start[j]);
            with_a_point(text);
        }
        if (apm_set_str(s->root.xstar[j], xstar == NULL ? text : xstar[j]) != APM_OK)
            return CV_ENUMBER;
    }
    if (apm_cmp(s->root.xstar[0], s->root.xstar[1]) != 0)
        s->symmetric = 0;
    return CV_OK;
}

static int prepare_loewner(cv_search *s)
{
    double abc[3], start[2];
    const double phase[3] = { 0.0, 0.0, 0.0 };
    const waves v = { 3, THESIS_WAVES, phase, abc };

    s->sharp = loewner_new(&s->root, s->together, 1);
    if (s->sharp == NULL)
        return CV_ENOMEM;
    if (apm_set_d(s->t[0], loewner_largest(s->sharp)) != APM_OK)
        return CV_EARITHMETIC;
    apm_round(s->constants[C_B], s->t[0], TORUS_PLACES, APM_UP);
    for (int j = 0; j < 3; j++)
        abc[j] = apm_get_d(s->root.centre[j]) + (s->together ? apm_get_d(s->root.half[j]) : 0.0);
    loewner_lowest(&v, start);
    s->at_once = loewner_at_once(s->sharp, start);
    return CV_OK;
}

static int prepare_thesis(cv_search *s)
{
    double abc[3], herman_start[2];
    int status;

    s->exact = Runit_new(s->dp, s->as_printed);
    s->quick = unit_new(s->dp, s->as_printed);
    if (s->exact == NULL || s->quick == NULL)
        return CV_ENOMEM;
    for (int j = 0; j < 3; j++)
        abc[j] = apm_get_d(s->root.centre[j]);
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

static int prepare(cv_search *s)
{
    const long pi_dp = s->as_printed ? s->dp : s->dp > PI_SHORT ? s->dp - PI_SHORT : 1;

    apm_pi(s->t[0], pi_dp);
    for (int j = 3; j < 5; j++)
        to_radians(s->root.centre[j], s->root.half[j], s->t[0], pi_dp);
    return s->method == CV_LOEWNER ? prepare_loewner(s) : prepare_thesis(s);
}

int cv_prepare(cv_search *s, const volatile int *stop)
{
    guard g = { .stop = stop }, *before;

    if (s->prepared || s->spoilt || s->status != CV_RUNNING)
        return s->prepared ? CV_OK : s->status < CV_OK ? s->status : CV_EARGUMENT;
    if (!machine_is_sound())
        return CV_EMACHINE;
    s->spoilt = 1;                      /* until it is done */
    before = guard_arm(&g);
    switch (setjmp(g.here)) {
    case 0:
        s->status = prepare(s);
        break;
    case GUARD_STOP:
        s->status = CV_EARGUMENT;       /* half prepared, it is good for nothing */
        guard_arm(before);
        return CV_RUNNING;
    default:
        s->status = CV_ENOMEM;
    }
    guard_arm(before);
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

int cv_search_new(cv_search **result, const char *const region[5], const char *const half[5],
                  const char *const xstar[2], int method, int together, int dp, int depth,
                  int stubborn, int as_printed)
{
    cv_search *s;
    guard g = { .stop = NULL }, *before;
    int status;

    *result = NULL;
    if (dp < 1 || dp > MAX_DP || depth < 0 || depth > MAX_DEPTH ||
        (method != CV_THESIS && method != CV_LOEWNER) ||
        (method == CV_THESIS ? together : as_printed))
        return CV_EARGUMENT;
    s = calloc(1, sizeof *s);
    if (s == NULL)
        return CV_ENOMEM;
    box_init(&s->root);
    box_init(&s->prism);
    for (int j = 0; j < N_CONSTANTS; j++)
        apm_init(s->constants[j]);
    apm_init(s->t[0]);
    apm_init(s->t[1]);
    s->method = method;
    s->dp = dp;
    s->depth = depth;
    s->stubborn = stubborn;
    s->as_printed = as_printed;
    s->together = together;

    before = guard_arm(&g);
    status = setjmp(g.here) != 0 ? CV_ENOMEM : read_problem(s, region, half, xstar);
    guard_arm(before);
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
