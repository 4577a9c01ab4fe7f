"""Diagrams: for which values of one or two parameters a family of maps has no invariant graph, and
for which it has one.

The amplitudes of the family are affine in its parameters K.  A member of the file is a whole proof
file or a whole certificate of existence, with amplitudes that are affine in its own t, -1 <= t <=
1; step (C29) says of which K it speaks.  Step (C30) excludes all K above a value, or below it.
"""

import math
import re
from dataclasses import dataclass, replace
from fractions import Fraction

from .arith import SINE_ERROR, fixed_of
from .claim import RATIO, Claim, number, present
from .container import Format, read_container
from .cover import symmetries_used
from .failures import NotConfirmed, Rejected, named
from .limits import MAX_K
from .proof_file import PROOF, parse_waves
from .torus_file import TORUS, TorusClaim, integers, rationals
from .tree import check_tree, coefficients
from .words import GRAPH, exact_text, map_lines

MAX_MEMBERS = 1 << 14
SIDES = "above", "below"
MEMBER_END = re.compile(b"\nchecksum: sha256 [0-9a-f]{64}\nend\n")
PARAMETER = re.compile(r"[^\W\d]\w{0,30}(\[[0-9]{1,3}\])?")      # of a parameter
SIDE_BITS = 256                              # of the sines of step (C30)
DECIMALS = 12                             # of ends of ranges that are rounded, and of rotations


@dataclass(frozen=True)
class Member:
    """A proof file or a certificate of the file.

    Attributes
    ----------
    claim
        A Claim or a TorusClaim.
    box
        For each parameter of the family (low, high), the values of which it speaks: Fractions, or
        an infinity of floats where it covers all larger multiples.
    larger
        Does it also cover all multiples s >= 1 of the values of the box?  It is said of families
        of two parameters; the box of one parameter holds them.
    text
        The bytes.
    """

    claim: object
    box: tuple
    larger: bool
    text: bytes


@dataclass(frozen=True)
class Family:
    """A family of maps: the waves, whose `middle` is the amplitude where all parameters are 0 and
    whose `parts` are the slopes, and the names of the parameters."""

    waves: tuple
    names: tuple

    @property
    def angles(self):
        """The number of angles."""
        return 2 if any(wave.k[1] for wave in self.waves) else 1

    @property
    def scales(self):
        """Is each multiple of a map of the family the map of the same multiple of K?"""
        return not any(wave.middle for wave in self.waves)

    def values(self, waves):
        """Of which K a member with these waves speaks: step (C29).

        Parameters
        ----------
        waves
            Of the member, each a Wave.

        Returns
        -------
        box, ends : tuple
            For each parameter (low, high); and, if the member has one parameter, K at t = 1.

        Raises
        ------
        Rejected
            Some of its maps are not of the family, or its values are not a box.
        """
        mine, others = coefficients(self.waves), coefficients(waves)
        keys = [*{**mine, **others}]

        def columns(known, count):
            return [[known.get(key, [0] * count)[m] for key in keys] for m in range(count)]

        start, *slopes = columns(mine, 1 + len(self.names))
        middle, *parts = columns(others, 1 + len(waves[0].parts if waves else ()))
        moves, still = [], []
        for part in parts:
            move = solution(slopes, part)
            (still if move is None else moves).append(part if move is None else move)
        found = solution([*slopes, *[[-x for x in part] for part in still]],
                         [x - y for x, y in zip(middle, start)])
        if found is None or any(abs(t) > 1 for t in found[len(slopes):]):
            raise Rejected("its maps are not of the family")
        if any(sum(map(bool, move)) > 1 for move in moves):
            raise Rejected("its values are not a box of the parameters")
        centre = found[:len(slopes)]
        half = [sum(map(abs, column)) for column in zip(*moves)] or [Fraction(0)] * len(centre)
        end = [c + x for c, x in zip(centre, moves[0])] if len(parts) == len(moves) == 1 else None
        return tuple([(c - h, c + h) for c, h in zip(centre, half)]), end

    def member(self, text):
        """A member from its bytes.  Nothing is verified but which values it speaks of.

        Parameters
        ----------
        text
            A whole proof file or certificate.

        Returns
        -------
        Member

        Raises
        ------
        Rejected, NotConfirmed, Unusable
            It cannot be read, is not of the family, is not finished, or speaks of a part of the
            torus only.
        """
        claim = read_container(text, PROOF, TORUS)
        if isinstance(claim, TorusClaim):
            box, _ = self.values(claim.waves)
            if claim.dimension != self.angles:
                raise Rejected("the torus has another number of angles than the family")
            return Member(claim, box, False, text)
        check_tree(claim)
        if symmetries_used(claim) is None:
            raise Rejected("it is of a part of the torus only")
        box, end = self.values(claim.waves)
        larger = self.scales and (claim.at_once == "yes"
                                  or claim.at_once == "upper end" and end is not None)
        if larger and len(box) == 1:
            (low, high), = box
            end, = end if claim.at_once == "upper end" else [low if low > 0 else high]
            box, larger = ((low if end >= 0 else -math.inf, math.inf if end > 0 else high),), False
        return Member(claim, box, larger and claim.at_once == "yes", text)

    def check_side(self, side, value, x, n):
        """NotConfirmed, unless no K >= value (above), or K <= value (below), has an invariant
        graph, by step (C30) at the point x (in turns) with the integers n."""
        fixed, sign = fixed_of(SIDE_BITS), 1 if side == "above" else -1
        least, growth = Fraction(2 * sum([i * i for i in n])), Fraction(0)
        for wave in self.waves:
            weight = sum([i * k for i, k in zip(n, wave.k)]) ** 2
            angle = 2 * sum([k * y for k, y in zip(wave.k, x)]) + wave.phase
            sine, error = Fraction(fixed.sincos(fixed.angle(angle))[0], fixed.one), \
                Fraction(SINE_ERROR, fixed.one)
            slope, = wave.parts
            least -= weight * (wave.at((value,)) * sine - abs(wave.at((value,))) * error)
            growth -= weight * (sign * slope * sine - abs(slope) * error)
        if least >= 0 or growth > 0:    # strictly, so that n is not 0
            raise NotConfirmed("it is not confirmed that no graph exists %s %s" % (
                side, exact_text(value)))


