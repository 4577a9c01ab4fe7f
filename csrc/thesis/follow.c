/* follow.c - one prism: may any of its points follow x* in a minimizing state? */

enum { FURTHEST = 10, QS_TO_RS = 6 };   /* the longest orbit; how cuts lengthen a quick try */

/* Is any row sum of the prism's matrix above MAX_SUM?  Then its images are hopeless.
   Thesis: big_RPrism. */
static int big_prism(state *s, prism *pz)
{
    numbers *n = &s->n;

    for (int j = 0; j < MAT_DIM; j++) {
        row_sum(s, n->t[0], pz->matrix[j], 0, MAT_DIM);
        if (!num_is_finite(n->t[0])) {
            s->failed = 1;
            return 1;
        }
        if (num_cmp(n->t[0], n->max_sum) > 0)
            return 1;
    }
    return 0;
}

/* Is the bound already below what an invariant torus allows? */
static int contradiction(state *s, verdict *v, int nsteps)
{
    numbers *n = &s->n;

    v->nsteps = nsteps;
    v->by_trace = num_cmp(n->slope, n->constants[C_TRACE_MIN]) < 0;
    v->no_tori = v->by_trace || num_cmp(n->least_lam, n->constants[C_LAM_MIN]) < 0;
    if (s->failed || !num_is_finite(n->slope) || !num_is_finite(n->least_lam)) {
        v->no_tori = 0;
        v->reason = CV_REASON_ARITHMETIC;
        return 1;
    }
    return v->no_tori;
}

/* The blocks of the second variation along the orbit of the prism in work[0], from d_0 on.
   Each is bounded over the whole of a prism that contains the image of the last one, so if a
   bound falls below the uniform cone no point of the first prism follows x* in a minimizing
   state.  With limit > 0 only the centre's orbit is followed (the widths of the parameters
   still count), and for so many steps.  Thesis: Rtry_prism. */
static void follow(state *s, verdict *v, int limit)
{
    numbers *n = &s->n;
    prism *pz = &n->work[0], *pz_prime = &n->work[1], *swap;
    int used, count = 1;

    s->failed = 0;
    num_set(n->slope, n->first_slope);
    num_set(n->least_lam, n->first_least_lam);
    if (contradiction(s, v, count))
        return;
    v->reason = CV_REASON_TOO_BIG;
    while (!big_prism(s, pz)) {
        count++;
        global_bounds(s, pz);
        bound_btrace(s, &n->b_trace);
        bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
        least_lambda(s, n->slope, n->least_lam, &used);
        v->ll_used[used]++;
        if (contradiction(s, v, count))
            return;
        if (count == (limit > 0 ? limit : FURTHEST)) {
            v->reason = CV_REASON_TOO_LONG;
            return;
        }
        if (limit > 0) {
            set_waves(s, pz->centre.v);
            image(s, &pz_prime->centre, &pz->centre);
            for (int j = 0; j < MAT_DIM; j++)
                for (int k = 0; k < MAT_DIM; k++)
                    num_set(pz_prime->matrix[j][k], pz->matrix[j][k]);
        } else {
            prismatic_image(s, pz_prime, pz);
            if (s->inverse_failed) {
                v->reason = CV_REASON_SINGULAR;
                return;
            }
        }
        swap = pz;
        pz = pz_prime;
        pz_prime = swap;
    }
    v->nsteps = count + 1;                              /* the image that grew too big counts */
    if (s->failed)
        v->reason = CV_REASON_ARITHMETIC;
}

static void set_work(state *s, const box *b, int with_v)
{
    prism *pz = &s->n.work[0];

    for (int j = 0; j < MAT_DIM; j++)
        for (int k = 0; k < MAT_DIM; k++)
            num_set_si(pz->matrix[j][k], 0, 0);
    for (int j = 0; j < N_PARMS; j++) {
        num_set_apm(pz->centre.p[j], b->centre[j]);
        num_set_apm(pz->matrix[j][j], b->half[j]);
    }
    for (int j = 0; j < DEG_FREE; j++) {
        num_set_apm(pz->centre.u[j], b->xstar[j]);
        num_set_apm(pz->centre.v[j], b->centre[N_PARMS + j]);
#ifdef NUM_DOUBLE
        pz->centre.v[j][0] *= 1.0 - 1e-15;              /* below, like the decimals: region.c */
#endif
        if (with_v)
            num_set_apm(pz->matrix[V + j][V + j], b->half[N_PARMS + j]);
    }
}

void R(try_prism)(state *s, const box *b, verdict *v)
{
    memset(v, 0, sizeof *v);
    set_work(s, b, 1);
    follow(s, v, 0);
}

#ifdef NUM_DOUBLE

/* The orbit of the centre alone, over a few steps that grow in number with the cuts. */
void quick_try(state *s, const box *b, verdict *v)
{
    const int steps = b->n_cuts / QS_TO_RS + 2;

    memset(v, 0, sizeof *v);
    set_work(s, b, 0);
    follow(s, v, steps < FURTHEST ? steps : FURTHEST);
    if (!v->no_tori && v->reason != CV_REASON_ARITHMETIC)
        v->reason = CV_REASON_CENTRE;
}

#endif
