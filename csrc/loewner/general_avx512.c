/* general_avx512.c - the engine of avx512.c for any waves. */
#define ENGINE general_avx512
#include "avx512.c"
