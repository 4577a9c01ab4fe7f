/* start.c - starting points: where the trace, or the least eigenvalue, of beta is least.  Any
   starting point is allowed, a good one makes the proof short; so this is plain double
   precision, and no bound depends on it. */
#include <math.h>

#include "model/stationary.h"
#include "unit.h"

enum { GRID = 24 };
static const double PI = 3.14159265358979323846;

/* x = a place where f is least: where Newton's method leads from (pi/2, pi/2), as in 1989, or
   from the best point of a grid if that is better, or that point itself.  On the diagonal if
   asked for, so that symmetry can be used.  p: the amplitudes of the thesis's three waves. */
static void find_start(objective *f, double x[2], const double p[3], int on_diagonal)
{
    static const int k[3][3] = { { 1, 0 }, { 0, 1 }, { 1, 1 } };
    static const double phase[3] = { 0.0, 0.0, 0.0 };
    const waves v = { 2, 3, k, phase, p };
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

/* The trace of beta is 4 plus the potential whose amplitudes are multiplied by |k|^2. */
void set_Herm_start(double x[2], const double abc[3], int on_diagonal)
{
    const double p[3] = { abc[0], abc[1], 2.0 * abc[2] };

    find_start(value_of_potential, x, p, on_diagonal);
}

void set_LL_start(double x[2], const double abc[3], int on_diagonal)
{
    find_start(least_eigenvalue_of_beta, x, abc, on_diagonal);
}
