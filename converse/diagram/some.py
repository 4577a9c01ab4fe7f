"""Where along one parameter there are tori: values are looked at, and tori are proved at some.

Existence is not monotone in a parameter: tori break up, and come back.  So values of a grid are
looked at, then values between those where a regular orbit is seen and those where none is.  Values
that are seen next to each other make a run.  In each run a torus is proved, and then others nearer
to both ends of the run.  What is seen is floating point; the checker verifies each certificate.
"""

import itertools
from fractions import Fraction
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ..model.map import SymplecticMap
from ..storage.files import ConverseError
from ..tori import prove
from ..tori.proved import ProvedTorus
from ..tori.regular import Orbits, regular
from ..tori.torus import family as potential_of
from .value import Diagram, Seen

GRID = 16                               # values that are looked at first: parts of the range
FINEST, COARSE = 1 << 13, 32            # No two values are nearer than a part of the range; than
BORDER = 4                              # COARSE such parts, unless a torus is seen at one only.
SEEN = 1e-9                             # turns: an orbit that changes less is taken for a torus
MESH = {1: (1 << 12, 1 << 15, 1 << 18), 2: (1 << 16, 1 << 18, 1 << 20)}     # sizes of meshes
# Points of orbits that cost as much time as a look, or as a point of a mesh.
LOOK_POINTS, MESH_POINTS = {1: 1_500_000, 2: 60_000_000}, 64
LOOKS, PROOFS = 3, 1                    # of a round


class Task(NamedTuple):
    """A value to look at, or with points > 0 to prove a torus at, on a mesh of so many points."""

    value: Fraction
    points: int = 0


class Outcome(NamedTuple):
    """What became of a task: its cost in points of orbits; the rotation vector of the most regular
    orbit, or None; the torus, or None."""

    points: int
    rotation: Optional[Tuple[float, ...]]
    torus: Optional[ProvedTorus]


def attempt(family: SymplecticMap, task: Task, stop: Callable[[], bool] = bool
            ) -> Optional[Outcome]:
    """Does a task at a map.  A worker calls it; None if it was stopped.

    Parameters
    ----------
    family
        The map at the value.
    task
        The task.
    stop
        stop() tells whether to end soon.
    """
    if stop():
        return None
    if not task.points:
        best = next(iter(regular(Orbits(potential_of(family)[0]))), None)
        return Outcome(LOOK_POINTS[family.dimension],
                       best.rotation if best and best.change < SEEN else None, None)
    try:
        torus = prove(family, points=task.points)
    except ConverseError:               # not found, or not confirmed
        return Outcome(MESH_POINTS * task.points, None, None)
    return Outcome(MESH_POINTS * task.points, None, torus)


