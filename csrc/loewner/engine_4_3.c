/* engine_4_3.c - prisms by fours, of three angles. */
#define LANES 4
#define N 3
#include "engine.inc"
