/* machine.h - what rigorous doubles rely on. */
#ifndef CONVERSE_MACHINE_H
#define CONVERSE_MACHINE_H

/* What doubles are for must hold, or the filter and every rigorous double are void: rounding to
   nearest, numbers below the normal ones, and no product that is added before it is rounded. */
int machine_is_sound(void);

#endif
