"""A Figure of matplotlib that a notebook shows.  Imported only where there is matplotlib."""

from matplotlib.figure import Figure

from . import plot


class Page(Figure):
    """A Figure that no window and no notebook's backend knows of: it draws itself."""

    def _repr_png_(self):
        return plot.encode(self, "png", dpi=100)
