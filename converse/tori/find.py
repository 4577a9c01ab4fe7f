"""Finds invariant tori, without proof: for one potential, or for all potentials of a range."""

from dataclasses import replace
from fractions import Fraction
from math import ceil, exp, inf, log, log2
from typing import Callable, List, Optional, Tuple, Union

import numpy as np

from ..model.exact import Ends, short_text
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..storage.files import ConverseError
from .continuation import POINTS, Found, NotFound, Way, ellipse, newton, place
from .effort import (BALLS, CHOOSING, LOOKING, PLANNING, REFINING, SINGLE, SOLVING, VERIFYING,
                     TimeIsUp, Work, balls, limited)
from .nearest import Place, nearest, rotation_of
from .newton import Frame, Mesh
from .plan import MARGIN, Weights, plan
from .refinement import SPARE_BITS, Modes, accepted, layers_for, numbers_of, refined, taken
from .regular import Orbit, Orbits, apart, near_vectors, regular, with_rotation
from .rotation import Rotation
from .torus import Torus, family

__all__ = ["NotFound", "find"]

ENOUGH = 3                  # Among this number of tori the one with the fewest modes is chosen.
SMALL = 1 << 15             # Points of the mesh on which the vectors of two angles are compared.
NEAR = 6                    # orbits of two angles near which rotation vectors are looked for
SMOOTHEST = 4               # vectors of which a torus is made
APART = 3e-4                # Of vectors that differ by less, in turns, the best is tried.
NEEDED = {1: 1.0, 2: 0.65}  # About this part of the planned modes is left, by the number of angles.
ROUNDS = 3                  # This often the number of modes is chosen.
# The lengths of pieces are chosen for DEGREE in sigma; they have LEAST_DEGREE to MOST_DEGREE.
LEAST_DEGREE, DEGREE, MOST_DEGREE = 4, 21, 26
LAYERS = 32                 # Points of the circle of sigma; tori are computed at half of these.
LARGEST = 1 << 23           # Points of the mesh times the degree are at most about this.
NARROWEST = 1e-5            # A piece of s is at least about this long.
ALL = 0.93                  # A piece that could cover this part of the rest takes all of it.
# The s that farthest() tries.
RETREAT = tuple(Fraction(n, 8) for n in (8, 7, 6, 4, 0, -4))
MOST_MARGIN = 1e100         # Coefficients times 2^bits are doubles on their way to integers.


def find(source: Union[SymplecticMap, Problem], rotation: Union[Rotation, str, None] = None, *,
         near: Optional[Place] = None, start: Optional[Torus] = None, margin: float = MARGIN,
         points: int = POINTS, memory: Optional[int] = None, time_limit: float = inf,
         progress: Optional[Callable[[str], None]] = None) -> Union[Torus, List[Torus]]:
    """Finds an invariant torus in floating-point numbers; nothing is proved.

    Parameters
    ----------
    source : SymplecticMap or Problem
        The map; one parameter may have a range.
    rotation : Rotation or str, optional
        The rotation vector, or its text as read_rotation takes it, or decimals as for `near`.  By
        default the one whose torus needs the fewest modes among those of the most regular orbits,
        with a range at the end where V is larger.
    near : sequence of number, optional
        In the place of `rotation`, one or two components in turns: the rotation vector is
        tori.nearest(near).
    start : Torus, optional
        A torus of the same rotation vector, of other amplitudes, from which to continue.  By
        default it is made of an orbit, or continued from the map without potential: first in the
        amplitudes that no parameter moves, then in the parameters.
    margin : float
        By which factor the error of the torus should be smaller than the theorem needs.
    points : int
        Of a mesh of angles, at most.
    memory : int, optional
        Bytes that refining the torus may take; by default three quarters of the free memory.
    time_limit : float
        Seconds, after which no step of the work begins.
    progress : callable, optional
        progress(text) is called with each step of the work.

    Returns
    -------
    Torus, or list of Torus
        With a range, tori for the pieces of the range, which tile it.

    Raises
    ------
    NotFound
        There is none, as far as can be seen, or it needs more points.
    TimeIsUp
        The time limit is over.
    TypeError, ValueError
        Map, rotation vector and start do not go together, or the margin is not from 1 to 1e100.
    """
    if not 1 <= margin <= MOST_MARGIN:
        raise ValueError("the margin, %g, is not from 1 to %g" % (margin, MOST_MARGIN))
    if near is not None and rotation is not None:
        raise ValueError("the rotation vector is given by `rotation` or by `near`, not by both")
    search = Search(Problem.of(source), points, memory, limited(progress, time_limit))
    n, part = search.potential.dimension, search.part
    if near is not None:
        rotation = nearest(near, dimension=n)
    elif rotation is not None:
        rotation = rotation_of(rotation, n)
    if rotation is None and start is not None:
        rotation = start.rotation
    if rotation is not None and rotation.dimension != n:
        raise ValueError("the rotation vector has %d component%s, but the potential depends on %d "
                         "angle%s" % (rotation.dimension, "s" * (rotation.dimension > 1), n,
                                      "s" * (n > 1)))
    if start is not None and rotation is not None:
        way, found = search.continued(rotation, start)
    elif rotation is not None:
        way, found = search.found(rotation)
    else:
        way, found = search.most_regular()
        if part is not None:            # so far at the end where V is larger
            way, found = search.found(way.rotation)
    if part is None:
        return _single(found, way, margin)
    return _Pieces(search, way.rotation, margin).cover(found)


