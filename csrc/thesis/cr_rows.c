/* cr_rows.c - the widths w for the column rotor. */

/* rows[j] += an upper bound over the prism of row j of |B1 S1 + B2 (beta S1 - S2)|, where B1 and
   B2 are blocks of the inverse, and S1 and S2 the blocks of P in the rows of v and of u and the
   columns from `col`.  beta = 2I - a sin v0 e0e0' - b sin v1 e1e1' - c sin(v0+v1) (1,1)(1,1)', so
   each entry is a constant and three multiples of bounded numbers.  Thesis: Rbound_rows. */
static void bound_rows(state *s, num_t rows[DEG_FREE], int half, prism *pz, int col)
{
    numbers *n = &s->n;
    num_t *t = n->ff;
    bdd *sum = &n->bx[2];

    for (int j = 0; j < DEG_FREE; j++) {
        num_t *B1 = n->inverse[half + j], *B2 = n->inverse[half + j] + DEG_FREE;
        for (int k = col; k < col + DEG_FREE; k++) {
            num_t *S1[DEG_FREE] = { &pz->matrix[V][k], &pz->matrix[V + 1][k] };
            num_set_si(t[0], 0, 0);
            for (int i = 0; i < DEG_FREE; i++) {
                num_mul_si(t[1], B2[i], 2);
                num_add(t[1], t[1], B1[i]);
                num_addmul(s, t[0], t[1], *S1[i]);
                num_submul(s, t[0], B2[i], pz->matrix[U + i][k]);
            }
            bound_set(sum, t[0]);
            num_mul(t[1], B2[0], *S1[0]);
            num_neg(t[1], t[1]);
            bound_add_term(s, sum, t[1], &n->a_sin);
            num_mul(t[1], B2[1], *S1[1]);
            num_neg(t[1], t[1]);
            bound_add_term(s, sum, t[1], &n->b_sin);
            num_add(t[1], B2[0], B2[1]);
            num_add(t[2], *S1[0], *S1[1]);
            num_mul(t[1], t[1], t[2]);
            num_neg(t[1], t[1]);
            bound_add_term(s, sum, t[1], &n->c_sin);
            add_max_abs(s, rows[j], sum);
        }
    }
}

/* After global_bounds, image and col_rotor: w_j >= row j of |A^-1 (G(x_c) - x_c')| +
   |A^-1 DG P| over the prism (equations Wabc-def and cr-rows).

   The p columns of DG P - A are zero in the rows of u and
   (gamma - gamma_c) P_pp + (beta - beta_c) P_vp in those of v, but for the rounding of A, an ulp
   for each of the 4 x 3 entries.  The inverse is off by at most inverse_err in each entry, which
   can change a row sum by inverse_err times the sum of all entries it is multiplied with.
   Thesis: Rcr_rows. */
static void cr_rows(state *s, num_t A[MAT_DIM][MAT_DIM], jacobian *d, prism *pz)
{
    numbers *n = &s->n;
    num_t *t = n->cr;

    invert_corner(s, A);
    if (s->inverse_failed)
        return;
    bound_beta(s, d);
    bound_gamma(s, d, pz);

    block_sum(s, t[0], pz->matrix, V, 0, N_PARMS);
    num_mul(t[1], n->beta_dif, t[0]);
    num_add(t[1], t[1], n->gamma_dif);                  /* the p columns, rows of v */

    /* the sum of all entries the inverse is multiplied with */
    block_sum(s, t[2], pz->matrix, V, U, MAT_DIM);
    num_set_si(t[3], 1, 0);
    num_add(t[3], t[3], n->beta_star);
    num_mul(t[3], t[3], t[2]);
    block_sum(s, t[2], pz->matrix, U, U, MAT_DIM);
    num_add(t[3], t[3], t[2]);
    num_add(t[3], t[3], t[1]);
    num_mul_si(t[4], n->ulp, 12);
    num_add(t[3], t[3], t[4]);
    num_mul_si(t[4], n->centre_err, 2);
    num_add(t[3], t[3], t[4]);
    num_mul(t[3], t[3], n->inverse_err);

    for (int j = 0; j < N_PARMS; j++)
        num_set_si(n->w[j], 1, 0);
    for (int half = 0; half < TWO_DF; half += DEG_FREE) {
        for (int j = 0; j < DEG_FREE; j++) {
            row_sum(s, t[4], n->inverse[half + j], DEG_FREE, TWO_DF);
            row_sum(s, t[5], n->inverse[half + j], 0, TWO_DF);
            num_add(t[6], t[1], n->centre_err);
            num_mul(n->w[U + half + j], t[4], t[6]);
            num_mul_si(t[6], n->ulp, 3);
            num_addmul(s, n->w[U + half + j], t[5], t[6]);
            num_add(n->w[U + half + j], n->w[U + half + j], t[3]);
        }
        bound_rows(s, n->w + U + half, half, pz, U);
        bound_rows(s, n->w + U + half, half, pz, V);
    }
}
