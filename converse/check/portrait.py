"""A portrait: where in phase space there are no invariant circles, column by column; step (C27)."""

import collections
import math
from dataclasses import dataclass, replace
from fractions import Fraction

from .arith import fixed_of
from .claim import IDENTITY, RATIO, Claim, Wave, number, present
from .container import Format
from .cover import CENTRE_BITS, reversal_centre
from .failures import NotConfirmed, Rejected, named
from .proof_file import parse_part, parse_waves
from .tree import leaves
from .words import GRAPH, decimal_text, map_lines, ordinary_names, range_text

MAX_COLUMNS = 1 << 16                   # of a portrait
MAX_STRIP = 0.5                         # of k times half the width of a column, in radians
STRIP_AXIS = 3                          # of cells: that of t2, along which a strip is cut
PLACES = 6                              # of the share that the header says


@dataclass(frozen=True)
class Portrait:
    """The content of a portrait; exact."""

    waves: tuple
    strip: Fraction                     # half the width of a column, in radians; 0: lines
    even: object                        # V is even about this point, in units of pi; or None
    claims: tuple                       # of the regions of all columns, in their order; the
                                        # others are parts of the first, as their patch is one
    header: dict                        # its fields; nothing rests on the others
    sha256: str                         # of the file, uncompressed

    @property
    def columns(self):
        """The regions of each column, in their order."""
        found = {}
        for claim in self.claims:
            found.setdefault(claim.xstar, []).append(claim)
        return list(found.values())

    @property
    def length(self):
        """Bounds of the length, in radians, of the interval in which x* lies: below and above."""
        return [(1 if self.even is not None else 2) * pi for pi in fixed_of(CENTRE_BITS).around_pi]

    @property
    def undecided(self):
        """The largest share of phase space, or of lines, that may lack a proof, rounded up."""
        shares = [share(column, self.strip) for column in self.columns]
        if self.strip:
            total = 1 - 2 * self.strip * sum([1 - x for x in shares]) / self.length[1]
        else:
            total = sum(shares, Fraction(0)) / len(shares) if shares else Fraction(1)
        return Fraction(math.ceil(total * 10 ** PLACES), 10 ** PLACES)


def patch_of_strip(wave, strip):
    """The waves of a patch that holds V(y + s) for all |s| <= strip, V(y) = -p sin(k y + phi).

    It is -p cos(k s) sin(k y + phi) - p sin(k s) sin(k y + phi + pi/2).  With p = P + g t, t2 =
    sin(k s)/angle and angle = k strip, p sin(k s) = P angle t2 + g angle (t t2), and t t2 is
    another t3 in [-1, 1]; and |p cos(k s) - P (1 - angle^2/4)| <= angle^2/4 |P| + |g|.
    """
    (k, _), p, g = wave.k, wave.middle, (*wave.parts, Fraction(0))[0]
    angle, zero = k * strip, Fraction(0)
    bend = angle * angle / 4
    along = bend * abs(p) + abs(g), zero, zero
    across = zero, p * angle, g * angle
    count = 3 if g else 2
    return (Wave(wave.k, wave.phase, p * (1 - bend), along[:count]),
            Wave(wave.k, wave.phase + Fraction(1, 2), zero, across[:count]))


def share(column, strip):
    """The largest share of a column that may lack a proof.

    Its regions hold half a turn of successors for each x[0] of the strip, and the reversal of time
    has the other half.  A leaf U is there for those s of the strip whose t2 is in its slice of t2:
    they are an interval of at most 1/sqrt(1 - angle^2) <= 1 + angle^2 times the slice's width
    times strip, as s = arcsin(angle t2)/k, and angle^2 <= 1/2.  Cuts of t1 and t3 do not count: a
    successor is proved only where all leaves over it are.
    """
    angle = column[0].waves[0].k[0] * strip
    total = sum([2 * claim.half[0] * claim.counts["lost"] for claim in column])
    return min(total * (1 + angle * angle), Fraction(1))


def read_portrait(file):
    """The portrait of a container; Rejected, unless all its regions are valid."""
    header = file.header
    waves, strip = present(parse_waves(header["wave"])), number(header["strip"], "the strip")
    if any(wave.k[1] for wave in waves) or not waves:
        raise Rejected("the waves are not those of a map of one angle")
    if strip:
        if strip < 0 or len(waves) > 1 or len(waves[0].parts) > 1:
            raise Rejected("strips have a positive width, and are of one wave with one parameter "
                           "at most")
        if abs(waves[0].k[0]) * strip > MAX_STRIP:
            raise NotConfirmed("the strips are wider than the checker's limit")
        patch = patch_of_strip(waves[0], strip)
    else:
        patch = waves
    even = None
    if header["even about"] != "no":
        even = number(header["even about"], "the header's even about", RATIO)
        if any((wave.k[0] * even + wave.phase - Fraction(1, 2)) % 1 for wave in waves):
            raise Rejected("V is not even about the point that the header names")
    zero, one = Fraction(0), Fraction(1)
    over = Claim(patch, (one, one), (one, one), IDENTITY, None, (zero, zero), {}, "no", "",
                 file.sha256)
    first, *texts = ("\n" + bytes(file.body).decode("latin-1")).split("\npart: ")
    if first.strip("\n"):
        raise Rejected("the line 'parts:' is not followed by a part")
    claims = [read_region(str(n), text, over, strip) for n, text in enumerate(texts, 1)]
    claims[:1] = [replace(claim, parts=tuple(claims[1:])) for claim in claims[:1]]
    found = Portrait(waves, strip, even, tuple(claims), header, file.sha256)
    if claims:
        check_places(found)
    for column in found.columns:
        with named(column[0].where):
            check_column(column, strip)
    said = number(header["undecided"], "the header's undecided")
    if said != found.undecided:
        raise Rejected("the header's undecided is %s, that of its columns %s"
                       % (decimal_text(said), decimal_text(found.undecided)))
    return found


