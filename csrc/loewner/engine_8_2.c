/* engine_8_2.c - prisms by eights, of two angles. */
#define LANES 8
#define N 2
#include "engine.inc"
