/* general_scalar.c - the engine of scalar.c for any waves. */
#define ENGINE general_scalar
#include "scalar.c"
