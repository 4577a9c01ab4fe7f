"""Sees that theorems assume the axioms that they may, and no others:
python assumed.py NUMBERS OUTPUT, where OUTPUT has what Print Assumptions says."""

import re
import sys
from pathlib import Path

REALS = {"ClassicalDedekindReals.sig_forall_dec", "ClassicalDedekindReals.sig_not_dec",
         "FunctionalExtensionality.functional_extensionality_dep", "Classical_Prop.classic"}
# What the primitive types of Coq's kernel are and compute, by the library's files.
WORDS = {"PrimInt63", "Uint63"}
FLOATS = {"PrimFloat", "FloatAxioms"}
PRIMITIVE = {"Integers": set(), "BigIntegers": WORDS, "Doubles": WORDS | FLOATS}


def others(numbers, said):
    """What the theorem assumes, beside what it may with these numbers."""
    head, axioms, rest = said.partition("\nAxioms:\n")
    if not axioms:
        return ["no list of axioms"]
    # A name a line, perhaps with its type; what is indented goes on with it.  Then the time.
    lines = [line for line in rest.split("\n") if re.match(r"\S(?!.*\.v: [0-9.]+ s, )", line)]
    named = [re.fullmatch(r"((\w+)\.\w+)(?: : .*)?", line) for line in lines]
    return [line for line, name in zip(lines, named) if not name
            or name[1] not in REALS and name[2] not in PRIMITIVE[numbers]]


def main():
    numbers, path = sys.argv[1:]
    found = others(numbers, Path(path).read_text("utf-8"))
    if found:
        sys.exit("%s: this may not be assumed with %s: %s" % (path, numbers, "; ".join(found)))


if __name__ == "__main__":
    main()
