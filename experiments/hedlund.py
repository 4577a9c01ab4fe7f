"""Hedlund's pathology: with two degrees of freedom the least orbit of a type, run through twice,
need not be the least of the doubled type.  With one it is (Aubry).

    python experiments/hedlund.py [--eps EPS ...] [--type P0,P1,Q] [--times N] [--figure FILE]

For the map of trig: proves that every orbit of type (5, 7)/9 has more action per point than one of
type (10, 14)/18, first for each EPS and then, without --eps, for all eps from where it begins to
0.08; and that just below, the least orbit of type (10, 14)/18 is that of type (5, 7)/9 run through
twice.  --figure draws the gain against eps and both orbits.  One or two minutes.
"""

import argparse
import sys

import numpy as np
from least_action import enclosed_action, least_action

from converse import ConverseError, orbits

EPS = [0.05, 0.055, 0.06, 0.065, 0.07, 0.075, 0.08]
FROM, TO = 0.03, 0.08                   # where a beginning is looked for
DIGITS = 7                              # to which it is proved


class Types:
    """A type, the same times n, and what is known of their least actions."""

    def __init__(self, p, q, times):
        self.p, self.q, self.times = p, q, times
        self.short, self.long = {}, {}

    def least(self, eps):
        """The short type's."""
        if eps not in self.short:
            self.short[eps] = least_action(orbits.trig, self.p, self.q, eps, gap=0)
        return self.short[eps]

    def least_long(self, eps):
        if eps not in self.long:
            self.long[eps] = least_action(
                orbits.trig, tuple(self.times * i for i in self.p), self.times * self.q, eps, gap=0)
        return self.long[eps]

    def names(self):
        short = "(%d, %d)/%d" % (*self.p, self.q)
        return short, "(%d, %d)/%d" % (*(self.times * i for i in self.p), self.times * self.q)


def at(types, eps):
    """Prints what is proved at one eps."""
    short, long = types.least(eps), types.least_long(eps)
    one, many = types.names()
    if short.low > long.high:
        found = ("every state of type %s has an action per point of %r or more, one of type %s has "
                 "%r or less: a gain of %.2e.  Proved."
                 % (one, short.low, many, long.high, short.low - long.high))
    elif long.copies % types.times == 0:
        found = ("the state of least action of type %s is an orbit of type %s run through %d "
                 "times; %.16f per point.  Proved." % (many, one, types.times, long.high))
    else:
        found = ("not decided: the least action per point lies from %r to %r for %s and from %r to "
                 "%r for %s." % (short.low, short.high, one, long.low, long.high, many))
    print("eps %r: %s" % (eps, found), flush=True)


def gains(types, eps, long):
    """By how much the long state, followed to this eps, has less action per point than the short
    one: seen, not proved."""
    return types.least(TO).state.relax(eps).action - long.relax(eps).action


def beginning(types, long):
    """The eps where both have the same action, by bisection, if it is between FROM and TO."""
    low, high = FROM, TO
    while high - low > 1e-12:
        middle = (low + high) / 2
        low, high = (low, middle) if gains(types, middle, long) > 0 else (middle, high)
    return high


def everywhere(types, long, first, last):
    """Proves it for all eps from first to last; returns in how many pieces.

    The least action is the least of functions that are linear in eps, the states' kinetic part less
    eps times their sum of V: so it is concave and, between two eps, no less than the straight line
    between bounds of it there.  The action of one state of the long type is such a linear
    function: if it is less than these bounds at both eps, it is less between them."""
    state = long.relax((first + last) / 2)
    ends = [(types.least(eps).low, orbits.PeriodicOrbit(
        orbits.trig, state.p, state.q, eps, state.u, state.origin)) for eps in (first, last)]
    if all(low > enclosed_action(there)[1] for low, there in ends):
        return 1
    middle = round((first + last) / 2, DIGITS + 1)
    if not first < middle < last:
        raise ConverseError("not proved from eps %r to %r" % (first, last))
    return everywhere(types, long, first, middle) + everywhere(types, long, middle, last)


def draw(types, long, begins, file):
    from matplotlib import style
    from matplotlib.figure import Figure

    from converse.draw import plot

    eps = np.linspace(max(FROM, begins - 0.01), TO, 60)
    gain = np.array([gains(types, e, long) for e in eps])
    proved = [(e, types.short[e].low - types.long[e].high) for e in sorted(types.long)]
    none = [e for e in sorted(types.long) if types.long[e].copies % types.times == 0]
    with style.context(["default", plot.STYLE]):
        figure = Figure(figsize=(9.2, 3.0))     # three panels of the same height
        axes, *planes = figure.subplots(1, 3, gridspec_kw={"wspace": 0.3,
                                                           "width_ratios": (1.5, 1, 1)})
        axes.axhline(0, color="0.8", linewidth=0.8)
        axes.plot(eps, 1e6 * gain, color=plot.BLUE, label="followed: seen")
        axes.plot(*np.array([(e, 1e6 * g) for e, g in proved if g > 0]).reshape(-1, 2).T, "o",
                  color=plot.VERMILLION, markersize=4, label="proved")
        axes.plot(*np.array([(e, 0) for e in none]).reshape(-1, 2).T, "s", color="0.35",
                  markersize=4, label="no gain: proved")
        axes.set(xlabel="ε", ylabel=r"$10^6$ times the gain per point",
                 title="%s has less action than %s" % types.names()[::-1])
        axes.legend()
        axes.set_box_aspect(1 / 1.5)
        x = (np.arange(100) + 0.5) / 100
        grid = np.stack(np.meshgrid(x, x, indexing="ij"), -1).reshape(-1, 2)
        value = orbits.trig.evaluate(grid)[0].reshape(100, 100).T
        for axes, name, state, colour in zip(planes, types.names(), (types.least(TO).state, long),
                                             ("0.25", plot.VERMILLION)):
            axes.contour(x, x, value, 9, colors="0.85", linewidths=0.6)
            axes.plot(*state.x.T, "o", color=colour, markersize=3)
            axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="$x_0$", ylabel="$x_1$",
                     title="%s, ε = %g" % (name, TO))
        data = plot.encode(figure, file.rpartition(".")[2], dpi=150)
    with open(file, "wb") as out:
        out.write(data)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--eps", nargs="+", type=float, help="for these alone")
    parser.add_argument("--type", default="5,7,9", help="p0,p1,q (5,7,9)")
    parser.add_argument("--times", type=int, default=2, help="the longer type's multiple (2)")
    parser.add_argument("--figure", metavar="FILE", help="SVG, PNG or PDF")
    options = parser.parse_args(arguments)
    try:
        *p, q = map(int, options.type.split(","))
        types = Types(tuple(p), q, options.times)
        for eps in options.eps or EPS:
            at(types, eps)
        if options.eps and not options.figure:
            return
        long = types.least_long(TO).state
        begins = beginning(types, long)
        if not options.eps and types.least(TO).low > types.long[TO].high:
            unit = 10.0 ** -DIGITS
            below, above = (round(unit * round(begins / unit + k), DIGITS) for k in (-1, 1))
            print("Both have the same action at eps %.10f: seen." % begins)
            at(types, below)
            at(types, above)
            pieces = everywhere(types, long, above, TO)
            print("For all eps from %r to %r every state of type %s has more action per point than "
                  "one of type %s.  Proved, in %d pieces." % (above, TO, *types.names(), pieces))
        if options.figure:
            draw(types, long, begins, options.figure)
    except (ConverseError, ValueError, OSError) as error:
        sys.exit("hedlund.py: %s" % error)


if __name__ == "__main__":
    main()
