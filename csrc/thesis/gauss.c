/* gauss.c - the inverse of the corner of A that belongs to u and v: Gauss-Jordan with full
   pivoting, and a bound on the error of every entry (thesis, Appendix B, "matrix inversion"). */

enum { MAX_RECUR = 12 };                /* tries, each with more digits than the last */

/* Rounding and quotients to inv_dp places, not to those of the state. */
#ifdef NUM_DOUBLE

static void round_to(num_t x, long inv_dp, apm_round_t dir)
{
    (void)x;
    (void)inv_dp;
    (void)dir;
}

static int quotient(num_t r, const num_t x, const num_t y, long inv_dp, apm_round_t dir)
{
    (void)inv_dp;
    (void)dir;
    r[0] = x[0] / y[0];
    return 0;
}

#else

static void round_to(num_t x, long inv_dp, apm_round_t dir) { apm_round(x, x, inv_dp, dir); }

static int quotient(num_t r, const num_t x, const num_t y, long inv_dp, apm_round_t dir)
{
    return apm_div(r, x, y, inv_dp, dir);
}

#endif

/* m = its own inverse, to inv_dp places; err = a bound of the error of every entry.  Returns 0,
   or 1 if a pivot may be zero.

   Let every entry be off by at most err from what exact arithmetic would have.  Then, with p
   the pivot and d = 10^-inv_dp,
       1/p is off by             piv_err = err / (|p| (|p| - err)) + d,
       the new pivot row by      row_err = err |1/p| + row_max piv_err + err piv_err,
       every other entry by      err (1 + new_max) + col_max row_err + err row_err,
   where row_max is the largest entry of the pivot row, a 1 standing in the place of p, new_max
   the largest after the division, and col_max the largest other entry of the pivot column;
   rounding adds d.  (Errata: the thesis has the first without the factor |p|; in the listing
   row_max is never increased from zero.) */
static int gauss_jordan(state *s, num_t m[TWO_DF][TWO_DF], num_t err, long inv_dp)
{
    numbers *n = &s->n;
    num_t *g = n->g;                                    /* piv_inv, piv_err, row_err, ... */
    int row_of[TWO_DF], col_of[TWO_DF], used[TWO_DF] = { 0 };

    num_set_si(err, 0, 0);
    num_set_si(g[7], 1, -inv_dp);
    for (int i = 0; i < TWO_DF; i++) {
        int row = 0, col = 0;
        num_set_si(g[0], -1, 0);
        for (int j = 0; j < TWO_DF; j++)
            for (int k = 0; k < TWO_DF; k++) {
                if (used[j] || used[k])
                    continue;
                num_abs(g[1], m[j][k]);
                if (num_cmp(g[1], g[0]) > 0) {
                    num_set(g[0], g[1]);
                    row = j;
                    col = k;
                }
            }
        used[col] = 1;
        for (int k = 0; row != col && k < TWO_DF; k++)
            num_swap(m[row][k], m[col][k]);
        row_of[i] = row;
        col_of[i] = col;

        num_sub(g[1], g[0], err);                       /* |p| - err; NaN fails, too */
        if (!(num_sgn(g[1]) > 0))
            return 1;
        num_mul(g[1], g[1], g[0]);
        num_set_si(g[4], 1, 0);
        if (quotient(g[2], g[4], m[col][col], inv_dp, APM_TRUNC) != 0 ||
            quotient(g[3], err, g[1], inv_dp, APM_UP) != 0)
            return 1;
        num_add(g[3], g[3], g[7]);                      /* piv_err */

        num_set_si(m[col][col], 1, 0);
        num_set_si(g[4], 0, 0);
        num_set_si(g[5], 0, 0);
        for (int k = 0; k < TWO_DF; k++) {
            num_abs(g[6], m[col][k]);
            num_max(g[4], g[6]);                        /* row_max */
            num_mul(m[col][k], m[col][k], g[2]);
            num_abs(g[6], m[col][k]);
            num_max(g[5], g[6]);                        /* new_max */
        }
        num_abs(g[6], g[2]);
        num_add(g[6], g[6], g[3]);
        num_mul(g[6], g[6], err);
        num_addmul(s, g[6], g[4], g[3]);                /* row_err */

        num_set_si(g[4], 0, 0);
        for (int j = 0; j < TWO_DF; j++) {
            if (j == col)
                continue;
            num_set(g[8], m[j][col]);
            num_abs(g[9], g[8]);
            num_max(g[4], g[9]);                        /* col_max */
            num_set_si(m[j][col], 0, 0);
            for (int k = 0; k < TWO_DF; k++) {
                num_submul(s, m[j][k], m[col][k], g[8]);
                round_to(m[j][k], inv_dp, APM_TRUNC);
            }
        }
        for (int k = 0; k < TWO_DF; k++)
            round_to(m[col][k], inv_dp, APM_TRUNC);
        num_set_si(g[8], 1, 0);
        num_add(g[8], g[8], g[5]);
        num_add(g[8], g[8], g[6]);
        num_mul(g[8], g[8], err);
        num_addmul(s, g[8], g[4], g[6]);
        num_max(g[8], g[6]);
        num_add(err, g[8], g[7]);
        round_to(err, inv_dp, APM_UP);
    }
    for (int i = TWO_DF - 1; i >= 0; i--)
        for (int k = 0; row_of[i] != col_of[i] && k < TWO_DF; k++)
            num_swap(m[k][row_of[i]], m[k][col_of[i]]);
    return 0;
}

/* inverse = that of the 4 x 4 corner of A, each entry off by at most inverse_err, which is at
   most 2 ulp; or inverse_failed is set.  Thesis: Rinvert_corner, Rgauss. */
static void invert_corner(state *s, num_t A[MAT_DIM][MAT_DIM])
{
    numbers *n = &s->n;
    long inv_dp = s->precision + 10;

    for (int recur = 0; recur < MAX_RECUR; recur++, inv_dp += 10 + inv_dp / 4) {
        int fails;
        for (int j = 0; j < TWO_DF; j++)
            for (int k = 0; k < TWO_DF; k++)
                num_set(n->gauss[j][k], A[U + j][U + k]);
        fails = gauss_jordan(s, n->gauss, n->inverse_err, inv_dp);
#ifndef NUM_DOUBLE
        fails = fails || num_cmp(n->inverse_err, n->ulp) > 0;
#endif
        if (!fails) {
            for (int j = 0; j < TWO_DF; j++)
                for (int k = 0; k < TWO_DF; k++)
                    num_round(s, n->inverse[j][k], n->gauss[j][k], APM_TRUNC);
            num_add(n->inverse_err, n->inverse_err, n->ulp);
            return;
        }
    }
    s->inverse_failed = 1;
}
