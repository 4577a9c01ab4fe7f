/* engine_8_1.c - prisms by eights, of one angle. */
#define LANES 8
#define N 1
#include "engine.inc"
