/* engine.h - the hooks of one engine; included after it, in its translation unit, since all that it
   has is static.  All lanes do the same, and the last is looked at. */
#ifdef LANES
#include "hooks.h"

/* What other prisms may have left there is not to matter: it is made as strange as can be. */
static void poison(void *work, int s, int t)
{
    batch *const w = work;

    for (int j = ORIGIN + s - 2; j <= ORIGIN + t + 2; j++)
        for (size_t k = 0; k < sizeof *w->orbit / sizeof(vec); k++)
            ((vec *)&w->orbit[j])[k] = every((k + (size_t)j) % 3 == 0 ? -0x1p300 : 1e3);
}

static int follow_root(void *work, const loewner *problem, int s, int t)
{
    static const cv_cell whole = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, 0 };
    batch *const w = work;
    loewner_cell c;
    int good = 1;

    w->problem = problem;
    loewner_prism(problem, &whole, &c);
    for (int k = 0; k < LANES; k++)
        set_lane(w, k, &c);
    begin(w);
    follow(w, ORIGIN + s);
    follow(w, ORIGIN + t);
    for (int k = 0; k < LANES; k++) {
        w->first[k] = ORIGIN + s;
        w->last[k] = ORIGIN + (t > 1 ? t : 1);
    }
    for (int j = s; j <= t; j++)
        good = good && holds(&w->orbit[ORIGIN + j].reached, LANES - 1);
    return good;
}

static int bound_root(void *work, int signs, double *bound, double *l, double *rounding, int *first,
                      double n[][2], int most)
{
    enum { K = LANES - 1 };
    batch *const w = work;
    const mask active = witness(w, ~none());
    const int from = number(&w->from, K), to = number(&w->to, K);

    *l = at(&w->l, K);
    if (!holds(&active, K) || to - from >= most)
        return 0;
    bound_second_variation(w, active, signs);
    *bound = at(&w->bound, K);
    *rounding = at(&w->rounding, K);
    *first = from - ORIGIN;
    for (int j = from; j <= to; j++)
        for (int i = 0; i < 2; i++)
            n[j - from][i] = at(&w->orbit[j].n[i], K);
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
    const point *const q = w->orbit + ORIGIN + n;
    const int columns = w->problem->columns, *const axis = w->problem->axis;

    memset(p, 0, sizeof *p);
    copy(p->x, q->x, 2);
    for (int i = 0; i < 2; i++)
        for (int k = 0, kl = 0; k < columns; k++) {
            copy(&p->lin[i][axis[k]], &q->lin[i][k], 1);
            for (int l = k; l < columns; l++)
                copy(&p->quad[i][pair(COLUMNS, axis[k], axis[l])], &q->quad[i][kl++], 1);
        }
    copy(p->rem, q->rem, 2);
    copy(p->lin_bound, q->lin_bound, waves_of(w));
    copy(p->quad_bound, q->quad_bound, waves_of(w));
    copy(p->nonlin_bound, q->nonlin_bound, waves_of(w));
    copy(p->rad, q->rad, waves_of(w));
    copy(p->residual, q->residual, 2);
    copy(p->force, q->force, 2);
    copy(p->beta, q->beta, 3);
    copy(p->d, q->d, 3);
    copy(&p->err_beta, &q->err_beta, 1);
    copy(p->mu, q->mu, 2);
}

#define HOOKS_OF(engine) hooks_##engine
#define HOOKS(engine) HOOKS_OF(engine)
const hooks HOOKS(ENGINE) = { poison, follow_root, bound_root, look_root };
#endif
