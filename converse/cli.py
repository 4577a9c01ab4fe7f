"""The command: converse [flags] < input > report."""

import argparse
import contextlib
import math
import os
import sys
from dataclasses import replace

from . import ConverseError, InputError, __version__, figure, files, picture, prove, read_input
from .proof import LIMIT, check_backup
from .report import header, verdict

THEOREM, UNDECIDED, BAD, INTERRUPTED = 0, 1, 2, 130
KIND_NAMES = {"P": "proved", "S": "symmetric", "U": "undecided"}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise ConverseError("%s; see %s --help" % (message, self.prog))


def _whole(least):
    def convert(text):
        try:
            number = int(text)
        except ValueError:
            number = None
        if number is None or not least <= number <= LIMIT:
            raise argparse.ArgumentTypeError("'%s' is not a whole number from %d to %d"
                                             % (text, least, LIMIT))
        return number
    return convert


def _seconds(text):
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not seconds >= 0:
        raise argparse.ArgumentTypeError("'%s' is not a number of seconds" % text)
    return seconds


def parser():
    p = Parser(prog="converse", allow_abbrev=False, description=(
        "Tries to prove that a family of symplectic maps has no invariant tori."), epilog=(
        "Exit status: 0 a theorem; 1 undecided; 2 bad usage, input or file; 130 interrupted."))
    p.add_argument("input", nargs="?", default="-", help="input file; standard input by default")
    p.add_argument("-d", "--depth", type=_whole(0), metavar="N",
                   help="give up on a prism that was cut N times (default 30; loewner: 120)")
    p.add_argument("-b", "--backup", metavar="FILE",
                   help="keep a backup in FILE, from which the run can be continued")
    p.add_argument("-r", "--restore", metavar="FILE",
                   help="continue the run whose backup is FILE")
    p.add_argument("-g", "--graphics", metavar="FILE",
                   help="draw the prisms in FILE, by its name as SVG, PNG or PDF, else as "
                        "PostScript; 'off' draws none (default)")
    p.add_argument("-p", "--precision", type=_whole(1), default=35, metavar="DP",
                   help="decimal places of the thesis's rigorous arithmetic (default 35)")
    p.add_argument("-s", "--stubborn", action="store_true",
                   help="go on after a prism that cannot be decided")
    p.add_argument("-t", "--verbose", action="store_true",
                   help="print a line for every decided prism")
    p.add_argument("--as-printed", action="store_true",
                   help="follow the thesis's listing to the letter; not a proof")
    p.add_argument("--method", choices=("thesis", "loewner"), default="thesis",
                   help="the thesis's criterion (default), or the sharper one, in doubles")
    p.add_argument("--together", action="store_true",
                   help="a, b and c move together, from all lower to all upper ends (loewner)")
    p.add_argument("--jobs", type=_whole(1), metavar="N",
                   help="work on N parts at a time (default: one per core)")
    p.add_argument("--dask", metavar="ADDRESS", help="let the Dask cluster at ADDRESS work")
    p.add_argument("--mpi", action="store_true",
                   help="let MPI processes work: mpiexec -n N python -m mpi4py.futures "
                        "-m converse.cli --mpi ...")
    p.add_argument("--time-limit", type=_seconds, default=math.inf, metavar="SECONDS",
                   help="stop after about so long; what is left is undecided")
    p.add_argument("--version", action="version", version="converse " + __version__)
    return p


def _leaf_line(leaf, steps):
    """A line of -t: kind, centre and half-widths in radians, cuts, steps."""
    numbers = ["%.10g" % (x * math.pi) for x in leaf.centre + leaf.half]
    return "%-9s (%s, %s) +- (%s, %s), %d cuts, %d steps" % (
        KIND_NAMES[leaf.kind], *numbers, leaf.depth, steps)


def _say(text):
    sys.stdout.write(text)
    sys.stdout.flush()


