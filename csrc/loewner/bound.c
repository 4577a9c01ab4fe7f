/* bound.c - the second variation over a whole prism, by multipliers.

   Let x[j] be the orbit of the centre and x[j] + D[j] any true one, on which
   E[j] = 2x[j] - x[j-1] - x[j+1] - V'(x[j]) = 0.  So for any multipliers mu, zero but at sites both
   of whose neighbours are in the orbit, the sum Q + sum mu[j].E[j] is Q, and with

       mu[j-1] = gradient of n[j].beta(x[j])n[j] + beta(x[j])mu[j] - mu[j+1]  from the future,  (2)

   and the same from the past, all terms linear in the D[j] cancel, except the terms in D[0] and
   D[1], which are the prism itself.  (2) is an identity in exact arithmetic; in doubles its
   residual is multiplied by |D[j]| and added.  With omega = (n.u)^2, m = mu.u, z = u.D,
   A = m cos y - omega sin y and B = -omega cos y - m sin y, each wave leaves

       p (A (cos z - 1) + B (sin z - z)) + (p' - p)(A cos z + B sin z),   p' = p + h e + w.      (3)

   With z = c.e + T + r and Taylor's series, (3) has in the symbols

       linear     h e A
       quadratic  -pA (c.e)^2/2 + h e B (c.e)
       cubic      -pA (c.e) T - pB (c.e)^3/6 + h e (B T - A (c.e)^2/2)                          (4)

   with signs, and summed over the orbit before it is bounded.  With a >= |c.e|, b >= |T| + |r|,
   rho >= |z| the rest is at most

       |p| (|A| (a |r| + (pA > 0 ? rho^4/24 : b^2/2)) + |B| (b (3a^2 + 3ab + b^2)/6 + rho^5/120))
       + h (|A| (b (2a + b)/2 + rho^4/24) + |B| (|r| + rho^3/6))
       + err_amp (|A| + |B| rho).                                                         (5) */
#include "arith/sum2.h"
#include "prism.h"

/* The sites that are summed over in the lanes that are active. */
static int begin_of(const batch *w, mask active) { return extreme(active, w->since, -1); }
static int end_of(const batch *w, mask active) { return extreme(active, w->until, 1); }

static mask within(const batch *w, int j)
{
    const uint64_t site = (uint64_t)j;

    return TRUTH(w->since <= site) & TRUTH(site <= w->until);
}

/* The gradient of n.beta n plus beta mu at a site: by (2), the sum of mu at both neighbours. */
INLINE vec steepness(const batch *w, const point *q, int i)
{
    vec times[N];

    sym_times(N, times, q->beta, q->mu);
    return times[i] - gradient(w, q, i);
}

/* The multipliers of the lanes that are active, by (2): zero outside, and from either end up to
   the sites 0 and 1. */
static void set_multipliers(batch *w, mask active)
{
    const int begin = begin_of(w, active), end = end_of(w, active);
    point *const ends[] = { site_of(w, begin - 1), site_of(w, begin), site_of(w, end),
                            site_of(w, end + 1) };

    for (int j = 0; j < 4; j++)
        for (int i = 0; i < N; i++)
            ends[j]->mu[i] = pick(active, every(0.0), ends[j]->mu[i]);
    for (int j = end; j > ORIGIN + 1; j--) {
        const mask now = within(w, j);
        point *const q = site_of(w, j);
        for (int i = 0; i < N; i++) {
            const vec mu = pick(now, steepness(w, q, i) - q[1].mu[i], every(0.0));
            q[-1].mu[i] = pick(active, mu, q[-1].mu[i]);
        }
    }
    for (int j = begin; j < ORIGIN; j++) {
        const mask now = within(w, j);
        point *const q = site_of(w, j);
        for (int i = 0; i < N; i++) {
            const vec mu = pick(now, steepness(w, q, i) - q[-1].mu[i], every(0.0));
            q[1].mu[i] = pick(active, mu, q[1].mu[i]);
        }
    }
}

