/* search.h - a search, as its files see it: setup.c makes all ready, tree.c holds the tree, and
   threads.c lets threads try its prisms. */
#ifndef CONVERSE_SEARCH_H
#define CONVERSE_SEARCH_H

#include <pthread.h>
#include <stddef.h>

#include "arith/guard.h"
#include "search/method.h"

/* A prism that the tree's beginning does not hold yet, or one that is free. */
typedef struct {
    cv_cell cell;
    outcome outcome;
    char kind;                          /* what became of it as in the text, or '?' */
    char busy;                          /* Does a thread try it? */
    int given; /* Did an earlier run grow it?  Then its kind is all that is known. */
    int next;                           /* the next one in preorder, or the next free one */
} prism;

typedef struct worker worker; /* threads.c */

/* The nodes of the tree up to the first one that is not known are its beginning: they stand in
   tree and steps, and only they count.  All prisms after it are in the list that begins with
   prisms[0].next; prisms[0] is its head, and stands for none. */
struct cv_search {
    const method *method;
    void *work; /* the method's, of the first thread */
    precision precision;
    patch problem;
    prism *prisms;
    int n_prisms, allocated, free_prism;
    char *tree;
    int *steps; /* of the orbit of each node */
    size_t length, capacity;
    cv_counts counts;
    double points, examined; /* of all orbits that were followed; share of the volume */
    double most_points;
    long enough; /* leaves */
    apm_t constants[CV_N_CONSTANTS];
    int depth, stubborn, symmetric, at_once, status, needs_long;
    enum { READ, PREPARED, SPOILT } stage; /* SPOILT: the setting up was broken off */
    int numbers_lost; /* memory ran out inside GMP: guard.c */
    worker *workers;
    stop_request stop; /* the threads are to end */
    pthread_mutex_t lock; /* of all that changes above, while threads are active */
    pthread_cond_t changed; /* there may be prisms to try */
};

static inline int all_cuts(const cv_cell *c)
{
    int sum = 0;

    for (int axis = 0; axis < AXES; axis++)
        sum += c->cuts[axis];
    return sum;
}

static inline long decided_leaves(const cv_search *s)
{
    return s->counts.proved + s->counts.symmetric + s->counts.undecided;
}

/* tree.c: room for n prisms more, or CV_ENOMEM; */
int room_for_prisms(cv_search *s, int n);
/* the first prisms to try, at most so many: their number, and which; their cells are copied; */
int take_prisms(cv_search *s, int most, int ids[], cv_cell cells[]);
/* records what became of a prism; there is room for two more; */
void put_outcome(cv_search *s, int id, const outcome *out);
/* appends to the tree's beginning what is known, up to the limits, and sets s->status and s->stop
   if the search has ended. */
void append_known(cv_search *s);

/* threads.c: frees what the threads had. */
void free_workers(cv_search *s);

/* setup.c: sets up what every thread needs, once.  CV_OK or an error. */
int set_up(cv_search *s);

#endif
