"""Flips one place of the C core at a time, rebuilds, and sees whether a kernel test notices.

    python tests/mutate.py [NUMBER ...]

A rounding direction, an error term, an upper for a lower bound, a sign, an index.  Prints a
table of caught and survived; exit status 1 if one survived that matters (see HARMLESS).
"""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TESTS = ["test_apm.py", "test_special.py", "test_bounding.py", "test_bd_trig.py", "test_bounds.py", "test_images.py",
         "test_search.py", "test_loewner.py", "test_waves.py"]
ORBITS = ["test_orbits.py", "test_orbits_fail.py", "test_floor.py", "test_proved.py"]   # for that room
# The test to begin with, by file or room; without one it is test_images.py.
FIRST = {"arith/apm.c": "test_apm.py", "arith/special.c": "test_special.py",
         "arith/sine.h": "test_loewner.py", "arith/lanes.h": "test_loewner.py",
         "thesis/bounding.c": "test_bounding.py",
         "thesis/bd_trig.c": "test_bd_trig.py", "thesis/trace.c": "test_bounds.py",
         "thesis/lambda.c": "test_bounds.py", "model/torus.c": "test_bounds.py",
         "thesis/lipschitz.c": "test_bounds.py", "thesis/region.c": "test_search.py",
         "thesis/follow.c": "test_search.py", "search/tree.c": "test_search.py", "search/setup.c": "test_search.py",
         "loewner/general.h": "test_waves.py", "loewner": "test_loewner.py", "orbits": "test_orbits.py",
         "orbits/minplus.c": "test_floor.py"}
FLAGS = ["-std=c11", "-O1", "-fPIC", "-ffp-contract=off", "-I", "csrc",
         "-I", sysconfig.get_paths()["include"]]

