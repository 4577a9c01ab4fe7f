"""The report of converse-tori: the theorem in the parameters of the input, and its grounds.
Bounds are rounded to the safe side."""

import math
from fractions import Fraction
from typing import Iterator, Optional, Sequence, Tuple, Union

from ..check.words import sum_text
from ..model.exact import decimal_text, rounded_text, short_text
from ..model.map import from_patch
from ..model.problem import Problem
from ..model.statement import TORUS, conditions, ended, indented, labelled, map_lines
from ..storage.files import plain
from ..storage.kept import verify_text
from ..version import __version__
from .effort import TimeIsUp
from .find import NotFound
from .proved import NotProved, Piece, ProvedTorus
from .rotation import Rotation, element_text, polynomial_text
from .torus import Strip, family, problem_of

DIGITS, FEW = 20, 14                    # characters of omega, and of omega in the theorem
VECTOR = {1: "rotation number", 2: "rotation vector"}


def _stated(problem: Problem) -> Problem:
    """The problem as it is stated: that of one angle where no wave depends on the other angle."""
    potential, part = family(problem)
    if problem.map.dimension == potential.dimension:
        return problem
    named = problem.parameters or [
        (letter, *ends) for letter, ends in zip("abc", problem.abc or ())]
    return Problem(from_patch(potential.waves, potential.amplitude, [part] if part else [], [
        each for each in named if each[1] < each[2]]))


def _rotation_lines(rotation: Rotation) -> Iterator[Tuple[str, str]]:
    """The rotation vector, exactly and to 20 digits."""
    n = rotation.dimension
    yield "Rotation", "%s, t the root of %s near %s" % (
        plain(str(rotation)), polynomial_text(rotation.polynomial),
        _rounded(rotation, rotation.field.t))
    for name, element in zip(_names("omega", n), rotation.vector):
        yield "", "%s = %s = %s..." % (name, element_text(element), _rounded(rotation, element))
    if n == 1:
        yield "", "      = " + rotation.continued_fraction()


def _input_lines(problem: Optional[Problem]) -> Iterator[Tuple[str, str]]:
    comments = problem.comments if problem else ()
    for label, comment in zip(["Input"] + [""] * len(comments), comments):
        yield label, ("> " + comment).rstrip()


def _names(name, n):
    return [name] if n == 1 else ["%s[%d]" % (name, i) for i in range(n)]


def _rounded(rotation, element):
    """The value, cut after DIGITS characters."""
    low, _ = rotation.field.bounds(element, DIGITS + 2)
    return ("-" if low < 0 else "") + decimal_text(
        Fraction(math.floor(abs(low) * 10 ** DIGITS), 10 ** DIGITS), DIGITS)[:DIGITS]


def verdict(proof: ProvedTorus, seconds: Optional[float] = None,
            certificate: Optional[str] = None, checksum: str = "",
            problem: Optional[Problem] = None) -> str:
    """The theorem, and how near the proof was to failing.

    Parameters
    ----------
    proof
    seconds
        CPU seconds of the search and the proof; by default of the verification alone.
    certificate, checksum
        The file's name and SHA-256, if there is one.
    problem
        The input, whose parameters and comments are used."""
    n, worst = proof.rotation.dimension, proof.worst
    stated = _stated(problem) if problem else problem_of(proof.torus)
    lines = ["THEOREM", *map_lines(stated), *ended(indented([
        "has %s with the %s omega = %s" % (_a(TORUS[n]), VECTOR[n], _omega(proof.rotation)),
        *conditions(stated)])), *indented([
            "It is a real analytic graph J = P + S'(y) over %s, P constant, S periodic.  The map "
            "takes its point y(theta) = theta + u(theta) to y(theta + 2 pi omega)."
            % ("the angle" if n == 1 else "both angles")]), ""]
    for label, text in _grounds(proof, worst, certificate):
        lines += labelled(label, text)
    for label, text in (*_input_lines(problem), (
            "Time", "%.2f CPU s" % (proof.seconds if seconds is None else seconds))):
        lines += labelled(label, text)
    if checksum:
        lines += labelled("SHA-256", checksum + " (certificate)")
    return "\n".join(lines) + "\n"


def _a(noun: str) -> str:
    return ("an " if noun[0] == "i" else "a ") + noun


def _omega(rotation: Rotation) -> str:
    """The first digits of the rotation vector; its elements are on lines of their own."""
    texts = [_rounded(rotation, element)[:FEW] + "..." for element in rotation.vector]
    return texts[0] if len(texts) == 1 else "(%s)" % ", ".join(texts)


