/* problem.c - what belongs to all prisms of a problem, and the engine that is to try them. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "arith/sine.h"
#include "arith/special.h"
#include "arith/sym.h"
#include "problem.h"
#include "model/torus.h"

/* Numbers of turns are less than 10^ORDER < 2^BITS units of 2^-64 turns: see times_middle. */
enum { ORDER = 24, BITS = 80 };
enum { SCALE_DIGITS = 60 }; /* decimal places of units per radian: see units_of_radian */
static const double MAX_AMPLITUDE = 0x1p60; /* of a wave: see wave_at */
static const double ERR_V = 16.0 * TURN_UNIT; /* of a cell's centre and half-width: set_angles */
static const int axis_of[ANGLES] = { V0, V1, V2 };

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
   each shift, by 9 at most: ERR_V.  The doubles near half and the shifts are off by 8 u of
   themselves (near), products with powers of two by nothing.  The columns frame width and frame
   shift round by 3 u of their absolute values at most, but for the identity: `off` has 8, and what
   it makes of v by the inverse of the frame is added to the widths, too. */
static void set_region(const loewner *w, const cv_cell *cell, const double part[], loewner_cell *c)
{
    double off[ANGLES] = { 0.0 }, size[ANGLES];
    uint64_t v[ANGLES];

    for (int i = 0; i < w->angles; i++) {
        const double width = w->half[i] * part[axis_of[i]];
        v[i] = (uint64_t)w->turns.centre[i] +
               (uint64_t)times_middle(w->turns.half[i], cell, axis_of[i]);
        size[i] = width;
        for (int m = 0; m < w->n_parameters; m++) {
            v[i] += (uint64_t)times_middle(w->turns.shift[i][m], cell, T1 + m);
            c->shift[i][m] = w->shift[i][m] * part[T1 + m];
            size[i] += fabs(c->shift[i][m]);
        }
        c->width[i] = width + ERR_V + 0x1p-49 * size[i];
        size[i] += ERR_V;
    }
    for (int i = 0; i < w->angles; i++)
        for (int k = 0; k < w->angles; k++) {
            c->x1[i] += w->turns.frame[i][k] * v[k];
            off[i] += w->identity ? 0.0 : 0x1p-50 * fabs(w->frame[i][k]) * size[k];
        }
    for (int i = 0; i < w->angles; i++)
        for (int k = 0; k < w->angles; k++)
            c->width[i] += w->inverse[i][k] * off[k];
}

/* The waves.  A cell's amplitude is off by 7 units at most, as its centre is above, which err_amp
   has; its parts are off by 8 u of themselves (near), and the double p by 3 u of its own. */
