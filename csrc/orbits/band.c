/* band.c - the Hessian of the action, a cyclic band of blocks beta_j = 2 - eps V''(x_j) with -1
   beside them and in both corners. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "arith/sym.h"
#include "converse.h"
#include "orbits.h"

typedef double mat[2][2];               /* two columns */

static inline double sym2_det(const double d[3]) { return d[0] * d[2] - d[1] * d[1]; }

static inline void sym2_inverse(double r[3], const double d[3])
{
    const double scale = 1.0 / sym2_det(d);

    r[0] = d[2] * scale;
    r[1] = -d[1] * scale;
    r[2] = d[0] * scale;
}

/* The number of negative eigenvalues; 2 if an entry is not a number. */
static inline int sym2_negative(const double d[3])
{
    const double det = sym2_det(d);

    return det > 0.0 ? (d[0] > 0.0 ? 0 : 2) : det <= 0.0 ? 1 : 2;
}

static inline void times(double r[2], const double m[3], const double v[2])
{
    const double v0 = v[0], v1 = v[1];

    r[0] = m[0] * v0 + m[1] * v1;
    r[1] = m[1] * v0 + m[2] * v1;
}

static inline double dot(const double v[2], const double w[2]) { return v[0] * w[0] + v[1] * w[1]; }

typedef struct {
    double inverse[3];
    mat w;
} row;     /* of work: CV_WORK doubles */
_Static_assert(sizeof(row) == CV_WORK * sizeof(double), "CV_WORK");

static const double PIVOT_ROUNDING = 1e-15; /* The rounding of a pivot is about this part of it. */
static const double SETTLED = 1e-13; /* Pivots that change by a smaller part of them repeat. */

/* Makes a pivot invertible: an exactly singular one is moved by about its rounding. */
static void regularize(double d[3])
{
    for (double t = PIVOT_ROUNDING * (fabs(d[0]) + fabs(d[2]) + 1e-5); sym2_det(d) == 0.0;
         t *= 2.0) {
        d[0] += t;
        d[2] += t;
    }
}

/* Eliminates the first q - 1 points by blocks, one after the other.  The pivot of point j is d_j;
   its coupling w_j to the last point goes along: w_{j+1} = d_j^-1 w_j.  Both neighbours of the last
   point couple to it; with q = 2 they are one point, with q = 1 the last point itself.  Returns the
   number of negative eigenvalues of all pivots, which the whole matrix has, by Sylvester's law.
   *log_det, unless it is NULL, is the logarithm of the determinant's modulus. */
static long eliminate(int n, long q, const double (*beta)[3], double mu, row *rows, double last[3],
                      double *log_det)
{
    const mat corner = { { -1.0, 0.0 }, { 0.0, n == 2 ? -1.0 : 0.0 } };
    const double idle = n == 2 ? mu : 0.0; /* an idle coordinate keeps its positive pivots */
    row here = { { 0.0, 0.0, 0.0 }, { { 0.0 } } };
    mat next;
    double total = 0.0;
    long negative = 0;

    memcpy(next, corner, sizeof next);
    memcpy(last, beta[q - 1], sizeof *beta);
    last[0] += mu;
    last[2] += idle;
    if (q == 1) {
        last[0] -= 2.0;
        last[2] -= n == 2 ? 2.0 : 0.0;
    }
    for (long j = 0; j < q - 1; j++) {
        double d[3] = { beta[j][0] + mu, beta[j][1], beta[j][2] + idle };
        for (int i = 0; j > 0 && i < 3; i++)
            d[i] -= here.inverse[i];
        regularize(d);
        negative += sym2_negative(d);
        sym2_inverse(here.inverse, d);
        memcpy(here.w, next, sizeof next);
        for (int k = 0; j == q - 2 && k < 2; k++)
            here.w[k][k] += corner[k][k];
        for (int k = 0; k < 2; k++)
            times(next[k], here.inverse, here.w[k]);
        last[0] -= dot(here.w[0], next[0]);
        last[1] -= dot(here.w[0], next[1]);
        last[2] -= dot(here.w[1], next[1]);
        if (rows)
            rows[j] = here;
        if (log_det)
            total += log(fabs(n == 2 ? sym2_det(d) : d[0]));
    }
    if (log_det)
        *log_det = total + log(fabs(n == 2 ? sym2_det(last) : last[0]));
    return negative + sym2_negative(last);
}

long cv_determinant(int n, long q, const double (*beta)[3], double *log_det)
{
    double last[3];

    return eliminate(n, q, beta, 0.0, NULL, last, log_det);
}

long cv_solve(int n, long q, const double (*beta)[3], double mu, const double (*b)[2],
              double (*u)[2], double *work)
{
    row *const rows = (row *)work;
    double sum[2] = { 0.0, 0.0 }, last[3], inverse[3];
    const long negative = eliminate(n, q, beta, mu, rows, last, NULL);

    if (!rows)
        return negative;
    for (long j = 0; j < q - 1; j++) { /* right-hand sides; u_j = d_j^-1 of them */
        double r[2] = { b[j][0], b[j][1] };
        for (int i = 0; j > 0 && i < 2; i++)
            r[i] += u[j - 1][i];
        times(u[j], rows[j].inverse, r);
        for (int k = 0; k < 2; k++)
            sum[k] += dot(rows[j].w[k], u[j]);
    }
    sum[0] = b[q - 1][0] - sum[0];
    sum[1] = b[q - 1][1] - sum[1];
    sym2_inverse(inverse, last);
    times(u[q - 1], inverse, sum);
    for (long j = q - 2; j >= 0; j--) {
        double r[2];
        for (int i = 0; i < 2; i++) {
            r[i] = -(rows[j].w[0][i] * u[q - 1][0] + rows[j].w[1][i] * u[q - 1][1]);
            if (j < q - 2)
                r[i] += u[j + 1][i];
        }
        times(r, rows[j].inverse, r);
        u[j][0] += r[0];
        u[j][1] += r[1];
    }
    return negative;
}

static const double HELD_PIVOT = 1e100; /* the pivot of a point that cannot move */

long cv_pivots(int n, long q, const double (*beta)[3], long max_rounds, double (*d)[3])
{
    double here[3] = { HELD_PIVOT, 0.0,
                       n == 2 ? HELD_PIVOT : 1.0 }; /* the idle coordinate's stays at one */

    for (long round = 1; round <= max_rounds; round++) {
        double moved = 0.0;
        for (long j = 0; j < q; j++) {
            double next[3], change = 0.0;
            sym_subtract_inverse(2, next, beta[j], here);
            if (sym2_negative(next) != 0)
                return -round;
            for (int i = 0; i < 3; i++)
                change += fabs(next[i] - d[j][i]);
            moved = fmax(moved, change / (next[0] + next[2]));
            memcpy(here, next, sizeof here);
            memcpy(d[j], next, sizeof next);
        }
        if (round > 1 && moved < SETTLED)
            return round;
    }
    return 0;
}
