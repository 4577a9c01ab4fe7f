/* memory.c - see memory.h.

   GMP's allocation functions belong to the process and must not return NULL.  Ours are malloc's,
   so blocks of others who share the library stay valid; only a thread that armed a guard jumps.
   What GMP held in temporaries at that moment leaks; the numbers themselves stay whole, as a
   failed realloc leaves its block alone. */
#include "memory.h"

#include <gmp.h>
#include <stdlib.h>

static _Thread_local jmp_buf *armed;

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
