"""The C core in terms of Python."""

import math
import os
import threading
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import List, Optional, Tuple

from ..model.exact import decimal_text
from ..model.map import HIGHEST
from ..model.problem import Problem, rows
from ..model.region import symmetric
from ..storage.files import ConverseError
from ..storage.signals import Resource, postponed
from ..version import __version__
from .settings import Settings
from .tree import UNTRIED
from .workers import LOOK_SECONDS


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
PHASE_PLACES = 41                   # of phases in the core: see csrc/converse.h
MANY = 2 ** 30                      # No search has as many leaves.
SWAPPED = str.maketrans("01", "10")
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

    @property
    def decided(self) -> int:
        """The number of leaves that are not linked."""
        return self.proved + self.symmetric + self.undecided

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
# standard map needs 3,735 points for k = 0.972.
ORDINARY = 4000


@dataclass(frozen=True)
class Task:
    """All that a worker must know of a search, as plain data.  xstar None: one is to be chosen.
    longest: the most points of an orbit; 0: as many as the core can follow; -n: n points, and the
    search ends before a prism whose orbit may need more."""

    problem: Problem
    settings: Settings
    xstar: Optional[Tuple[str, ...]] = None
    longest: int = ORDINARY


@dataclass(frozen=True)
class Grown:
    """A part of a tree: nodes, and cells that are yet to be decided.

    text: the nodes in preorder; a ? stands for each of the cells, but not for those at the end.
    steps: the lengths of their orbits, if one search has grown it.
    counts: the statistics, in which nodes that were taken up do not count.
    cells: in preorder, each (index, cuts, hint): see cv_cell in csrc/converse.h.
    examined: the share of parameters and angles that lies in its leaves.
    finished: is every prism decided, or one undecided in a search that is not stubborn?
    needs_long: did it end before a prism that may need a longer orbit than the task allows?
    points: how many the orbits of all its tries have.
    settled: the statistics up to the first prism on which somebody works: what depends on them does
    not depend on the workers.  None: they are all."""

    text: str = ""
    steps: List[int] = field(default_factory=list)
    counts: Counts = Counts()
    cells: List[tuple] = field(default_factory=list)
    examined: float = 0.0
    finished: bool = False
    needs_long: bool = False
    points: float = 0.0
    settled: Optional[Counts] = None

    def followed_by(self, other: "Grown") -> "Grown":
        """The part that this one, whose cells were decided or none, is together with the next."""
        return Grown(self.text + other.text, [], self.counts + other.counts, other.cells)


def native_text(text, owners):
    """A string of the C core's, which lives as long as owners."""
    owners.append(ffi.new("char[]", text.encode("ascii")))
    return owners[-1]


