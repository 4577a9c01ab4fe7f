/* try.c - prisms from beginning to end. */
#include "prism.h"

/* No proof rests on these thresholds: they decide how much is tried, and what is cut. */
enum { CUTS_BEHIND_MAX = 4 };           /* An axis may have 4 cuts fewer than the worst one. */
enum { TRIES_PER_LENGTH = 8 };          /* An orbit is tried again when it is an eighth longer. */
static const double SIZE_RATIO_MIN = 0.25;  /* Smaller parts of the largest wave count less. */
static const double BOUND_RATIO_MAX = 2.0; /* A bound above twice the least one ends the tries. */

/* How much the rad along each wave counts when it is asked how far an orbit is known: a wave that
   is small beside the largest bends orbits little, however large the rad. */
static void weigh_waves(batch *w, int k)
{
    double most = 0.0;

    for (int i = 0; i < waves_of(w); i++)
        most = fmax(most, at(&w->size[i], k));
    for (int i = 0; i < waves_of(w); i++) {
        const double part = at(&w->size[i], k) / (SIZE_RATIO_MIN * most);
        put_at(&w->weight[i], k, part < 1.0 ? sqrt(sqrt(part)) : 1.0);
    }
}

/* Sets the prism of lane k.  The residual is the sum over the waves of the error in wave_at. */
static void set_lane(batch *w, int k, const loewner_cell *c)
{
    double residual[N] = { 0.0 };

    for (int i = 0; i < waves_of(w); i++) {
        put_truth(&w->backward[i], k, c->force[i] < 0);
        ((uint64_t *)&w->force[i])[k] =
            2 * (uint64_t)(c->force[i] < 0 ? -c->force[i] : c->force[i]);
        put_at(&w->p[i], k, c->p[i]);
        put_at(&w->p_low[i], k, c->p_low[i]);
        put_at(&w->err_amp[i], k, c->err_amp[i]);
        double h = 0.0;
        for (int column = N; column < w->problem->columns; column++) {
            const double part = c->part[i][w->problem->axis[column] - T1];
            put_at(&w->part[i][column], k, part);
            h += fabs(part);
        }
        put_at(&w->h[i], k, h);
        put_at(&w->size[i], k, fabs(c->p[i]) + h + c->err_amp[i]);
        for (int j = 0; j < N && i >= FIRST; j++)
            residual[j] +=
                fabs(k_of(w, i)[j]) * (0x1p-59 * (fabs(c->p[i]) + ldexp(1.0, w->problem->coarse)));
    }
    for (int i = 0; i < N; i++) {
        ((uint64_t *)&w->x1[i])[k] = c->x1[i];
        put_at(&w->residual[i], k, residual[i]);
        put_at(&w->width[i], k, c->width[i]);
        for (int column = N; column < w->problem->columns; column++)
            put_at(&w->shift[i][column], k, c->shift[i][w->problem->axis[column] - T1]);
    }
    put_at(&w->l, k, c->l);
    weigh_waves(w, k);
}

/* The state of a lane while its prism is tried. */
typedef struct {
    double least; /* bound yet */
    int contradicted; /* the points with which the centre first did, or 0 */
    int tried; /* the points of the last attempt */
    int ended, why; /* the orbit goes no further */
} progress;

/* Tries to prove the prisms that are active with the orbits as far as they are followed. */
static void attempt(batch *w, mask active, progress s[], outcome *const out[], mask *going)
{
    const mask contradict = witness(w, active);

    if (any(contradict))
        bound_second_variation(w, contradict, 0);
    for (int k = 0; k < LANES; k++) {
        if (!holds(&active, k))
            continue;
        s[k].tried = points_of(w, k);
        if (holds(&contradict, k)) {
            const double bound = at(&w->bound, k), rounding = at(&w->rounding, k);
            verdict *const v = &out[k]->v;
            const int from = number(&w->from, k), to = number(&w->to, k);
            v->nsteps = to - from + 1 + (is_mirror(w, from) ? to - from : 0);
            v->no_tori = bound < 0.0;
            v->reason = bound - 2.0 * rounding < 0.0 ? CV_REASON_ARITHMETIC : CV_REASON_TOO_BIG;
            if (!s[k].contradicted)
                s[k].contradicted = s[k].tried;
            if (v->no_tori || bound > BOUND_RATIO_MAX * s[k].least)
                put_truth(going, k, 0);
            s[k].least = bound < s[k].least ? bound : s[k].least;
        }
        if (s[k].ended)
            put_truth(going, k, 0);
    }
}

/* How far a column of a point's L, or its square in T, reaches along the waves of lane k, by their
   weights: the ends of orbits whose x_1 moves with a parameter may know of it by T alone. */
static double reach_of(const batch *w, const point *q, int column, int k)
{
    const int square = sym_at(w->problem->columns, column, column);
    double most = 0.0;

    FOR_WAVES(w, i) {
        const vec straight = mag(dot_k(w, i, q->lin[column]));
        const vec bent = mag(dot_k(w, i, q->quad[square]));
        most = fmax(most, at(&w->weight[i], k) * fmax(at(&straight, k), at(&bent, k)));
    }
    return most;
}