def _grounds(proof: ProvedTorus, worst: Piece,
             certificate: Optional[str]) -> Iterator[Tuple[str, str]]:
    """(label, text) of the grounds of the theorem."""
    yield "Verify", verify_text(certificate, "certificate")
    yield from _rotation_lines(proof.rotation)
    yield "Distance", "|u - u0| <= %s, u0 the Fourier series of the certificate" % _up(
        max(piece.distance for piece in proof.pieces))
    if len(proof.pieces) > 1:
        yield "Pieces", "s goes from -1 at the lower end of the parameter to 1 at the upper end:"
        for piece in proof.pieces:
            yield "", _piece_line(piece)
        yield "", "The lines below are about the piece with the least margin."
    yield "Residual", "%s, admissible: %s" % (_up(worst.residual), _down(worst.needed))
    assert worst.torus.strip is not None
    yield from _divisors(worst, worst.torus.strip)
    yield "Strip", "rho = %s" % _down(worst.torus.strip.rho, 6)
    yield "Constants", ", ".join("%s0 = %s" % (name, _up(getattr(worst.constants, name), 4))
                                 for name in "lmabp")
    yield "Torus", "%s modes of %d bits%s" % (
        format(len(worst.torus.k), ","), worst.torus.bits, "" if worst.torus.part is None else
        ", polynomials in the parameter of degree %d" % worst.torus.degree)
    yield "Series", "%s modes of %d bits" % (format(worst.modes, ","), worst.bits)
    yield "Method", "an a-posteriori KAM theorem (manual: proofs/existence), verified in " \
        "integers; converse " + __version__


def _piece_line(piece: Piece) -> str:
    low, high = piece.torus.piece
    return "%s <= s <= %s: %d modes of degree %d, residual %s, admissible %s" % (
        short_text(low), short_text(high), len(piece.torus.k), piece.torus.degree,
        _up(piece.residual), _down(piece.needed))


def _divisors(piece: Piece, strip: Strip) -> Iterator[Tuple[str, str]]:
    """The checker's gamma is for the weights alpha as integers, by their common denominator."""
    n, scale = len(strip.alpha), math.lcm(*(a.denominator for a in strip.alpha))
    terms = ["%s|%s|" % ("" if a == 1 else "%s " % a, sum_text(row, _names("k", n)))
             for row, a in zip(strip.frame, strip.alpha)]
    yield "Divisors", "|1 - exp(2 pi i k.omega)| >= %s/%s for k != 0" % (
        _down(piece.gamma / scale ** n, 6), "|k|" if n == 1 else "|k|^2")
    if n == 2 or strip.alpha != (1,):
        yield "", "k: the integer combinations of %s; |k| = %s" % (" and ".join(
            "(%s)" % ", ".join(map(str, k)) for k in piece.basis), " + ".join(terms))


def undecided(problem: Problem, rotation: Optional[Rotation],
              reason: Union[NotFound, NotProved, TimeIsUp], by_hand: Sequence[str] = (),
              left: str = "") -> str:
    """The report without a theorem, and why there is none.

    by_hand: flags that took a choice from the program; left: about the torus that was found."""
    stated = _stated(problem)
    lines = ["UNDECIDED: nothing is proved.  There may be no %s%s (see converse)." % (
        TORUS[stated.map.dimension], "" if rotation is None else " with this %s" % VECTOR[
            rotation.dimension]), *map_lines(stated),
             *ended(indented(["was examined " + " ".join(conditions(stated))])), ""]
    entries = [("Time limit" if isinstance(reason, TimeIsUp) else
                "Not found" if isinstance(reason, NotFound) else "Not proved",
                plain(" ".join(str(reason).split())))]
    if left:
        entries.append(("Found", left))
    if by_hand:
        entries.append(("By hand", "%s; without such a flag the program chooses"
                        % ", ".join(by_hand)))
    for label, text in (*entries, *(_rotation_lines(rotation) if rotation else ()),
                        *_input_lines(problem)):
        lines += labelled(label, text)
    return "\n".join(lines) + "\n"


def _up(x: Union[float, Fraction], digits: int = 3) -> str:
    return rounded_text(x, digits, up=True)


def _down(x: Union[float, Fraction], digits: int = 3) -> str:
    return rounded_text(x, digits, up=False)
