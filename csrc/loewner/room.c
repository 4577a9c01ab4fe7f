/* room.c - the points of the orbits, allocated as these grow.

   The points stand in one array, which is copied when it doubles, at the end where room is wanted.
   What depends on the number of waves and columns stands apart and stays where it is. */
#include "prism.h"

enum { WAVE_VECTORS = 12 };             /* of a point for each slot */

static size_t vectors_of(const loewner *problem)
{
    const size_t columns = (size_t)problem->columns;

    return N * columns * (columns + 3) / 2 + WAVE_VECTORS * (size_t)problem->waves;
}

static void *aligned(char *memory) { return memory + (ALIGNMENT - (uintptr_t)memory % ALIGNMENT); }

/* Gives a point its vectors. */
static void lay_out(const loewner *problem, point *q, vec *next)
{
    const int columns = problem->columns, pairs = columns * (columns + 1) / 2;
    vec **const of_slots[WAVE_VECTORS] = { &q->sine,       &q->cosine,       &q->lin_bound,
                                           &q->quad_bound, &q->nonlin_bound, &q->rad,
                                           &q->err_dot,    &q->rest_A[0],    &q->rest_A[1],
                                           &q->rest_B,     &q->cube_A,       &q->cube_B };

    q->lin = (vec(*)[N])next;
    q->quad = q->lin + columns;
    next = q->quad[pairs];
    for (int j = 0; j < WAVE_VECTORS; j++, next += problem->waves)
        *of_slots[j] = next;
}

/* All numbers of a point become zero. */
static void clear(const batch *w, point *q)
{
    memset(q->lin, 0, vectors_of(w->problem) * sizeof(vec));
    memset(q->x, 0, sizeof *q - offsetof(point, x));
}

/* Twice as much room, downwards or upwards.  0: out of memory. */
static int double_room(batch *w, int down)
{
    const int added = w->room == 0 ? FIRST_ROOM : w->room, room = w->room + added;
    const size_t count = vectors_of(w->problem);
    const int below = down ? added : 0, first = down ? 0 : w->room;     /* of the new ones */
    char *const memory = calloc(1, (size_t)room * sizeof(point) + ALIGNMENT);
    char *const vectors = calloc(1, (size_t)added * count * sizeof(vec) + ALIGNMENT);

    if (memory == NULL || vectors == NULL || w->doublings == MAX_DOUBLINGS) {
        free(memory);
        free(vectors);
        return 0;
    }
    point *const points = aligned(memory);
    if (w->room > 0)
        memcpy(points + below, w->points, (size_t)w->room * sizeof *points);
    for (int j = 0; j < added; j++)
        lay_out(w->problem, points + first + j, (vec *)aligned(vectors) + (size_t)j * count);
    free(w->memory);
    w->memory = memory;
    w->vectors[w->doublings++] = vectors;
    w->points = points;
    w->lowest = w->room == 0 ? ORIGIN - FIRST_ROOM / 2 : w->lowest - below;
    w->room = room;
    return 1;
}

/* Room for the site and its neighbours; pointers to points do not outlive this.  0: out of
   memory. */
static int make_room(batch *w, int site)
{
    while (w->room == 0 || site <= w->lowest || site + 1 >= w->lowest + w->room)
        if (!double_room(w, w->room > 0 && site <= w->lowest)) {
            w->out_of_memory = 1;
            return 0;
        }
    return 1;
}

static void free_room(void *work)
{
    batch *const w = work;

    free(w->memory);
    for (int j = 0; j < w->doublings; j++)
        free(w->vectors[j]);
}
