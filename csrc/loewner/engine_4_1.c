/* engine_4_1.c - prisms by fours, of one angle. */
#define LANES 4
#define N 1
#include "engine.inc"
