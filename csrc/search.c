/* search.c - the list of untested prisms and the main loop (thesis, Appendix C, main).

   The list is a stack: a prism that fails is replaced by its two halves, the first of which is
   tried next.  So the tree of all prisms is met in preorder, and one character per node,
   written as it is decided, is the whole of the proof.  What becomes of a prism depends on
   nothing but itself, so parts of the tree can be grown apart. */
#define _POSIX_C_SOURCE 200809L

#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "loewner/loewner.h"
#include "numbers/memory.h"
#include "numbers/special.h"
#include "thesis/unit.h"

#ifdef __FAST_MATH__
#error "-ffast-math breaks the rules of rigor"
#endif
#if FLT_EVAL_METHOD != 0
#error "doubles must be evaluated as doubles"
#endif

enum { MAX_DP = 100000, MAX_DEPTH = 100000 };
enum { AXES = 5, V0 = 0, V1 = 1, FINEST = 61 };         /* of a cell; cuts that its index can hold */
enum { PI_SHORT = 5, B_PLACES = 12 };   /* see to_radians; B as it is reported */

struct cv_search {
    Runit *exact;                       /* method thesis */
    unit *quick;
    loewner *sharp;                     /* method Loewner */
    box root, prism;                    /* prism: the cell at hand, for the thesis's method */
    cv_cell *stack;
    int pending, allocated;             /* cells on the stack; room for */
    char *tree;
    size_t length, capacity;
    cv_counts counts, before;           /* before: as it was when the node at hand was begun */
    apm_t constants[N_CONSTANTS], t[2];
    double decided;
    int depth, stubborn, together, symmetric, at_once, last_steps, status;
};

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

static int all_cuts(const cv_cell *c)
{
    return c->cuts[0] + c->cuts[1] + c->cuts[2] + c->cuts[3] + c->cuts[4];
}

/* s->prism = the cell of a search that cuts v0 and v1 only, exactly. */
static void set_box(cv_search *s, const cv_cell *c)
{
    box *b = &s->prism;

    for (int axis = V0; axis <= V1; axis++) {
        apm_t *centre = &b->centre[3 + axis], *half = &b->half[3 + axis];
        apm_set(*half, s->root.half[3 + axis]);
        for (int k = 0; k < c->cuts[axis]; k++)
            apm_mul_si(*half, *half, 5);
        apm_scale(*half, *half, -c->cuts[axis]);
        apm_mul_si(*centre, *half, 2 * (long)c->index[axis] + 1 - (1L << c->cuts[axis]));
        apm_add(*centre, *centre, s->root.centre[3 + axis]);
    }
    b->n_cuts = all_cuts(c);
}

/* Adds one node to the tree; room is made in advance so that a node is never half decided. */
static int make_room(cv_search *s)
{
    if (s->length == s->capacity) {
        const size_t capacity = 2 * s->capacity + 4096;
        char *tree = realloc(s->tree, capacity);
        if (tree == NULL)
            return CV_ENOMEM;
        s->tree = tree;
        s->capacity = capacity;
    }
    if (s->pending + 1 >= s->allocated) {
        const int allocated = 2 * s->allocated + 64;
        cv_cell *stack = realloc(s->stack, (size_t)allocated * sizeof *stack);
        if (stack == NULL)
            return CV_ENOMEM;
        s->stack = stack;
        s->allocated = allocated;
    }
    return CV_OK;
}

static void leaf(cv_search *s, char kind)
{
    const int cuts = all_cuts(&s->stack[--s->pending]);

    s->tree[s->length++] = kind;
    s->decided += ldexp(1.0, -cuts);
    if (kind == 'P') {
        s->counts.proved++;
        if (cuts > s->counts.most_cuts)
            s->counts.most_cuts = cuts;
    } else if (kind == 'S') {
        s->counts.symmetric++;
    } else {
        s->counts.undecided++;
        if (!s->stubborn)
            s->status = CV_OK;          /* one prism too hard, and all is lost */
    }
    if (s->pending == 0)
        s->status = CV_OK;
}

/* The cell is cut in half across axis, the lower half to come first, or given up if it has been
   cut too often or, axis < 0, if that would not help.  Thesis: refinePrism. */
