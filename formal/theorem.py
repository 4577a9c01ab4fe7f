"""Writes a finished proof file as a theorem for Coq: python formal/theorem.py FILE NAME DIRECTORY

The claim, exact, is that of the file's header as converse-check reads it.  The trees, and the hints
(a bound B of the largest eigenvalue, l, and where the eigenvalue is small enough for larger
parameters to be excluded at once), are only proposals: Coq's kernel finds that they serve, or that
they do not, and then there is no theorem.

Into the directory go NAME_says.v, the proposition, which imports Map.v alone; NAME_claim.v, which
has what the checker is to see; NAME_0.v, NAME_1.v, ..., each of which has it check every K-th leaf,
and which can be compiled side by side; and NAME.v, "Theorem NAME : NAME_says".  This last imports
nothing but Map.v and NAME_says.v: so whatever the others define, its words mean what they do there.

Of a certificate of existence, of the kind that Exists.v is about, it makes NAME_exists_says.v and
NAME_exists.v, which has the integers that `holds` of Exists.v is to find accurate enough; or it
says by how much they are not.
"""

import argparse
import itertools
import math
import re
import sys
import textwrap
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from converse import check  # noqa: E402  (it needs the path)
from converse.check import tori  # noqa: E402
from converse.check.claim import LETTERS  # noqa: E402
from converse.check.cover import symmetries_used  # noqa: E402
from converse.check.series import Box, Ring  # noqa: E402
from converse.check.tree import check_mirror_images  # noqa: E402
from converse.check.tree import leaves, trees  # noqa: E402

WIDTH = 100                                                     # of a line
DIGITS = 10 ** 9                                                # of a hint, decimal
# The r that are tried for the norms of a certificate of existence.
RADII = [1 + Fraction(1, n) for n in (2, 3, 4, 6, 8, 12, 16, 24, 32, 50, 64, 100)]
# A hundredth of the residual that the theorem allows is for the errors of Coq's computation.
ROUNDINGS = 100
MOST = Fraction(249, 500), Fraction(1997, 3000)     # norms of u and u' that Exists.v allows


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
    """The point of which the header says that V is odd about it, or None: not kept by the
    checker."""
    text = re.search(rb"^odd about: (.*)\n", check.load(path), re.M)[1].decode("ascii")
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


def near(x):
    return Fraction(math.floor(x * DIGITS), DIGITS)


def bound_and_tail(waves, ends):
    """B and l for parameters between these ends."""
    B = 2.0
    for corner in itertools.product(*ends):
        at = floats(waves, corner)
        y = lowest(at, lambda y: -eigenvalues(at, y)[1])
        B = max(B, eigenvalues(at, y)[1])
    B = math.ceil(B * (1 + 1e-6) * DIGITS) / DIGITS             # for the kernel to see it fast
    l = 2 / (B + math.sqrt(B * B - 4))
    return Fraction(round(B * DIGITS), DIGITS), near(l) - Fraction(1, DIGITS)


def linked_slices(claim):
    """The slices (i, cuts) of the parameters of all leaves that are linked, each once."""
    axes = slice(2, 2 + claim.parameters)
    return sorted({tuple(zip(index[axes], cuts[axes])) for part, letters in trees(claim)
                   for position, (index, cuts) in leaves(part.tree, kinds="PS" + letters)
                   if part.tree[position] in letters})


def hints(claim):
    """B and l, the place and the vector of `at once`, and B and l for slices of linked leaves."""
    waves, parameters = claim.examined, claim.parameters
    at = floats(waves, [1 if claim.at_once == "upper end" else 0] * parameters)
    y = lowest(at, lambda y: eigenvalues(at, y)[0])
    n = eigenvalues(at, y)[2]
    size = math.hypot(*n) or 1
    nearer = [(slices, bound_and_tail(waves, [
        [2 * (i + upper) / (1 << cuts) - 1 for upper in (0, 1)] for i, cuts in slices]))
        for slices in linked_slices(claim)]
    return (bound_and_tail(waves, [(-1, 1)] * parameters),
            [near(x / math.pi) for x in y], [near(x / size) for x in n], nearer)


