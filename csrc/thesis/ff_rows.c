/* ff_rows.c - the widths w for the fixed-form scheme. */

/* After global_bounds, image and fixed_form: w_j >= row j of |A^-1 (G(x_c) - x_c')| +
   |A^-1 DG P| over the prism (equation Wabc-def), for a prism of the list.

   The u rows of A repeat the v rows of P, and u' is exact, so the p rows and the v rows of
   A^-1 DG P are those of the identity: w_p = w_v = 1.  (Without a width they are zero, and 1
   is more than enough.)  The u rows are A_vu^-1 times
       [ (gamma - gamma_c) P_pp + e,  0,  (beta - beta_c) P_vv + e ]
   with e the roundings of A_vp and A_vv, an ulp for each of the 2 x 5 entries; the error of
   the centre adds centre_err in each row of v.  Equation ff-ests.  Erratum: the listing divides
   by the determinant with its sign, which turns columns over.  Thesis: Rff_rows. */
static void ff_rows(state *s, num_t A[MAT_DIM][MAT_DIM], jacobian *d, prism *pz)
{
    numbers *n = &s->n;
    num_t *t = n->ff;

    bound_beta(s, d);
    bound_gamma(s, d, pz);
    block_sum(s, t[0], pz->matrix, V, V, MAT_DIM);
    num_mul(t[1], n->beta_dif, t[0]);
    num_add(t[1], t[1], n->gamma_dif);
    num_mul_si(t[2], n->ulp, 10);
    num_add(t[1], t[1], t[2]);
    num_mul_si(t[2], n->centre_err, 2);
    num_add(t[1], t[1], t[2]);

    /* the row sums of the inverse of A_vu are (|a11| + |a01|)/|det| and (|a00| + |a10|)/|det| */
    num_mul(t[3], A[V][U], A[V + 1][U + 1]);
    num_submul(s, t[3], A[V][U + 1], A[V + 1][U]);
    if (num_sgn(t[3]) == 0) {
        s->inverse_failed = 1;
        return;
    }
    num_abs(t[5], t[3]);
    for (int j = 0; j < N_PARMS; j++)
        num_set_si(n->w[j], 1, 0);
    for (int j = 0; j < DEG_FREE; j++) {
        num_abs(t[4], A[V + 1 - j][U + 1 - j]);
        num_addabs(s, t[4], A[V + j][U + 1 - j]);
        num_mul(t[4], t[4], t[1]);
        num_div(s, n->w[U + j], t[4], t[5], APM_UP);
        if (s->as_printed && num_sgn(t[3]) < 0)
            num_neg(n->w[U + j], n->w[U + j]);
        num_set_si(n->w[V + j], 1, 0);
    }
}