def read_region(name, text, patch, strip):
    """The claim of a part of this number, with what follows `part: ` in the file."""
    claim = parse_part(name, text, patch)
    count = len(claim.waves[0].parts)
    if claim.xstar[1] or (claim.centre[1], claim.half[1]) != (1, 1) or any(
            s1 or s0 and (m != 1 or not strip) for m, (s0, s1) in enumerate(claim.shifts)):
        raise Rejected("%s is not over one angle, or its region moves, but not with t2 of a strip"
                       % claim.where)
    lost, deepest, most_cuts = collections.Counter(), 0, 0
    with named(claim.where):
        for at, (_, cuts) in leaves(claim.tree, kinds="PU"):
            deepest = max(deepest, sum(cuts))
            if claim.tree[at] == "P":
                most_cuts = max(most_cuts, sum(cuts))
            else:
                lost[cuts[0] + (cuts[STRIP_AXIS] if strip else 0)] += 1
            if cuts[1] or any(cuts[2 + count:]):
                raise Rejected("the tree cuts an angle or a parameter that there is not, above "
                               "node %d" % at)
    proved, undecided = map(claim.tree.count, "PU")
    claim.counts.update(cuts=proved + undecided - 1, proved=proved, symmetric=0, linked=0,
                        undecided=undecided, most_cuts=most_cuts, depth=deepest,
                        lost=sum([Fraction(n, 1 << cuts) for cuts, n in lost.items()]))
    return claim


PORTRAIT = Format("portrait", "2", "portrait", "parts",
                  {"wave", "strip", "even about", "undecided", "program", "depth", "columns"},
                  {"comment"}, read_portrait)


def check_places(portrait):
    """Rejected, if strips overlap, each other or mirror images, or are not where they must be."""
    stars = [column[0].xstar[0] for column in portrait.columns]
    regions = [claim.xstar[0] for claim in portrait.claims]
    if regions != sorted(regions) or any(b - a < 2 * portrait.strip
                                         for a, b in zip(stars, stars[1:])):
        raise Rejected("the columns are not in their order, or overlap")
    if len(stars) > MAX_COLUMNS:
        raise NotConfirmed("there are more columns than the checker's limit, %d" % MAX_COLUMNS)
    low, high = stars[0] - portrait.strip, stars[-1] + portrait.strip
    if portrait.even is not None:
        ends = [portrait.even * pi for pi in fixed_of(CENTRE_BITS).around_pi]
        if low < max(ends) or high > min(ends) + portrait.length[0]:
            raise Rejected("an x* lies outside of the half turn whose mirror image is the other "
                           "half")
    elif high - low > portrait.length[0]:
        raise Rejected("an x* lies outside of the turn that begins with the first strip")


def check_column(column, strip):
    """Rejected, if the regions do not hold, for all parameters, all successors from c0 to c0 + 1,
    c0 as in step (C24); they are one after the other, and overlap or touch."""
    first, last = column[0], column[-1]
    try:
        least, most = reversal_centre(first)[0], reversal_centre(last)[1] + 1
    except OverflowError:               # of an x* far off
        raise Rejected("x* is too far off") from None
    whole = first.centre[0] - first.half[0] <= least and most <= last.centre[0] + last.half[0]
    for a, b in zip(column, column[1:]):
        for t in (-1, 1):
            high, low = [claim.centre[0] + sign * claim.half[0] + t * (
                claim.shifts[1][0] if claim.shifts else 0) for claim, sign in ((a, 1), (b, -1))]
            whole &= low <= high
    if not whole:
        raise Rejected("its region does not hold enough of the successors")


def portrayed(portrait):
    """The claim of a portrait, in lines."""
    count = len(portrait.columns)
    names = ordinary_names(len(portrait.waves[0].parts))
    lines = [*map_lines(portrait.waves, names, 1), *GRAPH[1],
             "with y in a column and y', or its image by the reversal of time, in proved prisms",
             "alone, and in none that is undecided" + ", for any parameters with" * bool(names),
             *[range_text(*ends) for ends in names]]
    lines += ["Columns : %d%s, y = x* %s" % (
        count, " and their mirror images about y = %s pi" % portrait.even
        if portrait.even is not None else "",
        "+ s, |s| <= " + decimal_text(portrait.strip) if portrait.strip else "alone"),
        "Undecided : at most %s of %s" % (decimal_text(portrait.undecided), "phase space"
                                          if portrait.strip else "the successors, on average")]
    if portrait.strip:
        area = (1 - portrait.undecided) * portrait.length[0] ** 2 * (
            4 if portrait.even is not None else 1)
        lines += ["Area without circles : at least %s of 4 pi^2" % decimal_text(
            Fraction(math.floor(area * 10 ** 4), 10 ** 4))]
    return lines
