"""How accurate the rigorous routines are: what csrc promises, and the worst that was seen.

    PYTHONPATH=tests/loewner:tests/thesis python tests/accuracy.py [TIMES] \
        > docs/development/accuracy.md

Prints a table in Markdown, one promise a row, the same at every run; TIMES multiplies the random
cases (1, which takes three minutes).  The truth is rational arithmetic, or mpmath at many
more digits.  Exit status 1, and a line for each, if something seen is outside what is promised.
"""

import re
import sys
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from fractions import Fraction
from itertools import product
from statistics import median

import mpmath
from test_bd_trig import boxes, true_range
from test_bounds import beta_at, grid_maxima
from test_images import exact_inverse, outside, random_prism
from test_loewner import draw

import kernels
from patches import displacements, thesis, variations
from truth import (CLOSE, cube_of, cube_point, decimal, eigenvalues, exact, list_prism, mp,
                   point_of, rng_for, step, uniform)

SEED = 1989
DIGITS = 120                                            # of mpmath
DP = {"10 places": 10, "35 places": 35, "double": 15}   # unit.inc: what a double is good for
NO_WIDTHS = [[Fraction(0)] * 7 for _ in range(7)]

# A measurement gets random numbers, the number of random cases, the places and the options of
# kernels.call (none but the double's), and yields distances from the truth in the row's unit.


def numbers(rng, n):
    """Decimals of every size, with few or many digits, of either sign."""
    yield from map(Fraction, ("0", "1", "-1", "3", "7", "0.1", "1e-90", "-1e90", "0.25", "1e-10"))
    for _ in range(n):
        digits = rng.randrange(1, 41)
        yield (rng.choice((-1, 1)) * rng.randrange(10**digits)
               * Fraction(10)**rng.randrange(-20 - digits, 20))


def quotients(rng, n, dp):
    for x, y in zip(numbers(rng, n), reversed(list(numbers(rng, n)))):
        if y:
            down, up, cut = kernels.call("div", [x, y], 3, dp)
            yield from (10**dp * e for e in (x / y - down, up - x / y, abs(x / y) - abs(cut)))


def roots(rng, n, dp):
    for x in map(abs, numbers(rng, n)):
        for y, sign in zip(kernels.call("sqrt", [x], 2, dp), (-1, 1)):
            # y - root x, so written that its sign is exact
            yield sign * 10**dp * (y * y - x) / (y + exact(mpmath.sqrt(mp(x)))) if x else y


def pi(rng, n, dp):
    for places in range(1, dp + 1):
        yield 10**places * (exact(mpmath.pi) - kernels.pi(places))


