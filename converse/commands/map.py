"""The command: converse-map INPUT -b FILE."""

import re
import sys

from ..storage import files
from ..storage.files import ConverseError
from .common import (MAP, SIGNALS, Parser, ProgressLine, add_files, add_worker_options,
                     check_figure, command, ending, kept, read_problem, say, workers_of)

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
    add_files(p, "what is proved", "the diagram", "continue the diagram in FILE, with a larger "
              "--budget")
    p.add_argument("--budget", type=_budget, metavar="TIME", help=(
        "of the work of all runs on the diagram, in seconds, min or h of one core, about: it "
        "stands for a number of points of orbits, so that --jobs and the machine's speed do not "
        "change the result (default: 5min)"))
    add_worker_options(p, "parts of the range")
    return p


def progress_text(diagram):
    """The progress line: how much work is done."""
    return "%d proved, %s points of orbits" % (len(diagram.members), format(diagram.points, ","))


def run(options):
    check_figure(options, *filter(None, (options.input, options.backup, options.restore)))
    path = options.restore or options.backup
    if options.restore and options.backup:
        raise ConverseError("-r goes on in the file that it names; leave out -b")
    if _is_diagram(options.input):
        if path is not None or options.budget is not None:
            raise ConverseError("%s: is a diagram; to continue it, give -r %s and no input" % (
                (options.input,) * 2))
        path = options.input
        from ..diagram import Diagram
        found = Diagram.load(path)
    else:
        found = _search(options, path)
    say(found.report(path))
    if options.graphics is not None:
        from ..draw import diagram_figure
        diagram_figure.draw(found, options.graphics)
    proved = [bool(found.none), bool(found.tori)]
    return 0 if all(proved) or any(proved) and len(found.ranges) > 1 else 3 if any(proved) else 1


def _is_diagram(name):
    """Is the file a diagram, and not an input?"""
    return name not in (None, "-") and files.read_text(
        name, "input or diagram", ": is neither an input nor a diagram").startswith(FIRST_WORDS)


def _search(options, path):
    from ..diagram import explore  # it needs the C core

    family, given = None, {} if options.budget is None else {"budget": options.budget}
    if options.input is not None or options.restore is None:
        problem = read_problem(options.input, COMMAND)
        if not problem.full_torus:
            raise ConverseError("the input names a part of the torus (v0, v1); leave it out")
        family = problem.map
    with ProgressLine(COMMAND) as line, workers_of(options) as workers:
        def tell(text):
            line.clear()
            say(text + "\n")

        return explore(family, path=path, resume=options.restore is not None, tell=tell,
                       progress=lambda diagram: line(lambda: progress_text(diagram)),
                       **workers, **given)


main = command(COMMAND, parser, run, kept, backup=None, restore=None)

if __name__ == "__main__":
    sys.exit(main())
