"""The command: converse [flags] < input > report."""

import argparse
import contextlib
import math
import os
import signal
import sys
import warnings
from dataclasses import replace

from . import files
from .files import ConverseError, plain
from .problem import InputError, decimal_text, parse_number, read_input
from .report import header, verdict
from .settings import AS_PRINTED, LIMIT, METHODS, REGION, THEOREM, UNDECIDED, Settings
from .version import __version__

STATUS = {THEOREM: 0, UNDECIDED: 1, REGION: 3, AS_PRINTED: 4}
BAD, ENDED_BY = 2, 128                  # the second plus the number of the signal
KIND_NAMES = {"P": "proved", "S": "symmetric", "U": "undecided"}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise ConverseError("%s; see %s --help" % (message, self.prog))


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
        "Exit status: 0 a theorem; 1 undecided; 2 bad usage, input or file; 3 decided for a part of "
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
                   help="draw the prisms in FILE, by its name as SVG, PNG or PDF, else as "
                        "PostScript; 'off' draws none (default)")
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
                        "-m converse.cli --mpi ...")
    p.add_argument("--time-limit", type=seconds, default=math.inf, metavar="SECONDS",
                   help="stop after about so long; what is left is undecided")
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
    with contextlib.suppress(OSError):
        print("%s: %s" % (command, plain(" ".join(str(message).split()))), file=sys.stderr,
              flush=True)


class Progress:
    """Prints the header when the search gets under way; then, on a terminal, keeps a bar that says
    how much of the work is behind, and an estimate of the time left."""

    def __init__(self, problem, as_printed, with_bar, begun):
        self.problem, self.as_printed, self.with_bar = problem, as_printed, with_bar
        self.started, self.bar, self.begun = False, None, begun

    def __call__(self, done, counts):
        if not self.started:
            self.started = True
            self.begun()
            if self.as_printed:
                _tell("--as-printed is a historical reconstruction, not a proof")
            say(header(self.problem, self.as_printed))
            with contextlib.suppress(ImportError):      # the extra "progress"
                if self.with_bar:
                    from tqdm import tqdm
                    self.bar = tqdm(total=1.0, leave=False, file=sys.stderr, bar_format=(
                        "{percentage:5.1f}% |{bar}| {elapsed}, about {remaining} left{postfix}"))
        if self.bar is not None:
            prisms = counts.proved + counts.symmetric + counts.undecided
            self.bar.n = done
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
            raise ConverseError("--dask needs dask; pip install 'converse-kam[dask]'") from None
        try:
            client = Client(options.dask, timeout=10)
        except (OSError, ValueError, TypeError) as error:
            raise ConverseError("there is no Dask scheduler at %s (%s); name another address"
                                % (options.dask, error or type(error).__name__)) from None
        with client:
            yield client.get_executor(), options.jobs or 2 * max(1, sum(client.nthreads().values()))


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
    together = options.together or (restored is not None and restored.problem.together)
    if together and problem.general is not None:
        raise ConverseError("--together is for ranges of a, b and c; name a parameter in the input "
                            "instead")
    return replace(problem, together=together or problem.together)


def _check_graphics(options):
    """Refuses a figure that cannot be written or would overwrite what the run reads or writes, or a
    proof."""
    from . import figure, picture       # these take a while

    path, others = options.graphics, [options.input, options.backup, options.restore]
    with contextlib.suppress(AttributeError, OSError, ValueError):
        others.append(sys.stdin.fileno())
    if not os.path.exists(path) or os.path.isfile(path):
        if any(other is not None and files.same(path, other) for other in others) or \
                files.is_proof(path):
            raise ConverseError("the figure would overwrite '%s'; name another file" % path)
    files.check_writable(path)
    if figure.format_of(path) != "ps":
        picture.check()


def run(options):
    from .proof import Proof            # these need the C core, and say so where it is missing
    from .run import prove

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
    if (options.method or settings.method) != "loewner":
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
                        sys.stderr.isatty() and not options.verbose, begun)
    asked = {name: getattr(options, name) for name in (
        "method", "depth", "digits", "stubborn", "as_printed", "xstar", "backup", "time_limit")}
    with contextlib.closing(progress), workers(options) as (executor, jobs):
        proof = prove(problem, resume=options.restore, jobs=jobs, executor=executor,
                      progress=progress, on_leaf=on_leaf if options.verbose else None, **asked)
    if not progress.started:            # there was no time even to set the search up
        progress(0.0, proof.counts)
    say(verdict(proof))
    if options.graphics is not None:
        proof.figure(options.graphics)
    if not proof.sha256 and (options.backup or options.restore):
        raise ConverseError("what was found is not saved")
    return STATUS[proof.conclusion]


@contextlib.contextmanager
def _signals_end(heard):
    """Meanwhile SIGTERM and SIGHUP end the program as Ctrl-C does, unless they were ignored.  Only
    the first signal counts, and is put into heard: another would strike while the backup is saved,
    or the process ends."""
    def end(number, _):
        heard.append(number)
        for other in before:            # a handler, since Python complains of one that is ignored
            before[other] = signal.SIG_IGN
            signal.signal(other, lambda *_: None)
        raise KeyboardInterrupt

    before = {}
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, end)
    except ValueError:                  # not the main thread, which alone hears of signals
        pass
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def _warnings_in_lines(command):
    with warnings.catch_warnings():
        warnings.simplefilter("always", RuntimeWarning)
        warnings.showwarning = lambda message, *_: _tell(message, command)
        yield


def ended(command, run, interrupted):
    """The exit status of run(); every failure is one line on stderr, headed by the command's name.
    interrupted() says what Ctrl-C leaves behind."""
    heard = []
    try:
        if None in (sys.stdout, sys.stderr):
            return BAD                      # a standard stream is closed: nowhere to say so
        for stream in (sys.stdout, sys.stderr):
            stream.reconfigure(errors="backslashreplace")
        with _signals_end(heard), _warnings_in_lines(command):
            return run()
    except SystemExit as end:               # of --help and --version
        return end.code
    except (ConverseError, InputError, MemoryError) as error:
        message, status = str(error) or "there is not enough memory", BAD
    except (KeyboardInterrupt, RuntimeError) as error:
        if isinstance(error, RuntimeError) and not heard:
            raise                       # else the signal struck inside the locks of a library
        message = "interrupted; " + interrupted()
        status = ENDED_BY + (heard or [signal.SIGINT])[0]
    except ImportError as error:        # of what is imported late: libraries are mapped then
        message, status = "a part of Python cannot be loaded (%s); give it more memory, or install " \
                          "it anew" % error, BAD
    except OSError as error:
        message, status = "the output cannot be written (%s)" % files.reason(error), BAD
        with contextlib.suppress(OSError):  # the interpreter must not try again when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
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
