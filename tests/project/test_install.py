"""The installation: whose core is under test, and what works without one."""

import ast
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

import pytest
from conftest import ROOT

from converse import _native, prove, read_input
from converse.prover.native import _without_core


def test_the_core_is_this_environments_own(root):
    """An editable installation leaves its core in the clone, where others must not pick it up."""
    installed = list(metadata.distributions(name="converse-kam",
                                            path=[sysconfig.get_path("purelib")]))
    if not installed:
        pytest.skip("this environment has no installation of converse")
    origin = installed[0].read_text("direct_url.json")
    home = Path(_native.__file__).resolve().parent
    if origin and json.loads(origin).get("dir_info", {}).get("editable"):
        assert home == root / "converse"
    else:
        assert home.is_relative_to(Path(sys.prefix).resolve())


def without_safe_path():
    """The environment of a Python that sees its own folder first, as usual."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}


def test_python_started_beside_the_clone(tmp_path):
    """There `converse` is also a folder without __init__.py, which must not hide the package."""
    (tmp_path / "converse" / "converse").mkdir(parents=True)
    done = subprocess.run([sys.executable, "-c", "import converse; print(converse.prove.__name__)"],
                          cwd=tmp_path, capture_output=True, text=True, env=without_safe_path())
    assert (done.returncode, done.stdout, done.stderr) == (0, "prove\n", "")


@pytest.mark.skipif(not (ROOT / ".git").exists() or not shutil.which("git"), reason="not a clone")
def test_the_source_distribution_is_complete():
    """MANIFEST.in names every file and folder of the clone that setuptools does not add itself."""
    tracked = subprocess.run(["git", "-c", "safe.directory=*", "ls-files"], cwd=ROOT, check=True,
                             capture_output=True, text=True).stdout.split()
    assert {path.partition("/")[0] for path in tracked} \
        - {*(ROOT / "MANIFEST.in").read_text("utf-8").split()} \
        == {".gitignore", "LICENSE", "MANIFEST.in", "README.md", "converse", "pyproject.toml",
            "setup.py"}


def test_make_checker_needs_nothing_but_python(root, tmp_path):
    """From the sources of the checker alone; what it makes runs with no package within reach."""
    (tmp_path / "converse").mkdir()
    shutil.copy(root / "Makefile", tmp_path)
    shutil.copytree(root / "converse" / "check", tmp_path / "converse" / "check",
                    ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run(["make", "checker", "PYTHON=%s -I -S" % sys.executable], cwd=tmp_path,
                   check=True,
                   stdout=subprocess.DEVNULL)
    result = subprocess.run([sys.executable, "-I", "-S", "converse-check.pyz", "--help"],
                            capture_output=True, text=True, cwd=tmp_path / "build")
    assert (result.returncode, result.stderr) == (0, "") and "converse-check" in result.stdout


WITHOUT_CORE = """
import runpy, sys
sys.modules["converse._native"] = None      # whatever asks for it is told that there is none
runpy.run_module(sys.argv.pop(1), run_name="__main__", alter_sys=True)
"""


def without_core(*arguments):
    """Runs a module as if there were no core: (exit status, stdout, stderr)."""
    result = subprocess.run([sys.executable, "-c", WITHOUT_CORE, *map(str, arguments)],
                            stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return result.returncode, result.stdout, result.stderr


def test_without_the_core_proofs_can_be_checked(root, tmp_path):
    """What CONVERSE_WITHOUT_CORE=1 installs."""
    path = tmp_path / "trig278.proof"
    prove(read_input(root / "inputs" / "trig278.in"), method="thesis").save(path)
    status, out, err = without_core("converse.check", path)
    assert (status, err) == (0, "") and "no invariant" in out


def test_without_the_core_nothing_is_proved(root):
    status, out, err = without_core("converse.commands.prove", root / "inputs" / "trig278.in")
    assert status == 2 and out == ""
    assert err.startswith("converse: ") and err.count("\n") == 1 and "core" in err


@pytest.mark.parametrize("error, remedy", [
    (ImportError("libgmp.so.10: cannot open shared object file"), "(Debian: libgmp10)"),
    (ModuleNotFoundError("No module named '_cffi_backend'", name="_cffi_backend"),
     "pip install cffi")])
def test_what_the_core_lacks_is_told(error, remedy):
    """No compiler is needed where one library is missing."""
    words = _without_core(error)
    assert words.endswith(remedy) and str(error) in words


def test_the_core_says_nothing_of_where_it_was_built(root):
    """No tables for a debugger, which are large, and name directories; so builds are the same."""
    core = Path(_native.__file__).read_bytes()
    for words in (b".debug_info", str(root).encode(), b"csrc/"):
        assert words not in core


@pytest.mark.parametrize("sources, asked", [(True, "converse.prove"), (False, "orbits.trig")])
def test_python_started_among_sources_without_core(root, tmp_path, sources, asked):
    """An unpacked source distribution; or a package that lost its core."""
    shutil.copytree(root / "converse", tmp_path / "converse",
                    ignore=shutil.ignore_patterns("_native.*", "__pycache__"))
    if sources:
        (tmp_path / "setup.py").touch()
    code = ("import converse\nfrom converse import orbits\n"
            "try: %s\nexcept converse.ConverseError as error: print(error)" % asked)
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True,
                          text=True, env=without_safe_path())
    assert (done.returncode, done.stderr, done.stdout.count("\n")) == (0, "", 1)
    assert ("start Python elsewhere" in done.stdout and str(tmp_path) in done.stdout) == sources
    assert ("pip install" in done.stdout) != sources


def test_the_inputs_come_with_the_package(root, command, tmp_path):
    """Each where it says, whether the package is installed or a clone; and it can be run."""
    status, out, err = command("--list-inputs", cwd=tmp_path)
    paths = {Path(line).name: Path(line) for line in out.splitlines()}
    assert (status, err) == (0, "")
    assert paths.keys() == {path.name for path in (root / "inputs").iterdir()}
    for name, path in paths.items():
        assert path.read_bytes() == (root / "inputs" / name).read_bytes()
    status, out, _ = command(paths["trig278.in"], cwd=tmp_path)
    assert status == 0 and "no invariant tori" in out


def test_the_readme_of_an_index(root):
    """There no picture is seen, and no link to a file leads anywhere."""
    parsed = ast.parse((root / "setup.py").read_text("utf-8"))
    parsed.body = [part for part in parsed.body if getattr(part, "name", "") == "on_an_index"]
    names = {"re": re}
    exec(compile(parsed, "setup.py", "exec"), names)
    readme = (root / "README.md").read_text("utf-8")
    text = names["on_an_index"](readme)
    assert "](" in readme and "](" not in text and "*Figure docs/chart-bound.svg: " in text
    assert {*re.findall(r"\]\(([^)#]+)", readme)} <= {
        *re.findall(r"(?<= \()[^) ]+(?=\))|(?<=Figure )[^:]+", text)}


def test_manual_pages_and_completions(root, tmp_path):
    """Of each command, where a shell and man look for them in share/."""
    pytest.importorskip("shtab")
    pytest.importorskip("argparse_manpage")
    done = subprocess.run([sys.executable, root / "docs" / "manual.py", tmp_path], cwd=tmp_path,
                          capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    for entry in ("", "-check", "-map", "-orbits"):
        name = "converse" + entry
        assert ".SH NAME" in (tmp_path / "man" / "man1" / (name + ".1")).read_text("utf-8")
        for file in ("bash-completion/completions/" + name, "zsh/site-functions/_" + name,
                     "fish/vendor_completions.d/%s.fish" % name):
            assert name in (tmp_path / file).read_text("utf-8")


@pytest.mark.parametrize("flags", ["-Ofast", "-g -ffast-math", "-funsafe-math-optimizations"])
def test_flags_that_flush_small_numbers_are_refused(flags, root, monkeypatch):
    """The linker would add code that does so in all of the process, before the core's guard."""
    setuptools = pytest.importorskip("setuptools")
    from setuptools.command.build_ext import customize_compiler, new_compiler

    monkeypatch.chdir(root)
    monkeypatch.setattr(setuptools, "setup", lambda **options: None)
    build = runpy.run_path("setup.py")["BuildExt"](setuptools.Distribution())
    for variable in "CFLAGS", "LDFLAGS":
        monkeypatch.setenv(variable, flags)
        build.compiler = new_compiler()
        customize_compiler(build.compiler)
        with pytest.raises(SystemExit, match="cannot be built with -[Off]"):
            build.build_extensions()
        monkeypatch.delenv(variable)
