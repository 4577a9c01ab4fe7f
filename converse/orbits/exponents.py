"""The Lyapunov exponents of a proved orbit, in balls: docs/proofs/proved-orbits.md, section 3.

The pivots D_j of the true orbit lie between two sequences of matrices, s_j <= D_j <= t_j, and its
exponents are (1/q) log |l|, l the eigenvalues of D_{q-1} ... D_0.
"""

from flint import arb, arb_mat

from .enclosure import ball, is_positive, lower, unit, upper
from .limits import MAX_CONES


def growth(chain, strict, away):
    """Enclosures (low, high) of log |l|, larger first, for every orbit whose blocks beta_j are
    within `away` of the blocks of the chain, an Enclosure; strict > away.  Also the sign of the l,
    which is 0 where they are complex or this is undecided.  None: the pivots could not be
    enclosed."""
    s, t = chain.below(ball(strict)), chain.above(ball(away), ball(strict))
    if s is None or t is None or not is_positive(t[0] - s[0]):
        return None
    det = _det(s)
    total = _ends(det.log())[0], _ends(_det(t).log())[1]
    if chain.n == 1:
        return (total,), 1
    half = total[0] / 2, total[1] / 2
    matrices, sign = _in_frames(s, t, _directions(s, 4 * chain.places))
    one = _of_cone(matrices)
    if one is not None:
        one = _ends(one[0].log())[0], _ends(one[1].log())[1]
        other = total[0] - one[1], total[1] - one[0]
        return (tuple(map(max, one, other)), tuple(map(min, one, other))), sign
    # No cone closes.  If (trace)^2 < 4 det, the eigenvalues are complex, and their moduli equal;
    # anyway the larger row sum bounds them.
    product = unit(2)
    for j in range(chain.q):
        product = matrices[j] * product
    trace = product[0, 0] + product[1, 1]
    if trace * trace < 4 * det:
        return (half, half), 0
    high = max(upper((abs(a) + abs(b)).upper().log()) for a, b in product.tolist())
    return ((half[0], high), (total[0] - high, half[1])), 0


def _ends(x):
    return lower(x), upper(x)


def _det(matrices):
    det = arb(1)
    for j in range(len(matrices)):
        det *= matrices[j].det()
    return det


def _directions(s, squarings):
    """About the directions that grow most, without radius: at point 0 the larger column of a high
    power of the product of all s, and at the following points as s carries it."""
    def scaled(x):
        return (x * (1 / max(map(abs, x.entries())))).mid()

    power = unit(2)
    for j in range(len(s)):
        power = scaled(s[j] * power)
    for _ in range(squarings):
        power = scaled(power * power)
    v = max((arb_mat(2, 1, list(column)) for column in zip(*power.tolist())),
            key=lambda v: float(abs(v[0, 0]) + abs(v[1, 0])))
    directions = []
    for j in range(len(s)):
        directions.append(v)
        v = scaled(s[j] * v)
    return directions


def _in_frames(s, t, directions):
    """Balls around the matrices that D_j are in the frames (v_j, Jv_j), J the quarter turn: D_j is
    within trace (t_j - s_j) of s_j.  The last frame is the first again, or its negative if the
    direction turned round: then the sign that is returned too is -1."""
    def frame(v):
        x, y = v.entries()
        return arb_mat(2, 2, [x, -y, y, x])

    frames = [frame(v) for v in directions]
    frames.append(frames[0])
    matrices = []
    for j in range(len(s)):
        wide = arb(0, (t[j] - s[j]).trace())
        D = s[j] + arb_mat(2, 2, [wide] * 4)
        after = frames[j + 1]
        matrices.append(after.transpose() * D * frames[j] * (1 / after.det()))
    sign = -1 if matrices[-1][0, 0] < 0 else 1
    matrices[-1] *= sign
    return matrices, sign


def _of_cone(matrices):
    """Two numbers around the modulus of an eigenvalue of the matrices' product.  None: no cone
    |y| <= kappa x was found that the whole round takes into itself.  The first guess is twice what
    becomes of the direction alone."""
    def carried(kappa):
        """The cone into which this one is taken, and bounds of the growth of x in it.  None: x may
        vanish.
        (kappa has all digits: a radius has nine, and the cone may shrink by less.)"""
        low = high = arb(1)
        for j in range(len(matrices)):
            a, b, c, d = matrices[j].entries()
            across = abs(b) * kappa
            if not a > across:
                return None
            low, high = (low * (a - across)).lower(), (high * (a + across)).upper()
            kappa = ((abs(c) + abs(d) * kappa) / (a - across)).upper()
        return kappa, low, high

    after = carried(arb(0))
    for n in range(MAX_CONES):
        if after is None:
            return None
        kappa = after[0] * (2 << min(n, 8))
        after = carried(kappa)
        if after is not None and after[0] <= kappa:
            return after[1:]
    return None
