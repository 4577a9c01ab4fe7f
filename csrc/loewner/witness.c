/* witness.c - the vector n on which the second variation is most plainly negative.

   Some n makes (1) negative for one orbit if and only if the recursion d[s] = beta - l, d[j+1] =
   beta - 1/d[j] of the Loewner bounds leads to a d[j] that is not above l.  Past and future have
   the same recursion.  n is chosen for the orbit of the prism's centre and then kept.  Nothing
   rigorous rests on it. */
#include "prism.h"

/* Before the end of an orbit a block falls only below 0.75 l, so that (1) is not next to zero. */
static const double FALL_RATIO = 0.75;

/* The recursion from the left, way 1, or from the right, -1, in the lanes that are active: from
   their sites `begin` to `end`, or to where it falls below l. */
typedef struct {
    int site, last;
    mask begin, end, going, fell, fall; /* fall: where it fell, in the lanes that fell */
    vec d[ENTRIES];
} recursion;

INLINE recursion recursion_of(const batch *w, int way, mask active, mask begin, mask end)
{
    recursion r = { .site = extreme(active, begin, -way),
                    .last = extreme(active, end, way),
                    .begin = begin,
                    .end = end,
                    .going = active };

    for (int i = 0; i < N; i++)
        r.d[sym_at(N, i, i)] = 1.0 / w->l;
    return r;
}

/* One site further.  0: there is none. */
INLINE int advance(batch *w, recursion *r, int way)
{
    const uint64_t site = (uint64_t)r->site;
    const vec end = is_mirror(w, r->site) ? every(0.0) : w->l;
    vec next[ENTRIES];
    mask now, falls;

    if (!any(r->going) || r->site == r->last + way)
        return 0;
    point *const q = site_of(w, r->site);
    vec *const blocks = way > 0 ? q->left : q->right;
    now = r->going & (way > 0 ? TRUTH(r->begin <= site) : TRUTH(r->begin >= site));
    sym_subtract_inverse(N, next, q->beta, r->d);
    for (int k = 0; k < ENTRIES; k++) {
        r->d[k] = pick(now, next[k], r->d[k]);
        blocks[k] = pick(now, next[k], blocks[k]);
    }
    falls = now & ~sym_is_above(N, r->d, pick(TRUTH(r->end == site), end, FALL_RATIO * w->l));
    r->fall = choose(falls, site - none(), r->fall);
    r->fell |= falls;
    r->going &= ~falls & ~TRUTH(r->end == site);
    r->site += way;
    return 1;
}

/* Follows a recursion as far as it goes. */
INLINE recursion followed(batch *w, int way, mask active, mask begin, mask end)
{
    recursion r = recursion_of(w, way, active, begin, end);

    while (advance(w, &r, way))
        continue;
    return r;
}

/* Chooses from and to, between which (1) is negative at the centre, in the lanes that are active.
   Returns where that can be.  low and high: the sites where the recursions from the right and from
   the left fall; all blocks between them are positive.

   Where the recursions fall before they meet, either place will do without the other.  The one with
   the smaller eigenvalue is taken: the other may be next to nothing, however small the prism.
   since and until, the ends of what is summed, enclose the sites 0 and 1. */
static mask choose_ends(batch *w, mask active, mask *low, mask *high)
{
    mask first = none(), last = none();

    for (int k = 0; k < LANES; k++) {
        put_number(&first, k, w->first[k]);
        put_number(&last, k, w->last[k]);
    }
    recursion left = recursion_of(w, 1, w->problem->mirrored ? none() : active, first, last);
    recursion right = recursion_of(w, -1, active, last, first);
    while (advance(w, &left, 1) | advance(w, &right, -1))       /* side by side: that is faster */
        continue;
    if (w->problem->mirrored)
        left = right;
    active = left.fell;
    *high = left.fall;
    *low = right.fall;
    const mask apart = active & (~right.fell | TRUTH(right.fall > left.fall));
    mask at_right = apart & right.fell &
                    TRUTH(sym_least_eigenvalue(N, right.d) < sym_least_eigenvalue(N, left.d));
    if (w->problem->mirrored)
        at_right = active & TRUTH(*low > ORIGIN - none());
    const mask at_left = apart & ~at_right;
    if (any(at_left)) {
        last = choose(at_left, *high, last);
        right = followed(w, -1, at_left, last, first);
        *low =
            choose(at_left, choose(right.fell, right.fall, *high), *low); /* else by a rounding */
    }
    if (any(at_right)) {
        first = choose(at_right, *low, first);
        left = followed(w, 1, at_right, first, last);
        *high = choose(at_right, choose(left.fell, left.fall, *low), *high);
    }
    w->from = choose(active, first, w->from);
    w->to = choose(active, last, w->to);
    w->since =
        choose(active, choose(TRUTH(first < ORIGIN - none()), first, ORIGIN - none()), w->since);
    w->until = choose(active, choose(TRUTH(last > ORIGIN), last, ORIGIN + 1 - none()), w->until);
    return active;
}

/* The site of the least beta between low and high.  n becomes the eigenvector of the quadratic form
   that is left there when all other sites are eliminated. */
static mask site_of_least(const batch *w, mask active, mask low, mask high, vec n[N])
{
    vec form[ENTRIES], value = every(HUGE_VAL);
    mask site = low;

    memset(form, 0, sizeof form);
    for (int j = extreme(active, low, -1); j <= extreme(active, high, 1); j++) {
        const uint64_t here = (uint64_t)j;
        const point *const q = site_of(w, j);
        const mask better = TRUTH(low <= here) & TRUTH(here <= high) & TRUTH(q->least < value);
        value = pick(better, q->least, value);
        site = choose(better, here - none(), site);
        for (int k = 0; k < ENTRIES; k++)
            form[k] = pick(better, q->left[k] + q->right[k] - q->beta[k], form[k]);
    }
    sym_least_eigenvector(N, form, n);
    return site;
}

/* Sets n from that site to `to`, way 1, or to `from`, -1: n = n / d outwards, and zero beyond. */
static void spread(batch *w, int way, mask active, mask site, const vec top[N])
{
    const int last = extreme(active, way > 0 ? w->until : w->since, way);
    vec n[N];

    memset(n, 0, sizeof n);
    for (int j = extreme(active, site, -way); j != last + way; j += way) {
        const uint64_t here = (uint64_t)j;
        point *const q = site_of(w, j);
        const mask start = TRUTH(here == site);
        const mask beyond = way > 0 ? TRUTH(here > site) : TRUTH(here < site);
        const mask own = way > 0 ? TRUTH(here <= w->to) : TRUTH(here >= w->from);
        vec next[N];
        sym_solve(N, next, way > 0 ? q->right : q->left, n);
        for (int i = 0; i < N; i++) {
            n[i] = pick(start, top[i], pick(beyond & own, next[i], every(0.0)));
            q->n[i] = pick(active & (start | beyond), n[i], q->n[i]);
        }
    }
}

/* Chooses from, to and n on the orbits so that (1) is negative at the centre, in the lanes that are
   active; returns where that can be.  n is zero where since..until reaches beyond from..to. */
static mask witness(batch *w, mask active)
{
    mask low, high;
    vec top[N];

    active = choose_ends(w, active, &low, &high);
    if (!any(active))
        return active;
    const mask site = site_of_least(w, active, low, high, top);
    spread(w, -1, active, site, top);
    spread(w, 1, active, site, top);
    return active;
}
