"""The value Proof: the tree of prisms with what was asked and the statistics of the search.

The methods that report, draw, save and load are conveniences: what they call knows Proof and is
imported when it is called for, since matplotlib takes a while."""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Dict, List, Optional, Tuple

from ..model.problem import Problem
from ..model.region import symmetries_used
from ..storage.kept import Kept
from ..storage.methods import provided
from ..version import __version__
from . import tree
from .native import TOO_LONG, Counts
from .settings import (AS_PRINTED, DEPTH, DOUBLES, HOPELESS, LENGTH, REGION, THEOREM, TIME,
                       UNDECIDED, Settings)
from .tree import Leaf


@dataclass(frozen=True)
class Tree:
    """A starting point, and what was decided of a region of its successors.

    Attributes
    ----------
    problem
        The map and the region.  Only regions of further starting points move with the parameters.
    xstar
        The angles of the starting point, two or three, in radians, as decimal strings; None: not
        yet chosen.
    text
        One character for each prism, in preorder (docs/reference/proof-file.md).
    pending
        The hints of the untried prisms, in their order: how long an orbit to try first, as their
        parents' tries suggest (0: unknown).
    """

    problem: Problem
    xstar: Optional[Tuple[str, ...]] = None
    text: str = ""
    pending: Tuple[int, ...] = ()

    @property
    def decided(self) -> bool:
        """Is the tree whole and without an undecided prism?"""
        return "U" not in self.text and tree.complete(self.text)

    @cached_property
    def undecided(self) -> Dict[Tuple[int, ...], int]:
        """The number of undecided leaves, by the cuts along each axis."""
        return Counter(cuts for kind, (_, cuts) in tree.cells(self.text) if kind == "U")


