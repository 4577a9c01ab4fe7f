/* search.h - a search, as its files see it: setup.c makes all ready, tree.c grows the tree, and
   lookahead.c tries prisms, some of them before their turn. */
#ifndef CONVERSE_SEARCH_H
#define CONVERSE_SEARCH_H

#include <stddef.h>

#include "search/method.h"

enum { INDEX_BITS = 61 };               /* cuts along one axis that a cell's index can hold */

/* A prism that was looked at, perhaps before its turn in preorder comes. */
typedef struct {
    cv_cell cell;
    outcome outcome;
    int known, skipped;                 /* was it tried, or need not be? */
    int settled;                        /* is all that it was cut into known, too? */
    int halves[2];                      /* of notes, lower and upper; -1: none */
} note;

/* A prism that is to be decided, and its note, or -1. */
typedef struct {
    cv_cell cell;
    int note;
} untested;

struct cv_search {
    const method *method;
    void *work;                         /* the method's */
    precision precision;
    patch problem;
    untested *stack;
    int pending, allocated;             /* prisms on the stack; room for */
    note *notes;                        /* those in use and those that are free, in a list */
    int n_notes, allocated_notes, free_note;
    char *tree;
    int *steps;                         /* of the orbit of each leaf */
    size_t length, capacity;
    cv_counts counts, before;           /* before: as it was when the node at hand was begun */
    double points;                      /* of all orbits that were followed since cv_restart */
    apm_t constants[CV_N_CONSTANTS];
    int depth, stubborn, symmetric, at_once, last_steps, status;
    enum { READ, PREPARED, SPOILT } stage;      /* SPOILT: cv_prepare was broken off */
    int numbers_lost;                   /* memory ran out inside GMP: guard.c */
};

static inline int all_cuts(const cv_cell *c)
{
    return c->cuts[0] + c->cuts[1] + c->cuts[2] + c->cuts[3] + c->cuts[4];
}

/* The cell becomes the upper of its halves across axis. */
static inline void split_cell(cv_cell *upper, int axis, cv_cell *lower)
{
    upper->cuts[axis]++;
    upper->index[axis] *= 2;
    *lower = *upper;
    upper->index[axis]++;
}

/* tree.c: may the cell be cut again across axis; may it be skipped, since its mirror image will do?
 */
int may_halve(const cv_search *s, const cv_cell *c, int axis);
int may_skip(const cv_search *s, const cv_cell *c);

/* lookahead.c: room for the notes of a step, or CV_ENOMEM; what is known of the cell on top of the
   stack, which is tried if need be, or NULL if memory is short; and when it had its turn
   the note is no longer needed. */
int make_room_for_notes(cv_search *s);
const note *note_on_top(cv_search *s);
void forget_note(cv_search *s, const note *n);
void forget_all_notes(cv_search *s);

#endif
