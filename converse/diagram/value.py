"""The value Diagram: what is proved of a family of maps, by its parameters, and its file."""

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple, Union

from .. import check
from ..check.claim import Wave
from ..model.exact import Ends, exact, is_decimal
from ..model.map import SymplecticMap
from ..storage.files import ConverseError, Path
from ..storage.kept import Kept, program_of, sealed
from ..storage.methods import provided
from ..version import __version__

if TYPE_CHECKING:
    from ..prover.proof import Proof
    from ..tori.proved import ProvedTorus
    from ..tori.rotation import Rotation

FIRST_LINE = "converse diagram 1"
POINTS_A_SECOND = 4 * 10 ** 6           # of orbits, about: what a second of the budget stands for
Value = Any                             # of one parameter; of two parameters, of each one
Box = Tuple[Ends, ...]                  # for each parameter (low, high)
Side = Tuple[Fraction, Tuple[Fraction, ...], Tuple[int, ...]]       # value, x in turns, n


class Existence(NamedTuple):
    """A proved torus, for one value or for each value of a range.

    Attributes
    ----------
    low, high
        The ends of the range, equal for a single value; with two parameters a pair each.
    rotation
        The rotation vector.
    certificate
        The text of the certificate of existence.
    """

    low: Value
    high: Value
    rotation: "Rotation"
    certificate: str


class Seen(NamedTuple):
    """A value at which a torus is seen; nothing is proved.

    Attributes
    ----------
    value
        A Fraction for each parameter.
    rotation
        About the rotation vector, in turns.
    """

    value: Tuple[Fraction, ...]
    rotation: Tuple[float, ...]


@dataclass(frozen=True)
class Member:
    """A proof, or a certificate of tori, over a part of the parameters.

    Attributes
    ----------
    text
        The proof file, or the certificate.
    box
        For each parameter the ends of the values that are proved; infinite ends are floats.
    larger
        Whether all multiples s >= 1 of the values in a box of two parameters are proved, also.
    rotation
        Of tori; None: a proof that there are none.
    """

    text: str
    box: Box
    larger: bool
    rotation: "Optional[Rotation]"


