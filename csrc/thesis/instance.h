/* instance.h - the whole of the program's algorithms, in the order of their dependence.
   Included once by each instance. */
#include "state.h"

#include "bounding.c"
#include "bd_trig.c"
#include "map.c"
#include "row_sums.c"
#include "trace.c"
#include "lambda.c"
#include "lipschitz.c"
#include "ff_fatten.c"
#include "ff_rows.c"
#include "gauss.c"
#include "cr_fatten.c"
#include "cr_rows.c"
#include "prismatic.c"
#include "follow.c"
#include "unit.c"
