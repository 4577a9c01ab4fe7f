/* cr_fatten.c - the column rotor: A = DG_c P with its last four columns kept from being parallel. */

/* If the sine of the angle between columns j < k, seen in two of the rows, is below that of the
   rotor's angle, turns the shorter one away from the other.  The rows are the listing's: u0, u1
   for neighbours, u1, v0 for the next but one, v0, v1 for the outermost.

   In the first step of the rotor columns 1 and 3 are exactly parallel in the rows u1 and v0, and
   the area of 0 and 2 is a multiple of sin(v0 + v1), which all but vanishes for many centres.
   Which way to turn is then not for rounding errors to say: columns that are parallel to ten
   places count as having a positive area, and see region.c for the sine.  Erratum: the listing
   looks at the sign of the area alone and so turns nearly opposite columns together.
   Thesis: Rsubspace_rot. */
static void subspace_rot(state *s, num_t A[MAT_DIM][MAT_DIM], int j, int k)
{
    numbers *n = &s->n;
    num_t *t = n->ex;
    const int row = U + k - j - 1, one = U + j, two = U + k;
    num_t *const upper = A[row], *const lower = A[row + 1];
    int sign, turned;

    num_mul(t[0], upper[one], lower[two]);
    num_submul(s, t[0], lower[one], upper[two]);        /* the area */
    num_mul(t[1], upper[one], upper[one]);
    num_addmul(s, t[1], lower[one], lower[one]);
    num_mul(t[2], upper[two], upper[two]);
    num_addmul(s, t[2], lower[two], lower[two]);
    num_mul(t[3], t[1], t[2]);
    if (num_sgn(t[3]) == 0)
        return;
    num_mul(t[4], t[0], t[0]);
    num_mul(t[5], t[3], n->small_sinsq);
    if (num_cmp(t[4], t[5]) >= 0)
        return;
    num_set_si(t[5], 1, -20);
    num_mul(t[5], t[5], t[3]);
    sign = num_cmp(t[4], t[5]) > 0 && num_sgn(t[0]) < 0 ? -1 : 1;
    num_mul(t[5], upper[one], upper[two]);
    num_addmul(s, t[5], lower[one], lower[two]);
    if (!s->as_printed && num_sgn(t[5]) < 0)
        sign = -sign;
    turned = two;
    if (num_cmp(t[2], t[1]) > 0) {
        turned = one;
        sign = -sign;
    }
    num_mul_si(t[6], n->theta_sin, sign);
    num_mul(t[0], n->theta_cos, upper[turned]);
    num_submul(s, t[0], t[6], lower[turned]);
    num_mul(t[1], n->theta_cos, lower[turned]);
    num_addmul(s, t[1], t[6], upper[turned]);
    num_round(s, upper[turned], t[0], APM_TRUNC);
    num_round(s, lower[turned], t[1], APM_TRUNC);
}

/* A = [ P_pp 0 0; P_vp P_vu P_vv; DG_v* P ], rounded to precision, then the rotations.  As for
   the fixed form, no error made here matters.  Erratum: as printed, P_uu is subtracted from the
   (v,v) block instead of the (v,u) block.  Thesis: Rcol_rotor. */
static void col_rotor(state *s, num_t A[MAT_DIM][MAT_DIM], jacobian *d, prism *pz)
{
    numbers *n = &s->n;
    num_t (*Pm)[MAT_DIM] = pz->matrix;

    for (int j = 0; j < N_PARMS; j++)
        for (int k = 0; k < MAT_DIM; k++)
            num_set(A[j][k], Pm[j][k]);
    for (int j = 0; j < DEG_FREE; j++)
        for (int k = 0; k < MAT_DIM; k++) {
            num_round(s, A[U + j][k], Pm[V + j][k], APM_TRUNC);
            num_mul(n->t[0], d->beta[j][0], Pm[V][k]);
            num_addmul(s, n->t[0], d->beta[j][1], Pm[V + 1][k]);
            if (!s->as_printed || k < U || k >= V)
                num_sub(n->t[0], n->t[0], Pm[U + j][k]);
            if (s->as_printed && k >= V)
                num_sub(n->t[0], n->t[0], Pm[U + j][k - DEG_FREE]);
            if (k < N_PARMS)
                num_addmul(s, n->t[0], d->gamma[j][k], Pm[k][k]);
            num_round(s, A[V + j][k], n->t[0], APM_TRUNC);
        }
    for (int j = 0; j < TWO_DF; j++)
        for (int k = j + 1; k < TWO_DF; k++)
            subspace_rot(s, A, j, k);
}
