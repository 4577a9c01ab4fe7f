"""Compiles minplus.c, with the potentials of the core and with its flags, into build/.

The cffi module includes the core's module, so that both have the same types.
"""

import hashlib
import os
import runpy
import subprocess
import sys
import sysconfig
import tempfile
from functools import lru_cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from cffi import FFI

from converse import ConverseError

HOME = Path(__file__).resolve().parent
ROOT = HOME.parent.parent
NAME = "_minplus"
# A module that was compiled with other flags, those of sanitizers, is another file.
FLAGS = hashlib.sha256(os.environ.get("CFLAGS", "").encode()).hexdigest()[:8]
TARGET = ROOT / "build" / "least_action" / FLAGS / (NAME + sysconfig.get_config_var("EXT_SUFFIX"))
SOURCES = [HOME / "minplus.c",
           *(ROOT / "csrc" / name for name in ("orbits/potential.c", "arith/machine.c"))]

SOURCE = """
#include "converse.h"
#include "orbits.h"
#include "minplus.h"
"""


@lru_cache
def library():
    """The functions of minplus.h, compiled first if a source is newer.  ConverseError: they cannot
    be compiled."""
    sources = [*ROOT.glob("csrc/**/*.*"), *HOME.glob("*.[ch]"), HOME / "build.py"]
    if not TARGET.exists() or max(path.stat().st_mtime for path in sources) > \
            TARGET.stat().st_mtime:
        done = subprocess.run([sys.executable, __file__], cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            raise ConverseError("experiments/least_action cannot be compiled (%s); run python "
                                "experiments/least_action/build.py"
                                % (done.stderr.strip() or "?").splitlines()[-1])
    spec = spec_from_file_location(NAME, TARGET)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.lib


def main():
    os.chdir(ROOT)
    core, ffi = runpy.run_path(os.path.join("converse", "_build.py")), FFI()
    ffi.include(core["ffi"])
    ffi.cdef((HOME / "minplus.h").read_text("utf-8"))
    ffi.set_source(NAME, SOURCE, sources=list(map(str, SOURCES)),
                   include_dirs=[str(ROOT / "csrc"), str(HOME)], extra_compile_args=core["FLAGS"])
    TARGET.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=TARGET.parent) as directory:
        os.replace(ffi.compile(tmpdir=directory), TARGET)


if __name__ == "__main__":
    main()
