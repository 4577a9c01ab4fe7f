"""Parts of all commands: types of arguments, output, workers, and the end of a command."""

import argparse
import contextlib
import math
import os
import re
import signal
import sys
import time
import warnings

from ..prover.settings import LIMIT
from ..storage import files
from ..storage.files import ConverseError, NotSaved, WorkersGone, plain
from ..storage.signals import ENDING, interruptible
from ..version import __version__

BAD, ENDED_BY = 2, 128                  # exit statuses; the signal's number is added to the second
REFRESH_SECONDS, LINE_SECONDS = 0.25, 60.0       # between texts of progress on a terminal; of lines


# ---- arguments

class _Formatter(argparse.HelpFormatter):
    """A text with line ends is shown unchanged, and any other text is filled."""

    def _fill_text(self, text, width, indent):
        return text if "\n" in text else super()._fill_text(text, width, indent)


class Parser(argparse.ArgumentParser):
    """Bad usage is a ConverseError, so that it becomes one line like every other failure.
"""

    def __init__(self, **options):
        super().__init__(**{"formatter_class": _Formatter, "allow_abbrev": False, **options})
        self._negative_number_matcher = re.compile(r"-\.?\d")     # -1e-3 and -0.1:0 are values
        self.add_argument("--version", action="version", version="%(prog)s " + __version__)

    def _get_value(self, action, arg_string):
        """The value of an argument by its type, whose ValueError names the fault."""
        try:
            return self._registry_get("type", action.type, action.type)(arg_string)
        except ValueError as error:
            raise argparse.ArgumentError(action, str(error)) from None

    def error(self, message):
        raise ConverseError("%s; see %s --help" % (message, self.prog))

    def _print_message(self, message, file=None):
        """Writes as argparse does, except that errors of writing are not ignored."""
        (file or sys.stderr).write(message)


MAP = ("the map  y' = y + J',  J' = J - grad V(y),  V(y) = - the sum of A sin(k.y + phase), "
       "of one or two angles y modulo 2 pi")
SIGNALS = "129, 130, 141, 143", "ended by SIGHUP, Ctrl-C, a closed pipe or SIGTERM"


def ending(example, others, statuses):
    """The end of a help text: an example, the commands to look at as well, the exit statuses."""
    width = max(len(str(status)) for status, _ in statuses)
    return "example:\n%s\n\nsee also:\n%s\n\nexit status:\n%s" % tuple("\n".join(
        "  " + line for line in lines) for lines in (
            example.split("\n"), others.split("\n"),
            ["%-*s  %s" % (width, *status) for status in statuses]))


def whole_number(least, most=LIMIT):
    """The type of an argument that is a whole number from least to most."""
    def convert(text):
        try:
            number = int(text) if text.isascii() else None      # int() knows other digits, too
        except ValueError:
            number = None
        if number is None or not least <= number <= most:
            raise ValueError("'%s' is not a whole number from %d to %d" % (text, least, most))
        return number
    return convert


def number(text):
    """The type of an argument that is an exact number."""
    from ..model.exact import exact  # late, as all that --help and --version do without
    return exact(text)


def seconds(text):
    """The type of an argument that is a duration in seconds, perhaps infinite."""
    with contextlib.suppress(ValueError):
        if float(text) >= 0:
            return float(text)
    raise ValueError("'%s' is not a number of seconds" % text)


INPUT = "input file, the thesis's or JSON; standard input if it is - or left out"


def add_files(p, kept, drawn, resumed):
    """Adds the options -b, -r and -g of a command.

    kept: what -b keeps; drawn: what -g draws; resumed: the help of -r"""
    p.add_argument("-b", "--backup", metavar="FILE", help="keep %s in the new file FILE; "
                   "compressed if its name ends in .gz" % kept)
    p.add_argument("-r", "--restore", metavar="FILE", help=resumed)
    p.add_argument("-g", "--graphics", metavar="FILE",
                   help="draw %s in FILE: SVG, PNG or PDF by its name" % drawn)


def add_worker_options(p, what):
    """Adds the options --jobs, --dask and --time-limit of a command that works on several `what`
    at a time."""
    p.add_argument("--jobs", type=whole_number(1), metavar="N",
                   help="work on N %s at a time (default: one per core)" % what)
    p.add_argument("--dask", metavar="ADDRESS", help="let the Dask cluster at ADDRESS work")
    p.add_argument("--time-limit", type=seconds, default=math.inf, metavar="SECONDS",
                   help="stop after about this time on the clock; -r continues")


TOGETHER = "a, b and c move together along the segment from all lower to all upper ends"


def check_figure(options, *others):
    """Refuses a figure of -g that cannot be drawn, or would overwrite one of the other files."""
    if options.graphics is not None:
        from ..draw import plot  # it takes a while
        plot.check_file(options.graphics, others)


# ---- output

def say(text):
    """Writes to standard output immediately."""
    sys.stdout.write(text)
    sys.stdout.flush()


def tell(message, command="converse"):
    """Writes one line to stderr, headed by the command's name, whatever the message contains."""
    ProgressLine.clear()
    with contextlib.suppress(OSError):
        print("%s: %s" % (command, plain(" ".join(str(message).split()))), file=sys.stderr,
              flush=True)


