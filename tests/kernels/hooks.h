/* hooks.h - how the console looks into an engine of csrc/loewner. */
#ifndef HOOKS_H
#define HOOKS_H

#include "loewner/problem.h"

/* What is known of a point.  The columns: x0's five, then x1's. */
typedef struct {
    double x[2], lin[2][COLUMNS], quad[2][PAIRS], rem[2];
    double lin_bound[SLOTS], quad_bound[SLOTS], nonlin_bound[SLOTS], rad[SLOTS];
    double residual[2], force[2], beta[3], d[3], err_beta, mu[2];
} known_point;

typedef struct {
    /* Leaves there, about the points s to t, what no prism would. */
    void (*poison)(void *work, int s, int t);

    /* Follows the root's prism from point s <= 0 to point t >= 0.  0: it cannot be done. */
    int (*follow)(void *work, const loewner *problem, int s, int t);

    /* The bound of the second variation that this orbit gives, with signs of cubic terms or as it
       is, the l it was made with, how much of it roundings are, and the vectors n from the first to
       the last site; their number, 0 without a witness. */
    int (*bound)(void *work, int signs, double *bound, double *l, double *rounding, int *first,
                 double n[][2], int most);

    /* What is known of point n of this orbit.  mu: after bound, and only where it is not zero. */
    void (*look)(const void *work, int n, known_point *p);
} hooks;

#ifdef HAVE_X86
/* clang-format off */
#define ENGINES(X) X(engine_scalar) X(engine_baseline) X(engine_avx2) X(engine_avx512) \
    X(general_scalar) X(general_baseline) X(general_avx2) X(general_avx512)
/* clang-format on */
#elif defined(HAVE_VECTORS)
#define ENGINES(X) X(engine_scalar) X(engine_baseline) X(general_scalar) X(general_baseline)
#else
#define ENGINES(X) X(engine_scalar) X(general_scalar)
#endif

#define DECLARE(engine) extern const hooks hooks_##engine;
ENGINES(DECLARE)
#undef DECLARE

#endif