# file, what stands there (once), what to put in its place
MUTATIONS = [
    ("arith/apm.c", "mpz_fdiv_q(r, x, y)", "mpz_cdiv_q(r, x, y)"),
    ("arith/apm.c", "(mpz_sgn(y) < 0) ? APM_DOWN", "(mpz_sgn(y) > 0) ? APM_DOWN"),
    ("arith/apm.c", "mpz_cdiv_q_ui(r, x, y)", "mpz_tdiv_q_ui(r, x, y)"),
    ("arith/apm.c", "mpz_add_ui(r->mant, r->mant, 1UL);\n    r->exp = -dp;", "r->exp = -dp;"),
    ("arith/apm.c", "if (dir == APM_UP && (!exact || mpz_sgn(rest) != 0))",
     "if (dir == APM_UP && mpz_sgn(rest) != 0)"),
    ("arith/apm.c", "apm_round(r, x, 0, APM_DOWN)", "apm_round(r, x, 0, APM_TRUNC)"),
    ("arith/apm.c", "shift_up(t, x->mant, x->exp - exp);", "shift_up(t, x->mant, x->exp - exp - 1);"),
    ("arith/apm.c", "const mpz_srcptr first = shift_x ? t : x->mant, second = shift_x ? y->mant : t;",
     "const mpz_srcptr first = shift_x ? t : y->mant, second = shift_x ? y->mant : t;"),
    ("arith/apm.c", "    if (!isfinite(x))\n        return APM_ERANGE;\n", ""),
    ("arith/special.c", "* 3322 / 1000 + 28;", "* 3322 / 1000 - 8;"),
    ("arith/special.c", "const mp_bitcnt_t big = order > 0 ?", "const mp_bitcnt_t big = order > 1000 ?"),
    ("arith/special.c", "negative != (quadrant == 2)", "negative"),
    ("arith/special.c", "2 * k * (2 * k - 1)", "2 * k * (2 * k + 1)"),
    ("arith/special.c", "bits < w;", "2 * bits < w;"),
    ("arith/special.c", "trig->turn_exp == exp && ", ""),
    ("arith/special.c", "trig->turn_bits >= bits && ", ""),
    ("arith/special.c", "exp < 0 ? scale : trig->half_pi", "scale"),
    ("arith/special.c", "w + mpz_sizeinbase(x->mant, 2) + 2", "w + 2"),
    ("arith/special.c", "z[1], z[1], trig->w - j", "z[1], z[1], trig->w"),
    ("arith/special.c", "c > ULONG_MAX / d", "c > ULONG_MAX / 2"),
    ("arith/special.c", "k % trig->row == 0 && k != trig->terms", "k % trig->row == 1"),
    ("arith/special.c", "trig->term, trig->term, b + 1", "trig->term, trig->term, b"),
    ("arith/special.c", "w + j + 2 * r;", "w + 2 * r;"),
    ("arith/special.c", "mpz_sub_ui(lower, lower, 1UL);", ""),
    ("thesis/bounding.c", "for (int j = 1; j < 4; j++) {", "for (int j = 1; j < 3; j++) {"),
    ("thesis/bounding.c", "negative ? x->ub : x->lb", "negative ? x->lb : x->ub"),
    ("thesis/bounding.c", "n < 0 ? x->lb : x->ub, n", "n < 0 ? x->ub : x->ub, n"),
    ("thesis/bounding.c", "        num_set_si(r->lb, 0, 0);\n", "        ;\n"),
    ("thesis/bounding.c", "num_cmp(t[4], t[5]) > 0", "num_cmp(t[4], t[5]) < 0"),
    ("thesis/bd_trig.c", "(s->as_printed ? num_truncate : num_floor)", "num_truncate"),
    ("thesis/bd_trig.c", "num_cmp(hi, t[1]) >= 0 || num_sgn(lo) == 0", "num_sgn(lo) == 0"),
    ("thesis/bd_trig.c", "num_cmp(hi, t[3]) >= 0 ||", ""),
    ("thesis/bd_trig.c", "bound_widen(r, s->as_printed", "if (s->as_printed) bound_widen(r, s->as_printed"),
    ("thesis/bd_trig.c", "(num_sgn(x) >= 0) == (dir == APM_DOWN)", "(num_sgn(x) >= 0) != (dir == APM_DOWN)"),
    ("thesis/bd_trig.c", "turns(s, t[5], theta->ub, APM_UP);", "turns(s, t[5], theta->ub, APM_DOWN);"),
    ("thesis/bd_trig.c", "num_set_si(t[6], 25, -2);", "num_set_si(t[6], -25, -2);"),
    ("thesis/map.c", "num_addmul(s, n->t[0], x->p[2], n->cos_c[2]);",
     "num_submul(s, n->t[0], x->p[2], n->cos_c[2]);"),
    ("thesis/map.c", "num_mul(n->centre_err, n->centre_err, n->ulp);",
     "num_set_si(n->centre_err, 0, 0);"),
    ("thesis/map.c", "num_set_si(n->centre_err, 1, 0);", "num_set_si(n->centre_err, 0, 0);"),
    ("thesis/map.c", "num_neg(d->beta[0][1], n->t[0]);", "num_set(d->beta[0][1], n->t[0]);"),
    ("thesis/row_sums.c", "num_add(parm[j]->ub, pz->centre.p[j], pz->matrix[j][j]);",
     "num_set(parm[j]->ub, pz->centre.p[j]);"),
    ("thesis/row_sums.c", "row_sum(s, n->t[2], pz->matrix[V + j], 0, MAT_DIM);",
     "row_sum(s, n->t[2], pz->matrix[V + j], U, MAT_DIM);"),
    ("thesis/row_sums.c", "num_add(n->bx[2].ub, n->bx[2].ub, theta->ub);",
     "num_add(n->bx[2].ub, n->bx[2].ub, theta->lb);"),
    ("thesis/row_sums.c", "num_mul_si(n->t[0], d->beta[0][1], 2);", "num_set(n->t[0], d->beta[0][1]);"),
    ("thesis/row_sums.c", "        if (j == 2) ", "        if (j == 7) "),
    ("thesis/row_sums.c", "&d->gamma[j == 1][j]", "&d->gamma[0][j]"),
    ("thesis/trace.c", "bound_add_multiple(s, r, -2, &n->c_sin);", "bound_add_multiple(s, r, -1, &n->c_sin);"),
    ("thesis/lambda.c", "bound_add_multiple(s, disc, 4, square);", "bound_add_multiple(s, disc, 2, square);"),
    ("thesis/lambda.c", "bound_add_multiple(s, disc, -2, square);", "bound_add_multiple(s, disc, 2, square);"),
    ("thesis/lambda.c", "num_sqrt(s, t[0], disc->lb, APM_DOWN);", "num_sqrt(s, t[0], disc->lb, APM_UP);"),
    ("thesis/lambda.c", "num_sqrt(s, t[1], disc->ub, APM_UP);", "num_sqrt(s, t[1], disc->ub, APM_DOWN);"),
    ("thesis/lambda.c", "num_sub(t[2], trace->ub, t[0]);", "num_sub(t[2], trace->ub, t[1]);"),
    ("thesis/lambda.c", "num_sqrt(s, t[2], t[0], APM_UP);", "num_sqrt(s, t[2], t[0], APM_DOWN);"),
    ("thesis/lambda.c", "num_div(s, low, t[3], t[2], APM_DOWN);", "num_div(s, low, t[3], t[2], APM_UP);"),
    ("thesis/lambda.c", "num_div(s, t[1], t[0], least_lam, APM_DOWN);",
     "num_div(s, t[1], t[0], least_lam, APM_UP);"),
    ("thesis/lambda.c", "num_div(s, t[2], t[0], t[1], APM_DOWN);", "num_div(s, t[2], t[0], t[1], APM_UP);"),
    ("thesis/lambda.c", "num_sub(t[1], slope, n->constants[C_LAM_MIN]);",
     "num_sub(t[1], slope, least_lam);"),
    ("thesis/lambda.c", "num_div(s, t[1], t[0], slope, APM_DOWN);", "num_div(s, t[1], t[0], slope, APM_UP);"),
    ("thesis/lambda.c", "num_set_si(t[0], DEG_FREE * DEG_FREE, 0);", "num_set_si(t[0], 5, 0);"),
    ("thesis/lambda.c", "num_round(s, slope, t[1], APM_UP);", "num_round(s, slope, t[1], APM_DOWN);"),
    ("thesis/lambda.c", "num_round(s, least_lam, t[0], APM_UP);", "num_round(s, least_lam, t[0], APM_DOWN);"),
    ("model/torus.c", "0.5 * t * t * p->size[i]", "0.25 * t * t * p->size[i]"),
    ("model/torus.c", "x < 0.0 ? p->low[i] : p->high[i]", "x < 0.0 ? p->high[i] : p->high[i]"),
    ("model/torus.c", "    most = larger(displaced(p, s, c, -r[0], r[1]), most);\n", ""),
    ("model/torus.c", "            most = larger(most, bound);\n", "            most = larger(most, middle);\n"),
    ("model/torus.c", "b = 2.0 * z,", "b = z,"),
    ("model/torus.c", "larger(fabs(low[i]), fabs(high[i]));", "fabs(high[i]);"),
    ("model/torus.c", ": 2.0 + larger(p.size[0], p.size[1])),", ": 2.0 + p.size[0]),"),
    ("model/torus.c", "? 4.0 + p.size[0]", "? 2.0 + p.size[0]"),
    ("model/torus.c", "return most + p->margin;", "return most - p->margin;"),
    ("model/torus.c", "        if (isnan(bound))\n            return bound;\n", ""),
    ("model/torus.c", "other->v[j] += k->r[j];", "other->v[j] += 0.5 * k->r[j];"),
    ("thesis/lipschitz.c", "set_earliest(s, root, 1);\n    if", "set_earliest(s, root, 0);\n    if"),
    ("thesis/region.c", "    apm_mul(off, off, ulp); ", "    apm_set_si(off, 0, 0); "),
    ("thesis/region.c", "apm_add(exact, pi, ulp);", "apm_set(exact, pi);"),
    ("thesis/region.c", "        apm_add(off, off, ulp);\n", "        ;\n"),
    ("thesis/region.c", "apm_round(half, half, dp, APM_UP);", "apm_round(half, half, dp, APM_TRUNC);"),
    ("thesis/ff_rows.c", "block_sum(s, t[0], pz->matrix, V, V, MAT_DIM);",
     "num_add(t[0], pz->matrix[V][V], pz->matrix[V + 1][V + 1]);"),
    ("thesis/ff_rows.c", "num_div(s, n->w[U + j], t[4], t[5], APM_UP);",
     "num_div(s, n->w[U + j], t[4], t[5], APM_DOWN);"),
    ("thesis/ff_rows.c", "num_mul_si(t[2], n->centre_err, 2);", "num_set_si(t[2], 0, 0);"),
    ("thesis/ff_rows.c", "num_mul_si(t[2], n->ulp, 10);", "num_set_si(t[2], 0, 0);"),
    ("thesis/ff_rows.c", "num_add(t[1], t[1], n->gamma_dif);", ""),
    ("thesis/ff_rows.c", "num_submul(s, t[3], A[V][U + 1], A[V + 1][U]);",
     "num_addmul(s, t[3], A[V][U + 1], A[V + 1][U]);"),
    ("thesis/ff_rows.c", "num_addabs(s, t[4], A[V + j][U + 1 - j]);",
     "num_addabs(s, t[4], A[V + 1 - j][U + j]);"),
    ("thesis/cr_rows.c", "num_submul(s, t[0], B2[i], pz->matrix[U + i][k]);",
     "num_addmul(s, t[0], B2[i], pz->matrix[U + i][k]);"),
    ("thesis/cr_rows.c", "num_add(t[2], *S1[0], *S1[1]);", "num_set(t[2], *S1[0]);"),
    ("thesis/cr_rows.c", "num_add(t[3], t[3], t[4]);\n    num_mul_si(t[4], n->centre_err, 2);",
     "num_mul_si(t[4], n->centre_err, 2);"),
    ("thesis/cr_rows.c", "    num_add(t[3], t[3], n->beta_star);\n", ""),
    ("thesis/cr_rows.c", "    num_add(t[3], t[3], t[2]);\n", ""),
    ("thesis/cr_rows.c", "num_add(t[6], t[1], n->centre_err);", "num_set(t[6], t[1]);"),
    ("thesis/cr_rows.c", "num_add(t[1], t[1], n->gamma_dif);", ""),
    ("thesis/cr_rows.c", "num_mul_si(t[6], n->ulp, 3);", "num_set_si(t[6], 0, 0);"),
    ("thesis/cr_rows.c", "num_add(n->w[U + half + j], n->w[U + half + j], t[3]);", ""),
    ("thesis/cr_rows.c", "row_sum(s, t[4], n->inverse[half + j], DEG_FREE, TWO_DF);",
     "row_sum(s, t[4], n->inverse[j], DEG_FREE, TWO_DF);"),
    ("thesis/cr_rows.c", "        bound_rows(s, n->w + U + half, half, pz, V);\n", ""),
    ("thesis/gauss.c", "num_max(g[4], g[6]);                        /* row_max */", ""),
    ("thesis/gauss.c", "        num_mul(g[1], g[1], g[0]);\n", ""),
    ("thesis/gauss.c", "num_mul(g[1], g[1], g[0]);", "num_mul(g[1], g[0], g[0]);"),
    ("thesis/gauss.c", "num_addmul(s, g[8], g[4], g[6]);", ""),
    ("thesis/gauss.c", "num_add(err, g[8], g[7]);", "num_set(err, g[8]);"),
    ("thesis/gauss.c", "fails = fails || num_cmp(n->inverse_err, n->ulp) > 0;", ""),
    ("thesis/gauss.c", "num_add(n->inverse_err, n->inverse_err, n->ulp);", ""),
    ("thesis/prismatic.c", "(j != k || (j >= U && j < V))", "j != k"),
    ("thesis/state.h", "W_DIGITS - apm_order(x), APM_UP", "W_DIGITS - apm_order(x), APM_DOWN"),
    ("thesis/follow.c", "num_cmp(n->least_lam, n->constants[C_LAM_MIN]) < 0;",
     "num_cmp(n->least_lam, n->constants[C_LAM_MAX]) < 0;"),
    ("thesis/follow.c", "        v->no_tori = 0;\n", ""),
    ("search/tree.c", "c->index[V1] << (k - l) > c->index[V0]", "c->index[V1] << (k - l) >= c->index[V0]"),
    ("search/tree.c", "c->index[V1] >= (c->index[V0] + 1) << (l - k)",
     "c->index[V1] >= c->index[V0] << (l - k)"),
    ("search/setup.c", "apm_cmp(p->half[0], p->half[1]) == 0;", "1;"),
    ("search/setup.c", "if (status == CV_OK && apm_cmp(s->problem.xstar[0], s->problem.xstar[1]) != 0)", "if (0)"),
    ("search/tree.c", "    upper->index[axis]++;\n", ""),
    ("search/tree.c", "2 * (long)c->index[axis] + 1 - (1L", "2 * (long)c->index[axis] - (1L"),
    ("search/tree.c", "        leaf(s, 'U');", "        leaf(s, 'P');"),
    ("arith/sine.h", " - n * 0x1.3198a2e037073p-69", ""),
    ("arith/sine.h", "z * (-1.0 / 1307674368000.0", "z * (1.0 / 1307674368000.0"),
    ("arith/sine.h", "(bits & 2) << 62", "(bits & 1) << 63"),
    ("loewner/three.h", "felt(w, wave, q->rest[0], q->rest[1])",
     "felt(w, wave, q->rest[0], every(0.0))"),
    ("loewner/orbit.c", "sum += mag(felt(w, i, q->column[0][k], q->column[1][k]));",
     "sum += felt(w, i, q->column[0][k], q->column[1][k]);"),
    ("loewner/orbit.c", "sum += mag(felt(w, i, q->bow[0][kl], q->bow[1][kl]));",
     "sum += felt(w, i, q->bow[0][kl], q->bow[1][kl]);"),
    ("loewner/orbit.c", "(q->straight[i] + q->off[i]) * WIDEN", "q->straight[i] * WIDEN"),
    ("loewner/orbit.c", "(b * (a + 0.5 * b)", "(b * (0.5 * a + 0.5 * b)"),
    ("loewner/orbit.c", " + 0.25 * rho * cube)", ")"),
    ("loewner/orbit.c", " + s * cube)\n", ")\n"),
    ("loewner/orbit.c", "(c * half_square + s * (b + cube))", "(s * (b + cube))"),
    ("loewner/orbit.c", "s * (b + cube)", "s * cube"),
    ("loewner/orbit.c", "s * (b + cube)", "s * b"),
    ("loewner/orbit.c", " + w->loose[wave]\n", "\n"),
    ("loewner/orbit.c", "           + w->size[wave] * off * rho * (1.0 + rho);",
     "           + 0.0;"),
    ("loewner/three.h", "f[k] = -half * c[k];", "f[k] = half * c[k];"),
    ("loewner/three.h", "        add_moves(w, i, -q->sine[i], f, columns);\n", ""),
    ("loewner/three.h", "c[k] * f[l] + c[l] * f[k]", "c[k] * f[l]"),
    ("loewner/three.h", " - o->bow[i][kl]\n", "\n"),
    ("loewner/orbit.c", "vec e = gathered_sizes(w, i, bent);", "vec e = bent[i];"),
    ("loewner/orbit.c", "i0 * o->force[0] + i1 * o->force[1];", "i0 * o->force[0];"),
    ("loewner/orbit.c", " + mag(q->d[i + 1]) * q->rest[1]\n", "\n"),
    ("loewner/three.h", "        add_moves(w, 2, q->cosine[2], next->column[i], columns);\n", ""),
    ("loewner/bound.c", "q[j].mu[1] - q[j + 1].mu[i],", "q[j].mu[1] + q[j + 1].mu[i],"),
    ("loewner/bound.c", "q[j].mu[1] - q[j - 1].mu[i],", "q[j].mu[1] + q[j - 1].mu[i],"),
    ("loewner/bound.c", "either = p * (a * r) + h", "either = h"),
    ("loewner/bound.c", "either + p * fourth;", "either;"),
    ("loewner/bound.c", "either + p * (0.5 * b * b);", "either;"),
    ("loewner/bound.c", "w->p[i] * A > 0.0", "w->p[i] * A < 0.0"),
    ("loewner/bound.c", "p * (b * (0.5 * a * (a + b)", "p * (b * (0.5 * a * b"),
    ("loewner/bound.c", " + b * b * (1.0 / 6.0)) + 0.2", ") + 0.2"),
    ("loewner/bound.c", " + 0.2 * rho * fourth", ""),
    ("loewner/bound.c", "h * (b * (a + 0.5 * b) + fourth)", "h * fourth"),
    ("loewner/bound.c", "(b * (a + 0.5 * b) + fourth)", "(b * (a + 0.5 * b))"),
    ("loewner/bound.c", "h * (r + rho * half_square", "h * (rho * half_square"),
    ("loewner/bound.c", "h * (r + rho * half_square * (1.0 / 3.0))", "h * r"),
    ("loewner/bound.c", "centre -= omega[i] * p * s;", "centre -= omega[i] * p * s + 1e-9;"),
    ("loewner/bound.c", "                    t.rest += mag(steep) * q->reach[i];\n",
     "                    ;\n"),
    ("loewner/bound.c", "t.slope[k] += steep * q->column[i][k];", "t.slope[k] += every(0.0);"),
    ("loewner/bound.c", "add_moves(w, i, t.along[i], t.slope, columns);",
     "add_moves(w, i, 0.5 * t.along[i], t.slope, columns);"),
    ("loewner/bound.c", "along[i] += A;", "along[i] -= A;"),
    ("loewner/bound.c", "f[k] = -0.5 * p * A * c[k];", "f[k] = 0.5 * p * A * c[k];"),
    ("loewner/bound.c", "add_moves(w, i, B, f, columns);", "add_moves(w, i, -B, f, columns);"),
    ("loewner/bound.c", "c[k] * f[l] + c[l] * f[k]", "c[k] * f[l]"),
    ("loewner/bound.c", "t.centre -= w->l * tails;", "t.centre -= 2.0 * w->l * tails;"),
    ("loewner/bound.c", "p * (a * bow) + h * (0.5", "h * (0.5"),
    ("loewner/bound.c", "p * (a * a * a * (1.0 / 6.0)) + h", "h"),
    ("loewner/bound.c", " + h * (0.5 * a * a);", ";"),
    ("loewner/bound.c", " + h * bow;", ";"),
    ("loewner/bound.c", "-pA * bow - third * cc", "pA * bow - third * cc"),
    ("loewner/bound.c", "-pA * bow - third * cc", "-pA * bow + third * cc"),
    ("loewner/bound.c", "l == k ? 0.5 : 1.0;     /*", "1.0;     /*"),
    ("loewner/bound.c", "w->part[i][m] * (B * bow - A * cc)",
     "w->part[i][m] * (B * bow + A * cc)"),
    ("loewner/bound.c", "w->part[i][m] * (B * bow - A * cc)",
     "w->part[i][m] * (-B * bow - A * cc)"),
    ("loewner/general.h", "k[0] * x0 + k[1] * x1", "k[0] * x0 + fabs(k[1]) * x1"),
    ("loewner/general.h", "        sum += w->root->k[j][i] * of[j];", "        sum += of[j];"),
    ("loewner/general.h", "        sum += fabs(w->root->k[j][i]) * of[j];",
     "        sum += w->root->k[j][i] * of[j];"),
    ("loewner/general.h", "fabs(k[1]) * q->rest[1]", "k[1] * q->rest[1]"),
    ("loewner/general.h", " + q->slip[wave];", ";"),
    ("loewner/general.h", "+ phase);", "- phase);"),
    ("loewner/general.h", "pull[1] += k0 * k1 * s;", "pull[1] += fabs(k0 * k1) * s;"),
    ("loewner/general.h", "3.0 * (mag(y0) + mag(y1)) + 10.0 * fabs(phase)", "every(0.0)"),
    ("loewner/general.h", "q->fuzz = 0x1p-49 * sizes", "q->fuzz = 0x1p-54 * sizes"),
    ("loewner/general.h", "pull = -w->p[j] * q->sine[j]", "pull = w->p[j] * q->sine[j]"),
    ("loewner/general.h", "f[k] = -half * c[k];", "f[k] = half * c[k];"),
    ("loewner/general.h", "        add_moves(w, j, -q->sine[j], f, columns);\n", ""),
    ("loewner/general.h", "        add_moves(w, j, q->cosine[j], push, columns);\n", ""),
    ("loewner/general.h", "cf + pull * felt(w, j, q->bow[0][kl], q->bow[1][kl])", "cf"),
    ("loewner/general.h", "bowed[i][kl] += wave[i] * bow;", "bowed[i][kl] += bow;"),
    ("loewner/general.h", "const vec unit = 0x1p-49 * (1.0 + q->far);", "const vec unit = every(0.0);"),
    ("loewner/general.h", "sum += w->root->k[j][i] * (square", "sum += (square"),
    ("loewner/general.h", "felt(w, j, q->column[0][m], q->column[1][m]) * form[j][kl]",
     "q->column[0][m] * form[j][kl]"),
    ("loewner/problem.c", "off[1 - i];\n", "0.0;\n"),
    ("loewner/problem.c", "w->amplitude[i] *= scale;", ";"),
    ("loewner/problem.c", "            w->part[i][m] *= scale;", "            ;"),
    ("loewner/problem.c", "w->xstar[0] = s[0] + s[1];", "w->xstar[0] = s[0];"),
    ("model/torus.c", "does[q.n][j] = k[i][j / 2] * k[i][(j + 1) / 2]",
     "does[q.n][j] = k[i][j / 2] * k[i][j / 2]"),
    ("model/torus.c", "0.5 * along * along * fabs(q->p[i])", "0.5 * along * along * q->p[i]"),
    ("model/torus.c", "q->feels[i][1] * v[1]) - q->phase[i]", "q->feels[i][1] * v[1]) + q->phase[i]"),
    ("model/torus.c", "corner < 4;", "corner < 3;"),
    ("search/setup.c", "apm_mul_si(t, t, -2);", "apm_mul_si(t, t, -1);"),
    ("search/setup.c", "apm_cmp(p->phase[i], p->phase[j]) != 0", "0"),
    ("search/setup.c", "        good = exchangeable(p, vector);", "        good = 1;"),
    ("search/setup.c", "is_identity(p->frame) && apm_cmp(p->angle", "apm_cmp(p->angle"),
    ("loewner/three.h", "q->column[1][m] * (form[1][kl] + form[2][kl])",
     "q->column[1][m] * form[1][kl]"),
    ("loewner/bound.c", "larger(every(0.0), w->square[pair(columns, k, k)])",
     "larger(every(0.0), -w->square[pair(columns, k, k)])"),
    ("loewner/bound.c", "(l == k ? 0.75 : 0.5) * x", "(l == k ? 0.75 : -0.5) * x"),
    ("loewner/bound.c", "(l == k ? 0.75 : 0.5) * x", "(l == k ? -0.75 : 0.5) * x"),
    ("loewner/bound.c", "(l == k ? 0.25 : 0.5) * mag(x)", "(l == k ? 0.0 : 0.5) * mag(x)"),
    ("loewner/bound.c", "(l == k ? 0.25 : 0.5) * mag(x)", "(l == k ? 0.25 : 0.0) * mag(x)"),
    ("loewner/bound.c", "sign[l] * sign[m] * triple", "sign[l] * triple"),
    ("loewner/bound.c", "corner < 1 << (columns - 1)", "corner < 1 << (columns - 2)"),
    ("loewner/bound.c", "even + mag(odd)", "even + odd"),
    ("loewner/bound.c", "top = larger(top, even", "top = larger(every(0.0), even"),
    ("loewner/bound.c", "bound = least + t.cubes * (1.0 + each);", "bound = least;"),
    ("loewner/problem.c", "largest = larger(largest, sum);", "largest = sum;"),
    ("loewner/problem.c", "(2.0 * (double)cell->index[k] + 1.0)", "(2.0 * (double)cell->index[k])"),
    ("loewner/problem.c", "c->part[i][m] = w->part[i][m] * part[2 + m];", "c->part[i][m] = 0.0;"),
    ("loewner/problem.c", "c->width[i] = w->half[i] * part[i]",
     "c->width[i] = 0.5 * w->half[i] * part[i]"),
    ("loewner/problem.c", "            c->p[i] += w->part[i][m] * at_axis[2 + m];\n", ""),
    ("loewner/problem.c", "corner >> m & 1 ? 1.0 : -1.0", "corner >> m & 1 ? 1.0 : 1.0"),
    ("loewner/problem.c", "        sum += fabs(swing);\n", ""),
    ("loewner/problem.c", "m < w->n_parameters && at_end; m++", "m < 0 && at_end; m++"),
    ("loewner/orbit.c", "if (any(~next->reached))", "if (0)"),
    ("loewner/orbit.c", "static const double WIDEN = 1.0 + 0x1p-43;",
     "static const double WIDEN = 1.0;"),
    ("loewner/three.h", "q->fuzz = 0x1p-49 * (1.0", "q->fuzz = 0x1p-55 * (1.0"),
    ("loewner/three.h", " + w->size[2]) * (1.0 + q->far);", " + w->size[2]);"),
    ("loewner/three.h", "w->root->present[2] ? mag(q->x[0]) + mag(q->x[1]) : every(0.0)",
     "every(0.0)"),
    ("loewner/orbit.c", "const vec off = 0x1p-40 * (1.0 + q->far);", "const vec off = every(0.0);"),
    ("loewner/orbit.c", "0x1p-50 * (mag(q->x[i]) + mag(o->x[i]) + mag(before) + mag(x)) + q->fuzz;",
     "q->fuzz;"),
    ("loewner/orbit.c", "mag(before) + mag(x)) + q->fuzz;", "mag(before) + mag(x));"),
    ("loewner/orbit.c", "        e += q->missed[i];\n", ""),
    ("loewner/orbit.c", "(next->straight[i] + next->bowed[i] + o->reach[i])", "0.0"),
    ("loewner/orbit.c", "        e += carried(w, q, i);\n", ""),
    ("loewner/orbit.c", "(1.0 + condition);", "0.0;"),
    ("loewner/orbit.c", "(2.0 * q->fuzz + rounded) * rest_sum", "0.0"),
    ("loewner/orbit.c", "is_first ? o->rest[i] :", "is_first ? every(0.0) :"),
    ("loewner/orbit.c", "det > TINY", "det > 0.0"),
    ("loewner/bound.c", "left = 4.0 * q->fuzz * weights + 0x1p-50 * (mag(before) + mag(after));",
     "left = every(0.0);"),
    ("loewner/bound.c", "pick(inside, mag(q->mu[i]) * q->missed[i], every(0.0));", "0.0;"),
    ("loewner/bound.c", "t.rounding += t.mass * (each + 0x1p-49 * (1.0 + t.far));", ""),
    ("loewner/bound.c", "t.mass += mag(steep) * q->reach[i];\n", ""),
    ("loewner/bound.c", "((1.0 + wide) * square(1.0 + wide))", "0.0"),
    ("loewner/bound.c", "((1.0 + wide) * square(1.0 + wide))", "1.0"),
    ("loewner/bound.c", "0x1p-47 * (double)(number(&w->until, k) - number(&w->since, k) + 2)",
     "0.0"),
    ("loewner/bound.c", "0x1p-49 * (1.0 + t.far)", "0.0"),
    ("loewner/bound.c", " + fourth) + loose;", " + fourth);"),
    ("loewner/bound.c", "pick(TRUTH(t.mass >= 1.0), bound, every(HUGE_VAL))", "bound"),
    ("loewner/bound.c", "weights_of(w, omega, m) + tiny;", "weights_of(w, omega, m);"),
    ("arith/lanes.h", "TRUTH(x > y) | TRUTH(x != x)", "TRUTH(x > y)"),
    ("loewner/problem.c", "w->slack[i] = 0x1p-48 * (fabs(w->centre[i]) + w->half[i]);",
     "w->slack[i] = 0.0;"),
    ("loewner/problem.c", "0x1p-48 * (fabs(w->centre[i]) + w->half[i])",
     "0x1p-54 * (fabs(w->centre[i]) + w->half[i])"),
    ("loewner/problem.c", "w->xstar_err[i] = 0x1p-49 * fabs(w->xstar[i]);",
     "w->xstar_err[i] = 0.0;"),
    ("loewner/problem.c", "return largest * (1.0 + 0x1p-46);", "return largest;"),
    ("loewner/problem.c", " * (1.0 - 0x1p-46);   /*", ";   /*"),
    ("loewner/problem.c", "sum + 0x1p-45 * (1.0 + far) * mass < 0.0",
     "sum < 0.0"),
    ("loewner/problem.c", "mass >= 1.0 && sum", "sum"),
    ("loewner/problem.c", "return wide && cell->cuts[axis] < FINEST;", "return wide;"),
    ("loewner/problem.c", "ldexp(w->half[axis], 2 - cell->cuts[axis]) > w->slack[axis]", "1"),
    ("loewner/problem.c", "cell->cuts[k] > FINEST", "0"),
    ("search/tree.c", "axis < 0 || !may_cut(s", "!may_cut(s"),
    ("loewner/try.c", "part < 1.0 ? sqrt(sqrt(part)) : 1.0", "1.0"),
    ("loewner/try.c", "        worst = widest;", "        ;"),
    ("arith/sine.h", "0x1.0b4611a6p-34) - n", "0x1.0b4611a7p-34) - n"),
    ("loewner/problem.c", "return largest * (1.0 + 0x1p-46);", "return largest - 1e-9;"),
    # lanes that are mixed up, what other prisms left behind, and notes of what was looked at ahead
    ("arith/lanes.h", "way * (number(&m, k) - best) > 0", "number(&m, k) - best > 0"),
    ("arith/lanes.h", "    for (int k = 0; k < LANES; k++)\n        x[k] = sqrt(x[k]);",
     "    x[0] = sqrt(x[0]);"),
    ("arith/sine.h", "~TRUTH(mag(x) <= SINE_LIMIT)", "~TRUTH(mag(x) <= 1e300)"),
    ("arith/sine.h", "((bits + 1) & 2) << 62", "(bits & 2) << 62"),
    ("arith/sine.h", "SHIFT = 0x1.8p52", "SHIFT = 0x1p52"),
    ("loewner/orbit.c", "SHIFT = 0x1.8p52", "SHIFT = 0x1p52"),
    ("loewner/orbit.c", "mag(next->turns[0]) + mag(next->turns[1])", "mag(next->turns[0])"),
    ("loewner/orbit.c", "TRUTH(d[0] > 0.0) & TRUTH(det", "TRUTH(det"),
    ("loewner/orbit.c", " & TRUTH(condition < 0x1p20);", ";"),
    ("loewner/orbit.c", "memset(origin, 0, 2 * sizeof *origin);",
     "memset(origin, 0, sizeof *origin);"),
    ("loewner/orbit.c", "w->weighed_last = ORIGIN - 1;",
     "w->weighed_last = w->weighed_last < ORIGIN ? ORIGIN - 1 : ORIGIN + 1;"),
    ("loewner/orbit.c", "    w->known_last = ORIGIN + 1;\n",
     "    if (w->known_last == 0) w->known_last = ORIGIN + 1;\n"),
    ("loewner/orbit.c", "if (holds(&q[next].reached, k)) {", "if (1) {"),
    ("loewner/orbit.c", "if (holds(&q[next].reached, k)) {", "if (holds(&q[next].reached, 0)) {"),
    ("loewner/orbit.c", "if (holds(&q[next].reached, k)) {", "if (any(q[next].reached)) {"),
    ("loewner/witness.c", "choose(TRUTH(to > ORIGIN), to, ORIGIN + 1 - none())", "to"),
    ("loewner/witness.c", "choose(TRUTH(first < ORIGIN - none()), first, ORIGIN - none())", "first"),
    ("loewner/witness.c", "q[j].n[i] = pick(turn, n[i], q[j].n[i]);", "q[j].n[i] = n[i];"),
    ("loewner/witness.c", "q[j].n[i] = pick(in, n[i], q[j].n[i]);", "q[j].n[i] = n[i];"),
    ("loewner/witness.c", "pick(in & TRUTH(here <= w->to), next[i], every(0.0))",
     "pick(in, next[i], every(0.0))"),
    ("loewner/witness.c", "TRUTH(here <= site) & TRUTH(here >= w->from)", "TRUTH(here <= site)"),
    ("loewner/witness.c", "put_number(&last, k, w->last[k]);", "put_number(&last, k, w->last[0]);"),
    ("loewner/bound.c", "q[j].mu[i] = pick(turn, every(0.0), q[j].mu[i]);", ";"),
    ("loewner/bound.c", "for (int j = begin - 1; j <= end + 1; j++)",
     "for (int j = begin; j <= end + 1; j++)"),
    ("loewner/bound.c", "for (int j = begin - 1; j <= end + 1; j++)",
     "for (int j = begin - 1; j <= end; j++)"),
    ("loewner/bound.c",
     "for (int j = end; j > ORIGIN + 1; j--) {\n        const mask now = turn & within(w, j);",
     "for (int j = end; j > ORIGIN + 1; j--) {\n        const mask now = turn;"),
    ("loewner/bound.c",
     "for (int j = begin; j < ORIGIN; j++) {\n        const mask now = turn & within(w, j);",
     "for (int j = begin; j < ORIGIN; j++) {\n        const mask now = turn;"),
    ("loewner/bound.c", "linked = TRUTH(site < w->to)", "linked = ~none()"),
    ("loewner/bound.c", "linked = TRUTH(site < w->to)", "linked = TRUTH(site <= w->to)"),
    ("loewner/bound.c", "TRUTH(w->since < site) & TRUTH(site < w->until)", "none()"),
    ("loewner/bound.c", "pick(own, q->far, every(0.0))", "every(0.0)"),
    ("loewner/bound.c", "at(&last->n[i], k) * at(&last->n[i], k)",
     "at(&last->n[i], 0) * at(&last->n[i], 0)"),
    ("loewner/bound.c", "w->orbit + number(&w->to, k);", "w->orbit + number(&w->to, 0);"),
    ("loewner/bound.c", "w->orbit + number(&w->from, k);", "w->orbit + number(&w->until, k);"),
    ("loewner/bound.c", "put_at(&tails, k, sum);", "put_at(&tails, 0, sum);"),
    ("loewner/bound.c", "w->cubic[m][kl] = pick(turn, every(0.0), w->cubic[m][kl]);", ";"),
    ("loewner/bound.c", "bound = pick(refine, more + summit(w, columns, 1), bound);",
     "bound = more + summit(w, columns, 1);"),
    ("loewner/bound.c", "w->slope[k] = pick(turn, t.slope[k], w->slope[k]);",
     "w->slope[k] = t.slope[k];"),
    ("loewner/bound.c", "        weigh(w, w->orbit + --w->weighed_first);",
     "        w->weighed_first--;"),
    ("loewner/bound.c",
     "        const mask now = turn & within(w, j);\n        for (int i = 0; i < WAVES; "
     "i++) {\n            const mask some",
     "        const mask now = turn;\n        for (int i = 0; i < WAVES; i++) {\n         "
     "   const mask some"),
    ("loewner/bound.c", "q->load += (w->size[i]", "q->load = (w->size[i]"),
    ("loewner/bound.c", "return TRUTH(w->since <= site) & TRUTH(site <= w->until);",
     "return ~none();"),
    ("loewner/try.c", "        if (holds(&contradict, k)) {", "        if (holds(&turn, k)) {"),
    ("loewner/try.c", "        if (holds(&contradict, k)) {", "        if (any(contradict)) {"),
    ("loewner/try.c", "bound = at(&w->bound, k)", "bound = at(&w->bound, 0)"),
    ("loewner/try.c", "put_at(&w->size[i], k, fabs(c->p[i]) + h + c->loose[i]);",
     "put_at(&w->size[i], k, fabs(c->p[i]));"),
    ("loewner/try.c", "points >= cells[k]->from", "points >= cells[0]->from"),
    ("loewner/problem.c", "return c->l > 0.0;", "return 1;"),
    ("search/tree.c",
     "p->halves[0] = new_note(s, &lower);\n            p->halves[1] = new_note(s, &upper);",
     "p->halves[1] = new_note(s, &lower);\n            p->halves[0] = new_note(s, &upper);"),
    ("search/tree.c", "s->noted[top + 1] = lower;\n            s->noted[top] = upper;",
     "s->noted[top + 1] = upper;\n            s->noted[top] = lower;"),
    ("search/tree.c", "upper.from = p->outcome.from;", ";"),
    ("search/tree.c", "s->stack[top].from = n->outcome.from;", ";"),
    ("search/tree.c", "p->known = p->skipped = may_skip", "p->known = may_skip"),
    ("search/tree.c", "    if (id == s->free_note)\n        s->free_note = n->halves[0];\n", ""),
    ("search/tree.c", "        s->noted[j] = -1;\n    }", "    }"),
    ("search/tree.c", "    s->free_note = -1;\n", ""),
    ("search/tree.c", "    s->noted[s->pending - 1] = s->noted[s->pending] = -1;\n", ""),
    ("search/tree.c", "out[k] = &s->notes[list[k]].outcome;", "out[k] = &s->notes[list[0]].outcome;"),
    ("search/tree.c", "s->n_notes + s->pending + 2 * MOST_LANES > s->allocated_notes",
     "s->n_notes > s->allocated_notes"),
    ("loewner/try.c", "v->no_tori = bound < 0.0;", "v->no_tori = !(bound >= 0.0);"),
    ("loewner/orbit.c", "    next->reached &= TRUTH(next->widest <= USELESS);\n", ""),
    ("loewner/bound.c", "        const mask now = turn & within(w, j);\n        vec form",
     "        const mask now = turn;\n        vec form"),
    ("loewner/try.c", "put_at(&w->l, k, c->l);", "put_at(&w->l, 0, c->l);"),
    ("loewner/problem.c", "w->present[i] = size != 0.0;",
     "w->present[i] = w->amplitude[i] != 0.0;"),
    ("search/tree.c", "p->settled &= *n < most && list_unknown", "p->settled &= list_unknown"),
    ("search/tree.c", "    *n = (note){ .cell = *cell, .halves = { -1, -1 } };",
     "    n->cell = *cell;\n    n->halves[0] = n->halves[1] = -1;"),
    ("orbits/minplus.c", "((2.0 + fabs(eps) * curvature) * squares",
     "((0.0 + fabs(eps) * curvature) * squares"),
    ("orbits/minplus.c", "((2.0 + fabs(eps) * curvature) * squares",
     "((2.0 + fabs(eps)) * squares"),
    ("orbits/minplus.c", "squares * 0.125", "squares * 0.01"),
    ("orbits/minplus.c", "most + r->bend < lowest", "most < lowest"),
    ("orbits/minplus.c", "first->W, &where) - first->bend;", "first->W, &where);"),
    ("orbits/minplus.c", "known + margin, lowest", "known, lowest"),
    ("orbits/minplus.c", "    *least -= margin;\n", ""),
    ("orbits/minplus.c", "? -c->u[i] : HUGE_VAL", "? c->u[i] : HUGE_VAL"),
    ("orbits/minplus.c", "? c->end[i] - c->u[i] : HUGE_VAL", "? c->end[i] : HUGE_VAL"),
    ("orbits/minplus.c", "last[axis] + (r->nodes[axis] > 1)", "last[axis]"),
    ("orbits/minplus.c", "first = middle + 1;\n        left = best;",
     "first = middle + 1;\n        left = best + 1;"),
    ("orbits/minplus.c", "cheapest(l, first, middle, left, best);",
     "cheapest(l, first, middle, left, best - 1);"),
    ("orbits/minplus.c", "(int)floor(grid * (-c - 0.5))", "(int)floor(grid * -c)"),
    ("orbits/minplus.c", "count = 2 * grid + 3", "count = grid + 1"),
    ("orbits/minplus.c", "part *= 6.3 * k)", "part *= 6.3)"),
    ("orbits/minplus.c", "double part = 0x1p-48 *", "double part = 0x1p-54 *"),
    ("orbits/minplus.c", "{ 0x1p-43, 0x1p-41, 0x1p-39 }",
     "{ 0x1p-51, 0x1p-51, 0x1p-48 }"),
    ("orbits/minplus.c", "{ 0x1p-47, 0x1p-43, 0x1p-40 }",
     "{ 0x1p-53, 0x1p-51, 0x1p-48 }"),
    ("orbits/minplus.c", "v->kind == CV_PYTHON || !(reach < 1000.0)",
     "!(reach < 1000.0)"),
    ("orbits/minplus.c", "v->kind == CV_PYTHON || !(reach < 1000.0)",
     "v->kind == CV_PYTHON"),
    ("orbits/minplus.c", "    if (!(sum < 1e300))\n        return CV_EARITHMETIC;\n", ""),
    ("orbits/minplus.c", "here[0] < 1 || here[0] > MAX_NODES ||", "here[0] < 1 ||"),
    ("orbits/potential.c", "slope = v->sine[t] * c - v->cosine[t] * s;",
     "slope = v->sine[t] * c + v->cosine[t] * s;"),
    ("orbits/potential.c", "h01 -= k0 * k1 * here;", "h01 += k0 * k1 * here;"),
    ("orbits/potential.c", "2.0 * fs + 4.0 * s * fss", "2.0 * fs + 2.0 * s * fss"),
    ("orbits/potential.c", "-4.0 * e + 8.0 * t", "-4.0 * e - 8.0 * t"),
    ("orbits/potential.c", "turn > 0.5 ? -1.0 : 1.0", "1.0"),
    ("orbits/potential.c", "hessian[2] = -0.25 * c1.second", "hessian[2] = -0.25 * c0.second"),
    ("orbits/relax.c", "j > 0 ? j - 1 : q - 1", "j > 0 ? j - 1 : 0"),
    ("orbits/relax.c", "(i == 1 ? 0.0 : 2.0) - of->eps", "2.0 - of->eps"),
    ("orbits/relax.c", "squares < HUGE_VAL ? largest : HUGE_VAL", "largest"),
    ("orbits/relax.c", "!(difference <= a->doubt)", "!(difference <= 0.0)"),
    ("orbits/relax.c", "return difference < 0.0;", "return difference > 0.0;"),
    ("orbits/relax.c", "return may_walk && along < 0.0 &&", "return may_walk && along > 0.0 &&"),
    ("orbits/relax.c", "return may_walk && along < 0.0 &&", "return 0 &&"),
    ("orbits/relax.c", "if (negative > 0 && how->escapes < MOST_ESCAPES) {", "if (0) {"),
    ("orbits/relax.c", "move(of->q, other, at, chosen,", "move(of->q, other, at, -chosen,"),
    ("orbits/relax.c", "double low = FLAT, high = 1.0, most;", "double low = 1.0, high = 1.0, most;"),
    ("orbits/relax.c", "-fmin(1.0, CAP / widest(q, (const point *)along))", "-1.0"),
    ("orbits/relax.c", "at->action = sum + lost;", "at->action = sum;"),
    ("orbits/relax.c", "double mu = how->damping;", "double mu = 0.0;"),
    ("orbits/relax.c", "if (status == CV_OK && lower(q, other, at, how->steps < WALK)) {",
     "if (status == CV_OK) {"),
    ("orbits/relax.c", "        status = descend(&of, at, other, along, tol, max_steps, how);\n"
     "        memcpy(u, at->u, size * sizeof *u);\n",
     "        status = descend(&of, at, other, along, tol, max_steps, how);\n"
     "        memcpy(u, places[0].u == at->u ? other->u : at->u, size * sizeof *u);\n"),
    ("orbits/band.c", "j == q - 2 && k < 2", "j == q && k < 2"),
    ("orbits/band.c", "        last.b -= dot(here->v[0], next.v[1]);\n", ""),
    ("orbits/band.c", "if (j < q - 2)\n                    r[i] += u[j + 1][i];", ""),
    ("orbits/band.c", "        last.c -= n == 2 ? 2.0 : 0.0;\n", ""),
    ("orbits/band.c", "const double idle = n == 2 ? mu : 0.0;", "const double idle = mu;"),
    ("orbits/band.h", "det > 0.0 ? (m.a > 0.0 ? 0 : 2)", "det > 0.0 ? 0"),
    ("orbits/band.c", "return -round;", "return 0;"),
    ("orbits/band.c", "sym here = { HELD, 0.0, n == 2 ? HELD : 1.0 };",
     "sym here = { 0.6, 0.0, n == 2 ? 0.6 : 1.0 };"),
    ("orbits/band.c", "if (round > 1 && moved < 1e-13)", "if (round > 1 && moved < 1e-3)"),
    ("orbits/band.c", "both += log(sym_det(sym_of(d[j])));", "both += log(d[j][0] * d[j][2]);"),
    ("orbits/band.c", "fabs(half) + sqrt(disc)", "half + sqrt(disc)"),
    ("orbits/band.c", "disc > 0.0 ? size", "disc > 1e300 ? size"),
    ("orbits/measure.c", "const double across = right->x[0] - left->x[0] + (a + step >= q ? 1.0 : 0.0);",
     "const double across = right->x[0] - left->x[0];"),
    ("orbits/measure.c", "fmin(up, 1.0 - up)", "up"),
    ("orbits/measure.c", "across == 0.5 && left->index > right->index", "0"),
    ("orbits/measure.c", "heap[child + 1].square > heap[child].square",
     "heap[child + 1].square < heap[child].square"),
    ("orbits/measure.c", "(kept == count && across * across >= heap[0].square)", "kept == count"),
    ("orbits/measure.c", "if (kept == count && square >= heap[0].square)\n                continue;", ""),
]

