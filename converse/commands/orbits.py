"""The command: converse-orbits POTENTIAL TYPE EPS."""

import math
import os
import re
import sys

from ..storage import files
from ..storage.files import ConverseError, plain
from .common import SIGNALS, Parser, ProgressLine, check_figure, command, ending, say

COMMAND = "converse-orbits"
POTENTIALS = "trig", "froeschle", "standard"
MOST_EPS = 10000                        # values of eps
ENDING = ending(
    "converse-orbits standard 89/233 0.9 0.97 --minimax --prove -g ghost.svg",
    "converse-tori      proves that a torus exists\n"
    "converse-portrait  shows where in phase space a map of one angle has no circle\n"
    "converse           proves that there are no tori", (
        (0, "all was found that was asked for"),
        (1, "an orbit was not found, is not a minimum, or is not proved with --prove"),
        (2, "bad usage, input or file"), SIGNALS))
POTENTIAL = ("trig, froeschle, standard, or an input file: JSON of the harmonics of V "
             "(manual: reference/inputs)")
AT = "the value of a parameter of the file; may be given again"
NO_MINIMUM = "saddle", "stationary", "not stationary"


# ---- what is read

def _eps(text):
    """'0.01' or 'LOW:HIGH:STEP': a list of floats."""
    from ..model.exact import exact
    try:
        ends = [exact(word.strip()) for word in text.split(":")]
        if len(ends) not in (1, 3) or not all(abs(x) < 10 ** 9 for x in ends):
            raise ValueError
    except ValueError:
        raise ValueError("'%s' is neither a number below 10^9 nor a range LOW:HIGH:STEP of such "
                         "numbers" % text) from None
    if len(ends) == 1:
        return [float(ends[0])]
    low, high, step = ends
    if not step or not 0 <= (high - low) / step < MOST_EPS:
        raise ValueError("'%s' is a range of no values, or of more than %d" % (text, MOST_EPS))
    return [float(low + k * step) for k in range(int((high - low) / step) + 1)]


def _vector(text):
    """'1432,1897/2513': ((1432, 1897), 2513)."""
    match = re.fullmatch(r"\(?(-?\d{1,9})(?:, *(-?\d{1,9}))?\)?/(\d{1,9})", text.strip(), re.ASCII)
    if not match or not int(match[3]):
        raise ValueError("'%s' is not a type: write p0,p1/q, or p/q for one angle, whole numbers "
                         "of at most 9 digits" % text)
    return tuple(int(p) for p in match.groups()[:2] if p is not None), int(match[3])


def _value(text):
    """'K=0.6': ('K', 0.6), exactly."""
    from ..model.exact import exact
    name, _, number = text.partition("=")
    try:
        return name.strip(), exact(number.strip())
    except ValueError:
        raise ValueError("'%s' is not a value of a parameter: write NAME=NUMBER" % text) from None


def read_potential(source, at=()):
    """One of those with a name, or that of an input file, with its parameters at these values."""
    from converse import orbits
    from converse.model.map import SymplecticMap

    if source in POTENTIALS:
        if at:
            raise ConverseError("%s has no parameters; leave out --at" % source)
        return getattr(orbits, source)
    if not os.path.exists(source):
        raise ConverseError("'%s' is neither a potential nor a file; there are %s, or a JSON file "
                            "of harmonics (manual: reference/inputs)" % (
                                source, ", ".join(POTENTIALS)))
    found = SymplecticMap.read(source)
    try:
        return orbits.potential.known(found.at(**dict(at)))
    except ValueError as error:
        raise ConverseError("%s: %s" % (source, error)) from None