class Search:
    """Looks for tori of a problem, each at the lower end of its range, if it has one."""

    def __init__(self, problem: Problem, points: int, memory: Optional[int], tell: Work) -> None:
        self.potential, self.part = family(problem)
        self.points, self.memory, self.tell = points, memory, tell
        source = problem.map
        self.named = [(name, float(low), float(high))
                      for name, (low, high) in zip(source.names, source.ranges) if low or high]
        constant = dict(zip(source.harmonics, source.amplitude)) if source.names else {}
        self.constant = _doubles([constant.get(wave, 0) for wave in self.potential.waves])

    def amplitude(self, s: Union[Fraction, int]) -> np.ndarray:
        return _doubles(self._exact(s))

    def _exact(self, s):
        part = self.part or (Fraction(0),) * len(self.potential.amplitude)
        return tuple(p + s * q for p, q in zip(self.potential.amplitude, part))

    def _end(self):
        return 0 if self.part is None else -1

    def way(self, rotation: Rotation, first: np.ndarray, last: np.ndarray,
            low: Optional[float] = None, high: float = 0.0) -> Way:
        """The way between two amplitudes: those of the parameter s from low to high, or, with
        None, from where all parameters are 0 to the end of the range."""
        to = self._end() if low is None else high
        potential = self.potential._replace(amplitude=self._exact(Fraction(to)))
        return Way(potential, rotation, self.points, first, last, self.tell, self.memory, [
            (name, 0.0 if low is None else value, there)
            for (name, value), (_, there) in zip(self.at(to if low is None else low), self.at(to))])

    def at(self, s: float) -> List[Tuple[str, float]]:
        """The parameters at s."""
        return [(name, (low + high) / 2 + s * (high - low) / 2) for name, low, high in self.named]

    def continued(self, rotation: Rotation, start: Optional[Torus] = None) -> Tuple[Way, Found]:
        """The torus to which continuation leads, from the start or without potential."""
        last = self.amplitude(self._end())
        if start is not None:
            begin = _amplitudes(self.potential, rotation, start)
            first = np.array([begin.get(wave, 0.0) for wave in self.potential.waves])
            way = Way(self.potential, rotation, self.points, first, last, self.tell, self.memory)
            return way, way.follow(way.taken_up(start))
        found = None
        if self.constant.any():
            way = Way(self.potential, rotation, self.points, 0 * last, self.constant, self.tell,
                      self.memory, [("the share of the constant amplitudes", 0, 1)])
            found = way.follow()
            if not (last - self.constant).any():
                return way, found
        way = self.way(rotation, self.constant, last)
        if found is not None:
            way.frame, way.chosen = found.mesh.frame, True
        return way, way.follow(found)

    def found(self, rotation: Rotation) -> Tuple[Way, Found]:
        """The torus of this rotation vector.  With one angle it is made of an orbit, or else
        continued; with two angles, where an orbit is harder to find, the other way round."""
        ways = [self._of_its_orbit, self.continued]
        failure: Optional[NotFound] = None
        for call in ways if self.potential.dimension == 1 else reversed(ways):
            try:
                return call(rotation)
            except NotFound as error:   # continuation says how far it came
                failure = error if call == self.continued or failure is None else failure
        assert failure is not None
        raise failure

    def _orbits(self, s):
        return Orbits(self.potential._replace(amplitude=self._exact(s)))

    def _of_its_orbit(self, rotation):
        orbits = self._orbits(self._end())
        way, rough = self._made(orbits, with_rotation(orbits, rotation), rotation, self._end())
        return way, way.finished(rough)

    def _made(self, orbits, orbit, rotation, s):
        """The torus of an orbit."""
        way = self._at(rotation, s)
        found = way.of_orbit(orbits, orbit)
        if isinstance(found, Found):
            return way, found
        raise NotFound("an orbit of the rotation vector (%s) was followed at %s, but no torus was "
                       "made of it%s" % (", ".join("%.9f" % w for w in rotation.floats),
                                         way.place(1.0), " on %d points" % self.points * (
                                             found < inf)), 0.0, self.amplitude(s))

    def _at(self, rotation, s):
        """The way that stays at s."""
        return self.way(rotation, self.amplitude(s), self.amplitude(s), float(s), float(s))

    def farthest(self, sign: int) -> Torus:
        """A torus, as near to s = sign as the effort of `tell` permits to refine and verify it: of
        the most regular orbits there, or of orbits of the same rotation vectors."""
        listed, failure = self._regular(self._orbits(sign), sign)[1][:SMOOTHEST], None
        for s in RETREAT if self.part else (1,):
            orbits = self._orbits(s * sign)
            if s < 1:
                listed = [with_rotation(orbits, each.vector, each)._replace(vector=each.vector)
                          for each in listed[:ENOUGH]]
            try:
                way, found, orbit = self._best(orbits, listed, s * sign)
                listed = [orbit]
                return _single(found, way, MARGIN)
            except (NotFound, TimeIsUp) as error:
                failure = error
        assert failure is not None
        raise failure

    def most_regular(self) -> Tuple[Way, Found]:
        """Of the tori of the most regular orbits the one that needs the fewest modes, at the end
        where V is larger."""
        s = self._end()
        if self.part is not None and abs(self.amplitude(1)).sum() > abs(self.amplitude(-1)).sum():
            s = 1
        orbits = self._orbits(s)
        seen, listed = self._regular(orbits, s)
        try:
            return self._best(orbits, listed, s)[:2]
        except NotFound:
            raise NotFound("at %s %s; a rotation vector may be given (converse-tori --rotation)" % (
                place(self.at(s), self.amplitude(s)), "%d regular orbits are seen, but no torus "
                "was made of them" % len(seen) if seen else "no orbit is seen that is regular and "
                "not resonant"), 0.0, self.amplitude(s).tolist()) from None

    def _regular(self, orbits, s):
        """The most regular orbits, and orbits with exact rotation vectors, the best first.

        With two angles the change of an orbit does not tell the good vectors, since it is a
        rounding error.  The error of Newton's method on a small mesh does."""
        n = self.potential.dimension
        self.tell("looking for regular orbits at %s" % place(self.at(s), self.amplitude(s)),
                  LOOKING[n])
        seen = regular(orbits)
        if n == 1:
            return seen, seen
        self.tell("looking for rotation vectors", CHOOSING * len(seen[:NEAR]))

        def error(orbit):
            found = self._at(orbit.vector, s).of_orbit(orbits, orbit, SMALL)
            return 0.0 if isinstance(found, Found) else found
        return seen, apart(sorted(near_vectors(orbits, seen[:NEAR]), key=error), APART)[:SMOOTHEST]

    def _best(self, orbits: Orbits, listed: List[Orbit],
              s: Union[Fraction, int]) -> Tuple[Way, Found, Orbit]:
        """Of the tori of the first orbits that have one the one that needs the fewest modes."""
        n, rough, made = self.potential.dimension, 0, []
        failure: ConverseError = NotFound("no torus was made of the regular orbits", 0.0,
                                          self.amplitude(s).tolist())
        for orbit in listed:
            assert orbit.vector is not None
            try:
                self.tell("looking for a torus near (%s)" % ", ".join(
                    "%.6f" % w for w in orbit.rotation), PLANNING[n])
                way, found = self._made(orbits, orbit, orbit.vector, s)
                rough += 1
                modes = plan(found).modes(found.mesh)
                self.tell("looking for its modes, about %d" % modes, 0.0,
                          VERIFYING[n] * NEEDED[n] * modes)
                made.append((way, way.finished(found), orbit))
            except TimeIsUp as error:
                failure = error
            except NotFound:
                pass
            if rough == ENOUGH:
                break
        if not made:
            raise failure
        return min(made, key=lambda each: plan(each[1]).modes(each[1].mesh))


