"""A Figure of matplotlib that a notebook shows.  Imported only where there is matplotlib."""

from matplotlib.figure import Figure


class Page(Figure):
    """A Figure that no window and no notebook's backend knows of: it draws itself, by `encode`."""

    def __init__(self, encode, **options):
        super().__init__(**options)
        self.encode = encode

    def _repr_png_(self):
        return self.encode(self, "png", dpi=100)