def solution(columns, right):
    """The only x for which the sum of x[j] columns[j] is `right`; None, if there is no such x or
    more than one."""
    rows = [list(row) for row in zip(*columns, right)]
    for j in range(len(columns)):
        at = next((i for i in range(j, len(rows)) if rows[i][j]), None)
        if at is None:
            return None
        rows[j], rows[at] = rows[at], rows[j]
        rows[j] = [Fraction(x) / rows[j][j] for x in rows[j]]
        rows = [row if i == j else [x - row[j] * y for x, y in zip(row, rows[j])]
                for i, row in enumerate(rows)]
    return None if any(row[-1] for row in rows[len(columns):]) else [
        row[-1] for row in rows[:len(columns)]]


def union(ranges):
    """The union of closed intervals (low, high), as a list in their order."""
    found = []
    for low, high in sorted(ranges):
        if found and low <= found[-1][1]:
            found[-1] = found[-1][0], max(high, found[-1][1])
        else:
            found.append((low, high))
    return found


def overlap(box, other):
    """Do two boxes have a point in common?"""
    return all(low <= high1 and low1 <= high for (low, high), (low1, high1) in zip(box, other))


@dataclass(frozen=True)
class Diagram:
    """The content of a diagram; exact.

    Attributes
    ----------
    family
        A Family.
    ranges
        For each parameter the (low, high) that was searched.
    members
        In their order.
    sides
        (side, value, x, n) for all K above a value, or below it, that are excluded at a point x.
    header
        The lists of values of the header by field; nothing rests on the rest of it.
    sha256
        The SHA-256 of the file, uncompressed.
    """

    family: Family
    ranges: tuple
    members: tuple
    sides: tuple
    header: dict
    sha256: str

    @property
    def proofs(self):
        """The members that are proofs that there are no invariant graphs."""
        return [member for member in self.members if isinstance(member.claim, Claim)]

    @property
    def tori(self):
        """The members that are certificates of existence."""
        return [member for member in self.members if not isinstance(member.claim, Claim)]

    @property
    def none(self):
        """The boxes without invariant graphs; of one parameter their union."""
        boxes = [member.box for member in self.proofs] + [
            ((value, math.inf) if side == "above" else (-math.inf, value),)
            for side, value, _, _ in self.sides]
        return boxes if len(self.ranges) > 1 else [(range,) for range in
                                                   union([box for box, in boxes])]


def read_diagram(file):
    """The diagram of a container."""
    header = file.header
    names, ranges = zip(*map(parse_parameter, header["parameter"]))
    family = Family(parse_waves(header["wave"], RATIO), names)
    if not 1 <= len(names) <= 2 or len(set(names)) != len(names) \
            or len(family.waves[0].parts) != len(names):
        raise Rejected("there are not one or two parameters, each with a name and a slope")
    if solution(*[[[wave.parts[m] for wave in family.waves] for m in range(len(names))],
                  [0] * len(family.waves)]) is None:
        raise Rejected("the parameters do not move the amplitudes independently")
    members, start, body = [], 0, bytes(file.body)
    for found in MEMBER_END.finditer(body):
        if len(members) == MAX_MEMBERS:
            raise NotConfirmed("there are more members than the checker's limit, %d" % MAX_MEMBERS)
        with named("member %d" % (1 + len(members))):
            members.append(family.member(body[start:found.end()]))
        start = found.end()
    if start < len(body):
        raise Rejected("the last member is not whole")
    diagram = Diagram(family, ranges, tuple(members), tuple([
        parse_side(side, header[side], family) for side in SIDES if side in header]), header,
        file.sha256)
    check_members(diagram)
    return diagram


