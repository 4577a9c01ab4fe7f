"""The C core in terms of Python."""

import math
import os
import threading
from dataclasses import asdict, dataclass, fields, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Dict, List, Optional, Tuple

from ..model.exact import decimal_text
from ..model.problem import Problem
from ..storage.files import ConverseError
from ..version import __version__
from . import tree
from .settings import Settings


def _without_core(error):
    """Why the C core cannot be loaded, and what to do."""
    if "libgmp" in str(error):
        return "the C core needs GMP (%s); install its library (Debian: libgmp10)" % error
    if getattr(error, "name", None) == "_cffi_backend":
        return "the C core needs cffi (%s); pip install cffi" % error
    home = str(Path(__file__).resolve().parents[2])
    if os.path.isfile(os.path.join(home, "setup.py")):
        return ("the sources in %s, which Python takes for the package, have no C core (%s); run "
                "make there and use its .venv/bin/python, or, where the package is installed, "
                "start Python elsewhere" % (home, error))
    return ("the C core is missing (%s); with a C compiler and the headers of Python and GMP, run "
            "pip install . in the sources of converse %s" % (error, __version__))


try:
    from .._native import ffi, lib
except ImportError as error:            # not built, or for another Python, or without cffi
    raise ConverseError(_without_core(error)) from None

METHODS = {"thesis": lib.CV_THESIS, "loewner": lib.CV_LOEWNER}
CONSTANTS = {                       # by method, the numbers of the theorem that are recorded
    "thesis": {"T": lib.CV_T, "Tr-": lib.CV_TRACE_MIN, "Tr+": lib.CV_TRACE_MAX, "B": lib.CV_B,
               "lambda-min": lib.CV_LAM_MIN, "lambda-max": lib.CV_LAM_MAX},
    "loewner": {"B": lib.CV_B},
}
MESSAGES = {
    lib.CV_ENUMBER: "a number is malformed or out of range",
    lib.CV_EARGUMENT: "an argument makes no sense",
    lib.CV_EARITHMETIC: "the arithmetic failed: a division by zero, a root of a negative number "
                        "or lost precision; try more digits, or parameters that are not as large",
    lib.CV_ESINGULAR: "the matrix could not be inverted at any sensible precision",
    lib.CV_EMACHINE: "this machine's floating-point arithmetic, or the way the program was "
                     "built, breaks the rules that the proof relies on",
}


class WrongTree(ConverseError):
    """A tree that no search of this kind can have grown."""

    def __init__(self, wrong="the tree does not belong to a search of this kind"):
        super().__init__(wrong)


def check(code):
    """Turns an error code of the C core into an exception; passes any other code on."""
    if code == lib.CV_ENOMEM:
        raise MemoryError("there is not enough memory")
    if code < 0:
        raise ConverseError(MESSAGES.get(code, "the C core failed with code %d" % code))
    return code


TOO_LONG = lib.CV_REASON_TOO_LONG       # index of Counts.reasons
MAXIMA = "most_cuts", "max_steps", "max_NTsteps"    # of Counts: all other fields are sums


@dataclass(frozen=True)
class Counts:
    """The statistics of a search; names after the thesis and csrc/converse.h.

    Attributes
    ----------
    quick_tries
        Tries of prisms on their centre alone (thesis's method).
    tries
        Tries in double precision; with the sharper method they are rigorous.
    Rtries
        Tries in exact decimals.
    cuts, proved, symmetric, undecided
        The nodes of the tree by kind.
    HermSuccess, LLSuccess
        Prisms proved by the trace, and by the least eigenvalue.
    ll_used
        Best bounds by maxBlam, by minBlam and by the trace.
    reasons
        Tries without a proof, in the order of report.REASONS.
    most_cuts
        The most cuts of a proved prism.
    max_steps
        The longest orbit of the tries in double precision (thesis's method).
    max_NTsteps
        The longest orbit of a proved prism.
    linked
        Leaves linked to another part, of which the core knows nothing.
    """

    quick_tries: int = 0
    tries: int = 0
    Rtries: int = 0
    cuts: int = 0
    proved: int = 0
    symmetric: int = 0
    undecided: int = 0
    HermSuccess: int = 0
    LLSuccess: int = 0
    ll_used: Tuple[int, ...] = (0, 0, 0)
    reasons: Tuple[int, ...] = (0,) * lib.CV_N_REASONS
    most_cuts: int = 0
    max_steps: int = 0
    max_NTsteps: int = 0
    linked: int = 0

    def __add__(self, other):
        """The statistics of both searches together."""
        both = {}
        for name, mine in asdict(self).items():
            theirs = getattr(other, name)
            if isinstance(mine, tuple):
                both[name] = tuple(map(sum, zip(mine, theirs)))
            else:
                both[name] = (max if name in MAXIMA else int.__add__)(mine, theirs)
        return Counts(**both)


