/* guard.h - a computation can be ended from within: when memory runs out, which would make GMP
   abort, and when somebody asks it to stop. */
#ifndef CONVERSE_GUARD_H
#define CONVERSE_GUARD_H

#include <setjmp.h>
#include <stddef.h>

/* setjmp(g.here) returns one of these after a jump; 0 before it. */
enum { GUARD_MEMORY = 1, GUARD_STOP = 2 };

typedef struct {
    jmp_buf here;
    const volatile int *stop;           /* set by another thread; NULL: nobody asks */
} guard;

/* Makes this thread jump to g->here, set with setjmp, when GMP runs out of memory or a poll finds
   *g->stop set; NULL: back to GMP's own behaviour.  Returns the guard that was armed before. */
guard *guard_arm(guard *g);

/* To be called now and then in every loop that may last, where all numbers are whole: after a
   stop they may be used again, but what local ones held is lost until the process ends. */
void guard_poll(void);

#endif