@dataclass(frozen=True)
class OneAngle:
    """The only angle q.y that the waves of a search depend on, where x_1 has q.x_1 = c v_i.

    With |q|^2 times their amplitudes the waves k = m q are waves m of it; see section 2 of
    docs/proofs/argument.md."""

    q: Tuple[int, int]
    i: int
    c: int

    @classmethod
    def of(cls, problem):
        """None: there is none."""
        k = [term.k for term in problem.searched if term.most]
        if problem.size != 2 or not k or any(a * d != b * c for a, b in k for c, d in k[:1]):
            return None
        q = tuple(x // math.gcd(*k[0]) for x in k[0])
        felt = [(i, c) for i in range(2)
                for c in [sum(a * b for a, b in zip(q, problem.frame[i::2]))] if c]
        return cls(q, *felt[0]) if len(felt) == 1 and abs(felt[0][1]) <= HIGHEST else None

    def along(self, x):
        """q.x of two decimals, as text."""
        return decimal_text(sum(a * Fraction(b) for a, b in zip(self.q, x)))

    def point(self, s):
        """Two decimals x with q.x = s, the same where q is a coordinate."""
        a, b = self.q
        x = a + b if 0 in self.q else pow(a, -1, abs(b))
        y = x if 0 in self.q else (1 - x * a) // b
        return str(x * Decimal(s)), str(y * Decimal(s))


def native_problem(problem, owners, one=None):
    """A problem as the C core takes it, which lives as long as owners; the waves that the search
    does not need are nothing in it.  one: the OneAngle that is all it has."""
    def text(x):
        return native_text(decimal_text(x), owners)

    def wave(term):
        there = term in problem.searched
        k, size = term.k, 1
        if one:
            size = sum(x * x for x in one.q)
            k = [sum(a * b for a, b in zip(k, one.q)) // size]
        turns = 2 * term.phase % 4
        return {"k": k, "phase": native_text(_nearly(turns / 2), owners),
                "quarters": int(turns) if turns.denominator == 1 else -1,
                "amplitude": text(size * term.p if there else 0),
                "part": [text(size * part if there else 0) for part in term.parts]}

    waves = ffi.new("cv_wave[]", [wave(term) for term in problem.terms
                                  if not one or term in problem.searched and term.most])
    owners.append(waves)
    angles = [one.i] if one else range(problem.size)
    ends = [problem.region[i] for i in angles]
    return ffi.new("cv_problem *", {
        "n_angles": len(ends), "n_waves": len(waves), "n_parameters": len(problem.parts),
        "waves": waves,
        "angle": [text((low + high) / 2) for low, high in ends],
        "half": [text((high - low) / 2) for low, high in ends],
        "shift": [[text(shift[i]) for shift in problem.shifts] for i in angles],
        "frame": [[one.c]] if one else rows(problem.frame), "odd": problem.odd is not None,
        "symmetric": not one and symmetric(problem)})


def _nearly(phase):
    """A rational number as a decimal, to PHASE_PLACES."""
    scale = 10 ** PHASE_PLACES
    return decimal_text(Fraction(phase.numerator * scale // phase.denominator, scale))


class _Threads(Resource):
    """Threads that call something of the core's for a search; fewer if the system has no more."""

    def __init__(self, call, handle, number):
        self.handle, self.codes = handle, []
        self.threads = [threading.Thread(target=lambda: self.codes.append(call(handle)))
                        for _ in range(number)]

    def acquire(self):
        with suppress(RuntimeError):    # none more can be started
            for thread in self.threads:
                thread.start()

    def wait(self):
        """Waits for LOOK_SECONDS at most; does a thread still run?"""
        self.threads = [thread for thread in self.threads if thread.is_alive()]
        with postponed():
            for thread in self.threads[:1]:
                thread.join(LOOK_SECONDS)
        return any(thread.is_alive() for thread in self.threads)

    def release(self):
        lib.cv_halt(self.handle)
        for thread in self.threads:
            if thread.ident:
                thread.join()


class Search:
    """A search in the C core, which begins with the whole root as its only cell."""

    def __init__(self, task):
        owners, settings, xstar = [], task.settings, task.xstar
        self.one = OneAngle.of(task.problem) if settings.method == "loewner" else None
        handle, self.size = ffi.new("cv_search **"), task.problem.size
        if xstar and self.one:
            xstar = [self.one.along(xstar)]
        check(lib.cv_search_new(
            handle, native_problem(task.problem, owners, self.one),
            [native_text(x, owners) for x in xstar] if xstar else ffi.NULL,
            METHODS[settings.method], settings.digits, settings.depth, settings.stubborn,
            settings.as_printed, task.longest))
        self.handle = ffi.gc(handle[0], lib.cv_search_free)
        self.method, self.given = settings.method, task.xstar
        self.swaps = self.one is not None and self.one.i == 1   # the core's angle 0 is v1

    @property
    def xstar(self):
        if self.one:
            return tuple(str(Decimal(x)) for x in self.given) if self.given else \
                self.one.point(_decimal(lib.cv_xstar(self.handle, 0)))
        return tuple(_decimal(lib.cv_xstar(self.handle, i)) for i in range(self.size))

    def _letters(self, text):
        """A tree of the core's as a file has it."""
        return text.translate(SWAPPED) if self.swaps else text

    def _axes(self, numbers):
        """The same of a cell's index or cuts."""
        return (numbers[1], numbers[0], *numbers[2:]) if self.swaps else tuple(numbers)

    @property
    def constants(self):
        """The numbers of the theorem, by name; 0 before the search is set up."""
        return {name: _decimal(lib.cv_constant(self.handle, which))
                for name, which in CONSTANTS[self.method].items()}

    @property
    def at_once(self):
        return bool(lib.cv_at_once(self.handle))

    def has_axis(self, axis):
        """May a cell be cut along it?"""
        return bool(lib.cv_has_axis(self.handle, 1 - axis if self.swaps and axis < 2 else axis))

    @property
    def skips(self):
        """Are mirror images skipped?"""
        return bool(lib.cv_skips(self.handle))

    def restart(self, text, cells):
        """Forgets the tree, and takes up another one, or trees that follow each other: these cells
        are to be decided now, for each of which the text has a ?."""
        check(lib.cv_restart(self.handle, self._letters(text).encode("ascii"), [
            (self._axes(index), self._axes(cuts), hint) for index, cuts, hint in cells]))

    def work(self, threads, look, leaves=MANY, points=math.inf):
        """Lets threads decide prisms, until there are as many leaves more or the orbits have as
        many points more; with 0 threads the search is only set up.  look() is called a few times a
        second, and ends the work when it returns True.  Returns whether it did not.  A search whose
        setting up was ended is good for nothing."""
        if not self._call(lib.cv_set_up, 1, look):
            return False
        check(lib.cv_begin(self.handle, min(leaves, MANY), points))
        return self._call(lib.cv_work, threads, look)

    def _call(self, call, threads, look):
        """Calls this of the core in threads; look() as of work()."""
        with _Threads(call, self.handle, threads) as started:
            while started.wait():
                if look():
                    return False
        for code in started.codes or [lib.CV_ENOMEM] * min(threads, 1):
            check(code)
        return True

    def view(self, whole=False):
        """The tree as grown by now; without its text and cells, unless it is wanted whole."""
        view = ffi.gc(ffi.new("cv_view *"), lib.cv_forget_view)
        check(lib.cv_look(self.handle, whole, view))
        text = ffi.unpack(view.tree, view.length).decode("ascii") if view.length else ""
        text = self._letters(text.rstrip(UNTRIED))
        return Grown(
            text, ffi.unpack(view.steps, len(text)) if text else [], _counts(view.counts),
            [(self._axes(cell.index), self._axes(cell.cuts), cell.hint) for cell in
             (view.cells[n] for n in range(view.n_cells))],
            view.examined, bool(view.finished), bool(view.needs_long), view.points)

    def grow(self, cells=None, leaves=MANY, points=math.inf, threads=1, look=bool):
        """The trees of these cells, or of those that are yet to be decided, when work() ends."""
        if cells is not None:
            self.restart(UNTRIED * len(cells), cells)
        self.work(threads, look, leaves, points)
        return self.view(True)


def _counts(counts):
    values = {item.name: getattr(counts, item.name, 0) for item in fields(Counts)}
    return Counts(**{name: value if isinstance(value, int) else tuple(value)
                     for name, value in values.items()})


def _decimal(text):
    """A number that the core hands over."""
    if not text:
        raise MemoryError("there is not enough memory")
    text = ffi.gc(text, lib.cv_free)
    return str(Decimal(ffi.string(text).decode("ascii")))


def chosen_start(task):
    """The x* that a search would choose."""
    return Search(task).xstar


def grow(task, leaves=MANY, points=math.inf, threads=1, look=bool):
    """The tree of the root: see Search.work.  None: look() returned True before the end."""
    search = Search(task)
    if not (search.work(0, look) and search.work(threads, look, leaves, points)):
        return None
    return search.view(True)
