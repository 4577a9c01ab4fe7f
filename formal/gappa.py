"""Proves what csrc/arith/sine.h promises, from its own text, by Gappa and exact arithmetic.

    python formal/gappa.py [--coq] [DIRECTORY]

The C text of double_sincos is executed with names for numbers, which makes of it Gappa scripts:
each +, -, * rounded to nearest, in the order of the text, each constant the double that it stands
for.  They are left in DIRECTORY, build/gappa by default.  Exit status 1, and one line, if anything
of it cannot be proved.  --coq: Gappa writes its proofs down for Coq, which checks them and makes
of them, and of the text's operations, the theorem in sine/Sine.v.

The proof.  Let |x| <= SINE_LIMIT, u = 2^-53.

1. Gappa: n is an integer, |n| <= 2^20, n = shifted - SHIFT, and n is next to INV x.
2. Exact polynomials: without roundings r = x - K n.  An enclosure of pi, by Machin's formula in
   rational numbers: K is within delta of pi/2.
3. Gappa, for n <= -1 and n >= 1: rho = x - n pi/2 is at most about pi/4, and how far r is off it.
   Where n = 0, r is x.
4. Gappa: how far sine and cosine are from the same without roundings, S(r) and C(r).
5. Exact polynomials: the coefficients of S and C beside Taylor's, and Lagrange's remainder: how far
   S(r) is from sin r, C(r) from cos r.
6. Exact arithmetic: |sine - sin rho| is at most what 4 and 5 say, and |r - rho|; |cosine - cos rho|
   the same with |r - rho| max(|r|, |rho|), as |sin t| <= |t|.
7. The last lines of the text, executed for each n modulo 4 with sine and cosine as they are: s is
   the sine of n pi/2 + rho, c its cosine.  They look at the last two bits of shifted alone, and
   these are those of n: shifted is between 2^52 and 2^53.

What is trusted: Gappa, which checks the hints that it is given, and the exact arithmetic; with
--coq, where Sine.v has steps 2 to 6 and the quadrants as well, Coq in their place.  In either case:
that the machine computes as IEEE 754 says (csrc/arith/machine.c looks); the reading of the C
text, which tests compare bit by bit with what the compiler made of it; and step 7.
"""

import math
import os
import re
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent))
from ctext import CTextError, Place, defined, function, run  # noqa: E402
from polynomial import symbol  # noqa: E402

from converse.model.exact import pi_bounds  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
HEADER = ROOT / "csrc" / "arith" / "sine.h"
UNIT = Fraction(1, 2 ** 53)
THEOREM = ROOT / "formal" / "sine" / "Sine.v"
SECONDS = 300                           # that a script or a proof may take


class NotProved(Exception):
    """One line that says what is not."""


# ---- the text as a Gappa script

def dyadic(x):
    """A number with finitely many bits as Gappa writes it."""
    x = Fraction(x)
    bits = x.denominator.bit_length() - 1
    if x.denominator != 1 << bits:
        raise NotProved("%s is no sum of powers of two" % x)
    return "%db-%d" % (x.numerator, bits) if bits else str(x.numerator)


class Text:
    """An expression of Gappa's language; `rounded`: are operations those of doubles?"""

    rounding, number = "rnd%s", staticmethod(dyadic)

    def __init__(self, text, rounded):
        self.text, self.rounded = text, rounded

    def _with(self, sign, left, right):
        left, right = (x.text if isinstance(x, Text) else self.number(x) for x in (left, right))
        text = "(%s %s %s)" % (left, sign, right)
        return type(self)(self.rounding % text if self.rounded else text, self.rounded)

    def __add__(self, other):
        return self._with("+", self, other)

    def __radd__(self, other):
        return self._with("+", other, self)

    def __sub__(self, other):
        return self if _is_zero(other) else self._with("-", self, other)    # doubles are exact

    def __rsub__(self, other):
        return self._with("-", other, self)

    def __mul__(self, other):
        return self._with("*", self, other)

    def __rmul__(self, other):
        return self._with("*", other, self)

    def __neg__(self):
        return type(self)("(-%s)" % self.text, self.rounded)


