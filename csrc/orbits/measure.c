/* measure.c - the closest pairs of an orbit's points. */
#include <math.h>
#include <stdlib.h>

#include "orbits/potential.h"

enum { ASK = 1 << 18 };                 /* pairs looked at before Ctrl-C is looked for */

typedef struct {
    double square;
    long i, j;
} pair;
typedef struct {
    double x[2];
    long index;
} site;

static int by_x0(const void *a, const void *b)
{
    const double x = ((const site *)a)->x[0], y = ((const site *)b)->x[0];
    return (x > y) - (x < y);
}

static int by_distance(const void *a, const void *b)
{
    const double x = ((const pair *)a)->square, y = ((const pair *)b)->square;
    return (x > y) - (x < y);
}

/* No pair of the heap is narrower than the two below it, heap[2k + 1] and heap[2k + 2]; what was
   put at k sinks to its place. */
static void sink(pair *heap, long count, long k)
{
    for (long child; (child = 2 * k + 1) < count; k = child) {
        const pair above = heap[k];
        if (child + 1 < count && heap[child + 1].square > heap[child].square)
            child++;
        if (heap[child].square <= above.square)
            return;
        heap[k] = heap[child];
        heap[child] = above;
    }
}

/* In the order of x0 the partners of a point are looked for to its right, round the torus, as far
   as the widest of the pairs kept so far; each pair is met once, from its left end. */
long cv_pairs(int n, long q, const double (*x)[2], long count, long *i, long *j, double *distance)
{
    site *const sites = malloc((size_t)q * sizeof *sites);
    pair *const heap = malloc((size_t)(count > 0 ? count : 1) * sizeof *heap);
    long kept = 0, looked = 0;

    if (!sites || !heap) {
        free(sites);
        free(heap);
        return CV_ENOMEM;
    }
    for (long k = 0; k < q; k++)
        sites[k] =
            (site){ { x[k][0] - floor(x[k][0]), n == 2 ? x[k][1] - floor(x[k][1]) : 0.0 }, k };
    qsort(sites, (size_t)q, sizeof *sites, by_x0);
    for (long a = 0; a < q && count > 0; a++)
        for (long step = 1; step < q; step++) {
            const site *const left = &sites[a], *const right = &sites[(a + step) % q];
            if (++looked % ASK == 0 && cv_python_interrupts()) {
                free(sites);
                free(heap);
                return CV_ESTOPPED;
            }
            const double across = right->x[0] - left->x[0] + (a + step >= q ? 1.0 : 0.0);
            const double up = fabs(right->x[1] - left->x[1]), up1 = fmin(up, 1.0 - up);
            const double square = across * across + up1 * up1;
            if (across > 0.5 || (across == 0.5 && left->index > right->index) ||
                (kept == count && across * across >= heap[0].square))
                break;
            if (kept == count && square >= heap[0].square)
                continue;
            if (kept < count) {
                heap[kept++] = (pair){ square, left->index, right->index };
                for (long k = kept == count ? count / 2 : 0; k-- > 0;)
                    sink(heap, count, k);
            } else {
                heap[0] = (pair){ square, left->index, right->index };
                sink(heap, count, 0);
            }
        }
    qsort(heap, (size_t)kept, sizeof *heap, by_distance);
    for (long k = 0; k < kept; k++) {
        i[k] = heap[k].i;
        j[k] = heap[k].j;
        distance[k] = sqrt(heap[k].square);
    }
    free(sites);
    free(heap);
    return kept;
}
