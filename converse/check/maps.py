"""Maps: many patches of the thesis's potential in one file.

The points of a face are (a, b, c) = r d(s), d(s) = d0 + s d1, 0 <= r <= radius, 0 <= s <= 1.  About
the middle of a cell of (r, s)
      r d(s) = r d(sm) + r (s - sm) d1
is covered by a patch of two parameters: with middle rm d(sm) and the parts (r1 - r0)/2 d(sm) and
r1 (s1 - s0)/2 d1.
"""

import functools
import hashlib
import json
import math
from dataclasses import dataclass, replace
from fractions import Fraction

from .arith import fixed_of, stiffness
from .claim import ANGLES, THESIS, Claim, Wave, check_alone, check_frame, number, present
from .cover import symmetries_used
from .failures import NotConfirmed, Rejected, Unusable, named
from .torus import is_at_once, torus_bound
from .tree import check_mirror_images, leaves, tree_counts
from .words import GRAPH, THESIS_LINES, decimal_text

REGIONS = {"b=0": (((1, 0, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0))),
           "a=b": (((1, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 1, 0))),
           "c=0": (((1, 0, 0), (0, 1, 0)),)}
MAX_ITEMS = 1 << 22                     # of the JSON text, and of the trees, of a map
MAP_FORMAT = "converse map 2"
MAP_AXES, MAP_KINDS = "01", "PAO"       # of the tree of a face: cuts of r and s; leaves
GRID, MAP_CELLS = 16, 2000              # slices of s; cells of the torus for B


@dataclass(frozen=True)
class Face:
    """A face of a map: d0 and d1, and its cells, (kind, index, cuts)."""

    directions: tuple
    radius: Fraction
    cells: tuple

    @functools.cached_property
    def proved(self):
        """What proved_from says of it."""
        return proved_from(self.cells, self.radius)

    def d(self, s):
        """d(s) of an exact number."""
        return [x + s * y for x, y in zip(*self.directions)]

    def box(self, index, cuts):
        """The ends of r, and those of s."""
        r, s = [(Fraction(i, 1 << k), Fraction(i + 1, 1 << k)) for i, k in zip(index, cuts)]
        return [self.radius * x for x in r], s

    def waves(self, cell, least=False):
        """The waves of the patch of a cell; or of the patch of its points of the least r."""
        (r0, r1), (s0, s1) = self.box(*cell)
        if least:
            r1 = r0
        middle = self.d((s0 + s1) / 2)
        parts = [[(r1 - r0) / 2 * x for x in middle],
                 [r1 * (s1 - s0) / 2 * x for x in self.directions[1]]]
        return tuple(Wave(k, Fraction(0), (r0 + r1) / 2 * x, tuple(column))
                     for k, x, column in zip(THESIS, middle, zip(*parts)))


@dataclass(frozen=True)
class ParameterMap:
    """The content of a map.

    Attributes
    ----------
    region
        Its name, a key of REGIONS.
    faces
        Its faces, each a Face.
    claims
        Of the proved cells, in their order, each a Claim.
    sha256
        The SHA-256 of the file, uncompressed.
    """

    region: str
    faces: tuple
    claims: tuple
    sha256: str

    def count(self, kind):
        """How many cells are of a kind.

        Parameters
        ----------
        kind
            A letter of MAP_KINDS: "P" proved, "A" proved with all larger multiples, "O" open.
        """
        return sum(cell[0] == kind for face in self.faces for cell in face.cells)


def fields_of(value, name, *ignored, **kinds):
    """The values of an object that must have exactly these fields, of these types; the ignored
    fields may be there."""
    if type(value) is not dict or value.keys() - set(ignored) != {key.replace("_", " ")
                                                                 for key in kinds}:
        raise Rejected("%s is not an object with the fields %s, and no other"
                       % (name, ", ".join(sorted(kinds)).replace("_", " ")))
    values = [value[key.replace("_", " ")] for key in kinds]
    for key, kind, found in zip(kinds, kinds.values(), values):
        if type(found) is not kind:
            raise Rejected("%s: its %s is not of the type it must be"
                           % (name, key.replace("_", " ")))
    return values


def list_of(value, count, kind, name):
    if type(value) is not list or len(value) != count or any(type(x) is not kind for x in value):
        raise Rejected("%s is not a list of %d as they must be" % (name, count))
    return value


def strict_json(data):
    """The content of a JSON text; Rejected, if it is not JSON, or readers may differ on it."""
    if data.count(b",") + data.count(b"[") + data.count(b"{") > MAX_ITEMS:
        raise NotConfirmed("the map has more than %d items, the checker's limit" % MAX_ITEMS)

    def once(pairs):
        if len(dict(pairs)) != len(pairs):
            raise ValueError("a field appears twice")
        return dict(pairs)

    def integer(text):
        if len(text) > 10:
            raise ValueError("an integer is too long")
        return int(text)

    def finite(text):
        if not math.isfinite(float(text)):
            raise ValueError("a number is not finite")
        return float(text)

    try:
        content = json.loads(data.decode("utf-8"), object_pairs_hook=once, parse_int=integer,
                             parse_float=finite, parse_constant=finite)
    except UnicodeDecodeError:
        raise Rejected("the map is not UTF-8: it was altered or damaged") from None
    except json.JSONDecodeError as error:
        raise Rejected("the map is no whole JSON text, at character %d: it was truncated or altered"
                       % error.pos) from None
    except RecursionError:
        raise Rejected("the map is nested too deeply") from None
    except ValueError as error:
        raise Rejected("the map is not as maps are: %s" % error) from None
    return content