/* The sums of a pass over the orbit: vectors only, of which as many as used_of are in use. */
typedef struct {
    vec centre, mass, rest, cubes, rounding, left;
    vec slope[COLUMNS], square[PAIRS], along[SLOTS];
} sums;

static size_t used_of(const batch *w)
{
    return offsetof(sums, along) / sizeof(vec) + (size_t)waves_of(w);
}

/* Sites are summed in blocks of so many, and then the blocks.  The roundings of the second sum are
   summed separately, so the error of a sum grows with BLOCK, and not with the number of sites. */
enum { BLOCK = 16 };
_Static_assert(MOST_WAVES <= 16 && MAX_POINTS / BLOCK + 2 < 1 << 14, "bound_with counts these");

/* Adds the vectors of a block's sums to the total, and begins the block anew. */
static void add_block(vec total[], vec lost[], vec block[], size_t vectors)
{
    for (size_t k = 0; k < vectors; k++) {
        const sum2 sum = sum2_of_sum(total[k], block[k]);
        total[k] = sum.high;
        lost[k] += sum.low;
        block[k] = every(0.0);
    }
}

/* Adds the last block, and what was lost. */
static void end_blocks(vec total[], vec lost[], vec block[], size_t vectors)
{
    add_block(total, lost, block, vectors);
    for (size_t k = 0; k < vectors; k++)
        total[k] += lost[k];
}

/* Sets the numbers of site q for each wave that depend on the prisms alone: (5) is
   |A| rest_A[pA > 0] + |B| rest_B, the cubic part of (4) without its signs |A| cube_A + |B| cube_B,
   and `load` is for the mass, below. */
static void weigh(const batch *w, point *q)
{
    q->load = every(0.0);
    FOR_WAVES(w, i) {
        const vec p = mag(w->p[i]), h = w->h[i], err_amp = w->err_amp[i], rho = q->rad[i];
        const vec a = q->lin_bound[i], b = q->nonlin_bound[i], r = rem_along(w, q, i);
        const vec half_square = 0.5 * rho * rho, quad = q->quad_bound[i];
        const vec fourth = half_square * half_square * (1.0 / 6.0);
        const vec either = p * (a * r) + h * (b * (a + 0.5 * b) + fourth) + err_amp;

        q->rest_A[0][i] = either + p * (0.5 * b * b);
        q->rest_A[1][i] = either + p * fourth;
        q->rest_B[i] = p * (b * (0.5 * a * (a + b) + b * b * (1.0 / 6.0)) + 0.2 * rho * fourth) +
                       h * (r + rho * half_square * (1.0 / 3.0)) + err_amp * rho;
        q->cube_A[i] = p * (a * quad) + h * (0.5 * a * a);
        q->cube_B[i] = p * (a * a * a * (1.0 / 6.0)) + h * quad;
        q->load += (w->size[i] * rho * rho + h + err_amp) * ((1.0 + rho) * square(1.0 + rho));
    }
}

/* omega and m of all slots at a site.  Half of omega at a mirror. */
INLINE void weights_along(const batch *w, const point *q, vec omega[], vec m[])
{
    const double half = is_mirror(w, ORIGIN) && q == site_of(w, ORIGIN) ? 0.5 : 1.0;

    for (int i = 0; i < waves_of(w); i++) {
        omega[i] = half * square(dot_k(w, i, q->n));
        m[i] = dot_k(w, i, q->mu);
    }
}

/* A and B of one wave. */
INLINE void trig_coefficients(const point *q, int i, const vec omega[], const vec m[], vec *A,
                              vec *B)
{
    *A = m[i] * q->cosine[i] - omega[i] * q->sine[i];
    *B = -omega[i] * q->cosine[i] - m[i] * q->sine[i];
}

/* (5), of one wave. */
INLINE vec remainder_of(const batch *w, const point *q, int i, vec A, vec B)
{
    return mag(A) * pick(TRUTH(w->p[i] * A > 0.0), q->rest_A[1][i], q->rest_A[0][i]) +
           mag(B) * q->rest_B[i];
}

