/* thesis.h - the routines of an instance of the thesis's algorithms (csrc/thesis); included after
   it, in its translation unit, since most of them are static. */
#include <time.h>

#include "console.h"

enum { PRISM_SIZE = MAT_DIM + MAT_DIM * MAT_DIM };

/* ---- numbers in and out */

static void get_prism(prism *pz, apm_t in[])
{
    num_t *const x[MAT_DIM] = { &pz->centre.p[0], &pz->centre.p[1], &pz->centre.p[2],
                                &pz->centre.u[0], &pz->centre.u[1], &pz->centre.v[0],
                                &pz->centre.v[1] };
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

static void get_bdd(bdd *x, apm_t in[2])
{
    num_set_apm(x->lb, in[0]);
    num_set_apm(x->ub, in[1]);
}

static void put_bdd(state *s, apm_t r[2], const bdd *x)
{
    put(s, r[0], x->lb);
    put(s, r[1], x->ub);
}

static void put_prism(state *s, apm_t out[], prism *pz)
{
    num_t *const x[MAT_DIM] = { &pz->centre.p[0], &pz->centre.p[1], &pz->centre.p[2],
                                &pz->centre.u[0], &pz->centre.u[1], &pz->centre.v[0],
                                &pz->centre.v[1] };
    for (int j = 0; j < MAT_DIM; j++) {
        put(s, out[j], *x[j]);
        for (int k = 0; k < MAT_DIM; k++)
            put(s, out[MAT_DIM + j * MAT_DIM + k], pz->matrix[j][k]);
    }
}

static void put_square(state *s, apm_t out[], num_t matrix[TWO_DF][TWO_DF])
{
    for (int j = 0; j < TWO_DF * TWO_DF; j++)
        put(s, out[j], matrix[j / TWO_DF][j % TWO_DF]);
}

/* ---- the routines: CV_OK or an error; those that take a prism find it in work[0], and its
   bounds */

typedef int routine(state *s, apm_t in[], apm_t out[]);

static int k_sincos(state *s, apm_t in[], apm_t out[])          /* x -> sin, cos */
{
    num_t *const t = s->n.t;

    num_set_apm(t[0], in[0]);
    num_sincos(s, t[1], t[2], t[0]);
    put(s, out[0], t[1]);
    put(s, out[1], t[2]);
    return CV_OK;
}

static int k_bound_sincos(state *s, apm_t in[], apm_t out[]) /* lo, hi -> of sin, of cos */
{
    numbers *const n = &s->n;

    get_bdd(&n->bx[0], in);
    bd_sincos(s, &n->sin[0], &n->cos[0], &n->bx[0]);
    put_bdd(s, out, &n->sin[0]);
    put_bdd(s, out + 2, &n->cos[0]);
    return CV_OK;
}

static int k_inverse(state *s, apm_t in[], apm_t out[])     /* 4 x 4 matrix -> inverse, error */
{
    prism *const pz = &s->n.work[0];

    for (int j = 0; j < TWO_DF; j++)
        for (int k = 0; k < TWO_DF; k++)
            num_set_apm(pz->matrix[U + j][U + k], in[j * TWO_DF + k]);
    invert_corner(s, pz->matrix);
    put_square(s, out, s->n.inverse);
    put(s, out[16], s->n.inverse_err);
    return CV_OK;
}

/* The same to the places of the state, in a single try. */
static int k_gauss_jordan(state *s, apm_t in[], apm_t out[])
{
    numbers *const n = &s->n;

    for (int j = 0; j < TWO_DF * TWO_DF; j++)
        num_set_apm(n->gauss[j / TWO_DF][j % TWO_DF], in[j]);
    s->inverse_failed = gauss_jordan(s, n->gauss, n->inverse_err, s->precision);
    put_square(s, out, n->gauss);
    put(s, out[16], n->inverse_err);
    return CV_OK;
}

static int k_image(state *s, apm_t in[], apm_t out[])           /* prism -> prism */
{
    (void)in;
    prismatic_image(s, &s->n.work[1], &s->n.work[0]);
    put_prism(s, out, &s->n.work[1]);
    return CV_OK;
}

/* Prism -> bounds of the sums of |beta|, |(gamma - gamma_c) P_pp| and |beta - beta_c|. */
static int k_row_sums(state *s, apm_t in[], apm_t out[])
{
    numbers *const n = &s->n;
    prism *const pz = &n->work[0];

    (void)in;
    set_sines(s, pz->centre.v);
    find_jacobian(s, &n->deriv, &pz->centre);
    bound_beta(s, &n->deriv);
    bound_gamma(s, &n->deriv, pz);
    put(s, out[0], n->beta_star);
    put(s, out[1], n->gamma_dif);
    put(s, out[2], n->beta_dif);
    return CV_OK;
}

static int k_image_ns(state *s, apm_t in[], apm_t out[])    /* prism, n -> ns per image, of n */
{
    const double repeat = apm_get_d(in[PRISM_SIZE]);
    const clock_t begin = clock();

    if (!(repeat >= 0.0 && repeat <= 1e9))
        return CV_EARGUMENT;
    for (long j = 0; j < (long)repeat && !s->inverse_failed; j++)
        prismatic_image(s, &s->n.work[1], &s->n.work[0]);
    apm_set_d(out[0], 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / fmax(repeat, 1.0));
    return CV_OK;
}

static int k_btrace(state *s, apm_t in[], apm_t out[])          /* prism -> lo, hi */
{
    (void)in;
    put_bdd(s, out, &s->n.b_trace);
    return CV_OK;
}

static int k_Blams(state *s, apm_t in[], apm_t out[]) /* prism -> least lo, hi, largest lo, hi */
{
    numbers *const n = &s->n;

    (void)in;
    bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
    put_bdd(s, out, &n->minBlam);
    put_bdd(s, out + 2, &n->maxBlam);
    return CV_OK;
}

/* Prism, Tr d, lam d, lam_-min -> the first two of the next block.  The block d is positive
   definite. */
static int k_least_lambda(state *s, apm_t in[], apm_t out[])
{
    numbers *const n = &s->n;
    int used;

    if (apm_sgn(in[PRISM_SIZE]) <= 0 || apm_sgn(in[PRISM_SIZE + 1]) <= 0)
        return CV_EARGUMENT;
    bd_Blams(s, &n->minBlam, &n->maxBlam, &n->b_trace);
    num_set_apm(n->slope, in[PRISM_SIZE]);
    num_set_apm(n->least_lam, in[PRISM_SIZE + 1]);
    num_set_apm(n->constants[CV_LAM_MIN], in[PRISM_SIZE + 2]);
    least_lambda(s, n->slope, n->least_lam, &used);
    put(s, out[0], n->slope);
    put(s, out[1], n->least_lam);
    return CV_OK;
}

static int k_cone(state *s, apm_t in[], apm_t out[])            /* M, k -> low, high */
{
    num_t *const t = s->n.t;
    const double k = apm_get_d(in[1]);

    if (k != 4.0 && k != 16.0)
        return CV_EARGUMENT;
    num_set_apm(t[5], in[0]);
    uniform_cone(s, t[6], t[7], t[5], (int)k);
    put(s, out[0], t[6]);
    put(s, out[1], t[7]);
    return CV_OK;
}

static int k_product(state *s, apm_t in[], apm_t out[])         /* x lo, hi, y lo, hi -> lo, hi */
{
    bdd *const x = s->n.bx;

    get_bdd(&x[0], in);
    get_bdd(&x[1], in + 2);
    bound_product(s, &x[2], &x[0], &x[1]);
    put_bdd(s, out, &x[2]);
    return CV_OK;
}

static int k_square(state *s, apm_t in[], apm_t out[])          /* lo, hi -> lo, hi */
{
    bdd *const x = s->n.bx;

    get_bdd(&x[0], in);
    bound_square(&x[2], &x[0]);
    put_bdd(s, out, &x[2]);
    return CV_OK;
}

/* Centres and half-widths of a, b, c, x* -> what a search begins with: the constants of the
   theorem, Tr d and lam d of d_0. */
static int k_constants(state *s, apm_t in[], apm_t out[])
{
    double abc[N_PARMS], herman_start[2];
    box root;
    int status;

    for (int j = 0; j < N_PARMS; j++) {                 /* borrowed, and only read */
        if (apm_sgn(in[N_PARMS + j]) < 0)
            return CV_EARGUMENT;
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
    put(s, out[CV_N_CONSTANTS], s->n.first_slope);
    put(s, out[CV_N_CONSTANTS + 1], s->n.first_least_lam);
    return status;
}

/* ---- the table */

/* intervals: as many pairs lo, hi come first; prism: a prism does. */
static const struct {
    shape shape;
    int intervals, prism;
    routine *run;
} kernels[] = {
    { { "sincos", 1, 2 }, 0, 0, k_sincos },
    { { "bound_sincos", 2, 4 }, 1, 0, k_bound_sincos },
    { { "inverse", 16, 17 }, 0, 0, k_inverse },
    { { "gauss_jordan", 16, 17 }, 0, 0, k_gauss_jordan },
    { { "image", PRISM_SIZE, PRISM_SIZE }, 0, 1, k_image },
    { { "row_sums", PRISM_SIZE, 3 }, 0, 1, k_row_sums },
    { { "image_ns", PRISM_SIZE + 1, 1 }, 0, 1, k_image_ns },
    { { "btrace", PRISM_SIZE, 2 }, 0, 1, k_btrace },
    { { "Blams", PRISM_SIZE, 4 }, 0, 1, k_Blams },
    { { "least_lambda", PRISM_SIZE + 3, 2 }, 0, 1, k_least_lambda },
    { { "cone", 2, 2 }, 0, 0, k_cone },
    { { "product", 4, 2 }, 2, 0, k_product },
    { { "square", 2, 2 }, 1, 0, k_square },
    { { "constants", 8, 8 }, 0, 0, k_constants },
};

static int are_intervals(apm_t in[], int count)
{
    for (int j = 0; j < count; j++)
        if (apm_cmp(in[2 * j], in[2 * j + 1]) > 0)
            return 0;
    return 1;
}

/* The parameters depend on nothing but themselves, and their widths are not negative; the signs of
   the other rows do not matter. */
static int is_prism(apm_t in[])
{
    for (int j = 0; j < N_PARMS; j++)
        for (int k = 0; k < MAT_DIM; k++) {
            const int sign = apm_sgn(in[MAT_DIM + j * MAT_DIM + k]);
            if (j == k ? sign < 0 : sign != 0)
                return 0;
        }
    return 1;
}

int R(thesis_answer)(state *s, const question *q)
{
    size_t which = 0;
    int status;

    while (which < sizeof kernels / sizeof *kernels && !asks_for(q, &kernels[which].shape))
        which++;
    if (which == sizeof kernels / sizeof *kernels)
        return NOT_MINE;
    if (!are_intervals(q->in, kernels[which].intervals) ||
        (kernels[which].prism && !is_prism(q->in)))
        return CV_EARGUMENT;
    s->failed = s->inverse_failed = 0;
    if (kernels[which].prism) {
        get_prism(&s->n.work[0], q->in);
        global_bounds(s, &s->n.work[0]);
        bound_btrace(s, &s->n.b_trace);
    }
    status = kernels[which].run(s, q->in, q->out);
    return status == CV_EARGUMENT ? status
         : s->inverse_failed      ? CV_ESINGULAR
         : s->failed              ? CV_EARITHMETIC
                                  : status;
}