@dataclass(frozen=True, repr=False)
class Proof(Kept):
    """A search and its result, finished or not: true if it proves that there are no invariant tori.

    The theorem rests on the tree, which prove() grew.  A Proof that was loaded, or made by hand, is
    believed, except that prove(resume=...) shows its links anew; verify() believes nothing.  A
    finished search gives the same file, however it was interrupted and continued.  The file of an
    unfinished search also holds the seconds that it took.

    Attributes
    ----------
    trees
        Over the starting point of the problem and then, a, b, c, ..., over those to which prisms of
        trees before them are linked.
    settings
        What was asked.  The proof also has its method, depth, digits and as_printed as attributes.
    counts
        The statistics of the search.
    constants
        The numbers of the theorem, as decimal strings: B, a bound of the largest eigenvalue of
        beta, and with the thesis's method T, of its trace, and the limits of the uniform cones.
    seconds
        The duration of the search, as far as it is known.
    version
        The release of the program that did the work.
    at_once
        Whether no multiples of these amplitudes by s > 1 have tori (if there is one parameter, as
        where a, b and c move together: multiples of those at its upper end).
    hopeless
        Whether the search ended because orbits were seen that seem to minimize: there is probably a
        torus, and neither time nor depth would help.
    longest
        The most points of an orbit, 0 for as many as the core can follow; None: whether orbits of
        more than native.ORDINARY points may prove more was not asked.
    restored
        How many leaves were read from a file; links may have taken the place of some.
    sha256
        The SHA-256 of the proof's file, uncompressed; "" if there is none.
    """

    KIND = "proof"

    trees: Tuple[Tree, ...]
    settings: Settings = Settings()
    counts: Counts = Counts()
    constants: Dict[str, str] = field(default_factory=dict, hash=False)
    seconds: float = field(default=0.0, compare=False)
    version: str = __version__
    at_once: bool = False
    hopeless: bool = False
    longest: Optional[int] = field(default=None, compare=False)
    restored: int = field(default=0, compare=False)
    sha256: str = field(default="", compare=False)

    def __bool__(self):
        return self.no_tori

    def __repr__(self):
        return "<Proof: %s; %s; %d prisms proved, %d %s, %d undecided; %s, %s>" % (
            self.problem.map,
            {THEOREM: "no invariant tori", REGION: "none through a part of the torus",
             UNDECIDED: "undecided", AS_PRINTED: "as printed, not a proof"}[self.conclusion],
            self.counts.proved, self.counts.linked if self.parts else self.counts.symmetric,
            "linked" if self.parts else "skipped", self.counts.undecided, self.method,
            self.arithmetic)

    @property
    def problem(self) -> Problem:
        """The problem.  Where all of the torus was asked for, and x* is known, it has the frame and
        the region that are searched (symmetries_used)."""
        return self.trees[0].problem

    @property
    def xstar(self) -> Optional[Tuple[str, ...]]:
        """The starting point of the problem."""
        return self.trees[0].xstar

    @property
    def tree(self) -> str:
        """The text of the tree over it."""
        return self.trees[0].text

    @property
    def parts(self) -> Tuple[Tree, ...]:
        """The trees over further starting points."""
        return self.trees[1:]

    def with_tree(self, number: int, **changes: Any) -> "Proof":
        """The proof with changes of one of its trees.

        Parameters
        ----------
        number
            The index of the tree in `trees`; 0 is the tree of the problem.
        changes
            New values of attributes of the Tree, by name.
        """
        trees = list(self.trees)
        trees[number] = replace(trees[number], **changes)
        return replace(self, trees=tuple(trees))

    @property
    def method(self) -> str:
        return self.settings.method

    @property
    def depth(self) -> int:
        return self.settings.depth or 0

    @property
    def digits(self) -> int:
        return self.settings.digits

    @property
    def as_printed(self) -> bool:
        return self.settings.as_printed

    @cached_property
    def all_decided(self) -> bool:
        """Are the trees whole and without an undecided prism?"""
        return all(each.decided for each in self.trees)

    @cached_property
    def symmetries_used(self) -> Optional[List[str]]:
        """The symmetries, in words, by which the region stands for every possible successor, or
        None if it is a part of the torus only."""
        return symmetries_used(self.problem, self.xstar)

    @property
    def conclusion(self) -> str:
        """The result of the search.  "theorem": there are no invariant tori.  "region": none goes
        through the successors of x* in the problem's region, a part of the torus.  "undecided".
        "as printed": decided as by the listing of 1989, which is not a proof."""
        if not self.all_decided:
            return UNDECIDED
        if self.as_printed:
            return AS_PRINTED
        return REGION if self.symmetries_used is None else THEOREM

    @property
    def ended(self) -> str:
        """The reason why an undecided search ended.  "hopeless as seen": see `hopeless`.  "limit of
        length", "limit of depth": an orbit would be too long, or a prism was cut as often as
        `depth` allows.  "limit of doubles": a prism is as small as doubles can tell.  "time": there
        was no time left, or the run was interrupted.  "": the search is decided."""
        if self.all_decided:
            return ""
        if self.hopeless:
            return HOPELESS
        if not self.undecided:
            return TIME
        if all(leaf.depth >= self.depth for leaf in self.undecided):
            return DEPTH
        return LENGTH if self.method == "loewner" and self.counts.reasons[TOO_LONG] else DOUBLES

    @property
    def no_tori(self) -> bool:
        """Is it proved that there are no invariant tori?"""
        return self.conclusion == THEOREM

    @property
    def arithmetic(self) -> str:
        """The arithmetic in which the bounds were computed, in words."""
        return "%d decimal places" % self.digits if self.method == "thesis" else "double precision"

    @property
    def undecided(self) -> List[Leaf]:
        """The prisms on which the search gave up: a list of Leaf, angles in units of pi.  Those of
        further starting points follow; where regions move with the parameters, a Leaf is as wide
        as all places of its prism."""
        return [leaf for each in self.trees if "U" in each.text
                for leaf in tree.leaves(each.problem, each.text, "U")]

    def report(self) -> str:
        """The report: with the thesis's method that of 1989, and what a reader needs beside it."""
        from .report import report
        return report(self)

    def plot(self, ax: Any = None, caption: bool = True) -> Any:
        """Draws the prisms, the angles in units of pi.

        Parameters
        ----------
        ax
            Axes of matplotlib, which are drawn into and returned: only the prisms and x*, with
            labels for ax.legend().  With None a Figure is returned, which a notebook shows.
        caption
            Whether the lines above a Figure state what is proved and by what.

        Raises
        ------
        ConverseError
            matplotlib is missing.
        """
        return provided("Proof.plot")(self, caption, ax)

    def _text(self):
        return provided("Proof.save")(self)

    @classmethod
    def _of(cls, content):
        return provided("Proof.load")(content)
