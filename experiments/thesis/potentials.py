"""The two potentials of the thesis's chapter 2 that are no Fourier sums, poly and ff: polynomials
between junctions, evaluated by NumPy and, for proofs, in balls of python-flint."""

import math
from dataclasses import dataclass

import numpy as np

from converse.orbits.potential import Potential, points


def _modulo(base, u):
    """The point in [0, 1)^n, exactly."""
    from converse.orbits.enclosure import exact
    x = [i + exact(j) for i, j in zip(base, u)]
    return [i - i.floor() for i in x]


@dataclass(frozen=True, repr=False)
class Poly(Potential):
    """V = -4096 f(y0) g(y1), y = x mod 1 - 1/2.  With a = 1/4 - y^2, from 0 to 1/4,
    f = a^2 (a - 3/16), f' = -6 y a (a - 1/8), f'' = -30 a^2 + 33 a/4 - 3/8, f''' = 2 y (60 a -
    33/4); g = a^2, g' = -4 y a, g'' = 2 - 12 a, g''' = 24 y.

    Derivatives 0 to 3 are at most 1/256, 0.022, 3/8, 33/4 and 1/16, 0.1925, 2, 12.  The norm of V''
    is at most its larger diagonal entry and |V_01|.  Of the third derivative along a unit vector v
    the terms with v0^3 and v1^3 make at most the larger one, and v0^2 v1 and v0 v1^2, three times
    each, are at most 0.385."""

    formula = ("-4096 a^2 (a - 3/16) b^2, a = 1/4 - (x0 mod 1 - 1/2)^2, "
               "b = 1/4 - (x1 mod 1 - 1/2)^2")
    curvature = 4096 * (3 / 8 / 16 + 0.022 * 0.1925)
    lipschitz = 4096 * (33 / 4 / 16 + 3 * 0.385 * (3 / 8 * 0.1925 + 0.022 * 2))

    def evaluate(self, x):
        y0, y1 = (points(x, 2) % 1.0 - 0.5).T
        s, t = y0 * y0, y1 * y1             # near the edges, where V is flat, nothing is lost
        a, b, e = 0.25 - s, 0.0625 - s, 0.25 - t
        slope, bend = -a * (2 * b + a), 2 * b + 4 * a       # of f by s
        f = a * a * b, 2 * y0 * slope, 2 * slope + 4 * s * bend
        g = e * e, -4 * y1 * e, -4 * e + 8 * t
        v01 = f[1] * g[1]
        return (-4096 * f[0] * g[0], -4096 * np.stack([f[1] * g[0], f[0] * g[1]], -1),
                -4096 * np.stack([f[2] * g[0], v01, v01, f[0] * g[2]], -1).reshape(-1, 2, 2))

    def law(self, base, u):
        from flint import arb, fmpq
        x = _modulo(base, u)
        y0, y1 = (arb(i - fmpq(1, 2)) for i in x)
        a, b = (arb(i * (1 - i)) for i in x)
        f = a * a * (a - arb(3) / 16)
        f1, f2 = -6 * y0 * a * (a - arb(1) / 8), (33 * a - 120 * a * a) / 4 - arb(3) / 8
        g, g1, g2 = b * b, -4 * y1 * b, 2 - 12 * b
        return [-4096 * i for i in (f * g, f1 * g, f * g1, f2 * g, f1 * g1, f * g2)]


@dataclass(frozen=True, repr=False)
class FastFroeschle(Potential):
    """V = -(c(x0) + c(x1))/4 - c(x0 + x1)/2, c = 1 - 24 y^2 + 32 y^3, y the distance to the nearest
    integer: a cubic spline that stands for cos 2 pi x.

    |c''| <= 48, |c'''| = 192.  V'' is diag(c''(x0), c''(x1))/4, of norm 12 at most, and
    c''(x0 + x1)/2 times [[1, 1], [1, 1]], whose norm is 2; x0 + x1 moves by sqrt 2 |dx| at most:
    12 + 48, and 48 + 96 2 sqrt 2 < 320."""

    formula = ("-(c(x0) + c(x1))/4 - c(x0 + x1)/2, c(x) = 1 - 24 y^2 + 32 y^3, "
               "y the distance from x to the nearest integer")
    curvature, lipschitz = 60.0, 320.0

    def evaluate(self, x):
        x = points(x, 2)
        turn = np.stack([*x.T, x.sum(1)]) % 1.0
        sign, y = np.where(turn > 0.5, -1.0, 1.0), np.where(turn > 0.5, 1.0 - turn, turn)
        value, slope, bend = (1 + y * y * (32 * y - 24), sign * y * (96 * y - 48), 192 * y - 48)
        v01 = -0.5 * bend[2]
        return (-0.25 * (value[0] + value[1]) - 0.5 * value[2],
                (-0.25 * slope[:2] - 0.5 * slope[2]).T,
                np.stack([v01 - 0.25 * bend[0], v01, v01, v01 - 0.25 * bend[1]], -1).reshape(
                    -1, 2, 2))

    def law(self, base, u):
        """Which integer is the nearest is told exactly."""
        from flint import arb, fmpq

        def c(z):
            z -= z.floor()
            sign, y = (1, arb(z)) if z <= fmpq(1, 2) else (-1, arb(1 - z))
            return 1 + y * y * (32 * y - 24), sign * y * (96 * y - 48), 192 * y - 48

        x = _modulo(base, u)
        (v0, d0, b0), (v1, d1, b1), (v, d, b) = c(x[0]), c(x[1]), c(x[0] + x[1])
        return [i / -4 for i in (v0 + v1 + 2 * v, d0 + 2 * d, d1 + 2 * d,
                                 b0 + 2 * b, 2 * b, b1 + 2 * b)]


# V = 1/4 at the start of poly, 27/49 at ff's.
poly = Poly("poly", ((2 - math.sqrt(2)) / 4, 0.5))
ff = FastFroeschle("ff", (2 / 7, 2 / 7))
