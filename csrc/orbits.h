/* orbits.h - what Python sees of the periodic orbits; the builder hands this file to cffi.

   The n-torus has period 1 here, n = 1 or 2, and the map is x_{j+1} = 2 x_j - x_{j-1} -
   eps grad V(x_j) (thesis, section 2.1).  An array of q points is double [q][2] for either n: with
   n = 1 the second coordinate is idle, zero and free.  A state of type (p, q) is base + u with
   base_j = origin + (j p mod q)/q: the kinetic part of its gradient needs u alone.
   Symmetric matrices are stored as three numbers, the entries 00, 01 and 11.

   These functions work in doubles and promise nothing.  converse/orbits/enclosure.py proves orbits
   in balls. */

typedef struct {
    int n;
    /* NULL: V(x) = sum over t of cosine[t] cos(2 pi k.x) + sine[t] sin(2 pi k.x), where k is k[2t],
       k[2t+1].  Otherwise Python computes V, and this is the handle of its Potential. */
    void *python;
    int terms;
    const int *k;
    const double *cosine, *sine;
} cv_potential;

/* V, its gradient and Hessian at m points. */
void cv_evaluate(const cv_potential *v, long m, const double (*x)[2], double *value,
                 double (*gradient)[2], double (*hessian)[3]);

/* u = (Hessian of the action + mu)^-1 b.  blocks: beta_j = 2 - eps V''(x_j).  Returns how many
   eigenvalues of Hessian + mu are negative (then u need not descend).  work: CV_WORK doubles for
   each point; NULL: count only, b and u are not looked at. */
enum { CV_WORK = 7 };
long cv_solve(int n, long q, const double (*beta)[3], double mu, const double (*b)[2],
              double (*u)[2], double *work);

/* How many eigenvalues of the Hessian are negative, and the logarithm of its determinant's
   modulus. */
long cv_determinant(int n, long q, const double (*beta)[3], double *log_det);

typedef struct {
    long steps;                             /* tried, accepted or not */
    int escapes;                            /* from saddles */
    double largest;                         /* coordinate of the gradient */
    double action;                          /* minus the straight orbit's: the sum over j of
                                               |u_{j+1} - u_j|^2/2 - eps V(x_j) */
} cv_relaxed;

/* Damped Newton: lowers the action until the largest coordinate of its gradient is at most tol, or
   100 tol where rounding hides what would lower it, and leaves saddles along their most negative
   direction.  CV_RUNNING: not there after max_steps steps, or, if there were fewer, no step helps;
   u is the best state met.  *how: zero, to be filled in.  CV_ESTOPPED: Python wants an end.
   held: this coordinate of the first point, 0 or 1, stays as it is, and its entry of the gradient
   does not count; -1: none. */
int cv_relax(const cv_potential *v, long q, double eps, const double (*base)[2], double (*u)[2],
             int held, double tol, long max_steps, cv_relaxed *how);

/* The pivots d_j = beta_j - 1/d_{j-1} from d_0 = beta_0, run round the orbit until they repeat to
   relative 1e-13 or for max_rounds.  Returns the rounds it took, 0 if they did not settle; -r if
   one in round r was not positive definite: then the orbit run through r + 1 times is not a
   minimum, since its Hessian, with the other points held fixed, has the same pivots up to there. */
long cv_pivots(int n, long q, const double (*beta)[3], long max_rounds, double (*d)[3]);

/* The force of a Fourier sum, for eps = 1: -grad V(x) is the sum over j of
   k_j size[j] sin(2 pi (k_j.x + phase[j])), where k_j is k[2j], k[2j+1]; k[2j+1] is 0 if n = 1. */
typedef struct {
    int n, waves;
    const int *k;
    const double *size, *phase;
} cv_waves;

/* Follows the orbits of m momenta p over x for 2 points steps.  means[i]: of the steps
   x_{j+1} - x_j of orbit i in its first half and in its second.  weight: of the steps of a half,
   with the sum 1.  On an invariant torus both means are about the rotation vector. */
void cv_rotations(const cv_waves *v, const double x[2], long m, const double (*p)[2], long points,
                  const double *weight, double (*means)[2][2]);

/* The points x_0 = x, x_1, ... of the orbit of one of these momenta, not reduced modulo 1. */
void cv_lift(const cv_waves *v, const double x[2], const double p[2], long points,
             double (*lift)[2]);
