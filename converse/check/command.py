"""The command converse-check."""

import argparse
import contextlib
import os
import re
import signal
import sys

from .failures import Failure, Unusable
from .limits import INTERRUPTED, PIPE_CLOSED, UNUSABLE, VERIFIED
from .progress import complain, reason
from .run import verify
from .signals import interruptible
from .version import __version__


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Unusable(message + "; see converse-check --help")


def positive_int(text):
    if not re.fullmatch("[0-9]{1,9}", text, re.ASCII) or int(text) == 0:
        raise argparse.ArgumentTypeError("'%.40s' is not a whole number above 0" % text)
    return int(text)


def parser():
    p = Parser(prog="converse-check", allow_abbrev=False,
               formatter_class=argparse.RawDescriptionHelpFormatter, description=(
        "Verifies the theorem of a proof file, a diagram, a portrait or a certificate of\n"
        "existence, independently of the program that wrote them."),
        epilog="""example:
  converse --method loewner --together trig148.in -b trig148.proof
  converse-check trig148.proof

see also:
  converse, converse-map, converse-portrait  prove that there are no tori, and write such files
  converse-tori                              proves that there is a torus, and writes a certificate

exit status:
  0    verified
  1    rejected: the file is wrong (altered, unfinished, with undecided or missing
       parts, wrong counts, a skipped part without its mirror image), or it is a
       diagram or portrait of which nothing is proved
  2    bad usage, or a file that cannot be read
  3    verified in part: for successors in a part of the torus only
  4    a spot check in which nothing failed: NOT a verification
  5    not confirmed: the claim is false or its proof beyond the checker's limits
  130  interrupted (129, 143: by SIGHUP, SIGTERM)
  141  the reader of the output has closed the pipe, as head does""")
    p.add_argument("file", help=(
        "a finished proof file, a diagram, a portrait or a certificate of existence, perhaps "
        "compressed by gzip"))
    p.add_argument("--jobs", type=positive_int, default=1, metavar="N",
                   help="processes (default 1)")
    p.add_argument("--sample", type=positive_int, metavar="K",
                   help="only a spot check, of K leaves chosen by chance; not a verification")
    p.add_argument("--exact", action="store_true", help=(
        "bound all leaves in integers, not first in doubles by numpy: dozens of times slower"))
    p.add_argument("--quiet", action="store_true", help=(
        "print no progress, and no report if the status is 0"))
    p.add_argument("--version", action="version", version="converse-check " + __version__)
    return p


def written(text, status):
    """Prints the text.  Returns the status, or another one if the reader has closed the pipe."""
    try:
        print(text, end="", flush=True)
        return status
    except OSError as error:
        with contextlib.suppress(OSError):      # the interpreter must not try again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return PIPE_CLOSED
        raise Unusable("the output cannot be written (%s)" % reason(error)) from None


def command(argv, options):
    """Fills in the options and does what they say; returns the exit status."""
    try:
        if sys.stdout is None:
            raise Unusable("the standard output is closed: nowhere to report to")
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.reconfigure(errors="backslashreplace")
        try:
            parser().parse_args(argv, options)
        except SystemExit as end:               # of --help and --version
            return written("", end.code)
        # Nothing here uses BLAS, whose threads cost 0.03 s of processor time at the start of numpy.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        result = verify(options.file, min(options.jobs, 61), options.sample,
                        not options.quiet, options.exact)
        return written((result.text + "\n") * (result.status != VERIFIED or not options.quiet),
                       result.status)
    except Failure as error:
        status, message = error.status, error.word + str(error)
    except Exception as error:                  # whatever went wrong must not look like success
        status, message = UNUSABLE, "the checker failed (%s: %s)" % (type(error).__name__, error)
    complain((options.file and options.file + ": ") + message)
    return status


def main(argv=None):
    """Runs the command and returns its exit status; every failure is one line.

    Parameters
    ----------
    argv
        The arguments; None: the arguments of the process, whose signals are then handled.
    """
    options = argparse.Namespace(file="")
    with interruptible(argv is None):
        try:
            return command(argv, options)
        except KeyboardInterrupt as end:
            complain((options.file and options.file + ": ") + "interrupted; nothing was verified")
            return INTERRUPTED + (end.args[0] if end.args else signal.SIGINT)
