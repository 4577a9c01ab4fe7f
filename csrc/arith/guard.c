/* guard.c - see guard.h.

   GMP's allocation functions belong to the process and must not return NULL.  Ours are malloc's,
   so blocks of others who share the library stay valid; only a thread that armed a guard jumps.
   The number at hand may by then have lost its memory (mpz_mul frees the old before it asks for
   the new), so whoever is jumped to for want of memory must neither use nor free the numbers of its
   state again: they are abandoned. */
#include "guard.h"

#include <gmp.h>
#include <setjmp.h>
#include <stdlib.h>

typedef struct {
    jmp_buf start;
    const stop_request *stop;
} guard;

/* Made with the thread and not at first use, which could itself run out of memory. */
#ifdef __ELF__
static _Thread_local guard *armed __attribute__((tls_model("initial-exec")));
#else
static _Thread_local guard *armed;
#endif

static void *checked(void *p)
{
    if (p == NULL) {
        if (armed == NULL)
            abort();                        /* what GMP itself does */
        longjmp(armed->start, GUARD_MEMORY);
    }
    return p;
}

static void *allocate(size_t n) { return checked(malloc(n)); }
static void release(void *p, size_t n)
{
    (void)n;
    free(p);
}
static void *reallocate(void *p, size_t old, size_t n)
{
    (void)old;
    return checked(realloc(p, n));
}

/* C11 (7.13.1.1) allows setjmp only as the whole of a condition or compared with a constant, and
   keeps only local variables that are volatile or have not changed since. */
int guard_run(void (*work)(void *), void *data, const stop_request *stop)
{
    guard *const before = armed;
    guard mine = { .stop = stop };
    void *(*current)(size_t);
    int ended;

    mp_get_memory_functions(&current, NULL, NULL);
    if (current != allocate)
        mp_set_memory_functions(allocate, reallocate, release);
    armed = &mine;
    switch (setjmp(mine.start)) {
    case 0:
        work(data);
        ended = GUARD_DONE;
        break;
    case GUARD_STOP: ended = GUARD_STOP; break;
    default: ended = GUARD_MEMORY;
    }
    armed = before;
    return ended;
}

void guard_poll(void)
{
    if (armed != NULL && is_to_stop(armed->stop))
        longjmp(armed->start, GUARD_STOP);
}