/* Adds the terms of (1) at a site that have no wave in them: 2|n|^2, and -2 n.n' to the next site
   where there is a link. */
INLINE void sum_links(sums *t, const point *q, mask linked, const vec omega[])
{
    vec squares = every(0.0), links = every(0.0), sizes = every(0.0);

    for (int i = 0; i < N; i++) {
        const vec link = pick(linked, q->n[i] * q[1].n[i], every(0.0));
        squares += omega[i];
        links += link;
        sizes += mag(link);
    }
    t->centre += 2.0 * squares;
    t->mass += 2.0 * squares;
    t->centre -= 2.0 * links;
    t->mass += 2.0 * sizes;
}

/* Adds what a wave makes of the prism at a site, except its cubic part with signs. */
INLINE void sum_wave(const batch *w, sums *t, const point *q, int i, const vec omega[],
                     const vec m[])
{
    const int columns = w->problem->columns;
    const vec p = w->p[i];
    vec A, B, c[COLUMNS], f[COLUMNS];

    trig_coefficients(q, i, omega, m, &A, &B);
    t->centre -= omega[i] * p * q->sine[i];
    t->mass += omega[i] * mag(p);
    t->rest += remainder_of(w, q, i, A, B);
    t->cubes += mag(A) * q->cube_A[i] + mag(B) * q->cube_B[i];
    t->along[i] += A;
    for (int k = 0; k < columns; k++) {
        c[k] = dot_k(w, i, q->lin[k]);
        f[k] = -0.5 * p * A * c[k];
    }
    add_moves(w, i, B, f);
    for (int k = 0, kl = 0; k < columns; k++) {                 /* (c.e) (f.e) */
        t->square[kl++] += c[k] * f[k];
        for (int l = k + 1; l < columns; l++)
            t->square[kl++] += c[k] * f[l] + c[l] * f[k];
    }
}

/* Adds what (2) leaves at site j, and what the centre's step missed there. */
INLINE void sum_left(const batch *w, sums *t, const point *q, int j, vec weights)
{
    const uint64_t site = (uint64_t)j;
    const mask inside = TRUTH(w->since < site) & TRUTH(site < w->until);

    if (is_mirror(w, j))
        return; /* mu is odd about it, and what (2) leaves is 0 */
    for (int i = 0; i < N; i++) {
        const vec before = q[-1].mu[i], after = q[1].mu[i];
        const vec left = 4.0 * q->err_beta * weights + 0x1p-50 * (mag(before) + mag(after));
        if (j == ORIGIN || j == ORIGIN + 1) {
            const vec steep = steepness(w, q, i) - before - after;
            t->mass += mag(steep) * q->rad[i];
            t->rest += mag(steep) * q->nonlin_bound[i];
            for (int k = 0; k < w->problem->columns; k++)
                t->slope[k] += steep * q->lin[k][i];
            t->rounding += left * q->rad[i];
        } else {
            t->left += left * q->rad[i];
        }
        t->rounding += pick(inside, mag(q->mu[i]) * w->residual[i], every(0.0));
    }
}

/* |n|^2 at the ends of the lanes that are active, which the tails begin with. */
static vec ends_of(const batch *w, mask active)
{
    vec squares = every(0.0);

    for (int k = 0; k < LANES; k++)
        if (holds(&active, k)) {
            const int from = number(&w->from, k);
            const point *const first = site_of(w, from), *const last =
                                                             site_of(w, number(&w->to, k));
            double sum = 0.0;
            for (int i = 0; i < N; i++)
                sum += (is_mirror(w, from) ? 0.0 : at(&first->n[i], k) * at(&first->n[i], k)) +
                       at(&last->n[i], k) * at(&last->n[i], k);
            put_at(&squares, k, sum);
        }
    return squares;
}

