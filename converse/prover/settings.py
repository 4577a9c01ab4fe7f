"""The settings of a search, which problems they are for, and what a search can conclude."""

from dataclasses import dataclass, replace
from typing import Optional

from ..model.problem import IDENTITY, Problem

METHODS = {"thesis": 30, "loewner": 120}            # by name, the depth unless another is given
LIMIT = 100000                                      # of the depth and of the digits

THEOREM, REGION, UNDECIDED, AS_PRINTED = "theorem", "region", "undecided", "as printed"


@dataclass(frozen=True)
class Settings:
    """The settings on which the tree of a search depends, beside the problem and x*.

    Parameters
    ----------
    method
        "thesis", the criterion of 1989 in exact decimals, or "loewner", the sharper criterion in
        doubles with proved rounding.
    depth
        The most cuts of a prism; None: 30, or 120 with the sharper method.
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

    method: str = "thesis"
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
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= LIMIT:
                raise ValueError("%s must be a whole number from %d to %d, not %r"
                                 % (name, least, LIMIT, value))
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
