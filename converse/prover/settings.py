"""The settings of a search, which problems they are for, and what a search can conclude."""

import math
import operator
from dataclasses import dataclass, replace
from typing import Any, Optional

from ..model.problem import IDENTITY, Problem

METHODS = {"thesis": 30, "loewner": 120}            # by name, the depth unless another is given
LIMIT = 100000                                      # of the depth and of the digits

# Why a search ended without a theorem: Proof.ended.
HOPELESS, LENGTH, DEPTH, DOUBLES, TIME = (
    "hopeless as seen", "limit of length", "limit of depth", "limit of doubles", "time")
THEOREM, REGION, UNDECIDED, AS_PRINTED = "theorem", "region", "undecided", "as printed"


def whole_number(value: Any, name: str, least: int, most: float = math.inf) -> int:
    """The integer that an argument is, of Python's or numpy's; ValueError: it is none, or is not
    from `least` to `most`."""
    try:
        number = least - 1 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        number = least - 1
    if not least <= number <= most:
        raise ValueError("%s must be a whole number%s, not %r" % (
            name, ", %d or more" % least if most == math.inf else " from %d to %d" % (least, most),
            value))
    return number


@dataclass(frozen=True)
class Settings:
    """The settings on which the tree of a search depends, beside the problem and x*.

    Parameters
    ----------
    method
        "loewner", the sharper criterion in doubles with proved rounding, or "thesis", the criterion
        of 1989 in exact decimals.
    depth
        The most cuts of a prism; None: 120, or 30 with the thesis's method.
    digits
        Decimal places of the thesis's rigorous arithmetic.
    stubborn
        Whether the search goes on after a prism that cannot be decided.
    as_printed
        Whether the thesis's listing is followed to the letter, which proves nothing.

    Raises
    ------
    ValueError
        A value is out of range, or two exclude each other.
    """

    method: str = "loewner"
    depth: Optional[int] = None
    digits: int = 35
    stubborn: bool = False
    as_printed: bool = False

    def __post_init__(self):
        if not isinstance(self.method, str) or self.method not in METHODS:
            raise ValueError("the method is one of %s, not %r" % (", ".join(METHODS), self.method))
        if self.depth is None:
            object.__setattr__(self, "depth", METHODS[self.method])
        for name, least in (("depth", 0), ("digits", 1)):
            object.__setattr__(self, name, whole_number(getattr(self, name), name, least, LIMIT))
        for name in "stubborn", "as_printed":
            if not isinstance(getattr(self, name), bool):
                raise ValueError("%s must be True or False, not %r" % (name, getattr(self, name)))
        if self.method == "loewner" and self.as_printed:
            raise ValueError("only the method thesis was ever printed: as_printed (--as-printed) "
                             "does not go with loewner")

    def accept(self, problem: Problem) -> Problem:
        """The problem as this method takes it: the thesis's method has neither frames nor a
        coordinate that is examined alone.

        Parameters
        ----------
        problem
            The problem as it was asked.

        Returns
        -------
        Problem
            The problem itself, or with the thesis's method, without a frame and `alone`.

        Raises
        ------
        ValueError
            The method cannot treat the problem.
        """
        if problem.shifts:
            raise ValueError("only the region of a further starting point moves with the "
                             "parameters, not that of a whole proof: give no shifts")
        if self.method != "thesis":
            return problem
        if problem.together:
            raise ValueError("parameters that move together (--together) need the method loewner "
                             "(--method loewner)")
        if not problem.by_ranges:
            raise ValueError("the method thesis takes three ranges of a, b and c; any other patch "
                             "or potential needs the method loewner (--method loewner)")
        return replace(problem, axes=IDENTITY, alone="no")