# Survivors that do not matter, by what stands there, with the reason.
HARMLESS = {
    "v->no_tori = bound < 0.0;":
        "a second belt: where the bound is NaN so is the mass, and then HUGE_VAL takes its place",
    "    next->reached &= TRUTH(next->widest <= USELESS);\n":
        "such a point only ends an orbit a step later, and its reach is a bound all the same",
    "        const mask now = turn & within(w, j);\n        vec form":
        "a second belt: n and mu are zero outside of a lane's own sites in the range of its turn",
    "        if (isnan(bound))\n            return bound;\n":
        "a second belt: larger keeps the NaN until the cells run out",
    "mpz_sub_ui(lower, lower, 1UL);":
        "without it pi is right unless fifteen digits of it coincide with nines or zeros",
    "        if (j == 2) ":
        "the sum over both rows is more than the larger row, which would do",
    "num_add(t[1], t[1], n->gamma_dif);":
        "the map is affine in the parameters: on a path that changes them first, at the centre's v, "
        "gamma is gamma_c, and the bound of beta - beta_c alone serves for the rest",
    "num_add(t[3], t[3], t[4]);\n    num_mul_si(t[4], n->centre_err, 2);":
        "twelve ulps times the error of the inverse, beside the prism times the same",
    "        v->no_tori = 0;\n":
        "a second belt: each divisor was just found to be above a positive bound, and comparisons "
        "with NaN are false",
    "det > TINY":
        "a determinant below 2^-800 would need two entries of beta that are differences from 2 and "
        "yet as small as 2^-400",
    "pick(TRUTH(t.mass >= 1.0), bound, every(HUGE_VAL))":
        "a second belt: one of the vectors n is a unit vector",
    "mass >= 1.0 && sum": "a second belt: n is a unit vector",
    "weights_of(w, omega, m) + tiny;":
        "TINY is for products that underflow beside parameters and reaches of more than 10^100",
    "TRUTH(x > y) | TRUTH(x != x)":
        "a second belt: where far or B is NaN, so are sines or all corners, and the bound",
    "squares < HUGE_VAL ? largest : HUGE_VAL":
        "a second belt: what a potential from Python answers is finite, and so is what ours do",
}


