/* threads.c - threads try the first prisms of those that are pending.

   A thread takes as many prisms as its method tries together, tries them without the lock, and
   records what became of them.  The threads run no code but this, and all signals are blocked in
   them, so nobody changes their floating-point settings: each checks these when it begins and when
   it ends. */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>

#include "arith/machine.h"
#include "search/search.h"

struct worker {
    cv_search *s;
    void *work;                         /* the method's */
    pthread_t thread;
    int has_thread, ready;              /* ready: its workspace is set up */
    int n, status, ids[MOST_LANES];     /* prisms at hand */
    cv_cell cells[MOST_LANES];
    outcome outcomes[MOST_LANES];
    worker *next;
};

#ifdef __APPLE__
enum { CLOCK = CLOCK_REALTIME };        /* The conditions of threads know no other there. */
#else
enum { CLOCK = CLOCK_MONOTONIC };
#endif
static const double MOST_SECONDS = 1e6; /* A longer wait is cut to this. */

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Sets up the method's workspace; the first thread also sets up what all need. */
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
            if (s->idle > 0)
                pthread_cond_broadcast(&s->changed);
        } else {
            append_known(s);                 /* The last prisms may have been skipped. */
            if (is_to_stop(&s->stop))
                break;
            s->idle++;
            pthread_cond_wait(&s->changed, &s->lock);
            s->idle--;
        }
    }
}

static void *run(void *data)
{
    worker *const w = data;
    cv_search *const s = w->s;

    pthread_mutex_lock(&s->lock);
    const int first = s->stage == READ && !is_to_stop(&s->stop);
    if (first)
        s->stage = SPOILT;              /* until this thread has set the search up */
    while (s->stage == SPOILT && !first && !is_to_stop(&s->stop))
        pthread_cond_wait(&s->changed, &s->lock);
    if (!machine_is_sound()) {
        s->status = CV_EMACHINE;
    } else if (first || !is_to_stop(&s->stop)) {
        const int ready = w->ready || unlocked(w, begin);
        if (ready && first) {
            s->stage = PREPARED;
            pthread_cond_broadcast(&s->changed);
        }
        if (ready && s->trying)
            grow(w);
        if (!machine_is_sound())
            s->status = CV_EMACHINE;
    }
    ask_to_stop(&s->stop, 1);
    s->active--;
    pthread_cond_broadcast(&s->changed);
    if (s->active == 0)
        pthread_cond_broadcast(&s->ended);
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

/* Lets one thread more begin, with the lock held; CV_ENOMEM: the system allows none. */
static int add_thread(cv_search *s)
{
    worker *w = s->workers;
    sigset_t all, before;
    int failed;

    while (w != NULL && w->has_thread)
        w = w->next;
    if (w == NULL) {
        w = calloc(1, sizeof *w);
        if (w == NULL)
            return CV_ENOMEM;
        w->s = s;
        w->next = s->workers;
        s->workers = w;
    }
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    failed = pthread_create(&w->thread, NULL, run, w);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed)
        return CV_ENOMEM;
    w->has_thread = 1;
    s->active++;
    return CV_OK;
}

int cv_start(cv_search *s, int threads, long max_leaves, double max_points)
{
    int status;

    cv_halt(s);
    if (s->status < CV_OK || s->stage == SPOILT)
        return s->status < CV_OK ? s->status : CV_EARGUMENT;
    for (int id = 0; id < s->n_prisms; id++)
        s->prisms[id].busy = 0;
    s->enough = decided_leaves(s) + max_leaves;
    s->most_points = s->points + max_points;
    s->trying = threads > 0;
    ask_to_stop(&s->stop, 0);
    pthread_mutex_lock(&s->lock);
    do
        status = add_thread(s);         /* Fewer will do. */
    while (status == CV_OK && --threads > 0);
    if (s->active > 0)
        status = CV_OK;
    pthread_mutex_unlock(&s->lock);
    return status;
}

int cv_wait(cv_search *s, double seconds)
{
    const double end = now() + fmin(seconds, MOST_SECONDS), whole = floor(end);
    const struct timespec t = { (time_t)whole, (long)(1e9 * (end - whole)) };

    pthread_mutex_lock(&s->lock);
    while (s->active > 0 && now() < end)
        pthread_cond_timedwait(&s->ended, &s->lock, &t);
    const int working = s->active > 0;
    pthread_mutex_unlock(&s->lock);
    if (working)
        return CV_RUNNING;
    cv_halt(s);
    return s->status < CV_OK ? s->status : CV_OK;
}

void cv_halt(cv_search *s)
{
    ask_to_stop(&s->stop, 1);
    pthread_mutex_lock(&s->lock);
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
    for (worker *w = s->workers; w != NULL; w = w->next)
        if (w->has_thread) {
            pthread_join(w->thread, NULL);
            w->has_thread = 0;
        }
}

void free_workers(cv_search *s)
{
    cv_halt(s);
    while (s->workers != NULL) {
        worker *const w = s->workers;
        s->workers = w->next;
        if (w->work != s->work)
            s->method->free(w->work, s->numbers_lost);
        free(w);
    }
}

int make_lock(cv_search *s)
{
    pthread_condattr_t timed;
    int failed = pthread_condattr_init(&timed);

    if (failed)
        return CV_ENOMEM;
#ifndef __APPLE__
    failed |= pthread_condattr_setclock(&timed, CLOCK);
#endif
    failed |= pthread_mutex_init(&s->lock, NULL) | pthread_cond_init(&s->changed, NULL) |
              pthread_cond_init(&s->ended, &timed);
    pthread_condattr_destroy(&timed);
    return failed ? CV_ENOMEM : CV_OK;
}
