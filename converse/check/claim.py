"""The claim of a proof file: waves, amplitudes, a region of the torus, x*; all of it exact."""

import re
from dataclasses import dataclass
from fractions import Fraction

from .failures import NotConfirmed, Rejected
from .limits import MAX_CHARACTERS, MAX_K, MAX_SIZE

RANGES = ("a", "b", "c")                # of the thesis
ANGLES = ("v0", "v1")
AXES = "01234"                          # of cuts: v0, v1, then the parameters
DECIMAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
NUMBER = re.compile(DECIMAL, re.ASCII)
RATIO = re.compile("[+-]?[0-9]+/0*[1-9][0-9]*|" + DECIMAL, re.ASCII)
THESIS = (1, 0), (0, 1), (1, 1)         # k of the three waves of the thesis
IDENTITY, DIAGONALS = (1, 0, 0, 1), (1, 1, 1, -1)        # frames
# A parameter's name; not one of these, which mean something else in a theorem.
NAME = re.compile(r"[^\W\d]\w{0,30}(\[[0-9]{1,9}\])?")
RESERVED = {"y", "y0", "y1", "J", "J0", "J1", "V", "P", "S", "pi", "sin", "cos"}
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
        t = [Fraction(2 * i + 1, 1 << k) - 1 for i, k in zip(cell[0][2:], cell[1][2:])]
        return self.at(t), sum([abs(g) / (1 << k) for g, k in zip(self.parts, cell[1][2:])])


def present(waves):
    """The waves whose amplitude is not always zero."""
    return tuple(wave for wave in waves if wave.middle or any(wave.parts))


@dataclass(frozen=True)
class Claim:
    """The claim of a proof file, of one of its parts, or of a proved cell of a map: exact; v0 and
    v1 in units of pi."""

    waves: tuple
    centre: tuple                       # of v0 and v1
    half: tuple
    frame: tuple                        # x[1] = (frame[0] v0 + frame[1] v1, the same with 2 and 3)
    alone: object                       # the only coordinate that is looked at, or None
    xstar: tuple
    counts: dict
    at_once: str                        # does the claim cover larger multiples: yes, no, upper end
    tree: str
    sha256: str                         # of the file, uncompressed
    where: str = ""                     # of a part, or a cell of a map: which it is
    parts: tuple = ()                   # of a proof file: a, b, ..., each a Claim
    shifts: tuple = ()                  # of a part: what each parameter adds to v0 and v1, or none
    names: tuple = ()                   # of each parameter: name, value at t = -1 and at 1; or none
    header: object = None               # of a proof file: its fields; nothing rests on the others

    @property
    def parameters(self):
        return len(self.waves[0].parts)

    @property
    def dimension(self):
        """The number of angles of the map of which the file is: step (C29)."""
        return 2 if any(wave.k[1] for wave in self.waves) else 1

    @property
    def moves(self):
        """How (v0, v1) change along each axis of cells from the middle to the end: step (C26)."""
        none, (h0, h1) = Fraction(0), self.half
        return (h0, none), (none, h1), *self.shifts, *[(none, none)] * (3 - len(self.shifts))

    def box(self, cell):
        """For v0 and v1 each: the middle of a cell, and the change from there along its axes."""
        at = [Fraction(2 * i + 1, 1 << k) - 1 for i, k in zip(*cell)]
        return [(c + sum([x * y for x, y in zip(at, along)]),
                 [y / (1 << k) for y, k in zip(along, cell[1])])
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


def check_frame(words, name):
    """The frame: four integers (as text), of a determinant that is not 0."""
    if len(words) != 4 or not all(re.fullmatch("[+-]?[0-9]{1,3}", word, re.ASCII)
                                  for word in words):
        raise Rejected(name + " is not four integers")
    a, b, c, d = frame = tuple(map(int, words))
    if max(map(abs, frame)) > MAX_K:
        raise Rejected("%s has an entry beyond %d" % (name, MAX_K))
    if a * d == b * c:
        raise Rejected(name + " has determinant 0")
    return frame


def check_alone(waves, alone):
    if alone is not None and any(all(wave.k) for wave in present(waves)):
        raise Rejected("no coordinate is alone: a wave feels both")