def sines(rng, n, dp, of_doubles=False, **options):
    half_pi = kernels.pi(2 * dp) / 2                # of_doubles: at what an angle is rounded to
    angles = [k * half_pi / 2 + sign * Fraction(1, 10**e) for k in (*range(-9, 10), 1000, -10**9)
              for e in (0, dp // 2, dp, dp + 4, dp + 9) for sign in (-1, 0, 1)]
    angles += map(Fraction, ("0", "1e-30", "-1e-200", "1e14", "-1e30", "1e100", "123456789e80"))
    angles += [uniform(rng, -100, 100, 40) for _ in range(n)]
    angles += [rng.randrange(-950000, 950000) * half_pi for _ in range(n // 4)]
    for given in angles:
        x = kernels.call("double", [given], 1, dp)[0] if of_doubles else given
        if not options or abs(x) <= (1500000 if of_doubles else 10**15):
            found = kernels.call("sincos", [given], 2, dp, **options)
            with mpmath.workdps(2 * DIGITS):
                true = exact(mpmath.sin(mp(x))), exact(mpmath.cos(mp(x)))
            unit = Fraction(max(1, abs(x)) if options else 1) / 10**dp
            yield from ((y - t) / (Fraction(1, 2**51) if of_doubles else unit)
                        for y, t in zip(found, true))


def intervals(rng, n, dp, far=False, **options):
    for low, high in boxes(rng, n):
        size = max(1, abs(low), abs(high))
        if (size > 100) == far:
            bounds = kernels.call("bound_sincos", [low, high], 4, dp, **options)
            for function, lo, hi in ((mpmath.sin, *bounds[:2]), (mpmath.cos, *bounds[2:])):
                least, largest = true_range(function, low, high)
                for slack, bound in ((least - lo, lo), (hi - largest, hi)):
                    if abs(bound) < 1 or not 0 <= 10**dp * slack < 1:   # else an extremum: exact
                        yield 10**dp * slack / (size if options else 1)


def matrices(rng, n):
    """Plain ones, needles, nearly singular ones."""
    one = [[Fraction(j == k) for k in range(4)] for j in range(4)]
    yield from (one, one[::-1], [[x / 10**12 for x in row] for row in one],
                [[x + (j + k)**2 for k, x in enumerate(row)] for j, row in enumerate(one)],
                [[1 + x / 10**30 for x in one[0]], [Fraction(1)] * 4, *one[2:]])
    for i in range(n):
        scale, tilt = (Fraction(1, 10**rng.randrange(0, last)) for last in (12, 20))
        matrix = [[decimal(uniform(rng, -1, 1) * scale) for _ in range(4)] for _ in range(4)]
        yield [[x, decimal(x + tilt * y), *rest] for x, y, *rest in matrix] if i % 3 else matrix


def inverses(rng, n, dp, name, want, **options):
    for matrix in matrices(rng, n):
        try:
            *found, bound = kernels.call(name, sum(matrix, []), 17, dp, **options)
        except ArithmeticError:                 # given up
            continue
        inverse = exact_inverse(matrix)
        true = sum(inverse, [])
        error = max(abs(x - t) for x, t in zip(found, true))
        if options:                             # relative, and to the condition number
            norms = [max(sum(map(abs, row)) for row in m) for m in (matrix, inverse)]
            yield 10**dp * error / max(map(abs, true)) / norms[0] / norms[1]
        elif want == "bound":
            yield 10**dp * bound
        elif error:
            yield bound / error


def suites(rng, n, dp, wanted, kind="point", **options):
    """Of trace, least and largest eigenvalue of beta those that are wanted."""
    for i in range(n):
        centre, matrix = list_prism(rng, rng.choice(("3", "0.3", "0.03")), (-2, 2))
        centre = [x * (i % 50 > 0) for x in centre]             # all zero now and then
        if kind == "equal":
            centre[1:3], centre[6] = [centre[0], Fraction(0)], centre[5]
        prism = (centre, matrix if kind == "prism" else NO_WIDTHS)
        bounds = kernels.btrace(prism, dp, **options), *kernels.Blams(prism, dp, **options)
        true = []
        for _ in range(30 if kind == "prism" else 1):
            m = beta_at(point_of(prism, cube_point(rng)))
            true.append([exact(x) for x in (m[0] + m[2], *eigenvalues(m))])
        for j in wanted:
            low, high = (end(x[j] for x in true) for end in (min, max))
            unit = Fraction(1, 10**(dp // 2 if kind == "equal" else dp))
            unit *= max(1, abs(centre[5]) + abs(centre[6])) if options else 1
            if kind == "prism":
                unit = high - low if high - low > Fraction(1, 10**5) else 0
            elif kind == "apart":
                unit *= true[0][2] - true[0][1] > Fraction(1, 10)
            if unit:
                yield from (x / unit for x in (low - bounds[j][0], bounds[j][1] - high))


def torus(rng, n, dp, cases, largest=0, **options):
    for i in range(len(cases) + n):
        scale = 10**rng.randrange(largest + 1)
        ranges = cases[i] if i < len(cases) else \
            [rng.choice((-scale, scale)) * decimal(uniform(rng, "0.1", 1), 6) for _ in range(3)]
        ranges = [tuple(map(Fraction, x if isinstance(x, tuple) else (x, x))) for x in ranges]
        tolerance = Fraction("5e-7") + 2 * (1 + sum(max(map(abs, x)) for x in ranges)) / 10**12
        maxima = [grid_maxima(*map(float, corner)) for corner in product(*map(set, ranges))]
        for bound, true in zip(kernels.torus(*ranges, dp, **options), map(max, zip(*maxima))):
            yield (bound - Fraction(true)) / tolerance


def point_images(rng, n, dp, want, **options):
    for i in range(n):
        centre = list_prism(rng, parameters=rng.choice(((-1, 1), (-10**5, 10**5))))[0]
        centre = [x * (i % 50 > 0) for x in centre]
        try:
            image, true = kernels.image((centre, NO_WIDTHS), dp, **options), step(centre)
        except ArithmeticError:                 # singular: undecided
            continue
        unit = (1 + sum(map(abs, centre[:3]))) / Fraction(10**dp)
        unit *= max(1, *map(abs, centre[3:])) if options else 1
        for j in (5, 6):
            error = image[0][j] - true[j]
            yield (error if want == "error" else sum(map(abs, image[1][j])) - abs(error)) / unit


def second_prism(rng):
    """The image of a prism of the list."""
    while True:
        prism = list_prism(rng, "0.01", ("0.2", "0.4"))
        if prism[1][5][5] and prism[1][6][6]:
            return kernels.image(prism, 35)


def images(rng, n, dp, make, want, **options):
    for _ in range(n):
        prism = make(rng)
        try:
            image = kernels.image(prism, dp, **options)
        except ArithmeticError:                 # singular: undecided
            continue
        centre, etas = step(prism[0]), [cube_point(rng) for _ in range(6)]
        moved = [step([c + row[k] for c, row in zip(*prism)]) for k in range(7)]
        for j in (5, 6):                        # the corners that the linear map sends furthest
            etas += [[Fraction(sign if x[j] >= centre[j] else -sign) for x in moved]
                     for sign in (-1, 1)]
        found = [step(point_of(prism, eta)) for eta in etas]
        if want == "widths":
            for j in (5, 6):
                extent = max(x[j] for x in found) - min(x[j] for x in found)
                if extent:
                    yield 2 * sum(map(abs, image[1][j])) / extent
        elif not options or all(prism[1][j][j] for j in range(3)):
            # fixed form: u' = v, so corners are corners again but in the columns of u
            columns = slice(3, 5 if make is list_prism else 7)
            inside = cube_of(image)
            worst = max(outside(inside, x) for x in found)
            yield exact(-worst if worst > CLOSE else 1 - max(
                abs(e) for x in found for e in inside(x)[columns]))


TORI = [(0, 0, 0), (1, 0, 0), (0, "-0.25", 0), ("0.2", "0.5", "0.6"), ("1e-9", 0, "1e-9"),
        (0, 0, "0.5"), (("0.30725", "0.30975"), ("0.30725", "0.30975"), ("0.6145", "0.6195")),
        (("-1", "1"),) * 3, (("-0.4", "-0.1"), ("0.2", "0.3"), ("-0.7", "-0.5"))]
LARGE = [(100, -30, 55), ("1e5", "2e4", "-1e5"), ("1e9", "1e9", "1e9"), (0, "1e6", 0)]
FLAT = [(0, 0, 100)]


def prisms(rng):
    return thesis(draw(rng))


def rests(rng, n, dp, **options):
    yield from (exact(rest / off) for _, measured, bounds in displacements(rng, n, prisms)
                for rest, off in zip(bounds[0][:2], measured[0]) if off > 1e-30)


def witnesses(rng, n, dp, **options):
    yield from (exact((bound - max(totals)) / abs(max(totals)))
                for _, bound, totals in variations(rng, n, prisms))


TOLERANCE = "tolerances, 5e-7 + 1e-12 (2 + 2 (\\|a\\| + \\|b\\| + \\|c\\|))"
CENTRE_ERR = "times 1 + \\|a\\| + \\|b\\| + \\|c\\| places"
GAUSS, ROOTS = "Gauss-Jordan, full pivoting; gauss.inc", "(Tr beta -+ sqrt(disc)) / 2; lambda.inc"
BRANCH, ROTOR = "branch and bound; model/torus.c", "column rotor (cr-rows); cr_fatten.inc, cr_rows.inc"
FIXED = "fixed form (A-blocks, ff-ests); ff_fatten.inc, ff_rows.inc"
DIRECTED = ("APM_DOWN never more than the true value, APM_UP never less, APM_TRUNC never more in "
            "magnitude; each is within 10^-dp of the truth")
HOLDS, HALF, WIDTHS = "pz_prime contains G(pz)", "half-widths", "sampled widths"
LEAST = "the least and the largest eigenvalue of beta"
ALL, EXACT, DOUBLE = list(DP), list(DP)[:2], list(DP)[2:]

# operation, algorithm, what csrc promises, that is: from, to (None: no limit), in this unit;
# measurement with its keywords, for which arithmetics, random cases
ROWS = [
    ("quotient in each direction", "integer division; apm.c", DIRECTED,
     0, 1, "places", quotients, {}, EXACT, 2000),
    ("square root in each direction", "integer square root; apm.c", DIRECTED,
     0, 1, "places", roots, {}, EXACT, 2000),
    ("pi to 1, 2, ... places", "Machin's formula; special.c", "0 < pi - r < 10^-dp",
     0, 1, "places", pi, {}, EXACT, 0),
    ("sine, cosine", "reduction, halving, Taylor series (reducedSin, trig-error); special.c",
     "\\|s - sin x\\| <= 10^-dp and \\|c - cos x\\| <= 10^-dp",
     -1, 1, "places", sines, {}, ALL, 3000),
    ("sine, cosine of a double to 1.5e6", "reduction in three parts, Taylor series; sine.h",
     "\\|s - sin x\\| <= SINE_ERROR and \\|c - cos x\\| <= SINE_ERROR, 0x1p-51",
     -1, 1, "times 2^-51", sines, {"of_doubles": True}, DOUBLE, 6000),
    ("sine, cosine over an interval, to 100", "values at the ends, extrema by turns; bd_trig.inc",
     "every value of the wave on the interval lies in r",
     0, None, "places", intervals, {}, ALL, 8000),
    ("sine, cosine over an interval, 100 to 10^25", "turns are known to dp places; bd_trig.inc",
     "the same", 0, None, "places", intervals, {"far": True}, EXACT, 8000),
    ("inverse of a 4 x 4 matrix: inverse_err", GAUSS,
     "each entry off by at most inverse_err, which is at most 2 ulp",
     0, 2, "places", inverses, {"name": "inverse", "want": "bound"}, ALL, 800),
    ("inverse of a 4 x 4 matrix: inverse_err / error", GAUSS, "the same",
     1, None, "", inverses, {"name": "inverse", "want": "ratio"}, EXACT, 800),
    ("one try, no digits to spare: err / error", GAUSS,
     "err = a bound of the error of every entry",
     1, None, "", inverses, {"name": "gauss_jordan", "want": "ratio"}, EXACT, 2000),
    ("trace of beta at a point", "sum of waves; trace.inc", "r encloses Tr beta",
     0, None, "places", suites, {"wanted": [0]}, ALL, 1000),
    ("trace of beta over a prism", "sum of waves; trace.inc", "r encloses Tr beta over the prism",
     0, None, WIDTHS, suites, {"wanted": [0], "kind": "prism"}, ALL, 300),
    ("eigenvalues of beta at a point, 0.1 apart", ROOTS, LEAST,
     0, None, "places", suites, {"wanted": [1, 2], "kind": "apart"}, ALL, 1000),
    ("eigenvalues of beta at a point, equal", ROOTS, LEAST,
     0, None, "times 10^-floor(dp/2)", suites, {"wanted": [1, 2], "kind": "equal"}, ALL, 1000),
    ("eigenvalues of beta over a prism", ROOTS, "over the prism: " + LEAST,
     0, None, WIDTHS, suites, {"wanted": [1, 2], "kind": "prism"}, ALL, 300),
    ("T, B over the torus, parameters to 1", BRANCH,
     "no less than the largest trace (or eigenvalue), and within a tolerance of it",
     0, 1, TOLERANCE, torus, {"cases": TORI}, ALL, 20),
    ("T, B over the torus, parameters to 10^9", BRANCH,
     "the same",
     0, 1, TOLERANCE, torus, {"cases": LARGE, "largest": 9}, ALL, 10),
    ("T, B over the torus, c = 100 alone", BRANCH,
     "a ridge, on which it may be looser, and still a bound",
     0, None, TOLERANCE, torus, {"cases": FLAT}, ALL, 0),
    ("image of a point: its centre", "equation code-map; map.inc",
     "each coordinate of v' is off by at most centre_err",
     -1, 1, CENTRE_ERR, point_images, {"want": "error"}, ALL, 500),
    ("image of a point: widths less error", FIXED, HOLDS,
     0, None, CENTRE_ERR, point_images, {"want": "reach"}, ALL, 500),
    ("image of a prism of the list: slack in u", FIXED, HOLDS,
     0, None, HALF, images, {"make": list_prism, "want": "slack"}, ALL, 150),
    ("image of a prism of the list: widths", FIXED, HOLDS,
     1, None, WIDTHS, images, {"make": list_prism, "want": "widths"}, ALL, 300),
    ("image of an image: slack", ROTOR, HOLDS,
     0, None, HALF, images, {"make": second_prism, "want": "slack"}, ALL, 150),
    ("image of an image: widths", ROTOR, HOLDS,
     1, None, WIDTHS, images, {"make": second_prism, "want": "widths"}, ALL, 300),
    ("image of any prism: slack", ROTOR, HOLDS,
     0, None, HALF, images, {"make": random_prism, "want": "slack"}, ALL, 150),
    ("image of any prism: widths", ROTOR, HOLDS,
     1, None, WIDTHS, images, {"make": random_prism, "want": "widths"}, ALL, 300),
    ("orbit of a prism, 1 to 8 steps either way: rest / error", "factors of the map; orbit.c",
     "x[j] + D[j], D[j] = L[j] e + T[j][e, e] + r[j], \\|r[j]\\| <= rest",
     1, None, "", rests, {}, DOUBLE, 2000),
    ("second variation over a prism: bound less truth", "witness and multipliers; bound.c",
     "bound >= (1) over the whole prism",
     0, None, "true values", witnesses, {}, DOUBLE, 2000),
]

HEAD = """\
# How accurate the rigorous routines are

Each number is the distance of a bound or a result from the truth, in the unit of its row. The truth
is rational arithmetic or mpmath with %d digits. A cell gives the least and the largest distance
seen, rounded outwards to three digits. Where nothing limits the distance upwards, it also gives the
median, in brackets. A place is 10^-dp with dp places. Double precision promises only the rows of
csrc/loewner and sine.h; its unit is 10^-15 relative to the arguments. (For the inverse, the error
is relative to its largest entry times the condition number.)
"""
COLUMNS = ("operation", "algorithm", "promised in csrc", "limits", *DP, "cases")


def digits(x, rounding):
    """Three significant digits, rounded in that direction."""
    x = Fraction(x)
    x = Context(prec=3, rounding=rounding).divide(x.numerator, x.denominator)
    return re.sub(r"e([+-])0*(\d+)", lambda e: "e" + e[1].strip("+") + e[2], "%.3g" % x)


def measured(row, times, arithmetic):
    """The distances of a row in one of the arithmetics."""
    operation, measure, keywords, arithmetics, n = row[0], *row[6:]
    options = {"arithmetic": "double"} if arithmetic == "double" else {}
    return list(measure(rng_for("%d %s" % (SEED, operation)), int(n * times), DP[arithmetic],
                        **keywords, **options)) if arithmetic in arithmetics else []


def kept(row, arithmetic, seen):
    """Are these within what csrc promises, if it does?"""
    low, high, arithmetics = row[3], row[4], row[8]
    return not seen or arithmetic == "double" and arithmetics is not DOUBLE or \
        min(seen) >= low and (high is None or max(seen) <= high)


def main(times):
    mpmath.mp.dps = DIGITS
    broken = []
    print(HEAD % DIGITS)
    print("|%s|\n|%s|" % ("|".join(COLUMNS), "|".join(["-"] * (len(COLUMNS) - 1) + ["-:"])))
    for row in ROWS:
        operation, algorithm, promise, low, high, unit = row[:6]
        limits = "at least %d" % low if high is None else "%d to %d" % (low, high)
        cells, cases = [operation, algorithm, promise, ("%s %s" % (limits, unit)).strip()], 0
        for arithmetic in DP:
            seen = measured(row, times, arithmetic)
            cells.append("%s to %s" % (digits(min(seen), ROUND_FLOOR),
                                       digits(max(seen), ROUND_CEILING)) if seen else "")
            if seen and high is None:
                cells[-1] += " (%s)" % digits(median(seen), ROUND_HALF_EVEN)
            if not kept(row, arithmetic, seen):
                cells[-1] = "**%s**" % cells[-1]
                broken.append("%s, %s" % (operation, arithmetic))
            cases += len(seen)
        print("| %s | %s |" % (" | ".join(cells), "{:,}".format(cases)), flush=True)
    print("\nSeed %d" % SEED)
    for where in broken:
        print("%s: outside what is promised" % where, file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1))
