/* tree.c - the list of untested prisms and the main loop (thesis, Appendix C, main).

   The list is a stack: a prism that fails is replaced by its two halves, the first of which is
   tried next.  So the tree of all prisms is met in preorder, and one character per node,
   written as it is decided, is the whole of the proof.  What becomes of a prism depends on
   itself and on what its parent learnt (cv_cell's from), so parts of the tree can be grown
   apart. */
#define _POSIX_C_SOURCE 200809L

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "arith/guard.h"
#include "arith/machine.h"
#include "search/search.h"

enum { AXES = 5, V0 = 0, V1 = 1, FINEST = 61 };         /* of a cell; cuts that its index can hold */

static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };

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

static int room_on_stack(cv_search *s, int allocated)
{
    cv_cell *const stack = realloc(s->stack, (size_t)allocated * sizeof *stack);
    if (stack == NULL)
        return CV_ENOMEM;
    s->stack = stack;
    int *const noted = realloc(s->noted, (size_t)allocated * sizeof *noted);
    if (noted == NULL)
        return CV_ENOMEM;
    s->noted = noted;
    s->allocated = allocated;
    return CV_OK;
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
        int *steps = realloc(s->steps, capacity * sizeof *steps);
        if (steps == NULL)
            return CV_ENOMEM;
        s->steps = steps;
        s->capacity = capacity;
    }
    if (s->pending + 1 >= s->allocated && room_on_stack(s, 2 * s->allocated + 64) != CV_OK)
        return CV_ENOMEM;
    if (s->sharp != NULL && s->n_notes + s->pending + 2 * MOST_LANES > s->allocated_notes) {
        const int allocated = 2 * s->allocated_notes + s->pending + 64;
        note *const notes = realloc(s->notes, (size_t)allocated * sizeof *notes);
        if (notes == NULL)
            return CV_ENOMEM;
        s->notes = notes;
        s->allocated_notes = allocated;
    }
    return CV_OK;
}

/* Counts a leaf of so many cuts. */
static void count_leaf(cv_search *s, char kind, int cuts)
{
    if (kind == 'P') {
        s->counts.proved++;
        if (cuts > s->counts.most_cuts)
            s->counts.most_cuts = cuts;
    } else if (kind == 'S') {
        s->counts.symmetric++;
    } else {
        s->counts.undecided++;
    }
}

static void leaf(cv_search *s, char kind)
{
    s->tree[s->length] = kind;
    s->steps[s->length++] = s->last_steps;
    count_leaf(s, kind, all_cuts(&s->stack[--s->pending]));
    if (kind == 'U') {
        if (!s->stubborn)
            s->status = CV_OK;          /* one prism too hard, and all is lost */
    }
    if (s->pending == 0)
        s->status = CV_OK;
}

/* May the cell be cut again across axis? */
static int may_cut(const cv_search *s, const cv_cell *c, int axis)
{
    return all_cuts(c) < s->depth && c->cuts[axis] < FINEST;
}

/* The cell becomes the upper of its halves across axis. */
static void split(cv_cell *upper, int axis, cv_cell *lower)
{
    upper->cuts[axis]++;
    upper->index[axis] *= 2;
    *lower = *upper;
    upper->index[axis]++;
}

/* Cuts the cell on top of the stack in half, the lower half to come first. */
static void halve(cv_search *s, int axis)
{
    cv_cell *upper = &s->stack[s->pending - 1], *lower = upper + 1;

    s->counts.cuts++;
    split(upper, axis, lower);
    s->noted[s->pending - 1] = s->noted[s->pending] = -1;
    s->pending++;
}

/* The cell is cut across axis, or given up if it has been cut too often or, axis < 0, if that would
   not help.  Thesis: refinePrism. */