# ---- the text

def tree_text(tree, later):
    """A tree in Coq, where a is the next part and b the one after it; later: the letters that
    these have in the file."""
    width = WIDTH - 6
    tree = tree.translate(str.maketrans(later, LETTERS[:len(later)]))
    return "read_tree\n  [\"%s\"]%%string" % '";\n   "'.join(
        tree[k:k + width] for k in range(0, len(tree), width))


def shifts_text(claim):
    """What each parameter adds to v0, and what to v1."""
    return "(%s)" % ", ".join(["[%s]" % "; ".join([number(shift[i]) for shift in claim.shifts])
                               for i in (0, 1)])


def part_text(part, later):
    """A part, its x*, ranges, shifts and tree."""
    return "Part %s %s %s %s (%s)" % (*map(pair, (part.xstar, *zip(part.centre, part.half))),
                                      shifts_text(part), tree_text(part.tree, later))


def patch_text(claim, indent):
    """The waves, one a line."""
    return "[" + (";\n" + " " * (indent + 1)).join(map(term, claim.waves)) + "]"


def region_text(claim):
    (c0, c1), (h0, h1) = claim.centre, claim.half
    return "(Region %s %s)" % (" ".join(map(number, claim.frame)),
                               " ".join(map(number, (c0, h0, c1, h1))))


READING = """\
From Coq Require Import Reals ZArith QArith List.
From Converse Require Import Map.
Import ListNotations.
Open Scope Q_scope.

"""
CHECKING = """\
From Coq Require Import ZArith QArith List String Bool.
From Converse Require Import Map Tree Share Reduce Check %s.
Import ListNotations.
Open Scope Q_scope.

"""


def statement(claim):
    """What is proved, spelled out in the words of Map.v: it is Check.statement of the claim."""
    patch = "let patch :=\n    %s in\n  " % patch_text(claim, 4)
    lines = ["forall t, in_cube t -> no_invariant_graph (waves patch t)"]
    if symmetries_used(claim) is None:
        lines = ["no_minimizing_orbit_into %s patch %s" % (region_text(claim), pair(claim.xstar))]
        if claim.parts:
            lines = ["forall t, in_cube t -> no_invariant_graph_into %s (waves patch t) (point %s)"
                     % (region_text(claim), pair(claim.xstar))]
    if claim.at_once == "yes":
        lines += ["forall t s, in_cube t -> (1 <= s)%R -> no_invariant_graph (scaled s (waves "
                  "patch t))"]
    elif claim.at_once == "upper end":
        lines += ["forall s, (1 <= s)%R -> no_invariant_graph (scaled s (waves patch [1%R]))"]
    return patch + " /\\\n  ".join(["(%s)" % line for line in lines] if lines[1:] else lines)


def says(claim, name):
    return READING + "Definition %s_says : Prop :=\n  %s.\n" % (name, statement(claim))


COMPUTED = "Proof. vm_cast_no_check (eq_refl true). Qed.\n"


def definitions(claim, odd, arithmetic):
    """The claim, the hints and the trees; and what is checked once."""
    (B, l), place, vector, nearer = hints(claim)
    alone = {None: "Both", 0: "First", 1: "Second"}[claim.alone]
    (_, later), *parts = trees(claim)
    once = {"no": "No", "yes": "Whole_patch", "upper end": "Upper_end"}[claim.at_once]
    return CHECKING % arithmetic + """\
Definition the_claim : claim :=
  %s

Definition the_hints : hints :=
  %s

Definition the_tree : tree := %s.

Definition the_parts : list part :=
  [%s].

Lemma header : header_ok the_claim the_hints the_tree the_parts = true.
%s""" % ("Claim %s\n  %s %s %s %s %s %s %s." % (
            patch_text(claim, 8), region_text(claim), shifts_text(claim), pair(claim.xstar),
            "false" if symmetries_used(claim) is None else "true", alone, once,
            "None" if odd is None else "(Some %s)" % pair(odd)),
         "Hints %s %s (%s, %s)\n  [%s]." % (
             number(B), number(l), pair(place), pair(vector), ";\n   ".join(
                 "([%s], %s)" % ("; ".join(["(%d%%Z, %d%%nat)" % s for s in slices]), pair(Bl))
                 for slices, Bl in nearer)),
         tree_text(claim.tree, later), ";\n   ".join(itertools.starmap(part_text, parts)), COMPUTED)


