/* bd_trig.c - sine and cosine over an interval. */

/* t = x / (2 pi), rounded down (or up) */
static void turns(state *s, num_t t, const num_t x, apm_round_t dir)
{
    const int wider = (num_sgn(x) >= 0) == (dir == APM_DOWN);   /* the larger pi divides */

    num_mul_si(s->n.bd[6], wider ? s->n.pi_ub : s->n.pi_lb, 2);
    num_div(s, t, x, s->n.bd[6], dir);
}

/* From the values of a wave at both ends of an interval, and the ends in turns counted from a
   maximum of the wave: bounds over the interval.  The wave is 1 at the integers and -1 halfway
   between.  The values are good to ulp.

   Promise: every value of the wave on the interval lies in r, if lo is not above the true lower
   end and hi not below the true upper end.  Between neighbouring extrema the wave is monotone,
   so the ends bound it; whether an extremum may lie within is decided by comparing floors. */
static void bd_wave(state *s, bdd *r, const num_t left, const num_t right, num_t lo, num_t hi)
{
    num_t *t = s->n.bd;

    num_set(r->lb, left);
    num_set(r->ub, left);
    num_min(r->lb, right);
    num_max(r->ub, right);
    bound_widen(r, s->as_printed ? s->n.max_error : s->n.ulp);

    /* Erratum: the listing cuts off the fraction where a floor is meant, and so misses the
       maximum in an interval that reaches from below zero to above it. */
    (s->as_printed ? num_truncate : num_floor)(t[0], lo);
    num_sub(lo, lo, t[0]);
    num_sub(hi, hi, t[0]);                              /* now 0 <= lo < 1 */
    num_set_si(t[1], 1, 0);                             /* the next maximum ... */
    num_set_si(t[2], 5, -1);                            /* ... the minimum before it ... */
    num_set_si(t[3], 15, -1);                           /* ... and after it */
    if (s->as_printed) {
        num_sub(t[4], hi, lo);
        if (num_cmp(t[4], t[1]) > 0) {
            num_set_si(r->lb, -1, 0);
            num_set_si(r->ub, 1, 0);
            return;
        }
    }
    if (num_cmp(hi, t[1]) >= 0 || num_sgn(lo) == 0)
        num_set_si(r->ub, 1, 0);
    if (num_cmp(hi, t[3]) >= 0 || (num_cmp(lo, t[2]) <= 0 && num_cmp(hi, t[2]) >= 0))
        num_set_si(r->lb, -1, 0);
}

/* sine and cosine enclose sin and cos on [theta.lb, theta.ub].  Thesis: Rbd_sin, Rbd_cos. */
static void bd_sincos(state *s, bdd *sine, bdd *cosine, const bdd *theta)
{
    num_t *t = s->n.ex;

    num_sincos(s, t[0], t[1], theta->lb);
    num_sincos(s, t[2], t[3], theta->ub);
    turns(s, t[4], theta->lb, APM_DOWN);
    turns(s, t[5], theta->ub, APM_UP);
    num_set_si(t[6], 25, -2);                           /* sin x = cos(x - a quarter turn) */
    num_sub(s->n.t[0], t[4], t[6]);
    num_sub(s->n.t[1], t[5], t[6]);
    bd_wave(s, cosine, t[1], t[3], t[4], t[5]);
    bd_wave(s, sine, t[0], t[2], s->n.t[0], s->n.t[1]);
}
