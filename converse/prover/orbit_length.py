"""How long the orbits of a search may become.

Close above the parameter where the last circle breaks, proofs need orbits of many thousand points.
Close below it, and at any parameter with a circle, such orbits take a minute and prove nothing.
So when a search meets a prism that needs a long orbit, a few of the thinnest prisms are tried with
long orbits.  If one of them is not proved, no search can prove the prisms around it, and the search
follows short orbits only.

No theorem rests on this choice: it decides how much is tried."""

from itertools import product
from operator import mul
from typing import List, Optional, Sequence, Tuple

from ..model.problem import rows
from . import native, tree
from .settings import Settings

CUTS = native.lib.CV_MAX_CUTS           # of the thinnest prisms
# Prisms are tried at each 2^-6 of the region, and then at each 2^-9, 2^-12, ... around those that
# took the longest orbits: around three, as the longest one need not be near the longest of all.
FIRST, FINER, AROUND = 6, 3, 3
# Points of the orbits of these prisms, at most.  For k = 0.97165 they need 25,073 (November 2026),
# where the proof needs 85,237.
TRY_POINTS = 1 << 15


def longest(problem, xstar, threads=1, is_late=bool) -> Optional[int]:
    """The most points of an orbit in a search over x*, or 0 for as many as the core can follow.
    None if is_late() returned True before.

    No proof is known to need more than native.ORDINARY where waves depend on two combinations of
    the angles."""
    ends = product(*((0, (1 << CUTS) - 1) if any(part) else (0,) for part in problem.parts))
    long = problem.is_flat and all(_all_proved(problem, xstar, end, threads, is_late)
                                   for end in ends)
    if is_late():
        return None
    return 0 if long else native.ORDINARY


def _all_proved(problem, xstar, end: Sequence[int], threads, is_late) -> bool:
    """Are the thinnest prisms proved, as far as they are tried, at this corner of the parameters'
    ranges?  The answer means nothing if it is late."""
    settings = Settings("loewner", CUTS * (1 + len(end)), stubborn=True)
    search = native.Search(native.Task(problem, settings, xstar, TRY_POINTS))
    axis, level, places = _axis(problem), FIRST, list(range(1 << FIRST))
    while search.work(0, is_late):
        grown = search.grow([_thinnest(axis, level, place, end) for place in places],
                            threads=threads, look=is_late)
        if grown.cells or "U" in grown.text or level == CUTS:
            return not grown.cells and "U" not in grown.text
        best = sorted(zip(grown.steps, places), reverse=True)[:AROUND]
        finer = min(level + FINER, CUTS)
        places = [(place << finer - level) + j for _, place in best
                  for j in range(1 << finer - level)]
        level = finer
    return False


def _axis(problem) -> int:
    """The coordinate of v that the waves depend on."""
    columns = list(zip(*rows(problem.frame)))
    return next(axis for axis, column in zip(tree.ANGLES, columns) if column is columns[-1] or any(
        sum(map(mul, term.k, column)) for term in problem.searched))


def _thinnest(axis, level, place, end) -> Tuple[List[int], List[int], int]:
    """The middle one of the thinnest prisms in a part, of 2^level, of the region."""
    index, cuts = (list(each) for each in tree.ROOT)
    index[axis] = place if level == CUTS else (2 * place + 1) << (CUTS - level - 1)
    for along, last in zip(tree.PARAMETERS, end):
        index[along], cuts[along] = last, CUTS
    cuts[axis] = CUTS
    return index, cuts, 0