static void cut(cv_search *s, int axis)
{
    if (axis < 0 || !may_cut(s, &s->stack[s->pending - 1], axis)) {
        leaf(s, 'U');
        return;
    }
    halve(s, axis);
    s->steps[s->length] = 0;
    s->tree[s->length++] = (char)('0' + axis);
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

/* ---- method Loewner: several prisms are tried at a time, some of them before their turn */

static int new_note(cv_search *s, const cv_cell *cell)
{
    const int id = s->free_note >= 0 ? s->free_note : s->n_notes++;
    note *const n = &s->notes[id];

    if (id == s->free_note)
        s->free_note = n->halves[0];
    *n = (note){ .cell = *cell, .halves = { -1, -1 } };
    return id;
}

/* Adds what is not yet known of a prism and those it was cut into to the list, in preorder.
   Returns whether all is known. */
static int list_unknown(cv_search *s, int id, int list[], int *n, int most)
{
    note *const p = &s->notes[id];

    if (p->settled)
        return 1;
    if (!p->known)
        p->known = p->skipped = may_skip(s, &p->cell);
    p->settled = p->known;
    if (!p->known)
        list[(*n)++] = id;
    for (int k = 0; k < 2 && p->halves[k] >= 0; k++)
        p->settled &= *n < most && list_unknown(s, p->halves[k], list, n, most);
    return p->settled;
}

/* Tries the first prisms of those in line, as many as go at once. */
static void look_ahead(cv_search *s)
{
    const int lanes = loewner_lanes(s->sharp);
    const cv_cell *cells[MOST_LANES];
    loewner_outcome *out[MOST_LANES];
    int list[MOST_LANES], n = 0;

    for (int j = s->pending - 1; j >= 0 && n < lanes; j--) {
        if (s->noted[j] < 0)
            s->noted[j] = new_note(s, &s->stack[j]);
        list_unknown(s, s->noted[j], list, &n, lanes);
    }
    for (int k = 0; k < n; k++) {
        cells[k] = &s->notes[list[k]].cell;
        out[k] = &s->notes[list[k]].outcome;
    }
    if (n > 0)
        loewner_try(s->sharp, n, cells, out);
    for (int k = 0; k < n; k++) {
        note *const p = &s->notes[list[k]];
        const int axis = p->outcome.axis;
        p->known = 1;
        if (!p->outcome.v.no_tori && axis >= 0 && may_cut(s, &p->cell, axis)) {
            cv_cell upper = p->cell, lower;
            upper.from = p->outcome.from;
            split(&upper, axis, &lower);
            p->halves[0] = new_note(s, &lower);
            p->halves[1] = new_note(s, &upper);
        }
    }
}

/* What is on top of the list gets its turn. */
static void take_note(cv_search *s)
{
    const int top = s->pending - 1;

    if (s->noted[top] < 0 || !s->notes[s->noted[top]].known)
        look_ahead(s);
    note *const n = &s->notes[s->noted[top]];
    if (n->skipped) {
        leaf(s, 'S');
    } else {
        const int lower = n->halves[0], upper = n->halves[1];
        s->counts.tries++;
        s->stack[top].from = n->outcome.from;
        conclude(s, &n->outcome.v, n->outcome.axis);
        if (s->pending > top + 1) {
            s->noted[top + 1] = lower;
            s->noted[top] = upper;
        }
    }
    n->halves[0] = s->free_note;
    s->free_note = (int)(n - s->notes);
}

/* One prism of the list: skip it, prove it, cut it or give it up.  Thesis: main. */
static void decide(cv_search *s)
{
    cv_cell *c = &s->stack[s->pending - 1];
    const box *b = &s->prism;
    verdict v;

    s->last_steps = 0;
    if (s->sharp != NULL) {
        take_note(s);
        return;
    }
    if (may_skip(s, c)) {
        leaf(s, 'S');
        return;
    }
    set_box(s, c);
    s->counts.quick_tries++;
    quick_try(s->quick, b, &v);
    if (v.no_tori) {
        s->counts.tries++;
        try_prism(s->quick, b, &v);
        for (int j = 0; j < 3; j++)
            s->counts.ll_used[j] += v.ll_used[j];
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
    }
    conclude(s, &v, apm_cmp(b->half[4], b->half[3]) > 0 ? V1 : V0);     /* the wider; ties to v0 */
}

/* The class of a cell: logarithmic, two to an octave. */
int cv_class(int from)
{
    int class = 0;

    for (int bound = 2; class < CV_CLASSES - 1 && from >= bound; class++)
        bound = class % 2 == 0 ? bound / 2 * 3 : bound / 3 * 4;
    return class;
}

static void decide_and_remember(cv_search *s)
{
    const cv_cell *c = &s->stack[s->pending - 1];
    const int cuts = all_cuts(c), level = cuts < CV_LEVELS ? cuts : CV_LEVELS - 1;
    const int class = cv_class(c->from), pending = s->pending;

    decide(s);
    s->history.nodes[level][class]++;
    if (s->pending > pending) {
        s->history.cut[level][class]++;
        s->history.became[class][cv_class(s->stack[pending].from)]++;
    }
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

/* How much of a search to do. */
typedef struct {
    cv_search *s;
    long enough;
    double end;
    const cv_stop *stop;
} step;

static void take_step(void *data)
{
    const step *const how = data;
    cv_search *const s = how->s;

    while (s->status == CV_RUNNING && s->pending > 0 && decided_leaves(s) < how->enough) {
        if (make_room(s) != CV_OK) {
            s->status = CV_ENOMEM;
            break;
        }
        s->before = s->counts;
        decide_and_remember(s);
        if (now() >= how->end || cv_stop_get(how->stop))
            break;
    }
}

int cv_step(cv_search *s, long max_leaves, double max_seconds, const cv_stop *stop)
{
    step how = { s, decided_leaves(s) + max_leaves, now() + max_seconds, stop };
    int ended = GUARD_DONE;

    if (s->status == CV_RUNNING && (!s->prepared || !machine_is_sound()))
        s->status = s->prepared ? CV_EMACHINE : CV_EARGUMENT;
    s->before = s->counts;
    ended = guard_run(take_step, &how, stop);
    if (ended != GUARD_DONE)            /* the node at hand is forgotten, the rest stands */
        s->counts = s->before;
    if (ended == GUARD_MEMORY)
        s->status = CV_ENOMEM;
    if (s->status >= CV_OK && !machine_is_sound())
        s->status = CV_EMACHINE;        /* who knows since when: see converse.h */
    return s->status;
}

int cv_restart(cv_search *s, int n, const cv_cell *cells)
{
    if (s->status == CV_ENOMEM)         /* its numbers are abandoned */
        return CV_ENOMEM;
    if (n < 0 || s->spoilt)
        return CV_EARGUMENT;
    for (int j = 0; j < n; j++)
        for (int axis = 0; axis < AXES; axis++)
            if (cells[j].cuts[axis] < 0 || cells[j].cuts[axis] > FINEST ||
                cells[j].index[axis] >> cells[j].cuts[axis] != 0)
                return CV_EARGUMENT;
    if (n + 1 > s->allocated && room_on_stack(s, n + 1) != CV_OK)
        return CV_ENOMEM;
    for (int j = 0; j < n; j++) {
        s->stack[j] = cells[n - 1 - j];
        s->noted[j] = -1;
    }
    s->n_notes = 0;
    s->free_note = -1;
    s->pending = n;
    s->length = 0;
    memset(&s->counts, 0, sizeof s->counts);
    memset(&s->history, 0, sizeof s->history);
    s->status = n > 0 ? CV_RUNNING : CV_OK;
    return CV_OK;
}

/* The nodes of a tree that was grown before are counted, and leave their untried prisms. */
static int take_up(cv_search *s, const char *tree, size_t length, cv_cell **untried, int *n)
{
    const int axes = s->method == CV_THESIS ? 2 : 2 + s->problem.n_parameters;
    int allocated = 0;

    for (size_t j = 0; j < length; j++) {
        const int axis = tree[j] - '0';
        if (s->pending == 0 || make_room(s) != CV_OK)
            return s->pending == 0 ? CV_EARGUMENT : CV_ENOMEM;
        cv_cell *const c = &s->stack[s->pending - 1];
        if (axis >= 0 && axis < axes && may_cut(s, c, axis)) {
            halve(s, axis);
            continue;
        }
        s->pending--;
        if (tree[j] == '?') {
            if (*n == allocated) {
                allocated = 2 * allocated + 64;
                cv_cell *const more = realloc(*untried, (size_t)allocated * sizeof *more);
                if (more == NULL)
                    return CV_ENOMEM;
                *untried = more;
            }
            (*untried)[(*n)++] = *c;
        } else if (tree[j] == 'P' || tree[j] == 'U' || (tree[j] == 'S' && may_skip(s, c))) {
            count_leaf(s, tree[j], all_cuts(c));
        } else {
            return CV_EARGUMENT;
        }
    }
    return CV_OK;
}

int cv_resume(cv_search *s, const char *tree, size_t length)
{
    cv_cell *untried = NULL;
    int n = 0, status = cv_restart(s, 1, &whole);

    if (status == CV_OK)
        status = take_up(s, tree, length, &untried, &n);
    while (status == CV_OK && n > 0) {              /* they come before those that are missing */
        if (make_room(s) != CV_OK) {
            status = CV_ENOMEM;
        } else {
            s->noted[s->pending] = -1;
            s->stack[s->pending++] = untried[--n];
        }
    }
    free(untried);
    if (status != CV_OK)
        s->pending = 0;
    if (s->status != CV_ENOMEM)
        s->status = status != CV_OK ? status : s->pending > 0 ? CV_RUNNING : CV_OK;
    return status;
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
const cv_history *cv_get_history(const cv_search *s) { return &s->history; }
const int *cv_steps(const cv_search *s) { return s->steps; }
int cv_at_once(const cv_search *s) { return s->at_once; }
void cv_free(char *text) { free(text); }

char *cv_constant(const cv_search *s, int which)
{
    if (which < 0 || which >= 12 || (which >= 2 && !s->prepared))
        return NULL;
    return apm_get_str(which < 2 ? s->problem.xstar[which]
                       : which < 8 ? s->constants[which - 2]
                       : which % 2 == 0 ? s->problem.angle[(which - 8) / 2]
                                        : s->problem.half[(which - 8) / 2]);
}
