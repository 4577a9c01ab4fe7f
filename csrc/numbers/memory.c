/* memory.c - see memory.h.

   GMP's allocation functions belong to the process and must not return NULL.  Ours are malloc's,
   so blocks of others who share the library stay valid; only a thread that armed a guard jumps.
   The number at hand may by then have lost its memory (mpz_mul frees the old before it asks for
   the new), so whoever is jumped to must neither use nor free the numbers of its state again:
   they are abandoned. */
#include "memory.h"

#include <gmp.h>
#include <stdlib.h>

/* Made with the thread and not at first use, which could itself run out of memory. */
#ifdef __ELF__
static _Thread_local jmp_buf *armed __attribute__((tls_model("initial-exec")));
#else
static _Thread_local jmp_buf *armed;
#endif

static void *checked(void *p)
{
    if (p == NULL) {
        if (armed == NULL)
            abort();                        /* what GMP itself does */
        longjmp(*armed, 1);
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

jmp_buf *memory_guard(jmp_buf *here)
{
    jmp_buf *const before = armed;
    void *(*current)(size_t);

    mp_get_memory_functions(&current, NULL, NULL);
    if (current != allocate)
        mp_set_memory_functions(allocate, reallocate, release);
    armed = here;
    return before;
}
