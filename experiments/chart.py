"""Three charts of speed against accuracy: how near to break-up proofs get and in what time (bound),
how wide enclosures are (width), and where both methods fail (wall).

    python experiments/chart.py [DIRECTORY] [--only NAME] [--quick] [--draw]

Writes chart-NAME.csv, measured on this machine, and chart-NAME.svg into DIRECTORY (.).  Needs
matplotlib (the extra "plot") and, for tori, the extra "tori".  All on the line a = b = c/2 =
11.21436 epsilon.  --draw draws the tables that are there.
"""

import itertools
import math
import os
import random
import sys
import time
from fractions import Fraction
from pathlib import Path

import output
import sides

import converse
from converse.commands.common import Parser, ended
from converse.draw import plot
from converse.model.map import LINE, FourierMap, MuldoonMap
from converse.model.problem import Problem
from converse.storage import files

TOP = "0.0280"                          # above it there is nothing left to prove

# The thesis, table of results: bound, seconds on a Sun-4 (it gives none for 0.0272).
SUN = ("0.0278", 500.0), ("0.0276", 759.0), ("0.0274", 2698.0)
# Their boxes, of half-width 0.00125 in a: what each proves, and the centre.
BOXES = (("0.0278", "0.313"), ("0.02763", "0.311"), ("0.0274", "0.3085"), ("0.0272", "0.306"))

# For every epsilon from the proof's to TOP the absence of tori is proved.  The last proof is not
# repeated:
# epsilon, CPU seconds, release.
BOUNDS = ("0.0272", "0.0250", "0.0220", "0.0200", "0.0180", "0.0160", "0.0152", "0.0148", "0.0144",
          "0.0142", "0.0141", "0.0140", "0.01391", "0.0139")
LAST = "0.01389", 240.0, "1.12.0"
# A torus is proved there; and for every epsilon from 0 to there, not repeated (how-to/tori.md).
TORI = "0.004", "0.006", "0.008", "0.009", "0.010", "0.011", "0.0115"
RANGES = ("0.004", 12.0, "1.11.0"), ("0.005", 23.0, "1.11.0"), ("0.008", 166.0, "1.11.0"), \
    ("0.010", 3314.0, "2026-11-25")
WALLS = {
    "thesis": ("0.0280", "0.0278", "0.0276", "0.0274", "0.0272", "0.0271", "0.02706", "0.02704",
               "0.02703", "0.02702", "0.0270"),
    "loewner": ("0.0250", "0.0240", "0.0220", "0.0200", "0.0180", "0.0170", "0.0160", "0.0155",
                "0.0150", "0.0147", "0.0145", "0.0144", "0.0143", "0.0142", "0.01415", "0.0141",
                "0.01405", "0.0140", "0.01397", "0.01395", "0.01393", "0.01391", "0.0139",
                "0.01389"),
}
# --quick stops there.
QUICK = {"angles": 0.0160, "bound": 0.0160, "torus": 0.004, "thesis": 0.02704, "loewner": 0.0147}
WALL_SECONDS = 40.0

# A prism of the size that proofs near the wall cut to, on an orbit of trig274: the centre and the
# half-width of a, b, c, then x*, then the centre and the half-width of x_1, in radians.
PARAMETERS = ("0.3085", "0.3085", "0.617"), ("0.00125", "0.00125", "0.0025")
XSTAR = ("0.827732913851",) * 2
SUCCESSOR = ("4.9578", "0.0982"), ("0.003", "0.006")
POINTS = (2, 3, 4)                      # of the orbit, x* being number 0
SAMPLES = 2000

# The line of maps of two angles and of three: single values, from the one at which one point of the
# torus is enough.
LINES = {
    2: ("0.0270", "0.0200", "0.0180", "0.0165", "0.0155", "0.0150", "0.0147", "0.0145", "0.0143",
        "0.0142", "0.0141", "0.0140", "0.0139"),
    3: ("0.0183", "0.0180", "0.0175", "0.0170", "0.0160", "0.0150", "0.0145", "0.0140", "0.0137",
        "0.0135", "0.0134", "0.0133"),
}

