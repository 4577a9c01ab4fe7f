/* scalar.c - prisms one by one, in plain C. */
#define LANES 1
#ifndef ENGINE
#define ENGINE engine_scalar
#endif
#include "instance.h"
