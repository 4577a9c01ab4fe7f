"""The certificate of a torus (docs/reference/torus-certificate.md, "converse torus 1"): the map,
the rotation vector and the modes of the torus, exactly, which are the claim; and the norm and strip
in which it is verified.  The checker's parser is the only one."""

from dataclasses import replace
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .. import check
from ..model.exact import decimal_text
from ..model.potential import FourierSum
from ..storage import kept
from ..storage.files import Path
from ..version import __version__
from .rotation import Rotation, name_of
from .torus import Strip, Torus

FIRST_LINE = "converse torus 1"


class Certificate(NamedTuple):
    """The contents of a file.  They prove nothing until the file is checked.

    Attributes
    ----------
    tori
        The pieces, of one map and one rotation vector.
    sha256
        The SHA-256 of the file, uncompressed.
    """

    tori: Tuple[Torus, ...]
    sha256: str


def read(path: Path) -> Certificate:
    """The certificate in a file, compressed or not.

    Parameters
    ----------
    path : path

    Returns
    -------
    Certificate

    Raises
    ------
    ConverseError
        In one line: the file cannot be read, is not a certificate, or was changed or damaged.
    """
    claim = kept.read(path, "torus")
    return Certificate(tori_of(claim), claim.sha256)


def tori_of(claim: check.TorusClaim) -> Tuple[Torus, ...]:
    """The tori that a certificate claims to be near to invariant ones."""
    n = claim.dimension
    potential = FourierSum(tuple((*wave.k, wave.phase) for wave in claim.waves),
                           tuple(wave.middle for wave in claim.waves), n)
    part = None if claim.pieces[0].low == claim.pieces[0].high else tuple(
        wave.parts[0] for wave in claim.waves)
    rotation, tori = rotation_of(claim), []
    for piece, rho in zip(claim.pieces, claim.rho):
        rows = sorted(piece.modes.items())
        numbers = np.array([series for _, series in rows], object).reshape(
            len(rows), piece.degree + 1, n, 2)
        tori.append(Torus(
            potential, part, rotation, piece.bits,
            np.array([k for k, _ in rows], np.int64).reshape(-1, n), numbers.transpose(3, 1, 2, 0),
            Strip(claim.frame, claim.alpha, rho), (piece.low, piece.high)))
    return tuple(tori)


def rotation_of(claim: check.TorusClaim) -> Rotation:
    """The rotation vector of a certificate."""
    rotation = Rotation("", claim.polynomial, claim.root, claim.rotation)
    return replace(rotation, name=name_of(rotation))        # whatever a hint calls it


def text(tori: Sequence[Torus]) -> str:
    """The certificate of tori that cover a range, or of one torus.  ValueError: a strip is None."""
    first = tori[0]
    potential, rotation, strip = first.potential, first.rotation, first.strip
    if strip is None or any(torus.strip is None for torus in tori):
        raise ValueError("the torus has no strip in which it is to be verified")
    parts = [()] * len(potential.waves) if first.part is None else [(p,) for p in first.part]
    lines = [FIRST_LINE, "program: converse " + __version__, "dimension: %d" % first.dimension]
    lines += ["wave: %d %d %s" % wave + "".join(" " + decimal_text(x) for x in (p, *part))
              for wave, p, part in zip(potential.waves, potential.amplitude, parts)]
    lines += ["polynomial: " + _words(rotation.polynomial), "root: " + _words(rotation.root)]
    lines += ["rotation: " + _words(element) for element in rotation.vector]
    lines += ["frame: " + _words(x for row in strip.frame for x in row),
              "alpha: " + _words(strip.alpha),
              "rho: " + _words(torus.strip.rho for torus in tori if torus.strip),
              "pieces: %d" % len(tori), "tori:"]
    for torus in tori:
        lines += _piece(torus)
    return kept.sealed(lines)


def _words(numbers):
    return " ".join(map(str, numbers))


def _piece(torus) -> List[str]:
    """The lines of a torus; coefficients that are zero are left out."""
    found = []
    for k, series in zip(torus.k.tolist(), torus.numbers.transpose(3, 1, 2, 0).tolist()):
        for j, pairs in enumerate(series):
            numbers = [x for pair in pairs for x in pair]
            if any(numbers):
                found.append("%s %d %s" % (_words(k), j, " ".join(format(x, "x") for x in numbers)))
    low, high = torus.piece
    return ["piece %s %s %d %d %d" % (low, high, torus.bits, torus.degree, len(found)), *found]
