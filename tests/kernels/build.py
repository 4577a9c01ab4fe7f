"""Builds the console, a cffi module of the tests: the sources of the core, with its flags, and what
lets tests call its routines one at a time.

    python tests/kernels/build.py       prints the path of the module

Most of those routines are static.  So the translation units that have them are not compiled as they
are: a unit here includes the source and then a file of the console.  The module lies in build/, in
a folder whose name tells sources, flags and compiler, and is built when it is missing there.
"""

import contextlib
import fcntl
import hashlib
import os
import re
import runpy
import shlex
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HOME = Path(__file__).resolve().parent
ROOT = HOME.parent.parent
NAME = "console"

CDEF = """
int kernel(const char *name, int as_double, int as_printed, int dp,
           int nin, const char *const in[], int nout, char *out[]);
int search_lanes(const void *search);
int search_mirrored(const void *search);
char *search_half(const void *search, int axis);
void cv_free(char *text);
"""
# What includes sources of the core, by a regular expression of their names.
INCLUDED = {r"model/torus": "rectangle.h", r"thesis/(rigorous|double)": "thesis.h",
            r"loewner/engine.*": "engine.h"}


def product():
    """What converse/_build.py says; it finds its files from the project's directory."""
    before = os.getcwd()
    os.chdir(ROOT)
    try:
        return runpy.run_path(os.path.join("converse", "_build.py"))
    finally:
        os.chdir(before)


def units(sources, csrc):
    """The translation units of the console: {name: text}."""
    found = {}
    for source in sources:
        name = source[len("csrc/"):-len(".c")]
        text = '#include "%s.c"\n' % name
        for pattern, file in INCLUDED.items():
            if re.fullmatch(pattern, name):
                text += _attributes(csrc, name, '#include "%s"' % (HOME / file))
        found[name.replace("/", "-")] = text
    for file in sorted(HOME.glob("*.c")):
        found["console-" + file.stem] = '#include "%s"\n' % file
    return found


def _attributes(csrc, name, text):
    """The text with the attributes that clang gives to the functions of an engine."""
    source, lanes = csrc / "loewner" / "engine.inc", re.fullmatch(r"loewner/engine_(.)_.", name)
    push = lanes and re.search("LANES == %s.*\n(#pragma clang attribute push.*)$" % lanes[1],
                               source.read_text("utf-8"), re.MULTILINE)
    if push is None:
        return text + "\n"
    return ("#ifdef __clang__\n%s\n#endif\n%s\n"
            "#ifdef __clang__\n#pragma clang attribute pop\n#endif\n"
            % (push[1], text))


def compile_unit(name, text, directory, csrc, flags):
    """Compiles a unit; next to the object, NAME.d says of which files it is made."""
    (directory / (name + ".c")).write_text(text, "utf-8")
    _run([*_compiler(), *flags, "-I", csrc, "-I", HOME, "-MMD", "-c", name + ".c"], cwd=directory)
    return directory / (name + ".o")


def _compiler():
    words = [sysconfig.get_config_var("CC").split()[0], sysconfig.get_config_var("CCSHARED"),
             "-I" + sysconfig.get_paths()["include"]]
    if os.environ.get("CC"):
        words[:1] = shlex.split(os.environ["CC"])
    given = " ".join(os.environ.get(name, "") for name in ("CPPFLAGS", "CFLAGS"))
    return [word for word in words if word] + shlex.split(given)


def link(objects, target):
    """A shared object that Python can load."""
    words = sysconfig.get_config_var("LDSHARED").split()
    if os.environ.get("CC"):
        words[:1] = shlex.split(os.environ["CC"])
    _run([*words, *objects, *shlex.split(os.environ.get("LDFLAGS", "")), "-lgmp", "-lm", "-o",
          target])


def _run(command, **options):
    done = subprocess.run(list(map(str, command)), stderr=subprocess.PIPE, text=True, **options)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(map(str, command)), done.stderr))


def wrapper(path):
    """Writes the C of the cffi module."""
    from cffi import FFI

    ffi = FFI()
    ffi.cdef(CDEF)
    ffi.set_source(NAME, CDEF)
    with contextlib.redirect_stdout(sys.stderr):        # it says what it does
        ffi.emit_c_code(str(path))


def stand_ins():
    """For the functions of Python that the core calls, and nothing here does."""
    return ("int cv_python_interrupts(void) { return 0; }\n"
            "void cv_python_evaluate(void *v, long m, const double (*x)[2], double *value,\n"
            "    double (*gradient)[2], double (*hessian)[3]) {}\n")


def path():
    """Where the console is, among the objects that it is made of.  It is built if need be, by one
    process at a time; CONVERSE_CONSOLE names another."""
    if "CONVERSE_CONSOLE" in os.environ:
        return Path(os.environ["CONVERSE_CONSOLE"])
    made = product()
    key = hashlib.sha256(repr((made["FLAGS"], list(map(str, _compiler())),
                               os.environ.get("LDFLAGS"),
                               sys.version, str(ROOT))).encode())
    for file in sorted([*ROOT.glob("csrc/**/*.*"), *HOME.glob("*.[ch]"), HOME / "build.py"]):
        key.update(file.read_bytes())
    home = ROOT / "build" / "kernels"
    target = home / key.hexdigest()[:16]
    home.mkdir(parents=True, exist_ok=True)
    with open(home / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not target.exists():
            with tempfile.TemporaryDirectory(dir=home) as directory:
                _build(made, Path(directory) / "made")
                os.replace(Path(directory) / "made", target)
    return target / (NAME + ".so")


def _build(made, directory):
    directory.mkdir()
    wrapper(directory / "module.c")
    texts = {**units(made["SOURCES"], ROOT / "csrc"), "stand-ins": stand_ins(),
             "module": (directory / "module.c").read_text("utf-8")}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(lambda item: compile_unit(*item, directory, ROOT / "csrc",
                                                          made["FLAGS"]), texts.items()))
    link(objects, directory / (NAME + ".so"))


if __name__ == "__main__":
    print(path())
