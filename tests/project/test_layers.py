"""The rooms of the package: who may import whom.  docs/development/architecture.md draws it."""

import ast
import functools
from graphlib import TopologicalSorter

import pytest
from conftest import ROOT

from converse.storage.methods import HOMES, provided

# From the ground up; a room imports only what is on lower floors.  (_native is compiled; the
# package itself, "", loads what it is asked for.)
FLOORS = [["version", "_native", "storage"], ["model"], ["prover", "tori"], ["diagram"],
          ["draw"], ["orbits"], ["commands", "results"], ["", "__main__"]]
BESIDE = ["check", "_build"]            # import nothing of the others
CHECKED = ["", "commands", "diagram", "storage", "tori"]        # may import the checker

PACKAGE = ROOT / "converse"


@functools.cache
def modules():
    """The names of all modules, without "converse.", their files, and what there is to see in them:
    imports and calls."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path, [
            node for node in ast.walk(ast.parse(path.read_text("utf-8")))
            if isinstance(node, (ast.Import, ast.ImportFrom, ast.Call, ast.Name, ast.Attribute))]
    return found


def imports(name, path, nodes, known):
    """The modules of the package that a module imports, anywhere in its file."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in nodes:
        if isinstance(node, ast.Import):
            targets = [alias.name.split(".", 1) for alias in node.names]
            targets = [rest[0] if rest else "" for first, *rest in targets if first == "converse"]
        elif isinstance(node, ast.ImportFrom):
            at = ["converse", *filter(None, package.split("."))] if node.level else []
            at = [*at[:len(at) - node.level + 1], *(node.module or "").split(".")]
            at = list(filter(None, at))
            if at[:1] != ["converse"]:
                continue
            home = ".".join(at[1:])
            inner = [".".join(filter(None, (home, alias.name))) for alias in node.names]
            targets = [each if each in known else home for each in inner]
        else:
            continue
        for target in targets:
            assert target in known, (name, target)
            if target != name:
                yield target


def room(name):
    return name.partition(".")[0]


@pytest.fixture(scope="module")
def arrows():
    files = modules()
    known = {"_native", *files}
    return {(name, target) for name, (path, nodes) in files.items()
            for target in imports(name, path, nodes, known)}


@pytest.mark.slow
def test_every_room_has_its_floor():
    assert {"_native", *map(room, modules())} == {*BESIDE, *sum(FLOORS, [])}
    assert len(FLOORS) <= 8


@pytest.mark.slow
def test_no_arrow_leads_upwards(arrows):
    floor = {name: i for i, names in enumerate(FLOORS) for name in names}

    def right(*arrow):
        name, target = map(room, arrow)
        if name == target or name in CHECKED and target == "check":
            return True
        return not {name, target} & {*BESIDE} and floor[name] > floor[target]

    assert [arrow for arrow in arrows if not right(*arrow)] == []


@pytest.mark.slow
def test_no_circle(arrows):
    below = {}
    for name, target in arrows:
        below.setdefault(name, set()).add(target)
    assert len(list(TopologicalSorter(below).static_order())) > 40          # or CycleError


@pytest.mark.slow
def test_results_are_bound_in_one_place():
    """The methods that rooms above provide are those that results ask for, and their functions are
    there; nothing else is imported by a name in a string."""
    for method, home in HOMES.items():
        assert callable(provided(method)), home
    asked, finders = set(), set()
    for name, (_, nodes) in modules().items():
        for node in nodes:
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "provided":
                asked.add(ast.literal_eval(node.args[0]))
            if "import_module" in (getattr(node, "attr", ""), getattr(node, "id", "")):
                finders.add(name)
    assert asked == HOMES.keys()
    assert finders == {"", "commands", "storage.methods"}


def test_the_page_shows_every_room():
    page = (ROOT / "docs/development/architecture.md").read_text("utf-8")
    folders = [path for top in ("converse", "csrc") for path in (ROOT / top).iterdir()
               if any(path.glob("*.py")) or any(path.glob("*.c"))]      # not inputs
    assert len(folders) > 10
    assert [path for path in folders if "`%s/`" % path.relative_to(ROOT) not in page] == []
