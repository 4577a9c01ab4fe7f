/* minplus.c - the least action over all orbits: sums of H(x, x') = |x' - x|^2/2 - eps V(x) become
   sums over paths on a grid, and their minima follow from one another point by point (the
   Lax-Oleinik operator).

   From the torus to a grid.  Let x_0, x_1, ... be any points and e_j the grid's pitch about x_j.
   Replace each x_j by a corner y_j of its cell, each coordinate at random, independently, and so
   that the mean of y_j is x_j.  Then a coordinate of y_j has a variance of e_j^2/4 at most, that of
   |y_{j+1} - y_j|^2/2 is on the average what it was and half of both variances more, and
   -eps V(y_j) is at most -eps V(x_j) and |eps| K2/2 times the variance more, K2 >= |V''|.  So on
   the average, and hence for some choice of corners, the action of the y_j exceeds the action of
   the x_j by at most

       sum over j and coordinates i of (2 + |eps| K2) e_ji^2/8.                               (1)

   Whatever bounds all paths on the grid from below, bounds all paths less (1).  Where all points
   have the same grid, one threshold will do for all of them, y_j = e floor(x_j/e + r) with a random
   r: then y_{j+1} - y_j is also one of two neighbours of its mean, and (1) has 1 in place of 2.

   Rounding.  Unit u = 2^-53.  Nodes are doubles, so only W = -eps V is not what it should be there,
   by cv_errors, and what is computed from it rounds: see cheapest, and the margins that refer
   to it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arith/lanes.h"
#include "arith/machine.h"
#include "converse.h"
#include "orbits.h"
#include "minplus.h"

enum { MAX_NODES = 1025 };              /* along an axis of a corridor */

/* Fourier: the point is off by u(2 reach + 2), k.x by 2u |k| reach more, |k| the sum of both, 2 pi
   times what is left of it after whole turns by 7u, the sine by 4u: u(26 |k|(reach + 1) + 11).  The
   amplitude is off by 3u of itself, the products and 2 pi k by 9u, the sum over the terms by u
   each.
   poly: 2^-43, 2^-41, 2^-39 are 1024u, 4096u and 16384u.  The roundings of the formulas make 40u,
   400u and 6000u of them at most, and the point, off by u(2 reach + 3) once its whole turns are
   taken off, moves V by 9 times, its gradient by 116 times, V'' by 2800 times as much.
   ff: the same; c, c', c'' have slopes of at most 12, 48 and 192, and x0 + x1 is off by
   u(6 reach + 6). */
int cv_errors(const cv_potential *v, double reach, double errors[3])
{
    static const double of_poly[3] = { 0x1p-43, 0x1p-41, 0x1p-39 },
                        of_ff[3] = { 0x1p-47, 0x1p-43, 0x1p-40 };

    for (int order = 0; order < 3; order++)
        errors[order] = v->kind == CV_POLY ? of_poly[order] * (reach + 1.0)
                      : v->kind == CV_FF   ? of_ff[order] * (reach + 2.0)
                                           : 0.0;
    for (int t = 0; v->kind == CV_FOURIER && t < v->terms; t++) {
        const double k = abs(v->k[2 * t]) + abs(v->k[2 * t + 1]);
        double part = 0x1p-48 * (k * (reach + 1.0) + 1.0 + v->terms) *
                      (fabs(v->cosine[t]) + fabs(v->sine[t]));
        for (int order = 0; order < 3; order++, part *= 6.3 * k)
            errors[order] += part;
    }
    const int known = v->kind == CV_FOURIER || v->kind == CV_POLY || v->kind == CV_FF;
    return !known || !(reach < 1000.0) ? CV_EARGUMENT : machine_is_sound() ? CV_OK : CV_EMACHINE;
}

/* ---- one axis */

typedef struct {
    const double *x, *f, *y;
    double *out;
    int *from;
    long stride;
} line;

/* out[k] = min over i of f[i] + (y[k] - x[i])^2/2 for first <= k < end, where the least is among
   left <= i <= right; x and y increase.  from[k], unless it is NULL: the i.

   An infinite f[i] takes no part in a minimum.  The terms -y[k] x[i] favour large i for large k:
   if i < i' and k < k',
       cost(k, i) + cost(k', i') <= cost(k, i') + cost(k', i).
   So the least of the row in the middle halves the search of the others.  Let a computed cost be
   off by at most c.  The i that is found is least up to 2c.  So by the inequality each row below
   has an i that is not smaller, whose cost is at most 2c above the row's least; and each row above
   has one that is not larger.  2048 rows are halved 12 times: each comes out within 25c of the
   truth. */
