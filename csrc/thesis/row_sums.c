/* row_sums.c - bounds over a whole prism. */

/* r = sum of |row| of a matrix from column `from` up to `to` */
static void row_sum(state *s, num_t r, num_t row[], int from, int to)
{
    num_set_si(r, 0, 0);
    for (int k = from; k < to; k++)
        num_addabs(s, r, row[k]);
}

/* r = sum of the absolute values of a block of two rows */
static void block_sum(state *s, num_t r, num_t m[][MAT_DIM], int row, int from, int to)
{
    num_set_si(r, 0, 0);
    for (int j = row; j < row + DEG_FREE; j++)
        for (int k = from; k < to; k++)
            num_addabs(s, r, m[j][k]);
}

/* Over the prism: bounds of a, b, c; of sin and cos of v0, v1, v0 + v1; of a sin v0, b sin v1,
   c sin(v0 + v1).  v differs from the centre by at most the sum of a row.
   Thesis: Rglobal_bounds. */
static void global_bounds(state *s, prism *pz)
{
    numbers *n = &s->n;
    bdd *const parm[N_PARMS] = { &n->a, &n->b, &n->c };
    bdd *theta = &n->bx[3];

    for (int j = 0; j < N_PARMS; j++) {
        num_sub(parm[j]->lb, pz->centre.p[j], pz->matrix[j][j]);
        num_add(parm[j]->ub, pz->centre.p[j], pz->matrix[j][j]);
    }
    num_set_si(n->bx[2].lb, 0, 0);
    num_set_si(n->bx[2].ub, 0, 0);
    for (int j = 0; j < DEG_FREE; j++) {
        row_sum(s, n->t[2], pz->matrix[V + j], 0, MAT_DIM);
        num_sub(theta->lb, pz->centre.v[j], n->t[2]);
        num_add(theta->ub, pz->centre.v[j], n->t[2]);
        num_add(n->bx[2].lb, n->bx[2].lb, theta->lb);
        num_add(n->bx[2].ub, n->bx[2].ub, theta->ub);
        bd_sincos(s, &n->sin[j], &n->cos[j], theta);
    }
    bd_sincos(s, &n->sin[2], &n->cos[2], &n->bx[2]);
    bound_product(s, &n->a_sin, &n->a, &n->sin[0]);
    bound_product(s, &n->b_sin, &n->b, &n->sin[1]);
    bound_product(s, &n->c_sin, &n->c, &n->sin[2]);
}

/* beta_star >= the sum of |beta_jk| and, with the numbers beta_c of the derivative given,
   beta_dif >= the sum of |beta_jk - beta_c_jk|, both over the prism of the last global_bounds.
   Thesis: Rbeta_star, Rbeta_dif_star. */
static void bound_beta(state *s, jacobian *d)
{
    numbers *n = &s->n;
    const bdd *const own[DEG_FREE] = { &n->a_sin, &n->b_sin };

    num_set_si(n->beta_star, 0, 0);
    num_set_si(n->beta_dif, 0, 0);
    for (int j = 0; j < DEG_FREE; j++) {
        num_set_si(n->t[0], 2, 0);
        bound_set(&n->bx[0], n->t[0]);
        bound_add_multiple(s, &n->bx[0], -1, own[j]);
        bound_add_multiple(s, &n->bx[0], -1, &n->c_sin);
        add_max_abs(s, n->beta_star, &n->bx[0]);
        num_sub(n->bx[0].lb, n->bx[0].lb, d->beta[j][j]);
        num_sub(n->bx[0].ub, n->bx[0].ub, d->beta[j][j]);
        add_max_abs(s, n->beta_dif, &n->bx[0]);
    }
    num_set_si(n->t[0], 0, 0);
    bound_set(&n->bx[0], n->t[0]);
    bound_add_multiple(s, &n->bx[0], -2, &n->c_sin);
    add_max_abs(s, n->beta_star, &n->bx[0]);
    num_mul_si(n->t[0], d->beta[0][1], 2);
    num_sub(n->bx[0].lb, n->bx[0].lb, n->t[0]);
    num_sub(n->bx[0].ub, n->bx[0].ub, n->t[0]);
    add_max_abs(s, n->beta_dif, &n->bx[0]);
}

/* gamma_dif >= the sum of |(gamma - gamma_c) P_pp| over the prism, gamma_c the numbers of the
   derivative given.  Thesis: Rgamdif_star. */
static void bound_gamma(state *s, jacobian *d, prism *pz)
{
    numbers *n = &s->n;

    num_set_si(n->gamma_dif, 0, 0);
    for (int j = 0; j < N_PARMS; j++) {
        const bdd *const wave = &n->cos[j];
        num_t *const at_centre = &d->gamma[j == 1][j];
        num_sub(n->bx[0].lb, wave->lb, *at_centre);
        num_sub(n->bx[0].ub, wave->ub, *at_centre);
        num_set_si(n->t[0], 0, 0);
        add_max_abs(s, n->t[0], &n->bx[0]);
        num_abs(n->t[1], pz->matrix[j][j]);
        num_mul(n->t[0], n->t[0], n->t[1]);
        num_add(n->gamma_dif, n->gamma_dif, n->t[0]);
        if (j == 2)                                     /* it stands in both rows */
            num_add(n->gamma_dif, n->gamma_dif, n->t[0]);
    }
}
