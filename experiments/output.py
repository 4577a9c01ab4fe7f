"""Tables and figures, as these scripts write them."""

import contextlib
import csv
import io

from converse.draw.style import STYLE
from converse.storage import files
from converse.storage.files import ConverseError

CHART = {                               # of pictures in which values are read off
    **STYLE, "axes.grid": True, "axes.axisbelow": True, "grid.color": "0.92",
    "grid.linewidth": 0.6, "lines.markersize": 5,
}


def text(columns, rows):
    """The table, its floats with four digits."""
    table = io.StringIO(newline="")
    csv.writer(table, lineterminator="\n").writerows(
        [columns] + [["%.4g" % x if isinstance(x, float) else x for x in row] for row in rows])
    return table.getvalue()


def read(columns, path):
    """The rows of a table, in words.  ConverseError: it has other columns, or no rows."""
    header, *rows = csv.reader(io.StringIO(files.read_text(path, "table", ": is no such table")))
    if tuple(header) != columns or not rows:
        raise ConverseError("%s: is not a table of this script; measure anew" % path)
    return rows


@contextlib.contextmanager
def figure(look, **how):
    """An empty Figure, in a style while it is drawn."""
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", look]):
        yield Figure(**how)