@dataclass(eq=False, repr=False)
class Diagram(Kept):
    """Where along one or two parameters there are proved to be no invariant tori, and where tori
    are proved.  Diagram.of makes an empty diagram of a family.

    Attributes
    ----------
    family
        The family.  Its first parameters are those that have a range, one or two, and are named;
        any others have one value, that of an amplitude which is not a finite decimal.
    members
        The proofs and the certificates, in the order in which they were found.
    sides
        By "above" and "below" the value of the parameter above which, or below which, one point x
        excludes all tori, with x and n (docs/proofs/argument.md).
    seen
        Values at which a torus is seen.
    search
        Lines of what the search must know to be continued; nothing rests on them.
    points
        The number of points of orbits that the search has computed.
    seconds
        The duration of the search.
    version
        The release of the program that did the work.
    sha256
        The SHA-256 of the file, uncompressed; "" if there is none.
    restored
        How many members were read from a file, and are believed.
    """

    KIND = "diagram"

    family: SymplecticMap
    members: List[Member] = field(default_factory=list)
    sides: Dict[str, Side] = field(default_factory=dict)
    seen: List[Seen] = field(default_factory=list)
    search: List[str] = field(default_factory=list)
    points: int = 0
    seconds: float = 0.0
    version: str = __version__
    sha256: str = ""
    restored: int = 0

    @classmethod
    def of(cls, family: SymplecticMap) -> "Diagram":
        """A diagram in which nothing is proved yet.

        Parameters
        ----------
        family
            A map with one or two parameters that have a range.

        Raises
        ------
        ValueError
            It has fewer or more, or they do not move the amplitudes independently.
        """
        if family.dimension > 2:
            raise ValueError("a diagram is of one angle or two; of three, prove a range with "
                             "converse")
        waves, names, ranges = [], [], []
        for name, (low, high) in zip(family.names or ["t%d" % m for m in range(
                1, 1 + len(family.slopes))], family.ranges):
            if low < high:
                names.append(name)
                ranges.append((low, high))
        if not 1 <= len(names) <= 2:
            raise ValueError("%s of the family ha%s a range, but a diagram has one parameter or two"
                             "; give one or two parameters a range (low, high), low < high" % (
                                 "no parameter" if not names else "%d parameters" % len(names),
                                 "ve" if names else "s"))
        fixed = [(low, slopes) for (low, high), slopes in zip(family.ranges, family.slopes)
                 if low == high]
        moving = [slopes for (low, high), slopes in zip(family.ranges, family.slopes) if low < high]
        for j, (k0, k1, phase) in enumerate(family.harmonics):
            amplitude = family.amplitude[j] + sum(value * slopes[j] for value, slopes in fixed)
            waves.append(Wave((k0, k1), phase, amplitude, tuple(slopes[j] for slopes in moving)))
        return cls._of_waves(waves, names, ranges, family.name)

    @classmethod
    def _of_waves(cls, waves, names, ranges, name=""):
        """The diagram of check.Waves.  An amplitude that is not a finite decimal becomes a
        parameter with one value, which proofs enclose."""
        if check.solution([list(column) for column in zip(*[wave.parts for wave in waves])],
                          [0] * len(waves)) is None:
            raise ValueError("the parameters %s do not move the amplitudes independently; leave "
                             "out a parameter" % " and ".join(names) if len(names) > 1 else
                             "no amplitude depends on the parameter %s; give another one a range"
                             % names[0])
        pins = [j for j, wave in enumerate(waves) if not is_decimal(wave.middle)]
        slopes = [list(column) for column in zip(*[wave.parts for wave in waves])] + [
            [int(j == pin) for j in range(len(waves))] for pin in pins]
        return cls(SymplecticMap(
            [(*wave.k, wave.phase) for wave in waves],
            [0 if j in pins else wave.middle for j, wave in enumerate(waves)], slopes,
            [*ranges, *[(waves[j].middle, waves[j].middle) for j in pins]],
            [*names, *["amplitude[%d]" % (j + 1) for j in pins]], name))

    # ---- the parameters

    @property
    def ranges(self) -> Box:
        """The range of each parameter."""
        return tuple(ends for ends in self.family.ranges if ends[0] < ends[1])

    @property
    def names(self) -> Tuple[str, ...]:
        """The name of each parameter."""
        return self.family.names[:len(self.ranges)]

    def over(self, box: Box) -> SymplecticMap:
        """The part of the family over a box of its parameters.

        Parameters
        ----------
        box
            For each parameter (low, high); equal for a single value.
        """
        return self.family.at(**dict(zip(self.names, box)))

    @property
    def waves(self) -> Tuple[Wave, ...]:
        """The waves of the family, as the checker has them: `middle` is the amplitude where all
        parameters are 0, and `parts` are the slopes."""
        count, family = len(self.ranges), self.family
        fixed = [sum(ends[0] * slopes[j] for ends, slopes in zip(
            family.ranges[count:], family.slopes[count:])) for j in range(len(family.harmonics))]
        return tuple(Wave((k0, k1), phase, family.amplitude[j] + fixed[j],
                          tuple(slopes[j] for slopes in family.slopes[:count]))
                     for j, (k0, k1, phase) in enumerate(family.harmonics))

    # ---- what is proved

    def add(self, found: "Union[Proof, ProvedTorus]") -> Member:
        """Adds a proof, or proved tori, of a part of the family.

        Parameters
        ----------
        found
            A Proof that is a theorem, or a ProvedTorus.

        Returns
        -------
        Member
            What was added.

        Raises
        ------
        ValueError
            The member proves nothing, or is about another family.
        ConverseError
            The member contradicts a proof of the diagram, which is an error of the program.
        """
        text = found._text()
        try:
            member = _member(check.Family(self.waves, self.names).member(text.encode()))
        except check.Failure as error:
            raise ValueError("this is not a proof of the family: %s" % error) from None
        if any((other.rotation is None) != (member.rotation is None)
               and check.overlap(other.box, member.box) for other in self.members):
            raise ConverseError("for %s there are a torus and a proof that there is none; this is "
                                "an error of the program" % check.box_words(self.names, member.box))
        self.members.append(member)
        return member

    @property
    def proofs(self) -> "List[Proof]":
        """The proofs that there are no tori."""
        from ..prover.proof_file import proof_of
        return [proof_of(check.content(member.text.encode())) for member in self.members
                if member.rotation is None]

    @property
    def boxes(self) -> List[Box]:
        """The boxes without invariant tori, in order; with one parameter their union."""
        boxes = [member.box for member in self.members if member.rotation is None]
        if len(self.ranges) > 1:
            return sorted(boxes)
        ranges: List[Any] = [(value, math.inf) if side == "above" else (-math.inf, value)
                             for side, (value, *_) in self.sides.items()]
        return [(ends,) for ends in check.union(ranges + [ends for ends, in boxes])]

    @property
    def none(self) -> List[Tuple[Value, Value]]:
        """Where there are no invariant tori: (low, high), in order, with math.inf where all larger
        values are proved; with two parameters a box for each proof, its corners."""
        return [_corners(box) for box in self.boxes]

    @property
    def tori(self) -> List[Existence]:
        """Where tori are proved, in order."""
        found = []
        for member in self.members:
            if member.rotation is not None:
                low, high = _corners(member.box)
                found.append(Existence(low, high, member.rotation, member.text))
        return sorted(found, key=lambda each: each[:2])

    @property
    def open(self) -> List[Tuple[Value, Value]]:
        """The parts of the range where nothing is proved: (low, high), in order; with two
        parameters boxes, their corners."""
        boxes = [member.box for member in self.members]
        if len(self.ranges) > 1:
            return [_corners(box) for box in _uncovered(self.ranges, boxes)]
        return _gaps(self.ranges[0], self.none + [ends for ends, in boxes])

    # ---- what is said

    def sentence(self, member: Member) -> str:
        """A line about a proof or a certificate.

        Parameters
        ----------
        member
            One of `members`.
        """
        return "%s: %s" % (check.box_words(self.names, member.box), "no torus" if
                           member.rotation is None else "a torus, rotation %s" % member.rotation)

    def report(self, file: Optional[Path] = None) -> str:
        """The theorem and the statistics of the search, in lines.

        Parameters
        ----------
        file
            The name of the diagram's file, for the line that says how to verify it.
        """
        from .report import report
        return report(self, file)

    def plot(self, ax: Any = None) -> Any:
        """Draws the diagram: along the parameter, or in the plane of two parameters.

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned.  With None a Figure is returned,
            which a notebook shows.

        Raises
        ------
        ConverseError
            matplotlib is missing.
        """
        return provided("Diagram.plot")(self, None, ax)

    def to_dict(self) -> Dict[str, Any]:
        """The results as plain data, for JSON: numbers are texts, exact; "inf" is infinity."""
        def ends(low, high):
            return [list(map(str, x)) if isinstance(x, tuple) else str(x) for x in (low, high)]

        return {"parameters": {name: ends(*each) for name, each in zip(self.names, self.ranges)},
                "none": [ends(*each) for each in self.none],
                "tori": [{"range": ends(*each[:2]), "rotation": each.rotation.text()}
                         for each in self.tori],
                "open": [ends(*each) for each in self.open],
                "seen": [{"value": list(map(str, each.value)), "rotation": list(each.rotation)}
                         for each in self.seen],
                "points": self.points, "seconds": self.seconds}

    def __repr__(self):
        tori = sum(member.rotation is not None for member in self.members)
        return "<Diagram of %s: %d proofs of no torus, %d of tori>" % (
            self.family, len(self.members) - tori, tori)

    # ---- the file

    def _text(self) -> str:
        lines = [FIRST_LINE, "program: converse " + self.version]
        lines += ["wave: %d %d %s %s" % (*wave.k, wave.phase, " ".join(
            map(check.exact_text, (wave.middle, *wave.parts)))) for wave in self.waves]
        lines += ["parameter: %s %s %s" % (name, *map(check.exact_text, ends))
                  for name, ends in zip(self.names, self.ranges)]
        lines += ["%s: %s" % (side, " ".join(map(check.exact_text, (value, *x, *n))))
                  for side, (value, x, n) in sorted(self.sides.items())]
        lines += ["seen: " + " ".join([*map(str, each.value), *map(repr, each.rotation)])
                  for each in self.seen]
        lines += ["search: " + line for line in self.search]
        lines += ["points: %d" % self.points, "seconds: %.2f" % self.seconds, "members:"]
        return sealed([*lines, *[member.text[:-1] for member in self.members]])

    @classmethod
    def _of(cls, content: Any) -> "Diagram":
        header = content.header
        made = cls._of_waves(content.family.waves, content.family.names, content.ranges)
        made.members = [_member(member) for member in content.members]
        made.sides = {side: (value, x, n) for side, value, x, n in content.sides}
        made.search = header.get("search", [])
        made.points, made.seconds = int(header["points"]), float(header["seconds"])
        count = len(made.ranges)
        made.seen = [Seen(tuple(map(exact, words[:count])), tuple(map(float, words[count:])))
                     for words in map(str.split, header.get("seen", []))]
        made.version, made.sha256 = program_of(header), content.sha256
        made.restored = len(made.members)
        return made


