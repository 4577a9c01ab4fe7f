"""Builds and machines that break the rules are refused; memory may run out anywhere."""

import ctypes
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from conftest import ROOT

import converse

import kernels
from kernels import build
from moments import PATIENCE

needs_gcc = pytest.mark.skipif(not shutil.which("gcc"), reason="needs gcc")


@needs_gcc
@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast"])
def test_a_fast_math_build_is_refused(flag):
    result = subprocess.run(["gcc", "-std=c11", flag, "-Icsrc", "-c", "csrc/arith/machine.c", "-o",
                             os.devnull],
                            cwd=ROOT, capture_output=True, text=True)
    assert result.returncode != 0
    assert "rules of rigor" in result.stderr


SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
void flush_to_zero(int on) { _mm_setcsr((_mm_getcsr() & ~0x8040u) | (on ? 0x8040u : 0u)); }
#else
void flush_to_zero(int on) { (void)on; }
#endif
void direction(int which)
{
    static const int modes[] = { FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO };
    fesetround(modes[which]);
}
"""


@pytest.fixture(scope="module")
def shim(tmp_path_factory):
    """A little library that spoils the floating-point unit."""
    directory = tmp_path_factory.mktemp("shim")
    (directory / "shim.c").write_text(SHIM)
    subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "shim.c", "-o", "shim.so", "-lm"],
                   cwd=directory, check=True)
    return directory / "shim.so"


@needs_gcc
@pytest.mark.parametrize("spoil, mend", [
    (lambda lib: lib.direction(1), lambda lib: lib.direction(0)),
    (lambda lib: lib.direction(2), lambda lib: lib.direction(0)),
    (lambda lib: lib.direction(3), lambda lib: lib.direction(0)),
    (lambda lib: lib.flush_to_zero(1), lambda lib: lib.flush_to_zero(0)),
])
def test_a_spoilt_machine_is_refused(shim, root, spoil, mend):
    lib = ctypes.CDLL(str(shim))
    problem = converse.read_input(root / "inputs" / "trig278.in")
    if os.uname().machine != "x86_64" and spoil.__code__.co_names[0] == "flush_to_zero":
        pytest.skip("only for x86-64")
    spoil(lib)
    try:
        with pytest.raises(converse.ConverseError, match="floating-point"):
            converse.prove(problem, method="thesis")
    finally:
        mend(lib)
    assert converse.prove(problem, method="thesis").no_tori


@needs_gcc
@pytest.mark.parametrize("method", ["thesis", "loewner"])
def test_a_machine_spoilt_in_mid_run_is_noticed(shim, root, method):
    """Each step looks at the arithmetic; nothing that a bad one did is taken."""
    from converse.prover.native import Search, Settings, Task
    from converse.prover.tree import ROOT as WHOLE

    lib = ctypes.CDLL(str(shim))
    search = Search(Task(converse.read_input(root / "inputs" / "trig278.in"), Settings(method)))
    assert search.work(0, bool)

    def grow():
        return search.grow([(*WHOLE, 0)]).text

    good = grow()
    for which in (1, 2, 3):
        lib.direction(which)
        try:
            with pytest.raises(converse.ConverseError, match="floating-point"):
                grow()
        finally:
            lib.direction(0)
        assert grow() == good


CONTRACTED = """
import converse
try:
    converse.prove(converse.MuldoonMap(1, 1, 1), method="loewner")
except converse.ConverseError as error:
    assert "the way the program was built" in str(error), error
else:
    raise SystemExit("it proves")
