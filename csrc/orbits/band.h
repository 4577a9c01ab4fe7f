/* band.h - symmetric matrices of two rows, and the band of an orbit's Hessian. */
#ifndef CONVERSE_BAND_H
#define CONVERSE_BAND_H

#include "orbits.h"

typedef struct { double a, b, c; } sym;             /* [[a, b], [b, c]] */

static inline sym sym_of(const double m[3]) { return (sym){ m[0], m[1], m[2] }; }

static inline double sym_det(sym m) { return m.a * m.c - m.b * m.b; }

static inline sym sym_inverse(sym m)
{
    const double r = 1.0 / sym_det(m);
    return (sym){ m.c * r, -m.b * r, m.a * r };
}

static inline sym sym_sub(sym m, sym n) { return (sym){ m.a - n.a, m.b - n.b, m.c - n.c }; }

/* How many of its eigenvalues are negative or, unless they are numbers, all. */
static inline int sym_negative(sym m)
{
    const double det = sym_det(m);
    return det > 0.0 ? (m.a > 0.0 ? 0 : 2) : det <= 0.0 ? 1 : 2;
}

#endif
