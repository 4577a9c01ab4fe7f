/* converse.h - what Python sees of the C core; the builder hands this file to cffi.

   Nothing here prints, reads a file or ends the process, and nothing is global: two searches
   may run in two threads.  Numbers cross the border as decimal strings, exactly. */

/* Return values. */
enum {
    CV_OK = 0,
    CV_RUNNING = 1,          /* of a search: prisms are left to decide */
    CV_ENOMEM = -1,
    CV_ENUMBER = -2,         /* a string is not a decimal number, or out of range */
    CV_EARGUMENT = -3,       /* an argument makes no sense (a negative half-width, dp < 1, ...) */
    CV_EARITHMETIC = -4,     /* division by zero, a root of a negative number, lost precision */
    CV_ESINGULAR = -5,       /* the matrix could not be inverted at any sensible precision */
    CV_EMACHINE = -6,        /* the floating-point unit or the build breaks the rules of rigor */
    CV_ESTOPPED = -7         /* Python asked for an end, with Ctrl-C for example */
};

/* Why a try of a prism ended without a proof (index of reasons[]). */
enum {
    CV_REASON_CENTRE,        /* not even the orbit of the centre contradicts minimality */
    CV_REASON_TOO_BIG,       /* an image prism outgrew MAX_SUM */
    CV_REASON_TOO_LONG,      /* the orbit reached `furthest` steps */
    CV_REASON_SINGULAR,      /* a matrix could not be inverted */
    CV_REASON_ARITHMETIC,    /* overflow, NaN, division by zero, lost precision */
    CV_REASON_DISAGREE,      /* the double-precision try succeeded, the rigorous one did not */
    CV_N_REASONS
};

enum { CV_BY_MAXBLAM, CV_BY_MINBLAM, CV_BY_TRACE };   /* index of ll_used[] */

/* The constants of the theorem: T, Tr_-, Tr_+, B, lambda_-min, lambda_-max, as in section 3.3.4 of
   the thesis.  The method Loewner has B alone. */
enum { CV_T, CV_TRACE_MIN, CV_TRACE_MAX, CV_B, CV_LAM_MIN, CV_LAM_MAX, CV_N_CONSTANTS };

/* The statistics of the report; names from the thesis, follow.inc. */
typedef struct {
    long quick_tries, tries, Rtries;
    long cuts, proved, symmetric, undecided; /* nodes of the tree by kind */
    long HermSuccess, LLSuccess; /* proved by the trace, by the eigenvalue */
    long ll_used[3]; /* which criterion gave each bound of the tries */
    long reasons[6]; /* tries that ended without a proof, by reason */
    long most_cuts; /* depth of the deepest proved prism */
    long max_steps; /* longest orbit of the double-precision tries */
    long max_NTsteps; /* longest orbit of the successful rigorous tries */
} cv_counts;

enum { CV_THESIS, CV_LOEWNER }; /* methods */

/* A prism of the tree: along axis k it is slice index[k] of the 2^cuts[k] equal slices of the
   root.  Axes: 0, 1, 5 the angles v0, v1, v2, less what the parameters shift them; 2, 3, 4 the
   parameters t_1, t_2, t_3. */
typedef struct {
    unsigned long long index[6];
    int cuts[6];
    int hint; /* learnt from the prism it was cut from; 0 for the root */
} cv_cell;

/* The cuts along one axis that a cell's index can hold. */
enum { CV_INDEX_BITS = 61 };
/* The sharper method tries no prism that was cut more often along one axis. */
enum { CV_MAX_CUTS = 50 };

typedef struct cv_search cv_search;

/* A wave of the potential V, -p sin(k.y + phase), whose amplitude p moves with the parameters, each
   in [-1, 1]: p = amplitude + t_1 part[0] + t_2 part[1] + t_3 part[2]. */
typedef struct {
    int k[3];
    const char *phase; /* in units of pi, from 0 to 2; it may be off by 10^-40 */
    int quarters; /* how many quarter turns it is exactly, or -1 */
    const char *amplitude;
    const char *part[3];
} cv_wave;

/* A patch of parameter space, and the region of x_1 = frame v, x_1[i] = sum of frame[i][j] v_j,
   whose determinant is not 0.  The region may move with the parameters: v_i lies within half[i] of
   angle[i] + t_1 shift[i][0] + t_2 shift[i][1] + t_3 shift[i][2].  Of fewer than three angles the
   first elements of the arrays are read. */
