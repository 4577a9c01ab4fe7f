"""Diagrams: where along one or two parameters of a family of maps there are no invariant tori, and
where there are.

    from converse import FourierMap, diagram
    found = diagram.explore(FourierMap({1: {"K": 1}, 2: "0.2"}, K=("0", "3")), points=10 ** 7)
    print(found.report())
"""

from typing import TYPE_CHECKING

from .value import Diagram, Existence

if TYPE_CHECKING:
    from .run import explore

__all__ = ["Diagram", "Existence", "explore"]


def __getattr__(name):
    """Imports explore when it is asked for: without the C core a diagram can still be described."""
    if name == "explore":
        from .run import explore
        return explore
    raise AttributeError("module 'converse.diagram' has no attribute %r" % name)
