/* potential.c - the potentials of the thesis's chapter 2, and any finite Fourier sum. */
#include <math.h>

#include "arith/sine.h"
#include "orbits.h"

#define TWO_PI 0x1.921fb54442d18p2

typedef struct { double value, first, second; } jet;    /* of a function of one variable */

static inline double frac(double x) { return x - floor(x); }

/* One Fourier sum.  Every phase is brought to [-1/2, 1/2] before it is multiplied by 2 pi. */
static void fourier(const cv_potential *v, const double x[2], double *value, double gradient[2],
                    double hessian[3])
{
    double sum = 0.0, g0 = 0.0, g1 = 0.0, h00 = 0.0, h01 = 0.0, h11 = 0.0;

    for (int t = 0; t < v->terms; t++) {
        const double k0 = TWO_PI * v->k[2 * t], k1 = TWO_PI * v->k[2 * t + 1];
        const double turns = v->k[2 * t] * x[0] + v->k[2 * t + 1] * x[1];
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
    *value = sum;
    gradient[0] = g0;
    gradient[1] = g1;
    hessian[0] = h00;
    hessian[1] = h01;
    hessian[2] = h11;
}

/* The thesis's V_poly is -4096 f(s) g(t), s = (x0 - 1/2)^2, t = (x1 - 1/2)^2, 0 <= x mod 1 < 1: the
   form in s and t is exactly symmetric and loses nothing near the edges, where V is flat. */
static void poly(const double x[2], double *value, double gradient[2], double hessian[3])
{
    const double y0 = frac(x[0]) - 0.5, y1 = frac(x[1]) - 0.5, s = y0 * y0, t = y1 * y1;
    const double a = 0.25 - s, b = 0.0625 - s, e = 0.25 - t;
    const double fs = -a * (2.0 * b + a), fss = 2.0 * b + 4.0 * a;
    const jet f = { a * a * b, 2.0 * y0 * fs, 2.0 * fs + 4.0 * s * fss };
    const jet g = { e * e, -4.0 * y1 * e, -4.0 * e + 8.0 * t };

    *value = -4096.0 * f.value * g.value;
    gradient[0] = -4096.0 * f.first * g.value;
    gradient[1] = -4096.0 * f.value * g.first;
    hessian[0] = -4096.0 * f.second * g.value;
    hessian[1] = -4096.0 * f.first * g.first;
    hessian[2] = -4096.0 * f.value * g.second;
}

/* c(x), a cubic spline that stands for cos 2 pi x; c(x) = c(1 - x). */
static jet spline(double x)
{
    const double turn = frac(x), sign = turn > 0.5 ? -1.0 : 1.0, y = turn > 0.5 ? 1.0 - turn : turn;
    const jet c = { 1.0 + y * y * (32.0 * y - 24.0), sign * y * (96.0 * y - 48.0),
                    192.0 * y - 48.0 };
    return c;
}

static void fast_froeschle(const double x[2], double *value, double gradient[2], double hessian[3])
{
    const jet c0 = spline(x[0]), c1 = spline(x[1]), c2 = spline(x[0] + x[1]);

    *value = -0.25 * (c0.value + c1.value) - 0.5 * c2.value;
    gradient[0] = -0.25 * c0.first - 0.5 * c2.first;
    gradient[1] = -0.25 * c1.first - 0.5 * c2.first;
    hessian[0] = -0.25 * c0.second - 0.5 * c2.second;
    hessian[1] = -0.5 * c2.second;
    hessian[2] = -0.25 * c1.second - 0.5 * c2.second;
}

void cv_evaluate(const cv_potential *v, long m, const double (*x)[2], double *value,
                 double (*gradient)[2], double (*hessian)[3])
{
    for (long j = 0; j < m; j++) {
        double here, slope[2], bend[3];
        if (v->kind == CV_FOURIER)
            fourier(v, x[j], &here, slope, bend);
        else if (v->kind == CV_POLY)
            poly(x[j], &here, slope, bend);
        else
            fast_froeschle(x[j], &here, slope, bend);
        if (value)
            value[j] = here;
        for (int i = 0; gradient && i < 2; i++)
            gradient[j][i] = slope[i];
        for (int i = 0; hessian && i < 3; i++)
            hessian[j][i] = bend[i];
    }
}