/* Sums the constant, linear and quadratic part, and what is bounded by absolute values; `cubes` is
   the cubic part, bounded in the same way.  Outside of a lane's own sites n and mu are zero, and
   all else is finite. */
static void sum_up(batch *w, sums *total, mask active)
{
    const int begin = begin_of(w, active), end = end_of(w, active);
    sums t, lost;

    memset(&t, 0, sizeof t);
    memset(&lost, 0, sizeof lost);
    memset(total, 0, sizeof *total);
    for (int j = begin; j <= end; j++) {
        const point *const q = site_of(w, j);
        vec omega[SLOTS], m[SLOTS];

        weights_along(w, q, omega, m);
        const vec tiny = pick(within(w, j), every(TINY), every(0.0));
        const vec weights = weights_of(w, omega, m) + tiny;
        sum_links(&t, q, TRUTH((uint64_t)j < w->to), omega);
        t.mass += weights * q->load;
        FOR_WAVES(w, i)
            sum_wave(w, &t, q, i, omega, m);
        sum_left(w, &t, q, j, weights);
        if (j % BLOCK == 0)
            add_block((vec *)total, (vec *)&lost, (vec *)&t, used_of(w));
    }
    end_blocks((vec *)total, (vec *)&lost, (vec *)&t, used_of(w));
    FOR_WAVES(w, i)
        add_moves(w, i, total->along[i], total->slope);
    const vec tails = w->l * ends_of(w, active);
    total->centre -= tails;
    total->mass += tails;
}

/* k.x, as a sum of two doubles. */
INLINE sum2 exact_dot_k(const batch *w, int wave, const vec x[N])
{
    sum2 sum = sum2_of_product(every(k_of(w, wave)[0]), x[0]);

    for (int i = 1; i < N; i++)
        sum = sum2_plus(sum, sum2_of_product(every(k_of(w, wave)[i]), x[i]));
    return sum;
}

/* p (m sin y + omega cos y) of a wave at a site, as a sum of two doubles.  Sines are off by 2^-100,
   and by 2^-61 more if the wave has a phase (wave_at). */
INLINE sum2 exact_pull(const batch *w, const point *q, int wave)
{
    const mask angle = angle_of(w, q, wave);
    const sum2 p = { w->p[wave], w->p_low[wave] };
    const sum2 m = exact_dot_k(w, wave, q->mu), n = exact_dot_k(w, wave, q->n);
    const sum2 sine = fine_sine(angle), cosine = fine_sine(angle + QUARTER_TURN);

    return sum2_times(p, sum2_plus(sum2_times(m, sine), sum2_times(sum2_times(n, n), cosine)));
}

/* Where roundings alone keep the bound from being negative: what (2) leaves at the sites but 0 and
   1, G, is computed with twice the digits of a double, and belongs to the slopes with its sign,

       G.D = G.L e + G.(T + r),
       G = 2 mu - mu[j-1] - mu[j+1] - sum of k p (m sin y + omega cos y).

   So instead of roundings of g and beta that are added up over the orbit by their absolute values
   there are those of mu, with signs.  All roundings, at most 200 operations on sums of two between
   any number and the result, are 2^-95 of the absolute values.  `left` has 2^-90 of these and of S
   times the weights, or with phases 2^-60 of the latter, and 2^-80 of the neighbours' mu. */
