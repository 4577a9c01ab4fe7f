"""Reading a certificate of existence: what it claims, exact; docs/reference/torus-certificate.md
describes it."""

import io
import re
from dataclasses import dataclass
from fractions import Fraction

from .claim import RATIO, number, present
from .container import Format
from .failures import NotConfirmed, Rejected
from .limits import MAX_BITS, MAX_K, MAX_PIECES
from .proof_file import parse_waves

MAX_MODES = 1 << 21                     # of a torus
MAX_MODE = 1 << 21                      # |k0| and |k1| of a mode
MAX_ALPHA = 1000                        # of the weights of modes
TORUS_FIELDS = {"program", "dimension", "wave", "polynomial", "root", "rotation", "frame", "alpha",
                "rho", "pieces"}
INTEGER = re.compile("0|-?[1-9][0-9]*", re.ASCII)
COUNT = re.compile("0|[1-9][0-9]{0,8}", re.ASCII)
HEXADECIMAL = re.compile("0|-?[1-9a-f][0-9a-f]*", re.ASCII)


@dataclass(frozen=True)
class Piece:
    """low <= s <= high; modes: of each k the coefficients u_kj in units of 2^-bits, a tuple over j
    = 0 .. degree of tuples over the components of (re, im)."""

    low: Fraction
    high: Fraction
    bits: int
    degree: int
    modes: dict


@dataclass(frozen=True)
class TorusClaim:
    """The claim of a certificate of existence, and the norms in which it is to be verified.

    Attributes
    ----------
    dimension
        The number of angles.
    waves
        The waves of the potential, affine in at most one parameter, and not 0.
    polynomial, root
        The coefficients, and (low, high), which isolates the root t.
    rotation
        Of each component the coordinates in 1, t, t^2.
    frame, alpha
        The rows and the weights of |k|.
    rho
        Of each piece the width of the strip.
    pieces
        The tori, each a Piece.
    sha256
        The SHA-256 of the file, uncompressed.
    """

    dimension: int
    waves: tuple
    polynomial: tuple
    root: tuple
    rotation: tuple
    frame: tuple
    alpha: tuple
    rho: tuple
    pieces: tuple
    sha256: str


def lines_of(data):
    """The lines, one after the other: a list of all would take many times their space."""
    for line in io.BytesIO(data):
        yield line.decode("utf-8", "replace").rstrip("\n")


def rationals(text, count, name):
    """Reads `count` numbers that single spaces separate."""
    words = text.split(" ", count)
    if len(words) != count:
        raise Rejected("%s is not %d numbers" % (name, count))
    return tuple([number(word, name, RATIO) for word in words])


def integers(text, count, name, most):
    words = text.split(" ", count)
    if len(words) != count or not all(map(INTEGER.fullmatch, words)):
        raise Rejected("%s is not %d integers" % (name, count))
    if max(map(len, words)) > len(str(most)) + 1 or max(abs(int(x)) for x in words) > most:
        raise NotConfirmed("%s is beyond the checker's limit, %d" % (name, most))
    return tuple(map(int, words))


def read_torus(file):
    """The claim of a container."""
    header = file.header
    if header["dimension"] not in ("1", "2"):
        raise Rejected("the header's dimension is neither 1 nor 2")
    n = int(header["dimension"])
    waves = parse_waves(header["wave"], RATIO)
    if len(waves[0].parts) > 1:
        raise Rejected("the waves have more than one part")
    parameter = bool(waves[0].parts)
    waves = present(waves)
    if n == 1 and any(wave.k[1] for wave in waves):
        raise Rejected("the dimension is 1, but a wave depends on the second angle")
    if n == 2 and not any(wave.k[1] for wave in waves):
        raise Rejected("the dimension is 2, but no wave depends on the second angle")
    polynomial = integers(header["polynomial"], n + 2, "the header's polynomial", 10 ** 60)
    if not polynomial[-1]:
        raise Rejected("the header's polynomial has not the degree %d" % (n + 1))
    if len(header["rotation"]) != n:
        raise Rejected("the header has not %d lines of the rotation" % n)
    rotation = tuple([rationals(text, n + 1, "the header's rotation")
                      for text in header["rotation"]])
    frame, alpha = parse_norm(header, n)
    if not COUNT.fullmatch(header["pieces"]) or header["pieces"] == "0":
        raise Rejected("the header's pieces are not a count")
    if int(header["pieces"]) > MAX_PIECES:
        raise NotConfirmed("there are more than %d pieces, the checker's limit" % MAX_PIECES)
    rho = rationals(header["rho"], int(header["pieces"]), "the header's rho")
    if min(rho) <= 0:
        raise Rejected("the header's rho is not positive")
    lines, pieces = enumerate(lines_of(file.body), file.line), []
    for _ in range(int(header["pieces"])):
        pieces.append(read_piece(lines, n, parameter, pieces[-1].high if pieces else None))
    for at, _ in lines:
        raise Rejected("line %d is more than the header's number of pieces" % at)
    if parameter and pieces[-1].high != 1 or not parameter and len(pieces) > 1:
        raise Rejected("the pieces do not tile the range of the parameter")
    return TorusClaim(n, waves, polynomial, rationals(header["root"], 2, "the header's root"),
                      rotation, frame, alpha, rho, tuple(pieces), file.sha256)


