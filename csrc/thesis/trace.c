/* trace.c - the trace of beta. */

/* r encloses Tr beta = 4 - a sin v0 - b sin v1 - 2c sin(v0 + v1) over the prism of the last
   global_bounds.  Thesis: Rbound_btrace.  (Appendix B prints its formula without the minus
   signs; the listing has them.) */
static void bound_btrace(state *s, bdd *r)
{
    numbers *n = &s->n;

    num_set_si(n->t[0], 4, 0);
    bound_set(r, n->t[0]);
    bound_add_multiple(s, r, -1, &n->a_sin);
    bound_add_multiple(s, r, -1, &n->b_sin);
    bound_add_multiple(s, r, -2, &n->c_sin);
    if (s->as_printed)
        bound_widen(r, n->max_error);
}