/* The column that makes the ends of lane k's orbit widest, as waves feel them. */
static int widest_at_ends(const batch *w, int k)
{
    double width[COLUMNS];
    int widest = 0;

    for (int c = 0; c < w->problem->columns; c++) {
        width[c] =
            reach_of(w, site_of(w, w->first[k]), c, k) + reach_of(w, site_of(w, w->last[k]), c, k);
        if (width[c] > width[widest])
            widest = c;
    }
    return widest;
}

/* The column that has the largest share in the bound. */
static int worst_of(const batch *w, int k)
{
    int worst = 0;

    for (int c = 1; c < w->problem->columns; c++)
        if (at(&w->share[c], k) > at(&w->share[worst], k))
            worst = c;
    return worst;
}

/* The cuts of a column's axis, or of these as many as made a parameter narrow: a range whose ends
   differ by orders of magnitude is cut until the amplitudes are about the same in all of a cell. */
static int fineness(const batch *w, int k, int column, const cv_cell *cell)
{
    const int cuts = cell->cuts[w->problem->axis[column]];
    double widest = 0.0;

    FOR_WAVES(w, i)
        widest = fmax(widest, fabs(at(&w->part[i][column], k)) / at(&w->size[i], k));
    return column < N || ldexp(widest, cuts) <= 1.0 ? cuts : -ilogb(widest);
}

/* Why the prism of lane k failed: blames a column, and tells what its halves should know.

   Where (1) is negative at the centre, that is the column with the largest share in the bound.  But
   (1) is zero on some surface of the prism's points, and near it the bound stays positive however
   often this column is cut, while a longer orbit would make (1) plainly negative.  That orbit was
   not followed as another column made its end too wide; so if the cuts of that one lag behind by
   more than CUTS_BEHIND_MAX, it is cut instead. */
static void blame(const batch *w, int k, const progress *s, const cv_cell *cell, outcome *out)
{
    const loewner *const problem = w->problem;
    const int widest = widest_at_ends(w, k);
    int worst = s->contradicted ? worst_of(w, k) : widest;

    if (s->ended && fineness(w, k, widest, cell) + CUTS_BEHIND_MAX < fineness(w, k, worst, cell))
        worst = widest;
    if (!s->contradicted)
        out->v.reason = s->why;
    if (out->cut_off && !s->contradicted)
        worst = -1; /* as halves' orbits stay near, they are hopeless, too */
    if (worst >= 0 && cut_helps(problem, cell, problem->axis[worst]))
        out->axis = problem->axis[worst];
    else if (out->v.reason == CV_REASON_TOO_BIG)
        out->v.reason = CV_REASON_ARITHMETIC;
    out->v.nsteps = points_of(w, k);
    out->hint = (s->contradicted ? s->contradicted : points_of(w, k)) - 2;
    if (out->hint < 2)
        out->hint = 0;
}

/* All orbits grow by a point at a time, and are tried at the lengths of one sequence, so that the
   lanes keep step; one that has ended waits for the next of them. */
static void follow_and_attempt(batch *w, mask going, int n, const cv_cell *const cells[],
                               progress s[], outcome *const out[])
{
    for (int points = 1, next = 1; any(going); points += 1 + w->problem->mirrored) {
        mask active = none();
        int growing = 0;

        for (int k = 0; k < n; k++)
            if (holds(&going, k)) {
                s[k].ended = s[k].ended || !lengthen(w, k, &s[k].why);
                growing |= !s[k].ended;
                put_truth(&active, k,
                          points_of(w, k) > s[k].tried && (s[k].ended || points >= cells[k]->hint));
                if (s[k].ended && points_of(w, k) == s[k].tried)
                    put_truth(&going, k, 0);
            }
        if (points >= next || !growing) {
            if (any(active))
                attempt(w, active, s, out, &going);
            next = points + 2 + points / TRIES_PER_LENGTH;
        }
    }
}

static int try_prisms(void *work, const loewner *problem, int n, const cv_cell *const cells[],
                      outcome *const out[])
{
    batch *const w = work;
    progress s[LANES] = { { 0 } };
    loewner_cell c, filler = { 0 };
    mask going = none(), blamed = none();

    w->problem = problem;
    w->out_of_memory = 0;
    for (int k = 0; k < n; k++) {
        s[k].least = HUGE_VAL;
        *out[k] = (outcome){ .axis = -1, .tries = 1 };
        out[k]->v.reason = /* without waves nothing contradicts anything */
            problem->waves == FIRST ? CV_REASON_CENTRE : CV_REASON_ARITHMETIC;
        if (!loewner_prism(problem, cells[k], &c))
            continue;
        put_truth(&going, k, 1);
        set_lane(w, k, &c);
        filler = c;
    }
    for (int k = 0; k < LANES; k++)
        if (!holds(&going, k))
            set_lane(w, k, &filler);
    if (!begin(w))
        return CV_ENOMEM;
    follow_and_attempt(w, going, n, cells, s, out);
    if (w->out_of_memory)
        return CV_ENOMEM;
    for (int k = 0; k < n; k++) {
        out[k]->cut_off = s[k].why == CV_REASON_TOO_LONG;
        put_truth(&blamed, k, holds(&going, k) && !out[k]->v.no_tori && s[k].contradicted);
    }
    if (any(blamed))
        bound_shares(w, blamed);
    for (int k = 0; k < n; k++)
        if (holds(&going, k) && !out[k]->v.no_tori)
            blame(w, k, &s[k], cells[k], out[k]);
    return CV_OK;
}

const engine ENGINE = { N, LANES, sizeof(batch), try_prisms, free_room };
