/* unit.c - one instance's memory. */

#ifdef NUM_DOUBLE
enum { DOUBLE_DP = 15 };                /* what a double is good for (thesis: DBL_ERR) */
#endif

/* The numbers of a state as one array: it has no members but num_t's. */
static num_t *first_number(state *s) { return (num_t *)(void *)&s->n; }
enum { N_NUMBERS = sizeof(numbers) / sizeof(num_t) };

void R(unit_free)(state *s)
{
    if (s == NULL)
        return;
    for (int j = 0; j < (int)N_NUMBERS; j++)
        num_clear(first_number(s)[j]);
    trig_clear(&s->trig);
    free(s);
}

state *R(unit_new)(long dp, int as_printed)
{
    state *s = calloc(1, sizeof *s);
    numbers *n;
    apm_t pi, angle, one;

    if (s == NULL)
        return NULL;
    n = &s->n;
#ifdef NUM_DOUBLE
    dp = DOUBLE_DP;
#endif
    s->dp = dp;
    s->as_printed = as_printed;
    trig_init(&s->trig, as_printed ? dp + SAFETY_DP : dp);
    for (int j = 0; j < (int)N_NUMBERS; j++)
        num_init(first_number(s)[j]);
    num_set_si(n->max_error, 1, -dp);
    set_precision(s, as_printed ? dp + SAFETY_DP : dp);

    apm_init(pi);
    apm_init(angle);
    apm_init(one);
    apm_pi(pi, s->precision);
    num_set_apm(n->pi_lb, pi);
    apm_set_si(one, 1, -s->precision);
    apm_add(angle, pi, one);
    num_set_apm(n->pi_ub, angle);
    apm_set_si(one, THETA_ROT, -2);
    apm_mul(angle, pi, one);
    num_set_apm(n->t[0], angle);
    num_sincos(s, n->theta_sin, n->theta_cos, n->t[0]);
    num_mul(n->small_sinsq, n->theta_sin, n->theta_sin);
    apm_set_si(one, MAX_SUM, -2);
    num_set_apm(n->max_sum, one);
    apm_clear(pi);
    apm_clear(angle);
    apm_clear(one);
    return s;
}
