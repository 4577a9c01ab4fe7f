/* problem.h - the problem that prisms belong to, and the engines that try them. */
#ifndef CONVERSE_PROBLEM_H
#define CONVERSE_PROBLEM_H

#include <assert.h>

#include "arith/sym.h"
#include "arith/turns.h"
#include "loewner.h"

enum { MOST_COLUMNS = ANGLES + PARAMETERS };

enum { ALIGNMENT = 64 };                /* of what engines work in, in bytes: a line of a cache */

/* Tries prisms LANES at a time.  Engines differ in that number and in the instructions they use,
   and in no bit of what they find. */
typedef struct {
    int angles, lanes;
    size_t size;                        /* of what it works in, which begins as zeros */
    /* method.h: try.  For an axis of -1 the cell is too fine for doubles already.
       outcome.hint: orbits of fewer points do not prove the halves as a rule.  cell->hint decides
       at which lengths the orbit is tried, not whether a try that succeeds is right.  Reason
       CV_REASON_ARITHMETIC: the doubles failed. */
    int (*try)(void *work, const loewner *w, int n, const cv_cell *const cells[],
               outcome *const out[]);
    void (*free)(void *work);           /* what it has allocated; not work itself */
} engine;

/* Those of this kind of machine: engine_4_2 tries 4 prisms of two angles at a time. */
#define ENGINES_OF(X, lanes) X(engine_##lanes##_1) X(engine_##lanes##_2) X(engine_##lanes##_3)
#ifdef __x86_64__
#define ENGINES(X) ENGINES_OF(X, 2) ENGINES_OF(X, 4) ENGINES_OF(X, 8)
#else
#define ENGINES(X) ENGINES_OF(X, 2)
#endif
#define DECLARE(name) extern const engine name;
ENGINES(DECLARE)
#undef DECLARE

struct loewner {
    int angles;
    double half[ANGLES], frame[ANGLES][ANGLES], inverse[ANGLES][ANGLES]; /* inverse: |frame^-1| */
    double shift[ANGLES][PARAMETERS];   /* what a parameter adds to their centres where it is 1 */
    struct {                            /* the same in 2^-64 turns, to within one: turns.h */
        int128 centre[ANGLES], half[ANGLES], shift[ANGLES][PARAMETERS];
        int128 amplitude[SLOTS], part[SLOTS][PARAMETERS]; /* in 2^coarse of these */
        uint64_t xstar[ANGLES], frame[ANGLES][ANGLES], k[SLOTS][ANGLES], phase[SLOTS];
    } turns;
    int coarse;                         /* 2^coarse is at least the size of any wave */
    double err_pull;                    /* of what leave_exactly computes, over (1 + S) weights */
    int usable;                         /* do all these numbers fit, and is there a wave? */
    int identity;                       /* is the frame the identity? */
    int mirrored;                       /* is V even about turns.xstar? */
    int longest;                        /* the most points of an orbit */
    int waves;                          /* slots in use; waves.h says what the first are */
    int given[SLOTS];                   /* of the patch's waves */
    double k[SLOTS][ANGLES], phase[SLOTS], square_k[SLOTS], most_k; /* |k|^2, largest |k| */
    double amplitude[SLOTS], part[SLOTS][PARAMETERS]; /* to within a bound: see add_wave */
    double err_amplitude[SLOTS], err_amp; /* of these two; of the force of a cell's centre */
    double axes[ANGLES][ANGLES];        /* |O|: set_axes */
    double turn[MOST_ENTRIES][MOST_ENTRIES]; /* m -> O m O' */
    double onto[SLOTS][ANGLES];         /* of a wave |O_i.k| */
    double xstar_err, corner[8];        /* of each coordinate of x*; bounds B at the corners */
    int n_parameters, columns; /* the symbols: the angles, and the parameters that count */
    int axis[MOST_COLUMNS]; /* of a column: the cell's */
    int moves[SLOTS][MOST_COLUMNS]; /* has the column's parameter a part of the wave? */
    const engine *engine;
    char *memory;
    void *work; /* there, aligned */
};

/* problem.c */

/* Would cutting the cell across axis help? */
int cut_helps(const loewner *w, const cv_cell *cell, int axis);

#endif
