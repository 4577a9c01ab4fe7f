"""Writes a finished proof file as a theorem for Coq: python formal/theorem.py FILE NAME > NAME.v

The claim, exact, is that of the file's header as converse-check reads it.  The tree, and the hints
(a bound B of the largest eigenvalue, l, and where the eigenvalue is small enough for larger
parameters to be excluded at once), are only proposals: Coq's kernel finds that they serve, or that
they do not, and then there is no theorem.

A long proof is divided: NAME_claim.v (--claim) has the definitions, NAME_0.v, NAME_1.v, ... (--part)
have every K-th leaf each, and can be compiled side by side, and NAME.v (--parts) puts them together.
"""

import argparse
import itertools
import math
import re
import sys
from fractions import Fraction
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from converse import check                                      # noqa: E402  (it needs the path)

WIDTH = 100                                                     # of a line
DIGITS = 10 ** 9                                                # of a hint, decimal


def number(x):
    """In Coq's notation for exact rationals: a decimal, or else a ratio."""
    x = Fraction(x)
    rest = x.denominator
    for p in (2, 5):
        while rest % p == 0:
            rest //= p
    text = check.decimal_text(x) if rest == 1 else "%d # %d" % (x.numerator, x.denominator)
    return text if re.fullmatch("[0-9.]+", text) else "(%s)" % text


def pair(xy):
    return "(%s, %s)" % tuple(map(number, xy))


def term(wave):
    return "Term %s %s %s %s [%s]" % (*map(number, wave.k), number(wave.phase), number(wave.middle),
                                      "; ".join(map(number, wave.parts)))


def odd_about(path):
    """The point of which the header says that V is odd about it, or None: not kept by the checker."""
    found = re.search(rb"^odd about: (.*)\n", check.load(path), re.M)
    if found is None:                                           # version 2: the thesis's potential
        return Fraction(0), Fraction(0)
    text = found[1].decode("ascii")
    return None if text == "no" else tuple(map(Fraction, text.split(" ")))


# ---- hints

def floats(waves, t):
    return [(*wave.k, math.pi * float(wave.phase), float(wave.at(t))) for wave in waves]


def eigenvalues(waves, y):
    """Of beta(y), the lesser and the larger, and a vector of the lesser."""
    a, b, d = 2.0, 0.0, 2.0
    for k0, k1, phase, p in waves:
        s = p * math.sin(k0 * y[0] + k1 * y[1] + phase)
        a, b, d = a - s * k0 * k0, b - s * k0 * k1, d - s * k1 * k1
    middle, radius = (a + d) / 2, math.hypot((a - d) / 2, b)
    least = middle - radius
    return least, middle + radius, (least - d, b) if a < d else (b, least - a)


def lowest(waves, f):
    """Where f is least on the torus, about."""
    count = min(16 * max([abs(k) for wave in waves for k in wave[:2]] + [1]), 128)
    width = 2 * math.pi / count
    y = min(itertools.product([i * width for i in range(count)], repeat=2), key=f)
    while width > 1e-9:
        y = min(itertools.product(*((x - width, x, x + width) for x in y)), key=f)
        width /= 1.5
    return y


def hints(claim):
    """B, l and the place and the vector of `at once`."""
    waves, parameters = claim.felt, claim.parameters
    B = 2.0
    for corner in itertools.product((-1, 1), repeat=parameters):
        at = floats(waves, corner)
        y = lowest(at, lambda y: -eigenvalues(at, y)[1])
        B = max(B, eigenvalues(at, y)[1])
    B = math.ceil(B * (1 + 1e-6) * DIGITS) / DIGITS             # for the kernel to see it fast
    l = 2 / (B + math.sqrt(B * B - 4))
    at = floats(waves, [1 if claim.at_once == "upper end" else 0] * parameters)
    y = lowest(at, lambda y: eigenvalues(at, y)[0])
    n = eigenvalues(at, y)[2]
    size = math.hypot(*n) or 1

    def near(x):
        return Fraction(math.floor(x * DIGITS), DIGITS)

    return (Fraction(round(B * DIGITS), DIGITS), near(l) - Fraction(1, DIGITS),
            [near(x / math.pi) for x in y], [near(x / size) for x in n])


# ---- the text

def tree_text(tree):
    width = WIDTH - 6
    return '";\n   "'.join(tree[k:k + width] for k in range(0, len(tree), width))


def patch_text(claim, indent):
    """The waves, one a line."""
    return "[" + (";\n" + " " * (indent + 1)).join(map(term, claim.waves)) + "]"


def region_text(claim):
    (c0, c1), (h0, h1) = claim.centre, claim.half
    return "(Region %s %s)" % (" ".join(map(number, claim.frame)),
                               " ".join(map(number, (c0, h0, c1, h1))))


