/* kernel.c - the routines one at a time, for tests and sceptics. */

static void get_prism(prism *pz, apm_t in[])
{
    num_t *const x[MAT_DIM] = { &pz->centre.p[0], &pz->centre.p[1], &pz->centre.p[2],
                                &pz->centre.u[0], &pz->centre.u[1],
                                &pz->centre.v[0], &pz->centre.v[1] };
    for (int j = 0; j < MAT_DIM; j++) {
        num_set_apm(*x[j], in[j]);
        for (int k = 0; k < MAT_DIM; k++)
            num_set_apm(pz->matrix[j][k], in[MAT_DIM + j * MAT_DIM + k]);
    }
}

static void put(state *s, apm_t r, const num_t x)
{
#ifdef NUM_DOUBLE
    if (isfinite(x[0]))
        apm_set_d(r, x[0]);
    else
        s->failed = 1;
#else
    (void)s;
    apm_set(r, x);
#endif
}

static void put_bdd(state *s, apm_t r[2], const bdd *x)
{
    put(s, r[0], x->lb);
    put(s, r[1], x->ub);
}

static void put_prism(state *s, apm_t out[], prism *pz)
{
    num_t *const x[MAT_DIM] = { &pz->centre.p[0], &pz->centre.p[1], &pz->centre.p[2],
                                &pz->centre.u[0], &pz->centre.u[1],
                                &pz->centre.v[0], &pz->centre.v[1] };
    for (int j = 0; j < MAT_DIM; j++) {
        put(s, out[j], *x[j]);
        for (int k = 0; k < MAT_DIM; k++)
            put(s, out[MAT_DIM + j * MAT_DIM + k], pz->matrix[j][k]);
    }
}

enum { PRISM_SZ = MAT_DIM + MAT_DIM * MAT_DIM };

/* name: what goes in -> what comes out
   sincos: x -> sin, cos                    bound_sincos: lo, hi -> sin lo, hi, cos lo, hi
   inverse: 4 x 4 matrix -> inverse, err    image: prism -> prism
   btrace: prism -> lo, hi                  Blams: prism -> least lo, hi, largest lo, hi
   torus: lo, hi of a, b, c -> T, B         least_lambda: prism, Tr d, lam d, lam_-min -> the same
   cone: M, k -> low, high                  image_ns: prism, n -> nanoseconds per image, of n
   product: x lo, hi, y lo, hi -> lo, hi    square: lo, hi -> lo, hi
   gauss_jordan: 4 x 4 matrix -> inverse to the places of the state, err, in a single try */
