/* lanes.h - LANES doubles side by side, on each of which the same is done.

   Define LANES before the include; the default is 1, where vec is double.  All operations are
   those of doubles rounded to nearest, lane by lane and in the order of the source, so whatever is
   computed has the same bits on every machine and with every number of lanes. */
#ifndef CONVERSE_LANES_H
#define CONVERSE_LANES_H

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef LANES
#define LANES 1
#endif

/* For what is made once for each case, so that its loops have constant ends. */
#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

#if LANES == 1
typedef double vec;
typedef uint64_t mask;                  /* per lane all ones (true) or all zeros (false) */

#define TRUTH(condition) (-(mask)(condition))
INLINE mask bits_of(vec x)
{
    mask m;
    memcpy(&m, &x, sizeof m);
    return m;
}
INLINE vec vec_of(mask m)
{
    vec x;
    memcpy(&x, &m, sizeof x);
    return x;
}
INLINE vec root_of(vec x) { return sqrt(x); }
INLINE int any(mask m) { return m != 0; }
#else
typedef double vec __attribute__((vector_size(8 * LANES)));
typedef uint64_t mask __attribute__((vector_size(8 * LANES)));

#define TRUTH(condition) ((mask)(condition))
INLINE mask bits_of(vec x) { return (mask)x; }
INLINE vec vec_of(mask m) { return (vec)m; }
INLINE vec root_of(vec x)
{
    for (int k = 0; k < LANES; k++)
        x[k] = sqrt(x[k]);
    return x;
}
INLINE int any(mask m)
{
    uint64_t all = 0;
    for (int k = 0; k < LANES; k++)
        all |= m[k];
    return all != 0;
}
#endif

INLINE mask none(void) { return (mask){ 0 }; }
INLINE vec every(double x) { return x - (vec){ 0 }; }
INLINE double at(const vec *x, int k) { return ((const double *)x)[k]; }
INLINE void put_at(vec *x, int k, double value) { ((double *)x)[k] = value; }
INLINE int holds(const mask *m, int k) { return ((const uint64_t *)m)[k] != 0; }

/* x where m, y elsewhere. */
INLINE vec pick(mask m, vec x, vec y) { return vec_of((bits_of(x) & m) | (bits_of(y) & ~m)); }
INLINE mask choose(mask m, mask x, mask y) { return (x & m) | (y & ~m); }
INLINE vec mag(vec x) { return vec_of(bits_of(x) & INT64_MAX); }
INLINE vec square(vec x) { return x * x; }
/* NaN if either is. */
INLINE vec larger(vec x, vec y) { return pick(TRUTH(x > y) | TRUTH(x != x), x, y); }

/* A mask may hold an integer below 2^31 in each lane.  extreme: the largest of these (way > 0) or
   the least (way < 0) over the lanes that are active; 0 if no lane is. */
INLINE int number(const mask *m, int k) { return (int)((const uint64_t *)m)[k]; }
INLINE void put_number(mask *m, int k, int value)
{
    assert(value >= 0);
    ((uint64_t *)m)[k] = (uint64_t)value;
}
INLINE void put_truth(mask *m, int k, int value) { ((uint64_t *)m)[k] = value ? UINT64_MAX : 0; }
INLINE int extreme(mask active, mask m, int way)
{
    int found = 0, best = 0;

    for (int k = 0; k < LANES; k++)
        if (holds(&active, k) && (!found || way * (number(&m, k) - best) > 0)) {
            best = number(&m, k);
            found = 1;
        }
    return best;
}

#endif
