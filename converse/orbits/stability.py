"""The linear map once round an orbit (monodromy), its multipliers and Greene's residue.

DF^q has eigenvalues l and 1/l in n pairs; rho = l + 1/l are the stability indices (Broucke 1969;
Howard and MacKay 1987), and (2 - rho)/4 is Greene's residue (Greene 1979).  The product of all
rho - 2 is the determinant of the Hessian of the action (MacKay and Meiss 1983).  Its pivots lose no
digits where the orbit is nearly parabolic, and keep the smaller index apart from the rounding of
the larger one.  For n = 2 the sum of the two rho - 2 is trace DF^q - 4.

A quantity that may exceed all doubles is kept as a logarithm, complex where it is not positive.
"""

from typing import NamedTuple

import numpy as np

from .limits import ANGLE_ROUNDING, DOUBLE_PLACES, MAX_LOG_EXCESS


class Monodromy(NamedTuple):
    """DF^q = matrix times e^log; the largest entry of matrix is 1 in size."""

    matrix: np.ndarray
    log: float


def product(steps):
    """The last of the matrices times ... times the first, as a Monodromy: pairs are multiplied,
    then pairs of these, and so on."""
    log = 0.0
    while True:
        size = np.abs(steps).max((1, 2))
        log += float(np.log(size).sum())
        steps = steps / size[:, None, None]
        if len(steps) == 1:
            return Monodromy(steps[0], log)
        pairs = steps[1::2] @ steps[:-1:2]
        steps = np.concatenate([pairs, steps[-1:]]) if len(steps) % 2 else pairs


def log_weak_excess(bends):
    """log (rho - 2) of an orbit of one angle, the bends h = -eps V'' of whose points are so small
    that q times the sum of |h| is below 1.

    The Hessian's 2 + h has no digits of h; and where the bends cancel, the product of all of them
    may be what is left.  So the steps p += h x, x += p are made with integers, in units so small
    that the least double has 2^50 times as many units as all roundings together: each is of one
    unit, and grows to at most e q units."""
    one = 1 << DOUBLE_PLACES + 52 + 2 * len(bends).bit_length()
    ratios = [h.as_integer_ratio() for h in bends.tolist()]

    def once_round(x, p):
        for above, below in ratios:
            p += above * x // below
            x += p
        return x, p

    return log_of((once_round(one, 0)[0] + once_round(0, one)[1] - 2 * one) / one)


def log_of(x):
    """The complex logarithm of a real number; -inf of 0."""
    with np.errstate(divide="ignore"):
        return np.log(complex(x))


def log_excesses(monodromy, log_det):
    """log (rho - 2) of the n stability indices as complex numbers, the larger multiplier's
    first.  log_det: of the Hessian's determinant."""
    if len(monodromy.matrix) == 2:
        return np.array([log_det])
    log = log_of(np.trace(monodromy.matrix)) + monodromy.log
    if log.real < MAX_LOG_EXCESS:
        log = log_of(np.exp(log).real - 4)
    scale = max(log.real, log_det.real / 2)         # The sums below are in units of e^scale.
    if scale == -np.inf:
        return np.array([log, log])
    half = np.exp(log - scale).real / 2
    root = np.sqrt(half ** 2 - np.exp(log_det - 2 * scale).real + 0j)
    farther = log_of(half + (root if half >= 0 else -root)) + scale
    found = np.array([farther, farther.conjugate() if root.imag else log_det - farther])
    return found[np.argsort(-log_multipliers(found).real, kind="stable")]


def log_multipliers(log_excess):
    """log l of the eigenvalues l with l + 1/l = rho and |l| >= 1: rho - 2 = 4 sinh^2 (log l)/2."""
    root = np.exp(np.minimum(log_excess.real, MAX_LOG_EXCESS) / 2) * np.exp(log_excess.imag * 0.5j)
    log = np.where(log_excess.real > MAX_LOG_EXCESS, log_excess, 2 * np.arcsinh(root / 2))
    return np.where(log.real < 0, -log, log)


def beyond(log):
    """e^log, real where it is: infinite where it is beyond doubles."""
    with np.errstate(over="ignore"):
        size = np.exp(log.real)
    turned = [(-1.0) ** round(y / np.pi) if abs(np.sin(y)) < ANGLE_ROUNDING else np.exp(1j * y)
              for y in log.imag]
    with np.errstate(invalid="ignore"):
        values = np.array([x * y for x, y in zip(size, turned)])
    return values
