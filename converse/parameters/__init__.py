"""Maps of the frontier: for which (a, b, c) is it proved that there are no invariant tori?

    from converse import parameters
    found = parameters.explore("a=b", "1.05", path="map.json")
    print(found.report())
    found.draw("map.svg")
"""

from typing import TYPE_CHECKING

from .map import Node, ParameterMap
from .region import REGIONS, Cell

if TYPE_CHECKING:
    from .search import explore

__all__ = ["Cell", "Node", "ParameterMap", "REGIONS", "explore"]


def __getattr__(name):
    """Imports explore when it is asked for: without the C core a map can still be described."""
    if name == "explore":
        from .search import explore
        return explore
    raise AttributeError("module 'converse.parameters' has no attribute %r" % name)
