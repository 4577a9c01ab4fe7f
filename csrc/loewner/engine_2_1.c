/* engine_2_1.c - prisms by twos, of one angle. */
#define LANES 2
#define N 1
#include "engine.inc"
