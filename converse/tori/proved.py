"""Proofs that there are invariant tori: find one in doubles, refine it, write its certificate, and
let the checker verify that.  Nothing here is proved by anything else: the theorem of
docs/proofs/existence.md has one implementation, converse/check/tori.py."""

import math
import os
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Dict, Optional, Sequence, Tuple, Union

from .. import check
from ..model.exact import Ends, rounded_text
from ..model.map import SymplecticMap
from ..model.problem import Problem
from ..model.statement import potential_text
from ..storage.files import ConverseError, Path
from ..storage.kept import Kept
from ..storage.methods import provided
from . import certificate
from .effort import VERIFYING, Tell, Work, limited
from .find import find
from .nearest import Place, rotation_of
from .rotation import Rotation
from .torus import Torus, family, problem_of

# If the residual exceeds the admissible one by a factor below MOST_LACKING, the torus is found
# again, with a margin of FINER times this factor.
MOST_LACKING, FINER = 1e8, 1e4


class NotProved(ConverseError):
    """The checker did not confirm the certificate of the torus; the text says why.

    Attributes
    ----------
    residual
        The norm of E(u) that was reached; infinity if it is not known.
    needed
        The largest norm for which the theorem would hold; 0 if it is not known.
    """

    def __init__(self, text: str, residual: float = math.inf, needed: float = 0.0) -> None:
        super().__init__(text)
        self.residual, self.needed = residual, needed


@dataclass(frozen=True)
class Piece(check.Verified):
    """The facts that the checker verified of one torus, of one potential or of a piece of a range.
    The numbers are rational and on the safe side.

    residual -- ||E(u)||_rho <= residual; the theorem would admit `needed`.
    distance -- a bound of |u - u0| at real angles, u0 being the u of the certificate.
    rho -- the width of the strip.
    constants -- the constants l0, m0, a0, b0 and p0 of the page, as attributes l, m, a, b and p.
    modes, bits -- of the checker's series.
    gamma, basis -- |1 - e^{i k.w}| >= gamma |k|^-n for all k != 0 of the group with this basis,
        the alpha of |k| being made integers by their common denominator.
    """

    torus: Torus

    @property
    def margin(self) -> float:
        """needed / residual."""
        return float(self.needed / self.residual) if self.residual else math.inf


@dataclass(frozen=True)
class ProvedTorus(Kept):
    """A theorem, which the checker has verified.  For every s of the range (for the potential, if
    nothing varies) the map has a real analytic invariant graph, conjugate to the rotation.  Each
    graph is within its piece's distance of the piece's torus.

    Attributes
    ----------
    pieces
        The facts that the checker verified of each piece of the range, in its order.  Their
        attributes include `torus`, `residual`, `needed`, `distance` and the width `rho` of the
        strip.
    certificate
        The text that was verified.
    seconds
        The processor time that the checker took.
    """

    pieces: Tuple[Piece, ...]
    certificate: str
    seconds: float

    def __repr__(self) -> str:
        return "<ProvedTorus: V = %s%s; rotation %s, within %s>" % (
            potential_text(problem_of(self.torus)), ", -1 <= s <= 1" * bool(self.torus.part),
            self.rotation, rounded_text(self.distance, 2, up=True))

    def _text(self) -> str:
        return self.certificate

    @property
    def torus(self) -> Torus:
        """The torus of the first piece; the only torus if nothing varies."""
        return self.pieces[0].torus

    @property
    def rotation(self) -> Rotation:
        """The rotation vector of all pieces."""
        return self.torus.rotation

    @property
    def worst(self) -> Piece:
        """The piece with the least margin."""
        return min(self.pieces, key=lambda piece: piece.margin)

    @property
    def residual(self) -> float:
        """A bound of the norm of E(u), of the worst piece."""
        return float(self.worst.residual)

    @property
    def needed(self) -> float:
        """The largest norm that the theorem would admit, of the worst piece."""
        return float(self.worst.needed)

    @property
    def distance(self) -> float:
        """Each invariant torus is within this distance of its piece's torus, at real angles."""
        return float(max(piece.distance for piece in self.pieces))

    def report(self) -> str:
        """The theorem in words, and its grounds."""
        return provided("ProvedTorus.report")(self)

    def plot(self, ax: Any = None) -> Any:
        """Draws the tori.

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned: one with one angle, a pair with
            two.  With None a Figure is returned, which also shows the Fourier coefficients and, for
            a range, the residual.
        """
        return provided("ProvedTorus.plot")([piece.torus for piece in self.pieces], ax, self.pieces)

    @classmethod
    def load(cls, path: Path, jobs: int = 1) -> "ProvedTorus":
        """Reads a certificate and lets the checker verify it: the result is a theorem again.

        Parameters
        ----------
        path
            The file, compressed or not.
        jobs
            As of verify().

        Raises
        ------
        ConverseError
            The file cannot be read, or is not a certificate.
        NotProved
            The checker does not confirm the torus.
        """
        return _verified(certificate.read(path).tori, jobs, Work())