int R(kernel)(state *s, const char *name, int nin, apm_t in[], int nout, apm_t out[])
{
    static const struct { const char *name; int nin, nout; } shapes[] = {
        { "sincos", 1, 2 }, { "bound_sincos", 2, 4 }, { "inverse", 16, 17 },
        { "image", PRISM_SZ, PRISM_SZ }, { "btrace", PRISM_SZ, 2 }, { "Blams", PRISM_SZ, 4 },
        { "torus", 6, 2 }, { "least_lambda", PRISM_SZ + 3, 2 }, { "cone", 2, 2 },
        { "image_ns", PRISM_SZ + 1, 1 }, { "product", 4, 2 }, { "square", 2, 2 },
        { "gauss_jordan", 16, 17 }
    };
    numbers *n = &s->n;
    prism *pz = &n->work[0];
    size_t which = 0;
    int used;

    while (which < sizeof shapes / sizeof *shapes && strcmp(name, shapes[which].name) != 0)
        which++;
    if (which == sizeof shapes / sizeof *shapes || nin != shapes[which].nin ||
        nout != shapes[which].nout)
        return CV_EARGUMENT;
    s->failed = s->inverse_failed = 0;
    if (nin >= PRISM_SZ) {
        get_prism(pz, in);
        global_bounds(s, pz);
        bound_btrace(s, &n->b_trace);
    }
    switch (which) {
    case 0:
        num_set_apm(n->t[0], in[0]);
        num_sincos(s, n->t[1], n->t[2], n->t[0]);
        put(s, out[0], n->t[1]);
        put(s, out[1], n->t[2]);
        break;
    case 1:
        num_set_apm(n->bx[0].lb, in[0]);
        num_set_apm(n->bx[0].ub, in[1]);
        bd_sincos(s, &n->sin[0], &n->cos[0], &n->bx[0]);
        put_bdd(s, out, &n->sin[0]);
        put_bdd(s, out + 2, &n->cos[0]);
        break;
    case 2:
        for (int j = 0; j < TWO_DF; j++)
            for (int k = 0; k < TWO_DF; k++)
                num_set_apm(pz->matrix[U + j][U + k], in[j * TWO_DF + k]);
        invert_corner(s, pz->matrix);
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            put(s, out[j], n->inverse[j / TWO_DF][j % TWO_DF]);
        put(s, out[16], n->inverse_err);
        break;
    case 3:
        prismatic_image(s, &n->work[1], pz);
        put_prism(s, out, &n->work[1]);
        break;
    case 4:
        put_bdd(s, out, &n->b_trace);
        break;
    case 5:
        bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
        put_bdd(s, out, &n->minBlam);
        put_bdd(s, out + 2, &n->maxBlam);
        break;
    case 6: {
        bdd *const parm[N_PARMS] = { &n->a, &n->b, &n->c };
        for (int j = 0; j < N_PARMS; j++) {
            num_set_apm(parm[j]->lb, in[2 * j]);
            num_set_apm(parm[j]->ub, in[2 * j + 1]);
        }
        torus_max(s, n->constants[C_T], 0);
        torus_max(s, n->constants[C_B], 1);
        put(s, out[0], n->constants[C_T]);
        put(s, out[1], n->constants[C_B]);
        break;
    }
    case 7:
        bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
        num_set_apm(n->slope, in[PRISM_SZ]);
        num_set_apm(n->least_lam, in[PRISM_SZ + 1]);
        num_set_apm(n->constants[C_LAM_MIN], in[PRISM_SZ + 2]);
        least_lambda(s, n->slope, n->least_lam, &used);
        put(s, out[0], n->slope);
        put(s, out[1], n->least_lam);
        break;
    case 9: {
        const long repeat = (long)apm_get_d(in[PRISM_SZ]);
        const clock_t begin = clock();
        for (long j = 0; j < repeat && !s->inverse_failed; j++)
            prismatic_image(s, &n->work[1], pz);
        apm_set_d(out[0], 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC /
                          (double)(repeat > 0 ? repeat : 1));
        break;
    }
    case 10:
    case 11:
        num_set_apm(n->bx[0].lb, in[0]);
        num_set_apm(n->bx[0].ub, in[1]);
        if (which == 10) {
            num_set_apm(n->bx[1].lb, in[2]);
            num_set_apm(n->bx[1].ub, in[3]);
            bound_product(s, &n->bx[2], &n->bx[0], &n->bx[1]);
        } else {
            bound_square(&n->bx[2], &n->bx[0]);
        }
        put_bdd(s, out, &n->bx[2]);
        break;
    case 12:
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            num_set_apm(n->gauss[j / TWO_DF][j % TWO_DF], in[j]);
        s->inverse_failed = gauss_jordan(s, n->gauss, n->inverse_err, s->precision);
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            put(s, out[j], n->gauss[j / TWO_DF][j % TWO_DF]);
        put(s, out[16], n->inverse_err);
        break;
    default:
        num_set_apm(n->t[5], in[0]);
        uniform_cone(s, n->t[6], n->t[7], n->t[5], (long)apm_get_d(in[1]));
        put(s, out[0], n->t[6]);
        put(s, out[1], n->t[7]);
    }
    return s->inverse_failed ? CV_ESINGULAR : s->failed ? CV_EARITHMETIC : CV_OK;
}
