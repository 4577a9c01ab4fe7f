"""The cffi builder: csrc/converse.h and csrc/orbits.h are headers and the list of what Python
sees."""

import glob
import os

from cffi import FFI

SOURCES = ["arith/apm", "arith/special", "arith/guard", "arith/machine",
           "thesis/start", "thesis/rigorous", "thesis/double", "thesis/method",
           "loewner/problem", "loewner/start", "loewner/score", "loewner/method",
           *("loewner/engine_%d_%d" % (lanes, n) for lanes in (2, 4, 8) for n in (1, 2, 3)),
           "model/patch", "model/region", "model/stationary", "model/torus",
           "search/setup", "search/tree", "search/threads",
           "orbits/potential", "orbits/band", "orbits/relax", "orbits/average"]
SOURCES = ["csrc/%s.c" % name for name in SOURCES]

# The flags are part of the proof: no fused, reordered or extended floating-point arithmetic.
FLAGS = ["-std=c11", "-ffp-contract=off", "-fno-fast-math", "-fexcess-precision=standard",
         "-pthread",
         "-fno-math-errno"]             # sqrt without a look at errno is one instruction
if "CFLAGS" not in os.environ:
    # -fpeel-loops unrolls short loops with constant ends: without it the proof of 0.0140 took 18 %
    # more CPU time (gcc 12, November 2026).  -g0: tables for a debugger would be four fifths of the
    # file, and name the directory of the build.  Assertions are for make sanitize.
    FLAGS += ["-O2", "-fpeel-loops", "-g0", "-DNDEBUG"]

ffi = FFI()
HEADERS = ["converse.h", "orbits.h"]
for name in HEADERS:
    with open("csrc/" + name) as header:
        ffi.cdef(header.read())
# What C calls, and converse/orbits/potential.py defines.
ffi.cdef("""extern "Python+C" {
    int cv_python_interrupts(void);
    void cv_python_evaluate(void *potential, long m, const double (*x)[2], double *value,
                            double (*gradient)[2], double (*hessian)[3]);
}""")
ffi.set_source("converse._native", "".join(map('#include "%s"\n'.__mod__, HEADERS)),
               sources=SOURCES,
               include_dirs=["csrc"], libraries=["gmp"], extra_compile_args=FLAGS,
               extra_link_args=["-pthread"],
               depends=sorted(glob.glob("csrc/**/*.*", recursive=True)))
