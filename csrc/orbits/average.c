/* average.c - rotation vectors of orbits, by weighted Birkhoff averages, and their points.

   On an invariant torus the weighted mean of a smooth function converges faster than any power of
   the number of points, if the weight is smooth and flat at both ends (Das, Saiki, Sander and
   Yorke, Nonlinearity 30, 4111, 2017).  On a chaotic orbit it converges like a square root.  So the
   means over both halves of an orbit tell how regular it is. */
#ifdef __GNUC__
#define LANES 2 /* orbits side by side: every processor has such vectors */
#endif
#include "arith/lanes.h"
#include "orbits.h"

/* The integer next to |x| < 2^51. */
INLINE vec nearest(vec x)
{
    static const double SHIFT = 0x1.8p52;
    return (x + SHIFT) - SHIFT;
}

/* sin 2 pi t for |t| < 2^51, to about 1e-15: the Taylor polynomial within a quarter turn of 0, its
   terms grouped so that a processor can work on several of them at a time. */
INLINE vec sine_of_turns(vec t)
{
    const vec turn = t - nearest(t), half = pick(TRUTH(turn < 0.0), every(-0.5), every(0.5));
    const vec r = 6.283185307179586 * pick(TRUTH(mag(turn) > 0.25), half - turn, turn);
    const vec z = r * r, z2 = z * z, z4 = z2 * z2;
    const vec a = -1.0 / 6 + z * (1.0 / 120), b = -1.0 / 5040 + z * (1.0 / 362880);
    const vec c = -1.0 / 39916800 + z * (1.0 / 6227020800.0);
    const vec d = -1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0);

    return r + r * z * ((a + z2 * b) + z4 * ((c + z2 * d) - z4 * (1.0 / 121645100408832000.0)));
}

/* One step of the map: p' = p + force(x), x' = x + p' less an integer. */
INLINE void iterate(const cv_waves *v, vec x[2], vec p[2])
{
    vec force[2] = { every(0.0), every(0.0) };

    for (int j = 0; j < v->waves; j++) {
        const double k0 = v->k[2 * j], k1 = v->k[2 * j + 1];
        const vec s = v->size[j] *
                      sine_of_turns((v->n == 2 ? k0 * x[0] + k1 * x[1] : k0 * x[0]) + v->phase[j]);
        force[0] += k0 * s;
        if (v->n == 2)
            force[1] += k1 * s;
    }
    for (int i = 0; i < v->n; i++) {
        p[i] += force[i];
        x[i] += p[i];
        x[i] -= nearest(x[i]);
    }
}

void cv_rotations(const cv_waves *v, const double from[2], long m, const double (*p)[2],
                  long points, const double *weight, double (*means)[2][2])
{
    for (long first = 0; first < m; first += LANES) {
        const int used = m - first < LANES ? (int)(m - first) : LANES;
        vec x[2] = { every(from[0]), every(from[1]) }, momentum[2] = { every(0.0), every(0.0) };
        for (int lane = 0; lane < used; lane++)
            for (int i = 0; i < 2; i++)
                put_at(&momentum[i], lane, p[first + lane][i]);
        for (int half = 0; half < 2; half++) {
            vec sum[2] = { every(0.0), every(0.0) };
            for (long j = 0; j < points; j++) {
                iterate(v, x, momentum);
                for (int i = 0; i < 2; i++)
                    sum[i] += weight[j] * momentum[i];
            }
            for (int lane = 0; lane < used; lane++)
                for (int i = 0; i < 2; i++)
                    means[first + lane][half][i] = at(&sum[i], lane);
        }
    }
}

void cv_lift(const cv_waves *v, const double from[2], const double p[2], long points,
             double (*lift)[2])
{
    vec x[2] = { every(from[0]), every(from[1]) }, momentum[2] = { every(p[0]), every(p[1]) };
    double total[2] = { from[0], from[1] };

    for (long j = 0; j < points; j++) {
        for (int i = 0; i < 2; i++)
            lift[j][i] = total[i];
        iterate(v, x, momentum);
        for (int i = 0; i < 2; i++)
            total[i] += at(&momentum[i], 0);
    }
}
