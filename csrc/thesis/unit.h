/* unit.h - what the search sees of the two instances of the algorithms. */
#ifndef CONVERSE_UNIT_H
#define CONVERSE_UNIT_H

#include "search/method.h"

/* A prism of the list: {parameters} x {x*} x {possible successors}.  Order: a, b, c, v0, v1. */
typedef struct {
    apm_t centre[5], half[5];
    apm_t xstar[2];
    int n_cuts;
} box;

#define DECLARE_UNIT(R)                                                                            \
    typedef struct R##unit R##unit;                                                                \
    R##unit *R##unit_new(long dp, int as_printed);              /* NULL: no memory */              \
    void R##unit_free(R##unit *u);                                                                 \
    /* Sets the constants, to the given ones or, with NULL, to computed ones, and the first    \
       block of the second variation.  herman_start serves as_printed.  CV_OK or an error. */   \
    int R##prepare_trial(R##unit *u, const box *root, const double herman_start[2],                \
                         apm_t constants[CV_N_CONSTANTS]);                                         \
    int R##unit_constants(R##unit *u, apm_t constants[CV_N_CONSTANTS]);    /* CV_OK or an error */ \
    void R##try_prism(R##unit *u, const box *b, verdict *v);

DECLARE_UNIT(R)
DECLARE_UNIT()

/* quick_try: may the centre's orbit, in double precision, be a minimizing one?  (follow.inc,
   in the double instance only) */
void quick_try(unit *u, const box *b, verdict *v);

/* start.c: where the trace, and where the least eigenvalue of beta attains its minimum, roughly.
   Nothing rigorous depends on the result. */
void set_Herm_start(double x[2], const double abc[3], int on_diagonal);
void set_LL_start(double x[2], const double abc[3], int on_diagonal);

#endif
