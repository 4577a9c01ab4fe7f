/* bound.c - the second variation over a whole prism, by multipliers.

   Let x[j] be the orbit of the centre and x[j] + D[j] any true one, on which
   E[j] = 2x[j] - x[j-1] - x[j+1] - V'(x[j]) = 0.  So for any multipliers mu, zero but at sites both
   of whose neighbours are in the orbit, the sum Q + sum mu[j].E[j] is Q, and with

       mu[j-1] = gradient of n[j].beta(x[j])n[j] + beta(x[j])mu[j] - mu[j+1]  from the future,  (2)

   and likewise from the past, all terms linear in the D[j] cancel, except those in D[0] and D[1],
   which are the prism itself.  (2) is an identity in exact arithmetic; in doubles what is left of
   it is multiplied by |D[j]| and added.  What is left of each wave, of weight omega = (n.u)^2 and
   with m = mu.u, A = m cos y - omega sin y, B = -omega cos y - m sin y, z = u.D, is

       p (A (cos z - 1) + B (sin z - z)) + (p' - p)(A cos z + B sin z),   p' = p + h e + w.      (3)

   Of that, with z = c.e + T + r and Taylor's series, there is in the symbols

       linear     h e A
       quadratic  -pA (c.e)^2/2 + h e B (c.e)
       cubic      -pA (c.e) T - pB (c.e)^3/6 + h e (B T - A (c.e)^2/2)                          (4)

   with signs, and summed over the orbit before it is bounded.  With a >= |c.e|, b >= |T| + |r|,
   rho >= |z| the rest is at most

       |p| (|A| (a |r| + (pA > 0 ? rho^4/24 : b^2/2)) + |B| (b (3a^2 + 3ab + b^2)/6 + rho^5/120))
       + h (|A| (b (2a + b)/2 + rho^4/24) + |B| (|r| + rho^3/6)) + loose (|A| + |B| rho).     (5) */
#include <string.h>

#include "prism.h"

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


/* What a pass over the orbit sums, besides the coefficients. */
typedef struct { double centre, mass, rest, cubes, rounding, far; } sums;

/* (5), of one wave. */
INLINE double remainder_of(const loewner *w, const point *q, int i)
{
    const double p = w->p[i], h = w->h[i], A = fabs(q->A[i]), B = fabs(q->B[i]);
    const double a = q->straight[i], b = q->off[i], r = felt(i, q->rest[0], q->rest[1]);
    const double rho = q->reach[i], half_square = 0.5 * rho * rho;
    const double fourth = half_square * half_square * (1.0 / 6.0);

    return fabs(p) * (A * (a * r + (p * q->A[i] > 0.0 ? fourth : 0.5 * b * b))
                      + B * (b * (0.5 * a * (a + b) + b * b * (1.0 / 6.0)) + 0.2 * rho * fourth))
           + h * (A * (b * (a + 0.5 * b) + fourth) + B * (r + rho * half_square * (1.0 / 3.0)))
           + w->loose[i] * (A + B * rho);
}

/* Constant, linear and quadratic part, and what is bounded by absolute values; `cubes` is the cubic
   part if it is, too. */
