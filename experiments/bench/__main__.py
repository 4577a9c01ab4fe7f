"""What docs/explanation/speed.md says of times, measured anew.

    python experiments/bench [--repeat N] [--whole] [WHAT ...]

Prints figures and judges nothing.  Machines differ and are shared: a time is the least of N runs
(3), and ratios within one run say more than seconds.  With --whole the checker verifies all proof
files whole, which takes hours; without it, the files that take a minute or less.
"""

import argparse
import os
import platform
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

from converse.prover import workers

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path += [str(ROOT / "tests"), str(ROOT / "experiments")]
import chart  # noqa: E402

import kernels  # noqa: E402

COMMAND = str(Path(sys.executable).parent / "converse")
DIGITS = (10, 20, 35, 50, 100, 200)
LOWS = ("0.0272", "0.0180", "0.0160", "0.0152", "0.0148", "0.0144", "0.0142", "0.0141", "0.0140")
APART = ("standard-63-64.in", "trig160.in")     # inputs whose parameters do not move together
LONG = 60                               # seconds, after which nothing is repeated


def run(arguments):
    """A process: seconds of wall time, peak memory in MB, seconds of the processor.  Its output is
    dropped."""
    begin = time.perf_counter()
    pid = os.fork()
    if pid == 0:
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execv(arguments[0], arguments)
    _, status, usage = os.wait4(pid, 0)
    assert os.WIFEXITED(status) and os.WEXITSTATUS(status) in (0, 1, 4), arguments
    return time.perf_counter() - begin, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def processes(repeat):
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


def images(repeat):
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
            times = 20000 if options else 2000
            figures.append(min(kernels.call("image_ns", values + [times], 1, digits, **options)[0]
                               for _ in range(repeat)))
        print("%-10s %12.0f %12.0f" % (name, *figures))


def frontier(repeat, whole=False):
    """The theorems of the sharper method: one thread; all cores; the checker."""
    import converse
    jobs = workers.count_workers()
    print("method loewner, together, down to epsilon; its seconds and the checker's on one core")
    print("%-17s %9s | %9s %6s %9s %7s %7s | %9s %9s" % (
        "", "1 thread", "%d cores" % jobs, "ratio", "prisms", "points", "deepest", "checked/s",
        "whole"))
    with tempfile.TemporaryDirectory() as directory:
        checked = 0
        for name in LOWS + APART:
            problem = chart.on_line(name, "0.0280", together=True) if name in LOWS else \
                converse.read_input(ROOT / "inputs" / name)
            proof, alone = chart.timed(problem, method="loewner")
            assert proof.no_tori
            wall = min(converse.prove(problem, method="loewner").seconds
                       for _ in range(repeat if alone < LONG / repeat else 1))
            file = os.path.join(directory, name + ".proof")
            proof.save(file)
            check = [COMMAND + "-check", "--quiet", file]
            rate = [run(check + ["--sample", str(k)])[2] for k in (1, 401)]
            if whole or checked < LONG / 10:
                checked = run(check)[2]
                words = "%.1f" % checked
            else:
                words = ""
            print("%-17s %9.4f | %9.4f %6.2f %9d %7d %7d | %9.0f %9s" % (
                name, alone, wall, alone / wall, proof.counts.proved, proof.counts.max_NTsteps,
                proof.counts.most_cuts,
                min(400, proof.counts.proved) / max(rate[1] - rate[0], 1e-3), words), flush=True)


def steps(repeat):
    """Nanoseconds per orbit step and prism of the sharper method, with each number of lanes, and
    of six sines in plain doubles."""
    a = Fraction("0.166")
    prism = [a, a, 2 * a, Fraction("3.1"), Fraction("2.9"), *[Fraction(1, 10 ** 9)] * 5,
             Fraction("0.858"), Fraction("0.858")]
    numbers = [kernels.arguments(kernels.thesis([*prism, together])) for together in (1, 0)]
    for most in ("2", "4", "8"):
        os.environ["CONVERSE_LANES"] = most
        *_, lanes = kernels.call("waves_step", [*numbers[0], 18, 1], 4, 20)
        print("nanoseconds per orbit step, %d prisms at once: "
              "%.0f with one parameter, %.0f with three" % (lanes, *(
                  min(kernels.call("waves_step", [*each, 18, 20000], 4, 20)[2]
                      for _ in range(repeat)) for each in numbers)))
    del os.environ["CONVERSE_LANES"]
    print("six sines in plain doubles: %.0f" % min(
        kernels.call("double_sincos_ns", [3, 300000], 1, 20)[0] for _ in range(repeat)))


PARTS = {part.__name__: part for part in (processes, images, steps, frontier)}


def main():
    p = argparse.ArgumentParser(description="Measures the times in docs/explanation/speed.md.")
    p.add_argument("--repeat", type=int, default=3, metavar="N",
                   help="runs, of which the least counts")
    p.add_argument("--whole", action="store_true", help="check all proof files whole: frontier")
    p.add_argument("what", nargs="*", metavar="WHAT",
                   help="of %s (default: all)" % ", ".join(PARTS))
    options = p.parse_args()
    if not set(options.what) <= set(PARTS) or options.repeat < 1:
        p.error("WHAT is any of %s, and N is 1 or more" % ", ".join(PARTS))
    print("%s, %s, Python %s" % (platform.machine(), platform.system(), platform.python_version()))
    for name in options.what or PARTS:
        PARTS[name](options.repeat, *[options.whole] * (name == "frontier"))


if __name__ == "__main__":
    main()
