/* instance.h - an engine: LANES and ENGINE, its name, are defined before, and THESIS_WAVES if it is
   for the waves of the thesis alone. */
#include "waves.h"

#include "orbit.c"
#include "witness.c"
#include "bound.c"
#include "try.c"
