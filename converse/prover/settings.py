"""The settings of a search, which problems they are for, and what a search can conclude."""

from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Dict, Optional

if TYPE_CHECKING:
    from ..model.problem import Problem

METHODS = {"thesis": 30, "loewner": 120}            # by name, the depth unless another is given
LIMIT = 100000                                      # of the depth and of the digits

# Why a search ended without a theorem: Proof.ended.
HOPELESS, LENGTH, DEPTH, DOUBLES, TIME = (
    "hopeless as seen", "limit of length", "limit of depth", "limit of doubles", "time")
THEOREM, REGION, UNDECIDED, AS_PRINTED = "theorem", "region", "undecided", "as printed"


def _setting(default, flags, text, **how):
    """A row of the table of settings: from it follow the flags of the command, the keyword of
    prove(), its checks, what a run may be continued with, and the line of a proof file.

    least -- of a whole number, of LIMIT at most; metavar -- as of argparse, as `choices` is
    only -- the method that alone has the setting, and that is chosen where it is given
    may_change -- may a run be continued with another value?"""
    return field(default=default, metadata={"flags": flags, "help": text, **how})


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

    method: str = _setting(
        "loewner", ["--method"], "the thesis's criterion (default of an input with ranges of a, b "
        "and c), or the sharper one, in rigorous double precision (default of any other)",
        choices=tuple(METHODS))
    depth: Optional[int] = _setting(
        None, ["-d", "--depth"], "give up on a prism that was cut N times (default %d; loewner: "
        "%d)" % (METHODS["thesis"], METHODS["loewner"]), least=0, metavar="N", may_change=True)
    digits: int = _setting(
        35, ["-p", "--precision"], "decimal places of the thesis's rigorous arithmetic (default "
        "35)", least=1, metavar="DP", only="thesis")
    stubborn: bool = _setting(
        False, ["-s", "--stubborn"], "go on after a prism that cannot be decided", may_change=True)
    as_printed: bool = _setting(
        False, ["--as-printed"], "follow the thesis's listing to the letter; not a proof",
        only="thesis")

    def __post_init__(self):
        from ..model.exact import whole_number  # late, for the parser needs none of it

        if not isinstance(self.method, str) or self.method not in METHODS:
            raise ValueError("the method is one of %s, not %r" % (", ".join(METHODS), self.method))
        if self.depth is None:
            object.__setattr__(self, "depth", METHODS[self.method])
        for each in fields(self):
            name, how, value = each.name, each.metadata, getattr(self, each.name)
            if "least" in how:
                value = whole_number(value, name, how["least"], LIMIT)
                object.__setattr__(self, name, value)
            elif isinstance(each.default, bool) and not isinstance(value, bool):
                raise ValueError("%s must be True or False, not %r" % (name, value))
            if value != each.default and self.method != how.get("only", self.method):
                raise ValueError("%s (%s) is of the method %s alone, not of %s; leave one of them "
                                 "out" % (name, how["flags"][-1], how["only"], self.method))

    @classmethod
    def of(cls, given: Dict[str, Any]) -> "Settings":
        """The settings with these values, by name.  What one method alone has chooses it.

        Parameters
        ----------
        given
            Values by name.

        Raises
        ------
        TypeError, ValueError
            There is no such setting, or the values are not as described.
        """
        only = [each.metadata["only"] for each in fields(cls)
                if "only" in each.metadata and given.get(each.name)]
        return cls(**{**dict(zip(["method"], only)), **given})

    def accept(self, problem: "Problem") -> "Problem":
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
        return replace(problem, axes=(1, 0, 0, 1), alone="no")


SETTINGS = [each.name for each in fields(Settings)]
MAY_CHANGE = {each.name for each in fields(Settings) if "may_change" in each.metadata}
# Those that a proof file has a line for; its claim says the others.
FILED = [name for name in SETTINGS if name not in ("method", "as_printed")]
