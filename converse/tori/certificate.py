"""The certificate of a proof (docs/format.md, "converse torus 1"): the map, the rotation vector and
the modes of the torus, exactly, which are the claim; and hints how it may be proved."""

import os
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Dict, NoReturn, Tuple, Union

from ..model.exact import DECIMAL, RATIO, decimal_text
from ..model.potential import FourierSum
from ..storage import files
from ..storage.files import ConverseError
from ..version import __version__
from .divisors import Norm
from .rotation import Rotation
from .torus import Part, Torus

if TYPE_CHECKING:
    from .proved import ProvedTorus

FIRST_LINE = "converse torus 1"
LONGEST_NUMBER = 2000                   # characters
INTEGER = re.compile("0|-?[1-9][0-9]{0,999}", re.ASCII)
HEXADECIMAL = re.compile("0|-?[1-9a-f][0-9a-f]*", re.ASCII)
HINT = "hint-"
FIELDS = "program", "comment", "dimension", "polynomial", "root", "frame", "alpha", "rho", "pieces"
Path = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Certificate:
    """What a file says.  It proves nothing until it is checked, or proved again.

    tori -- the pieces, of one map and one rotation vector
    norm, rho -- hints: the norm and the width of a proof
    hints -- others, by name
    sha256 -- of the file, uncompressed
    """

    tori: Tuple[Torus, ...]
    norm: Norm
    rho: Fraction
    hints: Dict[str, str]
    sha256: str


def write(proof: "ProvedTorus", path: Path) -> str:
    """ProvedTorus.save()."""
    return files.write_text(path, _text(proof))


def _text(proof):
    torus, worst = proof.torus, proof.worst
    potential, rotation, norm = torus.potential, torus.rotation, worst.norm
    parts = [()] * len(potential.waves) if torus.part is None else [(p,) for p in torus.part]
    lines = [FIRST_LINE, "program: converse " + __version__, "dimension: %d" % torus.dimension]
    lines += ["wave: %d %d %s" % wave + "".join(" " + decimal_text(x) for x in (p, *part))
              for wave, p, part in zip(potential.waves, potential.amplitude, parts)]
    lines += ["polynomial: " + _words(rotation.polynomial), "root: " + _words(rotation.root)]
    lines += ["rotation: " + _words(element) for element in rotation.vector]
    lines += ["frame: " + _words(x for row in norm.frame for x in row),
              "alpha: " + _words(norm.alpha), "rho: %s" % worst.rho]
    lines += ["hint-name: " + rotation.name] if rotation.name else []
    lines += ["hint-residual: %.6e" % worst.residual, "hint-needed: %.6e" % worst.needed,
              "hint-steps: %d" % worst.verdict.choice.steps,
              "hint-share: %s" % worst.verdict.choice.s, "hint-t: %s" % worst.verdict.choice.t,
              "pieces: %d" % len(proof.pieces), "tori:"]
    for piece in proof.pieces:
        lines += _piece(piece.torus)
    text = "\n".join(lines) + "\n"
    return text + "checksum: sha256 %s\nend\n" % files.sha256(text)


def _words(numbers):
    return " ".join(map(str, numbers))


def _piece(torus):
    """The lines of a torus; coefficients that are zero are left out."""
    lines = ["%s %d %s" % (_words(k), j, " ".join(format(x, "x") for x in numbers))
             for k, series in sorted(torus.modes.items())
             for j, numbers in enumerate(series) if any(numbers)]
    low, high = torus.piece
    return ["piece %s %s %d %d %d" % (low, high, torus.bits, torus.degree, len(lines)), *lines]


def read(path: Path) -> Certificate:
    """The certificate in a file, compressed or not.

    ConverseError, in one line: it cannot be read, is no certificate, or was changed or damaged."""
    text = files.read_text(path, "certificate",
                           ": the file is truncated or no certificate of this program")
    return _Reader(path, text).certificate()


class _Damaged(ValueError):
    """What is wrong with a line."""


