/* general_baseline.c - the engine of baseline.c for any waves. */
#define ENGINE general_baseline
#include "baseline.c"