typedef struct {
    int n_angles; /* 1 to 3 */
    int n_waves, n_parameters; /* 1 to 16, and 0 to 3 */
    const cv_wave *waves;
    const char *angle[3], *half[3]; /* centre and half-width of v0, v1, v2 in units of pi */
    const char *shift[3][3];            /* in units of pi; NULL: none */
    int frame[3][3];
    int odd;                            /* is V odd about some point?  See cv_at_once */
    int symmetric; /* does every exchange of coordinates map patch and region to themselves? */
} cv_problem;

/* A new search; it covers an enclosure of the problem's region.  The thesis's waves are (1, 0),
   (0, 1) and (1, 1) in this order, without phases.  Its method takes only these, each with a
   separate parameter, in the identity frame and without shifts.
   xstar: the coordinates of the starting point, or NULL to have one chosen.
   longest: the most points of an orbit, or 0 for as many as the method can follow.  -n: n points,
   and the work ends before a prism whose orbit may need more: then `needs_long` of cv_look is 1.
   On success *s must be freed with cv_search_free.  It begins with the root as its only prism. */
int cv_search_new(cv_search **s, const cv_problem *problem, const char *const xstar[3], int method,
                  int dp, int depth, int stubborn, int as_printed, int longest);
void cv_search_free(cv_search *s);

/* No thread may be in cv_work meanwhile: takes up a tree, and forgets the one before and
   its counts.
   text: the tree in preorder, or several ones, with a ? for each of the cells, in this order, that
   are to be decided. */
int cv_restart(cv_search *s, const char *text, const cv_cell *cells);

/* Before threads work: they are to end when all prisms are decided, when an undecided one ends a
   search that is not stubborn, and when max_leaves further leaves are decided or the orbits of the
   prisms that were decided since cv_restart have max_points further points.  Tree, counts and the
   place of the end are the same for any number of threads.  An error: one of before, or the setting
   up was broken off; then the search can only be freed. */
int cv_begin(cv_search *s, long max_leaves, double max_points);
/* Sets the search up, if that was not done: the bounds over the torus first of all. */
int cv_set_up(cv_search *s);
/* Decides prisms, once the search is set up.  As many threads as like may be in this.  CV_ENOMEM:
   memory ran out; the tree is good as far as it was grown.  CV_EMACHINE: the arithmetic breaks the
   rules, before the work or after it: nothing that the search did since cv_restart may be used. */
int cv_work(cv_search *s);
/* The threads that are in one of these two are to end soon.  Prisms that are being tried are
   forgotten. */
void cv_halt(cv_search *s);

/* A search as it is, whether or not threads are at work. */
typedef struct {
    cv_counts counts;
    double examined; /* the share of the root, by volume, in leaves; it never falls */
    double points; /* of the orbits of all tries since cv_restart that count in the tree */
    int finished; /* are all prisms decided, or does an undecided one end the search? */
    int needs_long; /* see cv_search_new; the tree so far does not depend on `longest` */
    size_t length, n_cells;
    char *tree; /* the tree in preorder, with a ? for each prism that is yet to be decided, */
    int *steps; /* the lengths of the orbits that this search followed, */
    cv_cell *cells; /* and the prisms yet to be decided, of which some may be known: these do not
                       count yet */
} cv_view;
/* whole: also the tree and the cells?  CV_OK or CV_ENOMEM. */
int cv_look(cv_search *s, int whole, cv_view *view);
void cv_forget_view(cv_view *view);

/* May a cell be cut along this axis?  Are cells that lie on the side v1 >= v0 skipped ('S'), since
   their mirror images will do? */
int cv_has_axis(const cv_search *s, int axis);
int cv_skips(const cv_search *s);

/* Mather's criterion, for the method Loewner and odd V.  1: B > 10/3 on the whole patch; 2: there
   is one parameter, and B > 10/3 at its upper end t_1 = 1; 0: neither.  With 1 or 2 the theorem
   also holds for every multiple s >= 1 of these amplitudes. */
int cv_at_once(const cv_search *s);
/* A coordinate, 0 to 2, of the starting point, and once the search is set up a constant of the
   theorem, CV_T, ...: as exact decimals, which the caller frees.  NULL: no memory. */
char *cv_xstar(const cv_search *s, int coordinate);
char *cv_constant(const cv_search *s, int which);
void cv_free(char *text);