class _Reader:
    def __init__(self, path, text):
        self.path, self.lines, self.at = path, text.split("\n"), 0
        self.sha256 = files.sha256(text)
        if self.lines[0] != FIRST_LINE:
            self.fail(1, "this is no certificate of a torus, version 1")
        if self.lines[-2:] != ["end", ""] or len(self.lines) < 4:
            self.fail(len(self.lines), "the file is truncated")
        body = "\n".join(self.lines[:-3]) + "\n"
        if self.lines[-3] != "checksum: sha256 " + files.sha256(body):
            self.fail(len(self.lines) - 2, "the file was changed or damaged (wrong checksum)")
        del self.lines[-3:]

    def fail(self, number: int, wrong: object) -> NoReturn:
        raise ConverseError("%s, line %d: %s; use an intact copy or prove it anew"
                            % (self.path, number, wrong)) from None

    def certificate(self) -> Certificate:
        try:
            header = self._header()
            n = _integer(header["dimension"])
            if n not in (1, 2):
                raise _Damaged("a dimension is 1 or 2")
            potential, part = _map(header["wave"], n)
            polynomial = tuple(map(_integer, header["polynomial"].split(" ")))
            if len(polynomial) != n + 2 or not polynomial[-1]:
                raise _Damaged("the polynomial is not of degree %d" % (n + 1))
            rotation = Rotation(
                header["hint-name"] if HINT + "name" in header else "", polynomial,
                _root(header["root"]),
                tuple(_numbers(line, n + 1) for line in header["rotation"]))
            if rotation.dimension != n:
                raise _Damaged("the rotation vector is not of the dimension %d" % n)
            frame = tuple(map(_integer, header["frame"].split(" ")))
            norm = Norm(tuple(frame[i:i + n] for i in range(0, len(frame), n)),
                        _numbers(header["alpha"], n))
            tori = tuple(self._torus(potential, part, rotation)
                         for _ in range(_integer(header["pieces"])))
            if self.at != len(self.lines):
                raise _Damaged("this is more than the header says")
            from .proved import check_cover
            check_cover(tori)
            hints = {name[len(HINT):]: value for name, value in header.items()
                     if name.startswith(HINT)}
            return Certificate(tori, norm, _number(header["rho"]), hints, self.sha256)
        except KeyError as error:
            self.fail(self.at, "the header has no field %s" % error)
        except (IndexError, ValueError) as error:
            self.fail(min(self.at + 1, len(self.lines)), error)

    def _next(self) -> str:
        if self.at == len(self.lines):
            raise _Damaged("there are fewer lines than the header says")
        self.at += 1
        return self.lines[self.at - 1]

    def _header(self):
        """The fields up to tori: by name; lists of the waves and the rotation's components."""
        found = {"wave": [], "rotation": []}
        self.at = 1
        while True:
            line = self._next()
            if line == "tori:":
                return found
            name, colon, value = line.partition(": ")
            if not colon:
                raise _Damaged("'%.40s' is not 'name: value'" % line)
            if name in ("wave", "rotation"):
                found[name].append(value)
            elif name not in FIELDS and not re.fullmatch("hint-[a-z0-9-]+", name, re.ASCII):
                raise _Damaged("there is no field %.40s" % name)
            elif name in found and name != "comment":
                raise _Damaged("the field %.40s stands twice" % name)
            else:
                found[name] = value

    def _torus(self, potential, part, rotation):
        word, *numbers = self._next().split(" ")
        if word != "piece" or len(numbers) != 5:
            raise _Damaged("this is not 'piece LOW HIGH BITS DEGREE MODES'")
        piece = _number(numbers[0]), _number(numbers[1])
        bits, degree, count = map(_integer, numbers[2:])
        if not (0 <= bits <= 10 ** 6 and 0 <= degree <= 10 ** 4):
            raise _Damaged("so many bits, or such a degree, are not possible")
        n = potential.dimension
        found = {}
        for _ in range(count):
            words = self._next().split(" ")
            if len(words) != n + 1 + 2 * n:
                raise _Damaged("this is no mode")
            *k, j = map(_integer, words[:n + 1])
            if not tuple(k) > (0,) * n or not 0 <= j <= degree:
                raise _Damaged("there is no such mode")
            series = found.setdefault(tuple(k), [(0,) * (2 * n)] * (degree + 1))
            if any(series[j]):
                raise _Damaged("the mode stands twice")
            series[j] = tuple(map(_hexadecimal, words[n + 1:]))
            if not any(series[j]):
                raise _Damaged("the coefficient is zero")
        return Torus(potential, part, rotation, bits,
                     {k: tuple(series) for k, series in found.items()}, piece)


def _map(waves, n) -> Tuple[FourierSum, Part]:
    rows = [line.split(" ") for line in waves]
    if not rows or len({len(row) for row in rows}) != 1 or len(rows[0]) not in (4, 5):
        raise _Damaged("the waves make no sense")
    potential = FourierSum(
        tuple((_integer(k0), _integer(k1), _number(phase)) for k0, k1, phase, *_ in rows),
        tuple(_number(row[3]) for row in rows), n)
    if (n == 1) == any(k1 for _, k1, _ in potential.waves):
        raise _Damaged("the waves are not of the dimension %d" % n)
    part = tuple(_number(row[4]) for row in rows) if len(rows[0]) == 5 else None
    return potential, part


def _integer(word: str) -> int:
    if not INTEGER.fullmatch(word):
        raise _Damaged("'%.40s' is no integer" % word)
    return int(word)


def _hexadecimal(word: str) -> int:
    if not HEXADECIMAL.fullmatch(word):
        raise _Damaged("'%.40s' is no hexadecimal integer" % word)
    return int(word, 16)


def _number(word: str) -> Fraction:
    if len(word) > LONGEST_NUMBER or not (DECIMAL.fullmatch(word) or RATIO.fullmatch(word)):
        raise _Damaged("'%.40s' is no decimal number and no ratio" % word)
    if "e" in word.lower() and abs(int(word.lower().partition("e")[2])) > 10000:
        raise _Damaged("'%.40s' is out of range" % word)
    return Fraction(word)


def _root(text: str) -> Tuple[Fraction, Fraction]:
    low, high = _numbers(text, 2)
    return low, high


def _numbers(text: str, count: int) -> Tuple[Fraction, ...]:
    words = text.split(" ")
    if len(words) != count:
        raise _Damaged("'%.60s' is not %d numbers" % (text, count))
    return tuple(map(_number, words))
