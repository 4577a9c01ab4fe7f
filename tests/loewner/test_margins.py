"""The margins for roundings: what formal/roundings.py proves of them from the C text, that it
proves nothing of a text with less, and how much of those of general waves is ever needed.

What is needed of the thesis's is in test_loewner.py.  With -s the table is printed.
"""

import importlib
import math
import re
import struct
import sys
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import pytest
from test_waves import many_digits  # noqa: F401
from test_waves import FRAMES, beta, draw, margins

import kernels
from patches import SITES, UNIT, angles, arguments, modulo, sites
from truth import TORTURE, mp, rng_for, uniform

CASES = 150 * TORTURE


@pytest.fixture(scope="module")
def tools(root):
    """formal/roundings.py and formal/ctext.py."""
    sys.path.insert(0, str(root / "formal"))
    try:
        yield importlib.import_module("roundings"), importlib.import_module("ctext")
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="module")
def read(root):
    return lambda file: (root / "csrc" / file).read_text("utf-8")


@pytest.fixture(scope="module")
def table(root):
    """Of each row of docs/proofs/argument.md that a machine has proved: the factor that it is said
    to leave.
    """
    text = (root / "docs/proofs/argument.md").read_text("utf-8")
    part = text[text.index("**What a machine has proved of this.**"):text.index("Why that much")]
    return {name: float(left) for name, left in
            re.findall(r"^\| ([a-z0-9_ *`]+?) \|.*\| ([0-9.]+) \|", part, re.MULTILINE)}


# ---- proved

@pytest.mark.slow
def test_the_text_proves_its_margins(tools, read, table):
    proved = {name: float(x) for name, x in tools[0].proved(read, parameters=1).items()}
    for name, left in proved.items():
        print("%-22s %.2f times what is needed" % (name, left))
    assert proved.keys() == table.keys() - {"sine"}     # of which test_gappa.py
    for name, left in proved.items():
        assert table[name] <= left < 1.01 * table[name] + 0.01, name


WAVES = "loewner/waves.h"
MUTATIONS = [                           # file, what stands there, what to put in its place, margin
    (WAVES, "q->err_beta = grain_of(w) *", "q->err_beta = 0x1p-51 *", "err_beta"),
    (WAVES, "(double)(12 + waves_of(w))", "12.0", "general err_beta"),
    ("arith/turns.h", "TURNS_ERROR 0x1.8p-61", "TURNS_ERROR 0x1p-48", "err_beta"),
    (WAVES, "N * 0x1p-52 * sum", "N * 0x1p-54 * sum", "err_dot"),
    (WAVES, "N * 0x1p-52 * sum", "N * 0x1p-54 * sum", "general err_dot"),
    (WAVES, "unit = every(grain_of(w))", "unit = every(0x1p-53)", "propagated"),
    ("loewner/orbit.c", "return grain_of(w) * (mag", "return 0x1p-60 * (mag", "propagated"),
    (WAVES, "lost : lost + p * q->err_dot[wave];", "lost : lost;", "propagated"),
    (WAVES, "+ w->h[wave]);", ");", "propagated"),
    ("loewner/orbit.c", "const double off = 0x1p-52", "const double off = 0x1p-54", "sines"),
    (WAVES, "q->err_beta = grain_of(w) *", "q->err_beta = 0x1p-51 *", "turned"),
    ("loewner/orbit.c", "WIDEN = 1.0 + 0x1p-46", "WIDEN = 1.0 + 0x1p-49", "widen"),
    ("loewner/orbit.c", "+ q->force[i]) * WIDEN;", "+ q->force[i]);", "widen"),
    ("loewner/orbit.c", "(q->lin_bound[i] + q->nonlin_bound[i]) * WIDEN",
     "(q->lin_bound[i] + q->nonlin_bound[i])", "widen"),
    ("loewner/bound.c", "left = 4.0 * q->err_beta * weights",
     "left = 0x1p-5 * q->err_beta * weights", "multipliers"),
    ("loewner/bound.c", "0x1p-50 * (mag(before) + mag(after))", "0x1p-50 * mag(after)",
     "multipliers"),
    ("loewner/problem.c", "sum + 0x1p-45 *", "sum + 0x1p-48 *", "general at_once"),
    ("loewner/problem.c", "(1.0 + err_angle) * mass < 0.0", "mass < 0.0", "general at_once"),
    ("loewner/problem.c", "w->err_amplitude[i]) * w->square_k[i] * length;",
     "w->err_amplitude[i]);", "general at_once"),
]


@pytest.mark.parametrize("file, old, new, margin", MUTATIONS)
@pytest.mark.slow
def test_less_is_not_proved(tools, read, file, old, new, margin):
    """Neither of the thesis's waves nor, where the margin says so, of 16."""
    roundings = tools[0]
    assert read(file).count(old) == 1
    general, name = margin.startswith("general "), margin.split()[-1]
    with pytest.raises(roundings.NotCovered):
        model = roundings.Model(lambda name: read(name).replace(old, new) if name == file else
                                read(name), 16 if general else None,
                                parameters=0 if general else 1)
        getattr(roundings, name)(model)


