/* lambda.c - the eigenvalues of beta, and the least eigenvalue of the blocks d_j. */

/* Over the prism of the last global_bounds, with its trace bounded: the least and the largest
   eigenvalue of beta, (Tr beta -+ sqrt(disc)) / 2 with
   disc = (a sin v0 - b sin v1)^2 + 4 (c sin(v0 + v1))^2.  (Appendix B prints a plus sign in
   the first square; the listing has the minus.)  Thesis: Rbd_Blams. */
static void bd_Blams(state *s, bdd *least, bdd *big, const bdd *trace)
{
    numbers *n = &s->n;
    bdd *disc = &n->bx[0], *square = &n->bx[1];
    num_t *t = n->blam;

    bound_square(disc, &n->a_sin);
    bound_square(square, &n->b_sin);
    num_add(disc->lb, disc->lb, square->lb);
    num_add(disc->ub, disc->ub, square->ub);
    bound_square(square, &n->c_sin);
    bound_add_multiple(s, disc, 4, square);
    bound_product(s, square, &n->a_sin, &n->b_sin);
    bound_add_multiple(s, disc, -2, square);
    if (num_sgn(disc->lb) < 0)
        num_set_si(disc->lb, 0, 0);
    if (num_sgn(disc->ub) < 0)
        num_set_si(disc->ub, 0, 0);

    num_sqrt(s, t[0], disc->lb, APM_DOWN);
    num_sqrt(s, t[1], disc->ub, APM_UP);
    num_sub(t[2], trace->ub, t[0]);
    num_half(least->ub, t[2]);
    num_sub(t[2], trace->lb, t[1]);
    num_half(least->lb, t[2]);
    num_add(t[2], trace->lb, t[0]);
    num_half(big->lb, t[2]);
    num_add(t[2], trace->ub, t[1]);
    num_half(big->ub, t[2]);
    if (s->as_printed) {
        bound_widen(least, n->max_error);
        bound_widen(big, n->max_error);
    }
}

/* From an upper bound M of a recursion d' <= M - (k/4)/d, k = 4 for eigenvalues and 16 for
   traces: the limits between which d must stay, low <= (M - sqrt(M^2 - k))/2 and
   high >= (M + sqrt(M^2 - k))/2.  The first is computed as k/4 over the second, where nothing
   cancels.  Thesis, section 3.3.4. */
static void uniform_cone(state *s, num_t low, num_t high, const num_t M, long k)
{
    num_t *t = s->n.blam;

    num_mul(t[0], M, M);
    num_set_si(t[1], k, 0);
    num_sub(t[0], t[0], t[1]);
    num_sqrt(s, t[2], t[0], APM_UP);
    num_add(t[2], t[2], M);
    num_half(high, t[2]);
    num_set_si(t[3], k, 0);
    num_half(t[3], t[3]);
    num_div(s, low, t[3], t[2], APM_DOWN);
}

/* As printed: the bound B of the largest eigenvalue and what follows.  An unclosed comment in
   the listing swallows the three calls that would have bounded the least eigenvalue of beta at
   the starting point, so zero stands in its place and B = 4 + the margin: weak, but a bound as
   long as no eigenvalue of beta is negative anywhere.  Thesis: setLLbounds. */
static void set_LL_bounds_as_printed(state *s, const num_t margin)
{
    numbers *n = &s->n;

    num_set_si(n->t[0], 4, 0);
    num_add(n->constants[C_B], n->t[0], margin);
    uniform_cone(s, n->constants[C_LAM_MIN], n->constants[C_LAM_MAX], n->constants[C_B], 4);
    num_sub(n->constants[C_LAM_MIN], n->constants[C_LAM_MIN], n->max_error);
    num_add(n->constants[C_LAM_MAX], n->constants[C_LAM_MAX], n->max_error);
}

/* The three bounds of the least eigenvalue of d' = beta - 1/d: equations sineq1 to sineq3, from
   upper bounds `slope` of Tr d and `least_lam` of its least eigenvalue, both positive, and from
   the bounds of beta just computed.  slope becomes the bound of Tr d'.  Each quotient that is
   subtracted is rounded down, so the bounds are upper bounds. */
static void least_lambda(state *s, num_t slope, num_t least_lam, int *used)
{
    numbers *n = &s->n;
    num_t *t = n->ex;

    num_set_si(t[0], 1, 0);
    num_div(s, t[1], t[0], least_lam, APM_DOWN);
    num_sub(n->maxBlam_ll, n->maxBlam.ub, t[1]);        /* lam+(beta) - 1/lam-(d) */

    num_sub(t[1], slope, n->constants[C_LAM_MIN]);      /* >= lam+(d) */
    if (num_sgn(t[1]) > 0) {
        num_div(s, t[2], t[0], t[1], APM_DOWN);
        num_sub(n->minBlam_ll, n->minBlam.ub, t[2]);    /* lam-(beta) - 1/lam+(d) */
    } else if (s->as_printed) {
        num_set_si(n->minBlam_ll, 0, 0);
    } else {
        num_set(n->minBlam_ll, n->maxBlam_ll);
    }

    num_set_si(t[0], DEG_FREE * DEG_FREE, 0);
    num_div(s, t[1], t[0], slope, APM_DOWN);
    num_sub(t[1], n->b_trace.ub, t[1]);                 /* Tr beta - n^2 / Tr d */
    num_round(s, slope, t[1], APM_UP);
    num_half(n->trace_ll, slope);                       /* lam-(d') <= Tr d' / n */

    *used = CV_BY_MINBLAM;
    num_set(t[0], n->minBlam_ll);
    if (num_cmp(t[0], n->maxBlam_ll) > 0) {
        num_set(t[0], n->maxBlam_ll);
        *used = CV_BY_MAXBLAM;
    }
    if (num_cmp(t[0], n->trace_ll) > 0) {
        num_set(t[0], n->trace_ll);
        *used = CV_BY_TRACE;
    }
    num_round(s, least_lam, t[0], APM_UP);
}

/* Bounds of the trace and the least eigenvalue of the first block, d_0 = beta(x*) - 1/d_-1 with
   d_-1 anywhere in the uniform cone.  `earliest` holds x* and the parameters.
   Thesis: setSlopes, setLeastLam. */
static void set_first_block(state *s)
{
    numbers *n = &s->n;
    int used;

    global_bounds(s, &n->earliest);
    bound_btrace(s, &n->b_trace);
    bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
    num_set(n->first_slope, n->constants[C_TRACE_MAX]);
    num_set(n->first_least_lam, n->constants[C_LAM_MAX]);
    least_lambda(s, n->first_slope, n->first_least_lam, &used);
}
