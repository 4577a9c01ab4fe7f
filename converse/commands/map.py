"""The command: converse-map [--plane b=0] MAP."""

import argparse
import math
import os
import sys

from ..model.exact import decimal_text
from ..parameters.map import PROVED, ParameterMap
from ..parameters.region import REGIONS
from ..storage.files import ConverseError, plain
from ..version import __version__
from .common import (SIGNALS, Parser, ProgressLine, add_worker_options, check_figure, command,
                     ending, executor_of, number, say)

COMMAND = "converse-map"
DOWN_TO = "1.05"
ENDING = ending(
    "converse-map --plane a=b --down-to 1.1 ab.json\n"
    "converse-map -g ab.svg ab.json\n"
    "converse-check ab.json",
    "converse-check  verifies the map independently\n"
    "converse        proves one patch of parameters, of any potential\n"
    "converse-tori   proves tori, and writes the certificates of --tori", (
        (0, "all is proved that was asked for"), (1, "some of it is not"),
        (2, "bad usage, map or file"), (SIGNALS[0], SIGNALS[1] + ", the map saved")))


def _ratio(text):
    ratio = number(text)
    if not 1 < ratio <= 100:
        raise argparse.ArgumentTypeError("'%.40s' is not a number above 1, at most 100, as 1.05 is"
                                         % text)
    return ratio


def parser():
    p = Parser(prog=COMMAND, epilog=ENDING, description=(
        "Proves for as many (a, b, c) of a plane as it can that the map  y' = y + J',  J' = J - "
        "grad V(y),  V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1), has no invariant torus, and "
        "keeps what is proved in MAP, a file that converse-check verifies.  Without --plane and -r "
        "MAP is described, and drawn with -g."))
    p.add_argument("map", metavar="MAP", help="a file, new unless it is restored; compressed if "
                   "its name ends in .gz")
    p.add_argument("--plane", choices=[*REGIONS], help="all directions of a plane, a, b, c >= 0")
    p.add_argument("--down-to", type=_ratio, metavar="RATIO", help=(
        "prove down to RATIO times the estimated frontier (default %s)" % DOWN_TO))
    p.add_argument("-r", "--restore", action="store_true", help=(
        "continue MAP in its plane; --down-to may have another value"))
    p.add_argument("-g", "--graphics", metavar="FILE", help="draw the map: SVG, PNG or PDF by name")
    p.add_argument("--tori", metavar="DIRECTORY", help="count the certificates of tori in "
                   "DIRECTORY, of points of the plane; with -g, draw these points")
    add_worker_options(p, "cells")
    p.add_argument("--version", action="version", version="%s %s" % (COMMAND, __version__))
    return p


def progress_text(share, found):
    """The progress line: the present step of the work, and how much of it is done."""
    if found.estimated_all:
        return "proving: %.1f%% of the area down to %s times the estimate, %d cells" % (
            math.floor(1000 * share) / 10, decimal_text(found.down_to), found.count(PROVED))
    return "estimating the frontier: %d of %d directions" % (
        sum(map(len, found.estimate)),
        len(found.estimate) * len(found.places()))


def run(options):
    check_figure(options, options.map)
    if not options.plane and not options.restore:
        if options.down_to is not None:
            raise ConverseError("--down-to needs --plane or -r")
        found = ParameterMap.load(options.map)
    else:
        from ..parameters.search import explore  # it needs the C core

        with ProgressLine() as line, executor_of(options) as executor:
            found = explore(
                options.plane, options.down_to, path=options.map, resume=options.restore,
                jobs=options.jobs, executor=executor, time_limit=options.time_limit,
                progress=lambda *done: line(lambda: progress_text(*done)))
    say(found.report(options.map))
    points = []
    if options.tori is not None:
        from ..parameters.tori import proved_points

        points = [point for point, _ in proved_points(options.tori) if found.in_plane(point)]
        say("Tori : %d of the plane, with certificates in %s that converse-check verifies\n" % (
            len(points), plain(options.tori)))
    if options.graphics is not None:
        from ..draw import map_figure
        map_figure.draw(found, options.graphics, points)
    return 0 if found.complete else 1


def interrupted(options):
    return ("continue with -r " + options.map if options.map and os.path.exists(options.map)
            else "nothing was found yet")


main = command(COMMAND, parser, run, interrupted, map=None)

if __name__ == "__main__":
    sys.exit(main())
