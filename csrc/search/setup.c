/* setup.c - a search is made: the problem is read, and what every step needs is set up. */
#include <math.h>
#include <stdlib.h>

#include "arith/guard.h"
#include "arith/machine.h"
#include "arith/special.h"
#include "search/search.h"

enum { MAX_DP = 100000, MAX_DEPTH = 100000 };   /* Larger arguments are refused. */
enum { PI_SHORT = 5 };                  /* Pi has 5 places less than sines: see region.c. */

/* GMP's numbers are abandoned, not freed, if memory ran out inside GMP: see guard.c. */
void cv_search_free(cv_search *s)
{
    if (s == NULL)
        return;
    free_workers(s);
    s->method->free(s->work, s->numbers_lost);
    if (!s->numbers_lost) {
        patch_clear(&s->problem);
        for (int j = 0; j < CV_N_CONSTANTS; j++)
            apm_clear(s->constants[j]);
    }
    pthread_mutex_destroy(&s->lock);
    pthread_cond_destroy(&s->changed);
    free(s->prisms);
    free(s->tree);
    free(s->steps);
    free(s);
}

/* The starting point of the method's choice, rounded to its decimal places; where that is a
   multiple of pi/2, to more of them, as V may be even about it. */
static int choose_xstar(const cv_search *s, apm_t xstar[ANGLES])
{
    const long places = s->method->start_places, fine = s->method->quarter_places;
    int status = CV_OK;
    double start[ANGLES] = { 0.0 };
    apm_t half, pi, near, off;

    s->method->choose_start(&s->problem, s->symmetric, start);
    apm_init(half);
    apm_init(pi);
    apm_init(near);
    apm_init(off);
    apm_set_si(half, 5, -places - 1);
    apm_pi(pi, fine + 2);
    for (int j = 0; j < s->problem.n_angles; j++) {
        if (apm_set_d(xstar[j], start[j]) != APM_OK)
            status = CV_ENUMBER;
        apm_add(xstar[j], xstar[j], half);
        apm_round(xstar[j], xstar[j], places, APM_DOWN);
        apm_mul_si(near, pi, 5 * (long)floor(start[j] / 1.5707963 + 0.5));
        apm_scale(near, near, -1);
        apm_round(near, near, fine, APM_DOWN);
        apm_sub(off, xstar[j], near);
        apm_scale(off, off, places);
        if (fine > 0 && fabs(apm_get_d(off)) < 1.0)
            apm_set(xstar[j], near);
    }
    apm_clear(half);
    apm_clear(pi);
    apm_clear(near);
    apm_clear(off);
    return status;
}

static int set_start(cv_search *s, const char *const xstar[ANGLES])
{
    int status = CV_OK;

    s->symmetric = s->problem.symmetric;
    if (xstar == NULL)
        status = choose_xstar(s, s->problem.xstar);
    for (int j = 0; j < s->problem.n_angles && xstar != NULL; j++)
        if (apm_set_str(s->problem.xstar[j], xstar[j]) != APM_OK)
            status = CV_ENUMBER;
    if (s->problem.n_angles != 2 || apm_cmp(s->problem.xstar[0], s->problem.xstar[1]) != 0)
        s->symmetric = 0;               /* of more angles no mirror image is skipped */
    return status;
}

/* What cv_search_new was given. */
typedef struct {
    cv_search *s;
    const cv_problem *problem;
    const char *const *xstar;
    int status;
} given;

static void set_up_problem(void *data)
{
    given *const g = data;
    cv_search *const s = g->s;

    g->status = patch_read(&s->problem, g->problem);
    if (g->status == CV_OK)
        g->status = s->method->accepts(&s->problem, &s->precision);
    if (g->status == CV_OK)
        g->status = set_start(s, g->xstar);
}

int set_up(cv_search *s)
{
    const long given = s->precision.digits, least = s->method->least_digits;
    const long dp = given < least ? least : given;
    const long pi_dp = s->precision.as_printed ? dp : dp > PI_SHORT ? dp - PI_SHORT : 1;
    apm_t pi;

    apm_init(pi);
    apm_pi(pi, pi_dp);
    region_to_radians(&s->problem, pi, pi_dp);
    apm_clear(pi);
    return s->method->prepare(&s->work, &s->problem, &s->precision, s->constants, &s->at_once);
}

int cv_search_new(cv_search **result, const cv_problem *problem, const char *const xstar[ANGLES],
                  int method, int dp, int depth, int stubborn, int as_printed, int longest)
{
    static const cv_cell root;          /* its fields are 0 */
    cv_search *s;
    given g = { NULL, problem, xstar, CV_OK };
    int status;

    *result = NULL;
    if (dp < 1 || dp > MAX_DP || depth < 0 || depth > MAX_DEPTH ||
        (method != CV_THESIS && method != CV_LOEWNER))
        return CV_EARGUMENT;
    s = calloc(1, sizeof *s);
    if (s == NULL)
        return CV_ENOMEM;
    status = pthread_mutex_init(&s->lock, NULL) | pthread_cond_init(&s->changed, NULL) ? CV_ENOMEM
                                                                                       : CV_OK;
    patch_init(&s->problem);
    for (int j = 0; j < CV_N_CONSTANTS; j++)
        apm_init(s->constants[j]);
    s->method = method == CV_THESIS ? &method_thesis : &method_loewner;
    s->precision = (precision){ dp, as_printed, longest };
    s->depth = depth;
    s->stubborn = stubborn;
    g.s = s;
    if (status == CV_OK) {
        s->numbers_lost = guard_run(set_up_problem, &g, NULL) == GUARD_MEMORY;
        status = s->numbers_lost ? CV_ENOMEM : g.status;
    }
    if (status == CV_OK)
        status = cv_restart(s, "?", &root);
    if (status == CV_OK) {
        *result = s;
    } else {
        cv_search_free(s);
    }
    return status;
}
