"""Maps of the frontier: for which (a, b, c) is it proved that there are no invariant tori?

    from converse import frontier
    atlas = frontier.explore("a=b", "1.05", path="map.json")
    print(atlas.report())
    atlas.draw("map.svg")
"""

from .atlas import Map, Node
from .region import REGIONS, Cell
from .search import explore

__all__ = ["Cell", "Map", "Node", "REGIONS", "explore"]
