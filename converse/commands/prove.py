"""The command: converse [flags] < input > report."""

import argparse
import contextlib
import math
import os
import sys
from dataclasses import fields

from ..prover.settings import AS_PRINTED, REGION, SETTINGS, THEOREM, UNDECIDED, Settings
from ..storage import files
from ..storage.files import ConverseError
from .common import (INPUT, MAP, SIGNALS, TOGETHER, Parser, ProgressLine, add_files,
                     add_worker_options, check_figure, command, ending, kept, number, read_problem,
                     say, tell, whole_number, workers_of)

STATUS = {THEOREM: 0, UNDECIDED: 1, REGION: 3, AS_PRINTED: 4}
ENDING = ending(
    "converse --method loewner --together trig148.in -b trig148.proof\n"
    "converse-check trig148.proof\n"
    "(the input is one of those that converse --list-inputs names)",
    "converse-check     verifies the proof independently\n"
    "converse-tori      proves that there is a torus\n"
    "converse-map       finds for which values of a parameter there is none\n"
    "converse-portrait  shows where in phase space a map of one angle has no circle\n"
    "converse-orbits    finds periodic orbits, and proves them", (
        (0, "a theorem"), (1, "undecided"),
        (2, "bad usage, input or file; the result could not be saved; or the workers are gone"),
        (3, "a theorem for a part of the torus only"),
        (4, "as printed in the thesis, not a proof"), SIGNALS))
LEAF_WORDS = {"P": "proved", "S": "symmetric", "U": "undecided"}


class ListInputs(argparse.Action):
    """Prints the paths of the inputs that come with the package, and ends."""

    def __call__(self, parser, *_):
        package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        directory = os.path.join(package, "inputs")
        say("".join(os.path.join(directory, name) + "\n" for name in sorted(os.listdir(directory))))
        parser.exit()


def _decimal(text):
    from ..model.exact import decimal_text
    return decimal_text(number(text))


def parser():
    p = Parser(prog="converse", epilog=ENDING, description=(
        "Tries to prove that %s, has no invariant torus, for all parameters of a range at a time."
        % MAP))
    p.add_argument("input", nargs="?", help=INPUT + "; not needed with -r")
    add_files(p, "the proof, also an unfinished one,", "the prisms", (
        "continue the run whose file is FILE, with the input and the settings of that run, except "
        "that -d may be larger; FILE is kept up to date, unless -b names another"))
    p.add_argument("-t", "--verbose", action="store_true",
                   help="print a line for every decided prism, after the search")
    for each in fields(Settings):
        how = {key: value for key, value in each.metadata.items()
               if key in ("help", "metavar", "choices")}
        if "least" in each.metadata:
            how["type"] = whole_number(each.metadata["least"])
        elif isinstance(each.default, bool):
            how["action"] = "store_true"
        p.add_argument(*each.metadata["flags"], dest=each.name, default=None, **how)
    p.add_argument("--together", action="store_true",
                   help=TOGETHER + " (loewner)")
    p.add_argument("--xstar", nargs=2, type=_decimal, metavar=("X0", "X1"),
                   help="the starting point x*, angles in radians (default: the program chooses)")
    p.add_argument("--x2", type=_decimal, metavar="X2",
                   help="with --xstar, its third angle, of a map of three angles")
    add_worker_options(p, "parts")
    p.add_argument("--list-inputs", action=ListInputs, nargs=0,
                   help="print the paths of the input files that come with the program, and exit")
    return p


def _leaf_lines(proof):
    """The lines of -t: kind, centre and half-widths in radians, cuts."""
    from ..prover.tree import leaves
    for each in proof.trees:
        for leaf in leaves(each.problem, each.text):
            centre, half = (", ".join("%.10g" % (x * math.pi) for x in each)
                            for each in (leaf.centre, leaf.half))
            yield "%-9s (%s) +- (%s), %d cuts\n" % (
                LEAF_WORDS.get(leaf.kind, "linked"), centre, half, leaf.depth)


def progress_text(examined, counts):
    return "%s prisms proved; %.2f%% of parameters x torus done%s" % (
        format(counts.proved, ","), math.floor(1e4 * examined) / 100,
        ", %d undecided" % counts.undecided if counts.undecided else "")


def run(options):
    from ..prover.report import report
    from ..prover.run import prove  # it needs the C core, and says so where it is missing

    if options.x2 is not None:
        if options.xstar is None:
            raise ConverseError("--x2 is the third angle of x*; give the others by --xstar X0 X1")
        options.xstar.append(options.x2)
    with contextlib.suppress(AttributeError, OSError, ValueError):
        options.stdin = sys.stdin.fileno()
    check_figure(options, options.input, options.backup, options.restore, options.stdin)
    given = {name: getattr(options, name) for name in SETTINGS}
    if options.backup is not None:
        files.check_writable(options.backup, regular=True)
        files.check_new(options.backup, options.restore)

    problem = None
    if options.restore is None:
        problem = read_problem(options.input, together=options.together)
        if problem.by_ranges and not options.together:      # an input of 1989
            given["method"] = given["method"] or "thesis"
    elif options.input or options.together:
        raise ConverseError("-r continues a run as it was asked for; leave out the input and "
                            "--together")
    with ProgressLine() as line, workers_of(options) as workers:
        proof = prove(problem, xstar=options.xstar, backup=options.backup, resume=options.restore,
                      progress=lambda *at: line(lambda: progress_text(*at)), **workers, **given)
    if proof.as_printed:
        tell("--as-printed is a historical reconstruction, not a proof")
    for line in _leaf_lines(proof) if options.verbose else ():
        say(line)
    say(report(proof, options.backup or options.restore or ""))
    if options.graphics is not None:
        from ..draw import plot
        plot.write(proof, options.graphics)
    return STATUS[proof.conclusion]


main = command("converse", parser, run, kept, backup=None, restore=None, stdin=None)

if __name__ == "__main__":
    sys.exit(main())
