"""Proofs that there are invariant tori: find one in floating-point numbers, bound its residual and
constants in ball arithmetic, and check the theorem's inequality (docs/existence.md)."""

import math
import os
import time
from contextlib import closing
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any, Callable, Dict, Optional, Sequence, Tuple, Union

import numpy as np

from ..model.balls import precision
from ..model.exact import exact, rounded_text
from ..model.problem import Problem
from ..storage.files import ConverseError
from ..storage.signals import postponed
from .constants import Constants, Inverse
from .divisors import Divisors, Norm, lattice_basis
from .effort import BYTES, INVERSE, INVERTING, balls, free_memory, proving, some
from .residual import LADDER, Grid, Phases, Sizes, residual, wave_vectors
from .rotation import Rotation
from .theorem import Bounds, Theorem, Verdict
from .torus import Torus, family

AIM = 200.0                 # what grid and roundings are to leave of the admissible residual
CLOSE = 1 / 200             # |I - L M| that is close enough
WIDTHS = [1.25 ** -j for j in range(20)]        # of the rate of decay: the rho that are tried
ALPHAS = tuple(Fraction(a, 2) for a in (2, 3, 4, 5, 6, 8, 10, 12, 16))      # ratios of weights
MOST_BITS, MOST_LAYERS = 4000, 1024
SPARE = 1.03                # a grid reaches so many times as far as the modes, at least
HUGE = 1 << 30              # above the components of modes and of coefficients
# A torus whose residual is so many times larger than needed, at most, is found more accurately,
# with a margin so many times larger.
MOST_LACKING, FINER = 1e8, 1e4
Progress = Optional[Callable[[str], None]]


class NotProved(ConverseError):
    """The inequality of the theorem does not hold for this torus; the text says what to mend.

    residual, needed -- the norm of E(u) that was reached, and the largest for which the theorem
    would hold; infinity and 0 if they are not known"""

    def __init__(self, text: str, residual: float = math.inf, needed: float = 0.0) -> None:
        super().__init__(text)
        self.residual, self.needed = residual, needed


@dataclass(frozen=True)
class Piece:
    """A proof for one torus: of one potential, or of a piece of a range.

    residual -- ||E(u)||_rho <= residual; `needed` would have done
    verdict -- of the theorem, with what was chosen in it
    rho, wider, radius -- widths: of the norms, and of the strip (and the disc of sigma) by which
        what the grid does not see is bounded
    tried -- (width, residual, needed) of all widths from which rho was chosen, `needed` not
        checked in balls
    grid, inverse_grid -- on which the residual and the inverse of I + Du were computed
    bits -- of the balls
    seconds, memory -- that the proof took; bytes, estimated
    """

    torus: Torus
    norm: Norm
    constants: Constants
    residual: float
    verdict: Verdict
    rho: Fraction
    wider: Fraction
    radius: Fraction
    tried: Tuple[Tuple[Fraction, float, float], ...]
    grid: Grid
    inverse_grid: Grid
    bits: int
    seconds: float
    memory: int

    @property
    def needed(self) -> float:
        """The largest residual with which the theorem holds, about."""
        return self.verdict.needed

    @property
    def bounds(self) -> Bounds:
        """The left sides of (16) to (18)."""
        assert self.verdict.bounds is not None
        return self.verdict.bounds

    @property
    def distance(self) -> float:
        """The true torus's u is no further away than this from the computed one, for real angles
        and in the sum of the Fourier coefficients' lengths."""
        return self.bounds.distance

    @property
    def slope(self) -> float:
        """The same for the first derivatives."""
        return self.bounds.slope

    @property
    def margin(self) -> float:
        """needed / residual."""
        return self.needed / self.residual


@dataclass(frozen=True)
class ProvedTorus:
    """A theorem: for every s of the range (for the potential, if there is no range) the map has a
    real analytic invariant graph, conjugate to the rotation, as near to the pieces' tori as they
    say."""

    pieces: Tuple[Piece, ...]

    @property
    def torus(self) -> Torus:
        """The first piece's; the only one if there is no range."""
        return self.pieces[0].torus

    @property
    def rotation(self) -> Rotation:
        return self.torus.rotation

    @property
    def worst(self) -> Piece:
        """The piece with the least margin."""
        return min(self.pieces, key=lambda piece: piece.margin)

    @property
    def residual(self) -> float:
        return self.worst.residual

    @property
    def needed(self) -> float:
        return self.worst.needed

    @property
    def distance(self) -> float:
        """Of the farthest piece."""
        return max(piece.distance for piece in self.pieces)

    @property
    def seconds(self) -> float:
        """Of processor time, of all pieces."""
        return sum(piece.seconds for piece in self.pieces)

    @property
    def memory(self) -> int:
        return max(piece.memory for piece in self.pieces)

    def _repr_html_(self) -> str:
        """For notebooks: the theorem and, where there is matplotlib, the picture."""
        from ..draw.torus_figure import proved_html
        return proved_html(self)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> str:
        """Writes the certificate (docs/format.md), compressed if the name ends in .gz, and returns
        its SHA-256 (that of the uncompressed file).  As with Proof.save() a file that is there is
        replaced; the command converse-tori refuses to.  ConverseError: it cannot be written; the
        older file, if any, is intact."""
        from .certificate import write
        return write(self, path)


