/* interval.h - intervals of doubles whose ends move outwards after every operation.

   Contract.  An interval stands for all real numbers x with low <= x <= high; an end may be
   infinite.  Each operation's result holds the operation's value for all members of its operands.
   An end that is not known, since it would be NaN or overflows, is infinite: at worst the result is
   the whole line.

   No rounding mode is changed.  A double x that was rounded to nearest from z has
   |x - z| <= 2^-53 |x| + 2^-1075, gradual underflow included.  just_below moves it down by about
   2^-51 |x| + 2^-951, and its own roundings cost less than 2^-52 |x| + 2^-1000; just_above moves it
   up by as much.  (Arb's intervals of doubles do the same.) */
#ifndef CONVERSE_INTERVAL_H
#define CONVERSE_INTERVAL_H

#include <math.h>

#include "sine.h"

#if LANES != 1
#error "intervals have one lane"
#endif

typedef struct { double low, high; } interval;

/* <= and >= what was rounded to x, by any operation that rounds correctly; -inf and inf where x is
   NaN or overflowed. */
INLINE double just_below(double x)
{
    const double y = x - (fabs(x) + 0x1p-900) * 0x1p-51;

    return y == y ? y : -HUGE_VAL;
}

INLINE double just_above(double x) { return -just_below(-x); }

/* x itself; the whole line unless it is finite. */
INLINE interval interval_of(double x)
{
    return isfinite(x) ? (interval){ x, x } : (interval){ -HUGE_VAL, HUGE_VAL };
}

INLINE interval interval_about(double x, double radius)
{
    return (interval){ just_below(x - radius), just_above(x + radius) };
}

/* >= |x| for all x of the interval. */
INLINE double interval_size(interval x) { return larger(fabs(x.low), fabs(x.high)); }

INLINE interval interval_add(interval x, interval y)
{
    return (interval){ just_below(x.low + y.low), just_above(x.high + y.high) };
}

INLINE interval interval_sub(interval x, interval y)
{
    return (interval){ just_below(x.low - y.high), just_above(x.high - y.low) };
}

INLINE interval interval_mul(interval x, interval y)
{
    const double a = x.low * y.low, b = x.low * y.high, c = x.high * y.low, d = x.high * y.high;
    const double least_ab = a < b ? a : b, least_cd = c < d ? c : d;
    const double most_ab = a > b ? a : b, most_cd = c > d ? c : d;

    if (isnan((a + b) + (c + d)))       /* 0 times infinity, or both infinities */
        return interval_of(NAN);
    return (interval){ just_below(least_ab < least_cd ? least_ab : least_cd),
                       just_above(most_ab > most_cd ? most_ab : most_cd) };
}

/* n x, n a double that is exact. */
INLINE interval interval_scale(double n, interval x)
{
    const double low = n * x.low, high = n * x.high;

    return n < 0.0 ? (interval){ just_below(high), just_above(low) }
                   : (interval){ just_below(low), just_above(high) };
}

/* The part of x within [-1, 1]. */
INLINE interval interval_clip(interval x)
{
    return (interval){ x.low > -1.0 ? x.low : -1.0, x.high < 1.0 ? x.high : 1.0 };
}

/* The sines and cosines: |sin'| and |cos'| are at most 1. */
INLINE void interval_sincos(interval *s, interval *c, interval x)
{
    const double middle = 0.5 * x.low + 0.5 * x.high;
    const double off = larger(just_above(middle - x.low), just_above(x.high - middle));
    const double radius = just_above(off + SINE_ERROR);
    double sine, cosine;

    double_sincos(&sine, &cosine, middle);
    *s = interval_clip(interval_about(sine, radius));
    *c = interval_clip(interval_about(cosine, radius));
}

#endif
