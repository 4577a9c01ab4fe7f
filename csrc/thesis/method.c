/* method.c - the thesis's method as a search sees it: a prism is tried in doubles on its centre,
   in doubles, and with exact decimals, which alone prove (Appendix C, main). */
#include <stdlib.h>

#include "search/method.h"
#include "thesis/unit.h"

typedef struct {
    Runit *exact;
    unit *quick;
    box root, prism;                    /* all of the problem, and the cell at hand */
} bench;

static int thesis_accepts(const patch *p, const precision *how)
{
    (void)how;
    return is_of_thesis(p) ? CV_OK : CV_EARGUMENT;
}

static void thesis_choose_start(const patch *p, int symmetric, double x[ANGLES])
{
    double abc[MOST_WAVES];

    patch_amplitudes(p, 0.0, abc);
    set_LL_start(x, abc, symmetric);
}

static void for_box(box *b, void (*what)(apm_t))
{
    for (int j = 0; j < 5; j++) {
        what(b->centre[j]);
        what(b->half[j]);
    }
    what(b->xstar[0]);
    what(b->xstar[1]);
}

/* The work is GMP's numbers, in all its parts. */
static void free_bench(void *work, int numbers_lost)
{
    bench *const w = work;

    if (w == NULL || numbers_lost)
        return;
    Runit_free(w->exact);
    unit_free(w->quick);
    for_box(&w->root, apm_clear);
    for_box(&w->prism, apm_clear);
    free(w);
}

/* All of the problem as a prism; its parameters are the amplitudes of the waves. */
static void set_root(box *root, const patch *p)
{
    for (int j = 0; j < 3; j++) {
        apm_set(root->centre[j], p->amplitude[j]);
        apm_set(root->half[j], p->part[j][j]);
    }
    for (int j = 0; j < 2; j++) {
        apm_set(root->centre[3 + j], p->angle[j]);
        apm_set(root->half[3 + j], p->half[j]);
        apm_set(root->xstar[j], p->xstar[j]);
    }
}

static int thesis_prepare(void **work, const patch *p, const precision *how,
                          apm_t constants[CV_N_CONSTANTS], int *at_once)
{
    bench *const w = *work = calloc(1, sizeof *w);
    double abc[MOST_WAVES], herman_start[2];
    int status;

    *at_once = 0;
    if (w == NULL)
        return CV_ENOMEM;
    for_box(&w->root, apm_init);
    for_box(&w->prism, apm_init);
    w->exact = Runit_new(how->digits, how->as_printed);
    w->quick = unit_new(how->digits, how->as_printed);
    if (w->exact == NULL || w->quick == NULL)
        return CV_ENOMEM;
    set_root(&w->root, p);
    set_root(&w->prism, p);
    patch_amplitudes(p, 0.0, abc);
    set_Herm_start(herman_start, abc, 1);
    status = Rprepare_trial(w->exact, &w->root, herman_start, NULL);
    if (status == CV_OK)
        status = Runit_constants(w->exact, constants);
    return status != CV_OK ? status : prepare_trial(w->quick, &w->root, herman_start, constants);
}

static int thesis_copy(void **copy, const void *work, const patch *p, const precision *how)
{
    apm_t constants[CV_N_CONSTANTS];
    int at_once, status;

    (void)work;
    for (int j = 0; j < CV_N_CONSTANTS; j++)
        apm_init(constants[j]);
    status = thesis_prepare(copy, p, how, constants, &at_once);
    for (int j = 0; j < CV_N_CONSTANTS; j++)
        apm_clear(constants[j]);
    return status;
}

static int thesis_has_axis(const patch *p, int axis)
{
    (void)p;
    return axis == V0 || axis == V1;
}

static int thesis_lanes(const void *work)
{
    (void)work;
    return 1;
}

/* The prism of a cell, exactly. */
static void set_prism(bench *w, const cv_cell *c)
{
    box *const b = &w->prism;

    b->n_cuts = 0;
    for (int axis = V0; axis <= V1; axis++) {
        apm_t *centre = &b->centre[3 + axis], *half = &b->half[3 + axis];
        apm_set(*half, w->root.half[3 + axis]);
        for (int k = 0; k < c->cuts[axis]; k++)
            apm_mul_si(*half, *half, 5);
        apm_scale(*half, *half, -c->cuts[axis]);
        apm_mul_si(*centre, *half, 2 * (long)c->index[axis] + 1 - (1L << c->cuts[axis]));
        apm_add(*centre, *centre, w->root.centre[3 + axis]);
        b->n_cuts += c->cuts[axis];
    }
}

static void try_cell(bench *w, const cv_cell *c, outcome *out)
{
    const box *const b = &w->prism;
    verdict *const v = &out->v;

    *out = (outcome){ .hint = c->hint, .quick_tries = 1 };
    set_prism(w, c);
    out->axis = apm_cmp(b->half[4], b->half[3]) > 0 ? V1 : V0;      /* the wider; ties to v0 */
    quick_try(w->quick, b, v);
    if (v->no_tori) {
        out->tries = 1;
        try_prism(w->quick, b, v);
        out->steps = v->nsteps;
        for (int j = 0; j < 3; j++)
            out->ll_used[j] = v->ll_used[j];
    }
    if (v->no_tori) {
        out->Rtries = 1;
        Rtry_prism(w->exact, b, v);
        if (!v->no_tori && v->reason != CV_REASON_ARITHMETIC && v->reason != CV_REASON_SINGULAR)
            v->reason = CV_REASON_DISAGREE;
    }
}

static int thesis_try(void *work, int n, const cv_cell *const cells[], outcome *const out[])
{
    for (int k = 0; k < n; k++)
        try_cell(work, cells[k], out[k]);
    return CV_OK;
}

const method method_thesis = {
    .accepts = thesis_accepts,
    .choose_start = thesis_choose_start,
    .start_places = 16,
    .prepare = thesis_prepare,
    .copy = thesis_copy,
    .free = free_bench,
    .has_axis = thesis_has_axis,
    .lanes = thesis_lanes,
    .try = thesis_try,
};
