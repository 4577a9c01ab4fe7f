/* problem.c - what belongs to all prisms of a problem, and the engine that is to try them. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "arith/sine.h"
#include "arith/special.h"
#include "arith/sym2.h"
#include "problem.h"
#include "model/torus.h"

/* Numbers of turns are less than 10^ORDER < 2^BITS units of 2^-64 turns: see times_middle. */
enum { ORDER = 24, BITS = 80 };
enum { SCALE_DIGITS = 60 }; /* decimal places of units per radian: see units_of_radian */
static const double MAX_AMPLITUDE = 0x1p60; /* of a wave: see wave_at */

/* ---- one prism */

/* B >= the largest eigenvalue over the torus for all parameters of the cell.  It is convex in the
   parameters, so along each edge of the root it lies below the straight line between the ends, and
   so below the product of these lines, which over a cell is largest at a corner.  The shares are
   exact, their products and the sum of 8 are off by 10 u, of which 2^-46 is 128. */
static double cell_largest(const loewner *w, const double low[3], const double high[3])
{
    const int axes = w->n_parameters;
    double largest = 0.0;

    for (int corner = 0; corner < 1 << axes; corner++) {
        double sum = 0.0;
        for (int root = 0; root < 1 << axes; root++) {
            double part = w->corner[root];
            for (int k = 0; k < axes; k++) {
                const double share = corner >> k & 1 ? high[k] : low[k]; /* 0 .. 1 */
                part *= root >> k & 1 ? share : 1.0 - share;
            }
            sum += part;
        }
        largest = larger(largest, sum);
    }
    return largest * (1.0 + 0x1p-46);
}

/* x times the place of a cell's middle along an axis, (2 index + 1) 2^-cuts - 1, less a number in
   [0, 1).  |x| < 2^BITS and cuts <= CV_MAX_CUTS: the product with the upper part of x has 98 bits
   at most, that with its lower bits 82. */
static int128 times_middle(int128 x, const cv_cell *cell, int axis)
{
    const int cuts = cell->cuts[axis], lower = cuts < 32 ? cuts : 32;
    const int64_t cells = INT64_C(1) << cuts, middle = 2 * (int64_t)cell->index[axis] + 1 - cells;
    const int128 rest = x & ((INT64_C(1) << lower) - 1);

    assert(-((int128)1 << BITS) < x && x < (int128)1 << BITS && cuts <= CV_MAX_CUTS);
    assert(-cells < middle && middle < cells);
    return ((x >> lower) * middle + (rest * middle >> lower)) >> (cuts - lower);
}

/* The region: centre, shifts and widths of a cell's slice.  The centre is off by 1 unit of 2^-64
   turns for that of the root, by 1 for its half and 1 for what times_middle cuts off, and by 2 for
   each shift, by 9 at most: err_v.  The doubles near half and the shifts are off by 8 u of
   themselves (near), products with powers of two by nothing.  The columns frame width and frame
   shift round by 3 u of their absolute values at most, but for the identity: `off` has 8, and what
   it makes of v by the inverse of the frame is added to the widths, too. */
static void set_region(const loewner *w, const cv_cell *cell, const double part[], loewner_cell *c)
{
    const double det = fabs(w->frame[0][0] * w->frame[1][1] - w->frame[0][1] * w->frame[1][0]);
    double off[2] = { 0.0, 0.0 }, size[2];
    uint64_t v[2];

    for (int i = 0; i < 2; i++) {
        v[i] = (uint64_t)w->turns.centre[i] + (uint64_t)times_middle(w->turns.half[i], cell, i);
        size[i] = w->half[i] * part[i];
        for (int m = 0; m < w->n_parameters; m++) {
            v[i] += (uint64_t)times_middle(w->turns.shift[i][m], cell, 2 + m);
            c->shift[i][m] = w->shift[i][m] * part[2 + m];
            size[i] += fabs(c->shift[i][m]);
        }
        c->width[i] = w->half[i] * part[i] + w->err_v[i] + 0x1p-49 * size[i];
        size[i] += w->err_v[i];
    }
    for (int i = 0; i < 2; i++) {
        c->x1[i] = w->turns.frame[i][0] * v[0] + w->turns.frame[i][1] * v[1];
        for (int k = 0; k < 2 && !w->identity; k++)
            off[i] += 0x1p-50 * fabs(w->frame[i][k]) * size[k];
    }
    for (int i = 0; i < 2 && !w->identity; i++) /* |frame^-1| off */
        c->width[i] +=
            (fabs(w->frame[1 - i][1 - i]) * off[i] + fabs(w->frame[i][1 - i]) * off[1 - i]) / det;
}

