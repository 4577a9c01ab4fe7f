/* tree.c - the tree of prisms (thesis, Appendix C, main).

   A prism that fails is replaced by its two halves, the first of which comes next.  So the tree
   of all prisms is met in preorder, and one character per node is the whole of the proof.  The
   outcome of a prism depends on itself and on what its parent learnt (cv_cell's hint), and on no
   other prism.  So threads may try the first prisms of those that are pending in any order and
   company (threads.c).  A prism counts only when all before it are known: limits, statistics and
   the end at an undecided prism are those of a search that tries one prism after the other. */
#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "search/search.h"

enum { MOST_PENDING = AXES * INDEX_BITS + 1 };  /* A cut adds one, and a cell has fewer cuts. */
enum { OLD = -1 };                      /* the steps of a node of a tree that was taken up */

static const cv_cell whole; /* all zeros */

static int is_cut(char kind) { return kind >= '0' && kind < '0' + AXES; }

static int may_halve(const cv_search *s, const cv_cell *c, int axis)
{
    return all_cuts(c) < s->depth && c->cuts[axis] < INDEX_BITS;
}

/* The cell becomes the upper of its halves across axis. */
static void split_cell(cv_cell *upper, int axis, cv_cell *lower)
{
    upper->cuts[axis]++;
    upper->index[axis] *= 2;
    *lower = *upper;
    upper->index[axis]++;
}

/* May the cell be skipped, since its mirror image will do?  Exchanging v0 and v1 exchanges a and b,
   and leaves x* alone if it lies on the diagonal.  If all the data of the problem are symmetric so
   is the set of minimizing states: of two mirror images one will do, and the prisms wholly on the
   side v1 >= v0 are skipped.  Their mirror images are covered by the prisms that are not.  Thesis:
   consultTree, section 3.4.4. */
static int may_skip(const cv_search *s, const cv_cell *c)
{
    const int k = c->cuts[V0], l = c->cuts[V1];

    if (!s->symmetric)
        return 0;                       /* else: is index1 / 2^l >= (index0 + 1) / 2^k ? */
    return k > l ? c->index[V1] << (k - l) > c->index[V0]
                 : c->index[V1] >= (c->index[V0] + 1) << (l - k);
}

/* ---- the list of prisms */

int room_for_prisms(cv_search *s, int n)
{
    if (s->n_prisms + n > s->allocated) {
        const int allocated = 2 * s->allocated + n + 64;
        prism *const prisms = realloc(s->prisms, (size_t)allocated * sizeof *prisms);
        if (prisms == NULL)
            return CV_ENOMEM;
        s->prisms = prisms;
        s->allocated = allocated;
    }
    return CV_OK;
}

/* Forgets all prisms but the head of the list, for which there is room. */
static void forget_prisms(cv_search *s)
{
    s->prisms[0] = (prism){ .kind = '-' };
    s->n_prisms = 1;
    s->free_prism = 0;
}

/* Puts a prism that is to be tried into the list, after another one. */
static int put_after(cv_search *s, int id, const cv_cell *cell)
{
    const int added = s->free_prism > 0 ? s->free_prism : s->n_prisms++;
    prism *const p = s->prisms;

    if (added == s->free_prism)
        s->free_prism = p[added].next;
    p[added] = (prism){ .cell = *cell, .kind = '?', .next = p[id].next };
    p[id].next = added;
    return added;
}

int take_prisms(cv_search *s, int most, int ids[], cv_cell cells[])
{
    int n = 0;

    for (int id = s->prisms[0].next; id > 0 && n < most; id = s->prisms[id].next) {
        prism *const p = &s->prisms[id];
        if (p->busy || p->kind != '?')
            continue;
        if (may_skip(s, &p->cell)) {
            p->kind = 'S';
        } else {
            p->busy = 1;
            cells[n] = p->cell;
            ids[n++] = id;
        }
    }
    return n;
}

/* Thesis: refinePrism. */
void put_outcome(cv_search *s, int id, const outcome *out)
{
    prism *const p = &s->prisms[id];
    const int axis = out->axis;
    cv_cell upper = p->cell, lower;

    p->outcome = *out;
    p->busy = 0;
    p->kind = out->v.no_tori ? 'P' : 'U';
    if (out->v.no_tori || axis < 0 || !may_halve(s, &p->cell, axis))
        return;
    p->kind = (char)('0' + axis);
    upper.hint = out->hint;
    split_cell(&upper, axis, &lower);
    prism *const last = &s->prisms[put_after(s, id, &upper)];
    last->old = p->old;
    last->old_end = p->old_end;
    p->old_end = p->old;
    put_after(s, id, &lower);
}

/* The last one of all that a prism in the list has become so far. */
static int last_below(const cv_search *s, int id)
{
    for (int open = 1;; id = s->prisms[id].next) {
        open += is_cut(s->prisms[id].kind) ? 1 : -1;
        if (open == 0)
            return id;
    }
}

/* ---- the tree's beginning */

