"""Where along the parameter of a family tori are seen, and whether they are found, at the values of
a grid.  The set of these values need not be an interval, so nothing is bisected.  All is in
doubles, and nothing is proved."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Callable, Iterator, Optional, Sequence, Tuple, Union

from ..model.exact import Number, exact
from ..model.map import SymplecticMap
from ..model.problem import Problem
from .continuation import POINTS
from .find import Search, points_of
from .regular import Orbit
from .rotation import Rotation


@dataclass(frozen=True)
class Seen:
    """What is seen of a map.

    Attributes
    ----------
    value
        Of the parameter, exactly.
    orbits
        The most regular orbits that are not resonant, the best first; none if all are chaotic.
    rotation
        The rotation vector whose torus was found with the fewest points; None: none was found.
    size
        About the points of the grid on which this torus is to be refined, 0 if there is none:
        how much work a proof is.
    """

    value: Fraction
    orbits: Tuple[Orbit, ...]
    rotation: Optional[Rotation]
    size: int


def scan(family: Union[SymplecticMap, Problem], values: Union[int, Sequence[Number]] = 64, *,
         points: int = POINTS, progress: Optional[Callable[[str], None]] = None
         ) -> Iterator[Seen]:
    """Yields for each value of a grid the most regular orbits, and whether a torus is found there.

    Parameters
    ----------
    family : SymplecticMap or Problem
        A family with one parameter that has a range.
    values : int or sequence of number
        How many values, evenly spaced from one end of the range to the other, or which.
    points : int
        Of a mesh of angles, at most.
    progress : callable, optional
        progress(text) is called with each step of the work.

    Yields
    ------
    Seen

    Raises
    ------
    ValueError
        The family has not one parameter with a name and a range, or there are fewer than two
        values.
    """
    source = Problem.of(family).map
    ranged = [(name, low, high) for name, (low, high) in zip(source.names, source.ranges)
              if low < high]
    if len(ranged) != 1:
        raise ValueError("the family has %d named parameters with a range; give one a range, and "
                         "the others single values" % len(ranged))
    (name, low, high), = ranged
    if isinstance(values, int):
        if values < 2:
            raise ValueError("values is %d; at least the two ends of the range are looked at"
                             % values)
        values = [low + (high - low) * Fraction(i, values - 1) for i in range(values)]
    for value in map(exact, values):
        orbits, best = Search(Problem(source.at(**{name: value})), points, None,
                              progress or (lambda text: None)).seen(0)
        yield Seen(value, tuple(orbits), *((best[0].rotation, points_of(best)) if best else (
            None, 0)))
