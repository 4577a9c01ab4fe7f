/* turns.h - angles as whole numbers of 2^-64 turns, and their sines, lane by lane.

   An angle is a uint64_t, so sums, differences and products with integers are exact modulo one
   turn.  In an orbit of such angles only the forces are rounded. */
#ifndef CONVERSE_TURNS_H
#define CONVERSE_TURNS_H

#include "sum2.h"

#if defined __x86_64__ && LANES > 1
#include <immintrin.h>
#endif

__extension__ typedef __int128 int128;

typedef int64_t integers __attribute__((vector_size(8 * LANES)));

#define QUARTER_TURN (UINT64_C(1) << 62)
#define TURNS_ERROR 0x1.8p-61           /* of the sines: 3 units of 2^-62 */
/* 2^-64 turns, in radians: the double, and what it lacks. */
static const double TURN_UNIT = 0x1.921fb54442d18p-62, TURN_UNIT_LOW = 0x1.1a62633145c07p-116;

/* The products of the lower 32 bits.  (gcc 12 does not find the instruction without help.) */
INLINE mask product_of_halves(mask a, mask b)
{
#if defined __x86_64__ && LANES == 8
    return (mask)_mm512_mul_epu32((__m512i)a, (__m512i)b);
#elif defined __x86_64__ && LANES == 4
    return (mask)_mm256_mul_epu32((__m256i)a, (__m256i)b);
#elif defined __x86_64__ && LANES == 2
    return (mask)_mm_mul_epu32((__m128i)a, (__m128i)b);
#else
    return (a & UINT32_MAX) * (b & UINT32_MAX);
#endif
}

/* a b 2^-64, off by less than 2: three products cut off lose less than 1 each, and 1 is added. */
INLINE mask high_of(mask a, mask b)
{
    const mask upper_a = a >> 32, upper_b = b >> 32;

    return product_of_halves(upper_a, upper_b) + (product_of_halves(upper_a, b) >> 32) +
           (product_of_halves(a, upper_b) >> 32) + 1;
}

/* Two's complement: -x where `negative` is all ones, x where it is 0. */
INLINE mask with_sign(mask x, mask negative) { return (x ^ negative) - negative; }

/* All ones where bit 63 is set. */
INLINE mask sign_of(mask x) { return -(x >> 63); }

/* An integer below 2^52 as a double, and a double from 0 to 2^52, rounded, as an integer: 2^52 and
   such a number is a double whose last bits are the number. */
#define ONES_AT_52 UINT64_C(0x4330000000000000)
INLINE vec double_of(mask x)
{
    assert(!any(x >> 52));
    return vec_of(x | ONES_AT_52) - 0x1p52;
}
INLINE mask integer_of(vec x)
{
    assert(!any(~(TRUTH(x >= 0.0) & TRUTH(x <= 0x1p52))));
    return bits_of(x + 0x1p52) - ONES_AT_52;
}

/* 2^-62 s is within TURNS_ERROR of the sine, 2^-62 c of the cosine, in two's complement; the sizes
   of s and c are 2^62 at most.

   The angle is n quarter turns and a part of at most 1/2 of one, the size of which is x.  So with
   z = x^2 <= 1/4 and k[i] = (pi/2)^i/i!

       sine    x (k1 - z (k3 - z (k5 - z (k7 - ... z k19)))),
       cosine  1 - z (k2 - z (k4 - z (k6 - ... z k18))),

   where the series lack 0.1 units of 2^-64 at most.  The polynomials that begin with k7 and k6, D
   and E, are computed in doubles of u = 2^-53, the others in units of 2^-64.

   In these units: x is exact, z is off by 2, and as a double, v, by 2^10 + 2 more.  z D < 2^-9.7 is
   off by 4.8 for v; by 2 each for k7, the last two sums and the last product, which are roundings
   of numbers below 2^-7, 2^-7, 2^-7 and 2^-9; by 0.4 for all else; and by 8 as it becomes an
   integer: by 21.2.  z E < 2^-7.5 is off in the same way by 21.5, 4 times 8, 1 and 16: by 70.5.  A
   product by high_of is off by 2, a coefficient by 1/2.  Of z alone, where it is not v, the sine is
   off by 2 k3/2 < 0.7 and the cosine by 2 k2 < 2.5; and besides
       k5 - z D by 21.7, the product with z by 21.7/4 + 2, k3 less that by 8;
       the product with z by 8/4 + 2, k1 less that by 4.5, the sine by 4.5/2 + 2 + 0.7 + 0.1 < 5.1;
       k4 - z E by 71, the product with z by 71/4 + 2, k2 less that by 20.3;
       the product with z by 20.3/4 + 2, the cosine by 7.1 + 2.5 + 0.1 = 9.7.
   A fourth of that, and 1/2 as s and c are rounded: less than 3 units of 2^-62. */
