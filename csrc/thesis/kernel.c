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
    if (num_get_apm(r, x) != APM_OK)
        s->failed = 1;
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
   least_lambda: prism, Tr d, lam d, lam_-min -> the same two
   cone: M, k -> low, high                  image_ns: prism, n -> nanoseconds per image, of n
   product: x lo, hi, y lo, hi -> lo, hi    square: lo, hi -> lo, hi
   gauss_jordan: 4 x 4 matrix -> inverse to the places of the state, err, in a single try
   constants: centres and half-widths of a, b, c, x* -> the constants, Tr d and lam d of d_0 */
enum { SINCOS, BOUND_SINCOS, INVERSE, IMAGE, BTRACE, BLAMS, LEAST_LAMBDA, CONE, IMAGE_NS,
       PRODUCT, SQUARE, GAUSS_JORDAN, CONSTANTS, N_KERNELS };

/* intervals: as many pairs lo, hi come first; prism: a prism does */
static const struct { const char *name; int nin, nout, intervals, prism; } kernels[N_KERNELS] = {
    { "sincos", 1, 2, 0, 0 }, { "bound_sincos", 2, 4, 1, 0 }, { "inverse", 16, 17, 0, 0 },
    { "image", PRISM_SZ, PRISM_SZ, 0, 1 }, { "btrace", PRISM_SZ, 2, 0, 1 },
    { "Blams", PRISM_SZ, 4, 0, 1 },
    { "least_lambda", PRISM_SZ + 3, 2, 0, 1 }, { "cone", 2, 2, 0, 0 },
    { "image_ns", PRISM_SZ + 1, 1, 0, 1 }, { "product", 4, 2, 2, 0 }, { "square", 2, 2, 1, 0 },
    { "gauss_jordan", 16, 17, 0, 0 }, { "constants", 8, 8, 0, 0 }
};

/* Is what the routines take for granted true?  Intervals do not end before they begin.  Of a
   prism, the parameters depend on nothing but themselves, and their widths are not negative; the
   signs of the other rows do not matter.  Blocks d are positive definite.  Nor are the half-widths
   of parameters negative.  The k of a cone is 4 or 16. */
static int makes_sense(int which, apm_t in[])
{
    for (int j = 0; j < kernels[which].intervals; j++)
        if (apm_cmp(in[2 * j], in[2 * j + 1]) > 0)
            return 0;
    for (int j = 0; j < N_PARMS && kernels[which].prism; j++)
        for (int k = 0; k < MAT_DIM; k++) {
            const int sign = apm_sgn(in[MAT_DIM + j * MAT_DIM + k]);
            if (j == k ? sign < 0 : sign != 0)
                return 0;
        }
    switch (which) {
    case LEAST_LAMBDA:
        return apm_sgn(in[PRISM_SZ]) > 0 && apm_sgn(in[PRISM_SZ + 1]) > 0;
    case CONE:
        return apm_get_d(in[1]) == 4.0 || apm_get_d(in[1]) == 16.0;
    case IMAGE_NS:
        return apm_sgn(in[PRISM_SZ]) >= 0 && apm_get_d(in[PRISM_SZ]) <= 1e9;
    case CONSTANTS:
        return apm_sgn(in[3]) >= 0 && apm_sgn(in[4]) >= 0 && apm_sgn(in[5]) >= 0;
    default:
        return 1;
    }
}

/* The numbers that a search begins with. */
static int constants(state *s, apm_t in[], apm_t out[])
{
    double abc[N_PARMS], herman_start[2];
    box root;
    int status;

    for (int j = 0; j < N_PARMS; j++) {                 /* borrowed, and only read */
        *root.centre[j] = *in[j];
        *root.half[j] = *in[N_PARMS + j];
        abc[j] = apm_get_d(in[j]);
    }
    for (int j = 0; j < DEG_FREE; j++)
        *root.xstar[j] = *in[2 * N_PARMS + j];
    set_Herm_start(herman_start, abc, 1);
    status = R(prepare_trial)(s, &root, herman_start, NULL);
    if (status == CV_OK)
        status = R(unit_constants)(s, out);
    put(s, out[N_CONSTANTS], s->n.first_slope);
    put(s, out[N_CONSTANTS + 1], s->n.first_least_lam);
    return status;
}