def read_map(data):
    """The map; each patch in it is whole, and every field is known."""
    content = strict_json(data)
    if not isinstance(content, dict) or content.get("format") != MAP_FORMAT:
        raise Unusable("is JSON, but not a map of the version that this checker knows, "
                       + MAP_FORMAT)
    _, _, region, down_to, faces, sha256 = fields_of(
        content, "the map", "seconds", format=str, program=str, region=str, down_to=str, faces=list,
        sha256=str)
    del content["sha256"]
    try:
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    except RecursionError:
        raise Rejected("the map is nested too deeply") from None
    if hashlib.sha256(text.encode()).hexdigest() != sha256:
        raise Rejected("wrong checksum: the map was changed or damaged")
    del content, text
    if region not in REGIONS:
        raise Rejected("the map's region is none of %s" % ", ".join(sorted(REGIONS)))
    number(down_to, "the map's 'down to'")
    if len(faces) != len(REGIONS[region]):
        raise Rejected("the region has %d faces, the map %d" % (len(REGIONS[region]), len(faces)))
    whole, claims, file = [], [], hashlib.sha256(data).hexdigest()
    for at, face in enumerate(faces, 1):
        with named("face %d" % at):
            whole.append(read_face(face, claims, at, file))
    if sorted(face.directions for face in whole) != sorted(REGIONS[region]):
        raise Rejected("the faces are not those of the region")
    found = ParameterMap(region, tuple(whole), tuple(claims), file)
    if not found.count("P") and not found.count("A"):
        raise Rejected("no cell of the map is proved: it claims no theorem")
    return found


def read_face(face, claims, at, sha256):
    """A face of a map; adds the claims of its proved cells."""
    directions, radius, tree, proofs = fields_of(face, "it", "tried", "estimate", directions=list,
                                                 radius=str, tree=str, proofs=list)
    directions = tuple(tuple(number(x, "a direction") for x in list_of(d, 3, str, "a direction"))
                       for d in list_of(directions, 2, list, "its directions"))
    radius = number(radius, "its radius")
    if radius <= 0:
        raise Rejected("its radius is not above 0")
    cells, proofs = [], iter(proofs)
    for position, cell in leaves(tree, MAP_AXES, MAP_KINDS):
        kind = tree[position]
        cells.append((kind, *cell))
        if kind == "P":
            if (proof := next(proofs, None)) is None:
                raise Rejected("it has fewer proofs than proved cells")
            with named("cell %d" % len(cells)):
                claims.append(read_cell(proof, Face(directions, radius, ()).waves(cell),
                                        "face %d, cell %d" % (at, len(cells)), sha256))
    if next(proofs, None) is not None:
        raise Rejected("it has more proofs than proved cells")
    return Face(directions, radius, tuple(cells))


def read_cell(proof, waves, name, sha256):
    """The claim of a proved cell."""
    xstar, frame, alone, tree, *ranges = fields_of(
        proof, "its proof", xstar=list, frame=list, alone=str, tree=str,
        **dict.fromkeys(ANGLES, list))
    xstar, *ranges = [tuple(number(x, key) for x in list_of(pair, 2, str, key))
                      for key, pair in zip(("x*", *ANGLES), (xstar, *ranges))]
    centre, half = zip(*ranges)
    if min(half) < 0:
        raise Rejected("a half-width is negative")
    frame = check_frame([str(x) for x in list_of(frame, 4, int, "the frame")], "the frame")
    if alone not in ("no", "0", "1"):
        raise Rejected("alone is neither no nor 0 nor 1")
    alone = None if alone == "no" else int(alone)
    check_alone(waves, alone)
    claim = Claim(waves, centre, half, frame, alone, xstar, {}, "no", tree, sha256)
    if symmetries_used(claim) is None:
        raise Rejected("its region does not hold enough of the torus")
    claim.counts.update(tree_counts(claim))
    check_mirror_images(claim)
    return replace(claim, where=name)