static int room_for_nodes(cv_search *s, size_t n)
{
    if (s->length + n > s->capacity) {
        const size_t capacity = 2 * s->capacity + n + 4096;
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
    return CV_OK;
}

/* Adds a node below that number of cuts to the statistics. */
static void count_node(cv_counts *counts, char kind, int cuts)
{
    counts->cuts += is_cut(kind);
    counts->proved += kind == 'P';
    counts->symmetric += kind == 'S';
    counts->undecided += kind == 'U';
    if (kind == 'P' && cuts > counts->most_cuts)
        counts->most_cuts = cuts;
}

static void append(cv_search *s, char kind, int steps)
{
    s->tree[s->length] = kind;
    s->steps[s->length++] = steps;
}

/* Does the search end at this node?  What is known beyond it does not count. */
static int ends_at(cv_search *s, char kind)
{
    if (kind != 'U' || s->stubborn)
        return 0;
    forget_prisms(s);
    s->status = CV_OK;
    return 1;
}

/* Appends nodes of the tree that was taken up; there is room. */
static void append_old(cv_search *s, size_t begin, size_t end)
{
    for (size_t j = begin; j < end; j++) {
        append(s, s->old[j], OLD);
        if (ends_at(s, s->old[j]))
            break;
    }
}

/* Adds a try to the statistics. */
static void count_try(cv_search *s, const prism *p)
{
    const outcome *const out = &p->outcome;
    const verdict *const v = &out->v;
    cv_counts *const counts = &s->counts;

    counts->quick_tries += out->quick_tries;
    counts->tries += out->tries;
    counts->Rtries += out->Rtries;
    for (int j = 0; j < 3; j++)
        counts->ll_used[j] += out->ll_used[j];
    if (out->steps > counts->max_steps)
        counts->max_steps = out->steps;
    s->points += v->nsteps;
    if (p->kind != 'P') {
        counts->reasons[v->reason]++;
        return;
    }
    if (out->Rtries && v->by_trace)
        counts->HermSuccess++;
    else if (out->Rtries)
        counts->LLSuccess++;
    if (v->nsteps > counts->max_NTsteps)
        counts->max_NTsteps = v->nsteps;
}

/* Appends the first prism of the list, which is known; there is room. */
static void append_first(cv_search *s)
{
    const int id = s->prisms[0].next;
    const prism p = s->prisms[id];
    const int cuts = all_cuts(&p.cell);

    if (p.kind != 'S')
        count_try(s, &p);
    count_node(&s->counts, p.kind, cuts);
    append(s, p.kind, p.kind == 'S' || is_cut(p.kind) ? 0 : p.outcome.v.nsteps);
    if (!is_cut(p.kind))
        s->examined += ldexp(1.0, -cuts);
    s->prisms[0].next = p.next;
    s->prisms[id].next = s->free_prism;
    s->free_prism = id;
    if (!ends_at(s, p.kind))
        append_old(s, p.old, p.old_end);
}

static int is_enough(const cv_search *s)
{
    return decided_leaves(s) >= s->enough || s->points >= s->most_points;
}

void append_known(cv_search *s)
{
    while (s->status == CV_RUNNING && !is_enough(s)) {
        const prism *const first = &s->prisms[s->prisms[0].next];
        if (first->kind == '?')
            return;
        s->needs_long = first->outcome.cut_off && s->precision.longest < 0;
        if (s->needs_long)
            break;
        if (first->kind == '-')
            s->status = CV_OK;          /* nothing is left */
        else if (room_for_nodes(s, 1 + first->old_end - first->old) != CV_OK)
            s->status = CV_ENOMEM;
        else
            append_first(s);
    }
    ask_to_stop(&s->stop, 1);
}

/* ---- what Python gives and gets */

/* Forgets tree and counts, for n prisms that will be put into the list. */
static int forget_tree(cv_search *s, int n)
{
    cv_halt(s);
    if (s->numbers_lost)
        return CV_ENOMEM;
    if (s->stage == SPOILT)
        return CV_EARGUMENT;
    s->n_prisms = 0;
    if (room_for_prisms(s, n + 1) != CV_OK)
        return CV_ENOMEM;
    forget_prisms(s);
    s->length = s->old_length = 0;
    s->needs_long = 0;
    s->points = s->examined = 0.0;
    memset(&s->counts, 0, sizeof s->counts);
    s->status = CV_RUNNING;
    return CV_OK;
}

int cv_restart(cv_search *s, int n, const cv_cell *cells)
{
    const int status = forget_tree(s, n);

    for (int j = n - 1; status == CV_OK && j >= 0; j--)
        put_after(s, 0, &cells[j]);
    return status;
}

/* The leaf of a tree that is taken up; '?': untried. */
static int is_leaf(const cv_search *s, char node, const cv_cell *c)
{
    return node == 'P' || node == 'U' || node == '?' || islower((unsigned char)node) ||
           (node == 'S' && may_skip(s, c));
}

/* Reads the tree, whose text is s->old, and lists the prisms to be tried. */
static int take_up(cv_search *s, const int hints[], int n_hints)
{
    cv_cell pending[MOST_PENDING] = { whole };
    size_t first = s->old_length;       /* the untried prism */
    int n = 1, last = 0;

    s->examined = 1.0;
    for (size_t j = 0; j < s->old_length || n > 0; j++) {
        const char node = j < s->old_length ? s->old[j] : '?';
        if (n == 0)
            return CV_EARGUMENT;
        cv_cell *const c = &pending[n - 1];
        if (last > 0 && node != '?')
            s->prisms[last].old_end = j + 1;
        if (is_cut(node) && s->method->has_axis(&s->problem, node - '0') &&
            may_halve(s, c, node - '0')) {
            pending[n] = *c;
            split_cell(&pending[n - 1], node - '0', &pending[n]);
            n++;
            continue;
        }
        n--;
        if (!is_leaf(s, node, c))
            return CV_EARGUMENT;
        if (node != '?')
            continue;
        if (last == 0 && j < first)
            first = j;
        c->hint = n_hints > 0 ? *hints : 0;
        hints += n_hints > 0;
        n_hints -= n_hints > 0;
        last = put_after(s, last, c);
        s->prisms[last].old = s->prisms[last].old_end = j + 1;
        s->examined -= ldexp(1.0, -all_cuts(c));
    }
    append_old(s, 0, first);
    return CV_OK;
}

int cv_resume(cv_search *s, const char *tree, size_t length, const int *hints, int n_hints)
{
    char *const old = malloc(length + 1);
    int n = MOST_PENDING, status = old == NULL ? CV_ENOMEM : CV_OK;

    for (size_t j = 0; j < length; j++)
        n += tree[j] == '?';
    if (status == CV_OK)
        status = forget_tree(s, n);
    if (status == CV_OK)
        status = room_for_nodes(s, length);
    if (status != CV_OK) {
        free(old);
        return status;
    }
    free(s->old);
    s->old = memcpy(old, tree, length);
    s->old_length = length;
    s->enough = LONG_MAX;
    s->most_points = HUGE_VAL;
    status = take_up(s, hints, n_hints);
    if (status == CV_OK) {
        append_known(s);
    } else {
        forget_prisms(s);
        s->status = status;
    }
    return status;
}

int cv_pending(cv_search *s, cv_cell *cells)
{
    int n = 0;

    pthread_mutex_lock(&s->lock);
    for (int id = s->prisms[0].next; id > 0; id = s->prisms[last_below(s, id)].next) {
        if (cells != NULL)
            cells[n] = s->prisms[id].cell;
        n++;
    }
    pthread_mutex_unlock(&s->lock);
    return n;
}

/* Writes the nodes after the tree's beginning: a '?' with its hint for each prism, though it may be
   known what became of that, and the old nodes between them. */
static size_t write_rest(const cv_search *s, char *tree, int *steps)
{
    size_t n = 0;

    for (int id = s->prisms[0].next, last; id > 0; id = s->prisms[last].next) {
        last = last_below(s, id);
        tree[n] = '?';
        steps[n++] = s->prisms[id].cell.hint;
        for (size_t j = s->prisms[last].old; j < s->prisms[last].old_end; j++) {
            tree[n] = s->old[j];
            steps[n++] = OLD;
        }
    }
    return n;
}

int cv_look(cv_search *s, size_t from, cv_view *view)
{
    int status = CV_OK;

    pthread_mutex_lock(&s->lock);
    *view = (cv_view){ .counts = s->counts,
                       .examined = s->examined,
                       .points = s->points,
                       .length = s->length,
                       .finished = s->status == CV_OK,
                       .needs_long = s->needs_long };
    if (from <= s->length) {
        const size_t n = s->length - from, room = n + (size_t)s->n_prisms + s->old_length;
        view->tree = malloc(room);
        view->steps = malloc(room * sizeof *view->steps);
        if (view->tree == NULL || view->steps == NULL) {
            status = CV_ENOMEM;
        } else if (room > 0) {
            if (n > 0) {                /* else there may be no arrays yet */
                memcpy(view->tree, s->tree + from, n);
                memcpy(view->steps, s->steps + from, n * sizeof *view->steps);
            }
            view->length = n + write_rest(s, view->tree + n, view->steps + n);
        }
    }
    pthread_mutex_unlock(&s->lock);
    if (status != CV_OK)
        cv_forget_view(view);
    return status;
}

void cv_forget_view(cv_view *view)
{
    free(view->tree);
    free(view->steps);
    view->tree = NULL;
    view->steps = NULL;
}

int cv_at_once(const cv_search *s) { return s->at_once; }
void cv_free(char *text) { free(text); }

char *cv_xstar(const cv_search *s, int coordinate)
{
    return apm_get_str(s->problem.xstar[coordinate]);
}

char *cv_constant(const cv_search *s, int which) { return apm_get_str(s->constants[which]); }