def part(name, arithmetic, i, count):
    return CHECKING % arithmetic + """\
From Converse.build Require Import {0}_claim.

Lemma leaves : forallb (fun ct =>
    forallb (leaf_ok (fst ct) the_hints) (share {1} {2} (leaves_of (fst ct) (snd ct))))
  (all_parts the_claim the_tree the_parts) = true.
{3}""".format(name, i, count, COMPUTED)


def theorem(name, arithmetic, count):
    parts = ["%s_%d" % (name, i) for i in range(count)]
    return READING + """\
From Converse.build Require Import {0}_says.
(* Not imported: no name of theirs hides one of those above. *)
From Converse Require Share {1}.
From Converse.build Require {0}_claim {2}.

Theorem {0} : {0}_says.
Proof.
  refine ({1}.check_sound
            {0}_claim.the_claim {0}_claim.the_hints {0}_claim.the_tree {0}_claim.the_parts _).
  apply andb_true_intro. split; [exact {0}_claim.header |].
  apply (Share.shares_all_of _ _ _ _ {3}); [| repeat constructor].
  exact ({4}).
Qed.

Add Printing Constructor term region.
Set Printing Width 100.
Check {0}.
Print {0}_says.
""".format(name, arithmetic, " ".join(parts), count,
           "".join("Forall_cons _ %s.leaves (" % part for part in parts) + "Forall_nil _"
           + ")" * count)


# ---- certificates of existence

def check_kind(claim):
    """Raises Unusable, unless Exists.v has a theorem about such certificates."""
    (r0, r1), *others = [element[:2] for element in claim.rotation]
    if others:
        raise check.Unusable("is about two angles; Coq's theorem of existence is about one")
    if any(map(any, [wave.parts for wave in claim.waves])):
        raise check.Unusable("has a parameter; Coq's theorem of existence is about one map")
    if claim.polynomial not in ((-1, 1, 1), (1, -1, -1)) or abs(r1) != 1 or r0.denominator != 1:
        raise check.Unusable("has another rotation than `--rotation golden`; Coq's theorem of "
                             "existence has only that")
    if [wave.k for wave in claim.waves] != [(1, 0)] or abs(claim.waves[0].middle) > 1 \
            or 2 * claim.waves[0].phase % 1:
        raise check.Unusable("has another potential than p sin(y) or p cos(y), abs(p) <= 1; Coq's "
                             "theorem of existence has only these")


def sines(torus):
    """The coefficients of sin(k t), k = 1, 2, ..., of the torus, in its units, where V = p cos t.
    The function is odd by construction; Coq finds whether it is accurate."""
    upside_down = torus.waves[0][1] % 2 == Fraction(1, 2)
    found = [0] * torus.farthest
    for (k,), (((_, im),),) in torus.modes.items():
        found[k - 1] = 2 * im if k % 2 and upside_down else -2 * im
    return found


