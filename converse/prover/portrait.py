"""A phase portrait that is proved: where no rotational invariant circle of a map passes.

The map has one angle.  A column is a vertical line of phase space at x_0 = x*, or a strip about it,
|x_0 - x*| <= h.  A strip is a line of another map: of V(y + s), whose waves lie in a patch of two
parameters or three (docs/how-to/portrait.md).  Of each column one tree of prisms is grown to a
certain depth, and whatever is undecided then stays so.
"""

import concurrent.futures
import math
import re
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from ..model.exact import decimal_text, pi_bounds, rounded, rounded_text, whole_number
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..model.region import MARGIN, PLACES, reversal_centre
from ..model.statement import conditions, ended, indented, map_lines
from ..storage.backup import Backup
from ..storage.files import Path
from ..storage.kept import Kept, headline, program_of, sealed, verify_text
from ..storage.methods import provided
from ..storage.signals import interruptible
from ..version import __version__
from . import native
from .proof import Tree
from .proof_file import map_of, part_lines, tree_of, wave_lines
from .resume import check_release
from .settings import Settings
from .workers import Filling, WorkerPool

FIRST_LINE = "converse portrait 2"
DIGITS = 12                             # decimals of x* and of the width of strips
SHARE_DIGITS = 6                        # decimals of the share that a file says, rounded up
WIDEST = 0.5                            # half the width of a strip times k; share() needs less
MOST_COLUMNS = 1 << 16                  # a limit of the checker
# Of the slopes of strips: samples in half a turn of successors; points of their orbits to either
# side; the least sum of squares of an orbit that separates, whose slope does not matter; the least
# difference of slopes for which another piece begins, and how far it may move an end of a strip, in
# units of the height of the smallest prisms.
SAMPLES, STEPS, SEPARATED, TURNED, MOVED = 64, 12, 96.0, 0.1, 5.0
BARREN = re.compile("[0-4]UU")          # a cut that separates nothing proved