METHODS = {"thesis": ("the thesis's method", plot.DARK),
           "loewner": ("the sharper method", plot.BLUE)}


# ---- measuring: each function yields the rows of a table

def on_line(low, high=None, together=False):
    """The problem for epsilon from low to high, both given as decimals; by default low alone."""
    low, high = (LINE * Fraction(x) for x in (low, high or low))
    return _problem(low, high, together)


def _problem(low, high, together=False):
    made = Problem(MuldoonMap((low, high), (low, high), (2 * low, 2 * high)))
    return made.tied() if together else made


def timed(problem, **options):
    """A proof and its seconds of one core: the least of a few runs, if they are short."""
    seconds = []
    while len(seconds) < 5 and sum(seconds) < 1:
        began = time.process_time()
        proof = converse.prove(problem, jobs=1, **options)
        seconds.append(time.process_time() - began)
    return proof, min(seconds)


def bound(quick):
    for epsilon, seconds in SUN:
        yield "1989", epsilon, seconds, "1989"
    for epsilon, centre in BOXES:
        yield _bound_row("thesis", epsilon, _problem(*(
            Fraction(centre) + sign * Fraction("0.00125") for sign in (-1, 1))), method="thesis")
    for epsilon in BOUNDS:
        if not quick or float(epsilon) >= QUICK["bound"]:
            yield _bound_row("no torus", epsilon, on_line(epsilon, TOP, together=True),
                             method="loewner")
    for epsilon in TORI:
        if not quick or float(epsilon) <= QUICK["torus"]:
            seconds = sides.measured("line", "torus", epsilon)[0]
            yield "torus", epsilon, seconds, converse.__version__
    yield ("no torus", *LAST)
    for row in sides.LONGEST:
        if row[:2] == ("line", "torus"):
            yield "torus", *row[2:4], row[-1]
    for row in RANGES:
        yield ("tori up to", *row)


def _bound_row(name, epsilon, problem, **options):
    proof, seconds = timed(problem, **options)
    assert proof.no_tori, epsilon
    return name, epsilon, seconds, converse.__version__


def true_extents():
    """From corners and random points of the prism, in plain doubles: n -> extents of x_n."""
    (p, dp), (v, dv), x = PARAMETERS, SUCCESSOR, tuple(map(float, XSTAR))
    box = [(float(c), float(h)) for c, h in zip(p + v, dp + dv)]
    rng = random.Random(1)
    places = list(itertools.product((-1, 1), repeat=len(box)))
    places += [[rng.uniform(-1, 1) for _ in box] for _ in range(SAMPLES)]
    found = {n: [] for n in POINTS}
    for place in places:
        a, b, c, v0, v1 = (centre + t * half for (centre, half), t in zip(box, place))
        u0, u1 = x
        for n in range(2, max(POINTS) + 1):
            mixed = c * math.cos(v0 + v1)
            u0, u1, v0, v1 = (v0, v1, 2 * v0 - u0 + a * math.cos(v0) + mixed,
                              2 * v1 - u1 + b * math.cos(v1) + mixed)
            if n in found:
                found[n].append((v0, v1))
    return {n: [max(xs) - min(xs) for xs in zip(*points)] for n, points in found.items()}


def _ratio(halves, extents):
    """The geometric mean of how much too wide both coordinates are."""
    return math.sqrt(math.prod(2 * float(h) / extent for h, extent in zip(halves, extents)))


def width(quick):
    sys.path.append(str(Path(__file__).resolve().parent.parent / "tests"))
    import kernels  # which compiles the core once more

    (p, dp), (v, dv) = PARAMETERS, SUCCESSOR
    extents = true_extents()
    zero = Fraction(0)
    first = ([Fraction(x) for x in p + XSTAR + v],
             [[Fraction(half) if j == k else zero for k in range(7)]
              for j, half in enumerate(dp + ("0", "0") + dv)])
    rows = [("double", 17, {"arithmetic": "double"})]
    rows += [(str(places), places, {}) for places in (10, 35, 100)]
    for name, places, options in rows:
        prism = first
        for n in POINTS:
            values = [*prism[0], *itertools.chain(*prism[1])]
            repeat = (2000 if quick else 20000) if options else (200 if quick else 2000)
            try:
                ns = min(float(kernels.call("image_ns", values + [repeat], 1, places,
                                                     **options)[0]) for _ in range(3))
                prism = kernels.image(prism, places, **options)
            except ArithmeticError:         # a matrix could not be inverted
                break
            halves = [sum(map(abs, row)) for row in prism[1][5:]]
            yield ("fixed form" if n == POINTS[0] else "column rotor", name, n, ns,
                   _ratio(halves, extents[n]))
    yield from taylor_width(kernels, extents)


