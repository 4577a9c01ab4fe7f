"""What a referee reads: the functions of the checker that run for a file of each kind."""

import ast
import sys
from collections import defaultdict
from fractions import Fraction as F
from pathlib import Path

from converse import FroeschleMap, Problem, StandardMap, check, prove
from converse.diagram import Diagram
from converse.prover.portrait import portray

FOLDER = Path(check.__file__).parent
BESIDE = {"run", "workers", "processes", "progress", "signals", "command", "words", "choice"}


def functions_of(path):
    """(first line, last line) of each function, by the line where its code begins."""
    return {min([node.lineno, *(each.lineno for each in node.decorator_list)]): node.end_lineno
            for node in ast.walk(ast.parse(path.read_text("utf-8")))
            if isinstance(node, ast.FunctionDef)}


def what_runs(path):
    """The lines of all functions that run when the file is verified, by module."""
    begun = defaultdict(set)

    def note(frame, event, _):
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(str(FOLDER)):
            begun[Path(code.co_filename)].add(code.co_firstlineno)

    sys.setprofile(note)
    try:
        check.verify(path, exact=True)
    finally:
        sys.setprofile(None)
    return {module.stem: {line for first, last in functions_of(module).items() if first in lines
                          for line in range(first, last + 1)}
            for module, lines in begun.items() if module.stem not in BESIDE}


def lists(folder, root):
    """{kind of file: (modules, number of lines)}."""
    prove(StandardMap("1.1")).save(folder / "no circle at one k")
    prove(FroeschleMap(("1.9", "2"), ("0", "0.1"))).save(folder / "no torus of a range")
    portray(Problem(StandardMap("0.9")), path=folder / "a portrait", columns=8, depth=6)
    found = Diagram.of(StandardMap((0, 2)))
    found.add(prove(found.over(((F("1.3"), F("1.4")),))))
    found.save(folder / "a diagram of proofs")
    files = {path.name: path for path in folder.iterdir()}
    files["a golden circle"] = root / "golden_outputs/tori/standard-0.9.torus"
    runs = {name: what_runs(path) for name, path in files.items()}
    return {name: (set(found), sum(map(len, found.values()))) for name, found in runs.items()}
