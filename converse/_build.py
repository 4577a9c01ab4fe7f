"""The cffi builder: csrc/converse.h is both the header and the list of what Python sees."""

import glob
import os

from cffi import FFI

SOURCES = ["numbers/apm", "numbers/special", "numbers/guard", "numbers/machine",
           "thesis/start", "thesis/region", "thesis/rigorous", "thesis/double",
           "loewner/orbit", "loewner/witness", "loewner/bound", "loewner/try",
           "setup", "search", "kernels"]
SOURCES = ["csrc/%s.c" % name for name in SOURCES]

# The flags are part of the proof: no fused, reordered or extended floating-point arithmetic.
FLAGS = ["-std=c11", "-ffp-contract=off", "-fno-fast-math", "-fexcess-precision=standard"]
if "CFLAGS" not in os.environ:
    FLAGS.append("-O2")

ffi = FFI()
with open("csrc/converse.h") as header:
    ffi.cdef(header.read())
ffi.set_source("converse._native", '#include "converse.h"', sources=SOURCES,
               include_dirs=["csrc"], libraries=["gmp"], extra_compile_args=FLAGS,
               depends=sorted(glob.glob("csrc/**/*.[ch]", recursive=True)))
