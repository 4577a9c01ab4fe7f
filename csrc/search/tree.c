/* tree.c - the tree of prisms (thesis, Appendix C, main).

   A prism that fails is replaced by its two halves, the first of which comes next.  So the tree
   of all prisms is met in preorder, and one character per node is the whole of the proof.  The
   outcome of a prism depends on itself and on what its parent learnt (cv_cell's hint), and on no
   other prism.  So threads may try the first prisms of those that are pending in any order and
   company (threads.c).  A prism counts only when all before it are known: limits, statistics and
   the end at an undecided prism are those of a search that tries one prism after the other. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "search/search.h"

static int is_cut(char kind) { return kind >= '0' && kind < '0' + AXES; }

static int may_halve(const cv_search *s, const cv_cell *c, int axis)
{
    return all_cuts(c) < s->depth && c->cuts[axis] < CV_INDEX_BITS;
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

/* Puts a prism into the list, after another one. */
static int put_after(cv_search *s, int id, const cv_cell *cell, char kind)
{
    const int added = s->free_prism > 0 ? s->free_prism : s->n_prisms++;
    prism *const p = s->prisms;

    if (added == s->free_prism)
        s->free_prism = p[added].next;
    p[added] = (prism){ .cell = *cell, .kind = kind, .next = p[id].next };
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
    put_after(s, id, &upper, '?');
    put_after(s, id, &lower, '?');
}

/* The last one of all that a prism in the list has become so far. */
static int last_below(const cv_search *s, int id)
{
    for (int open = 1; !s->prisms[id].given; id = s->prisms[id].next) {
        open += is_cut(s->prisms[id].kind) ? 1 : -1;
        if (open == 0)
            break;
    }
    return id;
}

/* ---- the tree's beginning */

static int room_for_a_node(cv_search *s)
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
    const int cuts = all_cuts(&p.cell), tried = !p.given && p.kind != 'S';

    if (tried)
        count_try(s, &p);
    if (!p.given) {
        count_node(&s->counts, p.kind, cuts);
        s->examined += is_cut(p.kind) ? 0.0 : ldexp(1.0, -cuts);
    }
    s->tree[s->length] = p.kind;
    s->steps[s->length++] = tried && !is_cut(p.kind) ? p.outcome.v.nsteps : 0;
    s->prisms[0].next = p.next;
    s->prisms[id].next = s->free_prism;
    s->free_prism = id;
    if (p.kind == 'U' && !s->stubborn)
        forget_prisms(s);               /* the end: what is known beyond it does not count */
}

/* Appends the first prisms that an earlier run grew.  Then there is room for one more, or 0: no
   memory. */
static int append_given(cv_search *s)
{
    while (room_for_a_node(s) == CV_OK) {
        if (!s->prisms[s->prisms[0].next].given)
            return 1;
        append_first(s);
    }
    return 0;
}

static int is_enough(const cv_search *s)
{
    return decided_leaves(s) >= s->enough || s->points >= s->most_points;
}

void append_known(cv_search *s)
{
    while (s->status == CV_RUNNING) {
        if (!append_given(s)) {
            s->status = CV_ENOMEM;
            break;
        }
        const prism *const first = &s->prisms[s->prisms[0].next];
        if (first->kind == '-')
            s->status = CV_OK;          /* nothing is left */
        if (first->kind == '-' || is_enough(s))
            break;
        if (first->kind == '?')
            return;
        s->needs_long = first->outcome.cut_off && s->precision.longest < 0;
        if (s->needs_long)
            break;
        append_first(s);
    }
    ask_to_stop(&s->stop, 1);
}

/* ---- what Python gives and gets */

int cv_restart(cv_search *s, const char *text, const cv_cell *cells)
{
    static const cv_cell none;

    if (s->numbers_lost || room_for_prisms(s, 1) != CV_OK)
        return CV_ENOMEM;
    if (s->stage == SPOILT)
        return CV_EARGUMENT;
    forget_prisms(s);
    s->length = 0;
    s->needs_long = 0;
    s->points = 0.0;
    s->examined = 1.0;
    memset(&s->counts, 0, sizeof s->counts);
    s->status = CV_RUNNING;
    for (int last = 0; *text != '\0'; text++) {
        const int given = *text != '?';
        if (!append_given(s) || room_for_prisms(s, 1) != CV_OK)
            return CV_ENOMEM;
        last = put_after(s, s->prisms[0].next == 0 ? 0 : last, given ? &none : cells, *text);
        s->prisms[last].given = given;
        s->examined -= given ? 0.0 : ldexp(1.0, -all_cuts(cells++));
        if (*text == 'U' && !s->stubborn)
            break;                      /* What follows does not count. */
    }
    if (!append_given(s))
        return CV_ENOMEM;
    if (s->prisms[0].next == 0)
        s->status = CV_OK;
    return CV_OK;
}

int cv_look(cv_search *s, int whole, cv_view *view)
{
    int status = CV_OK;

    pthread_mutex_lock(&s->lock);
    *view = (cv_view){ .counts = s->counts,
                       .examined = s->examined,
                       .points = s->points,
                       .finished = s->status == CV_OK,
                       .needs_long = s->needs_long };
    if (whole) {
        const size_t most = s->length + (size_t)s->n_prisms;
        view->tree = malloc(most);
        view->steps = calloc(most, sizeof *view->steps);
        view->cells = malloc((size_t)s->n_prisms * sizeof *view->cells);
        if (view->tree == NULL || view->steps == NULL || view->cells == NULL) {
            status = CV_ENOMEM;
        } else {
            memcpy(view->tree, s->tree, s->length);
            memcpy(view->steps, s->steps, s->length * sizeof *view->steps);
            view->length = s->length;
            for (int id = s->prisms[0].next; id > 0; id = s->prisms[last_below(s, id)].next) {
                const prism *const p = &s->prisms[id];
                view->tree[view->length++] = p->given ? p->kind : '?';
                if (!p->given)
                    view->cells[view->n_cells++] = p->cell;
            }
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
    free(view->cells);
    *view = (cv_view){ .length = 0 };
}

int cv_has_axis(const cv_search *s, int axis) { return s->method->has_axis(&s->problem, axis); }
int cv_skips(const cv_search *s) { return s->symmetric; }
int cv_at_once(const cv_search *s) { return s->at_once; }
void cv_free(char *text) { free(text); }

char *cv_xstar(const cv_search *s, int coordinate)
{
    return apm_get_str(s->problem.xstar[coordinate]);
}

char *cv_constant(const cv_search *s, int which) { return apm_get_str(s->constants[which]); }
