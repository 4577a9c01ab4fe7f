"""Four charts of what is measured on this machine: speed against accuracy.

    python experiments/chart.py [DIRECTORY] [--quick]

Needs matplotlib (the extra "plot").  All on the line a = b = c/2 = 11.21436 epsilon.
"""

import contextlib
import csv
import io
import itertools
import math
import os
import platform
import random
import sys
import time
from fractions import Fraction
from pathlib import Path

import converse
from converse.commands.common import Parser, ended
from converse.draw import plot
from converse.draw.plot import BLUE, DARK, ORANGE, PURPLE, VERMILLION
from converse.model.problem import LINE, Problem
from converse.storage import files
from converse.storage.files import ConverseError

sys.path.append(str(Path(__file__).resolve().parent.parent / "tests"))
import kernels  # noqa: E402

TOP = "0.0280"                          # above it there is nothing left to prove

# The thesis, table of results: bound, seconds on a Sun-4 (it gives none for 0.0272), longest orbit.
SUN = (("0.0278", 500, 3), ("0.0276", 759, 4), ("0.0274", 2698, 4))
# Their boxes, of half-width 0.00125 in a: what each proves, and the centre.
BOXES = (("0.0278", "0.313"), ("0.02763", "0.311"), ("0.0274", "0.3085"), ("0.0272", "0.306"))
SINGLES = ("0.0271", "0.02704", "0.0270")       # for the thesis's method, without width

BOUNDS = ("0.0272", "0.0250", "0.0220", "0.0200", "0.0180", "0.0160", "0.0152", "0.0148", "0.0144",
          "0.0142", "0.0141", "0.0140", "0.01395", "0.01393", "0.01391", "0.0139")
# The sharper method of older releases: seconds of one core, longest orbit.  1.1.0 was of first
# order; its times were taken in turn with those of 1.2.0, which took 9.8 for 0.0141.  1.6.0 bounded
# orbits in x_0 and x_1, over all of the torus.
FIRST = (("0.0272", 0.0017, 1), ("0.0250", 0.0020, 3), ("0.0220", 0.0028, 7),
         ("0.0200", 0.0044, 8), ("0.0180", 0.0101, 11), ("0.0160", 0.0499, 20),
         ("0.0152", 0.1517, 31), ("0.0148", 0.3999, 44), ("0.0144", 2.50, 72),
         ("0.0142", 19.3, 113), ("0.0141", 137.5, 142))
SECOND = (("0.0272", 0.0011, 1), ("0.0180", 0.0040, 12), ("0.0160", 0.012, 18),
          ("0.0152", 0.030, 36), ("0.0148", 0.066, 49), ("0.0144", 0.26, 87),
          ("0.0142", 0.91, 113), ("0.0141", 2.7, 147), ("0.0140", 57, 339))
LONG = 100                              # orbits from which the end of the curve is estimated

# The diagonal x_0 = x_1 is invariant.  The last invariant circle seen there that runs round has the
# rotation number [0; 5, 1, 1, ...]; a convergent of it.  experiments/diagonal.py tries others.
CIRCLE = (987,), 5545
# Tori were seen up to there by Fourier series, and orbits that are not yet hyperbolic up to there,
# near the toughest rotation vector that is known: experiments/toughest.py.
SEEN = 0.0121, 0.01256
DIGITS = (1, 2, 3, 4, 5, 7, 10, 15, 20, 35, 50, 75, 100, 150, 200)
WALLS = {
    "thesis": ("0.0280", "0.0278", "0.0276", "0.0274", "0.0272", "0.0271", "0.02706", "0.02704",
               "0.02703", "0.02702", "0.0270"),
    "loewner": ("0.0250", "0.0240", "0.0220", "0.0200", "0.0180", "0.0170", "0.0160", "0.0155",
                "0.0150", "0.0147", "0.0145", "0.0144", "0.0143", "0.0142", "0.01415", "0.0141",
                "0.01405", "0.0140", "0.01397", "0.01395", "0.01393", "0.01391", "0.0139",
                "0.01389"),
}
QUICK = {"bound": 0.0160, "thesis": 0.02704, "loewner": 0.0147}     # --quick stops there
WALL_SECONDS = 40.0

# A prism of the size that proofs near the wall cut to, on an orbit of trig274: the centre and the
# half-width of a, b, c, then x*, then the centre and the half-width of x_1, in radians.
PARAMETERS = ("0.3085", "0.3085", "0.617"), ("0.00125", "0.00125", "0.0025")
XSTAR = ("0.827732913851",) * 2
SUCCESSOR = ("4.9578", "0.0982"), ("0.003", "0.006")
POINTS = (2, 3, 4)                      # of the orbit, x* being number 0
SAMPLES = 2000

