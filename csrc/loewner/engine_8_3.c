/* engine_8_3.c - prisms by eights, of three angles. */
#define LANES 8
#define N 3
#include "engine.inc"
