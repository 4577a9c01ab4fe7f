/* tree.c - the list of untested prisms and the main loop (thesis, Appendix C, main).

   The list is a stack: a prism that fails is replaced by its two halves, the first of which is
   tried next.  So the tree of all prisms is met in preorder, and one character per node,
   written as it is decided, is the whole of the proof.  The outcome of a prism depends on itself
   and on what its parent learnt (cv_cell's hint), so parts of the tree can be grown apart. */
#define _POSIX_C_SOURCE 200809L

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "arith/guard.h"
#include "arith/machine.h"
#include "search/search.h"

static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };

static int room_on_stack(cv_search *s, int allocated)
{
    untested *const stack = realloc(s->stack, (size_t)allocated * sizeof *stack);
    if (stack == NULL)
        return CV_ENOMEM;
    s->stack = stack;
    s->allocated = allocated;
    return CV_OK;
}

static void push(cv_search *s, const cv_cell *cell)
{
    s->stack[s->pending++] = (untested){ *cell, -1 };
}

/* Makes room for one more node and its halves in advance, so that a node is never half decided. */
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
    return make_room_for_notes(s);
}

/* Counts a leaf below that number of cuts. */
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
    count_leaf(s, kind, all_cuts(&s->stack[--s->pending].cell));
    if (s->pending == 0 || (kind == 'U' && !s->stubborn))
        s->status = CV_OK;              /* the search has ended: nothing is left, or no theorem */
}

int may_halve(const cv_search *s, const cv_cell *c, int axis)
{
    return all_cuts(c) < s->depth && c->cuts[axis] < INDEX_BITS;
}

/* Cuts the cell on top of the stack in half, the lower half to come first. */
static void halve(cv_search *s, int axis)
{
    untested *const upper = &s->stack[s->pending - 1];
    cv_cell lower;

    s->counts.cuts++;
    split_cell(&upper->cell, axis, &lower);
    push(s, &lower);
}

/* The cell is cut across axis, or given up if it has been cut too often or, axis < 0, if that would
   not help.  Thesis: refinePrism. */