def taylor_width(kernels, extents):
    """The same for the sharper method's Taylor models, several prisms together, sines included."""
    (p, dp), (v, dv) = PARAMETERS, SUCCESSOR
    for n in POINTS:
        patch = kernels.thesis([*map(Fraction, (*p, *v, *dp, *dv, *XSTAR, 0))])
        values = [*kernels.arguments(patch), n, 20000]
        *halves, ns, _ = min((kernels.call("waves_step", values, 4, 17,
                                                    arithmetic="double") for _ in range(3)),
                             key=lambda result: result[2])
        yield "Taylor model", "double", n, float(ns), _ratio(halves, extents[n])


def wall(quick):
    for method, values in WALLS.items():
        for epsilon in values:
            if quick and float(epsilon) < QUICK[method]:
                break
            proof = converse.prove(on_line(epsilon, together=method == "loewner"),
                                   digits=20 if method == "thesis" else None, method=method,
                                   time_limit=WALL_SECONDS)
            counts = proof.counts
            yield (method, epsilon, counts.proved, counts.most_cuts,
                   "yes" if proof.no_tori else "no")
            if not proof.no_tori:
                break


# ---- drawing: each function draws the rows of such a table, and returns a caption

def _pick(rows, column, value):
    return [row for row in rows if row[column] == value]


def draw_bound(figure, rows):
    from matplotlib import ticker

    axes = figure.subplots()
    end = 5400.0                        # seconds, and the end of both areas

    def points(name):
        return [(row[2], float(row[1])) for row in _pick(rows, 0, name)]

    for name, above, colour, marker in (("no torus", 1, plot.BLUE, "o"),
                                        ("torus", 0, plot.GREEN, "s")):
        seconds, epsilon = zip(*points(name))
        axes.plot(seconds, epsilon, marker + "-", color=colour)
        axes.annotate(_pick(rows, 0, name)[-1][1], (seconds[-1], epsilon[-1]), color=colour,
                      textcoords="offset points", xytext=(7, 4 if above else -4),
                      va="bottom" if above else "top")
        if above:
            axes.fill_between([*seconds, end], [*epsilon, epsilon[-1]], 1, color=colour, alpha=0.16,
                              linewidth=0)
    seconds, epsilon = zip(*points("tori up to"), (end, points("tori up to")[-1][1]))
    axes.fill_between(seconds, epsilon, step="post", color=plot.GREEN, alpha=0.2, linewidth=0)
    for name, marker, colour, words, at in (
            ("1989", "^", plot.DARK, "the thesis, 1989,\non a Sun-4", 900.0),
            ("thesis", "v", "0.5", "its method, this program", 0.07)):
        axes.plot(*zip(*points(name)), marker, color=colour)
        axes.text(at, 0.0263, words, color=colour, ha="center", va="top")
    last = sides.FRONTIER["line"]
    axes.axhline(last, color=plot.VERMILLION, linestyle=":", linewidth=1)
    axes.annotate("seen, not proved: the last onset of a rotation vector, %g" % last,
                  (0.012, last), (0, -3), xycoords=axes.get_yaxis_transform(), va="top",
                  textcoords="offset points", color=plot.VERMILLION)
    for place, words, colour in (((0.5, 0.021), "PROVED: no invariant torus\n"
                                  "for any epsilon on or above the line", plot.BLUE),
                                 ((0.3, 0.0075), "PROVED: a torus\nat each square", plot.GREEN),
                                 ((800, 0.0035), "PROVED: a torus for\nevery epsilon here",
                                  plot.GREEN)):
        axes.text(*place, words.replace("epsilon", "ε"), color=colour, ha="center", va="center")
    axes.set(xscale="log", xlim=(0.002, end), ylim=(0, 0.029), xlabel="CPU time of the proof",
             ylabel="ε (a = b = c/2 = 11.21436 ε)",
             title="How near to break-up proofs get, and in what time")
    axes.xaxis.set_major_locator(ticker.FixedLocator([0.01, 0.1, 1, 10, 60, 600, 3600]))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.xaxis.set_major_formatter(ticker.FixedFormatter(
        ["10 ms", "0.1 s", "1 s", "10 s", "1 min", "10 min", "1 h"]))
    return ("blue: one proof for every ε from the point to %s; black and grey: boxes 0.0002 wide; "
            "one core" % TOP)


