/* lipschitz.c - the uniform cones: between which limits trace and least eigenvalue of the blocks
   d_j must stay on an invariant torus (thesis, section 3.3.4 and Appendix B, "uniform cones"). */

/* earliest = the point x* with the widths of the parameters and nothing else. */
static void set_earliest(state *s, const box *root, int with_widths)
{
    prism *pz = &s->n.earliest;

    for (int j = 0; j < MAT_DIM; j++)
        for (int k = 0; k < MAT_DIM; k++)
            num_set_si(pz->matrix[j][k], 0, 0);
    for (int j = 0; j < N_PARMS; j++) {
        num_set_apm(pz->centre.p[j], root->centre[j]);
        if (with_widths)
            num_set_apm(pz->matrix[j][j], root->half[j]);
    }
    for (int j = 0; j < DEG_FREE; j++)
        num_set_apm(pz->centre.v[j], root->xstar[j]);
}

/* As printed: the trace of beta at the point Newton's method found, a margin, and the symmetry
   of the potential.  Errata: a point is not a proof; the margin counts c once, the text twice;
   and the lower end of the bound of the largest trace is taken where the upper one is meant.
   Thesis: setCone. */
static void set_cone_as_printed(state *s, const num_t margin)
{
    numbers *n = &s->n;

    global_bounds(s, &n->earliest);
    bound_btrace(s, &n->b_trace);
    num_add(n->t[0], n->b_trace.ub, margin);
    num_set_si(n->t[1], 8, 0);
    num_sub(n->constants[C_T], n->t[1], n->t[0]);
    uniform_cone(s, n->constants[C_TRACE_MIN], n->constants[C_TRACE_MAX], n->constants[C_T], 16);
}

/* r >= the largest trace or eigenvalue of beta over the torus and the parameters of the root. */
static void bound_over_torus(state *s, num_t r, const box *root, int which)
{
    torus_wave waves[N_PARMS] = { { .k = { 1, 0 } }, { .k = { 0, 1 } }, { .k = { 1, 1 } } };
    apm_t x;

    apm_init(x);
    for (int j = 0; j < N_PARMS; j++) {
        apm_sub(x, root->centre[j], root->half[j]);
        waves[j].p.low = apm_bound_d(x, APM_DOWN);
        apm_add(x, root->centre[j], root->half[j]);
        waves[j].p.high = apm_bound_d(x, APM_UP);
    }
    if (apm_set_d(x, torus_largest(N_PARMS, waves, which)) != APM_OK)
        s->failed = 1;
    apm_round(x, x, TORUS_PLACES, APM_UP);
    num_set_apm(r, x);
    apm_clear(x);
}

/* Thesis: prepare_trial.  Sound: T and B are theorems (torus.c). */
int R(prepare_trial)(state *s, const box *root, const double herman_start[2],
                     apm_t constants[N_CONSTANTS])
{
    numbers *n = &s->n;

    s->failed = 0;
    if (s->as_printed) {
        num_t *margin = n->ex + 7;
        num_set_si(*margin, 0, 0);
        for (int j = 0; j < N_PARMS; j++) {
            num_set_apm(n->t[0], root->centre[j]);
            num_set_si(n->t[1], 1, -START_SZ);
            num_addmul(s, *margin, n->t[0], n->t[1]);
            num_set_apm(n->t[0], root->half[j]);
            num_addabs(s, *margin, n->t[0]);
        }
        set_earliest(s, root, 0);
        for (int j = 0; j < DEG_FREE; j++)
            if (num_set_d(n->earliest.centre.v[j], herman_start[j]) != APM_OK)
                s->failed = 1;
        set_cone_as_printed(s, *margin);
        set_LL_bounds_as_printed(s, *margin);
    } else if (constants != NULL) {
        for (int j = 0; j < N_CONSTANTS; j++)
            num_set_apm(n->constants[j], constants[j]);
    } else {
        bound_over_torus(s, n->constants[C_T], root, TORUS_TRACE);
        bound_over_torus(s, n->constants[C_B], root, TORUS_EIGENVALUE);
        uniform_cone(s, n->constants[C_TRACE_MIN], n->constants[C_TRACE_MAX],
                     n->constants[C_T], 16);
        uniform_cone(s, n->constants[C_LAM_MIN], n->constants[C_LAM_MAX], n->constants[C_B], 4);
    }
    set_earliest(s, root, 1);
    if (s->as_printed)                                  /* "the imprecision of the start" */
        for (int j = 0; j < DEG_FREE; j++)
            num_set_si(n->earliest.matrix[V + j][V + j], 1, -START_SZ);
    set_first_block(s);
    return s->failed ? CV_EARITHMETIC : CV_OK;
}

int R(unit_constants)(state *s, apm_t constants[N_CONSTANTS])
{
    for (int j = 0; j < N_CONSTANTS; j++)
        if (num_get_apm(constants[j], s->n.constants[j]) != APM_OK)
            return CV_EARITHMETIC;
    return CV_OK;
}
