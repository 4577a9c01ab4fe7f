"""The command: converse-portrait [INPUT] [-b FILE] [-g FILE]."""

import sys

from ..storage.files import ConverseError
from .common import (INPUT, SIGNALS, Parser, ProgressLine, add_files, add_worker_options,
                     check_figure, command, ending, kept, read_problem, say, whole_number,
                     workers_of)

COMMAND = "converse-portrait"
COLUMNS, DEPTH, DEEPEST, MOST = 600, 15, 1000, 1 << 16
ENDING = ending(
    "converse-portrait standard-k090.in --rotation golden -b k090.json -g k090.svg\n"
    "converse-check k090.json\n"
    "(the input is one of those that converse --list-inputs names)",
    "converse-check  verifies the portrait independently\n"
    "converse        proves that there is no circle at all\n"
    "converse-tori   proves circles, as --rotation does", (
        (0, "all columns are done, and all circles proved"),
        (1, "some are not, or no part of phase space is proved"),
        (2, "bad usage, input or file"), (SIGNALS[0], SIGNALS[1] + ", the portrait saved")))


def parser():
    p = Parser(prog=COMMAND, epilog=ENDING, description=(
        "Proves where in phase space the map  y' = y + J',  J' = J - V'(y),  V(y) = - the sum of "
        "A sin(k y + phase), y modulo 2 pi, has no rotational invariant circles, column by column, "
        "for all parameters of a range.  The file of the portrait is verified "
        "by converse-check."))
    p.add_argument("input", nargs="?", metavar="INPUT", help=INPUT + "; not needed with -r")
    add_files(p, "the portrait", "the portrait, with orbits of the map,", "continue the portrait "
              "FILE and keep its columns; a finished portrait is described, and drawn with -g")
    p.add_argument("--columns", type=whole_number(1, MOST), metavar="N",
                   help="divide the turn of x_0 into N columns (default %d)" % COLUMNS)
    p.add_argument("--depth", type=whole_number(1, DEEPEST), metavar="N",
                   help="most cuts of a prism (default %d): each further cut at least doubles the "
                   "time, and leaves less undecided" % DEPTH)
    p.add_argument("--lines", action="store_true", help=(
        "take vertical lines instead of strips, for any potential of one angle; nothing is proved "
        "between the lines"))
    p.add_argument("--rotation", metavar="ROTATION", action="append", default=[], help=(
        "prove that there is an invariant circle of this rotation number, as converse-tori does, "
        "and draw it; may be given again"))
    add_worker_options(p, "columns")
    return p


def progress_text(done, portrait):
    return "%d of %d columns" % (done, len(portrait.stars))


def run(options):
    path = options.restore or options.backup
    if options.rotation and options.graphics is None:
        raise ConverseError("--rotation is for the figure; name one with -g")
    if options.restore and (options.backup or options.input or options.columns or options.depth
                            or options.lines):
        raise ConverseError("-r continues a portrait as it was asked for; leave out the input, -b, "
                            "--columns, --depth and --lines")
    check_figure(options, path, options.input)
    from ..prover.portrait import portray  # it needs the C core, and says so where it is missing

    problem = None if options.restore else read_problem(options.input, COMMAND)
    rotations = _rotations(options.rotation)
    with ProgressLine(COMMAND) as line, workers_of(options) as workers:
        found = portray(problem, path=path, columns=options.columns or COLUMNS,
                        depth=options.depth or DEPTH, strips=not options.lines,
                        resume=options.restore is not None,
                        progress=lambda *done: line(lambda: progress_text(*done)), **workers)
    say(found.report(path or ""))
    if options.graphics is not None:
        from ..draw import portrait_figure
        tori = _tori(rotations, found.problem)
        portrait_figure.draw(found, options.graphics, tori)
        if len(tori) < len(rotations):
            return 1
    return 0 if found.complete and found.undecided < 1 else 1


def _rotations(texts):
    if not texts:
        return []
    from .. import tori

    try:
        return [tori.read_rotation(text, 1) for text in texts]
    except ValueError as error:
        raise ConverseError("--rotation: %s" % error) from None


def _tori(rotations, problem):
    """The circles that are proved; what is not is told."""
    from fractions import Fraction

    from .. import tori
    from ..model.exact import rounded_text

    proved = []
    for rotation in rotations:
        try:
            proved.append(tori.prove(problem, rotation))
            words = "proved, its angles within %s of its Fourier series" % rounded_text(
                Fraction(proved[-1].distance), 2, up=True)
        except (tori.NotFound, tori.NotProved) as error:
            words = str(error)
        say("Circle of rotation number %s : %s\n" % (rotation, words))
    return proved


main = command(COMMAND, parser, run, kept, restore=None, backup=None)

if __name__ == "__main__":
    sys.exit(main())
