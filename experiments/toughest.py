"""Which ghost is toughest?  The onsets of many rotation vectors (trig).

    python experiments/toughest.py [DIRECTORY] [--quick] [--draw] [--jobs N]

Writes into DIRECTORY (build/toughest), and continues there when it was interrupted:
    sweep.csv     the onsets of a thousand vectors, well spread, of q from 300 to 1201
    search-K.csv  the same of vectors near the toughest, ever nearer and with ever larger q
    near.csv      approximants of one vector
    chapter.csv   the thesis's two vectors
    toughest.svg, frontier.svg
    toughest.csv  what both show

The onset of a vector is the eps above which the first Lyapunov exponent of its orbit exceeds 1/q
(orbits.onset).  All that is found here is seen, not proved: an onset at a larger eps speaks for a
torus near the vector up to there, and proves none.
"""

import argparse
import math
import os
import random
import sys

import numpy as np
import output
from sweep import onsets

from converse import orbits
from converse.commands.common import ended
from converse.draw import plot
from converse.draw.plot import BLUE, DARK, GREEN, ORANGE, VERMILLION
from converse.storage import files

TRIG = {"step": 0.0005, "width": 1e-5, "top": 0.02}

# 1/tau and 1/tau^2, tau^3 = tau + 1: their multiples modulo 1 fill the square evenly.
SPREAD = 0.7548776662466927, 0.5698402909980532
# Invariant tori were seen by Fourier series near this vector up to TORI.
NEAR = 0.295401276 + 0.003327283, 0.295401276 - 0.003327283
TORI = 0.0122
NO_TORI = 0.01389, 0.0272               # for every larger eps: by this program, and in 1989
TORUS_UP_TO = 0.010                     # a torus is proved for every eps from 0 (tori.md)
TORUS_AT = 0.011, 0.0115, 0.0120, 0.0121, 0.0122    # and for these
TOP = 0.0335                            # of the picture
CHAPTER = ((1432, 1897), 2513), ((377, 2330), 3770)
RESONANCES = [(k0, k1) for k0 in range(4) for k1 in range(-3, 4)
              if 0 < k0 + abs(k1) <= 3 and math.gcd(k0, k1) == 1 and (k0 or k1 == 1)]

SIZES = {"full": {"vectors": 1000, "q": (300, 1200), "rounds": 7, "children": 4, "near": 7000},
         "quick": {"vectors": 40, "q": (100, 300), "rounds": 2, "children": 1, "near": 600}}
PARENTS = 8                             # of a round of the search


# ---- vectors

def folded(w):
    """The vector that stands for all that trig's orbits do not tell apart: those that time's
    direction, whole numbers or an exchange of the angles turn into each other."""
    w0, w1 = sorted((x % 1 for x in w), reverse=True)
    return (w0, w1) if w0 + w1 <= 1 else (1 - w1, 1 - w0)


def rational(w, q):
    """The type of size q, or the next one that has lowest terms, nearest to w."""
    while True:
        p = tuple(round(x * q) for x in w)
        if math.gcd(*p, q) == 1:
            return p, q
        q += 1


def spread(count, sizes):
    rng = random.Random(1)
    return [rational(folded([k * x for x in SPREAD]), rng.randint(*sizes))
            for k in range(1, count + 1)]


def approximants(w, most, quality=0.9, least=30):
    """The types with |q w - p| < quality / sqrt q in both coordinates."""
    q = np.arange(least, most)[:, None]
    p = np.round(q * w)
    good = np.abs(q * w - p).max(1) * np.sqrt(q[:, 0]) < quality
    return [(tuple(map(int, each)), int(size)) for each, size in zip(p[good], q[good, 0])
            if math.gcd(*map(int, each), int(size)) == 1]


# ---- onsets

def middle(table):
    return (table["eps_below"] + table["eps_above"]) / 2


def types(table):
    return [(tuple(map(int, p)), int(q)) for p, q in zip(table["p"], table["q"])]


def toughest(table, count):
    """Of a table, those rows that last longest, longest first."""
    table = table[np.isfinite(middle(table))]
    return table[np.argsort(-middle(table), kind="stable")[:count]]


