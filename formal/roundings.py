"""Bounds the roundings of csrc/loewner from its own text, whatever the numbers are.

    python formal/roundings.py

The functions that see a point and make the next one are executed with pairs of polynomials for
numbers: a bound of what a number is in exact arithmetic, and a bound of how far the double is off
that.  Their symbols are the absolute values of what goes in, their coefficients exact and not
negative.  A sum, a difference, a product of doubles is the exact one times 1 + epsilon,
|epsilon| <= u.  So the last polynomial bounds the error for all data at once, with its terms of
higher order in u; and where each of its coefficients is at most that of the margin, executed from
its text in the same way, the margin is proved.  What is printed is the least quotient of the two.

This is about what doubles lose of what the text says, not about whether it says the right thing:
signs, for one, are not looked at.  Left out, as docs/proofs/argument.md covers it by hand, is what
products lose that are below 2^-1022.
"""

import sys
from fractions import Fraction
from itertools import product
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent))
from ctext import CTextError, constant, defined, execute, function, run  # noqa: E402
from polynomial import Polynomial, symbol  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
UNIT = Fraction(1, 2 ** 53)
MOST_WAVES, PARAMETERS = 16, 3
ZERO = Polynomial()


class Rounded:
    """size >= |x|, off >= |double - x| for a number x of exact arithmetic."""

    known = {}                  # bounds of sums that are better than those of what is added

    def __init__(self, size, off=ZERO):
        self.size, self.off = Polynomial.of(size), Polynomial.of(off)

    def _after(self, size, off):
        """Of an operation whose operands are off so much, and which is rounded."""
        return Rounded(size, off + (size + off) * UNIT)

    def __add__(self, other):
        other = rounded(other)
        for x, y in ((self, other), (other, self)):
            if not x.size.terms and not x.off.terms:
                return y                        # nothing is added
        size = self.known.get(_sum(self, other), self.size + other.size)
        return self._after(size, self.off + other.off)

    def __mul__(self, other):
        other = rounded(other)
        size = self.size * other.size
        off = self.off * other.size + self.size * other.off + self.off * other.off
        if other.is_power() or self.is_power():
            return Rounded(size, off)
        return self._after(size, off)

    def __neg__(self):
        return self

    __sub__ = __radd__ = __rsub__ = __add__
    __rmul__ = __mul__

    def is_power(self):
        """Is it a power of two, or zero?  Products with it are exact."""
        if self.off.terms or set(self.size.terms) - {()}:
            return False
        x = self.size.terms.get((), Fraction(0))
        return x == 0 or x.numerator & (x.numerator - 1) == 0 == x.denominator & (x.denominator - 1)

    def least(self):
        """The double is at least that, if the size is the number itself and no bound."""
        return self.size - self.off


def _sum(x, y):
    """A sum's name in Rounded.known."""
    return frozenset([*x.size.terms.items()]), frozenset([*y.size.terms.items()])


def rounded(x):
    return x if isinstance(x, Rounded) else Rounded(abs(Fraction(x)))


def exact(name):
    """A double that is given."""
    return Rounded(symbol(name))


def total(numbers):
    return Rounded(sum((x.size for x in numbers), ZERO))


def substituted(polynomial, values):
    """With polynomials for symbols."""
    result = ZERO
    for key, x in polynomial.terms.items():
        product = Polynomial.of(x)
        for name in key:
            product = product * values.get(name, symbol(name))
        result = result + product
    return result


def squared(polynomial):
    """With k^2 for integers |k| that stand alone in a term: it is not less."""
    result = ZERO
    for key, x in polynomial.terms.items():
        alone = tuple(name for name in key if name[0] == "k" and key.count(name) == 1)
        result = result + Polynomial({tuple(sorted(key + alone)): x})
    return result


def convex(polynomial):
    """With 1 for weights w0, w1, ... that are not negative and whose sum is 1 at most."""
    result, alone = ZERO, {}
    for key, x in polynomial.terms.items():
        others = tuple(name for name in key if name[0] != "w")
        if others or key == ():
            result = result + Polynomial({others: x})
        else:
            alone[key] = alone.get(key, 0) + x
    return result + max(alone.values(), default=Fraction(0))