# The most points of an orbit, except where longer orbits may prove more (orbit_length.py).  The
# standard map needs 3,798 points for k = 0.972.
ORDINARY = 4000


@dataclass(frozen=True)
class Task:
    """All that a worker must know of a search, as plain data.  xstar None: one is to be chosen.
    longest: the most points of an orbit; 0: as many as the core can follow; -n: n points, and the
    search ends before a prism whose orbit may need more."""

    problem: Problem
    settings: Settings
    xstar: Optional[Tuple[str, str]] = None
    longest: int = ORDINARY


@dataclass(frozen=True)
class Begun:
    """The state of a search before the first prism is tried.

    A cell here is (index, cuts, hint), the hint being what the C core learnt from its parent."""

    xstar: Tuple[str, str]
    constants: Dict[str, str]
    at_once: bool
    cells: List[tuple]                  # yet to be decided, in preorder
    counts: Counts                      # of the nodes of the tree alone


@dataclass
class Grown:
    """The result of a worker: the text, the cells that follow it, the lengths of orbits; long: may
    the first of the cells need a longer orbit than the task allows?"""

    text: str
    steps: List[int]                    # of each node; empty if nobody wants them
    cells: List[tuple]
    counts: Counts
    long: bool = False


def native_text(text, owners):
    """A string of the C core's, which lives as long as owners."""
    owners.append(ffi.new("char[]", text.encode("ascii")))
    return owners[-1]


def native_problem(problem, owners):
    """A problem as the C core takes it, which lives as long as owners; the waves that the search
    does not need are nothing in it."""
    def text(x):
        return native_text(decimal_text(x), owners)

    waves = ffi.new("cv_wave[]", [
        {"k": wave[:2], "phase": native_text(_nearly(wave[2]), owners),
         "amplitude": text(p if i in problem.searched else 0),
         "part": [text(part if i in problem.searched else 0) for part in parts]}
        for i, (wave, p, *parts) in enumerate(zip(problem.waves, problem.amplitude,
                                                  *problem.parts))])
    owners.append(waves)
    ends = problem.v0, problem.v1
    return ffi.new("cv_problem *", {
        "n_waves": len(problem.waves), "n_parameters": len(problem.parts), "waves": waves,
        "angle": [text((low + high) / 2) for low, high in ends],
        "half": [text((high - low) / 2) for low, high in ends],
        "shift": [[text(pair[i]) for pair in problem.shifts] for i in range(2)],
        "frame": problem.frame, "odd": problem.odd is not None})


