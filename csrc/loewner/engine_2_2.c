/* engine_2_2.c - prisms by twos, of two angles. */
#define LANES 2
#define N 2
#include "engine.inc"