def _is_zero(x):
    return not isinstance(x, Text) and x == 0


class CoqText(Text):
    """The same in Coq's, with the numbers of Gappa's library."""

    rounding = "(rnd %s)"

    @staticmethod
    def number(x):
        mantissa, _, exponent = dyadic(x).partition("b")
        if exponent:
            return "(Float2 (%s) (%s))" % (mantissa, exponent)
        return "(Float1 (%s))" % mantissa


class Unknown:
    """What a script does not look at."""

    def _same(self, *_):
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = _same


def declared(text, free, until, kind):
    """Executes double_sincos until it declares that variable, with these for the free variables
    whatever the text makes of them, and kind(name, value) for what is declared after the last."""
    values = {"x": Unknown(), **free}
    statements = function(text, "double_sincos").statements
    order = [getattr(node, "name", None) for node in statements]
    begin = max((order.index(name) for name in free if name in order), default=-1)

    def noted(name, value):
        if name in free:
            value = free[name]
        elif order.index(name) > begin:
            value = kind(name, value)
        values[name] = value
        return value

    names = dict(values)
    for node in statements:
        run([node], names, noted)
        if until in values:
            return values
    raise CTextError("double_sincos declares no %s" % until)


def expanded(text, free, until):
    """What the text makes of the free variables, without roundings: polynomials."""
    return declared(text, {name: symbol(name) for name in free}, until,
                    lambda _, value: value)


def lines(text, free, until, rounded=True):
    """Gappa's definitions of what the text makes of the free variables; without roundings the names
    begin with M."""
    found = []

    def kind(name, value):
        if not isinstance(value, Text):
            return value                # a constant, or what is not looked at
        name = name if rounded else "M" + name
        found.append("%s = %s;\n" % (name, value.text))
        return Text(name, rounded)

    declared(text, {name: Text(name, rounded) for name in free}, until, kind)
    return "".join(found)


def definitions(text):
    """The same as functions in Coq: name_ rounded, name_exact without roundings."""
    found = ["Require Import Reals.", "From Gappa Require Import Gappa_library.",
             "Definition rnd := Generic_fmt.round radix2 (FLT.FLT_exp (-1074) 53) rndNE."]
    for free, until, kinds in ((["x"], "n", (True,)), (["x", "n"], "r", (True, False)),
                               (["r"], "cosine", (True, False))):
        for rounded in kinds:
            def kind(name, value):
                if not isinstance(value, Text):
                    return value
                name = name + ("_" if rounded else "_exact")
                found.append("Definition %s (%s : R) : R := %s%%R."
                             % (name, " ".join(free), value.text))
                return CoqText("(%s %s)" % (name, " ".join(free)), rounded)

            declared(text, {name: CoqText(name, rounded) for name in free}, until, kind)
    return "\n".join(found) + "\n"


