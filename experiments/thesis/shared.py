"""What several of the thesis's figures share: rotation vectors, families of states, and words."""

from collections import Counter
from fractions import Fraction

from converse import orbits
from converse.draw.plot import BLUE, DARK, VERMILLION
from converse.orbits.pictures import LABELS
from converse.orbits.solver import Family, follow, step_of, straight
from converse.storage.files import ConverseError

# (sqrt 5 - 1)/2, and (tau^-2, tau^-1) with tau^3 = tau + 1, rounded down to 60 digits.
GOLDEN = Fraction("0.618033988749894848204586834365638117720309179805762862135448")
SPIRAL_MEAN = (Fraction("0.569840290998053265911399958119568648839797439128940220544730"),
               Fraction("0.754877666246692760049508896358528691894606617772793143989283"))
SPIRAL = (1432, 1897), 2513             # near SPIRAL_MEAN
TENTH = (377, 2330), 3770               # near (1/10, GOLDEN)
STEPS = tuple(k / 400 for k in range(17))           # eps, where the thesis does not say
TOP, LONGEST, SHORTEST = STEPS[-1], 0.00125, 1e-5   # of Families.resolved: where it ends, its steps
CHANGE = 0.02                           # of a measure, above which a step is halved
NAMES = {"trig": "trigonometric", "poly": "polynomial", "ff": "fast-Froeschlé"}
COLOURS = {"trig": DARK, "poly": BLUE, "ff": VERMILLION}
HOW = "Found by continuation from ε = 0 in steps of at most %g.  %s" % (
    step_of(orbits.trig), LABELS)       # those of poly and ff are as long
RESOLVED = ("Found by continuation from ε = 0 in steps from %g to %g, short ones where much "
            "changes.  %s" % (LONGEST, SHORTEST, LABELS))


class Families:
    """Families of states, each computed when it is first needed and then kept."""

    def __init__(self):
        self.found = {}

    def __call__(self, potential, vector, eps=STEPS):
        key = potential, vector, eps
        if key not in self.found:
            self.found[key] = follow(potential, *vector, eps)
        return self.found[key]

    def at(self, potential, vector, eps):
        """The state at an eps, which need not be one of STEPS."""
        steps = STEPS if eps in STEPS else (eps,)
        return self(potential, vector, steps)[steps.index(eps)]

    def resolved(self, potential, vector):
        """The family found by continuation from eps 0 to TOP in adaptive steps, from LONGEST to
        SHORTEST.  A step is halved if an exponent exceeds 1/q at one of its ends only, if an
        exponent or the largest displacement changes by more than CHANGE, or if the solver fails.

        The displacement is left out where a phase is arbitrary, since it depends on the phase.
        ConverseError: the solver fails in the shortest step."""
        key = potential, vector
        if key not in self.found:
            state = straight(potential, *vector)
            states, step = [state], LONGEST
            while state.eps < TOP:
                there = min(state.eps + step, TOP)
                try:
                    after = state.relax(there)
                except ConverseError:
                    if step <= SHORTEST:
                        raise
                    step /= 2
                    continue
                if step > SHORTEST and self._coarse(state, after):
                    step /= 2
                    continue
                state = after
                states.append(state)
                step = min(2 * step, LONGEST)
            self.found[key] = Family(tuple(states))
        return self.found[key]

    @staticmethod
    def _coarse(before, after):
        """Whether the step between two states is to be halved."""
        hyperbolic = (after.exponents > 1 / after.q) != (before.exponents > 1 / before.q)
        changed = abs(after.exponents - before.exponents) > CHANGE
        moved = abs(after.deviation.from_start - before.deviation.from_start) > CHANGE
        return hyperbolic.any() or changed.any() or (
            moved and not after.undetermined and not before.undetermined)


def labels(states):
    """How many states there are of each kind."""
    count = Counter(state.label for state in states)
    return "Labels of the states: %s." % ", ".join("%s (%d)" % item for item in count.items())


def chosen(first_known=False):
    """Says that eps was chosen here, except the first one if the thesis names it."""
    if first_known:
        return "The first ε is the thesis's; it says no other, what follows was chosen here."
    return "The thesis does not say the ε; these were chosen here."
