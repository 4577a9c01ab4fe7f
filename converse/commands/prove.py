"""The command: converse [flags] < input > report."""

import argparse
import contextlib
import logging
import math
import os
import signal
import sys
import time
import warnings
from dataclasses import replace

from ..model.problem import InputError, decimal_text, parse_number, read_input
from ..prover.report import header, verdict
from ..prover.settings import AS_PRINTED, LIMIT, METHODS, REGION, THEOREM, UNDECIDED, Settings
from ..prover.signals import ENDING, interruptible
from ..prover.workers import WorkersGone
from ..storage import files
from ..storage.files import ConverseError, NotSaved, plain
from ..version import __version__

STATUS = {THEOREM: 0, UNDECIDED: 1, REGION: 3, AS_PRINTED: 4}
BAD, ENDED_BY = 2, 128                  # the second plus the number of the signal
LINE_SECONDS = 0.25                     # between two lines of progress
KIND_NAMES = {"P": "proved", "S": "symmetric", "U": "undecided"}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise ConverseError("%s; see %s --help" % (message, self.prog))


class ListInputs(argparse.Action):
    """Prints the paths of the inputs that come with the package, and ends."""

    def __call__(self, parser, *_):
        package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        directory = os.path.join(package, "inputs")
        say("".join(os.path.join(directory, name) + "\n" for name in sorted(os.listdir(directory))))
        parser.exit()


def whole(least):
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


def seconds(text):
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not seconds >= 0:
        raise argparse.ArgumentTypeError("'%s' is not a number of seconds" % text)
    return seconds