"""


@pytest.mark.slow
@needs_gcc
@pytest.mark.skipif("fma" not in Path("/proc/cpuinfo").read_text()
                    if os.path.exists("/proc/cpuinfo")
                    else True, reason="needs a processor with fused operations")
@pytest.mark.skipif("libasan" in os.environ.get("LD_PRELOAD", ""), reason="another build")
def test_a_core_that_fuses_is_refused(tmp_path, monkeypatch):
    """Built by flags that contract products and sums it is linked, and proves nothing.  (What
    notices is machine.c; the other objects are those of the console.)"""
    monkeypatch.delenv("CONVERSE_CONSOLE", raising=False)       # a mutant has no objects of its own
    native, package = tmp_path / "native.c", tmp_path / "converse"
    build.product()["ffi"].emit_c_code(str(native))
    shutil.copytree(Path(converse.__file__).parent, package,
                    ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    gcc = ["gcc", "-std=c11", "-fPIC", "-I", str(ROOT / "csrc"), "-c"]
    for source, flags in ((ROOT / "csrc/arith/machine.c", ["-O2", "-mfma", "-ffp-contract=fast"]),
                          (native, ["-O0", "-I", sysconfig.get_paths()["include"]])):
        subprocess.run([*gcc, *flags, str(source)], cwd=tmp_path, check=True)
    objects = {path.stem: path for path in build.path().parent.glob("*.o")}
    for name in ("module", "stand-ins", "arith-machine"):
        del objects[name]
    build.link([*objects.values(), tmp_path / "machine.o", tmp_path / "native.o"],
               package / "_native.abi3.so")
    subprocess.run([sys.executable, "-c", CONTRACTED], cwd=tmp_path, check=True, timeout=PATIENCE,
                   env=dict(os.environ, PYTHONPATH=str(tmp_path)))


FAILING = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>
/* Allocations until all fail, of the first thread and of all others; -1: never. */
static atomic_long left[2] = { -1, -1 };
static atomic_int failed;
void fail_after(long n, long others) { failed = 0; left[0] = n; left[1] = others; }
long left_here(void) { const long n = left[0]; left[0] = -1; return n; }
int has_failed(void) { left[0] = left[1] = -1; return failed; }
static int fails(void)
{
    atomic_long *const mine = &left[gettid() != getpid()];
    long now = *mine;
    while (now > 0 && !atomic_compare_exchange_weak(mine, &now, now - 1)) continue;
    if (now == 0) failed = 1;
    return now == 0;
}
extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
void *malloc(size_t n) { return fails() ? NULL : __libc_malloc(n); }
void *calloc(size_t n, size_t m) { return fails() ? NULL : __libc_calloc(n, m); }
void *realloc(void *p, size_t n) { return fails() ? NULL : __libc_realloc(p, n); }
"""

STARVED = r"""
import ctypes, resource, sys
from fractions import Fraction
import converse
from converse.prover.native import native_problem
from converse._native import ffi, lib
shim = ctypes.CDLL(None)
shim.fail_after.argtypes = [ctypes.c_long] * 2
shim.left_here.restype = ctypes.c_long
keep = []
ends = "0.30975", "0.31225"
made = converse.Problem(converse.MuldoonMap(ends, ends, ("0.6195", "0.6245")))
problems = [native_problem(each, keep) for each in (made, made.tied())]
handle = ffi.new("cv_search **")
assert lib.cv_search_new(handle, problems[0], ffi.NULL, 0, 0, 30, 0, 0, 0) == lib.CV_EARGUMENT
left = -1
def starved(call, *arguments):
    # Of the allocations of this call, and of no others, as many as are left succeed.
    global left
    shim.fail_after(left, -1)
    code = call(*arguments)
    left = shim.left_here()
    return code
def new(n=-1, dp=35, method=0, depth=30):
    global left
    left = n
    code = starved(lib.cv_search_new, handle, problems[method], ffi.NULL, method, dp, depth, 0, 0,
                   0)
    if code == 0:
        code = starved(lib.cv_set_up, handle[0])
        if code:
            lib.cv_search_free(handle[0])
            handle[0] = ffi.NULL
    return code
def step():
    return lib.cv_begin(handle[0], 10**6, 1e300) or starved(lib.cv_work, handle[0])
def look():
    view = ffi.new("cv_view *")
    assert lib.cv_look(handle[0], 1, view) == 0
    text = ffi.unpack(view.tree, view.length) if view.length else b""
    counts = view.counts.cuts, view.counts.proved, view.counts.symmetric
    lib.cv_forget_view(view)                # it is empty then
    return text, counts
seen = {"new": 0, "step": 0, "loewner": 0}
for n in list(range(0, 3000, 29)) + list(range(3000, 60000, 2999)):
    code = new(n)
    failed = shim.has_failed()
    assert code == (lib.CV_ENOMEM if failed else 0), (n, code, failed)
    assert (handle[0] == ffi.NULL) == bool(failed)
    seen["new"] += bool(failed)
    if not failed:
        lib.cv_search_free(handle[0])
assert new() == 0
step()
whole, _ = look()
lib.cv_search_free(handle[0])
for n in list(range(0, 2000, 41)) + list(range(2000, 200000, 4999)):
    assert new() == 0
    left = n
    code = step()
    failed = shim.has_failed()
    assert code == (lib.CV_ENOMEM if failed else 0), (n, code, failed)
    part, counts = look()
    part = part.rstrip(b"?")
    assert whole.startswith(part) and (failed or part == whole)
    assert counts == (part.count(b"0") + part.count(b"1"), part.count(b"P"), part.count(b"S"))
    seen["step"] += bool(failed)
    lib.cv_search_free(handle[0])
def pages():
    return int(open("/proc/self/statm").read().split()[0])
before = pages()
for n in range(0, 700):                      # the sharper method: making it, then a step
    code = new(n, method=1, depth=60)
    if code == 0:
        code = step()
    failed = shim.has_failed()
    assert code == (lib.CV_ENOMEM if failed else 0), (n, code, failed)
    seen["loewner"] += bool(failed)
    lib.cv_search_free(handle[0])
# Each such search works in 70 MB or more, which are freed whatever failed.
assert (pages() - before) * resource.getpagesize() < 50 << 20, (before, pages())
print(seen)
assert all(seen.values())
"""


