"""The rooms of the package: who may import whom.  docs/development/architecture.md draws it."""

import ast
from graphlib import TopologicalSorter

import pytest
from conftest import ROOT

# From the ground up; a room imports only what is on lower floors.  (_native is compiled; the
# package itself, "", loads what it is asked for.)
FLOORS = [["version", "_native", "storage"], ["model"], ["prover", "tori"], ["diagram"],
          ["draw"], ["orbits"], ["commands"], ["", "__main__"]]
BESIDE = ["check", "_build"]            # import nothing of the others
CHECKED = ["", "commands", "diagram", "storage", "tori"]        # may import the checker

# Methods of a value that need more than the value does: each imports it when it is called.
UPWARDS = {("model.map", "model.inputs"): "SymplecticMap.read",
           ("model.dynamics", "orbits.portrait"): "SymplecticMap.portrait",
           ("prover.proof", "draw.plot"): "Proof.plot",
           ("prover.portrait", "draw.portrait_figure"): "Portrait.plot",
           ("diagram.value", "draw.diagram_figure"): "Diagram.plot",
           ("orbits.state", "orbits.pictures"): "PeriodicOrbit.plot",
           ("orbits.state", "orbits.report"): "PeriodicOrbit.report",
           ("orbits.solver", "orbits.report"): "Family.report",
           ("orbits.proved", "orbits.pictures"): "ProvedOrbit.plot",
           ("orbits.solver", "orbits.pictures"): "Family.plot",
           ("orbits.state", "orbits.minimax"): "PeriodicOrbit.minimax",
           ("orbits.minimax", "orbits.proved_pair"): "Pair.prove",
           ("orbits.state", "orbits.points"): "PeriodicOrbit.load, PeriodicOrbit.save",
           ("orbits.solver", "orbits.points"): "Family.load, Family.save",
           ("tori.torus", "draw.torus_figure"): "Torus.plot",
           ("tori.torus", "tori.certificate"): "Torus.load, Torus.save",
           ("tori.proved", "tori.report"): "ProvedTorus.report",
           ("tori.proved", "draw.torus_figure"): "ProvedTorus.plot",
           ("prover.proof", "prover.proof_file"): "Proof.load, Proof.save"}

PACKAGE = ROOT / "converse"


def modules():
    """The names of all modules, without "converse.", and their files."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(name, path, known):
    """What a module imports of the package: (the module, whether at the top of the file)."""
    tree = ast.parse(path.read_text("utf-8"))
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(tree):
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
                yield target, node in tree.body


def room(name):
    return name.partition(".")[0]


@pytest.fixture(scope="module")
def arrows():
    files = modules()
    known = {"_native", *files}
    return {(name, target, top) for name, path in files.items()
            for target, top in imports(name, path, known)}


def test_every_room_has_its_floor():
    assert {"_native", *map(room, modules())} == {*BESIDE, *sum(FLOORS, [])}
    assert len(FLOORS) <= 8


@pytest.mark.slow
def test_no_arrow_leads_upwards(arrows):
    floor = {name: i for i, names in enumerate(FLOORS) for name in names}

    def right(name, target):
        if name == target or name in CHECKED and target == "check":
            return True
        return not {name, target} & {*BESIDE} and floor[name] > floor[target]

    assert [arrow for arrow in arrows if arrow[:2] not in UPWARDS
            and not right(*map(room, arrow[:2]))] == []
    assert {arrow[:2]: arrow[2] for arrow in arrows if arrow[:2] in UPWARDS} \
        == dict.fromkeys(UPWARDS, False)                    # none of them at the top of a file


def test_no_circle(arrows):
    below = {}
    for name, target, _ in arrows:
        if (name, target) not in UPWARDS:
            below.setdefault(name, set()).add(target)
    assert len(list(TopologicalSorter(below).static_order())) > 40          # or CycleError


def test_the_page_shows_every_room():
    page = (ROOT / "docs/development/architecture.md").read_text("utf-8")
    folders = [path for top in ("converse", "csrc") for path in (ROOT / top).iterdir()
               if any(path.glob("*.py")) or any(path.glob("*.c"))]      # not inputs
    assert len(folders) > 10
    assert [path for path in folders if "`%s/`" % path.relative_to(ROOT) not in page] == []