def parse_norm(header, n):
    """(frame, alpha) of a header."""
    numbers = integers(header["frame"], n * n, "the header's frame", MAX_K)
    frame = tuple([numbers[at:at + n] for at in range(0, n * n, n)])
    if numbers[0] * numbers[-1] == (numbers[1] * numbers[2] if n == 2 else 0):
        raise Rejected("the header's frame has the determinant 0")
    alpha = rationals(header["alpha"], n, "the header's alpha")
    if min(alpha) <= 0:
        raise Rejected("the header's alpha is not positive")
    if max(x.denominator for x in alpha) > MAX_ALPHA or max(alpha) > MAX_ALPHA:
        raise NotConfirmed("the header's alpha is beyond the checker's limit, %d" % MAX_ALPHA)
    return frame, alpha


def read_piece(lines, n, parameter, before):
    """The next piece, which begins where the one before ends."""
    at, line = next(lines, (0, ""))
    words = line.split(" ", 6)
    if len(words) != 6 or words[0] != "piece" or not all(map(COUNT.fullmatch, words[3:])):
        raise Rejected("line %d is not piece LOW HIGH BITS DEGREE MODES" % at if at else
                       "there are fewer pieces than the header says")
    low, high = [number(word, "line %d" % at, RATIO) for word in words[1:3]]
    bits, degree, count = map(int, words[3:])
    if bits > MAX_BITS or degree > MAX_K or count > MAX_MODES:
        raise NotConfirmed("line %d is beyond the checker's limits: %d bits, degree %d, %d modes"
                           % (at, MAX_BITS, MAX_K, MAX_MODES))
    if parameter and (low != (-1 if before is None else before) or not low < high <= 1) \
            or not parameter and (low or high or degree):
        raise Rejected("line %d: the pieces do not tile the range of the parameter" % at)
    modes = {}
    for _ in range(count):
        at, line = next(lines, (0, ""))
        words = line.split(" ", 3 * n + 2)
        if len(words) != 3 * n + 1 or not all(map(INTEGER.fullmatch, words[:n])) \
                or not COUNT.fullmatch(words[n]) \
                or not all(map(HEXADECIMAL.fullmatch, words[n + 1:])):
            raise Rejected("line %d is not a mode" % at if at else
                           "there are fewer modes than the piece says")
        if max(map(len, words[:n])) > 9 or max(abs(int(x)) for x in words[:n]) > MAX_MODE \
                or max(map(len, words)) > MAX_BITS // 2:
            raise NotConfirmed("line %d is beyond the checker's limits" % at)
        k, j = tuple(map(int, words[:n])), int(words[n])
        if k <= (0,) * n:
            raise Rejected("line %d: k is not positive (the first component that is not zero)" % at)
        if j > degree:
            raise Rejected("line %d: the power of s is beyond the degree" % at)
        values = [int(word, 16) for word in words[n + 1:]]
        entry = modes.setdefault(k, {})
        if j in entry:
            raise Rejected("line %d: the mode was there before" % at)
        entry[j] = tuple(zip(values[::2], values[1::2]))
    if len(modes) * (degree + 1) > MAX_MODES:
        raise NotConfirmed("a piece has more than %d coefficients, the checker's limit" % MAX_MODES)
    zero = ((0, 0),) * n
    return Piece(low, high, bits, degree, {
        k: tuple([entry.get(j, zero) for j in range(degree + 1)]) for k, entry in modes.items()})


TORUS = Format("torus", "1", "certificate", "tori", TORUS_FIELDS, {"comment"}, read_torus)