def _decimal(text):
    try:
        return decimal_text(parse_number(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def parser():
    p = Parser(prog="converse", allow_abbrev=False, description=(
        "Tries to prove that a family of symplectic maps has no invariant tori."), epilog=(
        "Exit status: 0 a theorem; 1 undecided; 2 bad usage, input or file, or what was found could "
        "not be saved, or the workers are gone; 3 decided for a part of "
        "the torus only; 4 as printed, not a proof; 129, 130 or 143 ended by a signal."))
    p.add_argument("input", nargs="?", help="input file, the thesis's or JSON, by default, and as -, "
                   "standard input; with -r it is not needed, and must agree if given")
    p.add_argument("-d", "--depth", type=whole(0), metavar="N",
                   help="give up on a prism that was cut N times (default %d; loewner: %d)"
                   % (METHODS["thesis"], METHODS["loewner"]))
    p.add_argument("-b", "--backup", metavar="FILE",
                   help="keep a backup in FILE, a new one, from which the run can be continued and "
                   "which in the end is the proof")
    p.add_argument("-r", "--restore", metavar="FILE",
                   help="continue the run whose backup is FILE, as it was asked for then, though "
                   "perhaps deeper (-d), and keep FILE up to date unless -b names another")
    p.add_argument("-g", "--graphics", metavar="FILE",
                   help="draw the prisms in FILE, by its name's ending as SVG, PNG, PDF or "
                        "PostScript (.ps, .eps); 'off' draws none (default)")
    p.add_argument("-p", "--precision", dest="digits", type=whole(1), metavar="DP",
                   help="decimal places of the thesis's rigorous arithmetic (default 35)")
    p.add_argument("-s", "--stubborn", action="store_true", default=None,
                   help="go on after a prism that cannot be decided")
    p.add_argument("-t", "--verbose", action="store_true",
                   help="print a line for every decided prism")
    p.add_argument("--as-printed", action="store_true", default=None,
                   help="follow the thesis's listing to the letter; not a proof")
    p.add_argument("--method", choices=tuple(METHODS),
                   help="the thesis's criterion (default), or the sharper one, in doubles")
    p.add_argument("--together", action="store_true",
                   help="a, b and c move together, from all lower to all upper ends (loewner)")
    p.add_argument("--xstar", nargs=2, type=_decimal, metavar=("X0", "X1"),
                   help="let x* be this point, angles in radians (default: the program chooses)")
    p.add_argument("--jobs", type=whole(1), metavar="N",
                   help="work on N parts at a time (default: one per core)")
    p.add_argument("--dask", metavar="ADDRESS", help="let the Dask cluster at ADDRESS work")
    p.add_argument("--mpi", action="store_true",
                   help="let MPI processes work: mpiexec -n N python -m mpi4py.futures "
                        "-m converse.commands.prove --mpi ...")
    p.add_argument("--time-limit", type=seconds, default=math.inf, metavar="SECONDS",
                   help="stop after about so long; what is left is undecided")
    p.add_argument("--list-inputs", action=ListInputs, nargs=0,
                   help="print where the inputs are that come with the program, and exit")
    p.add_argument("--version", action="version", version="converse " + __version__)
    return p


def _leaf_line(leaf, points):
    """A line of -t: kind, centre and half-widths in radians, cuts, steps."""
    numbers = ["%.10g" % (x * math.pi) for x in leaf.centre + leaf.half]
    return "%-9s (%s, %s) +- (%s, %s), %d cuts, %d steps" % (
        KIND_NAMES[leaf.kind], *numbers, leaf.depth, points)


def say(text):
    sys.stdout.write(text)
    sys.stdout.flush()


def _tell(message, command="converse"):
    """A line on stderr, whatever the message."""
    Line.clear()
    with contextlib.suppress(OSError):
        print("%s: %s" % (command, plain(" ".join(str(message).split()))), file=sys.stderr,
              flush=True)


class Line:
    """On a terminal, a line that is written over and over, a few times a second."""

    length = 0                              # of what stands there now, whoever wrote it

    def __init__(self):
        self.shown, self.due = sys.stderr.isatty(), 0.0
        self.began = time.monotonic()

    def __call__(self, words):
        """words() is the text, which is asked for if it is time."""
        now = time.monotonic()
        if self.shown and now >= self.due:
            self.due = now + LINE_SECONDS
            passed = int(now - self.began)
            Line._write("%d:%02d:%02d %s" % (
                passed // 3600, passed // 60 % 60, passed % 60, words()))

    @staticmethod
    def _write(text):
        with contextlib.suppress(OSError):
            text = text[:(os.get_terminal_size(sys.stderr.fileno()).columns or 80) - 1]
            sys.stderr.write("\r" + text.ljust(Line.length) + ("" if text else "\r"))
            sys.stderr.flush()
            Line.length = len(text)

    @staticmethod
    def clear():
        """Makes room for other lines."""
        if Line.length:
            Line._write("")


class Progress:
    """Prints the header when the search gets under way; then, on a terminal, what was done, how
    fast, and how much of parameters and torus it is.  What is left cannot be foreseen: by how the
    prisms so far fared, proofs were guessed to be a sixth as long as they were, or twice as long."""

    def __init__(self, problem, as_printed, with_line, begun):
        self.problem, self.as_printed, self.begun = problem, as_printed, begun
        self.started, self.before, self.line = False, 0, Line() if with_line else None

    def __call__(self, examined, counts):
        if not self.started:
            self.started = True
            self.begun()
            if self.as_printed:
                _tell("--as-printed is a historical reconstruction, not a proof")
            say(header(self.problem, self.as_printed))
            self.before = counts.proved         # from a backup
        if self.line is not None:
            self.line(lambda: self._words(examined, counts))

    def _words(self, examined, counts):
        rate = (counts.proved - self.before) / max(LINE_SECONDS, time.monotonic() - self.line.began)
        return "%s prisms proved, %s/s; %.2f%% of parameters x torus done%s" % (
            format(counts.proved, ","), format(round(rate), ","), math.floor(1e4 * examined) / 100,
            ", %d undecided" % counts.undecided if counts.undecided else "")

    def close(self):
        Line.clear()


@contextlib.contextmanager
def workers(options):
    """The executor that the options ask for, or None."""
    if options.dask is None and not options.mpi:
        yield None
    elif options.mpi:
        from mpi4py.futures import MPIPoolExecutor
        with MPIPoolExecutor() as executor:
            yield executor
    else:
        try:
            from distributed import Client
        except ImportError:
            raise ConverseError("--dask needs dask; pip install 'converse-kam[dask]'") from None
        logging.disable()               # what matters is said here, in a line
        try:
            client = Client(options.dask, timeout=10)
        except (OSError, ValueError, TypeError) as error:
            raise ConverseError("there is no Dask scheduler at %s (%s); name another address"
                                % (options.dask, error or type(error).__name__)) from None
        try:
            yield client.get_executor()
        finally:
            with contextlib.suppress(Exception):        # there may be nobody to say good-bye to
                client.close()


def check_mpi(options, module, command="converse"):
    """Ends the program if this module's command runs in each of several MPI processes, which would
    all do the same."""
    if not options.mpi:
        return
    try:
        import mpi4py.futures  # noqa: F401
        from mpi4py import MPI
    except ImportError:
        raise ConverseError("--mpi needs mpi4py; pip install mpi4py") from None
    core = sys.modules.get("mpi4py.futures._core") or sys.modules.get("mpi4py.futures._lib")
    world = MPI.COMM_WORLD
    if world.Get_size() > 1 and getattr(core, "SharedPool", True) is None:
        if world.Get_rank() == 0:
            _tell("--mpi: each of the %d processes would do the whole work; to divide it say "
                  "mpiexec -n %d python -m mpi4py.futures -m %s --mpi ..."
                  % (world.Get_size(), world.Get_size(), module), command)
        world.Barrier()                 # one that ends may take the others with it
        sys.exit(BAD)


def _read_problem(options, restored):
    """The problem that the input is, or that of the restored proof where there is no input."""
    if restored is not None and options.input is None:
        return restored.problem
    source = options.input
    if source in (None, "-"):
        source = sys.stdin
        if source is None:
            raise ConverseError("standard input is closed; name an input file")
        if source.isatty():
            _tell("reading the problem from standard input; end it with Ctrl-D")
    problem = read_input(source)
    if problem.general is not None:
        if options.together:
            raise ConverseError("--together is for ranges of a, b and c; name a parameter in the "
                                "input instead")
        return problem
    return replace(problem, together=options.together or problem.together or (
        restored is not None and restored.problem.together))


def _check_graphics(options):
    """Refuses a figure that cannot be written or would overwrite something else."""
    from ..draw import figure, plot  # these take a while

    others = [options.input, options.backup, options.restore]
    with contextlib.suppress(AttributeError, OSError, ValueError):
        others.append(sys.stdin.fileno())
    files.check_output(options.graphics, "figure", figure.FORMATS, others)
    if figure.format_of(options.graphics) != "ps":
        plot.check()


def run(options):
    from ..prover.proof import Proof  # these need the C core, and say so where it is missing
    from ..prover.run import prove

    check_mpi(options, "converse.commands.prove")
    if options.graphics == "off":
        options.graphics = None
    if options.graphics is not None:
        _check_graphics(options)
    if options.method == "loewner" and options.as_printed:
        raise ConverseError("--as-printed is the thesis's method; leave out --method loewner")
    if options.backup is not None:
        files.check_new(options.backup, options.restore)
    restored = None if options.restore is None else Proof.load(options.restore)
    if options.together and restored is not None and not restored.problem.together:
        raise ConverseError("%s: is of another run: its parameters do not move together; leave out "
                            "--together" % options.restore)
    problem = _read_problem(options, restored)
    settings = Settings() if restored is None else restored.settings
    if restored is None and (options.method or settings.method) != "loewner":
        if problem.together:
            raise ConverseError("%s needs --method loewner" % (
                "--together" if options.together else "an input whose amplitudes move together"))
        if problem.general is not None:
            raise ConverseError("the method of the thesis takes ranges of a, b and c alone; for this "
                                "input give --method loewner")

    def on_leaf(leaf, points):
        say(_leaf_line(leaf, points) + "\n")

    def begun():
        options.kept = bool(options.backup or options.restore)

    progress = Progress(problem, options.as_printed or settings.as_printed,
                        not options.verbose, begun)
    asked = {name: getattr(options, name) for name in (
        "method", "depth", "digits", "stubborn", "as_printed", "xstar", "backup", "time_limit")}
    with contextlib.closing(progress), workers(options) as executor:
        proof = prove(problem, resume=options.restore, jobs=options.jobs, executor=executor,
                      progress=progress, on_leaf=on_leaf if options.verbose else None, **asked)
    if not progress.started:            # there was no time even to set the search up
        progress(0.0, proof.counts)
    say(verdict(proof))
    if options.graphics is not None:
        proof.figure(options.graphics)
    return STATUS[proof.conclusion]


@contextlib.contextmanager
def _warnings_in_lines(command, unsaved):
    """Meanwhile a warning is a line, but that the end of a run is not saved is kept in unsaved."""
    def show(message, category, *_):
        if issubclass(category, NotSaved):
            unsaved.append(str(message))
        else:
            _tell(message, command)

    with warnings.catch_warnings():
        warnings.simplefilter("always", RuntimeWarning)
        warnings.showwarning = show
        yield


def ended(command, run, interrupted):
    """The exit status of run(); every failure is one line on stderr, headed by the command's name.
    interrupted() says what Ctrl-C leaves behind."""
    heard, unsaved = [], []
    try:
        if None in (sys.stdout, sys.stderr):
            return BAD                      # a standard stream is closed: nowhere to say so
        for stream in (sys.stdout, sys.stderr):
            stream.reconfigure(errors="backslashreplace")
        with interruptible(ENDING, at_end=True) as heard, _warnings_in_lines(command, unsaved):
            status = run()
        if not unsaved:
            return status
        message = ""
    except SystemExit as end:               # of --help and --version
        return end.code
    except (ConverseError, InputError, MemoryError) as error:
        message, status = str(error) or "there is not enough memory", BAD
        if isinstance(error, WorkersGone) and not unsaved:
            message += "; " + interrupted()
    except KeyboardInterrupt:
        message = "interrupted" if unsaved else "interrupted; " + interrupted()
        status = ENDED_BY + (heard or [signal.SIGINT])[0]
    except ImportError as error:        # of what is imported late: libraries are mapped then
        message, status = "a part of Python cannot be loaded (%s); give it more memory, or install " \
                          "it anew" % error, BAD
    except OSError as error:
        message, status = "the output cannot be written (%s)" % files.reason(error), BAD
        with contextlib.suppress(OSError):  # the interpreter must not try again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if unsaved:
        message, status = "; ".join(filter(None, [message, *unsaved])), BAD
    _tell(message, command)
    return status


def main(argv=None):
    """Runs the command and returns its exit status."""
    options = argparse.Namespace(backup=None, restore=None, kept=False)

    def interrupted():
        backup = options.backup or options.restore
        if options.kept:
            return "continue with -r " + backup
        return "nothing was found yet" if backup else "without -b nothing is kept"

    return ended("converse", lambda: run(parser().parse_args(argv, options)), interrupted)


if __name__ == "__main__":
    sys.exit(main())
