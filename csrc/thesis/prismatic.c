/* prismatic.c - a prism around the image of a prism (thesis, the lemma of section 3.2.2). */

/* The fixed-form scheme serves the prisms of the list: diagonal, and without width in u. */
static int is_of_the_list(prism *pz)
{
    for (int j = 0; j < MAT_DIM; j++)
        for (int k = 0; k < MAT_DIM; k++)
            if (num_sgn(pz->matrix[j][k]) != 0 && (j != k || (j >= U && j < V)))
                return 0;
    return 1;
}

/* pz_prime contains G(pz).  To be called after global_bounds(pz).  P' = A W is computed
   exactly: A was rounded before it was inverted and w is rounded up, so truncating P', as the
   listing does, and then making up for it, is not needed.  Thesis: Rprismatic_image. */
static void prismatic_image(state *s, prism *pz_prime, prism *pz)
{
    numbers *n = &s->n;

    s->inverse_failed = 0;
    set_waves(s, pz->centre.v);
    image(s, &pz_prime->centre, &pz->centre);
    find_jacobian(s, &n->deriv, &pz->centre);
    if (is_of_the_list(pz)) {
        fixed_form(s, pz_prime->matrix, &n->deriv, pz);
        ff_rows(s, pz_prime->matrix, &n->deriv, pz);
    } else {
        col_rotor(s, pz_prime->matrix, &n->deriv, pz);
        cr_rows(s, pz_prime->matrix, &n->deriv, pz);
    }
    if (s->inverse_failed)
        return;
    for (int k = 0; k < MAT_DIM; k++) {
        num_round_width(n->w[k], n->w[k]);
        for (int j = 0; j < MAT_DIM; j++)
            num_mul(pz_prime->matrix[j][k], pz_prime->matrix[j][k], n->w[k]);
    }
}