static void cut(cv_search *s, int axis)
{
    if (axis < 0 || !may_halve(s, &s->stack[s->pending - 1].cell, axis)) {
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
int may_skip(const cv_search *s, const cv_cell *c)
{
    const int k = c->cuts[V0], l = c->cuts[V1];

    if (!s->symmetric)
        return 0;                       /* else: is index1 / 2^l >= (index0 + 1) / 2^k ? */
    return k > l ? c->index[V1] << (k - l) > c->index[V0]
                 : c->index[V1] >= (c->index[V0] + 1) << (l - k);
}

/* Adds a try to the statistics; ends or cuts the prism on top of the stack, the tried one. */
static void conclude(cv_search *s, const outcome *out)
{
    const verdict *const v = &out->v;
    cv_counts *const counts = &s->counts;

    counts->quick_tries += out->quick_tries;
    counts->tries += out->tries;
    counts->Rtries += out->Rtries;
    for (int j = 0; j < 3; j++)
        counts->ll_used[j] += out->ll_used[j];
    if (out->steps > counts->max_steps)
        counts->max_steps = out->steps;
    s->stack[s->pending - 1].cell.hint = out->hint;
    s->last_steps = v->nsteps;
    s->points += v->nsteps;
    if (!v->no_tori) {
        counts->reasons[v->reason]++;
        cut(s, out->axis);
        return;
    }
    if (out->Rtries && v->by_trace)
        counts->HermSuccess++;
    else if (out->Rtries)
        counts->LLSuccess++;
    if (v->nsteps > counts->max_NTsteps)
        counts->max_NTsteps = v->nsteps;
    leaf(s, 'P');
}

/* One prism of the list: skip it, prove it, cut it or give it up.  Thesis: main.  CV_OK or
   CV_ENOMEM. */
static int decide(cv_search *s)
{
    const int top = s->pending - 1;
    const note *const n = note_on_top(s);

    if (n == NULL)
        return CV_ENOMEM;
    if (n->outcome.cut_off && s->precision.longest < 0) {
        s->status = CV_LONG;
        return CV_OK;
    }
    s->last_steps = 0;
    if (n->skipped)
        leaf(s, 'S');
    else
        conclude(s, &n->outcome);
    if (s->pending > top + 1) {
        s->stack[top + 1].note = n->halves[0];
        s->stack[top].note = n->halves[1];
    }
    forget_note(s, n);
    return CV_OK;
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
    long enough;                        /* leaves */
    double points, end;
    const cv_stop *stop;
} step;

static void take_step(void *data)
{
    const step *const how = data;
    cv_search *const s = how->s;

    while (s->status == CV_RUNNING && s->pending > 0 && decided_leaves(s) < how->enough &&
           s->points < how->points) {
        s->before = s->counts;
        if (make_room(s) != CV_OK || decide(s) != CV_OK) {
            s->status = CV_ENOMEM;
            break;
        }
        if (now() >= how->end || cv_stop_get(how->stop))
            break;
    }
}

int cv_step(cv_search *s, long max_leaves, double max_points, double max_seconds,
            const cv_stop *stop)
{
    step how = { s, decided_leaves(s) + max_leaves, s->points + max_points, now() + max_seconds,
                 stop };
    int ended = GUARD_DONE;

    if (s->status == CV_RUNNING && (s->stage != PREPARED || !machine_is_sound()))
        s->status = s->stage == PREPARED ? CV_EMACHINE : CV_EARGUMENT;
    s->before = s->counts;
    ended = guard_run(take_step, &how, stop);
    if (ended != GUARD_DONE)            /* the node at hand is forgotten, the rest stands */
        s->counts = s->before;
    if (ended == GUARD_MEMORY) {
        s->numbers_lost = 1;
        s->status = CV_ENOMEM;
    }
    if (s->status >= CV_OK && !machine_is_sound())
        s->status = CV_EMACHINE;        /* who knows since when: see converse.h */
    return s->status;
}

int cv_restart(cv_search *s, int n, const cv_cell *cells)
{
    if (s->numbers_lost)
        return CV_ENOMEM;
    if (s->stage == SPOILT)
        return CV_EARGUMENT;
    if (n + 1 > s->allocated && room_on_stack(s, n + 1) != CV_OK)
        return CV_ENOMEM;
    s->pending = 0;
    while (s->pending < n)
        push(s, &cells[n - 1 - s->pending]);
    forget_all_notes(s);
    s->length = 0;
    s->points = 0;
    memset(&s->counts, 0, sizeof s->counts);
    s->status = n > 0 ? CV_RUNNING : CV_OK;
    return CV_OK;
}

/* Counts the nodes of a tree that was grown before.  Puts its untried prisms, n of them, into an
   array with room for all of them. */
static int take_up(cv_search *s, const char *tree, size_t length, cv_cell untried[], int *n)
{
    const int axes = s->method->axes(&s->problem);

    for (size_t j = 0; j < length; j++) {
        const int axis = tree[j] - '0';
        if (s->pending == 0 || make_room(s) != CV_OK)
            return s->pending == 0 ? CV_EARGUMENT : CV_ENOMEM;
        const cv_cell *const c = &s->stack[s->pending - 1].cell;
        if (axis >= 0 && axis < axes && may_halve(s, c, axis)) {
            halve(s, axis);
            continue;
        }
        s->pending--;
        if (tree[j] == '?') {
            untried[(*n)++] = *c;
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
    size_t most = 1;
    int n = 0;

    for (size_t j = 0; j < length; j++)
        most += tree[j] == '?';
    cv_cell *const untried = malloc(most * sizeof *untried);
    int status = untried == NULL ? CV_ENOMEM : cv_restart(s, 1, &whole);
    if (status == CV_OK)
        status = take_up(s, tree, length, untried, &n);
    for (; status == CV_OK && n > 0; n--) {         /* they come before those that are missing */
        status = make_room(s);
        if (status == CV_OK)
            push(s, &untried[n - 1]);
    }
    free(untried);
    if (status != CV_OK)
        s->pending = 0;
    s->status = status != CV_OK ? status : s->pending > 0 ? CV_RUNNING : CV_OK;
    return status;
}

int cv_pending(const cv_search *s, cv_cell *cells)
{
    for (int j = 0; cells != NULL && j < s->pending; j++)
        cells[j] = s->stack[s->pending - 1 - j].cell;
    return s->pending;
}

const char *cv_tree(const cv_search *s, size_t *length)
{
    *length = s->length;
    return s->tree;
}

const cv_counts *cv_get_counts(const cv_search *s) { return &s->counts; }
const int *cv_steps(const cv_search *s) { return s->steps; }
int cv_at_once(const cv_search *s) { return s->at_once; }
void cv_free(char *text) { free(text); }

char *cv_xstar(const cv_search *s, int coordinate)
{
    return apm_get_str(s->problem.xstar[coordinate]);
}

char *cv_constant(const cv_search *s, int which) { return apm_get_str(s->constants[which]); }