DIAGRAM = Format("diagram", "1", "diagram", "members",
                 {"wave", "parameter", "program", "points", "seconds"},
                 {*SIDES, "seen", "search", "comment"}, read_diagram)


def parse_parameter(line):
    """(name, (low, high)) of a line: a name and two numbers."""
    words = line.split(" ", 3)
    if len(words) != 3 or not PARAMETER.fullmatch(words[0]):
        raise Rejected("the header's parameter is not NAME LOW HIGH")
    low, high = [number(word, "the header's parameter", RATIO) for word in words[1:]]
    if low >= high:
        raise Rejected("the range of the parameter is empty")
    return words[0], (low, high)


def parse_side(side, line, family):
    """(side, value, x, n) of a line: a value, two numbers and two integers."""
    if len(family.names) > 1:
        raise Rejected("the header's %s is of one parameter, and there are two" % side)
    words = line.rsplit(" ", 2)
    value, *x = rationals(words[0], 3, "the header's " + side)
    n = integers(" ".join(words[1:]), 2, "the header's " + side, MAX_K)
    return side, value, tuple(x), n


def check_members(diagram):
    """Rejected, if a claim contradicts another."""
    for torus in diagram.tori:
        for box in diagram.none:
            if overlap(torus.box, box):
                raise Rejected("for the same values there are a torus and a proof that there is "
                               "none: one of them must be wrong")


def proofs_of(diagram):
    """The claims of the proofs, each named by its place; check_side has been asked.  Rejected, if
    nothing is claimed."""
    if not diagram.none and not diagram.tori:
        raise Rejected("nothing of the diagram is proved: it claims no theorem")
    for side in diagram.sides:
        diagram.family.check_side(*side)
    return [replace(member.claim, where="proof %d" % n, parts=tuple([
        replace(part, where="proof %d, %s" % (n, part.where)) for part in member.claim.parts]))
        for n, member in enumerate(diagram.proofs, 1)]


# ---- the theorem

def inward(low, high):
    """The texts of both ends of an interval, rounded inwards if they have many digits."""
    def text(x, up):
        scaled = x * 10 ** DECIMALS
        return exact_text(Fraction(math.ceil(scaled) if up else math.floor(scaled),
                                   10 ** DECIMALS))

    wide = high - low > Fraction(2, 10 ** DECIMALS) if math.isfinite(high - low) else True
    return [exact_text(x) if not wide else text(x, up) for x, up in ((low, True), (high, False))
            if math.isfinite(x)]


def range_words(name, low, high):
    """The words for the values of a parameter from low to high."""
    ends = inward(low, high)
    if low == high:
        return "%s = %s" % (name, ends[0])
    if len(ends) == 2:
        return "every %s in [%s, %s]" % (name, *ends)
    return "every %s" % name if not ends else "every %s %s %s" % (
        name, "<=" if low == -math.inf else ">=", ends[0])


def box_words(names, box):
    return ", ".join([range_words(name, *ends) for name, ends in zip(names, box)])


def drawn(diagram):
    """The claim of a diagram, in lines."""
    family = diagram.family
    n, names = family.angles, family.names
    lines = map_lines(present(family.waves), [(name, -1, 1) for name in names], n)
    if diagram.none:
        lines += GRAPH[n]
        lines[-1] += " for"
        lines += ["  " + box_words(names, box) for box in sorted(diagram.none)]
        larger = [member.box for member in diagram.proofs if member.larger]
        lines += ["and for any multiple s >= 1 of"] * bool(larger)
        lines += ["  " + box_words(names, box) for box in sorted(larger)]
    if diagram.tori:
        lines += ["and " * bool(diagram.none) + "has an invariant %s (J = P + S'(y), P constant, S "
                  "periodic and real" % ("Lagrangian graph" if n == 2 else "circle"),
                  "analytic), on which it is conjugate to the rotation by 2 pi omega, for"]
        from .tori import root_text, rotation_text  # here, as most checks need no torus
        for member in sorted(diagram.tori, key=lambda member: member.box):
            lines += ["  %s: %s," % (box_words(names, member.box), rotation_text(member.claim)),
                      "    where " + root_text(member.claim)]
    return lines + ["Of other values nothing is said."]