def prove(source: Union[SymplecticMap, Problem, Torus, Sequence[Torus]],
          rotation: Union[Rotation, str, None] = None, *, near: Optional[Place] = None,
          start: Optional[Torus] = None, margin: Optional[float] = None,
          points: Optional[int] = None, memory: Optional[int] = None, jobs: int = 1,
          time_limit: float = math.inf, progress: Optional[Tell] = None,
          keep: Optional[Tell] = None) -> ProvedTorus:
    """Proves that there is an invariant torus near the given one, or near one that is found first.

    Parameters
    ----------
    source : Torus, sequence of Torus, SymplecticMap or Problem
        A torus, tori that cover a range, or a map.
    rotation : Rotation or str, optional
        The rotation vector; with a map, as `find` takes it.
    near, start, margin, points, memory : optional
        With a map: the arguments of `find`.
    jobs : int
        How many pieces of a range are verified at a time, in processes.
    time_limit : float
        Seconds, after which no step of the work begins.
    progress : callable, optional
        progress(text) is called with each step of the work.
    keep : callable, optional
        keep(text) is called with the certificate of a torus before the checker verifies it.

    Returns
    -------
    ProvedTorus

    Raises
    ------
    NotProved
        The checker does not confirm the torus.
    NotFound
        As `find` raises it.
    TimeIsUp
        The time limit is over.
    ValueError
        The arguments do not go together, or the checker refuses the claim of the torus.

    Notes
    -----
    If a torus that was found turns out to be not accurate enough, a more accurate one is tried,
    unless the arguments say how accurate it is to be.
    """
    if jobs < 1:
        raise ValueError("jobs is %s; at least one piece is proved at a time" % jobs)
    tell = limited(progress, time_limit)
    finding: Dict[str, Any] = {name: value for name, value in (
        ("near", near), ("start", start), ("margin", margin), ("points", points),
        ("memory", memory)) if value is not None}
    rotation = None if rotation is None else rotation_of(rotation)
    if not isinstance(source, (SymplecticMap, Problem)):
        if finding:
            raise ValueError("near, start, margin, points and memory are for a map, whose torus "
                             "is looked for")
        tori = [source] if isinstance(source, Torus) else list(source)
        if rotation is not None and any(torus.rotation != rotation for torus in tori):
            raise ValueError("the torus has another rotation vector than the one that is given")
        return _verified(tori, jobs, tell, keep)
    tell("looking for a torus")
    found = find(source, rotation, progress=tell, **finding)
    try:
        return _proved(source, found, jobs, tell, keep)
    except NotProved as failure:
        lacking = failure.residual / failure.needed if failure.needed else math.inf
        if not 1 < lacking < MOST_LACKING or margin:
            raise
    tell("looking for a more accurate torus")
    rotation = (found if isinstance(found, Torus) else found[0]).rotation
    finding.update(margin=FINER * lacking, near=None)
    return _proved(source, find(source, rotation, progress=tell, **finding), jobs, tell, keep)


def _proved(problem, found, jobs, tell, keep):
    proof = _verified([found] if isinstance(found, Torus) else found, jobs, tell, keep)
    torus = proof.torus
    if (torus.potential, torus.part) != family(problem) \
            or _ends(proof.pieces) != ((Fraction(-1), Fraction(1)) if torus.part else
                                       (Fraction(0), Fraction(0))):
        raise ConverseError("the torus that was found is not of the problem; this is an error of "
                            "the program")
    return proof


def _ends(pieces: Sequence[Piece]) -> Ends:
    return pieces[0].torus.piece[0], pieces[-1].torus.piece[1]


def _verified(tori, jobs, tell, keep=None):
    """Asks the checker to verify a certificate of these tori."""
    if not tori:
        raise ValueError("there is no torus")
    text, began = certificate.text(tori), processor_time()
    if len({(torus.potential, torus.part, torus.rotation, torus.strip[:2]) for torus in tori}) > 1:
        raise ValueError("the tori are of different potentials, rotation vectors or norms")
    if keep is not None:
        keep(text)
    tell("verifying the torus" if len(tori) == 1 else "verifying %d pieces" % len(tori), sum(
        VERIFYING[torus.dimension] * len(torus.k) * (torus.degree + 1) for torus in tori))
    try:
        claim = check.content(text.encode())
        _, facts = check.verify_torus(claim, lambda words: tell("verifying: " + words), jobs)
    except check.NotConfirmed as error:
        if not hasattr(error, "needed"):
            raise NotProved(str(error)) from None
        raise NotProved(str(error), float(error.residual), float(error.needed)) from None
    except check.Rejected as error:
        raise ValueError(str(error)) from None
    except check.Failure as error:
        raise ConverseError(str(error)) from None
    return ProvedTorus(tuple(
        Piece(**vars(fact), torus=torus)
        for torus, fact in zip(certificate.tori_of(claim), facts)), text,
        processor_time() - began)


def processor_time() -> float:
    """CPU seconds of this process and of its children that ended."""
    return sum(os.times()[:4])