static void leave_exactly(batch *w, sums *total, mask active)
{
    const int columns = w->problem->columns, begin = begin_of(w, active), end = end_of(w, active);
    sums t, lost;

    memset(&t, 0, sizeof t);
    memset(&lost, 0, sizeof lost);
    total->left = pick(active, every(0.0), total->left);
    for (int j = begin; j <= end; j++) {
        const point *const q = site_of(w, j);
        const mask own = active & within(w, j);
        vec omega[SLOTS], m[SLOTS];
        sum2 pull[SLOTS];

        if (j == ORIGIN || j == ORIGIN + 1)
            continue;
        weights_along(w, q, omega, m);
        FOR_WAVES(w, i)
            pull[i] = exact_pull(w, q, i);
        const vec weights = weights_of(w, omega, m) + TINY;
        const vec sizes = q->err_beta * (1.0 / grain_of(w));
        for (int i = 0; i < N; i++) {
            const vec before = q[-1].mu[i], after = q[1].mu[i];
            sum2 G = sum2_plus(sum2_of_sum(2.0 * q->mu[i], -before), (sum2){ -after, every(0.0) });
            FOR_WAVES(w, wave) {
                const vec k = every(-k_of(w, wave)[i]);
                G = sum2_plus(G, sum2_times((sum2){ k, every(0.0) }, pull[wave]));
            }
            const vec leaves = pick(own, G.high, every(0.0));
            const vec left = w->problem->err_pull * sizes * weights +
                             0x1p-80 * (mag(before) + mag(after)) + 0x1p-51 * mag(leaves);
            t.left += pick(own, left * q->rad[i], every(0.0));
            t.mass += mag(leaves) * q->rad[i];
            t.rest += mag(leaves) * q->nonlin_bound[i];
            for (int k = 0; k < columns; k++)
                t.slope[k] += leaves * q->lin[k][i];
        }
        if (j % BLOCK == 0)
            add_block((vec *)total, (vec *)&lost, (vec *)&t, used_of(w));
    }
    end_blocks((vec *)total, (vec *)&lost, (vec *)&t, used_of(w));
}

/* The cubic part of (4): cubic[n] at sym_at(k, l) is a coefficient of e_n e_k e_l, one of those
   that make it up. */
static void sum_cubic(batch *w, mask active)
{
    const int columns = w->problem->columns, begin = begin_of(w, active), end = end_of(w, active);
    vec block[COLUMNS][PAIRS], lost[COLUMNS][PAIRS];

    memset(block, 0, sizeof block);
    memset(lost, 0, sizeof lost);
    for (int j = begin; j <= end; j++) {
        const point *q = site_of(w, j);
        const mask now = active & within(w, j);
        vec form[SLOTS][PAIRS], omega[SLOTS], m[SLOTS];
        weights_along(w, q, omega, m);
        FOR_WAVES(w, i) {
            vec A, B;
            trig_coefficients(q, i, omega, m, &A, &B);
            const vec pA = w->p[i] * A, third = w->p[i] * B * (1.0 / 3.0);
            for (int k = 0, kl = 0; k < columns; k++) {
                const vec c = dot_k(w, i, q->lin[k]);
                for (int l = k; l < columns; l++, kl++) {
                    const double half = l == k ? 0.5 : 1.0;     /* of (c.e)^2/2 */
                    const vec cc = half * c * dot_k(w, i, q->lin[l]);
                    const vec quad = dot_k(w, i, q->quad[kl]);
                    form[i][kl] = -pA * quad - third * cc;
                    for (int n = N; n < columns; n++)
                        if (w->problem->moves[i][n])
                            block[n][kl] +=
                                pick(now, w->part[i][n] * (B * quad - A * cc), every(0.0));
                }
            }
        }
        for (int n = 0; n < columns; n++) {                     /* (c.e) form[e, e] */
            vec c[SLOTS];
            FOR_WAVES(w, i)
                c[i] = dot_k(w, i, q->lin[n]);
            for (int kl = 0; kl < columns * (columns + 1) / 2; kl++) {
                vec sum = every(0.0);
                FOR_WAVES(w, i)
                    sum += c[i] * form[i][kl];
                block[n][kl] += pick(now, sum, every(0.0));
            }
        }
        if (j % BLOCK == 0)
            add_block(w->cubic[0], lost[0], block[0], COLUMNS * PAIRS);
    }
    end_blocks(w->cubic[0], lost[0], block[0], COLUMNS * PAIRS);
}

