/* prism.h - what the files of an engine share: the prisms at hand and the orbits that start in
   them, one in each lane.  The first slots of waves are the coordinates themselves: see waves.h.

   The criterion (docs/proofs/argument.md has all of this file's mathematics).  Orbits on an
   invariant Lagrangian graph minimize, so their second variation
   Q(n) = sum of n[j].beta(x[j])n[j] - 2 n[j].n[j+1] is not negative for any square-summable n
   (Katok; MacKay, Meiss and Stark, Nonlinearity 2, 1989).  With B >= the largest eigenvalue of beta
   over the torus, l + 1/l >= B, 0 < l < 1, and n decaying outwards by l from its ends s and t, the
   two tails add at most -l |n[s]|^2 and -l |n[t]|^2.  So there is no torus if for some s, t and n

       Q = sum n[j].beta(x[j])n[j] - 2 sum n[j].n[j+1] - l (|n[s]|^2 + |n[t]|^2) < 0.           (1)

   A prism is a set of orbits: x[0] = x*, x[1] in a box, which may move with the parameters,
   the amplitudes on an affine image of the parameters' box.  orbit.c follows it, witness.c chooses
   n for the orbit of its centre, bound.c bounds (1) for that n over all of it, and try.c does one
   after the other until it is proved or hopeless.

   Lanes.  A vec has a number of each of the prisms at hand, and all of them go through the same
   operations; where their orbits differ in length, masks say which lanes are active.  No
   lane looks at another: what becomes of a prism does not depend on its company.

   Rounding.  All numbers are doubles rounded to nearest (unit u = 2^-53).  Any values of n,
   mu, x, L and d make a valid proof.  Only the bounds are to be trusted: sums of
   positive terms, widened in the end by more than their roundings, and the few sums with signs,
   whose roundings are bounded by the sums of absolute values.  These margins are relative, but a
   product below 2^-1022 loses up to 2^-1075 whatever its size.  So what a bound rests on is never
   that small: each step misses 2^-59 or more, weights count TINY more than they are, determinants
   are above TINY, and a bound of (1) counts only if the terms it sums have a mass of 1 or more. */
#ifndef CONVERSE_PRISM_H
#define CONVERSE_PRISM_H

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>

#include "arith/sym.h"
#include "problem.h"

/* N is the number of angles.  Of a symmetric matrix there are ENTRIES: sym.h. */
enum { FIRST = N, COLUMNS = N + PARAMETERS, PAIRS = COLUMNS * (COLUMNS + 1) / 2 };
enum { ENTRIES = N * (N + 1) / 2 };

#define FOR_WAVES(w, j) for (int j = FIRST; j < waves_of(w); j++)
enum { ORIGIN = 2 * MAX_POINTS };       /* the site of x*: those of all points are positive */

/* Room for points is allocated at most 16 times: for 64 first, then twice as many each time. */
enum { FIRST_ROOM = 64, MAX_DOUBLINGS = 16 };

/* One point of the orbits of the prisms' centres, and all that is known of its neighbours. */
typedef struct {
    /* As many as there are columns, pairs of them and slots: room.c lays them out. */
    vec (*lin)[N]; /* L: columns of the angles, then of parameters that move */
    vec (*quad)[N]; /* T: the coefficients of e_k e_l, at sym_at(k, l) */
    vec *sine, *cosine;
    vec *lin_bound, *quad_bound; /* of D along a wave: |L e| and |T[e, e]| */
    vec *nonlin_bound, *rad; /* |D - L e| and |D| */
    vec *err_dot; /* roundings of L e and T[e, e] along a wave; slots from FIRST */
    vec *rest_A[2], *rest_B, *cube_A, *cube_B; /* see weigh */
    mask x[N], push[N]; /* in 2^-64 turns: the point, and what its waves add */
    vec rem[N], force[N]; /* bounds of r and f along the axes of the problem */
    vec d[ENTRIES]; /* the factor in these axes */
    vec rad_max; /* the largest rad of a wave, by their weights */
    vec beta[ENTRIES];
    vec least; /* eigenvalue of beta, about */
    vec err_beta; /* how far p sin, p cos and entries of beta may be off */
    vec n[N], mu[N], load; /* load: see weigh */
    vec left[ENTRIES], right[ENTRIES]; /* the blocks of the recursion from either end */
    mask reached; /* can the orbit go on to here? */
} point;

typedef struct {
    const loewner *problem;
    vec p_low[SLOTS]; /* what p lacks of the centre's amplitude */
    vec p[SLOTS], part[SLOTS][COLUMNS]; /* part[k] moves with the column k of a parameter */
    vec h[SLOTS], err_amp[SLOTS]; /* h: the sum of |part|; err_amp: rounding */
    vec weight[SLOTS]; /* of the rad along a wave: see weigh_waves */
    vec size[SLOTS]; /* |p| + h + err_amp */
    mask force[SLOTS], backward[SLOTS]; /* |p| in 2^(coarse - 65) turns; is p negative? */
    vec residual[N]; /* of any step of the centre: a bound of |E| */
    mask x1[N]; /* in 2^-64 turns */
    vec width[N], shift[N][COLUMNS], l; /* shift[i][k]: of v_i with column k >= N */
    /* what bound.c finds */
    vec slope[COLUMNS], square[PAIRS], cubic[COLUMNS][PAIRS]; /* Q's part with signs */
    vec bound, rounding, share[COLUMNS];
    int known_first, known_last; /* the points that were computed */
    int weighed_first, weighed_last; /* the points that bound.c has seen */
    int first[LANES], last[LANES]; /* the points of the orbits */
    double end_rad[LANES][2]; /* how widely these are known: first, last */
    mask from, to, since, until; /* n is zero before from and after to; all: see witness */
    point *points; /* of the sites lowest, lowest + 1, ..., room of them */
    int lowest, room, doublings;
    char *memory, *vectors[MAX_DOUBLINGS]; /* what they lie in: room.c */
    int out_of_memory;
} batch;

INLINE point *site_of(const batch *w, int site)
{
    assert(w->lowest <= site && site < w->lowest + w->room);
    return w->points + (site - w->lowest);
}

static const double TINY = 0x1p-800;

/* Is this the site of x*, and V even about it?  Then no sites before it are used, and half of (1)
   is bounded, to which half of this site's own terms belongs: docs/proofs/argument.md, Lemma 8a. */
INLINE int is_mirror(const batch *w, int site) { return w->problem->mirrored && site == ORIGIN; }

/* Adds, for each column, what the wave's amplitude moves with its symbol, times a factor. */
INLINE void add_moves(const batch *w, int wave, vec factor, vec to[])
{
    for (int k = N; k < w->problem->columns; k++)
        if (w->problem->moves[wave][k])
            to[k] += w->part[wave][k] * factor;
}

#endif