def check_map(file):
    """NotConfirmed, if a cell A is not excluded by B > 10/3; else for each cell P a bound of B.

    B - 2 is convex and homogeneous of degree 1 in the amplitudes.  So it is r times its value at
    d(s), which lies below what is linear between points of a grid of s; and over a cell this, or
    the convex function itself where the cell has more than one slice of the grid, is largest at an
    end.
    """
    fixed, bounds, claims = fixed_of(96), [], iter(file.claims)
    for at, face in enumerate(file.faces, 1):
        with named("face %d" % at):
            face.proved                 # which has a limit: not to be met after hours

        @functools.lru_cache(maxsize=None)
        def excess(k, face=face):
            """B - 2 at a point k/GRID of the grid, exact and from above."""
            known = {(*k, 0): math.floor(x * fixed.one)
                     for k, x in zip(THESIS, face.d(Fraction(k, GRID))) if x}
            bound = torus_bound(fixed, list(known), [tuple(known.values())], MAP_CELLS) \
                + stiffness(known)
            return Fraction(bound, fixed.one) - 2

        def between(s, excess=excess):
            """The same, for any s."""
            k = min(math.floor(s * GRID), GRID - 1)
            u = s * GRID - k
            return sum([weight * excess(at) for at, weight in ((k, 1 - u), (k + 1, u)) if weight])

        for n, (kind, *cell) in enumerate(face.cells, 1):
            name = "face %d, cell %d" % (at, n)
            if kind == "A" and not is_at_once(fixed, present(face.waves(cell, least=True))):
                raise NotConfirmed("%s: that it and all larger multiples are excluded at once "
                                   "(B > 10/3)" % name)
            if kind == "P":
                claim, ((_, r), s) = next(claims), face.box(*cell)
                if claim.alone is None:
                    bounds.append(2 + r * max(map(between, s)))
                else:       # one coordinate, whose waves add no more than their amplitudes
                    bounds.append(2 + sum([wave.k[claim.alone] ** 2 * (
                        abs(wave.middle) + sum(map(abs, wave.parts))) for wave in claim.examined]))
    return bounds


def sign_changes():
    """How V's maps of the torus change the signs of a, b and c, generated by y0 -> y0 + pi,
    y1 -> y1 + pi and y -> -y: sin(k.(y + pi s)) = (-1)^(k.s) sin(k.y), sin(-k.y) = -sin(k.y)."""
    found = {(1, 1, 1)}
    for signs in [tuple([(-1) ** k[i] for k in THESIS]) for i in (0, 1)] + [(-1, -1, -1)]:
        found |= {tuple([p * q for p, q in zip(signs, other)]) for other in found}
    return found


def proved_from(cells, radius):
    """The least r such that every direction of these cells is proved between r and the radius (None
    if there is none), and whether every direction is proved for all large r.

    A cell A is proved for all r above its least r.  Directions in which some cell is finer are
    examined in halves.  Where all cells are as wide as the directions, the unproved cells are
    those not above the first cell A.  NotConfirmed, if there are too many halves: a wide cell
    above many narrow ones is examined for each of these.
    """
    worst, forever, seen = Fraction(0), True, 0
    todo = [(0, 0, cells)]
    while todo:
        index, cuts, cells = todo.pop()
        seen += len(cells)
        if seen > MAX_ITEMS:
            raise NotConfirmed("its cells lie in too many ways below each other for this checker")
        if all(cell[2][1] <= cuts for cell in cells):
            ends = [(kind, radius * i / (1 << k), radius * (i + 1) / (1 << k))
                    for kind, (i, *_), (k, *_) in cells]
            once = min([low for kind, low, _ in ends if kind == "A"], default=None)
            worst = max([worst] + [high if once is None else min(high, once)
                                   for kind, low, high in ends
                                   if kind == "O" and (once is None or low < once)])
            forever &= once is not None
            continue
        k = cuts + 1
        for i in (2 * index, 2 * index + 1):
            todo.append((i, k, [(kind, at, own) for kind, at, own in cells
                                if at[1] >> max(own[1] - k, 0) == i >> max(k - own[1], 0)]))
    return worst if worst < radius else None, forever


def mapped(file):
    """The claim of a map, in lines."""
    signs = len(sign_changes())
    lines = [*THESIS_LINES, *GRAPH[2]]
    lines[-1] += " for any (a, b, c)"
    lines += ["in the %d proved cells of the file, for any multiple s >= 1 of those in its %d cells"
              % (file.count("P"), file.count("A")),
              "with B > 10/3, and for the images of all these by the %d changes of the signs of"
              % signs,
              "a, b, c and by the exchange of a and b.  %d cells are open." % file.count("O"),
              "Region : " + file.region]
    for face in file.faces:
        lines += ["Face (a, b, c) = r (%s), 0 <= s <= 1, r <= %s :" % (" + s ".join([
            "(%s)" % ", ".join(map(decimal_text, d)) for d in face.directions]),
            decimal_text(face.radius))]
        least = min([face.box(*cell)[0][0] for kind, *cell in face.cells if kind in "PA"],
                    default=None)
        if least is None:
            lines += ["  nothing is proved"]
            continue
        start, forever = face.proved
        lines += ["  every direction is proved for all r >= %s%s" % (
            decimal_text(start), "" if forever else " up to the face's radius")
            if start is not None else "  not every direction is proved, even at the face's radius",
            "  the least r that is proved in some direction is %s" % decimal_text(least)]
    return lines
