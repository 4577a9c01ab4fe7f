/* double.c - the algorithms in double precision: the quick filter, which proves nothing. */
#define NUM_DOUBLE
#include "instance.h"
