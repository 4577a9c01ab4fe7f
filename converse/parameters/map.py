"""A map: what is proved of a region of parameter space, as a tree of cells, and its file."""

import json
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple

from ..model.exact import decimal_text, exact, rounded_text
from ..storage import files
from ..storage.files import ConverseError, Path
from ..storage.kept import Kept, headline, verify_text
from ..version import __version__
from .region import RADIUS, REGIONS, Cell, root

FORMAT = "converse map 2"
PROVED, AT_ONCE, OPEN = "PAO"
ESTIMATE_GRID = 32                  # intervals of s between the directions of the estimate


class Node:
    """A cell of the tree: a leaf of some kind, or cut across an axis into two halves.  It is one or
    the other whenever an exception strikes.

    Attributes
    ----------
    cell
        The cell.
    kind
        "P", proved; "A", proved with all larger multiples by Mather's criterion; "O", open.
    axis
        The axis across which the cell is cut: 0, r; 1, s; None: the node is a leaf.
    halves
        The nodes of both halves; () for a leaf.
    proof
        Of a proved leaf, the tree of its prisms with x*, frame, coordinate and region, as plain
        data; else None.
    tried
        Of an open leaf, the largest number of leaves with which a proof was tried in vain.
    """

    __slots__ = ("cell", "kind", "axis", "halves", "proof", "tried")

    def __init__(self, cell: Cell):
        self.cell, self.kind = cell, OPEN
        self.axis: Optional[int] = None
        self.halves: Tuple[Node, ...] = ()
        self.proof: Optional[Dict[str, Any]] = None
        self.tried = 0

    def cut(self, axis: int) -> "Tuple[Node, ...]":
        """Cuts the cell of a leaf, and returns both halves.

        Parameters
        ----------
        axis
            0: r is cut; 1: s is cut.
        """
        self.axis = axis
        self.halves = tuple(map(Node, self.cell.halves(axis)))
        return self.halves

    def decide(self, kind: str, proof: Optional[Dict[str, Any]]) -> None:
        """Makes the node a leaf of another kind.

        Parameters
        ----------
        kind, proof
            New values of these attributes.
        """
        self.proof = proof
        self.kind = kind

    def nodes(self) -> "Iterator[Node]":
        """All below and itself, in preorder."""
        todo = [self]
        while todo:
            node = todo.pop()
            yield node
            todo += node.halves[::-1]


