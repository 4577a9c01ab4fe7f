/* orbits.h - what Python sees of the periodic orbits; the builder hands this file to cffi.

   The n-torus has period 1 here, n = 1 or 2, and the map is x_{j+1} = 2 x_j - x_{j-1} -
   eps grad V(x_j) (thesis, section 2.1).  An array of q points is double [q][2] for either n: with
   n = 1 the second coordinate is idle, zero and free.  A state of type (p, q) is base + u with
   base_j = origin + (j p mod q)/q: the kinetic part of its gradient needs u alone.
   Symmetric matrices are stored as three numbers, the entries 00, 01 and 11.

   These are doubles without promises, but for potentials: see there.  What is proved with them
   is proved elsewhere. */

enum { CV_FOURIER, CV_POLY, CV_FF, CV_PYTHON };         /* kinds of potentials */

typedef struct {
    int kind, n;
    /* CV_FOURIER: V(x) = sum over t of cosine[t] cos(2 pi k.x) + sine[t] sin(2 pi k.x), k = k[2t], k[2t+1] */
    int terms;
    const int *k;
    const double *cosine, *sine;
    void *self;                             /* CV_PYTHON: handed to cv_python_potential */
} cv_potential;

/* V, its gradient and Hessian at m points.  value, gradient or hessian may be NULL.
   CV_EARGUMENT: Python failed to say. */
int cv_evaluate(const cv_potential *v, long m, const double (*x)[2],
                double *value, double (*gradient)[2], double (*hessian)[3]);

/* The action minus that of the straight orbit, sum |u_{j+1} - u_j|^2/2 - eps V(x_j), and its
   gradient. */
int cv_action(const cv_potential *v, long q, double eps, const double (*base)[2],
              const double (*u)[2], double *action, double (*gradient)[2]);

/* u = (Hessian of the action + mu)^-1 b.  blocks: beta_j = 2 - eps V''(x_j).  Returns how many
   eigenvalues of Hessian + mu are negative (then u is no descent), or an error.  b, u: NULL to count only. */
long cv_solve(int n, long q, const double (*beta)[3], double mu, const double (*b)[2],
              double (*u)[2]);

typedef struct {
    long steps;                             /* tried, accepted or not */
    int escapes;                            /* from saddles */
    double largest;                         /* coordinate of the gradient */
    double damping;                         /* of the next step */
} cv_relaxed;

/* Damped Newton: lowers the action until the largest coordinate of its gradient is at most tol,
   and leaves saddles along their most negative direction.  CV_RUNNING: not there after max_steps
   steps in all, or, if there were fewer, no step helps; u is the best state met.  All zero in *how
   begins; what an earlier call left there goes on where it ended, so that long runs can be broken
   into calls, and interrupted between them. */
int cv_relax(const cv_potential *v, long q, double eps, const double (*base)[2], double (*u)[2],
             double tol, long max_steps, cv_relaxed *how);

/* The pivots d_j = beta_j - 1/d_{j-1} from d_0 = beta_0, run round the orbit until they repeat to
   relative 1e-13 or for max_rounds.  Returns the rounds it took, 0 if they did not settle; -r if one
   in round r was not positive definite: then the orbit run through r + 1 times is no minimum, since
   the pivots up to there are those of its Hessian with the other points held fixed. */
long cv_pivots(int n, long q, const double (*beta)[3], long max_rounds, double (*d)[3]);

/* The logarithms, over q, of the moduli of the eigenvalues of d_{q-1} ... d_0, larger first. */
void cv_growth(long q, const double (*d)[3], double growth[2]);

/* The count closest pairs of q points on the torus, closest first.  Returns how many there are. */
long cv_pairs(int n, long q, const double (*x)[2], long count, long *i, long *j, double *distance);