HEIGHTS = {"bound": 6.6, "wall": 5.4}   # of charts with two parts, in inches
COLOURS = {"1989": DARK, "thesis": BLUE, "first order": "0.7", "second order": "0.45",
           "loewner": ORANGE, "linked": VERMILLION}
ZOOM = 0.0165                           # up to there the chart of the bound is drawn larger
SMALL = {"textcoords": "offset points", "fontsize": 8, "color": "0.3"}
STYLE = {
    **plot.STYLE, "lines.markersize": 5.5, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": "0.92",
    "grid.linewidth": 0.6,
}


# ---- the map on the diagonal

def diagonal():
    """The potential of the map on x_0 = x_1, for converse.orbits: half of trig's there, since both
    coordinates move."""
    from converse import orbits

    half = Fraction(-1, 2)
    return orbits.Fourier({(1,): (0, half), (2,): (0, half)}, "diagonal",
                          scale_enclosure=orbits.trig.scale_enclosure)


def last_circle():
    """Where the last invariant circle of the map on the diagonal breaks up: about where the orbits
    of type CIRCLE turn hyperbolic.  An estimate from numerics.

    The second variation along an orbit on the circle is positive within the diagonal, and where it
    is across, too, as seen, no segment of the orbit contradicts anything.  One goes through every
    x* of the diagonal: no proof from such an x* gets below."""
    from converse import orbits

    below, above = orbits.onset(diagonal(), *CIRCLE, step=0.0005, width=1e-6, top=0.02)
    return (below.eps + above.eps) / 2


# ---- measuring: each function yields the rows of a table

def on_line(low, high=None, together=False):
    """The problem for epsilon from low to high, both given as decimals; by default low alone."""
    low, high = (LINE * Fraction(x) for x in (low, high or low))
    return _problem((low + high) / 2, (high - low) / 2, together)


def _problem(centre, half, together=False):
    return Problem.around((centre, centre, 2 * centre, 1, 1), (half, half, 2 * half, 1, 1),
                          together=together)


def timed(problem, **options):
    """A proof and its seconds of one core: the least of a few runs, if they are short."""
    seconds = []
    while len(seconds) < 5 and sum(seconds) < 1:
        began = time.process_time()
        proof = converse.prove(problem, jobs=1, **options)
        seconds.append(time.process_time() - began)
    return proof, min(seconds)


def _yes(truth):
    return "yes" if truth else "no"


def bound(quick):
    for epsilon, seconds, orbit in SUN:
        yield "1989", epsilon, seconds, orbit, "yes"
    for epsilon, centre in BOXES:
        yield _bound_row("thesis", epsilon, _problem(Fraction(centre), Fraction("0.00125")))
    for epsilon in SINGLES:
        yield _bound_row("thesis, single value", epsilon, on_line(epsilon), digits=20)
    for epsilon in BOUNDS:
        if not quick or float(epsilon) >= QUICK["bound"]:
            yield _bound_row("loewner", epsilon, on_line(epsilon, TOP, together=True),
                             method="loewner")
    for name, older in ("first order", FIRST), ("second order", SECOND):
        for epsilon, seconds, orbit in older:
            yield name, epsilon, seconds, orbit, "yes"
    began = time.process_time()
    circle = last_circle()
    yield "last circle", "%.5f" % circle, time.process_time() - began, CIRCLE[1], "seen"


def _bound_row(name, epsilon, problem, **options):
    proof, seconds = timed(problem, **options)
    if proof.counts.linked:
        name = "linked"
    return name, epsilon, seconds, proof.counts.max_NTsteps, _yes(proof.no_tori)


def digits(quick):
    problem = _problem(Fraction("0.3085"), Fraction("0.00125"))
    for places in DIGITS:
        proofs, before = zip(*((converse.prove(problem, digits=places, jobs=1),
                                converse.prove(problem, digits=places, jobs=1, depth=0))
                               for _ in range(3 if quick else 12)))
        yield (places, min(proof.seconds for proof in proofs),
               min(proof.seconds for proof in before), proofs[0].counts.proved,
               _yes(proofs[0].no_tori))


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
    yield from taylor_width(extents)