class Progress:
    """Prints the header when the search gets under way; then keeps a bar on a terminal."""

    def __init__(self, problem, as_printed, with_bar):
        self.problem, self.as_printed, self.with_bar = problem, as_printed, with_bar
        self.started, self.bar = False, None

    def __call__(self, fraction, counts):
        if not self.started:
            self.started = True
            if self.as_printed:
                print("converse: --as-printed is a historical reconstruction, not a proof",
                      file=sys.stderr)
            _say(header(self.problem))
            if self.with_bar:
                from tqdm import tqdm
                self.bar = tqdm(total=100, leave=False, file=sys.stderr, bar_format=(
                    "{percentage:5.1f}% |{bar}| {elapsed}{postfix}"))
        if self.bar is not None:
            prisms = counts.proved + counts.symmetric + counts.undecided
            self.bar.n = 100 * fraction
            self.bar.set_postfix_str("%d prisms, cut %d times" % (prisms, counts.most_cuts))

    def close(self):
        if self.bar is not None:
            self.bar.close()


@contextlib.contextmanager
def workers(options):
    """The executor that the options ask for, or None, and how many tasks to give it."""
    if options.dask is None and not options.mpi:
        yield None, options.jobs
    elif options.mpi:
        try:
            from mpi4py.futures import MPIPoolExecutor
        except ImportError:
            raise ConverseError("--mpi needs mpi4py; pip install mpi4py") from None
        with MPIPoolExecutor() as executor:
            yield executor, options.jobs
    else:
        try:
            from distributed import Client
        except ImportError:
            raise ConverseError("--dask needs dask; pip install 'converse[dask]'") from None
        try:
            client = Client(options.dask, timeout=10)
        except (OSError, ValueError, TypeError) as error:
            raise ConverseError("there is no Dask scheduler at %s (%s); name another address"
                                % (options.dask, error or type(error).__name__)) from None
        with client:
            yield client.get_executor(), options.jobs or 2 * max(1, sum(client.nthreads().values()))


def run(options):
    if options.input == "-" and sys.stdin is None:
        raise ConverseError("standard input is closed; name an input file")
    problem = read_input(sys.stdin if options.input == "-" else options.input)
    if options.method == "thesis" and options.together:
        raise ConverseError("--together needs --method loewner")
    if options.method == "loewner" and options.as_printed:
        raise ConverseError("--as-printed is the thesis's method; leave out --method loewner")
    problem = replace(problem, together=options.together)
    graphics = None if options.graphics == "off" else options.graphics
    if graphics is not None:
        if graphics in (options.input, options.backup, options.restore):
            raise ConverseError("the figure would overwrite '%s'; name another file" % graphics)
        files.check_writable(graphics)
        if figure.format_of(graphics) != "ps":
            picture.check()
    if options.backup is not None:
        check_backup(options.backup)

    def on_leaf(leaf, steps):
        _say(_leaf_line(leaf, steps) + "\n")

    progress = Progress(problem, options.as_printed,
                        sys.stderr.isatty() and not options.verbose)
    with contextlib.closing(progress), workers(options) as (executor, jobs):
        proof = prove(problem, options.depth, options.precision, options.stubborn,
                      options.as_printed, progress, options.backup, options.restore,
                      on_leaf if options.verbose else None, options.time_limit, options.method,
                      jobs, executor)
    _say(verdict(proof))
    if graphics is not None:
        proof.figure(graphics)
    return THEOREM if proof.all_decided else UNDECIDED


def ended(command, run, interrupted):
    """The exit status of run(); every failure is one line on stderr, headed by the command's name.
    interrupted() says what Ctrl-C leaves behind."""
    try:
        if None in (sys.stdout, sys.stderr):
            return BAD                      # a standard stream is closed: nowhere to say so
        for stream in (sys.stdout, sys.stderr):
            stream.reconfigure(errors="backslashreplace")
        return run()
    except SystemExit as end:               # of --help and --version
        return end.code
    except KeyboardInterrupt:
        message, status = "interrupted; " + interrupted(), INTERRUPTED
    except (ConverseError, InputError, MemoryError) as error:
        message, status = str(error) or "there is not enough memory", BAD
    except OSError as error:
        message, status = "the output cannot be written (%s)" % files.reason(error), BAD
        with contextlib.suppress(OSError):  # the interpreter must not try again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    with contextlib.suppress(OSError):
        print("%s: %s" % (command, " ".join(message.split())), file=sys.stderr)
    return status


def main(argv=None):
    """Runs the command and returns its exit status."""
    options = argparse.Namespace(backup=None)

    def interrupted():
        if options.backup and os.path.exists(options.backup):
            return "continue with -r " + options.backup
        return "without -b nothing is kept"

    return ended("converse", lambda: run(parser().parse_args(argv, options)), interrupted)


if __name__ == "__main__":
    sys.exit(main())
