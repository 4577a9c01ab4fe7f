/* engine.h - the hooks of one engine; included after it, in its translation unit, since all that it
   has is static.  All lanes do the same, and the last is looked at. */
#ifdef LANES
#include "hooks.h"

/* What other prisms may have left there is not to matter: it is made as strange as can be. */
static void poison(void *work, const loewner *problem, int s, int t)
{
    batch *const w = work;

    w->problem = problem;
    if (!make_room(w, ORIGIN + s - 2) || !make_room(w, ORIGIN + t + 2))
        return;
    for (int j = ORIGIN + s - 2; j <= ORIGIN + t + 2; j++) {
        point *const q = site_of(w, j);
        vec *const parts[] = { q->lin[0], (vec *)q->x };
        const size_t sizes[] = { vectors_of(problem),
                                 (sizeof *q - offsetof(point, x)) / sizeof(vec) };
        for (int i = 0; i < 2; i++)
            for (size_t k = 0; k < sizes[i]; k++)
                parts[i][k] = every((k + (size_t)j) % 3 == 0 ? -0x1p300 : 1e3);
    }
}

static int follow_root(void *work, const loewner *problem, int s, int t)
{
    static const cv_cell whole;
    batch *const w = work;
    loewner_cell c;
    int good = 1;

    w->problem = problem;
    if (!loewner_prism(problem, &whole, &c))
        return 0;
    for (int k = 0; k < LANES; k++)
        set_lane(w, k, &c);
    if (!begin(w) || !follow(w, ORIGIN + s) || !follow(w, ORIGIN + t))
        return 0;
    for (int k = 0; k < LANES; k++) {
        w->first[k] = ORIGIN + s;
        w->last[k] = ORIGIN + (t > 1 ? t : 1);
    }
    for (int j = s; j <= t; j++)
        good = good && holds(&site_of(w, ORIGIN + j)->reached, LANES - 1);
    return good;
}

/* The bound where the multipliers are not what (2) says: with what it leaves, and what roundings
   make of that, but no other roundings. */
static void disturb(batch *w, mask active)
{
    sums t;

    for (int j = begin_of(w, active) + 1; j < end_of(w, active); j++)
        for (int i = 0; i < N; i++)
            site_of(w, j)->mu[i] *= 1.0 + 0x1p-20 * (double)(j % 3 - 1);
    sum_up(w, &t, active);
    leave_exactly(w, &t, active);
    memcpy(w->slope, t.slope, sizeof t.slope);
    memcpy(w->square, t.square, sizeof t.square);
    w->bound = t.centre + t.rest + t.cubes + summit(w, 0);
    w->rounding = t.left;
}

static int bound_root(void *work, int signs, double *bound, double *l, double *rounding, int *first,
                      double n[][ANGLES], int most)
{
    enum { K = LANES - 1 };
    batch *const w = work;
    const mask active = witness(w, ~none());
    const int from = number(&w->from, K), to = number(&w->to, K);

    *l = at(&w->l, K);
    if (!holds(&active, K) || to - from >= most)
        return 0;
    for (int j = from; j <= to && signs == 3; j++)
        for (int i = 0; i < N; i++)
            site_of(w, j)->n[i] *= 0x1p-300;
    bound_second_variation(w, active, signs == 1);
    if (signs == 2)
        disturb(w, active);
    *bound = at(&w->bound, K);
    *rounding = at(&w->rounding, K);
    *first = from - ORIGIN;
    for (int j = from; j <= to; j++)
        for (int i = 0; i < N; i++)
            n[j - from][i] = at(&site_of(w, j)->n[i], K);
    return to - from + 1;
}

static void copy(double *to, const vec *from, int count)
{
    for (int k = 0; k < count; k++)
        to[k] = at(from + k, LANES - 1);
}

static void look_root(const void *work, int n, known_point *p)
{
    const batch *const w = work;
    const point *const q = site_of(w, ORIGIN + n);
    const int columns = w->problem->columns, *const axis = w->problem->axis;

    memset(p, 0, sizeof *p);
    for (int i = 0; i < N; i++) {
        const uint64_t x = ((const uint64_t *)&q->x[i])[LANES - 1];
        p->x[i] = (double)(x >> 32);
        p->x_low[i] = (double)(x & UINT32_MAX);
    }
    for (int i = 0; i < N; i++)
        for (int k = 0, kl = 0; k < columns; k++) {
            copy(&p->lin[i][axis[k]], &q->lin[k][i], 1);
            for (int l = k; l < columns; l++)
                copy(&p->quad[i][sym_at(MOST_COLUMNS, axis[k], axis[l])], &q->quad[kl++][i], 1);
        }
    copy(p->rem, q->rem, N);
    copy(p->lin_bound, q->lin_bound, waves_of(w));
    copy(p->quad_bound, q->quad_bound, waves_of(w));
    copy(p->nonlin_bound, q->nonlin_bound, waves_of(w));
    copy(p->rad, q->rad, waves_of(w));
    copy(p->residual, w->residual, N);
    copy(p->force, q->force, N);
    copy(p->beta, q->beta, ENTRIES);
    copy(p->d, q->d, ENTRIES);
    copy(&p->err_beta, &q->err_beta, 1);
    copy(p->mu, q->mu, N);
}

static void sincos_of(uint64_t turns, int64_t *sine, int64_t *cosine, double y[])
{
    mask s, c;
    vec rest;

    turns_sincos(&s, &c, turns - none());
    const vec first = sine_in_two(s, &rest), simply = sine_of(s);
    const sum2 fine = fine_sine(turns - none());
    *sine = ((const int64_t *)&s)[LANES - 1];
    *cosine = ((const int64_t *)&c)[LANES - 1];
    y[0] = at(&first, LANES - 1) == at(&simply, LANES - 1) ? at(&first, LANES - 1) : NAN;
    y[1] = at(&rest, LANES - 1);
    y[2] = at(&fine.high, LANES - 1);
    y[3] = at(&fine.low, LANES - 1);
}

/* exact_pull of the last wave at a point of these numbers. */
static void pull_of(void *work, const loewner *problem, uint64_t turns, const double n_mu[4],
                    double y[4])
{
    static const cv_cell whole;
    batch *const w = work;
    const int last = problem->waves - 1;
    loewner_cell c;
    point q;

    memset(&q, 0, sizeof q);
    w->problem = problem;
    loewner_prism(problem, &whole, &c);
    for (int k = 0; k < LANES; k++)
        set_lane(w, k, &c);
    q.x[0] = turns - none();
    for (int i = 0; i < N && i < 2; i++) {
        q.n[i] = every(n_mu[i]);
        q.mu[i] = every(n_mu[2 + i]);
    }
    const sum2 pull = exact_pull(w, &q, last);
    y[0] = at(&pull.high, LANES - 1);
    y[1] = at(&pull.low, LANES - 1);
    y[2] = at(&w->p[last], LANES - 1);
    y[3] = at(&w->p_low[last], LANES - 1);
}

/* n times x, summed as over n sites. */
static double sum_of(int n, double x)
{
    vec total = every(0.0), lost = every(0.0), block = every(0.0);

    for (int j = 0; j < n; j++) {
        block += every(x);
        if (j % BLOCK == 0)
            add_block(&total, &lost, &block, 1);
    }
    end_blocks(&total, &lost, &block, 1);
    return at(&total, LANES - 1);
}

#define HOOKS_OF(engine) hooks_##engine
#define HOOKS(engine) HOOKS_OF(engine)
const hooks
    HOOKS(ENGINE) = { poison, follow_root, bound_root, look_root, sincos_of, pull_of, sum_of };
#endif
