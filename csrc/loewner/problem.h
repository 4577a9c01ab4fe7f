/* problem.h - the problem that prisms belong to, and the engines that try them. */
#ifndef CONVERSE_PROBLEM_H
#define CONVERSE_PROBLEM_H

#include <assert.h>

#include "arith/turns.h"
#include "loewner.h"

enum { COLUMNS = 5, PAIRS = 15 };
enum { FIRST = 2 };                     /* the first slot that is a wave: see waves.h */

enum { ALIGNMENT = 64 };                /* of what engines work in, in bytes: a line of a cache */

/* Tries prisms LANES at a time.  Engines differ in that number and in the instructions they use,
   and in no bit of what they find. */
typedef struct {
    int lanes;
    size_t size;                        /* of what it works in, which begins as zeros */
    /* method.h: try.  For an axis of -1 the cell is too fine for doubles already.
       outcome.hint: orbits of fewer points do not prove the halves as a rule.  cell->hint decides
       at which lengths the orbit is tried, not whether a try that succeeds is right.  Reason
       CV_REASON_ARITHMETIC: the doubles failed. */
    int (*try)(void *work, const loewner *w, int n, const cv_cell *const cells[],
               outcome *const out[]);
    void (*free)(void *work);           /* what it has allocated; not work itself */
} engine;

extern const engine engine_2, engine_4, engine_8;

struct loewner {
    double half[2], err_v[2], frame[2][2]; /* of v0, v1 */
    double shift[2][PARAMETERS];        /* what a parameter adds to their centres where it is 1 */
    struct {                            /* the same in 2^-64 turns, to within one: turns.h */
        int128 centre[2], half[2], shift[2][PARAMETERS];
        int128 amplitude[SLOTS], part[SLOTS][PARAMETERS]; /* in 2^coarse of these */
        uint64_t xstar[2], frame[2][2], k[SLOTS][2], phase[SLOTS];
    } turns;
    int coarse;                         /* 2^coarse is at least the size of any wave */
    double err_pull;                    /* of what leave_exactly computes, over (1 + S) weights */
    int usable;                         /* do all these numbers fit, and is there a wave? */
    int identity;                       /* is the frame the identity? */
    int length, given[SLOTS];           /* |q|^2 of straighten, or 1; of the patch's waves */
    int longest;                        /* the most points of an orbit */
    double seen[2][2];                  /* coordinates that waves are given in: see straighten */
    int waves;                          /* slots in use; waves.h says what the first two are */
    double k[SLOTS][2], phase[SLOTS], square_k[SLOTS], most_k; /* (|k0| + |k1|)^2, largest sum */
    double amplitude[SLOTS], part[SLOTS][PARAMETERS]; /* to within a bound: see add_wave */
    double err_amplitude[SLOTS], err_amp; /* of these two; of the force of a cell's centre */
    double axes[2][2];                  /* R, rows k and k_perp of the largest wave: set_axes */
    double turn[4];                     /* k0^2, k0 k1, k1^2, k0^2 - k1^2, over |k|^2 */
    double onto[2][SLOTS], along[SLOTS][2]; /* of a wave |R_i.k|, and that over |R_i|^2 */
    double xstar_err[2], corner[8];     /* of x*; bounds B at the corners */
    int n_parameters, columns;          /* the symbols: v0, v1, and the parameters that count */
    int axis[COLUMNS];                  /* of a column: the cell's */
    int moves[SLOTS][COLUMNS];          /* has the column's parameter a part of the wave? */
    const engine *engine;
    char *memory;
    void *work;                         /* there, aligned */
};

/* The place of e_k e_l among the products of the symbols, row by row with k <= l. */
static inline int pair(int columns, int k, int l)
{
    assert(0 <= k && k < columns && 0 <= l && l < columns);
    return k <= l ? k * (2 * columns - k - 1) / 2 + l : l * (2 * columns - l - 1) / 2 + k;
}

/* problem.c */

/* Would cutting the cell across axis help? */
int cut_helps(const loewner *w, const cv_cell *cell, int axis);

#endif
