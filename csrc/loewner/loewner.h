/* loewner.h - the sharper criterion: prisms, in doubles with proved rounding. */
#ifndef CONVERSE_LOEWNER_H
#define CONVERSE_LOEWNER_H

#include <stddef.h>

#include "converse.h"
#include "thesis/unit.h"

typedef struct loewner loewner;

enum { MOST_LANES = 8, MOST_WAVES = 16, SLOTS = MOST_WAVES + 2, PARAMETERS = 3 };

/* cv_problem as numbers; phases in radians, which may be off by 10^-39. */
typedef struct {
    int n_waves, n_parameters, k[MOST_WAVES][2], frame[4], odd;
    apm_t phase[MOST_WAVES], amplitude[MOST_WAVES], part[MOST_WAVES][PARAMETERS];
    apm_t angle[2], half[2], xstar[2];
} patch;

int is_identity(const int frame[4]);

/* Are these the thesis's waves, in its order and without phases? */
int thesis_waves(const patch *problem);

/* For a problem with its angles in radians, too, and x* chosen.  with_bounds: those over the torus, without
   which nothing can be proved.  NULL: no memory. */
loewner *loewner_new(const patch *problem, int with_bounds);
void loewner_free(loewner *w);

/* What became of a cell: was it proved, and if not, the axis to cut it across, or -1 if it is too
   fine for doubles already, and what the halves should know: fewer points of the orbit than `from`
   will hardly do.  Reason CV_REASON_ARITHMETIC: it is the doubles that failed. */
typedef struct { verdict v; int axis, from; } loewner_outcome;

/* How many cells are best tried at once, and at most: MOST_LANES or fewer. */
int loewner_lanes(const loewner *w);

/* Is it impossible that a minimizing orbit leads from x* to these cells?  What becomes of a cell
   depends on itself and on cell->from, what its parent learnt, and on no other cell.  (from decides
   at which lengths the orbit is tried, not whether a try that succeeds is right.) */
void loewner_try(loewner *w, int n, const cv_cell *const cells[], loewner_outcome *const out[]);

/* Is the least eigenvalue of beta below 2/3 at x, for all parameters or, at_end, where they are all
   1?  Then, if V is odd, no multiple s >= 1 of these amplitudes allows a torus. */
int loewner_at_once(const loewner *w, const double x[2], int at_end);

/* The upper bound of the largest eigenvalue over the torus that belongs to the whole root. */
double loewner_largest(const loewner *w);

/* The prism of a cell as doubles have it.  0: it is too thin for them, or its parameters are too
   large. */
typedef struct {
    double v[2], width[2], p[SLOTS], part[SLOTS][PARAMETERS], loose[SLOTS], l;
} loewner_cell;
int loewner_prism(const loewner *w, const cv_cell *cell, loewner_cell *c);

#endif