def taylor_width(extents):
    """The same for the sharper method's Taylor models, several prisms at once, sines included."""
    (p, dp), (v, dv) = PARAMETERS, SUCCESSOR
    for n in POINTS:
        values = [*p, *v, *dp, *dv, *XSTAR, 0, n, 20000]
        *halves, ns, _ = min((kernels.call("loewner_step", values, 4, 17,
                                                    arithmetic="double") for _ in range(3)),
                             key=lambda result: result[2])
        yield "Taylor model", "double", n, float(ns), _ratio(halves, extents[n])


def wall(quick):
    for method, values in WALLS.items():
        for epsilon in values:
            if quick and float(epsilon) < QUICK[method]:
                break
            proof = converse.prove(on_line(epsilon, together=method == "loewner"), digits=20,
                                   method=method, time_limit=WALL_SECONDS)
            counts = proof.counts
            yield method, epsilon, counts.proved, counts.most_cuts, _yes(proof.no_tori)
            if not proof.no_tori:
                break


# ---- drawing: each function draws the rows of such a table, and returns a caption

def _pick(rows, column, value):
    return [row for row in rows if row[column] == value]


def estimated_end(rows):
    """Where proofs would need orbits without end: once orbits are long, the inverse of the longest
    falls about linearly with epsilon, and the line of least squares says where it is 0.  An
    estimate; None where the proofs do not give one."""
    points = [(float(row[1]), 1 / row[3]) for row in rows
              if row[0] == "loewner" and row[4] == "yes" and row[3] >= LONG]
    if len(points) < 3:
        return None
    x, y = (sum(values) / len(points) for values in zip(*points))
    rise = sum((p - x) * (q - y) for p, q in points)
    end = x - y * sum((p - x) ** 2 for p, _ in points) / rise if rise > 0 else 0
    return end if 0 < end < min(points)[0] else None


def _level(axes, value, words, left=False, **line):
    """A horizontal line and its words: below at the right or, left, above at the left."""
    axes.axhline(value, linewidth=0.9, **line)
    axes.annotate(words, (0.015 if left else 0.985, value), (0, 3 if left else -2.5),
                  xycoords=axes.get_yaxis_transform(), textcoords="offset points", color="0.25",
                  ha="left" if left else "right", va="bottom" if left else "top")


def draw_bound(figure, rows):
    upper, lower = figure.subplots(2, 1, sharex=True,
                                   gridspec_kw={"hspace": 0.07, "height_ratios": (3, 2)})
    for name, marker, line, label in (
            ("1989", "^", "none", "the thesis, Sun-4, 1989"),
            ("thesis", "s", "none", "the thesis's method, this program, 35 digits"),
            ("first order", "v", "-", "method loewner, first order (release 1.1.0)"),
            ("second order", "<", "-", "second order, in $x_0$ and $x_1$ (release 1.6.0)"),
            ("loewner", "o", "-", "second order, along the axes of the waves"),
            ("linked", "D", "-", "several starting points, regions that move")):
        good = [row for row in rows if row[0] == name and row[4] == "yes"]
        for axes in (upper, lower):
            axes.plot([row[2] for row in good], [float(row[1]) for row in good], marker=marker,
                      linestyle=line, color=COLOURS[name], label=label)

    singles = _pick(rows, 0, "thesis, single value")
    good, bad = ([row[1] for row in singles if row[4] == word] for word in ("yes", "no"))
    if good:
        words = "the thesis's method: %s alone is proved" % good[-1]
        _level(upper, float(good[-1]), words + ", %s is not" % bad[0] if bad else words,
               color=COLOURS["thesis"], linestyle="--")
    end = estimated_end(rows)
    if end is not None:
        words = "estimate, of one x*:\nthe orbits needed grow\nwithout end near %.4f" % end
        _level(lower, end, words, left=True, color=COLOURS["loewner"], linestyle=":")
    for _, epsilon, *_ in _pick(rows, 0, "last circle"):
        _level(lower, float(epsilon), "seen: up to %s the diagonal $x_0 = x_1$ has an invariant "
               "circle: no proof from an x* there gets past" % epsilon, color=PURPLE,
               linestyle="-.")
    tori, not_hyperbolic = SEEN
    for value, words in ((not_hyperbolic, "some orbits are not yet hyperbolic"),
                         (tori, "tori, by Fourier series")):
        lower.axhspan(0, value, color=COLOURS["thesis"], alpha=0.13, linewidth=0)
        _level(lower, value, "seen: %s, up to %g" % (words, value), linestyle="none")
    upper.set(xscale="log", ylim=(0.0134, 0.0286),
              title="What is proved, and how long the proof takes")
    lower.set(ylim=(tori - 0.0004, ZOOM), xlabel="time of the proof (seconds of one core)")
    figure.supylabel("proven upper bound of $ε_c$", x=0.02, fontsize=9)
    upper.legend(loc="center right", bbox_to_anchor=(1, 0.6))
    caption = ("thesis: one box 0.0002 wide for each point (1989: the time for 0.0272 is not "
               "known); loewner: everything above the point,\nin one proof.  Below: the same near "
               "the end; what is seen is an estimate from numerics (docs/orbits.md), not proved")
    if end is not None:
        caption += ";\nthe dotted one: where 1 / (longest orbit) falls to 0"
    return caption