def prove(source: Union[Problem, Torus, Sequence[Torus]], rotation: Optional[Rotation] = None, *,
          start: Optional[Torus] = None, margin: Optional[float] = None,
          points: Optional[int] = None, norm: Optional[Norm] = None,
          shape: Optional[Tuple[int, int]] = None, layers: Optional[int] = None,
          bits: Optional[int] = None, rho: Optional[Fraction] = None,
          memory: Optional[int] = None, jobs: int = 1, progress: Progress = None) -> ProvedTorus:
    """Proves that there is an invariant torus near the given one, or near one that is found first.

    source -- a Torus, or tori that cover a range, or a Problem, to which a rotation vector belongs
    start, margin, points -- with a Problem: what `find` takes
    norm, shape, layers, bits, rho -- of the proof (docs/existence.md); chosen, if they are not
        given
    memory -- bytes that the proof may take; by default three quarters of what is free
    jobs -- how many pieces of a range are proved at a time, each in a process of its own
    progress -- is told in words what is going on

    If a torus that was found turns out to be not accurate enough, a more accurate one is tried,
    unless the arguments say how accurate it, or the proof, is to be.

    NotProved: the inequality does not hold.  ValueError: the arguments do not go together, or a
    mode of a torus is not in the lattice that its waves generate.  What `find` raises."""
    def proof(found):
        tori = [found] if isinstance(found, Torus) else list(found)
        check_cover(tori)
        if isinstance(source, Problem) and \
                (tori[0].potential, tori[0].part, tori[0].rotation) != (*family(source), rotation):
            raise ConverseError("the torus that was found is not of the problem; this is an error "
                                "of the program")
        return ProvedTorus(_pieces(tori, (norm, shape, layers, bits, rho), memory, jobs, progress))

    if jobs < 1:
        raise ValueError("jobs is %s; at least one piece is proved at a time" % jobs)
    finding: Dict[str, Any] = {name: value for name, value in (
        ("start", start), ("margin", margin), ("points", points)) if value is not None}
    if not isinstance(source, Problem):
        if finding:
            raise ValueError("start, margin and points are for a Problem, whose torus is looked "
                             "for")
        tori = [source] if isinstance(source, Torus) else list(source)
        if rotation is not None and any(torus.rotation != rotation for torus in tori):
            raise ValueError("the torus has another rotation vector than the one that is given")
        return proof(tori)
    if rotation is None:
        raise ValueError("a problem needs a rotation vector")
    from .find import find

    if progress:
        progress("looking for a torus")
    try:
        return proof(find(source, rotation, progress=progress, **finding))
    except NotProved as failure:
        lacking = failure.residual / failure.needed if failure.needed else math.inf
        if not 1 < lacking < MOST_LACKING or any((margin, shape, bits, rho)):
            raise
    if progress:
        progress("looking for a more accurate torus")
    return proof(find(source, rotation, progress=progress,
                      **dict(finding, margin=FINER * lacking)))


