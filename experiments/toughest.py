"""Which ghost is toughest?  Where the orbits of many rotation vectors turn hyperbolic (trig).

    python experiments/toughest.py [DIRECTORY] [--quick] [--jobs N]

Writes into DIRECTORY (build/toughest), and continues there when it was interrupted:
    sweep.csv     where a thousand vectors, well spread, turn hyperbolic, of q from 300 to 1200
    search-K.csv  the same of vectors near the toughest, ever nearer and with ever larger q
    near.csv, near-fixed.csv, golden.csv, golden-fixed.csv    approximants of one vector
    map.svg, sequence.svg, frontier.svg

All that is seen here is seen, not proved.  Of a periodic orbit that is not hyperbolic one cannot say
that a torus is there: only that there is none of those things yet that are left of one.
"""

import argparse
import concurrent.futures
import math
import os
import random

import numpy as np

from converse import files, orbits, picture

TRIG = {"step": 0.0005, "width": 1e-5, "top": 0.02}
STANDARD = {"step": 0.02, "width": 1e-5, "top": 1.5}
FIXED = 1e-3                            # the other criterion: an exponent, whatever q is

# The two numbers whose multiples modulo 1 are spread most evenly over the square that are known: powers
# of the spiral mean's tau.
SPREAD = 0.7548776662466927, 0.5698402909980532
# Invariant tori were seen by Fourier series near this vector up to TORI.
NEAR = 0.295401276 + 0.003327283, 0.295401276 - 0.003327283
TORI = 0.0121
PROVED = (("this program", 0.0141), ("the thesis, 1989", 0.0272))     # no tori from there on
CHAPTER = ((1432, 1897), 2513), ((377, 2330), 3770)
K_C = 0.971635406                       # where the standard map's golden torus breaks up (Greene)
RESONANCES = [(k0, k1) for k0 in range(4) for k1 in range(-3, 4)
              if 0 < k0 + abs(k1) <= 3 and math.gcd(k0, k1) == 1 and (k0 or k1 == 1)]

SIZES = {"full": {"vectors": 1000, "q": (300, 1200), "rounds": 7, "children": 4, "near": 7000,
                  "golden": 3000},
         "quick": {"vectors": 40, "q": (100, 300), "rounds": 2, "children": 1, "near": 600,
                   "golden": 400}}
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


def golden(most):
    p, q = 1, 2
    while q < most:
        if q > 20:
            yield (p,), q
        p, q = q, p + q


# ---- where they turn hyperbolic

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

STYLE = {**picture.SALT, "font.size": 8, "legend.frameon": False, "axes.spines.top": False,
         "axes.spines.right": False, "lines.linewidth": 1}
BLUE, ORANGE, DARK = "#1f5f94", "#d98a2b", "0.15"


def draw(path, size, fill, *arguments):
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE]):
        figure = Figure(figsize=size)
        fill(figure, *arguments)
        files.write(path, picture.encode(figure, "svg", pad_inches=0.08))


def draw_map(figure, table, best):
    axes = figure.subplots()
    for k0, k1 in RESONANCES:
        for m in range(-3, 4):
            ends = [(m / k0, 0.0), ((m - k1 * 0.5) / k0, 0.5)] if k0 else [(0, m / k1), (1, m / k1)]
            axes.plot(*zip(*ends), color="0.85", linewidth=0.7, zorder=0)
    table = table[np.isfinite(middle(table))]
    shown = axes.scatter(*(table["p"] / table["q"][:, None]).T, c=middle(table), s=11, cmap="viridis",
                         vmin=0, vmax=0.0125, linewidths=0)
    axes.scatter(*(best["p"][:1] / best["q"][:1, None]).T, marker="*", s=70, facecolor="none",
                 edgecolor="red", linewidth=0.8, label="the toughest found by the search")
    axes.scatter(*NEAR, marker="D", s=28, facecolor="none", edgecolor="red", linewidth=0.8,
                 label="tori seen by Fourier series up to %g" % TORI)
    axes.set(xlim=(0, 1), ylim=(0, 0.505), aspect="equal", xlabel="$w_0$", ylabel="$w_1$",
             title="Where the orbits of %d rotation vectors turn hyperbolic (trig)" % len(table))
    axes.legend(loc="upper left")
    figure.colorbar(shown, ax=axes, shrink=0.55, label=r"$\varepsilon$")
    axes.text(0, -0.2, "seen, not proved; q from %d to %d.  All other vectors are mirror images of these.  "
              "Grey: resonances $k\\cdot w$ = integer, $|k_0| + |k_1|$ up to 3."
              % (table["q"].min(), table["q"].max()), transform=axes.transAxes, fontsize=7,
              color="0.35")


