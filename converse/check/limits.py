"""The exit statuses, and the limits within which the checker works."""

VERIFIED, REJECTED, UNUSABLE, PART, SPOT_CHECK, NOT_CONFIRMED = range(6)    # exit statuses
INTERRUPTED = 128                       # and the number of the signal
PIPE_CLOSED = INTERRUPTED + 13          # as if SIGPIPE had ended the command
MAX_BYTES = 1 << 28                     # of a proof file, uncompressed
MAX_CUTS = 1000                         # of a leaf
MAX_LINE = 1 << 24                      # of the header
MAX_CHARACTERS = 3000                   # of a number; Python prints 4,300 digits of an integer
MAX_SIZE = 10 ** 300                    # of such a number
MAX_BITS = 4096                         # of the arithmetic
MAX_HALVINGS, MAX_PIECES = 24, 4096     # of a leaf, by the checker itself
HALVINGS_APART_MAX = 4                  # of an axis beyond another that matters
MATTERS_MIN = 2.0 ** -30                # share of an axis that matters, of the largest share
# When n is chosen, a site of this reach (radians) has beta + p |P| with p = (first + second reach)
# reach; a leaf's pieces take these pairs in turn.  docs/proofs/checker.md has the experiment.
SITE_PENALTIES = (0, 0.2), (0.3, 0), (0, 1.0), (1.0, 0)
MAX_SITES, FIRST_TRY_SITES = 1 << 17, 96    # of half an orbit, at most; before (C3) is tried
MAX_WAVES, MAX_K = 16, 100              # of a potential; |k0| and |k1|