@dataclass(eq=False, repr=False)
class Portrait(Kept):
    """The proved part of the phase space of a map of one angle.

    Attributes
    ----------
    problem
        The map, whose amplitudes may have one parameter, or up to three without strips.
    strip
        Half the width of a column, in radians; 0: the columns are lines.
    even
        A point, in units of pi, about which V is even: then each column also stands for its mirror
        image.  None: there is none.
    depth
        The most cuts above a prism.
    columns
        How many columns the circle was to have.
    found
        By x*, the trees of the columns that are done, each over a region of successors: it moves
        along strips by the second parameter of `patch`.
    seconds
        The duration of the search.
    sha256
        The SHA-256 of the file, uncompressed; "" if there is none.
    version
        The release of the program that did the work.
    restored
        How many columns were read from a file, and are believed.
    """

    KIND = "portrait"

    problem: Problem
    strip: Fraction
    even: Optional[Fraction]
    depth: int
    columns: int
    found: Dict[Fraction, Tuple[Tree, ...]] = field(default_factory=dict)
    seconds: float = 0.0
    sha256: str = ""
    version: str = __version__
    restored: int = 0

    @classmethod
    def new(cls, source: Union[SymplecticMap, Problem], columns: int = 600, depth: int = 15,
            strips: bool = True) -> "Portrait":
        """An empty portrait of a map, for which portray() finds the columns.

        Parameters
        ----------
        source, columns, depth, strips
            As of portray().

        Raises
        ------
        TypeError, ValueError
            The numbers or the map do not suit.
        """
        problem = _of_circle(Problem.of(source))
        columns = whole_number(columns, "columns", 1, MOST_COLUMNS)
        depth = whole_number(depth, "depth", 1, 1000)
        even = _even(problem)
        count = -(-columns // 2) if even is not None else columns
        if not strips:
            return cls(problem, Fraction(0), even, depth, columns)
        if len(problem.waves) > 1 or len(problem.parts) > 1:
            raise ValueError("strips are for a single wave with at most one parameter; ask for "
                             "lines (strips=False, --lines)")
        length = pi_bounds(2 * DIGITS)[0] * (1 if even is not None else 2)
        strip = rounded(length / (2 * count) - Fraction(1, 10 ** DIGITS), DIGITS, up=False)
        if abs(problem.waves[0][0]) * strip > WIDEST:
            least = math.ceil(2 * math.pi * abs(problem.waves[0][0]) / (2 * WIDEST)) + 1
            raise ValueError("%d is too small a number of columns for strips; give at least %d"
                             % (columns, least))
        return cls(problem, strip, even, depth, columns)

    @property
    def turns(self) -> int:
        """The length of the interval in which all x* lie, in units of pi."""
        return 2 if self.even is None else 1

    @property
    def stars(self) -> List[Fraction]:
        """The x* of all columns, in radians."""
        count = -(-self.columns * self.turns // 2)
        begin = -1 if self.even is None else self.even
        low = rounded(max(begin * x for x in pi_bounds(2 * DIGITS)), DIGITS, up=True)
        half = self.strip or rounded(self.turns * pi_bounds(2 * DIGITS)[0] / (2 * count)
                                     - Fraction(1, 10 ** DIGITS), DIGITS, up=False)
        return [low + (2 * i + 1) * half for i in range(count)]

    @cached_property
    def patch(self) -> Problem:
        """The problem whose lines are the columns: docs/how-to/portrait.md."""
        if not self.strip:
            return self.problem
        ((k, _), phase, p, reach), = self.problem.terms
        g, = reach or (Fraction(0),)
        angle = k * self.strip
        bend = angle * angle / 4
        zero = Fraction(0)
        parts = [(bend * abs(p) + abs(g), zero), (zero, p * angle)] + [(zero, g * angle)] * bool(g)
        return Problem(SymplecticMap(((k, 0, phase), (k, 0, phase + Fraction(1, 2))),
                                     (p * (1 - bend), zero), parts))

    # ---- what is proved

    def share(self, xstar: Fraction) -> Fraction:
        """At most this share of a column is undecided.

        Parameters
        ----------
        xstar
            The x* of a column that is done, a key of `found`.

        Returns
        -------
        Fraction
            From 0 to 1.
        """
        angle = self.problem.waves[0][0] * self.strip
        lost = sum((high - low) * number / 2 ** (cuts[0] + (cuts[3] if self.strip else 0))
                   for region in self.found[xstar] for low, high in [region.problem.v0]
                   for cuts, number in region.undecided.items())
        return min(lost * (1 + angle * angle), Fraction(1))

    @property
    def undecided(self) -> Fraction:
        """At most this share of phase space is undecided or, if columns are lines, of the
        successors in them, on average; rounded up."""
        shares = [self.share(x) for x in self.found]
        if self.strip:
            length = self.turns * pi_bounds(4 * DIGITS)[1]
            total = 1 - 2 * self.strip * sum(1 - x for x in shares) / length
        else:
            total = sum(shares, Fraction(0)) / len(shares) if shares else Fraction(1)
        return rounded(total, SHARE_DIGITS, up=True)

    @property
    def complete(self) -> bool:
        """Are all columns done that were asked for?"""
        return len(self.found) == len(self.stars)

    def report(self, file: Optional[Path] = None) -> str:
        """The proved statement, in words.

        Parameters
        ----------
        file
            The name of the portrait's file; "" if a command was given none.
        """
        shares = [self.share(x) for x in self.found]
        of = "phase space" if self.strip else "the successors in them, on average"
        proved = any("P" in region.text for each in self.found.values() for region in each)
        claim = ["has no rotational invariant circle through the points (y, y' - y) of these "
                 "prisms that lie in no undecided prism, nor through the images of such points by "
                 "the reversal of time"] if proved else ["was examined"]
        lines = [headline("THEOREM, for the proved prisms", self.restored, "column") if proved else
                 "UNDECIDED: nothing is proved.",
                 *map_lines(self.problem),
                 *ended([*indented([*claim, *conditions(self.problem)])]), ""]
        lines += ["Verify : " + verify_text(file, "portrait")] if proved else []
        lines += ["Columns : %d of %d%s%s" % (
            len(self.found), len(self.stars), "" if self.even is None else
            ", and their mirror images about %s pi" % self.even,
            ", strips %s wide" % decimal_text(2 * self.strip) if self.strip else ", lines"),
            "Undecided : at most %s of %s" % (decimal_text(self.undecided), of)]
        if shares:
            lines += ["Undecided in a column : at most %s to %s" % tuple(
                decimal_text(rounded(x, 4, up=True), 4) for x in (min(shares), max(shares)))]
        if not proved:
            lines += ["To try : " + ("a depth above %d (--depth)" % self.depth if shares else
                                     "more time, from a file (%s)" % (
                                         "path=FILE, then resume=True" if file is None else
                                         "-b FILE, then -r FILE"))]
        lines += ["Time : %.0f seconds" % self.seconds]
        lines += ["SHA-256 : " + self.sha256] if self.sha256 else []
        return "\n".join(lines) + "\n"

    # ---- its file

    def __repr__(self) -> str:
        return "<Portrait: %s; %d of %d columns, at most %s%% undecided>" % (
            self.problem.map, len(self.found), len(self.stars),
            rounded_text(100 * self.undecided, 3, up=True))

    def plot(self, ax: Any = None, tori: Sequence[Any] = ()) -> Any:
        """Draws the portrait: y to the right and J upwards, modulo 2 pi, as the portraits of
        orbits (SymplecticMap.portrait).

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned.  With None a Figure is returned,
            which a notebook shows.
        tori
            Proved circles (ProvedTorus), which are drawn in colour.

        Raises
        ------
        ConverseError
            matplotlib is missing.
        """
        return provided("Portrait.plot")(self, None, tori, ax)

    def _text(self) -> str:
        lines = [FIRST_LINE, "program: converse " + self.version, *wave_lines(self.problem),
                 "strip: " + decimal_text(self.strip),
                 "even about: " + ("no" if self.even is None else str(self.even)),
                 "depth: %d" % self.depth, "columns: %d" % self.columns,
                 "undecided: " + decimal_text(self.undecided), "parts:"]
        regions = [region for x in sorted(self.found) for region in self.found[x]]
        return sealed([*lines, *(line for n, region in enumerate(regions, 1)
                                 for line in part_lines(str(n), region))])

    @classmethod
    def _of(cls, content: Any) -> "Portrait":
        header = content.header
        made = cls(Problem(map_of(content)), content.strip, content.even, int(header["depth"]),
                   int(header["columns"]), sha256=content.sha256, version=program_of(header),
                   restored=len(content.columns))
        made.found = {column[0].xstar[0]: tuple(tree_of(region, made.patch) for region in column)
                      for column in content.columns}
        return made


def _of_circle(problem):
    """The problem with its waves alone that are there.  ValueError: it has two angles."""
    seen = [term for term in problem.terms if term.most]
    if any(term.k[1] for term in seen):
        raise ValueError("a portrait is of a map of one angle; this potential has a wave that "
                         "depends on a second angle")
    if not seen:
        raise ValueError("the potential is zero: every orbit of the map lies on a circle; give "
                         "amplitudes that are not all 0")
    return Problem(SymplecticMap([(*term.k, term.phase) for term in seen],
                                 [term.p for term in seen],
                                 list(filter(any, zip(*[term.parts for term in seen])))))


def _even(problem):
    """A point, in units of pi, about which V is even, or None: k c + phase + 1/2 is an integer for
    every wave."""
    (k, _, phase), *_ = problem.waves
    points = [(m + Fraction(1, 2) - phase) / k % 1 for m in range(abs(k))]
    return next((c for c in sorted(points) if not any(
        (k0 * c + phi + Fraction(1, 2)) % 1 for k0, _, phi in problem.waves)), None)


# ---- the search

def portray(source: Union[SymplecticMap, Problem, None] = None, *, path: Optional[Path] = None,
            columns: int = 600, depth: int = 15, strips: bool = True, resume: bool = False,
            jobs: Optional[int] = None, executor: Optional[concurrent.futures.Executor] = None,
            time_limit: float = math.inf,
            progress: Optional[Callable[[int, Portrait], None]] = None) -> Portrait:
    """Proves where in phase space a map of one angle has no rotational invariant circles.

    Parameters
    ----------
    source
        The map, or a Problem of it; None with resume.  It may have a range of parameters: what is
        proved holds for all of them.
    path
        The file that keeps the columns: a new one or, with resume, the file of the portrait to
        continue.  None: there is none.
    columns
        How many columns the circle has.
    depth
        The most cuts above a prism.
    strips
        Whether columns are strips, so that they leave no gaps; else they are lines.
    resume
        Whether to continue the portrait of the file: its columns are kept.
    jobs, executor
        Columns at a time, by default one per core; whose workers they are, by default threads.
    time_limit
        The search ends after about this number of seconds on the clock.
    progress
        progress(columns done, portrait) is called a few times a second.

    Raises
    ------
    TypeError, ValueError
        An argument does not suit, or there is neither a map nor a file to continue.
    ConverseError
        The file cannot be used; what was found is in it.
    """
    pool = WorkerPool(executor, jobs, time_limit)
    asked = None if source is None else Portrait.new(Problem.of(source), columns, depth, strips)
    with interruptible(), Backup(path, resumed=path if resume else None) as backup:
        if path is not None and resume and asked is None:
            portrait = Portrait.load(path)
            if not portrait.complete:
                check_release(portrait, path)
        elif asked is not None and not resume:
            portrait = asked
        else:
            raise TypeError("there must be a map, or the file of a portrait to continue")

        def take(xstar, regions):
            if regions is not None:
                portrait.found[xstar] = regions

        def look():
            if progress:
                progress(len(portrait.found), portrait)

        tasks = ((x, column, portrait.patch, portrait.strip, portrait.depth, x)
                 for x in portrait.stars if x not in portrait.found)
        with Filling(portrait, backup, pool, look) as filling:
            filling.work(lambda: next(tasks, None), take)
    return portrait


def column(patch: Problem, strip: Fraction, depth: int, xstar: Fraction,
           stop: Callable[[], bool] = bool) -> Optional[Tuple[Tree, ...]]:
    """The trees of the regions of a column; None: stop() returned True.  A worker calls
    it."""
    star, found = (decimal_text(xstar), "0"), []
    for problem in regions_of(patch, strip, depth, star):
        low, high = problem.v0
        cuts = max(0, depth + round(math.log2(high - low)))     # half a turn has them all
        task = native.Task(problem, Settings(method="loewner", depth=cuts, stubborn=True), star)
        grown = native.grow(task, look=stop)
        if grown is None:
            return None
        found.append(Tree(problem, star, pruned(grown.text)))
    return tuple(found)


def regions_of(patch: Problem, strip: Fraction, depth: int,
               star: Tuple[str, str]) -> Iterable[Problem]:
    """The patch with regions that hold, one after the other, all successors of x* from c0 to c0 +
    1: the others are their images by the reversal of time.  In a strip each has its own shift, and
    they overlap by the difference of their shifts, so that no gap is between them for any t2."""
    def moved(shift):
        return replace(patch, shifts=tuple((shift * (m == 1), Fraction(0))
                                           for m in range(len(patch.parts))))

    def outward(low, high):
        return rounded(low - MARGIN, PLACES, up=False), rounded(high + MARGIN, PLACES, up=True)

    low, high = reversal_centre(patch, star)
    pieces = [(Fraction(0), Fraction(0))]           # where each begins, from 0 to 1, and its shift
    if strip:
        pieces = [(start, Fraction(round(slope * strip / math.pi * 10 ** DIGITS), 10 ** DIGITS))
                  for start, slope in slopes(patch, strip, star, float(low + high) / 2, max(
                      TURNED, MOVED * math.pi / 2 ** depth / float(strip)))]
    for at, (start, shift) in enumerate(pieces):
        problem = moved(shift)
        low, high = reversal_centre(problem, star)
        middle = (low + high) / 2
        if at:
            low = middle + start - abs(shift - pieces[at - 1][1]) / 2
        if at + 1 < len(pieces):
            following, other = pieces[at + 1]
            high = middle + following - 1 + abs(shift - other) / 2
        yield replace(problem, v0=outward(low, high + 1))


def slopes(patch: Problem, strip: Fraction, star: Tuple[str, str], centre: float,
           turned: float) -> List[Tuple[Fraction, float]]:
    """Divides half a turn of successors into pieces, each with its beginning, as a share of the
    half turn, and its slope d x_1/d x_0 - 1.

    The line of this slope through a point separates less than all other lines, over STEPS points to
    either side.  Circles have such slopes, and strips along them need fewer cuts.  The slope of a
    piece is the midrange of its samples, which differ by `turned` at most.  Doubles are enough,
    since any slope is right."""
    k, _, phase = patch.waves[0]
    bend = float(patch.parts[1][1] / strip)         # p k

    def slope(x1):
        first, second = (float(star[0]), 1.0, 0.0), (x1, 1.0, 1.0)  # a point, d/d x_0 and d/d x_1
        across = along = product = 0.0
        for (x, a, b), (y, c, d) in (first, second), (second, first):   # forward and backward
            for _ in range(STEPS):
                across, along, product = across + d * d, along + c * c, product + c * d
                angle = k * y + math.pi * phase
                beta = 2 - k * bend * math.sin(angle)
                x, y = y, 2 * y - x + bend * math.cos(angle)
                a, b, c, d = c, d, beta * c - a, beta * d - b
        return -product / across if along - product * product / across < SEPARATED else None

    pieces: List[Tuple[Fraction, float]] = []
    low = high = None
    for n in range(SAMPLES):
        found = slope(math.pi * (centre + (n + 0.5) / SAMPLES))
        if found is None:
            continue
        if low is None or max(high, found) - min(low, found) > turned:
            pieces.append((Fraction(n, SAMPLES), found))
            low = high = found
        low, high = min(low, found), max(high, found)
        pieces[-1] = pieces[-1][0], (low + high) / 2
    return [(Fraction(0), pieces[0][1]), *pieces[1:]] if pieces else [(Fraction(0), 0.0)]


def pruned(text: str) -> str:
    """The tree without cuts below which nothing is proved."""
    while True:
        text, count = BARREN.subn("U", text)
        if not count:
            return text
