/* lookahead.c - prisms are tried several at a time, some of them before their turn.

   A method may be quickest with several prisms at a time (method.h: lanes).  So the first of those
   pending are tried together, and the outcomes are noted.  The halves of a prism that was cut are
   also noted, and may be tried with the prisms that follow.  A prism counts only when its turn
   comes in preorder.  Since no outcome depends on other prisms, the tree is the same as with one
   prism at a time. */
#include <stdlib.h>

#include "search/search.h"

int make_room_for_notes(cv_search *s)
{
    if (s->n_notes + s->pending + 2 * MOST_LANES > s->allocated_notes) {
        const int allocated = 2 * s->allocated_notes + s->pending + 64;
        note *const notes = realloc(s->notes, (size_t)allocated * sizeof *notes);
        if (notes == NULL)
            return CV_ENOMEM;
        s->notes = notes;
        s->allocated_notes = allocated;
    }
    return CV_OK;
}

static int new_note(cv_search *s, const cv_cell *cell)
{
    const int id = s->free_note >= 0 ? s->free_note : s->n_notes++;
    note *const n = &s->notes[id];

    if (id == s->free_note)
        s->free_note = n->halves[0];
    *n = (note){ .cell = *cell, .halves = { -1, -1 } };
    return id;
}

/* Adds a prism and those it was cut into to the list, in preorder, if their outcomes are not known.
   Returns whether all are known. */
static int list_unknown(cv_search *s, int id, int list[], int *n, int most)
{
    note *const p = &s->notes[id];

    if (p->settled)
        return 1;
    if (!p->known)
        p->known = p->skipped = may_skip(s, &p->cell);
    p->settled = p->known;
    if (!p->known)
        list[(*n)++] = id;
    for (int k = 0; k < 2 && p->halves[k] >= 0; k++)
        p->settled &= *n < most && list_unknown(s, p->halves[k], list, n, most);
    return p->settled;
}

/* Tries the first prisms in line, as many as the method takes together.  The note of a try that is
   broken off is as if the try had not begun.  CV_OK or CV_ENOMEM. */
static int look_ahead(cv_search *s)
{
    const int lanes = s->method->lanes(s->work);
    const cv_cell *cells[MOST_LANES];
    outcome *out[MOST_LANES];
    int list[MOST_LANES], n = 0, status = CV_OK;

    for (int j = s->pending - 1; j >= 0 && n < lanes; j--) {
        if (s->stack[j].note < 0)
            s->stack[j].note = new_note(s, &s->stack[j].cell);
        list_unknown(s, s->stack[j].note, list, &n, lanes);
    }
    for (int k = 0; k < n; k++) {
        cells[k] = &s->notes[list[k]].cell;
        out[k] = &s->notes[list[k]].outcome;
    }
    if (n > 0)
        status = s->method->try(s->work, n, cells, out);
    for (int k = 0; k < n && status == CV_OK; k++) {
        note *const p = &s->notes[list[k]];
        const int axis = p->outcome.axis;
        p->known = 1;
        if (!p->outcome.v.no_tori && axis >= 0 && may_halve(s, &p->cell, axis)) {
            cv_cell upper = p->cell, lower;
            upper.hint = p->outcome.hint;
            split_cell(&upper, axis, &lower);
            p->halves[0] = new_note(s, &lower);
            p->halves[1] = new_note(s, &upper);
        }
    }
    return status;
}

const note *note_on_top(cv_search *s)
{
    const int *const id = &s->stack[s->pending - 1].note;

    if ((*id < 0 || !s->notes[*id].known) && look_ahead(s) != CV_OK)
        return NULL;
    return &s->notes[*id];
}

void forget_note(cv_search *s, const note *n)
{
    const int id = (int)(n - s->notes);

    s->notes[id].halves[0] = s->free_note;
    s->free_note = id;
}

void forget_all_notes(cv_search *s)
{
    s->n_notes = 0;
    s->free_note = -1;
}