@dataclass(eq=False, repr=False)
class ParameterMap(Kept):
    """The proofs over a region of parameter space, and the estimate that led the search.

    Attributes
    ----------
    region
        "b=0", "a=b" or "c=0", with a, b, c >= 0.
    down_to
        How near to the estimated frontier the search was to come, as a ratio.
    roots
        The roots of the trees of its faces.
    estimate
        By face, the estimated frontier: by s, the least radius at which single parameters were
        proved with a certain effort.  Nothing that is proved rests on it.
    seconds
        The duration of the search.
    version
        The release of the program that did the work.
    sha256
        The SHA-256 of the file, uncompressed; "" if there is none.
    restored
        How many proved cells were read from a file, and are believed.
    """

    region: str
    down_to: Fraction
    roots: List[Node]
    estimate: List[Dict[Fraction, float]]
    seconds: float = 0.0
    version: str = __version__
    sha256: str = ""
    restored: int = 0

    @classmethod
    def new(cls, region: str, down_to: Fraction) -> "ParameterMap":
        """Makes a map in which nothing is proved or estimated yet.

        Parameters
        ----------
        region, down_to
            Values of these attributes.
        """
        faces = REGIONS[region]
        return cls(region, down_to, [Node(root(face)) for face in range(len(faces))],
                   [{} for _ in faces])

    @property
    def directions(self) -> Tuple[Tuple[Tuple[int, ...], ...], ...]:
        """d_0 and d_1 of each face."""
        return REGIONS[self.region]

    def leaves(self) -> Iterator[Node]:
        """The leaves of all faces, in preorder."""
        for tree in self.roots:
            yield from (node for node in tree.nodes() if not node.halves)

    def count(self, kind: str) -> int:
        """How many leaves are of a kind.

        Parameters
        ----------
        kind
            As of Node.
        """
        return sum(leaf.kind == kind for leaf in self.leaves())

    def in_plane(self, point: Tuple[Fraction, Fraction, Fraction]) -> bool:
        """Does a point lie in the plane of the region?

        Parameters
        ----------
        point
            Its (a, b, c), of any sign.
        """
        a, b, c = point
        return {"b=0": b == 0, "a=b": a == b, "c=0": c == 0}[self.region]

    # ---- the estimate

    @staticmethod
    def places() -> List[Fraction]:
        """The s at which the frontier of a face is estimated, exactly."""
        return [Fraction(k, ESTIMATE_GRID) for k in range(ESTIMATE_GRID + 1)]

    def estimated(self, face: int, s: Fraction) -> float:
        """The estimated frontier in a direction: a radius, linear between known places.

        Parameters
        ----------
        face, s
            The number of the face, and the direction on it, from 0 to 1.

        Raises
        ------
        KeyError
            The frontier is not yet estimated at a neighbouring place.
        """
        k = min(math.floor(s * ESTIMATE_GRID), ESTIMATE_GRID - 1)
        share, known = float(s * ESTIMATE_GRID - k), self.estimate[face]
        return sum(weight * known[Fraction(place, ESTIMATE_GRID)]
                   for place, weight in ((k, 1 - share), (k + 1, share)) if weight)

    def target(self, cell: Cell) -> float:
        """The least radius down to which all directions of a cell are to be proved: down_to times
        the least estimate.

        Parameters
        ----------
        cell
            The cell.  Its directions must have estimates.
        """
        low, high = cell.low[1], cell.high[1]
        inner = range(math.floor(low * ESTIMATE_GRID) + 1, math.ceil(high * ESTIMATE_GRID))
        return float(self.down_to) * min(
            self.estimated(cell.face, s)
            for s in [low, *(Fraction(k, ESTIMATE_GRID) for k in inner), high])

    def area(self, cell: Optional[Cell] = None) -> float:
        """About the area, in (r, s), of what is to be proved.

        Parameters
        ----------
        cell
            The cell whose part is measured; None: all that is to be proved.
        """
        if cell is None:
            return sum(max(0.0, RADIUS - float(self.down_to) * radius) / len(estimate)
                       for estimate in self.estimate for radius in estimate.values())
        target = float(self.down_to) * self.estimated(cell.face, cell.middle[1])
        return max(0.0, float(cell.high[0]) - max(float(cell.low[0]), target)) * float(
            cell.high[1] - cell.low[1])

    # ---- what is proved

    def wanted(self, cell: Cell) -> bool:
        """Does a part of the cell lie above down_to times the estimate?

        Parameters
        ----------
        cell
            As of target().
        """
        return float(cell.high[0]) > self.target(cell)

    @property
    def estimated_all(self) -> bool:
        """Is the frontier estimated at all places?"""
        return all(len(estimate) == len(self.places()) for estimate in self.estimate)

    @property
    def complete(self) -> bool:
        """Is everything proved that was asked for?"""
        return self.estimated_all and not any(leaf.kind == OPEN and self.wanted(leaf.cell)
                                              for leaf in self.leaves())

    @property
    def reached(self) -> float:
        """About the least ratio of r to the estimate above which everything is proved."""
        return max(math.inf if leaf.cell.high[0] == RADIUS else
                   float(leaf.cell.high[0] * self.down_to) / self.target(leaf.cell)
                   for leaf in self.leaves() if leaf.kind == OPEN)

    def height(self, face: int) -> Fraction:
        """The radius above which all directions of a face are proved.

        Parameters
        ----------
        face
            The number of the face.
        """
        return max(leaf.cell.high[0] for leaf in self.leaves()
                   if leaf.kind == OPEN and leaf.cell.face == face)

    def report(self, file: Optional[Path] = None) -> str:
        """The theorem and the counts of the map, in lines.

        Parameters
        ----------
        file
            The name of the map's file, for the line that says how to verify it.
        """
        proofs = [leaf.proof["tree"] for leaf in self.leaves() if leaf.proof is not None]
        lines = [headline("THEOREM", self.restored, "cell") + ".",
                 "The map  y' = y + J',  J' = J - grad V(y),  y modulo 2 pi,",
                 "with  V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1),",
                 "has no invariant torus J = P + S'(y) over both angles, P constant, S periodic "
                 "and C1,",
                 "for (a, b, c) = r d in the proved cells, for larger multiples of those in cells "
                 "with B > 10/3,", "and for the images of all these by changes of the signs of "
                 "a, b, c and by the exchange of a and b.",
                 *["Verify : " + verify_text(file, "map")] * bool(file)] if self.count(
                     PROVED) or self.count(AT_ONCE) else ["UNDECIDED: nothing is proved."]
        lines += ["Region : " + self.region]
        for face, directions in enumerate(self.directions):
            height = self.height(face)
            lines += ["d = %s, 0 <= s <= 1 : %s" % (
                " + s ".join("(%s)" % ", ".join(map(str, d)) for d in directions),
                "proved for all r >= %s" % decimal_text(height) if height < RADIUS else
                "open in some direction up to r = %s" % RADIUS)]
        lines += ["Cells : %d proved, %d proved with all larger multiples (B > 10/3), %d open" % (
                      len(proofs), self.count(AT_ONCE), self.count(OPEN)),
                  "Prisms : %d proved" % sum(tree.count("P") for tree in proofs),
                  "Asked for : down to %s times the estimated frontier%s" % (
                      decimal_text(self.down_to),
                      "" if self.complete else "; not all of it is proved")]
        if self.estimated_all and self.reached < math.inf:
            lines += ["Reached : all r >= %s times the estimate" % rounded_text(
                self.reached + 1e-9, 4, up=True)]       # whose floats are nearer than 1e-9
        lines += ["Time : %.0f seconds" % self.seconds]
        lines += ["SHA-256 : " + self.sha256] if self.sha256 else []
        return "\n".join(lines) + "\n"

    def plot(self, ax: Any = None,
             tori: Iterable[Tuple[Fraction, Fraction, Fraction]] = ()) -> Any:
        """Draws the map in its plane of a, b and c.

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned.  With None a Figure is returned,
            which a notebook shows.
        tori
            The (a, b, c) of proved tori (parameters.tori.proved_points); those that lie in the
            plane are drawn.

        Raises
        ------
        ConverseError
            matplotlib is missing, or the frontier is not estimated yet.
        """
        from ..draw import map_figure
        return map_figure.draw(self, None, list(tori), ax)

    def __repr__(self):
        return "<ParameterMap of %s: %d cells proved, %d at once, %d open>" % (
            self.region, *map(self.count, (PROVED, AT_ONCE, OPEN)))

    def _text(self) -> str:
        faces = []
        for directions, tree, estimate in zip(self.directions, self.roots, self.estimate):
            nodes = list(tree.nodes())
            faces.append({
                "directions": [list(map(str, d)) for d in directions],
                "radius": str(RADIUS),
                "tree": "".join(str(node.axis) if node.halves else node.kind
                                for node in nodes),
                "proofs": [node.proof for node in nodes if node.kind == PROVED],
                "tried": [node.tried for node in nodes
                          if node.kind == OPEN and not node.halves],
                "estimate": [[decimal_text(s), radius]
                             for s, radius in sorted(estimate.items())]})
        data = {"format": FORMAT, "program": "converse " + self.version, "region": self.region,
                "down to": decimal_text(self.down_to), "seconds": round(self.seconds, 2),
                "faces": faces}
        data["sha256"] = _digest(data)
        return json.dumps(data, indent=1) + "\n"

    @classmethod
    def load(cls, path: Path) -> "ParameterMap":
        damaged = ": is not a map, or truncated"
        text = files.read_text(path, "map", damaged)
        try:
            data = json.loads(text)
        except (ValueError, RecursionError):
            data = None
        if not isinstance(data, dict):
            raise ConverseError("%s%s; use an intact copy or start anew" % (path, damaged))
        if "harmonics" in data:
            raise ConverseError("%s: is an input and not a map; maps are of the thesis's three "
                                "waves (a, b, c) alone: prove a patch of another potential with "
                                "converse --method loewner" % path)
        try:
            digest = data.pop("sha256")
            if digest != _digest(data):
                raise ValueError("it was changed or damaged")
            if data["format"] != FORMAT:
                raise ValueError("its format, %s, is of another version of the program"
                                 % data["format"])
            made = cls.new(data["region"], exact(data["down to"]))
            made.seconds = float(data["seconds"])
            made.sha256 = files.sha256(text)
            made.version = data["program"].partition(" ")[2]
            for tree, face, estimate in zip(made.roots, data["faces"], made.estimate):
                _read_tree(tree, face)
                estimate.update((exact(s), float(radius)) for s, radius in face["estimate"])
            made.restored = made.count(PROVED) + made.count(AT_ONCE)
            return made
        except (AttributeError, KeyError, IndexError, TypeError, ValueError) as error:
            raise ConverseError("%s: makes no sense (%s); use an intact copy or start anew"
                                % (path, error)) from None


def _digest(data):
    return files.sha256(json.dumps(data, sort_keys=True, separators=(",", ":")))


def _read_tree(tree, face):
    """Takes up a tree of cells."""
    todo, proofs, tried = [tree], iter(face["proofs"]), iter(face["tried"])
    for kind in face["tree"]:
        node = todo.pop()
        if kind in "01":
            todo += node.cut(int(kind))[::-1]
            continue
        if kind not in (PROVED, AT_ONCE, OPEN):
            raise ValueError("'%s' is not a kind of cell" % kind)
        proof = next(proofs, None) if kind == PROVED else None
        if kind == PROVED and proof is None:
            raise ValueError("there are fewer proofs than proved cells")
        node.decide(kind, proof)
        if kind == OPEN:
            node.tried = next(tried, 0)
    if todo:
        raise ValueError("the tree of cells ends too early")
    if not any(node.kind == OPEN for node in tree.nodes() if not node.halves):
        raise ValueError("no cell of a face is open, but the map with r = 0 has tori")
