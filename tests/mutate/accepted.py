"""The survivors that do not matter, each with its reason: by file and function, or these and an
operator, or one place of it."""

GAMMA = ("the map is affine in the parameters: on a path that changes them first, at the centre's "
         "v, gamma is gamma_c but for its rounding, and the bound of beta - beta_c alone serves "
         "for the rest")
UNIT = "a second belt: one of the vectors n is a unit vector"

SPECTRAL = ("the squares are integers: if less than one is lost of a square x, isqrt(x) + 1 is "
            "still above its root")
FLOOR = ("the floor loses a unit of 2^-(bits + 64); the rounding of the same product is counted "
         "with more than 2^63 units too many: 1 + e, where e complex entries need (2 e)^(1/2)")

ACCEPTED = {
    "check/lockstep.py:remainder compare 1": "where P A0 = 0 both terms have the factor 0",
    "check/series.py:_beyond term 1": FLOOR,
    "check/series.py:_planned term 3": FLOOR,
    "check/series.py:product_of_norms term 1": FLOOR,
    "check/series.py:sizes term 5": SPECTRAL,
    "check/series.py:sizes term 12": SPECTRAL,
    "arith/special.c:apm_pi drop 7":
        "without it pi is right unless fifteen digits of it coincide with nines or zeros",
    "loewner/bound.c:bound_with drop 13": UNIT,
    "loewner/bound.c:sum_up term 1":
        "TINY is for products that underflow beside parameters and reaches of more than 10^100",
    "loewner/orbit.c:step drop 10":
        "such a point only ends an orbit a step later, and its reach is a bound all the same",
    "loewner/orbit.c:invert_factor compare 2":
        "a determinant below 2^-800 would need two entries of beta that are differences from 2 and "
        "yet as small as 2^-400",
    "loewner/problem.c:loewner_at_once compare 7": UNIT,
    "orbits/relax.c:evaluate compare 12":
        "a second belt: the values of potentials are finite where displacements are",
    "thesis/cr_rows.inc:cr_rows drop 6": GAMMA,
    "thesis/ff_rows.inc:ff_rows drop 5": GAMMA,
    "thesis/cr_rows.inc:cr_rows drop 15":
        "twelve ulps times the error of the inverse, beside the prism times the same",
    "thesis/follow.inc:contradiction drop 4":
        "a second belt: each divisor was just found to be above a positive bound, and comparisons "
        "with NaN are false",
}
