/* machine.c - see machine.h. */
#include "machine.h"

#include <fenv.h>
#include <float.h>

#ifdef __FAST_MATH__
#error "-ffast-math breaks the rules of rigor"
#endif
#if FLT_EVAL_METHOD != 0
#error "doubles must be evaluated as doubles"
#endif

int machine_is_sound(void)
{
    volatile double tiny = DBL_MIN, one = 1.0, third, more = 1.0 + 0x1p-30;
    const double x = more, fused = x * x - (1.0 + 0x1p-29);   /* 2^-60 where it is contracted */

    tiny *= 0.5;
    third = one / 3.0;
    return fegetround() == FE_TONEAREST && tiny > 0.0 && third * 3.0 == 1.0 && fused == 0.0 &&
           one + 0.5 * DBL_EPSILON == 1.0 && one - 0.25 * DBL_EPSILON == 1.0;
}
