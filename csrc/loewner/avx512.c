/* avx512.c - prisms by eights, for processors with AVX-512. */
#if defined(__GNUC__) && defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq")
#endif
#define LANES 8
#ifndef ENGINE
#define THESIS_WAVES
#define ENGINE engine_avx512
#endif
#include "instance.h"
#ifdef __clang__
#pragma clang attribute pop
#endif
#else
typedef int no_such_engine;            /* a file must not be empty */
#endif
