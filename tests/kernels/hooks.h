/* hooks.h - how the console looks into an engine of csrc/loewner. */
#ifndef HOOKS_H
#define HOOKS_H

#include "loewner/problem.h"

enum { MOST_PAIRS = MOST_COLUMNS * (MOST_COLUMNS + 1) / 2 };

/* What is known of a point.  x: the upper halves of its angles, in 2^-32 turns; x_low: the lower
   ones, in 2^-64.  lin, quad: of each angle; columns in the order of a cell's axes. */
typedef struct {
    double x[ANGLES], x_low[ANGLES], lin[ANGLES][MOST_COLUMNS], quad[ANGLES][MOST_PAIRS];
    double rem[ANGLES];
    double lin_bound[SLOTS], quad_bound[SLOTS], nonlin_bound[SLOTS], rad[SLOTS];
    double residual[ANGLES], force[ANGLES], beta[MOST_ENTRIES], d[MOST_ENTRIES], err_beta;
    double mu[ANGLES];
} known_point;

typedef struct {
    /* Leaves there, about the points s to t, what no prism would. */
    void (*poison)(void *work, const loewner *problem, int s, int t);

    /* Follows the root's prism from point s <= 0 to point t >= 0.  0: it cannot be done. */
    int (*follow)(void *work, const loewner *problem, int s, int t);

    /* The bound of the second variation that this orbit gives, with signs of cubic terms or as it
       is, the l it was made with, how much of it roundings are, and the vectors n from the first to
       the last site; their number, 0 without a witness. */
    int (*bound)(void *work, int signs, double *bound, double *l, double *rounding, int *first,
                 double n[][ANGLES], int most);

    /* What is known of point n of this orbit.  mu: after bound, and only where it is not zero. */
    void (*look)(const void *work, int n, known_point *p);

    /* turns_sincos: sine and cosine in 2^-62; the double next to the sine, and what that lacks; and
       fine_sine, high and low. */
    void (*sincos)(uint64_t turns, int64_t *sine, int64_t *cosine, double y[]);

    /* exact_pull of the last wave at an angle of x0, with n and mu: high, low, p and p_low. */
    void (*pull)(void *work, const loewner *problem, uint64_t turns, const double n_mu[4],
                 double y[4]);

    /* n times x, in the blocks of bound.c. */
    double (*sum)(int n, double x);
} hooks;

#define DECLARE(engine) extern const hooks hooks_##engine;
ENGINES(DECLARE)
#undef DECLARE

#endif
