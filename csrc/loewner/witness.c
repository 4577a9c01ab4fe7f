/* witness.c - the vector n on which the second variation is most plainly negative.

   Some n makes (1) negative for one orbit if and only if the recursion d[s] = beta - l, d[j+1] =
   beta - 1/d[j] of the Loewner bounds leads to a d[j] that is not above l; past and future are used
   alike.  n is chosen for the orbit of the prism's centre and then kept.  Nothing rigorous rests on
   it. */
#include "arith/sym2.h"
#include "prism.h"

static const double PLAINLY = 0.75; /* of l: blocks must fall below it while the orbit goes on */

/* The recursion from the left, way 1, or from the right, -1, in the lanes that are active: from
   their sites `begin` to `end`, or to where it falls below l. */
typedef struct {
    int way, site, last;
    mask begin, end, going, fell, fall; /* fall: where it fell, in the lanes that fell */
    vec d[3];
} recursion;

INLINE recursion recursion_of(const batch *w, int way, mask active, mask begin, mask end)
{
    return (recursion){ way,
                        extreme(active, begin, -way),
                        extreme(active, end, way),
                        begin,
                        end,
                        active,
                        none(),
                        none(),
                        { 1.0 / w->l, every(0.0), 1.0 / w->l } };
}

/* One site further.  0: there is none. */
INLINE int advance(batch *w, recursion *r, int way)
{
    const uint64_t site = (uint64_t)r->site;
    point *const q = site_of(w, r->site);
    vec *const blocks = way > 0 ? q->left : q->right, next[3];
    mask now, falls;

    if (!any(r->going) || r->site == r->last + way)
        return 0;
    now = r->going & (way > 0 ? TRUTH(r->begin <= site) : TRUTH(r->begin >= site));
    sym2_subtract_inverse(next, q->beta, r->d);
    for (int k = 0; k < 3; k++) {
        r->d[k] = pick(now, next[k], r->d[k]);
        blocks[k] = pick(now, next[k], blocks[k]);
    }
    falls = now & ~sym2_is_above(r->d, pick(TRUTH(r->end == site), w->l, PLAINLY * w->l));
    r->fall = choose(falls, site - none(), r->fall);
    r->fell |= falls;
    r->going &= ~falls & ~TRUTH(r->end == site);
    r->site += way;
    return 1;
}

/* Chooses from, to and n on the orbits so that (1) is negative at the centre, in the lanes that are
   active; returns where that can be.  (Long, as all its parts work on the same dozen of masks.)

   Between the places where the recursions from both ends fall all blocks are positive.  There n is,
   at the site of the least beta, the eigenvector of the quadratic form that is left there when all
   others are eliminated; outwards n = n / d.  Where the recursions fall before they meet, either
   place will do by itself, and the plainer one is taken: the other may be next to nothing, however
   small the prism.  The sites that are summed over, since..until, hold 0 and 1, with n = 0 where
   need be. */
static mask witness(batch *w, mask active)
{
    vec form[3] = { every(0.0), every(0.0), every(0.0) }, n[2] = { every(0.0), every(0.0) };
    vec value = every(HUGE_VAL), top[2];
    mask first = none(), last = none(), fall, from, to, since, until, site, alone, other;
    recursion left, right;

    for (int k = 0; k < LANES; k++) {
        put_number(&first, k, w->first[k]);
        put_number(&last, k, w->last[k]);
    }
    left = recursion_of(w, 1, active, first, last);
    right = recursion_of(w, -1, active, last, first);
    while (advance(w, &left, 1) | advance(w, &right, -1))       /* side by side: that is faster */
        continue;
    active = left.fell;
    if (!any(active))
        return active;
    fall = left.fall;
    from = right.fall;
    to = last;
    alone = active & (~right.fell | TRUTH(from > fall));          /* two places apart */
    other =
        alone & right.fell & TRUTH(sym2_least_eigenvalue(right.d) < sym2_least_eigenvalue(left.d));
    alone &= ~other;
    if (any(alone)) {                   /* the left one */
        to = choose(alone, fall, to);
        right = recursion_of(w, -1, alone, to, first);
        while (advance(w, &right, -1))
            continue;
        from = choose(alone, choose(right.fell, right.fall, fall), from); /* else by a rounding */
    }
    if (any(other)) {                   /* the right one */
        first = choose(other, from, first);
        left = recursion_of(w, 1, other, first, last);
        while (advance(w, &left, 1))
            continue;
        fall = choose(other, choose(left.fell, left.fall, from), fall);
    }
    since = choose(TRUTH(first < ORIGIN - none()), first, ORIGIN - none());
    until = choose(TRUTH(to > ORIGIN), to, ORIGIN + 1 - none());

    site = from;
    for (int j = extreme(active, from, -1); j <= extreme(active, fall, 1); j++) {
        const uint64_t here = (uint64_t)j;
        const point *const q = site_of(w, j);
        const mask better = TRUTH(from <= here) & TRUTH(here <= fall) & TRUTH(q->least < value);
        value = pick(better, q->least, value);
        site = choose(better, here - none(), site);
        for (int k = 0; k < 3; k++)
            form[k] = pick(better, q->left[k] + q->right[k] - q->beta[k], form[k]);
    }
    least_eigenvector(form, top);
    w->from = choose(active, first, w->from);
    w->to = choose(active, to, w->to);
    w->since = choose(active, since, w->since);
    w->until = choose(active, until, w->until);
    const int start = extreme(active, w->since, -1), end = extreme(active, w->until, 1);
    for (int j = extreme(active, site, 1); j >= start; j--) {
        const uint64_t here = (uint64_t)j;
        point *const q = site_of(w, j);
        const mask in = TRUTH(here <= site) & TRUTH(here >= w->from);
        vec next[2];
        sym2_solve(next, q->left, n);
        for (int i = 0; i < 2; i++) {
            n[i] = pick(in, pick(TRUTH(here == site), top[i], next[i]), every(0.0));
            q->n[i] = pick(active, n[i], q->n[i]);
        }
    }
    for (int i = 0; i < 2; i++)
        n[i] = every(0.0);
    for (int j = extreme(active, site, -1); j <= end; j++) {
        const uint64_t here = (uint64_t)j;
        point *const q = site_of(w, j);
        const mask in = active & TRUTH(here > site);
        vec next[2];
        sym2_solve(next, q->right, n);
        for (int i = 0; i < 2; i++) {
            n[i] = pick(TRUTH(here == site), top[i],
                        pick(in & TRUTH(here <= w->to), next[i], every(0.0)));
            q->n[i] = pick(in, n[i], q->n[i]);
        }
    }
    return active;
}
