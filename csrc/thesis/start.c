/* start.c - starting points: where the trace, or the least eigenvalue, of beta is least.  Any
   starting point is allowed, a good one makes the proof short; so this is plain double
   precision, and no bound depends on it. */
#include <math.h>

#include "model/stationary.h"
#include "unit.h"

enum { GRID = 24 };
static const double PI = 3.14159265358979323846;

/* ---- what is minimized, of the thesis's three waves, whose amplitudes v->p are a, b and c */

static double trace(const waves *v, const double x[2], double g[2], double h[3])
{
    const double a = v->p[0], b = v->p[1], c2 = 2.0 * v->p[2], z = x[0] + x[1];

    g[0] = -a * cos(x[0]) - c2 * cos(z);
    g[1] = -b * cos(x[1]) - c2 * cos(z);
    h[0] = a * sin(x[0]) + c2 * sin(z);
    h[1] = c2 * sin(z);
    h[2] = b * sin(x[1]) + c2 * sin(z);
    return 4.0 - a * sin(x[0]) - b * sin(x[1]) - c2 * sin(z);
}

/* Twice the least eigenvalue of beta, that is, its trace less the root of
   D = (a sin x - b sin y)^2 + (2c sin(x + y))^2. */
static double twice_least_eigenvalue(const waves *v, const double x[2], double g[2], double h[3])
{
    const double as = v->p[0] * sin(x[0]), ac = v->p[0] * cos(x[0]);
    const double bs = v->p[1] * sin(x[1]), bc = v->p[1] * cos(x[1]);
    const double cs = 2.0 * v->p[2] * sin(x[0] + x[1]), cc = 2.0 * v->p[2] * cos(x[0] + x[1]);
    const double dif = as - bs, D = dif * dif + cs * cs, root = sqrt(D);
    const double Dx = dif * ac + cs * cc, Dy = -dif * bc + cs * cc;     /* half the gradient */
    const double Dxx = ac * ac - dif * as + cc * cc - cs * cs;          /* half the Hessian */
    const double Dxy = -ac * bc + cc * cc - cs * cs;
    const double Dyy = bc * bc + dif * bs + cc * cc - cs * cs;

    g[0] = -ac - cc - Dx / root;
    g[1] = -bc - cc - Dy / root;
    h[0] = as + cs - Dxx / root + Dx * Dx / (D * root);
    h[1] = cs - Dxy / root + Dx * Dy / (D * root);
    h[2] = bs + cs - Dyy / root + Dy * Dy / (D * root);
    return 4.0 - as - bs - cs - root;
}

/* x = a place where f is least: where Newton's method leads from (pi/2, pi/2), as in 1989, or
   from the best point of a grid if that is better, or that point itself.  On the diagonal if
   asked for, so that symmetry can be used. */
static void find_start(objective *f, double x[2], const double abc[3], int on_diagonal)
{
    static const int k[3][2] = { { 1, 0 }, { 0, 1 }, { 1, 1 } };
    static const double phase[3] = { 0.0, 0.0, 0.0 };
    const waves v = { 3, k, phase, abc };
    double best[2] = { PI / 2, PI / 2 }, g[2], h[3], least = HUGE_VAL, value;

    x[0] = x[1] = PI / 2;
    value = newton(f, &v, x);
    for (int i = 0; i < GRID; i++)
        for (int j = on_diagonal ? i : 0; j < (on_diagonal ? i + 1 : GRID); j++) {
            const double y[2] = { 2 * PI * (i + 0.5) / GRID, 2 * PI * (j + 0.5) / GRID };
            const double at_y = f(&v, y, g, h);
            if (at_y < least) {
                least = at_y;
                best[0] = y[0];
                best[1] = y[1];
            }
        }
    if (!(value <= least)) {
        x[0] = best[0];
        x[1] = best[1];
        if (!(newton(f, &v, x) <= least)) {
            x[0] = best[0];
            x[1] = best[1];
        }
    }
    if (on_diagonal)
        x[1] = x[0];
}

void set_Herm_start(double x[2], const double abc[3], int on_diagonal)
{
    find_start(trace, x, abc, on_diagonal);
}

void set_LL_start(double x[2], const double abc[3], int on_diagonal)
{
    find_start(twice_least_eigenvalue, x, abc, on_diagonal);
}