def draw_width(figure, rows):
    axes = figure.subplots()
    for method, forms in (("thesis", ("fixed form", "column rotor")),
                          ("loewner", ("Taylor model",))):
        (name, colour), mine = METHODS[method], [row for row in rows if row[0] in forms]
        n, excess = zip(*((row[2], 100 * max(row[4] - 1, 1e-5)) for row in mine
                          if row[1] == "double"))
        axes.plot(n, excess, "o-", color=colour)
        times = ["\n%.2g µs %s" % (row[3] / 1000, words)
                 for digits, words in (("double", "in doubles"), ("35", "with 35 digits"))
                 for row in mine if row[1:3] == (digits, n[-1])]
        axes.annotate(name + ":" + ",".join(times), (n[-1], excess[-1]), (9, 5), va="top",
                      textcoords="offset points", color=colour)
    axes.set(yscale="log", xlim=(POINTS[0] - 0.2, POINTS[-1] + 0.8),
             xlabel="point of the orbit", ylabel="excess width of the enclosure",
             title="The sharper method encloses orbits more tightly, and in less time")
    axes.set_xticks(POINTS, ["$x_%d$" % n for n in POINTS])
    axes.yaxis.set_major_formatter("{x:g}%")
    return ("widths in doubles, compared with the orbits of the corners and of %d random points of "
            "the prism\n(half-widths %s, %s; a, b, c as in trig274), geometric mean over both "
            "angles; times of one image:\nof the sharper method with the bounds of sines, divided "
            "by the prisms in a vector"
            % (SAMPLES, *SUCCESSOR[1]))


def draw_wall(figure, rows):
    axes = figure.subplots()
    for method, marker, side, offset in (("thesis", "s", "right", -9), ("loewner", "o", "left", 9)):
        (name, colour), mine = METHODS[method], _pick(rows, 0, method)
        for word, line, face in (("yes", "-", colour), ("no", "", "white")):
            part = _pick(mine, 4, word)
            axes.plot([float(row[1]) for row in part], [row[2] for row in part], marker + line,
                      color=colour, markerfacecolor=face)
        for _, epsilon, prisms, *_ in _pick(mine, 4, "yes")[-1:]:
            axes.annotate("%s:\ndown to ε = %s in %g s" % (name, epsilon, WALL_SECONDS),
                          (float(epsilon), prisms), (offset, 0), textcoords="offset points",
                          ha=side, va="center", color=colour)
    axes.set(yscale="log", title="Where the methods fail", ylabel="prisms proved",
             xlabel="ε, a single value (a = b = c/2)")
    return "on all cores; the thesis's method with 20 digits" + (
        "; open: given up, with the prisms proved until then"
        if _pick(rows, 4, "no") else "")


def angles(quick):
    for epsilon, centre in BOXES:
        proof, seconds = timed(_problem(*(Fraction(centre) + sign * Fraction("0.00125")
                                          for sign in (-1, 1))), method="thesis")
        assert proof.no_tori, epsilon
        yield "1989", epsilon, proof.counts.proved, seconds, converse.__version__
    for n, values in LINES.items():
        units = [tuple(int(i == j) for i in range(n)) for j in range(n)]
        for epsilon in values:
            if quick and float(epsilon) < QUICK["angles"]:
                continue
            a = LINE * Fraction(epsilon)
            proof, seconds = timed(Problem(FourierMap({**dict.fromkeys(units, a),
                                                       (1,) * n: 2 * a})), method="loewner")
            assert proof.no_tori, epsilon
            yield "%d angles" % n, epsilon, proof.counts.proved, seconds, converse.__version__