def parser():
    p = Parser(prog=COMMAND, epilog=ENDING, description=(
        "Finds periodic orbits of least action of the map x' = x + p', p' = p - eps grad V(x), "
        "all of one type, by continuation from eps 0, and prints their properties.  Angles have "
        "period 1; those of an input file, and of its results, have period 2 pi."))
    p.add_argument("potential", metavar="POTENTIAL", help=POTENTIAL)
    p.add_argument("type", metavar="TYPE", type=_vector, help="p0,p1/q, such as 1432,1897/2513; "
                   "p/q for one angle")
    p.add_argument("eps", metavar="EPS", type=_eps, nargs="+", help="the factor of the "
                   "potential (1: the map of an input file), or LOW:HIGH:STEP; states are "
                   "followed from one value to the next")
    p.add_argument("--at", type=_value, metavar="NAME=VALUE", action="append", default=[],
                   help=AT)
    p.add_argument("--prove", action="store_true", help="prove that an orbit is near each "
                   "state and is a minimum; enclose its action and its exponents")
    p.add_argument("--minimax", action="store_true", help="find the pass to the neighbouring "
                   "minimum, and the flux; with --prove, prove both")
    p.add_argument("--points", metavar="FILE", help="write the points and momenta of the "
                   "states, as NPZ")
    p.add_argument("-g", "--graphics", metavar="FILE", help="draw the angles and the momenta of "
                   "the states: SVG, PNG or PDF by the name")
    return p


# ---- what is done

def _check_outputs(options):
    if options.points is not None:
        from ..orbits.points import ENDINGS
        files.check_output(options.points, "file of points", ENDINGS, [options.potential])
    check_figure(options, options.potential)
    if options.graphics is not None:
        from ..orbits.pictures import MOST_STATES
        if sum(map(len, options.eps)) > MOST_STATES:
            raise ConverseError("a figure shows %d states at most; choose fewer eps, or no figure"
                                % MOST_STATES)


class _Finding:
    """The states that are found: each is reported, and proved if asked for, at once."""

    def __init__(self, options, line):
        self.options, self.line = options, line
        self.states = []
        self.drawn = []                 # of each state its proof or, if there is none, the state
        self.failed = False

    def tell(self, text):
        self.line.clear()
        say(text)

    def add(self, state):
        from ..orbits.proved import NotProved, prove
        from ..orbits.report import pass_report, report
        self.states.append(state)
        self.drawn.append(state)
        self.tell("\n" + report(state))
        self.failed |= state.label in NO_MINIMUM
        try:
            pair = state.minimax() if self.options.minimax else None
            if pair is not None:
                self.tell(pass_report(pair))
            if self.options.prove:
                proof = prove(state) if pair is None else pair.prove()
                self.drawn[-1] = proof if pair is None else proof.minimum
                self.tell(proof.report())
        except ConverseError as reason:
            self.tell("%s : %s\n" % ("Not proved" if isinstance(reason, NotProved) else "No pass",
                                     plain(str(reason))))
            self.failed = True


def run(options):
    from converse import orbits

    orbits.PeriodicOrbit                        # or a line that says what is missing
    potential = read_potential(options.potential, options.at)
    _check_outputs(options)

    from ..orbits.proved import balls
    from ..orbits.report import header
    from ..orbits.solver import follow, reached, straight

    if options.prove:
        balls()
    if options.minimax and (potential.n > 1 or math.gcd(*options.type[0], options.type[1]) > 1):
        raise ConverseError("--minimax is for types p/q of one angle, in lowest terms")
    eps = reached(potential, [x for each in options.eps for x in each])
    say(header(straight(potential, *options.type)))
    with ProgressLine(COMMAND) as line:
        found = _Finding(options, line)
        try:
            follow(potential, *options.type, eps, progress=lambda _, state: found.add(state),
                   on_step=lambda state: line(lambda: "at eps %g, %d of %d states found" % (
                       state.eps, len(found.states), len(eps))))
        except ConverseError as reason:
            found.tell("\nNot found : %s\n" % plain(str(reason)))
            found.failed = True
    if options.points is not None and found.states:
        from ..orbits.points import save
        save(found.states, options.points)
    if options.graphics is not None and found.states:
        from ..orbits.pictures import states_picture
        files.write(options.graphics, states_picture(found.drawn, files.ending(options.graphics)))
    return int(found.failed)


main = command(COMMAND, parser, run, lambda options: "no table, points or figure is written")

if __name__ == "__main__":
    sys.exit(main())