def evened(polynomial):
    """With (n0^2 + n1^2)/2 for n0 n1, and so on."""
    result = ZERO
    for key, x in polynomial.terms.items():
        pair = [name for name in key if name in ("n0", "n1", "n2")]
        others = tuple(name for name in key if name not in pair)
        for name in pair:
            result = result + Polynomial({tuple(sorted(others + (name, name))): x / 2})
        if not pair:
            result = result + Polynomial({key: x})
    return result


def second_order(polynomial):
    """With 2^30 for D beside a slip.  A slip is itself of order u, and angles that are off by more
    than 2^30 u are of no use to anybody."""
    result = ZERO
    for key, x in polynomial.terms.items():
        if "D" in key and any(name.startswith("slip") for name in key):
            key, x = tuple(name for name in key if name != "D"), x * 2 ** (30 * key.count("D"))
        result = result + Polynomial({key: x})
    return result


def of_doubles(off, name, rest=ZERO):
    """A bound by |x| of exact arithmetic, name, less rest, as one by the double that it is off: if
    off = a + c name and name <= |double| + rest + off, it is at most (|double| + rest + a)/(1 - c).
    """
    alone = off.terms.get((name,), Fraction(0))
    others = Polynomial((key, x) for key, x in off.terms.items() if key != (name,))
    if any(name in key for key in others.terms):
        raise NotCovered("%s is a factor of other errors" % name)
    return substituted(off, {name: (symbol(name) + rest + others) * (1 / (1 - alone))})


class NotCovered(Exception):
    """One line that says what a margin does not cover."""


def left(what, needed, there):
    """The least quotient of the coefficients of what is there and what is needed."""
    worst = None
    for key, x in needed.terms.items():
        y = there.terms.get(key, Fraction(0))
        if y < x:
            raise NotCovered("%s: of %s are needed %.3f u, there are %.3f u"
                             % (what, " ".join(key) or "1", x / UNIT, y / UNIT))
        worst = y / x if worst is None else min(worst, y / x)
    return worst


# ---- the waves

