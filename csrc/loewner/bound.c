/* bound.c - the second variation over a whole prism, by multipliers.

   Let x[j] be the orbit of the centre and x[j] + D[j] any true one, on which
   E[j] = 2x[j] - x[j-1] - x[j+1] - V'(x[j]) = 0.  So for any multipliers mu, zero but at sites both
   of whose neighbours are in the orbit, the sum Q + sum mu[j].E[j] is Q, and with

       mu[j-1] = gradient of n[j].beta(x[j])n[j] + beta(x[j])mu[j] - mu[j+1]  from the future,  (2)

   and likewise from the past, all terms linear in the D[j] cancel, except those in D[0] and D[1],
   which are the prism itself.  What is left of each wave, of weight omega = (n.u)^2 and with
   m = mu.u, A = m cos y - omega sin y, B = -omega cos y - m sin y, is

       p (A (cos d - 1) + B (sin d - d)),   |d| <= rho,                                        (3)

   and at most max(0, -pA) rho^2/2 + |pB| rho^3/6; where the parameter is p + w, w A, which is
   summed over the orbit before it is bounded, and w (A (cos d - 1) + B sin d).  (2) is an identity
   in exact arithmetic; in doubles what is left of it is multiplied by |D[j]| and added. */
#include "prism.h"

#ifndef SHARE_REST
#define SHARE_REST 1.0
#endif
enum { TRIPLES = 35 };
static const unsigned char triple3[3][PAIRS] = { { 0, 1, 2, 3, 4, 5 }, { 1, 3, 4, 6, 7, 8 }, { 2, 4, 5, 7, 8, 9 } };
static const unsigned char triple5[5][PAIRS] = { { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14 }, { 1, 5, 6, 7, 8, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24 }, { 2, 6, 9, 10, 11, 16, 19, 20, 21, 25, 26, 27, 28, 29, 30 }, { 3, 7, 10, 12, 13, 17, 20, 22, 23, 26, 28, 29, 31, 32, 33 }, { 4, 8, 11, 13, 14, 18, 21, 23, 24, 27, 29, 30, 32, 33, 34 } };
static const unsigned char pair_of5[5][5] = { { 0, 1, 2, 3, 4 }, { 0, 5, 6, 7, 8 }, { 0, 0, 9, 10, 11 }, { 0, 0, 0, 12, 13 }, { 0, 0, 0, 0, 14 } };
static const unsigned char pair_of3[5][5] = { { 0, 1, 2, 0, 0 }, { 0, 3, 4, 0, 0 }, { 0, 0, 5, 0, 0 }, { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 } };

/* The multipliers, by (2): zero outside, and from either end up to the sites 0 and 1. */
static void set_multipliers(loewner *w)
{
    point *q = w->orbit;

    for (int j = w->from - 1; j <= w->until + 1; j++)
        q[j].mu[0] = q[j].mu[1] = 0.0;
    for (int j = w->from; j <= w->until; j++) {
        const double omega = square(q[j].n[0] + q[j].n[1]);
        const double sum = omega * w->p[2] * q[j].cosine[2];
        for (int i = 0; i < 2; i++)
            q[j].gradient[i] = -(square(q[j].n[i]) * w->p[i] * q[j].cosine[i] + sum);
    }
    for (int j = w->until; j > ORIGIN + 1; j--)
        for (int i = 0; i < 2; i++)
            q[j - 1].mu[i] = q[j].gradient[i] + q[j].beta[i] * q[j].mu[0]
                             + q[j].beta[i + 1] * q[j].mu[1] - q[j + 1].mu[i];
    for (int j = w->from; j < ORIGIN; j++)
        for (int i = 0; i < 2; i++)
            q[j + 1].mu[i] = q[j].gradient[i] + q[j].beta[i] * q[j].mu[0]
                             + q[j].beta[i + 1] * q[j].mu[1] - q[j - 1].mu[i];
}

