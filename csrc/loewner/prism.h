/* prism.h - what the files of this room share: the prism at hand and the orbits that start in it.

   The criterion (docs/proof.md has all of this file's mathematics, step by step).  Orbits on an
   invariant Lagrangian graph minimize, so their second variation
   Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1] is not negative for any square-summable n
   (Katok; MacKay, Meiss and Stark, Nonlinearity 2, 1989).  With B >= the largest eigenvalue of beta
   over the torus, l + 1/l >= B, 0 < l < 1, and n decaying outwards by l from its ends s and t, the
   two tails add at most -l |n[s]|^2 and -l |n[t]|^2.  So there is no torus if for some s, t and n

       Q = sum n[j].beta(x[j])n[j] - 2 sum n[j].n[j+1] - l (|n[s]|^2 + |n[t]|^2) < 0.           (1)

   A prism is a set of orbits: x[0] = x*, x[1] in a rectangle, the parameters on a segment or in a
   box.  orbit.c follows it, witness.c chooses n for the orbit of its centre, bound.c bounds (1) for
   that n over all of it, and try.c does one after the other until it is proved or hopeless.

   Rounding.  All numbers are doubles rounded to nearest (unit u = 2^-53).  n, mu, x, L and d are
   what they are: any values make a valid proof.  Only the bounds are to be trusted: sums of
   positive terms, widened in the end by more than their roundings, and the few sums with signs,
   whose roundings are bounded by the sums of absolute values.  These margins are relative, but a
   product below 2^-1022 loses up to 2^-1075 whatever its size.  So what a bound rests on is never
   that small: each step misses 2^-49 or more, weights count TINY more than they are, determinants
   are above TINY, and a bound of (1) counts only if the terms it sums have a mass of 1 or more. */
#ifndef CONVERSE_PRISM_H
#define CONVERSE_PRISM_H

#include <math.h>

#include "loewner.h"

enum { WAVES = 3, COLUMNS = 5, PAIRS = 15, MAX_POINTS = 4000, ORIGIN = MAX_POINTS };

/* One point of the orbit of the prism's centre, and all that is known of its neighbours. */
typedef struct {
    double x[2], turns[2];              /* x modulo 2 pi; turns taken off when it was reached */
    double missed[2];                   /* by the step from here: a bound of |E| at the centre */
    double column[2][COLUMNS];          /* L: v0, v1, then the parameters that move */
    double bow[2][PAIRS];               /* T: the coefficients of e_k e_l, at pair(k, l) */
    double rest[2], force[2];           /* r and f: bounds */
    double d[3];                        /* the factor: d00, d01, d11 */
    double sine[WAVES], cosine[WAVES];
    double straight[WAVES], bowed[WAVES];       /* of D0, D1, D0 + D1: |L e| and |T[e, e]| */
    double off[WAVES], reach[WAVES];    /* |D - L e| and |D| */
    double beta[3];                     /* beta00, beta01, beta11 */
    double far;                         /* how large a rounded angle is */
    double fuzz;                        /* how far p sin, p cos and entries of beta may be off */
    double n[2], mu[2], gradient[2];
    double A[WAVES], B[WAVES];          /* what Q makes of cos z and sin z */
    double left[3], right[3];           /* the blocks of the recursion from either end */
} point;

struct loewner {
    /* the problem */
    double centre[COLUMNS], half[COLUMNS], slack[COLUMNS];      /* v0, v1, a, b, c */
    double xstar[2], xstar_err[2], corner[8];                   /* bounds B at the corners */
    int together, columns;              /* the symbols: v0, v1, and the parameters that move */
    int axis[COLUMNS], symbol[WAVES];   /* of a column: the cell's; of a wave: the column */
    /* the prism at hand */
    double p[WAVES], h[WAVES], loose[WAVES];    /* p +- h moves with its symbol, loose by itself */
    double v[2], width[2], l;
    /* what bound.c finds */
    double slope[COLUMNS], square[PAIRS], cubic[COLUMNS][PAIRS];        /* Q's part with signs */
    double bound, rounding, share[COLUMNS];
    int first, last;                    /* of the orbit's points */
    int from, to, until;                /* n is zero before from and after to; until: see witness */
    point orbit[2 * MAX_POINTS + 1];
};

/* For what is made once for each number of columns, so that its loops have constant ends. */
#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

static const double TINY = 0x1p-800;

static inline double square(double x) { return x * x; }
/* NaN if either is. */
static inline double larger(double x, double y) { return x > y || isnan(x) ? x : y; }

/* The place of e_k e_l among the products of the symbols, row by row with k <= l. */
static inline int pair(int columns, int k, int l)
{
    return k <= l ? k * (2 * columns - k - 1) / 2 + l : l * (2 * columns - l - 1) / 2 + k;
}

/* What a wave feels, of x0, x1 along the coordinates. */
static inline double felt(int wave, double x0, double x1)
{
    return wave == 0 ? x0 : wave == 1 ? x1 : x0 + x1;
}

/* |p| + h + loose */
static inline double size(const loewner *w, int wave)
{
    return fabs(w->p[wave]) + w->h[wave] + w->loose[wave];
}

/* orbit.c */

/* The two points that the prism gives. */
void orbit_begin(loewner *w);
/* One more point, after the last or before the first.  0: the factor cannot go on. */
int orbit_step(loewner *w, int ahead);
/* One more point, at the end that is better known.  0: that end is known too badly, or the orbit is
   too long; why says which. */
int orbit_lengthen(loewner *w, int *why);

/* witness.c */

/* The least eigenvalue of a symmetric matrix, and a unit eigenvector. */
double least_eigenvector(const double d[3], double n[2]);
/* Chooses from, to and n on the orbit so that (1) is negative at the centre.  0: it never is. */
int witness(loewner *w);

/* bound.c */

/* w->bound >= (1) over the whole prism, whatever n is; w->rounding: how much of it roundings are.
   The cubic terms are bounded by absolute values unless their signs might make the bound negative,
   or are asked for.  Needs a witness. */
void bound_second_variation(loewner *w, int signs);
/* w->share[k] after that: how much of the bound each column is to blame for. */
void bound_shares(loewner *w);

#endif