def draw_sequence(figure, near, near_fixed, gold, gold_fixed):
    left, right = figure.subplots(1, 2, gridspec_kw={"wspace": 0.3})
    for axes, free, fixed, title in (
            (left, gold, gold_fixed, "the standard map, golden mean"),
            (right, near, near_fixed, "trig, (%.6f, %.6f)" % NEAR)):
        axes.plot(fixed["q"], middle(fixed), "o", color="0.65", markersize=3.5,
                  label="first exponent above %g" % FIXED)
        axes.plot(free["q"], middle(free), "s", color=BLUE, markersize=3.5,
                  label="first exponent above 1/q")
        axes.set(xscale="log", xlabel="q", title=title)
        axes.grid(color="0.93")
    left.axhline(K_C, color=ORANGE, zorder=0)
    left.annotate("0.971635: it breaks up", (1, K_C), (-2, -10), ha="right",
                  xycoords=("axes fraction", "data"), textcoords="offset points", color=ORANGE)
    left.set_ylabel("k where the orbit turns hyperbolic")
    right.axhline(TORI, color=ORANGE, zorder=0)
    right.annotate("%g: tori seen by Fourier series" % TORI, (1, TORI), (-2, 4), ha="right",
                   xycoords=("axes fraction", "data"), textcoords="offset points", color=ORANGE)
    right.set_ylabel(r"$\varepsilon$ where the orbit turns hyperbolic")
    left.legend(loc="lower right", bbox_to_anchor=(1, 0.1))


def draw_frontier(figure, table, last, chapter):
    axes = figure.subplots()
    eps = np.sort(middle(table)[np.isfinite(middle(table))])
    share = 100 * (1 - np.arange(1, len(eps) + 1) / len(eps))
    share[-1] = share[-2]               # as far as the last one
    axes.fill_between(np.concatenate([[0], eps]), np.concatenate([[100], share]), 0.05, step="post",
                      color=BLUE, alpha=0.25, linewidth=0)
    axes.step(np.concatenate([[0], eps]), np.concatenate([[100], share]), where="post", color=BLUE)
    (program, bound), (thesis, old) = PROVED
    top = 0.03
    axes.axvspan(bound, top, color=DARK, alpha=0.16, linewidth=0)
    axes.axvspan(old, top, color=DARK, alpha=0.3, linewidth=0)
    axes.set(yscale="log", xlim=(0, top), ylim=(0.05, 130), xlabel=r"$\varepsilon$",
             ylabel="share of rotation vectors (%)")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.text(bound + 0.0004, 60, "PROVED by %s:\nno tori, whatever their\nrotation vector, from %g on"
              % (program, bound), va="top", fontsize=8)
    axes.text(old + 0.0002, 0.07, "%s: %g" % (thesis, old), rotation=90, va="bottom", fontsize=8)
    axes.text(0.0004, 0.07, "SEEN: orbits of so many of\n%d vectors (q = %d to %d)\nare not yet hyperbolic"
              % (len(eps), table["q"].min(), table["q"].max()), va="bottom", fontsize=8, color=BLUE)

    def mark(x, y, words, marker, **options):
        axes.plot(x, y, marker, color=ORANGE, markersize=6, zorder=3)
        axes.annotate(words, (x, y), **{"textcoords": "offset points", "fontsize": 7.5, **options})

    for x in chapter:
        axes.plot(x, 30, "|", color=ORANGE, markersize=6)
    mark(np.mean(chapter), 30, "the thesis's two vectors", "|", xytext=(0, 8), ha="center")
    mark(TORI, 0.3, "smooth tori seen\nby Fourier series", "D", xytext=(-8, 0), ha="right", va="center",
         color="0.25")
    mark(last, 0.7, "the toughest orbits\nseen, q in the thousands", "*", xytext=(-8, 6), ha="right",
         va="center", color="0.25")
    axes.annotate("", (last, 12), (bound, 12), arrowprops={"arrowstyle": "<->", "color": "0.3"})
    axes.annotate("open", ((last + bound) / 2, 12), (0, 4), textcoords="offset points", ha="center",
                  fontsize=7.5)
    axes.set_title("Where order ends: what is seen, what is proved (trig, a = b = c/2 = 11.21436 "
                   r"$\varepsilon$)", fontsize=9)


