/* engine_avx2.c - prisms by fours, for processors with AVX2. */
#ifdef __x86_64__
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define LANES 4
#define ENGINE engine_4
#include "engine.c"
#ifdef __clang__
#pragma clang attribute pop
#endif
#else
typedef int no_such_engine;            /* a file must not be empty */
#endif
