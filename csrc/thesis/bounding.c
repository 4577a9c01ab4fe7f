/* bounding.c - arithmetic with bounded numbers.  Sums and products are exact here, so every
   bound is the best that the bounds of its parts allow. */

/* r encloses x y for x and y anywhere in their bounds.  Thesis: Rbound_term. */
static void bound_product(state *s, bdd *r, const bdd *x, const bdd *y)
{
    num_t *t = s->n.bd;

    num_mul(t[0], x->lb, y->lb);
    num_mul(t[1], x->lb, y->ub);
    num_mul(t[2], x->ub, y->lb);
    num_mul(t[3], x->ub, y->ub);
    num_set(r->lb, t[0]);
    num_set(r->ub, t[0]);
    for (int j = 1; j < 4; j++) {
        num_min(r->lb, t[j]);
        num_max(r->ub, t[j]);
    }
}

/* r += coef x */
static void bound_add_term(state *s, bdd *r, const num_t coef, const bdd *x)
{
    const int negative = num_sgn(coef) < 0;

    num_addmul(s, r->lb, coef, negative ? x->ub : x->lb);
    num_addmul(s, r->ub, coef, negative ? x->lb : x->ub);
}

/* r += n x, n a small integer */
static void bound_add_multiple(state *s, bdd *r, long n, const bdd *x)
{
    num_mul_si(s->n.mul, n < 0 ? x->ub : x->lb, n);
    num_add(r->lb, r->lb, s->n.mul);
    num_mul_si(s->n.mul, n < 0 ? x->lb : x->ub, n);
    num_add(r->ub, r->ub, s->n.mul);
}

static void bound_set(bdd *r, const num_t x)
{
    num_set(r->lb, x);
    num_set(r->ub, x);
}

/* r += max |x|.  Thesis: RmaxAbs. */
static void add_max_abs(state *s, num_t r, const bdd *x)
{
    num_t *t = s->n.bd;

    num_abs(t[4], x->lb);
    num_abs(t[5], x->ub);
    num_add(r, r, num_cmp(t[4], t[5]) > 0 ? t[4] : t[5]);
}

/* r encloses x^2.  Thesis: RsetSq. */
static void bound_square(bdd *r, const bdd *x)
{
    num_mul(r->lb, x->lb, x->lb);
    num_mul(r->ub, x->ub, x->ub);
    if (num_cmp(r->lb, r->ub) > 0)
        num_swap(r->lb, r->ub);
    if (num_sgn(x->lb) <= 0 && num_sgn(x->ub) >= 0)
        num_set_si(r->lb, 0, 0);
}

/* r widened by e on both sides */
static void bound_widen(bdd *r, const num_t e)
{
    num_sub(r->lb, r->lb, e);
    num_add(r->ub, r->ub, e);
}
