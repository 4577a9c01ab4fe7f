/* stationary.c - see stationary.h. */
#include <math.h>

#include "stationary.h"

enum { STEPS = 200 };
static const double TOLERANCE = 1e-9, MAX_JUMP = 0.5;

double value_of_potential(const waves *v, const double x[2], double g[2], double h[3])
{
    double value = 0.0;

    g[0] = g[1] = h[0] = h[1] = h[2] = 0.0;
    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], y = k0 * x[0] + k1 * x[1] + v->phase[j];
        const double s = v->p[j] * sin(y), c = v->p[j] * cos(y);
        value -= s;
        g[0] -= c * k0;
        g[1] -= c * k1;
        h[0] += s * k0 * k0;
        h[1] += s * k0 * k1;
        h[2] += s * k1 * k1;
    }
    return value;
}

/* beta is mean I + [apart mixed; mixed -apart], so that this is mean - root(apart^2 + mixed^2). */
double least_eigenvalue_of_beta(const waves *v, const double x[2], double g[2], double h[3])
{
    enum { MEAN, APART, MIXED };
    double value[3] = { 2.0, 0.0, 0.0 }, first[3][2] = { { 0.0 } }, second[3][3] = { { 0.0 } };
    double root, along[2];

    for (int j = 0; j < v->n; j++) {
        const double k0 = v->k[j][0], k1 = v->k[j][1], y = k0 * x[0] + k1 * x[1] + v->phase[j];
        const double s = v->p[j] * sin(y), c = v->p[j] * cos(y);
        const double part[3] = { 0.5 * (k0 * k0 + k1 * k1), 0.5 * (k0 * k0 - k1 * k1), k0 * k1 };
        for (int i = 0; i < 3; i++) {
            value[i] -= s * part[i];
            first[i][0] -= c * part[i] * k0;
            first[i][1] -= c * part[i] * k1;
            second[i][0] += s * part[i] * k0 * k0;
            second[i][1] += s * part[i] * k0 * k1;
            second[i][2] += s * part[i] * k1 * k1;
        }
    }
    root = sqrt(value[APART] * value[APART] + value[MIXED] * value[MIXED]);
    for (int m = 0; m < 2; m++) {
        along[m] = (value[APART] * first[APART][m] + value[MIXED] * first[MIXED][m]) / root;
        g[m] = first[MEAN][m] - along[m];
    }
    for (int m = 0, mn = 0; m < 2; m++)
        for (int n = m; n < 2; n++, mn++) {
            const double bend = along[m] * along[n] - first[APART][m] * first[APART][n] -
                                value[APART] * second[APART][mn] -
                                first[MIXED][m] * first[MIXED][n] -
                                value[MIXED] * second[MIXED][mn];
            h[mn] = second[MEAN][mn] + bend / root;
        }
    return value[MEAN] - root;
}

double newton(objective *f, const waves *v, double x[2])
{
    double g[2], h[3], size = 0.0;

    for (int j = 0; j < v->n; j++)
        size += fabs(v->p[j]);
    for (int step = 0; step < STEPS; step++) {
        const double value = f(v, x, g, h), det = h[0] * h[2] - h[1] * h[1];
        double dx, dy, jump;
        if (fabs(g[0]) + fabs(g[1]) <= TOLERANCE * size)
            return value;
        dx = (g[0] * h[2] - g[1] * h[1]) / det;
        dy = (g[1] * h[0] - g[0] * h[1]) / det;
        jump = fabs(dx) + fabs(dy);
        if (!isfinite(jump))
            return HUGE_VAL;
        if (jump > MAX_JUMP) {
            dx *= MAX_JUMP / jump;
            dy *= MAX_JUMP / jump;
        }
        x[0] -= dx;
        x[1] -= dy;
    }
    return HUGE_VAL;
}
