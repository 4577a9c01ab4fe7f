/* general_scalar.c - the engine of scalar.c for any waves. */
#define GENERAL
#define ENGINE general_scalar
#include "scalar.c"
