"""The second variation along orbits, bounded in integers by Taylor models of first order.

A piece is a set of amplitudes and of (v0, v1): of each wave the middle and the parts of its
amplitude, and centres and half-widths of the angles.  A number that depends on the point of the
piece is enclosed as centre + sum of column * symbol, each symbol in [-1, 1]: first the symbols of
the three parameters and the two angles, two for the rounding of x*, then some for the errors of
each step.  The left side of (C3) is a sum of such numbers with known weights, so it is bounded as a
whole: effects that cancel, cancel.
"""

from .arith import PARAMETER_ERROR, SINE_ERROR, angle_of, forms
from .torus import NU_BITS, least

MAX_POINTS = 330                        # of an orbit
PARAMETERS, SYMBOLS = 3, 7              # of these; of these and all the others of a piece


class Point:
    """x[j] on all orbits of a piece: its centre x, its rows of columns, and models of p sin."""

    __slots__ = ("x", "rows", "angles", "reach", "sines", "beta")

    def __init__(self, fixed, waves, amplitudes, x, rows):
        self.x, self.rows = x, rows
        row0, row1 = rows
        self.angles = [fixed.sincos(angle_of(wave, x)) for wave in waves]
        self.reach = [sum([abs(k0 * p + k1 * q) for p, q in zip(row0, row1)])
                      for k0, k1, _ in waves]
        self.sines = [model(fixed.bits, *amplitude, s, c, rho) for amplitude, (s, c), rho
                      in zip(amplitudes, self.angles, self.reach)]
        p, q, r = forms(waves, [value / fixed.one for value, _, _, _ in self.sines])
        self.beta = 2 - p, -q, 2 - r        # at the centre, in double precision


