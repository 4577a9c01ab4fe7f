/* sum2.h - numbers with twice the digits of a double, as sums of two (Dekker, Numerische Mathematik
   18, 1971), lane by lane.

   sum2_of_sum and sum2_of_product are exact unless something overflows, and then NaN or infinite,
   or lost below 2^-1000.  u = 2^-53, and each operand has |low| <= u |high|, as all results have.
   Then sum2_plus and sum2_times lose 8 u^2 of the absolute values of what they add and of the
   product, and 17 u^2 if |low| <= 3 u |high| for one of them.  sum2_over loses 16 u^2 of the
   quotient: the difference of the high parts is exact, and at most u of a.  With the low parts it
   is rounded three times. */
#ifndef CONVERSE_SUM2_H
#define CONVERSE_SUM2_H

#include "lanes.h"

typedef struct { vec high, low; } sum2;

INLINE sum2 sum2_of_sum(vec a, vec b)
{
    const vec sum = a + b, part = sum - a;

    return (sum2){ sum, (a - (sum - part)) + (b - part) };
}

/* a = the upper half of its digits and the rest. */
INLINE sum2 sum2_halves(vec a)
{
    const vec c = 0x1.0000002p27 * a, high = c - (c - a);

    return (sum2){ high, a - high };
}

INLINE sum2 sum2_of_product(vec a, vec b)
{
    const vec product = a * b;
    const sum2 x = sum2_halves(a), y = sum2_halves(b);

    return (sum2){ product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) +
                                x.low * y.low };
}

INLINE sum2 sum2_plus(sum2 a, sum2 b)
{
    const sum2 sum = sum2_of_sum(a.high, b.high);

    return sum2_of_sum(sum.high, sum.low + (a.low + b.low));
}

INLINE sum2 sum2_times(sum2 a, sum2 b)
{
    const sum2 product = sum2_of_product(a.high, b.high);

    return sum2_of_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

INLINE sum2 sum2_over(sum2 a, vec b)
{
    const vec quotient = a.high / b;
    const sum2 product = sum2_of_product(quotient, b);

    return sum2_of_sum(quotient, ((a.high - product.high) - product.low + a.low) / b);
}

#endif
