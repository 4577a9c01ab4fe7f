"""The checker's names, whichever of its modules they live in.

What a test puts in place of one of them is put into every module that uses it."""

import importlib
import pkgutil
import subprocess
from pathlib import Path

from converse import check as package

# Of make verified-check.
PROVED = Path(__file__).resolve().parent.parent / "formal" / "build" / "converse-verified"

MODULES = [package] + [importlib.import_module(package.__name__ + "." + name)
                       for _, name, _ in pkgutil.iter_modules(package.__path__)
                       if name not in ("__main__", "ship")]


class _Names:
    __slots__ = ()

    def __getattr__(self, name):
        for module in MODULES[1:]:
            if name in vars(module):
                return vars(module)[name]
        raise AttributeError("no module of the checker has the name %r" % name)

    def __setattr__(self, name, value):
        getattr(self, name)
        for module in MODULES:
            if name in vars(module):
                setattr(module, name, value)


check = _Names()


def start_of_workers(code):
    """What the checker's processes run, where they run this code first."""
    return check.START.replace("; work()", "; exec(%r); work()" % code)


def says_the_same(path, status, why=""):
    """Does the checker that Coq has proved, where it is built, not contradict?  It reads no file
    of three angles, leaves more undecided, and does not look at comments and names."""
    return status not in (check.VERIFIED, check.PART, check.REJECTED) or not PROVED.exists() \
        or "control character" in why or "parameter" in why \
        or subprocess.run([PROVED, path], capture_output=True).returncode in (
            status, check.UNUSABLE, check.NOT_CONFIRMED)