class Gappa:
    """Runs scripts, and leaves them in a directory; with_coq: and has Coq check the proofs."""

    def __init__(self, directory, with_coq):
        self.directory, self.with_coq = Path(directory), with_coq
        self.directory.mkdir(parents=True, exist_ok=True)
        self.seconds = {"gappa": 0.0, "coqc": 0.0}

    def bounds(self, name, script):
        """Proves a script; returns the intervals that it asks for."""
        file = name + ".g"
        (self.directory / file).write_text("@rnd = float<ieee_64, ne>;\n" + script, "utf-8")
        backend = "-Bcoq" if self.with_coq else "-Bnull"
        proof, output = self._run("gappa", "-Eprecision=120", backend, file)
        found = {key: (_number(low), _number(high)) for key, low, high in re.findall(
            r"^  (.*) in \[(\S+)(?: \{[^}]*\})?, (\S+?)(?: \{[^}]*\})?\]$", output, re.MULTILINE)}
        wanted = re.findall(r"(\S+(?: - \S+)?) in \?", script)
        if any(key not in found for key in wanted):
            raise NotProved("%s: Gappa finds no bounds" % file)
        if self.with_coq:
            (self.directory / (name + ".v")).write_text(proof, "utf-8")
            self._run("coqc", "-q", "-w", "-all", name + ".v")
        return [found[key] for key in wanted]

    def conclude(self, text):
        """Has Coq make the theorem of Sine.v of all that: the text's operations, Gappa's proofs."""
        (self.directory / "header.v").write_text(definitions(text), "utf-8")
        (self.directory / THEOREM.name).write_text(THEOREM.read_text("utf-8"), "utf-8")
        for name in ("header.v", THEOREM.name):
            self._run("coqc", "-q", "-w", "-all", name)

    def _run(self, *command):
        began = time.monotonic()
        try:
            done = subprocess.run(command, cwd=self.directory, capture_output=True, text=True,
                                  timeout=SECONDS)
        except FileNotFoundError:
            raise NotProved("the command %s is missing; `make gappa` installs what is needed"
                            % command[0]) from None
        except subprocess.TimeoutExpired:
            raise NotProved("%s: %s does not end" % (command[-1], command[0])) from None
        self.seconds[command[0]] += time.monotonic() - began
        # Gappa warns of hints that are no identities, and goes on
        if done.returncode != 0 or "Warning" in done.stderr:
            raise NotProved("%s: %s does not prove it: %s"
                            % (command[-1], command[0], " ".join(done.stderr.split())[:200]))
        return done.stdout, done.stderr


def _number(text):
    mantissa, _, exponent = text.partition("b")
    return int(mantissa) * Fraction(2) ** int(exponent or 0)


def largest(interval):
    return max(map(abs, interval))


# ---- what exact arithmetic proves

def half_pi():
    """An interval that holds pi/2, below 1e-60 wide."""
    low, high = pi_bounds(60)
    return low / 2, high / 2