static void set_amplitudes(const loewner *w, const cv_cell *cell, const double part[],
                           loewner_cell *c)
{
    const double unit = ldexp(TURN_UNIT, w->coarse);

    for (int i = w->angles; i < w->waves; i++) {
        int128 force = w->turns.amplitude[i];
        double size = 0.0;
        for (int m = 0; m < w->n_parameters; m++) {
            force += times_middle(w->turns.part[i][m], cell, T1 + m);
            c->part[i][m] = w->part[i][m] * part[T1 + m];
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
    double part[AXES], low[3], high[3], B;

    memset(c, 0, sizeof *c);
    if (!w->usable)
        return 0;
    for (int k = 0; k < AXES; k++) {
        if (cell->cuts[k] > CV_MAX_CUTS)
            return 0;
        part[k] = ldexp(1.0, -cell->cuts[k]);
    }
    set_region(w, cell, part, c);
    set_amplitudes(w, cell, part, c);
    for (int m = 0; m < w->n_parameters; m++) { /* exact */
        low[m] = (double)cell->index[T1 + m] * part[T1 + m];
        high[m] = low[m] + part[T1 + m];
    }
    B = cell_largest(w, low, high);
    c->l = 2.0 / (B + sqrt((B - 2.0) * (B + 2.0))) * (1.0 - 0x1p-46); /* off by 5 u before */
    return c->l > 0.0;
}

/* Not where what is off makes four fifths of its width or more. */
int cut_helps(const loewner *w, const cv_cell *cell, int axis)
{
    const int m = axis - T1, cuts = cell->cuts[axis], moves = 0 <= m && m < PARAMETERS;
    int wide = 0;

    for (int i = 0; i < w->waves && moves; i++)
        wide = wide || ldexp(fabs(w->part[i][m]), 2 - cuts) > w->err_amp;
    for (int i = 0; i < w->angles; i++)
        wide = wide || (moves ? ldexp(fabs(w->shift[i][m]), 2 - cuts) > ERR_V
                              : axis == axis_of[i] && ldexp(w->half[i], 2 - cuts) > ERR_V);
    return wide && cuts < CV_MAX_CUTS;
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

/* The most lanes that this machine can use.  The environment variable CONVERSE_LANES limits that
   number, as tests compare the engines. */
static int most_lanes(void)
{
#ifdef __x86_64__
    const char *const limit = getenv("CONVERSE_LANES");
    const long lanes = limit == NULL ? MOST_LANES : strtol(limit, NULL, 10);

    if (lanes >= 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        return 8;
    if (lanes >= 4 && __builtin_cpu_supports("avx2"))
        return 4;
#endif
    return 2;
}

static const engine *fastest_engine(int angles)
{
#define ADDRESS_OF(name) &name,
    static const engine *const all[] = { ENGINES(ADDRESS_OF) };
#undef ADDRESS_OF
    const int lanes = most_lanes();
    size_t j = 0;

    while (all[j]->angles != angles || all[j]->lanes != lanes)
        j++;
    return all[j];
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

/* |frame^-1|, of cofactors, which are whole numbers; quotients are off by u. */
static void set_inverse(loewner *w)
{
    double det = 0.0, cofactor[ANGLES][ANGLES];

    for (int i = 0; i < ANGLES; i++)
        for (int j = 0; j < ANGLES; j++) {
            const double *const a = w->frame[(i + 1) % ANGLES], *const b =
                                                                    w->frame[(i + 2) % ANGLES];
            const int k = (j + 1) % ANGLES, l = (j + 2) % ANGLES;
            cofactor[i][j] = a[k] * b[l] - a[l] * b[k];
            det += i == 0 ? w->frame[0][j] * cofactor[0][j] : 0.0;
        }
    for (int i = 0; i < ANGLES; i++)
        for (int j = 0; j < ANGLES; j++)
            w->inverse[i][j] = fabs(cofactor[j][i] / det);
}

/* The angles, and x*.  ERR_V is the 9 units of set_region, and the errors of the radians, since
   links of other points end at a prism's sides.  Pi has 30 places at least (least_digits), and
   numbers of 10^ORDER units are below 2^17 pi.  So the errors of an axis's five numbers, and the
   sum of them in half (region_to_radians), are below 10^-23 radians, 10^-4 of a unit. */
static void set_angles(loewner *w, const patch *problem, const apm_t scale)
{
    w->angles = problem->n_angles;
    w->n_parameters = problem->n_parameters;
    w->identity = is_identity(problem);
    w->xstar_err = 2.0 * TURN_UNIT;
    for (int i = 0; i < ANGLES; i++)
        for (int k = 0; k < ANGLES; k++) {
            w->frame[i][k] = problem->frame[i][k];
            w->turns.frame[i][k] = factor_of(w->frame[i][k]);
        }
    set_inverse(w);
    for (int i = 0; i < w->angles; i++) {
        w->turns.centre[i] = whole(w, problem->angle[i], scale, 0);
        w->turns.half[i] = whole(w, problem->half[i], scale, 0);
        w->half[i] = near(problem->half[i]);
        for (int m = 0; m < w->n_parameters; m++) {
            w->turns.shift[i][m] = whole(w, problem->shift[i][m], scale, 0);
            w->shift[i][m] = near(problem->shift[i][m]);
        }
        w->turns.xstar[i] = (uint64_t)whole(w, problem->xstar[i], scale, 0);
    }
}

/* |amplitude| + sum of |part|: no amplitude of the wave is larger in size. */
static double size_of(const loewner *w, int i)
{
    double size = fabs(w->amplitude[i]);

    for (int m = 0; m < w->n_parameters; m++)
        size += fabs(w->part[i][m]);
    return size;
}

/* |k|, the sum of the |k[j]|. */
static double length_of(const loewner *w, int i)
{
    double sum = 0.0;

    for (int j = 0; j < w->angles; j++)
        sum += fabs(w->k[i][j]);
    return sum;
}

/* The numbers of one wave: amplitude, parts, phase and k.  Amplitude and parts are off by 8 u of
   themselves (near), and their sum at a corner by 3 u: 11 u of their sizes, where err_amplitude has
   32. */
static void read_wave(loewner *w, const patch *problem, int given, int i)
{
    w->given[i] = given;
    w->amplitude[i] = near(problem->amplitude[given]);
    for (int m = 0; m < w->n_parameters; m++)
        w->part[i][m] = near(problem->part[given][m]);
    w->err_amplitude[i] = 0x1p-48 * size_of(w, i);
    w->phase[i] = near(problem->phase[given]);
    for (int j = 0; j < w->angles; j++) {
        w->k[i][j] = problem->k[given][j];
        w->turns.k[i][j] = factor_of(w->k[i][j]);
    }
    w->square_k[i] = square(length_of(w, i));
}

/* The columns of the parameters that move a wave or the region: the others need no symbol. */
static void set_columns(loewner *w)
{
    memcpy(w->axis, axis_of, sizeof axis_of);
    w->columns = w->angles;
    for (int m = 0; m < w->n_parameters; m++) {
        int counts = 0;
        for (int i = 0; i < w->angles; i++)
            counts |= w->shift[i][m] != 0.0;
        for (int i = w->angles; i < w->waves; i++) {
            w->moves[i][w->columns] = w->part[i][m] != 0.0;
            counts |= w->moves[i][w->columns];
        }
        if (counts)
            w->axis[w->columns++] = T1 + m;
    }
}

/* The slots of the coordinates, and of the waves whose amplitude is not 0 for all parameters. */
static void set_wave_slots(loewner *w, const patch *problem)
{
    w->most_k = 1.0;
    for (int i = 0; i < w->angles; i++)
        w->k[i][i] = 1.0;
    w->waves = w->angles;
    for (int given = 0; given < problem->n_waves; given++) {
        const int i = w->waves;
        read_wave(w, problem, given, i);
        if (size_of(w, i) != 0.0) {
            w->most_k = larger(w->most_k, length_of(w, i));
            w->waves++;
        }
    }
    set_columns(w);
}

static double dot(const double a[ANGLES], const double b[ANGLES])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The rows of w->axes become orthogonal vectors of integers: k of the wave that bends most; of the
   wave that bends most across that, how it does; and their cross product.  Each is divided by what
   its elements have in common.  For fewer angles the others are unit vectors. */
static void set_rows(loewner *w)
{
    double (*const row)[ANGLES] = w->axes;

    for (int r = 0; r < ANGLES; r++) {
        const double square = r == 0 ? 1.0 : dot(row[0], row[0]);
        double v[ANGLES], most = -1.0, common = 0.0;
        for (int i = 0; i < w->waves && r < 2; i++) {
            for (int j = 0; j < ANGLES; j++)
                v[j] = square * w->k[i][j] - (r == 0 ? 0.0 : dot(row[0], w->k[i]) * row[0][j]);
            const double bends = size_of(w, i) * dot(v, v);
            if (bends > most && dot(v, v) > 0.0) {
                most = bends;
                memcpy(row[r], v, sizeof v);
            }
        }
        for (int j = 0; j < ANGLES && r >= w->angles; j++)
            row[r][j] = j == r;
        for (int j = 0; j < ANGLES && r == 2 && w->angles == 3; j++) {
            const int k = (j + 1) % ANGLES, l = (j + 2) % ANGLES;
            row[2][j] = row[0][k] * row[1][l] - row[0][l] * row[1][k];
        }
        for (int j = 0; j < ANGLES; j++)
            common = divisor(fabs(row[r][j]), common);
        for (int j = 0; j < ANGLES; j++)
            row[r][j] /= common;
    }
}

/* The axes O in which remainders are bounded (orbit.c: step): the rows of set_rows, made as long
   as 1.  Orbits stretch along such axes, and products of matrices bounded entry by entry grow there
   much as they do themselves, where in other coordinates entries that cancel would be added.  The
   elements of rows are whole numbers below 2^31, so that quotients of their products by lengths are
   off by 4 u: the product of the squared lengths by 2 u at most, halved by the root, the root, the
   sum above it and the quotient by u each. */
static void set_axes(loewner *w)
{
    const int n = w->angles;
    double square[ANGLES];

    set_rows(w);
    for (int i = 0; i < n; i++)
        square[i] = dot(w->axes[i], w->axes[i]);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            for (int a = 0; a < n; a++)
                for (int b = a; b < n; b++) {
                    const double *const r = w->axes[i], *const s = w->axes[j];
                    w->turn[sym_at(n, i, j)][sym_at(n, a, b)] =
                        (r[a] * s[b] + (a == b ? 0.0 : r[b] * s[a])) / sqrt(square[i] * square[j]);
                }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < w->waves; j++)
            w->onto[j][i] = fabs(dot(w->axes[i], w->k[j])) / sqrt(square[i]);
        for (int j = 0; j < n; j++)
            w->axes[i][j] = fabs(w->axes[i][j]) / sqrt(square[i]);
    }
}

/* The waves at a corner of the parameters' cube.  An amplitude there is off by less than its
   err_amplitude, and a phase by 2^-50 of itself (near) and what it was off before, less than 10^-39
   (converse.h). */
static int waves_at_corner(const loewner *w, int corner, torus_wave waves[MOST_WAVES])
{
    int n = 0;

    for (int i = w->angles; i < w->waves; i++) {
        double p = w->amplitude[i];
        for (int m = 0; m < w->n_parameters; m++)
            p += (corner >> m & 1 ? 1.0 : -1.0) * w->part[i][m];
        waves[n++] =
            (torus_wave){ { w->k[i][0], w->k[i][1], w->k[i][2] },
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

    for (int i = w->angles; i < w->waves; i++)
        for (int m = 0; m < w->n_parameters; m++)
            moving |= (w->part[i][m] != 0.0) << m;
    for (int corner = 0; corner < 1 << w->n_parameters; corner++) {
        const int n = waves_at_corner(w, corner, waves), same = corner & moving;
        w->corner[corner] =
            same < corner ? w->corner[same] : torus_largest(w->angles, n, waves, TORUS_EIGENVALUE);
    }
}

/* The waves in turns: phases, and amplitudes in units of 2^coarse, so large that none has as many
   as 2^62 of them. */
static void set_turns(loewner *w, const patch *problem, const apm_t scale)
{
    double most = 0.0;

    for (int i = w->angles; i < w->waves; i++)
        most = larger(most, size_of(w, i) + w->err_amplitude[i]);
    if (!(most < MAX_AMPLITUDE) || w->waves == w->angles)
        w->usable = 0;
    for (w->coarse = 0; w->usable && ldexp(1.0, w->coarse) < most;)
        w->coarse++;
    w->err_amp = ldexp(8.0 * TURN_UNIT, w->coarse);
    for (int i = w->angles; i < w->waves && w->usable; i++) {
        const int given = w->given[i];
        w->turns.amplitude[i] = whole(w, problem->amplitude[given], scale, w->coarse);
        for (int m = 0; m < w->n_parameters; m++)
            w->turns.part[i][m] = whole(w, problem->part[given][m], scale, w->coarse);
        w->turns.phase[i] = (uint64_t)whole(w, problem->phase[given], scale, 0);
        if (w->phase[i] != 0.0)
            w->err_pull = 0x1p-60;
    }
}

/* Is V even about turns.xstar?  A wave is if 2 (k.x* + phase) is half a turn but for whole ones,
   exactly: turns are integers modulo 2^64. */
static int is_mirrored(const loewner *w, const patch *problem)
{
    int even = 1;

    for (int i = w->angles; i < w->waves; i++) {
        const int quarters = problem->quarters[w->given[i]];
        uint64_t turns = (uint64_t)quarters * QUARTER_TURN;
        for (int j = 0; j < w->angles; j++)
            turns += w->turns.k[i][j] * w->turns.xstar[j];
        even = even && quarters >= 0 && 2 * turns == 2 * QUARTER_TURN;
    }
    return even;
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
    w->usable = 1;
    w->err_pull = 0x1p-90;
    w->longest = longest;
    apm_init(scale);
    units_of_radian(scale);
    set_angles(w, problem, scale);
    set_wave_slots(w, problem);
    set_turns(w, problem, scale);
    w->mirrored = is_mirrored(w, problem);
    apm_clear(scale);
    set_axes(w);
    for (int corner = 0; corner < 1 << w->n_parameters; corner++)
        w->corner[corner] = HUGE_VAL;
    w->engine = fastest_engine(w->angles);
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
   parameters.  In units u, a wave's terms are off by 32 of |p| and its parts, by (6 + err_angle)
   for the sine, err_angle as in waves.h, and 8 for the product, where (k.n)^2 is off by 7 of |k|^2
   |n|^2; at most 21 numbers are added.  So all is off by 74 + err_angle of the sum of absolute
   values with that in the place of (k.n)^2, the mass; the margin is 256 (1 + err_angle). */
int loewner_at_once(const loewner *w, const double x[ANGLES], int at_end)
{
    const int angles = w->angles;
    double n[ANGLES], d[MOST_ENTRIES], p[SLOTS], pull[SLOTS], err_angle = 0.0;
    double length = 0.0, sum, mass;

    for (int ab = 0; ab < MOST_ENTRIES; ab++)
        d[ab] = 0.0;
    for (int a = 0; a < angles; a++)
        d[sym_at(angles, a, a)] = 2.0;
    for (int i = 0; i < w->waves; i++) {
        const double *const k = w->k[i];
        double y = 0.0, size = 0.0, c;
        for (int a = 0; a < angles; a++) {
            const double part = k[a] * x[a];
            y += part;
            size += fabs(part);
        }
        double_sincos(&pull[i], &c, y + w->phase[i]);
        err_angle = larger(err_angle, 4.0 * size + 10.0 * fabs(w->phase[i]));
        p[i] = w->amplitude[i];
        for (int m = 0; m < w->n_parameters && at_end; m++)
            p[i] += w->part[i][m];
        for (int a = 0, ab = 0; a < angles; a++)
            for (int b = a; b < angles; b++)
                d[ab++] -= p[i] * pull[i] * k[a] * k[b];
    }
    sym_least_eigenvector(angles, d, n);
    for (int a = 0; a < angles; a++)
        length += square(n[a]);
    sum = mass = 4.0 / 3.0 * length; /* 2 |n|^2 less 2/3 |n|^2 */
    for (int i = 0; i < w->waves; i++) {
        double along = 0.0;
        for (int a = 0; a < angles; a++)
            along += w->k[i][a] * n[a];
        pull[i] *= square(along);
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