int R(kernel)(state *s, const char *name, int nin, apm_t in[], int nout, apm_t out[])
{
    numbers *n = &s->n;
    prism *pz = &n->work[0];
    int which = 0, status = CV_OK, used;

    while (which < N_KERNELS && strcmp(name, kernels[which].name) != 0)
        which++;
    if (which == N_KERNELS || nin != kernels[which].nin || nout != kernels[which].nout ||
        !makes_sense(which, in))
        return CV_EARGUMENT;
    s->failed = s->inverse_failed = 0;
    if (kernels[which].prism) {
        get_prism(pz, in);
        global_bounds(s, pz);
        bound_btrace(s, &n->b_trace);
    }
    switch (which) {
    case SINCOS:
        num_set_apm(n->t[0], in[0]);
        num_sincos(s, n->t[1], n->t[2], n->t[0]);
        put(s, out[0], n->t[1]);
        put(s, out[1], n->t[2]);
        break;
    case BOUND_SINCOS:
        num_set_apm(n->bx[0].lb, in[0]);
        num_set_apm(n->bx[0].ub, in[1]);
        bd_sincos(s, &n->sin[0], &n->cos[0], &n->bx[0]);
        put_bdd(s, out, &n->sin[0]);
        put_bdd(s, out + 2, &n->cos[0]);
        break;
    case INVERSE:
        for (int j = 0; j < TWO_DF; j++)
            for (int k = 0; k < TWO_DF; k++)
                num_set_apm(pz->matrix[U + j][U + k], in[j * TWO_DF + k]);
        invert_corner(s, pz->matrix);
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            put(s, out[j], n->inverse[j / TWO_DF][j % TWO_DF]);
        put(s, out[16], n->inverse_err);
        break;
    case IMAGE:
        prismatic_image(s, &n->work[1], pz);
        put_prism(s, out, &n->work[1]);
        break;
    case BTRACE:
        put_bdd(s, out, &n->b_trace);
        break;
    case BLAMS:
        bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
        put_bdd(s, out, &n->minBlam);
        put_bdd(s, out + 2, &n->maxBlam);
        break;
    case LEAST_LAMBDA:
        bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
        num_set_apm(n->slope, in[PRISM_SZ]);
        num_set_apm(n->least_lam, in[PRISM_SZ + 1]);
        num_set_apm(n->constants[C_LAM_MIN], in[PRISM_SZ + 2]);
        least_lambda(s, n->slope, n->least_lam, &used);
        put(s, out[0], n->slope);
        put(s, out[1], n->least_lam);
        break;
    case IMAGE_NS: {
        const long repeat = (long)apm_get_d(in[PRISM_SZ]);
        const clock_t begin = clock();
        for (long j = 0; j < repeat && !s->inverse_failed; j++)
            prismatic_image(s, &n->work[1], pz);
        apm_set_d(out[0], 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC /
                          (double)(repeat > 0 ? repeat : 1));
        break;
    }
    case PRODUCT:
    case SQUARE:
        num_set_apm(n->bx[0].lb, in[0]);
        num_set_apm(n->bx[0].ub, in[1]);
        if (which == PRODUCT) {
            num_set_apm(n->bx[1].lb, in[2]);
            num_set_apm(n->bx[1].ub, in[3]);
            bound_product(s, &n->bx[2], &n->bx[0], &n->bx[1]);
        } else {
            bound_square(&n->bx[2], &n->bx[0]);
        }
        put_bdd(s, out, &n->bx[2]);
        break;
    case GAUSS_JORDAN:
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            num_set_apm(n->gauss[j / TWO_DF][j % TWO_DF], in[j]);
        s->inverse_failed = gauss_jordan(s, n->gauss, n->inverse_err, s->precision);
        for (int j = 0; j < TWO_DF * TWO_DF; j++)
            put(s, out[j], n->gauss[j / TWO_DF][j % TWO_DF]);
        put(s, out[16], n->inverse_err);
        break;
    case CONSTANTS:
        status = constants(s, in, out);
        break;
    default:
        num_set_apm(n->t[5], in[0]);
        uniform_cone(s, n->t[6], n->t[7], n->t[5], apm_get_d(in[1]) == 4.0 ? 4 : 16);
        put(s, out[0], n->t[6]);
        put(s, out[1], n->t[7]);
    }
    return s->inverse_failed ? CV_ESINGULAR : s->failed ? CV_EARITHMETIC : status;
}