def model(bits, p, parts, f, g, rho):
    """Encloses (p + sum of part e) (f' cos d + g' sin d) for |e| <= 1, |d| <= rho <= 2 and all f',
    g' within SINE_ERROR of f, g, as value + sum of slope e + tilt d + error: these four, the slopes
    as a list.

    cos d is in [1 - rho^2/2, 1], and |sin d - d| <= rho^3/6, so f cos d + g sin d is within
    bend = |f| rho^2/4 + |g| rho^3/6 + 2 SINE_ERROR of f (1 - rho^2/4) + g d.  With h, the sum of
    the |parts|, the error is (|p| + h) bend + h |g| rho; value, each slope, tilt d and the error
    lose 1 or 2 units each, and the amplitude is off by PARAMETER_ERROR, which the wave, at most 1,
    does not enlarge.
    """
    square, h = (rho * rho >> bits) + 1, sum(map(abs, parts))
    sag = f * square >> bits + 2
    bend = abs(sag) + (abs(g) * square * rho // 6 >> 2 * bits) + 2 * SINE_ERROR + 4
    error = ((abs(p) + h) * bend + ((h * abs(g) >> bits) + 1) * rho >> bits) \
        + PARAMETER_ERROR + 9
    return p * (f - sag) >> bits, [part * (f - sag) >> bits for part in parts], p * g >> bits, error


def step(fixed, waves, amplitudes, point, before, known):
    """The point after next: 2 x - before - V'(x).  Time may run either way: the map is reversible.

    -V'(x) is the sum of k g with g = p cos(angle).  Each g has a symbol for its error, all those
    that move x0 alone the same, and those that move x1 alone; these are new, after the known ones.
    The floor of each column costs a unit.
    """
    bits = fixed.bits
    models = [model(bits, *amplitude, c, -s, rho) for amplitude, (s, c), rho
              in zip(amplitudes, point.angles, point.reach)]
    p, q, r = forms(waves, [tilt for _, _, tilt, _ in models])
    p, r = (2 << bits) + p, (2 << bits) + r
    row0, row1, old0, old1 = [row + [0] * (known - len(row)) for row in point.rows + before.rows]
    new0 = [(p * u + q * v >> bits) - o for u, v, o in zip(row0, row1, old0)]
    new1 = [(q * u + r * v >> bits) - o for u, v, o in zip(row0, row1, old1)]
    x0, x1 = 2 * point.x[0] - before.x[0], 2 * point.x[1] - before.x[1]
    only0, only1, both0, both1 = known, known, [], []
    for (k0, k1, _), (value, slopes, _, error) in zip(waves, models):
        x0, x1 = x0 + k0 * value, x1 + k1 * value
        for m, slope in enumerate(slopes):
            new0[m] += k0 * slope
            new1[m] += k1 * slope
        if k1 == 0:
            only0 += abs(k0) * error
        elif k0 == 0:
            only1 += abs(k1) * error
        else:
            both0.append(k0 * error)
            both1.append(k1 * error)
    return Point(fixed, waves, amplitudes, (x0, x1),
                 (new0 + [only0, 0, *both0], new1 + [0, only1, *both1]))


def pivots(betas, l):
    """The recursion d = beta - l, then beta - 1/d, in double precision, up to the first d that is
    not above l, or to the end."""
    d, found = (1 / l, 0.0, 1 / l), []
    for b0, b1, b2 in betas:
        p, q, r = d
        det = p * r - q * q
        d = p, q, r = b0 - r / det, b1 + q / det, b2 - p / det
        found.append(d)
        if not (p > l and (p - l) * (r - l) > q * q):
            break
    return found


def witness(betas, l):
    """Vectors n of negative second variation at the centres of an orbit with these betas, or None.

    The recursion from the left falls below l at some site, that from the right at another, and
    all blocks between them are above it; if they cross, the part up to the left one is enough.
    Between them, where beta is least, n is the least eigenvector of what the others leave there;
    outwards n[j-1] = 1/d[j-1] n[j].  The last sites may go without.  Double precision: nothing
    rests on it.
    """
    left, end = pivots(betas, l), len(betas)
    fall = len(left) - 1
    p, q, r = left[-1]
    if p > l and (p - l) * (r - l) > q * q:
        return None
    right = pivots(betas[::-1], l)
    if end - len(right) > fall:
        end = len(left)
        right = pivots(betas[end - 1::-1], l)
    first = min(end - len(right), fall)
    site = min(range(first, fall + 1), key=lambda j: least(betas[j])[0])
    form = [d + e - b for d, e, b in zip(left[site], right[end - 1 - site], betas[site])]

    def outwards(side):
        m = n
        for p, q, r in side:
            det = p * r - q * q
            m = (r * m[0] - q * m[1]) / det, (p * m[1] - q * m[0]) / det
            yield m

    n = least(form)[1]
    return [*[*outwards(left[:site][::-1])][::-1], n, *outwards(right[:end - 1 - site][::-1])]


def second_variation(fixed, waves, l, orbit, vectors):
    """Bounds the left side of (C3) over a piece: (upper bound, columns of the symbols).

    All products are exact; the unit of the result is 2^-(2 bits + 2 NU_BITS).
    """
    bits = fixed.bits
    if len(vectors) > len(orbit):
        raise ValueError("a vector without its site")
    nu = [(round(u * 2 ** NU_BITS), round(v * 2 ** NU_BITS)) for u, v in vectors]
    centre = -l * sum(n * n for n in (*nu[0], *nu[-1]))
    centre -= 2 * sum(m[0] * n[0] + m[1] * n[1] for m, n in zip(nu, nu[1:])) << bits
    error, columns = 0, [0] * max(len(point.rows[0]) for point in orbit)
    for point, (n0, n1) in zip(orbit, nu):
        centre += 2 * (n0 * n0 + n1 * n1) << bits
        along0 = along1 = 0
        for (k0, k1, _), (value, slopes, tilt, loss) in zip(waves, point.sines):
            omega = (k0 * n0 + k1 * n1) ** 2
            centre -= omega * value
            error += omega * loss
            along0, along1 = along0 + omega * k0 * tilt, along1 + omega * k1 * tilt
            for m, slope in enumerate(slopes):
                columns[m] -= omega * slope << bits
        row0, row1 = point.rows
        columns[:len(row0)] = [k - along0 * p - along1 * q
                               for k, p, q in zip(columns, row0, row1)]
    return (centre + error << bits) + sum(map(abs, columns)), columns
