"""What doubles show of an orbit, and of the pass beside a minimum, in lines."""

import math

from .pictures import exponent_text
from .proved import action_words, map_words

LARGE = 1e10                            # Stability indices above it are given by their logarithm.
MEANINGS = {                            # of labels
    "minimum": "floating point, not proved: a local minimum of the action, perhaps not global",
    "saddle": "floating point: its action can be lowered, perhaps when it is run through often",
    "stationary": "floating point: rounding hides whether it is a minimum",
    "not stationary": "not an orbit",
}


def header(state):
    """The lines that are the same for all states of a report."""
    potential = state.potential
    return ("Map : %s, angles of period %s\n"
            "Potential : %s\nV(%s) : %s\n"
            "Type : %s, rotation vector %s\n" % (
                map_words(potential), "1" if potential.period == 1 else "2 pi", potential.name,
                potential.letters[0], potential.formula, state.type_text,
                _numbers(state.rotation)))


def _numbers(values):
    return ", ".join("%.10g" % x for x in values)


def of_state(state):
    """See PeriodicOrbit.report."""
    return header(state) + report(state)


def of_family(family):
    """See Family.report."""
    return header(family[0]) + "\n" + "\n".join(map(report, family)) if len(family) else ""


def report(state):
    """The lines of one state."""
    lines = [
        "eps : %r" % state.eps,
        "State : %s (%s)" % (state.label, MEANINGS[state.label]),
        "%s : %.12g" % (action_words(state.potential), state.action),
        "Exponents : " + ", ".join(exponent_text(state, x, 10) for x in state.exponents),
        ("Residue : %.10g" % state.residue if state.potential.n == 1 else
         "Stability indices : " + ", ".join(map(_index_text, state.indices))),
        "Gradient : largest %.2g, root mean square %.2g" % (state.shadow, state.grad_size),
        "Deviation : %.10g from the line through x_0, %.10g from the line at eps 0"
        % state.deviation,
        "Near-null directions : " + ("%d, along which the points can be moved at almost no cost"
                                     % state.undetermined if state.undetermined else "none")]
    return "\n".join(lines) + "\n"


def _index_text(rho):
    """A stability index; a large one by its decimal logarithm."""
    if isinstance(rho, complex) or not abs(rho) > LARGE:
        return format(rho, ".10g")
    return "%s10^%.4f" % ("-" if rho < 0 else "", math.log10(abs(rho)))


def pass_report(pair):
    """The pass of a Pair, in lines."""
    towards = "towards the neighbour displaced by 1/%d" % pair.minimum.q
    if pair.minimax.label != "saddle":
        return "Pass : too flat for doubles, %s\n" % towards
    return "Pass : saddle, %s\nResidue of the minimax orbit : %.10g\nFlux : %.10g\n" % (
        towards, pair.minimax.residue, pair.flux)
