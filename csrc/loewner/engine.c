/* engine.c - prisms by twos: vectors of two doubles, which every processor has or is given. */
#ifndef LANES
#define LANES 2
#define ENGINE engine_2
#endif
#include "waves.h"

#include "room.c"
#include "orbit.c"
#include "witness.c"
#include "bound.c"
#include "try.c"
