/* ff_fatten.c - the fixed-form fattener, for the prisms of the list: P is diagonal, without
   width in u. */

/* A = [ P_pp 0 0; 0 0 A_uv; A_vp A_vu A_vv ] with
       A_vp = gamma_c P_pp,   A_uv = P_vv,   A_vu = A_vv = beta_c P_vv,
   which is what equation A-blocks comes to for a prism of the list, rounded to precision where
   sines and cosines entered.  Any invertible A is right, so neither the rounding nor the errors
   of beta_c and gamma_c matter here; bounding the rows accounts for A as it is.  Where the
   prism has no width in v, a thousand units of the last place stand in for it in A_uv and A_vu,
   so that the columns keep three digits when they are rounded.  (The listing has one unit, of
   max_error, and SAFETY_DP more digits.)  Thesis: Rfxed_form. */
static void fixed_form(state *s, num_t A[MAT_DIM][MAT_DIM], jacobian *d, prism *pz)
{
    numbers *n = &s->n;

    num_mul_si(n->t[1], n->max_error, s->as_printed ? 1 : 1000);
    for (int j = 0; j < MAT_DIM; j++)
        for (int k = 0; k < MAT_DIM; k++)
            num_set_si(A[j][k], 0, 0);
    for (int k = 0; k < N_PARMS; k++) {
        num_t *const width = &pz->matrix[k][k];
        num_set(A[k][k], *width);
        for (int j = 0; j < DEG_FREE; j++) {
            num_mul(n->t[0], d->gamma[j][k], *width);
            num_round(s, A[V + j][k], n->t[0], APM_TRUNC);
        }
    }
    for (int k = 0; k < DEG_FREE; k++) {
        num_t *const width = &pz->matrix[V + k][V + k];
        num_t *const at_least = num_sgn(*width) == 0 ? &n->t[1] : width;
        num_set(A[U + k][V + k], *at_least);
        for (int j = 0; j < DEG_FREE; j++) {
            num_mul(n->t[0], d->beta[j][k], *at_least);
            num_round(s, A[V + j][U + k], n->t[0], APM_TRUNC);
            num_mul(n->t[0], d->beta[j][k], *width);
            num_round(s, A[V + j][V + k], n->t[0], APM_TRUNC);
        }
    }
}