static void cut(cv_search *s, int axis)
{
    cv_cell *upper = &s->stack[s->pending - 1], *lower = upper + 1;

    if (axis < 0 || all_cuts(upper) >= s->depth || upper->cuts[axis] == FINEST) {
        leaf(s, 'U');
        return;
    }
    upper->cuts[axis]++;
    upper->index[axis] *= 2;
    *lower = *upper;
    upper->index[axis]++;
    s->pending++;
    s->tree[s->length++] = (char)('0' + axis);
    s->counts.cuts++;
}

/* Exchanging v0 and v1 exchanges a and b, and leaves x* alone if it lies on the diagonal.  If
   all the data of the problem are symmetric so is the set of minimizing states: of two mirror
   images one will do, and the prisms wholly on the side v1 >= v0 are skipped.  Their mirror
   images are covered by the prisms that are not.  Thesis: consultTree, section 3.4.4. */
static int may_skip(const cv_search *s, const cv_cell *c)
{
    const int k = c->cuts[V0], l = c->cuts[V1];

    if (!s->symmetric)
        return 0;                       /* else: is index1 / 2^l >= (index0 + 1) / 2^k ? */
    return k > l ? c->index[V1] << (k - l) > c->index[V0]
                 : c->index[V1] >= (c->index[V0] + 1) << (l - k);
}

/* What the try of a prism came to: proved, or to be cut across axis. */
static void conclude(cv_search *s, const verdict *v, int axis)
{
    s->last_steps = v->nsteps;
    if (!v->no_tori) {
        s->counts.reasons[v->reason]++;
        cut(s, axis);
        return;
    }
    if (v->nsteps > s->counts.max_NTsteps)
        s->counts.max_NTsteps = v->nsteps;
    leaf(s, 'P');
}

/* One prism of the list: skip it, prove it, cut it or give it up.  Thesis: main. */
static void decide(cv_search *s)
{
    cv_cell *c = &s->stack[s->pending - 1];
    const box *b = &s->prism;
    verdict v;

    s->last_steps = 0;
    if (may_skip(s, c)) {
        leaf(s, 'S');
        return;
    }
    if (s->sharp != NULL) {
        int axis;
        s->counts.tries++;
        loewner_try(s->sharp, c, &v, &axis, &c->from);
        conclude(s, &v, axis);
        return;
    }
    set_box(s, c);
    s->counts.quick_tries++;
    quick_try(s->quick, b, &v);
    if (v.no_tori) {
        s->counts.tries++;
        try_prism(s->quick, b, &v);
        if (v.nsteps > s->counts.max_steps)
            s->counts.max_steps = v.nsteps;
    }
    if (v.no_tori) {
        s->counts.Rtries++;
        Rtry_prism(s->exact, b, &v);
        if (!v.no_tori && v.reason != CV_REASON_ARITHMETIC && v.reason != CV_REASON_SINGULAR)
            v.reason = CV_REASON_DISAGREE;
    }
    if (v.no_tori) {
        if (v.by_trace)
            s->counts.HermSuccess++;
        else
            s->counts.LLSuccess++;
        s->counts.ll_used[v.ll_used]++;
    }
    conclude(s, &v, apm_cmp(b->half[4], b->half[3]) > 0 ? V1 : V0);     /* the wider; ties to v0 */
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static long decided_leaves(const cv_search *s)
{
    return s->counts.proved + s->counts.symmetric + s->counts.undecided;
}

int cv_step(cv_search *s, long max_leaves, double max_seconds)
{
    const double end = now() + max_seconds;
    const long stop = decided_leaves(s) + max_leaves;
    jmp_buf here, *const before = memory_guard(&here);

    if (setjmp(here) != 0) {            /* the node at hand is forgotten, the rest stands */
        s->counts = s->before;
        s->status = CV_ENOMEM;
    }
    while (s->status == CV_RUNNING && decided_leaves(s) < stop) {
        if (make_room(s) != CV_OK) {
            s->status = CV_ENOMEM;
            break;
        }
        s->before = s->counts;
        decide(s);
        if (now() >= end)
            break;
    }
    memory_guard(before);
    return s->status;
}

int cv_restart(cv_search *s, int n, const cv_cell *cells)
{
    if (s->status == CV_ENOMEM)         /* its numbers are abandoned */
        return CV_ENOMEM;
    if (n < 0)
        return CV_EARGUMENT;
    for (int j = 0; j < n; j++)
        for (int axis = 0; axis < AXES; axis++)
            if (cells[j].cuts[axis] < 0 || cells[j].cuts[axis] > FINEST ||
                cells[j].index[axis] >> cells[j].cuts[axis] != 0)
                return CV_EARGUMENT;
    if (n + 1 > s->allocated) {
        cv_cell *stack = realloc(s->stack, (size_t)(n + 1) * sizeof *stack);
        if (stack == NULL)
            return CV_ENOMEM;
        s->stack = stack;
        s->allocated = n + 1;
    }
    for (int j = 0; j < n; j++)
        s->stack[j] = cells[n - 1 - j];
    s->pending = n;
    s->length = 0;
    s->decided = 0.0;
    memset(&s->counts, 0, sizeof s->counts);
    s->status = n > 0 ? CV_RUNNING : CV_OK;
    return CV_OK;
}

int cv_pending(const cv_search *s, cv_cell *cells)
{
    for (int j = 0; cells != NULL && j < s->pending; j++)
        cells[j] = s->stack[s->pending - 1 - j];
    return s->pending;
}

const char *cv_tree(const cv_search *s, size_t *length)
{
    *length = s->length;
    return s->tree;
}

const cv_counts *cv_get_counts(const cv_search *s) { return &s->counts; }
double cv_volume_decided(const cv_search *s) { return s->decided; }
int cv_last_steps(const cv_search *s) { return s->last_steps; }
int cv_symmetric(const cv_search *s) { return s->symmetric; }
int cv_at_once(const cv_search *s) { return s->at_once; }
void cv_free(char *text) { free(text); }

char *cv_constant(const cv_search *s, int which)
{
    if (which < 0 || which > 11)
        return NULL;
    if (which < 2)
        return apm_get_str(s->root.xstar[which]);
    if (which < 8)
        return apm_get_str(s->constants[which - 2]);
    return apm_get_str(which % 2 == 0 ? s->root.centre[3 + (which - 8) / 2]
                                      : s->root.half[3 + (which - 8) / 2]);
}

/* After CV_ENOMEM the numbers are abandoned, not freed: see memory.c. */
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
    free(s->tree);
    free(s);
}

