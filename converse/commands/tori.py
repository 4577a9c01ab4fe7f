"""The command: converse-tori INPUT -b FILE."""

import contextlib
import math
import os
import sys
import time

from ..storage import files
from ..storage.files import ConverseError, plain
from .common import (INPUT, MAP, SIGNALS, TOGETHER, Parser, ProgressLine, add_files, check_figure,
                     command, ending, number, read_problem, say, seconds, tell, whole_number)

COMMAND = "converse-tori"
ENDING = ending(
    "converse-tori standard-k090.in -b k090.torus\n"
    "converse-tori standard-k090.in --rotation golden -b golden.torus\n"
    "converse-check golden.torus\n"
    "(the input is one of those that converse --list-inputs names)",
    "converse-check   verifies the certificate independently\n"
    "converse         proves that there is no torus at all\n"
    "converse-orbits  finds the periodic orbits near a torus", (
        (0, "a theorem"), (1, "not found, not proved, or the time is up"),
        (2, "bad usage, input or file; or the certificate could not be saved"), SIGNALS))
GIGABYTE = 10 ** 9
MOST_POINTS = 1 << 26
QUIET_SECONDS = 2.0         # A run of less time writes no step to a stderr that is not a terminal.


# ---- what is read

def _positive(text):
    found = number(text)
    if not found > 0:
        raise ValueError("'%s' is not above 0" % text)
    return found


def parser():
    p = Parser(prog=COMMAND, epilog=ENDING, description=(
        "Finds an invariant torus, a graph J = P + S'(y), of %s, in floating-point numbers, and "
        "proves that there is one near it." % MAP))
    p.add_argument("input", nargs="?", metavar="FILE",
                   help=INPUT + "; one parameter may have a range")
    p.add_argument("--rotation", metavar="ROTATION", help=(
        "the rotation vector in turns: decimals, near which a vector with good small divisors is "
        "taken, such as 0.2077 or '0.2742, 0.2802'; a continued fraction, such as '[0; 4, 1, 4, "
        "...]', that ends in ones; golden, silver, spiral, seven, T49, V1, V2; or a polynomial "
        "and elements of the field of its largest real root t, such as 't^2+t-1: t'; default: that "
        "of the most regular orbits whose torus has the fewest modes"))
    p.add_argument("--together", action="store_true", help=TOGETHER)
    add_files(p, "the certificate", "the torus", (
        "start the search from the torus of the certificate FILE, which also gives the rotation "
        "vector, and not from the map without potential"))
    p.add_argument("--margin", type=_positive, metavar="X", help="find a torus whose residual is X "
                   "times smaller than the admissible residual (about; default 100)")
    p.add_argument("--points", type=whole_number(16, MOST_POINTS), metavar="N",
                   help="most points of the grid of the search in "
                        "floating-point numbers (default 2097152); the grid of the refinement "
                        "is limited by memory alone")
    p.add_argument("--jobs", type=whole_number(1), metavar="N",
                   help="verify N pieces of a range at a time, in processes (default 1)")
    p.add_argument("--time-limit", type=seconds, default=math.inf, metavar="SECONDS",
                   help="begin no step after this time")
    p.add_argument("--memory", type=_positive, metavar="GB", help="the most memory that "
                   "refining the torus takes, in GB (default: three quarters of the free memory)")
    return p


# ---- the command

class _Steps(ProgressLine):
    """Prints each step when it begins, since one step can take minutes: on a terminal in place of
    the last step, elsewhere on a new line."""

    def __call__(self, step):
        if self.shown:
            self.due = 0.0
            super().__call__(lambda: step)
        elif time.monotonic() > self.began + QUIET_SECONDS:
            tell(step, COMMAND)


def _read_problem(options):
    problem = read_problem(options.input, COMMAND, options.together)
    if not options.together and problem.by_ranges and sum(map(any, problem.parts)) > 1:
        raise ConverseError("a, b and c have ranges of their own; let them move together "
                            "(--together), or make all but one single numbers")
    return problem