def build(base, work, file):
    """Compiles the units that the changed file belongs to, and links; base has all other objects."""
    shutil.copytree(ROOT / "converse", work / "converse",
                    ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    objects = []
    for source in sorted(base.glob("*.d")):
        words = source.read_text().replace("\\\n", " ").split()
        objects.append(base / (source.stem + ".o"))
        if "csrc/" + file in words:
            objects[-1] = work / (source.stem + ".o")
            subprocess.run(["gcc", *FLAGS, "-c", words[1], "-o", str(objects[-1])], cwd=work,
                           check=True)
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    subprocess.run(["gcc", "-shared", *objects, "-lgmp", "-lm",
                    "-o", str(work / "converse" / ("_native" + suffix))], check=True)


def prepare(base):
    """The objects of the unchanged core, and what each is made of."""
    code = "exec(open('converse/_build.py').read()); ffi.emit_c_code(%r); print(*SOURCES)"
    sources = subprocess.run([sys.executable, "-c", code % str(base / "native.c")], cwd=ROOT,
                             check=True, capture_output=True, text=True).stdout.split()
    sources = [word for word in sources if word.startswith("csrc/")]
    for source in [str(base / "native.c"), *sources]:
        unit = str(base / source.replace("csrc/", "").replace("/", "-").removesuffix(".c")) \
            if source in sources else str(base / "native")
        subprocess.run(["gcc", *FLAGS, "-MMD", "-c", source, "-o", unit + ".o"], cwd=ROOT,
                       check=True)


def try_mutation(base, number):
    """'caught by ...' or 'SURVIVED'."""
    file, old, new = MUTATIONS[number]
    text = (ROOT / "csrc" / file).read_text()
    if text.count(old) != 1:
        return "STALE: stands %d times" % text.count(old)
    with tempfile.TemporaryDirectory() as directory:
        work = Path(directory)
        shutil.copytree(ROOT / "csrc", work / "csrc")
        (work / "csrc" / file).write_text(text.replace(old, new))
        build(base, work, file)
        environment = dict(os.environ, PYTHONPATH=str(work))
        first = FIRST.get(file, FIRST.get(file.split("/")[0], "test_images.py"))
        tests = sorted(ORBITS if file.startswith("orbits") else TESTS, key=lambda test: test != first)
        for test in tests:
            command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider",
                       "--no-header", str(ROOT / "tests" / test)]
            try:
                result = subprocess.run(command, cwd=work, env=environment, text=True,
                                        capture_output=True, timeout=300)
            except subprocess.TimeoutExpired:
                return "caught by %s (no end)" % test
            if result.returncode:
                failed = [line for line in result.stdout.splitlines()
                          if line.startswith(("FAILED", "ERROR"))]
                where = failed[0].split("::")[-1].split(" - ")[0] if failed else "a crash"
                return "caught by %s, %s" % (test, where)
    return "harmless: " + HARMLESS[old] if old in HARMLESS else "SURVIVED"


def main(numbers):
    numbers = numbers or range(len(MUTATIONS))
    with tempfile.TemporaryDirectory() as directory:
        base = Path(directory)
        prepare(base)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = pool.map(lambda n: try_mutation(base, n), numbers)
            bad = caught = 0
            for number, result in zip(numbers, results):
                file, old, new = MUTATIONS[number]
                print("%3d %-18s %-60.60s %s" % (number, file, " ".join(old.split()), result),
                      flush=True)
                caught += result.startswith("caught")
                bad += result.startswith(("SURVIVED", "STALE"))
    print("%d caught, %d survived that matter" % (caught, bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main([int(word) for word in sys.argv[1:]]))
