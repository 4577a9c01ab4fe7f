/* engine_2_3.c - prisms by twos, of three angles. */
#define LANES 2
#define N 3
#include "engine.inc"