def _member(member):
    """The statement of a check.Member, without the contents of its certificate."""
    rotation = None
    if isinstance(member.claim, check.TorusClaim):
        from ..tori.certificate import rotation_of
        rotation = rotation_of(member.claim)
    return Member(member.text.decode(), member.box, member.larger, rotation)


def _corners(box):
    """(low, high) of a box."""
    low, high = zip(*box)
    return (low[0], high[0]) if len(box) == 1 else (low, high)


def _gaps(whole, ranges):
    """The intervals of the range `whole` that none of the ranges, each (low, high), holds."""
    found, at = [], whole[0]
    for low, high in check.union(ranges):
        if at < min(low, whole[1]):
            found.append((at, min(low, whole[1])))
        at = max(at, high)
    return found + [(at, whole[1])] * (at < whole[1])


def _uncovered(whole, boxes):
    """Boxes, wide ones along the first parameter, of what no box of two parameters holds."""
    first, second = whole
    cuts = sorted({x for box in [whole, *boxes] for x in box[0] if first[0] <= x <= first[1]})
    found: List[Box] = []
    for low, high in zip(cuts, cuts[1:]):
        for gap in _gaps(second, [box[1] for box in boxes if box[0][0] <= low and
                                  high <= box[0][1]]):
            before = next((box for box in found if box == ((box[0][0], low), gap)), None)
            if before:
                found.remove(before)
            found.append(((before[0][0] if before else low, high), gap))
    return found