/* The waves.  A cell's amplitude is off by 7 units at most, as its centre is above, which err_amp
   has; its parts are off by 10 u of themselves (near, straighten), and the double p by 3 u of its
   own. */
static void set_amplitudes(const loewner *w, const cv_cell *cell, const double part[],
                           loewner_cell *c)
{
    const double unit = ldexp(TURN_UNIT, w->coarse);

    for (int i = FIRST; i < w->waves; i++) {
        int128 force = w->turns.amplitude[i];
        double size = 0.0;
        for (int m = 0; m < w->n_parameters; m++) {
            force += times_middle(w->turns.part[i][m], cell, 2 + m);
            c->part[i][m] = w->part[i][m] * part[2 + m];
            size += fabs(c->part[i][m]);
        }
        assert(-((int128)1 << 62) < force && force < (int128)1 << 62);
        c->force[i] = (int64_t)force;
        const double high = (double)c->force[i], low = (double)(c->force[i] - (int64_t)high);
        c->p[i] = high * unit;
        c->p_low[i] =
            fma(high, unit, -c->p[i]) + (low * unit + high * ldexp(TURN_UNIT_LOW, w->coarse));
        c->err_amp[i] = w->err_amp + 0x1p-49 * size;
    }
}

int loewner_prism(const loewner *w, const cv_cell *cell, loewner_cell *c)
{
    double part[COLUMNS], low[3], high[3], B;

    memset(c, 0, sizeof *c);
    if (!w->usable)
        return 0;
    for (int k = 0; k < COLUMNS; k++) {
        if (cell->cuts[k] > CV_MAX_CUTS)
            return 0;
        part[k] = ldexp(1.0, -cell->cuts[k]);
    }
    set_region(w, cell, part, c);
    set_amplitudes(w, cell, part, c);
    for (int m = 0; m < w->n_parameters; m++) { /* exact */
        low[m] = (double)cell->index[2 + m] * part[2 + m];
        high[m] = low[m] + part[2 + m];
    }
    B = cell_largest(w, low, high);
    c->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46); /* off by 5 u before */
    return c->l > 0.0;
}

/* Not where what is off makes four fifths of its width or more. */
int cut_helps(const loewner *w, const cv_cell *cell, int axis)
{
    int wide = axis < 2 && ldexp(w->half[axis], 2 - cell->cuts[axis]) > w->err_v[axis];

    for (int i = 0; i < w->waves && axis >= 2; i++)
        wide = wide || ldexp(fabs(w->part[i][axis - 2]), 2 - cell->cuts[axis]) > w->err_amp;
    for (int i = 0; i < 2 && axis >= 2; i++)
        wide = wide || ldexp(fabs(w->shift[i][axis - 2]), 2 - cell->cuts[axis]) > w->err_v[i];
    return wide && cell->cuts[axis] < CV_MAX_CUTS;
}

/* ---- the problem */

/* A double d with |d - x| <= 2^-50 |x|, or else NaN, with which nothing is proved. */
static double near(const apm_t x)
{
    const double d = apm_nearest_d(x);
    apm_t error, scaled;
    int good;

    if (!isfinite(d))
        return NAN;
    apm_init(error);
    apm_init(scaled);
    apm_set_d(error, d);
    apm_sub(error, error, x);
    apm_set_d(scaled, 0x1p50);
    apm_mul(error, error, scaled);
    apm_abs(error, error);
    apm_abs(scaled, x);
    good = apm_cmp(error, scaled) <= 0;
    apm_clear(error);
    apm_clear(scaled);
    return good ? d : NAN;
}

/* The engine with the most lanes that this machine can use.  The environment variable
   CONVERSE_LANES limits that number, as tests compare the engines. */