/* At least the largest value over the cube of the part with signs; without its cubic terms if they
   are not summed.  e_k^2 lies between 0 and 1: half of its coefficient counts, and half of the
   coefficient's size.  The same holds for e_k^2 e_l with e_l, and for
   e_k^3 = 3/4 e_k + (4 e_k^3 - 3 e_k)/4 with three quarters and a quarter.  The rest is linear in
   each symbol and largest at a corner, where the rest is even + odd or even - odd. */
static vec summit(const batch *w, int with_cubic)
{
    const int columns = w->problem->columns;
    vec slope[COLUMNS], triple[COLUMNS][COLUMNS][COLUMNS], sum = every(0.0);
    vec top = every(-HUGE_VAL);

    for (int k = 0; k < columns; k++) {
        slope[k] = w->slope[k];
        sum += larger(every(0.0), w->square[sym_at(columns, k, k)]);
    }
    for (int k = 0; k < columns && with_cubic; k++)
        for (int l = 0; l < columns; l++) {
            const vec *const linear = w->cubic[l], *const other = w->cubic[k];
            const vec more = l == k ? every(0.0) : other[sym_at(columns, k, l)];
            const vec x = linear[sym_at(columns, k, k)] + more;
            slope[l] += (l == k ? 0.75 : 0.5) * x;
            sum += (l == k ? 0.25 : 0.5) * mag(x);
            for (int m = l + 1; m < columns && k < l; m++)
                triple[k][l][m] = w->cubic[k][sym_at(columns, l, m)] +
                                  w->cubic[l][sym_at(columns, k, m)] +
                                  w->cubic[m][sym_at(columns, k, l)];
        }
    for (int corner = 0; corner < 1 << (columns - 1); corner++) {
        vec odd = every(0.0), even = every(0.0);
        double sign[COLUMNS];
        for (int k = 0; k < columns; k++)
            sign[k] = corner >> k & 1 ? -1.0 : 1.0;
        for (int k = 0; k < columns; k++) {
            vec mixed = every(0.0), cubic = slope[k];
            for (int l = k + 1; l < columns; l++) {
                mixed += sign[l] * w->square[sym_at(columns, k, l)];
                for (int m = l + 1; m < columns && with_cubic; m++)
                    cubic += sign[l] * sign[m] * triple[k][l][m];
            }
            even += sign[k] * mixed;
            odd += sign[k] * cubic;
        }
        top = larger(top, even + mag(odd));
    }
    return sum + top;
}

/* The bound of (1), of its sums.

   The mass is the sum of the absolute values of all that is summed with signs, and of what A and B
   are multiplied by anywhere, with omega + |m| in their place: with rho = a + b that is at most |p|
   (e^rho - 1 - rho) + h e^rho + err_amp (1 + rho) to the fifth order in rho, of which (size rho^2 +
   h + err_amp)(1 + rho)^3 is more.  (`load` is that of all waves, and the weights are at least each
   omega + |m|.)  Sines are off by 1.01 u, omega and m by 7 u, and two products and a sum make A and
   B off by 12 u of the weights; products of them, p among these, by 15 u more.  At each site at
   most 22 numbers, of 16 waves, are added to a sum, and each addition rounds by u of the partial
   sums of its block, of n = min(N, BLOCK) sites.  The blocks are fewer than 2^14, so the sum of
   what they lose is off by 2^28 u^2, and this and what it is added to by u.  Summit and the last
   sums make 60 additions.  So all is off by (22 n + 91) u of the mass, where `each` has 32 n + 128.
   Positive sums are off by (22 n + 34) u of themselves, which `each` also covers.  In leave_exactly
   the sites ORIGIN and ORIGIN + 1 end no block; a block has 2 n sites at most, of 2 additions each,
   which are fewer than 22 n.  (2) leaves at most (13 + N') u (1 + S) of the weights, N' waves, and
   2 u of the neighbours' mu; `left` has 4 (14 + N')(1 + S) and 8. */