INLINE void sum_up(loewner *w, sums *t, int columns)
{
    double along[WAVES] = { 0, 0, 0 }, tails;

    for (int j = w->from; j <= w->until; j++) {
        point *q = w->orbit + j;
        const double n0 = q->n[0], n1 = q->n[1], mu0 = q->mu[0], mu1 = q->mu[1];
        const double omega[WAVES] = { n0 * n0, n1 * n1, square(n0 + n1) };
        const double m[WAVES] = { mu0, mu1, mu0 + mu1 };
        const double weights = omega[0] + omega[1] + omega[2] + fabs(mu0) + fabs(mu1) + TINY;

        t->centre += 2.0 * (omega[0] + omega[1]);
        t->mass += 2.0 * (omega[0] + omega[1]);
        if (j < w->to) {
            const double *next = q[1].n;
            t->centre -= 2.0 * (n0 * next[0] + n1 * next[1]);
            t->mass += 2.0 * (fabs(n0 * next[0]) + fabs(n1 * next[1]));
        }
        t->far = larger(t->far, q->far);
        for (int i = 0; i < WAVES; i++) {
            const double s = q->sine[i], co = q->cosine[i], p = w->p[i], h = w->h[i];
            const double A = m[i] * co - omega[i] * s, B = -omega[i] * co - m[i] * s;
            const double a = q->straight[i], bow = q->bowed[i];
            const double wide = felt(i, q->reach[0], q->reach[1]);
            const double weight = omega[i] + fabs(m[i]) + TINY;
            double c[COLUMNS], f[COLUMNS];

            q->A[i] = A;
            q->B[i] = B;
            if (size(w, i) == 0.0)
                continue;
            t->centre -= omega[i] * p * s;
            t->mass += omega[i] * fabs(p) + weight * (size(w, i) * wide * wide + h + w->loose[i])
                                            * ((1.0 + wide) * square(1.0 + wide));
            t->rest += remainder_of(w, q, i);
            t->cubes += fabs(p) * a * (fabs(A) * bow + fabs(B) * a * a * (1.0 / 6.0))
                        + h * (fabs(B) * bow + fabs(A) * 0.5 * a * a);
            along[i] += A;
            for (int k = 0; k < columns; k++) {
                c[k] = felt(i, q->column[0][k], q->column[1][k]);
                f[k] = -0.5 * p * A * c[k];
            }
            f[w->symbol[i]] += h * B;
            for (int k = 0, kl = 0; k < columns; k++) {         /* (c.e) (f.e) */
                w->square[kl++] += c[k] * f[k];
                for (int l = k + 1; l < columns; l++)
                    w->square[kl++] += c[k] * f[l] + c[l] * f[k];
            }
        }
        /* what (2) leaves, and what the centre's steps missed */
        for (int i = 0; i < 2; i++) {
            const double before = q[-1].mu[i], after = q[1].mu[i];
            const double left = 4.0 * q->fuzz * weights + 0x1p-50 * (fabs(before) + fabs(after));
            if (j == ORIGIN || j == ORIGIN + 1) {
                const double steep = q->gradient[i] + q->beta[i] * mu0 + q->beta[i + 1] * mu1
                                     - before - after;
                t->mass += fabs(steep) * q->reach[i];
                if (j == ORIGIN)
                    t->rest += fabs(steep) * q->reach[i];
                else
                    w->slope[i] = steep * q->column[i][i];
            }
            t->rounding += left * q->reach[i];
            if (j > w->from && j < w->until)
                t->rounding += fabs(q->mu[i]) * q->missed[i];
        }
    }
    for (int i = 0; i < WAVES; i++)
        w->slope[w->symbol[i]] += w->h[i] * along[i];
    tails = w->l * (square(w->orbit[w->from].n[0]) + square(w->orbit[w->from].n[1])
                    + square(w->orbit[w->to].n[0]) + square(w->orbit[w->to].n[1]));
    t->centre -= tails;
    t->mass += tails;
}

/* The cubic part of (4): cubic[m] at pair(k, l) is a coefficient of e_m e_k e_l, one of those that
   make it up.  The third wave's c is the sum of the others'. */
INLINE void sum_cubic(loewner *w, int columns)
{
    const int pairs = columns * (columns + 1) / 2;

    for (int j = w->from; j <= w->until; j++) {
        const point *q = w->orbit + j;
        double form[WAVES][PAIRS];
        for (int i = 0; i < WAVES; i++) {
            const double A = q->A[i], B = q->B[i], h = w->h[i];
            const double pA = w->p[i] * A, third = w->p[i] * B * (1.0 / 3.0);
            double *const moved = w->cubic[w->symbol[i]];
            for (int k = 0, kl = 0; k < columns; k++) {
                const double c = felt(i, q->column[0][k], q->column[1][k]);
                for (int l = k; l < columns; l++, kl++) {
                    const double half = l == k ? 0.5 : 1.0;     /* of (c.e)^2/2 */
                    const double cc = half * c * felt(i, q->column[0][l], q->column[1][l]);
                    const double bow = felt(i, q->bow[0][kl], q->bow[1][kl]);
                    form[i][kl] = -pA * bow - third * cc;
                    if (h > 0.0)
                        moved[kl] += h * (B * bow - A * cc);
                }
            }
        }
        for (int m = 0; m < columns; m++)
            for (int kl = 0; kl < pairs; kl++)
                w->cubic[m][kl] += q->column[0][m] * (form[0][kl] + form[2][kl])
                                   + q->column[1][m] * (form[1][kl] + form[2][kl]);
    }
}

/* At least the largest value over the cube of the part with signs; without its cubic terms if they
   are not summed.  e_k^2 lies between 0 and 1: half of its coefficient counts, and half of the
   coefficient's size; that of e_k^2 e_l likewise with e_l, and of that of
   e_k^3 = 3/4 e_k + (4 e_k^3 - 3 e_k)/4 three quarters, and a quarter.  What remains is linear in
   each symbol and largest at a corner, where it is even + odd or even - odd. */
