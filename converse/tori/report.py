"""What the command converse-tori prints, in the manner of the report of 1989.  Bounds are rounded
to the safe side."""

import math
from fractions import Fraction
from typing import List, Optional, Sequence, Union

from ..model.exact import decimal_text, rounded, rounded_text, short_text
from ..model.potential import FourierSum
from ..model.problem import Problem, wave_text
from ..storage.files import plain
from ..version import __version__
from .find import NotFound
from .proved import NotProved, Piece, ProvedTorus
from .rotation import Rotation, element_text, polynomial_text
from .torus import Part, Strip, family

PLUSES = "+" * 48
PLACES = 6                              # of amplitudes, at least
DIGITS = 20                             # of omega
TORUS = {1: "a rotational invariant circle", 2: "an invariant torus"}       # by dimension
VECTOR = {1: "rotation number", 2: "rotation vector"}


def header(problem: Problem, rotation: Rotation) -> str:
    """What is known before the search: the map, the rotation vector, comments of the input."""
    n = rotation.dimension
    lines = ["Map : y' = y + J', J' = J - dV(y), V(y) = - the sum of :", *_waves(*family(problem)),
             "", "%s : %s" % (VECTOR[n].capitalize(), plain(str(rotation))),
             "t : the root of %s near %s" % (polynomial_text(rotation.polynomial), _rounded(
                 rotation, (Fraction(0), Fraction(1), Fraction(0))[:n + 1]))]
    lines += ["%s : %s = %s..." % (name, element_text(element), _rounded(rotation, element))
              for name, element in zip(_names("omega", n), rotation.vector)]
    lines += ["", "Comments :", "", *(("> " + plain(comment)).rstrip()
                                      for comment in problem.comments), "", PLUSES]
    return "\n".join(lines) + "\n"


def _names(name, n):
    return [name] if n == 1 else ["%s[%d]" % (name, i) for i in range(n)]


def _rounded(rotation, element):
    """The value, cut after so many digits."""
    low, _ = rotation.field.bounds(element, DIGITS + 2)
    return ("-" if low < 0 else "") + decimal_text(
        Fraction(math.floor(abs(low) * 10 ** DIGITS), 10 ** DIGITS), DIGITS)[:DIGITS]


def _waves(potential: FourierSum, part: Part) -> List[str]:
    """The waves, exactly."""
    lines = []
    for j, (wave, p) in enumerate(zip(potential.waves, potential.amplitude)):
        moves = "" if part is None or not part[j] else " %s %s s" % (
            "-" if part[j] < 0 else "+", decimal_text(abs(part[j]), PLACES))
        lines.append("p %s, p = %s%s" % (wave_text(wave), decimal_text(p, PLACES), moves))
    return lines + ([] if part is None else ["for -1 <= s <= 1"])


def verdict(proof: ProvedTorus, seconds: Optional[float] = None,
            certificate: Optional[str] = None, checksum: str = "") -> str:
    """The theorem, and how near it was.

    seconds -- that finding and proving took; by default what verifying took
    certificate, checksum -- the file's name and SHA-256, if there is one"""
    n, worst = proof.rotation.dimension, proof.worst
    lines = ["I find %s of this %s for V(y) = - the sum of :" % (TORUS[n], VECTOR[n]),
             *_waves(proof.torus.potential, proof.torus.part), "",
             "It is a real analytic graph J = P + S'(y) over all angles, P constant, S periodic.",
             "The map takes its point y(theta) = theta + u(theta) to y(theta + w), w = 2 pi omega.",
             ""]
    lines += ["|u - u0| at most : %s, u0 the u of the certificate"
              % _up(max(piece.distance for piece in proof.pieces)), ""]
    if len(proof.pieces) > 1:
        lines += [_piece_line(piece) for piece in proof.pieces]
        lines += ["", "What follows is of the piece with the least margin."]
    lines += ["Residual : %s at most; the theorem needs %s, about" % (_up(worst.residual),
                                                                      _down(worst.needed))]
    assert worst.torus.strip is not None
    lines += _divisors(worst, worst.torus.strip)
    lines += ["Width rho of the strip : %.6g" % worst.torus.strip.rho,
              "Constants : " + ", ".join("%s0 %s" % (name, _up(getattr(worst.constants, name), 4))
                                         for name in "lmabp"),
              "Torus : %d modes of %d bits%s" % (
                  len(worst.torus.k), worst.torus.bits,
                  "" if worst.torus.part is None else ", polynomials in s of degree %d"
                  % worst.torus.degree),
              "Series : %d modes of %d bits" % (worst.modes, worst.bits), "",
              "This investigation took %.2f seconds." % (
                  proof.seconds if seconds is None else seconds), ""]
    if certificate is not None:
        lines += ["Certificate : %s" % plain(certificate), "SHA-256 : %s" % checksum]
    lines += ["Program : converse " + __version__,
              "Method : an a-posteriori KAM theorem (docs/proofs/existence.md), verified in "
              "integers"]
    return "\n".join(lines) + "\n"