/* What the double-precision unit is for must hold, or the filter and every later use of
   rigorous doubles is void: rounding to nearest, and numbers below the normal ones. */
static int machine_is_sound(void)
{
    volatile double tiny = DBL_MIN, one = 1.0, third;

    tiny *= 0.5;
    third = one / 3.0;
    return fegetround() == FE_TONEAREST && tiny > 0.0 && third * 3.0 == 1.0 &&
           one + 0.5 * DBL_EPSILON == 1.0 && one - 0.25 * DBL_EPSILON == 1.0;
}

/* The angles of the root, from units of pi to radians: an enclosure of the region meant, with pi
   cut off after dp places, PI_SHORT places before the errors of sines begin.  So the centres of
   prisms lie a little below the multiples of pi they stand for, by more than the errors of their
   sines, and what depends on the sign of such a sine (the column rotor) is no accident.  The pi
   of 1989 was short, too. */
static void to_radians(cv_search *s, long dp)
{
    apm_t pi, ulp;

    apm_init(pi);
    apm_init(ulp);
    apm_pi(pi, dp);
    apm_set_si(ulp, 1, -dp);
    for (int j = 3; j < 5; j++) {
        apm_abs(s->t[0], s->root.centre[j]);            /* how far |centre pi| may be off */
        apm_mul(s->t[0], s->t[0], ulp);
        apm_mul(s->root.centre[j], s->root.centre[j], pi);
        apm_add(pi, pi, ulp);
        apm_mul(s->root.half[j], s->root.half[j], pi);
        apm_sub(pi, pi, ulp);
        apm_add(s->root.half[j], s->root.half[j], s->t[0]);
        apm_round(s->t[1], s->root.centre[j], dp, APM_TRUNC);
        if (apm_cmp(s->t[1], s->root.centre[j]) != 0)
            apm_add(s->root.half[j], s->root.half[j], ulp);
        apm_swap(s->t[1], s->root.centre[j]);
        apm_round(s->root.half[j], s->root.half[j], dp, APM_UP);
    }
    apm_clear(pi);
    apm_clear(ulp);
}

