/* guard.c - see guard.h.

   GMP's allocation functions belong to the process and must not return NULL.  Ours are malloc's,
   so blocks of others who share the library stay valid; only a thread that armed a guard jumps.
   The number at hand may by then have lost its memory (mpz_mul frees the old before it asks for
   the new), so whoever is jumped to for want of memory must neither use nor free the numbers of its
   state again: they are abandoned. */
#include "guard.h"

#include <gmp.h>
#include <stdlib.h>

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
        longjmp(armed->here, GUARD_MEMORY);
    }
    return p;
}

static void *allocate(size_t n) { return checked(malloc(n)); }
static void release(void *p, size_t n) { (void)n; free(p); }
static void *reallocate(void *p, size_t old, size_t n)
{
    (void)old;
    return checked(realloc(p, n));
}

guard *guard_arm(guard *g)
{
    guard *const before = armed;
    void *(*current)(size_t);

    mp_get_memory_functions(&current, NULL, NULL);
    if (current != allocate)
        mp_set_memory_functions(allocate, reallocate, release);
    armed = g;
    return before;
}

void guard_poll(void)
{
    if (armed != NULL && armed->stop != NULL && *armed->stop)
        longjmp(armed->here, GUARD_STOP);
}