def search(first, sizes, find):
    """Rounds of vectors near the toughest known, each half as far as those before it."""
    best = toughest(first, PARENTS)
    low, high = sizes["q"]
    rng = random.Random(2)
    for k in range(sizes["rounds"]):
        low, high = max(low, high // 2), high * 6 // 5
        children = [rational(folded([rng.gauss(p[i] / q, 0.02 / 2 ** k) for i in (0, 1)]),
                             rng.randint(low, high))
                    for p, q in types(best) for _ in range(sizes["children"])]
        found = find("search-%d.csv" % k, orbits.trig, children, **TRIG)
        best = toughest(np.concatenate([best, found]), PARENTS)
    return best


# ---- pictures



def draw(path, size, fill, *arguments):
    with output.figure(plot.STYLE, figsize=size) as figure:
        fill(figure, *arguments)
        files.write(path, plot.encode(figure, "svg", pad_inches=0.08))


def draw_map(figure, table, best):
    from matplotlib.patches import Polygon

    axes = figure.subplots()
    inside = axes.add_patch(Polygon([(0, 0), (1, 0), (0.5, 0.5)], facecolor="none",
                                    edgecolor="0.75", linewidth=0.7))
    for k0, k1 in RESONANCES:
        for m in range(-3, 4):
            ends = [(m / k0, 0), ((m - k1 / 2) / k0, 0.5)] if k0 else [(0, m / k1), (1, m / k1)]
            line, = axes.plot(*zip(*ends), color="0.85", linewidth=0.7, zorder=0)
            line.set_clip_path(inside)
    table = table[np.isfinite(middle(table))]
    shown = axes.scatter(*(table["p"] / table["q"][:, None]).T, c=middle(table), s=12, vmin=0,
                         vmax=0.0125, cmap="viridis", linewidths=0)
    mark = {"facecolor": "none", "edgecolor": DARK, "linewidth": 1.2}
    axes.scatter(*(best["p"][:1] / best["q"][:1, None]).T, marker="*", s=80, **mark,
                 label="the toughest that the search met")
    axes.scatter(*NEAR, marker="D", s=30, **mark, label="tori seen by Fourier series, to %g" % TORI)
    axes.set(xlim=(0, 1), ylim=(0, 0.54), aspect="equal", xlabel="$w_0$", ylabel="$w_1$",
             title="The onsets of %d rotation vectors (trig)" % len(table))
    axes.legend(loc="upper left", bbox_to_anchor=(0.57, 1.02))
    figure.colorbar(shown, ax=axes, shrink=0.55, label="onset (ε)")
    axes.text(0, -0.2, "Onset: the ε above which the first Lyapunov exponent exceeds 1/q; seen, "
              "not proved; q from %d to %d.\nGrey: resonances, $k\\cdot w$ whole, "
              "$|k_0| + |k_1|$ up to 3.  All other vectors are mirror images of these."
              % (table["q"].min(), table["q"].max()), transform=axes.transAxes,
              va="top", color="0.35")


def draw_frontier(figure, table, last, chapter):
    strips, curve = figure.subplots(2, 1, sharex=True,
                                    gridspec_kw={"hspace": 0.12, "height_ratios": (3, 2)})
    new, old = NO_TORI
    strips.barh(2, TORUS_UP_TO, color=GREEN)
    strips.plot(TORUS_AT, [2] * len(TORUS_AT), "s", color=GREEN, markersize=5,
                markeredgecolor="white", markeredgewidth=0.6)
    strips.annotate("%.4f" % TORUS_AT[-1], (TORUS_AT[-1], 2), (5, 0), va="center", color=GREEN,
                    textcoords="offset points")
    strips.barh(1, TORI, color=ORANGE, alpha=0.35)
    strips.plot(last, 1, "*", color=VERMILLION, markersize=8)
    strips.annotate("the last onset, %.4f" % last, (last, 1), (9, 0), va="center",
                    textcoords="offset points", color=VERMILLION)
    strips.text(0.0003, 1, "tori, Fourier series, to %g" % TORI, va="center")
    strips.barh(0, TOP - new, left=new, color=BLUE)
    strips.barh(0, TOP - old, left=old, color=DARK)
    for x, words in ((new, "%g" % new), (old, "1989: %g" % old)):
        strips.text(x + 0.0003, 0, words, va="center", color="white")
    strips.axvspan(TORUS_AT[-1], new, color="0.92", linewidth=0, zorder=0)
    strips.text((TORUS_AT[-1] + new) / 2, 2.62, "open", ha="center", va="center")
    strips.set(ylim=(-0.5, 2.85), title="Where the tori of a = b = c/2 = 11.21436 ε end")
    strips.set_yticks([2, 1, 0], ["PROVED:\na torus", "SEEN", "PROVED:\nno torus"])
    strips.tick_params(left=False)
    eps = np.sort(middle(table)[np.isfinite(middle(table))])
    curve.step([0, *eps], 100 * np.arange(len(eps), -1, -1) / len(eps), where="post", color=ORANGE)
    curve.plot(chapter, [100 * (eps > x).mean() for x in chapter], "o", color=DARK, markersize=4,
               label="the thesis's two vectors")
    curve.set(xlim=(0, TOP), ylim=(0, 103), xlabel="ε", ylabel="vectors before\ntheir onset (%)")
    curve.text(0.0135, 60, "SEEN: of %d rotation vectors, q = %d to %d, the share\nwhose orbits "
               "have a first exponent of at most 1/q" % (len(eps), table["q"].min(),
                                                         table["q"].max()), va="center")
    curve.legend(loc="lower right")


# ---- what is shown

SETS = "sweep", "search", "near", "chapter"
COLUMNS = "set", "p", "q", "eps_below", "eps_above"


def write(path, shown):
    """The tables of SETS in one CSV file."""
    files.write_text(path, output.text(COLUMNS, (
        (name, "%d %d" % tuple(row["p"]), row["q"], *("%.7g" % row[end] for end in COLUMNS[3:]))
        for name, table in zip(SETS, shown) for row in table)))


def read(path):
    """The tables of SETS from such a file."""
    rows = output.read(COLUMNS, path)
    kinds = [("p", "i8", (2,)), ("q", "i8"), ("eps_below", "f8"), ("eps_above", "f8")]
    return [np.array([(tuple(map(int, p.split())), int(q), float(low), float(high))
                      for each, p, q, low, high in rows if each == name], dtype=kinds)
            for name in SETS]


def pictures(directory):
    """Draws toughest.svg and frontier.svg from toughest.csv."""
    def path(name):
        return os.path.join(directory, name)

    table, best, near, chapter = read(path("toughest.csv"))
    long = best[best["q"] >= near["q"].min()]       # short orbits have late onsets
    last = middle(toughest(np.concatenate([long, near]), 1))[0]
    draw(path("toughest.svg"), (8.4, 4.4), draw_map, table, best)
    draw(path("frontier.svg"), (7.2, 3.9), draw_frontier, table, last, middle(chapter))


# ---- all together

def main():
    p = argparse.ArgumentParser(description="Which ghost is toughest?")
    p.add_argument("directory", nargs="?", default=os.path.join("build", "toughest"))
    p.add_argument("--quick", action="store_true", help="few vectors, small q: seconds")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="vectors at a time")
    p.add_argument("--draw", action="store_true", help="draw toughest.csv, which is there")
    options = p.parse_args()
    if options.draw:
        pictures(options.directory)
        return 0
    sizes = SIZES["quick" if options.quick else "full"]
    os.makedirs(options.directory, exist_ok=True)

    def path(name):
        return os.path.join(options.directory, name)

    def find(name, potential, vectors, **how):
        table = onsets(potential, list(vectors), file=path(name), jobs=options.jobs, **how)
        print("%s: %d types, %d lost" % (name, len(table), (table["label"] == "lost").sum()),
              flush=True)
        return table

    table = find("sweep.csv", orbits.trig, spread(sizes["vectors"], sizes["q"]), **TRIG)
    best = search(table, sizes, find)
    chapter = find("chapter.csv", orbits.trig, CHAPTER, **TRIG)
    near = find("near.csv", orbits.trig, approximants(NEAR, sizes["near"]), **TRIG)
    for eps in (0.004, 0.006, 0.008, 0.010, 0.011, 0.012):
        print("before their onset at %.3f: %4.1f %%" % (eps, 100 * (middle(table) > eps).mean()))
    print("the toughest:")
    for row in best:
        w0, w1 = row["p"] / row["q"]
        print("    (%d, %d)/%d = (%.6f, %.6f) at %.5f" % (*row["p"], row["q"], w0, w1, middle(row)))
    print("approximants of (%.9f, %.9f):" % NEAR)
    for row in near:
        print("    (%d, %d)/%d at %.5f" % (*row["p"], row["q"], middle(row)))
    long = near[near["q"] >= sizes["near"] // 3]
    write(path("toughest.csv"), (table, best, long, chapter))
    pictures(options.directory)
    return 0


if __name__ == "__main__":
    sys.exit(ended("toughest", main, lambda: "the same command continues"))
