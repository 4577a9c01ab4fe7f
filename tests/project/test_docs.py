"""The README and docs/: what they show runs, what they link to exists, what they list is all."""

import re
import shlex
import subprocess
import sys

import pytest
from conftest import ROOT

from converse import check
from converse.commands import map as map_cli
from converse.commands import orbits as orbits_cli
from converse.commands import portrait as portrait_cli
from converse.commands import prove as cli
from converse.commands import tori as tori_cli
from converse.version import __version__

from moments import PATIENCE

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FOLDERS = {page.name: page.parent for page in PAGES}
TEXTS = {page.name: page.read_text("utf-8") for page in PAGES}
PARSERS = {"converse": cli.parser, "converse-check": check.parser, "converse-map": map_cli.parser,
           "converse-orbits": orbits_cli.parser, "converse-portrait": portrait_cli.parser,
           "converse-tori": tori_cli.parser}


@pytest.mark.parametrize("name", [name for name, text in TEXTS.items() if "```python" in text])
@pytest.mark.slow
def test_python_examples_run(name, tmp_path):
    """In the order of the page, one after the other, where the inputs are."""
    blocks = re.findall(r"^```python\n(.*?)^```$", TEXTS[name], re.MULTILINE | re.DOTALL)
    (tmp_path / "inputs").symlink_to(ROOT / "inputs")
    (tmp_path / "example.py").write_text(
        "def main():\n" + re.sub("^(?=.)", "    ", "\n".join(blocks), flags=re.MULTILINE)
        + "\nif __name__ == '__main__':\n    main()\n")     # for the example's processes
    result = subprocess.run([sys.executable, "example.py"], cwd=tmp_path, capture_output=True,
                            text=True, timeout=PATIENCE)
    assert (result.returncode, result.stderr) == (0, "")
    said = {"orbits.md": "THEOREM, proved", "tori.md": "Proved",
            "portrait.md": "no rotational invariant circle", "map.md": "has no invariant torus"}
    assert said.get(name, "no invariant tori") in result.stdout


def test_commands_are_understood():
    """Each command line that a page shows, if it is one of ours."""
    shown = 0
    for text in TEXTS.values():
        lines = re.findall(r"^    (?:\S*/)?(converse\S*) *(.*)$", text, re.MULTILINE)
        spans = re.findall(r"`(converse\S*) ([^`[]*)`", text)
        for command, arguments in lines + spans:
            first_line = re.match("(proof|diagram|portrait|torus) [0-9]$", arguments)
            if command in PARSERS and "..." not in arguments and not first_line:
                arguments = re.sub(r"\b[KN]\b", "3", arguments.partition("#")[0])
                try:
                    PARSERS[command]().parse_args(shlex.split(arguments))
                except SystemExit as end:       # of what only prints
                    assert end.code == 0
                shown += 1
    assert shown >= 4


def test_extras_are_added_by_make():
    """Not by pip, which would compile the core again, or put a copy of these files in .venv."""
    section = (ROOT / "pyproject.toml").read_text("utf-8").partition("optional-dependencies]\n")[2]
    extras = {*re.findall(r"^(\w+) = ", section.partition("\n[")[0], re.MULTILINE)}
    shown = {name for text in TEXTS.values() for name in re.findall(r"\.venv/with-(\w+)", text)}
    assert "tori" in shown and shown <= extras
    assert not any(".venv/bin/pip" in text for text in TEXTS.values())


def test_experiments_are_of_use():
    """A page or another script names each, by which it is found or made."""
    scripts = {path: path.read_text("utf-8") for path in (ROOT / "experiments").glob("*.py")}
    pages = "\n".join([*TEXTS.values(), (ROOT / "docs" / "figures.csv").read_text("ascii")])
    for path in scripts:
        assert re.search(r"\b%s\b" % re.escape(path.name), pages) or any(
            re.search(r"(?m)^(import|from) %s\b" % path.stem, text)
            for text in scripts.values()), path


def test_experiments_draw_as_the_package_does():
    """In its letters, of eight points or more, and its colours; with the Greek letter."""
    for path in (ROOT / "experiments").glob("*.py"):
        text = path.read_text("utf-8")
        if "figsize" in text and path.name != "chart.py":       # which has notes in small letters
            assert "fontsize" not in text and "frameon" not in text
            assert not re.search("#[0-9a-f]{6}|varepsilon", text), path


@pytest.mark.parametrize("name", TEXTS)
def test_links_lead_somewhere(name):
    home = FOLDERS[name]
    for target in re.findall(r"\]\(([^)]+)\)", re.sub("(?m)^    .*", "", TEXTS[name])):
        path, _, section = target.partition("#")
        page = home / (path or name)
        assert "//" not in path and page.is_file(), target
        if section:
            titles = re.findall("^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
            assert section in [re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")
                               for title in titles], target


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "architecture.md"])
def test_files_that_are_named_exist(name):
    folders = "|".join(path.name.replace(".", r"\.") for path in ROOT.iterdir()
                       if path.is_dir() and not path.name.startswith((".v", "build")))
    paths = re.findall("`((?:%s)/[^`]*)`" % folders, TEXTS[name])
    assert len(paths) > 9
    assert [path for path in paths if "NAME" not in path and not (ROOT / path).exists()] == []


@pytest.mark.parametrize("column, command", [(1, "converse"), (2, "converse-check")])
def test_every_exit_status_is_listed(column, command):
    rows = re.findall(r"^\| ([0-9]+) \| *(.*?) *\| *(.*?) *\|$", TEXTS["commands.md"], re.MULTILINE)
    listed = {number for row in rows if row[column]
              for number in re.findall("[0-9]+", row[0] + row[column])}
    told = PARSERS[command]().epilog
    assert listed == set(re.findall(r"\b[0-9]+\b", re.split("(?i)exit status", told)[1]))


def test_one_version():
    assert re.search("^version: (.*)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)[1] \
        == __version__
    changes = re.findall("^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert [each for each in changes if "unreleased" not in each][0] == __version__
    assert check.__version__ == __version__             # it imports nothing, not even that
