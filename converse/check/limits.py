"""The exit statuses, and the limits within which the checker works."""

VERIFIED, REJECTED, UNUSABLE, PART, SPOT_CHECK, NOT_CONFIRMED = range(6)    # exit statuses
INTERRUPTED = 128                       # and the number of the signal
MAX_BYTES = 1 << 28                     # of a proof file, uncompressed
MAX_CUTS = 1000                         # of a leaf
MAX_LINE = 1 << 24                      # of the header
MAX_CHARACTERS = 1000                   # of a number in the header
MAX_SIZE = 10 ** 300                    # of such a number
MAX_BITS = 4096                         # of the arithmetic
MAX_HALVINGS, MAX_PIECES = 24, 4096     # of a leaf, by the checker itself
LAG = 4                                 # halvings along one axis that another may be behind
CAUTION = (0, 0.2), (0.3, 0), (0, 1.0), (1.0, 0)  # of the choice of n, in turns: see test_vectors
MAX_SITES, FIRST_TRY = 4096, 96         # of half an orbit; where its length is tried first
MAX_WAVES, MAX_K = 16, 100              # of a potential; |k0| and |k1|
MAX_ITEMS = 1 << 22                     # of a map
MAX_COLUMNS, MAX_STRIP = 1 << 16, 0.5   # of a portrait; half the width of a column, times k
MAX_CELLS = 1 << 15                     # of the torus, about, when B is bounded
MAX_DIVISORS = 1 << 21                 # of a rotation, computed one by one
MAX_MODES, MAX_MODE = 1 << 21, 1 << 21  # of a torus; |k0| and |k1|
MAX_ALPHA, MAX_LENGTH = 1000, 1 << 21    # of the weights of modes; of a mode with these
MAX_WIDTH = 200                         # of the strip of a torus, times its longest mode
MAX_TERMS, MAX_DIGITS = 1 << 24, 1 << 29     # of a series; of all its coefficients
MAX_GRID = 1 << 20                      # of the points on which L is inverted in doubles