def distance_from_taylor(found, first, radius):
    """How far a polynomial in r may be from sin r or cos r (first: the degree it begins with) for
    |r| <= radius: the coefficients' differences from Taylor's, and Lagrange's remainder, as all
    derivatives are at most 1."""
    degree = max(map(len, found.terms))
    if any(set(key) - {"r"} for key in found.terms):
        raise NotProved("the polynomials are not in r alone")
    off = radius ** (degree + 2) / math.factorial(degree + 2)      # the next but one: parity
    for k in range(degree + 1):
        taylor = Fraction((-1) ** (k // 2), math.factorial(k)) if k % 2 == first else Fraction(0)
        off += abs(found.terms.get(("r",) * k, 0) - taylor) * radius ** k
    return off


class Signed:
    """A double known by name but for its sign; `^` with a sign bit changes that."""

    def __init__(self, name, sign):
        self.name, self.sign = name, sign

    def __xor__(self, bits):
        if bits not in (0, 1 << 63):
            raise NotProved("the results are more than sine or cosine with a sign")
        return Signed(self.name, -self.sign if bits else self.sign)

    def __or__(self, bits):
        if bits != 0:
            raise NotProved("the results are NaN")
        return self


class LastBits:
    """An integer of which the last two bits are known."""

    def __init__(self, value):
        self.value = value % 4

    def __add__(self, other):
        return LastBits(self.value + other)

    def __and__(self, mask):
        if not 0 <= mask < 4:
            raise NotProved("the quadrant looks at more than two bits")
        return self.value & mask


def results(text, n):
    """What s and c are, (name, sign), where n has these last two bits and x is not too large."""
    statements = function(text, "double_sincos").statements
    names = [getattr(node, "name", None) for node in statements]
    if "bits" not in names or {"shifted", "sine", "cosine"} - {*names[:names.index("bits")]}:
        raise CTextError("double_sincos declares bits, but not shifted, sine and cosine before it")
    shifted, found = object(), {}
    scope = {
        "x": 0.0, "shifted": shifted, "sine": Signed("sine", 1), "cosine": Signed("cosine", 1),
        "s": Place(None, lambda value: found.update(s=value)),
        "c": Place(None, lambda value: found.update(c=value)),
        "bits_of": lambda x: LastBits(n) if x is shifted else x, "vec_of": lambda x: x,
        "pick": lambda m, x, y: {-1: x, 0: y}[m], "TRUTH": lambda truth: -int(truth),
        "mag": abs, "SINE_LIMIT": defined(text, "SINE_LIMIT"),
    }
    run(statements[names.index("bits"):], scope)
    return [(found[name].name, found[name].sign) for name in "sc"]


# ---- the proof

def prove(text, directory, with_coq=False):
    """Proves the header's promise of this text; returns the bounds of sine and cosine that are
    proved, and the seconds that Gappa took."""
    error, limit = (Fraction(defined(text, name)) for name in ("SINE_ERROR", "SINE_LIMIT"))
    gappa = Gappa(directory, with_coq)

    # 1. the turns
    exact = expanded(text, ["x"], "n")
    inverse = exact["n"].terms.get(("x",), Fraction(0))
    shift = (exact["shifted"] - exact["n"]).terms.get((), Fraction(0))
    if exact["n"].terms != {("x",): inverse} or shift % 4 or exact["shifted"].terms != {
            ("x",): inverse, (): shift}:
        raise NotProved("shifted and n are not INV x + SHIFT, 4 dividing SHIFT, and INV x")
    turns, off = gappa.bounds("turns", """x = rnd(x_);
%s%s{ |x| <= %s
  -> @FIX(shifted, 0) /\\ shifted in [0x1p52, 0x1.fffffffffffffp52]
     /\\ n - (shifted - %s) in [0, 0] /\\ n in ? /\\ n - Mn in ? }
""" % (lines(text, ["x"], "n"), lines(text, ["x"], "n", False), dyadic(limit), dyadic(shift)))
    turns, off = largest(turns), largest(off)
    if turns > 2 ** 20:
        raise NotProved("n may be %d" % turns)

    # 2. pi/2
    r = expanded(text, ["x", "n"], "r")["r"]
    K = -r.terms.get(("n",), Fraction(0))
    if r.terms != {("x",): Fraction(1), ("n",): -K}:
        raise NotProved("r is not x - K n")
    delta = rounded_up(largest(end - K for end in half_pi()))

    # 3. r
    at_zero = declared(text, {"x": Text("x", True), "n": 0.0}, "r", lambda _, value: value)
    if at_zero["r"].text != "x":
        raise NotProved("r is not x where n = 0")
    far, off_r = off / inverse, Fraction(0)     # there rho = r = x, |INV x| <= off
    for name, low, high in (("before", -turns, -1), ("after", 1, turns)):
        rho, r_off = gappa.bounds("reduced_" + name, """x = rnd(x_);
%s%sH = %s + delta;
rho = x - n * H;
{ @FIX(n, 0) /\\ n in [%s, %s] /\\ |n - %s * x| <= %s /\\ |delta| <= %s
  -> rho in ? /\\ r - rho in ? }
rho -> x * (1 - %s * H) - (n - %s * x) * H;
x -> (n - (n - %s * x)) / %s;
r - rho -> (r - Mr) + n * delta;
""" % (lines(text, ["x", "n"], "r"), lines(text, ["x", "n"], "r", False), dyadic(K), low, high,
            *map(dyadic, (inverse, off, delta, inverse, inverse, inverse, inverse))))
        far, off_r = max(far, largest(rho)), max(off_r, largest(r_off))
    size = rounded_up(far + off_r)

    # 4. the roundings of the polynomials
    sine_off, cosine_off = (largest(*gappa.bounds(name, """r = rnd(r_);
%s%s{ |r| <= %s -> %s - M%s in ? }
%s""" % (lines(text, ["r"], name), lines(text, ["r"], name, False), dyadic(size), name, name,
         hint))) for name, hint in (("sine", ""), ("cosine", "$ r in 8;\n")))

    # 5. the polynomials
    polynomials = expanded(text, ["r"], "cosine")
    from_sine = distance_from_taylor(polynomials["sine"], 1, size)
    from_cosine = distance_from_taylor(polynomials["cosine"], 0, size)

    if with_coq:
        gappa.conclude(text)

    # 6. and 7.
    quadrants = [[("sine", 1), ("cosine", 1)], [("cosine", 1), ("sine", -1)],
                 [("sine", -1), ("cosine", -1)], [("cosine", -1), ("sine", 1)]]
    for n, expected in enumerate(quadrants):
        if results(text, n) != expected:
            raise NotProved("the results are not those of n = %d modulo 4" % n)
    sine, cosine = sine_off + from_sine + off_r, cosine_off + from_cosine + off_r * size
    proved = Proof(turns, off, K, delta, far, off_r, sine_off, cosine_off, from_sine, from_cosine,
                   sine, cosine, error, gappa.seconds)
    if max(sine, cosine) > error:
        raise NotProved("sine.h promises %s; proved are %s for the sine and %s for the cosine"
                        % tuple(map(power, (error, sine, cosine))))
    return proved


class Proof(NamedTuple):
    """What was proved on the way, by the numbers above; sine and cosine: of the results."""
    turns: Fraction
    off: Fraction
    K: Fraction
    delta: Fraction
    far: Fraction
    off_r: Fraction
    sine_off: Fraction
    cosine_off: Fraction
    from_sine: Fraction
    from_cosine: Fraction
    sine: Fraction
    cosine: Fraction
    error: Fraction
    seconds: dict


def rounded_up(x):
    """A number with 64 bits or fewer, not below x > 0."""
    x = Fraction(x)
    scale = Fraction(2) ** (64 - x.numerator.bit_length() + x.denominator.bit_length())
    return -(-x * scale // 1) / scale


def power(x):
    """For people: x as a power of two."""
    return "2^%.3f" % math.log2(x)


def main(arguments):
    with_coq = arguments[:1] == ["--coq"]
    directory = (arguments[with_coq:] or [ROOT / "build" / "gappa"])[0]
    try:
        proof = prove(HEADER.read_text("utf-8"), directory, with_coq)
    except (NotProved, CTextError) as error:
        print("%s: %s" % (HEADER.relative_to(ROOT), error), file=sys.stderr)
        return 1
    u = {name: float(value / UNIT) for name, value in proof._asdict().items()
         if isinstance(value, Fraction)}
    best = max(proof.sine, proof.cosine)
    print("%s, |x| <= SINE_LIMIT, u = 2^-53:" % HEADER.relative_to(ROOT))
    for row in (
            ("n", "an integer, |n| <= %d, |n - INV x| <= %.7f" % (proof.turns, proof.off), "Gappa"),
            ("K", "within %s of pi/2" % power(proof.delta), "exact"),
            ("rho", "|x - n pi/2| <= %.7f" % proof.far, "Gappa"),
            ("r", "|r - rho| <= %.4f u" % u["off_r"], "Gappa"),
            ("sine", "off S(r) by %.4f u" % u["sine_off"], "Gappa"),
            ("S(r)", "off sin r by %.4f u" % u["from_sine"], "exact"),
            ("cosine", "off C(r) by %.4f u" % u["cosine_off"], "Gappa"),
            ("C(r)", "off cos r by %.4f u" % u["from_cosine"], "exact")):
        print("  %-7s %-48s %s" % row)
    print("Proved: sine within %.4f u, cosine within %.4f u = %s; promised: %s, %.2f times as much."
          % (u["sine"], u["cosine"], power(best), power(proof.error), proof.error / best))
    if with_coq:
        print("Coq has checked all of that: theorem double_sincos of %s."
              % THEOREM.relative_to(ROOT))
    print("Gappa took %.1f s%s; its scripts are in %s."
          % (proof.seconds["gappa"], ", Coq %.1f s" % proof.seconds["coqc"] if with_coq else "",
             os.path.relpath(directory)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
