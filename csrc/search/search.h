/* search.h - a search, as its two files see it: tree.c grows it, setup.c makes all ready. */
#ifndef CONVERSE_SEARCH_H
#define CONVERSE_SEARCH_H

#include "loewner/loewner.h"
#include "thesis/unit.h"

/* A prism that was looked at before its turn in preorder comes, method Loewner. */
typedef struct {
    cv_cell cell;
    loewner_outcome outcome;
    int known, skipped;                 /* was it tried, or need not be? */
    int settled;                        /* is all that it was cut into known, too? */
    int halves[2];                      /* of notes, lower and upper; -1: none */
} note;

struct cv_search {
    Runit *exact;                       /* method thesis */
    unit *quick;
    loewner *sharp;                     /* method Loewner */
    patch problem;
    box root, prism;                    /* method thesis: all, and the cell at hand */
    cv_cell *stack;
    int *noted;                         /* of each cell on the stack: its note, or -1 */
    int pending, allocated;             /* cells on the stack; room for */
    note *notes;                        /* those in use and those that are free, in a list */
    int n_notes, allocated_notes, free_note;
    char *tree;
    int *steps;                         /* of the orbit of each leaf */
    size_t length, capacity;
    cv_counts counts, before;           /* before: as it was when the node at hand was begun */
    cv_history history;
    apm_t constants[N_CONSTANTS], t[2];
    int method, dp, depth, stubborn, as_printed, symmetric, at_once;
    int prepared, spoilt, last_steps, status;        /* spoilt: setting up was broken off */
};

#endif
