/* torus.c - the largest trace and the largest eigenvalue of beta over the whole torus and all
   parameters, by branch and bound.  The thesis found them by Newton's method and added a
   margin; that is a guess, and everything else rests on these two numbers. */

enum { TORUS_CELLS = 400000 };

/* r >= p sin(v + t) for every p of the parameter's interval, given s0 and c0, the sine and
   cosine of v to within an ulp: sup p (s0 + c0 t) + |p| (t^2/2 + (1 + |t|) ulp), since
   |sin''| <= 1.  As a function of t this is convex. */
static void wave_coefficient(state *s, num_t r, const bdd *parm, const num_t s0, const num_t c0,
                             const num_t t)
{
    num_t *x = s->n.tor + 10;

    num_set(x[0], s0);
    num_addmul(s, x[0], c0, t);
    num_mul(r, x[0], num_sgn(x[0]) < 0 ? parm->lb : parm->ub);
    num_mul(x[1], t, t);
    num_half(x[1], x[1]);
    num_add(x[1], x[1], s->n.ulp);
    num_abs(x[2], t);
    num_addmul(s, x[1], x[2], s->n.ulp);
    num_set_si(x[3], 0, 0);
    add_max_abs(s, x[3], parm);
    num_addmul(s, r, x[1], x[3]);
}

/* r >= the trace or the largest eigenvalue of 2I + W(v + t), after set_waves(v), where
   W = a sin v0 e0e0' + b sin v1 e1e1' + c sin(v0+v1) (1,1)(1,1)'.  As a function of t the
   bound is convex: so are the three coefficients, W grows with them in the Loewner order, and
   trace and largest eigenvalue are convex and grow with W. */
static void displaced_bound(state *s, num_t r, const num_t t0, const num_t t1, int eigenvalue)
{
    numbers *n = &s->n;
    num_t *x = n->tor;

    num_add(x[2], t0, t1);
    wave_coefficient(s, x[3], &n->a, n->sin_c[0], n->cos_c[0], t0);
    wave_coefficient(s, x[4], &n->b, n->sin_c[1], n->cos_c[1], t1);
    wave_coefficient(s, x[5], &n->c, n->sin_c[2], n->cos_c[2], x[2]);
    num_add(r, x[3], x[4]);
    num_add(r, r, x[5]);
    num_add(r, r, x[5]);                                /* the trace of W */
    if (eigenvalue) {
        num_sub(x[6], x[3], x[4]);
        num_mul(x[6], x[6], x[6]);
        num_mul(x[7], x[5], x[5]);
        num_mul_si(x[7], x[7], 4);
        num_add(x[6], x[6], x[7]);
        num_sqrt(s, x[7], x[6], APM_UP);
        num_add(r, r, x[7]);
        num_half(r, r);
    }
    num_set_si(x[7], eigenvalue ? 2 : 4, 0);
    num_add(r, r, x[7]);
    num_round(s, r, r, APM_UP);
}

/* r >= the same for every point of the cell: a convex function is largest at a corner. */
static void cell_bound(state *s, num_t r, cell *k, int eigenvalue)
{
    num_t *x = s->n.tor;

    for (int corner = 0; corner < 4; corner++) {
        num_set(x[0], k->r[0]);
        num_set(x[1], k->r[1]);
        if (corner & 1)
            num_neg(x[0], x[0]);
        if (corner & 2)
            num_neg(x[1], x[1]);
        displaced_bound(s, x[8], x[0], x[1], eigenvalue);
        if (corner == 0 || num_cmp(x[8], r) > 0)
            num_set(r, x[8]);
    }
}

/* r = the trace or the largest eigenvalue of 2I + W at the cell's centre, plus 5e-7; leaves
   the waves of that point. */
static void value_at(state *s, num_t r, cell *k, int eigenvalue)
{
    num_t *x = s->n.tor;

    set_waves(s, k->v);
    num_set_si(x[0], 0, 0);
    displaced_bound(s, r, x[0], x[0], eigenvalue);
    num_set_si(x[0], 5, -7);
    num_add(r, r, x[0]);
}

/* max >= the largest trace (or eigenvalue) of beta over the torus and the parameters a, b, c
   of the state, and within about 1e-6 of it.  seed is where the maximum of W is expected: a
   good one saves work, a bad one does no harm.

   beta(-v) = 2I + W(v), and the torus is its own mirror image, so W serves.  A cell is done
   when its bound is at most 5e-7 above the best value seen at a centre; otherwise it is halved
   along the side that moves the waves most.  A cell that is not done when depth or patience run
   out counts with its own bound: max is then looser, and still a bound. */
static void torus_max(state *s, num_t max, int eigenvalue, const double seed[2])
{
    numbers *n = &s->n;
    cell *stack = n->cells;
    num_t *x = n->tor;
    double reach[3] = { 0.0, 0.0, 0.0 };                /* of a, b, c; only guides the cuts */
    long done = 0;
    int top = 0;

    num_t *const parm_ends[3][2] = { { &n->a.lb, &n->a.ub }, { &n->b.lb, &n->b.ub },
                                     { &n->c.lb, &n->c.ub } };
    for (int j = 0; j < 3; j++)
        for (int e = 0; e < 2; e++) {
            const double p = num_get_d(*parm_ends[j][e]);
            reach[j] = p > reach[j] ? p : -p > reach[j] ? -p : reach[j];
        }
    for (int j = 0; j < 2; j++) {
        num_set_si(stack[0].v[j], 0, 0);
        num_set(stack[0].r[j], n->pi_ub);
    }
    s->cell_depth[0] = 0;
    for (int j = 0; j < 2; j++)
        num_set_d(stack[1].v[j], seed[j]);
    value_at(s, x[9], stack + 1, eigenvalue);          /* the best value seen, plus 5e-7 */
    num_set(max, x[9]);
    while (top >= 0) {
        cell *k = stack + top, *other = stack + top + 1;

        value_at(s, x[8], k, eigenvalue);
        num_max(x[9], x[8]);
        cell_bound(s, x[14], k, eigenvalue);
        if (num_cmp(x[14], x[9]) <= 0) {
            top--;
        } else if (s->cell_depth[top] == TORUS_DEPTH || ++done > TORUS_CELLS) {
            num_max(max, x[14]);
            top--;
        } else {
            const int j = num_get_d(k->r[0]) * (reach[0] + reach[2])
                          < num_get_d(k->r[1]) * (reach[1] + reach[2]);
            s->cell_depth[top]++;
            s->cell_depth[top + 1] = s->cell_depth[top];
            num_half(k->r[j], k->r[j]);
            for (int i = 0; i < 2; i++) {
                num_set(other->v[i], k->v[i]);
                num_set(other->r[i], k->r[i]);
            }
            num_add(other->v[j], other->v[j], k->r[j]);
            num_sub(k->v[j], k->v[j], k->r[j]);
            top++;
        }
    }
    num_max(max, x[9]);
}