def draw_digits(figure, rows):
    from matplotlib import ticker

    axes = figure.subplots()
    good = [row for row in rows if row[4] == "yes"]
    bad = [row for row in rows if row[4] != "yes"]
    axes.plot([row[0] for row in good], [1000 * row[1] for row in good], "s-",
              color=COLOURS["thesis"], label="whole proof")
    axes.plot([row[0] for row in rows], [1000 * row[2] for row in rows], "--", color="0.45",
              label="of which before the search (bounds over the torus)")
    if bad:
        axes.plot([row[0] for row in bad], [1000 * row[1] for row in bad], "o", markersize=7,
                  markerfacecolor="none", color=VERMILLION, label="undecided: too few digits")
    changes = [row for row, last in zip(good, [None] + good) if not last or row[3] != last[3]]
    for k, row in enumerate(changes):       # the number of prisms, where it changes
        axes.annotate(str(row[3]), (row[0], 1000 * row[1]), (3, 13 if k % 2 else 6), **SMALL)
    axes.set(xscale="log", ylim=(0, 1150 * max(row[1] for row in rows)),
             xlabel="digits (decimal places)", ylabel="time (milliseconds)",
             title="The price of digits: 0.0274 < ε < 0.0276, the thesis's method")
    axes.xaxis.set_major_locator(ticker.FixedLocator(
        [row[0] for row in rows if row[0] not in (4, 15, 75, 150)]))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.xaxis.set_major_formatter("{x:g}")
    axes.legend(loc="upper center")
    return "one core; small numbers: prisms proved, where their number changes"


def draw_width(figure, rows):
    axes = figure.subplots()
    rows = [(*row[:4], 100 * max(row[4] - 1, 1e-5)) for row in rows]
    for n in POINTS:
        mine = [row for row in rows if row[2] == n and row[0] != "Taylor model"]
        axes.plot([row[3] for row in mine], [row[4] for row in mine], color="0.75", linewidth=0.8)
    for form, marker, colour in (("fixed form", "o", COLOURS["1989"]),
                                 ("column rotor", "s", COLOURS["thesis"]),
                                 ("Taylor model", "^", COLOURS["loewner"])):
        mine = [row for row in rows if row[0] == form]
        if mine:
            axes.plot([row[3] for row in mine], [row[4] for row in mine], marker, color=colour,
                      label=form)
    for form, name, n, ns, excess in rows:
        taylor = form == "Taylor model"
        if not taylor:
            axes.annotate(name, (ns, excess), (5, 6), ha="right", **SMALL)
        if name == "double":
            axes.annotate("$x_%d$" % n, (ns, excess), (6, -4) if taylor else (-7, 0),
                          va="center", ha="left" if taylor else "right",
                          **{**SMALL, "fontsize": 9})
    axes.margins(x=0.12, y=0.12)
    axes.set(xscale="log", yscale="log", xlabel="time of an image (nanoseconds)",
             ylabel="excess width of the enclosure",
             title="How tightly, and how fast, the orbits of a prism are enclosed")
    axes.yaxis.set_major_formatter("{x:g}%")
    axes.legend(loc="lower right")
    return ("small: digits; geometric mean over both angles of $x_n$ on the orbits of $x^*$ and "
            "$x_1$ in a prism (half-widths %s, %s;\na, b, c as in trig274), beside its corners' "
            "and %d random points' orbits; of Taylor models alone\nwith the bounds of sines, per "
            "prism of as many as the machine takes at once" % (*SUCCESSOR[1], SAMPLES))


