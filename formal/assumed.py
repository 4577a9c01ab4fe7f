"""Asks Coq what a theorem proves and assumes, and refuses all axioms that axioms.txt does not list:
python assumed.py NUMBERS [PROPOSITION] THEOREM, with full names, where Coq's folder Converse is."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Full names, and no import: so no file of the theorem can give these words another meaning.
QUESTION = """\
Require %s.
Set Printing Width 100.
Check %s.
Print Libraries.
Print Assumptions %s.
"""


def statements(text):
    """Each name with its type, without the breaks of lines."""
    return [" ".join(lines.split()) for lines in re.split(r"\n(?=\S)", text)]


def listed():
    """The list of each kind of numbers, in the order of the file."""
    text = Path(__file__).with_name("axioms.txt").read_text("ascii")
    return {kind: statements(axioms.strip())
            for kind, axioms in re.findall(r"(?m)^(\w+):\n((?:.+\n)+)", text)}


def others(numbers, said):
    """What Coq's answer has that it may not have with these numbers."""
    answer = re.search(r"Loaded library files: *\n((?:  \S+\n)+)\nAxioms:\n(.+)", said, re.S)
    if not answer:
        return ["no list of axioms"]
    lists = listed()
    kinds = list(lists)
    may = sum([lists[kind] for kind in kinds[:kinds.index(numbers) + 1]], [])
    # Coq prints only as much of a name as tells it from others.  So a file in Coq's folder Converse
    # could have the name of a library that is not loaded, and axioms of the names that are listed.
    names = set(re.findall(r"(\w+)(?=\.\w)", " ".join(sum(lists.values(), []))))
    namesakes = ["a library of the name " + library for library in answer[1].split()
                 if library.startswith("Converse.") and library.rpartition(".")[2] in names]
    return namesakes + [axiom for axiom in statements(answer[2].strip()) if axiom not in may]


def ask(*names):
    """What Coq says of a proposition and the theorem that proves it, or of a theorem alone."""
    libraries = " ".join([name.rpartition(".")[0] for name in names])
    theorem = names[-1]
    with tempfile.NamedTemporaryFile("w", suffix=".v") as file:
        file.write(QUESTION % (libraries, "(%s)" % " : ".join(reversed(names)), theorem))
        file.flush()
        done = subprocess.run(["coqtop", "-q", "-Q", ".", "Converse", "-batch", "-l", file.name],
                              text=True, stdout=subprocess.PIPE, check=False)
    if done.returncode:
        sys.exit("%s: Coq does not accept it as the theorem that it should be" % theorem)
    return done.stdout


def main():
    numbers, *names = sys.argv[1:]
    said = ask(*names)
    print(re.sub(r"(?s)Loaded library files:.*?\n\n", "", said), end="")
    if found := others(numbers, said):
        sys.exit("%s: this may not be assumed with %s: %s" % (names[-1], numbers, "; ".join(found)))


if __name__ == "__main__":
    main()
