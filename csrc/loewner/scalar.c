/* scalar.c - prisms one by one, in plain C. */
#define LANES 1
#define ENGINE engine_scalar
#include "instance.h"
