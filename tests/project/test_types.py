"""The type hints: those who use the package under the strictest rules, as the examples of the pages
do, see none missing.  (Whether the package contradicts them `make lint` asks.)"""

import inspect
import re

import pytest

import converse
from converse import diagram, orbits, tori

api = pytest.importorskip("mypy.api")


def checked(root, *arguments):
    """The complaints of mypy."""
    out, err, _ = api.run(["--config-file", str(root / "pyproject.toml"), "--cache-dir",
                           str(root / "build" / "mypy"), "--no-error-summary",
                           *map(str, arguments)])
    return out + err


def functions(module):
    """The functions and methods of a module's public names."""
    for name in module.__all__:
        thing = getattr(module, name)
        for own, value in (vars(thing) if inspect.isclass(thing) else {name: thing}).items():
            value = getattr(value, "fget", getattr(value, "__func__", value))
            if inspect.isfunction(value) and (own[0] != "_" or own == "__init__"):
                yield value


@pytest.mark.parametrize("module", [converse, diagram, orbits, tori],
                         ids=lambda module: module.__name__)
def test_public_names_are_annotated(module):
    """Every argument and every result."""
    found = [f for f in functions(module) if f.__module__.startswith("converse.")]
    assert len(found) > 5
    for function in found:
        signature = inspect.signature(function)
        kinds = [each.annotation for name, each in signature.parameters.items()
                 if name not in ("self", "cls")]
        if function.__name__ != "__init__":
            kinds.append(signature.return_annotation)
        assert signature.empty not in kinds, function.__qualname__


def test_examples(root, tmp_path, monkeypatch):
    """Those of the pages are right under the strictest rules; and a wrong one is seen: what is
    given to Problem may be a string, and becomes two Fractions.  (One run for all: a run takes
    long.)"""
    monkeypatch.chdir(root)
    examples = []
    for page in ("README.md", "docs/how-to/python.md", "docs/how-to/orbits.md",
                 "docs/how-to/tori.md"):
        blocks = re.findall(r"^```python\n(.*?)^```$", (root / page).read_text("utf-8"),
                            re.MULTILINE | re.DOTALL)
        assert blocks
        examples.append(tmp_path / ("page_%d.py" % len(examples)))
        examples[-1].write_text("\n".join(blocks), "utf-8")
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import converse\nproblem = converse.Problem(converse.StandardMap(1), v0=1)\n"
                     "reveal_type(problem.v0)\nproblem.v0.real\nconverse.StandardMap(0.5)\n",
                     "utf-8")
    found = checked(root, "--strict", "--follow-imports=silent", *examples, wrong)
    assert all("wrong.py:" in line for line in found.splitlines())
    assert re.search(r'3: note: .*[Tt]uple\[fractions.Fraction, fractions.Fraction\]', found)
    assert "4: error" in found and "5: error" in found
