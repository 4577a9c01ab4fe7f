/* general_baseline.c - the engine of baseline.c for any waves. */
#define GENERAL
#define ENGINE general_baseline
#include "baseline.c"
