"""The truth the kernels are held against: the map, its second variation and random boxes, with
mpmath at many more digits, sharing nothing with the C core."""

import math
import operator
import os
import random
from fractions import Fraction

import mpmath


class Share(Fraction):
    """A part of the random cases: of ten a third is four."""

    def __rmul__(self, cases):
        part = super().__rmul__(cases)
        return math.ceil(part) if isinstance(cases, int) else part


def _times(text):
    return int(text) if text.isdigit() else Share(text)


# Multiplies the number of random cases: make torture by 100, make check by 1/3.
TORTURE = _times(os.environ.get("CONVERSE_TORTURE", "1"))
# make sanitize: each case takes ten times as long, and is to execute code rather than find numbers
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")
# sys.setprofile(strike): SIGTERM where Python waits for a result and has just given up the lock of
# the condition; an exception there has it released twice, which is a RuntimeError
STRIKE = """
import os, signal, sys
def strike(frame, event, arg):
    if (event, getattr(arg, "__name__", "")) == ("c_return", "_release_save") or \\
            (event, frame.f_code.co_name) == ("return", "_release_save"):
        while frame and frame.f_code.co_name not in ("submit", "start"):
            frame = frame.f_back
        if not frame:                           # no thread is being begun
            sys.setprofile(None)
            os.kill(os.getpid(), signal.SIGTERM)
"""
DIGITS = 80                     # of mpmath, where the kernels have 35 or 40
CLOSE = Fraction(1, 10**60)     # what an error at DIGITS digits may come to


def mp(x):
    """An exact number as an mpmath number (at the working precision)."""
    x = Fraction(x)
    return mpmath.mpf(x.numerator) / x.denominator


def exact(x):
    """An mpmath number as a Fraction."""
    sign, mantissa, exponent, _ = mpmath.mpf(x)._mpf_
    return (-1)**sign * Fraction(int(mantissa)) * Fraction(2)**exponent


def uniform(rng, low, high, digits=20):
    """A random finite decimal between two exact numbers."""
    low, high = Fraction(low), Fraction(high)
    t = Fraction(rng.randrange(10**digits + 1), 10**digits)
    return low + t * (high - low)


def decimal(x, dp=60):
    """x cut to dp places, so that it can be handed to the core."""
    return Fraction(int(Fraction(x) * 10**dp), 10**dp)


def cube_point(rng):
    """A point of [-1, 1]^7: a corner, an edge, or anywhere."""
    kind = rng.randrange(3)
    if kind == 0:
        return [Fraction(rng.choice((-1, 1))) for _ in range(7)]
    if kind == 1:
        return [Fraction(rng.choice((-1, 0, 1))) for _ in range(7)]
    return [uniform(rng, -1, 1, 8) for _ in range(7)]


def point_of(prism, eta):
    """centre + matrix eta, exactly."""
    centre, matrix = prism
    return [sum((m * e for m, e in zip(row, eta) if m), c) for c, row in zip(centre, matrix)]


def step(x):
    """G at x = (a, b, c, u0, u1, v0, v1), to DIGITS digits, as Fractions."""
    with mpmath.workdps(DIGITS):
        a, b, c, u0, u1, v0, v1 = map(mp, x)
        mixed = c * mpmath.cos(v0 + v1)
        w0 = 2 * v0 - u0 + a * mpmath.cos(v0) + mixed
        w1 = 2 * v1 - u1 + b * mpmath.cos(v1) + mixed
        return list(x[:3]) + list(x[5:]) + [exact(w0), exact(w1)]


def beta(a, b, c, v0, v1):
    """2I - V'' as three mpmath numbers (00, 01, 11)."""
    mixed = c * mpmath.sin(v0 + v1)
    return 2 - a * mpmath.sin(v0) - mixed, -mixed, 2 - b * mpmath.sin(v1) - mixed


def eigenvalues(m):
    """Least and largest eigenvalue of a symmetric 2 x 2 matrix (00, 01, 11)."""
    half, root = (m[0] + m[2]) / 2, mpmath.sqrt(((m[0] - m[2]) / 2)**2 + m[1]**2)
    return half - root, half + root


def inverse(m):
    """The inverse of a symmetric 2 x 2 matrix."""
    det = m[0] * m[2] - m[1]**2
    return m[2] / det, -m[1] / det, m[0] / det


def cube_of(prism):
    """The function that finds eta with centre + matrix eta = x; p columns without width get 0."""
    centre, matrix = prism
    with mpmath.workdps(DIGITS + 20):
        entries = [[mp(x) for x in row] for row in matrix]
        corner = (mpmath.matrix([row[3:] for row in entries[3:]]) ** -1).tolist()

    def coordinates(x):
        with mpmath.workdps(DIGITS):
            eta = []
            for j in range(3):
                assert matrix[j][j] != 0 or x[j] == centre[j]
                eta.append(mp((x[j] - centre[j]) / matrix[j][j]) if matrix[j][j] else mp(0))
            rest = [mp(x[j] - centre[j]) - sum(entries[j][k] * eta[k] for k in range(3))
                    for j in range(3, 7)]
            return eta + [sum(map(operator.mul, row, rest)) for row in corner]

    return coordinates


def list_prism(rng, largest="0.5", parameters=(-1, 1)):
    """A random prism of the list: parameters x {x*} x successors."""
    width = Fraction(largest) * Fraction(1, 10**rng.randrange(0, 7))
    centre = [decimal(uniform(rng, *parameters)) for _ in range(3)]
    centre += [decimal(uniform(rng, -7, 7)) for _ in range(4)]
    half = [decimal(uniform(rng, 0, "0.01")) * rng.choice((0, 1, 1)) for _ in range(3)]
    half += [0, 0] + [decimal(width * rng.randrange(1, 10) / 10) * rng.choice((0, 1, 1, 1, 1))
                      for _ in range(2)]
    return centre, [[Fraction(half[j]) if j == k else Fraction(0) for k in range(7)]
                    for j in range(7)]


def rng_for(name):
    """Reproducible random numbers, different for every test."""
    return random.Random(name)
