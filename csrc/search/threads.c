/* threads.c - threads try the first prisms of those that are pending.

   A thread takes as many prisms as its method tries together, tries them without the lock, and
   records what became of them.  Python makes the threads, which run no code but this meanwhile.  So
   nobody changes their floating-point settings: each checks these when it begins and when it ends.
 */
#include <stdlib.h>

#include "arith/machine.h"
#include "search/search.h"

struct worker {
    cv_search *s;
    void *work;                         /* the method's */
    int busy, ready;                    /* Has a thread it?  Is the method's workspace set up? */
    int n, status, ids[MOST_LANES];     /* prisms at hand */
    cv_cell cells[MOST_LANES];
    outcome outcomes[MOST_LANES];
    worker *next;
};

/* Sets up the method's workspace; the first one also what all need. */
static void begin(void *data)
{
    worker *const w = data;
    cv_search *const s = w->s;

    if (s->stage != PREPARED) {
        w->status = set_up(s);
        w->work = s->work;
    } else {
        s->method->free(w->work, 0);    /* of a setting up that was broken off */
        w->work = NULL;
        w->status = s->method->copy(&w->work, s->work, &s->problem, &s->precision);
    }
    w->ready = w->status == CV_OK;
}

static void try_prisms(void *data)
{
    worker *const w = data;
    const cv_cell *cells[MOST_LANES];
    outcome *out[MOST_LANES];

    for (int k = 0; k < w->n; k++) {
        cells[k] = &w->cells[k];
        out[k] = &w->outcomes[k];
    }
    w->status = w->s->method->try(w->work, w->n, cells, out);
}

/* Calls what() without the lock.  Returns whether it came to its end and all is well; if a stop is
   the reason that it did not, the search may go on later. */
static int unlocked(worker *w, void (*what)(void *))
{
    cv_search *const s = w->s;

    pthread_mutex_unlock(&s->lock);
    w->status = CV_OK;
    const int ended = guard_run(what, w, &s->stop);
    pthread_mutex_lock(&s->lock);
    s->numbers_lost |= ended == GUARD_MEMORY;
    if (ended == GUARD_MEMORY)
        w->status = CV_ENOMEM;
    if (w->status < CV_OK && s->status == CV_RUNNING) {
        s->status = w->status;
        ask_to_stop(&s->stop, 1);
    }
    return ended == GUARD_DONE && w->status >= CV_OK;
}

/* Records what became of the prisms at hand, if the tree still has them. */
static void record(worker *w, int known)
{
    cv_search *const s = w->s;

    if (s->status != CV_RUNNING)
        return;
    if (known && room_for_prisms(s, 2 * w->n) != CV_OK) {
        s->status = CV_ENOMEM;
        ask_to_stop(&s->stop, 1);
        known = 0;
    }
    for (int k = 0; k < w->n; k++)
        if (known)
            put_outcome(s, w->ids[k], &w->outcomes[k]);
        else
            s->prisms[w->ids[k]].busy = 0;
    append_known(s);
}

static void grow(worker *w)
{
    cv_search *const s = w->s;
    const int lanes = s->method->lanes(w->work);

    while (s->status == CV_RUNNING && !is_to_stop(&s->stop)) {
        w->n = take_prisms(s, lanes, w->ids, w->cells);
        if (w->n > 0) {
            record(w, unlocked(w, try_prisms));
            pthread_cond_broadcast(&s->changed);
        } else {
            append_known(s);                 /* The last prisms may have been skipped. */
            if (is_to_stop(&s->stop))
                break;
            pthread_cond_wait(&s->changed, &s->lock);
        }
    }
}

/* A workspace that no thread has, or a new one; NULL: no memory.  The first is cv_set_up's. */
static worker *free_worker(cv_search *s)
{
    worker *w = s->workers;

    while (w != NULL && w->busy)
        w = w->next;
    if (w == NULL && (w = calloc(1, sizeof *w)) != NULL) {
        w->s = s;
        w->next = s->workers;
        s->workers = w;
    }
    return w;
}

/* Sets the search up, or decides prisms, in this thread. */
static int run(cv_search *s, void (*what)(worker *w))
{
    int status = CV_ENOMEM;

    pthread_mutex_lock(&s->lock);
    worker *const w = free_worker(s);
    if (w != NULL) {
        const int sound = machine_is_sound();
        w->busy = 1;
        if (sound)
            what(w);
        w->busy = 0;
        if (!sound || !machine_is_sound())
            s->status = CV_EMACHINE;
        pthread_cond_broadcast(&s->changed);
        status = s->status < CV_OK ? s->status : CV_OK;
    }
    pthread_mutex_unlock(&s->lock);
    return status;
}

static void set_up_first(worker *w)
{
    w->s->stage = SPOILT;               /* until it is set up */
    if (unlocked(w, begin))
        w->s->stage = PREPARED;
}

static void work(worker *w)
{
    if (w->ready || unlocked(w, begin))
        grow(w);
    ask_to_stop(&w->s->stop, 1);        /* The others are to end, too. */
}

int cv_begin(cv_search *s, long max_leaves, double max_points)
{
    if (s->status < CV_OK || s->stage == SPOILT)
        return s->status < CV_OK ? s->status : CV_EARGUMENT;
    for (int id = 0; id < s->n_prisms; id++)
        s->prisms[id].busy = 0;
    s->enough = decided_leaves(s) + max_leaves;
    s->most_points = s->points + max_points;
    ask_to_stop(&s->stop, 0);
    return CV_OK;
}

int cv_set_up(cv_search *s) { return s->stage == READ ? run(s, set_up_first) : CV_OK; }

int cv_work(cv_search *s) { return s->stage == PREPARED ? run(s, work) : CV_EARGUMENT; }

void cv_halt(cv_search *s)
{
    ask_to_stop(&s->stop, 1);
    pthread_mutex_lock(&s->lock);
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void free_workers(cv_search *s)
{
    while (s->workers != NULL) {
        worker *const w = s->workers;
        s->workers = w->next;
        if (w->work != s->work)
            s->method->free(w->work, s->numbers_lost);
        free(w);
    }
}