# ---- all together

def main():
    p = argparse.ArgumentParser(description="Which ghost is toughest?")
    p.add_argument("directory", nargs="?", default=os.path.join("build", "toughest"))
    p.add_argument("--quick", action="store_true", help="few vectors, small q: seconds")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), help="vectors at a time")
    options = p.parse_args()
    sizes = SIZES["quick" if options.quick else "full"]
    os.makedirs(options.directory, exist_ok=True)

    def path(name):
        return os.path.join(options.directory, name)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as executor:
        def find(name, potential, vectors, **how):
            table = orbits.onsets(potential, list(vectors), executor, path(name), **how)
            print("%s: %d types, %d lost" % (name, len(table), (table["label"] == "lost").sum()),
                  flush=True)
            return table

        table = find("sweep.csv", orbits.trig, spread(sizes["vectors"], sizes["q"]), **TRIG)
        best = search(table, sizes, find)
        chapter = find("chapter.csv", orbits.trig, CHAPTER, **TRIG)
        near, gold = approximants(NEAR, sizes["near"]), list(golden(sizes["golden"]))
        sequences = [find("%s%s.csv" % (name, end), potential, vectors, **how, **criterion)
                     for name, potential, vectors, how in (("near", orbits.trig, near, TRIG),
                                                           ("golden", orbits.standard, gold, STANDARD))
                     for end, criterion in (("", {}), ("-fixed", {"exponent": FIXED}))]
    for eps in (0.004, 0.006, 0.008, 0.010, 0.011, 0.012):
        print("not yet hyperbolic at %.3f: %4.1f %%" % (eps, 100 * (middle(table) > eps).mean()))
    print("the toughest:")
    for row in best:
        w0, w1 = row["p"] / row["q"]
        print("    (%d, %d)/%d = (%.6f, %.6f) at %.5f" % (*row["p"], row["q"], w0, w1, middle(row)))
    print("approximants of (%.9f, %.9f):" % NEAR)
    for row, fixed in zip(*sequences[:2]):
        print("    (%d, %d)/%d at %.5f, by the fixed exponent at %.5f"
              % (*row["p"], row["q"], middle(row), middle(fixed)))
    last = max(middle(best)[0], middle(toughest(sequences[0][sequences[0]["q"] >= sizes["near"] // 7],
                                                1))[0])
    draw(path("map.svg"), (8.4, 4.4), draw_map, table, best)
    draw(path("sequence.svg"), (8.4, 3.2), draw_sequence, *sequences)
    draw(path("frontier.svg"), (7.2, 3.6), draw_frontier, table, last, middle(chapter))


if __name__ == "__main__":
    main()