def draw_wall(figure, rows):
    upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"hspace": 0.08})
    for axes, column, what in ((upper, 2, "prisms proved"), (lower, 3, "deepest cut")):
        for name, marker, label in (("thesis", "s", "the thesis's method, 20 digits"),
                                    ("loewner", "o", "method loewner")):
            good, bad = ([(float(row[1]), row[column]) for row in rows
                          if row[0] == name and row[4] == word] for word in ("yes", "no"))
            axes.plot([x for x, _ in good], [y for _, y in good], marker + "-",
                      color=COLOURS[name], label=label)
            axes.plot([x for x, _ in bad], [y for _, y in bad], marker, color=COLOURS[name],
                      markerfacecolor="white")
        axes.set_ylabel(what)
    upper.set(yscale="log", title="Where the methods fail")
    lower.set(ylim=(-2, None),
              xlabel="ε, a single value (a = b = c/2)")
    upper.legend(loc="upper center", bbox_to_anchor=(0.55, 1))
    return "on all cores" + (
        "; open: given up, or not finished in %g seconds; the prisms proved until then"
        % WALL_SECONDS
        if _pick(rows, 4, "no") else "")


CHARTS = {
    "bound": (("method", "epsilon_c", "seconds", "longest_orbit", "proved"), bound, draw_bound),
    "digits": (("digits", "seconds", "before_search", "prisms", "proved"), digits, draw_digits),
    "width": (("form", "digits", "point", "nanoseconds", "ratio"), width, draw_width),
    "wall": (("method", "epsilon", "prisms", "deepest_cut", "proved"), wall, draw_wall),
}


def machine():
    """The machine, in a line."""
    model = ""
    with contextlib.suppress(OSError), open("/proc/cpuinfo", encoding="utf-8",
                                            errors="replace") as file:
        lines = [line.partition(":") for line in file if line.startswith("model name")]
        model = " ".join(lines[0][2].split()) + ", " if lines else ""
    count = os.cpu_count() or 1
    return "%s, %s%d core%s" % (platform.machine(), model, count, "" if count == 1 else "s")


def chart(name, rows, kind, caption=True):
    """A chart of these rows, as the bytes of a file of that kind; with a caption or without."""
    from matplotlib import style
    from matplotlib.figure import Figure

    height = HEIGHTS.get(name, 4.3)
    with style.context(["default", STYLE]):
        figure = Figure(figsize=(7.2, height))
        words = CHARTS[name][2](figure, rows) + "\n" + machine().replace("$", "")
        figure.subplots_adjust(left=0.11, right=0.97, bottom=0.5 / height, top=1 - 0.4 / height)
        if caption:
            figure.text(0.11, -0.04 / height, words, color="0.35", va="top", linespacing=1.4)
        return plot.encode(figure, kind, dpi=150, pad_inches=0.12)


def _words(row):
    return ["%.4g" % item if isinstance(item, float) else str(item) for item in row]


def table(name, rows):
    """The rows as the bytes of a CSV file."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(
        [CHARTS[name][0]] + [_words(row) for row in rows])
    return text.getvalue().encode("utf-8")


def parser():
    p = Parser(prog="chart.py", allow_abbrev=False, description=(
        "Measures on this machine and draws four charts: bound, digits, width, wall."), epilog=(
        "Exit status: 0 all are written; 2 bad usage or directory; 130 interrupted."))
    p.add_argument("directory", nargs="?", default=os.curdir,
                   help="where to write chart-NAME.svg and chart-NAME.csv (default: here)")
    p.add_argument("--format", choices=plot.FORMATS, default=plot.FORMATS[0],
                   help="of the charts")
    p.add_argument("--no-caption", action="store_true", help="leave out the captions")
    p.add_argument("--quick", action="store_true", help="leave out what takes long")
    return p


def run(options):
    try:
        plot.check()
    except ConverseError:
        raise ConverseError("charts need matplotlib; pip install matplotlib") from None
    try:
        os.makedirs(options.directory, exist_ok=True)
    except OSError as error:
        raise ConverseError("%s: cannot be made a directory (%s); name another place"
                            % (options.directory, files.reason(error))) from None
    paths = {name: [os.path.join(options.directory, "chart-%s.%s" % (name, ending))
                    for ending in (options.format, "csv")] for name in CHARTS}
    for path in itertools.chain(*paths.values()):
        files.check_writable(path)
    for name, (header, measure, _) in CHARTS.items():
        rows = []
        for row in measure(options.quick):
            rows.append(row)
            print("%s: %s" % (name, ", ".join(map(" ".join, zip(header, _words(row))))),
                  flush=True)
        picture_of = chart(name, rows, options.format, caption=not options.no_caption)
        for path, data in zip(paths[name], (picture_of, table(name, rows))):
            files.write(path, data)
    print("written: " + " ".join(itertools.chain(*paths.values())), flush=True)
    return 0


def main(argv=None):
    """Runs the command and returns its exit status."""
    return ended("chart.py", lambda: run(parser().parse_args(argv)),
                 lambda: "the charts that were finished are kept")


if __name__ == "__main__":
    sys.exit(main())