static const engine *fastest_engine(void)
{
#ifdef __x86_64__
    const char *const limit = getenv("CONVERSE_LANES");
    const long lanes = limit == NULL ? MOST_LANES : strtol(limit, NULL, 10);

    if (lanes >= 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        return &engine_8;
    if (lanes >= 4 && __builtin_cpu_supports("avx2"))
        return &engine_4;
#endif
    return &engine_2;
}

/* ---- numbers in turns */

/* How many units of 2^-64 turns a radian has, 2^63/pi < 10^19, to SCALE_DIGITS places.
   So a number below 2^BITS units is off by less than 10^-30 of them. */
static void units_of_radian(apm_t scale)
{
    apm_t pi;

    apm_init(pi);
    apm_pi(pi, SCALE_DIGITS + 20);
    apm_set_d(scale, 0x1p63);
    apm_div(scale, scale, pi, SCALE_DIGITS, APM_DOWN);
    apm_clear(pi);
}

/* The whole number next to x scale 2^-coarse, which is off by less than 1.  If it is 2^BITS or
   more the problem is not usable. */
static int128 whole(loewner *w, const apm_t x, const apm_t scale, int coarse)
{
    uint64_t words[2] = { 0, 0 };
    apm_t number, power;
    mpz_t z;

    apm_init(number);
    apm_init(power);
    mpz_init(z);
    apm_set_d(power, ldexp(1.0, -coarse));
    apm_mul(number, x, scale);
    apm_mul(number, number, power);
    apm_set_d(power, 0.5);
    apm_add(number, number, power);
    apm_floor(number, number);
    assert(number->exp >= 0);
    if (apm_order(number) <= ORDER) {
        mpz_ui_pow_ui(z, 10, (unsigned long)number->exp);
        mpz_mul(z, z, number->mant);
        assert(mpz_sizeinbase(z, 2) <= BITS);
        mpz_export(words, NULL, -1, sizeof *words, 0, 0, z);
    } else {
        w->usable = 0;
    }
    const int negative = mpz_sgn(z) < 0;
    const int128 r = (int128)words[1] << 64 | words[0];
    apm_clear(number);
    apm_clear(power);
    mpz_clear(z);
    return negative ? -r : r;
}

/* An integer as a factor of turns. */
static uint64_t factor_of(double k) { return (uint64_t)(int64_t)k; }

/* The angles, and x*.  err_v is the 9 units of set_region, and the errors of the radians, since
   links of other points end at a prism's sides.  Pi has 30 places at least (least_digits), and
   numbers of 10^ORDER units are below 2^17 pi.  So the errors of an axis's five numbers, and the
   sum of them in half (region_to_radians), are below 10^-23 radians, 10^-4 of a unit. */
static void set_angles(loewner *w, const patch *problem, const apm_t scale)
{
    w->n_parameters = problem->n_parameters;
    w->identity = is_identity(problem);
    for (int i = 0; i < 2; i++) {
        w->turns.centre[i] = whole(w, problem->angle[i], scale, 0);
        w->turns.half[i] = whole(w, problem->half[i], scale, 0);
        w->half[i] = near(problem->half[i]);
        for (int m = 0; m < w->n_parameters; m++) {
            w->turns.shift[i][m] = whole(w, problem->shift[i][m], scale, 0);
            w->shift[i][m] = near(problem->shift[i][m]);
        }
        w->err_v[i] = 16.0 * TURN_UNIT;
        w->turns.xstar[i] = (uint64_t)whole(w, problem->xstar[i], scale, 0);
        w->xstar_err[i] = 2.0 * TURN_UNIT;
        for (int k = 0; k < 2; k++) {
            w->frame[i][k] = problem->frame[i][k];
            w->turns.frame[i][k] = factor_of(w->frame[i][k]);
        }
    }
    w->seen[0][0] = w->seen[1][1] = 1.0;
}

/* |amplitude| + sum of |part|: no amplitude of the wave is larger in size. */
static double size_of(const loewner *w, int i)
{
    double size = fabs(w->amplitude[i]);

    for (int m = 0; m < w->n_parameters; m++)
        size += fabs(w->part[i][m]);
    return size;
}

/* The numbers of one wave: amplitude, parts, phase and k.  Amplitude and parts are off by 8 u of
   themselves (near), by two more if they are straightened, and their sum at a corner by 3 u: 13 u
   of their sizes, where err_amplitude has 32. */
static void read_wave(loewner *w, const patch *problem, int given, int i)
{
    w->given[i] = given;
    w->amplitude[i] = near(problem->amplitude[given]);
    for (int m = 0; m < w->n_parameters; m++)
        w->part[i][m] = near(problem->part[given][m]);
    w->err_amplitude[i] = 0x1p-48 * size_of(w, i);
    w->phase[i] = near(problem->phase[given]);
    for (int j = 0; j < 2; j++)
        w->k[i][j] = problem->k[given][j];
    w->square_k[i] = square(fabs(w->k[i][0]) + fabs(w->k[i][1]));
}

/* The columns of the parameters that move a wave or the region: the others need no symbol. */
static void set_columns(loewner *w)
{
    w->columns = 2;
    w->axis[1] = 1;
    for (int m = 0; m < w->n_parameters; m++) {
        int counts = w->shift[0][m] != 0.0 || w->shift[1][m] != 0.0;
        for (int i = FIRST; i < w->waves; i++) {
            w->moves[i][w->columns] = w->part[i][m] != 0.0;
            counts |= w->moves[i][w->columns];
        }
        if (counts)
            w->axis[w->columns++] = 2 + m;
    }
}

/* The slots of the coordinates, and of the waves whose amplitude is not 0 for all parameters. */
static void set_wave_slots(loewner *w, const patch *problem)
{
    w->most_k = 1.0;
    w->k[0][0] = w->k[1][1] = 1.0;
    w->waves = FIRST;
    for (int given = 0; given < problem->n_waves; given++) {
        const int i = w->waves;
        read_wave(w, problem, given, i);
        if (size_of(w, i) != 0.0) {
            w->most_k = larger(w->most_k, fabs(w->k[i][0]) + fabs(w->k[i][1]));
            w->waves++;
        }
    }
    set_columns(w);
}

/* Where all waves are m q, q primitive, s = q.x moves by itself: s' = 2s - s(o) + |q|^2 sum m p cos
   y, and vectors n = q nu make of Q |q|^2 times what it is for waves (m, 0) of amplitude |q|^2 p at
   s.  So these may be taken for them, if the frame tells s apart: then s_1 is a multiple of v1,
   with what shifts it, and v0 is not felt.  The products with |q|^2 are rounded by u or two. */
static void straighten(loewner *w)
{
    const double *const k = w->k[2], common = divisor(fabs(k[0]), fabs(k[1]));
    const double q[2] = { k[0] / common, k[1] / common }, scale = q[0] * q[0] + q[1] * q[1];
    int good = w->waves > 2 && q[0] * w->frame[0][0] + q[1] * w->frame[1][0] == 0.0;

    for (int i = 2; i < w->waves; i++)
        good = good && w->k[i][0] * q[1] == w->k[i][1] * q[0];
    if (!good)
        return;
    w->turns.xstar[0] = factor_of(q[0]) * w->turns.xstar[0] + factor_of(q[1]) * w->turns.xstar[1];
    w->xstar_err[0] *= fabs(q[0]) + fabs(q[1]);
    w->turns.xstar[1] = 0;
    w->xstar_err[1] = 0.0;
    w->length = (int)scale;
    w->frame[0][1] = q[0] * w->frame[0][1] + q[1] * w->frame[1][1];
    w->frame[1][0] = 1.0;
    w->frame[0][0] = w->frame[1][1] = 0.0;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            w->turns.frame[i][k] = factor_of(w->frame[i][k]);
    w->identity = 0;
    w->most_k = 1.0;
    for (int i = 2; i < w->waves; i++) {
        w->amplitude[i] *= scale;
        for (int m = 0; m < w->n_parameters; m++)
            w->part[i][m] *= scale;
        w->err_amplitude[i] *= scale;
        w->k[i][0] = (w->k[i][0] * q[0] + w->k[i][1] * q[1]) / scale;
        w->k[i][1] = 0.0;
        w->square_k[i] = square(w->k[i][0]);
        w->most_k = larger(w->most_k, fabs(w->k[i][0]));
    }
    for (int i = 0; i < 2; i++) {
        w->seen[0][i] = q[i];
        w->seen[1][i] = 0.0;
    }
}

/* The axes in which remainders are bounded (orbit.c: step): along k of the wave that bends most,
   and across it.  Orbits stretch along such axes, and products of matrices bounded entry by entry
   grow there much as they do themselves, where in other coordinates entries that cancel would be
   added.  R is orthogonal but for the factor |k|, and made of integers; quotients are off by u. */
static void set_axes(loewner *w)
{
    double k[2] = { 1.0, 0.0 }, most = -1.0, common, square_k;

    for (int i = FIRST; i < w->waves; i++) {
        const double bends = size_of(w, i) * (square(w->k[i][0]) + square(w->k[i][1]));
        if (bends > most) {
            most = bends;
            memcpy(k, w->k[i], sizeof k);
        }
    }
    common = divisor(fabs(k[0]), fabs(k[1]));
    for (int j = 0; j < 2; j++)
        k[j] /= common;
    square_k = square(k[0]) + square(k[1]);
    w->axes[0][0] = w->axes[1][1] = k[0];
    w->axes[0][1] = k[1];
    w->axes[1][0] = -k[1];
    w->turn[0] = k[0] * k[0] / square_k;
    w->turn[1] = k[0] * k[1] / square_k;
    w->turn[2] = k[1] * k[1] / square_k;
    w->turn[3] = (k[0] * k[0] - k[1] * k[1]) / square_k;
    for (int i = 0; i < w->waves; i++)
        for (int j = 0; j < 2; j++) {
            w->onto[j][i] = fabs(w->axes[j][0] * w->k[i][0] + w->axes[j][1] * w->k[i][1]);
            w->along[i][j] = w->onto[j][i] / square_k;
        }
}

/* The waves at a corner of the parameters' cube.  An amplitude there is off by less than its
   err_amplitude, and a phase by 2^-50 of itself (near) and what it was off before, less than 10^-39
   (converse.h). */
static int waves_at_corner(const loewner *w, int corner, torus_wave waves[MOST_WAVES])
{
    int n = 0;

    for (int i = FIRST; i < w->waves; i++) {
        double p = w->amplitude[i];
        for (int m = 0; m < w->n_parameters; m++)
            p += (corner >> m & 1 ? 1.0 : -1.0) * w->part[i][m];
        waves[n++] =
            (torus_wave){ { w->k[i][0], w->k[i][1] },
                          interval_about(w->phase[i], 0x1p-49 * fabs(w->phase[i]) + 0x1p-129),
                          interval_about(p, w->err_amplitude[i]) };
    }
    return n;
}

/* Sets B at the corners.  Corners that differ by parameters that move no wave have the same waves,
   and so the same B. */
void loewner_bound_torus(loewner *w)
{
    torus_wave waves[MOST_WAVES];
    int moving = 0; /* the parameters that move a wave, as bits */

    for (int i = FIRST; i < w->waves; i++)
        for (int m = 0; m < w->n_parameters; m++)
            moving |= (w->part[i][m] != 0.0) << m;
    for (int corner = 0; corner < 1 << w->n_parameters; corner++) {
        const int n = waves_at_corner(w, corner, waves), same = corner & moving;
        w->corner[corner] =
            same < corner ? w->corner[same] : torus_largest(n, waves, TORUS_EIGENVALUE);
    }
}

/* The waves in turns, when they are straightened: phases, k, and amplitudes in units of 2^coarse,
   so large that none has as many as 2^62 of them. */
static void set_turns(loewner *w, const patch *problem, const apm_t scale)
{
    double most = 0.0;
    apm_t longer;

    for (int i = FIRST; i < w->waves; i++)
        most = larger(most, size_of(w, i) + w->err_amplitude[i]);
    if (!(most < MAX_AMPLITUDE) || w->waves == FIRST)
        w->usable = 0;
    for (w->coarse = 0; w->usable && ldexp(1.0, w->coarse) < most;)
        w->coarse++;
    w->err_amp = ldexp(8.0 * TURN_UNIT, w->coarse);
    apm_init(longer);
    apm_mul_si(longer, scale, w->length);
    for (int i = FIRST; i < w->waves && w->usable; i++) {
        const int given = w->given[i];
        w->turns.amplitude[i] = whole(w, problem->amplitude[given], longer, w->coarse);
        for (int m = 0; m < w->n_parameters; m++)
            w->turns.part[i][m] = whole(w, problem->part[given][m], longer, w->coarse);
        w->turns.phase[i] = (uint64_t)whole(w, problem->phase[given], scale, 0);
        if (w->phase[i] != 0.0)
            w->err_pull = 0x1p-60;
        for (int j = 0; j < 2; j++)
            w->turns.k[i][j] = factor_of(w->k[i][j]);
    }
    apm_clear(longer);
}

/* Gives the problem room to try prisms in; NULL: no memory, and the problem is freed. */
static loewner *with_room(loewner *w)
{
    w->memory = calloc(1, w->engine->size + ALIGNMENT);
    if (w->memory == NULL) {
        free(w);
        return NULL;
    }
    w->work = w->memory + (ALIGNMENT - (uintptr_t)w->memory % ALIGNMENT);
    return w;
}

loewner *loewner_new(const patch *problem, int longest)
{
    loewner *w = calloc(1, sizeof *w);
    apm_t scale;

    if (w == NULL)
        return NULL;
    w->usable = w->length = 1;
    w->err_pull = 0x1p-90;
    w->longest = longest;
    apm_init(scale);
    units_of_radian(scale);
    set_angles(w, problem, scale);
    set_wave_slots(w, problem);
    straighten(w);
    set_turns(w, problem, scale);
    apm_clear(scale);
    set_axes(w);
    for (int corner = 0; corner < 1 << w->n_parameters; corner++)
        w->corner[corner] = HUGE_VAL;
    w->engine = fastest_engine();
    return with_room(w);
}

loewner *loewner_copy(const loewner *w)
{
    loewner *const copy = malloc(sizeof *copy);

    if (copy == NULL)
        return NULL;
    *copy = *w;
    return with_room(copy);
}

void loewner_free(loewner *w)
{
    if (w != NULL) {
        w->engine->free(w->work);
        free(w->memory);
    }
    free(w);
}

double loewner_largest(const loewner *w)
{
    const double low[3] = { 0, 0, 0 }, high[3] = { 1, 1, 1 };

    return cell_largest(w, low, high);
}

/* With n the eigenvector at the centre, n.beta n = 2|n|^2 - sum p sin(y) (k.n)^2 is linear in the
   parameters.  In units u, a wave's terms are off by 32 of |p| and its parts, by (4 + err_angle)
   for the sine, err_angle as in waves.h, and 8 for the product, where (k.n)^2 is off by 5 of (|k0|
   + |k1|)^2 |n|^2; at most 21 numbers are added.  So all is off by 70 + err_angle of the sum of
   absolute values with that in the place of (k.n)^2, the mass; the margin is 256 (1 + err_angle).
   */
int loewner_at_once(const loewner *w, const double at[2], int at_end)
{
    const double x[2] = { w->seen[0][0] * at[0] + w->seen[0][1] * at[1],
                          w->seen[1][0] * at[0] + w->seen[1][1] * at[1] };
    double n[2], d[3] = { 2.0, 0.0, 2.0 }, p[SLOTS], pull[SLOTS], sum, mass, err_angle = 0.0;

    for (int i = 0; i < w->waves; i++) {
        const double *const k = w->k[i], y0 = k[0] * x[0], y1 = k[1] * x[1];
        double c;
        double_sincos(&pull[i], &c, (y0 + y1) + w->phase[i]);
        err_angle = larger(err_angle, 3.0 * (fabs(y0) + fabs(y1)) + 10.0 * fabs(w->phase[i]));
        p[i] = w->amplitude[i];
        for (int m = 0; m < w->n_parameters && at_end; m++)
            p[i] += w->part[i][m];
        d[0] -= p[i] * pull[i] * k[0] * k[0];
        d[1] -= p[i] * pull[i] * k[0] * k[1];
        d[2] -= p[i] * pull[i] * k[1] * k[1];
    }
    least_eigenvector(d, n);
    const double length = square(n[0]) + square(n[1]);
    sum = mass = 4.0 / 3.0 * length; /* 2 |n|^2 less 2/3 |n|^2 */
    for (int i = 0; i < w->waves; i++) {
        pull[i] *= square(w->k[i][0] * n[0] + w->k[i][1] * n[1]);
        sum -= p[i] * pull[i];
        mass += (size_of(w, i) + w->err_amplitude[i]) * w->square_k[i] * length;
    }
    for (int m = 0; m < w->n_parameters && !at_end; m++) {
        double swing = 0.0;
        for (int i = 0; i < w->waves; i++)
            swing += w->part[i][m] * pull[i];
        sum += fabs(swing);
    }
    return mass >= 1.0 && sum + 0x1p-45 * (1.0 + err_angle) * mass < 0.0;
}