def _nearly(phase):
    """A rational number as a decimal, to less than 10^-40."""
    scale = 10 ** 41
    return decimal_text(Fraction(phase.numerator * scale // phase.denominator, scale))


def _handle(stop):
    """The argument of the C core for a Stop or None."""
    return ffi.NULL if stop is None else stop.handle


class Search:
    """A search in the C core; stop: a Stop, or None."""

    def __init__(self, task):
        owners, settings = [], task.settings
        handle = ffi.new("cv_search **")
        check(lib.cv_search_new(
            handle, native_problem(task.problem, owners),
            [native_text(x, owners) for x in task.xstar] if task.xstar else ffi.NULL,
            METHODS[settings.method], settings.digits, settings.depth, settings.stubborn,
            settings.as_printed, task.longest))
        self.handle = ffi.gc(handle[0], lib.cv_search_free)
        self.task = task

    def prepare(self, stop):
        """Sets the search up; False if it was stopped, and then it is good for nothing."""
        return check(lib.cv_prepare(self.handle, _handle(stop))) == lib.CV_OK

    def begin(self, tree):
        """Takes up a tree; ConverseError if it does not belong to a search of this kind."""
        if not tree.isascii():
            raise WrongTree()
        code = lib.cv_resume(self.handle, tree.encode("ascii"), len(tree))
        if code == lib.CV_EARGUMENT:
            raise WrongTree()
        check(code)
        return Begun(self.xstar(),
                     {name: _decimal(lib.cv_constant(self.handle, which)) for name, which
                      in CONSTANTS[self.task.settings.method].items()},
                     bool(lib.cv_at_once(self.handle)), *self._state())

    def grow(self, cells, seconds, max_leaves, stop, want_steps, max_points=math.inf):
        """Decides cells, and the cells that they are cut into, until about `seconds` passed or
        there are max_leaves leaves or max_points points of orbits."""
        check(lib.cv_restart(self.handle, len(cells), cells))
        code = check(lib.cv_step(self.handle, max_leaves, max_points, seconds, _handle(stop)))
        size = ffi.new("size_t *")
        text, size = lib.cv_tree(self.handle, size), size[0]
        return Grown(ffi.unpack(text, size).decode("ascii") if size else "",
                     ffi.unpack(lib.cv_steps(self.handle), size) if size and want_steps else [],
                     *self._state(), long=code == lib.CV_LONG)

    def _state(self):
        pending = ffi.new("cv_cell[]", lib.cv_pending(self.handle, ffi.NULL))
        lib.cv_pending(self.handle, pending)
        counts = lib.cv_get_counts(self.handle)
        values = {item.name: getattr(counts, item.name, 0) for item in fields(Counts)}
        return ([(tuple(cell.index), tuple(cell.cuts), cell.hint) for cell in pending],
                Counts(**{name: value if isinstance(value, int) else tuple(value)
                          for name, value in values.items()}))

    def xstar(self):
        return tuple(_decimal(lib.cv_xstar(self.handle, i)) for i in range(2))


def _decimal(text):
    """A number that the core hands over."""
    if not text:
        raise MemoryError("there is not enough memory")
    text = ffi.gc(text, lib.cv_free)
    return str(Decimal(ffi.string(text).decode("ascii")))


_mine = threading.local()               # each thread's last search: making one takes time


def _search(task, stop):
    """This thread's search for a task, or None if it was stopped while it was made."""
    if getattr(_mine, "task", None) != task:
        _mine.task = None
        search = Search(task)
        if not search.prepare(stop):
            return None
        _mine.search, _mine.task = search, task
    return _mine.search


class Stop:
    """A request, which another thread of this process may make, that begin or grow return soon."""

    def __init__(self):
        self.handle = ffi.gc(lib.cv_stop_new(), lib.cv_stop_free)
        if not self.handle:
            raise MemoryError("there is not enough memory")

    def set(self):
        lib.cv_stop_set(self.handle)

    def is_set(self):
        return bool(lib.cv_stop_get(self.handle))


def chosen_start(task):
    """The x* that a search would choose."""
    search = Search(task)
    return search.xstar()


def begin(task, tree, stop):
    """Sets up a search and takes up a tree.  Called by a worker; None if stopped."""
    search = _search(task, stop)
    if search is None:
        return None
    begun = search.begin(tree)
    _mine.task = replace(task, xstar=begun.xstar)       # the search serves this, too
    return begun


def grow(task, cells, seconds, max_leaves, want_steps, stop=None):
    """Grows cells.  Called by a worker; None if it was stopped before it could begin."""
    try:
        search = _search(task, stop)
        return search and search.grow(cells, seconds, max_leaves, stop, want_steps)
    except BaseException:
        _mine.task = _mine.search = None    # nobody knows in what state it is
        raise


def survey(task, leaves, points, stop=None):
    """Grows a tree from its root.  The search ends with `leaves` leaves or when its orbits had
    about `points` points.  None if it was stopped before that."""
    search = Search(task)
    if not search.prepare(stop):
        return None
    grown = search.grow([(*tree.ROOT, 0)], math.inf, leaves, stop, True, points)
    return None if grown.cells and stop is not None and stop.is_set() else grown
