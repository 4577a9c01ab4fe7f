/* patch.c - reads a problem and answers questions about its kind. */
#include <stdlib.h>

#include "arith/special.h"
#include "model/patch.h"

enum { MOST_POWER = 300 };              /* Sizes of a problem's numbers are 10^300 at most. */
enum { MOST_K = 100 };                  /* The integers of waves and frames are MOST_K at most. */
enum { PHASE_PLACES = 50 };             /* Phases use pi to 50 decimals. */

static void for_each(patch *p, void (*what)(apm_t))
{
    for (int i = 0; i < MOST_WAVES; i++) {
        what(p->phase[i]);
        what(p->amplitude[i]);
        for (int m = 0; m < PARAMETERS; m++)
            what(p->part[i][m]);
    }
    for (int j = 0; j < ANGLES; j++) {
        what(p->angle[j]);
        what(p->half[j]);
        for (int m = 0; m < PARAMETERS; m++)
            what(p->shift[j][m]);
        what(p->xstar[j]);
    }
}

void patch_init(patch *p) { for_each(p, apm_init); }
void patch_clear(patch *p) { for_each(p, apm_clear); }

/* ---- reading */

/* Reads a number of the problem, if *status is CV_OK. */
static void read_number(apm_t x, const char *text, int *status)
{
    apm_t size, most;

    if (*status != CV_OK)
        return;
    apm_init(size);
    apm_init(most);
    apm_set_si(most, 1, MOST_POWER);
    if (apm_set_str(x, text) != APM_OK)
        *status = CV_ENUMBER;
    apm_abs(size, x);
    if (apm_cmp(size, most) > 0)
        *status = CV_ENUMBER;
    apm_clear(size);
    apm_clear(most);
}

static void read_wave(patch *p, int i, const cv_wave *wave, const apm_t pi, int *status)
{
    int zero = 1;

    for (int j = 0; j < p->n_angles; j++) {
        p->k[i][j] = wave->k[j];
        zero = zero && wave->k[j] == 0;
        if (abs(wave->k[j]) > MOST_K)
            *status = CV_EARGUMENT;
    }
    if (zero)
        *status = CV_EARGUMENT;
    read_number(p->phase[i], wave->phase, status);
    read_number(p->amplitude[i], wave->amplitude, status);
    for (int m = 0; m < p->n_parameters; m++)
        read_number(p->part[i][m], wave->part[m], status);
    apm_mul(p->phase[i], p->phase[i], pi);
    p->quarters[i] = wave->quarters;
}

static int determinant(int f[ANGLES][ANGLES])
{
    int sum = 0;

    for (int i = 0; i < ANGLES; i++) {
        const int j = (i + 1) % ANGLES, k = (i + 2) % ANGLES;
        sum += f[0][i] * (f[1][j] * f[2][k] - f[1][k] * f[2][j]);
    }
    return sum;
}

static void read_region(patch *p, const cv_problem *given, int *status)
{
    for (int i = 0; i < ANGLES; i++) /* identity beyond the angles: the determinant is as it is */
        for (int j = 0; j < ANGLES; j++) {
            const int there = i < p->n_angles && j < p->n_angles;
            p->frame[i][j] = there ? given->frame[i][j] : i == j;
            if (abs(p->frame[i][j]) > MOST_K)
                *status = CV_EARGUMENT;
        }
    if (*status == CV_OK && determinant(p->frame) == 0)
        *status = CV_EARGUMENT;
    for (int j = 0; j < p->n_angles; j++) {
        read_number(p->angle[j], given->angle[j], status);
        read_number(p->half[j], given->half[j], status);
        if (apm_sgn(p->half[j]) < 0)
            *status = CV_EARGUMENT;
        for (int m = 0; m < p->n_parameters; m++)
            if (given->shift[j][m] != NULL)
                read_number(p->shift[j][m], given->shift[j][m], status);
    }
}

int patch_read(patch *p, const cv_problem *given)
{
    int status = CV_OK;
    apm_t pi;

    if (given->n_angles < 1 || given->n_angles > ANGLES || given->n_waves < 1 ||
        given->n_waves > MOST_WAVES || given->n_parameters < 0 || given->n_parameters > PARAMETERS)
        return CV_EARGUMENT;
    p->n_angles = given->n_angles;
    p->n_waves = given->n_waves;
    p->n_parameters = given->n_parameters;
    p->odd = given->odd;
    p->symmetric = given->symmetric;
    apm_init(pi);
    apm_pi(pi, PHASE_PLACES);
    for (int i = 0; i < p->n_waves; i++)
        read_wave(p, i, &given->waves[i], pi, &status);
    apm_clear(pi);
    read_region(p, given, &status);
    return status;
}

/* ---- what it is */

int is_identity(const patch *p)
{
    int good = 1;

    for (int i = 0; i < ANGLES; i++)
        for (int j = 0; j < ANGLES; j++)
            good = good && p->frame[i][j] == (i == j);
    return good;
}

int is_of_thesis(const patch *p)
{
    int good = p->n_angles == 2 && p->n_waves == 3 && p->n_parameters == 3 && is_identity(p);

    for (int i = 0; i < p->n_angles; i++)
        for (int m = 0; m < p->n_parameters; m++)
            good = good && apm_sgn(p->shift[i][m]) == 0;
    for (int i = 0; i < 3 && good; i++) {
        good = p->k[i][0] == (i != 1) && p->k[i][1] == (i != 0) && apm_sgn(p->phase[i]) == 0;
        for (int m = 0; m < 3; m++)
            good = good && (m == i ? apm_sgn(p->part[i][m]) >= 0 : apm_sgn(p->part[i][m]) == 0);
    }
    return good;
}

void patch_amplitudes(const patch *p, double t, double to[MOST_WAVES])
{
    for (int i = 0; i < p->n_waves; i++) {
        to[i] = apm_get_d(p->amplitude[i]);
        for (int m = 0; m < p->n_parameters; m++)
            to[i] += t * apm_get_d(p->part[i][m]);
    }
}
