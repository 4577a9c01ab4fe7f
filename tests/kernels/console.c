/* console.c - finds who answers a question, and turns its numbers into text and back. */
#include "console.h"

#include <stdlib.h>
#include <string.h>

#include "loewner/problem.h"
#include "search/search.h"
#include "thesis/unit.h"

enum { MAX_DP = 100000, MAX_IN = 64, MAX_OUT = 1079 };

int asks_for(const question *q, const shape *shape)
{
    return strcmp(q->name, shape->name) == 0 && q->nin == shape->nin && q->nout == shape->nout;
}

static int thesis_in(const question *q, int as_double)
{
    Runit *exact = as_double ? NULL : Runit_new(q->dp, q->as_printed);
    unit *quick = as_double ? unit_new(q->dp, q->as_printed) : NULL;
    const int status = exact != NULL ? Rthesis_answer(exact, q)
                     : quick != NULL ? thesis_answer(quick, q)
                                     : CV_ENOMEM;

    Runit_free(exact);
    unit_free(quick);
    return status;
}

static int answer(const question *q, int as_double)
{
    int status = numbers_answer(q);

    if (status == NOT_MINE)
        status = loewner_answer(q);
    if (status == NOT_MINE)
        status = thesis_in(q, as_double);
    return status == NOT_MINE ? CV_EARGUMENT : status;
}

int kernel(const char *name, int as_double, int as_printed, int dp, int nin, const char *const in[],
           int nout, char *out[])
{
    apm_t x[MAX_IN + MAX_OUT];
    const question q = { name, dp, as_printed, nin, nout, x, x + MAX_IN };
    int status = CV_OK;

    if (nin < 0 || nin > MAX_IN || nout < 0 || nout > MAX_OUT || dp < 1 || dp > MAX_DP)
        return CV_EARGUMENT;
    for (int j = 0; j < MAX_IN + MAX_OUT; j++)
        apm_init(x[j]);
    for (int j = 0; j < nin; j++)
        if (apm_set_str(x[j], in[j]) != APM_OK)
            status = CV_ENUMBER;
    if (status == CV_OK)
        status = answer(&q, as_double);
    for (int j = 0; j < nout; j++)
        out[j] = status == CV_OK ? apm_get_str(q.out[j]) : NULL;
    for (int j = 0; j < MAX_IN + MAX_OUT; j++)
        apm_clear(x[j]);
    return status;
}

/* Of a cv_search, which may be the product's. */
int search_lanes(const void *search)
{
    const cv_search *const s = search;

    return s->method->lanes(s->work);
}

/* Of one of the sharper method. */
int search_mirrored(const void *search)
{
    return ((const loewner *)((const cv_search *)search)->work)->mirrored;
}

/* Half of the width of v0 or v1 in radians, as a decimal that the caller frees. */
char *search_half(const void *search, int axis)
{
    return apm_get_str(((const cv_search *)search)->problem.half[axis]);
}
