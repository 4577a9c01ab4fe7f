/* baseline.c - prisms by twos, for processors whose every model has vectors of two doubles. */
#if defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define LANES 2
#ifndef ENGINE
#define THESIS_WAVES
#define ENGINE engine_baseline
#endif
#include "instance.h"
#else
typedef int no_such_engine;            /* a file must not be empty */
#endif
