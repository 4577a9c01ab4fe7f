"""The figures of the thesis's chapter 2 and Appendix A, and the standard map's of chapter 1.  (Not
chapter 1's other two, of a star's motion and of a torus, which are drawn after other books.)

The captions of the thesis say what is shown, but seldom for which size of the perturbation.  Where
a figure had to choose, its caption says so.  Needs matplotlib (the extra "plot"), whose settings
are not changed.
"""

import functools
import os

from converse.draw import plot
from converse.storage import files

from . import appendix, hedlund, shared, states, twist_maps

FIGURES = {                             # the order of the thesis: width and height in inches
    "std-demo": (7.2, 2.9, twist_maps.std_demo),
    "cyl-def": (3.6, 2.8, twist_maps.cyl_def),
    "twist": (6.4, 2.8, twist_maps.twist),
    "billiards": (3.6, 3.0, twist_maps.billiards),
    "cantorus": (6.0, 3.8, twist_maps.cantorus),
    "pert-maps": (7.2, 3.1, states.pert_maps),
    "Lyaps": (6.4, 8.4, states.lyaps),
    **{name: (6.2, 3.25 * len(sizes), functools.partial(states.orbits_pairs, name=name))
       for name, (_, _, sizes, _) in states.ORBITS.items()},
    "smooth": (6.4, 7.8, states.smooth),
    "hed1": (4.0, 4.2, hedlund.hed1),
    "hed2": (6.4, 3.0, hedlund.hed2),
    "deev": (6.0, 6.0, hedlund.deev),
    "hed_st": (7.2, 8.0, hedlund.hed_st),
    "tree": (6.0, 2.2, appendix.tree),
    "trimed": (4.2, 2.4, appendix.trimed),
    "tri": (6.4, 3.2, appendix.tri),
}


def draw(name, kind="svg", families=None, caption=True):
    """One of the FIGURES as the bytes of a file of that kind: "svg", "png" or "pdf"; with a caption
    or without."""
    check([name], kind)
    width, height, fill = FIGURES[name]
    families = shared.Families() if families is None else families

    def drawn(figure):
        words = fill(figure, families)
        return words if caption else None

    return plot.written(width, height, kind, drawn)


def check(names, kind):
    """Finds out before the work starts what is wrong with an order for figures."""
    plot.check()
    if kind not in plot.FORMATS:
        raise ValueError("figures are %s, not %s" % (", ".join(plot.FORMATS), kind))
    for name in names:
        if name not in FIGURES:
            raise ValueError("there is no figure %s; there are %s" % (name, ", ".join(FIGURES)))


def figures(directory, only=None, kind="svg", progress=None, caption=True):
    """Draws the figures, or only those named, into NAME.svg (or "png", "pdf") in a directory, which
    is made if need be, with captions or without; returns the paths.  progress(path) is called after
    each."""
    names = list(FIGURES) if only is None else list(only)
    check(names, kind)
    try:
        os.makedirs(directory, exist_ok=True)
    except OSError as error:
        raise files.ConverseError("%s: cannot be made a directory (%s); name another place"
                                  % (directory, files.reason(error))) from None
    paths = [os.path.join(directory, "%s.%s" % (name, kind)) for name in names]
    for path in paths:
        files.check_output(path, "figure", [kind])
    families = shared.Families()
    for name, path in zip(names, paths):
        files.write(path, draw(name, kind, families, caption))
        if progress is not None:
            progress(path)
    return paths