static void cheapest(const line *l, int first, int end, int left, int right)
{
    while (first < end) {
        const int middle = first + (end - first) / 2;
        const double y = l->y[middle];
        double least = HUGE_VAL;
        int best = left;

        for (int i = left; i <= right; i++) {
            const double d = y - l->x[i], cost = l->f[i] + 0.5 * d * d;
            if (cost < least) {
                least = cost;
                best = i;
            }
        }
        l->out[middle * l->stride] = least;
        if (l->from)
            l->from[middle * l->stride] = best;
        cheapest(l, first, middle, left, best);
        first = middle + 1;
        left = best;
    }
}

/* The rows of `in`, m numbers at x each, become the columns of `out`, at y. */
static void along_axis(int rows, int m, const double *x, const double *in, int k, const double *y,
                       double *out)
{
    for (int row = 0; row < rows; row++) {
        const line l = { x, in + (size_t)row * (size_t)m, y, out + row, NULL, rows };
        cheapest(&l, 0, k, 0, m - 1);
    }
}

/* ---- corridors */

typedef struct {
    int nodes[2];
    size_t size;                        /* of all arrays below: nodes[0] x nodes[1] */
    double *at[2];                      /* where the nodes are */
    double *W;                          /* -eps V there; infinite: excluded */
    double *F;                          /* the least action of a path that comes here */
    double bend;                        /* (1), this rectangle's part */
} rectangle;

typedef struct {
    int q;
    rectangle *r;
    double *u, *end, *G, *T, *spare;
} corridor;

/* out = min over the nodes of `from` of in + |difference|^2/2, at the nodes of `to`. */
static void step(const corridor *c, const rectangle *from, const double *in, const rectangle *to,
                 double *out)
{
    along_axis(from->nodes[0], from->nodes[1], from->at[1], in, to->nodes[1], to->at[1], c->spare);
    along_axis(to->nodes[1], from->nodes[0], from->at[0], c->spare, to->nodes[0], to->at[0], out);
}

/* The least and the largest of an array's values at the corners of a cell. */
static void corners(const rectangle *r, const double *values, int i, int k, double *least,
                    double *most)
{
    *least = HUGE_VAL;
    *most = -HUGE_VAL;
    for (int a = 0; a < 2 && a < r->nodes[0]; a++)
        for (int b = 0; b < 2 && b < r->nodes[1]; b++) {
            const double value = values[(size_t)(i + a) * (size_t)r->nodes[1] + (size_t)(k + b)];
            *least = value < *least ? value : *least;
            *most = value > *most ? value : *most;
        }
}

static int cells(const rectangle *r, int axis)
{
    return r->nodes[axis] > 1 ? r->nodes[axis] - 1 : 1;
}

/* Is W below `lowest` in all of the cell?  There it is at most what its corners give, interpolated,
   and `bend` more. */
static int too_low(const rectangle *r, int i, int k, double lowest)
{
    double least, most;
    corners(r, r->W, i, k, &least, &most);
    return most == HUGE_VAL || most + r->bend < lowest;
}

/* Excludes the nodes all of whose cells are too low. */
static void exclude(rectangle *r, double lowest, double *wanted)
{
    memset(wanted, 0, r->size * sizeof *wanted);
    for (int i = 0; i < cells(r, 0); i++)
        for (int k = 0; k < cells(r, 1); k++)
            if (!too_low(r, i, k, lowest))
                for (int a = 0; a < 2 && a < r->nodes[0]; a++)
                    for (int b = 0; b < 2 && b < r->nodes[1]; b++)
                        wanted[(size_t)(i + a) * (size_t)r->nodes[1] + (size_t)(k + b)] = 1.0;
    for (size_t i = 0; i < r->size; i++)
        if (wanted[i] == 0.0)
            r->W[i] = HUGE_VAL;
}

/* Lays nodes from low to high, both included, and evaluates W there.  r->bend becomes (1) plus the
   error of W: cv_errors, u of itself for the product, and u for eps, which stands for a decimal. */
