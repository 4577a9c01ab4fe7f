"""Where along one parameter there are tori: values are looked at, and tori are proved at some.

Existence is not monotone in a parameter: tori break up, and come back.  So values of a grid are
looked at, then values between those where a regular orbit is seen and those where none is.  Values
that are seen next to each other make a run.  In each run a torus is proved, and then others nearer
to both ends of the run; and with one angle tori for every value between proved ones.  Orbits
are seen in floating point; the checker verifies each certificate.
"""

import itertools
import math
from fractions import Fraction
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from .. import check
from ..model.exact import Ends
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..storage.files import ConverseError
from ..tori import prove
from ..tori.certificate import tori_of
from ..tori.continuation import POINTS
from ..tori.effort import LOOKING, Work
from ..tori.find import Search
from ..tori.proved import ProvedTorus
from ..tori.regular import Orbits, regular
from ..tori.torus import family as potential_of
from .value import POINTS_A_SECOND, Diagram, Seen

# By the number of angles.  First GRID parts of the range are looked at; then gaps between values,
# down to 1/PARTS of what is open, between tori SPARSE times less.  Where a torus is seen at one end
# only, they are looked at down to 1/FINEST, and to SHARE of the way to a proved torus.
GRID, PARTS, FINEST = {1: 8, 2: 8}, {1: 1 << 8, 2: 1 << 5}, {1: 1 << 15, 2: 1 << 9}
SPARSE, SHARE = 8, Fraction(1, 8)
SEEN = 3e-8                             # turns: an orbit that changes less is taken for a torus
EFFORTS = {1: (5, 20, 80), 2: (128, 512)}       # seconds that a try may take, about
LEAST = {1: 2, 2: 20}                   # No try begins with less.
POINT = 1e-4                            # seconds of a proof for each point of its mesh, at least
BORDERS, LOOKS, PROOFS = 2, 2, 1        # of a round
RANGES = Fraction(1), Fraction(1, 2), Fraction(1, 4)    # shares of what is between proved tori
LATER = 128                             # Ranges are less urgent than ends of runs by this factor.


class _Stopped(Exception):
    """A task ends before its time."""


class Task(NamedTuple):
    """A value to look at; with effort > 0 one to prove a torus at, or between `back` and it, within
    `effort` seconds of work; with a certificate of a torus to begin from, `start`, tori are to be
    proved for every value between."""

    value: Fraction
    effort: float = 0
    back: Optional[Fraction] = None
    start: str = ""

    @property
    def ends(self) -> Ends:
        """The range of the task."""
        first, last = sorted((self.value, self.value if self.back is None else self.back))
        return first, last


class Outcome(NamedTuple):
    """The result of a task: its cost in points of orbits; the rotation vector of the most regular
    orbit, or None; the torus, or None."""

    points: int
    rotation: Optional[Tuple[float, ...]]
    torus: Optional[ProvedTorus]


def attempt(family: SymplecticMap, task: Task, stop: Callable[[], bool] = bool
            ) -> Optional[Outcome]:
    """Does a task.  A worker calls it; None if it was stopped.

    Parameters
    ----------
    family
        The part of the family over the range of the task.
    task
        The task.
    stop
        stop() tells whether to end soon.
    """
    def step(_=""):
        if stop():
            raise _Stopped

    rotation = torus = None
    work = Work(step, most=task.effort or math.inf)
    try:
        search = Search(Problem.of(family), min(POINTS, int(task.effort / POINT)), None, work)
        if task.start:
            start, = tori_of(check.content(task.start.encode()))
            torus = prove(family, start.rotation, points=search.points, progress=work,
                          start=start if search.amplitude(-1).any() else None)
        elif task.effort:
            torus = prove(search.farthest(1 if task.value == task.ends[1] else -1), progress=work)
        else:
            work("looking for regular orbits", LOOKING[family.dimension])
            best = next(iter(regular(Orbits(potential_of(family)[0]))), None)
            rotation = best.rotation if best and best.change < SEEN else None
    except _Stopped:
        return None
    except ConverseError:               # not found, too dear, or not confirmed
        pass
    return Outcome(round(POINTS_A_SECOND * work.spent), rotation, torus)