class Model:
    """A point q of an orbit, the one before, and the waves: so many with any k, or those of the
    thesis with theirs; what each function of the text sees."""

    def __init__(self, read, waves=None, angles=2, parameters=PARAMETERS):
        Rounded.known.clear()
        columns = angles + parameters
        self.columns, self.pairs, self.n = columns, columns * (columns + 1) // 2, angles
        self.entries = angles * (angles + 1) // 2
        thesis = waves is None
        self.texts = {name: read(name) for name in
                      ("arith/sine.h", "arith/sym.h", "arith/turns.h", "loewner/prism.h",
                       "loewner/orbit.c", "loewner/bound.c", "loewner/problem.c",
                       "loewner/waves.h")}
        self.first, self.slots = angles, angles + (3 if thesis else waves)
        present = range(self.first, self.slots)
        self.part = [[exact("g%d_%d" % (i, k)) if k >= angles and i in present else 0.0
                      for k in range(columns)] for i in range(self.slots)]
        h = [total(map(rounded, row)) for row in self.part]
        p = [Rounded(symbol("p%d" % i), symbol("p%d" % i) * (3 * UNIT)) if i in present else 0.0
             for i in range(self.slots)]        # set_amplitudes
        k = [[float(i == j) for j in range(angles)] for i in range(angles)] + (
            [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] if thesis else
            [[exact("k%d_%d" % (i, j)) for j in range(angles)] for i in present])
        problem = SimpleNamespace(
            present=[i in present for i in range(self.slots)], waves=self.slots, k=k,
            moves=[[True] * columns] * self.slots, phase=[self.phase(i) for i in range(self.slots)],
            square_k=[Rounded(total(row).size * total(row).size)
                      for row in (list(map(rounded, row)) for row in k)],
            columns=columns, most_k=2.0,
            axes=[[self.quotient(symbol("O%d_%d" % (i, j))) for j in range(angles)]
                  for i in range(angles)],
            onto=[[self.quotient(symbol("O%d.k%d" % (j, i))) for j in range(angles)]
                  for i in range(self.slots)],
            turn=[[self.quotient(symbol("w%d" % a) if a == b else 1)
                   for a in range(angles) for b in range(a, angles)]
                  for _ in range(self.entries)])
        self.w = SimpleNamespace(
            problem=problem, p=p, h=h, part=self.part, err_amp=[0.0] * self.slots,
            size=[Rounded(rounded(x).size + y.size) for x, y in zip(p, h)],
            residual=[exact("residual%d" % i) for i in range(angles)])
        self.names = {
            "SLOTS": self.slots, "FIRST": self.first, "COLUMNS": columns, "N": angles,
            "ENTRIES": self.entries, "ANGLES": 3, "MOST_ENTRIES": 6, "sym_at": self.sym_at,
            "PAIRS": self.pairs, "mag": lambda x: x, "fabs": lambda x: x, "every": lambda x: x,
            "memset": clear, "double_sincos": self.double_sincos, "larger": self.larger,
            "dot_k": self.dot_k, "none": lambda: 0, "wave_at": self.wave_at}
        for name in ("dot", "waves_of", "k_of", "grain_of", "sum_abs_k", "propagate",
                     "propagate_err"):
            self.names[name] = self.function(name)
        self.names["add_moves"] = function(self.texts["loewner/prism.h"],
                                           "add_moves").bound(self.names)
        self.sine_error = Fraction(defined(self.texts["arith/sine.h"], "SINE_ERROR"))
        self.turns_error = Fraction(defined(self.texts["arith/turns.h"], "TURNS_ERROR"))
        self.slipping = "LT"            # of these k.L, k.T are meant, not what doubles make of them
        self.slip = Fraction(1)         # of its slip so many times what is off along a wave
        self.slip = self.measured_slips()
        self.q, self.o, self.angles = self.point("L", "T"), self.point("O", "U"), {}
        self.function("evaluate")(self.w, self.q)

    def function(self, name, names=None):
        """One of waves.h."""
        return function(self.texts["loewner/waves.h"], name).bound(
            self.names if names is None else names)

    @staticmethod
    def sym_at(n, i, j):
        """As the text has it."""
        i, j = min(i, j), max(i, j)
        return i * (2 * n - i - 1) // 2 + j

    def quotient(self, size):
        """Of integers, by lengths: off by 4 u (set_axes).  As the axes have length 1 and are
        orthogonal, those of `turn` are 1 at most, and those of the diagonal have a sum of 1 at
        most."""
        return Rounded(size, Polynomial.of(size) * (4 * UNIT))

    def phase(self, i):
        """near() puts it 8 u off, and it may be 10^-40 off before."""
        return Rounded(symbol("f%d" % i), symbol("f%d" % i) * (8 * UNIT) + Fraction(1, 10 ** 39))

    def point(self, lin, quad):
        """A point as doubles have it.  Its rad is at least what lin and quad add up to."""
        q = SimpleNamespace(
            push=[0] * self.n,
            lin=[[exact("%s%d_%d" % (lin, i, k)) for i in range(self.n)]
                 for k in range(self.columns)],
            quad=[[exact("%s%d_%d" % (quad, i, k)) for i in range(self.n)]
                  for k in range(self.pairs)],
            sine=[None] * self.slots, cosine=[None] * self.slots, beta=[None] * self.entries)
        along = [[[exact("%s%d_%d" % (name, i, k)) for k in range(n)] for i in range(self.slots)]
                 for name, n in ((lin, self.columns), (quad, self.pairs))]
        q.lin_bound, q.quad_bound = [[*map(total, rows)] for rows in along]
        q.rad = [Rounded(a.size + b.size) for a, b in zip(q.lin_bound, q.quad_bound)]
        q.err_dot = [Rounded(total(exact("slip_%s%d_%d" % (name, i, k)) for name, n in
                                ((lin, self.columns), (quad, self.pairs)) for k in range(n)).size
                          * self.slip) for i in range(self.slots)]
        return q

    def dot_k(self, _, wave, x):
        """k.x of L and T: a symbol of its own, off by the slip that roundings make of it.
        A coordinate itself, and what is neither L nor T, is what the text makes of it."""
        text = self.function("dot_k")(self.w, wave, x)
        first = next(iter(x[0].size.terms))[0]
        if "_" not in first:
            return text
        name = "%s%d_%s" % (first[0], wave, first.split("_")[1])
        along = symbol(name)
        if name[0] not in self.slipping:
            return Rounded(along)
        return Rounded(along + symbol("slip_" + name), symbol("slip_" + name))

    def measured_slips(self):
        """How many times what k.L and k.T lose bound_err_dot has."""
        dot_k, q = self.function("dot_k"), self.point("L", "T")
        self.function("bound_err_dot")(self.w, q)
        found = (left("err_dot", sum((dot_k(self.w, j, x).off for rows in (q.lin, q.quad)
                                      for x in rows), ZERO), q.err_dot[j].least())
                 for j in range(self.first, self.slots))
        return min(filter(None, found))         # along k = (1, 0) nothing is lost

    def wave_at(self, _, q, wave):
        """The sines of turns.h as doubles: rounded once more.  The phase is off by a unit of 2^-64
        turns, less than 2^-61."""
        off = self.turns_error + Fraction(1, 2 ** 61)
        q.sine[wave] = q.cosine[wave] = Rounded(1, off + UNIT * (1 + off))

    def double_sincos(self, sine, cosine, angle):
        """Of loewner_at_once.  An angle is D u off at most, with far = D + N + 1: see larger."""
        self.angles[len(self.angles)] = angle.off
        off = symbol("D") * (UNIT * (1 + Fraction(1, 2 ** 30))) + self.sine_error
        for place in (sine, cosine):
            place.put(Rounded(1, off))

    def larger(self, _, value):
        """D is the larger; what it is compared with must be what the last angle is off."""
        wave = max(self.angles)
        slack = Polynomial.of(Fraction(1, 10 ** 38))    # of the phase; err_angle has one to spare
        left("err_angle", self.angles[wave],
             value.least() * (UNIT * (1 + Fraction(1, 2 ** 30))) + slack)
        return exact("D")


