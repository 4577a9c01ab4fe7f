/* scalar.c - prisms one by one, in plain C. */
#define LANES 1
#ifndef ENGINE
#define THESIS_WAVES
#define ENGINE engine_scalar
#endif
#include "instance.h"
