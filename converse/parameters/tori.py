"""Tori that are proved along the rays of a map of a plane: the frontier from its other side.

On each ray, that is, in some of the directions in which the map's frontier was estimated, tori of a
few rotation vectors are looked for below it; the one that is proved with the largest amplitudes is
kept as a certificate (docs/reference/map-file.md), in a file of its own.  It is a torus for these
amplitudes; nothing is claimed of smaller ones.
"""

import os
from fractions import Fraction
from typing import TYPE_CHECKING, Callable, Dict, Iterable, Iterator, List, Optional, Tuple, Union

from ..model.map import THESIS, SymplecticMap
from ..model.problem import Problem
from ..storage.files import ConverseError
from . import region
from .map import ParameterMap

if TYPE_CHECKING:                       # tori needs an extra
    from ..tori import ProvedTorus, Rotation

VECTORS = {1: ("golden",), 2: ("T49", "V1", "seven")}   # by the number of angles
PARTS = 0.985, 0.95, 0.9, 0.8, 0.65     # of the radius to which tori are found: proofs are tried
POINTS = 1 << 15                        # of a grid on which a torus is looked for
FINEST = 8                              # intervals between the rays of a face, at most
UNIT = Fraction(1, 10 ** 5)             # of a radius
ENDING = ".torus"

Path = Union[str, "os.PathLike[str]"]
Point = Tuple[Fraction, Fraction, Fraction]
Progress = Optional[Callable[[int, int], None]]
Choice = Callable[[Point, float], Iterable[Tuple["Rotation", float]]]


def rays(found: ParameterMap) -> Iterator[Tuple[int, Fraction]]:
    """The (face, s) of the directions in which tori are looked for, each direction once, those of a
    coarse grid first."""
    known = set()
    places = [(s.denominator, face, s) for face, estimate in enumerate(found.estimate)
              for s in estimate]
    for denominator, face, s in sorted(places):
        direction = region.direction(found.directions[face], s)
        if denominator <= FINEST and direction not in known:
            known.add(direction)
            yield face, s


def named(direction: Point, estimate: float) -> List[Tuple["Rotation", float]]:
    """The rotation vectors that are tried by default, up to the estimate."""
    from ..tori import read_rotation
    from ..tori.torus import family

    potential, _ = family(Problem(SymplecticMap(THESIS, direction)))
    return [(read_rotation(name, potential.dimension), estimate)
            for name in VECTORS[potential.dimension]]


def prove_tori(found: ParameterMap, directory: Path, *, vectors: Choice = named,
               points: int = POINTS,
               progress: Progress = None) -> None:
    """Proves a torus on each ray of a map that has no certificate in the directory, and
    writes its certificate there, named by the face and the place of the ray.  The directory is made
    if need be.

    vectors(direction, estimate) -- the rotation vectors that are tried along that direction, where
        the frontier is estimated at so many times it, and the radius up to which each is tried
    points -- of the grid on which a torus is looked for, at most: effort
    progress(rays done, all rays) is called as rays are done

    A ray on which nothing is proved stays without a certificate.  ConverseError: a certificate
    cannot be written."""
    todo = list(rays(found))
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise ConverseError("%s: cannot be made (%s); name another directory"
                            % (os.fspath(directory), error.strerror)) from None
    for done, (face, s) in enumerate(todo):
        path = os.path.join(directory, "%d-%s%s" % (face, float(s), ENDING))
        if progress:
            progress(done, len(todo))
        if not os.path.exists(path):
            direction = region.direction(found.directions[face], s)
            estimate = found.estimated(face, s)
            best, reached = None, 0.0
            for rotation, top in vectors(direction, estimate):
                proof, reached = highest(lambda radius: _problem(direction, radius), rotation, top,
                                         points, reached)
                best = proof or best
            if best:
                best.save(path)


def highest(problem_at: Callable[[float], Problem], rotation: "Rotation", top: float,
            points: int = POINTS, least: float = 0.0) -> Tuple[Optional["ProvedTorus"], float]:
    """A proof of a torus of this rotation vector for the problem at a value above `least` and not
    above `top`, the largest of a few values that are tried, and the value; or (None, least).

    points -- of the grid on which the torus is looked for, at most: effort"""
    from ..tori import NotFound, NotProved, prove

    whole = top
    parts: Tuple[float, ...] = (1.0, *PARTS)
    while parts and top * parts[0] > least:
        value, parts = top * parts[0], parts[1:]
        try:
            return prove(problem_at(value), rotation, points=points), value
        except NotFound as failure:
            if failure.reached and top == whole:        # the search got so far
                top, parts = value * failure.reached, PARTS
        except NotProved:
            pass
    return None, least


def _problem(direction, radius):
    exact = max(1, round(radius / UNIT)) * UNIT         # not 0, where there is no wave
    return Problem(SymplecticMap(THESIS, [exact * d for d in direction]))


def proved_points(directory: Path) -> List[Tuple[Point, str]]:
    """The (a, b, c) of the certificates in a directory, and the rotation vectors' names.

    They are read, not checked: converse-check does that.  ConverseError: the directory or a
    certificate cannot be read, or is of other waves, or of a range."""
    from ..tori.certificate import read

    try:
        names = sorted(name for name in os.listdir(directory) if name.endswith(ENDING))
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name the directory of --tori"
                            % (os.fspath(directory), error.strerror)) from None
    points = []
    for name in names:
        path = os.path.join(directory, name)
        certificate = read(path)
        torus = certificate.tori[0]
        amplitude: Dict[tuple, Fraction] = dict(zip(torus.potential.waves,
                                                    torus.potential.amplitude))
        if torus.part is not None or not set(amplitude) <= {(*k, Fraction(0)) for k in THESIS}:
            raise ConverseError("%s: is no torus at one (a, b, c); remove it" % path)
        a, b, c = (amplitude.get((*k, Fraction(0)), Fraction(0)) for k in THESIS)
        points.append(((a, b, c), torus.rotation.name))
    return points