class Runs:
    """The state of the search for tori along a line.

    looks -- of each value that was looked at the rotation vector that is seen, or None.
    tried -- of each value with a try the largest effort.
    ranges -- (low, high) with a try to prove tori for every value."""

    def __init__(self, diagram: Diagram, lines: Sequence[Sequence[str]]) -> None:
        self.diagram = diagram
        self.n = diagram.family.dimension
        self.looks: Dict[Fraction, Optional[Tuple[float, ...]]] = {}
        self.tried: Dict[Fraction, float] = {}
        self.ranges: Set[Ends] = set()
        for kind, value, *words in lines:
            if kind == "look":
                self.looks[Fraction(value)] = tuple(map(float, words)) or None
            elif kind == "effort":
                self.tried[Fraction(value)] = float(words[0])
            elif kind == "range":
                self.ranges.add((Fraction(value), Fraction(words[0])))
        low, high = diagram.ranges[0]
        self.low, self.high = low, min(high, max((end for _, end in diagram.open), default=high))
        self.grain = (high - low) / FINEST[self.n]

    def lines(self) -> List[str]:
        """The state, for the file."""
        return [" ".join(["look", str(value), *map(repr, seen or ())])
                for value, seen in sorted(self.looks.items())] + [
            "effort %s %r" % item for item in sorted(self.tried.items())] + [
            "range %s %s" % ends for ends in sorted(self.ranges)]

    def round(self, seconds: float = math.inf) -> List[Task]:
        """The next tasks: looks at a grid, and as soon as a torus is seen a try to prove one;
        then tries, and looks.

        seconds -- No try may take more, nor may all looks."""
        grid = [nice(self.low + (self.high - self.low) * i / GRID[self.n], self.grain)
                for i in range(GRID[self.n] + 1)]
        new = [Task(value) for value in dict.fromkeys(grid) if not self._is_known(value)]
        tries = [] if new and self.diagram.tori else self._proofs(seconds)
        looks = new[:BORDERS + LOOKS] or self._looks()
        return [*tries, *looks[:int(max(0, min(len(looks), seconds / LOOKING[self.n])))]]

    def take(self, task: Task, outcome: Optional[Outcome]) -> None:
        """Records what became of a task; None: it was not done."""
        if outcome is None:
            return
        if task.start:
            self.ranges.add(task.ends)
        elif task.effort:
            self.tried[task.value] = task.effort
        else:
            self.looks[task.value] = outcome.rotation
        self.diagram.seen = [
            Seen((value,), seen) for value, seen in sorted(self.looks.items()) if seen and not any(
                each.low <= value <= each.high for each in self.diagram.tori)]

    def _looks(self):
        """The middles of the widest gaps between known values: where a torus is seen at one end,
        no narrower than SHARE of the way from there to a proved torus; and elsewhere, where gaps
        between tori that are seen are of less use."""
        ends, open_parts = self._values(), self.diagram.open
        if not open_parts:
            return []
        end = open_parts[-1][1]
        part, sparse = (end - open_parts[0][0]) / PARTS[self.n], (end - self.low) / PARTS[self.n]
        gaps: Tuple[List[Any], List[Any]] = ([], [])
        for a, b in zip(ends, ends[1:]):
            seen, middle = [end for end in (a, b) if self.looks.get(end)], nice(
                (a + b) / 2, self.grain)
            least = SPARSE * sparse if seen else part
            if len(seen) == 1:
                near = [abs(value - seen[0]) for value in self._proved()]
                least = max(self.grain, SHARE * min(near, default=self.high - self.low))
            if b - a > least and not self._is_known(middle):
                gaps[len(seen) == 1].append(((a - b) / least, middle))
        return [Task(middle) for each, most in zip(gaps, (LOOKS, BORDERS))
                for _, middle in sorted(each)[:most]]

    def _values(self):
        """The values that were looked at, and the ends of the parts without tori, in order."""
        return sorted({*self.looks, *(end for ends in self.diagram.none for end in ends
                                      if self.low <= end <= self.high)})

    def _is_known(self, value):
        """Has it been looked at, is it excluded or proved to have a torus, or is V 0 there, so that
        every torus exists?"""
        return value in self.looks or any(low <= value <= high for low, high, *_ in [
            *self.diagram.none, *self.diagram.tori]) or not any(
            wave.middle + value * wave.parts[0] for wave in self.diagram.waves)

    def _proofs(self, seconds=math.inf):
        """The tries that are next: where the part of a run that is not proved is widest for the
        effort."""
        tries = sorted([*self._of_ranges(seconds), *(
            each for run in self.runs() for each in self._of_run(run, seconds))])
        return [task for _, task in tries[:PROOFS]]

    def _of_ranges(self, seconds):
        """Tries to prove tori for every value from one to the next proved one of its run, or else
        for parts at the lower end, each tried once."""
        effort, tori = min(EFFORTS[self.n][0], seconds), self.diagram.tori
        single = {each.low: each.certificate for each in tori if each.low == each.high}
        begun, found = {each.low for each in tori if each.low < each.high}, []
        for first, last in self.hulls() if self.n == 1 and effort >= LEAST[1] else []:
            ends = sorted({first, *(x for x in single if first <= x <= last)})
            for low, high in zip(ends, ends[1:]):
                parts = [low + share * (high - low) for share in RANGES if low not in begun]
                found += [(-float(end - low) / LATER / effort, Task(
                    end, effort, low, single[high])) for end in parts
                    if (low, end) not in self.ranges][:1]
        return found

    def _proved(self):
        return [value for each in self.diagram.tori for value in {each.low, each.high}]

    def runs(self) -> List[List[Fraction]]:
        """Values at which tori are seen, tried or proved, next to each other."""
        found: List[List[Fraction]] = [[]]
        good = {*self.tried, *self._proved(),
                *(value for value, seen in self.looks.items() if seen)}
        for value in sorted({*good, *self._values()}):
            if value in good:
                found[-1].append(value)
            elif found[-1]:
                found.append([])
        return [run for run in found if run]

    def hulls(self) -> List[Ends]:
        """The ranges of the runs.  The lowest includes an end of the range where V is 0."""
        least = min(self._values(), default=self.high)
        return [(self.low if run[0] <= least else run[0], run[-1]) for run in self.runs()]

    def _of_run(self, run, seconds):
        """The next tries in a run: first at its upper end, then beyond proved values, to both ends
        and half of the way to what is known beyond these."""
        proved, known = [x for x in self._proved() if run[0] <= x <= run[-1]], self._values()
        if not proved:
            return self._next(run[0], run[-1], self.high - self.low, seconds)
        found = []
        for start, end, beyond in (
                (max(proved), run[-1], [x for x in known if x > run[-1]][:1]),
                (min(proved), run[0], [x for x in known if x < run[0]][-1:])):
            if beyond and abs(end - start) <= self.grain:
                end = nice((start + beyond[0]) / 2, self.grain)
            if beyond or end > start:       # Nothing is asked at the lower end of the range.
                found += self._next(start, end, abs(end - start), seconds)
        return found

    def _next(self, start, end, width, seconds):
        """(less the width of the part for each second, Task) of a try at an end, with more effort
        than those on the way from the start, where a torus is seen or proved.  The try itself goes
        back towards the start.  Then the way is halved."""
        while abs(end - start) > self.grain or start not in self._proved():
            low, high = sorted((start, end))
            done = max((effort for value, effort in self.tried.items()
                        if low <= value <= high and value != start or value == end), default=0)
            for most in EFFORTS[self.n]:
                effort = min(most, seconds)
                if effort > done and effort >= max(LEAST[self.n], self.tried.get(start, 0)):
                    return [(-float(width) / most, Task(end, effort, start))]
            if abs(end - start) <= self.grain:
                break
            end = nice((start + end) / 2, self.grain)
        return []


def nice(value: Fraction, grain: Fraction) -> Fraction:
    """The number with the fewest decimals that is nearer to a value than half a grain."""
    return next(near for near in (Fraction(round(value * 10 ** places), 10 ** places)
                                  for places in itertools.count())
                if abs(near - value) <= grain / 2)