static void bound_with(batch *w, mask active, int signs)
{
    const int columns = w->problem->columns;
    vec each = every(0.0), least, more, bound, rounding;
    mask refine, again;
    sums t;

    for (int k = 0; k < LANES; k++) {
        const int sites = number(&w->until, k) - number(&w->since, k) + 1;
        assert(!holds(&active, k) || (2 <= sites && sites <= MAX_POINTS));
        put_at(&each, k, 0x1p-53 * (32.0 * (sites < BLOCK ? sites : BLOCK) + 128.0));
    }
    sum_up(w, &t, active);
    for (int pass = 0; any(active) && pass < 2; pass++) {
        for (int k = 0; k < columns; k++)
            w->slope[k] = pick(active, t.slope[k], w->slope[k]);
        for (int kl = 0; kl < columns * (columns + 1) / 2; kl++) {
            w->square[kl] = pick(active, t.square[kl], w->square[kl]);
            for (int m = 0; m < columns; m++)
                w->cubic[m][kl] = pick(active, every(0.0), w->cubic[m][kl]);
        }
        rounding = (t.rounding + t.left + t.mass * each) * (1.0 + each);
        more = t.centre + (t.rest + rounding) * (1.0 + each);
        least = more + summit(w, 0);
        bound = least + t.cubes * (1.0 + each);
        refine = active & (signs ? active : TRUTH(least < 0.0) & TRUTH(bound >= 0.0));
        if (any(refine)) {
            sum_cubic(w, refine);
            bound = pick(refine, more + summit(w, 1), bound);
        }
        bound = pick(TRUTH(t.mass >= 1.0), bound, every(HUGE_VAL));
        w->bound = pick(active, bound, w->bound);
        w->rounding = pick(active, rounding, w->rounding);
        again = active & TRUTH(bound >= 0.0) & TRUTH(bound - 2.0 * t.left < 0.0);
        active = again;
        if (pass == 0 && any(active))
            leave_exactly(w, &t, active);
    }
}

/* w->bound >= (1) over the whole prism, whatever n is, in the lanes that are active, which need a
   witness; w->rounding: how much of it roundings are.  The cubic terms are bounded by absolute
   values unless their signs might make the bound negative, or are asked for. */
static void bound_second_variation(batch *w, mask active, int signs)
{
    while (w->weighed_last < w->known_last)
        weigh(w, site_of(w, ++w->weighed_last));
    while (w->weighed_first > w->known_first)
        weigh(w, site_of(w, --w->weighed_first));
    set_multipliers(w, active);
    bound_with(w, active, signs);
}

/* w->share[k] after that: by how much, to first order, the bound falls with the width of each
   column: each term times its degree in it.  The remainder is of fourth order, and shared like the
   rads. */
static void bound_shares(batch *w, mask active)
{
    const int columns = w->problem->columns, begin = begin_of(w, active), end = end_of(w, active);

    for (int k = 0; k < columns; k++)
        w->share[k] = mag(w->slope[k]);
    for (int k = 0; k < columns; k++)
        for (int l = k; l < columns; l++) {
            const vec x = w->square[sym_at(columns, k, l)];
            const vec part = l == k ? larger(every(0.0), x) : mag(x);
            w->share[k] += part;
            w->share[l] += part;
            for (int m = 0; m < columns; m++) {
                const vec y = mag(w->cubic[m][sym_at(columns, k, l)]);
                w->share[k] += y;
                w->share[l] += y;
                w->share[m] += y;
            }
        }
    for (int j = begin; j <= end; j++) {
        const point *q = site_of(w, j);
        const mask now = active & within(w, j);
        vec omega[SLOTS], m[SLOTS];
        weights_along(w, q, omega, m);
        FOR_WAVES(w, i) {
            const mask some = now & TRUTH(q->rad[i] > 0.0);
            vec A, B;
            trig_coefficients(q, i, omega, m, &A, &B);
            const vec part = 4.0 * remainder_of(w, q, i, A, B) / q->rad[i];
            for (int k = 0; k < columns; k++) {
                const vec more = part * mag(dot_k(w, i, q->lin[k]));
                w->share[k] += pick(some, more, every(0.0));
            }
        }
    }
}