def clear(rows, value, _):
    for i, row in enumerate(rows):
        if isinstance(row, list):
            clear(row, value, None)
        else:
            rows[i] = float(value)


# ---- the margins

def err_beta(model):
    """beta is off by less than err_beta: the least quotient of what is there and what is needed."""
    return min(left("err_beta", x.off, model.q.err_beta.least()) for x in model.q.beta)


def turned(model):
    """beta along the axes, and its difference from the inverse, is off by less than the 2 err_beta
    of `step`."""
    made = [None] * model.entries
    model.function("along_axes")(model.w, made, model.q.beta)
    there = model.q.err_beta.least() * 2
    return min(left("axes", convex(x.off + (x.size + x.off) * UNIT), there) for x in made)


def propagated(model):
    """What lin and quad of the next point lose is less than what the step adds to force for it.

    wave_remainder counts from what doubles make of k.L, so the squares in T have no slips: what
    these lose bending_err has.  A
    sum is known: 2L - o, which is the next column less what the waves add."""
    w, q, o = model.w, model.q, model.o
    for i in range(model.n):
        for rows, before in ((q.lin, o.lin), (q.quad, o.quad)):
            for x, y in ((row[i], other[i]) for row, other in zip(rows, before)):
                less = symbol("less %s" % next(iter(x.size.terms))[0])
                Rounded.known[_sum(2.0 * x, y)] = less
    lin, quad = (SimpleNamespace(lin=[[None] * model.n for _ in range(model.columns)],
                                 quad=[[None] * model.n for _ in range(model.pairs)])
                 for _ in range(2))
    model.names["propagate"](w, lin, q, o)
    model.slipping = "T"
    model.names["propagate"](w, quad, q, o)
    bending_err = function(model.texts["loewner/orbit.c"], "bending_err").bound(model.names)
    bent = [bending_err(w, q, i) if i >= model.first else 0.0 for i in range(model.slots)]
    err = [model.names["propagate_err"](w, q, i) if i >= model.first else 0.0
           for i in range(model.slots)]
    worst = {"lin": [], "quad": []}
    for i in range(model.n):
        lost, made = [], []
        for rows in (lin.lin, quad.quad):
            lost.append(ZERO)
            for x in (row[i] for row in rows):
                off = x.off
                for key in [key for key in x.size.terms if key[0].startswith("less ")]:
                    # what is less is at most what is made, and what the waves add
                    off = of_doubles(off, *key, x.size - symbol(*key))
                    made.append(exact(*key))
                lost[-1] = lost[-1] + second_order(off)
        there = model.names["sum_abs_k"](w, i, err).least()
        there = there + (total(made) + o.rad[i]).least() * (8 * UNIT)
        both = there + model.names["sum_abs_k"](w, i, bent).least()
        left("lin and quad", lost[0] + lost[1], both)
        worst["lin"].append(left("lin", lost[0], there))
        worst["quad"].append(left("quad", lost[1], both))
    return {name: min(row) for name, row in worst.items()}