def _pieces(tori, choices, memory, jobs, progress):
    """Their proofs."""
    memory, jobs = free_memory() * 3 // 4 if memory is None else memory, min(jobs, len(tori))
    tell = progress or (lambda text: None)
    if jobs == 1:
        tell("proving %s%s" % ("the torus" if len(tori) == 1 else "%d pieces" % len(tori),
                               some(sum(map(proving, tori)))))
        return tuple(_proof(torus, choices, memory, tell) for torus in tori)

    from ..check.processes import ProcessDied, in_order

    seconds, found = list(map(proving, tori)), {}
    order = sorted(range(len(tori)), key=seconds.__getitem__, reverse=True)     # the longest first
    tell("proving %d pieces, %d at a time%s" % (
        len(tori), jobs, some(max(sum(seconds) / jobs, *seconds))))
    try:
        with closing(in_order(partial(_proved_apart, choices, memory // jobs),
                              [tori[number] for number in order], jobs, postponed)) as pieces:
            for number, piece in zip(order, pieces):
                found[number] = replace(piece, torus=tori[number])
                tell("%d of %d pieces are proved" % (len(found), len(tori)))
    except ProcessDied:
        raise ConverseError("a process that worked at a piece died, perhaps for lack of memory; "
                            "let fewer work at a time (jobs)") from None
    return tuple(found[number] for number in range(len(tori)))


def _proved_apart(choices, memory, torus):
    """Proves a piece in a process of its own."""
    with np.errstate(all="ignore"):
        return _proof(torus, choices, memory, lambda text: None)


def _proof(torus, choices, memory, tell):
    with precision():
        return _Attempt(torus, *choices, memory, tell).run()


def check_cover(tori: Sequence[Torus]) -> None:
    """ValueError: these are not tori of one map and rotation vector that cover a range, one after
    the other, or one torus if there is no range."""
    if not tori:
        raise ValueError("there is no torus")
    first = tori[0]
    for torus in tori:
        _check(torus)
        if (torus.potential, torus.part, torus.rotation) != (
                first.potential, first.part, first.rotation):
            raise ValueError("the tori are of different potentials or rotation vectors")
    ends = [torus.piece for torus in tori]
    wanted = (Fraction(0), Fraction(0)) if first.part is None else (Fraction(-1), Fraction(1))
    if first.part is None and len(tori) > 1 or (ends[0][0], ends[-1][1]) != wanted or any(
            a[1] != b[0] for a, b in zip(ends, ends[1:])) or any(
            a >= b for a, b in ends if first.part is not None):
        raise ValueError("the pieces do not tile the range, one after the other")


def _check(torus: Torus) -> None:
    """ValueError: this is not what the class says a torus is."""
    waves, amplitude, n = torus.potential
    if n not in (1, 2) or n == 1 and any(k1 for _, k1, _ in waves):
        raise ValueError("the potential is not one of %s angles: its waves are %s" % (n, waves))
    if len(amplitude) != len(waves) or torus.part is not None and len(torus.part) != len(waves):
        raise ValueError("each wave has one amplitude, and one part if there is a range")
    numbers = [*amplitude, *(torus.part or ()), *torus.piece, *(phase for _, _, phase in waves)]
    if not all(type(x) in (int, Fraction) for x in numbers) or not all(
            type(x) is int for k in (*torus.modes, *(wave[:2] for wave in waves)) for x in k):
        raise ValueError("amplitudes, their parts, phases and pieces are Fractions, and waves and "
                         "modes integers; give them so, for other numbers are rounded")
    for k, series in torus.modes.items():
        if len(k) != n or not tuple(k) > (0,) * n:
            raise ValueError("the torus has the mode %s; of k and -k give the one whose first "
                             "component that is not 0 is positive, and no 0" % (tuple(k),))
        if not series or not all(len(c) == 2 * n and all(type(x) is int for x in c)
                                 for c in series):
            raise ValueError("the coefficients of the mode %s are not %d integers each"
                             % (tuple(k), 2 * n))
        if any(abs(x) >= HUGE for x in k) or any(
                abs(x) >> torus.bits >= HUGE for c in series for x in c):
            raise ValueError("the mode %s, or its coefficient, is too large" % (tuple(k),))


class _Attempt:
    """The proof of one torus."""

    def __init__(self, torus, norm, shape, layers, bits, rho, memory, tell):
        self.torus, self.shape, self.bits = torus, shape, bits
        self.rho = rho = None if rho is None else exact(rho)    # products of doubles are rounded
        self.memory, self.tell = memory, tell
        self.start = time.process_time()
        self.waves = wave_vectors(torus)
        if norm is not None and norm.dimension != torus.dimension:
            raise ValueError("the norm is one of %d angles, and the map has %d"
                             % (norm.dimension, torus.dimension))
        if bits is not None and not 2 <= bits <= MOST_BITS:
            raise ValueError("balls have from 2 to %d bits, not %s" % (MOST_BITS, bits))
        if rho is not None and not 0 < rho < LADDER[-1]:
            raise ValueError("rho = %s is not between 0 and %d" % (rho, LADDER[-1]))
        self.norm = _norm(torus) if norm is None else norm
        self.far = _distances(torus, self.norm)
        self.layers = layers
        self.phases = Phases(torus, self.norm)
        self.tell("bounding small divisors")
        self.theorem = Theorem(self.phases, Divisors(
            torus.rotation, self.norm, lattice_basis(self.waves)))

    def run(self) -> Piece:
        self.rate = rate = self._rate()
        widths = [Fraction(rate * x).limit_denominator(10 ** 6) for x in WIDTHS] \
            if self.rho is None else [self.rho]
        widths = [rho for rho in widths if rho > 0]
        inverse, grid, rho, at = self._plan(widths)
        bits = self.bits or self._bits(grid, rho, at[rho])
        self._tell("computing the residual", grid.shape, grid.layers, balls(grid.points, bits))
        error = residual(self.torus, grid, bits)

        tries = []
        for width in at:
            tail, wider, radius = self.phases.best_tail(grid, width)
            e0 = error.norm_at(width, tail)
            tries.append((at[width] / e0, width, e0, tail, wider, radius))
        _, rho, e0, tail, wider, radius = max(tries)
        constants = inverse.at(rho)
        verdict = self.theorem.verdict(constants, e0)
        if verdict.bounds is None:
            raise NotProved(self._remedy(e0, tail, verdict.needed, error.sizes, rho),
                            e0, verdict.needed)
        tried = tuple(sorted((width, reached, at[width]) for _, width, reached, *_ in tries))
        return Piece(self.torus, self.norm, constants, e0, verdict, rho, wider, radius, tried, grid,
                     inverse.grid, bits, time.process_time() - self.start,
                     max(BYTES * grid.points, INVERTING * inverse.grid.points))

    def _rate(self):
        """At which coefficients decay; that of no modes, or of those that grow, is made up."""
        rate = self.torus.decay(self.far)
        return min(rate, 5.0) if rate > 0 else 1.0

    def _plan(self, widths):
        """(Inverse, the grid of the residual, about the best width, {width: needed residual})."""
        points, known = 64, {}
        layers = self._inverse_layers()
        while 2 * float(self._at(points, 1).reach) * self.rate < 12:
            points *= 2
        while True:
            shape = best_shape(self.norm, self.waves, points)
            self._check_cost(points * layers, INVERTING)
            self._tell("inverting I + Du", shape, layers, INVERSE * points * layers)
            inverse = Inverse(self.torus, self.norm, shape, layers)
            constants = {rho: inverse.at(rho) for rho in widths}
            at = {}
            for rho, c in constants.items():
                if c is not None and not (rho in known and c.near(known[rho][0])):
                    known[rho] = c, self.theorem.verdict(c, math.inf, careful=False).needed
                if c is not None and known[rho][1] > 0:
                    at[rho] = known[rho][1]
            best = self._grid(at)
            if best is not None:
                grid, rho = best
                if constants[rho].eta < CLOSE or points * layers > grid.points:
                    return inverse, grid, rho, at
            elif 4 * inverse.cut > 3 * self.far.max(initial=1) + 40:
                if layers <= 2 * self.torus.degree:
                    layers *= 2
                    continue
                raise NotProved("no approximate inverse of I + Du is good enough for the theorem "
                                "to hold with any residual; find a torus with more points, or for "
                                "smaller amplitudes")
            points *= 2

    def _inverse_layers(self):
        """Points of sigma for the inverse of L.  It need not be more than close, so its powers may
        end where the rest of those of Du is small, in a strip as wide as suits the torus."""
        if not self.phases.varies:
            return 1
        width = (4 * self.torus.dimension + 1) / self.far.max(initial=1)
        weights = np.linalg.norm(self.torus.vectors, axis=1) * np.exp(width * self.far)
        sizes = 2 * self.torus.lengths @ weights
        beyond = sizes.sum() - np.cumsum(sizes)         # of the powers above each
        return 2 << int(np.argmax(beyond < CLOSE / 20)).bit_length()

    def _grid(self, at):
        """The smallest grid that sees enough, and the best width with it; None if there is no
        width.

        Of the residual only what the grid does not see is known before it is computed."""
        if not at:
            return None
        layers = self.layers or self._layers(at)
        if self.shape is not None:
            grid = Grid(self.norm, self.waves, self.shape, layers)
            self._check_cost(grid.points)
            return grid, max(at, key=lambda rho: self._ratio(grid, rho, at[rho]))
        points, found = 16, None
        while True:
            grid = self._at(points, layers)
            points *= 2
            if not float(grid.reach) > self.far.max(initial=0):
                self._check_cost(grid.points)
                continue
            rho = max(at, key=lambda rho: self._ratio(grid, rho, at[rho]))
            ratio = self._ratio(grid, rho, at[rho])
            if ratio > AIM:
                return grid, rho
            if found is not None and (found[0] >= ratio or grid.points * BYTES > self.memory):
                return found[1:]
            self._check_cost(grid.points)
            found = ratio, grid, rho

    def _layers(self, at):
        """Points of sigma, of which so many are needed with any grid of the angles."""
        if not self.phases.varies:
            return 1
        layers = max(2, 1 << self.torus.degree.bit_length())
        while layers < MOST_LAYERS and not any(
                self.phases.sigma_tail(layers, rho)[0] < needed / AIM
                for rho, needed in at.items()):
            layers *= 2
        return layers

    def _at(self, points, layers):
        return Grid(self.norm, self.waves, best_shape(self.norm, self.waves, points), layers)

    def _tell(self, what, shape, layers, seconds):
        points = [x for x in (*shape, layers) if x > 1] or [1]
        self.tell("%s on %s points%s" % (what, " x ".join(map(str, points)), some(seconds)))

    def _ratio(self, grid, rho, needed):
        tail = self.phases.best_tail(grid, rho)[0]
        return needed / tail if tail > 0 else math.inf

    def _bits(self, grid, rho, needed):
        """So many that the radii make up about needed/AIM."""
        _, m = grid.inside
        mass = Sizes(self.norm, m, np.ones((len(m), 1))).norm_at(rho) * grid.layers
        bits = math.log2(mass * AIM * 64 / needed)
        if not bits < MOST_BITS:
            raise NotProved("the residual would have to be computed with more than %d bits; find a "
                            "torus for smaller amplitudes" % MOST_BITS)
        return max(64, math.ceil(bits))

    def _check_cost(self, points, each=BYTES):
        if points * each > self.memory:
            raise NotProved("a grid of %d points takes %.3g GB of memory, and %.3g GB may be used; "
                            "give a torus with fewer modes, more memory, or fewer jobs"
                            % (points, points * each / 1e9, self.memory / 1e9))

    def _remedy(self, e0, tail, needed, sizes, rho):
        text = "the residual is %s at rho = %.4g, and the theorem needs %s: " % (
            _number(e0), float(rho), rounded_text(Fraction(needed), 2, up=False))
        if not math.isfinite(e0) or tail > e0 / 2:
            return text + "what the grid does not see is too much; take a larger grid"
        text += "the torus is not accurate enough; find it with a larger margin, or more points"
        return text if self.bits is None else \
            text + ", or balls of %d bits are too few; take more" % self.bits


def _number(x):
    """x >= 0, rounded up."""
    return rounded_text(Fraction(x), 2, up=True) if math.isfinite(x) else "unbounded"


def best_shape(norm: Norm, waves: Sequence[Tuple[int, ...]], points: int) -> Tuple[int, int]:
    """Of the grids with so many points, a power of two, the one that reaches furthest."""
    if len(Grid(norm, tuple(waves), (1, 1)).basis) == 1:
        return 1, points
    shapes = [(1 << j, points >> j) for j in range(points.bit_length())]
    return max(shapes, key=lambda shape: Grid(norm, tuple(waves), shape).reach)


def _norm(torus):
    """A norm in which the modes need a small grid and divisors are large.  The width that suits a
    torus whose modes end at K is (4 tau + 1)/K about, and the loss of the first step a quarter of
    it: of some ratios of weights the one with the least product of c(2/K) and the points of a grid
    that holds the modes is taken."""
    if torus.dimension == 1:
        return Norm(((1,),), (Fraction(1),))
    from .newton import default_frame
    frame = default_frame(torus.potential)
    waves = wave_vectors(torus)
    basis = lattice_basis(waves)
    best = None
    for a, b in [(1, r) for r in ALPHAS] + [(r, 1) for r in ALPHAS[1:]]:
        norm = Norm(frame, (Fraction(a), Fraction(b)))
        far, points = _distances(torus, norm).max(initial=1), 16
        while float(Grid(norm, waves, best_shape(norm, waves, points)).reach) < SPARE * far:
            points *= 2
        try:
            cost = points * float(Divisors(torus.rotation, norm, basis, 100).c(
                Fraction(2 / far).limit_denominator(10 ** 6)))
        except ValueError:
            continue
        if best is None or cost < best[0]:
            best = cost, norm
    if best is None:
        raise NotProved("the small divisors of the rotation vector cannot be bounded")
    return best[1]


def _distances(torus, norm):
    """The |k| of the modes, in doubles."""
    m = abs(torus.vectors @ np.array(norm.frame).T)
    return m @ np.array([float(a) for a in norm.alpha])
