/* guard.h - a computation can be ended from within: when memory runs out, which would make GMP
   abort, and when somebody asks it to stop. */
#ifndef CONVERSE_GUARD_H
#define CONVERSE_GUARD_H

#include <stdatomic.h>
#include <stddef.h>

/* A request to stop, that any thread may make and a poll sees.  It says nothing of other data, so
   no order of memory is asked for. */
typedef struct { atomic_int asked; } stop_request;

static inline void ask_to_stop(stop_request *stop, int asked)
{
    atomic_store_explicit(&stop->asked, asked, memory_order_relaxed);
}

/* Was it asked for?  Not if stop is NULL. */
static inline int is_to_stop(const stop_request *stop)
{
    return stop != NULL && atomic_load_explicit(&stop->asked, memory_order_relaxed);
}

enum { GUARD_DONE, GUARD_MEMORY, GUARD_STOP };

/* Calls work(data).  GUARD_DONE: it returned.  GUARD_MEMORY: GMP ran out of memory in it.
   GUARD_STOP: a poll in it found stop set, by work or by another thread; stop may be NULL.  In the
   last two cases work was left where it was, and data holds what it had stored there by then. */
int guard_run(void (*work)(void *data), void *data, const stop_request *stop);

/* To be called now and then in every loop that may last, where all numbers are whole: after a
   stop they may be used again, but what local ones held is lost until the process ends. */
void guard_poll(void);

#endif