def test_bounds_of_roundings(tools):
    """What is said of sums and products, against doubles that do them."""
    roundings = tools[0]
    rng = rng_for("bounds of roundings")
    worst = Fraction(0)
    for _ in range(CASES):
        x, y, z = (rng.choice([-1, 1]) * rng.uniform(0.5, 2) for _ in range(3))
        names = [roundings.exact(name) for name in "xyz"]

        def value(polynomial):
            return sum(c * math.prod(abs(Fraction({"x": x, "y": y, "z": z}[name])) for name in key)
                       for key, c in polynomial.terms.items())

        half, three = Fraction(1, 2), Fraction(3)
        for formula in (lambda x, y, z: (x + y) * z - half * x,
                        lambda x, y, z: x * y * z + three * y,
                        lambda x, y, z: (x - y) - (x * z - 1)):
            bound, exact = formula(*names), formula(*map(Fraction, (x, y, z)))
            assert abs(exact) <= value(bound.size)
            off = abs(Fraction(formula(x, y, z)) - exact)
            assert off <= value(bound.off)
            worst = max(worst, off / value(bound.off))
    assert worst > Fraction(1, 4)


# ---- needed by general waves

def many(rng, low, high):
    """A number with more digits than a double has."""
    return uniform(rng, low, high, 30)


def frame_margins(rng, cases):
    """Is x_1 = frame v in what the core's point 1 and its columns span?  The symbols there of the
    corners of v exceed 1 by what is needed, if the sides were not wider than they are."""
    for _ in range(cases):
        patch = draw(rng)
        patch.frame = rng.choice(FRAMES[2:])
        patch.centre = [many(rng, -7, 7) for _ in range(2)]
        patch.half = [many(rng, 0, Fraction(1, 10 ** rng.randrange(1, 12))) for _ in range(2)]
        q = sites(patch, 0, 1)
        if not q:
            continue
        (a, b), (c, d) = (row[:2] for row in q[1].lin)
        f, det = patch.frame, a * d - b * c
        x = [modulo(mp(f[2 * i] * patch.centre[0] + f[2 * i + 1] * patch.centre[1]) - q[1].x[i])
             for i in range(2)]
        inverse = [[d / det, -b / det], [-c / det, a / det]]
        for k, row in enumerate(inverse):
            width = abs(sum(row[i] * f[2 * i + k] for i in range(2)))           # of 1 in v
            off = abs(row[0] * x[0] + row[1] * x[1]) + sum(
                abs(sum(row[i] * f[2 * i + m] for i in range(2))) * mp(patch.half[m])
                for m in range(2))
            yield "frame", off / width - mp(patch.half[k]), 1 / width - mp(patch.half[k])


def err_dot_margins(rng, cases):
    """k.L as doubles make it."""
    for _ in range(10 * cases):
        k = [float(rng.randrange(-100, 101)) for _ in range(2)]
        L = [rng.uniform(-1, 1) for _ in range(2)]
        made = Fraction(k[0] * L[0] + k[1] * L[1])
        size = sum(abs(Fraction(i) * Fraction(x)) for i, x in zip(k, L))
        yield "err_dot", abs(made - sum(Fraction(i) * Fraction(x) for i, x in zip(k, L))), \
            4 * UNIT * size


def left_margins(rng, cases):
    """What (2) of bound.c leaves."""
    for _ in range(2 * cases):
        patch = draw(rng)
        s, t = -rng.randrange(1, 5), rng.randrange(2, 6)
        q = sites(patch, s, t)
        if not q:
            continue
        try:
            out = kernels.call("waves_bound", [*arguments(patch), s, t, 1], 5 + 2 * SITES, 20)
        except ArithmeticError:
            continue
        first, count = int(out[2]), int(out[3])
        n = {first + k: (mp(out[5 + 2 * k]), mp(out[6 + 2 * k])) for k in range(count)}
        if not n or max(max(map(abs, q[j].x)) for j in q) > 100:
            continue
        since, until, none = min(first, 0), max(first + count - 1, 1), (mp(0), mp(0))
        mu = {j: q[j].mu if since < j < until else none for j in range(since - 1, until + 2)}
        waves = [w for w in patch.waves if any(w[3:])]
        K = max([1] + [abs(w[0]) + abs(w[1]) for w in waves])
        for j in range(since, until + 1):
            if j in (0, 1):
                continue
            b, (n0, n1) = beta(patch, [w[3] for w in patch.waves], q[j].x), n.get(j, none)
            pull = [(w[0] * n0 + w[1] * n1) ** 2 * mp(w[3]) * mpmath.cos(y)
                    for w, y in zip(patch.waves, angles(patch, q[j].x))]
            weights = K * K * (n0 ** 2 + n1 ** 2) + K * (abs(mu[j][0]) + abs(mu[j][1]))
            for i in range(2):
                slope = b[i] * mu[j][0] + b[i + 1] * mu[j][1] - mu[j - 1][i] - mu[j + 1][i] \
                    - sum(w[i] * x for w, x in zip(patch.waves, pull))
                yield "left", abs(slope), 4 * q[j].err_beta * weights + 8 * mp(UNIT) * (
                    abs(mu[j - 1][i]) + abs(mu[j + 1][i]))


