/* method.h - what a search asks of a method of proof.  A search knows no more of it than its
   table: csrc/thesis/method.c and csrc/loewner/method.c. */
#ifndef CONVERSE_METHOD_H
#define CONVERSE_METHOD_H

#include "model/patch.h"

enum { AXES = 6, V0 = 0, V1 = 1, T1 = 2, V2 = 5 }; /* of a cell: converse.h */
enum { MOST_LANES = 8 };

/* The outcome of one try of a prism. */
typedef struct {
    int no_tori;                        /* proved (by this arithmetic) */
    int reason;                         /* CV_REASON_... if not */
    int nsteps;                         /* length of the orbit followed */
    int by_trace;                       /* proved by the trace, not by the least eigenvalue */
    int ll_used[3];                     /* how often its best bound was CV_BY_... */
} verdict;

/* The outcome of a cell. */
typedef struct {
    verdict v;                          /* of the last try */
    int axis;           /* to cut the cell across if it is not proved; -1: that would not help */
    int hint;                           /* what its halves are to know: cv_cell */
    int quick_tries, tries, Rtries;     /* stages that were run, 0 or 1 each, for cv_counts */
    int steps, ll_used[3];              /* of the thesis's try in doubles */
    int cut_off;                        /* has the orbit as many points as it may have? */
} outcome;

/* longest: as cv_search_new has it. */
typedef struct { int digits, as_printed, longest; } precision;

typedef struct {
    /* Can problems of this kind be proved, in this way?  CV_OK or CV_EARGUMENT. */
    int (*accepts)(const patch *p, const precision *how);

    /* A starting point from which the proof is short, and the decimal places to which it is
       rounded; quarter_places: those of a multiple of pi/2, if it is one to the others; 0: no more.
       On the diagonal, if it may be, where V is symmetric about it. */
    void (*choose_start)(const patch *p, int symmetric, double x[ANGLES]);
    int start_places, quarter_places;

    int least_digits;       /* the region is converted with at least this number of places */

    /* Sets up the tables of all tries, for a problem with angles in radians and x*.  *work receives
       the workspace, even on failure if something must be freed.  Sets the constants that the
       method has, and at_once (cv_at_once).  CV_OK or an error. */
    int (*prepare)(void **work, const patch *p, const precision *how,
                   apm_t constants[CV_N_CONSTANTS], int *at_once);
    /* A workspace for one thread more, from that of prepare, which other threads may be using.
       *copy receives it, even on failure if something must be freed.  CV_OK or an error. */
    int (*copy)(void **copy, const void *work, const patch *p, const precision *how);
    /* Frees work, which may be NULL.  If numbers_lost, GMP's numbers in it may be broken (guard.c):
       these are abandoned, and all other memory is freed. */
    void (*free)(void *work, int numbers_lost);

    int (*has_axis)(const patch *p, int axis); /* of a cell, that may be cut */
    int (*lanes)(const void *work); /* cells that are best tried together, at most MOST_LANES */

    /* Is it impossible that a minimizing orbit leads from x* to these cells?  The outcome of a cell
       depends on the cell and its hint, and on no other cell.  If a stop is asked for in the
       middle, or if this is CV_ENOMEM and not CV_OK, no outcome is known. */
    int (*try)(void *work, int n, const cv_cell *const cells[], outcome *const out[]);
} method;

extern const method method_thesis, method_loewner;

#endif
