"""The claim of a proof file: waves, amplitudes, a region of the torus, x*; all of it exact."""

import math
import re
from dataclasses import dataclass, replace
from fractions import Fraction

from .arith import combined, determinant, dot
from .failures import NotConfirmed, Rejected
from .limits import MAX_CHARACTERS, MAX_K, MAX_SIZE

RANGES = ("a", "b", "c")                # of the thesis
ANGLES = ("v0", "v1", "v2")
AXES = "012345"                         # of cuts: v0, v1, then the parameters, and v2
ANGLE_AXES = 0, 1, 5
DECIMAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
NUMBER = re.compile(DECIMAL, re.ASCII)
RATIO = re.compile("[+-]?[0-9]+/0*[1-9][0-9]*|" + DECIMAL, re.ASCII)
THESIS = (1, 0), (0, 1), (1, 1)         # k of the three waves of the thesis
IDENTITY = 1, 0, 0, 1                   # frames
# v0 is the mean of the coordinates, and n v1, n v2 are the differences of neighbours.
DIAGONALS = {2: (1, 1, 1, -1), 3: (1, 2, 1, 1, -1, 1, 1, -1, -2)}
# A parameter's name; not one of these, which mean something else in a theorem: the last two in one
# about three angles.
NAME = re.compile(r"[^\W\d]\w{0,30}(\[[0-9]{1,9}\])?")
RESERVED = "y", "y0", "y1", "J", "J0", "J1", "V", "P", "S", "pi", "sin", "cos", "y2", "J2"
LETTERS = "abcdefghijklmnopqrstuvwxyz"  # of parts, and of leaves linked to them


@dataclass(frozen=True)
class Wave:
    """-p sin(k.y + pi phase), p = middle + sum of parts[m] t[m] for parameters -1 <= t[m] <= 1."""

    k: tuple
    phase: Fraction
    middle: Fraction
    parts: tuple

    def at(self, t):
        return self.middle + sum([g * x for g, x in zip(self.parts, t)])

    def over(self, cell):
        """p in the middle of a cell, and how far it goes from there."""
        t = [Fraction(2 * i + 1, 1 << k) - 1 for i, k in zip(cell[0][2:5], cell[1][2:5])]
        return self.at(t), sum([abs(g) / (1 << k) for g, k in zip(self.parts, cell[1][2:5])])


def present(waves):
    """The waves whose amplitude is not always zero."""
    return tuple(wave for wave in waves if wave.middle or any(wave.parts))


@dataclass(frozen=True)
class Claim:
    """The claim of a proof file, of one of its parts, or of a proved cell of a map: exact; v in
    units of pi."""

    waves: tuple
    centre: tuple                       # of each v
    half: tuple
    frame: tuple                        # integers, row by row: x[1] = frame v
    alone: object                       # the only coordinate that is looked at, or None
    xstar: tuple
    counts: dict
    at_once: str                        # does the claim cover larger multiples: yes, no, upper end
    tree: str
    sha256: str                         # of the file, uncompressed
    where: str = ""                     # of a part, or a cell of a map: which it is
    parts: tuple = ()                   # of a proof file: a, b, ..., each a Claim
    shifts: tuple = ()                  # of a part: what each parameter adds to each v, or none
    names: tuple = ()                   # of each parameter: name, value at t = -1 and at 1; or none
    header: object = None               # of a proof file: its fields; nothing rests on the others

    @property
    def rows(self):
        """The frame's rows."""
        n = len(self.half)
        return [self.frame[at:at + n] for at in range(0, len(self.frame), n)]

    @property
    def parameters(self):
        return len(self.waves[0].parts)

    @property
    def dimension(self):
        """The number of angles of the map of which the file is: step (C29)."""
        return len(self.rows) if any(any(wave.k[1:]) for wave in self.waves) else 1

    @property
    def moves(self):
        """How v changes along each axis of cells from the middle to the end: step (C26)."""
        n = len(self.half)
        none = (Fraction(0),) * n
        v0, v1, v2 = [tuple([h * (i == j) for j in range(n)])
                      for i, h in enumerate((*self.half, *none)[:3])]
        return v0, v1, *self.shifts, *[none] * (3 - len(self.shifts)), v2

    def box(self, cell):
        """For each v: the middle of a cell, and the change from there along its axes."""
        at = [Fraction(2 * i + 1, 1 << k) - 1 for i, k in zip(*cell)]
        return [(c + dot(at, along), [y / (1 << k) for y, k in zip(along, cell[1])])
                for c, along in zip(self.centre, zip(*self.moves))]

    @property
    def examined(self):
        """The waves that are examined: those that are present, or of these the ones of the factor
        that is alone.  If no wave has both coordinates the map is a product, and Q(n) for
        n = (n[0], 0) is the second variation of the first factor: it is the one of the map that has
        the first factor's waves alone, whose other coordinate moves freely and adds nothing
        negative to it.  So what excludes an orbit of that map for any n excludes it of this one."""
        return tuple(wave for wave in present(self.waves)
                     if self.alone is None or wave.k[self.alone])

    @property
    def reduced(self):
        """The claim with the waves that are examined alone; and, if their k are multiples m q of a
        vector, in the one angle q.x: step (C31)."""
        waves = self.examined
        q = [x // math.gcd(*waves[0].k) for x in waves[0].k] if waves else []
        if not all(x * b == y * a for wave in waves for x, a in zip(wave.k, q)
                   for y, b in zip(wave.k, q)) or not waves:
            return replace(self, waves=waves, alone=None)
        size = dot(q, q)
        return replace(self, waves=tuple([
            Wave((dot(q, wave.k) // size,), wave.phase, size * wave.middle,
                 tuple([size * part for part in wave.parts])) for wave in waves]), alone=None,
                       frame=tuple(combined(q, self.rows)), xstar=(dot(q, self.xstar),))


def number(text, name, form=NUMBER):
    """The exact number that the text is, within the checker's limits."""
    if len(text) > MAX_CHARACTERS:
        raise NotConfirmed("%s has more than %d characters, the checker's limit"
                           % (name, MAX_CHARACTERS))
    if not form.fullmatch(text):
        raise Rejected("%s is not a decimal number%s" % (name, " or ratio" * (form is RATIO)))
    value = Fraction(text)
    if abs(value) > MAX_SIZE:
        raise NotConfirmed("%s is out of range: the checker's limit is 1e300" % name)
    return value


def check_frame(words, name, n):
    """The frame: n rows of n integers (as text), of a determinant that is not 0."""
    if len(words) != n * n or not all(re.fullmatch("[+-]?[0-9]{1,3}", word, re.ASCII)
                                      for word in words):
        raise Rejected("%s is not %s integers" % (name, {2: "four", 3: "nine"}[n]))
    found = tuple(map(int, words))
    if max(map(abs, found)) > MAX_K:
        raise Rejected("%s has an entry beyond %d" % (name, MAX_K))
    if not determinant([found[at:at + n] for at in range(0, n * n, n)]):
        raise Rejected(name + " has determinant 0")
    return found


def check_alone(waves, alone):
    if alone is not None and any(sum(map(bool, wave.k)) > 1 for wave in present(waves)):
        raise Rejected("no coordinate is alone: a wave feels both")