def sines(model):
    """wave_remainder counts sines and cosines as more than they may be."""
    text = function(model.texts["loewner/orbit.c"], "wave_remainder")
    off = rounded(execute(text.initial("off"), {}))
    return min(left("sines in wave_remainder", x.off, off.least())
               for x in (model.q.sine + model.q.cosine)[model.first:] if x is not None)


def multipliers(model):
    """What (2) of bound.c leaves is less than `left`.  Known is mu[j-1], which (2) makes."""
    text, q, w = model.texts["loewner/bound.c"], model.q, model.w
    q.n, q.mu = [[exact("%s%d" % (name, i)) for i in range(2)] for name in ("n", "mu")]
    names = {**model.names, "square": lambda x: x * x, "w": w, "q": q, "tiny": 0.0,
             "before": exact("before"), "after": exact("after")}
    names["gradient"] = model.function("gradient", names)
    names["sym_times"] = function(model.texts["arith/sym.h"], "sym_times").bound(names)
    omega = [x * x for x in (model.dot_k(w, i, q.n) for i in range(2))]
    names["weights"] = model.function("weights_of")(w, omega, q.mu)
    there = execute(function(text, "sum_left").initial("left"), names).least()
    worst = []
    for i in range(2):
        steep = function(text, "steepness").bound(names)(w, q, i)
        Rounded.known[_sum(steep, names["after"])] = symbol("before")
        off = of_doubles((steep - names["after"]).off, "before")
        worst.append(left("left", evened(off), there))
    return min(worst)


class Kept(list):
    """Keeps what is put into it, and has doubles with names instead."""

    def __init__(self, name, count):
        super().__init__(exact("%s%d" % (name, i)) for i in range(count))
        self.made = {}

    def __setitem__(self, i, value):
        self.made[i] = value


def widen(model):
    """All that orbit.c multiplies by WIDEN is at least what it stands for."""
    text, names = model.texts["loewner/orbit.c"], dict(model.names)
    factor = Fraction(constant(text, "WIDEN"))
    names.update(WIDEN=exact("WIDEN"), bound_err_dot=lambda *_: None,
                 larger=lambda *_: exact("rad_max"),
                 **{name: function(text, name).bound(names)
                    for name in ("wave_remainder", "bending_err")})
    for name in ("rem_along", "sum_onto", "onto_axis", "along_axes"):
        names[name] = model.function(name)
    wave = {name: Kept(name, model.slots) for name in
            ("lin_bound", "quad_bound", "nonlin_bound", "rad", "err_dot", "p", "h", "err_amp",
             "size", "weight",
             "cosine", "sine")}
    angles, entries = model.n, model.entries
    pair = {name: Kept(name, angles) for name in ("rem", "force")}
    q = SimpleNamespace(lin=model.q.lin, quad=model.q.quad, **wave, **pair,
                        err_beta=exact("err_beta"), d=Kept("d", entries),
                        rad_max=None)
    w = SimpleNamespace(problem=model.w.problem, residual=model.w.residual, **wave)
    o = SimpleNamespace(rad=Kept("before", model.slots), force=Kept("push", angles),
                        rem=Kept("last", angles))
    slips, model.slipping = model.slipping, ""      # see propagated
    function(text, "measure").bound(names)(w, q)
    model.slipping = slips
    function(text, "bound_displacement").bound(names)(w, q)
    following = SimpleNamespace(rem=Kept("rem", angles), lin_bound=q.lin_bound,
                                quad_bound=q.quad_bound)
    function(text, "set_force").bound(names)(w, following, q, o, Kept("inverse", entries),
                                             exact("rounded"), 0)
    function(text, "set_remainder").bound(names)(following, q)
    made = [kept.made for kept in
            (q.lin_bound, q.quad_bound, q.nonlin_bound, q.rad, q.force, following.rem)]
    if not all(made):
        raise NotCovered("widen: orbit.c no longer makes one of those sums where it did")
    worst = []
    for x in (x for kept in made for x in kept.values() if x.size.terms):
        if any(key.count("WIDEN") != 1 for key in x.size.terms):
            raise NotCovered("widen: a sum is not multiplied by WIDEN, or twice")
        whole = substituted(x.size, {"WIDEN": Polynomial.of(1)})
        off = substituted(x.off, {"WIDEN": Polynomial.of(factor)})
        worst.append(left("widen", off, whole * (factor - 1)))
    return min(worst)


