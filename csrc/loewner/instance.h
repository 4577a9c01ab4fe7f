/* instance.h - an engine: LANES and ENGINE, its name, are defined before. */
#include "prism.h"

#include "orbit.c"
#include "witness.c"
#include "bound.c"
#include "try.c"