static int lay_grid(rectangle *r, const cv_potential *v, double eps, double curvature,
                    const double base[2], const double low[2], const double high[2], double (*x)[2])
{
    double errors[3], reach = 0.0, largest = 0.0, squares = 0.0;
    int status;

    for (int axis = 0; axis < 2; axis++) {
        const int last = r->nodes[axis] - 1;
        double pitch = 0.0;
        for (int i = 0; i <= last; i++)
            r->at[axis][i] =
                i == last ? high[axis] : low[axis] + (high[axis] - low[axis]) / last * i;
        for (int i = 0; i < last; i++)
            pitch = fmax(pitch, r->at[axis][i + 1] - r->at[axis][i]);
        squares += pitch * pitch;
        reach = fmax(reach, 1.0 + fmax(fabs(low[axis]), fabs(high[axis])));
    }
    for (size_t i = 0; i < r->size; i++) {
        x[i][0] = base[0] + r->at[0][i / (size_t)r->nodes[1]];
        x[i][1] = base[1] + r->at[1][i % (size_t)r->nodes[1]];
    }
    cv_evaluate(v, (long)r->size, (const double (*)[2])x, r->W, NULL, NULL);
    status = cv_errors(v, reach, errors);
    for (size_t i = 0; status == CV_OK && i < r->size; i++) {
        r->W[i] *= -eps;
        largest = larger(largest, fabs(r->W[i]));
    }
    r->bend = ((2.0 + fabs(eps) * curvature) * squares * 0.125 + fabs(eps) * errors[0] +
               0x1p-52 * largest) *
              (1.0 + 0x1p-40);
    return status;
}

/* The least number of an array, and where it is. */
static double array_min(size_t n, const double *values, size_t *where)
{
    double least = HUGE_VAL;
    for (size_t i = 0; i < n; i++)
        if (values[i] < least) {
            least = values[i];
            *where = i;
        }
    return least;
}

/* Forward pass: F of every rectangle and `end`, for paths whose cost begins with u; T = end - u.
   Returns the least of T at the nodes that are not excluded; it is infinite without a path. */
static double forward(corridor *c, size_t *where)
{
    rectangle *const first = c->r;

    memcpy(first->F, c->u, first->size * sizeof *c->u);
    for (int j = 0; j < c->q; j++) {
        const rectangle *const here = c->r + j, *const next = j + 1 < c->q ? here + 1 : first;
        for (size_t i = 0; i < here->size; i++)
            c->G[i] = here->F[i] + here->W[i];
        step(c, here, c->G, next, j + 1 < c->q ? next->F : c->end);
    }
    for (size_t i = 0; i < first->size; i++)
        c->T[i] = first->W[i] < HUGE_VAL ? c->end[i] - c->u[i] : HUGE_VAL;
    return array_min(first->size, c->T, where);
}

/* A path that ends in this node of the first rectangle, as cheap as any. */
static void trace_back(const corridor *c, size_t where, double (*path)[2])
{
    const rectangle *next = c->r;

    for (int j = c->q - 1; j >= 0; j--) {
        const rectangle *const here = c->r + j;
        const double y0 = next->at[0][where / (size_t)next->nodes[1]],
                     y1 = next->at[1][where % (size_t)next->nodes[1]];
        for (size_t i = 0; i < here->size; i++) {
            const double d0 = y0 - here->at[0][i / (size_t)here->nodes[1]],
                         d1 = y1 - here->at[1][i % (size_t)here->nodes[1]];
            c->T[i] = here->F[i] + here->W[i] + 0.5 * (d0 * d0 + d1 * d1);
        }
        array_min(here->size, c->T, &where);
        path[j][0] = here->at[0][where / (size_t)here->nodes[1]];
        path[j][1] = here->at[1][where % (size_t)here->nodes[1]];
        next = here;
    }
}

/* The smallest rectangle around those cells that are not too low and have a corner where T is at
   most `most`.  0: there is none. */
static int shrink(const corridor *c, const rectangle *r, double most, double lowest, double low[2],
                  double high[2])
{
    int first[2] = { MAX_NODES, MAX_NODES }, last[2] = { -1, -1 };

    for (int i = 0; i < cells(r, 0); i++)
        for (int k = 0; k < cells(r, 1); k++) {
            double least, largest;
            corners(r, c->T, i, k, &least, &largest);
            if (least <= most && !too_low(r, i, k, lowest)) {
                first[0] = i < first[0] ? i : first[0];
                first[1] = k < first[1] ? k : first[1];
                last[0] = i > last[0] ? i : last[0];
                last[1] = k > last[1] ? k : last[1];
            }
        }
    for (int axis = 0; axis < 2 && last[0] >= 0; axis++) {
        low[axis] = r->at[axis][first[axis]];
        high[axis] = r->at[axis][last[axis] + (r->nodes[axis] > 1)];
    }
    return last[0] >= 0;
}

/* Excludes cells that are too low; *bend is the sum of (1).  Returns a number that no sum of costs
   along a path exceeds. */
