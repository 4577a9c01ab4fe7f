/* instance.h - an engine: LANES and ENGINE, its name, are defined before, and GENERAL if it is for any
   waves. */
#include "prism.h"
#ifdef GENERAL
#include "general.h"
#else
#include "three.h"
#endif

#include "orbit.c"
#include "witness.c"
#include "bound.c"
#include "try.c"
