/* rectangle.h - the bound of one cell of the torus; included after csrc/model/torus.c. */
#include "torus.h"

double torus_rectangle(int n, const torus_wave waves[], int which, const double low[2],
                       const double high[2])
{
    int all[MOST_WAVES];
    double middle;

    for (int i = 0; i < n; i++)
        all[i] = 1;
    const surface q = surface_of(2, n, waves, all, which, NULL);
    return just_above(over(&q, low, high, &middle) + (which == TORUS_TRACE ? 4.0 : 2.0));
}