class ProgressLine:
    """The progress of a command: on a terminal one line of stderr, rewritten a few times a second;
    elsewhere a line a minute.  It is a context manager, which clears the line in the end."""

    length = 0                          # of the line that is on the terminal now, whoever wrote it

    def __init__(self, command="converse"):
        self.command, self.shown = command, sys.stderr.isatty()
        self.began = time.monotonic()
        self.due = 0.0 if self.shown else self.began + LINE_SECONDS

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.clear()

    def __call__(self, words):
        """Shows the time that passed and the text words(), which is called only when it is due."""
        now = time.monotonic()
        if now >= self.due:
            self.due = now + (REFRESH_SECONDS if self.shown else LINE_SECONDS)
            passed = int(now - self.began)
            text = "%d:%02d:%02d %s" % (passed // 3600, passed // 60 % 60, passed % 60, words())
            if self.shown:
                self._write(text)
            else:
                tell(text, self.command)

    @staticmethod
    def _write(text):
        with contextlib.suppress(OSError):
            text = text[:(os.get_terminal_size(sys.stderr.fileno()).columns or 80) - 1]
            sys.stderr.write("\r" + text.ljust(ProgressLine.length) + ("" if text else "\r"))
            sys.stderr.flush()
            ProgressLine.length = len(text)

    @staticmethod
    def clear():
        """Clears the terminal's line, so that other lines can follow."""
        if ProgressLine.length:
            ProgressLine._write("")


# ---- workers

@contextlib.contextmanager
def workers_of(options):
    """The keywords jobs, time_limit and executor of a run, as add_worker_options has them."""
    given = {"jobs": options.jobs, "time_limit": options.time_limit}
    if options.dask is None:
        yield given
    else:
        import logging
        try:
            from distributed import Client
        except ImportError:
            raise ConverseError("--dask needs dask; pip install 'converse-kam[dask]'") from None
        logging.disable()               # Dask's; failures of its workers are told in one line
        try:
            client = Client(options.dask, timeout=10)
        except (OSError, ValueError, TypeError) as error:
            raise ConverseError("there is no Dask scheduler at %s (%s); name another address"
                                % (options.dask, error or type(error).__name__)) from None
        try:
            yield {**given, "executor": client.get_executor()}
        finally:
            with contextlib.suppress(Exception):        # the scheduler may be gone
                client.close()


# ---- the input

def read_problem(name, command="converse", together=False):
    """The Problem in an input file, or in standard input if the name is None or -.  together: a, b
    and c move together."""
    from ..model.inputs import read_input

    source = name
    if source in (None, "-"):
        source = sys.stdin
        if source is None:
            raise ConverseError("standard input is closed; name an input file")
        if source.isatty():
            tell("reading the problem from standard input; end it with Ctrl-D", command)
    problem = read_input(source)
    if not together:
        return problem
    if not problem.by_ranges:
        raise ConverseError("--together is for ranges of a, b and c; name a parameter in the input "
                            "instead")
    return problem.tied()


# ---- the end of a command

@contextlib.contextmanager
def _warnings_in_lines(command, unsaved):
    """A context that prints each RuntimeWarning as one line.  The text of NotSaved is appended to
    the list `unsaved` instead, and becomes a part of the command's last line."""
    def show(message, category, *_):
        if issubclass(category, NotSaved):
            unsaved.append(str(message))
        else:
            tell(message, command)

    with warnings.catch_warnings():
        warnings.simplefilter("always", RuntimeWarning)
        warnings.showwarning = show
        yield


def _make_stderr():
    """Opens a closed standard error, so that no backup gets its number."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False)


def ended(command, run, interrupted):
    """The exit status of run(); every failure is one line on stderr, headed by the command's name.
    interrupted() returns a text about what Ctrl-C leaves behind."""
    heard, unsaved = [], []
    try:
        if sys.stderr is None:
            _make_stderr()
        if sys.stdout is None:
            raise ConverseError("the standard output is closed; there is nowhere to report to")
        for stream in (sys.stdout, sys.stderr):
            stream.reconfigure(errors="backslashreplace")
        with interruptible(ENDING, at_end=True) as signals, _warnings_in_lines(command, unsaved):
            heard = signals.heard
            try:
                status = run()
            except SystemExit as end:   # of --help and --version
                status = end.code
            sys.stdout.flush()
        if not unsaved:
            return status
        message = ""
    except (ConverseError, ValueError, MemoryError) as error:   # ValueErrors tell bad arguments
        message, status = str(error) or "there is not enough memory", BAD
        if isinstance(error, WorkersGone) and not unsaved:
            message += "; " + interrupted()
    except KeyboardInterrupt:
        message = "interrupted" if unsaved else "interrupted; " + interrupted()
        status = ENDED_BY + (heard or [signal.SIGINT])[0]
    except ModuleNotFoundError as error:
        message, status = "%s is missing; pip install %s" % ((error.name,) * 2), BAD
    except ImportError as error:        # of a late import: memory may lack to map its library
        message, status = "a part of Python cannot be loaded (%s); give it more memory, or " \
                          "install it anew" % error, BAD
    except OSError as error:
        gone = isinstance(error, BrokenPipeError)       # the reader, such as head, had enough
        message = "" if gone else "the output cannot be written (%s)" % files.reason(error)
        status = ENDED_BY + signal.SIGPIPE if gone else BAD
        with contextlib.suppress(OSError):      # the interpreter must not try to flush it again
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if unsaved:
        message, status = "; ".join(filter(None, [message, *unsaved])), BAD
    if message:
        tell(message, command)
    return status


def kept(options):
    """The phrase about what an interrupted run has left."""
    file = options.restore or options.backup
    if file is None:
        return "nothing is kept without -b FILE"
    return "continue with -r " + file if os.path.exists(file) and os.path.getsize(file) else \
        "nothing was found yet"


def command(name, parser, run, interrupted, /, **options):
    """The function main() of a command.  interrupted(options) says what Ctrl-C leaves behind;
    options: those that it needs before the arguments are read."""
    def main(argv=None):
        """Runs the command and returns its exit status."""
        given = argparse.Namespace(**options)
        return ended(name, lambda: run(parser().parse_args(argv, given)),
                     lambda: interrupted(given))
    return main
