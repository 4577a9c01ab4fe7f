"""The installation: whose core is under test, and what works without one."""

import json
import shutil
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

import pytest

from converse import _native, prove, read_input


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


def test_the_checker_needs_nothing_but_its_file(root, tmp_path):
    """The file alone, with no other package within reach."""
    shutil.copy(root / "converse" / "check.py", tmp_path)
    result = subprocess.run([sys.executable, "-I", "-S", tmp_path / "check.py", "--help"],
                            capture_output=True, text=True, cwd=tmp_path)
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
    prove(read_input(root / "inputs" / "trig278.in")).save(path)
    status, out, err = without_core("converse.check", path)
    assert (status, err) == (0, "") and "no invariant" in out


def test_without_the_core_nothing_is_proved(root):
    status, out, err = without_core("converse.cli", root / "inputs" / "trig278.in")
    assert status == 2 and out == ""
    assert err.startswith("converse: ") and err.count("\n") == 1 and "core" in err
