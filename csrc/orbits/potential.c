/* potential.c - a finite Fourier sum, or a potential that Python computes. */
#include <math.h>

#include "arith/sine.h"
#include "orbits.h"

#define TWO_PI 0x1.921fb54442d18p2

/* Python defines this function for the potentials that are no Fourier sums. */
void cv_python_evaluate(void *potential, long m, const double (*x)[2], double *value,
                        double (*gradient)[2], double (*hessian)[3]);

/* Every phase is brought to [-1/2, 1/2] before it is multiplied by 2 pi. */
void cv_evaluate(const cv_potential *v, long m, const double (*x)[2], double *value,
                 double (*gradient)[2], double (*hessian)[3])
{
    if (v->python) {
        cv_python_evaluate(v->python, m, x, value, gradient, hessian);
        return;
    }
    for (long j = 0; j < m; j++) {
        double sum = 0.0, g0 = 0.0, g1 = 0.0, h00 = 0.0, h01 = 0.0, h11 = 0.0;
        for (int t = 0; t < v->terms; t++) {
            const double k0 = TWO_PI * v->k[2 * t], k1 = TWO_PI * v->k[2 * t + 1];
            const double turns = v->k[2 * t] * x[j][0] + v->k[2 * t + 1] * x[j][1];
            double s, c, here, slope;
            double_sincos(&s, &c, TWO_PI * (turns - floor(turns + 0.5)));
            here = v->cosine[t] * c + v->sine[t] * s;
            slope = v->sine[t] * c - v->cosine[t] * s;
            sum += here;
            g0 += k0 * slope;
            g1 += k1 * slope;
            h00 -= k0 * k0 * here;
            h01 -= k0 * k1 * here;
            h11 -= k1 * k1 * here;
        }
        value[j] = sum;
        gradient[j][0] = g0;
        gradient[j][1] = g1;
        hessian[j][0] = h00;
        hessian[j][1] = h01;
        hessian[j][2] = h11;
    }
}