def sines_of(tools, read):
    """double_sincos, executed from its text with Python's doubles."""
    header = read("arith/sine.h")
    names = {"bits_of": lambda y: struct.unpack("<Q", struct.pack("<d", y))[0], "mag": abs,
             "vec_of": lambda m: struct.unpack("<d", struct.pack("<Q", m % 2 ** 64))[0],
             "TRUTH": lambda truth: -int(truth), "pick": lambda m, x, y: x if m else y,
             "SINE_LIMIT": tools[1].defined(header, "SINE_LIMIT")}
    return tools[1].function(header, "double_sincos").bound(names)


def at_once_margins(rng, cases, tools, read):
    """The sum of loewner_at_once, executed from its text, and in exact arithmetic."""
    ctext = tools[1]
    *statements, _ = ctext.function(read("loewner/problem.c"), "loewner_at_once").statements
    for _ in range(cases):
        patch, at_end = draw(rng, [(1, 0), (1, -1), (40, -39), (7, 10), (2, 1)]), rng.randrange(2)
        patch.waves = [(*w[:2], many(rng, 0, 6), *(many(rng, -2, 2) for _ in range(1 + 3)))
                       for w in patch.waves]
        waves, n = [], [rng.uniform(-1, 1) for _ in range(2)]
        for k0, k1, *numbers in patch.waves:
            phase, p, *parts = map(float, numbers)
            waves.append(SimpleNamespace(k=[float(k0), float(k1)], phase=phase, p=p, parts=parts))
        w = SimpleNamespace(
            waves=len(waves), n_parameters=3, angles=2,
            k=[x.k for x in waves], phase=[x.phase for x in waves], amplitude=[x.p for x in waves],
            part=[x.parts for x in waves], square_k=[sum(map(abs, x.k)) ** 2 for x in waves],
            err_amplitude=[2.0 ** -48 * (abs(x.p) + sum(map(abs, x.parts))) for x in waves])
        x = [rng.uniform(-4, 4) for _ in range(2)]

        def eigenvector(_, matrix, found, n=n):
            found[:2] = n

        names = {"w": w, "x": x, "at_end": at_end, "SLOTS": 18, "fabs": abs, "larger": max,
                 "square": lambda x: x * x, "sym_least_eigenvector": eigenvector, "ANGLES": 3,
                 "MOST_ENTRIES": 6,
                 "sym_at": lambda n, i, j: i * (2 * n - i - 1) // 2 + j,
                 "double_sincos": sines_of(tools, read),
                 "size_of": ctext.function(read("loewner/problem.c"), "size_of").bound(
                     {"fabs": abs})}
        ctext.run(statements, names)
        pull = [mpmath.sin(k0 * mp(x[0]) + k1 * mp(x[1]) + mp(phase)) * mp(k0 * Fraction(n[0])
                + k1 * Fraction(n[1])) ** 2 for k0, k1, phase, *_ in patch.waves]
        swings = [-sum(mp(v[4 + m]) * y for v, y in zip(patch.waves, pull)) for m in range(3)]
        true = mp(4) / 3 * (mp(n[0]) ** 2 + mp(n[1]) ** 2) + sum(
            swings if at_end else map(abs, swings))
        true -= sum(mp(v[3]) * y for v, y in zip(patch.waves, pull))
        yield "at once", abs(mp(names["sum"]) - true), \
            mp(2) ** -45 * (1 + mp(names["err_angle"])) * mp(names["mass"])


def worst_margins(tools, read):
    """Of each margin of general waves the largest share that was needed."""
    worst = {}
    for measure, *more in ((frame_margins,), (err_dot_margins,), (left_margins,),
                           (margins,), (at_once_margins, tools, read)):
        for name, need, there in measure(rng_for(measure.__name__), CASES, *more):
            if need > 0:
                assert there > 0, name
                worst[name] = max(worst.get(name, 0), float(need / there))
    return worst


@pytest.mark.slow
def test_margins_of_general_waves(tools, read, root):
    """Of no margin more is needed than docs/proofs/argument.md proves, and of each some is."""
    text = (root / "docs/proofs/argument.md").read_text("utf-8")
    part = text[text.index("**General waves.**"):text.index("**What a machine has proved")]
    left = dict(re.findall(r"^\| ([a-z_]+) \|.*\| ([0-9.]+) \| [0-9]", part, re.MULTILINE))
    left.update({"residual": 1.4, "at once": 3.4})        # of the first table
    worst = worst_margins(tools, read)
    for name, share in worst.items():
        print("%-10s left, seen: %.3g" % (name, 1 / share))
    assert worst.keys() == left.keys()
    for name, share in worst.items():
        assert share <= 1 / float(left[name]), name