class Runs:
    """The state of the search for tori along a line.

    looks -- of each value that was looked at the rotation vector that is seen, or None.
    tried -- of each value with a try without success the largest mesh."""

    def __init__(self, diagram: Diagram, lines: Sequence[Sequence[str]]) -> None:
        self.diagram = diagram
        self.sizes = MESH[diagram.family.dimension]
        self.looks: Dict[Fraction, Optional[Tuple[float, ...]]] = {}
        self.tried: Dict[Fraction, int] = {}
        for kind, value, *words in lines:
            if kind == "look":
                self.looks[Fraction(value)] = tuple(map(float, words)) or None
            else:
                self.tried[Fraction(value)] = int(words[0])
        low, high = diagram.ranges[0]
        self.low, self.high = low, min(high, max((end for _, end in diagram.open), default=high))
        self.grain = (high - low) / FINEST

    def lines(self) -> List[str]:
        """The state, for the file."""
        return [" ".join(["look", str(value), *map(repr, seen or ())])
                for value, seen in sorted(self.looks.items())] + [
            "tried %s %d" % item for item in sorted(self.tried.items())]

    def round(self) -> List[Task]:
        """What is done next: tries to prove, and looks."""
        return [*self._proofs(), *self._looks()]

    def take(self, task: Task, outcome: Optional[Outcome]) -> None:
        """Records what became of a task; None: it was not done."""
        if outcome is None:
            return
        self.diagram.points += outcome.points
        if not task.points:
            self.looks[task.value] = outcome.rotation
        elif outcome.torus is None:
            self.tried[task.value] = task.points
        proved = {each.low for each in self.diagram.tori}
        self.diagram.seen = [Seen((value,), seen) for value, seen in sorted(self.looks.items())
                             if seen and value not in proved]

    def seen_in(self, low: Fraction, high: Fraction) -> bool:
        """Is a torus seen in this part of the line?"""
        return any(seen and low <= value <= high for value, seen in self.looks.items())

    def _looks(self):
        """Values of a grid, then those in the widest gaps between known values.  A gap between one
        that is seen and one that is not counts BORDER times, and is closed further."""
        grid = [nice(self.low + (self.high - self.low) * i / GRID, self.grain)
                for i in range(GRID + 1)]
        new = [value for value in dict.fromkeys(grid) if not self._is_known(value)]
        if not new:
            gaps, ends = [], self._values()
            for a, b in zip(ends, ends[1:]):
                border = bool(self.looks.get(a)) != bool(self.looks.get(b))
                if b - a > (self._finest() if border else self.grain * COARSE):
                    gaps.append(((a - b) * (BORDER if border else 1), a, b))
            new = [nice((a + b) / 2, self.grain) for _, a, b in sorted(gaps)]
            new = [value for value in new if not self._is_known(value)]
        return [Task(value) for value in new[:LOOKS]]

    def _values(self):
        """The values that were looked at, and the ends of the parts without tori, in order."""
        return sorted({*self.looks, *(end for ends in self.diagram.none for end in ends
                                      if self.low <= end <= self.high)})

    def _is_known(self, value):
        """Has it been looked at, is it excluded, or is V 0 there, so that every torus exists?"""
        return value in self.looks or any(
            low <= value <= high for low, high in self.diagram.none) or not any(
            wave.middle + value * wave.parts[0] for wave in self.diagram.waves)

    def _finest(self):
        """How near values are looked at: nearer when nearer tori were tried."""
        most = max(self.tried.values(), default=0)
        return self.grain * (COARSE if most < self.sizes[1] else 1)

    def _proofs(self):
        """For each run the value that is tried next, and at which size, the smallest first."""
        tasks = [task for run in self.runs() for task in self._of_run(run)]
        return sorted(tasks, key=lambda task: task.points)[:PROOFS]

    def runs(self) -> List[List[Fraction]]:
        """Values at which tori are seen, next to each other."""
        found: List[List[Fraction]] = [[]]
        for value in self._values():
            if self.looks.get(value):
                found[-1].append(value)
            elif found[-1]:
                found.append([])
        return [run for run in found if run]

    def _of_run(self, run):
        """The next tries in a run: first in its middle, then nearer to its ends."""
        proved = [each.low for each in self.diagram.tori if run[0] <= each.low <= run[-1]]
        proved += [each.high for each in self.diagram.tori if run[0] <= each.high <= run[-1]]
        if not proved:
            return self._next([run[len(run) // 2]])
        ends = [[x for x in reversed(run) if x > max(proved)]]
        if run[0] > self.low:
            ends.append([x for x in run if x < min(proved)])
        return [task for end in ends for task in self._next(end)]

    def _next(self, values):
        """Of values in the order of preference the first with the smallest size that is left."""
        for size in self.sizes:
            for value in values[:3]:
                if self.tried.get(value, 0) < size:
                    return [Task(value, size)]
        return []


def nice(value: Fraction, grain: Fraction) -> Fraction:
    """The number with the fewest decimals that is nearer to a value than half a grain."""
    return next(near for near in (Fraction(round(value * 10 ** places), 10 ** places)
                                  for places in itertools.count())
                if abs(near - value) <= grain / 2)
