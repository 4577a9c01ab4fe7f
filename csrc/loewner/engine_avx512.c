/* engine_avx512.c - prisms by eights, for processors with AVX-512. */
#ifdef __x86_64__
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq")
#endif
#define LANES 8
#define ENGINE engine_8
#include "engine.c"
#ifdef __clang__
#pragma clang attribute pop
#endif
#else
typedef int no_such_engine;            /* a file must not be empty */
#endif