static double exclude_cells(corridor *c, double lowest, double *bend)
{
    double sum = 0.0, largest = 0.0;

    *bend = 0.0;
    for (int j = 0; j < c->q; j++) {
        rectangle *const here = c->r + j, *const next = c->r + (j + 1 < c->q ? j + 1 : 0);
        for (size_t i = 0; i < here->size; i++)
            largest = larger(largest, fabs(here->W[i]));
        exclude(here, lowest, c->T);
        *bend += here->bend;
        for (int axis = 0; axis < 2; axis++) {
            const double up = next->at[axis][next->nodes[axis] - 1] - here->at[axis][0],
                         down = here->at[axis][here->nodes[axis] - 1] - next->at[axis][0];
            sum += 0.5 * larger(up * up, down * down);
        }
    }
    return sum + c->q * largest;
}

/* Backward pass: shrinks the rectangles to the cells through which a path of at most `most` may
   lead.  0: a rectangle has none. */
static int shrink_all(corridor *c, double most, double lowest, double (*low)[2], double (*high)[2])
{
    rectangle *const first = c->r;

    for (size_t i = 0; i < first->size; i++)
        c->G[i] = first->W[i] < HUGE_VAL ? -c->u[i] : HUGE_VAL;
    for (int j = c->q - 1; j >= 0; j--) {
        const rectangle *const here = c->r + j, *const next = j + 1 < c->q ? here + 1 : first;
        step(c, next, c->G, here, c->T);
        for (size_t i = 0; i < here->size; i++) {
            c->G[i] = c->T[i] + here->W[i];
            c->T[i] = here->F[i] + c->G[i];
            if (j == 0 && here->W[i] < HUGE_VAL)
                c->T[i] = larger(c->T[i], c->end[i] - c->u[i]);
        }
        if (!shrink(c, here, most, lowest, low[j], high[j]))
            return 0;
    }
    return 1;
}

/* cv_corridor, once W is known at all nodes.

   Rounding: all numbers are sums of parts of one path's costs, and u's, so none is larger than
   `sum` below.  A cost is off by c = 4u sum: 3u of the square, u of the sum.  So a step along both
   axes loses 50c, to which W adds u sum, and q steps and the few operations on their sums lose less
   than (q + 1) 2^-45 sum, which is (q + 1) 256u sum. */
static int search(corridor *c, double known, double (*low)[2], double (*high)[2], double *least,
                  double (*path)[2])
{
    rectangle *const first = c->r;
    size_t where = 0;
    const double lowest = array_min(first->size, first->W, &where) - first->bend;
    double bend, margin, sum = exclude_cells(c, lowest, &bend);

    if (!(sum < 1e300))
        return CV_EARITHMETIC;
    memset(c->u, 0, first->size * sizeof *c->u);
    *least = forward(c, &where);
    for (size_t i = 0; i < first->size && *least < HUGE_VAL; i++)
        c->u[i] = c->end[i] - *least;
    if (*least < HUGE_VAL)
        *least = forward(c, &where);
    if (*least == HUGE_VAL)
        return CV_OK;
    double largest = 0.0;
    for (size_t i = 0; i < first->size; i++)
        largest = larger(largest, fabs(c->u[i]));
    margin = bend * (1.0 + 0x1p-40) + 0x1p-45 * (c->q + 1) * (sum + largest);
    *least -= margin;
    if (*least <= known) {
        trace_back(c, where, path);
        if (shrink_all(c, known + margin, lowest, low, high))
            return CV_OK;
    }
    *least = HUGE_VAL;
    return CV_OK;
}

/* Arrays of doubles one after the other; without memory they are only counted. */
typedef struct {
    double *memory;
    size_t used;
} arena;

static double *take(arena *a, size_t n)
{
    double *const here = a->memory ? a->memory + a->used : NULL;

    a->used += n;
    return here;
}

/* All arrays of a corridor; returns room for the points of any rectangle. */
static double (*lay_out(corridor *c, const int (*nodes)[2], arena *a))[2]
{
    size_t widest = 0;

    for (int j = 0; j < c->q; j++) {
        const int *const next = nodes[j + 1 < c->q ? j + 1 : 0];
        rectangle *const r = c->r + j;
        for (int axis = 0; axis < 2; axis++) {
            r->nodes[axis] = nodes[j][axis];
            r->at[axis] = take(a, (size_t)nodes[j][axis]);
        }
        r->size = (size_t)r->nodes[0] * (size_t)r->nodes[1];
        r->W = take(a, r->size);
        r->F = take(a, r->size);
        const size_t sizes[] = { r->size, (size_t)r->nodes[0] * (size_t)next[1],
                                 (size_t)next[0] * (size_t)r->nodes[1] };
        for (int k = 0; k < 3; k++)
            widest = sizes[k] > widest ? sizes[k] : widest;
    }
    double **const parts[] = { &c->u, &c->end, &c->G, &c->T, &c->spare };
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        *parts[k] = take(a, widest);
    return (double (*)[2])take(a, 2 * widest);
}

