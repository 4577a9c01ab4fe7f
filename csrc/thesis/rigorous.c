/* rigorous.c - the algorithms with exact decimals: what the theorem rests on. */
#include "instance.h"
