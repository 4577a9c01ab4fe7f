/* instance.h - the whole of the program's algorithms, in the order of their dependence.
   Included once by each instance, so they are .inc files, not translation units. */
#include "state.h"

#include "bounding.inc"
#include "bd_trig.inc"
#include "map.inc"
#include "row_sums.inc"
#include "trace.inc"
#include "lambda.inc"
#include "lipschitz.inc"
#include "ff_fatten.inc"
#include "ff_rows.inc"
#include "gauss.inc"
#include "cr_fatten.inc"
#include "cr_rows.inc"
#include "prismatic.inc"
#include "follow.inc"
#include "unit.inc"
