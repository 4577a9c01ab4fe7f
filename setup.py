"""Builds the C core, and the README of an index; everything else about the package is in
pyproject.toml."""

import os
import re
import sys
import sysconfig
import tempfile

from setuptools import setup
from setuptools.command.build_ext import build_ext

NEEDS = """
converse cannot be built: {what}.
Install a C compiler, the headers of Python and the headers of GMP, then try again:
    Debian, Ubuntu:  apt-get install gcc python3-dev libgmp-dev
    Fedora:          dnf install gcc python3-devel gmp-devel
    macOS:           brew install gmp
    conda:           conda install -c conda-forge c-compiler gmp
To check proofs you need none of these: CONVERSE_WITHOUT_CORE=1 leaves the core out, and
make checker makes one file, build/converse-check.pyz, that runs alone.
"""

# With these the linker adds code that flushes small numbers to zero in all of the process.
FAST = {"-Ofast", "-ffast-math", "-funsafe-math-optimizations", "-mdaz-ftz"}

PROBES = [
    ("there is no working C compiler", "int main(void) { return 0; }", []),
    ("the header Python.h is missing", "#include <Python.h>\nint main(void) { return 0; }", []),
    ("the GMP library or its header gmp.h is missing",
     "#include <gmp.h>\nint main(void) { mpz_t x; mpz_init(x); mpz_clear(x); return 0; }",
     ["gmp"]),
]


class BuildExt(build_ext):
    """Checks what the build needs before it starts, and names what is missing or may not be."""

    def build_extensions(self):
        for flag in [*self.compiler.compiler_so, *self.compiler.linker_so]:
            if flag in FAST:
                sys.exit("converse cannot be built with %s, which makes arithmetic inexact in all "
                         "of the process; take it out of CFLAGS and LDFLAGS." % flag)
        with tempfile.TemporaryDirectory() as directory:
            source = os.path.join(directory, "probe.c")
            for what, text, libraries in PROBES:
                with open(source, "w") as file:
                    file.write(text)
                try:
                    objects = self.compiler.compile([source], output_dir=directory,
                                                    include_dirs=self.include_dirs)
                    self.compiler.link_shared_object(
                        objects, os.path.join(directory, "probe.so"), libraries=libraries,
                        library_dirs=self.library_dirs)
                except Exception:       # the kinds of error differ between setuptools versions
                    sys.exit(NEEDS.format(what=what))
        super().build_extensions()


def on_an_index(text):
    """The README where none of its files are: pictures and links become their names."""
    text = re.sub(r"!\[(.*?)\]\((.*?)\)", r"*Figure \2: \1.*", text)
    text = re.sub(r"\[([^]]*)\]\(([^)#]*)[^)]*\)", r"\1 (\2)", text)
    return text + "\nThe files that are named here are in the source distribution.\n"


with open("README.md", encoding="utf-8") as readme:
    description = on_an_index(readme.read())

# Without the core the package proves nothing, but converse-check works.
core = [] if os.environ.get("CONVERSE_WITHOUT_CORE") else ["converse/_build.py:ffi"]

# The core keeps to Python's stable ABI, which free-threaded Pythons do not have yet.
stable = {} if sysconfig.get_config_var("Py_GIL_DISABLED") else {"py_limited_api": "cp39"}

setup(cffi_modules=core, cmdclass={"build_ext": BuildExt},
      long_description=description, long_description_content_type="text/markdown",
      options={"bdist_wheel": stable})