int cv_corridor(const cv_potential *v, int q, double eps, double curvature, const double (*base)[2],
                double known, const int (*nodes)[2], double (*low)[2], double (*high)[2],
                double *least, double (*path)[2])
{
    corridor c = { .q = q, .r = malloc((size_t)q * sizeof *c.r) };
    arena a = { NULL, 0 };
    double (*x)[2] = NULL;
    int status = machine_is_sound() ? CV_OK : CV_EMACHINE;

    for (int j = 0; j < 2 * q; j++)
        if (nodes[j / 2][j % 2] < 1 || nodes[j / 2][j % 2] > MAX_NODES)
            status = CV_EARGUMENT;
    if (status == CV_OK && c.r != NULL) {
        lay_out(&c, nodes, &a);
        a = (arena){ malloc(a.used * sizeof *a.memory), 0 };
        if (a.memory != NULL)
            x = lay_out(&c, nodes, &a);
    }
    if (status == CV_OK && x == NULL)
        status = CV_ENOMEM;
    for (int j = 0; j < q && status == CV_OK; j++)
        status = lay_grid(c.r + j, v, eps, curvature, base[j], low[j], high[j], x);
    if (status == CV_OK)
        status = search(&c, known, low, high, least, path);
    free(c.r);
    free(a.memory);
    return status;
}

/* ---- the torus */

/* One axis of it, as along_axis: `in` is of period 1 there, and y = i/grid - c.  The images of a
   node differ by whole numbers, so the next one to y is the cheapest, and these are among the
   x from -c - 1/2 to -c + 3/2.  back[k][row]: how many pitches lie between k and its origin. */
static void round_axis(int grid, int rows, double c, const double *in, double *out, int *back,
                       double *spare)
{
    const int first = (int)floor(grid * (-c - 0.5)), count = 2 * grid + 3;
    double *const x = spare, *const f = x + count, *const y = f + count;
    const double pitch = grid;

    for (int k = 0; k < grid; k++)
        y[k] = k / pitch - c;
    for (int i = 0; i < count; i++)
        x[i] = (first + i) / pitch;
    for (int row = 0; row < rows; row++) {
        const line l = { x, f, y, out + row, back ? back + row : NULL, rows };
        int at = first % grid + (first % grid < 0 ? grid : 0);
        for (int i = 0; i < count; i++, at = at + 1 < grid ? at + 1 : 0)
            f[i] = in[(size_t)row * (size_t)grid + (size_t)at];
        cheapest(&l, 0, grid, 0, count - 1);
    }
    for (size_t i = 0; back && i < (size_t)grid * (size_t)rows; i++)
        back[i] = (int)(i / (size_t)rows) - (first + back[i]);
}

int cv_lax_oleinik(int n, int grid, const double c[2], const double *W, const double *u,
                   double *out, int (*back)[2])
{
    const size_t side = (size_t)grid, size = n == 2 ? side * side : side;
    double *const sum = malloc(size * sizeof *sum), *const half = malloc(size * sizeof *half),
                  *const spare = malloc((5 * side + 6) * sizeof *spare);
    int *const first = malloc(size * sizeof *first), *const second = malloc(size * sizeof *second);
    int status = CV_ENOMEM;

    if (!machine_is_sound())
        status = CV_EMACHINE;
    else if (sum && half && spare && first && second) {
        status = CV_OK;
        for (size_t i = 0; i < size; i++)
            sum[i] = u[i] + W[i];
        if (n == 1) {
            round_axis(grid, 1, c[0], sum, out, back ? first : NULL, spare);
            for (size_t i = 0; back && i < size; i++) {
                back[i][0] = first[i];
                back[i][1] = 0;
            }
        } else {
            round_axis(grid, grid, c[1], sum, half, back ? first : NULL, spare);
            round_axis(grid, grid, c[0], half, out, back ? second : NULL, spare);
            for (size_t i = 0; back && i < size; i++) {
                const int from = ((int)(i / side) - second[i]) % grid;
                back[i][0] = second[i];
                back[i][1] = first[(i % side) * side + (size_t)(from < 0 ? from + grid : from)];
            }
        }
    }
    free(sum);
    free(half);
    free(spare);
    free(first);
    free(second);
    return status;
}
