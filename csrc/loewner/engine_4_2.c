/* engine_4_2.c - prisms by fours, of two angles. */
#define LANES 4
#define N 2
#include "engine.inc"