def certificate(claim):
    """r, the integers, their unit, and the digits and the terms of the computation, in Coq."""
    setting = tori.Setting(replace(claim, frame=((1,),), alpha=(Fraction(1),)))        # of |k|
    (piece,), p = claim.pieces, claim.waves[0].middle
    torus, unit = tori.Torus(setting, piece, True), 1 << piece.bits
    numbers, best = sines(torus), None
    for r in RADII:
        size, slope = (sum([k ** power * abs(x) * r ** k for k, x in enumerate(numbers, 1)]) / unit
                       for power in (0, 1))
        if size > MOST[0] or slope > MOST[1]:
            continue
        allowed = 1 / (512000000 * (6 * r / (r - 1)) ** 4)
        box = Box(setting.norm, 2 * torus.farthest, 0)
        bits = 24 + math.ceil(math.log2(1 / allowed) + box.limit * math.log2(r))
        residual = tori.Residual(torus, Ring(box, r, bits), torus.farthest)
        factor = (residual.polynomial + residual.radius + allowed / ROUNDINGS) / allowed
        if best is None or factor < best[0]:
            terms = next(j for j in itertools.count() if 8 * ROUNDINGS * abs(p) * size ** (j + 1)
                         <= allowed * math.factorial(j + 1))
            best = factor, r, bits, terms
    if best is None:
        raise check.NotConfirmed(
            "the norms of its torus and of the derivative are %.4f and %.4f; Coq's theorem of "
            "existence allows %s and %.4f, with any --margin" % (size, slope, *map(float, MOST)))
    factor, r, bits, terms = best
    if factor > 1:
        raise check.NotConfirmed(
            "the residual of its torus is %.2g times as large as Coq's theorem of existence "
            "allows: let converse-tori prove it with a --margin 1e%d times as large"
            % (float(factor), math.ceil(math.log10(factor)) + 1))
    return "%d %d\n    [%s]%%Z\n    (2 ^ %d) %d %d" % (
        r.numerator, r.denominator, textwrap.fill("; ".join(map(str, numbers)), WIDTH - 5,
                                                  subsequent_indent=" " * 5),
        piece.bits, bits, terms)


def existence(claim, name):
    """The texts of NAME_exists_says.v and of NAME_exists.v."""
    check_kind(claim)
    wave, proved, name = claim.waves[0], certificate(claim), name + "_exists"
    return {"_exists_says": READING + "Definition %s_says : Prop :=\n  has_invariant_graph (waves "
            "[%s] []).\n" % (name, term(wave)),
            "_exists": READING + """\
From Converse.build Require Import {0}_says.
(* Not imported: no name of theirs hides one of those above. *)
From Converse Require Exists.

Theorem {0} : {0}_says.
Proof.
  refine (Exists.certified {1} {2} {3} _).
  vm_cast_no_check (eq_refl true).
Qed.

Add Printing Constructor term.
Set Printing Width 100.
Check {0}.
Print {0}_says.
""".format(name, proved, number(wave.phase), number(wave.middle))}


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("file", help="a finished proof file, or a certificate of existence")
    parser.add_argument("name", help="of the theorem")
    parser.add_argument("directory", type=Path, help="where the files go")
    parser.add_argument("--numbers", choices=["Doubles", "BigIntegers", "Integers"],
                        help="the processor's floating-point numbers, or numbers made of the "
                             "integers of the library Bignums or of Coq (default: Doubles); not "
                             "for a certificate of existence, as --parts")
    parser.add_argument("--parts", type=int, metavar="K",
                        help="divide the leaves among K files (default: 1)")
    options = parser.parse_args()
    name, numbers = options.name, options.numbers or "Doubles"
    count = 1 if options.parts is None else options.parts
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name):
        sys.exit("theorem.py: the name is not letters, digits and _, a letter first")
    if count < 1:
        sys.exit("theorem.py: --parts: less than one")
    try:
        claim = check.read(options.file)
        if isinstance(claim, check.Diagram):
            raise check.Unusable("is a diagram; a theorem is made from a proof file or a "
                                 "certificate of existence")
        if isinstance(claim, check.TorusClaim):
            if options.numbers or options.parts:
                raise check.Unusable("is a certificate of existence, whose theorem is one file "
                                     "with exact integers; leave out --numbers and --parts")
            texts = existence(claim, name)
        else:
            check.check_tree(claim)
            check_mirror_images(claim)      # Coq would say no more than that false is not true
            texts = {"_says": says(claim, name),
                     "_claim": definitions(claim, odd_about(options.file), numbers),
                     **{"_%d" % i: part(name, numbers, i, count) for i in range(count)},
                     "": theorem(name, numbers, count)}
    except check.Failure as error:
        sys.exit("theorem.py: %s: %s%s" % (check.shown(options.file), error.word, error))
    head = ("(* Made by formal/theorem.py from the file whose SHA-256 is\n   %s. *)\n\n"
            % claim.sha256)
    for end, text in texts.items():
        (options.directory / (name + end + ".v")).write_text(head + text, "ascii")


if __name__ == "__main__":
    main()
