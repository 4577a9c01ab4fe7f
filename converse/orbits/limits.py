"""The thresholds of this room: what each bounds, in which unit, and why it has its value.

The period of x is 1.  The Hessian of the action has eigenvalues of about 1.  A state's shadow is
about its distance from an orbit.  Where no reason stands, the value is a choice of effort, and
nothing that is proved rests on it.
"""

from fractions import Fraction

# ---- states

MAX_Q = 10 ** 7                 # The period q of a state is at most this.
MAX_DISPLACEMENT = 1000         # Displacements and origins are smaller: doubles keep 13 digits
                                # after the point there.
MAX_SHADOW = 1e-9               # A state whose shadow is smaller is an orbit.
EIGENVALUE_ROUNDING = 1e-12     # The rounding of an eigenvalue is smaller.
SHADOW_REACH = 1e-3             # Over this distance an eigenvalue is taken to be constant.
EIGENVALUE_STEP = 1e-15         # An eigenvalue is bisected to this, or to a relative 1e-5.
ACTION_ROUNDING = 1e-15         # The rounding of an action, for each point, where eps is at most 1.
ANGLE_ROUNDING = 1e-15          # A number whose argument has a smaller sine is real.
MIN_STEP_RATIO = 1e-9           # Newton's step to a maximum of V ignores flatter directions: a part
                                # of the largest singular value.
NULL_EIGENVALUE = 1e-8          # An eigenvalue below this in size leaves the phase undetermined.
MAX_PIVOTS = 200000             # The pivots pass at most this, or five times round the orbit.
MAX_LOG_EXCESS = 40.0           # Beyond e^40 a double does not notice 4.
DOUBLE_PLACES = 1074            # The least double is 2^-1074.

# ---- continuation and onsets

STEP_TIMES_CURVATURE = 0.2      # The step of eps to the next guess, times the curvature.
MIN_CURVATURE = 1e-300          # A flatter potential is followed as if it had this curvature.
NEWTON_GRADIENT = 1e-13         # newton() ends where no coordinate of the gradient is larger.
MAX_STEP_DIVISOR = 64           # The step is divided by at most this where the solver fails.
MAX_EPS_STEPS = 10000           # From one eps to the next there are no more steps.
MAX_ONSET_GRADIENT = 1e-12      # Before break-up rounding hides smaller gradients.
MAX_ONSET_STEPS = 3000          # After these steps of the solver a smaller step of eps is tried.
MAX_ONSET_HALVINGS = 10         # The step of eps is halved so often.
ONSET_TIMES_CURVATURE = 0.03, 0.0006, 4.0   # Step, width and top of onset(), times the curvature.

# ---- passes

ORDER_TOLERANCE = 1e-9          # A smaller disorder of neighbours on the circle may be rounding.
PASS_STOPS = 32                 # Places on the way from a minimum to its neighbour.
PASS_BISECTIONS = 24            # Bisections of the part of the way where the pass is.
HELD_STEPS = 1000               # Steps of a descent with a coordinate held.
MAX_HELD_GRADIENT = 1e-13       # The gradient of the other coordinates after it.
MIN_SLOPE = 1e-13               # If the held coordinate's slope is smaller, the way is flat.
MAX_PASS_SHADOW = 1e-10         # The shadow of a pass.
MAX_POLISH_STEPS = 12           # Newton steps at a pass.
MIN_JUMP = 1e-4                 # States that are nearer did not jump.
MAX_NESTED_JUMPS = 3            # Jumps inside of jumps.
MAX_HELD = 4                    # Coordinates that are held, one after the other.

# ---- proofs, in decimal places and bits

DEFAULT_DIGITS = 20             # The radius is at most 10^-DEFAULT_DIGITS by default.
MAX_PLACES = 1000               # No orbit is tried with more decimal places.
MAX_MORE_PLACES = 100           # Places that are added in vain.
MAX_PROOF_STEPS = 60            # Newton steps.
MIN_LEAST_GUESS = Fraction(1, 10 ** 11)     # The least eigenvalue is first tried at this or more,
LEAST_SHARE = Fraction(49, 50)  # at this part of what doubles see: their rounding is below a
LEAST_RATIO = Fraction(21, 20)  # fiftieth there.  The bound is raised until within this ratio.
MAX_STIFFNESS = 1e6             # A coordinate of a pass is made stiffer by at most this and 1.
GUARD_PLACES = 10               # A quantity counts if it exceeds rounding by 10^GUARD_PLACES.
MAX_DIGITS = MAX_PLACES - 2 * GUARD_PLACES      # A radius of 10^-MAX_DIGITS may be asked for.
SHOWN_PLACES = 20               # Places of an interval in a report.
EXPONENT_PLACES = 45            # Places of an exponent.
GUARD_BITS = 64                 # Bits of midpoints beyond the decimal places.
MAX_CONES = 40                  # Cones that are tried for one exponent.