@needs_gcc
@pytest.mark.skipif("libasan" in os.environ.get("LD_PRELOAD", ""), reason="asan has its own malloc")
@pytest.mark.slow
def test_every_allocation_may_fail(tmp_path):
    """The core returns an error wherever memory runs out, and what it had decided stands."""
    (tmp_path / "failing.c").write_text(FAILING)
    subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "failing.c", "-o", "failing.so"],
                   cwd=tmp_path, check=True)
    result = subprocess.run([sys.executable, "-c", STARVED], cwd=tmp_path,
                            capture_output=True, text=True,
                            env=dict(os.environ, LD_PRELOAD=str(tmp_path / "failing.so")),
                            timeout=PATIENCE)
    assert result.returncode == 0, result.stdout + result.stderr


HUNGRY = r"""
import resource, sys, threading
from converse.commands.prove import main
threading.stack_size(1 << 20)           # of one thread, however many cores there are
slack, backup, path = int(sys.argv[1]), sys.argv[2], sys.argv[3]
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + slack
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
hold = []
try:
    while slack == 0:                   # what the heap has left
        hold.append(bytearray(16384))
except MemoryError:
    del hold[-20:]
sys.exit(main(["--jobs", "1", "-r", backup]))
"""


def test_a_guard_within_a_guard_leaves_the_other_armed():
    STOP = 2                            # GUARD_STOP of guard.h
    assert kernels.call("guards", [], 2, 1) == [STOP, STOP]


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc")
@pytest.mark.skipif("libasan" in os.environ.get("LD_PRELOAD", ""), reason="asan needs room")
def test_a_memory_limit_ends_with_a_line_and_an_intact_backup(root, tmp_path):
    path = str(root / "inputs" / "trig272.in")
    problem = converse.read_input(path)
    seen = set()
    for slack in (0, 10**8):
        backup = tmp_path / "backup.proof"
        backup.unlink(missing_ok=True)
        before = converse.prove(problem, depth=4, digits=4000, time_limit=0, backup=backup)
        result = subprocess.run([sys.executable, "-c", HUNGRY, str(slack), str(backup), path],
                                cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
        assert "Traceback" not in result.stderr
        seen.add(result.returncode)
        if result.returncode == 2:
            assert result.stderr.count("\n") == 1 and "memory" in result.stderr.lower()
        after = converse.Proof.load(backup)
        assert after.tree.startswith(before.tree)
    assert seen == {1, 2}