def draw_angles(figure, rows):
    axes = figure.subplots()
    for what, marker, colour, words, at in (
            ("1989", "v", plot.DARK, "four dimensions,\nthe method of 1989", (0.0240, 300)),
            ("2 angles", "o", plot.BLUE, "four dimensions,\ntoday", (0.0143, 25000)),
            ("3 angles", "D", plot.VERMILLION, "six dimensions,\ntoday", (0.0130, 40))):
        some = _pick(rows, 0, what)
        epsilon, prisms = zip(*[(float(row[1]), row[2]) for row in some])
        axes.plot(epsilon, prisms, marker + "-", color=colour)
        axes.text(*at, "%s:\nevery ε ≥ %s" % (words, some[-1][1]), color=colour, va="center")
    axes.set(yscale="log", ylabel="prisms proved", xlabel="\u03b5 (a = c/2 = 11.21436 \u03b5)",
             title="No torus, for the line of maps of two angles and of three")
    return "single values, but boxes of 1989"


CHARTS = {
    "angles": (("what", "epsilon", "prisms", "seconds", "release"), angles, draw_angles),
    "bound": (("what", "epsilon", "seconds", "release"), bound, draw_bound),
    "width": (("form", "digits", "point", "nanoseconds", "ratio"), width, draw_width),
    "wall": (("method", "epsilon", "prisms", "deepest_cut", "proved"), wall, draw_wall),
}


def chart(name, rows, caption=True):
    """A chart of these rows, as the bytes of an SVG file; with a caption or without."""
    height = 4.3                        # inches
    with output.figure(output.CHART, figsize=(7.2, height)) as figure:
        words = CHARTS[name][2](figure, rows)
        figure.subplots_adjust(left=0.11, right=0.97, bottom=0.5 / height, top=1 - 0.4 / height)
        if caption:
            figure.text(0.11, -0.04 / height, words, color="0.35", va="top", linespacing=1.4)
        return plot.encode(figure, "svg", pad_inches=0.12)


def read(name, path):
    """The rows of a table.  ConverseError: it is not a table of this chart."""
    header = CHARTS[name][0]
    return [tuple(map(_number, header, row)) for row in output.read(header, path)]


def _number(column, word):
    """A cell; epsilon, digits and releases stay words."""
    if column in ("seconds", "nanoseconds", "ratio"):
        return float(word)
    return int(word) if column in ("point", "prisms", "deepest_cut") else word


def parser():
    p = Parser(prog="chart.py", description="Measures on this machine, and draws these charts: %s."
               % ", ".join(CHARTS))
    p.add_argument("directory", nargs="?", default=os.curdir,
                   help="where to write chart-NAME.svg and chart-NAME.csv (default: here)")
    p.add_argument("--no-caption", action="store_true", help="leave out the captions")
    p.add_argument("--quick", action="store_true", help="leave out what takes long")
    p.add_argument("--only", choices=CHARTS, metavar="NAME", help="of %s" % ", ".join(CHARTS))
    p.add_argument("--draw", action="store_true", help="draw the tables that are there")
    return p


def run(options):
    plot.check()
    os.makedirs(options.directory, exist_ok=True)
    for name, (header, measure, _) in CHARTS.items():
        if options.only in (None, name):
            picture, data = (os.path.join(options.directory, "chart-%s.%s" % (name, ending))
                             for ending in ("svg", "csv"))
            files.check_writable(picture)
            rows = read(name, data) if options.draw else []
            for row in () if options.draw else measure(options.quick):
                rows.append(row)
                print(name, *row, flush=True)
            files.write(picture, chart(name, rows, caption=not options.no_caption))
            files.write_text(data, output.text(header, rows))
    return 0


def main(argv=None):
    """Runs the command and returns its exit status."""
    return ended("chart.py", lambda: run(parser().parse_args(argv)),
                 lambda: "the charts that were finished are kept")


if __name__ == "__main__":
    sys.exit(main())
