/* memory.h - running out of memory is an error code, also inside GMP, which would abort. */
#ifndef CONVERSE_MEMORY_H
#define CONVERSE_MEMORY_H

#include <setjmp.h>

/* Makes GMP's allocator jump to `here` (set with setjmp) when this thread runs out of memory;
   NULL: back to GMP's own behaviour.  Returns the place that was armed before. */
jmp_buf *memory_guard(jmp_buf *here);

#endif
