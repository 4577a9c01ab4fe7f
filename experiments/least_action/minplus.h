/* minplus.h - what Python sees of the least action; build.py hands this file to cffi.  Arrays and
   states are as in csrc/orbits.h. */

/* Bounds of cv_evaluate's errors in V, its gradient and its Hessian (Euclidean and spectral norm),
   at points with coordinates up to reach that are themselves off by 2^-53 (2 reach + 2).
   CV_EARGUMENT: no bound is known, since the potential is Python's, or since reach >= 1000.
   CV_EMACHINE: the arithmetic breaks the rules. */
int cv_errors(const cv_potential *v, double reach, double errors[3]);

/* Which states of least action of type (p, q), q points z_j + j p/q, may have z_j in the rectangle
   low[j] to high[j] for all j, and V at z_0 (eps < 0: at least -V) as large as at any other?
   base[j] is (j p mod q)/q rounded, curvature >= the norm of V'', and `known` is an upper bound of
   their action.  All actions are less the straight orbit's.  The points of these states lie in the
   smaller rectangles that are left in low and high, and their action is at least *least, which is
   infinite if there is no such state; otherwise path may be near one.  nodes: how many to lay along
   each axis, 1 to 1025, both ends included; of an idle one 1. */
int cv_corridor(const cv_potential *v, int q, double eps, double curvature, const double (*base)[2],
                double known, const int (*nodes)[2], double (*low)[2], double (*high)[2],
                double *least, double (*path)[2]);

/* On the n-torus's grid of nodes i/grid: out(y) = min over nodes x and all their images of
   u(x) + W(x) + |y - x - c|^2/2, the last coordinate running fastest.  back, unless it is NULL: how
   many pitches y - x has along each axis.  For |c| < 1000 and 2 <= grid <= 2048, off by less than
   2^-45 (max |u| + max |W| + 8 max(1, |c|)). */
int cv_lax_oleinik(int n, int grid, const double c[2], const double *W, const double *u,
                   double *out, int (*back)[2]);
