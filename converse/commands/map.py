"""The command: converse-map INPUT -b FILE."""

import os
import re
import sys

from ..storage import files
from ..storage.files import ConverseError
from .common import (MAP, SIGNALS, Parser, ProgressLine, add_worker_options, check_figure, command,
                     ending, executor_of, read_problem, say)

COMMAND = "converse-map"
FIRST_WORDS = "converse diagram "       # of the file of a diagram
UNITS = {"": 1, "s": 1, "min": 60, "h": 3600}       # of a budget, in seconds
BUDGET = re.compile(r"(.*?)\s*(|s|min|h)")
ENDING = ending(
    "converse-map two-harmonics.json -b two.map -g two.svg\n"
    "converse-map -r two.map --budget 1h\n"
    "converse-map two.map -g two.svg\n"
    "converse-check two.map",
    "converse-check  verifies the file independently\n"
    "converse        proves that there are no tori, for one value or range\n"
    "converse-tori   proves one torus, for one value or range", (
        (0, "tori are proved for a value, and their absence for another; with two parameters, "
            "something is proved"), (1, "nothing is proved"), (2, "bad usage, input or file"),
        (3, "tori are proved, or their absence, but not both"),
        (SIGNALS[0], SIGNALS[1] + ", what was proved is saved")))


def _budget(text):
    from ..model.exact import exact

    number, unit = BUDGET.fullmatch(text).groups()
    try:
        seconds = exact(number) * UNITS[unit]
    except ValueError:
        seconds = 0
    if seconds <= 0:
        raise ValueError("'%.40s' is not a time above 0, such as 300, 10min or 2h" % text)
    return seconds


def parser():
    p = Parser(prog=COMMAND, epilog=ENDING, description=(
        "Finds for which values of one or two parameters %s, is proved to have no invariant torus. "
        " The input gives one or two parameters a range.  Between proved values nothing is proved."
        % MAP))
    p.add_argument("input", nargs="?", metavar="INPUT", help=(
        "an input file; or a file of -b, which is described, and drawn with -g"))
    p.add_argument("-b", "--backup", metavar="FILE", help=(
        "keep what is proved in FILE, a new file, compressed if its name ends in .gz"))
    p.add_argument("-r", "--restore", metavar="FILE", help=(
        "continue the diagram in FILE, with a larger --budget"))
    p.add_argument("--budget", type=_budget, metavar="TIME", help=(
        "of the work of all runs on the diagram, in seconds, min or h of one core, about: it "
        "stands for a number of points of orbits, so that --jobs and the machine's speed do not "
        "change the result (default: 5min)"))
    p.add_argument("-g", "--graphics", metavar="FILE",
                   help="draw the diagram: SVG, PNG or PDF by name")
    add_worker_options(p, "parts of the range")
    return p


def progress_text(diagram):
    """The progress line: how much work is done."""
    return "%d proved, %s points of orbits" % (len(diagram.members), format(diagram.points, ","))


def run(options):
    check_figure(options, *filter(None, (options.input, options.backup, options.restore)))
    kept = options.restore or options.backup
    if options.restore and options.backup:
        raise ConverseError("-r goes on in the file that it names; leave out -b")
    if _is_diagram(options.input):
        if kept is not None or options.budget is not None:
            raise ConverseError("%s: is a diagram; to continue it, give -r %s and no input" % (
                (options.input,) * 2))
        kept = options.input
        from ..diagram import Diagram
        found = Diagram.load(kept)
    else:
        found = _search(options, kept)
    say(found.report(kept))
    if options.graphics is not None:
        from ..draw import diagram_figure
        diagram_figure.draw(found, options.graphics)
    proved = [bool(found.none), bool(found.tori)]
    return 0 if all(proved) or any(proved) and len(found.ranges) > 1 else 3 if any(proved) else 1


def _is_diagram(name):
    """Is the file a diagram, and not an input?"""
    return name not in (None, "-") and files.read_text(
        name, "input or diagram", ": is neither an input nor a diagram").startswith(FIRST_WORDS)


def _search(options, kept):
    from ..diagram import explore  # it needs the C core

    family, given = None, {} if options.budget is None else {"budget": options.budget}
    if options.input is not None or options.restore is None:
        problem = read_problem(options.input, COMMAND)
        if not problem.full_torus:
            raise ConverseError("the input names a part of the torus (v0, v1); leave it out")
        family = problem.map
    with ProgressLine(COMMAND) as line, executor_of(options) as executor:
        def tell(text):
            line.clear()
            say(text + "\n")

        return explore(family, path=kept, resume=options.restore is not None, jobs=options.jobs,
                       executor=executor, time_limit=options.time_limit, tell=tell,
                       progress=lambda diagram: line(lambda: progress_text(diagram)), **given)


def interrupted(options):
    kept = options.restore or options.backup
    return "continue with -r " + kept if kept and os.path.exists(kept) else \
        "nothing was kept; keep what is proved with -b FILE"


main = command(COMMAND, parser, run, interrupted, backup=None, restore=None)

if __name__ == "__main__":
    sys.exit(main())