def _piece_line(piece: Piece) -> str:
    low, high = piece.torus.piece
    return "For %s <= s <= %s : %d modes of degree %d, residual %s, needed %s" % (
        short_text(low), short_text(high), len(piece.torus.k), piece.torus.degree,
        _up(piece.residual), _down(piece.needed))


def _divisors(piece: Piece, strip: Strip) -> List[str]:
    """The checker's gamma is for the weights alpha as integers, by their common denominator."""
    n, scale = len(strip.alpha), math.lcm(*(a.denominator for a in strip.alpha))
    terms = []
    for row, a in zip(strip.frame, strip.alpha):
        angle = " ".join("%s %s" % ("-" if x < 0 else "+", name if abs(x) == 1 else
                                    "%d %s" % (abs(x), name))
                         for x, name in zip(row, _names("k", n)) if x)
        terms.append("%s|%s|" % ("" if a == 1 else "%s " % a,
                                 angle[2:] if angle[0] == "+" else "-" + angle[2:]))
    return ["Small divisors : |1 - exp(i k.w)| >= %s/%s for k != 0" % (
                _down(piece.gamma / scale ** n, 6), "|k|" if n == 1 else "|k|^2"),
            *(["k : the integer combinations of %s, |k| = %s" % (" and ".join(
                "(%s)" % ", ".join(map(str, k)) for k in piece.basis), " + ".join(terms))]
              if n == 2 or strip.alpha != (1,) else [])]


def undecided(problem: Problem, rotation: Rotation, reason: Union[NotFound, NotProved],
              by_hand: Sequence[str] = ()) -> str:
    """That there is no theorem, and why.

    by_hand -- flags that took a choice from the program"""
    n = rotation.dimension
    lines = ["I could not decide whether there is %s of this %s for V(y) = - the sum of :"
             % (TORUS[n], VECTOR[n]), *_waves(*family(problem)), "",
             "%s : %s" % ("Not found" if isinstance(reason, NotFound) else "Not proved",
                          plain(" ".join(str(reason).split())))]
    if by_hand:
        lines.append("Chosen by hand : %s; without such a flag the program chooses"
                     % ", ".join(by_hand))
    return "\n".join(lines) + "\n"


def _up(x: Union[float, Fraction], digits: int = 3) -> str:
    """x >= 0, rounded up."""
    return _text(Fraction(x), digits, True) if math.isfinite(x) else "unbounded"


def _down(x: Union[float, Fraction], digits: int = 3) -> str:
    """x >= 0, rounded down."""
    return _text(Fraction(x), digits, False)


def _text(x, digits, up):
    if not Fraction(1, 1000) <= x < 10000:
        return rounded_text(x, digits, up)
    places = max(0, digits - 1 - math.floor(math.log10(x)))
    return decimal_text(rounded(x, places, up), places)
