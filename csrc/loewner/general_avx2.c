/* general_avx2.c - the engine of avx2.c for any waves. */
#define ENGINE general_avx2
#include "avx2.c"
