/* map.c - the map (a, b, c, u, v) -> (a, b, c, v, 2v - u - dV(v)) with
   V(v) = -a sin v0 - b sin v1 - c sin(v0 + v1), and its derivative.  Thesis, equation code-map
   and section "bounding the images of prisms". */

/* The six sines and cosines of the point v, each good to ulp. */
static void set_waves(state *s, num_t v[DEG_FREE])
{
    numbers *n = &s->n;

    num_add(n->t[0], v[0], v[1]);
    num_sincos(s, n->sin_c[0], n->cos_c[0], v[0]);
    num_sincos(s, n->sin_c[1], n->cos_c[1], v[1]);
    num_sincos(s, n->sin_c[2], n->cos_c[2], n->t[0]);
}

/* x' near the image of x, after set_waves(x.v).  u' is exact; each coordinate of v' is off by
   at most centre_err: an ulp for each of the two cosines, times its parameter, and an ulp for
   the rounding. */
static void image(state *s, xtnd_pt *x_prime, xtnd_pt *x)
{
    numbers *n = &s->n;

    for (int j = 0; j < N_PARMS; j++)
        num_set(x_prime->p[j], x->p[j]);
    num_set_si(n->centre_err, 1, 0);
    for (int j = 0; j < DEG_FREE; j++) {
        num_set(x_prime->u[j], x->v[j]);
        num_mul_si(n->t[0], x->v[j], 2);
        num_sub(n->t[0], n->t[0], x->u[j]);
        num_addmul(s, n->t[0], x->p[j], n->cos_c[j]);
        num_addmul(s, n->t[0], x->p[2], n->cos_c[2]);
        num_round(s, x_prime->v[j], n->t[0], APM_TRUNC);
    }
    for (int j = 0; j < N_PARMS; j++)
        num_addabs(s, n->centre_err, x->p[j]);
    num_mul(n->centre_err, n->centre_err, n->ulp);
}

/* beta and gamma at x, after set_waves(x.v), as the numbers the sines and cosines are. */
static void find_jacobian(state *s, jacobian *d, xtnd_pt *x)
{
    numbers *n = &s->n;

    num_mul(n->t[0], x->p[2], n->sin_c[2]);             /* the mixing term */
    num_neg(d->beta[0][1], n->t[0]);
    num_neg(d->beta[1][0], n->t[0]);
    for (int j = 0; j < DEG_FREE; j++) {
        num_set_si(d->beta[j][j], 2, 0);
        num_submul(s, d->beta[j][j], x->p[j], n->sin_c[j]);
        num_sub(d->beta[j][j], d->beta[j][j], n->t[0]);
        num_set_si(d->gamma[j][1 - j], 0, 0);
        num_set(d->gamma[j][j], n->cos_c[j]);
        num_set(d->gamma[j][2], n->cos_c[2]);
    }
}