INLINE void turns_sincos(mask *s, mask *c, mask turns)
{
    const mask n = (turns + (UINT64_C(1) << 61)) >> 62, part = turns - (n << 62);
    const mask negative = sign_of(part), x = with_sign(part, negative) << 2, z = high_of(x, x);
    const vec v = double_of((z + (1 << 10)) >> 11) * 0x1p-53, w = v * v;
    /* 2^60 (k7 - v k9 + ... + v^6 k19) and 2^59 (k6 - v k8 + ... + v^6 k18), pairs of terms apart
       from each other, as processors do these at the same time. */
    const vec d3 = 0x1.6fadb9f155744p+29 - v * 0x1.aaec32af93359p+22 + w * 0x1.8a404211f9547p+15;
    const vec d2 = 0x1.e3074fde8871fp+41 - v * 0x1.e8f434d018d63p+35 + w * d3;
    const vec d = 0x1.32d2cce62bd86p+52 - v * 0x1.50783487ee782p+47 + w * d2;
    const vec e3 = 0x1.b6e24f44b128fp+31 - v * 0x1.20c62c2f2d7f5p+25 + w * 0x1.2a0c591af8314p+18;
    const vec e2 = 0x1.a6d1f2a204a8cp+43 - v * 0x1.f9d38a3763cc3p+37 + w * e3;
    const vec e = 0x1.55d3c7e3cbffap+53 - v * 0x1.e1f506891babbp+48 + w * e2;
    mask p, q;

    p = UINT64_C(0x1466bc6775aae1d2) - (integer_of(v * d) << 4);        /* k5 */
    p = UINT64_C(0xa55de7312df295f5) - high_of(z, p);                   /* k3 */
    p = UINT64_C(0x921fb54442d1846a) - high_of(z, p);                   /* k1 - 1 */
    q = UINT64_C(0x40f07c206d6b0ecd) - (integer_of(v * e) << 5);        /* k4 */
    q = UINT64_C(0x3bd3cc9be45de5a5) - high_of(z, q);                   /* k2 - 1 */
    const mask sine = with_sign((x + high_of(x, p) + 2) >> 2, negative);
    const mask cosine = (UINT64_C(1) << 62) - ((z + high_of(z, q) + 2) >> 2);
    const mask odd = -(n & 1);

    *s = with_sign(choose(odd, cosine, sine), -(n >> 1 & 1));
    *c = with_sign(choose(odd, sine, cosine), -((n + 1) >> 1 & 1));
}

/* 2^-62 s, |s| <= 2^62, as the double next to it, and what that lacks: 2^-62 s = 2^-31 upper +
   2^-62 lower, which are exact, and upper is 0 or larger than lower. */
INLINE vec sine_in_two(mask s, vec *lacks)
{
    const mask biased = s + (UINT64_C(1) << 62);
    const vec upper = (double_of(biased >> 31) - 0x1p31) * 0x1p-31;
    const vec lower = double_of(biased & INT32_MAX) * 0x1p-62, sum = upper + lower;

    *lacks = lower - (sum - upper);
    return sum;
}

/* The sine, within 2^-100.

   The angle is n quarter turns and x radians, |x| < 0.79, z = x^2 < 0.62.  Except for 2^-107, the
   cosine of x is f and its sine x f, with

       f = 1 - z/(1 2) (1 - z/(3 4) (1 - ... z/(25 26)))    for the cosine,
       f = 1 - z/(2 3) (1 - z/(4 5) (1 - ... z/(26 27)))    for the sine.

   In units of u^2 = 2^-106, x is off by 9 of itself and z by 26.  A step loses 26 + 8 + 16 of z f/d
   and 8 of 1 + z f/d, and multiplies the error of f by z/d.  For the cosine z/d is below 0.31, and
   f is off by less than 38.  For the sine z/d is below 0.11, f is off by less than 17, and x f by
   0.79 (17 + 9 + 8). */
INLINE sum2 fine_sine(mask turns)
{
    const sum2 one = { every(1.0), every(0.0) };
    const sum2 quarter = { every(0x1.921fb54442d18p0), every(0x1.1a62633145c07p-54) };
    const mask n = (turns + (UINT64_C(1) << 61)) >> 62, odd = -(n & 1);
    const vec sign = 1.0 - double_of(n & 2);
    sum2 part, f = one;

    part.high = sine_in_two(turns - (n << 62), &part.low);
    const sum2 x = sum2_times(part, quarter);
    const sum2 minus_z = sum2_times((sum2){ -x.high, -x.low }, x);
    for (int m = 26; m > 0; m -= 2) {
        const vec divisor = pick(odd, every(m * (m - 1)), every(m * (m + 1)));
        f = sum2_plus(one, sum2_over(sum2_times(minus_z, f), divisor));
    }
    const sum2 sine = sum2_times(x, f);
    return (sum2){ sign * pick(odd, f.high, sine.high), sign * pick(odd, f.low, sine.low) };
}

/* 2^-62 s, |s| <= 2^62, as the double next to it. */
INLINE vec sine_of(mask s)
{
#if LANES == 8                          /* one instruction, where fewer lanes have none */
    return 0x1p-62 * __builtin_convertvector((integers)s, vec);
#else
    vec lacks;
    return sine_in_two(s, &lacks);
#endif
}

#endif