def _check_outputs(options, locks):
    """Before the work starts: files that cannot be written, or would overwrite something.  The
    certificate's is locked, so that another run does not choose the same."""
    if options.backup is not None:
        if options.restore is not None and files.same(options.backup, options.restore):
            raise ConverseError("'%s': the certificate would overwrite it; name another file"
                                % options.backup)
        files.check_writable(options.backup, regular=True)
        locks.enter_context(files.Lock(options.backup))
        for path in options.backup, _found(options):
            files.check_new(path, options.restore)
    check_figure(options, options.input, options.backup, options.restore)


def _found(options):
    """The file for the torus that was found, until it is proved."""
    return options.backup + ".found"


def _keep(options):
    """The function that writes the torus to this file, or None without -b."""
    def keep(text):
        try:
            files.write_text(_found(options), text)
        except ConverseError as error:          # The proof does not need the file.
            tell(error, COMMAND)
    return keep if options.backup is not None else None


def _left(options):
    """The phrase about the use of the file of the torus that was found, "" if there is none."""
    if getattr(options, "backup", None) is None or not os.path.exists(_found(options)):
        return ""
    return "%s has the torus that was found; converse-check tries to verify it, and -r starts " \
        "from it" % plain(_found(options))


def _rotation(options, potential, start):
    from ..tori.nearest import rotation_of

    if start is not None and start.dimension != potential.dimension:
        raise ConverseError("%s: its map has %d angle%s, and this one %d; start from another "
                            "certificate, or without" % (
                                options.restore, start.dimension, "s" * (start.dimension - 1),
                                potential.dimension))
    if options.rotation is not None:
        return rotation_of(options.rotation, potential.dimension)
    return start and start.rotation


def run(options):
    from .. import tori

    tori.Rotation                       # or a line that says what is missing
    with contextlib.ExitStack() as locks:
        _check_outputs(options, locks)
        return _prove(options, tori)


def _prove(options, tori):
    import numpy

    from ..tori import report
    from ..tori.proved import processor_time
    from ..tori.torus import family

    start = None if options.restore is None else _start(options.restore)
    problem = _read_problem(options)
    potential, part = family(problem)
    rotation = _rotation(options, potential, start)
    choices = {name: value for name, value in (
        ("start", start), ("margin", options.margin and float(options.margin)),
        ("points", options.points),
        ("memory", options.memory and int(options.memory * GIGABYTE)),
        ("jobs", options.jobs), ("keep", _keep(options))) if value is not None}
    began = processor_time()
    with _Steps() as line, numpy.errstate(all="ignore"):
        try:
            proof = tori.prove(problem, rotation, progress=line, time_limit=options.time_limit,
                               **choices)
        except (tori.NotFound, tori.NotProved, tori.TimeIsUp) as reason:
            line.clear()
            say(report.undecided(problem, rotation, reason, _by_hand(options), _left(options)))
            return 1
    certificate = {"certificate": ""}
    try:
        if options.backup is not None:
            certificate = {"certificate": options.backup, "checksum": proof.save(options.backup)}
            with contextlib.suppress(OSError):
                os.remove(_found(options))
    finally:                            # the theorem is told, even if the disk is full
        say(report.verdict(proof, processor_time() - began, problem=problem, **certificate))
    options.proved = True
    if options.graphics is not None:
        from ..draw import torus_figure
        torus_figure.draw(
            [piece.torus for piece in proof.pieces], None, proof.pieces, options.graphics)
    return 0


def _by_hand(options):
    """The flags that chose what the program would have chosen otherwise, and that may be why."""
    return ["--" + flag for flag in ("margin", "points", "memory")
            if getattr(options, flag) is not None]


def _start(path):
    from ..tori import certificate

    found = certificate.read(path)
    if len(found.tori) > 1:
        raise ConverseError("%s: is of a range; to start from, name the certificate of one torus"
                            % plain(path))
    return found.tori[0]


def interrupted(options):
    return "the figure is not drawn" if options.proved else "; ".join(
        filter(None, ("nothing is proved", _left(options))))


main = command(COMMAND, parser, run, interrupted, proved=False)

if __name__ == "__main__":
    sys.exit(main())