def _doubles(numbers):
    return np.array([float(p) for p in numbers])


def _range_text(piece):
    return "%s <= s <= %s" % tuple(map(short_text, piece))


def _amplitudes(potential, rotation, start):
    """The amplitude of each wave of the start."""
    known = dict(zip(start.potential.waves, _doubles(start.potential.amplitude)))
    for wrong, has in ((start.rotation.floats != rotation.floats, "another rotation vector"),
                       (start.part is not None, "a parameter; take a torus of one map"),
                       (not set(known) <= set(potential.waves),
                        "waves that the potential does not have")):
        if wrong:
            raise ValueError("the torus to start from has " + has)
    return known


def _single(found, way, margin):
    """The torus of one potential.  How many modes it needs is known from its decay in doubles, and
    then from the error that is left.  Near break-up the largest modes stand far apart.  So the next
    mesh is larger."""
    n, more, torus, points = way.potential.dimension, 1.0, None, 0
    for turn in range(1, ROUNDS + 1):
        aim = plan(found, margin, more)
        while (mesh := aim.mesh(found.mesh)).points <= points:
            more *= 1.1
            aim = plan(found, margin, more)
        way.check_cost(mesh.points)
        modes, points = Modes(mesh, aim.keep(mesh)), mesh.points
        bits = aim.bits(modes.k, 0, margin)
        # Modes below the noise stay: they belong to the errors of the others, and cancel in E.
        numbers = numbers_of(modes.picked(found.mesh.moved(found.u, mesh))[None], bits) \
            if torus is None else taken(modes, bits, torus)
        way.tell("refining a torus of %d modes" % len(modes.at),
                 SINGLE * balls(mesh.points, bits + SPARE_BITS),
                 VERIFYING[n] * NEEDED[n] * aim.modes(mesh))
        torus, ratio = refined(
            Torus(way.potential, None, way.rotation, bits, modes.k.T, numbers, aim.strip), modes,
            aim, margin, turn == ROUNDS)
        if ratio <= accepted(margin):
            return torus
        more *= 1.05 + log(ratio * margin) / ((aim.rate - aim.rho) * aim.size)
    if ratio < 1:
        return torus
    raise NotFound("the torus is seen, but with %d modes its error is %.2g times the error that "
                   "the theorem admits" % (len(modes.at), ratio), 1.0, [float(p) for p in way.last])


