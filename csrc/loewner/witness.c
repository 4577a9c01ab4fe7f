/* witness.c - the vector n on which the second variation is most plainly negative.

   Some n makes (1) negative for one orbit if and only if the recursion d[s] = beta - l, d[j+1] =
   beta - 1/d[j] of the Loewner bounds leads to a d[j] that is not above l; past and future are used
   alike.  n is chosen for the orbit of the prism's centre and then kept.  Nothing rigorous rests on
   it. */
#include "prism.h"

double least_eigenvector(const double d[3], double n[2])
{
    const double half = 0.5 * (d[0] - d[2]);
    const double value = 0.5 * (d[0] + d[2]) - sqrt(half * half + d[1] * d[1]);
    const double a = d[0] > d[2] ? d[1] : value - d[2], b = d[0] > d[2] ? value - d[0] : d[1];
    const double length = sqrt(a * a + b * b);

    n[0] = length > 0.0 ? a / length : 1.0;
    n[1] = length > 0.0 ? b / length : 0.0;
    return value;
}

static int above(const double d[3], double l)
{
    return d[0] > l && (d[0] - l) * (d[2] - l) > d[1] * d[1];
}

/* d' = beta - 1/d */
static void block(double next[3], const double beta[3], const double d[3])
{
    const double det = d[0] * d[2] - d[1] * d[1];

    next[0] = beta[0] - d[2] / det;
    next[1] = beta[1] + d[1] / det;
    next[2] = beta[2] - d[0] / det;
}

/* n = n / d */
static void divide(double n[2], const double m[2], const double d[3])
{
    const double det = d[0] * d[2] - d[1] * d[1];

    n[0] = (d[2] * m[0] - d[1] * m[1]) / det;
    n[1] = (d[0] * m[1] - d[1] * m[0]) / det;
}

/* The last blocks before the recursion falls below l: from the left, up to index `to`.  Returns
   where it falls, or to + 1.  from_right: the same from `to` downwards. */
static int fall_left(loewner *w, int from, int to)
{
    const double start[3] = { 1.0 / w->l, 0.0, 1.0 / w->l }, *d = start;
    point *q = w->orbit;

    for (int j = from; j <= to; j++) {
        block(q[j].left, q[j].beta, d);
        d = q[j].left;
        if (!above(d, w->l))
            return j;
    }
    return to + 1;
}

static int fall_right(loewner *w, int from, int to)
{
    const double start[3] = { 1.0 / w->l, 0.0, 1.0 / w->l }, *d = start;
    point *q = w->orbit;

    for (int j = to; j >= from; j--) {
        block(q[j].right, q[j].beta, d);
        d = q[j].right;
        if (!above(d, w->l))
            return j;
    }
    return from - 1;
}

/* Between the places where the recursions from both ends fall all blocks are above l.  There n is,
   at the site of the least beta, the eigenvector of the quadratic form that is left there when all
   others are eliminated; outwards n = n / d.  The sites that are summed over, from..until, hold 0
   and 1, with n = 0 where need be. */
int witness(loewner *w)
{
    point *q = w->orbit;
    double value = HUGE_VAL, form[3], ignored[2];
    int site, from, to = w->last;
    const int fall = fall_left(w, w->first, w->last);

    if (fall > w->last)
        return 0;
    from = fall_right(w, w->first, to);
    if (from < w->first || from > fall) {               /* two places apart: the left one alone */
        to = fall;
        from = fall_right(w, w->first, to);
        if (from < w->first)
            from = fall;                                /* by a rounding only */
    }
    site = from;
    for (int j = from; j <= fall; j++) {
        const double v = least_eigenvector(q[j].beta, ignored);
        if (v < value) {
            value = v;
            site = j;
        }
    }
    for (int k = 0; k < 3; k++)
        form[k] = q[site].left[k] + q[site].right[k] - q[site].beta[k];
    least_eigenvector(form, q[site].n);
    w->from = w->first;
    w->to = to;
    w->until = to > ORIGIN ? to : ORIGIN + 1;
    for (int j = to + 1; j <= w->until; j++)
        q[j].n[0] = q[j].n[1] = 0.0;
    for (int j = site - 1; j >= w->from; j--)
        divide(q[j].n, q[j + 1].n, q[j].left);
    for (int j = site + 1; j <= w->to; j++)
        divide(q[j].n, q[j - 1].n, q[j].right);
    return 1;
}
