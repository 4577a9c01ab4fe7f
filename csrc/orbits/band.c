/* band.c - the Hessian of the action, a cyclic band of blocks beta_j = 2 - eps V''(x_j) with -1
   beside them and in both corners. */
#include <math.h>
#include <stddef.h>

#include "converse.h"
#include "orbits/band.h"

typedef struct { double v[2][2]; } mat;         /* two columns */

static inline void times(double r[2], sym m, const double v[2])
{
    const double v0 = v[0], v1 = v[1];
    r[0] = m.a * v0 + m.b * v1;
    r[1] = m.b * v0 + m.c * v1;
}

static inline double dot(const double v[2], const double w[2]) { return v[0] * w[0] + v[1] * w[1]; }

typedef struct {
    sym inverse;
    mat w;
} row;     /* of work: CV_WORK doubles */
_Static_assert(sizeof(row) == CV_WORK * sizeof(double), "CV_WORK");

/* A pivot by which can be divided: one that is singular to the last bit is moved by rounding. */
static sym regular(sym d)
{
    for (double t = 1e-15 * (fabs(d.a) + fabs(d.c)) + 1e-20; sym_det(d) == 0.0; t *= 2.0) {
        d.a += t;
        d.c += t;
    }
    return d;
}

/* Block elimination of the first q - 1 points, one after the other, leaves d_j of point j; w_j, its
   coupling to the last point, goes along: w_{j+1} = d_j^-1 w_j.  Both neighbours of the last point
   couple to it, and with q = 2 they are one, with q = 1 itself.  The eigenvalues below zero of all
   the pivots together are as many as those of the whole (Sylvester), and are returned; log, unless
   it is NULL, is that of the modulus of the determinant. */
static long eliminate(int n, long q, const double (*beta)[3], double mu, row *rows, sym *last,
                      double *log_det)
{
    const mat corner = { { { -1.0, 0.0 }, { 0.0, n == 2 ? -1.0 : 0.0 } } };
    const double idle = n == 2 ? mu : 0.0;      /* an idle coordinate keeps its positive pivots */
    row here = { { 0.0, 0.0, 0.0 }, corner };
    mat next = corner;
    double total = 0.0;
    long negative = 0;

    *last = sym_of(beta[q - 1]);
    last->a += mu;
    last->c += idle;
    if (q == 1) {
        last->a -= 2.0;
        last->c -= n == 2 ? 2.0 : 0.0;
    }
    for (long j = 0; j < q - 1; j++) {
        sym d = sym_of(beta[j]);
        d.a += mu;
        d.c += idle;
        if (j > 0)
            d = sym_sub(d, here.inverse);
        d = regular(d);
        negative += sym_negative(d);
        here.inverse = sym_inverse(d);
        here.w = next;
        for (int k = 0; j == q - 2 && k < 2; k++)
            here.w.v[k][k] += corner.v[k][k];
        for (int k = 0; k < 2; k++)
            times(next.v[k], here.inverse, here.w.v[k]);
        last->a -= dot(here.w.v[0], next.v[0]);
        last->b -= dot(here.w.v[0], next.v[1]);
        last->c -= dot(here.w.v[1], next.v[1]);
        if (rows)
            rows[j] = here;
        if (log_det)
            total += log(fabs(n == 2 ? sym_det(d) : d.a));
    }
    if (log_det)
        *log_det = total + log(fabs(n == 2 ? sym_det(*last) : last->a));
    return negative + sym_negative(*last);
}

long cv_determinant(int n, long q, const double (*beta)[3], double *log_det)
{
    sym last;
    return eliminate(n, q, beta, 0.0, NULL, &last, log_det);
}

long cv_solve(int n, long q, const double (*beta)[3], double mu, const double (*b)[2],
              double (*u)[2], double *work)
{
    row *const rows = (row *)work;
    double sum[2] = { 0.0, 0.0 };
    sym last;
    const long negative = eliminate(n, q, beta, mu, rows, &last, NULL);

    if (!rows)
        return negative;
    for (long j = 0; j < q - 1; j++) {              /* right-hand sides; u_j = d_j^-1 of them */
        double r[2] = { b[j][0], b[j][1] };
        for (int i = 0; j > 0 && i < 2; i++)
            r[i] += u[j - 1][i];
        times(u[j], rows[j].inverse, r);
        for (int k = 0; k < 2; k++)
            sum[k] += dot(rows[j].w.v[k], u[j]);
    }
    sum[0] = b[q - 1][0] - sum[0];
    sum[1] = b[q - 1][1] - sum[1];
    times(u[q - 1], sym_inverse(last), sum);
    for (long j = q - 2; j >= 0; j--) {
        double r[2];
        for (int i = 0; i < 2; i++) {
            r[i] = -(rows[j].w.v[0][i] * u[q - 1][0] + rows[j].w.v[1][i] * u[q - 1][1]);
            if (j < q - 2)
                r[i] += u[j + 1][i];
        }
        times(r, rows[j].inverse, r);
        u[j][0] += r[0];
        u[j][1] += r[1];
    }
    return negative;
}

static const double HELD = 1e100;       /* the pivot of a point that cannot move */

long cv_pivots(int n, long q, const double (*beta)[3], long max_rounds, double (*d)[3])
{
    sym here = { HELD, 0.0, n == 2 ? HELD : 1.0 };      /* the idle coordinate's stays at one */

    for (long round = 1; round <= max_rounds; round++) {
        double moved = 0.0;
        for (long j = 0; j < q; j++) {
            here = sym_sub(sym_of(beta[j]), sym_inverse(here));
            if (sym_negative(here) != 0)
                return -round;
            moved = fmax(
                moved, (fabs(here.a - d[j][0]) + fabs(here.b - d[j][1]) + fabs(here.c - d[j][2])) /
                           (here.a + here.c));
            d[j][0] = here.a;
            d[j][1] = here.b;
            d[j][2] = here.c;
        }
        if (round > 1 && moved < 1e-13)
            return round;
    }
    return 0;
}