INLINE double summit(const loewner *w, int columns, int with_cubic)
{
    double slope[COLUMNS], triple[COLUMNS][COLUMNS][COLUMNS], sum = 0.0, top = -HUGE_VAL;

    for (int k = 0; k < columns; k++) {
        slope[k] = w->slope[k];
        sum += larger(0.0, w->square[pair(columns, k, k)]);
    }
    for (int k = 0; k < columns && with_cubic; k++)
        for (int l = 0; l < columns; l++) {
            const double *const linear = w->cubic[l], *const other = w->cubic[k];
            const double x = linear[pair(columns, k, k)]
                             + (l == k ? 0.0 : other[pair(columns, k, l)]);
            slope[l] += (l == k ? 0.75 : 0.5) * x;
            sum += (l == k ? 0.25 : 0.5) * fabs(x);
            for (int m = l + 1; m < columns && k < l; m++)
                triple[k][l][m] = w->cubic[k][pair(columns, l, m)]
                                  + w->cubic[l][pair(columns, k, m)]
                                  + w->cubic[m][pair(columns, k, l)];
        }
    for (int corner = 0; corner < 1 << (columns - 1); corner++) {
        double odd = 0.0, even = 0.0, sign[COLUMNS];
        for (int k = 0; k < columns; k++)
            sign[k] = corner >> k & 1 ? -1.0 : 1.0;
        for (int k = 0; k < columns; k++) {
            double mixed = 0.0, cubic = slope[k];
            for (int l = k + 1; l < columns; l++) {
                mixed += sign[l] * w->square[pair(columns, k, l)];
                for (int m = l + 1; m < columns && with_cubic; m++)
                    cubic += sign[l] * sign[m] * triple[k][l][m];
            }
            even += sign[k] * mixed;
            odd += sign[k] * cubic;
        }
        top = larger(top, even + fabs(odd));
    }
    return sum + top;
}

/* The mass is the sum of the absolute values of all that is summed with signs, and of what A and B
   are multiplied by anywhere, with omega + |m| in their place: with rho = a + b that is at most
   |p| (e^rho - 1 - rho) + h e^rho + loose (1 + rho) to the fifth order in rho, of which
   (size rho^2 + h + loose)(1 + rho)^3 is more; for the wave that both coordinates feel rho is the
   sum of theirs, as its cubic form is shared out among them.  A and B are off by (9 + far) u of
   omega + |m|, products of them by 12 u more.  At each of N sites at most 5 numbers are added to a
   sum, and each addition rounds by u of the partial sums; summit and the last sums make 45 of them.
   So all is off by (5 N + 57) u and (9 + far) u of the mass, where `each` is 64 (N + 1) u and
   2^-49 (1 + far) is 16 (1 + far) u.  Positive sums are off by (5 N + 30) u of themselves, which
   `each` covers, too.  (2) leaves at most 11 u (1 + sizes)(1 + far) of the weights and 2 u of the
   neighbours' mu; `left` has 64 and 8. */
INLINE void bound_with(loewner *w, int signs, int columns)
{
    const double each = 0x1p-47 * (double)(w->until - w->from + 2);
    sums t = { 0, 0, 0, 0, 0, 0 };
    double least, more;

    sum_up(w, &t, columns);
    t.rounding += t.mass * (each + 0x1p-49 * (1.0 + t.far));
    w->rounding = t.rounding * (1.0 + each);
    more = t.centre + (t.rest + w->rounding) * (1.0 + each);
    least = more + summit(w, columns, 0);
    w->bound = least + t.cubes * (1.0 + each);
    if (signs || (least < 0.0 && w->bound >= 0.0)) {
        sum_cubic(w, columns);
        w->bound = more + summit(w, columns, 1);
    }
    if (!(t.mass >= 1.0))
        w->bound = HUGE_VAL;
}

void bound_second_variation(loewner *w, int signs)
{
    set_multipliers(w);
    memset(w->slope, 0, sizeof w->slope);
    memset(w->square, 0, sizeof w->square);
    memset(w->cubic, 0, sizeof w->cubic);
    switch (w->columns) {
    case 2: bound_with(w, signs, 2); break;
    case 3: bound_with(w, signs, 3); break;
    case 4: bound_with(w, signs, 4); break;
    default: bound_with(w, signs, 5);
    }
}

/* By how much, to first order, the bound falls with the width of each column: each term times its
   degree in it.  The remainder is of fourth order, and shared like the reaches. */
void bound_shares(loewner *w)
{
    const int columns = w->columns;

    for (int k = 0; k < columns; k++)
        w->share[k] = fabs(w->slope[k]);
    for (int k = 0; k < columns; k++)
        for (int l = k; l < columns; l++) {
            const double x = w->square[pair(columns, k, l)];
            w->share[k] += l == k ? larger(0.0, x) : fabs(x);
            w->share[l] += l == k ? larger(0.0, x) : fabs(x);
            for (int m = 0; m < columns; m++) {
                const double y = fabs(w->cubic[m][pair(columns, k, l)]);
                w->share[k] += y;
                w->share[l] += y;
                w->share[m] += y;
            }
        }
    for (int j = w->from; j <= w->until; j++) {
        const point *q = w->orbit + j;
        for (int i = 0; i < WAVES; i++)
            if (size(w, i) > 0.0 && q->reach[i] > 0.0) {
                const double part = 4.0 * remainder_of(w, q, i) / q->reach[i];
                for (int k = 0; k < columns; k++)
                    w->share[k] += part * fabs(felt(i, q->column[0][k], q->column[1][k]));
            }
    }
}
