"""A torus x(theta) = theta + u(theta) of a map as a finite Fourier sum,

    u(theta) = sum over k of u_k e^{i k.theta},   u_{-k} = conj u_k,   u_0 = 0,

which invariant tori are proved to lie near.  It is on its own no claim that there is one.

The map has the potential V(y) = - sum of p[j] sin(k[j].y + pi phase[j]) of converse/model, and
angles and actions of period 2 pi.  An invariant torus solves the equation

    x(theta + w) - 2 x(theta) + x(theta - w) + grad V(x(theta)) = 0.

Here w is 2 pi omega for a rotation vector omega in turns, and J = x(theta) - x(theta - w).

For a range of parameters the amplitudes are p + s part with s in [-1, 1].  A torus covers a piece
(low, high) of these s by polynomials in sigma = (2 s - low - high)/(high - low).
"""

import os
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from ..model.exact import Ends
from ..model.map import SymplecticMap, from_patch
from ..model.potential import FourierSum, two_at_most
from ..model.problem import Problem
from ..model.statement import potential_text
from ..storage import files
from ..storage.methods import provided

if TYPE_CHECKING:
    from .rotation import Rotation

Part = Optional[Tuple[Fraction, ...]]
NO_RANGE = Fraction(0), Fraction(0)
FLAT = 5.0                  # Series that decay at this rate or faster have one or two modes.
ASPECTS = 1.0, 0.25, 0.4, 0.6, 1.6, 2.5, 4.0, 6.0   # Ratios of two rates of decay that are tried.
ENTRIES = 10 ** 6           # A matrix of modes and angles has at most about these entries.


def family(source: Union[SymplecticMap, Problem]) -> Tuple[FourierSum, Part]:
    """The potential in the middle of the patch of a map, and the change of each amplitude by
    the parameter s = 1, None without a parameter.  Waves that are 0 in the patch are left out.

    Its dimension is 1 if all these waves have k1 = 0, else 2.
    TypeError: it is not a map, nor the problem of one.  ValueError: there is more than one
    parameter, or no wave, or there are three angles."""
    problem = Problem.of(source)
    two_at_most(problem.map.dimension)
    parts = [m for m, part in enumerate(problem.parts) if any(part)]
    if len(parts) > 1:
        raise ValueError("the problem has %d parameters where one is possible; make the other "
                         "ranges single numbers, or let them change together" % len(parts))
    terms = [term for term in problem.terms if term.most]
    if not terms:
        raise ValueError("V is 0: every torus J = constant is invariant, and there is nothing "
                         "to prove; give an amplitude that is not 0")
    potential = FourierSum(tuple((*term.k, term.phase) for term in terms),
                           tuple(term.p for term in terms),
                           2 if any(term.k[1] for term in terms) else 1)
    return potential, tuple(term.parts[m] for term in terms for m in parts) if parts else None


def problem_of(torus: "Torus") -> Problem:
    """The problem of a torus whose input is not at hand, with the parameter s in [-1, 1]."""
    return Problem(from_patch(torus.potential.waves, torus.potential.amplitude,
                              [torus.part] if torus.part else [],
                              [("s", Fraction(-1), Fraction(1))] if torus.part else ()))


class Strip(NamedTuple):
    """The norm in which the theorem is verified.  It is a choice of the proof, not of the claim.

    Attributes
    ----------
    frame, alpha
        n rows of n integers, and n positive numbers: |k| = sum of alpha[i] |frame[i].k|.
    rho
        The width of the strip: the norm of f is the sum of |f_k| e^{rho |k|}.
    """

    frame: Tuple[Tuple[int, ...], ...]
    alpha: Tuple[Fraction, ...]
    rho: Fraction