HEAD = """\
(* Made by formal/theorem.py from the proof file whose SHA-256 is
   %s. *)

From Coq Require Import Reals ZArith QArith List String Bool.
From Converse Require Import Map Tree Share Reduce Check %s.
Import ListNotations.
Open Scope Q_scope.

"""
USING = "From Converse.build Require Import %s.\n\n"


def statement(claim):
    """What is proved, spelled out in the words of Map.v: it is Check.statement of the claim."""
    patch = "let patch :=\n    %s in\n  " % patch_text(claim, 4)
    lines = ["forall t, in_cube t -> no_invariant_graph (waves patch t)"]
    if min(claim.half) < 1:
        lines = ["no_minimizing_orbit_into %s patch %s" % (region_text(claim), pair(claim.xstar))]
    if claim.at_once == "yes":
        lines += ["forall t s, in_cube t -> (1 <= s)%R -> no_invariant_graph (scaled s (waves patch t))"]
    elif claim.at_once == "upper end":
        lines += ["forall s, (1 <= s)%R -> no_invariant_graph (scaled s (waves patch [1%R]))"]
    return patch + " /\\\n  ".join(["(%s)" % line for line in lines] if lines[1:] else lines)


def definitions(claim, odd, name):
    """The claim, the hints and the tree."""
    B, l, place, vector = hints(claim)
    alone = {None: "Both", 0: "First", 1: "Second"}[claim.alone]
    once = {"no": "No", "yes": "Whole_patch", "upper end": "Upper_end"}[claim.at_once]
    return """\
Definition %s_claim : claim :=
  %s

Definition %s_hints : hints :=
  %s

Definition %s_tree : tree := read_tree
  ["%s"]%%string.

""" % (name, "Claim %s\n  %s %s %s %s %s." % (
            patch_text(claim, 8), region_text(claim), pair(claim.xstar), alone, once,
            "None" if odd is None else "(Some %s)" % pair(odd)),
       name, "Hints %s %s (%s, %s)." % (number(B), number(l), pair(place), pair(vector)),
       name, tree_text(claim.tree))


COMPUTED = "Proof. vm_cast_no_check (eq_refl true). Qed.\n\n"


def part(name, i, count):
    return ("Lemma {0}_{1} : forallb (leaf_ok {0}_claim {0}_hints)\n"
            "  (share {1} {2} (leaves_of {0}_claim {0}_tree)) = true.\n" + COMPUTED).format(
                name, i, count)


def theorem(claim, name, count):
    return """\
Lemma {0}_header : header_ok {0}_claim {0}_hints {0}_tree = true.
{2}Theorem {0} :
  {1}.
Proof.
  refine (check_sound {0}_claim {0}_hints {0}_tree _).
  apply andb_true_intro. split; [exact {0}_header |].
  apply (shares_all _ _ {3}); [| repeat constructor].
  exact ({4}).
Qed.

Add Printing Constructor term region.
Set Printing Width 100.
Check {0}.
Print Assumptions {0}.
""".format(name, statement(claim), COMPUTED, count,
           "".join("Forall_cons _ %s_%d (" % (name, i) for i in range(count))
           + "Forall_nil _" + ")" * count)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("file", help="a finished proof file")
    parser.add_argument("name", help="of the theorem")
    parser.add_argument("--integers", action="store_true",
                        help="compute with Coq's own integers, not with the processor's numbers")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--claim", action="store_true", help="only the definitions")
    which.add_argument("--part", type=int, nargs=2, metavar=("I", "K"),
                       help="only the lemma about every K-th leaf from the I-th on")
    which.add_argument("--parts", type=int, metavar="K", help="only what K such lemmas prove")
    options = parser.parse_args()
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", options.name):
        sys.exit("theorem.py: the name is not letters, digits and _, a letter first")
    try:
        claim = check.read(options.file)
        if isinstance(claim, check.Map):
            raise check.Unusable("is a map; a theorem is made from a proof file")
        check.check_tree(claim)
        odd = odd_about(options.file)
    except check.Failure as error:
        sys.exit("theorem.py: %s: %s%s" % (check.shown(options.file), error.word, error))
    name, count = options.name, options.parts or 1
    text = HEAD % (claim.sha256, "Integers" if options.integers else "Doubles")
    parts = [name + "_%d" % i for i in range(count)]
    if options.claim:
        text += definitions(claim, odd, name)
    elif options.part:
        text += USING % (name + "_claim") + part(name, *options.part)
    elif options.parts:
        text += USING % " ".join([name + "_claim", *parts]) + theorem(claim, name, count)
    else:
        text += definitions(claim, odd, name) + part(name, 0, 1) + theorem(claim, name, 1)
    sys.stdout.write(text.rstrip("\n") + "\n")


if __name__ == "__main__":
    main()