# ---- a range

class _Pieces:
    """Cuts a range of s into pieces where the torus is a polynomial in sigma, to the precision that
    the theorem needs.

    Its coefficients follow, by Cauchy's formula, from the tori at complex amplitudes, on the circle
    that has the piece as its diameter.  If the tori end at s = e, those of sigma^j fall about as
    r^j, r the half of the piece's length over the distance of its middle from e.  So a piece is
    made as long as the degree wanted permits.  Where e was guessed too far away, they decay too
    slowly, or Newton's method fails: a shorter piece is tried.

    end -- e, about, beyond 1 or beyond -1; infinity: far away"""

    def __init__(self, search: Search, rotation: Rotation, margin: float) -> None:
        self.search, self.potential, self.part = search, search.potential, search.part
        self.rotation, self.margin, self.tell = rotation, margin, search.tell
        self.amplitude = search.amplitude
        self.frame: Optional[Frame] = None
        self.end = inf
        self.alpha: Optional[Weights] = None
        self.more = 1.0                 # times as many modes as `plan` estimates

    def cover(self, found: Found) -> List[Torus]:
        """The pieces from s = -1, whose torus this is, to 1."""
        low, longest, tori = Fraction(-1), Fraction(2), []
        self.frame = found.mesh.frame
        middle = self._followed(found, low, Fraction(0))
        last = self._followed(middle, Fraction(0), Fraction(1))
        worst = min(found, last, key=lambda each: float(each.rates.min()))
        self.alpha = plan(worst, self.margin).alpha             # one norm for all pieces
        at = [float(np.prod(each.rates)) ** (1 / len(each.rates))
              for each in (found, middle, last)]
        if at[2] < at[1]:               # as if rates of decay fell along a line
            self.end = 1 + at[2] / (at[1] - at[2])
        elif at[0] < at[1]:
            self.end = -1 - at[0] / (at[1] - at[0])
        while low < 1:
            high = min(low + min(longest, self._length(low, found, last)), Fraction(1))
            middle = self._followed(found, low, (low + high) / 2)
            ends = [found, middle, last if high == 1 else self._followed(
                middle, (low + high) / 2, high)]
            guess, torus = self.end, self._torus((low, high), ends)
            if torus is not None:
                tori.append(torus)
                low, found, longest = high, ends[-1], Fraction(2)
            elif high - low < 2 * NARROWEST:
                raise NotFound("no torus that is a polynomial in the parameter was found on a "
                               "piece of the range, however short, at %s" % ", ".join(
                                   "%.6g" % float(p) for p in self.amplitude((low + high) / 2)),
                               float(low + 1) / 2, [float(p) for p in self.amplitude(low)])
            else:                       # Less is cut, if the end of the tori is known better now.
                longest = (high - low) * (Fraction(1, 2) if self.end == guess else Fraction(7, 8))
        return tori

    def _followed(self, found: Found, begin: Fraction, end: Fraction) -> Found:
        """The torus at s = end, from that at s = begin."""
        return self._placed(begin, end, lambda way: way.follow(found))

    def _placed(self, begin, end, call):
        """Calls a function with the way from s = begin to s = end."""
        try:
            way = self.search.way(self.rotation, self.amplitude(begin), self.amplitude(end),
                                  float(begin), float(end))
            way.frame, way.chosen = self.frame, True        # one for all pieces
            return call(way)
        except NotFound as error:
            s = float(begin) + error.reached * float(end - begin)
            raise NotFound(str(error), (s + 1) / 2, error.amplitude) from None

    def _length(self, low: Fraction, found: Found, last: Found) -> Fraction:
        """The length of the piece that begins at `low`, where the torus is found; `last` is the
        torus at s = 1.  Between both, the admissible error and the points of the mesh are taken for
        powers of the distance from the end."""
        ends = []
        for each in (found, last):
            aim = plan(each, self.margin, alpha=self.alpha)
            ends.append((log(self.margin / aim.needed), log(aim.mesh(each.mesh).points)))
        begin, rest = float(low), 1 - float(low)
        gap = abs(self.end - begin)

        def is_short(length):
            part = length / rest
            if gap < inf:
                part = log(gap / abs(self.end - begin - length)) / log(gap / abs(self.end - 1))
            digits, points = ((1 - part) * x + part * y for x, y in zip(*ends))
            degree = min(DEGREE, max(LEAST_DEGREE, LARGEST / exp(points)))
            ratio = 2 * abs(self.end - begin - length / 2) / length
            return length <= rest and degree * log(ratio) >= digits

        length, step = 0.0, rest
        while step > NARROWEST:
            length, step = length + step * is_short(length + step), step / 2
            if length > ALL * rest:
                return 1 - low
        unit = 32 << max(0, ceil(-log2(max(length, NARROWEST))))
        return Fraction(ceil(max(length, NARROWEST) * unit), unit)

    def _torus(self, piece: Ends, ends: List[Found]) -> Optional[Torus]:
        """The torus of a piece, from those at its ends and in its middle; None: it is too long."""
        worst = min(reversed(ends), key=lambda found: float(found.rates.min()))
        aim = plan(worst, self.margin, self.more, self.alpha)
        series = self._series(piece, ends, worst)
        if series is None:
            return None
        source, c = series
        sizes = np.sqrt((abs(c) ** 2).sum(1)) @ np.exp(aim.rho * aim.length(source.k))
        least, (low, high) = aim.needed / (10 * self.margin), map(float, piece)
        enough, side = series_degree(sizes, least), -1 if self.end < 0 else 1
        rate = min(log(sizes.max() / least) / enough, 50) if enough else 50.0
        self.end = side * max(1 + NARROWEST, side * (low + high) / 2
                              + (high - low) / 2 * exp(rate))
        degree = max(LEAST_DEGREE, ceil(enough))
        mesh = aim.mesh(worst.mesh, real=False)
        if degree > max(LEAST_DEGREE, min(MOST_DEGREE, LARGEST // mesh.points)):
            return None
        layers = layers_for(degree)
        self._placed(*piece, lambda way: way.check_cost(mesh.points, layers))
        modes = Modes(mesh, aim.keep(mesh))
        bits = aim.bits(modes.k, degree, self.margin)
        # on the mesh of the modes of the piece: those that both have
        begun = Torus(self.potential, self.part, self.rotation, bits, source.k.T,
                      numbers_of(c[:degree + 1], bits), aim.strip, piece)
        torus = replace(begun, k=modes.k.T, numbers=taken(modes, bits, begun))
        self.tell("refining the tori of %s, %d modes of degree %d" % (
            _range_text(piece), len(modes.at), degree), REFINING * BALLS * mesh.points * layers)
        torus, ratio = refined(torus, modes, aim, self.margin)
        if ratio <= 10 / self.margin:
            return torus
        self.more *= 1.2                # a shorter piece with as few modes may fail, too
        return None

    def _series(self, piece, ends, worst):
        """(where its modes are, the coefficients of the torus as a series in sigma, as
        Modes.series gives them)."""
        mesh = Mesh(self.potential, self.rotation, worst.mesh.frame, worst.mesh.sizes, real=False)
        keep = ellipse(mesh, worst.rates, worst.reach)
        low, middle, high = (found.mesh.moved(found.u, mesh) for found in ends)
        source = Modes(mesh, keep & (abs(mesh.k).max(0) > 0))
        half = (ends[-1].amplitude - ends[0].amplitude) / 2
        half_circle = range(LAYERS // 2 + 1)
        self.tell("looking for the tori of %s, on %d points" % (
            _range_text(piece), mesh.points), SOLVING * mesh.points * len(half_circle))
        circle = []
        for l in half_circle:
            sigma = np.exp(2j * np.pi * l / LAYERS)
            guess = middle + (high - low) / 2 * sigma + ((high + low) / 2 - middle) * sigma ** 2
            solved = newton(mesh, guess, ends[1].amplitude + sigma * half, keep)
            if solved is None:
                return None
            circle.append(solved[0])
        return source, source.series(iter(circle), LAYERS)


def series_degree(sizes: np.ndarray, least: float) -> float:
    """About the power at which the coefficients of a series fall to the size `least`.

    Sizes above the noise are known; the second half of them, of negative powers, is nothing else.
    They fall more slowly with each power, so their last slope leads on from the last of them."""
    powers, noise = np.split(sizes, 2)
    last = int(np.flatnonzero(powers > 10 * noise.max())[-1:].sum())
    height = np.log(np.maximum.accumulate(powers[last::-1])[::-1])  # the largest farther on
    if len(below := np.flatnonzero(height <= log(least))):
        return float(below[0])
    before = max(last - max(2, last // 3), 0)
    fall = (height[before] - height[last]) / max(last - before, 1)
    return last + (height[last] - log(least)) / fall if fall > 0 else 0.0
