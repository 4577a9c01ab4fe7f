/* torus.c - the largest trace and the largest eigenvalue of beta over the whole torus and all
   parameters, by branch and bound.  The thesis found them by Newton's method and added a
   margin; that is a guess, and everything else rests on these two numbers. */

enum { TORUS_CELLS = 20000, TORUS_DP = 25 };

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
    if (!num_is_finite(r))
        s->failed = 1;                                  /* NaN is not larger than anything */
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

/* One pass over the torus: best becomes the largest value seen at any centre, if larger than
   before; max >= every value on the torus, and at most best + tolerance unless depth or patience
   ran out, when it is looser, and still a bound.  cells: how many were halved so far.

   beta(-v) = 2I + W(v), and the torus is its own mirror image, so W serves.  A cell is done
   when its bound is at most best + tolerance; otherwise it is halved along the side whose square
   moves the waves most, since it is at their maxima, where they are parabolas, that cells have
   to be small. */
static void torus_pass(state *s, num_t max, num_t best, const num_t tolerance, int eigenvalue,
                       num_t reach[DEG_FREE], long *cells)
{
    numbers *n = &s->n;
    cell *stack = n->cells;
    num_t *x = n->tor;
    int top = 0;

    for (int j = 0; j < DEG_FREE; j++) {
        num_set_si(stack[0].v[j], 0, 0);
        num_set(stack[0].r[j], n->pi_ub);
    }
    s->cell_depth[0] = 0;
    num_set(max, best);
    while (top >= 0) {
        cell *k = stack + top, *other = stack + top + 1;

        set_waves(s, k->v);
        num_set_si(x[0], 0, 0);
        displaced_bound(s, x[8], x[0], x[0], eigenvalue);
        num_max(best, x[8]);
        cell_bound(s, x[9], k, eigenvalue);
        if (s->failed)
            return;
        num_add(x[8], best, tolerance);
        if (num_cmp(x[9], x[8]) <= 0 || s->cell_depth[top] == TORUS_DEPTH ||
            ++*cells > TORUS_CELLS) {
            num_max(max, x[9]);
            top--;
        } else {
            int j;
            for (j = 0; j < DEG_FREE; j++) {
                num_mul(x[j], k->r[j], k->r[j]);
                num_mul(x[j], x[j], reach[j]);
            }
            j = num_cmp(x[0], x[1]) < 0;
            s->cell_depth[top]++;
            s->cell_depth[top + 1] = s->cell_depth[top];
            num_half(k->r[j], k->r[j]);
            for (int i = 0; i < DEG_FREE; i++) {
                num_set(other->v[i], k->v[i]);
                num_set(other->r[i], k->r[i]);
            }
            num_add(other->v[j], other->v[j], k->r[j]);
            num_sub(k->v[j], k->v[j], k->r[j]);
            top++;
        }
    }
}

/* max >= the largest trace (or eigenvalue) of beta over the torus and the parameters a, b, c
   of the state, and within 5e-7 + 1e-12 (|a| + |b| + |c|) of it, unless the cells run out, as
   they do where the maximum is a ridge: across the cells if |c| is much larger than |a| or |b|,
   along them if c = 0 and |a| and |b| differ, since the larger of two waves does not depend on
   the other's angle.  Then max is the best bound of the passes or, if that is less, what no sines
   exceed, 4 + |a| + |b| + 2|c| (or 2 + max(|a|, |b|) + 2|c|); a ridge nearly reaches it.
   Each pass looks a thousand times more closely than the last, whose best value spares it all
   but the neighbourhood of the maximum.  TORUS_DP places are plenty for that, whatever the
   precision of the proof. */
static void torus_max(state *s, num_t max, int eigenvalue)
{
    numbers *n = &s->n;
    bdd *const parm[N_PARMS] = { &n->a, &n->b, &n->c };
    num_t *best = n->tor + 14, *tolerance = n->tor + 15, *pass = n->tor + 16;
    num_t *reach = n->tor + 17, *last = n->tor + 20, *t = n->tor + 21, *most = n->tor + 22;
    const long precision = s->precision;
    long cells = 0;

    set_precision(s, TORUS_DP);
    num_set_si(*t, 0, 0);
    for (int j = 0; j < N_PARMS; j++) {
        num_set_si(reach[j], 0, 0);
        add_max_abs(s, reach[j], parm[j]);
        num_add(*t, *t, reach[j]);
    }
    num_set_si(*last, 1, -12);
    num_mul(*last, *last, *t);
    num_set_si(*most, 5, -7);
    num_add(*last, *last, *most);
    num_half(*t, *t);

    num_set_si(*most, eigenvalue ? 2 : 4, 0);           /* what no sines exceed */
    num_add(*most, *most, reach[2]);
    num_add(*most, *most, reach[2]);
    num_set(*pass, reach[0]);
    num_max(*pass, reach[1]);
    num_add(*most, *most, *pass);
    if (!eigenvalue) {
        num_set(*pass, reach[0]);
        num_min(*pass, reach[1]);
        num_add(*most, *most, *pass);
    }

    num_add(reach[0], reach[0], reach[2]);              /* what each side of a cell moves */
    num_add(reach[1], reach[1], reach[2]);
    num_set_si(*best, 0, 0);                            /* the average of either is above */
    for (int first = 1, done = 0; !done && !s->failed; first = 0) {
        num_mul_si(*tolerance, *last, 2);
        done = num_cmp(*t, *tolerance) <= 0;
        num_set(*tolerance, done ? *last : *t);
        torus_pass(s, *pass, *best, *tolerance, eigenvalue, reach, &cells);
        if (first || num_cmp(*pass, max) < 0)
            num_set(max, *pass);
        if (cells > TORUS_CELLS) {
            num_min(max, *most);
            done = 1;
        }
        num_set_si(*tolerance, 1, -3);
        num_mul(*t, *t, *tolerance);
    }
    set_precision(s, precision);
}

#ifdef NUM_DOUBLE

/* The same for one point of the parameters, as a double computes it: off by roundings, for which
   the caller makes up; HUGE_VAL if they overflow. */
double quick_largest(unit *s, const double p[N_PARMS])
{
    bdd *const parm[N_PARMS] = { &s->n.a, &s->n.b, &s->n.c };

    for (int j = 0; j < N_PARMS; j++) {
        num_set_d(parm[j]->lb, p[j]);
        num_set_d(parm[j]->ub, p[j]);
    }
    s->failed = 0;
    torus_max(s, s->n.constants[C_B], 1);
    return s->failed ? HUGE_VAL : num_get_d(s->n.constants[C_B]);
}

#endif
