"""Onsets: where the first exponent of the orbit that continuation follows exceeds a bound."""

from typing import NamedTuple, Optional

from ..storage.files import ConverseError
from .limits import (MAX_EPS_STEPS, MAX_ONSET_GRADIENT, MAX_ONSET_HALVINGS, MAX_ONSET_STEPS,
                     MAX_PIVOTS, ONSET_TIMES_CURVATURE)
from .potential import Numerators, Source, finite, known
from .solver import straight
from .state import PeriodicOrbit


class Onset(NamedTuple):
    """The states on both sides of an onset.

    Attributes
    ----------
    below : PeriodicOrbit
        The last state below the onset.
    above : PeriodicOrbit or None
        The first state above the onset; None if none was found.
    """

    below: PeriodicOrbit
    above: Optional[PeriodicOrbit]


def onset(potential: Source, p: Numerators, q: int, exponent: Optional[float] = None,
          step: Optional[float] = None, width: Optional[float] = None,
          top: Optional[float] = None) -> Onset:
    """The onset of the orbit of type (p, q) that continuation from eps 0 follows.

    Above its onset the orbit is a minimum whose first Lyapunov exponent, the largest, exceeds
    `exponent`.  (Minima are usually hyperbolic before their onset, with exponents that may be far
    below what doubles see; prove() encloses them.)

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
    q : int
    exponent : float, optional
        Per iterate; by default 1/q, so that one period stretches e-fold.
    step : float, optional
        Of eps: the steps with which the first such minimum is looked for.
    width : float, optional
        To this difference of eps the onset is cut down.
    top : float, optional
        The eps where the search ends.  Defaults of these three are ONSET_TIMES_CURVATURE divided by
        potential.curvature, to one digit.

    Returns
    -------
    Onset
        The states below and above; their eps are at most `width` apart.

    Raises
    ------
    ValueError
        The exponent is too small for doubles to show.
    ConverseError
        Continuation loses the branch.

    Notes
    -----
    With growing q the stretching along the orbits beside a smooth torus vanishes, and beside the
    remnants of a torus it grows.  At break-up it does neither.  For the golden torus of
    the standard map (Greene: residue -1/4) it is e^0.96.  So the onsets of approximants tend to
    where the torus breaks up: there they are within 3e-4 for q >= 233.  An exponent that is the
    same for all q is early for small and late for large ones.  Onsets are evidence, not proof, that
    a torus is near an orbit, or that none is.
    """
    potential = known(potential)
    step, width, top = finite("step, width and top", [
        float("%.0e" % (x / (potential.curvature or 1))) if y is None else y
        for x, y in zip(ONSET_TIMES_CURVATURE, (step, width, top))])
    if not (0 < width <= step and 0 < top <= MAX_EPS_STEPS * step):
        raise ValueError("step, width and top are positive, the width at most the step, and the "
                         "top at most %d steps, not %r, %r, %r"
                         % (MAX_EPS_STEPS, step, width, top))
    q = straight(potential, p, q).q
    limit, = finite("exponent", [1 / q if exponent is None else exponent])
    if not limit >= 2 / max(MAX_PIVOTS, 5 * q):
        raise ValueError("an exponent of %r is too small to be seen" % limit)
    below, above, k = straight(potential, p, q), None, 0
    while above is None or above.eps - below.eps > width:
        if above is None:
            if below.eps >= top:
                break
            k += 1
            eps = min(k * step, top)
        else:
            eps = (below.eps + above.eps) / 2
            if not below.eps < eps < above.eps:         # no double is between them
                break
        state = _further(below, eps)
        if state.exponents[0] > limit and state.label == "minimum":
            above = state
        else:
            below = state
    return Onset(below, above)


def _further(state, eps, halvings=MAX_ONSET_HALVINGS):
    """The state at a larger eps, in smaller steps if the solver fails."""
    try:
        return state.relax(eps, tol=MAX_ONSET_GRADIENT, max_steps=MAX_ONSET_STEPS)
    except ConverseError:
        if not halvings:
            raise
    middle = _further(state, (state.eps + eps) / 2, halvings - 1)
    return _further(middle, eps, halvings - 1)