@dataclass(frozen=True, eq=False)
class Torus:
    """A torus x(theta) = theta + u(theta) of a map, u a finite Fourier sum without a mean.  It need
    not be invariant: prove() shows that an invariant torus is near.

    Parameters
    ----------
    potential
        The potential, of n angles, with the amplitudes at s = 0.
    part
        The change of each amplitude by the parameter s = 1; None: there is no parameter.
    rotation
        The rotation vector omega, in turns.
    bits
        Coefficients are integers times 2^-bits.
    k
        The modes, integers of shape (modes, n) in lexicographic order: of k and -k the one that is
        lexicographically positive.
    numbers
        Python integers of shape (2, degree + 1, n, modes): the real and imaginary parts of the
        coefficient of sigma^j in each component of u_k, times 2^bits.
    strip
        The strip in which there is a proof, presumably; None if nothing is known of one.
    piece
        (low, high), the s that are covered; (0, 0) without a parameter.  On the piece sigma is
        (2 s - low - high)/(high - low).
    """

    potential: FourierSum
    part: Part
    rotation: "Rotation"
    bits: int
    k: np.ndarray
    numbers: np.ndarray
    strip: Optional[Strip] = None
    piece: Ends = NO_RANGE

    def __repr__(self) -> str:
        where = "" if self.part is None else ", s from %s to %s" % self.piece
        return "<Torus: V = %s; rotation %s, %d modes%s>" % (
            potential_text(problem_of(self)), self.rotation, len(self.k), where)

    @property
    def dimension(self) -> int:
        """n, of the angles theta."""
        return self.potential.dimension

    @property
    def degree(self) -> int:
        """The degree of the coefficients as polynomials in sigma."""
        return self.numbers.shape[1] - 1

    @cached_property
    def amplitudes(self) -> Tuple[Tuple[Fraction, Fraction], ...]:
        """A pair (c, d) for each wave: its amplitude on the piece is c + d sigma."""
        low, high = self.piece
        part = self.part or (Fraction(0),) * len(self.potential.amplitude)
        return tuple((p + (low + high) / 2 * d, (high - low) / 2 * d)
                     for p, d in zip(self.potential.amplitude, part))

    def sigma(self, s: float = 0) -> float:
        """The variable of the piece, in [-1, 1].

        Parameters
        ----------
        s
            The parameter; 0 without one.

        Raises
        ------
        ValueError
            s is outside of the piece.
        """
        low, high = map(float, self.piece)
        if not low <= s <= high:
            raise ValueError("s = %r is outside of the piece from %r to %r" % (s, low, high))
        return (2 * s - low - high) / (high - low) if high > low else 0.0

    @cached_property
    def doubles(self) -> np.ndarray:
        """The coefficients of the powers of sigma in complex doubles: shape (degree + 1, n, modes).
        """
        unit = 1 << self.bits
        re, im = (np.array([x / unit for x in part.ravel().tolist()]).reshape(part.shape)
                  for part in self.numbers)
        return re + 1j * im

    def coefficients(self, s: float = 0) -> np.ndarray:
        """The coefficients u_k in doubles.

        Parameters
        ----------
        s
            As of sigma().

        Returns
        -------
        array (modes, n)
            In the order of `k`.
        """
        return np.tensordot(self.sigma(s) ** np.arange(self.degree + 1), self.doubles, 1).T

    def _sum(self, theta, coefficients):
        """2 Re sum of c_k e^{i k.theta} over the modes."""
        flat = theta.reshape(-1, self.dimension)
        found = np.zeros(flat.shape)
        step = max(1, ENTRIES // max(len(flat), 1))
        for at in range(0, len(coefficients), step):
            angle = flat @ self.k[at:at + step].T
            found += 2 * (np.cos(angle) @ coefficients.real[at:at + step]
                          - np.sin(angle) @ coefficients.imag[at:at + step])
        return found.reshape(theta.shape)

    def x(self, theta: Any, s: float = 0) -> np.ndarray:
        """The points of the torus, as angles that are not taken modulo 2 pi.

        Parameters
        ----------
        theta
            Angles in radians: an array (..., n), or of any shape if n = 1.
        s
            As of sigma().

        Returns
        -------
        array
            Of the shape of theta.
        """
        theta = self._angles(theta)
        return theta + self._sum(theta, self.coefficients(s))

    def J(self, theta: Any, s: float = 0) -> np.ndarray:
        """The actions J = x(theta) - x(theta - w) of the torus: w + u(theta) - u(theta - w).

        Parameters
        ----------
        theta, s
            As of x().

        Returns
        -------
        array
            Of the shape of theta.
        """
        theta = self._angles(theta)
        turns = self.k @ np.array(self.rotation.floats, dtype=float)
        back = -np.expm1(-2j * np.pi * (turns - np.round(turns)))[:, None]
        return 2 * np.pi * np.array(self.rotation.floats, dtype=float) \
            + self._sum(theta, self.coefficients(s) * back)

    def _angles(self, theta):
        theta = np.asarray(theta, dtype=float)
        if self.dimension > 1 and theta.shape[-1:] != (self.dimension,):
            raise ValueError("theta has shape %s; its last axis must have length %d"
                             % (theta.shape, self.dimension))
        return theta

    def decay(self, s: Optional[float] = None) -> float:
        """Estimates the rate r at which the coefficients of u fall, about |u_k| < C e^{-r |k|}.

        Parameters
        ----------
        s
            As of sigma(); by default the middle of the piece.

        Returns
        -------
        float
            The slope, over the outer half of the modes, of the upper concave envelope of log|u_k|
            over |k|, the sum of |k_i|; infinity if there are fewer than two modes.
        """
        coefficients = self.doubles[0].T if s is None else self.coefficients(s)
        return decay(np.abs(self.k).sum(1), np.abs(coefficients).max(1, initial=0))

    def report(self) -> str:
        """A line or two about the torus, which is not proved."""
        return "%r\nCoefficients fall about as e^(-%.3g |k|), |k| the sum of |k_i|.  Nothing is " \
            "proved: tori.prove(torus) does.\n" % (self, self.decay())

    def plot(self, ax: Any = None) -> Any:
        """Draws the torus.

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned: one with one angle, a pair with
            two.  With None a Figure is returned, which also shows the Fourier coefficients.
        """
        return provided("Torus.plot")([self], ax)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> str:
        """Writes a certificate (docs/reference/torus-certificate.md) that nothing has verified.

        Parameters
        ----------
        path
            The file; the text is compressed if the name ends in .gz.

        Returns
        -------
        str
            The SHA-256 of the uncompressed text.

        Raises
        ------
        ValueError
            The strip is None.
        ConverseError
            The file cannot be written.
        """
        return files.write_text(path, provided("Torus.save")([self]))

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"]) -> "Torus":
        """Reads the torus of a certificate, the first if there are several.

        Parameters
        ----------
        path
            The file, compressed or not.

        Raises
        ------
        ConverseError
            The file cannot be read, or is not a certificate.
        """
        return provided("Torus.load")(path).tori[0]


def decay(far: np.ndarray, size: np.ndarray) -> float:
    """The rate r at which sizes fall with distances, about C e^{-r far}; see Torus.decay."""
    keep = size > 0
    if keep.sum() < 2:
        return np.inf
    order = np.argsort(far[keep], kind="stable")
    far, height = far[keep][order].astype(float), np.log(size[keep][order].astype(float))
    height = np.maximum.accumulate(height[::-1])[::-1]      # the largest farther out
    hull: List[Tuple[float, float]] = []                    # corners of the envelope
    for point in zip(far, height):
        while len(hull) > 1 and (hull[-1][1] - hull[-2][1]) * (point[0] - hull[-2][0]) <= \
                (point[1] - hull[-2][1]) * (hull[-1][0] - hull[-2][0]):
            hull.pop()
        hull.append(point)
    outer = hull[-1][0] / 2
    (x0, y0), (x1, y1) = max((p for p in hull if p[0] <= outer), default=hull[0]), hull[-1]
    return (y0 - y1) / (x1 - x0) if x1 > x0 else np.inf


def rates_of(m: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The rates at which sizes fall with one number m or with two, |m_0| and |m_1| of shape
    (numbers, count); of the pairs of rates that they permit, about, that of the largest product."""
    found = []
    for aspect in ASPECTS[:None if len(m) == 2 else 1]:
        each = np.array([1.0, aspect])[:len(m)]
        rate = decay(sum(a * row for a, row in zip(each, m)), sizes)
        found.append(each * min(FLAT / each.max(), max(rate, 1e-9)))
    return max(found, key=np.prod)
