/* torus.h - how the console looks into csrc/model/torus.c. */
#ifndef KERNELS_TORUS_H
#define KERNELS_TORUS_H

#include "model/torus.h"

/* What torus_largest bounds, over the rectangle low .. high of -v alone. */
double torus_rectangle(int n, const torus_wave waves[], int which, const double low[2],
                       const double high[2]);

#endif