/* The sums with signs are the constant `centre` and the coefficients `along` of the parameters;
   their masses are the sums of their terms' absolute values.  At each of N sites at most 5 numbers
   are added to either, each addition rounds by u of the partial sums, and each number is off by
   5 u of itself: together by (5 N + 8) u of the mass; `each` is 32 (N + 1) u.  The sines add
   (4 + far) u of it; 2^-49 (1 + far) is 16 (1 + far) u.  A and B are off by (9 + far) u of
   omega + |m|: where a wave comes with a reach, so does its part of the mass.  Positive sums are
   off by (3 N + 25) u of themselves, which `each` covers, too.  (2) leaves at most
   11 u (1 + sizes)(1 + far) of the weights and 2 u of the neighbours' mu; `left` has 64 and 8. */
void bound_second_variation(loewner *w)
{
    double centre = 0.0, mass = 0.0, rest = 0.0, rounding = 0.0, far = 0.0;
    double along[WAVES] = { 0, 0, 0 }, along_mass = 0.0, tails, corners;
    double slope[COLUMNS] = { 0 }, square_form[PAIRS] = { 0 }, cubic[TRIPLES] = { 0 };
    const double each = 0x1p-48 * (double)(w->until - w->from + 2);
    const int columns = w->columns, pairs = w->pairs;
    const unsigned char (*const triple)[PAIRS] = columns == 3 ? triple3 : triple5;

    set_multipliers(w);
    for (int k = 0; k < COLUMNS; k++)
        w->share[k] = 0.0;
    for (int j = w->from; j <= w->until; j++) {
        const point *q = w->orbit + j;
        const double n0 = q->n[0], n1 = q->n[1], mu0 = q->mu[0], mu1 = q->mu[1];
        const double omega[WAVES] = { n0 * n0, n1 * n1, square(n0 + n1) };
        const double m[WAVES] = { mu0, mu1, mu0 + mu1 };
        const double weights = omega[0] + omega[1] + omega[2] + fabs(mu0) + fabs(mu1) + TINY;

        centre += 2.0 * (omega[0] + omega[1]);
        mass += 2.0 * (omega[0] + omega[1]);
        if (j < w->to) {
            const double *next = q[1].n;
            centre -= 2.0 * (n0 * next[0] + n1 * next[1]);
            mass += 2.0 * (fabs(n0 * next[0]) + fabs(n1 * next[1]));
        }
        far = larger(far, q->far);
        for (int i = 0; i < WAVES; i++) {
            const double s = q->sine[i], co = q->cosine[i], p = w->p[i], rho = q->reach[i];
            const double h = w->h[i], loose = w->loose[i];
            const double weight = omega[i] + fabs(m[i]) + TINY;
            const double A = m[i] * co - omega[i] * s, B = -omega[i] * co - m[i] * s;
            const double pA = p * A, pB = p * B;
            const double a = q->straight[i], b = q->off[i];
            const double r = i < 2 ? q->rest[i] : q->rest[0] + q->rest[1];
            const double rho2 = rho * rho, rho4 = rho2 * rho2 * (1.0 / 24.0);
            const double bent = b * (2.0 * a + b) * 0.5;
            const double term = (pA > 0.0 ? pA * rho4 : -pA * b * b * 0.5) + fabs(pA) * a * r
                + fabs(pB) * (b * (3.0 * a * (a + b) + b * b) * (1.0 / 6.0) + rho * rho4 * 0.2)
                + h * (fabs(A) * (bent + rho4) + fabs(B) * (r + rho * rho2 * (1.0 / 6.0)))
                + loose * (fabs(A) * rho2 * 0.5 + fabs(B) * rho);
            const int t = w->together ? 2 : 2 + i;
            double c[COLUMNS], bow[PAIRS], form[PAIRS];

            centre -= omega[i] * p * s;
            mass += omega[i] * fabs(p);
            along[i] += A;
            along_mass += weight * (h + loose + (size(w, i) * rho * (1.0 + rho) + h + loose) * rho);
            rest += term;
            if (rho == 0.0)
                continue;
            for (int k = 0; k < columns; k++)
                c[k] = i < 2 ? q->column[i][k] : q->column[0][k] + q->column[1][k];
            for (int k = 0; k < pairs; k++)
                bow[k] = i < 2 ? q->bow[i][k] : q->bow[0][k] + q->bow[1][k];
            for (int k = 0, kl = 0; k < columns; k++)
                for (int l = k; l < columns; l++, kl++) {
                    const double cc = (k == l ? 0.5 : 1.0) * c[k] * c[l];
                    square_form[kl] -= pA * cc;
                    form[kl] = -pA * bow[kl] - pB * (1.0 / 3.0) * cc;
                    cubic[triple[t][kl]] += h * (B * bow[kl] - A * cc);
                }
            for (int k = 0; k < columns; k++) {
                square_form[(columns == 3 ? pair_of3 : pair_of5)[t < k ? t : k][t < k ? k : t]] += h * B * c[k];
                for (int kl = 0; kl < pairs; kl++)
                    cubic[triple[k][kl]] += c[k] * form[kl];
            }
            {
                const double part = SHARE_REST * term / rho;
                for (int k = 0; k < columns; k++)
                    w->share[k] += part * fabs(c[k]);
            }
        }
        /* what (2) leaves, and what the centre's steps missed */
        for (int i = 0; i < 2; i++) {
            const double before = q[-1].mu[i], after = q[1].mu[i];
            double left = 4.0 * q->fuzz * weights + 0x1p-50 * (fabs(before) + fabs(after));
            if (j == ORIGIN || j == ORIGIN + 1) {
                const double steep = q->gradient[i] + q->beta[i] * mu0
                                          + q->beta[i + 1] * mu1 - before - after;
                if (j == ORIGIN + 1)
                    slope[i] += steep * q->column[i][i];
                else
                    rest += fabs(steep) * q->reach[i];
            }
            rounding += left * q->reach[i];
            if (j > w->from && j < w->until)
                rounding += fabs(q->mu[i]) * q->missed[i];
        }
    }
    tails = w->l * (square(w->orbit[w->from].n[0]) + square(w->orbit[w->from].n[1])
                    + square(w->orbit[w->to].n[0]) + square(w->orbit[w->to].n[1]));
    centre -= tails;
    mass += tails;
    for (int i = 0; i < WAVES; i++) {
        slope[w->together ? 2 : 2 + i] += w->h[i] * along[i];
        rest += w->loose[i] * fabs(along[i]);
    }
    for (int k = 0, kl = 0; k < columns; k++) {
        w->share[k] += fabs(slope[k]);
        for (int l = k; l < columns; l++, kl++) {
            if (k == l) {
                rest += larger(0.0, square_form[kl]);
                w->share[k] += 2.0 * larger(0.0, square_form[kl]);
            } else {
                w->share[k] += fabs(square_form[kl]);
                w->share[l] += fabs(square_form[kl]);
            }
        }
    }
    for (int k = 0; k < (columns == 3 ? 10 : 35); k++)
        rest += fabs(cubic[k]);
    for (int k = 0, m = 0; k < columns; k++)
        for (int l = k; l < columns; l++)
            for (int o = l; o < columns; o++, m++) {
                w->share[k] += fabs(cubic[m]);
                w->share[l] += fabs(cubic[m]);
                w->share[o] += fabs(cubic[m]);
            }
    corners = -HUGE_VAL;
    for (int corner = 0; corner < 1 << (columns - 1); corner++) {
        double linear = 0.0, mixed = 0.0;
        for (int k = 0, kl = 0; k < columns; k++) {
            const double ek = corner >> k & 1 ? -1.0 : 1.0;
            linear += ek * slope[k];
            for (int l = k; l < columns; l++, kl++)
                if (l > k)
                    mixed += (corner >> l & 1 ? -ek : ek) * square_form[kl];
        }
        corners = larger(corners, fabs(linear) + mixed);
    }
    rounding += (mass + along_mass) * (each + 0x1p-49 * (1.0 + far));
    w->rounding = rounding * (1.0 + each);
    w->bound = mass >= 1.0 ? centre + corners + (rest + w->rounding) * (1.0 + each) : HUGE_VAL;
}
