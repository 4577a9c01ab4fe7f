"""Wall time, peak memory and prisms for every input and precision, and the price of an image.

    python tests/bench [REPEAT]

Prints figures and judges nothing.  Machines differ and are shared: the time is the least of
REPEAT runs (3), and ratios within one run say more than seconds.
"""

import math
import os
import platform
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

from converse import growth, kernels

ROOT = Path(__file__).resolve().parent.parent.parent
COMMAND = str(Path(sys.executable).parent / "converse")
DIGITS = (10, 20, 35, 50, 100, 200)


def run(arguments):
    """Seconds of wall time and peak memory in MB of one process; its output is dropped."""
    begin = time.perf_counter()
    pid = os.fork()
    if pid == 0:
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execv(arguments[0], arguments)
    _, status, usage = os.wait4(pid, 0)
    assert os.WIFEXITED(status) and os.WEXITSTATUS(status) in (0, 1), arguments
    return time.perf_counter() - begin, usage.ru_maxrss / 1024


def proofs(repeat):
    import converse
    empty = min(run([COMMAND, "--version"])[0] for _ in range(repeat))
    print("whole processes; starting Python and importing alone takes %.3f s" % empty)
    print("%-8s %6s %9s %9s %8s %8s" % ("input", "digits", "seconds", "search", "MB", "prisms"))
    for path in sorted((ROOT / "inputs").glob("trig27*.in")):
        for digits in DIGITS:
            runs = [run([COMMAND, "-d30", "-p%d" % digits, str(path)]) for _ in range(repeat)]
            searches = []
            for _ in range(repeat):
                proof = converse.prove(converse.read_input(path), digits=digits)
                searches.append(proof.seconds)
            print("%-8s %6d %9.3f %9.3f %8.1f %8d" % (
                path.stem, digits, min(r[0] for r in runs), min(searches),
                max(r[1] for r in runs), proof.counts.proved))


def images():
    """Nanoseconds for the image of a prism of the list, and of that image."""
    centre = [Fraction(x) for x in ("0.3085", "0.3085", "0.617", "0.82", "0.82", "2.5", "2.1")]
    widths = ("0.00125", "0.00125", "0.0025", "0", "0", "0.02", "0.02")
    first = (centre, [[Fraction(w) if j == k else Fraction(0) for k in range(7)]
                      for j, w in enumerate(widths)])
    print("nanoseconds per image of a prism (without bounding its sines)")
    print("%-10s %12s %12s" % ("", "fixed form", "column rotor"))
    rows = [("double", 35, {"arithmetic": "double"})]
    rows += [("%d digits" % digits, digits, {}) for digits in DIGITS]
    for name, digits, options in rows:
        figures = []
        for prism in (first, kernels.image(first, digits, **options)):
            values = [*prism[0], *(x for row in prism[1] for x in row)]
            repeat = 20000 if options else 2000
            figures.append(min(kernels.call("image_ns", values + [repeat], 1, digits, **options)[0]
                               for _ in range(3)))
        print("%-10s %12.0f %12.0f" % (name, *figures))


def frontier(repeat, longest=60):
    """The theorems of the sharper method, one core against all, and the checker."""
    import converse
    jobs = growth.count_workers()
    print("method loewner, together, down to epsilon; %d cores; the checker on a sample" % jobs)
    print("%-8s %9s %9s %6s %9s %7s %7s %12s" % ("epsilon", "1 core", "all", "ratio", "prisms",
                                                 "points", "deepest", "checked/s"))
    with tempfile.TemporaryDirectory() as directory:
        for low in ("0.0272", "0.0180", "0.0160", "0.0152", "0.0148", "0.0144", "0.0142", "0.0141"):
            ends = [Fraction(e) * Fraction("11.21436") for e in (low, "0.0280")]
            centre, half = sum(ends) / 2, (ends[1] - ends[0]) / 2
            problem = converse.Problem.around((centre, centre, 2 * centre, Fraction(1), Fraction(1)),
                                       (half, half, 2 * half, Fraction(1), Fraction(1)),
                                       together=True)
            seconds = {}
            for n in (1, jobs):
                for _ in range(repeat):
                    if seconds.get(n, 0) < longest / repeat:
                        proof = converse.prove(problem, method="loewner", jobs=n)
                        assert proof.no_tori
                        seconds[n] = min(seconds.get(n, math.inf), proof.seconds)
            path = os.path.join(directory, low)
            proof.save(path)
            rate = [run([COMMAND + "-check", "--quiet", "--sample", str(k), path])[0]
                    for k in (1, 401)]
            print("%-8s %9.4f %9.4f %6.2f %9d %7d %7d %12.0f" % (
                low, seconds[1], seconds[jobs], seconds[1] / seconds[jobs], proof.counts.proved,
                proof.counts.max_NTsteps, proof.counts.most_cuts,
                min(400, proof.counts.proved) / max(rate[1] - rate[0], 1e-3)), flush=True)


def steps():
    """Nanoseconds per orbit step of the sharper method, and of its six sines alone."""
    a = Fraction("0.166")
    prism = [a, a, 2 * a, Fraction("3.1"), Fraction("2.9"), *[Fraction(1, 10 ** 9)] * 5,
             Fraction("0.858"), Fraction("0.858")]
    step = [min(kernels.call("loewner_step", [*prism, together, 18, 20000], 3, 20)[2]
                for _ in range(5)) for together in (1, 0)]
    sines = min(kernels.call("double_sincos_ns", [3, 300000], 1, 20)[0] for _ in range(5))
    print("nanoseconds per orbit step: %.0f with one parameter, %.0f with three; "
          "its six sines alone: %.0f" % (*step, sines))


def newton(repeat):
    """Milliseconds of a step of damped Newton, and seconds of whole families, of the orbits."""
    import numpy as np
    from converse import orbits
    from converse._native import ffi, lib
    from converse.orbits.potential import address

    print("periodic orbits, trig: milliseconds per step of damped Newton; 16 eps from 0.0025 to 0.04")
    for p, q in (((1432, 1897), 2513), ((377, 2330), 3770), ((57031, 75550), 100083)):
        guess = orbits.straight(orbits.trig, p, q)
        seconds = []
        for _ in range(repeat):
            how, u = ffi.new("cv_relaxed *"), np.zeros((q, 2))
            begin = time.perf_counter()
            lib.cv_relax(guess.potential.native, q, 0.0025, address(guess.base), address(u), 1e-13, 10,
                         how)
            seconds.append((time.perf_counter() - begin) / how.steps)
        begin = time.perf_counter()
        if q < 10000:
            orbits.follow(orbits.trig, p, q, [0.0025 * k for k in range(1, 17)])
        family = time.perf_counter() - begin
        print("q = %6d: %7.3f per step%s" % (q, 1000 * min(seconds),
                                             ", family %.2f s" % family if q < 10000 else ""))


if __name__ == "__main__":
    print("%s, %s, Python %s" % (platform.machine(), platform.system(), platform.python_version()))
    proofs(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
    images()
    steps()
    newton(3)
    frontier(3)
