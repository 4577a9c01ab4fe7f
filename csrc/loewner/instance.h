/* instance.h - an engine: LANES and ENGINE, its name, are defined before, and THESIS_WAVES if it is for
   those of the thesis. */
#include "waves.h"

#include "orbit.c"
#include "witness.c"
#include "bound.c"
#include "try.c"