static int read_problem(cv_search *s, const char *const region[5], const char *const half[5],
                        const char *const xstar[2], int method, long pi_dp)
{
    double abc[3], start[2], herman_start[2];
    char text[40];
    int status;

    for (int j = 0; j < 5; j++) {
        if (apm_set_str(s->root.centre[j], region[j]) != APM_OK ||
            apm_set_str(s->root.half[j], half[j]) != APM_OK)
            return CV_ENUMBER;
        if (apm_sgn(s->root.half[j]) < 0)
            return CV_EARGUMENT;
    }
    s->symmetric = apm_cmp(s->root.centre[0], s->root.centre[1]) == 0 &&
                   apm_cmp(s->root.half[0], s->root.half[1]) == 0 &&
                   apm_cmp(s->root.centre[3], s->root.centre[4]) == 0 &&
                   apm_cmp(s->root.half[3], s->root.half[4]) == 0;
    to_radians(s, pi_dp);
    for (int j = 0; j < 3; j++)
        abc[j] = apm_get_d(s->root.centre[j]);
    if (method == CV_LOEWNER)
        set_gap_start(start, abc, s->symmetric);
    else
        set_LL_start(start, abc, s->symmetric);
    set_Herm_start(herman_start, abc, 1);
    for (int j = 0; j < 2; j++) {
        if (xstar == NULL)
            snprintf(text, sizeof text, method == CV_LOEWNER ? "%.6f" : "%.17g", start[j]);
        if (apm_set_str(s->root.xstar[j], xstar == NULL ? text : xstar[j]) != APM_OK)
            return CV_ENUMBER;
    }
    if (apm_cmp(s->root.xstar[0], s->root.xstar[1]) != 0)
        s->symmetric = 0;

    if (method == CV_LOEWNER) {
        s->sharp = loewner_new(&s->root, s->together, s->quick);
        if (s->sharp == NULL)
            return CV_ENOMEM;
        if (!isfinite(loewner_largest(s->sharp)))
            return CV_EARITHMETIC;
        apm_set_d(s->t[0], loewner_largest(s->sharp));
        apm_round(s->constants[C_B], s->t[0], B_PLACES, APM_UP);
        if (s->together)
            for (int j = 0; j < 3; j++)
                abc[j] += apm_get_d(s->root.half[j]);
        set_LL_start(start, abc, s->symmetric);
        s->at_once = loewner_at_once(s->sharp, start);
        return CV_OK;
    }
    for (int j = 0; j < 5; j++) {
        apm_set(s->prism.centre[j], s->root.centre[j]);
        apm_set(s->prism.half[j], s->root.half[j]);
    }
    apm_set(s->prism.xstar[0], s->root.xstar[0]);
    apm_set(s->prism.xstar[1], s->root.xstar[1]);
    status = Rprepare_trial(s->exact, &s->root, herman_start, NULL);
    if (status != CV_OK)
        return status;
    Runit_constants(s->exact, s->constants);
    return prepare_trial(s->quick, &s->root, herman_start, s->constants);
}

int cv_search_new(cv_search **result, const char *const region[5], const char *const half[5],
                  const char *const xstar[2], int method, int together, int dp, int depth,
                  int stubborn, int as_printed)
{
    static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };
    cv_search *s;
    jmp_buf here, *before;
    int status;

    *result = NULL;
    if (dp < 1 || dp > MAX_DP || depth < 0 || depth > MAX_DEPTH ||
        (method != CV_THESIS && method != CV_LOEWNER) ||
        (method == CV_THESIS ? together : as_printed))
        return CV_EARGUMENT;
    if (!machine_is_sound())
        return CV_EMACHINE;
    s = calloc(1, sizeof *s);
    if (s == NULL)
        return CV_ENOMEM;
    box_init(&s->root);
    box_init(&s->prism);
    for (int j = 0; j < N_CONSTANTS; j++)
        apm_init(s->constants[j]);
    apm_init(s->t[0]);
    apm_init(s->t[1]);
    s->depth = depth;
    s->stubborn = stubborn;
    s->together = together;
    s->status = CV_RUNNING;

    before = memory_guard(&here);
    if (setjmp(here) != 0) {
        status = CV_ENOMEM;
    } else {
        s->exact = Runit_new(dp, as_printed);
        s->quick = unit_new(dp, as_printed);
        status = s->exact == NULL || s->quick == NULL ? CV_ENOMEM
                 : read_problem(s, region, half, xstar, method,
                                as_printed ? dp : dp > PI_SHORT ? dp - PI_SHORT : 1);
        if (status == CV_OK)
            status = cv_restart(s, 1, &whole);
    }
    memory_guard(before);
    if (status == CV_OK) {
        *result = s;
    } else {
        s->status = status;
        cv_search_free(s);
    }
    return status;
}