def at_once(model):
    """The roundings of loewner_at_once are less than the margin it asks for, for all parameters and
    at their end.  near() puts amplitudes 8 u off; and |k.n|^2 <= (|k0| + |k1| + ...)^2 |n|^2, also
    of sizes."""
    text = model.texts["loewner/problem.c"]

    def off_by(x, units):
        return Rounded(x.size, x.size * (units * UNIT)) if isinstance(x, Rounded) else x

    problem, w = model.w.problem, model.w
    given = SimpleNamespace(
        waves=model.slots, angles=model.n, k=problem.k, phase=problem.phase,
        square_k=problem.square_k, n_parameters=3,
        err_amplitude=w.err_amp, amplitude=[off_by(x, 8) for x in w.p],
        part=[[off_by(exact("g%d_%d" % (i, m)), 8) if i >= model.first else 0.0 for m in range(3)]
              for i in range(model.slots)])
    worst = []
    for at_end in (0, 1):
        model.angles = {}

        def eigenvector(angles, _, n):
            n[:angles] = [exact("n%d" % i) for i in range(angles)]

        names = {**model.names, "square": lambda x: x * x, "sym_least_eigenvector": eigenvector,
                 "SLOTS": model.slots, "w": given,
                 "x": [exact("x%d" % i) for i in range(model.n)], "at_end": at_end,
                 "size_of": function(text, "size_of").bound(model.names)}
        *rest, last = function(text, "loewner_at_once").statements
        run(rest, names)
        n = [symbol("n%d" % i) for i in range(model.n)]
        length = sum((x * x for x in n), ZERO)
        needed = names["sum"].off + length * (UNIT * 4 / 3)     # 4/3 is a double, too
        try:
            margin = last.expr.right.left.right                 # mass >= 1 && sum + margin < 0
        except AttributeError:
            raise CTextError("loewner_at_once ends with another comparison") from None
        worst.append(left("at once", evened(needed), execute(margin, names).least()))
    return min(worst)


def proved(read, parameters=PARAMETERS):
    """The margins of section 8 of docs/proofs/argument.md that the text of csrc proves, read(file)
    of it: how many times what is needed there is, of the thesis's waves, and of one, of three, and
    of as many as may be of one, two and three angles."""
    result = {}
    for waves, angles in [(None, 2), *product((1, 3, MOST_WAVES), (1, 2, 3))]:
        model = Model(read, waves, angles, parameters if waves != MOST_WAVES else 0)
        found = {"err_beta": err_beta(model), "axes": turned(model), **propagated(model),
                 "sines in wave_remainder": sines(model), "err_dot": model.slip,
                 "widen": widen(model)}
        found.update({"left": multipliers(model)} if waves is None else {"at once": at_once(model)})
        for name, x in found.items():
            result[name] = min(x, result.get(name, x))
    return result


def main():
    try:
        for name, x in proved(lambda file: (ROOT / "csrc" / file).read_text("utf-8")).items():
            print("%-22s %.2f times what is needed" % (name, x))
    except (NotCovered, CTextError) as error:
        print("csrc/loewner: %s" % error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
