/* guard.h - a computation can be ended from within: when memory runs out, which would make GMP
   abort, and when somebody asks it to stop. */
#ifndef CONVERSE_GUARD_H
#define CONVERSE_GUARD_H

#include <stdatomic.h>

/* A request to stop, that any thread may make and a poll sees.  It says nothing of other data, so
   no order of memory is asked for.  Python has it as an opaque handle (converse.h). */
typedef struct cv_stop { atomic_int asked; } cv_stop;

cv_stop *cv_stop_new(void);             /* not asked for yet; NULL: no memory */
void cv_stop_free(cv_stop *stop);
void cv_stop_set(cv_stop *stop);
int cv_stop_get(const cv_stop *stop);   /* was it asked for?  Not if stop is NULL */

enum { GUARD_DONE, GUARD_MEMORY, GUARD_STOP };

/* Calls work(data).  GUARD_DONE: it returned.  GUARD_MEMORY: GMP ran out of memory in it.
   GUARD_STOP: a poll in it found stop set, by work or by another thread; stop may be NULL.  In the
   last two cases work was left where it was, and data holds what it had stored there by then. */
int guard_run(void (*work)(void *data), void *data, const cv_stop *stop);

/* To be called now and then in every loop that may last, where all numbers are whole: after a
   stop they may be used again, but what local ones held is lost until the process ends. */
void guard_poll(void);

#endif
